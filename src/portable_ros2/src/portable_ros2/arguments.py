"""A parser of arguments that says the same on every Python: what the one of Jazzy, Python 3.12, says."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from typing import Any


class Formatter(argparse.RawDescriptionHelpFormatter):
    """Lay out a command's help."""

    def _format_action_invocation(self, action: argparse.Action) -> str:
        """Name the value behind each name of an option; Python 3.13 names it once, behind the last."""
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        value = self._format_args(action, self._get_default_metavar_for_optional(action))
        return ", ".join(f"{name} {value}" for name in action.option_strings)


class Parser(argparse.ArgumentParser):
    """Parse a command line."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(formatter_class=Formatter, **settings)
        self.color = False  # Python 3.14 would colour the help

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Quote the choices, as Python does no more since 3.12.8."""
        if action.choices is not None and value not in action.choices:
            choices = ", ".join(map(repr, action.choices))
            text = f"invalid choice: {value!r} (choose from {choices})"
            if isinstance(action, argparse._SubParsersAction):
                text += self._where(value, action.choices)
            raise argparse.ArgumentError(action, text)

    def _where(self, word: str, known: Iterable[str]) -> str:
        """Return which package of the real one has more words than these, unless one of these is meant."""
        import difflib

        if not re.fullmatch("[a-z][a-z_]+", word) or difflib.get_close_matches(word, known):
            return ""
        command = self.prog.partition(" ")[2]
        package = f"ros2{command}" if command else "ros2cli-common-extensions"
        return (
            f"\nThis small ros2 has no '{word}'; if the real one has it, it needs the real package "
            f"{package.replace('-', '_')}, which an installed ROS 2 brings: apt install ros-jazzy-{package}"
        )
