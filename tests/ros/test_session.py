"""A session runs students' nodes, survives their mistakes, and gives everything back."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import psutil
import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.waitable import NumberOfEntities, Waitable
from std_msgs.msg import String

from deadlines import DEADLINE
from ros2lab.session import LabSession
from ros2lab.session_resources import THREAD_NAME


class Counter(Node):
    """A node as a student writes it: no argument, no context."""

    def __init__(self) -> None:
        super().__init__("counter")
        self.declare_parameter("period", 0.02)
        self.declare_parameter("word", "tick")
        self.n = 0
        self.publisher_ = self.create_publisher(String, "count", 10)
        self.create_timer(self.get_parameter("period").value, self.tick)

    def tick(self) -> None:
        self.n += 1
        word = self.get_parameter("word").value
        self.publisher_.publish(String(data=f"{word} {self.n}"))


class Forwarding(Node):
    """A node that passes options on, as the reference nodes do."""

    def __init__(self, **options: object) -> None:
        super().__init__("forwarding", **options)
        self.declare_parameter("speed", 0.1)


class Echo(Node):
    """A node without a class of its own timer: it answers."""

    def __init__(self) -> None:
        super().__init__("echo")
        self.publisher_ = self.create_publisher(String, "answer", 10)
        self.create_subscription(String, "question", self.answer, 10)

    def answer(self, message: String) -> None:
        self.publisher_.publish(String(data=message.data.upper()))


class Faulty(Node):
    """A node whose callback raises at every tick."""

    def __init__(self) -> None:
        super().__init__("faulty")
        self.create_timer(0.01, self.tick)

    def tick(self) -> None:
        raise ZeroDivisionError("a robot cannot be divided")


class Leaving(Node):
    """A node that ends itself."""

    def __init__(self) -> None:
        super().__init__("leaving")
        self.create_timer(0.01, self.tick)

    def tick(self) -> None:
        raise SystemExit


def executor_threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == THREAD_NAME]


def test_a_node_without_arguments_runs_in_the_private_context(session: LabSession) -> None:
    """A student's node needs no context, and the default one stays untouched."""
    node = session.run(Counter)
    log = session.log("/count", String)
    log.wait_for(3)
    assert type(node).__name__ == "Counter"
    assert isinstance(node, Counter)
    assert not rclpy.ok()


def test_parameters_are_given_at_the_start(session: LabSession) -> None:
    """Keyword arguments become the node's parameters."""
    session.run(Counter, word="tock", period=0.01)
    session.log("/count", String).wait_until(lambda message: message.data.startswith("tock"))
    assert session.run(Forwarding, speed=0.7).get_parameter("speed").value == 0.7


def test_an_unknown_parameter_is_refused(session: LabSession) -> None:
    """A misspelt parameter is an error, not silently the default."""
    with pytest.raises(ValueError, match="Counter declares no parameter named peroid"):
        session.run(Counter, peroid=0.1)
    assert "counter" not in session.node.get_node_names()


@pytest.mark.parametrize("wrong", [Counter.tick, "Counter", int, None])
def test_only_a_node_class_is_run(session: LabSession, wrong: object) -> None:
    """Anything else is refused in one sentence."""
    with pytest.raises(TypeError, match=r"run\(\) takes a class derived from rclpy.node.Node"):
        session.run(wrong)  # type: ignore[arg-type]


def test_running_again_replaces(session: LabSession) -> None:
    """Running a cell again does not double the node."""
    first = session.run(Counter)
    log = session.log("/count", String)
    log.wait_for(2)
    second = session.run(Counter)
    log.wait_until(lambda message: message.data == "tick 1")
    assert first is not second
    assert session.node.get_node_names().count("counter") == 1
    assert session.node.count_publishers("/count") == 1


def test_a_stopped_node_says_nothing_more(session: LabSession) -> None:
    """`stop` takes the node or its name; stopping twice does no harm, a wrong name does."""
    node = session.run(Counter)
    log = session.log("/count", String)
    log.wait_for(1)
    session.stop("counter")
    session.stop(node)
    heard = log.count
    with pytest.raises(TimeoutError, match="No node publishes on /count"):
        log.wait_for(heard + 2, timeout=0.3)
    with pytest.raises(ValueError, match="runs no node named 'kounter'; it runs: none"):
        session.stop("kounter")


def test_a_raising_callback_is_reported_and_the_others_go_on(session: LabSession) -> None:
    """The error carries the node and the student's own line; a second node keeps publishing."""
    session.run(Faulty)
    session.run(Counter)
    log = session.log("/count", String)
    log.wait_for(20)
    error = session.errors[0]
    assert error.node_name == "faulty"
    assert isinstance(error.exception, ZeroDivisionError)
    assert 'raise ZeroDivisionError("a robot cannot be divided")' in error.traceback
    assert "rclpy" not in error.traceback
    assert len(session.errors) > 1, "the faulty node itself goes on too"


class Vanishing(Waitable):  # type: ignore[misc]
    """Is destroyed in another thread just before the executor waits for it, as a log is that is closed."""

    is_met = False

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities()

    def is_ready(self, _wait_set: object) -> bool:
        return False

    def add_to_wait_set(self, _wait_set: object) -> None:
        if not self.is_met:
            self.is_met = True
            raise InvalidHandle("destruction was requested")


def test_what_is_destroyed_meanwhile_does_not_end_the_others(session: LabSession) -> None:
    node = session.run(Counter)
    vanishing = Vanishing(node.default_callback_group)
    node.add_waitable(vanishing)
    log = session.log("/count", String)
    log.wait_for(20)
    assert vanishing.is_met
    assert executor_threads()


def test_a_node_that_raises_system_exit_is_stopped(session: LabSession) -> None:
    """SystemExit ends that node only."""
    session.run(Leaving)
    session.run(Counter)
    log = session.log("/count", String)
    log.wait_for(10)
    assert "leaving" not in session.node.get_node_names()
    assert len(session.errors) == 1


def test_a_failed_wait_names_the_error_that_caused_it(session: LabSession) -> None:
    """Waiting for what a failing callback would have said tells of the failure."""
    session.run(Faulty)
    log = session.log("/nothing", String)
    with pytest.raises(TimeoutError, match="faulty raised ZeroDivisionError"):
        log.wait_for(1, timeout=0.3)


def test_a_first_message_is_not_lost(session: LabSession) -> None:
    """What is published right after a node was started reaches it."""
    session.run(Echo)
    log = session.log("/answer", String)
    session.publish("/question", "hello")
    assert log.wait_for(1)[0].message.data == "HELLO"
    session.publish("question", String(data="again"))
    assert log.wait_for(2)[1].message.data == "AGAIN"


@pytest.mark.parametrize("wrong", [None, 3, Twist, ["start"]])
def test_only_messages_and_texts_are_published(session: LabSession, wrong: object) -> None:
    """Anything else is refused in one sentence."""
    with pytest.raises(TypeError, match=r"publish\(\) takes a message or a text"):
        session.publish("/question", wrong)


def test_subscribers_leave_out_the_sessions_own_logs(session: LabSession) -> None:
    """A log is no listener."""
    session.log("/question", String)
    assert session.subscribers("/question") == 0
    session.run(Echo)
    session.wait_for_subscribers("/question")
    assert session.subscribers("/question") == 1
    with pytest.raises(TimeoutError, match="1 of 2 expected nodes listen on /question"):
        session.wait_for_subscribers("/question", 2, timeout=0.1)


def test_the_type_of_a_log_is_found(session: LabSession) -> None:
    """A log needs no type where one is published; a silent topic says what is published instead."""
    session.run(Counter)
    assert session.log("/count").type_name == "std_msgs/msg/String"
    assert session.log("/count", "std_msgs/msg/String").wait_for(1)
    with pytest.raises(ValueError, match=r"No node publishes on /cout.*Did you mean /count\?"):
        session.log("/cout")


def test_a_second_session_replaces_the_first(domain_id: int) -> None:
    """Running the session's cell again leaves one thread."""
    first = LabSession(domain_id=domain_id)
    first.run(Counter)
    with LabSession(domain_id=domain_id) as second:
        assert first.is_closed
        assert len(executor_threads()) == 1
        assert "counter" not in second.node.get_node_names()
    assert not executor_threads()


def test_a_closed_session_says_so(session: LabSession) -> None:
    """Closing twice does no harm; using it or a log of it afterwards is one sentence."""
    log = session.log("/hello", String)
    session.close()
    session.close()
    assert repr(session) == "LabSession(closed)"
    with pytest.raises(RuntimeError, match="This session is closed; make a new one"):
        session.run(Counter)
    with pytest.raises(TimeoutError, match="this log is closed; make a new one"):
        log.wait_for(1)


def test_an_exception_in_the_block_closes(domain_id: int) -> None:
    """A `with` block that fails gives everything back."""

    def fail() -> None:
        with LabSession(domain_id=domain_id) as session:
            session.run(Counter)
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert not executor_threads()


def test_a_forgotten_session_is_collected(domain_id: int) -> None:
    """Garbage collection ends the thread."""
    session = LabSession(domain_id=domain_id)
    session.run(Counter)
    session.log("/count", String).wait_for(1)
    del session
    gc.collect()
    assert not executor_threads()


def test_callbacks_of_close_run_newest_first_and_all(
    domain_id: int, capsys: pytest.CaptureFixture[str]
) -> None:
    """A widget that cannot close does not keep the others from closing."""
    called = []
    session = LabSession(domain_id=domain_id)
    session.on_close(lambda: called.append("first"))
    session.on_close(lambda: 1 / 0)  # type: ignore[arg-type, return-value]
    session.on_close(lambda: called.append("last"))
    session.close()
    assert called == ["last", "first"]
    assert "ZeroDivisionError" in capsys.readouterr().err


@pytest.mark.parametrize("wrong", [-1, 233, 1.5, "seven", True])
def test_a_wrong_domain_is_refused(wrong: object) -> None:
    """The sentence names the value and what is allowed."""
    with pytest.raises(ValueError, match="whole number from 0 to 232"):
        LabSession(domain_id=wrong)  # type: ignore[arg-type]


def test_an_int_in_a_twist_is_an_error(session: LabSession) -> None:
    """The lab has ROS check the fields of messages, which the wheels do not by themselves."""
    assert session.is_closed is False
    with pytest.raises(AssertionError, match="'x' field must be of type 'float'"):
        Twist().linear.x = 1


SCRIPT = """
    import os, signal, sys
    import psutil
    from rclpy.node import Node
    from std_msgs.msg import String
    from ros2lab.session import LabSession

    class Talker(Node):
        def __init__(self):
            super().__init__("talker")
            self.pub = self.create_publisher(String, "/talk", 10)
            self.create_timer(0.05, lambda: self.pub.publish(String(data="x")))

    session = LabSession()
    session.run(Talker)
    session.log("/talk", String).wait_for(2)
    # The owner of a file keeps its lock open; what others own and this process reads is theirs to remove.
    opened = [file.path for file in psutil.Process().open_files()]
    mine = {{path.split("/")[-1][:-3] for path in opened if "/dev/shm/fastrtps_" in path and path.endswith("_el")}}
    print(*(name for name in mine if "port" not in name), flush=True)
    {ending}
"""


def run_script(ending: str) -> subprocess.CompletedProcess[str]:
    script = textwrap.dedent(SCRIPT).format(ending=ending)
    return subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=DEADLINE, check=False
    )


def shared_memory(finished: subprocess.CompletedProcess[str]) -> list[Path]:
    """Return the shared-memory files that the script had and that are still there."""
    names = finished.stdout.splitlines()[0].split()
    assert names, "Fast DDS uses shared memory"
    return [path for name in names for path in Path("/dev/shm").glob(f"{name}*")]


@pytest.mark.parametrize(
    "ending",
    [
        "pass",
        "raise KeyError('on purpose')",
        "session.close()",
        *(pytest.param(ending, marks=pytest.mark.thorough) for ending in ("sys.exit(3)", "del session")),
    ],
)
def test_however_a_program_ends_nothing_is_left(ending: str) -> None:
    """The process ends by itself, prints no complaint of ROS, and leaves no shared memory."""
    finished = run_script(ending)
    assert finished.returncode == {"sys.exit(3)": 3, "raise KeyError('on purpose')": 1}.get(ending, 0)
    assert "KeyError" in finished.stderr if "KeyError" in ending else finished.stderr == ""
    assert not shared_memory(finished)


def test_the_next_session_cleans_up_after_a_killed_one() -> None:
    """A killed kernel cannot tidy up; the next session does."""
    finished = run_script("os.kill(os.getpid(), signal.SIGKILL)")
    assert finished.returncode == -signal.SIGKILL
    assert shared_memory(finished), "a killed process leaves its files"
    for path in shared_memory(finished):
        os.utime(path, (time.time() - 10, time.time() - 10))
    with LabSession() as session:
        session.run(Counter)
        session.log("/count", String).wait_for(2)
        assert not shared_memory(finished)


def test_a_killed_kernel_takes_its_node_processes_along() -> None:
    """The processes that a session started end with it, even on SIGKILL."""
    # Linux is asked to end the process between its making and its first own instruction.
    ending = (
        "from ros2lab.node_process import NodeProcess; "
        "p = NodeProcess('p', 'sleep', ['sh', '-c', 'echo ready; exec sleep 300'], os.environ)\n"
        "while 'ready' not in p.output: pass\n"
        "print(p.pid, flush=True); os.kill(os.getpid(), signal.SIGKILL)"
    )
    pid = int(run_script(ending).stdout.split()[-1])
    gone, alive = psutil.wait_procs([psutil.Process(pid)] if psutil.pid_exists(pid) else [], timeout=DEADLINE)
    assert not alive, gone
