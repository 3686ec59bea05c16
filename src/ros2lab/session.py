"""One session a kernel: a private context, one executor, one thread.

Nodes run in the background while the notebook goes on.
What a callback raises is kept and shown with its node; the other nodes go on.
"""

from __future__ import annotations

import contextvars
import os
import sys
import weakref
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from ros2lab import course, environment, neighbours
from ros2lab.executor import NodeError
from ros2lab.interrupts import interrupted_says
from ros2lab.node_process import NodeProcess
from ros2lab.session_resources import MATCH_TIMEOUT, Resources, full_name, wait
from ros2lab.topics import DEFAULT_TIMEOUT, TopicLog, find_type, near_misses

if TYPE_CHECKING:
    from ros2lab.recording import Recorder, Replay
    from ros2lab.workspace import Workspace


class LabSession:
    """Runs nodes in the background of a notebook, and listens and talks to them.

    A kernel has one session: a new one closes its predecessor, so that running its cell again replaces
    everything and doubles nothing. It is a context manager, and closes itself when the kernel ends.
    Other notebooks and terminals of the same student share the domain: who has nodes in it is printed.

    Args:
        domain_id: the ROS domain, 0 to 232; None takes `ROS_DOMAIN_ID`, or else a domain of the user's own.

    Raises:
        ValueError: if the domain id is not in 0 to 232.
    """

    _current: weakref.ref[LabSession] | None = None

    def __init__(self, *, domain_id: int | None = None) -> None:
        environment.apply()
        environment.remove_dead_shared_memory()
        self.domain_id = _checked_domain(domain_id)
        predecessor = self.current()
        if predecessor is not None:
            predecessor.close()
        self._resources = Resources(self.domain_id)
        self.node = self._resources.node
        # Not the session itself is handed to threads and to the exit: it can be garbage collected.
        self._finalizer = weakref.finalize(self, self._resources.close)
        LabSession._current = weakref.ref(self)
        self._resources.answer_neighbours(self._finalizer)
        sys.stdout.write(neighbours.notice(neighbours.neighbours(self.domain_id), "session.stop_others()"))

    @classmethod
    def current(cls) -> LabSession | None:
        """Return the session that is open in this kernel, None if there is none."""
        session = cls._current() if cls._current else None
        return session if session is not None and not session.is_closed else None

    @property
    def is_closed(self) -> bool:
        """Whether the session has ended."""
        return not self._finalizer.alive

    @property
    def errors(self) -> tuple[NodeError, ...]:
        """The newest hundred exceptions that callbacks raised, oldest first."""
        return tuple(self._resources.errors)

    def run(self, node_class: Callable[[], Node], **parameters: Any) -> Node:
        """Make a node and spin it in the background.

        The class is used as a student writes it: its `__init__` needs no argument. A node of the same name
        that the session runs already is stopped first.

        Args:
            node_class: a subclass of `rclpy.node.Node`.
            parameters: values of the node's parameters, by name.

        Raises:
            TypeError: if `node_class` is not a subclass of Node.
            ValueError: if the node declares no parameter of a name that is given.
            RuntimeError: if the session is closed.
        """
        resources = self._open()
        if not (isinstance(node_class, type) and issubclass(node_class, Node)):
            raise TypeError(f"run() takes a class derived from rclpy.node.Node, not {node_class!r}.")
        node = _hosted(node_class, resources, parameters)
        unknown = [name for name in parameters if not node.has_parameter(name)]
        if unknown:
            node.destroy_node()
            raise ValueError(f"{node_class.__name__} declares no parameter named {', '.join(unknown)}.")
        resources.add(node, contextvars.copy_context())
        return node

    def stop(self, node: Node | str) -> None:
        """Stop a node that `run` started, given itself or its name; a stopped one stays stopped.

        Raises:
            ValueError: if the session runs no node of that name.
        """
        resources = self._open()
        if isinstance(node, str):
            named = [known for known in resources.nodes if node in (known.get_name(), full_name(known))]
            if not named:
                names = ", ".join(known.get_name() for known in resources.nodes) or "none"
                raise ValueError(f"This session runs no node named {node!r}; it runs: {names}.")
            node = named[0]
        resources.remove(node)

    def start_process(
        self,
        package: str,
        executable: str,
        *,
        workspace: Workspace,
        parameters: Mapping[str, Any] | None = None,
        arguments: Sequence[str] = (),
    ) -> NodeProcess:
        """Start an executable of a built workspace as a process of its own, with `ros2 run`.

        It gets the overlay of the workspace and this session's domain, and ends with the kernel.
        A process of the same package and executable is stopped first.

        Args:
            package: the package's name.
            executable: the executable's name, as in the package's entry points.
            workspace: where it was built.
            parameters: values of the node's parameters, by name.
            arguments: further arguments, put before `--ros-args`.

        Raises:
            ValueError: if the package has no such executable.
            RuntimeError: if the session is closed.
        """
        resources = self._open()
        found = {known.name: known.path for known in workspace.executables(package)}
        if executable not in found:
            names = ", ".join(sorted(found)) or "none"
            raise ValueError(
                f"Package {package} has no executable {executable!r} in {workspace.path} (it has: {names}); "
                "compare with the entry points in setup.py, then build again."
            )
        resources.stop_processes(package, executable)
        settings = [
            part for name, value in (parameters or {}).items() for part in ("-p", f"{name}:={_yaml(value)}")
        ]
        command = ["ros2", "run", package, executable, *arguments]
        command += ["--ros-args", *settings] if settings else []
        environ = {
            **workspace.overlay,
            "ROS_DOMAIN_ID": str(self.domain_id),
            "ROS2LAB_WORK": str(course.work_folder()),
        }
        process = NodeProcess(package, executable, command, environ)
        resources.processes.append(process)
        return process

    def stop_others(self) -> None:
        """Stop what else of yours has nodes in this domain: sessions of other notebooks, programs in terminals.

        A session closes, and its kernel lives on; a program gets what Ctrl-C sends. What was stopped is printed.

        Raises:
            RuntimeError: if the session is closed.
        """
        self._open()
        sys.stdout.write(neighbours.stop_neighbours(self.domain_id))

    def publish(self, topic: str, message: Any) -> None:
        """Publish a message; a text stands for a `std_msgs/String`.

        The first message of a topic waits, up to a second, until the publisher has met every subscription
        that the graph shows: what is published before is lost.

        Args:
            topic: the topic's name.
            message: a message, or a text.

        Raises:
            TypeError: if it is neither.
            ValueError: if a node of this kernel uses the topic with another type.
            RuntimeError: if the session is closed.
        """
        resources = self._open()
        if isinstance(message, str):
            message = String(data=message)
        if not hasattr(type(message), "get_fields_and_field_types"):
            raise TypeError(f"publish() takes a message or a text, not {message!r}.")
        resources.publisher(topic, type(message)).publish(message)

    def log(
        self,
        topic: str,
        message_type: type | str | None = None,
        *,
        capacity: int = 10_000,
        qos: QoSProfile | None = None,
    ) -> TopicLog:
        """Listen to a topic. A log of the same topic that this session has made before is closed.

        Args:
            topic: the topic's name.
            message_type: the message class or its name; None takes what is published there.
            capacity: how many messages are held.
            qos: the quality of service; None takes what every publisher seen now can serve.

        Raises:
            ValueError: if no type is given and none is published there within a second.
            RuntimeError: if the session is closed.
        """
        resources = self._open()
        topic = self.node.resolve_topic_name(topic)
        if message_type is None:
            message_type = self._published_type(topic)
        if isinstance(message_type, str):
            message_type = find_type(message_type)
        return resources.log(topic, message_type, capacity, qos)

    def record(self, path: str | Path, topics: Collection[str] | str | None = None) -> Recorder:
        """Record topics into a file until its `stop()`, or until the session ends.

        The file is MCAP, which `ros2 bag` and Foxglove open, too. An existing file is kept in `~/earlier`.

        Args:
            path: the file, as the lab's terminals write it: `~`, and what is relative, is in the student's folder.
            topics: only these; None takes all, also those that appear later.

        Raises:
            ValueError: if the path is a folder.
            OSError: if the file cannot be written.
            RuntimeError: if the session is closed.
        """
        from ros2lab.recording import Recorder  # noqa: PLC0415 -- the lab's start does not wait for it

        resources, file = self._open(), course.student_path(path)
        resources.end_recorder(file)
        resources.recorders[file] = Recorder(self.node, file, _names(topics))
        return resources.recorders[file]

    def replay(
        self,
        path: str | Path,
        rate: float = 1.0,
        topics: Collection[str] | str | None = None,
        *,
        loop: bool = False,
    ) -> Replay:
        """Publish the messages of a recording again, on their topics, with their timing.

        It plays in the background; `wait()` waits for its end. A replay of the same file is stopped first.

        Args:
            path: the file, as for `record`.
            rate: how many times faster than recorded, from 0.1 to 100.
            topics: only these; None takes all but `/rosout` and `/parameter_events`, where every node publishes.
            loop: whether it begins again at the end.

        Raises:
            FileNotFoundError: if there is no such file; the text names those that are there.
            ValueError: if the file is not a recording of ROS 2, or is still being recorded; if it has none of
                the topics, or none of their types is installed here; or if the rate is not from 0.1 to 100.
            RuntimeError: if the session is closed.
        """
        from ros2lab.recording import Replay  # noqa: PLC0415 -- the lab's start does not wait for it

        resources, file = self._open(), course.student_path(path)
        recorder = resources.recorders.get(file)
        if recorder is not None and recorder.is_recording:
            raise ValueError(
                f"{course.shown_path(file)} is still being recorded; call its recorder's stop() first."
            )
        resources.end_replay(file)
        resources.replays[file] = Replay(self.node, file, rate=rate, topics=_names(topics), loop=loop)
        return resources.replays[file]

    def subscribers(self, topic: str) -> int:
        """Count the subscriptions to a topic other than this session's own logs."""
        self._open()
        own = self.node.get_name(), self.node.get_namespace()
        infos = self.node.get_subscriptions_info_by_topic(self.node.resolve_topic_name(topic))
        return sum((info.node_name, info.node_namespace) != own for info in infos)

    def wait_for_subscribers(self, topic: str, n: int = 1, timeout: float = DEFAULT_TIMEOUT) -> None:
        """Wait until `n` nodes listen to a topic.

        Raises:
            TimeoutError: if they do not within `timeout` seconds.
        """
        with interrupted_says("the session goes on."):
            is_met = wait(lambda: self.subscribers(topic) >= n, timeout)
        if not is_met:
            raise TimeoutError(
                f"{self.subscribers(topic)} of {n} expected nodes listen on {topic} after {timeout:g} s; "
                "is the node running, and is its topic spelt like this?"
            )

    def on_close(self, callback: Callable[[], None]) -> None:
        """Have `callback` called when the session closes; the newest is called first."""
        self._open().callbacks.append(callback)

    def close(self) -> None:
        """End the nodes, the processes, the thread and the context. Closing twice does no harm."""
        self._finalizer()

    def _open(self) -> Resources:
        if self.is_closed:
            raise RuntimeError("This session is closed; make a new one with LabSession().")
        return self._resources

    def _published_type(self, topic: str) -> str:
        infos: list[Any] = []

        def is_published() -> bool:
            infos[:] = self.node.get_publishers_info_by_topic(topic)
            return bool(infos)

        if not wait(is_published, MATCH_TIMEOUT):
            raise ValueError(
                " ".join(
                    [f"No node publishes on {topic}, so its type is unknown.", *near_misses(self.node, topic)]
                )
                + f" Or name the type: log({topic!r}, String)."
            )
        return str(infos[0].topic_type)

    def __enter__(self) -> LabSession:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        if self.is_closed:
            return "LabSession(closed)"
        names = ", ".join(node.get_name() for node in self._resources.nodes) or "no nodes"
        return f"LabSession({names})"


def _hosted(node_class: type[Node], resources: Resources, parameters: Mapping[str, Any]) -> Node:
    """Make a `node_class` that lives in the session's context and starts with `parameters`.

    Students' nodes call `super().__init__('name')` and pass no context on. A class put between theirs and
    `Node` in the method resolution order adds what is missing, and nothing of theirs is changed.
    """

    class Hosted(Node):
        def __init__(self, node_name: str, **options: Any) -> None:
            resources.replace(node_name, options.get("namespace"))
            overrides = [Parameter(name, value=value) for name, value in parameters.items()]
            overrides += options.pop("parameter_overrides", None) or []
            options.setdefault("context", resources.node.context)
            super().__init__(node_name, parameter_overrides=overrides, **options)

    names = {"__module__": node_class.__module__, "__qualname__": node_class.__qualname__}
    hosted: type[Node] = type(node_class.__name__, (node_class, Hosted), names)
    return hosted()


def _names(topics: Collection[str] | str | None) -> Collection[str] | None:
    return (topics,) if isinstance(topics, str) else topics


def _checked_domain(domain_id: int | None) -> int:
    text = str(domain_id) if domain_id is not None else os.environ["ROS_DOMAIN_ID"]
    if not (text.isascii() and text.isdigit() and int(text) <= 232):
        raise ValueError(f"The domain id must be a whole number from 0 to 232 (ROS_DOMAIN_ID), not {text!r}.")
    return int(text)


def _yaml(value: Any) -> str:
    """Write a parameter's value as `--ros-args -p` reads it."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_yaml(item) for item in value)}]"
    if isinstance(value, str):
        # Quoted, or YAML would read a text such as 'on' or '10' as something else.
        return "'{}'".format(value.replace("'", "''"))
    return str(value).lower() if isinstance(value, bool) else repr(value)
