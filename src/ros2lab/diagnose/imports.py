"""Names that are imported from where they are not, and names that are never made."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection, Iterator

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.python_source import Import, PythonSource
from ros2lab.diagnose.spelling import did_you_mean, nearest

_MODULE_NAMES = frozenset(
    ("__file__", "__name__", "__doc__", "__path__", "__package__", "__spec__", "__loader__")
)
_ROS1 = {
    "rospy": "rclpy",
    "roslib": "rclpy",
    "roslaunch": "launch",
    "tf": "tf2_ros",
    "rospkg": "ament_index_python",
}


def import_faults(source: PythonSource, own_modules: Collection[str]) -> Iterator[Finding]:
    """Yield what is wrong with the imports of a file, and the names that nothing binds.

    Args:
        source: the file.
        own_modules: the modules of its package, such as `pk` and `pk.talk`.
    """
    for one in source.imports:
        if one.is_guarded:
            continue
        top = one.target.partition(".")[0]
        if top in ("rospy", "roslib", "roslaunch"):
            yield Finding(
                "ros1-import",
                f"{top} belongs to ROS 1; in ROS 2 it is {_ROS1[top]}.",
                source.at(one.line),
                f"import {_ROS1[top]}, and write the node as a class derived from rclpy.node.Node",
            )
        elif top in interfaces.PACKAGES and one.is_from:
            yield from _wrong_home(source, one)
        elif one.is_from and top in own_modules:
            yield from _own_module(source, one, own_modules)
        elif (wanted := nearest(top, interfaces.PACKAGES, 0.85)) and not (
            top in own_modules or interfaces.is_installed(top)
        ):
            yield Finding(
                "module-missing",
                f"There is no Python package {top}. Did you mean {wanted}?",
                source.at(one.line),
                f"write {wanted}",
            )
    for name, node in undefined_names(source):
        homes = interfaces.homes_of(name)
        yield Finding(
            "name-undefined",
            f"{name} is used here and never imported or defined.{'' if homes else did_you_mean(name, _bound(source))}",
            source.at(node),
            f"write `from {homes[0]} import {name}` at the top"
            if homes
            else "import or define it, or mend its spelling",
        )


def _wrong_home(source: PythonSource, one: Import) -> Iterator[Finding]:
    module, _, name = one.target.rpartition(".")
    names = interfaces.names_in(module)
    if name == "*" or names is None or name in names:
        return
    homes = interfaces.homes_of(name)
    known = sorted(names | {message for home in homes for message in (interfaces.names_in(home) or ())})
    close = nearest(name, known)
    yield Finding(
        "import-wrong",
        f"{name} is not in {module}"
        + (f"; it is in {homes[0]}." if homes else f".{f' Did you mean {close}?' if close else ''}"),
        source.at(one.line),
        f"write `from {homes[0] if homes else module} import {name if homes or not close else close}`",
    )


def _own_module(source: PythonSource, one: Import, own_modules: Collection[str]) -> Iterator[Finding]:
    module = one.target.rpartition(".")[0]
    if module not in own_modules and one.target not in own_modules:
        yield Finding(
            "module-missing",
            f"There is no module {module} in this package.{did_you_mean(module, own_modules)}",
            source.at(one.line),
            "mend the name, or make the file",
        )


def undefined_names(source: PythonSource) -> Iterator[tuple[str, ast.AST]]:
    """Yield each name that a file uses and that is bound nowhere in it, with its first use.

    Which scope binds a name, and when, is not asked: what is yielded fails wherever it is reached.
    """
    if any(one.local == "*" for one in source.imports):
        return
    known = _bound(source) | set(dir(builtins)) | _MODULE_NAMES
    told: set[str] = set()
    for node in source.nodes:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in known | told:
            told.add(node.id)
            yield node.id, node


def _bound(source: PythonSource) -> set[str]:
    names = {one.local for one in source.imports}
    for node in source.nodes:
        match node:
            case ast.Name(ctx=ast.Store() | ast.Del()):
                names.add(node.id)
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                names.add(node.name)
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
        names.update(one.name for one in getattr(node, "type_params", ()))
    return names
