"""What every test stands on: a ROS domain of its own, and nothing left behind."""

from __future__ import annotations

import itertools
import os
import signal
import threading
from collections.abc import Iterator

import psutil
import pytest

from ros2lab import environment

# What a script starts in the background ignores Ctrl-C, or with nohup the end of its terminal, and so would
# everything that the tests start.
for number, handler in ((signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, handler)

# Domains 1 to 100 are dealt out so that no two workers of pytest-xdist share one.
_WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
_DOMAINS = itertools.cycle(range(1 + 25 * (_WORKER % 4), 26 + 25 * (_WORKER % 4)))


@pytest.fixture(autouse=True)
def domain_id(monkeypatch: pytest.MonkeyPatch) -> int:
    """Give the test a domain of its own, and the lab's settings and no others."""
    for name in list(os.environ):
        if name.startswith(("ROS_", "ROS2LAB_", "RMW_", "RCUTILS_", "FASTRTPS_", "FASTDDS_")):
            monkeypatch.delenv(name)
    domain = next(_DOMAINS)
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    for name, value in environment.lab_settings().items():
        monkeypatch.setenv(name, value)
    return domain


@pytest.fixture(autouse=True)
def nothing_is_left_behind(domain_id: int) -> Iterator[None]:
    """Fail the test that leaves a thread or a process."""
    threads = set(threading.enumerate())
    processes = set(psutil.Process().children(recursive=True))
    yield
    left_threads = [thread for thread in threading.enumerate() if thread not in threads]
    for thread in left_threads:
        thread.join(1.0)  # one that is ending may end
    # An event loop, such as Playwright's, keeps its helpers for as long as it lives.
    left = [t.name for t in left_threads if t.is_alive() and not t.name.startswith("asyncio_")]
    now = psutil.Process().children(recursive=True)
    # A browser that was there before may start and keep processes of its own.
    new = [child for child in now if child not in processes and not processes.intersection(child.parents())]
    _, alive = psutil.wait_procs(new, timeout=1.0)
    assert not left, f"threads left behind: {left}"
    assert not alive, f"processes left behind: {alive}"
