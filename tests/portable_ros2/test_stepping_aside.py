"""A real `ros2` and a real `launch` come first, wherever they are, and never ours in their place."""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from deadlines import DEADLINE
from portable_ros2 import stepping_aside

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))
SYSTEM = "/usr/bin:/bin"

# As an installed Jazzy has it: a small script that names its own package.
REAL = f"""#!{sys.executable}
# EASY-INSTALL-ENTRY-SCRIPT: 'ros2cli','console_scripts','ros2'
import os, sys
print("real", sys.argv[1:], os.environ.get("LD_LIBRARY_PATH", ""))
sys.exit(5)
"""


def program(folder: Path, text: str = REAL, *, mode: int = 0o755) -> Path:
    """Put a program named `ros2` into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "ros2"
    path.write_text(text)
    path.chmod(mode)
    return path


def ros2(*words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run ours."""
    return subprocess.run(
        [COMMAND, *words],
        env={**os.environ, **variables},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )


def is_ours(done: subprocess.CompletedProcess[str]) -> bool:
    """Return whether `ros2 --version` was answered by ours."""
    return done.returncode == 0 and done.stdout.startswith("portable_ros2 ") and done.stderr == ""


class TestCommand:
    """Which `ros2` answers."""

    @pytest.mark.parametrize("first", [True, False])
    def test_a_real_one_answers(self, tmp_path: Path, first: bool) -> None:
        """On PATH before ours or after it, with the same words and its own exit code."""
        real = program(tmp_path / "jazzy")
        own = str(Path(COMMAND).parent)
        path = os.pathsep.join([str(real.parent), own] if first else [own, str(real.parent)])
        done = ros2("topic", "echo", "--once", "a b", PATH=f"{path}:{SYSTEM}")
        assert (done.returncode, done.stderr) == (5, "")
        assert done.stdout.startswith("real ['topic', 'echo', '--once', 'a b']")

    def test_completion_asks_the_real_one(self, tmp_path: Path) -> None:
        """Its verbs are offered, not ours."""
        path = f"{program(tmp_path).parent}:{SYSTEM}"
        assert ros2(_ARGCOMPLETE="1", COMP_LINE="ros2 ", PATH=path).stdout.startswith("real []")

    @pytest.mark.parametrize("path", ["", SYSTEM, "/no/such/folder", f"{Path(COMMAND).parent}", ":"])
    def test_ours_answers_where_there_is_none(
        self, path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Also when it is not on PATH itself."""
        monkeypatch.chdir(tmp_path)
        assert is_ours(ros2("--version", PATH=path))

    def test_what_is_no_program_does_not_count(self, tmp_path: Path) -> None:
        """A file that cannot be run, a folder, a link that leads nowhere."""
        program(tmp_path / "a", mode=0o644)
        (tmp_path / "b" / "ros2").mkdir(parents=True)
        (tmp_path / "c").mkdir()
        (tmp_path / "c" / "ros2").symlink_to("gone")
        path = os.pathsep.join(str(tmp_path / name) for name in "abc")
        assert is_ours(ros2("--version", PATH=f"{path}:{SYSTEM}"))

    def test_another_copy_of_ours_does_not_count(self, tmp_path: Path) -> None:
        """A link to it, and the one of another environment: else both would step aside for ever."""
        (tmp_path / "link").mkdir()
        (tmp_path / "link" / "ros2").symlink_to(COMMAND)
        program(tmp_path / "other", Path(COMMAND).read_text())
        path = f"{tmp_path / 'link'}:{tmp_path / 'other'}"
        assert is_ours(ros2("--version", PATH=f"{path}:{SYSTEM}"))
        linked = subprocess.run(
            ["ros2", "--version"],
            env={**os.environ, "PATH": f"{path}:{SYSTEM}"},
            capture_output=True,
            text=True,
            timeout=DEADLINE,
            check=False,
        )
        assert is_ours(linked)
        real = program(tmp_path / "real")
        assert ros2("--version", PATH=f"{path}:{real.parent}:{SYSTEM}").returncode == 5

    @pytest.mark.parametrize("how", ["exec ", ""])
    def test_a_wrapper_around_ours_ends(self, tmp_path: Path, how: str) -> None:
        """A user's own script that calls ours looks like a real one, but must not go round for ever."""
        path = program(tmp_path, f'#!/bin/sh\n{how}"$ROS2" "$@"\n')
        assert is_ours(ros2("--version", PATH=f"{path.parent}:{SYSTEM}", ROS2=COMMAND))

    def test_a_program_that_a_real_one_starts_still_finds_it(self, tmp_path: Path) -> None:
        """Stepping aside once does not forbid it below."""
        once = program(
            tmp_path,
            '#!/bin/sh\nif [ -z "$INNER" ]; then INNER=1 "$ROS2" inner; else echo "real $*"; fi\n',
        )
        assert ros2("outer", PATH=f"{once.parent}:{SYSTEM}", ROS2=COMMAND).stdout == "real inner\n"

    def test_the_real_one_does_not_get_our_libraries(self, tmp_path: Path) -> None:
        """What the pip wheels have put into the environment is for ours alone; what the user has put there stays."""
        path = f"{program(tmp_path, REAL.replace(sys.executable, '/usr/bin/env -S python3 -S')).parent}"
        show = program(tmp_path, '#!/bin/sh\necho "$LD_LIBRARY_PATH|$_ROS_WHEELS_BOOTSTRAP_COMPLETE"\n')
        assert show.parent == Path(path)
        variables = {"PATH": f"{path}:{SYSTEM}", "_ROS_WHEELS_BOOTSTRAP_COMPLETE": ""}
        assert ros2(**variables, LD_LIBRARY_PATH="").stdout == "|\n"
        assert ros2(**variables, LD_LIBRARY_PATH="/opt/mine").stdout == "/opt/mine|\n"


class TestEnvironment:
    """What is handed to the real one."""

    def test_only_folders_of_ours_are_taken_out(self) -> None:
        """In whatever order they are; nothing else changes."""
        wheels = f"{sys.prefix}/lib"
        environ = {
            "LD_LIBRARY_PATH": f"/a:{wheels}:/b:{wheels}/python3/site-packages/ros_rcl.libs:",
            "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
            "HOME": "/home/me",
        }
        made = stepping_aside.environment_of_real(environ)
        assert {name: made[name] for name in made if not name.startswith("_")} == {
            "LD_LIBRARY_PATH": "/a:/b",
            "HOME": "/home/me",
        }
        assert "_ROS_WHEELS_BOOTSTRAP_COMPLETE" not in made
        assert "LD_LIBRARY_PATH" not in stepping_aside.environment_of_real({"LD_LIBRARY_PATH": wheels})

    def test_a_strange_count_is_none(self, tmp_path: Path) -> None:
        """Whatever someone has set the variable to."""
        real = program(tmp_path)
        for value in ("", "x", "-1", "0"):
            environ = {"PATH": str(tmp_path), "_PORTABLE_ROS2_STEPS_ASIDE": value}
            assert stepping_aside.real_command(environ) == real
        assert stepping_aside.real_command({}) is None

    def test_a_program_that_cannot_be_read_may_be_real(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Running needs another permission than reading."""
        real = program(tmp_path)

        def refuse(_: Path) -> bytes:
            raise PermissionError

        monkeypatch.setattr(Path, "read_bytes", refuse)
        assert stepping_aside.real_command({"PATH": str(tmp_path)}) == real


class TestLaunch:
    """Which `launch` is imported."""

    CODE = (
        "import sys, launch; from portable_ros2.stepping_aside import has_real_launch as real;"
        "print(launch.__file__, real('launch'), real('launch_ros'), real('no_such_module'))"
    )

    def asked(self, folder: Path, **variables: str) -> list[str]:
        """Return where `launch` came from, and whether launch, launch_ros and a module that is not there are real."""
        done = subprocess.run(
            [sys.executable, "-c", self.CODE],
            cwd=folder,
            env={**os.environ, **variables},
            capture_output=True,
            text=True,
            timeout=DEADLINE,
            check=True,
        )
        return done.stdout.split()

    def test_a_real_one_is_imported(self, tmp_path: Path) -> None:
        """An installed Jazzy is on PYTHONPATH."""
        for name in ("launch", "launch_ros"):
            (tmp_path / "jazzy" / name).mkdir(parents=True)
            (tmp_path / "jazzy" / name / "__init__.py").touch()
        file, *real = self.asked(tmp_path, PYTHONPATH=str(tmp_path / "jazzy"))
        assert file == str(tmp_path / "jazzy" / "launch" / "__init__.py")
        assert real == ["True", "True", "False"]

    def test_ours_is_imported_where_there_is_none(self, tmp_path: Path) -> None:
        """Also in the folder of a package, where `launch` holds launch files and is no module."""
        (tmp_path / "launch").mkdir()
        (tmp_path / "launch" / "robot.launch.py").touch()
        file, *real = self.asked(tmp_path)
        assert Path(file).parent.parent == Path(stepping_aside.__file__).parent.parent
        assert real == ["False", "False", "False"]
