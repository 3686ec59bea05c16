"""Passes on what tools, shells and Python say, with the nearest valid word and the place."""

from __future__ import annotations

import ast
import errno
import keyword
import os
import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.causes.file_lookups import of_missing_file, of_shared_file
from ros2lab.diagnose.causes.python_says import of_error
from ros2lab.diagnose.explaining.ros_1_tools import ROS_1_TOOLS
from ros2lab.diagnose.explaining.shell_assignments import of_assignment
from ros2lab.diagnose.explaining.started_files import of_interpreter, of_line_ends
from ros2lab.diagnose.explaining.there_already import existing_folder, of_existing
from ros2lab.diagnose.explaining.warnings_told import of_warning
from ros2lab.diagnose.finding import SAID, Finding, at, line_with, shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import PREFIX, ErrorReport, ErrorText, Frame, own_frames
from ros2lab.diagnose.printed.names_there import node_names, topic_ends
from ros2lab.diagnose.printed.spots import place_of, spot_of
from ros2lab.diagnose.printed.transcript import (
    LABELLED,
    OF_LATER,
    SYSTEM,
    WARNING,
    Step,
    harmless_lines,
    is_refusal,
    step_with,
    without_data,
)
from ros2lab.diagnose.sources.python_source import read_source, read_text
from ros2lab.diagnose.sources.spelling import did_you_mean, has_form_of, nearest

_USAGE = re.compile(r"^(?P<tool>[\w./-]+(?: [\w-]+)*): error: (?P<said>.+)")
_CHOICE = re.compile(r"invalid choice: '?(?P<given>[^' ]*)'? \(choose from (?P<choices>.*)\)")
_SYSTEM_SAYS = re.compile(
    rf"^(?:(?P<tool>[^\s:]+): )?(?P<before>.*?)(?:: )?(?:\[Errno \d+\] )?(?P<said>{'|'.join(map(re.escape, SYSTEM))})"
    r"(?:: (?P<after>.+))?$"
)
_STARTS = re.compile(
    r"exception occurred while executing process|cannot be started|failed to run command|^\S*env: "
)
_NO_COMMAND = re.compile(
    r"^(?P<tool>[^\s:]+): (?:line )?(?:\d+: )?(?:(?P<name>\S+): (?:command )?not found|command not found: (?P<name2>\S+))$"
)
_SCRIPT = re.compile(r"^(?P<file>\S+\.py): line \d+: ")
# How ros2, launch and colcon begin an error message.
_SHOWS_ARGUMENTS = " -h` shows its arguments"
_SENTENCE = re.compile(
    r"(?:unknown|unable|could not|cannot|can't|failed to|malformed|invalid|the passed|there is no|no such|node not|fatal"
    r"|error|ignoring unknown|not a|no matching)\b",
    re.IGNORECASE,
)
_SAY_NOTHING = frozenset(("KeyboardInterrupt", "SystemExit", "CheckError", "TerminalError"))
_NOT_LOOKED_INTO = frozenset(("build", "install", "log", "__pycache__"))


def said_by_tools(error: ErrorText, look: Look) -> list[Finding]:
    """Return the message of an exception or a tool; empty if there is none to pass on."""
    reports = [report for report in error.reports[-1:] if report.kind not in _SAY_NOTHING]
    harmless = harmless_lines(error.steps)
    said = (
        [_of_report(report, error, look) for report in reports]
        if reports
        else [passed_on(line, error, look) for line in lines_of(error) if line not in harmless]
    )
    found = [finding for finding in said if finding is not None][:1]
    if not found and look and "Caught exception in launch" in error.text:
        found = [finding for finding in [of_launch(error, look)] if finding]
    if found and "Warning: " in error.decisive and step_with(error.decisive, error.steps).ended_well:
        only = "The command succeeded; this is only a warning."
        return [replace(finding, cause=f"{only} {finding.cause}") for finding in found]
    return found


def lines_of(error: ErrorText) -> list[str]:
    """Return the lines that may name the error: the exceptions, the last first, then all other lines."""
    exceptions = [report.line for report in reversed(error.reports) if report.kind not in _SAY_NOTHING]
    return [
        *exceptions,
        *(line for line in error.text.splitlines() if line.strip() and line not in exceptions),
    ]


def passed_on(line: str, error: ErrorText, look: Look) -> Finding | None:
    """Pass on a message of a tool, a shell or the system, with what to do; None if the line is none."""
    line = line.strip()
    if script := _SCRIPT.match(line):
        file = script["file"]
        cause = f"The shell reads {file} as shell commands, because its first line does not say that it is Python."
        fix = f"start it with python3 {file}, or write #!/usr/bin/env python3 as its very first line"
        return Finding(SAID, cause, file, fix)
    step = step_with(line, error.steps)
    refused = of_assignment(line, step, look)
    if missing := _NO_COMMAND.match(line):
        return refused or _no_command(missing["tool"], missing["name"] or missing["name2"])
    if warning := WARNING.match(line):
        is_told = _concerns(warning, step)
        return of_warning(line, error.text, look) if is_told else None
    if usage := _USAGE.match(line):
        return _usage(usage["tool"], usage["said"], error)
    if said := _SYSTEM_SAYS.match(line):
        return of_existing(line, step, look) or _of_system(said, look)
    return refused or of_existing(line, step, look) or _sentence(line, error, look)


def _concerns(warning: re.Match[str], step: Step) -> bool:
    """Return whether a warning is not about later versions, and about the student's code unless the command failed."""
    # pytest warns at a line of its own code, and names the test.
    is_own = ".py" in warning["message"] or bool(own_frames([Frame(warning["file"], int(warning["line"]))]))
    return not OF_LATER.search(f"{warning['kind']}: {warning['message']}") and (is_own or not step.ended_well)


def _sentence(line: str, error: ErrorText, look: Look) -> Finding | None:
    """Return the error message of ros2, launch or colcon; None if the line is none.

    A mere warning is passed on only if it is known what was meant.
    """
    sentence = PREFIX.sub("", line, count=1)
    if not error.reports and (_SENTENCE.match(without_data(sentence)) or is_refusal(sentence)):
        quoted = re.findall(r"'([^']+)'", sentence)
        meant = re.search(r"(?i:did you mean|possible options:) '?([\w/-]+)", sentence)
        known = set(_names(look)) if meant is None else set()
        alike = ((word, nearest(word, (n for n in known if has_form_of(n, word)))) for word in quoted)
        wrong, close = next((pair for pair in alike if pair[1]), ("", None))
        hint = f" Nothing here is called {wrong}; there is {close}." if close else ""
        word = close or (meant[1] if meant else None)
        form = re.search(r"expected format '(.+?)'", sentence)
        last = re.match(r"(?:[a-z]\w* ?){0,3}", step_with(line, error.steps).command)[0].strip()  # type: ignore[index]
        fix = f"`{last}{_SHOWS_ARGUMENTS}" if last else ""
        fix = f"write {word}" if word else f"write it as {form[1]}" if form else fix
        if word or not LABELLED.match(line):
            return Finding(SAID, f"{sentence[0].upper()}{sentence[1:].rstrip('.?')}.{hint}", "", fix)
    return None


def is_bare(finding: Finding) -> bool:
    """Return whether a finding tells neither where something is wrong nor what to write."""
    return not finding.place and (not finding.fix or finding.fix.endswith(_SHOWS_ARGUMENTS))


def _no_command(tool: str, name: str) -> Finding:
    if name == "source":
        fix = "write a dot instead of source (. install/setup.bash), or type bash first"
        return Finding(SAID, f"{tool} has no command source; that belongs to bash.", "", fix)
    if name in ROS_1_TOOLS:
        fix = f"write {ROS_1_TOOLS[name]} instead"
        return Finding(SAID, f"{name} is a command of ROS 1; in ROS 2 it is {ROS_1_TOOLS[name]}.", "", fix)
    if not re.search(r"\w", name):
        cause = f"{name} is the prompt, which the terminal itself prints; it is not part of the command."
        return Finding(SAID, cause, "", f"type only what comes after {name}")
    folders = [Path(folder) for folder in os.environ.get("PATH", "").split(os.pathsep)]
    commands = [program.name for folder in folders if folder.is_dir() for program in folder.iterdir()]
    close = nearest(name, [command for command in commands if abs(len(command) - len(name)) < 2])
    if keyword.iskeyword(name):
        fix = "type python3 first, or put it into a file and run that with python3"
        return Finding(SAID, f"{name} belongs to Python; the shell has no such command.", "", fix)
    fix = f"write {close}" if close else "fix its spelling; if it is right, the program is not installed here"
    if shutil.which(name):
        fix = "it exists on this machine: in that terminal, activate the course's .venv or source ROS's setup.bash"
    cause = f"There is no command {name} in this terminal.{did_you_mean(name, [close] if close else [])}"
    return Finding(SAID, cause, "", fix)


def _usage(tool: str, said: str, error: ErrorText) -> Finding:
    help_ = f"{tool} -h shows its arguments"
    if choice := _CHOICE.search(said):
        choices = re.findall(r"[\w.-]+", choice["choices"])
        close = nearest(choice["given"], choices, 0.6)
        option = re.match(r"argument (-\S+):", said)
        what = f"for {option[1]} " if option else ""
        cause = f"{tool} does not accept {choice['given']} {what}here; it accepts {', '.join(choices)}."
        return Finding(SAID, cause, "", f"write {close}" if close else help_)
    if match := re.match(r"unrecognized arguments?: (.+)", said):
        wrong = match[1].split()[0]
        if re.search(r"[}\]]", match[1]) and not wrong.startswith("-"):
            fix = "put the whole value in quotes: '{data: hello}'"
            return Finding(SAID, f"{tool} reads the value as several words, because of its spaces.", "", fix)
        if " " in match[1] and "[ERROR]" in error.text:
            # Two arguments are in one string, where a terminal would pass two.
            pieces = ", ".join(map(repr, shlex.split(match[1])))
            cause = f"{tool} is given {match[1]!r} as one argument, but it is {len(shlex.split(match[1]))}."
            return Finding(SAID, cause, "", f"write {pieces} instead of {match[1]!r} in the launch file")
        options = re.findall(r"--[\w-]+", error.text.replace(match[0], ""))
        close = nearest(wrong, options) or (wrong.replace("_", "-") if "_" in wrong else None)
        cause = f"{tool} does not know {match[1]}.{did_you_mean(wrong, options)}"
        return Finding(
            SAID, cause, "", f"write {close}" if close else f"remove it, or fix its spelling: {help_}"
        )
    if match := re.match(r"the following arguments are required: (.+)", said):
        wanted = match[1].replace(", argv", "")
        return Finding(SAID, f"The command lacks {wanted}.", "", f"add {wanted}; {help_}")
    return Finding(SAID, f"{tool}: {said}.", "", help_)


def _of_system(said: re.Match[str], look: Look, *, is_start: bool = False) -> Finding | None:
    """Explain an error of the operating system about a file, or a program that was to be started; None if it names none."""
    quoted = re.findall(
        r"(?<!\w)[\u2018'\"]([^\u2019'\"]+)[\u2019'\"]", said["after"] or said["before"] or ""
    )
    words = (said["before"] or "").removesuffix(": bad interpreter").split()
    path = quoted[-1] if quoted else words[-1] if words else said["tool"] or ""
    if not path:
        return None
    number = SYSTEM[said["said"]]
    if path.endswith(("\\r", "\r", "^M")):
        program = path.removesuffix("\\r").rstrip("\r").removesuffix("^M")
        cause = f"The first line of the file has a Windows line ending, so the system looks for a program called {program} with a carriage return at its end."
        fix = r"remove the Windows line endings of the file that was started, with sed -i 's/\r$//' and its name"
        return (of_line_ends(look) if look else None) or Finding(SAID, cause, "", fix)
    if number == errno.ENOENT:
        is_program = "/" not in path and (is_start or _STARTS.search(said.string))
        return _no_program(path, look) if is_program else _missing(path, look)
    if number in (errno.EACCES, errno.EPERM):
        return _denied(path, is_run=not said["after"] and (said["tool"] or "").endswith("sh"))
    if number == errno.ENOEXEC:
        cause = f"The first line of {path} does not say which program should run it, so the system cannot start it."
        fix = "give it an entry point in setup.py, build again, and start that; a standalone script needs #!/usr/bin/env python3 as its very first line"
        return Finding(SAID, cause, "", fix)
    return Finding(SAID, f"{path}: {said['said']}.", "", f"look at it with ls -ld {path}")


def _stale_link(path: str, look: Look) -> Finding | None:
    """Return the finding about the links of a build if a path is one that leads nowhere; None if it is none."""
    within = re.search(r"(?:^|/)((?:build|install)/.+)$", path)
    link = look.root / within[1] if within else None
    if link is None or link.exists() or not any(part.is_symlink() for part in (link, *link.parents)):
        return None
    parts = link.relative_to(look.root).parts[1:]
    stale = [finding for finding in look.findings if finding.code == "link-stale"]
    return next((f for f in stale if any(f"/{part}/" in f"{f.place}/" for part in parts)), None)


def _no_program(name: str, look: Look) -> Finding:
    """Say that a program is not on PATH, and which line of a launch file names it."""
    if shutil.which(name) or name in ROS_1_TOOLS:
        return _no_command("", name)
    begun = [f"{mark}{name}" for mark in ('"', "'", ": ")]
    lines = (at(file.shown, line_with(read_text(path), *begun)) for file, path in look.launches)
    cause = f"There is no program {name} on PATH: it is not installed here, or its name is misspelt."
    fix = f"install {name}, fix its name, or do without it"
    if " " in name:
        cause = f"There is no program {name!r}: the whole text is taken for the name of a program."
        fix = f"give the program and its arguments one by one: {name.split()!r}"
    return Finding(SAID, cause, next((place for place in lines if ":" in place), ""), fix)


def _missing(path: str, look: Look) -> Finding:
    if stale := _stale_link(path, look):
        return stale
    if path.startswith("/") and os.path.exists(path):  # noqa: PTH110 -- False where pathlib raises
        again = "run the same command again"
        return of_interpreter(Path(path), look) or Finding(SAID, f"{path} is there by now.", "", again)
    if look and not path.startswith("/") and (look.root / path).exists():
        cause = f"There is no {path} in the folder where this was typed; it is in {look.root}."
        return Finding(SAID, cause, "", f"cd {look.root}, and type it again")
    if look and path.endswith("install/setup.bash") and not (look.root / "install").exists():
        cause = f"There is no {path}: {look.root} has no folder install."
        return Finding(SAID, cause, "", f"cd {look.root}, run colcon build there, and type it again")
    dropped = (f for f in look.findings if f.code == "path-absolute" and f.cause.startswith(repr(path)))
    if found := of_shared_file(path, look) or next(dropped, None):
        return found
    near = sorted(_alike(path, look)) if look else []
    where = f"; there is {near[0]}" if near else ""
    fix = "compare the path with what ls and pwd show"
    if near:
        fix = f"write {near[0]}, from the workspace folder"
    return Finding(SAID, f"There is no file or folder {path}{where}.", "", fix)


def _denied(path: str, *, is_run: bool) -> Finding:
    if is_run or (path.startswith("./") and Path(path).is_file()):
        fix = f"chmod +x {path}; a node is started with ros2 run"
        return Finding(SAID, f"The file {path} cannot be run: it is not marked as executable.", "", fix)
    home = next((folder for folder in (Path(path), *Path(path).parents) if folder.exists()), Path(path))
    is_roots = home.exists() and home.stat().st_uid == 0 and path.startswith(str(Path.home()))
    cause = f"You have no permission to use {path}{', because it belongs to root' if is_roots else ''}."
    fix = "use a file or folder of your own"
    if is_roots:
        fix = f'sudo chown -R "$USER" {quote(str(home))}, and never build with sudo'
    return Finding(SAID, cause, "", fix)


def _alike(path: str, look: Look) -> Iterator[str]:
    """Yield the paths in a workspace that a wrong path may mean: of a similar path, or of a similar name."""
    wanted, meant = Path(path).name, look.root
    for part in Path(shown_path(Path(path), look.root)).parts:
        inside = os.listdir(meant) if meant.is_dir() else []  # noqa: PTH208
        meant /= part if part in inside else nearest(part, inside, 0.6) or part
    is_of_its_kind = meant.is_file() if Path(path).suffix else meant.exists()
    if is_of_its_kind and meant != look.root and meant.is_relative_to(look.root):
        yield str(meant.relative_to(look.root))
        return
    for folder, names, files in os.walk(look.root):
        names[:] = sorted(n for n in names if not n.startswith(".") and n not in _NOT_LOOKED_INTO)
        close = nearest(wanted, [*names, *files], 0.8)
        found = wanted if wanted in (*names, *files) else close
        if found:
            shown = os.path.relpath(os.path.join(folder, found), look.root)  # noqa: PTH118
            if shown != path:
                yield shown


def _names(look: Look) -> Iterator[str]:
    """Yield the names of the packages, executables, launch files, nodes and topics of a workspace."""
    for package in look.packages:
        yield package.name
        yield from look.executables[package.name] or ()
    yield from (path.name for path in look.launch_paths)
    yield from node_names(look)
    yield from (end.topic for end in topic_ends(look))


def of_launch(error: ErrorText, look: Look) -> Finding | None:
    """Pass on the exception of launch, with the place in the launch file; None if there is none."""
    match = re.search(r"Caught exception in launch[^:]*: (?P<said>.+)", error.text)
    if match is None:
        return None
    if fault := _refused_here(error, look):
        return fault
    inner = [report.line for report in error.reports if "LaunchFileError" not in report.kind]
    said = re.sub(r"^\w+Error: ", "", (inner[-1] if inner else match["said"]).strip())
    choices = re.findall(r"\"(\w+)\"", said)
    close = nearest(said.split()[0], choices, 0.5)
    place = launch_line(error, look)
    fix = f"write {close} instead of {said.split()[0]}" if close else ""
    if not close and place.partition(":")[0].endswith((".xml", ".yaml", ".yml")):
        working = "compare the tag and its attributes with those of a working launch file"
        fix = _other_substitution(said) or working
    return Finding(SAID, f"launch cannot load the launch file: {said.rstrip('.')}.", place, fix)


def _refused_here(error: ErrorText, look: Look) -> Finding | None:
    """Return the fault that launch found in a file of the workspace, if the error is the same; else None."""
    # Addresses in memory are others each time.
    refused = (f for f in look.launch_files if f.refusal and f.refusal.partition(" at 0x")[0] in error.text)
    return next((fault for file in refused for fault in file.faults if fault.code == SAID), None)


# Substitutions of ROS 1 that have another name now; see http://wiki.ros.org/roslaunch/XML.
_RENAMED = {"arg": "var", "find": "find-pkg-share", "optenv": "env"}


def _other_substitution(said: str) -> str:
    """Say which substitution was meant by an unknown one; empty if the error is about something else."""
    unknown = re.search(r"Unknown substitution: ([\w-]+)", said)
    if unknown is None:
        return ""
    from launch.frontend import Parser, expose

    Parser.load_launch_extensions()
    known = sorted(expose.substitution_parse_methods)
    if near := _RENAMED.get(unknown[1]) or nearest(unknown[1], known):
        return f"write $({near} ...) instead of $({unknown[1]} ...)"
    return f"write one that launch has: {', '.join(f'$({substitution} ...)' for substitution in known)}"


def launch_line(error: ErrorText, look: Look) -> str:
    """Return the line of the launch file that an error is about; else the file, if only one is possible."""
    files = look.launches
    run = [pair for pair in files if error.command and pair[1].name == Path(error.command[2]).name]
    run = run or [pair for pair in files if any(pair[1].name in line for line in error.typed)] or files
    said = error.text.partition("Caught exception in launch")[2]
    fault = _refused_here(error, look)
    if fault and ":" in fault.place:
        return fault.place
    run = [pair for pair in files if f"/{pair[1].name}'" in said] or run
    words = [
        word
        for word in re.findall(r"'([\w./ -]+)'|: (\w+) is not|substitution: ([\w-]+)", said)
        for word in word
        if len(word) > 1
    ]
    for file, path in run:
        for number, line in enumerate(read_text(path).splitlines(), 1):
            if any(
                re.search(rf"['\"]{re.escape(word)}['\"]|\b{re.escape(word)}=|\$\({re.escape(word)} ", line)
                for word in words
            ):
                return f"{file.shown}:{number}"
    return run[0][0].shown if len(run) == 1 else ""


def of_python(report: ErrorReport, place: str, look: Look) -> Finding | None:
    """Explain an exception that Python or a library raised at a line of the student's; else None."""
    if said := _SYSTEM_SAYS.match(report.message):
        number, words = SYSTEM[said["said"]], re.findall(r"'([^']+)'", said["after"] or "")
        spot = spot_of(report, look)
        may_be_folder = any(isinstance(node, ast.keyword) and node.arg == "cwd" for node in spot.whole)
        is_start = not may_be_folder and any(Path(f.file).name == "subprocess.py" for f in report.frames[-1:])
        told = None
        if number == errno.ENOENT and words and not is_start:
            told = of_missing_file(words[0], place, look)
        elif number == errno.EEXIST and words:
            told = existing_folder(words[0], spot.text, place)
        found = None if told else _of_system(said, look, is_start=is_start)
        return told or (found and replace(found, place=place or found.place))
    told = of_error(report.kind, report.message, place, spot_of(report, look))
    return told or _argument(report, place, look)


def _argument(report: ErrorReport, place: str, look: Look) -> Finding | None:
    """Say which value a library rejects, as in `Expected 'parameters' to be a list`; else None."""
    match = re.search(
        r"Expected '(?P<name>\w+)' to be (?P<wanted>.+?), but got '?(?P<given>.+?)'? of type '<class '(?P<kind>\w+)'>'",
        report.message,
    )
    must = re.search(r"(?P<wanted>must (?:be|return) .+?), (?:but|not) (?P<given>.+)", report.message)
    if match is None and must is None:
        return None
    if match is None:
        cause = f"{report.message[:300]}."
        fix = f"it {must['wanted']}" if must else ""
        return Finding(SAID, cause, place or _in_launch(look, ""), fix)
    name = {"remap_rule": "remappings"}.get(match["name"], match["name"])
    is_list = "list" in match["wanted"] or "tuple" in match["wanted"]
    fix = f"write brackets around it: {name}=[...]" if is_list else f"give {name} {match['wanted']}"
    cause = f"{name} must be {match['wanted']}{' in a list' if name == 'remappings' else ''}, but is the {match['kind']} {match['given']}."
    return Finding(SAID, cause, place or _in_launch(look, name), fix)


def _in_launch(look: Look, keyword_name: str) -> str:
    """Return where a launch file passes this keyword argument; else the only launch file, or nothing."""
    files = look.launch_files
    for path, file in ((p, f) for p in look.packages for f in p.launch_files):
        source = read_source(file, file.stem, path.shown(str(file.relative_to(path.folder))))
        for node in source.nodes:
            if isinstance(node, ast.keyword) and node.arg == keyword_name:
                return source.at(node.value)
    return files[0].shown if len(files) == 1 else ""


def _of_report(report: ErrorReport, error: ErrorText, look: Look) -> Finding | None:
    """Return what an exception says about a line of the student's, or a warning that is printed like one."""
    place = place_of(own_frames(report.frames), look)
    # Python prints a warning after its place; an exception is at the beginning of its line.
    if report.kind.endswith("Warning") and f": {report.line}" in error.text:
        frame = report.frames[-1] if report.frames else None
        said = of_warning(f"{frame.file}:{frame.line}: {report.line}", error.text, look) if frame else None
        return said or Finding(SAID, f"Python warns: {report.message.rstrip('.')}.", place)
    return of_python(report, place, look)
