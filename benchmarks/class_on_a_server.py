"""A class on one server: what a student takes at rest and driving, and how long a click takes when many drive."""

from __future__ import annotations

import random
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from row import Quantity, Row

sys.path.append(str(Path(__file__).parent.parent / "tests"))
sys.path.append(str(Path(__file__).parent.parent / "tests" / "hub"))
from class_server import ClassServer, class_server
from hub_user import HubUser
from test_class import NAMES, at_once, printed, set_up

from bare_student import Kernel, Student

COUNTS = (1, 5, 10, 20)
CLICKS = 20  # of each student
PAUSES = (0.5, 1.5)  # s, between a student's clicks
OBSERVED = 10.0  # s
SOON = 100.0  # ms
# What lesson 8 has on its page while the robot drives.
DRIVE = """
from ros2lab import CommandPanel, LabSession, NodeLog, RobotView, TwistPlot, course
session = LabSession()
for node_class in course.reference_nodes():
    session.run(node_class)
panel = CommandPanel(session)
for view in (panel, RobotView(session), TwistPlot(session), NodeLog(session)):
    display(view)
buttons = {button.description: button.model_id for button in panel.children[1].children}
print(buttons["start"], buttons["stop"])
"""
# In another process. The clock is the whole machine's.
LISTEN = """
import threading, time
from geometry_msgs.msg import Twist
from ros2lab import LabSession
session = LabSession()
changes, is_driving = [], False
is_met, changed = threading.Event(), threading.Condition()
def hear(twist):
    global is_driving
    is_met.set()
    if (twist.linear.x > 0) != is_driving:
        is_driving = not is_driving
        with changed:
            changes.append(time.monotonic())
            changed.notify()
def heard(turn):
    with changed:
        assert changed.wait_for(lambda: len(changes) > turn, 60), f"Nothing changed after click {turn}."
        return changes[turn]
listening = session.node.create_subscription(Twist, "/cmd_vel", hear, 10)
assert is_met.wait(60)
"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Let students of a real hub drive, one at first and then more."""
    counts = COUNTS[:2] if is_quick else COUNTS
    with (
        tempfile.TemporaryDirectory(prefix="ros2lab-figures-") as name,
        class_server(Path(name, "debian")) as server,
    ):
        set_up(server)
        advance(0.3)
        users = [HubUser(server.address, name, f"{name}'s, secret") for name in NAMES[: counts[-1]]]
        users[0].start()
        rows = _taken(server, users[0].name, "at rest", time.sleep)
        drivers: list[Driver] = []
        for count in counts:
            begun = at_once(Driver, users[len(drivers) : count])
            if not drivers:
                begun[0].start()
                rows += _taken(server, users[0].name, "who drives", begun[0].watch)
                begun[0].stop()
            at_once(Driver.listen, begun)
            drivers += begun
            times = [time for times in at_once(Driver.click, drivers) for time in times]
            rows.append(
                Row(
                    f"click → changed Twist at another process, {count} of a class at once",
                    Quantity.of_samples(times, "ms"),
                    limits={"value": SOON, "p99": SOON},
                    note=f"on the same cores a second kernel of each, which listens, and the {count} pages",
                )
            )
            advance(0.3 + 0.7 * count / counts[-1])
    return rows


class Driver:
    """A student who drives, with everything that lesson 8 has.

    Args:
        user: who has entered the hub.
    """

    def __init__(self, user: HubUser) -> None:
        user.start()
        self._lab = Student(user.address, Path())
        self._page = Kernel(self._lab, "notebooks/08_drive_the_robot.ipynb")
        self._buttons = printed(self._page.run(DRIVE)).split()[-2:]

    def start(self) -> None:
        """Let the robot drive."""
        self._click(0)

    def stop(self) -> None:
        """Let the robot stand."""
        self._click(1)

    def listen(self) -> None:
        """Let another process note when the robot starts and stops."""
        self._listener = Kernel(self._lab, "notebooks/00_welcome.ipynb")
        printed(self._listener.run(LISTEN))

    def click(self, count: int = CLICKS) -> list[float]:
        """Click start and stop by turns; return how long each took until the other process heard it, in ms.

        The next click follows the change, for one that nobody waits for may be overtaken. Others may have kept everybody
        waiting since the last time.
        """
        self._page.connect_again()
        self._listener.connect_again()
        self._listener.run("changes.clear()")
        times = []
        for turn in range(count):
            clicked = time.monotonic()
            self._click(turn)
            self.watch(random.uniform(*PAUSES))
            heard = printed(self._listener.run(f"print(heard({turn}))"))
            times.append(1000 * (float(heard) - clicked))
        return times

    def _click(self, turn: int) -> None:
        self._page.send_to_widget(self._buttons[turn % 2], {"event": "click"})

    def watch(self, seconds: float) -> None:
        """Take in what the kernel sends to the page."""
        self._page.follow(seconds)


def _taken(server: ClassServer, name: str, state: str, watch: Callable[[float], None]) -> list[Row]:
    """Return the memory and processor time of a student's server and all that it has started."""
    before = _processor_time(server, name)
    watch(OBSERVED)
    used = 100 * (_processor_time(server, name) - before) / OBSERVED
    memory = sum(process.memory_full_info().pss for process in server.processes(name)) / 1e6
    return [
        Row(
            f"memory of a student of a class, {state}",
            Quantity(memory, "MB"),
            note="shared pages are divided",
        ),
        Row(f"processor of a student of a class, {state}", Quantity(used, "% of a core")),
    ]


def _processor_time(server: ClassServer, name: str) -> float:
    return sum(sum(process.cpu_times()[:2]) for process in server.processes(name))
