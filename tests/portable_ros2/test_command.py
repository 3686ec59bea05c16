"""The dispatch of the `ros2` command: help, what it does not know, versions, and outputs that go nowhere."""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import re
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

from deadlines import DEADLINE
from portable_ros2 import __version__, command
from portable_ros2.verb import Verb, summary

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]

VERBS = {"pkg": ["create", "executables", "list", "prefix", "xml"]}


@pytest.mark.parametrize("words", [[], ["-h"], ["--help"]])
def test_help_names_each_command_with_its_first_line(ros2: Ros2, words: list[str]) -> None:
    """No command at all shows the help too, and neither is an error."""
    done = ros2(*words)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("usage: ros2 [-h]")
    assert "ros2 is an extensible command-line tool for ROS 2." in done.stdout
    rows = [line.split(None, 1) for line in done.stdout.splitlines() if line.startswith("  ")]
    assert ["pkg", "Various package related sub-commands"] in rows
    assert ["run", "Run a package specific executable"] in rows


@pytest.mark.parametrize("words", [[], ["-h"]])
@pytest.mark.parametrize("name", VERBS)
def test_help_of_a_command_names_its_verbs(ros2: Ros2, name: str, words: list[str]) -> None:
    """A command without a verb shows its help, as success."""
    done = ros2(name, *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"usage: ros2 {name} [-h]")
    assert f"Call `ros2 {name} <command> -h` for more detailed usage." in done.stdout
    shown = [line.split()[0] for line in done.stdout.partition("Commands:")[2].splitlines() if line.strip()]
    assert shown[: len(VERBS[name])] == VERBS[name]


def test_each_verb_has_help() -> None:
    """Each verb is loaded, has a line of help, and its options are explained."""
    parser = command.parser_of(None)
    seen = []

    def walk(parser: argparse.ArgumentParser) -> None:
        for child in _choices(parser).values():
            walk(child)
        for action in parser._actions:
            assert action.help or isinstance(action, argparse._SubParsersAction), f"{parser.prog}: {action}"
        verb = parser.get_default("verb_object")
        if verb is not None and parser.get_default("shown_parser") is parser:
            seen.append(parser.prog)
            assert parser.description == summary(type(verb))
            assert isinstance(verb, Verb)
            assert parser.format_help().startswith(f"usage: {parser.prog} ")

    walk(parser)
    assert {"ros2 run", *(f"ros2 pkg {verb}" for verb in VERBS["pkg"])} <= set(seen)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["nope"], "invalid choice: 'nope'"),
        (["pkg", "nope"], "invalid choice: 'nope'"),
        (["pkg", "list", "--nope"], "unrecognized arguments: --nope"),
        (["pkg", "list", "nope"], "unrecognized arguments: nope"),
        (["pkg", "prefix"], "the following arguments are required: package_name"),
        (["run"], "the following arguments are required: package_name, executable_name"),
        (["run", "rclpy"], "the following arguments are required: executable_name"),
        (["--nope"], "unrecognized arguments: --nope"),
        (["_verb"], "invalid choice: '_verb'"),
        (["__init__"], "invalid choice: '__init__'"),
        ([""], "invalid choice: ''"),
    ],
)
def test_a_wrong_line_is_explained(ros2: Ros2, words: list[str], complaint: str) -> None:
    """Usage and complaint go to standard error, with argparse's exit code."""
    done = ros2(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("usage: ros2")
    assert complaint in done.stderr
    assert "Traceback" not in done.stderr


def test_an_unknown_command_is_told_which_there_are(ros2: Ros2) -> None:
    """All of them, not only those that were loaded."""
    assert "'pkg', " in ros2("nope").stderr
    assert "'create', 'executables', 'list', 'prefix', 'xml'" in ros2("pkg", "nope").stderr


def test_a_word_of_the_real_one_names_the_real_package() -> None:
    """A word that is like one of those that there are is taken for that, and gets no more advice."""
    for words, package in (
        (["component"], "ros2cli_common_extensions"),
        (["service", "echo"], "ros2service"),
        (["bag", "convert"], "ros2bag"),
        (["topik"], None),
        (["topic", "ehco"], None),
    ):
        with pytest.raises(SystemExit), contextlib.redirect_stderr(io.StringIO()) as told:
            command.main(words)
        assert (f"it needs the real package {package}, which" in told.getvalue()) == bool(package), words
        assert ("apt install" in told.getvalue()) == bool(package), words


def test_help_names_the_value_behind_each_name_of_an_option(ros2: Ros2) -> None:
    """As Jazzy's Python 3.12 does, whichever Python this is."""
    assert "  -w WINDOW, --window WINDOW\n" in ros2("topic", "hz", "-h").stdout


def test_version_does_not_pretend_to_be_the_real_one(ros2: Ros2) -> None:
    """It names this package, its version, and what it is not."""
    done = ros2("--version")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"portable_ros2 {__version__} ")
    assert "not the ros2 of ros2cli" in done.stdout


def test_only_what_is_asked_for_is_loaded() -> None:
    """`pkg list` loads neither ROS nor another command, and help loads nothing slow."""
    for words in (["pkg", "list"], ["--help"]):
        code = (
            "import sys\nfrom portable_ros2 import command\n"
            f"try:\n command.main({words})\nexcept SystemExit:\n pass\n"
            "slow = {'rclpy', 'yaml', 'jinja2', 'catkin_pkg', 'numpy', 'argcomplete', 'std_msgs'}\n"
            "print(sorted(slow & set(sys.modules)), file=sys.stderr)"
        )
        done = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, timeout=DEADLINE, check=True
        )
        assert done.stderr == "[]\n"


@pytest.fixture
def buffered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let Python write when it likes: without, argparse meets the error itself when it writes help, and hides it."""
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)


LINES = [["pkg", "list"], ["--help"], ["pkg", "create", "-h"], ["pkg", "executables"], ["--version"]]


@pytest.mark.usefixtures("buffered")
@pytest.mark.parametrize("words", LINES)
@pytest.mark.parametrize("buffering", [[], ["--use-python-default-buffering"]])
def test_a_closed_pipe_ends_it_quietly(words: list[str], buffering: list[str]) -> None:
    """Whoever reads may stop reading, such as `head -1`, at any time."""
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [COMMAND, *buffering, *words],
            stdout=writing,
            stderr=subprocess.PIPE,
            text=True,
            timeout=DEADLINE,
            check=False,
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (128 + signal.SIGPIPE, "")


def test_head_gets_its_line(tmp_path: Path) -> None:
    """The first line arrives, and the shell sees nothing else."""
    done = subprocess.run(
        ["bash", "-c", f"'{COMMAND}' pkg list | head -1"],
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=True,
    )
    assert len(done.stdout.splitlines()) == 1
    assert done.stderr == ""


@pytest.mark.usefixtures("buffered")
@pytest.mark.parametrize("words", LINES)
def test_a_full_disk_is_told_in_a_sentence(words: list[str]) -> None:
    """Neither a traceback, nor Python's own complaint at the exit."""
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [COMMAND, *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=DEADLINE,
            check=False,
        )
    assert done.returncode == 1
    assert done.stderr.splitlines() == ["[Errno 28] No space left on device"]


@pytest.mark.parametrize("words", LINES)
def test_it_works_without_an_output(words: list[str]) -> None:
    """A program may be started with its output closed."""
    done = subprocess.run(
        ["bash", "-c", f"'{COMMAND}' {' '.join(words)} >&-"],
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert done.returncode == 0
    assert "Traceback" not in done.stderr


LIST = ["--use-python-default-buffering", "pkg", "list"]


@pytest.mark.parametrize(
    ("raised", "code"),
    [
        (KeyboardInterrupt(), 2),
        (RuntimeError("It is broken."), "It is broken."),
        (OSError(13, "Permission denied", "/x"), "[Errno 13] Permission denied: '/x'"),
    ],
)
def test_what_a_verb_raises_becomes_an_exit_code(
    monkeypatch: pytest.MonkeyPatch, raised: BaseException, code: int | str
) -> None:
    """Ctrl-C, a sentence, a file that cannot be read."""
    from portable_ros2.commands.pkg.list import ListVerb

    def main(*_: object) -> None:
        raise raised

    monkeypatch.setattr(ListVerb, "main", main)
    monkeypatch.setattr(command, "_discard_output", lambda: None)
    assert command.main(LIST) == code


@pytest.mark.parametrize(
    ("is_terminal", "shown"),
    [(True, "\\x1b[2J\\x9b\\u202e\tsprüht\n"), (False, "\x1b[2J\x9b\u202e\tsprüht\n")],
)
def test_what_others_say_gives_a_terminal_no_codes(
    monkeypatch: pytest.MonkeyPatch, is_terminal: bool, shown: str
) -> None:
    """Messages and names may hold any character; a pipe gets them as they are."""
    from portable_ros2.commands.pkg.list import ListVerb

    class Output(io.StringIO):
        def isatty(self) -> bool:
            return is_terminal

    def main(*_: object) -> None:
        print("\x1b[2J\x9b\u202e\tsprüht")
        print("\x1b[2J\x9b\u202e\tsprüht", file=sys.stderr)

    monkeypatch.setattr(ListVerb, "main", main)
    outputs = [Output(), Output()]
    monkeypatch.setattr(sys, "stdout", outputs[0])
    monkeypatch.setattr(sys, "stderr", outputs[1])
    assert command.main(LIST) is None
    assert [output.getvalue() for output in outputs] == [shown, shown]


def test_what_a_launch_file_asks_for_gives_a_terminal_no_codes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    file = tmp_path / "a.launch.py"
    file.write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import DeclareLaunchArgument\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([DeclareLaunchArgument('a\\x1b[2J', description='b\\x1b[2J')])\n"
    )
    output = Terminal()
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, output)
    assert command.main(["--use-python-default-buffering", "launch", "--show-args", str(file)]) is None
    assert "a\\x1b[2J" in output.getvalue()
    assert "\x1b" not in output.getvalue()


STRANGE = os.fsdecode(b"a\xffb")


@pytest.mark.parametrize(
    "words",
    [
        ["topic", "echo", f"/{STRANGE}"],
        ["topic", "pub", "/a", "std_msgs/msg/String", f"{{data: {STRANGE}}}"],
        ["service", "call", f"/{STRANGE}", "std_srvs/srv/Empty"],
        ["action", "info", STRANGE],
        ["pkg", "create", STRANGE],
        ["pkg", "create", "duck", "--description", STRANGE],
        ["launch", STRANGE],
        ["bag", "record", "-o", STRANGE, "-a"],
        ["param", "set", "/a", "b", STRANGE],
    ],
    ids=lambda words: " ".join(words[:2]),
)
def test_an_argument_that_is_no_text_is_told_in_a_sentence(words: list[str], tmp_path: Path) -> None:
    done = run_in_bytes(words, tmp_path)
    assert done.returncode == 1
    assert b" cannot be read as text in UTF-8, the encoding of this terminal.\n" in done.stderr
    assert done.stderr.count(b"\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_program_that_is_run_gets_any_bytes(tmp_path: Path) -> None:
    done = run_in_bytes(["run", "duck", "swim", STRANGE], tmp_path)
    assert done.stderr == b"Package 'duck' not found\n"


@pytest.mark.parametrize(
    "environment",
    [
        {"PYTHONIOENCODING": "ascii"},
        {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        {"PYTHONIOENCODING": "latin-1"},
    ],
    ids=lambda environment: next(iter(environment)),
)
def test_a_letter_that_the_output_has_not_is_written_as_python_does(
    environment: dict[str, str], tmp_path: Path
) -> None:
    """A package may have any description, and a file any name."""
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "duck_日").touch()
    done = run_in_bytes(["pkg", "list"], tmp_path, AMENT_PREFIX_PATH=str(tmp_path), **environment)
    assert b"duck_\\u65e5\n" in done.stdout or b"duck_\\udce6\\udc97\\udca5\n" in done.stdout
    assert (done.returncode, done.stderr) == (0, b"")


def run_in_bytes(words: list[str], folder: Path, **variables: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [COMMAND, *words],
        cwd=folder,
        env={**os.environ, **variables},
        capture_output=True,
        timeout=DEADLINE,
        check=False,
    )


def test_a_mistake_of_ours_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    """What no one expected is raised."""
    from portable_ros2.commands.pkg.list import ListVerb

    monkeypatch.setattr(ListVerb, "main", lambda *_: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        command.main(LIST)


README = Path(__file__).parents[2] / "src" / "portable_ros2" / "README.md"


def test_readme_names_each_verb() -> None:
    """Its table has what there is, no more and no less."""
    rows = [line for line in README.read_text().splitlines() if line.startswith("| `ros2 ")]
    told = {}
    for row in rows:
        commands, verbs = row.strip("| ").partition("|")[::2]
        for name in re.findall("`ros2 ([a-z]+)`", commands):
            told[name] = set(re.findall("`([a-z_]+)`", verbs))
    subcommands = _choices(command.parser_of(None))
    assert told == {name: set(_choices(parser)) for name, parser in subcommands.items()}


def test_readme_shows_a_whole_verb(capsys: pytest.CaptureFixture[str]) -> None:
    """What stands there as an example works."""
    [code] = re.findall("```python\n(.*?)```", README.read_text(), re.DOTALL)
    scope: dict[str, type[Verb]] = {}
    exec(code, scope)
    scope["CountVerb"]().main(argparse.ArgumentParser(), argparse.Namespace())
    assert int(capsys.readouterr().out) > 10


def _choices(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return the sub-commands of a parser."""
    actions = (action for action in parser._actions if isinstance(action, argparse._SubParsersAction))
    return {name: child for action in actions for name, child in action.choices.items()}
