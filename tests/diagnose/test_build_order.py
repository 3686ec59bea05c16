"""Dependencies that would leave colcon no order to build in: what is proposed never closes a ring."""

from __future__ import annotations

from collections.abc import Mapping
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from ros2lab.diagnose.look import Look

SETUP = "from setuptools import setup\n\nsetup(name='NAME', version='1.0.0', packages=['NAME'], data_files=[('share/NAME/launch', ['launch/go.launch.py'])])\n"
MANIFEST = "<package format='3'><name>NAME</name><version>1.0.0</version><description>x</description><maintainer email='a@b.cc'>a</maintainer><license>BSD</license>NEEDS<export><build_type>ament_python</build_type></export></package>"
LAUNCH = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([NODES])\n"

Uses = Mapping[str, tuple[str, str, str]]  # of each package: what it declares, launches and imports


def proposed(root: Path, uses: Uses) -> dict[str, set[str]]:
    """Return what each package is told to declare."""
    for name, (declared, launched, imported) in uses.items():
        folder = root / "src" / name
        (folder / name).mkdir(parents=True)
        (folder / "launch").mkdir()
        nodes = ", ".join(f"Node(package='{other}', executable='talk')" for other in launched.split())
        (folder / "launch/go.launch.py").write_text(LAUNCH.replace("NODES", nodes))
        (folder / "setup.py").write_text(SETUP.replace("NAME", name))
        needs = "".join(f"<depend>{other}</depend>" for other in ["rclpy", *declared.split()])
        (folder / "package.xml").write_text(MANIFEST.replace("NAME", name).replace("NEEDS", needs))
        (folder / name / "__init__.py").touch()
        lines = [f"from {other} import help\n" for other in imported.split()]
        (folder / name / "help.py").write_text("".join(["import rclpy\n", *lines, "\nprint(rclpy)\n"]))
    lacking = ("dependency-launched", "dependency-undeclared")
    told = {name: set[str]() for name in uses}
    for finding in Look(root).findings:
        if finding.code in lacking:
            told[finding.place.split("/")[1]].update(finding.about)
    return told


@pytest.mark.parametrize(
    ("uses", "count"),
    [
        ({"one": ("", "two", ""), "two": ("", "one", "")}, 1),
        ({"one": ("", "two", ""), "two": ("one", "", "")}, 0),
        ({"one": ("", "two", ""), "two": ("", "three", ""), "three": ("", "one", "")}, 2),
        ({"one": ("", "two", ""), "two": ("three", "", ""), "three": ("one", "", "")}, 0),
        ({"one": ("", "", "two"), "two": ("", "", "one")}, 1),
        ({"one": ("", "", "two"), "two": ("", "one", "")}, 1),
        ({"one": ("", "two", "three"), "two": ("", "three", ""), "three": ("", "", "one")}, 3),
        ({"one": ("", "two", ""), "two": ("", "", "")}, 1),
        ({"one": ("two", "three", ""), "two": ("", "", "three"), "three": ("", "", "")}, 2),
    ],
)
def test_no_dependency_that_closes_a_ring_is_proposed(tmp_path: Path, uses: Uses, count: int) -> None:
    told = proposed(tmp_path, uses)
    declared = {name: {*needs.split()} for name, (needs, _, _) in uses.items()}
    TopologicalSorter({name: declared[name] | told[name] for name in uses}).prepare()
    assert sum(map(len, told.values())) == count
