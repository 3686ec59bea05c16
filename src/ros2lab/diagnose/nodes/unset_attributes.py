"""Attributes that a node uses and nothing sets: where they are defined instead, and what they should hold."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator

from ros2lab.diagnose.code.at_hand import holders
from ros2lab.diagnose.code.unknown_names import Unknown, compared, first_value
from ros2lab.diagnose.finding import Finding, Guess
from ros2lab.diagnose.sources.commented_out import disabled
from ros2lab.diagnose.sources.interfaces import method_of, node_properties
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    last_name,
    names_read,
    own_nodes,
    parameters,
    returns_value,
    walk,
)
from ros2lab.diagnose.sources.signatures import signature_of
from ros2lab.diagnose.sources.spelling import begin_alike, has_other_words, may_mean, nearest, words_of
from ros2lab.diagnose.sources.syntax_parts import calls_in, is_property, needed_by

_SENDERS = ("publish", "call_async", "call")


def no_such_member(owner: NodeClass, node: ast.Attribute, what: str, members: Collection[str]) -> Finding:
    """Return the finding of an attribute or a method that a node class lacks."""
    if found := chain_fault(owner, node, members):
        return found
    name, is_called = node.attr, owner.source.is_called(node)
    where, fix = _elsewhere(owner, name)
    if where:
        cause = f"{owner.definition.name} has no {what} {name}{where}"
        return Finding("attribute-missing", cause, owner.source.at(node), fix)
    close = _nearest_member(owner, node, members)
    if is_called and close not in owner.methods and (holder := _only_holder(owner, node)):
        cause = f"{owner.definition.name} has no {what} {name}: {holder} has it."
        fix = f"write {holder}.{name} instead of self.{name}"
        return Finding("attribute-missing", cause, owner.source.at(node), fix)
    if _is_callback(owner.source, node):
        what = "method"
        uses = [n.attr for n in walk(owner.definition) if is_self_attribute(n)]
        close = None if close in uses else close  # that one is called back, or called, for something else
    elif not is_called:
        fix = f"set self.{name} in __init__, or fix its spelling"
        close = _as_used(owner, node, close) if close else None
    meant = f" Did you mean {close}?" if close else ""
    cause = f"{owner.definition.name} has no {what} {name}.{meant}"
    guess = Guess(f"self.{name}", f"self.{close}", f"define self.{name} in __init__") if close else None
    told = unset(owner.source, owner.definition, name)
    is_disabled = bool(told and "out of use" in told[0])
    if told and (is_disabled or not close or "==" in told[0]):
        cause, fix = told
        guess = None if is_disabled else guess
    elif close:
        fix = f"write self.{close}, or define {name if what == 'method' and not is_called else f'self.{name} in __init__'}"
    return Finding("attribute-missing", cause, owner.source.at(node), fix, guess=guess)


def _is_callback(source: PythonSource, node: ast.Attribute) -> bool:
    """Return whether an attribute is given to a call as what is to be called back."""
    given = source.above(node)
    call = source.above(given) if isinstance(given, ast.keyword) else given
    if not isinstance(call, ast.Call) or call.func is node:
        return False
    signature = signature_of(source, call)
    names = [place.name for place in signature.places] if signature else [last_name(call.func)]
    names = [str(given.arg)] if isinstance(given, ast.keyword) else names[call.args.index(node) :]
    return "".join(names[:1]).endswith("callback")


def _nearest_member(owner: NodeClass, node: ast.Attribute, members: Collection[str]) -> str | None:
    """Return the attribute or the member of Node that a name may mean; None if it is like none."""
    name = node.attr
    public = [member for member in members if member[0] != "_" or name[0] == "_"]
    like = [member for member in public if may_mean(name, member, public)]
    return nearest(name, owner.attributes) or nearest(name, like) or _word_for_word(owner, node, public)


def _word_for_word(owner: NodeClass, node: ast.Attribute, members: Collection[str]) -> str | None:
    """Return the only member of Node with words that begin like those of a called name, and that takes what it is given.

    So `destroy` is `destroy_node`, and `create_subscriber`, made like `create_publisher`, is `create_subscription`.
    """
    call = owner.source.above(node)
    if not isinstance(call, ast.Call) or call.func is not node:
        return None
    found = list[str]()
    for member in (m for m in members if begin_alike(node.attr, m)):
        asked = ast.Call(ast.Attribute(node.value, member), call.args, call.keywords)
        signature = signature_of(owner.source, asked)
        found += [member] * bool(signature and signature.accepts(call))
    return found[0] if len(found) == 1 else None


def _only_holder(owner: NodeClass, node: ast.Attribute) -> str:
    """Return the only other object at hand that has a method; empty if there is none, or more than one."""
    unknown = Unknown(owner.source, node.attr, node)
    held = [holder for holder in holders(unknown, {node.attr}) if holder != "self"]
    return held[0] if len(held) == 1 else ""


def _as_used(owner: NodeClass, node: ast.Attribute, close: str) -> str | None:
    """Return a similar name as it gives the value that is used: a method that takes nothing, called; None if none."""
    if close not in owner.attributes and close in node_properties():
        return None  # such as `timers`, all of them
    method = owner.methods.get(close) or method_of("rclpy.node", "Node", close)
    if method is None or is_property(method) or isinstance(node.ctx, ast.Store):
        return close
    is_inside = node in walk(method)  # it would only call itself
    return None if needed_by(method) or is_inside or not returns_value(method) else f"{close}()"


def unset(source: PythonSource, definition: ast.ClassDef, name: str) -> tuple[str, str] | None:
    """Return why an attribute of self has no value, and the line that gives it one; None if its uses do not tell."""
    uses = [n for n in walk(definition) if is_self_attribute(n) and getattr(n, "attr", "") == name]
    for use in uses:
        if told := compared(source, use):
            return f"`==` only compares, so nothing sets self.{name}; a single `=` assigns.", told
    cause = f"self.{name} is used here, but nothing in the class sets it."
    line, back = disabled(source.text, definition.body, rf"^\s*self\.{re.escape(name)}\s*=[^=]")
    if line:
        return f"{cause} Line {line} does, but is out of use.", back
    if there := _there(source, definition, name):
        return cause, there
    value = _sender(source, definition, name) or first_value(source, uses)
    if not value:
        return None
    line = max(_constructed(definition), default=0)
    where = f"below line {line}, in __init__()" if line else "as the first line of __init__()"
    blank = ", with the name that the others use instead of the dots" * ("'...'" in value)
    return cause, f"write `self.{name} = {value}` {where}{blank}"


def _constructed(definition: ast.ClassDef) -> Iterator[int]:
    """Yield the line on which the constructor of a class calls that of its base class."""
    for node in walk(definition):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "super().__init__":
            yield node.end_lineno or node.lineno


def _sender(source: PythonSource, definition: ast.ClassDef, name: str) -> str:
    """Return the creation of the publisher or the client that an attribute is used as; empty if it is none."""
    for method, kind in _sent(definition, name):
        asked = kind.removesuffix(".Request")
        if asked in source.names and method != "publish":
            return f"self.create_client({asked}, '...')"
        if kind in source.names and method == "publish" and not _publishers(source, definition, kind):
            return f"self.create_publisher({kind}, '...', 10)"
    return ""


def _sent(definition: ast.ClassDef, name: str) -> Iterator[tuple[str, str]]:
    """Yield by which methods an attribute sends something, each with its class; empty if that is not known."""
    for call in walk(definition):
        match call:
            case ast.Call(func=ast.Attribute(value=owner, attr=method), args=[sent]) if method in _SENDERS:
                if ast.unparse(owner) == f"self.{name}":
                    yield method, _kind(definition, sent)


def _there(source: PythonSource, definition: ast.ClassDef, name: str) -> str:
    """Say which publisher of the class may be meant by an attribute that publishes; empty if there is none."""
    for method, kind in _sent(definition, name):
        found = _publishers(source, definition, kind) if method == "publish" else []
        found = [text for text in found if not _is_another(definition, text, name)]
        numbered = [text for text in found if re.findall(r"\d+", text) == re.findall(r"\d+", name)]
        found = numbered if len(numbered) == 1 else found
        if found:
            return f"write {' or '.join(found)} instead of self.{name}: it publishes {kind} already"
    return ""


def _is_another(definition: ast.ClassDef, text: str, name: str) -> bool:
    """Return whether an attribute of self is in use, and its name has another word in place of one of a name."""
    words, others = words_of(name), words_of(text.removeprefix("self."))
    is_other = len(words) == len(others) and has_other_words(name, text.removeprefix("self."))
    return is_other and any(
        ast.unparse(call.func) == f"{text}.publish" for call in calls_in(walk(definition))
    )


def _publishers(source: PythonSource, definition: ast.ClassDef, kind: str) -> list[str]:
    """Return the attributes of self that hold a publisher of a type."""
    return [
        text
        for text, made in source.made
        if text.startswith("self.") and getattr(made.func, "attr", "") == "create_publisher"
        if kind and made.args and ast.unparse(made.args[0]) == kind
        if made in walk(definition)
    ]


def _kind(definition: ast.ClassDef, sent: ast.expr) -> str:
    """Return the class of which a message is an instance, as the file writes it; empty if it is not known."""
    if isinstance(sent, ast.Call):
        return ast.unparse(sent.func)
    for node in walk(definition):
        match node:
            case ast.Assign(targets=[ast.Name(id=made)], value=ast.Call(func=func)):
                if isinstance(sent, ast.Name) and made == sent.id:
                    return ast.unparse(func)
            case ast.arg(arg=made, annotation=ast.expr() as kind):
                if isinstance(sent, ast.Name) and made == sent.id:
                    return ast.unparse(kind)
    return ""


def _elsewhere(owner: NodeClass, name: str) -> tuple[str, str]:
    """Say where a name that a class lacks is defined, and what to do about it."""
    for node in owner.source.nodes:
        if not isinstance(node, Function) or node.name != name:
            continue
        holder = next((h for h in owner.source.nodes if node in getattr(h, "body", [])), None)
        line = f"line {node.lineno}"
        if isinstance(holder, ast.ClassDef):
            cause = f": it belongs to {holder.name} ({line})."
            return cause, f"move the method {name} into the class {owner.definition.name}"
        if holder is owner.source.tree and [p.arg for p in parameters(node)][:1] != ["self"]:
            cause = f": {name} is a function outside the class ({line})."
            return cause, f"write {name} instead of self.{name}"
        inside = (
            f"too far, so it is a function inside {holder.name}()"
            if isinstance(holder, Function)
            else "too little, so it is a function outside the class"
        )
        cause = f": it is indented {inside} ({line})."
        return cause, f"indent def {name} and its body like the other methods of {owner.definition.name}"
    for local in owner.methods.values():
        set_here = [n for n in own_nodes(local) if isinstance(n, ast.stmt) and name in _assigned(n)]
        if set_here:
            cause = f": {local.name}() sets {name} without self."
            if len(set_here) == 1 and name not in names_read(walk(local)):
                text = re.sub(rf"\b{name}\b", f"self.{name}", ast.unparse(set_here[0]), count=1)
                return cause, f"write `{text}` on line {set_here[0].lineno}"
            last = max(node.end_lineno or node.lineno for node in set_here)
            return cause, f"write `self.{name} = {name}` below line {last}, in {local.name}()"
    return "", f"define {name}, or fix its spelling"


def _assigned(statement: ast.stmt) -> set[str]:
    """Return the names that an assignment gives a value."""
    if not isinstance(statement, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
        return set()
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    return {n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)}


def chain_fault(owner: NodeClass, node: ast.Attribute, members: Collection[str]) -> Finding | None:
    """Return the finding of `self.get.logger()` for `get_logger`, or of `self.cancel.timer()` for `timer.cancel`."""
    asked = owner.source.above(node)
    if not isinstance(asked, ast.Attribute):
        return None
    is_called = owner.source.is_called(asked)
    made = {text for text, _ in owner.source.made}
    written, joined = ast.unparse(asked), f"{node.attr}_{asked.attr}"
    if joined in members:
        cause = f"{written} asks self for {node.attr} first, which it does not have: the name has no dot."
        meant = f"self.{joined}"
    elif is_called and f"self.{asked.attr}" in made and asked.attr in owner.attributes:
        cause = f"{written} asks self for {node.attr}, which it does not have: {asked.attr} comes first."
        meant = f"self.{asked.attr}.{node.attr}"
    else:
        return None
    return Finding("attribute-missing", cause, owner.source.at(node), f"write {meant} instead of {written}")
