"""Tries edits of a line in copies of its file, which the type checker and the rules then check."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import cached_property

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.checking.edits import Edit, all_applied, copied
from ros2lab.diagnose.finding import stops_node
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.python_source import Function, PythonSource, names_bound, own_nodes, parameters
from ros2lab.diagnose.sources.syntax_parts import own_parameters, stores_in
from ros2lab.diagnose.sources.uses import own_stores

_LONGEST = 110  # characters of a statement that is shown in full
UNKNOWN_TYPE = re.compile(r"\b(?:Unknown|Any|Never)\b|^object$")


class Trial:
    """A line of a file, and the copies of the file that the type checker checks."""

    def __init__(self, source: PythonSource, spot: Spot, look: Look) -> None:
        self.source, self.spot, self.look = source, spot, look
        self.lines = all_applied(source.lines, message_annotations(source, look))
        self.statement = statement_of(spot)
        self._before, self._kinds = self._first_look()

    @property
    def objections(self) -> list[Row]:
        """The messages of the type checker about the unchanged line."""
        return [row for row in self._before if row.line in self.spot.lines]

    def kind(self, text: str) -> str:
        """Return the type of an expression on the line, or of a name in scope; empty if it is unknown."""
        kind = self._kinds.get(text, "")
        return "" if UNKNOWN_TYPE.search(kind) else kind

    def is_open(self, text: str) -> bool:
        """Return whether a text calls a function with an unknown return type."""
        called = re.findall(r"([\w.]+)\(", text)
        return any(self._kinds.get(name, "").endswith("-> Unknown") for name in called)

    def expressions(self) -> list[ast.expr]:
        """Return the expressions on the statement's own lines, those that Python marks first."""
        if self.statement is None:
            return []
        head = set(self.spot.lines)
        found = [n for n in ast.walk(self.statement) if isinstance(n, ast.expr) and n.lineno in head]
        marked = self.spot.marked
        inner = {ast.unparse(n) for n in ast.walk(marked) if isinstance(n, ast.expr)} if marked else set()
        return sorted(found, key=lambda node: ast.unparse(node) not in inner) if inner else found

    def stands(self, edits: Sequence[Edit]) -> list[bool]:
        """Return for each edit whether the type checker accepts its lines and reports nothing new elsewhere.

        An edit that changes nothing or loses names is not accepted.
        """
        texts = [edit.with_imports(self.source, self.lines) for edit in edits]
        known = Counter((row.rule, row.said) for row in self._before if row.line not in self.spot.lines)
        found = []
        for edit, rows in zip(edits, checked(self.source, texts), strict=True):
            grown = len(edit.text.splitlines()) - (edit.node.end_lineno or 0) + edit.node.lineno - 1
            own = {*self.spot.lines, edit.node.lineno} | {self.spot.lines.stop - 1 + grown}
            is_clean = not any(row.line in own for row in rows)
            is_same = edit.is_idle(self.source) or not edit.keeps_names(self.source)
            new = Counter((row.rule, row.said) for row in rows) - known
            found.append(is_clean and not new and not is_same)
        return found

    def is_right(self, edit: Edit) -> bool:
        """Return whether the rules find no fault on the lines of an edit."""
        copied = self._copied(edit)
        places = {copied.at(line) for line in {*self.spot.lines, edit.node.lineno}}
        return not any(finding.place in places and stops_node(finding) for finding in text_faults(copied))

    def told(self, edit: Edit) -> str:
        """Return what to write: the whole statement on one line, or only the edit if that is too long."""
        spot = Spot(self._copied(edit), edit.node.lineno)
        if len(spot.lines) == 1:
            return f"`{spot.text.partition('  #')[0]}`"
        statement = statement_of(spot)
        lines = ast.unparse(statement).splitlines() if statement else []
        whole = next((line for line in lines if not line.startswith("@")), "")
        is_short = 0 < len(whole) <= _LONGEST
        return f"`{whole}`" if is_short else f"`{edit.text}` instead of `{ast.unparse(edit.node)}`"

    def copy_with(self, edit: Edit) -> bytes:
        """Return the file with an edit and the imports that it needs."""
        return edit.with_imports(self.source, self.source.lines)

    def _copied(self, edit: Edit) -> PythonSource:
        return copied(self.source, edit.of(self.source))

    def _first_look(self) -> tuple[list[Row], dict[str, str]]:
        """Return the messages about the unchanged file, and the types of what is on the line or in scope."""
        texts = list(dict.fromkeys([*map(ast.unparse, self.expressions()), *self.names]))
        before, rows = checked(self.source, [b"".join(self.lines), self._revealing(texts)])
        return before, _revealed(texts, rows)

    def asked_of(self, edit: Edit) -> list[str]:
        """Return the expressions around an edit whose members are used: `self.b()` in `self.b().now`."""
        source = self.spot.source or self.source
        found, node, text = list[str](), source.above(edit.node), edit.text
        below: ast.AST = edit.node
        while isinstance(node, (ast.Attribute, ast.Call)):
            if isinstance(node, ast.Attribute):
                found.append(text)
                text = f"{text}.{node.attr}"
            elif node.func is below:
                values = [*map(ast.unparse, (*node.args, *node.keywords))]
                text = f"{text}({', '.join(values)})"
            else:
                break
            below, node = node, source.above(node)
        return found

    def kinds_of(self, texts: Sequence[str]) -> dict[str, str]:
        """Return the types of some expressions on the line; empty if they are not known."""
        return _revealed(texts, checked(self.source, [self._revealing(texts)])[0])

    def _revealing(self, texts: Sequence[str]) -> bytes:
        anchor = _anchor(self.statement)
        if anchor is None:
            return b""
        asked = "".join(f"reveal_type({text}), " for text in texts)
        written = ast.get_source_segment(self.source.text, anchor) or ast.unparse(anchor)
        revealing = Edit(anchor, f"({asked}{' '.join(written.split())})[-1]")
        return b"".join(revealing.applied(self.lines))

    @cached_property
    def names(self) -> list[str]:
        """The names in scope on the line: the attributes of self, and parameters and variables."""
        owner, function = self.owner, self.spot.function
        found = [f"self.{name}" for name in sorted(own_stores(owner.definition))] if owner else []
        if isinstance(function, Function):
            found += [parameter.arg for parameter in parameters(function) if parameter.arg != "self"]
            stored = (n for n in stores_in(own_nodes(function)) if n.lineno < self.spot.line)
            found += [n.id for n in stored if isinstance(n, ast.Name)]
        return list(dict.fromkeys(found))

    @cached_property
    def owner(self) -> NodeClass | None:
        """The class around the line."""
        around = self.source.around(self.spot.line, ast.ClassDef)
        sources = (self.look.sources(package) for package in self.look.packages)
        known = (candidate for own in sources for candidate in own.classes.values())
        return next((candidate for candidate in known if candidate.definition in around), None)


def type_of(source: PythonSource, expression: ast.expr) -> str:
    """Return the type of an expression, as the type checker writes it; empty if it is not known."""
    return revealed_by(source, Edit(expression, f"reveal_type({ast.unparse(expression)})"))


def revealed_by(source: PythonSource, edit: Edit) -> str:
    """Return the type that an edit with `reveal_type` asks for; empty if it is not known."""
    (rows,) = checked(source, [edit.of(source)])
    there = [row for row in rows if row.rule == "revealed-type" and row.line == edit.node.lineno]
    return _revealed([""], there[:1]).get("", "")


def _revealed(texts: Sequence[str], rows: Sequence[Row]) -> dict[str, str]:
    kinds = kinds_in(rows)
    return dict(zip(texts, kinds, strict=True)) if len(kinds) == len(texts) else {}


def kinds_in(rows: Sequence[Row]) -> list[str]:
    """Return the types that the type checker was asked for, in the order of the lines."""
    return [re.sub(r"^.*?`(.*)`$", r"\1", row.said) for row in rows if row.rule == "revealed-type"]


_RECEIVED = {"create_subscription": ("",), "create_service": (".Request", ".Response")}  # parts of the type


def message_annotations(source: PythonSource, look: Look) -> Iterator[Edit]:
    """Yield edits that annotate the parameters of callbacks with the types of what they receive."""
    for package in look.packages:
        known = look.sources(package)
        for creation, function in known.callbacks() if source in package.sources.values() else ():
            given = creation.given("msg_type") or creation.given("srv_type")
            parts = _RECEIVED.get(creation.method, ()) if given and creation.source is source else ()
            for name, part in zip(own_parameters(function), parts, strict=False):
                is_open = name.annotation is None and name.lineno == name.end_lineno
                # A name that is reassigned may not hold a message any more.
                if given and is_open and name.arg not in names_bound(own_nodes(function)):
                    here = ast.Name(name.arg, lineno=name.lineno, col_offset=name.col_offset)
                    here.end_lineno, here.end_col_offset = name.end_lineno, name.end_col_offset
                    yield Edit(here, f"{name.arg}: '{ast.unparse(given)}{part}'")


def statement_of(spot: Spot) -> ast.stmt | None:
    """Return the statement that begins in the lines of a spot; None if none does."""
    nodes = spot.source.nodes if spot.source else ()
    return next((n for n in nodes if isinstance(n, ast.stmt) and n.lineno == spot.lines.start), None)


def _anchor(statement: ast.stmt | None) -> ast.expr | None:
    """Return an expression that a statement always evaluates; None if there is none."""
    match statement:
        case ast.With(items=[item, *_]):
            return item.context_expr
        case None:
            return None
    for name in ("value", "test", "iter", "exc", "subject"):
        if isinstance(found := getattr(statement, name, None), ast.expr):
            return found
    return None
