"""Modules of a package that are in none of its Python files: the build makes them, or compiles them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from portable_ros2.new_package import NewPackage
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import last_name, read_text

# Arguments of setup() with which a build does more than to copy files.
_MAKING = frozenset(("cmdclass", "ext_modules", "cffi_modules", "rust_extensions", "use_scm_version"))
_CONFIGURATIONS = ("setup.cfg", "pyproject.toml", "CMakeLists.txt")
_FILE = re.compile(r"(\w+)\.py\b")
_INTERFACE = re.compile(r"\.(?:msg|srv|action)(?:\.|$)")
# Calls for their effect on what setup() is given, or on nothing.
_HARMLESS = frozenset(("setup", "append", "extend", "insert", "update", "print"))


def is_made(package: SourcePackage, module: str) -> bool:
    """Return whether a module without a Python file is there once its package is built.

    What the build writes is known by its name in setup.py or in the files beside it; where none is written there, by
    what is installed. An installed copy alone does not count: it may be of a file that has been renamed since.
    """
    texts = [read_text(package.folder / name) for name in _CONFIGURATIONS]
    if package.build_type == "ament_python":
        texts[-1] = ""  # colcon does not read it
    if _INTERFACE.search(module) and "rosidl_generate_interfaces" in texts[-1]:
        return True
    leaf = module.rpartition(".")[2]
    written = written_modules(package)
    if _is_compiled(package, module) or leaf in written or any(leaf in _FILE.findall(text) for text in texts):
        return True
    does_more = _does_more(package)
    folders = [folder for folder in _installed(package) if (folder / package.name).is_dir()]
    if folders:
        path = Path(*module.split("."))
        files = (
            folder / file for folder in folders for file in (path.with_suffix(".py"), path / "__init__.py")
        )
        return (does_more or bool(texts[-1])) and any(file.is_file() for file in files)
    return does_more and (not written or "" in written)


def written_modules(package: SourcePackage) -> set[str]:
    """Return the last parts of modules that setup.py names and that have no file yet, empty for one put together."""
    nodes = package.setup.source.nodes if package.setup else ()
    joined = {id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values}
    names = {
        "" if id(node) in joined or node.value.startswith(".") else Path(node.value).name.removesuffix(".py")
        for node in nodes
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.endswith(".py")
    }
    return {name for name in names if not package.places_of(f"{name}.py")}


def _does_more(package: SourcePackage) -> bool:
    """Return whether setup.py builds more than Python files, or calls something for its effect."""
    if package.setup is None:
        return False
    calls = (
        n.value
        for n in package.setup.source.nodes
        if isinstance(n, ast.Expr) and isinstance(n.value, ast.Call)
    )
    names = {last_name(call.func) for call in calls}
    return bool(names - _HARMLESS) or not _MAKING.isdisjoint(package.setup.keywords)


def _is_compiled(package: SourcePackage, module: str) -> bool:
    """Return whether a library in another language lies where the module would."""
    parent, _, leaf = module.rpartition(".")
    owner = package.sources.get(parent)
    folder = owner.path.parent if owner and owner.path else None
    return folder is not None and any(file.suffix in (".so", ".pyd") for file in folder.glob(f"{leaf}.*"))


def _installed(package: SourcePackage) -> Iterator[Path]:
    """Yield the folders in which the modules of a package are once it is built."""
    root = package.root or package.beside.parent
    for prefix in (root / "install" / package.name, root / "install"):
        yield from prefix.glob("lib/python3*/site-packages")
        yield from prefix.glob("local/lib/python3*/dist-packages")
    yield root / "build" / package.name


_COMMAND = re.compile(r"^\s*(\w+)\s*\(", re.MULTILINE)
# Those that make no program, or name it.
_PLAIN = re.compile(
    r"add_executable|add_library|install|ament_(?:target|export|python_install)_\w+|target_\w+|rosidl_generate_interfaces"
)


def commands_in(text: str) -> set[str]:
    """Return the commands of a CMakeLists.txt besides those that `ros2 pkg create` writes, which make nothing yet."""
    begun = NewPackage("new", "ament_cmake", 3, "", "", "", "", []).render("ament_cmake/CMakeLists.txt")
    return {*_COMMAND.findall(text.lower())} - {*_COMMAND.findall(begun)}


def programs_of(package: SourcePackage) -> list[str] | None:
    """Return the programs that a CMakeLists.txt makes or installs by their names; None if there may be others."""
    text = package.cmake
    taken = re.findall(r"\binstall\s*\(\s*PROGRAMS\b([^()]*?)DESTINATION", text)
    names = re.findall(r"\badd_executable\s*\(\s*(\S+)", text) + [
        name for row in taken for name in row.split()
    ]
    is_open = re.search(r"RENAME|SCRIPTS_DESTINATION|DIRECTORY[^()]*DESTINATION\s+lib", text)
    has_variable = any("$" in name.rpartition("/")[2] for name in names)
    if (
        is_open
        or has_variable
        or not package.is_built_by_cmake
        or not all(map(_PLAIN.fullmatch, commands_in(text)))
    ):
        return None
    return [name.strip('"').rpartition("/")[2] for name in names]
