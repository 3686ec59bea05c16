"""What is done when something happens."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from launch.action import Action
from launch.actions import ExecuteLocal, ExecuteProcess
from launch.event import Event
from launch.event_handler import BaseEventHandler, EventHandler, Handled
from launch.event_handlers.event_named import event_named
from launch.events import ExecutionComplete, IncludeLaunchDescription
from launch.events.process import ProcessExited, ProcessIO, ProcessStarted
from launch.lookup import lookup
from launch.on_event import OnActionEventBase, OnShutdown

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.on_event import Answer, Target

__getattr__ = lookup(__name__)


class OnProcessStart(OnActionEventBase):
    """Answers the start of a process."""

    def __init__(self, *, target_action: Target = None, on_start: Answer, handle_once: bool = False) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_start,
            target_event_cls=ProcessStarted,
            target_action_cls=ExecuteProcess,
            handle_once=handle_once,
        )


class OnProcessExit(OnActionEventBase):
    """Answers the end of a process."""

    def __init__(self, *, target_action: Target = None, on_exit: Answer, handle_once: bool = False) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_exit,
            target_event_cls=ProcessExited,
            target_action_cls=ExecuteLocal,
            handle_once=handle_once,
        )


class OnProcessIO(OnActionEventBase):
    """Answers what a process writes; `event.text` is bytes."""

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_stdin: Callable[[ProcessIO], Handled] | None = None,
        on_stdout: Callable[[ProcessIO], Handled] | None = None,
        on_stderr: Callable[[ProcessIO], Handled] | None = None,
        handle_once: bool = False,
    ) -> None:
        def answer(event: ProcessIO, _: LaunchContext) -> Handled:
            function = on_stdout if event.from_stdout else on_stderr if event.from_stderr else on_stdin
            return None if function is None else function(event)

        super().__init__(
            action_matcher=target_action,
            on_event=answer,
            target_event_cls=ProcessIO,
            target_action_cls=ExecuteLocal,
            handle_once=handle_once,
        )


class OnExecutionComplete(OnActionEventBase):
    """Answers the end of an action of any kind."""

    def __init__(
        self, *, target_action: Target = None, on_completion: Answer, handle_once: bool = False
    ) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=ExecutionComplete,
            target_action_cls=Action,
            handle_once=handle_once,
        )


class OnIncludeLaunchDescription(BaseEventHandler):
    """Answers the wish to visit a launch description with this description."""

    handler_description = "returns the launch_description in the event"
    matcher_description = "event issubclass of launch.events.IncludeLaunchDescription"

    def __init__(self, *, handle_once: bool = False) -> None:
        super().__init__(
            matcher=lambda event: isinstance(event, IncludeLaunchDescription), handle_once=handle_once
        )

    def handle(self, event: Event, context: LaunchContext) -> Handled:
        """Return the launch description."""
        super().handle(event, context)
        return [event.launch_description] if isinstance(event, IncludeLaunchDescription) else None


__all__ = [
    "BaseEventHandler",
    "EventHandler",
    "OnActionEventBase",
    "OnExecutionComplete",
    "OnIncludeLaunchDescription",
    "OnProcessExit",
    "OnProcessIO",
    "OnProcessStart",
    "OnShutdown",
    "event_named",
]
