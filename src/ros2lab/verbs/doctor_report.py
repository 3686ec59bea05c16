"""What the doctor says, as a table and as JSON."""

from __future__ import annotations

import html
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from ros2lab import __version__

if TYPE_CHECKING:
    from rich.table import Table


SCHEMA = 1  # of the JSON; a field is never renamed without a new number
Status = Literal["ok", "warning", "failed"]


@dataclass(frozen=True)
class Finding:
    """What one check has found.

    Attributes:
        name: what was looked at.
        status: `ok`; `warning` if the lab works but something may surprise; `failed` if it does not work.
        found: what is there, in a few words.
        fix: the line to type, or what to do; empty if all is well.
        values: the numbers and names behind `found`, for programs.
    """

    name: str
    status: Status
    found: str
    fix: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Diagnosis:
    """All that was found."""

    findings: tuple[Finding, ...]

    @property
    def is_ok(self) -> bool:
        """Whether the lab can work here."""
        return all(finding.status != "failed" for finding in self.findings)

    def as_json(self) -> str:
        """Return everything as JSON: `schema`, `ros2lab`, `is_ok`, and `checks` with one entry a finding."""
        checks = [asdict(finding) for finding in self.findings]
        whole = {"schema": SCHEMA, "ros2lab": __version__, "is_ok": self.is_ok, "checks": checks}
        return json.dumps(whole, indent=2)

    def as_table(self) -> Table:
        """Return everything as a table for the terminal."""
        from rich.table import Table  # noqa: PLC0415
        from rich.text import Text  # noqa: PLC0415

        table = Table("check", "state", "found", "to fix it", highlight=False)
        for finding in self.findings:
            state = Text("FAILED" if finding.status == "failed" else finding.status, _COLOURS[finding.status])
            table.add_row(Text(finding.name), state, Text(finding.found), Text(finding.fix))
        return table

    # What was found differs from machine to machine, and a stored notebook is compared with a later run.
    def __repr__(self) -> str:
        return f"Diagnosis(is_ok={self.is_ok})"

    def _repr_html_(self) -> str:
        head = "".join(f'<th scope="col">{name}</th>' for name in ("check", "state", "found", "to fix it"))
        left = 'style="text-align:left"'
        rows = "".join(
            f'<tr><th scope="row" {left}>{html.escape(finding.name)}</th>'
            f"<td><b>{finding.status}</b></td><td {left}>{html.escape(finding.found)}</td>"
            f"<td {left}>{html.escape(finding.fix)}</td></tr>"
            for finding in self.findings
        )
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        # All is well: one line, which unfolds. What is not comes first, and is open.
        others = [finding for finding in self.findings if finding.status != "ok"]
        names = ", ".join(html.escape(finding.name) for finding in others)
        said = (
            f"! Look at: {names}"
            if others
            else f"✔ This machine is ready: {len(self.findings)} of {len(self.findings)} checks are ok"
        )
        colour = "var(--jp-warn-color0, #b35900)" if others else "var(--jp-success-color0, #1b5e20)"
        summary = f'<summary style="color:{colour};font-weight:600">{said}.</summary>'
        return f'<details class="doctor"{" open" if others else ""}>{summary}{table}</details>'


_COLOURS: Mapping[Status, str] = {"ok": "green", "warning": "yellow", "failed": "bold red"}
