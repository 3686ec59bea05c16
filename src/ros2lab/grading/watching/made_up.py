"""Messages of made-up contents: plausible, and others each time.

Each field goes through all of its values before one comes again, in an order of its own.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Collection, Sequence
from typing import Any

from portable_ros2.messages import FLOAT_MAX, fields_of
from ros2lab.message_schema import TIME_TYPE, integer_range
from ros2lab.message_tree import type_text
from ros2lab.topics import find_type, type_name

NUMBERS = (1.0, 0.5, 0.0, -0.5, 2.0, -1.0, 0.1, 10.0)
TAME = 2.0  # no larger number is an odd index, or a great speed
WORD = "word"
BANDS = 12  # of a sequence of numbers, each with a value of its own; a sequence has as many items
FEW = 3  # items of a sequence inside of another
# What fits the other fields of a type, or what the field is by its definition: from the least to the greatest.
_LIMITS: dict[str, tuple[float, float]] = {
    "Duration.sec": (0, 2),
    "Duration.nanosec": (0, 0),
    "MultiArrayLayout.data_offset": (0, 0),
    "LaserScan.angle_min": (-math.pi, -math.pi),
    "LaserScan.angle_max": (math.pi * 179 / 180, math.pi * 179 / 180),
    "LaserScan.angle_increment": (math.pi / 180, math.pi / 180),
    "LaserScan.time_increment": (0.0, 0.0),
    "LaserScan.scan_time": (0.1, 0.1),
    "LaserScan.range_min": (0.05, 0.05),
    "LaserScan.range_max": (10.0, 10.0),
    "LaserScan.ranges": (0.1, 9.5),
    "LaserScan.intensities": (0.0, 255.0),
    "Range.field_of_view": (0.5, 0.5),
    "Range.min_range": (0.02, 0.02),
    "Range.max_range": (4.0, 4.0),
    "Range.range": (0.05, 3.9),
    "BatteryState.percentage": (0.0, 1.0),
    "BatteryState.voltage": (0.5, 24.0),
    "BatteryState.power_supply_status": (0, 4),
    "Joy.axes": (-1.0, 1.0),
    "Joy.buttons": (0, 1),
    "NavSatFix.latitude": (-90.0, 90.0),
    "NavSatFix.longitude": (-180.0, 180.0),
    "RelativeHumidity.relative_humidity": (0.0, 1.0),
    "Illuminance.illuminance": (0.0, 1000.0),
    "Image.height": (48, 48),
    "Image.width": (64, 64),
    "Image.step": (192, 192),
    "Image.is_bigendian": (0, 0),
    "Image.data": (0, 255),
    "MapMetaData.resolution": (0.05, 0.05),
    "MapMetaData.width": (20, 20),
    "MapMetaData.height": (20, 20),
    "OccupancyGrid.data": (-1, 100),
}
_SIZES = {
    "LaserScan.ranges": 360,
    "LaserScan.intensities": 360,
    "Image.data": 48 * 192,
    "OccupancyGrid.data": 400,
}
_TEXTS = {"Header.frame_id": "base_link", "Image.encoding": "rgb8"}


class Filler:
    """Fills messages.

    Args:
        now: returns the present time, as a message.
        words: the texts that the code compares with.
        numbers: the numbers in the code, at which and around which something may change.
    """

    def __init__(
        self, now: Callable[[], Any], words: Collection[str] = (), numbers: Collection[float] = ()
    ) -> None:
        self._now = now
        self._words = [*words, WORD]
        self._numbers = [
            *dict.fromkeys((*NUMBERS, *(near for number in numbers for near in _around(number))))
        ]

    def fill(self, message: Any, turn: int, where: str = "") -> Any:
        """Fill all fields of a message and return it.

        Args:
            message: a message, a request or a response.
            turn: how many were filled before.
            where: the path of the field that it is, so that no two fields go together.
        """
        name = type_name(type(message)).rpartition("/")[2]
        for field, kind in fields_of(message):
            setattr(message, field, self._value(kind, f"{name}.{field}", f"{where}.{field}", turn))
        if name == "Quaternion":  # a turn about the vertical axis
            half = _picked(where, (0.0, 0.4, -0.4, 0.8, -0.8, 1.5), turn)
            message.x, message.y, message.z, message.w = 0.0, 0.0, math.sin(half), math.cos(half)
        return message

    def _value(self, kind: Any, field: str, where: str, turn: int) -> Any:
        """Return a value for a field.

        Args:
            kind: its type, of `rosidl_parser.definition`.
            field: the short name of the message with that of the field.
            where: its path.
            turn: how many messages were filled before.
        """
        if hasattr(kind, "value_type"):
            return self._items(kind, field, where, turn)
        if hasattr(kind, "namespaces"):
            kind_name = "/".join(kind.namespaced_name())
            return (
                self._now()
                if type_text(kind) == TIME_TYPE
                else self.fill(find_type(kind_name)(), turn, where)
            )
        typename = getattr(kind, "typename", "")
        if not typename:
            text = _TEXTS.get(field) or _picked(where, self._words, turn)
            return text[: getattr(kind, "maximum_size", None)]
        if typename == "boolean":
            return _picked(where, (True, False), turn)
        value = _picked(where, self._choices(typename, field), turn)
        return bytes([value]) if typename == "octet" else value

    def _items(self, kind: Any, field: str, where: str, turn: int) -> Any:
        """Return a sequence: in every other message of equal items, so that also the least is large now and then."""
        is_deep = hasattr(kind.value_type, "namespaces") and where.count(".") > 1
        size = getattr(kind, "size", None) or _SIZES.get(field, FEW if is_deep else BANDS)
        size = min(size, getattr(kind, "maximum_size", None) or size)
        if field.endswith("covariance"):
            side = math.isqrt(size)
            return [0.01 * (number % (side + 1) == 0) for number in range(size)]
        typename = getattr(kind.value_type, "typename", "")
        if not typename:
            items = (
                self._value(kind.value_type, field, f"{where}[{number}]", turn) for number in range(size)
            )
            return [f"{item}_{n}" if isinstance(item, str) else item for n, item in enumerate(items)]
        width = math.ceil(size / BANDS)
        bands = [
            self._value(kind.value_type, field, f"{where}[{number if turn % 2 else 0}]", turn)
            for number in range(math.ceil(size / width))
        ]
        return [bands[number // width] for number in range(size)]

    def _choices(self, typename: str, field: str) -> Sequence[Any]:
        """Return the numbers for a field: within its limits, which are among them."""
        low, high = _LIMITS.get(field, (-math.inf, math.inf))
        if typename in FLOAT_MAX:
            limits = [float(limit) for limit in (low, high) if math.isfinite(limit)]
            return [*dict.fromkeys((*limits, *(float(n) for n in self._numbers if low <= n <= high)))]
        least, most = integer_range(typename)
        low, high = max(low, least), min(high, most)
        limits = [limit for limit in _LIMITS.get(field, ()) if low <= limit <= high]
        return [*dict.fromkeys(int(number) for number in (*limits, *self._numbers) if low <= number <= high)]


def _around(number: float) -> tuple[float, ...]:
    """Return a number, one below it and some above it."""
    step = 1 if isinstance(number, int) or abs(number) >= 1 else abs(number) / 2
    return number - step, number, number + step, 2 * number


def _picked(where: str, choices: Sequence[Any], turn: int) -> Any:
    """Return one of some values: in as many turns as there are values each of them, in another order each time.

    The numbers at which code may fail, 0 and large ones, come last, so that it shows before what it does.
    """
    lap, at = divmod(turn, len(choices))
    mixed = random.Random(f"{where} {lap}").sample(choices, len(choices))  # noqa: S311 -- no secret
    return sorted(mixed, key=lambda value: isinstance(value, (int, float)) and not _is_tame(value))[at]


def _is_tame(value: float) -> bool:
    return isinstance(value, bool) or 0 < abs(value) <= TAME
