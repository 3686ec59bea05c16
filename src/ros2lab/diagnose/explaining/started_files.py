"""Files that are there and yet cannot be started, or of which a shell could not run a line."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.finding import Finding, in_a_row, shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import prefix_of
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.transcript import Step, unsettled, words_in
from ros2lab.diagnose.sources.file_texts import bytes_of
from ros2lab.diagnose.sources.package import SourcePackage

_SHELL = re.compile(r"(?:\S*/)?(?P<name>bash|zsh|dash|sh)$")
_COMPLAINT = re.compile(r"^(?P<file>[^\s:]+): (?:line )?(?P<line>\d+): (?P<said>.+)")
_GONE = re.compile(r"[Nn]o such file|not found")
_ENV = re.compile(r"(?:\S*/)?env(?: -S)? +(\S+)")


@dataclass(frozen=True)
class Started:
    """A file that a command starts.

    Attributes:
        path: the file that the system is asked to run.
        source: the file to change, of which it may be a copy.
        package: whose it is; None for a file that is not installed.
        shell: the shell that reads it; empty if the system starts it by itself.
    """

    path: Path
    source: Path
    package: SourcePackage | None = None
    shell: str = ""

    @property
    def first(self) -> bytes:
        """Its first line, with its end."""
        return bytes_of(self.path)[:200].partition(b"\n")[0] + b"\n"

    def again(self, change: str) -> str:
        """Return a change of the source, and the build that takes it over."""
        build = f"colcon build --packages-select {self.package.name}" if self.package else ""
        return ", then ".join(filter(None, ("" if self.is_made else change, build)))

    @property
    def is_made(self) -> bool:
        """Whether a build has made it, and not only copied."""
        return self.package is not None and self.source == self.path


def of_started_file(error: ErrorText, look: Look) -> Finding | None:
    """Say why a file that a command was to start did not run as it should; None if nothing is wrong with it."""
    if not look or any(frame.file.endswith(".py") for frame in own_frames(error.frames)):
        return None  # it was started
    for step in reversed(unsettled(error.steps)):
        for started in _started(step, look) if step.lines else ():
            if found := _unusable(started, look, step.text) or _misread(started, step, look):
                return found
    return None


def of_line_ends(look: Look) -> Finding | None:
    """Return the finding of a script whose first line ends as on Windows, an installed one first; None without any."""
    scripts = [script for package in look.packages for script in _installed(package, look)]
    files = [path for path in sorted(look.root.iterdir()) if path.is_file()]
    files += [path for package in look.packages for path in package.own_files()]
    for script in (*scripts, *(Started(path, path) for path in files)):
        if script.first.startswith(b"#!") and script.first.endswith(b"\r\n"):
            return _unusable_line(script, look)
    return None


def of_interpreter(path: Path, look: Look) -> Finding | None:
    """Return the finding of a file whose first line names a program that is not there; None if it does not."""
    started = Started(path, path)
    return _unusable_line(started, look) if path.is_file() and started.first.startswith(b"#!") else None


def _started(step: Step, look: Look) -> Iterator[Started]:
    """Yield the files that a command starts: scripts that it names, and those of the packages that are named."""
    words = words_in(step.command)
    shell = _SHELL.match(words[0]) if words else None
    plain = [word for word in words[shell is not None :] if not word.startswith("-")][:1]
    for word in plain if words[:1] != ["ros2"] else ():
        path = look.root / word
        if path.is_file() and (shell or "/" in word):
            yield Started(path, path, shell=shell["name"] if shell else "")
    named = {*re.findall(r"[\w.-]+", f"{step.command}\n{step.text}")}
    for package in look.packages:
        if package.name in named:
            scripts = (script for script in _installed(package, look) if script.path.name in named)
            yield from (script for script in scripts if not script.is_made or _GONE.search(step.text))


def _installed(package: SourcePackage, look: Look) -> Iterator[Started]:
    """Yield the files in the folder of a package's executables, copies of its own and those that a build makes."""
    prefix = prefix_of(look.root, package.name)
    folder = prefix / "lib" / package.name if prefix else None
    for path in sorted(folder.iterdir()) if folder and folder.is_dir() else ():
        if path.is_file():
            places = package.places_of(path.name)
            yield Started(path, package.folder / places[0] if places else path, package)


def _unusable(started: Started, look: Look, said: str) -> Finding | None:
    """Say what keeps the system from starting a file that is there; None if nothing does, or a shell reads it."""
    if started.shell:
        return None
    shown, source = (shown_path(path, look.root) for path in (started.path, started.source))
    if not os.access(started.path, os.X_OK):
        cause = f"{shown} is there, but has no permission to be executed."
        change = "" if os.access(started.source, os.X_OK) else f"chmod +x {quote(source)}"
        return Finding("executable-unusable", cause, source, started.again(change))
    return _unusable_line(started, look, said)


def _unusable_line(started: Started, look: Look, said: str = "") -> Finding | None:
    """Say why the system cannot start a file as its first line is; None if it can."""
    first, source = started.first, shown_path(started.source, look.root)
    if first.startswith(b"#!") and first.endswith(b"\r\n"):
        files = _of_windows(started, look)
        have = f"{in_a_row(files)} {'has' if len(files) == 1 else 'have'}"
        cause = f"{have} Windows line endings, so the system looks for a program called {_program(first)} with a carriage return at its end."
        change = rf"sed -i 's/\r$//' {' '.join(map(quote, files))}"
    elif told := _of_program(started, source, said):
        cause, change = told
    else:
        return None
    return Finding("executable-unusable", cause, f"{source}:1", started.again(change))


def _of_program(started: Started, source: str, said: str) -> tuple[str, str] | None:
    """Return cause and change of a first line that names no program, or none that is there; None if it is right."""
    first, new = started.first, "#!/usr/bin/env python3"
    program = _program(first)
    is_python = started.path.suffix == ".py" or "python" in program
    if not first.startswith(b"#!"):  # a shell runs it as a script of its own, unless it is in Python
        cause = f"The first line of {source} is no shebang that says that Python should run it, so the system cannot start it."
        return (cause, f"write {new} above line 1") if is_python else None
    is_said = re.search(rf"{re.escape(program)}\W*: No such file", said) is not None
    if not program or (shutil.which(program) and not is_said):
        return None
    cause = f"The first line of {source} has it run by {program}, which is not on this computer."
    return cause, f"write {new} as line 1" if is_python else f"correct {program} in line 1, or install it"


def _program(first: bytes) -> str:
    """Return the program that the first line of a script asks for; empty if it asks for none."""
    line = first.decode(errors="replace").strip().removeprefix("#!").strip()
    asked = _ENV.match(line)
    return asked[1] if asked else line.split(" ")[0]


def _of_windows(started: Started, look: Look) -> list[str]:
    """Return the file, and those beside it that are installed with it, that have Windows line endings."""
    scripts = _installed(started.package, look) if started.package else ()
    names = [script.source for script in scripts if not script.is_made]
    files = [path for path in dict.fromkeys((started.source, *names)) if b"\r\n" in bytes_of(path)]
    return [shown_path(path, look.root) for path in files or [started.source]]


def _misread(started: Started, step: Step, look: Look) -> Finding | None:
    """Say why a shell could not run a line of a script; None if it ran all, or if that is not known."""
    asked = _SHELL.match(_program(started.first)) if started.first.startswith(b"#!") else None
    shell = started.shell or (asked["name"] if asked else "")
    text = bytes_of(started.source).decode(errors="replace")
    shown = shown_path(started.source, look.root)
    lines = text.splitlines()
    for line in step.lines if shell else ():
        complaint = _COMPLAINT.match(line)
        if complaint is None or not (
            Path(complaint["file"]).name == started.path.name or complaint["file"] in text
        ):
            continue
        number, said = int(complaint["line"]), complaint["said"]
        place = f"{shown}:{number}" if Path(complaint["file"]).name == started.path.name else shown
        if b"\r\n" in bytes_of(started.source):
            cause = f"{shown} has Windows line endings, and {shell} reads the carriage return as part of each command."
            fix = rf"sed -i 's/\r$//' {quote(shown)}, then type `{step.command}` again"
            return Finding("script-fails", cause, place, fix)
        if shell in ("sh", "dash") and (why := _lacks(said, started.source)):
            cause = (
                f"{shown} is run with {shell}, {why}, so what is below that line does not find what it needs."
            )
            fix = "write #!/bin/bash as its first line"
            if started.shell:
                fix = f"type `{re.sub(rf'^(?:[^ ]*/)?{shell}(?= )', 'bash', step.command)}`"
            return Finding("script-fails", cause, place, fix)
        there = look.root / "install" / "setup.bash"
        sources = re.match(r"\s*(?:source|\.)\s+(?P<file>\S+)", lines[number - 1 : number][0]) if number <= len(lines) else None  # fmt: skip
        if sources and said.endswith("No such file or directory") and there.is_file():
            cause = f"Line {number} of {shown} sources {sources['file']}, which is not there, so the workspace is not sourced."
            return Finding("script-fails", cause, place, f"write `source {quote(str(there))}` there")
    return None


def _lacks(said: str, script: Path) -> str:
    """Say what a complaining shell does not know that bash does, as the rest of a sentence; empty if bash knows no more."""
    bash = shutil.which("bash")
    if bash is None:
        return ""
    missing = re.match(r"(?P<word>\S+): (?:command )?not found|\S*?: (?P<late>\S+): not found", said)
    word = missing["word"] or missing["late"] if missing else ""
    asked = (
        ["-c", 'type -t -- "$1"', "bash", word] if word else ["-n", str(script)]
    )  # which only reads the script
    done = subprocess.run(
        [bash, "--norc", *asked], capture_output=True, text=True, timeout=5, check=False, env={}
    )
    if word:
        return f"which has no command `{word}`" if done.stdout.strip() in ("builtin", "keyword") else ""
    is_known = "yntax error" in said or "ubstitution" in said
    return "which does not know bash's syntax" if is_known and done.returncode == 0 else ""
