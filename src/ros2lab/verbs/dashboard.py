"""`ros2lab dashboard`: robot, commands, velocities, graph and log of a running ROS 2 system in a browser."""

from __future__ import annotations

import os
import secrets
from pathlib import Path
from typing import Annotated
from urllib.parse import urlencode

import typer

from ros2lab import environment
from ros2lab.jupyter_settings import HOST, jupyter_variables, make_jupyter_folders, server_settings
from ros2lab.scratch import scratch_folder
from ros2lab.verbs.lab import LabError, check_port, has_browser, run

FIRST_PORT = 8866
PORT_RETRIES = 50


def dashboard(
    port: Annotated[
        int | None,
        typer.Option(
            help=f"The port on {HOST}; without it, the first free one from {FIRST_PORT} on.", min=0, max=65535
        ),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the browser, where there is one.")] = True,
    domain: Annotated[
        int | None,
        typer.Option(help="The ROS domain; without it, ROS_DOMAIN_ID or your own.", min=0, max=232),
    ] = None,
) -> None:
    """Show what runs in a ROS domain in the browser, and drive the robot there, without a notebook."""
    opens_browser = browser and has_browser(os.environ)
    try:
        if port is not None:
            check_port(port, "ros2lab dashboard --port ", FIRST_PORT)
        with scratch_folder() as folder:
            serve(folder, port, domain, opens_browser=opens_browser)
    except LabError as error:
        typer.echo(error, err=True)
        raise typer.Exit(1) from None
    except KeyboardInterrupt:
        raise typer.Exit(130) from None


def serve(folder: Path, port: int | None, domain: int | None, *, opens_browser: bool) -> None:
    """Serve the page in this process until it is closed.

    Args:
        folder: an empty one, for what a server writes; nothing in it is kept.
        port: on 127.0.0.1; 0 takes any free one, None the first free one from 8866 on, as near as can be.
        domain: the ROS domain; None takes `ROS_DOMAIN_ID`, or else a domain of the user's own.
        opens_browser: whether to open a browser there.

    Raises:
        LabError: if there is no ROS 2.
    """
    enter(folder, domain)
    from ros2lab.page.server import make_server  # noqa: PLC0415  # takes a second

    token = secrets.token_hex(24)
    notebooks = folder / "page"
    notebooks.mkdir()
    first, retries = (FIRST_PORT, PORT_RETRIES) if port is None else (port, 0)
    app = make_server(notebooks, server_settings(notebooks, first, token, retries=retries))
    typer.echo(f"ROS domain {os.environ['ROS_DOMAIN_ID']}: each page follows what starts and ends in it.")
    run(
        app,
        "dashboard",
        lambda: f"http://{HOST}:{app.port}/dashboard?{urlencode({'token': token})}",
        opens_browser=opens_browser,
    )


def enter(folder: Path, domain: int | None) -> None:
    """Point this process, and the kernels that it starts, at a ROS 2 and at a Jupyter of its own.

    Raises:
        LabError: if there is no ROS 2.
    """
    from ros2lab import page  # noqa: PLC0415

    if environment.find_ros().kind == "missing":
        raise LabError("There is no ROS 2 for this Python: `ros2lab doctor` tells more.")
    make_jupyter_folders(folder)
    try:
        variables = jupyter_variables(folder, environment.lab_environment())
    except RuntimeError as error:
        raise LabError(str(error)) from None
    # A kernel of a page is not one of the student's notebooks: `session.stop_others()` leaves it alone.
    variables.pop("ROS2LAB_WORK", None)
    variables["JUPYTER_PATH"] = str(Path(page.__file__).parent)  # voila's template
    if domain is not None:
        variables["ROS_DOMAIN_ID"] = str(domain)
    os.environ.clear()
    os.environ.update(variables)
