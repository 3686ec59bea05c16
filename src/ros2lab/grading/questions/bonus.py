"""What goes beyond the assignment."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import PurePosixPath
from typing import Any

from ros2lab.assignments import Part
from ros2lab.grading.evidence import Run
from ros2lab.grading.player import Player, is_timers
from ros2lab.grading.players import Case
from ros2lab.grading.questions.answer import Answer, last_word, listed, question, shown
from ros2lab.grading.questions.publisher import period_of
from ros2lab.rhythm import LEAST_CHANGE

# Parts of the names of parameters that can hardly be anything but a timer's.
_SURELY_TIMERS = re.compile(r"period|interval|timer|publish|status", re.IGNORECASE)
_DIED = re.compile(r"\[([\w.-]+)-\d+\]: process has died")  # with an error, as `ros2 launch` says it

NEARLY = 1.2  # times, from the change of a parameter to that of a period that follows it


@question(
    "all ended not_installed some nothing untried missing",
    "file lost",
    frozenset(
        (
            "launch-syntax",
            "launch-function",
            "launch-package",
            "launch-executable",
            "not-in-data-files",
            "parameter-type",
        )
    ),
)
def launch_file_starts_all(case: Case) -> Answer:
    """Whether a launch file starts every node that works, and at least two parts of the assignment."""
    paths = case.evidence.files.launch_files
    if not paths:
        return Answer("missing", {"file": "", "lost": ""}, ("files.launch_files",))
    working = {name for name, players in case.players.items() if players}
    least = min(2, len(case.assignment.parts))
    is_tried = any(run.setting == "launched" for run in case.evidence.runs)
    seen = {"file": shown(PurePosixPath(paths[0]).name), "lost": ""}
    best = Answer("nothing" if is_tried else "untried", seen, ("runs",), shown(paths[0]))
    most = 0
    for number, run in enumerate(case.evidence.runs):
        if run.setting != "launched":
            continue
        started = working & case.started(run)
        died = {name for said in run.ended.values() for name in _DIED.findall(said)} & case.executables.keys()
        if not working and len(died) > 1:
            seen = {"file": shown(run.programs[0]), "lost": ""}
            best = Answer("ended", seen, (f"runs[{number}].ended",), shown(paths[0]))
        has_ended = run.ended and not any(command.is_alive for command in run.commands)
        if has_ended and best.level == "nothing":
            said = last_word(run.ended.get(run.programs[0], ""))
            seen = {"file": shown(run.programs[0]), "lost": f": it ended with {shown(said)}" if said else ""}
            best = Answer("nothing", seen, (f"runs[{number}].ended",), shown(paths[0]))
        if has_ended or len(started) <= most:
            continue
        most = len(started)
        file = run.programs[0]
        is_installed = any(PurePosixPath(path).name == file for path in _shared(case))
        # One that ends by itself may have ended before it was seen; that counts elsewhere.
        missing = {
            name
            for name in working - started
            if not any(player.is_read or player.node in case.short_lived for player in case.players[name])
        }
        if most < least:
            missing = case.assignment.parts.keys() - started
        lost = listed([part.topic for name, part in case.assignment.parts.items() if name in missing])
        level = "some" if lost else "all" if is_installed else "not_installed"
        place = next((path for path in paths if PurePosixPath(path).name == file), file)
        best = Answer(level, {"file": shown(file), "lost": lost}, (f"runs[{number}].nodes",), shown(place))
    absent = case.evidence.build.absent if case.evidence.build else []
    if best.level == "nothing" and absent:
        return replace(best, not_tried=f"{best.seen['file']} needs {listed(absent)}, not installed here")
    return best


@question("all some none unseen missing", "without", frozenset(("parameter-undeclared", "parameter-type")))
def period_parameters_take_effect(case: Case) -> Answer:
    """Whether a timer fires at another rate when its parameter is another one."""
    alone = {run.programs[0]: run for run in case.evidence.runs if run.setting == "alone" and run.programs}
    of_messages = {
        parameter.name
        for part in case.assignment.parts.values()
        for parameter in part.parameters
        if parameter.changes == "message"
    }
    effects = {
        (number, f"{run.programs[0]} {run.setting.partition(':=')[0]}"): _takes_effect(
            alone[run.programs[0]], run
        )
        for number, run in enumerate(case.evidence.runs)
        if ":=" in run.setting
        and run.programs
        and run.programs[0] in alone
        and run.setting.partition(":=")[0] not in of_messages
    }
    answered = {name for run in alone.values() for values in run.parameters.values() for name in values}
    at_work = {key[1].partition(" ")[2] for key, effect in effects.items() if effect}

    def is_meant(name: str) -> bool:
        # Where no name is a timer's, other numbers were tried; one that has no effect is for something else.
        # What a program does not tell of may be another's.
        return is_timers(name) and (name in answered or name not in at_work)

    effects = {key: one for key, one in effects.items() if one or is_meant(key[1].partition(" ")[2])}
    known = {key: effect for key, effect in effects.items() if effect is not None}
    if not known:
        return Answer("unseen" if effects else "missing", {"without": ""}, ("runs",))
    working = {name.partition(" ")[0] for (_, name), effect in known.items() if effect}
    # A turn rate is no timer's: what has such a name is a fault only where no parameter of the program is one's.
    without = [
        name
        for (_, name), effect in known.items()
        if not effect
        and (name.partition(" ")[0] not in working or _SURELY_TIMERS.search(name.partition(" ")[2]))
    ]
    level = "all" if not without else "some" if len(without) < len(known) else "none"
    keys = tuple(f"runs[{number}].setting" for number, _ in known)
    return Answer(level, {"without": listed(without)}, keys)


@question(
    "used loaded not_installed partly own unused untried missing",
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
    """Whether the nodes have the values of a parameter file when they are launched, or when started as README says."""
    files = case.evidence.files.parameter_files
    if not files:
        return Answer("missing", {"file": "", "fault": ""}, ("files.parameter_files",))
    order = ("used", "loaded", "not_installed", "partly", "own", "unused", "untried")
    answers = [_parameter_file(case, path, nodes) for path, nodes in files.items()]
    return min(answers, key=lambda answer: order.index(answer.level))


@question("by_name wholesale none")
def errors_are_handled(case: Case) -> Answer:
    """Whether exceptions are caught, and caught by name."""
    handlers = case.evidence.files.handlers
    key = "by name" if handlers.get("by name") else "wholesale"
    places = handlers.get(key) or []
    if not places or not case.executables:
        return Answer("none", {}, ("files.handlers",))
    place = shown(f"{places[0].file}:{places[0].line}")
    return Answer("by_name" if key == "by name" else "wholesale", {}, ("files.handlers",), place)


@question("sound blind failing untried missing", "error files")
def tests_find_faults(case: Case) -> Answer:
    """Whether the package's own tests pass, and fail when a node is broken."""
    tests = case.evidence.tests
    passed, failed = int(tests.get("passed") or 0), int(tests.get("failed") or 0)
    left_out = case.evidence.files.tests_left_out
    seen = {"error": last_word(tests.get("error") or ""), "files": listed(left_out)}
    if left_out and not case.evidence.files.tests:
        return Answer("untried", seen, ("files.tests_left_out",), shown(left_out[0]))
    if not case.evidence.files.tests or not (passed or failed or tests.get("error")):
        return Answer("missing", seen, ("files.tests",))
    if failed or not passed:
        return Answer("failing", seen, ("tests",))
    return Answer("sound" if tests.get("is_noticed") else "blind", seen, ("tests",))


def _is_built(case: Case) -> bool:
    return case.evidence.build is not None and case.evidence.build.is_built


def _shared(case: Case) -> list[str]:
    return case.evidence.build.shared if case.evidence.build else []


def _takes_effect(before: Run, after: Run) -> bool | None:
    """Return whether any topic comes at another rate; None if none comes again and again before.

    Where the name is not a timer's, the rate must have changed as the value has: a loop's rhythm may differ by chance.
    """
    periods = [*_periods(before, after)]
    if not periods:
        return None
    changes = [max(new / old, old / new) for old, new in periods if new]
    name, _, value = after.setting.partition(":=")
    if is_timers(name):
        return any(change >= LEAST_CHANGE for change in changes)
    own = (values.get(name) for values in before.parameters.values())
    asked = [abs(float(value) / one) for one in own if isinstance(one, (int, float)) and one]
    return any(1 / NEARLY < change / max(one, 1 / one) < NEARLY for change in changes for one in asked)


def _periods(before: Run, after: Run) -> Iterator[tuple[float, float | None]]:
    for topic in before.publishes:
        part = Part("", "publisher", topic, "")
        pair = [period_of(Player(part, "right", topic, "", (), 0, run, "")) for run in (before, after)]
        if pair[0]:
            yield pair[0], pair[1] or None


def _parameter_file(case: Case, path: str, nodes: dict[str, dict[str, Any]]) -> Answer:
    """Answer for one parameter file."""
    seen = {"file": shown(PurePosixPath(path).name), "fault": ""}
    launched = [run for run in case.evidence.runs if run.setting == "launched" and run.parameters]
    readme, users = case.evidence.files.readme, case.evidence.files.parameter_file_users
    is_in_readme = PurePosixPath(path).name in readme and "params-file" in readme
    if not nodes:
        seen["fault"] = "it sets no parameter below ros__parameters"
        is_read = any(name not in case.evidence.files.launch_files for name in users.get(path, []))
        return Answer("own" if is_read else "unused", seen, ("files.parameter_files",), shown(path))
    if not is_in_readme and path in users and not users[path]:
        seen["fault"] = "no launch file and no command of the README loads it"
        return Answer("unused", seen, ("files.parameter_file_users",), shown(path))
    runs = launched or ([run for run in case.evidence.runs if run.setting == "alone"] if is_in_readme else [])
    if not runs and not _is_built(case):
        return Answer("untried", seen, ("build.is_built",), shown(path))
    faults: list[str] = []
    fits = believed = 0
    for pattern, values in nodes.items():
        meant = _meant(case, pattern, runs)
        if not meant and _is_unasked(case, pattern):
            foreign = [name for name in values if name not in case.evidence.files.declared]
            faults += [f"{shown(name)} of {shown(pattern)} is no parameter of it" for name in foreign]
            believed += len(values) - len(foreign)
        elif not meant and not _counts_elsewhere(case, pattern):
            faults.append(f"there is no node {shown(pattern)}")
        for name, value in values.items() if meant else ():
            fault = _misfit(meant, name, value)
            faults += [f"{shown(name)} of {shown(pattern)} {fault}"] if fault else []
            fits += not fault
    is_installed = any(PurePosixPath(one).name == PurePosixPath(path).name for one in _shared(case))
    if faults and not is_installed and not is_in_readme:
        name = PurePosixPath(path).name
        lies = [one for one in case.evidence.files.hard_coded if PurePosixPath(one).name == name]
        where = f"the launch file loads {shown(lies[0])}, which is there on one machine only" if lies else ""
        faults.insert(0, where or "data_files in setup.py does not install it")
    seen["fault"] = faults[0] if faults else "nothing that was started loads it"
    is_lost = any(not players for players in case.players.values())  # whose values they may be
    level = (
        ("untried" if is_lost else "unused")
        if not fits + believed
        else "partly"
        if faults
        else "loaded"
        if believed and (is_installed or is_in_readme)
        else "used"
        if is_installed or is_in_readme
        else "not_installed"
    )
    return Answer(level, seen, ("files.parameter_files", "build.shared"), shown(path))


def _meant(case: Case, pattern: str, runs: list[Run]) -> list[tuple[Run, str]]:
    """Return the nodes that a name in a parameter file fits, and the runs in which their parameters were seen.

    That a launch file does not start a node, or that it ends at once, counts elsewhere; its parameters are known from
    when it was alone.
    """
    started = [(run, node) for run in runs for node in run.parameters]
    unlaunched = [
        (player.run, player.node)
        for players in case.players.values()
        if not any(
            player.run.setting == "launched" and player.node in player.run.parameters for player in players
        )
        for player in players
        if player.node in player.run.parameters
    ]
    return [(run, node) for run, node in (*started, *unlaunched) if _fits(pattern, node)]


def _is_unasked(case: Case, pattern: str) -> bool:
    """Return whether there is such a node, and it did not answer what parameters it has."""
    return any(_fits(pattern, node) for run in case.evidence.runs for node in run.unasked)


def _counts_elsewhere(case: Case, pattern: str) -> bool:
    """Return whether there is no such node because it was never written, or ends by itself."""
    meant = case.assignment.meant_by(pattern)
    is_lost = meant is not None and not case.players[meant.name]
    return is_lost or any(_fits(pattern, node) for node in case.short_lived)


def _misfit(meant: list[tuple[Run, str]], name: str, value: Any) -> str:
    """Return what is wrong with a value in a parameter file; empty if nothing is."""
    held = [(run, node, run.parameters[node][name]) for run, node in meant if name in run.parameters[node]]
    if not held:
        return "is no parameter of it"
    is_launched = any(run.setting == "launched" for run, *_ in held)
    if not is_launched and not any(_is_alike(one, value) for *_, one in held):
        return "has another type"
    if is_launched and not any(node in run.twins or _is_same(one, value) for run, node, one in held):
        return "has another value"
    return ""


def _fits(pattern: str, node: str) -> bool:
    """Return whether a parameter file's name for nodes, such as `/**/status`, is that of a node."""
    expression = re.escape(pattern.lstrip("/")).replace(r"/\*\*/", "/(?:.*/)?").replace(r"\*\*/", "(?:.*/)?")
    expression = expression.replace(r"\*\*", ".*").replace(r"\*", "[^/]*")
    return re.fullmatch(expression, node.lstrip("/")) is not None


def _is_alike(one: Any, other: Any) -> bool:
    """Return whether one value of a parameter may replace another; a list is shown as a text in a file's facts."""
    return type(one) is type(other) or isinstance(one, list)


def _is_same(one: Any, other: Any) -> bool:
    try:
        return bool(float(one) == float(other))
    except (TypeError, ValueError, OverflowError):
        return str(one) == str(other)
