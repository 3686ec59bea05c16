"""Messages from values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from portable_ros2.messages import StampSetter, fill


def set_message_fields(
    msg: Any, values: Mapping[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[StampSetter]:
    """Set the fields of a message as `portable_ros2.messages.fill` does, which always expands `auto` and `now`."""
    del expand_header_auto, expand_time_now
    return fill(msg, values)
