"""A Jupyter kernel as the lab's notebooks have it, without a notebook in front of it."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

from jupyter_client.blocking import BlockingKernelClient
from jupyter_client.connect import write_connection_file

CELL_TIMEOUT = 120.0  # s
STOP_TIMEOUT = 15.0  # s

# What lesson 8 does before it drives.
THREE_NODES = """
from ros2lab import LabSession, course

workspace = course.own_workspace()
assert workspace.build(show=False).is_ok
workspace.source()

from robot_controller.command_subscriber import CommandSubscriber
from robot_controller.status_publisher import StatusPublisher
from robot_controller.velocity_publisher import VelocityPublisher

session = LabSession()
for node_class in (CommandSubscriber, StatusPublisher, VelocityPublisher):
    session.run(node_class)
session.wait_for_subscribers("/robot/command")
"""


class Kernel:
    """A real ipykernel in a process of its own; cells are sent to it as JupyterLab sends them.

    Args:
        environ: its environment.
        folder: its working folder, in which its connection file lies, too.
    """

    def __init__(self, environ: Mapping[str, str], folder: Path) -> None:
        connection, _ = write_connection_file(str(folder / "kernel.json"), ip="127.0.0.1")
        self._process = subprocess.Popen(
            [sys.executable, "-m", "ipykernel_launcher", "-f", connection, "--log-level=ERROR"],
            env=environ,
            cwd=folder,
            stdout=subprocess.DEVNULL,  # advice on how to connect
            start_new_session=True,
        )
        self._client = BlockingKernelClient(connection_file=connection)
        self._client.load_connection_file()
        # Nobody reads what the kernel tells all: it would only pile up.
        self._client.start_channels(iopub=False, stdin=False, hb=False)
        try:
            self.run("")
        except BaseException:
            self.close()
            raise

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid

    def run(self, cell: str, value: str = "None", *, timeout: float = CELL_TIMEOUT) -> Any:
        """Run a cell.

        Args:
            cell: the code.
            value: an expression whose value, such as JSON can hold, is returned.
            timeout: the longest wait in s.

        Raises:
            RuntimeError: with what the cell raised.
            TimeoutError: if it does not end.
        """
        # As JSON, because IPython shortens a long list.
        expressions = {"value": f"__import__('json').dumps({value})"}
        answer = self._client.execute(
            cell, user_expressions=expressions, store_history=False, reply=True, timeout=timeout
        )["content"]
        result = answer.get("user_expressions", {}).get("value", answer)
        if result["status"] != "ok":
            raise RuntimeError(f"The kernel answered {result.get('ename')}: {result.get('evalue')}.")
        return json.loads(ast.literal_eval(result["data"]["text/plain"]))

    def close(self) -> None:
        """End the kernel as JupyterLab does."""
        self._client.shutdown()
        try:
            self._process.wait(STOP_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._client.stop_channels()

    def __enter__(self) -> Kernel:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
