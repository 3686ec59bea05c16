"""Modules of a package that are in none of its Python files: the build makes them, or compiles them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

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
