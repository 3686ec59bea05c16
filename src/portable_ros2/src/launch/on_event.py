"""Handlers of events that actions themselves need."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from launch.event import Event
from launch.event_handler import BaseEventHandler, Handled
from launch.events import Shutdown
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_entities_type import SomeEntitiesType
from launch.utilities import normalize_to_list_of_entities

if TYPE_CHECKING:
    from launch.action import Action
    from launch.launch_context import LaunchContext

    Target = Action | Callable[[Any], bool] | None
    Answer = SomeEntitiesType | Callable[[Any, LaunchContext], Handled]


class OnActionEventBase(BaseEventHandler):
    """Answers events about an action, about some, or about all.

    Args:
        action_matcher: the action, or a function that tells whether it is meant; None means all.
        on_event: entities, or a function of event and context that returns some or None.
        target_event_cls: the class of the events.
        target_action_cls: the class of the actions.
        handle_once: only answer the first one.
    """

    def __init__(
        self,
        *,
        action_matcher: Target,
        on_event: Answer,
        target_event_cls: type[Event],
        target_action_cls: type[Action],
        handle_once: bool = False,
    ) -> None:
        self._is_meant: Callable[[Any], bool]
        if action_matcher is None:
            self._is_meant = lambda _: True
        elif callable(action_matcher):
            self._is_meant = action_matcher
        elif isinstance(action_matcher, target_action_cls):
            self._is_meant = lambda action: action is action_matcher
        else:
            raise TypeError(
                f"action_matcher must be an '{target_action_cls.__name__}' instance or a callable"
            )
        self._on_event = on_event if callable(on_event) else None
        self._entities = [] if callable(on_event) else _checked(on_event)
        self.handler_description = str(self._on_event) if self._on_event else "<actions>"
        self.matcher_description = f"event == {target_event_cls.__name__}"
        if action_matcher is not None:
            self.matcher_description += f" and {target_action_cls.__name__}(event.action)"
        super().__init__(
            matcher=lambda event: isinstance(event, target_event_cls) and self._is_meant(event.action),  # type: ignore[attr-defined]
            handle_once=handle_once,
        )

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Handle an event; return the entities to be visited."""
        super().handle(event, context)
        return self._on_event(event, context) if self._on_event else self._entities

    def describe(self) -> tuple[str, list[LaunchDescriptionEntity]]:
        """Return a text for people, and the entities to be visited as far as they are known before."""
        return super().describe()[0], list(self._entities)


class OnShutdown(BaseEventHandler):
    """Answers the end of the whole system."""

    matcher_description = "event issubclass of launch.events.Shutdown"

    def __init__(self, *, on_shutdown: Answer, handle_once: bool = False) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), handle_once=handle_once)
        self._on_shutdown = on_shutdown
        self.handler_description = str(on_shutdown)

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Handle an event; return the entities to be visited."""
        super().handle(event, context)
        return self._on_shutdown(event, context) if callable(self._on_shutdown) else self._on_shutdown


def _checked(entities: SomeEntitiesType) -> list[LaunchDescriptionEntity]:
    listed = list(entities) if isinstance(entities, Iterable) else [entities]
    for entity in listed:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(
                "expected all items in 'on_event' iterable to be of type 'LaunchDescriptionEntity' "
                f"but got '{type(entity)}'"
            )
    return normalize_to_list_of_entities(listed)
