"""Keep the boxes of one World: start them, watch their limits, end them.

`sandbox.World` runs this file as a program of its own inside the World's network. A box cannot see it.
It ends every box and then itself when the grader lets go of the socket or dies, however that happens.

Only the standard library, and few modules of it: each World waits for this to start.
"""

# pathlib takes as long to import as all of the others.
# ruff: noqa: PTH110, PTH116, PTH123, PTH208

import contextlib
import json
import os
import select
import signal
import socket
import struct
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping

TICK = 0.04  # s between two looks at the boxes
MOMENT = 0.002  # s between two of them while the processes of a box are stopped
LAST_WAIT = 5.0  # s until the last process of a box has gone, once bubblewrap has
BYTES_PER_FILE = 4096  # what an empty file is counted as
# As much can wait in a socket, and is not shown as anybody's: net.core.wmem_default, as Linux has it. No socket of a box
# gets more, and a pipe never holds as much.
BYTES_PER_OPEN_FILE = 212_992
# What Linux keeps of a map of memory, and besides for each process that has a copy of it: no page shows it.
BYTES_PER_MAP, BYTES_PER_COPY = 448, 64
NOT_STARTED = 126  # as a shell has it
COUNTING = 0.01  # s at a look in which maps are counted
TCP_BUFFERS = {"tcp_rmem": "4096 65536 131072", "tcp_wmem": "4096 16384 65536"}
PAGE = os.sysconf("SC_PAGE_SIZE")
CLOCK_TICKS = os.sysconf("SC_CLK_TCK")
NOBODY = 65534

# What bubblewrap finds here and binds into each box.
FOLDER = "/box"
FILES = "/files"

# The box's own /etc.
SETTINGS = {
    "passwd": "student:x:1000:1000::/tmp/home:/bin/sh\n",
    "group": "student:x:1000:\n",
    "hosts": "127.0.0.1 localhost\n::1 localhost\n",
    "nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}

# They are the machine's, and whoever may write to one may set its times to now: another box could read when it was.
DEVICES = [f"/dev/{name}" for name in ("null", "zero", "full", "random", "urandom", "tty")]

# linux/seccomp.h, linux/audit.h, linux/bpf_common.h
ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050000, 0x80000000
X86_64, X32_BIT = 0xC000003E, 0x40000000
LOAD, EQUAL, AT_LEAST, ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
PRETEND, EPERM, EINVAL, ENOSYS, EPROTONOSUPPORT, EAFNOSUPPORT = 0, 1, 22, 38, 93, 97

# asm/unistd_64.h. What looks into other processes, makes namespaces, holds memory that no process shows, or is counted
# together with what the user who grades has, or with what the whole machine has.
REFUSED = {
    "shmget": 29,
    "semget": 64,
    "msgget": 68,
    "ptrace": 101,
    "io_setup": 206,
    "mq_open": 240,
    "add_key": 248,
    "request_key": 249,
    "keyctl": 250,
    "inotify_init": 253,
    "unshare": 272,
    "inotify_init1": 294,
    "perf_event_open": 298,
    "fanotify_init": 300,
    "setns": 308,
    "process_vm_readv": 310,
    "process_vm_writev": 311,
    "kcmp": 312,
    "bpf": 321,
    "userfaultfd": 323,
    "io_uring_setup": 425,
    "pidfd_getfd": 438,
    "memfd_secret": 447,
}
# Programs do without them where they are not there. A timer may let a process go on that is held. A pipe or a socket
# that is given a page itself, for a byte of it, keeps the whole, up to 2 MB; rules of landlock and seccomp have no end.
HAVE_ANOTHER_WAY = {
    "sendfile": 40,
    "timer_create": 222,
    "splice": 275,
    "tee": 276,
    "vmsplice": 278,
    "seccomp": 317,
    "memfd_create": 319,
    "clone3": 435,
    "landlock_create_ruleset": 444,
}
# What later Linuxes have brought could hold memory, too: to a program, this one is as old as these.
LATER_CALL, LATER_OPTION = 450, 70  # cachestat and what follows; of prctl, what follows PR_SET_MEMORY_MERGE
FAMILIES = (1, 2, 10, 16)  # unix, IPv4, IPv6, netlink; not vsock, which is no part of a network namespace
INTERNET, PROTOCOLS = (2, 10), (0, 1, 6, 17)  # ICMP, TCP, UDP; one socket of SCTP has any number of peers

# A test of an argument of a call: which argument, how it is compared and with what, and whether that must hold.
Test = tuple[int, int, int, bool]
# Calls that are refused with some arguments only.
REFUSED_IF: list[tuple[int, int, list[Test]]] = [
    (56, EPERM, [(0, ANY_BIT, 0x7E020000, True)]),  # clone, CLONE_NEWUSER and its kin
    # mmap, MAP_SHARED and MAP_ANONYMOUS; multiprocessing takes /dev/shm
    (9, EPERM, [(3, ANY_BIT, 0x01, True), (3, ANY_BIT, 0x20, True)]),
    (41, EAFNOSUPPORT, [(0, EQUAL, family, False) for family in FAMILIES]),  # socket
    *(
        (41, EPROTONOSUPPORT, [(0, EQUAL, family, True), *((2, EQUAL, one, False) for one in PROTOCOLS)])
        for family in INTERNET
    ),
    # setsockopt, SO_SNDBUF and SO_RCVBUF: Linux, too, takes another size than it is asked for
    *((54, PRETEND, [(1, EQUAL, 1, True), (2, EQUAL, name, True)]) for name in (7, 8)),
    (54, EPERM, [(1, EQUAL, 1, True), (2, EQUAL, 60, True)]),  # setsockopt, SO_ZEROCOPY: as splice
    (157, EINVAL, [(0, AT_LEAST, LATER_OPTION, True)]),  # prctl; a table of futexes takes 2 GB
    (157, EINVAL, [(0, EQUAL, 22, True)]),  # prctl, PR_SET_SECCOMP
    (72, EPERM, [(1, EQUAL, 1031, True)]),  # fcntl, F_SETPIPE_SZ
    (72, EPERM, [(1, EQUAL, 10, True)]),  # fcntl, F_SETSIG: what comes may let a process go on that is held
]


class Box:
    """One running bubblewrap."""

    def __init__(self, number: int, pid: int, status: int, limits: dict[str, float]) -> None:
        self.number = number
        self.pid = pid
        self.ended = os.pidfd_open(pid)
        self.status = status  # the pipe on which bubblewrap tells the first process of the box, and its end
        self.told = b""
        self.init = 0  # process number of the box's first process
        self.init_handle = -1
        self.limits = limits
        self.start = time.monotonic()
        # CPU seconds of each process, and of those that it has waited for, as last seen; by its number and its start.
        self.cpu_of: dict[tuple[bytes, bytes], tuple[float, float]] = {}
        self.cpu_of_gone = 0.0
        self.memory, self.slots = 0, 0  # bytes that its processes show, and the open files that they may have
        self.maps: dict[
            str, int
        ] = {}  # of each process, as last counted; the one that was counted last comes last
        self.cut: str | None = None
        self.fault = ""
        self.is_doomed = False
        self.is_to_stand = False
        self.is_interrupted = self.was_interrupted = False

    @property
    def root(self) -> str:
        """The box's own root folder, as Linux shows it."""
        return f"/proc/{self.init}/root"

    @property
    def processes_folder(self) -> str:
        """The box's own /proc."""
        return f"{self.root}/proc"

    def read_status(self) -> None:
        """Take in what bubblewrap has written, as far as it has."""
        while select.select([self.status], [], [], 0)[0] and (part := os.read(self.status, 4096)):
            self.told += part
        if not self.init and b"\n" in self.told:
            self.init = json.loads(self.told.split(b"\n")[0])["child-pid"]
            with contextlib.suppress(ProcessLookupError):
                self.init_handle = os.pidfd_open(self.init)

    def look(self, free: int, sockets: int, adrift: Callable[[], int]) -> None:
        """Compare what the box uses with its limits.

        Args:
            free: bytes of memory that this machine can still give.
            sockets: how many there are in the World.
            adrift: tells the bytes of memory in the World that no process of a box holds any more.
        """
        if self.is_doomed:
            return
        self.cut = self._reason(sockets, adrift)
        if self.cut is None and free < self.limits["spare_bytes"]:
            self.fault = "This machine has too little memory left"
        self.is_doomed = bool(self.cut or self.fault)

    def act(self) -> None:
        """Carry out what was asked for, or what a limit asks for."""
        if not self.init:
            self.read_status()
        if self.is_doomed and self.init_handle >= 0:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self.init_handle, signal.SIGKILL)
        elif self.is_interrupted and self._has_started():
            self.is_interrupted, self.was_interrupted = False, True
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.init, signal.SIGINT)  # the first process of a process namespace ignores it

    def has_come_to_stand(self) -> bool:
        """Stop all that runs in the box where it is, if that was asked for; return whether all of it stands by now."""
        if self.is_to_stand and self._has_started() and not any([*self._signal_all(signal.SIGSTOP)]):
            self.is_to_stand = False
            return True
        return False

    def release(self) -> None:
        """Let all that runs in the box go on."""
        self.is_to_stand = False
        if self._has_started():
            _ = [*self._signal_all(signal.SIGCONT)]

    def _signal_all(self, number: int) -> Iterator[bool]:
        """Send a signal to all processes but the first one; yield of each whether it was running until now."""
        for name in _numbers(self.processes_folder):
            with contextlib.suppress(OSError):
                process = os.open(f"{self.processes_folder}/{name}", os.O_RDONLY | os.O_DIRECTORY)
                try:
                    if name != "1":
                        yield _is_running(f"/proc/self/fd/{process}")
                        signal.pidfd_send_signal(process, number)
                finally:
                    os.close(process)

    def _reason(self, sockets: int, adrift: Callable[[], int]) -> str | None:
        """Say which limit it is over."""
        limit = self.limits
        if time.monotonic() - self.start > limit["wall_s"]:
            return f"It ran longer than {limit['wall_s']:g} s."
        if not self._has_started():
            return None
        with contextlib.suppress(OSError):  # it has just ended
            if self._cpu_s() > limit["cpu_s"]:
                return f"It used more than {limit['cpu_s']:g} s of CPU time."
            if self._is_over_memory(sockets, adrift):
                return f"It used more than {limit['memory_bytes'] / 1e6:g} MB of memory."
            folders = (f"{self.root}/tmp", f"{self.root}/dev/shm", FILES)  # noqa: S108 -- the box's own
            if any(map(_has_too_many_files, folders)):
                return "It made more files than its disk is for."
        return None

    def _has_started(self) -> bool:
        """Return whether the box has its own /proc, instead of the whole machine's, and the program is there."""
        try:
            is_own = bool(self.init) and os.stat(self.processes_folder).st_dev != OWN_PROC
            return is_own and os.path.exists(f"{self.processes_folder}/2")
        except OSError:
            return False

    def _cpu_s(self) -> float:
        """Return the CPU seconds of all its processes.

        Those of one that has ended are its parent's if that has waited for it, which a parent may leave. Then they count
        as they were last seen.
        """
        seen = {key: seconds for process in self._processes() for key, seconds in _cpu_s(process)}
        self.cpu_of_gone += sum(own for key, (own, _) in self.cpu_of.items() if key not in seen)
        self.cpu_of = seen
        own, waited_for = map(sum, zip(*seen.values(), strict=True)) if seen else (0.0, 0.0)
        return own + max(waited_for, self.cpu_of_gone)

    def _is_over_memory(self, sockets: int, adrift: Callable[[], int]) -> bool:
        """Return whether all of its processes hold too much; what takes long is counted only where that may decide it."""
        most = self.limits["memory_bytes"]
        held = {process: _memory(process) for process in self._processes()}
        memory, slots, pages = map(sum, zip(*held.values(), strict=True)) if held else (0, 0, 0)
        self.memory, self.slots = memory, slots
        of_a_map = BYTES_PER_MAP + BYTES_PER_COPY * len(held)
        if memory + (slots + sockets) * BYTES_PER_OPEN_FILE + pages * of_a_map <= most:
            return False
        memory += self._count_maps(held) * of_a_map
        return memory + self.descriptors() * BYTES_PER_OPEN_FILE + adrift() > most

    def _count_maps(self, processes: Collection[str]) -> int:
        """Return how many maps of memory processes have, of which some are counted anew, each in its turn."""
        waiting = [name for name in processes if name not in self.maps]
        waiting += [name for name in self.maps if name in processes]
        self.maps = {name: self.maps.get(name, 0) for name in waiting}
        end = time.monotonic() + COUNTING
        for name in waiting:
            del self.maps[name]
            self.maps[name] = _maps(name)
            if time.monotonic() > end:
                break
        return sum(self.maps.values())

    def descriptors(self) -> int:
        """Return how many open files all its processes have."""
        return sum(map(_descriptors, self._processes())) if self._has_started() else 0

    def _processes(self) -> list[str]:
        """Return the folders of all its processes, once the program is there; none when it has ended."""
        return [f"{self.processes_folder}/{name}" for name in _numbers(self.processes_folder)]


OWN_PROC = os.stat("/proc").st_dev
with open("/proc/sys/vm/max_map_count", encoding="ascii") as most_maps:
    MOST_MAPS = int(most_maps.read())


class Keeper:
    """The boxes, and the grader at the other end of `control`."""

    def __init__(self, control: socket.socket, grader: int) -> None:
        self.control = control
        self.grader = os.pidfd_open(grader)
        self.boxes: dict[int, Box] = {}
        self.is_over = False
        self.next_look = 0.0

    def run(self) -> None:
        """Serve until the grader has gone, and leave nothing."""
        while not self.is_over or self.boxes:
            waiting = [box.ended for box in self.boxes.values()]
            waiting += [box.status for box in self.boxes.values() if not box.init]
            if not self.is_over:
                waiting += [self.control.fileno(), self.grader]
            pause = MOMENT if any(box.is_to_stand for box in self.boxes.values()) else TICK
            ready, _, _ = select.select(waiting, [], [], pause if self.boxes else None)
            if not self.is_over and (
                self.grader in ready or (self.control.fileno() in ready and not self.obey())
            ):
                self.is_over = True
            if time.monotonic() >= self.next_look:
                free, sockets = available(), _sockets()
                for box in self.boxes.values():
                    box.look(free, sockets, self.adrift)
                self.look_at_all()
                self.next_look = time.monotonic() + TICK
            for box in list(self.boxes.values()):
                box.is_doomed |= self.is_over
                box.act()
                if box.has_come_to_stand():
                    self.tell({"box": box.number, "stands": True})
                if box.ended in ready:
                    self.bury(box)

    def look_at_all(self) -> None:
        """Compare what all boxes hold with what they may together, and end the one that holds most where it is too much."""
        boxes = [box for box in self.boxes.values() if not box.is_doomed]
        most = max((box.limits["together_bytes"] for box in boxes), default=0)
        if sum(box.memory + box.slots * BYTES_PER_OPEN_FILE for box in boxes) <= most:
            return
        held = {box: box.memory + box.descriptors() * BYTES_PER_OPEN_FILE for box in boxes}
        if sum(held.values()) > most:
            largest = max(held, key=held.__getitem__)
            largest.cut = f"It and what ran beside it used more than {most / 1e6:g} MB of memory."
            largest.is_doomed = True

    def adrift(self) -> int:
        """Return the bytes of memory in the World that no process of a box holds any more."""
        held = sum(box.descriptors() for box in self.boxes.values())
        return max(0, _sockets() - held) * BYTES_PER_OPEN_FILE

    def obey(self) -> bool:
        """Do what one message asks for; False when there is no more to come."""
        try:
            data, passed, _, _ = socket.recv_fds(self.control, 1 << 20, 2)
        except OSError:
            return False
        if not data:
            return False
        for descriptor in passed:
            os.set_inheritable(descriptor, False)
        message = json.loads(data)
        number = message["box"]
        if message["do"] == "start":
            self.start(number, message["command"], passed, message["limits"])
        elif box := self.boxes.get(number):
            box.is_interrupted |= message["do"] == "interrupt"
            box.is_doomed |= message["do"] == "kill"
            box.is_to_stand |= message["do"] == "hold"
            if message["do"] == "release":
                box.release()
        return True

    def start(self, number: int, command: list[str], passed: list[int], limits: dict[str, float]) -> None:
        """Start a box; what no program can be given, such as a word with a zero byte, is said where it would write."""
        output, *_ = passed
        try:
            self.boxes[number] = _start(number, command, passed, limits)
        except (OSError, ValueError) as error:
            os.write(output, f"It cannot be started: {error}\n".encode())
            self.tell({"box": number, "code": NOT_STARTED, "cut": None, "seconds": 0.0, "was_made": True})
        finally:
            for descriptor in passed:
                os.close(descriptor)

    def tell(self, message: Mapping[str, object]) -> None:
        """Send a message to the grader, if it is still there."""
        try:
            self.control.send(json.dumps(message).encode())
        except OSError:
            self.is_over = True

    def bury(self, box: Box) -> None:
        """Tell the grader how the box ended."""
        _, wait_status = os.waitpid(box.pid, 0)
        code = os.waitstatus_to_exitcode(wait_status)
        box.read_status()
        if box.init_handle >= 0:  # with the first process of the box, all others have ended
            select.select([box.init_handle], [], [], LAST_WAIT)
        for descriptor in (box.ended, box.status, box.init_handle):
            if descriptor >= 0:
                os.close(descriptor)
        del self.boxes[box.number]
        end = {
            "box": box.number,
            "code": code if code >= 0 else 128 - code,
            "cut": box.cut,
            "seconds": time.monotonic() - box.start,
            "fault": box.fault,
            # bubblewrap tells an exit code only of a program that it has reached, which a signal may prevent.
            "was_made": b"exit-code" in box.told or box.is_doomed or box.was_interrupted,
        }
        self.tell(end)


def main() -> None:
    """Prepare what all boxes share, and keep them. `argv[1]` is the grader's process, standard input its socket."""
    control = socket.socket(fileno=0)
    _prepare()
    keeper = Keeper(control, int(sys.argv[1]))
    files = os.open(FILES, os.O_PATH)
    socket.send_fds(control, [b"ready"], [files])
    os.close(files)
    keeper.run()


def is_root() -> bool:
    """Return whether this process is root and can become another user; root of a small user namespace cannot."""
    with open("/proc/self/uid_map", encoding="ascii") as file:
        ranges = [[int(number) for number in line.split()] for line in file]
    return os.getuid() == 0 and any(first <= NOBODY < first + count for first, _, count in ranges)


def system_call_filter() -> bytes:
    """Return the seccomp program of a box, for x86-64."""
    program = [(LOAD, 0, 0, 4), (EQUAL, 1, 0, X86_64), (RETURN, 0, 0, KILL)]
    program += [(LOAD, 0, 0, 0), (AT_LEAST, 0, 1, X32_BIT), (RETURN, 0, 0, KILL)]
    program += [(AT_LEAST, 0, 1, LATER_CALL), (RETURN, 0, 0, REFUSE | ENOSYS)]
    for number in REFUSED.values():
        program += _answer(number, EPERM, [])
    for number in HAVE_ANOTHER_WAY.values():
        program += _answer(number, ENOSYS, [])
    for number, error, tests in REFUSED_IF:
        program += _answer(number, error, tests)
    program += [(RETURN, 0, 0, ALLOW)]
    return b"".join(struct.pack("=HBBI", *instruction) for instruction in program)


def _answer(number: int, error: int, tests: list[Test]) -> list[tuple[int, int, int, int]]:
    """Return the instructions by which a call is not made, and gives `error`, where all tests hold."""
    steps = [(LOAD, 0, True), (EQUAL, number, True)]
    for argument, operation, operand, must_hold in tests:
        steps += [(LOAD, 16 + 8 * argument, True), (operation, operand, must_hold)]
    program = []
    for at, (operation, operand, must_hold) in enumerate(steps):
        past = 0 if operation == LOAD else len(steps) - at
        program.append((operation, *((0, past) if must_hold else (past, 0)), operand))
    return [*program, (RETURN, 0, 0, REFUSE | error)]


def _prepare() -> None:
    """Write what is bound into every box, and stop being root."""
    os.umask(0o022)  # the boxes' programs, too, make files that are read
    for name, text in SETTINGS.items():
        with open(f"{FOLDER}/{name}", "w", encoding="ascii") as file:
            file.write(text)
    with open(f"{FOLDER}/filter", "wb") as program:
        program.write(system_call_filter())
    if is_root():
        # To Linux, the limit on processes does not hold for root.
        os.chown(FILES, NOBODY, NOBODY)
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)


def _start(number: int, command: list[str], passed: list[int], limits: dict[str, float]) -> Box:
    for device in DEVICES:
        with contextlib.suppress(OSError):  # what this user may not mark, no box may
            os.utime(device)
    output, *given = passed
    status, its_status = os.pipe()
    its_filter, nothing = (os.open(path, os.O_RDONLY) for path in (f"{FOLDER}/filter", os.devnull))
    for descriptor in (its_status, its_filter):
        os.set_inheritable(descriptor, True)
    options = ["--json-status-fd", str(its_status), "--seccomp", str(its_filter)]
    try:
        pid = os.posix_spawn(
            command[0],
            [command[0], *options, *command[1:]],
            {},
            file_actions=[
                (os.POSIX_SPAWN_DUP2, given[0] if given else nothing, 0),
                *((os.POSIX_SPAWN_DUP2, output, n) for n in (1, 2)),
            ],
            setsigdef=[n for n in signal.valid_signals() if n not in (signal.SIGKILL, signal.SIGSTOP)],
            setsigmask=[],
        )
    except (OSError, ValueError):
        os.close(status)
        raise
    finally:
        for descriptor in (its_status, its_filter, nothing):
            os.close(descriptor)
    return Box(number, pid, status, limits)


def _numbers(folder: str) -> list[str]:
    """Return the numbers of processes or threads that have a folder in one; none where that has gone."""
    try:
        return [name for name in os.listdir(folder) if name.isdigit()]
    except OSError:
        return []


def _is_running(process: str) -> bool:
    """Return whether a thread of a process has neither ended nor stopped.

    What waits in Linux itself, as who has begun a program by vfork() does until that runs, stops before anything else if
    it has been sent the signal; if what it waits for stands, it may wait for ever.
    """
    for thread in _numbers(f"{process}/task"):
        with contextlib.suppress(OSError), open(f"{process}/task/{thread}/stat", "rb") as file:
            state = file.read().rpartition(b")")[2].split()[0]
            if state not in (b"T", b"Z", b"X") and not (state == b"D" and _is_to_stop(f"{process}/status")):
                return True
    return False


def _is_to_stop(status: str) -> bool:
    with open(status, "rb") as file:
        waiting = int(file.read().partition(b"ShdPnd:")[2].split(None, 1)[0], 16)
    return bool(waiting >> (signal.SIGSTOP - 1) & 1)


def _cpu_s(process: str) -> Iterator[tuple[tuple[bytes, bytes], tuple[float, float]]]:
    """Yield the number and the start of a process, its CPU seconds, and those of its children that it has waited for."""
    with contextlib.suppress(OSError), open(f"{process}/stat", "rb") as file:
        number, _, rest = file.read().partition(b" ")
        fields = rest.rpartition(b")")[2].split()  # proc_pid_stat(5), from the third on
        user, system, users, systems = map(int, fields[11:15])
        yield (number, fields[19]), ((user + system) / CLOCK_TICKS, (users + systems) / CLOCK_TICKS)


def _memory(process: str) -> tuple[int, int, int]:
    """Return the bytes of memory of a process, and how many open files and maps it has at most; 0 if it has gone."""
    with contextlib.suppress(OSError), open(f"{process}/status", "rb") as file:
        fields = dict(line.split(b":", 1) for line in file.read().splitlines())
        size, *held = (
            int(fields[name].split()[0]) * 1024 if name in fields else 0
            for name in (b"VmSize", b"VmRSS", b"VmPTE")
        )
        return sum(held), int(fields[b"FDSize"]), min(size // PAGE, MOST_MAPS)
    return 0, 0, 0


def _maps(process: str) -> int:
    with contextlib.suppress(OSError), open(f"{process}/maps", "rb") as file:
        return file.read().count(b"\n")
    return 0


def _descriptors(process: str) -> int:
    with contextlib.suppress(OSError):
        return len(os.listdir(f"{process}/fd"))
    return 0


def _sockets() -> int:
    """Return how many sockets there are in the World, also those that wait to be accepted or are on their way."""
    with open("/proc/net/sockstat", "rb") as file:
        return int(file.readline().split()[-1])


def available() -> int:
    """Return the bytes of memory that this machine can still give to programs."""
    with open("/proc/meminfo", "rb") as file:
        return int(file.read().partition(b"MemAvailable:")[2].split(None, 1)[0]) * 1024


def _has_too_many_files(folder: str) -> bool:
    disk = os.statvfs(folder)
    return (disk.f_files - disk.f_ffree) * BYTES_PER_FILE > disk.f_blocks * disk.f_frsize


if __name__ == "__main__":
    main()
