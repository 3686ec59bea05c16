"""Programs that look at the list of processes, and do what they should."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.elsewhere import INIT, looking
from corpus.package import COMMAND, STATUS, VELOCITY
from corpus.styles.making import style

_NAMES = {STATUS: "status_publisher", COMMAND: "command_subscriber", VELOCITY: "velocity_publisher"}

BESIDE: tuple[Case, ...] = (
    style(
        "one_of_a_kind",
        "each program ends where another one of its own name runs, which none does",
        *(looking(path, INIT, f"sees('{name}')") for path, name in _NAMES.items()),
    ),
    style(
        "waits_for_another",
        "one ends where it does not see the status publisher run; all together they do what they should",
        looking(VELOCITY, INIT, "not sees('status_publisher')"),
    ),
)
