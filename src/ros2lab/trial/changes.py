"""Notes what attributes, variables and lists go through in each call of a callback; imports nothing of ros2lab.

A call begins when what is not watched, such as an executor, calls a
function of a watched file, and ends when the next one begins in the same thread.
"""

import ast
import contextlib
import enum
import sys
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from threading import get_ident
from types import CodeType, FrameType
from typing import Any

from .values import LONGEST, PLAIN, shown

NAME = "ros2lab_changes"  # of this module, and of what is called, in a running program
ADDS = {"append": -1, "appendleft": 0}  # the place of what is added
_MOST, _LONGEST_PATH, _MOST_PATHS, _MOST_ITEMS, _MOST_PRINTS, _MOST_PRINTED = 2000, 8, 12, 300, 6, 30
_DEEPEST, _LARGEST, _LONGEST_PRINT = 8, 1000, 4000
_MISSING = object()


class Call:
    """A call of a callback that goes on: its function, what was set in it, and the lists that got something in it."""

    def __init__(self, root: str, code: CodeType) -> None:
        self.root, self.code = root, code
        self.paths: dict[
            tuple[int, str], list[Any]
        ] = {}  # the value before, then the line, the place and the value
        self.lists: dict[str, tuple[Any, tuple[Any, ...], bool]] = {}


class Added:
    """What became of a list in the calls in which it got something at one place.

    Attributes:
        same: in how many calls in a row, up to the last one, it ended with the very items with which it had begun.
        is_disturbed: whether it changed again after that.
        repeats: how many times in a row it was given the same object.
        prints: the different contents of that object.
    """

    def __init__(self) -> None:
        self.root, self.kind = "", ""
        self.same = self.repeats = self.held = self.printed = 0
        self.is_disturbed = False
        self.last: tuple[Any, ...] = ()
        self.newest = 0  # its id; the object itself must not outlive what the program does with it
        self.prints: set[str] = set()

    def ended(self, root: str, before: tuple[Any, ...], now: Sequence[Any], *, is_new: bool) -> None:
        """Note what a call has left of a list.

        Args:
            root: the callback.
            before: the items with which the call began, each as `_item` gives it.
            now: those with which it ended.
            is_new: whether what was added was not among them.
        """
        items = (*map(_item, now),)
        is_same = len(before) > 0 and before == items
        self.is_disturbed |= self.same > 0 and not (is_same and self.last == before)
        self.same += is_same and is_new
        self.root, self.last = root, items
        self.held = sum(id(item) == self.newest for item in now)

    def repeated(self) -> tuple[str, int, int]:
        """Return the type of the object that it last got, how often it holds it, and how many contents that has had."""
        return self.kind, min(self.repeats, self.held), len(self.prints)

    def given(self, value: Any) -> None:
        """Note what was added."""
        if type(value) in PLAIN or isinstance(value, (enum.Enum, type, tuple, frozenset)):
            return
        is_again = id(value) == self.newest
        self.repeats = self.repeats + 1 if is_again else 1
        self.newest, self.kind = id(value), type(value).__name__
        if not is_again:
            self.prints.clear()
        if len(self.prints) < _MOST_PRINTS > self.repeats - len(self.prints) and self.printed < _MOST_PRINTED:
            self.printed += 1
            self.prints.add(_print(value))


class Changes:
    """What was noted in all calls.

    Args:
        paths: the watched files.
    """

    def __init__(self, paths: Any) -> None:
        self.files = paths
        self.calls: dict[int, Call] = {}
        self.notes: dict[str, Callable[[Any], Any]] = {}  # what is called at each place, with the owner
        self.left: Counter[str] = Counter()  # how often that was
        self.known: dict[tuple[int, str], Any] = {}
        self.closed: set[str] = set()  # the names that were set too often
        self.found: dict[tuple[str, str], Counter[Any]] = {}
        self.added: dict[str, Added] = {}

    def begun(self, place: str, _: Any) -> None:
        """Note that a function is entered that may be a callback."""
        with contextlib.suppress(Exception):  # nothing of this may reach the program
            self._begun(place, sys._getframe(1))

    def _begun(self, place: str, frame: FrameType) -> None:
        if self._is_over(place):
            self.notes.update(dict.fromkeys(self.notes, id))  # nothing is noted any more
        around = frame.f_back
        while around is not None and around.f_code.co_name == "<lambda>":
            around = around.f_back
        if around is None or around.f_code.co_filename not in self.files:
            thread = get_ident()
            if call := self.calls.get(thread):
                self.end(call)
            self.calls[thread] = Call(place, frame.f_code)

    def _is_over(self, place: str) -> bool:
        """Return whether a place was noted so often that it is not noted again."""
        self.left[place] += 1
        return self.left[place] >= _MOST

    def set_(self, place: str, name: str, key: Any, owner: Any) -> None:
        """Note that an attribute or a variable was set, or a key of it."""
        with contextlib.suppress(Exception):
            self._set(place, name, key, owner, sys._getframe(1))

    def _set(self, place: str, name: str, key: Any, owner: Any, frame: FrameType) -> None:
        if self._is_over(f"{place}:{name}"):
            self.closed.add(name)
            self.notes[f"{place}:{name}"] = id
        value = _held(owner, (name,))
        if key is not _MISSING:
            value = value.get(key, _MISSING) if type(value) is dict else _MISSING
            name = f"{name}[{key!r}]"
        value = _kept(value)
        known = id(owner), name
        before, self.known[known] = self.known.get(known, _MISSING), value
        if (call := self.calls.get(get_ident())) and (line := _line_in(call, frame)):
            path = call.paths.setdefault(known, [before])
            if len(path) <= _LONGEST_PATH + 1:
                path.append((line, place, value))

    def added_to(self, place: str, names: Sequence[str], at: int, owner: Any) -> None:
        """Note that a list has just got something, at one of its ends."""
        with contextlib.suppress(Exception):
            self._added_to(place, names, at, owner, sys._getframe(1))

    def _added_to(self, place: str, names: Sequence[str], at: int, owner: Any, frame: FrameType) -> None:
        if self._is_over(f"{place}:"):
            self.notes[f"{place}:"] = id
        if (call := self.calls.get(get_ident())) is None:
            return
        holder = _held(owner, names)
        is_list = (type(holder) is deque and holder.maxlen is None) or type(holder) is list
        if not is_list or not 0 < len(holder) <= _MOST_ITEMS or not _line_in(call, frame):
            return
        value = holder[at]
        seen = self.added.setdefault(place, Added())
        seen.given(value)
        if place not in call.lists:
            items = (*map(_item, holder),)
            before = items[1:] if at == 0 else items[:-1]
            is_new = _item(value) not in before
            call.lists[place] = (lambda: _held(owner, names), before, is_new)

    def end(self, call: Call) -> None:
        """Note what a call has changed in the end."""
        for (_, name), (before, *steps) in call.paths.items():
            if name.partition("[")[0] in self.closed or before is _MISSING:
                continue
            found = self.found.setdefault((call.root, name), Counter())
            is_known = all(value is not _MISSING for _, _, value in steps)
            is_back = is_known and _is_same(before, steps[-1][2]) and len(steps) <= _LONGEST_PATH
            path = (_shown(before), *((line, place, _shown(value)) for line, place, value in steps))
            if not is_back:
                found["changed"] += 1
            elif any(not _is_same(before, value) for _, _, value in steps):
                found[path if path in found or len(found) < _MOST_PATHS else "changed"] += 1
        for place, (now, before, is_new) in call.lists.items():
            holder = now()
            if type(holder) in (list, deque):
                self.added[place].ended(call.root, before, holder, is_new=is_new)

    def told(self) -> dict[str, Any]:
        """Return what was noted, as plain data: the paths that end where they began; and the lists, by their places.

        If something ended elsewhere at times, its paths are empty. The calls in which a list stayed the same are -1 if
        it changed again later.
        """
        for call in [*self.calls.values()]:
            self.end(call)
        paths = [
            (root, name, [] if "changed" in found else [*found.items()])
            for (root, name), found in self.found.items()
            if found
        ]
        lists = [
            (place, one.root, -1 if one.is_disturbed else one.same, len(one.last), *one.repeated())
            for place, one in self.added.items()
        ]
        return {"paths": paths, "lists": lists}


def _line_in(call: Call, frame: FrameType | None) -> int:
    """Return the line of the callback itself that led to a frame; 0 if it did not."""
    for _ in range(_DEEPEST):
        if frame is None:
            break
        if frame.f_code is call.code:
            return frame.f_lineno
        frame = frame.f_back
    return 0


def _held(owner: Any, names: Sequence[str]) -> Any:
    """Return what an object holds under some names, one in the other, without running code of the program."""
    for name in names:
        found = _MISSING
        if type(owner) is dict:
            found = owner.get(name, _MISSING)
        else:
            with contextlib.suppress(AttributeError):
                found = object.__getattribute__(owner, "__dict__").get(name, _MISSING)
            if found is _MISSING and hasattr(type(owner), "get_fields_and_field_types"):
                found = object.__getattribute__(owner, f"_{name}")
        owner = found
    return owner


def _kept(value: Any) -> Any:
    kind = type(value)
    return value if kind in PLAIN or isinstance(value, enum.Enum) else _MISSING


def _shown(value: Any) -> str:
    if isinstance(value, enum.Enum):
        return f"{type(value).__name__}.{value.name}"
    return shown(value)[:LONGEST]


def _is_same(value: Any, other: Any) -> bool:
    return value is other or (type(value) is type(other) and type(value) in PLAIN and bool(value == other))


def _item(value: Any) -> tuple[type, Any]:
    """Return what tells an item of a list from others, without keeping what is not plain, or asking it."""
    return type(value), value if type(value) in PLAIN else id(value)


def _print(value: Any) -> str:
    """Return the contents of a message, a list or a dict; empty of what may be the same thing at different times."""
    is_message = hasattr(type(value), "get_fields_and_field_types")
    with contextlib.suppress(Exception):
        if not is_message and type(value) not in (list, dict, set, deque):
            return ""
        slots: Any = (getattr(value, slot, None) for slot in type(value).__slots__) if is_message else value
        inside = [*slots.values()] if type(value) is dict else [*slots]
        if len(inside) + sum(len(item) for item in inside if hasattr(item, "__len__")) <= _LARGEST:
            return repr(value)[:_LONGEST_PRINT]
    return ""


class Noting:
    """What is written into a file so that its changes are noted.

    Args:
        tree: the file.
        key: names a place.
        changes: what notes them.
    """

    def __init__(self, tree: ast.AST, key: Callable[[Any], str], changes: Changes) -> None:
        self.key, self.changes = key, changes
        called = {id(node.func) for node in ast.walk(tree) if isinstance(node, ast.Call)}
        in_lambdas = [node for node in ast.walk(tree) if isinstance(node, ast.Lambda)]
        called -= {id(node) for one in in_lambdas for node in ast.walk(one)}
        names = (node for node in ast.walk(tree) if isinstance(node, (ast.Name, ast.Attribute)))
        self.named = {getattr(n, "attr", getattr(n, "id", "")) for n in names if id(n) not in called}
        self.owners: dict[int, str] = {}
        self.globals: dict[int, set[str]] = {}
        for function in ast.walk(tree):
            if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef)):
                first = [*function.args.posonlyargs, *function.args.args][:1]
                inside = [*ast.walk(function)]
                shared = {name for node in inside if isinstance(node, ast.Global) for name in node.names}
                for node in inside:  # an inner function comes later
                    self.owners[id(node)] = first[0].arg if first else self.owners.get(id(node), "")
                    self.globals[id(node)] = shared

    def entered(self, function: Any) -> Iterator[ast.expr]:
        """Yield a call at the beginning of a function that may be a callback."""
        if function.name in self.named or function.name.startswith("on_"):
            place = self.key(function)
            yield self._note(place, ast.Constant(None), self.changes.begun, place)

    def after(self, node: ast.AST) -> Iterator[ast.expr]:
        """Yield calls after a statement that sets something, or that adds something to a list."""
        targets = list[ast.expr]()
        match node if id(node) in self.globals else None:
            case ast.Assign(targets=several):
                targets = several
            case ast.AugAssign(target=one) | ast.AnnAssign(target=one, value=ast.expr()):
                targets = [one]
            case ast.Expr(value=ast.Call(func=ast.Attribute(value=holder, attr=name), args=args)):
                at = ADDS.get(name, 0 if name == "insert" and _is_zero(args[:1]) else None)
                owner, *names = _names(holder) or [""]
                if at is not None and owner:
                    found: ast.expr = ast.Name(owner, ast.Load()) if names else _globals()
                    place = self.key(node)
                    yield self._note(f"{place}:", found, self.changes.added_to, place, names or [owner], at)
        for target in targets:
            yield from self._set(node, target)

    def _set(self, node: ast.AST, target: ast.AST) -> Iterator[ast.expr]:
        is_key = isinstance(target, ast.Subscript) and isinstance(target.slice, ast.Constant)
        key = target.slice.value if is_key else _MISSING  # type: ignore[attr-defined]
        match target.value if is_key else target:  # type: ignore[attr-defined]
            case ast.Attribute(value=ast.Name(id=owner), attr=name) if owner == self.owners[id(node)]:
                found: ast.expr = ast.Name(owner, ast.Load())
            case ast.Name(id=name) if name in self.globals[id(node)]:
                found = _globals()
            case _:
                return
        place = self.key(node)
        yield self._note(f"{place}:{name}", found, self.changes.set_, place, name, key)

    def _note(self, key: str, owner: ast.expr, method: Callable[..., None], *given: Any) -> ast.expr:
        """Return a call that notes something of an owner."""
        self.changes.notes[key] = partial(method, *given)
        found = ast.Subscript(ast.Name(NAME, ast.Load()), ast.Constant(key), ast.Load())
        return ast.Call(found, [owner], [])


def _names(node: ast.expr) -> list[str]:
    """Return the parts of a dotted name; empty for anything else."""
    names = list[str]()
    while isinstance(node, ast.Attribute):
        names.insert(0, node.attr)
        node = node.value
    return [node.id, *names] if isinstance(node, ast.Name) else []


def _is_zero(args: Sequence[ast.expr]) -> bool:
    return any(isinstance(arg, ast.Constant) and arg.value == 0 for arg in args)


def _globals() -> ast.expr:
    return ast.Call(ast.Name("globals", ast.Load()), [], [])
