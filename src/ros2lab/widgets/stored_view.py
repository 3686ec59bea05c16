"""What the lab's widgets have in common: their place in a session, and what they leave in the notebook.

A widget's live view needs its kernel, or its state in the notebook, which the lab's JupyterLab saves; elsewhere a
reader without one sees an error in its place, even when a picture is stored beside it. So each widget stores a
picture with its view, and takes the view out of the notebook when it closes.
"""

from __future__ import annotations

import atexit
import base64
import functools
import io
import threading
import uuid
import weakref
from collections.abc import Callable, Iterator, Sequence
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import anywidget
import ipywidgets
import traitlets
from IPython.display import display, update_display
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font
from rclpy.exceptions import InvalidTopicNameException
from rclpy.validate_topic_name import validate_topic_name

from ros2lab.session import LabSession
from ros2lab.widget_state import WIDGET_VIEW, ending_with_its_kernel

if TYPE_CHECKING:
    Self = TypeVar("Self", bound="StoredView")

_FOLDER = Path(__file__).parent
CSS_DPI = 96  # a CSS pixel is 1/96 inch
PICTURE_DPI = 144
TEXT_SIZE = 9  # points
LETTER_WIDTH = 0.602  # of the size, in DejaVu Sans Mono


class Home(Protocol):
    """What a widget belongs to: a session, with which it closes, or a recording's file."""

    def on_close(self, callback: Callable[[], None]) -> None:
        """Have `callback` called at its end."""


_open_views: weakref.WeakKeyDictionary[Home, dict[object, StoredView]] = weakref.WeakKeyDictionary()

_exit_begun = threading.Event()


class StoredView(ipywidgets.DOMWidget):
    """A widget that leaves a picture in the notebook, and closes with its session.

    Subclasses call `_open_in` at the end of their constructor, and define `still`, `description` and `_stop`.
    """

    _is_open = False  # also of an object whose constructor raised
    _is_shown = False
    _container: StoredView | None = None  # in which it is shown, and stored

    def still(self) -> Figure:
        """Draw what the widget shows, or showed last, with matplotlib."""
        raise NotImplementedError

    @property
    def description(self) -> str:
        """What is to be seen now, in words."""
        raise NotImplementedError

    def __init_subclass__(cls, **options: Any) -> None:
        module = cls.__dict__.get("_esm")
        if isinstance(module, str | Path):  # not a trait, which it becomes of each object
            cls._esm = ending_with_its_kernel(module)
        super().__init_subclass__(**options)

    @property
    def home(self) -> Home:
        """What the widget belongs to."""
        return self._home

    @property
    def session(self) -> LabSession:
        """The session with which the widget closes.

        Raises:
            RuntimeError: if it shows a recording.
        """
        if not isinstance(self._home, LabSession):
            raise RuntimeError(f"{self!r} shows a recording, and belongs to no session.")
        return self._home

    @property
    def is_closed(self) -> bool:
        """Whether the widget has ended; its picture stays."""
        return not self._is_open

    def save(self, path: str | Path) -> Path:
        """Save the picture to a file; its ending (.png, .svg, .pdf) says in which format.

        Returns:
            The path of the file.
        """
        path = Path(path)
        self.still().savefig(path, dpi=PICTURE_DPI)
        return path

    def close(self) -> None:
        """End the widget and leave its picture in the notebook. Closing twice does no harm."""
        if self._is_open:
            self._is_open = False
            views = _open_views.get(self._home, {})
            if views.get(self._place) is self:
                del views[self._place]
            self._stop()
            self._update_stored()
        if _exit_begun.is_set():
            return  # the browser has forgotten these widgets already, and would complain
        for part in parts_of(self):
            part.close()
        super().close()

    def _stop(self) -> None:
        """Give back what the widget owns."""
        raise NotImplementedError

    def _open_in(self, home: Home, topic: str) -> None:
        """Take this place in the session, or of the recording: a predecessor of class and topic is closed."""
        _watch_for_exit()
        self._home = home
        if home not in _open_views:
            views: dict[object, StoredView] = {}
            home.on_close(lambda: _close_all(views))
            _open_views[home] = views
        self._place = type(self).__name__, topic  # not the class: anywidget makes one for each object
        self._display_id = uuid.uuid4().hex
        self._is_open = True
        predecessor = _open_views[home].get(self._place)
        if predecessor is not None:
            predecessor.close()
        _open_views[home][self._place] = self

    def _ipython_display_(self, **_: Any) -> None:
        self._is_shown = True
        data, metadata = self._bundle()
        display(data, metadata=metadata, raw=True, display_id=self._display_id)  # type: ignore[no-untyped-call]

    def _update_stored(self) -> None:
        """Bring what is stored in the notebook up to date."""
        if self._is_shown and not _exit_begun.is_set():
            data, metadata = self._bundle()
            update_display(data, metadata=metadata, raw=True, display_id=self._display_id)  # type: ignore[no-untyped-call]

    def _bundle(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return what is stored in the notebook, by MIME type, and its metadata."""
        figure = self.still()
        width, height = (round(length * CSS_DPI) for length in figure.get_size_inches())
        # The text says nothing of the data: nbval compares it with that of another run.
        data: dict[str, Any] = {"text/plain": repr(self), "image/png": _png(figure)}
        if self._is_open:
            data[WIDGET_VIEW] = {"version_major": 2, "version_minor": 0, "model_id": self.model_id}
        return data, {"image/png": {"width": width, "height": height, "alt": self.description}}

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class PausingView(StoredView):
    """A stored view of what goes on, which may stand still.

    Attributes:
        paused: whether it stands still.
    """

    paused = traitlets.Bool(False).tag(sync=True)

    def pause(self) -> None:
        """Let the picture stand still, and store it in the notebook."""
        self.paused = True

    def resume(self) -> None:
        """Go on, with everything that came in the meantime."""
        self.paused = False

    @traitlets.observe("paused")
    def _on_paused(self, _: object) -> None:
        if self.paused:
            self._update_stored()
            if self._container is not None:
                self._container._update_stored()


def check_session(session: object, widget: str) -> None:
    """Check a constructor's argument.

    Raises:
        TypeError: if it is not a session.
    """
    if not isinstance(session, LabSession):
        raise TypeError(f"{widget} takes a LabSession as its first argument, not {session!r}.")


def resolved(session: LabSession, topic: object) -> str:
    """Check a constructor's argument and return the topic's full name.

    Raises:
        TypeError: if it is not a text.
        ValueError: if ROS does not allow it as the name of a topic.
    """
    return str(session.node.resolve_topic_name(checked_name(topic)))


def checked_name(topic: object) -> str:
    """Check a constructor's argument and return the topic's name, as it was given.

    Raises:
        TypeError: if it is not a text.
        ValueError: if ROS does not allow it as the name of a topic.
    """
    if not isinstance(topic, str):
        raise TypeError(f"A topic is a text such as '/cmd_vel', not {topic!r}.")
    try:
        validate_topic_name(topic)
    except InvalidTopicNameException as error:
        raise ValueError(
            f"{topic!r} is no name of a topic: it is made of letters, digits, '_' and '/', "
            "and no part of it begins with a digit."
        ) from error
    return topic


def check_number(name: str, value: object, least: float, most: float, unit: str) -> float:
    """Check a constructor's argument.

    Raises:
        TypeError: if it is not a number.
        ValueError: if it is not from `least` to `most`.
    """
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} is a number in {unit}, not {value!r}.")
    number = float(value)
    if not least <= number <= most:  # also false for NaN
        raise ValueError(f"{name} must be from {least:g} to {most:g} {unit}, not {value!r}.")
    return number


def style_sheet(widget: str = "") -> str:
    """Return the style that all widgets share, and that of one, which is in a file of this name beside this one.

    Only its own: a saved notebook keeps the style with each widget.
    """
    names = ["widgets", *([widget] if widget else [])]
    return "\n".join((_FOLDER / f"{name}.css").read_text(encoding="utf-8") for name in names)


def style(widget: str = "") -> ipywidgets.HTML:
    """Return the style sheet of a widget that is made of others, as an invisible widget."""
    sheet = f"<style>{style_sheet(widget)}</style>"
    return ipywidgets.HTML(sheet, layout=ipywidgets.Layout(display="none"))


class KernelEnd(anywidget.AnyWidget):
    """An invisible part of a card that is made of stock widgets, which marks the card once its kernel has gone."""

    _esm = ending_with_its_kernel("""
        export default {
          initialize: ({ model }) => void (model.get("saved") || model.set("saved", true)),
          render: ({ el }) => void (el.style.display = "none"),
        };
    """)


def text_figure(title: str, lines: Sequence[str]) -> Figure:
    """Draw lines of text below a title; the figure is as wide as the longest."""
    texts = [_drawable(text) for text in (title, *lines)]
    columns = max(map(len, texts))
    line_height = 1.5 * TEXT_SIZE / 72  # inch
    figure = Figure(figsize=(columns * LETTER_WIDTH * TEXT_SIZE / 72 + 0.3, len(texts) * line_height + 0.3))
    height = figure.get_figheight()
    for row, text in enumerate(texts):
        figure.text(
            0.15 / figure.get_figwidth(),
            1 - (0.15 + row * line_height) / height,
            text,
            family="DejaVu Sans Mono",
            size=TEXT_SIZE,
            weight="bold" if row == 0 else "normal",
            verticalalignment="top",
            parse_math=False,
        )
    return figure


def _drawable(text: str) -> str:
    """Replace what matplotlib's font lacks, of which it would warn."""
    font = get_font(findfont("DejaVu Sans Mono"))
    return "".join(letter if font.get_char_index(ord(letter)) else "□" for letter in text)


def _png(figure: Figure) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=PICTURE_DPI)
    return base64.b64encode(buffer.getvalue()).decode()


def parts_of(widget: ipywidgets.Widget) -> Iterator[ipywidgets.Widget]:
    """Yield the widgets of which a widget is made; ipywidgets closes none of them by itself."""
    for part in (
        *getattr(widget, "children", ()),
        getattr(widget, "layout", None),
        getattr(widget, "style", None),
    ):
        if isinstance(part, ipywidgets.Widget):
            if not isinstance(part, StoredView):
                yield from parts_of(part)
            yield part


@functools.cache
def _watch_for_exit() -> None:
    """Notice the end of the kernel; registered after the session's own end, and so called before it."""
    atexit.register(_exit_begun.set)


def _close_all(views: dict[object, StoredView]) -> None:
    """Close the widgets of a session, the newest first."""
    for view in reversed(list(views.values())):
        view.close()
