"""The exercise of `08_drive_the_robot`."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

from geometry_msgs.msg import Twist

from ros2lab.checks import CheckError, Prediction, Question, answer_of, exercise, predict_of, quiz_of

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

QUIZ = (
    Question(
        "The panel is grey and says that nobody listens. What is missing?",
        (
            "A node that publishes on `/robot/status`.",
            "The plot.",
            "A node that subscribes to `/robot/command`.",
        ),
        "c",
        "The panel publishes on /robot/command, and it is grey as long as nobody subscribes to it.",
        {"a": "on which topic does the panel publish?", "b": "the panel does not need the plot."},
    ),
    Question(
        "Why must a callback never sleep?",
        (
            "While one sleeps, the executor calls no other function of any of its nodes.",
            "Sleeping is forbidden in Python classes.",
            "The node would lose its name.",
        ),
        "a",
        "One executor calls one function after the other, for all of its nodes.",
        {
            "c": "a node keeps its name for as long as it lives.",
            "b": "it is allowed; but what has to wait meanwhile?",
        },
    ),
    Question(
        "The velocity publisher is stopped while the robot drives. What should its last message be?",
        ("The velocity as it was.", "A zero `Twist`.", "None at all."),
        "b",
        "Otherwise the wheels go on with the last velocity that they received.",
        {"a": "what would the wheels do next?", "c": "what would the wheels go on doing?"},
    ),
)

PREDICTIONS = {
    "folders_of_build": Prediction(
        "Which folders will lie beside `src/` afterwards?",
        ("only `install/`", "`build/` and `install/`", "`build/`, `install/` and `log/`"),
        "c",
        (
            "`build/` holds what the build needed on its way, `install/` what can be run, and `log/` "
            "what colcon said."
        ),
    ),
    "connecting_topic": Prediction(
        "Which topic connects `command_subscriber` with the other two?",
        ("`/robot/command`", "`/robot/state`", "`/cmd_vel`"),
        "b",
        "`/robot/state` does: on it the commander tells the other two what to do.",
    ),
    "session_node": Prediction(
        "Will `ros2 node list` name the notebook's own node, too?",
        ("yes", "no: a notebook is no node"),
        "a",
        "It does: the session has a node of its own, `/ros2lab`, for its logs and publishers.",
    ),
    "click_to_line": Prediction(
        "How much later than your click does the line move?",
        ("no delay is to be seen", "about half a second", "more than a second"),
        "a",
        (
            "You see no delay: a click arrives within hundredths of a second, and the next velocity is "
            "at most 0.1 s away."
        ),
    ),
    "largest_gap": Prediction(
        "How large is the largest gap?",
        ("exactly 0.1 s", "a little more than 0.1 s", "about a second"),
        "b",
        (
            "The mean is close to 0.1 s, and the largest gap is a little larger: your computer has "
            "other things to do, and Linux makes no promise."
        ),
    ),
    "faster_plot": Prediction(
        "What will the plot show?",
        (
            "the line climbs to 1 m/s in one step",
            "the line climbs slowly to 1 m/s",
            "no change until the node starts again",
        ),
        "a",
        "The line climbs to 1 m/s in one step, and stays there.",
    ),
    "other_sender": Prediction(
        "Does the robot mind who sends it?",
        ("no: it stops", "yes: it listens only to the panel", "yes: it asks the notebook first"),
        "a",
        "The robot stops: it does not matter who publishes, only what arrives on which topic.",
    ),
    "fly": Prediction(
        "What happens at `fly`?",
        ("the node ends with an error", "the state becomes `fly`", "nothing changes but a line in the log"),
        "c",
        "`fly` changes nothing but leaves a line in the log above; blanks and capitals do no harm.",
    ),
}


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
