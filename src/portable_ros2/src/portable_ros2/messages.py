"""Messages: found by the name of their type, shown as text, filled from text.

Nothing here needs rclpy; a message class tells its fields by itself (`get_fields_and_field_types`, `SLOT_TYPES`).
Formats are those of `ros2 topic echo` and `ros2 topic pub` in Jazzy.
"""

from __future__ import annotations

import array
import difflib
import functools
import itertools
import math
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from portable_ros2 import ament_index, interfaces

INTERFACES = "rosidl_interfaces"  # the ament resource that lists what a package brings
YAML_LINE_BREAKS = frozenset("\n\r\x85\u2028\u2029")
FLOAT_MAX = {"float": 3.402823466e38, "double": sys.float_info.max}

StampSetter = Callable[[Any], None]


class TypeNotFoundError(RuntimeError):
    """No such type can be used; the text says what is missing.

    Args:
        subject: what the sentence is about, such as "The passed message type is invalid".
        reason: what is missing.
    """

    def __init__(self, subject: str, reason: str) -> None:
        super().__init__(f"{subject}: {reason}")
        self.reason = reason


class FieldError(RuntimeError):
    """A value does not fit its field, or there is no such field; the text says which and what would fit."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"Failed to populate field: {reason}")


# --- Types by name --------------------------------------------------------------------------------------------


def find_message(name: str, subject: str = "The passed message type is invalid") -> type[Any]:
    """Return the class of a message type, named `std_msgs/msg/String` or `std_msgs/String`.

    Raises:
        TypeNotFoundError: if there is none, or it cannot be loaded.
    """
    return _find(name, "msg", subject, "SLOT_TYPES")


def find_service(name: str, subject: str = "The passed service type is invalid") -> type[Any]:
    """Return the class of a service type, named `std_srvs/srv/Trigger` or `std_srvs/Trigger`.

    Raises:
        TypeNotFoundError: if there is none, or it cannot be loaded.
    """
    return _find(name, "srv", subject, "Request")


def find_action(name: str, subject: str = "The passed action type is invalid") -> type[Any]:
    """Return the class of an action type, named `pkg/action/Name` or `pkg/Name`.

    Raises:
        TypeNotFoundError: if there is none, or it cannot be loaded.
    """
    return _find(name, "action", subject, "Goal")


def message_names() -> list[str]:
    """Return the names of all message types that are installed, as `std_msgs/msg/String`."""
    names = set()
    for package in ament_index.resources(INTERFACES):
        for line in (ament_index.resource(INTERFACES, package) or "").splitlines():
            if match := re.fullmatch(r"(msg/[A-Za-z0-9]+)\.(msg|idl)", line.strip()):
                names.add(f"{package}/{match[1]}")
    return sorted(names)


def _find(name: str, default_kind: str, subject: str, mark: str) -> type[Any]:
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, default_kind)
    if len(parts) != 3 or not all(part.isidentifier() for part in parts):
        raise TypeNotFoundError(subject, f"'{name}' is not of the form package/{default_kind}/Name")
    package, kind, short_name = parts
    try:
        found = _load(package, kind, short_name)
    except Exception as error:
        raise TypeNotFoundError(subject, _missing(package, kind, short_name, error)) from error
    if not hasattr(found, mark):
        raise TypeNotFoundError(subject, f"'{name}' is not of the kind package/{default_kind}/Name")
    return found


def _load(package: str, kind: str, name: str) -> type[Any]:
    """Import an interface and its compiled half.

    The latter's absence would otherwise be noticed only when a publisher is made.
    """
    module = interfaces.module(package, kind)
    action, _, part = name.rpartition("_")
    found: type[Any] = (
        getattr(module, action).Impl.FeedbackMessage if part == "FeedbackMessage" else getattr(module, name)
    )
    metaclass: Any = type(found)
    if hasattr(metaclass, "__import_type_support__") and metaclass._TYPE_SUPPORT is None:
        metaclass.__import_type_support__()
        if metaclass._TYPE_SUPPORT is None:
            raise ImportError("its compiled library cannot be loaded")
    return found


def _missing(package: str, kind: str, name: str, error: Exception) -> str:
    """Tell what is missing when a type could not be loaded."""
    if isinstance(error, ModuleNotFoundError) and error.name == package:
        packages = ament_index.resources(INTERFACES)
        return f"there is no package '{package}'{_similar(package, packages)} (is its workspace sourced?)"
    if isinstance(error, ModuleNotFoundError) and error.name == f"{package}.{kind}":
        return f"the package '{package}' has nothing of the kind '{kind}'"
    module = sys.modules.get(f"{package}.{kind}")
    if isinstance(error, AttributeError) and module is not None and not hasattr(module, name):
        known = [word for word in vars(module) if word[:1].isupper()]
        return f"the package '{package}' has no '{kind}/{name}'{_similar(name, known)}"
    first_line = (str(error) or type(error).__name__).splitlines()[0]
    return f"'{package}/{kind}/{name}' cannot be imported: {first_line}"


def _similar(word: str, known: Iterable[str]) -> str:
    by_lower_case = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), by_lower_case, n=1)
    return f"; did you mean '{by_lower_case[close[0]]}'?" if close else ""


# --- Messages as text -----------------------------------------------------------------------------------------


class Limits(NamedTuple):
    """What is left out of a message's text."""

    truncate_length: int | None = None
    no_arr: bool = False
    no_str: bool = False


def to_dict(
    message: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> dict[str, Any]:
    """Return a message as plain dicts, lists, numbers and texts.

    Args:
        message: a message.
        truncate_length: so many elements of an array and characters of a text are kept; "..." stands for the rest.
        no_arr: say only how long arrays are.
        no_str: say only how long texts are.
    """
    return _message_to_dict(message, Limits(truncate_length, no_arr, no_str))


def to_yaml(
    message: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Return a message as YAML with a line break at its end; see `to_dict` for what can be left out.

    In flow style a list is in one line.
    """
    values = to_dict(message, truncate_length=truncate_length, no_arr=no_arr, no_str=no_str)
    return dict_to_yaml(values, flow_style=flow_style)


def dict_to_yaml(values: dict[str, Any], *, flow_style: bool = False) -> str:
    """Return what `to_dict` gave as YAML with a line break at its end."""
    if not flow_style and values:
        try:
            return "\n".join(_block(values, "")) + "\n"
        except _SeveralLinesError:
            pass
    return _dump(values, flow_style)


def to_csv(
    message: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Return all values of a message in one line, separated by commas; see `to_dict` for what can be left out."""
    return _message_to_csv(message, Limits(truncate_length, no_arr, no_str))


def fields_of(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield name and type (of `rosidl_parser.definition`) of each field of a message or message class."""
    return zip(message.get_fields_and_field_types(), message.SLOT_TYPES, strict=True)


def _message_to_dict(message: Any, limits: Limits) -> dict[str, Any]:
    return {name: _plain(getattr(message, name), kind, limits) for name, kind in fields_of(message)}


def _plain(value: Any, kind: Any, limits: Limits) -> Any:
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, bytes):
        return _truncated(value.decode("latin-1"), limits)
    if isinstance(value, str):
        return f"<string length: <{len(value)}>>" if limits.no_str else _truncated(value, limits)
    if hasattr(value, "SLOT_TYPES"):
        return _message_to_dict(value, limits)
    if limits.no_arr:
        return _array_summary(value, kind)
    kept = value[: limits.truncate_length]
    if hasattr(kept, "tolist"):  # of numbers: array.array and numpy's
        items = kept.tolist()
    else:
        items = [_plain(item, kind.value_type, limits) for item in kept]
    return items + ["..."] * (len(items) < len(value))


def _truncated(text: str, limits: Limits) -> str:
    length = limits.truncate_length
    return text if length is None or len(text) <= length else text[:length] + "..."


def _array_summary(value: Any, kind: Any) -> str:
    item = kind.value_type
    name = getattr(item, "typename", None) or getattr(item, "name", None)
    if hasattr(item, "namespaced_name"):
        name = "/".join(item.namespaced_name())
    elif name is None:
        name = "wstring" if type(item).__name__.endswith("WString") else "string"
    if hasattr(kind, "size"):
        return f"<array type: {name}[{kind.size}]>"
    bound = f"[{kind.maximum_size}]" if hasattr(kind, "maximum_size") else ""
    return f"<sequence type: {name}{bound}, length: {len(value)}>"


def _message_to_csv(message: Any, limits: Limits) -> str:
    return _joined(_csv(getattr(message, name), kind, limits) for name, kind in fields_of(message))


def _csv(value: Any, kind: Any, limits: Limits) -> str:
    if isinstance(value, str | bool | int | float):
        return str(_plain(value, kind, limits))
    if isinstance(value, bytes):
        length = limits.truncate_length
        return str(value if length is None or len(value) <= length else value[:length] + b"...")
    if hasattr(value, "SLOT_TYPES"):
        return _message_to_csv(value, limits)
    if not hasattr(value, "__len__"):  # numpy's numbers
        return str(value)
    if limits.no_arr:
        return _array_summary(value, kind)
    kept = [_csv(item, kind.value_type, limits) for item in value[: limits.truncate_length]]
    return _joined(kept + ["..."] * (len(kept) < len(value)))


def _joined(values: Iterable[str]) -> str:
    """Join values by commas; Jazzy leaves out empty ones at the beginning, and so do we."""
    return ",".join(itertools.dropwhile(lambda value: not value, values))


# A message with a dozen numbers takes PyYAML several milliseconds, so that `topic echo` would lose some of a
# topic with 1 kHz. Only block style is written here, and each text is still PyYAML's.


class _SeveralLinesError(Exception):
    """A text with line breaks, whose layout depends on how deep it stands."""


def _block(value: Any, indent: str) -> Iterator[str]:
    if isinstance(value, dict):
        for name, inner in value.items():
            if isinstance(inner, dict | list) and inner:
                yield f"{indent}{_scalar(name)}:"
                yield from _block(inner, indent + "  " if isinstance(inner, dict) else indent)
            else:
                yield f"{indent}{_scalar(name)}: {_scalar(inner)}"
        return
    for item in value:
        if isinstance(item, dict) and item:
            first, *rest = _block(item, indent + "  ")
            yield f"{indent}- {first.lstrip()}"
            yield from rest
        else:
            yield f"{indent}- {_scalar(item)}"


def _scalar(value: Any) -> str:
    if isinstance(value, str):
        return _text_scalar(value)
    if isinstance(value, float) and (not math.isfinite(value) or "e" in repr(value)):
        return _dump([value])[2:-1]
    if isinstance(value, bool):
        return "true" if value else "false"
    return "null" if value is None else repr(value)  # a number, [] or {}


@functools.lru_cache(maxsize=4096)
def _text_scalar(text: str) -> str:
    if not YAML_LINE_BREAKS.isdisjoint(text):
        raise _SeveralLinesError
    return _dump([text])[2:-1]


def _dump(value: Any, flow_style: bool = False) -> str:
    import yaml

    text: str = yaml.dump(
        value, Dumper=_dumper(), allow_unicode=True, width=sys.maxsize, default_flow_style=flow_style
    )
    return text


@functools.cache
def _dumper() -> Any:
    """Return a YAML dumper that keeps the order of names, and whose flow style is only that of lists."""
    import yaml

    class Dumper(yaml.SafeDumper):
        pass

    def represent(dumper: Any, values: dict[str, Any]) -> Any:
        pairs = [
            (dumper.represent_data(name), dumper.represent_data(value)) for name, value in values.items()
        ]
        return yaml.MappingNode("tag:yaml.org,2002:map", pairs)

    Dumper.add_representer(dict, represent)
    return Dumper


# --- Messages from text ---------------------------------------------------------------------------------------


def parse_values(text: str | bytes) -> dict[str, Any]:
    """Return the values in a YAML or JSON text.

    Raises:
        RuntimeError: if it is none, or no mapping of names to values.
    """
    import yaml

    try:
        values = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError) as error:
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        mark = getattr(error, "problem_mark", None)
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise RuntimeError(f"The passed value is not valid YAML{place}: {problem}") from error
    if not isinstance(values, dict):
        raise RuntimeError(
            "The passed value needs to be a dictionary in YAML format, such as '{name: 1.0}'"
            " (with a space after each colon)"
        )
    return values


def fill(message: Any, values: Mapping[str, Any]) -> list[StampSetter]:
    """Set the fields of a message; fields that are not named keep what they have.

    Whole numbers become floating point numbers where the field is one, numbers become texts, and texts such as
    "1e3" (which YAML takes for a text) become numbers. `auto` for a `std_msgs/Header` and `now` for a
    `builtin_interfaces/Time` stand for the time of publishing.

    Args:
        message: a message, or the request of a service.
        values: values by name, nested as the message is.

    Returns:
        For each `auto` and `now` a function that takes the present time (a `builtin_interfaces/Time`) and sets it.

    Raises:
        FieldError: if there is no such field, or a value that does not fit into it.
    """
    setters: list[StampSetter] = []
    _fill(message, values, "", setters)
    return setters


def _fill(message: Any, values: Any, where: str, setters: list[StampSetter]) -> None:
    kinds = dict(fields_of(message))
    if not isinstance(values, Mapping):
        names = ", ".join(kinds) or "nothing"
        raise FieldError(f"'{where}' is a message with the fields {names}, not {values!r}")
    for name, value in values.items():
        if name not in kinds:
            whose = f"'{where}' ({_name_of(message)})" if where else _name_of(message)
            raise FieldError(f"{whose} has no field '{name}'; it has {', '.join(kinds) or 'none'}")
        field = f"{where}.{name}" if where else name
        if hasattr(kinds[name], "value_type"):
            present = getattr(message, name)
            setattr(message, name, _like(present, _items(value, kinds[name], field, setters)))
        else:
            setattr(message, name, _value(value, kinds[name], field, setters))


def _name_of(message: Any) -> str:
    module = type(message).__module__.split(".")
    return "/".join([*module[:2], type(message).__name__])


def _like(present: Any, items: list[Any]) -> Any:
    """Return items in the kind of container that the message class has for the field."""
    if isinstance(present, array.array):
        return array.array(present.typecode, items)
    if isinstance(present, list):
        return items
    import numpy as np

    return np.array(items, dtype=present.dtype)


def _items(value: Any, kind: Any, where: str, setters: list[StampSetter]) -> list[Any]:
    if isinstance(value, str | Mapping) or not hasattr(value, "__iter__"):
        raise FieldError(f"'{where}' takes a list, such as [1, 2], not {value!r}")
    items = [_value(item, kind.value_type, f"{where}[{n}]", setters) for n, item in enumerate(value)]
    size, most = getattr(kind, "size", None), getattr(kind, "maximum_size", None)
    if size is not None and len(items) != size:
        raise FieldError(f"'{where}' takes exactly {size} values, not {len(items)}")
    if most is not None and len(items) > most:
        raise FieldError(f"'{where}' takes at most {most} values, not {len(items)}")
    return items


def _value(value: Any, kind: Any, where: str, setters: list[StampSetter]) -> Any:
    if hasattr(kind, "namespaces"):
        return _submessage(value, kind, where, setters)
    typename = getattr(kind, "typename", "string")
    try:
        if typename == "string":
            return _as_text(value, getattr(kind, "maximum_size", None))
        if typename == "boolean":
            return _as_bool(value)
        if typename == "octet":
            return _as_byte(value)
        return _as_float(value, typename) if typename in FLOAT_MAX else _as_int(value, typename)
    except _NotThisError as error:
        raise FieldError(f"'{where}' takes {error}, not {value!r}") from None


def _submessage(value: Any, kind: Any, where: str, setters: list[StampSetter]) -> Any:
    message = find_message("/".join(kind.namespaced_name()))()
    if value == "auto" and kind.namespaced_name() == ("std_msgs", "msg", "Header"):
        setters.append(functools.partial(setattr, message, "stamp"))
    elif value == "now" and kind.namespaced_name() == ("builtin_interfaces", "msg", "Time"):
        setters.append(functools.partial(_set_time, message))
    else:
        _fill(message, value, where, setters)
    return message


def _set_time(time: Any, now: Any) -> None:
    time.sec, time.nanosec = now.sec, now.nanosec


class _NotThisError(Exception):
    """A value of the wrong kind; the text says what would be right."""


def _as_text(value: Any, most: int | None) -> str:
    if value is None or isinstance(value, Mapping | list | tuple | set | bytes):
        raise _NotThisError("a text (in quotes)")
    text = str(value)
    if most is not None and len(text) > most:
        raise _NotThisError(f"a text of at most {most} characters")
    return text


def _as_bool(value: Any) -> bool:
    if not isinstance(value, bool | int | float):
        raise _NotThisError("true or false")
    return bool(value)


def _as_byte(value: Any) -> bytes:
    if isinstance(value, str) and len(value) == 1 and ord(value) < 256:
        return value.encode("latin-1")
    if isinstance(value, bytes) and len(value) == 1:
        return value
    if isinstance(value, int) and 0 <= value < 256:
        return bytes([value])
    raise _NotThisError("a whole number from 0 to 255")


def _as_int(value: Any, typename: str) -> int:
    match = re.fullmatch(r"(u?)int(\d+)", typename)
    bits, unsigned = (int(match[2]), bool(match[1])) if match else (16 if typename == "wchar" else 8, True)
    lowest, highest = (0, 2**bits - 1) if unsigned else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    try:
        number = int(value) if isinstance(value, bool | int | float | str) else None
    except (ValueError, OverflowError):
        number = None
    # What is silently cut off (the half of 1.5, the upper bits of 300) would be published wrong.
    is_whole = not isinstance(value, float) or number == value
    if number is None or not is_whole or not lowest <= number <= highest:
        raise _NotThisError(f"a whole number from {lowest} to {highest}")
    return number


def _as_float(value: Any, typename: str) -> float:
    try:
        number = float(value) if isinstance(value, bool | int | float | str) else None
    except (ValueError, OverflowError):
        number = None
    if number is None or (math.isfinite(number) and abs(number) > FLOAT_MAX[typename]):
        raise _NotThisError("a number")
    return number
