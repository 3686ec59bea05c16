"""Findings and sentences about parameters that were set while nodes ran."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import PythonSource, last_name, read_text
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.uses import uses_of
from ros2lab.trial.given import GivenRun, given_faults
from ros2lab.trial.set_values import Setting, told
from ros2lab.trial.spoken import value_of

if TYPE_CHECKING:
    from ros2lab.trial.seen import Seen

# Other ways in which code hears of a parameter, or sets it.
_OTHERWISE = re.compile(r"\w*Parameter(Event|Client)\w*|SetParameters|(parameter_ev|set_param)\w+")
# What a line may say of a parameter that is for the start only.
_START = re.compile(r"start|launch|\bonce\b|initial|fixed|constant", re.IGNORECASE)
_READS = re.compile(r"(get|declare)_parameter\w*")


class _Code:
    """The files of a program; the `callbacks` that are called when a parameter is set, and all that is `reached` there."""

    def __init__(self, seen: Seen, program: str) -> None:
        entry = seen.entry(program)
        self.files = entry[0].around(entry[1]) or entry[0] if entry else NodeSources({})
        scopes = [
            (source, one) for source in self.files.sources.values() for one in self.files.scoped(source)
        ]
        self._nodes = [(source, function, node) for source, (_, function, node) in scopes]
        functions = [(s, node) for s, _, node in self._nodes if isinstance(node, ast.FunctionDef)]
        self._calls = [(s, n) for s, _, n in self._nodes if isinstance(n, ast.Call) and n.args]
        tell = [n for _, n in self._calls if str(last_name(n.func)).endswith("set_parameters_callback")]
        passed = {last_name(call.args[0]) for call in tell}
        self.callbacks = [(s, node) for s, node in functions if node.name in passed]
        self.reached, waiting = dict[ast.AST, PythonSource](), [*self.callbacks]
        for source, function in waiting:
            inner = [node for node in ast.walk(function) if node not in self.reached]
            self.reached |= dict.fromkeys(inner, source)
            named = {node.attr for node in inner if is_self_attribute(node)}
            waiting += [one for one in functions if one[1].name in named and one[1] not in self.reached]
        readmes = map(read_text, seen.look.root.glob("src/**/README*"))
        texts = [*readmes, *(source.text for source in self.files.sources.values())]
        self._rows = [row for text in texts for row in text.splitlines() if _START.search(row)]

    def is_for_start(self, name: str) -> bool:
        """Return whether a line of the files or a README may say that a parameter is for the start only."""
        return any(re.search(rf"\b{re.escape(name)}\b", row) for row in self._rows)

    def read(self, name: str) -> str:
        """Return the place where the value of a parameter is taken, or else that given when it is declared."""
        used = [(s, n, last_name(n.func)) for s, n in self._calls if not isinstance(s.above(n), ast.Expr)]
        given = [one for one in used if name in _texts(one[1].args[0]) and _READS.fullmatch(one[2])]
        return next((s.at(n) for s, n, how in sorted(given, key=lambda one: one[2][0] != "g")), "")

    def is_once(self, name: str) -> bool:
        """Return whether a parameter is read, but not where it may have changed, and nothing says that this is meant."""
        return self.read(name) != "" and not (self.is_for_start(name) or self.may_change_later(name))

    def may_change_later(self, name: str) -> bool:
        """Return whether anything but the constructors and the callbacks may take a new value."""
        uses = uses_of(self.files)
        stored = {n.attr for n in self.reached if is_self_attribute(n) and isinstance(n.ctx, ast.Store)}
        plain = [(call, call.args[0]) for _, call in self._calls if isinstance(call.args[0], ast.Constant)]
        others = {id(call.func) for call, given in plain if given.value != name}
        for _, function, node in self._nodes:
            if function is None or function.name == "__init__" or node in self.reached:
                continue
            attr = getattr(node, "attr", "") if isinstance(getattr(node, "ctx", None), ast.Load) else ""
            of_timer = any(made.method == "create_timer" for made in uses.callbacks.get(id(function), ()))
            is_kept = attr in stored and not of_timer
            if is_kept or (attr.startswith("get_parameter") and id(node) not in others):
                return True
        return any(map(_OTHERWISE.fullmatch, uses.named))


def is_to_start(seen: Seen, setting: Setting) -> bool:
    """Return whether a start with a value that was set in vain shows something that can be told."""
    programs = [run.programs[0] for run in seen.alone if setting.is_idle and setting.node in run.nodes]
    return any(_Code(seen, program).is_once(setting.name) for program in programs)


def parameter_faults(
    seen: Seen, ran: GivenRun, given: GivenRun | None, read: Iterable[Finding]
) -> Iterator[Finding]:
    """Yield what is certainly wrong with how nodes take their parameters, and neither reading nor giving has found."""
    last = [*ran.fatal[0].items()] if ran.fatal and not (given and given.run.ended) else []
    for found in given_faults(seen, ran) if last and last[0][0][0] != "/" else ():
        what = f"{last[0][0]} was set to {value_of(last[0][1])}"
        yield replace(found, cause=f"Soon after {what}, the program ended: {found.cause}")
    known = {finding.place for finding in read}
    for setting in ran.settings:
        for run in (one for one in seen.alone if [setting.node] == one.nodes):
            code = _Code(seen, run.programs[0])
            near = {source.at(n) for n, source in code.reached.items() if hasattr(n, "lineno")}
            is_new = known.isdisjoint(near) and bool(code.callbacks) and len(code.files.nodes) == 1
            fault = _fault(setting, code, run.parameters.get(setting.node, ())) if is_new else None
            if fault:
                known.add(fault.place)
                yield fault


def _fault(setting: Setting, code: _Code, declared: Iterable[str]) -> Finding | None:
    name, texts = setting.name, {n: n.value for n in code.reached if isinstance(n, ast.Constant)}
    is_own, is_no = name in texts.values(), any(value is False for value in texts.values())
    source, function = code.callbacks[0]
    called, place = f"{function.name}()", source.at(function)
    if setting.taken is False and not (setting.reason or is_no):
        cause = f"{setting.shown} was refused without a reason, and so was the value that it has: {called} accepts nothing."
        fix = "return SetParametersResult(successful=True) where it accepts: without successful=True, it refuses"
        return Finding("value-none", cause, place, fix)
    if setting.late:
        cause = f"When {name} was set to {value_of(setting.value)}, nothing changed, but when it was set back, {told(setting.late)}: {called} uses the value before."
        fix = f"in {called}, take the `.value` of the parameters that it is given before it is used; get_parameter() may still return the old one there"
        return Finding("callback-waits", cause, place, fix)
    is_of_others = not is_own and not {*declared}.isdisjoint(map(str, texts.values()))
    if is_of_others or not _is_in_vain(setting, code):
        return None
    cause = f"{_in_vain(setting)}, although {called} accepts it."
    tests = [node for test in code.reached if isinstance(test, ast.Compare) for node in ast.walk(test)]
    slip = next((n for n in tests if n in texts and not is_own and nearest(name, [texts[n]])), None)
    if slip:
        cause += f" It compares with {texts[slip]!r}, but the name is {name!r}."
        fix = f"write {name!r} instead of {texts[slip]!r}"
        return Finding("parameter-name", cause, code.reached[slip].at(slip), fix)
    fix = f"in {called}, give the new value to all that {code.read(name)} gave it to; a timer keeps its period, and a computed value stays as it is"
    return Finding("parameter-once", cause, place, fix)


def _is_in_vain(setting: Setting, code: _Code) -> bool:
    """Return whether a value counts at the start, and was taken later without any effect, which nothing says to be meant."""
    return bool(setting.at_start) and code.is_once(setting.name)


def _in_vain(setting: Setting) -> str:
    return f"{setting.shown}, set while {setting.node} ran, changed nothing; if it starts with it, {told(setting.at_start)}"


def told_of_set(seen: Seen, ran: GivenRun | None) -> Iterator[str]:
    """Say in sentences what nodes did with parameters that were set while they ran."""
    for setting in ran.settings if ran else ():
        for run in (one for one in seen.alone if setting.node in one.nodes):
            code = _Code(seen, run.programs[0])
            if setting.changes:
                yield f"With {setting.shown}, set while {setting.node} ran, {told(setting.changes)}."
            elif setting.taken is False:
                why = f": {setting.reason.rstrip('.')}" if setting.reason else ""
                yield f"{setting.node} refused {setting.shown}{why}."
            elif not code.callbacks and _is_in_vain(setting, code):
                yield f"{_in_vain(setting)}: it is read once, at {code.read(setting.name)}."


def _texts(node: ast.expr) -> set[object]:
    return {one.value for one in ast.walk(node) if isinstance(one, ast.Constant)}
