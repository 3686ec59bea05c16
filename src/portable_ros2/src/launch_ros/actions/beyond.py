"""Actions that go beyond this small launch_ros: a launch file may hold them, and those that are executed say so.

Many launch files have them for a case that is seldom chosen, such as `use_composition:=True`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.actions import TimerAction
from launch.lookup import refuse
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution
from launch_ros.actions.node import Node

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity
    from launch_ros.descriptions import ComposableNode


class ComposableNodeContainer(Node):
    """Would run a process into which nodes are loaded."""

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        composable_node_descriptions: Sequence[ComposableNode] | None = None,
        **node_arguments: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **node_arguments)
        self.composable_node_descriptions = composable_node_descriptions

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity] | None:  # noqa: ARG002
        """Say that there is none.

        Raises:
            NotImplementedError: always.
        """
        refuse("launch_ros.actions", "ComposableNodeContainer")


class LoadComposableNodes(Action):
    """Would load nodes into a process that runs."""

    def __init__(
        self,
        *,
        composable_node_descriptions: Sequence[ComposableNode],
        target_container: SomeSubstitutionsType | ComposableNodeContainer,
        **action_arguments: Any,
    ) -> None:
        super().__init__(**action_arguments)
        self.composable_node_descriptions = composable_node_descriptions
        self.target_container = target_container

    def execute(self, context: LaunchContext) -> None:  # noqa: ARG002
        """Say that there is none.

        Raises:
            NotImplementedError: always.
        """
        refuse("launch_ros.actions", "LoadComposableNodes")


class LifecycleNode(Node):
    """Runs a node that has states; to change them, use `ros2 lifecycle set`.

    Args:
        name: the name of the node.
        namespace: its namespace.
        autostart: whether its states would be changed until it is active.
        node_arguments: see `Node`.
    """

    is_lifecycle_node = True

    def __init__(
        self,
        *,
        name: SomeSubstitutionsType,
        namespace: SomeSubstitutionsType,
        autostart: bool | SomeSubstitutionsType = False,
        **node_arguments: Any,
    ) -> None:
        super().__init__(name=name, namespace=namespace, **node_arguments)
        self.node_autostart = normalize_typed_substitution(autostart, bool)

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity] | None:
        """Run it.

        Raises:
            NotImplementedError: if it would have to be made active.
        """
        if perform_typed_substitution(context, self.node_autostart, bool):
            refuse("launch_ros.actions", "LifecycleNode(autostart=True)")
        return super().execute(context)


class ROSTimer(TimerAction):
    """Executes actions after a period of the nodes' time, which must be that of the clock on the wall."""

    def execute(self, context: LaunchContext) -> None:
        """Start to wait.

        Raises:
            NotImplementedError: if the nodes follow the topic /clock.
        """
        if ("use_sim_time", True) in context.launch_configurations.get("global_params", []):
            refuse("launch_ros.actions", "ROSTimer")
        super().execute(context)
