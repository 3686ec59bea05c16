"""The broken package of `03_packages`; right and wrong answers are in `answers/packages.yaml`."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab.checks import packages


def test_the_broken_package_of_a_student_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was fixed is not broken again."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    packages.make_broken_package()
    lost = [tmp_path / "packages_ws" / "src" / "lamp_driver" / name for name in packages.LOST_FILES]
    assert not any(file.exists() for file in lost)
    for file in lost:
        file.touch()
    packages.make_broken_package()
    assert all(file.exists() for file in lost)
