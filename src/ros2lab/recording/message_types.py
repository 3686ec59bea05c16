"""Types of recorded messages: their definitions, the classes installed here, and how messages are decoded."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from mcap.records import Schema
from mcap.well_known import SchemaEncoding
from mcap_ros2.decoder import DecoderFactory
from rclpy.serialization import deserialize_message

from portable_ros2 import interfaces
from ros2lab.recording.mcap_file import RecordedTopic
from ros2lab.topics import find_type

_SEPARATOR = "=" * 80


def definition_text(type_name: str) -> str:
    """Return the definition of a message type, followed by those of all types in it, each once.

    Args:
        type_name: such as `geometry_msgs/msg/Twist`.

    Raises:
        LookupError: if the definition of one of them is not installed.
    """
    texts: dict[str, str] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop(0)
        if name not in texts:
            lines = list(interfaces.definition(name))
            texts[name] = "\n".join(line.text for line in lines)
            waiting += [line.nested for line in lines if line.nested]
    root, *nested = texts
    parts = [texts[root], *(f"{_SEPARATOR}\nMSG: {_short(name)}\n{texts[name]}" for name in nested)]
    return "\n".join(parts) + "\n"


def same_fields(definition: str, other: str) -> bool:
    """Return whether messages of two definitions are serialised alike: comments and constants may differ."""
    return _fields(definition) == _fields(other)


def installed_type(topic: RecordedTopic) -> type:
    """Return the message class of a recorded topic.

    Raises:
        ValueError: if its type is not installed here, or has other fields than where it was recorded.
    """
    message_type = find_type(topic.type_name)
    if topic.encoding == SchemaEncoding.ROS2:
        with contextlib.suppress(LookupError):  # a type without its definition is taken to be the same
            if not same_fields(topic.definition, definition_text(topic.type_name)):
                raise ValueError(f"{topic.type_name} has other fields here than where it was recorded.")
    return message_type


def decoder(topic: RecordedTopic) -> Callable[[bytes], Any]:
    """Return what makes a message of bytes: of the type installed here, else as the recording defines it."""
    try:
        message_type = installed_type(topic)
    except ValueError as error:
        schema = Schema(1, topic.definition.encode(), topic.encoding, topic.type_name)
        decoder = DecoderFactory().decoder_for("cdr", schema)
        if decoder is None:
            raise ValueError(f"{topic.name} cannot be read: {error}") from None
        return decoder
    return lambda data: deserialize_message(data, message_type)


def _short(name: str) -> str:
    """Return `package/Name` of `package/msg/Name`, as MCAP names the nested types."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest.rpartition('/')[2]}"


def _fields(definition: str) -> dict[str, list[list[str]]]:
    """Return the words of each field of a definition, by the type in which it is; the outermost one is ''."""
    fields: dict[str, list[list[str]]] = {"": []}
    name = ""
    for line in definition.splitlines():
        code = line.partition("#")[0].strip()
        if code.startswith("MSG:"):
            name = _short(code.removeprefix("MSG:").strip())
            fields[name] = []
        elif code and "=" not in code:
            fields[name].append(code.split())
    return fields
