"""A bash that stays open between cells, and never hangs the notebook."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from deadlines import DEADLINE
from ros2lab.terminal import Terminal, TerminalError


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The student's folder, with a space and a foreign letter."""
    home = tmp_path / "mein Kurs ü"
    home.mkdir()
    monkeypatch.setenv("ROS2LAB_WORK", str(home))
    return home


@pytest.fixture
def bash(home: Path) -> Iterator[Terminal]:
    terminal = Terminal("a")
    yield terminal
    terminal.close()


def shown_by(terminal: Terminal, cell: str, **options: object) -> str:
    """Run a cell and return what it shows, without colours of prompts."""
    texts: list[str] = []
    try:
        terminal.run(cell.splitlines(), texts.append, **options)  # type: ignore[arg-type]
    finally:
        text = "".join(texts)
        for colour in ("\x1b[1;32m", "\x1b[1;34m", "\x1b[0m"):
            text = text.replace(colour, "")
    return text


def until(condition: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + DEADLINE
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.02)


def test_folder_variable_function_and_job_hold_in_the_next_cell_and_not_in_another_terminal(
    bash: Terminal, home: Path
) -> None:
    shown_by(bash, "mkdir ros2_ws; cd ros2_ws\nX=5\nf() { echo called $1; }\nexport Y=6\nsleep 60 &")
    assert shown_by(bash, "pwd; echo $X $Y; f g; jobs -r").splitlines()[1:] == [
        str(home / "ros2_ws"),
        "5 6",
        "called g",
        "[1]+  Running                 sleep 60 &",
    ]
    other = Terminal("b")
    try:
        assert (
            shown_by(other, "pwd\necho [$X$Y]\njobs")
            == f"b:~$ pwd\n{home}\nb:~$ echo [$X$Y]\n[]\nb:~$ jobs\n"
        )
    finally:
        other.close()


def test_each_command_stands_behind_the_prompt_above_its_output(bash: Terminal) -> None:
    cell = "mkdir -p w/src\ncd w\n\nls\n# done"
    assert shown_by(bash, cell) == "a:~$ mkdir -p w/src\na:~$ cd w\na:~/w$ ls\nsrc\na:~/w$ # done\n"


def test_a_new_terminal_reads_the_bashrc_of_the_students_folder(home: Path) -> None:
    (home / ".bashrc").write_text("echo hello; export FROM_BASHRC=yes; PS1='my own '; PROMPT_COMMAND=false\n")
    terminal = Terminal("a")
    try:
        assert shown_by(terminal, "echo $FROM_BASHRC") == "a:~$ echo $FROM_BASHRC\nyes\n"
    finally:
        terminal.close()


def test_programs_speak_english_and_know_all_letters(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What a lesson shows is what a student of any language sees."""
    monkeypatch.setenv("LC_ALL", "C.UTF-8")
    monkeypatch.setenv("LANGUAGE", "de")
    terminal = Terminal()
    try:
        variables = terminal.environ()
        assert "No such file or directory" in shown_by(terminal, "ls nowhere", goes_on=True)
    finally:
        terminal.close()
    assert (variables["LC_MESSAGES"], variables["LC_CTYPE"]) == ("C", "C.UTF-8")
    assert {"LC_ALL", "LANGUAGE"}.isdisjoint(variables)


def test_a_traceback_has_no_colours_on_any_python(bash: Terminal) -> None:
    """What a lesson shows is what a student of any Python sees; since 3.13 it would be coloured."""
    shown = shown_by(bash, f"{sys.executable} -c 'import nowhere'", goes_on=True)
    assert "ModuleNotFoundError: No module named 'nowhere'\n" in shown
    assert "\x1b" not in shown


def test_the_students_folder_is_made_where_there_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A notebook that is opened without `make lab` has a terminal, too."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "not yet there"))
    terminal = Terminal()
    try:
        assert "not yet there" in shown_by(terminal, "cd; pwd")
        assert terminal.environ()["HOME"] == str(tmp_path / "not yet there")
    finally:
        terminal.close()


@pytest.mark.parametrize(
    ("cell", "output"),
    [
        ("for i in 1 2; do\n  echo $i\n\ndone", "1\n2\n"),
        ("cat <<END\none\n\n  two\nEND", "one\n\n  two\n"),
        ("echo 'a\nb'", "a\nb\n"),
        ("echo a \\\n  b", "a b\n"),
        ('echo "Hello ROS2! Message #1"', "Hello ROS2! Message #1\n"),
        ("printf 'no end of line'", "no end of line"),
        ("echo \N{SNOWMAN} ü", "\N{SNOWMAN} ü\n"),
        ("printf 'a\\033]0;title\\007b\\033[2Kc\\n'", "abc\n"),
        ("true | false | true", ""),
    ],
)
def test_what_bash_understands_is_understood(bash: Terminal, cell: str, output: str) -> None:
    shown = shown_by(bash, cell)
    assert shown.endswith(output)
    assert shown.count("\n") - output.count("\n") == cell.count("\n") + 1
    assert not bash.is_busy


def test_a_command_that_fails_ends_the_cell(bash: Terminal) -> None:
    with pytest.raises(
        TerminalError, match=r"`ls /nowhere` failed with exit code 2\. 2 more lines"
    ) as caught:
        bash.run(["ls /nowhere", "echo a", "echo b"])
    assert caught.value._render_traceback_() == [str(caught.value)]
    assert "echo a" not in bash.read()
    assert bash.run(["echo $?"]) == [0]
    assert bash.read().rstrip().endswith("2")


def test_after_an_expected_error_it_goes_on(bash: Terminal) -> None:
    assert bash.run(["ls /nowhere", "true", "frobnicate"], goes_on=True) == [2, 0, 127]


def test_a_comment_after_a_command_that_failed_does_not_fail(bash: Terminal) -> None:
    """Bash keeps the code of the command before it."""
    bash.run(["ls /nowhere"], goes_on=True)
    assert bash.run(["# Write here.", "true"]) == [0]


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("frobnicate", "no such command"),
        ("echo 'not closed", "a quote, a bracket or a here-document is not closed"),
        ("cat <<END\ntext", "is not closed"),
        ("if true; then\necho a", "is not closed"),
        ("cat", "`cat` waits for the keyboard"),
        ("read answer", "waits for the keyboard"),
        ("python3 -c 'input()'", "waits for the keyboard"),
        ("python3 -q", "waits for the keyboard"),
        ("printf '\\033[?1049h'; sleep 60", "takes the whole screen"),
        ("bash -c 'kill -SEGV $$'", "SIGSEGV ended it"),
        ("echo " + 5000 * "x", "more than 4000 bytes"),
    ],
)
def test_nothing_hangs_it(bash: Terminal, cell: str, words: str) -> None:
    with pytest.raises(TerminalError, match=words):
        bash.run(cell.splitlines(), timeout=DEADLINE)
    assert shown_by(bash, "echo alive").endswith("\nalive\n")


def test_what_does_not_end_in_time_is_interrupted(bash: Terminal) -> None:
    with pytest.raises(TerminalError, match="`sleep 60` did not end in time"):
        bash.run(["sleep 60"], timeout=0.3)
    assert shown_by(bash, "echo alive").endswith("\nalive\n")


def test_what_ignores_ctrl_c_is_killed_and_bash_survives(bash: Terminal) -> None:
    cell = "X=5\npython3 -c 'import signal; signal.signal(2, signal.SIG_IGN); print(1, flush=True); signal.pause()'"
    with pytest.raises(TerminalError, match="did not end in time"):
        bash.run(cell.splitlines(), timeout=1.0)
    assert shown_by(bash, "echo $X").endswith("\n5\n")


def test_an_interrupt_of_the_notebook_reaches_the_command(bash: Terminal) -> None:
    def press_ctrl_c() -> None:
        until(lambda: "\nbegun\n" in bash.read(), "the command has begun")
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=press_ctrl_c)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        bash.run(["X=5", "trap 'echo trapped' INT", "bash -c 'echo begun; sleep 60; echo ended'"])
    thread.join()
    assert not bash.is_busy
    assert shown_by(bash, "echo $X").endswith("\n5\n")


@pytest.mark.parametrize("cell", ["exit", "exec true"])
def test_a_shell_that_is_left_is_no_error(bash: Terminal, cell: str) -> None:
    bash.run([cell])
    assert not bash.is_open
    with pytest.raises(TerminalError, match="is closed"):
        bash.run(["true"])


@pytest.mark.parametrize("cell", ["set -e\nfalse", "kill -9 $$", "exit 3\necho lost"])
def test_a_shell_that_ends_otherwise_is_an_error(bash: Terminal, cell: str) -> None:
    with pytest.raises(TerminalError, match="has ended") as caught:
        bash.run(cell.splitlines(), timeout=DEADLINE)
    assert ("not typed" in str(caught.value)) == ("lost" in cell)
    assert not bash.is_open


def test_much_output_is_taken_in_and_the_newest_is_kept(bash: Terminal) -> None:
    seen = 0

    def count(text: str) -> None:
        nonlocal seen
        seen += len(text)

    bash.run(["head -c 10000000 /dev/zero | tr '\\0' x | fold -w 99", "echo the end"], count)
    assert seen > 10_000_000
    assert len(bash.read()) < 1_200_000
    assert bash.read().endswith("the end\n")


def test_any_bytes_are_taken_in(bash: Terminal) -> None:
    bash.run(["head -c 100000 /dev/urandom | tr -d '\\033'", "echo the end"])
    assert bash.read().endswith("the end\n")


def test_what_runs_in_the_background_is_read_and_interrupted(bash: Terminal) -> None:
    node = "python3 -uc 'import time\nprint(\"up\")\ntime.sleep(60)'"
    assert bash.run(["cd /", *node.splitlines()], in_background=True) == [0]
    bash.wait_for("up", DEADLINE)
    assert bash.is_busy
    with pytest.raises(TerminalError, match="is busy"):
        bash.run(["ls"])
    bash.interrupt()
    assert not bash.is_busy
    assert "KeyboardInterrupt" in bash.read()
    assert bash.last_code not in (0, None)


def test_an_interrupt_of_what_ends_just_then_costs_the_next_line_nothing(bash: Terminal) -> None:
    for _ in range(60):
        bash.run(["bash -c 'echo over'"], in_background=True)
        bash.wait_for("over", DEADLINE)
        bash.interrupt()
        assert bash.run(["true"], timeout=DEADLINE) == [0]
    assert "^C" not in bash.read()


def test_waiting_for_what_does_not_come_says_what_came(bash: Terminal) -> None:
    bash.run(["echo something"], in_background=True)
    with pytest.raises(TerminalError, match=r"has not shown 'else' and its command has ended.*something"):
        bash.wait_for("else", DEADLINE)


KERNEL = """
import sys
from ros2lab.terminal import Terminal
terminal = Terminal("a")
terminal.run(["nohup setsid sleep 1001 >/dev/null 2>&1 &", "sleep 1002 & disown", "(trap '' HUP; sleep 1003) &"])
terminal.run(["sleep 1004"], in_background=True)
print("ready", flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_everything_ends_with_the_kernel(home: Path, number: int) -> None:
    """What has left its session, its parent or ignores SIGHUP, too; by whatever the kernel ends."""
    kernel = subprocess.Popen(
        [sys.executable, "-c", KERNEL], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert kernel.stdout is not None
    assert kernel.stdout.readline() == "ready\n"
    until(lambda: len(_sleeps(kernel.pid)) == 4, "the four have started")
    family = psutil.Process(kernel.pid).children(recursive=True)
    kernel.send_signal(number)
    kernel.communicate()
    _, alive = psutil.wait_procs(family, timeout=DEADLINE)
    assert not alive


def _sleeps(pid: int) -> list[int]:
    names = {}
    for child in psutil.Process(pid).children(recursive=True):
        with contextlib.suppress(psutil.NoSuchProcess):  # one that has just ended
            names[child.pid] = child.name()
    return [pid for pid, name in names.items() if name == "sleep"]


def test_what_a_program_prints_ends_no_command(bash: Terminal) -> None:
    """Nor does it name a folder, clear what was shown, or rename the window."""
    forged = "\\e]133;D;0;/forged\\a\\e]133;D;0;/forged;\\a\\e]133;P\\a\\e]0;title\\a\\e[2J\\e[H\\ec"
    shown = shown_by(bash, f"printf '{forged}'; sleep 0.3; echo the end; pwd")
    assert shown.splitlines()[-2] == "the end"
    assert "forged" not in shown.partition("\n")[2]
    assert "ROS2LAB_WORD" not in bash.environ()
