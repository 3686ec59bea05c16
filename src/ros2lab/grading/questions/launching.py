"""The launch file: whether it starts all nodes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import PurePosixPath

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.evidence import TIMED, Run
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.answer import Answer, ended, is_shut_down, listed, question, shown

_DIED = re.compile(r"\[([\w.-]+)-\d+\]: process has died")  # with an error, as `ros2 launch` says it
# launch's error for a program that is not on the PATH; a program's own output has its name before it.
_NOT_HERE = re.compile(
    r"(?:\[ERROR\] \[[^\]]+\]: exception occurred while executing process: |FileNotFoundError: )"
    r"\[Errno 2\] No such file or directory: '([^'/]+)'"
)
_NO_PACKAGE = re.compile(r"PackageNotFoundError: \W*package '([^']+)' not found")
_NO_MODULE = re.compile(r"ModuleNotFoundError: No module named '(\w+)")
_OF_ROS = ("ros2", "python3", "python")
_ORDER = (
    "all",
    "not_installed",
    "some",
    "moved",
    "few",
    "ended",
    "no_part",
    "shut_down",
    "nothing",
    "untried",
)


_FAULTS = frozenset(
    (
        "launch-syntax",
        "launch-function",
        "launch-package",
        "launch-executable",
        "not-in-data-files",
        "parameter-type",
    )
)


@question(
    "all ended not_installed some moved few no_part shut_down nothing untried missing",
    "file lost nodes elsewhere",
    _FAULTS,
)
def launch_file_starts_all(case: Case) -> Answer:
    """Whether a launch file starts every node that works, and nodes for at least two parts.

    If no node plays a part, it must start every node that was seen.
    """
    files = case.evidence.files
    seen = {"file": "", "lost": "", "nodes": "", "elsewhere": ""}
    if not files.launch_files:
        names = listed([PurePosixPath(path).name for path in files.launch_files_elsewhere])
        seen["elsewhere"] = f"; {names} of another package starts no node of this one" if names else ""
        return Answer("missing", seen, ("files.launch_files",))
    seen["file"] = shown(PurePosixPath(files.launch_files[0]).name)
    untried = Answer("untried", seen, ("runs",), shown(files.launch_files[0]))
    runs = [(number, run) for number, run in enumerate(case.evidence.runs) if run.setting == "launched"]
    answers = [(_started(case, run), _launched(case, number, run, seen)) for number, run in runs]
    # The launch file that starts most; of equal ones the best answer, and of these the first.
    _, best = min(
        answers, key=lambda pair: (-len(pair[0]), _ORDER.index(pair[1].level)), default=(set(), untried)
    )
    return best


def excuse(case: Case, path: str) -> str:
    """Return why a launch file started nothing, if it needs packages not installed here; else empty.

    It must also start something of the submission. A fault of its own, or an end for another reason, is no
    excuse.
    """
    files, build, file = case.evidence.files, case.evidence.build, PurePosixPath(path).name
    absent = [name for name in files.launched_packages.get(path, []) if build and name in build.absent]
    said = [
        run.ended[file]
        for run in case.evidence.runs
        if run.setting == "launched" and run.programs[0] == file and run.ended.get(file)
    ]
    absent += [*_modules_missing(case, said), *_unbuilt(case, said)]
    is_for_another = said and not any(name in text for name in absent for text in said)
    is_faulty = any(
        finding.code in _FAULTS and re.sub(r":\d+$", "", finding.place) == path for finding in files.told()
    )
    is_excused = absent and _names_own(case, path) and not is_faulty and not is_for_another
    return f"{file} needs {listed(absent)}, not installed here" if is_excused else ""


def _unbuilt(case: Case, said: Iterable[str]) -> list[str]:
    """Return the packages of the hand-in that launch did not find because only others were built here."""
    submission = case.evidence.submission
    graded = {package.name for package in (submission.package, *submission.also) if package}
    names = {package.name for package in submission.packages} - graded
    return [*dict.fromkeys(name for text in said for name in _NO_PACKAGE.findall(text) if name in names)]


def _modules_missing(case: Case, said: Iterable[str]) -> list[str]:
    """Return the modules that launch did not find, without misspelt names of installed or own packages."""
    own = [package.name or "" for package in case.evidence.submission.packages]
    names = [name for text in said for name in _NO_MODULE.findall(text)]
    return [
        name
        for name in dict.fromkeys(names)
        if not interfaces.meant(name)
        and not any(name == package or is_near_miss(name, package) for package in own)
    ]


def _lacks(case: Case, run: Run, path: str) -> str:
    """Return why nodes were not started, if a program that starts them, such as a terminal, is missing here.

    Each missing program explains at most one node, and only a node whose own program the launch file names.
    """
    lines = [
        *(text for _, text in run.log),
        *(line for said in run.ended.values() for line in said.splitlines()),
    ]
    absent = [match[1] for match in map(_NOT_HERE.fullmatch, dict.fromkeys(map(str.strip, lines))) if match]
    known = {*case.executables, *_OF_ROS}
    absent = [
        name
        for name in absent
        if name not in known and not any(is_near_miss(name, program) for program in known)
    ]
    named = case.evidence.files.launched_programs.get(path)
    lost = _lost(case, _started(case, run))
    is_meant = all(
        named is None or any(player.program in named for player in case.players[name]) for name in lost
    )
    if not absent or not lost or len(lost) > len(absent) or not is_meant:
        return ""
    names = listed([*dict.fromkeys(absent)])
    return f"{PurePosixPath(path).name} starts programs by {names}, not installed here"


def _names_own(case: Case, path: str) -> bool:
    """Return whether a launch file names a package that was handed in; True if that is not known."""
    named = case.evidence.files.launched_packages.get(path)
    return named is None or any(package.name in named for package in case.evidence.submission.packages)


def _started(case: Case, run: Run) -> set[str]:
    """Return the working parts that a launch file starts; empty if it ended by itself.

    A node whose topic is wrong anyway may have another name, or another topic, when it is launched.
    """
    if _has_ended(run):
        return set()
    working = {name for name, players in case.players.items() if players}
    near = {name for name in working if all(player.match != "right" for player in case.players[name])}
    return (working & case.started(run)) | {name for name in near if _is_there(case, run, name)}


def _path_of(case: Case, run: Run) -> str:
    """Return the path of the launch file of a run; its name if that is not known."""
    file, paths = run.programs[0], case.evidence.files.launch_files
    return next((path for path in paths if PurePosixPath(path).name == file), file)


def _has_ended(run: Run) -> bool:
    """Return whether a launch file ended before any command, or began a timer by which it will end."""
    is_timed = any(text == TIMED for _, text in run.log)
    return is_timed or (bool(run.ended) and not any(command.is_alive for command in run.commands))


def _launched(case: Case, number: int, run: Run, nothing: dict[str, str]) -> Answer:
    """Answer for one launch file, by its run."""
    file, path = run.programs[0], _path_of(case, run)
    build = case.evidence.build
    is_installed = build is not None and any(PurePosixPath(shared).name == file for shared in build.shared)
    seen = nothing | {"file": shown(file if is_installed else path)}
    keys: tuple[str, ...] = (f"runs[{number}].ended",)
    died = {name for said in run.ended.values() for name in _DIED.findall(said)} & case.executables.keys()
    if not any(case.players.values()) and len(died) > 1:
        return Answer("ended", seen, keys, shown(path))
    if _has_ended(run):
        said = run.ended.get(file, "")
        level = "nothing" if file in run.ended and not is_shut_down(said) else "shut_down"
        told = {"lost": f": it ended {ended(said, 'with')}" if said else ""}
    else:
        level, told = _of_nodes(case, run, path, is_installed=is_installed)
        keys = (f"runs[{number}].nodes",)
    why = excuse(case, path) if level == "nothing" else ""
    why = why or (_lacks(case, run, path) if level in ("nothing", "some", "few") else "")
    return Answer(level, seen | told, keys, shown(path), why)


def _of_nodes(case: Case, run: Run, path: str, *, is_installed: bool) -> tuple[str, dict[str, str]]:
    """Return the level for a launch file that goes on, by its nodes, and the values for its sentence."""
    whole = "all" if is_installed else "not_installed"
    if started := _started(case, run):
        names = _lost(case, started)
        lost = listed([case.assignment.parts[name].topic for name in names])
        if names and all(_is_there(case, run, name) for name in names):
            return "moved", {"lost": lost}
        is_few = len(started) < min(2, len(case.assignment.parts))
        topics = listed([case.assignment.parts[name].topic for name in sorted(started)])
        return ("some" if lost else "few" if is_few else whole), {"lost": lost, "nodes": topics}
    if not run.nodes:
        return "nothing", {} if _names_own(case, path) else {
            "lost": ": it names no package that was handed in"
        }
    ends = set[tuple[str, str]]().union(
        *(_ends(lone_run) for lone_run in case.evidence.runs if lone_run.setting == "alone")
    )
    is_any_played = any(case.players.values())
    if not is_any_played and len({node for node, _ in ends}) > 1 and ends <= _ends(run):
        return whole, {}
    return "no_part", {"nodes": listed(sorted({*run.nodes}))}


def _is_there(case: Case, run: Run, name: str) -> bool:
    """Return whether a node that plays a part was started, under whatever name and on whatever topic."""
    played = {_base(player.node) for player in case.players[name]}
    return any(played & _nodes_like(case, run, node) for node in run.nodes)


def _nodes_like(case: Case, run: Run, node: str) -> set[str]:
    """Return which nodes of single programs a launched node may be: the one of its name, else those most like it.

    A launch file may give it another name, so that its topics tell, or other topics, so that their types do.
    """
    named = case.evidence.files.launched_programs.get(_path_of(case, run))
    alone = [
        (own, other)
        for own in case.evidence.runs
        if own.setting == "alone" and (named is None or own.programs[0] in named)
        for other in own.nodes
    ]
    types = {*_shape(run, node, has_topics=False)}
    # One that has only other types is another program's, to which the launch file gives that name.
    if any(
        _base(node) == _base(other) and not (types and types.isdisjoint(_shape(own, other, has_topics=False)))
        for own, other in alone
    ):
        return {_base(node)}
    for has_topics in (True, False):
        launched = _shape(run, node, has_topics=has_topics)
        found = {
            _base(other) for own, other in alone if _shape(own, other, has_topics=has_topics) == launched
        }
        if found and launched:
            return found
    return set()


def _shape(run: Run, node: str, *, has_topics: bool) -> list[tuple[str, ...]]:
    """Return the ends of a node: publisher or subscription, the types, and the topic if that is asked for."""
    return sorted(
        (end, *sorted(nodes[node]), *((topic,) if has_topics else ()))
        for end, topics in (("publisher", run.publishes), ("subscription", run.subscribes))
        for topic, nodes in topics.items()
        if node in nodes
    )


def _base(node: str) -> str:
    """Return the name of a node without its namespace."""
    return node.rpartition("/")[2]


def _ends(run: Run) -> set[tuple[str, str]]:
    """Return the nodes of a run, each with each of its topics."""
    return {
        (node, topic) for ends in (run.publishes, run.subscribes) for topic in ends for node in ends[topic]
    }


def _lost(case: Case, started: set[str]) -> list[str]:
    """Return the parts that a launch file should also start: those that a node plays without it."""
    # A node that ends by itself may have ended unseen; that counts elsewhere. Nor do launched nodes have a
    # keyboard.
    return [
        name
        for name, players in case.players.items()
        if players and name not in started
        if not any(
            player.is_read or player.run.typed or player.node in case.short_lived for player in players
        )
    ]
