"""Build a submission with colcon in the sandbox, and find out how each of its programs can be started.

A fresh workspace is made beside what was handed in, so that nothing around a package takes part in its build.
What a build leaves may be anything: it is listed and read in a box, and taken as a claim that the next box tries.
"""

from __future__ import annotations

import ast
import configparser
import json
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any

from ros2lab import environment
from ros2lab.build_report import (
    BuildResult,
    Job,
    first_error,
    judge_build,
    read_jobs,
    read_packages,
    read_records,
)
from ros2lab.build_report import Package as ListedPackage
from ros2lab.diagnose.python_source import PythonSource, read_source, read_text
from ros2lab.grading.evidence import Build, Executable
from ros2lab.grading.files import Package
from ros2lab.grading.sandbox import FILES, ROS_SETTINGS, World
from ros2lab.grading.submission import IGNORED, FoundPackage, Submission

WORKSPACE = "graded_ws"  # beside what was handed in
IMPORT_TIME = 10.0  # s; what is imported for longer runs its node at once, and does so as installed, too
READ_TIME = 30.0  # s

_NAMED_SCRIPT = re.compile(r"([\w.-]+)\s*=\s*([\w.{}]+)\s*:\s*(\w+)")
_LATE_IMPORTS = ("importlib", "runpy", "subprocess", "multiprocessing")
_MOST_PROGRAMS = 20


def underlay() -> dict[str, str]:
    """Return the variables with which a box has ROS and colcon, and nothing of a submission.

    The file `environment.DISCOVERY_PROFILE` must be shown to the World.

    Raises:
        RuntimeError: if the installed Jazzy cannot be sourced, or colcon is not installed.
    """
    environ = environment.lab_environment({"ROS_DOMAIN_ID": "0"}) | ROS_SETTINGS
    if shutil.which("colcon", path=environ["PATH"]) is None:
        raise RuntimeError("The command colcon is not installed; run `make lab`.")
    if environment.WHEELS_GUARD in os.environ and environment.find_ros({}).kind == "wheels":
        # What the wheels' start-up hook found for this Python saves every other one the search.
        folders = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
        environ["LD_LIBRARY_PATH"] = os.pathsep.join(sorted(filter(None, folders)))
        environ[environment.WHEELS_GUARD] = os.environ[environment.WHEELS_GUARD]
    return {
        name: value for name, value in environ.items() if name not in ("HOME", "PWD", "OLDPWD", "SHLVL", "_")
    }


def build(
    world: World,
    submission: Submission,
    prepare: Callable[[Path, str], None] = lambda _root, _workspace: None,
) -> Build:
    """Build the assignment's package, with what it needs of the other ones.

    Args:
        world: a copy of what was received, in which no box has run; its limits hold for colcon. It shows
            `environment.DISCOVERY_PROFILE`.
        submission: what was found in it.
        prepare: called before anything runs, with the World's folder and the name of the new workspace in it.

    Returns:
        What came of it; without a package there are only scripts.

    Raises:
        RuntimeError: as for `underlay`.
        SandboxMissing: if a box cannot be made.
    """
    environ = underlay()
    loose = [_script(read_source(world.folder / name, "", name)) for name in submission.node_files]
    if submission.package is None:
        fault = "There is no package to which it belongs."
        programs = [replace(one, fault=fault) for one in loose[:_MOST_PROGRAMS]]
        return Build(False, "There is no package to build.", [], [], programs, [], environ, 0.0)
    # All that is read here is read before anything of the submission runs.
    plan = _plan(world.folder, submission, submission.package)
    notes = _settings(world.folder, plan)
    plan.lay_out(world.folder)
    prepare(world.folder, plan.workspace)
    outcome = _colcon(world, plan, environ)
    overlay = _overlay(plan, outcome.files, environ)
    programs = _programs(world, plan, outcome, overlay)
    if not any(one.command for one in programs):
        programs += [replace(one, fault="It does not lie in the package.") for one in loose]
    share = f"{plan.name}/share/{plan.name}/"
    shared = [path.removeprefix(share) for path in outcome.files if path.startswith(share)]
    return Build(
        outcome.is_built,
        outcome.error,
        outcome.warnings,
        notes,
        programs[:_MOST_PROGRAMS],
        sorted(
            path
            for path in shared
            if not re.match(r"package\.(ba|z|)sh$|package\.(dsv|ps1|xml)$|hook/", path)
        ),
        overlay,
        outcome.seconds,
    )


# --- before anything runs ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Module:
    """A Python file of the package, as far as starting it goes.

    Attributes:
        name: how it is imported; empty for a file that is not in a Python package.
        file: its path below the package's folder.
        base: the folder below the package's from which it is imported.
        functions: those that can be called without arguments to start it; "" runs the file itself.
        defined: all names that it binds at its top.
        imported: modules of the package that it imports.
    """

    name: str
    file: str
    base: str
    functions: tuple[str, ...]
    defined: frozenset[str]
    imported: frozenset[str]


@dataclass(frozen=True)
class _Point:
    name: str
    module: str
    function: str

    @property
    def target(self) -> str:
        return f"{self.module}:{self.function}"


@dataclass(frozen=True)
class _Plan:
    """What is to be built, and what is known of it.

    Attributes:
        found: the assignment's package.
        name: of that package.
        folders: where each package of the new workspace lies in the submission, by its folder below src.
        names: of all these packages.
        modules: the Python files of the assignment's package.
        points: the executables that it means to install.
        workspace: the new workspace's folder below the World's.
        configured: sections and options of its setup.cfg.
    """

    found: FoundPackage
    name: str
    folders: dict[str, str]
    names: list[str]
    modules: list[_Module]
    points: list[_Point]
    workspace: str
    configured: list[str] = field(default_factory=list)

    @property
    def source(self) -> str:
        """The package's folder in a box."""
        return f"{FILES}/{self.workspace}/src/{next(iter(self.folders))}"

    @property
    def install(self) -> str:
        return f"{FILES}/{self.workspace}/install"

    def lay_out(self, root: Path) -> None:
        """Put the packages into the new workspace's src, without using space for them."""
        for name, folder in self.folders.items():
            _link_tree(root, PurePosixPath(folder), root / self.workspace / "src" / name, self.workspace)


def _plan(root: Path, submission: Submission, found: FoundPackage) -> _Plan:
    package = Package(root / found.folder, root)
    others = {one.name: one for one in submission.packages if one.name and one.folder != found.folder}
    needed = _needed(root, package, others)
    folders: dict[str, str] = {}
    for one in (found, *needed):
        # A name from setup.py may be anything, also a path.
        name = re.sub(r"[^\w-]", "_", PurePosixPath(one.folder).name or package.name)[:100]
        folders[_free(name, folders)] = one.folder
    config = package.setup_cfg
    configured = [f"{s}.{key}" for s in config.sections() for key in config[s]] if config else []
    return _Plan(
        found,
        package.name,
        folders,
        [package.name, *(str(one.name) for one in needed)],
        [*_modules(package)],
        _intended(package),
        _free(WORKSPACE, {path.name for path in root.iterdir()}),
        configured,
    )


def _free(name: str, taken: Iterable[str]) -> str:
    names = {*taken}
    while name in names:
        name += "_"
    return name


def _needed(root: Path, package: Package, others: Mapping[str, FoundPackage]) -> list[FoundPackage]:
    """Return the other packages that a package declares or imports, and those that these need."""
    found: dict[str, FoundPackage] = {}
    queue = [package]
    while queue:
        one = queue.pop()
        manifest = one.manifest
        wanted = {d.name for d in [*manifest.build_depends, *manifest.exec_depends]} if manifest else set()
        wanted |= {i.target.partition(".")[0] for source in one.sources.values() for i in source.imports}
        for name in sorted(wanted & others.keys() - found.keys() - {package.name}):
            found[name] = others[name]
            queue.append(Package(root / others[name].folder, root))
    return [*found.values()]


def _link_tree(root: Path, folder: PurePosixPath, target: Path, left_out: str) -> None:
    """Make a tree like `folder` below `root`, of hard links to its files, and links to its links.

    What would hide the package from colcon is left out, for the nodes are to be seen all the same.
    """
    for parent, folders, files in os.walk(root / folder):
        inside = Path(parent).relative_to(root / folder)
        folders[:] = [name for name in folders if Path(parent, name) != root / left_out]
        (target / inside).mkdir(parents=True)
        for name in [*folders, *files]:
            original = Path(parent, name)
            if inside == Path() and name in IGNORED:
                continue
            if original.is_symlink():
                (target / inside / name).symlink_to(f"{FILES}/{original.relative_to(root)}")
            elif name in files:
                os.link(original, target / inside / name)
        folders[:] = [name for name in folders if not Path(parent, name).is_symlink()]


def _modules(package: Package) -> Iterator[_Module]:
    """Yield the package's modules, then files that lie elsewhere in its folder and start a node."""
    own = set(package.sources)
    seen = set()
    for name, source in package.sources.items():
        assert source.path is not None
        seen.add(source.path)
        file = source.path.relative_to(package.folder)
        parts = file.parts[: -len(name.split(".")) - source.is_package]
        yield _module(source, name, file, "/".join(parts), own)
    if package.notes:
        return
    for path in sorted(package.folder.rglob("*.py")):
        file = path.relative_to(package.folder)
        is_other = (
            path.name == "setup.py" or "launch" in path.name or {"test", "tests", "launch"} & {*file.parts}
        )
        if path in seen or is_other:
            continue
        module = _module(read_source(path, path.stem, str(file)), "", file, "", own)
        if module.functions:
            yield module


def _module(source: PythonSource, name: str, file: Path, base: str, own: set[str]) -> _Module:
    targets = {one.target for one in source.imports}
    if any(target.startswith(_LATE_IMPORTS) for target in targets):
        texts = {n.value for n in source.nodes if isinstance(n, ast.Constant) and isinstance(n.value, str)}
        targets |= {m for m in own if {m, m.rpartition(".")[2]} & {text.lstrip(".") for text in texts}}
    imported = {m for m in own if any(t == m or t.startswith(f"{m}.") for t in targets)}
    stored = {n.id for n in source.nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    is_ros = any(target.partition(".")[0] == "rclpy" for target in targets) or bool(imported)
    functions = tuple(_starts(source)) if is_ros else ()
    return _Module(name, str(file), base, functions, frozenset({*source.names} | stored), frozenset(imported))


def _starts(source: PythonSource) -> Iterator[str]:
    """Yield the functions by which a file can be started; "" stands for the file itself."""
    starting = {
        node.name
        for node in source.tree.body
        if isinstance(node, ast.FunctionDef)
        and len(node.args.args) <= len(node.args.defaults)
        and not any(default is None for default in node.args.kw_defaults)
        and (node.name == "main" or any(_inits(source, inner) for inner in ast.walk(node)))
    }
    if starting:
        yield from ["main"] if "main" in starting else sorted(starting)
        return
    for statement in source.tree.body:
        is_guard = isinstance(statement, ast.If) and "__main__" in ast.dump(statement.test)
        is_definition = isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
        if is_guard or (not is_definition and any(_inits(source, inner) for inner in ast.walk(statement))):
            yield ""
            return


def _inits(source: PythonSource, node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and source.resolve(node.func) in ("rclpy.init", "rclpy.init.init")


def _intended(package: Package) -> list[_Point]:
    """Return the executables that setup.py names, or seems to name where it cannot be read."""
    points = package.setup.entry_points if package.setup and not package.setup.source.fault else None
    if points:
        return [_Point(one.name, one.module, one.function) for one in points if one.function]
    text = "\n".join(read_text(package.folder / name) for name in ("setup.py", "setup.cfg", "pyproject.toml"))
    return [
        _Point(name, re.sub(r"\{\w*\}", package.name, module), function)
        for name, module, function in _NAMED_SCRIPT.findall(text)
    ]


_ALL_IGNORED = re.compile(
    r"sitecustomize\.py|usercustomize\.py|.*\.pth|colcon\.meta|defaults\.yaml|COLCON_\w+"
)


def _settings(root: Path, plan: _Plan) -> list[str]:
    """Say which settings of colcon, Python and pytest a submission holds, and how far they count."""
    own = PurePosixPath(plan.found.folder)
    inside: list[str] = []
    outside: list[str] = []
    for parent, _, names in os.walk(root):
        folder = PurePosixPath(Path(parent).relative_to(root).as_posix())
        is_own = own == folder or own in folder.parents
        for name in names:
            is_colcons = folder.name in (".colcon", "metadata") and name.endswith((".yaml", ".meta"))
            if name == "COLCON_IGNORE" or (name == "conftest.py" and is_own):
                continue  # the one was noted when it was received, the other is as it should be
            if name in ("colcon.pkg", "conftest.py") or is_colcons or _ALL_IGNORED.fullmatch(name):
                (inside if is_own else outside).append(_one_line(str(folder / name)))
    notes = []
    if outside:
        notes.append(f"Without effect, because it lies outside the package: {_listed(outside)}.")
    if inside:
        notes.append(f"With effect on its own package only: {_listed(inside)}.")
    expected = r"(develop\.script[_-]dir|install\.install[_-]scripts)"
    paths = [
        one
        for one in plan.configured
        if re.match(r"(build|install|develop|egg_info|build_py|install_lib|easy_install)\.", one)
        and not re.fullmatch(expected, one)
    ]
    if paths:
        notes.append(f"With effect on its own package only: {_listed(paths)} in setup.cfg.")
    groups = [one for one in plan.configured if "entry_points.colcon" in one]
    if groups:
        notes.append(f"Without effect, because colcon runs without the submission: {_listed(groups)}.")
    return notes


# --- colcon -----------------------------------------------------------------------------------------------

# Prints what a build has left. It runs in a box, where a link can lead to nothing of the grader's.
_READER = """
import json, os, stat, sys
def text(path, most):
    try:
        file = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with open(file, 'rb') as data:
            is_file = stat.S_ISREG(os.fstat(file).st_mode)
            return data.read(most).decode(errors='replace') if is_file else ''
    except OSError:
        return ''
files, points, heads, room = {}, {}, {}, 500_000
for parent, folders, names in os.walk('install'):
    folders.sort()
    for name in sorted(names):
        path = os.path.join(parent, name)
        room -= len(path)
        if room > 0 and '__pycache__' not in path and os.path.isfile(path):
            files[path[len('install/'):]] = os.access(path, os.X_OK)
        if parent.count('/') == 3 and parent.split('/')[2] == 'lib' and len(heads) < 50:
            heads[path[len('install/'):]] = text(path, 100)
        if name == 'entry_points.txt' and len(points) < 10:
            points[path[len('install/'):]] = text(path, 20_000)
logs = sorted(name for name in os.listdir('log') if name.startswith('build_')) if os.path.isdir('log') else []
log = os.path.join('log', *logs[:1])
print(json.dumps({
    'files': files,
    'points': points,
    'heads': heads,
    'events': text(os.path.join(log, 'events.log'), 1_000_000),
    'log': text(os.path.join(log, 'logger_all.log'), 1_000_000),
}))
"""


@dataclass(frozen=True)
class _Outcome:
    """What a build has left.

    Attributes:
        files: everything below install, with whether it can be executed.
        points: the installed entry points.
        unbound: scripts that name no Python of this machine, because newer setuptools leave that to pip.
    """

    is_built: bool
    error: str
    warnings: list[str]
    files: dict[str, bool]
    points: list[_Point]
    unbound: frozenset[str]
    seconds: float


def _colcon(world: World, plan: _Plan, environ: Mapping[str, str]) -> _Outcome:
    folder = f"{FILES}/{plan.workspace}"
    bases = ["--build-base", "build", "--install-base", "install"]
    handlers = ["--event-handlers", "event_log+", "desktop_notification-"]
    box = world.run(
        ["colcon", "--log-base", "log", "build", *bases, *handlers],
        files="write",
        environ=environ,
        cwd=folder,
    )
    limits = replace(world.limits, wall_s=READ_TIME, cpu_s=READ_TIME, output_bytes=20_000_000)
    reader = [sys.executable, "-I", "-S", "-c", _READER]
    left = _read_left(world.run(reader, cwd=folder, limits=limits).output)
    try:
        jobs, records = read_jobs(left["events"]), read_records(left["log"])
    except Exception:
        # A setup.py can write anything into colcon's log, and literal_eval says anything of it.
        return _Outcome(False, "colcon's log was overwritten.", [], {}, [], frozenset(), box.seconds)
    packages = read_packages(left["log"])
    result = judge_build(
        box.wait(),
        box.seconds,
        [ListedPackage(name, Path(path), kind.removeprefix("ros.")) for name, path, kind in packages],
        jobs,
        records,
        reasons=_hidden_reason(world, plan, environ, jobs),
        last_words=box.output.splitlines()[-20:],
    )
    return _judge(plan, result, {name: kind for name, _, kind in packages}, box.cut, left)


def _read_left(printed: str) -> dict[str, Any]:
    """Read what `_READER` has printed; of anything else, nothing."""
    try:
        return dict(json.loads(printed))
    except ValueError:
        return {"files": {}, "points": {}, "heads": {}, "events": "", "log": ""}


def _judge(
    plan: _Plan, result: BuildResult, kinds: Mapping[str, str], cut: str | None, left: Mapping[str, Any]
) -> _Outcome:
    """Judge what colcon has made of the package.

    Args:
        plan: what was built.
        result: of the build.
        kinds: the packages that colcon listed, with their types, such as `ros.ament_python`.
        cut: which limit ended the build.
        left: from `_read_left`.
    """
    name, found = plan.name, plan.found
    mine = next((one for one in result.packages if one.name == name), None)
    files = dict(left["files"])
    is_installed = f"{name}/share/ament_index/resource_index/packages/{name}" in files and any(
        re.match(rf"{re.escape(name)}/(local/)?lib/python3[^/]*/[^/]*-packages/[^/]*-info/", path)
        for path in files
    )
    is_built = kinds.get(name) == "ros.ament_python" and mine is not None and mine.is_ok and is_installed
    error = ""
    if not is_built:
        kind = kinds.get(name)
        reasons = [
            cut,
            mine.error if mine else None,
            found.error and f"colcon does not take it for an ament_python package: {found.error}",
            f"colcon lists it as {kind}, not as ros.ament_python."
            if kind not in (None, "ros.ament_python")
            else None,
            result.first_error,
            f"colcon finds no package {name}." if kind is None else None,
            "colcon ended without an error, and nothing was installed.",
        ]
        error = next(reason for reason in reasons if reason)
    warnings = [*(mine.warnings if mine else ()), *result.warnings]
    return _Outcome(
        is_built,
        _one_line(error),
        [_one_line(warning) for warning in warnings],
        files,
        [*_points(left["points"], name)],
        frozenset(path for path, head in left["heads"].items() if head.startswith("#!python\n")),
        result.seconds,
    )


def _points(texts: Mapping[str, str], name: str) -> Iterator[_Point]:
    """Yield the console scripts in the metadata that were installed for a package."""
    for path, text in texts.items():
        if not path.startswith(f"{name}/"):
            continue
        parser = configparser.RawConfigParser(delimiters=("=",), strict=False)
        parser.optionxform = str  # type: ignore[assignment, method-assign]
        try:
            parser.read_string(text)
        except configparser.Error:
            continue
        for script, target in (
            parser.items("console_scripts") if parser.has_section("console_scripts") else ()
        ):
            module, _, function = target.partition("[")[0].replace(" ", "").partition(":")
            yield _Point(_one_line(script), module, function)


def _hidden_reason(
    world: World, plan: _Plan, environ: Mapping[str, str], jobs: Mapping[str, Job]
) -> dict[str, str]:
    """Ask setup.py itself what is wrong, where colcon shows only its own traceback."""
    job = jobs.get(plan.name)
    if job is None or not job.is_colcon_traceback:
        return {}
    limits = replace(world.limits, wall_s=min(READ_TIME, world.limits.wall_s))
    box = world.run([sys.executable, "setup.py", "--name"], environ=environ, cwd=plan.source, limits=limits)
    reason = box.cut or first_error(box.output.splitlines()) if box.code else None
    return {plan.name: reason} if reason else {}


def _overlay(plan: _Plan, files: Iterable[str], environ: Mapping[str, str]) -> dict[str, str]:
    """Return the variables after `source install/setup.bash`, as they are with no hooks but colcon's own."""
    result = dict(environ)
    paths = [*files]
    for name in reversed(plan.names):
        own = [path.removeprefix(f"{name}/") for path in paths if path.startswith(f"{name}/")]
        prefix = f"{plan.install}/{name}"
        if f"share/{name}/hook/ament_prefix_path.dsv" in own:
            _prepend(result, "AMENT_PREFIX_PATH", prefix)
        for folder in sorted(
            {m[1] for path in own if (m := re.match(r"((?:local/)?lib/python3[^/]*/[^/]*-packages)/", path))}
        ):
            _prepend(result, "PYTHONPATH", f"{prefix}/{folder}")
        if any(path.startswith("bin/") for path in own):
            _prepend(result, "PATH", f"{prefix}/bin")
    if paths:
        _prepend(result, "COLCON_PREFIX_PATH", plan.install)
    return result


def _prepend(environ: dict[str, str], name: str, folder: str) -> None:
    environ[name] = os.pathsep.join(filter(None, (folder, environ.get(name, ""))))


# --- programs ---------------------------------------------------------------------------------------------

# Imports each entry point in a process of its own, and prints why it cannot be called; "" if it can.
_IMPORTER = """
import importlib, json, os, select, sys, time, traceback
try:
    import rclpy
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
print(json.dumps(results))
"""

# Calls a function, or runs a module, as if a package that was not installed were.
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


def _programs(world: World, plan: _Plan, outcome: _Outcome, overlay: Mapping[str, str]) -> list[Executable]:
    """Return the executables, then the plain scripts, then the modules that no executable starts."""
    installed = {one.name: one for one in outcome.points}
    points = [*installed.values(), *(one for one in plan.points if one.name not in installed)][
        :_MOST_PROGRAMS
    ]
    tried = [one.target for one in points if one.name in installed] if outcome.is_built else []
    imports = _try_imports(world, tried, overlay)
    programs = []
    for point in points:
        fault = _fault(plan, outcome, point, imports)
        programs.append(_installed(plan, point) if not fault else _otherwise(plan, point, fault))
    programs += _plain_scripts(plan, outcome, {one.name for one in points})
    reached = _reached(plan, (one.target.partition(":")[0] for one in programs if one.command))
    started = {one.name for one in programs if not one.target and one.command}
    for module in plan.modules:
        if module.name not in reached and PurePosixPath(module.file).stem not in started:
            for one in (_alone(plan, module, function) for function in module.functions):
                programs.append(replace(one, name=_free(one.name, {other.name for other in programs})))
    return programs


def _try_imports(world: World, targets: Sequence[str], overlay: Mapping[str, str]) -> dict[str, str]:
    """Import what entry points name; return what is wrong with each."""
    if not targets:
        return {}
    limits = replace(world.limits, wall_s=IMPORT_TIME + READ_TIME)
    words = json.dumps([IMPORT_TIME, FILES, *targets])
    box = world.run([sys.executable, "-c", _IMPORTER, words], environ=overlay, limits=limits)
    try:
        results = json.loads(box.output.rstrip().rpartition("\n")[2])
        return {target: _one_line(str(said)) for target, said in zip(targets, results, strict=True)}
    except (ValueError, TypeError):
        return dict.fromkeys(targets, f"Its module could not be tried: {box.cut or 'the trial was ended'}")


def _fault(plan: _Plan, outcome: _Outcome, point: _Point, imports: Mapping[str, str]) -> str:
    """Return why `ros2 run` cannot start an executable; nothing if it can."""
    if not outcome.is_built:
        return "The package was not built."
    if outcome.files.get(f"{plan.name}/lib/{plan.name}/{point.name}"):
        return imports.get(point.target, "")
    if f"{plan.name}/bin/{point.name}" in outcome.files:
        return "It was installed in bin, where `ros2 run` does not look."
    return f"It was not installed in lib/{plan.name}, where `ros2 run` looks."


def _installed(plan: _Plan, point: _Point, fault: str = "") -> Executable:
    path = f"{plan.install}/{plan.name}/lib/{plan.name}/{point.name}"
    return Executable(point.name, point.target, "installed", [path] if not fault else [], fault)


def _otherwise(plan: _Plan, point: _Point, fault: str) -> Executable:
    """Return how to start what an executable should have started."""
    module = next((one for one in plan.modules if one.name == point.module), None)
    if module is None:
        return _installed(plan, point, fault)
    function = point.function.partition(".")[0]
    if function not in module.defined:
        if not module.functions:
            return _installed(plan, point, fault)
        return replace(_alone(plan, module, module.functions[0]), name=point.name, fault=fault)
    return replace(_alone(plan, module, point.function), name=point.name, fault=fault)


def _alone(plan: _Plan, module: _Module, function: str) -> Executable:
    stem = PurePosixPath(module.file).stem
    name = stem if function in ("", "main") else function
    fault = "No entry point leads to it."
    if not module.name:
        script = [sys.executable, f"{plan.source}/{module.file}"]
        if "" in module.functions or not function:
            return Executable(name, "", "script", script, fault)
        folder = f"{plan.source}/{PurePosixPath(module.file).parent}".removesuffix("/.")
        return Executable(name, f"{stem}:{function}", "script", _call(folder, stem, function), fault)
    folder = f"{plan.source}/{module.base}".rstrip("/")
    target = f"{module.name}:{function}"
    return Executable(name, target, "module", _call(folder, module.name, function), fault)


def _call(folder: str, module: str, function: str) -> list[str]:
    return [sys.executable, "-c", _CALL, folder, module, function]


def _script(source: PythonSource) -> Executable:
    """Return how to run a file that belongs to no package."""
    name = PurePosixPath(source.shown).stem
    return Executable(name, "", "script", [sys.executable, f"{FILES}/{source.shown}"])


def _plain_scripts(plan: _Plan, outcome: _Outcome, known: Iterable[str]) -> list[Executable]:
    """Return what lies in lib/<package> and is no entry point."""
    folder = f"{plan.name}/lib/{plan.name}/"
    names = {
        path.removeprefix(folder): is_on for path, is_on in outcome.files.items() if path.startswith(folder)
    }
    found = []
    for name, is_executable in names.items():
        if name in {*known} or "/" in name:
            continue
        path = f"{plan.install}/{folder}{name}"
        if is_executable and outcome.is_built:
            command = [sys.executable, path] if f"{folder}{name}" in outcome.unbound else [path]
            found.append(Executable(name, "", "installed", command))
        elif name.endswith(".py"):
            fault = "It is not executable." if outcome.is_built else "The package was not built."
            found.append(Executable(name.removesuffix(".py"), "", "script", [sys.executable, path], fault))
    return found


def _reached(plan: _Plan, modules: Iterable[str]) -> set[str]:
    """Return the modules that these import, directly or not, and themselves."""
    by_name = {one.name: one for one in plan.modules if one.name}
    reached: set[str] = set()
    queue = [*modules]
    while queue:
        name = queue.pop()
        if name in by_name and name not in reached:
            reached.add(name)
            queue += by_name[name].imported
    return reached


def _listed(names: Sequence[str]) -> str:
    return ", ".join(sorted(names)[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")


def _one_line(text: str, longest: int = 400) -> str:
    """Return a text on one line, shortened, without the box's folder and what a terminal would act upon."""
    text = re.sub(rf"{FILES}/{WORKSPACE}_*/", "", " ".join(text.split()))
    text = text if len(text) <= longest else f"{text[: longest - 1]}…"
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "backslashreplace").decode() for c in text
    )
