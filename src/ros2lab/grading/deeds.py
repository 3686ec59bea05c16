"""What code that runs would do with an end of a topic, if nothing kept it from that: as far as reading tells.

What could not be tried where it is graded is excused only as far as it stands in the code.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator
from functools import cached_property

from ros2lab.diagnose.node_source import LOG_METHODS, Creation, NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes
from ros2lab.grading.running import Code

# What an end's code does: publish on it; read what comes, log something now and then, name all of the commands.
PUBLISHES, READS, LOGS, COMPARES = "publishes", "reads", "logs", "compares"
# What a line of code would have to do, in a clause.
CLAUSES = {
    PUBLISHES: "publishes there",
    READS: "looks at what comes there",
    LOGS: "logs what comes",
    COMPARES: "names all of the commands",
}

_SAYING = LOG_METHODS | {"log", "exception", "write"}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Za-z][a-z]*")  # of a text or a name


class Deeds:
    """What the code of some files does with the ends that it makes.

    Args:
        sources: the files.
        code: that runs.
        words: the commands that a subscription may get.
    """

    def __init__(self, sources: NodeSources, code: Code, words: Collection[str]) -> None:
        self._sources = sources
        self._code = {node for _, node in code}
        self._words = words

    def of(self, creation: Creation) -> list[str] | None:
        """Return what is done with what a call makes; None if that is not known."""
        if creation.method == "create_publisher":
            return [PUBLISHES] if self._publishes(creation) else []
        is_read = self._is_read(creation)
        if is_read is None:
            return None
        does = {READS: is_read, LOGS: self._logs, COMPARES: self._compares}
        return [deed for deed, is_done in does.items() if is_done]

    def _publishes(self, creation: Creation) -> bool:
        """Return whether a publisher is told to publish, or is handed on where something publishes."""
        if not self._is_publish_named:
            return False
        parent = next((n for n in creation.source.nodes if creation.call in ast.iter_child_nodes(n)), None)
        match parent:
            case ast.Expr():
                return False
            case ast.Assign(targets=targets):
                pass
            case ast.AnnAssign(target=target):
                targets = [target]
            case _:
                return True
        names = {_last(target) for target in targets}
        return "" in names or any(
            self._asked_of.get(node, "publish") == "publish"
            for module in self._sources.together(creation.source.name)
            for owner, _, node in self._sources.scoped(self._sources.sources[module])
            if _names(node) in names and node in self._code and self._is_of(creation, owner, node)
        )

    def _is_of(self, creation: Creation, owner: NodeClass | None, node: ast.AST) -> bool:
        """Return whether what stands in a class may be the end that was made, for it is not of another class's self."""
        if not (is_self_attribute(node) and owner and creation.owner):
            return True
        lines = (self._sources.lineage(one)[0] for one in (owner, creation.owner))
        return not {*next(lines)}.isdisjoint(next(lines))

    @cached_property
    def _is_publish_named(self) -> bool:
        return any(_names(node) == "publish" for node in self._code)

    @cached_property
    def _asked_of(self) -> dict[ast.AST, str]:
        """What is asked of an expression: `publish` of `self.publisher` in `self.publisher.publish`."""
        return {node.value: node.attr for node in self._code if isinstance(node, ast.Attribute)}

    def _is_read(self, creation: Creation) -> bool | None:
        """Return whether a callback looks at what it is given; None if it is not known which one it is."""
        given = (creation.arguments or {}).get("callback")
        function = given if isinstance(given, ast.Lambda) else self._sources.function_of(creation, given)
        if function is None:
            return None
        names = [one.arg for one in (*function.args.posonlyargs, *function.args.args) if one.arg != "self"]
        if not names:
            return function.args.vararg is not None
        return any(_names(node) == names[0] for node in ast.walk(function) if node in self._code)

    @cached_property
    def _logs(self) -> bool:
        """Return whether something is logged or printed more than once: by a callback, or in a loop."""
        return any(
            _says(node) and (node in loops or not self._is_once(source, function)) and node not in handlers
            for source in self._sources.sources.values()
            for loops in [{*_within(source, ast.While, ast.For)}]
            for handlers in [{*_within(source, ast.ExceptHandler)}]
            for _, function, node in self._sources.scoped(source)
            if node in self._code
        )

    def _is_once(self, source: PythonSource, function: Function | None) -> bool:
        """Return whether a function only begins or starts a node, or is none at all."""
        return (
            function is None
            or function.name == "__init__"
            or any(
                self._sources.resolve(source, node.func) in ("rclpy.init", "rclpy.init.init")
                for node in own_nodes(function)
                if isinstance(node, ast.Call)
            )
        )

    @cached_property
    def _compares(self) -> bool:
        """Return whether each of the commands stands in the code, as a text or in a name that it gives.

        A text that is only logged, or describes the code, tells no words apart.
        """
        told = set[ast.AST]()
        for node in self._code:
            match node:
                case ast.Expr(value=ast.Constant() as text):
                    told.add(text)
                case ast.Call(func=function) if _says(function):
                    told |= {part for given in node.args for part in (given, *ast.iter_child_nodes(given))}
        found = {
            word.lower() for node in self._code if node not in told for word in _WORD.findall(_given(node))
        }
        return {*self._words} <= found


def _last(target: ast.expr) -> str:
    """Return the last part of what something is kept as; empty if that is no name."""
    match target:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
    return ""


def _names(node: ast.AST) -> str:
    """Return the name by which something is used, or looked up."""
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name, ctx=ast.Load()):
            return name
        case ast.Call(func=ast.Name(id="getattr"), args=[_, ast.Constant(value=str(name)), *_]):
            return name
    return ""


def _given(node: ast.AST) -> str:
    """Return the text that a constant is, or the name that is given to something."""
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.Name(id=name, ctx=ast.Store()) | ast.FunctionDef(name=name):
            return name
    return ""


def _says(node: ast.AST) -> bool:
    match node:
        case ast.Name(id="print", ctx=ast.Load()):
            return True
        case ast.Attribute(attr=name, ctx=ast.Load()):
            return name in _SAYING
    return False


def _within(source: PythonSource, *kinds: type[ast.AST]) -> Iterator[ast.AST]:
    """Yield everything in a file that stands in a statement of some kinds."""
    for node in source.nodes:
        if isinstance(node, kinds):
            yield from ast.walk(node)
