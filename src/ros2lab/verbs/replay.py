"""`ros2lab replay`: what was recorded is published again."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from ros2lab import course
from ros2lab.verbs.record import REFRESH_PERIOD, ends_in_a_sentence, quiet_session


def replay(
    file: Annotated[Path, typer.Argument(help="The recording, such as drive.mcap.")],
    topics: Annotated[
        list[str] | None,
        typer.Argument(help="Only these topics (default: all but /rosout and /parameter_events)."),
    ] = None,
    rate: Annotated[
        float, typer.Option("--rate", "-r", help="How many times faster than recorded, from 0.1 to 100.")
    ] = 1.0,
    is_loop: Annotated[
        bool, typer.Option("--loop", "-l", help="Begin again at the end, until Ctrl-C.")
    ] = False,
) -> None:
    """Publish the messages of a recording again, with their timing. Ctrl-C ends it.

    End a drive with a message that stops the robot: it keeps the last velocity that it has received.
    """
    from rich.console import Console  # noqa: PLC0415 -- the other verbs print no colours
    from rich.text import Text  # noqa: PLC0415

    console = Console(stderr=True, highlight=False)
    with ends_in_a_sentence("replayed"), quiet_session() as session:
        path = Path.cwd() / file
        replayed = session.replay(path, rate, topics or None, loop=is_loop)
        with replayed, console.status("") as status, contextlib.suppress(KeyboardInterrupt):
            while not replayed.has_ended:
                status.update(
                    Text(
                        f"{course.shown_path(path)}: {replayed.position:.1f} of {replayed.duration:.1f} s, "
                        f"{replayed.count:,} messages. Ctrl-C ends the replay."
                    )
                )
                with contextlib.suppress(TimeoutError):
                    replayed.wait(REFRESH_PERIOD)
            replayed.wait()
        typer.echo(
            f"{course.shown_path(path)}: {replayed.count:,} messages published, up to {replayed.position:.1f} s."
        )
