"""What a dashboard says and shows, and how several widgets become one picture."""

from __future__ import annotations

from collections.abc import Iterator

import ipywidgets
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from stand_in_session import StandInSession

from ros2lab.widgets import Dashboard, NodeLog, TwistPlot
from ros2lab.widgets.redraw import redraw_of
from ros2lab.widgets.stored_view import PICTURE_DPI
from ros2lab.widgets.view_group import tiled


@pytest.fixture
def session() -> Iterator[StandInSession]:
    session = StandInSession()
    yield session
    session.close()


def note(dashboard: Dashboard) -> str:
    """Return what the line above the widgets says, as HTML."""
    return str(dashboard.children[0].value)


def look(dashboard: Dashboard, *nodes: tuple[str, str]) -> None:
    """Have the dashboard look around once while these nodes run."""
    dashboard.session.node.nodes[:] = nodes
    dashboard._look_around()


def test_the_five_widgets_are_in_the_order_of_their_importance(session: StandInSession) -> None:
    """The keyboard and a narrow page go through them in the order of the page."""
    dashboard = Dashboard(session)
    tiles = dashboard.children[1]
    assert tiles.children == dashboard.views
    places = [view._dom_classes[-1].removeprefix("ros2lab-place-") for view in dashboard.views]
    assert places == ["robot", "panel", "plot", "graph", "log"]
    assert "ros2lab-five" in tiles._dom_classes


def test_other_widgets_are_shown_in_the_order_given(session: StandInSession) -> None:
    log, plot = NodeLog(session), TwistPlot(session, topic="/turtle1/cmd_vel")
    dashboard = Dashboard(session, views=[log, plot])
    assert dashboard.views == (log, plot)
    assert "ros2lab-five" not in dashboard.children[1]._dom_classes
    assert repr(dashboard) == "Dashboard(NodeLog(), TwistPlot(/turtle1/cmd_vel))"


def test_widgets_of_another_session_are_refused(session: StandInSession) -> None:
    elsewhere = StandInSession()
    plot = TwistPlot(elsewhere)
    with pytest.raises(ValueError, match="of its own session"):
        Dashboard(session, views=[plot])
    assert not plot.is_closed
    elsewhere.close()


def test_an_empty_graph_is_said_and_what_starts_is_followed(session: StandInSession) -> None:
    dashboard = Dashboard(session)
    assert "ROS domain 7: nothing runs yet" in note(dashboard)
    look(dashboard, ("talker", "/"))
    assert "ROS domain 7: 1 node runs: /talker." in note(dashboard)
    look(dashboard, ("talker", "/"), ("camera", "/left"))
    assert dashboard.nodes == ("/left/camera", "/talker")
    assert "2 nodes run: /left/camera, /talker." in note(dashboard)
    assert dashboard.description.startswith("ROS domain 7: 2 nodes run")
    look(dashboard)
    assert "nothing runs yet" in note(dashboard)


def test_those_that_only_listen_are_no_nodes_of_a_robot(session: StandInSession) -> None:
    dashboard = Dashboard(session)
    look(dashboard, ("ros2lab", "/"), ("_ros2cli_4711", "/"), ("_ros2cli_daemon_7_0", "/"))
    assert dashboard.nodes == ()


def test_the_names_of_many_nodes_are_cut_short(session: StandInSession) -> None:
    dashboard = Dashboard(session)
    look(dashboard, *((f"node_{number}", "/") for number in range(9)))
    assert "9 nodes run: /node_0, /node_1, /node_2, /node_3, /node_4, /node_5 and 3 more." in note(dashboard)


def test_closing_it_closes_everything_and_no_draw_function_is_left(session: StandInSession) -> None:
    dashboard = Dashboard(session)
    dashboard.close()
    dashboard.close()
    assert all(view.is_closed for view in dashboard.views)
    assert redraw_of(session)._jobs == {}


def test_all_views_are_drawn_by_the_one_thread_of_the_session(session: StandInSession) -> None:
    dashboard = Dashboard(session)
    assert all(view._redraw is redraw_of(session) for view in (dashboard, *dashboard.views))


def test_a_page_that_has_just_made_it_gets_the_state_of_every_part_again(
    session: StandInSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What changes while a page makes the widgets is lost there, such as that a button may be clicked."""
    dashboard = Dashboard(session)
    sent: list[object] = []
    monkeypatch.setattr(ipywidgets.Widget, "send_state", lambda widget, *_, **__: sent.append(widget))
    arrival = dashboard.children[-1]
    arrival._handle_custom_msg({"arrived": True}, [])
    buttons = [part for part in sent if isinstance(part, ipywidgets.Button)]
    assert [button.description for button in buttons] == ["start", "stop", "reset"]
    assert {dashboard, *dashboard.views, dashboard.children[0]} <= set(sent)


def test_made_again_it_replaces_its_predecessor(session: StandInSession) -> None:
    first, second = Dashboard(session), Dashboard(session)
    assert first.is_closed
    assert not second.is_closed
    assert not any(view.is_closed for view in second.views)


def plain(colour: str, width: float, height: float) -> Figure:
    """Return a figure of one colour; sizes in inches."""
    return Figure(figsize=(width, height), facecolor=colour)


def colour_at(figure: Figure, right: float, down: float) -> tuple[int, ...]:
    """Return red, green and blue of a point, given in inches from the upper left corner."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    return tuple(int(part) for part in pixels[int(down * PICTURE_DPI), int(right * PICTURE_DPI), :3])


def test_pictures_go_beside_each_other_and_below_where_they_find_no_room() -> None:
    red, green, blue = (255, 0, 0), (0, 255, 0), (0, 0, 255)
    figures = [plain("#f00", 2, 1), plain("#0f0", 1, 2), plain("#00f", 3, 1)]
    row = tiled(figures)
    assert tuple(row.get_size_inches()) == pytest.approx((6, 2))
    assert [colour_at(row, right, 0.5) for right in (1, 2.5, 4.5)] == [red, green, blue]
    assert colour_at(row, 1, 1.5) == (255, 255, 255)
    wrapped = tiled(figures, width=3.5)
    assert tuple(wrapped.get_size_inches()) == pytest.approx((3, 3))
    assert [colour_at(wrapped, 2.5, down) for down in (0.5, 1.5, 2.5)] == [green, green, blue]
    assert colour_at(wrapped, 0.5, 0.5) == red
    assert tuple(tiled(figures, width=0.5).get_size_inches()) == pytest.approx((3, 4))
