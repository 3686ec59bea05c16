"""Every mistake that beginners were seen to make, as a change to a right workspace and as what is then seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from workspace_files import Files

Break = Callable[[Files], object]


@dataclass(frozen=True)
class Mistake:
    """A mistake.

    Attributes:
        name: what it is.
        code: the finding that must come first.
        makes: does it to a right workspace; None for what is not in the files.
        text: what is seen, with the names to be filled in; empty if nothing is.
        file: where the place of the finding must be, as a part of the path.
        bare: the finding that must come first where the text is all there is; empty: the same.
        others: what else must be found in the files, and nothing more; None does not ask.
        fix: what the first finding must say to write.
    """

    name: str
    code: str
    makes: Break | None
    text: str = ""
    file: str = ""
    bare: str = ""
    others: tuple[str, ...] | None = None
    fix: str = ""


def change(name: str, old: str, new: str) -> Break:
    return lambda files: files.change(name, old, new)


def remove(name: str) -> Break:
    return lambda files: files.remove(name)


def put(name: str, text: str) -> Break:
    return lambda files: files.put(name, text)


def both(*breaks: Break) -> Break:
    def makes(files: Files) -> None:
        for one in breaks:
            one(files)

    return makes


def _flat(files: Files) -> None:
    """Put the nodes beside setup.py."""
    inner = f"src/{files.names.package}/{files.names.package}/"
    for path in [path for path in files.texts if path.startswith(inner)]:
        text = files.texts.pop(path)
        if not path.endswith("__init__.py"):
            files.texts[path.replace(inner, f"src/{files.names.package}/")] = text
    files.change("setup.py", "find_packages(exclude=['test'])", "[package_name]")


def _twice(files: Files) -> None:
    for path, text in list(files.texts.items()):
        files.texts[path.replace("src/", "src/old/", 1)] = text


def _failed_build(files: Files) -> None:
    """Leave what colcon has written of a package whose build then failed."""
    share = f"install/{files.names.package}/share/{files.names.package}"
    files.texts |= {"install/setup.bash": "", f"{share}/hook/ament_prefix_path.dsv": ""}


def in_launch(name: str, old: str, new: str) -> Break:
    """Change a launch file that is written in YAML or in XML."""
    return both(lambda files: files.launch_by(name), change(name, old, new))


def _in_launch_file(name: str, executable: str, named: str, line: int) -> list[Mistake]:
    """List the mistakes that a launch file in YAML or in XML may hold as one in Python does."""
    unknown = change("config/robot.yaml", "MODULE", "tellre")
    return [
        Mistake(f"executable in {name}", "launch-executable", in_launch(name, "DRIVER", "DRIVERs"), "", f"{name}:{line}", others=()),
        Mistake(f"package in {name}", "launch-package", in_launch(name, "PACKAGE", "PACKAGEs"), "", name, others=()),
        Mistake(f"parameters in {name}", "parameter-file-missing", in_launch(name, "robot.yaml", "robots.yaml"), "", name, others=()),
        Mistake(f"name in {name}", "parameter-file-node", both(in_launch(name, executable, named), unknown), "", "robot.yaml", others=(), fix="teller"),
    ]  # fmt: skip


BODY = "        msg.data = f'running {self.count}'\n"
ROW = "            'MODULE = PACKAGE.MODULE:main',\n"

PACKAGING = [
    Mistake("marker", "marker-missing", remove("resource/PACKAGE"), "error: can't copy 'resource/PACKAGE': doesn't exist or not a regular file", "setup.py"),
    Mistake("no inner folder", "package-folder-missing", _flat, "error: package directory 'PACKAGE' does not exist", "setup.py"),
    Mistake("no __init__", "init-file-missing", remove("PACKAGE/__init__.py"), "ModuleNotFoundError: No module named 'PACKAGE'", "__init__.py", bare="entry-point-module"),
    Mistake("no setup.cfg", "setup-cfg-missing", remove("setup.cfg"), "$ ros2 run PACKAGE MODULE\nNo executable found", "setup.cfg", bare="executable-missing"),
    Mistake("dashes", "setup-cfg-dashes", both(change("setup.cfg", "script_dir", "script-dir"), change("setup.cfg", "install_scripts", "install-scripts")), "Invalid dash-separated key 'script-dir' in 'develop' (setup.cfg), please use the underscore name 'script_dir' instead.", "setup.cfg"),
    *(Mistake(f"setup.cfg with {name}", "setup-value", change("setup.cfg", "[install]", f"{text}\n[install]"), "", f"setup.cfg:{line}", others=(), fix=fix) for name, text, line, fix in (
        ("a section twice", "[develop]", 3, "keep one [develop]"),
        ("an option twice", "script_dir=$base/lib/PACKAGE", 3, "keep one script_dir in [develop]"),
        ("an entry point group twice", "[options.entry_points]\nconsole_scripts =\n  a = b:c\nconsole_scripts =\n  d = e:f", 6, "keep one console_scripts"),
        ("files of a folder twice", "[options.data_files]\nshare/x = a\nshare/x = b", 5, "keep one share/x in [options.data_files]"),
        ("a line that is no option", "[options]\npackages", 4, "as name=value"),
    )),
    Mistake("setup.cfg without a section", "setup-value", change("setup.cfg", "[develop]\n", ""), "", "setup.cfg:1", others=(), fix="write the section it belongs to above it"),
    Mistake("key", "entry-points-key", change("setup.py", "'console_scripts'", "'console_script'"), "No executable found", "setup.py", bare="executable-missing"),
    Mistake("no entry points", "entry-points-missing", both(change("setup.py", ROW, ""), change("setup.py", "            'LISTENER = PACKAGE.LISTENER:main',\n", ""), change("setup.py", "            'DRIVER = PACKAGE.DRIVER:main',\n", ""), remove("launch/robot.launch.py")), "$ ros2 run PACKAGE MODULE\nNo executable found", "setup.py", bare="executable-missing"),
    Mistake("comma", "entry-point-comma", change("setup.py", "MODULE:main',", "MODULE:main'"), "RuntimeError: 'distutils.core.setup()' was never called -- perhaps '/x/setup.py' is not a Distutils setup script?", "setup.py"),
    Mistake("main()", "entry-point-spec", change("setup.py", "MODULE:main'", "MODULE:main()'"), "RuntimeError: 'distutils.core.setup()' was never called -- perhaps 'setup.py' is not a Distutils setup script?", "setup.py", bare="entry-point-comma"),
    Mistake("slash", "entry-point-spec", change("setup.py", "PACKAGE.MODULE:main", "PACKAGE/MODULE:main"), "RuntimeError: 'distutils.core.setup()' was never called", "setup.py", bare="entry-point-comma"),
    Mistake("colon", "entry-point-spec", change("setup.py", "MODULE = PACKAGE", "MODULE : PACKAGE"), "", "setup.py"),
    Mistake("twice", "entry-point-twice", change("setup.py", ROW, ROW + ROW), "error in PACKAGE setup command: Duplicate element EntryPoint(name='MODULE', value='PACKAGE.MODULE:main', group='console_scripts') encountered.\nRuntimeError: 'distutils.core.setup()' was never called -- perhaps 'setup.py' is not a Distutils setup script?", "setup.py", bare="entry-point-comma", fix="remove this line"),
    Mistake("one name for two", "entry-point-twice", change("setup.py", "'LISTENER = ", "'MODULE = "), "", "setup.py", others=("executable-missing", "launch-executable"), fix="another name"),
    Mistake("without :main", "entry-point-no-function", change("setup.py", "MODULE:main'", "MODULE'"), "Traceback (most recent call last):\n  File \"/ws/install/PACKAGE/lib/PACKAGE/MODULE\", line 33, in <module>\n    sys.exit(load())\nTypeError: 'module' object is not callable", "setup.py"),
    Mistake("module", "entry-point-module", change("setup.py", "PACKAGE.MODULE:main", "PACKAGE.MODULEs:main"), "ModuleNotFoundError: No module named 'PACKAGE.MODULEs'", "setup.py"),
    Mistake("no main", "entry-point-function", change("node", "def main(", "def mian("), "AttributeError: module 'PACKAGE.MODULE' has no attribute 'main'", ""),
    Mistake("empty file", "entry-point-function", put("node", ""), "AttributeError: module 'PACKAGE.MODULE' has no attribute 'main'", "MODULE.py"),
    Mistake("setup.py syntax", "setup-syntax", change("setup.py", "version='0.1.0',", "version='0.1.0'"), "  File \"setup.py\", line 8\n    name=package_name\n    ^^^^\nSyntaxError: invalid syntax. Perhaps you forgot a comma?", "setup.py"),
    Mistake("os", "setup-import", change("setup.py", "import os\n", ""), "Traceback (most recent call last):\n  File \"<string>\", line 1, in <module>\n  File \"setup.py\", line 14, in <module>\nNameError: name 'os' is not defined. Did you forget to import 'os'?", "setup.py"),
    Mistake("glob", "setup-import", change("setup.py", "from glob import glob\n", ""), "NameError: name 'glob' is not defined", "setup.py", bare="name-missing"),
    Mistake("no data_files", "marker-not-installed", both(change("setup.py", "        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n", "")), "WARNING:colcon.colcon_ros.task.ament_python.build:Package 'PACKAGE' doesn't explicitly install a marker in the package index (colcon-ros currently does it implicitly but that fallback will be removed in the future)", "setup.py"),
    Mistake("launch not installed", "not-in-data-files", change("setup.py", "        (os.path.join('share', package_name, 'launch'), glob('launch/*.launch.py')),\n", ""), "file 'robot.launch.py' was not found in the share directory of package 'PACKAGE' which is at '/ws/install/PACKAGE/share/PACKAGE'", "setup.py", bare="file-not-found"),
    Mistake("build_type", "build-type-unknown", change("package.xml", "ament_python", "ament_pyton"), "WARNING:colcon.colcon_core.verb:No task extension to 'build' a 'ros.ament_pyton' package\n\nSummary: 0 packages finished [0.21s]", "package.xml"),
    Mistake("ament_cmake", "build-type-cmake", change("package.xml", "ament_python", "ament_cmake"), "CMake Error: The source directory \"/ws/src/PACKAGE\" does not appear to contain CMakeLists.txt.", "package.xml"),
    Mistake("no export", "build-type-missing", change("package.xml", "    <build_type>ament_python</build_type>\n", ""), "CMake Error: The source directory \"/ws/src/PACKAGE\" does not appear to contain CMakeLists.txt.", "package.xml", bare="build-type-cmake"),
    Mistake("XML", "manifest-invalid", change("package.xml", "</maintainer>", ""), "", "package.xml"),
    Mistake("no licence", "manifest-invalid", change("package.xml", "  <license>Apache-2.0</license>\n", ""), "", "package.xml"),
    Mistake("e-mail", "manifest-invalid", change("package.xml", "anna@example.org", "anna at example"), "", "package.xml"),
    Mistake("dependency name", "dependency-unknown", change("package.xml", "std_msgs", "stdmsgs"), "ERROR: the following packages/stacks could not have their rosdep keys resolved\nto system dependencies:\nPACKAGE: Cannot locate rosdep definition for [stdmsgs]", "package.xml"),
    Mistake("no dependency", "dependency-undeclared", change("package.xml", "  <depend>std_msgs</depend>\n", ""), "", ".py"),
    Mistake("math declared", "dependency-not-ros", change("package.xml", "  <depend>rclpy</depend>\n", "  <depend>rclpy</depend>\n  <depend>math</depend>\n"), "PACKAGE: Cannot locate rosdep definition for [math]", "package.xml", bare="dependency-unknown"),
    Mistake("not ended", "not-running", None, "$ ros2 run PACKAGE MODULE\n^Z\n[1]+  Stopped                 ros2 run PACKAGE MODULE", fix="fg"),
    Mistake("no return in launch", "launch-function", change("launch/robot.launch.py", "    return LaunchDescription", "    LaunchDescription"), "Caught exception in launch (see debug for traceback): Caught multiple exceptions when trying to load file of format [py]:\n - InvalidPythonLaunchFileError: generate_launch_description() in the launch file must return a LaunchDescription, but it returns None", "robot.launch.py", bare="passed-on", fix="write return"),
    Mistake("main demands", "entry-point-function", change("node", "def main(args=None)", "def main(arguments)"), "Traceback (most recent call last):\n  File \"/ws/install/PACKAGE/lib/PACKAGE/MODULE\", line 33, in <module>\n    sys.exit(load())\nTypeError: main() missing 1 required positional argument: 'arguments'", "MODULE.py", fix="write def main(arguments=None):"),
    Mistake("a conflict", "node-syntax", change("node", BODY, "<<<<<<< HEAD\n" + BODY + "=======\n" + BODY + ">>>>>>> other\n"), "  File \"/ws/install/PACKAGE/lib/python3.12/site-packages/PACKAGE/MODULE.py\", line 16\n    <<<<<<< HEAD\n    ^^\nSyntaxError: invalid syntax", "MODULE.py:16", fix="keep line"),
    Mistake("a fence", "node-syntax", change("node", "import rclpy\n", "```python\nimport rclpy\n"), "", "MODULE.py:1", fix="remove the line"),
    Mistake("a hidden method", "callback-missing", change("node", "        self.count = 0", "        self.count = 0\n        self.CALLBACK = 'idle'"), "Traceback (most recent call last):\n  File \"/ws/install/PACKAGE/lib/python3.12/site-packages/PACKAGE/MODULE.py\", line 27, in main\n    rclpy.spin(node)\n  File \"/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/executors.py\", line 111, in await_or_execute\n    return callback(*args)\nTypeError: 'str' object is not callable", "MODULE.py:13", bare="passed-on", fix="write self.CALLBACK_value instead of self.CALLBACK on this line"),
    Mistake("a method of Node", "node-property", both(change("node", "def CALLBACK(self):", "def create_timer(self):\n        pass\n\n    def CALLBACK(self):")), "", "MODULE.py:14", fix="rename it, for example to create_timer_"),
    Mistake("a lambda that names", "no-effect", change("node", "value, self.CALLBACK)", "value, lambda: self.CALLBACK)"), "", "MODULE.py:11", fix="write self.CALLBACK instead of"),
    Mistake("parameters not answered", "value-none", change("node", "        self.count = 0\n", "        self.count = 0\n        self.add_on_set_parameters_callback(self.on_set)\n\n    def on_set(self, parameters):\n        self.count = 1\n"), "[INFO] [MODULE]: running 0\n/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/node.py:911: UserWarning: Callback returned an invalid type, it should return SetParameterResult.\n  warnings.warn(", "MODULE.py:15", bare="passed-on", fix="return SetParametersResult(successful=True)"),
    Mistake("declared by Node", "python-error", None, "Traceback (most recent call last):\nrclpy.exceptions.ParameterAlreadyDeclaredException: Parameter(s) already declared: ['use_sim_time']", fix="remove"),
    Mistake("a key twice", "replaced", change("setup.py", "            'LISTENER = PACKAGE.LISTENER:main',\n", "        ],\n        'console_scripts': [\n            'LISTENER = PACKAGE.LISTENER:main',\n"), "$ ros2 run PACKAGE MODULE\nNo executable found", "setup.py:27", bare="executable-missing", fix="put everything that both lists hold"),
    Mistake("a condition too early", "launch-argument", both(change("launch/robot.launch.py", "from launch import LaunchDescription\n", "from launch import LaunchDescription\nfrom launch.actions import DeclareLaunchArgument\nfrom launch.substitutions import LaunchConfiguration\n"), change("launch/robot.launch.py", "    return LaunchDescription([\n", "    quiet = LaunchConfiguration('quiet')\n    if quiet == 'true':\n        return LaunchDescription([])\n    return LaunchDescription([\n        DeclareLaunchArgument('quiet', default_value='false'),\n")), "", "robot.launch.py:13", fix="condition=IfCondition(quiet)"),
    Mistake("tests not found", "never-called", put("test/checks_of_state.py", "def test_state():\n    assert True\n"), "", "test/checks_of_state.py", fix="mv src/PACKAGE/test/checks_of_state.py src/PACKAGE/test/test_checks_of_state.py"),
    Mistake("the package's folder", "import-wrong", change("node", "from std_msgs.msg import String\n", "from std_msgs.msg import String\n\nfrom PACKAGE.PACKAGE.LISTENER import Listener\n"), "", "MODULE.py:5", fix="write PACKAGE.LISTENER instead of"),
    Mistake("another program's variable", "never-passed", both(put("PACKAGE/shared.py", "state = 'idle'\n"), change("listener", "from std_msgs.msg import String\n", "from std_msgs.msg import String\n\nfrom PACKAGE import shared\n"), change("listener", "        self.get_logger().info('Received", "        shared.state = msg.data\n        self.get_logger().info('Received"), change("driver", "from rclpy.node import Node\n", "from rclpy.node import Node\n\nfrom PACKAGE import shared\n"), change("driver", "        msg.linear.x = 1.0\n", "        msg.linear.x = 1.0 if shared.state == 'go' else 0.0\n")), "", "LISTENER.py:14", fix="subscribe to that in DRIVER.py"),
    Mistake("if for elif", "replaced", change("listener", "        self.get_logger().info('Received", "        if msg.data == 'start':\n            self.state = 'running'\n        if msg.data == 'stop':\n            self.state = 'stopped'\n        else:\n            self.state = 'idle'\n        self.get_logger().info(self.state + ' Received"), "", "LISTENER.py:14", fix="write elif"),
    Mistake("always true", "text-as-condition", change("listener", "        self.get_logger().info('Received", "        if msg.data != 'start' or msg.data != 'stop':\n            return\n        self.get_logger().info('Received"), "", "LISTENER.py:12", fix="write `msg.data != 'start' and msg.data != 'stop'`"),
    Mistake("a path of substitutions", "launch-argument", both(change("launch/robot.launch.py", "get_package_share_directory('PACKAGE'), 'config'", "FindPackageShare('PACKAGE'), 'config'"), change("launch/robot.launch.py", "from launch_ros.actions import Node\n", "from launch_ros.actions import Node\nfrom launch_ros.substitutions import FindPackageShare\n")), "", "robot.launch.py:10", fix="write PathJoinSubstitution([FindPackageShare('PACKAGE'), 'config', 'robot.yaml'])"),
    Mistake("an open quote", "typed-wrong", None, "$ ros2 topic pub --once /robot/command std_msgs/msg/String '{data: start}\n> ", fix="type `ros2 topic pub --once /robot/command std_msgs/msg/String '{data: start}'`"),
    Mistake("another layout", "link-stale", None, "[0.2s] ERROR:colcon:colcon build: The install directory 'install' was created with the layout 'isolated'. Please remove the install directory, pick a different one or remove the '--merge-install' option.", fix="rm -r build install log"),
    Mistake("scripts beside", "setup-value", both(change("setup.py", "    entry_points={\n        'console_scripts': [\n", "    console_scripts=[\n"), change("setup.py", "        ],\n    },\n)", "    ],\n)")), "$ ros2 run PACKAGE MODULE\nNo executable found", "setup.py", bare="executable-missing", fix="write entry_points={'console_scripts': [...]}"),
    Mistake("two copies", "package-duplicate", _twice, "[0.4s] ERROR:colcon:colcon build: Duplicate package names not supported:\n- PACKAGE:\n  - src/a\n  - src/b", ""),
    Mistake("setuptools 80", "setuptools-too-new", None, "error: option --editable not recognized"),
    Mistake("setuptools 72", "setuptools-too-new", None, "dist.py:289: UserWarning: Unknown distribution option: 'tests_require'\n  warnings.warn(msg)\n\nRan 0 tests in 0.000s\n\nOK"),
]  # fmt: skip


def frames(module: str, line: str) -> str:
    """Return the frames of a traceback from an installed module."""
    return (
        "Traceback (most recent call last):\n"
        '  File "/ws/install/PACKAGE/lib/PACKAGE/MODULE", line 33, in <module>\n'
        "    sys.exit(load_entry_point('PACKAGE==0.1.0', 'console_scripts', 'MODULE')())\n"
        f'  File "/ws/install/PACKAGE/lib/python3.11/site-packages/PACKAGE/{module}.py", line {line}, in main\n'
        "    some_code()\n"
    )


N, L, D = (
    (lambda line: frames("MODULE", line)),
    (lambda line: frames("LISTENER", line)),
    (lambda line: frames("DRIVER", line)),
)
CREATE = "self.create_publisher(String, 'TOPIC', 10)"
SUBSCRIBE = "self.create_subscription(String, '/robot/command', self.on_command, 10)"
TIMER = "self.create_timer(self.get_parameter('period').value, self.CALLBACK)"

RUNNING = [
    Mistake("int in float", "int-in-float", change("driver", "x = 1.0", "x = 1"), D("15") + "AssertionError: The 'x' field must be of type 'float'", "DRIVER.py"),
    Mistake("int by a name", "int-in-float", both(change("driver", "self.speed = 0.5", "self.speed = 1"), change("driver", "x = 1.0", "x = self.speed")), "", "DRIVER.py"),
    Mistake("non-str", "string-data-type", change("node", "f'running {self.count}'", "self.count"), N("16") + "TypeError: bad argument type for built-in operation", "MODULE.py"),
    Mistake("publish text", "publish-text", change("node", "publish(msg)", "publish('running')"), N("17") + "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'str'>", "MODULE.py"),
    Mistake("type str", "type-not-a-message", change("node", "publisher(String,", "publisher(str,"), N("10") + "AttributeError: type object 'type' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 message type but it should be a ROS 2 message type. Make sure to source your ROS 2 workspace after your ROS 1 workspace.", "MODULE.py"),
    Mistake("publisher.publisher", "publisher-method", change("node", "PUBLISHER.publish(", "PUBLISHER.publisher("), N("17") + "AttributeError: 'Publisher' object has no attribute 'publisher'. Did you mean: 'publish'?", "MODULE.py"),
    Mistake("callback called", "callback-called", change("node", "self.CALLBACK)", "self.CALLBACK())"), N("30") + "TypeError: 'NoneType' object is not callable", "MODULE.py"),
    Mistake("callback without msg", "callback-arguments", change("listener", "on_command(self, msg)", "on_command(self)"), L("9") + "RuntimeError: Subscription.__init__(): callback should be either be callable with one argument(to get only the message) or two (to get message and message info)", "LISTENER.py"),
    Mistake("no qos", "qos-missing", change("listener", "self.on_command, 10)", "self.on_command)"), L("9") + "TypeError: Node.create_subscription() missing 1 required positional argument: 'qos_profile'", "LISTENER.py"),
    Mistake("swapped", "argument-order", change("listener", "self.on_command, 10)", "10, self.on_command)"), L("9") + "TypeError: Expected QoSProfile or int, but received <class 'method'>", "LISTENER.py"),
    Mistake("queue_size", "queue-size", change("node", "'TOPIC', 10)", "'TOPIC', queue_size=10)"), N("10") + "TypeError: Node.create_publisher() got an unexpected keyword argument 'queue_size'", "MODULE.py"),
    Mistake("dot", "dot-for-comma", change("node", TIMER, "self.create_timer(2.0.self.CALLBACK)"), N("11") + "AttributeError: 'float' object has no attribute 'self'", "MODULE.py"),
    Mistake("super().__init", "super-misspelt", change("driver", "super().__init__", "super().__init"), D("8") + "AttributeError: 'super' object has no attribute '_Driver__init'", "DRIVER.py"),
    Mistake("no super", "super-missing", change("node", "        super().__init__('MODULE')\n", ""), N("9") + "AttributeError: 'CLASS' object has no attribute '_default_callback_group'", "MODULE.py"),
    Mistake("property", "node-property", change("driver", "self.speed = 0.5", "self.timers = []"), D("9") + "AttributeError: property 'timers' of 'Driver' object has no setter", "DRIVER.py"),
    Mistake("property publishers", "node-property", change("node", "self.count = 0", "self.publishers = []"), N("12") + "AttributeError: property 'publishers' of 'CLASS' object has no setter", "MODULE.py"),
    Mistake("node name", "node-name-invalid", change("listener", "super().__init__('LISTENER')", "super().__init__('LISTENER-1')"), L("8") + "rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not contain characters other than alphanumerics or '_':\n  'LISTENER-1'", "LISTENER.py"),
    Mistake("topic name", "topic-name-invalid", change("driver", "'/cmd_vel'", "'/cmd-vel'"), D("10") + "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}':\n  '/cmd-vel'", "DRIVER.py"),
    Mistake("wrong topic", "topic-near-miss", change("listener", "/robot/command", "/robot/comand"), "", "LISTENER.py"),
    Mistake("cmd_vel2", "topic-near-miss", change("driver", "/cmd_vel", "/cmd_vel2"), "", "DRIVER.py"),
    Mistake("wrong type", "topic-type", both(change("listener", "from std_msgs.msg import String", "from std_msgs.msg import Empty"), change("listener", "(String,", "(Empty,"), change("listener", "msg.data", "'nothing'")), "", "LISTENER.py"),
    Mistake("wrong period", "period", change("node", TIMER, "self.create_timer(1.0, self.CALLBACK)"), "", "MODULE.py"),
    Mistake("no init", "rclpy-init-missing", change("listener", "    rclpy.init(args=args)\n", ""), L("16") + "rclpy.exceptions.NotInitializedException: ('rclpy.init() has not been called', 'cannot create node')", "LISTENER.py"),
    Mistake("init twice", "rclpy-init-twice", change("node", "        super()", "        rclpy.init()\n        super()"), N("8") + "RuntimeError: Context.init() must only be called once", "MODULE.py"),
    Mistake("with init", "context-manager", change("listener", "    rclpy.init(args=args)\n    node = Listener()\n    rclpy.spin(node)\n    node.destroy_node()\n    rclpy.shutdown()", "    with rclpy.init(args=args):\n        node = Listener()\n        rclpy.spin(node)"), L("16") + "TypeError: 'NoneType' object does not support the context manager protocol", "LISTENER.py"),
    Mistake("with node", "context-manager", change("listener", "    node = Listener()\n    rclpy.spin(node)\n", "    with rclpy.create_node('LISTENER') as node:\n        rclpy.spin(node)\n"), L("17") + "TypeError: 'Node' object does not support the context manager protocol", "LISTENER.py"),
    Mistake("second shutdown", "shutdown-twice", None, L("19") + "rclpy._rclpy_pybind11.RCLError: failed to shutdown: rcl_shutdown already called on the given context, at ./src/rcl/init.c:333"),
    Mistake("no spin", "spin-missing", change("listener", "    rclpy.spin(node)\n", ""), "", "LISTENER.py"),
    Mistake("spin not called", "spin-missing", change("driver", "rclpy.spin(node)", "rclpy.spin"), "", "DRIVER.py"),
    Mistake("endless loop", "endless-loop", change("driver", "        self.timer = self.create_timer(0.1, self.drive)\n", "        while True:\n            self.drive()\n"), "", "DRIVER.py"),
    Mistake("endless callback", "endless-loop", change("node", BODY, BODY + "        while rclpy.ok():\n            self.count += 1\n"), "", "MODULE.py"),
    Mistake("running", "endless-loop", change("listener", "        self.get_logger", "        self.running = msg.data == 'start'\n        while self.running:\n            self.get_logger().info('driving')\n        self.get_logger"), "", "LISTENER.py"),
    Mistake("rate", "rate-without-thread", change("driver", "        self.publisher_.publish(msg)\n", "        self.publisher_.publish(msg)\n        rate = self.create_rate(10)\n        rate.sleep()\n"), "", "DRIVER.py"),
    Mistake("tabs", "node-syntax", change("node", "        msg = String()\n", "\tmsg = String()\n"), '  File "/ws/install/PACKAGE/lib/python3.11/site-packages/PACKAGE/MODULE.py", line 16\n    msg.data = 1\nTabError: inconsistent use of tabs and spaces in indentation', "MODULE.py"),
    Mistake("indent", "node-syntax", change("listener", "        self.get_logger", "    self.get_logger"), '  File "/ws/install/PACKAGE/lib/python3.11/site-packages/PACKAGE/LISTENER.py", line 12\n    self.get_logger\nIndentationError: expected an indented block after function definition on line 11', "LISTENER.py"),
    Mistake("Node from rclpy", "import-wrong", change("node", "from rclpy.node import Node", "from rclpy import Node"), N("2") + "ImportError: cannot import name 'Node' from 'rclpy' (/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/__init__.py)", "MODULE.py"),
    Mistake("String from std_msgs", "import-wrong", change("listener", "std_msgs.msg", "std_msgs"), L("3") + "ImportError: cannot import name 'String' from 'std_msgs' (/x/std_msgs/__init__.py)", "LISTENER.py"),
    Mistake("Twist from std_msgs", "import-wrong", change("driver", "geometry_msgs.msg", "std_msgs.msg"), D("2") + "ImportError: cannot import name 'Twist' from 'std_msgs.msg' (/x/std_msgs/msg/__init__.py)", "DRIVER.py"),
    Mistake("rospy", "ros1-import", change("node", "import rclpy\n", "import rclpy\nimport rospy\n"), N("2") + "ModuleNotFoundError: No module named 'rospy'", "MODULE.py"),
    Mistake("logger two", "logger-arguments", change("node", "info(msg.data)", "info('said', msg.data)"), N("18") + "TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given", "MODULE.py"),
    Mistake("logger msg", "logger-arguments", change("listener", "'Received: \"%s\"' % msg.data", "msg"), L("12") + "TypeError: rclpy_logging_rcutils_log(): incompatible function arguments. The following argument types are supported:", "LISTENER.py"),
    Mistake("undeclared", "parameter-undeclared", change("node", "        self.declare_parameter('period', 2.0)\n", ""), N("10") + "rclpy.exceptions.ParameterNotDeclaredException: ('Invalid access to undeclared parameter(s): period', ['period'])", "MODULE.py"),
    Mistake("YAML 2", "parameter-type", change("config/robot.yaml", "period: 2.0", "period: 2"), N("9") + "rclpy.exceptions.InvalidParameterTypeException: ('Trying to set parameter 'period' to '2' of type 'INTEGER', expecting type 'DOUBLE'', 'period')", "robot.yaml"),
    Mistake("YAML node", "parameter-file-node", change("config/robot.yaml", "MODULE:", "MODULE_node:"), "", "robot.yaml"),
    Mistake("no YAML", "parameter-file-missing", remove("config/robot.yaml"), "[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: /ws/install/PACKAGE/share/PACKAGE/config/robot.yaml", "launch"),
    Mistake("launch executable", "launch-executable", change("launch/robot.launch.py", "executable='DRIVER'", "executable='DRIVERs'"), "[ERROR] [launch]: Caught exception in launch (see debug for traceback): executable 'DRIVERs' not found on the libexec directory '/ws/install/PACKAGE/lib/PACKAGE'", "launch"),
    Mistake("QoS", "qos-mismatch", both(change("node", "import Node\n", "import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n"), change("node", "        self.count = 0\n", "        self.count = 0\n        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n        self.sub = self.create_subscription(String, 'TOPIC', lambda msg: None, qos)\n")), "[WARN] [MODULE]: New publisher discovered on topic 'TOPIC', offering incompatible QoS. No messages will be received from it. Last incompatible policy: DURABILITY", "MODULE.py"),
    Mistake("shutdown in callback", "shutdown-in-callback", change("listener", "        self.get_logger", "        rclpy.shutdown()\n        self.get_logger"), "", "LISTENER.py"),
]  # fmt: skip

# Not in the list of what was seen: what rests on causes must explain these as well.
FURTHER = [
    Mistake("attribute", "attribute-missing", change("node", "self.CALLBACK)", "self.CALLBACKs)"), N("11") + "AttributeError: 'CLASS' object has no attribute 'CALLBACKs'. Did you mean: 'CALLBACK'?", "MODULE.py", bare="attribute-unknown"),
    Mistake("field", "message-field", change("driver", "msg.linear.x", "msg.linear.forward"), D("15") + "AttributeError: 'Vector3' object has no attribute 'forward'", "DRIVER.py", bare="attribute-unknown"),
    Mistake("field in callback", "message-field", change("listener", "% msg.data", "% msg.text"), L("12") + "AttributeError: 'String' object has no attribute 'text'", "LISTENER.py", bare="attribute-unknown"),
    Mistake("message compared", "message-compared", change("listener", "        self.get_logger", "        if msg == 'start':\n            self.running = True\n        self.get_logger"), "", "LISTENER.py"),
    Mistake("message in texts", "message-compared", change("listener", "        self.get_logger", "        if msg not in ('start', 'stop'):\n            return\n        self.get_logger"), "", "LISTENER.py"),
    Mistake("message matched", "message-compared", change("listener", "        self.get_logger", "        match msg:\n            case 'start' | 'go':\n                self.running = True\n        self.get_logger"), "", "LISTENER.py"),
    Mistake("== for =", "comparison-unused", change("node", "        self.count += 1", "        self.count == self.count + 1"), "", "MODULE.py", fix="write self.count = self.count + 1"),
    Mistake("is a text", "literal-comparison", change("listener", "        self.get_logger", "        if msg.data is 'start':\n            self.running = True\n        self.get_logger"), "", "LISTENER.py", fix="write msg.data == 'start'"),
    Mistake("or a text", "text-as-condition", change("listener", "        self.get_logger", "        if msg.data == 'start' or 'go':\n            self.running = True\n        self.get_logger"), "", "LISTENER.py", fix="write msg.data in ('start', 'go')"),
    Mistake("timer in callback", "timer-in-callback", change("node", "        self.count += 1", "        self.count += 1\n        self.timer = self.create_timer(2.0, self.CALLBACK)"), "", "MODULE.py"),
    Mistake("method handle", "node-property", both(change("listener", "def on_command(", "def handle("), change("listener", "self.on_command", "self.handle")), L("9") + "TypeError: 'method' object does not support the context manager protocol", "LISTENER.py"),
    Mistake("two spins", "spin-missing", change("listener", "    rclpy.spin(node)\n", "    other = Listener()\n    rclpy.spin(node)\n    rclpy.spin(other)\n"), "", "LISTENER.py"),
    Mistake("no import", "name-undefined", change("driver", "from geometry_msgs.msg import Twist\n", ""), D("9") + "NameError: name 'Twist' is not defined", "DRIVER.py", bare="name-missing"),
    Mistake("class published", "publish-type", change("driver", "publish(msg)", "publish(Twist)"), "", "DRIVER.py"),
    Mistake("timer swapped", "argument-order", change("driver", "(0.1, self.drive)", "(self.drive, 0.1)"), "", "DRIVER.py"),
    Mistake("late super", "super-late", both(change("driver", "        super().__init__('DRIVER')\n", ""), change("driver", "self.drive)\n", "self.drive)\n        super().__init__('DRIVER')\n")), D("9") + "AttributeError: 'Driver' object has no attribute '_default_callback_group'", "DRIVER.py", bare="super-missing"),
    Mistake("parameter name", "parameter-name", change("config/robot.yaml", "period", "periods"), "", "robot.yaml"),
    Mistake("ros_parameters", "parameter-file-node", change("config/robot.yaml", "ros__parameters", "ros_parameters"), "", "robot.yaml"),
    Mistake("YAML tab", "parameter-file-syntax", change("config/robot.yaml", "    period", "\tperiod"), "", "robot.yaml"),
    Mistake("launch package", "launch-package", change("launch/robot.launch.py", "package='PACKAGE', executable='DRIVER'", "package='PACKAGEs', executable='DRIVER'"), "", "launch"),
    Mistake("launch function", "launch-function", change("launch/robot.launch.py", "def generate_launch_description", "def generate_launch"), "", "launch"),
    Mistake("launch syntax", "launch-syntax", change("launch/robot.launch.py", "    ])", "    ]"), "", "launch"),
    Mistake("install dir", "setup-cfg-missing", change("setup.cfg", "install_scripts=$base/lib/PACKAGE", "install_scripts=$base/lib/other"), "", "setup.cfg"),
    Mistake("wrong executable", "executable-missing", None, "$ ros2 run PACKAGE MODULEs\nNo executable found"),
    Mistake("wrong package", "package-not-found", None, "Package 'PACKAGEs' not found"),
    Mistake("not built", "not-built", None, "Package 'PACKAGE' not found", bare="package-not-found"),
]  # fmt: skip

# Written after everything above was found, to see whether what was not thought of is found, too.
AFTERWARDS = [
    Mistake('qos kw missing', 'qos-missing', change('node',"'TOPIC', 10)","topic='TOPIC')")),
    Mistake('count in Twist', 'int-in-float', both(change('driver','self.speed = 0.5','self.n = 0'),change('driver','x = 1.0','x = self.n * 2'))),
    Mistake('round', 'int-in-float', change('driver','z = 0.2','z = round(1.7)')),
    Mistake('Twist ctor', 'int-in-float', both(change('driver','import Twist','import Twist, Vector3'),change('driver','msg = Twist()','msg = Twist(linear=Vector3(x=1))'))),
    Mistake('str data', 'string-data-type', change('node',"f'running {self.count}'","5.0")),
    Mistake('list data', 'string-data-type', change('node',"f'running {self.count}'","['a']")),
    Mistake('topic blank', 'topic-name-invalid', change('listener','/robot/command','/robot command')),
    Mistake('topic end slash', 'topic-name-invalid', change('driver','/cmd_vel','/cmd_vel/')),
    Mistake('node name blank', 'node-name-invalid', change('driver',"__init__('DRIVER')","__init__('my driver')")),
    Mistake('super()__init__ missing parens', 'super-misspelt', change('driver',"super().__init__('DRIVER')","super.__init__('DRIVER')")),
    Mistake('_init_', 'super-misspelt', change('driver',"def __init__(self)","def _init_(self)")),
    Mistake('subscription cb called', 'callback-called', change('listener','self.on_command, 10','self.on_command(), 10')),
    Mistake('cb typo', 'attribute-missing', change('listener','self.on_command, 10','self.on_comand, 10')),
    Mistake('no self in cb', 'callback-arguments', change('listener','on_command(self, msg)','on_command(msg)')),
    Mistake('timer cb arg', 'callback-arguments', change('node','def CALLBACK(self)','def CALLBACK(self, msg)')),
    Mistake('pub no type', 'argument-order', change('driver',"create_publisher(Twist, '/cmd_vel', 10)","create_publisher('/cmd_vel', 10)")),
    Mistake('swap type topic', 'argument-order', change('driver',"(Twist, '/cmd_vel', 10)","('/cmd_vel', Twist, 10)")),
    Mistake('positional String', 'argument-missing', both(change('node',"msg = String()\n        msg.data = f'running {self.count}'","msg = String('x')"))),
    Mistake('spin class', 'spin-missing', change('driver','rclpy.spin(node)','rclpy.spin')),
    Mistake('import typo', 'module-missing', change('driver','geometry_msgs.msg','geometry_msg.msg')),
    Mistake('twist lower', 'import-wrong', change('driver','import Twist\n','import twist\n')),
    Mistake('cfg other name', 'setup-cfg-missing', change('setup.cfg',"install_scripts=$base/lib/PACKAGE","install_scripts=$base/bin")),
    Mistake('missing bracket', 'setup-syntax', change('setup.py',"        ],\n    },","    },")),
    Mistake('unclosed quote', 'node-syntax', change('node',"'MODULE')","'MODULE)")),
    Mistake('no colon', 'node-syntax', change('listener',"def on_command(self, msg):","def on_command(self, msg)")),
    Mistake('log int', 'logger-arguments', change('node','info(msg.data)','info(self.count)')),
    Mistake('pub other type', 'name-undefined', change('driver','publish(msg)','publish(String())')),
    Mistake('launch keyword', 'launch-executable', change('launch/robot.launch.py',"executable='DRIVER'","executable='DRIVER.py'")),
    Mistake('yaml missing', 'parameter-file-missing', change('launch/robot.launch.py',"'robot.yaml'","'robots.yaml'")),
    Mistake('bool loop', 'endless-loop', change('driver','        msg = Twist()\n','        while 1:\n            pass\n        msg = Twist()\n')),
    Mistake('run loop', 'endless-loop', both(change('driver','        self.timer = self.create_timer(0.1, self.drive)\n','        self.loop()\n'),change('driver','    def drive','    def loop(self):\n        while rclpy.ok():\n            self.drive()\n\n    def drive'))),
    Mistake('main typo in class', 'name-undefined', change('node','node = CLASS()','node = CLASSS()')),
    Mistake('pub not saved', 'attribute-missing', change('node','self.PUBLISHER.publish','self.PUBLISHERR.publish')),
]  # fmt: skip

# Found by the author of the lesson on troubleshooting.
IN_LESSONS = [
    Mistake("no module", "entry-point-function", change("setup.py", "PACKAGE.MODULE:main", "PACKAGE:main"), "AttributeError: module 'PACKAGE' has no attribute 'main'", "setup.py", bare="entry-point-function", others=(), fix="write 'MODULE = PACKAGE.MODULE:main'"),
    Mistake("another function", "entry-point-function", change("setup.py", "MODULE:main", "MODULE:start"), "AttributeError: module 'PACKAGE.MODULE' has no attribute 'start'", "setup.py", bare="attribute-unknown", others=(), fix="MODULE.py has main"),
    Mistake("failed build", "not-built", _failed_build, "Package 'PACKAGE' not found", "src/PACKAGE", bare="package-not-found", others=()),
    Mistake("number published", "publish-text", change("driver", "publish(msg)", "publish(self.speed)"), D("17") + "TypeError: Expected <class 'geometry_msgs.msg._twist.Twist'>, got <class 'float'>", "DRIVER.py", others=(), fix="msg = Twist()"),
    Mistake("text as Twist", "publish-text", change("driver", "publish(msg)", "publish('forward')"), "", "DRIVER.py", others=(), fix="msg = Twist()"),
    Mistake("count published", "publish-text", change("node", "publish(msg)", "publish(self.count)"), N("17") + "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'int'>", "MODULE.py", others=(), fix="String(data=str("),
    Mistake("method without self", "name-undefined", change("driver", "(0.1, self.drive)", "(0.1, drive)"), D("11") + "NameError: name 'drive' is not defined", "DRIVER.py", bare="name-missing", others=(), fix="self.drive"),
    Mistake("attribute without self", "name-undefined", change("node", "running {self.count}", "running {count}"), N("16") + "NameError: name 'count' is not defined. Did you mean: 'self.count'?", "MODULE.py", bare="name-missing", others=(), fix="self.count"),
    Mistake("Node's without self", "name-undefined", change("listener", "self.create_subscription", "create_subscription"), "", "LISTENER.py", others=(), fix="self.create_subscription"),
    Mistake("package misspelt", "module-missing", change("driver", "geometry_msgs.msg", "geometry_msg.msg"), "", "DRIVER.py", others=()),
    Mistake("package misspelt in its middle", "module-missing", change("driver", "geometry_msgs.msg", "geomtry_msgs.msg"), "", "DRIVER.py", others=()),
    Mistake("glob and marker", "setup-import", both(change("setup.py", "from glob import glob\n", ""), remove("resource/PACKAGE")), "NameError: name 'glob' is not defined", "setup.py", bare="name-missing", others=("marker-missing",)),
    Mistake("glob and a file", "setup-import", both(change("setup.py", "from glob import glob\n", ""), change("setup.py", "['package.xml']", "['package.xml', 'README.md']")), "", "setup.py", others=("data-file-missing",)),
    Mistake("double for an integer", "parameter-type", None, "rclpy.exceptions.InvalidParameterTypeException: ('Trying to set parameter 'period' to '1.0' of type 'DOUBLE', expecting type 'INTEGER'', 'period')", fix="declare period with a default of type DOUBLE"),
    Mistake("number near 0", "int-in-float", None, "linear:\n  x: 4.0e-323\n  y: 0.0\n", fix="1.0 instead of 1"),
    Mistake("number nearer 0", "int-in-float", None, "data: 5e-324\n---\n", fix="1.0 instead of 1"),
    *_in_launch_file("launch/robot.launch.yaml", "exec: MODULE", "exec: MODULE\n      name: teller", 18),
    *_in_launch_file("launch/robot.yaml", "exec: MODULE", "exec: MODULE\n      name: teller", 18),
    *_in_launch_file("launch/robot.launch.xml", 'exec="MODULE"', 'exec="MODULE" name="teller"', 10),
    *_in_launch_file("launch/robot.xml", 'exec="MODULE"', 'exec="MODULE" name="teller"', 10),
    Mistake("YAML launch syntax", "launch-syntax", in_launch("launch/robot.launch.yaml", "  - arg", "\t- arg"), "", "robot.launch.yaml:2"),
    Mistake("XML launch syntax", "launch-syntax", in_launch("launch/robot.launch.xml", "</group>", ""), "", "robot.launch.xml:13"),
]  # fmt: skip

ALL = [*PACKAGING, *RUNNING, *FURTHER, *AFTERWARDS, *IN_LESSONS]

# A second fault of a kind that stops nobody before the first one does, with its code.
SECOND = (
    ("dependency-not-ros", change("package.xml", "  <depend>rclpy</depend>\n", "  <depend>rclpy</depend>\n  <depend>time</depend>\n")),
    ("topic-near-miss", change("driver", "'/cmd_vel'", "'/cmdvel'")),
)  # fmt: skip
