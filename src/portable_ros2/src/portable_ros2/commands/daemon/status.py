"""`ros2 daemon status`."""

from __future__ import annotations

import argparse

from portable_ros2.commands.daemon import _daemon
from portable_ros2.verb import Verb


class StatusVerb(Verb):
    """Output the status of the daemon."""

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        print(f"{_daemon.NOT_RUNNING}: {_daemon.REASON}")
