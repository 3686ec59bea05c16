"""Grade on a cluster of dask.distributed: submissions travel as bytes, and what was seen of them comes back as data.

A worker is asked first whether it may grade: it needs this very grader, and a sandbox. A submission whose worker is lost
is given to another one; as on one machine, only what has come back is written down.
"""

from __future__ import annotations

import asyncio
import io
import tarfile
import time
from collections import deque
from collections.abc import Callable, Collection, Generator, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ros2lab.classroom import identity, one, side_by_side
from ros2lab.classroom.gradebook import Seen
from ros2lab.classroom.handed_in import ClassError
from ros2lab.classroom.one import CannotGrade, GradingFailed, graded_apart
from ros2lab.classroom.side_by_side import Done, Step, Task
from ros2lab.grading.receiving.clean_copy import MOST_BYTES
from ros2lab.grading.sandbox.compiled import compile_modules
from ros2lab.scratch import scratch_folder

CONNECT_WITHIN = 20.0  # s
LOOK_AGAIN = 2.0  # s; how soon a worker is noticed that has come, or is gone, while nothing comes back
WITHOUT_WORKERS = 60.0  # s, after which the class is given up until the command is given again
AHEAD = 2  # submissions on the way for each that a worker can grade at once


def grade(
    tasks: Sequence[Task], address: str, assignment: Path | None, tell: Callable[[str], None]
) -> Generator[Step | Done, None, None]:
    """Grade tasks on a cluster, and yield what happens.

    Args:
        tasks: in the order in which they are begun.
        address: of dask's scheduler, such as `tcp://10.0.0.5:8786`.
        assignment: the folder of what was asked for; None for the course's own.
        tell: given a sentence for each worker that is refused.

    Raises:
        ClassError: if dask.distributed is not installed, or no scheduler answers.
        CannotGrade: if no worker can grade.
    """
    try:
        from distributed import Client  # noqa: PLC0415 -- an extra, which only this needs
    except ImportError:
        raise ClassError(
            "--scheduler needs dask.distributed; install it with `pip install 'ros2lab[cluster]'`."
        ) from None
    try:
        client = Client(address, timeout=CONNECT_WITHIN)
    except (OSError, ValueError) as error:
        raise ClassError(
            f"No scheduler of dask answers at {address} ({error}); start one with `dask scheduler`."
        ) from None
    with client:
        yield from _Cluster(client, packed([assignment]) if assignment else b"", tell).grade(
            tasks, assignment
        )


class _Cluster:
    """The workers of a cluster that may grade, and what is on the way to them."""

    def __init__(self, client: Any, assignment: bytes, tell: Callable[[str], None]) -> None:
        self._client, self._assignment, self._tell = client, assignment, tell
        self._asked, self._admitted = set[str](), set[str]()
        self._sent: dict[Any, tuple[Task, frozenset[str]]] = {}

    def grade(self, tasks: Sequence[Task], assignment: Path | None) -> Generator[Step | Done, None, None]:
        waiting, had_workers_at = deque(tasks), time.monotonic()
        try:
            while waiting or self._sent:
                threads = self._workers()
                if threads:
                    had_workers_at = time.monotonic()
                    waiting.extendleft(self._stranded(threads.keys()))
                elif time.monotonic() - had_workers_at > WITHOUT_WORKERS:
                    raise CannotGrade(
                        f"The cluster has had no worker for {WITHOUT_WORKERS:g} s; start workers with `dask worker`, "
                        "and give the same command again."
                    )
                while waiting and len(self._sent) < AHEAD * sum(threads.values()):
                    task = waiting.popleft()
                    if held(task.paths) > MOST_BYTES:  # it is refused before anything of it runs
                        yield from side_by_side.grade([task], 1, assignment)
                        continue
                    self._send(task, frozenset(threads))
                    yield Step(task, "on the cluster")
                yield from self._ended()
        finally:
            self._client.cancel([*self._sent])

    def _workers(self) -> Mapping[str, int]:
        """Return how many each worker that may grade grades at once; those that have come are asked first.

        Raises:
            CannotGrade: if there are workers, and all are refused.
        """
        here = self._client.scheduler_info(n_workers=-1)["workers"]
        new = [worker for worker in here if worker not in self._asked]
        if new:
            answers = self._client.run(refusal, identity.grader(), workers=new, on_error="return")
            for worker, answer in answers.items():
                self._asked.add(worker)
                if isinstance(answer, OSError):  # it is gone
                    continue
                if isinstance(answer, BaseException):
                    answer = f"ros2lab cannot be used there ({answer})."  # noqa: PLW2901
                if answer:
                    self._tell(f"The worker {worker} is refused: {answer}")
                else:
                    self._admitted.add(worker)
        if here and not self._admitted and self._asked.issuperset(here):
            raise CannotGrade("No worker of the cluster can grade.")
        return {name: about["nthreads"] for name, about in here.items() if name in self._admitted}

    def _send(self, task: Task, workers: frozenset[str]) -> None:
        future = self._client.submit(
            seen_there,
            packed(task.paths),
            self._assignment,
            workers=[*workers],
            allow_other_workers=False,
            pure=False,
        )
        self._sent[future] = task, workers

    def _stranded(self, workers: Collection[str]) -> Iterator[Task]:
        """Take back what was sent to workers of whom none is here any more, while others are.

        Where nobody is, they may only not have been told of for a moment, and work on.
        """
        for future, (task, asked) in [*self._sent.items()]:
            if asked.isdisjoint(workers):
                del self._sent[future]
                self._client.cancel([future])
                yield task

    def _ended(self) -> Iterator[Done]:
        """Yield what has come back; after a while without anything, return."""
        from distributed import wait  # noqa: PLC0415

        if not self._sent:
            time.sleep(LOOK_AGAIN)  # for a first worker
            return
        try:
            ended = wait([*self._sent], timeout=LOOK_AGAIN, return_when="FIRST_COMPLETED").done
        except asyncio.TimeoutError:
            return
        for future in ended:
            task, _ = self._sent.pop(future)
            error = future.exception()
            if error is not None:
                yield Done(task, f"The grader was lost with its worker: {error}".rstrip(".") + ".")
                continue
            answer = future.result()
            yield Done(task, answer if isinstance(answer, str) else Seen(**answer))


# --- what runs on a worker --------------------------------------------------------------------------------


def refusal(grader: str) -> str:
    """Return why this worker may not grade, in a sentence; empty if it may.

    Args:
        grader: the digest of the grader that the class is graded by.
    """
    if identity.grader() != grader:
        return "it has another release of ros2lab, or another Python; install the same there."
    compile_modules()
    return one.refusal()


def seen_there(submission: bytes, assignment: bytes) -> dict[str, Any] | str:
    """Return what is seen of a submission, as data; or a sentence that says why the grader has failed."""
    with scratch_folder() as scratch:
        own = unpacked(assignment, Path(scratch, "assignment"))[0] if assignment else None
        paths = unpacked(submission, Path(scratch, "handed_in"))
        try:
            return asdict(graded_apart(paths, own, lambda _step: None, is_alone=False))
        except (GradingFailed, CannotGrade) as error:
            return str(error)


def packed(paths: Sequence[Path]) -> bytes:
    """Return files and folders as bytes, with what they are called."""
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz", compresslevel=1) as archive:
        for number, path in enumerate(paths):
            archive.add(path, f"{number}/{path.name}", filter=_without_devices)
    return data.getvalue()


def _without_devices(member: tarfile.TarInfo) -> tarfile.TarInfo | None:
    return None if member.ischr() or member.isblk() else member


def unpacked(data: bytes, folder: Path) -> list[Path]:
    """Write what was packed into a new folder, and return the files and folders in their order."""
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        # It comes from `packed`, so that nothing in it lies behind a link; links stay as they are, and are not followed.
        archive.extraction_filter = lambda member, _folder: member
        archive.extractall(folder)  # noqa: S202
    return [next(parent.iterdir()) for parent in sorted(folder.iterdir(), key=lambda path: int(path.name))]


def held(paths: Sequence[Path]) -> int:
    """Return how many bytes files and folders hold."""
    files = (file for path in paths for file in (path.rglob("*") if path.is_dir() else (path,)))
    return sum(file.lstat().st_size for file in files)
