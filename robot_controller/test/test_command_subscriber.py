"""The node that obeys the commands."""

from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from conftest import LATCHED, Bench
from robot_controller.command_subscriber import CommandSubscriber


def test_commands_change_the_state(bench: Bench) -> None:
    """Each change is published once, what changes nothing or is refused is not."""
    states = bench.hear_words("/robot/state")
    bench.add(CommandSubscriber)
    bench.until(lambda: states == ["idle"], "the first state is idle")
    commands = bench.speaker("/robot/command")
    for word in [
        "stop",
        " START ",
        "start",
        "",
        "jump",
        "x" * 5000,
        "start\0",
        "Stop",
        "stop",
        "start",
        "reset",
    ]:
        commands.publish(String(data=word))
    expected = ["idle", "running", "stopped", "running", "idle"]
    bench.until(lambda: len(states) >= len(expected), f"the states are {expected}, not {states}")
    assert states == expected


def test_a_late_node_knows_the_state(bench: Bench) -> None:
    """Who subscribes after the change hears the last state, and only that."""
    node = bench.add(CommandSubscriber)
    early = bench.hear_words("/robot/state")
    bench.speaker("/robot/command").publish(String(data="start"))
    bench.until(lambda: early[-1:] == ["running"], "the robot runs")
    late = bench.hear_words("/robot/state", LATCHED)
    bench.until(lambda: bool(late), "the late subscription hears the state")
    assert late == ["running"]
    (offered,) = bench.listener.get_publishers_info_by_topic("/robot/state")
    assert offered.qos_profile.reliability is ReliabilityPolicy.RELIABLE
    bench.remove(node)


def test_each_kind_of_publisher_is_heard(bench: Bench) -> None:
    """Commands from a transient-local publisher (`ros2 topic pub` may be one) arrive as well."""
    states = bench.hear_words("/robot/state")
    bench.add(CommandSubscriber)
    bench.speaker("/robot/command", LATCHED).publish(String(data="start"))
    bench.until(lambda: states[-1:] == ["running"], "a transient-local command is obeyed")
    bench.speaker("/robot/command", QoSProfile(depth=1)).publish(String(data="stop"))
    bench.until(lambda: states[-1:] == ["stopped"], "a volatile command is obeyed")
    (requested,) = bench.listener.get_subscriptions_info_by_topic("/robot/command")
    assert requested.qos_profile.reliability is ReliabilityPolicy.RELIABLE


def test_each_command_is_logged_with_its_effect(bench: Bench) -> None:
    """One line a command; refused ones are warnings, shortened and on one line."""
    lines = bench.hear_log()
    bench.add(CommandSubscriber)
    commands = bench.speaker("/robot/command")
    for word in ["Start", "start", "", "a\nb\x1b[31m", "x" * 5000, "reset"]:
        commands.publish(String(data=word))
    accepted = "accepted: start, stop, reset."
    expected = [
        "INFO command_subscriber: Received 'start': idle -> running",
        "INFO command_subscriber: Received 'start': still running, it is running already",
        f"WARN command_subscriber: Refused a command: the command is empty; {accepted}",
        f"WARN command_subscriber: Refused a command: 'a\\nb\\x1b[31m' is not known; {accepted}",
        f"WARN command_subscriber: Refused a command: '{'x' * 40}…' is too long "
        f"(5000 characters); {accepted}",
        "INFO command_subscriber: Received 'reset': running -> idle",
    ]
    bench.until(lambda: len(lines) >= len(expected), f"a line for each, and not only {lines}")
    assert lines == expected


def test_a_namespace_moves_the_topics(bench: Bench) -> None:
    """The topics are relative."""
    states = bench.hear_words("/anna/robot/state")
    bench.add(CommandSubscriber, "-r", "__ns:=/anna")
    bench.speaker("/anna/robot/command").publish(String(data="start"))
    bench.until(lambda: states == ["idle", "running"], "the node in /anna obeys and answers there")
