"""Says why a command does not find a package, an executable, a file or a module."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.bare_imports import bare_import, by_folders, is_meant
from ros2lab.diagnose.code.imports import names_of
from ros2lab.diagnose.code.listed_packages import not_built
from ros2lab.diagnose.code.wrong_imports import wrong_imports
from ros2lab.diagnose.explaining.unbuilt import not_yet_built
from ros2lab.diagnose.finding import Finding, at, stops_build
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging.installed import prefix_of
from ros2lab.diagnose.packaging.layout_faults import hidden, outside
from ros2lab.diagnose.packaging.manifest_faults import manifest_faults
from ros2lab.diagnose.packaging.whereabouts import in_another_workspace, nowhere_seen
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.spots import Spot, spot_at
from ros2lab.diagnose.sources.interfaces import (
    PACKAGES,
    install_of,
    is_installed,
    is_module,
    nearest_module,
    package_of,
)
from ros2lab.diagnose.sources.other_names import by_another_name, meant_function
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.diagnose.sources.setup_script import EntryPoint
from ros2lab.diagnose.sources.spelling import did_you_mean, is_near_miss, nearest

# Faults that keep an executable from the folder where `ros2 run` looks, the likeliest first.
_LOSE_EXECUTABLES = (
    *("setup-value", "setup-cfg-missing", "setup-cfg-dashes", "entry-points-key", "entry-points-missing"),
    *("install-stale", "entry-point-spec", "replaced"),
)
# The variables that `setup.bash` sets; setting one again hides the workspace.
_VARIABLE = re.compile(
    r"^(?:export |unset )?(?P<name>AMENT_PREFIX_PATH|PYTHONPATH|PATH|COLCON_PREFIX_PATH)\b(?P<to>=.*)?$"
)
_SOURCES = re.compile(r"^(?:source|\.) +(?P<file>\S*setup\.\w*sh)\b")
_RUNS_IT = re.compile(r"^(?:(?:ba|z)?sh +|\./)?(?P<file>\S*install/(?:local_)?setup\.\w*sh)$")


def not_sourced(name: str, typed: Sequence[str], text: str, root: Path) -> Finding:
    """Say why a package that is built is not found, judging by what was typed in that terminal."""
    fix, cause = (
        f"source {quote(f'{root}/install/setup.bash')}",
        f"The package {name} is built, but this terminal has not sourced the workspace",
    )
    sourced = [n for n, line in enumerate(typed) if _SOURCES.match(line)]
    built = [n for n, line in enumerate(typed) if line.startswith("colcon build")]
    ran = next((line for line in typed if _RUNS_IT.match(line)), "")
    last = sourced[-1] if sourced else -1
    hidden = next(
        (line for line in typed[last + 1 :] if (m := _VARIABLE.match(line)) and "$" + m["name"] not in line),
        "",
    )
    file = _SOURCES.match(typed[last])["file"] if sourced else ""  # type: ignore[index]
    if hidden and sourced:
        variable = _VARIABLE.match(hidden)["name"]  # type: ignore[index]
        cause = f"`{hidden}` removes what sourcing put into {variable}, so {name} is no longer found"
        value = hidden.partition("=")[2].strip("'\"")
        kept = f"write `export {variable}=${variable}:{value}` instead of `{hidden}`"
        fix = f"{fix}, and {kept if value else f'remove `{hidden}`'}, also in ~/.bashrc"
    elif sourced and built and last < built[-1]:
        cause = (
            f"The workspace was sourced before {name} was built, and a terminal does not notice later builds"
        )
    elif sourced and re.search(
        rf"{re.escape(file)}'?: (?:No such file|Permission)|no such file.*{re.escape(file)}", text
    ):
        cause = (
            f"`{typed[last]}` found no file {file} in the folder where it was typed, so nothing was sourced"
        )
    elif sourced and re.search(r"source: (?:command )?not found|not found: source", text):
        cause = f"`{typed[last]}` was not understood, because this shell is not bash, so nothing was sourced"
        fix = f"type bash, then {fix}"
    elif ran and not sourced:
        cause = f"`{ran}` runs in its own shell, and what it sets is lost when it ends: it must be sourced"
    return Finding("not-sourced", f"{cause}.", "", fix)


def no_package(name: str, look: Look, error: ErrorText) -> Finding:
    """Say why ROS does not find a package."""
    package = look.package(name)
    if package is None:
        return _unknown_package(name, look)
    if not package.has("package.xml"):
        return next(manifest_faults(package, ()))  # the command needs it as a ROS package
    if package.manifest_fault and (invalid := _fault_of(package, look, ("manifest-invalid",))):
        return invalid
    if prefix_of(look.root, name) is not None:
        return not_sourced(name, error.typed, error.text, look.root)
    folder = package.shown("-").removesuffix("-")
    stops = [f for f in look.findings if f.place.startswith(folder) and stops_build(f)]
    stops += [f for f in look.findings if f.code == "link-stale" and f"/{name}/" in f"{f.place}/"]
    stops += [f for f in look.findings if f.code in ("build-elsewhere", "build-type-unknown")]
    return next(iter(stops), None) or not_yet_built(package, look, error)


def _unknown_package(name: str, look: Look) -> Finding:
    """Say where colcon does not see a package, or which name was meant."""
    if found := _unseen(name, look) if look else None:
        return found
    names = [package.name for package in look.packages]
    cause = f"ROS finds no package {name} in what this terminal has sourced.{did_you_mean(name, names)}"
    near = nearest(name, names)
    do = "check the name, build the workspace, and source install/setup.bash in this terminal"
    return Finding("package-not-found", cause, "", f"write {near} instead of {name}" if near else do)


def _unseen(name: str, look: Look) -> Finding | None:
    """Say where a package is, or a module of its name, that colcon does not see; None if it is nowhere."""
    passed_over = (hidden(folder) for folder in look.passed_over if folder.package.name == name)
    named = (f for f in look.findings if f.code == "package-name" and name in f.about)
    found = next(passed_over, None) or next(outside(look.root, name), None) or next(named, None)
    return found or nowhere_seen(look.root, name) or in_another_workspace(look.root, name)


def no_executable(command: tuple[str, str, str] | None, look: Look, typed: Sequence[str] = ()) -> Finding:
    """Say why `ros2 run` does not find an executable."""
    package = look.package(command[1]) if command else None
    if command is None or package is None:
        return _fault_of(package, look, _LOSE_EXECUTABLES) or _nowhere(command)
    there, name = look.executables[package.name] or (), command[2]
    if there and name not in there and (meant := by_another_name(package, name)):
        return _called_otherwise(package, name, meant, typed)
    stem = name.partition(".")[0]
    if f"{package.name}.{stem}" in package.sources and stem not in there:
        return _fault_of(package, look, _LOSE_EXECUTABLES) or _no_entry_point(package, stem)
    if there and name not in there:
        return _fault_of(package, look, ("replaced",)) or _unknown_to(package, name, there)
    return _fault_of(package, look, _LOSE_EXECUTABLES) or _nowhere(command)


def _called_otherwise(
    package: SourcePackage, name: str, meant: Sequence[EntryPoint], typed: Sequence[str]
) -> Finding:
    """Say by which names the executables are started that a file's, function's or class's name means."""
    wrong = re.compile(rf"\b{re.escape(package.name)} +{re.escape(name)}\S*")
    plain = f"ros2 run {package.name} {name}"
    line = next((line for line in reversed(typed) if f"{package.name} {name}" in line), plain)
    run = ", or ".join(f"`{wrong.sub(f'{package.name} {point.name}', line)}`" for point in meant)
    cause = f"{name} is not the name of an executable; {len(meant)} executables in setup.py run it."
    if len(meant) == 1:
        cause = f"{name} is not the name of an executable: ros2 run needs the name before the = in `{meant[0].text}`."
    place = at(package.shown("setup.py"), meant[0].line)
    return Finding("executable-missing", cause, place, f"type {run}")


def _unknown_to(package: SourcePackage, name: str, there: Collection[str]) -> Finding:
    """Say which executables a package has instead of one that was typed."""
    cause = f"The package {package.name} has no executable {name}; it has {', '.join(sorted(there))}.{did_you_mean(name, there)}"
    fix = f"type ros2 run {package.name}, and after it one of these names"
    return Finding("executable-missing", cause, package.shown("setup.py"), fix)


def _nowhere(command: tuple[str, str, str] | None) -> Finding:
    """Say what keeps ROS from finding an executable, where nothing more is known."""
    what = f" {command[2]} in {command[1]}" if command else ""
    cause = f"ROS finds no such executable{what}: it is not an entry point in setup.py, has not been built since, or setup.cfg does not put it into lib/<package>."
    fix = "check entry_points in setup.py and setup.cfg, build again, and source install/setup.bash"
    return Finding("executable-missing", cause, "", fix)


def _no_entry_point(package: SourcePackage, name: str) -> Finding:
    """Say that a module exists, but that no entry point calls it."""
    module = f"{package.name}.{name}"
    cause = f"{package.sources[module].shown} exists, but no entry point in setup.py calls it, so it is not an executable."
    fix = f"write `'{name} = {module}:{meant_function(package, module)}'` into 'console_scripts', and build again"
    return Finding("executable-missing", cause, package.shown("setup.py"), fix)


# Faults that keep a file from the folder where ROS looks.
_UNINSTALLED = frozenset(("not-in-data-files", "installed-elsewhere", "install-stale", "setup-value"))


def no_file(name: str, package_name: str, look: Look) -> Finding | None:
    """Say why `ros2 launch` does not find a file."""
    package = look.package(package_name)
    paths = package.launch_files if package else []
    for finding in look.findings:
        if finding.code in _UNINSTALLED and {name, "data_files"} & {*finding.about}:
            return finding
    if begun := next((path.name for path in paths if path.name.startswith(f"{name}.")), ""):
        cause = f"There is no launch file {name}: its full name, with the extension, is {begun}."
        return Finding("file-not-found", cause, "", f"ros2 launch {package_name} {begun}")
    path = next((path for path in paths if path.name == name), None)
    if package and path:
        inner = path.relative_to(package.folder).as_posix()
        cause = f"{inner} is in src but not in share/{package_name} in install, where ROS looks: it has not been installed since, or was installed elsewhere."
        fix = f"add (os.path.join('share', package_name, 'launch'), ['{inner}']) to data_files in setup.py, then colcon build --packages-select {package_name}"
        return Finding("not-in-data-files", cause, package.shown(inner), fix)
    cause = f"The package {package_name} has installed no file {name}.{did_you_mean(name, [path.name for path in paths])}"
    fix = "compare it with the file's name; add the file to data_files in setup.py, build again and source"
    return Finding("file-not-found", cause, "", fix)


def _fault_of(package: SourcePackage | None, look: Look, codes: tuple[str, ...]) -> Finding | None:
    """Return a finding with the earliest possible code, about a package or, without one, any package."""
    folder = package.shown("-").removesuffix("-") if package else ""
    found = [finding for finding in look.findings if finding.place.startswith(folder)]
    found = [finding for finding in found if finding.code != "replaced" or "/setup.py:" in finding.place]
    return next((finding for code in codes for finding in found if finding.code == code), None)


def no_module(name: str, place: str, look: Look) -> Finding | None:
    """Say why Python does not find a module; None if it may be misspelled, or without a workspace."""
    top = name.partition(".")[0]
    if top in PACKAGES and is_installed(top) and (name == top or is_module(name)):
        cause = f"The Python that ran this does not find {top}, but the course's own Python does: it is a different Python, or a terminal without ROS."
        fix = "start the node with `ros2 run`, in a terminal where ROS is sourced or the course's .venv is active; or with `python3` there"
        return Finding("command-not-found", cause, place, fix)
    if not look:
        return None
    if known := _own_module(name, place, look) or _not_installed(top, place):
        return known
    own = {part for package in look.packages for module in package.sources for part in module.split(".")}
    if found := _unseen(top, look) if top not in own else None:
        return replace(found, place=found.place or place)
    if top in own or nearest_module(name) or any(is_near_miss(top, own_name) for own_name in own):
        return None
    return _of_library(top, place, f"Nothing in the workspace or in ROS is called {top}")


def _of_library(top: str, place: str, why: str) -> Finding:
    """Say that a module is one of a library, or misspelt, and why it can be no other."""
    cause = f"{why}: it is a library that is not installed here, or a misspelled name."
    fix = f"install the library that provides {top}, following its documentation, and name it in package.xml; or fix the name"
    return Finding("module-missing", cause, place, fix)


def _not_installed(top: str, place: str) -> Finding | None:
    """Say which package of ROS has a module, and how to install it; None if it is installed, or not of ROS."""
    if top not in PACKAGES or is_installed(top):
        return None
    brings = package_of(top)
    cause = f"{top} comes with the package {brings} of ROS, which is not installed here."
    fix = f"{install_of(brings)}, and declare it in package.xml: <depend>{brings}</depend>"
    return Finding("module-missing", cause, place, fix)


def wrong_import(spot: Spot, groups: Mapping[str, str], look: Look) -> Finding | None:
    """Return the finding of an import that failed; None if what was meant is not known.

    Without its line, only the message `cannot import name` is known, as `groups`.
    """
    source = spot.source
    if source is None and groups.get("module"):
        source = PythonSource("", "", f"from {groups['module']} import {groups['name']}")
    if source is None:
        return None
    found = [*wrong_imports(source, names_of(source, look.modules, look.interfaces), is_sure=True)]
    if spot.source is None:
        return replace(found[0], place="") if found else None
    here = {source.at(line) for line in spot.lines}
    return next((finding for finding in found if finding.place in here), None)


def below_folders(spot: Spot, look: Look) -> Finding | None:
    """Return the finding about a line that imports a module of the workspace with the folders above it; else None."""
    found = (by_folders(spot.file, line, look.modules) for line in spot.lines)
    return next(filter(None, found), None)


def _own_module(name: str, place: str, look: Look) -> Finding | None:
    """Say why a module of the workspace is not found; None if the workspace has no such module."""
    for package in look.packages:
        if not place.startswith("cell") and (unlisted := not_built(package, name)):
            return unlisted
        for module in package.sources:
            if module.endswith(f".{name}"):
                source = spot_at(place, look).source
                is_other = source is not None and not is_meant(source, name, module, package.sources)
                why = f"{module} does not have what this file uses of {name}"
                return _of_library(name, place, why) if is_other else bare_import(module, name, place)
            if module == name and place.startswith("cell"):
                cause = f"{name} is in {package.shown('')}, but the notebook's kernel has sourced no workspace; a cell with ! runs in its own shell."
                fix = "use it in a %%terminal cell, after source install/setup.bash there"
                return Finding("not-sourced", cause, place, fix)
            if module == name:
                lists = (f for f in look.findings if "packages" in f.about and f.code == "setup-value")
                if found := next((f for f in lists if f.place.startswith(package.shown("setup.py"))), None):
                    return found
                cause = f"{name} is in {package.shown('')} but not where the package is installed, or this terminal does not look there."
                fix = f"run colcon build --packages-select {package.name} in the workspace, and source install/setup.bash"
                return Finding("install-stale", cause, place, fix)
    return None
