"""What a widget does while nobody sees it, and when somebody does again."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Log
from rclpy.qos import QoSProfile
from stand_in_session import StandInSession
from std_msgs.msg import String

from deadlines import DEADLINE
from ros2lab.widgets import GraphView, NodeLog, RobotView, TopicMonitor, TwistPlot, watched
from ros2lab.widgets.redraw import Redraw
from ros2lab.widgets.stored_view import StoredView
from ros2lab.widgets.watched import MOST_PAGES, Lookout, Watched, script


@pytest.fixture
def session() -> Iterator[StandInSession]:
    session = StandInSession()
    yield session
    session.close()


def tell(view: Watched, *, seen: bool, page: str = "a page") -> None:
    """Say what a page says."""
    view._handle_custom_msg({"seen": seen, "page": page}, [])


def test_a_widget_is_watched_until_a_page_says_that_it_is_not() -> None:
    """A page that says nothing, of an older lab or in a test, is served as ever."""
    view = Lookout()
    assert view.is_watched()
    tell(view, seen=False)
    assert not view.is_watched()
    tell(view, seen=True)
    assert view.is_watched()
    assert view.watchers == ["a page"], "so that the page knows that it was understood"


def test_a_widget_is_watched_while_one_of_its_pages_shows_it() -> None:
    view = Lookout()
    for page in ("one", "other", "other"):
        tell(view, seen=True, page=page)
    tell(view, seen=False, page="one")
    assert view.is_watched()
    tell(view, seen=False, page="other")
    assert not view.is_watched()


def test_while_a_cell_runs_every_widget_is_served(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that shows it again could not say so before the cell has ended."""
    hooks: dict[str, Callable[[], None]] = {}
    events = SimpleNamespace(register=hooks.__setitem__)
    monkeypatch.setattr(watched, "get_ipython", lambda: SimpleNamespace(events=events))
    watched._cell.cache_clear()
    view = Lookout()
    watched._cell.cache_clear()
    tell(view, seen=False)
    assert view.is_watched(), "the cell that made it runs"
    hooks["post_execute"]()
    assert not view.is_watched()
    hooks["pre_execute"]()
    assert view.is_watched()


def test_pages_that_never_say_good_bye_are_forgotten() -> None:
    view = Lookout()
    for number in range(3 * MOST_PAGES):
        tell(view, seen=True, page=str(number))
    assert view.watchers is not None
    assert len(view.watchers) == MOST_PAGES


@pytest.mark.parametrize("content", [{}, {"seen": True}, {"seen": True, "page": 7}, "seen", None])
def test_what_is_no_word_of_a_page_is_ignored(content: Any) -> None:
    view = Lookout()
    view._handle_custom_msg(content, [])
    assert view.watchers is None


@pytest.mark.parametrize("name", ["twist_plot", "robot_view", "graph_view", "topic_monitor", "lookout"])
def test_each_module_is_whole_and_asks_nothing_of_the_internet(name: str) -> None:
    module = script(name)
    assert "function onScreen(" in module
    assert module.count("export default") == 1
    assert "import " not in module
    assert "http" not in module.replace("http://www.w3.org/2000/svg", "")  # a name, not an address


def test_a_turn_is_left_out_while_its_condition_is_false() -> None:
    redraw, is_wanted = Redraw(), threading.Event()
    drawn, others = threading.Event(), threading.Event()
    try:
        redraw.add(drawn.set, 100, while_=is_wanted.is_set)
        redraw.add(others.set, 20)
        for _ in range(2):
            others.clear()
            assert others.wait(DEADLINE)
        assert not drawn.is_set()
        is_wanted.set()
        assert drawn.wait(DEADLINE)
    finally:
        redraw.close()


def test_a_hurried_draw_does_not_wait_for_its_turn() -> None:
    redraw, drawn = Redraw(), threading.Event()
    try:
        redraw.add(drawn.set, 1e-6)
        redraw.hurry(drawn.set)  # another object of the same method
        assert drawn.wait(DEADLINE)
        redraw.hurry(print)  # unknown
    finally:
        redraw.close()


def test_hurrying_again_and_again_draws_at_twice_the_rate_at_most() -> None:
    redraw, counted = Redraw(), []
    try:
        redraw.add(lambda: None, 1e-6)
        redraw.add(draw := lambda: counted.append(1), 1e-6)
        redraw.hurry(draw)
        other = threading.Event()
        redraw.add(other.set, 100)
        for _ in range(20):
            redraw.hurry(draw)
            other.clear()
            assert other.wait(DEADLINE)
        assert len(counted) == 1, "the next one is due in half a million seconds"
    finally:
        redraw.close()


def sees(view: StoredView) -> Watched:
    """Return the part of a widget that knows whether somebody sees it."""
    return view._lookout if isinstance(view, NodeLog) else view  # type: ignore[return-value]


def velocity(linear: float) -> Twist:
    message = Twist()
    message.linear.x = linear
    return message


def _publish_news(session: StandInSession) -> None:
    session.node.publishers["/news"] = [QoSProfile(depth=1)]


CASES: dict[str, tuple[Callable[[Any], Any], Callable[[Any], None]]] = {
    "plot": (TwistPlot, lambda session: session.node.receive("/cmd_vel", velocity(0.5))),
    "robot": (RobotView, lambda session: session.node.receive("/cmd_vel", velocity(0.5))),
    "graph": (GraphView, _publish_news),
    "log": (NodeLog, lambda session: session.node.receive("/rosout", Log(level=20, name="a", msg="word"))),
    "monitor": (
        lambda session: TopicMonitor(session, "/words", String),
        lambda session: session.node.receive("/words", String(data="word")),
    ),
}


class Sent:
    """All that a widget and its parts send to the browser, until it is told to begin anew."""

    def __init__(self, view: StoredView, monkeypatch: pytest.MonkeyPatch) -> None:
        self.has_come = threading.Event()
        parts = (view, view._table) if isinstance(view, NodeLog) else (view,)
        for part in parts:
            monkeypatch.setattr(part, "_send", self._note)

    def _note(self, message: dict[str, Any], buffers: Any = None) -> None:
        if set(message.get("state", {})) != {"watchers"}:
            self.has_come.set()


@pytest.fixture
def quick_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let each part of a widget have its turn twenty times as often, so that a few turns of the slowest are no wait."""
    add = Redraw.add
    monkeypatch.setattr(
        Redraw, "add", lambda redraw, draw, rate, **options: add(redraw, draw, 20 * rate, **options)
    )


@pytest.mark.usefixtures("quick_turns")
@pytest.mark.parametrize("name", CASES)
def test_nothing_is_sent_of_what_nobody_sees_and_all_of_it_once_somebody_does(
    name: str, session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    make, happen = CASES[name]
    view = make(session)
    tell(sees(view), seen=False)
    sent = Sent(view, monkeypatch)
    turns = threading.Semaphore(0)
    view._redraw.add(turns.release, 2.0)
    turns.acquire(timeout=DEADLINE)  # a turn that began before has ended
    sent.has_come.clear()
    happen(session)
    for _ in range(3):  # of the slowest, so that each part had its turn
        assert turns.acquire(timeout=DEADLINE)
    assert not sent.has_come.is_set()
    tell(sees(view), seen=True)
    assert sent.has_come.wait(DEADLINE)


@pytest.mark.usefixtures("quick_turns")
def test_what_nobody_sees_is_not_looked_for(session: StandInSession) -> None:
    """Nor is a rate measured that a page asked for before it was closed."""
    _publish_news(session)
    view = GraphView(session)
    view._handle_custom_msg({"measure": ["/news"]}, [])
    assert len(session.node.callbacks["/news"]) == 1
    tell(view, seen=True)
    tell(view, seen=False)
    assert session.node.callbacks["/news"] == []
    looked = threading.Event()
    names = session.node.get_topic_names_and_types
    session.node.get_topic_names_and_types = lambda: (looked.set(), names())[1]  # type: ignore[method-assign]
    turns = threading.Semaphore(0)
    view._redraw.add(turns.release, 2.0)
    assert turns.acquire(timeout=DEADLINE)
    looked.clear()
    for _ in range(2):
        assert turns.acquire(timeout=DEADLINE)
    assert not looked.is_set()
    assert view.still().axes, "its picture is drawn of what there is"
    assert looked.is_set()


def test_a_robot_that_nobody_sees_drives_on(session: StandInSession) -> None:
    view = RobotView(session)
    tell(view, seen=False)
    session.node.receive("/cmd_vel", velocity(5.0))
    moved, check = threading.Event(), lambda: view.pose.x > 0.5 and moved.set()
    view._redraw.add(check, 50)
    assert moved.wait(DEADLINE)


def test_the_lines_of_a_log_that_nobody_sees_are_all_there(session: StandInSession) -> None:
    log = NodeLog(session)
    tell(sees(log), seen=False)
    session.node.receive("/rosout", Log(level=20, name="a", msg="word"))
    assert [line.message for line in log.lines] == ["word"]
