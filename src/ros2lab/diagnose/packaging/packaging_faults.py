"""Faults in a package's setup.py, its setup.cfg and the files that they name."""

from __future__ import annotations

import filecmp
import os
import re
from collections.abc import Iterator
from configparser import RawConfigParser
from dataclasses import replace
from fnmatch import fnmatchcase
from importlib.metadata import distributions
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.argument_names import refused_keywords
from ros2lab.diagnose.code.bound_names import undefined_names
from ros2lab.diagnose.code.expression_faults import comma_faults, keys_twice, path_faults
from ros2lab.diagnose.code.listed_packages import needed_packages, not_listed
from ros2lab.diagnose.code.meant_names import meant
from ros2lab.diagnose.code.syntax_repairs import syntax_finding
from ros2lab.diagnose.code.wrong_imports import misspelt_packages, wrong_imports
from ros2lab.diagnose.finding import Finding, at, in_a_row, line_with
from ros2lab.diagnose.packaging.entry_point_faults import entry_point_faults
from ros2lab.diagnose.packaging.file_patterns import dead_pattern
from ros2lab.diagnose.packaging.installed import prefix_of
from ros2lab.diagnose.packaging.setup_run import taken_by_setuptools
from ros2lab.diagnose.packaging.setup_shapes import as_meant, like, meant_name, shape_faults
from ros2lab.diagnose.sources.file_texts import read_toml
from ros2lab.diagnose.sources.interfaces import INDEX
from ros2lab.diagnose.sources.lying import lies_elsewhere
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import names_read, read_text
from ros2lab.diagnose.sources.setup_cfg import cfg_repair, read_cfg
from ros2lab.diagnose.sources.setup_script import SetupScript
from ros2lab.diagnose.sources.spelling import alike, differs, is_near_miss

_BRINGING = {"__import__", "exec", "eval"}  # what may bring code into a file without an import statement


def packaging_faults(
    package: SourcePackage, *, is_for_ros: bool = True, is_as_meant: bool = False
) -> Iterator[Finding]:
    """Yield what is wrong with the packaging of a Python package, and keeps ROS from finding it if it is for ROS.

    If it is taken as meant, a misspelt keyword of setup() counts as the right one, once it is reported.
    """
    setup = package.setup
    if setup is None or (package.kind == "cmake" and not is_for_ros):
        return
    if setup.source.tree is not None and setup.source.fault:
        yield syntax_finding("setup-syntax", setup.source)
        return
    yield from misspelt_packages(setup.source, package.sources)
    yield from wrong_imports(setup.source, {})
    yield from _undefined(package, setup)
    yield from refused_keywords(setup.source)
    yield from path_faults(setup.source)
    told = {setup.source.at(node.end_lineno) for node, _ in setup.beside.values()}
    yield from (one for one in comma_faults(setup.source, "setup-syntax") if one.place not in told)
    if not _is_called(package, setup):
        cause = "setup.py never calls setup(), so nothing is installed."
        yield Finding("setup-missing", cause, setup.source.shown, "call setup(...) from setuptools")
        return
    yield from keys_twice(setup.source)
    yield from _taken_over(package, setup)
    yield from shape_faults(package, setup, is_for_ros=is_for_ros)
    if is_as_meant:
        package, setup = as_meant(package, setup)
    yield from _package_faults(package, setup)
    yield from _missing_files(package, setup)
    yield from _cfg_form(package)
    yield from _dashes(package)
    if is_for_ros:
        yield from _places_for_ros(package, setup)
        is_library = setup.entry_points == [] and "scripts" not in setup.keywords
        lost = "" if is_library or package.build_type not in (None, "ament_python") else _lost(package)
        yield from _cfg_faults(package, lost) if lost else ()
    yield from entry_point_faults(package, setup)


def _is_called(package: SourcePackage, setup: SetupScript) -> bool:
    """Return whether a setup.py calls setup(), as its text shows or setuptools says; True if neither can be told."""
    body = setup.source.tree.body if setup.source.tree else ()
    if any(setup.call and getattr(statement, "value", None) is setup.call for statement in body):
        return True
    brings_code = setup.source.imports or _BRINGING & names_read(setup.source.nodes)
    may_be_called = package.is_run or bool(setup.source.calls and brings_code)
    return bool(taken_by_setuptools(package).get("is_called", may_be_called))


def _taken_over(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    """Yield a pyproject.toml whose [project] table makes setuptools ignore the entry points of setup.py."""
    text = read_text(package.folder / "pyproject.toml")
    table = read_toml(text).get("project")
    if not isinstance(table, dict) or "entry_points" not in setup.lines:
        return
    if not {*table, *table.get("dynamic", ())} & {"scripts", "entry-points"}:
        cause = "pyproject.toml has a [project] table, so setuptools ignores the entry points in setup.py and installs no executable."
        fix = f"rm {quote(package.shown('pyproject.toml'))}, and build again; or write dynamic = ['scripts', 'entry-points'] into its [project]"
        yield Finding(
            "entry-points-missing",
            cause,
            at(package.shown("pyproject.toml"), line_with(text, "project")),
            fix,
        )


def _undefined(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    for name, node in undefined_names(setup.source):
        cause, fix = meant(setup.source, name, node, package=package.name)
        code = "setup-import" if re.match(r"write `(?:from|import) ", fix) else "name-undefined-in-setup"
        yield Finding(code, cause, setup.source.at(node), fix)


def _package_faults(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    names = package.packages
    if names is None or setup.keywords.get("py_modules"):
        return
    place = at(setup.source.shown, setup.line("packages"))
    for name in names:
        if package.folder_of(name).is_dir():
            continue
        if len(parts := re.findall(r"[\w.]+", name)) > 1:
            cause = f"`packages` holds {name!r}, which is {len(parts)} names in one string; each needs its own quotes."
            written = ", ".join(map(repr, parts))
            yield Finding("package-folder-missing", cause, place, f"write {written} instead of {name!r}")
            return
        if called := alike(package.folder, name.replace(".", "/")):
            cause = f"The folder is called {called}, but setup.py installs the Python package {name}: {differs(called, name)}."
            fix = f"mv {quote(package.shown(called))} {quote(package.shown(name.replace('.', '/')))}, and build again"
            yield Finding("package-folder-missing", cause, place, fix)
            continue
        if "package_dir" in setup.keywords and (package.folder / name.replace(".", "/")).is_dir():
            line = setup.line("package_dir") or line_with(setup.source.text, "package_dir")
            cause = (
                f"package_dir makes setup.py look for {name} in another folder, but it is next to setup.py."
            )
            fix = "remove the line with package_dir"
            yield Finding("package-folder-missing", cause, at(setup.source.shown, line), fix)
            continue
        if name != package.name and package.name in names:
            left = [listed for listed in names if package.folder_of(listed).is_dir()]
            cause = f"setup.py installs the Python package {name}, but there is no folder {name} next to setup.py."
            yield Finding("package-folder-missing", cause, place, f"write packages={left!r}")
            continue
        beside = [path.name for path in package.folder.glob("*.py") if path.name != "setup.py"]
        cause = (
            f"setup.py installs the Python package {name}, but there is no folder {name} next to setup.py"
            + (f" ({', '.join(sorted(beside))} are directly there)." if beside else ".")
        )
        fix = f"create the folder {name} in {package.shown('')} with an empty __init__.py, and put the nodes into it"
        yield Finding("package-folder-missing", cause, place, fix)
    lacking = (name for name in needed_packages(package) if name not in names)
    yield from dict.fromkeys(not_listed(package, setup, name) for name in lacking)


def _missing_files(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    for file in (file for _, files in setup.data_files for file in files):
        path = package.folder / file
        # A file that only has a slightly different name is reported by `shape_faults`.
        if path.exists() or alike(package.folder, file):
            continue
        if lies_elsewhere(package, file) or not like(path):
            yield _missing_file(package, setup, file)


def _places_for_ros(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    """Yield files that are not installed where ROS looks for them."""
    place = at(setup.source.shown, setup.line("data_files"))
    if not setup.are_data_files_known:
        return
    if not any(target == INDEX for target, _ in setup.data_files):
        marker = f"resource/{package.name}"
        made = "" if package.has(marker) else f"{_touched(package, marker)}, and "
        cause = "setup.py does not install the marker file that ROS uses to find the package."
        if package.build_type == "ament_python":  # no other way to build it makes the marker
            cause = f"{cause[:-1]}; colcon does it for you with a warning."
        fix = f"{made}{_added(package, setup, INDEX, marker)}"
        yield Finding("marker-not-installed", cause, place, fix)
    yield from _as_one(package, setup)
    installed = {file for _, files in setup.data_files for file in files}
    # `ros2 launch` finds a file by its name, so a copy of an installed one need not be installed.
    found = {Path(file).name for file in installed}
    for path in package.likely_files:
        relative = path.relative_to(package.folder).as_posix()
        folder = "launch" if path in package.launch_files else relative.partition("/")[0]
        share = f"share/{package.name}"
        target = next((target for target, files in setup.data_files if relative in files), "")
        if (
            target
            and not target.startswith("/")
            and not f"{os.path.normpath(target)}/".startswith(f"{share}/")
        ):
            written, line = setup.written(target)
            cause = f"{relative} is installed into {target}, but ROS looks for it in {share}."
            fix = f"write '{share}/{folder}' instead of {written}, and build again"
            yield Finding("installed-elsewhere", cause, at(setup.source.shown, line), fix, (path.name,))
        is_copy = path in package.launch_files and path.name in found
        if relative not in installed and not is_copy:
            yield _left_out(package, setup, path, folder)


def _as_one(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    """Yield the files of different content that are installed as one."""
    for copy, files in setup.copies(package.folder).items():
        paths = [package.folder / file for file in files]
        if not all(filecmp.cmp(paths[0], path, shallow=False) for path in paths[1:]):
            target, _, name = copy.rpartition("/")
            cause = f"setup.py installs {in_a_row(files)} as one file, {copy}, so only one of them is kept."
            rows = in_a_row([*map(package.row, files)])
            fix = f"install them into folders of their own, such as {rows} in data_files, build again, and read them from there"
            place = at(setup.source.shown, setup.written(target)[1])
            yield Finding("installed-elsewhere", cause, place, fix, (name,))


def _missing_file(package: SourcePackage, setup: SetupScript, file: str) -> Finding:
    """Return a finding that a file to be installed does not exist."""
    is_marker = file == f"resource/{package.name}"
    # The name of the package is on other lines, too.
    word = "resource/" if is_marker else file.rpartition("/")[2]
    line = line_with(setup.source.text, word, start=setup.line("data_files") or 1) or setup.line("data_files")
    place = at(setup.source.shown, line)
    if is_marker:
        cause = f"The file {file}, which ROS uses to find the package, is missing; it is an empty file and easily lost."
        return Finding("marker-missing", cause, place, _touched(package, file))
    cause = f"setup.py installs {file}, but there is no such file."
    fix = f"create the file, or remove {file} from data_files"
    if there := lies_elsewhere(package, file):
        cause = f"setup.py installs {file}, a path that starts in its own folder, but the file is in {there.folder}."
        fix = there.fix
    return Finding("data-file-missing", cause, place, fix, (file.rpartition("/")[2],))


def _touched(package: SourcePackage, file: str) -> str:
    """Return the command that makes an empty file, with its folder if that is missing."""
    folder = file.rpartition("/")[0]
    is_there = (package.folder / folder).is_dir()
    make = "" if is_there else f"mkdir {quote(package.shown(folder))} && "
    return f"{make}touch {quote(package.shown(file))}"


def _added(package: SourcePackage, setup: SetupScript, folder: str, file: str) -> str:
    """Say how to install a file in a folder, with what every package installs if there are no data_files yet."""
    usual = {INDEX: f"resource/{package.name}", f"share/{package.name}": "package.xml"}
    if "data_files" in setup.keywords:
        return f"add ('{folder}', ['{file}']) to data_files"
    rows = [f"('{target}', ['{name}'])" for target, name in (usual | {folder: file}).items()]
    return f"write `data_files=[{', '.join(rows)}],` in setup()"


def _left_out(package: SourcePackage, setup: SetupScript, path: Path, folder: str) -> Finding:
    """Return why a file is not installed: a pattern is misspelt, or no line of setup.py names it."""
    if " " not in path.name and (dead := dead_pattern(package, setup, path)):
        return dead
    relative = path.relative_to(package.folder).as_posix()
    patterns = re.findall(rf"['\"]({folder}/[^'\"]*\*[^'\"]*)['\"]", setup.source.text)
    only = f" (which matches {' and '.join(patterns)})" if patterns else ""
    lost = " and cannot be found" * (folder == "launch")
    cause = f"{relative} is not in data_files in setup.py{only}, so it is not installed{lost}."
    lies_in = relative.rpartition("/")[0]
    target = (
        lies_in if lies_in.startswith(f"{folder}/") else folder
    )  # what lies below a folder stays below it
    fix = f"{_added(package, setup, f'share/{package.name}/{target}', relative)} and build again"
    if " " in path.name:
        cause = (
            f"{relative} is not in data_files in setup.py, so it is not installed; and its name has a space."
        )
        fix = _without_spaces(package, setup, path, folder)
    return Finding(
        "not-in-data-files", cause, at(setup.source.shown, setup.line("data_files")), fix, (path.name,)
    )


def _without_spaces(package: SourcePackage, setup: SetupScript, path: Path, folder: str) -> str:
    """Say how to rename a file whose name has a space, and to install it then."""
    better = path.with_name(re.sub(r" +(?=\.)|(?<=\.) +", "", path.name).strip().replace(" ", "_"))
    relative, new = (file.relative_to(package.folder).as_posix() for file in (path, better))
    row = f", {_added(package, setup, f'share/{package.name}/{folder}', new)}"
    is_matched = any(fnmatchcase(new, pattern.text) for pattern in setup.patterns)
    return f"mv {quote(package.shown(relative))} {quote(package.shown(new))}{'' if is_matched else row}, and build again"


def _cfg_form(package: SourcePackage) -> Iterator[Finding]:
    text = read_text(package.folder / "setup.cfg")
    _, fault = read_cfg(text)
    if fault is not None:
        cause = f"setup.cfg {fault.said}, so setuptools stops."
        slip = cfg_repair(text, _scripts(package))
        line, fix = (slip.line, slip.told) if slip else (fault.line, fault.fix)
        yield Finding("setup-value", cause, at(package.shown("setup.cfg"), line), fix)


def _scripts(package: SourcePackage) -> dict[str, tuple[str, str]]:
    """Return what setup.cfg must say for `ros2 run` to find the executables."""
    folder = f"$base/lib/{meant_name(package)}"
    return {"develop": ("script_dir", folder), "install": ("install_scripts", folder)}


def _cfg_faults(package: SourcePackage, lost: str) -> Iterator[Finding]:
    shown = package.shown("setup.cfg")
    if not package.has("setup.cfg"):
        if into := _kept_out(package, "install"):
            cause = f"setup.cfg is missing, so {lost} {into}."
            yield Finding("setup-cfg-missing", cause, shown, _cfg_fix(package))
        return
    config, fault = read_cfg(read_text(package.folder / "setup.cfg"))
    sections = _scripts(package) if fault is None else {}  # otherwise `_cfg_form` reports it
    found = [one for section in sections for one in _cfg_section(package, config, section, lost)]
    match found:
        case [other, last] if all(re.fullmatch("write `[^`]+`", one.fix) for one in found):
            # Of two wrong lines, the last one decides where colcon installs; mended alone, the other one stays wrong.
            line = other.place.rpartition(":")[2]
            yield replace(last, fix=f"{last.fix}, and on line {line} {other.fix.removeprefix('write ')}")
        case _:
            yield from found


def _kept_out(package: SourcePackage, section: str) -> str:
    """Say into which wrong folder setuptools puts executables, wherever that is set; empty if it is the right one."""
    key, right = _scripts(package)[section]
    folder = str(taken_by_setuptools(package).get(key) or "bin")
    is_right = folder.rstrip("/") == right
    return "" if is_right else f"into {folder.removeprefix('$base/')}, where `ros2 run` does not look"


def _lost(package: SourcePackage) -> str:
    """Say which executables `ros2 run` does not find without a right setup.cfg; empty if none, as far as is known."""
    if package.copied is None:
        return ""
    there = {Path(file).name for file in package.copied if os.access(package.folder / file, os.X_OK)}
    left = [point.name for point in package.points if point.name not in there]
    if package.points and not left:
        return ""
    return f"{' and '.join(left)} {'go' if len(left) > 1 else 'goes'}" if there else "the executables go"


def _cfg_fix(package: SourcePackage) -> str:
    rows = [
        row
        for section, (key, value) in _scripts(package).items()
        for row in (f"[{section}]", f"{key}={value}")
    ]
    return f"write these lines in setup.cfg: {', '.join(f'`{row}`' for row in rows)}"


def _cfg_section(
    package: SourcePackage, config: RawConfigParser, section: str, lost: str
) -> Iterator[Finding]:
    """Yield what is wrong in one section of a setup.cfg."""
    shown, wanted = package.shown("setup.cfg"), f"lib/{meant_name(package)}"
    key, right = _scripts(package)[section]
    dashed, value = key.replace("_", "-"), config.get(section, key, fallback=None)
    if value is None and config.has_option(section, dashed):
        return  # told for the whole file
    options = config.options(section) if config.has_section(section) else []
    near = next((option for option in options if is_near_miss(option, key)), "")
    strange = re.search(r"\$(?!base\b)\w*", value or "")
    if strange:
        cause = f"setuptools has no variable {strange[0]}; in setup.cfg the folder begins with $base."
    elif near:
        cause = f"setup.cfg has {near} in [{section}], but the option is called {key}."
    elif value is None and section == "install":
        cause = f"setup.cfg has no {key} in [{section}], so {lost} {_kept_out(package, section)}."
    elif value is not None and not value.strip().rstrip("/").endswith(wanted):
        cause = f"setup.cfg installs the executables in {value.strip()}, but `ros2 run` looks in {wanted}."
    else:
        return
    if not _kept_out(package, section):
        return
    # The other section may be wrong as well, which is told apart.
    text = read_text(package.folder / "setup.cfg")
    slip = cfg_repair(text, _scripts(package)) or cfg_repair(text, {section: (key, right)})
    line = slip.line if slip else _cfg_line(package, near or key) if near or value else None
    fix = slip.told if slip else f"add two lines at the end of setup.cfg: `[{section}]`, `{key}={right}`"
    yield Finding("setup-cfg-missing", cause, at(shown, line), fix)


_REFUSES_DASHES = "78.0.1"  # the version of setuptools that stops at them; the next one only warns again


def _dashes(package: SourcePackage) -> Iterator[Finding]:
    """Yield the options of a setup.cfg that setuptools reads and that are written with a dash; where it has taken them, that is no fault."""
    config, tool = package.setup_cfg, next(iter(distributions(name="setuptools")), None)
    if not config or not tool or (package.root and prefix_of(package.root, package.name)):
        return
    names = ("metadata", r"options(?!\.(?:extras_require|data_files)$).*", *tool.entry_points.names)
    sections = [name for name in config.sections() if re.fullmatch("|".join(names), name)]
    options = [(section, key) for section in sections for key in config.options(section) if "-" in key]
    rows = [(_cfg_line(package, key, section), key) for section, key in options]
    for line, key in rows[:1]:
        does = f"takes this with a warning, but {_REFUSES_DASHES} stopped at it, and later ones may"
        does = "stops at this" if tool.version == _REFUSES_DASHES else does
        dashed = in_a_row([*dict.fromkeys(key for _, key in rows)])
        cause = f"setup.cfg has {dashed} with a dash, where an underscore belongs: setuptools {tool.version} {does}."
        fix = f"write {key.replace('-', '_')} instead of {key}"
        fix += "".join(f", and on line {n} {key.replace('-', '_')} instead of {key}" for n, key in rows[1:])
        yield Finding("setup-cfg-dashes", cause, at(package.shown("setup.cfg"), line), fix)


def _cfg_line(package: SourcePackage, key: str, section: str = "") -> int | None:
    """Return the line of an option in a section of a setup.cfg, or in any; None if there is none."""
    lines = read_text(package.folder / "setup.cfg").splitlines()
    begin = next((number for number, line in enumerate(lines) if line.startswith(f"[{section}]")), 0)
    rows = enumerate(lines[begin:], begin + 1)
    return next((number for number, line in rows if line.strip().startswith(key)), None)
