"""Paths put together without the slash between a folder and what is in it, as they are printed."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

NAME = NAMES[1]
PACKAGE = NAME.package
SHARE = f"get_package_share_directory('{PACKAGE}')"
LAUNCH = "launch/more.launch.py"
BASE = "from launch import LaunchDescription\n\n\ndef generate_launch_description():\n    return LaunchDescription([])\n"
ROOMS = {
    "added": f"PATH = {SHARE} + 'launch/base.launch.py'\n",
    "in two pieces": f"PATH = {SHARE} + 'launch' + '/base.launch.py'\n",
    "an f-string": f"share = {SHARE}\nPATH = f'{{share}}launch/base.launch.py'\n",
    "a list": f"PATH = [FindPackageShare('{PACKAGE}'), 'launch/base.launch.py']\n",
}
REFUSED = "[ERROR] [launch]: Caught exception in launch (see debug for traceback): [Errno 2] No such file or directory: '{}'\n"
TEXTS = {
    "launch": REFUSED,
    "a parameter file": "[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: {}\n",
    "a node": "FileNotFoundError: [Errno 2] No such file or directory: '{}'\n",
}


def written(folder: Path, more: str) -> Path:
    files = Files.right(NAME).put("launch/base.launch.py", BASE).put(LAUNCH, more)
    return files.write(folder)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
@pytest.mark.parametrize("more", ROOMS.values(), ids=ROOMS)
def test_the_piece_without_a_slash_is_named(tmp_path: Path, more: str, text: str) -> None:
    root = written(tmp_path, more)
    (told, *_) = of_text(
        text.format(f"/elsewhere/install/{PACKAGE}/share/{PACKAGE}launch/base.launch.py"), root
    )
    assert "the slash between the folder" in told.cause
    lines = more.splitlines()
    assert told.place == f"src/{PACKAGE}/{LAUNCH}:{len(lines)}"
    assert told.fix.startswith("write '/launch")
    new, old = told.fix.removeprefix("write ").split(" instead of ")
    mended = lines[-1].replace(old.strip("'"), new.strip("'"))
    assert "/launch" in mended
    assert "//" not in mended


@pytest.mark.parametrize("inner", ["launch/bas.launch.py", "_msgs/base.launch.py", "/launch/base.launch.xml"])
def test_no_slash_is_missing(tmp_path: Path, inner: str) -> None:
    root = written(tmp_path, "")
    found = of_text(REFUSED.format(f"/elsewhere/install/{PACKAGE}/share/{PACKAGE}{inner}"), root)
    assert not any("slash" in one.cause for one in found)
    assert not any("rules failed" in one.cause for one in found)


def test_a_piece_with_a_slash_too_many_is_the_cause(tmp_path: Path) -> None:
    path = f"os.path.join({SHARE}, '/launch/base.launch.py')"
    begin = f"import os\n\nfrom ament_index_python.packages import get_package_share_directory\nfrom launch import LaunchDescription\n\nPATH = {path}\n"
    text = f"{begin}\n\ndef generate_launch_description():\n    return LaunchDescription([])\n"
    (told, *_) = of_text(REFUSED.format("/launch/base.launch.py"), written(tmp_path, text))
    assert (told.code, told.place) == ("path-absolute", f"src/{PACKAGE}/{LAUNCH}:6")
