"""Run a submission's programs so that they can do no harm.

A `World` is a network of its own, with only a loopback interface, and one folder of files. Each program runs
in a `Box` of the World: its own processes, its own /tmp, /dev/shm and home, a read-only system, and limits.
Boxes of one World can talk over the loopback and abstract sockets; those started with the same `among` share
these folders, as programs on one machine do. All of it ends with the World, and with the grader.

Linux namespaces do the work, through bubblewrap (https://github.com/containers/bubblewrap). Processes, open
files and disks are limited by Linux. CPU time and memory of a whole box are summed from outside 25 times a
second, without control groups: a box can exceed these two limits by what it can do in 40 ms. System calls
that allocate memory that belongs to no process are refused.
"""

from __future__ import annotations

import contextlib
import errno
import itertools
import json
import os
import selectors
import shutil
import socket
import stat
import subprocess
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

from ros2lab import environment
from ros2lab.grading.sandbox import bubblewrap, keeper
from ros2lab.grading.sandbox.box import (
    Box,
    End,
    Limits,
    SandboxMissing,
    allow_open_files,
    refuse_narrow_limits,
    why,
)
from ros2lab.grading.sandbox.neighbours import Neighbours

FILES = "/submission"
OWN = ("/dev/shm", "/tmp")  # noqa: S108 -- the box's own
HOME = "/tmp/home"  # noqa: S108 -- the same
# These let the ROS nodes of two boxes meet: discovery on LOCALHOST uses shared memory, which boxes do not
# share.
ROS_SETTINGS = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}

# The default environment of a box. ROS messages import numpy, which would otherwise start threads that cost a
# quarter of a node's start.
ENVIRON = {"PATH": "/usr/bin:/bin", "HOME": HOME, "LANG": "C.UTF-8", "OPENBLAS_NUM_THREADS": "1"}

HARDWARE = Path("/sys/class")
START_TIMEOUT = 30.0  # s, on a machine that is very busy

_USUAL = Limits()

Access = Literal["none", "read", "write"]


def underlay() -> dict[str, str]:
    """Return the environment that gives a box ROS and colcon, and nothing of a submission.

    The file `environment.DDS_PROFILE` must be shown to the World.

    Raises:
        RuntimeError: if the installed Jazzy cannot be sourced, or colcon is not installed.
    """
    environ = (
        environment.lab_environment({"ROS_DOMAIN_ID": "0"}) | environment.found_libraries() | ROS_SETTINGS
    )
    if shutil.which("colcon", path=environ["PATH"]) is None:
        raise RuntimeError(f"The command colcon is not installed; run `{environment.INSTALL}`.")
    return {
        name: value for name, value in environ.items() if name not in ("HOME", "PWD", "OLDPWD", "SHLVL", "_")
    }


class World:
    """A private network and a private copy of a folder, in which boxes run; a context manager.

    Attributes:
        folder: the copy, as the grader reads and writes it while the World is open. It is in memory, and the boxes
            see it as /submission. What the grader puts there before the first box starts belongs to the
            boxes. The path leads through /proc, so it must not be resolved; a link in it may point to any
            file of the grader.
        limits: the limits of a box that is given no others.
        folders: empty folders that each box has of its own besides /tmp and its home, unless something lies
            there already; the same list for the Worlds made by `beside`.

    Args:
        files: the folder to copy; None starts with an empty one.
        shown: further files and folders that every box can read, at their own paths; showing a folder around
            `PACKAGE` does not show `PACKAGE`.
        limits: the limits.

    Raises:
        SandboxMissing: if this machine cannot make one.
        ValueError: if `files` cannot be copied.
    """

    def __init__(
        self, files: Path | None = None, *, shown: Iterable[Path] = (), limits: Limits = _USUAL
    ) -> None:
        self.limits = limits
        self.folders = ["/home", "/root"]
        self._given = [*shown]
        self._shown = bubblewrap.shown(self._given)
        self._boxes: dict[int, Box] = {}
        self._numbers = itertools.count()
        self._is_handed_over = False
        refuse_narrow_limits()
        allow_open_files()
        self._bubblewrap = bubblewrap.program()
        self._control, its_control = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with its_control:
            self._popen = subprocess.Popen(
                self._keeper_command(),
                stdin=its_control.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env=dict[str, str](),
                cwd="/",
                start_new_session=True,  # Ctrl-C is for the grader
            )
        self._folder = self._await_keeper()
        self.folder = Path(f"/proc/{os.getpid()}/fd/{self._folder}")
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._control, selectors.EVENT_READ)
        self._thread = threading.Thread(target=self._listen, name="ros2lab-sandbox", daemon=True)
        self._thread.start()
        if files is not None:
            try:
                self.fill(files)
            except BaseException:
                self.close()
                raise

    def beside(self) -> World:
        """Return a new World like this one, with a network of its own and an empty folder."""
        world = type(self)(shown=self._given, limits=self.limits)
        world.folders = self.folders
        return world

    def fill(self, files: Path, only: str = "") -> None:
        """Copy a folder into this World's, before any box has used it.

        Args:
            files: the folder; its links are copied as links.
            only: the name of the entry to copy; empty copies all.

        Raises:
            ValueError: if it cannot be copied.
        """
        _copy(files, self.folder, only)

    def start(
        self,
        command: Sequence[str | Path],
        *,
        files: Access = "read",
        environ: Mapping[str, str] | None = None,
        cwd: str = "/tmp",  # noqa: S108 -- the box's own
        stdin: int | None = None,
        shown: Iterable[Path] = (),
        limits: Limits | None = None,
        among: str = "",
        neighbours: Neighbours | None = None,
    ) -> Box:
        """Start a program in a box of its own.

        Args:
            command: the program and its arguments.
            files: what the box may do with /submission.
            environ: the environment, added to the defaults in `ENVIRON`; nothing else is set.
            cwd: the working folder, as seen in the box.
            stdin: a file descriptor that the program reads from; None gives it nothing to read.
            shown: the parts of `PACKAGE` that this box can read.
            limits: the box's limits; None takes the World's.
            among: a name for boxes that share /tmp, /dev/shm and home until the World ends.
            neighbours: the programs that its list of processes shows; it has no `stdin` then.

        Raises:
            RuntimeError: if the World has ended.
        """
        limits = limits or self.limits
        if self._folder < 0:
            raise RuntimeError(f"{command[0]} cannot be started, for the World is closed; make another.")
        words = {**ENVIRON, **(environ or {})}
        bell = -1
        if neighbours:
            command, more = neighbours.starting(command)
            words |= more
            stdin, bell = os.pipe()
        start = ["/usr/bin/env", "-i", "-C", cwd, *(f"{name}={value}" for name, value in words.items())]
        folders, links = bubblewrap.writable(self.folders, [*self._shown, *bubblewrap.HIDDEN])
        folders = [HOME, *folders]
        own = [*_own(folders, limits, among), *links]
        arguments = [*self._box_command(files, shown, own), *limits.words(), *start, *map(str, command)]
        if files != "none" and not self._is_handed_over:
            self._is_handed_over = True
            if keeper.is_root():
                _hand_over(self._folder)  # no box is running that could change the folder meanwhile
        number = next(self._numbers)
        box = self._boxes[number] = Box(lambda do: self._ask(do, number), limits.output_bytes)
        box._bell = bell
        box._reading, its_output = os.pipe()
        passed = [its_output] if stdin is None else [its_output, stdin]
        common = {"among": among, "folders": [*OWN, *folders]}
        message = _message("start", number, command=arguments, limits=asdict(limits), **common)
        try:
            # The listener closes it at its end, which comes even if the keeper has gone.
            os.set_blocking(box._reading, False)
            self._selector.register(box._reading, selectors.EVENT_READ, box)
            socket.send_fds(self._control, [message], passed)
        except (OSError, ValueError) as error:
            self._boxes.pop(number, None)
            box.show_neighbours()  # nobody else closes the pipe that they wait for
            if not isinstance(error, OSError) or error.errno != errno.EMSGSIZE:
                raise RuntimeError(
                    f"{command[0]} cannot be started ({error}): the World has ended."
                ) from None
            self._selector.unregister(box._reading)
            os.close(box._reading)
            box._add(b"It cannot be started: the command is too long.\n")
            box._add(b"")
            box._set_end(End(keeper.NOT_STARTED, None, 0.0, True))
        finally:
            os.close(its_output)
            if neighbours and stdin is not None:
                os.close(stdin)
        return box

    def run(
        self,
        command: Sequence[str | Path],
        *,
        files: Access = "read",
        environ: Mapping[str, str] | None = None,
        cwd: str = "/tmp",  # noqa: S108 -- the box's own
        shown: Iterable[Path] = (),
        limits: Limits | None = None,
    ) -> Box:
        """Start a program as `start` does, and wait until it ends or a limit ends it.

        Raises:
            SandboxMissing: if the box could not be made.
            RuntimeError: as for `start`.
        """
        box = self.start(command, files=files, environ=environ, cwd=cwd, shown=shown, limits=limits)
        box.wait()
        return box

    def close(self) -> None:
        """End everything in the World; closing twice does nothing."""
        if self._folder < 0:
            return
        with contextlib.suppress(OSError):  # the keeper may have gone already
            self._control.shutdown(socket.SHUT_WR)
        self._thread.join()
        os.close(self._folder)
        self._folder = -1

    def __enter__(self) -> World:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _keeper_command(self) -> list[str]:
        """Return the command of the World itself, which runs the keeper and has what boxes may be shown."""
        ask = [] if keeper.is_root() else ["--unshare-user"]
        own = ["--bind", "/proc", "/proc", "--dev-bind", "/dev", "/dev"]
        own += ["--dir", "/tmp"]  # noqa: S108 -- bubblewrap works in it
        for folder in (keeper.FILES, keeper.SHARED):
            own += ["--size", str(self.limits.disk_bytes), "--tmpfs", folder]
        own += ["--dir", keeper.FOLDER, "--ro-bind", *keeper.__path__, f"{keeper.FOLDER}/keeper"]
        program = f"import sys; sys.path.append('{keeper.FOLDER}'); from keeper.main import main; main()"
        python = [sys.executable, "-I", "-S", "-B", "-c", program, str(os.getpid())]
        shown = bubblewrap.bound([self._bubblewrap, *sorted({bubblewrap.PACKAGE, *self._shown})])
        shown += bubblewrap.emptied()
        # Setting the sizes of TCP's buffers needs the right to set up the network, which the keeper then
        # gives up.
        settings = [f"echo {sizes} >/proc/sys/net/ipv4/{name}" for name, sizes in keeper.TCP_BUFFERS.items()]
        start = f'{{ {"; ".join(settings)}; }} 2>/dev/null; exec setpriv --ambient-caps -all "$@"'
        ask += ["--unshare-net", "--cap-add", "CAP_NET_ADMIN"]
        return [
            self._bubblewrap,
            *ask,
            *bubblewrap.system(),
            *own,
            *shown,
            "--",
            "sh",
            "-c",
            start,
            "sh",
            *python,
        ]

    def _box_command(self, files: Access, shown: Iterable[Path], places: Iterable[str]) -> list[str]:
        own = ["--unshare-user", "--unshare-pid", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try"]
        own += ["--uid", "1000", "--gid", "1000", "--hostname", "sandbox", "--cap-drop", "ALL"]
        # Nothing may be written in /proc, such as which process Linux kills first when memory is short.
        own += ["--new-session", "--die-with-parent", "--proc", "/proc"]
        for name, (place, _) in keeper.SHOWN.items():
            own += ["--ro-bind", f"{keeper.FOLDER}/{name}", place]
        own += ["--remount-ro", "/proc"]
        # Mappings of /dev/zero are memory that no process shows as its own.
        own += ["--dev", "/dev", "--dev-bind", "/dev/null", "/dev/zero"]
        own += [*places, "--remount-ro", "/dev"]
        # The folders of batteries and sensors are there but empty, as on a machine without any.
        own += itertools.chain(*(("--dir", str(folder)) for folder in sorted(HARDWARE.glob("*"))))
        for name in keeper.SETTINGS:
            own += ["--ro-bind", f"{keeper.FOLDER}/{name}", f"/etc/{name}"]
        if files != "none":
            own += ["--bind" if files == "write" else "--ro-bind", keeper.FILES, FILES]
        own += bubblewrap.hiding(self._shown, shown)
        return [self._bubblewrap, *bubblewrap.system(), *own, "--remount-ro", "/", "--"]

    def _await_keeper(self) -> int:
        """Wait for the keeper, and return a file descriptor of the World's folder."""
        self._control.settimeout(START_TIMEOUT)
        try:
            _, passed, _, _ = socket.recv_fds(self._control, 64, 1)
        except OSError:
            passed = []
        self._control.settimeout(None)
        if passed:
            os.set_inheritable(passed[0], False)
            return passed[0]
        self._popen.kill()
        _, said = self._popen.communicate()
        self._control.close()
        raise SandboxMissing(why(said.decode(errors="replace")))

    def _ask(self, do: str, number: int) -> None:
        with contextlib.suppress(OSError):  # if the World has ended, so has the box
            self._control.send(_message(do, number))

    def _listen(self) -> None:
        """Read the boxes' output and the keeper's messages, until the keeper has gone and all is read."""
        with self._selector, self._control:
            while self._selector.get_map():
                for key, _ in self._selector.select():
                    if isinstance(key.data, Box):
                        self._read(key.data)
                    elif message := self._control.recv(65536):
                        self._take(json.loads(message))
                    else:
                        self._selector.unregister(self._control)
                        self._give_up()

    def _take(self, said: dict[str, Any]) -> None:
        """Take a message of the keeper about a box: that it is held, or how it ended."""
        number = said.pop("box")
        if "stands" in said:
            self._boxes[number]._set_standing()
            return
        box = self._boxes.pop(number)
        while box._is_writing:  # another box may have got hold of its output
            self._read(box, is_last=True)
        box._set_end(End(**said))

    def _read(self, box: Box, *, is_last: bool = False) -> None:
        """Read the output of a box; with `is_last`, treat it as ended if nothing is left to read."""
        if not box._is_writing:  # all has been read since this was asked for
            return
        try:
            part = os.read(box._reading, 65536)
        except BlockingIOError:
            if not is_last:
                return
            part = b""
        if not box._add(part):
            self._selector.unregister(box._reading)
            os.close(box._reading)

    def _give_up(self) -> None:
        """Mark all boxes as ended after the keeper has gone."""
        _, said = self._popen.communicate()
        reason = (said.decode(errors="replace").strip().splitlines() or ["it was killed"])[-1]
        for box in list(self._boxes.values()):
            box._set_end(End(137, None, box.seconds, True, f"The keeper of the sandbox ended ({reason})"))


def _own(folders: Iterable[str], limits: Limits, among: str) -> list[str]:
    """Return bubblewrap's arguments for a box's own /tmp and /dev/shm, or for those that it shares."""
    if among:  # the keeper has made the folders
        return [word for place in OWN for word in ("--bind", f"{keeper.SHARED}/{among}{place}", place)]
    size = ["--size", str(limits.disk_bytes), "--tmpfs"]
    made = (word for folder in folders for word in ("--dir", folder))
    return [*(word for place in OWN for word in (*size, place)), *made]


def _message(do: str, number: int, **more: object) -> bytes:
    return json.dumps({"do": do, "box": number, **more}).encode()


def _copy(files: Path, folder: Path, only: str = "") -> None:
    def left_out(inside: str, names: list[str]) -> list[str]:
        if only and Path(inside) == files:
            return [name for name in names if name != only]
        kinds = {name: stat.S_IFMT(Path(inside, name).lstat().st_mode) for name in names}
        return [
            name for name, kind in kinds.items() if kind not in (stat.S_IFREG, stat.S_IFDIR, stat.S_IFLNK)
        ]

    try:
        shutil.copytree(files, folder, symlinks=True, dirs_exist_ok=True, ignore=left_out)
    except RecursionError:
        raise ValueError("The files cannot be copied into the sandbox: the folders are too deep.") from None
    except shutil.Error as error:
        raise ValueError(_not_copied(str(error.args[0][0][2]))) from None
    except OSError as error:
        raise ValueError(_not_copied(str(error))) from None


def _hand_over(folder: int) -> None:
    """Give everything in the open `folder` to the boxes' user: links themselves, not their targets."""
    for _, folders, files, handle in os.fwalk(".", dir_fd=folder):
        for name in folders + files:
            with contextlib.suppress(FileNotFoundError):  # another box may have removed it
                os.chown(name, keeper.NOBODY, keeper.NOBODY, dir_fd=handle, follow_symlinks=False)


def _not_copied(error: str) -> str:
    """Return a sentence about an error of the system, without the paths that only the grader has."""
    what = error.partition(": '")[0].rpartition("] ")[2]
    return f"The files cannot be copied into the sandbox: {what}."
