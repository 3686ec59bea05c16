"""Recordings of topics: made in the background, replayed, and read for a plot.

The files are MCAP, which `ros2 bag` and Foxglove open, too. Modules import only from those above them:

- `tables`, `qos`, `matching`, `mcap_file`: text, policies, waiting and the file format, each by itself
- `message_types`, `files`: the types of a file's messages, and where a student's files are
- `track`; then `subscriptions`, `buffer`: a topic while it is recorded, and its messages on their way to disk
- `recorder`, `replay`, `read`: what a notebook uses
"""

from ros2lab.recording.read import RecordedSample, Recording, read_recording
from ros2lab.recording.recorder import Recorder
from ros2lab.recording.replay import Replay

__all__ = ["RecordedSample", "Recorder", "Recording", "Replay", "read_recording"]
