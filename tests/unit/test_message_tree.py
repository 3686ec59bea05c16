"""A message as a tree: what a reader sees of its fields."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from builtin_interfaces.msg import Duration, Time
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, PoseWithCovarianceStamped, Transform, Twist
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import Bool, Float32, Header, Int8, String
from visualization_msgs.msg import Marker, MarkerArray

from ros2lab.message_tree import MOST_BRANCHES, MOST_ITEMS, Branch, message_tree


def all_branches(tree: Branch) -> Iterator[Branch]:
    for child in tree.children:
        yield child
        yield from all_branches(child)


def find(message: Any, *path: str) -> Branch:
    """Return the branch of a message's tree at a path of names."""
    branch = message_tree(message)
    for name in path:
        (branch,) = (child for child in branch.children if child.name == name)
    return branch


def test_nested_messages_are_branches_in_the_order_of_their_definition() -> None:
    message = PoseWithCovarianceStamped()
    message.pose.pose.position.x = 1.5
    tree = message_tree(message)
    assert (tree.name, tree.type) == ("", "geometry_msgs/PoseWithCovarianceStamped")
    assert [child.name for child in tree.children] == ["header", "pose"]
    x = find(message, "pose", "pose", "position", "x")
    assert x == Branch("x", "float64", "1.5")
    assert find(message, "pose", "pose", "position").text == "x 1.5  y 0  z 0"


def test_a_long_array_shows_its_length_and_its_first_elements() -> None:
    ranges = find(LaserScan(ranges=[0.5 * n for n in range(640)]), "ranges")
    assert ranges.type == "float32[]"
    assert ranges.text == "640 elements: 0, 0.5, 1, 1.5, …"
    assert [child.name for child in ranges.children[:2]] == ["[0]", "[1]"]
    assert len(ranges.children) == MOST_ITEMS
    assert ranges.left_out == 640 - MOST_ITEMS


def test_arrays_of_every_container_and_of_messages_are_shown() -> None:
    fixed = find(PoseWithCovarianceStamped(), "pose", "covariance")
    assert (fixed.type, fixed.text) == ("float64[36]", "36 elements: 0, 0, 0, 0, …")
    values = find(DiagnosticStatus(values=[KeyValue(key="a", value="1")]), "values")
    assert (values.type, values.text) == ("diagnostic_msgs/KeyValue[]", "1 element")
    assert values.children[0].text == 'key "a"  value "1"'
    assert find(LaserScan(), "ranges") == Branch("ranges", "float32[]", "0 elements")


def test_bytes_are_hexadecimal() -> None:
    data = find(Image(data=bytes(range(250))), "data")
    assert data.text == "250 bytes: 00 01 02 03 04 05 06 07 08 09 0a 0b …"
    assert find(DiagnosticStatus(level=b"\x02"), "level").text == "0x02"


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (Time(sec=12, nanosec=500_000_000), "12.5 s"),
        (Time(), "0 s"),
        (Duration(sec=-1, nanosec=500_000_000), "-0.5 s"),
        (Duration(sec=2), "2 s"),
    ],
)
def test_times_are_seconds(message: Any, text: str) -> None:
    assert message_tree(message).text == text


def test_a_time_of_the_wall_clock_is_a_date() -> None:
    text = find(Header(stamp=Time(sec=1_700_000_000, nanosec=123_000_000)), "stamp").text
    assert text.startswith("2023-11-1")
    assert text.endswith(":20.123")


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (Bool(data=True), "true"),
        (Int8(data=-128), "-128"),
        (Float32(data=0.1), "0.1"),
        (String(data='a "word"\n日本'), '"a \\"word\\"\\n日本"'),
        (Float32(data=float("nan")), "nan"),
    ],
)
def test_values_are_as_they_are_read(message: Any, text: str) -> None:
    assert find(message, "data").text == text


def test_a_long_text_is_cut() -> None:
    text = find(String(data=1000 * "x"), "data").text
    assert len(text) < 150
    assert text.endswith('…"')


def test_a_huge_message_has_a_tree_of_bounded_size() -> None:
    markers = [Marker(points=[Point() for _ in range(100)]) for _ in range(100)]
    tree = message_tree(MarkerArray(markers=markers))
    assert len(list(all_branches(tree))) < 2 * MOST_BRANCHES


def test_the_lines_of_a_tree_fold_arrays() -> None:
    assert list(message_tree(Twist()).lines())[:2] == ["linear: x 0  y 0  z 0", "  x: 0"]
    lines = list(message_tree(LaserScan(ranges=[1.0])).lines())
    assert "ranges: 1 element: 1" in lines
    assert not any("[0]" in line for line in lines)


def test_a_tree_as_plain_data_says_what_is_left_out() -> None:
    plain = message_tree(LaserScan(ranges=[1.0] * 100)).plain()
    (ranges,) = (child for child in plain["children"] if child["name"] == "ranges")
    assert ranges["left_out"] == 100 - MOST_ITEMS
    assert ranges["children"][0] == {"name": "[0]", "type": "float32", "text": "1"}
    assert message_tree(Transform()).plain()["children"][0]["name"] == "translation"
