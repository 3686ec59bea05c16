"""Look behind the line of an error: where what it uses was made, set, written or read."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.causes.class_bodies import of_class_body
from ros2lab.diagnose.causes.elements import key_asked
from ros2lab.diagnose.causes.format_texts import of_format
from ros2lab.diagnose.causes.interface_parts import of_clock_types, of_part
from ros2lab.diagnose.causes.origins import of_argument, of_origin, of_parameter
from ros2lab.diagnose.causes.read_keys import of_data_file, of_read_key
from ros2lab.diagnose.causes.refused_value import of_filled, of_item, of_refused
from ros2lab.diagnose.causes.terminal_variables import of_variable
from ros2lab.diagnose.causes.unfit_parameters import of_unfit_parameter
from ros2lab.diagnose.causes.wrong_literals import of_wrong_literal
from ros2lab.diagnose.checking.items import of_named_item
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorReport, ErrorText
from ros2lab.diagnose.printed.spots import Spot, place_of, spot_at, spot_of
from ros2lab.diagnose.sources.python_source import Function, PythonSource, own_nodes


def where_made(error: ErrorText, known: list[Finding], look: Look) -> list[Finding]:
    """Return what is wrong where a value, class or function used on an error's line was made."""
    report = error.report or ErrorReport("", "")
    spot = spot_of(report, look)
    if (source := spot.source) is None:
        return []
    message, lines = report.message, _lines_of_use(source, spot)
    by_comma = {f"{source.shown}:{line}" for line in {*lines, *spot.lines}}
    if commas := [
        finding for finding in known if finding.code == "comma-tuple" and finding.place in by_comma
    ]:
        return commas
    if early := _told_at_once(report, spot, look):
        return [early]
    if report.kind == "KeyError" and (missing := _of_key(message, spot, error, look)):
        return [missing]
    places = {f"{source.shown}:{line}" for line in lines - {spot.line}}
    found = [finding for finding in known if finding.place in places and finding.code in _MAKES_WRONG]
    if found or report.kind not in ("AttributeError", "TypeError"):
        return found
    caller = spot_at(place_of(error.own[1:2], look), look)
    made = of_argument(message, spot, caller) or of_origin(report.kind, message, spot)
    return [made] if made else []


def _told_at_once(report: ErrorReport, spot: Spot, look: Look) -> Finding | None:
    """Return what an error's message and its line tell together; None if they tell nothing."""
    kind, message = report.kind, report.message
    return (
        of_named_item(message, spot)
        or of_parameter(message, spot)
        or of_unfit_parameter(message, spot)
        or of_filled(message, spot)
        or of_item(message, spot)
        or of_refused(message, spot, look)
        or (of_wrong_literal(message, spot, (), look) if kind in ("TypeError", "error") else None)
        or of_class_body(kind, message, spot)
        or of_format(kind, message, spot)
        or of_part(kind, spot)
        or of_clock_types(message, spot)
        or of_data_file(kind, message, look)
    )


def _lines_of_use(source: PythonSource, spot: Spot) -> set[int]:
    """Return the lines of a file that define what one of its lines uses."""
    named = (n for n in spot.nodes if isinstance(n, (ast.Name, ast.Attribute)))
    used = {ast.unparse(n) for n in named if isinstance(n.ctx, ast.Load)}
    used |= {ast.unparse(n.target) for n in spot.nodes if isinstance(n, ast.AugAssign)}
    lines: set[int] = set()
    for node in source.nodes:
        if isinstance(node, ast.ClassDef) and node.name in used:
            lines |= {node.lineno, *(method.lineno for method in node.body)}
        elif isinstance(node, Function) and used & {node.name, f"self.{node.name}"}:
            lines |= {node.lineno, *(n.lineno for n in own_nodes(node) if isinstance(n, ast.Return))}
        elif isinstance(node, ast.Assign) and used & {
            whole for target in node.targets for whole in _with_owners(target)
        }:
            lines |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return lines


def _with_owners(target: ast.expr) -> Iterator[str]:
    """Yield a target and each object that it is part of, as `msg.header` and `msg` for `msg.header.stamp`."""
    yield ast.unparse(target)
    while isinstance(target, ast.Attribute):
        target = target.value
        if not isinstance(target, ast.Name) or target.id != "self":
            yield ast.unparse(target)


# Findings about values or classes made other than was meant, so that using them fails.
_MAKES_WRONG = frozenset(
    ("comma-tuple", "comma-missing", "super-misspelt", "super-missing", "parameter-type", "name-shadowed")
)


def _of_key(message: str, spot: Spot, error: ErrorText, look: Look) -> Finding | None:
    """Return a finding about a missing key of the environment or of a file; None if it is neither."""
    asked = key_asked(spot, message)
    if asked is None or not (spot.is_innermost or ast.unparse(asked.slice) == message):
        return None
    try:
        key = ast.literal_eval(message)
    except (SyntaxError, ValueError):
        return None
    if ast.unparse(asked.value) in ("os.environ", "environ"):
        return of_variable(str(key), spot.file.at(spot.line), error)
    return of_read_key(key, asked, spot, look) if look and isinstance(key, str) else None
