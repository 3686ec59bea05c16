"""The exercise of `08_drive_the_robot`."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

from geometry_msgs.msg import Twist

from ros2lab.checks import CheckError, answer_of, exercise, predict_of, questions_of, quiz_of

# Speed in m/s, turning in rad/s, radius in m.
CIRCLES = (
    (0.5, 0.2, 2.5),
    (1.0, 0.25, 4.0),
    (0.5, -0.2, 2.5),
    (-0.3, 0.1, 3.0),
    (1.0, 0.3, 1.0 / 0.3),
    (0.0, 1.0, 0.0),
    (0.5, 0.0, math.inf),
)

STRAIGHT_ON = "a robot that does not turn drives straight on, on a circle without end: math.inf."


@exercise
def turn_radius(function: Any) -> str:
    """Check that `function` returns the radius in m of the circle on which a Twist drives the robot.

    Args:
        function: takes a `geometry_msgs/Twist`, returns a number.

    Raises:
        CheckError: if it returns another radius, or none.
    """
    for linear, angular, radius in CIRCLES:
        twist = Twist()
        twist.linear.x, twist.angular.z = linear, angular
        call = f"turn_radius() of {linear} m/s and {angular} rad/s"
        found = _answer(function, twist, call)
        if not _is_number(found) or not math.isclose(float(found), radius, rel_tol=1e-6, abs_tol=1e-9):
            raise CheckError(f"{call} is {radius} m", f"{found!r}", _hint(found, angular, radius))
    return "Right: your robot knows its circle."


QUIZ, PREDICTIONS = questions_of(__name__)
quiz = quiz_of(__name__, QUIZ)
predict = predict_of(__name__, PREDICTIONS)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _answer(function: Any, twist: Twist, call: str) -> Any:
    try:
        return answer_of(function, twist, call=call)
    except CheckError as error:
        if isinstance(error.__cause__, ZeroDivisionError) and twist.angular.z == 0.0:
            raise CheckError(error.expected, error.found, STRAIGHT_ON) from error.__cause__
        raise


def _hint(found: Any, angular: float, radius: float) -> str:
    if found is None:
        return "the function needs a return."
    if not _is_number(found):
        return "return a number, the radius in m, and no text."
    if angular == 0.0:
        return STRAIGHT_ON
    if math.isclose(-float(found), radius):
        return "a radius is never negative: abs() helps."
    if any(math.isclose(float(found), round(radius, digits)) for digits in range(4)):
        return "do not round: return what the division gives."
    return "radius = speed / turning: which two fields of the Twist hold them?"
