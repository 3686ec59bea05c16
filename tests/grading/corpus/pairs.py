"""Two faults at once, of two components or one hidden behind the other: both must be charged, and both be said."""

from __future__ import annotations

from corpus.case import Case, Loss
from corpus.faults.documentation import without_words
from corpus.package import CFG, COMMAND, LAUNCH, MARKER, MODEL, README, SETUP, STATUS, VELOCITY, XML, M, P
from corpus.tree import Change, as_folder, drop, edit, every, made, move, put

_SPIN = "        rclpy.spin(node)\n"


def _pair(
    name: str,
    about: str,
    loses: dict[str, Loss],
    *changes: Change,
    unreadable: tuple[str, ...] = (),
    builds: bool = True,
) -> Case:
    folder = as_folder(made(MODEL, *changes))
    return Case(f"pair/{name}", about, folder, loses, unreadable=unreadable, builds=builds)


def _both(*causes: str) -> str:
    """Return an expression that asks for each of the causes."""
    return "(?s)^" + "".join(f"(?=.*(?:{cause}))" for cause in causes)


# Each: what it costs, and the change; put together below.
_SETUP_SYNTAX = edit(SETUP, "version='0.1.0',", "version='0.1.0'")
_SETUP_COST = Loss(2, 15, r"setup-syntax|setup\.py")
_STATUS_IMPORT = edit(STATUS, "from rclpy.node import Node", "from rclpy import Node")
_STATUS_DEAD = Loss(14, 20, r"import|rclpy\.node")
_STATUS_TOPIC = edit(STATUS, "'/robot/status', 10)", "'/robot/statu', 10)")
_STATUS_SLOW = edit(STATUS, "'timer_period', 2.0", "'timer_period', 5.0")
_SLOW_COST = Loss(2, 16, r"\b5(\.0)? s")
_COMMAND_TOPIC = edit(COMMAND, "'/robot/command'", "'/robot/commands'")
_COMMAND_COST = Loss(2, 16, r"/robot/commands")
_COMMAND_DIES = edit(
    COMMAND, "    if word not in STATES:\n        raise ValueError(f'Unknown command: {command!r}')\n", ""
)
_DIES_COST = Loss(1, 12, r"KeyError|ended|died|unknown")
_VELOCITY_TOPIC = edit(VELOCITY, "'/cmd_vel', 10)", "'/cmdvel', 10)")
_VELOCITY_COST = Loss(2, 18, r"/cmdvel")
_VELOCITY_INT = edit(VELOCITY, "    return 0.0, 0.0\n", "    return 0, 0\n")
_INT_COST = Loss(1, 20, r"int-in-float|float|int\b|0\.0")
_NO_README_COST = Loss(3, 8, r"README")

BEHIND: tuple[Case, ...] = (
    _pair(
        "import_behind_setup",
        "setup.py does not parse, and behind it a node cannot import",
        {"package": _SETUP_COST, "status_publisher": _STATUS_DEAD},
        _SETUP_SYNTAX,
        _STATUS_IMPORT,
        unreadable=("setup.py",),
        builds=False,
    ),
    _pair(
        "topic_behind_setup",
        "setup.py does not parse, and behind it a topic is misspelt",
        {"package": _SETUP_COST, "command_subscriber": _COMMAND_COST},
        _SETUP_SYNTAX,
        _COMMAND_TOPIC,
        unreadable=("setup.py",),
        builds=False,
    ),
    _pair(
        "period_behind_manifest",
        "package.xml is no XML, and behind it a period is wrong",
        {"package": Loss(1, 15, r"manifest-invalid|package\.xml"), "status_publisher": _SLOW_COST},
        edit(XML, "<license>MIT</license>", "<license>MIT"),
        _STATUS_SLOW,
    ),
    _pair(
        "int_behind_build_type",
        "colcon builds nothing, and behind it a Twist gets an int",
        {"package": Loss(1, 15, r"build.type"), "velocity_publisher": _INT_COST},
        edit(XML, ">ament_python<", ">ament_pyton<"),
        _VELOCITY_INT,
        builds=False,
    ),
    _pair(
        "topic_behind_marker",
        "the build stops at the marker, and behind it a topic is misspelt",
        {"package": Loss(1, 15, r"marker|resource"), "velocity_publisher": _VELOCITY_COST},
        drop(MARKER),
        _VELOCITY_TOPIC,
        builds=False,
    ),
    _pair(
        "death_behind_setup_cfg",
        "nothing is found by ros2 run, and behind it a node dies on an unknown command",
        {"package": Loss(1, 15, r"setup.cfg"), "command_subscriber": _DIES_COST},
        drop(CFG),
        _COMMAND_DIES,
    ),
    _pair(
        "syntax_behind_entry_point",
        "the entry point names no module, and the module that it means is no Python",
        {
            "package": Loss(1, 15, r"status_publsher|entry-point"),
            "status_publisher": Loss(14, 20, r"status_publisher\.py"),
        },
        edit(SETUP, "robot_controller.status_publisher:", "robot_controller.status_publsher:"),
        edit(STATUS, "    def publish_status(self):", "    def publish_status(self)"),
        unreadable=("/status_publisher.py",),
    ),
    _pair(
        "silence_behind_missing_point",
        "nothing starts the driver, and if something did it would send nothing",
        {
            "package": Loss(1, 12, r"velocity_publisher|entry.point"),
            "velocity_publisher": Loss(10, 20, r"publish"),
        },
        edit(SETUP, "            'velocity_publisher = robot_controller.velocity_publisher:main',\n", ""),
        edit(VELOCITY, "        self.publisher_.publish(msg)\n", "        self.last = msg\n"),
    ),
    _pair(
        "syntax_behind_no_init",
        "the modules are not installed, and one of them is no Python",
        {
            "package": Loss(1, 15, r"__init__|init-file"),
            "command_subscriber": Loss(14, 20, r"command_subscriber\.py"),
        },
        drop(f"{M}__init__.py"),
        edit(SETUP, "from setuptools import setup", "from setuptools import find_packages, setup"),
        edit(SETUP, "[package_name],", "find_packages(),"),
        edit(COMMAND, "    if word not in STATES:", "    if word not in STATES"),
        unreadable=("/command_subscriber.py",),
    ),
    _pair(
        "callback_behind_no_packages",
        "the modules are not installed, and a callback takes no message",
        {
            "package": Loss(1, 15, r"package-not-listed|packages"),
            "command_subscriber": Loss(12, 20, r"callback"),
        },
        edit(SETUP, "packages=[package_name]", "packages=[]"),
        edit(COMMAND, "def on_command(self, msg):", "def on_command(self):"),
    ),
    _pair(
        "topic_behind_import",
        "a node cannot import, and its topic is wrong, too: one component, two causes",
        {"status_publisher": Loss(14, 20, _both(r"import|rclpy\.node", r"robot/statu\b"))},
        _STATUS_IMPORT,
        _STATUS_TOPIC,
    ),
    _pair(
        "int_behind_topic",
        "a topic is misspelt, and what is sent there is an int",
        {"velocity_publisher": Loss(3, 20, _both(r"/cmdvel", r"int-in-float|float|int\b"))},
        _VELOCITY_TOPIC,
        _VELOCITY_INT,
    ),
    _pair(
        "cfg_behind_glob",
        "setup.py raises, and there is no setup.cfg",
        {"package": Loss(2, 15, _both(r"glob", r"setup.cfg"))},
        edit(SETUP, "from glob import glob\n", ""),
        drop(CFG),
        builds=False,
    ),
    _pair(
        "marker_behind_syntax",
        "setup.py does not parse, and the marker is missing",
        {"package": Loss(3, 15, _both(r"setup-syntax|setup\.py", r"marker|resource"))},
        _SETUP_SYNTAX,
        drop(MARKER),
        unreadable=("setup.py",),
        builds=False,
    ),
)

SIDE_BY_SIDE: tuple[Case, ...] = (
    _pair(
        "two_topics",
        "two nodes misspell their topics",
        {"status_publisher": Loss(2, 16, r"robot/statu\b"), "velocity_publisher": _VELOCITY_COST},
        _STATUS_TOPIC,
        _VELOCITY_TOPIC,
    ),
    _pair(
        "topics_swapped",
        "one publishes where the other listens, and the other way round",
        {
            "status_publisher": Loss(3, 20, r"/robot/command|/robot/status"),
            "command_subscriber": Loss(3, 20, r"/robot/status|/robot/command"),
        },
        edit(STATUS, "'/robot/status', 10)", "'/robot/command', 10)"),
        edit(COMMAND, "'/robot/command'", "'/robot/status'"),
    ),
    _pair(
        "period_and_death",
        "one is too slow, another dies",
        {"status_publisher": _SLOW_COST, "command_subscriber": _DIES_COST},
        _STATUS_SLOW,
        _COMMAND_DIES,
    ),
    _pair(
        "period_and_type",
        "one is too slow, another sends texts for Twists",
        {"status_publisher": _SLOW_COST, "velocity_publisher": Loss(2, 18, r"String")},
        _STATUS_SLOW,
        edit(VELOCITY, "create_publisher(Twist,", "create_publisher(String,"),
        edit(
            VELOCITY,
            "        msg = Twist()\n        msg.linear.x = forward\n        msg.angular.z = turn\n",
            "        msg = String(data=f'{forward} {turn}')\n",
        ),
    ),
    _pair(
        "two_that_never_spin",
        "two nodes end at once",
        {"status_publisher": Loss(10.5, 20, r"spin"), "velocity_publisher": Loss(10, 20, r"spin")},
        edit(STATUS, _SPIN, "        pass\n"),
        edit(VELOCITY, _SPIN, "        pass\n"),
    ),
    _pair(
        "two_that_raise",
        "two nodes raise at their start",
        {"command_subscriber": Loss(12, 20, r"INITIAL_STATE"), "velocity_publisher": Loss(13, 20, r"Twist")},
        edit(COMMAND, "        self.state = 'idle'\n", "        self.state = INITIAL_STATE\n"),
        edit(VELOCITY, "from geometry_msgs.msg import Twist\n", ""),
    ),
    _pair(
        "no_reset_and_one_twist",
        "reset is refused, and one Twist is all",
        {
            "command_subscriber": Loss(1, 10, r"reset"),
            "velocity_publisher": Loss(1, 16, r"once|one|repeat|again"),
        },
        edit(COMMAND, ", 'reset': 'idle'", ""),
        edit(
            VELOCITY,
            "        self.timer = self.create_timer(\n            self.get_parameter('timer_period').value, self.publish_velocity)\n",
            "        self.publish_velocity()\n",
        ),
    ),
    _pair(
        "no_readme_and_topic",
        "there is no README, and a topic is misspelt",
        {"documentation": _NO_README_COST, "status_publisher": Loss(2, 16, r"robot/statu\b")},
        drop(README),
        _STATUS_TOPIC,
    ),
    _pair(
        "no_readme_and_setup",
        "there is no README, and setup.py does not parse",
        {"documentation": _NO_README_COST, "package": _SETUP_COST},
        drop(README),
        _SETUP_SYNTAX,
        unreadable=("setup.py",),
        builds=False,
    ),
    _pair(
        "no_words_and_int",
        "nothing is explained, and a Twist gets ints",
        {"documentation": Loss(0.5, 6, r"docstring|comment"), "velocity_publisher": _INT_COST},
        _VELOCITY_INT,
        every(without_words, "status_publisher.py", "command_subscriber.py", "velocity_publisher.py"),
    ),
    _pair(
        "beside_src_and_todo",
        "the package lies beside src, and its licence was never chosen",
        {"workspace": Loss(0.5, 12, r"\bsrc\b"), "package": Loss(0.5, 6, r"TODO|licen[sc]e")},
        edit(XML, ">MIT<", ">TODO: License declaration<"),
        move(P, "robot_controller/"),
        put("src/.gitkeep", ""),
    ),
    _pair(
        "beside_src_and_topic",
        "the package lies beside src, and a topic is misspelt",
        {"workspace": Loss(0.5, 12, r"\bsrc\b"), "command_subscriber": _COMMAND_COST},
        _COMMAND_TOPIC,
        move(P, "robot_controller/"),
        put("src/.gitkeep", ""),
    ),
    _pair(
        "ignored_and_no_readme",
        "colcon does not look into src, and there is no README",
        {"workspace": Loss(0.5, 15, r"COLCON_IGNORE"), "documentation": _NO_README_COST},
        put("src/COLCON_IGNORE", ""),
        drop(README),
    ),
    _pair(
        "undeclared_and_import",
        "std_msgs is not declared, and a node imports it from the wrong place",
        {"package": Loss(0.5, 6, r"std_msgs"), "status_publisher": Loss(14, 20, r"import|std_msgs\.msg")},
        edit(XML, "  <depend>std_msgs</depend>\n", ""),
        edit(STATUS, "from std_msgs.msg import", "from std_msgs import"),
    ),
    _pair(
        "package_and_all_nodes",
        "setup.py does not parse, and each node has a fault of its own",
        {
            "package": _SETUP_COST,
            "status_publisher": _SLOW_COST,
            "command_subscriber": _DIES_COST,
            "velocity_publisher": _VELOCITY_COST,
        },
        _SETUP_SYNTAX,
        _STATUS_SLOW,
        _COMMAND_DIES,
        _VELOCITY_TOPIC,
        unreadable=("setup.py",),
        builds=False,
    ),
    Case(
        "pair/launch_and_period",
        "the launch file starts what is not there, and a period is wrong",
        as_folder(
            made(
                MODEL,
                edit(LAUNCH, "executable='command_subscriber'", "executable='command_listener'"),
                _STATUS_SLOW,
            )
        ),
        {"status_publisher": _SLOW_COST},
        lacks=frozenset(("launch",)),
        bonus_cause=r"command_listener|launch-executable",
    ),
)

PAIRS: tuple[Case, ...] = (*BEHIND, *SIDE_BY_SIDE)
