"""The name in scope, the keyword or the attribute that is spelt almost like a name that nothing defines."""

from __future__ import annotations

import ast
import builtins
import keyword
import re
from collections.abc import Iterator
from difflib import SequenceMatcher

from ros2lab.diagnose.code.at_hand import is_own_node
from ros2lab.diagnose.code.bound_names import bound_in
from ros2lab.diagnose.code.main_guards import as_guard
from ros2lab.diagnose.code.unknown_names import Unknown, also_on, as_code, cause_of
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import bound_by
from ros2lab.diagnose.sources.python_source import own_nodes
from ros2lab.diagnose.sources.spelling import edits, has_other_words, same_letters

# Words of other languages, and what Python calls them.
_FOREIGN = {"this": "self", "null": "None", "nullptr": "None", "nil": "None", "undefined": "None"}

_KEYWORDS, _MEMBERS, _BUILTINS = 100, 101, 102  # how far they are; a name in scope is nearer
_ALIKE = 0.7
_SHORT = 2  # letters; a name of so few resembles too many others


def as_foreign(unknown: Unknown) -> tuple[str, str] | None:
    """Read the name as a word of another language: `this` for `self`."""
    word = _FOREIGN.get(unknown.name.lower())
    cause = f"Python has no {unknown.name}; in Python it is {word}."
    return (cause, unknown.with_text(unknown.node, word)) if word else None


def as_another(unknown: Unknown, *, is_class_meant: bool = False) -> tuple[str, str] | None:
    """Read the name as another that it resembles; if it begins with a small letter, as a class only if that is said to be meant."""
    name = unknown.name
    found = sorted(_candidates(unknown, is_class_meant=is_class_meant))
    if not found:
        return None
    *_, near = found[0]
    bound = _misspelt_where_bound(unknown, near)
    if bound is not None:
        number = getattr(bound, "lineno", 1)
        new = re.sub(rf"\b{near}\b", name, unknown.line(bound), count=1)
        cause = f"{cause_of(unknown)} Line {number} calls it {near}."
        return cause, f"write {as_code(new) or f'{name} instead of {near}'} on line {number}"
    fix = as_guard(unknown.statement, near) or unknown.with_text(unknown.node, near)
    more = also_on(unknown, near)
    if same_letters(name, near) and (near in dir(builtins) or keyword.iskeyword(near)):
        return f"Python has no {name}; in Python it is {near}.", fix + more
    return f"{cause_of(unknown)} Did you mean {near}?", fix + more


def _candidates(unknown: Unknown, *, is_class_meant: bool) -> Iterator[tuple[bool, float, int, float, str]]:
    """Yield names that may be meant, each with what tells how likely it is; the smallest is the likeliest.

    A name that is bound but never used comes first: its only use may be the misspelt one.
    """
    for candidate, far in _known(unknown).items():
        wanted = candidate.removeprefix("self.")
        if wanted == unknown.name or not _fits(unknown, candidate, is_class_meant=is_class_meant):
            continue
        is_of_file = far < _KEYWORDS or far == _MEMBERS
        if is_of_file and (has_other_words(unknown.name, wanted) or _meets_itself(unknown, candidate)):
            continue
        distance = edits(unknown.name, wanted)
        alike = SequenceMatcher(None, unknown.name, wanted).ratio()
        if far < _KEYWORDS:
            is_near = distance == 0 or alike >= _ALIKE or (distance == 1 and len(wanted) > _SHORT)
        elif far == _BUILTINS and not (unknown.is_called or unknown.is_type):
            is_near = distance == 0 or sorted(unknown.name) == sorted(wanted)
        else:
            is_near = distance < 2 and len(wanted) > _SHORT
        if is_near:
            is_idle = far < _KEYWORDS and distance < 2 and candidate not in unknown.loaded
            yield not is_idle, min(distance, 3), min(far, _KEYWORDS), -alike, candidate


def _known(unknown: Unknown) -> dict[str, int]:
    """Return the names in scope, the keywords, the attributes of self and the builtins, each with how far it is."""
    known: dict[str, int] = {}
    for far, scope in enumerate(unknown.scopes):
        known = dict.fromkeys(bound_in(scope), far) | known
    further = dict.fromkeys((*keyword.kwlist, *keyword.softkwlist), _KEYWORDS)
    further |= {f"self.{name}": _MEMBERS for name in unknown.members if "self" in known}
    return dict.fromkeys(dir(builtins), _BUILTINS) | further | known


def _fits(unknown: Unknown, candidate: str, *, is_class_meant: bool) -> bool:
    """Return whether a candidate can be used as the unknown name is: called, or asked for its attributes."""
    if keyword.iskeyword(candidate) or keyword.issoftkeyword(candidate):
        is_value = candidate in ("True", "False", "None")
        return not (unknown.is_called or unknown.attributes) if is_value else _reads(unknown, candidate)
    if candidate in dir(builtins):
        return unknown.attributes <= {*dir(getattr(builtins, candidate))}
    return _fits_as_named(unknown, candidate, is_class_meant=is_class_meant)


def _fits_as_named(unknown: Unknown, candidate: str, *, is_class_meant: bool) -> bool:
    """Return whether a name of the file can be used so, by what it stands for: a class, a module or a value."""
    is_free = not (unknown.is_called or unknown.attributes)
    target = unknown.source.names.get(candidate, "")
    is_own = candidate in unknown.source.classes
    is_class = candidate[:1].isupper() and (is_own or candidate in unknown.source.names)
    if unknown.name[:1].islower() and unknown.attributes and is_own_node(unknown, candidate):
        return False  # a class is no object
    if unknown.name[:1].islower() and is_class and not unknown.is_called:
        return is_class_meant and not (is_free and is_own)
    if unknown.name[:1].isupper() and (unknown.is_called or unknown.is_type) and not target:
        return candidate[:1].isupper()  # a class is called, and no variable
    names = interfaces.importable_names(target) if target and interfaces.is_module(target) else None
    return names is None or (not unknown.is_called and unknown.attributes <= names)


def _meets_itself(unknown: Unknown, candidate: str) -> bool:
    """Return whether an operation would have the same value on both sides with a name in place of the unknown one.

    Another unknown name that the same name resembles may mean it just as well.
    """
    match unknown.above():
        case ast.BinOp(left=left, right=right):
            beside = [left, right]
        case ast.Compare(left=left, comparators=values):
            beside = [left, *values]
        case ast.BoolOp(values=values):
            beside = values
        case _:
            return False
    others = [ast.unparse(value) for value in beside if value is not unknown.node]
    return any(other == candidate for other in others)


def _reads(unknown: Unknown, word: str) -> bool:
    """Return whether Python reads the statement with a keyword for the unknown name, and as something else."""
    statement, node = unknown.statement, unknown.node
    if statement.lineno != getattr(node, "lineno", 0):
        return False
    row = unknown.line(node).encode()
    new = row[: node.col_offset] + word.encode() + row[node.end_col_offset :]  # type: ignore[attr-defined]
    rows = unknown.source.text.encode().splitlines(keepends=True)
    rows[statement.lineno - 1] = new + b"\n"
    try:
        compile(b"".join(rows), "", "exec", dont_inherit=True)  # not run
    except (SyntaxError, ValueError):
        return False
    return True


def _misspelt_where_bound(unknown: Unknown, near: str) -> ast.AST | None:
    """Return where the near name is bound, if nothing uses it and the unknown name is used more than once."""
    bound = [n for scope in unknown.scopes for n in own_nodes(scope) if near in bound_by(n)]
    is_certain = len(unknown.uses) > 1 or unknown.name == "main"  # which the entry points name, too
    return bound[0] if is_certain and near not in unknown.loaded and len(bound) == 1 else None
