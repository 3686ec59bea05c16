"""What ROS calls each callback with, and which of that a callback's def lacks."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.code.bound_names import unbound_names
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.own_functions import called_function
from ros2lab.diagnose.sources.python_source import Function, PythonSource, argument, own_nodes, parameters
from ros2lab.diagnose.sources.static_value import dotted

# What ROS calls the callbacks with; a subscription's may take the message's information, too.
CALLED_WITH: Mapping[str, Sequence[str]] = {
    "create_subscription": ("msg",),
    "create_timer": (),
    "create_service": ("request", "response"),
    "ActionServer": ("goal_handle",),
}
_ACTION_SERVERS = ("rclpy.action.ActionServer", "rclpy.action.server.ActionServer")


@dataclass(frozen=True)
class CalledBack:
    """A function that ROS calls.

    Attributes:
        by: what it was given to, such as `create_timer`.
        is_bound: whether it is called as a method, so that it gets self as well.
        action: the type of the action that it executes, as that is written; empty if it executes none.
    """

    source: PythonSource
    function: Function
    by: str
    is_bound: bool
    action: str = ""

    @property
    def accepts(self) -> range:
        """How many arguments it takes, without the self that a method gets."""
        return accepted(self.function, is_method=self.is_bound)

    @property
    def lacks(self) -> list[str]:
        """The names of what it is called with and its def does not take, as its body has them."""
        wanted = CALLED_WITH[self.by]
        if self.function.decorator_list or len(wanted) < self.accepts.stop:
            return []
        own = len(parameters(self.function)) - self.is_bound
        return [*named_in_body(self.source, self.function, wanted, is_method=self.is_bound)][own:]


def accepted(function: Function | ast.Lambda, *, is_method: bool = False) -> range:
    """Return how many arguments a function accepts, without the self that a method gets."""
    most = len(parameters(function)) - is_method
    return range(max(most - len(function.args.defaults), 0), 100 if function.args.vararg else most + 1)


def named_in_body(
    source: PythonSource, function: Function, wanted: Sequence[str], *, is_method: bool
) -> Sequence[str]:
    """Return what a callback is called with, by the names of its def and, for the rest, those that its body uses."""
    own = [parameter.arg for parameter in parameters(function)][is_method:]
    rest = wanted[len(own) :]
    returned = [
        n.value.id for n in own_nodes(function) if isinstance(n, ast.Return) and isinstance(n.value, ast.Name)
    ]
    # What ROS gives is asked for its fields; a service returns its response.
    asked = {
        n.value.id
        for n in own_nodes(function)
        if isinstance(n, ast.Attribute) and isinstance(n.value, ast.Name)
    }
    fitting = asked.union(returned, wanted)
    used = sorted(unbound_names(source, function), key=lambda name: name in returned)
    if not fitting.issuperset(used):
        return [*own, *rest][: len(wanted)]
    return [*own[: len(wanted)], *(used if rest and len(used) == len(rest) else rest)]


def called_back(sources: NodeSources) -> Iterator[CalledBack]:
    """Yield the package's functions that ROS calls, once for each time that they are given to it."""
    for creation, function in sources.callbacks():
        if creation.method in CALLED_WITH:
            is_bound = isinstance(creation.given("callback"), ast.Attribute)
            yield CalledBack(creation.source, function, creation.method, is_bound)
    yield from executed(sources)


def executed(sources: NodeSources) -> Iterator[CalledBack]:
    """Yield the package's functions that execute an action."""
    for source in sources.sources.values():
        for owner, _, node in sources.scoped(source):
            if isinstance(node, ast.Call) and source.resolve(node.func) in _ACTION_SERVERS:
                given = argument(node, 3, "execute_callback")
                function = called_function(sources, source, owner, given) if given else None
                if function is not None:
                    home = next(file for file in sources.sources.values() if function in file.nodes)
                    kind = argument(node, 1, "action_type")
                    action = dotted(kind) or "" if kind else ""
                    yield CalledBack(home, function, "ActionServer", isinstance(given, ast.Attribute), action)
