"""Programs of many styles, and some that do harm, are watched in the sandbox: what is seen of each, and twice the same."""

from __future__ import annotations

import itertools
import json
import math
import statistics
import sys
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import CommandSeen, Run
from ros2lab.grading.judging.ways import shut_out
from ros2lab.grading.sandbox.worlds import World
from ros2lab.grading.watching import observe
from ros2lab.grading.watching.ends import add_types
from ros2lab.grading.watching.job import Job, Program
from ros2lab.grading.watching.observe import SHOWN, Observer
from ros2lab.grading.watching.script import Script
from ros2lab.grading.watching.watch import TOPICS

TWIST = "geometry_msgs/msg/Twist"

BEGIN = """
import itertools, sys, threading, time
import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
"""
STATUS = """
node = rclpy.create_node("status")
publisher = node.create_publisher(String, "/robot/status", 10)
def tell():
    publisher.publish(String(data="well"))
"""
COMMAND = """
node = rclpy.create_node("command")
"""

_GATED = f"""
from std_msgs.msg import Bool
rclpy.init()
{STATUS.strip()}
kept = {{}}
has = kept.get
for topic in sys.argv[2:]:
    node.create_subscription(Bool, topic, lambda message, topic=topic: kept.update({{topic: message.data}}), 10)
node.create_timer(0.5, lambda: eval(sys.argv[1]) and tell())
rclpy.spin(node)
"""
_WAITS = """
from geometry_msgs.msg import TwistStamped, Vector3
from std_msgs.msg import Float32
rclpy.init()
node = rclpy.create_node("velocity")
out = node.create_publisher(Twist, "/cmd_vel", 10)
kind, condition, do = sys.argv[1:]
def take(message):
    if eval(condition):
        exec(do)
node.create_subscription(globals()[kind], "/input", take, 10)
rclpy.spin(node)
"""
# What only one program of a machine can have at a time.
_LOCKS = {
    "abstract": r'held = socket.socket(socket.AF_UNIX); held.bind("\0robot")',
    "port": 'held = socket.create_server(("127.0.0.1", 4242))',
    "new_file": 'open("/tmp/robot.pid", "x")',
    "process_of_a_file": """
with open("/tmp/robot.new", "a") as turn:  # both begin at once
    fcntl.flock(turn, fcntl.LOCK_EX)
    try:
        os.kill(int(open("/tmp/robot.pid").read()), 0)
    except OSError:
        with open("/tmp/robot.pid", "w") as file:
            file.write(str(os.getpid()))
    else:
        sys.exit("The robot is busy.")
""",
    "home": 'held = open(os.path.expanduser("~/robot"), "w"); fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)',
    "foreign_home": 'os.mkdir("/home/lock")',
    "memory": 'held = shared_memory.SharedMemory("robot", create=True, size=8)',
}
# NAME is the program's.
_OF_EACH = 'held = open("/tmp/NAME.lock", "w"); fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)'
_LOCKED = f"""
import fcntl, os, socket
from multiprocessing import shared_memory
try:
    exec(LOCK)
except OSError:
    sys.exit("The robot is busy.")
rclpy.init()
{STATUS.strip()}
node.create_timer(2.0, tell)
rclpy.spin(node)
"""

# Each is run as `python3 NAME.py`, with BEGIN before it.
PROGRAMS = {
    "class_node": """
class Status(Node):
    def __init__(self):
        super().__init__("status")
        self.declare_parameter("period", 2.0)
        self.publisher = self.create_publisher(String, "/robot/status", 10)
        self.create_timer(self.get_parameter("period").value, self.tell)
    def tell(self):
        self.publisher.publish(String(data="well"))
rclpy.init()
rclpy.spin(Status())
""",
    "functions": f"""
rclpy.init()
{STATUS}
node.create_timer(2.4, tell)
rclpy.spin(node)
""",
    "three_nodes": """
rclpy.init()
one, two, three = (rclpy.create_node(name) for name in ("status", "command", "velocity"))
status = one.create_publisher(String, "robot/status", 10)
one.create_timer(2.0, lambda: status.publish(String(data=state)))
velocity = three.create_publisher(Twist, "cmd_vel", 1)
state = "idle"
def hear(message):
    global state
    state = message.data
    two.get_logger().info("heard " + state)
    print("printed", state)
def drive():
    twist = Twist()
    twist.linear.x = 0.5 if state == "start" else 0.0
    velocity.publish(twist)
two.create_subscription(String, "robot/command", hear, 10)
three.create_timer(0.1, drive)
executor = SingleThreadedExecutor()
for node in (one, two, three):
    executor.add_node(node)
executor.spin()
""",
    "sleep_loop": f"""
rclpy.init()
{STATUS}
while rclpy.ok():
    tell()
    time.sleep(2.0)
""",
    "wait_loop": f"""
rclpy.init()
{STATUS}
while rclpy.ok():
    tell()
    rclpy.spin_once(node, timeout_sec=2.0)
""",
    "poll_loop": f"""
rclpy.init()
{STATUS}
for number in itertools.count():
    if number % 4 == 0:
        tell()
    rclpy.spin_once(node, timeout_sec=0)
    time.sleep(0.5)
""",
    "sleeping_timer": f"""
rclpy.init()
{STATUS}
node.declare_parameter("period", 0.1)
def tell_and_sleep():
    tell()
    time.sleep(2.0)
node.create_timer(0.1, tell_and_sleep)
rclpy.spin(node)
""",
    "thread_timer": f"""
rclpy.init()
{STATUS}
def again():
    tell()
    timer = threading.Timer(2.0, again)
    timer.daemon = True
    timer.start()
again()
rclpy.spin(node)
""",
    "after_command": """
rclpy.init()
node = rclpy.create_node("command")
publisher = None
def hear(message):
    global publisher
    publisher = publisher or node.create_publisher(Twist, "/cmd_vel", 10)
    node.create_timer(0.1, lambda: publisher.publish(Twist()))
node.create_subscription(String, "/robot/command", hear, 10)
rclpy.spin(node)
""",
    "dies": """
rclpy.init()
node = rclpy.create_node("command")
def hear(message):
    node.get_logger().info({"start": "run", "stop": "halt", "reset": "idle"}[message.data.lower()])
node.create_subscription(String, "/robot/command", hear, 10)
rclpy.spin(node)
""",
    "spams": f"""
rclpy.init()
{STATUS}
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
while rclpy.ok():
    publisher.publish(String(data="x" * 2_000_000))
    time.sleep(0.001)
""",
    "stops": f"""
rclpy.init()
{STATUS}
left = 5
def tell_while_any_are_left():
    global left
    tell()
    left -= 1
    if not left:
        timer.cancel()
timer = node.create_timer(0.1, tell_while_any_are_left)
rclpy.spin(node)
""",
    "stops_later": f"""
rclpy.init()
{STATUS}
left = iter(range(8))
node.create_timer(2.0, lambda: [tell() for _ in itertools.islice(left, 1)])
rclpy.spin(node)
""",
    "counts": f"""
rclpy.init()
{STATUS}
left = itertools.cycle((3, 2, 1, 0))
node.create_timer(0.5, lambda: next(left) or tell())
rclpy.spin(node)
""",
    "counts_in_turns": f"""
rclpy.init()
{STATUS}
velocity = node.create_publisher(Twist, "/cmd_vel", 10)
turns = itertools.cycle((velocity.publish, lambda _: None, velocity.publish, lambda _: tell()))
node.create_timer(0.25, lambda: next(turns)(Twist()))
rclpy.spin(node)
""",
    "counts_to_its_end": f"""
rclpy.init()
{STATUS}
left = iter(range(16))
node.create_timer(0.5, lambda: next(left, 1) % 4 or tell())
rclpy.spin(node)
""",
    "ends": f"""
rclpy.init()
{STATUS}
left = iter(range(9))
def tell_while_any_are_left():
    tell()
    if next(left, None) is None:
        raise SystemExit("enough")
node.create_timer(0.5, tell_while_any_are_left)
rclpy.spin(node)
""",
    "begins_late": """
rclpy.init()
node = rclpy.create_node("status")
def begin():
    timer.cancel()
    publisher = node.create_publisher(String, "/robot/status", 10)
    node.create_timer(0.1, lambda: publisher.publish(String(data="well")))
timer = node.create_timer(0.5, begin)
rclpy.spin(node)
""",
    "answers_late": """
rclpy.init()
node = rclpy.create_node("command")
def hear(message):
    time.sleep(0.1)
    node.get_logger().info("heard " + message.data)
node.create_subscription(String, "/robot/command", hear, 10, callback_group=ReentrantCallbackGroup())
rclpy.spin(node, MultiThreadedExecutor(4))
""",
    "tells_late": f"""
rclpy.init()
{STATUS}
state = "idle"
def hear(message):
    global state
    state = message.data
def tell():
    if state == "idle":
        publisher.publish(String(data=state))
    else:
        threading.Timer(0.1, publisher.publish, [String(data=state)]).start()
node.create_subscription(String, "/robot/command", hear, 10)
node.create_timer(2.0, tell)
rclpy.spin(node)
""",
    "prints": """
while True:
    print("x" * 1000)
""",
    "near": """
rclpy.init()
node = rclpy.create_node("command")
node.create_subscription(String, "/robot/comand", lambda m: node.get_logger().warning("got " + m.data), 10)
rclpy.spin(node)
""",
    "far": """
rclpy.init()
node = rclpy.create_node("listener")
queue = []
def work():
    if queue:
        node.get_logger().info("doing " + queue.pop(0))
node.create_subscription(String, "/cmd", lambda message: queue.append(message.data), 10)
node.create_timer(0.7, work)
rclpy.spin(node)
""",
    "own_clock": f"""
rclpy.init()
{STATUS}
clock = node.create_publisher(Clock, "/clock", 10)
node.create_timer(0.5, tell)
rclpy.spin(node)
""",
    "impostor": f"""
rclpy.init()
{STATUS}
node.create_timer(1.0, tell)
context = rclpy.Context()
context.init()
other = rclpy.create_node("status", context=context)
other.create_publisher(String, "/robot/status", 10)
executor = SingleThreadedExecutor(context=context)
executor.add_node(other)
threading.Thread(target=executor.spin, daemon=True).start()
while node.count_publishers("/robot/status") < 2:
    time.sleep(0.01)
rclpy.spin(node)
""",
    "strict": f"""
rclpy.init()
{STATUS}
node.create_timer(float(sys.argv[1]) if len(sys.argv) > 1 else 0.5, tell)
rclpy.spin(node)
""",
    "broken": "import no_such_module",
    "no_node": "time.sleep(3)\nprint('that was all')",
}

# What a thread does, and when, is chance; and what is watched in another way than by itself, twice.
OTHERS = {
    "crowd": """
rclpy.init()
node = rclpy.create_node("crowd")
others = [node.create_publisher(String, f"/a{number}", 1) for number in range(60)]
made = []
def begin():
    made.append(node.create_publisher(String, "/robot/status", 10))
    node.create_timer(0.5, lambda: made[0].publish(String(data="well")))
    start.cancel()
node.create_timer(0.1, lambda: [other.publish(String(data="here")) for other in others])
start = node.create_timer(1.0, begin)
rclpy.spin(node)
""",
    "brief": """
rclpy.init()
node = rclpy.create_node("brief")
publisher = node.create_publisher(String, "/robot/brief", 10)
subscription = node.create_subscription(String, "/robot/command", print, 10)
time.sleep(float(sys.argv[1]))
raise SystemExit("over")
""",
    "gated": _GATED,
    "waits": _WAITS,
    "switched": f"""
from std_srvs.srv import SetBool
rclpy.init()
{STATUS}
on = []
def switch(request, response):
    on[:] = [True] * request.data
    return response
node.create_service(SetBool, "/enable", switch)
node.create_timer(0.2, lambda: on and tell())
rclpy.spin(node)
""",
    "managed": """
from rclpy.lifecycle import Node as Managed, TransitionCallbackReturn
class Status(Managed):
    def on_configure(self, state):
        self.publisher = self.create_lifecycle_publisher(String, "/robot/status", 10)
        self.create_timer(0.5, lambda: self.publisher.publish(String(data="well")))
        willing = sys.argv[1] == "True"
        return TransitionCallbackReturn.SUCCESS if willing else TransitionCallbackReturn.FAILURE
rclpy.init()
rclpy.spin(Status("status"))
""",
    **{
        f"{way}_{name}": _LOCKED.replace("LOCK)", f"{lock.replace('NAME', name)!r})")
        for way, lock in {**_LOCKS, "of_each": _OF_EACH}.items()
        for name in ("first", "too")
    },
    "stops_once_heard": f"""
rclpy.init()
{STATUS}
left = iter(range(5))
def tell_while_any_are_left():
    if publisher.get_subscription_count():  # what stops before it is heard was never a rhythm
        for _ in itertools.islice(left, 1):
            tell()
node.create_timer(0.1, tell_while_any_are_left)
rclpy.spin(node)
""",
    "rate": f"""
rclpy.init()
{STATUS}
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
rate = node.create_rate(0.5)
while rclpy.ok():
    tell()
    rate.sleep()
""",
    "begins": """
rclpy.init()
node = rclpy.create_node("command")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
def drive():
    while rclpy.ok():
        publisher.publish(Twist())
        time.sleep(0.1)
thread = threading.Thread(target=drive, daemon=True)
def hear(message):
    if not thread.is_alive():
        thread.start()
node.create_subscription(String, "/robot/command", hear, 10)
rclpy.spin(node)
""",
    "idle": """
rclpy.init()
rclpy.spin(rclpy.create_node("idle"))
""",
    "forger": """
kept = []
for number in range(2):
    context = rclpy.Context()
    context.init(args=["--ros-args", "--enclave", f"/program_{number}", "-p", "use_sim_time:=true"])
    node = rclpy.create_node(f"forged_{number}", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    kept += [context, node]
    threading.Thread(target=executor.spin, daemon=True).start()
time.sleep(60)
""",
    "asleep": "time.sleep(60)",
    "unspun": f"""
rclpy.init()
others = [Node(f"a_{{number}}") for number in range(25)]
{COMMAND}
node.create_subscription(String, "/robot/command", lambda message: node.get_logger().info("took " + message.data), 10)
rclpy.spin(node)
""",
    "tires_out": f"""
rclpy.init()
{COMMAND}
def obey(message):
    time.sleep(5.0)
    node.get_logger().info("took " + message.data)
node.create_subscription(String, "/robot/command", obey, 10)
rclpy.spin(node)
""",
    "computes": f"""
rclpy.init()
{COMMAND}
def obey(message):
    until = time.monotonic() + 3.0
    while time.monotonic() < until:
        pass
    node.get_logger().info("took " + message.data)
node.create_subscription(String, "/robot/command", obey, 10)
rclpy.spin(node)
""",
    "restarts": f"""
import os
rclpy.init()
{COMMAND}
def obey(message):
    if message.data == "dance":
        os.execv(sys.executable, [sys.executable, *sys.argv])
    node.get_logger().info("took " + message.data)
node.create_subscription(String, "/robot/command", obey, 10)
rclpy.spin(node)
""",
    "elsewhere": """
import os
own = int(os.environ["ROS_DOMAIN_ID"])
kept = []
for domain in [own + 1, own + 2, own + 3, own]:
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node("elsewhere", context=context)
    kept += [context, node, node.create_publisher(String, "/robot/status", 10)]
executor = SingleThreadedExecutor(context=context)
executor.add_node(node)
executor.spin()
""",
}

SCRIPT = Script(assignments.load().commanded)
FLOOD = SCRIPT.flood


@pytest.fixture(scope="module")
def observer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Observer]:
    folder = tmp_path_factory.mktemp("programs")
    for name, source in (PROGRAMS | OTHERS).items():
        (folder / f"{name}.py").write_text(BEGIN + source)
    with (
        World(folder, shown=SHOWN) as world,
        Observer(world, rooms=observe.AT_ONCE, seconds=math.inf) as observer,
    ):
        yield observer


def program(name: str, *parameters: str) -> Program:
    return Program(name, [sys.executable, f"/submission/{name}.py"], parameters=parameters)


class Runs(dict[str, Run]):
    """A run of each program by itself, watched when it is first asked for."""

    def __init__(self, observer: Observer) -> None:
        super().__init__()
        self._observer = observer

    def __missing__(self, name: str) -> Run:
        (self[name],) = self._observer.watch([Job.alone(program(name))])
        return self[name]


@pytest.fixture(scope="module")
def runs(observer: Observer) -> Runs:
    return Runs(observer)


CHANCE = ("seconds", "said", "traceback")


def seen(run: Run) -> str:
    """Write a run without its times, how often something came, and where Ctrl-C met the program.

    What a flood has left in the queues comes after it, more or less of it, sooner or later.
    """
    texts = [command.text for command in run.commands]
    print([(c.text, c.anew) for c in run.commands], run.clock, run.notes)
    steady = texts.index(FLOOD) if FLOOD in texts else len(texts)
    answers = any(one.log or one.topics for one in run.commands[steady:])
    later = [replace(one, log=[], topics={}) for one in run.commands[steady:]]
    run = replace(run, commands=run.commands[:steady] + later)

    def timeless(value: Any) -> Any:
        if isinstance(value, dict) and "times" in value:
            values = sorted({json.dumps(one) for one in value["values"]})
            return [value["type_name"], value["node"], values, value["count"] > 1]
        if isinstance(value, dict):
            return {key: timeless(one) for key, one in value.items() if key not in CHANCE}
        return [timeless(one) for one in value] if isinstance(value, list) else value

    return json.dumps([timeless(asdict(run)), answers], indent=1)


def after(run: Run, text: str) -> CommandSeen:
    return next(command for command in run.commands if command.text == text)


def gaps(run: Run, topic: str) -> list[float]:
    times = run.quiet[topic].times
    return [round(later - earlier, 3) for earlier, later in itertools.pairwise(times)]


# Others of these kinds: each of them is watched once for what is particular about it.
ALIKE = (
    *("class_node", "functions", "wait_loop", "poll_loop", "thread_timer", "own_clock"),
    *("stops", "counts_in_turns", "ends", "begins_late", "prints", "near", "far", "broken", "no_node"),
)


EACH = [pytest.param(name, marks=pytest.mark.thorough if name in ALIKE else ()) for name in PROGRAMS]


# On the stepped clock, and of one that is not what it says: watched a second time in each run.
TWICE = ("three_nodes", "impostor")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in TWICE else pytest.mark.thorough) for name in PROGRAMS]
)
def test_what_is_seen_twice_is_the_same(runs: Runs, observer: Observer, name: str) -> None:
    (again,) = observer.watch([Job.alone(program(name))])
    assert seen(again) == seen(runs[name])


@pytest.mark.parametrize(
    "name", [pytest.param("functions", marks=pytest.mark.thorough), "class_node", "three_nodes"]
)
def test_a_period_is_seen_on_the_stepped_clock(runs: Runs, name: str) -> None:
    run = runs[name]
    assert run.clock == "stepped"
    assert len(gaps(run, "/robot/status")) >= 2
    assert statistics.fmean(gaps(run, "/robot/status")) == pytest.approx(
        2.4 if name == "functions" else 2.0, abs=0.11
    )


def test_a_period_is_seen_where_a_thread_keeps_it(observer: Observer) -> None:
    """On the stepped clock, or on the real one where the thread had no turn in time."""
    (run,) = observer.watch([Job.alone(program("rate"))])
    assert statistics.median(gaps(run, "/robot/status")) == pytest.approx(2.0, abs=0.5)


@pytest.mark.parametrize(
    "name",
    [
        *("sleep_loop", "wait_loop", "sleeping_timer"),
        *(pytest.param(name, marks=pytest.mark.thorough) for name in ("poll_loop", "thread_timer")),
    ],
)
def test_a_period_is_seen_on_the_real_clock(runs: Runs, name: str) -> None:
    run = runs[name]
    assert run.clock == "real"
    assert any("real clock" in note for note in run.notes)
    found = gaps(run, "/robot/status")
    assert found
    # On a busy machine a message may be late; none is missed, and none comes twice.
    assert found == pytest.approx([2.0] * len(found), abs=0.9)


def test_a_parameter_of_a_node_that_sleeps_is_seen(runs: Runs) -> None:
    """On the real clock it may not answer in time; while the clock stands it does."""
    assert runs["sleeping_timer"].parameters == {"/status": {"period": 0.1}}


def test_the_graph_is_seen(runs: Runs) -> None:
    run = runs["three_nodes"]
    assert run.nodes == ["/command", "/status", "/velocity"]
    assert run.publishes == {
        "/robot/status": {"/status": ["std_msgs/msg/String"]},
        "/cmd_vel": {"/velocity": ["geometry_msgs/msg/Twist"]},
    }
    assert run.subscribes == {"/robot/command": {"/command": ["std_msgs/msg/String"]}}
    assert run.qos["/cmd_vel"] == ["publisher reliable volatile"]
    assert runs["class_node"].parameters == {"/status": {"period": 2.0}}


def test_what_follows_each_command_is_seen(runs: Runs) -> None:
    run = runs["three_nodes"]
    texts = [command.text for command in run.commands]
    print([(c.text, c.anew) for c in run.commands], run.clock, run.notes)
    assert texts == [
        "start",
        "stop",
        "reset",
        "START",
        "dance",
        "twirl",
        "",
        "start",
        "dance",
        "twirl",
        FLOOD,
        "start",
        "start",
    ]
    assert after(run, "start").log == [["INFO", "heard start"], ["PRINT", "printed start"]]
    assert after(run, "dance").log == [["INFO", "heard dance"], ["PRINT", "printed dance"]]
    for text, speed in (("start", 0.5), ("stop", 0.0)):
        speeds = {value["linear"]["x"] for value in after(run, text).topics["/cmd_vel"].values}
        assert speeds == {speed}
    assert all(command.is_alive for command in run.commands)
    assert run.stopped["three_nodes"]["last"]["/cmd_vel"]["linear"]["x"] == 0.5
    assert run.stopped["three_nodes"]["traceback"]


def test_a_topic_that_comes_with_a_command_is_heard(runs: Runs) -> None:
    run = runs["after_command"]
    assert run.clock == "stepped"
    assert run.quiet == {}
    assert after(run, "start").topics["/cmd_vel"].count > 1


def test_what_begins_with_a_command_has_time_to_come_again(observer: Observer) -> None:
    (run,) = observer.watch([Job([program("begins")], "alone", is_stepped=False)])
    assert run.quiet == {}
    assert after(run, "start").topics["/cmd_vel"].count > 1


def test_what_begins_with_a_word_of_its_own_has_time_to_come_again(tmp_path: Path) -> None:
    """It may be the word for driving by itself, and the next one ends it."""
    (tmp_path / "has_modes.py").write_text(
        BEGIN
        + f"""
rclpy.init()
{COMMAND}
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
mode = []
node.create_subscription(String, "/mode", lambda message: mode.append(message.data), 10)
node.create_timer(0.2, lambda: mode[-1:] == ["auto"] and publisher.publish(Twist()))
rclpy.spin(node)
"""
    )
    assignment = assignments.load().with_own_words(["auto", "manual"])
    with World(tmp_path, shown=SHOWN) as world, Observer(world, assignment, seconds=math.inf) as observer:
        (run,) = observer.watch([Job([program("has_modes")], "alone", is_stepped=False)])
    assert run.quiet == {}
    assert next(command.text for command in run.commands if command.topics) == "auto"
    assert after(run, "auto").topics["/cmd_vel"].count > 1


def test_a_program_that_dies_of_a_command_is_seen_to(runs: Runs) -> None:
    run = runs["dies"]
    assert [(command.text, command.is_alive) for command in run.commands] == [
        ("start", True),
        ("stop", True),
        ("reset", True),
        ("START", True),
        ("dance", False),
    ]
    assert "KeyError: 'dance'" in run.ended["dies"]


def test_a_program_that_starts_itself_anew_is_seen_to(observer: Observer) -> None:
    """It is another participant from then on, whether it is met before the next command or after it."""
    (run,) = observer.watch([Job.alone(program("restarts"))])
    texts = [command.text for command in run.commands]
    anew = [number for number, command in enumerate(run.commands) if command.anew]
    assert all(run.commands[number].anew == ["/command"] for number in anew)
    assert texts.index("dance") <= anew[0]
    assert run.ended == {}


def test_a_program_that_lives_on_is_not_there_anew(runs: Runs) -> None:
    assert not any(command.anew for command in runs["class_node"].commands)


def test_a_program_that_cannot_start_says_why(runs: Runs) -> None:
    assert "no_such_module" in runs["broken"].ended["broken"]
    assert runs["no_node"].ended == {"no_node": "that was all"}


def test_what_is_asked_for_is_heard_among_many_other_topics(observer: Observer) -> None:
    """Also if it comes after all of them: which of them are heard is chance, and no grade may depend on it."""
    (run,) = observer.watch([Job.alone(program("crowd"))])
    assert run.quiet["/robot/status"].count > 1
    assert len(run.quiet) <= TOPICS + 1


@pytest.mark.parametrize("seconds", [0.0, 0.2, 1.0])
def test_what_is_gone_before_it_does_anything_is_seen_in_no_run(observer: Observer, seconds: float) -> None:
    """Whether a node that lives for a moment is seen is chance, and no grade may depend on it."""
    brief = replace(program("brief"), command=[*program("brief").command, str(seconds)])
    first, beside = observer.watch([Job.alone(brief), Job.together([brief, program("class_node")])])
    assert not first.nodes
    assert not first.publishes
    assert not first.qos
    assert "/brief" not in beside.nodes
    assert "/status" in beside.nodes
    assert first.early == ["brief"]


def test_a_program_that_takes_no_ros_arguments_is_started_without_them(runs: Runs) -> None:
    run = runs["strict"]
    assert (run.clock, run.nodes, run.ended) == ("real", ["/status"], {})
    assert run.quiet["/robot/status"].count > 2


@pytest.mark.thorough
def test_too_much_is_cut(runs: Runs) -> None:
    assert "/robot/status was cut: too many messages, or too large ones." in runs["spams"].notes
    assert runs["prints"].ended == {"prints": "It wrote more than 5 MB."}


def test_a_topic_one_letter_away_is_used_and_told(runs: Runs) -> None:
    run = runs["near"]
    assert ["WARN", "got start"] in after(run, "start").log
    assert run.commanded == "/robot/comand"


def test_another_topic_is_used_and_what_a_timer_does_later_is_seen(runs: Runs) -> None:
    run = runs["far"]
    for word in ("start", "stop", "reset"):
        assert after(run, word).log == [["INFO", f"doing {word}"]]
    assert "/cmd" in run.commanded


def test_a_clock_of_the_submission_does_not_count(runs: Runs) -> None:
    run = runs["own_clock"]
    assert run.clock == "real"
    assert "The submission publishes /clock itself." in run.notes
    assert statistics.median(gaps(run, "/robot/status")) == pytest.approx(0.5, abs=0.2)


@pytest.mark.parametrize("name", EACH)
def test_a_rhythm_that_stops_is_noticed(runs: Runs, name: str) -> None:
    run = runs[name]
    has_stopped = name in ("stops", "stops_later", "counts_to_its_end")
    if has_stopped:
        assert (run.clock, run.notes, run.stalled) == ("stepped", [], ["/robot/status"])
    else:
        assert run.stalled == []


def test_what_came_before_a_rhythm_stopped_is_kept(runs: Runs) -> None:
    assert runs["stops"].quiet["/robot/status"].count == 5


def test_a_rhythm_that_stops_is_noticed_on_the_real_clock(observer: Observer) -> None:
    (run,) = observer.watch([Job([program("stops_once_heard")], "alone", is_stepped=False)])
    assert run.stalled == ["/robot/status"]


def test_what_is_published_only_later_is_heard_on_the_stepped_clock(runs: Runs) -> None:
    run = runs["begins_late"]
    assert (run.clock, run.notes) == ("stepped", [])
    assert set(gaps(run, "/robot/status")) == {0.1}


def test_a_program_that_has_told_enough_is_seen_to_end(runs: Runs) -> None:
    assert runs["ends"].ended == {"ends": "enough"}


def test_what_a_thread_answers_late_is_heard_after_its_command(runs: Runs) -> None:
    run = runs["answers_late"]
    for word in ("start", "stop", "reset", "dance"):
        assert [text for _, text in after(run, word).log] == [f"heard {word}"]


def test_what_a_timer_tells_late_is_heard_after_its_command(runs: Runs) -> None:
    run = runs["tells_late"]
    assert run.clock == "stepped"
    for word in ("start", "stop", "reset", "dance"):
        told = after(run, word).topics["/robot/status"].values
        assert {one["data"] for one in told} == {word}


def test_an_impostor_is_noted(runs: Runs) -> None:
    assert {
        "2 programs publish on /robot/status, or one that joins ROS as often.",
        "Nodes joined ROS as if they were of more programs than were started: 2 instead of 1.",
        "Two nodes have the name /status.",
    } <= set(runs["impostor"].notes)


def test_what_is_watched_for_one_program_no_other_one_plays(observer: Observer) -> None:
    """Whichever domains it joins: what counts for a program comes from it."""
    jobs = [program("elsewhere"), *[program("idle")] * 3]
    elsewhere, *idle = observer.watch([Job.alone(one) for one in jobs])
    assert (elsewhere.nodes, elsewhere.ended) == (["/elsewhere"], {})
    for run in idle:
        assert (run.nodes, run.publishes, run.notes) == (["/idle"], {}, [])


@pytest.mark.thorough
def test_what_a_program_does_in_the_name_of_another_one_is_shared_out_to_none(observer: Observer) -> None:
    """A node may tell any enclave: it is of that program if it answers while all others are held."""
    jobs = [
        Job.shared([program(name), program(other)], has_commands=False)
        for name, other in (("idle", "class_node"), ("forger", "asleep"))
    ]
    observer.watch(jobs)
    honest, forged = (job.shares() for job in jobs)
    assert [run.nodes for run in honest] == [["/idle"], ["/status"]]
    assert forged == []


def test_one_run_tells_of_another_period_and_of_the_commands_once_more(observer: Observer) -> None:
    job = Job.again([program("class_node"), program("after_command")], [program("class_node", "period:=1.0")])
    (run,) = observer.watch([job])
    (share,) = job.shares()
    assert (share.setting, share.programs, share.commands) == ("period:=1.0", ["class_node"], [])
    assert statistics.fmean(gaps(share, "/robot/status")) == pytest.approx(1.0, abs=0.11)
    assert (run.setting, run.programs) == ("together", ["class_node", "after_command"])
    assert (run.changed, [*run.parameters]) == (["class_node"], ["/command"])
    assert [one.text for one in run.commands] == [*SCRIPT.few]
    assert run.unasked == set()


def test_what_one_run_does_not_tell_is_watched_apart(observer: Observer) -> None:
    """A program that ends leaves it open what each of them does."""
    job = Job.again([program("broken"), program("class_node")], [program("class_node", "period:=1.0")])
    observer.watch([job])
    assert job.shares() == []
    changed, whole = job.apart()
    assert [one.parameters for one in changed.programs] == [("period:=1.0",)]
    assert [one.parameters for one in whole.programs] == [(), ()]
    assert (whole.setting, whole.is_shared, whole.plan["has_commands"]) == ("together", False, True)


def test_what_a_hidden_node_has_is_nobodys_work() -> None:
    """Each `ros2 topic` has one, and a program may be nothing but such a command."""
    names = ("_ros2cli_2", "drive")
    infos = [SimpleNamespace(node_name=name, node_namespace="/", topic_type=TWIST) for name in names]
    ends: dict[str, dict[str, list[str]]] = {}
    add_types(ends, "/cmd_vel", infos)
    assert ends == {"/cmd_vel": {"/drive": [TWIST]}}


def test_files_that_cannot_be_copied_are_an_outcome(tmp_path: Path) -> None:
    with World(tmp_path, shown=SHOWN) as world, Observer(world) as observer:
        deep = "import os\nfor _ in range(3000):\n    os.mkdir('d')\n    os.chdir('d')\n"
        assert world.run([sys.executable, "-c", deep], files="write", cwd="/submission").code == 0
        (run,) = observer.watch([Job.alone(program("class_node"))])
    assert run.notes[0].startswith("This could not be watched: ")


def test_what_takes_too_long_is_cut_and_does_not_count_as_an_end(
    observer: Observer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(observe, "RUN_TIMEOUT", 5.0)  # s, in which a busy machine starts Python
    (run,) = observer.watch([Job([program("sleep_loop"), program("broken")], "together")])
    assert run.unfinished == "it was not seen to its end within 5 s"
    assert [*run.ended] == ["broken"]


@pytest.mark.parametrize("name", ["tires_out", pytest.param("computes", marks=pytest.mark.thorough)])
def test_of_what_is_slow_to_take_commands_a_few_are_asked(observer: Observer, name: str) -> None:
    """Each command, and unknown ones, in the time that there is for a run; it has not ended of that."""
    (run,) = observer.watch([Job.alone(program(name))])
    assert {"start", "stop", "reset"} <= {command.text for command in run.commands}
    assert FLOOD not in [command.text for command in run.commands]
    assert ["INFO", "took stop"] in after(run, "stop").log
    assert all(command.is_alive for command in run.commands)
    assert (run.unfinished, run.ended) == ("", {})


@pytest.mark.thorough
def test_nodes_that_nobody_spins_leave_time_for_the_commands(
    observer: Observer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However many they are, they are waited for all at once, and after the one that has a part."""
    monkeypatch.setattr(observe, "RUN_TIMEOUT", 60.0)
    (run,) = observer.watch([Job.alone(program("unspun"), is_stepped=False)])
    assert len(run.nodes) == 26
    assert ["INFO", "took stop"] in after(run, "stop").log
    assert run.unfinished == ""


def test_what_is_slow_leaves_time_to_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of those that are watched at a time is seen, and has commands, before their time is over."""
    monkeypatch.setattr(observe, "LEAST_TIMEOUT", 8.0)  # s, in which a busy machine starts Python
    names = ["tires_out", "asleep", "class_node"]
    for name in names:
        (tmp_path / f"{name}.py").write_text(BEGIN + OTHERS.get(name, "") + PROGRAMS.get(name, ""))
    with World(tmp_path, shown=SHOWN) as world, Observer(world, seconds=1.0) as observer:
        slow, mute, quick = observer.watch([Job.alone(program(name)) for name in names])
        assert slow.nodes == ["/command"]
        assert (mute.unfinished, mute.notes[-1]) == ("", "No node of it was there within 8 s.")
        assert mute.nodes == []
        assert quick.nodes == []
        assert quick.unfinished == "others of the submission took 1 s"


def test_an_observer_that_does_not_come_to_its_end_is_given_up(
    observer: Observer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever keeps it busy: programs that publish without end, or that are thousands of nodes."""
    with monkeypatch.context() as patch:
        patch.setattr(observe, "OBSERVER_TIMEOUT", 0.5)
        (run,) = observer.watch([Job.alone(program("sleep_loop"))])
    assert run.unfinished == "the observer itself has failed (it did not come to its end within 0.5 s)"
    (run,) = observer.watch([Job.alone(program("class_node"), has_commands=False)])
    assert run.nodes == ["/status"]


def test_what_no_time_is_left_for_is_not_watched(observer: Observer, monkeypatch: pytest.MonkeyPatch) -> None:
    """However many programs a submission has, and however long each takes."""
    monkeypatch.setattr(observer, "_seconds_left", -1.0)
    runs = observer.watch([Job.alone(program("sleep_loop")), Job.alone(program("class_node"))])
    assert [(run.nodes, run.unfinished) for run in runs] == [([], "others of the submission took inf s")] * 2


def test_programs_hear_one_another_only_together(observer: Observer) -> None:
    (run,) = observer.watch([Job.together([program("three_nodes"), program("class_node")])])
    assert "Two nodes have the name /status." in run.notes
    assert run.publishes["/robot/status"] == {"/status": ["std_msgs/msg/String"]}
    assert "2 programs publish on /robot/status, or one that joins ROS as often." in run.notes


@pytest.mark.parametrize(
    ("gate", "is_opened"),
    [
        ("has('/one') is True", True),
        ("[*map(has, ('/one', '/two'))] == [False, True]", True),
        ("has('/one') is has('/two') is not None and not has('/three')", True),
        ("has('/one') in ('now', 'later') or has('/two') == 'now'", False),
    ],
)
def test_what_waits_for_flags_is_given_them_in_each_way(
    observer: Observer, gate: str, is_opened: bool
) -> None:
    names = [name for name in ("/one", "/two", "/three") if name in gate]
    waiting = replace(program("gated"), command=[*program("gated").command, gate, *names])
    (run,) = observer.watch([Job.given([waiting], {})])
    assert run.gave == dict.fromkeys(sorted(names), "std_msgs/msg/Bool")
    assert run.waits == run.given == sorted(names)
    assert ("/robot/status" in run.meanwhile) == is_opened


@pytest.mark.parametrize(
    ("what", "heard"),
    [
        (["Float32", "message.data < -5.0", "out.publish(Twist())"], ["/cmd_vel"]),
        (["String", "message.data == 'ready'", "out.publish(Twist())"], ["/cmd_vel"]),
        pytest.param(
            ["String", "message.data == 'other'", "out.publish(Twist())"], [], marks=pytest.mark.thorough
        ),
        (["Float32", "False", "out.publish(Twist())"], []),
        (["Twist", "True", "out.publish(message)"], ["/cmd_vel"]),
        (["Twist", "message.linear.x < 5.0", "message.linear.x /= 2; out.publish(message)"], ["/cmd_vel"]),
        (["Twist", "message.linear.x > 0.0", "out.publish(message)"], ["/cmd_vel"]),  # it holds some back
        (["TwistStamped", "True", "out.publish(message.twist)"], ["/cmd_vel"]),
        (["Vector3", "True", "out.publish(Twist(linear=message))"], ["/cmd_vel"]),
        (["Vector3", "message.x < 5.0", "message.x /= 2; out.publish(Twist(linear=message))"], ["/cmd_vel"]),
    ],
)
def test_what_waits_for_a_message_is_given_it(observer: Observer, what: list[str], heard: list[str]) -> None:
    """At and around what its code compares, whatever the type; what only hands it on is told."""
    waiting = replace(program("waits"), command=[*program("waits").command, *what])
    contents = {"input": {"words": ["ready"], "numbers": [-5.0]}}
    (run,) = observer.watch([Job.given([waiting], contents)])
    assert [*run.gave] == ["/input"]
    assert [*run.meanwhile] == heard
    assert run.handed_on == (heard if what[1] == "True" else [])
    assert (run.ungiven, run.unfinished) == ({}, "")
    assert "/cmd_vel" not in run.quiet


def test_what_a_request_switches_on_is_left_on(observer: Observer) -> None:
    """So that its rhythm is seen, whatever the last request but one was."""
    (run,) = observer.watch([Job.given([program("switched")], {})])
    assert run.given == ["/enable"]
    assert run.quiet["/robot/status"].count > 3


@pytest.mark.parametrize("is_willing", [True, False])
def test_a_managed_node_is_told_to_begin(observer: Observer, is_willing: bool) -> None:
    """One that refuses would do so wherever it is told to."""
    managed = replace(program("managed"), command=[*program("managed").command, str(is_willing)])
    (run,) = observer.watch([Job.given([managed], {})])
    assert ("/robot/status" in {*run.meanwhile, *run.quiet}) == is_willing
    assert "/status/change_state" in run.given


@pytest.mark.parametrize(
    "way",
    # What lies in /tmp and at home is shared by two other ways, too.
    [
        pytest.param(way, marks=pytest.mark.thorough if way in ("new_file", "foreign_home") else ())
        for way in _LOCKS
    ],
)
def test_programs_that_lock_each_other_out_are_seen_to(observer: Observer, way: str) -> None:
    """Alone each goes on; beside each other one has ended before any command."""
    both = [program(f"{way}_first"), program(f"{way}_too")]
    first, second, together = observer.watch([*map(Job.alone, both), Job.together(both)])
    assert not first.ended
    assert not second.ended
    assert len(together.early) == 1
    assert shut_out([first, second, together]) == {together.early[0]: "The robot is busy."}


def test_a_lock_of_each_program_keeps_nobody_out(observer: Observer) -> None:
    both = [program("of_each_first"), program("of_each_too")]
    (together,) = observer.watch([Job.together(both)])
    assert together.ended == {}


def test_what_a_launch_command_starts_is_seen(observer: Observer) -> None:
    starts = [f"{sys.executable} /submission/{name}.py &" for name in ("near", "class_node")]
    launch = Program("all.launch.py", ["bash", "-c", " ".join([*starts, "wait"])])
    (run,) = observer.watch([Job.launched(launch, nodes=2)])
    assert run.setting == "launched"
    assert run.nodes == ["/command", "/status"]
    assert run.quiet["/robot/status"].count >= 1
    assert ["WARN", "got start"] in after(run, "start").log


def test_a_parameter_takes_effect(observer: Observer) -> None:
    (run,) = observer.watch([Job.alone(program("class_node", "period:=1.0"), has_commands=False)])
    assert run.setting == "period:=1.0"
    assert set(gaps(run, "/robot/status")) == {1.0}


def test_after_the_observer_has_ended_another_one_goes_on(observer: Observer) -> None:
    observer._rooms[0]._box.kill()
    (lost,) = observer.watch([Job.alone(program("class_node"))])
    assert lost.unfinished.startswith("the observer itself has failed (")
    (run,) = observer.watch([Job.alone(program("class_node"), has_commands=False)])
    assert run.nodes == ["/status"]
