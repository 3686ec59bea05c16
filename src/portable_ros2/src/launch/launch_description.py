"""What is to be launched."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import launch.logging
from launch.launch_description_entity import LaunchDescriptionEntity, find_arguments

if TYPE_CHECKING:
    from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import Arguments


class LaunchDescription(LaunchDescriptionEntity):
    """Entities, to be visited in their order."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self.entities = list(initial_entities or [])
        self.deprecated_reason = deprecated_reason

    @property
    def deprecated(self) -> bool:
        """Whether another one should be used."""
        return self.deprecated_reason is not None

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Add an entity at the end."""
        self.entities.append(entity)

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Add an action at the end."""
        self.add_entity(action)

    def visit(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Return the entities."""
        if self.deprecated_reason is not None:
            path = context.get_locals_as_dict().get("current_launch_file_path")
            text = f"launch file [{path}] is deprecated" if path else "deprecated launch description"
            launch.logging.get_logger().warning(f"{text}: {self.deprecated_reason}")
        return self.entities

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return the entities."""
        return self.entities

    def get_launch_arguments(self) -> list[DeclareLaunchArgument]:
        """Return the arguments that are declared here and in included files, as far as they can be read."""
        return [
            argument for argument, _ in self.get_launch_arguments_with_include_launch_description_actions()
        ]

    def get_launch_arguments_with_include_launch_description_actions(
        self,
    ) -> list[tuple[DeclareLaunchArgument, list[IncludeLaunchDescription]]]:
        """Return the arguments, each with the includes that lead to it."""
        found: Arguments = {}
        find_arguments(self.entities, found, [], conditional=False)
        return list(found.values())
