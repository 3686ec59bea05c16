"""Various service related sub-commands."""

from __future__ import annotations

import argparse


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the option that stands before the verb."""
    parser.add_argument(
        "--include-hidden-services", action="store_true", help="Consider hidden services as well"
    )
