"""Command-line arguments that a launch file gives a program that reads none."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Mapping

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.launching.launch_file import Launched
from ros2lab.diagnose.launching.misplaced_values import OPTIONS, value_of
from ros2lab.diagnose.nodes.parameter_faults import declared_in
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, given_to, own_nodes

# Modules that read the command line; sys does so only by its argv.
_READERS = frozenset(("argparse", "optparse", "getopt", "click", "typer", "fire", "docopt", "absl"))
_LONGEST = 60  # signs of words that are shown together
_OPTIONS = {"__log_level": "--log-level", "__params": "--params-file"}
_NAMES = {"__node": "name", "__name": "name", "__ns": "namespace"}


def unread_words(node: Launched, packages: Mapping[str, SourcePackage]) -> Iterator[Finding]:
    """Yield `arguments` given to a program of the workspace that never reads its command line."""
    package = packages.get(node.package) if isinstance(node.package, str) else None
    words = node.arguments
    if "--ros-args" in node.arguments:
        words = node.arguments[: node.arguments.index("--ros-args")]
    points = package.points if package else ()
    module = next((point.module for point in points if point.name == node.executable), None)
    if package is None or not words or module is None or module not in package.sources:
        return
    sources = NodeSources(package.sources)
    files = [sources.sources[name] for name in sources.together(module)]
    if any(source.fault or _reads_words(source) for source in files):
        return
    inside = f"{package.root}/" if package.root else ""
    said = [word.replace(inside, "") if inside else word for word in words]
    short = " ".join(said)
    short = f"{said[0]} ..." if len(short) > _LONGEST and len(said) > 1 else short
    cause = f"arguments passes `{short}` to {node.executable} on the command line, but it reads no command-line arguments, so they change nothing."
    fix = _fix(words, declared_in(sources) or {})
    if ".py:" in node.place and fix.startswith("write parameters=['/"):
        fix = (
            "write parameters instead of arguments, with the same list"  # which may be worked out in the file
        )
    yield Finding("words-unread", cause, node.place, fix)


def _fix(words: tuple[str, ...], declared: Mapping[str, object]) -> str:
    """Return a fix that puts the words where they belong, by their form."""
    if not OPTIONS.isdisjoint(words):
        return f"write arguments={['--ros-args', *words]!r}"
    pairs = [word.partition(":=")[::2] for word in words if ":=" in word]
    if len(pairs) == len(words):
        return f"write {', '.join(_in_their_places(pairs, declared))} instead of arguments"
    if all(word.endswith((".yaml", ".yml")) for word in words):
        return f"write parameters={[*words]!r} instead of arguments"
    values = _named(words, declared)
    where = "if the node needs the value, declare a parameter for it there, and set that parameter here"
    return f"write parameters=[{values!r}] instead of arguments" if values else f"remove arguments; {where}"


def _in_their_places(pairs: Iterable[tuple[str, str]], declared: Mapping[str, object]) -> Iterator[str]:
    """Yield the keywords of a Node that mean what `old:=new` meant in a command of the first releases."""
    options, moved, values = list[str](), list[tuple[str, str]](), dict[str, object]()
    for old, new in pairs:
        if old in _NAMES:
            yield f"{_NAMES[old]}={new!r}"
        elif old in _OPTIONS:
            options += [_OPTIONS[old], new]
        elif old not in declared and (old.startswith(("/", "~")) or new.startswith("/")):
            moved.append((old, new))
        else:
            values[old] = value_of(new)
    if options:
        yield f"ros_arguments={options!r}"
    if moved:
        yield f"remappings={moved!r}"
    if values:
        yield f"parameters=[{values!r}]"


def _named(words: tuple[str, ...], declared: Mapping[str, object]) -> dict[str, object]:
    """Return the parameters that words are values of: by their options, or a number for the only parameter."""
    options = [
        (old.removeprefix("--"), value_of(new)) for old, new in zip(words[::2], words[1::2], strict=False)
    ]
    if len(words) % 2 == 0 and all(old in declared for old, _ in options):
        return dict(options)
    is_number = len(words) == 1 and isinstance(value_of(words[0]), (int, float))
    return {next(iter(declared)): value_of(words[0])} if is_number and len(declared) == 1 else {}


def _reads_words(source: PythonSource) -> bool:
    """Return whether a file may read the command line."""
    if any(imported.target.partition(".")[0] in _READERS for imported in source.imports):
        return True
    if "argv" in source.text or "remove_ros_args" in source.text:
        return True
    functions = (n for n in source.tree.body if isinstance(n, ast.FunctionDef))
    main = next((function for function in functions if function.name == "main"), None)
    taken = [argument.arg for argument in main.args.args] if main else []
    nodes = own_nodes(main) if main else ()
    # rclpy.init() reads only what comes after --ros-args.
    handed = {
        id(given)
        for node in nodes
        if isinstance(node, ast.Call) and source.resolve(node.func) == "rclpy.init"
        for given in given_to(node)
    }
    return any(
        isinstance(n, ast.Name) and n.id in taken and isinstance(n.ctx, ast.Load) and id(n) not in handed
        for n in nodes
    )
