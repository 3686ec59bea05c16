"""What the lab starts of a student's leaves nothing behind: no daemon, and nothing after a kill."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from deadlines import DEADLINE
from ros2lab.family_keeper import ENDING
from ros2lab.process_family import keeping

# Leaves its session and its parent, holds no pipe, ignores what asks it to end, and tells its number.
DAEMON = """
import os, signal, sys, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        null = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(null, stream)
        with open(sys.argv[1] + ".part", "w") as file:
            file.write(str(os.getpid()))
        os.rename(sys.argv[1] + ".part", sys.argv[1])
        time.sleep(600)
    os._exit(0)
os.wait()
while not os.path.exists(sys.argv[1]):
    time.sleep(0.01)
print("ready", flush=True)
"""
GOES_ON = DAEMON + "time.sleep(600)\n"

# How each part of the lab starts a program and ends it; `command` and `folder` are given.
STARTERS = {
    "a node": """
from ros2lab.node_process import NodeProcess
process = NodeProcess("package", "node", command, os.environ)
while "ready" not in process.output:
    time.sleep(0.01)
end = process.stop
""",
    "what is watched on one's own machine": """
from ros2lab.grading.sandbox.open_world import OpenWorld
world = OpenWorld()
assert world.start(command).wait_for("ready", 60)
end = world.close
""",
    "a build": """
from ros2lab.process_family import family_started
started = family_started(command, folder, dict(os.environ))
assert started.__enter__().stdout.readline() == "ready\\n"
end = lambda: started.__exit__(None, None, None)
""",
    "a check's program": """
import signal, threading
from ros2lab.checks import programs
def interrupt():
    while not (folder / "number").exists():
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)
def end():
    threading.Thread(target=interrupt).start()
    try:
        programs.run(command, "it", folder=folder)
        time.sleep(600)
    except KeyboardInterrupt:
        pass
if is_to_stay:
    programs.run(command, "it", folder=folder)
""",
}
SCRIPT = """
import os, sys, time
from pathlib import Path
folder, is_to_stay = Path(sys.argv[1]), sys.argv[2] == "stays"
command = [sys.executable, sys.argv[3], str(folder / "number")]
{starter}
if is_to_stay:
    time.sleep(600)
try:
    end()
except Exception as error:
    print(error)
"""


def begin(starter: str, folder: Path, program: str, way: str) -> subprocess.Popen[str]:
    (folder / "daemon.py").write_text(program)
    script = SCRIPT.format(starter=STARTERS[starter])
    command = [sys.executable, "-c", script, str(folder), way, str(folder / "daemon.py")]
    return subprocess.Popen(command, text=True, stdout=subprocess.PIPE)


def expect_gone(number: Path) -> None:
    """The process whose number a file tells ends; it is ended here if it does not."""
    process = None
    try:
        process = psutil.Process(int(number.read_text()))
        psutil.wait_procs([process], timeout=DEADLINE)
        assert not process.is_running()
    except psutil.NoSuchProcess:
        return
    finally:
        if process is not None and process.is_running():
            process.kill()


@pytest.mark.parametrize(
    ("starter", "program"),
    [
        *(pytest.param(starter, DAEMON, id=f"{starter}-ended") for starter in STARTERS),
        # All of them are killed so below, too.
        *(
            pytest.param(starter, GOES_ON, id=f"{starter}-goes on", marks=pytest.mark.thorough)
            for starter in STARTERS
        ),
    ],
)
def test_a_daemon_ends_with_what_has_started_it(starter: str, program: str, tmp_path: Path) -> None:
    """Also one that has left its parent, its session and its terminal."""
    with begin(starter, tmp_path, program, "ends") as lab:
        said, _ = lab.communicate(timeout=DEADLINE)
    assert lab.returncode == 0, said
    expect_gone(tmp_path / "number")


@pytest.mark.parametrize("starter", STARTERS)
def test_nothing_outlives_a_lab_that_is_killed(starter: str, tmp_path: Path) -> None:
    number = tmp_path / "number"
    with begin(starter, tmp_path, GOES_ON, "stays") as lab:
        deadline = time.monotonic() + DEADLINE
        while not number.exists():
            assert time.monotonic() < deadline
            assert lab.poll() is None
            time.sleep(0.01)
        program = psutil.Process(lab.pid).children(recursive=True)
        lab.kill()
    _, alive = psutil.wait_procs(program, timeout=DEADLINE)
    for process in alive:
        process.kill()
    expect_gone(number)
    assert alive == []


def test_the_end_is_not_undone_by_being_asked_again(tmp_path: Path) -> None:
    """The kernel asks once for each thread of a parent that is killed, and the second time may come amid the first."""
    (tmp_path / "daemon.py").write_text(GOES_ON)
    number = tmp_path / "number"
    command = keeping([sys.executable, str(tmp_path / "daemon.py"), str(number)])
    with subprocess.Popen(command, text=True, stdout=subprocess.PIPE, start_new_session=True) as keeper:
        assert keeper.stdout is not None
        assert keeper.stdout.readline() == "ready\n"
        while keeper.poll() is None:
            keeper.send_signal(ENDING)
    assert keeper.returncode == -signal.SIGKILL
    expect_gone(number)


def test_what_is_held_ends_as_well(tmp_path: Path) -> None:
    """Programs that are stopped while they are asked something are not left so by a kill."""
    script = """
import sys, time
from ros2lab.grading.sandbox.open_world import OpenWorld
world = OpenWorld()
box = world.start(["sh", "-c", "echo ready; sleep 600; true"])
assert box.wait_for("ready", 60) and box.hold(60)
print("held", flush=True)
time.sleep(600)
"""
    with subprocess.Popen([sys.executable, "-c", script], text=True, stdout=subprocess.PIPE) as lab:
        try:
            assert lab.stdout is not None
            assert lab.stdout.readline() == "held\n"
            family = psutil.Process(lab.pid).children(recursive=True)
            # Each stops when it runs next, which is later than the signal on a busy machine.
            deadline = time.monotonic() + DEADLINE
            while psutil.STATUS_STOPPED not in [process.status() for process in family]:
                assert time.monotonic() < deadline
                time.sleep(0.01)
        finally:
            lab.kill()
    _, alive = psutil.wait_procs(family, timeout=DEADLINE)
    for process in alive:
        process.kill()
    assert alive == []
