"""Errors that come from an older build of a file that has been changed since."""

from __future__ import annotations

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import changed_sources, prefix_of
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import place_of


def of_earlier(error: ErrorText, look: Look) -> Finding | None:
    """Say that an error comes from an installed copy of a file that has changed; None if it does not."""
    own = error.own
    frames = {place_of([frame], look): frame for frame in own if "/install/" in frame.file}
    stale = (
        next((finding for finding in look.findings if finding.code == "install-stale"), None)
        if frames
        else None
    )
    if stale is None:
        return None
    prefixes = ((package, prefix_of(look.root, package.name)) for package in look.packages)
    changed = {
        source.shown: source
        for package, prefix in prefixes
        if prefix
        for source, _ in changed_sources(prefix, package)
    }
    for place, frame in frames.items():
        file = place.rpartition(":")[0]
        if file in changed:
            cause = f"{file} has changed since the last build, and the error comes from the older build."
            if frame.text and frame.text not in map(str.strip, changed[file].text.splitlines()):
                cause = f"{cause.rstrip('.')}: `{frame.text}` is no longer in it."
            return Finding("install-stale", cause, place, f"{stale.fix}; then run the same command again")
    return None
