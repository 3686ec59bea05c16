"""Python files that were run and printed nothing, because nothing in them calls what they define."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import PurePath

from ros2lab.diagnose.code.main_guards import RUN, indented_guard, is_guard, untrue_guard
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import commands_with_output
from ros2lab.diagnose.printed.transcript import words_in
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.static_value import holds

_GUARD = "`if __name__ == '__main__':`"


def of_quiet_program(text: str, look: Look) -> Finding | None:
    """Say why a file that was run did nothing; None if no such file was run."""
    for line, printed in reversed(commands_with_output(text)):
        if any(map(str.strip, printed)):
            continue
        for package, source in _run_by(line, look):
            if source.text and not source.fault and (found := _does_nothing(source, package)):
                return found
    return None


def _run_by(line: str, look: Look) -> Iterator[tuple[SourcePackage, PythonSource]]:
    """Yield the files of the workspace that a command may run directly, each with its package."""
    for command in re.split(r" *(?:&&|;) *", line):
        words = [word for word in words_in(command) if not re.match(r"\w+=", word)]
        program = words[0] if words else ""
        is_python = re.fullmatch(r"(?:\S*/)?python[\d.]*", program) is not None
        is_module = "-m" in words[:-1]
        rest = words[words.index("-m") + 1 :] if is_module else [w for w in words[is_python:] if w[:1] != "-"]
        if not rest or not (is_python or program.endswith(".py")):
            continue
        path = f"{rest[0].replace('.', '/')}.py" if is_module else rest[0]
        if path.endswith(".py"):
            for package in look.packages:
                yield from ((package, source) for source in _files(package) if _is_meant(path, source))


def _files(package: SourcePackage) -> Iterator[PythonSource]:
    yield from package.sources.values()
    others = [*package.launch_files, *sorted(package.folder.glob("test*/*.py"))]
    for path in others:
        if path.suffix == ".py":
            yield read_source(path, path.stem, package.shown(path.relative_to(package.folder).as_posix()))


def _is_meant(path: str, source: PythonSource) -> bool:
    """Return whether a path that was typed ends like the path of a file."""
    parts = [part for part in PurePath(path).parts if part not in (".", "..", "~", "/")]
    there = [*PurePath(source.shown).parts]
    # The folder in which it was typed is not known, so only the last parts are compared.
    return there[-1:] == parts[-1:] and (len(parts) == 1 or there[-2:] == parts[-2:])


def _does_nothing(source: PythonSource, package: SourcePackage) -> Finding | None:
    """Say that a file only contains definitions, and how to run it; None if it does more."""
    guards = [node for node in source.nodes if isinstance(node, ast.If) and is_guard(node)]
    if any(not _only_defines(statement) for statement in source.tree.body if statement not in guards):
        return None
    functions = [node for node in source.tree.body if isinstance(node, ast.FunctionDef)]
    if found := _of_others(source, package, [node.name for node in functions]):
        return found
    main = _main(source, package, functions)
    if guards:
        return next((found for guard in guards if (found := _of_guard(guard, source, main))), None)
    return _never_called(source, package, main)


def _of_others(source: PythonSource, package: SourcePackage, names: list[str]) -> Finding | None:
    """Say what calls the functions of a launch file or a test; None if it is neither."""
    file, called = PurePath(source.shown).name, ""
    if "generate_launch_description" in names:
        called, by, fix = (
            "generate_launch_description",
            "ros2 launch",
            f"type `ros2 launch {package.name} {file}`",
        )
    elif tests := [name for name in names if name.startswith("test")]:
        called, by, fix = tests[0], "pytest", f"type `python3 -m pytest {source.shown}`"
    if not called:
        return None
    cause = f"{file} only defines {called}(), which {by} calls but python3 does not."
    return Finding("never-called", cause, source.shown, fix)


def _never_called(
    source: PythonSource, package: SourcePackage, main: ast.FunctionDef | None
) -> Finding | None:
    """Say that nothing calls what a file defines, and where the call belongs; None if it defines nothing."""
    file = PurePath(source.shown).name
    kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    made = next((node.name for node in source.tree.body if isinstance(node, kinds)), "")
    if main is None:
        cause = f"{file} only defines {made}, and nothing in it uses that, so it ends at once."
        fix = f"write def main(): with what it should do, and at the very end {_GUARD} and, indented below it, `main()`"
        return Finding("never-called", cause, source.shown, fix) if made else None
    point = next((p.name for p in package.points if p.module == source.name), "")
    by_ros = (
        f"; or start it with `ros2 run {package.name} {point}`, which calls {main.name}()" if point else ""
    )
    cause = f"{file} only defines {main.name}() and nothing in it calls it, so python3 reads the file and exits at once."
    fix = f"write {_GUARD} at the very end of the file and, indented below it, `{main.name}()`{by_ros}"
    return Finding("never-called", cause, source.at(main), fix)


def _main(
    source: PythonSource, package: SourcePackage, functions: list[ast.FunctionDef]
) -> ast.FunctionDef | None:
    """Return the main function: an entry point, `main`, or the last function without required parameters."""
    points = [point.function for point in package.points if point.module == source.name]
    free = [function for function in functions if len(function.args.args) == len(function.args.defaults)]
    named = [function for function in free if function.name in (*points, "main")]
    return next(iter(named), free[-1] if free else None)


def _of_guard(guard: ast.If, source: PythonSource, main: ast.FunctionDef | None) -> Finding | None:
    """Say what is wrong with a `__main__` guard; None if it calls something."""
    if guard not in source.tree.body:
        return indented_guard(guard, source)
    if not holds(guard.test, {"__name__": RUN}):
        return untrue_guard(guard, source)
    if all(isinstance(statement, ast.Pass) or (isinstance(statement, ast.Expr) and isinstance(statement.value, (ast.Name, ast.Constant, ast.Attribute))) for statement in guard.body):  # fmt: skip
        name = main.name if main else "main"
        cause = f"`{ast.unparse(guard.body[0])}` only names a function without calling it."
        return Finding("never-called", cause, source.at(guard.body[0]), f"write {name}()")
    return None


def _only_defines(node: ast.stmt) -> bool:
    """Return whether a top-level statement has no visible effect."""
    if isinstance(
        node, (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Pass)
    ):
        return True
    if isinstance(node, ast.Expr):
        return isinstance(node.value, (ast.Constant, ast.Name, ast.Attribute))
    is_set = isinstance(node, (ast.Assign, ast.AnnAssign))
    return is_set and not any(isinstance(n, ast.Call) for n in ast.walk(node))
