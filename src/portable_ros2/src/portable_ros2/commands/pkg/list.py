"""`ros2 pkg list`."""

from __future__ import annotations

import argparse

from portable_ros2 import ament_index
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available packages."""

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        for name in sorted(ament_index.resources(ament_index.PACKAGES)):
            print(name)
