"""How messages are filled, compared, published and logged."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from ros2lab.diagnose.code.expression_faults import is_by_comma
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.rounded_off import rounded_off
from ros2lab.diagnose.nodes.topic_faults import End, ends_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.calls import filled, fitting, meant_call
from ros2lab.diagnose.sources.interfaces import field_kind, members_of
from ros2lab.diagnose.sources.joined_texts import joined
from ros2lab.diagnose.sources.kinds import CLASS, PARAMETER, PLAIN, SENDER, Kind, Kinds, Scope
from ros2lab.diagnose.sources.node_source import LOG_METHODS, NodeSources
from ros2lab.diagnose.sources.python_source import assignments, given_to, last_name
from ros2lab.diagnose.sources.signatures import Signature, signature_by_name
from ros2lab.diagnose.sources.spelling import did_you_mean, nearest, with_article, write_instead
from ros2lab.diagnose.sources.syntax_parts import equal_sides, own_parameters

_NUMBERS = frozenset(("bool", "int", "float"))
# The kinds of values that a value of a plain kind can equal.
_EQUALS = {"str": frozenset(("str",)), "bool": _NUMBERS, "int": _NUMBERS, "float": _NUMBERS}


def message_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield values that do not fit message fields, and faults in comparing, publishing and logging."""
    kinds = Kinds(sources)
    told: set[tuple[str, str]] = set()
    for source in sources.sources.values():
        for owner, function, node in sources.scoped(source):
            scope = Scope(kinds, source, owner, function)
            if isinstance(node, (ast.Assign, ast.AnnAssign)):
                yield from _assignment_faults(scope, node)
            elif isinstance(node, ast.Call):
                yield from _constructor_faults(scope, node)
                yield from _sent_faults(scope, node)
                yield from _logger_faults(scope, node)
            elif isinstance(node, (ast.Compare, ast.Match)):
                if isinstance(node, ast.Compare):
                    yield from _never_equal(scope, node)
                # One finding for a whole if/elif chain.
                for finding in _comparison_faults(scope, node):
                    if (key := (source.at(function), finding.cause)) not in told:
                        told.add(key)
                        yield finding
            elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                message = scope.kind(node.value)
                if node.attr not in ("get_fields_and_field_types", "SLOT_TYPES") and not node.attr.isupper():
                    yield from _field_fault(scope, message, node.attr, node)


def filling(message: str, value: str, kind: Kind, method: str = "publish") -> str:
    """Say how to send a value in a message of another type."""
    name, fields = _short(message), interfaces.fields_of(message)
    if not fields:
        return (
            f"write {method}({name}())" if fields is not None else f"put it into {_described(message)} first"
        )
    path, wanted = _first_field(message)
    if kind != wanted:
        is_turned = {kind, wanted} <= {"int", "float"} or (wanted == "str" and kind in PLAIN)
        value = f"{wanted}({value})" if is_turned else "..."
    if len(fields) == 1 and "." not in path:
        return f"write {method}({name}({path}={value}))"
    return f"write msg = {name}(), fill its fields ({', '.join(fields)}), as in msg.{path} = {value}, and {method}(msg)"


def _first_field(message: str) -> tuple[str, Kind]:
    """Return the path and the kind of the first plain field of a message, such as `linear.x`."""
    fields = (interfaces.fields_of(message) or {}).items()
    name, field = next(
        entry for entry in [*fields, ("", "")] if entry[0] != "header"
    )  # a header says nothing about the value
    kind = field_kind(field)
    if not interfaces.fields_of(kind):
        return name, kind
    path, inner = _first_field(str(kind))
    return f"{name}.{path}", inner


def _short(kind: str) -> str:
    return kind.rpartition(".")[2].replace("_", ".")


def _described(kind: str) -> str:
    """Say what a value is, such as `an int` or `a Twist`."""
    if kind.startswith(CLASS):
        return "the class itself, without ()"
    return with_article("string" if kind == "str" else _short(kind))


def _assignment_faults(scope: Scope, node: ast.Assign | ast.AnnAssign) -> Iterator[Finding]:
    for target, given in assignments([node]):
        pairs = [(target, given)]
        if isinstance(target, (ast.Tuple, ast.List)) and isinstance(given, (ast.Tuple, ast.List)):
            pairs = list(zip(target.elts, given.elts, strict=False))
        for element, value in pairs:
            if isinstance(element, ast.Attribute):
                yield from _value_faults(scope, scope.kind(element.value), element.attr, value, element)


def _constructor_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    message = scope.kinds.sources.resolve(scope.source, node.func)
    fields = interfaces.fields_of(message)
    if message is None or fields is None:
        return
    for keyword in node.keywords:
        if keyword.arg:
            yield from _value_faults(scope, message, keyword.arg, keyword.value, keyword)
    if node.args:
        cause = f"{_short(message)} takes its fields as keyword arguments, but this value has no name."
        yield Finding("argument-missing", cause, scope.source.at(node), meant_call(scope.source, node))


def _value_faults(
    scope: Scope, message: Kind, field: str, value: ast.expr, place: ast.AST
) -> Iterator[Finding]:
    """Yield faults in giving a value to a field of a message."""
    wanted = field_kind((interfaces.fields_of(message) or {}).get(field))
    given = scope.kind(value)
    if wanted is None:
        yield from _field_fault(scope, message, field, place)
    elif is_by_comma(scope.source, value):
        return  # the comma is reported elsewhere
    elif rounded := [*rounded_off(scope, field, value)] if wanted == "float" else []:
        yield from rounded
    elif given is not None and given != wanted and not given.startswith(SENDER):
        target = place if isinstance(place, ast.Attribute) else None
        for finding in _misfit(scope, f"The field {field} of {_short(str(message))}", wanted, given, value):
            finding = replace(finding, about=(str(message),))  # noqa: PLW2901
            better = set_field(target, wanted, value) if finding.code == "field-type" else ""
            is_fixed = finding.fix and not finding.fix.startswith("give it")
            yield finding if is_fixed or not better else replace(finding, fix=better)


def set_field(target: ast.Attribute | None, wanted: str, value: ast.expr) -> str:
    """Say how to put a value into a field, or a keyword argument (None), of another type; empty if that is not known."""
    if (
        target is not None
        and interfaces.fields_of(wanted)
        and not isinstance(value, (ast.Tuple, ast.List, ast.Dict))
    ):
        path = _first_field(wanted)[0].rpartition(".")[2]
        path = "z" if target.attr == "angular" else path  # a robot turns about z
        return f"write {ast.unparse(target)}.{path} = {ast.unparse(value)}"
    new = fitting(wanted, value)
    home = f", with `from {wanted.rpartition('.')[0]} import {_short(wanted)}`" if "." in wanted else ""
    given = f"{ast.unparse(target)} = " if target is not None else ""
    return f"write {given}{new}{home}" if new else ""


def _misfit(scope: Scope, which: str, wanted: str, given: str, value: ast.expr) -> Iterator[Finding]:
    place, text = scope.source.at(value), ast.unparse(value)
    digits = (
        [n.value for n in value.elts if isinstance(n, ast.Constant)] if isinstance(value, ast.Tuple) else []
    )
    if given == PARAMETER:
        cause = f"{which} holds {_described(wanted)}, but {text} is a Parameter, whose value is in .value."
        yield Finding("field-type", cause, place, f"write {text}.value")
    elif len(digits) == 2 and wanted == "float":
        cause = f"{which} holds a float, but {text} is two numbers: the comma makes them a tuple."
        yield Finding("field-type", cause, place, f"write {digits[0]!s}.{digits[1]!s}, with a decimal point")
    elif wanted == "float" and given == "int":
        cause = f"{which} holds a float, but {text} is an int: ROS does not check it, reads the wrong bytes and sends a number like 4e-323, practically 0."
        fix = f"write {text}.0 instead of {text}" if text.lstrip("-").isdigit() else f"write float({text})"
        yield Finding("int-in-float", cause, place, fix)
    elif wanted == "str" and given in PLAIN:
        cause = f"{which} holds a string, but {text} is {_described(given)}."
        yield Finding("string-data-type", cause, place, f"write {fitting('str', value) or f'str({text})'}")
    elif not (wanted in ("int", "float") and given == "bool") and (wanted != "float" or given in PLAIN):
        is_tuple = isinstance(value, ast.Tuple)
        cause = f"{which} holds {_described(wanted)}, but {text} is {'a tuple' if is_tuple else _described(given)}."
        fix = f"give it {_described(wanted)}"
        yield Finding("field-type", cause, place, f"write {text}()" if given == f"{CLASS}{wanted}" else fix)


def _field_fault(scope: Scope, message: Kind, name: str, node: ast.AST) -> Iterator[Finding]:
    fields = interfaces.fields_of(message)
    if fields is not None and name not in fields and not name.startswith("_"):
        inner = [f for f, kind in fields.items() if name in (interfaces.fields_of(field_kind(kind)) or {})]
        short = _short(str(message))
        of_rclpy = interfaces.members_of(f"rclpy.{short.lower()}", short)
        if {"from_msg", name} <= of_rclpy and isinstance(node, ast.Attribute):
            cause = f"This {short} is a message, with the fields {', '.join(fields)}: {name} belongs to rclpy's {short}."
            fix = f"write `{short}.from_msg({ast.unparse(node.value)}).{name}` instead of `{ast.unparse(node)}`, with `from rclpy.{short.lower()} import {short}` at the top"
            yield Finding("message-field", cause, scope.source.at(node), fix, (str(message),))
            return
        if meant := _published(scope, node):
            end, kind = meant
            cause = (
                f"{short} has no field {name}, but {_short(kind)} has, which is published on {end.topic!r}."
            )
            fix = f"write {_short(kind)} instead of {short} in the subscription on line {end.creation.call.lineno}, with `from {kind.rpartition('.')[0]} import {_short(kind)}`"
            yield Finding("message-field", cause, scope.source.at(node), fix, (str(message),))
            return
        fits, why = _fitting_use(fields, scope, node)
        cause = f"{short} has no field {name}; it has {', '.join(fields) or 'none'}{why}.{did_you_mean(name, fits)}"
        fix = _deeper(fields, inner, name, node) if inner else _one_of(fits, name, scope, node)
        yield Finding("message-field", cause, scope.source.at(node), fix, (str(message),))


def _published(scope: Scope, node: ast.AST) -> tuple[End, str] | None:
    """Return the subscription of a callback, and the type published there that has a field which the message lacks."""
    sources, function = scope.kinds.sources, scope.function
    names = [parameter.arg for parameter in own_parameters(function)] if function else []
    if not isinstance(node, ast.Attribute) or ast.unparse(node.value) not in names[:1]:
        return None
    ends, asked = ends_of(sources), [id(made) for made, called in sources.callbacks() if called is function]
    kinds = [(end.topic, str(end.type)) for end in ends if end.is_publisher]
    having = {topic: kind for topic, kind in kinds if node.attr in (interfaces.fields_of(kind) or ())}
    found = (end for end in ends if id(end.creation) in asked and end.topic in having)
    return next(((end, having[end.topic]) for end in found), None)


def _fitting_use(fields: Mapping[str, str], scope: Scope, node: ast.AST) -> tuple[Mapping[str, str], str]:
    """Return the fields that fit what is done with the one that is written, and why; all of them if none does.

    What is done is the field of it that is asked for next, or the plain value that it is given.
    """
    for used in scope.source.nodes:
        match used:
            case ast.Attribute(attr=asked, value=owner) if owner is node:
                inner = {f: interfaces.fields_of(field_kind(kind)) or {} for f, kind in fields.items()}
                fits = {f: kind for f, kind in fields.items() if asked in inner[f]}
                why = f"; only {next(iter(fits))} has {asked}" if len(fits) == 1 else ""
            case ast.Assign(targets=[target], value=value) if target is node and scope.kind(value) in PLAIN:
                given = scope.kind(value)
                fits = {f: kind for f, kind in fields.items() if field_kind(kind) == given}
                why = f"; only {next(iter(fits))} holds {_described(str(given))}" if len(fits) == 1 else ""
            case _:
                continue
        return (fits, why) if fits else (fields, "")
    return fields, ""


def _one_of(fields: Mapping[str, str], name: str, scope: Scope, node: ast.AST) -> str:
    """Say which field is to be written instead of a name, of those that the call does not give yet."""
    calls = (call for call in scope.source.calls if node in call.keywords)
    given = {keyword.arg for call in calls for keyword in call.keywords}
    if (near := nearest(name, fields)) and near in given:
        return write_instead(near, name, given)
    left = [field for field in fields if field not in given]
    if len(left) == 1 and isinstance(node, ast.Attribute):
        return f"write {ast.unparse(node.value)}.{left[0]} instead of {ast.unparse(node)}"
    return f"write one of: {', '.join(left)}" if left else f"remove {name}, or use another message type"


def _deeper(fields: Mapping[str, str], inner: Sequence[str], name: str, node: ast.AST) -> str:
    """Say which inner field is to be written instead of a name, read or given."""
    if not isinstance(node, ast.keyword):
        return f"write {' or '.join(f'{field}.{name}' for field in inner)} instead of {name}"
    value = ast.unparse(node.value)
    kinds = {field: str(field_kind(fields[field])) for field in inner}
    whole = [f"{field}={_short(kind)}({name}={value})" for field, kind in kinds.items()]
    modules = {kind.rpartition(".")[0]: _short(kind) for kind in kinds.values()}
    imports = " and ".join(f"`from {module} import {short}`" for module, short in modules.items())
    return f"write {' or '.join(whole)} instead of {name}={value}, with {imports} at the top"


def _comparison_faults(scope: Scope, node: ast.Compare | ast.Match) -> Iterator[Finding]:
    """Yield comparisons of a message with a string or a number, which it never equals."""
    if isinstance(node, ast.Match):
        patterns = [branch.pattern for branch in node.cases]
        patterns += [
            inner for pattern in patterns if isinstance(pattern, ast.MatchOr) for inner in pattern.patterns
        ]
        values = [
            node.subject,
            *(pattern.value for pattern in patterns if isinstance(pattern, ast.MatchValue)),
        ]
    elif all(isinstance(operator, (ast.Eq, ast.NotEq, ast.In, ast.NotIn)) for operator in node.ops):
        values = [node.left]
        for comparator in node.comparators:
            values += (
                comparator.elts if isinstance(comparator, (ast.Tuple, ast.List, ast.Set)) else [comparator]
            )
    else:
        return
    messages = [value for value in values if interfaces.fields_of(scope.kind(value))]
    plain = [kind for value in values if (kind := scope.kind(value)) in PLAIN]
    if messages and plain:
        text, kind = ast.unparse(messages[0]), str(scope.kind(messages[0]))
        cause = f"`{text}` is {_described(kind)}, which never equals {_described(str(plain[0]))}."
        fix = f"compare {text}.{_first_field(kind)[0]}"
        yield Finding("message-compared", cause, scope.source.at(messages[0]), fix, (kind,))


def _never_equal(scope: Scope, node: ast.Compare) -> Iterator[Finding]:
    """Yield comparisons of a message field with values of another type, which it never equals."""
    for field, values, is_equal in equal_sides(node):
        is_field = isinstance(field, ast.Attribute) and interfaces.fields_of(scope.kind(field.value))
        equals = _EQUALS.get(scope.kind(field) or "") if is_field else None
        kinds = [scope.kind(value) for value in values]
        if equals and kinds and all(kind in PLAIN and kind not in equals for kind in kinds):
            wanted = str(scope.kind(field))
            holds = "never" if is_equal else "always"
            cause = f"`{ast.unparse(field)}` holds {_described(wanted)}, but {ast.unparse(values[0])} is {_described(str(kinds[0]))}, so `{ast.unparse(node)}` is {holds} true."
            fix = _asked_rightly(field, wanted, is_equal, values)
            yield Finding("never-equal", cause, scope.source.at(node), fix)
            return


def _asked_rightly(field: ast.expr, wanted: str, is_equal: bool, values: list[ast.expr]) -> str:
    """Say how to compare a field with a value of its own type."""
    text, value = ast.unparse(field), getattr(values[0], "value", None)
    if len(values) > 1 or not isinstance(values[0], ast.Constant):
        return f"compare {text} with {_described(wanted)}"
    written, sign = str(value).strip(), "==" if is_equal else "!="
    if wanted == "bool":
        is_true = (written.lower() not in ("false", "0", "")) == is_equal
        return f"write `{text}`" if is_true else f"write `not {text}`"
    if wanted == "str":
        return f"write `{text} {sign} {written!r}`"
    is_number = re.fullmatch(r"[-+]?\d+(\.\d+)?", written)
    return f"write `{text} {sign} {float(written):g}`" if is_number else f"compare {text} with a number"


# The methods that send messages, with their classes.
_SENDS = {
    "publish": "rclpy.publisher.Publisher",
    **dict.fromkeys(("call", "call_async"), "rclpy.client.Client"),
    **dict.fromkeys(("send_goal", "send_goal_async"), "rclpy.action.client.ActionClient"),
}


def _sent_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    owner = scope.kind(node.func.value) if isinstance(node.func, ast.Attribute) else None
    if owner is None or not owner.startswith(SENDER) or not isinstance(node.func, ast.Attribute):
        return
    message, method, place = owner.removeprefix(SENDER), node.func.attr, scope.source.at(node)
    if method not in _SENDS:
        members = members_of("rclpy.publisher", "Publisher") if ".msg." in message else ()
        if members and method not in members:
            cause = f"A publisher has no method {method}.{did_you_mean(method, ['publish'])}"
            yield Finding(
                "publisher-method", cause, place, f"write {ast.unparse(node.func.value)}.publish(msg)"
            )
        return
    given = scope.kind(node.args[0]) if node.args else None
    signature = signature_by_name(f"{_SENDS[method]}.{method}")
    if (given in PLAIN or not node.args) and signature and not signature.accepts(node):
        yield from _fields_sent(scope, node, message, signature)
        return
    if given is None or given == message:
        return
    text, what = ast.unparse(node.args[0]), _short(given)
    if given in PLAIN:
        fix = filling(message, text, given, method)
    elif given.removeprefix(CLASS) in (message, message.rpartition("_")[0]):
        fix = f"write {method}({_short(message)}())"
    elif isinstance(node.args[0], ast.Attribute) and scope.kind(node.args[0].value) == message:
        fix = f"write {method}({ast.unparse(node.args[0].value)})"
    else:
        fix = (
            f"write {method}({what}())"
            if given.startswith(CLASS)
            else _of_other_type(scope, node, message, what)
        )
    code = "publish-text" if given in PLAIN else "publish-type"
    cause = f"{method}() needs {_described(message)}, but {text} is {_described(given)}."
    yield Finding(code if method == "publish" else "argument-type", cause, place, fix, (message,))


def _fields_sent(scope: Scope, node: ast.Call, message: str, signature: Signature) -> Iterator[Finding]:
    """Yield calls that send values instead of a message with these fields, as in ROS 1, or nothing at all."""
    method, what, values = last_name(node.func), _described(message), given_to(node)
    places = [place.name for place in signature.places]
    if any(keyword.arg in places or nearest(keyword.arg, places) for keyword in node.keywords):
        return
    names = [name for name in interfaces.fields_of(message) or () if name != "header"]
    given = dict(zip(names, node.args, strict=False)) | {str(k.arg): k.value for k in node.keywords}
    is_whole = len(given) == len(values) and given.keys() <= {*names}
    whole = filled(message, ast.Dict([*map(ast.Constant, given)], [*given.values()]) if is_whole else None)
    if not values and scope.function:
        names_there = (ast.Name(name, ast.Load()) for name in scope.kinds.locals_of(scope.function))
        whole = next((name.id for name in names_there if scope.kind(name) == message), whole)
    more = f", with these values in its fields ({', '.join(names) or 'ros2 interface show lists them'})"
    cause = f"{method}() sends {what}, and these values belong in its fields."
    code, cause = (
        ("argument-unknown", cause)
        if values
        else ("argument-missing", f"{method}() is called without {what}.")
    )
    fix = f"write `{ast.unparse(node.func)}({whole})`{'' if is_whole else more}"
    yield Finding(code, cause, scope.source.at(node), fix, (message,))


def _of_other_type(scope: Scope, node: ast.Call, message: str, given: str) -> str:
    """Say how to make what sends for the messages that are sent with it."""
    sender, given = node.func.value if isinstance(node.func, ast.Attribute) else node, given.partition(".")[0]
    made = [value for _, value in scope.assigned(sender) if isinstance(value, ast.Call) and value.args]
    if len(made) == 1 and last_name(made[0].args[0]) == _short(message).partition(".")[0]:
        written = ast.unparse(made[0]).replace(ast.unparse(made[0].args[0]), given, 1)
        return f"write `{written}` on line {made[0].lineno}, or send {_described(message)} here"
    return f"send {_described(message)}, or create what sends it with {given}"


def _logger_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    function = node.func
    if not (isinstance(function, ast.Attribute) and function.attr in LOG_METHODS and node.args):
        return
    loggers = [function.value, *(value for _, value in scope.assigned(function.value) if value is not None)]
    if not any(ast.unparse(logger).endswith("get_logger()") for logger in loggers):
        return
    kind, value = scope.kind(node.args[0]), ast.unparse(node.args[0])
    if len(node.args) > 1:
        cause = f"A logger's {function.attr}() takes one string, but is given {len(node.args)} values."
        fix = f"write {function.attr}({joined(node.args)})"
        yield Finding("logger-arguments", cause, scope.source.at(node), fix)
    elif kind is not None and kind != "str" and not kind.startswith(SENDER):
        cause = f"A logger's {function.attr}() takes a string, but {value} is {_described(kind)}."
        fix = f"write {function.attr}(str({value}))"
        yield Finding("logger-arguments", cause, scope.source.at(node), fix)
