"""What is handed in: evidence that the package runs, and the archive."""

from __future__ import annotations

import datetime
import itertools
import os
import re
import sys
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ros2lab import assignments, course
from ros2lab.clean_build import (
    CleanBuild,
    built_from_nothing,
    differing,
    digests,
    handed_in,
    is_readme,
)
from ros2lab.grading.evidence import Run
from ros2lab.node_process import last_line
from ros2lab.observed_domain import ObservedDomain
from ros2lab.practices import practices  # noqa: F401 -- the lesson calls both
from ros2lab.rehearsal import OBSERVED, Rehearsal
from ros2lab.rhythm import period_of
from ros2lab.run_record import LEVELS
from ros2lab.table import Table
from ros2lab.topics import TopicLog
from ros2lab.workspace import Workspace

ASSIGNMENT = assignments.load()
PACKAGE = ASSIGNMENT.package
PUBLISHED = tuple(part.topic for part in ASSIGNMENT.parts.values() if part.is_publisher)
COMMANDED = next(part for part in ASSIGNMENT.parts.values() if part.commands)
COMMAND_TOPIC, COMMANDS = COMMANDED.topic, COMMANDED.commands
TOPICS = ASSIGNMENT.topics
EVIDENCE_FILE = "EVIDENCE.md"
RUNS = "runs"  # of a program that has not ended
GENERATED_TESTS = ("test_copyright", "test_flake8", "test_pep257")  # of `ros2 pkg create`; of style
LAUNCH_FILES = ("*launch.*", "launch/*.py")
YAML_FILES = ("*.yaml", "*.yml")


@dataclass(frozen=True)
class Published:
    """What was published on a topic while the package ran.

    Attributes:
        type_name: such as `std_msgs/msg/String`.
        count: how many messages came; None if its type cannot be imported here.
        rate: in Hz, from the median gap before any command, or after the last one; None for fewer than two messages.
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
        published: what was received, by topic.
        shared: what lies in `share/<package>`, relative to that folder.
        log: the log lines, in their order.
        run: all of it as the grader has it; None if it could not be built.
    """

    file: Path = field(repr=False)
    sources: dict[str, str] = field(repr=False)
    fault: str = ""
    programs: dict[str, str] = field(default_factory=dict)
    published: dict[str, Published] = field(default_factory=dict)
    shared: list[str] = field(default_factory=list)
    log: list[str] = field(default_factory=list, repr=False)
    run: Run | None = field(default=None, repr=False)

    @property
    def nodes(self) -> list[str]:
        """The full names of the nodes."""
        return self.run.nodes if self.run else []

    @property
    def publishers(self) -> dict[str, dict[str, list[str]]]:
        """The types of what was published, by topic and node."""
        return self.run.publishes if self.run else {}

    @property
    def subscribers(self) -> dict[str, dict[str, list[str]]]:
        """The types of what was subscribed to, by topic and node."""
        return self.run.subscribes if self.run else {}

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
        seconds: how long it is watched before the commands, at most.

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
    commands = {
        executable.name: ["ros2", "run", package, executable.name]
        for executable in built.executables(package)
    }
    with ObservedDomain() as domain:
        rehearsal = Rehearsal(domain, commands, overlay)
        rehearsal.play(seconds)
        record, run = rehearsal.record, rehearsal.record.run()
        types = domain.published()
        return Evidence(
            file,
            sources,
            run=run,
            programs={
                name: f"ended: {last_line(run.ended[name])}" if name in run.ended else RUNS
                for name in commands
            },
            published={
                topic: _published(types[topic][0], log, run, topic)
                for topic, log in record.logs.items()
                if topic in types
            },
            shared=[
                path.relative_to(folder).as_posix()
                for folder in _shares(built, package)
                for path in shared_files(built, package, "*")
                if path.is_relative_to(folder)
            ],
            log=[_log_line(sample.message) for sample in record.lines.samples()],
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


def _published(type_name: str, log: TopicLog | None, run: Run, topic: str) -> Published:
    """Sum up what came on a topic; the rate is that before any command, or else after the last one."""
    if log is None:
        return Published(type_name, None, None, "nothing")
    stretches = [run.quiet, *(command.topics for command in run.commands[-1:])]
    periods = [period_of(topics[topic].times) for topics in stretches if topic in topics]
    period = next(filter(None, periods), None)
    latest = log.latest
    return Published(
        type_name, log.count, 1.0 / period if period else None, _brief(latest.message if latest else None)
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
    return f"[{LEVELS.get(message.level, message.level)}] [{message.name}]: {message.msg}"


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
