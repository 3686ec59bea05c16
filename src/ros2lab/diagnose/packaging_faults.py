"""What is wrong with a package's setup.py, its setup.cfg, and the files that they name."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from ros2lab.diagnose.expression_faults import path_faults
from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.imports import undefined_names
from ros2lab.diagnose.installed import INDEX
from ros2lab.diagnose.package import SourcePackage
from ros2lab.diagnose.python_source import PythonSource, read_text
from ros2lab.diagnose.setup_script import EntryPoint, SetupScript
from ros2lab.diagnose.setup_shapes import like, shape_faults
from ros2lab.diagnose.spelling import did_you_mean, nearest
from ros2lab.diagnose.syntax import syntax_finding


def packaging_faults(package: SourcePackage) -> Iterator[Finding]:
    """Yield what is wrong with how an ament_python package is put together."""
    setup = package.setup
    if setup is None:
        return
    if setup.source.tree is not None and setup.source.fault:
        yield syntax_finding("setup-syntax", setup.source)
        return
    yield from _undefined(setup)
    yield from path_faults(setup.source)
    if not setup.is_called:
        yield Finding(
            "setup-missing",
            "setup.py never calls setup(), so nothing is installed.",
            setup.source.shown,
            "call setup(...) from setuptools",
        )
        return
    yield from shape_faults(package, setup)
    yield from _package_faults(package, setup)
    yield from _data_file_faults(package, setup)
    if package.build_type in (None, "ament_python"):
        yield from _cfg_faults(package)
    yield from _entry_point_faults(package, setup)


def _undefined(setup: SetupScript) -> Iterator[Finding]:
    lines = {
        "os": "import os",
        "glob": "from glob import glob",
        "find_packages": "from setuptools import find_packages",
    }
    for name, node in undefined_names(setup.source):
        is_import = name in lines or name in sys.stdlib_module_names or name == "setup"
        line = lines.get(name, "from setuptools import setup" if name == "setup" else f"import {name}")
        yield Finding(
            "setup-import" if is_import else "name-undefined-in-setup",
            f"setup.py uses {name} and never imports or defines it.",
            setup.source.at(node),
            f"write `{line}` at the top of setup.py"
            if is_import
            else f"define {name} above this line, or fix its spelling",
        )


def _package_faults(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    names = package.packages
    if names is None or setup.keywords.get("py_modules"):
        return
    place = at(setup.source.shown, setup.line("packages"))
    for name in names:
        if _folder_of(package, name).is_dir():
            continue
        if "package_dir" in setup.keywords and (package.folder / name.replace(".", "/")).is_dir():
            yield Finding(
                "package-folder-missing",
                f"package_dir lets setup.py look for {name} in another folder, and it lies beside setup.py.",
                at(setup.source.shown, setup.line("package_dir")),
                "take the line with package_dir away",
            )
            continue
        beside = [path.name for path in package.folder.glob("*.py") if path.name != "setup.py"]
        yield Finding(
            "package-folder-missing",
            f"setup.py installs the Python package {name}, and there is no folder {name} beside setup.py"
            + (f" ({', '.join(sorted(beside))} lie there directly)." if beside else "."),
            place,
            f"make the folder {name} in {package.shown('')}, with an empty __init__.py, and put the nodes into it",
        )
    for name in dict.fromkeys(_needed_packages(package, setup)):
        if name in names:
            continue
        folder = _folder_of(package, name).relative_to(package.folder).as_posix()
        # With its name written out, setuptools installs a folder without __init__.py, too.
        if "find_packages(" in setup.source.text and not package.has(f"{folder}/__init__.py"):
            yield Finding(
                "init-file-missing",
                f"The folder {folder} has no __init__.py, so find_packages() passes it over and nothing of it is installed.",
                package.shown(f"{folder}/__init__.py"),
                f"touch {package.shown(folder)}/__init__.py, and build again",
            )
        else:
            yield Finding(
                "package-not-listed",
                f"setup.py does not install the Python package {name}: `packages` holds {', '.join(names) or 'nothing'}.",
                place,
                f"write {name!r} into the list of packages in setup.py",
            )


def _needed_packages(package: SourcePackage, setup: SetupScript) -> Iterator[str]:
    """Yield the Python packages whose modules lie there: the one that all have, and those of the entry points."""
    inner = package.folder / package.name
    if inner.is_dir() and any(inner.glob("*.py")) and not package.package_dirs:
        yield package.name
    for point in setup.entry_points or ():
        name, _, module = point.module.rpartition(".")
        folder = _folder_of(package, name)
        if name and package.folder in folder.parents and (folder / f"{module}.py").is_file():
            yield name


def _folder_of(package: SourcePackage, name: str) -> Path:
    mapping = package.package_dirs
    if name in mapping:
        return package.folder / mapping[name]
    top, _, rest = name.partition(".")
    base = package.folder / mapping[top] if top in mapping else package.folder / mapping.get("", "") / top
    return base.joinpath(*rest.split(".")) if rest else base


def _data_file_faults(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    data_files = setup.data_files
    place = at(setup.source.shown, setup.line("data_files"))
    for _, files in data_files:
        for file in files:
            if (package.folder / file).exists() or like(package.folder / file):
                continue  # what is near is told of its shape
            is_marker = file == f"resource/{package.name}"
            # The package's own name stands on other lines, too.
            word = "resource/" if is_marker else file.rpartition("/")[2]
            line = _line_with(setup.source, word, setup.line("data_files"))
            yield Finding(
                "marker-missing" if is_marker else "data-file-missing",
                f"The file {file}, by which ROS knows the package, is missing; it is empty and easily lost."
                if is_marker
                else f"setup.py installs {file}, and there is no such file.",
                at(setup.source.shown, line) if line else place,
                f"touch {package.shown('resource')}/{package.name}"
                if is_marker
                else f"make the file, or take {file} out of data_files",
            )
    if not setup.are_data_files_known:
        return
    if not any(target == INDEX for target, _ in data_files):
        yield Finding(
            "marker-not-installed",
            "setup.py does not install the marker by which ROS finds the package; colcon does it for you with a warning.",
            place,
            f"add ('{INDEX}', ['resource/{package.name}']) to data_files",
        )
    installed = {file for _, files in data_files for file in files}
    for path in package.likely_files:
        relative = path.relative_to(package.folder).as_posix()
        folder = relative.partition("/")[0] if "/" in relative else "launch"
        target = next((target for target, files in data_files if relative in files), "")
        share = f"share/{package.name}"
        if target and not target.startswith("/") and f"{target}/".startswith(f"{share}/") is False:
            yield Finding(
                "installed-elsewhere",
                f"{relative} is installed into {target}, and ROS looks for it in {share}.",
                place,
                f"write 'share/{package.name}/{folder}' in place of {target!r}, and build again",
            )
        if relative not in installed:
            patterns = re.findall(rf"['\"]({folder}/[^'\"]*\*[^'\"]*)['\"]", setup.source.text)
            only = f" (which takes {' and '.join(patterns)})" if patterns else ""
            yield Finding(
                "not-in-data-files",
                f"{relative} is not in data_files of setup.py{only}, so it is not installed and cannot be found.",
                place or setup.source.shown,
                f"add ('share/{package.name}/{folder}', ['{relative}']) to data_files and build again",
            )


def _line_with(source: PythonSource, word: str, start: int | None) -> int | None:
    lines = source.text.splitlines()
    return next((n for n in range(start or 1, len(lines) + 1) if word in lines[n - 1]), None)


def _cfg_faults(package: SourcePackage) -> Iterator[Finding]:
    shown = package.shown("setup.cfg")
    wanted = f"lib/{package.name}"
    fix = f"write in setup.cfg: [develop] script_dir=$base/{wanted} and [install] install_scripts=$base/{wanted}"
    lost = "the executables go to bin, where `ros2 run` does not look"
    config = package.setup_cfg
    if config is None:
        why = "cannot be read" if package.has("setup.cfg") else "is missing"
        yield Finding("setup-cfg-missing", f"setup.cfg {why}, so {lost}.", shown, fix)
        return
    for section, key in (("develop", "script_dir"), ("install", "install_scripts")):
        dashed = key.replace("_", "-")
        value = config.get(section, key, fallback=None)
        if value is None and config.has_option(section, dashed):
            yield Finding(
                "setup-cfg-dashes",
                f"setup.cfg writes {dashed}, and setuptools wants {key} with an underscore.",
                at(shown, _cfg_line(package, dashed)),
                f"write {key} in place of {dashed}",
            )
        elif value is None and section == "install":
            yield Finding(
                "setup-cfg-missing", f"setup.cfg has no {key} in [{section}], so {lost}.", shown, fix
            )
        elif value is not None and not value.strip().rstrip("/").endswith(wanted):
            yield Finding(
                "setup-cfg-missing",
                f"setup.cfg installs the executables in {value.strip()}, and `ros2 run` looks in {wanted}.",
                at(shown, _cfg_line(package, key)),
                fix,
            )


def _cfg_line(package: SourcePackage, key: str) -> int | None:
    lines = read_text(package.folder / "setup.cfg").splitlines()
    return next((number for number, line in enumerate(lines, 1) if line.strip().startswith(key)), None)


def _entry_point_faults(package: SourcePackage, setup: SetupScript) -> Iterator[Finding]:
    groups, points = setup.groups, setup.entry_points
    place = at(setup.source.shown, setup.line("entry_points"))
    if (
        groups is not None
        and (wrong := nearest("console_scripts", groups, 0.8))
        and "console_scripts" not in groups
    ):
        yield Finding(
            "entry-points-key",
            f"setup.py writes {wrong!r} in entry_points, and the key is 'console_scripts', so no executable is installed.",
            place,
            "write 'console_scripts' with an s",
        )
    elif points == [] and (main := _first_main(package)):
        yield Finding(
            "entry-points-missing",
            f"setup.py has no entry point, so {main} cannot be run with `ros2 run`.",
            place,
            f"add '{main.rpartition('.')[2]} = {main}:main' to 'console_scripts' in entry_points",
        )
    seen: dict[str, EntryPoint] = {}
    for point in points or ():
        first = seen.setdefault(point.name, point) if point.name else point
        if first is not point:
            yield _named_twice(setup, point, first)
        else:
            yield from _entry_point_fault(package, setup, point)


def _first_main(package: SourcePackage) -> str | None:
    for name, source in package.sources.items():
        if "rclpy" in source.names and any(
            isinstance(n, ast.FunctionDef) and n.name == "main" for n in source.tree.body
        ):
            return name
    return None


def _named_twice(setup: SetupScript, point: EntryPoint, first: EntryPoint) -> Finding:
    is_same = (point.module, point.function) == (first.module, first.function)
    return Finding(
        "entry-point-twice",
        f"The executable {point.name} is named twice in entry_points, so setuptools refuses setup.py.",
        at(setup.source.shown, point.line),
        f"remove this line: line {first.line} says the same"
        if is_same
        else "give one of the two another name",
    )


def _unnamed(package: SourcePackage, wanted: Path) -> str | None:
    """Return the only file of a folder that no entry point names, and which may be the one that is meant."""
    setup = package.setup
    named = {point.module.rpartition(".")[2] for point in (setup.entry_points if setup else None) or ()}
    text = setup.source.text if setup else ""
    files = [path for path in wanted.parent.glob("*.py") if path.stem not in {*named, "__init__"}]
    alone = [path.name for path in files if path.stem not in text and "def main" in read_text(path)]
    return (
        alone[0] if len(alone) == 1 and set(alone[0][:-3].split("_")) & set(wanted.stem.split("_")) else None
    )


def _entry_point_fault(package: SourcePackage, setup: SetupScript, point: EntryPoint) -> Iterator[Finding]:
    place = at(setup.source.shown, point.line)
    if not point.module:
        yield _wrong_form(package, point, place)
        return
    if point.module.partition(".")[0] in sys.stdlib_module_names | {"rclpy", "launch"}:
        return
    sources = package.sources
    source = sources.get(point.module)
    tops = {name.partition(".")[0] for name in sources} | set(package.packages or ())
    if source is None and sources and package.packages is not None and not setup.keywords.get("py_modules"):
        is_own = point.module.partition(".")[0] in tops
        whole_names = [name for name in sources if name != package.name]
        wanted = package.folder.joinpath(*point.module.split(".")).with_suffix(".py")
        beside = package.folder / wanted.name
        near = like(wanted) or _unnamed(package, wanted)
        lies = beside if beside.is_file() else wanted.parent / near if near else None
        if lies is not None:
            shown = [package.shown(str(path.relative_to(package.folder))) for path in (lies, wanted)]
            yield Finding(
                "entry-point-module",
                f"The executable {point.name} names the module {point.module}, whose file is {shown[1]}; there is {shown[0]} in its place.",
                place,
                f"mv {shown[0]} {shown[1]}, then colcon build --packages-select {package.name}",
            )
            return
        yield Finding(
            "entry-point-module",
            f"The executable {point.name} names the module {point.module}, and "
            + ("there is no such file." if is_own else "no such package is in this folder.")
            + did_you_mean(point.module, whole_names),
            place,
            "write the module as the file is called, or the file as the module is called, and build again",
        )
    elif not point.function:
        yield Finding(
            "entry-point-no-function",
            f"The executable {point.name} names the module {point.module} and no function in it.",
            place,
            f"write '{point.name} = {point.module}:{_meant_function(package, point.module)}'",
        )
    elif source is not None and any(
        isinstance(n, ast.ClassDef) and n.name == point.function for n in source.tree.body
    ):
        yield Finding(
            "entry-point-function",
            f"The executable {point.name} calls the class {point.function}, and must call a function that runs a node of it.",
            place,
            f"write '{point.name} = {point.module}:main', and define main() in {source.shown}: init, {point.function}(), spin",
        )
    elif source is not None and not source.fault and not _has(source, point.function):
        yield _missing_function(source, sources, point, place)


def _missing_function(
    source: PythonSource, sources: Mapping[str, PythonSource], point: EntryPoint, place: str
) -> Finding:
    """Return what is to be said of an entry point whose module has not the function that it names."""
    calls = f"The executable {point.name} calls {point.function}() in {source.shown}, and"
    homes = [name for name, one in sources.items() if not one.fault and _has(one, point.function)]
    if homes:
        meant = next((name for name in homes if name.rpartition(".")[2] == point.name), homes[0])
        cause = f"{calls} it stands in {', '.join(homes)}."
        return Finding(
            "entry-point-function", cause, place, f"write '{point.name} = {meant}:{point.function}'"
        )
    define = f"define {point.function}(args=None)"
    functions = [
        one.name for one in source.tree.body if isinstance(one, (ast.FunctionDef, ast.AsyncFunctionDef))
    ]
    if not functions:
        what = "there is no such function." if source.text.strip() else "the file is empty."
        fix = f"{define} in {source.shown}, or write the function's right name in setup.py"
        return Finding("entry-point-function", f"{calls} {what}", source.at(1), fix)
    return Finding(
        "entry-point-function",
        f"{calls} there is no such function.{did_you_mean(point.function, functions)}",
        place,
        f"write the function that is meant in setup.py ({source.shown} has {', '.join(functions)}), or {define} there",
    )


def _has(source: PythonSource, function: str) -> bool:
    _ = source.tree
    if source.fault:
        return True
    bound = {
        node.id for node in source.nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    names = set(source.names) | bound
    return function.partition(".")[0] in names or any(one.local == "*" for one in source.imports)


def _wrong_form(package: SourcePackage, point: EntryPoint, place: str) -> Finding:
    name, _, rest = point.text.partition("=")
    if rest.count("=") >= 1:
        return Finding(
            "entry-point-comma",
            f"Between two entry points a comma is missing, so Python makes one text of them: {point.text!r}.",
            place,
            "put a comma behind each entry point",
        )
    if "/" in point.text:
        why = "has a slash where a dot belongs"
    elif "(" in point.text:
        why = "calls the function with parentheses, and only its name belongs there"
    elif not rest:
        why = "has no `=` between the executable and the module"
    elif point.text.count(":") > 1:
        why = "has two colons"
    else:
        why = "is not of the form `name = package.module:function`"
    module = re.sub(r"[^\w.]", "", rest.replace("/", ".").partition(":")[0]).removesuffix(".py")
    if not rest:
        name, _, module = point.text.partition(":")
        module = module.partition(":")[0].strip()
    module = module or f"{package.name}.{name.strip()}"
    written = point.text.rpartition(":")[2] if ":" in point.text else ""
    return Finding(
        "entry-point-spec",
        f"The entry point {point.text!r} {why}.",
        place,
        f"write '{name.strip()} = {module}:{_meant_function(package, module, written)}'",
    )


def _meant_function(package: SourcePackage, module: str, written: str = "") -> str:
    """Return the function that an entry point is to call: the one that is written, or the only one there is."""
    if name := re.fullmatch(r"\s*(\w+)\s*(\(.*\)\s*)?", written):
        return name[1]
    source = package.sources.get(module)
    functions = [n.name for n in source.tree.body if isinstance(n, ast.FunctionDef)] if source else []
    return functions[0] if len(functions) == 1 else "main"
