"""The jobs of a shell: which program Ctrl-Z has suspended, and whether it was resumed later."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.transcript import Step

# How bash and zsh report a job: its number, its state and its command.
_TOLD = re.compile(
    r"^(?:\^Z)?\[(?P<job>\d+)\]\s*[+-]?\s+(?:\d+\s+)?(?P<state>[A-Za-z]\w*)(?:\s\([\w ]+\))?\s+(?P<command>\S.*)$"
)
_FROZEN = frozenset(("stopped", "suspended"))
_THAT_RUN = frozenset(("run", "launch"))


def frozen_faults(steps: Sequence[Step]) -> Iterator[Finding]:
    """Yield a program that is suspended at the end, or was while a command got no answer."""
    if frozen := _frozen(steps):
        cause = f"Ctrl-Z has only suspended `{frozen}`: it still exists but responds to nothing."
        fix = "type `bg` to let it continue while this terminal takes commands, or type `fg`, leave it running and use a second terminal. To end a node, press Ctrl-C, not Ctrl-Z"
        yield Finding("not-running", cause, "", fix)


def _frozen(steps: Sequence[Step]) -> str:
    jobs: dict[str, str] = {}  # suspended jobs by their numbers, the latest last
    missed: dict[str, str] = {}  # the job that was suspended when a command got no answer
    for step in steps:
        _let_go_on(step.command, jobs)
        is_asked = step.command.startswith("ros2 ") and step.command.split()[1] not in _THAT_RUN
        if is_asked and step.is_answered:
            missed.pop(step.command, None)
        elif is_asked and jobs:
            missed[step.command] = [*jobs.values()][-1]
        for told in filter(None, map(_TOLD.match, step.lines)):
            jobs.pop(told["job"], None)
            if told["state"].lower() in _FROZEN:
                jobs[told["job"]] = told["command"].strip()
    return next(iter([*missed.values(), *reversed(jobs.values())]), "")


def _let_go_on(command: str, jobs: dict[str, str]) -> None:
    """Remove the jobs that a command resumes or ends."""
    verb, *rest = command.rstrip(";& ").split() or [""]
    named = [word.removeprefix("%") for word in rest if re.fullmatch(r"%?\d+|%[+%]?", word)]
    if verb.startswith("%"):  # on its own it is short for fg
        verb, named = "fg", [verb.removeprefix("%")]
    is_signal = verb == "kill" and "-STOP" not in rest
    if verb in ("fg", "bg") or is_signal:
        current = [*jobs][-1:] if not is_signal or "%" in command else []
        for job in [number for number in named if number.isdigit()] or current:
            jobs.pop(job, None)
