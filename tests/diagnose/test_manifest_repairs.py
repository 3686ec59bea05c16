"""A package.xml that cannot be read: what is told makes it readable, and where that is not known nothing is made up."""

from __future__ import annotations

from pathlib import Path

import pytest
from catkin_pkg.package import parse_package_string
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.xml_repairs import repaired

MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>my_bot</name>
  <version>0.0.0</version>
  <description>A robot.</description>
  <maintainer email="ida@example.org">Ida</maintainer>
  <license>MIT</license>
  <!-- what it needs -->
  <depend>std_msgs</depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""


@pytest.mark.parametrize(
    ("old", "new", "line", "written"),
    [
        ("A robot.", "Doors & gates", 5, "<description>Doors &amp; gates</description>"),
        ("A robot.", "speed < 2", 5, "<description>speed &lt; 2</description>"),
        ("<depend>std_msgs</depend>", "<depend>std_msgs<depend>", 9, "<depend>std_msgs</depend>"),
        ("<depend>std_msgs</depend>", "<depend>std_msgs", 9, "<depend>std_msgs</depend>"),
        ("<depend>std_msgs</depend>", "<<depend>std_msgs</depend>", 9, "<depend>std_msgs</depend>"),
        ("<depend>std_msgs</depend>", "depend>std_msgs</depend>", 9, "<depend>std_msgs</depend>"),
        ('email="ida@example.org"', 'email="ida@example.org', 6, '<maintainer email="ida@example.org">Ida</maintainer>'),
        ("what it needs", "messages -- and more", 8, "<!-- messages - and more -->"),
        ("</build_type>", "<build_type>", 11, "<build_type>ament_python</build_type>"),
    ],
)  # fmt: skip
def test_one_line_is_written_so_that_the_manifest_is_read(
    old: str, new: str, line: int, written: str
) -> None:
    broken = MANIFEST.replace(old, new)
    number, fix = repaired(broken) or (0, "")
    assert (number, fix) == (line, f"write `{written}`")
    lines = broken.splitlines()
    lines[line - 1] = written
    parse_package_string("\n".join(lines))


def test_nothing_may_stand_before_the_declaration() -> None:
    number, fix = repaired(f"<!-- mine -->\n{MANIFEST}") or (0, "")
    assert number == 2
    assert fix.startswith("move this line to the very beginning")


@pytest.mark.parametrize(
    "broken",
    [
        MANIFEST,
        "",
        "no manifest at all",
        MANIFEST.replace("A robot.", "a & b").replace("MIT", "a & b"),
        MANIFEST.replace("<license>MIT</license>", ""),
        MANIFEST.replace("<package ", '<!DOCTYPE x [<!ENTITY a "ha">]>\n<package ').replace(
            "A robot.", "&a; & b"
        ),
    ],
)
def test_what_is_read_or_needs_more_than_one_change_is_left(broken: str) -> None:
    assert repaired(broken) is None


def test_a_version_is_told_with_three_parts(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.change("package.xml", "<version>0.1.0</version>", "<version>1.2</version>")
    first = of_workspace(files.write(tmp_path))[0]
    assert (first.code, first.fix) == ("manifest-invalid", "write `<version>1.2.0</version>`")
