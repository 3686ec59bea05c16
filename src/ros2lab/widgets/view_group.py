"""Widgets of the lab that are shown, closed and stored as one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import ipywidgets
import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ros2lab.widgets.stored_view import PICTURE_DPI, StoredView


class ViewGroup(StoredView, ipywidgets.Box):
    """Shows several widgets of the lab, with one picture of all of them; closing it closes them.

    Args:
        views: at least one open widget of the lab; all of one session, or of one recording.
        children: what is shown, with the views somewhere in it; None shows the views alone.
        options: of the box.

    Attributes:
        views: as above.

    Raises:
        TypeError: if one of them is not a widget of the lab.
        ValueError: if there is none, one is closed, or they are not of one session or recording.
    """

    _picture_width = math.inf  # inch

    def __init__(
        self,
        views: Sequence[StoredView],
        children: Sequence[ipywidgets.Widget] | None = None,
        **options: Any,
    ) -> None:
        self.views = check_views(views, type(self).__name__)
        super().__init__(self.views if children is None else children, **options)
        for view in self.views:
            view._container = self
        self._open_in(self.views[0].home, ", ".join(map(repr, self.views)))

    def still(self) -> Figure:
        """Draw the pictures of the widgets beside each other, and below where they find no room."""
        return tiled([view.still() for view in self.views], self._picture_width)

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return " ".join(view.description for view in self.views)

    def _stop(self) -> None:
        pass

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.views))})"


def check_views(views: Sequence[object], group: str) -> tuple[StoredView, ...]:
    """Check a constructor's argument, and return the widgets.

    Raises:
        TypeError: if one of them is not a widget of the lab.
        ValueError: if there is none, one is closed, or they are not of one session or recording.
    """
    checked: list[StoredView] = []
    for view in views:
        if not isinstance(view, StoredView):
            raise TypeError(f"{group} takes widgets of the lab, not {view!r}.")
        if view.is_closed:
            raise ValueError(f"{view!r} is closed; make a new one.")
        checked.append(view)
    if not checked:
        raise ValueError(f"{group} takes at least one widget, such as a CommandPanel or a TwistPlot.")
    if any(view.home is not checked[0].home for view in checked):
        raise ValueError(f"{group} takes widgets of one session, or of one recording.")
    return tuple(checked)


def tiled(figures: Sequence[Figure], width: float = math.inf) -> Figure:
    """Put figures together: beside each other, in as many rows as it takes.

    Args:
        figures: at least one.
        width: how wide a row may be, in inches; a figure that is wider has a row of its own.
    """
    rows: list[list[npt.NDArray[np.uint8]]] = [[]]
    for picture in map(_pixels, figures):
        if rows[-1] and _width([*rows[-1], picture]) > width * PICTURE_DPI:
            rows.append([])
        rows[-1].append(picture)
    heights = [max(picture.shape[0] for picture in row) for row in rows]
    size = max(map(_width, rows)) / PICTURE_DPI, sum(heights) / PICTURE_DPI
    figure = Figure(figsize=size, dpi=PICTURE_DPI)
    for number, row in enumerate(rows):
        top = sum(heights[number:])
        for column, picture in enumerate(row):
            left, bottom = _width(row[:column]), top - picture.shape[0]
            figure.figimage(picture, xo=left, yo=bottom, origin="upper")
    return figure


def _width(row: Sequence[npt.NDArray[np.uint8]]) -> int:
    return sum(picture.shape[1] for picture in row)


def _pixels(figure: Figure) -> npt.NDArray[np.uint8]:
    """Return a figure as an array of shape (height, width, 4), of bytes."""
    figure.set_dpi(PICTURE_DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]


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
