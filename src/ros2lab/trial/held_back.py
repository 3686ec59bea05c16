"""Says what was not reached in a run: silent publishers, hidden errors, and what else has an effect."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence, Set
from dataclasses import replace
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding, keeps_from_working
from ros2lab.diagnose.nodes.topic_faults import ends_of
from ros2lab.diagnose.sources.node_source import LOG_METHODS, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes, walk
from ros2lab.trial.clauses import LEAST, on_one_line, times
from ros2lab.trial.failing import failed_with, is_of_code
from ros2lab.trial.following import overwritten, read_at, set_by
from ros2lab.trial.guards import only_warns
from ros2lab.trial.record import Error
from ros2lab.trial.unreached import Reason, Unreached, block_of, statement_of
from ros2lab.trial.words import untaken

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen
    from ros2lab.trial.witnessed import Witnessed

MOST = 3  # statements of which that is told
_SAYS = 3  # the rank of what only says something
_RARE = frozenset(
    ("debug", "error", "fatal", "critical")
)  # that nothing is logged with these is as it should be
_SENDS = frozenset(("publish", "call", "call_async", "send_goal", "send_goal_async", "cancel"))


def with_reasons(
    found: Sequence[Finding], read: Sequence[Finding], noted: Witnessed, seen: Seen
) -> tuple[list[Finding], list[Finding], list[Finding]]:
    """Return findings with the reasons of silent publishers, notes on what else was not reached, and what was read.

    A publisher may be right to be silent if its program publishes something else, and only some number has not passed
    a limit: an alarm that does not ring. What reading has found is not told again. A comparison that is never true may
    be intended, but may also explain other findings.
    """
    unreached, runs = noted.unreached, (*seen.alone, *seen.together)
    deaf = untaken(seen, unreached.record)
    if any(how.get("killed") for run in runs for how in run.stopped.values()):  # it could not write its notes
        told = [one for one in found if one.code != "publishes-nothing" or deaf.isdisjoint(one.about)]
        return [*told, *(noted.never if told else ())], [], [*read]
    working = [finding for finding in read if keeps_from_working(finding)]
    causes = {finding.place for finding in working}
    speaking = {run.programs[0] for run in seen.alone if seen.published(run)}
    told, places = _of_silent(found, unreached, causes, speaking, deaf)
    known = places | {finding.place for finding in read}
    reasons, explained = _notes(unreached), set_by([*working, *told], unreached.look)

    def is_new(*at: str) -> bool:
        return known.isdisjoint(at) and explained.isdisjoint(read_at(at, unreached.look))

    others = [(text, reason) for text, reason in reasons if is_new(*reason.places)][:MOST]
    notes = [Finding("never-passed", f"{text}.", reason.place) for text, reason in others]
    known = known.union(*(reason.places for _, reason in others))
    never, steady = ([one for one in ones if is_new(one.place)] for ones in (noted.never, noted.steady))
    steady += [note for note in overwritten(unreached.record) if is_new(note.place)]
    read = [_completed(finding, [reason for _, reason in reasons], unreached) for finding in read]
    return [*told, *(never if told else ())], [*notes, *steady, *(never if not told else ())], read


def _of_silent(
    found: Sequence[Finding], unreached: Unreached, causes: Set[str], speaking: Set[str], deaf: Set[str]
) -> tuple[list[Finding], set[str]]:
    """Return findings with the reasons of silent publishers, and the places that these reasons tell of.

    Args:
        found: the findings.
        unreached: what was not reached.
        causes: places whose fault is told already.
        speaking: the programs that published something.
        deaf: those of which it is not known whether they take what they were sent.
    """
    told, places = list[Finding](), set[str]()
    for finding in found:
        reason = _of_publisher(finding, unreached) if finding.code == "publishes-nothing" else None
        if reason is None:
            told.append(finding)
        elif (
            causes.isdisjoint(reason.places)
            and not (unreached.record.moving is not None and reason.is_coming)
            and not (reason.is_open and {*finding.about} <= speaking)
            and (reason.is_certain or deaf.isdisjoint(finding.about))
        ):
            cause = f"{finding.cause.rstrip('.')}: {reason.text}."
            told.append(replace(finding, cause=cause, place=reason.place, fix=reason.fix or finding.fix))
            places |= reason.places
    return told, places


def _completed(finding: Finding, reasons: Sequence[Reason], unreached: Unreached) -> Finding:
    """Return what reading has found with what the run shows of it: the errors that are hidden, or what is set instead."""
    cause = finding.cause.rstrip(".")
    if finding.code == "errors-hidden":
        for error in unreached.record.errors:
            if error.handler and error.handler[0].at(error.handler[1]) == finding.place and error.lines:
                where = f"on line {error.lines[-1][1]}"
                told = f"{cause}. In the run, it caught this {times(error.count)}, {where}: {failed_with(error)}."
                return replace(finding, cause=told, fix=f"correct line {error.lines[-1][1]}; {finding.fix}")
    for reason in reasons if finding.code == "never-passed" else ():
        if finding.place in reason.on_the_way and reason.fix:
            return replace(
                finding, cause=f"{cause}. In the run, {reason.text}.", place=reason.place, fix=reason.fix
            )
    return finding


def swallowed(unreached: Unreached) -> Iterator[tuple[Finding, str]]:
    """Yield the mistakes that an `except` for every error catches each time, each with the place of that `except`."""
    for error in unreached.record.errors:
        handler, failing = _tried(error)
        is_broad = handler is not None and (
            handler.type is None or ast.unparse(handler.type) in ("Exception", "BaseException")
        )
        is_mistake = is_of_code(error.kind, error.message) and error.count >= LEAST
        if handler is None or failing is None or not is_broad or not is_mistake:
            continue
        source = error.lines[0][0]
        if not unreached.record.count(source, failing):
            cause = f"`{on_one_line(failing)}` failed {error.count} times and never came to its end, which the `except` on line {handler.lineno} hides: {failed_with(error)}."
            fix = "correct the line that fails, and let the `except` name only the errors that you expect"
            yield Finding("errors-hidden", cause, error.place, fix), source.at(handler)


def _tried(error: Error) -> tuple[ast.ExceptHandler | None, ast.stmt | None]:
    """Return the `except` that caught an error, and the statement of its `try` that failed."""
    for source, line in error.lines[:1] if error.handler else ():
        for tried in (node for node in source.around(line, ast.Try)):
            for handler in tried.handlers:
                if error.handler and handler.lineno == error.handler[1]:
                    return handler, next((s for s in tried.body if line <= (s.end_lineno or 0)), None)
    return None, None


def _of_publisher(finding: Finding, unreached: Unreached) -> Reason | None:
    """Return why nothing was published by the publisher that a finding is about; None if that is not known."""
    for package in unreached.look.packages:
        for end in ends_of(unreached.look.sources(package)):
            source, kept = end.creation.source, end.creation.kept
            if end.place != finding.place or not end.is_publisher or not kept:
                continue
            calls = (call for call in source.calls if ast.unparse(call.func) == f"{kept}.publish")
            statements = [*filter(None, (statement_of(source, call) for call in calls))]
            if any(unreached.record.count(source, statement) for statement in statements):
                return None
            for statement in statements:
                if reason := unreached.why(source, statement):
                    return reason.after(
                        f"`{on_one_line(statement)}` on line {statement.lineno} was never carried out, because "
                    )
    return None


def _notes(unreached: Unreached) -> list[tuple[str, Reason]]:
    """Return what was not reached in functions that were called again and again, each with its reason."""
    found: dict[str, tuple[int, str, Reason]] = {}
    for source, function in unreached.record.marked(Function):
        calls = unreached.record.count(source, function)
        for statement in own_nodes(function) if calls >= LEAST else ():
            rank = _rank(source, statement)
            if (
                rank is None
                or not isinstance(statement, ast.stmt)
                or unreached.record.count(source, statement)
            ):
                continue
            if rank == _SAYS and only_warns(block_of(source, statement)):
                continue
            if (reason := unreached.why(source, statement)) and not reason.is_coming:
                text = (
                    f"In {calls} calls of {function.name}(), `{on_one_line(statement)}` was never carried out"
                )
                known = found.setdefault(reason.place, (rank, text, reason))
                found[reason.place] = (rank, text, reason) if rank < known[0] else known
    ordered = sorted(found.values(), key=lambda row: row[0])
    return [(f"{text}: {reason.text}", reason) for _, text, reason in ordered]


def _rank(source: PythonSource, node: ast.AST) -> int | None:
    """Return how much it matters that a statement is not reached, 0 the most; None if it has no effect elsewhere."""
    if not isinstance(node, (ast.Expr, ast.Assign, ast.AugAssign, ast.AnnAssign)):
        return None
    called = {getattr(inner.func, "attr", "") for inner in walk(node) if isinstance(inner, ast.Call)}
    if called & _SENDS:
        return 0
    if any(name.startswith("create_") for name in called):
        return 1
    targets = getattr(node, "targets", [getattr(node, "target", None)])
    if any(is_self_attribute(target) and _is_read(source, target.attr) for target in targets):
        return 2
    is_log = "get_logger" in called and called & (LOG_METHODS - _RARE)
    done = getattr(node.value, "func", None) if isinstance(node, ast.Expr) else None
    is_own = is_self_attribute(done) or getattr(done, "id", "") == "print"
    return _SAYS if is_log or is_own else None


def _is_read(source: PythonSource, name: str) -> bool:
    nodes = (node for node in source.nodes if isinstance(node, ast.Attribute))
    return any(node.attr == name and isinstance(node.ctx, ast.Load) for node in nodes)
