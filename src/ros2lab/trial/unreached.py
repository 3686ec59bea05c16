"""Explains why a statement was never reached in a run: which test, exit or exception kept it from that, and why.

Each step is a fact of the run, or of the text: a statement was not reached because a test never changed, because an
attribute was never set, because the statement that sets it was not reached.
"""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from ros2lab.diagnose.finding import these_lines
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.node_source import is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, own_nodes, walk
from ros2lab.trial.clauses import (
    ORDERS,
    checks_in_words,
    is_coming,
    is_plain,
    of_side,
    on_one_line,
    times,
    truth,
    values_of,
)
from ros2lab.trial.failing import failed_with
from ros2lab.trial.guards import asks_who_is_there
from ros2lab.trial.record import Error, Record, Test, spot
from ros2lab.trial.witness import is_marked

MANY = 0.25  # of the calls of a function, in which something else comes first
STEPS = 3  # from a statement to a value, from there to what sets it, and so on
_EXITS = (ast.Return, ast.Continue, ast.Break, ast.Raise)
_ENDS = frozenset(("KeyboardInterrupt", "ExternalShutdownException", "SystemExit", "GeneratorExit"))
_LOOPS = (ast.For, ast.AsyncFor, ast.While)
_Store = tuple[PythonSource, ast.stmt]


@dataclass(frozen=True)
class Reason:
    """Why a statement was not reached.

    Attributes:
        text: as a clause.
        place: the line that decides.
        fix: what to do there; empty if that is not known.
        is_open: whether it may only not have come so far: a number has not passed a limit.
        is_coming: whether that number only went towards the limit, or still moved when the runs ended.
        is_certain: whether it holds whatever comes: it is in the code, or something failed.
        is_circle: whether it only comes to what it is to explain, or to what is told already.
        on_the_way: the other lines that it tells of.
    """

    text: str
    place: str
    fix: str = ""
    is_open: bool = False
    is_coming: bool = False
    is_circle: bool = False
    is_certain: bool = False
    on_the_way: tuple[str, ...] = ()

    @property
    def places(self) -> set[str]:
        """All lines that it tells of."""
        return {self.place, *self.on_the_way}

    def after(self, text: str, *places: str) -> Reason:
        """Return it as the reason of something else, at other places."""
        return replace(self, text=f"{text}{self.text}", on_the_way=(*places, *self.on_the_way))

    def only_if(self, test: ast.expr, truth: str) -> Reason:
        """Return it as that of a test that is evaluated only after another one; as it is if it has a further reason."""
        also = f"; that is only asked when `{ast.unparse(test)}` is {truth}"
        return self if self.on_the_way else replace(self, text=f"{self.text}{also}")


class Unreached:
    """What was not reached in the runs of a workspace's programs.

    Args:
        record: what was noted while they ran.
        look: the workspace.
    """

    def __init__(self, record: Record, look: Look) -> None:
        self.record, self.look = record, look
        self._explained: list[ast.AST | None] = []  # statements, and the tests that are told of them

    def why(self, source: PythonSource, statement: ast.AST | None) -> Reason | None:
        """Return why a statement never came to its end; None if that is not known."""
        self._explained.clear()
        return self._why(source, statement, STEPS)

    def _why(self, source: PythonSource, statement: ast.AST | None, steps: int) -> Reason | None:
        """Return the same in at most so many steps."""
        self._explained.append(statement)
        owner, block = _around(source, statement) if steps > 0 else (None, ())
        for place, inner in enumerate(filter(is_marked, block)):
            if not self.record.count(source, inner):
                if place or self._entries(source, owner, block):
                    stuck = self._stuck(source, inner, steps)
                    return stuck and self._after_others(source, inner, stuck)
                return self._unentered(source, owner, block, steps)
            if inner is statement or isinstance(inner, _EXITS):
                break
        return None

    def _stuck(self, source: PythonSource, stuck: ast.stmt, steps: int) -> Reason | None:
        """Return why a statement that was reached never came to its end: an exit in it, or an exception."""
        exits = [
            node
            for node in own_nodes(stuck)
            if isinstance(node, _EXITS) and self.record.count(source, node) and _leaves(source, node, stuck)
        ]
        most = max((self.record.count(source, node) for node in exits), default=0)
        lines = range(stuck.lineno, (stuck.end_lineno or 0) + 1)
        errors = [
            e for e in self.record.errors if any(home is source and at in lines for home, at in e.lines)
        ]
        if any(error.handler is None or error.kind in _ENDS for error in errors):
            return None  # the program ended, or was stopped, which is told anyway
        failed = max(errors, key=lambda error: error.count, default=None)
        if failed and failed.count >= most:
            return _caught(failed)
        if len(exits) > 1:
            text = (
                f"it is left before, each time, on one of the {these_lines(sorted(n.lineno for n in exits))}"
            )
            return Reason(text, source.at(stuck))
        return self._left(source, exits[0], stuck, steps) if exits else None

    def _left(self, source: PythonSource, left: ast.stmt, stuck: ast.stmt, steps: int) -> Reason:
        """Return why an exit inside a statement comes before what follows the statement."""
        text = f"`{on_one_line(left)}` on line {left.lineno} came first each time"
        inner: ast.AST = left
        while inner is not stuck and (around := source.above(inner)) is not None:
            if isinstance(around, ast.If):
                reason = self._constant(source, around.test, inner not in around.body, steps)
                if reason:
                    return reason.after(f"{text}, because ", source.at(left))
            inner = around
        return Reason(text, source.at(left))

    def _entries(self, source: PythonSource, owner: ast.AST | None, block: Sequence[ast.stmt]) -> int:
        """Return how often a block was begun, at least once or never."""
        found = 0
        match owner:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                found = self.record.count(source, owner)
            case ast.If() | ast.While() if not isinstance(owner.test, ast.Constant):
                found = self._outcomes(source, owner.test)[block is not owner.body]
            case ast.For() | ast.AsyncFor() if block is owner.body:
                found = self.record.count(source, owner.target)
            case ast.match_case():
                found = self.record.count(source, owner.pattern)
            case ast.ExceptHandler():
                found = any(e.handler and e.handler[:2] == (source, owner.lineno) for e in self.record.errors)
            case ast.stmt():
                found = self._arrivals(source, owner)
        return found

    def _arrivals(self, source: PythonSource, statement: ast.stmt) -> int:
        """Return how often a statement was begun, at least once or never."""
        around, siblings = _around(source, statement)
        marked = [*filter(is_marked, siblings[: siblings.index(statement)])] if siblings else []
        if marked:
            return 0 if isinstance(marked[-1], _EXITS) else self.record.count(source, marked[-1])
        return self._entries(source, around, siblings) if around is not None else 0

    def _after_others(self, source: PythonSource, gate: ast.stmt, reason: Reason) -> Reason:
        """Return why nothing came past a statement, with what kept many turns of its function or loop from reaching it."""
        turned, inner = list[tuple[int, str, ast.AST]](), gate
        while True:
            owner, block = _around(source, inner)
            before = block[: block.index(inner)] if block else ()
            for stuck, exited in ((earlier, node) for earlier in before for node in own_nodes(earlier)):
                if isinstance(exited, _EXITS) and _leaves(source, exited, stuck):
                    text = f"`{on_one_line(exited)}` on line {exited.lineno} came first"
                    turned.append((self.record.count(source, exited), text, exited))
            if not isinstance(owner, (ast.If, ast.Try, ast.With)):
                break
            if isinstance(owner, ast.If):
                is_then = block is owner.body
                text = f"`{ast.unparse(owner.test)}` on line {owner.lineno} was {'not ' * is_then}true"
                turned.append((self._outcomes(source, owner.test)[is_then], text, owner))
            inner = owner
        turns, reached = self._entries(source, owner, block), self._arrivals(source, gate)
        count, text, at = max(turned, key=lambda row: row[0], default=(0, "", gate))
        if not turns * MANY <= count < turns:
            return reason
        text = f"{text} {count} of {turns} times, and where line {gate.lineno} was reached, "
        if count <= reached:
            return reason.after(text, source.at(at))
        return replace(reason.after(text, reason.place), place=source.at(at), fix="")

    def _unentered(
        self, source: PythonSource, owner: ast.AST | None, block: Sequence[ast.stmt], steps: int
    ) -> Reason | None:
        """Return why a block was never begun."""
        found: Reason | None = None
        match owner:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                found = self._uncalled(source, owner, steps)
            case ast.If() | ast.While() if any(self._outcomes(source, owner.test)):
                alone = self._constant(source, owner.test, block is owner.body, steps)
                around = source.above(owner)
                found = alone and self._after_others(source, owner, alone)
                if found and found is alone and isinstance(around, ast.If) and around.orelse == [owner]:
                    found = found.only_if(around.test, "not true")
            case ast.For() if "stdin" in ast.unparse(owner.iter):
                found = None  # nobody types anything here
            case ast.For() if self.record.count(source, owner):
                loop = f"the loop over {ast.unparse(owner.iter)} on line {owner.lineno}"
                found = Reason(f"{loop} had nothing to go through", source.at(owner))
            case ast.match_case():
                found = self._untaken(source, owner, steps)
            case ast.stmt():
                found = self._why(source, owner, steps)
        return found

    def _untaken(self, source: PythonSource, case: ast.match_case, steps: int) -> Reason | None:
        match, line = source.above(case), case.pattern.lineno
        seen = self.record.test(source, match) if isinstance(match, ast.Match) else None
        if not isinstance(match, ast.Match) or seen is None:
            return self._why(source, match, steps)
        if case.guard and any(self._outcomes(source, case.guard)):
            return self._constant(source, case.guard, True, steps)
        value = of_side(ast.unparse(match.subject), seen.sides[0])
        return Reason(f"`case {ast.unparse(case.pattern)}` was never taken ({value})", source.at(line))

    def _outcomes(self, source: PythonSource, test: ast.expr) -> tuple[int, int]:
        """Return how often a test was true and false."""
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            held, failed = self._outcomes(source, test.operand)
            return failed, held
        found = self.record.test(source, test)
        return (found.held, found.failed) if found else (0, 0)

    def _constant(self, source: PythonSource, test: ast.expr, wanted: bool, steps: int) -> Reason | None:
        """Return why a test was never true, or never false, as is `wanted`; None if it was, or was not evaluated."""
        outcomes = self._outcomes(source, test)
        if outcomes[not wanted] or not any(outcomes) or asks_who_is_there(source, test):
            return None
        match test:
            case ast.UnaryOp(op=ast.Not(), operand=inner):
                return self._constant(source, inner, not wanted, steps)
            case ast.BoolOp(op=sign, values=values):
                needs_all = isinstance(sign, ast.And) is wanted
                parts = list[Reason]()
                for place, value in enumerate(values):
                    if (reason := self._constant(source, value, wanted, steps)) is None:
                        continue
                    if needs_all and not reason.is_circle:
                        return reason.only_if(values[place - 1], str(wanted).lower()) if place else reason
                    parts.append(reason)
                text = f"`{ast.unparse(test)}` was {truth(wanted)} in {checks_in_words(sum(outcomes))}"
                if len(parts) == (1 if needs_all else len(values)):
                    told = [part for part in parts if not part.is_circle] or parts[:1]
                    text = " and ".join(part.text for part in told)
                    return replace(told[0], text=text, is_coming=any(part.is_coming for part in parts))
                return Reason(
                    f"{text}{', although each part of it was at times' * needs_all}", source.at(test)
                )
        found = self.record.test(source, test)
        return self._leaf(source, test, found, wanted, steps) if found else None

    def _leaf(self, source: PythonSource, test: ast.expr, found: Test, wanted: bool, steps: int) -> Reason:
        """Return why a test without parts never had a truth: what was compared, and why that did not change."""
        parts = [test.left, *test.comparators] if isinstance(test, ast.Compare) else [test]
        pairs = [*zip(map(ast.unparse, parts), parts, found.sides, strict=True)]
        values = values_of(test, found)
        checks = checks_in_words(found.held + found.failed)
        text = f"`{ast.unparse(test)}` was {truth(wanted)} in {checks}"
        text = f"{text} ({values})" if values else text
        if len(parts) == 1 and not found.sides[0].has_changed:
            text = f"{pairs[0][0]} was {found.sides[0].last} in {checks}"
        fix = f"see whether `{ast.unparse(test)}` can be {str(wanted).lower()} at all, and what should change it"
        is_order = isinstance(test, ast.Compare) and isinstance(test.ops[0], ORDERS)
        is_open = is_order and any(side.bounds for side in found.sides)
        is_known, has_changed = test in self._explained, any(side.has_changed for side in found.sides)
        self._explained.append(test)
        for _, part, side in pairs if not has_changed and not is_known else ():
            if not is_self_attribute(part) or not is_plain(side.last):
                continue
            if further := self._unset(source, part, side.last, steps - 1):
                if further.is_circle:
                    return Reason(text, source.at(test), fix, is_circle=True)
                return further.after(f"{text}, and ", source.at(test))
        coming = is_coming(self.record.moving, spot(source, test), test, found, wanted=wanted)
        return Reason(text, source.at(test), fix, is_open, coming, is_known)

    def _unset(self, source: PythonSource, attribute: Any, value: str, steps: int) -> Reason | None:
        """Return why an attribute of self kept a value: where it would have been set to another one, and why it was not."""
        same, others = (
            self._stores(source, attribute, value) if steps > 0 and not self._sets_by_name else ([], [])
        )
        name, reached = ast.unparse(attribute), any(self.record.count(*store) for store in others)
        if any(node in self._explained for _, node in others):
            return Reason("", source.at(attribute), is_circle=True)
        again = [store for store in same if self.record.count(*store) and _name_around(*store) != "__init__"]
        if reached and len(again) == 1:
            ((home, node),) = again
            text = f"line {node.lineno} set it to {value} {times(self.record.count(home, node))}"
            fix = f"look at line {node.lineno}: it sets {name} to {value} again each time"
            found = Reason(text, home.at(node), fix)
        elif len(others) == 1 and reached:
            ((home, node),) = others
            found = Reason(f"line {node.lineno} sets it: `{on_one_line(node)}`", home.at(node))
        elif len(others) == 1:
            ((home, node),) = others
            text = f"the only other place that sets it, line {node.lineno} in {_name_around(home, node)}(), was not reached"
            further = self._why(home, node, steps)
            found = further.after(f"{text}: ") if further else Reason(text, home.at(node))
        elif others and not reached:
            lines = these_lines(sorted(node.lineno for _, node in others))
            found = Reason(
                f"nothing that sets it to another value was reached ({lines})", source.at(attribute)
            )
        else:
            return self._never_set(source, attribute) if same and not others else None
        return found

    def _stores(self, source: PythonSource, attribute: Any, value: str) -> tuple[list[_Store], list[_Store]]:
        """Return the statements that set an attribute: to a constant with this value, and to anything else."""
        same, others = list[_Store](), list[_Store]()
        for home in self.look.files:
            for node in home.nodes:
                is_set = (
                    isinstance(node, ast.Attribute)
                    and node.attr == attribute.attr
                    and not isinstance(node.ctx, ast.Load)
                    and not (is_self_attribute(node) and self._are_apart(source, attribute, home, node))
                )
                if is_set and (statement := statement_of(home, node)):
                    given = (
                        getattr(statement, "value", None)
                        if not isinstance(statement, ast.AugAssign)
                        else None
                    )
                    is_same = isinstance(given, ast.Constant) and repr(given.value) == value
                    (same if is_same else others).append((home, statement))
        return same, others

    def _are_apart(self, source: PythonSource, node: Any, home: PythonSource, other: Any) -> bool:
        """Return whether two attributes of self belong to classes of which none inherits from another of the workspace."""
        classes = (source.class_at(node.lineno), home.class_at(other.lineno))
        bases = {last_name(base) for found in classes if found for base in found.bases}
        own = {n.name for file in self.look.files for n in file.nodes if isinstance(n, ast.ClassDef)}
        return None not in classes and classes[0] is not classes[1] and bases.isdisjoint(own)

    def _never_set(self, source: PythonSource, attribute: Any) -> Reason:
        """Return what is said of an attribute that is never set to another value: perhaps a local variable is instead."""
        name, text = ast.unparse(attribute), "nothing in the code sets it to another value"
        for node in walk(source.class_at(attribute.lineno) or source.tree):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and node.id == attribute.attr:
                text += f": line {node.lineno} sets only a local variable {node.id}"
                fix = f"write {name} instead of {node.id} on line {node.lineno}"
                return Reason(text, source.at(node), fix, is_certain=True)
        return Reason(text, source.at(attribute), f"set {name} where it should change", is_certain=True)

    def _uncalled(self, source: PythonSource, function: Any, steps: int) -> Reason | None:
        """Return why a function was never called: nothing calls it, what calls it was not reached, or no message came."""
        text, place = f"{function.name}() was never called", source.at(function)
        for sources in map(self.look.sources, self.look.packages):
            for creation, callback in sources.callbacks():
                if callback is function:
                    topic = sources.value(creation.source, creation.given("topic"))
                    is_topic = creation.method == "create_subscription" and isinstance(topic, str)
                    return Reason(f"{text}: it received nothing on {topic}", place) if is_topic else None
        named = [
            (home, node)
            for home in self.look.files
            for node in home.nodes
            if function.name in (getattr(node, "attr", ""), getattr(node, "id", ""))
        ]
        if not named and not function.decorator_list and not function.name.startswith(("__", "on_")):
            fix = f"call {function.name}() where it is needed"
            return Reason(f"{text}: nothing calls it", place, fix, is_certain=not self._gets_by_name)
        home, statement = (named[0][0], statement_of(*named[0])) if len(named) == 1 else (source, None)
        if statement is None or self.record.count(home, statement):
            return Reason(text, place)
        further = self._why(home, statement, steps - 1)
        text = f"{text}, as line {statement.lineno}, which calls it, was not reached"
        return further.after(f"{text}: ") if further else Reason(text, place)

    @cached_property
    def _names(self) -> frozenset[str]:
        return frozenset(last_name(node) for source in self.look.files for node in source.nodes)

    @property
    def _sets_by_name(self) -> bool:
        """Whether anything sets attributes by names that are not in the text."""
        return not self._names.isdisjoint(("setattr", "__dict__", "vars"))

    @property
    def _gets_by_name(self) -> bool:
        """Whether anything asks for methods by names that are not in the text."""
        return not self._names.isdisjoint(("getattr", "globals", "attrgetter", "__dict__", "vars"))


def statement_of(source: PythonSource, node: ast.AST) -> ast.stmt | None:
    """Return the statement around an expression."""
    found: ast.AST | None = node
    while found is not None and not isinstance(found, ast.stmt):
        found = source.above(found)
    return found


def block_of(source: PythonSource, statement: ast.AST | None) -> list[ast.stmt]:
    """Return the statements of the block in which a statement is; empty if it is in none."""
    owner = source.above(statement) if statement is not None else None
    blocks = (getattr(owner, name, None) for name in ("body", "orelse", "finalbody"))
    return next((b for b in blocks if isinstance(b, list) and statement in b), [])


def _around(source: PythonSource, statement: ast.AST | None) -> tuple[ast.AST | None, list[ast.stmt]]:
    """Return what a statement is in, and the statements of its block there."""
    owner = source.above(statement) if statement is not None else None
    return owner, block_of(source, statement)


def _name_around(source: PythonSource, node: ast.stmt) -> str:
    return getattr(source.function_at(node.lineno), "name", "")


def _leaves(source: PythonSource, node: ast.AST, stuck: ast.stmt) -> bool:
    """Return whether an exit inside a statement leaves the statement too, and not only a loop in it."""
    around: ast.AST | None = node
    while around is not None and not isinstance(node, (ast.Return, ast.Raise)):
        if isinstance(around, _LOOPS):
            return False
        if around is stuck:
            break
        around = source.above(around)
    return True


def _caught(error: Error) -> Reason:
    """Return what is said of an exception that an `except` caught."""
    source, line = error.lines[-1]
    handler = error.handler[1] if error.handler else 0
    text = f"line {line} failed with {failed_with(error)}, which the `except` on line {handler} caught {times(error.count)}"
    fix = f"correct line {line}, and let the `except` show the error that it catches"
    return Reason(text, source.at(line), fix, is_certain=True, on_the_way=(source.at(handler),))
