"""The robot's states, the commands, and what a command does in each state; no ROS here."""

from dataclasses import dataclass
from enum import Enum

LONGEST_COMMAND = 64  # characters, spaces included
LONGEST_QUOTE = 40  # characters


class State(Enum):
    """What the robot is doing; the value is the word on `robot/state`."""

    IDLE = "idle"
    RUNNING = "running"
    STOPPED = "stopped"


class Command(Enum):
    """What the robot can be told; the value is the word on `robot/command`."""

    START = "start"
    STOP = "stop"
    RESET = "reset"


_NEXT_STATE = {
    (State.IDLE, Command.START): State.RUNNING,
    (State.RUNNING, Command.STOP): State.STOPPED,
    (State.RUNNING, Command.RESET): State.IDLE,
    (State.STOPPED, Command.START): State.RUNNING,
    (State.STOPPED, Command.RESET): State.IDLE,
}
_NOTHING_TO_DO = {
    (State.IDLE, Command.STOP): "it is not running",
    (State.IDLE, Command.RESET): "it is idle already",
    (State.RUNNING, Command.START): "it is running already",
    (State.STOPPED, Command.STOP): "it has stopped already",
}


@dataclass(frozen=True)
class Effect:
    """What a command does.

    Attributes:
        before: the state in which the command came.
        after: the state that it leads to; the same one if it changes nothing.
        reason: why it changes nothing; empty if it changes something.
    """

    before: State
    after: State
    reason: str = ""

    def __str__(self) -> str:
        """Say it in a few words for the log."""
        if self.reason:
            return f"still {self.after.value}, {self.reason}"
        return f"{self.before.value} -> {self.after.value}"


def effect_of(command: Command, state: State) -> Effect:
    """Say what a command does in a state."""
    after = _NEXT_STATE.get((state, command), state)
    return Effect(state, after, _NOTHING_TO_DO.get((state, command), ""))


def parse_command(text: str) -> Command:
    """Understand a received command; spaces around it and capitals do not matter.

    Raises:
        ValueError: the text is empty, too long or unknown; the message says so and what is
            accepted.
    """
    if len(text) > LONGEST_COMMAND:
        length = f"{len(text)} characters"
        raise ValueError(f"{quoted(text)} is too long ({length}); {_accepted(Command)}")
    word = text.strip().lower()
    if not word:
        raise ValueError(f"the command is empty; {_accepted(Command)}")
    try:
        return Command(word)
    except ValueError:
        raise ValueError(f"{quoted(text)} is not known; {_accepted(Command)}") from None


def parse_state(text: str) -> State:
    """Understand a received state.

    Raises:
        ValueError: the text is not the word for a state; the message says so and what is accepted.
    """
    try:
        return State(text)
    except ValueError:
        raise ValueError(f"{quoted(text)} is not known; {_accepted(State)}") from None


def quoted(text: str) -> str:
    """Quote a text for a log line: shortened, and with its control characters written out."""
    return repr(text if len(text) <= LONGEST_QUOTE else text[:LONGEST_QUOTE] + "…")


def _accepted(words: type[Enum]) -> str:
    return "accepted: " + ", ".join(word.value for word in words)
