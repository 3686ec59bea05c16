"""The system calls that no box may make, as the seccomp program that refuses them."""

from __future__ import annotations

import struct

# linux/seccomp.h, linux/audit.h, linux/bpf_common.h
ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050000, 0x80000000
X86_64, X32_BIT = 0xC000003E, 0x40000000
LOAD, EQUAL, AT_LEAST, ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
PRETEND, EPERM, EINVAL, ENOSYS, EPROTONOSUPPORT, EAFNOSUPPORT = 0, 1, 22, 38, 93, 97

# asm/unistd_64.h. Calls that look into other processes, make namespaces, hold memory that counts as no
# process's, or use up what the grading user or the whole machine has.
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
# Programs do without these if they are missing. A timer may resume a process that is held. A pipe or a socket
# that is given a page for a byte of it keeps the whole, up to 2 MB; there is no limit to rules of landlock
# and seccomp.
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
# Calls of later kernels could hold memory, too: programs see a kernel that is no newer than these.
LATER_CALL, LATER_OPTION = 450, 70  # cachestat and what follows; of prctl, what follows PR_SET_MEMORY_MERGE
FAMILIES = (1, 2, 10, 16)  # unix, IPv4, IPv6, netlink; not vsock, which is no part of a network namespace
INTERNET, PROTOCOLS = (2, 10), (0, 1, 6, 17)  # ICMP, TCP, UDP; one socket of SCTP has any number of peers

# A test of a call's argument: which argument, how it is compared and with what, and whether that must hold.
Test = tuple[int, int, int, bool]
# Calls that are refused only with some arguments.
REFUSED_IF: list[tuple[int, int, list[Test]]] = [
    (56, EPERM, [(0, ANY_BIT, 0x7E020000, True)]),  # clone, CLONE_NEWUSER and its kin
    # mmap, MAP_SHARED and MAP_ANONYMOUS; multiprocessing takes /dev/shm
    (9, EPERM, [(3, ANY_BIT, 0x01, True), (3, ANY_BIT, 0x20, True)]),
    (41, EAFNOSUPPORT, [(0, EQUAL, family, False) for family in FAMILIES]),  # socket
    *(
        (
            41,
            EPROTONOSUPPORT,
            [(0, EQUAL, family, True), *((2, EQUAL, protocol, False) for protocol in PROTOCOLS)],
        )
        for family in INTERNET
    ),
    # setsockopt, SO_SNDBUF and SO_RCVBUF: Linux, too, takes another size than it is asked for
    *((54, PRETEND, [(1, EQUAL, 1, True), (2, EQUAL, name, True)]) for name in (7, 8)),
    (54, EPERM, [(1, EQUAL, 1, True), (2, EQUAL, 60, True)]),  # setsockopt, SO_ZEROCOPY: as splice
    (157, EINVAL, [(0, AT_LEAST, LATER_OPTION, True)]),  # prctl; a table of futexes takes 2 GB
    (157, EINVAL, [(0, EQUAL, 22, True)]),  # prctl, PR_SET_SECCOMP
    (72, EPERM, [(1, EQUAL, 1031, True)]),  # fcntl, F_SETPIPE_SZ
    (72, EPERM, [(1, EQUAL, 10, True)]),  # fcntl, F_SETSIG: the signal may resume a process that is held
]


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
    """Return the instructions that refuse a call with `error` if all tests hold."""
    steps = [(LOAD, 0, True), (EQUAL, number, True)]
    for argument, operation, operand, must_hold in tests:
        steps += [(LOAD, 16 + 8 * argument, True), (operation, operand, must_hold)]
    program = []
    for at, (operation, operand, must_hold) in enumerate(steps):
        past = 0 if operation == LOAD else len(steps) - at
        program.append((operation, *((0, past) if must_hold else (past, 0)), operand))
    return [*program, (RETURN, 0, 0, REFUSE | error)]
