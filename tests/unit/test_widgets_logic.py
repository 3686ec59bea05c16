"""The widgets at a session without ROS: what they compute, send, and leave in the notebook."""

from __future__ import annotations

import base64
import gc
import html
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from geometry_msgs.msg import Twist
from ipywidgets.widgets.widget import _instances
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from stand_in_session import StandInSession
from std_msgs.msg import String
from traitlets import TraitError

from ros2lab.executor import NodeError
from ros2lab.topics import TopicLog
from ros2lab.widgets import (
    CommandPanel,
    Dashboard,
    GraphView,
    MessageForm,
    NodeLog,
    RobotView,
    SideBySide,
    Teleop,
    TopicMonitor,
    TwistPlot,
    graph_view,
    node_log,
    stored_view,
    twist_figure,
    view_group,
)
from ros2lab.widgets.stored_view import WIDGET_VIEW, StoredView, text_figure

MAKERS = {
    "panel": CommandPanel,
    "plot": TwistPlot,
    "log": NodeLog,
    "robot": RobotView,
    "graph": GraphView,
    "monitor": lambda session: TopicMonitor(session, "/cmd_vel", Twist),
    "form": lambda session: MessageForm(session, "/cmd_vel", Twist),
    "teleop": Teleop,
    "side by side": lambda session: SideBySide(CommandPanel(session), TwistPlot(session)),
    "dashboard": Dashboard,
}


@pytest.fixture
def session() -> Iterator[StandInSession]:
    session = StandInSession()
    yield session
    session.close()


@pytest.fixture(params=MAKERS)
def view(request: pytest.FixtureRequest, session: StandInSession) -> StoredView:
    return MAKERS[request.param](session)


class Notebook:
    """What was stored below a cell: the outputs by display id, and how often they were written."""

    def __init__(self) -> None:
        self.outputs: dict[str, dict[str, Any]] = {}
        self.metadata: dict[str, dict[str, Any]] = {}
        self.updates = 0

    def display(self, data: dict[str, Any], *, metadata: Any, raw: bool, display_id: str) -> None:
        assert raw
        self.outputs[display_id] = data
        self.metadata[display_id] = metadata

    def update(self, data: dict[str, Any], *, metadata: Any, raw: bool, display_id: str) -> None:
        assert display_id in self.outputs
        self.updates += 1
        self.display(data, metadata=metadata, raw=raw, display_id=display_id)

    @property
    def output(self) -> dict[str, Any]:
        """The only output."""
        (output,) = self.outputs.values()
        return output


@pytest.fixture
def notebook(monkeypatch: pytest.MonkeyPatch) -> Notebook:
    """Stands for IPython's display; `tests/ros/test_widgets_in_notebook.py` has a real kernel."""
    notebook = Notebook()
    monkeypatch.setattr(stored_view, "display", notebook.display)
    monkeypatch.setattr(stored_view, "update_display", notebook.update)
    for module in (stored_view, view_group):  # small pictures are drawn in half the time
        monkeypatch.setattr(module, "PICTURE_DPI", 36)
    return notebook


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw no picture, for a test that asks when one is stored and not what it shows."""
    monkeypatch.setattr(stored_view, "_png", lambda _: "a picture")
    monkeypatch.setattr(view_group, "_pixels", lambda _: np.zeros((1, 1, 4), np.uint8))


def twist(linear: float, angular: float) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


# What is left in the notebook


def test_a_shown_widget_stores_its_view_a_picture_and_a_text(view: StoredView, notebook: Notebook) -> None:
    view._ipython_display_()
    assert set(notebook.output) == {"text/plain", "image/png", WIDGET_VIEW}
    assert notebook.output[WIDGET_VIEW]["model_id"] == view.model_id
    assert base64.b64decode(notebook.output["image/png"]).startswith(b"\x89PNG")
    (metadata,) = notebook.metadata.values()
    assert metadata["image/png"]["alt"] == view.description
    assert 0 < metadata["image/png"]["width"] < 1200


@pytest.mark.usefixtures("undrawn")
def test_a_shown_widget_that_is_closed_leaves_its_picture_alone(view: StoredView, notebook: Notebook) -> None:
    view._ipython_display_()
    view.close()
    view.close()
    assert set(notebook.output) == {"text/plain", "image/png"}
    assert notebook.updates == 1


@pytest.mark.usefixtures("undrawn")
def test_a_closed_widget_is_shown_as_its_picture(view: StoredView, notebook: Notebook) -> None:
    view.close()
    view._ipython_display_()
    assert set(notebook.output) == {"text/plain", "image/png"}


@pytest.mark.usefixtures("undrawn")
def test_the_stored_text_does_not_depend_on_what_was_seen(
    session: StandInSession, notebook: Notebook
) -> None:
    """Nbval compares it with that of another run."""
    views = [
        TwistPlot(session),
        CommandPanel(session),
        NodeLog(session),
        GraphView(session),
        TopicMonitor(session, "/cmd_vel"),
        MessageForm(session, "/pose", "geometry_msgs/msg/Pose"),
        Teleop(session),
    ]
    texts = [repr(view) for view in views]
    session.node.receive("/cmd_vel", twist(0.5, 0.2))
    views[1].send_command("start")
    session.node.receive("/rosout", Log(level=20, name="n", msg="m"))
    for view in views:
        view._ipython_display_()
    session.close()
    assert [output["text/plain"] for output in notebook.outputs.values()] == texts
    assert texts == [
        "TwistPlot(/cmd_vel)",
        "CommandPanel(/robot/command)",
        "NodeLog()",
        "GraphView()",
        "TopicMonitor(/cmd_vel)",
        "MessageForm(/pose)",
        "Teleop(/cmd_vel)",
    ]


@pytest.mark.usefixtures("notebook")
def test_what_was_never_shown_stores_nothing(view: StoredView, notebook: Notebook) -> None:
    view.close()
    assert notebook.outputs == {}


def test_pausing_a_plot_brings_the_picture_up_to_date(session: StandInSession, notebook: Notebook) -> None:
    plot = TwistPlot(session)
    plot._ipython_display_()
    before = notebook.output["image/png"]
    session.node.receive("/cmd_vel", twist(0.5, 0.2))
    plot.pause()
    assert notebook.output["image/png"] != before
    assert WIDGET_VIEW in notebook.output
    plot.resume()
    assert notebook.updates == 1


@pytest.mark.parametrize(
    "group",
    [
        SideBySide,
        pytest.param(
            lambda *views: Dashboard(views[0].session, views=views),
            id="dashboard",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_pausing_a_plot_beside_a_panel_brings_the_picture_of_both_up_to_date(
    session: StandInSession, notebook: Notebook, group: Callable[..., StoredView]
) -> None:
    plot = TwistPlot(session)
    group(CommandPanel(session), plot)._ipython_display_()
    before = notebook.output["image/png"]
    session.node.receive("/cmd_vel", twist(0.5, 0.2))
    plot.paused = True
    assert notebook.output["image/png"] != before
    assert WIDGET_VIEW in notebook.output


@pytest.mark.usefixtures("undrawn")
def test_at_the_kernels_exit_nothing_is_sent(
    view: StoredView, notebook: Notebook, monkeypatch: pytest.MonkeyPatch
) -> None:
    view._ipython_display_()
    monkeypatch.setattr(stored_view._exit_begun, "is_set", lambda: True)
    view.close()
    assert notebook.updates == 0
    monkeypatch.undo()
    view.close()


def test_a_picture_is_saved_in_the_format_of_its_ending(session: StandInSession, tmp_path: Path) -> None:
    view = CommandPanel(session)
    path = view.save(tmp_path / "picture.png")
    assert matplotlib.image.imread(path).shape[2] == 4
    assert b"<svg" in view.save(tmp_path / "picture.svg").read_bytes()


def test_text_is_drawn_as_it_is_and_what_the_font_lacks_as_a_box() -> None:
    figure = text_figure("title $x_1$", ["日本 and more"])
    figure.canvas.draw()
    assert [text.get_text() for text in figure.texts] == ["title $x_1$", "□□ and more"]


# Coming and going


def test_a_session_closes_its_widgets(view: StoredView, session: StandInSession) -> None:
    session.close()
    assert view.is_closed
    assert not any(session.node.callbacks.values())


def test_a_closed_widget_leaves_nothing_behind(session: StandInSession) -> None:
    gc.collect()
    before = set(_instances)
    for make in MAKERS.values():
        with make(session):
            pass
    assert session.node.own_publishers == []
    assert set(_instances) == before
    assert not any(session.node.callbacks.values())


def test_a_second_widget_of_the_same_topic_closes_the_first(session: StandInSession) -> None:
    for make in MAKERS.values():
        first, second = make(session), make(session)
        assert first.is_closed
        assert not second.is_closed


def test_widgets_of_other_topics_and_sessions_stay(session: StandInSession) -> None:
    plot, other = TwistPlot(session), TwistPlot(session, topic="/other")
    elsewhere = StandInSession()
    TwistPlot(elsewhere)
    assert not plot.is_closed
    assert not other.is_closed
    with pytest.raises(ValueError, match="of one session"):
        SideBySide(plot, TwistPlot(elsewhere, topic="/third"))
    elsewhere.close()


def test_a_refused_widget_leaves_its_predecessor_alone(session: StandInSession) -> None:
    plot = TwistPlot(session)
    with pytest.raises(ValueError, match="window"):
        TwistPlot(session, window=0)
    assert not plot.is_closed


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (
            lambda _: TwistPlot(3),
            TypeError,
            "TwistPlot takes a LabSession as its first argument, or what read_recording() returns, not 3.",
        ),
        (lambda _: CommandPanel(None), TypeError, "CommandPanel takes a LabSession"),
        (lambda _: NodeLog("session"), TypeError, "NodeLog takes a LabSession"),
        (lambda s: TwistPlot(s, topic=3), TypeError, "A topic is a text"),
        (lambda s: TwistPlot(s, topic="/cmd vel"), ValueError, "'/cmd vel' is no name of a topic"),
        (lambda s: CommandPanel(s, topic=""), ValueError, "'' is no name of a topic"),
        (lambda s: CommandPanel(s, state_topic="/1"), ValueError, "'/1' is no name of a topic"),
        (lambda s: TwistPlot(s, window="10"), TypeError, "The window is a number in s, not '10'."),
        (lambda s: TwistPlot(s, window=0.5), ValueError, "The window must be from 1 to 120 s, not 0.5."),
        (lambda s: TwistPlot(s, window=float("nan")), ValueError, "The window must be from 1 to 120 s"),
        (lambda s: TwistPlot(s, rate=0), ValueError, "The rate must be from 0.1 to 50 Hz, not 0."),
        (lambda s: TwistPlot(s, rate=True), TypeError, "The rate is a number in Hz, not True."),
        (
            lambda s: NodeLog(s, level="LOUD"),
            ValueError,
            "one of DEBUG, INFO, WARN, ERROR, FATAL, not 'LOUD'.",
        ),
        (lambda s: NodeLog(s, capacity=0), ValueError, "at least 1 line, not 0."),
        (lambda s: NodeLog(s, capacity=1.5), TypeError, "whole number of lines, not 1.5."),
        (lambda _: TopicMonitor(3, "/x"), TypeError, "TopicMonitor takes a LabSession"),
        (lambda s: TopicMonitor(s, "/1"), ValueError, "'/1' is no name of a topic"),
        (
            lambda s: TopicMonitor(s, "/x", 3),
            TypeError,
            "The message type is a message class, or a name such",
        ),
        (
            lambda s: TopicMonitor(s, "/x", int),
            TypeError,
            "The message type is a message class, or a name such",
        ),
        (
            lambda s: TopicMonitor(s, "/x", "no_msgs/msg/No"),
            ValueError,
            "'no_msgs/msg/No' cannot be imported",
        ),
        (lambda _: MessageForm(None, "/x", Twist), TypeError, "MessageForm takes a LabSession"),
        (
            lambda s: MessageForm(s, "/x", None),
            TypeError,
            "The message type is a message class, or a name such",
        ),
        (lambda s: MessageForm(s, "", Twist), ValueError, "'' is no name of a topic"),
        (lambda _: Teleop("session"), TypeError, "Teleop takes a LabSession"),
        (
            lambda s: Teleop(s, linear_speed=-1),
            ValueError,
            "The linear speed must be from 0 to 10 m/s, not -1.",
        ),
        (
            lambda s: Teleop(s, angular_speed="1"),
            TypeError,
            "The angular speed is a number in rad/s, not '1'.",
        ),
        (lambda _: SideBySide(), ValueError, "at least one widget"),
        (lambda _: SideBySide("plot"), TypeError, "SideBySide takes widgets of the lab, not 'plot'."),
        (lambda _: Dashboard("session"), TypeError, "Dashboard takes a LabSession"),
        (lambda s: Dashboard(s, views=[]), ValueError, "Dashboard takes at least one widget"),
        (
            lambda s: Dashboard(s, views=["plot"]),
            TypeError,
            "Dashboard takes widgets of the lab, not 'plot'.",
        ),
    ],
)
def test_bad_arguments_are_refused_with_one_sentence(
    session: StandInSession, make: Any, error: type[Exception], says: str
) -> None:
    with pytest.raises(error) as caught:
        make(session)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_closed_sessions_and_widgets_are_refused(session: StandInSession) -> None:
    plot = TwistPlot(session)
    plot.close()
    with pytest.raises(ValueError, match="closed; make a new one"):
        SideBySide(plot)
    session.close()
    for make in MAKERS.values():
        with pytest.raises(RuntimeError, match="closed"):
            make(session)


# The panel


def controls(panel: CommandPanel) -> list[Any]:
    return [*panel._buttons, panel._field]


def test_the_panel_is_greyed_out_with_the_reason_until_somebody_listens(session: StandInSession) -> None:
    panel = CommandPanel(session)
    assert all(control.disabled for control in controls(panel))
    assert "Nobody listens on /robot/command: run the command subscriber first." in panel._note.value
    session.listeners = 1
    panel._look_around()
    assert not any(control.disabled for control in controls(panel))
    assert "Nobody" not in panel._note.value
    session.listeners = 0
    panel._look_around()
    assert all(control.disabled for control in controls(panel))


def test_each_button_publishes_its_word(session: StandInSession) -> None:
    panel = CommandPanel(session, topic="/other")
    for button in panel._buttons:
        button.click()
    assert session.published == [("/other", "start"), ("/other", "stop"), ("/other", "reset")]
    assert panel.sent == "reset"


def test_what_comes_from_the_field_is_published(session: StandInSession) -> None:
    panel = CommandPanel(session)
    panel._field._handle_custom_msg({"text": "dance"}, [])
    assert session.published == [("/robot/command", "dance")]
    assert panel.sent == "dance"


def test_the_panel_shows_the_state_and_forgets_it_when_nobody_tells_it(session: StandInSession) -> None:
    panel = CommandPanel(session)
    assert "unknown" in panel._answer.value
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    session.node.publishers["/robot/state"] = [kept]
    panel._look_around()
    session.node.receive("/robot/state", String(data="running"))
    panel._look_for_state()
    assert panel.state == "running"
    assert ">running<" in panel._answer.value
    session.node.publishers.clear()
    panel._look_around()
    assert panel.state is None
    assert "unknown" in panel._answer.value


def test_what_others_wrote_is_escaped_and_shortened(session: StandInSession) -> None:
    panel = CommandPanel(session)
    panel.state = "<script>alert(1)</script>" + 100 * "x"
    panel.listeners = 1
    panel.sent = "<b>"
    assert "<script>" not in panel._answer.value
    assert "&lt;script&gt;" in panel._answer.value
    assert "xx…" in panel._answer.value
    assert "&lt;b&gt;" in panel._note.value


def test_the_panel_sends_nothing_to_the_browser_while_nothing_changes(session: StandInSession) -> None:
    session.listeners = 1
    panel = CommandPanel(session)
    changes: list[Any] = []
    for control in (*controls(panel), panel._answer, panel._note):
        control.observe(changes.append)
    panel._look_around()
    panel._look_for_state()
    assert changes == []


# The plot


class Wire:
    """What a plot sends to the browser."""

    def __init__(self, plot: TwistPlot, monkeypatch: pytest.MonkeyPatch) -> None:
        plot._redraw.remove(plot._send_new)  # the test says when it is a tick's turn
        self.sent: list[tuple[dict[str, Any], np.ndarray]] = []
        monkeypatch.setattr(plot, "send", self._send)

    def _send(self, content: dict[str, Any], buffers: list[bytes]) -> None:
        self.sent.append((content, np.frombuffer(buffers[0], dtype=np.float64).reshape(-1, 3)))


def test_each_tick_sends_only_what_is_new(session: StandInSession, monkeypatch: pytest.MonkeyPatch) -> None:
    plot = TwistPlot(session)
    wire = Wire(plot, monkeypatch)
    plot._send_new()
    assert wire.sent == []
    session.node.receive("/cmd_vel", twist(0.5, 0.2))
    session.node.receive("/cmd_vel", twist(0.0, -0.1))
    plot._send_new()
    plot._send_new()
    session.node.receive("/cmd_vel", twist(0.7, 0.0))
    plot._send_new()
    values = [samples[:, 1:].tolist() for _, samples in wire.sent]
    assert values == [[[0.5, 0.2], [0.0, -0.1]], [[0.7, 0.0]]]
    for content, samples in wire.sent:
        assert not content["is_whole"]
        assert 0 <= samples[0, 0] <= content["now"] < 60


def test_a_paused_plot_sends_nothing_and_then_everything(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    plot = TwistPlot(session)
    wire = Wire(plot, monkeypatch)
    plot.pause()
    for linear in (0.1, 0.2, 0.3):
        session.node.receive("/cmd_vel", twist(linear, 0.0))
        plot._send_new()
    assert wire.sent == []
    plot.resume()
    plot._send_new()
    assert wire.sent[0][1][:, 1].tolist() == [0.1, 0.2, 0.3]


def test_a_browser_that_comes_back_gets_the_whole_window(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    plot = TwistPlot(session)
    wire = Wire(plot, monkeypatch)
    now = time.monotonic()
    for age, linear in ((500.0, 0.1), (100.0, 0.2), (1.0, 0.3)):
        monkeypatch.setattr(time, "monotonic", lambda age=age: now - age)
        session.node.receive("/cmd_vel", twist(linear, 0.0))
    monkeypatch.setattr(time, "monotonic", lambda: now)
    plot._handle_custom_msg({"ask": "samples"}, [])
    plot._send_new()
    ((content, samples),) = wire.sent
    assert content["is_whole"]
    assert samples[:, 1].tolist() == [0.2, 0.3]


def test_the_window_is_clamped_and_must_be_a_number(session: StandInSession) -> None:
    plot = TwistPlot(session, window=20)
    assert plot.window == 20.0
    for wanted, got in ((1000, 120.0), (0, 1.0), (-5, 1.0), (7.5, 7.5)):
        plot.window = wanted
        assert plot.window == got
    with pytest.raises(TraitError):
        plot.window = "long"
    with pytest.raises(TraitError):
        plot.topic = "/other"


def test_the_plot_tells_the_current_values_in_words(session: StandInSession) -> None:
    plot = TwistPlot(session)
    assert "no message yet" in plot.description
    session.node.receive("/cmd_vel", twist(0.5, -0.2))
    assert "linear x 0.50 m/s, angular z -0.20 rad/s" in plot.description


def test_the_browsers_part_comes_with_the_package_and_from_nowhere_else() -> None:
    source = Path(stored_view.__file__).with_name("twist_plot.js").read_text()
    assert "import " not in source
    assert "http" not in source


# The still picture of the plot


def test_the_picture_names_both_values_with_their_units() -> None:
    figure = twist_figure([0.0, 1.0], [0.0, 0.5], [0.0, 0.2])
    assert [axes.get_ylabel() for axes in figure.axes] == ["linear x (m/s)", "angular z (rad/s)"]
    assert figure.axes[-1].get_xlabel() == "time (s)"


def test_the_picture_tells_the_lines_apart_by_colour_and_by_dashes() -> None:
    first, second = (axes.lines[0] for axes in twist_figure([0.0], [0.0], [0.0]).axes)
    assert (first.get_color(), second.get_color()) == ("#0072B2", "#D55E00")
    assert first.get_linestyle() != second.get_linestyle()


def test_the_picture_shows_steps_with_the_data() -> None:
    figure = twist_figure(np.array([0.0, 0.1, 0.2]), np.array([0.0, 0.5, 0.5]), np.array([0.0, 0.2, 0.1]))
    line = figure.axes[0].lines[0]
    assert line.get_drawstyle() == "steps-post"
    assert line.get_xydata().tolist() == [[0.0, 0.0], [0.1, 0.5], [0.2, 0.5]]
    assert figure.axes[1].lines[0].get_ydata().tolist() == [0.0, 0.2, 0.1]


def test_the_picture_is_broken_where_nothing_came() -> None:
    times = [0.0, 0.1, 0.2, 5.0, 5.1]
    line = twist_figure(times, [0.5] * 5, [0.2] * 5).axes[0].lines[0]
    assert np.isnan(line.get_ydata()).tolist() == [False, False, False, True, False, False]
    assert line.get_xdata().tolist() == [0.0, 0.1, 0.2, 0.2, 5.0, 5.1]


def test_slow_topics_are_not_broken() -> None:
    line = twist_figure([0.0, 2.0, 4.0, 6.0], [0.5] * 4, [0.2] * 4).axes[0].lines[0]
    assert not np.isnan(line.get_ydata()).any()


def test_a_picture_of_nothing_says_so() -> None:
    figure = twist_figure([], [], [], topic="/other")
    figure.canvas.draw()
    assert figure.axes[0].get_title() == "/other: no message yet"


@pytest.mark.parametrize("arrays", [([0.0], [0.0, 1.0], [0.0]), ([[0.0]], [[0.0]], [[0.0]])])
def test_arrays_of_different_shapes_are_refused(arrays: tuple[Any, Any, Any]) -> None:
    with pytest.raises(ValueError, match="three arrays of one length"):
        twist_figure(*arrays)


# The log


def say(
    session: StandInSession, message: str, *, level: int = 20, at: float = 0.0, node: str = "talker"
) -> None:
    """Have a node log a line, `at` s after the start."""
    written = int((1_000_000_000 + at) * 1e9)
    session.node.receive("/rosout", Log(level=level, name=node, msg=message), written)


def drawn(log: NodeLog) -> str:
    log._draw()
    return str(log._table.value)


def test_a_line_has_time_level_node_and_message(session: StandInSession) -> None:
    log = NodeLog(session)
    say(session, "hello")
    say(session, "careful", level=30, at=1.25, node="listener")
    table = drawn(log)
    assert "<td>0.000</td><td>INFO</td><td>talker</td><td>hello</td>" in table
    assert "<td>1.250</td><td>WARN</td><td>listener</td><td>careful</td>" in table
    assert table.index("hello") < table.index("careful")


def test_lines_are_in_the_order_in_which_they_were_written(session: StandInSession) -> None:
    log = NodeLog(session)
    say(session, "later", at=2.0)
    say(session, "earlier", at=1.0)
    assert [line.message for line in log.lines] == ["earlier", "later"]


def test_only_lines_of_the_level_and_above_are_shown(session: StandInSession) -> None:
    log = NodeLog(session, level="WARN")
    for level, word in ((10, "fine"), (20, "told"), (30, "warned"), (40, "failed"), (50, "dead")):
        say(session, word, level=level)
    assert [line.message for line in log.lines] == ["warned", "failed", "dead"]
    assert [line.level_name for line in log.lines] == ["WARN", "ERROR", "FATAL"]
    log.level = "DEBUG"
    assert "fine" in drawn(log)
    log.level = "FATAL"
    assert "failed" not in drawn(log)
    with pytest.raises(TraitError):
        log.level = "LOUD"


def test_the_log_is_bounded(session: StandInSession) -> None:
    log = NodeLog(session, capacity=3)
    for i in range(10):
        say(session, f"line {i}", at=i)
    assert [line.message for line in log.lines] == ["line 7", "line 8", "line 9"]
    assert "<td>7.000</td>" in drawn(log)
    say(session, 10_000 * "x")
    assert max(len(line.message) for line in log.lines) == 2000


def test_what_nodes_wrote_is_escaped(session: StandInSession) -> None:
    log = NodeLog(session)
    say(session, "<script>alert('x')</script>", node="<i>")
    table = drawn(log)
    assert "<script>" not in table
    assert "<i>" not in table
    assert html.escape("<script>alert('x')</script>") in table


def test_a_callbacks_exception_is_a_line_with_its_traceback_once(session: StandInSession) -> None:
    log = NodeLog(session)
    for moment in (1.0, 2.0):
        session.raised.append(NodeError("driver", ValueError("too <fast>"), "File 'x', line 3\n", moment))
    table = drawn(log)
    assert table.count("A callback of driver raised ValueError: too &lt;fast&gt;") == 1
    assert "<td>ERROR</td><td>driver</td>" in table
    assert "<pre>File &#x27;x&#x27;, line 3" in table


def test_a_widget_that_cannot_draw_is_a_line_too(session: StandInSession) -> None:
    log = NodeLog(session)

    def broken() -> None:
        raise ValueError("no ink")

    log._redraw._call(broken)
    assert "no ink" in drawn(log)


def test_nothing_is_drawn_while_nothing_changes(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = NodeLog(session)
    log._redraw.remove(log._draw)  # the test says when it is a tick's turn
    drawings: list[list[str]] = []
    monkeypatch.setattr(
        node_log, "_as_table", lambda lines, _: str(drawings.append([line.message for line in lines]))
    )
    say(session, "hello")
    log._draw()
    log._draw()
    say(session, "again", at=1.0)
    log._draw()
    log._draw()
    assert drawings == [["hello"], ["hello", "again"]]


def test_an_empty_log_says_so(session: StandInSession) -> None:
    log = NodeLog(session)
    assert "Nothing of this level was logged yet." in log._table.value
    assert [text.get_text() for text in log.still().texts][1] == "Nothing of this level was logged yet."


# The graph


def names(view: GraphView) -> list[str]:
    return [box["title"] for box in view.scene["boxes"]]


def test_the_graph_is_sent_when_it_has_changed_and_not_otherwise(session: StandInSession) -> None:
    view = GraphView(session)
    sent: list[Any] = []
    view.observe(sent.append, "scene")
    for _ in range(3):
        view._look()
    assert sent == []
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    view._look()
    view._look()
    assert len(sent) == 1
    assert names(view) == ["/ros2lab", "/talker", "/news"]
    del session.node.publishers["/news"]
    view._look()
    assert names(view) == ["/ros2lab"]


def test_what_every_node_has_comes_with_a_click(session: StandInSession) -> None:
    session.node.publishers["/rosout"] = [QoSProfile(depth=1)]
    view = GraphView(session)
    assert names(view) == ["/ros2lab"]
    view.everything = True
    assert names(view) == ["/ros2lab", "/talker", "/rosout"]
    view.everything = False
    assert names(view) == ["/ros2lab"]


def test_a_rate_is_measured_only_while_it_is_asked_for(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    view = GraphView(session)
    before = view.scene
    view._on_message(view, {"measure": ["/news"]}, [])
    for n in range(6):
        session.node.receive("/news", String(), published=n * 100_000_000)
    view._look()
    assert view.rates == {"/news": "10.0 Hz"}
    assert view.scene == before, "the own subscription is not drawn"
    view._on_message(view, {"measure": []}, [])
    assert view.rates == {}
    assert session.node.callbacks["/news"] == []


def test_a_browser_that_has_gone_does_not_leave_a_subscription(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    view = GraphView(session)
    view._on_message(view, {"measure": ["/news"]}, [])
    view._look()
    assert len(session.node.callbacks["/news"]) == 1
    monkeypatch.setattr(graph_view, "ASKED_FOR", -1.0)
    view._on_message(view, {"measure": ["/news"]}, [])
    assert session.node.callbacks["/news"] == []


def test_another_subscription_of_the_session_stays_in_the_graph(session: StandInSession) -> None:
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    TopicLog(session.node, "/news", String, qos=qos)
    view = GraphView(session)
    before = view.scene
    assert "/news > /ros2lab" in [arrow["id"] for arrow in before["arrows"]]
    view._on_message(view, {"measure": ["/news"]}, [])
    view._look()
    assert view.scene == before


@pytest.mark.parametrize(
    "content", [None, {}, {"measure": "/news"}, {"measure": ["/unknown", 3]}, {"measure": [["/news"]]}]
)
def test_what_nobody_can_measure_is_ignored(session: StandInSession, content: Any) -> None:
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    view = GraphView(session)
    view._on_message(view, content, [])
    assert view.rates == {}


def test_a_type_that_cannot_be_imported_is_told_in_place_of_a_rate(session: StandInSession) -> None:
    words = graph_view._Measurement(session.node, "/x", "no_such_msgs/msg/Thing", 0.0).words(0.0)
    assert words.startswith("rate not measured: The message type 'no_such_msgs/msg/Thing'")


def test_a_graph_view_takes_yes_or_no(session: StandInSession) -> None:
    with pytest.raises(TypeError, match="services is True or False, not 'yes'"):
        GraphView(session, services="yes")  # type: ignore[arg-type]


def test_the_last_picture_of_a_graph_is_that_of_its_end(session: StandInSession) -> None:
    view = GraphView(session)
    session.node.publishers["/news"] = [QoSProfile(depth=1)]
    view.close()
    assert "/talker -> /news" in view.description
