"""The text on `robot/status`, `state=running uptime_s=12.0 count=6`; no ROS here."""

from dataclasses import dataclass

from robot_controller.robot_state import State, parse_state, quoted

_UNKNOWN = "unknown"


@dataclass(frozen=True)
class Status:
    """How the robot is.

    Attributes:
        state: its state, or None while nobody has told.
        uptime: how long the status node has been up, in s; the line keeps one decimal.
        count: the number of this line, from 1; a gap tells that lines were lost.
    """

    state: State | None
    uptime: float
    count: int


def format_status(status: Status) -> str:
    """Write a status as one line of `key=value` pairs."""
    state = status.state.value if status.state else _UNKNOWN
    return f"state={state} uptime_s={status.uptime:.1f} count={status.count}"


def parse_status(line: str) -> Status:
    """Read a line of `key=value` pairs, in any order; further keys are passed over.

    Raises:
        ValueError: with one sentence, if a key is missing or a value is not what it should be.
    """
    try:
        values = dict(pair.split("=", 1) for pair in line.split())
        state = None if values["state"] == _UNKNOWN else parse_state(values["state"])
        return Status(state, float(values["uptime_s"]), int(values["count"]))
    except KeyError as missing:
        raise ValueError(f"the status line {quoted(line)} lacks the key {missing}") from None
    except ValueError as error:
        raise ValueError(f"the status line {quoted(line)} cannot be read: {error}") from None
