"""What would be installed, what is installed and what was asked for: built by the real colcon, fixed as is said."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from workspace_files import MANIFEST, NAMES, NODE, Files

from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.environment import lab_environment

NOT_FOUND = "Package 'my_bot' not found: \"package 'my_bot' not found, searching: ['/opt/ros']\""


def typed(command: str, folder: Path) -> str:
    return subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env=lab_environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    ).stdout


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for what is made once; what is built knows its path, so every test works at the same one."""
    return tmp_path_factory.mktemp("layout")


@pytest.fixture
def root(kept: Path) -> Path:
    """Return a right workspace that was never built."""
    shutil.rmtree(kept / "home", ignore_errors=True)
    return Files.right(NAMES[1]).write(kept / "home" / "ws")


@pytest.fixture
def built(root: Path, kept: Path) -> Path:
    """Return a right workspace after `colcon build`, with the times that its files had then."""
    copy = kept / "built"
    if not copy.exists():
        typed("colcon build", root)
        shutil.copytree(root, copy, symlinks=True)
    shutil.rmtree(root)
    return Path(shutil.copytree(copy, root, symlinks=True))


def commands(finding: Finding) -> list[str]:
    """Return every command of a fix, word for word."""
    parts = re.split(r", then |, and |; |, run | there", finding.fix)
    found = [part for part in parts if re.match(r"(rm|mv|cp|cd|colcon) ", part)]
    assert found, finding.fix
    return found


EXECUTABLES = {"my_bot talker", "my_bot ears"}


def executables(root: Path, *lines: str) -> set[str]:
    """Return what is listed after some commands, among what these print."""
    words = " && ".join([*lines, "source install/setup.bash", "ros2 pkg executables my_bot"])
    return set(typed(words, root).splitlines())


def is_right(root: Path, *findings: Finding) -> bool:
    """Type what the fixes say, build what nobody has built, and return whether all is right then."""
    lines = [command for finding in findings for command in commands(finding)]
    if not (root / "install/my_bot").is_dir() and not any(line.startswith("colcon build") for line in lines):
        lines.append("colcon build")
    listed = executables(root, *lines)
    return of_workspace(root) == [] and listed >= EXECUTABLES


def _ignored(root: Path) -> None:
    (root / "src/my_bot/COLCON_IGNORE").touch()


def _ignored_above(root: Path) -> None:
    (root / "src/robots").mkdir()
    shutil.move(root / "src/my_bot", root / "src/robots/my_bot")
    (root / "src/robots/AMENT_IGNORE").touch()


def _nested(root: Path) -> None:
    shutil.copytree(root / "src/my_bot", root / "src/other")
    for path in ("package.xml", "setup.py", "setup.cfg"):
        text = (root / "src/other" / path).read_text()
        (root / "src/other" / path).write_text(text.replace("my_bot", "other"))
    (root / "src/other/my_bot").rename(root / "src/other/other")
    (root / "src/other/resource/my_bot").rename(root / "src/other/resource/other")
    for path in (root / "src/other").rglob("*.launch.py"):
        path.write_text(path.read_text().replace("my_bot", "other"))
    shutil.move(root / "src/my_bot", root / "src/other/my_bot_package")


def _outside(root: Path) -> None:
    shutil.move(root / "src/my_bot", root.parent / "my_bot")


def _built(command: str = "colcon build", below: str = ".") -> Callable[[Path], None]:
    return lambda root: print(typed(command, root / below))


@pytest.mark.parametrize(
    ("makes", "code"),
    [
        pytest.param(_ignored, "package-passed-over", marks=pytest.mark.thorough),
        pytest.param(_ignored_above, "package-passed-over", marks=pytest.mark.thorough),
        pytest.param(_nested, "package-passed-over", marks=pytest.mark.thorough),
        (_outside, "package-outside"),
        (_built(below="src"), "build-elsewhere"),
        pytest.param(_built(below="src/my_bot"), "build-elsewhere", marks=pytest.mark.thorough),
        pytest.param(_built(below=".."), "build-elsewhere", marks=pytest.mark.thorough),
        pytest.param(
            _built("colcon build --symlink-install", "src"), "build-elsewhere", marks=pytest.mark.thorough
        ),
    ],
)
def test_a_package_that_ros_does_not_find(root: Path, makes: Callable[[Path], None], code: str) -> None:
    """The same cause comes first with and without the error, and its fix brings the package."""
    makes(root)
    for found in (of_workspace(root), of_text(NOT_FOUND, root)):
        assert found[0].code == code
    assert is_right(root, found[0])


def _edit_installed(root: Path) -> None:
    _edit(next((root / "install").rglob("talker.py")))


def _edit_built(root: Path) -> None:
    _edit(next((root / "build").rglob("talker.py")))


def _edit_launch(root: Path) -> None:
    path = next((root / "install").rglob("robot.launch.py"))
    path.write_text(path.read_text() + "\n# running\n")
    _edit(path)


def _edit(path: Path) -> None:
    """Change a file some time after the build."""
    path.write_text(path.read_text().replace("running", "walking"))
    late = path.stat().st_mtime + 60
    os.utime(path, (late, late))


@pytest.mark.parametrize(
    "makes",
    [
        _edit_installed,
        *(pytest.param(made, marks=pytest.mark.thorough) for made in (_edit_built, _edit_launch)),
    ],
)
def test_an_edit_where_a_build_writes_is_saved(built: Path, makes: Callable[[Path], None]) -> None:
    makes(built)
    (finding,) = of_workspace(built)
    assert finding.code == "edited-in-install"
    assert is_right(built, finding)
    assert any("walking" in path.read_text() for path in (built / "src").rglob("*.py"))


def test_an_edit_in_both_is_never_overwritten_by_the_advice(built: Path) -> None:
    _edit_installed(built)
    path = built / "src/my_bot/my_bot/talker.py"
    path.write_text(path.read_text().replace("count = 0", "count = 7"))
    late = path.stat().st_mtime + 90
    os.utime(path, (late, late))
    finding = of_workspace(built)[0]
    assert finding.code == "edited-in-install"
    assert finding.fix.startswith("compare the two (diff src/my_bot/my_bot/talker.py install/")


def test_in_a_copy_with_new_times_nothing_was_edited_by_hand(built: Path, tmp_path: Path) -> None:
    """What differs there is an edit in src."""
    copied = tmp_path / "copied"
    shutil.copytree(built, copied, copy_function=shutil.copyfile)
    source = copied / "src/my_bot/my_bot/talker.py"
    source.write_text(source.read_text().replace("count = 0", "count = 7"))
    assert [one.code for one in of_workspace(copied) if one.code == "edited-in-install"] == []


@pytest.mark.thorough
def test_a_workspace_that_was_moved_after_a_build_with_links(root: Path) -> None:
    typed("colcon build --symlink-install", root)
    root = root.rename(root.with_name("other"))
    (finding,) = of_workspace(root)
    assert finding.code == "link-stale"
    assert is_right(root, finding)


def test_a_file_that_was_renamed_after_a_build_with_links(root: Path) -> None:
    typed("colcon build --symlink-install", root)
    launch = root / "src/my_bot/launch"
    (launch / "robot.launch.py").rename(launch / "bot.launch.py")
    found = {one.code: one for one in of_workspace(root)}
    assert set(found) == {"install-stale", "link-stale"}
    assert is_right(root, found["link-stale"])


@pytest.mark.thorough
def test_what_an_earlier_build_left(built: Path) -> None:
    """An executable and a launch file that were renamed in the sources, and built again."""
    setup = built / "src/my_bot/setup.py"
    setup.write_text(setup.read_text().replace("'wheels = ", "'motors = "))
    launch = built / "src/my_bot/launch"
    text = (launch / "robot.launch.py").read_text().replace("executable='wheels'", "executable='motors'")
    (launch / "robot.launch.py").unlink()
    (launch / "bot.launch.py").write_text(text)
    typed("colcon build", built)
    found = of_workspace(built)
    assert [one.code for one in found] == ["left-over", "left-over"]
    assert is_right(built, *found)


MOVES = [
    ("launch/robot.launch.py", "launch/robot.Launch.py"),
    ("launch/robot.launch.py", "launch/robot.py"),
    ("config/robot.yaml", "config/robot.YAML"),
    ("config/robot.yaml", "params/robot.yaml"),
]


# Two that meet nowhere share a build, and so does a file that is installed where nobody looks.
@pytest.mark.parametrize("moves", [MOVES[::2], pytest.param(MOVES[1::2], marks=pytest.mark.thorough)])
def test_a_file_that_no_pattern_takes(root: Path, moves: list[tuple[str, str]]) -> None:
    package = root / "src/my_bot"
    setup = package / "setup.py"
    target = "os.path.join('share', package_name, 'launch')"
    setup.write_text(setup.read_text().replace(target, "'share/mybot/launch'"))
    (finding,) = of_workspace(root)
    assert finding.code == "installed-elsewhere"
    meant, old = re.findall(r"'([^']+)'", finding.fix)
    setup.write_text(setup.read_text().replace(f"'{old}'", f"'{meant}'"))
    assert of_workspace(root) == []
    for old, new in moves:
        (package / new).parent.mkdir(exist_ok=True)
        (package / old).rename(package / new)
        (finding,) = (one for one in of_workspace(root) if one.code == "not-in-data-files")
        assert new in finding.cause
        text = setup.read_text()
        if added := re.match(r"add (\(.*?\)) to data_files", finding.fix):
            setup.write_text(text.replace("data_files=[", f"data_files=[{added[1]},"))
        else:
            written = re.match(r"write (\S+) instead of (\S+), ", finding.fix)
            assert written, finding.fix
            setup.write_text(text.replace(written[2], written[1]))
        assert "not-in-data-files" not in [one.code for one in of_workspace(root)]
    assert executables(root, "colcon build") >= EXECUTABLES
    for _, new in moves:
        assert list((root / "install").rglob(Path(new).name))


def test_what_belongs_to_somebody_else(built: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, _mode: "install" not in Path(path).parts)
    (finding,) = of_workspace(built)
    assert finding.code == "not-writable"
    assert "chown" in finding.fix


def _mixin(root: Path) -> None:
    path = root / "src/my_bot/my_bot/talker.py"
    text = (
        NODE.replace("CLASS(Node)", "Talker(Loud, Node)")
        .replace("PUBLISHER", "pub")
        .replace("CALLBACK", "tick")
    )
    mixin = "class Loud:\n    def shout(self, text):\n        self.get_logger().info(text.upper())\n\n\n"
    text = (
        text.replace("class Talker", f"{mixin}class Talker")
        .replace("MODULE", "talker")
        .replace("CLASS", "Talker")
    )
    path.write_text(
        text.replace("TOPIC", "robot/status").replace("self.get_logger().info(msg", "self.shout(msg", 1)
    )


def _relative(root: Path) -> None:
    package = root / "src/my_bot/my_bot"
    (package / "numbers.py").write_text("START = 0\n")
    path = package / "talker.py"
    path.write_text(
        path.read_text()
        .replace("import rclpy\n", "import rclpy\n\nfrom .numbers import START\n", 1)
        .replace("count = 0", "count = START")
    )


def _metadata_in_cfg(root: Path) -> None:
    package = root / "src/my_bot"
    text = (package / "setup.py").read_text()
    for word in ("version='0.1.0'", "maintainer='anna'", "description='Three nodes'", "license='Apache-2.0'"):
        text = text.replace(f"    {word},\n", "")
    (package / "setup.py").write_text(text)
    cfg = (package / "setup.cfg").read_text()
    (package / "setup.cfg").write_text(f"[metadata]\nversion = 0.1.0\ndescription = Three\n{cfg}")


def _package_at_root(root: Path) -> None:
    for path in list((root / "src/my_bot").iterdir()):
        shutil.move(path, root)
    shutil.rmtree(root / "src")


def _hidden_copy(root: Path) -> None:
    shutil.copytree(root / "src/my_bot", root / "src/my_bot_old")
    (root / "src/my_bot_old/COLCON_IGNORE").touch()


def _hidden_other(root: Path) -> None:
    (root / "src/big").mkdir()
    (root / "src/big/package.xml").write_text(MANIFEST.replace("PACKAGE", "big"))
    (root / "src/big/COLCON_IGNORE").touch()


def _linked(root: Path) -> None:
    shutil.move(root / "src/my_bot", root.parent / "elsewhere")
    (root / "src/my_bot").symlink_to(root.parent / "elsewhere")


def _beside(root: Path) -> None:
    shutil.move(root / "src/my_bot", root / "my_bot")


def _deeper(root: Path) -> None:
    (root / "src/team/robots").mkdir(parents=True)
    shutil.move(root / "src/my_bot", root / "src/team/robots/my_bot")


def _fixture(root: Path) -> None:
    folder = root / "src/my_bot/test/fixture"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST.replace("PACKAGE", "made_up"))


def _two_workspaces(root: Path) -> None:
    shutil.copytree(root / "src", root.parent / "second" / "src")


def _other_yaml(root: Path) -> None:
    (root / "src/my_bot/config/labels.txt").write_text("one\n")
    (root / "src/my_bot/launch/README.md").write_text("# How to launch\n")


# What is unusual, in groups that one workspace can be all of, and the build that each group has.
UNUSUAL: list[tuple[list[Callable[[Path], None]], str]] = [
    ([_mixin, _relative, _metadata_in_cfg, _hidden_copy], ""),
    ([_fixture, _other_yaml, _hidden_other, _linked], " --symlink-install"),
    ([_two_workspaces, _deeper], " --merge-install"),
    ([_package_at_root], ""),
    ([_beside], " --symlink-install"),
]


@pytest.mark.parametrize("makes", [makes for group, _ in UNUSUAL for makes in group])
def test_right_and_unusual_workspaces_raise_no_alarm(root: Path, makes: Callable[[Path], None]) -> None:
    makes(root)
    assert of_workspace(root) == []


@pytest.mark.parametrize(
    ("group", "option"),
    [UNUSUAL[0], *(pytest.param(*built, marks=pytest.mark.thorough) for built in UNUSUAL[1:])],
)
def test_nor_do_they_when_they_are_built(
    root: Path, group: list[Callable[[Path], None]], option: str
) -> None:
    for makes in group:
        makes(root)
    assert of_workspace(root) == []
    typed(f"colcon build{option}", root)
    assert list((root / "install").rglob("robot.launch.py"))  # so it was built
    assert of_workspace(root) == []
