"""`ros2 launch` as a student types it."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pexpect
import psutil
import pytest
import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

from deadlines import DEADLINE
from ros2lab.course import copy_reference
from ros2lab.environment import lab_environment

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))
NODES = ("command_subscriber", "status_publisher", "velocity_publisher")

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Start = Callable[..., "subprocess.Popen[str]"]

HEADER = """
import sys
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import IfCondition
from launch.substitutions import *
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare
"""
# Ignores the signals that are named on its command line, and says what it gets.
PROCESS = r"""
import os, signal, sys, time
def tell(number, frame):
    os.write(1, f"got {signal.Signals(number).name}\n".encode())  # a print may be in progress
    if number not in map(int, sys.argv[1:]):
        os._exit(0)
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, tell)
print("ready", os.getpid(), flush=True)
while True:
    time.sleep(0.05)
"""


@pytest.fixture(autouse=True)
def own_logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes a launch file with some entities."""

    def write_file(*entities: str, name: str = "a.launch.py") -> Path:
        (tmp_path / "process.py").write_text(PROCESS)
        path = tmp_path / name
        listed = ", ".join(entities)
        path.write_text(
            f"{HEADER}\ndef generate_launch_description():\n    return LaunchDescription([{listed}])\n"
        )
        return path

    return write_file


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Return a function that starts `ros2 launch` in a process group of its own, without a terminal."""
    started: list[subprocess.Popen[str]] = []

    def start_launch(*words: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [COMMAND, "launch", *words],
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield start_launch
    for process in started:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


def process(*ignored: int, more: str = "") -> str:
    words = ", ".join(f"'{number}'" for number in ignored)
    return f"ExecuteProcess(cmd=[sys.executable, 'process.py', {words}], name='p', output='screen'{more})"


def ready(launching: subprocess.Popen[str], count: int = 1) -> list[psutil.Process]:
    """Wait until so many processes have said that they are ready, and return them."""
    assert launching.stdout is not None
    found = []
    for line in launching.stdout:
        if " ready " in line:
            found.append(psutil.Process(int(line.split()[-1])))
        if len(found) == count:
            return found
    raise AssertionError("the launch has ended")


def finished(launching: subprocess.Popen[str]) -> tuple[int, str]:
    output, _ = launching.communicate(timeout=DEADLINE)
    return launching.returncode, re.sub(r"pid \[?\d+", "pid N", output)


# What is launched


def test_a_file_is_launched_with_arguments_of_which_the_last_one_counts(
    ros2: Ros2, write: Callable[..., Path]
) -> None:
    path = write("DeclareLaunchArgument('a')", "LogInfo(msg=LaunchConfiguration('a'))")
    result = ros2("launch", str(path), "a:=1", "b:=x:=y", "a:=2")
    assert (result.returncode, result.stderr) == (0, "")
    folder, verbosity, said = result.stdout.splitlines()
    assert re.fullmatch(
        r"\[INFO\] \[launch\]: All log files can be found below /.*/log/\d{4}(-\d\d){5}-\d{6}-.*-\d+", folder
    )
    assert verbosity == "[INFO] [launch]: Default logging verbosity is set to INFO"
    assert said == "[INFO] [launch.user]: 2"


def test_a_file_of_a_package_is_found_wherever_it_lies(
    ros2: Ros2, prefix: Path, write: Callable[..., Path]
) -> None:
    share = prefix / "share/demo"
    (share / "launch/deep").mkdir(parents=True)
    shutil.copy(write("LogInfo(msg='found')"), share / "launch/deep/robot.launch.py")
    result = ros2("launch", "demo", "robot.launch.py")
    assert (result.returncode, result.stdout.splitlines()[2:]) == (0, ["[INFO] [launch.user]: found"])
    shutil.copy(share / "launch/deep/robot.launch.py", share)
    result = ros2("launch", "demo", "robot.launch.py")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.startswith(
        f"file 'robot.launch.py' was found more than once in the share directory of package 'demo': ['{share}/"
    )


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (
            ["none_such", "a.launch.py"],
            "Package 'none_such' not found: \"package 'none_such' not found, searching: [",
        ),
        (["none_such"], "Package 'none_such' not found: "),
        (
            ["demo", "none.launch.py"],
            "file 'none.launch.py' was not found in the share directory of package 'demo' which is at '/",
        ),
        (["demo"], "Name the launch file of package 'demo' too; there are: demo.yaml."),
        (["./none.launch.py"], "There is no launch file './none.launch.py'."),
        (["none.launch.py"], "There is no launch file 'none.launch.py'."),
        (["/no/where/x"], "There is no launch file '/no/where/x'."),
        (["."], "Package '.' not found: "),
        ([""], "Package '' not found: "),
        (["a.launch.py", "a"], "malformed launch argument 'a', expected format '<name>:=<value>'"),
        (["a.launch.py", "a:="], "malformed launch argument 'a:=', expected format"),
        (["a.launch.py", ":=a"], "malformed launch argument ':=a', expected format"),
        (["a.launch.py", "a=1"], "malformed launch argument 'a=1', expected format"),
        (
            ["a.launch.py", "--launch-prefix-filter", "x"],
            "--launch-prefix must be specified if --launch-prefix-filter",
        ),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_what_cannot_be_launched_is_one_sentence(
    ros2: Ros2, write: Callable[..., Path], words: list[str], error: str
) -> None:
    write()
    result = ros2("launch", *words)
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.startswith(error)
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize("words", [[], ["-s", "-p", "a.launch.py"]])
def test_wrong_usage(ros2: Ros2, words: list[str]) -> None:
    result = ros2("launch", *words)
    assert result.returncode == 2
    assert result.stderr.startswith("usage: ros2 launch [-h] [-n] [-d] [-p | -s] [-a]")


def test_an_unknown_option_is_named(ros2: Ros2) -> None:
    result = ros2("launch", "--none", "a.launch.py")
    assert result.returncode == 2
    assert result.stderr.endswith("error: unrecognized arguments: --none\n")


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("def generate_launch_description(:", "SyntaxError: invalid syntax (a.launch.py, line 1)"),
        ("x = 1", "does not contain the required function 'generate_launch_description()'"),
        ("raise SystemExit('enough')", "enough"),
    ],
)
@pytest.mark.parametrize("option", [None, "-s", "-p"])
def test_a_wrong_file_is_told_without_a_traceback(
    ros2: Ros2, tmp_path: Path, text: str, error: str, option: str | None
) -> None:
    (tmp_path / "a.launch.py").write_text(text)
    result = ros2("launch", *([option] if option else []), "a.launch.py")
    assert result.returncode == 1
    assert error in result.stderr + result.stdout
    assert "Traceback" not in result.stderr + result.stdout


def test_the_arguments_are_shown(ros2: Ros2, tmp_path: Path, write: Callable[..., Path]) -> None:
    (tmp_path / "more.launch.xml").write_text(
        "<launch><arg name='f' default='$(var e)' description='of more'/></launch>"
    )
    path = write(
        "DeclareLaunchArgument('a')",
        "DeclareLaunchArgument('b', default_value=['x', EnvironmentVariable('HOME')], description='the b')",
        "DeclareLaunchArgument('c', choices=['x', 'y'], default_value='x')",
        "DeclareLaunchArgument('d', default_value='', condition=IfCondition('true'))",
        "GroupAction([DeclareLaunchArgument('e', description='in a group')])",
        "IncludeLaunchDescription('more.launch.xml')",
        "DeclareLaunchArgument('a', description='again')",
    )
    for option in ("-s", "--show-args", "--show-arguments"):
        result = ros2("launch", str(path), option)
        assert (result.returncode, result.stderr) == (0, "")
        assert result.stdout.split("\n\n") == [
            "Arguments (pass arguments as '<name>:=<value>'):",
            "    'a':\n        no description given",
            "    'b':\n        the b\n        (default: 'x' + EnvVar('HOME'))",
            "    'c':\n        One of: ['x', 'y']\n        (default: 'x')",
            "    'd':*\n        no description given\n        (default: '')",
            "    'e':\n        in a group",
            "    'f':\n        of more\n        (default: LaunchConfig('e'))",
            "* argument(s) which are only used if specific conditions occur\n",
        ]
    assert not (tmp_path / "log").exists()


def test_no_arguments_are_shown_as_none(ros2: Ros2, write: Callable[..., Path]) -> None:
    result = ros2("launch", str(write()), "-s")
    assert result.stdout == "Arguments (pass arguments as '<name>:=<value>'):\n\n  No arguments.\n"


@pytest.mark.usefixtures("prefix")
def test_the_description_is_printed_as_a_tree(ros2: Ros2, write: Callable[..., Path]) -> None:
    path = write(
        "LogInfo(msg=['a', LaunchConfiguration('b')])",
        "ExecuteProcess(cmd=['echo', LaunchConfiguration('x')], cwd='/', env={'a': 'b'})",
        "Node(package='demo', executable='show')",
        "Shutdown()",
        "RegisterEventHandler(__import__('launch.event_handlers').event_handlers.OnProcessExit("
        "on_exit=[LogInfo(msg='x'), LogInfo(msg='y')]))",
    )
    for option in ("-p", "--print", "--print-description"):
        result = ros2("launch", str(path), option)
        assert (result.returncode, result.stderr) == (0, "")
        assert re.sub(r"<\S+ object at 0x\w+>", "OBJECT", result.stdout).splitlines() == [
            "OBJECT",
            "├── LogInfo('a' + LaunchConfig('b'))",
            "├── ExecuteProcess(cmd=['echo', LaunchConfig('x')], cwd=''/'', env={'a': 'b'}, shell=False)",
            "├── ExecuteProcess(cmd=[ExecInPkg(pkg='demo', exec='show'), '--ros-args'], cwd=None, env=None, shell=False)",
            "├── EmitEvent(event='launch.events.Shutdown')",
            "└── RegisterEventHandler('OBJECT'):",
            "    └── OnProcessExit(matcher='event == ProcessExited', handler='<actions>', handle_once=False)",
            "        ├── LogInfo('x')",
            "        └── LogInfo('y')",
        ]


def test_options_about_the_processes(ros2: Ros2, write: Callable[..., Path]) -> None:
    path = str(write("ExecuteProcess(cmd=['echo', 'out'])", "ExecuteProcess(cmd=['printf', 'other'])"))
    assert " out\n" not in ros2("launch", path).stdout
    for option in ("-a", "--show-all-subprocesses-output"):
        assert "[echo-1] out\n" in ros2("launch", path, option).stdout
    prefix = ["--launch-prefix", "echo before"]
    both = ros2("launch", path, "-a", *prefix).stdout
    assert "[echo-1] before echo out\n" in both
    assert "[echo-2] before printf other\n" in both
    one = ros2("launch", path, "-a", *prefix, "--launch-prefix-filter", "pri.*").stdout
    assert "[echo-1] out\n" in one
    assert "[echo-2] before printf other\n" in one


def test_debug_writes_more(ros2: Ros2, write: Callable[..., Path]) -> None:
    result = ros2("launch", str(write("LogInfo(msg=LaunchConfiguration('nowhere'))")), "-d")
    assert result.returncode == 1
    assert "[INFO] [launch]: Default logging verbosity is set to DEBUG\n" in result.stdout
    assert "SubstitutionFailure: launch configuration 'nowhere' does not exist" in result.stdout


def test_a_log_folder_that_cannot_be_written_is_one_sentence(
    ros2: Ros2, tmp_path: Path, write: Callable[..., Path]
) -> None:
    (tmp_path / "file").touch()
    result = ros2("launch", str(write("LogInfo(msg='x')")), ROS_LOG_DIR=str(tmp_path / "file"))
    assert result.returncode == 1
    assert re.fullmatch(r"The log folder /\S+ cannot be made \(.*\); set ROS_LOG_DIR to .*\n", result.stderr)


def test_letters_that_the_terminal_has_not(ros2: Ros2, write: Callable[..., Path]) -> None:
    path = str(write("LogInfo(msg='ä')"))
    result = ros2("launch", path, PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.endswith("[launch.user]: ?\n")


# How it ends


def test_an_interrupt_reaches_each_process_once(start: Start, write: Callable[..., Path]) -> None:
    """Whether it is sent to the launch alone or to its group, as a terminal does."""
    for send in (os.kill, os.killpg):
        launching = start(str(write(process(), process())))
        ready(launching, 2)
        send(launching.pid, signal.SIGINT)
        code, output = finished(launching)
        assert code == 0
        assert output.count("[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)\n") == 1
        assert output.count("got SIGINT") == 2
        assert output.count("process has finished cleanly [pid N]") == 2
        assert output.count("[p-1]: sending signal 'SIGINT' to process[p-1]") == 1


def test_the_second_interrupt_is_ignored(start: Start, write: Callable[..., Path]) -> None:
    launching = start(str(write(process(signal.SIGINT, more=", sigterm_timeout='1'"))))
    ready(launching)
    launching.send_signal(signal.SIGINT)
    assert launching.stdout is not None
    before = "".join(iter(launching.stdout.readline, "[p-1] got SIGINT\n"))
    launching.send_signal(signal.SIGINT)
    code, output = finished(launching)
    assert code == 0
    assert "user interrupted with ctrl-c (SIGINT)\n" in before
    assert "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT) again, ignoring...\n" in output
    assert "got SIGINT" not in output
    assert "failed to terminate '1' seconds after receiving 'SIGINT', escalating to 'SIGTERM'" in output
    assert "[p-1] got SIGTERM\n" in output


def test_sigterm_ends_the_processes_in_order_too(start: Start, write: Callable[..., Path]) -> None:
    launching = start(str(write(process())))
    ready(launching)
    launching.terminate()
    code, output = finished(launching)
    assert code == 1
    assert "[ERROR] [launch]: user interrupted with ctrl-\\ (SIGTERM), terminating...\n" in output
    assert "[p-1] got SIGINT\n" in output


def test_the_second_sigterm_ends_all_at_once(start: Start, write: Callable[..., Path]) -> None:
    launching = start(str(write(process(signal.SIGINT, signal.SIGTERM))))
    (child,) = ready(launching)
    launching.terminate()
    assert launching.stdout is not None
    for line in launching.stdout:
        if "got SIGINT" in line:
            break
    launching.terminate()
    code, output = finished(launching)
    assert code == 1
    assert "[ERROR] [launch]: run task was canceled\n" in output
    child.wait(DEADLINE)


def test_nothing_survives_a_launch_that_is_killed(start: Start, write: Callable[..., Path]) -> None:
    launching = start(str(write(process(signal.SIGINT, signal.SIGTERM), process())))
    children = ready(launching, 2)
    launching.kill()
    launching.wait(DEADLINE)
    gone, alive = psutil.wait_procs(children, timeout=DEADLINE)
    assert (len(gone), alive) == (2, [])


def test_a_reader_that_goes_ends_the_launch_and_its_processes(
    start: Start, write: Callable[..., Path]
) -> None:
    script = "import itertools, time\nfor n in itertools.count(): print(n, flush=True); time.sleep(0.001)"
    launching = start(
        str(write(process(), f"ExecuteProcess(cmd=[sys.executable, '-c', {script!r}], output='screen')"))
    )
    (child,) = ready(launching)
    assert launching.stdout is not None
    launching.stdout.close()
    assert launching.wait(DEADLINE) == 0
    child.wait(DEADLINE)


def test_a_closed_pipe_is_quiet(tmp_path: Path, write: Callable[..., Path]) -> None:
    result = subprocess.run(
        ["bash", "-c", f"{COMMAND} launch {write(process())} < /dev/null | head -n 1"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=True,
    )
    assert result.stdout.startswith("[INFO] [launch]: All log files")
    assert result.stderr == ""


def test_ctrl_c_in_a_terminal(tmp_path: Path, write: Callable[..., Path]) -> None:
    """The terminal sends SIGINT to the processes itself, and twice if it is pressed twice."""
    path = write(process(signal.SIGINT))
    terminal = pexpect.spawn(
        COMMAND, ["launch", str(path), "sigterm_timeout:=1"], cwd=tmp_path, encoding="utf-8", timeout=DEADLINE
    )
    terminal.expect(r"\[p-1\] ready")
    terminal.sendintr()
    terminal.expect(r"\[p-1\] got SIGINT")
    terminal.sendintr()
    terminal.expect(r"\[p-1\] got SIGINT")
    terminal.expect("escalating to 'SIGTERM'")
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert terminal.exitstatus == 0


def test_ctrl_c_in_a_terminal_is_passed_on_by_nobody(tmp_path: Path, write: Callable[..., Path]) -> None:
    terminal = pexpect.spawn(
        COMMAND, ["launch", str(write(process()))], cwd=tmp_path, encoding="utf-8", timeout=DEADLINE
    )
    terminal.expect(r"\[p-1\] ready")
    terminal.sendintr()
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert terminal.exitstatus == 0
    assert "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)" in terminal.before
    assert "[p-1] got SIGINT" in terminal.before
    assert "sending signal" not in terminal.before


# Completion


def completions(tmp_path: Path, line: str) -> list[str]:
    subprocess.run(
        [COMMAND],
        cwd=tmp_path,
        env={
            **os.environ,
            "_ARGCOMPLETE": "1",
            "_ARGCOMPLETE_IFS": "\n",
            "_ARGCOMPLETE_SUPPRESS_SPACE": "1",
            "_ARGCOMPLETE_STDOUT_FILENAME": str(tmp_path / "answer"),
            "COMP_LINE": line,
            "COMP_POINT": str(len(line)),
        },
        timeout=DEADLINE,
        check=False,
    )
    words = (word.strip() for word in (tmp_path / "answer").read_text().split("\n"))
    return [word for word in words if word and not word.startswith("-")]  # options are always offered, too


def test_packages_files_and_arguments_are_completed(
    tmp_path: Path, prefix: Path, write: Callable[..., Path]
) -> None:
    path = write(
        "DeclareLaunchArgument('speed', default_value='1')",
        "DeclareLaunchArgument('size')",
        name="de.launch.py",
    )
    (tmp_path / "desk").mkdir()
    (tmp_path / "desk/table.launch.xml").write_text("<launch/>")
    (tmp_path / "device.txt").touch()
    shutil.copy(path, prefix / "share/demo/robot.launch.py")
    shutil.copy(path, prefix / "share/demo/package.xml")
    assert sorted(completions(tmp_path, "ros2 launch de")) == ["de.launch.py", "demo", "desk/"]
    assert completions(tmp_path, "ros2 launch desk/") == ["desk/table.launch.xml"]
    assert sorted(completions(tmp_path, "ros2 launch demo ")) == ["demo.yaml", "robot.launch.py"]
    assert sorted(completions(tmp_path, "ros2 launch demo robot.launch.py s")) == ["size:=", "speed:="]
    assert sorted(completions(tmp_path, "ros2 launch de.launch.py s")) == ["size:=", "speed:="]
    assert completions(tmp_path, "ros2 launch none_such ") == []
    assert completions(tmp_path, "ros2 launch demo none.launch.py s") == []


# The reference


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a copy of the reference workspace."""
    folder = copy_reference(tmp_path_factory.mktemp("reference"))
    subprocess.run(
        ["colcon", "build"],
        cwd=folder,
        env=lab_environment(),
        capture_output=True,
        timeout=DEADLINE,
        check=True,
    )
    return folder


class Watcher:
    """Looks which nodes there are, and what values their parameters have."""

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self.node = rclpy.create_node("watcher", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)

    def wait_for(self, namespace: str) -> None:
        deadline = time.monotonic() + DEADLINE
        expected = {(name, namespace) for name in NODES}
        while not expected <= set(self.node.get_node_names_and_namespaces()):
            assert time.monotonic() < deadline, self.node.get_node_names_and_namespaces()
            self.executor.spin_once(timeout_sec=0.05)

    def parameter(self, node: str, name: str) -> float:
        client = self.node.create_client(GetParameters, f"{node}/get_parameters")
        assert client.wait_for_service(DEADLINE)
        future = client.call_async(GetParameters.Request(names=[name]))
        self.executor.spin_until_future_complete(future, DEADLINE)
        value: float = future.result().values[0].double_value
        return value

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


@pytest.fixture
def watcher(domain_id: int) -> Iterator[Watcher]:
    watching = Watcher(domain_id)
    yield watching
    watching.close()


def test_the_reference_runs_in_a_sourced_terminal(workspace: Path, watcher: Watcher) -> None:
    """Unchanged, with its configuration file and with arguments, which beat the file."""
    # On a busy machine an interpreter may need more than the usual 5 s for its own end.
    arguments = "namespace:=anna status_period:=0.5 sigterm_timeout:=60"
    line = f"ros2 launch robot_controller robot.launch.py {arguments}"
    terminal = pexpect.spawn(
        "bash", ["--norc", "-c", f"source install/setup.bash && {line}"],
        cwd=workspace, env=lab_environment(), encoding="utf-8", timeout=DEADLINE,
    )  # fmt: skip
    for number, name in enumerate(NODES, start=1):
        terminal.expect(rf"\[INFO\] \[{name}-{number}\]: process started with pid \[\d+\]\r\n")
    watcher.wait_for("/anna")
    assert watcher.parameter("/anna/status_publisher", "period") == 0.5
    assert watcher.parameter("/anna/velocity_publisher", "period") == 0.1
    assert watcher.parameter("/anna/velocity_publisher", "angular_speed") == 0.2
    terminal.sendintr()
    terminal.expect(pexpect.EOF)
    terminal.close()
    assert terminal.before.count("process has finished cleanly [pid ") == len(NODES), terminal.before
    assert "Traceback" not in terminal.before
    assert terminal.exitstatus == 0


def test_a_wrong_argument_of_the_reference_is_a_sentence(workspace: Path) -> None:
    line = "ros2 launch robot_controller robot.launch.py status_period:=often"
    result = subprocess.run(
        ["bash", "-c", f"source install/setup.bash && {line}"],
        cwd=workspace, env=lab_environment(), capture_output=True, text=True, timeout=DEADLINE, check=False,
    )  # fmt: skip
    assert result.returncode == 1
    assert result.stdout.splitlines()[-1] == (
        "[ERROR] [launch]: Caught exception in launch (see debug for traceback): "
        "status_period:=often is not a number of seconds, such as 0.5"
    )
    assert result.stderr == ""


def test_help_comes_without_the_library() -> None:
    code = (
        "import sys; from portable_ros2.command import parser_of; parser_of(['launch']);"
        "print([m for m in ('launch', 'yaml', 'asyncio', 'rclpy') if m in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout == "[]\n"
