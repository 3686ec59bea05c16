"""Programs that an earlier build left, and the commands that remove them."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.sources.interfaces import INDEX

PACKAGE = NAMES[0].package
SCRIPT = "#!/usr/bin/python3\n# 'console_scripts'\n"


def left_over(root: Path, *programs: str) -> list[Finding]:
    """Install some programs, and return what is told to be left over."""
    prefix = root / "install" / PACKAGE
    (prefix / INDEX).mkdir(parents=True)
    (prefix / INDEX / PACKAGE).touch()
    lib = prefix / "lib" / PACKAGE
    lib.mkdir(parents=True)
    for program in programs:
        (lib / program).write_text(SCRIPT)
    return [finding for finding in Look(root).findings if finding.code == "left-over"]


@pytest.mark.parametrize("name", ["old_node", "old node", "anna's_node", "old = p.m:main"])
def test_a_program_without_an_entry_point_is_removed_by_its_own_name(tmp_path: Path, name: str) -> None:
    (found,) = left_over(Files.right(NAMES[0]).write(tmp_path), name, NAMES[0].module)
    command = shlex.split(found.fix.partition(";")[0])
    assert command == ["rm", f"install/{PACKAGE}/lib/{PACKAGE}/{name}"]


def test_a_program_with_an_entry_point_is_not_left_over(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    assert not left_over(files.write(tmp_path), NAMES[0].module, NAMES[0].listener, NAMES[0].driver)


@pytest.mark.parametrize(
    "change",
    [
        (f":main',\n            '{NAMES[0].listener}", f":main'\n            '{NAMES[0].listener}"),
        (f"'{NAMES[0].module} = ", f"'{NAMES[0].module}: old = "),
        (f"{NAMES[0].module}:main'", f"{NAMES[0].module}:main main'"),
    ],
)
def test_which_program_an_odd_entry_point_makes_is_not_guessed(
    tmp_path: Path, change: tuple[str, str]
) -> None:
    files = Files.right(NAMES[0]).change("setup.py", *change)
    made = f"{NAMES[0].module} = {PACKAGE}.{NAMES[0].module}:main{NAMES[0].listener}"
    assert not left_over(files.write(tmp_path), made, NAMES[0].driver)


@pytest.mark.parametrize(
    ("listed", "does"),
    [
        ("", "can still be started"),
        ("[console_scripts]\nold = p.old:main\n", "can still be started"),
        ("[console_scripts]\nnew = p.old:main\n", "ends in StopIteration"),
    ],
)
def test_what_starting_it_does_is_told_by_what_was_built_last(tmp_path: Path, listed: str, does: str) -> None:
    root = Files.right(NAMES[0]).write(tmp_path)
    built = root / "install" / PACKAGE / "lib/python3.11/site-packages" / f"{PACKAGE}-0.1.0-py3.11.egg-info"
    built.mkdir(parents=True)
    (built / "entry_points.txt").write_text(listed)
    (found,) = left_over(root, "old")
    assert does in found.cause
    assert NAMES[0].listener in found.cause


@pytest.mark.parametrize(("name", "is_told"), [(NAMES[0].module, True), ("others", False)])
def test_an_installed_folder_that_hides_a_file_is_removed(
    tmp_path: Path, name: str, *, is_told: bool
) -> None:
    root = Files.right(NAMES[0]).write(tmp_path)
    old = root / "install" / PACKAGE / "lib/python3.11/site-packages" / PACKAGE / name
    old.mkdir(parents=True)
    (old / "__init__.py").touch()
    assert not left_over(root)
    told = [finding.fix for finding in Look(root).findings if "left over" in finding.cause]
    fix = f"rm -r build/{PACKAGE} {old.relative_to(root)}, then colcon build --packages-select {PACKAGE}"
    assert told == [fix] * is_told


HOOKS = f"install/{PACKAGE}/share/{PACKAGE}/hook"


@pytest.mark.parametrize(("name", "is_told"), [("pythonpath.sh", False), ("old.sh", True)])
def test_what_colcon_puts_into_a_folder_of_data_files_is_not_left_over(
    tmp_path: Path, name: str, *, is_told: bool
) -> None:
    files = Files.right(NAMES[0]).put("hook/site.sh", "")
    files.change("setup.py", "data_files=[", f"data_files=[('share/{PACKAGE}/hook', ['hook/site.sh']),")
    files.texts |= {f"{HOOKS}/{name}": "", f"{HOOKS}/site.sh": ""}
    files.texts[f"install/{PACKAGE}/share/{PACKAGE}/package.dsv"] = (
        f"source;share/{PACKAGE}/hook/pythonpath.sh\n"
    )
    told = left_over(files.write(tmp_path))
    assert [finding.place for finding in told] == [f"{HOOKS}/{name}"] * is_told


@pytest.mark.parametrize(
    ("bath", "bed", "installed", "codes"),
    [
        ("1", "2", "2", ["installed-elsewhere"]),
        ("1", "2", "1", ["installed-elsewhere"]),
        ("1", "2", "0", ["installed-elsewhere", "install-stale"]),
        ("1", "1", "1", []),
        ("1", "1", "2", ["install-stale"]),
    ],
)
def test_a_copy_of_one_of_two_files_is_not_stale(
    tmp_path: Path, bath: str, bed: str, installed: str, codes: list[str]
) -> None:
    files = Files.right(NAMES[0]).put("config/bath/night.yaml", bath).put("config/bed/night.yaml", bed)
    row = f"('share/{PACKAGE}/config', ['config/bath/night.yaml', 'config/bed/night.yaml'])"
    files.change("setup.py", "data_files=[", f"data_files=[{row},")
    files.texts[f"install/{PACKAGE}/share/{PACKAGE}/config/night.yaml"] = installed
    root = files.write(tmp_path)
    left_over(root)
    told = [finding for finding in Look(root).findings if "night.yaml" in finding.about]
    assert [finding.code for finding in told] == codes
    assert all(f"('share/{PACKAGE}/config/bed', [" in finding.fix for finding in told[:1] if bath != bed)
