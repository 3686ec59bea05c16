"""Faults of the node that reports on the robot: topic, type, period, and all that keeps it from running."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import RUNS, both, fault
from corpus.package import STATUS
from corpus.tree import Change, edit, put

_TOPIC, _TIMER = "'/robot/status', 10)", "self.create_timer(period, self.publish_status)"
_SUPER = "        super().__init__('status_publisher')\n"
_SPIN = "        rclpy.spin(node)\n"


def _wrong(
    name: str, old: str, new: str, cause: str, about: str, *, least: float = 2, most: float = 16
) -> Case:
    """It runs, and does something else."""
    return _wrongly(name, edit(STATUS, old, new), cause, about, least=least, most=most)


def _wrongly(
    name: str, change: Change, cause: str, about: str, *, least: float = 2, most: float = 16
) -> Case:
    return fault("status_publisher", name, change, cause, about, least=least, most=most, earns=RUNS)


def _dead(name: str, old: str, new: str, cause: str, about: str) -> Case:
    """It publishes nothing, ever."""
    return fault("status_publisher", name, edit(STATUS, old, new), cause, about, least=10.5)


def _unreadable(name: str, old: str, new: str, about: str) -> Case:
    return fault(
        "status_publisher",
        name,
        edit(STATUS, old, new),
        r"status_publisher\.py",
        about,
        least=11,
        unreadable=("/status_publisher.py",),
    )


STATUS_FAULTS: tuple[Case, ...] = (
    # It runs, and does something else.
    _wrong(
        "topic_one_letter_short", _TOPIC, "'/robot/statu', 10)", r"/robot/statu\b", "one letter is missing"
    ),
    _wrong(
        "topic_underscore",
        _TOPIC,
        "'/robot_status', 10)",
        r"/robot_status",
        "an underscore in place of the slash",
    ),
    _wrong(
        "topic_capital",
        _TOPIC,
        "'/robot/Status', 10)",
        r"/robot/Status",
        "names of topics are case-sensitive",
    ),
    _wrong("topic_without_robot", _TOPIC, "'/status', 10)", r"/status", "the topic is not below /robot"),
    _wrong(
        "topic_private",
        _TOPIC,
        "'~/robot/status', 10)",
        r"/status_publisher/robot/status",
        "~ puts it below the node's name",
        most=18,
    ),
    _wrongly(
        "type_int",
        both(
            edit(STATUS, "import String", "import Int32"),
            edit(STATUS, "msg = String()", "msg = Int32()"),
            edit(STATUS, "create_publisher(String", "create_publisher(Int32"),
            edit(STATUS, "status_text(self.count)", "self.count"),
        ),
        r"Int32",
        "the assignment says String",
    ),
    _wrongly(
        "type_header",
        both(
            edit(STATUS, "import String", "import Header"),
            edit(STATUS, "msg = String()", "msg = Header()"),
            edit(STATUS, "create_publisher(String", "create_publisher(Header"),
            edit(STATUS, "msg.data = ", "msg.frame_id = "),
            edit(STATUS, "{msg.data}", "{msg.frame_id}"),
        ),
        r"Header",
        "the assignment says String",
    ),
    _wrongly(
        "period_1_0",
        both(
            edit(STATUS, "'timer_period', 2.0", "'timer_period', 1.0"),
            edit(STATUS, "period = 2.0", "period = 1.0"),
        ),
        r"\b1(\.0)? s",
        "every second in place of every two",
    ),
    _wrong(
        "period_2_5",
        "'timer_period', 2.0",
        "'timer_period', 2.5",
        r"\b2\.5 s",
        "off by a quarter",
        least=1,
        most=8,
    ),
    _wrong(
        "period_3_0", "'timer_period', 2.0", "'timer_period', 3.0", r"\b3(\.0)? s", "off by a half", least=1
    ),
    _wrong("period_5_0", "'timer_period', 2.0", "'timer_period', 5.0", r"\b5(\.0)? s", "far too slow"),
    _wrong("period_0_2", "'timer_period', 2.0", "'timer_period', 0.2", r"\b0\.2 s", "ten times too often"),
    _wrong(
        "frequency_for_period",
        "create_timer(period,",
        "create_timer(1.0 / period,",
        r"\b0\.5 s",
        "a timer takes the period, and not the frequency",
    ),
    _wrong(
        "timer_in_ms",
        "'timer_period', 2.0",
        "'timer_period', 2000.0",
        r"never|once|no message|2000|ever published",
        "2000 was meant as ms",
        least=5,
    ),
    _wrong(
        "timer_in_ns",
        "create_timer(period,",
        "create_timer(period / 1000.0,",
        r"0\.0|often|period|fast",
        "every 2 ms: somebody converted what needs no converting",
    ),
    _wrong(
        "irregular",
        "        self.count += 1\n",
        "        self.count += 1\n        if self.count % 3 == 0:\n            return\n",
        r"period|regular| s\b",
        "every third message is missing",
    ),
    _wrong(
        "stops_after_two",
        "        self.count += 1\n",
        "        self.count += 1\n        if self.count > 2:\n            self.timer.cancel()\n            return\n",
        r"stop|keep|only|message|end",
        "after two messages there are no more",
    ),
    _wrong(
        "publishes_once",
        _TIMER,
        "self.create_timer(period, self.publish_status)\n"
        "        self.publish_status()\n        self.timer.cancel()",
        r"once|one|repeat|period|again",
        "one message, and the timer is cancelled",
    ),
    fault(
        "status_publisher",
        "dies_after_three",
        edit(
            STATUS,
            "        self.count += 1\n",
            "        self.count += 1\n        share = 1 / (3 - self.count)\n        self.get_logger().debug(str(share))\n",
        ),
        r"ZeroDivisionError|ended|died",
        "it divides by zero at the third message",
        least=2,
        most=16,
    ),
    # It publishes nothing.
    _dead(
        "timer_never_made",
        f"        self.timer = {_TIMER}\n",
        "",
        r"publish",
        "nothing ever calls publish_status",
    ),
    _dead(
        "message_not_sent",
        "        self.publisher_.publish(msg)\n",
        "",
        r"publish",
        "the message is made and not sent",
    ),
    _dead("never_spins", _SPIN, "        pass\n", r"spin", "it ends at once"),
    _dead(
        "spins_once",
        _SPIN,
        "        rclpy.spin_once(node, timeout_sec=0.1)\n",
        r"spin|end",
        "it ends at once",
    ),
    _dead(
        "main_does_nothing",
        "    rclpy.init(args=args)\n",
        "    return\n    rclpy.init(args=args)\n",
        r"end|start|run",
        "main returns before it does anything",
    ),
    _dead(
        "callback_called",
        _TIMER,
        "self.create_timer(period, self.publish_status())",
        r"callback-called|publish_status\(\)|NoneType",
        "the method is called where it should be named",
    ),
    _dead(
        "callback_missing",
        _TIMER,
        "self.create_timer(period, self.publish_state)",
        r"callback-missing|publish_state\b|attribute",
        "there is no such method",
    ),
    _dead(
        "callback_wants_message",
        "def publish_status(self):",
        "def publish_status(self, msg):",
        r"callback|argument",
        "a timer gives no message",
    ),
    _dead(
        "callback_without_self",
        "def publish_status(self):",
        "def publish_status():",
        r"callback|argument|self",
        "the method takes no self",
    ),
    _dead(
        "init_missing",
        "    rclpy.init(args=args)\n",
        "",
        r"rclpy-init|rclpy\.init|NotInitialized",
        "rclpy.init() comes first",
    ),
    _dead(
        "init_twice",
        "    rclpy.init(args=args)\n",
        "    rclpy.init(args=args)\n    rclpy.init()\n",
        r"rclpy-init|init\(\)? must|twice|once",
        "rclpy.init() is called twice",
    ),
    _dead("super_missing", _SUPER, "", r"super", "the node itself is never made"),
    _dead(
        "super_misspelt",
        _SUPER,
        "        super().__init('status_publisher')\n",
        r"super|__init",
        "two underscores are missing",
    ),
    _dead(
        "super_late",
        _SUPER + "        self.declare_parameter('timer_period', 2.0)\n",
        "        self.declare_parameter('timer_period', 2.0)\n" + _SUPER,
        r"super|attribute",
        "it is used before it is made",
    ),
    _dead(
        "node_name_with_blank",
        _SUPER,
        "        super().__init__('status publisher')\n",
        r"node.name|InvalidNodeName",
        "a node's name has no blanks",
    ),
    _dead(
        "topic_with_blank",
        _TOPIC,
        "'/robot status', 10)",
        r"topic.name|InvalidTopicName",
        "a topic's name has no blanks",
    ),
    _dead(
        "property_named",
        "        self.publisher_ = self",
        "        self.publishers = self",
        r"node-property|publishers",
        "Node has a property of that name",
    ),
    _dead(
        "attribute_misspelt",
        "        self.publisher_ = self",
        "        self.publisher = self",
        r"publisher_",
        "it is made as publisher and used as publisher_",
    ),
    _dead(
        "wrong_method",
        "self.publisher_.publish(msg)",
        "self.publisher_.publisher(msg)",
        r"publisher-method|publish\b",
        "a publisher's method is publish",
    ),
    _dead(
        "publishes_text",
        "self.publisher_.publish(msg)",
        "self.publisher_.publish(msg.data)",
        r"publish-text|String|TypeError",
        "a text is no message",
    ),
    _dead(
        "data_is_number",
        "msg.data = status_text(self.count)",
        "msg.data = self.count",
        r"string-data-type|str\(|TypeError|data",
        "String.data is a text",
    ),
    _dead(
        "field_misspelt",
        "        msg.data = status_text(self.count)\n",
        "        msg.date = status_text(self.count)\n",
        r"date\b|message-field|attribute",
        "String has no field date",
    ),
    _dead("qos_missing", _TOPIC, "'/robot/status')", r"qos", "the depth is missing"),
    _dead(
        "arguments_swapped",
        "String, '/robot/status', 10",
        "'/robot/status', String, 10",
        r"argument-order|order|type",
        "the type comes first",
    ),
    _dead("queue_size", _TOPIC, "'/robot/status', queue_size=10)", r"queue.size", "an argument of ROS 1"),
    _dead(
        "dot_for_comma",
        _TIMER,
        "self.create_timer(2.0.self.publish_status)",
        r"dot-for-comma|comma|float",
        "a dot in place of a comma",
    ),
    _dead(
        "logger_before_publishing",
        "        self.publisher_.publish(msg)\n",
        "        self.get_logger().info('Publishing', msg.data)\n        self.publisher_.publish(msg)\n",
        r"logger-arguments|logger|argument",
        "the logger takes one text",
    ),
    _dead(
        "endless_constructor",
        f"        self.timer = {_TIMER}\n",
        f"        self.timer = {_TIMER}\n        while True:\n            pass\n",
        r"endless-loop|loop|while",
        "the constructor never ends",
    ),
    _dead(
        "parameter_undeclared",
        "        self.declare_parameter('timer_period', 2.0)\n",
        "",
        r"parameter|declare",
        "the parameter is asked for and never declared",
    ),
    _dead(
        "import_from_rclpy",
        "from rclpy.node import Node",
        "from rclpy import Node",
        r"import|rclpy\.node",
        "Node is in rclpy.node",
    ),
    _dead(
        "import_without_msg",
        "from std_msgs.msg import",
        "from std_msgs import",
        r"import|std_msgs\.msg",
        "messages are in .msg",
    ),
    _dead(
        "imports_rospy",
        "import rclpy\nfrom rclpy.exec",
        "import rospy\nimport rclpy\nfrom rclpy.exec",
        r"rospy|ros1",
        "rospy is of ROS 1",
    ),
    _dead(
        "imports_misspelt",
        "from std_msgs.msg import String",
        "from std_msg.msg import String",
        r"std_msgs?",
        "there is no such module, but one that is called nearly so",
    ),
    _dead("no_import", "from std_msgs.msg import String\n", "", r"String", "NameError"),
    fault(
        "status_publisher",
        "file_empty",
        put(STATUS, ""),
        r"main|empty|status_publisher",
        "the file was never saved",
        least=14,
    ),
    _unreadable(
        "syntax", "    def publish_status(self):", "    def publish_status(self)", "a colon is missing"
    ),
    _unreadable(
        "indentation",
        "        self.count += 1\n",
        "      self.count += 1\n",
        "a line is indented by six blanks",
    ),
    _unreadable("tab", "        self.count += 1\n", "\tself.count += 1\n", "a tab stands among blanks"),
    _unreadable(
        "print_statement",
        "        self.count += 1\n",
        "        self.count += 1\n        print 'publishing'\n",
        "Python 2",
    ),
)
