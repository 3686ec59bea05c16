"""Entry points, patterns, folders and tags that are nearly right: each is told with what stands when it is applied."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package_string
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace

POINT = "'talker = my_bot.talker:main'"
LAUNCHES = "glob('launch/*.launch.py')"
VALUES = "glob('config/*.yaml')"


def first(files: Files, folder: Path) -> Finding:
    return of_workspace(files.write(folder))[0]


@pytest.mark.parametrize(
    "written",
    [
        "talker = my_bot.talker.main",
        "talker = my_bot/talker:main",
        "talker = my_bot/talker.py/main",
        "talker = my_bot.talker.Talker",
        "talker = talker.main",
        "talker = my_bot.talker:main.",
        "talker = my_bot.talker::main",
        "talker = my_bot.talker.py:main",
        "talker = my_bot.talker->main",
        "talker = my-bot.talker:main",
        "talker = my_bto.talker.main",
        "talker = my_bot.talkr.main",
        "main = my_bot.talker:talker",
        "my_bot.talker:main = talker",
    ],
)
def test_an_entry_point_is_put_together_from_its_words(tmp_path: Path, written: str) -> None:
    found = first(Files.right(NAMES[1]).change("setup.py", POINT, repr(written)), tmp_path)
    assert found.fix.removesuffix(", and build again") == f"write {POINT}"


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("glob('launch\\\\*.launch.py')", "glob('launch/*.launch.py')"),
        ("glob('Launch/*')", "glob('launch/*')"),
        ("glob('../launch/*')", "glob('launch/*')"),
        ("glob(os.path.join('launches', '*'))", "glob('launch/*')"),
        ("glob('launch/*.launch.xml')", "glob('launch/*.launch.py')"),
        ("glob('my_bot/launch/*.py')", "glob('launch/*.py')"),
        ("glob('launch*.py')", "glob('launch/*.launch.py')"),
    ],
)
def test_a_pattern_that_matches_nothing_is_named(tmp_path: Path, written: str, fix: str) -> None:
    found = first(Files.right(NAMES[1]).change("setup.py", LAUNCHES, written), tmp_path)
    assert found.code == "not-in-data-files"
    assert found.fix.startswith(f"write {fix} instead of glob(")
    fixed = Files.right(NAMES[1]).change("setup.py", LAUNCHES, fix)
    assert of_workspace(fixed.write(tmp_path / "fixed")) == []


def test_a_pattern_for_files_that_are_not_there_yet_is_right(tmp_path: Path) -> None:
    more = f"{VALUES}),\n        ('share/my_bot/rviz', glob('rviz/*.rviz')"
    assert of_workspace(Files.right(NAMES[1]).change("setup.py", VALUES, more).write(tmp_path)) == []


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("glob('config/*')", "glob('config/*.yaml')"),
        ("[path for path in glob('config/*')]", "[path for path in glob('config/*') if os.path.isfile(path)]"),
        ("glob('config/**', recursive=True)", "[path for path in glob('config/**', recursive=True) if os.path.isfile(path)]"),
        ("['config/robot.yaml', 'config/old']", "glob('config/old/*')"),
    ],
)  # fmt: skip
def test_a_folder_among_the_files_is_left_out(tmp_path: Path, written: str, fix: str) -> None:
    files = Files.right(NAMES[1]).change("setup.py", VALUES, written).put("config/old/notes.txt", "old")
    found = first(files, tmp_path)
    assert found.code == "setup-value"
    assert found.fix.startswith(f"write {fix} instead of ")


def test_a_folder_that_only_setuptools_finds_is_left_out(tmp_path: Path) -> None:
    written = "[os.path.join('config', name) for name in os.listdir('config')]"
    files = Files.right(NAMES[1]).change("setup.py", VALUES, written).put("config/old/notes.txt", "old")
    said = "$ colcon build\nStarting >>> my_bot\n--- stderr: my_bot\nerror: can't copy 'config/old': doesn't exist or not a regular file\n---\nFailed   <<< my_bot [1s, exited with code 1]\n"
    found = of_text(said, files.write(tmp_path))[0]
    assert f"write {written[:-1]} if os.path.isfile(os.path.join('config', name))] instead" in found.fix


@pytest.mark.parametrize(
    ("old", "new", "moved"),
    [
        ("my_bot/", "My_Bot/", "My_Bot src/my_bot/my_bot"),
        ("my_bot/", "my-bot/", "my-bot src/my_bot/my_bot"),
        ("resource/", "Resource/", "Resource/my_bot src/my_bot/resource/my_bot"),
        ("resource/my_bot", "resource/my-bot", "resource/my-bot src/my_bot/resource/my_bot"),
        ("setup.py", "Setup.py", "Setup.py src/my_bot/setup.py"),
        ("my_bot/__init__.py", "my_bot/_init_.py", "my_bot/_init_.py src/my_bot/my_bot/__init__.py"),
    ],
)
def test_what_has_nearly_the_right_name_is_renamed(tmp_path: Path, old: str, new: str, moved: str) -> None:
    files = Files.right(NAMES[1])
    start = f"src/my_bot/{old}"
    for path in [path for path in files.texts if path.startswith(start)]:
        files.texts[f"src/my_bot/{new}{path.removeprefix(start)}"] = files.texts.pop(path)
    assert first(files, tmp_path).fix.startswith(f"mv src/my_bot/{moved}")


LICENSE = "  <license>Apache-2.0</license>\n"
MAINTAINER = '<maintainer email="anna@example.org">anna</maintainer>'
EXPORT = "  <export>\n    <build_type>ament_python</build_type>\n  </export>\n"
RCLPY = "<depend>rclpy</depend>"
TAGS = [
    (EXPORT, "  <build_type>ament_python</build_type>\n"),
    (EXPORT, "  <build_type>ament_python</build_type>\n  <export>\n  </export>\n"),
    (EXPORT, "  <export>\n  </export>\n  <build_type>ament_python</build_type>\n"),
    (LICENSE, ""),
    (LICENSE, "  <licence>MIT</licence>\n"),
    (LICENSE, "  <License>MIT</License>\n"),
    (LICENSE, f"{LICENSE}  <python>3.12</python>\n"),
    (f"  {MAINTAINER}\n", ""),
    (MAINTAINER, "<maintainer>anna</maintainer>"),
    (MAINTAINER, "<maintainer>anna (anna@uni.de)</maintainer>"),
    (MAINTAINER, '<maintainer email="anna">anna</maintainer>'),
    ("  <description>Three nodes</description>\n", ""),
    ("<name>my_bot</name>", "<name>my bot</name>"),
    ("<name>my_bot</name>\n", "<name>my_bot</name>\n  <name>other</name>\n"),
    ("<version>0.1.0<", "<version>v0.1<"),
    (RCLPY, "<depends>rclpy</depends>"),
    (RCLPY, "<run_depend>rclpy</run_depend>"),
    (RCLPY, "<dependency>rclpy</dependency>"),
    (RCLPY, "<exec-depend>rclpy</exec-depend>"),
    (RCLPY, f"{RCLPY}\n  <exec_depend>rclpy</exec_depend>"),
    (RCLPY, '<depend version="1">rclpy</depend>'),
    ('<package format="3">', '<package format="4">'),
    ('<package format="3">', "<package>"),
]


@pytest.mark.parametrize("change", TAGS)
def test_a_wrong_tag_is_repaired(tmp_path: Path, change: tuple[str, str]) -> None:
    """What is said, applied to the line that is named, gives a manifest that catkin_pkg accepts."""
    files = Files.right(NAMES[1]).change("package.xml", *change)
    found = first(files, tmp_path)
    assert found.code == "manifest-invalid"
    text = files.texts["src/my_bot/package.xml"]
    assert parse_package_string(applied(found, text)).name == "my_bot"


def applied(found: Finding, text: str) -> str:
    """Return a manifest with a fix applied to its line."""
    lines, number = text.split("\n"), int(found.place.rpartition(":")[2])
    here = lines[number - 1]
    quoted = re.search(r"`(.+?)`", found.fix)
    below = re.search(r"move this line below <export> on line (\d+)", found.fix)
    if below:
        lines.insert(int(below[1]), here)
        del lines[number if number > int(below[1]) else number - 1]
    elif found.fix.startswith("remove this line"):
        del lines[number - 1]
    elif quoted and found.fix.startswith("add "):
        lines.insert(number, quoted[1])
    elif quoted and found.fix.startswith("write "):
        lines[number - 1] = quoted[1]
    else:
        raise AssertionError(found.fix)
    return "\n".join(lines)


@pytest.mark.parametrize("written", ["rclpy, sensor_msgs", "rclpy sensor_msgs", "rclpy;sensor_msgs"])
def test_a_tag_declares_one_package(tmp_path: Path, written: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", RCLPY, f"<depend>{written}</depend>")
    found = of_workspace(files.write(tmp_path))
    assert [finding.code for finding in found] == ["dependency-joined"]
    assert found[0].fix == f"write `{RCLPY}<depend>sensor_msgs</depend>`"


@pytest.mark.parametrize(
    ("written", "left"),
    [
        ("sensor_msgs.msg", ["sensor_msgs"]),
        ("sensor_msgs/msg/String", ["sensor_msgs"]),
        ("sensor_msgs::msg", ["sensor_msgs"]),
        ("rclpy.node", []),
        ("rclpy.action, sensor_msgs.msg", ["sensor_msgs"]),
        ("rclpy and sensor_msgs", ["sensor_msgs"]),
        ("rclpy.sensor_msgs", ["sensor_msgs"]),
        ("sensor_msgs>=1.0", ["sensor_msgs"]),
        ("rclpy python3-numpy", ["python3-numpy"]),
        ("rclpy, libgstreamer1.0-dev", ["libgstreamer1.0-dev"]),
    ],
)
def test_what_is_imported_of_a_package_is_declared_as_the_package(
    tmp_path: Path, written: str, left: list[str]
) -> None:
    shown = f"<depend>{written.replace('>', '&gt;')}</depend>"
    files = Files.right(NAMES[1]).change("package.xml", RCLPY, f"{RCLPY}\n  {shown}")
    (found,) = of_workspace(files.write(tmp_path))
    new = "".join(f"<depend>{name}</depend>" for name in left)
    assert found.fix == (f"write `{new}`" if new else "remove this line: rclpy is declared as well")


def test_a_dependency_inside_export_is_moved(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("package.xml", f"  {RCLPY}\n", "")
    files.change("package.xml", "    <build_type>", f"    {RCLPY}\n    <build_type>")
    found = of_workspace(files.write(tmp_path))
    assert [finding.fix for finding in found] == ["move this line above <export>"]


MARKED = "        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n"


@pytest.mark.parametrize("has_marker", [True, False])
def test_a_marker_that_is_not_installed_is_made_first_where_it_is_missing(
    tmp_path: Path, has_marker: bool
) -> None:
    files = Files.right(NAMES[0]).change("setup.py", MARKED, "")
    if not has_marker:
        files.remove("resource/PACKAGE")
    root = files.write(tmp_path)
    (found,) = (f for f in of_workspace(root) if f.code == "marker-not-installed")
    command, also, line = found.fix.rpartition(", and add ")
    assert bool(also) != has_marker
    subprocess.run(command, shell=True, check=True, cwd=root)
    package = root / "src/robot_controller"
    assert (package / line.partition("['")[2].partition("']")[0]).is_file()


def test_data_files_that_are_not_there_are_written_whole(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    setup = files.texts[files.path("setup.py")]
    files.change("setup.py", setup[setup.index("    data_files=") : setup.index("    install_requires")], "")
    fixes = [f.fix for f in of_workspace(files.write(tmp_path)) if "data_files" in f.fix]
    lists = [fix.partition("data_files=")[2].partition(",` in setup()")[0] for fix in fixes]
    folders = [[folder for folder, _ in ast.literal_eval(rows)] for rows in lists]
    usual = ["share/ament_index/resource_index/packages", "share/robot_controller"]
    assert {(*usual,), (*usual, "share/robot_controller/launch")} <= {*map(tuple, folders)}
    assert all(row[:2] == usual for row in folders)


@pytest.mark.parametrize(
    ("file", "old", "new", "is_helped"),
    [
        ("package.xml", "<version>", "<version>", True),
        ("package.xml", "<version>", "<version>one", False),
        ("package.xml", "<build_type>ament_python</build_type>", "", False),
    ],
)
def test_colcon_installs_the_marker_only_of_a_package_of_ament_python(
    tmp_path: Path, file: str, old: str, new: str, is_helped: bool
) -> None:
    files = Files.right(NAMES[0]).change("setup.py", MARKED, "").change(file, old, new)
    found = [f for f in of_workspace(files.write(tmp_path)) if f.code == "marker-not-installed"]
    assert ["colcon does it" in one.cause for one in found] == [is_helped]


def test_a_dependency_under_a_condition_is_declared(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    for condition in ("$ROS_DISTRO == humble", "$BUILD_KIND == real"):
        depend = f'<depend condition="{condition}">std_msgs</depend>'
        files.change("package.xml", "<depend>std_msgs</depend>", depend)
        assert "dependency-undeclared" not in [f.code for f in of_workspace(files.write(tmp_path), None)]
        files.change("package.xml", depend, "<depend>std_msgs</depend>")
    files.change("package.xml", "<depend>std_msgs</depend>", "")
    assert "dependency-undeclared" in [f.code for f in of_workspace(files.write(tmp_path), None)]


@pytest.mark.parametrize(
    "key",
    ["libgstreamer1.0-dev", "gstreamer1.0-plugins-bad", "python3.11-dev", "liblua5.3-dev", "libgtk-3-dev", "libstdc++6", "qtbase5-dev"],
)  # fmt: skip
def test_a_key_of_rosdep_may_have_dots(tmp_path: Path, key: str) -> None:
    files = Files.right(NAMES[1]).change("package.xml", RCLPY, f"{RCLPY}\n  <depend>{key}</depend>")
    assert of_workspace(files.write(tmp_path)) == []


GIVEN = {
    "entry_points": "{'console_scripts': ['talker = my_bot.talker:main', 'ears = my_bot.ears:main', 'wheels = my_bot.wheels:main']}",
    "packages": "find_packages(exclude=['test'])",
}


def with_setup(keyword: str, *, inner: str = "", before: str = "", after: str = "") -> Files:
    """Return a package whose setup() is not given a keyword as it was, but has its value where it is put."""
    files = Files.right(NAMES[1])
    text = re.sub(
        rf"    {keyword}=(?:\{{.*?\n    \}}|.*?),\n",
        f"    {inner}\n" * bool(inner),
        files.texts[files.path("setup.py")],
        count=1,
        flags=re.S,
    )
    text = text.replace("setup(\n", f"{before}\nsetup(\n") + after
    return files.put("setup.py", text.replace("VALUE", GIVEN[keyword]))


@pytest.mark.parametrize(
    ("keyword", "places"),
    [
        ("entry_points", {"after": "entry_points = VALUE,\n"}),
        ("entry_points", {"after": "entry_points = VALUE\n"}),
        ("entry_points", {"before": "entry_points = VALUE\n"}),
        ("entry_points", {"before": "args = {'entry_points': VALUE}\n"}),
        ("entry_points", {"before": "args = dict(entry_points=VALUE)\n"}),
        ("entry_points", {"inner": "extras_require={'test': ['pytest'], 'entry_points': VALUE},"}),
        ("packages", {"after": "packages = VALUE\n"}),
    ],
)
def test_what_setup_is_not_given_is_put_into_its_parentheses(
    tmp_path: Path, keyword: str, places: dict[str, str]
) -> None:
    files = with_setup(keyword, **places)
    (found,) = of_workspace(files.write(tmp_path / "first"))
    wanted = f"{keyword}={GIVEN[keyword]},"
    assert (found.code, found.fix.startswith(f"write `{wanted}` behind `setup(`")) == ("setup-value", True)
    text = files.texts[files.path("setup.py")].splitlines()
    assert keyword in text[int(found.place.rpartition(":")[2]) - 1]
    text.insert(int(re.findall(r"line (\d+)", found.fix)[-1]), wanted)
    text = [line for line in text if not line.startswith(f"{keyword} = ")]
    assert of_workspace(files.put("setup.py", "\n".join(text)).write(tmp_path / "fixed")) == []


@pytest.mark.parametrize(
    "places",
    [
        {"before": "entry_points = VALUE\n", "inner": "entry_points=entry_points,"},
        {"before": "args = {'entry_points': VALUE}\n", "inner": "**args,"},
        {"before": "args = dict(entry_points=VALUE)\n", "inner": "**args,"},
        {"before": "def args():\n    return {'entry_points': VALUE}\n\n", "inner": "**args(),"},
    ],
)
def test_what_setup_is_given_by_another_name_is_left_alone(tmp_path: Path, places: dict[str, str]) -> None:
    assert of_workspace(with_setup("entry_points", **places).write(tmp_path)) == []


SHARE = "os.path.join('share', package_name, 'launch')"
REFUSED = {
    "a slash before share": ("('/share/' + package_name, FILES)", "isabs(dest)", "write 'share/' + package_name instead of"),
    "in the first part": ("(os.path.join('/share', package_name, 'launch'), FILES)", "isabs(dest)", f"write {SHARE} instead of"),
    "in a later part": ("(os.path.join('share', '/' + package_name, 'launch'), FILES)", "isabs(dest)", f"write {SHARE} instead of"),
    "a folder of the system": ("('/opt/robot', FILES)", "isabs(dest)", "write 'share/my_bot', or a folder in it, instead of '/opt/robot'"),
    "below Python": ("(__import__('sys').prefix + '/share', FILES)", "isabs(dest)", "write each folder as in os.path.join('share', package_name)"),
    "files by their whole paths": ("('share/x', glob(os.path.abspath('launch/*')))", "isabs(source)", "give each file by its path from the folder of setup.py"),
    "a tuple of files": ("('share/x', tuple(FILES))", "isinstance(sources, list)", "write [ and ] around the files"),
    "three parts": ("('share/x', FILES, 1)", "len(data_file) == 2", "write each entry as (folder, [files])"),
}  # fmt: skip
ASSERTED = """\
$ colcon build
Starting >>> my_bot
--- stderr: my_bot
Traceback (most recent call last):
  File "/opt/colcon_ros/task/ament_python/build.py", line 54, in build
    data_files = get_data_files_mapping(
  File "/opt/colcon_core/task/python/__init__.py", line 38, in get_data_files_mapping
    assert not LINE
AssertionError
---
Failed   <<< my_bot [0.34s, exited with code 1]
"""


@pytest.mark.parametrize(("row", "asserted", "fix"), REFUSED.values(), ids=REFUSED)
def test_data_files_that_colcon_asserts_something_else_of(
    tmp_path: Path, row: str, asserted: str, fix: str
) -> None:
    files = Files.right(NAMES[1])
    text = files.texts["src/my_bot/setup.py"]
    files.put(
        "setup.py",
        text.replace("    data_files=[\n", f"    data_files=[\n        {row.replace('FILES', LAUNCHES)},\n"),
    )
    (found, *_) = of_text(ASSERTED.replace("not LINE", asserted), files.write(tmp_path))
    assert found.code == "setup-value"
    assert found.fix.startswith(fix)


def test_of_a_build_that_is_shown_to_fail_it_is_not_told_that_there_is_none(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.texts["install/setup.bash"] = ""
    text = ASSERTED.replace("get_data_files_mapping", "other").replace("python/__init__", "other")
    assert "not-built" not in {found.code for found in of_text(text, files.write(tmp_path))}


@pytest.mark.parametrize(
    ("options", "codes"),
    [
        ("package_dir =\n    = lib\npackages = find:\n[options.packages.find]\nwhere = lib\n", []),
        ("package_dir =\n    my_bot = lib/my_bot\npackages = my_bot\n", []),
        ("package_dir = = lib\npackages = my_bot\n", []),
        ("package_dir = = src\npackages = my_bot\n", ["package-folder-missing"]),
    ],
)
def test_the_folders_that_setup_cfg_names_are_looked_into(
    tmp_path: Path, options: str, codes: list[str]
) -> None:
    for path in ("lib/my_bot/__init__.py", "setup.py", "setup.cfg"):
        (tmp_path / "src" / "my_bot" / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "src" / "my_bot" / path).touch()
    folder = tmp_path / "src" / "my_bot"
    (folder / "package.xml").write_text("<package format='3'><name>my_bot</name></package>\n")
    (folder / "setup.py").write_text("from setuptools import setup\n\nsetup(name='my_bot')\n")
    (folder / "setup.cfg").write_text(f"[options]\n{options}")
    found = [finding.code for finding in of_workspace(tmp_path)]
    assert [code for code in found if code == "package-folder-missing"] == codes
