"""Stubs of message classes for the type checker, because their Python code has no types."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.signatures import fields_as_parameters, message_of

_PLAIN = frozenset(("float", "int", "str", "bool", "list"))
# Other members of a package are not known here, so they may be anything.
_HEAD = "import typing\n\ndef __getattr__(name: str) -> typing.Any: ...\n"


def write_stubs(names: Iterable[str], folder: Path) -> None:
    """Write the stubs of those of some names that are messages, and of the messages in their fields, into a folder to search."""
    folder.mkdir(parents=True, exist_ok=True)
    modules: dict[str, list[str]] = {}
    for name in _held(names):
        modules.setdefault(name.rpartition(".")[0], []).append(_class(name))
    for module, classes in modules.items():
        path = folder.joinpath(*module.split("."))
        path.mkdir(parents=True, exist_ok=True)
        imported = {module_name.rpartition(".")[0] for module_name in modules} | set(modules)
        lines = [f"import {module_name}\n" for module_name in sorted(filter(None, imported))]
        path.joinpath("__init__.pyi").write_text("".join([*lines, _HEAD, *classes]))
        path.parent.joinpath("__init__.pyi").write_text(_HEAD)


def _held(names: Iterable[str]) -> Iterator[str]:
    """Yield messages and the messages in their fields, each once."""
    left, known = list(names), set[str]()
    while left:
        name = left.pop()
        if name not in known and ".msg." in name and interfaces.fields_of(name) is not None:
            known.add(name)
            yield name
            fields = interfaces.fields_of(name) or {}
            left += [held for field in fields_as_parameters(fields) if (held := message_of(field.type))]


def _class(name: str) -> str:
    """Return the stub of a message's class."""
    rows = [
        (field.name, _type(field.type)) for field in fields_as_parameters(interfaces.fields_of(name) or {})
    ]
    given = "".join(f", {field}: {kind} = ..." for field, kind in rows)
    # Properties, as in the real class: the class itself does not have their values.
    fields = "".join(
        f"    @property\n    def {field}(self) -> {kind}: ...\n"
        f"    @{field}.setter\n    def {field}(self, value: {kind}) -> None: ...\n"
        for field, kind in rows
    )
    made = f"    def __init__(self{', *' if given else ''}{given}) -> None: ...\n"
    known = "    @classmethod\n    def get_fields_and_field_types(cls) -> dict[str, str]: ...\n"
    return f"\nclass {name.rpartition('.')[2]}:\n{fields}{made}{known}"


def _type(kind: str) -> str:
    """Return how Python names the type of a field."""
    return message_of(kind) or (kind if kind in _PLAIN else "typing.Any")
