"""Actions about which other actions come, and when."""

from __future__ import annotations

import asyncio
import warnings
from collections.abc import Awaitable, Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import launch.logging
from launch.action import Action
from launch.actions.configuration import (
    PopEnvironment,
    PopLaunchConfigurations,
    PushEnvironment,
    PushLaunchConfigurations,
    ResetEnvironment,
    ResetLaunchConfigurations,
    SetLaunchConfiguration,
)
from launch.condition import Condition
from launch.event import Event
from launch.event_handler import BaseEventHandler, EventHandler
from launch.events import Shutdown as ShutdownEvent
from launch.events import TimerEvent
from launch.events.process import ProcessExited
from launch.launch_context import LaunchContext
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.launch_description_source import LaunchDescriptionSource
from launch.on_event import OnShutdown
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions import SubstitutionFailure
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

if TYPE_CHECKING:
    from launch.launch_description import LaunchDescription
    from launch.launch_description_entity import Arguments, Entities


class LogInfo(Action):
    """Writes a text."""

    def __init__(self, *, msg: SomeSubstitutionsType, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.msg = normalize_to_list_of_substitutions(msg)

    def execute(self, context: LaunchContext) -> None:
        """Write it."""
        launch.logging.get_logger("launch.user").info("%s", perform_substitutions(context, self.msg))


class OpaqueFunction(Action):
    """Calls a Python function with the context; it may return entities."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        if not callable(function):
            raise TypeError(f"OpaqueFunction expected a callable for 'function', got '{type(function)}'")
        self._function = function
        self._args = list(args or [])
        self._kwargs = dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Any:
        """Call it."""
        return self._function(context, *self._args, **self._kwargs)


class OpaqueCoroutine(Action):
    """Runs a Python coroutine function, and cancels it at the shutdown."""

    def __init__(
        self,
        *,
        coroutine: Callable[..., Awaitable[None]],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        if not asyncio.iscoroutinefunction(coroutine):
            raise TypeError(
                f"OpaqueCoroutine expected a coroutine function for 'coroutine', got '{type(coroutine)}'"
            )
        self._coroutine = coroutine
        self._args = list(args or [])
        self._kwargs = dict(kwargs or {})
        self._ignores_context = ignore_context
        self._task: asyncio.Task[None] | None = None

    def execute(self, context: LaunchContext) -> None:
        """Start it."""
        args = self._args if self._ignores_context else [context, *self._args]
        task = asyncio.ensure_future(self._coroutine(*args, **self._kwargs))
        self._task = task

        def cancel(*_: object) -> None:
            task.cancel()

        context.register_event_handler(OnShutdown(on_shutdown=cancel))

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return the task."""
        return self._task


class EmitEvent(Action):
    """Lets an event happen."""

    def __init__(self, *, event: Event, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        if not isinstance(event, Event):
            raise RuntimeError(f"EmitEvent() expected an event instance, got '{event}'.")
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Let it happen."""
        context.emit_event_sync(self.event)


class Shutdown(EmitEvent):
    """Ends the whole system."""

    def __init__(
        self, *, reason: SomeSubstitutionsType = "reason not given", condition: Condition | None = None
    ) -> None:
        self._reason = normalize_to_list_of_substitutions(reason)
        text = reason if isinstance(reason, str) else "".join(sub.describe() for sub in self._reason)
        super().__init__(event=ShutdownEvent(reason=text), condition=condition)

    def execute(self, context: LaunchContext) -> None:
        """End it."""
        cause = context.get_locals_as_dict().get("event")
        if isinstance(cause, ProcessExited):
            launch.logging.get_logger("launch").info(
                f"process[{cause.process_name}] was required: shutting down launched system"
            )
        context.emit_event_sync(ShutdownEvent(reason=perform_substitutions(context, self._reason)))


class RegisterEventHandler(Action):
    """Lets a handler see the events from now on."""

    def __init__(self, event_handler: BaseEventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it."""
        context.register_event_handler(self.event_handler)

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """Return what the handler answers."""
        text, entities = self.event_handler.describe()
        return [(text, entities)] if entities else []


class UnregisterEventHandler(Action):
    """Lets a handler see no more events."""

    def __init__(self, event_handler: BaseEventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Unregister it."""
        context.unregister_event_handler(self.event_handler)


class TimerAction(Action):
    """Executes actions after a period in seconds, unless it is cancelled before.

    They know the launch configurations that were there when it began; what they set is forgotten at their end.

    Args:
        period: seconds.
        actions: what is executed then.
        cancel_on_shutdown: whether the shutdown does not wait for it.
        condition: when there is a timer at all.
    """

    def __init__(
        self,
        *,
        period: float | SomeSubstitutionsType,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | SomeSubstitutionsType = True,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        if isinstance(period, int):
            raise TypeError(
                f"TimerAction expected 'period' to be a float or a substitution: {period}.0, not {period}"
            )
        if isinstance(period, str):
            period = float(period)
            warnings.warn(
                f"The 'period' of a TimerAction must be a float or a substitution: {period}, not a text",
                UserWarning,
                stacklevel=2,
            )
        self.period = normalize_typed_substitution(period, float)
        self.actions = list(actions)
        self._cancel_on_shutdown = normalize_typed_substitution(cancel_on_shutdown, bool)
        self._locals: dict[str, Any] = {}
        self._configurations: dict[str, Any] = {}
        self._ended: asyncio.Future[None] | None = None
        self._is_cancelled = False

    def execute(self, context: LaunchContext) -> None:
        """Start to wait."""
        loop = asyncio.get_running_loop()
        ended = self._ended = loop.create_future()
        if self._is_cancelled:
            ended.set_result(None)
            return
        self._locals = context.get_locals_as_dict()
        self._configurations = dict(context.launch_configurations)
        seconds = perform_typed_substitution(context, self.period, float)
        context.register_event_handler(
            EventHandler(
                matcher=lambda event: isinstance(event, TimerEvent) and event.timer_action is self,
                entities=OpaqueFunction(function=self._fire),
                handle_once=True,
            )
        )
        if perform_typed_substitution(context, self._cancel_on_shutdown, bool):
            context.register_event_handler(OnShutdown(on_shutdown=lambda *_: self.cancel()))

        def fire() -> None:
            if not ended.done():
                context.emit_event_sync(TimerEvent(timer_action=self))
                ended.set_result(None)

        loop.call_later(seconds, fire)

    def cancel(self) -> None:
        """Execute nothing after the period; does nothing if this is too late."""
        self._is_cancelled = True
        if self._ended is not None and not self._ended.done():
            self._ended.set_result(None)

    def _fire(self, context: LaunchContext) -> Entities:
        context.extend_locals(self._locals)
        context._push_launch_configurations()
        context.launch_configurations.clear()
        context.launch_configurations.update(self._configurations)
        return [*self.actions, PopLaunchConfigurations()]

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Return what ends with the period."""
        return self._ended

    def describe(self) -> str:
        """Return a text for people."""
        return f"TimerAction(period={self.period}, actions=<actions>)"

    def describe_conditional_sub_entities(self) -> list[tuple[str, Iterable[LaunchDescriptionEntity]]]:
        """Return the actions."""
        return [(f"{self.period} seconds pass without being canceled", self.actions)]


class GroupAction(Action):
    """Executes actions; what they set is forgotten at the end.

    Args:
        actions: the actions.
        scoped: whether launch configurations and environment variables are forgotten at the end.
        forwarding: whether they are known in the group.
        launch_configurations: what is set in the group.
        condition: when the group is executed.
    """

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, SomeSubstitutionsType] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        configurations = dict(launch_configurations or {})
        set_here = [SetLaunchConfiguration(name, value) for name, value in configurations.items()]
        before: list[LaunchDescriptionEntity] = []
        after: list[LaunchDescriptionEntity] = []
        if scoped:
            before = [PushLaunchConfigurations(), PushEnvironment()]
            after = [PopEnvironment(), PopLaunchConfigurations()]
        if scoped and not forwarding:
            before += [ResetEnvironment(), ResetLaunchConfigurations(configurations)]
        else:
            before += set_here
        self._entities = [*before, *actions, *after]

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return the actions, and what surrounds them."""
        return self._entities

    def execute(self, context: LaunchContext) -> Entities:  # noqa: ARG002
        """Return the actions, and what surrounds them."""
        return self._entities


class IncludeLaunchDescription(Action):
    """Visits another launch file.

    Args:
        launch_description_source: the file.
        launch_arguments: names and values; they become launch configurations.
        condition: when it is visited.
    """

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        condition: Condition | None = None,
    ) -> None:
        from launch.launch_description_sources import AnyLaunchDescriptionSource

        super().__init__(condition=condition)
        if not isinstance(launch_description_source, LaunchDescriptionSource):
            launch_description_source = AnyLaunchDescriptionSource(launch_description_source)
        self.launch_description_source = launch_description_source
        self.launch_arguments = tuple(launch_arguments or ())

    def get_sub_entities(self) -> list[LaunchDescriptionEntity]:
        """Return the launch description if it can be read before launching."""
        description = self.launch_description_source.try_get_launch_description_without_context()
        return [] if description is None else [description]

    def execute(self, context: LaunchContext) -> Entities:
        """Read the file; return what sets the arguments, and its launch description.

        Raises:
            RuntimeError: if a required argument is missing.
        """
        description = self.launch_description_source.get_launch_description(context)
        location = self.launch_description_source.location
        path = Path(location).absolute()
        before = context.get_locals_as_dict()
        context.extend_locals(
            {
                "current_launch_file_path": str(path),
                "current_launch_file_directory": str(path.parent) if path.exists() else location,
            }
        )
        self._check_required_arguments(context, description)
        return [
            *(SetLaunchConfiguration(name, value) for name, value in self.launch_arguments),
            description,
            OpaqueFunction(function=lambda context: context.extend_locals(before)),
        ]

    def _find_arguments(
        self, found: Arguments, includes: list[IncludeLaunchDescription], *, conditional: bool
    ) -> bool:
        return super()._find_arguments(found, [*includes, self], conditional=conditional)

    def _check_required_arguments(self, context: LaunchContext, description: LaunchDescription) -> None:
        given = self._argument_names(context)
        for argument, includes in description.get_launch_arguments_with_include_launch_description_actions():
            if argument._conditionally_included or argument.default_value is not None:
                continue
            known = [*given, *(name for include in includes for name in include._argument_names(context))]
            if argument.name not in known:
                raise RuntimeError(
                    f"Included launch description missing required argument '{argument.name}' "
                    f"(description: '{argument.description}'), given: [{', '.join(known)}]"
                )

    def _argument_names(self, context: LaunchContext) -> list[str]:
        """Return the names of the arguments that can be told now."""
        names = []
        for name, _ in self.launch_arguments:
            try:
                names.append(perform_substitutions(context, normalize_to_list_of_substitutions(name)))
            except SubstitutionFailure:
                continue
        return names
