"""What is handed in: evidence that the package runs, its best practices, a self-assessment, and the archive."""

from __future__ import annotations

import ast
import datetime
import html
import itertools
import os
import re
import shutil
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import course
from ros2lab.node_process import last_line
from ros2lab.observed_domain import ObservedDomain, has_period, median_gap
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

PACKAGE = "robot_controller"
PUBLISHED, COMMAND_TOPIC = ("/robot/status", "/cmd_vel"), "/robot/command"
TOPICS = ("/robot/status", COMMAND_TOPIC, "/cmd_vel")
COMMANDS = ("start", "stop", "reset")
EVIDENCE_FILE = "EVIDENCE.md"
BUILT = ("build", "install", "log")  # what colcon makes where it is run
GENERATED_TESTS = ("test_copyright", "test_flake8", "test_pep257")  # of `ros2 pkg create`; of style
# How to build, to source and to run, as a README may say it.
COMMANDS_OF_README = {
    "colcon build": r"colcon build",
    "source install/setup.bash": r"install/(local_)?setup\.\w*sh",
    "ros2 run or ros2 launch": r"ros2 +(run|launch) ",
}
POINTS = {
    "workspace": 15,
    "package": 15,
    "status publisher": 20,
    "command subscriber": 20,
    "velocity publisher": 20,
    "documentation": 10,
    "bonus": 10,
}
START_TIMEOUT = 20.0  # s
COMMAND_TIME = 0.7  # s, between two commands
OBSERVED = 5.0  # s, in which a message every 2.4 s comes twice
LONGEST_LINE = 99  # characters, as ROS 2 has it
IGNORE_FILE = "COLCON_IGNORE"
LAUNCH_FILES = ("*launch.*", "launch/*.py")
YAML_FILES = ("*.yaml", "*.yml")

# The practices that are an exercise, by their names in the table.
READABLE = "can be read as Python"
SHORT = f"lines up to {LONGEST_LINE} characters"
DESCRIBED = "docstrings of modules and classes"
CAUGHT = "exceptions caught by name"
LOGGED = "logger and not print"

_LOG = "rcl_interfaces/msg/Log"
_LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}


class Table:
    """Rows with a head, shown as a table in a notebook and as text elsewhere."""

    def __init__(self, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        self.head = tuple(head)
        self.rows = [tuple(str(cell) for cell in row) for row in rows]

    def markdown(self) -> str:
        """Return it as Markdown."""
        lines = [self.head, tuple("---" for _ in self.head), *self.rows]
        return "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
        )

    def __repr__(self) -> str:
        widths = [max(map(len, column)) for column in zip(self.head, *self.rows, strict=True)]
        lines = ("  ".join(map(str.ljust, line, widths)).rstrip() for line in (self.head, *self.rows))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        def line(cells: Sequence[str], kind: str) -> str:
            style = 'style="text-align: left"'
            return "<tr>" + "".join(f"<{kind} {style}>{html.escape(c)}</{kind}>" for c in cells) + "</tr>"

        return f"<table>{line(self.head, 'th')}{''.join(line(row, 'td') for row in self.rows)}</table>"


@dataclass(frozen=True)
class Heard:
    """What was published on a topic while the package ran.

    Attributes:
        type_name: such as `std_msgs/msg/String`.
        count: how many messages came; None if its type cannot be imported here.
        rate: in Hz, from the median gap while nothing was commanded; None for fewer than two messages.
        last: the last value, in a few words.
        has_moved: whether a number in it was not zero while the last command was `start`.
    """

    type_name: str
    count: int | None
    rate: float | None
    last: str
    has_moved: bool


@dataclass(frozen=True)
class Evidence:
    """What a package did while it ran.

    Attributes:
        programs: of each executable, how it was at the end: `runs`, or its last words.
        nodes: their full names.
        published: what was heard, by topic.
        subscribed: the types of what was listened to, by topic.
        log: the log lines, in their order.
        file: where this is written.
    """

    programs: dict[str, str]
    nodes: list[str]
    published: dict[str, Heard]
    subscribed: dict[str, list[str]]
    log: list[str] = field(repr=False)
    file: Path = field(repr=False)

    @property
    def topics(self) -> list[str]:
        """Every topic that was published or listened to."""
        return sorted({*self.published, *self.subscribed})

    def table(self) -> Table:
        """Return the topics with their types and rounded rates."""
        rows = []
        for topic in self.topics:
            heard = self.published.get(topic)
            kind = heard.type_name if heard else ", ".join(self.subscribed[topic])
            rate = _rounded(heard.rate if heard else None)
            rows.append((topic, kind, "published" if heard else "listened to", rate))
        return Table(("topic", "type", "", "rate"), rows)


def collect_evidence(workspace: Workspace, package: str = PACKAGE) -> Evidence:
    """Run every executable of a built package, give the three commands, and write down what is seen.

    It runs in a ROS domain of its own, so that nothing else is heard. `EVIDENCE.md` in the workspace is
    written anew; what was there before is kept in `~/earlier`.

    Args:
        workspace: where the package was built.
        package: its name.

    Raises:
        WorkspaceError: if nothing has been built there.
        OSError: if the file cannot be written.
    """
    overlay = workspace.overlay
    with ObservedDomain() as domain:
        programs = {
            executable.name: domain.start(executable.name, ["ros2", "run", package, executable.name], overlay)
            for executable in workspace.executables(package)
        }
        domain.wait(
            lambda: set(PUBLISHED) <= domain.published().keys() and COMMAND_TOPIC in domain.subscribed(),
            START_TIMEOUT * bool(programs),
        )
        lines = domain.log("/rosout", _LOG)
        logs = {
            topic: (types[0], _log(domain, topic, types[0])) for topic, types in domain.published().items()
        }
        for command in (*COMMANDS, COMMANDS[0]):
            domain.say(COMMAND_TOPIC, command)
            domain.wait(lambda: False, COMMAND_TIME * bool(programs))
        # Rates are those while nobody commands: what a command brings about comes once. And what moves now
        # moves after `start`: messages from before have arrived.
        quiet = time.monotonic()
        domain.wait(lambda: False, OBSERVED * bool(programs))
        evidence = Evidence(
            {
                name: "runs" if one.is_running else f"ended: {last_line(one.output) or 'it said nothing'}"
                for name, one in programs.items()
            },
            domain.nodes(),
            {topic: _heard(kind, log, quiet) for topic, (kind, log) in logs.items()},
            domain.subscribed(),
            [_log_line(sample.message) for sample in lines.samples()],
            workspace.path / EVIDENCE_FILE,
        )
    _write_kept(evidence.file, _report(evidence, package))
    return evidence


def practices(workspace: Workspace, package: str = PACKAGE) -> Table:
    """Measure a package's modules against what is agreed among those who write Python.

    Returns:
        A row for each practice: its name, how often it holds, and the first place where it does not.
    """
    rows = []
    for practice, places in places_of_practices(workspace, package).items():
        wrong = [place for place in places if place]
        rows.append((practice, f"{len(places) - len(wrong)} of {len(places)}", wrong[0] if wrong else ""))
    return Table(("practice", "holds for", "first place where not"), rows)


def places_of_practices(workspace: Workspace, package: str = PACKAGE) -> dict[str, list[str]]:
    """Return for each practice an entry a place where it could hold: "" if it does, else `file:line`."""
    found: dict[str, list[str]] = {}
    inner = workspace.path / "src" / package / package
    for file in sorted(inner.rglob("*.py")):
        name = file.relative_to(inner).as_posix()
        text = file.read_text(encoding="utf-8-sig", errors="replace")
        try:
            tree = ast.parse(text)
        except SyntaxError as error:
            found.setdefault(READABLE, []).append(f"{name}:{error.lineno}")
            continue
        for practice, holds, line in [*_measured(tree), *_measured_lines(text)]:
            found.setdefault(practice, []).append("" if holds else f"{name}:{line}")
    return found


def git(folder: Path, *words: str) -> str:
    """Return what a git command that only reads prints; nothing if it fails, or there is no git."""
    if shutil.which("git") is None:
        return ""
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    done = subprocess.run(
        ["git", "-C", str(folder), *words],
        env={**environ, "GIT_OPTIONAL_LOCKS": "0"},
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    return done.stdout if done.returncode == 0 else ""


def ignored(folder: Path) -> list[str]:
    """Return which of the folders that colcon makes git would not take."""
    shown = git(folder, "check-ignore", *(f"{name}/x" for name in BUILT))
    return [line.removesuffix("/x") for line in shown.splitlines()]


def products(paths: Iterable[PurePath]) -> list[PurePath]:
    """Return those files of a workspace that colcon, Python or git has made.

    Args:
        paths: relative to the workspace's folder. Below it, a folder such as `build` is colcon's if it holds
            the file COLCON_IGNORE, which colcon puts into each that it makes.
    """
    files = list(paths)
    made = {PurePath(name) for name in BUILT}
    made |= {file.parent for file in files if file.name == IGNORE_FILE and file.parent.name in BUILT}
    return [
        file
        for file in files
        if made.intersection(file.parents) or {"__pycache__", ".git"}.intersection(file.parts)
    ]


def is_readme(name: str) -> bool:
    """Tell whether a file of this name is a README."""
    return re.fullmatch(r"readme(\.\w+)?", name, re.IGNORECASE) is not None


def find_readme(workspace: Workspace, package: str = PACKAGE) -> Path | None:
    """Return the README: the workspace's, or else the package's; None if there is none."""
    for folder in (workspace.path, workspace.path / "src" / package):
        for file in sorted(folder.iterdir()) if folder.is_dir() else ():
            if is_readme(file.name) and file.is_file():
                return file
    return None


def shared_files(workspace: Workspace, package: str, *patterns: str) -> list[Path]:
    """Return the files of these patterns that a package has installed in `share/<package>`, sorted."""
    install = workspace.path / "install"
    # Isolated and merged.
    folders = [install / package / "share" / package, install / "share" / package]
    found = {file for folder in folders for pattern in patterns for file in folder.rglob(pattern)}
    return sorted(file for file in found if file.is_file() and "__pycache__" not in file.parts)


def measure(workspace: Workspace, evidence: Evidence, package: str = PACKAGE) -> dict[str, dict[str, bool]]:
    """Return facts for each part of the assignment, and whether they hold."""
    folder = workspace.path / "src" / package
    status, velocity = (evidence.published.get(topic) for topic in ("/robot/status", "/cmd_vel"))
    file = find_readme(workspace, package)
    readme = file.read_text(encoding="utf-8", errors="replace") if file else ""
    caught = places_of_practices(workspace, package).get(CAUGHT, [])
    return {
        "workspace": {
            "the package lies in src/": (folder / "package.xml").is_file(),
            "it is built": (workspace.path / "install" / "setup.bash").is_file(),
            "git ignores build, install and log": len(ignored(workspace.path)) == len(BUILT),
        },
        "package": {
            "package.xml is valid and says ament_python": _build_type(folder) == "ament_python",
            "three executables": len(evidence.programs) >= 3,
            "all of them run": set(evidence.programs.values()) == {"runs"},
        },
        "status publisher": {
            "a String on /robot/status": _has_type(status, "std_msgs/msg/String"),
            "every 2 s": bool(status and status.rate and has_period(1 / status.rate, 2.0)),
        },
        "command subscriber": {
            "a String is taken from /robot/command": "std_msgs/msg/String"
            in evidence.subscribed.get(COMMAND_TOPIC, []),
            "start, stop and reset are in the log": all(
                any(command in line.lower() for line in evidence.log) for command in COMMANDS
            ),
        },
        "velocity publisher": {
            "a Twist on /cmd_vel": _has_type(velocity, "geometry_msgs/msg/Twist"),
            "it moves after start": bool(velocity and velocity.has_moved),
        },
        "documentation": {
            "README names the three topics": all(topic in readme for topic in TOPICS),
            "README says how to build and run": all(
                re.search(pattern, readme) for pattern in COMMANDS_OF_README.values()
            ),
            "evidence of running": evidence.file.is_file(),
        },
        "bonus": {
            "a launch file": bool(shared_files(workspace, package, *LAUNCH_FILES)),
            "a parameter file": any(
                "ros__parameters" in file.read_text(encoding="utf-8", errors="replace")
                for file in shared_files(workspace, package, *YAML_FILES)
            ),
            "parameters": "declare_parameter" in _source(folder),
            "errors are caught by name": bool(caught) and not any(caught),
            "unit tests": any(_own_tests(folder)),
        },
    }


def assess(claims: Mapping[str, int], facts: Mapping[str, Mapping[str, bool]]) -> Table:
    """Hold what somebody claims for each part against the points for the facts that hold.

    Args:
        claims: points by the names in `POINTS`.
        facts: of `measure`.
    """
    rows = [
        (
            part,
            most,
            claims.get(part, "-"),
            measured_points(part, facts),
            ", ".join(f"not: {fact}" for fact, holds in facts[part].items() if not holds),
        )
        for part, most in POINTS.items()
    ]
    return Table(("part", "of", "claimed", "measured", ""), rows)


def measured_points(part: str, facts: Mapping[str, Mapping[str, bool]]) -> int:
    """Return the points of a part: those of the assignment, in proportion to the facts that hold."""
    return round(POINTS[part] * sum(facts[part].values()) / len(facts[part]))


def pack(workspace: Workspace, name: str = "") -> Path:
    """Pack the sources, README and evidence of a workspace, and nothing that was built.

    Args:
        workspace: what is handed in.
        name: whose it is; it becomes part of the file's name.

    Returns:
        The archive, `~/hand_in/<name>_<workspace>_<number>.zip`; the number is the first that is free.

    Raises:
        OSError: if it cannot be written.
    """
    folder = course.work_folder() / "hand_in"
    folder.mkdir(parents=True, exist_ok=True)
    stem = "_".join(re.findall(r"\w+", f"{name} {workspace.path.name}", flags=re.ASCII))
    for number in itertools.count(1):
        target = folder / f"{stem}_{number}.zip"
        if not os.path.lexists(target):
            break
    # Under its name only once it is whole, also after Ctrl-C.
    with tempfile.TemporaryDirectory(prefix=".pack-", dir=folder) as scratch:
        whole = Path(scratch, target.name)
        with zipfile.ZipFile(whole, "x", zipfile.ZIP_DEFLATED, strict_timestamps=False) as archive:
            for path in _handed_in(workspace.path):
                archive.write(path, Path(workspace.path.name) / path.relative_to(workspace.path))
        whole.rename(target)
    return target


def _handed_in(root: Path) -> Iterator[Path]:
    """Yield the files of a workspace that somebody has written, following links to folders once."""
    seen: set[str] = set()
    for folder, subfolders, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            subfolders.clear()
            continue
        seen.add(real)
        is_root = Path(folder) == root
        subfolders[:] = sorted(
            name
            for name in subfolders
            if not name.startswith((".", "__pycache__"))
            and not name.endswith(".egg-info")
            and not (name in BUILT and (is_root or Path(folder, name, IGNORE_FILE).is_file()))
        )
        for name in sorted(names):
            is_hidden = name.startswith(".") and name != ".gitignore"
            if not is_hidden and not name.endswith((".pyc", ".zip")) and Path(folder, name).is_file():
                yield Path(folder, name)


def _log(domain: ObservedDomain, topic: str, type_name: str) -> TopicLog | None:
    """Keep what is published on a topic; None if its type cannot be imported here."""
    try:
        return domain.log(topic, type_name)
    except (ImportError, ValueError):
        return None


def _heard(type_name: str, log: TopicLog | None, quiet: float) -> Heard:
    """Sum up a log; rate and motion are those of the samples since `quiet` (s of time.monotonic())."""
    if log is None:
        return Heard(type_name, None, None, "nothing", has_moved=False)
    samples = log.samples(since=quiet)
    gap = median_gap([sample.time for sample in samples])
    latest = log.latest
    return Heard(
        type_name,
        log.count,
        1.0 / gap if gap else None,
        _brief(latest.message if latest else None),
        any(_numbers_in(sample.message) for sample in samples),
    )


def _rounded(rate: float | None) -> str:
    if rate is None:
        return "-"
    return f"{rate:.0f} Hz" if rate >= 2 else f"{rate:.1f} Hz"


def _numbers_in(message: Any) -> bool:
    """Tell whether a message holds a number other than zero, at any depth."""
    if isinstance(message, (int, float)) and not isinstance(message, bool):
        return message != 0
    fields: dict[str, str] = getattr(message, "get_fields_and_field_types", dict)()
    return any(_numbers_in(getattr(message, name)) for name in fields)


def _brief(message: Any) -> str:
    if message is None:
        return "nothing"
    if hasattr(message, "linear"):
        return f"linear.x {message.linear.x:g}, angular.z {message.angular.z:g}"
    text = " ".join(str(getattr(message, "data", message)).split())
    return text if len(text) <= 80 else f"{text[:79]}…"


def _log_line(message: Any) -> str:
    return f"[{_LEVELS.get(message.level, message.level)}] [{message.name}]: {message.msg}"


def _report(evidence: Evidence, package: str) -> str:
    """Write the evidence as Markdown; its headings are always the same."""
    now = datetime.datetime.now().astimezone()
    heard = [
        (
            topic,
            one.type_name,
            "-" if one.count is None else one.count,
            f"{one.rate:.2f} Hz" if one.rate else "-",
            one.last,
        )
        for topic, one in evidence.published.items()
    ]
    listened = [(topic, ", ".join(types)) for topic, types in evidence.subscribed.items()]
    log = "\n".join(evidence.log)
    return f"""# Evidence

`{package}` was run on {now:%Y-%m-%d at %H:%M}: each executable by `ros2 run`, in a ROS domain of its own.
The commands {", ".join(f"`{command}`" for command in COMMANDS)} were published on `/robot/command`.

## Executables

{Table(("executable", "at the end"), evidence.programs.items()).markdown()}

## Nodes

{chr(10).join(f"- `{node}`" for node in evidence.nodes) or "none"}

## Topics published

{Table(("topic", "type", "messages", "rate", "last value"), heard).markdown()}

## Topics listened to

{Table(("topic", "type"), listened).markdown()}

## Log

```text
{log}
```
"""


def _write_kept(file: Path, text: str) -> None:
    """Write a file; what was there before is kept in `~/earlier`."""
    if file.is_file() and file.read_text(encoding="utf-8", errors="replace") != text:
        course.keep_earlier(file)
    course.write_whole(file, text.encode())


def _measured(tree: ast.Module) -> Iterator[tuple[str, bool, int]]:
    """Yield a practice, whether it holds, and the line, for every place where it could hold."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield "names as in PEP 8", re.fullmatch(r"[a-z_][a-z0-9_]*", node.name) is not None, node.lineno
            yield "type hints", _is_annotated(node), node.lineno
        if isinstance(node, ast.ClassDef):
            yield (
                "names as in PEP 8",
                re.fullmatch(r"_?[A-Z][A-Za-z0-9]*", node.name) is not None,
                node.lineno,
            )
        if isinstance(node, ast.ClassDef) or (isinstance(node, ast.Module) and node.body):
            yield DESCRIBED, ast.get_docstring(node) is not None, getattr(node, "lineno", 1)
        if isinstance(node, ast.ExceptHandler):
            yield CAUGHT, node.type is not None, node.lineno
        if isinstance(node, ast.Call):
            is_print = isinstance(node.func, ast.Name) and node.func.id == "print"
            # One that says where it prints is not in the logger's place.
            if is_print and not any(keyword.arg == "file" for keyword in node.keywords):
                yield LOGGED, False, node.lineno
            elif getattr(node.func, "attr", "") in ("debug", "info", "warning", "warn", "error", "fatal"):
                yield LOGGED, True, node.lineno


def _measured_lines(text: str) -> Iterator[tuple[str, bool, int]]:
    for number, line in enumerate(text.splitlines(), 1):
        yield SHORT, len(line) <= LONGEST_LINE, number


def _is_annotated(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    given = [one for one in arguments if one.arg not in ("self", "cls")]
    return function.returns is not None and all(one.annotation is not None for one in given)


def _has_type(heard: Heard | None, type_name: str) -> bool:
    return heard is not None and heard.type_name == type_name and bool(heard.count)


def _build_type(folder: Path) -> str:
    try:
        return str(parse_package(str(folder), warnings=[]).get_build_type())
    except (InvalidPackage, OSError):
        return ""


def _source(folder: Path) -> str:
    files = sorted((folder / folder.name).rglob("*.py"))
    return "\n".join(file.read_text(encoding="utf-8", errors="replace") for file in files)


def _own_tests(folder: Path) -> Iterator[Path]:
    """Yield the tests that `ros2 pkg create` has not written."""
    return (file for file in (folder / "test").rglob("test_*.py") if file.stem not in GENERATED_TESTS)
