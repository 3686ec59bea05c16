"""What a launch description is made of."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
    from launch.launch_context import LaunchContext

    # Of each name, the action that declares it and the includes that lead there.
    Arguments = dict[str, tuple[DeclareLaunchArgument, list[IncludeLaunchDescription]]]
    Entities = Iterable["LaunchDescriptionEntity"] | None


class LaunchDescriptionEntity:
    """Something to be visited while launching."""

    def visit(self, context: LaunchContext) -> Entities:  # noqa: ARG002
        """Do it; return the entities to be visited next."""
        return None

    def describe(self) -> str:
        """Return a text for people."""
        return repr(self)

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return the entities that are visited in any case."""
        return []

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """Return the entities that may be visited, with the condition as a text."""
        return []

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return what ends when the entity is done, None if a visit is all."""
        return None

    def _find_arguments(
        self, found: Arguments, includes: list[IncludeLaunchDescription], *, conditional: bool
    ) -> bool:
        """Add the arguments that are declared here; return whether one that comes later can be set, too."""
        find_arguments(self.describe_sub_entities(), found, includes, conditional=conditional)
        for _, entities in self.describe_conditional_sub_entities():
            find_arguments(entities, found, includes, conditional=True)
        return True


def find_arguments(
    entities: Iterable[LaunchDescriptionEntity],
    found: Arguments,
    includes: list[IncludeLaunchDescription],
    *,
    conditional: bool,
) -> None:
    """Add the arguments that entities declare.

    Args:
        entities: the entities.
        found: the arguments that were found before.
        includes: the includes that lead here.
        conditional: whether it is not certain that the entities are visited.
    """
    for entity in entities:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{entity}'")
        if not entity._find_arguments(found, includes, conditional=conditional):
            return
