"""The line on `robot/status`."""

import pytest

from robot_controller.robot_state import State
from robot_controller.status_line import Status, format_status, parse_status


def test_line_is_key_value_pairs() -> None:
    """The line has one decimal for the time, and spaces between the pairs."""
    assert format_status(Status(State.RUNNING, 12.04, 6)) == "state=running uptime_s=12.0 count=6"
    assert format_status(Status(None, 0.0, 1)) == "state=unknown uptime_s=0.0 count=1"


@pytest.mark.parametrize("state", [None, *State])
@pytest.mark.parametrize("uptime", [0.0, 0.1, 12.0, 123456.7])
def test_line_is_read_back(state: State | None, uptime: float) -> None:
    """Reading undoes writing."""
    status = Status(state, uptime, 7)
    assert parse_status(format_status(status)) == status


def test_order_and_further_keys_do_not_matter() -> None:
    """A later version may say more."""
    line = "count=3  battery=80% note=a=b state=idle uptime_s=6"
    assert parse_status(line) == Status(State.IDLE, 6.0, 3)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("", "lacks the key 'state'"),
        ("state=idle count=3", "lacks the key 'uptime_s'"),
        ("state=idle uptime_s=6.0", "lacks the key 'count'"),
        ("state=flying uptime_s=6.0 count=3", "'flying' is not known"),
        ("state=idle uptime_s=long count=3", "cannot be read"),
        ("state=idle uptime_s=6.0 count=3.5", "cannot be read"),
        ("hello world", "cannot be read"),
    ],
)
def test_other_lines_are_refused(line: str, complaint: str) -> None:
    """A refusal quotes the line and says what is wrong with it."""
    with pytest.raises(ValueError, match=complaint):
        parse_status(line)
