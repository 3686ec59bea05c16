"""What the verbs of `ros2 bag` have in common: the bag that they read, and which topics they take."""

from __future__ import annotations

import argparse
import importlib.util
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from portable_ros2.bags.bag import Bag


def add_bag_argument(parser: argparse.ArgumentParser) -> None:
    """Add the bag that is read."""
    parser.add_argument("bag_path", type=_existing, help="Bag to open")
    add_storage_argument(parser)


def add_storage_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option that says how a bag is stored, of which there is one way."""
    parser.add_argument(
        "-s", "--storage", choices=("mcap",), default="mcap", help="Storage implementation of bag (mcap)"
    )


def check_library() -> None:
    """Raise RuntimeError if the library that reads and writes recordings is not installed."""
    if importlib.util.find_spec("mcap") is None:
        raise RuntimeError(
            "Recordings need the package mcap, which is not installed: pip install 'portable_ros2[bag]'."
        )


def opened(path: Path) -> Bag:
    """Return a bag.

    Raises:
        RuntimeError: if it cannot be read.
    """
    check_library()
    from portable_ros2.bags.bag import open_bag

    return open_bag(path)


def add_filter_arguments(parser: argparse.ArgumentParser, verb: str) -> None:
    """Add the options that say which topics are taken."""
    parser.add_argument("-e", "--regex", default="", help=f"{verb} only topics that contain this expression")
    parser.add_argument(
        "-x", "--exclude-regex", default="", help=f"{verb} no topics that contain this expression"
    )
    parser.add_argument(
        "--exclude-topics",
        metavar="topic",
        nargs="+",
        default=[],
        help=f"Space-delimited list of topics not to {verb.lower()}",
    )


def taken(names: Iterable[str], args: argparse.Namespace) -> list[str]:
    """Return the topics that the options of `add_filter_arguments` leave.

    Raises:
        RuntimeError: if an expression is none.
    """
    try:
        wanted, unwanted = re.compile(args.regex), re.compile(args.exclude_regex or r"(?!)")
    except re.error as error:
        raise RuntimeError(f"The regular expression is not valid: {error}") from error
    return [
        name
        for name in names
        if wanted.search(name) and not unwanted.search(name) and name not in args.exclude_topics
    ]


def _existing(text: str) -> Path:
    if not Path(text).exists():
        raise argparse.ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return Path(text)
