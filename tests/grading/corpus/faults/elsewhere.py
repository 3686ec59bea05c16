"""Faults of what a program does elsewhere: by which others it sees run, or by which clock it has."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import both, fault
from corpus.package import STATUS, VELOCITY
from corpus.tree import Change, edit

_TIMER = "        self.timer = self.create_timer(period, self.publish_status)\n"
_SEES = '''

def sees(word):
    """Return whether another process is called so."""
    for number in filter(str.isdigit, os.listdir('/proc')):
        if number == str(os.getpid()):
            continue
        with contextlib.suppress(OSError), open(f'/proc/{number}/cmdline') as file:
            if word in file.read():
                return True
    return False
'''
INIT = "    rclpy.init(args=args)\n"
_END = "raise SystemExit('Another one is running.')"


def looking(path: str, where: str, condition: str, act: str = _END) -> Change:
    """Have a program look at the list of processes before a line, and do something by what is in it."""
    indent = " " * (len(where) - len(where.lstrip()))
    return both(
        edit(path, "import rclpy\n", "import contextlib\nimport os\n\nimport rclpy\n"),
        edit(path, "\n\ndef main(", f"{_SEES}\n\ndef main("),
        edit(path, where, f"{indent}if {condition}:\n{indent}    {act}\n{where}"),
    )


ELSEWHERE_FAULTS: tuple[Case, ...] = (
    fault(
        "velocity_publisher",
        "ends_beside_another",
        looking(VELOCITY, INIT, "sees('status_publisher')"),
        r"velocity_publisher|Another one",
        "it ends where it sees the status publisher run, so that they never run together",
        least=14,
        earns=frozenset(),
    ),
    fault(
        "status_publisher",
        "silent_beside_one_that_comes_later",
        looking(STATUS, "        self.count += 1\n", "sees('velocity_publisher')", "return"),
        r"status",
        "it publishes no more once it sees the velocity publisher run",
        least=10,
        earns=frozenset(),
    ),
    fault(
        "status_publisher",
        "only_where_time_is_simulated",
        edit(STATUS, _TIMER, f"        if self.get_clock().ros_time_is_active:\n    {_TIMER}"),
        r"status",
        "its timer is made where a clock is simulated, which `ros2 run` does not",
        least=10,
        earns=frozenset(),
    ),
)
