"""The parameters of the nodes: descriptors, bad values, and the configuration file."""

import math
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter

from conftest import Bench
from robot_controller.status_publisher import StatusPublisher
from robot_controller.velocity_publisher import VelocityPublisher

DEFAULTS = [
    (StatusPublisher, "period", 2.0, "s"),
    (VelocityPublisher, "period", 0.1, "s"),
    (VelocityPublisher, "linear_speed", 0.5, "m/s"),
    (VelocityPublisher, "angular_speed", 0.2, "rad/s"),
]
BAD_NUMBERS = [-1.0, 0.0, math.nan, math.inf, -math.inf, 1e9, -1, 0, 10**12]
BAD_PERIODS = [*BAD_NUMBERS, "fast", "", True, [1.0]]


@pytest.mark.parametrize(("node_class", "name", "default", "unit"), DEFAULTS)
def test_each_parameter_is_described(
    bench: Bench, node_class: type[Node], name: str, default: float, unit: str
) -> None:
    """It has a default, a description, a unit and a range that holds the default."""
    node = bench.add(node_class)
    assert node.get_parameter(name).value == default
    descriptor = node.describe_parameter(name)
    assert descriptor.description.endswith(f", in {unit}")
    assert not descriptor.dynamic_typing
    (allowed,) = descriptor.floating_point_range
    assert allowed.from_value < default < allowed.to_value


@pytest.mark.parametrize("value", BAD_PERIODS)
@pytest.mark.parametrize("node_class", [StatusPublisher, VelocityPublisher])
def test_a_bad_value_is_refused_at_run_time(
    bench: Bench,
    node_class: type[Node],
    value: Any,
) -> None:
    """The answer says why, and the old value stays."""
    node = bench.add(node_class)
    before = node.get_parameter("period").value
    (result,) = node.set_parameters([Parameter("period", value=value)])
    assert not result.successful
    assert "out of range" in result.reason or "Wrong parameter type" in result.reason
    assert node.get_parameter("period").value == before


@pytest.mark.parametrize("value", BAD_PERIODS)
@pytest.mark.parametrize("node_class", [StatusPublisher, VelocityPublisher])
def test_a_bad_value_is_refused_at_start_up(
    bench: Bench,
    node_class: type[Node],
    value: Any,
) -> None:
    """The log says so in one line, and the node goes on with the default."""
    lines = bench.hear_log()
    node = bench.add(node_class, period=value)
    default = {StatusPublisher: 2.0, VelocityPublisher: 0.1}[node_class]
    assert node.get_parameter("period").value == default
    bench.until(lambda: bool(lines), "the log names it")
    assert lines[0].startswith(f"ERROR {node.get_name()}: Refused period=")
    assert lines[0].endswith(f"going on with {default} s.")


def test_an_integer_is_taken_for_a_number(bench: Bench) -> None:
    """`period:=3` is three seconds, at start-up and at run time; the parameter stays a double."""
    node = bench.add(StatusPublisher, "-p", "period:=3")
    assert node.get_parameter("period").value == 3.0
    assert node.set_parameters([Parameter("period", value=4)])[0].successful
    parameter = node.get_parameter("period")
    assert (parameter.type_, parameter.value) == (Parameter.Type.DOUBLE, 4.0)


@pytest.mark.parametrize("name", ["linear_speed", "angular_speed"])
def test_speeds_are_checked_too(bench: Bench, name: str) -> None:
    """A speed may be negative or zero, but not a NaN nor out of its range."""
    node = bench.add(VelocityPublisher)
    for value, is_good in [
        (-0.5, True),
        (0.0, True),
        (1, True),
        (math.nan, False),
        (1e3, False),
        ("1", False),
    ]:
        assert node.set_parameters([Parameter(name, value=value)])[0].successful is is_good, value


def test_other_parameters_are_left_alone(bench: Bench) -> None:
    """What rclpy itself declares can still be set, as `use_sim_time`."""
    node = bench.add(VelocityPublisher)
    assert node.set_parameters([Parameter("use_sim_time", value=True)])[0].successful


@pytest.mark.parametrize("namespace", ["/", "/anna"])
def test_configuration_file_is_found_in_every_namespace(
    bench: Bench, package: Path, tmp_path: Path, namespace: str
) -> None:
    """Its values are the defaults; changed ones reach the nodes."""
    text = (package / "config" / "robot.yaml").read_text()
    changed = tmp_path / "changed.yaml"
    for before, after in (("2.0", "3.0"), ("0.1", "0.3"), ("0.5", "1.0"), ("0.2", "0.4")):
        text = text.replace(before, after)
    changed.write_text(text)
    for node_class, name, default, _ in DEFAULTS:
        arguments = ["-r", f"__ns:={namespace}", "--params-file"]
        shipped = bench.add(node_class, *arguments, str(package / "config" / "robot.yaml"))
        assert shipped.get_parameter(name).value == default
        bench.remove(shipped)
        other = bench.add(node_class, *arguments, str(changed))
        assert other.get_parameter(name).value == {2.0: 3.0, 0.1: 0.3, 0.5: 1.0, 0.2: 0.4}[default]
        bench.remove(other)
