"""A file that is named in one place and lies in another one."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace

NAME = NAMES[1]
ROW = "('share/' + package_name, ['package.xml']),"
SRC = f"src/{NAME.package}"


def installing(tmp_path: Path, named: str, lies: str) -> Path:
    """Write a workspace whose setup.py installs a file under another path than its own."""
    files = Files.right(NAME).put(lies, "a: 1\n")
    files.change("setup.py", ROW, f"{ROW}\n        ('share/{NAME.package}/data', ['{named}']),")
    return files.write(tmp_path)


@pytest.mark.parametrize(
    ("named", "lies"),
    [
        ("data/a.csv", f"{NAME.package}/data/a.csv"),
        ("launch/b.launch.xml", f"{NAME.package}/launch/b.launch.xml"),
        ("launch/b.txt", "b.txt"),
        ("b.txt", "docs/b.txt"),
        ("rviz/view.rviz", "config/views/view.rviz"),
    ],
)
def test_both_remedies_bring_it_there(tmp_path: Path, named: str, lies: str) -> None:
    root = installing(tmp_path, named, lies)
    text = f"error: can't copy '{named}': doesn't exist or not a regular file\n"
    found = of_text(text, root)[0]
    folder = f"{SRC}/{lies}".rpartition("/")[0]
    assert found.code == "data-file-missing"
    assert f"the file is in {folder}/" in found.cause
    assert f"name it as {lies!r}" in found.fix
    assert found.place.startswith(f"{SRC}/setup.py:")
    subprocess.run(found.fix.partition(";")[0], shell=True, cwd=root, check=True)
    assert (root / SRC / named).is_file()
    assert "data-file-missing" not in {one.code for one in of_workspace(root)}


def test_a_file_of_another_package_is_copied(tmp_path: Path) -> None:
    root = installing(tmp_path, "rviz/view.rviz", "a.txt")
    other = root / "src/shown"
    (other / "rviz").mkdir(parents=True)
    (other / "rviz/view.rviz").write_text("")
    manifest = (root / SRC / "package.xml").read_text()
    (other / "package.xml").write_text(manifest.replace(NAME.package, "shown"))
    found = next(one for one in of_workspace(root) if one.code == "data-file-missing")
    wanted = f"mkdir -p {SRC}/rviz && cp src/shown/rviz/view.rviz {SRC}/rviz/view.rviz; then build again"
    assert found.fix == wanted


def test_the_same_name_elsewhere_is_nearer_than_another_name_here(tmp_path: Path) -> None:
    root = installing(tmp_path, "maps/room.yaml", "room.yaml")
    (root / SRC / "maps").mkdir()
    (root / SRC / "maps/room.pgm").write_text("")
    found = next(one for one in of_workspace(root) if one.code == "data-file-missing")
    assert found.fix.startswith(f"mv {SRC}/room.yaml {SRC}/maps/room.yaml;")


@pytest.mark.parametrize("lies", ["", "test/a.csv", "build/data/a.csv"])
def test_what_lies_nowhere_is_to_be_made(tmp_path: Path, lies: str) -> None:
    root = installing(tmp_path, "data/a.csv", lies or "README")
    found = next(one for one in of_workspace(root) if one.code == "data-file-missing")
    assert found.fix == "create the file, or remove data/a.csv from data_files"


def test_a_readme_of_another_package_is_not_meant(tmp_path: Path) -> None:
    root = installing(tmp_path, "README.md", "a.txt")
    other = root / "src/shown"
    other.mkdir()
    (other / "README.md").write_text("")
    (other / "package.xml").write_text(
        (root / SRC / "package.xml").read_text().replace(NAME.package, "shown")
    )
    found = next(one for one in of_workspace(root) if one.code == "data-file-missing")
    assert "shown" not in found.fix


def test_what_setup_reads_is_looked_for_from_its_own_folder_on(tmp_path: Path) -> None:
    root = installing(tmp_path, "a.txt", "a.txt")
    (root / SRC / "docs").mkdir()
    (root / SRC / "docs/intro.md").write_text("")
    setup = root / SRC / "setup.py"
    setup.write_text(f"text = open('intro.md').read()\n{setup.read_text()}")
    text = f"Traceback (most recent call last):\n  File \"{setup}\", line 1, in <module>\n    text = open('intro.md').read()\nFileNotFoundError: [Errno 2] No such file or directory: 'intro.md'\n"
    found = of_text(text, root)[0]
    assert (
        found.fix
        == f"mv {SRC}/docs/intro.md {SRC}/intro.md; or name it as 'docs/intro.md' in this line; then build again"
    )
