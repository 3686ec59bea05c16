"""Confine a process to reading and computing, so that code it loads can do no harm.

From then on Linux refuses all of its threads to start a program, to change or remove a file, to reach another
process or a network, or to exceed its limits. This needs no privilege and no package.
"""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import struct

X86_64 = 0xC000003E
# System calls that read, compute, wait or exit, with their numbers on x86-64 (syscall_64.tbl of Linux).
HARMLESS = {
    "read": 0, "write": 1, "close": 3, "stat": 4, "fstat": 5, "lstat": 6, "poll": 7, "lseek": 8, "mmap": 9,
    "mprotect": 10, "munmap": 11, "brk": 12, "rt_sigaction": 13, "rt_sigprocmask": 14, "rt_sigreturn": 15,
    "pread64": 17, "readv": 19, "writev": 20, "access": 21, "pipe": 22, "select": 23, "sched_yield": 24,
    "mremap": 25, "madvise": 28, "dup": 32, "dup2": 33, "nanosleep": 35, "getpid": 39, "socketpair": 53,
    "exit": 60, "uname": 63, "getcwd": 79, "chdir": 80, "readlink": 89, "gettimeofday": 96, "getrlimit": 97,
    "getrusage": 98, "sysinfo": 99, "times": 100, "getuid": 102, "getgid": 104, "geteuid": 107, "getegid": 108,
    "getppid": 110, "sigaltstack": 131, "statfs": 137, "fstatfs": 138, "gettid": 186, "time": 201, "futex": 202,
    "sched_getaffinity": 204, "getdents64": 217, "set_tid_address": 218, "restart_syscall": 219,
    "fadvise64": 221, "clock_gettime": 228, "clock_getres": 229, "clock_nanosleep": 230, "exit_group": 231,
    "epoll_wait": 232, "epoll_ctl": 233, "newfstatat": 262, "readlinkat": 267, "faccessat": 269, "ppoll": 271,
    "set_robust_list": 273, "epoll_pwait": 281, "eventfd2": 290, "epoll_create1": 291, "dup3": 292, "pipe2": 293,
    "getrandom": 318, "membarrier": 324, "statx": 332, "rseq": 334, "close_range": 436, "faccessat2": 439,
}  # fmt: skip
_OPEN, _OPENAT, _IOCTL, _FCNTL, _CLONE, _CLONE3, _SECCOMP = 2, 257, 16, 72, 56, 435, 317
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC
_IS_THREAD = 0x10000  # CLONE_THREAD
_FIONBIO = 0x5421  # with which Python makes a socket non-blocking
_F_SETFL = 4  # the commands after it lock files or signal other processes
_EPERM, _ENOSYS = 1, 38

# The instructions of a filter, and what it may return (seccomp(2) and bpf of Linux).
_LOAD, _EQUAL, _ABOVE, _HAS, _RETURN = 0x20, 0x15, 0x25, 0x45, 0x06
_ALLOW, _REFUSE, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_NO_NEW_PRIVILEGES, _SIGNAL_OF_PARENT = 38, 1  # of prctl
_SET_FILTER, _OF_ALL_THREADS = 1, 1


def confine(*, memory_bytes: int, cpu_s: int, written_bytes: int) -> None:
    """Confine this process, and end it when its parent ends.

    Args:
        memory_bytes: how much memory it may use.
        cpu_s: how many seconds of CPU time it may use.
        written_bytes: how much it may write to each file that is already open.

    Raises:
        OSError: if this machine cannot confine it; untrusted code must not be run then.
    """
    for limit, wanted in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, cpu_s),
        (resource.RLIMIT_FSIZE, written_bytes),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(limit)
        most = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(limit, (most, most))
    libc = ctypes.CDLL(None, use_errno=True)
    code = ctypes.create_string_buffer(_filter())
    program = ctypes.create_string_buffer(struct.pack("=HxxxxxxQ", len(code) // 8, ctypes.addressof(code)))
    for call, *given in (
        (libc.prctl, _SIGNAL_OF_PARENT, signal.SIGKILL, 0, 0, 0),
        (libc.prctl, _NO_NEW_PRIVILEGES, 1, 0, 0, 0),
        (libc.syscall, _SECCOMP, _SET_FILTER, _OF_ALL_THREADS, program),
    ):
        if call(*given):
            number = ctypes.get_errno()
            raise OSError(number, f"This process cannot be confined: {os.strerror(number)}")


def _filter() -> bytes:
    program = [(_LOAD, 0, 0, 4), (_EQUAL, 1, 0, X86_64), (_RETURN, 0, 0, _KILL), (_LOAD, 0, 0, 0)]
    for number in HARMLESS.values():
        program += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _ALLOW)]
    program += _only(_OPEN, 1, (_HAS, 1, 0, _WRITES))
    program += _only(_OPENAT, 2, (_HAS, 1, 0, _WRITES))
    program += _only(_IOCTL, 1, (_EQUAL, 0, 1, _FIONBIO))
    program += _only(_FCNTL, 1, (_ABOVE, 1, 0, _F_SETFL))
    program += _only(_CLONE, 0, (_HAS, 0, 1, _IS_THREAD))
    # glibc falls back to clone, which is checked above.
    program += [
        (_EQUAL, 0, 1, _CLONE3),
        (_RETURN, 0, 0, _REFUSE | _ENOSYS),
        (_RETURN, 0, 0, _REFUSE | _EPERM),
    ]
    return b"".join(struct.pack("=HBBI", *instruction) for instruction in program)


def _only(number: int, argument: int, test: tuple[int, int, int, int]) -> list[tuple[int, int, int, int]]:
    """Return the instructions that allow a call unless the test of an argument jumps to the refusal."""
    return [
        (_EQUAL, 0, 4, number),
        (_LOAD, 0, 0, 16 + 8 * argument),
        test,
        (_RETURN, 0, 0, _ALLOW),
        (_RETURN, 0, 0, _REFUSE | _EPERM),
    ]
