"""Types of recorded messages: the classes installed here, and how messages are decoded."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from mcap.records import Schema
from mcap.well_known import SchemaEncoding
from mcap_ros2.decoder import DecoderFactory
from rclpy.serialization import deserialize_message

from portable_ros2.bags.definitions import definition_text, same_fields
from portable_ros2.bags.mcap_file import RecordedTopic
from ros2lab.topics import find_type


def installed_type(topic: RecordedTopic) -> type:
    """Return the message class of a recorded topic.

    Raises:
        ValueError: if its type is not installed here, or has other fields here than in the recording.
    """
    message_type = find_type(topic.type_name)
    if topic.encoding == SchemaEncoding.ROS2:
        with contextlib.suppress(LookupError):  # a type without a definition is assumed to be the same
            if not same_fields(topic.definition, definition_text(topic.type_name)):
                raise ValueError(f"{topic.type_name} has other fields here than where it was recorded.")
    return message_type


def decoder(topic: RecordedTopic) -> Callable[[bytes], Any]:
    """Return a function that decodes a message: by the installed type, else by the recording's definition."""
    try:
        message_type = installed_type(topic)
    except ValueError as error:
        schema = Schema(1, topic.definition.encode(), topic.encoding, topic.type_name)
        decoder = DecoderFactory().decoder_for("cdr", schema)
        if decoder is None:
            raise ValueError(f"{topic.name} cannot be read: {error}") from None
        return decoder
    return lambda data: deserialize_message(data, message_type)
