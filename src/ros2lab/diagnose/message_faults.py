"""What is put into messages, what is published, and what is logged, followed through the sources."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.interfaces import members_of
from ros2lab.diagnose.node_source import LOG_METHODS, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes, parameters
from ros2lab.diagnose.spelling import did_you_mean

# The kind of a value: "int", "float", "str", "bool", "list", "dict", a message such as "std_msgs.msg.String",
# "type of std_msgs.msg.String", or "publisher of std_msgs.msg.String"; None where it is not known.
Kind = str | None

_FLOATS, _TEXTS = frozenset(("float", "double", "float32", "float64")), frozenset(("string", "wstring"))
_ROUNDING = frozenset(("int", "len"))
_ARTICLES = {
    "int": "an int",
    "float": "a float",
    "str": "a text",
    "bool": "a bool",
    "list": "a list",
    "dict": "a dict",
}


def message_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield values that do not fit the fields of messages, and what is wrong with publishing and logging."""
    kinds = Kinds(sources)
    for source in sources.sources.values():
        for owner, function, node in sources.scoped(source):
            scope = Scope(kinds, source, owner, function)
            if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
                yield from _assignment_faults(scope, node)
            elif isinstance(node, ast.Call):
                yield from _constructor_faults(scope, node)
                yield from _publish_faults(scope, node)
                yield from _logger_faults(scope, node)
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
                yield from _field_faults(scope, node)


class Kinds:
    """What the names of some sources hold, as far as every assignment to a name agrees."""

    def __init__(self, sources: NodeSources) -> None:
        self.sources = sources
        self._locals: dict[int, Mapping[str, list[ast.expr | None]]] = {}
        self._attributes: dict[int, Mapping[str, list[tuple[Scope, ast.expr | None]]]] = {}

    @cached_property
    def received(self) -> Mapping[int, str]:
        """The message that a callback's parameter holds, by the parameter's identity."""
        found = {}
        for creation, function in self.sources.callbacks():
            given = (creation.arguments or {}).get("msg_type")
            name = self.sources.resolve(creation.source, given)
            names = [one for one in parameters(function) if one.arg not in ("self", "cls")]
            if creation.method == "create_subscription" and names and name and interfaces.is_interface(name):
                found[id(names[0])] = name
        return found

    def locals_of(self, function: Function) -> Mapping[str, list[ast.expr | None]]:
        """Return what a function assigns to each of its names; None stands for what cannot be followed."""
        if id(function) not in self._locals:
            self._locals[id(function)] = _assigned(
                function, lambda node: node.id if isinstance(node, ast.Name) else None
            )
        return self._locals[id(function)]

    def attributes_of(self, one: NodeClass) -> Mapping[str, list[tuple[Scope, ast.expr | None]]]:
        """Return what a class assigns to each attribute of itself, and where."""
        if id(one) not in self._attributes:
            found: dict[str, list[tuple[Scope, ast.expr | None]]] = {}
            for inner in self.sources.lineage(one)[0]:
                for method in inner.methods.values():
                    scope = Scope(self, inner.source, inner, method)
                    pairs = _assigned(method, lambda n: n.attr if is_self_attribute(n) else None)
                    for name, values in pairs.items():
                        found.setdefault(name, []).extend((scope, value) for value in values)
            self._attributes[id(one)] = found
        return self._attributes[id(one)]


def _assigned(
    function: Function, name_of: Callable[[ast.AST], str | None]
) -> dict[str, list[ast.expr | None]]:
    found: dict[str, list[ast.expr | None]] = {}
    simple: set[int] = set()
    for node in own_nodes(function):
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                if name := name_of(target):
                    simple.add(id(target))
                    found.setdefault(name, []).append(node.value)
        elif isinstance(node, ast.AugAssign) and (name := name_of(node.target)):
            simple.add(id(node.target))
            # A sum is of the kind of what is added, or the assignments disagree: that is enough to know.
            is_sum = isinstance(node.op, (ast.Add, ast.Sub, ast.Mult))
            found.setdefault(name, []).append(node.value if is_sum else None)
    for node in own_nodes(function):
        is_bound = isinstance(getattr(node, "ctx", None), ast.Store) and id(node) not in simple
        if is_bound and (name := name_of(node)):
            found.setdefault(name, []).append(None)
    return found


class Scope:
    """A place in the sources, from which names are looked up."""

    def __init__(
        self, kinds: Kinds, source: PythonSource, owner: NodeClass | None, function: Function | None
    ) -> None:
        self.kinds, self.source, self.owner, self.function = kinds, source, owner, function

    def kind(self, node: ast.AST | None, depth: int = 0) -> Kind:  # noqa: PLR0911, PLR0912 -- a table
        """Return the kind of an expression's value."""
        if node is None or depth > 12:
            return None
        match node:
            case ast.Constant():
                return _constant_kind(node.value)
            case ast.JoinedStr():
                return "str"
            case ast.List() | ast.ListComp() | ast.Tuple():
                return "list"
            case ast.Dict() | ast.DictComp():
                return "dict"
            case ast.UnaryOp(op=ast.Not()):
                return "bool"
            case ast.UnaryOp():
                return self.kind(node.operand, depth + 1)
            case ast.BinOp():
                return self._sum_kind(node, depth + 1)
            case ast.IfExp():
                one, other = self.kind(node.body, depth + 1), self.kind(node.orelse, depth + 1)
                if {one, other} == {"int", "float"}:
                    return "int"  # sometimes, and that is enough to be wrong
                return one if one == other else None
            case ast.Call():
                return self._call_kind(node, depth + 1)
            case ast.Name():
                return self._name_kind(node, depth + 1)
            case ast.Attribute():
                return self._attribute_kind(node, depth + 1)
        return None

    def _sum_kind(self, node: ast.BinOp, depth: int) -> Kind:
        one, other = self.kind(node.left, depth), self.kind(node.right, depth)
        if isinstance(node.op, ast.Mod) and one == "str":
            return "str"
        if isinstance(node.op, ast.Div):
            return "float" if {one, other} <= {"int", "float"} else None
        if one == other and one in ("int", "float", "str"):
            return None if isinstance(node.op, ast.Pow) else one
        return "float" if {one, other} == {"int", "float"} else None

    def _call_kind(self, node: ast.Call, depth: int) -> Kind:
        name = self.kinds.sources.resolve(self.source, node.func)
        if name in ("int", "len") or (name == "round" and len(node.args) == 1):
            return "int"
        if name in ("str", "float", "bool", "list", "dict"):
            return name
        if name and interfaces.is_interface(name):
            return name
        if isinstance(node.func, ast.Attribute):
            if node.func.attr == "create_publisher":
                given = [k.value for k in node.keywords if k.arg == "msg_type"] or node.args[:1]
                message = self.kinds.sources.resolve(self.source, given[0]) if given else None
                return f"publisher of {message}" if message and interfaces.is_interface(message) else None
            if node.func.attr in ("format", "join", "upper", "lower", "strip") and (
                self.kind(node.func.value, depth) == "str"
            ):
                return "str"
        return None

    def _name_kind(self, node: ast.Name, depth: int) -> Kind:
        if self.function is not None:
            for one in [*parameters(self.function), *self.function.args.kwonlyargs]:
                if one.arg == node.id:
                    if node.id in self.kinds.locals_of(self.function):
                        return None
                    annotated = self.source.resolve(one.annotation)
                    known = self.kinds.received.get(id(one)) or annotated
                    return known if interfaces.is_interface(known) else None
            if node.id in (assigned := self.kinds.locals_of(self.function)):
                return _agreed([self.kind(value, depth) for value in assigned[node.id]])
        if node.id in self.source.constants:
            return _constant_kind(self.source.constants[node.id])
        name = self.source.resolve(node)
        return f"type of {name}" if name and interfaces.is_interface(name) else None

    def _attribute_kind(self, node: ast.Attribute, depth: int) -> Kind:
        if is_self_attribute(node):
            values = self.kinds.attributes_of(self.owner).get(node.attr, []) if self.owner else []
            return _agreed([scope.kind(value, depth) for scope, value in values])
        name = self.source.resolve(node)
        if name and interfaces.is_interface(name):
            return f"type of {name}"
        owner = self.kind(node.value, depth)
        fields = interfaces.fields_of(owner) if owner and interfaces.is_interface(owner) else None
        return _field_kind(fields.get(node.attr)) if fields else None


def _agreed(kinds: list[Kind]) -> Kind:
    return kinds[0] if kinds and all(kind == kinds[0] for kind in kinds) else None


def _constant_kind(value: object) -> Kind:
    name = type(value).__name__
    return name if name in ("int", "float", "str", "bool") else None


def _field_kind(field: str | None) -> Kind:
    """Return the kind of what a message's field holds, such as `double` or `geometry_msgs/Vector3`."""
    if field is None or "[" in field or "<" in field:
        return None
    if "/" in field:
        return field.replace("/", ".msg.")
    if field in _FLOATS:
        return "float"
    if field in _TEXTS:
        return "str"
    return {"boolean": "bool"}.get(field, "int" if "int" in field else None)


def _misfit(scope: Scope, message: str, name: str, field: str, value: ast.expr) -> Iterator[Finding]:
    """Yield what is wrong with giving a value to the field of a message."""
    wanted, given = _field_kind(field), scope.kind(value)
    place, text, short = scope.source.at(value), ast.unparse(value), message.rpartition(".")[2]
    if wanted is None or given is None or given == wanted or "publisher" in given:
        return
    if wanted == "float" and given == "int":
        number = f"{text}.0" if text.lstrip("-").isdigit() else f"float({text})"
        yield Finding(
            "int-in-float",
            f"The field {name} of {short} holds a float, and {text} is an int: without a check it arrives as 4e-323, "
            "which is nothing.",
            place,
            f"write {number}",
        )
    elif wanted == "str" and given in _ARTICLES:
        yield Finding(
            "string-data-type",
            f"The field {name} of {short} holds a text, and {text} is {_ARTICLES[given]}.",
            place,
            f"write str({text})",
        )
    elif not (wanted in ("int", "float") and given == "bool") and not (
        wanted == "float" and given not in _ARTICLES
    ):
        what = _ARTICLES.get(given, given.rpartition(".")[2])
        yield Finding(
            "field-type",
            f"The field {name} of {short} holds {_ARTICLES.get(wanted, wanted.rpartition('.')[2])}, and {text} is {what}.",
            place,
            f"give it {_ARTICLES.get(wanted, f'a {wanted.rpartition(chr(46))[2]}')}",
        )


def _assignment_faults(scope: Scope, node: ast.Assign | ast.AnnAssign | ast.AugAssign) -> Iterator[Finding]:
    if node.value is None or isinstance(node, ast.AugAssign):
        return
    for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
        pairs = [(target, node.value)]
        if isinstance(target, (ast.Tuple, ast.List)) and isinstance(node.value, (ast.Tuple, ast.List)):
            pairs = list(zip(target.elts, node.value.elts, strict=False))
        for one, value in pairs:
            if isinstance(one, ast.Attribute) and (message := scope.kind(one.value)):
                fields = interfaces.fields_of(message)
                if fields and one.attr in fields:
                    yield from _misfit(scope, message, one.attr, fields[one.attr], value)
                elif fields and not one.attr.startswith("_"):
                    yield _no_field(scope, message, one.attr, fields, one)


def _no_field(scope: Scope, message: str, name: str, fields: Mapping[str, str], node: ast.AST) -> Finding:
    return Finding(
        "message-field",
        f"{message.rpartition('.')[2]} has no field {name}; it has {', '.join(fields) or 'none'}.{did_you_mean(name, fields)}",
        scope.source.at(node),
        f"write one of: {', '.join(fields)}",
    )


def _field_faults(scope: Scope, node: ast.Attribute) -> Iterator[Finding]:
    message = scope.kind(node.value)
    fields = interfaces.fields_of(message) if message and interfaces.is_interface(message) else None
    if not fields or node.attr in fields or node.attr.startswith("_"):
        return
    package, kind, name = str(message).split(".")
    if node.attr not in ("get_fields_and_field_types", "SLOT_TYPES") and not node.attr.isupper():
        yield _no_field(scope, f"{package}.{kind}.{name}", node.attr, fields, node)


def _constructor_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    message = scope.kinds.sources.resolve(scope.source, node.func)
    fields = interfaces.fields_of(message) if message and interfaces.is_interface(message) else None
    if not message or fields is None:
        return
    for keyword in node.keywords:
        if keyword.arg and keyword.arg in fields:
            yield from _misfit(scope, message, keyword.arg, fields[keyword.arg], keyword.value)
        elif keyword.arg:
            yield _no_field(scope, message, keyword.arg, fields, keyword.value)
    if node.args:
        first = next(iter(fields), "field")
        yield Finding(
            "argument-missing",
            f"{message.rpartition('.')[2]} takes its fields by name, and a value stands here without one.",
            scope.source.at(node),
            f"write {message.rpartition('.')[2]}({first}={ast.unparse(node.args[0])})",
        )


def _publish_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    if not isinstance(node.func, ast.Attribute):
        return
    owner = scope.kind(node.func.value)
    if owner is None or not owner.startswith("publisher of "):
        return
    message = owner.removeprefix("publisher of ")
    short, place = message.rpartition(".")[2], scope.source.at(node)
    members = members_of("rclpy.publisher", "Publisher")[0]
    if node.func.attr != "publish":
        if members and node.func.attr not in members:
            yield Finding(
                "publisher-method",
                f"A publisher has no method {node.func.attr}.{did_you_mean(node.func.attr, ['publish'])}",
                place,
                f"write {ast.unparse(node.func.value)}.publish(msg)",
            )
        return
    given = scope.kind(node.args[0]) if node.args else None
    if given in _ARTICLES:
        text = ast.unparse(node.args[0])
        yield Finding(
            "publish-text",
            f"publish() wants a {short}, and {text} is {_ARTICLES[given]}.",
            place,
            f"write publish({short}(data={text}))"
            if given == "str"
            else f"put the value into a {short} first",
        )
    elif given is not None and given != message:
        is_class = given.startswith("type of ")
        what = given.rpartition(".")[2]
        yield Finding(
            "publish-type",
            f"publish() wants a {short}, and {'the class' if is_class else 'a'} {what} is given.",
            place,
            f"publish a {short}, or create the publisher with {what}"
            if not is_class
            else f"write publish({what}())",
        )


def _logger_faults(scope: Scope, node: ast.Call) -> Iterator[Finding]:
    function = node.func
    if not (isinstance(function, ast.Attribute) and function.attr in LOG_METHODS and node.args):
        return
    text = ast.unparse(function.value)
    is_logger = text.endswith("get_logger()")
    if not is_logger and is_self_attribute(function.value) and scope.owner is not None:
        values = scope.kinds.attributes_of(scope.owner).get(function.value.attr, [])
        is_logger = any(
            value is not None and ast.unparse(value) == "self.get_logger()" for _, value in values
        )
    if not is_logger:
        return
    if len(node.args) > 1:
        yield Finding(
            "logger-arguments",
            f"{function.attr}() of a logger takes one text, and {len(node.args)} values are given.",
            scope.source.at(node),
            "make one text of them: f'... {value}'",
        )
        return
    kind = scope.kind(node.args[0])
    if kind is not None and kind != "str" and not kind.startswith("publisher"):
        value = ast.unparse(node.args[0])
        yield Finding(
            "logger-arguments",
            f"{function.attr}() of a logger takes a text, and {value} is {_ARTICLES.get(kind, f'a {kind.rpartition(chr(46))[2]}')}.",
            scope.source.at(node),
            f"write {function.attr}(str({value}))",
        )
