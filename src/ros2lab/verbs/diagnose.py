"""`ros2lab diagnose`: what is wrong with a workspace, or what an error means."""

from __future__ import annotations

import json
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ros2lab.diagnose.explaining.steps import Step, is_step_by_step, is_text_step_by_step, next_step, told

if TYPE_CHECKING:
    from ros2lab.diagnose import Finding

FOUND, USAGE_ERROR = 1, 2
LONGEST = 10_000  # characters of a text that is shown
_RUN_OFFER = "If a node does nothing, or the wrong thing, run the nodes too: ros2lab diagnose --run. "
_RAN = (
    "No certain fault was found by reading the files and running the nodes for a short time. What they did: "
)


def diagnose(
    workspace: Annotated[
        str,
        typer.Argument(
            help="The workspace's folder (default: the one around this folder), or - for the text of an error."
        ),
    ] = "",
    up_to: Annotated[
        Step | None,
        typer.Option(
            "--up-to",
            help="Say only this much, of the likeliest fault (default: all of every fault; in the workspaces of "
            "lesson 9 the cause).",
        ),
    ] = None,
    is_run: Annotated[
        bool,
        typer.Option(
            "--run",
            help="Also run what was built for a few seconds, in isolation, with made-up messages and calls where nothing sends any, and say what is silent or wrong.",
        ),
    ] = False,
    is_json: Annotated[
        bool, typer.Option("--json", help="Print a list of objects: code, cause, place, fix.")
    ] = False,
) -> None:
    """Say what is wrong with a workspace, or what an error means.

    `command 2>&1 | ros2lab diagnose -` explains what a command has printed. The likeliest cause comes first.
    The exit code is 0 if nothing was found, 1 if something was, and 2 if there is nothing to look at.
    """
    # Late, so that the other verbs of the command need not wait for it.
    from ros2lab.diagnose.look import workspace_around  # noqa: PLC0415

    here = workspace_around(Path.cwd())
    root = Path(workspace) if workspace not in ("", "-") else here
    if workspace == "-":
        findings, is_told_in_steps, looked_at = _of_printed(here)
    elif root is not None and root.is_dir():
        findings, is_told_in_steps, looked_at = _of_folder(root)
    else:
        print(_nowhere(workspace), file=sys.stderr)
        raise typer.Exit(USAGE_ERROR)
    story = ""
    if is_run and (watched := root or here) is not None:
        findings, looked_at, story = _seen_beside(findings, watched)
    if up_to is None and is_told_in_steps:
        up_to = Step.CAUSE
    shown = findings if up_to is None else told(findings, up_to)
    if is_json:
        print(json.dumps([*map(_documented, shown)], indent=2))
        raise typer.Exit(FOUND if findings else 0)
    _show(shown, looked_at)
    if up_to in (None, Step.FIX):
        _tell_of_the_build(shown, root)
    if shown and up_to is None:
        is_of_files = workspace != "-" and not is_run
        _tell_the_rest(story, looked_at if is_of_files else "")
    elif shown and up_to and (step := next_step(findings[0], up_to)):
        print(f"For the {step.value}, add --up-to {step.value}.")
    raise typer.Exit(FOUND if findings else 0)


def _nowhere(workspace: str) -> str:
    """Say that what was given is no folder of a workspace."""
    if Path(workspace).is_file():
        return (
            f"{workspace} is a file; give the folder of its workspace, or, if it holds the text of an error: "
            f"ros2lab diagnose - < {shlex.quote(workspace)}"
        )
    where = f"no folder {workspace}" if workspace else "no workspace in this folder or above it"
    return f"There is {where}; give the folder of a workspace, or - for the text of an error."


def _of_printed(here: Path | None) -> tuple[list[Finding], bool, str]:
    """Return what is found of the text that is read, whether it is told in steps, and what was looked at."""
    from ros2lab.diagnose import of_text, of_workspace  # noqa: PLC0415
    from ros2lab.diagnose.explaining.needed import of_needed  # noqa: PLC0415
    from ros2lab.diagnose.explaining.own_words import own_words  # noqa: PLC0415
    from ros2lab.diagnose.look import Look, seen_of  # noqa: PLC0415
    from ros2lab.diagnose.printed.error_text import read_error, read_printed  # noqa: PLC0415

    text = read_printed(sys.stdin.buffer)
    findings = of_text(text, here)
    looked_at = "The text contains no error known to ros2lab"
    if not findings and here is not None and text.strip():
        # What runs without an error may still do nothing: then the cause is in the files.
        error = read_error(text)
        look = Look(here.absolute(), loads="launch" in text)
        findings = of_needed(of_workspace(here, os.environ), error, look)
        if error.typed:
            # What was sourced, the text shows itself: it may be of another terminal.
            findings = [finding for finding in findings if finding.code != "not-sourced"]
        if own := own_words(error, look):
            looked_at += f" ({own.cause.rstrip('.')}: {own.place})"
        looked_at += f", and nothing wrong was found in {here}, where it looked at {seen_of(here)}. {_RUN_OFFER.rstrip(' .')}"
    looked_at += ". Give everything that was printed, starting with the command."
    return findings, is_text_step_by_step(text, here), looked_at


def _of_folder(root: Path) -> tuple[list[Finding], bool, str]:
    """Return what is found of a workspace, whether it is told in steps, and, if its files are right, what was looked at."""
    from ros2lab.diagnose import of_workspace  # noqa: PLC0415
    from ros2lab.diagnose.look import seen_of  # noqa: PLC0415

    findings, looked_at = of_workspace(root, os.environ), ""
    if all(finding.code == "not-sourced" for finding in findings):  # which is about this terminal alone
        looked_at = (
            f"It looked at {seen_of(root)}, but ran nothing, so it cannot tell what the nodes do at run time. "
            f"{_RUN_OFFER}If a command fails, pass on its output: command 2>&1 | ros2lab diagnose -"
        )
    return findings, is_step_by_step(root), looked_at


def _seen_beside(findings: Sequence[Finding], root: Path) -> tuple[list[Finding], str, str]:
    """Run what a workspace has installed.

    Returns:
        What is found by reading or then, each once; what was looked at; and what the nodes did.
    """
    from ros2lab.diagnose.finding import ranked  # noqa: PLC0415

    findings, found, looked_at, story = _run(root, findings)
    read = {(finding.code, _about(finding)) for finding in findings if finding.place}
    others = (finding for finding in found if (finding.code, _about(finding)) not in read)
    return ranked([*findings, *others]), looked_at, story


def _about(finding: Finding) -> str:
    """Return the place that a finding is about; of what the nodes note themselves the file."""
    from ros2lab.trial.witnessed import NOTED  # noqa: PLC0415

    return finding.place.partition(":")[0] if finding.code in NOTED else finding.place


def _documented(finding: Finding) -> dict[str, str]:
    """Return what `--json` prints of a finding."""
    return {name: getattr(finding, name) for name in ("code", "cause", "place", "fix")}


def _run(root: Path, read: Sequence[Finding]) -> tuple[Sequence[Finding], list[Finding], str, str]:
    """Run what a workspace has installed.

    Returns:
        What reading has found and the run does not contradict; what is found then; what was looked at; and what the
        nodes did.
    """
    from ros2lab.diagnose.net import unjudged  # noqa: PLC0415
    from ros2lab.domain_lease import NoDomainError  # noqa: PLC0415
    from ros2lab.grading.reports.shown import visible  # noqa: PLC0415
    from ros2lab.trial import try_out  # noqa: PLC0415
    from ros2lab.workspace import WorkspaceError  # noqa: PLC0415

    def show(step: str) -> None:
        print(f"{step} ...", file=sys.stderr, flush=True)

    try:
        trial = try_out(root.absolute(), show, read)
    except (NoDomainError, WorkspaceError) as error:
        # What reading has found is told all the same.
        print(error, file=sys.stderr)
        return read, [], f"Nothing could be run: {error}", ""
    except Exception as error:
        return read, [unjudged(error)], "", ""
    story = " ".join(trial.story)
    return (
        trial.read,
        trial.findings,
        f"{_RAN if trial.untried else ''}{story} {trial.untried}".rstrip(),
        visible(story, LONGEST),
    )


def _tell_of_the_build(findings: Sequence[Finding], root: Path | None) -> None:
    from ros2lab.diagnose.packaging.installed import to_build  # noqa: PLC0415

    if root is not None and (command := to_build(root.absolute(), findings)):
        print(f"What runs is a copy of the source: after a change, build again: {command}")


def _tell_the_rest(story: str, looked_at: str) -> None:
    """Tell below the findings what the nodes did, and what was looked at without finding more."""
    from ros2lab.grading.reports.shown import visible  # noqa: PLC0415

    if story:
        print(f"What the nodes did: {story}")
    if looked_at:
        print(visible(f"Nothing else was found. {looked_at}", LONGEST))


def _show(findings: Sequence[Finding], looked_at: str) -> None:
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    from ros2lab.diagnose.finding import merged  # noqa: PLC0415
    from ros2lab.grading.reports.shown import visible  # noqa: PLC0415

    findings = merged(findings)
    console = Console(soft_wrap=not sys.stdout.isatty())
    if not findings:
        console.print(
            Text(
                visible(
                    looked_at if looked_at.startswith(_RAN) else f"Nothing was found. {looked_at}", LONGEST
                )
            )
        )
        return
    # What is quoted of a file or a text gives the terminal no codes.
    told_of = {
        name: [visible(getattr(finding, name), LONGEST, keeps_lines=True) for finding in findings]
        for name in ("cause", "place", "fix")
    }
    columns = {name: texts for name, texts in told_of.items() if any(texts)}
    if not sys.stdout.isatty():
        for finding, (cause, *others) in zip(findings, zip(*told_of.values(), strict=True), strict=True):
            print(f"{finding.code}: {cause}")
            for name, text in zip(("place", "fix"), others, strict=True):
                if text:
                    print(f"  {name}: {text}")
        return
    table = Table(*columns, show_lines=True)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*map(Text, row))
    console.print(table)
