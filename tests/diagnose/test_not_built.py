"""A module that is in src and that Python does not find: setup.py leaves it out, or it was not built since."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.diagnose import of_text
from ros2lab.diagnose.code.listed_packages import not_built
from ros2lab.diagnose.sources.package import SourcePackage

MANIFEST = "<package format='3'><name>bot</name><version>0.0.1</version><description>d</description><maintainer email='a@b.c'>a</maintainer><license>MIT</license><export><build_type>ament_python</build_type></export></package>"
HEAD = "from setuptools import find_packages, setup\npackage_name = 'bot'\nsetup(\n    name=package_name,\n"


def made(folder: Path, given: str, *files: str) -> SourcePackage:
    for name in ("bot/__init__.py", *files):
        path = folder / "src/bot" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("LIMIT = 1\n")
    (folder / "src/bot/package.xml").write_text(MANIFEST)
    (folder / "src/bot/setup.py").write_text(f"{HEAD}    {given},\n)\n")
    return SourcePackage(folder / "src/bot", folder)


INNER = ("bot/inner/__init__.py", "bot/inner/units.py")
LEFT_OUT = [
    ("packages=[package_name]", INNER, "bot.inner", "packages=[package_name, 'bot.inner'],"),
    ("packages=['bot']", INNER, "bot.inner.units", "packages=['bot', 'bot.inner'],"),
    ("packages=['bot']", (*INNER, "bot/inner/si/__init__.py"), "bot.inner", "['bot', 'bot.inner', 'bot.inner.si']"),
    ("packages=find_packages(include=['bot'])", INNER, "bot.inner", "include=['bot', 'bot.inner']"),
    ("packages=find_packages(exclude=['test', '*.inner'])", INNER, "bot.inner", "exclude=['test'])"),
    ("packages=find_packages(exclude=['bot.*'])", INNER, "bot.inner", "`packages=find_packages(),`"),
    ("packages=find_packages()", ("bot/inner/units.py",), "bot.inner", "touch src/bot/bot/inner/__init__.py"),
    ("packages=[package_name]", ("shared/__init__.py", "shared/units.py"), "shared", "[package_name, 'shared']"),
    ("packages=[package_name]", ("limits.py",), "limits", "py_modules=['limits'],"),
    ("packages=['bot'], package_dir={'': 'src'}", ("src/bot/__init__.py", "src/bot/inner/a.py"), "bot.inner", "['bot', 'bot.inner']"),
]  # fmt: skip
BUILT = [
    ("packages=[package_name, 'bot.inner']", INNER, "bot.inner"),
    ("packages=[package_name, package_name + '.inner']", INNER, "bot.inner.units"),
    ("packages=find_packages()", INNER, "bot.inner"),
    ("packages=find_packages(exclude=['test'])", INNER, "bot.inner.units"),
    ("packages=find_packages(include=['bot', 'bot.*'])", INNER, "bot.inner"),
    ("packages=['bot'], py_modules=['limits']", ("limits.py",), "limits"),
    ("packages=listed()", INNER, "bot.inner"),
    ("packages=['bot'], package_dir={'': 'src'}", ("src/bot/__init__.py", "src/bot/a.py"), "bot.a"),
    ("packages=[package_name]", ("bot/limits.py",), "bot.limits"),
    ("packages=[package_name]", (), "numpy"),
]


@pytest.mark.parametrize(("given", "files", "module", "fix"), LEFT_OUT)
def test_what_setup_leaves_out_no_build_installs(
    tmp_path: Path, given: str, files: tuple[str, ...], module: str, fix: str
) -> None:
    found = not_built(made(tmp_path, given, *files), module)
    assert found is not None
    assert found.place.startswith("src/bot/")
    assert fix in found.fix


@pytest.mark.parametrize(
    ("cfg", "fix"),
    [
        ("packages =\n    bot\n", "write bot.inner on a line of its own below bot,"),
        ("packages = find:\n[options.packages.find]\ninclude = bot\n", "and below it bot, bot.inner, each"),
        (
            "packages = find:\n[options.packages.find]\nwhere = bot/away\n",
            "and below it bot, bot.inner, each",
        ),
    ],
)
def test_a_list_in_setup_cfg_is_mended_there(tmp_path: Path, cfg: str, fix: str) -> None:
    package = made(tmp_path, "version='0.0.1'", *INNER)
    (package.folder / "setup.cfg").write_text(f"[options]\n{cfg}")
    found = not_built(package, "bot.inner")
    assert found is not None
    assert found.place == "src/bot/setup.cfg:2"
    assert fix in found.fix


def test_a_search_that_needs_no_init_file_skips_none(tmp_path: Path) -> None:
    package = made(tmp_path, "version='0.0.1'", "bot/inner/units.py")
    find = "[options]\npackages = find_namespace:\n[options.packages.find]\ninclude = bot\n"
    (package.folder / "setup.cfg").write_text(find)
    found = not_built(package, "bot.inner")
    assert found is not None
    assert found.code == "package-not-listed"


@pytest.mark.parametrize("where", ["/usr/lib", "../.."])
def test_nothing_outside_a_package_is_searched(tmp_path: Path, where: str) -> None:
    package = made(tmp_path, f"packages=find_packages({where!r})", *INNER)
    assert package.packages is None
    (package.folder / "setup.cfg").write_text(
        f"[options]\npackages = find:\n[options.packages.find]\nwhere = {where}\n"
    )
    (package.folder / "setup.py").write_text("from setuptools import setup\nsetup()\n")
    assert SourcePackage(package.folder).packages is None


@pytest.mark.parametrize(("given", "files", "module"), BUILT)
def test_what_setup_takes_is_only_to_be_built(
    tmp_path: Path, given: str, files: tuple[str, ...], module: str
) -> None:
    assert not_built(made(tmp_path, given, *files), module) is None


@pytest.mark.parametrize(
    ("given", "code"),
    [("packages=[package_name]", "package-not-listed"), ("packages=find_packages()", "install-stale")],
)
def test_a_build_is_advised_only_where_it_helps(tmp_path: Path, given: str, code: str) -> None:
    made(tmp_path, given, *INNER)
    error = "Traceback (most recent call last):\n  File \"/x/node.py\", line 1, in <module>\n    from bot.inner import units\nModuleNotFoundError: No module named 'bot.inner'\n"
    assert of_text(error, tmp_path)[0].code == code
