"""A report of a hostile submission is opened in a browser: nothing runs, nothing is loaded."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser

from ros2lab.grading.evidence import SCHEMA, CommandSeen, Evidence, Files, Heard, Run
from ros2lab.grading.grade import Fault, Grade, Judgement, Points
from ros2lab.grading.receiving.submission import Submission
from ros2lab.grading.reports.html import html

pytestmark = pytest.mark.long

OPENING = ("", '"', "'", "</title>", "</style>", "</svg>", "</pre>", "</desc>", "-->", "]]>", "</textarea>")
PAYLOADS = (
    "<script>alert(1)</script>",
    "<img src=http://127.0.0.1:9/x onerror=alert(2)>",
    "<svg onload=alert(3)><a xlink:href=javascript:alert(4)>x</a></svg>",
    "<iframe srcdoc='<script>alert(5)</script>'></iframe>",
    " onmouseover=alert(6) style=background:url(http://127.0.0.1:9/y) x=",
    "<link rel=stylesheet href=http://127.0.0.1:9/z><base href=http://127.0.0.1:9/><meta http-equiv=refresh content=0>",
)
# Each begins with another end; shortened texts keep the payload that comes first.
HOSTILE = [
    f"{opening}>" + " ".join(PAYLOADS[number % len(PAYLOADS) :] + PAYLOADS[: number % len(PAYLOADS)])
    for number, opening in enumerate(OPENING)
]


def report(text: str) -> str:
    """Return a report in which a text stands wherever a submission can write."""
    heard = Heard("geometry_msgs/msg/Twist", text, [1.0, 2.0], [{"data": text}, {text: text}], 2)
    run = Run(
        [text],
        text,
        "stepped",
        [text],
        publishes={text: {text: [text]}},
        subscribes={text: {text: [text]}},
        qos={text: [text]},
        parameters={text: {text: text}},
        quiet={text: heard},
        commands=[CommandSeen(text, [["INFO", text]], {text: heard}, {text: text}, is_alive=True)],
        ended={text: text},
        stopped={text: {"seconds": 0.1, "said": text}},
        notes=[text],
    )
    submission = Submission("nothing", None, [], None, [], [])
    evidence = Evidence(SCHEMA, text, text, submission, Files(), None, [run], {}, {}, "none", {})
    one = Judgement("package.x", "package", text, 0, 1, text, text, [text])
    grade = Grade(
        1,
        text,
        0,
        1,
        {"package": Points(0, 1)},
        [one],
        [Fault(text, "package", text, text, text)],
        [text],
        "stepped",
        text,
        {text: 1.0},
        {text: text},
    )
    return html(grade, evidence)


def test_nothing_of_a_hostile_report_runs(browser: Browser, tmp_path: Path) -> None:
    """No dialog, no request beside the file, no complaint of the console, and no element that is not ours."""
    events: list[str] = []
    context = browser.new_context(viewport={"width": 320, "height": 640})
    page = context.new_page()
    page.on("dialog", lambda dialog: (events.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.on("console", lambda message: events.append(f"console: {message.text}"))
    page.on("pageerror", lambda error: events.append(f"error: {error}"))
    page.on("popup", lambda popup: events.append(f"popup: {popup.url}"))
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    files = []
    for number, text in enumerate(HOSTILE):
        file = tmp_path / f"{number}.html"
        file.write_text(report(text), encoding="utf-8")
        files.append(file.as_uri())
        page.goto(files[-1])
        assert page.locator("script, img, iframe, link, base, form, object, embed, a[href*=':']").count() == 0
        assert page.locator("main").inner_text().count("alert")
        width = page.evaluate("document.documentElement.scrollWidth")
        assert width <= 320, "nothing sticks out on a phone"
    page.mouse.move(100, 100)
    page.keyboard.press("Tab")
    context.close()
    assert events == []
    assert requests == files
