"""The parameters of other nodes, through the services that each node offers for them."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.node import _nodes
from portable_ros2.questions import Question, answers

TYPE_NAMES = (
    "not set",
    "boolean",
    "integer",
    "double",
    "string",
    "byte array",
    "boolean array",
    "integer array",
    "double array",
    "string array",
)


def add_arguments(parser: argparse.ArgumentParser, *, parameter: str | None = None) -> None:
    """Add the options and the arguments that most verbs have.

    Args:
        parser: to which they are added.
        parameter: the name of an argument for the name of one parameter, None if there is none.
    """
    graph.add_arguments(parser)
    node_name = parser.add_argument("node_name", help="Name of the ROS node")
    node_name.completer = _nodes.complete  # type: ignore[attr-defined]
    add_hidden_argument(parser)
    if parameter:
        name = parser.add_argument(parameter, help="Name of the parameter")
        name.completer = complete_parameter  # type: ignore[attr-defined]
    parser.add_argument(
        "--timeout",
        metavar="N",
        type=int,
        default=1,
        help="Wait for N seconds until node becomes available (default %(default)s sec)",
    )


def add_hidden_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that makes hidden nodes count."""
    parser.add_argument("--include-hidden-nodes", action="store_true", help="Consider hidden nodes as well")


def complete_parameter(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Return the names of the parameters of the node that was already named."""
    args = argparse.Namespace(spin_time=_nodes.COMPLETION_SPIN_TIME)
    with graph.GraphNode(args) as node:
        return names_of(node, [_nodes.absolute(parsed_args.node_name)])[0] or []


class Target(graph.GraphNode):
    """A node that knows the graph and has found the node that the arguments name.

    Args:
        args: what the options and arguments of `add_arguments` have become.

    Raises:
        RuntimeError: if there is no such node.
    """

    def __init__(self, args: argparse.Namespace) -> None:
        super().__init__(args)
        self.target = _nodes.absolute(args.node_name)
        if not _nodes.wait_for(self, self.target, args.include_hidden_nodes, args.timeout):
            self.close()
            raise RuntimeError("Node not found")

    def ask(self, verb: str, request: Any) -> Any:
        """Return the answer of one of the target's services for parameters, such as "get" or "list".

        Raises:
            RuntimeError: if the service is not there or does not answer.
        """
        return ask(self, self.target, verb, request)

    def set(self, parameters: list[Any]) -> list[Any]:
        """Set parameters one by one and return the results."""
        from rcl_interfaces.srv import SetParameters

        results = self.ask("set", SetParameters.Request(parameters=parameters)).results
        if len(results) != len(parameters):
            raise RuntimeError(f"Node {self.target} has not told about all of the parameters")
        return list(results)


def ask(node: Any, target: str, verb: str, request: Any) -> Any:
    """Return the answer of one service of one node.

    Raises:
        RuntimeError: if the service is not there or does not answer.
    """
    (answer,) = ask_all(node, [(target, verb, request)])
    if isinstance(answer, RuntimeError):
        raise answer
    return answer


def ask_all(node: Any, questions: Iterable[tuple[str, str, Any]]) -> list[Any]:
    """Ask several services for parameters at the same time.

    Args:
        node: asks.
        questions: for each a node's name, "get", "set", "list" or "describe", and the request.

    Returns:
        The answers, and where there is none a RuntimeError that tells why.
    """
    from rcl_interfaces import srv

    classes = {
        "describe": srv.DescribeParameters,
        "get": srv.GetParameters,
        "list": srv.ListParameters,
        "set": srv.SetParameters,
    }
    return answers(
        node,
        [
            Question(target, f"{target}/{verb}_parameters", classes[verb], request)
            for target, verb, request in questions
        ],
        "parameter",
    )


def names_of(node: Any, targets: list[str], prefixes: Iterable[str] = ()) -> list[Any]:
    """Return the sorted parameter names of each of some nodes, and a RuntimeError where there is no answer."""
    from rcl_interfaces.srv import ListParameters

    request = ListParameters.Request(prefixes=list(prefixes))
    found = ask_all(node, [(target, "list", request) for target in targets])
    return [answer if isinstance(answer, RuntimeError) else sorted(answer.result.names) for answer in found]


def value_from_text(text: str) -> Any:
    """Return a `ParameterValue` for a text in YAML; what is no value of a parameter is a text itself.

    Raises:
        RuntimeError: if a whole number has more than 64 bits.
    """
    import yaml
    from rcl_interfaces.msg import ParameterType, ParameterValue
    from rclpy.parameter import get_parameter_value

    try:
        parsed = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError):
        parsed = None
    whole = [item for item in (parsed if isinstance(parsed, list) else [parsed]) if isinstance(item, int)]
    if any(not -(2**63) <= number < 2**63 for number in whole):
        raise RuntimeError(f"The value {text} does not fit into 64 bits")
    if isinstance(parsed, (bool, int, float, str, list)):
        return get_parameter_value(text)
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)
