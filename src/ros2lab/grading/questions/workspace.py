"""Where the package lies, and whether colcon finds and builds it there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePosixPath

from ros2lab.grading.evidence import OTHER_TYPE
from ros2lab.grading.judging.players import Case
from ros2lab.grading.questions.answer import Answer, error_of, listed, question, shown
from ros2lab.grading.questions.package import wanting
from ros2lab.grading.receiving.notes import Kind, spoken

_BY_PYTHON = re.compile(r"(?:^|/)(?:__pycache__|[^/]*\.py[co])$")
_NAME = re.compile(r"[a-z](_?[a-z0-9]+)*")  # REP 144
_HIDDEN: Mapping[Kind, str] = {
    "ignored by colcon": "a COLCON_IGNORE or an AMENT_IGNORE lies in {}",
    "in another package": "{} lies in another package",
}

LONGEST_ERROR = 240  # characters; the error of a setup.py may quote what is wrong with it
_BARE = "it has no package.xml, and its setup.py installs no modules"


@question("in_src package_alone loose_files nothing", "folder what")
def package_lies_in_src(case: Case) -> Answer:
    """Whether the package lies below the src of a workspace."""
    form = case.evidence.submission.form
    level = {"workspace": "in_src", "package": "package_alone", "files": "loose_files"}.get(form, "nothing")
    folder = shown(_folder(case))
    subject = f"The package in {folder}"
    if folder == ".":
        subject = "The handed-in folder is itself the package, and"
        if not case.evidence.files.manifest.get("is_there"):
            subject = "What was handed in, a setup.py without a package.xml and what is beside it,"
    seen = {"folder": spoken(folder), "what": subject}
    return Answer(level, seen, ("submission.form",), folder)


@question(
    "built other_type fails endless copy_outside duplicate hidden bare no_package",
    "package others top why error",
    frozenset(("package-duplicate", "setuptools-too-new")),
)
def colcon_finds_package(case: Case) -> Answer:
    """Whether colcon finds the package and builds it, as far as its own faults and those of its setup.py go.

    A package.xml by which it is no ROS package for colcon costs points there. A build that never ends leaves nothing,
    because then nothing in the workspace can be built.
    """
    seen = {"package": shown(case.package or "the package"), "others": "", "top": "", "why": "", "error": ""}
    build = case.evidence.build
    files = case.evidence.files
    is_package = files.manifest.get("is_there") or files.setup.get("installs_modules")
    if build is None or case.evidence.submission.package is None or not is_package:
        level = "no_package" if case.evidence.submission.package is None else "bare"
        is_read = bool(files.manifest)
        seen["why"] = _BARE if is_read else "its files could not be read"
        if is_read and build and build.error:
            seen["why"] += f" and ends with {error_of(build.error, LONGEST_ERROR)}"
        return Answer(level, seen, ("build", "files.manifest"), shown(_folder(case)))
    if twins := _twins(case):
        return _of_twins(case, twins, seen)
    if why := _hidden_by(case):
        return Answer("hidden", seen | {"why": why}, ("submission.notes",), shown(_folder(case)))
    if build.cut:
        return Answer("endless", seen | {"why": build.cut}, ("build.cut",), case.at("setup.py"))
    if build.is_built:
        return Answer("built", seen, ("build.is_built",))
    is_of_another_type = files.manifest.get("is_valid") and not files.manifest.get("is_ament_python")
    error = (
        "its build type is not ament_python" if is_of_another_type else error_of(build.error, LONGEST_ERROR)
    )
    # Elsewhere there may be CMake; and without a valid package.xml colcon may build it as plain Python.
    needs_cmake = (case.evidence.submission.package.build_type or "").startswith(("ament_cmake", "cmake"))
    is_passed_over = build.error.startswith(OTHER_TYPE) and not is_of_another_type
    level = "other_type" if needs_cmake or is_passed_over else "fails"
    keys = ("build.is_built", "build.error")
    return Answer(level, seen | {"error": error}, keys, shown(_folder(case)), excuse=wanting(case))


def _of_twins(case: Case, twins: list[str], seen: dict[str, str]) -> Answer:
    """Answer for a package that is there more than once, so that colcon builds none of them."""
    workspace = case.evidence.submission.workspace
    is_inside = any(PurePosixPath(workspace or "", "src") in PurePosixPath(t).parents for t in twins)
    level = "duplicate" if workspace and is_inside else "copy_outside"
    seen = seen | {"others": listed(twins), "top": "the workspace" if workspace else "what was handed in"}
    return Answer(level, seen, ("submission.packages",), shown(twins[0]))


def _hidden_by(case: Case) -> str:
    """Return what hides the package from colcon, as a clause; empty if nothing does."""
    folder = PurePosixPath(_folder(case))
    for kind, why in _HIDDEN.items():
        for path in case.evidence.submission.noted(kind):
            if PurePosixPath(path) in (folder, *folder.parents):
                return why.format(shown(spoken(path)))
    return ""


@question("clean built_beside built_inside nothing", "folders")
def sources_are_clean(case: Case) -> Answer:
    """Whether no output of colcon or Python was handed in; among the sources it is worse than beside them.

    Without a workspace, it always counts as among the sources.
    """
    submission = case.evidence.submission
    if submission.package is None:
        return Answer("nothing", {"folders": ""}, ("submission.form",))
    made = submission.noted("by a build")
    wrong, level = made, "built_inside"
    if submission.workspace:
        inside = {PurePosixPath(submission.workspace, "src")}
        inside |= {PurePosixPath(package.folder) for package in submission.packages}
        # If the package is its own workspace, they lie where they belong.
        wrong = [
            path
            for path in made
            if inside & {*PurePosixPath(path).parents}
            and str(PurePosixPath(path).parent) != submission.workspace
        ]
    if not wrong:
        by_python = filter(_BY_PYTHON.search, submission.noted("by a tool"))
        wrong, level = [*made, *by_python, *submission.noted("made")], "built_beside"
    place = shown(wrong[0]) if wrong else ""
    return Answer(level if wrong else "clean", {"folders": listed(wrong)}, ("submission.notes",), place)


@question("asked_for conventional unconventional unknown nothing", "package wanted why")
def package_has_its_name(case: Case) -> Answer:
    """Whether the package has the assignment's name, or at least a valid package name."""
    name, wanted = case.package, case.assignment.package
    differ = case.evidence.files.setup.get("name_agrees") is False
    if differ and _NAME.fullmatch(name) and PurePosixPath(_folder(case)).name == wanted:
        name = wanted  # different names in package.xml and setup.py count there
    package = case.evidence.submission.package
    seen = {"package": shown(name), "wanted": wanted, "why": shown((package and package.error) or "", 160)}
    if package is None:
        return Answer("nothing", seen, ("submission.package",))
    level = "conventional" if _NAME.fullmatch(name) else "unconventional" if name else "unknown"
    if name == wanted:
        level = "asked_for"
    return Answer(level, seen, ("submission.package.name",), case.at("package.xml"))


def _folder(case: Case) -> str:
    package = case.evidence.submission.package
    return package.folder if package else ""


def _twins(case: Case) -> list[str]:
    """Return the other folders in the workspace, or in the submission, with a package of the same name."""
    submission = case.evidence.submission
    if not case.package:
        return []
    top = PurePosixPath(submission.workspace or ".")
    packages = {PurePosixPath(package.folder): package.name for package in submission.packages}
    return [
        str(folder)
        for folder, name in packages.items()
        if name == case.package
        and str(folder) != _folder(case)
        and top in folder.parents
        and not packages.keys() & {*folder.parents}
    ]
