"""`ros2lab lab`: the student's folder, and JupyterLab in it."""

from __future__ import annotations

import errno
import html
import http.client
import logging
import os
import secrets
import signal
import socket
import threading
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Annotated, Any
from urllib.parse import urlencode

import typer

from ros2lab import course, edition, environment, widget_state
from ros2lab.jupyter_settings import (
    HOST,
    any_server_settings,
    first_page,
    hub_settings,
    jupyter_variables,
    lab_settings,
    make_jupyter_folders,
    runtime_folder,
    server_settings,
)

FIRST_PORT, PORT_RETRIES = 8888, 100
ON_ANOTHER_PORT = "make lab PORT=" if environment.IS_CHECKOUT else "ros2lab lab --port "
BY_A_HUB = "JUPYTERHUB_SERVICE_URL"  # in which a JupyterHub says where the server that it starts is to listen
ENDING_TIME = 5.0  # s, for requests that are in progress at Ctrl-C

# They would take the terminal away from the student.
_TEXT_BROWSERS = ("www-browser", "links", "elinks", "lynx", "w3m")


class LabError(Exception):
    """What keeps the lab from starting: one sentence with what to do."""


def lab(
    folder: Annotated[
        Path | None, typer.Option(help="The student's folder; without it, the one you are in or ./work.")
    ] = None,
    port: Annotated[
        int | None,
        typer.Option(
            help="The port on 127.0.0.1; 0 takes any; without it, the first free one from 8888 on.",
            min=0,
            max=65535,
        ),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the browser, where there is one.")] = True,
    options: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[-- OPTIONS]",
            help="JupyterLab's own options: where it listens and who may enter, then, is theirs to say.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Open the course in JupyterLab; what you have written stays as it is."""
    work = course.work_folder() if folder is None else Path.cwd() / folder.expanduser()
    opens_browser = browser and has_browser(os.environ)
    try:
        delivery = prepare(work)
        typer.echo(f"Your folder is {work} (notebooks: {_counts(delivery)}).")
        for name, beside in delivery.beside.items():
            typer.echo(f"{name} is newer in this release: yours stays as it is, the new one is {beside}.")
        running = None if options or BY_A_HUB in os.environ else find_running(runtime_folder(work))
        if running:
            typer.echo(f"Its lab is already running:\n\n    {running.address(work)}\n")
            if opens_browser:
                open_in_browser("lab", running.address(work))
        else:
            if port is not None:
                check_port(port)
            for name in edition.restore(work / course.LESSONS):
                typer.echo(f"{name} is as it was before it was saved the last time, for that was cut off.")
            serve(work, port, options or [], opens_browser=opens_browser)
    except LabError as error:
        typer.echo(error, err=True)
        raise typer.Exit(1) from None
    except KeyboardInterrupt:
        raise typer.Exit(130) from None


class Server:
    """Where a JupyterLab listens.

    Attributes:
        port: its port on 127.0.0.1.
        token: what opens it.
    """

    def __init__(self, port: int, token: str) -> None:
        self.port = port
        self.token = token

    def address(self, work: Path) -> str:
        """Return the address that opens it, with the page to begin with."""
        return f"http://{HOST}:{self.port}{first_page(work)}?{urlencode({'token': self.token})}"

    def answers(self) -> bool:
        """Return whether it is there and takes its token."""
        connection = http.client.HTTPConnection(HOST, self.port, timeout=2)
        try:
            connection.request("GET", "/api/status", headers={"Authorization": f"token {self.token}"})
            return connection.getresponse().status == http.HTTPStatus.OK
        except (OSError, http.client.HTTPException):
            return False
        finally:
            connection.close()


def prepare(work: Path) -> edition.Delivery:
    """Make the student's folder, bring the notebooks into it, and point this process at it.

    Raises:
        LabError: if the folder cannot be written to, or an installed ROS 2 cannot be used.
    """
    try:
        course.open_work_folder(work)
        delivery = edition.deliver(work / course.LESSONS)
        make_jupyter_folders(work)
        variables = jupyter_variables(work, environment.lab_environment())
        # The second as in a terminal, whose home folder this is.
        variables |= {"ROS2LAB_WORK": str(work), "COLCON_HOME": str(work / ".colcon")}
    except OSError as error:
        place = error.filename or work
        raise LabError(
            f"{place} cannot be written ({error.strerror}): "
            f"choose another folder with `ROS2LAB_WORK=~/ros2lab-work {environment.OPEN}`."
        ) from None
    except RuntimeError as error:
        raise LabError(str(error)) from None
    os.environ.clear()
    os.environ.update(variables)
    return delivery


def _counts(delivery: edition.Delivery) -> str:
    renewed = f"{len(delivery.renewed)} renewed, " if delivery.renewed else ""
    kept = len(delivery.kept) + len(delivery.beside)
    return f"{len(delivery.new)} new, {renewed}{kept} kept as they were"


def find_running(runtime: Path) -> Server | None:
    """Return the server that is listed in `runtime` and really answers, if there is one."""
    if not any(runtime.glob("jpserver-*.json")):
        return None  # the import below takes half a second
    from jupyter_server.serverapp import list_running_servers  # noqa: PLC0415

    servers = (Server(info["port"], info["token"]) for info in list_running_servers(str(runtime)))
    return next((server for server in servers if server.answers()), None)


def check_port(port: int, remedy: str = ON_ANOTHER_PORT, default: int = FIRST_PORT) -> None:
    """Raise LabError, naming a port that would do, if nothing can listen on `port`.

    Args:
        port: on 127.0.0.1.
        remedy: the command that takes another one, without its number.
        default: a port that every user may listen on.
    """
    problem = _port_problem(port)
    if problem == errno.EADDRINUSE:
        raise LabError(f"Port {port} is used by another program: run `{remedy}{free_port(port + 1)}`.")
    if problem:
        raise LabError(f"Port {port} cannot be used ({os.strerror(problem)}): run `{remedy}{default}`.")


def free_port(first: int) -> int:
    """Return the first port from `first` on that can be listened on, or 0, which takes any."""
    return next((port for port in range(first, 65536) if not _port_problem(port)), 0)


def has_browser(environ: Mapping[str, str]) -> bool:
    """Return whether a browser with a screen can be opened from here."""
    if not any(environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")):
        return False
    try:
        name = getattr(webbrowser.get(), "name", "")
    except webbrowser.Error:
        return False
    return Path(name).name not in _TEXT_BROWSERS


def open_in_browser(name: str, address: str) -> None:
    """Open an address that holds a token, by way of a page: other users can read a browser's command line.

    Args:
        name: of what is opened; its page lies where any browser can read it, until the server ends.
        address: what the page leads to.
    """
    page = _opening_page(name)
    page.unlink(missing_ok=True)
    with os.fdopen(os.open(page, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(f'<meta http-equiv="refresh" content="0; url={html.escape(address)}">\n')
    webbrowser.open(page.as_uri())


def _opening_page(name: str) -> Path:
    folder = course.work_folder()
    return (folder if folder.is_dir() else Path.home()) / f"open_the_{name}.html"


def serve(work: Path, port: int | None, options: Sequence[str], *, opens_browser: bool) -> None:
    """Run JupyterLab in this process until it is closed.

    In this process and not in one of its own, so that the address is printed once it really listens and
    Ctrl-C is quiet from the first moment on.
    """
    token = secrets.token_hex(24)
    first, retries = (
        (FIRST_PORT, PORT_RETRIES) if port is None else (port, 0)
    )  # another user may have it already
    hub = None if options else os.environ.get(BY_A_HUB)
    if options:
        place = [*any_server_settings(work), *options]
    elif hub:
        place = hub_settings(work, hub)
    else:
        place = server_settings(work, first, token, retries=retries)
    app = _import_lab_app().initialize_server(argv=[*place, *lab_settings(work, by_a_hub=bool(hub))])
    # A lab that is started in a terminal of this one has not been asked for by a hub.
    os.environ.pop(BY_A_HUB, None)
    app.contents_manager.register_pre_save_hook(_before_saving)
    from ros2lab.side_bar import server  # noqa: PLC0415 -- takes a second, which other commands need not wait for

    server.add_to(app)

    def address() -> str:
        if options:
            return str(app.display_url)
        return os.environ.get("JUPYTERHUB_PUBLIC_URL") or hub or Server(app.port, token).address(work)

    run(app, "lab", address, opens_browser=opens_browser)


def run(app: Any, name: str, find_address: Callable[[], str], *, opens_browser: bool) -> None:
    """Run a server of Jupyter until Ctrl-C, SIGTERM or the closing of the terminal.

    Args:
        app: the server, initialized.
        name: what it is called in what is printed.
        find_address: returns what opens it, once it listens.
        opens_browser: whether to open a browser there.
    """

    def announce() -> None:
        address = find_address()
        typer.echo(f"The {name} is open at\n\n    {address}\n\nCtrl-C closes it.")
        if opens_browser:
            threading.Thread(target=open_in_browser, args=[name, address], daemon=True).start()

    def stop(_signal: int, _frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a second Ctrl-C does not wait for kernels
        logging.getLogger("asyncio").disabled = True  # it mourns what pages were about to be told
        app.stop(from_signal=True)

    for teller in (*app.log.handlers, logging.getLogger("asyncio")):
        teller.addFilter(_is_worth_telling)
    # Jupyter's own Ctrl-C asks whether one is sure, and does not know that a terminal was closed.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if number == signal.SIGINT or signal.getsignal(number) != signal.SIG_IGN:  # nohup stays nohup
            signal.signal(number, stop)
    app.io_loop.add_callback(announce)  # after the callback that binds the port
    app.start()
    app.io_loop.asyncio_loop.run_until_complete(_end_tasks())
    _opening_page(name).unlink(missing_ok=True)
    typer.echo(f"The {name} is closed.")


def _before_saving(model: dict[str, Any], **_: Any) -> None:
    if model["type"] == "notebook" and isinstance(model["content"], dict):
        widget_state.put_back(model["content"])
        widget_state.keep_what_is_shown(model["content"])


def _is_worth_telling(record: logging.LogRecord) -> bool:
    """Return whether a line belongs into the terminal.

    A page may have gone while a kernel speaks to it, as with every computer that falls asleep; it comes back by itself.
    """
    return not (record.exc_info and type(record.exc_info[1]).__name__ == "WebSocketClosedError")


async def _end_tasks() -> None:
    """Cancel what was in progress when the server stopped, as `asyncio.run` does.

    A thread in which a request has read a file ends with that request's task, and Python waits for the thread.
    """
    import asyncio  # noqa: PLC0415 -- the server has it; a verb that starts none waits for no import of it

    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.wait(tasks, timeout=ENDING_TIME)


def _import_lab_app() -> Any:
    """Import JupyterLab, which takes a second.

    Where there is a Node.js, JupyterLab asks it at import for settings that only building JupyterLab itself
    needs, which takes another second: it does not find it.
    """
    path = os.environ.get("PATH", os.defpath)
    os.environ["PATH"] = os.devnull  # an empty one would be /bin:/usr/bin
    try:
        from jupyterlab.labapp import LabApp  # type: ignore[import-untyped]  # noqa: PLC0415
    finally:
        os.environ["PATH"] = path
    return LabApp


def _port_problem(port: int) -> int:
    """Return 0 if `port` can be listened on, else the error number."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            return error.errno or errno.EADDRINUSE
    return 0
