"""A bench for one test: its own context and domain, nodes under test, and someone who listens."""

import os
import socket
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.msg import Log
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from std_msgs.msg import String

DEADLINE = 60.0  # s; far more than anything here takes
LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Bench:
    """Nodes under test and a listener, spun by the test itself and only while it waits."""

    def __init__(self, domain_id: int) -> None:
        self.domain_id = domain_id
        self._context = Context()
        self._context.init(args=[], domain_id=domain_id)
        self._executor = SingleThreadedExecutor(context=self._context)
        self.listener = Node("listener", context=self._context, use_global_arguments=False)
        self._executor.add_node(self.listener)
        self._nodes = [self.listener]

    def add(self, node_class: type[Node], *arguments: str, **parameters: Any) -> Node:
        """Make a node, with command line arguments and parameters, and let it run."""
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = node_class(
            context=self._context,
            use_global_arguments=False,
            cli_args=["--ros-args", *arguments],
            parameter_overrides=overrides,
        )
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def remove(self, node: Node) -> None:
        """Destroy a node as its process would at its end."""
        self._nodes.remove(node)
        self._executor.remove_node(node)
        node.destroy_node()

    def hear(self, topic: str, message_type: type, qos: QoSProfile | int = 100) -> list[Any]:
        """Return the list in which the messages on a topic arrive."""
        messages: list[Any] = []
        self.listener.create_subscription(message_type, topic, messages.append, qos)
        return messages

    def hear_words(self, topic: str, qos: QoSProfile | int = 100) -> list[str]:
        """Return the list in which the texts on a topic arrive."""
        words: list[str] = []
        self.listener.create_subscription(
            String,
            topic,
            lambda message: words.append(message.data),
            qos,
        )
        return words

    def hear_log(self) -> list[str]:
        """Return the list in which log lines arrive, as `WARN velocity_publisher: ...`."""
        levels = {20: "INFO", 30: "WARN", 40: "ERROR"}
        lines: list[str] = []
        self.listener.create_subscription(
            Log,
            "/rosout",
            lambda m: lines.append(f"{levels.get(m.level)} {m.name}: {m.msg}"),
            LATCHED,
        )
        return lines

    def speaker(self, topic: str, qos: QoSProfile | int = 10, listeners: int = 1) -> Publisher:
        """Return a publisher of texts that so many subscriptions are connected to."""
        publisher = self.listener.create_publisher(String, topic, qos)
        self.until(
            lambda: publisher.get_subscription_count() >= listeners,
            f"somebody listens to {topic}",
        )
        return publisher

    def is_running(self, name: str) -> bool:
        """Return whether a node of that name offers its services.

        The list of node names is not asked: the middleware keeps a name for ever, if what it
        heard last of a node is worked through only after the node is gone.
        """
        return self.listener.count_services(f"/{name}/get_parameters") > 0

    def set_time(self, node: Node, seconds: float) -> None:
        """Set a node's simulated time (`use_sim_time`), and let the timers run that are due."""
        node.get_clock().set_ros_time_override(Time(seconds=seconds))
        on_ros_time = [timer for timer in node.timers if timer.clock is node.get_clock()]
        self.until(
            lambda: not any(timer.is_ready() for timer in on_ros_time),
            "the due timers have run",
        )

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Spin until the condition holds; fail at the deadline, saying what did not happen."""
        end = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < end, f"did not happen within {DEADLINE:.0f} s: {what}"
            self._executor.spin_once(timeout_sec=0.05)

    def close(self) -> None:
        """Destroy everything."""
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self._context.try_shutdown()


@pytest.fixture(scope="session")
def domain_id(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """Take a domain that no other run of these tests uses, and keep everything on this machine."""
    with socket.socket(socket.AF_UNIX) as claim:
        domain = _claim_domain(claim)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            patch.setenv("ROS_LOG_DIR", str(tmp_path_factory.mktemp("log")))
            yield domain


@pytest.fixture
def bench(domain_id: int) -> Iterator[Bench]:
    """Give a test its bench."""
    bench = Bench(domain_id)
    yield bench
    bench.close()


@pytest.fixture(scope="session")
def package() -> Path:
    """Return the folder of the package's sources."""
    return Path(__file__).parent.parent


def _claim_domain(claim: socket.socket) -> int:
    # Above the ports that Linux gives out by itself: DDS computes its ports from the domain.
    for domain in range(215, 232):
        try:
            claim.bind(f"\0robot_controller_test_domain_{domain}")
        except OSError:
            continue
        return domain
    raise RuntimeError("17 runs of these tests are under way already: wait for one to end")


# A float field that is given an integer is an error, and not silently a wrong number.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
