"""Faults of the node that obeys commands."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import RUNS, both, fault
from corpus.package import COMMAND, OBEY
from corpus.tree import Change, edit

_SUBSCRIPTION = """\
        self.subscription = self.create_subscription(
            String, '/robot/command', self.on_command, 10)
"""
_STATES = "STATES = {'start': 'running', 'stop': 'stopped', 'reset': 'idle'}"
_LOG = "        self.get_logger().info(f'Received {msg.data}: now {self.state}')\n"


def _wrongly(
    name: str, change: Change, cause: str, about: str, *, least: float = 1, most: float = 16
) -> Case:
    """It runs, and does something else."""
    return fault("command_subscriber", name, change, cause, about, least=least, most=most, earns=RUNS)


def _wrong(
    name: str, old: str, new: str, cause: str, about: str, *, least: float = 1, most: float = 16
) -> Case:
    return _wrongly(name, edit(COMMAND, old, new), cause, about, least=least, most=most)


def _obeys(name: str, body: str, cause: str, about: str, *, least: float = 1, most: float = 16) -> Case:
    """Another body of the callback."""
    return _wrong(name, OBEY, body, cause, about, least=least, most=most)


def _dead(name: str, old: str, new: str, cause: str, about: str) -> Case:
    """It obeys no command, ever."""
    return _never(name, edit(COMMAND, old, new), cause, about)


def _never(name: str, change: Change, cause: str, about: str) -> Case:
    return fault("command_subscriber", name, change, cause, about, least=12)


COMMAND_FAULTS: tuple[Case, ...] = (
    # It hears something else.
    _wrong(
        "topic_plural",
        "'/robot/command'",
        "'/robot/commands'",
        r"/robot/commands",
        "one letter too many",
        least=2,
    ),
    _wrong(
        "topic_underscore",
        "'/robot/command'",
        "'/robot_command'",
        r"/robot_command",
        "an underscore for the slash",
        least=2,
    ),
    _wrong(
        "topic_other",
        "'/robot/command'",
        "'/cmd'",
        r"/cmd\b|/robot/command",
        "another topic",
        least=2,
        most=8,
    ),
    _wrong(
        "topic_of_velocity",
        "'/robot/command'",
        "'/cmd_vel'",
        r"/cmd_vel|/robot/command",
        "commands are expected on /cmd_vel",
        least=2,
        most=20,
    ),
    _wrongly(
        "type_int",
        both(
            edit(COMMAND, "import String", "import Int32, String"),
            edit(COMMAND, "            String, '/robot", "            Int32, '/robot"),
            edit(COMMAND, "next_state(msg.data)", "next_state(list(STATES)[msg.data])"),
        ),
        r"Int32",
        "the assignment says String",
        least=4,
        most=20,
    ),
    # It obeys some of them, or in a wrong way.
    _wrong(
        "only_start",
        _STATES,
        "STATES = {'start': 'running'}",
        r"stop|reset",
        "stop and reset are refused as dance is",
        least=2,
    ),
    _wrong(
        "no_reset",
        _STATES,
        "STATES = {'start': 'running', 'stop': 'stopped'}",
        r"reset",
        "reset is refused as dance is",
        most=10,
    ),
    _wrong(
        "reset_misspelt",
        "'reset': 'idle'",
        "'rest': 'idle'",
        r"reset",
        "reset is refused as dance is",
        most=10,
    ),
    _wrong(
        "start_and_stop_inverted",
        _STATES,
        "STATES = {'start': 'stopped', 'stop': 'running', 'reset': 'idle'}",
        r"start|stop",
        "the robot drives after stop and stands after start",
    ),
    _wrong(
        "capitals_only",
        "    word = command.strip().lower()\n    if word not in STATES:",
        "    word = command if command.istitle() else ''\n    word = word.lower()\n    if word not in STATES:",
        r"start|stop|reset",
        "Start is obeyed, and start is refused as dance is",
        least=3,
        most=20,
    ),
    _obeys(
        "compares_message",
        """\
        if msg == 'start':
            self.state = 'running'
            self.get_logger().info('Robot starts')
        elif msg == 'stop':
            self.state = 'stopped'
            self.get_logger().info('Robot stops')
        elif msg == 'reset':
            self.state = 'idle'
            self.get_logger().info('Robot is reset')
""",
        r"start|stop|reset|data",
        "the message is compared in place of its data: nothing is ever obeyed",
        least=8,
        most=20,
    ),
    _obeys(
        "compares_by_is",
        """\
        if msg.data is 'start':
            self.state = 'running'
            self.get_logger().info('Robot starts')
        elif msg.data is 'stop':
            self.state = 'stopped'
            self.get_logger().info('Robot stops')
        elif msg.data is 'reset':
            self.state = 'idle'
            self.get_logger().info('Robot is reset')
        else:
            self.get_logger().info(f'Received {msg.data}, which is not a command')
""",
        r"literal-comparison",
        "a text that was received is never one object with another: nothing is ever obeyed",
        least=6,
        most=20,
    ),
    _obeys(
        "logs_and_compares_message",
        """\
        self.get_logger().info(f'Received {msg.data}')
        if msg == 'start':
            self.state = 'running'
        elif msg == 'stop':
            self.state = 'stopped'
        elif msg == 'reset':
            self.state = 'idle'
        else:
            self.get_logger().warning('Unknown command')
""",
        r"message-compared",
        "every command is logged, and called unknown",
        most=6,
    ),
    _obeys(
        "only_logs",
        "        self.get_logger().info(f'I heard: {msg.data}')\n",
        r"start|stop|reset|log|process|react",
        "every text is logged in the same way, and none has an effect",
        most=14,
    ),
    _obeys(
        "says_nothing_else_than_heard",
        "        self.get_logger().info('I heard a command')\n",
        r"start|stop|reset|log",
        "the log does not even tell which command it was",
        least=3,
        most=18,
    ),
    _wrong("logs_nothing", _LOG, "", r"log", "commands are obeyed and not logged", most=10),
    _wrong(
        "logs_in_debug",
        "self.get_logger().info(f'Received",
        "self.get_logger().debug(f'Received",
        r"log",
        "nobody sees a debug line",
        most=10,
    ),
    _wrong(
        "unknown_starts",
        "        raise ValueError(f'Unknown command: {command!r}')\n",
        "        return 'running'\n",
        r"unknown|dance|empty",
        "any word starts the robot",
        most=10,
    ),
    _wrong(
        "obeys_once",
        _LOG,
        _LOG + "        self.destroy_subscription(self.subscription)\n",
        r"stop|reset|command",
        "it hears no second command",
        least=2,
    ),
    # It dies or hangs.
    _obeys(
        "dies_on_unknown",
        """\
        self.state = STATES[msg.data.strip().lower()]
        self.get_logger().info(f'Received {msg.data}: now {self.state}')
        self.publisher_.publish(String(data=self.state))
""",
        r"KeyError|ended|died|unknown",
        "KeyError for a word that it does not know",
        most=12,
    ),
    _wrong(
        "dies_on_empty",
        "    word = command.strip().lower()\n",
        "    word = command.split()[0].lower()\n",
        r"IndexError|ended|died|empty",
        "IndexError for an empty text",
        most=12,
    ),
    _wrong(
        "dies_on_reset",
        _LOG,
        _LOG + "        if self.state == 'idle':\n            self.counter += 1\n",
        r"AttributeError|counter|ended|died|reset",
        "reset uses what was never made",
        most=16,
    ),
    _wrong(
        "ends_at_stop",
        _LOG,
        _LOG + "        if self.state == 'stopped':\n            raise SystemExit(0)\n",
        r"end|stop|alive",
        "stop ends the program in place of the robot",
        most=16,
    ),
    _wrong(
        "shutdown_in_callback",
        _LOG,
        _LOG + "        if self.state == 'stopped':\n            rclpy.shutdown()\n",
        r"end|stop|shutdown|alive",
        "stop ends ROS in place of the robot",
        most=18,
    ),
    _wrong(
        "hangs_at_start",
        _LOG,
        _LOG + "        while self.state == 'running':\n            pass\n",
        r"stop|loop|hang|answer|endless",
        "it waits in the callback for a stop that it cannot hear",
        least=2,
        most=18,
    ),
    _wrong(
        "sleeps_after_command",
        _LOG,
        "        import time\n" + _LOG + "        time.sleep(60.0)\n",
        r"stop|reset|sleep|answer",
        "for a minute it hears nothing else",
        least=2,
        most=18,
    ),
    # It obeys nothing.
    _dead(
        "subscription_never_made", _SUBSCRIPTION, "", r"subscri|/robot/command", "nothing is subscribed to"
    ),
    _dead(
        "publishes_instead",
        _SUBSCRIPTION,
        "        self.subscription = self.create_publisher(String, '/robot/command', 10)\n",
        r"subscri",
        "it publishes commands in place of hearing them",
    ),
    _dead(
        "reads_keyboard",
        "        rclpy.spin(node)\n",
        "        while True:\n            node.on_command(String(data=input('command: ')))\n",
        r"EOFError|ended|spin|/robot/command",
        "commands are asked for at the keyboard",
    ),
    _dead("never_spins", "        rclpy.spin(node)\n", "        pass\n", r"spin", "it ends at once"),
    _dead(
        "sleeps_for_spin",
        "        rclpy.spin(node)\n",
        "        import time\n        while rclpy.ok():\n            time.sleep(0.1)\n",
        r"spin|command",
        "it lives, and no callback is ever called",
    ),
    _dead(
        "callback_without_message",
        "def on_command(self, msg):",
        "def on_command(self):",
        r"callback",
        "a subscription gives a message",
    ),
    _dead(
        "callback_called",
        "self.on_command, 10)",
        "self.on_command(None), 10)",
        r"callback|on_command|NoneType",
        "the method is called",
    ),
    _dead(
        "callback_missing",
        "self.on_command, 10)",
        "self.on_comand, 10)",
        r"on_comand|callback",
        "there is no such method",
    ),
    _never(
        "callback_called_handle",
        both(
            edit(COMMAND, "def on_command(", "def handle("), edit(COMMAND, "self.on_command,", "self.handle,")
        ),
        r"node-property|\bhandle\b",
        "the callback hides what every node has by this name",
    ),
    _dead("qos_missing", "self.on_command, 10)", "self.on_command)", r"qos", "the depth is missing"),
    _dead(
        "arguments_swapped",
        "self.on_command, 10)",
        "10, self.on_command)",
        r"argument-order|order|qos",
        "the callback comes before the depth",
    ),
    _dead("type_not_imported", "from std_msgs.msg import String\n", "", r"String", "NameError"),
    _dead(
        "type_is_str",
        "            String, '/robot",
        "            str, '/robot",
        r"type|String",
        "str is no message type",
    ),
    _dead(
        "field_misspelt",
        "next_state(msg.data)",
        "next_state(msg.command)",
        r"command|message-field|attribute",
        "String has no field command: it dies at the first one",
    ),
    _dead(
        "raises_at_start",
        "        self.state = 'idle'\n",
        "        self.state = INITIAL_STATE\n",
        r"INITIAL_STATE",
        "NameError",
    ),
    _dead(
        "super_missing",
        "        super().__init__('command_subscriber')\n",
        "",
        r"super",
        "the node itself is never made",
    ),
    fault(
        "command_subscriber",
        "syntax",
        edit(COMMAND, "    if word not in STATES:", "    if word not in STATES"),
        r"command_subscriber\.py",
        "a colon is missing",
        least=14,
        unreadable=("/command_subscriber.py",),
    ),
)
