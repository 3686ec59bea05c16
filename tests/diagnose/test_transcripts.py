"""What a terminal shows, command by command: what did well is no fault, whatever a tool warns of, and whoever runs now."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files, Names

from ros2lab.diagnose import of_text

WARNED = "/ws/src/my_bot/test/test_it.py:25: UserWarning: this is slow\n    warnings.warn('this is slow', UserWarning)\n"
TESTED = """\
$ colcon test --event-handlers console_direct+
Starting >>> my_bot
=================================================== warnings summary ===================================================
test/test_it.py::test_it
  {warned}
-- Docs: https://docs.pytest.org/en/stable/how-to/capture-warnings.html
================================== {counts} in 0.43s ==================================
Finished <<< my_bot [7.13s]

Summary: 1 package finished [8.14s]
{more}"""
LICENSE = """\
$ ros2 pkg create --build-type ament_python my_bot
going to create a new package
creating ./my_bot/my_bot/__init__.py

[WARNING]: Unknown license 'TODO: License declaration'.  This has been set in the package.xml, but no LICENSE file has been created.
It is recommended to use one of the ament license identifiers:
Apache-2.0
"""
BUILT = """\
$ colcon build
Starting >>> my_bot
--- stderr: my_bot
/usr/lib/python3/dist-packages/setuptools/command/install.py:34: SetuptoolsDeprecationWarning: setup.py install is deprecated.
  warnings.warn(
---
Finished <<< my_bot [1.39s]

Summary: 1 package finished [1.53s]
  1 package had stderr output: my_bot
"""
DID_WELL = {
    "a graph that was there": (
        "$ ros2 node list\n/talker\n$ ros2 node info /talker\n/talker\n  Subscribers:\n\n  Publishers:\n    /rosout: rcl_interfaces/msg/Log\n"
        "$ ros2 param get /talker period\nDouble value is: 2.0\n$ ros2 param list /talker\n  period\n  use_sim_time\n"
    ),
    "a node that the workspace does not have": "$ ros2 node info /turtlesim\n/turtlesim\n  Subscribers:\n    /turtle1/cmd_vel: geometry_msgs/msg/Twist\n$ ros2 param get /turtlesim background_r\nInteger value is: 69\n",
    "a topic that came at last": "$ ros2 topic hz /robot/status\nWARNING: topic [/robot/status] does not appear to be published yet\naverage rate: 0.500\n\tmin: 2.000s max: 2.000s std dev: 0.00016s window: 2\n^C\n",
    "details with words that also errors have": "$ ros2 topic info -v /robot/status\nType: std_msgs/msg/String\n\nPublisher count: 1\n\nNode name: talker\nQoS profile:\n  History (Depth): UNKNOWN\n  Lifespan: Infinite\n\nSubscription count: 0\n",
    "a service that answered": "$ ros2 service call /reset std_srvs/srv/Trigger\nwaiting for service to become available...\nrequester: making request: std_srvs.srv.Trigger_Request()\n\nresponse:\nstd_srvs.srv.Trigger_Response(success=True, message='')\n",
    "an action that ended": "$ ros2 action send_goal /turn demo/action/Turn '{angle: 1.0}'\nWaiting for an action server to become available...\nSending goal:\n     angle: 1.0\n\nGoal accepted with ID: 1f\n\nResult:\n    done: true\n\nGoal finished with status: SUCCEEDED\n",
    "comments of a definition": "$ ros2 interface show std_msgs/msg/Float64\n# This was originally provided as an example message.\n# it's deprecated, so don't use it\n\nfloat64 data\n",
    "a warning of the test itself": TESTED.format(
        warned=WARNED, counts="6 passed, 1 skipped, 1 xfailed, 1 warning", more=""
    ),
    "a warning of a library": TESTED.format(
        warned="/usr/lib/python3/dist-packages/x.py:3: DeprecationWarning: old\n    import y",
        counts="6 passed, 1 warning",
        more="",
    ),
    "results without failures": TESTED.format(
        warned=WARNED,
        counts="1 passed, 1 warning",
        more="$ colcon test-result --all\nbuild/my_bot/pytest.xml: 8 tests, 0 errors, 0 failures, 2 skipped\n\nSummary: 8 tests, 0 errors, 0 failures, 2 skipped\n",
    ),
    "a new package": LICENSE,
    "a new package, built and asked for": f"{LICENSE}{BUILT}$ ros2 pkg executables my_bot\n",
    "a build with a warning of setuptools": BUILT,
    "a node that warns": f"$ ros2 run my_bot talker\n{WARNED}[WARN] [talker]: battery low\n[INFO] [talker]: running 0\n^C\n",
}


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return Files.right(NAMES[1]).write(tmp_path)


@pytest.mark.parametrize("name", DID_WELL)
@pytest.mark.parametrize("is_in_workspace", [True, False])
def test_what_did_well_is_no_fault(name: str, is_in_workspace: bool, root: Path) -> None:
    assert of_text(DID_WELL[name], root if is_in_workspace else None) == []


def test_a_warning_of_ones_own_code_is_known_by_its_words(root: Path) -> None:
    """With a stacklevel, Python names the line of who called what gives the warning."""
    file = root / "src/my_bot/my_bot/talker.py"
    file.write_text(
        f"import warnings\n{file.read_text()}\n\ndef slow(n):\n    warnings.warn(f'the sieve is slow for {{n}}', stacklevel=2)\n"
    )
    text = f"$ ros2 run my_bot talker\n{file}:20: UserWarning: the sieve is slow for 7\n  slow(7)\n[INFO] [talker]: running 0\n"
    assert of_text(text, root) == []


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        # Nobody answered, or something else than was asked for.
        ("$ ros2 node list\n/ears\n$ ros2 node info /talker\nUnable to find node '/talker'\n", "not-running", "/talker"),
        ("$ ros2 node info /talkr\nUnable to find node '/talkr'\n", "typed-wrong", "/talker"),
        ("$ ros2 param get /talker perod\nParameter not set\n$ ros2 param get /talker perod\nError: Parameter not set.\n", "parameter-name", "period"),
        ("$ ros2 topic echo /robot/status\nWARNING: topic [/robot/status] does not appear to be published yet\n", "not-running", "/robot/status"),
        ("$ ros2 service call /reset std_srvs/srv/Trigger\nwaiting for service to become available...\n", "not-running", "/reset"),
        # One command did well, and another one did not, whatever is noted below it.
        ("$ ros2 topic pub --once /robot/status std_msgs/msg/String '{text: a}'\nFailed to populate field: std_msgs/msg/String has no field 'text'\n# terminal 2\n$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n^C\n", "typed-wrong", "data"),
        (f"{BUILT}$ ros2 run my_bot tlaker\nNo executable found\n", "executable-missing", "talker"),
        (f"$ ros2 run my_bot tlaker\nNo executable found\n{DID_WELL['a graph that was there']}", "executable-missing", "talker"),
        (f"{LICENSE}$ ros2 topic eco /robot/status\nros2 topic: error: argument: invalid choice: 'eco' (choose from 'echo', 'hz')\n", "typed-wrong", "echo"),
        # What tools warn of, and what is known of it.
        ("$ colcon build --packages-select my_bto\n[0.5s] WARNING:colcon.colcon_core.package_selection:ignoring unknown package 'my_bto' in --packages-select\n\nSummary: 0 packages finished [0.1s]\n", "typed-wrong", "my_bot"),
        ("$ colcon build --packages-select my_bto\n[0.5s] WARNING:colcon.colcon_core.package_selection:ignoring unknown package 'my_bto' in --packages-select\n\nSummary: 0 packages finished [0.1s]\n$ ros2 run my_bot status\ntimeout: failed to run command\n", "typed-wrong", "type `colcon build --packages-select my_bot`"),
    ],
)  # fmt: skip
def test_what_did_not_is_told(text: str, code: str, said: str, root: Path) -> None:
    first = of_text(text, root)[0]
    assert first.code == code
    assert said in f"{first.cause} {first.fix}"


def test_a_test_that_pytest_doubts_is_a_hint_in_a_run_that_ended_well(root: Path) -> None:
    warned = "/usr/lib/python3/dist-packages/_pytest/python.py:191: PytestReturnNotNoneWarning: Test functions should return None, but test/test_it.py::test_it returned bool.\n    warnings.warn("
    (finding,) = of_text(TESTED.format(warned=warned, counts="1 passed, 1 warning", more=""), root)
    assert "succeeded" in finding.cause
    assert "should return None" in finding.cause


def test_a_fix_is_of_the_command_that_said_it(root: Path) -> None:
    text = "$ ros2 bag play mine\nFailed to open the bag: no metadata\n$ ros2 pkg executables my_bot\nmy_bot talker\n"
    assert all("pkg executables" not in one.fix for one in of_text(text, root))


GIT = '$ git commit -am "fix error handling"\n[main 3f1a] fix error handling\n 1 file changed\n'
CMAKE = "$ colcon build\nStarting >>> demo\n--- stderr: demo\nCMake Warning at CMakeLists.txt:12 (message):\n  optional dependency not found, building without it\n\n\n---\nFinished <<< demo [8.1s]\n\nSummary: 1 package finished [9.0s]\n"
LATER = "$ ros2 launch my_bot robot.launch.py\n[INFO] [talker-1]: process started with pid [23]\n[talker-1] {file}:12: DeprecationWarning: There is no current event loop\n[talker-1]   loop = get_event_loop()\n[talker-1] [INFO] [1795792826.1] [talker]: running 0\n^C[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)\n"


@pytest.mark.parametrize("text", [GIT, CMAKE, LATER, GIT + CMAKE])
def test_words_of_errors_are_no_errors_by_themselves(text: str, root: Path) -> None:
    assert of_text(text.replace("{file}", f"{root}/src/my_bot/my_bot/talker.py"), root) == []


def test_what_python_only_warns_of_has_stopped_nothing(root: Path) -> None:
    file = root / "src/my_bot/my_bot/talker.py"
    (finding,) = of_text(
        f"$ ros2 run my_bot talker\n{file}:16: RuntimeWarning: divide by zero encountered\n  a / b\n", root
    )
    assert finding.cause == "Python warns: divide by zero encountered."
    assert finding.place == "src/my_bot/my_bot/talker.py:16"


@pytest.mark.parametrize("name", ["# terminal 2", "student@pc:~/ws$ ls"])
def test_a_comment_is_no_command_beside_prompts(name: str, root: Path) -> None:
    text = f"{name}\n$ ros2 interface show sensor_msgs/msg/Imu\n# it's the covariance that isn't known\n\nfloat64 x\n"
    assert of_text(text, root) == []


def test_a_word_is_put_right_where_it_stands_alone(tmp_path: Path) -> None:
    root = Files.right(Names("nave", "nave")).write(tmp_path)
    first = of_text("$ ros2 run nave nav\nNo executable found\n", root)[0]
    assert first.fix == "type `ros2 run nave nave`"
