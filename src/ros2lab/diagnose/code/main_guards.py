"""Guards such as `if __name__ == '__main__':` that never call what they should."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import PurePath

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.python_source import PythonSource, walk
from ros2lab.diagnose.sources.spelling import same_letters
from ros2lab.diagnose.sources.static_value import holds
from ros2lab.diagnose.sources.syntax_parts import calls_in

RUN, SPAWNED = (
    "__main__",
    "__mp_main__",
)  # names of a file that is run, and of one that a process imports again
_NAME = "__name__"
_FIX = f"write `if {_NAME} == {RUN!r}:`"


def main_guard_faults(source: PythonSource) -> Iterator[Finding]:
    """Yield guards that are true under no name that Python gives the file, and those inside their function."""
    names = (RUN, SPAWNED, source.name)
    for guard in (node for node in source.nodes if isinstance(node, ast.If) and is_guard(node)):
        if not any(holds(guard.test, {_NAME: name}) is not False for name in names):
            yield untrue_guard(guard, source)
    for function in source.tree.body:
        if isinstance(function, ast.FunctionDef):
            for guard in (node for node in walk(function) if isinstance(node, ast.If) and is_guard(node)):
                if function.name in _called(guard):
                    yield indented_guard(guard, source)


def is_guard(node: ast.If) -> bool:
    """Return whether a condition is about `__name__`, with or without quotes around it."""
    inner = [*ast.walk(node.test)]
    is_quoted = any(isinstance(n, ast.Constant) and n.value == _NAME for n in inner)
    return is_quoted or any(isinstance(n, ast.Name) and n.id == _NAME for n in inner)


def as_guard(statement: ast.stmt, word: str) -> str:
    """Say to write a guard whose first name means `word`, and whose text may be misspelt as well; empty if it is none."""
    match statement:
        case ast.If(test=ast.Compare(comparators=[ast.Constant(value=str(text))])) if word == _NAME:
            return _FIX if same_letters(text, RUN) else ""
    return ""


def untrue_guard(guard: ast.If, source: PythonSource) -> Finding:
    """Say that a guard is not true when its file is run."""
    file, called = PurePath(source.shown).name, next(iter(_called(guard)), "")
    effect = f"`python3 {file}` never calls {called}()" if called else f"`python3 {file}` skips these lines"
    is_quoted = not any(isinstance(n, ast.Name) for n in ast.walk(guard.test))
    why = f"{_NAME!r} in quotes is only a text" if is_quoted else f"{_NAME} is then {RUN!r}"
    cause = f"`if {ast.unparse(guard.test)}:` is not true when the file is run, because {why}: {effect}."
    return Finding("never-called", cause, source.at(guard), _FIX)


def indented_guard(guard: ast.If, source: PythonSource) -> Finding:
    """Say that a guard is inside the function that it should call."""
    cause = f"`if {ast.unparse(guard.test)}:` is indented, so it belongs to the block above it and is not reached when the file is run."
    return Finding(
        "never-called", cause, source.at(guard), "move it, with the lines below it, to the left margin"
    )


def _called(guard: ast.If) -> list[str]:
    """Return the names of the functions that the body of a guard calls."""
    calls = [n for statement in guard.body for n in calls_in(ast.walk(statement))]
    return [call.func.id for call in calls if isinstance(call.func, ast.Name)]
