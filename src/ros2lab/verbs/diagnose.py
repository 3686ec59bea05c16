"""`ros2lab diagnose`: what is wrong with a workspace, or what an error means."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ros2lab.diagnose import Finding

FOUND, USAGE_ERROR = 1, 2


def diagnose(
    workspace: Annotated[
        str,
        typer.Argument(
            help="The workspace's folder (default: the one around this folder), or - for an error's text."
        ),
    ] = "",
    is_json: Annotated[
        bool, typer.Option("--json", help="Print a list of objects: code, cause, place, mend.")
    ] = False,
) -> None:
    """Say what is wrong with a workspace, or what an error means.

    `command 2>&1 | ros2lab diagnose -` explains what a command has printed. The likeliest cause comes first.
    The exit code is 0 if nothing was found, 1 if something was, and 2 if there is nothing to look at.
    """
    # Late, so that the other verbs of the command need not wait for it.
    from ros2lab.diagnose import of_text, of_workspace  # noqa: PLC0415
    from ros2lab.diagnose.look import workspace_around  # noqa: PLC0415

    here = workspace_around(Path.cwd())
    if workspace == "-":
        findings = of_text(sys.stdin.buffer.read().decode(errors="replace"), here)
    else:
        root = Path(workspace) if workspace else here
        if root is None or not root.is_dir():
            where = f"no folder {workspace}" if workspace else "no workspace in this folder or above it"
            print(
                f"There is {where}; give the folder of a workspace, or - for an error's text.",
                file=sys.stderr,
            )
            raise typer.Exit(USAGE_ERROR)
        findings = of_workspace(root, os.environ)
    print(json.dumps([asdict(finding) for finding in findings], indent=2)) if is_json else _show(findings)
    raise typer.Exit(FOUND if findings else 0)


def _show(findings: Sequence[Finding]) -> None:
    from rich.console import Console  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    console = Console(soft_wrap=not sys.stdout.isatty())
    if not findings:
        console.print("Nothing was found.")
        return
    if not sys.stdout.isatty():
        for finding in findings:
            print(f"{finding.code}: {finding.cause}")
            for name, text in (("place", finding.place), ("mend", finding.mend)):
                if text:
                    print(f"  {name}: {text}")
        return
    table = Table("cause", "place", "mend", show_lines=True)
    for finding in findings:
        table.add_row(*(Text(text) for text in (finding.cause, finding.place, finding.mend)))
    console.print(table)
