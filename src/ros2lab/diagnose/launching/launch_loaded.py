"""Load launch files with the real launch: what they would start, and why launch refuses them."""

from __future__ import annotations

import ast
import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import SAID, Finding, at, line_with
from ros2lab.diagnose.launching import launch_child
from ros2lab.diagnose.launching.entity_shapes import shapes
from ros2lab.diagnose.launching.in_vain import fixed, never_begun, set_late, shared, unknown_arguments
from ros2lab.diagnose.launching.launch_file import SHARE, Launched, LaunchFile
from ros2lab.diagnose.launching.lost_arguments import lost_argument
from ros2lab.diagnose.launching.own_modules import own_module
from ros2lab.diagnose.launching.unlisted import unlisted
from ros2lab.diagnose.nodes.parameter_faults import unread_file
from ros2lab.diagnose.sources.class_trees import launch_classes_below
from ros2lab.diagnose.sources.interfaces import PACKAGES, install_of, package_of
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.parameter_file import ParameterFileError, is_other_yaml, read_parameter_file
from ros2lab.diagnose.sources.python_source import PythonSource, read_source, read_text
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest, with_article, write_instead
from ros2lab.scratch import scratch_folder


def load(files: Mapping[Path, LaunchFile], packages: Sequence[SourcePackage]) -> list[LaunchFile]:
    """Return launch files with what launch itself says they would start; those that it cannot load are unchanged.

    The folders of the packages, with what setup.py installs elsewhere, stand for their share folders.
    """
    told = _ask([*files], packages)
    return [_as_told(path, files, told.get(str(path)), packages) for path in files]


def load_copies(path: Path, texts: Sequence[bytes], packages: Sequence[SourcePackage]) -> list[int | None]:
    """Return how many nodes each copy of a launch file would start; None where launch refuses it.

    It is 0 where something outside the file is missing, such as a value for an argument without a default.
    """
    with scratch_folder() as folder:
        copies = [folder / str(number) / path.name for number in range(len(texts))]
        for copy, text in zip(copies, texts, strict=True):
            copy.parent.mkdir()
            for beside in (entry for entry in path.parent.iterdir() if entry != path):
                (copy.parent / beside.name).symlink_to(beside)
            copy.write_bytes(text)
        told = _run(copies, packages) if copies else {}
    rows = (told.get(str(copy)) or {"error": None, "faults": [], "nodes": []} for copy in copies)
    return [None if row.get("error") or row.get("faults") else len(row.get("nodes", ())) for row in rows]


# Launch's answers by the texts of the files, with `_ROOT` for the workspace: a kernel asks repeatedly.
_told: dict[Hashable, str] = {}
_ROOT = "{workspace}"
_MOST_TOLD = 64


def _ask(paths: Sequence[Path], packages: Sequence[SourcePackage]) -> dict[str, Any]:
    if not paths:
        return {}
    root = str(packages[0].root or packages[0].folder)
    read = [*paths, *(path for package in packages for path in package.parameter_files)]
    key = (
        tuple((str(path).removeprefix(root), read_text(path)) for path in read),
        tuple((p.name, str(p.folder).removeprefix(root), p.setup and p.setup.source.text) for p in packages),
    )
    if key not in _told:
        if len(_told) >= _MOST_TOLD:
            _told.clear()
        _told[key] = json.dumps(_run(paths, packages)).replace(root, _ROOT)
    found: dict[str, Any] = json.loads(_told[key].replace(_ROOT, root))
    return found


def _run(paths: Sequence[Path], packages: Sequence[SourcePackage]) -> dict[str, Any]:
    """Return what a separate process that loads launch files prints, by file, as far as it comes."""
    with scratch_folder() as folder:
        prefix = folder / "prefix"
        markers = prefix / "share/ament_index/resource_index/packages"
        markers.mkdir(parents=True)
        for package in packages:
            if "/" not in package.name and not (markers / package.name).exists():
                (markers / package.name).touch()
                package.link_into(prefix)
        known = [str(prefix), *filter(None, [os.environ.get("AMENT_PREFIX_PATH")])]
        environ = {
            "AMENT_PREFIX_PATH": os.pathsep.join(known),
            "ROS_LOG_DIR": str(folder),
            "TMPDIR": str(folder),
        }
        with tempfile.TemporaryFile() as told:
            with contextlib.suppress(OSError, ValueError, subprocess.SubprocessError):
                subprocess.run(
                    [sys.executable, "-m", launch_child.__name__, *map(str, paths)],
                    cwd=folder,  # where no file of the student's can shadow what launch imports
                    env={**os.environ, **environ},
                    stdin=subprocess.DEVNULL,
                    stdout=told,
                    stderr=subprocess.DEVNULL,
                    timeout=launch_child.LONGEST,
                    check=True,
                )
            told.seek(0)
            said = _as_installed(told.read().decode(errors="replace"), prefix, packages)
    found: dict[str, Any] = {}
    for line in said.splitlines():
        with contextlib.suppress(ValueError, TypeError, RecursionError):  # a launch file may print anything
            found |= json.loads(line)
    return found


def _as_installed(said: str, prefix: Path, packages: Sequence[SourcePackage]) -> str:
    """Return what is said with the paths that files have once the packages are installed."""
    install = _install_of(packages)
    names = "|".join(re.escape(package.name) for package in packages)
    said = re.sub(rf"{re.escape(str(prefix))}(?=/share/({names})\b)", rf"{install}/\1", said)
    # Where launch was started stands for the folder in which a student starts it.
    return said.replace(str(prefix), str(install)).replace(str(prefix.parent), str(install.parent))


def _install_of(packages: Sequence[SourcePackage]) -> Path:
    return (packages[0].root or packages[0].folder.parent) / "install" if packages else Path("install")


def _as_told(
    path: Path, files: Mapping[Path, LaunchFile], told: Any, packages: Sequence[SourcePackage]
) -> LaunchFile:
    """Return a file with what launch told of it; unchanged where that is nothing or malformed."""
    with contextlib.suppress(AttributeError, LookupError, TypeError, ValueError):
        return _joined(path, files, told, packages) if told else files[path]
    return files[path]


def _joined(
    path: Path, files: Mapping[Path, LaunchFile], told: Mapping[str, Any], packages: Sequence[SourcePackage]
) -> LaunchFile:
    file = files[path]
    if "lacks" in told:
        return replace(file, lacks=tuple(_lacking(path, file, told, packages)))
    source = read_source(path, path.stem, file.shown)
    paths = [other for package in packages for other in package.launch_files]
    if told["error"] or told["faults"]:
        if file.faults:
            return file  # its text says why
        refusal = (told["error"] or {}).get("message", "")
        lost = lost_argument(refusal, path, source, paths)
        faults = tuple(_refusals(path, file, told, packages) if lost is None else lost)
        return replace(file, faults=faults, refusal=refusal)
    real = {other.resolve(): known for other, known in files.items()}
    nodes = tuple(_launched(node, real.get(Path(node["file"]), file), packages) for node in told["nodes"])
    given = [wanted for node in told["nodes"] for wanted in node["given"] if isinstance(wanted, str)]
    faults = (
        *_never_added(source, told["lost"]),
        *_torn(source, given, packages),
        *_from_here(source, given, packages),
        *set_late(path, file.shown, told["late"], paths),
        *shared(path, file.shown, told["shared"]),
        *unknown_arguments(path, file.shown, told["unknown"]),
        *(() if path.suffix == ".py" or file.faults else fixed(path, file.shown)),
    )
    faults += (*never_begun(file.shown, told["waited_for"], [fault.place for fault in faults]),)
    for lacking in told["later"]:
        faults += (*_lacking(path, file, lacking, packages, is_later=True),)
    # Where the text has faults, these others may come of them.
    loaded = LaunchFile(
        file.shown, nodes, file.faults or faults, is_loaded=True, arguments=tuple(told["arguments"])
    )
    return replace(loaded, choices=tuple(tuple(map(tuple, choice)) for choice in told["choices"]))


def _launched(node: Mapping[str, Any], file: LaunchFile, packages: Sequence[SourcePackage]) -> Launched:
    started = [node["executable"], re.sub(r"^/.*/share/", SHARE, str(node["executable"]))]
    alike = (known for known in file.nodes if known.package == node["package"])
    read = [known for known in alike if known.executable in started]
    read = [known for known in read if known.line == node["line"]] or read
    install = _install_of(packages)
    files = [
        (package.name, str(path.relative_to(home)))
        for path in (Path(entry) for entry in node["given"] if isinstance(entry, str))
        for package in packages
        for home in (package.folder.resolve(), install / package.name / "share" / package.name)
        if path.is_relative_to(home)
    ]
    return Launched(
        node["package"],
        node["executable"],
        node["name"],
        tuple(files),
        tuple((old, new) for old, new in node["remappings"]),
        read[0].place if len(read) == 1 else at(file.shown, node["line"]),
        node["namespace"],
        node["output"],
        tuple(node["arguments"]),
        tuple(node["given"]),
        node["is_wrapped"],
        by_argument={(number, name): argument for number, name, argument in node["by_argument"]},
        entries=read[0].entries if len(read) == 1 else {},
    )


def _texts(source: PythonSource) -> list[tuple[ast.Constant, str]]:
    """Return the texts in a launch file, each with its node."""
    constants = (node for node in source.nodes if isinstance(node, ast.Constant))
    return [(node, node.value) for node in constants if isinstance(node.value, str) and node.value]


def _torn(source: PythonSource, files: Sequence[str], packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield paths of parameter files that would exist with a slash between two of their parts."""
    for given in files:
        for package in packages:
            for lies in package.parameter_files:
                rest = lies.relative_to(package.folder).as_posix()
                is_meant = given.replace("/", "").endswith(f"share/{package.name}/{rest}".replace("/", ""))
                for node, text in _texts(source) if is_meant else ():
                    if given.endswith(text) and not given.endswith(f"/{text}") and text[0] != "/":
                        cause = f"A / is missing in the parameter file's path {package.name}{text}, so it is not found and the nodes keep their defaults."
                        fix = f"write {'/' + text!r} instead of {text!r}"
                        yield Finding("parameter-file-missing", cause, source.at(node), fix)


def _from_here(
    source: PythonSource, files: Sequence[str], packages: Sequence[SourcePackage]
) -> Iterator[Finding]:
    """Yield paths of parameter files that are looked for where launch is started, but are in a package."""
    given = {wanted for wanted in files if not Path(wanted).is_file()}
    for node, text in _texts(source):
        is_given = text[0] != "/" and any(wanted.endswith(f"/{text}") for wanted in given)
        home = next((package for package in packages if is_given and (package.folder / text).is_file()), None)
        if home:
            cause = f"The parameter file {text} is looked for in the folder where `ros2 launch` is typed, but it is in the package {home.name}, so the nodes keep their defaults."
            parts = "".join(f", {part!r}" for part in text.split("/"))
            fix = f"write PathJoinSubstitution([FindPackageShare({home.name!r}){parts}]) instead of {text!r}{home.to_install(text)}"
            yield Finding("parameter-file-missing", cause, source.at(node), fix, (home.name, Path(text).name))


def _never_added(source: PythonSource, lines: Sequence[int]) -> Iterator[Finding]:
    """Yield actions that a launch file makes but does not add to its description: nodes only if launch has not them.

    An argument that is declared in vain is told where something needs it.
    """
    for action in unlisted(source):
        what = f"The node {action.name}".rstrip()
        effect = "launch does not start it"
        if action.kind != "Node":
            what, effect = (
                f"{action.name or 'This'}, a {action.kind},".replace(" a I", " an I").replace(
                    " a E", " an E"
                ),
                "launch never does it",
            )
        if action.kind == "DeclareLaunchArgument" or action.is_left_out:
            continue
        if action.kind != "Node" or {call.lineno for call in action.made} & {*lines}:
            cause = f"{what} is made here but is not in the launch description, so {effect}."
            yield Finding("launch-lost", cause, source.at(action.statement), action.listing)


def _refusals(
    path: Path, file: LaunchFile, told: Mapping[str, Any], packages: Sequence[SourcePackage]
) -> Iterator[Finding]:
    """Yield why launch does not load a file: missing and unknown attributes, or else its own message."""
    tags = list(dict.fromkeys(fault["tag"] for fault in told["faults"]))
    for tag in tags:
        yield _refused(path, file, tag, [fault for fault in told["faults"] if fault["tag"] == tag])
    if told["error"] and not tags:
        read = [*_unread(packages)] if told["error"].get("is_yaml") else []
        yield from read or [_reshaped(path, file, told["error"], packages) or _refusal(file, told["error"])]


def _reshaped(
    path: Path, file: LaunchFile, error: Mapping[str, Any], packages: Sequence[SourcePackage]
) -> Finding | None:
    """Return how to write a value in YAML whose shape launch refuses, so that launch loads the file; else None."""
    ways = [*shapes(error["message"], read_text(path))] if path.suffix in (".yaml", ".yml") else []
    counts = load_copies(path, [way.text.encode() for way in ways], packages)
    good = next((way for way, count in zip(ways, counts, strict=True) if count is not None), None)
    said = replace(_refusal(file, error), place=at(file.shown, ways[0].line)) if ways else None
    return replace(said, fix=good.told) if said and good else said


def _refused(path: Path, file: LaunchFile, tag: str, faults: Sequence[Mapping[str, Any]]) -> Finding:
    """Return which attributes of an element are missing and unknown."""
    missing = list(dict.fromkeys(fault["missing"] for fault in faults if "missing" in fault))
    strange = sorted({name for fault in faults for name in fault.get("unexpected", ())})
    known = {name for fault in faults for name in fault.get("known", ())} - {*strange}
    unknown = f"has no attribute called {' or '.join(strange)}"
    cause = f"<{tag}> {unknown}." if strange else f"<{tag}> lacks its attribute {' and '.join(missing)}."
    if missing and strange:
        cause = f"<{tag}> needs {' and '.join(missing)}, and {unknown}."
    given: dict[str, list[str]] = {}
    for fault in faults:
        for name in fault.get("unexpected", ()):
            given.setdefault(name, []).extend(fault["given"])
    text = read_text(path)
    pushed = [name for name in strange if tag in _WITHOUT_NAMESPACE and name in ("ns", "namespace")]
    fixes = [_pushed(tag, name, text) for name in pushed]
    others = [name for name in strange if name not in pushed]
    fix = ", and ".join([*fixes, *_attribute_fixes(others, missing, known, given)])
    return Finding("launch-argument", cause, at(file.shown, line_with(text, *(strange or [tag]))), fix)


# How an element is put into a namespace that takes no namespace itself.
_WITHOUT_NAMESPACE = {
    "group": "write `{}` as its first element instead of {}",
    "include": "put it into a <group> whose first element is `{}`, without {}",
}


def _pushed(tag: str, name: str, text: str) -> str:
    """Say how an element is put into the namespace that its attribute gives it."""
    values = set(re.findall(rf"<{tag}\b[^>]*\s{name}=[\"']([^\"']*)", text))
    value = values.pop() if len(values) == 1 else "..."
    return _WITHOUT_NAMESPACE[tag].format(f'<push-ros-namespace namespace="{value}"/>', name)


def _attribute_fixes(
    strange: Sequence[str], missing: Sequence[str], known: Collection[str], given: Mapping[str, Sequence[str]]
) -> Iterator[str]:
    """Yield what to do with the attributes that an element does not have, and with those that it lacks."""
    lacking = [*missing]
    for name in strange:
        meant = _attribute_meant(name, lacking) or _attribute_meant(name, known)
        if meant is None and len(strange) == len(lacking) == 1:
            meant = lacking[0]
        if meant in lacking:
            lacking.remove(meant)
        yield write_instead(meant, name, given[name]) if meant else f"remove {name}"
    if lacking:
        yield f"write {' and '.join(lacking)} here"


def _attribute_meant(name: str, known: Collection[str]) -> str | None:
    """Return the attribute that a name misspells, writes out or shortens: `exec` for `executable`, `namespace` for `ns`."""
    alike = [o for o in known if o[0] == name[0] and (_is_within(o, name) or _is_within(name, o))]
    return nearest(name, known, 0.75) or max(alike, key=len, default=None) or nearest(name, known, 0.6)


def _is_within(short: str, long: str) -> bool:
    """Return whether a word has all letters of a shorter one, in their order."""
    left = iter(long)
    return all(letter in left for letter in short)


def _unread(packages: Sequence[SourcePackage]) -> Iterator[Finding]:
    """Yield the YAML files that a launch file, which reads one itself, cannot read."""
    for package, path in ((home, path) for home in packages for path in home.yaml_files):
        text = read_text(path)
        try:
            read_parameter_file(text)
        except ParameterFileError as error:
            if not is_other_yaml(text):
                yield unread_file(package.shown(path.relative_to(package.folder).as_posix()), text, error)


def _refusal(file: LaunchFile, error: Mapping[str, Any]) -> Finding:
    """Return launch's own reason not to load a file, with the refused argument named as in the file."""
    said, refused, fix = error["message"], error["refused"], ""
    if refused:
        said = re.sub(rf"\b{refused['name']}\b", refused["given"], said)
        if match := re.search(rf"{refused['given']} must be (?P<wanted>[^,]+)$", said):
            said += f", but {refused['to']} gets {with_article(refused['type'])}"
            names = re.findall(r"'(\w+)'", match["wanted"])
            below = (class_name for name in names for class_name in launch_classes_below(name))
            derived = [class_name for class_name in below if class_name not in names]
            example = f" (such as {', '.join(map(with_article, derived[-1:]))})" if derived else ""
            fix = f"give {refused['given']} {match['wanted']}{example}"
    fails = "an action fails that launch runs later" if error["is_later"] else "launch cannot load this file"
    return Finding(SAID, f"{fails}: {said.rstrip('.')}.", at(file.shown, error["line"]), fix)


def _lacking(
    path: Path,
    file: LaunchFile,
    told: Mapping[str, Any],
    packages: Sequence[SourcePackage],
    *,
    is_later: bool = False,
) -> Iterator[Finding]:
    """Yield the package or module that a file names and that is neither in the workspace nor installed.

    If launch loads the file without it and needs it only later, only a slip is told.
    """
    (name, *_) = re.findall(r"'([^']+)'", told["lacks"]) or [""]
    own, top = [package.name for package in packages], name.partition(".")[0]
    is_module = "No module" in told["lacks"]
    if not name or top in own or (is_module and top in _modules(packages)):
        return  # it may be found once the workspace is installed
    brings = package_of(top) if is_module else top
    is_right = top in PACKAGES or any(brings in package.declared for package in packages)
    known = () if is_right else (*own, *sorted(PACKAGES))
    near = next((other for other in known if is_near_miss(name, other)), None)
    here = own_module(path, name, packages) if is_module and not is_right else None
    if is_later and not near and not here:
        return
    line = told["line"] or _named_on(path, name)
    if not line and _is_named_elsewhere(name, packages):
        return  # it is told of the launch file that names it, which this one includes
    fails = "an action fails that launch runs later" if is_later else "launch cannot load this file"
    where = "not installed here" if is_right else "neither in this workspace nor installed"
    fix = f"write {near} instead of {name}" if near else _how_to_get(name, is_module=is_module)
    cause, fix = here or (f"{name} is {where}.", fix)
    yield Finding("launch-package", f"{fails}: {cause}", at(file.shown, line), fix, (name,))


def _is_named_elsewhere(name: str, packages: Sequence[SourcePackage]) -> bool:
    """Return whether some launch file names a package or module."""
    return any(_named_on(path, name) for package in packages for path in package.launch_files)


def _named_on(path: Path, name: str) -> int | None:
    """Return the line where a launch file names a package: as a whole string in Python, quoted or spaced in others."""
    if path.suffix != ".py":
        return line_with(read_text(path), f"'{name}'", f'"{name}"', f" {name}")
    texts = _texts(read_source(path, path.stem, path.name))
    return next((node.lineno for node, text in texts if text == name), None)


def _modules(packages: Sequence[SourcePackage]) -> set[str]:
    """Return the modules at the top of what packages install."""
    alone = [package.setup.keywords.get("py_modules") for package in packages if package.setup]
    found = {module.partition(".")[0] for package in packages for module in package.sources}
    return found.union(*(names for names in alone if isinstance(names, (list, tuple))))


def _how_to_get(name: str, *, is_module: bool) -> str:
    """Say how what a launch file names may be installed; of a name that is not known, apt tells whether Jazzy has it."""
    top = name.partition(".")[0]
    apt = install_of(package_of(top) if is_module else top)
    if top in PACKAGES:
        return f"install it ({apt}), or put its source into src"
    asked = f"if `apt-cache policy {apt.rpartition(' ')[2]}` names a version"
    how = f"install it ({apt}), {asked}, or put its source into src"
    how = f"install the package that provides it ({apt}, {asked})" if is_module else how
    return f"{how}; if {name} is misspelt, correct it"
