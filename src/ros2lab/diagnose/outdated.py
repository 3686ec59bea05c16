"""An error of what ran before a file was changed."""

from __future__ import annotations

from ros2lab.diagnose.error_text import ErrorText, own_frames
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.installed import changed_sources, prefix_of
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.spots import place_of, spot_at

_AGAIN = "run the same command again"


def of_earlier(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return what to do where a file was changed since it ran into an error; None if all are as they were.

    A line that was printed is then in its file no more, or the file is not what was installed.
    """
    changed = {
        source.shown
        for package in look.packages
        if (prefix := prefix_of(look.root, package.name)) is not None
        for source, _ in changed_sources(prefix, package)
    }
    stale = next((one for one in known if one.code == "install-stale"), None)
    for frame in own_frames(error.reports[-1].frames) if error.reports else ():
        place = place_of([frame], look)
        file, spot = place.rpartition(":")[0], spot_at(place, look)
        is_own = not file.startswith(("/", "install/", "build/"))
        lines = {line.strip() for line in spot.source.text.splitlines()} if spot.source and is_own else set()
        fix = f"{stale.fix}; then {_AGAIN}" if stale else _AGAIN
        if frame.text and lines and frame.text not in lines:
            cause = f"The error is of `{frame.text}`, and that line is not in {file} any more."
            return Finding("install-stale", cause, place, fix)
        if stale and file in changed and "/install/" in frame.file:
            cause = f"{file} was changed since the last build, and the error is of what was built before."
            return Finding("install-stale", cause, file, fix)
    return None
