"""Files as the lab's server gives them to JupyterLab."""

from __future__ import annotations

from typing import Any

from jupyter_server.services.contents.largefilemanager import AsyncLargeFileManager

from ros2lab import widget_state


class Contents(AsyncLargeFileManager):
    """Gives JupyterLab no widgets of a notebook that is not trusted, whose code it would run as it opens it.

    JupyterLab keeps the outputs of such a notebook from running anything. But it makes all widgets that are saved in
    its metadata, and one of anywidget runs its own JavaScript when it is made.
    """

    def mark_trusted_cells(self, nb: dict[str, Any], path: str = "") -> None:
        """Mark cells as trusted if the notebook is, and else set its widgets aside."""
        if not self.notary.check_signature(nb):
            widget_state.set_aside(nb)
        super().mark_trusted_cells(nb, path)  # type: ignore[no-untyped-call]
