"""A misspelt name whose right spelling is there as well: it is not to be written twice."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look


def found(files: Files, folder: Path) -> list[Finding]:
    return Look(files.write(folder)).findings


@pytest.mark.parametrize(
    ("given", "right", "misspelt"),
    [
        ("['pytest']", "tests_require", "test_require"),
        ("['setuptools']", "install_requires", "install_require"),
        ("'a@b.co'", "maintainer_email", "maintainer_mail"),
        ("{}", "package_data", "packages_data"),
    ],
)
@pytest.mark.parametrize("is_there", [True, False])
def test_a_keyword_of_setup_is_not_repeated(
    tmp_path: Path, given: str, right: str, misspelt: str, *, is_there: bool
) -> None:
    files = Files.right(NAMES[1])
    setup = re.sub(rf"    {right}=.*\n", "", files.texts[files.path("setup.py")])
    rows = "".join(f"    {name}={given},\n" for name in [right] * is_there + [misspelt])
    files.put("setup.py", setup.replace("    zip_safe", f"{rows}    zip_safe"))
    told = [finding.fix for finding in found(files, tmp_path) if finding.code == "setup-value"]
    kept = f"remove {misspelt}, and keep the right value as {right}, which is there as well"
    assert told == [kept if is_there else f"write {right} instead of {misspelt}"]


@pytest.mark.parametrize(
    ("given", "fix"),
    [
        ("data='a', dat='b'", "remove dat, and keep the right value as data, which is there as well"),
        ("dat='b'", "write one of: data"),
        ("data='a', sender='b'", "remove sender, or use another message type"),
    ],
)
def test_a_field_of_a_message_is_not_given_twice(tmp_path: Path, given: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("node", "msg = String()", f"msg = String({given})")
    assert [finding.fix for finding in found(files, tmp_path) if finding.code == "message-field"] == [fix]


def test_a_section_of_another_name_is_for_nobody_known_beside_the_right_one(tmp_path: Path) -> None:
    """The node's defaults are not kept if it has a section of its own."""
    files = Files.right(NAMES[1])
    section = "{name}:\n  ros__parameters:\n    period: 1.0\n"
    files.put("config/more.yaml", section.format(name="talker") + section.format(name="talkerr"))
    assert not [f for f in found(files, tmp_path) if f.code == "parameter-file-node"]


AREA = "\n\ndef area(width, height):\n    return width * height\n\n\nclass"


@pytest.mark.parametrize(
    ("lines", "fix"),
    [
        ("print(area(width=1, height=2, widht=3))", "remove widht, and keep the right value as width, which is there as well"),
        ("print(area(1.0))", "add a value for height in the parentheses of area(...): nothing here is called height"),
        ("self.height = 2\n        self.size = area(1)", "add self.height in the parentheses of area(...)"),
        ("height = 2\n        self.size = area(1) * height", "write `area(1, height)`"),
    ],
)  # fmt: skip
def test_an_argument_is_named_that_can_be_given(tmp_path: Path, lines: str, fix: str) -> None:
    """A call is told with what there is: an argument given already, and a value that the code has."""
    files = Files.right(NAMES[1]).change("node", "\n\nclass", AREA)
    files.change("node", "        self.count = 0", f"        self.count = 0\n        {lines}")
    codes = ("argument-unknown", "argument-missing")
    told = of_workspace(files.write(tmp_path))
    assert [finding.fix for finding in told if finding.code in codes] == [fix]
