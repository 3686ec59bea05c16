"""From an error's text to its cause: what it may mean, looked up in the sources that it names."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.error_text import ErrorText, Frame, own_frames, read_error
from ros2lab.diagnose.finding import UNKNOWN, Finding, shown_path
from ros2lab.diagnose.installed import prefix_of
from ros2lab.diagnose.interfaces import homes_of
from ros2lab.diagnose.look import Look, text_faults, workspace_around
from ros2lab.diagnose.meanings import MEANINGS, Meaning
from ros2lab.diagnose.python_source import PythonSource, read_source
from ros2lab.diagnose.spelling import did_you_mean
from ros2lab.diagnose.syntax import explained, mend

# These are all about a package or its files, so the place in a program that an error names does not tell them apart.
_OF_THE_PACKAGE = re.compile(
    r"entry-point|setup|package|marker|manifest|build-type|init-file|install|not-|launch|depend|param|executable"
)
_WORD = re.compile(r"[A-Za-z_][\w.]{2,}")
_SAY_NOTHING = frozenset(("KeyboardInterrupt", "SystemExit", "CheckError", "TerminalError"))


def explain(text: str, workspace: Path | None, sources: Mapping[str, str]) -> list[Finding]:
    """Explain an error's text; see `ros2lab.diagnose.of_text`."""
    error = read_error(text)
    if not error.decisive:
        return []
    root = workspace or _workspace_of(error)
    look = Look(root) if root is not None else None
    known = [*_beside(error, sources, look), *(look.findings if look else [])]
    found: list[Finding] = []
    exceptions = {report.line for report in error.reports}
    for line in _lines(error):
        if found and line not in exceptions:
            break  # what else was printed counts only where no exception explains itself
        meaning = next((one for one in MEANINGS if one.pattern.search(line)), None)
        if meaning is not None:
            found += _meant(meaning, line, error, known, look)
    if not found:
        # Not an error that we know; but what is wrong on that very line is its likeliest cause.
        found = [one for one in known if _nearness(one, error, error.decisive) == 3]
    return list(dict.fromkeys(found)) or [_unknown(error, root)]


def _lines(error: ErrorText) -> list[str]:
    """Return what may hold the error's words: its exceptions, the last one first, then every other line."""
    exceptions = [report.line for report in reversed(error.reports) if report.kind not in _SAY_NOTHING]
    return [
        *exceptions,
        *(line for line in error.text.splitlines() if line.strip() and line not in exceptions),
    ]


def _meant(
    meaning: Meaning, line: str, error: ErrorText, known: list[Finding], look: Look | None
) -> list[Finding]:
    special = _asked_of_workspace(meaning, line, error, look)
    if special is not None:
        return [special]
    fitting = [one for one in known if one.code in meaning.codes]
    near = {one: _nearness(one, error, line) for one in fitting}
    has_place = bool(own_frames(error.frames))
    causes = [
        one
        for one in sorted(
            fitting, key=lambda one: (-near[one], meaning.codes.index(one.code) if near[one] < 2 else 0)
        )
        if near[one] >= 2
        or (_OF_THE_PACKAGE.match(one.code) and (near[one] or not meaning.cause))
        or not has_place
    ]
    if not causes and not meaning.cause:
        # The words alone say little: what is wrong on a line through which the error came says more.
        causes = [one for one in known if _nearness(one, error, line) == 3]
    return causes or _said(meaning, line, error, look.root if look else None)


def _nearness(finding: Finding, error: ErrorText, line: str) -> int:
    """Return how near a finding is to an error: 3 the same line, 2 the same file, 1 the same words, else 0."""
    file, _, number = finding.place.rpartition(":")
    name = "/".join(Path(file or finding.place).parts[-2:])
    there = [frame for frame in error.frames if frame.is_in == name or frame.file == file]
    if any(str(frame.line) == number for frame in there):
        return 3
    if there:
        return 2
    words = {
        word for word in _WORD.findall(line) if word not in ("error", "module", "object", "attribute", "None")
    }
    told = set(_WORD.findall(f"{finding.cause} {finding.place} {finding.mend}"))
    quoted = {
        word
        for text in re.findall(r"'([^']+)'|\[(\w+)\]", line)
        for part in text
        for word in _WORD.findall(part)
    }
    return int(bool((quoted or words) & told))


def _asked_of_workspace(meaning: Meaning, line: str, error: ErrorText, look: Look | None) -> Finding | None:
    """Answer what a command asked of a workspace and did not get."""
    match = meaning.pattern.search(line)
    assert match is not None
    groups = match.groupdict()
    if meaning.codes[0] == "package-not-found":
        return _no_package(groups["name"] or groups["name2"], look)
    if meaning.codes[0] == "executable-missing":
        return _no_executable(error, look)
    if "file-not-found" in meaning.codes and not (
        look and any(one.code == "not-in-data-files" and groups["name"] in one.cause for one in look.findings)
    ):
        own = next((p for p in look.packages if p.name == groups["package"]), None) if look else None
        names = [path.name for path in own.launch_files] if own else []
        return Finding(
            "file-not-found",
            f"The package {groups['package']} has installed no file {groups['name']}.{did_you_mean(groups['name'], names)}",
            "",
            "compare the name with the file's; put it into data_files of setup.py, build again and source",
        )
    return None


def _no_package(name: str, look: Look | None) -> Finding:
    names = [package.name for package in look.packages] if look else []
    if look is None or name not in names:
        return Finding(
            "package-not-found",
            f"ROS does not find a package {name} in what this terminal has sourced.{did_you_mean(name, names)}",
            "",
            "look at the name, build the workspace, and source install/setup.bash in this terminal",
        )
    package = next(one for one in look.packages if one.name == name)
    if prefix_of(look.root, name) is None:
        invalid = next(
            (
                one
                for one in look.findings
                if one.code in ("manifest-invalid", "build-type-unknown")
                and one.place.startswith(package.shown("package.xml"))
            ),
            None,
        )
        return invalid or Finding(
            "not-built",
            f"The package {name} is in src, and it was not built.",
            package.shown(""),
            f"colcon build --packages-select {name}, then source install/setup.bash",
        )
    return Finding(
        "not-sourced",
        f"The package {name} is built, and this terminal has not sourced the workspace.",
        "",
        f"source {look.root}/install/setup.bash",
    )


def _no_executable(error: ErrorText, look: Look | None) -> Finding | None:
    command = error.command
    faults = (
        "setup-cfg-missing",
        "setup-cfg-dashes",
        "entry-points-key",
        "entry-points-missing",
        "install-stale",
        "entry-point-spec",
    )
    if look is not None:
        package = next((p for p in look.packages if command and p.name == command[1]), None)
        there = look.executables.get(package.name) if package else None
        if package and command and there and command[2] not in there:
            return Finding(
                "executable-missing",
                f"The package {package.name} has no executable {command[2]}; it has {', '.join(sorted(there))}."
                f"{did_you_mean(command[2], there)}",
                package.shown("setup.py"),
                "write its name as it stands in the entry points of setup.py, or add an entry point and build again",
            )
        folder = package.shown("").removesuffix("/.") if package else ""
        for code in faults:
            for one in look.findings:
                if one.code == code and one.place.startswith(folder):
                    return one
    what = f" {command[2]} in {command[1]}" if command else ""
    return Finding(
        "executable-missing",
        f"ROS finds no such executable{what}: it is no entry point of setup.py, it was not built since, or setup.cfg "
        "does not put it into lib/<package>.",
        "",
        "look at entry_points in setup.py and at setup.cfg, build again, and source install/setup.bash",
    )


def _said(meaning: Meaning, line: str, error: ErrorText, root: Path | None) -> list[Finding]:
    """Explain an error by its words alone."""
    match = meaning.pattern.search(line)
    assert match is not None
    frames = own_frames(error.frames)
    place = _place(frames, root)
    if meaning.cause:
        groups = {name: value or "" for name, value in match.groupdict().items()}
        return [
            Finding(
                meaning.codes[0],
                meaning.cause.format(**groups).replace(" ()", ""),
                place,
                meaning.mend.format(**groups),
            )
        ]
    report = error.reports[-1] if error.reports else None
    if report and report.kind in ("SyntaxError", "IndentationError", "TabError"):
        fault = {"SyntaxError": SyntaxError, "IndentationError": IndentationError, "TabError": TabError}[
            report.kind
        ](report.message)
        place = _place(list(report.frames[::-1]), root)
        code = "setup-syntax" if re.search(r"setup\.py(:|$)", place) else "node-syntax"
        return [Finding(code, f"Python cannot read the file: {explained(fault)}.", place, mend(fault))]
    if report and report.kind == "NameError":
        name = match.groupdict().get("name", "")
        is_setup = re.search(r"setup\.py(:|$)", place) is not None
        homes = homes_of(name)
        return [
            Finding(
                "setup-import" if is_setup else "name-missing",
                f"{name} is used before it is imported or defined.",
                place,
                f"write `from {homes[0]} import {name}` at the top"
                if homes
                else f"import {name} or define it above, or mend its spelling",
            )
        ]
    if report and report.kind == "AttributeError" and "name" in match.groupdict():
        owner = (
            match.groupdict().get("owner") or match.groupdict().get("module") or "what stands before the dot"
        )
        hint = re.search(r"Did you mean: '(.+?)'", line)
        return [
            Finding(
                "attribute-unknown",
                f"{owner} has no {match['name']}.",
                place,
                f"write {hint[1]}" if hint else "mend its spelling, or define it first",
            )
        ]
    return []


def _unknown(error: ErrorText, root: Path | None) -> Finding:
    return Finding(
        UNKNOWN,
        f"This error is not known here; its decisive line is: {error.decisive}",
        _place(own_frames(error.frames), root),
    )


def _place(frames: list[Frame], root: Path | None) -> str:
    return f"{shown_path(Path(frames[0].file), root)}:{frames[0].line}" if frames else ""


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
    inside = (
        {str(path) for package in look.packages for s in package.sources.values() if (path := s.path)}
        if look
        else set()
    )
    for file in dict.fromkeys(frame.file for frame in own_frames(error.frames)):
        path = Path(file)
        if file in sources:
            # What a cell does not define, an earlier one may.
            alone = text_faults(PythonSource("cell", file, sources[file]))
            yield from (one for one in alone if one.code not in ("name-undefined", "parameter-undeclared"))
        elif look is None and file not in inside and path.suffix == ".py" and path.is_file():
            yield from text_faults(read_source(path, path.stem, file))
