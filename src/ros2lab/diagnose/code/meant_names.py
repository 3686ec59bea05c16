"""What a name that nothing defines was meant as: another name, an import, an assignment, or a string."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial

from ros2lab.diagnose.code.at_hand import as_at_hand, as_exception, as_method, as_path, as_text
from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.code.similar_names import as_another, as_foreign
from ros2lab.diagnose.code.unknown_names import Unknown, as_code, cause_of, compared, first_value
from ros2lab.diagnose.finding import these_lines
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.commented_out import put_back
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.diagnose.sources.static_value import dotted
from ros2lab.diagnose.sources.syntax_parts import needed_by, removal, stores_in

Reading = tuple[str, str]  # the cause, and the fix


def meant(
    source: PythonSource,
    name: str,
    node: ast.AST,
    *,
    members: Collection[str] = (),
    package: str = "",
    own: Mapping[str, PythonSource] | None = None,
) -> Reading:
    """Return why a name is not defined, and what to write instead; the likeliest of all readings."""
    unknown = Unknown(source, name, node, members, package, own or {})
    readings: Sequence[Callable[[Unknown], Reading | None]] = (
        _as_keyword_argument,
        _as_assignment,
        _as_after_dot,
        _as_self,
        as_at_hand,
        _as_member,
        _as_alias,
        as_exception,
        as_foreign,
        as_method,
        _as_import,
        as_path,
        _as_of_another_function,
        _as_own,
        as_another,
        _as_of_module,
        _as_of_python,
        _as_parameter,
        _as_package,
        _as_out_of_use,
        _as_object,
        partial(as_another, is_class_meant=True),
        as_text,
    )
    found = (reading(unknown) for reading in readings)
    return next(filter(None, found), None) or _unexplained(unknown)


def _as_keyword_argument(unknown: Unknown) -> Reading | None:
    """`Node(package == 'demo')` for `package='demo'`."""
    match compared := unknown.above():
        case ast.Compare(left=left, ops=[ast.Eq()], comparators=[value]) if left is unknown.node:
            call = unknown.above(compared)
            if isinstance(call, ast.Call) and compared in call.args:
                given = ast.get_source_segment(unknown.source.text, value) or ast.unparse(value)
                fix = unknown.with_text(compared, f"{unknown.name}={given}")
                return "`==` compares; an argument is given by its name with a single `=`.", fix
    return None


def _as_assignment(unknown: Unknown) -> Reading | None:
    """`node == Talker()` as a statement for `node = Talker()`."""
    fix = compared(unknown.source, unknown.node)
    cause = f"`==` only compares, so nothing sets {unknown.name}; a single `=` assigns."
    return (cause, fix) if fix else None


def _as_self(unknown: Unknown) -> Reading | None:
    """`node.pub` in a method, where another function calls the instance of the class `node`."""
    around = [unknown.above(scope) for scope in unknown.scopes[:-1]]
    classes = {node.name for node in around if isinstance(node, ast.ClassDef)}
    if not classes or not unknown.attributes:
        return None
    functions = unknown.source.functions.values()
    for function, node in ((owner, node) for owner in functions for node in own_nodes(owner)):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id=made))):
                if name == unknown.name and made in classes:
                    cause = (
                        f"{name} is a variable of {function.name}(); a method knows its own object as self."
                    )
                    return cause, unknown.with_text(unknown.node, "self")
    return None


def _as_member(unknown: Unknown) -> Reading | None:
    set_here = [ast.unparse(target) for target in getattr(unknown.statement, "targets", ())]
    if unknown.name not in unknown.members or f"self.{unknown.name}" in set_here:
        return None  # what the statement itself sets has no value yet
    cause = f"{unknown.name} belongs to the class, so its methods can use it only as self.{unknown.name}."
    return cause, unknown.with_text(unknown.node, f"self.{unknown.name}")


def _as_alias(unknown: Unknown) -> Reading | None:
    for imported in unknown.source.imports:
        if imported.target == unknown.name != imported.local:
            cause = f"{unknown.name} is imported as {imported.local}, so there is no {unknown.name} here."
            return cause, f"write `import {unknown.name}` on line {imported.line}"
    return None


def _as_after_dot(unknown: Unknown) -> Reading | None:
    """`f(self,kind)` for `f(self.kind)`: a comma where a dot was meant."""
    source, start = unknown.source, getattr(unknown.node, "col_offset", 0)
    row, number = unknown.line(unknown.node).encode(), getattr(unknown.node, "lineno", 0)
    if row[start - 1 : start] != b",":
        return None
    ends = (number, start - 1)
    before = [
        n for n in source.nodes if (getattr(n, "end_lineno", 0), getattr(n, "end_col_offset", 0)) == ends
    ]
    owner = next((n for n in before if isinstance(n, (ast.Name, ast.Attribute, ast.Call))), None)
    if owner is None:
        return None
    whole = ast.unparse(owner)
    names = unknown.members if whole == "self" else interfaces.importable_names(source.resolve(owner) or "-")
    is_only = len(re.findall(r",(?=[^\s)\]}])", source.text)) == 1  # elsewhere a space follows each comma
    if not (unknown.name in names if names else is_only):
        return None
    new = row[: start - 1] + b"." + row[start:]
    cause = f"There is a comma between {whole} and {unknown.name} instead of a dot."
    return cause, f"write {as_code(new.decode()) or f'{whole}.{unknown.name}'}"


def _as_import(unknown: Unknown) -> Reading | None:
    """`Node` without `from rclpy.node import Node`, with the other names that the same line has to import."""
    name = unknown.name
    asked = unknown.attributes
    is_module = name in sys.stdlib_module_names or (interfaces.is_installed(name) and bool(asked))
    inner = interfaces.importable_names(name) if is_module else frozenset[str]()
    if asked and (inner is None or asked <= inner):
        return cause_of(unknown), f"write `import {name}` at the top"
    if unknown.is_called and name in (inner or ()):
        return cause_of(unknown), f"write `from {name} import {name}` at the top"
    home = "" if is_module else _home_of(unknown, name)
    if not home:
        return None
    others = [other for other, _ in undefined_names(unknown.source) if other != name]
    names = sorted([name, *(other for other in others if _home_of(unknown, other) == home)])
    return cause_of(unknown), f"write `from {home} import {', '.join(names)}` at the top"


def _home_of(unknown: Unknown, name: str) -> str:
    """Return the module of ROS, or one that the file imports from already, that has a name; empty if none has."""
    imports, around = unknown.source.imports, unknown.above()
    targets = [imported.target for imported in imports]
    homes = interfaces.homes_for(name, targets)
    is_message = bool(homes) and homes[0].endswith((".msg", ".srv"))
    if is_message and (unknown.is_exception or interfaces.homes_around(name, "")):
        # A launch file uses no messages, and a message takes no positional arguments.
        is_launch = any(target.startswith("launch") for target in targets)
        is_given = isinstance(around, ast.Call) and around.func is unknown.node and bool(around.args)
        homes = () if is_launch or is_given or unknown.is_exception else homes
    if homes:
        return homes[0]
    used = [imported.target.rpartition(".")[0] for imported in imports if imported.is_from]
    used += ["setuptools"] * unknown.source.shown.endswith("setup.py")
    has = (module for module in dict.fromkeys(used) if name in (interfaces.importable_names(module) or ()))
    found = next(has, "")
    # A module also offers what it imports itself.
    inner = interfaces.inner_homes_of(name) if found.startswith("rclpy.") else ()
    return inner[0] if len(inner) == 1 else found


def _as_own(unknown: Unknown) -> Reading | None:
    """A function or a class of another module of the workspace, which is not imported."""
    for module, other in unknown.own.items():
        kinds = (Function, ast.ClassDef)
        defined = {node.name for node in other.tree.body if isinstance(node, kinds)} - {"main"}
        if other is not unknown.source and unknown.name in defined:
            return cause_of(unknown), f"write `from {module} import {unknown.name}` at the top"
    return None


def _as_of_module(unknown: Unknown) -> Reading | None:
    """`shutdown()` for `rclpy.shutdown()`."""
    is_alone = getattr(unknown.statement, "value", None) is unknown.node and isinstance(
        unknown.statement, ast.Expr
    )
    for imported in unknown.source.imports if unknown.is_called or is_alone else ():
        is_ros = imported.target.partition(".")[0] in interfaces.PACKAGES
        is_meant = not imported.is_from and (unknown.is_called or is_ros)
        if is_meant and interfaces.has_name(imported.target, unknown.name):
            cause = f"{unknown.name} belongs to the module {imported.local}."
            call = "()" * is_alone
            return cause, unknown.with_text(unknown.node, f"{imported.local}.{unknown.name}{call}")
    return None


def _as_of_python(unknown: Unknown) -> Reading | None:
    """`Path` without `from pathlib import Path`, with the other names that the same line has to import."""
    if not (unknown.is_called or unknown.is_exception or unknown.name[:1].isupper()):
        return None
    names = [name for name, _ in undefined_names(unknown.source)]
    homes = (interfaces.homes_around(name, "")[:1] for name in (unknown.name, *names))
    for home in (home for found in homes for home in found):
        inner = interfaces.importable_names(home) or ()
        if unknown.name in inner:
            joined = ", ".join(sorted({unknown.name, *(name for name in names if name in inner)}))
            return cause_of(unknown), f"write `from {home} import {joined}` at the top"
    return None


def _as_parameter(unknown: Unknown) -> Reading | None:
    """A name that a function passes on without having it, as `rclpy.init(args=args)` in `main()`."""
    name, handed = unknown.name, unknown.above()
    function = next((scope for scope in unknown.scopes if isinstance(scope, Function)), None)
    if not (isinstance(handed, ast.keyword) and handed.arg == name and function):
        return None
    if function.body[0].lineno == function.lineno or function.args.kwarg:
        return None
    if beside := _given_beside(unknown, function):
        line = getattr(beside, "lineno", 0)
        cause = f"{name} is passed on here, but nothing gives it a value, as line {line} does for {ast.unparse(beside)}."
        return cause, f"write a line that gives {name} its value, above line {unknown.statement.lineno}"
    cause = f"{name} is passed on here, but {function.name}() has no parameter of that name."
    new = re.sub(
        r"\)(?=[^)]*$)",
        f"{', ' if function.args.args else ''}{name}=None)",
        unknown.line(function).strip(),
        count=1,
    )
    if not new.endswith(":"):  # its signature spans several lines
        fix = f"write `{name}=None` as the last parameter of {function.name}() (line {function.lineno})"
        return cause, fix
    return cause, f"write `{new}` on line {function.lineno}"


def _given_beside(unknown: Unknown, function: Function) -> ast.Name | None:
    """Return the variable of a function that is passed on under its own name beside an unknown one; None without any."""
    call = unknown.above(unknown.above())
    names = (
        {k.arg for k in call.keywords if getattr(k.value, "id", "") == k.arg}
        if isinstance(call, ast.Call)
        else ()
    )
    own = (n for n in stores_in(own_nodes(function)) if isinstance(n, ast.Name) and n.id in names)
    return next(own, None)


def _as_of_another_function(unknown: Unknown) -> Reading | None:
    """A variable of another top-level function, which no other function sees."""
    body = unknown.source.tree.body
    if not any(scope in body for scope in unknown.scopes):
        return None
    for function in body:
        if isinstance(function, Function) and function not in unknown.scopes:
            named = (n for n in own_nodes(function) if isinstance(n, ast.Name) and n.id == unknown.name)
            if any(isinstance(n.ctx, ast.Store) for n in named):
                cause = f"{unknown.name} is a variable of {function.name}(), and no other function sees what a function assigns."
                fix = f"write `global {unknown.name}` as the first line of {function.name}(); or better, keep it in a class as self.{unknown.name}"
                return cause, fix
    return None


def _as_package(unknown: Unknown) -> Reading | None:
    """The name of the package in its setup.py: `name=`, an item of `packages`, or a part of a path."""
    if unknown.package == unknown.name:
        cause = f"{unknown.name} is the name of the package; without quotes it is that of a variable."
        return cause, unknown.with_text(unknown.node, repr(unknown.name))
    if not unknown.package or not any(_names_package(unknown, use) for use in unknown.uses):
        return None
    line = f"`{unknown.name} = '{unknown.package}'`"
    cause = f"{cause_of(unknown)} It stands for the name of the package."
    return cause, f"write {line} above line {unknown.statement.lineno}"


def _names_package(unknown: Unknown, use: ast.AST) -> bool:
    match unknown.above(use):
        case ast.keyword(arg="name"):
            return True
        case ast.List() as items:
            around = unknown.above(items)
            return isinstance(around, ast.keyword) and around.arg == "packages"
        case ast.BinOp(left=ast.Constant(value=str()), op=ast.Add()):
            return True
        case ast.Call(func=ast.Attribute(attr="join"), args=[ast.Constant(value="share"), *_]):
            return True
    return False


def _as_out_of_use(unknown: Unknown) -> Reading | None:
    """A name that a statement above binds, in a comment or in a text, and that is known once it is put back."""
    source, name = unknown.source, unknown.name
    known = {other for other, _ in undefined_names(source)} - {name}
    for line, back, whole in put_back(
        source.text, rf"\b{re.escape(name)}\b *=[^=]|\bimport\b.*\b{re.escape(name)}\b"
    ):
        again = {other for other, _ in undefined_names(PythonSource(source.name, source.shown, whole))}
        if line < unknown.statement.lineno and again <= known:
            either = ", or remove this line" if isinstance(unknown.statement, ast.Expr) else ""
            return f"{cause_of(unknown)} Line {line} would do that, but is out of use.", back + either
    return None


def _as_object(unknown: Unknown) -> Reading | None:
    """A variable whose assignment is missing, if its uses tell what it holds."""
    made = _sent(unknown) or _unused_class(unknown) or first_value(unknown.source, unknown.uses)
    if not made:
        return None
    cause = f"{cause_of(unknown)} A line that assigns it is missing."
    return cause, f"write `{unknown.name} = {made}` above line {_outside_loops(unknown).lineno}"


def used_too_early(source: PythonSource, name: str, node: ast.AST) -> Reading | None:
    """Return why a name that is assigned elsewhere has no value yet, and what to write; None if that is not known."""
    unknown = Unknown(source, name, node)
    value = first_value(source, unknown.uses)
    if not value:
        return None
    is_global = any(isinstance(n, ast.Global) and name in n.names for n in source.nodes)
    top = min((n.lineno for n in source.tree.body if isinstance(n, (Function, ast.ClassDef))), default=1)
    number = top if is_global else _outside_loops(unknown).lineno
    cause = f"Nothing gives {name} a value before this line runs."
    return cause, f"write `{name} = {value}` above line {number}"


def _outside_loops(unknown: Unknown) -> ast.stmt:
    """Return the statement around the use that no loop repeats."""
    found, node = unknown.statement, unknown.node
    while node not in unknown.scopes:
        node = unknown.above(node)
        if isinstance(node, (ast.For, ast.While)):
            found = node
    return found


def _sent(unknown: Unknown) -> str:
    """Return what makes the message that a publisher publishes, or the request of a client."""
    kinds = {
        ast.unparse(target): ast.unparse(node.value.args[0])
        for node in unknown.source.nodes
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call) and node.value.args
        for target in node.targets
        if getattr(node.value.func, "attr", "") in ("create_publisher", "create_client")
    }
    for use in unknown.uses:
        match unknown.above(use):
            case ast.Call(func=ast.Attribute(value=owner, attr="publish" | "call" | "call_async" as method)):
                if kind := kinds.get(ast.unparse(owner)):
                    return f"{kind}()" if method == "publish" else f"{kind}.Request()"
    return ""


def _unused_class(unknown: Unknown) -> str:
    """Return a call of the only class that the file has and never uses; empty if it does not fit the uses."""
    source = unknown.source
    loaded, own = unknown.loaded, unknown.source.classes
    found = [name for name, definition in own.items() if name not in loaded and _has_all(unknown, definition)]
    for imported in source.imports:
        module, _, name = imported.target.rpartition(".")
        if imported.local not in loaded and imported.is_from and name[:1].isupper():
            members = interfaces.members_of(module, name) if unknown.attributes else frozenset[str]()
            if unknown.attributes and unknown.attributes <= members:
                found.append(imported.local)
    return f"{found[0]}()" if len(found) == 1 else ""


def _has_all(unknown: Unknown, definition: ast.ClassDef) -> bool:
    """Return whether a class can be instantiated without arguments and has what the uses ask for."""
    made = next((n for n in definition.body if isinstance(n, Function) and n.name == "__init__"), None)
    is_free = made is None or not needed_by(made)
    names = {n.attr for n in walk(definition) if isinstance(n, ast.Attribute)} | {
        n.name for n in definition.body if isinstance(n, Function)
    }
    is_node = any(ast.unparse(base).rpartition(".")[2] == "Node" for base in definition.bases)
    names |= interfaces.node_members() if is_node else set()
    is_handed = any(isinstance(unknown.above(use), ast.Call) for use in unknown.uses)
    return is_free and unknown.attributes <= names and bool(unknown.attributes or (is_node and is_handed))


def _unexplained(unknown: Unknown) -> Reading:
    alone = getattr(unknown.statement, "value", None)
    if isinstance(unknown.statement, ast.Expr) and dotted(alone):
        cause = f"{cause_of(unknown)} Alone on its line, it would do nothing."
        return cause, removal(unknown.source, alone or unknown.node, "this line")
    if unknown.name in ("self", "cls"):
        fix = (
            _moved(unknown)
            or f"move the statement into a method whose first parameter is {unknown.name}, or remove it"
        )
        return (
            f"{unknown.name} is used outside of any method, but exists only inside one, as its first parameter.",
            fix,
        )
    if unknown.is_called:
        fix = f"write the object that {unknown.name} belongs to, and a dot, before it; otherwise import or define it above"
    elif unknown.name[:1].isupper() and (unknown.attributes or not unknown.name.isupper()):
        fix = f"import or define {unknown.name} above"
    else:
        fix = f"write a line above it that gives {unknown.name} its value"
    return cause_of(unknown), fix


def _moved(unknown: Unknown) -> str:
    """Say how a statement of a class's body that needs self is to stand in __init__; empty if there is none, or if it binds nothing."""
    source, statement = unknown.source, unknown.statement
    around = source.above(statement)
    names = [last_name(target) for target in getattr(statement, "targets", ())]
    body = around.body if isinstance(around, ast.ClassDef) and len(names) == 1 else []
    made = [node for part in body if getattr(part, "name", "") == "__init__" for node in walk(part)]
    begins = [n for n in made if isinstance(n, ast.Call) and last_name(n.func) == "__init__"]
    if not begins or not isinstance(statement, ast.Assign):
        return ""
    name, last = names[0], begins[0].end_lineno
    fix = f"write `self.{name} = {ast.unparse(statement.value)}` below line {last}, in __init__, and {removal(source, statement, 'this line')}"
    whole = f"{getattr(around, 'name', '')}.{name}"
    others = sorted(
        {n.lineno for n in source.nodes if isinstance(n, ast.Attribute) and ast.unparse(n) == whole}
    )
    return f"{fix}; and write self.{name} instead of {whole} on {these_lines(others)}" if others else fix
