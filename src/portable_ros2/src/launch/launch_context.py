"""What is known while launching: arguments, variables, events."""

from __future__ import annotations

import asyncio
import os
from collections import deque
from collections.abc import Iterable, MutableMapping
from types import SimpleNamespace
from typing import Any

import launch.logging
from launch.event import Event
from launch.event_handler import BaseEventHandler
from launch.substitution import Substitution


class LaunchContext:
    """What entities read and change when they are visited."""

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False) -> None:
        self.argv = list(argv or [])
        self.noninteractive = noninteractive
        # Mostly texts; launch_ros also keeps lists here, which a group forgets at its end like the rest.
        self.launch_configurations: dict[str, Any] = {}
        self.is_shutdown = False
        self.asyncio_loop: asyncio.AbstractEventLoop | None = None
        self.completion_futures: list[asyncio.Future[Any]] = []
        self.something_happened: asyncio.Event | None = None
        self._event_queue: asyncio.Queue[Event] = asyncio.Queue()
        self._event_handlers: deque[BaseEventHandler] = deque()
        self._globals: dict[str, Any] = {}
        self._locals: dict[str, Any] = {}
        self._stacks: dict[str, list[dict[str, Any]]] = {
            "locals": [],
            "launch_configurations": [],
            "environment": [],
        }
        self._first_environment = dict(os.environ)
        self._logger = launch.logging.get_logger(__name__)

    @property
    def environment(self) -> MutableMapping[str, str]:
        """The environment variables that processes get."""
        return os.environ

    @property
    def locals(self) -> SimpleNamespace:
        """What is known at this place, such as the event that is handled."""
        return _Locals(**self.get_locals_as_dict())

    def get_locals_as_dict(self) -> dict[str, Any]:
        """Return what is known at this place."""
        return {**self._globals, **self._locals}

    def extend_globals(self, extensions: dict[str, Any]) -> None:
        """Add to what is known everywhere."""
        self._globals.update(extensions)

    def extend_locals(self, extensions: dict[str, Any]) -> None:
        """Add to what is known at this place, until its end."""
        self._locals.update(extensions)

    def perform_substitution(self, substitution: Substitution) -> str:
        """Return the text of a substitution."""
        return substitution.perform(self)

    def register_event_handler(self, event_handler: BaseEventHandler, append: bool = False) -> None:
        """Let a handler see the events from now on, before the other handlers unless `append` is given."""
        if append:
            self._event_handlers.append(event_handler)
        else:
            self._event_handlers.appendleft(event_handler)

    def unregister_event_handler(self, event_handler: BaseEventHandler) -> None:
        """Let a handler see no more events."""
        self._event_handlers.remove(event_handler)

    def would_handle_event(self, event: Event) -> bool:
        """Return whether there is a handler for an event."""
        return any(handler.matches(event) for handler in self._event_handlers)

    def handlers_of(self, event: Event) -> list[BaseEventHandler]:
        """Return the handlers of an event, first one first."""
        return [handler for handler in self._event_handlers if handler.matches(event)]

    async def emit_event(self, event: Event) -> None:
        """Let an event happen."""
        self.emit_event_sync(event)

    def emit_event_sync(self, event: Event) -> None:
        """Let an event happen."""
        self._logger.debug("emitting event: '%s'", event.name)
        self._event_queue.put_nowait(event)
        self.wake()

    def add_completion_future(self, completion_future: asyncio.Future[Any]) -> None:
        """Keep launching until this is done."""
        self.completion_futures.append(completion_future)
        completion_future.add_done_callback(lambda _: self.wake())

    def wake(self) -> None:
        """Let the launch service look what there is to do."""
        if self.something_happened is not None:
            self.something_happened.set()

    def has_events(self) -> bool:
        """Return whether there are events that are to be handled."""
        return not self._event_queue.empty()

    def next_event(self) -> Event | None:
        """Return the event that is to be handled next, None if there is none."""
        return self._event_queue.get_nowait() if self.has_events() else None

    def _set_asyncio_loop(self, loop: asyncio.AbstractEventLoop | None) -> None:
        self.asyncio_loop = loop

    def _push_locals(self) -> None:
        self._stacks["locals"].append(dict(self._locals))

    def _pop_locals(self) -> None:
        self._locals = self._popped("locals")

    def _push_launch_configurations(self) -> None:
        self._stacks["launch_configurations"].append(dict(self.launch_configurations))

    def _pop_launch_configurations(self) -> None:
        self.launch_configurations = self._popped("launch_configurations")

    def _push_environment(self) -> None:
        self._stacks["environment"].append(dict(os.environ))

    def _pop_environment(self) -> None:
        _set_environment(self._popped("environment"))

    def _popped(self, name: str) -> dict[str, Any]:
        if not self._stacks[name]:
            raise RuntimeError(f"{name} stack unexpectedly empty")
        return self._stacks[name].pop()

    def _reset_environment(self) -> None:
        _set_environment(self._first_environment)


class _Locals(SimpleNamespace):
    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"context.locals.{name} can only be set by context.extend_locals()")

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(
            f"context.locals does not contain attribute '{name}', it contains: [{', '.join(vars(self))}]"
        )


def _set_environment(variables: dict[str, str]) -> None:
    os.environ.clear()
    os.environ.update(variables)
