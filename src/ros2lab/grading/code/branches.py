"""What the code does with each text that it compares a value from a message with, as far as it is plain.

That counts only for a text that nobody could send: what a branch has no line for is not logged, and what it leaves
the program with is no answer. Where the branch of a text is not known, nothing is said of it.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Collection, Iterable

from ros2lab.diagnose.finding import Finding, fails_there
from ros2lab.diagnose.sources.node_source import LOG_METHODS
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.grading.code.compared import compared
from ros2lab.grading.code.dependence import Flow
from ros2lab.grading.code.paths import ends_program
from ros2lab.grading.code.publishing import name_read
from ros2lab.grading.code.running import Code

MUTE, LAST = "mute", "last"  # a branch has no line for the log; it ends the program
_SAYING = LOG_METHODS - {"debug"} | {"log", "exception", "write", "print"}
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_Branch = tuple[PythonSource, ast.If | ast.match_case]


def branches(
    sources: Collection[PythonSource], code: Code, words: Collection[str], findings: Iterable[Finding] = ()
) -> dict[str, list[str]]:
    """Return by word what the branch that it opens plainly is; nothing of those that are neither.

    Args:
        sources: the files.
        code: the code that runs.
        words: the words.
        findings: what `diagnose` finds in the files.
    """
    flow, failing = Flow(sources, code), {finding.place for finding in findings if fails_there(finding)}
    opened = defaultdict[str, list[_Branch]](list)
    unknown = set[str]()
    for source in sources:
        for node in filter(flow.tells_apart, flow.code.intersection(source.nodes)):
            branch = _opened_by(flow, node)
            for text in compared([node]):
                unknown |= set() if branch else {text}
                opened[text] += [(source, branch)] if branch else []
    around = _Around(flow)
    found = defaultdict[str, list[str]](list)
    for text in {*words} & opened.keys() - unknown:
        others = {node for other, found in opened.items() if other != text for node in _inside(found)}
        if not around.says(opened[text], others - _inside(opened[text])):
            found[text].append(MUTE)
        if all(_leaves(flow, source, branch, failing) for source, branch in opened[text]):
            found[text].append(LAST)
    return dict(found)


def _opened_by(flow: Flow, node: ast.AST) -> ast.If | ast.match_case | None:
    """Return the branch that a comparison by itself opens; None if it opens none, or not alone."""
    above = flow.parents.get(node)
    match node, above:
        case ast.Compare(ops=[ast.Eq()]), ast.If(test=test) if test is node:
            return above
        case ast.MatchValue(), ast.match_case(guard=None):
            return above
    return None


def _inside(opened: Iterable[_Branch]) -> set[ast.AST]:
    return {node for _, branch in opened for part in branch.body for node in walk(part)}


class _Around:
    """What is around the branches of some code, and what they lead to."""

    def __init__(self, flow: Flow) -> None:
        self._flow = flow
        self._readers = defaultdict[str, set[ast.AST | None]](
            set
        )  # the functions that read a name, and that call it
        self._callers = defaultdict[str, set[ast.AST | None]](set)
        self._is_handed_on = any(_is_said_elsewhere(flow, node) for node in flow.code)
        for node in flow.code:
            if name := name_read(node):
                function = flow.above(node, *_FUNCTIONS)
                self._readers[name].add(function)
                above = flow.parents.get(node)
                if isinstance(above, ast.Call) and above.func is node:
                    self._callers[name].add(function)

    def says(self, opened: Iterable[_Branch], others: Collection[ast.AST]) -> bool:
        """Return whether anything that comes with a text may say something: its branch, and what is around it.

        Args:
            opened: the branches of the text.
            others: what is done with other texts alone.
        """
        left = {*others}
        for _, branch in opened:
            orelse = branch.orelse if isinstance(branch, ast.If) else ()
            left.update(node for part in orelse for node in walk(part))
        waiting = [self._flow.above(branch, *_FUNCTIONS) for _, branch in opened]
        done = set[ast.AST]()
        while waiting and not self._is_handed_on:
            function = waiting.pop()
            if function is None:
                return True  # what is around it is not known
            if function in done:
                continue
            done.add(function)
            for node in {*walk(function)} - left:
                if isinstance(node, ast.Call) and name_read(node.func) in _SAYING:
                    return True
                waiting += self._flow.named.get(name_read(node), ())
                if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                    waiting += self._readers[node.attr] - {None}
            waiting += self._callers[getattr(function, "name", "")] - {None}
        return self._is_handed_on


def _is_said_elsewhere(flow: Flow, node: ast.AST) -> bool:
    """Return whether a node hands on what logs, sets what is shown, or decorates a function, so that other code may log."""
    above = flow.parents.get(node)
    is_called = isinstance(above, ast.Call) and above.func is node
    is_decorated = isinstance(node, _FUNCTIONS) and bool(node.decorator_list)
    name = name_read(node)
    return is_decorated or name == "set_level" or (name in _SAYING and not is_called)


def _leaves(
    flow: Flow, source: PythonSource, branch: ast.If | ast.match_case, failing: Collection[str]
) -> bool:
    """Return whether a branch ends the program, whatever holds, and nothing around it catches that."""
    if flow.above(branch, ast.Try) is not None:
        return False
    return any(ends_program(source, part) or source.at(part) in failing for part in branch.body)
