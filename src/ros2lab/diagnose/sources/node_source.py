"""Which classes of a package are nodes, and what they create, as the sources have it."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeGuard

from ros2lab.diagnose.sources.interfaces import members_of
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    children,
    is_property,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.static_value import UNKNOWN, evaluate

NODE_CLASSES = frozenset(
    (
        "rclpy.node.Node",
        "rclpy.lifecycle.Node",
        "rclpy.lifecycle.LifecycleNode",
        "rclpy.lifecycle.node.LifecycleNode",
    )
)
# What a node creates, with the parameters of each method in their order.
CREATORS: Mapping[str, tuple[str, ...]] = {
    "create_publisher": ("msg_type", "topic", "qos_profile"),
    "create_subscription": ("msg_type", "topic", "callback", "qos_profile"),
    "create_timer": ("timer_period_sec", "callback"),
    "create_service": ("srv_type", "srv_name", "callback"),
    "create_client": ("srv_type", "srv_name"),
}
_ALSO = {"create_lifecycle_publisher": "create_publisher"}  # what takes the same
LOG_METHODS = frozenset(("debug", "info", "warn", "warning", "error", "fatal"))


@dataclass(frozen=True, eq=False)
class Creation:
    """A call such as `self.create_publisher(String, '/robot/status', 10)`.

    Attributes:
        method: such as `create_publisher`.
        call: the call itself.
        arguments: by the parameters' names; None if a star hides them.
        owner: the class in which it stands, if it is one.
        function: the function in which it stands, if it is one.
    """

    method: str
    call: ast.Call
    arguments: dict[str, ast.expr] | None
    extra: int
    owner: NodeClass | None
    function: Function | None
    source: PythonSource


@dataclass(eq=False)
class NodeClass:
    """A class of the package.

    Attributes:
        name: with its module, such as `pk.talk.Talk`.
        bases: what it is derived from, by their whole names; None for one that is not known.
    """

    name: str
    definition: ast.ClassDef
    source: PythonSource
    bases: tuple[str | None, ...]

    @cached_property
    def functions(self) -> tuple[Function, ...]:
        """All that are defined in it, also a property's getter, which has its setter's name."""
        kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
        return tuple(node for node in self.definition.body if isinstance(node, kinds))

    @cached_property
    def methods(self) -> Mapping[str, Function]:
        """Its own methods, by their names."""
        return {function.name: function for function in self.functions}

    @cached_property
    def attributes(self) -> frozenset[str]:
        """What it assigns to itself or to its class, and what stands in its body."""
        found = set(self.methods)
        holders = {"self", "cls", "type(self)", "self.__class__", self.definition.name}
        for node in walk(self.definition):
            if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                found |= {node.attr} if ast.unparse(node.value) in holders else set()
        # A name that a method binds is that method's own.
        names = [node for node in own_nodes(self.definition) if isinstance(node, ast.Name)]
        found |= {node.id for node in names if isinstance(node.ctx, ast.Store)}
        return frozenset(found)


def is_self_attribute(node: ast.AST | None) -> TypeGuard[ast.Attribute]:
    """Return whether this is `self.something`."""
    return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"


Scoped = tuple[NodeClass | None, Function | None, ast.AST]


class NodeSources:
    """The classes and functions of some Python files, which may import each other.

    Args:
        sources: the files by the names of their modules.
    """

    def __init__(self, sources: Mapping[str, PythonSource]) -> None:
        self.sources = sources
        self.classes: dict[str, NodeClass] = {}
        self.functions: dict[str, tuple[PythonSource, Function]] = {}
        self._scoped: dict[PythonSource, tuple[Scoped, ...]] = {}
        for name, source in sources.items():
            for node in source.tree.body:
                if isinstance(node, ast.ClassDef):
                    bases = tuple(source.resolve(base) for base in node.bases)
                    self.classes[f"{name}.{node.name}"] = NodeClass(
                        f"{name}.{node.name}", node, source, bases
                    )
                elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                    self.functions[f"{name}.{node.name}"] = (source, node)

    def resolve(self, source: PythonSource, node: ast.AST | None) -> str | None:
        """Return what a name stands for, also where a file hands on what it has imported itself."""
        name = source.resolve(node)
        for _ in range(5):
            if name is None or name in self.classes or name in self.functions:
                return name
            module, _, rest = name.rpartition(".")
            handed_on = self.sources[module].names.get(rest) if module in self.sources else None
            if handed_on in (None, name):
                return name
            name = handed_on
        return name

    def lineage(self, one: NodeClass) -> tuple[list[NodeClass], bool, bool]:
        """Return a class with its own bases, whether it is a node, and whether all of its bases are known."""
        chain, is_node, is_known = [one], False, True
        for base in (self._handed(base) for base in one.bases):
            if base in NODE_CLASSES:
                is_node = True
            elif base in self.classes and self.classes[base] is not one and len(chain) < 20:
                inner, inner_is_node, inner_is_known = self.lineage(self.classes[base])
                chain += inner
                is_node |= inner_is_node
                is_known &= inner_is_known
            elif base not in ("object", "abc.ABC"):
                is_known = False
        return chain, is_node, is_known

    def _handed(self, name: str | None) -> str | None:
        if name is None or name in self.classes:
            return name
        module, _, rest = name.rpartition(".")
        return self.sources[module].names.get(rest, name) if module in self.sources else name

    @cached_property
    def nodes(self) -> list[NodeClass]:
        """The classes that are nodes."""
        return [one for one in self.classes.values() if self.lineage(one)[1]]

    def is_managed(self, one: NodeClass) -> bool:
        """Return whether a class is a node with a life cycle, of which others decide when it publishes."""
        return any(base and "lifecycle" in base for inner in self.lineage(one)[0] for base in inner.bases)

    def attributes(self, one: NodeClass) -> frozenset[str]:
        """Return what a class and its own bases assign to themselves."""
        return frozenset(name for inner in self.lineage(one)[0] for name in inner.attributes)

    def method(self, owner: NodeClass | None, name: str) -> Function | None:
        """Return a method of a class or of its bases; a property is none, for its name means its value."""
        chain = self.lineage(owner)[0] if owner else []
        found = next((one.methods[name] for one in chain if name in one.methods), None)
        return None if found is None or is_property(found) else found

    def members(self, one: NodeClass) -> frozenset[str] | None:
        """Return everything that `self.` may be followed by; None if that cannot be told."""
        _, is_node, is_known = self.lineage(one)
        inherited = members_of("rclpy.node", "Node")[0]
        text = ast.dump(one.definition)
        if not (is_node and is_known and inherited) or "setattr" in text or "__getattr__" in text:
            return None
        if self.is_managed(one):
            return None
        return inherited | frozenset(dir(object)) | self.attributes(one)

    def members_at(self, source: PythonSource, node: ast.AST) -> frozenset[str]:
        """Return what `self.` may be followed by where something stands; nothing outside a class."""
        for one in self.classes.values():
            if one.source is source and node in walk(one.definition):
                return self.members(one) or one.attributes
        return frozenset()

    @cached_property
    def creations(self) -> list[Creation]:
        """Every call by which something is created."""
        own = {name for one in self.classes.values() for name in one.methods}
        methods = {name: names for name, names in CREATORS.items() if name not in own}
        return [
            creation
            for source in self.sources.values()
            if any(
                one.target.partition(".")[0] in ("rclpy", source.name.partition(".")[0])
                for one in source.imports
            )
            for creation in self._creations_in(source, methods)
        ]

    def _creations_in(
        self, source: PythonSource, methods: Mapping[str, tuple[str, ...]]
    ) -> Iterator[Creation]:
        for owner, function, node in self.scoped(source):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Attribute)
                and (method := _ALSO.get(node.func.attr, node.func.attr)) in methods
            ):
                names = methods[method]
                stars = any(isinstance(a, ast.Starred) for a in node.args) or any(
                    keyword.arg is None for keyword in node.keywords
                )
                arguments: dict[str, ast.expr] = dict(zip(names, node.args, strict=False))
                arguments |= {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
                extra = len(node.args) - len(names)
                yield Creation(method, node, None if stars else arguments, extra, owner, function, source)

    def scoped(self, source: PythonSource) -> Sequence[Scoped]:
        """Return everything in a file with the class and the function in which it stands."""
        if source not in self._scoped:
            self._scoped[source] = tuple(self._within(source, source.tree, None, None))
        return self._scoped[source]

    def _within(
        self, source: PythonSource, parent: ast.AST, owner: NodeClass | None, function: Function | None
    ) -> Iterator[Scoped]:
        for node in children(parent):
            yield owner, function, node
            if isinstance(node, ast.ClassDef):
                inner = self.classes.get(f"{source.name}.{node.name}")
                yield from self._within(source, node, inner, None)
            elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                yield from self._within(source, node, owner, node)
            else:
                yield from self._within(source, node, owner, function)

    def value(self, source: PythonSource, node: ast.expr | None) -> Any:
        """Return what an expression is, where the file's constants tell it; else `UNKNOWN`."""
        known = evaluate(node, source.constants, {})
        if known is UNKNOWN and node is not None:
            name = source.resolve(node) or ""
            module, _, rest = name.rpartition(".")
            if module in self.sources:
                return self.sources[module].constants.get(rest, UNKNOWN)
        return known

    def written(self, source: PythonSource, node: ast.expr | None) -> ast.expr | None:
        """Return the expression that a name stands for which the file assigns only once; any other as it is."""
        if not isinstance(node, (ast.Name, ast.Attribute)):
            return node
        text = ast.unparse(node)
        stored = [
            n for n in source.nodes if isinstance(n, (ast.Name, ast.Attribute)) and ast.unparse(n) == text
        ]
        stored = [n for n in stored if isinstance(n.ctx, ast.Store)]
        given = [n.value for n in source.nodes if isinstance(n, ast.Assign) and n.targets == stored]
        return given[0] if len(stored) == len(given) == 1 else node

    def callbacks(self) -> Iterator[tuple[Creation, Function]]:
        """Yield the package's own functions that ROS calls, with the call that hands them over."""
        for creation in self.creations:
            given = (creation.arguments or {}).get("callback")
            function = self.function_of(creation, given)
            if function is not None:
                yield creation, function

    def function_of(self, creation: Creation, given: ast.expr | None) -> Function | None:
        """Return the function or method that is given as a callback, if it is one of the package's own."""
        if is_self_attribute(given):
            return self.method(creation.owner, given.attr)
        if isinstance(given, ast.Name) and creation.function is not None:
            for node in own_nodes(creation.function):
                if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.name == given.id:
                    return node
        found = self.functions.get(self.resolve(creation.source, given) or "")
        return found[1] if found else None

    def node_name(self, creation: Creation) -> str:
        """Return the whole name, without its first slash, of the node that creates something; empty if it is not known."""
        owners = self.lineage(creation.owner)[0] if creation.owner else [None]
        names = {
            self._whole_name(source, node)
            for source in {one.source if one else creation.source for one in owners}
            for owner, function, node in self.scoped(source)
            if owner in owners and isinstance(node, ast.Call)
            if self.makes_node(source, owner, function, node)
        }
        return names.pop() if len(names) == 1 else ""

    def _whole_name(self, source: PythonSource, call: ast.Call) -> str:
        """Return the name that a call gives a node, after its namespace; empty if one of them is not known."""
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        name = self.value(source, given.get("node_name") or next(iter(call.args), None))
        space = self.value(source, given["namespace"]) if "namespace" in given else ""
        are_known = isinstance(name, str) and isinstance(space, str) and None not in given
        return f"{space.strip('/')}/{name}".lstrip("/") if are_known else ""

    def around(self, module: str) -> NodeSources | None:
        """Return the files that run together with one: what it imports, and what imports it.

        None if something outside of them takes part in their nodes, so that these hold more than is seen.
        """
        own = NodeSources({name: self.sources[name] for name in self.together(module)})
        is_seen = not any(source.fault or own.hands_itself_on(source) for source in own.sources.values())
        return own if is_seen and all(own.lineage(one)[2] for one in own.nodes) else None

    def together(self, module: str) -> list[str]:
        """Return the names of the files that run together with one: what it imports, and what imports it."""
        return sorted({name for reached in self._reached.values() if module in reached for name in reached})

    @cached_property
    def _reached(self) -> Mapping[str, frozenset[str]]:
        """The files that each one imports, and what these import; itself is among them."""
        found = {}
        for name in self.sources:
            reached, waiting = {name}, [name]
            while waiting:
                targets = (one.target for one in self.sources[waiting.pop()].imports)
                new = {to for target in targets for to in (target, target.rpartition(".")[0])}
                new = (new & self.sources.keys()) - reached
                reached |= new
                waiting += new
            found[name] = frozenset(reached)
        return found

    def hands_itself_on(self, source: PythonSource) -> bool:
        """Return whether a node is given to something outside these files, which may use it as its own."""
        for node in source.nodes:
            if isinstance(node, ast.Call) and any(
                getattr(one, "id", "") in ("self", "node")
                for one in (*node.args, *(keyword.value for keyword in node.keywords))
            ):
                name = self.resolve(source, node.func)
                is_own = name in self.functions or name in self.classes
                if name and not is_own and not name.startswith(("rclpy.", "super")) and "." in name:
                    return True
        return False

    def node_names(self) -> dict[str, tuple[PythonSource, ast.expr]]:
        """Return the names that nodes are given, with where; the key "" stands for one that is not known."""
        found: dict[str, tuple[PythonSource, ast.expr]] = {}
        unnamed = {id(one) for one in self.classes.values() if self._might_be_node(one)}
        for source in self.sources.values():
            for owner, function, node in self.scoped(source):
                if isinstance(node, ast.Call) and self.makes_node(source, owner, function, node):
                    unnamed.discard(id(owner))
                    given = [k.value for k in node.keywords if k.arg == "node_name"] or node.args[:1]
                    name = self.value(source, given[0]) if given else UNKNOWN
                    found[name if isinstance(name, str) else ""] = (source, given[0] if given else node)
        # One that says no name, or cannot be read, may have any.
        is_blank = any(
            source.fault or not (source.text.strip() or source.is_package) for source in self.sources.values()
        )
        if unnamed or is_blank:
            found[""] = next(iter(found.values()), (next(iter(self.sources.values())), ast.Constant("")))
        return found

    def full_names(self) -> dict[str, str]:
        """Return the full names of nodes, such as `/hall/guide`, by their last parts; without those not known."""
        found: dict[str, set[str]] = {}
        for source in self.sources.values():
            for owner, function, node in self.scoped(source):
                if isinstance(node, ast.Call) and self.makes_node(source, owner, function, node):
                    whole = self._whole_name(source, node)
                    found.setdefault(whole.rpartition("/")[2], set()).add(f"/{whole}")
        return {name: full.pop() for name, full in found.items() if name and len(full) == 1}

    def _might_be_node(self, one: NodeClass) -> bool:
        names = [ast.unparse(base) for base in one.definition.bases]
        has_name = "__init__" in one.methods and any(self._handed(base) in self.classes for base in one.bases)
        return any(name.endswith("Node") for name in names) and not has_name

    def makes_node(
        self, source: PythonSource, owner: NodeClass | None, function: Function | None, node: ast.Call
    ) -> bool:
        """Return whether a call hands a name to rclpy's Node: `super().__init__`, `Node(...)`, `create_node(...)`."""
        name = self.resolve(source, node.func)
        if name in NODE_CLASSES or name == "rclpy.create_node":
            return True
        is_init = isinstance(node.func, ast.Attribute) and node.func.attr == "__init__"
        if not is_init or owner is None or function is None or function.name != "__init__":
            return False
        return bool({self._handed(base) for base in owner.bases} & NODE_CLASSES)
