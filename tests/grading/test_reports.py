"""Reports tell what a grade says, in every form; and what a submission has written does nothing in any of them."""

from __future__ import annotations

import io
import itertools
import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import asdict, replace
from html.parser import HTMLParser
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rich.console import Console
from typer.testing import CliRunner

from ros2lab.cli import app
from ros2lab.grading import evidence as evidence_module
from ros2lab.grading.evidence import (
    SCHEMA,
    Build,
    CommandSeen,
    Evidence,
    Executable,
    Files,
    Heard,
    Place,
    Run,
)
from ros2lab.grading.evidence_json import EvidenceError, evidence_json, read_evidence
from ros2lab.grading.grade import Fault, Grade, Judgement, Override, Points
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.reports.as_json import as_json
from ros2lab.grading.reports.github import github
from ros2lab.grading.reports.gradescope import gradescope
from ros2lab.grading.reports.html import html
from ros2lab.grading.reports.junit import junit
from ros2lab.grading.reports.losses import losses, missed_bonus, other_faults
from ros2lab.grading.reports.markdown import markdown, prose
from ros2lab.grading.reports.shown import disarmed, is_hidden, number, visible
from ros2lab.grading.reports.table import table
from ros2lab.grading.reports.timeline import timeline

LARGEST = 1_000_000  # bytes
TWIST, STRING = "geometry_msgs/msg/Twist", "std_msgs/msg/String"
HOSTILE = (
    "<script>alert(1)</script><img src=x onerror=alert(2)>\"'><svg onload=alert(3)>",
    "javascript:alert(4) [link](https://evil.example) ![x](https://evil.example/x.png) www.evil.example a@evil.example",
    "\x1b[31mred\x1b]8;;https://evil.example\x07link\x1b]8;;\x07\x9b2J\r\b\x00",
    "\u202etxt.exe\u2066\u200f\u200b\ufeff\u2028\ud800\ufffe\U000e0041",
    "[red]rich[/red] [link=https://evil.example]x[/link] [/] :smile:",
    '=HYPERLINK("https://evil.example")',
    "{{ 7*191 }} {% raw %} {0} %s ${x}",
    "]]> --> </style></title></textarea></pre></svg> <!--",
    "```\n# heading\n| a | b |\n- item\n<b>x</b> \\| `` \\`",
    "a" + "\u0301" * 500,
    "#### @everyone #1 ~~x~~ $x$ http://evil.example __init__ *b* &lt;script&gt;",
)


def judgement(id_: str, points: float, most: float, **more: Any) -> Judgement:
    lost = points < most
    fields: dict[str, Any] = {
        "title": f"The title of {id_}",
        "reason": f"The reason of {id_} is 2.4 s instead of 2.0 s.",
        "hint": "Change it to create_timer(2.0, self.tick)." if lost else "",
        "evidence": ["runs[0].quiet"],
    }
    return Judgement(id_, id_.partition(".")[0], points=points, max=most, **{**fields, **more})


def grade_of(criteria: list[Judgement], **more: Any) -> Grade:
    names = dict.fromkeys(one.component for one in criteria)
    components = {
        name: Points(
            sum(one.points for one in criteria if one.component == name),
            sum(one.max for one in criteria if one.component == name),
        )
        for name in names
    }
    fields: dict[str, Any] = {
        "faults": [],
        "notes": [],
        "clock": "stepped",
        "sandbox": "bubblewrap 0.8",
        "seconds": {"unpack": 0.01, "build": 1.3, "observe": 2.1, "total": 3.41},
        "versions": {"ros2lab": "0.1.0", "rubric": "1"},
    }
    total = sum(one.points for one in criteria)
    most = sum(one.max for one in criteria if one.component != "bonus") or 100.0
    return Grade(
        1, more.pop("submission", "ada.zip"), total, most, components, criteria, **{**fields, **more}
    )


def twist(x: float, z: float) -> dict[str, Any]:
    return {"linear": {"x": x, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": z}}


def velocities(start: float, count: int) -> Heard:
    times = [round(start + 0.1 * n, 3) for n in range(count)]
    values = [twist(0.5 + 0.3 * math.sin(time), 0.4 * math.cos(2 * time)) for time in times]
    return Heard(TWIST, "/velocity_publisher", times, values, count)


def run_of(programs: list[str], **more: Any) -> Run:
    fields: dict[str, Any] = {
        "setting": "alone",
        "clock": "stepped",
        "nodes": [],
        "publishes": {},
        "subscribes": {},
        "qos": {},
        "parameters": {},
        "quiet": {},
        "commands": [],
        "ended": {},
        "stopped": {},
        "notes": [],
    }
    return Run(programs, **{**fields, **more})


def evidence_of(runs: list[Run], build: Build | None = None, **more: Any) -> Evidence:
    fields: dict[str, Any] = {
        "name": "ada.zip",
        "submission": Submission("package", None, [], None, [], []),
        "files": Files(),
        "tests": {},
        "seconds": {"total": 3.41},
        "sandbox": "bubblewrap 0.8",
        "versions": {"ros2lab": "0.1.0"},
    }
    return Evidence(SCHEMA, "week2", build=build, runs=runs, **{**fields, **more})


def full() -> tuple[Grade, Evidence]:
    """Return what a good submission with a few faults might be given."""
    grade = grade_of(
        [
            judgement("workspace.builds", 10, 10),
            judgement("workspace.layout", 5, 5),
            judgement("package.manifest", 4, 5),
            judgement("package.entry_points", 10, 10),
            judgement("status_publisher.period", 5, 10),
            judgement("status_publisher.type", 10, 10),
            judgement("command_subscriber.answers", 0, 20),
            judgement("velocity_publisher.rate", 20, 20),
            judgement("documentation.readme", 20 / 3, 10),
            judgement("bonus.launch", 3, 5),
        ],
        faults=[
            Fault(
                "undeclared-dependency",
                "package",
                "package.xml does not name std_msgs, which the nodes import.",
                "robot_controller/package.xml:12",
                "Add this line:\n<depend>std_msgs</depend>",
            ),
            Fault(
                "unused-file", "velocity_publisher", "config/old.yaml is used by nothing.", "", "Remove it."
            ),
        ],
        notes=["build/ and install/ were handed in, and were not used."],
    )
    status = Heard(STRING, "/status_publisher", [2.0, 4.0, 6.0], [{"data": "idle"}] * 3, 3)
    commands, start = [], 14.4
    for text, moves in (
        ("start", True),
        ("stop", False),
        ("reset", False),
        ("START", True),
        ("dance", True),
        ("", True),
        ("1000 x start, stop", False),
        ("start", True),
    ):
        commands.append(
            CommandSeen(
                text,
                [["INFO", f"Command '{text}'"], ["WARN", "Velocity changed"]],
                {"/cmd_vel": velocities(start, 40)} if moves else {},
                {"/velocity_publisher:is_moving": moves},
                is_alive=True,
            )
        )
        start += 4.3
    stopped = {"seconds": 0.12, "traceback": True, "killed": False, "said": "KeyboardInterrupt", "last": {}}
    runs = [
        run_of(
            ["status_publisher"],
            nodes=["/status_publisher"],
            publishes={"/robot/status": {"/status_publisher": [STRING]}},
            qos={"/robot/status": ["publisher reliable volatile"]},
            parameters={"/status_publisher": {"period": 2.0}},
            quiet={"/robot/status": status},
            stopped={"status_publisher": stopped},
        ),
        run_of(
            ["velocity_publisher"],
            nodes=["/velocity_publisher"],
            publishes={"/cmd_vel": {"/velocity_publisher": [TWIST]}},
            subscribes={"/robot/command": {"/velocity_publisher": [STRING]}},
            quiet={"/cmd_vel": velocities(0.1, 80)},
            commands=commands,
        ),
        run_of(
            ["status_publisher", "command_subscriber", "velocity_publisher"],
            setting="together",
            clock="real",
            nodes=["/command_subscriber", "/status_publisher", "/velocity_publisher"],
            publishes={
                "/cmd_vel": {"/velocity_publisher": [TWIST]},
                "/robot/status": {"/status_publisher": [STRING]},
            },
            subscribes={"/robot/command": {"/command_subscriber": [STRING]}},
            quiet={"/cmd_vel": velocities(0.1, 24), "/robot/status": replace(status, times=[2.0], count=1)},
            commands=commands[:2],
            ended={"command_subscriber": "Traceback (most recent call last):\nValueError: unknown command"},
            notes=["2 programs publish on /cmd_vel, or one that joins ROS as often."],
        ),
    ]
    build = Build(
        is_built=True,
        error="",
        warnings=["The marker is missing."],
        notes=[],
        executables=[
            Executable("status_publisher", "robot_controller.status_publisher:main", "installed", ["x"]),
            Executable("talk", "", "script", [], "The entry point has no function."),
        ],
        shared=["launch/robot.launch.py"],
        environ={"PATH": "/usr/bin"},
        seconds=1.31,
    )
    return grade, evidence_of(runs, build)


def empty() -> tuple[Grade, Evidence]:
    return grade_of([]), evidence_of([])


def hostile() -> tuple[Grade, Evidence]:
    """Return a grade and its evidence with hostile text in every place that a submission can write to."""
    texts = [*HOSTILE] * 3
    criteria = [
        judgement(f"package.c{n}", 0, 1, title=text, reason=text, hint=text, evidence=[text])
        for n, text in enumerate(texts)
    ]
    faults = [Fault(text, "package", text, text, text) for text in texts]
    runs = []
    for text in HOSTILE:
        heard = Heard(
            TWIST,
            text,
            [1.0, math.nan, 2.0, 1e308],
            [{text: text}, {}, twist(math.inf, 1e308), {"x": [text]}],
            9,
        )
        seen = CommandSeen(text, [[text, text]], {text: heard}, {text: [text, {text: text}]}, is_alive=False)
        runs.append(
            run_of(
                [text],
                setting=text,
                nodes=[text],
                publishes={text: {text: [text]}},
                subscribes={text: {text: [text]}},
                qos={text: [text]},
                parameters={text: {text: text}},
                quiet={text: heard},
                commands=[seen],
                ended={text: text},
                stopped={text: {"seconds": text, "traceback": text, "said": text, "killed": text}},
                notes=[text],
            )
        )
    executables = [Executable(text, text, "script", [text], text) for text in HOSTILE]
    build = Build(False, HOSTILE[0] + HOSTILE[2], [*HOSTILE], [*HOSTILE], executables, [*HOSTILE], {}, 1.0)
    many = dict(zip(HOSTILE, HOSTILE, strict=True))
    grade = grade_of(criteria, faults=faults, notes=texts, submission=" ".join(HOSTILE), sandbox=HOSTILE[0])
    return replace(grade, versions=many), evidence_of(runs, build, name=" ".join(texts))


def overridden() -> tuple[Grade, Evidence]:
    grade, evidence = full()
    changed = judgement(
        "package.manifest", 5, 5, override=Override(5, "Seen in the lab: it builds.", "Dr Noether", 4)
    )
    criteria = [changed if one.id == changed.id else one for one in grade.criteria]
    return grade_of(criteria), evidence


def flooding() -> tuple[Grade, Evidence]:
    """Return what a submission leaves that talks as much as it can."""
    heard = Heard(
        TWIST, "/n", [n / 7 for n in range(200)], [twist(n % 9, -n) for n in map(float, range(200))], 9999
    )
    topics = {f"/topic_{n}": heard for n in range(20)}
    log = [["INFO", "<&\"'>" * 100]] * 200
    nodes = [f"/node_{n}" for n in range(20)]
    run = run_of(
        nodes,
        nodes=nodes,
        publishes={topic: {node: [TWIST] for node in nodes} for topic in topics},
        parameters={node: {f"p{n}": "x" * 500 for n in range(50)} for node in nodes},
        quiet=topics,
        commands=[
            CommandSeen(
                "start", log, {"/topic_0": heard}, {f"{n}": "'" * 500 for n in range(99)}, is_alive=True
            )
        ]
        * 8,
        ended=dict.fromkeys(nodes, "\x1b" * 9_000),
        notes=["<" * 10_000] * 300,
    )
    grade, _ = full()
    faults = [Fault("code", "package", "<" * 10_000, "'" * 10_000, "&" * 10_000)] * 60
    criteria = [
        judgement(f"package.c{n}", 0, 2, reason="\u202e<" * 9_000, hint="&" * 9_000) for n in range(40)
    ]
    return replace(grade, criteria=criteria, faults=faults, notes=["'" * 10_000] * 60), evidence_of([run] * 3)


CASES: dict[str, Callable[[], tuple[Grade, Evidence]]] = {
    case.__name__: case for case in (full, empty, hostile, overridden, flooding)
}
every_case = pytest.mark.parametrize("case", CASES.values(), ids=CASES)


def shown_table(grade: Grade, width: int = 100) -> str:
    output = io.StringIO()
    Console(file=output, width=width, force_terminal=True, color_system=None, legacy_windows=False).print(
        table(grade)
    )
    return output.getvalue()


TEXTS: dict[str, Callable[[Grade, Evidence], str]] = {
    "html": html,
    "markdown": lambda grade, _: markdown(grade),
    "gradescope": lambda grade, _: gradescope(grade),
    "junit": lambda grade, _: junit(grade),
    "json": lambda grade, _: as_json(grade),
    "evidence": lambda _, evidence: evidence_json(evidence),
    "table": lambda grade, _: shown_table(grade),
}


@every_case
@pytest.mark.parametrize("form", TEXTS.values(), ids=TEXTS)
def test_no_form_has_a_character_that_is_not_seen(
    form: Callable[[Grade, Evidence], str], case: Callable[[], tuple[Grade, Evidence]]
) -> None:
    """Controls, bidi controls and lone surrogates are signs; every form can be written as UTF-8."""
    text = form(*case())
    assert not {hex(ord(letter)) for letter in set(text) if letter != "\n" and is_hidden(ord(letter))}
    text.encode("utf-8")


@pytest.mark.parametrize("name", ["html", "markdown", "gradescope", "junit", "table"])
def test_a_flood_stays_small_and_is_said_to_be_shortened(name: str) -> None:
    """What is read by people stays under 1 MB, and says what is missing."""
    text = TEXTS[name](*flooding())
    assert len(text.encode()) < LARGEST
    assert re.search(r"more characters|\\u2026", text)
    if name == "html":
        assert "more runs are not shown" in text
        assert "more faults are not shown" in text
        assert 'id="run-0"' in text, "some of what happened is shown all the same"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("plain, Ünïcödé, 日本語, 👩‍🔬", "plain, Ünïcödé, 日本語, 👩‍🔬"),
        ("\x1b[0m\x7f\x85\u202e\r\n\t", "␛[0m␡<U+0085><U+202E>␍␊␉"),
        ("\ud800\uffff\U0001fffe", "<U+D800><U+FFFF><U+1FFFE>"),
        ("e" + "\u0301" * 6, "e" + "\u0301" * 4 + "<U+0301><U+0301>"),
        (12.5, "12.5"),
    ],
)
def test_what_cannot_be_seen_gets_a_sign(text: object, expected: str) -> None:
    assert visible(text) == expected


def test_a_long_text_says_how_much_is_missing() -> None:
    assert visible("x" * 410) == "x" * 400 + "… (10 more characters)"
    assert visible("x" * 400) == "x" * 400
    assert len(visible("\u202e" * 10_000_000)) < 450


def test_lines_are_kept_where_they_are_wanted() -> None:
    assert visible("a\r\n\tb\x1b", keeps_lines=True) == "a\n    b␛"


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", " =1", "\uff1d1"])
def test_no_cell_begins_a_formula(text: str) -> None:
    """Whatever a spreadsheet divides cells by: a semicolon, a tab or the end of a line stands in any text."""
    assert disarmed(text) == f"'{text}"
    assert disarmed(f"x{text}") == f"x{text}"
    for sign in (";", "\t", "\n", ";;"):
        assert disarmed(f"a{sign}{text};b") == f"a{sign}'{text};b"


@pytest.mark.parametrize(
    ("value", "text"), [(12.0, "12"), (20 / 3, "6.67"), (0.1 + 0.2, "0.3"), (100, "100")]
)
def test_points_have_at_most_two_decimals(value: float, text: str) -> None:
    assert number(value) == text


def test_losses_stand_with_their_faults() -> None:
    """A fault stands where its component lost points, and the bonus is no loss."""
    grade, _ = full()
    assert [(loss.component, loss.points) for loss in losses(grade)] == [
        ("package", 1),
        ("status_publisher", 5),
        ("command_subscriber", 20),
        ("documentation", pytest.approx(10 / 3)),
    ]
    assert [fault.code for fault in losses(grade)[0].faults] == ["undeclared-dependency"]
    assert [fault.code for fault in other_faults(grade)] == ["unused-file"]
    assert [one.id for one in missed_bonus(grade)] == ["bonus.launch"]


def schema() -> dict[str, Any]:
    text = resources.files("ros2lab.grading").joinpath("reports", "schema.json").read_text(encoding="utf-8")
    return dict(json.loads(text))


class TestJson:
    """The form for programs."""

    @every_case
    def test_it_fits_its_schema_and_loses_nothing(self, case: Callable[[], tuple[Grade, Evidence]]) -> None:
        grade, _ = case()
        data = json.loads(as_json(grade))
        jsonschema.Draft202012Validator(schema()).validate(data)
        for criterion in data["criteria"]:
            criterion.setdefault("override", None)
        assert data == {"run": grade.run, **asdict(grade)}

    def test_all_reports_of_a_grade_name_its_run_and_another_grade_has_another(self) -> None:
        """So that the JSON of one grader is not taken for that of another, whose HTML lies beside it."""
        grade, evidence = full()
        for name in ("json", "html", "markdown", "gradescope", "junit"):
            assert grade.run in TEXTS[name](grade, evidence), name
        assert replace(grade, total=grade.total - 1).run != grade.run

    def test_an_override_is_there_only_where_there_is_one(self) -> None:
        data = json.loads(as_json(overridden()[0]))
        with_one = [one for one in data["criteria"] if "override" in one]
        assert [one["id"] for one in with_one] == ["package.manifest"]
        assert with_one[0]["override"]["machine"] == 4

    @pytest.mark.parametrize(
        "change",
        [
            {"schema": 2},
            {"total": "100"},
            {"clock": "sundial"},
            {"components": {"package": {"points": 1}}},
            {"criteria": [{"id": "x"}]},
            {"more": 1},
        ],
        ids=str,
    )
    def test_the_schema_refuses_what_is_no_grade(self, change: dict[str, Any]) -> None:
        data = {**json.loads(as_json(full()[0])), **change}
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.Draft202012Validator(schema()).validate(data)

    def test_a_number_that_json_does_not_have_is_refused(self) -> None:
        with pytest.raises(ValueError, match="nan"):
            as_json(replace(full()[0], total=math.nan))


class Page(HTMLParser):
    """What is in an HTML page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.errors: list[str] = []
        self.tables: list[set[str]] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag == "table":
            self.tables.append(set())
        if "table" in self.open:
            self.tables[-1].add(tag)
        if tag not in ("meta", "br"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.errors.append(f"</{tag}> at {self.getpos()}")

    def handle_data(self, data: str) -> None:
        self.text += data

    def all(self, name: str) -> list[str]:
        return [str(attributes[name]) for _, attributes in self.elements if name in attributes]


TAGS = {
    "html",
    "head",
    "meta",
    "title",
    "style",
    "body",
    "header",
    "main",
    "section",
    "h1",
    "h2",
    "h3",
    "h4",
    "p",
    "small",
    "strong",
    "table",
    "caption",
    "thead",
    "tbody",
    "tr",
    "th",
    "td",
    "span",
    "div",
    "dl",
    "dt",
    "dd",
    "ul",
    "ol",
    "li",
    "code",
    "pre",
    "a",
    "bdi",
    "br",
    "figure",
    "figcaption",
    "svg",
    "desc",
    "path",
    "text",
}
ATTRIBUTES = {
    "lang",
    "charset",
    "http-equiv",
    "content",
    "name",
    "class",
    "style",
    "scope",
    "aria-hidden",
    "id",
    "href",
    "tabindex",
    "role",
    "aria-label",
    "aria-labelledby",
    "viewbox",
    "xmlns",
    "d",
    "x",
    "y",
}


class TestHtml:
    """The form for people."""

    @every_case
    def test_it_is_well_formed_and_has_only_what_we_write(
        self, case: Callable[[], tuple[Grade, Evidence]]
    ) -> None:
        """No script, no event, no form, no link that leads out, whatever the texts say."""
        page = Page(html(*case()))
        assert not page.errors
        assert not page.open
        assert {tag for tag, _ in page.elements} <= TAGS
        assert {name for _, attributes in page.elements for name in attributes} <= ATTRIBUTES
        assert all(link.startswith("#") for link in page.all("href"))
        assert all(re.fullmatch(r"width: [\d.]+%", style) for style in page.all("style"))

    @every_case
    def test_it_can_be_read_by_a_screen_reader(self, case: Callable[[], tuple[Grade, Evidence]]) -> None:
        """Ids differ, links lead somewhere, headings skip no level, tables and pictures have names."""
        page = Page(html(*case()))
        ids = page.all("id")
        assert len(ids) == len(set(ids))
        assert {link[1:] for link in page.all("href")} <= set(ids)
        assert {one for names in page.all("aria-labelledby") for one in names.split()} <= set(ids)
        levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h\d", tag)]
        assert levels[0] == 1
        assert levels.count(1) == 1
        assert all(later <= earlier + 1 for earlier, later in itertools.pairwise(levels))
        assert all({"caption", "th"} <= inside for inside in page.tables)
        assert all("scope" in attributes for tag, attributes in page.elements if tag == "th")
        for tag, attributes in page.elements:
            assert tag != "svg" or (attributes.get("role") == "img" and attributes.get("aria-labelledby"))

    def test_it_says_what_the_grade_says(self) -> None:
        grade, evidence = full()
        text = Page(html(grade, evidence)).text
        for one in grade.criteria:
            assert one.reason in text
            assert one.hint in text
        for fault in grade.faults:
            assert fault.cause in text
            assert fault.place in text
            assert fault.fix in text
        for words in (
            *grade.notes,
            "60.67 of 100 points",
            "ValueError: unknown command",
            "Also found",
            "/cmd_vel",
        ):
            assert words.replace("60.67", number(grade.total)).replace("100", number(grade.max)) in text
        assert text.index("Lost points") < text.index("All criteria") < text.index("What happened")
        assert text.index("What happened") < text.index("Notes") < text.index("If a point seems wrong")

    def test_an_override_is_shown_with_who_and_why_and_what_it_was(self) -> None:
        text = Page(html(*overridden())).text
        assert "Set by Dr Noether: Seen in the lab: it builds. (The machine gave 4.)" in text

    def test_a_hostile_text_is_shown_as_it_is(self) -> None:
        text = Page(html(*hostile())).text
        assert "<script>alert(1)</script>" in text
        assert "{{ 7*191 }}" in text
        assert "1337" not in text
        assert "␛[31mred" in text
        assert "<U+202E>txt.exe" in text

    def test_code_in_a_sentence_is_shown_as_code(self) -> None:
        grade, evidence = full()
        criterion = judgement("package.manifest", 0, 1, reason="`ros2 run <b>` finds ` no node.")
        page = html(replace(grade, criteria=[criterion]), evidence)
        assert "<p><code>ros2 run &lt;b&gt;</code> finds ` no node.</p>" in page

    def test_evidence_that_is_shown_is_linked(self) -> None:
        grade, evidence = full()
        criterion = judgement("package.manifest", 1, 1, evidence=["runs[1].commands[0]", "runs[99]", "files"])
        page = Page(html(replace(grade, criteria=[criterion]), evidence))
        assert page.all("href") == ["#run-1"]


class TestTimeline:
    """The pictures of what happened."""

    @staticmethod
    def paths(svg: str, kind: str) -> list[str]:
        root = ET.fromstring(svg)
        return [
            str(one.get("d"))
            for one in root.iter("{http://www.w3.org/2000/svg}path")
            if one.get("class") == kind
        ]

    def test_ticks_stand_where_messages_came(self) -> None:
        run = full()[1].runs[0]
        (ticks,) = self.paths(timeline(run, "/status_publisher", "k"), "tick")
        places = [int(x) for x in re.findall(r"M(\d+) ", ticks)]
        assert len(places) == 3
        assert places[1] - places[0] == pytest.approx(places[2] - places[1], abs=1)
        assert places[-1] == 472, "the last message is the end of the run"

    def test_commands_are_marked_in_their_order_after_what_came_before(self) -> None:
        run = full()[1].runs[1]
        svg = timeline(run, "/velocity_publisher", "k")
        places = [float(re.match(r"M([\d.]+)", mark)[1]) for mark in self.paths(svg, "mark")]  # type: ignore[index]
        assert len(places) == 8
        assert places == sorted(places)
        assert all(later - earlier >= 17.9 for earlier, later in itertools.pairwise(places))
        assert "1 start" in svg

    def test_velocities_are_drawn_to_scale(self) -> None:
        heard = Heard(TWIST, "/n", [0.0, 1.0, 2.0], [twist(0.0, 1.0), twist(1.0, 1.0), twist(0.0, 1.0)], 3)
        run = run_of(["p"], nodes=["/n"], publishes={"/cmd_vel": {"/n": [TWIST]}}, quiet={"/cmd_vel": heard})
        svg = timeline(run, "/n", "k")
        linear, angular = (
            [*map(float, re.findall(r"[\d.]+", self.paths(svg, k)[1]))] for k in ("linear", "angular")
        )
        assert linear[::2] == angular[::2] == [8, 240, 472]
        assert linear[1] == linear[5] == linear[3] + 84, "the plot is 84 high, and y points down"
        assert angular[1::2] == [linear[3]] * 3
        assert "linear x: from 0 to 1 m/s" in svg
        assert "one every 1 s" in svg

    @pytest.mark.parametrize(
        "times", [[], [0.0], [math.nan, math.inf, -1.0], [1e308, 1e308], [5.0, 5.0]], ids=str
    )
    def test_odd_times_and_values_still_give_a_picture(self, times: list[float]) -> None:
        values = [twist(1e308, -1e308), "text", None, {"linear": 3}][: len(times)]
        heard = Heard(TWIST, "/n", times, values, 7)
        seen = CommandSeen("go", [], {"/a": heard}, {}, is_alive=True)
        run = run_of(
            ["p"], nodes=["/n"], publishes={"/a": {"/n": [TWIST]}}, quiet={"/a": heard}, commands=[seen] * 60
        )
        svg = timeline(run, "/n", "k")
        ET.fromstring(svg)
        assert "nan" not in re.sub(r"<desc.*</desc>", "", svg)
        assert all(-1 <= float(x) <= 481 for x in re.findall(r'(?:M| x=")(-?[\d.]+)', svg))

    @pytest.mark.parametrize("value", [5e-324, -5e-324, 1e-300, 0.0, 1.7e308])
    def test_no_velocity_is_too_small_or_too_large_for_a_picture(self, value: float) -> None:
        """As the one that an int leaves in a field for floats."""
        heard = Heard(TWIST, "/n", [0.0, 0.1, 0.2], [twist(value, 0.0)] * 3, 3)
        run = run_of(["p"], nodes=["/n"], publishes={"/a": {"/n": [TWIST]}}, quiet={"/a": heard})
        svg = timeline(run, "/n", "k")
        ET.fromstring(svg)
        assert not re.search(r"\b(nan|inf)\b", re.sub(r"<desc.*</desc>", "", svg))

    def test_a_flood_is_thinned_out(self) -> None:
        run = flooding()[1].runs[0]
        svg = timeline(run, "/node_0", "k")
        assert len(svg) < 60_000
        assert "of them shown" in svg
        ET.fromstring(svg)

    def test_nothing_published_is_said(self) -> None:
        assert "Nothing was published." in timeline(run_of(["p"], nodes=["/n"]), "/n", "k")


class TestMarkdown:
    """The form for a comment or an issue."""

    def test_it_says_what_the_grade_says(self) -> None:
        text = markdown(overridden()[0])
        assert "| Package | 15 | 15 |" in text
        assert "### Command subscriber: 20 lost" in text
        assert "Set by Dr Noether: Seen in the lab: it builds. (the machine gave 4)" in text
        assert "`robot_controller/package.xml:12`" in markdown(full()[0])

    @pytest.mark.parametrize("text", HOSTILE)
    def test_only_words_stand_outside_of_code(self, text: str) -> None:
        """What is left without its code spans is letters and plain marks."""
        left = prose(text)
        while (fence := re.search("`+", left)) is not None:
            end = re.search(f"(?<!`){fence[0]}(?!`)", left[fence.end() :])
            assert end, "every code span ends"
            left = left[: fence.start()] + left[fence.end() + end.end() :]
        assert re.fullmatch(r"""(?:\w|[ "'\u2019(),.;:!?-])*""", left)
        assert not re.search(r"www\.|://|@|__|\]\(", left)

    def test_plain_sentences_stay_readable(self) -> None:
        sentence = "It doesn't build, as Zoë's package says (twice): fix it."
        assert prose(sentence) == sentence
        assert prose("See setup.py:3, then\nx.y(1.0, z).") == "See `setup.py:3`, then `x.y(1.0, z)`."
        assert prose("Look (with `ros2 topic list`), and give\ncreate_timer 2.0 s. Or get_logger?") == (
            "Look (with `ros2 topic list`), and give `create_timer` 2.0 s. Or `get_logger`?"
        )
        assert prose('Not true: ros2 topic pub /t "{data: 25.5}".').endswith('`/t` "`{data: 25.5}`".')
        assert prose("It ended with [Errno 2] No such file.") == "It ended with `[Errno 2]` No such file."
        assert prose("Write get_logger().info(...), not rclpy.init() (twice).") == (
            "Write `get_logger().info(...)`, not `rclpy.init()` (twice)."
        )

    def test_no_line_of_a_hostile_grade_begins_something_of_its_own(self) -> None:
        allowed = r"# Grade of |## |### |\*\*|\| (?:Component|---|Package) |  ?(?:- )|- |$"
        assert [line for line in markdown(hostile()[0]).split("\n") if not re.match(allowed, line)] == []

    def test_a_bar_does_not_end_a_cell(self) -> None:
        grade = grade_of([judgement("a|b<img>.x", 1, 1)])
        assert "| `A¦b<img>` | 1 | 1 |" in markdown(grade)


class TestGradescope:
    """results.json."""

    @every_case
    def test_it_has_the_documented_form(self, case: Callable[[], tuple[Grade, Evidence]]) -> None:
        grade, _ = case()
        data = json.loads(gradescope(grade))
        known = {
            "score",
            "execution_time",
            "output",
            "output_format",
            "test_output_format",
            "test_name_format",
        }
        assert data.keys() == known | {"visibility", "stdout_visibility", "tests"}
        assert data["score"] == pytest.approx(grade.total, abs=1e-3)
        for test, one in zip(data["tests"], grade.criteria, strict=True):
            assert test.keys() == {"score", "max_score", "status", "name", "output", "tags", "visibility"}
            assert test["status"] == ("passed" if one.points >= one.max else "failed")
            assert test["score"] == pytest.approx(one.points, abs=1e-3)

    def test_a_spreadsheet_takes_nothing_for_a_formula(self) -> None:
        grade = grade_of(
            [judgement("package.x", 0, 1, title="=1+1", reason="=cmd|' /C calc'!A0", hint="+1")],
            submission="=HYPERLINK(1)",
        )
        data = json.loads(gradescope(grade))
        for text in (data["output"], data["tests"][0]["name"], data["tests"][0]["output"]):
            assert not text.startswith(("=", "+", "-", "@"))
        assert data["tests"][0]["output"].startswith("'=cmd")

    def test_an_override_is_said(self) -> None:
        outputs = [test["output"] for test in json.loads(gradescope(overridden()[0]))["tests"]]
        assert any("Set by Dr Noether: Seen in the lab" in output for output in outputs)


class TestJunit:
    """The form for CI."""

    @every_case
    def test_it_is_well_formed_and_counts(self, case: Callable[[], tuple[Grade, Evidence]]) -> None:
        grade, _ = case()
        root = ET.fromstring(junit(grade))
        cases = root.findall("testsuite/testcase")
        shown = [one for one in grade.criteria if one.component in grade.components]
        assert len(cases) == len(shown) == int(root.attrib["tests"])
        lost = [one for one in shown if one.points < one.max]
        bonus = [one for one in lost if one.component == "bonus"]
        assert (
            int(root.attrib["failures"])
            == len(root.findall("testsuite/testcase/failure"))
            == len(lost) - len(bonus)
        )
        assert int(root.attrib["skipped"]) == len(bonus)

    def test_a_failure_says_why(self) -> None:
        root = ET.fromstring(junit(full()[0]))
        failure = root.find("testsuite[@name='status_publisher']/testcase/failure")
        assert failure is not None
        assert failure.attrib["message"].startswith("5 of 10 points: The reason of status_publisher.period")
        assert failure.text == "Change it to create_timer(2.0, self.tick)."

    def test_an_override_is_said(self) -> None:
        assert "Set by Dr Noether" in junit(overridden()[0])


class TestGitHub:
    """Annotations of GitHub Actions."""

    def test_a_fault_stands_at_its_line_and_the_points_are_noticed(self) -> None:
        fault = Fault("code", "status", "The period is 2.4 s.", "src/a b/talker.py:12", "write 2.0")
        other = Fault("code", "workspace", "Nothing came.", "/robot/status", "")
        lines = github(grade_of([judgement("status.rate", 1, 2)], faults=[fault, other])).splitlines()
        assert lines == [
            "::warning title=status,file=src/a b/talker.py,line=12::The period is 2.4 s.%0AFix: write 2.0",
            "::warning title=workspace::Nothing came.",
            "::notice title=ros2lab::ada.zip: 1 of 2 points",
        ]

    def test_no_hostile_text_begins_a_command_or_ends_a_property(self) -> None:
        fault = Fault(
            "code", "x", "a\n::error::b 100%", "\x1b[1m\u2028a,line=7,b::c.py:3", "x\r\n::add-mask::y"
        )
        lines = github(grade_of([], faults=[fault], submission="z\n::error::w")).splitlines()
        assert len(lines) == 2
        assert all(line.startswith(("::warning title=", "::notice title=")) for line in lines)
        assert not any(is_hidden(ord(letter)) for letter in "".join(lines))
        assert "line=7" not in lines[0].partition("::")[2].partition("::")[0].replace("%2Cline=7", "")

    def test_no_line_of_the_table_is_beside_them(self, tmp_path: Path) -> None:
        """One that begins with what a submission has written would be a command of its own."""
        seen = tmp_path / "seen.json"
        seen.write_text(evidence_json(hostile()[1]))
        done = CliRunner().invoke(app, ["regrade", str(seen), "--github", "-"])
        assert done.exit_code == 0, done.output
        assert all(
            line.startswith(("::warning title=", "::notice title=")) for line in done.stdout.splitlines()
        )


class TestTable:
    """The form for the terminal."""

    @pytest.mark.parametrize("width", [60, 100])
    def test_it_says_total_losses_and_notes(self, width: int) -> None:
        text = " ".join(shown_table(full()[0], width).split())
        assert f"ada.zip: {number(full()[0].total)} of 100 points" in text
        assert "Note: build/ and install/ were handed in" in text

    def test_brackets_are_no_markup(self) -> None:
        grade = grade_of(
            [judgement("package.x", 0, 1, title="[red]x[/red]", reason="[link=y]", hint=":smile:")]
        )
        text = shown_table(replace(grade, notes=["[bold]", "[/]"], submission="[blink]"))
        for words in ("[red]x[/red]", "[link=y]", ":smile:", "[bold]", "[/]", "[blink]"):
            assert words in text

    def test_an_override_is_said(self) -> None:
        assert "package.manifest: 5 of 5, set by Dr Noether" in shown_table(overridden()[0])


def same(left: Any, right: Any) -> bool:
    """Return whether two pieces of data are the same, to the type and to nan."""
    if type(left) is not type(right):
        return False
    if isinstance(left, dict):
        return list(left) == list(right) and all(same(left[key], right[key]) for key in left)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(same, left, right))
    if isinstance(left, float):
        return math.copysign(1, left) == math.copysign(1, right) and (
            left == right or (math.isnan(left) and math.isnan(right))
        )
    return bool(left == right)


ODD: list[Any] = [
    math.nan,
    math.inf,
    -math.inf,
    -0.0,
    1e-320,
    2**80,
    -(2**20_000),
    {"$int": "0x1"},
    True,
    None,
    "",
    [],
    {},
    {"$float": "nan"},
    {"$float": math.nan},
    {"$$float": 1, "$": 2, "": 3},
    {"a": [{"$float": [math.inf]}]},
    "\ud800\x00\u2028",
    [[[[[]]]]],
    "nan",
    *HOSTILE,
]


class TestEvidence:
    """Evidence is written and read back."""

    @every_case
    def test_nothing_is_lost(self, case: Callable[[], tuple[Grade, Evidence]]) -> None:
        _, evidence = case()
        again = read_evidence(evidence_json(evidence))
        assert same(asdict(again), asdict(evidence))
        assert type(again.files) is Files
        assert all(type(run) is Run for run in again.runs)

    @pytest.mark.parametrize("value", ODD, ids=range(len(ODD)))
    def test_odd_values_are_kept(self, value: Any) -> None:
        heard = Heard(STRING, "", [math.nan, math.inf, 0.5, 3], [{"x": value}, {"y": value}], 2)
        files = Files(
            manifest={"$x": True},
            handlers={"by name": [Place("a.py", 3)]},
            parameter_files={"f": {"/**": {"p": value}}},
            readme_commands={"ros2 run": None, "x": False},
        )
        seen = CommandSeen("", [], {"$t": heard}, {"p": value}, is_alive=False)
        evidence = evidence_of(
            [run_of(["p"], quiet={"/t": heard}, commands=[seen])],
            files=files,
            tests={"x": value, "list": [value, {"deep": value}]},
            seconds={"total": math.inf},
        )
        text = evidence_json(evidence)
        again = read_evidence(text)
        assert same(asdict(again), asdict(evidence))
        assert evidence_json(again) == text
        json.loads(text, parse_constant=pytest.fail)  # strict JSON has no NaN

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            (
                lambda data: data["runs"][1]["commands"][2].update(log=7),
                r"runs\[1\]\.commands\[2\]\.log must be a list",
            ),
            (
                lambda data: data["runs"][0]["quiet"]["/robot/status"]["times"].append("x"),
                r"times\[3\] must be a number",
            ),
            (
                lambda data: data["runs"][0].update(clock="sundial"),
                r"runs\[0\]\.clock must be stepped or real",
            ),
            (
                lambda data: data["build"].update(is_built=1),
                r"build\.is_built must be true or false, and is a whole",
            ),
            (
                lambda data: data["runs"][0]["quiet"]["/robot/status"].update(count=True),
                "count must be a whole number",
            ),
            (lambda data: data["runs"][0].pop("nodes"), r"runs\[0\] has no nodes"),
            (lambda data: data.update(more=1), "the whole has 'more', which is not known"),
            (lambda data: data.update(files=None), "files must be an object, and is null"),
            (lambda data: data.update(sandbox={"$float": "nan"}), "sandbox must be a text, and is a number"),
        ],
    )
    def test_what_does_not_fit_is_said_with_its_place(
        self, change: Callable[[dict[str, Any]], Any], words: str
    ) -> None:
        data = json.loads(evidence_json(full()[1]))
        change(data)
        with pytest.raises(EvidenceError, match=words) as caught:
            read_evidence(json.dumps(data))
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("", "not JSON"),
            ("[" * 100_000, "not JSON"),
            ('{"$float": []}', "not JSON"),
            ("[1]", "does not say its schema"),
            ("{}", "does not say its schema"),
            ('{"schema": 99}', "newer than this ros2lab"),
            ('{"schema": 0}', "older than this ros2lab"),
        ],
        ids=range(7),
    )
    def test_what_is_no_evidence_of_this_version_is_refused(self, text: str, words: str) -> None:
        with pytest.raises(EvidenceError, match=words):
            read_evidence(text)

    def test_what_has_a_default_may_be_missing(self) -> None:
        data = json.loads(evidence_json(empty()[1]))
        data["files"] = {}
        assert read_evidence(json.dumps(data)).files == Files()

    @pytest.mark.parametrize(
        ("value", "words"), [({1: 2}, "tests.x is no text but 1"), (b"x", r"bytes.*tests\.x")]
    )
    def test_what_json_cannot_hold_is_refused_with_its_place(self, value: Any, words: str) -> None:
        with pytest.raises(TypeError, match=words):
            evidence_json(evidence_of([], tests={"x": value}))

    def test_the_cases_know_every_field(self) -> None:
        """A field that is new in the evidence is in the round trip, too."""
        data = json.loads(evidence_json(full()[1]))
        assert set(data) == set(evidence_module.Evidence.__dataclass_fields__)
        assert set(data["files"]) == set(Files.__dataclass_fields__)


def test_a_place_with_a_blank_is_one_place() -> None:
    fault = Fault("code", "package", "It is wrong.", "src/drive node.py:5", "Fix it.")
    said = markdown(replace(full()[0], faults=[fault]))
    assert "- Place: `src/drive node.py:5`" in said
