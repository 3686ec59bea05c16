"""What Linux tells in /proc of the memory, time and files that processes hold."""

# pathlib takes as long to import as all of the others.
# ruff: noqa: PTH123, PTH208

import contextlib
import os
import signal
from collections.abc import Iterator

BYTES_PER_FILE = 4096  # what an empty file is counted as
PAGE = os.sysconf("SC_PAGE_SIZE")
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")
with open("/proc/sys/vm/max_map_count", encoding="ascii") as most_maps:
    MOST_MAPS = int(most_maps.read())


def numbers(folder: str) -> list[str]:
    """Return the numbers of processes or threads that have a folder in one; none where that has gone."""
    try:
        return [name for name in os.listdir(folder) if name.isdigit()]
    except OSError:
        return []


def is_running(process: str) -> bool:
    """Return whether a thread of a process has neither ended nor stopped.

    What waits in Linux itself, as who has begun a program by vfork() does until that runs, stops before anything else if
    it has been sent the signal; if what it waits for stands, it may wait for ever.
    """
    for thread in numbers(f"{process}/task"):
        with contextlib.suppress(OSError), open(f"{process}/task/{thread}/stat", "rb") as file:
            state = file.read().rpartition(b")")[2].split()[0]
            if state not in (b"T", b"Z", b"X") and not (state == b"D" and _is_to_stop(f"{process}/status")):
                return True
    return False


def _is_to_stop(status: str) -> bool:
    with open(status, "rb") as file:
        waiting = int(file.read().partition(b"ShdPnd:")[2].split(None, 1)[0], 16)
    return bool(waiting >> (signal.SIGSTOP - 1) & 1)


def cpu_s(process: str) -> Iterator[tuple[tuple[bytes, bytes], tuple[float, float]]]:
    """Yield the number and the start of a process, its CPU seconds, and those of its children that it has waited for."""
    with contextlib.suppress(OSError):
        number, _, rest = _read(f"{process}/stat").partition(b" ")
        fields = rest.rpartition(b")")[2].split()  # proc_pid_stat(5), from the third on
        user, system, users, systems = map(int, fields[11:15])
        yield (number, fields[19]), ((user + system) / CLOCK_TICKS, (users + systems) / CLOCK_TICKS)


def memory(process: str) -> tuple[int, int, int]:
    """Return the bytes of memory of a process, and how many open files and maps it has at most; 0 if it has gone."""
    with contextlib.suppress(OSError):
        status = _read(f"{process}/status")
        size, resident, tables = (_number(status, name) * 1024 for name in (b"VmSize", b"VmRSS", b"VmPTE"))
        return resident + tables, _number(status, b"FDSize"), min(size // PAGE, MOST_MAPS)
    return 0, 0, 0


def _read(path: str) -> bytes:
    """Return what stands in a small file of /proc; a file object of Python's takes as long again."""
    file = os.open(path, os.O_RDONLY)
    try:
        return os.read(file, 65536)
    finally:
        os.close(file)


def _number(status: bytes, name: bytes) -> int:
    """Return the number in a line of proc_pid_status(5); 0 if there is no such line, as of a process that has ended."""
    _, is_there, rest = status.partition(b"\n%b:" % name)
    return int(rest.split(None, 1)[0]) if is_there else 0


def maps(process: str) -> int:
    """Return how many maps of memory a process has; 0 if it has gone."""
    with contextlib.suppress(OSError), open(f"{process}/maps", "rb") as file:
        return file.read().count(b"\n")
    return 0


def descriptors(process: str) -> int:
    """Return how many open files a process has; 0 if it has gone."""
    with contextlib.suppress(OSError):
        return len(os.listdir(f"{process}/fd"))
    return 0


def sockets() -> int:
    """Return how many sockets there are in the World, also those that wait to be accepted or are on their way."""
    with open("/proc/net/sockstat", "rb") as file:
        return int(file.readline().split()[-1])


def available() -> int:
    """Return the bytes of memory that this machine can still give to programs."""
    with open("/proc/meminfo", "rb") as file:
        return int(file.read().partition(b"MemAvailable:")[2].split(None, 1)[0]) * 1024


def has_too_many_files(folder: str) -> bool:
    """Return whether the files of a disk would fill it if each were as large as an empty one is counted."""
    disk = os.statvfs(folder)
    return (disk.f_files - disk.f_ffree) * BYTES_PER_FILE > disk.f_blocks * disk.f_frsize
