"""`ros2 interface show`."""

from __future__ import annotations

import argparse
import sys

from portable_ros2 import interfaces
from portable_ros2.commands.interface._kinds import complete_types
from portable_ros2.verb import Verb


class ShowVerb(Verb):
    """Output the interface definition."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        comments = parser.add_mutually_exclusive_group()
        comments.add_argument(
            "--all-comments",
            action="store_true",
            help="Show all comments, including for nested interface definitions",
        )
        comments.add_argument("--no-comments", action="store_true", help="Show no comments or whitespace")
        name = parser.add_argument(
            "type",
            help="Show an interface definition (e.g. 'std_msgs/msg/String'). Passing '-' reads it from stdin "
            "(e.g. 'ros2 topic type /chatter | ros2 interface show -')",
        )
        name.completer = complete_types  # type: ignore[attr-defined]

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        name = args.type
        if name == "-":
            if sys.stdin.isatty():
                parser.error("expected stdin pipe")
            name = sys.stdin.readline().strip()
        if not name:
            parser.error("the passed value is empty")
        try:
            _show(name, has_comments=not args.no_comments, has_nested_comments=args.all_comments)
        except LookupError as error:
            return str(error)
        return None


def _show(name: str, *, has_comments: bool, has_nested_comments: bool, depth: int = 0) -> None:
    """Print a definition, and below each field of another type its definition, one tab further in."""
    for line in interfaces.definition(name):
        text = line.text if has_comments else line.code
        if text or has_comments:
            print(depth * "\t" + text if text else "")
        if line.nested:
            _show(
                line.nested,
                has_comments=has_nested_comments,
                has_nested_comments=has_nested_comments,
                depth=depth + 1,
            )
