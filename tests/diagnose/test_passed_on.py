"""What tools, shells and Python say well themselves: printed by the real ones, explained, and mended as is said."""

from __future__ import annotations

import io
import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text
from ros2lab.diagnose.finding import SAID
from ros2lab.diagnose.printed.error_text import MOST_READ, read_error, read_printed
from ros2lab.environment import lab_environment


def typed(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Type a command in bash, with both streams in one."""
    return subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env=lab_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    return Files.right(NAMES[1]).write(tmp_path / "ws")


def explained(text: str, workspace: Path) -> Finding:
    (finding,) = of_text(text, workspace)
    assert finding.code in (SAID, "python-error", "executable-unusable")
    return finding


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("ros2 topic lst -h", "list"),
        ("ros2 interfac list -h", "interface"),
        ("colcon lst --names-only", "list"),
        ("ros2 pkg creat x -h", "create"),
        ("ehco hello", "echo"),
        ("cat src/my_bto/package.xml", "src/my_bot/package.xml"),
        ("cat package.xml", "src/my_bot/package.xml"),
        ("cd scr", "src"),
        ("python3 -m py_compile talker.py", "src/my_bot/my_bot/talker.py"),
    ],
)
def test_the_nearest_right_word_is_told_and_works(workspace: Path, wrong: str, right: str) -> None:
    done = typed(wrong, workspace)
    assert done.returncode != 0
    fix = explained(done.stdout, workspace).fix
    assert fix.startswith(f"write {right}")
    again = typed(wrong.replace(_wrong_word(wrong, right), right), workspace)
    assert "No such file" not in again.stdout
    assert "invalid choice" not in again.stdout
    assert "not found" not in again.stdout


def _wrong_word(wrong: str, right: str) -> str:
    import difflib

    return difflib.get_close_matches(right, wrong.split(), 1, 0.3)[0]


def test_a_script_is_run_after_its_mends(workspace: Path) -> None:
    """Not marked as a program, then with the line ends of Windows, then without a first line."""
    script = workspace / "hello.py"
    script.write_bytes(b"#!/usr/bin/env python3\r\nimport sys\r\nprint('hello')\r\n")
    if os.getuid() == 0 or not os.access(script, os.X_OK):
        first = explained(typed("./hello.py", workspace).stdout, workspace)
        assert first.fix.startswith("chmod +x ./hello.py")
        typed("chmod +x ./hello.py", workspace)
    second = explained(typed("./hello.py", workspace).stdout, workspace)
    typed(second.fix, workspace)
    assert typed("./hello.py", workspace).stdout == "hello\n"
    script.write_text("import sys\nprint('hello')\n")
    third = explained(typed("./hello.py", workspace).stdout, workspace)
    assert "python3 ./hello.py" in third.fix
    assert typed("python3 ./hello.py", workspace).stdout == "hello\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("ros2 run: error: the following arguments are required: executable_name, argv", "add executable_name"),
        ("usage: ros2 topic hz [--window N]\nros2: error: unrecognized arguments: --windw 3", "write --window"),
        ("ros2: error: unrecognized arguments: hi}", "in quotes"),
        ("ros2 topic hz: error: argument --window/-w: expected one argument", "-h"),
        ("Unknown topic '/robot/statuss'", "write robot/status"),
        ("Unable to find node '/tallker'", "write /talker"),
        ("malformed launch argument 'speed:0.3', expected format '<name>:=<value>'", "<name>:=<value>"),
        ("[0.5s] WARNING:colcon.colcon_core.package_selection:ignoring unknown package 'my_bto' in --packages-select", "write my_bot"),
        ("The passed message type is invalid: the package 'std_msgs' has no 'msg/Sting'; did you mean 'String'?", "write String"),
        ("sh: 1: source: not found", "bash"),
        ("colcon: error: unrecognized arguments: --symlink_install", "write --symlink-install"),
        ("fatal: not a git repository (or any of the parent directories): .git", ""),
        ("ERROR: Could not find a version that satisfies the requirement rclpyy (from versions: none)", ""),
        ("zsh: command not found: pythn3", "write python3"),
        ("bash: import: command not found", "python3"),
    ],
)  # fmt: skip
def test_what_a_tool_says_is_passed_on(workspace: Path, text: str, said: str) -> None:
    assert said in explained(text, workspace).fix


@pytest.mark.parametrize(
    ("typed_line", "printed", "meant"),
    [
        (
            "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}, angular: {z: 0.2}'",
            "The passed value is not valid YAML at line 1, column 37: expected ',' or '}', but got '<stream end>'",
            "ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.5}, angular: {z: 0.2}}'",
        ),
        ("ros2 interface show std_msgs/String", "Invalid name 'std_msgs/String'. Expected three parts separated by '/'", "ros2 interface show std_msgs/msg/String"),
        (
            "ros2 run my_bot talker --ros-args -r __ns:=robot1",
            "rclpy._rclpy_pybind11.RCLError: failed to initialize rcl: Couldn't parse remap rule: '-r __ns:=robot1'.",
            "ros2 run my_bot talker --ros-args -r __ns:=/robot1",
        ),
        *(
            (f"ros2 run my_bot talker --ros-args {typed} -p loud:=true", f"RCLError: failed to initialize rcl: Couldn't parse parameter override rule: '{said}'.", f"ros2 run my_bot talker --ros-args {meant} -p loud:=true")
            for typed, said, meant in (
                ("-p period:= 2.5", "-p period:=", "-p period:=2.5"),
                ("-p period :=-2.5", "-p period", "-p period:=-2.5"),
                ("-p period: =2.5", "-p period:", "-p period:=2.5"),
                ("-p period=2.5", "-p period=2.5", "-p period:=2.5"),
                ("-p period 2.5", "-p period", "-p period:=2.5"),
                ("-r talker:chatter := /a", "-r talker:chatter", "-r talker:chatter:=/a"),
            )
        ),
        ("ros2 run my_bot talker --log-level debug", "[INFO] [talker]: running 0", "ros2 run my_bot talker --ros-args --log-level debug"),
        (
            "ros2 run my_bot talker --ros-args --params-file robot.yaml",
            "RCLError: failed to initialize rcl: Couldn't parse params file: '--params-file robot.yaml'. Error: Error opening YAML file, at /src/parser.c:271",
            "ros2 run my_bot talker --ros-args --params-file src/my_bot/config/robot.yaml",
        ),
        (
            "ros2 pkg create --build-type ament_python --dependencies rclpy std_msgs my_tools",
            "ros2 pkg create: error: the following arguments are required: package_name",
            "ros2 pkg create --build-type ament_python my_tools --dependencies rclpy std_msgs",
        ),
    ],
)  # fmt: skip
def test_the_command_that_was_meant_is_told(
    workspace: Path, typed_line: str, printed: str, meant: str
) -> None:
    first = of_text(f"student$ {typed_line}\n{printed}\n", workspace)[0]
    assert first.fix == f"type `{meant}`"


@pytest.mark.parametrize(
    ("wrong", "path", "right"),
    [
        ("ros2 bag record -o src /x", "src", "type `ros2 bag record -o src_2 /x`"),
        ("mkdir src", "src", "type `mkdir src_2`"),
        ("ln -s src/my_bot src/my_bot/setup.py", "src/my_bot/setup.py", "mv src/my_bot/setup.py"),
        ("git init -q other.git; git clone other.git src", "src", "mv src src_old"),
    ],
)
def test_what_a_command_should_make_exists_already(
    workspace: Path, wrong: str, path: str, right: str
) -> None:
    """It may be kept, be given another name, or be moved away; nothing is removed."""
    finding = explained(f"student$ {wrong}\n{typed(wrong, workspace).stdout}", workspace)
    assert finding.cause.startswith(f"{path} exists already")
    assert right in finding.fix


def test_a_bag_that_exists_is_told_without_its_command_and_what_a_node_says_is_not(workspace: Path) -> None:
    said = "[ERROR] [ros2bag]: Output folder 'lap' already exists."
    assert explained(said, workspace).cause.startswith("lap exists already")
    (finding,) = of_text(f"$ ros2 run my_bot talker\n{said.replace('ros2bag', 'talker')}", workspace)
    assert "exists already" not in finding.cause


def test_a_folder_that_a_program_makes_twice(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change(
        "my_bot/talker.py", "import rclpy\n", "import os\n\nimport rclpy\n\nos.mkdir('log')\n"
    )
    workspace = files.write(tmp_path / "ws")
    text = typed("mkdir log; PYTHONPATH=src/my_bot:$PYTHONPATH python3 -c 'import my_bot.talker'", workspace)
    finding = explained(text.stdout, workspace)
    assert "os.makedirs('log', exist_ok=True)" in finding.fix
    assert finding.place.startswith("src/my_bot/my_bot/talker.py:")


def test_a_command_that_did_what_it_was_told(workspace: Path) -> None:
    """A package that was made just now is no reason for another name."""
    text = typed("cd src && ros2 pkg create --build-type ament_python mine", workspace).stdout
    found = of_text(f"student$ ros2 pkg create --build-type ament_python mine\n{text}", workspace)
    assert not any("a different name" in one.cause for one in found)


def test_a_path_that_is_right_elsewhere(workspace: Path) -> None:
    """Typed in another folder, or before the build."""
    text = typed("source install/setup.bash", workspace / "src").stdout
    assert explained(text, workspace).fix.startswith(f"cd {workspace}, run colcon build")
    text = typed("cat src/my_bot/package.xml", workspace / "src").stdout
    fix = explained(text, workspace).fix
    assert fix.startswith(f"cd {workspace}, and type it again")
    assert "<package" in typed("cat src/my_bot/package.xml", workspace).stdout


def test_an_executable_of_an_earlier_build(tmp_path: Path) -> None:
    """Its traceback ends in StopIteration, which says nothing; the workspace knows that nothing names it now."""
    files = Files.right(NAMES[1])
    index = "install/my_bot/share/ament_index/resource_index/packages/my_bot"
    files.texts |= {index: "", "install/my_bot/lib/my_bot/old": "load_entry_point('console_scripts')"}
    workspace = files.write(tmp_path / "ws")
    text = (
        f'Traceback (most recent call last):\n  File "{workspace}/install/my_bot/lib/my_bot/old", line 33, in <module>\n'
        "    sys.exit(load_entry_point())\nStopIteration\n[ros2run]: Process exited with failure 1"
    )
    (finding,) = of_text(text, workspace)
    assert finding.code == "left-over"
    assert finding.fix.startswith("rm install/my_bot/lib/my_bot/old")


def test_packages_that_need_each_other(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("package.xml", "<depend>rclpy<", "<depend>second<")
    second = Files.right(replace(NAMES[1], package="second")).change("package.xml", "rclpy", "my_bot")
    files.texts |= second.texts
    workspace = files.write(tmp_path / "ws")
    text = typed("colcon build --event-handlers log-", workspace).stdout
    first = of_text(text, workspace)[0]
    assert (first.code, first.place) in (
        ("dependency-circle", "src/second/package.xml:8"),
        ("dependency-circle", "src/my_bot/package.xml:8"),
    )
    folder, wanted = ("second", "my_bot") if "second" in first.place else ("my_bot", "second")
    assert first.fix.startswith(f"remove the dependency on {wanted} from the package.xml of {folder}")
    manifest = workspace / "src" / folder / "package.xml"
    manifest.write_text(manifest.read_text().replace(f"<depend>{wanted}</depend>", ""))
    assert "topologically" not in typed("colcon list -t", workspace).stdout


def test_a_module_is_told_by_the_nearest_name(workspace: Path) -> None:
    for text, right in (
        ("rclpy.nod", "rclpy.node"),
        ("std_msgs.mgs", "std_msgs.msg"),
        ("std_msg", "std_msgs"),
    ):
        (finding,) = of_text(f"ModuleNotFoundError: No module named '{text}'", workspace)
        assert finding.fix == f"write {right}"


@pytest.mark.parametrize(
    "text",
    [
        "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='error')\n\npublishing #2: x\n",
        "data: hello\n---\ndata: again\n---\n^C",
        "linear:\n  x: 0.5\n  y: 0.0\nangular:\n  z: 0.0\n---",
        "$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n^C[ros2run]: Interrupt",
        "$ ros2 launch my_bot robot.launch.py\n[INFO] [launch]: Default logging verbosity is set to INFO\n^C[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)",
        "anna@pc:~/ws$ ros2 topic list\n/parameter_events\n/rosout",
        '[ears-2] Traceback (most recent call last):\n[ears-2]   File "/x/ears.py", line 18, in main\n[ears-2]     rclpy.spin(node)\n[ears-2] KeyboardInterrupt',
        "^CTraceback (most recent call last):\n  raise ExternalShutdownException()\nrclpy.executors.ExternalShutdownException\n[ros2run]: Process exited with failure 1",
        "[INFO] [n]: bye\nFailed to publish log message to rosout: publisher's context is invalid, at ./src/rcl/publisher.c:423\n",
    ],
)
def test_what_is_harmless_is_no_error(workspace: Path, text: str) -> None:
    assert of_text(text, workspace) == []


FRAMES = """\
Traceback (most recent call last):
  File "/ws/install/my_bot/lib/my_bot/talker", line 33, in <module>
    sys.exit(load_entry_point('my-bot==0.1.0', 'console_scripts', 'talker')())
  File "/ws/{where}/my_bot/talker.py", line 19, in tick
    self.get_logger().info(msg.data)
  File "/home/anna/ws/.venv/lib/python3.11/site-packages/{inner}.py", line 382, in _execute
    await await_or_execute(tmr.callback)
"""


PLACES = ["install/my_bot/lib/python3.11/site-packages", "build/my_bot", "src/my_bot"]
INNER = ["rclpy/executors", "installer", "yaml/install/__init__"]
ERRORS = [
    ("PermissionError: [Errno 13] Permission denied: '/opt/log.csv'", "/opt/log.csv"),
    ("FileNotFoundError: [Errno 2] No such file or directory: 'robt.yaml'", "config/robot.yaml"),
    ("IsADirectoryError: [Errno 21] Is a directory: '/opt'", "/opt"),
    ("KeyError: 'x'", "self.count += 1"),
    ("IndexError: list index out of range", "self.count += 1"),
]


@pytest.mark.parametrize(
    ("where", "inner", "error", "cause"),
    [
        # Each place, each inner frame and each error once; all with all are thorough.
        pytest.param(where, inner, *error, marks=() if i % 3 == j == k else pytest.mark.thorough)
        for i, error in enumerate(ERRORS)
        for j, inner in enumerate(INNER)
        for k, where in enumerate(PLACES)
    ],
)
def test_the_place_is_in_the_students_own_file(
    workspace: Path, where: str, inner: str, error: str, cause: str
) -> None:
    """Whatever of it was installed, and never in a package that is not the student's; in a launch, too."""
    text = FRAMES.format(where=where, inner=inner) + error
    launched = "\n".join(f"[talker-1] {line}" for line in text.splitlines())
    mixed = launched.replace("\n", "\n[ears-2] [INFO] [ears]: hello\n")
    for one in (text, launched, mixed):
        finding = explained(one, workspace)
        assert finding.place == "src/my_bot/my_bot/talker.py:19"
        assert cause in finding.cause


def test_an_error_in_a_setup_script_is_found_below_colcons_own(workspace: Path) -> None:
    setup = workspace / "src/my_bot/setup.py"
    setup.write_text(setup.read_text().replace("version='0.1.0'", "version='0.1.0' % {}['x']"))
    done = typed("colcon build", workspace)
    finding = explained(done.stdout, workspace)
    assert finding.place.startswith("src/my_bot/setup.py:")
    assert "'x'" in finding.cause


def test_an_error_of_a_launch_file_is_the_one_below_launchs_own(workspace: Path) -> None:
    text = (
        "[INFO] [launch]: Default logging verbosity is set to INFO\n[ERROR] [launch]: Caught exception in launch (see "
        "debug for traceback): Caught multiple exceptions when trying to load file of format [py]:\n"
        " - SyntaxError: '(' was never closed (robot.launch.py, line 10)\n"
        " - InvalidFrontendLaunchFileError: The launch file may have a syntax error, or its format is unknown"
    )
    (finding,) = of_text(text, workspace)
    assert finding.code == "node-syntax"
    assert finding.place.endswith("robot.launch.py:10")


@pytest.mark.parametrize(
    ("made", "kind"),
    [
        ("GroupAction([talker])", "a GroupAction"),
        ("TimerAction(period=1.0, actions=[talker])", "a TimerAction"),
        ("LogInfo(msg='on')", "a LogInfo"),
    ],
)
def test_a_value_that_launch_refuses_is_told_by_the_name_under_which_it_was_given(
    workspace: Path, made: str, kind: str
) -> None:
    launch_file = workspace / "src/my_bot/launch/robot.launch.py"
    launch_file.write_text(f"""\
from launch import LaunchDescription
from launch.actions import GroupAction, LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessStart
from launch_ros.actions import Node


def generate_launch_description():
    talker = Node(package='my_bot', executable='talker')
    first = {made}
    after = OnProcessStart(target_action=first, on_start=[talker])
    return LaunchDescription([first, RegisterEventHandler(after)])
""")
    said = "action_matcher must be an 'ExecuteProcess' instance or a callable"
    text = (
        "$ ros2 launch my_bot robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for traceback): "
        f"Caught multiple exceptions when trying to load file of format [py]:\n - TypeError: {said}\n"
        " - InvalidFrontendLaunchFileError: The launch file may have a syntax error, or its format is unknown"
    )
    (finding,) = of_text(text, workspace)
    assert finding.place == "src/my_bot/launch/robot.launch.py:10"
    assert finding.cause.endswith(
        f"{said.replace('action_matcher', 'target_action')}, but OnProcessStart gets {kind}."
    )
    assert finding.fix == "give target_action an 'ExecuteProcess' instance or a callable (such as a Node)"


@pytest.mark.parametrize(
    ("path", "name", "code", "said"),
    [
        ("my_bot/limits.py", "limits", "import-wrong", "my_bot.limits"),
        ("my_bot/tools/limits.py", "tools.limits", "import-wrong", "my_bot.tools.limits"),
        ("my_bot/limits.py", "my_bot.limits", "install-stale", "colcon build --packages-select my_bot"),
        (
            "my_bot/tools/limits.py",
            "my_bot.tools",
            "init-file-missing",
            "touch src/my_bot/my_bot/tools/__init__.py",
        ),
        ("my_bot/limits.py", "limitz", "entry-point-module", "compare it with the file"),
        ("my_bot/limits.py", "serial", "module-missing", "install the library that provides serial"),
    ],
)
def test_a_module_of_ones_own_that_python_does_not_find_is_looked_for(
    workspace: Path, path: str, name: str, code: str, said: str
) -> None:
    file = workspace / "src/my_bot" / path
    file.parent.mkdir(exist_ok=True)
    file.write_text("LIMIT = 1.0\n")
    node = workspace / "src/my_bot/my_bot/talker.py"
    written = f"from {name}{'.limits' if code == 'init-file-missing' else ''} import LIMIT\n"
    node.write_text(f"{written}{node.read_text()}")
    error = f"ModuleNotFoundError: No module named '{name}'"
    finding, *_ = of_text(
        f'Traceback (most recent call last):\n  File "{node}", line 1, in <module>\n    {written}{error}\n',
        workspace,
    )
    assert (finding.code, said in finding.fix) == (code, True)


def test_a_blank_that_yaml_wants_is_asked_for(workspace: Path) -> None:
    command = 'ros2 topic pub --once /cmd_vel geometry_msgs/msg/Twist "{linear: {x:0.5}}"'
    (finding,) = of_text(typed(command, workspace).stdout, workspace)
    assert finding.fix == "write x: 0.5"


def test_a_kernel_that_has_sourced_nothing_is_told_from_a_terminal(workspace: Path) -> None:
    text = (
        "ModuleNotFoundError                       Traceback (most recent call last)\n"
        "Cell In[1], line 1\n----> 1 from my_bot.talker import Talker\n\n"
        "ModuleNotFoundError: No module named 'my_bot'\n"
    )
    (finding,) = of_text(text, workspace)
    assert (finding.code, "%%terminal" in finding.fix) == ("not-sourced", True)


@pytest.mark.parametrize(
    ("line", "error", "fix"),
    [
        (
            "from time import time; time.sleep(1)",
            "'builtin_function_or_method' object has no attribute 'sleep'",
            "import time",
        ),
        ("self.timer.stop()", "'Timer' object has no attribute 'stop'", "cancel"),
        ("self.out.send(msg)", "'Publisher' object has no attribute 'send'", "publish"),
    ],
)
def test_what_an_object_has_in_place_of_what_it_lacks_is_told(
    workspace: Path, line: str, error: str, fix: str
) -> None:
    node = workspace / "src/my_bot/my_bot/talker.py"
    node.write_text(f"{line}\n{node.read_text()}")
    text = f'Traceback (most recent call last):\n  File "{node}", line 1, in <module>\n    {line}\nAttributeError: {error}\n'
    finding, *_ = of_text(text, workspace)
    assert fix in finding.cause + finding.fix


def test_of_a_very_long_text_the_beginning_and_the_end_are_read() -> None:
    lines = "".join(f'  File "/ws/src/{number}.py", line 7, in f\n' for number in range(300_000))
    text = f"$ ros2 run first node\n{lines}NameError: name 'last' is not defined\n"
    printed = read_printed(io.BytesIO(text.encode()))
    assert len(printed) <= 2 * MOST_READ
    for error in (read_error(text), read_error(printed)):
        assert error.decisive == "NameError: name 'last' is not defined"
        assert error.typed == ("ros2 run first node",)


@pytest.mark.parametrize(
    ("guard", "printed", "is_told"),
    [
        ("try:\n    import fast_sky\nexcept ImportError as error:\n    print(f'{error}: slow')\n", "No module named 'fast_sky': slow", False),
        ("try:\n    from fast_sky.core import stars\nexcept ImportError:\n    stars = None\n", "[WARN] [talker]: No module named 'fast_sky'", False),
        ("import fast_sky\n", "ModuleNotFoundError: No module named 'fast_sky'", True),
        ("try:\n    import fast_sky\nexcept KeyError:\n    pass\n", "Traceback (most recent call last):\n  File \"talker.py\", line 2, in <module>\n    import fast_sky\nModuleNotFoundError: No module named 'fast_sky'", True),
    ],
)  # fmt: skip
def test_an_import_that_the_program_has_caught_is_no_error(
    workspace: Path, guard: str, printed: str, is_told: bool
) -> None:
    node = workspace / "src/my_bot/my_bot/talker.py"
    node.write_text(f"{guard}{node.read_text()}")
    found = of_text(f"$ ros2 run my_bot talker\n{printed}\n", workspace)
    assert any("fast_sky" in finding.cause for finding in found) == is_told


@pytest.mark.parametrize(
    ("line", "right"),
    [
        ("export ROS_DOMAIN_ID = 42", "export ROS_DOMAIN_ID=42"),
        ("export ROS_DOMAIN_ID =42", "export ROS_DOMAIN_ID=42"),
        ("export ROS_DOMAIN_ID= 42", "export ROS_DOMAIN_ID=42"),
        ("ROS_DOMAIN_ID = 42", "export ROS_DOMAIN_ID=42"),
        ("declare -x ROS_DOMAIN_ID = '42'", "declare -x ROS_DOMAIN_ID='42'"),
        ("alias cb = 'colcon build'", "alias cb='colcon build'"),
    ],
)
def test_an_assignment_has_no_blanks_beside_its_sign(workspace: Path, line: str, right: str) -> None:
    """The shell's own line is explained, in a script that it names, in one that it does not name, and as it was typed."""
    (workspace / "setup_robot.sh").write_text(f"# the lab\nexport LAB=1\n{line}\n")
    said = typed("source ./setup_robot.sh", workspace).stdout
    for text in (said, re.sub(r"\./setup_robot\.sh: line \d+", "bash", said)):
        found = explained(f"$ source setup_robot.sh\n{text}", workspace)
        assert (found.place, found.fix) == ("setup_robot.sh:3", f"write `{right}`")
    (found,) = of_text(f"$ {line}\n{typed(line, workspace).stdout.replace('line 1: ', '')}", workspace)
    assert "no blank stands before or after the =" in found.cause
    assert (found.place, found.fix) == ("", f"type `{right}`")


@pytest.mark.parametrize("line", ["export ROS-DOMAIN-ID=42", "export 2ROBOT=x", "export $NOT_SET=42"])
def test_what_a_shell_takes_for_no_name_is_told_where_it_stands(workspace: Path, line: str) -> None:
    (workspace / "setup_robot.sh").write_text(f"\n{line}\n")
    found = explained(typed("source ./setup_robot.sh", workspace).stdout, workspace)
    assert (found.place, found.fix[:16]) == ("setup_robot.sh:2", "write NAME=value")


@pytest.mark.parametrize(
    "line",
    ["export ROS_DOMAIN_ID", "export RMW= # default", "ROS_DOMAIN_ID= ros2 topic list", "test $A = 42"],
)
def test_what_a_shell_takes_is_left_alone(workspace: Path, line: str) -> None:
    assert not of_text(f"$ {line}\n$ ros2 run my_bot status_publisher\n", workspace)
