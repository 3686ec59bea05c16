"""`ros2 lifecycle get`."""

from __future__ import annotations

import argparse
import sys

from portable_ros2.commands.lifecycle import _lifecycle
from portable_ros2.verb import Verb


class GetVerb(Verb):
    """Get lifecycle state for one or more nodes."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        purpose = "Name of the ROS node. If no name is provided, then get the state for all nodes."
        _lifecycle.add_arguments(parser, purpose=purpose, nargs="?")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        with _lifecycle.LifecycleGraph(args) as node:
            targets = node.names if node.target is None else [node.target]
            states = node.states(targets)
        for target, state in zip(targets, states, strict=True):
            if isinstance(state, RuntimeError):
                print(state, file=sys.stderr)
            else:
                before = "" if args.node_name else f"{target}: "
                print(f"{before}{state.label} [{state.id}]")
        return int(bool(args.node_name) and isinstance(states[0], RuntimeError))
