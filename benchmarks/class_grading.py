"""How many submissions of a class are graded in a minute, one at a time and as many as the machine bears.

    python figures.py class_grading.rate         # a piece of what the figures measure; each takes ten minutes at most
    python class_grading.py --size 60            # a class of any size
    python class_grading.py --size 500 --kills 3 # a large one, killed on the way and started again

A class is made of the corpus of tests/grading: two in five are mostly right work in another form, as a class of 100
has all of them, and the others styles and faults in turn; six mean harm, four are copies of one with other names, and
some came late. All are called as Canvas calls them.
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
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
from row import Quantity, Row

from grading import autograde

if TYPE_CHECKING:
    from corpus import Case

CORPUS = Path(__file__).parents[1] / "tests/grading"
COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()", "class"]
HOSTILE, COPIES, LATE = 6, 4, 5
SMALL, FEW, SIZE, LARGE, MANY = 10, 12, 60, 120, 500
KILLS = 3
WORKERS = 3  # at most
LEAST_A_MINUTE = 20  # on two cores
COPIED = "style/one_process_multithreaded"


@dataclass(frozen=True)
class Graded:
    """What came of grading a class.

    Attributes:
        seconds: all in all.
        memory: the most that the command and all below it held at one time, in bytes.
        going_on: from the start after a kill to the first step of a grading, in s.
        points: at each criterion, by student; None for who has no grade.
        gradings: how many were made.
    """

    seconds: float
    memory: int
    going_on: list[float]
    points: dict[str, dict[str, float] | None]
    gradings: int

    @property
    def each(self) -> Quantity:
        """How long each has taken, of all that went on at once."""
        return Quantity(self.seconds / self.gradings, "s")

    @property
    def rate(self) -> str:
        """How many a minute."""
        return f"{60 * self.gradings / self.seconds:.1f} a minute"


Advance = Callable[[float], None]


def rate(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a class at --jobs auto, and every second of it again so and one at a time."""
    size = SMALL if is_quick else SIZE
    with _made(size) as folder:
        whole = graded(folder / "class", folder / "whole")
        advance(0.4)
        half = _only([*whole.points][::2])
        together = graded(folder / "class", folder / "together", *half)
        advance(0.6)
        alone = graded(folder / "class", folder / "alone", "--jobs", "1", *half)
    return [
        Row(
            f"a submission of a class of {size}, at --jobs auto",
            whole.each,
            limits={"value": 60 / LEAST_A_MINUTE},
            note=whole.rate,
        ),
        Row(
            "every second of them, at --jobs auto",
            together.each,
            "the same one at a time",
            alone.each,
            limits={"ratio": 1 / (2 * 0.9)},
            note=f"{together.rate}, and {alone.rate}",
        ),
        _different(alone, whole, together),
        _memory_row(f"memory of a class of {size} at --jobs auto", whole, "one at a time", alone),
    ]


def beside_nbgrader(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a few at --jobs auto, and as many notebooks with nbgrader."""
    size = _few(is_quick)
    with _made(size) as folder:
        small = graded(folder / "class", folder / "small")
        advance(0.6)
        peer = autograde(folder / "course", size) / size
    name = "nbgrader's autograde of a notebook with two cells"
    what = f"a submission of a class of {size}, at --jobs auto"
    return [Row(what, small.each, name, Quantity(peer, "s"), note=small.rate)]


def sizes(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a small class, and a usual one."""
    return _at_sizes(advance, (SMALL,) if is_quick else (SMALL, SIZE))


def large(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a large class."""
    return _at_sizes(advance, (SMALL,) if is_quick else (LARGE,))


def tiny(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade very many in which there is nothing to run: what a class itself costs, whatever a submission does."""
    size = SMALL if is_quick else MANY
    with tempfile.TemporaryDirectory(prefix="ros2lab-class-") as name:
        folder = Path(name)
        for number in range(size):
            path = folder / f"class/student{number}_{1000 + number}_{9000 + number}_ws"
            path.mkdir(parents=True)
            (path / "README.md").write_text(f"# The work of student {number}\n", encoding="utf-8")
        done = graded(folder / "class", folder / "grades")
    advance(1.0)
    return [_size_row(size, done, "each nothing but a README: no build and no run is in it")]


def on_workers(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a few at --jobs auto, and the same on one, two and three workers."""
    size, rows, seen = _few(is_quick), list[Row](), list[Graded]()
    with _made(size) as folder:
        here = graded(folder / "class", folder / "here")
        for count in range(1, WORKERS + 1):
            advance(count / (WORKERS + 1))
            with workers(count) as address:
                there = graded(folder / "class", folder / f"workers_{count}", "--scheduler", address)
            seen.append(there)
            what = f"a submission of {size}, on {count} worker{'s' if count > 1 else ''} of one thread"
            rows.append(Row(what, there.each, "at --jobs auto", here.each, note=there.rate))
    return [*rows, _different(here, *seen)]


def going_on(advance: Advance, *, is_quick: bool = False) -> list[Row]:
    """Grade a few, killed three times on the way."""
    with _made(_few(is_quick)) as folder:
        done = graded(folder / "class", folder / "grades", kills=1 if is_quick else KILLS)
    advance(1.0)
    what = "from a start after kill -9 until the next is being graded"
    return [Row(what, Quantity.of_samples(done.going_on, "s"))]


def _few(is_quick: bool) -> int:
    return SMALL // 2 if is_quick else FEW


def _only(students: Sequence[str]) -> list[str]:
    return [word for key in students for word in ("--only", key)]


def _at_sizes(advance: Advance, numbers: Sequence[int]) -> list[Row]:
    rows = list[Row]()
    for done, size in enumerate(numbers, start=1):
        with _made(size) as folder:
            rows.append(_size_row(size, graded(folder / "class", folder / "grades"), "styles and faults"))
        advance(done / len(numbers))
    return rows


def _size_row(size: int, done: Graded, note: str) -> Row:
    memory = f"{done.memory / 1e6:.0f} MB at most"
    return Row(f"a submission of {size}, at --jobs auto", done.each, note=f"{done.rate}; {memory}; {note}")


def _different(one: Graded, *others: Graded) -> Row:
    pairs = [(key, points) for other in others for key, points in other.points.items() if key in one.points]
    both = [(points, one.points[key]) for key, points in pairs if points or one.points[key]]
    different = sum(points != same for points, same in both)
    what = f"grades that differ of {len(both)}, at each criterion"
    return Row(what, Quantity(different, "grades"), limits={"value": 0.0})


def _memory_row(what: str, one: Graded, name: str, other: Graded) -> Row:
    note = "resident, shared pages counted once (PSS where Linux tells it)"
    return Row(what, Quantity(one.memory / 1e6, "MB"), name, Quantity(other.memory / 1e6, "MB"), note=note)


def graded(submissions: Path, grades: Path, *words: str, kills: int = 0) -> Graded:
    """Grade a class, killed so many times when so many shares of it are done, and started again.

    Args:
        submissions: of the class.
        grades: where its gradebook is made.
        words: options of `ros2lab class grade`.
        kills: how many times it is killed.
    """
    size = sum(1 for _ in submissions.iterdir())
    kill_at = [size * (number + 1) // (kills + 1) for number in range(kills)]
    begin, going_on, was_killed = time.monotonic(), list[float](), False
    with _memory() as memory:
        while True:
            started, is_first = time.monotonic(), was_killed
            command = [*COMMAND, "grade", str(submissions), "--out", str(grades), "--json", *words]
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
    seconds = time.monotonic() - begin
    with contextlib.closing(sqlite3.connect(grades / "gradebook.sqlite")) as book:
        given = book.execute("SELECT student, data FROM submission LEFT JOIN grade USING (student)")
        points = {student: _points(data) for student, data in given}
    return Graded(seconds, memory.most, going_on, points, _gradings(grades))


def _points(data: bytes | None) -> dict[str, float] | None:
    if data is None:
        return None
    return {one["id"]: one["points"] for one in json.loads(zlib.decompress(data))["criteria"]}


@contextlib.contextmanager
def workers(count: int) -> Iterator[str]:
    """Start a scheduler of dask and so many workers on this machine, and give its address."""
    dask = [sys.executable, "-m", "dask"]
    place = ["--host", "127.0.0.1", "--no-dashboard"]
    with contextlib.ExitStack() as stack:

        def start(*words: str) -> subprocess.Popen[str]:
            process = stack.enter_context(
                subprocess.Popen([*dask, *words, *place], stderr=subprocess.PIPE, text=True)
            )
            stack.callback(process.terminate)
            return process

        said = start("scheduler", "--port", "0").stderr or ()
        address = next(line.split()[-1] for line in said if "Scheduler at:" in line)
        for _ in range(count):
            start("worker", "--no-nanny", "--nthreads", "1", address)
        yield address


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
    for path in sorted(folder.glob("student*.zip"))[: min(LATE, size // 4)]:
        name, user_id, upload, _ = path.name.split("_", 3)
        path.rename(folder / f"{name}_LATE_{user_id}_{int(upload) + 50_000}_ws-1.zip")


def _spread(cases: Sequence[Case], count: int) -> list[Case]:
    """Return so many cases, evenly from the first to the last; all if there are fewer."""
    count = min(count, len(cases))
    return [cases[number * len(cases) // count] for number in range(count)]


def _hand_in(path: Path, place: Path) -> None:
    if path.is_dir():
        has_links = any(file.is_symlink() for file in path.rglob("*"))  # which a zip of Python's loses
        try:
            shutil.make_archive(str(place), "gztar" if has_links else "zip", path.parent, path.name)
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
    parser.add_argument("--jobs", default="auto", help="a number, or auto")
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--out", type=Path, help="where the class and the grades stay")
    options = parser.parse_args()
    folder = options.out or Path(tempfile.mkdtemp(prefix="ros2lab-class-"))
    made_class(folder / "class", options.size)
    done = graded(folder / "class", folder / "grades", "--jobs", options.jobs, kills=options.kills)
    print(
        f"{len(done.points)} students, {done.gradings} gradings in {done.seconds:.0f} s: "
        f"{done.rate}; {done.memory / 1e6:.0f} MB at most; "
        f"going on after a kill: {', '.join(f'{seconds:.1f} s' for seconds in done.going_on) or 'not tried'}; "
        f"without a grade: {', '.join(key for key, points in done.points.items() if points is None) or 'nobody'}. "
        f"See {folder / 'grades'}."
    )


if __name__ == "__main__":
    main()
