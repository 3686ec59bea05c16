"""The parameter file: whether the nodes have its values."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

from ros2lab.grading.evidence import Run
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.answer import Answer, question, shown

_ORDER = ("used", "loaded", "not_installed", "partly", "own", "lost", "unused", "untried")


@question(
    "used loaded not_installed partly own lost unused untried missing",
    "file fault",
    frozenset(
        (
            "parameter-file-missing",
            "parameter-file-node",
            "parameter-name",
            "parameter-file-syntax",
            "parameter-type",
        )
    ),
)
def parameter_file_is_used(case: Case) -> Answer:
    """Whether the nodes have a parameter file's values when launched, or when started as the README says."""
    files = case.evidence.files.parameter_files
    if not files:
        return Answer("missing", {"file": "", "fault": ""}, ("files.parameter_files",))
    answers = [_answer(_File(case, path, nodes)) for path, nodes in files.items()]
    return min(answers, key=lambda answer: _ORDER.index(answer.level))


@dataclass(frozen=True)
class _File:
    """A parameter file, and what is known of its use."""

    case: Case
    path: str
    nodes: Mapping[str, Mapping[str, Any]]

    @property
    def name(self) -> str:
        return PurePosixPath(self.path).name

    @property
    def users(self) -> list[str] | None:
        """The files that name it; None if that is not known."""
        return self.case.evidence.files.parameter_file_users.get(self.path)

    @property
    def is_in_readme(self) -> bool:
        """Whether a command in the README passes it to a node."""
        readme = self.case.evidence.files.readme
        return self.name in readme and "params-file" in readme

    @property
    def is_installed(self) -> bool:
        build = self.case.evidence.build
        return build is not None and any(PurePosixPath(path).name == self.name for path in build.shared)

    @property
    def runs(self) -> list[Run]:
        """The runs in which its values should be seen."""
        runs = self.case.evidence.runs
        launched = [run for run in runs if run.setting == "launched" and run.parameters]
        alone = [run for run in runs if run.setting == "alone"]
        return launched or (alone if self.is_in_readme else [])


@dataclass
class _Held:
    """How much of a parameter file fits: values that nodes have, values that code declares, and faults."""

    fits: int = 0
    believed: int = 0
    faults: list[str] = field(default_factory=list)


def _answer(file: _File) -> Answer:
    """Answer for one parameter file."""
    build = file.case.evidence.build
    if not file.nodes:
        launch_files = file.case.evidence.files.launch_files
        is_read = any(user not in launch_files for user in file.users or ())
        fault = "it sets no parameter below ros__parameters"
        level = "unused" if not is_read else "own" if build and build.is_built else "untried"
        fault = "the package was not built" if level == "untried" else fault
        return _told(file, level, fault, "files.parameter_files", "build.is_built")
    if not file.is_in_readme and file.users == []:
        fault = "no launch file and no command of the README loads it"
        return _told(file, "unused", fault, "files.parameter_file_users")
    if not file.runs and not (build and build.is_built):
        return _told(file, "untried", "the package was not built", "build.is_built")
    if not any(run.nodes for run in file.case.evidence.runs):
        return _told(file, "untried", "no node at all was seen", "runs")
    held = _Held()
    for pattern, values in file.nodes.items():
        _hold(file, pattern, values, held)
    if held.faults and not file.is_installed and not file.is_in_readme:
        held.faults.insert(0, _astray(file))
    fault = held.faults[0] if held.faults else "nothing that was started loads it"
    return _told(file, _level(file, held), fault, "files.parameter_files", "build.shared")


def _told(file: _File, level: str, fault: str, *keys: str) -> Answer:
    return Answer(level, {"file": shown(file.name), "fault": fault}, keys, shown(file.path))


def _level(file: _File, held: _Held) -> str:
    if not held.fits + held.believed:
        is_lost = any(not players for players in file.case.players.values())  # the values may be for them
        return "lost" if is_lost else "unused"
    if held.faults:
        return "partly"
    if not (file.is_installed or file.is_in_readme):
        return "not_installed"
    return "loaded" if held.believed else "used"


def _astray(file: _File) -> str:
    """Return why a file that is not installed is not found, as a clause."""
    hard_coded = file.case.evidence.files.hard_coded
    lies = next((path for path in hard_coded if PurePosixPath(path).name == file.name), "")
    if lies:
        return f"the launch file loads {shown(lies)}, which is there on one machine only"
    return "data_files in setup.py does not install it"


def _hold(file: _File, pattern: str, values: Mapping[str, Any], held: _Held) -> None:
    """Compare the values for a name in the file with those of its nodes; enter the result in `held`."""
    case, node = file.case, shown(pattern)
    meant = _meant(case, pattern, file.runs)
    if meant:
        faults = {name: _misfit(meant, name, value) for name, value in values.items()}
        held.faults += [f"{shown(name)} of {node} {fault}" for name, fault in faults.items() if fault]
        held.fits += sum(not fault for fault in faults.values())
    elif _is_unasked(case, pattern):
        foreign = [name for name in values if name not in case.evidence.files.declared]
        held.faults += [f"{shown(name)} of {node} is no parameter of it" for name in foreign]
        held.believed += len(values) - len(foreign)
    elif not _counts_elsewhere(case, pattern):
        held.faults.append(f"there is no node {node}")


def _meant(case: Case, pattern: str, runs: Sequence[Run]) -> list[tuple[Run, str]]:
    """Return the nodes that a name in a parameter file fits, each with a run that shows its parameters.

    A node that is not launched, or ends at once, counts elsewhere; its parameters are taken from other runs.
    """
    started = [(run, node) for run in runs for node in run.parameters]
    for players in case.players.values():
        known = [(player.run, player.node) for player in players if player.node in player.run.parameters]
        if not any(run.setting == "launched" for run, _ in known):
            started += known
    return [(run, node) for run, node in started if _fits(pattern, node)]


def _is_unasked(case: Case, pattern: str) -> bool:
    """Return whether there is such a node that did not report its parameters."""
    return any(_fits(pattern, node) for run in case.evidence.runs for node in run.unasked)


def _counts_elsewhere(case: Case, pattern: str) -> bool:
    """Return whether such a node is missing because it was never written, or ends by itself."""
    meant = case.assignment.meant_by(pattern)
    is_lost = meant is not None and not case.players[meant.name]
    return is_lost or any(_fits(pattern, node) for node in case.short_lived)


def _misfit(meant: Sequence[tuple[Run, str]], name: str, value: Any) -> str:
    """Return what is wrong with a value in a parameter file, as a clause; empty if nothing is."""
    held = [(run, node, run.parameters[node][name]) for run, node in meant if name in run.parameters[node]]
    if not held:
        return "is no parameter of it"
    is_launched = any(run.setting == "launched" for run, *_ in held)
    if not is_launched and not any(_is_alike(current, value) for *_, current in held):
        return "has another type"
    if is_launched and not any(node in run.twins or _is_same(current, value) for run, node, current in held):
        return "has another value"
    return ""


def _fits(pattern: str, node: str) -> bool:
    """Return whether a parameter file's name for nodes, such as `/**/status`, matches a node."""
    expression = re.escape(pattern.lstrip("/")).replace(r"/\*\*/", "/(?:.*/)?").replace(r"\*\*/", "(?:.*/)?")
    expression = expression.replace(r"\*\*", ".*").replace(r"\*", "[^/]*")
    return re.fullmatch(expression, node.lstrip("/")) is not None


def _is_alike(current: Any, wanted: Any) -> bool:
    """Return whether a value may replace a parameter's current one; lists are texts in the file's facts."""
    return type(current) is type(wanted) or isinstance(current, list)


def _is_same(current: Any, wanted: Any) -> bool:
    try:
        return bool(float(current) == float(wanted))
    except (TypeError, ValueError, OverflowError):
        return str(current) == str(wanted)
