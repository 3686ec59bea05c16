"""Errors from format strings: each is filled again with similar values, and changed until that works.

Only Python's own formatting runs, with plain numbers and strings instead of the program's values.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.checking.trials import type_of
from ros2lab.diagnose.code.placeholders import regrouped
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.own_functions import held_once
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import nearest

# What a format string must contain to raise each exception.
_RAISED_BY = {
    "AttributeError": r"\{\w*\.",
    "KeyError": r"\{[^}:]*[^\d}:]|%\(",
    "IndexError": r"[{\[]",
    "TypeError": r"%|[\[:]",
    "ValueError": "",
}
_PLAIN: Mapping[str, object] = {
    "float": 1.5,
    "int": 3,
    "str": "a",
    "bool": True,
    "list": [1, 2],
    "NoneType": None,
}
_FIELD = re.compile(r"\{([^{}]*)\}")
_PERCENT = re.compile(r"%(?:\((?P<name>[^)]*)\))?(?P<form>[-+ #0]*\d*(?:\.\d*)?)(?P<letter>.?)", re.DOTALL)
_WIDEST = 999  # characters or digits of a field; nobody writes more by hand
_Values = tuple[list[object], dict[str, object]]
# How each kind of format string is filled.
_WAYS: Mapping[str, Callable[[str, _Values], object]] = {
    "format": lambda text, values: text.format(*values[0], **values[1]),
    "percent": lambda text, values: text % (values[1] or tuple(values[0])),
    "f-string": lambda text, values: format(values[0][0], text),
}


@dataclass(frozen=True)
class _Use:
    """A format string that is filled.

    Attributes:
        text: the text; of an f-string, the part after the colon.
        values: the expressions that fill it, each with its name; empty for values by position.
    """

    node: ast.expr
    source: PythonSource
    text: str
    values: Sequence[tuple[str, ast.expr]]
    fill: Callable[[str, _Values], object]
    changes: Callable[[str, _Values], Iterator[tuple[str, str, str]]]


def of_format(kind: str, message: str, spot: Spot) -> Finding | None:
    """Return which part of a format string failed, and how it was meant; None if none did."""
    if kind not in _RAISED_BY:
        return None
    if message.startswith("not enough arguments") and (whole := [*filter(None, map(regrouped, spot.nodes))]):
        cause = "The comma ends what `%` takes: the values behind it are not among those of the string."
        return Finding("made-wrong", cause, spot.place, f"write `{whole[0]}`")
    for use in (candidate for candidate in _uses(spot) if re.search(_RAISED_BY[kind], candidate.text)):
        for values in _stand_ins(use, message, spot.file):
            raised, printed = _said(use, use.text, values), f"{kind}: {message}"
            # A later Python may say more.
            if not raised or not (raised.startswith(printed) or printed.startswith(raised)):
                continue
            for text, old, new in use.changes(use.text, values):
                if not _said(use, text, values):
                    return _told(use, old, new, message, spot)
            break
    return None


def _told(use: _Use, old: str, new: str, message: str, spot: Spot) -> Finding:
    same = use.source is spot.file
    there = f"line {use.node.lineno}" if same and use.node.lineno != spot.line else "this line"
    there = there if same else use.source.at(use.node)
    cause = f"In the format string of {there}, `{old}` does not fit its value: {message}."
    fix = f"write `{new}` instead of `{old}`"
    if "for object of type 'str'" in message or "number is required, not str" in message:
        fix += "; or, if the string holds a number, float(...) around the value"
    return Finding("made-wrong", cause, use.source.at(use.node), fix)


def _uses(spot: Spot) -> Iterator[_Use]:
    """Yield the format strings that the statement on a line fills."""
    source = spot.file
    for node in (inner for line in spot.lines for inner in Spot(source, line).nodes):
        match node:
            case ast.Call(func=ast.Attribute(attr="format", value=named), args=args, keywords=keywords):
                values = [("", argument) for argument in args] + [
                    (keyword.arg or "", keyword.value) for keyword in keywords
                ]
                way, changes = "format", _changed_fields
            case ast.BinOp(left=named, op=ast.Mod(), right=right):
                values = _right_values(right)
                way, changes = "percent", _changed_percents
            case ast.FormattedValue(
                value=value, format_spec=ast.JoinedStr(values=[ast.Constant(value=str() as form)])
            ):
                yield _Use(node, source, form, [("", value)], _WAYS["f-string"], _changed_form)
                continue
            case _:
                continue
        home, held = held_once(source, named) or (source, named)
        is_plain = not any(isinstance(given, ast.Starred) for _, given in values)
        if is_plain and isinstance(held, ast.Constant) and isinstance(held.value, str):
            yield _Use(held, home, held.value, values, _WAYS[way], changes)


def _right_values(right: ast.expr) -> list[tuple[str, ast.expr]]:
    if isinstance(right, ast.Tuple):
        return [("", element) for element in right.elts]
    if isinstance(right, ast.Dict):
        pairs = zip(right.keys, right.values, strict=True)
        named = ((key.value, value) for key, value in pairs if isinstance(key, ast.Constant))
        return [(name, value) for name, value in named if isinstance(name, str)]
    return [("", right)]


def _said(use: _Use, text: str, values: _Values) -> str:
    """Return the error that filling a text raises; empty if it works."""
    if any(int(digits) > _WIDEST for digits in re.findall(r"\d+", text)):
        return "too wide"
    try:
        use.fill(text, values)
    except (AttributeError, LookupError, ValueError, TypeError, OverflowError) as error:
        return f"{type(error).__name__}: {error}"
    return ""


def _stand_ins(use: _Use, message: str, source: PythonSource) -> Iterator[_Values]:
    """Yield values like those that fill a text, the likeliest first."""
    named = re.search(r"(?:of type |^)'(\w+)'|not '?(\w+)'?$", message)
    said = next(filter(None, named.groups()), "") if named else ""
    kinds = [_kind(expression, source) for _, expression in use.values]
    for fallback in dict.fromkeys((said, "float", "str", "int")):
        if fallback:
            by_place: list[object] = []
            by_name: dict[str, object] = {}
            for kind, (name, node) in zip(kinds, use.values, strict=True):
                value = node.value if isinstance(node, ast.Constant) else _value(kind or fallback)
                if name:
                    by_name[name] = value
                else:
                    by_place.append(value)
            yield by_place, by_name


def _kind(node: ast.expr, source: PythonSource) -> str:
    kind = type_of(source, node) if not isinstance(node, ast.Constant) else ""
    plain = re.match(r"(?:\w+\.)*(\w+)$", kind)
    return plain[1] if plain and plain[1] not in ("Unknown", "Any", "object") else ""


def _value(kind: str) -> object:
    """Return a plain value of a type; for a message, an object with its fields."""
    if kind in _PLAIN:
        return _PLAIN[kind]
    fields = [
        name for home in interfaces.homes_of(kind) for name in interfaces.fields_of(f"{home}.{kind}") or ()
    ]
    return type(kind, (), dict.fromkeys(fields, 1.5))() if kind.isidentifier() else object()


def _changed_fields(text: str, values: _Values) -> Iterator[tuple[str, str, str]]:
    """Yield a str.format() text with one field changed: the whole text, the field before, and after."""
    for match in _FIELD.finditer(text):
        for inner in _other_fields(match[1], values):
            new = f"{{{inner}}}"
            yield f"{text[: match.start()]}{new}{text[match.end() :]}", match[0], new
    for match in _FIELD.finditer(text):
        new = f"{{{match[0]}}}"
        yield f"{text[: match.start()]}{new}{text[match.end() :]}", match[0], new
    # All braces that hold no field, as in JSON.
    whole = re.sub(r"\{(?!\w*[:}])|(?<![\w{:])\}", lambda match: match[0] * 2, text)
    yield whole, text, whole
    for match in re.finditer(r"[{}]", text):
        new = match[0] * 2
        yield (
            f"{text[: match.start()]}{new}{text[match.end() :]}",
            text,
            f"{text[: match.start()]}{new}{text[match.end() :]}",
        )


def _other_fields(inner: str, values: _Values) -> Iterator[str]:
    """Yield what may have been meant by the text between two braces."""
    field, colon, form = inner.partition(":")
    yield from () if colon else _with_form(field)
    yield from (f"{meant}{colon}{form}" for meant in _other_names(field, values))
    yield from (f"{field}:{new}".removesuffix(":") for new in _other_forms(form) if colon)


def _with_form(field: str) -> Iterator[str]:
    """Yield what may have been meant by a field that lacks the colon before its format."""
    if match := re.fullmatch(r"(\w*?)%?[.,](\d+)([a-zA-Z%]?)", field):
        yield f"{match[1]}:.{match[2]}{match[3] or 'f'}"
    if match := re.fullmatch(r"(\d*)%(\.\d+\w|\w)", field):
        yield f"{match[1]}:{match[2]}"


def _other_names(field: str, values: _Values) -> Iterator[str]:
    """Yield which value may have been meant: by another name, by position, or by an attribute."""
    by_place, by_name = values
    head, sign, rest = re.match(r"(\w*)(.?)(.*)", field, re.DOTALL).groups()  # type: ignore[union-attr]
    bare = field.strip(" '\"")
    yield from (name for name in [bare] if name in by_name and name != field)
    near = [nearest(head, by_name, 0.6)] if head not in by_name else []
    only = [*by_name] if len(by_name) == 1 and not by_place else []
    yield from (f"{name}{sign}{rest}" for name in (*near, *only) if name)
    if by_place and head not in by_name:
        yield rest if sign == "." else ""
    if sign == "[":
        yield head
    elif sign == ".":
        number = int(head or 0) if not head.strip("0123456789") else len(by_place)
        owner = by_name.get(head, next(iter(by_place[number:]), None))
        if meant := nearest(rest, dir(owner), 0.6):
            yield f"{head}.{meant}"


def _changed_form(text: str, _values: _Values) -> Iterator[tuple[str, str, str]]:
    """Yield what may have been meant by the format after the colon in an f-string."""
    yield from ((new, f":{text}", f":{new}".removesuffix(":")) for new in _other_forms(text))


def _other_forms(form: str) -> Iterator[str]:
    """Yield what may have been meant by a format such as `1f.`, for a value that does not take it."""
    digits = re.findall(r"\d+", form)
    letter = next(iter(re.findall(r"[eEfFgGd]", form)), "f")
    plain = re.sub(r"[a-zA-Z%]+$", "", form)
    before = re.match(r"(?:.?[<>^=])?[-+ ]?#?0?", form)
    begin = before[0] if before else ""
    if digits and letter != "d" and len(digits) == 1:
        yield f"{begin}.{digits[0]}{letter}"
    if len(digits) > 1 and letter != "d":
        yield f"{begin}{digits[0].lstrip('0') or ''}.{digits[1]}{letter}"
    if form.endswith("d"):
        yield f"{form[:-1]}.0f"
    yield re.sub(r"\.\d+", "", plain)  # a precision would cut off a string
    yield ""


def _changed_percents(text: str, values: _Values) -> Iterator[tuple[str, str, str]]:
    """Yield a text for % with one of its placeholders changed."""
    for match in _PERCENT.finditer(text):
        name, form = match["name"], match["form"]
        near = nearest(name, values[1], 0.6)
        called = f"({name})" if name is not None else ""
        letters = [f"%{called}{form}f"] if "." in form or form.isdigit() else []
        others = [f"%({near}){form}{match['letter']}"] if near else []
        for new in [*others, *letters, f"%{called}{re.sub('[.].*', '', form)}s", f"%{match[0]}"]:
            # Keep the next character where the conversion letter is missing.
            more = match["letter"] if not match["letter"].isalpha() and not new.startswith("%%") else ""
            yield f"{text[: match.start()]}{new}{more}{text[match.end() :]}", match[0].rstrip(), new.rstrip()
