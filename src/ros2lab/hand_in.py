"""What is handed in: evidence that the package runs, its best practices, a self-assessment, and the archive."""

from __future__ import annotations

import ast
import datetime
import html
import itertools
import os
import re
import statistics
import tempfile
import time
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from catkin_pkg.package import InvalidPackage, parse_package

from ros2lab import course
from ros2lab.observed_domain import ObservedDomain
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

PACKAGE = "robot_controller"
TOPICS = ("/robot/status", "/robot/command", "/cmd_vel")
COMMANDS = ("start", "stop", "reset")
EVIDENCE_FILE = "EVIDENCE.md"
BUILT = ("build", "install", "log")  # what colcon makes beside src
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
OBSERVED = 4.5  # s, in which a message every 2 s comes twice
LONGEST_LINE = 99  # characters, as ROS 2 has it

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
        count: how many messages came.
        rate: in Hz, from the median gap while nothing was commanded; None for fewer than two messages.
        last: the last value, in a few words.
        has_moved: whether a number in it was not zero at some time.
    """

    type_name: str
    count: int
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
            lambda: set(TOPICS) <= {*domain.published(), *domain.subscribed()}, START_TIMEOUT * bool(programs)
        )
        lines = domain.log("/rosout", _LOG)
        logs = {topic: domain.log(topic, types[0]) for topic, types in domain.published().items()}
        for command in (*COMMANDS, COMMANDS[0]):
            domain.say("/robot/command", command)
            domain.wait(lambda: False, COMMAND_TIME * bool(programs))
        # Rates are those while nobody commands: what a command brings about comes once.
        quiet = time.monotonic()
        domain.wait(lambda: False, OBSERVED * bool(programs))
        evidence = Evidence(
            {name: "runs" if one.is_running else _last_line(one.output) for name, one in programs.items()},
            domain.nodes(),
            {topic: _heard(log, quiet) for topic, log in logs.items()},
            {topic: types for topic, types in domain.subscribed().items() if topic not in domain.published()},
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
    counts: dict[str, list[str]] = {}  # of each practice, "" where it holds, and else the place
    for file in sorted((workspace.path / "src" / package / package).rglob("*.py")):
        text = file.read_text(encoding="utf-8", errors="replace")
        try:
            tree = ast.parse(text)
        except SyntaxError as error:
            counts.setdefault("can be read as Python", []).append(f"{file.name}:{error.lineno}")
            continue
        for practice, holds, line in [*_measured(tree), *_measured_lines(text)]:
            counts.setdefault(practice, []).append("" if holds else f"{file.name}:{line}")
    rows = []
    for practice, places in counts.items():
        wrong = [place for place in places if place]
        rows.append((practice, f"{len(places) - len(wrong)} of {len(places)}", wrong[0] if wrong else ""))
    return Table(("practice", "holds for", "first exception"), rows)


def measure(workspace: Workspace, evidence: Evidence, package: str = PACKAGE) -> dict[str, dict[str, bool]]:
    """Return facts for each part of the assignment, and whether they hold."""
    folder = workspace.path / "src" / package
    status, velocity = (evidence.published.get(topic) for topic in ("/robot/status", "/cmd_vel"))
    readme = _readme(workspace, package)
    return {
        "workspace": {
            "the package lies in src/": (folder / "package.xml").is_file(),
            "it is built": (workspace.path / "install" / "setup.bash").is_file(),
            ".gitignore names build, install and log": set(BUILT) <= _ignored(workspace.path),
        },
        "package": {
            "package.xml is valid and says ament_python": _build_type(folder) == "ament_python",
            "three executables": len(evidence.programs) >= 3,
            "all of them run": set(evidence.programs.values()) == {"runs"},
        },
        "status publisher": {
            "a String on /robot/status": _has_type(status, "std_msgs/msg/String"),
            "every 2 s": bool(status and status.rate and 0.35 < status.rate < 0.7),
        },
        "command subscriber": {
            "a String is taken from /robot/command": "std_msgs/msg/String"
            in evidence.subscribed.get("/robot/command", []),
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
            "README says how to build and run": "colcon build" in readme and "ros2 " in readme,
            "evidence of running": evidence.file.is_file(),
        },
        "bonus": {
            "a launch file": any(folder.rglob("*launch.*")),
            "a parameter file": any(folder.rglob("*.yaml")),
            "parameters": "declare_parameter" in _source(folder),
            "errors are caught by name": bool(re.search(r"except \(?[A-Z]\w+", _source(folder))),
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
            and not (is_root and name in BUILT)
        )
        for name in sorted(names):
            is_hidden = name.startswith(".") and name != ".gitignore"
            if not is_hidden and not name.endswith((".pyc", ".zip")) and Path(folder, name).is_file():
                yield Path(folder, name)


def _heard(log: TopicLog, quiet: float) -> Heard:
    """Sum up a log; the rate is that of the samples since `quiet` (s of time.monotonic())."""
    times = [sample.time for sample in log.samples(since=quiet)]
    gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
    rate = 1.0 / statistics.median(gaps) if gaps else None
    latest = log.latest
    has_moved = any(_numbers_in(sample.message) for sample in log.samples())
    return Heard(log.type_name, log.count, rate, _brief(latest.message if latest else None), has_moved)


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


def _last_line(output: str) -> str:
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return f"ended: {lines[-1]}" if lines else "ended without a word"


def _report(evidence: Evidence, package: str) -> str:
    """Write the evidence as Markdown; its headings are always the same."""
    now = datetime.datetime.now().astimezone()
    heard = [
        (topic, one.type_name, one.count, f"{one.rate:.2f} Hz" if one.rate else "-", one.last)
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
    part = file.with_name(f".{file.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(file)


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
            yield "docstrings of classes", ast.get_docstring(node) is not None, node.lineno
        if isinstance(node, ast.ExceptHandler):
            yield "exceptions caught by name", node.type is not None, node.lineno
        if isinstance(node, ast.Call):
            called = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
            if called == "print" or called in ("debug", "info", "warning", "warn", "error", "fatal"):
                yield "logger and not print", called != "print", node.lineno


def _measured_lines(text: str) -> Iterator[tuple[str, bool, int]]:
    for number, line in enumerate(text.splitlines(), 1):
        yield (
            "lines as in PEP 8",
            len(line) <= LONGEST_LINE and line == line.rstrip() and "\t" not in line,
            number,
        )


def _is_annotated(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    given = [one for one in arguments if one.arg not in ("self", "cls")]
    return function.returns is not None and all(one.annotation is not None for one in given)


def _has_type(heard: Heard | None, type_name: str) -> bool:
    return heard is not None and heard.type_name == type_name and heard.count > 0


def _build_type(folder: Path) -> str:
    try:
        return str(parse_package(str(folder), warnings=[]).get_build_type())
    except (InvalidPackage, OSError):
        return ""


def _readme(workspace: Workspace, package: str) -> str:
    """Return the text of the workspace's README and the package's."""
    files = [*workspace.path.glob("README*"), *(workspace.path / "src" / package).glob("README*")]
    return "\n".join(
        file.read_text(encoding="utf-8", errors="replace") for file in sorted(files) if file.is_file()
    )


def _ignored(folder: Path) -> set[str]:
    file = folder / ".gitignore"
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines() if file.is_file() else []
    return {line.strip().strip("/") for line in lines}


def _source(folder: Path) -> str:
    files = sorted((folder / folder.name).rglob("*.py"))
    return "\n".join(file.read_text(encoding="utf-8", errors="replace") for file in files)


def _own_tests(folder: Path) -> Iterator[Path]:
    """Yield the tests that `ros2 pkg create` has not written."""
    generated = ("test_copyright.py", "test_flake8.py", "test_pep257.py")
    return (file for file in (folder / "test").rglob("test_*.py") if file.name not in generated)
