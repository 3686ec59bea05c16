"""Finds comparisons, conditions and lost texts that the types of their sides decide, as the type checker tells these."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import yaml

from ros2lab.diagnose.checking.checked_copies import Row, checked
from ros2lab.diagnose.checking.doubts import contradicted, is_asked_for, is_contradicted, is_of_several
from ros2lab.diagnose.checking.edits import Edit, all_applied, copied, revealing
from ros2lab.diagnose.checking.operands import held_in
from ros2lab.diagnose.checking.trials import UNKNOWN_TYPE, kinds_in, message_annotations, revealed_by
from ros2lab.diagnose.code.idle_statements import properties, tried_statements
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import defaults_of, equal_sides, own_parameters, removal

_FUNCTION = re.compile(r"(?:def|bound method|<method-wrapper|<wrapper-descriptor) .*|Overload\[.*\]")
# Each type in plain words, and how the type checker writes it; other types are not reported.
_FAMILIES = (
    ("a bool", re.compile(r"bool|Literal\[(?:True|False)(?:, ?(?:True|False))*\]")),
    ("a number", re.compile(r"int|float|Literal\[-?[\d.]+(?:, ?-?[\d.]+)*\]")),
    ("a string", re.compile(r"str|Literal\[\".*\"\]")),
    ("bytes", re.compile(r"bytes|bytearray|Literal\[b\".*\"\]")),
    ("a list", re.compile(r"list\[.*\]")),
    ("a tuple", re.compile(r"tuple\[.*\]")),
    ("a dict", re.compile(r"dict\[.*\]")),
    ("a set", re.compile(r"set\[.*\]")),
    ("None", re.compile(r"None")),
    ("a function", _FUNCTION),
)
_OBJECT = re.compile(r"[A-Z]\w*")
_NUMBER = re.compile(r"\s*[-+]?\d+(\.\d+)?\s*")


@dataclass(frozen=True)
class _Compared:
    """A side of a comparison, and the constants with which it is compared, all of one kind.

    There are none for a condition, which is its own side, and for a call whose result is lost.

    Attributes:
        side: the side that is not a constant; of a call, what stands before the method.
        is_equal: whether the operator is == or in, and not != or not in.
    """

    node: ast.expr
    side: ast.expr
    constants: Sequence[ast.Constant]
    is_equal: bool


def compared_types(look: Look, known: Collection[str]) -> Iterator[Finding]:
    """Yield comparisons that are always false, or always true, because of the types, at places without a finding."""
    for package in look.packages:
        sources = look.sources(package)
        for source in sources.sources.values():
            asked = _comparisons(source) if source.path and not source.fault else []
            if any(source.at(comparison.node) not in known for comparison in asked):
                kinds = _kinds(source, sources, look)
                told = [*zip(asked, kinds, strict=True)] if len(asked) == len(kinds) else []
                yield from _told(
                    sources, source, [pair for pair in told if source.at(pair[0].node) not in known], look
                )
            if source.path and not source.fault:
                yield from _of_attributes(source, sources, known)


def _comparisons(source: PythonSource) -> list[_Compared]:
    """Return the comparisons with constants, the bare conditions and the lost results, in the order of the file."""
    found = [*_compared(source), *_conditions(source), *_lost(source)]
    return sorted(found, key=lambda comparison: (comparison.side.lineno, comparison.side.col_offset))


def _compared(source: PythonSource) -> Iterator[_Compared]:
    for node in source.nodes:
        if not isinstance(node, ast.Compare) or len(node.ops) > 1:
            continue
        for side, others, is_equal in equal_sides(node):
            constants = [operand for operand in others if isinstance(operand, ast.Constant)]
            families = {_family_of(constant.value) for constant in constants}
            is_asked = len(constants) == len(others) and len(families) == 1 and "" not in families
            is_guard = ast.unparse(side) == "__name__" and families == {"a string"}  # a string in every file
            if is_asked and not is_guard and not isinstance(side, ast.Constant):
                yield _Compared(node, side, constants, is_equal)


def _conditions(source: PythonSource) -> Iterator[_Compared]:
    """Yield what a condition takes as true or false by itself: names that are no known values, or that are only asked, and what a node returns."""
    values = {name.rpartition(".")[2] for name in source.stored} | properties(source)
    for test in _tests(source):
        match test:
            case ast.Attribute(attr=name) | ast.Name(id=name) if name not in values:
                yield _Compared(test, test, (), is_equal=True)
            case ast.Name() | ast.Call() if _is_only_asked(source, test):
                yield _Compared(test, test, (), is_equal=True)


@lru_cache(maxsize=8)
def _tests(source: PythonSource) -> tuple[ast.expr, ...]:
    """Return the expressions of whose values only the truth counts."""
    found = [n.test for n in source.nodes if isinstance(n, (ast.If, ast.While, ast.IfExp, ast.Assert))]
    for node in source.nodes:
        match node:
            case ast.UnaryOp(op=ast.Not(), operand=value):
                found.append(value)
            case ast.BoolOp(values=[*values, _]):
                found += values
    for test in found:
        found += test.values[-1:] if isinstance(test, ast.BoolOp) else []
    return (*found,)


def _is_only_asked(source: PythonSource, value: ast.expr) -> bool:
    """Return whether only the truth of a value is used: of what a node returns, and of a name in its function or in a choice."""
    if is_self_attribute(value):
        return not any(_read_beside(source, value))
    if not isinstance(value, ast.Name):
        called = getattr(value, "func", None)
        owner = getattr(getattr(called, "value", None), "id", "")
        return owner in ("self", "node") and last_name(called) in interfaces.node_members()
    function, around = source.function_at(value.lineno), source.above(value)
    while around is not None and not isinstance(around, (ast.If, ast.IfExp, Function)):
        around = source.above(around)
    if function is None or value.id in defaults_of(function):
        return False
    is_given = value.id in [parameter.arg for parameter in own_parameters(function)]
    if is_given and function.name in (last_name(call.func) for call in source.calls):
        return False
    asked = {id(test) for test in _tests(source)}
    scopes = [function, *([around] if around is not None and getattr(around, "orelse", None) else [])]
    used = ([n for n in walk(scope) if isinstance(n, ast.Name) and n.id == value.id] for scope in scopes)
    return any(all(id(n) in asked or isinstance(n.ctx, ast.Store) for n in names) for names in used)


def _read_beside(source: PythonSource, value: ast.expr) -> Iterator[ast.AST]:
    """Yield where the function of an attribute reads it, but for the conditions that ask it."""
    asked, text = {id(test) for test in _tests(source)}, ast.unparse(value)
    function = source.function_at(value.lineno)
    for node in walk(function) if function else ():
        if is_self_attribute(node) and id(node) not in asked and ast.unparse(node) == text:
            yield node


# Without __init__, which is called in nearly every node: then the type checker would run for each of them.
_OF_STRINGS = frozenset(name for name in dir(str) if not name.startswith("__"))


def _lost(source: PythonSource) -> Iterator[_Compared]:
    """Yield the calls of methods that a string has, too, whose result is not used."""
    tried = tried_statements(source)
    for node in source.nodes:
        match node:
            case ast.Expr(value=ast.Call(func=ast.Attribute(value=side, attr=name)) as call) if (
                id(node) not in tried and name in _OF_STRINGS and not isinstance(side, ast.Constant)
            ):
                yield _Compared(call, side, (), is_equal=True)


def _kinds(source: PythonSource, sources: NodeSources, look: Look) -> list[str]:
    """Return the types of the sides as the type checker writes them, in file order; empty if unknown."""
    edits = [*message_annotations(source, look), *parameter_casts(source, sources)]  # none inside another
    known = copied(source, b"".join(all_applied(source.lines, edits)))
    asked = _comparisons(known)
    rows: list[Row] = checked(source, [revealing(known, [comparison.side for comparison in asked])])[0]
    kinds = kinds_in(rows)
    denied = contradicted(known, ((row.line, row.said) for row in rows))
    doubted = [
        is_asked_for(known, one.side) or is_contradicted(known, one.node.lineno, denied) for one in asked
    ]
    told = zip(doubted, kinds, strict=True) if len(kinds) == len(asked) else ()
    return ["Unknown" if is_doubted else kind for is_doubted, kind in told]


def _told(
    sources: NodeSources, source: PythonSource, asked: Sequence[tuple[_Compared, str]], look: Look
) -> Iterator[Finding]:
    own = {name.rpartition(".")[2] for name in sources.classes}
    stored = {name.rpartition(".")[2] for file in sources.sources.values() for name in file.stored}
    for comparison, kind in asked:
        parts = kind.replace("*", "").split(" | ") if is_of_several(kind) else [kind.replace("*", "")]
        families, text = {_family(part, own) for part in parts}, ast.unparse(comparison.side)
        if not comparison.constants:
            if comparison.node is not comparison.side and isinstance(comparison.node, ast.Call):
                yield from _new_text(source, comparison.node) if families == {"a string"} else ()
            elif families == {"a function"} and last_name(comparison.side) not in stored:
                cause = f"`{text}` only names a function: without parentheses it is not called, and as a condition it is always true."
                fix = f"write {_call(source, comparison.side, look)} instead of {text}"
                yield Finding("no-effect", cause, source.at(comparison.side), fix)
            elif _is_only_asked(source, comparison.side) and (fix := _meant(text, kind)):
                yield _always_true(source, comparison.side, kind, fix)
            continue
        wanted = _family_of(comparison.constants[0].value)
        if "" in families or wanted in families or (wanted == "a number" and "a bool" in families):
            continue
        if wanted != "a string" and any(_OBJECT.fullmatch(part) for part in parts):
            continue  # an object may define equality with a number
        cause = (
            f"`{text}` is {' or '.join(sorted(families))}, but {ast.unparse(comparison.constants[0])} is {wanted}, "
            f"so `{ast.unparse(comparison.node)}` is {'never' if comparison.is_equal else 'always'} true."
        )
        yield Finding("never-equal", cause, source.at(comparison.node), _fix(comparison, families, wanted))


def _always_true(source: PythonSource, side: ast.expr, kind: str, fix: str) -> Finding:
    short = re.sub("_(?=Request|Response)", ".", kind)
    cause = f"`{ast.unparse(side)}` is a whole {short}, which is always true, whatever is in it."
    return Finding("message-compared", cause, source.at(side), fix)


def _of_attributes(source: PythonSource, sources: NodeSources, known: Collection[str]) -> Iterator[Finding]:
    """Yield conditions that ask an attribute which holds an object of ROS from the beginning, whatever came since."""
    for test in _tests(source):
        if not is_self_attribute(test) or source.at(test) in known:
            continue
        text, kind = ast.unparse(test), _kind_of_all(sources, test.attr)
        fix = _meant(text, kind) if kind else ""
        if fix and (kind == "Parameter" or _is_only_asked(source, test)):
            yield _always_true(source, test, kind, fix)
        elif fix and _has_other_branch(source, test):
            cause = f"`{text}` is a {kind} from the beginning, which is always true, even before anything has come."
            yield Finding("message-compared", cause, source.at(test), f"set {text} = None in __init__")


def _kind_of_all(sources: NodeSources, name: str) -> str:
    """Return the class of which an attribute is always given an object; empty if it may hold anything else."""
    kinds, received = set[str](), {id(function) for _, function in sources.callbacks()}
    for source in sources.sources.values():
        for node in source.nodes:
            if not isinstance(node, ast.Attribute) or node.attr != name or isinstance(node.ctx, ast.Load):
                continue
            match source.above(node):
                case ast.Assign(targets=[ast.Attribute()], value=ast.Call(func=func)):
                    made = last_name(func)
                    kinds.add("Parameter" if made in _READERS else made if made[:1].isupper() else "")
                case ast.Assign(targets=[ast.Attribute()], value=ast.Name(id=given)):
                    function = source.function_at(node.lineno)
                    first = own_parameters(function)[:1] if function and id(function) in received else []
                    kinds |= set() if [parameter.arg for parameter in first] == [given] else {""}
                case _:
                    return ""
    return kinds.pop() if len(kinds) == 1 else ""


def _has_other_branch(source: PythonSource, test: ast.expr) -> bool:
    """Return whether something is done where a condition does not hold, and not only left."""
    around = source.above(test)
    is_denied = isinstance(around, ast.UnaryOp) and isinstance(around.op, ast.Not)
    around = source.above(around) if is_denied and around else around
    branch = (around.body if is_denied else around.orelse) if isinstance(around, ast.If) else []
    return any(isinstance(statement, (ast.Expr, ast.Assign)) for statement in branch)


def _meant(text: str, kind: str) -> str:
    """Say what to ask of an object of ROS that is always true itself; empty if its class may decide otherwise."""
    if held := held_in(text, kind):
        return f"write {held} instead of {text}"
    homes = interfaces.homes_of(kind)
    if fields := next(filter(None, (interfaces.fields_of(f"{home}.{kind}") for home in homes)), None):
        bools = [name for name, field in fields.items() if field == "boolean"]
        if len(bools) == 1:
            return f"write {text}.{bools[0]} instead of {text}"
        return f"write one of its fields, such as {text}.{next(iter(fields))}, instead of {text}"
    plain = [home for home in homes if (found := interfaces.class_in(home, kind)) and not found.bases]
    decides = {"__bool__", "__len__"} & {name for home in plain for name in interfaces.members_of(home, kind)}
    methods = interfaces.methods_of(kind)
    return f"ask what it has instead: {methods}" if plain and methods and not decides else ""


def _new_text(source: PythonSource, call: ast.Call) -> Iterator[Finding]:
    """Yield the finding of a call that makes another string of one, where that is not used."""
    text = ast.unparse(call)
    begin: ast.expr = call
    while (
        isinstance(begin, ast.Call)
        and isinstance(begin.func, ast.Attribute)
        and hasattr(str, begin.func.attr)
    ):
        begin = begin.func.value
    made = f"str().{last_name(call.func)}({', '.join(map(ast.unparse, (*call.args, *call.keywords)))})"
    if revealed_by(source, Edit(call, f"reveal_type({made})")) == "str":
        cause = f"`{text}` returns a new string and changes nothing, and what it returns is not used."
        fix = f"write {ast.unparse(begin)} = {text}"
        fix = fix if dotted(begin) else f"use what it returns, or {removal(source, call, 'this line')}"
        yield Finding("no-effect", cause, source.at(call), fix)


def _call(source: PythonSource, function: ast.expr, look: Look) -> str:
    """Return how to call a function, as far as the type checker knows."""
    text = ast.unparse(function)
    edits = [*message_annotations(source, look), Edit(function, f"{text}()")]
    (rows,) = checked(source, [b"".join(all_applied(source.lines, edits))])
    lacking = ("missing-argument", "no-matching-overload")
    is_short = any(row.line == function.lineno and row.rule in lacking for row in rows)
    return f"{text}(...), with what it needs in the parentheses," if is_short else f"{text}()"


def _family(kind: str, own: Collection[str]) -> str:
    """Return a type in plain words; empty if it is unknown, or if its instances may equal anything."""
    if UNKNOWN_TYPE.search(kind) and not _FUNCTION.fullmatch(kind):
        return ""
    if found := next((name for name, pattern in _FAMILIES if pattern.fullmatch(kind)), ""):
        return found
    return f"an instance of the class {kind}" if _OBJECT.fullmatch(kind) and kind not in own else ""


def _family_of(value: object) -> str:
    """Return the type of a constant in plain words; empty for None and the like."""
    if isinstance(value, (bool, int, float)):
        return "a number"
    if isinstance(value, str):
        return "a string"
    return "bytes" if isinstance(value, bytes) else ""


def _fix(comparison: _Compared, families: Collection[str], wanted: str) -> str:
    """Say how to make the two sides comparable."""
    text, value = ast.unparse(comparison.side), comparison.constants[0].value
    family = next(iter(families)) if len(families) == 1 else ""
    meant = [*map(_as_plain, comparison.constants)]
    if family == "a bool" and len({*map(bool, meant)}) == 1 and not any(isinstance(m, str) for m in meant):
        negated = "" if bool(meant[0]) is comparison.is_equal else "not "
        return f"write `{negated}{text}` instead of `{ast.unparse(comparison.node)}`"
    sign, word = ("==", "in") if comparison.is_equal else ("!=", "not in")
    if len(meant) > 1:
        are_numbers = family == "a number" and all(isinstance(m, (int, float)) for m in meant)
        both = f"compare what is {wanted} on both sides"
        return f"write `{text} {word} {tuple(meant)!r}`" if are_numbers else both
    match (family, value):
        case "a function", _:
            fix = f"write {text}() instead of {text}"
        case "an instance of the class Parameter", _:
            fix = f"write {text}.value instead of {text}"
        case "a number", str() if _NUMBER.fullmatch(value):
            fix = f"write `{text} {sign} {value.strip()}`"
        case "a number", str():
            fix = f"write `str({text}) {sign} {value!r}`"
        case "a bool", str():
            fix = f"compare {text} with True or False"
        case "a string", bytes():
            fix = f"write `{text} {sign} {value.decode(errors='replace')!r}`"
        case "a string", _:
            fix = f"write `{text} {sign} {str(value)!r}`"
        case "bytes", str():
            fix = f"write `{text} {sign} {value.encode()!r}`"
        case (("a list" | "a tuple" | "a set" | "a dict"), _):
            fix = f"write `{value!r} {word} {text}`, or compare one of its items"
        case _:
            fix = f"compare what is {wanted} on both sides"
    return fix


def _as_plain(constant: ast.Constant) -> object:
    """Return what a text means where YAML reads it, such as True for 'true'; another value as it is."""
    if not isinstance(constant.value, str):
        return constant.value
    try:
        return yaml.safe_load(constant.value.strip())
    except (yaml.YAMLError, ValueError):
        return constant.value


_READERS = frozenset(("get_parameter", "declare_parameter"))
_TYPES = (bool, int, float, str)  # their names convert a value, which tells its type


def parameter_casts(source: PythonSource, sources: NodeSources) -> Iterator[Edit]:
    """Yield edits that convert each parameter that is read to the type of its default, if that is known."""
    values = [node for node in source.nodes if isinstance(node, ast.Attribute) and node.attr == "value"]
    reads = [(node, name) for node in values if (name := _name_read(node, source, sources))]
    declared = declared_in(sources) if reads else None
    for node, name in reads:
        kind = type((declared or {}).get(name))
        if kind in _TYPES:
            yield Edit(node, f"{kind.__name__}({ast.unparse(node)})")


def _name_read(node: ast.Attribute, source: PythonSource, sources: NodeSources) -> str:
    """Return the name of the parameter whose value an expression reads; empty if it reads none."""
    match node.value:
        case ast.Call(func=ast.Attribute(attr=method), args=[given, *_]):
            name = sources.value(source, given) if method in _READERS else None
            return name if isinstance(name, str) else ""
    return ""
