"""What a launch description is made of."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

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
