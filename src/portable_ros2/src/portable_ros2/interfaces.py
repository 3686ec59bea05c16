"""Which message, service and action types there are, and how they are defined on disk.

Each package that has any lists its files in the index (`rosidl_interfaces`), such as `msg/String.idl`; the
definition itself lies beside it in `share/<package>/msg/String.msg`.
Source: https://design.ros2.org/articles/interface_definition.html
"""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from portable_ros2 import ament_index

KINDS = {"msg": "Messages", "srv": "Services", "action": "Actions"}
RESOURCE = "rosidl_interfaces"

_BASIC_TYPES = re.compile(
    r"bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string(<=\d+)?|duration|time", re.ASCII
)
_FIELD = re.compile(r"\s*(?P<type>[A-Za-z][\w/]*(?:<=\d+)?)(?:\[[^\]]*\])?\s+[A-Za-z]\w*(?!\w*\s*=)")


@dataclass(frozen=True)
class Line:
    """A line of a definition.

    Attributes:
        text: the line without its end.
        comment: the index at which its comment begins; the length of the text if it has none.
        nested: the type that the field has, `package/msg/Name`; None if that is a basic one.
    """

    text: str
    comment: int
    nested: str | None

    @property
    def code(self) -> str:
        """The line without its comment and outer blanks."""
        return self.text[: self.comment].strip()


def packages() -> list[str]:
    """List the packages that have interfaces."""
    return sorted(ament_index.resources(RESOURCE))


def of_package(package: str, kinds: tuple[str, ...] = tuple(KINDS)) -> list[str]:
    """List a package's interfaces, such as `msg/String`, of some kinds; empty if it has none.

    Raises:
        LookupError: if there is no such package.
    """
    content = ament_index.resource(RESOURCE, package)
    if content is None:
        raise LookupError(f"Unknown package '{package}'")
    # The names before the derived files: each is there as .idl, too.
    names = dict.fromkeys(
        name.removesuffix(".idl")
        for name in content.splitlines()
        if name.endswith(".idl") and name.split("/")[0] in kinds
    )
    return list(names)


def definition(name: str) -> Iterator[Line]:
    """Read the definition of `package/kind/Name`.

    Raises:
        LookupError: if there is no such interface, or the name has not three parts.
    """
    path = definition_file(name)
    package = name.split("/", maxsplit=1)[0]
    with path.open(encoding="utf-8") as file:
        for line in file:
            yield _line(line.rstrip(), package)


def definition_file(name: str) -> Path:
    """Return the file that defines `package/kind/Name`; as `definition`, it raises LookupError."""
    parts = name.split("/")
    if len(parts) != 3 or not all(parts):
        raise LookupError(f"Invalid name '{name}'. Expected three parts separated by '/'")
    package, kind, short = parts
    if package not in ament_index.resources(RESOURCE):
        raise LookupError(f"Unknown package '{package}'")
    path = ament_index.share_folder(package) / kind / f"{short}.{kind}"
    if not path.is_file():
        raise LookupError(f"Could not find the interface '{path.with_suffix('.idl')}'")
    return path


def module(package: str, kind: str) -> ModuleType:
    """Import the classes of a package's interfaces of a kind.

    The names may come from another node or a recording: nothing is imported that is no package of interfaces.

    Raises:
        ImportError: if there is no such package, or it cannot be imported.
    """
    spec = importlib.util.find_spec(package) if package.isidentifier() else None
    if spec is None:
        raise ModuleNotFoundError(f"No module named {package!r}", name=package)
    name = f"{package}.{kind}"
    if kind not in KINDS or not any(
        Path(folder, kind).is_dir() for folder in spec.submodule_search_locations or ()
    ):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    return importlib.import_module(name)


def _line(text: str, package: str) -> Line:
    comment = _comment_start(text)
    field = _FIELD.match(text[:comment])
    if field is None or _BASIC_TYPES.fullmatch(field["type"]):
        return Line(text, comment, None)
    prefix, _, short = field["type"].rpartition("/")
    return Line(text, comment, f"{prefix.split('/')[0] or package}/msg/{short}")


def _comment_start(text: str) -> int:
    """Return the index of the first # that is not within quotes, else the text's length."""
    quote = ""
    for index, letter in enumerate(text):
        if letter == "#" and not quote:
            return index
        if letter in "'\"":
            quote = "" if letter == quote else quote or letter
    return len(text)
