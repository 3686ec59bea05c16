"""Programs that read the arguments that ROS adds to a command line as if they were their own."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.sources.python_source import PythonSource, last_name

# How argparse, click, getopt, and a conversion of an item of sys.argv complain.
_REFUSED = re.compile(
    r"(?:unrecognized arguments: |[Nn]o such option:? |\boption |invalid .+: '|could not convert .+: ')(?P<word>--ros-args|[\w/~]+:=)"
)
_OWN = "rclpy.utilities.remove_ros_args()"


def of_ros_arguments(error: ErrorText, look: Look) -> Finding | None:
    """Say how a program is to leave out what ROS adds to its arguments; None if it complains of something else."""
    refused = _REFUSED.search(error.text)
    named = {*re.findall(r"[\w.-]+", error.text)}
    points = [(package, point) for package in look.packages for point in package.points]
    for package, point in points if refused else ():
        source = package.sources.get(point.module)
        is_named = not named.isdisjoint((point.name, f"{point.module.rpartition('.')[2]}.py"))
        if is_named and source and (reading := next(_readings(source), None)):
            node, written = reading
            more = "" if "rclpy" in source.names else ", with `import rclpy` at the top"
            cause = f"`{ast.unparse(node)}` also reads --ros-args and what follows it, which is meant for rclpy alone."
            given = "; give its own arguments in the launch file, by arguments=[...]"
            is_item = not isinstance(node, ast.Call)
            return Finding(
                "argument-unknown", cause, source.at(node), f"write `{written}`{more}{given * is_item}"
            )
    return None


def _readings(source: PythonSource) -> Iterator[tuple[ast.expr, str]]:
    """Yield what reads the whole command line, each with what reads only the program's own part of it."""
    for node in source.nodes:
        match node:
            case ast.Call(func=ast.Attribute(attr="parse_args") as called, args=[], keywords=[]):
                yield node, f"{ast.unparse(called)}({_OWN}[1:])"
            case ast.Subscript(value=ast.Attribute() as whole) if source.resolve(whole) == "sys.argv":
                above = source.above(node)
                if last_name(getattr(above, "func", None)) != "init":
                    yield node, ast.unparse(node).replace(ast.unparse(whole), _OWN)
