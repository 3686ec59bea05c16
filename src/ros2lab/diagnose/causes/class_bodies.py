"""Errors raised while a class is created: Python names its first line, but they are about a field."""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Callable

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import PythonSource

_Field = ast.Assign | ast.AnnAssign
_Said = Callable[["_Body", re.Match[str]], tuple[str, str] | None]


class _Body:
    """A class that cannot be made, and the field that is to blame; both are empty if they are not known."""

    def __init__(self, source: PythonSource, definition: ast.ClassDef | None, name: str, line: int) -> None:
        self.source, self.definition, self.name, self._line = source, definition, name, line
        self.fields = {target: node for node in _fields(definition) for target in _names(node)}

    @property
    def field(self) -> _Field | None:
        """The statement that makes the field."""
        return self.fields.get(self.name)

    @property
    def line(self) -> int:
        """The line to change."""
        return self.field.lineno if self.field else self._line

    def imported(self, name: str) -> tuple[str, str]:
        """Return how a name from dataclasses is written here, and the import that it needs; empty if none."""
        known = {imported.target: imported.local for imported in self.source.imports}
        if f"dataclasses.{name}" in known:
            return known[f"dataclasses.{name}"], ""
        if "dataclasses" in known:
            return f"{known['dataclasses']}.{name}", ""
        return name, f", with `from dataclasses import {name}` at the top"


def of_class_body(kind: str, message: str, spot: Spot) -> Finding | None:
    """Return a finding about the field that keeps a class from being created; None if there is none."""
    source = spot.file
    if kind not in ("TypeError", "ValueError", "AttributeError"):
        return None
    definition = _class_at(source, spot.line)
    is_call = any(isinstance(n, ast.Call) and ast.unparse(n.func).endswith("namedtuple") for n in spot.nodes)
    if definition is None and not is_call:
        return None
    words = re.findall(r"\w+", message)
    known = {target for node in _fields(definition) for target in _names(node)}
    body = _Body(source, definition, next((word for word in words if word in known), ""), spot.line)
    for pattern, said in _SAYINGS:
        if (match := re.search(pattern, message)) and (told := said(body, match)):
            return Finding("made-wrong", told[0], source.at(body.line), told[1])
    if body.field is None:
        return None
    cause = f"The class {definition.name if definition else ''} cannot be created because of {body.name}: {message}."
    return Finding(
        "made-wrong", cause, source.at(body.line), f"fix {body.name} on this line as the message says"
    )


def _class_at(source: PythonSource, line: int) -> ast.ClassDef | None:
    """Return the class whose decorators, first line or fields include a line; None if there is none."""
    for node in source.nodes:
        if isinstance(node, ast.ClassDef):
            begin = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
            if begin <= line < node.body[0].lineno or any(
                field.lineno <= line <= (field.end_lineno or 0) for field in _fields(node)
            ):
                return node
    return None


def _fields(definition: ast.ClassDef | None) -> list[_Field]:
    body = definition.body if definition else []
    return [node for node in body if isinstance(node, (ast.Assign, ast.AnnAssign))]


def _names(node: _Field) -> list[str]:
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    return [ast.unparse(target) for target in targets]


def _mutable(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    node = body.field
    if node is None or node.value is None:
        return None
    value, text = node.value, ast.unparse(node.value)
    empty = {"[]": "list", "{}": "dict", "set()": "set"}
    is_bare = isinstance(value, ast.Call) and not value.args and not value.keywords
    made = empty.get(text) or (ast.unparse(value.func) if is_bare else f"lambda: {text}")  # type: ignore[attr-defined]
    name, needs = body.imported("field")
    kind = f": {ast.unparse(node.annotation)}" if isinstance(node, ast.AnnAssign) else ""
    cause = f"{body.name} has the default `{text}`, which all instances would share; dataclass does not allow that."
    return cause, f"write {body.name}{kind} = {name}(default_factory={made}){needs}"


def _late(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    """Return cause and fix for a field without a default that comes after one with a default."""
    node = body.field
    if node is None:
        return None
    before = [
        field for field in body.fields.values() if field.value is not None and field.lineno < node.lineno
    ]
    kind = ast.unparse(node.annotation) if isinstance(node, ast.AnnAssign) else ""
    example = {"float": "0.0", "int": "0", "str": "''", "bool": "False"}.get(kind, "None")
    default = f"`{body.name}: {kind} = {example}`"
    if not before:
        cause = f"{body.name} has no default, but a field of the base class has one."
        return cause, f"write {default.strip(chr(96))}"
    cause = f"{body.name} has no default but comes after {_names(before[0])[0]}, which has one."
    return cause, f"move this line above line {before[0].lineno}, or give it a default, as in {default}"


def _without_type(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    node = body.field
    if not isinstance(node, ast.Assign):
        return None
    factory = re.search(r"default_factory=(\w+)", ast.unparse(node.value))
    default = re.search(r"default=(-?[\d.]+|['\"])", ast.unparse(node.value))
    plain = {"'": "str", '"': "str"}
    number = (plain.get(default[1]) or ("float" if "." in default[1] else "int")) if default else "..."
    kind = factory[1] if factory and factory[1] != "lambda" else number
    cause = f"{body.name} is made with field() but has no type."
    fix = f"write {body.name}: {kind} = {ast.unparse(node.value)}"
    return cause, fix


def _twice(body: _Body, match: re.Match[str]) -> tuple[str, str] | None:
    first = next((field for field in _fields(body.definition) if match["name"] in _names(field)), None)
    if first is None or body.field is None or first is body.field:
        return None
    cause = f"{body.name} is already on line {first.lineno}, but each member of an Enum needs its own name."
    return cause, "give it another name on this line, or remove the line"


def _equal(body: _Body, match: re.Match[str]) -> tuple[str, str] | None:
    name, other = match["name"], match["other"]
    if other not in body.fields or name not in body.fields:
        return None
    value = ast.unparse(body.fields[other].value or ast.Constant(None))
    cause = f"{name} has the same value as {other} on line {body.fields[other].lineno}, {value}, but @unique allows each value only once."
    return cause, f"give {name} another value on this line, or remove @unique"


def _bad_name(_body: _Body, match: re.Match[str]) -> tuple[str, str]:
    name = match["name"]
    new = re.sub(r"\W", "_", name).strip("_") or "value"
    new = f"{new}_" if keyword.iskeyword(new) else f"x{new}" if new[0].isdigit() else new
    cause = f"{name!r} cannot be a field of a named tuple: the name must consist of letters, digits and _, must not begin with _, and must not be a Python keyword."
    return cause, f"write {new} instead of {name}, here and wherever it is used"


def _frozen(body: _Body, match: re.Match[str]) -> tuple[str, str] | None:
    if body.definition is None:
        return None
    name, _ = body.imported("dataclass")
    bases = ", ".join(map(ast.unparse, body.definition.bases))
    wanted = "(frozen=True)" if match["kind"] == "non-frozen" else ""
    cause = f"{bases} is {'' if wanted else 'not '}frozen, so its subclasses must {'be frozen too' if wanted else 'not be frozen either'}."
    return cause, f"write @{name}{wanted} above the class {body.definition.name}"


def _extended(_body: _Body, match: re.Match[str]) -> tuple[str, str]:
    base = match["base"]
    cause = f"{base} is an Enum with members, so it cannot be subclassed."
    fix = f"write Enum instead of {base} in the parentheses, and write all the members in this class"
    return cause, fix


def _order(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    bases = [*map(ast.unparse, body.definition.bases)] if body.definition else []
    if len(bases) < 2 or body.definition is None:
        return None
    swapped = ", ".join([*bases[1:], bases[0]])
    cause = (
        f"In the parentheses of {body.definition.name}, {bases[0]} comes before one of its own subclasses."
    )
    return cause, f"write class {body.definition.name}({swapped}):"


def _twice_a_base(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    if body.definition is None:
        return None
    bases = ", ".join(dict.fromkeys(map(ast.unparse, body.definition.bases)))
    return "A class is listed twice in the parentheses.", f"write class {body.definition.name}({bases}):"


def _slots(body: _Body, _match: re.Match[str]) -> tuple[str, str] | None:
    if not body.name:
        return None
    cause = f"{body.name} is in __slots__, but the class also gives it a value."
    return cause, f"remove this line, and set self.{body.name} in __init__"


# What Python says while it creates a class, and what that means for its body; the first match counts.
_SAYINGS: tuple[tuple[str, _Said], ...] = (
    (r"mutable default .* for field \w+ is not allowed", _mutable),
    (r"(?i)non-default (?:argument|namedtuple field) '?\w+'? (?:follows|cannot follow)", _late),
    (r"is a field but has no type annotation", _without_type),
    (r"'(?P<name>\w+)' already defined as|[Aa]ttempted to reuse key: '(?P<name2>\w+)'", _twice),
    (r"duplicate values found in .*?: (?P<name>\w+) -> (?P<other>\w+)", _equal),
    (r"ield names (?:cannot|must) .*: '(?P<name>.+)'", _bad_name),
    (r"cannot inherit (?P<kind>non-frozen|frozen) dataclass", _frozen),
    (r"cannot extend (?:<enum '|enumeration ')?(?P<base>\w+)", _extended),
    (r"consistent method resolution", _order),
    (r"duplicate base class", _twice_a_base),
    (r"in __slots__ conflicts with class variable", _slots),
)
