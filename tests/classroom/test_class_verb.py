"""`ros2lab class`, typed: a small class is graded, killed on the way, and goes on; what is wrong is one sentence."""

from __future__ import annotations

import io
import json
import os
import re
import shlex
import signal
import sqlite3
import subprocess
import sys
import zipfile
from pathlib import Path

import psutil
import pytest
from typer.testing import CliRunner

from ros2lab.classroom.gradebook import Seen, Worth, opened
from ros2lab.classroom.handed_in import HandedIn
from ros2lab.cli import app

COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()"]
DOCUMENT = Path(__file__).parents[2] / "docs/instructors.md"
TIMEOUT = 500  # s

NODE = """import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("status_publisher")
    publisher = node.create_publisher(String, "/robot/status", 10)
    node.create_timer(2.0, lambda: publisher.publish(String(data="{text}")))
    rclpy.spin(node)


main()
"""
NOTHING = "print('{text}')\n"


def zipped(text: str, source: str = NODE) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr("robot/status_publisher.py", source.format(text=text))
    return data.getvalue()


@pytest.fixture
def canvas(tmp_path: Path) -> Path:
    """A class of four: one has handed in late, one a broken zip, one has a formula for a name.

    That one has no node, so that it is not built and run.
    """
    folder = tmp_path / "submissions"
    folder.mkdir()
    for name, data in {
        "maieranna_LATE_1001_2_ws-1.zip": zipped("second"),
        "broken_1002_3_ws.zip": zipped("x")[:-40],
        "=cmd|' C calc'!A0_1003_4_ws.zip": zipped("third", NOTHING),
        "müllerjörg_1004_5_ws.zip": zipped("second"),
    }.items():
        (folder / name).write_bytes(data)
    return folder


def run(*words: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, "class", *map(str, words)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )


def gradings(grades: Path) -> int:
    path = grades / "gradebook.sqlite"
    if not path.exists():
        return 0
    with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as book:
        (count,) = book.execute("SELECT count(*) FROM grading").fetchone()
    book.close()
    return int(count)


@pytest.mark.long
def test_a_class_that_is_killed_goes_on_and_is_handed_back_as_the_document_says(
    canvas: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Killed with SIGKILL when the first is graded and the next is at work; nothing is lost, nothing graded twice."""
    commands = [
        shlex.split(line)[2:]
        for block in re.findall(r"```bash\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
        for line in block.splitlines()
        if line.startswith("ros2lab class")
    ]
    grade, *others = commands
    assert grade == ["grade", "submissions"]
    # One after the other, so that there is something left when it is killed.
    killed = subprocess.Popen(
        [*COMMAND, "class", *grade, "--jobs", "1", "--json"], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    )
    with killed:
        assert killed.stdout is not None
        graded = 0
        for line in killed.stdout:
            event = json.loads(line)
            graded += event["event"] == "done"
            if event["event"] == "step" and graded == 2 and event["step"] == "building":
                workers = psutil.Process(killed.pid).children()
                killed.send_signal(signal.SIGKILL)
                break
    before = gradings(tmp_path / "grades")
    assert graded == before == 2
    psutil.wait_procs(workers, timeout=60)
    assert not [worker for worker in workers if worker.is_running()]

    again = run(*grade, cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "1/1" in again.stderr
    assert gradings(tmp_path / "grades") == 3  # what two have handed in is graded once
    assert "4 of 4 are graded" in again.stdout
    monkeypatch.chdir(tmp_path)
    third = CliRunner().invoke(app, ["class", *grade])
    assert third.stderr == ""
    assert gradings(tmp_path / "grades") == 3

    (tmp_path / "decisions.csv").write_text(
        "student,criterion,points,comment,by\n1002,documentation.readme,2,It came by mail.,I. Structor\n"
    )
    (tmp_path / "from_canvas.csv").write_text(
        "Student,ID,SIS User ID,SIS Login ID,Section,Week 2 (77)\n    Points Possible,,,,,100\n"
        '"Maier, Anna",1001,,,,\n"B, Roken",1002,,,,\n'
    )
    (tmp_path / "from_moodle.csv").write_text(
        "Identifier,Full name,Grade,Last modified (grade),Feedback comments\nParticipant 1004,Jörg Müller,,-,\n"
    )
    said = ""
    for words in others:
        done = CliRunner().invoke(app, ["class", *words])
        assert done.exit_code == 0, (words, done.stderr)
        said += done.stdout
    assert "1 have other points now" in said
    page = (tmp_path / "grades/class.html").read_text(encoding="utf-8")
    assert "byte for byte" in page
    median = re.search(r"the median is [\d.]+\d", CliRunner().invoke(app, ["class", *grade]).stdout)
    assert median
    assert median[0] in page
    assert "is broken or incomplete" in page
    assert "It came by mail." in next((tmp_path / "grades/reports").glob("broken-*")).read_text()
    links = re.findall(r'href="(reports/[^"]+)"', page)
    assert len(links) == 4
    rows = (tmp_path / "grades/canvas.csv").read_text().splitlines()
    assert rows[3].endswith(",5")  # 2 and 3 that were decided
    assert gradings(tmp_path / "grades") == 3


def test_ctrl_c_ends_everything_and_says_how_to_go_on(canvas: Path, tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*COMMAND, "class", "grade", "submissions", "--json"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()  # something is being graded
        workers = psutil.Process(process.pid).children()
        process.send_signal(signal.SIGINT)
        said = process.stderr.read()
    assert process.returncode == 130
    assert "goes on where it was" in said
    assert len(said.splitlines()) == 1
    assert not [
        worker for worker in workers if worker.is_running() and worker.status() != psutil.STATUS_ZOMBIE
    ]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["grade", "nowhere"], "There is no nowhere"),
        (["grade", "submissions", "--jobs", "many"], "--jobs is a number"),
        (["grade", "submissions", "--jobs", "0"], "--jobs is a number"),
        (["grade", "submissions", "--only", "Zoe"], "Nobody in this class"),
        (["grade", "submissions", "--out", "submissions/x"], "lies in what is graded"),
        (["grade", "submissions", "--quiet", "--json"], "Give either"),
        (["grade", "submissions", "--rubric", "nowhere.yaml"], "nowhere.yaml cannot be read"),
        (["grade", "submissions", "--from", "nbgrader"], "no submissions"),
        (["regrade"], "no gradebook"),
        (["report", "elsewhere"], "no gradebook"),
        (["export", "canvas"], "no gradebook"),
        (["override", "Ann", "x.y", "1"], "no gradebook"),
        (["override", "--comment", "No.", "Ann", "x.y", "-1"], "no gradebook"),
        (["override", "Ann", "x.y", "-1.5", "--by", "me"], "no gradebook"),
    ],
)
def test_wrong_usage_is_one_sentence(
    words: list[str], sentence: str, canvas: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["class", *words])
    assert done.exit_code == 2
    assert sentence in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_a_dry_run_says_what_would_be_done_and_grades_nothing(
    canvas: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (canvas / "empty_1009_8_ws.zip").write_bytes(b"")
    done = CliRunner().invoke(app, ["class", "grade", "submissions", "--dry-run"])
    assert done.exit_code == 0, done.output
    assert "4 would be graded" in done.stdout
    assert "empty cannot be graded" in done.stdout
    assert not (tmp_path / "grades").exists()


def test_a_dry_run_names_all_who_have_handed_in_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "submissions").mkdir()
    for name in ("ann", "ben"):
        (tmp_path / f"submissions/{name}.zip").write_bytes(zipped("alike"))
    done = CliRunner().invoke(app, ["class", "grade", "submissions", "--dry-run"])
    assert "2 would be graded" in done.stdout, done.output
    assert {"ann would be graded.", "ben would be graded."} <= {*done.stdout.splitlines()}


def test_a_dry_run_keeps_the_grade_of_what_has_changed_since(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "submissions").mkdir()
    (tmp_path / "submissions/ann.zip").write_bytes(zipped("new"))
    with opened(tmp_path / "grades", is_new_allowed=True) as book:
        book.register([(HandedIn("ann", "Ann"), "what it was", 0)])
        book.record("what it was", "a", "g", Seen("{}", {}, "", 1), {"ann": Worth(90, 100, "{}", "r")})
    done = CliRunner().invoke(app, ["class", "grade", "submissions", "--dry-run"])
    assert "1 would be graded" in done.stdout, done.output
    with opened(tmp_path / "grades") as book:
        (row,) = book.rows()
    assert (row.state, row.digest, row.worth and row.worth.total) == ("graded", "what it was", 90)


def test_only_and_since_choose(canvas: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in canvas.iterdir():
        os.utime(path, (1_000_000_000, 1_000_000_000))
    os.utime(canvas / "broken_1002_3_ws.zip")
    for words, name in ((["--only", "1003"], "=cmd"), (["--since", "2020-01-01"], "broken")):
        done = CliRunner().invoke(app, ["class", "grade", "submissions", "--dry-run", *words])
        assert "1 would be graded" in done.stdout, done.output
        assert name in done.stdout
