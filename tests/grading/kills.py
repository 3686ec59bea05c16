"""Kill graders at random moments, and look what each leaves: `python tests/grading/kills.py 200 [SEED]`.

Each is `ros2lab grade` or `ros2lab class grade`, and gets SIGKILL, SIGTERM, SIGHUP or SIGINT, it alone or, as from a
terminal, with all that it has started in its group; which, and when, is drawn from the seed, which is printed. It goes on in process, mount and shared-memory namespaces of its own, so that whatever is there besides was left by a
grader. Processes must end by themselves; folders must be gone when the next grader has started.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from ros2lab import course

ROS2LAB = [sys.executable, "-c", "from ros2lab.cli import main; main()"]
VERBS = ("grade", "class grade")
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
PLACE = "/run"  # where a grader has its folder, which is empty at the beginning
DEADLINE = 60.0  # s, in which the last process must have ended


def kill_graders(times: int, seed: int, submission: Path) -> dict[str, list[object]]:
    """Start as many graders, kill each at a random moment, and return what was left, by its kind.

    Args:
        times: how many.
        seed: of the moments.
        submission: what is graded; a class is all that lies in the folder around it.
    """
    # bubblewrap hides parts of /proc, and then no other one is made inside.
    alone = ["unshare", "--mount", "--pid", "--ipc", "--fork", "--kill-child", "--mount-proc"]
    alone += [] if os.getuid() == 0 else ["--map-root-user"]
    disks = f'mount -t tmpfs none /dev/shm && mount -t tmpfs none {PLACE} && exec env TMPDIR={PLACE} "$@"'
    own = [sys.executable, __file__, str(times), str(seed), str(submission)]
    command = [*alone, "sh", "-c", disks, "sh", *own]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True, text=True)
    return dict(json.loads(done.stdout))


def _inside(times: int, seed: int, submission: str) -> dict[str, list[object]]:
    chance = random.Random(seed)
    left: dict[str, list[object]] = {"processes": [], "mounts": [], "shared memory": [], "folders": []}
    mounts = Path("/proc/self/mounts").read_text()
    whole = {verb: _seconds_of_one(verb, submission) for verb in VERBS}
    usual = _names("/dev/shm")  # files of tracing, of which a user has two for ever
    for number in range(times):
        verb, sent, whom = chance.choice(VERBS), chance.choice(SIGNALS), chance.choice((os.kill, os.killpg))
        moment = chance.uniform(0, 1.1 * whole[verb])
        with _grader(verb, submission) as grader:
            try:
                grader.wait(moment)
            except subprocess.TimeoutExpired:
                whom(grader.pid, sent)
            deadline = time.monotonic() + DEADLINE
            while (others := _others()) and time.monotonic() < deadline:
                time.sleep(0.02)
            grader.kill()
        _begin_another()
        found = {
            "processes": others,
            "mounts": [] if Path("/proc/self/mounts").read_text() == mounts else ["there are others"],
            "shared memory": [name for name in _names("/dev/shm") if name not in usual],
            "folders": _names(PLACE),
        }
        how = f"{verb}: {sent.name} by {whom.__name__} after {moment:.2f} s of {whole[verb]:.2f}"
        for kind, names in found.items():
            left[kind] += [[number, how, name] for name in names]
        sys.stderr.write(f"{number + 1} of {times}: {how}; {found}\n")
    return left


@contextlib.contextmanager
def _grader(
    verb: str, submission: str, said: int | None = subprocess.DEVNULL
) -> Iterator[subprocess.Popen[bytes]]:
    """Start a grader in a process group of its own, which has nothing from another one to go on with."""
    with tempfile.TemporaryDirectory(dir=Path(submission).parents[1]) as grades:
        handed_in = [submission] if verb == "grade" else [str(Path(submission).parent), "--out", grades]
        with subprocess.Popen(
            [*ROS2LAB, *verb.split(), *handed_in],
            stdout=subprocess.DEVNULL,
            stderr=said,
            start_new_session=True,
        ) as grader:
            yield grader


def _seconds_of_one(verb: str, submission: str) -> float:
    start = time.monotonic()
    with _grader(verb, submission, None) as grader:
        if grader.wait():
            raise RuntimeError(
                f"`ros2lab {verb}` does not grade here, so that killing it would show nothing."
            )
    return time.monotonic() - start


def _begin_another() -> None:
    """Start a grader that has nothing to grade, which sweeps what others have left."""
    with tempfile.TemporaryDirectory(dir="/dev/shm") as empty:
        subprocess.run(
            [*ROS2LAB, "grade", empty], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False
        )


def _others() -> list[str]:
    """Return the commands of all processes but this one, which is the first one here, to which all orphans fall."""
    found = []
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    for name in filter(str.isdigit, _names("/proc")):
        if int(name) != os.getpid():
            try:
                found.append(Path("/proc", name, "cmdline").read_text().replace("\0", " ")[:200] or name)
            except OSError:
                continue  # it has ended
    return found


def _names(folder: str) -> list[str]:
    return [path.name for path in Path(folder).iterdir()]


def main() -> None:
    """Kill as many graders as `argv` says; the exit code is 1 if anything was left."""
    if len(sys.argv) == 4:
        print(json.dumps(_inside(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])))
        return
    times = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time())
    print(f"seed {seed}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in ("anna", "ben"):
            submission = course.copy_reference(Path(folder, "class", name), has_tests=False)
        left = kill_graders(times, seed, submission.parent)
    for kind, names in left.items():
        print(f"{kind}: {len(names)} left after {times} kills", *names, sep="\n  ")
    raise SystemExit(any(left.values()))


if __name__ == "__main__":
    main()
