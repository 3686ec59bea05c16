"""Definitions of message types, as a recording holds them."""

from __future__ import annotations

from portable_ros2 import interfaces

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
