"""A parameter file as rcl reads it: nodes, `ros__parameters`, and values whose types their spelling decides."""

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
_LONGEST_NUMBER = 100  # letters; longer ones are too large, and texts
_FLOAT = re.compile(
    r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|0[xX][\da-fA-F]+(?:\.[\da-fA-F]*)?(?:[pP][-+]?\d+)?|\.?inf(?:inity)?|\.?nan)",
    re.IGNORECASE,
)
_KINDS = {bool: "BOOL", int: "INTEGER", float: "DOUBLE", str: "STRING"}


class ParameterFileError(ValueError):
    """A text is no parameter file; its text says why.

    Attributes:
        line: where, from 1 on; None if it is not known.
        fix: what to do.
    """

    def __init__(self, reason: str, line: int | None, fix: str = "") -> None:
        super().__init__(reason)
        self.line = line
        self.fix = fix or "indent with spaces and never with tabs, and write a space after each colon"


class UnreadParameterFileError(ParameterFileError):
    """A text may be a parameter file, and is longer or deeper than is read here; ROS may read it."""


def kind_of(value: Any) -> str | None:
    """Return the type of parameter that a value has, as rcl names it; None if it has none."""
    if not isinstance(value, (list, tuple)):
        return _KINDS.get(type(value))
    kinds = {_KINDS.get(type(each)) for each in value}
    kind = kinds.pop() if len(kinds) == 1 else None
    return f"{kind}_ARRAY" if kind else None


def read_parameter_file(text: str) -> Any:
    """Return what a parameter file holds, with the types that rcl gives its values.

    What has no `ros__parameters` may be a file for something else: of it only its YAML is asked.

    Raises:
        UnreadParameterFileError: if it is longer or deeper than somebody writes by hand.
        ParameterFileError: if it is no YAML, or holds what rcl does not read.
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


def _value(written: str) -> bool | int | float | str:
    """Return the value of what stands without quotes."""
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
        """Return what all documents of a file hold: rcl reads one after the other."""
        documents = []
        while self.check_node():
            documents.append(self.construct_document(self.get_node()))
        if not all(isinstance(each, dict) for each in documents):
            return documents[0]
        return {key: value for each in documents for key, value in each.items()} or None

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
    """Return all keys below a node, at any depth, with what belongs to them."""
    inner = node.value if isinstance(node, yaml.MappingNode) else []
    return [*inner, *(entry for _, value in inner for entry in _entries(value))]


def _expect_nodes(node: yaml.Node, *, is_top: bool = False) -> None:
    """Expect names of nodes and namespaces, and their parameters below `ros__parameters`."""
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
    if any(not isinstance(each, yaml.ScalarNode) for each in value.value):
        raise _error(
            key,
            f"{key.value} is a list that does not hold plain values",
            "write one list of numbers or of strings",
        )
    kinds = {kind_of(each.value if each.style else _value(each.value)) or "" for each in value.value}
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


# What PyYAML's words mean to who writes a file: words, whether the place is where it began, reason, fix.
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
        "alias|anchor|cannot start any token",
        False,
        "a name or a value begins with a character that has a special meaning in YAML",
        "put it in quotes",
    ),
)


def _reason(error: yaml.MarkedYAMLError, text: str) -> ParameterFileError:
    """Say what YAML does not take, in the words of who writes it, and where that begins."""
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
    """Say which line lacks a colon and a space, where YAML notices it only after it; None if none does so alone."""
    first, last = error.context_mark, error.problem_mark
    if first is None or last is None:
        return None
    start = first.line
    while start and _entry(lines[start - 1]):  # YAML takes several such lines for one text
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
    """Return whether YAML takes a text as far as a line, counted from 0: what comes after it may be another fault."""
    try:
        yaml.compose(text, Loader=yaml.BaseLoader)
    except yaml.MarkedYAMLError as error:
        return bool(error.context_mark and error.context_mark.line > line)
    except yaml.YAMLError:
        return False
    return True


def _second_colon(lines: list[str], mark: yaml.Mark) -> ParameterFileError:
    """Say why YAML takes a colon for one too many: its line holds two, or belongs to the one above."""
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
    """Return a line such as `p = 1` or `p:1` as it was meant; empty if it is an entry, or none can be told."""
    match = re.match(r"\s*([\w.]+)(?:\s*=\s*|:|\s+)(?=\S)", line)
    return (
        "" if match is None or re.search(r":(\s|$)", line) else f"{match[1]}: {line[match.end() :].strip()}"
    )
