"""The views of a recording, without a session: what they tell the browser, and leave in the notebook."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from geometry_msgs.msg import Twist
from rclpy.serialization import serialize_message
from stand_in_session import StandInSession
from std_msgs.msg import String

from portable_ros2.bags.definitions import definition_text
from portable_ros2.bags.mcap_file import RecordingWriter
from ros2lab.motion import Command, DrivenPath, Pose
from ros2lab.recording import Recording, read_recording
from ros2lab.topics import type_name
from ros2lab.widgets import RobotView, SideBySide, TwistPlot, robot_view, stored_view, twist_plot
from ros2lab.widgets.stored_view import WIDGET_VIEW, StoredView

BEGAN = 1_700_000_000_000_000_000  # ns since 1970
VIEWS = pytest.mark.parametrize("view_class", [RobotView, TwistPlot])


def twist(linear: float, angular: float) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = linear, angular
    return message


# 2 s on a circle of 1 m, then a straight line of 0.5 m; nothing more for 2 s.
DRIVE = [(0.1 * n, twist(0.5, 0.5)) for n in range(20)] + [(2.0, twist(0.5, 0.0))]


def write_recording(path: Path, topics: dict[str, tuple[type, list[tuple[float, Any]]]]) -> Path:
    """Write messages at times in s since the recording's begin."""
    with path.open("wb") as stream:
        writer = RecordingWriter(stream)
        for topic, (kind, messages) in topics.items():
            name = type_name(kind)
            channel = writer.add_topic(topic, name, definition_text(name))
            for time, message in messages:
                now = BEGAN + round(1e9 * time)
                writer.add(channel, serialize_message(message), received=now, published=now)
        writer.finish()
    return path


@pytest.fixture
def recording(tmp_path: Path) -> Recording:
    said = [(0.0, String(data="idle")), (4.0, String(data="idle"))]
    topics = {"/cmd_vel": (Twist, DRIVE), "/robot/state": (String, said), "/wren/cmd_vel": (Twist, [])}
    return read_recording(write_recording(tmp_path / "drive.mcap", topics))


def rows(data: bytes, columns: int) -> npt.NDArray[np.float32]:
    return np.frombuffer(data, dtype="<f4").reshape(-1, columns)


def test_the_robot_is_where_its_commands_led_it_at_each_time(recording: Recording) -> None:
    view = RobotView(recording, start=(1.0, 2.0, 0.0))
    assert view.span == 4.0
    moments = rows(view.moments[0], 6)
    assert (moments[0, 0], moments[-1, 0]) == (0.0, 4.0)
    assert np.diff(moments[:, 0]).max() < 0.06, "close enough that it is straight between them"
    for time, *pose, linear, angular in moments.tolist():
        path = DrivenPath(Pose(1.0, 2.0, 0.0), 0.0, hold=1.0)
        commands = [Command(t, m.linear.x, m.angular.z) for t, m in DRIVE if t <= time + 1e-6]
        path.drive(commands, time)
        assert pose == pytest.approx(path.pose, abs=1e-5)
        assert (linear, angular) == pytest.approx(path.command[1:])


def test_the_robot_stands_at_the_recordings_end_and_its_picture_shows_the_whole_way(
    recording: Recording,
) -> None:
    view = RobotView(recording)
    assert view.pose == pytest.approx(
        (math.sin(1) + 0.5 * math.cos(1), 1 - math.cos(1) + 0.5 * math.sin(1), 1)
    )
    assert "standing" in view.description
    way = view.still().axes[0].lines[0].get_xydata()
    assert way[-1] == pytest.approx(view.pose[:2])
    assert len(way) > 10
    view.reset()
    assert view.pose.heading == pytest.approx(1), "a recording is as it is"


def test_the_plot_gets_each_sample_with_its_time_since_the_begin(recording: Recording) -> None:
    plot = TwistPlot(recording)
    expected = [(time, message.linear.x, message.angular.z) for time, message in DRIVE]
    np.testing.assert_allclose(rows(plot.recorded, 3), expected, atol=1e-6)
    assert plot.span == 4.0
    assert plot.recording.endswith("drive.mcap")
    assert plot.topic_log.count == len(DRIVE)
    assert "21 messages" in plot.description
    line = plot.still().axes[0].lines[0]
    assert line.get_xdata()[-1] == pytest.approx(2.0)


def test_a_long_recording_stays_small(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(twist_plot, "MOST_RECORDED", 1000)
    monkeypatch.setattr(robot_view, "MOST_MOMENTS", 400)
    drive = [(0.01 * n, twist(0.5, float(n % 3))) for n in range(1200)]
    recording = read_recording(write_recording(tmp_path / "long.mcap", {"/cmd_vel": (Twist, drive)}))
    assert len(rows(TwistPlot(recording).recorded, 3)) <= 1000
    moments = rows(RobotView(recording).moments[0], 6)
    assert len(moments) <= 801
    assert moments[-1, 3] == pytest.approx(11.98, abs=0.001), "and every command is in it"


@pytest.mark.parametrize("drive", [DRIVE[:1], [(0.0, twist(0.0, 0.0)), (3600.0, twist(0.0, 0.0))]])
def test_recordings_of_next_to_nothing_are_shown(tmp_path: Path, drive: list[tuple[float, Any]]) -> None:
    recording = read_recording(write_recording(tmp_path / "little.mcap", {"/cmd_vel": (Twist, drive)}))
    for view in (RobotView(recording), TwistPlot(recording)):
        assert view.span >= 0.1
        view.still().canvas.draw()


@VIEWS
@pytest.mark.parametrize(
    ("topic", "error", "says"),
    [
        ("/cmd_vil", ValueError, "drive.mcap holds no topic /cmd_vil; did you mean /cmd_vel?"),
        (
            "/robot/state",
            ValueError,
            "drive.mcap is of the type std_msgs/msg/String; {} shows geometry_msgs/msg/Twist.",
        ),
        (
            "/wren/cmd_vel",
            ValueError,
            "drive.mcap holds no message of /wren/cmd_vel: nothing was published there.",
        ),
        ("/cmd vel", ValueError, "'/cmd vel' is no name of a topic"),
        (3, TypeError, "A topic is a text"),
    ],
)
def test_what_cannot_be_shown_is_told_in_one_sentence(
    recording: Recording, view_class: type[Any], topic: Any, error: type[Exception], says: str
) -> None:
    with pytest.raises(error) as caught:
        view_class(recording, topic=topic)
    assert says.format(view_class.__name__) in str(caught.value)
    assert "\n" not in str(caught.value)


@VIEWS
def test_a_path_is_not_a_recording(view_class: type[Any]) -> None:
    with pytest.raises(TypeError, match=r"or what read_recording\(\) returns, not 'drive.mcap'\."):
        view_class("drive.mcap")


@VIEWS
def test_a_view_of_a_recording_leaves_its_picture(
    recording: Recording, view_class: type[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    stored: list[dict[str, Any]] = []
    monkeypatch.setattr(stored_view, "display", lambda data, **_: stored.append(data))
    monkeypatch.setattr(stored_view, "update_display", lambda data, **_: stored.append(data))
    view = view_class(recording, topic="cmd_vel")
    view._ipython_display_()
    assert set(stored[0]) == {"text/plain", "image/png", WIDGET_VIEW}
    assert base64.b64decode(stored[0]["image/png"]).startswith(b"\x89PNG")
    assert stored[0]["text/plain"] == f"{view_class.__name__}(/cmd_vel)"
    view.close()
    view.close()
    assert [set(data) for data in stored[1:]] == [{"text/plain", "image/png"}]


@VIEWS
def test_the_second_view_of_a_file_closes_the_first(recording: Recording, view_class: type[Any]) -> None:
    first, second = view_class(recording), view_class(read_recording(recording.path))
    assert first.is_closed
    assert not second.is_closed


@pytest.mark.parametrize("make", [RobotView, TwistPlot])
def test_views_of_a_recording_stand_side_by_side_but_not_with_those_of_a_session(
    recording: Recording, make: Callable[[Any], StoredView]
) -> None:
    both = SideBySide(RobotView(recording), TwistPlot(recording))
    assert not both.is_closed
    session = StandInSession()
    with pytest.raises(ValueError, match="of one session, or of one recording"):
        SideBySide(make(recording), TwistPlot(session))
    with pytest.raises(RuntimeError, match="shows a recording, and belongs to no session"):
        _ = make(recording).session
    session.close()


def test_a_damaged_recording_is_told_in_a_sentence(tmp_path: Path) -> None:
    """Wherever a byte has changed: in a chunk, in a definition, in a message."""
    path = write_recording(tmp_path / "drive.mcap", {"/robot/status": (String, [(0.0, String(data="idle"))])})
    data, told = path.read_bytes(), list[str]()
    for place in range(20, len(data), 7):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0xFF]) + data[place + 1 :])
        try:
            recording = read_recording(path)
            for topic in recording:
                _ = recording[topic]
        except ValueError as error:
            told.append(str(error))
    assert len(told) > 5
    assert all(path.name in sentence for sentence in told)
