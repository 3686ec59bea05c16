"""Explains errors that come from a name that replaces or hides another one."""

from __future__ import annotations

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText, own_frames
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at
from ros2lab.diagnose.sources.interfaces import members_of


def taken_from_rclpy(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the file of an error hides a member of Node; None if there is none."""
    frames = error.report.frames if error.report else ()
    own = own_frames(frames)
    if not own or frames[-1] in own:
        return None
    file = place_of(own[:1], look).rpartition(":")[0]
    return next(
        (
            finding
            for finding in known
            if finding.code == "node-property" and finding.place.startswith(f"{file}:")
        ),
        None,
    )


def called_by_rclpy(error: ErrorText, look: Look) -> Finding | None:
    """Say that the failing method hides a method of Node that rclpy calls itself; None if it does not."""
    frames = error.report.frames if error.report else ()
    own = own_frames(frames)
    if len(own) < 2 or frames.index(own[0]) - frames.index(own[1]) < 2:  # they call each other directly
        return None
    spot = spot_at(place_of(own[:1], look), look)
    name = spot.function.name if spot.function else ""
    if (
        name.startswith("__")
        or name not in members_of("rclpy.node", "Node")[0]
        or spot.source is None
        or spot.function is None
    ):
        return None
    cause = f"Every node has a method {name}, which rclpy itself calls: this one hides it and is called too early."
    return Finding(
        "node-property",
        cause,
        spot.source.at(spot.function),
        f"rename it, for example to {name}_, also where it is used",
    )


def made_twice(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return the known finding that the failing function replaces one of the same name; else None."""
    frames = error.own
    spot = spot_at(place_of(frames, look), look) if frames else Spot(None, 0)
    if spot.source is None or spot.function is None:
        return None
    place = f"{spot.source.shown}:{spot.function.lineno}"
    return next((finding for finding in known if finding.code == "replaced" and finding.place == place), None)
