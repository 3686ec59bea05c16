"""Packages that are none of ROS: each is judged as what colcon takes it for, and one that lost its package.xml is told."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from workspace_files import NAMES, NODE, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.look import Look
from ros2lab.environment import lab_environment

SETUP = "from setuptools import find_packages, setup\n\n"
CIRCLE = "import math\n\n\ndef area(radius):\n    return math.pi * radius ** 2\n"
# Each library beside a package of ROS, as colcon lists it.
LIBRARIES = {
    "python": {
        "setup.py": f"{SETUP}setup(name='shapes', version='1.0', packages=find_packages())\n",
        "shapes/__init__.py": "",
        "shapes/circle.py": CIRCLE,
    },
    "python, by setup.cfg": {
        "setup.py": "from setuptools import setup\n\nsetup()\n",
        "setup.cfg": "[metadata]\nname = shapes\nversion = 1.0\n\n[options]\npackages = find:\n",
        "shapes/__init__.py": CIRCLE,
    },
    "python, below src": {
        "setup.py": f"{SETUP}setup(name='shapes', packages=find_packages('src'), package_dir={{'': 'src'}})\n",
        "src/shapes/__init__.py": CIRCLE,
    },
    "python, with a program and a hyphen": {
        "setup.py": f"{SETUP}setup(\n    name='my-shapes', version='1.0', packages=['my_shapes'],\n"
        "    entry_points={'console_scripts': ['area = my_shapes.circle:main']},\n)\n",
        "my_shapes/__init__.py": "",
        "my_shapes/circle.py": f"{CIRCLE}\n\ndef main():\n    print(area(1.0))\n",
        "package.json": '{"name": "shapes"}\n',
    },
    "python, for nodes": {
        "setup.py": f"{SETUP}setup(name='shapes', version='1.0', packages=['shapes'], data_files=[('share/doc', ['README'])])\n",
        "README": "Circles.\n",
        "shapes/__init__.py": "import rclpy.node\n\n\nclass Named(rclpy.node.Node):\n    def __init__(self):\n        super().__init__('named')\n",
    },
    "cmake": {
        "CMakeLists.txt": "cmake_minimum_required(VERSION 3.8)\nproject(shapes NONE)\ninstall(FILES shapes.h DESTINATION include)\n",
        "shapes.h": "#pragma once\n",
    },
    "cmake, with a setup.py": {
        "CMakeLists.txt": "cmake_minimum_required(VERSION 3.8)\nproject(shapes NONE)\n",
        "setup.py": f"{SETUP}setup(name='shapes', version='1.0', packages=['not_here'])\n",
    },
}
# What a folder still has that lost its package.xml.
LOST = {
    "setup.py of ros2 pkg create": None,
    "only setup.cfg": {
        "setup.py": f"{SETUP}setup(name='sonar', version='1.0', packages=['sonar'])\n",
        "setup.cfg": "[develop]\nscript_dir=$base/lib/sonar\n[install]\ninstall_scripts=$base/lib/sonar\n",
        "sonar/__init__.py": "",
    },
    "only a node": {
        "setup.py": f"{SETUP}setup(name='sonar', version='1.0', packages=['sonar'],\n"
        "      entry_points={'console_scripts': ['ping = sonar.ping:main']})\n",
        "sonar/__init__.py": "",
        "sonar/ping.py": NODE.replace("CLASS", "Ping"),
    },
    "only a launch file": {
        "setup.py": f"{SETUP}setup(name='sonar', version='1.0', packages=['sonar'])\n",
        "sonar/__init__.py": "",
        "launch/sonar.launch.xml": "<launch></launch>\n",
    },
}


def beside(texts: dict[str, str], folder: Path, name: str = "lib") -> Path:
    """Write a right workspace with one more folder in it."""
    root = Files.right(NAMES[1]).write(folder)
    for path, text in texts.items():
        (root / "src" / name / path).parent.mkdir(parents=True, exist_ok=True)
        (root / "src" / name / path).write_text(text)
    return root


@pytest.mark.parametrize("name", LIBRARIES)
def test_what_is_no_package_of_ros_needs_nothing_of_one(name: str, tmp_path: Path) -> None:
    root = beside(LIBRARIES[name], tmp_path)
    node = root / "src/my_bot/my_bot/talker.py"
    module = next(
        (top for top in ("my_shapes", "shapes") for p in (root / "src/lib").rglob(top) if p.is_dir()), "os"
    )
    node.write_text(f"import {module}\n{node.read_text()}")
    assert of_workspace(root) == []


@pytest.mark.parametrize("name", LIBRARIES)
def test_each_is_taken_for_what_colcon_takes_it_for(name: str, tmp_path: Path) -> None:
    root = beside(LIBRARIES[name], tmp_path)
    listed = subprocess.run(
        ["colcon", "list", "--base-paths", "src"],
        cwd=root, env=lab_environment(), capture_output=True, text=True, check=True, timeout=120,
    ).stdout  # fmt: skip
    kinds = {line.split("\t")[1]: line.split("\t")[2] for line in listed.splitlines()}
    for package in Look(root).packages:
        assert package.kind in kinds[package.shown("").rstrip("/")]


@pytest.mark.parametrize("name", LOST)
def test_a_package_that_lost_its_manifest_is_told(name: str, tmp_path: Path) -> None:
    texts = LOST[name]
    root = beside(texts or {}, tmp_path, "sonar")
    if texts is None:
        (root / "src/my_bot/package.xml").unlink()
    first = of_workspace(root)[0]
    assert first.code == "manifest-invalid"
    assert first.place == f"src/{'sonar' if texts else 'my_bot'}/package.xml"


def test_a_library_of_which_a_node_is_started_is_meant_for_ros(tmp_path: Path) -> None:
    root = beside(LIBRARIES["python"], tmp_path)
    text = "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\ndef generate_launch_description():\n    return LaunchDescription([Node(package='shapes', executable='circle')])\n"
    (root / "src/my_bot/launch/shapes.launch.py").write_text(text)
    assert of_workspace(root)[0].place == "src/lib/package.xml"
    (finding,) = of_text("$ ros2 run shapes circle\nPackage 'shapes' not found", root)
    assert finding.code == "manifest-invalid"


def test_a_wrong_library_is_told_what_is_wrong_with_it(tmp_path: Path) -> None:
    texts = LIBRARIES["python"] | {
        "setup.py": "from setuptools import setup\n\nsetup(name='shapes', packages=['shape'])\n"
    }
    assert "package-folder-missing" in {one.code for one in of_workspace(beside(texts, tmp_path))}
    (tmp_path / "src/lib/setup.py").write_text("from setuptools import setup\n\nsetup(name='shapes'\n")
    assert of_workspace(tmp_path)[0].code == "setup-syntax"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("entry_points={", "entry_point={"),
        ("packages=", "package="),
        ("data_files=[", "data_file=["),
        ("    entry_points={", "    console_scripts=["),
    ],
)
def test_what_follows_from_a_wrong_keyword_is_not_told(old: str, new: str, tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("setup.py", old, new)
    if "console_scripts" in new:
        files.change("setup.py", "        'console_scripts': [\n", "").change(
            "setup.py", "        ],\n    },\n)", "    ],\n)"
        )
    assert [one.code for one in of_workspace(files.write(tmp_path))] == ["setup-value"]


def test_what_is_wrong_below_a_wrong_keyword_is_told(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).change("setup.py", "entry_points={", "entry_point={")
    files.change("setup.py", "MODULE:main", "MODULE:mian")
    assert [one.code for one in of_workspace(files.write(tmp_path))] == [
        "setup-value",
        "entry-point-function",
    ]


@pytest.mark.parametrize(
    ("written", "quoted"),
    [
        (
            "os.path.join('share', 'package_name', 'launch')",
            "os.path.join('share', 'package_name', 'launch')",
        ),
        ("'share/package_name/launch'", "'share/package_name/launch'"),
        ("'share/' + 'my_robot' + '/launch'", "'share/' + 'my_robot' + '/launch'"),
        ("f'share/{package_name}s/launch'", "f'share/{package_name}s/launch'"),
    ],
)
def test_a_folder_is_quoted_as_it_stands_in_its_line(written: str, quoted: str, tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    text = files.texts[files.path("setup.py")]
    line = next(one for one in text.splitlines() if "launch/*" in one)
    start = line.index("(") + 1
    old = line[start : line.index(", glob")] if ", glob" in line else line[start : line.index(", [")]
    files.texts[files.path("setup.py")] = text = text.replace(line, line.replace(old, written))
    if "import os" not in text:
        files.texts[files.path("setup.py")] = text = f"import os\n{text}"
    (finding,) = of_workspace(files.write(tmp_path))
    assert finding.code == "installed-elsewhere"
    number = int(finding.place.rpartition(":")[2])
    assert quoted in text.splitlines()[number - 1]
    assert f"instead of {quoted}, " in finding.fix
