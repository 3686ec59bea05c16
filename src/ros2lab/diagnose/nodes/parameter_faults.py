"""Faults in parameters: how sources declare them, and how YAML files set them."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ros2lab.diagnose.code.merge_conflicts import conflict_in
from ros2lab.diagnose.finding import Finding, at, lines_in_words, not_read
from ros2lab.diagnose.nodes.parameter_values import of_its_type, value_fix
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.parameter_file import (
    BELOW,
    ParameterFileError,
    UnreadParameterFileError,
    Written,
    is_for,
    is_other_yaml,
    kind_of,
    line_of,
    parameter_file_repair,
    read_parameter_file,
    written_values,
)
from ros2lab.diagnose.sources.python_source import (
    PythonSource,
    argument,
    last_name,
    read_text,
)
from ros2lab.diagnose.sources.spelling import is_near_miss, same_letters, write_instead
from ros2lab.diagnose.sources.static_value import UNKNOWN


def of_parameter_file(text: str, look: Any) -> Finding | None:
    """Return the finding for what rcl says about a parameter file; None if it names none."""
    match = re.search(
        r"params file: '(?:--params-file )?(?P<file>[^']+)'.*?[Ee]rror: (?P<said>.+?)(?: at line (?P<line>\d+))?, at ",
        text,
    )
    if match is None:
        return None
    name, said = match["file"].rpartition("/")[2], match["said"]
    files = [(p, f) for p in (look.packages if look else ()) for f in p.parameter_files if f.name == name]
    shown = files[0][0].shown(str(files[0][1].relative_to(files[0][0].folder))) if files else match["file"]
    place = at(shown, int(match["line"]) if match["line"] else None)
    if "opening" in said:
        cause = f"There is no parameter file {match['file']} in the folder where the command was typed."
        fix = f"give it as {shown}, from the workspace folder" if files else "give the full path of the file"
        return Finding("file-not-found", cause, "", fix)
    try:
        for _, path in files[:1]:
            read_parameter_file(read_text(path))
    except UnreadParameterFileError:
        pass  # ROS's own message is shown below
    except ParameterFileError as error:
        return unread_file(shown, read_text(files[0][1]), error)
    fix = "indent with spaces, write a space after each colon, and put the node's name and then ros__parameters: above the values"
    return Finding("parameter-file-syntax", f"{shown} cannot be read as parameters: {said}.", place, fix)


def unread_file(shown: str, text: str, error: ParameterFileError) -> Finding:
    """Return why a file cannot be read as parameters, or not even as YAML."""
    if isinstance(error, UnreadParameterFileError):
        return not_read(shown, error.line, str(error))
    slip = conflict_in(text) or parameter_file_repair(text)
    why = (slip.why if slip else "") or str(error)
    place, fix = (at(shown, slip.line), slip.told) if slip else (at(shown, error.line), error.fix)
    said = "cannot be read as parameters" if BELOW in text else "is not valid YAML"
    return Finding("parameter-file-syntax", f"{shown} {said}: {why}.", place, fix)


def declared_in(
    sources: NodeSources, files: Iterable[str] | None = None, but: Collection[int] = ()
) -> dict[str, Any] | None:
    """Return the parameters that all or some files declare, but for some calls, with defaults (or `UNKNOWN`); None if a name is not known."""
    found: dict[str, Any] = {}
    for source in sources.sources.values() if files is None else map(sources.sources.__getitem__, files):
        for node in source.nodes:
            if not isinstance(node, ast.Call) or id(node) in but:
                continue
            declared = _declared_by(sources, source, node)
            if declared is None:
                return None
            for name, default in declared.items():
                # Two nodes may declare the same name with different types.
                is_other = name in found and kind_of(found[name]) != kind_of(default)
                found[name] = UNKNOWN if is_other else default
    return found


# A list of each type that a parameter may be declared with instead of a default.
_LISTS: Mapping[str, Any] = {
    "BOOL_ARRAY": [False],
    "DOUBLE_ARRAY": [0.0],
    "INTEGER_ARRAY": [0],
    "STRING_ARRAY": [""],
}


def _declared_by(sources: NodeSources, source: PythonSource, call: ast.Call) -> dict[str, Any] | None:
    """Return the parameters that a call declares, with their defaults; None if a name is not known."""
    match getattr(call.func, "attr", ""):
        case "declare_parameter":
            name = sources.value(source, argument(call, 0, "name"))
            is_dynamic = "dynamic_typing" in ast.dump(call)
            written = argument(call, 1, "value")
            default = (
                UNKNOWN if is_dynamic else _LISTS.get(last_name(written), sources.value(source, written))
            )
            return {name: default} if isinstance(name, str) else None
        case "declare_parameters":
            space = argument(call, 0, "namespace")
            before = sources.value(source, space) if space else ""
            rows = sources.value(source, argument(call, 1, "parameters"))
            if not isinstance(rows, list) or not isinstance(before, str):
                return None
            if not all(isinstance(row, list) and row and isinstance(row[0], str) for row in rows):
                return None
            defaults = {row[0]: row[1] if len(row) > 1 else UNKNOWN for row in rows}
            return {f"{before}.{name}" if before else name: default for name, default in defaults.items()}
    return {}


def file_faults(
    package: SourcePackage,
    sources: NodeSources,
    launched: Collection[str],
    moved: Collection[str],
    others: Collection[str],
    *,
    given: Collection[tuple[str, str]],
) -> Iterator[Finding]:
    """Yield faults in a package's parameter files; none in what only its programs read, as any YAML.

    Args:
        package: the package.
        sources: its Python files.
        launched: names that launch files give its nodes; "" for one that is not known.
        moved: names in its code that launch files replace or put into a namespace.
        others: names that launch files give nodes of other packages.
        given: the files that launch files give nodes, as (package, path below its folder).
    """
    names = {*sources.node_names, *launched}
    full = {name: whole for name, whole in sources.full_names.items() if name not in {*launched, *moved}}
    declared = declared_in(sources)
    for path in package.parameter_files:
        inner = path.relative_to(package.folder).as_posix()
        shown = package.shown(inner)
        text = read_text(path)
        readers = [*_readers(path.name, sources.beyond.modules.values())]
        if readers and (package.name, inner) not in given:
            continue
        try:
            content = read_parameter_file(text)
        except ParameterFileError as error:
            yield from (
                _unread(shown, text, error, readers) if BELOW in text or not is_other_yaml(text) else ()
            )
            continue
        lines_of = _Lines(shown, text)
        if isinstance(content, Mapping) and BELOW in text:
            offered = {*names} - {*moved} | {*launched}
            own = {key: values for key, values in sections_of(content) if not is_node(key, others)}
            yield from _other_nodes(own, sources, names, offered, lines_of) if "" not in names else ()
            taken = [row for row in written_values(text) if is_node(row.section, names) or "" in names]
            for value in (row for row in taken if not is_node(row.section, others)):
                beside = {row.name for row in taken if row.section == value.section}
                yield from _value_faults(value, beside, declared or {}, at(shown, value.line))
            yield from _octals(taken, sources, declared or {}, shown)
            yield from _apart(content, full, lines_of)
            yield from replaced_values(shown, text)
        elif isinstance(content, Mapping):
            yield from _without_below(content, names, shown, lines_of)


def _unread(
    shown: str, text: str, error: ParameterFileError, readers: Sequence[PythonSource]
) -> Iterator[Finding]:
    """Yield why a file cannot be read as parameters, with a program that reads it, too."""
    fault = unread_file(shown, text, error)
    also = "".join(f"; {reader.shown} reads the file, too, as it is now" for reader in readers[:1])
    yield replace(fault, fix=fault.fix + also)


def _without_below(
    content: Mapping[Any, Any], names: Collection[str], shown: str, lines_of: _Lines
) -> Iterator[Finding]:
    """Yield that the line above the parameters of a file is misspelt or missing."""
    if near := _nearly_below(content):
        cause = (
            f"In {shown} the line above the parameters is {near}:, but ROS reads only what is below {BELOW}:."
        )
        fix = f"write {BELOW}: (two underscores) instead of {near}:"
        yield Finding("parameter-file-node", cause, lines_of.at(near), fix)
    elif any(is_node(str(key), names) for key in content):
        cause = (
            f"In {shown} the line `ros__parameters:` is missing between the node's name and its parameters."
        )
        fix = "write ros__parameters: (two underscores) below the node's name, and indent the parameters below it"
        yield Finding("parameter-file-node", cause, at(shown, 1), fix)


def _readers(name: str, files: Iterable[PythonSource]) -> Iterator[PythonSource]:
    """Yield the programs that name a YAML file and read YAML themselves."""
    for file in files:
        texts = (node.value for node in file.nodes if isinstance(node, ast.Constant))
        is_named = any(isinstance(text, str) and text.endswith(name) for text in texts)
        if is_named and any(i.target.partition(".")[0] in ("yaml", "ruamel") for i in file.imports):
            yield file


def _nearly_below(content: Mapping[Any, Any]) -> str:
    """Return a key at any depth that is nearly `ros__parameters`; empty if there is none."""
    for key, value in content.items():
        if is_near_miss(str(key), BELOW):
            return str(key)
        if isinstance(value, Mapping) and (inner := _nearly_below(value)):
            return inner
    return ""


class _Lines:
    def __init__(self, shown: str, text: str) -> None:
        self.shown, self.text = shown, text

    def at(self, key: str) -> str:
        return at(self.shown, line_of(key, self.text))


def _apart(content: Mapping[Any, Any], full: Mapping[str, str], lines: _Lines) -> Iterator[Finding]:
    """Yield sections that have a node's name, but not the namespace that the code gives it."""
    keys = [key for key, _ in sections_of(content)]
    for key in keys:
        runs_as = full.get(key.rstrip("/").rpartition("/")[2], "")
        if runs_as.count("/") > 1 and not any(is_for(section, runs_as) for section in keys):
            yield other_name(key, runs_as, lines.shown, lines.at(key))


def other_name(key: str, runs_as: str, shown: str, place: str) -> Finding:
    """Say that a section of a parameter file has a different name from the node it is meant for."""
    cause = f"{shown} sets parameters for {key}, but the node runs as {runs_as}, so it silently keeps its defaults."
    return Finding(
        "parameter-file-node", cause, place, f"write {runs_as}: instead of {key}:, or /**: for every node"
    )


def _other_nodes(
    sections: Mapping[str, Mapping[Any, Any]],
    sources: NodeSources,
    names: Collection[str],
    offered: Collection[str],
    lines: _Lines,
) -> Iterator[Finding]:
    """Yield sections for nodes that the package does not have, and that are plainly meant for one that it has.

    A file may also be for somebody else's node, be read by the code itself, or name a node as whoever starts it will.
    """
    told = {key.rpartition("/")[2] for key in sections}
    for key in (key for key in sections if not is_node(key, names)):
        short = key.rpartition("/")[2]
        is_one_of_many = re.sub(r"_?\d+$", "", short) in names
        if is_one_of_many or any(is_near_miss(short, name) for name in told & {*names}):
            continue  # that node has its section
        takers = _takers(sources, sections[key])
        meant = [n for n in takers if is_near_miss(short, n)] or takers
        alike = [name for name in meant if {*name.split("_")} & {*short.split("_")}]
        meant = alike if len(alike) == 1 else meant
        does = f"declare{'s' * (len(meant) == 1)} them"
        if not meant:
            meant, does = [name for name in sorted(offered) if is_near_miss(short, name)][:1], "is meant"
        if meant and told.isdisjoint(meant) and {*meant} <= {*offered}:
            nodes = " and ".join(meant)
            cause = f"{lines.shown} sets parameters for a node called {short}, but there is none here: {nodes} {does}, so the defaults are kept silently."
            fix = f"write {' or '.join(meant)} instead of {short}"
            yield Finding("parameter-file-node", cause, lines.at(key), fix)


def _takers(sources: NodeSources, section: Mapping[Any, Any]) -> list[str]:
    """Return the nodes whose files declare every parameter of a section."""
    homes = {name: source for name, (source, _) in sources.node_names.items() if name and section}
    declared = {name: declared_in(sources, sources.together(home.name)) for name, home in homes.items()}
    return [name for name, found in sorted(declared.items()) if (found or {}).keys() >= section.keys()]


def _value_faults(
    value: Written, beside: Collection[str], declared: Mapping[str, Any], place: str
) -> Iterator[Finding]:
    """Yield why a node does not take a value: it has another type, or a name that is nearly one of the node's."""
    name = value.name
    wanted, given = kind_of(declared.get(name, UNKNOWN)), kind_of(value.value)
    if wanted and given and wanted != given:
        cause = f"The parameter {name} is declared as {wanted}, but the file gives it {value.short}, of type {given}, so the node does not start."
        yield Finding("parameter-type", cause, place, value_fix(name, value.short, given, wanted))
    near = next((known for known in declared if is_misspelt(name, known)), None)
    if near and name not in declared:
        cause = f"The file sets the parameter {name}, but the node declares {near}{', which keeps its default' * (near not in beside)}."
        typed = of_its_type(value.value, declared[near]) * (near not in beside)
        yield Finding("parameter-name", cause, place, renamed(name, near, beside) + typed)


_OCTAL = re.compile(r"\b0o[0-7]|\b(?:chmod|umask)\(")  # code that may want an octal number


def _octals(
    values: Iterable[Written], sources: NodeSources, declared: Collection[str], shown: str
) -> Iterator[Finding]:
    """Yield numbers with a leading zero, which are not the ones that they seem to be; none if the code may want them."""
    if any(_OCTAL.search(source.text) for source in sources.sources.values()):
        return
    for value in (value for value in values if value.octal and value.name in declared):
        first = value.octal[0]
        cause = f"ROS reads {first} as {int(first, 8)}: a number that begins with 0 is octal."
        right = re.sub(r"(?<![\w.+-])([-+]?)0+(?=[1-9]\d*(?![\w.]))", r"\1", value.short)
        fix = f"write {value.name}: {right}, without the leading zero"
        yield Finding("parameter-octal", cause, at(shown, value.line), fix)


def is_misspelt(name: str, known: str) -> bool:
    """Return whether a parameter's name is meant as a declared one: each part of it is, or only the parts are joined otherwise."""
    parts, others = name.split("."), known.split(".")
    pairs = zip(parts, others, strict=False)
    are_alike = len(parts) == len(others) and all(one == o or is_near_miss(one, o) for one, o in pairs)
    return name != known and (are_alike or same_letters(name, known))


def renamed(name: str, known: str, beside: Collection[str]) -> str:
    """Return how what gives a parameter and the node that declares it come to use one name for it."""
    if same_letters(name, known) and name.count(".") > known.count(".") and known not in beside:
        return f"write {name!r} instead of {known!r} where the node declares and reads it: ROS joins a key and those below it with dots"
    return write_instead(known, name, beside)


def sections_of(content: Mapping[Any, Any], above: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the sections of a parameter file: each node's name as the file has it, and its parameters by their full names."""
    for key, value in content.items():
        name = f"{above}/{key}" if above else str(key)
        if isinstance(value, Mapping):
            given = value.get("ros__parameters")
            if isinstance(given, Mapping):
                yield name, dict(flat(given))
            else:
                yield from sections_of(value, name)


def flat(values: Mapping[Any, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yield parameters by their full names, such as `wheel.radius`."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def is_node(key: str, names: Collection[str]) -> bool:
    """Return whether a key of a parameter file, such as `/**/talker`, means one of the nodes."""
    last = key.rstrip("/").rpartition("/")[2]
    return "*" in last or last in names


def replaced_values(shown: str, text: str) -> Iterator[Finding]:
    """Yield the values of a parameter file that never count: a later line sets another one for all nodes that they are for."""
    written = written_values(text)
    for index, lost in enumerate(written):
        later = [new for new in written[index + 1 :] if new.name == lost.name and _covers(new, lost)]
        if not later or repr(later[-1].value) == repr(lost.value):  # 1 is not 1.0
            continue
        last = later[-1]
        cause = f"{shown} sets {lost.name} to {lost.short} on line {lost.line}, but line {last.line} sets it to {last.short} for the same node, and the last value counts."
        first, second = lines_in_words(*lost.lines), lines_in_words(*last.lines)
        if first == second:  # in braces
            first, second = (f"`{value.name.rpartition('.')[2]}: {value.text}`" for value in (lost, last))
        fix = f"remove {second} if {lost.short} is meant, or {first} if {last.short} is"
        yield Finding("parameter-replaced", cause, at(shown, last.line), fix)


def _covers(new: Written, lost: Written) -> bool:
    """Return whether a value is for all nodes that another value is for."""
    return new.section == lost.section or ("*" not in lost.section and is_for(new.section, lost.section))
