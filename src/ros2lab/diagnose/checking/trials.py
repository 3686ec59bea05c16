"""A line of a file, tried: copies of the file in which it is changed, and what the type checker and the rules say of them."""

from __future__ import annotations

import ast
import copy
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.finding import stops_node
from ros2lab.diagnose.look import Look, text_faults
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.calls import missing_imports
from ros2lab.diagnose.sources.interfaces import has_name
from ros2lab.diagnose.sources.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, children, own_nodes, parameters

_LONGEST = 110  # letters of a statement that is told as a whole
UNKNOWN_TYPE = re.compile(r"\b(?:Unknown|Any|Never)\b|^object$")


@dataclass(frozen=True)
class Edit:
    """Another text for an expression or a statement."""

    node: ast.expr | ast.stmt
    text: str

    def applied(self, lines: Sequence[bytes]) -> list[bytes]:
        """Return the lines of a file with the other text."""
        node = self.node
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        return [*lines[:first], before + self.text.encode() + after, *lines[last + 1 :]]

    def is_idle(self, source: PythonSource) -> bool:
        """Return whether the other text means just what stood there, as `str('a')` does instead of `'a'`."""
        try:
            new = ast.parse(self.text.strip()).body
        except (SyntaxError, ValueError):
            return False
        old = [self.node if isinstance(self.node, ast.stmt) else ast.Expr(self.node)]
        return [ast.unparse(_Bare(source).visit(copy.deepcopy(one))) for one in new] == [
            ast.unparse(_Bare(source).visit(ast.parse(ast.unparse(one)).body[0])) for one in old
        ]

    def keeps_names(self, source: PythonSource) -> bool:
        """Return whether nothing is lost that is set here alone and used elsewhere."""
        try:
            new = ast.parse(self.text.strip())
        except (SyntaxError, ValueError):
            return True
        lost = _stored(self.node) - _stored(new)
        if not lost:
            return True
        inside = {id(node) for node in ast.walk(self.node)}
        others = [node for node in source.nodes if id(node) not in inside]
        lost -= {name for node in others for name in _stored(node, is_deep=False)}
        return not any(
            isinstance(node, (ast.Name, ast.Attribute)) and ast.unparse(node) in lost for node in others
        )


class _Bare(ast.NodeTransformer):
    """Takes away what makes a plain value into one of the type that it has already."""

    def __init__(self, source: PythonSource) -> None:
        self.source = source

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        match node:
            case ast.Call(
                func=ast.Name(id="str" | "int" | "float" | "bool" as kind), args=[value], keywords=[]
            ):
                made = Spot(self.source, 0).assigned(ast.unparse(value))
                known = made[0] if len(made) == 1 else value
                is_text = isinstance(known, ast.JoinedStr) and kind == "str"
                is_of_kind = isinstance(known, ast.Constant) and type(known.value).__name__ == kind
                return value if is_text or is_of_kind else node
        return node


def _stored(node: ast.AST, *, is_deep: bool = True) -> set[str]:
    """Return the names and attributes that something is assigned to in a part of a file."""
    nodes = ast.walk(node) if is_deep else [node]
    kinds = (ast.Name, ast.Attribute)
    return {ast.unparse(one) for one in nodes if isinstance(one, kinds) and isinstance(one.ctx, ast.Store)}


class Trial:
    """A file whose copies the type checker is asked about."""

    def __init__(self, source: PythonSource, spot: Spot, look: Look) -> None:
        self.source, self.spot, self.look = source, spot, look
        self.lines = source.text.encode().splitlines(keepends=True)
        for edit in sorted(
            message_annotations(source, look), key=lambda one: one.node.col_offset, reverse=True
        ):
            self.lines = edit.applied(self.lines)
        self.statement = statement_of(spot)
        self._before, self._kinds = self._first_look()

    @property
    def objections(self) -> list[Row]:
        """What the type checker says of the line as it is."""
        return [row for row in self._before if row.line in self.spot.lines]

    def kind(self, text: str) -> str:
        """Return the type of an expression in the line, or of a name that can be used there; empty if unknown."""
        kind = self._kinds.get(text, "")
        return "" if UNKNOWN_TYPE.search(kind) else kind

    def is_undefined(self, name: str) -> bool:
        """Return whether the type checker knows nothing of a name."""
        return any(row.rule == "unresolved-reference" and f"`{name}`" in row.said for row in self.objections)

    def modules_with(self, name: str) -> list[str]:
        """Return under which names the file has imported modules that have a name."""
        modules = [(one.local, one.target) for one in self.source.imports if not one.is_from]
        return [local for local, target in modules if has_name(target, name)]

    def is_open(self, text: str) -> bool:
        """Return whether a text calls a function of which the type checker does not know what it gives."""
        called = re.findall(r"([\w.]+)\(", text)
        return any(self._kinds.get(name, "").endswith("-> Unknown") for name in called)

    def expressions(self) -> list[ast.expr]:
        """Return the expressions of the statement's own lines, those first that Python marks."""
        if self.statement is None:
            return []
        head = set(self.spot.lines)
        found = [n for n in ast.walk(self.statement) if isinstance(n, ast.expr) and n.lineno in head]
        marked = self.spot.marked
        inner = {ast.unparse(n) for n in ast.walk(marked) if isinstance(n, ast.expr)} if marked else set()
        return sorted(found, key=lambda node: ast.unparse(node) not in inner) if inner else found

    def stands(self, edits: Sequence[Edit]) -> list[bool]:
        """Return of each edit whether the type checker has nothing against its lines, nor anything new elsewhere."""
        texts = [b"".join(self._with_imports(edit)) for edit in edits]
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
        """Return whether the rules find nothing in the lines of an edit."""
        text = b"".join(edit.applied(self.source.text.encode().splitlines(keepends=True))).decode()
        copy = PythonSource(self.source.name, self.source.shown, text, self.source.is_package)
        places = {copy.at(line) for line in {*self.spot.lines, edit.node.lineno}}
        return not any(one.place in places and stops_node(one) for one in text_faults(copy))

    def told(self, edit: Edit) -> str:
        """Return what is to be written: the whole statement in one line, or the edit alone where that is too long."""
        text = b"".join(edit.applied(self.source.text.encode().splitlines(keepends=True))).decode()
        copied = PythonSource(self.source.name, self.source.shown, text, self.source.is_package)
        spot = Spot(copied, edit.node.lineno)
        if len(spot.lines) == 1:
            return f"`{spot.text.partition('  #')[0]}`"
        statement = statement_of(spot)
        lines = ast.unparse(statement).splitlines() if statement else []
        whole = next((line for line in lines if not line.startswith("@")), "")
        is_short = 0 < len(whole) <= _LONGEST
        return f"`{whole}`" if is_short else f"`{edit.text}` instead of `{ast.unparse(edit.node)}`"

    def copy_with(self, edit: Edit) -> bytes:
        """Return the file with an edit, and the imports that it needs."""
        lines = self.source.text.encode().splitlines(keepends=True)
        added = [f"\n{line}".encode() for line in missing_imports(self.source, edit.text)]
        return b"".join([*edit.applied(lines), *added])

    def _with_imports(self, edit: Edit) -> list[bytes]:
        added = [f"\n{line}".encode() for line in missing_imports(self.source, edit.text)]
        return [*edit.applied(self.lines), *added]

    def _first_look(self) -> tuple[list[Row], dict[str, str]]:
        """Ask what is wrong with the file as it is, and of which types what stands in the line is, and can be used there."""
        texts = list(dict.fromkeys([*map(ast.unparse, self.expressions()), *self.names]))
        before, rows = checked(self.source, [b"".join(self.lines), self._revealing(texts)])
        return before, _revealed(texts, rows)

    def asked_of(self, edit: Edit) -> list[str]:
        """Return what a member is asked of above an edit, with its text: `self.b()` in `self.a().now`, where a becomes b."""
        above = {
            id(inner): node for node in ast.walk(self.statement or ast.Pass()) for inner in children(node)
        }
        found, node, text = list[str](), above.get(id(edit.node)), edit.text
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
            below, node = node, above.get(id(node))
        return found

    def kinds_of(self, texts: Sequence[str]) -> dict[str, str]:
        """Return of which types some expressions are in the line; nothing where that is not known."""
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
        """What a value may be asked of in the line: the attributes of its class, and the names of its function."""
        owner, function = self.owner, self.spot.function
        found = [f"self.{name}" for name in sorted(_assigned_to_self(owner.definition))] if owner else []
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef)):
            found += [one.arg for one in parameters(function) if one.arg != "self"]
            found += [
                n.id
                for n in own_nodes(function)
                if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store) and n.lineno < self.spot.line
            ]
        return list(dict.fromkeys(found))

    @cached_property
    def owner(self) -> NodeClass | None:
        """The class around the line."""
        sources = (self.look.sources(package) for package in self.look.packages)
        for one in (one for known in sources for one in known.classes.values()):
            definition = one.definition
            if one.source is self.source and definition.lineno <= self.spot.line <= (
                definition.end_lineno or 0
            ):
                return one
        return None


def type_of(source: PythonSource, expression: ast.expr) -> str:
    """Return the type of an expression of a file, as the type checker has it; empty if it cannot be asked."""
    lines = source.text.encode().splitlines(keepends=True)
    asked = b"".join(Edit(expression, f"reveal_type({ast.unparse(expression)})").applied(lines))
    (rows,) = checked(source, [asked])
    there = [row for row in rows if row.rule == "revealed-type" and row.line == expression.lineno]
    return _revealed([""], there[:1]).get("", "")


def _revealed(texts: Sequence[str], rows: Sequence[Row]) -> dict[str, str]:
    kinds = [re.sub(r"^.*?`(.*)`$", r"\1", row.said) for row in rows if row.rule == "revealed-type"]
    return dict(zip(texts, kinds, strict=True)) if len(kinds) == len(texts) else {}


def message_annotations(source: PythonSource, look: Look) -> Iterator[Edit]:
    """Yield the type of what each callback receives, as the subscription names it, after its parameter."""
    for package in look.packages:
        known = look.sources(package)
        for creation, function in known.callbacks() if source in package.sources.values() else ():
            given = (creation.arguments or {}).get("msg_type")
            names = [one for one in parameters(function) if one.arg not in ("self", "cls")]
            if creation.method == "create_subscription" and given and creation.source is source and names:
                is_open = names[0].annotation is None and names[0].lineno == names[0].end_lineno
                # A name that is given something else holds a message no more.
                is_open &= not any(
                    isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store) and n.id == names[0].arg
                    for n in own_nodes(function)
                )
                if is_open:
                    here = ast.Name(names[0].arg, lineno=names[0].lineno, col_offset=names[0].col_offset)
                    here.end_lineno, here.end_col_offset = names[0].end_lineno, names[0].end_col_offset
                    yield Edit(here, f"{names[0].arg}: {ast.unparse(given)!r}")


def _statements(source: PythonSource) -> list[ast.stmt]:
    """Return the statements of a file, the innermost first."""
    found = [node for node in source.nodes if isinstance(node, ast.stmt)]
    return sorted(found, key=lambda node: -node.lineno)


def statement_of(spot: Spot) -> ast.stmt | None:
    """Return the statement that begins in the lines of a spot; None if none does."""
    return (
        next((n for n in _statements(spot.source) if n.lineno == spot.lines.start), None)
        if spot.source
        else None
    )


def _anchor(statement: ast.stmt | None) -> ast.expr | None:
    """Return an expression of a statement that is always computed; None if it has none."""
    match statement:
        case ast.With(items=[item, *_]):
            return item.context_expr
        case None:
            return None
    for name in ("value", "test", "iter", "exc", "subject"):
        if isinstance(found := getattr(statement, name, None), ast.expr):
            return found
    return None


def _assigned_to_self(definition: ast.ClassDef) -> set[str]:
    return {n.attr for n in ast.walk(definition) if is_self_attribute(n) and isinstance(n.ctx, ast.Store)}
