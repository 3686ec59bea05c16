"""Definitions that nothing uses, where something else shows that they were meant to be used."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator

from ros2lab.diagnose.code.expression_faults import chain_faults, keys_twice
from ros2lab.diagnose.code.lost_values import lost_values
from ros2lab.diagnose.code.result_faults import result_faults
from ros2lab.diagnose.code.shared_objects import shared_objects
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.nodes.state_faults import state_faults
from ros2lab.diagnose.sources.construction import may_be_made_unseen
from ros2lab.diagnose.sources.node_source import NodeClass, NodeSources, is_self_attribute
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, walk
from ros2lab.diagnose.sources.spelling import edits, words_of
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import calls_in
from ros2lab.diagnose.sources.uses import Uses, named, uses_of


def use_faults(sources: NodeSources) -> Iterator[Finding]:
    """Yield what the files of a package define or compute and do not use, or use when it is out of date."""
    if any(source.fault for source in sources.sources.values()):
        return  # a file that cannot be read may use anything
    uses = uses_of(sources)
    yield from _never_made(uses)
    yield from _in_another_program(sources)
    for source in sources.sources.values():
        yield from keys_twice(source)
        yield from chain_faults(source)
        for node in source.nodes:
            if isinstance(node, (ast.Module, ast.ClassDef)):
                yield from _replaced(uses, source, node)
    yield from result_faults(uses)
    yield from lost_values(uses)
    yield from state_faults(uses)
    yield from shared_objects(uses)
    yield from _parameters_unread(uses)


def _never_made(uses: Uses) -> Iterator[Finding]:
    """Yield node classes whose program instantiates neither them nor another one of its own."""
    names = {node_class.name for node_class in uses.sources.nodes}
    for owner in uses.sources.nodes:
        source, name = owner.source, owner.definition.name
        found = uses.sources.functions.get(f"{source.name}.main")
        if found is None or uses.resolved[owner.name] or uses.named[name]:
            continue
        if may_be_made_unseen(uses.sources, owner):
            continue
        main = found[1]
        loads = [node for node in walk(main) if isinstance(node, (ast.Name, ast.Attribute))]
        if any(uses.sources.resolve(source, node) in names for node in loads):
            continue  # it uses another node class
        made = next(
            (node for node in calls_in(walk(main)) if uses.sources.makes_node(source, None, main, node)), None
        )
        spun = next((dotted(n.func) or "" for n in calls_in(walk(main))), "")
        if made is None and not spun.startswith("rclpy."):
            continue
        fix = (
            f"write `{name}()` instead of `{ast.unparse(made)}`"
            if made
            else f"write `node = {name}()` in main, and `rclpy.spin(node)` below it"
        )
        cause = f"The class {name} is defined but never instantiated, so none of its code runs."
        yield Finding("never-made", cause, source.at(made or main), fix, never=(source.at(owner.definition),))


def _in_another_program(sources: NodeSources) -> Iterator[Finding]:
    """Yield variables of modules that one program changes and another reads: each has its own copy."""
    programs = {name for name in sources.sources if f"{name}.main" in sources.functions}
    imports = [{imported.target for imported in source.imports} for source in sources.sources.values()]
    if any(
        sum(any(t == p or t.startswith(f"{p}.") for t in names) for p in programs) > 1 for names in imports
    ):
        return  # one program may run the nodes of the others
    stores: dict[str, dict[str, ast.Attribute]] = {}
    loads: dict[str, set[str]] = {}
    for name in sorted(programs):
        source = sources.sources[name]
        for node in (node for node in source.nodes if isinstance(node, ast.Attribute)):
            variable = sources.resolve(source, node) or ""
            if not any(variable.startswith(f"{module}.") for module in sources.sources.keys() - programs):
                continue
            if isinstance(node.ctx, ast.Store):
                stores.setdefault(variable, {}).setdefault(name, node)
            else:
                loads.setdefault(variable, set()).add(name)
    for variable, by in stores.items():
        for reader in sorted(loads.get(variable, set()) - set(by)):
            name, node = next(iter(by.items()))
            shown = [sources.sources[program].shown.rpartition("/")[2] for program in (name, reader)]
            cause = f"{shown[0]} changes {ast.unparse(node)} and {shown[1]} reads it, but they are two programs, each with its own copy."
            fix = f"publish it on its own topic in {shown[0]}, such as /robot/state, and subscribe to that in {shown[1]}"
            yield Finding("never-passed", cause, sources.sources[name].at(node), fix)


def _replaced(uses: Uses, source: PythonSource, scope: ast.Module | ast.ClassDef) -> Iterator[Finding]:
    """Yield functions and classes that replace an earlier one of the same name in the same block."""
    seen: dict[str, ast.stmt] = {}
    for statement in scope.body:
        if not isinstance(statement, (Function, ast.ClassDef)) or statement.decorator_list:
            continue
        name, first = statement.name, seen.get(statement.name)
        seen[name] = statement
        if first is None or (name.startswith("_") and not name.startswith("__")):
            continue
        between = scope.body[scope.body.index(first) + 1 : scope.body.index(statement)]
        others = (node for middle in between if not isinstance(middle, Function) for node in walk(middle))
        if any(name in named(node) for node in others):
            continue  # the first one is used in between
        where = f" of {scope.name}" if isinstance(scope, ast.ClassDef) else ""
        what = f"{name}()" if isinstance(statement, Function) else f"The class {name}"
        if ast.dump(first) == ast.dump(statement):
            continue
        cause = f"{what}{where} is defined twice: this one replaces the one on line {first.lineno}, which is never called."
        if asked := _lacking(uses, scope, name):
            fix = f"write `def {asked[0]}` here, if it is the one that {asked[1]} calls; otherwise remove one of the two"
        else:
            fix = _one_of_two(uses, first, statement)
        yield Finding("replaced", cause, source.at(statement), fix, never=(source.at(first),))


def _one_of_two(uses: Uses, first: ast.stmt, last: Function | ast.ClassDef) -> str:
    """Return what to do with two definitions of one name: a draft goes, and two uses beside each other have one each."""
    if isinstance(last, ast.ClassDef) or not isinstance(first, Function):
        return f"merge the two, and remove the one on line {first.lineno}"
    given = [creation for creation, function in uses.sources.callbacks() if function is last]
    if _is_empty(first):
        return f"remove the one on line {first.lineno}, which does nothing"
    if _is_empty(last):
        return "remove this one, if it is only a draft"
    if len(given) == 2 and given[0].function is given[1].function:
        name = f"{last.name}_2"
        return f"write another name here, such as `def {name}`, and give self.{name} to {given[1].method} on line {given[1].call.lineno}"
    if last.name == "__init__":
        return f"merge the two, and remove the one on line {first.lineno}"
    return f"move the lines from line {first.lineno} on into this one, or remove this one"


def _lacking(uses: Uses, scope: ast.AST, name: str) -> tuple[str, str] | None:
    """Return a method one letter off that a class lacks, and the place that calls it on an object of the class; else None."""
    own = {n.name for n in getattr(scope, "body", ()) if isinstance(n, Function)}
    for file in uses.sources.sources.values():
        for call in file.calls:
            asked, held = getattr(call.func, "attr", ""), ast.unparse(getattr(call.func, "value", call))
            made = {last_name(getattr(value, "func", None)) for value in file.stored.get(held, ())}
            if made == {getattr(scope, "name", None)} and asked not in own and edits(asked, name) == 1:
                return asked, file.at(call)
    return None


def _is_empty(function: Function) -> bool:
    """Return whether a function does nothing, or only prints a text or says that it is to be written."""
    for node in function.body:
        match node:
            case ast.Pass() | ast.Return(value=None | ast.Constant()) | ast.Expr(value=ast.Constant()):
                pass
            case ast.Raise() if "NotImplementedError" in ast.unparse(node):
                pass
            case ast.Expr(value=ast.Call(func=ast.Name(id="print"), args=given)) if all(
                isinstance(value, ast.Constant) for value in given
            ):
                pass
            case _:
                return False
    return True


# What may read a parameter without its name.
_READS_ANY = frozenset(("get_parameters", "get_parameters_by_prefix", "get_parameter_or", "_parameters"))
_READS_ANY |= {"has_parameter", "add_on_set_parameters_callback", "add_post_set_parameters_callback"}


def _parameters_unread(uses: Uses) -> Iterator[Finding]:
    """Yield declared parameters that nothing reads, where an attribute is set to the default instead."""
    declared = declared_in(uses.sources) or {}
    if not _READS_ANY.isdisjoint(uses.named):
        return
    for source in uses.sources.sources.values():
        for owner, function, node in uses.sources.scoped(source):
            if not (
                isinstance(node, ast.Call)
                and getattr(node.func, "attr", "") == "declare_parameter"
                and node.args
            ):
                continue
            name = uses.sources.value(source, node.args[0])
            if (
                name not in declared
                or uses.named[str(name)] != 1
                or owner is None
                or _is_kept(function, node)
            ):
                continue
            field = _filled_with(owner, str(name), node.args[1] if len(node.args) > 1 else None)
            if field is None:
                continue  # it may be read from outside
            target = field.targets[0]
            cause = f"The parameter {name!r} is declared but never read, so setting it changes nothing."
            fix = f"write {ast.unparse(target)} = self.get_parameter({name!r}).value"
            if {*words_of(str(name))}.isdisjoint(words_of(ast.unparse(target))):
                fix += (
                    " if that is the value it should set; otherwise read it where it is meant, or remove it"
                )
            yield Finding("parameter-unread", cause, source.at(field), fix)


def _is_kept(function: Function | None, call: ast.Call) -> bool:
    """Return whether the return value of declare_parameter() is used."""
    statements = (
        {id(node.value) for node in walk(function) if isinstance(node, ast.Expr)} if function else set()
    )
    return id(call) not in statements


def _filled_with(owner: NodeClass, name: str, default: ast.expr | None) -> ast.Assign | None:
    """Return the only assignment of a parameter's default to what the parameter is meant for; None if it is not sure.

    An attribute of self has a word of its name and is set nowhere else, as a counter is; for a field of a message,
    the default must be more than 0, 1, or an empty string, which are written for anything, and be the only such value.
    """
    if not isinstance(default, ast.Constant):
        return None
    assigned = [node for node in walk(owner.definition) if isinstance(node, ast.Assign)]
    alike = [(node, node.targets[0]) for node in assigned if ast.dump(node.value) == ast.dump(default)]
    pairs = [(node, target) for node, target in alike if isinstance(target, ast.Attribute)]
    fit = [
        node
        for node, target in pairs
        if (
            not {*words_of(name)}.isdisjoint(words_of(target.attr)) and _is_set_once(owner, target)
            if is_self_attribute(target)
            else default.value not in _PLAIN and _is_only_value(assigned, target.attr)
        )
    ]
    return fit[0] if len(fit) == len(pairs) == 1 else None


_PLAIN = (0, 1, "")  # values that are written for anything


def _is_only_value(assigned: Iterable[ast.Assign], attr: str) -> bool:
    """Return whether a field gets only one value but those that are written for anything, so the code chooses none."""
    values = [node.value for node in assigned if getattr(node.targets[0], "attr", "") == attr]
    return len([v for v in values if not isinstance(v, ast.Constant) or v.value not in _PLAIN]) == 1


def _is_set_once(owner: NodeClass, target: ast.Attribute) -> bool:
    nodes = (node for node in walk(owner.definition) if isinstance(node, ast.Attribute))
    return sum(isinstance(node.ctx, ast.Store) and node.attr == target.attr for node in nodes) == 1
