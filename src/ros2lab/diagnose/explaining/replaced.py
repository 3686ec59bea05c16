"""Explains errors that come from a name that replaces or hides another one."""

from __future__ import annotations

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.spots import spot_of
from ros2lab.diagnose.sources.interfaces import node_members


def taken_from_rclpy(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the file of an error hides a member of Node; None if there is none."""
    spot = spot_of(error.report, look)
    begin = f"{spot.file.shown}:"
    hidden = (found for found in known if found.code == "node-property" and found.place.startswith(begin))
    return next(hidden, None) if spot.line and not spot.is_innermost else None


def called_by_rclpy(error: ErrorText, look: Look) -> Finding | None:
    """Say that the failing method hides a method of Node that rclpy calls itself; None if it does not."""
    frames = error.report.frames if error.report else ()
    own = own_frames(frames)
    if len(own) < 2 or frames[max(0, frames.index(own[0]) - 1)] in own:  # they call each other directly
        return None
    spot = spot_of(error.report, look)
    name = spot.function.name if spot.function else ""
    if name.startswith("__") or name not in node_members():
        return None
    cause = f"Every node has a method {name}, which rclpy itself calls: this one hides it and is called too early."
    fix = f"rename it, for example to {name}_, also where it is used"
    return Finding("node-property", cause, spot.file.at(spot.function), fix)


def made_twice(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the failing function replaces one of the same name; else None."""
    spot = spot_of(error.report, look)
    if spot.function is None:
        return None
    place = spot.file.at(spot.function)
    return next((finding for finding in known if finding.code == "replaced" and finding.place == place), None)
