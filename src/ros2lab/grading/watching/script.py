"""The commands that are sent to the node that takes them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from ros2lab.assignments import Part
from ros2lab.diagnose.sources.spelling import is_near_topic

FLOOD = 1000

Ends = Mapping[str, Mapping[str, Collection[str]]]  # types by topic and node


def topic_for(part: Part, subscribes: Ends, publishes: Ends) -> str:
    """Return the topic on which a part's commands are sent: the right one, else a likely one, else an empty name.

    A topic with publishers is less likely, for nodes talk to each other there, and one with publishers of another
    type the least.
    """
    taken = {
        topic: f"{topic} {' '.join(nodes)}"
        for topic, nodes in sorted(subscribes.items())
        if any(part.type_name in types for types in nodes.values())
    }
    if part.topic in taken:
        return part.topic
    return min(
        taken,
        key=lambda topic: (
            any(part.type_name not in types for types in publishes.get(topic, {}).values()),
            topic in publishes,
            not is_near_topic(topic, part.topic),
            not part.is_meant(taken[topic]),
        ),
        default="",
    )


class Script:
    """The commands that are sent to the node that takes them, one after the other.

    Attributes:
        flood: the name of the command that stands for very many at once.
        all: all commands.
        few: those for a node that is slow to answer, and for saying them again.
        before: unknown words that come first, as one command, when the commands are said again: an answer
            that follows them was given to the place in the sequence, and not to the word.
        first: the name of that command.
        changes: the commands that a state answers to.
        own: words of the submission's own, at which it may do what it does at no command.
    """

    def __init__(self, part: Part | None) -> None:
        self.words = words = part.commands if part else ()
        unknown = part.unknown if part else ()
        first, loud = words[:1], tuple(word.upper() for word in words[:1])
        self.flood = f"{FLOOD} x {', '.join(words[:2])}"
        self.changes = (*words, *loud)
        # Unknown words come while the robot stands and again while it moves: what follows both is no
        # reaction.
        again = [word for word in unknown if word][: len(words)]
        control = (*unknown, *first, *again)
        # The last ones tell whether the node survived the flood, and let the robot move when Ctrl-C comes.
        # There are two, because DDS sends again what a flood has crowded out when the next message comes.
        self.own = part.own if part else ()
        self.all = (*self.changes, *control, *self.own, self.flood, *first, *first) if words else ()
        self.before = part.before if part else ()
        self.first = ", ".join(self.before)
        self.few = (*first, *unknown[:1], *words[1:], *unknown[:1], *first)
