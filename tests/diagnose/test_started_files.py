"""Scripts that are there and do not run: their mode, their first line, their line ends, and the shell that reads them."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding

NAME = NAMES[1]
INSTALLED, SOURCE = (
    f"install/{NAME.package}/lib/{NAME.package}/tool.py",
    f"src/{NAME.package}/scripts/tool.py",
)
INDEX = f"install/{NAME.package}/share/ament_index/resource_index/packages/{NAME.package}"
FIRST = "#!/usr/bin/env python3\n"
RUN = f"$ ros2 run {NAME.package} tool.py\n"
BUILD = f"colcon build --packages-select {NAME.package}"


def explained(root: Path, first: str, mode: int, said: str, *, ends: str = "\n") -> Finding:
    """Return what is told of a script of a package that was installed as it is."""
    files = Files.right(NAME)
    files.texts |= {INDEX: "", "install/setup.bash": ""}
    files.write(root)
    for path in (root / INSTALLED, root / SOURCE):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(f"{first}print('on')\n".replace("\n", ends).encode())
        path.chmod(mode)
    return of_text(said, root)[0]


@pytest.mark.parametrize(
    ("script", "said", "fix"),
    [
        ((FIRST, 0o644, "\n"), RUN + "No executable found\n", f"chmod +x {SOURCE}, then {BUILD}"),
        ((FIRST, 0o755, "\r\n"), RUN + "/usr/bin/env: \u2018python3\\r\u2019: No such file or directory\n", rf"sed -i 's/\r$//' {SOURCE}, then {BUILD}"),
        (("#!/no/python3\n", 0o755, "\n"), RUN + "/no/python3: bad interpreter: No such file or directory\n", f"write #!/usr/bin/env python3 as line 1, then {BUILD}"),
        (("", 0o755, "\n"), RUN + "OSError: [Errno 8] Exec format error: 'tool.py'\n", f"write #!/usr/bin/env python3 above line 1, then {BUILD}"),
        ((FIRST, 0o755, "\r\n"), "/usr/bin/env: \u2018python3\\r\u2019: No such file or directory\n", rf"sed -i 's/\r$//' {SOURCE}, then {BUILD}"),
    ],
)  # fmt: skip
def test_what_keeps_a_file_that_is_there_from_starting_is_told(
    tmp_path: Path, script: tuple[str, int, str], said: str, fix: str
) -> None:
    first, mode, ends = script
    found = explained(tmp_path, first, mode, said, ends=ends)
    assert (found.code, found.place.partition(":")[0], found.fix) == ("executable-unusable", SOURCE, fix)


@pytest.mark.parametrize(
    "said", ["No executable found\n", "Traceback (most recent call last):\nValueError: 3\n"]
)
def test_a_file_that_can_be_started_is_not_blamed(tmp_path: Path, said: str) -> None:
    assert explained(tmp_path, FIRST, 0o755, RUN + said).code != "executable-unusable"


def of_script(root: Path, text: str, command: str) -> Finding:
    """Return what is told of a start script that ran as it runs here, and of the package that was not found then."""
    files = Files.right(NAME)
    files.texts |= {INDEX: "", "install/setup.bash": "export READY=1\n", "start.sh": text}
    files.write(root)
    (root / "start.sh").chmod(0o755)
    done = subprocess.run(command.split(), cwd=root, capture_output=True, text=True, check=False)
    said = f"$ {command}\n{done.stderr}Package '{NAME.package}' not found\n"
    return of_text(said, root)[0]


SOURCES = "source install/setup.bash\n"


@pytest.mark.parametrize(
    ("text", "command", "fix"),
    [
        (SOURCES, "sh start.sh", "type `bash start.sh`"),
        (f"#!/bin/sh\n{SOURCES}", "./start.sh", "write #!/bin/bash as its first line"),
        ("#!/bin/bash\nsource instal/setup.bash\n", "./start.sh", "write `source "),
        (f"cd src\r\n{SOURCES}", "bash start.sh", r"sed -i 's/\r$//' start.sh"),
    ],
)
def test_the_line_that_a_shell_could_not_run_comes_before_what_follows_from_it(
    tmp_path: Path, text: str, command: str, fix: str
) -> None:
    if Path("/bin/sh").resolve().name == "bash":
        pytest.skip("sh is bash here")
    found = of_script(tmp_path, text, command)
    assert found.code == "script-fails"
    assert found.place.startswith("start.sh")
    assert found.fix.startswith(fix)


def test_a_script_that_ran_is_not_blamed(tmp_path: Path) -> None:
    assert of_script(tmp_path, f"#!/bin/bash\n{SOURCES}", "./start.sh").code != "script-fails"


MADE = f"install/{NAME.package}/lib/{NAME.package}/{NAME.module}"


@pytest.mark.parametrize(
    ("first", "is_told"),
    [("#!/no/bin/python3.10\n", True), ("#!/no/env/bin/python\n", True), ("#!/bin/sh\n", False)],
)
@pytest.mark.parametrize(
    "said",
    [
        "'{0}' cannot be started: No such file or directory: '{0}'",
        "[ERROR] [x-1]: exception occurred while executing process: [Errno 2] No such file or directory: '{0}'",
        "bash: {0}: cannot execute: required file not found",
    ],
)
def test_a_program_that_a_build_made_is_built_again_where_what_runs_it_is_gone(
    tmp_path: Path, first: str, said: str, *, is_told: bool
) -> None:
    files = Files.right(NAME)
    files.texts |= {INDEX: "", "install/setup.bash": "", MADE: first}
    files.write(tmp_path)
    (tmp_path / MADE).chmod(0o755)
    found = of_text(f"$ ros2 run {NAME.package} {NAME.module}\n{said.format(tmp_path / MADE)}\n", tmp_path)[0]
    told = ("executable-unusable", f"{MADE}:1", BUILD)
    assert ((found.code, found.place, found.fix) == told) is is_told
    assert "There is no" not in found.cause


@pytest.mark.parametrize(
    ("text", "fix"), [("#!/no/zsh\n", "correct /no/zsh in line 1"), ("1,2\n", "run the same command again")]
)
def test_a_file_that_is_there_is_not_said_to_be_missing(tmp_path: Path, text: str, fix: str) -> None:
    path = Files.right(NAME).write(tmp_path / "ws").with_name("given")
    path.write_text(text)
    path.chmod(0o755)
    for root in (tmp_path / "ws", None):
        found = of_text(f"FileNotFoundError: [Errno 2] No such file or directory: '{path}'", root)[0]
        assert found.fix.startswith(fix)
