"""Check the entry points of setup.py against the files of the package."""

from __future__ import annotations

import ast
import copy
import difflib
import os
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.packaging.entry_point_forms import (
    can_be_named,
    function_of,
    meant_file,
    of_its_parts,
    put_in_order,
    wrong_form,
)
from ros2lab.diagnose.packaging.for_ros import programs
from ros2lab.diagnose.packaging.setup_shapes import like
from ros2lab.diagnose.sources.interfaces import is_installed
from ros2lab.diagnose.sources.made_modules import is_made
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.other_names import meant_function
from ros2lab.diagnose.sources.own_functions import what_a_call_makes
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import Function, PythonSource, names_bound, own_nodes, read_text
from ros2lab.diagnose.sources.setup_script import EntryPoint, SetupScript
from ros2lab.diagnose.sources.spelling import (
    alike,
    did_you_mean,
    differs,
    is_near_miss,
    nearest,
    program_words,
    same_letters,
)
from ros2lab.diagnose.sources.syntax_parts import needed_by

_ALIKE = 0.6  # how similar the names of an executable and of its module usually are, at least


def entry_point_faults(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    """Yield what is wrong with the entry points of a setup.py, and with the functions that they name."""
    groups, points = setup.groups, setup.entry_points
    place = at(setup.source.shown, setup.line("entry_points"))
    if (
        groups is not None
        and (wrong := nearest("console_scripts", groups, 0.8))
        and "console_scripts" not in groups
    ):
        cause = f"setup.py has {wrong!r} in entry_points, but the key must be 'console_scripts', so no executable is installed."
        fix = "write 'console_scripts' with an s"
        yield Finding("entry-points-key", cause, place, fix)
    elif (
        points == []
        and not _has_scripts(package, setup)
        and (mains := programs(package))
        and not any(f"{mains[0]}:" in read_text(path) for path in package.beside.rglob("setup.py"))
    ):
        moves = dict.fromkeys(move for main in mains for move in _moves(package, main))
        named = [re.sub(r"[^\w.]+", "_", main) for main in mains]
        added = ", ".join(f"'{name.rpartition('.')[2]} = {name}:main'" for name in named)
        cause = f"setup.py has no entry point, so {', '.join(mains)} cannot be run with `ros2 run`."
        fix = f"{''.join(f'{move}, and ' for move in moves)}add {added} to 'console_scripts' in entry_points"
        yield Finding("entry-points-missing", cause, place, fix)
    yield from _of_another(setup, package.sources)
    seen: dict[str, EntryPoint] = {}
    for point in points or ():
        first = seen.setdefault(point.name, point) if point.name else point
        if first is not point:
            found = [_named_twice(setup, point, first)]
        else:
            found = [*_entry_point_fault(package, setup, point)]
        yield from (replace(finding, about=(point.name, *finding.about)) for finding in found)


def _moves(package: SourcePackage, module: str) -> Iterator[str]:
    """Yield the commands after which an entry point can name a module: its folders and its file, each where it needs it."""
    parts, count = Path(package.sources[module].shown).parts, module.count(".") + 1
    folder = Path(*parts[:-count])
    for name in parts[-count:]:
        stem, dot, ending = name.partition(".")
        better = re.sub(r"\W+", "_", stem)
        old, new = folder / name, folder / f"{better}{dot}{ending}"
        if old != new:
            yield f"mv {quote(str(old))} {quote(str(new))}"
        folder = new


def _has_scripts(package: SourcePackage, setup: SetupScript) -> bool:
    """Return whether a setup.py installs executables in another way, or may do so."""
    others = {"scripts"} & setup.keywords.keys() or {*(setup.groups or ())} - {"console_scripts"}
    return bool(others) or package.copied != []


def _named_twice(setup: SetupScript, point: EntryPoint, first: EntryPoint) -> Finding:
    is_same = (point.module, point.function) == (first.module, first.function)
    cause = f"The executable {point.name} is listed twice in entry_points, so setuptools rejects setup.py."
    fix = "give one of the two another name"
    if is_same:
        fix = f"remove this line: line {first.line} says the same"
    return Finding("entry-point-twice", cause, at(setup.source.shown, point.line), fix)


def _is_anothers(package: SourcePackage, point: EntryPoint) -> bool:
    """Return whether another package may bring the module of an entry point: a declared or installed one, or one beside it."""
    top = point.module.partition(".")[0]
    if top in package.declared or is_installed(top):
        return True
    named = package.beside.rglob(f"{point.module.replace('.', '/')}.py")
    return any(not path.is_relative_to(package.folder) for path in named)


def _entry_point_fault(package: SourcePackage, setup: SetupScript, point: EntryPoint) -> Iterator[Finding]:
    place = at(setup.source.shown, point.line)
    if not point.module or point.function.endswith("."):
        yield wrong_form(package, point, place)
        return
    if point.module.partition(".")[0] in sys.stdlib_module_names | {"rclpy", "launch"}:
        return
    sources = package.sources
    source = sources.get(point.module)
    if source is None and is_made(package, point.module):
        return
    top = point.module.partition(".")[0]
    if source is None and (called := alike(package.folder, top)) and (package.folder / called).is_dir():
        cause = f"The entry point {point.name} names the package {top}, but the folder is called {called}: {differs(called, top)}."
        fix = f"mv {quote(package.shown(called))} {quote(package.shown(top))}, and build again"
        yield Finding("entry-point-module", cause, place, fix, (package.shown(called),))
        return
    tops = {name.partition(".")[0] for name in sources} | set(package.packages or ())
    if source is None and top not in tops and _is_anothers(package, point):
        return
    if source is None and sources and package.packages is not None and not setup.keywords.get("py_modules"):
        yield _no_module(package, point, place, is_own=point.module.partition(".")[0] in tops)
    elif not point.function:
        cause = f"The entry point {point.name} names the module {point.module} but no function in it."
        function = meant_function(package, point.module)
        fix = f"write '{point.name} = {point.module}:{function}'{_lacking(package, point.module, function)}"
        yield Finding("entry-point-no-function", cause, place, fix)
    elif source is not None:
        yield from _function_fault(package, source, point, place)


def _function_fault(
    package: SourcePackage, source: PythonSource, point: EntryPoint, place: str
) -> Iterator[Finding]:
    """Yield what keeps an entry point's function from being called: it is a class, needs arguments, or is missing."""
    made = source.classes.get(point.function)
    if made is not None:
        # The constructor of another class may run the whole program.
        if not _is_only_a_node(source, made):
            return
        cause = f"The executable {point.name} calls the class {point.function}, but it must call a function that makes and runs the node."
        fix = f"write '{point.name} = {point.module}:main', and define main() in {source.shown}: init, {point.function}(), spin"
        yield Finding("entry-point-function", cause, place, fix)
    elif made_by := _made_by(source, point.function):
        yield _only_made(source, point, source.functions[point.function], made_by)
    elif (function := _demanding(source, point.function)) is not None:
        names = [argument.arg for argument in function.args.args]
        required = names[: len(names) - len(function.args.defaults)]
        given = copy.deepcopy(function.args)
        given.defaults = [*(ast.Constant(None) for _ in required), *function.args.defaults]
        returns = f" -> {ast.unparse(function.returns)}" if function.returns else ""
        cause = (
            f"`ros2 run` calls {point.function}() without arguments, but it requires {', '.join(required)}."
        )
        fix = f"write def {point.function}({ast.unparse(given)}){returns}:"
        yield Finding("entry-point-function", cause, source.at(function), fix)
    elif not (source.fault or source.hidden or source.is_beyond) and not _has(source, point.function):
        if "." in point.function and (meant := of_its_parts(package, point)):
            yield put_in_order(package, point, meant, place)
            return
        yield _missing_function(package, source, point, place)


def _made_by(source: PythonSource, name: str) -> str:
    """Return what a call of a function makes instead of running it; empty if it runs it, or is bound to something else."""
    own = source.functions.get(name)
    return what_a_call_makes(own) if own and name not in names_bound(own_nodes(source.tree)) else ""


def _only_made(source: PythonSource, point: EntryPoint, function: Function, made: str) -> Finding:
    """Return a finding about an entry point whose call makes a coroutine or a generator, which nothing runs."""
    name = function.name
    runs = f"asyncio.run({name}())" if made == "coroutine" else f"list({name}())"
    is_known = made == "generator" or "asyncio" in source.names
    imported = "" if is_known else ", with `import asyncio` at the top"
    cause = f"The executable {point.name} calls {name}(), and this call only makes a {made}: nothing of {name}() runs."
    fix = f"write `def run_{name}(): {runs}` below {name}() in {source.shown}{imported}, '{point.name} = {point.module}:run_{name}' in setup.py, and build again"
    return Finding("entry-point-function", cause, source.at(function), fix)


def _is_only_a_node(source: PythonSource, made: ast.ClassDef) -> bool:
    """Return whether a class is a node that neither starts nor spins itself."""
    is_node = any(ast.unparse(base).rpartition(".")[2].endswith("Node") for base in made.bases)
    calls = (node for node in ast.walk(made) if isinstance(node, ast.Call))
    return is_node and not any((source.resolve(call.func) or "").startswith("rclpy.") for call in calls)


def _demanding(source: PythonSource, name: str) -> ast.FunctionDef | None:
    """Return the function of a name if it cannot be called without arguments; None otherwise."""
    for node in source.tree.body:
        if isinstance(node, ast.FunctionDef) and node.name == name and not node.decorator_list:
            return node if len(node.args.args) > len(node.args.defaults) else None
    return None


def _below_guard(source: PythonSource) -> ast.If | None:
    """Return the `if __name__ == '__main__':` that holds the program; None if it only calls a function."""
    for node in source.tree.body:
        if isinstance(node, ast.If) and "__name__" in ast.unparse(node.test) and len(node.body) > 1:
            return node
    return None


def _of_another(setup: SetupScript, sources: Mapping[str, PythonSource]) -> Iterator[Finding]:
    """Yield an executable that calls the module of another one although a suitable file is called by none."""
    points = setup.entry_points or []
    modules = {point.module for point in points}
    uncalled = [name for name in sources if can_be_named(name) and name not in modules]
    for number, point in enumerate(points):
        twin = next((other for other in points if other is not point and other.module == point.module), None)
        if twin is None or not (meant := _meant_module(points, number, uncalled, sources)):
            continue
        called = f"{point.module}:{point.function}" if point.function == twin.function else point.module
        cause = f"The executable {point.name} calls {called}, as {twin.name} does, so nothing runs {sources[meant].shown}."
        where = "" if _are_alike(point.name, meant) else f"if {point.name} should run that file, "
        fix = f"{where}write '{point.name} = {meant}:{point.function}', and build again"
        place = at(setup.source.shown, point.line)
        yield Finding("entry-point-function", cause, place, fix, (point.name,))


def _meant_module(
    points: list[EntryPoint], number: int, uncalled: list[str], sources: Mapping[str, PythonSource]
) -> str:
    """Return the module that an entry point should name instead of that of another; empty if it may be right.

    It is the file with the name of the executable. If two entry points call the same function and one file is
    left uncalled, that file belongs to the executable with the more similar name, if there is one.
    """
    point = points[number]
    able = [name for name in uncalled if _has(sources[name], point.function)]
    if own := next((name for name in able if name.rpartition(".")[2] == point.name), ""):
        return own
    target = (point.module, point.function)
    alike = [candidate for candidate in points if (candidate.module, candidate.function) == target]
    if len(alike) < 2 or len(able) != 1:
        return ""

    def fit(candidate: EntryPoint) -> float:
        return _likeness(candidate.name, able[0]) - _likeness(candidate.name, point.module)

    own_fit, others = fit(point), [other for other in alike if other is not point]
    # The module may be named after another executable, which leaves none for this one.
    is_left = any(other.name == other.module.rpartition(".")[2] for other in others)
    named = [candidate for candidate in points if _are_alike(candidate.name, able[0])]
    is_meant = (own_fit > 0 or is_left) if point in named else is_left and not named
    return able[0] if is_meant and own_fit > max(map(fit, others)) else ""


def _are_alike(executable: str, module: str) -> bool:
    words = (program_words(name).split() for name in (executable, module))
    return bool(set.intersection(*map(set, words))) or _likeness(executable, module) >= _ALIKE


def _likeness(executable: str, module: str) -> float:
    """Return how similar the names of an executable and a module are, from 0 to 1."""
    return difflib.SequenceMatcher(None, program_words(executable), program_words(module)).ratio()


def _missing_function(package: SourcePackage, source: PythonSource, point: EntryPoint, place: str) -> Finding:
    """Return a finding about an entry point whose module lacks the function that it names."""
    sources, points = package.sources, package.setup.entry_points if package.setup else None
    taken = {other.module for other in points or ()}  # another executable's program is not meant
    calls = f"The executable {point.name} calls {point.function}() in {source.shown}, but"
    homes = [name for name, file in sources.items() if not file.fault and _has(file, point.function)]
    homes = [name for name in homes if name not in taken and can_be_named(name)]
    own = {name.rpartition(".")[2]: name for name in homes}
    home = own.get(point.name) or own.get(nearest(point.name, own) or "", "")
    # Every program may have a main(): another file is meant if it makes the node, or if no file is named.
    home = home or "".join(n for n in homes if len(homes) == 1 and _may_be(source, sources[n], point.name))
    if (below := _below_guard(source)) is not None:
        cause = f"{calls} that file runs its code only under `if __name__ == '__main__':`, which is not true under `ros2 run`."
        fix = f"write `def {point.function}(args=None):` instead of that line, and at the end of the file that line with `{point.function}()` below it"
        return Finding("entry-point-function", cause, source.at(below), fix)
    if inner := _indented(source, point.function):
        holder, line = inner
        cause = f"{calls} `def {point.function}` on line {line} is indented, so it belongs to {holder} instead of the module."
        fix = f"remove the spaces before `def {point.function}`, and the same number before each line of its body"
        return Finding("entry-point-function", cause, source.at(line), fix)
    if home:
        cause = f"{calls} it is in {home}."
        fix = f"write '{point.name} = {home}:{point.function}', and build again"
        return Finding("entry-point-function", cause, place, fix)
    define = f"define {point.function}(args=None)"
    callable_ones = (
        f for f in source.functions.values() if isinstance(f, ast.FunctionDef) and not needed_by(f)
    )
    functions = [function.name for function in callable_ones]
    if not functions:
        what = "there is no such function." if source.text.strip() else "the file is empty."
        fix = f"{define} in {source.shown}, or remove this entry point from setup.py"
        return Finding("entry-point-function", f"{calls} {what}", source.at(1), fix)
    if point.name in functions:
        cause = f"{calls} the function is called {point.name}: the executable's name comes first."
        fix = f"write '{point.function} = {point.module}:{point.name}', and build again"
        return Finding("entry-point-function", cause, place, fix)
    cause = f"{calls} there is no such function.{did_you_mean(point.function, functions)}"
    fix = f"write the function you mean in setup.py ({source.shown} has {', '.join(functions)}), or {define} there"
    return Finding("entry-point-function", cause, place, fix)


def _no_module(package: SourcePackage, point: EntryPoint, place: str, *, is_own: bool) -> Finding:
    """Return a finding about an entry point whose module does not exist, with the module that was meant."""
    if meant := of_its_parts(package, point):
        return put_in_order(package, point, meant, place)
    wanted = package.folder_of(point.module).with_suffix(".py")
    listed = package.packages or ()
    installed = [n for n in package.sources if n != package.name and n.rpartition(".")[0] in listed]
    known = [name for name in installed if name.rpartition(".")[2] == wanted.stem]
    if not known and (lies := _lies(package, wanted)):
        return _renamed(package, point, lies, wanted, place)
    having = [name for name in installed if point.function in package.sources[name].functions]
    close = meant_file(package, point, known or having) or meant_file(package, point, installed)
    if close and not can_be_named(close):
        return _renamed(package, point, package.sources[close].path or wanted, wanted, place)
    return _no_such_module(package, point, place, close, known, is_own=is_own)


def _renamed(package: SourcePackage, point: EntryPoint, lies: Path, wanted: Path, place: str) -> Finding:
    """Say that the file of an entry point lies elsewhere, or under another name."""
    shown = [package.shown(os.path.relpath(path, package.folder)) for path in (lies, wanted)]
    folder = quote(shown[1].rpartition("/")[0])
    make = "" if wanted.parent.is_dir() else f"mkdir -p {folder} && touch {folder}/__init__.py && "
    cause = f"The entry point {point.name} names the module {point.module}, whose file is {shown[1]}; there is {shown[0]} instead."
    fix = f"{make}mv {quote(shown[0])} {quote(shown[1])}, then colcon build --packages-select {package.name}"
    return Finding("entry-point-module", cause, place, fix, (shown[0],))


def _lies(package: SourcePackage, wanted: Path) -> Path | None:
    """Return the file that has a module's name, or nearly so, in a folder that is not installed; None if none has."""
    same = [source.path for name, source in package.sources.items() if name.rpartition(".")[2] == wanted.stem]
    near = like(wanted)
    away = [package.folder / place for place in package.places_of(wanted.name)]
    paths = [*same, *([wanted.parent / near] if near else []), *away]
    return next((path for path in paths if path and path.exists()), None)


def _no_such_module(
    package: SourcePackage,
    point: EntryPoint,
    place: str,
    close: str | None,
    known: Sequence[str],
    *,
    is_own: bool,
) -> Finding:
    """Say that no file is a module's, and which module was meant if one is called nearly so."""
    function = point.function or point.module.rpartition(".")[2]
    right, more = "", ""
    if close:
        is_there = [*known] == [close]
        called = (point.function or "main") if is_there else function_of(package, close, [function])
        called = called or meant_function(package, close)
        right, more = f"{close}:{called}", _lacking(package, close, called)
        stem, written = close.rpartition(".")[2], point.module.rpartition(".")[2]
        is_alike = (
            same_letters(stem, point.name) or same_letters(stem, written) or is_near_miss(written, stem)
        )
        if more and not is_there and not is_alike:
            close, right = None, ""  # a similar name alone does not make it the program
    lacks = "there is no such file." if is_own else "there is no such package in this folder."
    said = f" Did you mean {close}?" if close else ""
    cause = f"The entry point {point.name} names the module {point.module}, but {lacks}{said}"
    fix = f"write '{point.name} = {right}'{more}, and build again"
    if not right:
        fix = f"create {package.shown(str(package.folder_of(point.module)))}.py with the function {function}, or remove this entry point"
    return Finding("entry-point-module", cause, place, fix, (close,) if close else ())


def _lacking(package: SourcePackage, module: str, function: str) -> str:
    """Return the further step of a fix that names a function that its module lacks; empty if the module has it."""
    source = package.sources.get(module)
    if source is None or _has(source, function):
        return ""
    kinds = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
    others = (node for node in source.tree.body if not isinstance(node, kinds))
    runs = next((node for node in others if not isinstance(getattr(node, "value", None), ast.Constant)), None)
    if runs is not None:
        return f", and put the lines that run the program, from line {runs.lineno} of {source.shown} on, into `def {function}():` there"
    if free := [name for name in source.functions if _demanding(source, name) is None]:
        return (
            f", with the function that is meant instead of {function}: {source.shown} has {', '.join(free)}"
        )
    return f", and define {function}() in {source.shown}"


def _has(source: PythonSource, function: str) -> bool:
    _ = source.tree
    if source.fault:
        return True
    bound = names_bound(source.nodes)
    names = set(source.names) | bound | {node.name for node in _defined(source.tree.body)}
    return function.partition(".")[0] in names or any(imported.local == "*" for imported in source.imports)


def _defined(body: Sequence[ast.stmt]) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Yield what a module defines, also under a condition, unless it is run only as a script."""
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield node
        elif isinstance(node, (ast.If, ast.Try, ast.With)) and "__name__" not in ast.unparse(
            getattr(node, "test", ast.Constant(None))
        ):
            for field in ("body", "orelse", "finalbody"):
                yield from _defined(getattr(node, field, ()))
            for handler in getattr(node, "handlers", ()):
                yield from _defined(handler.body)


def _may_be(named: PythonSource, other: PythonSource, executable: str) -> bool:
    return named.is_package or executable in NodeSources({other.name: other}).node_names


def _indented(source: PythonSource, name: str) -> tuple[str, int] | None:
    """Return the class or function that contains a function of this name, and its line; None if none does."""
    for outer in source.nodes:
        if isinstance(outer, (ast.ClassDef, ast.FunctionDef)):
            for node in outer.body:
                if isinstance(node, ast.FunctionDef) and node.name == name:
                    kind = "the class" if isinstance(outer, ast.ClassDef) else "the function"
                    return f"{kind} {outer.name}", node.lineno
    return None
