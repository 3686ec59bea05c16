"""Tells publishers that a node makes when a message comes: in a run alone, only what is sent as a trial makes them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ros2lab.diagnose.nodes.topic_faults import End, ends_of
from ros2lab.diagnose.sources.uses import uses_of

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen


def is_made_by_words(seen: Seen, topic: str) -> bool:
    """Return whether the code makes a publisher of a topic only in what is called for a message or a request.

    A publisher whose topic is put together while it runs may be one of any topic.
    """
    last = topic.rpartition("/")[2]
    ends = [e for p in seen.look.packages for e in ends_of(seen.look.sources(p), unnamed=True)]
    makers = [e for e in ends if e.is_publisher and (not e.topic or e.topic.rpartition("/")[2] == last)]
    return bool(makers) and all(map(_is_called_for_messages, makers))


def _is_called_for_messages(end: End) -> bool:
    function = end.creation.function
    made = uses_of(end.sources).callbacks.get(id(function), ())
    return bool(made) and all(one.method in ("create_subscription", "create_service") for one in made)
