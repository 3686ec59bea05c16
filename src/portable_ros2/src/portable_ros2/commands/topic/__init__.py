"""Various topic related sub-commands."""

from __future__ import annotations

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option that stands before the verb."""
    parser.add_argument("--include-hidden-topics", action="store_true", help="Consider hidden topics as well")
