"""Actions about all nodes that are run after them in the same group."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.condition import Condition
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions import SubstitutionFailure
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch_ros.names import (
    InvalidNamespaceException,
    make_namespace_absolute,
    prefix_namespace,
    validate_namespace,
)
from launch_ros.parameters import evaluate_parameter_dict, normalize_parameter_dict

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class PushROSNamespace(Action):
    """Puts the nodes into a namespace, below the one they are in."""

    def __init__(self, namespace: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.namespace = normalize_to_list_of_substitutions(namespace)

    def execute(self, context: LaunchContext) -> None:
        """Push it.

        Raises:
            SubstitutionFailure: if it is no namespace.
        """
        pushed = perform_substitutions(context, self.namespace)
        previous = context.launch_configurations.get("ros_namespace")
        namespace = make_namespace_absolute(prefix_namespace(previous, pushed)) or "/"
        try:
            validate_namespace(namespace)
        except InvalidNamespaceException:
            raise SubstitutionFailure(
                "The resulting namespace is invalid: "
                f"[previous_namespace='{previous}', pushed_namespace='{pushed}']"
            ) from None
        context.launch_configurations["ros_namespace"] = namespace


class SetParameter(Action):
    """Gives a parameter to the nodes."""

    def __init__(
        self, name: SomeSubstitutionsType, value: Any, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.name = normalize_to_list_of_substitutions(name)
        self.value = value
        self._given = normalize_parameter_dict({tuple(self.name): value})

    def execute(self, context: LaunchContext) -> None:
        """Remember it."""
        given = evaluate_parameter_dict(context, self._given)
        _append(context, "global_params", *given.items())


class SetParametersFromFile(Action):
    """Gives the parameters in a YAML file to the nodes."""

    def __init__(self, filename: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._file = normalize_to_list_of_substitutions(filename)

    def execute(self, context: LaunchContext) -> None:
        """Remember the file."""
        _append(context, "global_params", str(Path(perform_substitutions(context, self._file)).absolute()))


class SetUseSimTime(SetParameter):
    """Lets the nodes follow the topic /clock."""

    def __init__(self, value: Any, *, condition: Condition | None = None) -> None:
        super().__init__("use_sim_time", value, condition=condition)


class SetRemap(Action):
    """Gives a remapping to the nodes."""

    def __init__(
        self, src: SomeSubstitutionsType, dst: SomeSubstitutionsType, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self.src = normalize_to_list_of_substitutions(src)
        self.dst = normalize_to_list_of_substitutions(dst)

    def execute(self, context: LaunchContext) -> None:
        """Remember it."""
        rule = (perform_substitutions(context, self.src), perform_substitutions(context, self.dst))
        _append(context, "ros_remaps", rule)


class SetROSLogDir(Action):
    """Lets the nodes write their log files to a folder, below the one that is set unless it is absolute."""

    def __init__(self, new_log_dir: SomeSubstitutionsType, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.log_dir = normalize_to_list_of_substitutions(new_log_dir)

    def execute(self, context: LaunchContext) -> None:
        """Set the variable that the nodes read."""
        home = os.environ.get("ROS_HOME") or "~/.ros"
        now = os.environ.get("ROS_LOG_DIR") or f"{home}/log"
        new = Path(now, perform_substitutions(context, self.log_dir)).expanduser().absolute()
        context.environment["ROS_LOG_DIR"] = str(new)


def _append(context: LaunchContext, name: str, *items: Any) -> None:
    # A new list: the one that a group remembers stays as it was.
    context.launch_configurations[name] = [*context.launch_configurations.get(name, []), *items]
