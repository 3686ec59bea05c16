"""A line at which Python stops: changes of it are tried on copies of its file, and what the type checker takes is told.

Nothing here knows a mistake. A change is small and general: a value is called, or not called, taken out of what holds
it, asked of something else, given by its name, or written as another type; in the line itself, or in the one that made
the value. A fix that is known already is tried first, as a student would apply it, word by word.
"""

from __future__ import annotations

import ast
import builtins
import difflib
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ros2lab.diagnose.calls import missing_imports
from ros2lab.diagnose.finding import Finding, stops_node
from ros2lab.diagnose.interfaces import fields_of, has_name, homes_of, launch_homes_of
from ros2lab.diagnose.look import Look, text_faults
from ros2lab.diagnose.members import members
from ros2lab.diagnose.node_source import NodeClass, is_self_attribute
from ros2lab.diagnose.operands import held_in
from ros2lab.diagnose.origins import Origin, of_what_gives_nothing
from ros2lab.diagnose.python_source import Function, PythonSource, own_nodes, parameters, read_source
from ros2lab.diagnose.signatures import signature_of
from ros2lab.diagnose.spots import Spot
from ros2lab.diagnose.type_checker import Row, checked

_MOST = 150  # changes that are tried, about half a second
_ALIKE = 0.6  # of two names, as difflib measures it
_UNKNOWN = re.compile(r"\b(?:Unknown|Any|Never)\b|^object$")
_IN_PLACE = re.compile(r"write `?(?P<new>.+?)`? in place of `?(?P<old>.+?)`?(?:, .*)?$", re.DOTALL)
_WRITTEN = re.compile(r"write (?P<sign>`?)(?P<new>.+?)(?P=sign)(?:, with .*)?$")
_MOST_TOLD = 3  # changes of which nothing tells which is meant


@dataclass(frozen=True)
class Edit:
    """Another text for an expression or a statement."""

    node: ast.expr | ast.stmt
    text: str

    def applied(self, lines: Sequence[bytes]) -> list[bytes]:
        """Return the lines of a file with the other text."""
        node = self.node
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, behind = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        return [*lines[:first], before + self.text.encode() + behind, *lines[last + 1 :]]


@dataclass(frozen=True)
class Change:
    """An edit that may be what was meant.

    Attributes:
        edit: what is changed.
        cost: how much it changes; of several that stand, the cheapest is meant.
        is_one_of_many: whether nothing but that it stands speaks for it, so that no other of its cost may.
    """

    edit: Edit
    cost: int
    is_one_of_many: bool = False


def tried(finding: Finding, look: Look, part: str = "", *, is_sure: bool = False) -> Finding:
    """Return a finding about a line of Python with a fix that stands, if one is known or found.

    A fix that can be applied word by word stays if the type checker takes it; else a change that it takes is told in
    its place. Without the type checker, or where it has no objection to begin with, nothing is changed.

    Args:
        finding: what is known.
        look: the workspace.
        part: what of the line has failed, as Python marks it.
        is_sure: whether a fix that cannot be applied word by word is right all the same.
    """
    source, line = _source_at(finding.place, look)
    if source is None:
        return finding
    trial = _Trial(source, replace(Spot(source, line), part=part), look)
    if not trial.objections:
        return finding
    if nothing := _of_nothing(trial):
        return nothing
    said = [*_as_said(finding.fix, trial)]
    if any(trial.stands([edit for edit in said if not trial.is_open(edit.text)])) or (is_sure and not said):
        return finding
    good = _cheapest(trial, sorted(_changes(trial), key=lambda change: change.cost)[:_MOST])
    if not good:
        return finding
    place = source.at(good[0].node)
    more = "" if place == finding.place else f" Line {line} fails because of this one."
    texts = (f"`{trial.line_after(edit)}`" for edit in good)
    cause = finding.cause.partition(" Did you mean")[0]  # that was a guess
    return replace(finding, cause=f"{cause}{more}", place=place, fix=f"write {', or '.join(texts)}")


def _of_nothing(trial: _Trial) -> Finding | None:
    """Say which call gives nothing back whose value the line uses; None if there is none."""
    for text, value in _origins(trial.expressions(), trial).items():
        if trial.kind(text) == "None" and isinstance(value, ast.Call):
            origin = Origin(text, value, trial.source, value.lineno, "NoneType")
            return Finding("made-wrong", *of_what_gives_nothing(origin, value))
    return None


def _source_at(place: str, look: Look) -> tuple[PythonSource | None, int]:
    file, _, line = place.rpartition(":")
    sources = [one for package in look.packages for one in package.sources.values()]
    launch = zip(look.launch_files, (path for one in look.packages for path in one.launch_files), strict=True)
    sources += [read_source(path, path.stem, one.shown) for one, path in launch if path.suffix == ".py"]
    found = next((one for one in sources if one.shown == file and one.tree.body), None)
    return (found if line.isdigit() else None), int(line) if line.isdigit() else 0


class _Trial:
    """A file whose copies the type checker is asked about."""

    def __init__(self, source: PythonSource, spot: Spot, look: Look) -> None:
        self.source, self.spot, self.look = source, spot, look
        self.lines = source.text.encode().splitlines(keepends=True)
        for edit in sorted(_annotations(source, look), key=lambda one: one.node.col_offset, reverse=True):
            self.lines = edit.applied(self.lines)
        self.statement = _statement(spot)
        self._before, self._kinds = self._first_look()

    @property
    def objections(self) -> list[Row]:
        """What the type checker says of the line as it is."""
        return [row for row in self._before if row.line in self.spot.lines]

    def kind(self, text: str) -> str:
        """Return the type of an expression in the line, or of a name that can be used there; empty if unknown."""
        kind = self._kinds.get(text, "")
        return "" if _UNKNOWN.search(kind) else kind

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
            found.append(is_clean and not Counter((row.rule, row.said) for row in rows) - known)
        return found

    def is_right(self, edit: Edit) -> bool:
        """Return whether the rules find nothing in the lines of an edit."""
        text = b"".join(edit.applied(self.source.text.encode().splitlines(keepends=True))).decode()
        copy = PythonSource(self.source.name, self.source.shown, text, self.source.is_package)
        places = {copy.at(line) for line in {*self.spot.lines, edit.node.lineno}}
        return not any(one.place in places and stops_node(one) for one in text_faults(copy))

    def line_after(self, edit: Edit) -> str:
        """Return what the line of an edit says then; of an expression over several lines, all of them in one."""
        lines = edit.applied(self.source.text.encode().splitlines(keepends=True))
        first = edit.node.lineno - 1
        texts = (line.decode().strip() for line in lines[first : first + len(edit.text.splitlines())])
        return " ".join(texts).partition("  #")[0]

    def _with_imports(self, edit: Edit) -> list[bytes]:
        added = [f"\n{line}".encode() for line in missing_imports(self.source, edit.text)]
        return [*edit.applied(self.lines), *added]

    def _first_look(self) -> tuple[list[Row], dict[str, str]]:
        """Ask what is wrong with the file as it is, and of which types what stands in the line is, and can be used there."""
        texts = list(dict.fromkeys([*map(ast.unparse, self.expressions()), *self.names]))
        before, rows = checked(self.source, [b"".join(self.lines), self._revealing(texts)])
        return before, _revealed(texts, rows)

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


def _revealed(texts: Sequence[str], rows: Sequence[Row]) -> dict[str, str]:
    kinds = [re.sub(r"^.*?`(.*)`$", r"\1", row.said) for row in rows if row.rule == "revealed-type"]
    return dict(zip(texts, kinds, strict=True)) if len(kinds) == len(texts) else {}


def _annotations(source: PythonSource, look: Look) -> Iterator[Edit]:
    """Yield the type of what each callback receives, as the subscription names it, behind its parameter."""
    for package in look.packages:
        known = look.sources(package)
        for creation, function in known.callbacks() if source in package.sources.values() else ():
            given = (creation.arguments or {}).get("msg_type")
            names = [one for one in parameters(function) if one.arg not in ("self", "cls")]
            if creation.method == "create_subscription" and given and creation.source is source and names:
                is_open = names[0].annotation is None and names[0].lineno == names[0].end_lineno
                if is_open:
                    here = ast.Name(names[0].arg, lineno=names[0].lineno, col_offset=names[0].col_offset)
                    here.end_lineno, here.end_col_offset = names[0].end_lineno, names[0].end_col_offset
                    yield Edit(here, f"{names[0].arg}: {ast.unparse(given)!r}")


def _statements(source: PythonSource) -> list[ast.stmt]:
    """Return the statements of a file, the innermost first."""
    found = [node for node in source.nodes if isinstance(node, ast.stmt)]
    return sorted(found, key=lambda node: -node.lineno)


def _statement(spot: Spot) -> ast.stmt | None:
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


def _cheapest(trial: _Trial, changes: Sequence[Change]) -> list[Edit]:
    """Return the cheapest change that stands, or the few of which nothing tells which is meant; none if many are."""
    stands = trial.stands([one.edit for one in changes])
    good = [change for change, is_good in zip(changes, stands, strict=True) if is_good]
    good = [change for change in good if trial.is_right(change.edit)]
    # A value of an unknown type stands anywhere; what a call with less gives is what it gave before.
    kinds = trial.kinds_of([change.edit.text for change in good]) if good else {}
    known = [c for c in good if c.cost == _LESS or not _UNKNOWN.search(kinds.get(c.edit.text, ""))]
    for change in [*known, *(one for one in good if not one.is_one_of_many)]:
        same = [one.edit for one in known if one.cost == change.cost and one.is_one_of_many]
        if not change.is_one_of_many:
            return [change.edit]
        if len(same) <= _MOST_TOLD:
            return same
    return []


def _as_said(fix: str, trial: _Trial) -> Iterator[Edit]:
    """Yield what a student may do who applies a fix word by word."""
    if match := _IN_PLACE.match(fix):
        for node in trial.expressions():
            if ast.unparse(node) == _plain(match["old"]):
                yield Edit(node, match["new"])
            elif isinstance(node, ast.Attribute) and node.attr == match["old"]:
                yield Edit(node, f"{ast.unparse(node.value)}.{match['new']}")
    elif (match := _WRITTEN.match(fix)) and trial.statement is not None and _plain(match["new"]):
        written = match["new"]
        yield Edit(trial.statement, written)
        yield from (Edit(node, written) for node in trial.expressions() if _is_like(node, written))


def _plain(text: str) -> str:
    """Return a statement as `ast` writes it; empty if it is none."""
    try:
        return ast.unparse(ast.parse(text.strip()))
    except (SyntaxError, ValueError):
        return ""


def _is_like(node: ast.expr, written: str) -> bool:
    return isinstance(node, (ast.Call, ast.Attribute, ast.BinOp, ast.Compare)) and (
        difflib.SequenceMatcher(None, ast.unparse(node), written).ratio() >= _ALIKE
    )


# What a change costs, from a slip of the fingers to another value.
_SLIP, _FORM, _PLACE, _VALUE, _LESS = 1, 2, 3, 4, 5


def _changes(trial: _Trial) -> Iterator[Change]:
    """Yield the changes of a line, and of the lines that made its values."""
    expressions = trial.expressions()
    called = {id(node.func): node for node in expressions if isinstance(node, ast.Call)}
    given = {id(one) for call in called.values() for one in [*call.args, *(k.value for k in call.keywords)]}
    made = _origins(expressions, trial)
    for node in expressions:
        if isinstance(getattr(node, "ctx", None), (ast.Store, ast.Del)):
            continue
        if ast.unparse(node) not in made and id(node) not in called:
            yield from _of_form(node, is_given=id(node) in given)
        yield from _of_members(node, trial, called.get(id(node)))
        if id(node) not in called:
            yield from _of_what_it_holds(node, trial)
        if isinstance(node, ast.Call):
            yield from _of_arguments(node, trial)
        yield from _of_value(node, trial)
    for value in made.values():
        for change in [*_of_form(value), *_of_value(value, trial)]:
            yield replace(change, cost=change.cost + 1)


def _of_form(node: ast.expr, *, is_given: bool = False) -> Iterator[Change]:
    """Yield a function called; or the function itself, where a call of it is given to another one."""
    text = ast.unparse(node)
    if isinstance(node, (ast.Name, ast.Attribute)):
        yield Change(Edit(node, f"{text}()"), _FORM)
    if isinstance(node, ast.Call) and is_given and not node.args and not node.keywords:
        yield Change(Edit(node, ast.unparse(node.func)), _FORM)


def _of_members(node: ast.expr, trial: _Trial, call: ast.Call | None) -> Iterator[Change]:
    """Yield another member of the same, the member of something else, and an item in place of a member."""
    if not isinstance(node, ast.Attribute):
        return
    before = ast.unparse(node.value)
    kind = trial.kind(before)
    known = members(_class_name(kind), trial.look)
    if "Self@" in kind and trial.owner:
        known |= members(trial.owner.definition.name, trial.look)
    for name in difflib.get_close_matches(node.attr, known - {node.attr}, n=3, cutoff=_ALIKE):
        yield Change(Edit(node, f"{before}.{name}"), _SLIP)
        yield Change(Edit(node, f"{before}.{name}()"), _FORM)
    for name in (
        _never_read(trial.owner) if before == "self" and node.attr not in known and trial.owner else ()
    ):
        yield Change(Edit(node, f"self.{name}"), _SLIP, is_one_of_many=True)
    if call is not None and isinstance(trial.statement, ast.Expr) and trial.statement.value is call:
        # Who does not use what a method gives means one that gives nothing.
        kinds = trial.kinds_of([f"{before}.{name}" for name in sorted(known)])
        for text, one in kinds.items():
            if one.endswith("-> None"):
                yield Change(Edit(node, text), _PLACE, is_one_of_many=True)
    if kind.startswith("dict["):
        yield Change(Edit(node, f"{before}[{node.attr!r}]"), _FORM)
    for holder in trial.names if node.attr not in known else ():
        if holder != before and node.attr in members(_class_name(trial.kind(holder)), trial.look):
            yield from _asked_of(holder, node, call)


def _of_what_it_holds(node: ast.expr, trial: _Trial) -> Iterator[Change]:
    """Yield what a value holds in place of the value."""
    text = ast.unparse(node)
    kind = trial.kind(text)
    name = _class_name(kind)
    if not name or hasattr(builtins, name):
        return
    is_whole = isinstance(node, (ast.Name, ast.Attribute, ast.Call))
    held = (
        f"{text}.value" if kind.startswith("Literal[") else held_in(text if is_whole else f"({text})", name)
    )
    if held:
        yield Change(Edit(node, held), _FORM)
    for field in _fields(name) if not held else ():
        yield Change(Edit(node, f"{text}.{field}"), _PLACE, is_one_of_many=True)


def _fields(message: str) -> Sequence[str]:
    """Return the fields of a message; none of any other class."""
    fields = (fields_of(f"{home}.{message}") for home in homes_of(message))
    return [*next(filter(None, fields), {})]


def _never_read(owner: NodeClass) -> list[str]:
    """Return the attributes that a class sets and never reads: one may be called otherwise where it is read."""
    own = [n for n in ast.walk(owner.definition) if is_self_attribute(n)]
    read = {n.attr for n in own if not isinstance(n.ctx, ast.Store)}
    return sorted({n.attr for n in own} - read)


def _asked_of(holder: str, node: ast.Attribute, call: ast.Call | None) -> Iterator[Change]:
    """Yield a member of something else, and a call of it with less."""
    if call is None:
        yield Change(Edit(node, f"{holder}.{node.attr}"), _PLACE, is_one_of_many=True)
        return
    texts = [*map(ast.unparse, call.args), *map(_keyword, call.keywords)]
    yield Change(Edit(call, f"{holder}.{node.attr}({', '.join(texts)})"), _PLACE, is_one_of_many=True)
    for number in range(len(texts)):
        less = [*texts[:number], *texts[number + 1 :]]
        yield Change(Edit(call, f"{holder}.{node.attr}({', '.join(less)})"), _VALUE, is_one_of_many=True)


def _of_arguments(call: ast.Call, trial: _Trial) -> Iterator[Change]:
    """Yield a call whose values are exchanged, given by their names, put into one list, one more, or one less."""
    function, given = ast.unparse(call.func), [*map(ast.unparse, call.args)]
    named = [*map(_keyword, call.keywords)]
    rules = {row.rule for row in trial.objections}

    def written(*texts: str) -> Edit:
        return Edit(call, f"{function}({', '.join([*texts, *named])})")

    for number in range(len(given) - 1):
        swapped = [*given[:number], given[number + 1], given[number], *given[number + 2 :]]
        yield Change(written(*swapped), _PLACE)
    signature = signature_of(trial.source, call)
    for one in signature.parameters if signature else ():
        if given and one.name not in {keyword.arg for keyword in call.keywords}:
            yield Change(written(*given[:-1], f"{one.name}={given[-1]}"), _PLACE)
    for name in trial.names if "missing-argument" in rules else ():
        yield Change(written(*given, name), _PLACE, is_one_of_many=True)
    if "too-many-positional-arguments" in rules or len(given) > 1:
        yield Change(written(f"[{', '.join(given)}]"), _PLACE)
    for number in range(len(given)) if "too-many-positional-arguments" in rules else ():
        yield Change(written(*given[:number], *given[number + 1 :]), _LESS, is_one_of_many=True)


def _of_value(node: ast.expr, trial: _Trial) -> Iterator[Change]:
    """Yield a value as one of another type, or with what stands for it where it may be None."""
    text, kind = ast.unparse(node), trial.kind(ast.unparse(node))
    match node:
        case ast.Constant(value=str(value)) if re.fullmatch(r"[-+]?\d+(?:\.\d*)?", value):
            yield Change(Edit(node, value), _FORM)
        case ast.Constant(value=bool() | None):
            return
        case ast.Constant(value=int(value)):
            yield Change(Edit(node, f"{value}.0"), _FORM)
        case ast.Constant(value=float(value)) if value.is_integer():
            yield Change(Edit(node, str(int(value))), _FORM)
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            yield Change(Edit(node, f"{ast.unparse(left)} // {ast.unparse(right)}"), _FORM)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            yield Change(Edit(node, f"[{ast.unparse(left)}, {ast.unparse(right)}]"), _LESS)
        case ast.Name(id=name) if trial.is_undefined(name):
            yield from (Change(Edit(node, f"{module}.{name}"), _SLIP) for module in trial.modules_with(name))
            yield from (Change(Edit(node, one), _SLIP) for one in trial.names if one == f"self.{name}")
            yield Change(Edit(node, repr(name)), _LESS)
        case ast.Constant(value=bytes(value)):
            yield Change(Edit(node, repr(value.decode("latin-1"))), _FORM)
    if kind.endswith("| None"):
        empty = _EMPTY.get(kind.removesuffix(" | None"), "...")
        yield Change(Edit(node, f"({text} or {empty})"), _VALUE)
    yield from (Change(Edit(node, made.format(text)), _VALUE) for made in _made_of(kind))


def _made_of(kind: str) -> Sequence[str]:
    """Return what is made of a value of a type where another one is wanted: a text of all but a few."""
    name = _class_name(kind)
    # What launch fills in later is no text yet.
    is_no_text = not kind or _NO_TEXT.match(kind) or launch_homes_of(name)
    return _MADE_OF.get(name, () if is_no_text else ("str({})",))


_EMPTY = {"str": "''", "int": "0", "float": "0.0"}
# The types of functions, classes, modules and None.
_NO_TEXT = re.compile(r"None$|def |bound method|\(|<|type\[|Overload|Self@")
_MADE_OF: Mapping[str, Sequence[str]] = {
    "str": ("float({})", "int({})"),
    "int": ("range({})", "str({})"),
    "float": ("int({})", "str({})"),
    "bool": ("str({})",),
    "list": ("map(str, {})", "map(float, {})"),
    "tuple": ("list({})", "map(str, {})"),
    "set": ("list({})", "map(str, {})"),
    "dict": (),
    "bytes": ("{}.decode()",),
}


def _origins(expressions: Iterable[ast.expr], trial: _Trial) -> dict[str, ast.expr]:
    """Return what is assigned to each name of a line, of those to which it is only once, and in another line."""
    texts = {ast.unparse(n) for n in expressions if isinstance(n, (ast.Name, ast.Attribute))}
    values: dict[str, list[ast.expr]] = {}
    scope: Function | ast.ClassDef | ast.Module
    for text in texts:
        is_own = text.startswith("self.") and trial.owner
        scope = trial.owner.definition if is_own and trial.owner else trial.spot.function or trial.source.tree
        for node in ast.walk(scope):
            if isinstance(node, ast.Assign) and text in map(ast.unparse, node.targets):
                values.setdefault(text, []).append(node.value)
    return {
        text: found[0]
        for text, found in values.items()
        if len(found) == 1 and found[0].lineno not in trial.spot.lines
    }


def _keyword(one: ast.keyword) -> str:
    return f"{one.arg}={ast.unparse(one.value)}" if one.arg else f"**{ast.unparse(one.value)}"


def _class_name(kind: str) -> str:
    """Return the name of the class of which a type is."""
    kind = kind.removesuffix(" | None").replace("LiteralString", "str")
    if literal := re.match(
        r"Literal\[(?:(?P<enum>[A-Z]\w*)\.\w|(?P<text>['\"])|(?P<bytes>b)|(?P<number>-?\d))", kind
    ):
        known = {"text": "str", "bytes": "bytes", "number": "int"}
        return literal["enum"] or known[literal.lastgroup or "number"]
    return re.sub(r"\[.*", "", kind).rpartition(".")[2]
