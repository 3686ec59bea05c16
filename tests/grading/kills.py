"""Kill graders at random moments, and look what each leaves: `python tests/grading/kills.py 200`.

It goes on in process, mount and shared-memory namespaces of its own, so that whatever is there besides was left by a
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
from pathlib import Path

from ros2lab import course

GRADER = [sys.executable, "-c", "from ros2lab.cli import main; main()", "grade"]
PLACE = "/run"  # where a grader has its folder, which is empty at the beginning
DEADLINE = 60.0  # s, in which the last process must have ended


def kill_graders(times: int, seed: int, submission: Path) -> dict[str, list[object]]:
    """Start as many graders, kill each at a random moment, and return what was left, by its kind.

    Args:
        times: how many.
        seed: of the moments.
        submission: what is graded.
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
    whole = _seconds_of_one(submission)
    usual = _names("/dev/shm")  # files of tracing, of which a user has two for ever
    for number in range(times):
        moment = chance.uniform(0, 1.1 * whole)
        with subprocess.Popen(
            [*GRADER, submission], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as grader:
            try:
                grader.wait(moment)
            except subprocess.TimeoutExpired:
                grader.send_signal(signal.SIGKILL)
        deadline = time.monotonic() + DEADLINE
        while (others := _others()) and time.monotonic() < deadline:
            time.sleep(0.02)
        _begin_another()
        found = {
            "processes": others,
            "mounts": [] if Path("/proc/self/mounts").read_text() == mounts else ["there are others"],
            "shared memory": [name for name in _names("/dev/shm") if name not in usual],
            "folders": _names(PLACE),
        }
        for kind, names in found.items():
            left[kind] += [[number, round(moment, 3), name] for name in names]
        sys.stderr.write(f"{number + 1} of {times}: killed after {moment:.2f} s of {whole:.2f}; {found}\n")
    return left


def _seconds_of_one(submission: str) -> float:
    start = time.monotonic()
    subprocess.run([*GRADER, submission], stdout=subprocess.DEVNULL, check=True)
    return time.monotonic() - start


def _begin_another() -> None:
    """Start a grader that has nothing to grade, which sweeps what others have left."""
    with tempfile.TemporaryDirectory(dir="/dev/shm") as empty:
        subprocess.run([*GRADER, empty], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


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
    with tempfile.TemporaryDirectory() as folder:
        submission = course.copy_reference(Path(folder), has_tests=False)
        left = kill_graders(times, seed=int(time.time()), submission=submission)
    for kind, names in left.items():
        print(f"{kind}: {len(names)} left after {times} kills", *names, sep="\n  ")
    raise SystemExit(any(left.values()))


if __name__ == "__main__":
    main()
