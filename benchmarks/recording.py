"""What recording costs: the processor time of a session that records three topics at 10 Hz, or one at 1 kHz.

Beside it the same session without a recorder, and with a `TopicLog`, which makes messages of the bytes.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import psutil

from ros2lab import environment
from ros2lab.recording.recorder import INTAKE_THREAD, WRITER_THREAD
from ros2lab.session import LabSession
from ros2lab.session_resources import THREAD_NAME

SECONDS = 15.0
PUBLISHER = """
import sys, rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("load")
for number in range(int(sys.argv[1])):
    publisher = node.create_publisher(Twist, f"/topic_{number}", 1000)
    node.create_timer(1 / float(sys.argv[2]), lambda publisher=publisher: publisher.publish(Twist()))
rclpy.spin(node)
"""


def main() -> None:
    """Measure, and print a table."""
    with tempfile.TemporaryDirectory() as work:
        os.environ["ROS2LAB_WORK"] = work
        print(
            f"{'load':<18}{'who listens':<12}{'received':>9}{'process':>9}{'ROS':>8}{'intake':>8}{'writer':>8}{'lost':>6}"
        )
        for topics, rate in ((3, 10), (1, 1000)):
            for listener in ("nobody", "TopicLog", "Recorder"):
                print_load(topics, rate, listener)


def print_load(topics: int, rate: int, listener: str) -> None:
    """Print what a listener costs, in percent of a core: of the process and its threads."""
    with LabSession(domain_id=environment.own_domain("benchmark")) as session:
        load = subprocess.Popen(
            [sys.executable, "-c", PUBLISHER, str(topics), str(rate)],
            env={**environment.lab_environment(), "ROS_DOMAIN_ID": str(session.domain_id)},
            stderr=subprocess.DEVNULL,
        )
        names = [f"/topic_{number}" for number in range(topics)]
        while not all(session.node.count_publishers(name) for name in names):
            time.sleep(0.01)
        recorder = session.record("load.mcap", names) if listener == "Recorder" else None
        logs = [session.log(name) for name in names] if listener == "TopicLog" else []
        time.sleep(2.0)
        first, began, received = cpu(), time.monotonic(), heard(recorder, logs)
        time.sleep(SECONDS)
        seconds = time.monotonic() - began
        used = {name: 100 * (now - first.get(name, 0.0)) / seconds for name, now in cpu().items()}
        received = heard(recorder, logs) - received
        load.terminate()
        load.wait()
        lost = recorder.dropped + recorder.missed if recorder else 0
        print(
            f"{topics} at {rate:>4} Hz".ljust(18)
            + f"{listener:<12}{received:>9}{used['process']:>8.1f}%{used.get(THREAD_NAME, 0):>7.1f}%"
            + f"{used.get(INTAKE_THREAD, 0):>7.1f}%{used.get(WRITER_THREAD, 0):>7.1f}%{lost:>6}"
        )
        if recorder:
            recorder.stop()
            size = Path(recorder.path).stat().st_size
            print(f"{'':<18}{size / max(1, recorder.count):.0f} bytes a message on disk")


def heard(recorder: object, logs: list[object]) -> int:
    """Return how many messages came."""
    return sum(getattr(one, "count", 0) for one in (recorder, *logs))


def cpu() -> dict[str, float]:
    """Return the processor time of this process and of its named threads, in s."""
    process = psutil.Process()
    times = {thread.id: thread.user_time + thread.system_time for thread in process.threads()}
    named = {thread.name: times.get(thread.native_id or 0, 0.0) for thread in threading.enumerate()}
    return {**named, "process": sum(process.cpu_times()[:2])}


if __name__ == "__main__":
    main()
