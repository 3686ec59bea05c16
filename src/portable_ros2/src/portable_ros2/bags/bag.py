"""A bag: a folder with a recording and what it holds, as rosbag2 has it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from portable_ros2 import bounded_yaml
from portable_ros2.bags.mcap_file import RecordedMessage, RecordedTopic, RecordingFile

METADATA = "metadata.yaml"
STORAGE = "mcap"
VERSION = 9  # of the metadata, as Jazzy writes it
LONGEST = 1_000_000  # characters of the metadata: those of a thousand topics


@dataclass(frozen=True)
class Bag:
    """A recording of one or more files, one after the other.

    Attributes:
        files: the files.
        names: what they are called in the folder.
        distro: the distribution of ROS that has recorded it, `unknown` if that is not told.
    """

    files: Sequence[RecordingFile]
    names: Sequence[str]
    distro: str

    @property
    def topics(self) -> dict[str, RecordedTopic]:
        """What it says of its topics, by name; the counts are those of all files."""
        found: dict[str, RecordedTopic] = {}
        for file in self.files:
            for name, topic in file.topics.items():
                count = found[name].count if name in found else 0
                found[name] = RecordedTopic(**{**vars(topic), "count": topic.count + count})
        return found

    @property
    def size(self) -> int:
        """Its size in bytes."""
        return sum(file.size for file in self.files)

    @property
    def began(self) -> int:
        """When the first message was received, in ns since 1970; 0 if there is none."""
        return min((file.began for file in self.files if file.began), default=0)

    @property
    def ended(self) -> int:
        """When the last message was received, in ns since 1970; 0 if there is none."""
        return max((file.ended for file in self.files), default=0)

    def messages(self, topics: Sequence[str], since: int = 0) -> Iterator[RecordedMessage]:
        """Yield the messages of some topics that were received at a time or later, in ns since 1970.

        Raises:
            RuntimeError: if a file is damaged.
        """
        for file in self.files:
            try:
                yield from file.messages(topics, since)
            except Exception as error:  # whatever a damaged file makes its reader raise
                raise RuntimeError(f"{file.shown} cannot be read on: {error}") from error


def open_bag(path: Path) -> Bag:
    """Return what lies in a folder, or in one file.

    Raises:
        RuntimeError: if it is not a recording in MCAP, or cannot be read.
    """
    try:
        metadata = _metadata(path)
        names = metadata.get("relative_file_paths") or sorted(file.name for file in path.glob("*.mcap"))
        if path.is_file():
            names, folder = [path.name], path.parent
        else:
            folder = path
        storage = metadata.get("storage_identifier", STORAGE)
        if storage != STORAGE:
            raise RuntimeError(
                f"The bag '{path}' is stored as {storage}, and only {STORAGE} can be read here; where the real "
                "ros2 bag is, `ros2 bag convert` makes one of the other."
            )
        if not names:
            raise RuntimeError(
                f"The folder '{path}' is no bag: there is no {METADATA} and no .mcap file in it."
            )
        files = [RecordingFile(folder / name, name) for name in names]
    except RuntimeError:
        raise
    except Exception as error:  # as above
        raise RuntimeError(f"The bag '{path}' cannot be read: {error}") from error
    return Bag(files, names, str(metadata.get("ros_distro") or "unknown"))


def write_metadata(
    folder: Path, file: RecordingFile, offers: Mapping[str, str], hashes: Mapping[str, str], distro: str
) -> None:
    """Write what a folder with one file holds, as rosbag2 does.

    Args:
        folder: the folder.
        file: the file in it.
        offers: of each topic, the qualities of service that its publishers offered, as YAML.
        hashes: of each topic, the hash of its type.
        distro: the distribution of ROS.
    """
    import yaml

    count = sum(topic.count for topic in file.topics.values())
    began = {"nanoseconds_since_epoch": file.began}
    duration = {"nanoseconds": file.ended - file.began}
    topics = [
        {
            "topic_metadata": {
                "name": topic.name,
                "type": topic.type_name,
                "serialization_format": "cdr",
                "offered_qos_profiles": yaml.safe_load(offers.get(topic.name, "")) or [],
                "type_description_hash": hashes.get(topic.name, ""),
            },
            "message_count": topic.count,
        }
        for topic in file.topics.values()
    ]
    contents = {
        "version": VERSION,
        "storage_identifier": STORAGE,
        "duration": duration,
        "starting_time": began,
        "message_count": count,
        "topics_with_message_count": topics,
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.path.name],
        "files": [
            {
                "path": file.path.name,
                "starting_time": dict(began),  # a copy, or YAML would refer to the other one
                "duration": dict(duration),
                "message_count": count,
            }
        ],
        "custom_data": None,
        "ros_distro": distro,
    }
    text = yaml.safe_dump({"rosbag2_bagfile_information": contents}, sort_keys=False)
    (folder / METADATA).write_text(text, encoding="utf-8")


def _metadata(path: Path) -> Mapping[str, Any]:
    """Return what a folder says of itself; empty if it says nothing.

    Raises:
        ValueError: if it is not YAML.
    """
    import yaml

    file = path / METADATA
    if not file.is_file():
        return {}
    with file.open(encoding="utf-8") as stream:
        text = stream.read(LONGEST + 1)
    try:
        contents = bounded_yaml.load(text, yaml.SafeLoader, has_aliases=False, longest=LONGEST)
    except yaml.YAMLError as error:
        raise ValueError(f"{METADATA} is not YAML: {error}") from error
    found = contents.get("rosbag2_bagfile_information") if isinstance(contents, dict) else None
    return found if isinstance(found, dict) else {}
