"""`ros2 daemon start`."""

from __future__ import annotations

import argparse

from portable_ros2.commands.daemon import _daemon
from portable_ros2.verb import Verb


class StartVerb(Verb):
    """Start the daemon if it isn't running."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument("--debug", "-d", action="store_true", help="Print debug messages")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        print(f"There is nothing to start: {_daemon.REASON}")
