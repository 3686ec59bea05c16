"""From an error's text to its cause: what it may mean, looked up in the sources that it names."""

from __future__ import annotations

import builtins
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from ros2lab.diagnose.causes.declarations import declaration_fault
from ros2lab.diagnose.causes.where_made import where_made
from ros2lab.diagnose.checking.called_at_once import called_at_once
from ros2lab.diagnose.checking.checked_copies import stands_trial
from ros2lab.diagnose.checking.type_checker import type_faults
from ros2lab.diagnose.explaining.assertions import of_assertion, of_test_without_init, results_of_tests
from ros2lab.diagnose.explaining.commands import Corrected, corrected
from ros2lab.diagnose.explaining.in_words import said_of
from ros2lab.diagnose.explaining.meaning import Meaning
from ros2lab.diagnose.explaining.meanings import MEANINGS
from ros2lab.diagnose.explaining.needed import of_needed
from ros2lab.diagnose.explaining.not_found import no_executable, no_file, no_package, not_sourced
from ros2lab.diagnose.explaining.older_nodes import of_older_node
from ros2lab.diagnose.explaining.outdated import of_earlier
from ros2lab.diagnose.explaining.own_words import own_words, without_own_warnings
from ros2lab.diagnose.explaining.quiet_programs import of_quiet_program
from ros2lab.diagnose.explaining.replaced import called_by_rclpy, made_twice, taken_from_rclpy
from ros2lab.diagnose.explaining.said import launch_line, of_launch
from ros2lab.diagnose.explaining.said_by_tools import lines_of, said_by_tools
from ros2lab.diagnose.explaining.sections_read import sections_read
from ros2lab.diagnose.explaining.shown_values import shown_values
from ros2lab.diagnose.explaining.typed import as_keyed, of_history, of_processes, own_shells, typed_faults
from ros2lab.diagnose.explaining.usage import accepted_form
from ros2lab.diagnose.finding import SAID, UNKNOWN, Finding, is_about_life, stops_build, stops_node
from ros2lab.diagnose.look import Look, text_faults, workspace_around
from ros2lab.diagnose.mending.repairs import tried, worth_typing
from ros2lab.diagnose.printed.error_text import PREFIX, ErrorReport, ErrorText, own_frames, read_error
from ros2lab.diagnose.printed.jobs import frozen_faults
from ros2lab.diagnose.printed.spots import Spot, is_setup, place_of
from ros2lab.diagnose.printed.transcript import LABELLED, Step, step_with
from ros2lab.diagnose.sources.calls import call_faults
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text

# These are all about a package or its files, so the place in a program that an error names does not tell them apart.
_OF_THE_PACKAGE = re.compile(
    r"entry-point|setup|package|marker|manifest|build-type|init-file|install|not-|launch|depend|param|executable"
)
_BUILD_FAILED = re.compile(
    r"^(?:Failed +<<< |error: can't copy|error in \S+ setup command|(?:\[[\d.]+s\] )?ERROR:colcon)|in setup command|setup\.py.*returned non-zero",
    re.M,
)
_REFUSED = re.compile(r"^(?:usage: )?ros2[ \w]*: error: ", re.M)
_SHELLS = re.compile(r" *(?:&&|\|\||;|\|) +")  # between two commands of a line
_WORD = re.compile(r"[A-Za-z_][\w.]{2,}")
_EVERYWHERE = frozenset(("error", "module", "object", "attribute", "None"))
_MOST_CORRECTIONS = 4  # words of a command that are put right


def explain(text: str, workspace: Path | None, sources: Mapping[str, str], *, loads: bool) -> list[Finding]:
    """Explain an error's text; see `ros2lab.diagnose.of_text`."""
    root = workspace or _workspace_of(read_error(text))
    look = Look(root, loads=loads and "launch" in text) if root is not None else None
    text = without_own_warnings(text, look) if "Warning: " in text else text
    error = read_error(text)
    if look is None:
        return _of_error(error, text, _beside(error, sources, look), look)
    if earlier := of_earlier(error, look):
        return [earlier]
    error = _whole(error, text, look)
    known = [*_beside(error, sources, look), *of_needed(look.findings, error, look)]
    shown = [*shown_values(error, look), *sections_read(error, look)[0]] if not error.reports else []
    return [worth_typing(one, look) for one in shown] or _of_error(error, text, known, look)


def _of_error(error: ErrorText, text: str, beside: Iterable[Finding], look: Look | None) -> list[Finding]:
    """Return what an error leads to, or what is wrong beside it."""
    known = [*beside]
    found = _explained(error, known, look)
    if not error.reports and (quiet := of_quiet_program(text, look)):
        return [quiet, *(one for one in found or known if one.place != quiet.place)]
    if not found and not (error.is_clear and (error.reports or not own_words(error.decisive, look))):
        return known or _undecided(error, look)
    found = [*dict.fromkeys(found)] or [_unknown(error, look)]
    return [worth_typing(one, look) for one in (_first_tried(found, error, look) if look else found)]


def _undecided(error: ErrorText, look: Look | None) -> list[Finding]:
    """Return that a text is not known, where it may hold an error; nothing where all that was typed did well."""
    did_well = all(step.ended_well or step.is_answer for step in error.steps if step.text.strip())
    is_plain = not error.decisive or LABELLED.match(error.decisive) is not None
    return [] if look or did_well or is_plain else [_unknown(error, look)]


def _whole(error: ErrorText, text: str, look: Look) -> ErrorText:
    """Return an error with what is written in the workspace of it: results of tests, and lines that were cut."""
    if more := results_of_tests(error, look.root):
        error = read_error(f"{text}\n{more}")
    return replace(error, reports=tuple(_whole_report(report, look) for report in error.reports))


def _explained(error: ErrorText, known: list[Finding], look: Look | None) -> list[Finding]:
    """Return what is to be said of an error; before words that say neither where nor what to do, what is known."""
    checked = _checked(error, known, look) if look else []
    found = _with_command(_of_what_was_said(error, known, checked, look), error, known, look)
    if error.decisive and all(one.code in (SAID, UNKNOWN) and not one.fix and not one.place for one in found):
        return [*known, *found]
    return found


def _first_tried(found: list[Finding], error: ErrorText, look: Look) -> list[Finding]:
    """Return findings of which the first has a fix that was tried; what an origin or an import says is right as it is.

    So is what is to be written in another line, which the fix then names.
    """
    if "Caught exception in launch" in error.text:
        found = [one if one.place else replace(one, place=launch_line(error, look)) for one in found]
    first, *others = found
    own = own_frames(error.reports[-1].frames) if error.reports else []
    is_sure = first.code in ("made-wrong", "value-none") or "import" in first.fix.partition("`")[2]
    is_sure |= re.search(r"\bline \d+", first.fix) is not None
    part, said = own[0].part if own else "", of_launch(error, look)
    return [tried(first, look, part, is_sure=is_sure, passed_on=said), *others]


def _of_what_was_said(
    error: ErrorText, known: list[Finding], checked: list[Finding], look: Look | None
) -> list[Finding]:
    """Return what the words of an error mean, what they lead to, or what the tool says well itself."""
    found = _worded(error, [*known, *checked], look)
    told = _made_elsewhere(error, known, look) if look else None
    if told and not (found and found[0] in known and stops_build(found[0])):
        return [told]
    found = _asked_first(error, known, found, look) or where_made(error, known, look) or found
    frozen = [*frozen_faults(error.steps)]
    if not error.reports and not frozen and (not found or found[0] not in known):
        found = [*typed_faults(error, look)] or found
    if error.decisive:
        found = _with_choice(error, look) or found or checked or _in_line(error, known)
        found = found or ([] if frozen and not error.reports else said_by_tools(error, look))
    history = of_history(error.typed, error.text)
    return [*history, *own_shells(error.typed), *frozen, *of_processes(error.text, look), *found]


def _with_choice(error: ErrorText, look: Look | None) -> list[Finding]:
    """Return what launch says where it names what may stand there: nothing else is known better."""
    said = of_launch(error, look) if not error.reports else None
    return [said] if said and said.fix.startswith("write ") else []


def _made_elsewhere(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return what lies behind an error whose own line is right; None if nothing is known to."""
    return (
        of_assertion(error, look)
        or of_test_without_init(error, look)
        or made_twice(error, known, look)
        or called_by_rclpy(error, look)
        or taken_from_rclpy(error, known, look)
        or declaration_fault(error, look)
    )


def _worded(error: ErrorText, known: list[Finding], look: Look | None) -> list[Finding]:
    """Return what the words of an error mean."""
    found: list[Finding] = []
    exceptions = {report.line for report in error.reports}
    for line in lines_of(error):
        if line not in exceptions:
            # What else was printed counts only where no exception explains itself, or names a faulty file.
            found = found or [one for one in known if any(_names(said, one.place) for said in exceptions)]
            if found:
                break
        meaning = next((one for one in MEANINGS if one.pattern.search(line)), None)
        if meaning is not None:
            found += _meant(meaning, line, error, known, look)
    return found


# What the command itself may be to blame for: then the same command, as it was meant, is the fix.
_OF_THE_COMMAND = frozenset(
    f"{SAID} {UNKNOWN} package-not-found executable-missing file-not-found topic-near-miss topic-type typed-wrong "
    "parameter-name parameter-type".split()
)


def _with_command(
    found: list[Finding], error: ErrorText, known: list[Finding], look: Look | None
) -> list[Finding]:
    """Return findings whose fix is the command that was typed, as it was meant, where that is what is wrong."""
    first = found[0] if found else Finding(UNKNOWN, "")
    is_told = first.code not in (SAID, UNKNOWN)
    is_refused = _REFUSED.search(error.text) is not None
    if look is None or first in known or first.code not in _OF_THE_COMMAND:
        return found
    if is_told and "`" in first.fix and not is_refused:
        return found
    blamed = step_with(error.decisive, error.steps)
    lines = [step.command for step in reversed(error.steps) if step is blamed or not _did_well(step)]
    parts = [as_keyed(part) for line in lines if line for part in _SHELLS.split(line)]
    meant = next((one for part in parts if (one := _as_meant(part, error, look))), None)
    if meant is None:
        return found
    first = first if is_told and not is_refused else Finding("typed-wrong", meant.why)
    return [replace(first, fix=f"type `{meant.line}`"), *found[1:]]


def _did_well(step: Step) -> bool:
    """Return whether what a command has printed shows that it did well."""
    is_told = any(meaning.pattern.search(line) for meaning in MEANINGS for line in step.lines)
    return step.is_answered and not is_told


def _as_meant(line: str, error: ErrorText, look: Look) -> Corrected | None:
    """Return a command with every wrong word put right, and what was wrong first; None if nothing is known to be."""
    meant = None
    for _ in range(_MOST_CORRECTIONS):
        # What the parser of ros2 does not take comes first: whether its words exist is asked of what it takes.
        form = accepted_form(line) if _REFUSED.search(error.text) or meant else None
        one = Corrected(*form) if form else corrected(line, look, error.text)
        if one is None or one.line == line:
            break
        line = one.line
        meant = replace(one, why=meant.why if meant else one.why)
    return meant


def _checked(error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Return what a type checker and the libraries' own signatures say of the lines through which an error came."""
    named = [place_of([frame], look) for frame in own_frames(error.frames)[:8]]
    paths = {_file(place): look.root / _file(place) for place in named if _file(place).endswith(".py")}
    if "Caught exception in launch" in error.text:
        # It seldom says where: all lines may be meant.
        files = zip(look.launch_files, look.launch_paths, strict=True)
        paths |= {file.shown: path for file, path in files if path.suffix == ".py"}
        named += [
            f"{shown}:{n}" for shown, path in paths.items() for n in range(1, read_text(path).count("\n") + 2)
        ]
    # What has a wrong type is told by Python; an exception of a library's own says itself what it is about.
    is_pythons = not error.reports or hasattr(builtins, error.reports[-1].kind)
    said = error.reports[-1].message if error.reports else ""
    asked = (*called_at_once(look), *type_faults(look, known, named, said)) if named and is_pythons else ()
    found = [one for one in asked if one.place in named]
    innermost = error.reports[-1].frames[-1:] if error.reports else ()
    if not found and not own_frames(innermost):
        for shown, path in paths.items():
            # Of what is known of a line already nothing else is said.
            told = {one.place for one in known if stops_node(one)}
            lines = {int(place.rpartition(":")[2]) for place in {*named} - told if _file(place) == shown}
            found += call_faults(read_source(path, path.stem, shown), lines, said, stands_trial)
    return found


def _file(place: str) -> str:
    return place.rpartition(":")[0]


def _in_line(error: ErrorText, known: list[Finding]) -> list[Finding]:
    """Return what is wrong on the very line of an error, or, below a spin, in the callbacks of its file."""
    near = {one: _nearness(one, error, error.decisive) for one in known}
    # What only surprises in a line of code is no reason for an exception.
    is_code = {one: bool(error.reports) and ".py:" in one.place for one in known}
    # What a library refuses may be how it is called at all.
    inner = error.reports[-1].frames[-1:] if error.reports else ()
    is_librarys = bool(inner) and not own_frames(inner)
    on_it = [
        one
        for one in known
        if near[one] == 3 and (stops_node(one) or not is_code[one] or (is_librarys and is_about_life(one)))
    ]
    return on_it or [one for one in known if near[one] == 2 and stops_node(one) and "spin" in error.text]


# What keeps launch from loading a file, whatever it says of it.
_REFUSED_BY_LAUNCH = frozenset(
    ("import-wrong", "launch-argument", "launch-function", "launch-syntax", "comma-tuple", "comma-missing")
)


_NOT_THERE = frozenset(("not-built", "package-not-found", "executable-missing"))


def _asked_first(
    error: ErrorText, known: list[Finding], found: list[Finding], look: Look | None
) -> list[Finding]:
    """Return what keeps from being built or loaded what failed to be, or is wrong in the line that names what was run."""
    if refused := _refused_by_launch(error, known, found, look):
        return refused
    if found and found[0] in known and stops_build(found[0]):
        return []
    if _BUILD_FAILED.search(error.text) and (stops := [one for one in known if stops_build(one)]):
        return stops
    is_of_setup = bool(error.reports) and is_setup(place_of(own_frames(error.reports[-1].frames), look))
    if is_of_setup and found and found[0].code in _NOT_THERE:
        return said_by_tools(error, look)  # what could not be built is not found afterwards
    named = [one for one in known if error.command and error.command[2] in one.about]
    return [one for one in named if one.code.startswith("entry-point")] if error.reports else []


def _refused_by_launch(
    error: ErrorText, known: list[Finding], found: list[Finding], look: Look | None
) -> list[Finding]:
    """Return what is wrong in a launch file that launch could not load, or of which it could not start a program."""
    stops = [one for one in known if one.code in _REFUSED_BY_LAUNCH]
    if "exception occurred while executing process" in error.text:
        return stops
    if look is None or "Caught exception in launch" not in error.text:
        return []
    files = {file.shown for file in look.launch_files}
    is_told = bool(found) and found[0].code in _REFUSED_BY_LAUNCH
    return [] if is_told else [one for one in stops if one.place.partition(":")[0] in files]


def _whole_report(report: ErrorReport, look: Look) -> ErrorReport:
    """Return an error with all lines of the statement at which it came; the line that Python names stays the last."""
    own = own_frames(report.frames)
    if not own:
        return report
    file, _, line = place_of(own[:1], look).rpartition(":")
    path = look.root / file
    if not line.isdigit() or not path.is_file():
        return report
    lines = Spot(read_source(path, path.stem, file), int(line)).lines
    index = report.frames.index(own[0])
    around = tuple(replace(own[0], line=n) for n in lines if n != own[0].line)
    return replace(report, frames=(*report.frames[:index], *around, *report.frames[index:]))


def _names(line: str, place: str) -> bool:
    """Return whether a line names the file of a place by its path."""
    file = place.partition(":")[0]
    return "/" in file and f"/{file}'" in line


def _meant(
    meaning: Meaning, line: str, error: ErrorText, known: list[Finding], look: Look | None
) -> list[Finding]:
    match = meaning.pattern.search(line)
    assert match is not None
    groups = match.groupdict(default="")
    if asked := _asked_for(meaning, groups, error, look):
        return [asked]
    near = {one: _nearness(one, error, line) for one in known}
    has_place = bool(own_frames(error.frames))

    def may_cause(one: Finding) -> bool:
        is_near = near[one] or not meaning.cause
        return near[one] >= 2 or not has_place or bool(is_near and _OF_THE_PACKAGE.match(one.code))

    causes = sorted(
        (one for one in known if one.code in meaning.codes and may_cause(one)),
        key=lambda one: (-near[one], meaning.codes.index(one.code) if near[one] < 2 else 0),
    )
    if not causes:
        # Words alone say little: what is wrong on a line through which the error came says more.
        causes = [one for one in known if near[one] == 3 and stops_node(one)]
    if not causes and not error.reports:
        # So does what is wrong with the very package or file that is named.
        causes = [one for one in known if near[one] and stops_build(one)]
    return causes or said_of(meaning, groups, line, error, look)


def _nearness(finding: Finding, error: ErrorText, line: str) -> int:
    """Return how near a finding is to an error: 3 the same line, 2 the same file, 1 the same words, else 0."""
    file, _, number = finding.place.rpartition(":")
    name = "/".join(Path(file or finding.place).parts[-2:])
    there = [frame for frame in error.frames if frame.is_in == name or frame.file == file]
    if there:
        return 3 if not number.isdigit() or any(str(frame.line) == number for frame in there) else 2
    if not number.isdigit() and "/" in finding.place and finding.place in error.text:
        return 3
    line = PREFIX.sub("", line, count=1)
    quoted = " ".join(text for pair in re.findall(r"\B'([^']+)'|\[(\w+)\]", line) for text in pair)
    words = set(_WORD.findall(quoted)) or set(_WORD.findall(line)) - _EVERYWHERE
    words |= {word.rpartition(".")[2] for word in words if quoted}
    return int(not words.isdisjoint(_WORD.findall(f"{finding.cause} {finding.place} {finding.fix}")))


def _asked_for(
    meaning: Meaning, groups: Mapping[str, str], error: ErrorText, look: Look | None
) -> Finding | None:
    """Answer what a command asked of a workspace and did not get; None if this is about something else."""
    if meaning.codes[0] == "package-not-found":
        return no_package(groups["name"] or groups["name2"], look, error)
    if meaning.codes[0] == "command-not-found" and look:
        reset = not_sourced(groups["name"], error.typed, error.text, look.root)
        return reset if "removes" in reset.cause else None
    if meaning.codes[0] == "name-twice" and look:
        return of_older_node(error, look)
    if meaning.codes[0] == "not-sourced" and look and error.typed:
        names = [
            package.name for package in look.packages if package.name == groups["name"].replace("-", "_")
        ]
        return not_sourced(names[0], error.typed, error.text, look.root) if names else None
    if meaning.codes[0] == "executable-missing":
        return no_executable(error.command, look)
    return no_file(groups["name"], groups["package"], look) if "file-not-found" in meaning.codes else None


def _unknown(error: ErrorText, look: Look | None) -> Finding:
    return own_words(error.decisive, look) or Finding(
        UNKNOWN,
        f"This error is not known; its most important line is: {error.decisive}",
        place_of(own_frames(error.frames), look),
    )


def _workspace_of(error: ErrorText) -> Path | None:
    """Return the workspace to which a file belongs that the text names, if it is on this disk."""
    for frame in own_frames(error.frames):
        path = Path(frame.file)
        if path.is_absolute() and path.is_file():
            root = workspace_around(path.parent)
            if root is not None:
                return root
    return None


def _beside(error: ErrorText, sources: Mapping[str, str], look: Look | None) -> Iterator[Finding]:
    """Yield what is wrong in files that the text names and that belong to no workspace, and in cells."""
    for file in dict.fromkeys(frame.file for frame in own_frames(error.frames)):
        path = Path(file)
        if file in sources:
            # What a cell does not define, an earlier one may.
            alone = text_faults(PythonSource("cell", file, sources[file]))
            yield from (one for one in alone if one.code not in ("name-undefined", "parameter-undeclared"))
        elif look is None and path.suffix == ".py" and path.is_file():
            yield from text_faults(read_source(path, path.stem, file))
