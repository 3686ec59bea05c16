"""A form that publishes any message."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from matplotlib.figure import Figure

from ros2lab.message_schema import FormError, filled, message_schema
from ros2lab.message_tree import message_tree
from ros2lab.session import LabSession
from ros2lab.topics import one_type_a_topic, type_name
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import (
    StoredView,
    check_number,
    check_session,
    resolved,
    style_sheet,
    text_figure,
)
from ros2lab.widgets.topic_monitor import message_class

LEAST_RATE = 0.1  # Hz
MOST_RATE = 100.0  # Hz
LOOK_RATE = 2.0  # Hz
# A browser calls the timers of a hidden page once a minute only.
MOST_ABSENCE = 150.0  # s without a word of the browser, after which its page is taken for gone
LINES_IN_PICTURE = 40


class MessageForm(StoredView, anywidget.AnyWidget):
    """Publishes messages of any type, as typed into a form: once, or again and again at a rate.

    What does not fit its field is refused there, and nothing is published.

    Args:
        session: where is published; closing it closes the form.
        topic: the topic's name.
        message_type: the message class or its name, such as `geometry_msgs/msg/Pose`.

    Attributes:
        sent: how many messages were published.
        listeners: how many nodes listen to the topic.
        publishing_rate: in Hz; 0 while nothing is published by itself.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if the topic's name is none, the type cannot be imported, or a node of this kernel uses the
            topic with another type.
        RuntimeError: if the session is closed.
    """

    _esm = Path(__file__).with_name("message_form.js")
    _css = style_sheet("message_form")

    topic = traitlets.Unicode("", read_only=True).tag(sync=True)
    type_name = traitlets.Unicode("", read_only=True).tag(sync=True)
    fields: Any = traitlets.List(read_only=True).tag(sync=True)
    rate_range = traitlets.List([LEAST_RATE, MOST_RATE], read_only=True).tag(sync=True)
    sent = traitlets.Int(0, read_only=True).tag(sync=True)
    listeners = traitlets.Int(0, read_only=True).tag(sync=True)
    publishing_rate = traitlets.Float(0.0, read_only=True).tag(sync=True)

    def __init__(self, session: LabSession, topic: str, message_type: type | str) -> None:
        check_session(session, "MessageForm")
        topic = resolved(session, topic)
        self._type = message_class(message_type)
        self._redraw = redraw_of(session)
        # A second type on the topic is refused here, and not at the first click.
        with one_type_a_topic(session.node, topic, type_name(self._type)):
            session.node.destroy_publisher(session.node.create_publisher(self._type, topic, 1))
        self._message: Any = self._type()
        self._stamp_setters: list[Callable[[Any], None]] = []
        self._publishing = threading.RLock()
        self._count = 0
        self._heard = time.monotonic()
        self.set_trait("topic", topic)
        self.set_trait("type_name", type_name(self._type))
        self.set_trait("fields", message_schema(self._type))
        super().__init__()
        self.on_msg(self._on_message)
        self._open_in(session, topic)
        self._look_around()
        self._redraw.add(self._look_around, LOOK_RATE)

    @property
    def message(self) -> Any:
        """What was published last, or the message as it begins."""
        return self._message

    def publish(self, values: Mapping[str, Any] | None = None) -> Any:
        """Publish what was typed, once; what is published at a rate is this message from now on.

        Args:
            values: texts and booleans by field, nested as the message is, lists for arrays; what is missing
                keeps its default. None publishes the last message again.

        Returns:
            The message.

        Raises:
            FormError: if something does not fit, with a sentence for each such field; nothing is published.
            RuntimeError: if the form or its session is closed.
        """
        if self.is_closed:
            raise RuntimeError("This form is closed; make a new one with MessageForm().")
        made = (self._message, self._stamp_setters) if values is None else filled(self._type, values)
        with self._publishing:
            self._message, self._stamp_setters = made
            self._publish_again()
        self._show_count()
        return self._message

    def start(self, rate: float, values: Mapping[str, Any] | None = None) -> None:
        """Publish now, and then `rate` times a second, until `stop`.

        Args:
            rate: from 0.1 to 100 Hz.
            values: as `publish` takes them.

        Raises:
            TypeError: if the rate is not a number.
            ValueError: if the rate is out of its range; FormError, one of these, as `publish` raises it.
            RuntimeError: if the form or its session is closed.
        """
        rate = check_number("The rate", rate, LEAST_RATE, MOST_RATE, "Hz")
        # The first one may wait for its subscribers, for which the redraw thread has no time.
        self.publish(values)
        self._heard = time.monotonic()
        self._redraw.add(self._publish_again, rate)
        self.set_trait("publishing_rate", rate)

    def stop(self) -> None:
        """Publish nothing by itself any more. Stopping twice does no harm."""
        self._redraw.remove(self._publish_again)
        self.set_trait("publishing_rate", 0.0)
        self._show_count()

    def still(self) -> Figure:
        """Draw the last message, as far as it fits, with matplotlib."""
        tree = list(message_tree(self._message).lines())
        lines = [f"{self._count} published", "", *tree[:LINES_IN_PICTURE]]
        lines += [f"… {len(tree) - LINES_IN_PICTURE} lines more"] if len(tree) > LINES_IN_PICTURE else []
        return text_figure(f"Publish {self.topic} {self.type_name}", lines)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return f"Form that publishes {self.type_name} on {self.topic}: {self._count} published."

    def _publish_again(self) -> None:
        with self._publishing:
            if self._stamp_setters:
                now = self.session.node.get_clock().now().to_msg()
                for set_stamp in self._stamp_setters:
                    set_stamp(now)
            self.session.publish(self.topic, self._message)
            self._count += 1

    def _on_message(self, _: object, content: Any, __: object) -> None:
        self._heard = time.monotonic()
        action = content.get("do")
        if action == "stop":
            self.stop()
        elif action in ("publish", "start") and not self.is_closed:
            self.send({"answer": content.get("number"), **self._answer(action, content)})

    def _answer(self, action: str, content: Any) -> dict[str, Any]:
        """Do what the browser asks for, and return what does not fit."""
        try:
            if action == "start":
                self.start(content.get("rate"), content.get("values"))
            else:
                self.publish(content.get("values"))
        except FormError as error:
            return {"problems": error.problems}
        except (TypeError, ValueError, RuntimeError) as error:
            return {"problems": {"": str(error)}}
        return {"problems": {}}

    def _look_around(self) -> None:
        self.set_trait("listeners", self.session.subscribers(self.topic))
        self._show_count()
        if self.publishing_rate and time.monotonic() - self._heard > MOST_ABSENCE:
            self.stop()

    def _show_count(self) -> None:
        self.set_trait("sent", self._count)

    def _stop(self) -> None:
        self._redraw.remove(self._look_around)
        self.stop()

    def __repr__(self) -> str:
        return f"MessageForm({self.topic})"
