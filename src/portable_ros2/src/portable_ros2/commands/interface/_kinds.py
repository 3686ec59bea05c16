"""The options that choose messages, services or actions."""

from __future__ import annotations

import argparse

from portable_ros2 import interfaces


def add_kind_arguments(parser: argparse.ArgumentParser, text: str) -> None:
    """Add the three options; `{}` in the help text becomes the kind."""
    parser.add_argument("-m", "--only-msgs", action="store_true", help=text.format("message"))
    parser.add_argument("-s", "--only-srvs", action="store_true", help=text.format("service"))
    parser.add_argument("-a", "--only-actions", action="store_true", help=text.format("action"))


def chosen_kinds(args: argparse.Namespace) -> tuple[str, ...]:
    """Return the chosen kinds; all of them if none is chosen."""
    wanted = zip(interfaces.KINDS, (args.only_msgs, args.only_srvs, args.only_actions), strict=True)
    return tuple(kind for kind, is_wanted in wanted if is_wanted) or tuple(interfaces.KINDS)


def complete_types(**_: object) -> list[str]:
    """Return the names of all types, for completion."""
    return [
        f"{package}/{name}" for package in interfaces.packages() for name in interfaces.of_package(package)
    ]
