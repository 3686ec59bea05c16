"""Buttons and a line of text that drive the robot."""

from __future__ import annotations

import html
from collections.abc import Callable
from pathlib import Path

import anywidget
import ipywidgets
import traitlets
from matplotlib.figure import Figure
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from ros2lab import assignments
from ros2lab.assignments.lesson import load_lesson
from ros2lab.session import LabSession
from ros2lab.topics import TopicLog, matching_qos
from ros2lab.widget_state import ending_with_its_kernel
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import StoredView, check_session, resolved, style, text_figure

STATE_RATE = 10.0  # Hz
GRAPH_RATE = 2.0  # Hz
LONGEST_SHOWN = 30  # letters


class CommandPanel(StoredView, ipywidgets.VBox):
    """Publishes commands (`std_msgs/String`) at a click or on Enter, and shows the state that answers.

    While nobody listens to the commands it is greyed out and says so.

    Args:
        session: where is published and listened; closing it closes the panel.
        topic: where the commands go; None is the course's own.
        state_topic: where the state comes from, `std_msgs/String`; None is the course's own.

    Attributes:
        listeners: how many nodes listen to the commands.
        state: the newest state, None if there is none, or nobody who would tell it.
        sent: the newest command that was sent, None if none was.

    Raises:
        TypeError: if an argument is of another kind.
        ValueError: if a topic's name is none.
        RuntimeError: if the session is closed.
    """

    listeners = traitlets.Int(0)
    state = traitlets.Unicode(None, allow_none=True)
    sent = traitlets.Unicode(None, allow_none=True)

    def __init__(
        self, session: LabSession, *, topic: str | None = None, state_topic: str | None = None
    ) -> None:
        check_session(session, "CommandPanel")
        self._lesson, part = load_lesson(), assignments.load().commanded
        own = part.topic if part else ""
        self.topic = resolved(session, own if topic is None else topic)
        self.state_topic = resolved(session, self._lesson.state_topic if state_topic is None else state_topic)
        self._redraw = redraw_of(session)
        self._build()
        self._state_log: TopicLog | None = None
        self._state_qos: tuple[object, object] | None = None
        self._open_in(session, self.topic)
        self._look_around()
        self._look_for_state()
        self._redraw.add(self._look_around, GRAPH_RATE)
        self._redraw.add(self._look_for_state, STATE_RATE)

    def send_command(self, command: str) -> None:
        """Publish a command.

        Args:
            command: the text.

        Raises:
            RuntimeError: if the session is closed.
        """
        self.session.publish(self.topic, command)
        self.sent = command

    def still(self) -> Figure:
        """Draw what the panel shows with matplotlib."""
        lines = [f"state  {_brief(self.state or 'unknown')}", f"sent   {_brief(self.sent or 'nothing')}"]
        return text_figure(f"Command {self.topic}", lines)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return f"Command panel of {self.topic}. Sent: {self.sent or 'nothing'}. State: {self.state or 'unknown'}."

    def _build(self) -> None:
        self._buttons = [
            ipywidgets.Button(description=word, icon=icon, tooltip=f"Publish {word!r} on {self.topic}")
            for word, icon in self._lesson.icons.items()
        ]
        for button in self._buttons:
            button.on_click(lambda button: self.send_command(button.description))
        self._field = _CommandField(self.send_command, hint=f"Publish any text on {self.topic}")
        self._answer = ipywidgets.HTML()
        self._note = ipywidgets.HTML()
        title = f'<span class="ros2lab-title">Command</span> <code>{html.escape(self.topic)}</code>'
        words = ipywidgets.HBox(self._buttons)
        words.add_class("ros2lab-words")
        rows = [
            ipywidgets.HTML(title),
            words,
            self._field,
            self._answer,
            self._note,
            style(),
        ]
        super().__init__(rows)
        self.add_class("ros2lab-card")
        self.add_class("ros2lab-panel")
        self._show_answer()
        self._show_note()

    def _look_around(self) -> None:
        self.listeners = self.session.subscribers(self.topic)
        node = self.session.node
        qos = matching_qos(node, self.state_topic) if node.count_publishers(self.state_topic) else None
        self._listen_to_state(qos)

    def _listen_to_state(self, qos: QoSProfile | None) -> None:
        """Listen as the publishers offer it, so that none of them warns of us; not at all if there is none."""
        wanted = qos and (qos.durability, qos.reliability)
        if wanted == self._state_qos:
            return
        if self._state_log is not None:
            self._state_log.close()
        log = qos and TopicLog(self.session.node, self.state_topic, String, capacity=1, qos=qos)
        self._state_qos, self._state_log, self.state = wanted, log, None

    def _look_for_state(self) -> None:
        latest = self._state_log.latest if self._state_log else None
        if latest is not None:
            self.state = latest.message.data

    @traitlets.observe("state")
    def _show_answer(self, _: object = None) -> None:
        state = _brief(self.state or "unknown")
        self._answer.value = (
            f'<div role="status">State <code>{html.escape(self.state_topic)}</code>'
            f'<div class="ros2lab-state">{html.escape(state)}</div></div>'
        )

    @traitlets.observe("listeners", "sent")
    def _show_note(self, _: object = None) -> None:
        for control in (*self._buttons, self._field):
            control.disabled = not self.listeners
        kind = "note" if self.listeners else "reason"
        if not self.listeners:
            note = f"Nobody listens on {self.topic}: run the command subscriber first."
        elif self.sent is None:
            note = f"{self.listeners} {'node listens' if self.listeners == 1 else 'nodes listen'}."
        else:
            note = f"Sent “{_brief(self.sent)}”."
        self._note.value = f'<div role="status" class="ros2lab-{kind}">{html.escape(note)}</div>'

    def _stop(self) -> None:
        self._redraw.remove(self._look_for_state)
        self._redraw.remove(self._look_around)
        if self._state_log is not None:
            self._state_log.close()

    def __repr__(self) -> str:
        return f"CommandPanel({self.topic})"


class _CommandField(anywidget.AnyWidget):
    """A line of text, and a button beside it.

    ipywidgets' own sends the text in one message and Enter in another, which overtakes it while a kernel is busy.

    Args:
        send: is called with the text at a click or on Enter, unless there is none.
        hint: what it is for.
    """

    _esm = ending_with_its_kernel(Path(__file__).with_name("command_field.js"))

    hint = traitlets.Unicode().tag(sync=True)
    disabled = traitlets.Bool(False).tag(sync=True)

    def __init__(self, send: Callable[[str], None], *, hint: str) -> None:
        super().__init__(hint=hint)
        self.on_msg(lambda _widget, content, _buffers: send(content["text"]))


def _brief(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"
