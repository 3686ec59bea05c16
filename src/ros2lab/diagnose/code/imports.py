"""Imports of names that are not there, and names that are never defined."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.code.bare_imports import bare_sibling
from ros2lab.diagnose.code.wrong_imports import wrong_imports
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import Function, Import, PythonSource, read_source, walk
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest

_MODULE_NAMES = frozenset(
    ("__file__", "__name__", "__doc__", "__path__", "__package__", "__spec__", "__loader__")
)
# Words of other languages, and what Python calls them.
_FOREIGN = {"this": "self", "null": "None", "nullptr": "None", "nil": "None", "undefined": "None"}
ROS_1 = {
    "rospy": "rclpy",
    "roslib": "rclpy",
    "roslaunch": "launch",
    "tf": "tf2_ros",
    "rospkg": "ament_index_python",
}


def shadow_faults(source: PythonSource, folder: Path, own_modules: Collection[str]) -> Iterator[Finding]:
    """Yield imports that a file or folder next to the source shadows, as `random.py` does."""
    for imported in source.imports:
        module, _, name = imported.target.rpartition(".") if imported.is_from else (imported.target, "", "")
        top = (module or imported.target).partition(".")[0]
        own = next(
            (p for p in (folder / f"{top}.py", folder / top) if p.is_file() or (p / "__init__.py").is_file()),
            None,
        )
        is_other = top in sys.stdlib_module_names or top in interfaces.PACKAGES
        if (
            own is None
            or not is_other
            or (module or imported.target) in own_modules
            or (name and own.is_file() and _binds(own, name))
        ):
            continue
        yield Finding(
            "name-shadowed",
            f"{own.name}, next to this file, has the same name as the module {top} and may be imported instead of it.",
            source.at(imported.line),
            f"rename {own.name}, for example to my_{own.name}, and update whatever imports it",
        )


def hidden_types(source: PythonSource) -> Iterator[Finding]:
    """Yield classes and functions that have the name of a message type imported above them."""
    message_types = {
        imported.local: imported
        for imported in source.imports
        if imported.is_from and interfaces.is_interface(imported.target)
    }
    for node in source.tree.body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            continue
        imported = message_types.get(node.name)
        if imported is None or imported.line > node.lineno:
            continue
        what = "class" if isinstance(node, ast.ClassDef) else "function"
        better = f"{node.name}Node" if what == "class" else f"{node.name}_node"
        yield Finding(
            "name-shadowed",
            f"The {what} {node.name} has the same name as the message type imported on line {imported.line}, so from here on {node.name} means the {what}, not the message.",
            source.at(node),
            f"rename the {what} to {better}, here and where it is {'used' if what == 'class' else 'called'}",
            (node.name,),
        )


def _binds(file: Path, name: str) -> bool:
    return name in _bound(read_source(file, file.stem, file.name))[0]


def import_faults(sources: NodeSources, source: PythonSource) -> Iterator[Finding]:
    """Yield faults in the imports of a file, and the names that nothing in it binds."""
    own_modules = sources.sources
    for imported in source.imports:
        if imported.is_guarded:
            continue
        top = imported.target.partition(".")[0]
        if top in ("rospy", "roslib", "roslaunch"):
            yield Finding(
                "ros1-import",
                f"{top} belongs to ROS 1; in ROS 2 it is {ROS_1[top]}.",
                source.at(imported.line),
                f"import {ROS_1[top]}, and write the node as a subclass of rclpy.node.Node",
            )
        elif imported.is_from and top in own_modules and top not in interfaces.PACKAGES:
            yield from _own_module(source, imported, own_modules)
        elif bare_sibling(source, imported, own_modules):
            continue  # whether Python finds it depends on how the file is started
        elif top not in own_modules and (wanted := interfaces.meant(top) or _own_package(top, own_modules)):
            yield Finding(
                "module-missing",
                f"There is no Python package {top}. Did you mean {wanted}?",
                source.at(imported.line),
                f"write {wanted}",
            )
    yield from wrong_imports(source, names_of(source, own_modules))
    for name, node in undefined_names(source):
        if name in sources.members_at(source, node):
            yield Finding(
                "name-undefined",
                f"{name} belongs to the class, so its methods can use it only as self.{name}.",
                source.at(node),
                f"write self.{name}",
            )
            continue
        yield _undefined(source, name, node)


def _own_package(name: str, own_modules: Collection[str]) -> str | None:
    """Return the package of the workspace that a name misspells; None if there is none."""
    if name in sys.stdlib_module_names or interfaces.is_installed(name):
        return None
    return next((module for module in own_modules if "." not in module and is_near_miss(name, module)), None)


def _undefined(source: PythonSource, name: str, node: ast.AST) -> Finding:
    cause, place = f"{name} is used here but never imported or defined.", source.at(node)
    if alias := next(
        (imported for imported in source.imports if imported.target == name and imported.local != name), None
    ):
        cause = f"{name} is imported as {alias.local}, so there is no {name} here."
        return Finding("name-undefined", cause, place, f"write `import {name}` on line {alias.line}")
    if homes := interfaces.homes_for(name, [imported.target for imported in source.imports]):
        return Finding("name-undefined", cause, place, f"write `from {homes[0]} import {name}` at the top")
    here = _bound(source)[0]
    known = sorted(here | set(dir(builtins)))
    meant = _FOREIGN.get(name.lower()) or next(
        (candidate for candidate in known if candidate.lower() == name.lower()), None
    )
    if meant:
        return Finding(
            "name-undefined", f"Python has no {name}; in Python it is {meant}.", place, f"write {meant}"
        )
    close = nearest(name, here) or nearest(name, dir(builtins), 0.85)
    if close:
        cause, fix = f"{cause} Did you mean {close}?", f"write {close} instead of {name}"
    elif function := _hands_on(source, name, node):
        first = source.text.splitlines()[function.lineno - 1].strip()
        cause = f"{name} is passed on here, but {function.name}() has no parameter of that name."
        new = re.sub(r"\)(?=[^)]*$)", f"{', ' if function.args.args else ''}{name}=None)", first, count=1)
        fix = f"write `{new}` on line {function.lineno}"
        if not new.endswith(":"):  # its signature spans several lines
            fix = f"write `{name}=None` as the last parameter of {function.name}() (line {function.lineno})"
    else:
        is_called = any(isinstance(call, ast.Call) and call.func is node for call in source.nodes)
        fix = (
            f"write the object that {name} belongs to, and a dot, before it"
            if is_called
            else f"put it in quotes if it is a string ('{name}')"
        )
        fix += "; otherwise import or define it above"
    return Finding("name-undefined", cause, place, fix)


def _hands_on(source: PythonSource, name: str, used: ast.AST) -> Function | None:
    """Return the function that passes a name on, as in `rclpy.init(args=args)`; None if none does."""
    is_handed = any(
        isinstance(node, ast.keyword) and node.arg == name and node.value is used for node in source.nodes
    )
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef)
    around = [n for n in source.nodes if isinstance(n, kinds) and used in walk(n)]
    function = max(around, key=lambda definition: definition.lineno, default=None) if is_handed else None
    is_short = function and function.body[0].lineno > function.lineno and not function.args.kwarg
    return function if is_short else None


def names_of(source: PythonSource, modules: Mapping[str, PythonSource]) -> dict[str, frozenset[str]]:
    """Return the names of each module that a file imports from; none for the other modules."""
    asked = {source.absolute(node) for node in source.nodes if isinstance(node, ast.ImportFrom)}
    return {name: bound_names(own) if name in asked else frozenset() for name, own in modules.items()}


def bound_names(source: PythonSource) -> frozenset[str]:
    """Return the names that a file binds at its top level, as far as they are known; empty if they are not."""
    is_open = any(imported.local == "*" for imported in source.imports) or source.fault is not None
    names = {node.id for node in source.nodes if isinstance(node, ast.Name)}
    binds = {node.name for node in source.tree.body if isinstance(node, ast.FunctionDef)}
    is_open = is_open or bool(names & {"exec", "globals"}) or "__getattr__" in binds
    return frozenset() if is_open else frozenset(_bound(source)[0] | _MODULE_NAMES)


def _own_module(source: PythonSource, imported: Import, own_modules: Collection[str]) -> Iterator[Finding]:
    module = imported.target.rpartition(".")[0]
    if module.endswith((".msg", ".srv", ".action")) and module not in own_modules:
        kind = module.rpartition(".")[2]
        yield Finding(
            "module-missing",
            f"{module} would hold this package's own messages, but a package of type ament_python cannot generate them from its .{kind} files.",
            source.at(imported.line),
            f"put the .{kind} files into a separate ament_cmake package, with rosidl_generate_interfaces in CMakeLists.txt, and import from that",
        )
        return
    if module not in own_modules and imported.target not in own_modules:
        close = nearest(module, own_modules)
        yield Finding(
            "module-missing",
            f"There is no module {module} in this package.{f' Did you mean {close}?' if close else ''}",
            source.at(imported.line),
            f"write {close} instead of {module}" if close else "fix the name, or create the file",
        )


def undefined_names(source: PythonSource) -> Iterator[tuple[str, ast.AST]]:
    """Yield each name that a file uses and that is bound nowhere in it, with its first use.

    Scopes and order are ignored, so a name that is yielded fails wherever it is reached.
    A name bound in a class body counts there only, not in its methods.
    """
    used = {node.id for node in source.nodes if isinstance(node, ast.Name)}
    if any(imported.local == "*" for imported in source.imports) or used & {"exec", "globals"}:
        return  # what these bind is known only when they run
    names, of_classes = _bound(source)
    known = names | set(dir(builtins)) | _MODULE_NAMES
    told: set[str] = set()
    for node, is_in_body in _placed(source.tree):
        if not (isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)) or node.id in known | told:
            continue
        if not (is_in_body and node.id in of_classes):
            told.add(node.id)
            yield node.id, node


def _placed(parent: ast.AST, is_in_body: bool = False) -> Iterator[tuple[ast.AST, bool]]:
    """Yield every node of a tree, and whether it is in a class body but in none of its methods."""
    scopes = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
    for name, value in ast.iter_fields(parent):
        # Decorators, defaults and annotations are evaluated in the scope around the function.
        is_inner = name == "body" and isinstance(parent, scopes)
        is_within = isinstance(parent, ast.ClassDef) if is_inner else is_in_body
        for node in value if isinstance(value, list) else [value]:
            if isinstance(node, ast.AST):
                yield node, is_within
                yield from _placed(node, is_within)


def _bound(source: PythonSource) -> tuple[set[str], set[str]]:
    """Return the names that a file binds, and those that the bodies of its classes bind."""
    names = {imported.local for imported in source.imports}
    of_classes: set[str] = set()
    for node, is_in_body in _placed(source.tree):
        match node:
            case ast.Name(ctx=ast.Store() | ast.Del()):
                (of_classes if is_in_body else names).add(node.id)
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                (of_classes if is_in_body else names).add(node.name)
                if not isinstance(node, ast.ClassDef):
                    names.add("__class__")
            case ast.arg():
                names.add(node.arg)
            case ast.ExceptHandler() | ast.MatchAs() | ast.MatchStar() if node.name:
                names.add(node.name)
            case ast.MatchMapping() if node.rest:
                names.add(node.rest)
            case ast.Global() | ast.Nonlocal():
                names.update(node.names)
        names.update(parameter.name for parameter in getattr(node, "type_params", ()))
    return names, of_classes
