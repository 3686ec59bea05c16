"""A TopicLog in a kernel, at a thousand messages a second from another process."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack

from kernel import Kernel
from load import processor_load
from place import own_place
from program import Program
from row import Quantity, Row

RATE = 1000  # Hz
LISTEN = """
from ros2lab import LabSession
from std_msgs.msg import Int64

def came(count, timeout):
    try:
        log.wait_for(count, timeout)
    except TimeoutError:
        return False
    return True

session = LabSession()
"""


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Count which of the numbered messages are in the log, and in which order."""
    seconds = 5 if is_quick else 60
    count = RATE * seconds
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        kernel = stack.enter_context(Kernel(place.environ, place.folder))
        sender = stack.enter_context(Program("counter.py", "/numbers", str(RATE), environ=place.environ))
        kernel.run(f"{LISTEN}log = session.log('/numbers', Int64, capacity={count})")
        _meet(sender, kernel)
        sender.tell(count)
        busy = processor_load([kernel.pid], seconds, advance)
        sent_in = sender.hear()
        kernel.run("", f"came({count}, 5.0)")  # what is still under way may arrive
        numbers, gap = kernel.run(
            "", "([s.message.data for s in log.samples()], log.statistics().largest_gap)"
        )
    order = "each once and in order" if numbers == sorted(set(numbers)) else "some twice or not in order"
    return [
        Row(
            f"messages that a TopicLog misses at {RATE / 1000:g} kHz in {seconds} s",
            Quantity(count - len(set(numbers)), "messages"),
            "sent by another process",
            Quantity(count, "messages"),
            {"value": 0},
            f"sent at {count / sent_in:.0f} Hz; came {order}; largest gap {1000 * gap:.0f} ms; "
            f"the kernel took {busy:.0f} % of a core",
        )
    ]


def _meet(sender: Program, kernel: Kernel) -> None:
    """Send until it is heard: what is published before the two have found each other is lost."""
    for _ in range(100):
        sender.tell(1)
        sender.hear()
        if kernel.run("", "came(1, 0.2)"):
            kernel.run("log.clear()")
            return
    raise TimeoutError("The sender and the log did not find each other in 20 s.")
