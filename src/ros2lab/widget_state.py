"""What widgets are once their kernel has gone: in the browser, and in a saved notebook, from which JupyterLab shows them."""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"

_ASIDE = "widgets of a notebook that is not trusted"
_REFERENCE = re.compile(r'"IPY_MODEL_([0-9a-f-]+)"')
_ENDING = Path(__file__).parent / "widgets" / "kernel_end.js"


def ending_with_its_kernel(module: str | Path) -> str:
    """Return the browser's part of a widget, which stands still, and says so, once its kernel has gone.

    Args:
        module: a module, or the file that holds it; its default export is a widget of anywidget, or makes one.
    """
    source = module.read_text(encoding="utf-8") if isinstance(module, Path) else module
    own = source.replace("export default", "const ros2labWidget =", 1)
    ending = _ENDING.read_text(encoding="utf-8")
    return f"{own}\n{ending}\nexport default endingWithItsKernel(ros2labWidget);\n"


def set_aside(notebook: dict[str, Any]) -> None:
    """Hide the state of widgets in a notebook from JupyterLab, which gives it back when it saves the notebook.

    Args:
        notebook: of nbformat 4; it is changed in place.
    """
    metadata = notebook.get("metadata", {})
    if "widgets" in metadata:
        metadata[_ASIDE] = metadata.pop("widgets")


def put_back(notebook: dict[str, Any]) -> None:
    """Put the state of widgets back that was set aside, beside that of the widgets that were made since then.

    Args:
        notebook: of nbformat 4; it is changed in place.
    """
    metadata = notebook.get("metadata", {})
    before = metadata.pop(_ASIDE, None)
    if before is not None:
        now = metadata.setdefault("widgets", before)
        with contextlib.suppress(KeyError, TypeError):  # somebody else has written it
            now[WIDGET_STATE]["state"] = before[WIDGET_STATE]["state"] | now[WIDGET_STATE]["state"]


def keep_what_is_shown(notebook: dict[str, Any]) -> None:
    """Take out of a notebook the state of widgets that no output shows.

    JupyterLab saves all that it knows, also what it has read from the notebook itself, and so a notebook that is
    run with one kernel after another would grow without end.

    Args:
        notebook: of nbformat 4; it is changed in place.
    """
    metadata = notebook.get("metadata", {})
    saved = metadata.get("widgets", {}).get(WIDGET_STATE)
    if saved is None:
        return
    states: Mapping[str, Any] = saved["state"]
    wanted = [
        output["data"][WIDGET_VIEW]["model_id"]
        for cell in notebook["cells"]
        for output in cell.get("outputs", [])
        if WIDGET_VIEW in output.get("data", {})
    ]
    kept: dict[str, Any] = {}
    while wanted:
        name = wanted.pop()
        if name in states and name not in kept:
            kept[name] = states[name]
            wanted += _REFERENCE.findall(json.dumps(states[name]))
    saved["state"] = kept
    if not kept:
        del metadata["widgets"]
