"""Tell packages for ROS from plain Python libraries and CMake projects that colcon builds, too."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection

from ros2lab.diagnose.code.syntax_repairs import mended
from ros2lab.diagnose.packaging.setup_shapes import like
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, read_text

_OF_THE_INDEX = re.compile(r"\bament_index\b|(?:^|/)package\.xml$")


def is_for_ros(package: SourcePackage, started: Collection[str] = ()) -> bool:
    """Return whether a package has a package.xml, or something that only a ROS package needs, or is started by launch.

    colcon builds a folder with only a setup.py as a Python package, and one with a CMakeLists.txt as a CMake
    package: neither needs a package.xml if it is only imported or linked.
    """
    if package.has("package.xml") or renamed_manifest(package) or package.name in started:
        return True
    if package.kind == "cmake":
        return False
    has_marker = package.has(f"resource/{package.name}")
    return has_marker or bool(package.launch_files) or _installs_for_ros(package) or bool(programs(package))


def renamed_manifest(package: SourcePackage) -> str:
    """Return the name of a manifest that is nearly called package.xml; empty if there is none."""
    name = like(package.folder / "package.xml")
    return name if name and "<package" in read_text(package.folder / name) else ""


def _installs_for_ros(package: SourcePackage) -> bool:
    """Return whether a package installs a marker, a manifest or programs where only ROS looks for them."""
    config = package.setup_cfg
    keys = (("develop", "script_dir"), ("install", "install_scripts"))
    folders = [config.get(*key, fallback="") for key in keys] if config else []
    if any(f"lib/{package.name}" in (folder or "") for folder in folders):
        return True
    source = package.setup.source if package.setup else None
    if source is None:
        return False
    if source.tree is None or source.fault:
        return "ament_index" in source.text
    texts = (node.value for node in source.nodes if isinstance(node, ast.Constant))
    return any(isinstance(text, str) and _OF_THE_INDEX.search(text) for text in texts)


def programs(package: SourcePackage) -> list[str]:
    """Return the modules that are programs with a node, as they use rclpy and have a main().

    A main() to which its file gives what it needs is called there alone.
    """
    files = {name: mended(source) for name, source in package.sources.items()}
    with_main = [name for name, file in files.items() if file.names.get("main") == f"{name}.main"]
    return [name for name in with_main if "rclpy" in files[name].names and not _given(files[name])]


def _given(source: PythonSource) -> bool:
    """Return whether a file calls its own main() with arguments that it needs."""
    main = source.functions.get("main")
    calls = (call for call in source.calls if getattr(call.func, "id", "") == "main")
    return main is not None and len(main.args.args) > len(main.args.defaults) and any(map(given_to, calls))
