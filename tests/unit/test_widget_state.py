"""Of the state of widgets a saved notebook keeps what its outputs show, and no more."""

from __future__ import annotations

import copy
from typing import Any

from ros2lab.widget_state import WIDGET_STATE, WIDGET_VIEW, keep_what_is_shown

STATES = {
    "0a": {"state": {"children": ["IPY_MODEL_0b"], "layout": "IPY_MODEL_0c"}},
    "0b": {"state": {"text": "the word IPY_MODEL_0d is not a reference"}},
    "0c": {"state": {}},
    "0d": {"state": {"children": ["IPY_MODEL_0a"]}},
}


def notebook(*shown: str) -> dict[str, Any]:
    """Return a notebook that shows widgets, with the state of those and of others."""
    outputs: list[dict[str, Any]] = [{"output_type": "stream", "text": "text"}]
    outputs += [{"data": {WIDGET_VIEW: {"model_id": name}}} for name in shown]
    saved = {WIDGET_STATE: {"version_major": 2, "state": copy.deepcopy(STATES)}}
    return {
        "cells": [{"source": "text"}, {"outputs": outputs}],
        "metadata": {"widgets": saved, "kernelspec": {}},
    }


def test_what_is_shown_is_kept_with_its_parts() -> None:
    changed = notebook("0a", "of another kernel")
    keep_what_is_shown(changed)
    assert set(changed["metadata"]["widgets"][WIDGET_STATE]["state"]) == {"0a", "0b", "0c"}
    again = copy.deepcopy(changed)
    keep_what_is_shown(again)
    assert again == changed


def test_nothing_is_left_where_nothing_is_shown() -> None:
    changed = notebook()
    keep_what_is_shown(changed)
    assert changed["metadata"] == {"kernelspec": {}}


def test_a_notebook_without_widgets_stays_as_it_is() -> None:
    plain: dict[str, Any] = {"cells": [], "metadata": {}}
    keep_what_is_shown(plain)
    assert plain == {"cells": [], "metadata": {}}
