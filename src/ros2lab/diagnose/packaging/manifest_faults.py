"""What is wrong with a package.xml."""

from __future__ import annotations

import ast
import difflib
import itertools
import keyword
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.imports import ROS_1
from ros2lab.diagnose.code.merge_conflicts import conflict_in
from ros2lab.diagnose.finding import Finding, at, line_with
from ros2lab.diagnose.packaging.build_order import needed
from ros2lab.diagnose.packaging.cmake_files import launches_left, named_by_cmake, python_alone
from ros2lab.diagnose.packaging.for_ros import renamed_manifest
from ros2lab.diagnose.packaging.manifest_repairs import build_type_written, repaired
from ros2lab.diagnose.packaging.setup_shapes import manifest_line
from ros2lab.diagnose.sources.commented_out import without_comments, without_texts
from ros2lab.diagnose.sources.interfaces import PACKAGES, is_library, is_module, meant, package_of
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import Function, PythonSource, read_text
from ros2lab.diagnose.sources.spelling import alike, differs, is_near_miss, nearest, same_letters
from ros2lab.manifest_words import KEYS

BUILD_TYPES = ("ament_python", "ament_cmake", "cmake", "catkin")
# What rclpy depends on, and what a launch file needs: hardly anybody declares these, and nothing breaks.
# Modules of Python that are called like the libraries that they wrap, which rosdep does find.
_LIBRARIES = frozenset(("readline", "sqlite3", "uuid", "zlib"))
_LONG = 10  # letters of a standard package's name, of which no other package's differs by only one
_BROUGHT_ALONG = frozenset(
    ("rcl_interfaces", "builtin_interfaces", "unique_identifier_msgs", "launch", "launch_ros")
)


def manifest_faults(
    package: SourcePackage,
    workspace_names: Collection[str],
    plain: Collection[str] = (),
    homes: Mapping[str, str] | None = None,
) -> Iterator[Finding]:
    """Yield what is wrong with the package.xml of a package for ROS.

    Args:
        package: which.
        workspace_names: the packages of its workspace.
        plain: those of them that are not for ROS, which it need not declare.
        homes: the others by the modules that they bring.
    """
    shown = package.shown("package.xml")
    if not package.has("package.xml") and (misnamed := renamed_manifest(package)):
        cause = f"The manifest is called {misnamed} but must be called package.xml, so colcon does not treat this as a ROS package."
        fix = f"mv {quote(package.shown(misnamed))} {quote(shown)}"
        yield Finding("manifest-invalid", cause, package.shown(misnamed), fix)
        return
    if not package.has("package.xml"):
        yield no_manifest(package)
        return
    if package.manifest_fault:
        text = read_text(package.folder / "package.xml")
        keywords = package.setup.keywords if package.setup else {}
        said = re.sub(r"^(?:Error\(s\): )?(?:- )?", "", " ".join(package.manifest_fault.split()))
        if conflict := conflict_in(text):
            said = conflict.why
        line, fix = ((conflict.line, conflict.told) if conflict else repaired(text, keywords)) or (
            package.manifest_line,
            "change it as it says; `colcon list` then shows (ros.ament_python)",
        )
        cause = f"package.xml is not valid, so colcon does not treat this as a ROS package: {said}"
        yield Finding("manifest-invalid", cause, at(shown, line), fix)
        return
    if package.is_of_ros_1:
        yield _of_ros_1(package)
        return
    yield from _build_type_faults(package, shown)
    if package.is_built_by_cmake:
        yield from named_by_cmake(package)
        yield from () if python_alone(package) else launches_left(package)
    yield from _dependency_faults(package, shown, workspace_names)
    yield from _undeclared(package, {*workspace_names} - {*plain}, homes or {})


def _of_ros_1(package: SourcePackage) -> Finding:
    """Return that a package is one of ROS 1, which has to be made anew."""
    name, folder = package.name, package.shown("").rstrip("/")
    cause = f"{name} is a package of ROS 1: it is built by catkin, which ROS 2 does not have."
    fix = f"touch {quote(f'{folder}/COLCON_IGNORE')} if it is not needed here; otherwise make a new package (ros2 pkg create --build-type ament_python) and write its nodes anew with rclpy there"
    line = manifest_line(package, "catkin")
    return Finding("build-type-unknown", cause, at(package.shown("package.xml"), line), fix)


def no_manifest(package: SourcePackage) -> Finding:
    """Return a finding that a package for ROS has no package.xml."""
    cause = (
        f"The package {package.name} has no package.xml, so colcon and ROS do not treat it as a ROS package."
    )
    fix = "write a package.xml next to setup.py; `ros2 pkg create --build-type ament_python` creates one"
    return Finding("manifest-invalid", cause, package.shown("package.xml"), fix)


def dependency_circle(packages: Collection[SourcePackage]) -> Iterator[Finding]:
    """Yield a circle of packages that depend on each other: colcon finds no order to build them in."""
    needs = {package.name: [dependency.name for dependency in needed(package)] for package in packages}
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        circle: list[str] = error.args[1]  # the next package needs each of them
        edges = [*itertools.pairwise(circle)]
        by_name = {package.name: package for package in packages}
        wanted, user = next((edge for edge in edges if not mentions(by_name[edge[1]], edge[0])), edges[0])
        package = by_name[user]
        cause = f"colcon cannot decide which package to build first, because each of these depends on the next: {' -> '.join(circle[::-1])}."
        fix = f"move what {user} uses from {wanted} into a separate package that both depend on, and remove this dependency"
        if not mentions(package, wanted):
            fix = f"remove the dependency on {wanted} from the package.xml of {user}, which does not use it"
        yield Finding(
            "dependency-circle", cause, at(package.shown("package.xml"), manifest_line(package, wanted)), fix
        )


def mentions(package: SourcePackage, name: str) -> bool:
    """Return whether a file of a package mentions another package."""
    texts = [source.text for source in package.sources.values()]
    texts += [read_text(path) for path in package.launch_files]
    return any(re.search(rf"\b{re.escape(name)}\b", text) for text in texts)


def _no_setup(package: SourcePackage) -> Finding:
    """Return that a Python package has no setup.py, or one of nearly that name."""
    if called := alike(package.folder, "setup.py"):
        cause = f"The file is called {called} but must be called setup.py: {differs(called, 'setup.py')}."
        fix = f"mv {quote(package.shown(called))} {quote(package.shown('setup.py'))}, and build again"
        return Finding("setup-missing", cause, package.shown(called), fix)
    cause = f"The package {package.name} is an ament_python package but has no setup.py, which says what to install."
    fix = f"type `ros2 pkg create {package.name} --build-type ament_python` in an empty folder elsewhere, copy setup.py, setup.cfg and resource from there next to package.xml, and add the executables to entry_points"
    return Finding("setup-missing", cause, package.shown("setup.py"), fix)


def _build_type_faults(package: SourcePackage, shown: str) -> Iterator[Finding]:
    kind, has_cmake = package.build_type, package.has("CMakeLists.txt")
    if not package.has("setup.py") and not has_cmake and kind == "ament_python":
        yield _no_setup(package)
    exports = package.manifest.exports if package.manifest else []
    near = next((e.tagname for e in exports if is_near_miss(e.tagname, "build_type")), "")
    several = [e.content for e in exports if e.tagname == "build_type" and "condition" not in e.attributes]
    if len(several) > 1:
        yield _several_build_types(package, shown, several)
    elif kind is None and near:
        cause = f"package.xml has <{near}>, but the tag is called <build_type>, so colcon does not know how to build this."
        fix = "write `<build_type>ament_python</build_type>`"
        yield Finding("build-type-missing", cause, at(shown, manifest_line(package, near)), fix)
    elif kind is None and not has_cmake:
        cause = "package.xml has no <build_type>, so colcon takes this for an old catkin package and expects a CMakeLists.txt."
        yield _with_build_type("build-type-missing", cause, package, "ament_python")
    elif kind is not None and kind not in BUILD_TYPES:
        yield from _unknown_build_type(package, kind)
    elif kind in ("ament_cmake", "cmake", "catkin") and not has_cmake:
        is_python = package.has("setup.py") or bool(package.sources)
        create = f"type `ros2 pkg create {package.name} --build-type ament_cmake` in an empty folder elsewhere, and copy CMakeLists.txt from there next to package.xml"
        cause = f"package.xml has the build type {kind}, which needs a CMakeLists.txt, but {'this is a Python package' if is_python else 'there is none'}."
        found = _with_build_type("build-type-cmake", cause, package, "ament_python")
        yield found if is_python else replace(found, fix=create)
    elif kind in (None, "ament_cmake") and (files := python_alone(package)):
        yield from _not_installed_by_cmake(package, shown, files)


def _several_build_types(package: SourcePackage, shown: str, several: Sequence[str]) -> Finding:
    """Return a finding that colcon asks none of several build types, and takes the package for one that is not for ROS."""
    cause = f"package.xml has {len(several)} build types, {' and '.join(several)}, and colcon uses none of them: there must be one."
    is_python = package.has("setup.py") and not package.has("CMakeLists.txt")
    kept = "ament_python" if is_python else several[0]
    lost = next((name for name in several if name != kept), kept)
    line, fix = manifest_line(package, lost), f"remove `<build_type>{lost}</build_type>`"
    return Finding("build-type-unknown", cause, at(shown, line), fix)


def _unknown_build_type(package: SourcePackage, kind: str) -> Iterator[Finding]:
    """Yield a build type that may be misspelt; there are others, for Rust or Java, each with an extension of colcon."""
    wanted = nearest(kind, BUILD_TYPES, 0.8) or ("ament_python" if package.has("setup.py") else "")
    if wanted:
        cause = f"package.xml has the build type {kind!r}, which colcon does not know, so nothing is built."
        yield _with_build_type("build-type-unknown", cause, package, wanted)


def _with_build_type(code: str, cause: str, package: SourcePackage, kind: str) -> Finding:
    """Return a finding with the words that give a package.xml a build type, and the line for them."""
    line, fix = build_type_written(read_text(package.folder / "package.xml"), kind)
    return Finding(code, cause, at(package.shown("package.xml"), line), fix)


def _not_installed_by_cmake(package: SourcePackage, shown: str, files: Sequence[str]) -> Iterator[Finding]:
    """Yield that a package is built by CMake, which does not install its Python files; modules are none to be run."""
    name, place, file = package.name, at(shown, manifest_line(package, "build_type")), files[0]
    if package.has("setup.py"):
        has = "the build type ament_cmake" if package.build_type else "no <build_type>"
        cause = f"package.xml has {has}, so colcon builds {name} with CMakeLists.txt, which does not install {file}, and does not read setup.py."
        yield _with_build_type("build-type-cmake", cause, package, "ament_python")
        return
    text = package.cmake
    if re.search(r"^\s*install\s*\(", text, re.MULTILINE):
        files = [path for path in files if _is_program(package.folder / path)]
        line = line_with(text, "ament_package")
        cause = f"CMakeLists.txt does not install {', '.join(files)}, so `ros2 run` and `ros2 launch` do not find {'it' if len(files) == 1 else 'them'}."
        fix = f"write `install(PROGRAMS {' '.join(files)} DESTINATION lib/${{PROJECT_NAME}})` above ament_package(), and build again; the first line of a program must be #!/usr/bin/env python3"
        if files:
            yield Finding("build-type-cmake", cause, at(package.shown("CMakeLists.txt"), line), fix)
        return
    manifest = package.manifest
    needs = dict.fromkeys(dependency.name for dependency in manifest.exec_depends) if manifest else {}
    create = f"ros2 pkg create {name} --build-type ament_python"
    create += f" --dependencies {' '.join(needs)}" if needs else ""
    folder = package.shown("").rstrip("/")
    beside, inner = folder.rpartition("/")[0] or ".", file.rpartition("/")[0]
    shown_files = ", ".join(path.rpartition("/")[2] for path in files)
    old, new = f"{folder}_old/{inner}".rstrip("/"), f"{beside}/{name}/{name}".removeprefix("./")
    cause = f"{name} is a CMake package, which `ros2 pkg create` makes without --build-type ament_python, but {file} in it is Python."
    fix = f"touch {quote(f'{folder}/COLCON_IGNORE')}, then mv {quote(folder)} {quote(f'{folder}_old')}, then cd {quote(beside)} && {create}, and copy {shown_files} from {old} into {new}"
    yield Finding("build-type-cmake", cause, place, fix)


def _is_program(path: Path) -> bool:
    """Return whether a file is meant to be run: it says by what, has a main(), or does more than define and import."""
    text = read_text(path)
    try:
        body = ast.parse(text).body
    except (SyntaxError, ValueError):
        return True
    defining = (ast.Import, ast.ImportFrom, ast.ClassDef, ast.Assign, ast.AnnAssign)
    acts = (node for node in body if not isinstance(getattr(node, "value", None), ast.Constant))
    return text.startswith("#!") or any(
        node.name == "main" if isinstance(node, Function) else not isinstance(node, defining) for node in acts
    )


def _dependency_faults(
    package: SourcePackage, shown: str, workspace_names: Collection[str]
) -> Iterator[Finding]:
    manifest = package.manifest
    runtime = [*manifest.build_depends, *manifest.exec_depends, *manifest.build_export_depends]
    declared = [
        *dict.fromkeys(
            dependency.name for dependency in [*runtime, *manifest.test_depends, *manifest.buildtool_depends]
        )
    ]
    known = PACKAGES | {*workspace_names}
    used = {launched for launched, _ in launched_packages(package)}
    used |= {i.target.partition(".")[0] for source in package.sources.values() for i in source.imports}
    for export in (e for e in manifest.exports if e.tagname.endswith("depend") and e.content):
        name = str(export.content).strip()
        element = f"<{export.tagname}>{name}</{export.tagname}>"
        cause = f"`{element}` is inside <export>, where neither colcon nor rosdep looks for dependencies."
        place = at(shown, manifest_line(package, name, after="export"))
        fix = "move this line above <export>"
        if name in declared:
            fix = "remove this line: it is above <export> as well"
        yield Finding("dependency-joined", cause, place, fix, (name,))
    for name in declared:
        place = at(shown, manifest_line(package, name))
        if len(re.findall(r"[\w-]+", name)) > 1:
            yield from _joined(package, name, place, declared, known)
            continue
        if name in known:
            continue
        key = KEYS.get(name, "")
        if name in sys.stdlib_module_names - _LIBRARIES:
            code, wanted, otherwise = "dependency-not-ros", "", ""
            what = "which is part of Python, not a package, so rosdep cannot find it"
        elif name in used and (key.startswith("python3-") or is_library(name)):
            code, wanted, otherwise = "dependency-key", key, ", or write rosdep's name for it"
            what = "which is a Python module, not a package of ROS: rosdep has names of its own for modules"
        elif wanted := _meant(package, name, known, used):
            code, otherwise = "dependency-unknown", ""
            what = f"but there is no such package; the name is {wanted}"
            what += f", which has the module {name[len(wanted) + 1 :]}" * name.startswith(f"{wanted}_")
        else:
            continue
        fix = f"write {wanted} instead of {name}" if wanted else f"remove the line with {name}{otherwise}"
        fix = f"remove this line: {wanted} is declared as well" if wanted in declared else fix
        yield Finding(code, f"package.xml declares {name}, {what}.", place, fix, (name,))


def _meant(package: SourcePackage, name: str, known: Set[str], used: Set[str]) -> str:
    """Return the package that is meant by a declared name that no package has; empty if it is not known.

    A public package that is not installed here may differ from one in the workspace by one letter: a slip it is
    only if the package uses the other one and not this one, or if the other one's name is standard and long.
    """
    # The name of a package of ROS 1 often gets a 2, as in rviz2.
    of_ros_2 = ROS_1.get(name) or (f"{name}2" if f"{name}2" in PACKAGES else "")
    of_ros_2 = of_ros_2 if package.is_built_by_cmake else package_of(of_ros_2)
    if of_ros_2 or name in used:
        return of_ros_2
    near = [other for other in sorted(known) if is_near_miss(name, other)]
    standard = {other for other in PACKAGES if len(other) >= _LONG or same_letters(name, other)}
    slips = [other for other in near if other != package.name and other in used | standard]
    splits = ((name[:end], name[end + 1 :]) for end, sign in enumerate(name) if sign == "_")
    homes = (top for top, inner in splits if top in PACKAGES and is_module(f"{top}.{inner}"))
    return next(iter(slips), "") or next(homes, "")


_KEY = re.compile(r"[\w.+-]+")  # a name as rosdep has it, such as libgstreamer1.0-dev or libstdc++6


def _named_in(word: str, known: Collection[str]) -> list[str]:
    """Return the packages that a word of a tag names: as a whole, `rcl.py` for rclpy, or by the parts of a path."""
    path = re.split(r"[./:]+", word)
    whole = [name for name in sorted(known) if same_letters(name, word)]
    parts = [part if part in known else meant(part) for part in path]
    return whole[:1] or [*filter(None, parts)] or [word if _KEY.fullmatch(word) else path[0]]


def _joined(
    package: SourcePackage, written: str, place: str, declared: Collection[str], known: Set[str]
) -> Iterator[Finding]:
    """Yield how to declare the packages that are written in one tag, as a list or as what Python imports of them."""
    words = re.findall(r"[^\W\d][\w./:+-]*", written)
    parts = [part for word in words for part in _named_in(word, known)]
    if _KEY.fullmatch(written) and known.isdisjoint(parts):
        return  # it may be a key of rosdep
    names = [*dict.fromkeys(part for part in parts if not keyword.iskeyword(part))]
    new = [name for name in names if name not in declared]
    text = read_text(package.folder / "package.xml")
    tags = re.search(rf"<(\w+)[^<>]*>\s*{re.escape(written)}\s*<", text)
    tag = tags[1] if tags else "depend"
    cause = f"A tag declares one package by its name, but {written!r} is not the name of one"
    cause = f"{cause}, so it does not declare {' and '.join(names)}."
    rows = "".join(f"<{tag}>{name}</{tag}>" for name in new)
    are = "are" if len(names) > 1 else "is"
    fix = f"write `{rows}`" if new else f"remove this line: {' and '.join(names)} {are} declared as well"
    if names:
        yield Finding("dependency-joined", cause, place, fix, (*names,))


# How a launch file names another package, in Python, XML and YAML.
_NAMED_BY_LAUNCH = re.compile(
    r"(?:\b(?:package|pkg)\w* ?[=:] *|FindPackageShare\( *|get_package_share_\w+\( *|\$\(find-pkg-share )['\"]?(?P<name>[\w-]+)"
)


def launched_packages(package: SourcePackage) -> Iterator[tuple[str, str]]:
    """Yield the packages that a package's launch files name, each with its place."""
    for path in package.launch_files:
        shown = package.shown(str(path.relative_to(package.folder)))
        text = read_text(path)
        text = without_texts(text) if path.suffix == ".py" else without_comments(text)
        for number, line in enumerate(text.splitlines(), 1):
            code = line if path.suffix == ".xml" else line.partition("#")[0]
            yield from ((match["name"], at(shown, number)) for match in _NAMED_BY_LAUNCH.finditer(code))


def _undeclared(package: SourcePackage, own: Collection[str], homes: Mapping[str, str]) -> Iterator[Finding]:
    declared = {dependency.name for dependency in needed(package)} | package.conditional
    strange = [name for name in declared if name not in PACKAGES.union(own)]
    launched = dict[str, str]()
    for name, place in launched_packages(package):
        launched.setdefault(name, place)
    for name, place in launched.items():
        if name in own and name not in declared | {package.name} and not _is_like(name, strange):
            cause = f"{place.partition(':')[0]} uses the package {name}, but package.xml does not declare it, so `colcon build --packages-up-to {package.name}` leaves it out."
            fix = f"add <exec_depend>{name}</exec_depend> to {package.shown('package.xml')}"
            yield Finding("dependency-launched", cause, place, fix, (name,))
    yield from _imported(package, own, homes, declared, strange)


def _imported(
    package: SourcePackage,
    own: Collection[str],
    homes: Mapping[str, str],
    declared: Set[str],
    strange: Sequence[str],
) -> Iterator[Finding]:
    """Yield the packages that are imported, and neither declared nor misspelt among the `strange` names."""
    told, known = set[str](), PACKAGES.union(own)
    for source in package.sources.values():
        if re.search(r"(^|/)tests?/", source.shown):
            continue
        for imported in source.imports:
            module = imported.target.partition(".")[0]
            name = homes.get(module) or package_of(module)
            if name in told | declared | _BROUGHT_ALONG or imported.is_guarded:
                continue
            if package.name in (name, module) or (name != module and _lies_here(package, source, module)):
                continue
            is_interface = name.endswith(("_msgs", "_srvs", "_interfaces")) and name not in package.sources
            if name in known or (is_interface and not meant(name)):
                told.add(name)
                if _is_like(name, strange):
                    continue
                what = (
                    f"{module}, but package.xml does not declare it"
                    if name == module
                    else f"{module}, which the package {name} brings, but package.xml does not declare {name}"
                )
                order = ", and colcon may build in the wrong order" if name in own else ""
                cause = f"{source.shown} imports {what}: it may be missing on another machine{order}."
                fix = f"add <depend>{name}</depend> to package.xml"
                yield Finding("dependency-undeclared", cause, source.at(imported.line), fix, (name,))


def _is_like(name: str, strange: Collection[str]) -> bool:
    """Return whether a package is declared but misspelt, which is reported already."""
    return bool(difflib.get_close_matches(name, strange, n=1, cutoff=0.85))


def homes_of(packages: Iterable[SourcePackage]) -> Mapping[str, str]:
    """Return packages of a workspace by the modules that only they install."""
    tops = [(p.name, {name.partition(".")[0] for name in p.packages or ()}) for p in packages]
    counts = Counter(module for _, modules in tops for module in modules - sys.stdlib_module_names)
    return {module: name for name, modules in tops for module in modules if counts[module] == 1}


def _lies_here(package: SourcePackage, source: PythonSource, module: str) -> bool:
    """Return whether a module lies beside the file that imports it, or in the package's own folder."""
    folders = (package.folder, source.path.parent if source.path else package.folder)
    return any((folder / module).is_dir() or (folder / f"{module}.py").is_file() for folder in folders)
