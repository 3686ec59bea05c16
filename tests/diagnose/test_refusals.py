"""Sentences with which ros2 ends in vain, and what commands print otherwise."""

from __future__ import annotations

from pathlib import Path

import pytest

from portable_ros2.messages import FieldError, find_message, parse_values
from ros2lab.diagnose import of_text
from ros2lab.diagnose.printed.transcript import is_refusal


@pytest.mark.parametrize("text", ["a: {b: 1}, c: 2", "{a: 1", "{a: b: c}", "3"])
def test_what_is_no_message_is_known_as_such(text: str) -> None:
    with pytest.raises(RuntimeError) as refused:
        parse_values(text)
    assert is_refusal(str(refused.value))


@pytest.mark.parametrize("name", ["String", "std_msgs/msg/Strin", "nowhere/msg/String"])
def test_a_type_that_is_not_there_is_known_as_such(name: str) -> None:
    with pytest.raises(RuntimeError) as refused:
        find_message(name)
    assert is_refusal(str(refused.value))


def test_a_reason_that_is_put_together_is_known() -> None:
    assert is_refusal(str(FieldError("'data' takes a number, not 'three'")))


@pytest.mark.parametrize(
    "line",
    [
        *(
            "",
            "publisher: beginning loop",
            "average rate: 2.000",
            "data: hello",
            "/rosout",
            "Node name: talker",
        ),
        *("[INFO] [1.0] [talker]: the passed value is 3", "publishing #1: std_msgs.msg.String(data='x')"),
    ],
)
def test_an_answer_is_no_refusal(line: str) -> None:
    assert not is_refusal(line)


@pytest.mark.parametrize(
    ("command", "said", "cause", "fix"),
    [
        ("ros2 topic delay /x", "msg does not have header", "Msg does not have header.", "`ros2 topic delay -h`"),
        ("ros2 bag info a", "The folder 'a' is no bag: there is no metadata.yaml and no .mcap file in it.", "The folder 'a' is no bag", ""),
        ("ros2 topic list", "ROS_DOMAIN_ID=800 is not a number from 0 to 232", "ROS_DOMAIN_ID=800 is not", ""),
        ("ros2lab grade --nope", "╭─ Error ────╮\n│ No such option: --nope  │\n╰────────────╯", "No such option: --nope.", "`ros2lab grade -h`"),
        ("ros2lab diagnose --rnu", "Error: No such option: --rnu Did you mean --run?", "No such option", "write --run"),
    ],
)  # fmt: skip
def test_a_refusal_is_never_passed_over(
    tmp_path: Path, command: str, said: str, cause: str, fix: str
) -> None:
    first = of_text(f"$ {command}\n{said}\n", tmp_path)[0]
    assert cause in first.cause
    assert fix in first.fix
