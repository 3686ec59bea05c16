"""Faults of the node that drives. A robot that drives for ever has none: the assignment asks for Twists only."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import RUNS, both, fault
from corpus.package import COMMAND, LAUNCH, STATUS, VELOCITY
from corpus.tree import Change, edit

_TOPIC = "'/cmd_vel', 10)"
_PUBLISHER = f"        self.publisher_ = self.create_publisher(Twist, {_TOPIC}\n"
_TIMER = """\
        self.timer = self.create_timer(
            self.get_parameter('timer_period').value, self.publish_velocity)
"""
_SEND = "        self.publisher_.publish(msg)\n"
_VALUES = "        msg.linear.x = forward\n        msg.angular.z = turn\n"


def _wrongly(
    name: str, change: Change, cause: str, about: str, *, least: float = 1, most: float = 18
) -> Case:
    """It runs, and does something else."""
    return fault("velocity_publisher", name, change, cause, about, least=least, most=most, earns=RUNS)


def _wrong(
    name: str, old: str, new: str, cause: str, about: str, *, least: float = 1, most: float = 18
) -> Case:
    return _wrongly(name, edit(VELOCITY, old, new), cause, about, least=least, most=most)


def _dies(
    name: str, old: str, new: str, cause: str, about: str, *, least: float = 1, most: float = 16
) -> Case:
    return fault("velocity_publisher", name, edit(VELOCITY, old, new), cause, about, least=least, most=most)


def _dead(name: str, old: str, new: str, cause: str, about: str) -> Case:
    """It publishes nothing, ever."""
    return fault("velocity_publisher", name, edit(VELOCITY, old, new), cause, about, least=10)


VELOCITY_FAULTS: tuple[Case, ...] = (
    _wrong(
        "topic_without_underscore", _TOPIC, "'/cmdvel', 10)", r"/cmdvel", "the underscore is missing", least=2
    ),
    _wrongly(
        "topic_in_namespace",
        both(
            edit(VELOCITY, "'/cmd_vel'", "'cmd_vel'"),
            edit(STATUS, "'/robot/status'", "'status'"),
            edit(COMMAND, "'/robot/command'", "'command'"),
            edit(LAUNCH, "'),\n", "', namespace='robot'),\n"),
            *(
                edit(LAUNCH, f"'{name}', parameters", f"'{name}', namespace='robot', parameters")
                for name in ("status_publisher", "velocity_publisher")
            ),
        ),
        r"/robot/cmd_vel",
        "the launch file's namespace is right for the two other topics only",
        least=2,
    ),
    _wrong("topic_one_letter_more", _TOPIC, "'/cmd_vell', 10)", r"/cmd_vell", "one letter too many", least=2),
    _wrong(
        "topic_hyphen_as_slash", _TOPIC, "'/cmd/vel', 10)", r"/cmd/vel", "a slash for the underscore", least=2
    ),
    _wrong(
        "topic_of_turtle",
        _TOPIC,
        "'/turtle1/cmd_vel', 10)",
        r"/turtle1/cmd_vel",
        "the topic of turtlesim",
        least=2,
    ),
    _wrong(
        "topic_private",
        _TOPIC,
        "'~/cmd_vel', 10)",
        r"/velocity_publisher/cmd_vel",
        "~ puts it below the node's name",
        least=2,
    ),
    _wrongly(
        "type_stamped",
        both(
            edit(VELOCITY, "import Twist", "import TwistStamped"),
            edit(VELOCITY, "create_publisher(Twist,", "create_publisher(TwistStamped,"),
            edit(VELOCITY, "msg = Twist()", "msg = TwistStamped()"),
            edit(VELOCITY, "msg.linear.x", "msg.twist.linear.x"),
            edit(VELOCITY, "msg.angular.z", "msg.twist.angular.z"),
        ),
        r"TwistStamped",
        "the assignment says Twist",
        least=2,
    ),
    _wrongly(
        "type_vector",
        both(
            edit(VELOCITY, "import Twist", "import Vector3"),
            edit(VELOCITY, "create_publisher(Twist,", "create_publisher(Vector3,"),
            edit(VELOCITY, "msg = Twist()", "msg = Vector3()"),
            edit(VELOCITY, "msg.linear.x", "msg.x"),
            edit(VELOCITY, "msg.angular.z", "msg.z"),
        ),
        r"Vector3",
        "the assignment says Twist",
        least=2,
    ),
    _wrongly(
        "type_string",
        both(
            edit(VELOCITY, "create_publisher(Twist,", "create_publisher(String,"),
            edit(
                VELOCITY,
                "        msg = Twist()\n" + _VALUES,
                "        msg = String(data=f'{forward} {turn}')\n",
            ),
        ),
        r"String",
        "numbers in a text are no Twist",
        least=2,
    ),
    _wrong(
        "not_a_number",
        "    return 0.0, 0.0\n",
        "    return float('nan'), 0.0\n",
        r"nan|finite|number",
        "the robot is sent NaN",
    ),
    _wrong(
        "infinite",
        "    return 0.0, 0.0\n",
        "    return float('inf'), 0.0\n",
        r"inf|finite|number",
        "the robot is sent infinity",
    ),
    _wrong(
        "publishes_once",
        _TIMER,
        "        self.publish_velocity()\n",
        r"once|one|repeat|again|from a timer",  # whether anybody hears it is chance
        "one Twist at the start, and no other",
        most=16,
    ),
    _wrongly(
        "stops_after_five",
        both(
            edit(VELOCITY, _TIMER, _TIMER + "        self.left = 5\n"),
            edit(
                VELOCITY,
                _SEND,
                _SEND
                + "        self.left -= 1\n        if self.left == 0:\n            self.timer.cancel()\n",
            ),
        ),
        r"stop|repeat|keep|only|end|again|few",
        "after five Twists there are no more",
        most=16,
    ),
    # It dies.
    _dies(
        "dies_after_ten",
        _SEND,
        _SEND + "        self.history = getattr(self, 'history', []) + [forward]\n"
        "        if len(self.history) > 10:\n            raise RuntimeError('history is full')\n",
        r"RuntimeError|ended|died|history",
        "it dies after a second",
    ),
    _dies(
        "int_in_linear",
        "    return 0.0, 0.0\n",
        "    return 0, 0.0\n",
        r"int-in-float|float|int\b|0\.0",
        "a Twist takes floats only",
        least=3,
        most=3,
    ),
    _dies(
        "int_in_angular",
        "    return 0.0, 0.0\n",
        "    return 0.0, 0\n",
        r"int-in-float|float|int\b|0\.0",
        "a Twist takes floats only",
        least=3,
        most=3,
    ),
    _wrongly(
        "int_that_is_caught",
        both(
            edit(VELOCITY, "    return 0.0, 0.0\n", "    return 0, 0\n"),
            edit(
                VELOCITY,
                _VALUES + _SEND,
                "        try:\n            msg.linear.x = forward\n            msg.angular.z = turn\n"
                "            self.publisher_.publish(msg)\n        except Exception:\n            pass\n",
            ),
        ),
        r"int-in-float|float|int\b|0\.0",
        "the lab's check of fields is caught, and nothing comes",
        least=3,
        most=3,
    ),
    _dies(
        "int_when_it_is_made",
        _PUBLISHER,
        _PUBLISHER + "        self.fastest = Twist()\n        self.fastest.linear.x = 1\n",
        r"int-in-float|float|int\b|1\.0",
        "the int is assigned before the node is there",
        least=3,
        most=3,
    ),
    _dies(
        "velocity_is_text",
        "msg.linear.x = forward",
        "msg.linear.x = str(forward)",
        r"field-type|float|text|type",
        "a Twist takes floats only",
        least=3,
        most=3,
    ),
    # It publishes nothing.
    _dead("timer_never_made", _TIMER, "", r"publish", "nothing ever calls publish_velocity"),
    _dead(
        "message_not_sent", _SEND, "        self.last = msg\n", r"publish", "the message is made and not sent"
    ),
    _dead(
        "publisher_never_made",
        _PUBLISHER,
        "        self.publisher_ = None\n",
        r"publish|NoneType",
        "there is no publisher",
    ),
    _dead(
        "subscribes_instead",
        "create_publisher(Twist, '/cmd_vel', 10)",
        "create_subscription(Twist, '/cmd_vel', print, 10)",
        r"publish",
        "it listens to /cmd_vel in place of publishing there",
    ),
    _dead("never_spins", "        rclpy.spin(node)\n", "        pass\n", r"spin", "it ends at once"),
    _dead(
        "linear_is_number",
        _VALUES,
        "        msg.linear = forward\n        msg.angular.z = turn\n",
        r"linear|field-type|Vector3|\.x",
        "linear has three parts",
    ),
    _dead(
        "field_unknown",
        "msg.linear.x = forward",
        "msg.x = forward",
        r"\bx\b|message-field|attribute",
        "Twist has no field x",
    ),
    _dead(
        "import_from_std_msgs",
        "from geometry_msgs.msg import Twist",
        "from std_msgs.msg import Twist",
        r"import|geometry_msgs",
        "Twist is in geometry_msgs",
    ),
    _dead(
        "import_without_msg",
        "from geometry_msgs.msg import",
        "from geometry_msgs import",
        r"import|geometry_msgs\.msg",
        "messages are in .msg",
    ),
    _dead("not_imported", "from geometry_msgs.msg import Twist\n", "", r"Twist", "NameError"),
    _dead(
        "publishes_class",
        "        msg = Twist()\n",
        "        msg = Twist\n",
        r"Twist|attribute|\(\)",
        "the class is filled in place of a message",
    ),
    _dead(
        "name_misspelt",
        _VALUES,
        "        msg.linear.x = forwrad\n        msg.angular.z = turn\n",
        r"forwrad|name-undefined",
        "NameError",
    ),
    _dead(
        "state_callback_without_message",
        "def on_state(self, msg):",
        "def on_state(self):",
        r"callback|argument",
        "a subscription gives a message",
    ),
    _dead(
        "callback_without_self",
        "def publish_velocity(self):",
        "def publish_velocity():",
        r"callback|argument|self",
        "the method takes no self",
    ),
    _dead("qos_missing", _TOPIC, "'/cmd_vel')", r"qos", "the depth is missing"),
    _dead(
        "endless_loop",
        _TIMER,
        "        while True:\n            self.state = 'idle'\n",
        r"endless-loop|loop|while",
        "the constructor never ends",
    ),
    _dead(
        "rate_without_thread",
        "        rclpy.spin(node)\n",
        "        rate = node.create_rate(10)\n        node.timer.cancel()\n        while rclpy.ok():\n"
        "            rate.sleep()\n            node.publish_velocity()\n",
        r"rate|thread|spin|publish",
        "nothing spins, so the rate never wakes",
    ),
    fault(
        "velocity_publisher",
        "syntax",
        edit(VELOCITY, "    if state == 'running':", "    if state = 'running':"),
        r"velocity_publisher\.py",
        "an assignment in place of a comparison",
        least=14,
        unreadable=("/velocity_publisher.py",),
    ),
)
