"""What happens while launching."""

from __future__ import annotations

from typing import TYPE_CHECKING

from launch.event import Event
from launch.lookup import lookup

if TYPE_CHECKING:
    from launch.action import Action
    from launch.actions import TimerAction
    from launch.launch_description import LaunchDescription

__getattr__ = lookup(__name__)


class Shutdown(Event):
    """The whole system is to end."""

    name = "launch.events.Shutdown"

    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason
        self.due_to_sigint = due_to_sigint


class IncludeLaunchDescription(Event):
    """A launch description is to be visited."""

    name = "launch.events.IncludeLaunchDescription"

    def __init__(self, launch_description: LaunchDescription) -> None:
        self.launch_description = launch_description


class ExecutionComplete(Event):
    """An action is done."""

    name = "launch.events.ExecutionComplete"

    def __init__(self, *, action: Action) -> None:
        self.action = action


class TimerEvent(Event):
    """The period of a timer has passed."""

    name = "launch.events.TimerEvent"

    def __init__(self, *, timer_action: TimerAction) -> None:
        self.timer_action = timer_action


def matches_action(target_action: Action):  # type: ignore[no-untyped-def]  # noqa: ANN201
    """Return a function that tells whether an action is the one given here."""
    return lambda action: action is target_action
