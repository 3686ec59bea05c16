"""Read what launch files start, without running them."""

from __future__ import annotations

import ast
import re
import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ros2lab.diagnose.code.bound_names import bound_in, undefined_names
from ros2lab.diagnose.code.expression_faults import comma_faults, is_by_comma, path_faults, tuple_by_comma
from ros2lab.diagnose.code.meant_names import meant
from ros2lab.diagnose.code.merge_conflicts import conflict_in
from ros2lab.diagnose.code.syntax_repairs import syntax_finding
from ros2lab.diagnose.code.wrong_imports import misspelt_packages, wrong_imports
from ros2lab.diagnose.finding import Finding, at, not_read
from ros2lab.diagnose.launching.entity_words import entity_repair
from ros2lab.diagnose.launching.launch_arguments import all_named, calls_of_launch
from ros2lab.diagnose.launching.launch_kinds import READING, kind_faults
from ros2lab.diagnose.launching.launch_values import declared_late, used_too_early
from ros2lab.diagnose.launching.misplaced_values import joined_words, misplaced_values, older_keywords
from ros2lab.diagnose.launching.plain_values import passed_on, plain_value_faults
from ros2lab.diagnose.launching.unlisted import unlisted
from ros2lab.diagnose.sources.calls import as_list
from ros2lab.diagnose.sources.commented_out import put_back
from ros2lab.diagnose.sources.interfaces import launch_homes_of
from ros2lab.diagnose.sources.python_source import PythonSource, own_nodes, read_source, read_text
from ros2lab.diagnose.sources.signatures import LISTS, heads_of, signature_of
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN, dotted, evaluate

_LISTS = frozenset(("parameters", "remappings", "arguments", "ros_arguments"))
# Actions that may read or set any launch argument.
_MAY_READ_ANY = ("Include", "OpaqueFunction", "SetLaunchConfiguration", "Push", "Group")
SHARE = "share:"  # stands for a package's share folder in a path


@dataclass(frozen=True)
class Launched:
    """A node that a launch file starts; what is not known is `UNKNOWN`.

    Attributes:
        output: where it prints; None if that is not given.
        files: the parameter files that it is given, as (package, path below its share folder).
        remappings: the names that are replaced, each with the new one.
        namespace: the namespace in which it is started; empty for none.
        arguments: its command-line arguments.
        given: its parameters in order: dicts of values by name, and paths of files.
        by_argument: the launch arguments that change nothing of it but parameters, by the entry's number and the name.
        is_wrapped: whether launch starts another program, such as a terminal of its own, which then starts it.
        is_listed: whether launch is given it, as far as the text tells.
        entries: the places of the names that its parameters and remappings have in the file, and of their lists.
        line: where it is made; 0 if that is not known.
    """

    package: Any
    executable: Any
    name: Any
    files: tuple[tuple[str, str], ...]
    remappings: tuple[tuple[str, Any], ...]
    place: str
    namespace: Any = ""
    output: Any = None
    arguments: tuple[str, ...] = ()
    given: tuple[Mapping[str, Any] | str, ...] = ()
    is_wrapped: bool = False
    is_listed: bool = True
    by_argument: Mapping[tuple[int, str], str] = field(default_factory=dict)
    entries: Mapping[str, str] = field(default_factory=dict)
    line: int = 0

    @property
    def values(self) -> dict[str, Any]:
        """The parameters that it is given directly, without those of files."""
        return {
            name: value for given in self.given if isinstance(given, Mapping) for name, value in given.items()
        }

    def place_of(self, name: str, keyword: str = "parameters") -> str:
        """Return where a parameter, or the old name of a remapping, is written for this node, as far as that is known."""
        return self.entries.get(name) or self.entries.get(keyword) or self.place

    @property
    def remapped(self) -> tuple[str, ...]:
        """The topics that get other names, without the slash at their beginning."""
        return tuple(old.lstrip("/") for old, _ in self.remappings)


@dataclass(frozen=True)
class LaunchFile:
    """A launch file, with what it starts and what is wrong with the file itself.

    Attributes:
        is_loaded: whether launch itself has loaded it; otherwise it was only read.
        lacks: findings about what is not on this machine, without which launch cannot load it.
        arguments: the names of its launch arguments; None where they are not known.
        refusal: launch's error message, if it refuses the file.
        choices: package, executable and name of all nodes in it, then of those that each choice of arguments starts.
        is_typed: whether it stands for a command, which starts a program as a launch file would.
    """

    shown: str
    nodes: tuple[Launched, ...]
    faults: tuple[Finding, ...] = ()
    is_loaded: bool = False
    lacks: tuple[Finding, ...] = ()
    arguments: tuple[str, ...] | None = None
    refusal: str = ""
    choices: tuple[tuple[tuple[str | None, ...], ...], ...] = ()
    is_typed: bool = False

    @property
    def giver(self) -> str:
        """What sets something, as a sentence begins with it."""
        return "The command" if self.is_typed else "The launch file"


def read_launch_file(path: Path, shown: str, own: Collection[str] = ()) -> LaunchFile:
    """Read a launch file, in Python, XML or YAML; `own` are the packages and the modules of the workspace."""
    return _read_python(path, shown, own) if path.suffix == ".py" else _read_entities(path, shown)


def _read_python(path: Path, shown: str, own: Collection[str]) -> LaunchFile:
    source = read_source(path, "launch_file", shown)
    if source.tree is not None and source.fault:
        return LaunchFile(shown, (), (syntax_finding("launch-syntax", source),))
    functions = [node.name for node in source.nodes if isinstance(node, ast.FunctionDef)]
    faults = []
    if "generate_launch_description" not in {*functions, *bound_in(source.tree)}:
        near = nearest("generate_launch_description", functions)
        place = next((n for n in source.nodes if isinstance(n, ast.FunctionDef) and n.name == near), 1)
        cause = f"{shown} has no function generate_launch_description, which ros2 launch calls."
        fix = "write def generate_launch_description(): and return LaunchDescription([...])"
        fix = f"write generate_launch_description instead of {near}" if near else fix
        faults.append(Finding("launch-function", cause, source.at(place), fix))
    faults += _without_return(source)
    faults += [*used_too_early(source), *declared_late(source)]
    faults += [*kind_faults(source), *plain_value_faults(source), *_of_ros_nodes(source, own)]
    return LaunchFile(shown, tuple(_nodes(source)), tuple(faults))


def _without_return(source: PythonSource) -> Iterator[Finding]:
    """Yield a description that is not returned, or that a comma turns into a tuple."""
    for node in source.tree.body:
        if isinstance(node, ast.FunctionDef) and node.name == "generate_launch_description":
            returned = [n.value for n in own_nodes(node) if isinstance(n, ast.Return) and n.value]
            yield from (tuple_by_comma(source, value) for value in returned if is_by_comma(source, value))
            if returned:
                return
            last = node.body[-1]
            assigned = (statement for statement in node.body if isinstance(statement, ast.Assign))
            made = [n for n in assigned if "LaunchDescription" in ast.unparse(n.value)]
            is_made = isinstance(last, ast.Expr) and "LaunchDescription" in ast.unparse(last)
            fix = "end it by returning the LaunchDescription"
            if is_made:
                fix = "write return in front of LaunchDescription(...)"
            fix = f"write return {ast.unparse(made[-1].targets[0])} as its last line" if made else fix
            cause = "generate_launch_description() makes a description but returns nothing, so launch has nothing to start."
            yield Finding("launch-function", cause, source.at(last), fix)


def _of_ros_nodes(source: PythonSource, own: Collection[str]) -> Iterator[Finding]:
    """Yield imports meant for nodes, wrong arguments, and actions that a comma turns into a tuple."""
    for imported in source.imports:
        module, _, name = imported.target.rpartition(".")
        homes = launch_homes_of(imported.local) if imported.is_from and imported.local[:1].isupper() else []
        # A name that its module does not have at all is one of the wrong imports below.
        is_other = name != imported.local or module.partition(".")[0] == "rclpy"
        if homes and is_other and module not in homes:
            cause = f"{imported.local} here is {imported.target}, but the {imported.local} for launch files is in {homes[0]}."
            fix = f"write `from {homes[0]} import {imported.local}`"
            yield Finding("import-wrong", cause, source.at(imported.line), fix)
    yield from misspelt_packages(source, own)
    yield from wrong_imports(source, {})
    for name, node in undefined_names(source):
        cause, fix = meant(source, name, node)
        yield Finding("name-undefined", cause, source.at(node), fix)
    yield from comma_faults(source)
    yield from path_faults(source)
    worded = {finding.fix.partition("'")[2].partition("'")[0] for finding in kind_faults(source)}
    yield from _arguments(source, worded, own)
    yield from older_keywords(source)
    yield from misplaced_values(source)
    yield from joined_words(source)
    for _, node in calls_of_launch(source, "launch.actions.", "launch_ros.actions."):
        for keyword in node.keywords:
            if _lacks_brackets(source, node, keyword):
                cause = f"{keyword.arg} must be a list, but {ast.unparse(keyword.value)[:60]} is not one: the brackets around it are missing."
                fix = f"write {keyword.arg}={as_list(keyword.value)}"
                yield Finding("launch-argument", cause, source.at(keyword.value), fix)


def _lacks_brackets(source: PythonSource, call: ast.Call, keyword: ast.keyword) -> bool:
    """Return whether a keyword argument of an action should be a list but is something else."""
    if any(given.arg == "shell" for given in call.keywords):
        return False  # a shell takes a single text
    if keyword.arg in _LISTS:  # whose types are aliases
        is_pair = isinstance(keyword.value, ast.Tuple) and keyword.arg == "remappings"
        return is_pair or isinstance(keyword.value, (ast.Dict, ast.Constant, ast.JoinedStr))
    is_text = isinstance(keyword.value, ast.JoinedStr) or isinstance(
        getattr(keyword.value, "value", None), str
    )
    signature = signature_of(source, call) if is_text else None
    parameters = signature.parameters if signature else ()
    places = [parameter for parameter in parameters if parameter.name == keyword.arg]
    # Launch would take a text as a list of its letters.
    return any(heads_of(parameter.type) and heads_of(parameter.type) <= LISTS for parameter in places)


def _arguments(source: PythonSource, worded: Collection[str], own: Collection[str]) -> Iterator[Finding]:
    """Yield arguments declared but not used, or the reverse; none for a file that may use others than it names.

    Of those in `worded` it is known already how they should be used.
    """
    called = (source.resolve(node.func) or "" for node in source.calls)
    if any(name.rpartition(".")[2].startswith(_MAY_READ_ANY) for name in called):
        return
    if not {imported.target.partition(".")[0] for imported in source.imports}.isdisjoint(own):
        return
    declared, used = all_named(source, "DeclareLaunchArgument"), all_named(source, *READING)
    if declared is None or used is None:
        return
    strange, idle = [n for n in used if n not in declared], [n for n in declared if n not in used]
    for name in strange:
        # An argument that is not declared here may come from a launch file that includes this one.
        if near := nearest(name, idle, 0.6):
            cause = f"LaunchConfiguration({name!r}) is used, but the declared argument is called {near}."
            yield Finding("launch-argument", cause, source.at(used[name]), f"write {near!r} here")
    if not strange:
        for name in (name for name in idle if name not in worded):
            cause = f"The launch argument {name} is declared but never used, so it changes nothing."
            value = f"LaunchConfiguration('{name}')"
            fix = f"remove it, or write {value} where its value is needed"
            if not (passed := passed_on(source, name)):
                used_by = put_back(source.text, re.escape(value))
                ways = [back for _, back, whole in used_by if not _gives_twice(whole)]
                fix = f"remove it, or {ways[0]}, which would use it" if ways else fix
            yield Finding("launch-unused", cause, source.at(declared[name]), passed or fix)


def _gives_twice(code: str) -> bool:
    """Return whether a list of dictionaries gives a key twice."""
    for items in (node.elts for node in ast.walk(ast.parse(code)) if isinstance(node, ast.List)):
        keys = [ast.unparse(key) for d in items if isinstance(d, ast.Dict) for key in d.keys if key]
        if len(keys) > len({*keys}):
            return True
    return False


def _nodes(source: PythonSource) -> Iterator[Launched]:
    names: dict[str, Any] = {}
    calls = _calls(source)
    for node in source.nodes:
        if isinstance(node, ast.Assign) and len(node.targets) == 1 and isinstance(node.targets[0], ast.Name):
            name = node.targets[0].id
            names[name] = UNKNOWN if name in names else evaluate(node.value, names, calls)
    idle = {id(call) for action in unlisted(source) for call in action.made}
    for target, node in calls_of_launch(source, "launch_ros.actions."):
        if not target.endswith("Node"):
            continue
        given = {k.arg: evaluate(k.value, names, calls) for k in node.keywords if k.arg}
        line = next((k.value for k in node.keywords if k.arg == "executable"), node)
        remappings = given.get("remappings", [])
        pairs = remappings if isinstance(remappings, list) else []
        two = [pair for pair in pairs if isinstance(pair, list) and len(pair) == 2]
        yield Launched(
            given.get("package", UNKNOWN),
            given.get("executable", UNKNOWN),
            given.get("name"),
            tuple(_files(given.get("parameters"))),
            tuple((old, new) for old, new in two if isinstance(old, str)),
            source.at(line),
            given.get("namespace", ""),
            given.get("output"),
            _words(given.get("arguments")),
            is_wrapped=bool(given.get("prefix")),
            is_listed=id(node) not in idle,
            entries=_entries(source, node),
            line=node.lineno,
        )


def _entries(source: PythonSource, call: ast.Call) -> dict[str, str]:
    """Return the places of the texts in a node's parameters and remappings, and of these lists themselves."""
    found: dict[str, str] = {}
    for keyword in call.keywords:
        if keyword.arg in ("parameters", "remappings"):
            found[keyword.arg] = source.at(keyword.value)
            for inner in ast.walk(source.written(keyword.value) or keyword.value):
                if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                    found.setdefault(inner.value, source.at(inner))
    return found


def _words(arguments: Any) -> tuple[str, ...]:
    """Return a program's command-line arguments; empty if any of them is not known."""
    are_known = isinstance(arguments, list) and all(isinstance(word, str) for word in arguments)
    return tuple(arguments) if are_known else ()


def _files(parameters: Any) -> Iterator[tuple[str, str]]:
    for parameter in parameters if isinstance(parameters, list) else ():
        if isinstance(parameter, str) and parameter.startswith(SHARE):
            package, _, path = parameter.removeprefix(SHARE).partition("/")
            yield package, path


def _calls(source: PythonSource) -> Mapping[str, Any]:
    def share(package: str) -> str:
        return f"{SHARE}{package}"

    def joined(*parts: Any) -> Any:
        flat = [inner for part in parts for inner in (part if isinstance(part, list) else [part])]
        if not all(isinstance(part, str) for part in flat):
            return UNKNOWN
        # An absolute path, such as a share folder, replaces what is before it.
        whole = [number for number, part in enumerate(flat) if part.startswith((SHARE, "/"))]
        return "/".join(flat[max(whole, default=0) :])

    known = {
        "ament_index_python.packages.get_package_share_directory": share,
        "ament_index_python.get_package_share_directory": share,
        "launch_ros.substitutions.FindPackageShare": share,
        "launch.substitutions.PathJoinSubstitution": joined,
        "os.path.join": joined,
        "str": str,
    }
    spelt = {}
    for node in source.nodes:
        name = dotted(node) if isinstance(node, (ast.Name, ast.Attribute)) else None
        if name and (target := source.resolve(node) or name) in known:
            spelt[name] = known[target]
    return spelt


def entities_in(path: Path) -> Any:
    """Return the entities of a launch file in XML or YAML, with texts as attributes."""
    import yaml

    from portable_ros2 import bounded_yaml

    text = read_text(path)
    return _xml(text) if path.suffix in (".xml", ".launch") else bounded_yaml.load(text, yaml.BaseLoader)


def _read_entities(path: Path, shown: str) -> LaunchFile:
    import yaml

    from portable_ros2 import bounded_yaml

    text, line, is_xml = read_text(path), None, path.suffix in (".xml", ".launch")
    try:
        content = entities_in(path)
        if isinstance(content, Mapping) and "launch" in content:
            rows = entities_below("", content, set())
            return LaunchFile(
                shown, tuple(_launched(node, shown, text) for tag, node in rows if tag == "node")
            )
        problem = "its root element is not launch"
    except bounded_yaml.TooLargeError as error:
        mark = error.problem_mark
        return LaunchFile(shown, (), (not_read(shown, mark.line + 1 if mark else None, error.problem or ""),))
    except ET.ParseError as error:
        problem, line = str(error), error.position[0]
    except (yaml.YAMLError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        problem = getattr(error, "problem", None) or "it cannot be read"
        line = mark.line + 1 if mark else None
    slip = conflict_in(text) or entity_repair(text, is_xml=is_xml)
    cause = f"{shown} is not a valid launch file: {(slip.why if slip else '') or problem}."
    fix = "make launch the root element, with the nodes inside it"
    fix = slip.told if slip else "fix this line or the one above" if line else fix
    fault = Finding("launch-syntax", cause, at(shown, slip.line if slip else line), fix)
    return LaunchFile(shown, (), (fault,))


def _xml(text: str) -> dict[str, Any]:
    root = ET.fromstring(text)  # noqa: S314 -- a file of the workspace; entities are not fetched
    return {root.tag: _entity(root)}


def _entity(element: ET.Element) -> dict[str, Any]:
    found: dict[str, Any] = dict(element.attrib)
    for child in element:
        found[child.tag] = [*_several(found.get(child.tag)), _entity(child)]
    return found


def _several(value: Any) -> list[Mapping[str, Any]]:
    """Return the entities of a tag as a list, whether there are none, one or more."""
    return [
        entity for entity in (value if isinstance(value, list) else [value]) if isinstance(entity, Mapping)
    ]


def entities_below(tag: str, content: Any, seen: set[int]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the entities in some content, each with its tag; a YAML alias may even refer to an entity that contains it."""
    if isinstance(content, Mapping):
        yield tag, content
    if id(content) not in seen:
        seen.add(id(content))
        inner = content.items() if isinstance(content, Mapping) else ()
        for below, child in [
            *inner,
            *((tag, item) for item in (content if isinstance(content, list) else ())),
        ]:
            yield from entities_below(below, child, seen)


def _launched(node: Mapping[str, Any], shown: str, text: str) -> Launched:
    executable = _text(node.get("exec"))
    line = re.search(rf"exec\s*[:=]\s*[\"']?{re.escape(str(node.get('exec')))}(?![\w.])", text)
    renamed = [(_text(remap.get("from")), _text(remap.get("to"))) for remap in _several(node.get("remap"))]
    return Launched(
        _text(node.get("pkg")),
        executable,
        _text(node["name"]) if "name" in node else None,
        tuple(_files([_text(param.get("from")) for param in _several(node.get("param"))])),
        tuple((old, new) for old, new in renamed if isinstance(old, str)),
        at(shown, text.count("\n", 0, line.start()) + 1 if line else None),
        _text(node.get("namespace", "")),
        node.get("output"),
        is_wrapped=bool(node.get("launch-prefix")),
    )


def _text(value: Any) -> Any:
    """Return the text of an attribute; UNKNOWN if it holds a substitution that only launch can evaluate."""
    if not isinstance(value, str):
        return UNKNOWN
    known = re.sub(r"^\$\(find-pkg-share ['\"]?([\w.-]+)['\"]?\)", rf"{SHARE}\1", value.strip())
    return UNKNOWN if "$(" in known else known
