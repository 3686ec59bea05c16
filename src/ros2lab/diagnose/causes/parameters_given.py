"""A function of the student's that a library calls with more or fewer arguments than it takes."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, last_name, own_nodes

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
