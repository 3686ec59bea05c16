"""Where a package is that nobody finds: in src, but no package; in a workspace below or beside; under its old name."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from test_layout import typed
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.diagnose.packaging.whereabouts import in_another_workspace, nowhere_seen
from ros2lab.diagnose.sources.interfaces import INDEX

NOBODY = 65534
NOT_FOUND = "$ ros2 run kite_camera shutter\nPackage 'kite_camera' not found"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Return a right workspace that was never built."""
    return Files.right(NAMES[1]).write(tmp_path / "ws")


def as_archive(path: Path) -> None:
    path.with_name("kite_camera.tar.gz").write_bytes(b"")


def as_submodule(path: Path) -> None:
    path.mkdir()
    (path.parents[1] / ".gitmodules").write_text('[submodule "src/kite_camera"]\n')


def with_(name: str) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        path.mkdir()
        (path / name).write_text("")

    return make


@pytest.mark.parametrize(
    ("make", "cause", "fix"),
    [
        (
            lambda path: path.symlink_to("/home/noor/kite_camera"),
            "a link to /home/noor/kite_camera,",
            "rm src/kite",
        ),
        (lambda path: path.symlink_to(path.parents[1] / "log"), "a link to ", "rm src/kite_camera"),
        (Path.mkdir, "is empty", "put the package itself into src/kite_camera"),
        (as_submodule, "is empty", "submodule update --init"),
        (as_archive, "is packed", "unpack it into src"),
        (Path.touch, "is a file, not a folder", "put the package itself"),
        (
            with_("Package.xml"),
            "has a Package.xml",
            "mv src/kite_camera/Package.xml src/kite_camera/package.xml",
        ),
        (with_("package.xml.txt"), "has a package.xml.txt", "mv src/kite_camera/package.xml.txt"),
        (with_("shutter.py"), "has no package.xml", "put the package itself"),
    ],
)
def test_what_bears_the_name_is_told_with_what_it_lacks(
    root: Path, make: Callable[[Path], None], cause: str, fix: str
) -> None:
    make(root / "src/kite_camera")
    (found, *_) = of_text(NOT_FOUND, root)
    assert (found.code, found.place) == ("package-passed-over", found.cause.partition(" ")[0])
    assert found.place in ("src/kite_camera", "src/kite_camera.tar.gz")
    assert of_text("ModuleNotFoundError: No module named 'kite_camera'", root) == [found]
    assert cause in found.cause
    assert found.fix.startswith(fix) or fix in found.fix


@pytest.mark.parametrize("name", ["config", "launch", "talker.py"])
def test_what_is_inside_a_package_is_none(root: Path, name: str) -> None:
    (found, *_) = of_text(f"$ ros2 run {name} talker\nPackage '{name}' not found", root)
    assert found.code == "package-not-found"


@pytest.mark.parametrize(("program", "is_meant"), [("talker", True), ("talkr", True), ("shutter", False)])
def test_a_package_with_a_similar_name_is_meant_if_it_has_the_program(
    root: Path, program: str, is_meant: bool
) -> None:
    (found, *_) = of_text(f"$ ros2 run my_boot {program}\nPackage 'my_boot' not found", root)
    assert ("ros2 run my_bot talker" in found.fix) == is_meant


def test_a_package_of_another_workspace_is_told_where_it_is(tmp_path: Path) -> None:
    """Beside this workspace; below it; and where the one below was, before it was moved."""
    base = Files.right(NAMES[0]).write(tmp_path / "base_ws")
    root = Files.right(NAMES[1]).write(tmp_path / "over_ws")
    typed("colcon build", base)
    typed("colcon build", root)
    module = root / "src/my_bot/my_bot/talker.py"
    texts = (
        "Package 'robot_controller' not found",
        f"  File \"{module}\", line 1, in <module>\nModuleNotFoundError: No module named 'robot_controller'",
    )

    def told() -> str:
        first, second = (of_text(text, root)[0] for text in texts)
        assert (first.code, first.cause, first.fix) == (second.code, second.cause, second.fix)
        assert (first.code, second.place) == ("not-sourced", "src/my_bot/my_bot/talker.py:1")
        return f"{first.cause} {first.fix}"

    assert f"is in another workspace, {base}," in told()
    assert f"source {base}/install/setup.bash, run colcon build here, and source {root}/install" in told()
    typed(f"source {base}/install/setup.bash && colcon build", root)
    assert f"is in {base}/install, which install/setup.bash sources, too" in told()
    assert told().endswith(f" source {root}/install/setup.bash")
    base.rename(tmp_path / "Basis")
    assert f"{base}/install, on which the workspace was built, is not there any more" in told()


def test_folders_that_are_closed_are_passed_over() -> None:
    """Those of other users beside the workspace, and what a link in it leads into."""
    with tempfile.TemporaryDirectory() as folder:  # pytest's own is closed to others
        home = Path(folder)
        root = Files.right(NAMES[1]).write(home / "ws")
        (home / "other/install/depth/share").mkdir(parents=True)
        (root / "src/kite_camera").symlink_to(home / "other/kite")
        of_text(NOT_FOUND, root)  # imports all, which may be closed to others, too
        home.chmod(0o755)
        (home / "other").chmod(0)
        is_root = os.geteuid() == 0
        try:
            os.setresuid(NOBODY, NOBODY, 0) if is_root else None
            linked, other = nowhere_seen(root, "kite_camera"), in_another_workspace(root, "depth")
        finally:
            os.setresuid(0, 0, 0) if is_root else None
            (home / "other").chmod(0o755)
    assert other is None
    assert linked
    assert "src/kite_camera is a link to " in linked.cause


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("package.xml", "</description>", "</description>\n  <exec_depend>old_bot</exec_depend>"),
        ("my_bot/talker.py", "import rclpy\n", "import old_bot.tools\nimport rclpy\n"),
        (
            "my_bot/talker.py",
            "import rclpy\n",
            "import rclpy\nHOME = get_package_share_directory('old_bot')\n",
        ),
    ],
)
def test_who_still_asks_for_the_old_name_of_a_package_is_told(
    tmp_path: Path, file: str, old: str, new: str
) -> None:
    files = Files.right(NAMES[1])
    assert [finding.code for finding in _after_rename(files, tmp_path / "nobody")] == ["left-over"]
    (found,) = _after_rename(files.change(file, old, new), tmp_path / "asks")
    assert (found.code, found.place.rpartition(":")[0]) == ("launch-package", f"src/my_bot/{file}")
    assert found.fix.startswith(
        f"write my_bot instead of old_bot in {found.place}, build again, and rm -r build/"
    )


def test_a_module_may_keep_the_old_name_of_its_package(tmp_path: Path) -> None:
    files = Files.right(NAMES[1]).put("old_bot/__init__.py", "").put("old_bot/tools.py", "")
    files.change("my_bot/talker.py", "import rclpy\n", "import old_bot.tools\nimport rclpy\n")
    assert "launch-package" not in [finding.code for finding in _after_rename(files, tmp_path)]


def _after_rename(files: Files, root: Path) -> list[Finding]:
    """Return what is told of a package that was built under another name, too."""
    files.write(root)
    lib = root / "install/old_bot/lib/old_bot"
    lib.mkdir(parents=True)
    for name in ("talker", "ears", "wheels"):
        (lib / name).write_text("#!/usr/bin/python3\n")
    index = root / "install/old_bot" / INDEX
    index.mkdir(parents=True)
    (index / "old_bot").touch()
    return [finding for finding in of_workspace(root) if "old_bot" in finding.cause]
