"""Imports of names that are not there, and names that are never defined."""

from __future__ import annotations

import ast
import sys
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.code.bare_imports import by_folders
from ros2lab.diagnose.code.bound_names import MODULE_NAMES, global_names, undefined_names
from ros2lab.diagnose.code.called_back import called_back
from ros2lab.diagnose.code.meant_names import meant
from ros2lab.diagnose.code.wrong_imports import misspelt_packages, wrong_imports
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.beyond import Beyond
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource, read_source
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest

ROS_1 = {
    "rospy": "rclpy",
    "roslib": "rclpy",
    "roslaunch": "launch",
    "tf": "tf2_ros",
    "rospkg": "ament_index_python",
}


_UNKNOWN = "from unknown import *"  # the text of a module of which nothing is known


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
        cause = f"{own.name}, next to this file, has the same name as the module {top} and may be imported instead of it."
        fix = f"rename {own.name}, for example to my_{own.name}, and update whatever imports it"
        yield Finding("name-shadowed", cause, source.at(imported.line), fix)


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
        cause = f"The {what} {node.name} has the same name as the message type imported on line {imported.line}, so from here on {node.name} means the {what}, not the message."
        fix = f"rename the {what} to {better}, here and where the {what} is meant; {node.name} stays where the message is"
        yield Finding("name-shadowed", cause, source.at(node), fix, (node.name,))


def _binds(file: Path, name: str) -> bool:
    return name in global_names(read_source(file, file.stem, file.name))


def import_faults(sources: NodeSources, source: PythonSource) -> Iterator[Finding]:
    """Yield faults in the imports of a file, and the names that nothing in it binds."""
    own_modules = {**sources.sources, **_made(sources, source)}
    for imported in source.imports:
        if imported.is_guarded:
            continue
        top = imported.target.partition(".")[0]
        if top in ("rospy", "roslib", "roslaunch"):
            cause = f"{top} belongs to ROS 1; in ROS 2 it is {ROS_1[top]}."
            fix = f"import {ROS_1[top]}, and write the node as a subclass of rclpy.node.Node"
            yield Finding("ros1-import", cause, source.at(imported.line), fix)
        elif top in own_modules and top not in interfaces.PACKAGES:
            yield from _own_module(source, imported, own_modules, sources.beyond)
    yield from misspelt_packages(source, {*own_modules, *sources.beyond.modules, *sources.beyond.packages})
    is_run = any(name.rpartition(".")[0] == source.name for name in sources.used)
    # A script that is run by hand finds the files beside it first.
    beside = "" if is_run or "__main__" not in source.text else source.name.rpartition(".")[0]
    yield from wrong_imports(source, names_of(source, own_modules, sources.beyond.interfaces, beside))
    undefined = [*undefined_names(source)]
    lost = {id(called.function): called.lacks for called in (called_back(sources) if undefined else ())}
    for name, node in undefined:
        if name in lost.get(id(source.function_at(getattr(node, "lineno", 0))), ()):
            continue  # the def of a callback lacks it, which is told there
        cause, fix = meant(source, name, node, members=sources.members_at(source, node), own=own_modules)
        yield Finding("name-undefined", cause, source.at(node), fix)


def _made(sources: NodeSources, source: PythonSource) -> dict[str, PythonSource]:
    """Return the modules that a file imports of its own package and that only the build makes, as unknown files."""
    own = sources.sources
    targets = (imported.target for imported in source.imports if imported.target.partition(".")[0] in own)
    names = (name for target in targets for name in (target, target.rpartition(".")[0]) if name not in own)
    return {name: PythonSource(name, "", _UNKNOWN) for name in names if sources.beyond.is_made(name)}


def names_of(
    source: PythonSource,
    modules: Mapping[str, PythonSource],
    interfaces: Mapping[str, frozenset[str]],
    beside: str = "",
) -> dict[str, frozenset[str]]:
    """Return the names of each module that a file imports from, and what those below it define; none for the others.

    Those of a module in the package `beside`, if it is given, count as those of one with its bare name, too.
    """
    asked = {source.absolute(node) for node in source.nodes if isinstance(node, ast.ImportFrom)}
    found = {name: frozenset[str]() for name in modules}
    found |= {home: names for home, names in interfaces.items() if home not in asked}
    for name in (name for name in modules if name.rpartition(".")[0] in asked):
        found[name] = bound_names(modules[name]) - {imported.local for imported in modules[name].imports}
    for name in asked & found.keys():
        found[name] = bound_names(modules[name])
        twin = modules.get(f"{beside}.{name}") if beside and found[name] else None
        found[name] |= bound_names(twin) if twin else frozenset()
    return found


def bound_names(source: PythonSource) -> frozenset[str]:
    """Return the names that a file binds at its top level, as far as they are known; empty if they are not."""
    is_open = any(imported.local == "*" for imported in source.imports) or source.fault is not None
    is_open |= source.hidden is not None  # which may be meant
    names = {node.id for node in source.nodes if isinstance(node, ast.Name)}
    binds = {node.name for node in source.tree.body if isinstance(node, ast.FunctionDef)}
    is_open = is_open or bool(names & {"exec", "globals"}) or "__getattr__" in binds
    return frozenset() if is_open else global_names(source) | MODULE_NAMES


def _own_module(
    source: PythonSource, imported: Import, own_modules: Mapping[str, PythonSource], beyond: Beyond
) -> Iterator[Finding]:
    module = imported.target.rpartition(".")[0] if imported.is_from else imported.target
    is_folder = any(name.startswith(f"{module}.") for name in own_modules)  # one without __init__.py
    if is_folder or module in own_modules or imported.target in own_modules:
        return
    if further := by_folders(source, imported.line, {**beyond.modules, **own_modules}):
        yield further
        return
    if module.endswith((".msg", ".srv", ".action")):
        yield _own_messages(source, imported, module, beyond)
        return
    made = {f"{module.rpartition('.')[0]}.{name}" for name in beyond.written() if name}
    name = imported.target.rpartition(".")[2] if imported.is_from else "*"
    passing = {home for home, file in own_modules.items() if imported.target in file.names.values()}
    holding = [home for home, file in own_modules.items() if _holds(file, name, own_modules)]
    holding = [home for home in holding if home not in passing]  # they import it from there, too
    # Where it is not known what a file has, only its own name tells.
    alike = {home.rpartition(".")[2]: home for home in sorted({*made, *own_modules})}
    unread = {*made, *(home for home, file in own_modules.items() if name == "*" or not bound_names(file))}
    near = alike.get(nearest(module.rpartition(".")[2], alike) or "")
    close = (
        nearest(module, holding) or (near if near in unread else None) or _only_definition(own_modules, name)
    )
    cause = f"There is no module {module} in this package.{f' Did you mean {close}?' if close else ''}"
    fix = f"write {close} instead of {module}" if close else "fix the name, or create the file"
    yield Finding("module-missing", cause, source.at(imported.line), fix)


def _holds(file: PythonSource, name: str, modules: Collection[str]) -> bool:
    """Return whether a name, perhaps misspelt, is known to be in a module of the package."""
    names = bound_names(file)
    is_there = name in names or any(is_near_miss(name, other) for other in names)
    return is_there or f"{file.name}.{name}" in modules


def _only_definition(modules: Mapping[str, PythonSource], name: str) -> str | None:
    """Return the only module that defines a class or function; None if none does, or several do."""
    homes = [module for module, file in modules.items() if name in {*file.classes, *file.functions}]
    return homes[0] if len(homes) == 1 and homes[0] else None


def _own_messages(source: PythonSource, imported: Import, module: str, beyond: Beyond) -> Finding:
    """Say why the build does not make the messages that a file imports of its own package."""
    kind = module.rpartition(".")[2]
    cause = f"{module} would hold this package's own messages, but a package of type ament_python cannot generate them from its .{kind} files."
    fix = f"put the .{kind} files into a separate ament_cmake package, with rosidl_generate_interfaces in CMakeLists.txt, and import from that"
    if beyond.is_cmake:
        file = f"{kind}/{imported.target.rpartition('.')[2] if imported.is_from else 'Name'}.{kind}"
        cause = f"{module} would hold this package's own messages, but CMakeLists.txt has no rosidl_generate_interfaces, so the build generates none."
        fix = f'write `find_package(rosidl_default_generators REQUIRED)` and `rosidl_generate_interfaces(${{PROJECT_NAME}} "{file}")` above ament_package() in CMakeLists.txt, and `<buildtool_depend>rosidl_default_generators</buildtool_depend>`, `<exec_depend>rosidl_default_runtime</exec_depend>` and `<member_of_group>rosidl_interface_packages</member_of_group>` above <export> in package.xml'
    return Finding("module-missing", cause, source.at(imported.line), fix)
