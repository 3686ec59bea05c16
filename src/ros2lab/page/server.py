"""The server of `ros2lab dashboard`: voila in a Jupyter server of its own."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import nbformat
from jupyter_server.auth.decorator import allow_unauthenticated
from jupyter_server.auth.identity import IdentityProvider
from jupyter_server.auth.login import LoginFormHandler
from jupyter_server.base.handlers import JupyterHandler
from jupyter_server.serverapp import ServerApp
from jupyter_server.services.kernels.kernelmanager import AsyncMappingKernelManager
from jupyter_server.utils import url_path_join
from tornado import web

NOTEBOOK = "ROS 2 dashboard.ipynb"  # its name is the page's title
CELL = "from ros2lab.page import kernel\ndashboard = kernel.show()"
# What a page may ask of its kernel: to run code is not among it.
MESSAGES = [
    "comm_open",
    "comm_close",
    "comm_msg",
    "comm_info_request",
    "kernel_info_request",
    "shutdown_request",
]
LOADING_TIME = 120.0  # s, for a page to be there after its kernel has started
RECONNECTING_TIME = 10.0  # s, for a page to come back; one that is closed says so, one that crashes does not
# Of JupyterLab's extensions that are installed, those without which there is no widget.
EXTENSIONS = ["@jupyter-widgets/jupyterlab-manager", "@voila-dashboards/widgets-manager8", "anywidget"]
# voila fetches MathJax from the internet as soon as a widget shows HTML. The page shows no formula.
NO_FORMULAS = (
    "data:text/javascript,MathJax={Hub:{Config(){},Configured(){},Queue(){},Register:{StartupHook(){}}}}//"
)
ENTRANCE = "/dashboard"
ENTRANCE_PAGE = """<!DOCTYPE html><meta charset="utf-8"><title>ROS 2 dashboard</title>
<script>
  const theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  location.replace(`{page}?theme=${theme}`);
</script>
"""
REFUSED = (
    "403: this dashboard opens only with its token. "
    "Use the whole address that `ros2lab dashboard` has printed.\n"
)


def make_server(folder: Path, settings: list[str]) -> ServerApp:
    """Make the server, which does not listen yet.

    Args:
        folder: an empty one, for what the server writes.
        settings: Jupyter's options.
    """
    kernel = {"name": "python3", "display_name": "Python 3 (ipykernel)", "language": "python"}
    cells = [nbformat.v4.new_code_cell(CELL)]
    notebook = nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})
    nbformat.write(notebook, folder / NOTEBOOK)
    options = [
        *settings,
        "--ServerApp.jpserver_extensions={'voila.server_extension': True}",
        f"--ServerApp.default_url={ENTRANCE}",
        f"--ServerApp.kernel_manager_class={__name__}.PageKernels",
        f"--ServerApp.identity_provider_class={__name__}.TokenOnly",
        "--ServerApp.terminals_enabled=False",
        f"--MappingKernelManager.allowed_message_types={MESSAGES}",
        "--VoilaConfiguration.template=ros2lab",
        f"--VoilaConfiguration.extension_allowlist={EXTENSIONS}",
    ]
    app = ServerApp.instance()
    app.initialize(argv=options, find_extensions=False)
    app.web_app.settings["mathjax_url"] = NO_FORMULAS
    app.web_app.add_handlers(".*", [(ENTRANCE, Entrance)])  # type: ignore[no-untyped-call]
    return app


class PageKernels(AsyncMappingKernelManager):
    """The kernels of pages: each ends once its page is gone."""

    async def start_kernel(self, *args: Any, **kwargs: Any) -> str:  # type: ignore[override]
        """Start a kernel, which ends if no page comes."""
        kernel_id = str(await super().start_kernel(*args, **kwargs))
        self._look_after(LOADING_TIME, kernel_id)
        return kernel_id

    def notify_disconnect(self, kernel_id: str) -> None:
        """Count a connection less, and end the kernel unless the page comes back."""
        super().notify_disconnect(kernel_id)  # type: ignore[no-untyped-call]
        self._look_after(RECONNECTING_TIME, kernel_id)

    def _look_after(self, delay: float, kernel_id: str) -> None:
        loop = asyncio.get_running_loop()
        loop.call_later(delay, lambda: loop.create_task(self._end_if_alone(kernel_id)))

    async def _end_if_alone(self, kernel_id: str) -> None:
        if kernel_id in self and not self._kernel_connections.get(kernel_id):
            await self.shutdown_kernel(kernel_id)  # type: ignore[no-untyped-call]


class Entrance(JupyterHandler):
    """Leads to the page in the theme that the browser prefers, and out of the address with the token."""

    @web.authenticated
    def get(self) -> None:
        """Answer with the way to the page."""
        _ = self.xsrf_token  # sets the cookie without which the page may not say that it is closed
        self.finish(ENTRANCE_PAGE.replace("{page}", url_path_join(self.base_url, "voila/render", NOTEBOOK)))


class Refusal(LoginFormHandler):
    """Takes the place of the form for passwords and tokens."""

    @allow_unauthenticated
    def get(self) -> None:
        """Say what is missing."""
        self.set_status(403)
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(REFUSED)


class TokenOnly(IdentityProvider):
    """Lets in who has the token; nobody is asked for it."""

    login_handler_class = Refusal
