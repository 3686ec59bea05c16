"""A made-up class, graded, killed on the way, reported, decided and handed back by the commands of docs/instructors.md.

    python class_by_the_page.py                       # 120 students, killed three times: half an hour on two cores
    python class_by_the_page.py --size 20 --kills 1

The commands are typed into a shell as they stand there. At the end a line says of each promise whether it was kept,
and Chromium's pictures of the report lie beside it.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import json
import os
import re
import shlex
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from class_grading import COPIES, made_class
from playwright.sync_api import sync_playwright

from ros2lab import environment

PAGE = Path(__file__).parents[1] / "docs/instructors.md"
CHROMIUM = "/usr/bin/chromium"
ASSIGNMENT = "Week 2 (77)"
MOODLE_MOST = 100
DECIDED = ("1003", "documentation.readme", "2")  # in the CSV
BY_HAND = ("1002", "documentation.code", "3")  # on the page


def commands() -> list[str]:
    """Return the commands about a class, as the page has them."""
    blocks = re.findall(r"```bash\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.startswith("ros2lab class")]


class Desk:
    """A folder in which an instructor types, and what is promised and kept there."""

    def __init__(self, folder: Path, size: int) -> None:
        self.folder = folder
        self.book = folder / "grades/gradebook.sqlite"
        self.kept: list[tuple[str, bool]] = []
        self._environ = environment.lab_environment()
        scripts = str(Path(sys.executable).parent)
        self._environ["PATH"] = os.pathsep.join([scripts, self._environ["PATH"]])
        made_class(folder / "submissions", size)
        self.uploads = sorted(path.name for path in (folder / "submissions").iterdir())
        self.students = sorted({re.sub(r"_(LATE_)?", "_", name).split("_")[1] for name in self.uploads})

    def promise(self, what: str, is_kept: bool) -> None:
        """Note a promise, and say whether it was kept."""
        self.kept.append((what, is_kept))
        print(f"{'kept  ' if is_kept else 'BROKEN'}  {what}", flush=True)

    def typed(self, command: str) -> str:
        """Type a command, and return what it says."""
        begin = time.monotonic()
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=self.folder,
            env=self._environ,
            capture_output=True,
            text=True,
            check=False,
        )
        print(f"$ {command}\n{done.stdout}{done.stderr}({time.monotonic() - begin:.1f} s)", flush=True)
        self.promise(f"`{command}` ends with 0", done.returncode == 0)
        return done.stdout

    def graded_until(self, command: str, count: int) -> None:
        """Type a command, and kill it with all its force when so many are in the gradebook."""
        with subprocess.Popen(
            shlex.split(command), cwd=self.folder, env=self._environ, stderr=subprocess.PIPE, text=True
        ) as process:
            for line in process.stderr or ():
                print(line, end="", flush=True)
                if self.count("SELECT count(*) FROM grading") >= count:
                    process.send_signal(signal.SIGKILL)
                    break
        print(f"(killed with {self.count('SELECT count(*) FROM grading')} graded)", flush=True)

    def rows(self, question: str) -> list[tuple[Any, ...]]:
        """Ask the gradebook."""
        with contextlib.closing(sqlite3.connect(self.book)) as book:
            return book.execute(question).fetchall()

    def count(self, question: str) -> int:
        """Ask the gradebook for a number; 0 while there is none."""
        return int(self.rows(question)[0][0]) if self.book.exists() else 0

    def totals(self) -> dict[str, float]:
        """Return what each student has."""
        return dict(self.rows("SELECT student, total FROM grade"))

    def write_what_the_page_takes(self) -> None:
        """Write what an instructor has of the platforms, and has decided."""
        lines = [f'"Name of, {key}",{key},s{key},login{key},A,-1,,7' for key in self.students]
        (self.folder / "from_canvas.csv").write_text(
            f"Student,ID,SIS User ID,SIS Login ID,Section,Week 1 (5),{ASSIGNMENT},Final Score\n"
            "    Points Possible,,,,,10,100,(read only)\n" + "\n".join(lines) + "\n"
        )
        lines = [
            f'Participant {key},"Müller, {key}",{key}@example.org,Submitted,,{MOODLE_MOST}.00,Yes,-,-,'
            for key in self.students
        ]
        (self.folder / "from_moodle.csv").write_text(
            "Identifier,Full name,Email address,Status,Grade,Maximum Grade,Grade can be changed,"
            "Last modified (submission),Last modified (grade),Feedback comments\n" + "\n".join(lines) + "\n"
        )
        (self.folder / "decisions.csv").write_text(
            f"student,criterion,points,comment,by\n{','.join(DECIDED)},It came by mail.,I. Structor\n"
        )
        rubric = resources.files("ros2lab.assignments").joinpath("week2/rubric.yaml").read_text("utf-8")
        mine = rubric.replace("documentation.readme, points: 2", "documentation.readme, points: 3")
        mine = mine.replace("documentation.code, points: 3", "documentation.code, points: 2")
        (self.folder / "mine.yaml").write_text(mine)

    def table(self, name: str) -> tuple[list[str], dict[str, dict[str, str]]]:
        """Return the header of an exported CSV, and its lines by the number that names a student."""
        with (self.folder / "grades" / name).open(encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            lines = [*reader]
        key = "ID" if "ID" in (reader.fieldnames or ()) else "Identifier"
        return [*(reader.fieldnames or ())], {line[key].rpartition(" ")[2]: line for line in lines}


def main() -> int:
    """Handle a made-up class; return 0 if each promise was kept."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=120)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--out", type=Path, help="an empty folder, in which all of it stays")
    options = parser.parse_args()
    desk = Desk(options.out or Path(tempfile.mkdtemp(prefix="ros2lab-class-")), options.size)
    print(f"{len(desk.uploads)} uploads of {len(desk.students)} students in {desk.folder}")
    desk.write_what_the_page_takes()
    grade, *others = commands()
    _graded(desk, grade, options.kills)
    for command in others:
        desk.typed(command)
    _decided(desk)
    _handed_back(desk)
    _looked_at(desk)
    broken = sum(not is_kept for _, is_kept in desk.kept)
    print(f"{len(desk.kept) - broken} of {len(desk.kept)} promises were kept; see {desk.folder / 'grades'}.")
    return int(bool(broken))


def _graded(desk: Desk, grade: str, kills: int) -> None:
    size = len(desk.students)
    for number in range(kills):
        desk.graded_until(grade, size * (number + 1) // (kills + 1))
        before = desk.count("SELECT count(*) FROM grading")
        whole = desk.count("SELECT count(*) FROM grade") >= before
        desk.promise(f"after kill {number + 1} each of {before} gradings has its grade", whole)
    begin = time.monotonic()
    desk.typed(grade)
    print(f"The rest took {time.monotonic() - begin:.0f} s.")
    states = Counter(state for (state,) in desk.rows("SELECT state FROM submission"))
    desk.promise(
        f"each of {size} is a row, graded or with a reason: {dict(states)}",
        sum(states.values()) == size and not states.keys() & {"waiting", "failed"},
    )
    reasons = desk.count("SELECT count(*) FROM submission WHERE state = 'unreadable' AND reason = ''")
    desk.promise("what cannot be graded says why", not reasons)
    digests = desk.count("SELECT count(DISTINCT digest) FROM submission WHERE state = 'graded'")
    desk.promise("nothing is graded twice", desk.count("SELECT count(*) FROM grading") == digests)
    late = {key for (key,) in desk.rows("SELECT student FROM submission WHERE is_late")}
    uploaded = {name.split("_LATE_")[1].split("_")[0] for name in desk.uploads if "_LATE_" in name}
    desk.promise(f"who came late is late: {', '.join(sorted(late))}", late == uploaded)


def _decided(desk: Desk) -> None:
    with_both = desk.totals()
    desk.promise("both decisions count", {BY_HAND, DECIDED} <= {*_judged(desk)})
    desk.typed("ros2lab class regrade --rubric mine.yaml")
    with_mine = desk.totals()
    desk.promise("another rubric gives other points, without a run", with_mine != with_both)
    desk.typed("ros2lab class regrade")
    desk.promise("the course's rubric gives the same points again", desk.totals() == with_both)


def _judged(desk: Desk) -> Iterator[tuple[str, str, str]]:
    """Yield student, criterion and points of what an instructor has decided, as the exported grades say it."""
    for line in (desk.folder / "grades/grades.jsonl").read_text(encoding="utf-8").splitlines():
        student = json.loads(line)
        for criterion in (student["grade"] or {"criteria": ()})["criteria"]:
            if criterion.get("override"):
                yield student["student"], criterion["id"], f"{criterion['points']:g}"


def _handed_back(desk: Desk) -> None:
    totals = desk.totals()
    header, lines = desk.table("canvas.csv")
    given = (desk.folder / "from_canvas.csv").read_text(encoding="utf-8").splitlines()
    desk.promise("Canvas's own columns are kept", header == given[0].split(","))
    del lines[""]
    right = all(float(lines[key][ASSIGNMENT]) == round(total, 2) for key, total in totals.items())
    ungraded = all(not line[ASSIGNMENT] for key, line in lines.items() if key not in totals)
    desk.promise("Canvas gets each total, and nothing for those without a grade", right and ungraded)
    others = all(
        (line["Week 1 (5)"], line["SIS User ID"]) == ("-1", f"s{key}") for key, line in lines.items()
    )
    desk.promise("what else stands in Canvas's file is as it was", others)
    header, lines = desk.table("moodle.csv")
    given = (desk.folder / "from_moodle.csv").read_text(encoding="utf-8").splitlines()
    desk.promise("Moodle's own columns are kept", header == given[0].split(","))
    right = all(
        float(lines[key]["Grade"]) == min(MOODLE_MOST, round(total, 2)) for key, total in totals.items()
    )
    desk.promise("Moodle gets each total, as far as it takes it", right)
    commented = all(lines[key]["Feedback comments"].endswith(("points.", ">", ".")) for key in totals)
    desk.promise("Moodle gets a comment for each", commented)
    folders = [*(desk.folder / "grades/feedback").iterdir()]
    whole = all(
        {"feedback.md", "report.html"} == {path.name for path in folder.iterdir()} for folder in folders
    )
    desk.promise(f"{len(folders)} students have feedback", whole and len(folders) == len(totals))
    results = [*(desk.folder / "grades/gradescope").rglob("results.json")]
    desk.promise(f"{len(results)} have Gradescope's results.json", len(results) == len(totals))


def _looked_at(desk: Desk) -> None:
    """Look at the report in a browser."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        said: list[str] = []
        page.on("console", lambda message: said.append(message.text))
        page.on("request", lambda request: said.append(request.url))
        page.goto((desk.folder / "grades/class.html").as_uri())
        page.screenshot(path=desk.folder / "class_top.png")
        rows = page.locator("#students tbody tr:visible")
        desk.promise(f"the page has {len(desk.students)} students", rows.count() == len(desk.students))
        page.get_by_role("button", name="Points").click()
        points = [float(cell) for cell in _values(page) if float(cell) >= 0]
        desk.promise("the table sorts by points", points == sorted(points))
        page.fill("#filter", "late")
        page.locator("#class").scroll_into_view_if_needed()
        page.screenshot(path=desk.folder / "class_late.png")
        desk.promise("the table filters", 0 < rows.count() < len(desk.students))
        page.fill("#filter", "")
        pairs = page.locator("details summary").all_inner_texts()
        copies = [pair for pair in pairs if len(re.findall(r"copy\d|student1001", pair)) == 2]
        family = min(COPIES, len(desk.students) // 4) + 1
        desk.promise(
            f"all who copied from each other are pairs: {len(copies)}, and {len(pairs) - len(copies)} more pairs",
            len(copies) == family * (family - 1) // 2,
        )
        page.locator("details").filter(has_text="copy0").first.locator("summary").click()
        page.locator("#alike").scroll_into_view_if_needed()
        page.screenshot(path=desk.folder / "class_alike.png")
        page.screenshot(path=desk.folder / "class_whole.png", full_page=True)
        links = page.locator("#students a")
        desk.promise("each graded student has a report", links.count() == len(desk.totals()))
        links.first.click()
        page.screenshot(path=desk.folder / "class_report.png")
        desk.promise("nothing but files is asked for", all(text.startswith("file:") for text in said))
        browser.close()


def _values(page: Any) -> Sequence[str]:
    cells = page.locator("#students tbody td.points")
    return [str(value) for value in cells.evaluate_all("cells => cells.map(cell => cell.dataset.value)")]


if __name__ == "__main__":
    sys.exit(main())
