"""What a student has, while what writes it is killed at any of its steps, or the disk is full."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

# What is done to a folder, and what a look at it tells afterwards. Of a file that is replaced the text before or the
# text after stands under its name, or the text before in ~/earlier; never a part of one.
DEEDS = '''
import json, os, shutil, sys, zipfile
from pathlib import Path
from ros2lab import course, edition, files, hand_in, progress
from ros2lab.terminal import editor
from ros2lab.workspace import Workspace

BEFORE, AFTER = "before\\n" * 5_000, "after\\n" * 5_000
home = course.work_folder()
node, cell, given = home / "ws/node.py", home / "ws/cell.py", home / "given_ws/src/given.py"
release = course.notebooks()[0]
course.notebooks = lambda: [release]
edition._as_bytes = lambda source: AFTER.encode()

def begin():
    """Lay out what the student has, and nothing else."""
    shutil.rmtree(home, ignore_errors=True)
    for path in (node, cell, home / "notebooks" / release.name, home / "old_ws/src/mine.py", given):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(BEFORE)
        path.chmod(0o755)
    progress.keep("a.first")
    record = {release.name: {"release": "an older one", "delivered": edition._hash(BEFORE.encode())}}
    (home / "notebooks" / edition.RECORD).write_text(json.dumps(record))

def is_kept(path):
    """Whether there is all of the text before or after, and where it is the text after, all of the one before too."""
    kept = {path.read_text(), *(earlier.read_text() for earlier in home.glob(f"earlier/{path.name}*"))}
    return kept <= {BEFORE, AFTER} and BEFORE in kept and path.stat().st_mode & 0o777 == 0o755

def is_whole(archive):
    with zipfile.ZipFile(archive) as opened:
        return [opened.read(name).decode() for name in opened.namelist()] == [BEFORE]

DEEDS = {
    "files.write": (lambda: files.write("~/ws/node.py", AFTER), lambda: is_kept(node)),
    "%%editor": (lambda: editor.save_cell("~/ws/cell.py", AFTER), lambda: is_kept(cell)),
    "start_over": (
        lambda: course.start_over("~/old_ws"),
        lambda: [p.read_text() for p in home.rglob("mine.py")] == [BEFORE],
    ),
    "a notebook's update": (
        lambda: edition.deliver(home / "notebooks"),
        lambda: (home / "notebooks" / release.name).read_text() in (BEFORE, AFTER),
    ),
    "hand_in.pack": (
        lambda: hand_in.pack(Workspace(home / "given_ws"), "Anna"),
        lambda: given.read_text() == BEFORE and all(map(is_whole, home.glob("hand_in/*.zip"))),
    ),
    "progress": (lambda: progress.keep("a.second"), lambda: "a.first" in progress.read()),
}
'''

KILLED = (
    DEEDS
    + """
import itertools, signal
STEPS = {"open", "os.rename", "os.remove", "os.mkdir", "os.chmod", "shutil.copyfile", "os.utime", "os.truncate"}
steps = [0, 10**9]

def count(event, arguments):
    if event in STEPS and str(home) in str(arguments):
        steps[0] += 1
        if steps[0] == steps[1]:
            os.kill(os.getpid(), signal.SIGKILL)

sys.addaudithook(count)
told = {}
for name, (do, holds) in DEEDS.items():
    for step in itertools.count(1):
        begin()
        child = os.fork()
        if not child:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            steps[:] = [0, step]
            do()
            os._exit(0)
        _, status = os.waitpid(child, 0)
        if not holds():
            told[name] = f"lost at step {step}"
            break
        do()  # and it can be done again
        if not holds() or [*home.rglob(".*.part")]:
            told[name] = f"not well again after step {step}"
            break
        if status == 0:
            told.setdefault(name, step - 1)
            break
print(json.dumps(told))
"""
)

FULL = (
    DEEDS
    + """
begin()
with (home / "filler").open("wb", buffering=0) as filler:
    try:
        while True:
            filler.write(bytes(4096))
    except OSError:
        pass
told = {}
for name, (do, holds) in DEEDS.items():
    try:
        do()
        said = "done"
    except OSError as error:
        said = error.strerror
    told[name] = [said, bool(holds()), len([*home.rglob(".*.part")])]
sys.stderr.write(json.dumps(told))
"""
)


WRITER = """
import sys
from pathlib import Path
from ros2lab import course
for _ in range(200):
    course.write_whole(Path(sys.argv[1]), sys.argv[2].encode() * 100_000)
"""


def test_of_two_that_write_one_file_each_text_is_whole(tmp_path: Path) -> None:
    """As two graders that were given the same report."""
    report = tmp_path / "report.html"
    report.write_text("a" * 100_000)
    seen = set()
    with (
        subprocess.Popen([sys.executable, "-c", WRITER, str(report), "a"]) as one,
        subprocess.Popen([sys.executable, "-c", WRITER, str(report), "b"]) as other,
    ):
        while one.poll() is None or other.poll() is None:
            seen.add(report.read_text())
    assert (one.returncode, other.returncode) == (0, 0)
    assert seen == {"a" * 100_000, "b" * 100_000}
    assert [*tmp_path.iterdir()] == [report]


def test_whatever_step_it_is_killed_at(tmp_path: Path) -> None:
    """SIGKILL comes before each of the steps at which the file system changes; then the same is done again."""
    done = subprocess.run(
        [sys.executable, "-c", KILLED],
        env={"ROS2LAB_WORK": str(tmp_path / "work")},
        capture_output=True,
        text=True,
        check=False,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    assert all(isinstance(steps, int) for steps in told.values()), told
    assert {name for name, steps in told.items() if steps < 1} == set(), told


def test_on_a_full_disk(tmp_path: Path) -> None:
    """Nothing is lost, and nothing half-made is left."""
    small = tmp_path / "work"
    small.mkdir()
    command = ["bwrap", "--dev-bind", "/", "/", "--size", "400000", "--tmpfs", str(small)]
    done = subprocess.run(
        [*command, "--setenv", "ROS2LAB_WORK", str(small), sys.executable, "-c", FULL],
        capture_output=True,
        text=True,
        check=False,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stderr.splitlines()[-1])
    assert told.pop("start_over")[1:] == [True, 0]  # only a name changes
    assert told.pop("progress")[1:] == [True, 0]  # it does not spoil the check
    assert {(said, holds, parts) for said, holds, parts in told.values()} == {
        ("No space left on device", True, 0)
    }, told
