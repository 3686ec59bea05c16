"""Nodes that have states, and the services by which these are asked for and changed."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from portable_ros2 import graph
from portable_ros2.commands.node import _nodes
from portable_ros2.questions import Question, answers

GET_STATE = "lifecycle_msgs/srv/GetState"


def add_arguments(
    parser: argparse.ArgumentParser, *, purpose: str = "Name of the ROS node", **name: Any
) -> None:
    """Add the options and the node's name that most verbs have; `name` is for `add_argument`."""
    graph.add_arguments(parser)
    node_name = parser.add_argument("node_name", help=purpose, **name)
    node_name.completer = _complete  # type: ignore[attr-defined]
    parser.add_argument("--include-hidden-nodes", action="store_true", help="Consider hidden nodes as well")


def nodes_of(node: Any, include_hidden: bool) -> list[str]:
    """Return the sorted names of the nodes that have states."""
    services = {name for name, types in node.get_service_names_and_types() if GET_STATE in types}
    names = {known.full_name for known in _nodes.present(node, include_hidden)}
    return sorted(name for name in names if f"{name}/get_state" in services)


class LifecycleGraph(graph.GraphNode):
    """A node that knows the graph and the nodes with states in it.

    Args:
        args: what the options and arguments of `add_arguments` have become.

    Raises:
        RuntimeError: if the node that they name is not there, or has no states.
    """

    def __init__(self, args: argparse.Namespace) -> None:
        super().__init__(args)
        self.names = nodes_of(self, args.include_hidden_nodes)
        self.target = _nodes.absolute(args.node_name) if args.node_name else None
        if self.target is not None and self.target not in self.names:
            self.close()
            raise RuntimeError("Node not found")

    def states(self, targets: Sequence[str]) -> list[Any]:
        """Return the state of each node, and a RuntimeError where there is no answer."""
        from lifecycle_msgs.srv import GetState

        asked = [Question(target, f"{target}/get_state", GetState, GetState.Request()) for target in targets]
        found = answers(self, asked, "lifecycle")
        return [answer if isinstance(answer, RuntimeError) else answer.current_state for answer in found]

    def transitions(self, *, include_all: bool = False) -> list[Any]:
        """Return the transitions that the target can make now, or all that it knows.

        Raises:
            RuntimeError: if it does not answer.
        """
        from lifecycle_msgs.srv import GetAvailableTransitions as Get

        service = "get_transition_graph" if include_all else "get_available_transitions"
        return list(self._ask(service, Get, Get.Request()).available_transitions)

    def make(self, transition: Any) -> bool:
        """Let the target make a transition; return whether it has.

        Raises:
            RuntimeError: if it does not answer.
        """
        from lifecycle_msgs.srv import ChangeState

        return bool(
            self._ask("change_state", ChangeState, ChangeState.Request(transition=transition)).success
        )

    def _ask(self, service: str, service_class: Any, request: Any) -> Any:
        assert self.target is not None
        question = Question(self.target, f"{self.target}/{service}", service_class, request)
        (answer,) = answers(self, [question], "lifecycle")
        if isinstance(answer, RuntimeError):
            raise answer
        return answer


def _complete(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    with graph.GraphNode(argparse.Namespace(spin_time=_nodes.COMPLETION_SPIN_TIME)) as node:
        return nodes_of(node, getattr(parsed_args, "include_hidden_nodes", False))
