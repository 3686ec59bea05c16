"""Parameters that are numbers, with a unit and a range; a bad value never stops the node."""

from collections.abc import Sequence
from dataclasses import dataclass

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter


@dataclass(frozen=True)
class Number:
    """A parameter of type double: its default and its range, both ends included, in `unit`."""

    name: str
    default: float
    lowest: float
    highest: float
    unit: str
    meaning: str


def declare_numbers(node: Node, numbers: Sequence[Number]) -> None:
    """Declare the parameters of a node; to be called once.

    An integer is taken for a double (`period:=2`).
    What is not a finite number in the range is refused: at run time in the answer to who set it,
    at start-up in the log, and then the default holds.
    """
    names = {number.name for number in numbers}
    node.add_pre_set_parameters_callback(
        lambda parameters: [_as_double(p) if p.name in names else p for p in parameters]
    )
    for number in numbers:
        _declare(node, number)


def _declare(node: Node, number: Number) -> None:
    # rclpy raises if the start-up value is bad. So look at it first, whatever its type,
    # and then let it in by the same door as a change at run time.
    of_any_type = ParameterDescriptor(dynamic_typing=True)
    given = node.declare_parameter(number.name, number.default, of_any_type)
    node.undeclare_parameter(number.name)
    node.declare_parameter(number.name, number.default, _descriptor(number), ignore_override=True)
    (result,) = node.set_parameters([given])
    if not result.successful:
        node.get_logger().error(
            f"Refused {number.name}={given.value!r} ({result.reason}); "
            f"going on with {number.default} {number.unit}."
        )


def _descriptor(number: Number) -> ParameterDescriptor:
    return ParameterDescriptor(
        description=f"{number.meaning}, in {number.unit}",
        floating_point_range=[
            FloatingPointRange(from_value=number.lowest, to_value=number.highest),
        ],
    )


def _as_double(parameter: Parameter) -> Parameter:
    if parameter.type_ is Parameter.Type.INTEGER:
        return Parameter(parameter.name, Parameter.Type.DOUBLE, float(parameter.value))
    return parameter
