"""From an error's text to its cause: what it may mean, looked up in the sources that it names."""

from __future__ import annotations

import ast
import builtins
import contextlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from ros2lab.diagnose.calls import call_faults, missing_imports
from ros2lab.diagnose.commands import Corrected, corrected
from ros2lab.diagnose.error_text import ErrorReport, ErrorText, Frame, own_frames, read_error
from ros2lab.diagnose.filled import of_filled, of_item
from ros2lab.diagnose.finding import SAID, UNKNOWN, Finding, shown_path, stops_build, stops_node
from ros2lab.diagnose.interfaces import homes_of, inner_homes_of, launch_homes_of, members_of, methods_of
from ros2lab.diagnose.look import Look, text_faults, workspace_around
from ros2lab.diagnose.meaning import Meaning
from ros2lab.diagnose.meanings import MEANINGS
from ros2lab.diagnose.message_faults import set_field
from ros2lab.diagnose.not_found import no_executable, no_file, no_module, no_package, not_sourced
from ros2lab.diagnose.origins import of_argument, of_origin
from ros2lab.diagnose.parameter_faults import given_at, of_parameter_file, typed_rightly
from ros2lab.diagnose.python_says import Spot, of_error, of_function
from ros2lab.diagnose.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.said import launch_line, launch_paths, of_launch, of_python, passed_on
from ros2lab.diagnose.spelling import nearest
from ros2lab.diagnose.syntax import explained
from ros2lab.diagnose.type_checker import stands_trial, type_faults
from ros2lab.diagnose.typed import as_keyed, own_shells, typed_faults
from ros2lab.diagnose.usage import accepted_form

# These are all about a package or its files, so the place in a program that an error names does not tell them apart.
_OF_THE_PACKAGE = re.compile(
    r"entry-point|setup|package|marker|manifest|build-type|init-file|install|not-|launch|depend|param|executable"
)
_BUILD_FAILED = re.compile(
    r"^(?:Failed +<<< |error: can't copy|error in \S+ setup command|(?:\[[\d.]+s\] )?ERROR:colcon)|in setup command|setup\.py.*returned non-zero",
    re.M,
)
_REFUSED = re.compile(r"^(?:usage: )?ros2[ \w]*: error: ", re.M)
_LOGGED = re.compile(r"^\[[A-Z]+\] (?:\[[\d.]+\] )?\[[\w.]+\]: ")
_WORD = re.compile(r"[A-Za-z_][\w.]{2,}")
_EVERYWHERE = frozenset(("error", "module", "object", "attribute", "None"))
_MOST_OF_TESTS = 20_000  # characters of what pytest has written
_MOST_CORRECTIONS = 4  # words of a command that are put right
_SAY_NOTHING = frozenset(("KeyboardInterrupt", "SystemExit", "CheckError", "TerminalError"))


def explain(text: str, workspace: Path | None, sources: Mapping[str, str], *, loads: bool) -> list[Finding]:
    """Explain an error's text; see `ros2lab.diagnose.of_text`."""
    error = read_error(text)
    root = workspace or _workspace_of(error)
    if root is not None and (more := _of_test_results(error, root)):
        error = read_error(f"{text}\n{more}")
    look = Look(root, loads=loads and "launch" in text) if root is not None else None
    known = [*_beside(error, sources, look), *(look.findings if look else [])]
    if look and error.frames:
        error = replace(error, reports=tuple(_whole(report, look) for report in error.reports))
    checked = _checked(error, known, look) if look else []
    found = _with_command(_of_what_was_said(error, known, checked, look), error, known, look)
    if error.decisive and all(one.code in (SAID, UNKNOWN) and not one.fix and not one.place for one in found):
        found = [*known, *found]
    if not found and not error.is_clear:
        # Nothing in it is an error: what is wrong with the workspace may be why it does not what it should.
        return known or ([_unknown(error, look)] if error.decisive and not look else [])
    if look and "Caught exception in launch" in error.text:
        found = [one if one.place else replace(one, place=launch_line(error, look)) for one in found]
    return [_with_imports(one, look) for one in dict.fromkeys(found)] or [_unknown(error, look)]


def _of_test_results(error: ErrorText, root: Path) -> str:
    """Return what pytest has written of failed tests into the files that a text names; empty if nothing."""
    texts = []
    for name in re.findall(r"^(build/[\w-]+/pytest\.xml):", error.text, re.MULTILINE):
        with contextlib.suppress(OSError, ElementTree.ParseError):
            for node in ElementTree.fromstring(read_text(root / name)).iter():  # noqa: S314 -- pytest has written it
                if node.tag in ("error", "failure") and node.text:
                    texts.append(node.text)
    return "\n".join(texts)[-_MOST_OF_TESTS:]


def _with_imports(finding: Finding, look: Look | None) -> Finding:
    """Return a finding whose fix names the import of each class that it writes into a file without one."""
    source = _spot(finding.place, look).source if "import" not in finding.fix else None
    lines = missing_imports(source, finding.fix) if source and source.text else []
    more = f", with `{'; '.join(lines)}` at the top" if lines else ""
    return replace(finding, fix=f"{finding.fix}{more}")


def _of_what_was_said(
    error: ErrorText, known: list[Finding], checked: list[Finding], look: Look | None
) -> list[Finding]:
    """Return what the words of an error mean, what they lead to, or what the tool says well itself."""
    found = _worded(error, [*known, *checked], look)
    found = _asked_first(error, known, found, look) or _where_made(error, known, look) or found
    if not error.reports and (not found or found[0] not in known):
        found = [*typed_faults(error, look)] or found
    if error.decisive:
        found = found or checked or _in_line(error, known) or _passed_on(error, look)
    return [*own_shells(error.typed), *found]


def _worded(error: ErrorText, known: list[Finding], look: Look | None) -> list[Finding]:
    """Return what the words of an error mean."""
    found: list[Finding] = []
    exceptions = {report.line for report in error.reports}
    for line in _lines(error):
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
    parts = [as_keyed(part) for line in reversed(error.typed) for part in line.split(" && ")]
    meant = next((one for part in parts if (one := _as_meant(part, error, look))), None)
    if meant is None:
        return found
    first = first if is_told and not is_refused else Finding("typed-wrong", meant.why)
    return [replace(first, fix=f"type `{meant.line}`"), *found[1:]]


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
    named = [_place([frame], look) for frame in own_frames(error.frames)[:8]]
    paths = {_file(place): look.root / _file(place) for place in named if _file(place).endswith(".py")}
    if "Caught exception in launch" in error.text:
        # It seldom says where: all lines may be meant.
        files = zip(look.launch_files, launch_paths(look), strict=True)
        paths |= {file.shown: path for file, path in files if path.suffix == ".py"}
        named += [
            f"{shown}:{n}" for shown, path in paths.items() for n in range(1, read_text(path).count("\n") + 2)
        ]
    # What has a wrong type is told by Python; an exception of a library's own says itself what it is about.
    is_pythons = not error.reports or hasattr(builtins, error.reports[-1].kind)
    found = (
        [one for one in type_faults(look, known, named) if one.place in named] if named and is_pythons else []
    )
    innermost = error.reports[-1].frames[-1:] if error.reports else ()
    if not found and not own_frames(innermost):
        for shown, path in paths.items():
            # Of what is known of a line already nothing else is said.
            told = {one.place for one in known if stops_node(one)}
            lines = {int(place.rpartition(":")[2]) for place in {*named} - told if _file(place) == shown}
            said = error.reports[-1].message if error.reports else ""
            found += call_faults(read_source(path, path.stem, shown), lines, said, stands_trial)
    return found


def _file(place: str) -> str:
    return place.rpartition(":")[0]


def _in_line(error: ErrorText, known: list[Finding]) -> list[Finding]:
    """Return what is wrong on the very line of an error, or, below a spin, in the callbacks of its file."""
    near = {one: _nearness(one, error, error.decisive) for one in known}
    # What only surprises in a line of code is no reason for an exception.
    is_code = {one: bool(error.reports) and ".py:" in one.place for one in known}
    on_it = [one for one in known if near[one] == 3 and (stops_node(one) or not is_code[one])]
    return on_it or [one for one in known if near[one] == 2 and stops_node(one) and "spin" in error.text]


def _passed_on(error: ErrorText, look: Look | None) -> list[Finding]:
    """Return what an error says well itself."""
    reports = [report for report in error.reports[-1:] if report.kind not in _SAY_NOTHING]
    said = (
        [of_python(report, _place(own_frames(report.frames), look), look) for report in reports]
        if reports
        else [passed_on(line, error, look) for line in _lines(error)]
    )
    found = [one for one in said if one is not None][:1]
    if not found and look and "Caught exception in launch" in error.text:
        found = [one for one in [of_launch(error, look)] if one]
    return found


def _where_made(error: ErrorText, known: list[Finding], look: Look | None) -> list[Finding]:
    """Return what is wrong where that was made which is used in the line of an error: a value, a class, a function."""
    reports = error.reports[-1:]
    frames = own_frames(reports[0].frames)[:1] if reports else []
    spot = replace(_spot(_place(frames, look), look), part=frames[0].part if frames else "")
    if (source := spot.source) is None:
        return []
    if early := of_filled(reports[0].message, spot) or of_item(reports[0].message, spot):
        return [early]
    used = {ast.unparse(n) for n in spot.nodes if isinstance(n, (ast.Name, ast.Attribute)) and _is_load(n)}
    lines: set[int] = set()
    for node in source.nodes:
        if isinstance(node, ast.ClassDef) and node.name in used:
            lines |= {node.lineno, *(method.lineno for method in node.body)}
        elif isinstance(node, ast.Assign) and used.intersection(map(ast.unparse, node.targets)):
            lines |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    places = {f"{source.shown}:{line}" for line in lines - {spot.line}}
    found = [one for one in known if one.place in places and one.code in _MAKES_WRONG]
    if reports[0].kind not in ("AttributeError", "TypeError"):
        return found
    callers = own_frames(reports[0].frames)[1:2]
    made = of_argument(reports[0].message, spot, _spot(_place(callers, look), look)) if callers else None
    made = made or of_origin(reports[0].kind, reports[0].message, spot)
    return found or ([made] if made else [])


# What makes a value or a class other than was meant, so that what uses it fails.
_MAKES_WRONG = frozenset(
    ("comma-tuple", "comma-missing", "super-misspelt", "super-missing", "parameter-type")
)


def _is_load(node: ast.Name | ast.Attribute) -> bool:
    return isinstance(node.ctx, ast.Load)


# What keeps launch from loading a file, whatever it says of it.
_REFUSED_BY_LAUNCH = frozenset(
    ("import-wrong", "launch-argument", "launch-function", "launch-syntax", "comma-tuple", "comma-missing")
)


def _asked_first(
    error: ErrorText, known: list[Finding], found: list[Finding], look: Look | None
) -> list[Finding]:
    """Return what keeps from being built or loaded what failed to be, or is wrong in the line that names what was run."""
    if look and "Caught exception in launch" in error.text:
        files = {file.shown for file in look.launch_files}
        stops = [
            one for one in known if one.code in _REFUSED_BY_LAUNCH and one.place.partition(":")[0] in files
        ]
        if stops and (not found or found[0].code not in _REFUSED_BY_LAUNCH):
            return stops
    if found and found[0] in known and stops_build(found[0]):
        return []
    if again := _made_twice(error, known, look):
        return [again]
    if _BUILD_FAILED.search(error.text) and (stops := [one for one in known if stops_build(one)]):
        return stops
    named = [one for one in known if error.command and f"executable {error.command[2]} " in one.cause]
    return [one for one in named if one.code.startswith("entry-point")] if error.reports else []


def _made_twice(error: ErrorText, known: list[Finding], look: Look | None) -> Finding | None:
    """Return that the function in which an error came has replaced another one of its name; None if it has not."""
    frames = own_frames(error.reports[-1].frames) if error.reports else []
    spot = _spot(_place(frames, look), look) if frames else Spot(None, 0)
    if spot.source is None or spot.function is None:
        return None
    place = f"{spot.source.shown}:{spot.function.lineno}"
    return next((one for one in known if one.code == "replaced" and one.place == place), None)


def _whole(report: ErrorReport, look: Look) -> ErrorReport:
    """Return an error with all lines of the statement at which it came; the line that Python names stays the last."""
    own = own_frames(report.frames)
    if not own:
        return report
    file, _, line = _place(own[:1], look).rpartition(":")
    path = look.root / file
    if not line.isdigit() or not path.is_file():
        return report
    lines = Spot(read_source(path, path.stem, file), int(line)).lines
    index = report.frames.index(own[0])
    around = tuple(replace(own[0], line=n) for n in lines if n != own[0].line)
    return replace(report, frames=(*report.frames[:index], *around, *report.frames[index:]))


def _lines(error: ErrorText) -> list[str]:
    """Return what may hold the error's words: its exceptions, the last one first, then every other line."""
    exceptions = [report.line for report in reversed(error.reports) if report.kind not in _SAY_NOTHING]
    return [
        *exceptions,
        *(line for line in error.text.splitlines() if line.strip() and line not in exceptions),
    ]


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
    return causes or _said(meaning, groups, line, error, look)


def _nearness(finding: Finding, error: ErrorText, line: str) -> int:
    """Return how near a finding is to an error: 3 the same line, 2 the same file, 1 the same words, else 0."""
    file, _, number = finding.place.rpartition(":")
    name = "/".join(Path(file or finding.place).parts[-2:])
    there = [frame for frame in error.frames if frame.is_in == name or frame.file == file]
    if there:
        return 3 if not number.isdigit() or any(str(frame.line) == number for frame in there) else 2
    if not number.isdigit() and "/" in finding.place and finding.place in error.text:
        return 3
    line = _LOGGED.sub("", line)
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
        return reset if "takes away" in reset.cause else None
    if meaning.codes[0] == "not-sourced" and look and error.typed:
        names = [
            package.name for package in look.packages if package.name == groups["name"].replace("-", "_")
        ]
        return not_sourced(names[0], error.typed, error.text, look.root) if names else None
    if meaning.codes[0] == "executable-missing":
        return no_executable(error.command, look)
    return no_file(groups["name"], groups["package"], look) if "file-not-found" in meaning.codes else None


def _said(
    meaning: Meaning, groups: Mapping[str, str], line: str, error: ErrorText, look: Look | None
) -> list[Finding]:
    """Explain an error by its words alone."""
    place = _place(own_frames(error.frames), look)
    is_declared = groups.get("wanted") == "INTEGER" and not groups.get("value", "0").lstrip("-").isdigit()
    if meaning.codes[0] == "parameter-type" and groups.get("name") and not is_declared:
        place = given_at(groups["name"], look, error.typed) or place
    told = of_parameter_file(error.text, look) if meaning.codes[0] == "parameter-file-syntax" else None
    if meaning.codes[0] == "entry-point-module":
        told = no_module(groups["name"].removesuffix(".py").replace("/", "."), place, look)
    if told:
        return [told]
    if meaning.cause:
        cause = meaning.cause.format(**groups).replace(" ()", "")
        do = meaning.fix.format(**groups) if isinstance(meaning.fix, str) else meaning.fix(**groups)
        if meaning.codes[0] == "parameter-type" and groups.get("name"):
            command = typed_rightly(groups["name"], groups["value"], groups["wanted"], error.typed)
            place, do = ("", f"type `{command}`") if command else (place, do)
        do = (_field_fix(_spot(place, look), groups) if "what" in groups and "name" in groups else "") or do
        return [Finding(meaning.codes[0], cause, place, do)]
    report = error.reports[-1] if error.reports else ErrorReport("", "")
    hint = re.search(r"Did you mean: '(.+?)'", line)
    if report.kind in ("SyntaxError", "IndentationError", "TabError"):
        place = _place([*reversed(report.frames)], look)
        code = "setup-syntax" if _is_setup(place) else "node-syntax"
        source = _spot(place, look).source
        found = source.fault if source and source.tree else None
        fault = found or getattr(builtins, report.kind)(report.message)
        return [explained(code, "Python cannot read the file", place, fault, source if found else None)]
    if report.kind == "NameError":
        name = groups.get("name", "")
        is_launched = "Caught exception in launch" in error.text
        homes = launch_homes_of(name) if is_launched else homes_of(name)
        do = f"import {name} or define it above, fix its spelling, or put it in quotes if it is a text"
        do = f"write {hint[1]}" if hint else do
        do = f"write `from {homes[0]} import {name}` at the top" if homes else do
        code = "setup-import" if _is_setup(place) else "name-missing"
        return [Finding(code, f"{name} is used before it is imported or defined.", place, do)]
    if report.kind == "AttributeError" and "name" in groups:
        return [_no_attribute(groups, hint[1] if hint else "", place, look)]
    return []


def _field_fix(spot: Spot, groups: Mapping[str, str]) -> str:
    """Say how the value that stands in a line is put into a field of a message; empty if that is not found there."""
    wanted = re.search(r"type '(\w+)'", groups["what"])
    home = (homes_of(wanted[1]) if wanted and wanted[1][:1].isupper() else ()) or ("",)
    for node in spot.nodes:
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        kind = f"{home[0]}.{wanted[1]}".lstrip(".") if wanted else ""
        if kind and isinstance(target, ast.Attribute) and target.attr == groups["name"]:
            return set_field(target, kind, node.value)  # type: ignore[attr-defined]
        fields = [one for one in getattr(target, "elts", ()) if getattr(one, "attr", "") == groups["name"]]
        if kind and fields:
            new = set_field(fields[0], kind, ast.Constant(0)).partition(" = ")[0]
            return f"{new} in place of {ast.unparse(fields[0])}, and so for what stands beside it"
    return ""


def _no_attribute(groups: Mapping[str, str], near: str, place: str, look: Look | None) -> Finding:
    name, owner = groups["name"], groups.get("owner") or groups.get("module") or "what stands before the dot"
    homes = homes_of(name) if groups.get("module") else ()
    if owner == "NoneType":
        spot = _spot(place, look)
        message = f"'NoneType' object has no attribute '{name}'"
        return of_error("AttributeError", message, place, spot) or Finding(
            "attribute-unknown", message, place
        )
    if homes:
        fix = f"write `from {homes[0]} import {name}` at the top, and {name} here"
        return Finding("import-wrong", f"{owner} itself has no {name}: it is in {homes[0]}.", place, fix)
    if owner in ("function", "method", "builtin_function_or_method"):
        return of_function(name, place, _spot(place, look))
    methods = methods_of(owner)
    homes = homes_of(owner) or inner_homes_of(owner)
    near = near or nearest(name, {one for home in homes for one in members_of(home, owner)[0]}) or ""
    fix = f"use what a {owner} has: {methods}" if methods else "fix its spelling, or define it first"
    fix = f"write {near}" if near else fix
    return Finding("attribute-unknown", f"{owner} has no {name}.", place, fix)


def _spot(place: str, look: Look | None) -> Spot:
    file, _, line = place.rpartition(":")
    path = (look.root if look else Path()) / file
    is_known = line.isdigit() and path.is_file()
    return Spot(read_source(path, path.stem, file) if is_known else None, int(line) if is_known else 0)


def statement_around(place: str, look: Look) -> list[str]:
    """Return the places of all lines of the statement at a place; of the file, if that names no line."""
    if not place.rpartition(":")[2].isdigit():
        lines = read_text(look.root / place).splitlines() if (look.root / place).is_file() else []
        return [f"{place}:{number}" for number, _ in enumerate(lines, 1)]
    spot = _spot(place, look)
    return [f"{spot.source.shown}:{line}" for line in spot.lines] if spot.source else []


def _is_setup(place: str) -> bool:
    return re.search(r"setup\.py(:|$)", place) is not None


def _unknown(error: ErrorText, look: Look | None) -> Finding:
    return Finding(
        UNKNOWN,
        f"This error is not known here; its decisive line is: {error.decisive}",
        _place(own_frames(error.frames), look),
    )


def _place(frames: list[Frame], look: Look | None) -> str:
    """Return the innermost place; of an installed copy, that of the student's own file."""
    if not frames:
        return ""
    file = frames[0].file
    for package in look.packages if look else ():
        for source in [*package.sources.values(), *([package.setup.source] if package.setup else [])]:
            if file == source.shown or file.endswith(f"/{'/'.join(Path(source.shown).parts[2:])}"):
                return f"{source.shown}:{frames[0].line}"
    return f"{shown_path(Path(file), look.root if look else None)}:{frames[0].line}"


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
