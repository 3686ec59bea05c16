"""What a substitution is, and the one that is only a text."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_substitutions_type import SomeSubstitutionsType


class Substitution:
    """A text that is only known while launching."""

    @classmethod
    def parse(cls, data: Iterable[SomeSubstitutionsType]) -> tuple[type[Substitution], dict[str, Any]]:  # noqa: ARG003
        """Return the class and the keyword arguments it is made with, for `$(name data ...)` of XML and YAML."""
        return cls, {}

    def describe(self) -> str:
        """Return a text for people, as `ros2 launch --show-args` shows it."""
        return repr(self)

    def perform(self, context: LaunchContext) -> str:
        """Return the text."""
        raise NotImplementedError(f"perform() is not implemented for {type(self).__name__}")


class TextSubstitution(Substitution):
    """A text that is known already."""

    def __init__(self, *, text: str) -> None:
        if not isinstance(text, str):
            raise TypeError(
                f"TextSubstitution expected 'text' to be of type 'str', but got '{text}' of type '{type(text)}'"
            )
        self.text = text

    def describe(self) -> str:
        """Return a text for people."""
        return f"'{self.text}'"

    def perform(self, context: LaunchContext) -> str:  # noqa: ARG002
        """Return the text."""
        return self.text
