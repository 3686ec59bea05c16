"""Widgets beside each other, with one picture of all of them."""

from __future__ import annotations

import ipywidgets

from ros2lab.widgets.stored_view import StoredView
from ros2lab.widgets.view_group import ViewGroup


class SideBySide(ViewGroup, ipywidgets.HBox):
    """Shows widgets of the lab beside each other; the last one gets the room that is left.

    Closing it closes them.

    Args:
        views: at least one open widget of the lab; all of one session, or of one recording.

    Raises:
        TypeError: if one of them is not a widget of the lab.
        ValueError: if there is none, one is closed, or they are not of one session or recording.
    """

    def __init__(self, *views: StoredView) -> None:
        super().__init__(views)
        self.add_class("ros2lab-side-by-side")
