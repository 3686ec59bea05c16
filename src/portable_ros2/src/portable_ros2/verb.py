"""What a verb of the `ros2` command is: one file, one class."""

from __future__ import annotations

import argparse


class Verb:
    """A verb such as `list` in `ros2 topic list`, or a command without verbs such as `run`.

    The first line of a subclass's docstring is its help. The subclass's module is imported whenever help or
    a completion is asked for: it imports what takes long (rclpy, messages, yaml) only where it is used.

    Attributes:
        takes_bytes: whether it hands its words to another program, which may take any bytes.
    """

    takes_bytes = False

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add options and arguments; one may have an argcomplete `completer`."""

    def passes_on(self, args: argparse.Namespace) -> bool:  # noqa: ARG002 -- for those that ask it
        """Return whether it shows what other programs print, as it is."""
        return False

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int | str | None:
        """Do it.

        Returns:
            The exit code; None is 0, and a text is printed on standard error with exit code 1.

        Raises:
            RuntimeError: its text is printed on standard error, with exit code 1.
        """
        raise NotImplementedError


def summary(documented: object) -> str:
    """Return the first line of a docstring without its full stop, as help shows it."""
    return (documented.__doc__ or "").strip().partition("\n")[0].rstrip(".")
