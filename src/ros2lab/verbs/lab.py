"""`ros2lab lab`: the student's folder, and JupyterLab in it."""

from __future__ import annotations

import errno
import html
import http.client
import json
import logging
import os
import re
import secrets
import signal
import socket
import threading
import webbrowser
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import FrameType
from typing import Annotated, Any
from urllib.parse import unquote, urlencode, urlsplit

import typer

from ros2lab import course, edition, environment, side_bar, widget_state

HOST = "127.0.0.1"
FIRST_PORT, PORT_RETRIES = 8888, 100
ON_ANOTHER_PORT = "make lab PORT=" if environment.IS_CHECKOUT else "ros2lab lab --port "
FIRST_PAGE = f"{course.LESSONS}/00_welcome.ipynb"
TERMINAL_START = Path(__file__).parents[1] / "terminal" / "jupyterlab.bash"
BY_A_HUB = "JUPYTERHUB_SERVICE_URL"  # in which a JupyterHub says where the server that it starts is to listen
ENDING_TIME = 5.0  # s, for requests that are in progress at Ctrl-C
# What JupyterLab reads in work/.jupyter/config/labconfig: of each file its entries.
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    # JupyterLab's own default takes cells out of the page that are out of sight, and on a busy computer a widget
    # that is slow to be made is then missing. A lesson has few enough cells to have them all there.
    "default_setting_overrides.json": {
        "@jupyterlab/notebook-extension:tracker": {"windowingMode": "defer"},
        # Without it a notebook that is opened without its kernel shows errors in place of widgets.
        "@jupyter-widgets/jupyterlab-manager:plugin": {"saveState": True},
    },
    "page_config.json": {
        "disabledExtensions": {
            "@jupyterlab/apputils-extension:announcements": True,  # it would ask over the first page
            # Buttons and menus for who makes a course. The edition needs nbgrader as a library, which brings both.
            "@jupyter/nbgrader": True,
            "@jupyter-notebook/lab-extension": True,
            # A button for another way to show a notebook, of the package that `ros2lab dashboard` needs.
            "@voila-dashboards/jupyterlab-preview": True,
        },
    },
}
DISABLED_SERVERS = (
    "notebook",
    "voila.server_extension",
    *(
        f"nbgrader.server_extensions.{name}"
        for name in ("formgrader", "validate_assignment", "assignment_list", "course_list")
    ),
)

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
        return f"http://{HOST}:{self.port}{_first_page(work)}?{urlencode({'token': self.token})}"

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


def jupyter_variables(work: Path, environ: Mapping[str, str]) -> dict[str, str]:
    """Return `environ` with a Jupyter whose settings are the folder's own.

    What stands in ~/.jupyter (a password, another port, extensions of another JupyterLab) was written for
    other servers; it is neither read nor changed. What a JupyterHub has set is for this one.
    """
    state = work / ".jupyter"
    result = {name: value for name, value in environ.items() if not re.match(r"JUPYTER(?!HUB_)", name)}
    result |= {
        "JUPYTER_CONFIG_DIR": str(state / "config"),
        "JUPYTER_DATA_DIR": str(state / "data"),
        "JUPYTER_RUNTIME_DIR": str(runtime_folder(work)),
        "JUPYTER_PREFER_ENV_PATH": "1",
    }
    if runtime_folder(work).stat().st_mode & 0o077:
        # Jupyter refuses to start where files cannot be made private, as on a Windows disk under WSL.
        result["JUPYTER_ALLOW_INSECURE_WRITES"] = "1"
    return result


def runtime_folder(work: Path) -> Path:
    """Return the folder in which the servers of this student's folder are listed."""
    return work / ".jupyter" / "runtime"


def make_jupyter_folders(work: Path) -> None:
    """Make the folders of this lab's Jupyter; the tokens of its servers are nobody else's to read."""
    runtime_folder(work).mkdir(mode=0o700, parents=True, exist_ok=True)
    is_migrated = work / ".jupyter" / "config" / "migrated"
    if not is_migrated.exists():  # or else Jupyter takes over what it finds of IPython 3 in the home folder
        is_migrated.parent.mkdir(exist_ok=True)
        is_migrated.touch()
    lab_config = is_migrated.with_name("labconfig")
    lab_config.mkdir(exist_ok=True)
    for name, entries in SETTINGS.items():
        _add_settings(lab_config / name, entries)


def _add_settings(path: Path, entries: Mapping[str, Mapping[str, Any]]) -> None:
    """Add what is missing to a file of settings, and keep what somebody chose there."""
    try:
        settings = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        settings = None
    if not isinstance(settings, dict):
        settings = {}
    chosen = {name: settings.get(name, {}) for name in entries}
    merged = {
        name: {**entry, **chosen[name]} if isinstance(chosen[name], dict) else chosen[name]
        for name, entry in entries.items()
    }
    if merged != chosen:
        course.write_whole(path, json.dumps({**settings, **merged}).encode())


def shell_command(work: Path) -> list[str]:
    """Return the command of JupyterLab's own terminals: a bash in the world of the notebooks' terminals.

    Jupyter would otherwise start the user's shell, and without a terminal of its own a login shell, which forgets
    PATH.
    """
    before, after = os.environ, environment.terminal_environment(work)
    unset = [word for name in before.keys() - after.keys() for word in ("-u", name)]
    changed = [f"{name}={value}" for name, value in after.items() if before.get(name) != value]
    return ["env", *unset, *changed, "bash", "--noprofile", "--rcfile", str(TERMINAL_START), "-i"]


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
        place = [*_any_server_settings(work), *options]
    elif hub:
        place = hub_settings(work, hub)
    else:
        place = server_settings(work, first, token, retries=retries)
    app = _import_lab_app().initialize_server(argv=[*place, *_settings(work, by_a_hub=bool(hub))])
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


def _settings(work: Path, *, by_a_hub: bool) -> list[str]:
    """Return JupyterLab's options."""
    # The one of JupyterHub asks the hub who may enter, and listens where that wants it.
    extensions = {**dict.fromkeys(DISABLED_SERVERS, False), "jupyterhub": by_a_hub}
    return [
        f"--ServerApp.jpserver_extensions={extensions}",
        f"--ServerApp.terminado_settings={ {'shell_command': shell_command(work)} }",
        "--ServerApp.contents_manager_class=ros2lab.contents.Contents",
        f"--LabApp.default_url={_first_page(work)}",
        f"--LabApp.extra_labextensions_path={side_bar.EXTENSIONS}",
        # Both ask the internet.
        "--LabApp.news_url=None",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
        # It would run npm, where there is one, to look for language servers of this computer.
        "--LanguageServerManager.autodetect=False",
    ]


def server_settings(folder: Path, port: int, token: str, *, retries: int = 0) -> list[str]:
    """Return the options of a server that serves a folder to one user of this computer.

    They stay within this process: `ps` does not show the token.

    Args:
        folder: what is served.
        port: where it listens.
        token: what a browser must know.
        retries: how many other ports are tried if another program listens there.
    """
    return [
        f"--ServerApp.ip={HOST}",
        f"--ServerApp.port={port}",
        f"--ServerApp.port_retries={retries}",
        f"--IdentityProvider.token={token}",
        *_any_server_settings(folder),
    ]


def hub_settings(folder: Path, address: str) -> list[str]:
    """Return the options of a server that a JupyterHub has started.

    Args:
        folder: what is served.
        address: where the hub wants it to listen; `http+unix://` and an escaped path is a socket.
    """
    place = urlsplit(address)
    listening = [f"--ServerApp.sock={unquote(place.netloc)}"] if place.scheme == "http+unix" else []
    # The hub's own default is JupyterLab without a page.
    return [*listening, f"--ServerApp.default_url={_first_page(folder)}", *_any_server_settings(folder)]


def _any_server_settings(folder: Path) -> list[str]:
    return [
        f"--ServerApp.root_dir={folder}",
        "--ServerApp.open_browser=False",
        "--ServerApp.allow_root=True",  # containers and CI
        "--Application.log_level=ERROR",
        # Without it every kernel warns in the terminal that other users of this computer might listen.
        "--KernelManager.transport_encryption=auto",
    ]


def _first_page(work: Path) -> str:
    return f"/lab/tree/{FIRST_PAGE}" if (work / FIRST_PAGE).is_file() else "/lab"


def _port_problem(port: int) -> int:
    """Return 0 if `port` can be listened on, else the error number."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            return error.errno or errno.EADDRINUSE
    return 0
