"""Explains the text of an error: what it may mean, checked against the sources that it names."""

from __future__ import annotations

import builtins
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from ros2lab.diagnose.causes.answers import of_answer
from ros2lab.diagnose.causes.asserted import of_asserted
from ros2lab.diagnose.causes.declarations import declaration_fault
from ros2lab.diagnose.causes.file_lookups import of_lost_slash
from ros2lab.diagnose.causes.init_order import of_init_order, of_init_twice
from ros2lab.diagnose.causes.later_calls import of_later_call, of_lone_argument
from ros2lab.diagnose.causes.raised_in_callbacks import of_own_raise
from ros2lab.diagnose.causes.refused_names import of_refused_name, of_refused_rule
from ros2lab.diagnose.causes.shadowed import of_namesake, of_shadow
from ros2lab.diagnose.causes.taken import of_parameters, of_taken
from ros2lab.diagnose.causes.terminal_variables import of_ros_arguments
from ros2lab.diagnose.causes.undeclared_arguments import undeclared_argument
from ros2lab.diagnose.causes.waited import of_unanswered
from ros2lab.diagnose.causes.where_made import where_made
from ros2lab.diagnose.checking.called_at_once import called_at_once
from ros2lab.diagnose.checking.checked_copies import stands_trial
from ros2lab.diagnose.checking.type_checker import type_faults
from ros2lab.diagnose.explaining.asked_for import asked_for
from ros2lab.diagnose.explaining.assertions import of_assertion, of_test_without_init, results_of_tests
from ros2lab.diagnose.explaining.commands import REFUSED, as_meant
from ros2lab.diagnose.explaining.in_words import said_of
from ros2lab.diagnose.explaining.launched_commands import of_launched_command
from ros2lab.diagnose.explaining.meaning import Meaning
from ros2lab.diagnose.explaining.meanings import MEANINGS
from ros2lab.diagnose.explaining.needed import is_refuted, of_needed, seen_there
from ros2lab.diagnose.explaining.not_set import called_by_rclpy, made_twice, taken_from_rclpy
from ros2lab.diagnose.explaining.other_ends import of_other_end
from ros2lab.diagnose.explaining.own_words import is_own_log, own_words, still_waiting, without_own
from ros2lab.diagnose.explaining.quiet_programs import of_quiet_program
from ros2lab.diagnose.explaining.ros_variables import of_ros_variable
from ros2lab.diagnose.explaining.said import is_bare, launch_line, lines_of, of_launch, said_by_tools
from ros2lab.diagnose.explaining.sections_read import sections_read
from ros2lab.diagnose.explaining.shown_values import shown_values
from ros2lab.diagnose.explaining.started_files import of_started_file
from ros2lab.diagnose.explaining.typed import as_keyed, of_history, of_processes, own_shells, typed_faults
from ros2lab.diagnose.explaining.typed_settings import with_settings
from ros2lab.diagnose.explaining.unbuilt import failed_build, of_earlier, of_refused_files
from ros2lab.diagnose.finding import SAID, UNKNOWN, Finding, is_about_life, stops_build, stops_node
from ros2lab.diagnose.look import Look, workspace_around
from ros2lab.diagnose.mending.repairs import tried, worth_typing
from ros2lab.diagnose.printed.error_text import PREFIX, ErrorReport, ErrorText, own_frames, read_error
from ros2lab.diagnose.printed.jobs import frozen_faults
from ros2lab.diagnose.printed.spots import is_setup, place_of, spot_at
from ros2lab.diagnose.printed.transcript import LABELLED, Step, is_complaint, step_with
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.calls import call_faults
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text

# Codes about a package or its files: the line of code that an error names does not tell them apart.
_OF_THE_PACKAGE = re.compile(
    r"entry-point|setup|package|marker|manifest|build-type|init-file|install|not-|launch|depend|param|executable"
)
_BUILD_FAILED = re.compile(
    r"^(?:Failed +<<< |error: can't copy|error in \S+ setup command|(?:\[[\d.]+s\] )?ERROR:colcon)|in setup command|setup\.py.*returned non-zero",
    re.M,
)
_SHELLS = re.compile(r" *(?:&&|\|\||;|\|) +")  # between two commands on a line
_WORD = re.compile(r"[A-Za-z_][\w.]{2,}")
_EVERYWHERE = frozenset(("error", "module", "object", "attribute", "None"))


def explain(text: str, workspace: Path | None, sources: Mapping[str, str], *, loads: bool) -> list[Finding]:
    """Explain an error's text; see `ros2lab.diagnose.of_text`."""
    root = workspace or _workspace_of(read_error(text))
    look = Look(root, loads=loads and "launch" in text, runs=loads)
    text = without_own(text, look)
    error = read_error(text)
    if built := failed_build(error.steps):
        found = explain(built, workspace, sources, loads=loads)
        if found and found[0].code != UNKNOWN:
            return found
    sure = of_started_file(error, look) or of_earlier(error, look)
    sure = sure or of_namesake(error, look) or of_shadow(error, look)
    if sure := sure or of_ros_variable(error):
        return [sure]
    if not look:
        return _of_error(error, text, _beside(error, sources, look), look)
    error = _whole(error, text, look)
    known = [*_beside(error, sources, look), *of_needed(look.findings, error, look)]
    known = [finding for finding in known if not is_refuted(finding, error, look)]
    shown = [*shown_values(error, look), *sections_read(error, look)[0]] if not error.reports else []
    return [worth_typing(finding, look) for finding in shown] or _of_error(error, text, known, look)


def _of_error(error: ErrorText, text: str, beside: Iterable[Finding], look: Look) -> list[Finding]:
    """Return the findings that explain an error; else those that are known of its files or workspace."""
    known = [*beside]
    found = _explained(error, known, look)
    quiet = None if error.reports else of_quiet_program(text, look) or still_waiting(text, look)
    if quiet:
        return [quiet, *(finding for finding in found or known if finding.place != quiet.place)]
    if not found and not (error.is_clear and (error.reports or not own_words(error, look))):
        return known or _undecided(error, look)
    found = [*dict.fromkeys(found)] or [_unknown(error, look)]
    return [worth_typing(finding, look) for finding in (_first_tried(found, error, look) if look else found)]


def _undecided(error: ErrorText, look: Look) -> list[Finding]:
    """Say that an error is unknown; empty with a workspace, or if the text need not contain an error."""
    did_well = all(step.ended_well or step.is_answer for step in error.steps if step.text.strip())
    is_plain = not error.decisive or LABELLED.match(error.decisive) is not None
    return [] if look or did_well or is_plain else [_unknown(error, look)]


def _whole(error: ErrorText, text: str, look: Look) -> ErrorText:
    """Complete an error from the workspace: with test results, and with all lines of its statements."""
    if more := results_of_tests(error, look.root):
        error = read_error(f"{text}\n{more}")
    return replace(error, reports=tuple(_whole_report(report, look) for report in error.reports))


def _explained(error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Return the findings for an error, after the known ones if they name neither place nor fix."""
    checked = _checked(error, known, look) if look else []
    found = _with_command(_of_what_was_said(error, known, checked, look), error, known, look)
    if error.decisive and all(finding.code in (SAID, UNKNOWN) and is_bare(finding) for finding in found):
        return [*known, *found]
    return found


def _first_tried(found: list[Finding], error: ErrorText, look: Look) -> list[Finding]:
    """Return the findings, the first with a fix that was tried.

    Fixes that concern an origin, an import or another line are not tried: they are right as they are.
    """
    if "Caught exception in launch" in error.text:
        found = [
            finding if finding.place else replace(finding, place=launch_line(error, look))
            for finding in found
        ]
    first, *others = found
    if first.code.startswith("name-undefined"):
        return found  # no other change of the line says what the name stands for
    own = error.own
    is_sure = first.code in ("made-wrong", "value-none") or "import" in first.fix.partition("`")[2]
    is_sure |= re.search(r"\bline \d+", first.fix) is not None
    part, said = own[0].part if own else "", of_launch(error, look)
    return [tried(first, look, part, is_sure=is_sure, passed_on=said), *others]


def _of_what_was_said(
    error: ErrorText, known: list[Finding], checked: list[Finding], look: Look
) -> list[Finding]:
    """Return what an error message means, what caused it elsewhere, or what the tool says itself."""
    found = _worded(error, [*known, *checked], look)
    if (
        look
        and not (found and found[0] in known)
        and (fitting := of_taken(error, look) or of_parameters(error, look))
    ):
        return [fitting]
    told = _made_elsewhere(error, known, look) if look else None
    if told and not (found and found[0] in known and stops_build(found[0])):
        return [told]
    found = _asked_first(error, known, found, look) or where_made(error, known, look) or found
    frozen = [*frozen_faults(error.steps)]
    if not error.reports and not frozen and (not found or found[0] not in known):
        found = with_settings([*typed_faults(error, look)], error, look) or found
    if error.decisive:
        found = _with_choice(error, look) or found or checked or _in_line(error, known)
        found = found or _said_by_tools(error, known, look, is_frozen=bool(frozen))
    history = of_history(error.typed, error.text)
    return [*history, *own_shells(error.typed), *frozen, *of_processes(error.text, look), *found]


def _said_by_tools(error: ErrorText, known: list[Finding], look: Look, *, is_frozen: bool) -> list[Finding]:
    """Return what a tool says itself; nothing where a program was only stopped, or logs what it is written to log."""
    if not error.reports and (is_frozen or is_own_log(error.decisive, look)):
        return []
    said = said_by_tools(error, look)
    return (seen_there(said[0], error, known, look) if said and look else []) or said


def _with_choice(error: ErrorText, look: Look) -> list[Finding]:
    """Return the finding of a launch error that names the allowed values; empty if it names none."""
    said = of_launch(error, look) if not error.reports else None
    return [said] if said and said.fix.startswith("write ") else []


def _made_elsewhere(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the cause of an error whose own line is right; None if no such cause is known."""
    return (
        of_assertion(error, look)
        or of_test_without_init(error, look)
        or of_refused_files(error, look)
        or of_taken(error, look)
        or of_own_raise(error, look)
        or of_lone_argument(error, look)
        or of_other_end(error, look)
        or of_later_call(error, known, look)
        or of_init_order(error, look)
        or of_init_twice(error, look)
        or of_answer(error, look)
        or of_refused_name(error, look)
        or of_refused_rule(error, look)
        or of_asserted(error, look)
        or of_lost_slash(error, look)
        or of_ros_arguments(error, look)
        or made_twice(error, known, look)
        or called_by_rclpy(error, look)
        or taken_from_rclpy(error, known, look)
        or of_launched_command(error, look)
        or declaration_fault(error, look)
        or of_unanswered(error, look)
        or undeclared_argument(error, look)
    )


def _worded(error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Return the findings for the meanings of an error's lines."""
    found: list[Finding] = []
    exceptions = {report.line for report in error.reports}
    for line in lines_of(error):
        if line not in exceptions:
            # Other lines count only if no exception explains itself or names a faulty file.
            found = found or [
                finding for finding in known if any(_names(said, finding.place) for said in exceptions)
            ]
            if found:
                break
        meaning = next((candidate for candidate in MEANINGS if candidate.pattern.search(line)), None)
        if meaning is not None:
            found += _meant(meaning, line, error, known, look)
    return found


# Codes for which the command itself may be wrong: then the corrected command is the fix.
_OF_THE_COMMAND = frozenset(
    f"{SAID} {UNKNOWN} package-not-found executable-missing file-not-found topic-near-miss topic-type typed-wrong "
    "parameter-name parameter-type message-field".split()
)


def _with_command(found: list[Finding], error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Make the corrected command the fix of the first finding if the command was wrong."""
    first = found[0] if found else Finding(UNKNOWN, "")
    is_told = first.code not in (SAID, UNKNOWN)
    is_refused = REFUSED.search(error.text) is not None
    if not look or first in known or first.code not in _OF_THE_COMMAND:
        return found
    if is_told and "`" in first.fix and not is_refused:
        return found
    blamed = step_with(error.decisive, error.steps)
    lines = [step.command for step in reversed(error.steps) if step is blamed or not _did_well(step)]
    commands = [as_keyed(command) for line in lines if line for command in _SHELLS.split(line)]
    meant = next((better for command in commands if (better := as_meant(command, error, look))), None)
    if meant is None:
        return found
    if first.code == "package-not-found":
        first = replace(first, cause=meant.why)
    first = first if is_told and not is_refused else Finding("typed-wrong", meant.why)
    return [replace(first, fix=f"type `{meant.line}`"), *found[1:]]


def _did_well(step: Step) -> bool:
    """Return whether the output of a command shows that it succeeded, and complains of nothing."""
    is_told = any(meaning.pattern.search(line) for meaning in MEANINGS for line in step.lines)
    return not (is_told or any(map(is_complaint, step.lines))) and step.is_answered


def _checked(error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Return what the type checker and the libraries' signatures say about the lines of a traceback."""
    named = [place_of([frame], look) for frame in own_frames(error.frames)[:8]]
    paths = {_file(place): look.root / _file(place) for place in named if _file(place).endswith(".py")}
    if "Caught exception in launch" in error.text:
        # launch seldom names the line: any line may be meant.
        files = look.launches
        paths |= {file.shown: path for file, path in files if path.suffix == ".py"}
        named += [
            f"{shown}:{n}" for shown, path in paths.items() for n in range(1, read_text(path).count("\n") + 2)
        ]
    # Wrong types raise built-in exceptions; a library's own exceptions explain themselves.
    last = error.report or ErrorReport("", "")
    is_pythons = not error.reports or hasattr(builtins, last.kind)
    early = [*called_at_once(look)] if named and is_pythons else []
    asked = (
        [*early, *type_faults(look, [*known, *early], named, last.message)] if named and is_pythons else []
    )
    found = [finding for finding in asked if finding.place in named]
    if not found and not own_frames(last.frames[-1:]):
        for shown, path in paths.items():
            # A line with a known fault is not checked again.
            told = {finding.place for finding in known if stops_node(finding)}
            lines = {int(place.rpartition(":")[2]) for place in {*named} - told if _file(place) == shown}
            found += call_faults(read_source(path, path.stem, shown), lines, last.message, stands_trial)
    return found


def _file(place: str) -> str:
    return place.rpartition(":")[0]


def _in_line(error: ErrorText, known: list[Finding]) -> list[Finding]:
    """Return the findings on the line of an error; else, if it came from a spin, those in the same file."""
    near = {finding: _nearness(finding, error, error.decisive) for finding in known}
    # A fault that does not stop the node does not explain an exception.
    is_code = {finding: bool(error.reports) and ".py:" in finding.place for finding in known}
    # An exception raised inside a library may come from when or by whom it is called.
    inner = error.report.frames[-1:] if error.report else ()
    is_librarys = bool(inner) and not own_frames(inner)
    on_it = [
        finding
        for finding in known
        if near[finding] == 3
        and (stops_node(finding) or not is_code[finding] or (is_librarys and is_about_life(finding)))
    ]
    return on_it or [
        finding for finding in known if near[finding] == 2 and stops_node(finding) and "spin" in error.text
    ]


# Codes of faults that keep launch from loading a file, whatever its message is.
_REFUSED_BY_LAUNCH = frozenset(
    ("import-wrong", "launch-argument", "launch-function", "launch-syntax", "comma-tuple", "comma-missing")
)
_NOT_THERE = frozenset(("not-built", "package-not-found", "executable-missing"))


def _asked_first(error: ErrorText, known: list[Finding], found: list[Finding], look: Look) -> list[Finding]:
    """Return the faults of a failed build or launch, or else of the entry point that was run."""
    if refused := _refused_by_launch(error, known, found, look):
        return refused
    if found and found[0] in known and stops_build(found[0]):
        return []
    is_of_setup = bool(error.reports) and is_setup(place_of(error.own, look))
    is_of_build = is_of_setup or _BUILD_FAILED.search(error.text) is not None
    if is_of_build and (stops := [finding for finding in known if stops_build(finding)]):
        return stops
    if is_of_setup and found and found[0].code in _NOT_THERE:
        return said_by_tools(error, look)  # a package that could not be built is not found later
    named = [finding for finding in known if error.command and error.command[2] in finding.about]
    return [finding for finding in named if finding.code.startswith("entry-point")] if error.reports else []


def _refused_by_launch(
    error: ErrorText, known: list[Finding], found: list[Finding], look: Look
) -> list[Finding]:
    """Return the faults in a launch file that launch could not load, or whose program it could not start."""
    stops = [finding for finding in known if finding.code in _REFUSED_BY_LAUNCH]
    if "exception occurred while executing process" in error.text:
        return stops
    if "Caught exception in launch" not in error.text:
        return []
    files = {file.shown for file in look.launch_files}
    is_told = bool(found) and found[0].code in _REFUSED_BY_LAUNCH
    return [] if is_told else [finding for finding in stops if finding.place.partition(":")[0] in files]


def _whole_report(report: ErrorReport, look: Look) -> ErrorReport:
    """Add frames for all lines of the failing statement; the line that Python names stays last."""
    own = own_frames(report.frames)
    if not own:
        return report
    spot = spot_at(place_of(own[:1], look), look)
    if spot.source is None:
        return report
    lines = spot.lines
    index = report.frames.index(own[0])
    around = tuple(replace(own[0], line=n) for n in lines if n != own[0].line)
    return replace(report, frames=(*report.frames[:index], *around, *report.frames[index:]))


def _names(line: str, place: str) -> bool:
    """Return whether a line contains the path of the file of a place."""
    file = place.partition(":")[0]
    return "/" in file and f"/{file}'" in line


def _meant(meaning: Meaning, line: str, error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    match = meaning.pattern.search(line)
    groups = match.groupdict(default="") if match else {}
    if asked := asked_for(meaning, groups, error, look):
        return [asked]
    near = {finding: _nearness(finding, error, line) for finding in known}
    has_place = bool(own_frames(error.frames))

    def may_cause(finding: Finding) -> bool:
        is_near = near[finding] or not meaning.cause
        return near[finding] >= 2 or not has_place or bool(is_near and _OF_THE_PACKAGE.match(finding.code))

    causes = sorted(
        (finding for finding in known if finding.code in meaning.codes and may_cause(finding)),
        key=lambda finding: (-near[finding], meaning.codes.index(finding.code) if near[finding] < 2 else 0),
    )
    if not causes:
        # A fault on a line of the traceback says more than the words alone.
        causes = [finding for finding in known if near[finding] == 3 and stops_node(finding)]
    if not causes and not error.reports:
        # So does a fault of the very package or file that is named.
        causes = [finding for finding in known if near[finding] and stops_build(finding)]
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


def _unknown(error: ErrorText, look: Look) -> Finding:
    return own_words(error, look) or Finding(
        UNKNOWN,
        f"This error is not known here; the line to look up is: {error.decisive}",
        place_of(own_frames(error.frames), look),
    )


def _workspace_of(error: ErrorText) -> Path | None:
    """Return the workspace of the first file in the traceback that exists here; None if there is none."""
    paths = (Path(frame.file) for frame in own_frames(error.frames))
    roots = (workspace_around(path.parent) for path in paths if path.is_absolute() and path.is_file())
    return next((root for root in roots if root is not None), None)


def _beside(error: ErrorText, sources: Mapping[str, str], look: Look) -> Iterator[Finding]:
    """Yield faults in the cells and the files outside any workspace that a traceback names."""
    for file in dict.fromkeys(frame.file for frame in own_frames(error.frames)):
        path = Path(file)
        if file in sources:
            # A name that this cell does not define may come from an earlier one.
            alone = text_faults(PythonSource("cell", file, sources[file]))
            yield from (
                finding for finding in alone if finding.code not in ("name-undefined", "parameter-undeclared")
            )
        elif not look and path.suffix == ".py" and path.is_file():
            yield from text_faults(read_source(path, path.stem, file))
