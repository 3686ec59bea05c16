"""What an action is."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, ClassVar

from launch.condition import Condition
from launch.events import ExecutionComplete
from launch.launch_description_entity import LaunchDescriptionEntity

if TYPE_CHECKING:
    from launch.frontend import Entity, Parser
    from launch.launch_context import LaunchContext
    from launch.launch_description_entity import Entities


class Action(LaunchDescriptionEntity):
    """An entity that does something, unless its condition does not hold."""

    # The module of the tags defines it for the classes that have tags; the others inherit it.
    _keywords: ClassVar[Callable[[Entity, Parser], dict[str, Any]]]

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    @classmethod
    def parse(cls, entity: Entity, parser: Parser) -> tuple[type[Action], dict[str, Any]]:
        """Return the class and what a tag of XML or YAML says of the arguments it is made with."""
        return cls, cls._keywords(entity, parser)

    def execute(self, context: LaunchContext) -> Entities:  # noqa: ARG002
        """Do it; return the entities to be visited next."""
        return None

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return what is executed as a consequence, as far as it is known before."""
        return []

    def visit(self, context: LaunchContext) -> Entities:
        """Execute the action if its condition holds."""
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        try:
            return self.execute(context)
        finally:
            self._announce_completion(context)

    def _announce_completion(self, context: LaunchContext) -> None:
        event = ExecutionComplete(action=self)
        if not context.would_handle_event(event):
            return
        future = self.get_asyncio_future()
        if future is None:
            context.emit_event_sync(event)
        else:
            future.add_done_callback(lambda _: context.emit_event_sync(event))

    def describe_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return the entities that are visited in any case."""
        return self.get_sub_entities() if self.condition is None else []

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """Return the entities that may be visited, with the condition as a text."""
        if self.condition is None:
            return []
        return [(f"Conditionally included by {self.describe()}", self.get_sub_entities())]
