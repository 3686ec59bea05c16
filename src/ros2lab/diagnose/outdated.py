"""An error of what ran before a file was changed."""

from __future__ import annotations

from ros2lab.diagnose.error_text import ErrorText, own_frames
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.installed import changed_sources, prefix_of
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.spots import place_of, spot_at


def of_earlier(error: ErrorText, known: list[Finding], look: Look) -> Finding | None:
    """Return that an error is of an installed copy, where its file was changed since; None if none was."""
    stale = next((one for one in known if one.code == "install-stale"), None)
    frames = own_frames(error.reports[-1].frames) if stale and error.reports else []
    changed = {
        source.shown
        for package in look.packages
        if frames and (prefix := prefix_of(look.root, package.name)) is not None
        for source, _ in changed_sources(prefix, package)
    }
    for frame in frames:
        place = place_of([frame], look)
        file, source = place.rpartition(":")[0], spot_at(place, look).source
        if stale is None or file not in changed or source is None or "/install/" not in frame.file:
            continue
        cause = f"{file} was changed since the last build, and the error is of what was built before."
        if frame.text and frame.text not in map(str.strip, source.text.splitlines()):
            cause = f"{cause.rstrip('.')}: `{frame.text}` is not in it any more."
        return Finding("install-stale", cause, place, f"{stale.fix}; then run the same command again")
    return None
