"""The kinds of values that a program puts into messages, followed through its sources."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from functools import cached_property

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    argument,
    assignments,
    last_name,
    own_nodes,
)
from ros2lab.diagnose.sources.syntax_parts import all_parameters, own_parameters

# The kind of a value: one of `PLAIN`, a message such as "std_msgs.msg.String", its class as
# "type of std_msgs.msg.String", or "sender of std_msgs.msg.String"; None if not known. A part of a service or an
# action is named as its class is: "std_srvs.srv.SetBool_Request".
Kind = str | None

PLAIN = frozenset(("int", "float", "str", "bool", "list", "dict"))
SENDER, CLASS = "sender of ", "type of "
PARAMETER = "rclpy.parameter.Parameter"
# What makes senders: the place and the name of the type, and the part of it that is sent.
_SENDERS = {
    "create_publisher": (0, "msg_type", ""),
    "create_client": (0, "srv_type", "_Request"),
    "ActionClient": (1, "action_type", "_Goal"),
}
_DEEPEST = 12  # names that are followed in a row

_Assigned = Mapping[str, list[ast.expr | None]]


class Kinds:
    """The kinds of the names in some sources, if all assignments to a name agree."""

    def __init__(self, sources: NodeSources) -> None:
        self.sources = sources
        self.depth = 0
        self._locals: dict[int, _Assigned] = {}
        self._attributes: dict[int, Mapping[str, list[tuple[Scope, ast.expr | None]]]] = {}

    @cached_property
    def received(self) -> Mapping[int, str]:
        """The message type of a callback's parameter, by the `id` of the parameter."""
        found: dict[int, set[str]] = {}
        for creation, function in self.sources.callbacks():
            given = creation.given("msg_type")
            name = self.sources.resolve(creation.source, given)
            names = own_parameters(function)
            if creation.method == "create_subscription" and names and name and interfaces.is_interface(name):
                found.setdefault(id(names[0]), set()).add(name)
        # A callback may receive messages of several types.
        return {parameter: types.pop() for parameter, types in found.items() if len(types) == 1}

    def locals_of(self, function: Function) -> _Assigned:
        """Return the values that a function assigns to each name; None for one that cannot be followed."""
        if id(function) not in self._locals:
            self._locals[id(function)] = _assigned(
                function, lambda node: node.id if isinstance(node, ast.Name) else None
            )
        return self._locals[id(function)]

    def attributes_of(self, node_class: NodeClass) -> Mapping[str, list[tuple[Scope, ast.expr | None]]]:
        """Return the values that a class assigns to each of its attributes, each with its scope."""
        if id(node_class) not in self._attributes:
            found: dict[str, list[tuple[Scope, ast.expr | None]]] = {}
            for inner in self.sources.lineage(node_class)[0]:
                for method in inner.methods.values():
                    scope = Scope(self, inner.source, inner, method)
                    pairs = _assigned(method, lambda n: n.attr if is_self_attribute(n) else None)
                    for name, values in pairs.items():
                        found.setdefault(name, []).extend((scope, value) for value in values)
            self._attributes[id(node_class)] = found
        return self._attributes[id(node_class)]


def _assigned(function: Function, name_of: Callable[[ast.AST], str | None]) -> _Assigned:
    found: dict[str, list[ast.expr | None]] = {}
    followed: set[int] = set()

    def add(target: ast.AST, value: ast.expr | None) -> None:
        if name := name_of(target):
            followed.add(id(target))
            found.setdefault(name, []).append(value)

    for target, value in assignments(own_nodes(function)):
        add(target, value)
    for node in own_nodes(function):
        if isinstance(node, ast.AugAssign):
            # Either the sum has the kind of what is added, or the assignments disagree.
            add(node.target, node.value if isinstance(node.op, (ast.Add, ast.Sub, ast.Mult)) else None)
    for node in own_nodes(function):
        if isinstance(getattr(node, "ctx", None), ast.Store) and id(node) not in followed:
            add(node, None)
    return found


class Scope:
    """A function or module of the sources, from which names are looked up."""

    def __init__(
        self, kinds: Kinds, source: PythonSource, owner: NodeClass | None, function: Function | None
    ) -> None:
        self.kinds, self.source, self.owner, self.function = kinds, source, owner, function

    def assigned(self, node: ast.AST) -> list[tuple[Scope, ast.expr | None]]:
        """Return the values that a class assigns to `self.something`, here or on an object of it; empty if it is none of both."""
        if not isinstance(node, ast.Attribute):
            return []
        owner = self.owner if is_self_attribute(node) else self._class_of(node)
        return self.kinds.attributes_of(owner).get(node.attr, []) if owner else []

    def _class_of(self, node: ast.Attribute) -> NodeClass | None:
        """Return the class of the object that a variable of the function holds, if only it sets the attribute; else None."""
        name = ast.unparse(node.value)
        made = self.kinds.locals_of(self.function).get(name, []) if self.function else []
        if len(made) != 1 or not isinstance(made[0], ast.Call) or ast.unparse(node) in self.source.stored:
            return None
        sources = self.kinds.sources
        return sources.classes.get(sources.resolve(self.source, made[0].func) or "")

    def kind(self, node: ast.AST | None) -> Kind:
        """Return the kind of an expression's value."""
        if self.kinds.depth > _DEEPEST:
            return None
        self.kinds.depth += 1
        try:
            return self._kind(node)
        finally:
            self.kinds.depth -= 1

    def _kind(self, node: ast.AST | None) -> Kind:  # noqa: PLR0911 -- a table
        match node:
            case ast.Constant():
                return _constant_kind(node.value)
            case ast.JoinedStr():
                return "str"
            case ast.List() | ast.ListComp() | ast.Tuple():
                return "list"
            case ast.Dict() | ast.DictComp():
                return "dict"
            case ast.UnaryOp():
                return "bool" if isinstance(node.op, ast.Not) else self.kind(node.operand)
            case ast.BinOp():
                return self._sum_kind(node)
            case ast.IfExp():
                then, otherwise = self.kind(node.body), self.kind(node.orelse)
                if {then, otherwise} == {"int", "float"}:
                    return "int"  # an int in one case is enough to be wrong
                return then if then == otherwise else None
            case ast.Call():
                return self._call_kind(node)
            case ast.Name():
                return self._name_kind(node)
            case ast.Attribute():
                return self._attribute_kind(node)
        return None

    def _sum_kind(self, node: ast.BinOp) -> Kind:
        left, right = self.kind(node.left), self.kind(node.right)
        if isinstance(node.op, ast.Mod) and left == "str":
            return "str"
        if isinstance(node.op, ast.Div):
            return "float" if {left, right} <= {"int", "float"} else None
        if left == right and left in ("int", "float", "str"):
            return None if isinstance(node.op, ast.Pow) else left
        return "float" if {left, right} == {"int", "float"} else None

    def _call_kind(self, node: ast.Call) -> Kind:
        if made := _SENDERS.get(last_name(node.func)):
            message = self._interface(argument(node, *made[:2]))
            return f"{SENDER}{message}{made[2]}" if message else None
        name = self.kinds.sources.resolve(self.source, node.func)
        if name == "len" or (name == "round" and len(node.args) == 1):
            return "int"
        if name in PLAIN or self._interface(node.func):
            return self._interface(node.func) or name
        if not isinstance(node.func, ast.Attribute):
            return None
        if node.func.attr == "get_parameter":
            return PARAMETER
        is_text = node.func.attr in ("format", "join", "upper", "lower", "strip")
        return "str" if is_text and self.kind(node.func.value) == "str" else None

    def _name_kind(self, node: ast.Name) -> Kind:
        if self.function is not None:
            assigned = self.kinds.locals_of(self.function).get(node.id)
            parameter = next((p for p in all_parameters(self.function) if p.arg == node.id), None)
            if parameter is not None:
                known = self.kinds.received.get(id(parameter)) or self.source.resolve(parameter.annotation)
                is_sure = interfaces.is_interface(known) and not assigned
                return known if is_sure and not _asks_for_type(self.function, node.id) else None
            if assigned:
                return _agreed([self.kind(value) for value in assigned])
        if node.id in self.source.constants:
            return _constant_kind(self.source.constants[node.id])
        return self._class_kind(node)

    def _attribute_kind(self, node: ast.Attribute) -> Kind:
        if values := self.assigned(node):
            return _agreed([scope.kind(value) for scope, value in values])
        fields = interfaces.fields_of(self.kind(node.value)) or {}
        return self._class_kind(node) or interfaces.field_kind(fields.get(node.attr))

    def _class_kind(self, node: ast.expr) -> Kind:
        name = self._interface(node)
        return f"{CLASS}{name}" if name else None

    def _interface(self, node: ast.expr | None) -> str:
        """Return the class of messages that an expression names; empty if it names none."""
        name = self.kinds.sources.resolve(self.source, node) or ""
        name = re.sub(r"\.(?=(?:Request|Response|Goal|Result|Feedback)$)", "_", name)
        return name if interfaces.is_interface(name) else ""


def kind_within(source: PythonSource, node: ast.expr) -> Kind:
    """Return the kind of an expression's value, as far as its own file tells."""
    sources = NodeSources({source.name: source})
    around = next((row[:2] for row in sources.scoped(source) if row[2] is node), (None, None))
    return Scope(Kinds(sources), source, *around).kind(node)


def _asks_for_type(function: Function, name: str) -> bool:
    """Return whether a function finds out itself what a variable holds, as with isinstance()."""
    for node in own_nodes(function):
        match node:
            case ast.Call(
                func=ast.Name(id="isinstance" | "hasattr" | "getattr" | "type"), args=[ast.Name(id=asked), *_]
            ):
                pass
            # Only values compare; any other pattern tells types or shapes apart.
            case ast.Match(subject=ast.Name(id=asked), cases=cases) if any(
                isinstance(inner, ast.MatchClass | ast.MatchSequence | ast.MatchMapping | ast.MatchSingleton)
                for branch in cases
                for inner in ast.walk(branch.pattern)
            ):
                pass
            case _:
                continue
        if asked == name:
            return True
    return False


def _agreed(kinds: list[Kind]) -> Kind:
    return kinds[0] if kinds and all(kind == kinds[0] for kind in kinds) else None


def _constant_kind(value: object) -> Kind:
    name = type(value).__name__
    return name if name in PLAIN else None
