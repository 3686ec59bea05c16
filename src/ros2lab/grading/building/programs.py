"""Find out how each program of a package can be started: as installed, or in some other way."""

from __future__ import annotations

import contextlib
import json
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from ros2lab.grading.building.colcon_build import READ_TIME, Outcome
from ros2lab.grading.evidence import ELSEWHERE, KEYBOARD, NO_ENTRY_POINT, NOWHERE, UNBUILT, Executable
from ros2lab.grading.reading.absent import MARKERS
from ros2lab.grading.reading.build_plan import Plan, Point, free_name, one_line
from ros2lab.grading.reading.modules import Module
from ros2lab.grading.sandbox.worlds import FILES, World

IMPORT_TIME = 10.0  # s; a module that takes longer runs its node on import, as it does when installed
TRIALS = 2  # of importing: on a busy machine, about one in a hundred ended without output
MOST_TRIED = 20  # entry points that are imported
MOST_PROGRAMS = 200

# Imports each entry point in a process of its own, and prints why it cannot be called; "" if it can. What
# most of them import is imported once, before.
_IMPORTER = """
import importlib, json, os, select, sys, time, traceback
for module in ('rclpy.node', 'std_msgs.msg', 'geometry_msgs.msg'):
    try:
        importlib.import_module(module)
    except BaseException:
        pass
limit, root, *targets = json.loads(sys.argv[1])
def place(error):
    frames = traceback.extract_tb(error.__traceback__)
    own = [(f.filename, f.lineno) for f in frames if f.filename.startswith(root)]
    if isinstance(error, SyntaxError) and error.filename:
        own.append((error.filename, error.lineno))
    return f' ({os.path.basename(own[-1][0])}, line {own[-1][1]})' if own else ''
def attempt(target):
    module, _, names = target.partition(':')
    try:
        found = importlib.import_module(module)
    except BaseException as error:
        said = getattr(error, 'msg', None) or str(error)
        return f'Its module cannot be imported: {type(error).__name__}: {said[:300]}{place(error)}.'
    if not names:
        return f'Its entry point names no function in {module}.'
    try:
        for name in names.split('.'):
            found = getattr(found, name)
    except AttributeError:
        return f'There is no {names} in {module}.'
    return '' if callable(found) else f'{names} in {module} is no function.'
children = []
for target in targets:
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        nothing = os.open(os.devnull, os.O_RDWR)
        for number in range(3):
            os.dup2(nothing, number)
        os.write(writing, attempt(target)[:1000].encode(errors='replace') + b'.')
        os._exit(0)
    os.close(writing)
    children.append((reading, child))
deadline = time.monotonic() + limit
results = []
for reading, child in children:
    ready = select.select([reading], [], [], max(0, deadline - time.monotonic()))[0]
    said = os.read(reading, 4096).decode() if ready else '.'
    results.append(said[:-1] if said else 'Its module ends Python while it is imported.')
    os.kill(child, 9)
print()
print(json.dumps(results), flush=True)
os._exit(0)
"""

# Calls a function, or runs a module, as if its package, which was not installed, were.
_CALL = """
import functools, importlib, runpy, sys
folder, module, function = sys.argv[1:4]
sys.argv[:4] = [module]
sys.path.insert(0, folder)
if not function:
    runpy.run_module(module, run_name='__main__', alter_sys=True)
else:
    sys.exit(functools.reduce(getattr, function.split('.'), importlib.import_module(module))())
"""


def programs_of(world: World, plan: Plan, outcome: Outcome, overlay: Mapping[str, str]) -> list[Executable]:
    """Return the executables, then the plain scripts, then the modules that no executable starts.

    The executables of the other packages whose nodes are graded as well come last.
    """
    installed = {point.name: point for point in outcome.points}
    points = [*installed.values(), *(point for point in plan.points if point.name not in installed)][
        :MOST_PROGRAMS
    ]
    able = [point.target for point in points if point.name in installed] if outcome.is_built else []
    tried = able[:MOST_TRIED]
    imports = _try_imports(world, tried, overlay)
    faults = {point: _fault(plan, outcome, point, imports) for point in points}
    programs = [
        _otherwise(plan, point, fault) if fault else _installed(plan, point, _path(plan, outcome, point.name))
        for point, fault in faults.items()
    ]
    programs += _plain_scripts(plan, outcome, {point.name for point in points})
    for program in (*_not_started(plan, programs), *_of_others(plan, outcome)):
        programs.append(_named_anew(program, programs))
    return [of_modules(plan, program) for program in programs]


def _not_started(plan: Plan, programs: Iterable[Executable], package: str = "") -> list[Executable]:
    """Return programs for the modules of a package (the graded one if empty) that no given program starts."""
    programs = [program for program in programs if program.command]
    reached = _reached(plan, (program.module for program in programs))
    started = {program.name for program in programs if not program.target}
    return [
        _alone(plan, module, function)
        for module in plan.modules
        if module.package == package and module.name not in reached and module.stem not in started
        for function in module.functions
    ]


def of_modules(plan: Plan, program: Executable) -> Executable:
    """Return a program with what is known of the modules that it imports, directly or indirectly."""
    reached = _reached(plan, [program.module])
    own = [
        module
        for module in plan.modules
        if module.name in reached or module.stem == (program.stem or program.name)
    ]
    if not own:  # its module is not known
        return replace(program, absent=[*plan.absent_modules])
    outside = {name for module in own for name in module.outside}
    return replace(
        program,
        absent=[
            *sorted(outside.intersection(plan.absent_modules)),
            *([KEYBOARD] if any(module.asks_keyboard for module in own) else []),
        ],
        modules=sorted({module.stem for module in own}),
        is_brief=not any(module.goes_on for module in own),
        never_spins=not any(module.spins for module in own),
    )


def _named_anew(program: Executable, programs: Iterable[Executable]) -> Executable:
    """Return a program with a name that none of the given programs has."""
    taken = {known.name for known in programs}
    name = f"{program.name}.py" if program.name in taken else program.name
    return replace(program, name=free_name(name, taken))


def _of_others(plan: Plan, outcome: Outcome) -> Iterator[Executable]:
    """Yield the programs of the other packages whose nodes are graded as well.

    First those installed where `ros2 run` looks, then the modules that none of these starts.
    """
    for package, points in plan.also.items():
        folder = f"{package}/lib/{package}/"
        targets = {point.name: point.target for point in points}
        installed = list[Executable]()
        for path, is_executable in outcome.files.items():
            name = path.removeprefix(folder)
            if path.startswith(folder) and is_executable and "/" not in name:
                words = [sys.executable] if path in outcome.unbound else []
                command = [*words, f"{plan.install}/{path}"]
                installed.append(
                    Executable(name, targets.get(name, ""), "installed", command, package=package)
                )
        yield from installed
        yield from (
            replace(executable, package=package) for executable in _not_started(plan, installed, package)
        )


def _try_imports(world: World, targets: Sequence[str], overlay: Mapping[str, str]) -> dict[str, str]:
    """Import the entry points; return what is wrong with each, empty if nothing is."""
    if not targets:
        return {}
    limits = replace(world.limits, wall_s=IMPORT_TIME + READ_TIME)
    words = json.dumps([IMPORT_TIME, FILES, *targets])
    why = ""
    for _ in range(TRIALS):
        box = world.run([sys.executable, "-c", _IMPORTER, words], environ=overlay, limits=limits)
        # The submission may have printed anything.
        with contextlib.suppress(ValueError, TypeError, RecursionError):
            results = json.loads(box.output.rstrip().rpartition("\n")[2])
            return {target: one_line(str(said)) for target, said in zip(targets, results, strict=True)}
        why = box.cut or f"the trial ended with code {box.code}"
    return dict.fromkeys(targets, f"Its module could not be tried: {why}")


def _fault(plan: Plan, outcome: Outcome, point: Point, imports: Mapping[str, str]) -> str:
    """Return why `ros2 run` cannot start an executable; empty if it can."""
    if not outcome.is_built:
        return UNBUILT
    if _path(plan, outcome, point.name):
        return imports.get(point.target, "")
    beside = re.compile(rf"({re.escape(plan.name)}/(bin|lib/[^/]+)/){re.escape(point.name)}")
    for found in filter(None, map(beside.fullmatch, outcome.files)):
        if found[1] not in _looked_in(plan, outcome):
            return f"{ELSEWHERE}{found[2]}, where `ros2 run` does not look."
    return f"{NOWHERE}lib/{plan.name}, where `ros2 run` looks."


def _looked_in(plan: Plan, outcome: Outcome) -> list[str]:
    """Return the folders in which `ros2 run` looks: one for each name that the index of packages has."""
    index = f"{plan.name}/{MARKERS}/"
    names = [path.removeprefix(index) for path in outcome.files if path.startswith(index)]
    return [f"{plan.name}/lib/{name}/" for name in dict.fromkeys((plan.name, *names))]


def _installed(plan: Plan, point: Point, path: str) -> Executable:
    return Executable(point.name, point.target, "installed", [f"{plan.install}/{path}"])


def _path(plan: Plan, outcome: Outcome, name: str) -> str:
    """Return the path of an executable where `ros2 run` finds it; empty if it is not there."""
    paths = (f"{folder}{name}" for folder in _looked_in(plan, outcome))
    return next(filter(outcome.files.get, paths), "")


def _otherwise(plan: Plan, point: Point, fault: str) -> Executable:
    """Return another way to start what an executable should start."""
    module = next((module for module in plan.modules if module.name == point.module), None)
    is_there = module is not None and point.function.partition(".")[0] in module.defined
    if module is None or not (is_there or module.functions):
        return Executable(point.name, point.target, "installed", [], fault)
    function = point.function if is_there else module.functions[0]
    return replace(_alone(plan, module, function), name=point.name, fault=fault)


def _alone(plan: Plan, module: Module, function: str) -> Executable:
    stem = PurePosixPath(module.file).stem
    name = stem if function in ("", "main") else function
    fault, source = NO_ENTRY_POINT, plan.source_of(module.package)
    if not module.name:
        script = [sys.executable, f"{source}/{module.file}"]
        if "" in module.functions or not function:
            return Executable(name, "", "script", script, fault)
        folder = f"{source}/{PurePosixPath(module.file).parent}".removesuffix("/.")
        return Executable(name, f"{stem}:{function}", "script", _call(folder, stem, function), fault)
    folder = f"{source}/{module.base}".rstrip("/")
    target = f"{module.name}:{function}"
    return Executable(name, target, "module", _call(folder, module.name, function), fault)


def _call(folder: str, module: str, function: str) -> list[str]:
    return [sys.executable, "-c", _CALL, folder, module, function]


def loose_script(file: str) -> Executable:
    """Return how to run a file that belongs to no package."""
    return Executable(PurePosixPath(file).stem, "", "script", [sys.executable, f"{FILES}/{file}"])


def _plain_scripts(plan: Plan, outcome: Outcome, known: Iterable[str]) -> list[Executable]:
    """Return the files in lib/<package> that are no entry points."""
    folders, found = _looked_in(plan, outcome), list[Executable]()
    for file, is_executable in outcome.files.items():
        folder, _, name = file.rpartition("/")
        if name in {*known} or f"{folder}/" not in folders:
            continue
        path = f"{plan.install}/{file}"
        if is_executable and outcome.is_built:
            command = [sys.executable, path] if file in outcome.unbound else [path]
            found.append(Executable(name, "", "installed", command))
        elif name.endswith(".py"):
            fault = "It is not executable." if outcome.is_built else UNBUILT
            found.append(Executable(name.removesuffix(".py"), "", "script", [sys.executable, path], fault))
    return found


def _reached(plan: Plan, modules: Iterable[str]) -> set[str]:
    """Return these modules and all that they import, directly or indirectly."""
    by_name = {module.name: module for module in plan.modules if module.name}
    reached: set[str] = set()
    queue = [*modules]
    while queue:
        name = queue.pop()
        if name in by_name and name not in reached:
            reached.add(name)
            queue += by_name[name].imported
    return reached
