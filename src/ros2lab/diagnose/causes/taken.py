"""Functions of the student's files that are given other arguments than they take: which side is wrong."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from ros2lab.diagnose.causes.later_calls import sources_around
from ros2lab.diagnose.code.lost_parameters import (
    Definition,
    calls_of,
    definitions,
    lost_by,
    lost_parameters,
    named_by,
    surplus,
    without_self,
)
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import spot_of
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, last_name, own_nodes, parameters

_SAYS = re.compile(
    r"(?P<name>[\w.<>]+)\(\) (?:takes (?:from \d+ to )?(?P<takes>\d+) positional arguments? but (?P<given>\d+) w"
    r"|missing \d+ required positional|got an unexpected keyword argument)"
)


def of_taken(error: ErrorText, look: Look) -> Finding | None:
    """Return the finding about a def that lacks a parameter with which it is called; None if a call is wrong."""
    report = error.report
    if report is None or report.kind not in ("TypeError", "NameError"):
        return None
    said = _SAYS.match(report.message)
    if said is None:
        return _of_name(error, look) if report.kind == "NameError" else None
    lacking = int(said["given"]) - int(said["takes"]) if said["takes"] else 0
    for definition, calls in _named(said["name"], sources_around(error, look)):
        is_taken = not said["takes"] or len(parameters(definition.function)) == int(said["takes"])
        if not is_taken:
            continue
        if definition.lacks_self or (lacking > 0 and _begins_without_self(definition)):
            return without_self(definition)
        if lost := lost_by(definition, calls, lacking):
            return lost
        if lacking > 0 and (more := _by_callers(definition, calls, lacking)):
            return more
    return None


def _named(name: str, every: Sequence[NodeSources]) -> Iterator[tuple[Definition, list[ast.Call]]]:
    """Yield the functions that Python calls so, each with its calls."""
    wanted = name.rpartition("<locals>.")[2]
    for sources in every:
        for source in sources.sources.values():
            for definition in definitions(source):
                if definition.name == wanted:
                    yield definition, [*calls_of(sources, definition)]


def _begins_without_self(definition: Definition) -> bool:
    """Return whether a method that is given one argument too many does not begin with self."""
    names = [parameter.arg for parameter in parameters(definition.function)]
    is_plain = definition.owner is not None and not definition.function.decorator_list
    return is_plain and names[:1] not in (["self"], ["cls"], ["this"], ["mcs"])


def _by_callers(definition: Definition, calls: Sequence[ast.Call], lacking: int) -> Finding | None:
    """Return the finding about a def that takes less than all its callers pass; None if only one does."""
    more = [call for call in calls if surplus(call, definition) == lacking]
    if not len(more) == len(calls) > 1:
        return None
    names = named_by(more[0], lacking)
    function, takes = definition.function, len(parameters(definition.function)) - bool(definition.owner)
    who = f"each of its {len(calls)} callers passes"
    cause = (
        f"{function.name}() takes {takes or 'no'} argument{'s' * (takes != 1)}, but {who} {takes + lacking}."
    )
    return Finding(
        "callback-arguments", cause, definition.source.at(function), f"write `{definition.with_more(names)}`"
    )


def _of_name(error: ErrorText, look: Look) -> Finding | None:
    """Return the finding about the function that fails at a name that its def lacks; None if it lacks none."""
    spot = spot_of(error.report, look)
    if spot.function is None:
        return None
    place = spot.file.at(spot.function)
    of_file = (
        lost for p in look.packages for lost in lost_parameters(look.sources(p)) if lost.place == place
    )
    return next(of_file, None)


_MORE = re.compile(
    r"(?P<name>[\w.<>]+)\(\) takes (?P<takes>\d+) positional arguments? but (?P<given>\d+) (?:was|were)"
)
_FEWER = re.compile(r"(?P<name>[\w.<>]+)\(\) missing \d+ required positional arguments?: (?P<missing>'.*')")


def of_parameters(error: ErrorText, look: Look) -> Finding | None:
    """Return the function whose parameters do not fit the call of a library; None for any other error."""
    report = error.report
    own = error.own
    if report is None or not report.frames or report.frames[-1] in own:
        return None
    more, fewer = _MORE.search(report.message), _FEWER.search(report.message)
    said = more or fewer
    home = _defined(said["name"], look) if said else None
    if said is None or home is None:
        return None
    source, function = home
    names = [parameter.arg for parameter in function.args.args]
    if more:
        number = int(more["given"]) - int(more["takes"])
        names += _new_names(source, function, number)
        cause = f"{function.name}() is called with {number} argument{'s' * (number > 1)} more than it takes."
    else:
        missing = set(re.findall(r"'(\w+)'", said["missing"]))
        used = {n.id for n in own_nodes(function) if isinstance(n, ast.Name)} & missing
        if used:
            return None
        names = [name for name in names if name not in missing]
        cause = f"{function.name}() is called without {' and '.join(sorted(missing))}."
    rest = function.args.vararg or function.args.kwonlyargs or function.args.kwarg or function.args.defaults
    if rest or function.lineno != function.body[0].lineno - 1:
        return None
    return Finding(
        "callback-arguments", cause, source.at(function), f"write `def {function.name}({', '.join(names)}):`"
    )


def _defined(name: str, look: Look) -> tuple[PythonSource, ast.FunctionDef] | None:
    """Return the only function of a qualified name, such as `Talk.done`, in the student's files; else None."""
    *owners, last = name.split(".")
    found: list[tuple[PythonSource, ast.FunctionDef]] = []
    for package in look.packages:
        for source in package.sources.values():
            tops = [
                n for n in source.nodes if isinstance(n, ast.ClassDef) and owners and n.name == owners[-1]
            ]
            bodies = [n for top in tops for n in top.body] if owners else source.tree.body
            found += [(source, n) for n in bodies if isinstance(n, ast.FunctionDef) and n.name == last]
    return found[0] if len(found) == 1 else None


def _new_names(source: PythonSource, function: ast.FunctionDef, number: int) -> list[str]:
    """Return names for the parameters that a function lacks, by what it is passed to."""
    calls = source.calls
    takers = [last_name(call.func) for call in calls if function.name in map(last_name, given_to(call))]
    if number > 1:
        return ["*args"]
    return ["future"] if "add_done_callback" in takers else ["event"]
