"""ROS's environment variables that a program sets for itself: it then does not meet those that do not."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ros2lab.diagnose.finding import Finding, in_a_row
from ros2lab.diagnose.nodes.partners import Partners
from ros2lab.diagnose.nodes.service_faults import ServiceEnd, service_ends
from ros2lab.diagnose.nodes.topic_faults import End, ends_of
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, own_nodes
from ros2lab.diagnose.sources.syntax_parts import removal

# The variables that decide who sees whom, with what they are where nobody sets them.
_DEFAULTS = {
    "ROS_DOMAIN_ID": "0",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
    "ROS_LOCALHOST_ONLY": "0",
    "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
}
# What may start other programs, for which a variable may be meant.
_STARTS_OTHERS = frozenset(("subprocess", "multiprocessing", "launch", "pty"))


@dataclass(frozen=True)
class Setting:
    """A line that sets a variable; its value is empty if it is not known."""

    name: str
    value: str
    source: PythonSource
    node: ast.AST


@dataclass(frozen=True)
class Program:
    """What an executable runs: a function of a module, with the files of its package."""

    sources: NodeSources
    module: str
    function: str

    @property
    def source(self) -> PythonSource:
        """The file with its function."""
        return self.sources.sources[self.module]

    @cached_property
    def files(self) -> list[PythonSource]:
        """The files that are read when it starts."""
        return [self.sources.sources[name] for name in self.sources.imported_by(self.module)]

    @cached_property
    def _settings(self) -> list[tuple[Setting, bool]]:
        """What it sets, each with whether that is after rclpy has begun."""
        found = [
            (s, False) for file in self.files for n in file.tree.body for s in _set(self.sources, file, n)
        ]
        _, main = self.sources.functions.get(f"{self.module}.{self.function}", (None, None))
        nodes = [*own_nodes(main)] if main else []
        inits = [
            n.lineno for n in nodes if isinstance(n, ast.Call) and self.source.resolve(n.func) == "rclpy.init"
        ]
        for node in nodes if inits else ():
            found += [
                (s, getattr(node, "lineno", 0) > min(inits)) for s in _set(self.sources, self.source, node)
            ]
        for owner in self.sources.nodes if inits else ():
            if owner.source in self.files and (begin := owner.methods.get("__init__")):
                found += [(s, True) for n in own_nodes(begin) for s in _set(self.sources, owner.source, n)]
        return found

    @property
    def settings(self) -> dict[str, Setting]:
        """What it sets before rclpy begins, by the name of the variable."""
        return {setting.name: setting for setting, is_late in self._settings if not is_late}

    @property
    def late(self) -> list[Setting]:
        """What it sets when rclpy has already read it, for itself alone."""
        starts = {i.target.partition(".")[0] for file in self.files for i in file.imports} & _STARTS_OTHERS
        return [setting for setting, is_late in self._settings if is_late and not starts]

    @cached_property
    def ends(self) -> list[End | ServiceEnd]:
        """Its ends of topics, services and actions."""
        found: list[End | ServiceEnd] = [*ends_of(self.sources), *service_ends(self.sources)]
        return [end for end in found if end.creation.source in self.files and end.name]


def environment_apart(programs: Sequence[Program], partners: Partners) -> Iterator[Finding]:
    """Yield variables that one program sets and another with which it talks does not, and those set too late."""
    told: set[str] = set()
    for program in programs:
        for setting in program.late:
            place = setting.source.at(setting.node)
            if place not in told:
                told.add(place)
                cause = f"{setting.name} is set here after rclpy.init(), which has already read it, so this changes nothing."
                fix = f"move this line above rclpy.init() in {program.source.shown}, or set {setting.name} in the terminal"
                yield Finding("environment-apart", cause, place, fix)
        for name, setting in program.settings.items():
            place = setting.source.at(setting.node)
            apart = [
                other
                for other in programs
                if _differ(name, program, other) and _talk(program, other, partners)
            ]
            if place not in told and apart:
                told.add(place)
                yield _apart(setting, apart)


def _apart(setting: Setting, apart: Iterable[Program]) -> Finding:
    name, value = setting.name, setting.value
    others = [*dict.fromkeys(other.source.shown.rpartition("/")[2] for other in apart)]
    own = {other.settings[name].value for other in apart if name in other.settings}
    s = "s" * (len(others) == 1)
    where = f"set{s} it to {in_a_row(sorted(own))}, so they never see each other"
    if not own:
        where = f"take{s} it from the terminal, so they see each other only if the terminal sets {value}, too"
    cause = f"This program sets {name} to {value} for itself, but {in_a_row(others)} {where}."
    fix = removal(setting.source, setting.node)
    if isinstance(setting.node, ast.Call) and setting.source.resolve(setting.node.func) == "rclpy.init":
        given = [ast.unparse(keyword) for keyword in setting.node.keywords if keyword.arg != "domain_id"]
        fix = f"write `rclpy.init({', '.join([*map(ast.unparse, setting.node.args), *given])})`"
    fix += f"; if {value} is meant, type `export {name}={value}` in every terminal instead"
    return Finding("environment-apart", cause, setting.source.at(setting.node), fix)


def _differ(name: str, program: Program, other: Program) -> bool:
    """Return whether two programs are known to have different values of a variable."""
    values = [p.settings[name].value if name in p.settings else _DEFAULTS[name] for p in (program, other)]
    return all(values) and values[0] != values[1]


def _talk(program: Program, other: Program, partners: Partners) -> bool:
    """Return whether two programs have two ends of one topic, service or action."""
    return any(
        end.name.lstrip("/") == facing.name.lstrip("/")
        and type(end) is type(facing)
        and _is_giving(end) is not _is_giving(facing)
        and partners.are_together(end, facing, [end, facing])
        for end in program.ends
        for facing in other.ends
    )


def _is_giving(end: End | ServiceEnd) -> bool:
    return end.is_publisher if isinstance(end, End) else end.is_server


def _set(sources: NodeSources, source: PythonSource, node: ast.AST) -> Iterator[Setting]:
    """Yield the variables about who sees whom that a statement sets."""
    pairs: list[tuple[ast.expr | None, ast.expr]] = []
    match node:
        case ast.Assign(targets=[ast.Subscript(value=owner, slice=key)], value=value):
            pairs = [(key, value)] if source.resolve(owner) == "os.environ" else []
        case ast.Expr(value=ast.Call() as call):
            node = call
            how = source.resolve(call.func) or ""
            if how in ("os.environ.setdefault", "os.putenv"):
                pairs = [(call.args[0], call.args[1])] if len(call.args) == 2 else []
            elif how == "os.environ.update":
                pairs = [
                    pair
                    for d in call.args
                    if isinstance(d, ast.Dict)
                    for pair in zip(d.keys, d.values, strict=True)
                ]
                pairs += [(ast.Constant(keyword.arg), keyword.value) for keyword in call.keywords]
            elif how == "rclpy.init" and "context" not in (named := {k.arg: k.value for k in call.keywords}):
                pairs = [(ast.Constant("ROS_DOMAIN_ID"), named["domain_id"])] if "domain_id" in named else []
    for named_by, given in pairs:
        is_number = isinstance(given, ast.Call) and getattr(given.func, "id", "") == "str" and given.args
        written = given.args[0] if isinstance(given, ast.Call) and is_number else given
        name, value = sources.value(source, named_by), sources.value(source, written)
        if name in _DEFAULTS:
            yield Setting(str(name), str(value) if isinstance(value, (str, int)) else "", source, node)
