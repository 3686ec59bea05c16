"""A bare Debian has what a newcomer has, and nothing of this machine; making one can be interrupted."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bare_student import SUITE, bare_root

# With the second student, who waits for the first to have made the root and installed the project in it.
pytestmark = pytest.mark.xdist_group("student 1")

TOOL = Path(bare_root.__file__)
# As the grader's sandbox does: a process table and a network of its own.
SANDBOX = "bwrap --unshare-all --ro-bind / / --dev /dev --proc /proc --tmpfs /tmp"


def in_the_root(script: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(TOOL), *options, SUITE, "sh", "-c", script]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize(("options", "user"), [((), "student"), (("--root",), "root")])
def test_another_sandbox_works_inside(options: tuple[str, ...], user: str) -> None:
    """Whoever one is there, bubblewrap can be started again."""
    finished = in_the_root(f"{SANDBOX} ls /proc/self/cmdline && id --user --name", *options)
    assert finished.stdout == f"/proc/self/cmdline\n{user}\n", finished.stderr


def test_nothing_of_this_machine_is_inside(monkeypatch: pytest.MonkeyPatch) -> None:
    """The home is empty, no other process is seen, the system is read-only, and no tool of developers is there."""
    monkeypatch.setenv("EDITOR", "/usr/bin/of-this-machine")
    script = "env; ls -A ~; cat /proc/[0-9]*/comm; for tool in gcc pytest ruff ros2; do which $tool; done; touch /x"
    finished = in_the_root(script)
    assert "of-this-machine" not in finished.stdout
    assert str(Path.home()) not in finished.stdout
    assert "Read-only file system" in finished.stderr
    rest = [line for line in finished.stdout.splitlines() if "=" not in line]
    assert sorted(set(rest)) == ["bwrap", "sh"]


def test_an_interrupted_root_is_not_taken_for_whole(tmp_path: Path) -> None:
    """Ctrl-C while it is made leaves nothing that a second run would use."""
    environ = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    making = subprocess.Popen(
        [sys.executable, str(TOOL), SUITE],
        env=environ,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert making.stderr is not None
    assert making.stderr.readline().startswith("Making a bare Debian")
    os.killpg(making.pid, signal.SIGINT)
    making.communicate(timeout=120)
    assert making.returncode == 130
    assert not [path for path in (tmp_path / "ros2lab" / "roots").iterdir() if path.is_dir()]


def test_what_is_missing_is_said_in_one_sentence(tmp_path: Path) -> None:
    """Without mmdebstrap there is no root, and the sentence says what to type."""
    for name in ("bwrap", "tar"):
        (tmp_path / name).symlink_to(str(shutil.which(name)))
    finished = subprocess.run(
        [sys.executable, str(TOOL), SUITE],
        env={**os.environ, "PATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 1
    assert finished.stderr == (
        "A bare Debian needs mmdebstrap: type `sudo apt install mmdebstrap` and run this again.\n"
    )
