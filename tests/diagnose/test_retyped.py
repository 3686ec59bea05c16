"""A command that gave a parameter a value of another type, as it is told to be typed again."""

from __future__ import annotations

import pytest

from ros2lab.diagnose import of_text


@pytest.mark.parametrize(
    ("command", "typed", "shown", "kind", "told"),
    [
        ("run", "007", "7", "INTEGER", "type `ros2 run my_bot talker --ros-args -p code:=\"'007'\"`"),
        ("run", "on", "True", "BOOL", "type `ros2 run my_bot talker --ros-args -p code:=\"'on'\"`"),
        (
            "run",
            "12E5",
            "1200000.0",
            "DOUBLE",
            "type `ros2 run my_bot talker --ros-args -p code:=\"'12E5'\"`",
        ),
        ("launch", "1_000", "1000", "INTEGER", "type `ros2 launch my_bot a.launch.py code:=\"'1_000'\"`"),
        ("launch", "12E5", "1200000.0", "DOUBLE", "write ros_arguments=['-p', [\"code:='\","),
    ],
)
def test_a_value_for_a_string_is_told_as_it_was_typed(
    command: str, typed: str, shown: str, kind: str, told: str
) -> None:
    line = "talker --ros-args -p" if command == "run" else "a.launch.py"
    (finding,) = of_text(
        f"$ ros2 {command} my_bot {line} code:={typed}\n"
        f"rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'code' to '{shown}' "
        f"of type '{kind}', expecting type 'STRING': code\n"
    )
    assert finding.code == "parameter-type"
    assert finding.fix.startswith(told)
