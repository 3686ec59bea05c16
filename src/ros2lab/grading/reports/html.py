"""A grade as one HTML file with the runs: for a phone, a screen, paper, and a screen reader.

Everything that a template prints goes through `shown.visible` and is escaped; only Markup made here is not.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from typing import Any

import jinja2
from markupsafe import Markup, escape

from ros2lab.grading.evidence import Evidence, Run
from ros2lab.grading.grade import Grade
from ros2lab.grading.reports.losses import losses, missed_bonus, other_faults
from ros2lab.grading.reports.shown import number, title, visible
from ros2lab.grading.reports.timeline import LANES, published_by, timeline

LARGEST = 900_000  # bytes of a report
SPARE = 200_000  # of them at least for the runs
MOST = {
    "faults": 30,
    "notes": 30,
    "nodes": 6,
    "topics": 20,
    "parameters": 20,
    "log": 15,
    "commands": 20,
    "words": 30,
}
SHORT = 60  # characters of a parameter's value
LINE, LINES = 120, 12  # characters and lines of what a program printed

_CODE = re.compile("`([^`]+)`")
_RUN = re.compile(r"runs\[(\d+)\]")


def html(grade: Grade, evidence: Evidence) -> str:
    """Return a grade as an HTML page that needs nothing else and runs nothing.

    Args:
        grade: the grade.
        evidence: the evidence for it; runs are shown as far as they fit into `LARGEST`.
    """
    template = _environment().get_template("report.html.j2")
    context: dict[str, Any] = {
        "grade": grade,
        "evidence": evidence,
        "losses": losses(grade),
        "other_faults": other_faults(grade),
        "missed_bonus": missed_bonus(grade),
    }
    size = len(template.render(**context, runs=[], left_out=0).encode())
    runs = _runs(evidence, max(SPARE, LARGEST - size))
    return template.render(**context, runs=runs, left_out=len(evidence.runs) - len(runs))


def _runs(evidence: Evidence, room: int) -> list[Markup]:
    """Return the first runs, as many as fit into this number of bytes."""
    template = _environment().get_template("run.html.j2")
    shown: list[Markup] = []
    for index, run in enumerate(evidence.runs):
        pictures, silent = _pictures(run, f"run-{index}")
        text = template.render(run=run, key=f"run-{index}", pictures=pictures, silent=silent)
        room -= len(text.encode())
        if room < 0:
            break
        shown.append(Markup(text))  # noqa: S704 -- a template of ours
    return shown


def _pictures(run: Run, key: str) -> tuple[list[tuple[str, Markup, int]], list[str]]:
    """Return name, picture and number of omitted topics for each node that was heard, and the other nodes."""
    nodes = list(
        dict.fromkeys([*run.nodes, *(node for nodes in run.publishes.values() for node in nodes), ""])
    )
    heard = [node for node in nodes if published_by(run, node)]
    if not heard and run.nodes and run.commands:
        heard = run.nodes[:1]  # the commands and its log
    pictures = [
        (node, timeline(run, node, f"{key}-{index}"), max(0, len(published_by(run, node)) - LANES))
        for index, node in enumerate(heard[: MOST["nodes"]])
    ]
    return pictures, [node for node in run.nodes if node not in heard[: MOST["nodes"]]]


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("ros2lab.grading", "reports"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: value if isinstance(value, Markup) else visible(value),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        number=number,
        name=title,
        prose=_prose,
        lines=_lines,
        short=_short,
        printed=_printed,
        keys=_keys,
        first=_first,
    )
    environment.globals["most"] = MOST
    return environment


def _printed(text: str) -> Markup:
    """Return the last lines that a program printed, unchanged."""
    lines = text.splitlines()
    left_out = [f"({len(lines) - LINES} lines before)"] if len(lines) > LINES else []
    return escape("\n".join([*left_out, *(visible(line, LINE) for line in lines[-LINES:])]))


def _prose(text: str) -> Markup:
    """Return a sentence with the text between backticks as code."""
    return Markup(_CODE.sub(r"<code>\1</code>", str(escape(visible(text)))))  # noqa: S704 -- all else is escaped


def _lines(text: str) -> Markup:
    """Return a text with its line breaks."""
    return escape(visible(text, keeps_lines=True))


def _short(value: object) -> str:
    return visible(value, SHORT)


def _keys(keys: list[str], shown: int) -> Markup:
    """Return keys of the evidence, those of a run as links to it.

    Args:
        keys: such as `runs[0].commands[2]`.
        shown: how many runs the page shows.
    """
    result = []
    for key in keys[: MOST["words"]]:
        match = _RUN.match(key)
        text = Markup("<code>{}</code>").format(visible(key, 80))
        if match and len(match[1]) < 5 and int(match[1]) < shown:
            text = Markup('<a href="#run-{}">{}</a>').format(int(match[1]), text)
        result.append(text)
    return Markup(", ").join(result)


def _first(values: list[Any] | Mapping[str, Any], kind: str) -> list[Any]:
    """Return the first values, or pairs of name and value, as many as are shown of a kind."""
    return list(values.items() if isinstance(values, Mapping) else values)[: MOST[kind]]
