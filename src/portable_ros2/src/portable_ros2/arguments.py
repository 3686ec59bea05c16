"""A parser of arguments that says the same on every Python: what the one of Jazzy, Python 3.12, says."""

from __future__ import annotations

import argparse
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
            raise argparse.ArgumentError(action, f"invalid choice: {value!r} (choose from {choices})")
