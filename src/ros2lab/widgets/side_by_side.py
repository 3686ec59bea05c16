"""Widgets beside each other, with one picture of all of them."""

from __future__ import annotations

import ipywidgets
import numpy as np
import numpy.typing as npt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ros2lab.widgets.stored_view import PICTURE_DPI, StoredView


class SideBySide(StoredView, ipywidgets.HBox):
    """Shows widgets of the lab beside each other; the last one gets the room that is left.

    Closing it closes them.

    Args:
        views: at least one open widget of the lab; all of one session.

    Raises:
        TypeError: if one of them is not a widget of the lab.
        ValueError: if there is none, one is closed, or they are not of one session.
    """

    def __init__(self, *views: StoredView) -> None:
        if not views:
            raise ValueError("SideBySide takes at least one widget, such as SideBySide(panel, plot).")
        for view in views:
            if not isinstance(view, StoredView):
                raise TypeError(f"SideBySide takes widgets of the lab, not {view!r}.")
            if view.is_closed:
                raise ValueError(f"{view!r} is closed; make a new one.")
            if view.session is not views[0].session:
                raise ValueError("SideBySide takes widgets of one session.")
        super().__init__(views)
        self.add_class("ros2lab-side-by-side")
        for view in views:
            view._container = self
        self._open_in(views[0].session, ", ".join(map(repr, views)))

    def still(self) -> Figure:
        """Draw the pictures of the widgets beside each other."""
        pictures = [_pixels(view.still()) for view in self.children]
        height = max(picture.shape[0] for picture in pictures)
        width = sum(picture.shape[1] for picture in pictures)
        figure = Figure(figsize=(width / PICTURE_DPI, height / PICTURE_DPI), dpi=PICTURE_DPI)
        left = 0
        for picture in pictures:
            figure.figimage(picture, xo=left, yo=height - picture.shape[0], origin="upper")
            left += picture.shape[1]
        return figure

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        return " ".join(view.description for view in self.children)

    def _stop(self) -> None:
        pass

    def __repr__(self) -> str:
        return f"SideBySide({', '.join(map(repr, self.children))})"


def _pixels(figure: Figure) -> npt.NDArray[np.uint8]:
    """Return a figure as an array of shape (height, width, 4), of bytes."""
    figure.set_dpi(PICTURE_DPI)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
