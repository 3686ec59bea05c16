"""`ros2 pkg`: a new package, and what is known of the installed ones."""

from __future__ import annotations

import getpass
import os
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from catkin_pkg.package import parse_package

from deadlines import DEADLINE
from portable_ros2 import ament_index
from portable_ros2.new_package import LICENSES, license_text

NODES = [
    "--dependencies",
    "rclpy",
    "std_msgs",
    "--build-type",
    "ament_python",
    "--node-name",
    "status_publisher",
]
MAINTAINER = ["--maintainer-name", "Ada", "--maintainer-email", "ada@example.org"]
UNKNOWN_LICENSE = [
    "",
    "[WARNING]: Unknown license 'TODO: License declaration'.  This has been set in the package.xml, "
    "but no LICENSE file has been created.",
    "It is recommended to use one of the ament license identifiers:",
    *LICENSES,
]

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]


def tree(folder: Path) -> set[str]:
    """Return the files below a folder."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an install folder that comes first, with the package `arm`."""
    prefix = tmp_path / "install"
    index = prefix / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    (index / "arm").touch()
    (prefix / "share" / "arm").mkdir()
    (prefix / "share" / "arm" / "package.xml").write_text(
        '<?xml version="1.0"?>\n<package format="3"><name>arm</name><version>1.2.3</version>'
        "<depend>rclpy</depend><depend>std_msgs</depend><export/></package>\n"
    )
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{prefix}:{tmp_path / 'gone'}")
    return prefix


def install(prefix: Path, *names: str, mode: int = 0o755) -> None:
    """Put executables into the package `arm`."""
    for name in names:
        path = prefix / "lib" / "arm" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("#!/bin/sh\n")
        path.chmod(mode)


class TestCreate:
    """A new package."""

    def test_it_says_what_it_does(self, ros2: Ros2, tmp_path: Path) -> None:
        """What the course shows, line by line."""
        done = ros2("pkg", "create", *NODES, *MAINTAINER, "robot_controller")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.splitlines() == [
            "going to create a new package",
            "package name: robot_controller",
            f"destination directory: {tmp_path}",
            "package format: 3",
            "version: 0.0.0",
            "description: TODO: Package description",
            "maintainer: ['Ada <ada@example.org>']",
            "licenses: ['TODO: License declaration']",
            "build type: ament_python",
            "dependencies: ['rclpy', 'std_msgs']",
            "node_name: status_publisher",
            "creating folder ./robot_controller",
            "creating ./robot_controller/package.xml",
            "creating source folder",
            "creating folder ./robot_controller/robot_controller",
            "creating ./robot_controller/setup.py",
            "creating ./robot_controller/setup.cfg",
            "creating folder ./robot_controller/resource",
            "creating ./robot_controller/resource/robot_controller",
            "creating ./robot_controller/robot_controller/__init__.py",
            "creating folder ./robot_controller/test",
            "creating ./robot_controller/test/test_copyright.py",
            "creating ./robot_controller/test/test_flake8.py",
            "creating ./robot_controller/test/test_pep257.py",
            "creating ./robot_controller/robot_controller/status_publisher.py",
            *UNKNOWN_LICENSE,
        ]

    def test_the_files_are_those_of_the_course(self, ros2: Ros2, tmp_path: Path) -> None:
        """No more and no less, each created as it was said."""
        done = ros2("pkg", "create", *NODES, "--library-name", "words", "--license", "MIT", "robot")
        assert "Unknown license" not in done.stdout
        assert tree(tmp_path / "robot") == {
            "LICENSE",
            "package.xml",
            "resource/robot",
            "robot/__init__.py",
            "robot/status_publisher.py",
            "robot/words/__init__.py",
            "setup.cfg",
            "setup.py",
            "test/test_copyright.py",
            "test/test_flake8.py",
            "test/test_pep257.py",
        }
        said = {line.removeprefix("creating ./robot/") for line in done.stdout.splitlines()}
        assert tree(tmp_path / "robot") - {"LICENSE"} <= said
        assert "creating folder ./robot/robot/words" in done.stdout
        assert "library_name: words" in done.stdout
        assert (tmp_path / "robot" / "LICENSE").read_text() == license_text("MIT")

    def test_the_manifest_is_valid(self, ros2: Ros2, tmp_path: Path) -> None:
        """As catkin_pkg and so colcon reads it, without a warning."""
        ros2(
            "pkg",
            "create",
            *NODES,
            *MAINTAINER,
            "--license",
            "Apache-2.0",
            "--description",
            "It moves.",
            "robot",
        )
        warnings: list[str] = []
        package = parse_package(tmp_path / "robot", warnings=warnings)
        assert warnings == []
        assert (package.name, package.version, package.description) == ("robot", "0.0.0", "It moves.")
        assert (package.package_format, package.get_build_type()) == (3, "ament_python")
        assert [(person.name, person.email) for person in package.maintainers] == [("Ada", "ada@example.org")]
        assert package.licenses == ["Apache-2.0"]
        assert [depend.name for depend in package.exec_depends] == ["rclpy", "std_msgs"]
        tests = ["ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest"]
        assert [depend.name for depend in package.test_depends] == tests

    def test_its_text_is_laid_out_as_by_hand(self, ros2: Ros2, tmp_path: Path) -> None:
        """One empty line between the groups, whichever there are."""
        ros2("pkg", "create", "--build-type", "ament_cmake", "--package-format", "2", *MAINTAINER, "robot")
        assert (tmp_path / "robot" / "package.xml").read_text().splitlines() == [
            '<?xml version="1.0"?>',
            '<?xml-model href="http://download.ros.org/schema/package_format2.xsd" '
            'schematypens="http://www.w3.org/2001/XMLSchema"?>',
            '<package format="2">',
            "  <name>robot</name>",
            "  <version>0.0.0</version>",
            "  <description>TODO: Package description</description>",
            '  <maintainer email="ada@example.org">Ada</maintainer>',
            "  <license>TODO: License declaration</license>",
            "",
            "  <buildtool_depend>ament_cmake</buildtool_depend>",
            "",
            "  <test_depend>ament_lint_auto</test_depend>",
            "  <test_depend>ament_lint_common</test_depend>",
            "",
            "  <export>",
            "    <build_type>ament_cmake</build_type>",
            "  </export>",
            "</package>",
        ]

    @pytest.mark.parametrize(
        "text",
        [
            "Tom & Jerry <cat>",
            'it\'s "quoted"',
            "back\\slash",
            *(
                pytest.param(text, marks=pytest.mark.thorough)
                for text in ("two\nlines", "Zoë 日本", "{{ name }}", "%s")
            ),
        ],
    )
    def test_any_text_can_be_said(self, ros2: Ros2, tmp_path: Path, text: str) -> None:
        """What has a meaning in XML, in Python or in a template does not break the files."""
        texts = ["--description", text, "--maintainer-name", text, "--license", text]
        ros2("pkg", "create", "--build-type", "ament_python", *texts, "robot")
        root = ElementTree.parse(tmp_path / "robot" / "package.xml").getroot()
        assert [root.findtext(tag) for tag in ("description", "maintainer", "license")] == [text] * 3
        done = subprocess.run(
            [sys.executable, "setup.py", "--quiet", "--description", "--license"],
            cwd=tmp_path / "robot",
            capture_output=True,
            text=True,
            timeout=DEADLINE,
            check=True,
        )
        assert done.stdout.startswith(" ".join(text.split()) + "\n")

    @pytest.mark.parametrize("name", LICENSES)
    def test_a_known_licence_comes_with_its_text(self, ros2: Ros2, tmp_path: Path, name: str) -> None:
        """In the file LICENSE, and without a warning."""
        done = ros2("pkg", "create", "--build-type", "ament_python", "--license", name, "robot")
        assert (done.returncode, done.stderr) == (0, "")
        assert f"licenses: ['{name}']" in done.stdout
        assert "WARNING" not in done.stdout
        assert "software" in (tmp_path / "robot" / "LICENSE").read_text().lower()

    def test_the_licences_are_listed(self, ros2: Ros2, tmp_path: Path) -> None:
        """For `?` instead of a package, but its name is asked for, as by the real command."""
        done = ros2("pkg", "create", "--license", "?", "robot")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.splitlines() == ["Supported licenses:", *LICENSES]
        assert tree(tmp_path) == set()
        assert ros2("pkg", "create", "--license", "?").returncode == 2

    def test_an_unknown_licence_is_taken_with_a_warning(self, ros2: Ros2, tmp_path: Path) -> None:
        """Also one that only looks like a known one."""
        for number, name in enumerate(["Mine", "apache-2.0", "../licenses/MIT", ""]):
            done = ros2("pkg", "create", "--build-type", "ament_python", "--license", name, f"robot{number}")
            assert done.returncode == 0
            assert f"Unknown license '{name}'" in done.stdout
            assert not (tmp_path / f"robot{number}" / "LICENSE").exists()

    def test_a_maintainer_is_found(self, ros2: Ros2, tmp_path: Path) -> None:
        """The user's name, and the address that git knows, else one that says that it is none."""
        (tmp_path / "gitconfig").write_text("[user]\n\temail = ada@git.example\n")
        nothing = {"GIT_CONFIG_NOSYSTEM": "1", "GIT_CEILING_DIRECTORIES": str(tmp_path.parent)}
        for number, (config, expected) in enumerate(
            [(tmp_path / "gitconfig", "ada <ada@git.example>"), ("/dev/null", "ada <ada@todo.todo>")]
        ):
            variables = {**nothing, "GIT_CONFIG_GLOBAL": str(config), "LOGNAME": "ada", "USER": "ada"}
            done = ros2("pkg", "create", "--build-type", "ament_python", f"robot{number}", **variables)
            assert f"maintainer: ['{expected}']" in done.stdout
        done = ros2("pkg", "create", "robot", "--maintainer-name", "Bob", **variables, PATH="")
        assert "maintainer: ['Bob <Bob@todo.todo>']" in done.stdout

    def test_a_user_without_a_name_has_one(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Some containers have users that no file names."""
        from portable_ros2.commands.pkg import create

        def fail() -> str:
            raise KeyError("uid not found")

        monkeypatch.setattr(getpass, "getuser", fail)
        assert create._user() == "user"

    def test_node_and_library_get_different_names(self, ros2: Ros2, tmp_path: Path) -> None:
        """The node is renamed, with a warning."""
        done = ros2(
            "pkg",
            "create",
            "--build-type",
            "ament_python",
            *MAINTAINER,
            "robot",
            "--node-name",
            "arm",
            "--library-name",
            "arm",
        )
        assert done.stderr.splitlines() == [
            "[WARNING] node name can not be equal to the library name",
            "[WARNING] renaming node to arm_node",
        ]
        assert {"robot/arm_node.py", "robot/arm/__init__.py"} <= tree(tmp_path / "robot")
        assert "'arm_node = robot.arm_node:main'" in (tmp_path / "robot" / "setup.py").read_text()

    @pytest.mark.parametrize("destination", ["src", "a/b/c", "{}/absolute"])
    def test_the_destination_is_made_if_need_be(self, ros2: Ros2, tmp_path: Path, destination: str) -> None:
        """Relative to the current folder, and shown as it was given."""
        destination = destination.format(tmp_path)
        done = ros2("pkg", "create", "--destination-directory", destination, *NODES, "robot")
        assert done.returncode == 0
        assert f"destination directory: {tmp_path / destination}\n" in done.stdout
        assert f"creating folder {destination}/robot\n" in done.stdout
        assert (tmp_path / destination / "robot" / "setup.py").is_file()

    @pytest.mark.parametrize("kind", ["folder", "file", "package"])
    def test_nothing_is_overwritten(self, ros2: Ros2, tmp_path: Path, kind: str) -> None:
        """Whatever has the name of the package is kept as it is."""
        if kind == "folder":
            (tmp_path / "robot").mkdir()
        elif kind == "file":
            (tmp_path / "robot").write_text("mine")
        else:
            ros2("pkg", "create", *NODES, "robot")
            (tmp_path / "robot" / "setup.py").write_text("mine")
        before = {path: path.read_text() for path in tmp_path.rglob("*") if path.is_file()}
        done = ros2("pkg", "create", *NODES, "robot")
        assert (done.returncode, done.stdout) == (1, "")
        assert done.stderr.splitlines()[:3] == ["", "Aborted!", "The directory already exists: ./robot"]
        assert {path: path.read_text() for path in tmp_path.rglob("*") if path.is_file()} == before

    def test_nothing_outside_is_overwritten(self, ros2: Ros2, tmp_path: Path) -> None:
        """A node's name may lead out of the package, but not to a file that is there."""
        (tmp_path / "mine.py").write_text("mine")
        done = ros2("pkg", "create", "--build-type", "ament_python", "--node-name", "../../mine", "robot")
        assert done.returncode == 1
        assert done.stderr.splitlines() == [
            "unable to create the package: robot/robot/../../mine.py: File exists"
        ]
        assert (tmp_path / "mine.py").read_text() == "mine"

    @pytest.mark.parametrize(
        "words", [["robot", "--destination-directory", "file"], ["x" * 300], ["file/robot"]]
    )
    def test_a_folder_that_cannot_be_made_is_explained(
        self, ros2: Ros2, tmp_path: Path, words: list[str]
    ) -> None:
        """In one sentence that names it."""
        (tmp_path / "file").touch()
        done = ros2("pkg", "create", *NODES, *words)
        assert done.returncode == 1
        assert done.stderr.startswith("unable to create the package: ")
        assert len(done.stderr.splitlines()) == 1

    @pytest.mark.parametrize(
        "name",
        [
            "my-robot",
            "MyRobot",
            "class",
            *(
                pytest.param(name, marks=pytest.mark.thorough)
                for name in ("1robot", "my robot", "r", "a/b", "_robot")
            ),
        ],
    )
    def test_a_bad_name_is_taken_with_a_warning(self, ros2: Ros2, tmp_path: Path, name: str) -> None:
        """The real command takes it silently, and the build fails in an unreadable way."""
        done = ros2("pkg", "create", *NODES, name)
        assert done.returncode == 0
        assert done.stderr.startswith(f"[WARNING] '{name}' is no good name for a package: ")
        assert (tmp_path / name / "package.xml").is_file()

    @pytest.mark.parametrize(
        ("name", "node"),
        [("robot", "robot"), ("robot_controller", "Node"), ("robot2", "_n"), ("my_robot_2_", "run1")],
    )
    def test_a_good_name_is_not_warned_about(self, ros2: Ros2, name: str, node: str) -> None:
        """Neither a package's nor a node's."""
        done = ros2("pkg", "create", "--build-type", "ament_python", "--node-name", node, name)
        assert (done.returncode, done.stderr) == (0, "")

    @pytest.mark.parametrize(
        "node",
        [
            "status-publisher",
            "status_publisher.py",
            *(pytest.param(node, marks=pytest.mark.thorough) for node in ("my node", "import", "1st")),
        ],
    )
    def test_a_node_that_cannot_be_imported_is_warned_about(self, ros2: Ros2, node: str) -> None:
        """Such as one with the ending of its file."""
        done = ros2("pkg", "create", "--build-type", "ament_python", "--node-name", node, "robot")
        assert done.returncode == 0
        assert done.stderr.startswith(f"[WARNING] '{node}' is no good name for a node: ")

    def test_a_package_of_python_cannot_be_named_test(self, ros2: Ros2, tmp_path: Path) -> None:
        """Its modules and its tests would be in one folder."""
        done = ros2("pkg", "create", "--build-type", "ament_python", "test")
        assert (done.returncode, done.stdout) == (1, "")
        assert done.stderr.startswith("Aborted since 'ament_python' packages can't be named 'test'")
        assert tree(tmp_path) == set()

    @pytest.mark.parametrize(
        "words",
        [
            [],
            ["--build-type", "catkin", "robot"],
            ["--package-format", "1", "robot"],
            ["--dependencies", "rclpy", "robot"],
        ],
    )
    def test_a_wrong_line_creates_nothing(self, ros2: Ros2, tmp_path: Path, words: list[str]) -> None:
        """The last of them has taken the name of the package for a dependency."""
        done = ros2("pkg", "create", *words)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith("usage: ros2 pkg create")
        assert tree(tmp_path) == set()


class TestCreateForCMake:
    """A package that this machine cannot build."""

    def test_the_build_type_is_that_of_the_real_command(self, ros2: Ros2, tmp_path: Path) -> None:
        """A package in C++, and a sentence that it cannot be built here."""
        done = ros2("pkg", "create", *MAINTAINER, "robot")
        assert done.returncode == 0
        assert "build type: ament_cmake\n" in done.stdout
        assert done.stdout.splitlines()[11:16] == [
            "creating ./robot/package.xml",
            "creating source and include folder",
            "creating folder ./robot/src",
            "creating folder ./robot/include/robot",
            "creating ./robot/CMakeLists.txt",
        ]
        assert done.stdout.splitlines()[16:] == UNKNOWN_LICENSE
        assert tree(tmp_path / "robot") == {"package.xml", "CMakeLists.txt"}
        assert "ament_cmake" not in ament_index.resources(ament_index.PACKAGES)
        assert len(done.stderr.splitlines()) == 1
        assert "cannot build packages of the type ament_cmake" in done.stderr

    def test_it_is_not_said_where_it_can_be_built(self, ros2: Ros2, prefix: Path, tmp_path: Path) -> None:
        """Nothing is missing once ament_cmake and cmake are there."""
        (prefix / "share" / "ament_index" / "resource_index" / "packages" / "ament_cmake").touch()
        (tmp_path / "cmake").write_text("#!/bin/sh\n")
        (tmp_path / "cmake").chmod(0o755)
        path = f"{tmp_path}:{os.environ['PATH']}"
        assert ros2("pkg", "create", "robot", PATH=path).stderr == ""

    def test_node_and_library_have_their_files(self, ros2: Ros2, tmp_path: Path) -> None:
        """In the order in which the real command makes them."""
        words = [
            "--node-name",
            "drive",
            "--library-name",
            "motor_words",
            "--dependencies",
            "rclcpp",
            "std_msgs",
        ]
        done = ros2("pkg", "create", "robot", *MAINTAINER, "--license", "MIT", *words)
        assert done.stdout.splitlines()[-5:] == [
            "creating ./robot/CMakeLists.txt",
            "creating ./robot/src/drive.cpp",
            "creating ./robot/include/robot/motor_words.hpp",
            "creating ./robot/src/motor_words.cpp",
            "creating ./robot/include/robot/visibility_control.h",
        ]
        assert (
            "class ROBOT_PUBLIC MotorWords" in (tmp_path / "robot/include/robot/motor_words.hpp").read_text()
        )
        text = (tmp_path / "robot/CMakeLists.txt").read_text()
        for line in (
            "find_package(ament_cmake_ros REQUIRED)",
            "find_package(rclcpp REQUIRED)",
            "ament_target_dependencies(motor_words rclcpp std_msgs)",
            "target_link_libraries(drive motor_words)",
            "ament_package()",
        ):
            assert line in text.splitlines()
        package = parse_package(tmp_path / "robot")
        assert [depend.name for depend in package.buildtool_depends] == ["ament_cmake_ros"]

    @pytest.mark.skipif(not shutil.which("cmake") or not shutil.which("c++"), reason="cmake is not installed")
    @pytest.mark.parametrize(
        "words",
        [
            [],
            pytest.param(["--node-name", "drive"], marks=pytest.mark.thorough),
            pytest.param(["--library-name", "arm"], marks=pytest.mark.thorough),
            ["--node-name", "d", "--library-name", "l"],
        ],
    )
    def test_plain_cmake_builds_it(self, ros2: Ros2, tmp_path: Path, words: list[str]) -> None:
        """The program says hello, and another project finds it all."""
        done = ros2("pkg", "create", "--build-type", "cmake", "robot", *words)
        assert (done.returncode, done.stderr) == (0, "")

        def cmake(*words: str) -> None:
            subprocess.run(["cmake", *words], cwd=tmp_path, capture_output=True, timeout=DEADLINE, check=True)

        cmake("-S", "robot", "-B", "build", f"-DCMAKE_INSTALL_PREFIX={tmp_path}/out", "-Werror=dev")
        if not words:
            return
        cmake("--build", "build", "--target", "install")
        (tmp_path / "user").mkdir()
        (tmp_path / "user" / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.8)\nproject(user NONE)\nfind_package(robot 0.0.0 EXACT REQUIRED)\n"
        )
        cmake("-S", "user", "-B", "user/build", f"-DCMAKE_PREFIX_PATH={tmp_path}/out")
        for program in (tmp_path / "out" / "lib" / "robot").glob("*"):
            hello = subprocess.run([program], capture_output=True, text=True, timeout=DEADLINE, check=True)
            assert hello.stdout == "hello world robot package\n"


def test_a_new_package_builds_tests_and_runs(
    ros2: Ros2, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a warning; linters that are not installed are skipped, and say so."""
    monkeypatch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)  # setuptools would warn of it
    monkeypatch.setenv("PATH", f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}")
    ros2("pkg", "create", "--destination-directory", "src", *NODES, "robot")

    def bash(line: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["bash", "-c", line], cwd=tmp_path, capture_output=True, text=True, timeout=DEADLINE, check=True
        )

    build = bash("colcon build")
    assert (build.stderr, "Summary: 1 package finished" in build.stdout) == ("", True)
    tests = bash("colcon test && colcon test-result")
    assert tests.stderr == ""
    assert "Summary: 3 tests, 0 errors, 0 failures, 3 skipped" in tests.stdout
    run = bash("source install/setup.bash && ros2 pkg executables robot && ros2 run robot status_publisher")
    assert (run.stdout, run.stderr) == ("robot status_publisher\nHi from robot.\n", "")


def test_the_tests_run_linters_where_there_are_some(ros2: Ros2, tmp_path: Path) -> None:
    """What they find fails the test that asked, with its words."""
    ros2("pkg", "create", *NODES, "robot")
    for name, body in {
        "ament_flake8": "def main_with_errors(argv):\n    return 1, ['line too long']\n",
        "ament_pep257": "def main(argv):\n    return 0\n",
    }.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").touch()
        (tmp_path / name / "main.py").write_text(body)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-rs", "-p", "no:cacheprovider", "robot"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert "1 failed, 1 passed, 1 skipped" in done.stdout
    assert "line too long" in done.stdout


class TestList:
    """`ros2 pkg list`."""

    def test_it_is_sorted_and_complete(self, ros2: Ros2, prefix: Path) -> None:
        """Those of each prefix, once."""
        (prefix / "share" / "ament_index" / "resource_index" / "packages" / "rclpy").touch()
        done = ros2("pkg", "list")
        names = done.stdout.splitlines()
        assert (done.returncode, done.stderr) == (0, "")
        assert names == sorted(set(names))
        assert {"arm", "rclpy", "std_msgs"} <= set(names)

    def test_an_unsourced_workspace_is_not_seen(self, ros2: Ros2, prefix: Path) -> None:
        """Only what a prefix on the path holds."""
        assert "arm" not in ros2("pkg", "list", AMENT_PREFIX_PATH="").stdout.splitlines()


class TestExecutables:
    """`ros2 pkg executables`."""

    def test_they_are_sorted_and_executable(self, ros2: Ros2, prefix: Path) -> None:
        """Deeper ones too, but neither hidden folders nor files that cannot be run."""
        install(prefix, "wave", "grip", "deep/er", ".hidden/no")
        install(prefix, "notes.txt", mode=0o644)
        (prefix / "lib" / "arm" / "broken").symlink_to("gone")
        done = ros2("pkg", "executables", "arm")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.splitlines() == ["arm er", "arm grip", "arm wave"]
        full = ros2("pkg", "executables", "--full-path", "arm").stdout.splitlines()
        assert full == [f"{prefix}/lib/arm/{name}" for name in ("deep/er", "grip", "wave")]

    def test_without_a_package_it_shows_all(self, ros2: Ros2, prefix: Path) -> None:
        """In the order of the packages."""
        install(prefix, "wave")
        lines = ros2("pkg", "executables").stdout.splitlines()
        assert "arm wave" in lines
        assert [line.split()[0] for line in lines] == sorted(line.split()[0] for line in lines)
        assert f"{prefix}/lib/arm/wave" in ros2("pkg", "executables", "--full-path").stdout.splitlines()

    def test_a_package_without_any_is_silent(self, ros2: Ros2, prefix: Path) -> None:
        """It is there, so that is no error."""
        done = ros2("pkg", "executables", "arm")
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")

    @pytest.mark.parametrize("name", ["leg", "a b", "../arm"])
    def test_a_package_that_is_not_there(self, ros2: Ros2, prefix: Path, name: str) -> None:
        """The sentence of the real command."""
        done = ros2("pkg", "executables", name)
        assert (done.returncode, done.stdout, done.stderr) == (1, "", f"Package '{name}' not found\n")


class TestPrefix:
    """`ros2 pkg prefix`."""

    def test_of_two_the_first_one_counts(self, ros2: Ros2, prefix: Path) -> None:
        """As the environment is set; the wheels' own come last."""
        assert ros2("pkg", "prefix", "arm").stdout == f"{prefix}\n"
        assert ros2("pkg", "prefix", "--share", "arm").stdout == f"{prefix}/share/arm\n"
        assert ros2("pkg", "prefix", "rclpy").stdout == f"{sys.prefix}\n"
        (prefix / "share" / "ament_index" / "resource_index" / "packages" / "rclpy").touch()
        assert ros2("pkg", "prefix", "rclpy").stdout == f"{prefix}\n"

    @pytest.mark.parametrize("share", [[], ["--share"]])
    @pytest.mark.parametrize("name", ["leg", "", "..", "arm/", "ARM"])
    def test_a_package_that_is_not_there(self, ros2: Ros2, prefix: Path, name: str, share: list[str]) -> None:
        """The sentence of the real command, for a name that no package can have too."""
        done = ros2("pkg", "prefix", *share, name)
        assert (done.returncode, done.stdout, done.stderr) == (1, "", "Package not found\n")


class TestXml:
    """`ros2 pkg xml`."""

    def test_the_manifest_is_shown(self, ros2: Ros2, prefix: Path) -> None:
        """As XML with the same content."""
        done = ros2("pkg", "xml", "arm")
        assert (done.returncode, done.stderr) == (0, "")
        root = ElementTree.fromstring(done.stdout)
        assert (root.tag, root.get("format"), root.findtext("name")) == ("package", "3", "arm")

    @pytest.mark.parametrize(
        ("tag", "lines"), [("version", ["1.2.3"]), ("depend", ["rclpy", "std_msgs"]), ("export", ["None"])]
    )
    @pytest.mark.parametrize("option", ["-t", "--tag"])
    def test_a_tag_is_shown(self, ros2: Ros2, prefix: Path, option: str, tag: str, lines: list[str]) -> None:
        """Each of its texts on a line; one without text as the real command shows it."""
        done = ros2("pkg", "xml", "arm", option, tag)
        assert (done.returncode, done.stdout.splitlines(), done.stderr) == (0, lines, "")

    @pytest.mark.parametrize("tag", ["nope", "Version", "[", "a b"])
    def test_a_tag_that_is_not_there(self, ros2: Ros2, prefix: Path, tag: str) -> None:
        """Also one that is none."""
        done = ros2("pkg", "xml", "arm", "-t", tag)
        assert (done.returncode, done.stdout, done.stderr) == (1, "", "XML tag not found\n")

    def test_what_is_missing_or_broken_is_told(self, ros2: Ros2, prefix: Path) -> None:
        """The package, its manifest, or an end tag."""
        assert ros2("pkg", "xml", "leg").stderr == "Package not found\n"
        manifest = prefix / "share" / "arm" / "package.xml"
        manifest.write_text("<package>")
        done = ros2("pkg", "xml", "arm")
        assert done.returncode == 1
        assert done.stderr.startswith(f"{manifest} is not valid XML: ")
        manifest.unlink()
        done = ros2("pkg", "xml", "arm")
        assert (done.returncode, done.stderr) == (1, "Package XML manifest not found\n")
