"""Find the node classes of a package and what they create, from its sources."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeGuard

from ros2lab.diagnose.sources.beyond import NOTHING, Beyond
from ros2lab.diagnose.sources.handed_on import given_from_outside
from ros2lab.diagnose.sources.interfaces import node_members
from ros2lab.diagnose.sources.known_values import value_of
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    argument,
    children,
    given_to,
    names_bound,
    own_nodes,
    walk,
)
from ros2lab.diagnose.sources.syntax_parts import by_parameter, is_property

_MANAGED = (f"rclpy.lifecycle.{name}" for name in ("Node", "LifecycleNode", "node.LifecycleNode"))
NODE_CLASSES = frozenset(("rclpy.node.Node", *_MANAGED))
# The methods with which a node creates something, with their parameters in order.
CREATORS: Mapping[str, tuple[str, ...]] = {
    "create_publisher": ("msg_type", "topic", "qos_profile"),
    "create_subscription": ("msg_type", "topic", "callback", "qos_profile"),
    "create_timer": ("timer_period_sec", "callback"),
    "create_service": ("srv_type", "srv_name", "callback"),
    "create_client": ("srv_type", "srv_name"),
}
_ALSO = {"create_lifecycle_publisher": "create_publisher"}  # methods with the same parameters
LOG_METHODS = frozenset(("debug", "info", "warn", "warning", "error", "fatal"))


@dataclass(frozen=True, eq=False)
class Creation:
    """A call such as `self.create_publisher(String, '/robot/status', 10)`.

    Attributes:
        arguments: the arguments by parameter name; None if a star hides them.
        owner: the class that contains the call; None outside a class.
        function: the function that contains the call; None outside a function.
    """

    method: str
    call: ast.Call
    arguments: dict[str, ast.expr] | None
    owner: NodeClass | None
    function: Function | None
    source: PythonSource

    def given(self, *names: str) -> ast.expr | None:
        """Return the argument for the first of these parameters that has one; None if that is not known."""
        arguments = self.arguments or {}
        return next((arguments[name] for name in names if name in arguments), None)

    @property
    def kept(self) -> str:
        """What it is assigned to, such as `self.pub`; empty if to nothing."""
        return self.source.name_of(self.call)


@dataclass(eq=False)
class NodeClass:
    """A class of the package.

    Attributes:
        name: its name with the module, such as `pk.talk.Talk`.
        bases: the full names of its base classes; None for one that is not known.
    """

    name: str
    definition: ast.ClassDef
    source: PythonSource
    bases: tuple[str | None, ...]

    @cached_property
    def functions(self) -> tuple[Function, ...]:
        """All functions in its body, including a property's getter and setter, which share a name."""
        return tuple(node for node in self.definition.body if isinstance(node, Function))

    @cached_property
    def methods(self) -> Mapping[str, Function]:
        """Its own methods by name."""
        return {function.name: function for function in self.functions}

    @cached_property
    def attributes(self) -> frozenset[str]:
        """The names of the attributes that it assigns to itself or its class, or defines in its body."""
        found = set[str]()
        holders = {"self", "cls", "type(self)", "self.__class__", self.definition.name}
        for node in walk(self.definition):
            if self.source.gives(node):
                found |= {node.attr} if ast.unparse(node.value) in holders else set()
        # Only names in the body of the class; a name that a method binds is local.
        inner = own_nodes(self.definition)
        defined = {node.name for node in inner if isinstance(node, (Function, ast.ClassDef))}
        return frozenset(found | names_bound(inner) | defined)


def is_self_attribute(node: ast.AST | None) -> TypeGuard[ast.Attribute]:
    """Return whether a node is an attribute of a class's self, such as `self.count`; that of an inner class is another."""
    is_of_self = isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "self"
    return is_of_self and not hasattr(node, "is_inner")


Scoped = tuple[NodeClass | None, Function | None, ast.AST]


class NodeSources:
    """The classes and functions of some Python files, which may import each other.

    Args:
        sources: the files by the names of their modules.
        used: what executables and other packages use of them, such as `pk.talk.main`; empty if not known.
        beyond: what else the files may import; nothing if that is not known.
    """

    def __init__(
        self, sources: Mapping[str, PythonSource], used: Collection[str] = (), beyond: Beyond = NOTHING
    ) -> None:
        self.sources = sources
        self.used = used
        self.beyond = beyond
        self.classes: dict[str, NodeClass] = {}
        self.functions: dict[str, tuple[PythonSource, Function]] = {}
        self._scoped: dict[PythonSource, tuple[Scoped, ...]] = {}
        self._given: dict[NodeClass, frozenset[str] | None] = {}
        for name, source in sources.items():
            for own, definition in source.classes.items():
                bases = tuple(map(source.resolve, definition.bases))
                self.classes[f"{name}.{own}"] = NodeClass(f"{name}.{own}", definition, source, bases)
            for own, function in source.functions.items():
                self.functions[f"{name}.{own}"] = (source, function)

    def resolve(self, source: PythonSource, node: ast.AST | None) -> str | None:
        """Return the full name that a name stands for, even if a file re-exports what it imports."""
        return self._origin(source.resolve(node))

    def _origin(self, name: str | None) -> str | None:
        for _ in range(5):
            if name is None or name in self.classes or name in self.functions:
                return name
            module, _, rest = name.rpartition(".")
            handed_on = home.names.get(rest) if (home := self.file(module)) else None
            if handed_on in (None, name):
                return name
            name = handed_on
        return name

    def lineage(self, node_class: NodeClass) -> tuple[list[NodeClass], bool, bool]:
        """Return a class with its own bases, whether it is a node, and whether all of its bases are known."""
        chain, is_node, is_known = [node_class], False, True
        for base in map(self._origin, node_class.bases):
            if base in NODE_CLASSES:
                is_node = True
            elif base in self.classes and self.classes[base] is not node_class and len(chain) < 20:
                inner, inner_is_node, inner_is_known = self.lineage(self.classes[base])
                chain += inner
                is_node |= inner_is_node
                is_known &= inner_is_known
            elif base not in ("object", "abc.ABC"):
                is_known = False
        return chain, is_node, is_known

    @cached_property
    def nodes(self) -> list[NodeClass]:
        """The classes that are nodes."""
        return [node_class for node_class in self.classes.values() if self.lineage(node_class)[1]]

    def is_managed(self, node_class: NodeClass) -> bool:
        """Return whether a class is a managed node, for which others decide when it publishes."""
        return any(
            base and "lifecycle" in base for inner in self.lineage(node_class)[0] for base in inner.bases
        )

    def attributes(self, node_class: NodeClass) -> frozenset[str]:
        """Return the attributes of a class and its bases from these files."""
        return frozenset(name for inner in self.lineage(node_class)[0] for name in inner.attributes)

    def method(self, owner: NodeClass | None, name: str) -> Function | None:
        """Return a method of a class or its bases; None if there is none, or if it is a property."""
        chain = self.lineage(owner)[0] if owner else []
        found = next((node_class.methods[name] for node_class in chain if name in node_class.methods), None)
        return None if found is None or is_property(found) else found

    def members(self, node_class: NodeClass) -> frozenset[str] | None:
        """Return every attribute that `self` has in a class; None if they are not all known."""
        _, is_node, is_known = self.lineage(node_class)
        inherited = node_members()
        given = self.given(node_class) if is_node and is_known and inherited else None
        if given is None or self.is_managed(node_class):
            return None
        return inherited | frozenset(dir(type("Any", (), {}))) | self.attributes(node_class) | given

    def given(self, node_class: NodeClass) -> frozenset[str] | None:
        """Return the attributes that other code gives the instances of a class; None if they are not all known."""
        if node_class not in self._given:
            chain = {inner.name: (inner.source, inner.definition) for inner in self.lineage(node_class)[0]}
            self._given[node_class] = given_from_outside(self.sources, chain)
        return self._given[node_class]

    def members_at(self, source: PythonSource, node: ast.AST) -> frozenset[str]:
        """Return every attribute that `self` has at a node of the syntax tree; empty outside a class."""
        for node_class in self.classes.values():
            if node_class.source is source and node in walk(node_class.definition):
                return self.members(node_class) or node_class.attributes
        return frozenset()

    @cached_property
    def creations(self) -> list[Creation]:
        """Every call that creates a publisher, a subscription, a timer, a service or a client."""
        own = {name for node_class in self.classes.values() for name in node_class.methods}
        methods = {name: names for name, names in CREATORS.items() if name not in own}
        return [
            creation
            for source in self.sources.values()
            if any(
                imported.target.partition(".")[0] in ("rclpy", source.name.partition(".")[0])
                for imported in source.imports
            )
            for creation in self._creations_in(source, methods)
        ]

    def _creations_in(
        self, source: PythonSource, methods: Mapping[str, tuple[str, ...]]
    ) -> Iterator[Creation]:
        modules = {imported.local for imported in source.imports if not imported.is_from}
        for owner, function, node in self.scoped(source):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Attribute)
                and ast.unparse(node.func.value) not in modules
                and (method := _ALSO.get(node.func.attr, node.func.attr)) in methods
            ):
                names = methods[method]
                if self.is_node(self.resolve(source, node.func.value)):  # as in Node.create_timer(self, ...)
                    names = ("self", *names)
                is_hidden = any(isinstance(a, ast.Starred) for a in node.args)
                is_hidden |= None in {keyword.arg for keyword in node.keywords}
                arguments = None if is_hidden else by_parameter(node, names)
                yield Creation(method, node, arguments, owner, function, source)

    def scoped(self, source: PythonSource) -> Sequence[Scoped]:
        """Return every syntax node of a file with the class and the function around it."""
        if source not in self._scoped:
            self._scoped[source] = tuple(self._within(source, source.tree, None, None))
        return self._scoped[source]

    def _within(
        self, source: PythonSource, parent: ast.AST, owner: NodeClass | None, function: Function | None
    ) -> Iterator[Scoped]:
        for node in children(parent):
            yield owner, function, node
            if isinstance(node, ast.ClassDef):
                inner = None if hasattr(node, "is_inner") else self.classes.get(f"{source.name}.{node.name}")
                yield from self._within(source, node, inner, None)
            elif isinstance(node, Function):
                yield from self._within(source, node, owner, node)
            else:
                yield from self._within(source, node, owner, function)

    def value(self, source: PythonSource, node: ast.expr | None) -> Any:
        """Return the value of an expression, from the constants of the files; `UNKNOWN` if not known."""
        return value_of(self, source, node)

    def file(self, module: str) -> PythonSource | None:
        """Return the file of a module of the workspace; None if there is none."""
        return self.sources.get(module) or self.beyond.modules.get(module)

    def callbacks(self) -> Iterator[tuple[Creation, Function]]:
        """Yield the package's callbacks, each with the call that passes it to ROS."""
        for creation in self.creations:
            function = self.function_of(creation, creation.given("callback"))
            if function is not None:
                yield creation, function

    def function_of(self, creation: Creation, given: ast.expr | None) -> Function | None:
        """Return the function or method passed as a callback; None if it is not defined in the package."""
        if is_self_attribute(given):
            return self.method(creation.owner, given.attr)
        if isinstance(given, ast.Name) and creation.function is not None:
            for node in own_nodes(creation.function):
                if isinstance(node, Function) and node.name == given.id:
                    return node
        found = self.functions.get(self.resolve(creation.source, given) or "")
        return found[1] if found else None

    def node_name(self, creation: Creation) -> str:
        """Return the full name, without the first slash, of a creation's node; empty if not known."""
        owners = self.lineage(creation.owner)[0] if creation.owner else [None]
        files = {node_class.source if node_class else creation.source for node_class in owners}
        made = (entry for entry in self._made_nodes if entry[0] in files and entry[1] in owners)
        names = {self._whole_name(source, call) for source, _, call in made}
        return names.pop() if len(names) == 1 else ""

    def _whole_name(self, source: PythonSource, call: ast.Call) -> str:
        """Return the namespace and name that a call gives a node, joined; empty if not known."""
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        name = self.value(source, given.get("node_name") or next(iter(call.args), None))
        space = self.value(source, given["namespace"]) if "namespace" in given else ""
        are_known = isinstance(name, str) and isinstance(space, str) and None not in given
        return f"{space.strip('/')}/{name}".lstrip("/") if are_known else ""

    def around(self, module: str) -> NodeSources | None:
        """Return the files that run together with a module: what it imports, and what imports it.

        None if code outside these files may use their nodes, so that not all of it is seen.
        """
        own = NodeSources({name: self.sources[name] for name in self.together(module)}, beyond=self.beyond)
        is_seen = not any(source.fault or own.hands_itself_on(source) for source in own.sources.values())
        return own if is_seen and all(own.lineage(node_class)[2] for node_class in own.nodes) else None

    def together(self, module: str) -> list[str]:
        """Return the names of the files that run together with a module: what it imports, what imports it."""
        return sorted({name for reached in self._reached.values() if module in reached for name in reached})

    def imported_by(self, module: str) -> list[str]:
        """Return the names of the files that run when a module is imported, itself and its packages included."""
        reached = self._reached.get(module, frozenset())
        names = {name.rsplit(".", depth)[0] for name in reached for depth in range(name.count(".") + 1)}
        return sorted(names & self.sources.keys())

    def may_import(self, source: PythonSource) -> bool:
        """Return whether an executable may run a file."""
        return source.name in self._run

    @cached_property
    def _run(self) -> frozenset[str]:
        """The files that executables may run: all where that is not known."""
        may_be_any = any(
            source.fault or "import_module" in source.text or "__import__" in source.text
            for source in self.sources.values()
        )
        modules = {part for name in self.used for part in (name, name.rpartition(".")[0])}
        run = frozenset(name for module in modules for name in self.imported_by(module))
        return frozenset(self.sources) if may_be_any or not run else run

    def is_named(self, owner: NodeClass) -> bool:
        """Return whether anything outside a class names it, so that it may be created or have subclasses."""
        short = owner.definition.name
        if owner.name in self.used or owner.source.name in self.used:
            return True
        own = {id(node) for node in walk(owner.definition)}
        return any(
            short in (getattr(node, "id", ""), getattr(node, "attr", ""), getattr(node, "value", ""))
            for source in self.sources.values()
            for node in source.nodes
            if id(node) not in own
        )

    @cached_property
    def _reached(self) -> Mapping[str, frozenset[str]]:
        """The files that each file imports, directly or indirectly, itself included."""
        found = {}
        for name in self.sources:
            reached, waiting = {name}, [name]
            while waiting:
                targets = (imported.target for imported in self.sources[waiting.pop()].imports)
                new = {to for target in targets for to in (target, target.rpartition(".")[0])}
                new = (new & self.sources.keys()) - reached
                reached |= new
                waiting += new
            found[name] = frozenset(reached)
        return found

    def calls_to(self, name: str) -> list[ast.Call]:
        """Return the calls in the files of what has a full name."""
        files = self.sources.values()
        return [call for file in files for call in file.calls if self.resolve(file, call.func) == name]

    def hands_itself_on(self, source: PythonSource) -> bool:
        """Return whether a file passes a node to code outside these files, which may use it."""
        for call in source.calls:
            if any(getattr(argument, "id", "") in ("self", "node") for argument in given_to(call)):
                name = self.resolve(source, call.func)
                is_own = name in self.functions or name in self.classes
                if name and not is_own and not name.startswith(("rclpy.", "super")) and "." in name:
                    return True
        return False

    @cached_property
    def node_names(self) -> Mapping[str, tuple[PythonSource, ast.expr]]:
        """The names of the nodes, each with its file and expression; "" stands for an unknown name."""
        found: dict[str, tuple[PythonSource, ast.expr]] = {}
        unnamed = {id(node_class) for node_class in self.classes.values() if self._might_be_node(node_class)}
        for source, owner, call in self._made_nodes:
            unnamed.discard(id(owner))
            given = argument(call, 0, "node_name")
            name = self.value(source, given)
            found[name if isinstance(name, str) else ""] = (source, given or call)
        # A class without a name for its node, or a file that cannot be read, may use any name.
        is_blank = any(
            source.fault or not (source.text.strip() or source.is_package) for source in self.sources.values()
        )
        if unnamed or is_blank:
            found[""] = next(iter(found.values()), (next(iter(self.sources.values())), ast.Constant("")))
        return found

    @cached_property
    def full_names(self) -> Mapping[str, str]:
        """The known full names of nodes, such as `/hall/guide`, by their last parts."""
        found: dict[str, set[str]] = {}
        for source, _, call in self._made_nodes:
            whole = self._whole_name(source, call)
            found.setdefault(whole.rpartition("/")[2], set()).add(f"/{whole}")
        return {name: full.pop() for name, full in found.items() if name and len(full) == 1}

    def _might_be_node(self, node_class: NodeClass) -> bool:
        names = [ast.unparse(base) for base in node_class.definition.bases]
        has_name = "__init__" in node_class.methods and any(
            base in self.classes for base in map(self._origin, node_class.bases)
        )
        return any(name.endswith("Node") for name in names) and not has_name

    @cached_property
    def _made_nodes(self) -> list[tuple[PythonSource, NodeClass | None, ast.Call]]:
        """The calls that make a node, each with its file and the class around it."""
        return [
            (source, owner, node)
            for source in self.sources.values()
            for owner, function, node in self.scoped(source)
            if isinstance(node, ast.Call) and self.makes_node(source, owner, function, node)
        ]

    def is_node(self, name: str | None) -> bool:
        """Return whether what has a full name makes a node when it is called."""
        own = self.classes.get(name or "")
        return (
            name in NODE_CLASSES or name == "rclpy.create_node" or (own is not None and self.lineage(own)[1])
        )

    def makes_node(
        self, source: PythonSource, owner: NodeClass | None, function: Function | None, node: ast.Call
    ) -> bool:
        """Return whether a call passes a name to rclpy's Node, as `Node(...)` or `super().__init__` does."""
        name = self.resolve(source, node.func)
        if name in NODE_CLASSES or name == "rclpy.create_node":
            return True
        is_init = isinstance(node.func, ast.Attribute) and node.func.attr == "__init__"
        if not is_init or owner is None or function is None or function.name != "__init__":
            return False
        return any(base in NODE_CLASSES for base in map(self._origin, owner.bases))
