"""Values that are made or filled in and then reach nobody: one look at what is still read after each statement."""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from ros2lab.diagnose.code.left_at_default import PURE, left_at_default, unread_attributes
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.commented_out import disabled
from ros2lab.diagnose.sources.filled import (
    Fill,
    Filled,
    filled_in,
    is_among,
    kind_of,
    statement_of,
    unset_in,
)
from ros2lab.diagnose.sources.liveness import FILL, LOG, live_after
from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.one_run import blocks
from ros2lab.diagnose.sources.python_source import (
    Function,
    PythonSource,
    assignments,
    last_name,
    names_read,
    own_nodes,
    parameters,
    walk,
)
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in, calls_of
from ros2lab.diagnose.sources.uses import SENDS, State, Uses

_READS_ALL = frozenset(("locals", "vars", "exec", "eval"))
_LEAVES = (ast.Return, ast.Raise, ast.Break, ast.Continue)
_Sent = ast.Call | ast.Return


def lost_values(uses: Uses) -> Iterator[Finding]:
    """Yield the values that functions make, and the attributes of node classes, that reach nobody."""
    flows = dict[NodeClass | None, list[Flow]]()
    kept = {owner: kept_by(uses, owner) for owner in uses.sources.classes.values() if _is_own(uses, owner)}
    for source in uses.sources.sources.values():
        for owner, _, node in uses.sources.scoped(source):
            if isinstance(node, Function) and _READS_ALL.isdisjoint(names_read(own_nodes(node))):
                flow = Flow(uses, source, owner, node, kept.get(owner, {}) if owner else {})
                flows.setdefault(owner, []).append(flow)
                yield from flow.findings()
                yield from left_at_default(source, owner, node, flow.unset)
    for owner in filter(kept.__contains__, uses.sources.nodes):
        objects = [own for flow in flows.get(owner, ()) for own in flow.filled.values()]
        yield from unread_attributes(State(uses, owner), [*objects, *kept[owner].values()])


def _is_own(uses: Uses, owner: NodeClass) -> bool:
    """Return whether only the package's own code uses the attributes of a class."""
    is_ours = {owner.name, owner.source.name}.isdisjoint(uses.sources.used) and not uses.named["setattr"]
    return is_ours and not uses.sources.hands_itself_on(owner.source)


def kept_by(uses: Uses, owner: NodeClass) -> Mapping[str, Filled]:
    """Return the messages that a class makes and keeps in its attributes, where nothing else uses these."""
    nodes = [node for function in owner.functions for node in walk(function)]
    state, foreign = State(uses, owner), {*uses.read_of_others, *uses.stored_of_others}
    # Derived classes and bases are foreign, too.
    uses_of_all = ((name, use[0]) for of in (state.loads, state.stores) for name in of for use in of[name])
    foreign |= {name[5:] for name, function in uses_of_all if function not in owner.functions}
    found = filled_in(uses, owner.source, nodes, begin="self.")
    return {name: made for name, made in found.items() if name[5:] not in foreign}


class Flow:
    """The way of what a function makes: to whom it goes, and what is read after each statement."""

    def __init__(
        self,
        uses: Uses,
        source: PythonSource,
        owner: NodeClass | None,
        function: Function,
        kept: Mapping[str, Filled],
    ) -> None:
        self.uses, self.source, self.owner, self.function = uses, source, owner, function
        self.nodes = own_nodes(function)
        self.live = live_after(function)
        own = {id(node) for node in self.nodes}
        # What a function inside names, or others may see, is read at times that are not known.
        inner = (n for n in walk(function) if id(n) not in own)
        self.open = {node.id for node in inner if isinstance(node, ast.Name)}
        for node in self.nodes:
            self.open |= {*node.names} if isinstance(node, (ast.Global, ast.Nonlocal)) else set()
        filled = filled_in(uses, source, self.nodes, dict(self._answers()))
        self.filled = {name: made for name, made in filled.items() if name not in self.open}
        self._kept, self._known = kept, {**kept, **self.filled}
        self.unset = [*unset_in(made for made in self.filled.values() if made.made)]

    def _answers(self) -> Iterator[tuple[str, str]]:
        """Yield the response that ROS gives to the callback of a service, with its type."""
        names = [parameter.arg for parameter in parameters(self.function)]
        for creation, function in self.uses.sources.callbacks() if len(names) > 1 else ():
            kind = self.source.resolve(creation.given("srv_type"))
            if function is self.function and creation.method == "create_service" and kind:
                yield names[-1], f"{kind}.Response"

    def findings(self) -> Iterator[Finding]:
        """Yield what is lost in the function."""
        for made in self.filled.values():
            if made.sent and not made.others:
                yield from self._of_filled(made)
            elif made.fills and not made.others:
                yield from self._never_sent(made)
        for made in self._kept.values():
            is_here = any(says_something(fill) for fill in made.fills if fill.statement in self.nodes)
            ways = self.empty_ones(made.kind) if is_here else []
            if len(ways) == 1 and not (made.sent or made.others or made.shown):
                yield self._sent_instead(made, *ways[0])
        yield from self._changed_late()

    def _of_filled(self, made: Filled) -> Iterator[Finding]:
        """Yield what is filled into an object where no run sends it any more."""
        lost = [fill for fill in made.fills if made.name not in self.live.get(id(fill.statement), made.name)]
        first = next(filter(says_something, lost), None)
        if first and (again := self._made_again(made, first)):
            cause = (
                f"{made.name} is created again here, so what line {first.statement.lineno} filled in is lost."
            )
            yield Finding("filling-lost", cause, self.source.at(again), "remove this line")
        elif late := self._filled_late(made, lost):
            fill, last = late[0].statement, line_of(statement_of(self.source, late[1]))
            cause = f"`{line_of(fill)}` comes after `{last}`, so it is not in what was sent."
            fix = f"move `{last}` after the lines that fill {made.name}"
            yield Finding("filling-lost", cause, self.source.at(fill), fix)
        elif first:
            below = self._below(lost[-1].statement)
            ways = [way for way in self.empty_ones(made.kind) if way[0] in below]
            yield from (self._sent_instead(made, *way) for way in ways[:1])

    def _made_again(self, made: Filled, fill: Fill) -> ast.stmt | None:
        """Return the statement that makes an object anew in every run after it is filled."""
        below, around = self._below(fill.statement), self.source.above(fill.statement)
        while around is not None:
            if found := next((n for n in made.made if n in below and self.source.above(n) is around), None):
                return found
            around = self.source.above(around)
        return None

    def _filled_late(self, made: Filled, lost: Sequence[Fill]) -> tuple[Fill, _Sent] | None:
        """Return a field that first gets a value after its object has been sent, and what sends it."""
        for fill in lost:
            before = [sent for sent in made.sent if fill.statement in self._below(sent)]
            earlier = [f.field for f in made.fills if before and f.statement.lineno <= before[-1].lineno]
            if before and not is_among(fill.field, earlier):
                return fill, before[-1]
        return None

    def _below(self, node: ast.AST, *, is_same_block: bool = False) -> set[ast.AST]:
        """Return all that may come after a node in its block, and after the blocks around it."""
        found, inner = set[ast.AST](), statement_of(self.source, node)
        while inner is not self.function and not isinstance(inner, _LEAVES):
            outer = self.source.above(inner)
            block = next((b for b in blocks(outer) if inner in b), []) if outer else []
            after = block[block.index(inner) + 1 :] if block else []
            found.update(after if is_same_block else (n for later in after for n in walk(later)))
            is_end = is_same_block or any(isinstance(later, _LEAVES) for later in after)
            if is_end or not isinstance(outer, (ast.stmt, ast.ExceptHandler, ast.match_case)):
                break
            inner = outer  # type: ignore[assignment]
        return found

    def empty_ones(self, kind: str) -> list[tuple[_Sent, ast.expr]]:
        """Return where the function gives others an object of a type without any value in it, and that object."""
        ways: list[tuple[_Sent, ast.expr]] = [
            (n, n.args[0]) for n in calls_of(self.nodes, *self.uses.senders) if n.args
        ]
        ways += [(n, n.value) for n in self.nodes if isinstance(n, ast.Return) and n.value is not None]
        return [(node, given) for node, given in ways if self._is_empty(given, kind)]

    def _is_empty(self, given: ast.expr, kind: str) -> bool:
        if isinstance(given, ast.Call):
            return kind_of(self.source, given) == kind and not given.args and not given.keywords
        made = self._known.get(dotted(given) or "")
        return made is not None and made.kind == kind and made.is_empty

    def _never_sent(self, made: Filled) -> Iterator[Finding]:
        """Yield what a function fills, and neither sends nor puts anywhere."""
        fill, cause = made.fills[-1].statement, f"{self.function.name}() fills {made.name}"
        place, senders = self.source.at(fill), self._senders(made.kind)
        ways = self.empty_ones(made.kind) or self._handed_on(senders)
        places = [(own, path) for own, path, kind in self.unset if kind == made.kind and own is not made]
        if made.shown:  # which may be all that is wanted, unless nothing else has a value or is sent at all
            below, places = self._below(fill, is_same_block=True), []
            ways = [
                way for way in ways if isinstance(way[1], ast.Call) and self.source.above(way[0]) in below
            ]
            read = {dotted(n) for n in self.source.nodes if isinstance(getattr(n, "ctx", None), ast.Load)}
            senders = {sender for sender in senders if sender.rpartition(".")[0] not in read}
        if len(ways) == 1 and any(map(says_something, made.fills)):
            yield self._sent_instead(made, *ways[0])
        elif len(places) == 1:
            ((own, path),) = places
            fix = f"write `{own.name}.{path} = {made.name}` above line {own.sent[0].lineno}"
            said = f"{cause} but puts it nowhere: {own.name}.{path} stays at its default."
            yield Finding("never-sent", said, place, fix)
        elif made.made and not ways and not places and len(senders) == 1:
            way = f"{senders.pop()}({made.name})"
            line, back = disabled(self.source.text, [self.function], rf"\.\w+\({made.name}\)")
            where = _sending_place(self.function, made.made[0], fill.lineno)
            fix = back if line else f"write `{way}` {where}"
            if not calls_of(self.nodes, *SENDS):
                yield Finding("never-sent", f"{cause} but never sends it.", place, fix)

    def _handed_on(self, senders: Collection[str]) -> list[tuple[_Sent, ast.expr]]:
        """Return where the function sends what it was given, as it is, by the way of an object that it fills."""
        set_here = {(dotted(target) or "").partition(".")[0] for target, _ in assignments(self.nodes)}
        given = {parameter.arg for parameter in parameters(self.function)} - set_here
        calls = [n for n in calls_in(self.nodes) if ast.unparse(n.func) in senders and n.args]
        return [(call, call.args[0]) for call in calls if dotted(call.args[0]) in given]

    def _sent_instead(self, made: Filled, node: _Sent, given: ast.expr) -> Finding:
        """Tell that others get an empty object where another one of its type is filled."""
        is_end, text = isinstance(node, ast.Return), ast.unparse(given)
        does = "returns" if is_end else "publishes" if "publish" in ast.unparse(node) else "sends"
        who = f"{self.function.name}()"
        cause = f"{who} fills {made.name} but never {'returns' if is_end else 'sends'} it: it {does} {text} instead."
        if made.sent:
            cause = f"What {who} fills into {made.name} above does not go out: it {does} {text} here instead."
        fix = f"write return {made.name}" if is_end else f"write {ast.unparse(node.func)}({made.name})"  # type: ignore[union-attr]
        return Finding("never-sent", cause, self.source.at(node), fix)

    def _senders(self, kind: str) -> set[str]:
        """Return what sends objects of a type, such as `self.pub.publish`: of the class, or of a goal that is executed."""
        whole, _, part = kind.rpartition(".")
        method, of, sends_it = "create_publisher", "msg_type", "publish"
        if part == "Request":
            method, of, sends_it, kind = "create_client", "srv_type", "call_async", whole
        given = [parameter.arg for parameter in parameters(self.function)]
        if part == "Feedback":
            return {f"{given[1]}.publish_feedback"} if len(given) == 2 else set()
        return {
            f"{creation.kept}.{sends_it}"
            for creation in self.uses.sources.creations
            if creation.owner is self.owner and creation.method == method and creation.kept
            if creation.source.resolve(creation.given(of)) == kind
        }

    def _changed_late(self) -> Iterator[Finding]:
        """Yield variables that get another value when theirs is copied already, and nothing reads the new one."""
        for statement, name in _recomputed(self.nodes):
            is_read = not {name, LOG + name, FILL + name}.isdisjoint(self.live.get(id(statement), (name,)))
            copied = None if is_read or name in self.open else self._copied(name, statement)
            if copied:
                cause = f"`{line_of(copied)}` copies {name} before line {statement.lineno} changes it, so what is sent has the value from before."
                fix = f"move `{line_of(copied)}` below line {self._end_of(statement, copied)}"
                yield Finding("filling-lost", cause, self.source.at(copied), fix)

    def _copied(self, name: str, statement: ast.stmt) -> ast.stmt | None:
        """Return what copies a variable into a field of an object that is sent only after a statement."""
        below = self._below(statement)
        for own in self.filled.values():
            is_later = any(node in below for node in own.sent) and not own.others
            for fill in own.fills if is_later else ():
                is_copy = fill.value is not None and dotted(fill.value) == name
                if is_copy and statement in self._below(fill.statement) and fill.statement not in own.made:
                    return fill.statement
        return None

    def _end_of(self, statement: ast.stmt, copied: ast.stmt) -> int:
        """Return the last line of what stands in the block of one statement and contains a later one."""
        siblings = self._below(copied, is_same_block=True)
        around = next((n for n in siblings if statement in walk(n)), statement)
        return getattr(around, "end_lineno", statement.lineno)


def _recomputed(nodes: Iterable[ast.AST]) -> Iterator[tuple[ast.stmt, str]]:
    """Yield the statements that make a variable's new value out of the old one, but do not count, with its name."""
    for node in nodes:
        match node:
            case ast.AugAssign(target=ast.Name(id=name), value=ast.JoinedStr() | ast.Constant(value=str())):
                yield node, name
            case ast.Assign(value=ast.BinOp(op=ast.Add() | ast.Sub(), right=ast.Constant(value=int()))):
                continue
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name in names_read(walk(value)):
                # Another function may have changed the object itself.
                if PURE.issuperset(last_name(call.func) for call in calls_in(walk(value))):
                    yield node, name


def says_something(fill: Fill) -> bool:
    """Return whether what a field gets may differ from its default."""
    return fill.value is None or ast.unparse(fill.value) not in ("0", "0.0", "False", "''", "[]")


def line_of(statement: ast.stmt) -> str:
    """Return the first line of a statement."""
    return ast.unparse(statement).splitlines()[0]


def _sending_place(function: Function, made: ast.stmt, filled_at: int) -> str:
    """Say where a message is sent that is made in a function and filled up to a line: there, or in the loop that waits below."""
    body = function.body
    around = next((n for n in body if n.lineno <= filled_at <= (n.end_lineno or n.lineno)), body[-1])
    if made not in body or isinstance(around, (ast.For, ast.While)):
        return f"below line {filled_at}, with the same indentation"
    below = body[body.index(around) + 1 :]
    loops = [n for n in below if isinstance(n, (ast.For, ast.While))]
    if waiting := [n for n in loops if any("sleep" in last_name(call.func) for call in calls_in(walk(n)))]:
        return f"as the first line of the loop on line {waiting[0].lineno}"
    return f"above line {below[0].lineno}" if below else f"as the last line of {function.name}()"
