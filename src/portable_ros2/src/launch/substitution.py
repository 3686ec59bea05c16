"""What a substitution is."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext


class Substitution:
    """A text that is only known while launching."""

    def describe(self) -> str:
        """Return a text for people, as `ros2 launch --show-args` shows it."""
        return repr(self)

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        raise NotImplementedError(f"perform() is not implemented for {type(self).__name__}")
