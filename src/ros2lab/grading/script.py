"""The commands that are said to the node that takes them."""

from __future__ import annotations

from ros2lab.assignments import Part

FLOOD = 1000


class Script:
    """The commands that are said to the node that takes them, one after the other.

    Attributes:
        flood: the name of very many at once.
        all: of them.
        few: for a node that is slow to answer, and to say again.
        before: words that nobody knows, and that come first where the commands are said again, as one command: what
            follows a command then follows the word, and not its place among the words.
        first: the name of these.
        changes: those that a state answers to.
    """

    def __init__(self, part: Part | None) -> None:
        self.words = words = part.commands if part else ()
        unknown = part.unknown if part else ()
        first, loud = words[:1], tuple(word.upper() for word in words[:1])
        self.flood = f"{FLOOD} x {', '.join(words[:2])}"
        self.changes = (*words, *loud)
        # Unknown ones come while the robot stands, and again while it moves: what follows both is no reaction.
        again = [word for word in unknown if word][: len(words)]
        control = (*unknown, *first, *again)
        # The last ones tell whether the flood was survived, and let the robot move when Ctrl-C comes. There are
        # two, for DDS sends again what a flood has crowded out when the next one comes.
        own = part.own if part else ()
        self.all = (*self.changes, *control, *own, self.flood, *first, *first) if words else ()
        self.before = part.before if part else ()
        self.first = ", ".join(self.before)
        self.few = (*first, *unknown[:1], *words[1:], *unknown[:1], *first)
