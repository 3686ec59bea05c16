"""What /proc says about the memory, time and files of processes."""

# pathlib takes as long to import as all of the others.
# ruff: noqa: PTH123, PTH208

import contextlib
import os
import signal
from collections.abc import Iterator

BYTES_PER_FILE = 4096  # what an empty file counts
PAGE = os.sysconf("SC_PAGE_SIZE")
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")
with open("/proc/sys/vm/max_map_count", encoding="ascii") as most_maps:
    MOST_MAPS = int(most_maps.read())


def numbers(folder: str) -> list[str]:
    """Return the numbers of the processes or threads in a folder; empty if it is gone."""
    try:
        return [name for name in os.listdir(folder) if name.isdigit()]
    except OSError:
        return []


def is_running(process: str) -> bool:
    """Return whether a thread of a process has neither ended nor stopped.

    One that waits inside the kernel, as after vfork() until the child runs, counts as stopped if it has been
    sent the signal: it stops before anything else, and may wait for ever if what it waits for has stopped.
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
    """Yield a process's number and start, its CPU seconds, and those of children that it has waited for."""
    with contextlib.suppress(OSError):
        number, _, rest = _read(f"{process}/stat").partition(b" ")
        fields = rest.rpartition(b")")[2].split()  # proc_pid_stat(5), from the third on
        user, system, users, systems = map(int, fields[11:15])
        yield (number, fields[19]), ((user + system) / CLOCK_TICKS, (users + systems) / CLOCK_TICKS)


def memory(process: str) -> tuple[int, int, int]:
    """Return a process's memory in bytes, and the most open files and maps it may have; 0 if it is gone."""
    with contextlib.suppress(OSError):
        status = _read(f"{process}/status")
        size, resident, tables = (_number(status, name) * 1024 for name in (b"VmSize", b"VmRSS", b"VmPTE"))
        return resident + tables, _number(status, b"FDSize"), min(size // PAGE, MOST_MAPS)
    return 0, 0, 0


def _read(path: str) -> bytes:
    """Return the content of a small file in /proc; Python's file object would take twice as long."""
    file = os.open(path, os.O_RDONLY)
    try:
        return os.read(file, 65536)
    finally:
        os.close(file)


def _number(status: bytes, name: bytes) -> int:
    """Return the number in a line of proc_pid_status(5); 0 if there is none, as for an ended process."""
    _, is_there, rest = status.partition(b"\n%b:" % name)
    return int(rest.split(None, 1)[0]) if is_there else 0


def maps(process: str) -> int:
    """Return how many maps of memory a process has; 0 if it is gone."""
    with contextlib.suppress(OSError), open(f"{process}/maps", "rb") as file:
        return file.read().count(b"\n")
    return 0


def descriptors(process: str) -> int:
    """Return how many open files a process has; 0 if it is gone."""
    with contextlib.suppress(OSError):
        return len(os.listdir(f"{process}/fd"))
    return 0


def sockets() -> int:
    """Return how many sockets the World has, with those that wait to be accepted or are being passed."""
    with open("/proc/net/sockstat", "rb") as file:
        return int(file.readline().split()[-1])


def available() -> int:
    """Return the bytes of memory that this machine can still give to programs."""
    with open("/proc/meminfo", "rb") as file:
        return int(file.read().partition(b"MemAvailable:")[2].split(None, 1)[0]) * 1024


def has_too_many_files(folder: str) -> bool:
    """Return whether the files of a disk would fill it if each took what an empty file counts."""
    disk = os.statvfs(folder)
    return (disk.f_files - disk.f_ffree) * BYTES_PER_FILE > disk.f_blocks * disk.f_frsize
