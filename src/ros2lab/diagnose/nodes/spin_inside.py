"""A spin in a constructor or a callback, and what is to be moved into main with it."""

from __future__ import annotations

import ast

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.sources.caught import may_be_caught
from ros2lab.diagnose.sources.node_source import NodeClass
from ros2lab.diagnose.sources.python_source import Function, PythonSource, last_name, own_nodes, walk
from ros2lab.diagnose.sources.removal import removal
from ros2lab.diagnose.sources.syntax_parts import calls_in


def spin_inside(
    source: PythonSource, owner: NodeClass | None, function: Function, spin: ast.Call, what: str
) -> Finding:
    """Return the finding of a spin; the `try` around it, and what ends the node below, go with it."""
    ends = "never returns and nothing after it is reached"
    if may_be_caught(source, spin.lineno, KeyboardInterrupt):
        ends = "does not return before Ctrl-C, and nothing after it is reached until then"
    cause = f"{what[0].upper()}{what[1:]} spins, so it {ends}."
    made = f"node = {owner.definition.name}()" if owner else "node = ..."
    tries = (
        n for n in own_nodes(function) if isinstance(n, ast.Try) and any(spin in walk(s) for s in n.body)
    )
    around = next(tries, None)
    last = (around or spin).end_lineno or 0
    ending = {
        call.lineno
        for call in calls_in(own_nodes(function))
        if last_name(call.func) in ("destroy_node", "shutdown", "try_shutdown") and call.lineno > last
    }
    fix = f"{removal(source, spin)} here, and write rclpy.spin(node) in main, after the node is made"
    if what == "the constructor" and (around or ending):
        moved = f"the whole try on line {around.lineno}" if around else f"`{ast.unparse(spin)}`"
        lines = "".join(f" and line {line}" for line in sorted(ending))
        fix = f"move {moved}{lines} to main, below `{made}`, with node instead of self"
    return Finding("spin-inside", cause, source.at(spin), fix)
