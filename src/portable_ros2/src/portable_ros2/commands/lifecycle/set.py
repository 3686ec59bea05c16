"""`ros2 lifecycle set`."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from portable_ros2.commands.lifecycle import _lifecycle
from portable_ros2.verb import Verb


class SetVerb(Verb):
    """Trigger lifecycle state transition."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        _lifecycle.add_arguments(parser)
        transition = parser.add_argument("transition", help="The lifecycle transition")
        transition.completer = _complete_transition  # type: ignore[attr-defined]

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        with _lifecycle.LifecycleGraph(args) as node:
            available = [description.transition for description in node.transitions()]
            chosen = [
                transition
                for transition in available
                if args.transition in (transition.label, str(transition.id))
            ]
            if not chosen:
                listed = "".join(f"\n- {transition.label} [{transition.id}]" for transition in available)
                return f"Unknown transition requested, available ones are:{listed}"
            has_made_it = node.make(min(chosen, key=lambda transition: transition.label != args.transition))
        if has_made_it:
            print("Transitioning successful")
        else:
            print("Transitioning failed", file=sys.stderr)
        return None


def _complete_transition(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    try:
        with _lifecycle.LifecycleGraph(parsed_args) as node:
            return [description.transition.label for description in node.transitions()]
    except RuntimeError:
        return []
