"""What is said about a build type or a setup.cfg fits what is there: applied to its line, colcon can build the package."""

from __future__ import annotations

import configparser
import re
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package_string
from workspace_files import CFG, NAMES, Files

from ros2lab.diagnose import Finding, of_workspace

ELEMENT = "<build_type>ament_python</build_type>"
EXPORT = f"  <export>\n    {ELEMENT}\n  </export>\n"
WRONG = [
    EXPORT.replace("ament_python", "ament_pyton"),
    EXPORT.replace("ament_python", "ament_cmake_python"),
    EXPORT.replace("ament_python", "ament_cmake"),
    EXPORT.replace("ament_python", "\n      ament_pyhton\n    "),
    EXPORT.replace(ELEMENT, ""),
    EXPORT.replace(ELEMENT, "<rviz/>"),
    EXPORT.replace(ELEMENT, f"{ELEMENT}\n    {ELEMENT.replace('python', 'cmake')}"),
    EXPORT.replace(ELEMENT, f"<!-- {ELEMENT} -->"),
    "  <export><build_type>cmake</build_type></export>\n",
    "  <export><rviz/></export>\n",
    "  <export/>\n",
    "",
]


def applied(found: Finding, text: str) -> str:
    """Return a text after its fix: the words in the place that it names, and nothing else."""
    lines, number = text.split("\n"), int(found.place.rpartition(":")[2])
    new, *old = re.findall(r"`(.+?)`", found.fix)
    block = re.search(r"instead of lines (\d+) to (\d+)", found.fix)
    if also := re.search(r", and on line (\d+) `(.+?)`", found.fix):
        lines[number - 1], lines[int(also[1]) - 1] = new, also[2]
    elif block:
        lines[int(block[1]) - 1 : int(block[2])] = [new]
    elif old or found.fix.startswith("remove "):
        taken, put = (old[0], new) if old else (new, "")
        assert taken in lines[number - 1]
        lines[number - 1] = lines[number - 1].replace(taken, put)
    elif found.fix.startswith("add "):
        lines.insert(number - ("above" in found.fix), new)
    else:
        lines[number - 1] = new
    return "\n".join(lines)


@pytest.mark.parametrize("written", WRONG)
def test_a_build_type_is_written_into_what_is_there(tmp_path: Path, written: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", EXPORT, written)
    found = of_workspace(files.write(tmp_path))
    manifest = parse_package_string(applied(found[0], files.texts["src/my_bot/package.xml"]))
    kinds = [export.content for export in manifest.exports if export.tagname == "build_type"]
    assert kinds == ["ament_python"]
    assert not any(export.tagname == "export" for export in manifest.exports)


def test_build_types_under_conditions_are_no_fault(tmp_path: Path) -> None:
    both = "".join(
        f'    <build_type condition="$ROS_VERSION == {n}">{kind}</build_type>\n'
        for n, kind in ((2, "ament_python"), (1, "catkin"))
    )
    files = Files.right(NAMES[1]).change("package.xml", f"    {ELEMENT}\n", both)
    assert not of_workspace(files.write(tmp_path))


@pytest.mark.parametrize(
    "written",
    [
        CFG.replace("lib/PACKAGE", "bin"),
        CFG.replace("script_dir=$base/lib/PACKAGE", "script_dir=$base/lib/other").replace(
            "install_scripts", "scripts"
        ),
        CFG.partition("[install]")[0],
        f"[install]\n{CFG.partition('[install]')[0].replace('PACKAGE', 'other')}",
    ],
)
def test_each_wrong_line_of_setup_cfg_is_written_anew(tmp_path: Path, written: str) -> None:
    files = Files.right(NAMES[1]).change(
        "setup.cfg", CFG.replace("PACKAGE", "my_bot"), written.replace("PACKAGE", "my_bot")
    )
    text = files.texts["src/my_bot/setup.cfg"]
    found = [
        finding for finding in of_workspace(files.write(tmp_path)) if finding.code == "setup-cfg-missing"
    ]
    for finding in sorted(found, key=lambda finding: finding.place, reverse=True):
        if finding.place[-1].isdigit():
            text = applied(finding, text)
        else:
            text += "\n".join(re.findall(r"`(.+?)`", finding.fix))
    config = configparser.ConfigParser()
    config.read_string(text)
    assert config["develop"]["script_dir"] == config["install"]["install_scripts"] == "$base/lib/my_bot"
