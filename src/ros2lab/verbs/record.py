"""`ros2lab record`: topics into a file, until Ctrl-C."""

from __future__ import annotations

import contextlib
import io
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ros2lab import environment

if TYPE_CHECKING:
    from ros2lab.session import LabSession

REFRESH_PERIOD = 0.25  # s
INTERRUPTED = 130


def record(
    topics: Annotated[
        list[str] | None, typer.Argument(help="The topics, such as /cmd_vel (default: all, also later ones).")
    ] = None,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="The file; an earlier one of this name is kept in ~/earlier."),
    ] = Path("recording.mcap"),
) -> None:
    """Record topics into a file, until Ctrl-C.

    The file is MCAP, as `ros2 bag` and Foxglove have it; `ros2lab replay` plays it, and `read_recording` reads it in a
    notebook.
    """
    from rich.console import Console  # noqa: PLC0415 -- the other verbs print no colours
    from rich.text import Text  # noqa: PLC0415

    console = Console(stderr=True, highlight=False)
    with ends_in_a_sentence("recorded"), quiet_session() as session:
        recorder = session.record(Path.cwd() / output, topics or None)
        with recorder, console.status("") as status, contextlib.suppress(KeyboardInterrupt):
            while recorder.is_recording:
                status.update(Text(f"{recorder.headline} Ctrl-C ends it."))
                time.sleep(REFRESH_PERIOD)
        typer.echo(recorder)
        if recorder.failure:
            raise typer.Exit(1)


@contextlib.contextmanager
def quiet_session() -> Iterator[LabSession]:
    """Open a session in the domain of this terminal. SIGTERM ends it as Ctrl-C does."""
    environment.enter_ros()
    from ros2lab.session import LabSession  # noqa: PLC0415 -- the other verbs need no ROS

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with contextlib.redirect_stdout(io.StringIO()):  # who else has nodes here is no news: they are recorded
        session = LabSession()
    with session:
        yield session


@contextlib.contextmanager
def ends_in_a_sentence(what: str) -> Iterator[None]:
    """End the command with one sentence where something is wrong.

    Args:
        what: what cannot be done, in one word.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise typer.Exit(INTERRUPTED) from None
    except (ImportError, OSError, ValueError, RuntimeError) as error:
        typer.echo(f"Nothing is {what}: {error}", err=True)
        raise typer.Exit(1) from None
