"""What was built against the sources, with the real colcon."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from typer.testing import CliRunner
from workspace_files import NAMES, Files

from deadlines import DEADLINE
from ros2lab import environment
from ros2lab.cli import app
from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.diagnose.packaging.installed import to_build
from ros2lab.diagnose.sources.interfaces import INDEX
from ros2lab.workspace import Workspace


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a right workspace that is built."""
    root = Files.right(NAMES[0]).write(tmp_path_factory.mktemp("built") / "ws")
    assert Workspace(root).build(show=False).is_ok
    return root


@pytest.fixture
def workspace(built: Path, tmp_path: Path) -> Path:
    """Return a copy of it, to be changed."""
    return Path(shutil.copytree(built, tmp_path / "ws", symlinks=True))


def codes(findings: list[Finding]) -> list[str]:
    return [finding.code for finding in findings]


def told_to_build(root: Path, place: str, fix: str) -> str:
    """Return the command that is told to follow a fix of a file of the package."""
    (package,) = (root / "src").iterdir()
    return to_build(root, [Finding("x", "It is wrong.", f"src/{package.name}/{place}" if place else "", fix)])


@pytest.mark.parametrize(
    ("place", "fix", "is_told"),
    [
        ("robot_controller/status_publisher.py:3", "write x", True),
        ("launch/robot.launch.py:9", "write x", True),
        ("config/robot.yaml", "write x", True),
        ("setup.py:20", "write x", True),
        ("setup.py:20", "write x, and build again", False),
        ("robot_controller/status_publisher.py:3", "", False),
        ("package.xml:9", "write x", False),
        ("robot_controller/status_publisher.py:3", "add <depend>rclpy</depend> to package.xml", False),
        ("notes.py", "write x", False),
        ("not_there.py:1", "write x", False),
        ("", "source install/setup.bash", False),
    ],
)
def test_a_build_follows_a_change_of_what_runs_as_a_copy(
    workspace: Path, place: str, fix: str, is_told: bool
) -> None:
    (workspace / "src/robot_controller/notes.py").touch()
    command = "colcon build --packages-select robot_controller"
    assert told_to_build(workspace, place, fix) == (command if is_told else "")


def test_where_nothing_is_built_no_build_is_told(tmp_path: Path) -> None:
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    assert told_to_build(root, "robot_controller/status_publisher.py:3", "write x") == ""


def test_a_fresh_build_is_right(workspace: Path) -> None:
    assert of_workspace(workspace) == []


def test_an_edit_after_the_build_is_seen(workspace: Path) -> None:
    """Also if the file is of the same length and the clock stood still."""
    path = workspace / "src/robot_controller/robot_controller/status_publisher.py"
    path.write_text(path.read_text().replace("running", "waiting"))
    (finding,) = of_workspace(workspace)
    assert finding.code == "install-stale"
    assert finding.place.endswith("status_publisher.py")


@pytest.mark.parametrize(
    "mended", [("self.count += 1", "self.count = self.count + 1"), ("self.count = 0", "self.count = 1")]
)
def test_an_error_of_what_was_built_before_an_edit(workspace: Path, mended: tuple[str, str]) -> None:
    """What is right in src by now is not blamed once more, whether the line that was printed changed or another."""
    module = "robot_controller/status_publisher.py"
    path = workspace / "src/robot_controller" / module
    lines = path.read_text().splitlines()
    number = next(n for n, line in enumerate(lines, 1) if "self.count += 1" in line)
    path.write_text(path.read_text().replace(*mended))
    (copy,) = workspace.glob(f"install/robot_controller/lib/python3*/site-packages/{module}")
    text = (
        f'Traceback (most recent call last):\n  File "{copy}", line {number}, in on_timer\n'
        "    self.count += 1\nTypeError: 'NoneType' object is not callable"
    )
    (finding,) = of_text(text, workspace)
    assert finding.code == "install-stale"
    assert finding.fix.startswith("colcon build --packages-select robot_controller")
    assert finding.fix.endswith("run the same command again")


@pytest.mark.parametrize(
    ("added", "message", "is_told"),
    [
        ("LIMIT = 1\n", "ImportError: cannot import name 'LIMIT' from 'robot_controller.status_publisher' (x.py)", True),
        ("def lift(t):\n    pass\n", "AttributeError: module 'robot_controller.status_publisher' has no attribute 'lift'", True),
        ("class Leg:\n    def lift(self):\n        pass\n", "AttributeError: 'Leg' object has no attribute 'lift'", True),
        ("def lift(t, speed):\n    pass\n", "TypeError: lift() got an unexpected keyword argument 'speed'", True),
        ("LIMITS = 1\n", "ImportError: cannot import name 'LIMIT' from 'robot_controller.status_publisher' (x.py)", False),
        ("def lift(t):\n    pass\n", "AttributeError: 'NoneType' object has no attribute 'lift'", False),
        ("total = int('1')\n", "TypeError: unsupported operand type(s) for +: 'int' and 'str'", False),
        ("print(lift())\n", "TypeError: lift() takes 0 positional arguments but 1 was given", False),
    ],
)  # fmt: skip
def test_what_another_file_has_in_src_by_now_is_not_said_to_be_missing(
    workspace: Path, added: str, message: str, *, is_told: bool
) -> None:
    (site,) = workspace.glob("install/robot_controller/lib/python3*/site-packages")
    user = "robot_controller/command_subscriber.py"
    for folder in (site, workspace / "src/robot_controller"):
        text = (folder / user).read_text()
        (folder / user).write_text(f"from robot_controller.status_publisher import *\n{text}")
    home = workspace / "src/robot_controller/robot_controller/status_publisher.py"
    home.write_text(f"{home.read_text()}\n\n{added}")
    text = (
        f'Traceback (most recent call last):\n  File "{site / user}", line 1, in <module>\n    x\n{message}\n'
    )
    found = of_text(text.replace("    x\n", ""), workspace)[0]
    assert ("older build" in found.cause) is is_told
    if is_told:
        assert found.place == "src/robot_controller/robot_controller/status_publisher.py"
        assert found.fix.startswith("colcon build --packages-select robot_controller, ")


def test_a_new_file_and_a_new_entry_point_are_seen(workspace: Path) -> None:
    package = workspace / "src/robot_controller"
    node = (package / "robot_controller/status_publisher.py").read_text()
    (package / "robot_controller/again.py").write_text(node.replace("'status_publisher'", "'again'"))
    setup = package / "setup.py"
    setup.write_text(
        setup.read_text().replace(
            "'console_scripts': [", "'console_scripts': ['again = robot_controller.again:main',"
        )
    )
    assert codes(of_workspace(workspace)) == ["install-stale"]
    (finding,) = of_text("$ ros2 run robot_controller again\nNo executable found", workspace)
    assert finding.code == "install-stale"
    # A copy whose node still has the first one's name cannot be told apart from it.
    (package / "robot_controller/again.py").write_text(node)
    assert codes(of_workspace(workspace)) == ["install-stale", "name-twice"]


def test_a_linked_build_is_stale_by_its_entry_points_alone(tmp_path: Path) -> None:
    """An edited module is what runs; an edited entry point is not."""
    root = Files.right(NAMES[1]).write(tmp_path / "ws")
    assert Workspace(root).build(symlink=True, show=False).is_ok
    path = root / "src/my_bot/my_bot/talker.py"
    path.write_text(path.read_text() + "def speak():\n    pass\n")
    assert of_workspace(root) == []
    assert [
        told_to_build(root, place, "write x")
        for place in ("my_bot/talker.py:3", "launch/robot.launch.py", "setup.py")
    ] == [
        "",
        "",
        "colcon build --packages-select my_bot",
    ]
    setup = root / "src/my_bot/setup.py"
    setup.write_text(setup.read_text().replace("talker:main", "talker:speak"))
    assert codes(of_workspace(root)) == ["install-stale"]


@pytest.mark.parametrize("version", ["0.0.1", "0.1.1"])
def test_a_build_of_another_version_counts(workspace: Path, version: str) -> None:
    """The description of the version before stays beside it, with its entry points."""
    setup = workspace / "src/robot_controller/setup.py"
    other = re.sub(r"(version=.)[0-9.]+", rf"\g<1>{version}", setup.read_text())
    line = other.index("status_publisher =") - 1
    setup.write_text(f"{other[:line]}'again = robot_controller.status_publisher:main', {other[line:]}")
    assert "install-stale" in codes(of_workspace(workspace))
    assert Workspace(workspace).build(show=False).is_ok
    assert len([*workspace.glob("install/robot_controller/lib/python3*/site-packages/*.egg-info")]) == 2
    assert of_workspace(workspace) == []
    setup.write_text(setup.read_text().replace("'again =", "'once_more ="))
    assert "install-stale" in codes(of_workspace(workspace))


def test_a_package_that_was_not_built_is_seen(workspace: Path) -> None:
    Files.right(NAMES[1]).write(workspace)
    assert codes(of_workspace(workspace)) == ["not-built"]
    assert codes(of_text("Package 'my_bot' not found", workspace)) == ["not-built"]


@pytest.mark.thorough
@pytest.mark.parametrize("symlink", [False, pytest.param(True, marks=pytest.mark.thorough)])
def test_a_package_whose_build_failed_is_not_built(tmp_path: Path, symlink: bool) -> None:
    """Though colcon and setuptools have left files of it in install; what the build says is explained, too."""
    files = Files.right(NAMES[0]).remove("resource/PACKAGE")
    root = files.write(tmp_path / "ws")
    result = Workspace(root).build(symlink=symlink, show=False)
    assert not result.is_ok
    findings = of_text(str(result), root)
    assert codes(findings) == ["marker-missing"]
    make = "mkdir src/robot_controller/resource && touch src/robot_controller/resource/robot_controller"
    assert findings[0].fix == make
    assert (root / "install/robot_controller/share/robot_controller").is_dir()
    assert codes(of_workspace(root, {})) == ["marker-missing", "not-built"]
    files.put("resource/PACKAGE", "").write(root)
    assert codes(of_text("Package 'robot_controller' not found", root)) == ["not-built"]


def test_a_terminal_that_has_not_sourced_is_seen(workspace: Path) -> None:
    """Nothing is said of a terminal that has, nor where no terminal is asked about."""
    assert codes(of_workspace(workspace, {})) == ["not-sourced"]
    sourced = {"AMENT_PREFIX_PATH": f"{workspace}/install/robot_controller"}
    assert of_workspace(workspace, sourced) == []
    assert codes(of_text("Package 'robot_controller' not found", workspace)) == ["not-sourced"]


def test_what_is_true_of_the_terminal_alone_is_not_all_that_is_said(workspace: Path) -> None:
    """Its node may still do nothing, and then the files are right."""
    said = CliRunner().invoke(app, ["diagnose", str(workspace)], env={"AMENT_PREFIX_PATH": ""}).stdout
    first, _, rest = said.partition("Nothing else was found. It looked at ")
    assert first.startswith("not-sourced")
    assert "ros2lab diagnose --run" in rest
    (workspace / "src/robot_controller/setup.cfg").unlink()
    said = CliRunner().invoke(app, ["diagnose", str(workspace)], env={"AMENT_PREFIX_PATH": ""}).stdout
    assert "not-sourced" in said
    assert "Nothing else" not in said


def test_the_order_of_overlays_is_seen(built: Path, workspace: Path) -> None:
    first, second = (f"{root}/install/robot_controller" for root in (built, workspace))
    assert codes(of_workspace(workspace, {"AMENT_PREFIX_PATH": f"{first}:{second}"})) == ["overlay-order"]
    assert of_workspace(workspace, {"AMENT_PREFIX_PATH": f"{second}:{first}"}) == []


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("self.count = 0", "self.publishers = []", "node-property"),
        ("self.timer_callback)", "self.timer_callback())", "callback-called"),
        *(
            pytest.param(*row, marks=pytest.mark.thorough)
            for row in (
                (
                    "super().__init__('status_publisher')",
                    "super().__init__('status publisher')",
                    "node-name-invalid",
                ),
                ("(String,", "(str,", "type-not-a-message"),
            )
        ),
        ("    rclpy.init(args=args)\n", "", "rclpy-init-missing"),
    ],
)
def test_the_real_text_of_a_run_is_explained(workspace: Path, old: str, new: str, code: str) -> None:
    """What Python really prints leads to the line in src, whether or not it is said where the workspace is."""
    root = Path(workspace)
    for folder in (
        root / "src/robot_controller",
        *root.glob("install/robot_controller/lib/python3*/site-packages"),
    ):
        path = folder / "robot_controller/status_publisher.py"
        path.write_text(path.read_text().replace(old, new))
    (site,) = root.glob("install/robot_controller/lib/python3*/site-packages")
    environ = environment.lab_environment()
    environ["PYTHONPATH"] = f"{site}:{environ.get('PYTHONPATH', '')}"
    program = "from robot_controller.status_publisher import main; main()"
    run = subprocess.run(
        ["python", "-c", program], env=environ, capture_output=True, text=True, timeout=DEADLINE, check=False
    )
    assert run.returncode
    line = next(
        n
        for n, text in enumerate(
            (root / "src/robot_controller/robot_controller/status_publisher.py").read_text().splitlines(), 1
        )
        if (new or "node = ") in text
    )
    for findings in (of_text(run.stderr), of_text(run.stderr, root)):
        assert (findings[0].code, findings[0].place) == (
            code,
            f"src/robot_controller/robot_controller/status_publisher.py:{line}",
        )


def test_dashes_that_setuptools_takes_are_no_fault_once_it_is_built(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    for name in ("script_dir", "install_scripts"):
        files.change("setup.cfg", name, name.replace("_", "-"))
    root = files.write(tmp_path)
    assert {one.code for one in of_workspace(root)} == {"setup-cfg-dashes"}
    marker = root / "install" / NAMES[0].package / INDEX / NAMES[0].package
    marker.parent.mkdir(parents=True)
    marker.touch()
    assert "setup-cfg-dashes" not in {one.code for one in of_workspace(root)}


@pytest.mark.parametrize(
    ("rows", "fix"),
    [
        ("[develop]\nscript-dir=$base/lib/a\n", "write script_dir instead of script-dir"),
        (
            "[develop]\nscript-dir=a\n[install]\nscript-dir=a\n",
            "write script_dir instead of script-dir, and on line 4 script_dir instead of script-dir",
        ),
        ("[metadata]\nauthor-email=a@b.org\n", "write author_email instead of author-email"),
        ("[options.packages.find]\nto-find=a\n", "write to_find instead of to-find"),
        ("[options.data_files]\nshare/a-b=c\n", ""),
        ("[flake8]\nmax-line-length=99\n[tool:pytest]\njunit-family=xunit2\n", ""),
    ],
)
def test_dashes_stop_setuptools_wherever_it_reads(tmp_path: Path, rows: str, fix: str) -> None:
    files = Files.right(NAMES[0])
    setup = files.texts[files.path("setup.py")]
    files.put("setup.py", re.sub(r"(?s)'console_scripts': \[.*?\],", "", setup)).put("setup.cfg", rows)
    found = [one.fix for one in of_workspace(files.write(tmp_path)) if one.code == "setup-cfg-dashes"]
    assert found == [fix] * bool(fix)


def test_both_wrong_lines_of_a_copied_setup_cfg_are_told_at_once(tmp_path: Path) -> None:
    """The last one decides where colcon installs, and both are mended by what is told."""
    files, own = Files.right(NAMES[0]), f"lib/{NAMES[0].package}"
    for name in ("script_dir", "install_scripts"):
        files.change("setup.cfg", f"{name}=$base/{own}", f"{name}=$base/lib/another")
    root = files.write(tmp_path)
    (told,) = [one for one in of_workspace(root) if one.code == "setup-cfg-missing"]
    path = root / told.place.rpartition(":")[0]
    lines = path.read_text().splitlines()
    last, other = re.findall(r"`([^`]+)`", told.fix)
    lines[int(told.place.rpartition(":")[2]) - 1] = last
    lines[int(re.findall(r"line (\d+)", told.fix)[0]) - 1] = other
    path.write_text("\n".join(lines))
    assert "setup-cfg-missing" not in [one.code for one in of_workspace(root)]


def test_a_library_needs_no_folder_for_executables(tmp_path: Path) -> None:
    files = Files.right(NAMES[0])
    del files.texts[files.path("setup.cfg")]
    setup = files.texts[files.path("setup.py")]
    root = files.write(tmp_path / "a")
    assert "setup-cfg-missing" in {one.code for one in of_workspace(root)}
    listed = setup.partition("'console_scripts': [")[2].partition("]")[0]
    files.texts[files.path("setup.py")] = setup.replace(listed, "")
    codes = {one.code for one in of_workspace(files.write(tmp_path / "b"))}
    assert "setup-cfg-missing" not in codes
