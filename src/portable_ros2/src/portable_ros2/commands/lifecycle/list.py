"""`ros2 lifecycle list`."""

from __future__ import annotations

import argparse

from portable_ros2.commands.lifecycle import _lifecycle
from portable_ros2.verb import Verb


class ListVerb(Verb):
    """Output a list of available transitions."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _lifecycle.add_arguments(parser)
        parser.add_argument("-a", "--all", action="store_true", help="Display all existing transitions")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> None:
        with _lifecycle.LifecycleGraph(args) as node:
            descriptions = node.transitions(include_all=args.all)
        for description in descriptions:
            print(f"- {description.transition.label} [{description.transition.id}]")
            print(f"\tStart: {description.start_state.label}\n\tGoal: {description.goal_state.label}")
