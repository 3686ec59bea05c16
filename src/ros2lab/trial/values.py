"""Shows values of a running program without running code of its own; imports nothing of ros2lab."""

# ruff: noqa: PTH123

import ast
import contextlib
import itertools
from collections import deque
from collections.abc import Mapping
from types import FrameType
from typing import Any

LONGEST, _MOST_VALUES, _FIRST = 60, 12, 4
PLAIN = frozenset((int, float, bool, str, bytes, type(None)))
NUMBERS = frozenset((int, float))
HOLDERS = frozenset((list, tuple, dict, set, frozenset, deque, range, str, bytes))
_SHORT = frozenset(("rclpy.duration", "rclpy.time", "datetime", "enum"))  # whose objects have a short repr


class Words(str):
    """What is shown of a value that is not kept."""

    __repr__ = str.__str__


def shown(value: object) -> str:
    """Return a short text for a value, quickly: a test may be evaluated a thousand times a second."""
    try:
        kind = type(value)
        if kind in PLAIN:
            return repr(value[:LONGEST] if isinstance(value, (str, bytes)) else value)[: LONGEST + 2]
        name = f"{'an' if kind.__name__[0] in 'AEIOUaeio' else 'a'} {kind.__name__}"
        if kind in HOLDERS:
            return f"{name} of {len(value)}" if value else f"an empty {kind.__name__}"  # type: ignore[arg-type]
        is_short = isinstance(value, (int, float)) or kind.__module__ in _SHORT
        return repr(value)[:LONGEST] if is_short else name
    except Exception:
        return "?"


def values_in(frame: FrameType, line: int) -> list[tuple[str, str, int | None]]:
    """Return the values in the statement at a line of a frame: the text of each, what is shown of it, and its length."""
    with open(frame.f_code.co_filename, "rb") as file:
        statements = [node for node in ast.walk(ast.parse(file.read())) if isinstance(node, ast.stmt)]
    around = (node for node in statements if node.lineno <= line <= (node.end_lineno or 0))
    statement = max(around, key=lambda node: (node.lineno, node.col_offset))
    is_head = hasattr(statement, "body")
    parts = [n for n in ast.iter_child_nodes(statement) if not is_head or isinstance(n, ast.expr)]
    names = {**frame.f_globals, **frame.f_locals}
    found: dict[str, tuple[str, str, int | None]] = {}
    for node in itertools.chain.from_iterable(map(ast.walk, parts)):
        if not isinstance(node, (ast.Name, ast.Attribute, ast.Subscript, ast.BinOp)):
            continue
        if not isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del)) and len(found) < _MOST_VALUES:
            with contextlib.suppress(Exception):
                text = ast.unparse(node)
                found[text] = (text, *_described(_evaluated(node, names)))
    return [*found.values()]


def _evaluated(node: ast.AST, names: Mapping[str, Any]) -> Any:
    """Return the value of an expression without running code of the program; raises an error if that cannot be."""
    with contextlib.suppress(ValueError):
        return ast.literal_eval(node)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "len" and "len" not in names:
        found = _evaluated(node.args[0], names)
        return len(found) if type(found) in HOLDERS else names["len"]
    fields = dict(ast.iter_fields(node))
    parts = {name: _evaluated(part, names) for name, part in fields.items() if isinstance(part, ast.expr)}
    if isinstance(node, ast.Attribute):
        return _attribute(parts["value"], node.attr)
    kinds, owner = {*map(type, parts.values())}, type(parts.get("value"))
    is_sum = isinstance(node, ast.BinOp) and not isinstance(node.op, (ast.Pow, ast.LShift))
    is_of_holder = owner in HOLDERS or owner.__module__ in ("array", "numpy")
    is_element = isinstance(node, ast.Subscript) and is_of_holder and kinds - {owner} <= PLAIN | {slice}
    if not (is_element or isinstance(node, ast.Slice) or (is_sum and kinds <= NUMBERS)):
        raise LookupError
    if isinstance(node, ast.Slice):
        return slice(*map(parts.get, fields))
    whole = type(node)(**{**fields, **{name: ast.Name(name) for name in parts}})
    return eval(ast.unparse(whole), {}, parts)  # noqa: S307 -- of numbers, or of an element


def _attribute(owner: Any, name: str) -> Any:
    """Return an attribute that an object holds itself, or a field of a message."""
    with contextlib.suppress(AttributeError):
        own: dict[str, Any] = object.__getattribute__(owner, "__dict__")
        if name in own:
            return own[name]
    if hasattr(type(owner), "get_fields_and_field_types"):
        return object.__getattribute__(owner, f"_{name}")
    for kind in type(owner).__mro__:
        if type(value := vars(kind).get(name)) in PLAIN and name in vars(kind):
            return value
    raise LookupError


def _described(value: Any) -> tuple[str, int | None]:
    """Return what is shown of a value, with the first of its elements, and its length; None without one."""
    kind = type(value)
    if kind.__name__ in ("module", "function", "method", "builtin_function_or_method", "type"):
        raise LookupError
    if kind.__module__ == "numpy" and hasattr(value, "shape"):
        return f"an array of shape {value.shape} and type {value.dtype}", len(value)
    text = shown(value)
    if kind is str or kind is bytes:
        return text, len(value)
    if kind not in HOLDERS and kind.__module__ != "array":
        return text, None
    first = ", ".join([*map(shown, itertools.islice(value, _FIRST)), *["..."][: len(value) > _FIRST]])
    words = f"a dict with {first}" if kind is dict else f"{text} ({first})"
    return (words if value else text), len(value)
