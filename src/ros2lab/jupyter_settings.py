"""The settings of JupyterLab in a student's folder: its variables, its files, and its options."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from ros2lab import course, environment, side_bar

HOST = "127.0.0.1"
FIRST_PAGE = f"{course.LESSONS}/00_welcome.ipynb"
TERMINAL_START = Path(__file__).parent / "terminal" / "jupyterlab.bash"
# What JupyterLab reads in work/.jupyter/config/labconfig: of each file its entries.
SETTINGS: dict[str, dict[str, dict[str, Any]]] = {
    # JupyterLab's own default takes cells out of the page that are out of sight, and on a busy computer a widget
    # that is slow to be made is then missing. A lesson has few enough cells to have them all there.
    "default_setting_overrides.json": {
        "@jupyterlab/notebook-extension:tracker": {"windowingMode": "defer"},
        # Without it a notebook that is opened without its kernel shows errors instead of widgets.
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
    settings = course.read_json(path)
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


def lab_settings(work: Path, *, by_a_hub: bool) -> list[str]:
    """Return JupyterLab's options."""
    # The one of JupyterHub asks the hub who may enter, and listens where that wants it.
    extensions = {**dict.fromkeys(DISABLED_SERVERS, False), "jupyterhub": by_a_hub}
    return [
        f"--ServerApp.jpserver_extensions={extensions}",
        f"--ServerApp.terminado_settings={ {'shell_command': shell_command(work)} }",
        "--ServerApp.contents_manager_class=ros2lab.contents.Contents",
        f"--LabApp.default_url={first_page(work)}",
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
        *any_server_settings(folder),
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
    return [*listening, f"--ServerApp.default_url={first_page(folder)}", *any_server_settings(folder)]


def any_server_settings(folder: Path) -> list[str]:
    """Return the options of every server, whoever starts it."""
    return [
        f"--ServerApp.root_dir={folder}",
        "--ServerApp.open_browser=False",
        "--ServerApp.allow_root=True",  # containers and CI
        "--Application.log_level=ERROR",
        # Without it every kernel warns in the terminal that other users of this computer might listen.
        "--KernelManager.transport_encryption=auto",
    ]


def first_page(work: Path) -> str:
    """Return the path below the server's address of the page to begin with."""
    return f"/lab/tree/{FIRST_PAGE}" if (work / FIRST_PAGE).is_file() else "/lab"
