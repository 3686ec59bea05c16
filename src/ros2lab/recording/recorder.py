"""Topics, recorded in the background.

A recorder takes messages as serialised bytes in a thread of its own, so that slow callbacks do not hold it up
and the ROS thread has no work with it; another thread writes them to disk.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from portable_ros2.bags.mcap_file import RecordingWriter
from ros2lab import course
from ros2lab.interrupts import interrupted_says
from ros2lab.recording.files import new_file
from ros2lab.recording.subscriptions import Subscriptions, Track
from ros2lab.recording.tables import counted, html_table, text_table

if TYPE_CHECKING:
    from rclpy.node import Node


INTAKE_THREAD, WRITER_THREAD = "ros2lab-recorder-intake", "ros2lab-recorder-writer"
TAKE_PERIOD = 0.05  # s, in which ROS queues up to QUEUE_DEPTH messages per topic
WRITE_PERIOD = 0.1  # s
LAST_WAIT = 0.1  # s, for a message that is on its way when the recording ends
LOOK_PERIOD = 0.2  # s between looks for new topics, for which rclpy has no event
FLUSH_PERIOD = 1.0  # s, the most that is lost if the process is killed
STOP_TIMEOUT = 10.0  # s
MOST_WAITING = 64 * 2**20  # bytes that wait for the disk


class Recorder:
    """Records topics into an MCAP file until it is stopped, or the session ends.

    Made by `LabSession.record`. An existing file of the same name is kept in `~/earlier`. Topics that appear
    later are recorded from then on; hidden ones only if they are named.

    Args:
        node: the node that subscribes.
        path: the file.
        topics: the topics to record; None takes all.
        most_waiting: how many bytes may wait for the disk; messages beyond that are dropped and counted.

    Raises:
        ValueError: if the path is a folder.
        OSError: if the file cannot be written.
    """

    def __init__(
        self,
        node: Node,
        path: Path,
        topics: Collection[str] | None = None,
        *,
        most_waiting: int = MOST_WAITING,
    ) -> None:
        self.path = path
        self._subscriptions = Subscriptions(node, topics)
        self._buffer = Buffer(most_waiting)
        self._tracks = self._subscriptions.tracks
        self._failure = ""
        self._stop_asked = threading.Event()
        self._is_taken_in = False
        self._is_told = False
        self._began = time.monotonic()
        self._ended: float | None = None
        self._stream = new_file(path)
        self._writer = RecordingWriter(self._stream, library="ros2lab")
        self._intake = threading.Thread(target=self._run_intake, name=INTAKE_THREAD, daemon=True)
        self._thread = threading.Thread(target=self._run_writer, name=WRITER_THREAD, daemon=True)
        try:
            self._subscriptions.look()
            self._subscriptions.wait_for_match()
        except BaseException:  # also an interrupt
            self._stop_asked.set()
            raise
        finally:
            self._intake.start()
            self._thread.start()

    @property
    def counts(self) -> dict[str, int]:
        """The number of messages written, by topic."""
        return {topic: track.count for topic, track in list(self._tracks.items())}

    @property
    def count(self) -> int:
        """The number of messages written."""
        return sum(self.counts.values())

    @property
    def dropped(self) -> int:
        """The number of messages dropped because they came faster than they could be written."""
        return self._buffer.dropped

    @property
    def missed(self) -> int:
        """The number of messages that never came, by the sequence numbers of a topic's only publisher."""
        return sum(track.missed for track in list(self._tracks.values()))

    @property
    def duration(self) -> float:
        """How long it has recorded, in s."""
        return (self._ended or time.monotonic()) - self._began

    @property
    def is_recording(self) -> bool:
        """Whether it is still recording."""
        return not self._stop_asked.is_set()

    @property
    def failure(self) -> str:
        """Why the recording ended early; empty if it did not."""
        return self._failure

    @property
    def problems(self) -> list[str]:
        """Sentences that say what is not in the file, and why."""
        problems = [self._failure] if self._failure else []
        problems += self._subscriptions.left_out.values()
        if self.dropped:
            problems.append(
                f"{counted(self.dropped, 'message')} came faster than they could be written, and "
                f"{'is' if self.dropped == 1 else 'are'} not in the file; record fewer topics."
            )
        if self.missed:
            problems.append(
                f"{counted(self.missed, 'message')} did not reach the recorder: "
                "a best-effort publisher, or more than this computer can take."
            )
        return problems

    def stop(self) -> None:
        """End the recording and the file, and print what is missing in it. Stopping twice does no harm."""
        self._stop_asked.set()
        with interrupted_says(f"{course.shown_path(self.path)} is finished in the background."):
            self._thread.join(STOP_TIMEOUT)
        if not self._is_told:
            self._is_told = True
            name = course.shown_path(self.path)
            sys.stdout.write("".join(f"{name}: {problem}\n" for problem in self.problems))

    def _run_intake(self) -> None:
        try:
            self._take_in()
        except Exception as error:  # whatever it was, it must be reported and the file ended
            self._fail(error)
        finally:
            self._subscriptions.close()
            self._is_taken_in = True
            self._buffer.wake.set()

    def _take_in(self) -> None:
        looked = time.monotonic()
        while not self._stop_asked.wait(TAKE_PERIOD):
            self._take_messages()
            if time.monotonic() - looked >= LOOK_PERIOD:
                looked = time.monotonic()
                self._subscriptions.look()
        # What was published before the end may be on its way, and its topic not even known.
        self._subscriptions.look()
        self._subscriptions.wait_for_match()
        time.sleep(LAST_WAIT)
        self._take_messages()

    def _take_messages(self) -> None:
        for track, data, info in self._subscriptions.messages():
            self._buffer.put(track, data, info)

    def _run_writer(self) -> None:
        try:
            self._write_out()
        except Exception as error:  # as above
            self._fail(error)
        finally:
            self._stop_asked.set()
            with contextlib.suppress(OSError):
                self._stream.close()
            self._ended = time.monotonic()

    def _write_out(self) -> None:
        flushed = time.monotonic()
        while not self._is_taken_in:
            self._buffer.wait(WRITE_PERIOD)
            self._write()
            if time.monotonic() - flushed >= FLUSH_PERIOD:
                flushed = time.monotonic()
                self._writer.flush()
        self._write()
        for track in self._tracks.values():
            self._channel(track)  # the file lists a topic even if it had no messages
        self._writer.finish()

    def _write(self) -> None:
        items = self._buffer.take()
        items.sort(key=lambda item: item[2]["received_timestamp"])
        for track, data, info in items:
            published = info["source_timestamp"]
            self._writer.add(
                self._channel(track),
                data,
                received=info["received_timestamp"] or published,
                published=published,
                sequence=info["publication_sequence_number"] or 0,
            )
            track.count += 1

    def _channel(self, track: Track) -> int:
        if not track.channel:
            track.channel = self._writer.add_topic(
                track.topic,
                track.type_name,
                track.definition,
                offered_qos=track.offered_qos,
                type_hash=track.type_hash,
            )
        return track.channel

    def _fail(self, error: Exception) -> None:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        self._failure = f"The recording ended early: {reason}."
        self._stop_asked.set()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _rows(self) -> list[tuple[str, str, str]]:
        tracks = list(self._tracks.items())
        return sorted((topic, track.type_name, str(track.count)) for topic, track in tracks)

    @property
    def headline(self) -> str:
        """What was recorded so far, in one line."""
        doing = "recording" if self.is_recording else "recorded"
        numbers = f"{counted(self.count, 'message')}, {self.duration:.1f} s"
        return " ".join([f"{course.shown_path(self.path)}: {doing}, {numbers}.", *self.problems])

    def __repr__(self) -> str:
        state = "recording" if self.is_recording else "stopped"
        return f"Recorder({course.shown_path(self.path)!r}, {state}, {counted(self.count, 'message')})"

    def __str__(self) -> str:
        return text_table(self.headline, self._rows())

    def _repr_html_(self) -> str:
        return html_table(self.headline, self._rows())


class Buffer:
    """Messages that were received and are not yet written, up to a number of bytes."""

    def __init__(self, most: int) -> None:
        self.dropped = 0
        self.wake = threading.Event()
        self._most = most
        self._lock = threading.Lock()
        self._bytes = 0
        self._items: list[tuple[Track, bytes, dict[str, Any]]] = []

    def put(self, track: Track, data: bytes, info: dict[str, Any]) -> None:
        """Add a message; if there is no space for it, it is dropped and counted."""
        with self._lock:
            if self._bytes + len(data) > self._most:
                self.dropped += 1
                return
            self._bytes += len(data)
            self._items.append((track, data, info))
        if 2 * self._bytes > self._most:
            self.wake.set()

    def take(self) -> list[tuple[Track, bytes, dict[str, Any]]]:
        """Remove and return all messages, in the order in which they were added."""
        with self._lock:
            items, self._items, self._bytes = self._items, [], 0
        return items

    def wait(self, timeout: float) -> None:
        """Wait until the buffer is half full, or the time is up."""
        self.wake.wait(timeout)
        self.wake.clear()
