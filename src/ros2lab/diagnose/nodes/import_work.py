"""Programs that never begin, because a file that they import runs until Ctrl-C."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.nodes.spin_loops import is_endless
from ros2lab.diagnose.sources.entrance import Entrance, is_lasting
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.one_run import is_always_reached
from ros2lab.diagnose.sources.python_source import Function, PythonSource, is_generator, own_nodes
from ros2lab.diagnose.sources.static_value import dotted

_GUARD = "`if __name__ == '__main__':`"
_DEEPEST = 4  # functions that call each other


def import_work(entrance: Entrance) -> Iterator[Finding]:
    """Yield what runs until Ctrl-C in a file that a program imports before it calls its own function."""
    sources, own = entrance.sources, entrance.source
    at_top = {
        statement.lineno for statement in own.tree.body if isinstance(statement, (ast.Import, ast.ImportFrom))
    }
    told = {own.name}
    for imported in own.imports:
        target = imported.target if imported.target in sources.sources else imported.target.rpartition(".")[0]
        for name in sources.imported_by(target) if imported.line in at_top else ():
            source = sources.sources[name]
            work = _lasting(sources, source, source.tree, _DEEPEST) if name not in told else None
            told.add(name)
            if work is not None:
                yield _finding(entrance, source, work, imported.line)


def _lasting(
    sources: NodeSources, source: PythonSource, block: Function | ast.Module, depth: int
) -> ast.Call | ast.While | None:
    """Return what keeps every run of a function or a file from its end until Ctrl-C; None if nothing is known to."""
    for node in own_nodes(block):
        if not isinstance(node, (ast.Call, ast.While)) or not is_always_reached(block, node):
            continue
        if isinstance(node, ast.While):
            if is_endless(node, source):
                return node
            continue
        name = sources.resolve(source, node.func) or dotted(node.func) or ""
        home, function = sources.functions.get(name, (source, None))
        is_run = isinstance(function, ast.FunctionDef) and not is_generator(function) and depth > 0
        if is_lasting(name) or (is_run and function and _lasting(sources, home, function, depth - 1)):
            return node
    return None


def _finding(entrance: Entrance, source: PythonSource, work: ast.Call | ast.While, line: int) -> Finding:
    """Say that a line of a file runs when the file is imported, and how it runs only when it is started itself."""
    text = f"{ast.unparse(work)}, which" if isinstance(work, ast.Call) else "a loop that"
    name, own = source.name.rpartition(".")[2], entrance.source.name.rpartition(".")[2]
    cause = (
        f"Importing {name} runs {text} goes on until Ctrl-C: {own} imports it on line {line}, "
        f"so {entrance.function.name}() of {own} is not reached."
    )
    fix = f"write {_GUARD} above this line, and indent this line by four spaces"
    is_alone = any(isinstance(above, ast.Expr) and above.value is work for above in source.tree.body)
    if not is_alone or is_lasting(source.resolve(getattr(work, "func", None)) or ""):
        fix = f"move this, with the lines that prepare it, into a function, and call that below {_GUARD}"
    return Finding("never-called", cause, source.at(work), fix)
