"""Watch a submission's programs on the ROS graph: the trusted program that `observe` starts in its own box.

Standard input is a socket to the grader that carries one JSON object per line both ways; nothing that a
program of the submission prints or publishes gets into it. Each run has its own thread and ROS domain.
"""

from __future__ import annotations

import json
import os
import socket
import sys
import threading
from typing import Any

from ros2lab.assignments import Assignment
from ros2lab.grading.watching.conductor import Conductor


def main() -> None:
    """Conduct the runs that the grader asks for, until it closes the socket."""
    assignment = Assignment.of_plain(json.loads(sys.argv[1]))
    grader = socket.socket(fileno=0)
    lock = threading.Lock()

    def say(message: dict[str, Any]) -> None:
        with lock:
            grader.sendall(json.dumps(message).encode() + b"\n")

    runs: dict[int, Conductor] = {}
    with grader.makefile("rb") as lines:
        for line in lines:
            message = json.loads(line)
            if "domain" in message:
                runs[message["run"]] = conductor = Conductor(assignment, message, say)
                threading.Thread(target=conductor.run, name=f"run-{message['run']}", daemon=True).start()
            else:
                runs[message["run"]].tell(message)
    sys.stdout.flush()
    os._exit(0)  # the grader has gone, and with it everything that the threads wait for


if __name__ == "__main__":
    main()
