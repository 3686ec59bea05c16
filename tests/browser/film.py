"""A picture of the lab for README: a short film of a drive."""

from __future__ import annotations

import io
import time
from pathlib import Path

from browsing import Tab
from PIL import Image
from playwright.sync_api import Locator

FRAME_PERIOD = 0.15  # s
COLOURS = 64


def film(tab: Tab, folder: Path) -> None:
    """Drive with the mouse, and save `drive.gif` in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    row = tab.page.locator(".ros2lab-side-by-side").first
    row.scroll_into_view_if_needed()
    frames: list[Image.Image] = []
    for button, seconds in (("reset", 1.5), ("start", 3.5), ("stop", 2.0), ("start", 3.0)):
        row.get_by_role("button", name=button).first.click()
        frames += shots(row, seconds)
    first, *others = [frame.quantize(COLOURS) for frame in frames]
    period_ms = round(1000 * FRAME_PERIOD)
    first.save(
        folder / "drive.gif", save_all=True, append_images=others, duration=period_ms, loop=0, optimize=True
    )


def shots(what: Locator, seconds: float) -> list[Image.Image]:
    """Take a picture of an element every `FRAME_PERIOD`."""
    taken = []
    end = time.monotonic() + seconds
    due = time.monotonic()
    while due < end:
        time.sleep(max(0.0, due - time.monotonic()))
        taken.append(Image.open(io.BytesIO(what.screenshot())).convert("RGB"))
        due += FRAME_PERIOD
    return taken
