"""Read a parameter file as rcl does: nodes, `ros__parameters`, and values typed by their spelling."""

from __future__ import annotations

import contextlib
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from portable_ros2 import bounded_yaml
from ros2lab.diagnose.sources.slips import Slip, Vocabulary
from ros2lab.diagnose.sources.yaml_slips import yaml_repair
from ros2lab.located_yaml import QUICK

BELOW = "ros__parameters"
_WORDS = Vocabulary((BELOW, "/**"))
# rcl reads with libyaml, which takes tabs after a value; PyYAML's own reader takes none, and is for where libyaml is not.
_Yaml: Any = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
_TRUE = frozenset(["y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"])
_FALSE = frozenset(["n", "N", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"])
_INTEGER = re.compile(r"[-+]?(?:0[xX][\da-fA-F]+|0[0-7]*|[1-9]\d*)")
_LARGEST = 2**63  # rcl keeps 64 bits
_LONGEST_NUMBER = 100  # characters; a longer number is too large, and so a string
_FLOAT = re.compile(
    r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|0[xX][\da-fA-F]+(?:\.[\da-fA-F]*)?(?:[pP][-+]?\d+)?|\.?inf(?:inity)?|\.?nan)",
    re.IGNORECASE,
)
_KINDS = {bool: "BOOL", int: "INTEGER", float: "DOUBLE", str: "STRING"}


class ParameterFileError(ValueError):
    """A text is not a parameter file; the message says why.

    Attributes:
        line: the line, counted from 1; None if not known.
    """

    def __init__(self, reason: str, line: int | None, fix: str = "") -> None:
        super().__init__(reason)
        self.line = line
        self.fix = fix or "indent with spaces and never with tabs, and write a space after each colon"


class UnreadParameterFileError(ParameterFileError):
    """A parameter file is too long or too deeply nested to be read here, although ROS may read it."""


def kind_of(value: Any) -> str | None:
    """Return the parameter type of a value, as rcl names it; None if it has none."""
    if not isinstance(value, (list, tuple)):
        return _KINDS.get(type(value))
    kinds = {_KINDS.get(type(item)) for item in value}
    kind = kinds.pop() if len(kinds) == 1 else None
    return f"{kind}_ARRAY" if kind else None


def read_parameter_file(text: str) -> Any:
    """Return the contents of a parameter file, with the types that rcl gives its values.

    A file without `ros__parameters` may be for something else: it only has to be valid YAML.

    Raises:
        UnreadParameterFileError: if it is longer or more deeply nested than anybody writes by hand.
        ParameterFileError: if it is not valid YAML, or holds what rcl does not read.
    """
    try:
        return bounded_yaml.load(text, _Loader, has_aliases=False)
    except bounded_yaml.TooLargeError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else None
        raise UnreadParameterFileError(error.problem or "", line) from None
    except yaml.MarkedYAMLError as error:
        raise _reason(error) from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        reason = "there is an invalid character here"
        raise ParameterFileError(reason, line, "remove it, and save the file as UTF-8") from None


def parameter_file_repair(text: str) -> Slip | None:
    """Return the likeliest slip of typing that keeps a parameter file from being read; None if none is found.

    A file without `ros__parameters` may be for something else: it only has to be valid YAML.
    """
    if BELOW not in text:
        return yaml_repair(text, Vocabulary(()))
    # An alias whose value is there is no slip: rcl reads none.
    if re.search(r"(?s)&(\w+)\b.*\*\1\b", text) or not _may_be_a_slip(text):
        return None
    return yaml_repair(text, _WORDS, _check)


def _may_be_a_slip(text: str) -> bool:
    try:
        bounded_yaml.load(text, _Loader, has_aliases=False)
    except _RclError as error:
        return error.is_slip
    except (yaml.YAMLError, ValueError):
        return True
    return True


def _check(node: yaml.Node) -> None:
    seen, left = {id(node)}, [node]
    while left:
        above = left.pop()
        pairs = above.value if isinstance(above, yaml.MappingNode) else ()
        items = above.value if isinstance(above, yaml.SequenceNode) else ()
        for inner in (*(node for pair in pairs for node in pair), *items):
            if id(inner) in seen:
                raise _error(inner, "ROS reads no aliases", "")
            seen.add(id(inner))
            left.append(inner)
    if all(key.value != BELOW for key, _ in _entries(node)):
        raise _error(node, f"there is no {BELOW}:", "")
    check_parameters(node)


def is_other_yaml(text: str) -> bool:
    """Return whether a text is YAML for something else: with aliases, merged keys or tags, which rcl does not read."""
    try:
        bounded_yaml.load(text, QUICK)
    except (yaml.YAMLError, ValueError):
        return False
    return True


def _value(written: str) -> bool | int | float | str:
    """Return the value of a scalar without quotes."""
    if written in _TRUE | _FALSE:
        return written in _TRUE
    lower = written.lower()
    if _INTEGER.fullmatch(written) and len(written) < _LONGEST_NUMBER:
        base = 16 if "x" in lower else 8 if written.lstrip("+-").startswith("0") else 10
        if -_LARGEST <= (number := int(written, base)) < _LARGEST:
            return number
    if _FLOAT.fullmatch(written) and len(written) < _LONGEST_NUMBER:
        with contextlib.suppress(OverflowError):
            value = float.fromhex(written) if "x" in lower else float(re.sub(r"\.(?=[in])", "", lower))
            if "inf" in lower or not math.isinf(value):
                return value
    return written


def _read(node: yaml.Node) -> Any:
    """Return the value of a node, or those of its items."""
    if isinstance(node, yaml.ScalarNode):
        return node.value if node.style else _value(node.value)
    return [*map(_read, node.value)] if isinstance(node, yaml.SequenceNode) else None


class _Loader(_Yaml):
    def get_single_data(self) -> Any:
        """Return the contents of all documents of a file, merged: rcl reads one after the other."""
        documents = []
        while self.check_node():
            documents.append(self.construct_document(self.get_node()))
        if not all(isinstance(item, dict) for item in documents):
            return documents[0]
        return _merged([entry for item in documents for entry in item.items()]) or None

    def construct_document(self, node: yaml.Node) -> Any:
        check_parameters(node)
        return super().construct_document(node)

    def construct_scalar(self, node: Any) -> Any:
        return _read(node)

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:  # noqa: ARG002 -- PyYAML's
        return _merged(
            [(str(key.value), self.construct_object(value, deep=True)) for key, value in node.value]
        )


def _merged(entries: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return a mapping of entries; those of one name are put together, as rcl does, and of single values the last counts."""
    found: dict[str, Any] = {}
    for key, given in entries:
        value = given
        if isinstance(above := found.get(key), dict) and isinstance(value, dict):
            value = _merged([*above.items(), *value.items()])
        found[key] = value
    return found


def check_parameters(node: yaml.Node) -> None:
    """Raise a `yaml.MarkedYAMLError` if a document with `ros__parameters` holds what rcl does not read."""
    keys = [key for key, _ in _entries(node)]
    if any(key.value == BELOW for key in keys):
        for key in keys:
            if not isinstance(key, yaml.ScalarNode):
                reason = "there is a list or a mapping where a name should be"
                raise _error(key, reason, "write a name before the colon")
        for empty in _expect_nodes(node, is_top=True):
            fix = "write a parameter below it as `name: value`, or remove it and the node's name above it"
            raise _value_error(empty, f"there is no parameter below this {BELOW}", fix)


def _entries(node: yaml.Node) -> list[tuple[yaml.Node, yaml.Node]]:
    """Return all keys below a node, at any depth, with their values."""
    inner = node.value if isinstance(node, yaml.MappingNode) else []
    return [*inner, *(entry for _, value in inner for entry in _entries(value))]


def _expect_nodes(node: yaml.Node, *, is_top: bool = False) -> list[yaml.Node]:
    """Raise an error unless a mapping holds nodes and namespaces, with parameters below `ros__parameters`.

    Return each `ros__parameters` with nothing below it: no slip of typing if all else is right.
    """
    empty = list[yaml.Node]()
    _expect_once(node)
    for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
        if key.value == BELOW:
            if is_top:
                raise _error(
                    key,
                    f"there is no node name above {BELOW}:",
                    f"write the node's name and a colon above it, and indent {BELOW}: and everything below it by two more spaces",
                )
            if isinstance(value, yaml.MappingNode):
                _expect_parameters(value)
            elif value.value:
                reason = f"there is no `name: value` below {BELOW}:"
                fix = "write each parameter below it as `name: value`, with a space after the colon"
                raise _error(value, reason, fix)
            else:
                empty.append(key)
        elif isinstance(value, yaml.MappingNode):
            empty += _expect_nodes(value)
        elif BELOW in str(value.value):
            raise _error(
                value,
                f"the colon after {BELOW} is missing",
                f"write {BELOW}:, and the parameters below it, indented deeper",
            )
        else:
            raise _error(
                key, f"{key.value} is not below {BELOW}:", f"indent it like the parameters below {BELOW}:"
            )
    return empty


def _expect_once(node: yaml.Node) -> None:
    """Raise an error if there is a second `ros__parameters` in one node: rcl misses the node's name above it."""
    inner = [*node.value] if isinstance(node, yaml.MappingNode) else []
    heads = [index for index, (key, _) in enumerate(inner) if key.value == BELOW]
    if len(heads) < 2:
        return
    (first, above), (key, value) = inner[heads[0]], inner[heads[1]]
    fix = f"move the parameters below it to those below line {_line(first)}, and remove this line"
    is_next = heads[1] == heads[0] + 1 and all(
        isinstance(n, yaml.MappingNode) and not n.flow_style for n in (above, value)
    )
    if is_next and above.start_mark.column == value.start_mark.column:
        fix = f"remove this line, so that the parameters below it belong to line {_line(first)}"
    reason = f"{BELOW}: is written a second time for the same node, after line {_line(first)}"
    raise _value_error(key, reason, fix)


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


def _expect_parameters(node: yaml.Node) -> None:
    for key, value in node.value:
        if isinstance(value, yaml.MappingNode):
            _expect_parameters(value)
        elif isinstance(value, yaml.SequenceNode):
            _expect_alike(key, value)
        elif not value.value and not value.style:
            raise _error(
                key,
                f"nothing comes after {key.value}:",
                "write a value after the colon, in quotes if it begins with #, or remove the line",
            )


def _expect_alike(key: yaml.Node, value: yaml.SequenceNode) -> None:
    if any(not isinstance(item, yaml.ScalarNode) for item in value.value):
        raise _value_error(
            key,
            f"{key.value} is a list that does not hold plain values",
            _unnested(key.value, value.value),
        )
    kinds = _kinds(value.value)
    if len(kinds) > 1:
        *others, last = sorted(kind.lower() for kind in kinds)
        alike = "in quotes" if "STRING" in kinds else "as values of one type"
        fix = f"write all of them {alike}"
        if kinds == _NUMBERS:
            fix = f"write every number with a decimal point: {key.value}: {_list_of(value.value)}"
        reason = f"the list {key.value} mixes values of different types: {', '.join(others)} and {last}"
        raise _value_error(key, reason, fix)


def _kinds(items: Iterable[yaml.ScalarNode]) -> set[str]:
    return {kind_of(item.value if item.style else _value(item.value)) or "" for item in items}


def _unnested(name: str, items: Sequence[yaml.Node]) -> str:
    """Return how what is written as a list of lists, or of mappings, can be given as parameters."""
    rows = [
        {key.value: cell for key, cell in item.value} for item in items if isinstance(item, yaml.MappingNode)
    ]
    columns = {key: [row[key] for row in rows if key in row] for key in itertools.chain(*rows)}
    if not rows:
        cells = [[item] if isinstance(item, yaml.ScalarNode) else item.value for item in items]
        flat = [*itertools.chain(*cells)]
        if _are_plain(flat):
            return f"write one list, and take it apart again in the node: {name}: {_list_of(flat)}"
    elif columns and all(len(column) == len(items) and _are_plain(column) for column in columns.values()):
        lists = " and ".join(f"{key}: {_list_of(column)}" for key, column in columns.items())
        names = " and ".join(f"{name}.{key}" for key in columns)
        return f"write a list for each key, below {name}: {lists}; the node then declares {names}"
    return "write a list of numbers or of strings for each thing that it holds"


_NUMBERS = {"INTEGER", "DOUBLE"}


def _are_plain(items: Iterable[yaml.Node]) -> bool:
    """Return whether nodes are values that one list of a parameter may hold, once numbers are written alike."""
    items = [*items]
    if not items or not all(isinstance(item, yaml.ScalarNode) for item in items):
        return False
    return len(_kinds(items)) == 1 or _kinds(items) == _NUMBERS


def _list_of(items: Sequence[yaml.ScalarNode]) -> str:
    """Return plain values as a list, all numbers with a decimal point if one has it."""
    has_doubles = _kinds(items) == _NUMBERS
    written = (
        f'"{item.value}"' if item.style else _with_point(item.value) if has_doubles else item.value
        for item in items
    )
    return f"[{', '.join(written)}]"


def _with_point(text: str) -> str:
    """Return a number as YAML reads a double."""
    value = _value(text)
    return f"{value}.0" if isinstance(value, int) else text


class _RclError(yaml.MarkedYAMLError):
    fix, is_slip = "", True


def _error(node: yaml.Node, reason: str, fix: str) -> _RclError:
    error = _RclError(problem=reason, problem_mark=node.start_mark)
    error.fix = fix
    return error


def _value_error(node: yaml.Node, reason: str, fix: str) -> _RclError:
    """Return an error about a value that is written as it was meant: no slip of typing."""
    error = _error(node, reason, fix)
    error.is_slip = False
    return error


def _reason(error: yaml.MarkedYAMLError) -> ParameterFileError:
    """Return a YAML error with the line where the parser notices it."""
    mark, fix = error.problem_mark or error.context_mark, getattr(error, "fix", "")
    if "aliases" in (error.problem or ""):
        fix = "write the value itself"
        error.problem = (
            "a value begins with *, which stands for another value in YAML, but ROS does not read that"
        )
    return ParameterFileError(error.problem or "it cannot be read", mark.line + 1 if mark else None, fix)


def line_of(key: str, text: str) -> int | None:
    """Return the line of a parameter file with a parameter or a section, which may be below its namespace."""
    lines = [line.strip().strip("\"'").lstrip("/") for line in text.splitlines()]
    names = (key.strip("/"), key.rstrip("/").rpartition("/")[2])
    return next((n for name in names for n, line in enumerate(lines, 1) if line.startswith(name)), None)


@dataclass(frozen=True)
class Written:
    """A parameter's value as it stands in a file.

    Attributes:
        section: the full name of the node, or the pattern, that it is for.
        name: the parameter, with the groups that it is in, as in `gains.p`.
        value: what ROS reads there.
        octal: the numbers in it that ROS reads as octal, as they are written, such as 010.
        lines: what goes with it: the first and the last line to remove, with the heads that would have nothing left.
    """

    section: str
    name: str
    text: str
    value: Any
    line: int
    lines: tuple[int, int]
    octal: tuple[str, ...] = ()

    @property
    def short(self) -> str:
        """The value as it is written, on one line."""
        return " ".join(self.text.split())


def written_values(text: str) -> list[Written]:
    """Return all values of a parameter file that can be read, in their order, also those that later ones replace.

    Of a file of several documents, which hardly anybody writes, none is returned.
    """
    documents = [*yaml.compose_all(text, _Yaml)]
    return [*_written(documents[0], (), "", None, text)] if len(documents) == 1 else []


def _written(
    node: yaml.Node | None, above: tuple[str, ...], section: str, alone: int | None, text: str
) -> Iterator[Written]:
    """Yield the values below a mapping; `alone` is the line of the outermost head that has nothing else below it."""
    entries: Sequence[tuple[yaml.Node, yaml.Node]] = node.value if isinstance(node, yaml.MappingNode) else ()
    for key, value in entries:
        head = alone if alone and len(entries) == 1 else _line(key)
        if isinstance(value, yaml.MappingNode):
            is_head = key.value == BELOW and not section
            name = f"/{'/'.join(part.strip('/') for part in above)}" if is_head else section
            yield from _written(value, () if is_head else (*above, key.value), name, head, text)
        elif section:
            said = text[value.start_mark.index : value.end_mark.index].strip()
            last = int(value.start_mark.line) + 1 + said.count("\n")
            items = value.value if isinstance(value, yaml.SequenceNode) else [value]
            octal = tuple(item.value for item in items if not item.style and _is_octal(item.value))
            name = ".".join((*above, key.value))
            yield Written(section, name, said, _read(value), _line(key), (head, last), octal)


def _is_octal(text: str) -> bool:
    value = _value(text) if re.fullmatch(r"[-+]?0\d+", text) else ""
    return isinstance(value, int) and value != int(text)


def is_for(key: str, full_name: str) -> bool:
    """Return whether a section of a parameter file, such as `/**/talker`, is for a node."""
    parts = [
        ".*" if part == "**" else re.escape(part).replace(r"\*", "[^/]*")
        for part in key.strip("/").split("/")
    ]
    return re.fullmatch("/" + "/".join(parts).replace(".*/", "(?:.*/)?"), full_name) is not None
