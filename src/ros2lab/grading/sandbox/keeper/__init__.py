"""Keep the boxes of one World: start them, watch their limits, end them.

`sandbox.World` runs `main` as a program of its own inside the World's network. A box cannot see it.
It ends every box and then itself when the grader closes the socket or dies, however that happens.

It imports only a few modules of the standard library, because each World waits for it to start. These files
are loaded as a package of their own, so that they import each other relatively.
"""

# pathlib takes as long to import as all of the others.
# ruff: noqa: PTH123

import os

NOT_STARTED = 126  # the exit code of a shell
NOBODY = 65534
TCP_BUFFERS = {"tcp_rmem": "4096 65536 131072", "tcp_wmem": "4096 16384 65536"}

# What bubblewrap finds here and binds into each box.
FOLDER = "/box"
FILES = "/files"
SHARED = "/shared"  # what some boxes share: a folder for each name
FOLDER_OF_WAITING = "/etc/waiting"  # in the box; Python imports from it the code that only waits

# The box's own /etc.
SETTINGS = {
    "passwd": "student:x:1000:1000::/tmp/home:/bin/sh\n",
    "group": "student:x:1000:\n",
    "hosts": "127.0.0.1 localhost\n::1 localhost\n",
    "nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}


# Takes the short name that Linux would give the script, and waits. Python imports it before anything else, such as
# the site-packages, whose start-up hooks take five times as long as all before them.
_WAITING = """
import ctypes, os, sys, time
ctypes.CDLL(None).prctl(15, os.path.basename(sys.argv[0] or sys.orig_argv[0]).encode())
while True:
    time.sleep(3600)
"""
# More files that a box is shown, by their names here: a command line of the first process that names no
# program, and the code of a process that only waits.
SHOWN = {
    "init": ("/proc/1/cmdline", "init\0"),
    "waiting": (f"{FOLDER_OF_WAITING}/encodings.py", _WAITING),
}


# Why a box is ended, as a sentence.
LIMITS = {
    "time": "It ran longer than {:g} s.",
    "cpu": "It used more than {:g} s of CPU time.",
    "memory": "It used more than {:g} MB of memory.",
    "together": "It and what ran beside it used more than {:g} MB of memory.",
    "files": "It made more files than its disk is for.",
    "output": "It wrote more than {:g} MB.",
}


def is_limit(said: str) -> bool:
    """Return whether a text is the sentence that says which limit ended a box, and not a program's output."""
    forms = [form.partition("{:g}") for form in LIMITS.values()]
    return any(said.startswith(start) and said.endswith(end) and "\n" not in said for start, _, end in forms)


def is_root() -> bool:
    """Return whether this process is root and can become another user, unlike root of a small namespace."""
    with open("/proc/self/uid_map", encoding="ascii") as file:
        ranges = [[int(number) for number in line.split()] for line in file]
    return os.getuid() == 0 and any(first <= NOBODY < first + count for first, _, count in ranges)
