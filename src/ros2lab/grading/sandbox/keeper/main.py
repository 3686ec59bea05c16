"""The keeper's program: it keeps the boxes, and does what the grader asks for."""

# ruff: noqa: PTH103, PTH110, PTH123

import json
import os
import select
import socket
import sys
import time
from collections.abc import Mapping

from . import FILES, FOLDER, LIMITS, NOBODY, NOT_STARTED, SETTINGS, SHARED, SHOWN, counted, is_root
from .box import BYTES_PER_OPEN_FILE, Box, started
from .system_calls import system_call_filter

TICK = 0.04  # s between two looks at the boxes
MOMENT = 0.002  # s between two looks while the processes of a box are being stopped
LAST_WAIT = 5.0  # s for the last process of a box to end after bubblewrap


class Keeper:
    """The boxes, and the grader at the other end of `control`."""

    def __init__(self, control: socket.socket, grader: int) -> None:
        self.control = control
        self.grader = os.pidfd_open(grader)
        self.boxes: dict[int, Box] = {}
        self.is_over = False
        self.next_look = 0.0

    def run(self) -> None:
        """Serve until the grader is gone, and leave nothing running."""
        while not self.is_over or self.boxes:
            ready = self.wait()
            if not self.is_over and (
                self.grader in ready or (self.control.fileno() in ready and not self.obey())
            ):
                self.is_over = True
            self.look()
            for box in list(self.boxes.values()):
                box.is_doomed |= self.is_over
                box.act()
                if box.has_come_to_stand():
                    self.tell({"box": box.number, "stands": True})
                if box.ended in ready:
                    self.bury(box)

    def wait(self) -> list[int]:
        """Wait for a box or the grader, or until it is time to look; return the ready descriptors."""
        waiting = [box.ended for box in self.boxes.values()]
        waiting += [box.status for box in self.boxes.values() if not box.init]
        if not self.is_over:
            waiting += [self.control.fileno(), self.grader]
        pause = MOMENT if any(box.is_to_stand for box in self.boxes.values()) else TICK
        return select.select(waiting, [], [], pause if self.boxes else None)[0]

    def look(self) -> None:
        """Compare what the boxes use with their limits, if it is time."""
        if time.monotonic() < self.next_look:
            return
        free, sockets = counted.available(), counted.sockets()
        for box in self.boxes.values():
            box.look(free, sockets, self.adrift)
        self.look_at_all()
        self.next_look = time.monotonic() + TICK

    def look_at_all(self) -> None:
        """End the box that holds most if all boxes together hold too much."""
        boxes = [box for box in self.boxes.values() if not box.is_doomed]
        most = max((box.limits["together_bytes"] for box in boxes), default=0)
        if sum(box.memory + box.slots * BYTES_PER_OPEN_FILE for box in boxes) <= most:
            return
        held = {box: box.memory + box.descriptors() * BYTES_PER_OPEN_FILE for box in boxes}
        if sum(held.values()) > most:
            largest = max(held, key=held.__getitem__)
            largest.cut = LIMITS["together"].format(most / 1e6)
            largest.is_doomed = True

    def adrift(self) -> int:
        """Return the bytes of memory in the World that no process of a box holds any more."""
        held = sum(box.descriptors() for box in self.boxes.values())
        return max(0, counted.sockets() - held) * BYTES_PER_OPEN_FILE

    def obey(self) -> bool:
        """Do what a message asks for; return False if no more will come."""
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
            share(message["among"], message["folders"])
            self.start(number, message["command"], passed, message["limits"])
        elif box := self.boxes.get(number):
            box.is_interrupted |= message["do"] == "interrupt"
            box.is_doomed |= message["do"] == "kill"
            box.is_to_stand |= message["do"] == "hold"
            if message["do"] == "release":
                box.release()
        return True

    def start(self, number: int, command: list[str], passed: list[int], limits: dict[str, float]) -> None:
        """Start a box; if that fails, as with a zero byte in its command, write the reason to its output."""
        output, *_ = passed
        try:
            self.boxes[number] = started(number, command, passed, limits)
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
        """Remove a box that has ended, and tell the grader how it ended."""
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
            # bubblewrap reports an exit code only for a program that it started, which a signal may prevent.
            "was_made": b"exit-code" in box.told or box.is_doomed or box.was_interrupted,
        }
        self.tell(end)


def share(among: str, folders: list[str]) -> None:
    """Make the folders that boxes share, before the first box can put anything in their place."""
    if among and not os.path.exists(f"{SHARED}/{among}"):
        for folder in folders:
            os.makedirs(f"{SHARED}/{among}{folder}", exist_ok=True)


def main() -> None:
    """Prepare what boxes share, and keep them; `argv[1]` is the grader's process, stdin its socket."""
    control = socket.socket(fileno=0)
    _prepare()
    keeper = Keeper(control, int(sys.argv[1]))
    files = os.open(FILES, os.O_PATH)
    socket.send_fds(control, [b"ready"], [files])
    os.close(files)
    keeper.run()


def _prepare() -> None:
    """Write the files that are bound into every box, and stop being root."""
    os.umask(0o022)  # others read these files, and those that programs in boxes make
    for name, text in {**SETTINGS, **{name: text for name, (_, text) in SHOWN.items()}}.items():
        with open(f"{FOLDER}/{name}", "w", encoding="ascii") as file:
            file.write(text)
    with open(f"{FOLDER}/filter", "wb") as program:
        program.write(system_call_filter())
    if is_root():
        # Linux does not apply the limit on processes to root.
        for folder in (FILES, SHARED):
            os.chown(folder, NOBODY, NOBODY)
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
