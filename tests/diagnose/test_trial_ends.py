"""What is said of programs that end, or do not end, while they are watched."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import FAILED, STRING, build, run_of

from ros2lab import assignments
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import Clock, CommandSeen, Heard, Run
from ros2lab.trial import try_out
from ros2lab.trial.run import _why_none
from ros2lab.trial.seen import Seen, seen_faults
from ros2lab.trial.starts import own_file
from ros2lab.trial.story import told_of

SAID = Heard(STRING, "/status_publisher", [0.0, 0.5, 1.0], [{"data": "start"}] * 3, 3)
OTHER = "Traceback (most recent call last):\nKeyError: 'left'"


def told(root: Path, alone: Run, *together: Run) -> list[Finding]:
    return [*seen_faults(Seen(Look(root), assignments.load(), [alone], together))]


@pytest.mark.parametrize(
    ("alone", "together", "word", "is_told"),
    [
        ("", FAILED, None, True),
        (FAILED, FAILED, None, True),  # once
        ("[ERROR] [status_publisher]: nobody answers", FAILED, None, True),
        ("", "[ERROR] [status_publisher]: there is no lamp", None, False),  # it means what it says
        ("", FAILED, "dance", False),  # what we sent, and no node of the workspace sends
        ("", "", None, False),
    ],
)
def test_an_exception_that_comes_only_among_the_others_is_told_once(
    tmp_path: Path, alone: str, together: str, word: str | None, is_told: bool
) -> None:
    """It may come of a message or a call of another program."""
    run = run_of("status_publisher", "/robot/report", STRING, SAID)
    run = replace(run, subscribes={"/robot/command": {"/status_publisher": [STRING]}})
    command = CommandSeen(word or "", [["ERROR", FAILED.splitlines()[0]]], {}, {}, is_alive=False)
    found = told(
        right_workspace().write(tmp_path),
        replace(run, ended={"status_publisher": alone} if alone else {}),
        replace(
            run,
            setting="together",
            ended={"status_publisher": together} if together else {},
            commands=[command] if word else [],
        ),
    )
    assert [one.code for one in found] == ["python-error"] * is_told


@pytest.mark.parametrize(
    ("line", "error", "word", "is_told"),
    [
        ("size = int(msg.data)", "ValueError: invalid literal for int() with base 10: 'dance'", "dance", False),
        ("size = json.loads(msg.data)", "json.decoder.JSONDecodeError: Expecting value: line 1 column 1 (char 0)", "dance", False),
        ("self.state = Mode(msg.data)", "ValueError: 'dance' is not a valid Mode", "dance", False),
        ("left, right = msg.data.split()", "ValueError: not enough values to unpack (expected 2, got 1)", "dance", False),
        ("raise RuntimeError('what is that?')", "RuntimeError: what is that?", "dance", False),
        ("self.state = STATES[msg.data]", "KeyError: 'dance'", "dance", False),
        ("words = msg.data.split()\n        self.state = words[1]", "IndexError: list index out of range", "dance", False),
        ("self.state = STATES[msg.data]", "KeyError: 'start'", "start", True),
        ("self.state = STATES['speed']", "KeyError: 'speed'", "dance", True),
        ("self.state = self.sizes[3]", "IndexError: list index out of range", "dance", True),
        ("self.loger.info(msg.data)", "AttributeError: 'CommandSubscriber' object has no attribute 'loger'", "dance", True),
    ],
)  # fmt: skip
def test_what_a_text_of_no_meaning_does_is_no_fault(
    tmp_path: Path, line: str, error: str, word: str, *, is_told: bool
) -> None:
    """What it does to every text is, and what it does to a word of its own."""
    head = "    def command_callback(self, msg):\n"
    root = right_workspace().change("listener", head, f"{head}        {line}\n").write(tmp_path)
    (path,) = root.glob("src/*/*/command_subscriber.py")
    last = line.splitlines()[-1].strip()
    number = next(n for n, text in enumerate(found_text(root), 1) if text.strip() == last)
    said = f'Traceback (most recent call last):\n  File "{path}", line {number}, in command_callback\n    {last}\n{error}\n'
    command = CommandSeen(word, [["ERROR", said.splitlines()[0]]], {}, {}, is_alive=False)
    run = run_of("command_subscriber", "/robot/echo", STRING, None)
    run = replace(run, commands=[command], ended={"command_subscriber": said}, commanded="/robot/command")
    assert bool(told(root, run)) is is_told


def test_of_a_client_what_happens_among_the_nodes_that_it_asks_is_told(tmp_path: Path) -> None:
    """Alone it fails at another thing: there is nobody to answer."""
    made = "        self.count = 0\n"
    files = right_workspace()
    files.change("node", made, f"{made}        self.client = self.create_client(Trigger, 'go')\n")
    run = run_of("status_publisher", "/robot/report", STRING, SAID)
    alone, among = ({"status_publisher": said} for said in (FAILED, OTHER))
    found = told(
        files.write(tmp_path), replace(run, ended=alone), replace(run, setting="together", ended=among)
    )
    assert len(found) == 1
    assert "left" in found[0].cause


def test_a_real_callback_that_fails_at_another_nodes_message_is_told_with_its_line(tmp_path: Path) -> None:
    """Also where another exception follows while it is handled: all of what was printed is read."""
    files = right_workspace()
    files.change(
        "listener",
        "        self.state = 'idle'\n",
        "        self.state = 'idle'\n        self.create_subscription(String, '/robot/report', self.add, 10)\n",
    )
    files.change(
        "listener",
        "    def command_callback(self, msg):",
        "    def add(self, msg):\n        try:\n            self.total = self.sum + 1\n"
        "        except AttributeError:\n            self.total = 1 + msg\n\n"
        "    def command_callback(self, msg):",
    )
    root = files.only("node", "listener").write(tmp_path)
    build(root)
    (found,) = try_out(root).findings
    line = next(n for n, text in enumerate(found_text(root), 1) if "self.sum + 1" in text)
    assert found.code == "attribute-missing"  # the first of the two
    assert found.place.endswith(f"command_subscriber.py:{line}")


def found_text(root: Path) -> list[str]:
    (path,) = root.glob("src/*/*/command_subscriber.py")
    return path.read_text().splitlines()


EXECUTOR = '  File "/opt/ros/jazzy/lib/python3/site-packages/rclpy/executors.py", line 518, in handler\n'
TRY = "    try:\n        rclpy.spin(node)\n"


def seen_unspun(
    tmp_path: Path,
    main: str,
    line: str,
    *,
    before: str = "",
    makes: str = "self.client = self.create_client(Trigger, 'go')",
) -> Finding:
    """Return what is told of a program whose node is not spun, and that stands in a line at Ctrl-C."""
    files = right_workspace()
    files.change("node", "        self.count = 0\n", f"        self.count = 0\n        {makes}\n")
    root = files.change("node", TRY, main).write(tmp_path)
    (path,) = root.glob("src/*/*/status_publisher.py")
    number = next((n for n, text in enumerate(path.read_text().splitlines(), 1) if line and line in text), 0)
    said = f'{before}  File "{path}", line {number}, in main\nKeyboardInterrupt\n' if number else ""
    run = run_of("status_publisher", "/robot/report", STRING, SAID)
    run = replace(run, parameters={}, stopped={"status_publisher": {"said": said}})
    (found,) = told(root, run, replace(run, setting="together"))
    assert found.code == "not-spinning"
    assert not number or found.place.rpartition(":")[2].isdigit()
    return found


ASKING = "    answer = node.client.call(Trigger.Request())\n    try:\n        rclpy.spin(node)\n"
POLLING = (
    "    future = node.client.call_async(Trigger.Request())\n    while not future.done():\n        time.sleep(0.1)\n"
    f"{TRY}"
)


@pytest.mark.parametrize(
    ("main", "line", "fix"),
    [
        (ASKING, "client.call(", "`rclpy.spin_until_future_complete(node, future)` and `answer = future.result()`"),
        (ASKING.replace("    try:\n        rclpy.spin(node)", "    try:\n        pass"), "", "rclpy.spin_until_future_complete(node, future)"),
        (POLLING, "time.sleep", "rclpy.spin_until_future_complete(node, future)` instead of this loop"),
        (f"    node.came.wait()\n{TRY}", "came.wait", "threading.Thread(target=rclpy.spin, args=(node,), daemon=True)"),
        (TRY, "self.publisher_.publish", "do not wait, sleep or loop"),  # a method that does not return
        (TRY, "", "do not wait, sleep or loop"),
    ],
)  # fmt: skip
def test_what_waits_for_what_only_a_spin_brings_is_told_with_its_line(
    tmp_path: Path, main: str, line: str, fix: str
) -> None:
    """As Ctrl-C shows it, where the program does not catch that."""
    assert fix in seen_unspun(tmp_path, main, line).fix


def test_a_callback_that_waits_for_an_answer_is_to_be_called_back(tmp_path: Path) -> None:
    """It cannot spin: what called it spins."""
    found = seen_unspun(tmp_path, ASKING, "client.call(", before=EXECUTOR)
    assert "add_done_callback" in found.fix
    assert "spin_until" not in found.fix


def test_who_asks_a_service_may_wait_for_it_alone(tmp_path: Path) -> None:
    """Among the others it is spun."""
    files = right_workspace()
    made = "        self.count = 0\n"
    files.change("node", made, f"{made}        self.client = self.create_client(Trigger, 'go')\n")
    run = run_of("status_publisher", "/robot/report", STRING, SAID)
    assert told(files.write(tmp_path), replace(run, parameters={}), replace(run, setting="together")) == []


@pytest.mark.parametrize(
    ("added", "is_told"),
    [
        ("executor.add_node(node)", True),
        ("executor.add_node(node)\n    executor.add_node(second)", False),
        ("for one in (node, second):\n        executor.add_node(one)", False),
    ],
)
def test_a_node_that_was_not_added_is_to_be_added(tmp_path: Path, added: str, is_told: bool) -> None:
    """To the executor that has the others; where all were added, it does not answer for another reason."""
    main = f"    second = StatusPublisher()\n    executor = MultiThreadedExecutor()\n    {added}\n    try:\n        executor.spin()\n"
    found = seen_unspun(tmp_path, main, "", makes="self.size = 0")
    assert ("executor.add_node(second)" in found.fix) is is_told
    assert ("do not wait, sleep" in found.fix) is not is_told


@pytest.mark.parametrize(
    ("also", "is_told"),
    [
        ("", False),
        ("second.create_timer(1.0, lambda: out.publish(String()))", True),
        ("second.create_client(Trigger, 'go')", True),
        ("watch(second)", True),
    ],
)
def test_a_node_that_only_publishes_needs_no_spin(tmp_path: Path, also: str, is_told: bool) -> None:
    made = f"    second = rclpy.create_node('second')\n    out = second.create_publisher(String, 'other', 10)\n    {also or 'pass'}\n"
    files = right_workspace()
    main = f"{made}    executor = MultiThreadedExecutor()\n    executor.add_node(node)\n    try:\n        executor.spin()\n"
    root = files.change("node", TRY, main).write(tmp_path)
    run = run_of("status_publisher", "/robot/report", STRING, SAID)
    run = replace(run, nodes=["/second"], parameters={})
    assert [one.code for one in told(root, run)] == ["not-spinning"] * is_told


@pytest.mark.parametrize(
    ("main", "is_told"),
    [
        ("    while rclpy.ok():\n        wait_for_message(String, node, 'other', time_to_wait=1.0)\n", False),
        ("    node.create_subscription(String, 'other', print, 10)\n    while rclpy.ok():\n        time.sleep(1.0)\n", True),
        ("    node.create_subscription(String, 'other', lambda msg: None, 10)\n    node.rate.sleep()\n", True),
    ],
)  # fmt: skip
def test_a_program_without_callbacks_needs_no_spin(tmp_path: Path, main: str, *, is_told: bool) -> None:
    """It may receive without: what it subscribes to then, it gets as it asks."""
    files = right_workspace().change(
        "node", "    node = StatusPublisher()\n", "    node = rclpy.create_node('status_publisher')\n"
    )
    root = files.change(
        "node", "    try:\n        rclpy.spin(node)\n", f"{main}    try:\n        pass\n"
    ).write(tmp_path)
    run = replace(run_of("status_publisher", "/robot/report", STRING, SAID), parameters={})
    run = replace(run, subscribes={"/other": {"/status_publisher": [STRING]}})
    assert [one.code for one in told(root, run)] == ["not-spinning"] * is_told


@pytest.mark.parametrize(
    ("loop", "names"),
    [
        ("    while rclpy.ok():\n        rclpy.spin_once(node, timeout_sec=0.0)\n        time.sleep(3.0)\n", {"timer_callback"}),
        ("", set()),
    ],
)  # fmt: skip
def test_a_node_whose_callbacks_ran_is_spun_now_and_then(tmp_path: Path, loop: str, names: set[str]) -> None:
    """Then it is not said that it is not spun; of one with a lasting spin, it is a callback that does not return."""
    found = seen_unspun(tmp_path, f"{loop}    try:\n        {'pass' if loop else 'rclpy.spin(node)'}\n", "")
    lines = next(tmp_path.glob("src/*/*/status_publisher.py")).read_text().splitlines()
    places = [int(place.rpartition(":")[2]) for place in found.never]
    assert {lines[line - 1].split("(")[0].split()[-1] for line in places} == names


@pytest.mark.parametrize(
    ("line", "is_told"),
    [
        ("kind = sys.argv[1]", False),
        ("period = float(remove_ros_args(sys.argv)[1])", False),
        ("words = sys.argv[1:]\n    print(words[0])", False),
        ("words = []\n    print(words[0])", True),
    ],
)
def test_a_program_that_wants_arguments_has_no_fault(tmp_path: Path, line: str, is_told: bool) -> None:
    """It is given none while it is watched."""
    init = "    rclpy.init(args=args)\n"
    root = right_workspace().change("node", init, f"{init}    {line}\n").write(tmp_path)
    (path,) = root.glob("src/*/*/status_publisher.py")
    last = line.splitlines()[-1].strip()
    number = next(n for n, text in enumerate(path.read_text().splitlines(), 1) if text.strip() == last)
    said = f'Traceback (most recent call last):\n  File "{path}", line {number}, in main\n    {last}\nIndexError: list index out of range\n'
    run = replace(run_of("status_publisher", "/robot/report", STRING, None), ended={"status_publisher": said})
    assert [one.code for one in told(root, run)] == ["python-error"] * is_told
    story = told_of(Seen(Look(root), assignments.load(), [run], []), run, {})
    assert ("without the arguments that it reads" in story) is not is_told
    assert "the last that it printed is 'IndexError: list index out of range'" in story


@pytest.mark.parametrize(
    ("is_built", "has_program", "said"),
    [
        (False, True, "build the workspace"),
        (True, True, "build the workspace"),
        (True, False, "only installed"),
    ],
)
def test_it_is_said_why_nothing_is_run(tmp_path: Path, is_built: bool, has_program: bool, said: str) -> None:
    files = right_workspace()
    if not has_program:
        (points,) = re.findall(r"'console_scripts': \[.*?\]", files.texts[files.path("setup.py")], re.DOTALL)
        files.change("setup.py", points, "'console_scripts': []")
    root = files.write(tmp_path)
    for package in root.glob("src/*") if is_built else ():
        index = root / "install" / package.name / "share/ament_index/resource_index/packages"
        index.mkdir(parents=True)
        (index / package.name).touch()
        (root / "install/setup.bash").touch()
    assert said in _why_none(Look(root))


THREAD = "self.reader = threading.Thread(target=self.read)"
READ = "\n    def read(self):\n        while True:\n            time.sleep(1.0)\n\n    def timer_callback"
DEAF = "    while True:\n        try:\n            rclpy.spin_once(node)\n        EXCEPT\n    try:\n        pass\n"


@pytest.mark.parametrize(
    ("made", "read", "main", "fix"),
    [
        (THREAD, READ, TRY, "write `threading.Thread(target=self.read, daemon=True)`"),
        (THREAD.replace("read)", "read, daemon=False)"), READ, TRY, "write `threading.Thread(target=self.read, daemon=True)`"),
        ("self.again = threading.Timer(1.0, self.read)", READ, TRY, "write `self.again.daemon = True`"),
        (THREAD.replace("read)", "read, daemon=True)"), READ, TRY, ""),
        (f"{THREAD}\n        self.reader.daemon = True", READ, TRY, ""),
        (THREAD, READ.replace("True", "rclpy.ok()"), TRY, ""),
        ("self.size = 0", READ, DEAF.replace("EXCEPT", "except:\n            pass"), "write `except Exception:` instead of `except:`"),
        ("self.size = 0", READ, DEAF.replace("EXCEPT", "except KeyboardInterrupt:\n            print('no')"), "write `break` in it"),
        ("self.size = 0", READ, DEAF.replace("EXCEPT", "except KeyboardInterrupt:\n            break"), ""),
        ("self.size = 0", READ, DEAF.replace("EXCEPT", "except Exception:\n            pass"), ""),
    ],
)  # fmt: skip
def test_what_keeps_a_program_after_ctrl_c_is_told(
    tmp_path: Path, made: str, read: str, main: str, fix: str
) -> None:
    """Of a program that had to be killed only, and only where the files tell why."""
    files = right_workspace()
    files.change("node", "        self.count = 0\n", f"        self.count = 0\n        {made}\n")
    files.change("node", "\n    def timer_callback", read)
    files.change("node", "import rclpy\n", "import threading\nimport time\n\nimport rclpy\n")
    root = files.change("node", TRY, main).write(tmp_path)
    run = run_of("status_publisher", "/robot/report", STRING, SAID)

    def ends(*, killed: bool) -> list[Finding]:
        return told(root, replace(run, stopped={"status_publisher": {"said": "", "killed": killed}}))

    found = ends(killed=True)
    assert [one.code for one in found] == ["never-ends"] * bool(fix)
    assert fix in "".join(one.fix for one in found)
    assert ends(killed=False) == []


@pytest.mark.parametrize(
    ("files", "is_given"),
    [
        ({"config/lamp.yaml": "status_publisher:\n  ros__parameters:\n    size: 3\n"}, True),
        ({"config/lamp.yaml": "/bot/status_publisher:\n  ros__parameters:\n    size: 3\n"}, True),
        ({"config/lamp.yaml": "status_publisher:\n  ros__parameters:\n    size:3\n"}, False),  # it cannot be read
        ({"config/lamp.yaml": "driver:\n  ros__parameters:\n    size: 3\n"}, False),
        ({f"config/{n}.yaml": f"status_publisher:\n  ros__parameters:\n    size: {n}\n" for n in "34"}, False),
        ({"config/lamp.yaml": ""}, False),
        ({"config/lamp.yaml": "- 3\n"}, False),
        ({}, False),
    ],
)  # fmt: skip
def test_a_program_that_no_launch_file_starts_has_the_parameter_file_that_names_its_node(
    tmp_path: Path, files: dict[str, str], is_given: bool
) -> None:
    """Where there is one; which of several is meant is not known."""
    workspace = right_workspace()
    for name, text in files.items():
        workspace.put(name, text)
    (package,) = Look(workspace.write(tmp_path)).packages
    words = own_file(package, "status_publisher")
    assert words[1:] == (["--params-file", str(package.folder / "config/lamp.yaml")] if is_given else [])


@pytest.mark.parametrize(
    ("clock", "times", "said"),
    [
        ("stepped", [0.3, 0.5, 0.8, 1.0], ", about one every 0.23 s"),  # of a timer with 0.25 s
        ("stepped", [0.2, 0.3, 0.5, 0.6, 0.8, 0.9], ", about one every 0.14 s"),
        ("stepped", [0.4, 0.7, 1.1, 1.4], ", about one every 0.33 s"),
        ("stepped", [0.1, 0.2, 0.3], ", about 0.1 s apart"),
        ("stepped", [0.1, 0.2, 0.3, 0.4], ", one every 0.1 s or more often"),
        ("stepped", [2.0, 4.0], ""),  # chance
        ("stepped", [2.0], ""),
        ("real", [0.25, 0.5, 0.76, 1.0], ", about one every 0.25 s"),
        ("real", [0.2, 0.21, 1.5, 1.6], ""),  # in bursts,
    ],
)
def test_a_rhythm_is_told_as_exactly_as_it_was_measured(
    tmp_path: Path, clock: Clock, times: list[float], said: str
) -> None:
    heard = Heard(STRING, "/status_publisher", times, [{"data": "a"}] * len(times), len(times))
    run = replace(run_of("status_publisher", "/news", STRING, heard), clock=clock)
    look = Look(right_workspace().write(tmp_path))
    story = told_of(Seen(look, assignments.load(), [run], []), run, frozenset())
    assert f"published {len(times)} message{'s' * (len(times) > 1)} on /news{said}, " in story


@pytest.mark.parametrize(
    ("line", "log", "said"),
    [
        ("self.create_client(Trigger, '/bake')", [], "status_publisher calls /bake, which no program here offers."),
        ("self.create_service(Trigger, 'bake', print)", [], "status_publisher offers /bake."),
        ("self.create_service(Trigger, 'bake', print)\n        self.create_client(Trigger, 'bake')", [], "status_publisher offers /bake; calls /bake."),
        ("pass", [["INFO", "ready"]], "status_publisher printed 'ready'."),
        ("pass", [], "status_publisher neither published nor subscribed to anything."),
    ],
)  # fmt: skip
def test_what_a_program_did_without_a_topic(
    tmp_path: Path, line: str, log: list[list[str]], said: str
) -> None:
    files = right_workspace()
    files.texts[files.path("node")] = (
        "from rclpy.node import Node\nfrom std_srvs.srv import Trigger\n\n\n"
        f"class Cook(Node):\n    def __init__(self):\n        super().__init__('cook')\n        {line}\n\n\ndef main():\n    Cook()\n"
    )
    run = replace(run_of("status_publisher", "/news", STRING, None), publishes={}, log=log)
    seen = Seen(Look(files.write(tmp_path)), assignments.load(), [run], [])
    assert told_of(seen, run, frozenset()).startswith(said)
