"""Read a parameter file as rcl does: nodes, `ros__parameters`, and values typed by their spelling."""

from __future__ import annotations

import contextlib
import math
import re
from typing import Any

import yaml

from portable_ros2 import bounded_yaml

BELOW = "ros__parameters"
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
        fix: what to do.
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
        raise _reason(error, text) from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        reason = "there is an invalid character here"
        raise ParameterFileError(reason, line, "remove it, and save the file as UTF-8") from None


def is_other_yaml(text: str) -> bool:
    """Return whether a text is YAML for something else: with aliases, merged keys or tags, which rcl does not read."""
    try:
        bounded_yaml.load(text, yaml.SafeLoader)
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


class _Loader(yaml.BaseLoader):
    def get_single_data(self) -> Any:
        """Return the contents of all documents of a file, merged: rcl reads one after the other."""
        documents = []
        while self.check_node():
            documents.append(self.construct_document(self.get_node()))
        if not all(isinstance(item, dict) for item in documents):
            return documents[0]
        return {key: value for item in documents for key, value in item.items()} or None

    def construct_document(self, node: yaml.Node) -> Any:
        keys = [key for key, _ in _entries(node)]
        if any(key.value == BELOW for key in keys):
            for key in keys:
                if not isinstance(key, yaml.ScalarNode):
                    raise _error(
                        key,
                        "there is a list or a mapping where a name should be",
                        "write a name before the colon",
                    )
            _expect_nodes(node, is_top=True)
        return super().construct_document(node)

    def construct_scalar(self, node: Any) -> Any:
        return _value(node.value) if isinstance(node, yaml.ScalarNode) and node.style is None else node.value

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:  # noqa: ARG002 -- PyYAML's
        return {str(key.value): self.construct_object(value, deep=True) for key, value in node.value}


def _entries(node: yaml.Node) -> list[tuple[yaml.Node, yaml.Node]]:
    """Return all keys below a node, at any depth, with their values."""
    inner = node.value if isinstance(node, yaml.MappingNode) else []
    return [*inner, *(entry for _, value in inner for entry in _entries(value))]


def _expect_nodes(node: yaml.Node, *, is_top: bool = False) -> None:
    """Raise an error unless a mapping holds nodes and namespaces, with parameters below `ros__parameters`."""
    for key, value in node.value if isinstance(node, yaml.MappingNode) else ():
        if key.value == BELOW:
            if is_top:
                raise _error(
                    key,
                    f"there is no node name above {BELOW}:",
                    f"write the node's name and a colon above it, and indent {BELOW}: and everything below it by two more spaces",
                )
            if not isinstance(value, yaml.MappingNode):
                written = str(value.value).split("\n")[0]
                entry = (
                    _entry(written)
                    or "each parameter below it as `name: value`, with a space after the colon"
                )
                reason = f"there is no `name: value` below {BELOW}:"
                raise _error(value if written else key, reason, f"write {entry}")
            _expect_parameters(value)
        elif isinstance(value, yaml.MappingNode):
            _expect_nodes(value)
        elif BELOW in str(value.value):
            raise _error(
                value,
                f"the colon after {BELOW} is missing",
                f"write {BELOW}:, and the parameters below it, indented deeper",
            )
        else:
            raise _error(
                key,
                f"{key.value} is not below {BELOW}:",
                f"indent it like the parameters below {BELOW}:",
            )


def _expect_parameters(node: yaml.Node) -> None:
    for key, value in node.value:
        if isinstance(value, yaml.MappingNode):
            _expect_parameters(value)
        elif isinstance(value, yaml.SequenceNode):
            _expect_alike(key, value)
        elif not value.value and value.style is None:
            raise _error(
                key,
                f"nothing comes after {key.value}:",
                "write a value after the colon, in quotes if it begins with #, or remove the line",
            )


def _expect_alike(key: yaml.Node, value: yaml.SequenceNode) -> None:
    if any(not isinstance(item, yaml.ScalarNode) for item in value.value):
        raise _error(
            key,
            f"{key.value} is a list that does not hold plain values",
            "write one list of numbers or of strings",
        )
    kinds = {kind_of(item.value if item.style else _value(item.value)) or "" for item in value.value}
    if len(kinds) > 1:
        *others, last = sorted(kind.lower() for kind in kinds)
        is_text = "STRING" in kinds
        are_numbers = kinds == {"INTEGER", "DOUBLE"}
        alike = (
            "in quotes"
            if is_text
            else "with a point, such as 1.0"
            if are_numbers
            else "as values of one type"
        )
        reason = f"the list {key.value} mixes values of different types: {', '.join(others)} and {last}"
        raise _error(key, reason, f"write all of them {alike}")


class _RclError(yaml.MarkedYAMLError):
    fix = ""


def _error(node: yaml.Node, reason: str, fix: str) -> _RclError:
    error = _RclError(problem=reason, problem_mark=node.start_mark)
    error.fix = fix
    return error


# PyYAML's messages in plain words: pattern, whether the place is where the context began, reason, fix.
_IN_OTHER_WORDS = (
    (
        "quoted scalar",
        True,
        "the quote {sign} opened here is never closed",
        "write {sign} at the end of the string, too",
    ),
    ("flow sequence", True, "the bracket [ opened here is never closed", "write ] after its last value"),
    (
        "flow mapping",
        True,
        "the brace {{ opened here is never closed",
        "write }} after its last value",
    ),
    (
        r"'\\t'",
        False,
        "there is a tab here, but YAML must be indented with spaces",
        "write spaces instead of the tab",
    ),
    (
        "<block end>",
        False,
        "this line is not indented like the lines it belongs with",
        "indent it by the same number of spaces",
    ),
    (
        "alias",
        False,
        "a name or a value begins with *, which stands for another value in YAML, but ROS does not read that",
        "write the value itself; or put it in quotes if it is meant as a word",
    ),
    (
        "anchor|cannot start any token",
        False,
        "a name or a value begins with a character that has a special meaning in YAML",
        "put it in quotes",
    ),
)


def _reason(error: yaml.MarkedYAMLError, text: str) -> ParameterFileError:
    """Return a YAML error in plain words, with the line where the fault begins."""
    if isinstance(error, _RclError):
        assert error.problem_mark is not None
        return ParameterFileError(error.problem or "", error.problem_mark.line + 1, error.fix)
    lines, said = text.splitlines(), f"{error.context} {error.problem}"
    if "mapping values are not allowed" in said and error.problem_mark:
        return _second_colon(lines, error.problem_mark)
    for words, is_where_it_began, reason, fix in _IN_OTHER_WORDS:
        mark = error.context_mark if is_where_it_began else error.problem_mark
        if mark and re.search(words, said):
            sign = lines[mark.line][mark.column : mark.column + 1] if mark.line < len(lines) else ""
            return ParameterFileError(reason.format(sign=sign), mark.line + 1, fix.format(sign=sign))
    if before := _without_colon(lines, error):
        return before
    line = error.problem_mark.line + 1 if error.problem_mark else None
    return ParameterFileError(error.problem or "it cannot be read", line)


def _without_colon(lines: list[str], error: yaml.MarkedYAMLError) -> ParameterFileError | None:
    """Return an error at the line that lacks a colon and a space; None if adding them does not help."""
    first, last = error.context_mark, error.problem_mark
    if first is None or last is None:
        return None
    start = first.line
    while start and _entry(lines[start - 1]):  # YAML reads several such lines as one string
        start -= 1
    meant = {n: entry for n in range(start, min(last.line + 1, len(lines))) if (entry := _entry(lines[n]))}
    indents = [line[: len(line) - len(line.lstrip())] for line in lines]
    whole = [f"{indents[n]}{meant[n]}" if n in meant else line for n, line in enumerate(lines)]
    if not meant or not _is_read_beyond("\n".join(whole), last.line):
        return None
    number, entry = next(iter(meant.items()))
    more = ", and the lines below it likewise" if len(meant) > 1 else ""
    return ParameterFileError(
        "the colon and the space after the name are missing", number + 1, f"write {entry}{more}"
    )


def _is_read_beyond(text: str, line: int) -> bool:
    """Return whether a text is valid YAML up to a line, counted from 0; there may be another fault below."""
    try:
        yaml.compose(text, Loader=yaml.BaseLoader)
    except yaml.MarkedYAMLError as error:
        return bool(error.context_mark and error.context_mark.line > line)
    except yaml.YAMLError:
        return False
    return True


def _second_colon(lines: list[str], mark: yaml.Mark) -> ParameterFileError:
    """Return why YAML rejects a colon: there are two on the line, or the line continues the one above."""
    here = lines[mark.line]
    if re.search(r":\s", here[: mark.column]):
        return ParameterFileError("this line has two colons", mark.line + 1, "put the value in quotes")
    above = next((n for n in range(mark.line - 1, -1, -1) if lines[n].split("#")[0].strip()), 0)
    if entry := _entry(lines[above]):
        reason = "the colon and the space after the name are missing"
        return ParameterFileError(reason, above + 1, f"write {entry}")
    reason = "this line is indented deeper than the one above, which already has a value"
    return ParameterFileError(reason, mark.line + 1, "indent it like the line above")


def _entry(line: str) -> str:
    """Return a line such as `p = 1` or `p:1` written as an entry; empty if it is one, or cannot be one."""
    match = re.match(r"\s*([\w.]+)(?:\s*=\s*|:|\s+)(?=\S)", line)
    return (
        "" if match is None or re.search(r":(\s|$)", line) else f"{match[1]}: {line[match.end() :].strip()}"
    )
