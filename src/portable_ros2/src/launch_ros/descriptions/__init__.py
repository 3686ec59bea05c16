"""Parameters and nodes that are loaded into a process, as a launch file describes them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from launch.condition import Condition
from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions
from launch_ros.names import normalize_remap_rules
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from launch_ros.parameters import normalize_parameters

__getattr__ = lookup(__name__)


class ComposableNode:
    """A node that would be loaded into a process; see `launch_ros.actions.Node` for its arguments."""

    def __init__(
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: Sequence[Any] | None = None,
        remappings: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        extra_arguments: Sequence[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        self.package = normalize_to_list_of_substitutions(package)
        self.node_plugin = normalize_to_list_of_substitutions(plugin)
        self.node_name = None if name is None else normalize_to_list_of_substitutions(name)
        self.node_namespace = None if namespace is None else normalize_to_list_of_substitutions(namespace)
        self.parameters = None if parameters is None else normalize_parameters(parameters)
        self.remappings = None if remappings is None else list(normalize_remap_rules(remappings))
        self.extra_arguments = None if extra_arguments is None else normalize_parameters(extra_arguments)
        self._condition = condition

    def condition(self) -> Condition | None:
        """Return when it would be loaded."""
        return self._condition


class ComposableLifecycleNode(ComposableNode):
    """A node with states that would be loaded into a process."""

    def __init__(self, *, autostart: bool = False, **node_arguments: Any) -> None:
        super().__init__(**node_arguments)
        self.node_autostart = autostart


__all__ = ["ComposableLifecycleNode", "ComposableNode", "Parameter", "ParameterFile", "ParameterValue"]
