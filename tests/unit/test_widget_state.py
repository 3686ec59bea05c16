"""Of the state of widgets a saved notebook keeps what its outputs show, and no more."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from ros2lab.widget_state import WIDGET_STATE, WIDGET_VIEW, keep_what_is_shown, put_back, set_aside

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


def test_what_was_set_aside_comes_back_beside_what_was_made_since_then() -> None:
    changed = notebook("0a")
    set_aside(changed)
    assert "widgets" not in changed["metadata"]
    opened = copy.deepcopy(changed)
    put_back(changed)
    assert changed == notebook("0a")
    opened["metadata"]["widgets"] = {WIDGET_STATE: {"state": {"0d": {}}}}
    put_back(opened)
    assert set(opened["metadata"]["widgets"][WIDGET_STATE]["state"]) == {*STATES, "0d"}


@pytest.mark.parametrize("written", [{}, [], "text", {WIDGET_STATE: 1}, {WIDGET_STATE: {"state": None}}])
def test_widgets_that_nobody_can_have_saved_come_back_as_they_were(written: Any) -> None:
    changed = {"cells": [], "metadata": {"widgets": written}}
    set_aside(changed)
    put_back(changed)
    assert changed == {"cells": [], "metadata": {"widgets": written}}
