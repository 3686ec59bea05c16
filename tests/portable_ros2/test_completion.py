"""Completion: what is offered, by argcomplete's protocol and in real shells."""

from __future__ import annotations

import argparse
import os
import subprocess
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path

import pexpect
import pytest

import portable_ros2.completion
from deadlines import DEADLINE
from portable_ros2.commands.launch import _complete_arguments

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))
SCRIPTS = Path(portable_ros2.completion.__file__).parent

Offered = Callable[..., list[str]]


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a sourced workspace with the package `arm_words`, its executables `wave` and `wink`, and a launch file."""
    prefix = tmp_path / "install"
    index = prefix / "share" / "ament_index" / "resource_index" / "packages"
    executables = prefix / "lib" / "arm_words"
    launch = prefix / "share" / "arm_words" / "launch"
    for folder in (index, executables, launch):
        folder.mkdir(parents=True)
    (index / "arm_words").touch()
    (launch / "robot.launch.py").touch()
    for name in ("wave", "wink"):
        (executables / name).write_text("#!/bin/sh\n")
        (executables / name).chmod(0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    return tmp_path


@pytest.fixture
def offered(tmp_path: Path) -> Offered:
    """Return a function that asks what is offered at the end of a line, or at a place in it."""

    def ask(line: str, point: int | None = None) -> list[str]:
        answer = tmp_path / "answer"
        done = subprocess.run(
            [COMMAND],
            env={
                **os.environ,
                "_ARGCOMPLETE": "1",
                "_ARGCOMPLETE_IFS": "\n",
                "_ARGCOMPLETE_SUPPRESS_SPACE": "1",
                "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
                "COMP_LINE": line,
                "COMP_POINT": str(len(line.encode()) if point is None else point),
            },
            capture_output=True,
            text=True,
            timeout=DEADLINE,
            check=True,
        )
        assert (done.stdout, done.stderr) == ("", "")
        return answer.read_text().split("\n") if answer.stat().st_size else []

    return ask


class TestOffered:
    """What `ros2` itself offers."""

    def test_commands(self, offered: Offered) -> None:
        """All of them, or those that begin so."""
        assert {"pkg", "run", "topic", "node"} <= set(offered("ros2 "))
        assert offered("ros2 pk") == ["pkg"]
        assert offered("ros2 pkg") == ["pkg"]
        assert offered("ros2 nope") == []

    def test_verbs(self, offered: Offered) -> None:
        """Of the command that is there."""
        assert set(offered("ros2 pkg ")) == {"create", "executables", "list", "prefix", "xml"}
        assert offered("ros2 pkg cr") == ["create"]

    def test_options(self, offered: Offered) -> None:
        """Those of the verb, except help."""
        options = offered("ros2 pkg create --")
        assert {"--build-type", "--node-name", "--license", "--dependencies"} <= set(options)
        assert "--help" not in options
        assert offered("ros2 pkg create --node") == ["--node-name"]
        assert "--use-python-default-buffering" in offered("ros2 --")

    def test_choices_of_an_option(self, offered: Offered) -> None:
        """Also after others."""
        assert set(offered("ros2 pkg create --node-name a --build-type ")) == {
            "cmake",
            "ament_cmake",
            "ament_python",
        }
        assert offered("ros2 pkg create --build-type ament_p") == ["ament_python"]

    @pytest.mark.parametrize(
        "line", ["run", "pkg prefix", "pkg xml", "pkg executables", "pkg xml -t name", "run --prefix x"]
    )
    def test_packages(self, offered: Offered, workspace: Path, line: str) -> None:
        """Those of the workspace and those below it."""
        assert offered(f"ros2 {line} arm_w") == ["arm_words"]
        assert {"rclpy", "std_msgs", "arm_words"} <= set(offered(f"ros2 {line} "))

    @pytest.mark.parametrize("code", ["\x1b[31m", "\x9b31m", "\u202e", "\x7f"], ids=ascii)
    def test_no_name_that_is_a_code_for_a_terminal(
        self, offered: Offered, workspace: Path, code: str
    ) -> None:
        """A shell shows what is offered as it is."""
        strange = workspace / f"install/lib/arm_words/wa{code}ve"
        strange.write_text("#!/bin/sh\n")
        strange.chmod(0o755)
        assert set(offered("ros2 run arm_words ")) >= {"wave", "wink"}
        assert not [word for word in offered("ros2 run arm_words ") if "wa" in word and word != "wave"]

    def test_executables(self, offered: Offered, workspace: Path) -> None:
        """Those of the package before it."""
        assert set(offered("ros2 run arm_words ")) >= {"wave", "wink"}
        assert offered("ros2 run arm_words wi") == ["wink"]
        assert "wave" not in offered("ros2 run rclpy ")
        assert "wave" not in offered("ros2 run nope ")

    def test_a_place_inside_the_line(self, offered: Offered, workspace: Path) -> None:
        """What is after the cursor does not count."""
        line = "ros2 run arm wave"
        assert offered(line, len("ros2 run arm")) == ["arm_words"]

    def test_an_unsourced_workspace(
        self, offered: Offered, workspace: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Its packages are not offered, as they cannot be run."""
        monkeypatch.delenv("AMENT_PREFIX_PATH")
        assert offered("ros2 run arm_w") == []

    @pytest.mark.parametrize(
        "line", ["ros2 'run", 'ros2 run "arm_w', "ros2 run arm_words \\", "ros2 ééé", "ros2  ", ""]
    )
    def test_a_strange_line_is_no_error(self, offered: Offered, workspace: Path, line: str) -> None:
        """Quotation marks that are still open, letters of two bytes, two blanks."""
        offered(line)

    def test_nothing_slow_is_loaded(
        self, offered: Offered, workspace: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Neither ROS nor templates, for a package or an executable."""
        for name in ("rclpy", "jinja2", "yaml", "catkin_pkg", "numpy"):
            (workspace / "broken").mkdir(exist_ok=True)
            (workspace / "broken" / f"{name}.py").write_text("import os\nos._exit(9)\n")
        monkeypatch.setenv("PYTHONPATH", str(workspace / "broken"))
        assert offered("ros2 run arm_w") == ["arm_words"]
        assert "wave" in offered("ros2 run arm_words wa")
        assert "list" in offered("ros2 topic l")


@pytest.fixture
def bash(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[pexpect.spawn]:
    """Return an interactive bash that has `ros2` on its path."""
    monkeypatch.setenv("PATH", f"{Path(COMMAND).parent}:{os.environ['PATH']}")
    monkeypatch.setenv("TERM", "dumb")
    with pexpect.spawn(
        "bash", ["--norc", "--noprofile", "-i"], cwd=str(workspace), encoding="utf-8", timeout=DEADLINE
    ) as shell:
        # Markers that the echo of the line does not hold.
        shell.sendline("bind 'set enable-bracketed-paste off'; PS1='>''> '; unset HISTFILE")
        shell.expect_exact("\n>> ")
        yield shell


class TestBash:
    """A TAB in a real, interactive bash."""

    @pytest.fixture(params=["script", "argcomplete"])
    def shell(self, bash: pexpect.spawn, request: pytest.FixtureRequest) -> pexpect.spawn:
        """Return a bash that has sourced our script, or what argcomplete's own command says."""
        lines = {
            "script": f"source '{SCRIPTS / 'ros2.bash'}'",
            "argcomplete": 'eval "$(register-python-argcomplete ros2)"',
        }
        bash.sendline(lines[request.param])
        bash.expect_exact("\n>> ")
        return bash

    @pytest.mark.parametrize(
        ("typed", "completed"),
        [
            ("ros2 pk\t", "ros2 pkg "),
            ("ros2 pkg cre\t", "ros2 pkg create "),
            ("ros2 run arm_w\twi\t", "ros2 run arm_words wink "),
            (
                "ros2 pkg create --build-type ament_p\t--no\t",
                "ros2 pkg create --build-type ament_python --node-name ",
            ),
        ],
    )
    def test_a_word_is_completed(self, shell: pexpect.spawn, typed: str, completed: str) -> None:
        """With a blank after it, so that the next word can be typed; the first TAB works as well as the second."""
        shell.send(typed)
        shell.expect_exact(completed)

    def test_several_are_listed(self, shell: pexpect.spawn) -> None:
        """By two TABs."""
        shell.send("ros2 run arm_words w\t\t")
        shell.expect("wave +wink")

    def test_files_are_completed_where_nothing_else_is_known(
        self, shell: pexpect.spawn, workspace: Path
    ) -> None:
        """Such as a parameter file for the executable."""
        (workspace / "robot_parameters.yaml").touch()
        shell.send("ros2 run arm_words wave --ros-args --params-file rob\t")
        shell.expect_exact("robot_parameters.yaml ")


def test_bash_without_argcomplete_says_nothing(bash: pexpect.spawn) -> None:
    """A TAB then completes files, as for any other command."""
    bash.sendline(f"source '{SCRIPTS / 'ros2.bash'}'; PATH=/nowhere")
    bash.expect_exact("\n>> ")
    bash.send("ros2 inst\t")
    bash.expect_exact("install/")


@pytest.mark.parametrize(
    "words",
    [
        [("ros2 pk", "pkg "), ("cre", "create "), ("--node", "--node-name ")],
        [("ros2 run arm_w", "arm_words "), ("wi", "wink ")],
    ],
)
def test_zsh_completes(
    workspace: Path, monkeypatch: pytest.MonkeyPatch, words: list[tuple[str, str]]
) -> None:
    """A TAB in a real, interactive zsh that has sourced our script."""
    monkeypatch.setenv("PATH", f"{Path(COMMAND).parent}:{os.environ['PATH']}")
    monkeypatch.setenv("ZDOTDIR", str(workspace))
    monkeypatch.setenv("TERM", "dumb")
    (workspace / ".zshrc").write_text(f"PS1='>''> '\nsource '{SCRIPTS / 'ros2.zsh'}'\n")
    with pexpect.spawn("zsh", ["-i"], cwd=str(workspace), encoding="utf-8", timeout=DEADLINE) as shell:
        shell.expect_exact(">> ")
        for typed, completed in words:
            shell.send(f"{typed}\t")
            shell.expect_exact(completed)


LAUNCH_FILES = {
    "a.launch.py": (
        "open('ran', 'w')\nfrom launch.actions import DeclareLaunchArgument as D\nimport launch\n"
        "x = launch.actions.DeclareLaunchArgument('speed')\ny = launch.actions.DeclareLaunchArgument(name='turn')\n"
    ),
    "a.launch.xml": (
        "<launch><arg name='speed' default='$(eval 1)'/><arg name='turn'/>"
        "<include file='a.launch.py'><arg name='other' value='1'/></include></launch>"
    ),
    "a.launch.yaml": "launch:\n- arg: {name: speed}\n- arg: {name: turn}\n- include: {file: a.launch.py}\n",
    "b.launch.py": "(((",
    "b.launch.yaml": "launch: 5\n",
}


@pytest.mark.parametrize("name", LAUNCH_FILES)
def test_the_arguments_of_a_launch_file_are_offered_and_nothing_of_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    for file, text in LAUNCH_FILES.items():
        Path(file).write_text(text)
    asked = argparse.Namespace(package_name=name, launch_file_name=None, launch_arguments=[])
    assert _complete_arguments(asked) == (["speed:=", "turn:="] if name.startswith("a.") else [])
    assert not Path("ran").exists()
