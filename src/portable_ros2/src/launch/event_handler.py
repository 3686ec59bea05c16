"""What handles an event."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from launch.event import Event
from launch.some_entities_type import SomeEntitiesType
from launch.utilities import normalize_to_list_of_entities

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import LaunchDescriptionEntity

Handled = SomeEntitiesType | None


class BaseEventHandler:
    """Handles the events that match."""

    handler_description: str | None = None
    matcher_description: str | None = None

    def __init__(self, *, matcher: Callable[[Event], bool], handle_once: bool = False) -> None:
        self._matcher = matcher
        self.handle_once = handle_once

    def matches(self, event: Event) -> bool:
        """Return whether the event is handled."""
        return self._matcher(event)

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Handle an event; return the entities to be visited."""
        context.extend_locals({"event": event})
        if self.handle_once:
            context.unregister_event_handler(self)
        return None

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Return a text for people, and the entities to be visited as far as they are known before."""
        return (
            f"{type(self).__name__}(matcher='{self.matcher_description}', "
            f"handler='{self.handler_description}', handle_once={self.handle_once})",
            [],
        )


class EventHandler(BaseEventHandler):
    """Answers the events that match with entities."""

    def __init__(
        self,
        *,
        matcher: Callable[[Event], bool],
        entities: Handled = None,
        handle_once: bool = False,
    ) -> None:
        super().__init__(matcher=matcher, handle_once=handle_once)
        self.entities = entities

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Handle an event; return the entities to be visited."""
        super().handle(event, context)
        return self.entities

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Return a text for people, and the entities to be visited."""
        return super().describe()[0], normalize_to_list_of_entities(self.entities)
