"""Explain errors, and faults that no tool reports: what causes them and how to fix them.

Files are parsed, and texts are read. Only launch files are loaded, by launch itself, and a setup.py that may tell
setuptools something in another way than usual is run up to its command line, in a process that can only read and compute.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, ParamSpec

from ros2lab.diagnose.finding import Finding

if TYPE_CHECKING:
    from rclpy.node import Node

    from ros2lab.session import LabSession

_Given = ParamSpec("_Given")

__all__ = ["Finding", "diagnose", "of_graph", "of_text", "of_workspace"]


def diagnose(source: Path | str, environ: Mapping[str, str] | None = None) -> list[Finding]:
    """Return what is wrong, the likeliest cause first; an empty list if nothing is.

    Args:
        source: a workspace folder as a `Path`, or the text of an error as a `str`.
        environ: the environment of the terminal in which a workspace is used; None skips checking it.
    """
    return of_workspace(source, environ) if isinstance(source, Path) else of_text(source)


def _followed(find: Callable[_Given, list[Finding]]) -> Callable[_Given, list[Finding]]:
    """Make a function that fails return a single finding that says so."""

    @functools.wraps(find)
    def followed(*given: _Given.args, **named: _Given.kwargs) -> list[Finding]:
        try:
            return find(*given, **named)
        except NotADirectoryError:
            raise
        except Exception as error:
            from ros2lab.diagnose.net import unjudged

            return [unjudged(error)]

    return followed


@_followed
def of_workspace(path: Path, environ: Mapping[str, str] | None = None) -> list[Finding]:
    """Check a workspace's sources, what was installed from them, and a terminal's environment.

    Raises:
        NotADirectoryError: if there is no such folder.
    """
    from ros2lab.diagnose.checking.called_at_once import called_at_once
    from ros2lab.diagnose.checking.compared_types import compared_types
    from ros2lab.diagnose.checking.type_checker import type_faults
    from ros2lab.diagnose.finding import SAID, ranked, stops_node
    from ros2lab.diagnose.look import Look
    from ros2lab.diagnose.mending.repairs import worth_typing
    from ros2lab.diagnose.net import changed, guarded
    from ros2lab.diagnose.printed.spots import statement_around

    path = path.expanduser().absolute()
    if not path.is_dir():
        raise NotADirectoryError(
            f"There is no folder {path}; give the workspace folder, the one that contains src."
        )
    look = Look(path, environ, loads=True)
    # Where launch itself fails, trust everything that a type checker says about the statement.
    stopped = [finding.place for finding in look.findings if finding.code == SAID and finding.place]
    named = [line for place in stopped for line in statement_around(place, look)]
    checked = [*guarded(called_at_once, look)]
    checked += guarded(type_faults, look, [*look.findings, *checked], named)
    places = {finding.place for finding in (*look.findings, *checked)}
    checked += guarded(compared_types, look, places)
    checked += [lacking for file in look.launch_files for lacking in file.lacks]
    told = {finding.place for finding in checked}  # or the file, where launch names no line
    told |= {finding.place.partition(":")[0] for finding in checked if stops_node(finding)}
    known = (finding for finding in look.findings if finding.code != SAID or finding.place not in told)
    return [changed(worth_typing, finding, look) for finding in ranked([*known, *checked])]


@_followed
def of_text(
    text: str,
    workspace: Path | None = None,
    sources: Mapping[str, str] | None = None,
    *,
    loads: bool = True,
) -> list[Finding]:
    """Explain what a failed command or cell printed.

    Args:
        text: what it printed.
        workspace: where to look for the cause; None takes the workspace of the files named in the text.
        sources: texts of files that are not on disk, such as notebook cells, by their names in the text.
        loads: whether launch may load launch files, and setuptools a setup.py, which runs their code.
    """
    from ros2lab.diagnose.explaining.explanation import explain

    root = workspace.expanduser().absolute() if workspace else None
    return explain(text, root, sources or {}, loads=loads)


def of_graph(node: Node | LabSession) -> list[Finding]:
    """Check the running nodes: similar topics, types and qualities of service that differ, equal names."""
    from ros2lab.diagnose.nodes.graph import graph_findings

    return graph_findings(node if hasattr(node, "get_topic_names_and_types") else node.node)
