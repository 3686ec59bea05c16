"""How many submissions of a class are graded in a minute, one at a time and as many as the machine bears.

    python class_grading.py --size 60            # as the figures take it
    python class_grading.py --size 500 --kills 3 # a large one, killed on the way and started again

A class is made of the corpus of tests/grading: two in five are mostly right work in another form, as a class of 100
has all of them, and the others styles and faults in turn; six mean harm, four are copies of one with other names, and
some came late and twice. All are called as Canvas calls them.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
from row import Quantity, Row

if TYPE_CHECKING:
    from corpus import Case

CORPUS = Path(__file__).parents[1] / "tests/grading"
COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()", "class"]
HOSTILE, COPIES, TWICE = 6, 4, 5
SIZE, SMALL = 60, 4
COPIED = "style/one_process_multithreaded"


@dataclass(frozen=True)
class Graded:
    """What came of grading a class.

    Attributes:
        seconds: all in all.
        memory: the most that the command and all below it held at one time, in bytes.
        going_on: from the start after a kill to the first step of a grading, in s.
        totals: by student.
        gradings: how many were made.
    """

    seconds: float
    memory: int
    going_on: list[float]
    totals: dict[str, float | None]
    gradings: int


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Grade the same class one at a time and at --jobs auto, and compare the grades."""
    size = SMALL if is_quick else SIZE
    with _made(size) as folder:
        alone = graded(folder / "class", folder / "alone", "1")
        advance(0.7)
        together = graded(folder / "class", folder / "together", "auto", kills=1)
    different = sum(alone.totals[key] != total for key, total in together.totals.items())
    return [
        Row(
            f"submissions a minute, {size} of a class at --jobs auto",
            Quantity(60 * together.gradings / together.seconds, "a minute"),
            "the same, one at a time",
            Quantity(60 * alone.gradings / alone.seconds, "a minute"),
            note="with one kill -9 on the way",
        ),
        Row(
            f"different totals of {size} submissions, alone and in the class",
            Quantity(different, "totals"),
            limits={"value": 0.0},
        ),
        Row(
            "memory of a class at --jobs auto",
            Quantity(together.memory / 1e6, "MB"),
            "one at a time",
            Quantity(alone.memory / 1e6, "MB"),
            note="resident, shared pages counted once (PSS where Linux tells it)",
        ),
        Row(
            "from a start after kill -9 until the next is being graded",
            Quantity.of_samples(together.going_on, "s"),
        ),
    ]


def graded(submissions: Path, grades: Path, jobs: str, kills: int = 0) -> Graded:
    """Grade a class, killed so many times when so many shares of it are done, and started again."""
    size = sum(1 for _ in submissions.iterdir())
    kill_at = [size * (number + 1) // (kills + 1) for number in range(kills)]
    begin, going_on, was_killed = time.monotonic(), list[float](), False
    with _memory() as memory:
        while True:
            started, is_first = time.monotonic(), was_killed
            command = [*COMMAND, "grade", str(submissions), "--out", str(grades), "--jobs", jobs, "--json"]
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
                memory.watch(process.pid)
                was_killed = False
                for line in process.stdout or ():
                    event = json.loads(line)
                    if is_first and event["event"] == "step":
                        going_on.append(time.monotonic() - started)
                        is_first = False
                    if kill_at and event["event"] == "done" and _gradings(grades) >= kill_at[0]:
                        del kill_at[0]
                        process.send_signal(signal.SIGKILL)
                        was_killed = True
                        break
            if not was_killed:
                break
    with contextlib.closing(sqlite3.connect(grades / "gradebook.sqlite")) as book:
        totals = dict(book.execute("SELECT student, total FROM submission LEFT JOIN grade USING (student)"))
    return Graded(time.monotonic() - begin, memory.most, going_on, totals, _gradings(grades))


def _gradings(grades: Path) -> int:
    with contextlib.closing(sqlite3.connect(grades / "gradebook.sqlite")) as book:
        return int(book.execute("SELECT count(*) FROM grading").fetchone()[0])


class _Memory:
    """The most memory that a process and all below it hold."""

    def __init__(self) -> None:
        self.most = 0
        self.is_over = threading.Event()
        self._pid = 0

    def watch(self, pid: int) -> None:
        self._pid = pid

    def run(self) -> None:
        while not self.is_over.wait(1.0):
            with contextlib.suppress(psutil.Error):
                root = psutil.Process(self._pid)
                self.most = max(self.most, sum(map(_held, [root, *root.children(recursive=True)])))


def _held(process: psutil.Process) -> int:
    with contextlib.suppress(psutil.Error, AttributeError):
        return int(process.memory_full_info().pss)
    return 0


@contextlib.contextmanager
def _memory() -> Iterator[_Memory]:
    memory = _Memory()
    thread = threading.Thread(target=memory.run)
    thread.start()
    try:
        yield memory
    finally:
        memory.is_over.set()
        thread.join()


@contextlib.contextmanager
def _made(size: int) -> Iterator[Path]:
    with tempfile.TemporaryDirectory(prefix="ros2lab-class-") as name:
        made_class(Path(name) / "class", size)
        yield Path(name)


def made_class(folder: Path, size: int) -> None:
    """Write a class of so many students as Canvas gives it to download."""
    sys.path.insert(0, str(CORPUS))
    import corpus  # noqa: PLC0415

    folder.mkdir(parents=True)
    hostile = min(HOSTILE, size // 10)
    copies = min(COPIES, size // 4)
    others = size - hostile - copies
    fair = [case for case in (*corpus.STYLES, *corpus.EXTREMES, *corpus.FAULTS) if case.assignment is None]
    # What is copied is not the model, which most of the corpus is made from and which is nobody's own.
    copied = next(case for case in fair if case.name == COPIED)
    fair.remove(copied)
    forms = [case for case in fair if case.name.startswith(("form/", "extreme/"))]
    shown = _spread(forms, others * 2 // 5)
    rest = _spread([case for case in fair if case not in forms], others - 1 - len(shown))
    chosen = [copied, *shown, *rest, *_spread(corpus.HOSTILE, hostile)]
    user = 1000
    for user, case in enumerate(chosen, start=1001):
        with tempfile.TemporaryDirectory() as scratch, case.handed_in(Path(scratch)) as path:
            _hand_in(path, folder / f"student{user}_{user}_{user + 9000}_ws")
    original = next(folder.glob("student1001_*.zip"))
    for number in range(copies):
        _copy(original, folder / f"copy{number}_{user + number + 1}_{user + number + 9500}_ws.zip", number)
    for path in sorted(folder.glob("student*.zip"))[: min(TWICE, size // 4)]:
        name, user_id, upload, _ = path.name.split("_", 3)
        shutil.copy(path, folder / f"{name}_LATE_{user_id}_{int(upload) + 50_000}_ws-1.zip")


def _spread(cases: Sequence[Case], count: int) -> list[Case]:
    """Return so many cases, evenly from the first to the last; all if there are fewer."""
    count = min(count, len(cases))
    return [cases[number * len(cases) // count] for number in range(count)]


def _hand_in(path: Path, place: Path) -> None:
    if path.is_dir():
        try:
            shutil.make_archive(str(place), "zip", path.parent, path.name)
        except (OSError, ValueError):  # sockets, times before 1980: such a folder is no zip
            shutil.copytree(path, place, symlinks=True, ignore_dangling_symlinks=True)
    elif not path.exists():
        place.with_name(f"{place.name}.zip").touch()  # what never came is an empty upload
    else:
        suffix = "".join(path.suffixes[-2:])
        shutil.copy(path, place.with_name(place.name + suffix))


def _copy(original: Path, copy: Path, number: int) -> None:
    """Hand the work of somebody else in, with other names in it."""
    with tempfile.TemporaryDirectory() as scratch:
        shutil.unpack_archive(original, scratch)
        for path in Path(scratch).rglob("*.py"):
            text = path.read_text(encoding="utf-8")
            for name in ("count", "period", "word", "command", "speed"):
                text = text.replace(f"self.{name} ", f"self.my_{name}_{number} ")
            path.write_text(f"# {number}\n{text}", encoding="utf-8")
        shutil.make_archive(str(copy.with_suffix("")), "zip", scratch)


def main() -> None:
    """Grade a made-up class and say what came of it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=SIZE)
    parser.add_argument("--jobs", default="auto")
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--out", type=Path, help="where the class and the grades stay")
    options = parser.parse_args()
    folder = options.out or Path(tempfile.mkdtemp(prefix="ros2lab-class-"))
    made_class(folder / "class", options.size)
    done = graded(folder / "class", folder / "grades", options.jobs, options.kills)
    print(
        f"{len(done.totals)} students, {done.gradings} gradings in {done.seconds:.0f} s: "
        f"{60 * done.gradings / done.seconds:.1f} a minute; {done.memory / 1e6:.0f} MB at most; "
        f"going on after a kill: {', '.join(f'{seconds:.1f} s' for seconds in done.going_on) or 'not tried'}; "
        f"without a grade: {', '.join(key for key, total in done.totals.items() if total is None) or 'nobody'}. "
        f"See {folder / 'grades'}."
    )


if __name__ == "__main__":
    main()
