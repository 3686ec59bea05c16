"""What a session owns, and how it is closed."""

from __future__ import annotations

import contextvars
import logging
import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from ros2lab import neighbours
from ros2lab.executor import IsolatingExecutor, NodeError
from ros2lab.node_process import NodeProcess
from ros2lab.topics import TopicLog, one_type_a_topic, type_name

if TYPE_CHECKING:
    from ros2lab.recording import Recorder, Replay


THREAD_NAME = "ros2lab-executor"
CLOSE_TIMEOUT = 5.0  # s
MATCH_TIMEOUT = 1.0  # s
POLL_PERIOD = 0.005  # s, for facts about the graph, of which rclpy sends no event


class Resources:
    """Everything that a session owns and must give back; knows nothing of the session itself."""

    def __init__(self, domain_id: int) -> None:
        self.nodes: list[Node] = []
        self.processes: list[NodeProcess] = []
        self.callbacks: list[Callable[[], None]] = []
        self.recorders: dict[Path, Recorder] = {}
        self.replays: dict[Path, Replay] = {}
        self.errors: deque[NodeError] = deque(maxlen=100)
        self._shown: set[tuple[str, str]] = set()
        self._cells: dict[str, contextvars.Context] = {}
        self._publishers: dict[tuple[str, type], Any] = {}
        self._logs: dict[str, TopicLog] = {}
        self._listener: neighbours.Listener | None = None
        self._context = Context()
        rclpy.init(
            # A log line printed from the ROS thread would land in whichever cell runs; /rosout has it too.
            args=["--ros-args", "--disable-stdout-logs"],
            context=self._context,
            domain_id=domain_id,
            # Interrupting the kernel must not end the nodes.
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._executor = IsolatingExecutor(self._on_error, context=self._context)
        self.node = Node("ros2lab", context=self._context, start_parameter_services=False)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, name=THREAD_NAME, daemon=True)
        self._thread.start()

    def answer_neighbours(self, close: Callable[[], object]) -> None:
        """Let other notebooks ask for the nodes, and close the session, as if its own cell did."""
        cell = contextvars.copy_context()
        self._listener = neighbours.Listener(
            lambda: [node.get_name() for node in self.nodes], lambda: cell.run(close)
        )

    def add(self, node: Node, cell: contextvars.Context) -> None:
        """Spin a node; its callbacks run in a cell's context."""
        self.nodes.append(node)
        self._cells[node.get_name()] = cell
        self._executor.add_node(node)

    def remove(self, node: Node) -> None:
        """Spin a node no more, and destroy it."""
        if node in self.nodes:
            self.nodes.remove(node)
            self._executor.remove_node(node)
            self._executor.between_callbacks(node.destroy_node)

    def replace(self, name: str, namespace: str | None) -> None:
        """Make room for a node of this name."""
        wanted = f"/{(namespace or '').strip('/')}/{name}".replace("//", "/")
        for node in [node for node in self.nodes if full_name(node) == wanted]:
            self.remove(node)

    def stop_processes(self, package: str, executable: str) -> None:
        """End the processes of an executable."""
        for process in list(self.processes):
            if (process.package, process.executable) == (package, executable):
                process.stop()
                self.processes.remove(process)

    def end_recorder(self, path: Path) -> None:
        """End the recording into a file."""
        if path in self.recorders:
            self.recorders.pop(path).stop()

    def end_replay(self, path: Path) -> None:
        """End the replay of a file."""
        if path in self.replays:
            self.replays.pop(path).stop()

    def publisher(self, topic: str, message_type: type) -> Any:
        """Return the publisher of a topic, made at the first call."""
        topic = self.node.resolve_topic_name(topic)
        if (topic, message_type) not in self._publishers:
            # Transient-local, so that subscribers that insist on it hear us too.
            qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            name = type_name(message_type)
            with one_type_a_topic(self.node, topic, name):
                publisher = self.node.create_publisher(message_type, topic, qos)
            self._publishers[topic, message_type] = publisher

            def has_met_all() -> bool:
                infos = self.node.get_subscriptions_info_by_topic(topic)
                return bool(
                    publisher.get_subscription_count() >= sum(info.topic_type == name for info in infos)
                )

            wait(has_met_all, MATCH_TIMEOUT)
        return self._publishers[topic, message_type]

    def log(self, topic: str, message_type: type, capacity: int, qos: QoSProfile | None) -> TopicLog:
        """Log a topic until the session is closed."""
        if topic in self._logs:
            self._logs[topic].close()
        errors = self.errors
        self._logs[topic] = TopicLog(
            self.node,
            topic,
            message_type,
            capacity=capacity,
            qos=qos,
            notes=lambda: [f"{error.headline}." for error in list(errors)[-1:]],
        )
        return self._logs[topic]

    def close(self) -> None:
        """Give everything back, in the order in which nothing is missed by what is still there."""
        if self._listener is not None:
            self._listener.close()
        for callback in reversed(self.callbacks):
            try:
                callback()
            except Exception:
                # One widget that cannot close must not keep the robot running.
                traceback.print_exc()
        for path in list(self.replays):
            self.end_replay(path)
        for process in self.processes:
            process.stop()
        for path in list(self.recorders):  # after what the nodes said as they ended
            self.end_recorder(path)
        self._executor.shutdown(CLOSE_TIMEOUT)
        if self._thread is not threading.current_thread():
            self._thread.join(CLOSE_TIMEOUT)
        for log in self._logs.values():
            log.close()  # so that one who waits for it is told
        for node in [*self.nodes, self.node]:
            node.destroy_node()
        self.nodes.clear()
        self._context.try_shutdown()

    def _on_error(self, node: Node | None, exception: BaseException) -> None:
        error = NodeError.of(node, exception)
        self.errors.append(error)
        if isinstance(exception, SystemExit) and node is not None:
            self.remove(node)
        # A timer that raises does so ten times a second: it is shown once.
        if (error.node_name, error.place) not in self._shown:
            self._shown.add((error.node_name, error.place))
            # In the context of the cell that ran the node, so that it is shown below that cell.
            self._cells.get(error.node_name, contextvars.copy_context()).run(_show, error)


def full_name(node: Node) -> str:
    """Return the full name of a node."""
    return str(node.get_fully_qualified_name())


def wait(condition: Callable[[], bool], timeout: float) -> bool:
    """Wait until a fact about the graph holds; return whether it does."""
    deadline = time.monotonic() + timeout
    while not condition():
        if time.monotonic() >= deadline:
            return False
        time.sleep(POLL_PERIOD)
    return True


def _show(error: NodeError) -> None:
    """Show an error in the notebook, or log it where there is none."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    if ipython is not None and hasattr(shell, "kernel"):
        ipython.display.display(error)
    else:
        logging.getLogger(__name__).error("%s", error)
