"""What a form knows of a message type, and which of the things typed into it make a message."""

from __future__ import annotations

import math
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Polygon, PoseWithCovarianceStamped, Twist
from rcl_interfaces.msg import ParameterDescriptor
from sensor_msgs.msg import BatteryState, LaserScan, NavSatStatus
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import (
    Bool,
    Byte,
    Float32,
    Float64,
    Int8,
    Int16,
    Int32,
    Int64,
    String,
    UInt8,
    UInt16,
    UInt32,
    UInt64,
)

from portable_ros2 import interfaces
from ros2lab import message_schema as schema_module
from ros2lab.message_schema import NOW, FormError, filled, message_schema


def field(message_type: type, *path: str) -> dict[str, Any]:
    """Return the description of a field."""
    found: dict[str, Any] = {"fields": message_schema(message_type)}
    for name in path:
        found = next(below for below in found["fields"] if below["name"] == name)
    return found


# The schema


def test_the_schema_nests_as_the_message_does() -> None:
    header, pose = message_schema(PoseWithCovarianceStamped)
    assert [f["name"] for f in header["fields"]] == ["stamp", "frame_id"]
    assert header["fields"][0]["kind"] == "time"
    inner, covariance = pose["fields"]
    assert inner["kind"] == "message"
    assert (covariance["kind"], covariance["size"], covariance["type"]) == ("array", 36, "float64[36]")
    assert covariance["default"] == ["0.0"] * 36
    assert covariance["item"]["kind"] == "float"


def test_defaults_are_those_of_the_message() -> None:
    assert field(PoseWithCovarianceStamped, "pose", "pose", "orientation", "w")["default"] == "1.0"
    assert field(NavSatStatus, "status")["default"] == "-2"
    assert field(Bool, "data")["default"] is False


def test_arrays_say_how_long_they_may_be() -> None:
    assert (field(Polygon, "points")["size"], field(Polygon, "points")["most"]) == (None, None)
    assert field(SolidPrimitive, "dimensions")["most"] == 3
    assert field(ParameterDescriptor, "floating_point_range")["most"] == 1


@pytest.mark.parametrize(
    ("message_type", "low", "high"),
    [
        (Int8, -(2**7), 2**7 - 1),
        (UInt8, 0, 2**8 - 1),
        (Byte, 0, 2**8 - 1),
        (Int64, -(2**63), 2**63 - 1),
        (UInt64, 0, 2**64 - 1),
    ],
)
def test_whole_numbers_have_ranges(message_type: type, low: int, high: int) -> None:
    data = field(message_type, "data")
    assert (int(data["low"]), int(data["high"])) == (low, high)


def test_constants_are_offered_where_they_belong() -> None:
    assert field(DiagnosticStatus, "level")["options"][:3] == [("OK", "0"), ("WARN", "1"), ("ERROR", "2")]
    assert field(DiagnosticStatus, "name")["options"] == []
    names = [name for name, _ in field(BatteryState, "power_supply_health")["options"]]
    assert "POWER_SUPPLY_HEALTH_GOOD" in names
    assert all(name.startswith("POWER_SUPPLY_HEALTH_") for name in names)
    assert field(NavSatStatus, "service")["options"][1] == ("SERVICE_GPS", "1")


def test_comments_and_units_come_from_the_definition() -> None:
    least = field(LaserScan, "range_min")
    assert (least["unit"], least["comment"]) == ("m", "minimum range value [m]")
    assert field(LaserScan, "angle_increment")["unit"] == "rad"
    assert field(BatteryState, "current")["unit"] == "A"
    assert "Row-major" in field(PoseWithCovarianceStamped, "pose", "covariance")["comment"]
    assert field(Twist, "linear", "x")["comment"] == "", "the file's first comment is about the whole message"


def test_without_a_definition_there_are_fields_and_constants_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def no_file(name: str) -> Any:
        raise LookupError(name)

    monkeypatch.setattr(interfaces, "definition", no_file)
    schema_module._words.cache_clear()
    level = field(DiagnosticStatus, "level")
    schema_module._words.cache_clear()
    assert level["options"][0] == ("OK", "0")
    assert level["comment"] == ""


# What was typed


def test_nested_values_and_arrays_make_a_message() -> None:
    values = {
        "header": {"frame_id": "map", "stamp": {"sec": "3", "nanosec": "5"}},
        "pose": {"pose": {"position": {"x": "1", "y": "-2.5e-1"}}, "covariance": [str(n) for n in range(36)]},
    }
    message, setters = filled(PoseWithCovarianceStamped, values)
    assert setters == []
    assert (message.header.frame_id, message.header.stamp.sec) == ("map", 3)
    assert (message.pose.pose.position.x, message.pose.pose.position.y) == (1.0, -0.25)
    assert isinstance(message.pose.pose.position.x, float)
    assert list(message.pose.covariance) == [float(n) for n in range(36)]
    assert message.pose.pose.orientation.w == 1.0


def test_arrays_of_messages_and_bytes_are_filled() -> None:
    values = {"status": [{"level": "2", "values": [{"key": "a", "value": "b"}]}, {"name": "second"}]}
    message, _ = filled(DiagnosticArray, values)
    assert message.status[0].level == b"\x02"
    assert message.status[0].values[0].value == "b"
    assert message.status[1].name == "second"


def test_the_default_of_every_field_is_accepted() -> None:
    def defaults(fields: list[dict[str, Any]]) -> dict[str, Any]:
        return {f["name"]: default(f) for f in fields}

    def default(f: dict[str, Any]) -> Any:
        if f["kind"] in ("message", "time"):
            return defaults(f["fields"])
        if f["kind"] == "array":
            return [default(f["item"]) if value is None else value for value in f["default"]]
        return f["default"]

    for message_type in (PoseWithCovarianceStamped, BatteryState, LaserScan, DiagnosticArray, SolidPrimitive):
        message, _ = filled(message_type, defaults(message_schema(message_type)))
        assert str(message) == str(message_type())


def test_now_is_set_when_it_is_published() -> None:
    message, (set_stamp,) = filled(PoseWithCovarianceStamped, {"header": {"stamp": NOW}})
    set_stamp(message.header.stamp.__class__(sec=7, nanosec=8))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)


INTEGERS = [
    (Int8, -(2**7), 2**7 - 1),
    (UInt8, 0, 2**8 - 1),
    (Int16, -(2**15), 2**15 - 1),
    (UInt16, 0, 2**16 - 1),
    (Int32, -(2**31), 2**31 - 1),
    (UInt32, 0, 2**32 - 1),
    (Int64, -(2**63), 2**63 - 1),
    (UInt64, 0, 2**64 - 1),
]


@pytest.mark.parametrize(("message_type", "low", "high"), INTEGERS)
def test_the_limits_of_a_whole_number_are_accepted_and_what_is_beyond_is_not(
    message_type: type, low: int, high: int
) -> None:
    for number in (low, high, 0):
        assert filled(message_type, {"data": f" {number} "})[0].data == number
    for number in (low - 1, high + 1):
        with pytest.raises(FormError) as caught:
            filled(message_type, {"data": str(number)})
        assert caught.value.problems == {
            "data": f"data takes a whole number from {low} to {high}, not '{number}'."
        }


@pytest.mark.parametrize(
    ("message_type", "value", "says"),
    [
        (Int8, "1.5", "data takes a whole number from -128 to 127, not '1.5'."),
        (Int8, "", "data takes a number; it is empty."),
        (UInt8, "0x10", "data takes a whole number from 0 to 255, not '0x10'."),
        (UInt8, "\uff11", "data takes a whole number from 0 to 255"),
        (Float64, "abc", "data takes a number such as 0.5, not 'abc'."),
        (Float64, "0,5", "data takes a decimal point: 0.5, not '0,5'."),
        (Float64, "1_0", "data takes a number such as 0.5, not '1_0'."),
        (Float64, "1e999", "data takes a number up to ±1.8e+308 (float64), not '1e999'."),
        (Float32, "1e39", "data takes a number up to ±3.4e+38 (float32), not '1e39'."),
        (Float64, True, "data takes a number, not True."),
        (Bool, "true", "data takes true or false, not 'true'."),
        (String, 3, "data takes a text, not 3."),
        (String, "a\0b", "data takes a text without the character NUL"),
        (Twist, {}, "geometry_msgs/msg/Twist has no field data; it has linear, angular."),
    ],
)
def test_what_does_not_fit_is_refused_with_one_sentence(message_type: type, value: Any, says: str) -> None:
    with pytest.raises(FormError) as caught:
        filled(message_type, {"data": value})
    (sentence,) = caught.value.problems.values()
    assert says in sentence
    assert sentence.count("\n") == 0
    assert list(caught.value.problems) == ["data"]


def test_numbers_that_are_none_are_numbers_to_ros() -> None:
    assert math.isnan(filled(Float32, {"data": "nan"})[0].data)
    assert filled(Float64, {"data": "-inf"})[0].data == -math.inf


def test_every_bad_field_is_named_with_its_path() -> None:
    values = {
        "header": {"stamp": {"sec": "x"}},
        "pose": {"pose": {"position": {"z": "?"}}, "covariance": ["0"] * 35 + ["a"]},
    }
    with pytest.raises(FormError) as caught:
        filled(PoseWithCovarianceStamped, values)
    assert set(caught.value.problems) == {"header.stamp.sec", "pose.pose.position.z", "pose.covariance[35]"}


@pytest.mark.parametrize(
    ("message_type", "values", "problems"),
    [
        (
            PoseWithCovarianceStamped,
            {"pose": {"covariance": ["0"] * 35}},
            {"pose.covariance": "pose.covariance takes exactly 36 elements, not 35."},
        ),
        (
            SolidPrimitive,
            {"dimensions": ["0"] * 4},
            {"dimensions": "dimensions takes at most 3 elements, not 4."},
        ),
        (Polygon, {"points": "no"}, {"points": "points takes a list, not 'no'."}),
        (Polygon, {"points": ["no"]}, {"points[0]": "points[0] takes the fields x, y, z, not 'no'."}),
    ],
)
def test_arrays_of_a_wrong_length_or_kind_are_refused(
    message_type: type, values: dict[str, Any], problems: dict[str, str]
) -> None:
    with pytest.raises(FormError) as caught:
        filled(message_type, values)
    assert caught.value.problems == problems
