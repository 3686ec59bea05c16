"""Pictures of what is really there: a folder, an overlay chain, an entry point, a graph.

Each is drawn by JupyterLab from Mermaid's text and has the same in words, for a terminal and a screen reader.
"""

from __future__ import annotations

import ast
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from catkin_pkg.packages import find_packages

from ros2lab import course

TREE_HIDDEN = ("__pycache__", "*.pyc", ".*")


class Picture:
    """A picture with its text.

    Attributes:
        mermaid: what is drawn, in Mermaid's language.
        text: the same in words.
    """

    def __init__(self, mermaid: str, text: str) -> None:
        self.mermaid = mermaid
        self.text = text

    def __repr__(self) -> str:
        return self.text

    def _repr_mimebundle_(self, **_: Any) -> dict[str, str]:
        return {"text/vnd.mermaid": self.mermaid, "text/plain": self.text}


class Tree:
    """A folder as a tree of lines.

    Args:
        folder: as the lab's terminals write it.
        depth: how many levels are shown.
        hidden: patterns of names that are left out.
    """

    def __init__(self, folder: str | Path, depth: int = 3, hidden: Sequence[str] = TREE_HIDDEN) -> None:
        self._folder = course.student_path(folder)
        self._depth = depth
        self._hidden = tuple(hidden)
        if not self._folder.is_dir():
            raise NotADirectoryError(f"There is no folder {course.shown_path(self._folder)} to draw.")

    def __repr__(self) -> str:
        return "\n".join([course.shown_path(self._folder) + "/", *self._lines(self._folder, "", self._depth)])

    def _lines(self, folder: Path, indent: str, depth: int) -> Iterable[str]:
        entries = [
            entry
            for entry in sorted(folder.iterdir(), key=lambda path: (not path.is_dir(), path.name))
            if not any(entry.match(pattern) for pattern in self._hidden)
        ]
        for entry in entries:
            is_last = entry is entries[-1]
            arrow = f" -> {entry.readlink()}" if entry.is_symlink() else ""
            is_folder = entry.is_dir() and not entry.is_symlink()
            yield f"{indent}{'└── ' if is_last else '├── '}{entry.name}{'/' if is_folder else ''}{arrow}"
            if is_folder and depth > 1:
                yield from self._lines(entry, indent + ("    " if is_last else "│   "), depth - 1)


def overlay_chain(environ: Mapping[str, str] = os.environ, package: str = "") -> Picture:
    """Draw the prefixes on `AMENT_PREFIX_PATH`, the first one on top.

    Args:
        environ: the environment, such as `terminal().environ()`.
        package: a package whose places are marked; the topmost is the one that runs.
    """
    prefixes = [Path(part) for part in environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if part]
    if not prefixes:
        return Picture('flowchart TD\n    nothing["nothing is sourced"]', "nothing is sourced")
    names, lines, runs = [], ["flowchart TD"], True
    for number, prefix in enumerate(prefixes):
        name = course.shown_path(prefix)
        if package and (prefix / "share" / "ament_index" / "resource_index" / "packages" / package).exists():
            name += f": {package}, {'which runs' if runs else 'hidden'}"
            runs = False
        names.append(name)
        lines.append(f'    p{number}["{_quoted(name)}"]')
        if number:
            lines.append(f"    p{number - 1} -- on top of --> p{number}")
    return Picture("\n".join(lines), "\n".join(f"{n + 1}. {name}" for n, name in enumerate(names)))


def entry_point(package: str | Path, name: str) -> Picture:
    """Draw an entry point of a package's setup.py, taken apart, and what it leads to.

    Args:
        package: the package's folder, as the lab's terminals write it.
        name: of the executable.

    Raises:
        LookupError: if setup.py names no such executable.
    """
    folder = course.student_path(package)
    specification = _console_scripts(folder / "setup.py").get(name)
    if specification is None:
        raise LookupError(f"{course.shown_path(folder)}/setup.py has no entry point named {name}.")
    module, _, function = specification.partition(":")
    file = folder.joinpath(*module.split(".")).with_suffix(".py")
    line = _definition(file, function)
    package_name = module.partition(".")[0]
    found = f"{file.relative_to(folder)}" if file.is_file() else f"{file.relative_to(folder)} is not there"
    where = f"def {function}, line {line}" if line else f"no {function} in it"
    mermaid = f"""flowchart LR
    command["ros2 run {_quoted(package_name)} {_quoted(name)}"] --> script["install/…/lib/{_quoted(package_name)}/{_quoted(name)}"]
    script --> entry["{_quoted(name)} = {_quoted(specification)}"]
    entry -- "{_quoted(module)}" --> file["{_quoted(found)}"]
    entry -- "{_quoted(function)}" --> main["{_quoted(where)}"]
    file --> main"""
    text = f"{name} = {module} : {function}\n  executable  {name}\n  module      {module}  ({found})\n  function    {function}  ({where})"
    return Picture(mermaid, text)


def package_graph(workspace: str | Path) -> Picture:
    """Draw which packages of a workspace need which others of it, as their package.xml files say.

    Args:
        workspace: its folder, as the lab's terminals write it.

    Raises:
        NotADirectoryError: if it has no `src`.
        catkin_pkg.package.InvalidPackage: if a package.xml is not valid.
    """
    source = course.student_path(workspace) / "src"
    if not source.is_dir():
        raise NotADirectoryError(f"There is no folder {course.shown_path(source)} to look for packages in.")
    packages = sorted(find_packages(str(source)).values(), key=lambda package: str(package.name))
    names = [str(package.name) for package in packages]
    lines = ["flowchart LR", *(f'    p{number}["{_quoted(name)}"]' for number, name in enumerate(names))]
    texts = []
    for number, package in enumerate(packages):
        tags = (package.build_depends, package.buildtool_depends, package.exec_depends, package.test_depends)
        needed = sorted({dependency.name for tag in tags for dependency in tag} & set(names))
        lines += [f"    p{number} -- needs --> p{names.index(name)}" for name in needed]
        texts.append(f"{names[number]} needs {', '.join(needed) or 'no other'}")
    return Picture("\n".join(lines), "\n".join(texts) or "no packages")


def node_graph(node: Any) -> Picture:
    """Draw the nodes that a node sees, and the topics that connect them; what every node has is left out.

    Args:
        node: an rclpy node, such as `session.node`.
    """
    from ros2lab.diagnose.nodes.ros_graph import graph_of, observe, words  # the other pictures need no ROS

    graph = graph_of(observe(node))
    boxes = {part.name: f"n{number}" for number, part in enumerate(graph.nodes)}
    lines = ["flowchart LR", *(f'    {box}["{_quoted(name)}"]' for name, box in boxes.items())]
    for number, topic in enumerate(graph.topics):
        box = f"t{number}"
        lines.append(f'    {box}{{{{"{_quoted(topic.name)}<br>{_quoted(", ".join(topic.types))}"}}}}')
        edges = [edge for edge in graph.edges if edge.medium == topic.name]
        lines += [f"    {boxes[edge.node]} --> {box}" for edge in edges if edge.is_from_node]
        lines += [f"    {box} --> {boxes[edge.node]}" for edge in edges if not edge.is_from_node]
    return Picture("\n".join(lines), "\n".join(words(graph) or boxes) or "no nodes")


def _console_scripts(file: Path) -> dict[str, str]:
    """Return the executables of a setup.py by their names, without running it."""
    found = {}
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and ":" in node.value:
            name, equals, specification = node.value.partition("=")
            if equals:
                found[name.strip()] = specification.strip()
    return found


def _definition(file: Path, function: str) -> int:
    """Return the line in which a file defines a function; 0 if it does not."""
    if not file.is_file():
        return 0
    nodes = ast.parse(file.read_text(encoding="utf-8")).body
    return next((n.lineno for n in nodes if isinstance(n, ast.FunctionDef) and n.name == function), 0)


def _quoted(text: str) -> str:
    return text.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
