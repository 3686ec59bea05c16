"""What is made and filled to be given to others: messages, and the parts of services and actions."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ros2lab.diagnose.sources.interfaces import field_kind, fields_of
from ros2lab.diagnose.sources.liveness import GROWS
from ros2lab.diagnose.sources.python_source import PythonSource, assignments
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_of
from ros2lab.diagnose.sources.uses import Uses, is_log

_PART = r"Request|Response|Goal|Result|Feedback"


@dataclass(frozen=True)
class Fill:
    """A statement that gives a field a value; the value is None where it only adds to what there is."""

    field: str
    statement: ast.stmt
    value: ast.expr | None


@dataclass
class Filled:
    """A message, or a part of a service or an action, that a name stands for and nothing else.

    Attributes:
        name: as it is written, such as `msg` or `self.msg`.
        kind: its full type, such as `std_srvs.srv.SetBool.Response`.
        made: the statements that make it; none if ROS does.
        fills: what gives its fields a value, in order.
        sent: the calls and returns that give it to others.
        shown: where a log shows it.
        others: all else that may read or fill it.
    """

    name: str
    kind: str
    made: list[ast.stmt] = field(default_factory=list)
    fills: list[Fill] = field(default_factory=list)
    sent: list[ast.Call | ast.Return] = field(default_factory=list)
    shown: list[ast.AST] = field(default_factory=list)
    others: list[ast.AST] = field(default_factory=list)

    @property
    def is_empty(self) -> bool:
        """Whether all its fields have their defaults."""
        return not self.fills and not self.others

    def is_set(self, path: str) -> bool:
        """Return whether a field, or what it is a part of, or a part of it, gets a value."""
        return is_among(f"{self.name}.{path}", (fill.field for fill in self.fills))


def is_among(path: str, filled: Iterable[str]) -> bool:
    """Return whether a field, or what it is a part of, or a part of it, is among some."""
    return any(
        f"{path}.".startswith(f"{one}.") or re.match(rf"{re.escape(path)}[.\[]", one) for one in filled
    )


Unset = tuple[Filled, str, str]  # what is sent, and the path and type of a field that stays at its default


def unset_in(objects: Iterable[Filled]) -> Iterator[Unset]:
    """Yield the fields that stay at their defaults in what is sent, as far as all that fills it is known."""
    for own in objects:
        if own.sent and not own.others:
            fields = fields_below(own.kind).items()
            yield from ((own, path, field_kind(of) or of) for path, of in fields if not own.is_set(path))


def kind_of(source: PythonSource, value: ast.AST | None) -> str:
    """Return the type that a call makes anew, such as `std_msgs.msg.String`; empty for any other expression."""
    kind = (source.resolve(value.func) or "") if isinstance(value, ast.Call) else ""
    return kind if re.fullmatch(rf"\w+\.(msg\.\w+|(srv|action)\.\w+\.({_PART}))", kind) else ""


def fields_below(kind: str, depth: int = 4) -> Mapping[str, str]:
    """Return the types of all fields of a type, also of those inside others, by their paths."""
    found = dict[str, str]()
    whole = re.sub(rf"\.({_PART})$", r"_\1", kind)
    for name, of in (fields_of(whole) or {}).items():
        found[name] = of
        if depth and (inner := field_kind(of)) and "." in inner:
            found |= {f"{name}.{path}": below for path, below in fields_below(inner, depth - 1).items()}
    return found


def filled_in(
    uses: Uses, source: PythonSource, nodes: Sequence[ast.AST], given: Mapping[str, str] = {}, begin: str = ""
) -> dict[str, Filled]:
    """Return what some code makes and keeps under a name that stands for nothing else, by the name.

    Args:
        uses: what the package's files use.
        source: the file.
        nodes: the syntax nodes of the code.
        given: the types of what ROS makes for it, by their names.
        begin: with what the names begin: `self.` for attributes, else variables are meant.
    """
    found = {name: Filled(name, kind) for name, kind in given.items()}
    foreign = set[str]()
    for target, value in assignments(nodes):
        name, kind = dotted(target) or "", kind_of(source, value)
        if not name.startswith(begin) or name.count(".") != begin.count(".") or not name:
            continue
        own, statement = found.setdefault(name, Filled(name, "")), statement_of(source, target)
        own.kind = own.kind or kind
        is_copy = isinstance(value, ast.Call) and (source.resolve(value.func) or "").startswith("copy.")
        is_alone = len(getattr(statement, "targets", [target])) == 1
        foreign |= set() if is_alone and (is_copy or kind == own.kind != "") else {name}
        own.made.append(statement)
        if isinstance(value, ast.Call):
            keywords = [(f"{name}.{item.arg}" if item.arg else name, item.value) for item in value.keywords]
            whole = [(name, item) for item in value.args]
            own.fills += [Fill(key, statement, item) for key, item in (*keywords, *whole)]
    found = {name: own for name, own in found.items() if name not in foreign and own.kind}
    for node in nodes:
        used = found.get(dotted(node) or "") if isinstance(node, (ast.Name, ast.Attribute)) else None
        if used is not None and isinstance(node, ast.expr):
            _note_use(uses, source, used, node)
    for own in found.values():
        own.fills.sort(key=lambda fill: (fill.statement.lineno, fill.statement.col_offset))
    return found


def _note_use(uses: Uses, source: PythonSource, own: Filled, node: ast.expr) -> None:
    *_, whole = parts = [*_parts_on(source, node)]
    around, statement = source.above(whole), statement_of(source, whole)
    call = source.above(around) if isinstance(around, ast.keyword) else around
    if len(parts) == 1 and not isinstance(getattr(node, "ctx", None), ast.Load):
        if statement not in own.made:
            own.others.append(node)
    elif not isinstance(getattr(whole, "ctx", None), ast.Load):
        value = next((v for target, v in assignments([statement]) if target is whole), None)
        own.fills.append(Fill(ast.unparse(whole), statement, value))
    elif len(parts) == 1 and (isinstance(around, ast.Return) or calls_of([call or node], *uses.senders)):
        own.sent.append(call if isinstance(call, ast.Call) else around)  # type: ignore[arg-type]
    elif _grows(source, whole, around):
        own.fills.append(Fill(ast.unparse(whole.value), statement, None))  # type: ignore[attr-defined]
    else:
        is_shown = any(is_log(outer) for outer in around_of(source, whole))
        (own.shown if is_shown else own.others).append(node)


def _parts_on(source: PythonSource, node: ast.expr) -> Iterator[ast.expr]:
    """Yield an expression, and the attributes and items of it that it is written with."""
    yield node
    outer = source.above(node)
    if isinstance(outer, (ast.Attribute, ast.Subscript)) and outer.value is node:
        yield from _parts_on(source, outer)


def _grows(source: PythonSource, whole: ast.expr, call: ast.AST | None) -> bool:
    is_called = isinstance(call, ast.Call) and call.func is whole and getattr(whole, "attr", "") in GROWS
    return is_called and call is not None and isinstance(source.above(call), ast.Expr)


def around_of(source: PythonSource, node: ast.AST) -> Iterator[ast.AST]:
    """Yield what is around a node up to its statement, which is the last."""
    while not isinstance(node, ast.stmt) and (outer := source.above(node)) is not None:
        yield outer
        node = outer


def statement_of(source: PythonSource, node: ast.AST) -> ast.stmt:
    """Return the innermost statement around an expression, or the statement itself."""
    *_, found = (node, *around_of(source, node))
    assert isinstance(found, ast.stmt)
    return found
