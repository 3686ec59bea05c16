"""Which Python packages setup.py lists and so installs, and how to add one that is left out."""

from __future__ import annotations

import ast
import glob
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from shlex import quote

from ros2lab.diagnose.code.bare_imports import finds_more
from ros2lab.diagnose.finding import Finding, at, in_a_row
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.setup_script import SetupScript
from ros2lab.diagnose.sources.spelling import alike
from ros2lab.diagnose.sources.static_value import UNKNOWN, is_known


def not_built(package: SourcePackage, module: str) -> Finding | None:
    """Return why no build installs a module whose file exists; None if a build does, or if not known."""
    setup, names = package.setup, package.packages
    if setup is None or names is None or module == package.name:
        return None
    path, parent = package.folder_of(module), module.rpartition(".")[0]
    if package.folder not in path.parents:
        return None
    if path.is_dir() and any(path.glob("*.py")):
        home = module
    elif path.with_suffix(".py").is_file():
        home = parent
    else:
        return None
    if home:
        is_installed = home in names or _is_package_data(package, home)
        return None if is_installed else not_listed(package, setup, home)
    return _beside_setup(setup, module)


def _beside_setup(setup: SetupScript, module: str) -> Finding | None:
    """Return that setup.py does not install a module next to it; None if it does, or if that is not known."""
    alone = setup.keywords.get("py_modules", [])
    if alone is UNKNOWN or not isinstance(alone, (list, tuple)) or module in alone:
        return None
    return Finding(
        "package-not-listed",
        f"{module}.py lies beside setup.py, and setup.py installs only the folders in its `packages`, so no build installs {module}.",
        at(setup.source.shown, setup.line("py_modules") or setup.line("packages")),
        f"write `py_modules={[*alone, module]!r},` in setup(){' instead' if alone else ''}, and build again",
    )


def not_listed(package: SourcePackage, setup: SetupScript, name: str) -> Finding:
    """Return that setup.py does not install a Python package, nor others that it lacks likewise, and how to change that."""
    names = package.packages or []
    # A package that is listed by name is installed even without an __init__.py.
    cfg = package.setup_cfg
    in_cfg = (
        cfg.get("options", "packages", fallback="").strip() if cfg and setup.line("packages") is None else ""
    )
    search = in_cfg or "find_packages()" * ("find_packages(" in setup.source.text)

    def is_skipped(name: str) -> bool:
        return (
            search in ("find:", "find_packages()") and not (package.folder_of(name) / "__init__.py").is_file()
        )

    if is_skipped(name):
        return _skipped(package, name, search)
    needed = [other for other in needed_packages(package) if not is_skipped(other)]
    lacking = [*dict.fromkeys(other for other in [*needed, name] if other not in names)]
    if in_cfg:
        return _not_in_cfg(package, in_cfg, lacking)
    written = _with(setup, _with_inner(package, lacking))
    fix = f"write {in_a_row([*map(repr, lacking)])} into the list of packages in setup.py"
    if not names:
        fix = f"write packages={lacking!r} instead of what is there"
    elif written:
        fix += f": `packages={written},`"
    return Finding(
        "package-not-listed",
        _not_held("setup.py does", lacking, "`packages`", names),
        at(setup.source.shown, setup.line("packages")),
        f"{fix}, and build again" if names else fix,
    )


def _skipped(package: SourcePackage, name: str, search: str) -> Finding:
    """Return that a search for packages skips a folder without an __init__.py, and how to change that."""
    folder = package.folder_of(name).relative_to(package.folder).as_posix()
    cause = f"The folder {folder} has no __init__.py, so {search} skips it, and an installed program cannot import anything in it."
    called = alike(package.folder, f"{folder}/__init__.py")
    made = f"mv {quote(package.shown(called))}" if called else "touch"
    fix = f"{made} {quote(package.shown(f'{folder}/__init__.py'))}, and build again"
    if package.has(f"{folder}.py"):
        old, new = package.shown(folder), package.shown(f"{folder}_parts")
        cause = f"The folder {folder} and the file {folder}.py are both {name} for Python, which imports the file and nothing of the folder, as it has no __init__.py."
        fix = f"mv {quote(old)} {quote(new)} && touch {quote(new)}/__init__.py, write {name}_parts instead of {name} where something of the folder is imported, and build again"
    return Finding("init-file-missing", cause, package.shown(f"{folder}/__init__.py"), fix)


def _with_inner(package: SourcePackage, lacking: list[str]) -> list[str]:
    """Return Python packages that are not listed with those around them and inside them that are not, either."""
    homes = {s.name if s.is_package else s.name.rpartition(".")[0] for s in package.sources.values()}
    found: list[str] = []
    for name in lacking:
        above = [name[:end] for end, sign in enumerate(name) if sign == "."]
        found += [outer for outer in above if (package.folder_of(outer) / "__init__.py").is_file()]
        found += [name, *sorted(home for home in homes if home.startswith(f"{name}."))]
    return [name for name in dict.fromkeys(found) if name not in (package.packages or ())]


def _not_held(does: str, lacking: list[str], where: str, names: list[str]) -> str:
    """Say which Python packages a list lacks, and what it holds."""
    what = f"package{'s' * (len(lacking) > 1)} {in_a_row(lacking)}"
    return f"{does} not install the Python {what}: {where} holds {', '.join(names) or 'nothing'}."


def _not_in_cfg(package: SourcePackage, in_cfg: str, lacking: list[str]) -> Finding:
    """Return that the `packages` of setup.cfg do not hold some Python packages, and how to change that."""
    names = package.packages or []
    lines = read_text(package.folder / "setup.cfg").splitlines()
    line = next((n for n, text in enumerate(lines, 1) if text.startswith("packages")), None)
    cause = _not_held("setup.cfg does", lacking, "its `packages`", names)
    if in_cfg.startswith("find"):
        each = ", ".join([*names, *lacking])
        fix = f"write `packages =` instead of `packages = {in_cfg}`, and below it {each}, each on an indented line of its own, and build again"
    else:
        own = "on a line of its own" if len(lacking) == 1 else "each on a line of its own,"
        fix = f"write {in_a_row(lacking)} {own} below {names[-1]}, as far to the right, and build again"
    return Finding("package-not-listed", cause, at(package.shown("setup.cfg"), line), fix)


def _with(setup: SetupScript, names: list[str]) -> str:
    """Return the `packages` of setup() with more names; empty if it is neither a list nor a call."""
    match setup.given("packages"):
        case ast.List(elts=[*known]):
            return ast.unparse(ast.List([*known, *map(ast.Constant, names)], ast.Load()))
        case ast.Call(func=func, args=args, keywords=[*keywords]):
            kept = [new for keyword in keywords if (new := _taking(keyword, names))]
            return ast.unparse(ast.Call(func, args, kept))
    return ""


def _taking(keyword: ast.keyword, names: list[str]) -> ast.keyword | None:
    """Return a keyword argument of find_packages(), changed to find some names; None if nothing is left."""
    if not isinstance(keyword.value, (ast.List, ast.Tuple)) or keyword.arg not in ("include", "exclude"):
        return keyword
    patterns = keyword.value.elts
    if keyword.arg == "include":
        patterns = [*patterns, *map(ast.Constant, names)]
    else:
        texts = {pattern: str(getattr(pattern, "value", "")) for pattern in patterns}
        patterns = [
            pattern for pattern in patterns if not any(fnmatchcase(name, texts[pattern]) for name in names)
        ]
    return ast.keyword(keyword.arg, ast.List(patterns, ast.Load())) if patterns else None


def needed_packages(package: SourcePackage) -> Iterator[str]:
    """Yield the Python packages to install: that of the package's name, and those that programs and what is installed import."""
    inner = package.folder / package.name
    is_own = inner.is_dir() and any(map(_has_code, inner.glob("*.py"))) and not package.package_dirs
    waiting = [*(package.packages or ()), *([package.name] if is_own else [])]
    waiting += [home for point in package.points for home in _homes_of(package, point.module)]
    files = [*package.sources.values()]
    is_elsewhere = finds_more(package)
    seen: set[str] = set()
    while waiting:
        home = waiting.pop(0)
        if home in seen:
            continue
        seen.add(home)
        yield home
        own = (s for s in files if home == (s.name if s.is_package else s.name.rpartition(".")[0]))
        for imported in (imported for source in own for imported in source.imports):
            # What is imported from a module may be a module, too.
            named = [imported.target, *([imported.target.rpartition(".")[0]] if imported.is_from else [])]
            homes = (home for name in named for home in _homes_of(package, name))
            waiting += [
                home
                for home in homes
                if not (is_elsewhere and _is_data(package, home)) and not _is_package_data(package, home)
            ]


def _homes_of(package: SourcePackage, named: str) -> Iterator[str]:
    """Yield the Python packages among the files of a package that must be installed for a module to be imported."""
    name, _, module = named.rpartition(".")
    folder = package.folder_of(name)
    if name and package.folder in folder.parents and (folder / f"{module}.py").is_file():
        yield name
    if package.folder in folder.parents and (folder / module / "__init__.py").is_file():
        yield named


def _is_data(package: SourcePackage, name: str) -> bool:
    """Return whether setup.py installs the files of a Python package as data, or may do so."""
    setup, folder = package.setup, package.folder_of(name).relative_to(package.folder).as_posix()
    files = (file for _, files in setup.data_files for file in files) if setup else ()
    is_open = setup is not None and not setup.are_data_files_known
    return is_open or any(file.startswith(f"{folder}/") for file in files)


def _is_package_data(package: SourcePackage, name: str) -> bool:
    """Return whether setup.py installs modules of a folder as files of the packages that it lists, or may do so."""
    keywords = package.setup.keywords if package.setup else {}
    given = keywords.get("package_data") or {}
    if (keywords.get("include_package_data") and package.has("MANIFEST.in")) or not is_known(given):
        return True
    inner = {*map(str, package.folder_of(name).glob("*.py"))}
    for home in package.packages or ():
        patterns = [*given.get("", ()), *given.get("*", ()), *given.get(home, ())]
        for found in (package.folder_of(home) / pattern for pattern in patterns):
            if not inner.isdisjoint(glob.glob(str(found), recursive=True)):  # noqa: PTH207 -- a pattern may be one that Path refuses
                return True
    return False


def _has_code(path: Path) -> bool:
    """Return whether a file is more than an __init__.py without a statement, of which nothing is missed."""
    try:
        body = ast.parse(read_text(path)).body if path.name == "__init__.py" else [ast.Pass()]
    except (SyntaxError, ValueError):
        return True
    return any(
        not (isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant))
        for statement in body
    )
