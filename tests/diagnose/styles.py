"""Right packages, each written in another way: in none of them anything may be found."""

from __future__ import annotations

from collections.abc import Callable

from workspace_files import NAMES, Files

MAIN = (
    "\n\ndef main(args=None):\n    rclpy.init(args=args)\n    rclpy.spin(CLASS())\n    rclpy.try_shutdown()\n"
)


def _reference() -> Files:
    return Files.right(NAMES[0])


def node(text: str) -> Callable[[], Files]:
    """Return a maker of the workspace with another first module."""
    return lambda: _reference().put("node", text)


def _sub_packages() -> Files:
    files = _reference()
    text = files.texts.pop(files.path("driver"))
    files.put("PACKAGE/nodes/__init__.py", "").put("PACKAGE/nodes/DRIVER.py", text)
    return files.change("setup.py", "PACKAGE.DRIVER:main", "PACKAGE.nodes.DRIVER:main")


def _listed_packages() -> Files:
    return (
        _reference()
        .change("setup.py", "find_packages(exclude=['test'])", "[package_name]")
        .change("setup.py", "find_packages, ", "")
    )


def _comprehension() -> Files:
    files = _reference()
    rows = "            'MODULE = PACKAGE.MODULE:main',\n            'LISTENER = PACKAGE.LISTENER:main',\n            'DRIVER = PACKAGE.DRIVER:main',\n"
    files.change("setup.py", rows, "            f'{name} = {package_name}.{name}:main' for name in NODES\n")
    return files.change(
        "setup.py",
        "package_name = 'PACKAGE'\n",
        "package_name = 'PACKAGE'\nNODES = ('MODULE', 'LISTENER', 'DRIVER')\n",
    )


def _keywords() -> Files:
    files = _reference()
    text = files.texts[files.path("setup.py")]
    text = text.replace("setup(\n", "KEYWORDS = dict(\n", 1) + "setup(**KEYWORDS)\n"
    files.put("setup.py", text)
    return files


def _walked_data_files() -> Files:
    files = _reference()
    loop = (
        "package_name = 'PACKAGE'\n\ndata = [\n"
        "    ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n"
        "    ('share/' + package_name, ['package.xml']),\n]\n"
        "for folder, _, names in os.walk('launch'):\n"
        "    data.append((os.path.join('share', package_name, folder), [os.path.join(folder, n) for n in names]))\n"
        "data += [('share/' + package_name + '/config', glob('config/*'))]\n"
    )
    text = files.texts[files.path("setup.py")]
    start, end = text.index("    data_files=["), text.index("    install_requires")
    files.put("setup.py", text[:start] + "    data_files=data,\n" + text[end:])
    return files.change("setup.py", "package_name = 'PACKAGE'\n", loop)


def _ini_entry_points() -> Files:
    files = _reference()
    text = files.texts[files.path("setup.py")]
    start = text.index("    entry_points=")
    rows = "[console_scripts]\nMODULE = PACKAGE.MODULE:main\nLISTENER = PACKAGE.LISTENER:main\nDRIVER = PACKAGE.DRIVER:main\n"
    return files.put("setup.py", text[:start] + f'    entry_points="""\n{rows}""",\n)\n')


def _src_layout() -> Files:
    files = _reference()
    inner = f"src/{files.names.package}/{files.names.package}/"
    files.texts = {
        path.replace(inner, f"src/{files.names.package}/lib/{files.names.package}/"): text
        for path, text in files.texts.items()
    }
    return files.change("setup.py", "find_packages(exclude=['test'])", "find_packages('lib')").change(
        "setup.py", "    install_requires", "    package_dir={'': 'lib'},\n    install_requires"
    )


def _commented_cfg() -> Files:
    return _reference().put(
        "setup.cfg",
        "# where ros2 run looks\n[develop]\nscript_dir = $base/lib/PACKAGE\n\n[install]\n; here, too\n"
        "install_scripts = $base/lib/PACKAGE/\n\n[flake8]\nmax-line-length = 99\n",
    )


def _pyproject() -> Files:
    return _reference().put(
        "pyproject.toml", "[tool.ruff]\nline-length = 100\n[build-system]\nrequires = ['setuptools']\n"
    )


def _other_function() -> Files:
    return (
        _reference()
        .change("node", "def main(", "def run_status(")
        .change("node", "    main()", "    run_status()")
        .change("setup.py", "MODULE:main", "MODULE:run_status")
    )


def _own_base() -> Files:
    base = (
        "from rclpy.node import Node\n\n\nclass Base(Node):\n    def __init__(self, name, **kwargs):\n"
        "        super().__init__(name, **kwargs)\n        self.period = 2.0\n\n    def say(self, text):\n"
        "        self.get_logger().info(text)\n"
    )
    text = (
        "import rclpy\nfrom std_msgs.msg import String\n\nfrom .base import Base\n\n\nclass CLASS(Base):\n"
        "    def __init__(self):\n        super().__init__('MODULE')\n        self.declare_parameter('period', 2.0)\n"
        "        self.out = self.create_publisher(String, 'robot/status', 10)\n"
        "        self.create_timer(self.period, self.tell)\n\n    def tell(self):\n        self.say('x')\n"
        "        self.out.publish(String(data='x'))\n" + MAIN
    )
    return _reference().put("PACKAGE/base.py", base).put("node", text)


def _composed() -> Files:
    text = (
        "import rclpy\nfrom rclpy.executors import ExternalShutdownException, MultiThreadedExecutor\n"
        "from PACKAGE.LISTENER import Listener\nfrom PACKAGE.DRIVER import Driver\n\n\ndef main():\n    rclpy.init()\n"
        "    executor = MultiThreadedExecutor(num_threads=4)\n    nodes = [Listener(), Driver()]\n"
        "    for node in nodes:\n        executor.add_node(node)\n    try:\n        executor.spin()\n"
        "    except (KeyboardInterrupt, ExternalShutdownException):\n        pass\n    finally:\n"
        "        for node in nodes:\n            node.destroy_node()\n        rclpy.try_shutdown()\n"
    )
    return (
        _reference()
        .put("PACKAGE/everything.py", text)
        .change(
            "setup.py",
            "            'LISTENER =",
            "            'everything = PACKAGE.everything:main',\n            'LISTENER =",
        )
    )


def _launch_namespaces() -> Files:
    text = (
        "from launch import LaunchDescription\nfrom launch.actions import DeclareLaunchArgument, GroupAction\n"
        "from launch.substitutions import LaunchConfiguration, PathJoinSubstitution\n"
        "from launch_ros.actions import Node, PushRosNamespace\nfrom launch_ros.substitutions import FindPackageShare\n\n\n"
        "def generate_launch_description():\n"
        "    config = PathJoinSubstitution([FindPackageShare('PACKAGE'), 'config', 'robot.yaml'])\n"
        "    return LaunchDescription([\n        DeclareLaunchArgument('robot', default_value='anna'),\n"
        "        GroupAction([PushRosNamespace(LaunchConfiguration('robot')),\n"
        "                     Node(package='PACKAGE', executable='MODULE', name='teller', parameters=[config])]),\n"
        "        Node(package='turtlesim', executable='turtlesim_node', remappings=[('/turtle1/cmd_vel', '/cmd_vel')]),\n"
        "    ])\n"
    )
    return (
        _reference()
        .put("launch/robot.launch.py", text)
        .put(
            "config/robot.yaml",
            "/**:\n  teller:\n    ros__parameters:\n      period: 2.0\n/**/turtlesim:\n  ros__parameters:\n    r: 1\n",
        )
    )


def _xml_launch() -> Files:
    return (
        _reference()
        .remove("launch/robot.launch.py")
        .put(
            "launch/robot.launch.xml",
            '<launch>\n  <arg name="ns" default="a"/>\n  <node pkg="PACKAGE" exec="MODULE" namespace="$(var ns)"/>\n</launch>\n',
        )
        .change("setup.py", "launch/*.launch.py", "launch/*")
    )


def _names_in_launch(name: str, executable: str, named: str) -> Files:
    """Return a workspace whose YAML or XML launch file gives a node the name that the parameter file has."""
    return (
        _reference()
        .launch_by(name)
        .change(name, executable, named)
        .put("config/robot.yaml", "/**:\n  teller:\n    ros__parameters:\n      period: 2.0\n")
    )


def _nodes_in_a_sub_package() -> Files:
    """Put every node into a package inside the package, with imports relative to it."""
    files = _reference().change(
        "setup.py", "find_packages(exclude=['test'])", "[package_name, package_name + '.nodes']"
    )
    for name, module in (("node", "MODULE"), ("listener", "LISTENER"), ("driver", "DRIVER")):
        text = files.texts.pop(files.path(name))
        files.put(f"PACKAGE/nodes/{module}.py", text.replace("self.speed = 0.5", "self.speed = SPEED"))
        files.change("setup.py", f"PACKAGE.{module}:main", f"PACKAGE.nodes.{module}:main")
    files.change(
        "PACKAGE/nodes/DRIVER.py",
        "\n\nclass",
        "\nfrom ..limits import SPEED\nfrom . import MODULE as status\n\n\nclass",
    )
    files.change("PACKAGE/nodes/DRIVER.py", "'DRIVER')", "'DRIVER')\n        self.other = status.CLASS")
    files.put("PACKAGE/limits.py", "SPEED = 0.5\n").put("PACKAGE/nodes/__init__.py", "")
    return files.change("setup.py", "find_packages, ", "")


def _two_packages() -> Files:
    files = _reference()
    second = Files.right(NAMES[1])
    second.put("listener", (
        "import rclpy\nfrom rclpy.node import Node\nfrom robot_controller.velocity_publisher import Driver\n\n\n"
        "class Both(Driver):\n    def extra(self):\n        return self.speed + 1\n\n\ndef main():\n    rclpy.init()\n"
        "    rclpy.spin(Both())\n"
    ))  # fmt: skip
    second.change(
        "package.xml",
        "  <depend>std_msgs</depend>\n",
        "  <depend>std_msgs</depend>\n  <exec_depend>robot_controller</exec_depend>\n",
    )
    files.texts |= second.texts
    return files


FUNCTIONS = node(
    "import rclpy\nfrom std_msgs.msg import String\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n"
    "    node = rclpy.create_node('MODULE')\n    node.declare_parameter('period', 2.0)\n"
    "    publisher = node.create_publisher(String, 'robot/status', 10)\n    count = 0\n\n    def tell():\n"
    "        nonlocal count\n        count += 1\n        publisher.publish(String(data=f'{count}'))\n\n"
    "    node.create_timer(2, tell)\n    rclpy.spin(node)\n    rclpy.shutdown()\n"
)

ALIASES = node(
    "import rclpy\nimport rclpy.node as n\nfrom geometry_msgs.msg import Twist as T\nimport std_msgs.msg as sm\n\n"
    "Text = sm.String\n\n\nclass CLASS(n.Node):\n    def __init__(self):\n        super(CLASS, self).__init__('MODULE')\n"
    "        self.out = self.create_publisher(msg_type=Text, topic='/robot/status', qos_profile=10)\n"
    "        self.drive = self.create_publisher(T, 'cmd_vel', qos_profile=1)\n"
    "        self.declare_parameters('', [('period', 2.0), ('word', 'on')])\n"
    "        self.create_timer(callback=lambda: self.tell(1), timer_period_sec=2.0)\n\n    def tell(self, n):\n"
    "        t = T()\n        t.linear.x, t.angular.z = 0.5, -0.1\n        t.linear.y = float(n)\n        t.linear.z = n / 2\n"
    "        self.drive.publish(t)\n        self.out.publish(Text(data=str(n) + self.get_parameter('word').value))\n"
    + MAIN
)

ASYNCIO = node(
    "import asyncio\n\nimport rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n\n\n"
    "class CLASS(Node):\n    def __init__(self):\n        Node.__init__(self, 'MODULE')\n"
    "        self.declare_parameter('period', 2.0)\n        self.out = self.create_publisher(String, 'robot/status', 10)\n\n"
    "    async def tell(self):\n        while rclpy.ok():\n            self.out.publish(String(data='on'))\n"
    "            await asyncio.sleep(2.0)\n\n    async def spin_some(self):\n        while rclpy.ok():\n"
    "            rclpy.spin_once(self, timeout_sec=0)\n            await asyncio.sleep(0.01)\n\n\nasync def run():\n"
    "    node = CLASS()\n    await asyncio.gather(node.tell(), node.spin_some())\n\n\ndef main():\n    rclpy.init()\n"
    "    asyncio.run(run())\n"
)

RATE = node(
    "import threading\n\nimport rclpy\nfrom std_msgs.msg import String\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n"
    "    node = rclpy.create_node('MODULE')\n    out = node.create_publisher(String, '/robot/status', 10)\n"
    "    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()\n    rate = node.create_rate(0.5)\n"
    "    while rclpy.ok():\n        out.publish(String(data='running'))\n        rate.sleep()\n"
)

SLEEP = node(
    "import time\n\nimport rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n\n\ndef main():\n    rclpy.init()\n"
    "    node = Node('MODULE')\n    pub = node.create_publisher(String, 'robot/status', 10)\n    try:\n        while True:\n"
    "            msg = String()\n            msg.data = 'running'\n            pub.publish(msg)\n            time.sleep(2)\n"
    "    except KeyboardInterrupt:\n        node.destroy_node()\n"
)

DATACLASSES = node(
    "from __future__ import annotations\n\nfrom dataclasses import dataclass, field\nfrom functools import partial\nfrom typing import ClassVar\n\n"
    "import rclpy\nfrom rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy\nfrom std_msgs.msg import String\n\n\n"
    "@dataclass\nclass State:\n    word: str = 'idle'\n    seen: list[str] = field(default_factory=list)\n    LIMIT: ClassVar[int] = 3\n\n\n"
    "class CLASS(Node):\n    def __init__(self, **kwargs) -> None:\n        super().__init__('MODULE', **kwargs)\n"
    "        self.state = State()\n        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)\n"
    "        self._out = self.create_publisher(String, 'robot/state', qos)\n        self._in = self.create_subscription(String, 'robot/state', partial(self._hear, 1), qos)\n"
    "        self.declare_parameter('period', 2.0)\n        self._timer = self.create_timer(self._seconds(), self._make_callback('x'))\n\n"
    "    def _seconds(self) -> float:\n        return self.get_parameter('period').get_parameter_value().double_value\n\n"
    "    def _hear(self, number: int, msg: String) -> None:\n        match msg.data:\n            case 'start' | 'stop' as word:\n                self.state.word = word\n"
    "            case other if (size := len(other)) > 3:\n                self.get_logger().warning(f'{other} {size}', throttle_duration_sec=1.0)\n\n"
    "    def _make_callback(self, word: str):\n        def call() -> None:\n            self._out.publish(String(data=word))\n        return call\n"
    + MAIN
)

SERVICES = node(
    "import rclpy\nfrom rclpy.node import Node\nfrom std_srvs.srv import SetBool, Trigger\nfrom std_msgs.msg import Float64, Int32, String\n\n\n"
    "class CLASS(Node):\n    def __init__(self):\n        super().__init__('MODULE')\n        self.declare_parameter('period', 2.0)\n"
    "        self.srv = self.create_service(Trigger, '~/reset', self.reset)\n        self.cli = self.create_client(SetBool, 'enable')\n"
    "        self.level = self.create_publisher(Float64, 'level', 10)\n        self.number = self.create_publisher(Int32, 'number', 10)\n"
    "        self.count = 0\n        self.total = 0\n        self.create_subscription(String, 'words', self.hear, rclpy.qos.qos_profile_sensor_data)\n"
    "        while not self.cli.wait_for_service(timeout_sec=1.0):\n            self.get_logger().info('waiting')\n\n"
    "    def reset(self, request, response):\n        response.success = True\n        response.message = 'done'\n        self.count += 1\n"
    "        self.total += 0.5\n        self.level.publish(Float64(data=self.total * 2.0))\n        self.number.publish(Int32(data=self.count))\n        return response\n\n"
    "    def hear(self, msg: String):\n        self.get_logger().info(f'{msg.data!r}')\n        first, *rest = msg.data.split() or ['']\n        print(first, rest)\n"
    + MAIN
)

MADE_NAMES = node(
    "import rclpy\nfrom rclpy.node import Node\n\nfor number, name in enumerate(('SLOW', 'FAST')):\n"
    "    globals()[name] = float(number)\n\n\nclass CLASS(Node):\n    def __init__(self):\n"
    "        super().__init__('MODULE')\n        self.speed = self.declare_parameter('period', FAST - SLOW).value\n"
    + MAIN
)

CLASS_NAMES = node(
    "from typing import Callable\n\nimport rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n\n\n"
    "def logged(function):\n    return function\n\n\n"
    "class CLASS(Node):\n    TALKS_ON = 'robot/status'\n    PERIODS = [2.0]\n    PERIOD = PERIODS[0] or [p for p in PERIODS]\n\n"
    "    class Word:\n        text = 'on'\n        longer = text + text\n\n"
    "    def __init__(self, word=Word, key: Callable = lambda one: one):\n        super().__init__('MODULE')\n"
    "        self.declare_parameter('period', self.PERIOD)\n        self._speed = 0.5\n"
    "        self.out = self.create_publisher(String, self.TALKS_ON, 10)\n        self.create_timer(self.PERIOD, self.tell)\n\n"
    "    @property\n    def speed(self) -> float:\n        return self._speed\n\n"
    "    @speed.setter\n    def speed(self, speed: float) -> None:\n        self._speed = speed\n\n"
    "    def tell(self, words: list[Word] = PERIODS) -> Word:\n        def tell(text):\n            return [tell for tell in text]\n\n"
    "        self.out.publish(String(data=str(tell('on'))))\n\n    again = logged(tell)\n" + MAIN
)

COMPARED = node(
    "import rclpy\nfrom rclpy.executors import SingleThreadedExecutor\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n\n\n"
    "class CLASS(Node):\n    def __init__(self):\n        super().__init__('MODULE')\n        self.last = String()\n        self.timer = None\n"
    "        self.declare_parameter('period', 2.0)\n        self.create_subscription(String, 'words', self.hear, 10)\n"
    "        self.create_subscription(String, 'texts', self.read, 10)\n\n"
    "    @property\n    def handle(self):\n        return super().handle\n\n"
    "    def hear(self, msg):\n        if msg == self.last or msg is None or self.last != String(data='on'):\n            return\n"
    "        self.last = msg\n        if self.timer is None:\n            self.timer = self.create_timer(1.0, self.tick)\n        msg = msg.data\n        if msg == 'start' or msg in ('stop', 'reset'):\n            self.tell(msg)\n\n"
    "    def read(self, msg):\n        match msg:\n            case String(data='start'):\n                self.tell('go')\n"
    "            case _ if msg.data == 'stop' or '':\n                self.tell('on')\n\n"
    "    def tick(self):\n        if self.timer:\n            return\n        self.timer = self.create_timer(1.0, self.tick)\n"
    "        self.tell(self.last.data == 'a' and 'b' or self.last.data or 'c')\n\n"
    "    def tell(self, text):\n        self.get_logger().info(text)\n\n\ndef main():\n    rclpy.init()\n    node = CLASS()\n"
    "    executor = SingleThreadedExecutor()\n    executor.add_node(node)\n    try:\n        executor.spin()\n"
    "    except KeyboardInterrupt:\n        executor.spin_once(0.1)\n"
)


def _setup_cfg_only() -> Files:
    files = _reference()
    files.texts.pop(files.path("launch/robot.launch.py"), None)
    return files.put(
        "setup.py", "from setuptools import setup\n\nDATA_FILES\n".replace("DATA_FILES", _DATA)
    ).put(
        "setup.cfg",
        "[metadata]\nname = PACKAGE\nversion = 0.1.0\n\n[options]\npackages = find:\ninstall_requires = setuptools\n\n"
        "[options.entry_points]\nconsole_scripts =\n    MODULE = PACKAGE.MODULE:main\n    LISTENER = PACKAGE.LISTENER:main\n"
        "    DRIVER = PACKAGE.DRIVER:main\n\n[develop]\nscript_dir=$base/lib/PACKAGE\n[install]\ninstall_scripts=$base/lib/PACKAGE\n",
    )


_DATA = (
    "from glob import glob\n\nsetup(data_files=[\n    ('share/ament_index/resource_index/packages', ['resource/PACKAGE']),\n"
    "    ('share/PACKAGE', ['package.xml']),\n    ('share/PACKAGE/launch', glob('launch/*')),\n"
    "    ('share/PACKAGE/config', glob('config/*')),\n])"
)


def _in_main(line: str) -> Callable[[], Files]:
    """Return a maker of the workspace with a line before the spin of its first node."""
    return lambda: _reference().change(
        "node", "        rclpy.spin(node)", f"{line}\n        rclpy.spin(node)"
    )


STYLES: dict[str, Callable[[], Files]] = {
    "as ros2 pkg create": _reference,
    "all in setup.cfg": _setup_cfg_only,
    "spins once first": _in_main(
        "        rclpy.spin_once(node, timeout_sec=0.1)\n        node.create_timer(3600.0, node.get_name)"
    ),
    "says braces": _in_main("        node.get_logger().info('{name} is filled by nobody')"),
    "an ellipsis and a docstring": _in_main("        ...\n        'a text that stands for a comment'"),
    "other names": lambda: Files.right(NAMES[1]),
    "a property that is set": lambda: (
        Files.right(NAMES[1])
        .change(
            "node",
            "    def CALLBACK(self):",
            "    @property\n    def state(self):\n        return self._state\n\n    @state.setter\n    def state(self, value):\n"
            "        self._state = value\n        self.PUBLISHER.publish(String(data=value))\n\n"
            "    def on_set(self, msg):\n        self.state = msg.data\n\n    def CALLBACK(self):",
        )
        .change(
            "node",
            "        self.count = 0\n",
            "        self.count = 0\n        self.create_subscription(String, '/robot/command', self.on_set, 10)\n",
        )
    ),
    "ifs that leave": lambda: Files.right(NAMES[1]).change(
        "listener",
        "        self.get_logger().info('Received",
        "        if msg.data == 'start':\n            self.state = 'running'\n            return\n        if msg.data == 'stop':\n"
        "            self.state = 'stopped'\n        else:\n            self.state = 'idle'\n"
        "        self.get_logger().info(self.state + ' Received",
    ),
    "a loop that empties a list": lambda: (
        Files.right(NAMES[1])
        .change(
            "node",
            "        msg = String()\n",
            "        while self.waiting:\n            self.waiting.pop()()\n        msg = String()\n",
        )
        .change("node", "        self.count = 0\n", "        self.count = 0\n        self.waiting = []\n")
    ),
    "a main that may be given words": lambda: Files.right(NAMES[1]).change(
        "node", "def main(args=None)", "def main(args=None, *more)"
    ),
    "a condition of launch": lambda: (
        Files.right(NAMES[1])
        .change(
            "launch/robot.launch.py",
            "    return LaunchDescription([",
            "    quiet = LaunchConfiguration('quiet', default='false')\n    return LaunchDescription([\n"
            "        Node(package='PACKAGE', executable='DRIVER', condition=UnlessCondition(quiet)),",
        )
        .change(
            "launch/robot.launch.py",
            "from launch import LaunchDescription\n",
            "from launch import LaunchDescription\nfrom launch.conditions import UnlessCondition\n"
            "from launch.substitutions import LaunchConfiguration\n",
        )
    ),
    "a method of Node made anew": lambda: Files.right(NAMES[1]).change(
        "node",
        "    def CALLBACK(self):",
        "    def create_timer(self, *args, **kwargs):\n        return super().create_timer(*args, **kwargs)\n\n"
        "    def destroy_node(self):\n        self.count = 0\n        super().destroy_node()\n\n    def CALLBACK(self):",
    ),
    "helpers beside the tests": lambda: Files.right(NAMES[1]).put(
        "test/helpers.py", "def make_node():\n    return None\n"
    ),
    "sub-packages": _sub_packages,
    "packages=[name]": _listed_packages,
    "entry points by a comprehension": _comprehension,
    "setup(**dict)": _keywords,
    "data_files by os.walk": _walked_data_files,
    "entry points as a text": _ini_entry_points,
    "package_dir": _src_layout,
    "commented setup.cfg": _commented_cfg,
    "pyproject beside": _pyproject,
    "other function": _other_function,
    "own base class": _own_base,
    "composed main": _composed,
    "namespaces by launch": _launch_namespaces,
    "launch in XML": _xml_launch,
    "parameters by XML": lambda: _reference().launch_by("launch/robot.launch.xml"),
    "parameters by YAML": lambda: _reference().launch_by("launch/robot.launch.yaml"),
    "names by XML": lambda: _names_in_launch(
        "launch/all.xml", 'exec="MODULE"', 'exec="MODULE" name="teller"'
    ),
    "names by YAML": lambda: _names_in_launch(
        "launch/all.yml", "exec: MODULE", "exec: MODULE\n      name: teller"
    ),
    "nodes in a sub-package": _nodes_in_a_sub_package,
    "names of a class": CLASS_NAMES,
    "messages and texts compared": COMPARED,
    "names made while it runs": MADE_NAMES,
    "two packages": _two_packages,
    "functions": FUNCTIONS,
    "aliases": ALIASES,
    "asyncio": ASYNCIO,
    "rate with a thread": RATE,
    "sleep loop": SLEEP,
    "dataclasses and closures": DATACLASSES,
    "services": lambda: SERVICES().change(
        "package.xml", "<depend>std_msgs", "<depend>std_srvs</depend>\n  <depend>std_msgs"
    ),
}
