"""Whether anybody sees a widget: what nobody sees is not sent, and what it shows is not looked for.

While a cell runs, what pages say waits. Somebody may look again by then, so everything is served.
"""

from __future__ import annotations

import functools
import threading
from pathlib import Path
from typing import Any

import anywidget
import traitlets
from IPython.core.getipython import get_ipython

from ros2lab.widget_state import ending_with_its_kernel

_FOLDER = Path(__file__).parent
MOST_PAGES = 16  # remembered; one that crashed never says that it has gone


def script(*names: str) -> str:
    """Return the module of a watched widget, which is in files of these names beside this one."""
    return "\n".join((_FOLDER / f"{part}.js").read_text(encoding="utf-8") for part in ("on_screen", *names))


class _Cell:
    """Knows whether a cell runs in this kernel, from the first time that it is asked in one."""

    def __init__(self) -> None:
        self._running = threading.Event()
        shell = get_ipython()
        if shell is not None:
            self._running.set()
            shell.events.register("pre_execute", self._running.set)
            shell.events.register("post_execute", self._running.clear)

    @property
    def is_running(self) -> bool:
        """Whether one runs now."""
        return self._running.is_set()


@functools.cache
def _cell() -> _Cell:
    return _Cell()


class Watched(anywidget.AnyWidget):
    """A widget whose pages tell whether it is on the screen.

    Its module in the browser begins with `on_screen.js`; see `script`.

    Attributes:
        watchers: the pages on which somebody sees it now; None until a page has told for the first time.
    """

    watchers = traitlets.List(traitlets.Unicode(), None, allow_none=True, read_only=True).tag(sync=True)

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._cell = _cell()
        self.on_msg(self._on_page)

    def is_watched(self) -> bool:
        """Return whether somebody sees it; also as long as that is not known, and while a cell runs."""
        return self.watchers is None or bool(self.watchers) or self._cell.is_running

    def _on_page(self, _: object, content: Any, __: object) -> None:
        """Note that a page shows the widget, or that it no longer does."""
        if not isinstance(content, dict) or not isinstance(content.get("page"), str):
            return
        page, before = content["page"], self.watchers
        others = [watcher for watcher in self.watchers or () if watcher != page]
        self.set_trait("watchers", [*others, page][-MOST_PAGES:] if content.get("seen") else others)
        if bool(self.watchers) != bool(before):
            self._on_watched()

    def _on_watched(self) -> None:
        """Go on or rest, now that somebody has begun or ceased to look."""


class Lookout(Watched):
    """An invisible part of a widget that is made of others: it tells whether the card in which it is is seen.

    And it marks the card once its kernel has gone.
    """

    _esm = ending_with_its_kernel(script("lookout"))
