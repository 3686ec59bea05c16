"""A class on a cluster of dask: a scheduler and workers as processes on this machine, one of them lost in the middle."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sqlite3
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest

from ros2lab import environment
from ros2lab.classroom import cluster, one
from ros2lab.classroom.gradebook import Worth
from ros2lab.classroom.judging import Judging

COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()", "class", "grade", "submissions"]
DASK = "from distributed.cli.{0} import main; main()"

# Instead of the grader: it tells who grades what, and what is called `held` is held for as long as its first worker lives.
GRADER = """
import json, os, sys, zipfile
path = json.loads(sys.stdin.readline())["paths"][0]
name = open(path).read()
with open(os.environ["CALLS"], "a") as calls:
    calls.write(f"{name} {os.getppid()}\\\\n")
if name == "held" and open(os.environ["CALLS"]).read().count("held") == 1:
    with open(os.environ["HELD"], "w") as held:
        held.write(str(os.getppid()))
    sys.stdin.read()
    sys.exit()
evidence = open(os.environ["EVIDENCE"]).read()
print(json.dumps({"seen": {"evidence": evidence, "sources": {}, "problem": "", "seconds": 1}}), flush=True)
"""
FAKE = (
    f"import sys; from ros2lab.classroom import one; one.COMMAND = [sys.executable, '-c', '''{GRADER}''']; "
)
OTHERS = 8
ANOTHER_RELEASE = "import ros2lab; ros2lab.__version__ = '0.0'; "


NODE = """import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("status_publisher")
    publisher = node.create_publisher(String, "/robot/status", 10)
    node.create_timer(2.0, lambda: publisher.publish(String(data="well")))
    rclpy.spin(node)


main()
"""


class Cluster:
    """A scheduler and its workers, each a process."""

    def __init__(self, folder: Path, ending: contextlib.ExitStack) -> None:
        self._folder, self._ending = folder, ending
        self._environ = {
            **environment.lab_environment(),
            "CALLS": str(folder / "calls"),
            "HELD": str(folder / "held"),
            "EVIDENCE": str(folder / "evidence.json"),
            "DASK_DISTRIBUTED__SCHEDULER__WORK_STEALING": "False",
        }
        words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self.address = _said(self._start("", "dask_scheduler", words, {}), "Scheduler at:")

    def workers(self, *before: str, **environ: str) -> list[int]:
        """Start workers, each of which runs something before, and return the numbers of their processes."""
        words = ("--host", "127.0.0.1", "--no-nanny", "--no-dashboard", "--nthreads", "1", self.address)
        started = [self._start(code, "dask_worker", words, environ) for code in before]
        for process in started:
            _said(process, "Registered to:")
        return [process.pid for process in started]

    def _start(
        self, before: str, name: str, words: Sequence[str], environ: Mapping[str, str]
    ) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", before + DASK.format(name), *words],
            cwd=self._folder,
            env={**self._environ, **environ},
            stderr=subprocess.PIPE,
            text=True,
        )
        self._ending.enter_context(process)  # which closes its pipe, and waits
        self._ending.callback(process.kill)
        return process


def _said(process: subprocess.Popen[str], words: str) -> str:
    """Wait until a process says something, and return what stands behind it; what comes later fits into the pipe."""
    assert process.stderr is not None
    for line in process.stderr:
        if words in line:
            return line.partition(words)[2].strip()
    raise AssertionError(f"It has ended with {process.wait()}.")


@pytest.fixture
def started(tmp_path: Path) -> Iterator[Cluster]:
    with contextlib.ExitStack() as ending:
        yield Cluster(tmp_path, ending)


def grade(folder: Path, address: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, "--scheduler", address, "--json"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def handed_in(folder: Path, *names: str) -> None:
    (folder / "submissions").mkdir()
    for name in names:
        (folder / "submissions" / f"{name}.py").write_text(name)


def test_what_a_lost_worker_had_is_graded_by_another_and_nothing_is_twice_in_the_gradebook(
    started: Cluster, tmp_path: Path
) -> None:
    """Three workers; the one that holds a submission is killed once it has said so."""
    from ros2lab import assignments
    from ros2lab.grading.collect import nothing
    from ros2lab.grading.evidence_json import evidence_json

    (tmp_path / "evidence.json").write_text(evidence_json(nothing(Path("x"), "", assignments.load(None))))
    os.mkfifo(tmp_path / "held")
    handed_in(tmp_path, "held", *(f"s{number}" for number in range(OTHERS)))
    workers = started.workers(FAKE, FAKE, FAKE)
    with grade(tmp_path, started.address) as process:
        lost = int((tmp_path / "held").read_text())  # waits until somebody writes
        assert lost in workers
        os.kill(lost, signal.SIGKILL)
        said, wrong = process.communicate()
    assert process.returncode == 0, wrong
    done = [event["name"] for event in map(json.loads, said.splitlines()) if event["event"] == "done"]
    assert len(done) == len({*done}) == OTHERS + 1
    calls = [line.split() for line in (tmp_path / "calls").read_text().splitlines()]
    first, second = (int(worker) for name, worker in calls if name == "held")
    assert first == lost != second
    with contextlib.closing(sqlite3.connect(tmp_path / "grades/gradebook.sqlite")) as book:
        assert (
            book.execute("SELECT count(*), count(DISTINCT digest) FROM grading").fetchone()
            == (OTHERS + 1,) * 2
        )
        assert book.execute("SELECT DISTINCT state FROM submission").fetchall() == [("graded",)]


@pytest.mark.thorough
def test_a_worker_that_cannot_grade_as_the_others_is_refused_in_a_sentence(
    started: Cluster, tmp_path: Path
) -> None:
    """One has another release, one no bubblewrap; with no other one the class is not graded."""
    handed_in(tmp_path, "a")
    started.workers(ANOTHER_RELEASE)
    started.workers("", PATH=str(Path(sys.executable).parent))
    with grade(tmp_path, started.address) as process:
        said, wrong = process.communicate()
    assert process.returncode == 4
    assert wrong == "No worker of the cluster can grade.\n"
    refused = sorted(json.loads(line)["text"].partition(" is refused: ")[2] for line in said.splitlines())
    assert "another release of ros2lab" in refused[1]
    assert "bubblewrap" in refused[0]
    assert len(refused) == 2


@pytest.mark.thorough
def test_a_submission_is_worth_the_same_on_a_worker(started: Cluster, tmp_path: Path) -> None:
    """It travels as bytes, is built and run in the worker's sandbox, and gets what this machine gives it."""
    submission = tmp_path / "submissions/a"
    submission.mkdir(parents=True)
    (submission / "status_publisher.py").write_text(NODE)
    started.workers("")
    with grade(tmp_path, started.address) as process:
        *_, event = map(json.loads, process.communicate()[0].splitlines())
    assert process.returncode == 0
    here = one.graded_apart([submission], None, lambda _step: None)
    worth = Judging.of(None, None, {}).worth(here.evidence, "a", "a")
    assert isinstance(worth, Worth)
    assert 0 < event["total"] == worth.total


def test_what_is_sent_arrives_as_it_was(tmp_path: Path) -> None:
    """Modes, links that lead nowhere, and empty folders stay; a device does not."""
    folder = tmp_path / "wörk space"
    (folder / "empty").mkdir(parents=True)
    (folder / "run.sh").write_text("true")
    (folder / "run.sh").chmod(0o755)
    (folder / "link").symlink_to("/nowhere")
    (tmp_path / "two.py").write_text("2")
    paths = cluster.unpacked(cluster.packed([folder, tmp_path / "two.py"]), tmp_path / "there")
    assert [path.name for path in paths] == ["wörk space", "two.py"]
    assert sorted(path.name for path in paths[0].iterdir()) == ["empty", "link", "run.sh"]
    assert (paths[0] / "link").readlink() == Path("/nowhere")
    assert os.access(paths[0] / "run.sh", os.X_OK)
    assert cluster.held(paths) == cluster.held([folder, tmp_path / "two.py"])


def test_without_a_scheduler_nothing_of_dask_is_imported() -> None:
    code = "import sys; from ros2lab.classroom import grading; sys.exit('dask' in sys.modules or 'distributed' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
