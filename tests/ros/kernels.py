"""A real kernel of a student's notebook."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jupyter_client import BlockingKernelClient
from jupyter_client.manager import KernelManager, start_new_kernel

from deadlines import DEADLINE
from ros2lab import environment


class Kernel:
    """A notebook's kernel, as Jupyter starts it."""

    def __init__(self, work: Path, notebook: str) -> None:
        # Without what pytest says to its own kernels; and with what JupyterLab says to its.
        environ = {**environment.lab_environment(), "ROS2LAB_WORK": str(work)}
        environ |= {"JPY_SESSION_NAME": str(work / "notebooks" / notebook)}
        environ.pop("PYTEST_CURRENT_TEST", None)
        manager: tuple[KernelManager, BlockingKernelClient]
        manager = start_new_kernel(
            kernel_name="python3", env=environ, cwd=str(work), startup_timeout=DEADLINE
        )
        self._manager, self._client = manager
        self.pid = self._manager.provisioner.pid

    def run(self, code: str) -> str:
        """Run a cell and return what it prints, and why it failed."""
        printed: list[str] = []

        def hear(message: dict[str, Any]) -> None:
            content = message["content"]
            printed.append(content.get("text", "") or "\n".join(content.get("traceback", [])))

        self._client.execute_interactive(code, timeout=DEADLINE, output_hook=hear)
        return "".join(printed)

    def interrupt(self, code: str, when: str) -> tuple[str, list[str]]:
        """Run a cell, interrupt it once it has printed a text, and return what it prints and shows of an error."""
        request = self._client.execute(code)
        printed = ""
        trace: list[str] = []
        is_interrupted = False
        while True:
            message = self._client.get_iopub_msg(timeout=DEADLINE)
            if message["parent_header"].get("msg_id") != request:
                continue
            content = message["content"]
            printed += content.get("text", "")
            trace += content.get("traceback", [])
            if content.get("execution_state") == "idle":
                self._client.get_shell_msg(timeout=DEADLINE)
                return printed, trace
            if when in printed and not is_interrupted:
                is_interrupted = True
                self._manager.interrupt_kernel()

    def close(self) -> None:
        """End it, as the closing of JupyterLab does."""
        self._client.stop_channels()
        self._manager.shutdown_kernel()
