"""What running code does with an end of a topic, as far as its names tell.

What cannot be given during grading, such as a package that is not installed, is excused only if the code has it.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator
from dataclasses import replace
from functools import cached_property

from ros2lab.diagnose.sources.interfaces import fields_of
from ros2lab.diagnose.sources.node_source import LOG_METHODS, Creation, NodeSources
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes
from ros2lab.grading.code.publishing import Publishing, name_read
from ros2lab.grading.evidence import WrittenEnd

# What code does with a publisher: publish, again and again. With a subscription: read the messages, log something
# now and then, name all of the commands.
PUBLISHES, REPEATS = "publishes", "repeats"
VARIES = "varies"  # publish now this and now that
READS, LOGS, COMPARES = "reads", "logs", "compares"
# What a line of code would have to do, as a clause.
CLAUSES = {
    PUBLISHES: "publishes there",
    REPEATS: "publishes there again and again",
    READS: "looks at what comes there",
    LOGS: "logs what comes",
    COMPARES: "names all of the commands",
}

_SAYING = LOG_METHODS | {"log", "exception", "write"}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Za-z][a-z]*")  # in a text or a name


class Deeds:
    """What the code of some files does with the ends that it creates.

    Args:
        sources: the files.
        code: the nodes that run while a program lives.
        words: the commands that a subscription may receive.
    """

    def __init__(self, sources: NodeSources, code: frozenset[ast.AST], words: Collection[str]) -> None:
        self._sources = sources
        self._code = code
        self._words = words
        self._publishing = Publishing(sources, code)

    def entered(self, end: WrittenEnd, creation: Creation) -> WrittenEnd:
        """Return an end with what is done and never done with what a call creates."""
        if self._publishing.is_destroyed(creation):
            return replace(end, does=[])
        if not end.is_publisher:
            return replace(end, does=self._of_subscription(creation))
        uses = self._publishing.uses(creation)
        if uses is None:
            return replace(end, does=[PUBLISHES])
        rhythm = self._publishing.rhythm(uses)
        never = {REPEATS: not rhythm.repeats, VARIES: self._publishing.is_always_same(uses)}
        return replace(
            end,
            does=[PUBLISHES] if uses else [],
            never=[deed for deed, is_never in never.items() if uses and is_never],
            begins=rhythm.begins,
        )

    def _of_subscription(self, creation: Creation) -> list[str]:
        does = {READS: self._is_read(creation), LOGS: self._logs, COMPARES: self._compares}
        return [deed for deed, is_done in does.items() if is_done]

    def _is_read(self, creation: Creation) -> bool:
        """Return whether a subscription's callback reads its message.

        One that is not known does if any line reads a field of such a message.
        """
        kind = self._sources.resolve(creation.source, creation.given("msg_type"))
        fields = fields_of(kind)
        given = creation.given("callback")
        function = given if isinstance(given, ast.Lambda) else self._sources.function_of(creation, given)
        if function is None:
            return fields is None or any(name_read(node) in fields for node in self._code)
        names = [
            parameter.arg
            for parameter in (*function.args.posonlyargs, *function.args.args)
            if parameter.arg != "self"
        ]
        if not names:
            return function.args.vararg is not None
        wrong = {
            node.value
            for node in ast.walk(function)
            if isinstance(node, ast.Attribute) and fields is not None and _is_no_field(node.attr, fields)
        }
        return any(
            name_read(node) == names[0] and node not in wrong
            for node in ast.walk(function)
            if node in self._code
        )

    @cached_property
    def _logs(self) -> bool:
        """Whether something is logged or printed more than once: by a callback, or in a loop."""
        return any(
            _says(node) and (node in loops or not self._is_once(source, function)) and node not in handlers
            for source in self._sources.sources.values()
            for loops in [{*_within(source, ast.While, ast.For)}]
            for handlers in [{*_within(source, ast.ExceptHandler)}]
            for _, function, node in self._sources.scoped(source)
            if node in self._code
        )

    def _is_once(self, source: PythonSource, function: Function | None) -> bool:
        """Return whether code runs only once: outside functions, in `__init__`, or beside `rclpy.init`."""
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
        """Whether all of the commands are in the code, as a text or in the name of a variable or a function.

        A text that is only logged, or describes the code, does not count.
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


def _is_no_field(name: str, fields: Collection[str]) -> bool:
    """Return whether a message has no such attribute: neither a field nor one that all messages have."""
    return name not in fields and not name.startswith(("_", "get_", "SLOT"))


def _given(node: ast.AST) -> str:
    """Return the text of a constant, or the name that is assigned or defined; empty for any other node."""
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
    """Yield the statements of some kinds in a file, and all nodes in them."""
    for node in source.nodes:
        if isinstance(node, kinds):
            yield from ast.walk(node)
