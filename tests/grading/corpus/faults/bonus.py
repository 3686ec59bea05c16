"""Faults of what is done for the bonus: they cost the bonus, and no points."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import bonus_fault, both
from corpus.package import COMMAND, LAUNCH, README, README_TEXT, SETUP, STATUS, TESTS, VELOCITY, YAML, P
from corpus.tree import Change, drop, edit, put


def _launch(
    name: str, change: Change, cause: str, about: str, *costs: str, unreadable: tuple[str, ...] = ()
) -> Case:
    """The launch file does not start all three; what it would hand over is not seen, either, if `costs` says so."""
    return bonus_fault("launch", name, change, cause, about, costs=costs, unreadable=unreadable)


def _yaml(name: str, change: Change, cause: str, about: str, *costs: str) -> Case:
    return bonus_fault("parameter_file", name, change, cause, about, costs=costs)


_VELOCITY_NODE = (
    "        Node(package='robot_controller', executable='velocity_publisher', parameters=[config]),\n"
)
_NO_LAUNCH_IN_README = put(
    README,
    README_TEXT.replace(
        "All together:\n\n```bash\nros2 launch robot_controller robot.launch.py\n```\n\nOr each", "Each"
    ),
)

LAUNCHING: tuple[Case, ...] = (
    _launch(
        "launch_missing",
        both(drop(LAUNCH), _NO_LAUNCH_IN_README),
        r"launch",
        "there is none",
        "parameter_file",
    ),
    _launch(
        "launch_not_installed",
        edit(SETUP, "        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),\n", ""),
        r"not-in-data-files|data_files|install",
        "ros2 launch looks in install, and not in src",
        "parameter_file",
    ),
    _launch(
        "launch_wrong_executable",
        edit(LAUNCH, "executable='command_subscriber'", "executable='command_listener'"),
        r"command_listener|launch-executable",
        "there is no such executable",
    ),
    _launch(
        "launch_wrong_package",
        edit(
            LAUNCH,
            "package='robot_controller', executable='command",
            "package='robot_control', executable='command",
        ),
        r"robot_control\b|launch-package",
        "there is no such package",
    ),
    _launch(
        "launch_only_two",
        edit(LAUNCH, _VELOCITY_NODE, ""),
        r"two|2|three|velocity|cmd_vel",
        "one node is not started",
        "parameter_file",
    ),
    _launch(
        "launch_same_thrice",
        edit(LAUNCH, "executable='command_subscriber'", "executable='status_publisher'"),
        r"command|three|twice|status",
        "one node is started twice and another not",
    ),
    _launch(
        "launch_syntax",
        edit(LAUNCH, "    ])\n", "    )\n"),
        r"launch-syntax|robot\.launch\.py",
        "a bracket is not closed",
        "parameter_file",
        unreadable=("robot.launch.py",),
    ),
    _launch(
        "launch_function_misnamed",
        edit(LAUNCH, "def generate_launch_description", "def generate_launch_descriptions"),
        r"generate_launch_description|launch-function",
        "ros2 launch calls generate_launch_description",
        "parameter_file",
    ),
    _launch(
        "launch_returns_nothing",
        edit(LAUNCH, "    return LaunchDescription([", "    LaunchDescription(["),
        r"launch|return|None",
        "the description is made and not returned",
        "parameter_file",
    ),
    _launch(
        "launch_import_missing",
        edit(LAUNCH, "from launch_ros.actions import Node\n", ""),
        r"Node|launch",
        "NameError",
        "parameter_file",
    ),
    _launch(
        "launch_empty_list",
        put(
            LAUNCH,
            '"""Start the robot."""\nfrom launch import LaunchDescription\n\n\n'
            'def generate_launch_description():\n    """Return nothing to start."""\n    return LaunchDescription([])\n',
        ),
        r"launch|none|no node|three",
        "it starts nothing",
        "parameter_file",
    ),
)

CONFIGURING: tuple[Case, ...] = (
    _yaml(
        "yaml_missing",
        both(
            drop(YAML),
            edit(LAUNCH, "    config = os.path.join(share, 'config', 'robot.yaml')\n", "    config = {}\n"),
        ),
        r"YAML|parameter",
        "there is none",
    ),
    _yaml(
        "yaml_not_used",
        both(
            edit(
                LAUNCH,
                "executable='status_publisher', parameters=[config])",
                "executable='status_publisher')",
            ),
            edit(
                LAUNCH,
                "executable='velocity_publisher', parameters=[config])",
                "executable='velocity_publisher')",
            ),
        ),
        r"robot\.yaml|use|YAML",
        "the launch file does not hand it on",
    ),
    _yaml(
        "yaml_other_node",
        both(
            edit(YAML, "status_publisher:", "status_node:"),
            edit(YAML, "velocity_publisher:", "velocity_node:"),
        ),
        r"write status_publisher instead of status_node",
        "no node has these names",
    ),
    _yaml(
        "yaml_without_ros_parameters",
        put(
            YAML,
            "status_publisher:\n  timer_period: 1.0\nvelocity_publisher:\n  timer_period: 0.2\n  speed: 0.3\n",
        ),
        r"ros__parameters|parameter-file",
        "ros__parameters is missing",
        "launch",
    ),
    _yaml(
        "yaml_one_underscore",
        put(
            YAML,
            "status_publisher:\n  ros_parameters:\n    timer_period: 1.0\nvelocity_publisher:\n  ros_parameters:\n"
            "    timer_period: 0.2\n",
        ),
        r"ros__parameters|parameter-file",
        "one underscore is missing",
        "launch",
    ),
    _yaml(
        "yaml_indentation",
        put(
            YAML,
            "status_publisher:\n  ros__parameters:\n  timer_period: 1.0\nvelocity_publisher:\n  ros__parameters:\n"
            "  timer_period: 0.2\n",
        ),
        r"indent|ros__parameters|parameter-file",
        "the values stand beside ros__parameters, and not below it",
        "launch",
    ),
    _yaml(
        "yaml_tab",
        edit(YAML, "    speed: 0.3", "\tspeed: 0.3"),
        r"tab|parameter-file|YAML",
        "YAML has no tabs",
        "launch",
    ),
    _yaml(
        "yaml_names_misspelt",
        both(
            edit(YAML, "    timer_period: 1.0\n", "    timer_perod: 1.0\n"),
            edit(YAML, "    timer_period: 0.2\n    speed: 0.3\n", "    timer_perod: 0.2\n    sped: 0.3\n"),
        ),
        r"timer_perod|sped|parameter-name|declare",
        "no node declares these",
    ),
    _yaml(
        "yaml_int_for_double",
        edit(YAML, "timer_period: 1.0", "timer_period: 1"),
        r"1\.0|parameter-type|int|double",
        "the node dies at its start: 1 is no double",
        "launch",
    ),
    _yaml(
        "yaml_of_other_type",
        edit(VELOCITY, "'timer_period', 0.1", "'timer_period', '0.1'"),
        r"parameter-type|another type",
        "the node declares a text, which a number from the file must not replace",
        "launch",
        "parameters",
    ),
    _yaml(
        "yaml_not_installed",
        edit(SETUP, "        ('share/' + package_name + '/config', glob('config/*.yaml')),\n", ""),
        r"not-in-data-files|parameter-file-missing|data_files|install",
        "the launch file looks for it in install",
        "launch",
    ),
    _yaml(
        "yaml_by_relative_path",
        edit(
            LAUNCH, "os.path.join(share, 'config', 'robot.yaml')", "'src/robot_controller/config/robot.yaml'"
        ),
        r"path|parameter-file|YAML|robot\.yaml",
        "it is found only from one folder",
        "launch",
    ),
    _yaml(
        "yaml_other_file_name",
        edit(LAUNCH, "'robot.yaml')", "'params.yaml')"),
        r"params\.yaml|parameter-file",
        "there is no such file",
        "launch",
    ),
)

_NO_PERIOD = """\
        self.declare_parameter('timer_period', 2.0)
        period = self.get_parameter('timer_period').value
        if period <= 0.0:
            self.get_logger().warning(f'timer_period cannot be {period}, I take 2.0')
            period = 2.0
"""
_VELOCITY_TIMER = "self.get_parameter('timer_period').value, self.publish"

PERIODS: tuple[Case, ...] = (
    bonus_fault(
        "parameters",
        "periods_not_used",
        both(
            edit(STATUS, "self.create_timer(period,", "self.create_timer(2.0,"),
            edit(VELOCITY, _VELOCITY_TIMER, "0.1, self.publish"),
        ),
        r"timer_period|effect|period",
        "they are declared and have no effect",
    ),
    bonus_fault(
        "parameters",
        "periods_missing",
        both(
            edit(STATUS, _NO_PERIOD, "        period = 2.0\n"),
            edit(VELOCITY, "        self.declare_parameter('timer_period', 0.1)\n", ""),
            edit(VELOCITY, _VELOCITY_TIMER, "0.1, self.publish"),
            put(YAML, "velocity_publisher:\n  ros__parameters:\n    speed: 0.3\n"),
        ),
        r"parameter|period",
        "there is no such parameter",
    ),
)

TESTING: tuple[Case, ...] = (
    bonus_fault("tests", "tests_missing", drop(f"{P}test/"), r"test", "there are none"),
    bonus_fault(
        "tests",
        "tests_fail",
        edit(TESTS, "== 'Robot is OK, message 3'", "== 'Robot is well, message 3'"),
        r"test|fail",
        "one of them fails",
    ),
    bonus_fault(
        "tests",
        "tests_syntax",
        edit(TESTS, "def test_states():", "def test_states()"),
        r"test",
        "they are no Python",
        unreadable=("test_nodes.py",),
    ),
    bonus_fault(
        "tests",
        "tests_import_missing",
        edit(TESTS, "import StatusPublisher, status_text", "import StatusNode, status_text"),
        r"test|import|StatusNode",
        "they import what is not there",
    ),
    bonus_fault(
        "tests",
        "tests_assert_true",
        put(
            TESTS,
            '"""Tests."""\n\n\ndef test_status():\n    assert True\n\n\ndef test_velocity():\n    assert 1 + 1 == 2\n',
        ),
        r"test",
        "they test nothing of the package",
    ),
    bonus_fault(
        "tests",
        "tests_assert_nothing",
        put(
            TESTS,
            '"""Tests."""\nimport robot_controller\n\n\ndef test_import():\n    print(robot_controller)\n',
        ),
        r"test",
        "they pass whatever the nodes do",
    ),
    bonus_fault(
        "tests",
        "tests_of_a_constant",
        both(
            edit(STATUS, "        self.count += 1\n", "        self.count += step()\n"),
            edit(
                STATUS,
                "def status_text(",
                'def step():\n    """Return by how much it counts."""\n    return 1\n\n\ndef status_text(',
            ),
            put(
                TESTS,
                '"""Tests."""\nfrom robot_controller.status_publisher import step\n\n\n'
                "def test_step():\n    assert step() == 1\n",
            ),
        ),
        r"test",
        "they repeat a number that a function only gives back",
    ),
    bonus_fault(
        "tests",
        "tests_of_a_copy",
        put(
            TESTS,
            '"""Tests."""\n\n\ndef status_text(count):\n    return f\'Robot is OK, message {count}\'\n\n\n'
            "def test_status_text():\n    assert status_text(3) == 'Robot is OK, message 3'\n",
        ),
        r"test",
        "they test their own copy of the code",
    ),
    bonus_fault(
        "tests",
        "tests_skipped",
        edit(TESTS, "import rclpy\n", "import rclpy\n\npytestmark = pytest.mark.skip(reason='no time')\n"),
        r"test|skip",
        "all of them are skipped",
    ),
    bonus_fault(
        "tests",
        "tests_not_named_so",
        put(
            TESTS,
            "from robot_controller.status_publisher import status_text\n\n\n"
            "def check_status_text():\n    assert status_text(3) == 'Robot is OK, message 3'\n",
        ),
        r"test",
        "pytest looks for test_",
    ),
    bonus_fault(
        "tests",
        "tests_swallow",
        put(
            TESTS,
            "from robot_controller.status_publisher import status_text\n\n\ndef test_status_text():\n"
            "    try:\n        assert status_text(3) == 'Robot is OK, message 3'\n    except Exception:\n        pass\n",
        ),
        r"test",
        "no failure gets out of them",
    ),
)

_TRY = """\
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
"""
_OBEY = """\
        try:
            self.state = next_state(msg.data)
        except ValueError as error:
            self.get_logger().warning(str(error))
            return
"""
_NO_CARE = both(
    *(
        edit(path, _TRY, "    rclpy.spin(node)\n    node.destroy_node()\n    rclpy.shutdown()\n")
        for path in (STATUS, COMMAND, VELOCITY)
    ),
    edit(
        STATUS,
        _NO_PERIOD,
        "        self.declare_parameter('timer_period', 2.0)\n        period = self.get_parameter('timer_period').value\n",
    ),
    edit(COMMAND, _OBEY, "        self.state = next_state(msg.data)\n"),
    edit(
        COMMAND,
        "    if word not in STATES:\n        raise ValueError(f'Unknown command: {command!r}')\n    return STATES[word]\n",
        "    return STATES.get(word, 'stopped')\n",
    ),
)

HANDLING: tuple[Case, ...] = (
    bonus_fault(
        "errors",
        "no_error_handling",
        _NO_CARE,
        r"error|exception|handl",
        "nothing is caught, refused or warned of; it stays a style that works",
        costs=("tests",),
    ),
)

BONUS_FAULTS: tuple[Case, ...] = (*LAUNCHING, *CONFIGURING, *PERIODS, *TESTING, *HANDLING)
