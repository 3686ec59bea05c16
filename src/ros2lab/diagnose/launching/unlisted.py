"""Actions of a launch file that are made and never put into the launch description."""

from __future__ import annotations

import ast
import contextlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.finding import lines_in_words
from ros2lab.diagnose.launching.launch_arguments import arguments_named
from ros2lab.diagnose.sources.commented_out import out_of_use
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk

_ACTIONS = ("launch.actions.", "launch_ros.actions.")


@dataclass(frozen=True)
class Unlisted:
    """A statement that makes actions that launch is never given, with its calls and their variable, if they have one."""

    source: PythonSource
    statement: ast.Assign | ast.Expr
    name: str
    made: tuple[ast.Call, ...]

    @property
    def kind(self) -> str:
        """The class of the action, such as `Node`."""
        return last_name(self.made[0].func)

    @property
    def is_left_out(self) -> bool:
        """Whether it is left out on purpose: a comment in the list or code out of use below it names it, or the same node is started.

        Launch would refuse one that reads an argument which the file does not declare.
        """
        source, names = self.source, re.compile(rf"\b{re.escape(self.name or '#')}\b")
        lists = [c for c in source.calls if last_name(c.func) == "LaunchDescription"]
        for number, text, _ in out_of_use(source.text):
            is_inside = any(c.lineno <= number <= (c.end_lineno or 0) for c in lists)
            if number > self._last and names.search(text) and (is_inside or _is_code(text)):
                return True
        asked = {n for c in self.made for n, _ in arguments_named(source, "LaunchConfiguration", within=c)}
        same = [c for c in source.calls if c is not self.made[0] and _alike(c) == _alike(self.made[0]) != {}]
        return bool(same) or not asked <= dict(arguments_named(source, "DeclareLaunchArgument")).keys()

    @property
    def listing(self) -> str:
        """How to put it into the description of the function that makes it: where its own line comes in the file."""
        functions = [n for n in self.source.nodes if isinstance(n, Function)]
        home = next((f for f in functions if self.statement in own_nodes(f)), self.source.tree)
        calls = [n for n in own_nodes(home) if isinstance(n, ast.Call)]
        descriptions = [c for c in calls if last_name(c.func) == "LaunchDescription"]
        items = next((n for call in descriptions for n in self._items(home, call)), None)
        kept = next((text for c in descriptions if (text := self.source.name_of(c))), "")
        is_early = kept and all(call.lineno < self._first for call in descriptions)
        if kept and (items is None or is_early):
            return f"{self._added(home, kept, descriptions, calls)}{self._gone}"
        where = self._below(home, items) if items else "as the first item in the list of LaunchDescription"
        return f"write `{'*' if self._is_list else ''}{self._given},` {where}{self._gone}"

    @property
    def _is_list(self) -> bool:
        return isinstance(self.statement.value, ast.List)

    @property
    def _given(self) -> str:
        return self.name or ast.unparse(self.made[0])

    @property
    def _first(self) -> int:
        return self.statement.lineno

    @property
    def _last(self) -> int:
        return self.statement.end_lineno or self.statement.lineno

    @property
    def _gone(self) -> str:
        """What is to be removed: the statement that made an action for nobody."""
        return "" if self.name else f", and remove {lines_in_words(self._first, self._last)}"

    def _added(
        self, home: ast.AST, kept: str, descriptions: Sequence[ast.Call], calls: Sequence[ast.Call]
    ) -> str:
        """Say to add it to a description that a variable holds, below what is made and added before it."""
        later = [c for c in calls if ast.unparse(c.func) == f"{kept}.add_action" and c.args]
        before = [c for c in later if self._made_at(home, c.args[0]) < self._first]
        line = max(self._last, *(c.end_lineno or 0 for c in [*descriptions, *before]))
        adding = f"{kept}.add_action({self._given})"
        if self._is_list:
            adding = f"for action in {self._given}: {kept}.add_action(action)"
        return f"write `{adding}` below line {line}"

    def _below(self, home: ast.AST, items: ast.List) -> str:
        """Say where it comes in the list of a description."""
        before = [item for item in items.elts if self._made_at(home, item) < self._first]
        is_named = bool(before) and isinstance(before[-1], ast.Name)
        where = f"below `{ast.unparse(before[-1])}`" if is_named else "as the first item"
        return f"{where} in the list on line {items.lineno}"

    def _items(self, home: ast.AST, description: ast.Call) -> Iterator[ast.List]:
        """Yield the lists that a description is given, as they are written."""
        for given in (*description.args, *(keyword.value for keyword in description.keywords)):
            names = {n.id for n in walk(given) if isinstance(n, ast.Name)}
            assigned = (n for n in own_nodes(home) if isinstance(n, ast.Assign))
            kept = [n.value for n in assigned if ast.unparse(n.targets[0]) in names]
            for value in (given, *kept):
                if isinstance(value, ast.List) or value is given:
                    yield from [n for n in walk(value) if isinstance(n, ast.List)][:1]

    def _made_at(self, home: ast.AST, item: ast.expr) -> int:
        """Return the line where an item of the description is made."""
        name = ast.unparse(item)
        assigned = (n for n in own_nodes(home) if isinstance(n, ast.Assign))
        made = [n.lineno for n in assigned if ast.unparse(n.targets[0]) == name]
        return made[0] if made else item.lineno


def _is_code(text: str) -> bool:
    with contextlib.suppress(SyntaxError, ValueError):
        return bool(ast.parse(text.strip()))
    return False


def _alike(call: ast.Call) -> dict[str, str]:
    """Return what two calls have in common that start the same node; empty for other actions."""
    given = {keyword.arg: ast.unparse(keyword.value) for keyword in call.keywords}
    names = ("package", "executable", "name", "namespace")
    return {name: given.get(name, "") for name in names} if "executable" in given else {}


def unlisted(source: PythonSource) -> Iterator[Unlisted]:
    """Yield the actions that nothing reads; one that is read only to wait for its node counts as not read."""
    waited = {id(n.value) for n in source.nodes if isinstance(n, ast.keyword) and n.arg == "target_action"}
    names = [n for n in source.nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)]
    read = {n.id for n in names if id(n) not in waited}
    for node in source.nodes:
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name not in read:
                made = tuple(value.elts) if isinstance(value, ast.List) else (value,)
            case ast.Expr(value=value):
                name, made = "", (value,)
            case _:
                continue
        calls = tuple(call for call in made if isinstance(call, ast.Call))
        are_actions = all((source.resolve(call.func) or "").startswith(_ACTIONS) for call in calls)
        if calls and len(calls) == len(made) and are_actions:
            yield Unlisted(source, node, name, calls)
