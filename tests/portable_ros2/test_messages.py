"""Messages: types by name, messages as text, messages from text."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from portable_ros2 import messages

# --- Types by name


@pytest.mark.parametrize("name", ["std_msgs/msg/String", "std_msgs/String"])
def test_a_message_is_found_by_its_long_and_its_short_name(name: str) -> None:
    from std_msgs.msg import String

    assert messages.find_message(name) is String


@pytest.mark.parametrize("name", ["std_srvs/srv/Trigger", "std_srvs/Trigger"])
def test_a_service_is_found_by_its_long_and_its_short_name(name: str) -> None:
    from std_srvs.srv import Trigger

    assert messages.find_service(name) is Trigger


def test_the_messages_of_a_service_are_found_as_a_topic_of_them_names_them() -> None:
    assert messages.find_message("std_srvs/srv/SetBool_Event").__name__ == "SetBool_Event"


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("", "'' is not of the form package/msg/Name"),
        ("String", "'String' is not of the form package/msg/Name"),
        ("std_msgs/msg/String/x", "'std_msgs/msg/String/x' is not of the form package/msg/Name"),
        ("std_msgs//String", "'std_msgs//String' is not of the form package/msg/Name"),
        ("std_msgs/msg/a b", "'std_msgs/msg/a b' is not of the form package/msg/Name"),
        ("std_msg/msg/String", "there is no package 'std_msg'; did you mean 'std_msgs'? (is its workspace sourced?)"),
        ("qzx/msg/String", "there is no package 'qzx' (is its workspace sourced?)"),
        ("std_msgs/msg/string", "the package 'std_msgs' has no 'msg/string'; did you mean 'String'?"),
        ("std_msgs/msg/Qzx", "the package 'std_msgs' has no 'msg/Qzx'"),
        ("std_srvs/msg/Trigger", "the package 'std_srvs' has nothing of the kind 'msg'"),
        ("std_srvs/srv/Trigger", "'std_srvs/srv/Trigger' is not of the kind package/msg/Name"),
        ("os/path/join", "the package 'os' has nothing of the kind 'path'"),
    ],
)  # fmt: skip
def test_what_is_missing_is_said(name: str, reason: str) -> None:
    with pytest.raises(messages.TypeNotFoundError) as caught:
        messages.find_message(name)
    assert str(caught.value) == f"The passed message type is invalid: {reason}"
    assert caught.value.reason == reason


@pytest.mark.parametrize("name", ["swan/msg/Egg", "swan/Egg", "goose/msg/Egg", "goose/__main__/Egg"])
def test_a_type_of_somebody_else_runs_no_module_that_has_its_name(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A recording or another node may name any: only a package with types is imported."""
    (tmp_path / "goose").mkdir()
    for file in "swan.py", "goose/__init__.py", "goose/__main__.py":
        (tmp_path / file).write_text("raise SystemExit('it was run')")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(messages.TypeNotFoundError):
        messages.find_message(name)


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import a_module_that_is_not_there", "No module named 'a_module_that_is_not_there'"),
        ("raise ImportError('first\\nsecond')", "first"),
        ("raise ImportError", "ImportError"),
        ("this is no Python", "invalid syntax (__init__.py, line 1)"),
    ],
)
def test_a_broken_package_is_told_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, source: str, reason: str
) -> None:
    (tmp_path / "broken_words" / "msg").mkdir(parents=True)
    (tmp_path / "broken_words" / "__init__.py").touch()
    (tmp_path / "broken_words" / "msg" / "__init__.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(messages.TypeNotFoundError) as caught:
        messages.find_message("broken_words/msg/Word")
    assert caught.value.reason == f"'broken_words/msg/Word' cannot be imported: {reason}"
    __import__("sys").modules.pop("broken_words", None)


def test_a_message_without_its_compiled_half_is_not_found(monkeypatch: pytest.MonkeyPatch) -> None:
    from std_msgs.msg import Bool

    monkeypatch.setattr(type(Bool), "_TYPE_SUPPORT", None)
    monkeypatch.setattr(type(Bool), "__import_type_support__", classmethod(lambda _: None))
    with pytest.raises(messages.TypeNotFoundError, match="its compiled library cannot be loaded"):
        messages.find_message("std_msgs/msg/Bool")


def test_the_installed_messages_are_listed() -> None:
    names = messages.message_names()
    assert {"std_msgs/msg/String", "geometry_msgs/msg/Twist"} <= set(names)
    assert names == sorted(names)
    assert not any("/srv/" in name for name in names)


# --- Messages as text


def filled(type_name: str, /, **values: Any) -> Any:
    message = messages.find_message(type_name)()
    messages.fill(message, values)
    return message


IMU = {"header": {"frame_id": "base"}, "orientation_covariance": range(9)}


def test_yaml_has_block_style_and_lists_are_not_indented() -> None:
    joints = filled("sensor_msgs/JointState", name=["a", "b"], position=[1, 2.5])
    assert messages.to_yaml(joints) == (
        "header:\n  stamp:\n    sec: 0\n    nanosec: 0\n  frame_id: ''\n"
        "name:\n- a\n- b\nposition:\n- 1.0\n- 2.5\nvelocity: []\neffort: []\n"
    )


def test_messages_in_a_list_begin_with_a_dash() -> None:
    polygon = filled("geometry_msgs/Polygon", points=[{"x": 1}, {"y": 2}])
    assert (
        messages.to_yaml(polygon) == "points:\n- x: 1.0\n  y: 0.0\n  z: 0.0\n- x: 0.0\n  y: 2.0\n  z: 0.0\n"
    )


def test_a_message_without_fields_is_an_empty_mapping() -> None:
    assert messages.to_yaml(filled("std_msgs/Empty")) == "{}\n"


def test_flow_style_puts_each_list_in_one_line() -> None:
    polygon = filled("geometry_msgs/Polygon", points=[{"x": 1}])
    assert messages.to_yaml(polygon, flow_style=True) == "points: [{x: 1.0, y: 0.0, z: 0.0}]\n"


TEXTS = [
    "", " ", "plain", "two words", "y", "no", "null", "1", "1e3", "0x1f", "true", "- a", "a: b", "#", "a #b", "it's",
    '"', "tab\t", "line\nbreak", "\n", "\x00", "\x85", "\u2028", "é", "日本", "😀", "---", "...", "2024-01-01", "=",
    "[", "{", "&a", "*a", "!a", "|", ">", "%", "@", "`", "word " * 100,
]  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_each_text_is_written_as_pyyaml_writes_it(text: str) -> None:
    """Also inside lists, where a text of several lines is indented in another way."""
    diagnosis = filled(
        "diagnostic_msgs/DiagnosticStatus",
        message=text,
        values=[{"key": text, "value": "x"}, {"value": text}],
    )
    shown = messages.to_yaml(diagnosis)
    plain = messages.to_dict(diagnosis)
    assert shown == yaml.dump(plain, allow_unicode=True, width=10**9, sort_keys=False)


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        (0.0, "0.0"), (-0.0, "-0.0"), (1e16, "1.0e+16"), (1.5e-9, "1.5e-09"), (0.1, "0.1"),
        (math.inf, ".inf"), (-math.inf, "-.inf"), (math.nan, ".nan"),
    ],
)  # fmt: skip
def test_each_number_is_written_as_yaml_knows_it(number: float, shown: str) -> None:
    assert messages.to_yaml(filled("std_msgs/Float64", data=number)) == f"data: {shown}\n"


@pytest.mark.parametrize(
    ("name", "values", "limits", "shown"),
    [
        ("std_msgs/String", {"data": "abcdef"}, {"truncate_length": 3}, "data: abc...\n"),
        ("std_msgs/String", {"data": "abc"}, {"truncate_length": 3}, "data: abc\n"),
        ("std_msgs/String", {"data": "abc"}, {"truncate_length": 0}, "data: '...'\n"),
        ("std_msgs/String", {"data": "abc"}, {"no_str": True}, "data: '<string length: <3>>'\n"),
        ("std_msgs/String", {"data": "abc"}, {"no_arr": True}, "data: abc\n"),
        ("geometry_msgs/Polygon", {"points": [{}] * 3}, {"no_arr": True},
         "points: '<sequence type: geometry_msgs/msg/Point32, length: 3>'\n"),
        ("sensor_msgs/CameraInfo", {"d": [1, 2]}, {"no_arr": True}, "d: '<sequence type: double, length: 2>'"),
        ("sensor_msgs/CameraInfo", {}, {"no_arr": True}, "k: '<array type: double[9]>'"),
        ("sensor_msgs/JointState", {"name": ["a"]}, {"no_arr": True}, "name: '<sequence type: string, length: 1>'"),
        ("sensor_msgs/JointState", {"name": ["a", "b", "c"]}, {"truncate_length": 2}, "name:\n- a\n- b\n- '...'\n"),
        ("sensor_msgs/CameraInfo", {}, {"truncate_length": 1}, "k:\n- 0.0\n- '...'\n"),
        ("shape_msgs/SolidPrimitive", {"dimensions": [1]}, {"no_arr": True}, "<sequence type: double[3], length: 1>"),
        ("std_msgs/Byte", {"data": 65}, {}, "data: A\n"),
    ],
)  # fmt: skip
def test_what_is_long_is_cut_off_or_left_out(
    name: str, values: dict[str, Any], limits: dict[str, Any], shown: str
) -> None:
    assert shown in messages.to_yaml(filled(name, **values), **limits)


@pytest.mark.parametrize(
    ("name", "values", "limits", "shown"),
    [
        ("geometry_msgs/Vector3", {"x": 1}, {}, "1.0,0.0,0.0"),
        ("std_msgs/Bool", {"data": True}, {}, "True"),
        ("std_msgs/Byte", {"data": 1}, {}, "b'\\x01'"),
        ("sensor_msgs/JointState", {"name": ["a", "b"], "position": [1]}, {}, "0,0,,a,b,1.0,,"),
        ("sensor_msgs/JointState", {"name": ["abc", "b"]}, {"truncate_length": 1}, "0,0,,a...,...,,,"),
        ("sensor_msgs/JointState", {"name": ["a"]}, {"no_str": True}, "0,0,<string length: <0>>,<string length: <1>>,,,"),
        ("geometry_msgs/Polygon", {"points": [{}]}, {"no_arr": True},
         "<sequence type: geometry_msgs/msg/Point32, length: 1>"),
        ("std_msgs/UInt8MultiArray", {"data": [1, 2]}, {}, "0,1,2"),  # its empty list of dimensions is left out
        ("unique_identifier_msgs/UUID", {"uuid": range(16)}, {"truncate_length": 2}, "0,1,..."),
        ("std_msgs/Empty", {}, {}, ""),
    ],
)  # fmt: skip
def test_csv_has_all_values_in_one_line(
    name: str, values: dict[str, Any], limits: dict[str, Any], shown: str
) -> None:
    assert messages.to_csv(filled(name, **values), **limits) == shown


def test_a_dict_holds_plain_values_only() -> None:
    plain = messages.to_dict(filled("sensor_msgs/Imu", **IMU))
    assert plain["orientation_covariance"] == list(range(9))
    assert all(type(value) is float for value in plain["orientation_covariance"])
    assert plain["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}


# --- Messages from text


@pytest.mark.parametrize(
    "text",
    [
        "{linear: {x: 1.0}, angular: {z: -2}}",
        '{"linear": {"x": 1.0}, "angular": {"z": -2}}',
        "linear:\n  x: 1\nangular:\n  z: -2.0\n",
        "{linear: {x: '1'}, angular: {z: -2e0}}",
        b"{linear: {x: 1}, angular: {z: -2}}",
    ],
)
def test_yaml_and_json_fill_a_message(text: str | bytes) -> None:
    """YAML takes -2e0 for a text."""
    from geometry_msgs.msg import Twist

    twist = Twist()
    assert messages.fill(twist, messages.parse_values(text)) == []
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (1.0, 0.0, -2.0)
    assert type(twist.linear.x) is type(twist.angular.z) is float


@pytest.mark.parametrize("text", ["", "data:1", "1", "[1]", "null", "text"])
def test_values_without_names_are_refused(text: str) -> None:
    with pytest.raises(RuntimeError, match="The passed value needs to be a dictionary in YAML format"):
        messages.parse_values(text)


@pytest.mark.parametrize(
    "text", ["{data: [1", "{a: b: c}", "a: b\nc", "'", "{a: *b}", "\x00", "a: 2024-13-45"]
)
def test_what_is_no_yaml_is_told_in_one_line(text: str) -> None:
    with pytest.raises(RuntimeError, match="The passed value is not valid YAML") as caught:
        messages.parse_values(text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "value", "data"),
    [
        ("Float64", 1, 1.0), ("Float64", "1e3", 1000.0), ("Float64", True, 1.0), ("Float64", math.inf, math.inf),
        ("Float32", 0.5, 0.5), ("Int8", -128, -128), ("UInt64", 2**64 - 1, 2**64 - 1), ("Int32", 2.0, 2),
        ("Int32", "7", 7), ("UInt8", True, 1), ("Bool", True, True), ("Bool", 0, False), ("Char", 65, 65),
        ("Byte", 7, b"\x07"), ("Byte", "A", b"A"), ("Byte", b"A", b"A"),
        ("String", "a", "a"), ("String", 5, "5"), ("String", 1.5, "1.5"), ("String", True, "True"), ("String", "", ""),
    ],
)  # fmt: skip
def test_a_value_becomes_what_its_field_is(name: str, value: Any, data: Any) -> None:
    found = filled(f"std_msgs/{name}", data=value).data
    assert found == data
    assert type(found) is type(data)


@pytest.mark.parametrize(
    ("name", "value", "right"),
    [
        ("Float64", "x", "a number"), ("Float64", None, "a number"), ("Float64", [1.0], "a number"),
        ("Float64", {}, "a number"), ("Float32", 1e39, "a number"),
        ("Int8", 128, "a whole number from -128 to 127"), ("UInt8", -1, "a whole number from 0 to 255"),
        ("UInt16", 65536, "a whole number from 0 to 65535"), ("Int8", 1.5, "a whole number from -128 to 127"),
        ("Int8", "a", "a whole number from -128 to 127"), ("Int8", math.nan, "a whole number from -128 to 127"),
        ("Int8", math.inf, "a whole number from -128 to 127"), ("Int8", [1], "a whole number from -128 to 127"),
        ("Bool", "false", "true or false"), ("Bool", None, "true or false"), ("Bool", [], "true or false"),
        ("Byte", 256, "a whole number from 0 to 255"), ("Byte", "AB", "a whole number from 0 to 255"),
        ("String", None, "a text (in quotes)"), ("String", [1], "a text (in quotes)"),
        ("String", {"a": 1}, "a text (in quotes)"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_told_with_what_would_be_right(name: str, value: Any, right: str) -> None:
    with pytest.raises(messages.FieldError) as caught:
        filled(f"std_msgs/{name}", data=value)
    assert str(caught.value) == f"Failed to populate field: 'data' takes {right}, not {value!r}"


@pytest.mark.parametrize(
    ("name", "values", "reason"),
    [
        ("std_msgs/String", {"dat": 1}, "std_msgs/msg/String has no field 'dat'; it has data"),
        ("std_msgs/String", {"SLOT_TYPES": 1}, "std_msgs/msg/String has no field 'SLOT_TYPES'; it has data"),
        ("std_msgs/Empty", {"a": 1}, "std_msgs/msg/Empty has no field 'a'; it has none"),
        ("std_srvs/srv/SetBool_Request", {1: 1}, "std_srvs/srv/SetBool_Request has no field '1'; it has data"),
        ("geometry_msgs/Twist", {"linear": {"w": 1}},
         "'linear' (geometry_msgs/msg/Vector3) has no field 'w'; it has x, y, z"),
        ("geometry_msgs/Twist", {"linear": 1}, "'linear' is a message with the fields x, y, z, not 1"),
        ("geometry_msgs/Twist", {"linear": None}, "'linear' is a message with the fields x, y, z, not None"),
        ("geometry_msgs/Twist", {"linear": [1, 2, 3]}, "'linear' is a message with the fields x, y, z, not [1, 2, 3]"),
        ("geometry_msgs/Twist", {"linear": {"x": "fast"}}, "'linear.x' takes a number, not 'fast'"),
        ("geometry_msgs/Polygon", {"points": [{"x": 1}, {"x": "a"}]}, "'points[1].x' takes a number, not 'a'"),
        ("geometry_msgs/Polygon", {"points": {"x": 1}}, "'points' takes a list, such as [1, 2], not {'x': 1}"),
        ("sensor_msgs/JointState", {"name": "a"}, "'name' takes a list, such as [1, 2], not 'a'"),
        ("sensor_msgs/JointState", {"position": 1}, "'position' takes a list, such as [1, 2], not 1"),
        ("sensor_msgs/JointState", {"position": [1, "a"]}, "'position[1]' takes a number, not 'a'"),
        ("sensor_msgs/Imu", {"orientation_covariance": [1]}, "'orientation_covariance' takes exactly 9 values, not 1"),
        ("shape_msgs/SolidPrimitive", {"dimensions": [1] * 4}, "'dimensions' takes at most 3 values, not 4"),
        ("sensor_msgs/Imu", {"header": "now"}, "'header' is a message with the fields stamp, frame_id, not 'now'"),
        ("sensor_msgs/Imu", {"header": {"stamp": "auto"}},
         "'header.stamp' is a message with the fields sec, nanosec, not 'auto'"),
    ],
)  # fmt: skip
def test_a_wrong_place_is_told_with_what_is_there(name: str, values: dict[Any, Any], reason: str) -> None:
    with pytest.raises(messages.FieldError) as caught:
        messages.fill(messages.find_message(name)(), values)
    assert str(caught.value) == f"Failed to populate field: {reason}"


def test_lists_get_the_containers_that_the_message_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """The message class itself would refuse others."""
    monkeypatch.setenv("ROS_PYTHON_CHECK_FIELDS", "1")
    imu = filled("sensor_msgs/Imu", orientation_covariance=[1] * 9)
    assert imu.orientation_covariance.dtype == np.float64
    joints = filled("sensor_msgs/JointState", name=["a"], position=[1])
    assert (joints.name, list(joints.position)) == (["a"], [1.0])
    assert list(filled("std_msgs/UInt8MultiArray", data=b"ab").data) == [97, 98]


def test_auto_and_now_stand_for_the_time_of_publishing() -> None:
    from builtin_interfaces.msg import Time
    from geometry_msgs.msg import PoseArray, PoseStamped

    pose = PoseStamped()
    (set_stamp,) = messages.fill(pose, {"header": "auto"})
    set_stamp(Time(sec=3))
    assert pose.header.stamp.sec == 3

    poses = PoseArray()
    (set_stamp,) = messages.fill(poses, {"header": {"stamp": "now", "frame_id": "map"}})
    for second in (1, 2):
        set_stamp(Time(sec=second, nanosec=5))
        assert (poses.header.stamp.sec, poses.header.stamp.nanosec) == (second, 5)
    assert poses.header.frame_id == "map"


# --- What ROS calls them


def test_the_library_of_ros_gives_the_same() -> None:
    """Students import it, also to take a message's class by its name."""
    from std_msgs.msg import String

    import rosidl_runtime_py
    from rosidl_runtime_py.utilities import get_action, get_interface, get_message, get_service

    for find in (get_message, get_interface):
        assert find("std_msgs/msg/String") is String
    assert get_service("std_srvs/srv/Trigger") is get_interface("std_srvs/srv/Trigger")
    for find in (get_message, get_service, get_action):
        with pytest.raises(ValueError, match="nowhere"):
            find("nowhere/msg/Nothing")
    message = String()
    assert rosidl_runtime_py.set_message_fields(message, {"data": "well"}) == []
    assert rosidl_runtime_py.message_to_ordereddict(message) == {"data": "well"}
    assert rosidl_runtime_py.message_to_yaml(message) == "data: well\n"
    assert rosidl_runtime_py.message_to_csv(message) == "well"
    assert "msg/String" in rosidl_runtime_py.get_message_interfaces(["std_msgs"])["std_msgs"]
    assert rosidl_runtime_py.get_interface_path("std_msgs/msg/String").endswith("String.msg")
