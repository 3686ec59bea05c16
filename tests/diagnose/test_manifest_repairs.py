"""A package.xml that cannot be read: what is told makes it readable, and where that is not known nothing is made up."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package_string
from workspace_files import NAMES, Files

from ros2lab.checks import CheckError
from ros2lab.checks.manifests import manifest_of
from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.packaging.manifest_repairs import repaired
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.package_faults import manifest_fault

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
    number, fix = repaired(broken, {}) or (0, "")
    assert (number, fix) == (line, f"write `{written}`")
    lines = broken.splitlines()
    lines[line - 1] = written
    parse_package_string("\n".join(lines))


def test_nothing_may_stand_before_the_declaration() -> None:
    number, fix = repaired(f"<!-- mine -->\n{MANIFEST}", {}) or (0, "")
    assert number == 2
    assert fix.startswith("move this line to the very beginning")


@pytest.mark.parametrize(
    "broken",
    [
        MANIFEST,
        "",
        "no manifest at all",
        MANIFEST.replace("<package ", '<!DOCTYPE x [<!ENTITY a "ha">]>\n<package ').replace(
            "A robot.", "&a; & b"
        ),
    ],
)
def test_what_is_read_or_is_no_manifest_is_left(broken: str) -> None:
    assert repaired(broken, {}) is None


def test_of_two_faults_the_first_is_told() -> None:
    broken = MANIFEST.replace("A robot.", "a & b").replace("MIT", "a & b")
    assert repaired(broken, {}) == (5, "write `<description>a &amp; b</description>`")


def slips() -> list[tuple[int, str, str]]:
    """Return the line, what it was, and the manifest, for each sign left out and each tag misspelt on one side."""
    found, lines = [], MANIFEST.split("\n")
    for n, line in enumerate(lines):
        is_comment = line.lstrip().startswith(("<?", "<!"))
        for match in re.finditer(r'[<>/"=]|(?<=</)\w{5,}', "" if is_comment else line):
            new = match[0][:2] + match[0][3:] if len(match[0]) > 1 else ""
            broken = f"{line[: match.start()]}{new}{line[match.end() :]}"
            found.append((n + 1, line.strip(), "\n".join([*lines[:n], broken, *lines[n + 1 :]])))
    return found


def test_what_was_left_out_of_a_tag_is_put_back() -> None:
    assert len(slips()) > 50
    for line, was, broken in slips():
        assert repaired(broken, {}) == (line, f"write `{was}`")


@pytest.mark.parametrize("left_out", ['<package format="3">', "<export>", "</export>", "</package>"])
def test_the_line_of_a_tag_is_put_back(left_out: str) -> None:
    broken = "".join(line for line in MANIFEST.splitlines(keepends=True) if line.strip() != left_out)
    number, fix = repaired(broken, {}) or (0, "")
    assert fix == f"add `{left_out}` below this line"
    lines = broken.splitlines()
    parse_package_string("\n".join([*lines[:number], left_out, *lines[number:]]))


def test_a_version_is_told_with_three_parts(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.change("package.xml", "<version>0.1.0</version>", "<version>1.2</version>")
    first = of_workspace(files.write(tmp_path))[0]
    assert (first.code, first.fix) == ("manifest-invalid", "write `<version>1.2.0</version>`")


DEEP = "<b>" * 3000 + "</b>" * 3000
# What catkin_pkg raises something else for than that a package is invalid, and what is said of it.
NOT_TAKEN = {
    "a format that is no number": ('format="3"', 'format="x"', "must be a number"),
    "no format at all": ('format="3"', 'format=""', "must be a number"),
    "a format of the future": ('format="3"', 'format="4"', "version '4'"),
    "tags without end": ("A robot.", DEEP, "nested hundreds of levels deep"),
}
CONDITIONS = {
    "brackets": ("((((((1))))))", "more than 5 brackets"),
    "no condition": ("1 &lt;", "failed to parse"),
}


@pytest.fixture
def package_folder(tmp_path: Path) -> Path:
    """A folder that no other test's workspace has beside it, where a package would be one outside of that workspace."""
    folder = tmp_path / "src" / "package"
    folder.mkdir(parents=True)
    return folder


@pytest.mark.parametrize(("old", "new", "said"), NOT_TAKEN.values(), ids=NOT_TAKEN.keys())
def test_whatever_the_parser_raises_is_said_by_all_that_read(
    package_folder: Path, old: str, new: str, said: str
) -> None:
    assert old in MANIFEST
    (package_folder / "package.xml").write_text(MANIFEST.replace(old, new, 1))
    package = SourcePackage(package_folder)
    assert package.manifest is None
    assert said in str(package.manifest_fault)
    assert said in str(manifest_fault(package_folder))
    with pytest.raises(CheckError, match=r"package\.xml"):
        manifest_of(package_folder)


@pytest.mark.parametrize(("condition", "said"), CONDITIONS.values(), ids=CONDITIONS.keys())
def test_a_condition_that_cannot_be_read_is_said_to_be(
    package_folder: Path, condition: str, said: str
) -> None:
    text = MANIFEST.replace("<depend>", f'<depend condition="{condition}">')
    (package_folder / "package.xml").write_text(text)
    package = SourcePackage(package_folder)
    assert package.manifest is None
    assert said in str(package.manifest_fault)


def test_a_mistake_of_our_own_is_none_of_the_manifest(
    package_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(manifest: object) -> object:
        raise TypeError(manifest)

    monkeypatch.setattr("ros2lab.diagnose.sources.package._where_they_hold", broken)
    (package_folder / "package.xml").write_text(MANIFEST)
    with pytest.raises(TypeError):
        _ = SourcePackage(package_folder).manifest
