"""What every test stands on: a ROS domain of its own, and nothing left behind."""

from __future__ import annotations

import contextlib
import gc
import itertools
import os
import signal
import socket
import sys
import threading
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path

import psutil
import pytest

from bare_student import installation, student
from deadlines import DEADLINE
from portable_ros2 import participants
from ros2lab import environment
from ros2lab.diagnose import net

__all__ = ["installation", "student"]  # what tests/student and tests/browser share

sys.path.append(
    str(Path(__file__).with_name("grading"))
)  # evidence that is made by hand is for other folders, too

# What a script starts in the background ignores Ctrl-C, or with nohup the end of its terminal, and so would
# everything that the tests start.
for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, handler)

# What is imported from here on finds the lab's settings; to look at all modules again before each test takes longer
# than most tests.
environment.apply()

_FIRST_DOMAINS = itertools.count(7 * os.getpid())  # so that one test does not begin where the last one ended


def pytest_addoption(parser: pytest.Parser) -> None:
    """Let `make test-all` ask for every case."""
    parser.addoption("--thorough", action="store_true", help="run the cases marked thorough, too")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage among modules and tests: they are hundreds of thousands of objects, and stay to the end."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is marked thorough, unless it was asked for or tests, or their files, were named one by one."""
    is_named = any("::" in argument or argument.endswith(".py") for argument in config.args)
    if not (config.getoption("--thorough") or is_named):
        thorough = [item for item in items if item.get_closest_marker("thorough")]
        items[:] = [item for item in items if not item.get_closest_marker("thorough")]
        config.hook.pytest_deselected(items=thorough)
    items[:] = long_first(items, int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")))


def long_first(items: Sequence[pytest.Item], workers: int) -> list[pytest.Item]:
    """Let half of the workers begin with the long tests: at the end, one core would wait for the other.

    To begin with, xdist gives each worker as many of the tests as any other, in their order. Those of a file that are
    marked as long together, since they share what takes long, stay together.
    """
    if workers == 1:
        return list(items)
    with_long = workers // 2
    marked = ((item, item.get_closest_marker("long")) for item in items)
    of_whom = ((item, item.path if mark.kwargs else item.nodeid) for item, mark in marked if mark)
    long = [[item for item, _ in group] for _, group in itertools.groupby(of_whom, key=lambda pair: pair[1])]
    others = deque(item for item in items if not item.get_closest_marker("long"))
    ordered: list[pytest.Item] = []
    for worker in range(workers):
        share = (len(items) - len(ordered)) // (workers - worker)
        own = [item for group in long[worker::with_long] for item in group] if worker < with_long else []
        ordered += [*own, *(others.popleft() for _ in range(min(share - len(own), len(others))))]
    return [*ordered, *others]


@contextlib.contextmanager
def leased_domain() -> Iterator[int]:
    """Lease a domain from 1 to 101 that no other test on this machine has, whoever runs it, and in which nobody is.

    A node whose test has ended may live on for as long as something, such as a traceback, holds it.
    """
    first = next(_FIRST_DOMAINS)
    for domain in (1 + (first + n) % 101 for n in range(101)):
        with socket.socket(socket.AF_UNIX) as lease:
            try:
                lease.bind(f"\0ros2lab-test-domain-{domain}")
            except OSError:
                continue
            if participants.listeners(domain):
                continue
            yield domain
            return
    raise RuntimeError("All of the domains from 1 to 101 are used by tests; end some of them.")


@pytest.fixture
def tmp_path(tmp_path: Path) -> Path:
    """Return a folder that has nothing beside it: a workspace is also judged by what lies next to it."""
    alone = tmp_path / "alone"
    alone.mkdir()
    return alone


@pytest.fixture(autouse=True)
def domain_id(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Give the test a domain of its own, and the lab's settings and no others."""
    for name in list(os.environ):
        if name.startswith(("ROS_", "ROS2LAB_", "RMW_", "RCUTILS_", "FASTRTPS_", "FASTDDS_")):
            monkeypatch.delenv(name)
    with leased_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        for name, value in environment.lab_settings().items():
            monkeypatch.setenv(name, value)
        # A rule that fails at a student's code costs its own findings alone; here it is a fault of ours, to be seen.
        monkeypatch.setenv(net.STRICT, "1")
        yield domain


@pytest.fixture(autouse=True)
def nothing_is_left_behind(domain_id: int) -> Iterator[None]:
    """Fail the test that leaves a thread or a process."""
    threads = set(threading.enumerate())
    processes = _descendants()
    yield
    # An event loop, such as Playwright's, keeps its helpers for as long as it lives.
    left_threads = [
        thread
        for thread in threading.enumerate()
        if thread not in threads and not thread.name.startswith("asyncio_")
    ]
    for thread in left_threads:
        thread.join(DEADLINE)
    left = [thread.name for thread in left_threads if thread.is_alive()]
    new = [child for child in _descendants() - processes if not _belongs_to(child, processes)]
    _, alive = psutil.wait_procs(new, timeout=DEADLINE)
    assert not left, f"threads left behind: {left}"
    assert not alive, f"processes left behind: {alive}"


def _descendants() -> set[psutil.Process]:
    """Return the processes below this one; most tests have none, which the kernel says at once."""
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return set()
    return set(psutil.Process().children(recursive=True))


def _belongs_to(child: psutil.Process, processes: set[psutil.Process]) -> bool:
    """Return whether a process is below one of these, as those of a browser are, or has gone meanwhile."""
    try:
        return bool(processes.intersection(child.parents()))
    except psutil.NoSuchProcess:
        return True
