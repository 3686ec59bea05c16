"""Messages as text."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

from portable_ros2.messages import to_csv as message_to_csv
from portable_ros2.messages import to_dict
from portable_ros2.messages import to_yaml as message_to_yaml

__all__ = ["get_message_slot_types", "message_to_csv", "message_to_ordereddict", "message_to_yaml"]


def message_to_ordereddict(message: Any, **limits: Any) -> OrderedDict[str, Any]:
    """Return a message as `portable_ros2.messages.to_dict` does, with its limits."""
    return OrderedDict(to_dict(message, **limits))


def get_message_slot_types(message: Any) -> OrderedDict[str, str]:
    """Return the types of a message's fields by their names."""
    return OrderedDict(message.get_fields_and_field_types())
