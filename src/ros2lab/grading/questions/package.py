"""Whether package.xml, setup.py and setup.cfg say what they must.

A fault that prevents the build counts at the criterion of the file that has it. Its consequences cost only
the share of `nodes_are_installed` that is for being installed.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Collection, Mapping, Sequence

from ros2lab.assignments import Part
from ros2lab.diagnose.code.imports import ROS_1
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.interfaces import PACKAGES
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.evidence import ELSEWHERE, NO_WORD, NOWHERE, UNBUILT, Build, Executable, Run
from ros2lab.grading.judging.player import lacked
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.answer import Answer, error_of, listed, question, shown
from ros2lab.grading.reading.package_facts import DECLARED, MANIFEST_FINDINGS, SETUP_FINDINGS

_WRITTEN = {
    "description_is_written": "a telling description",
    "license_is_written": "the license",
    "maintainer_is_written": "a maintainer with an address",
}
_NO_MODULE = re.compile(r"No module named '?(\w+)")
_KEEPS_FROM_BUILDING = ("data_files_exist", "has_entry_points", "entry_points_lead_to_functions")
_MARKER_CODES = frozenset(("marker-missing", "setup-cfg-missing", "setup-cfg-dashes", "marker-not-installed"))


def _codes(facts: dict[str, frozenset[str]], *names: str) -> frozenset[str]:
    return frozenset().union(*(facts[name] for name in names))


_MANIFEST, _SETUP = dict(MANIFEST_FINDINGS), dict(SETUP_FINDINGS)
_POINT_CODES = _codes(_SETUP, "entry_points_lead_to_functions")


@question("right invalid wrong_type missing", "", _codes(_MANIFEST, "is_valid", "is_ament_python"))
def manifest_is_valid(case: Case) -> Answer:
    """Whether colcon takes package.xml for that of an ament_python package."""
    facts = case.evidence.files.manifest
    if not facts.get("is_there"):
        level = "missing"
    elif not facts.get("is_valid"):
        level = "invalid"
    else:
        level = "right" if facts.get("is_ament_python") else "wrong_type"
    return Answer(level, {}, ("files.manifest",), case.at("package.xml"))


@question(
    "all other unread one_missing two_missing none",
    "missing fault",
    _codes(_MANIFEST, "dependencies_exist", "declares_all_imports"),
)
def dependencies_are_declared(case: Case) -> Answer:
    """Whether package.xml declares what the nodes import, and nothing that does not exist."""
    facts = case.evidence.files.manifest
    # Packages that no module imports are not required.
    wanted = [name for name in case.assignment.dependencies if f"declares_{name}" in facts]
    wanted = wanted or [*case.assignment.dependencies]
    # A type may come without an import that we can read: packages of types seen at run time are required.
    wanted += [name for name in _packages_seen(case) if f"{DECLARED}{name}" in facts and name not in wanted]
    missing = [
        name for name in wanted if not (facts.get(f"declares_{name}") or facts.get(f"{DECLARED}{name}"))
    ]
    level = (
        "none" if len(missing) == len(wanted) else ("all", "one_missing", "two_missing")[min(len(missing), 2)]
    )
    if not missing and not facts.get("is_valid"):
        level = "unread"
    elif not missing and not (facts.get("dependencies_exist") and facts.get("declares_all_imports")):
        level = "other"
    declared = {fact.removeprefix("declares_"): holds for fact, holds in facts.items() if "declares_" in fact}
    undeclared = [
        name for name, holds in declared.items() if not holds and name not in (*wanted, "all_imports")
    ]
    fault = f"not {listed(undeclared)}, which is imported, too" if undeclared else "also what does not exist"
    seen = {"missing": listed([*missing, *undeclared]), "fault": fault}
    return Answer(level, seen, ("files.manifest",), case.at("package.xml"))


def _packages_seen(case: Case) -> list[str]:
    """Return the packages of the players' types; empty if another package, too, was handed in."""
    if len(case.evidence.submission.packages) != 1:
        return []
    types = (
        type_name
        for players in case.players.values()
        for player in players
        if player.program in case.executables and not player.is_read
        for type_name in player.types
    )
    return [*dict.fromkeys(type_name.partition("/")[0] for type_name in types)]


@question(
    "right other_name no_modules no_code no_files invalid fails no_word missing",
    "error fault but",
    _codes(_SETUP, "is_valid", "installs_modules", "data_files_exist") | {"setup-value"},
)
def setup_installs_the_package(case: Case) -> Answer:
    """Whether setup.py runs and installs the package's modules."""
    facts, build = case.evidence.files.setup, case.evidence.build
    levels = {
        "is_there": "missing",
        "is_valid": "invalid",
        "installs_modules": "no_modules",
        "data_files_exist": "no_files",
        "name_agrees": "other_name",
    }
    if not facts.get("has_code", True):
        levels["installs_modules"] = "no_code"
    wrong = [level for fact, level in levels.items() if not facts.get(fact)]
    is_read = facts.get("is_there") and facts.get("is_valid")
    if is_read and build and not build.is_built and not _is_explained(case) and not wanting(case):
        wrong.insert(
            0, "no_word" if build.error == NO_WORD else "fails"
        )  # neither a name nor missing modules would keep setup.py from running
    level = wrong[0] if wrong else "right"
    causes = [cause for code, cause, *_ in case.evidence.files.findings if code in SETUP_FINDINGS["is_valid"]]
    seen = {
        "error": error_of(build.error) if build else "",
        "fault": shown(causes[0], 160) if causes else "",
        "but": "; why it does not build counts elsewhere" if build and not build.is_built else "",
    }
    return Answer(level, seen, ("files.setup", "build.error"), case.at("setup.py"))


@question("right partly misplaced missing", "fault what", _MARKER_CODES)
def package_is_registered(case: Case) -> Answer:
    """Whether the marker, package.xml and the executables are installed where ROS looks for them."""
    facts, name = _as_installed(case), shown(case.package)
    faults = {
        "marker_exists": "the marker below resource is missing",
        "marker_is_installed": f"setup.py installs no marker for {name}",
        "manifest_is_installed": f"setup.py does not install package.xml in share/{name}",
        "cfg_has_no_dashes": "setup.cfg writes a key with a dash, which setuptools takes with a warning or not at all",
        "scripts_go_to_lib": f"nothing sends the executables to lib/{name}, as setup.cfg is to",
    }
    wrong = [fact for fact in faults if not facts.get(fact)]
    if not facts.get("is_there"):
        level = "missing"
    elif "scripts_go_to_lib" in wrong:
        level = "misplaced"
    else:
        level = "partly" if wrong else "right"
    place = "setup.cfg" if wrong and wrong[-1] in ("cfg_has_no_dashes", "scripts_go_to_lib") else "setup.py"
    told = wrong if level == "partly" else wrong[-1:]
    fault = ", and ".join(faults[fact] for fact in told)
    points = [one for one in case.executables.values() if one.has_entry_point]
    is_there = any(not one.fault.startswith((ELSEWHERE, NOWHERE, UNBUILT)) for one in points)
    what = "Marker, package.xml and executables" if is_there else "Marker and package.xml"
    return Answer(level, {"fault": fault, "what": what}, ("files.setup",), case.at(place))


def _as_installed(case: Case) -> dict[str, bool]:
    """Return the facts of setup.py; where the package was built, its marker, package.xml and executables as installed.

    colcon warns if it had to install one of the first two by itself.
    """
    facts, build = dict(case.evidence.files.setup), case.evidence.build
    if not facts.get("is_there") or build is None or not build.is_built:
        return facts
    said = [line for line in build.warnings if "doesn't explicitly install" in line]
    facts |= {"marker_is_installed": not any("marker" in line for line in said)}
    facts |= {"marker_exists": facts["marker_is_installed"] or facts.get("marker_exists", False)}
    facts |= {"manifest_is_installed": not any("package.xml" in line for line in said)}
    points = [one for one in build.executables if one.has_entry_point and not one.package]
    if any(one.fault.startswith(ELSEWHERE) for one in points):
        facts["scripts_go_to_lib"] = False
    elif any(map(case.is_installed_program, (one.name for one in points))):
        facts["scripts_go_to_lib"] = True
    return facts


@question(
    "all unreachable one_lost idle two_lost unread none",
    "lost broken unreachable",
    _codes(_SETUP, "has_entry_points") | _POINT_CODES | {"executable-missing"},
)
def nodes_are_installed(case: Case) -> Answer:
    """Whether `ros2 run` or `ros2 launch` starts every node that exists; missing nodes count elsewhere."""
    facts, build = _as_installed(case), case.evidence.build
    seen, keys = (
        dict.fromkeys(("lost", "broken", "unreachable"), ""),
        ("build.executables", "files.setup"),
    )
    if build is None or not facts.get("is_there") or not build.executables:
        return Answer("none", seen, keys, case.at("setup.py"))
    playing = _lost(case)
    lost = _all_lost(case, playing)
    broken = [name for name, one in case.executables.items() if one.way == "installed" and one.fault]
    seen["lost"] = _told_apart(lost)
    seen["broken"] = f"; but these cannot be imported: {listed(broken)}" if broken else ""
    is_right = _has_right_points(case, is_whole=not lost and build.is_built)
    points = [executable for executable in build.executables if executable.has_entry_point]
    ways = [executable.way for executable in points]
    if build.cut or ("installed" not in ways and not is_right):
        level = "unread" if facts.get("has_entry_points") and not build.cut else "none"
        return Answer(level, seen, keys, case.at("setup.py"))
    if is_right and (why := _unreachable(build, facts, points)):
        return Answer(
            "unreachable", seen | {"unreachable": why}, keys, case.at("setup.py"), excuse=wanting(case)
        )
    if not lost and (idle := _idle(case)):
        return Answer(
            "idle", {**seen, "lost": listed(idle)}, ("build.executables", "runs"), case.at("setup.py")
        )
    count = len(playing if any(map(case.is_installed_program, case.executables)) else lost)
    return Answer(("all", "one_lost", "two_lost")[min(count, 2)], seen, keys, case.at("setup.py"))


def _all_lost(case: Case, playing: Mapping[str, str]) -> dict[str, str]:
    """Return why each executable does not start, those that play a part first; none where each of these starts."""
    points = [one for one in case.executables.values() if one.has_entry_point and not one.package]
    faulty = {one.name: _why(case, one) for one in points if one.fault and one.name not in playing}
    return {**playing, **faulty} if playing else {}


def _why(case: Case, program: Executable) -> str:
    """Return why a program does not start as installed: what is wrong with the entry point that is meant for it, if known."""
    point = _point_of(case, program)
    return point.cause if point else program.fault


def _told_apart(lost: Mapping[str, str]) -> str:
    """Return names with the reason of each, those of one reason together, such as `a and b: It is not installed.`."""
    named: dict[str, list[str]] = {}
    for name, fault in lost.items():
        named.setdefault(shown(fault or "It is not installed.", 160), []).append(name)
    return " ".join(f"{listed(names)}: {fault}" for fault, names in named.items())


def _unreachable(build: Build, facts: Mapping[str, bool], points: Sequence[Executable]) -> str:
    """Return why `ros2 run` starts nothing although the entry points are right; empty if it starts what there is."""
    nowhere = "nothing is installed where `ros2 run` looks"
    if not (build.is_built and facts.get("scripts_go_to_lib")):
        return nowhere
    failing = [point.fault for point in points if point.fault]
    if facts.get("installs_modules") or (points and not failing):
        return ""
    return f"what is installed does not start: {shown(failing[0], 160).rstrip('.')}" if failing else nowhere


def _lost(case: Case) -> dict[str, str]:
    """Return the programs that are not installed though their nodes play a part, or would if they lived, with what is wrong."""
    lost = dict[str, str]()
    for part, players in case.players.items():
        # If the node's program is not known, it is not known either that nothing starts it.
        alike = [player for player in players if player.match == players[0].match and player.program]
        programs = [player.program for player in alike] or _crashed(case, case.assignment.parts[part])
        is_there = any(map(case.is_installed, alike)) or any(map(case.is_installed_program, programs))
        if programs and not is_there:
            program = case.executables.get(programs[0])
            is_meant = program is not None and _point_of(case, program) is not None
            name = programs[0].removesuffix(".py") if is_meant else programs[0]
            lost[name] = _why(case, program) if program else ""
    return lost or _astray(case)


def _crashed(case: Case, part: Part) -> list[str]:
    """Return the programs that may have the node of an unplayed part, and ended before it was seen.

    A program to which an entry point rightly leads ends by a fault of its own, such as an import, which counts at the node.
    """
    if case.players[part.name]:
        return []
    is_right = _has_right_points(case, is_whole=False) and case.evidence.files.setup.get("installs_modules")
    lost = sorted(case.lost(case.players), key=lambda name: case.assignment.meant_by(name) is not part)
    programs = [case.executables[name] for name in lost if case.may_be(name, part)]
    return [
        program.name for program in programs if program.command and not (is_right and program.has_entry_point)
    ]


def _idle(case: Case) -> list[str]:
    """Return the executables named for a part that run on without a node, deaf or silent, while others play it."""
    alone = {
        run.programs[0]: run
        for run in case.evidence.runs
        if run.setting == "alone" and run.programs[0] in run.stopped
    }
    return [
        name
        for name, players in case.players.items()
        if name in alone and players and not case.executables[name].absent
        if _is_silent(case, name, alone)
        or (
            all(player.program != name for player in players)
            # Whoever takes the commands plays their part, but for the deaf.
            and (not alone[name].nodes or alone[name].commanded == case.assignment.parts[name].topic)
        )
    ]


def _is_silent(case: Case, name: str, alone: Mapping[str, Run]) -> bool:
    """Return whether an executable only advertises its part's topic, on which one named for another part publishes.

    What relays messages is silent alone, too, but then no other program publishes what it relays.
    """
    topics = {player.topic for player in case.players[name] if player.program == name}
    if not case.assignment.parts[name].is_publisher or not topics or _comes(alone[name], topics):
        return False
    others = alone.keys() & case.players.keys() - {name}
    return any(_comes(alone[other], topics) for other in others)


def _comes(run: Run, topics: Collection[str]) -> bool:
    return any(
        heard.count for stretch in run.stretches for topic, heard in stretch.items() if topic in topics
    )


def _has_right_points(case: Case, *, is_whole: bool) -> bool:
    """Return whether the entry points are right, apart from other faults of the package.

    Args:
        case: the submission's case.
        is_whole: whether everything that runs was built and installed.
    """
    facts = case.evidence.files.setup
    is_own = facts.get("entry_points_are_own", True)
    leads = facts.get("entry_points_lead_to_functions") or not facts.get("installs_modules")
    return bool(facts.get("has_entry_points") and ((is_own and leads) or is_whole))


def _point_of(case: Case, program: Executable) -> Finding | None:
    """Return the finding about the entry point that is meant for a program; None if there is none."""
    names = {program.module, program.name.removesuffix(".py")}
    findings = (finding for finding in case.evidence.files.told() if finding.code in _POINT_CODES)
    return next((finding for finding in findings if names & {*finding.about}), None)


def _astray(case: Case) -> dict[str, str]:
    """Return the executables whose entry points lead to no module, with the cause, where one may be meant for a part.

    It is if the module is there by another name, or a part has no node.
    """
    astray = [finding for finding in case.evidence.files.told() if finding.code == "entry-point-module"]
    meant = [finding for finding in astray if len(finding.about) > 1 or not all(case.players.values())]
    named = [executable.name for executable in case.executables.values() if not executable.command]
    return {name: finding.cause for name in named for finding in meant if name in finding.about}


@question("written partly todo", "missing where")
def package_is_described(case: Case) -> Answer:
    """Whether description, license and maintainer are somebody's own words."""
    files = case.evidence.files
    facts = {field: files.manifest.get(fact, False) for fact, field in _WRITTEN.items()}
    has_any = any(facts.values())
    missing = [field for field, is_written in facts.items() if not is_written]
    is_there = files.manifest.get("is_there")
    where = " in package.xml" if is_there else ", for there is no package.xml"
    seen = {"where": where, "missing": listed(missing)}
    if not missing and files.setup.get("is_described") is False:
        missing = ["its description, license or maintainer"]
        seen = {"where": " in setup.py", "missing": listed(missing)}
    level = "written" if not missing else "partly" if has_any else "todo"
    return Answer(level, seen, ("files.manifest", "files.setup"), seen["where"].rpartition(" ")[2])


def wanting(case: Case) -> str:
    """Return for want of what the package is not built here, though nothing is wrong with it, as a clause; else empty."""
    build, setup = case.evidence.build, case.evidence.files.setup
    if build is None or build.is_built or build.cut or not setup.get("is_valid") or _is_explained(case):
        return ""
    own = {package.name for package in case.evidence.submission.packages}
    known = PACKAGES | sys.stdlib_module_names | {"setuptools", *ROS_1, *filter(None, own)}
    if found := _NO_MODULE.search(build.error):
        is_known = any(found[1] == name or is_near_miss(found[1], name) for name in known)
        return "" if is_known else f"setup.py needs {shown(found[1])}, not there where it is graded"
    return f"the build needs {', '.join(lacked(build.error))}" if lacked(build.error) else ""


def _is_explained(case: Case) -> bool:
    """Return whether the fault that prevents the build counts at another criterion."""
    manifest, setup = case.evidence.files.manifest, case.evidence.files.setup
    facts = [
        manifest.get("is_there"),
        manifest.get("is_valid"),
        manifest.get("is_ament_python"),
        setup.get("marker_exists"),
        setup.get("scripts_go_to_lib"),
        *(setup.get(name) for name in _KEEPS_FROM_BUILDING),
    ]
    return not all(facts)
