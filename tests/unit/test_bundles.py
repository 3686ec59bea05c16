"""The course packed for another place; `make pythons` installs such a folder without a network."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
import yaml

from ros2lab import bundles
from ros2lab.bundles import BundleError


def test_what_is_fetched_for_another_python_is_what_its_lock_names(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Markers are asked of that Python and not of this one, and each package keeps its hashes."""
    (tmp_path / "locks").mkdir()
    (tmp_path / "locks" / "student.txt").write_text(
        "old==1.0 ; python_full_version < '3.11' \\\n    --hash=sha256:aa \\\n    --hash=sha256:bb\n"
        "new==2.0 ; python_full_version >= '3.11' \\\n    --hash=sha256:cc\nall==3.0 \\\n    --hash=sha256:dd\n"
    )
    monkeypatch.setattr(bundles, "_checkout", lambda: tmp_path)
    assert [*bundles.locked("student", "3.10")] == [
        "old==1.0 --hash=sha256:aa --hash=sha256:bb",
        "all==3.0 --hash=sha256:dd",
    ]
    assert [*bundles.locked("student", "3.13")] == ["new==2.0 --hash=sha256:cc", "all==3.0 --hash=sha256:dd"]


def test_nothing_is_replaced_and_nothing_half_made_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder that is there is refused; one whose packages cannot be fetched does not appear."""
    monkeypatch.setattr(bundles, "_pack_course", Path.mkdir)  # it is packed below
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    (tmp_path / "there").mkdir()
    with pytest.raises(BundleError, match="is there already"):
        bundles.offline(tmp_path / "there", ["3.12"], lambda *_: None)
    with pytest.raises(BundleError, match=r"no packages for Python 2\.7"):
        bundles.offline(tmp_path / "new", ["2.7"], lambda *_: None)
    with pytest.raises(BundleError, match=r"pip cannot fetch the packages \(No matching distribution"):
        bundles.offline(tmp_path / "new", ["3.12"], lambda *_: None)
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


def test_gradescope_finds_its_two_scripts_and_no_work_of_anybody(tmp_path: Path) -> None:
    """Both may be run, and they start what is in the zip."""
    bundles.gradescope(tmp_path / "autograder.zip", None)
    with zipfile.ZipFile(tmp_path / "autograder.zip") as archive:
        names = archive.namelist()
        modes = {name: archive.getinfo(name).external_attr >> 16 for name in ("setup.sh", "run_autograder")}
        script = archive.read("setup.sh").decode()
    assert all(mode & 0o111 for mode in modes.values())
    assert "ros2lab/tools/bootstrap.py" in names
    assert "/autograder/source/ros2lab/tools/bootstrap.py" in script
    assert not [name for name in names if name.startswith(("ros2lab/work", "ros2lab/.venv", "ros2lab/.git/"))]


def test_the_workflow_is_yaml_and_names_where_the_course_comes_from(tmp_path: Path) -> None:
    """Written twice it is the same; another file of its name is left alone."""
    path = tmp_path / ".github" / "workflows" / "ros2lab.yml"
    for _ in range(2):
        bundles.github(path, "https://example.org/lab.git", "3.12")
    steps = yaml.safe_load(path.read_text())["jobs"]["grade"]["steps"]
    assert any(
        'clone --quiet --depth 1 "https://example.org/lab.git"' in step.get("run", "") for step in steps
    )
    assert any('"$GITHUB_STEP_SUMMARY" --github -' in step.get("run", "") for step in steps)
    path.write_text("my own")
    with pytest.raises(BundleError, match="is there already"):
        bundles.github(path, "https://example.org/lab.git", "3.12")
    assert path.read_text() == "my own"
