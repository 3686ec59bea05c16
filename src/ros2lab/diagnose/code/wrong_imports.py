"""Imports of names or modules that are not there, and the statements that import what was meant."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence

from ros2lab.diagnose.finding import Finding, Guess, these_lines
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.bindings import Import
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest, nothing_like

_Home = tuple[str, str]  # the module, empty for a name that is one, and the name in it
# The packages whose names are known to be those of the student's computer, too.
_KNOWN = interfaces.PACKAGES | sys.stdlib_module_names | {"setuptools"}


def misspelt_packages(source: PythonSource, own: Collection[str]) -> Iterator[Finding]:
    """Yield imports whose package is spelt almost like one of ROS, of the workspace or setuptools."""
    for imported in source.imports:
        top = imported.target.partition(".")[0]
        if imported.is_guarded or top in own:
            continue
        wanted = interfaces.meant(top)
        wanted = (
            wanted if wanted and _may_be_of(imported, wanted) else _own_package(top, (*own, "setuptools"))
        )
        if wanted:
            line = source.text.splitlines()[imported.line - 1].strip()
            new = re.sub(rf"\b{top}\b", wanted, line, count=1)
            fix = f"write `{new}`" if top in line and "(" not in line else f"write {wanted} instead of {top}"
            cause = f"There is no Python package {top}. Did you mean {wanted}?"
            yield Finding("module-missing", cause, source.at(imported.line), fix)


def _may_be_of(imported: Import, package: str) -> bool:
    """Return whether a name, perhaps misspelt, can be imported from another package than the file does, as far as is known."""
    module, _, name = f"{package}.{imported.target.partition('.')[2]}".rpartition(".")
    names = interfaces.importable_names(module) if imported.is_from else None
    return names is None or name in ("*", *names) or any(is_near_miss(name, other) for other in names)


def _own_package(name: str, own_modules: Collection[str]) -> str | None:
    """Return the package of the workspace that a name misspells; None if there is none."""
    if name in sys.stdlib_module_names or interfaces.is_installed(name):
        return None
    return next((module for module in own_modules if "." not in module and is_near_miss(name, module)), None)


def wrong_imports(
    source: PythonSource, own: Mapping[str, Collection[str]], *, is_sure: bool = False
) -> Iterator[Finding]:
    """Yield the import statements that ask a module for names that it does not have, or that name no module.

    Args:
        source: the file.
        own: the names that each module of the workspace binds.
        is_sure: whether an import is known to fail: then those in a `try` are looked at as well, and any
            installed module, not only those of ROS and of Python.
    """
    guarded = {imported.line for imported in source.imports if imported.is_guarded}
    for node in source.nodes:
        if getattr(node, "lineno", None) in guarded and not is_sure:
            continue
        if isinstance(node, ast.ImportFrom) and (found := _of_names(source, node, own, is_sure=is_sure)):
            yield found
        elif isinstance(node, ast.Import):
            yield from _of_modules(source, node, own, is_sure=is_sure)
    yield from _called_modules(source, own)


def _of_names(
    source: PythonSource, node: ast.ImportFrom, own: Mapping[str, Collection[str]], *, is_sure: bool
) -> Finding | None:
    module = source.absolute(node)
    top = module.partition(".")[0]
    is_known = is_sure or module in own or top in _KNOWN
    if not is_known or any(alias.name == "*" for alias in node.names):
        return None
    names = own.get(module) or interfaces.importable_names(module)
    is_absent = is_sure and module == top and not interfaces.is_installed(top)
    if names is None and (top in own or not (is_absent or _lacks(module))):
        return None
    wrong = [alias.name for alias in node.names if alias.name not in (names or ())]
    wrong = [name for name in wrong if f"{module}.{name}" not in own]
    if not wrong:
        return None
    homes = _homes(module, wrong, names, source) | _below(module, wrong, own)
    if is_absent and not homes:
        return None  # a library that is not installed here
    cause = _lacking(module, wrong, homes) if names is not None else f"There is no module {module}"
    return Finding(
        "import-wrong",
        cause + _meant(module, wrong, homes, is_module=names is not None),
        source.at(node),
        fix := _fix(source, node, homes, names),
        guess=_guess(source, node, fix, wrong, homes),
    )


def _lacking(module: str, wrong: Sequence[str], homes: Mapping[str, object]) -> str:
    """Say what a module lacks: where nothing else has it, it may be of another release."""
    is_of_ros = module.partition(".")[0] in interfaces.PACKAGES
    release = " of ROS 2 Jazzy" if is_of_ros and not homes else ""
    return f"{' and '.join(wrong)} {'is' if len(wrong) == 1 else 'are'} not in {module}{release}"


def _guess(
    source: PythonSource, node: ast.ImportFrom, fix: str, wrong: Sequence[str], homes: Mapping[str, _Home]
) -> Guess | None:
    """Return what is written instead of an import, if that is only taken from where a name is; else None."""
    name = wrong[0]
    lines = used_on(source, name)
    if len(wrong) > 1 or homes.get(name, ("", ""))[1] != name or not lines:
        return None
    new = "; ".join(re.findall(r"`((?:from|import) [^`]+)`", fix))
    more = f"line {lines[0]} cannot use {homes[name][0]}.{name} as it does"
    return Guess(ast.unparse(node), new, f"import what is meant there: {more}")


def _below(module: str, wrong: Sequence[str], own: Mapping[str, Collection[str]]) -> dict[str, _Home]:
    """Return the only module of the workspace, directly below another one, that binds each of some names."""
    inner = {name: names for name, names in own.items() if name.rpartition(".")[0] == module}
    holding = {name: [home for home, names in inner.items() if name in names] for name in wrong}
    for name in wrong:  # or it is a module itself, in a folder
        deep = re.compile(rf"({re.escape(module)}\..+)\.{name}")
        holding[name] += [found[1] for found in map(deep.fullmatch, own) if found]
    return {name: (homes[0], name) for name, homes in holding.items() if len(homes) == 1}


def _lacks(module: str) -> bool:
    """Return whether an installed package, or Python itself, has no module of this name."""
    parent, _, last = module.rpartition(".")
    names = interfaces.importable_names(parent) if parent else None
    return names is not None and last not in names and not interfaces.is_module(module)


def other_home(module: str, name: str, source: PythonSource) -> str:
    """Return the module that has a class which another module is asked for; empty if none has it.

    A function may be meant as that of an object; it counts if the file imports its module.
    """
    names = interfaces.importable_names(module) or ()
    home, meant = _homes(module, [name], names, source).get(name, ("", ""))
    is_known = name[:1].isupper() or home in [imported.target for imported in source.imports]
    return home if home != module and meant == name and is_known else ""


def _homes(
    module: str, wrong: Sequence[str], names: Collection[str] | None, source: PythonSource
) -> dict[str, _Home]:
    """Return where each of the missing names is, as it was meant; a name of which nothing is known is left out."""
    meant = interfaces.module_meant(module) if names is None else module
    known = (names or interfaces.importable_names(meant) or ()) if meant else ()
    taken = {
        name for name in known if interfaces.is_module(whole := f"{meant}.{name}") or whole in sys.modules
    } | sys.stdlib_module_names
    there = [imported.target for imported in source.imports]
    found: dict[str, _Home] = {}
    for name in wrong:
        if names is None and name in known:
            found[name] = meant, name
            continue
        near = nearest(name, known)
        if near and near.lower() == name.lower() and near not in taken:
            found[name] = meant, near
        elif name in _KNOWN and not _is_called(source, name):
            found[name] = "", name
        elif homes := _homes_of(name, module, source):
            found[name] = homes[0], name
        elif near and (f"{meant}.{near}" not in there or is_near_miss(name, near)):
            found[name] = meant, near
    return found


def _is_called(source: PythonSource, name: str) -> bool:
    """Return whether a file calls a name itself, which it cannot do with a module."""
    calls = (node.func for node in source.calls)
    return any(isinstance(called, ast.Name) and called.id == name for called in calls)


def _homes_of(name: str, module: str, source: PythonSource) -> list[str]:
    """Return the modules that define a name: for a module of Python those of Python first."""
    known = [imported.target for imported in source.imports]
    of_ros, around = interfaces.homes_for(name, known), interfaces.homes_around(name, module, known)
    is_pythons = module.partition(".")[0] in sys.stdlib_module_names
    return [*around, *of_ros] if is_pythons else [*of_ros, *around]


def _meant(module: str, wrong: Sequence[str], homes: Mapping[str, _Home], *, is_module: bool) -> str:
    """Say where the missing names are, as the end of a sentence, and what similar names there are."""
    said = asked = ""
    for name in wrong:
        home, meant = homes.get(name, ("", ""))
        if meant and not home:
            said += f"; {meant} is a module itself"
        elif meant == name and home != module:
            said += f"; it is in {home}" if len(wrong) == 1 and is_module else f"; {name} is in {home}"
        elif meant:
            asked += f" Did you mean {meant}?"
    return f"{said}.{asked}"


def _fix(
    source: PythonSource, node: ast.ImportFrom, homes: Mapping[str, _Home], names: Collection[str] | None
) -> str:
    """Return the statements that import the same names from where they are, and what else must be renamed."""
    by_home: dict[str, dict[str, None]] = {}  # each name once, in order
    renamed: dict[str, str] = {}
    lost: list[str] = []
    module = f"{'.' * node.level}{node.module or ''}"
    for alias in node.names:
        if alias.name in homes:
            home, name = homes[alias.name]
            home = module if home == source.absolute(node) else home
            if name != alias.name and not alias.asname:
                renamed[alias.name] = name
        elif alias.name in (names or ()):
            home, name = module, alias.name
        else:
            lost.append(alias.name)
            continue
        by_home.setdefault(home, {})[f"{name} as {alias.asname}" if alias.asname else name] = None
    # A module that is in no other is imported by itself.
    written = [
        f"`from {home} import {', '.join(names)}`" if home else f"`import {', '.join(names)}`"
        for home, names in by_home.items()
    ]
    if not homes:
        return _without(source, source.absolute(node), lost, written)
    used = [
        f"{new} instead of {old} on line {' and '.join(map(str, lines))}"
        for old, new in renamed.items()
        if (lines := used_on(source, old))
    ]
    instead = f", one below the other, instead of line {node.lineno}" if len(written) > 1 else ""
    return f"write {' and '.join(written)}{instead}{', and ' if used else ''}{' and '.join(used)}"


def _without(source: PythonSource, module: str, lost: list[str], written: list[str]) -> str:
    """Say what to do with names that a module lacks, and nothing is like; only the workspace's own can be defined."""
    used = sorted({line for name in lost for line in used_on(source, name)})
    if not used:
        return (
            f"write {written[0]}: nothing here uses {' or '.join(lost)}"
            if written
            else "remove this line: nothing here uses what it imports"
        )
    where = f"here, with what uses it on {these_lines(used)}"
    return nothing_like(" and ".join(lost), module, where, is_own=module.partition(".")[0] not in _KNOWN)


def used_on(source: PythonSource, name: str) -> list[int]:
    """Return the lines on which a file uses a name, or an attribute as it is written."""
    used = (node for node in source.nodes if isinstance(node, (ast.Name, ast.Attribute)))
    return sorted({node.lineno for node in used if ast.unparse(node) == name})


def _called_modules(source: PythonSource, own: Mapping[str, Collection[str]]) -> Iterator[Finding]:
    """Yield imports of a module of ROS that is then used as the class of that name in it."""
    called = {ast.unparse(node.func) for node in source.calls}
    called |= {ast.unparse(base) for n in source.nodes if isinstance(n, ast.ClassDef) for base in n.bases}
    for imported in source.imports:
        module, _, name = imported.target.rpartition(".")
        is_ros = (
            imported.is_from
            and module.partition(".")[0] in interfaces.PACKAGES
            and imported.target not in own
        )
        is_used_so = imported.local in called and imported.local not in source.stored
        if not (is_ros and is_used_so and interfaces.is_module(imported.target)):
            continue
        meant = nearest(name, interfaces.importable_names(imported.target) or ())
        known = [other.target for other in source.imports]
        homes = interfaces.homes_for(meant, known) if meant else ()
        if meant and homes and meant.lower() == name.lower():
            alias = f" as {imported.local}" if imported.local not in (name, meant) else ""
            used = (
                ""
                if imported.local == meant or alias
                else f", and {meant} instead of {imported.local} where it is used"
            )
            cause = f"{imported.target} is a module; the class {meant} is in {homes[0]}."
            fix = f"write `from {homes[0]} import {meant}{alias}`{used}"
            yield Finding("import-wrong", cause, source.at(imported.line), fix)


def _of_modules(
    source: PythonSource, node: ast.Import, own: Mapping[str, Collection[str]], *, is_sure: bool
) -> Iterator[Finding]:
    """Yield submodules that a statement such as `import rclpy.nodes` names, and that are not there."""
    for alias in node.names:
        top = alias.name.partition(".")[0]
        is_known = (is_sure or top in _KNOWN) and top not in own
        is_absent = is_sure and alias.name == top and not interfaces.is_installed(top)
        is_wrong = is_known and (is_absent or _lacks(alias.name))
        meant = interfaces.module_meant(alias.name) if is_wrong else ""
        if meant:
            now = f"import {meant} as {alias.asname}" if alias.asname else f"import {meant}"
            lines = " and ".join(map(str, used_on(source, alias.name))) if "." in alias.name else ""
            used = f", and {meant} instead of {alias.name} on line {lines}" if lines else ""
            cause = f"There is no module {alias.name}. Did you mean {meant}?"
            yield Finding("import-wrong", cause, source.at(node), f"write `{now}`{used}")
