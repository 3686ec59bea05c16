"""Which code of a package runs, as far as names and constants tell: no more of it counts than that.

Code is taken to run unless something plain keeps it from that: nothing names the function or the class, a constant
shuts the branch, the statement before it leaves. Where names are made at run time, any function may be called.
"""

from __future__ import annotations

import ast
import builtins
import contextlib
from collections import defaultdict
from collections.abc import Collection, Iterator

from ros2lab.diagnose.interfaces import members_of
from ros2lab.diagnose.python_source import Function, PythonSource

_LEAVES = (ast.Return, ast.Raise, ast.Continue, ast.Break)
_PLAIN = (ast.Pass, ast.Expr, ast.Assign, ast.Constant, ast.Name, ast.Attribute, ast.expr_context)
_EXITS = frozenset(("sys.exit", "os._exit", "exit", "quit"))
_BY_NAME = frozenset(("getattr", "globals", "vars", "eval", "exec"))  # what finds functions by texts

Definition = Function | ast.ClassDef | ast.Dict
Code = Collection[tuple[PythonSource, ast.AST]]  # that runs, with the file in which it stands


def running(
    sources: Collection[PythonSource], entrances: Collection[str] | None = None
) -> Iterator[tuple[PythonSource, ast.AST]]:
    """Yield what stands in code that runs, and in which file.

    Args:
        sources: the modules of a package.
        entrances: the functions that its entry points name; None takes every function of a module that needs no
            arguments for one.
    """
    named = _definitions(sources)
    classes = {node.name for one in sources for node in one.nodes if isinstance(node, ast.ClassDef)}
    waiting: list[tuple[PythonSource, ast.AST]] = [(source, source.tree) for source in sources]
    waiting += [
        (one, part) for one in sources for part in one.tree.body if _is_entrance(one, part, entrances)
    ]
    done = set[ast.AST]()
    while waiting:
        source, piece = waiting.pop()
        if piece in done:
            continue
        done.add(piece)
        if isinstance(piece, ast.ClassDef):
            waiting += [(source, method) for method in _called_by_others(source, piece, classes)]
        for node in _pieces(source, piece):
            yield source, node
            for name in _names_in(node):
                waiting += named.pop(name, ())
            if _finds_any(node):
                waiting += [one for found in named.values() for one in found]
                named.clear()


def _definitions(sources: Collection[PythonSource]) -> dict[str, list[tuple[PythonSource, Definition]]]:
    """Return by its name what is looked at only where something names it."""
    named: dict[str, list[tuple[PythonSource, Definition]]] = defaultdict(list)
    for source in sources:
        for node in source.nodes:
            match node:
                case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                    named[name].append((source, node))
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Dict() as table):
                    named[name].append((source, table))
    return named


def idle(sources: Collection[PythonSource], code: Code) -> dict[str, list[int]]:
    """Return by file in which lines functions begin that never run, and assignments that nothing that runs reads."""
    run = {node for _, node in code}
    read = {name for node in run for name in _names_in(node)}
    found: dict[str, list[int]] = defaultdict(list)
    for source in sources:
        for node in source.nodes:
            match node:
                case ast.FunctionDef() | ast.AsyncFunctionDef():
                    is_idle = node not in run
                case ast.Assign(targets=[ast.Name(id=name)]) | ast.AnnAssign(target=ast.Name(id=name)):
                    is_idle = name not in read
                case _:
                    continue
            if is_idle:
                found[source.shown].append(node.lineno)
    return dict(found)


def _is_entrance(source: PythonSource, one: ast.stmt, entrances: Collection[str] | None) -> bool:
    """Return whether a statement of a module is what runs if the program is started right: that may be the fault."""
    match one:
        case ast.ClassDef(bases=bases):
            return bool(bases)  # whoever has forgotten `main` has written the node
        case ast.FunctionDef(name=name, args=arguments) | ast.AsyncFunctionDef(name=name, args=arguments):
            if len(arguments.args) > len(arguments.defaults):
                return False
            is_named = entrances is None or name in entrances or name == "main"
            return is_named or any(
                isinstance(node, ast.Call) and source.resolve(node.func) in ("rclpy.init", "rclpy.init.init")
                for node in ast.walk(one)
            )
    return False


def _pieces(source: PythonSource, piece: ast.AST) -> Iterator[ast.AST]:
    """Yield a piece of code and what runs with it: no definitions in it but decorated ones, and no named dictionaries."""
    waiting = [piece]
    while waiting:
        node = waiting.pop()
        yield node
        for inner in _reached(source, node):
            match inner:
                case (
                    ast.FunctionDef(decorator_list=[])
                    | ast.AsyncFunctionDef(decorator_list=[])
                    | ast.ClassDef()
                ):
                    pass
                case ast.Assign(targets=[ast.Name()], value=ast.Dict()):
                    pass
                case _:
                    waiting.append(inner)


def _reached(source: PythonSource, node: ast.AST) -> Iterator[ast.AST]:
    """Yield the parts of a node that are reached if it is."""
    shut: tuple[str, ...] = ()
    match node:
        case ast.If(test=test) | ast.IfExp(test=test):
            shut = {True: ("orelse",), False: ("body",), None: ()}[_truth(test)]
        case ast.While(test=test):
            shut = ("body",) if _truth(test) is False else ()
        case ast.For(iter=values):
            shut = ("body",) if _truth(values) is False else ()
        case ast.Try(body=body) if all(map(_cannot_fail, body)):
            shut = ("handlers",)
        case ast.BoolOp(op=sign, values=values):
            yield sign
            for one in values:
                yield one
                if _truth(one) is isinstance(sign, ast.Or):
                    break
            return
    for name, value in ast.iter_fields(node):
        if name not in shut:
            yield from _until_left(source, value if isinstance(value, list) else [value])


def _truth(test: ast.expr) -> bool | None:
    """Return whether a condition of constants holds; None if there is more in it."""
    match test:
        case ast.Constant(value=value):
            return bool(value)
        case ast.List(elts=parts) | ast.Tuple(elts=parts) | ast.Dict(values=parts):
            return bool(parts)
        case ast.UnaryOp(op=ast.Not(), operand=inner):
            return None if (truth := _truth(inner)) is None else not truth
        case ast.BoolOp(op=sign, values=values):
            decides, truths = isinstance(sign, ast.Or), [*map(_truth, values)]
            return decides if decides in truths else None if None in truths else not decides
        case ast.Compare(left=ast.Constant(), comparators=[ast.Constant()]):
            with contextlib.suppress(TypeError):
                return bool(eval(compile(ast.Expression(test), "", "eval"), {}))  # noqa: S307 -- two constants
    return None


def _until_left(source: PythonSource, parts: list[object]) -> Iterator[ast.AST]:
    """Yield the parts of a list up to a statement that leaves what they stand in."""
    for part in parts:
        if isinstance(part, ast.AST):
            yield part
            match part:
                case ast.Expr(value=ast.Call(func=function)) if source.resolve(function) in _EXITS:
                    return
                case _ if isinstance(part, _LEAVES):
                    return


def _cannot_fail(statement: ast.stmt) -> bool:
    """Return whether a statement only gives names to constants, to what types make of these, and to other names."""
    made = [node for node in ast.walk(statement) if _is_made_of_constants(node)]
    return all(
        node in made
        or (
            isinstance(node, _PLAIN)
            and not (isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load))
        )
        for node in ast.walk(statement)
    )


def _is_made_of_constants(node: ast.AST) -> bool:
    """Return whether a type of Python's makes the same of the same constants each time, such as `float("2.0")`."""
    match node:
        case ast.Call(func=ast.Name(id=name), args=[*given], keywords=[]):
            is_type = isinstance(getattr(builtins, name, None), type)
            return is_type and all(isinstance(one, ast.Constant) for one in given)
    return False


def _called_by_others(
    source: PythonSource, one: ast.ClassDef, classes: Collection[str]
) -> Iterator[Function]:
    """Yield the methods of a class that Python calls, or a base class that is not among `classes`."""
    own = {*classes, "object", "Node"}
    is_open = any(
        base is None or base.rpartition(".")[2] not in own for base in map(source.resolve, one.bases)
    )
    inherited = members_of("rclpy.node", "Node")[0] if one.bases else frozenset()
    for method in one.body:
        if not isinstance(method, (ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        if is_open or method.name.startswith("__") or method.name in inherited:
            yield method


def _names_in(node: ast.AST) -> Iterator[str]:
    """Yield the names by which a node may lead to a definition; a text may be one that is looked up."""
    match node:
        case ast.Name(id=name, ctx=ast.Load()) | ast.Attribute(attr=name) | ast.Constant(value=str(name)):
            yield name
        case ast.alias(name=name, asname=str()):
            yield name.rpartition(".")[2]


def _finds_any(node: ast.AST) -> bool:
    """Return whether code looks functions up by names that are not written there."""
    match node:
        case ast.Call(func=ast.Name(id="getattr"), args=[_, ast.Constant(), *_]):
            return False
        case ast.Call(func=ast.Name(id=name)):
            return name in _BY_NAME
    return False
