"""What is handed in: evidence that the package runs, how well it is written, and the archive."""

from __future__ import annotations

import ast
import datetime
import html
import itertools
import os
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

from ros2lab import assignments, course
from ros2lab.clean_build import (
    BUILT,
    IGNORE_FILE,
    CleanBuild,
    built_from_nothing,
    differing,
    digests,
    handed_in,
    is_readme,
)
from ros2lab.node_process import last_line
from ros2lab.observed_domain import ObservedDomain
from ros2lab.rhythm import median_gap
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

ASSIGNMENT = assignments.load()
PACKAGE = ASSIGNMENT.package
PUBLISHED = tuple(part.topic for part in ASSIGNMENT.parts.values() if part.is_publisher)
COMMANDED = ASSIGNMENT.parts["command_subscriber"]
COMMAND_TOPIC, COMMANDS = COMMANDED.topic, COMMANDED.commands
TOPICS = ASSIGNMENT.topics
EVIDENCE_FILE = "EVIDENCE.md"
GENERATED_TESTS = ("test_copyright", "test_flake8", "test_pep257")  # of `ros2 pkg create`; of style
START_TIMEOUT = 20.0  # s
COMMAND_TIME = 0.7  # s, between two commands
OBSERVED = 5.0  # s, in which a message every 2.4 s comes twice
LONGEST_LINE = 99  # characters, as ROS 2 has it
LAUNCH_FILES = ("*launch.*", "launch/*.py")
YAML_FILES = ("*.yaml", "*.yml")

# The practices that are an exercise, by their names in the table.
READABLE = "can be read as Python"
SHORT = f"lines up to {LONGEST_LINE} characters"
DESCRIBED = "docstrings of modules and classes"
NAMED = "names as in PEP 8"
CAUGHT = "exceptions caught by name"
LOGGED = "logger and not print"
LICENSED = "a license, a description and a maintainer"

_LOG = "rcl_interfaces/msg/Log"
_NOBODY_ELSES = ("-c", "core.excludesFile=/dev/null")  # what this user ignores everywhere, others do not
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
    """

    type_name: str
    count: int | None
    rate: float | None
    last: str


@dataclass(frozen=True)
class Evidence:
    """What a package did while it ran, built from nothing.

    Attributes:
        file: where this is written, in the workspace.
        sources: digests of the files that were built, by their paths in the workspace.
        fault: why it could not be built, as colcon says it; empty if it could.
        programs: of each executable, how it was at the end: `runs`, or its last words.
        nodes: their full names.
        published: what was heard, by topic.
        publishers: the types of what was published, by topic and node.
        subscribers: the types of what was subscribed to, by topic and node.
        shared: what lies in `share/<package>`, relative to that folder.
        log: the log lines, in their order.
    """

    file: Path = field(repr=False)
    sources: dict[str, str] = field(repr=False)
    fault: str = ""
    programs: dict[str, str] = field(default_factory=dict)
    nodes: list[str] = field(default_factory=list)
    published: dict[str, Heard] = field(default_factory=dict)
    publishers: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    subscribers: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    shared: list[str] = field(default_factory=list)
    log: list[str] = field(default_factory=list, repr=False)

    @property
    def topics(self) -> list[str]:
        """Every topic that was published or subscribed to."""
        return sorted({*self.published, *self.subscribers})

    @property
    def outdated(self) -> list[str]:
        """The sources that are not any more what was built."""
        return differing(digests(self.file.parent), self.sources)

    def table(self) -> Table:
        """Return the topics with their types and rounded rates."""
        rows = []
        for topic in self.topics:
            heard = self.published.get(topic)
            kind = heard.type_name if heard else _types(self.subscribers[topic])
            rate = _rounded(heard.rate if heard else None)
            rows.append((topic, kind, "published" if heard else "subscribed to", rate))
        return Table(("topic", "type", "", "rate"), rows)


def collect_evidence(workspace: Workspace, package: str = PACKAGE, *, seconds: float = OBSERVED) -> Evidence:
    """Build a package from nothing, run its executables, give the commands, and write down what is seen.

    It is built in a folder apart and runs in a ROS domain of its own. `EVIDENCE.md` in the workspace is written
    anew if it can be built; what was there before is kept in `~/earlier`.

    Args:
        workspace: where the sources are.
        package: its name.
        seconds: how long it is watched after the commands.

    Raises:
        WorkspaceError: if there is no workspace, or colcon is missing.
        OSError: if a file cannot be read or written.
    """
    file, sources = workspace.path / EVIDENCE_FILE, digests(workspace.path)
    place = course.shown_path(workspace.path)
    sys.stdout.write(f"Building {package} from nothing, in an empty folder.\n")
    with built_from_nothing(workspace.path) as clean:
        fault = _fault_of(clean, package)
        if fault:
            sys.stdout.write(f"What is in {place}/src cannot be built: {fault}\n")
            return Evidence(file, sources, fault)
        sys.stdout.write(
            f"Built from the {clean.files} files in {place}/src; the workspace's own install/ is not used.\n"
            "Running it for a few seconds.\n"
        )
        evidence = _observed(clean.workspace, package, file, sources, seconds)
    _write_kept(file, _report(evidence, package))
    return evidence


def _fault_of(clean: CleanBuild, package: str) -> str:
    """Return why a package was not built; empty if it was."""
    if not clean.result.is_ok:
        return str(clean.result.first_error)
    names = [built.name for built in clean.result.packages if built.is_ok]
    return "" if package in names else f"there is no package {package}, only {', '.join(names) or 'nothing'}"


def _observed(
    built: Workspace, package: str, file: Path, sources: dict[str, str], seconds: float
) -> Evidence:
    overlay = built.overlay
    with ObservedDomain() as domain:
        programs = {
            executable.name: domain.start(executable.name, ["ros2", "run", package, executable.name], overlay)
            for executable in built.executables(package)
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
        # Rates are those while nobody commands: what a command brings about comes once.
        quiet = time.monotonic()
        domain.wait(lambda: False, seconds * bool(programs))
        return Evidence(
            file,
            sources,
            programs={
                name: "runs"
                if program.is_running
                else f"ended: {last_line(program.output) or 'it said nothing'}"
                for name, program in programs.items()
            },
            nodes=domain.nodes(),
            published={topic: _heard(kind, log, quiet) for topic, (kind, log) in logs.items()},
            publishers=domain.publishers(),
            subscribers=domain.subscribers(),
            shared=[
                path.relative_to(folder).as_posix()
                for folder in _shares(built, package)
                for path in shared_files(built, package, "*")
                if path.is_relative_to(folder)
            ],
            log=[_log_line(sample.message) for sample in lines.samples()],
        )


def evidence_fault(root: Path) -> str:
    """Return in what way the evidence in a folder does not belong to the sources there; empty if it does.

    Args:
        root: a workspace's folder.
    """
    file = root / EVIDENCE_FILE
    if not file.is_file():
        return "there is none"
    text, sources = file.read_text(encoding="utf-8", errors="replace"), digests(root)
    if _sources_table(sources) in text:
        return ""
    if not any(_source_row(name, digest) in text for name, digest in sources.items()):
        return "it is of another workspace, or was not written by collect_evidence()"
    changed = [name for name, digest in sources.items() if _source_row(name, digest) not in text]
    return (
        f"since it was collected, {changed[0]} has changed" if changed else "since then, a file was removed"
    )


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
    if found:
        found[LICENSED] = [*_unwritten(workspace.path / "src" / package / "package.xml")]
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
    shown = git(folder, *_NOBODY_ELSES, "check-ignore", *(f"{name}/x" for name in BUILT))
    return [line.removesuffix("/x") for line in shown.splitlines()]


def ignored_sources(folder: Path) -> list[tuple[str, str]]:
    """Return the files that somebody has written and git does not take, each with the line that is to blame."""
    names = [path.relative_to(folder).as_posix() for path in handed_in(folder)]
    shown = git(folder, *_NOBODY_ELSES, "check-ignore", "--verbose", "--", *names)
    pairs = [line.rpartition("\t") for line in shown.splitlines()]
    return [(name, rule) for rule, _, name in pairs]


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


def find_readme(workspace: Workspace, package: str = PACKAGE) -> Path | None:
    """Return the README: the workspace's, or else the package's; None if there is none."""
    for folder in (workspace.path, workspace.path / "src" / package):
        for file in sorted(folder.iterdir()) if folder.is_dir() else ():
            if is_readme(file.name) and file.is_file():
                return file
    return None


def shared_files(workspace: Workspace, package: str, *patterns: str) -> list[Path]:
    """Return the files of these patterns that a package has installed in `share/<package>`, sorted."""
    found = {
        file
        for folder in _shares(workspace, package)
        for pattern in patterns
        for file in folder.rglob(pattern)
    }
    return sorted(file for file in found if file.is_file() and "__pycache__" not in file.parts)


def _shares(workspace: Workspace, package: str) -> tuple[Path, Path]:
    """Return where a package may have installed what it shares: isolated and merged."""
    install = workspace.path / "install"
    return install / package / "share" / package, install / "share" / package


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
    with (
        course.whole_file(target) as file,
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED, strict_timestamps=False) as archive,
    ):
        for path in handed_in(workspace.path):
            archive.write(path, Path(workspace.path.name) / path.relative_to(workspace.path))
    return target


def _log(domain: ObservedDomain, topic: str, type_name: str) -> TopicLog | None:
    """Keep what is published on a topic; None if its type cannot be imported here."""
    try:
        return domain.log(topic, type_name)
    except (ImportError, ValueError):
        return None


def _heard(type_name: str, log: TopicLog | None, quiet: float) -> Heard:
    """Sum up a log; the rate is that of the samples since `quiet` (s of time.monotonic())."""
    if log is None:
        return Heard(type_name, None, None, "nothing")
    samples = log.samples(since=quiet)
    gap = median_gap([sample.published for sample in samples])
    latest = log.latest
    return Heard(
        type_name,
        log.count,
        1.0 / gap if gap else None,
        _brief(latest.message if latest else None),
    )


def _rounded(rate: float | None) -> str:
    if rate is None:
        return "-"
    return f"{rate:.0f} Hz" if rate >= 2 else f"{rate:.1f} Hz"


def _brief(message: Any) -> str:
    if message is None:
        return "nothing"
    if hasattr(message, "linear"):
        return f"linear.x {message.linear.x:g}, angular.z {message.angular.z:g}"
    text = " ".join(str(getattr(message, "data", message)).split())
    return text if len(text) <= 80 else f"{text[:79]}…"


def _log_line(message: Any) -> str:
    return f"[{_LEVELS.get(message.level, message.level)}] [{message.name}]: {message.msg}"


def _types(nodes: Mapping[str, Iterable[str]]) -> str:
    return ", ".join(sorted({name for types in nodes.values() for name in types}))


def _source_row(name: str, digest: str) -> str:
    return f"| {name} | {digest} |"


def _sources_table(sources: Mapping[str, str]) -> str:
    return Table(("file", "SHA-256, its beginning"), sources.items()).markdown()


def _report(evidence: Evidence, package: str) -> str:
    """Write the evidence as Markdown; its headings are always the same."""
    now = datetime.datetime.now().astimezone()
    published = [
        (
            topic,
            heard.type_name,
            "-" if heard.count is None else heard.count,
            f"{heard.rate:.2f} Hz" if heard.rate else "-",
            heard.last,
        )
        for topic, heard in evidence.published.items()
    ]
    subscribed = [(topic, _types(nodes)) for topic, nodes in evidence.subscribers.items()]
    log = "\n".join(evidence.log)
    return f"""# Evidence

`{package}` was built from nothing and run on {now:%Y-%m-%d at %H:%M}: a copy of the files below was built in an
empty folder, and each executable was started by `ros2 run`, in a ROS domain of its own.
The commands {", ".join(f"`{command}`" for command in COMMANDS)} were published on `{COMMAND_TOPIC}`.

## Executables

{Table(("executable", "at the end"), evidence.programs.items()).markdown()}

## Nodes

{chr(10).join(f"- `{node}`" for node in evidence.nodes) or "none"}

## Topics published

{Table(("topic", "type", "messages", "rate", "last value"), published).markdown()}

## Topics subscribed to

{Table(("topic", "type"), subscribed).markdown()}

## Log

```text
{log}
```

## Sources

{_sources_table(evidence.sources)}
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
            yield NAMED, re.fullmatch(r"[a-z_][a-z0-9_]*", node.name) is not None, node.lineno
            yield "type hints", _is_annotated(node), node.lineno
        if isinstance(node, ast.ClassDef):
            yield (
                NAMED,
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


def _unwritten(manifest: Path) -> Iterator[str]:
    """Yield of license, description and maintainer an entry each: "" if it is written, else where it is not."""
    try:
        root = ET.fromstring(manifest.read_text(encoding="utf-8"))  # noqa: S314 -- the student's own
    except (OSError, ValueError, ET.ParseError):
        yield f"{manifest.name} cannot be read"
        return
    for name in ("license", "description", "maintainer"):
        element = root.find(name)
        text = "" if element is None else f"{element.text or ''} {element.get('email', '')}"
        is_written = bool(text.strip()) and "todo" not in text.lower()
        yield "" if is_written else f"{manifest.name}: <{name}>"


def _is_annotated(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    given = [one for one in arguments if one.arg not in ("self", "cls")]
    return function.returns is not None and all(one.annotation is not None for one in given)
