"""Facts of a package's files: right ones in many styles, single faults, and files that mean harm."""

from __future__ import annotations

import re
import subprocess
import sysconfig
import tempfile
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from ros2lab import assignments
from ros2lab.diagnose import of_text
from ros2lab.grading.evidence import Files, Place
from ros2lab.grading.reading import documents, files, graded_package, package_facts
from ros2lab.grading.reading.unread import OF_CODE, OF_EACH_FILE
from ros2lab.grading.receiving.submission import receive

RECORDED = "[INFO] [1700000000.5] [status_publisher]: Publishing: Robot is OK, message 1\n"
REFERENCE = Path(__file__).parents[2] / "robot_controller"
Texts = dict[str, str]

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>robot_controller</name>
  <version>0.1.0</version>
  <description>Drives a robot by words.</description>
  <maintainer email="ada@example.org">Ada</maintainer>
  <license>MIT</license>
  <depend>rclpy</depend>
  <depend>std_msgs</depend>
  <depend>geometry_msgs</depend>
  <test_depend>python3-pytest</test_depend>
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
SETUP = """from setuptools import find_packages, setup

package_name = 'robot_controller'

setup(
    name=package_name,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='Ada',
    maintainer_email='ada@example.org',
    description='Drives a robot by words.',
    license='MIT',
    entry_points={
        'console_scripts': [
            'status_publisher = robot_controller.status_publisher:main',
            'velocity_publisher = robot_controller.velocity_publisher:main',
        ],
    },
)
"""
SETUP_CODES = {"package-not-listed", "init-file-missing", "package-folder-missing", "entry-point-module"}
SETUP_CFG = """[develop]
script_dir=$base/lib/robot_controller
[install]
install_scripts=$base/lib/robot_controller
"""
STATUS = '''"""Tell how the robot is."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class StatusPublisher(Node):
    """Publishes the status every 2 s."""

    def __init__(self):
        super().__init__('status_publisher')
        self.publisher = self.create_publisher(String, '/robot/status', 10)
        self.create_timer(2.0, self.tell)

    def tell(self):
        """Publish it once."""
        self.publisher.publish(String(data='ok'))


def main(args=None):
    """Run the node."""
    rclpy.init(args=args)
    node = StatusPublisher()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
'''
VELOCITY = (
    STATUS.replace("from std_msgs.msg import String", "from geometry_msgs.msg import Twist")
    .replace("String(data='ok')", "Twist()")
    .replace("String", "Twist")
    .replace("StatusPublisher", "VelocityPublisher")
    .replace("status_publisher", "velocity_publisher")
    .replace("/robot/status", "/cmd_vel")
)
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([Node(package='robot_controller', executable='status_publisher')])
"""
PARAMETERS = "status_publisher:\n  ros__parameters:\n    period: 2.0\n"


def right_package() -> Texts:
    """Return a package without a fault, much as `ros2 pkg create` makes it, by the paths of its files."""
    return {
        "package.xml": MANIFEST,
        "setup.py": SETUP,
        "setup.cfg": SETUP_CFG,
        "resource/robot_controller": "",
        "robot_controller/__init__.py": "",
        "robot_controller/status_publisher.py": STATUS,
        "robot_controller/velocity_publisher.py": VELOCITY,
    }


def write(folder: Path, texts: Texts) -> Path:
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


@pytest.fixture
def look(tmp_path: Path) -> Callable[[Texts | Path], Files]:
    """Look at what is handed in: a folder, or the files of one."""

    def look(given: Texts | Path) -> Files:
        place = Path(tempfile.mkdtemp(dir=tmp_path))
        path = given if isinstance(given, Path) else write(place / "handed_in", given)
        root = place / "received"
        root.mkdir()
        return files.look(root, receive(path, root))

    return look


def false_facts(found: Files) -> set[str]:
    facts = {f"manifest.{name}": holds for name, holds in found.manifest.items()}
    facts |= {f"setup.{name}": holds for name, holds in found.setup.items()}
    return {name for name, holds in facts.items() if not holds}


ALL_FACTS = {
    "manifest": {
        "is_there",
        *package_facts.MANIFEST_FINDINGS,
        *(f"declares_{name}" for name in assignments.load().dependencies),
    }
    | {"description_is_written", "license_is_written", "maintainer_is_written"},
    "setup": {"is_there", *package_facts.SETUP_FINDINGS}
    | {
        "has_code",
        "name_agrees",
        "marker_exists",
        "manifest_is_installed",
        "is_described",
        "entry_points_are_own",
    },
}


# Right packages.


def as_created(_: Texts) -> None:
    pass


def packages_by_name(texts: Texts) -> None:
    texts["setup.py"] = SETUP.replace("find_packages(exclude=['test'])", "[package_name]")


def sub_packages(texts: Texts) -> None:
    texts["robot_controller/nodes/__init__.py"] = ""
    texts["robot_controller/nodes/status_publisher.py"] = texts.pop("robot_controller/status_publisher.py")
    texts["setup.py"] = SETUP.replace("controller.status", "controller.nodes.status")


def src_layout(texts: Texts) -> None:
    for name in [name for name in texts if name.startswith("robot_controller/")]:
        texts[f"src/{name}"] = texts.pop(name)
    texts["setup.py"] = SETUP.replace("(exclude=['test'])", "('src')").replace(
        "    data_files", "    package_dir={'': 'src'},\n    data_files"
    )


def pyproject_beside(texts: Texts) -> None:
    texts["pyproject.toml"] = (
        "[build-system]\nrequires = ['setuptools']\n[tool.pytest.ini_options]\ntestpaths = ['test']\n"
    )


def entry_points_in_setup_cfg(texts: Texts) -> None:
    head, _, _ = SETUP.partition("    entry_points={")
    texts["setup.py"] = head + ")\n"
    texts["setup.cfg"] += (
        "[options.entry_points]\nconsole_scripts =\n"
        "    status_publisher = robot_controller.status_publisher:main\n"
        "    velocity_publisher = robot_controller.velocity_publisher:main\n"
    )


def everything_in_setup_cfg(texts: Texts) -> None:
    entry_points_in_setup_cfg(texts)
    texts["setup.py"] = "from setuptools import setup\n\nsetup()\n"
    texts["setup.cfg"] += (
        "[metadata]\nname = robot_controller\nversion = 0.1.0\n[options]\npackages = find:\n"
        "[options.data_files]\nshare/ament_index/resource_index/packages = resource/robot_controller\n"
        "share/robot_controller = package.xml\n"
    )


def entry_points_as_text(texts: Texts) -> None:
    head, _, _ = SETUP.partition("    entry_points={")
    texts["setup.py"] = head + (
        "    entry_points='''\n[console_scripts]\n"
        "status_publisher = robot_controller.status_publisher:main\n"
        "velocity_publisher=robot_controller.velocity_publisher:main\n''',\n)\n"
    )


def several_packages(texts: Texts) -> None:
    for name in [*texts]:
        texts[f"ws/src/robot_controller/{name}"] = texts.pop(name)
    texts["ws/src/other/package.xml"] = MANIFEST.replace("robot_controller", "other")
    texts["ws/src/other/setup.py"] = "from setuptools import setup\nsetup(name='other')\n"


def launch_and_parameters(texts: Texts) -> None:
    texts["launch/robot.launch.py"] = LAUNCH
    texts["config/robot.yaml"] = PARAMETERS
    texts["setup.py"] = SETUP.replace(
        "['package.xml']),",
        "['package.xml']),\n        ('share/' + package_name + '/launch', ['launch/robot.launch.py']),\n"
        "        ('share/' + package_name + '/config', ['config/robot.yaml']),",
    )


def by_glob(texts: Texts) -> None:
    launch_and_parameters(texts)
    texts["setup.py"] = "import os\nfrom glob import glob\n" + texts["setup.py"].replace(
        "['launch/robot.launch.py']", "glob('launch/*.launch.py')"
    ).replace("['config/robot.yaml']", "glob(os.path.join('config', '*.yaml'))")


def merged_data_files(texts: Texts) -> None:
    launch_and_parameters(texts)
    files = "['package.xml', 'launch/robot.launch.py', 'config/robot.yaml']"
    head, _, rest = SETUP.partition("['package.xml']")
    texts["setup.py"] = head + files + rest


def built_step_by_step(texts: Texts) -> None:
    launch_and_parameters(texts)
    texts["setup.py"] = SETUP.replace(
        "\nsetup(",
        "\ndata_files = [('share/' + package_name, ['package.xml'])]\n"
        "data_files.append(('share/ament_index/resource_index/packages', ['resource/' + package_name]))\n"
        "data_files += [(f'share/{package_name}/{d}', [f'{d}/{f}']) for d, f in "
        "(('launch', 'robot.launch.py'), ('config', 'robot.yaml'))]\n\nsetup(",
    )
    head, _, rest = texts["setup.py"].rpartition("    data_files=[")
    texts["setup.py"] = head + "    data_files=data_files,\n" + rest.partition("    ],\n")[2]


def separate_dependencies(texts: Texts) -> None:
    texts["package.xml"] = MANIFEST.replace(
        "<depend>rclpy</depend>", "<exec_depend> rclpy </exec_depend>"
    ).replace(
        "<depend>std_msgs</depend>",
        '<!-- messages -->\n<build_depend>std_msgs</build_depend><exec_depend condition="$ROS_VERSION == 2">std_msgs</exec_depend>',
    )


def with_windows_line_ends(texts: Texts) -> None:
    for name in texts:
        texts[name] = texts[name].replace("\n", "\r\n")
    texts["package.xml"] = "\ufeff" + texts["package.xml"]


STYLES = [
    as_created,
    packages_by_name,
    sub_packages,
    src_layout,
    pyproject_beside,
    entry_points_in_setup_cfg,
    everything_in_setup_cfg,
    entry_points_as_text,
    several_packages,
    launch_and_parameters,
    by_glob,
    merged_data_files,
    built_step_by_step,
    separate_dependencies,
    with_windows_line_ends,
]


@pytest.mark.parametrize("style", STYLES, ids=lambda style: style.__name__)
def test_every_fact_of_a_right_package_is_true(
    look: Callable[[Texts], Files], style: Callable[[Texts], None]
) -> None:
    texts = right_package()
    style(texts)
    found = look(texts)
    assert not false_facts(found)
    assert {"manifest": {*found.manifest}, "setup": {*found.setup}} == ALL_FACTS


def test_every_fact_of_the_reference_is_true(look: Callable[[Path], Files]) -> None:
    found = look(REFERENCE)
    assert not false_facts(found)
    assert "robot_controller" in found.readme
    assert found.launch_files == ["launch/robot.launch.py"]
    assert found.parameter_files["config/robot.yaml"]["/**/status_publisher"] == {"period": 2.0}
    assert found.parameter_file_users == {"config/robot.yaml": ["launch/robot.launch.py"]}
    assert found.findings == []
    assert found.tests["test/test_velocity_publisher.py"] > 5
    assert found.sources["modules"][0] == found.sources["modules"][1] > 8
    assert found.handlers["by name"]
    assert not found.handlers["wholesale"]


def test_what_ros2_pkg_create_makes_lacks_what_is_to_be_written(
    look: Callable[[Path], Files], tmp_path: Path
) -> None:
    command = [Path(sysconfig.get_path("scripts"), "ros2"), "pkg", "create", "--build-type", "ament_python"]
    names = ["--maintainer-name", "ada", "--maintainer-email", "ada@todo.todo", "robot_controller"]
    folder = tmp_path / "created"
    folder.mkdir()
    subprocess.run([*command, *names], cwd=folder, check=True, capture_output=True)
    found = look(folder)
    assert false_facts(found) == {
        "setup.installs_modules",
        "setup.has_code",
        *(f"manifest.declares_{name}" for name in assignments.load().dependencies),
        *(f"manifest.{name}_is_written" for name in ("description", "license", "maintainer")),
        "setup.has_entry_points",
        "setup.is_described",
    }
    assert not found.tests
    assert not found.readme


# Single faults: what is replaced in which file by what, and the one fact that it breaks. None removes a file.
FAULTS: dict[str, tuple[str, str, str | None, str]] = {
    "manifest missing": ("package.xml", "", None, "manifest.is_there"),
    "tag not closed": ("package.xml", "</license>", "", "manifest.is_valid"),
    "no version": ("package.xml", "<version>0.1.0</version>", "", "manifest.is_valid"),
    "version of two numbers": ("package.xml", "0.1.0", "0.1", "manifest.is_valid"),
    "maintainer without address": ("package.xml", ' email="ada@example.org"', "", "manifest.is_valid"),
    "no build type": ("package.xml", "<build_type>ament_python</build_type>", "", "manifest.is_ament_python"),
    "built by cmake": ("package.xml", "ament_python", "ament_cmake", "manifest.is_ament_python"),
    "build type misspelt": ("package.xml", "ament_python", "ament-python", "manifest.is_ament_python"),
    "rclpy not declared": ("package.xml", "<depend>rclpy</depend>", "", "manifest.declares_rclpy"),
    "rclpy in a comment": (
        "package.xml",
        "<depend>rclpy</depend>",
        "<!-- <depend>rclpy</depend> -->",
        "manifest.declares_rclpy",
    ),
    "rclpy only for tests": (
        "package.xml",
        "<depend>rclpy</depend>",
        "<test_depend>rclpy</test_depend>",
        "manifest.declares_rclpy",
    ),
    "rclpy only of ROS 1": (
        "package.xml",
        "<depend>rclpy</depend>",
        '<depend condition="$ROS_VERSION == 1">rclpy</depend>',
        "manifest.declares_rclpy",
    ),
    "rclpy only in another distribution": (
        "package.xml",
        "<depend>rclpy</depend>",
        '<exec_depend condition="$ROS_DISTRO == noetic or $UNSET == 1">rclpy</exec_depend>',
        "manifest.declares_rclpy",
    ),
    "a build type only of ROS 1": (
        "package.xml",
        "<build_type>",
        '<build_type condition="$ROS_VERSION == 1">',
        "manifest.is_ament_python",
    ),
    "std_msgs misspelt": ("package.xml", "std_msgs", "std_msg", "manifest.declares_std_msgs"),
    "geometry_msgs not declared": (
        "package.xml",
        "<depend>geometry_msgs</depend>",
        "",
        "manifest.declares_geometry_msgs",
    ),
    "another dependency not declared": (
        "robot_controller/status_publisher.py",
        "import rclpy\n",
        "import rclpy\nfrom sensor_msgs.msg import LaserScan\n",
        "manifest.declares_all_imports",
    ),
    "a module of Python declared": (
        "package.xml",
        "<test_depend>",
        "<depend>math</depend><test_depend>",
        "manifest.dependencies_exist",
    ),
    "description to be done": (
        "package.xml",
        "Drives a robot by words.",
        "TODO: Package description",
        "manifest.description_is_written",
    ),
    "license to be done": ("package.xml", "MIT", "TODO: License declaration", "manifest.license_is_written"),
    "maintainer to be done": ("package.xml", "ada@example.org", "ada@todo.todo", "manifest.maintainer_is_written"),
    "maintainer to be named": ("package.xml", ">Ada<", ">Your Name<", "manifest.maintainer_is_written"),
    "maintainer in one word": ("package.xml", ">Ada<", ">YourName<", "manifest.maintainer_is_written"),
    "address to be filled in": (
        "package.xml",
        "ada@example.org",
        "you@email.com",
        "manifest.maintainer_is_written",
    ),
    "address of its reader": (
        "package.xml",
        "ada@example.org",
        "your.email@example.com",
        "manifest.maintainer_is_written",
    ),
    "maintainer in setup.py to be named": ("setup.py", "'Ada'", "'Your Name'", "setup.is_described"),
    "setup missing": ("setup.py", "", None, "setup.is_there"),
    "parenthesis missing": ("setup.py", "setup(\n", "setup\n", "setup.is_valid"),
    "import missing": ("setup.py", "import find_packages, setup", "import setup", "setup.is_valid"),
    "another name": ("setup.py", "name=package_name", "name='robot_driver'", "setup.name_agrees"),
    "another name in package.xml": ("package.xml", ">robot_controller<", ">robot_driver<", "setup.name_agrees"),
    "comma between arguments missing": ("setup.py", "zip_safe=True,", "zip_safe=True", "setup.is_valid"),
    "no marker": ("resource/robot_controller", "", None, "setup.marker_exists"),
    "marker not installed": (
        "setup.py",
        "        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n",
        "",
        "setup.marker_is_installed",
    ),
    "manifest not installed": (
        "setup.py",
        "        ('share/' + package_name, ['package.xml']),\n",
        "",
        "setup.manifest_is_installed",
    ),
    "file that is not there": (
        "setup.py",
        "['package.xml']",
        "['package.xml', 'launch/robot.launch.py']",
        "setup.data_files_exist",
    ),
    "package without __init__": ("robot_controller/__init__.py", "", None, "setup.installs_modules"),
    "no package listed": (
        "setup.py",
        "packages=find_packages(exclude=['test'])",
        "packages=[]",
        "setup.installs_modules",
    ),
    "scripts to bin": ("setup.cfg", "[install]\ninstall_scripts=$base/lib/robot_controller\n", "", "setup.scripts_go_to_lib"),
    "scripts to another package": (
        "setup.cfg",
        "install_scripts=$base/lib/robot_controller",
        "install_scripts=$base/lib/robot",
        "setup.scripts_go_to_lib",
    ),
    "no setup.cfg": ("setup.cfg", "", None, "setup.scripts_go_to_lib"),
    "entry points misspelt": ("setup.py", "console_scripts", "console_script", "setup.has_entry_points"),
    "no module of this name": (
        "setup.py",
        "robot_controller.status_publisher:",
        "robot_controller.status_publsher:",
        "setup.entry_points_lead_to_functions",
    ),
    "no function of this name": (
        "setup.py",
        "status_publisher:main",
        "status_publisher:mian",
        "setup.entry_points_lead_to_functions",
    ),
    "function not named": ("setup.py", "status_publisher:main", "status_publisher", "setup.entry_points_lead_to_functions"),
    "comma missing": ("setup.py", "status_publisher:main',", "status_publisher:main'", "setup.entry_points_lead_to_functions"),
    "description of setup.py to be done": (
        "setup.py",
        "description='Drives a robot by words.'",
        "description='TODO: Package description'",
        "setup.is_described",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_single_fault_breaks_one_fact(look: Callable[[Texts], Files], fault: str) -> None:
    file, old, new, fact = FAULTS[fault]
    texts = right_package()
    if new is None:
        del texts[file]
    else:
        assert old in texts[file]
        texts[file] = texts[file].replace(old, new, 1)
    named = {"manifest.declares_sensor_msgs"}  # what is imported and not declared is told by its name, too
    assert false_facts(look(texts)) - named == {fact}


@pytest.mark.parametrize(
    "kind", ["", "<build_type>ament_cmake</build_type>", "<build_type>catkin</build_type>"]
)
def test_another_build_type_is_not_the_right_one_though_it_can_be_built(
    look: Callable[[Texts], Files], kind: str
) -> None:
    manifest = MANIFEST.replace("<build_type>ament_python</build_type>", kind)
    found = look(right_package() | {"package.xml": manifest, "CMakeLists.txt": "project(robot_controller)\n"})
    assert false_facts(found) == {"manifest.is_ament_python"}


@pytest.mark.parametrize("text", ["", "print('hello')\n", "from setuptools import setup\n\nset up(\n"])
def test_a_setup_script_that_says_nothing_makes_no_fact_true_by_itself(
    look: Callable[[Texts], Files], text: str
) -> None:
    false = false_facts(look(right_package() | {"setup.py": text}))
    assert false >= {
        f"setup.{name}" for name in ("is_valid", "has_entry_points", "marker_is_installed", "name_agrees")
    }


@pytest.mark.parametrize(
    ("start", "named"),
    [
        ("*[Node(package=name, executable='a') for name in ('robot_controller',)],", ["robot_controller"]),
        ("ExecuteProcess(cmd=['ros2', 'run', 'robot_controller', 'a']),", ["robot_controller"]),
        ("\n        # Node(package='robot_controller', executable='a'),", []),
    ],
)
def test_a_launch_file_names_a_package_however_it_starts_it(
    look: Callable[[Texts], Files], start: str, named: list[str]
) -> None:
    nodes = f"{start}\n        Node(package='turtlesim', executable='turtlesim_node')"
    launch = LAUNCH.replace("Node(package='robot_controller', executable='status_publisher')", nodes)
    found = look(right_package() | {"launch/robot.launch.py": launch})
    assert found.launched_packages == {"launch/robot.launch.py": [*named, "turtlesim"]}


def test_a_launch_file_that_is_not_installed_is_a_fault(look: Callable[[Texts], Files]) -> None:
    found = look(right_package() | {"launch/robot.launch.py": LAUNCH})
    assert [code for code, *_ in found.findings] == ["not-in-data-files"]


# README, description, tests, handlers.


@pytest.mark.parametrize(
    "name",
    [
        "README.md",
        "readme.txt",
        "README.MD",
        "README.rst",
        "README",
        "README.textile",
        "README.creole",
        "Readme_de.md",
        "LIESMICH.md",
        "LISEZMOI.txt",
        "说明",
        "docs/README.md",
    ],
)
def test_a_readme_is_found_by_its_name(look: Callable[[Texts], Files], name: str) -> None:
    assert look(right_package() | {name: "Überblick: colcon build"}).readme == "Überblick: colcon build"


@pytest.mark.parametrize(
    ("names", "read", "is_noted"),
    [
        (["README.mediawiki"], "Drive.", True),
        (["README.mediawiki", "README.md"], "Drive.", True),
        (["README.md.bak", "README.md"], "Drive.", True),
        (["README.py"], "", False),
        (["README.md"], "Drive.", False),
    ],
)
def test_a_readme_that_is_not_rendered_here_is_read_as_it_stands(
    look: Callable[[Texts], Files], names: list[str], read: str, is_noted: bool
) -> None:
    """Where there is no other one; HTML is hidden in it as elsewhere, and what else its page may hide is noted."""
    texts = dict.fromkeys(names[:1], "Drive.<!-- /cmd_vel --> <includeonly>/robot/status</includeonly>")
    found = look(right_package() | texts | dict.fromkeys(names[1:], "Drive."))
    assert found.readme.strip() == read
    assert any("not rendered here" in note for note in found.notes) is is_noted


@pytest.mark.parametrize(
    ("data", "text"),
    [
        ("Größe".encode("utf-16"), "Größe"),
        ("Größe, Höhe".encode("cp1252"), "Größe, Höhe"),
        (b"\xef\xbb\xbftext", "text"),
        (b"\0\1\2", ""),
        (b"x" * 10_000_000, "x" * documents.LONGEST_README),
    ],
    ids=["utf-16", "cp1252", "bom", "no text", "one line of 10 MB"],
)
def test_a_readme_is_read_in_any_encoding(
    tmp_path: Path, look: Callable[[Path], Files], data: bytes, text: str
) -> None:
    folder = write(tmp_path / "handed_in", right_package())
    (folder / "README.md").write_bytes(data)
    assert look(folder).readme == text


def test_a_table_beside_the_nodes_keeps_nothing_else_from_being_read(look: Callable[[Texts], Files]) -> None:
    """The largest file is left out: what it may do is neither there nor missing, and of the documentation the others tell."""
    table = "TABLE = [\n" + "    (1, 2, 3),\n" * 80_000 + "]\n"
    found = look(right_package() | {"robot_controller/table.py": table})
    assert found.sources["classes"] == [2, 2]
    assert found.handlers["of an end"]
    why = "Of the Python files the smallest were looked at, 1000000 bytes in all, and not robot_controller/table.py."
    assert found.unread == dict.fromkeys({*OF_CODE} - OF_EACH_FILE, why)
    (note,) = found.notes
    assert note.startswith("Not read in full: ")
    assert f"{why} What rests on it costs nothing" in note


def test_where_no_code_at_all_was_read_nothing_is_known_of_its_documentation(
    look: Callable[[Texts], Files],
) -> None:
    table = "TABLE = [\n" + "    (1, 2, 3),\n" * 80_000 + "]\n"
    files = {
        name: text + table * name.startswith("robot_controller/") for name, text in right_package().items()
    }
    assert {"sources", "readme_names"} <= look(files).unread.keys()


NESTED = {
    "an expression": f"\nCOUNT = {' + '.join(['int()'] * 900)}\n",
    "a lambda": f"\nSIGN = lambda: {'-' * 400}int()\n",
    "branches": "\n" + "".join(f"{'el' * bool(n)}if __name__ == '{n}':\n    pass\n" for n in range(400)),
    "attributes": f"\nLAST = print{'.a()' * 400} if 0 else 0\n",
}


@pytest.mark.parametrize(
    "nested",
    [
        pytest.param(text, id=name, marks=pytest.mark.thorough if name == "branches" else ())
        for name, text in NESTED.items()
    ],
)
def test_beside_what_is_nested_too_deeply_the_rest_of_a_file_is_read(
    look: Callable[[Texts], Files], nested: str
) -> None:
    """Each function counts, with a docstring or without one, and each end that is made."""
    files = right_package()
    plain = look(files)
    deep = {name: text + nested * name.endswith("_publisher.py") for name, text in files.items()}
    found = look(deep)
    assert found.unread
    assert (found.sources, found.ends, found.setup) == (plain.sources, plain.ends, plain.setup)


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("<!-- ros2 run -->\nDrive.\n<!--\n/cmd_vel", "Drive."),
        ("[//]: # (/robot/status)\nDrive.\n\n[a]: b", "Drive."),
        ('See [there](http://x "ros2 run robot_controller x").\n\n[b]: c "/cmd_vel"', "See there."),
        ('![/cmd_vel](picture.png "/robot/status") Drive.', "Drive."),
        ('<p title="/cmd_vel">Drive.</p>\n\n<a name="/robot/status"></a>', "Drive."),
        ("<div hidden>\n\n```bash\ncolcon build\n```\n<div>\n</div>\n\nA\n</div>\n\nDrive.", "Drive."),
        ("<SCRIPT>\n/cmd_vel\n</script>\n<template>\n\n# /cmd_vel\n</template>\nDrive.", "Drive."),
        ('Drive<span style="display: none"> /cmd_vel <b>on</b></span>.', "Drive."),
        ("Drive.\n\n<style>\n\n/cmd_vel", "Drive."),
        ("<details>\n\nDrive.\n\n", "<details> Drive."),
        ("Say ros2 run <title> <style> /cmd_vel.", "Say ros2 run <title> <style> /cmd_vel."),
        ("Drive.\n\n```topojson\n/cmd_vel\n```\n\n```stl\nsolid /cmd_vel\n```", "Drive."),
        ("Drive.\n\n```math\n\\iffalse /cmd_vel\n```\n\n```math\n% /cmd_vel\n```", "Drive."),
        (r"Drive.$\color{white}{/cmd_vel}$ $`\phantom{/cmd_vel}`$ $$\llap{/cmd_vel}$$", "Drive."),
        ("Drive at $v = 2$ m/s.\n\n```math\nv = 2\n```", "Drive at $v = 2$ m/s. v = 2"),
        (r"Set $HOME/a and $PATH\b, or `$A\b$`.", r"Set $HOME/a and $PATH\b, or `$A\b$`."),
        ("Use `ros2 run <a> <b>`, or ros2 run <a> <b>.", "Use `ros2 run <a> <b>`, or ros2 run <a> <b>."),
        (
            "Drive\n=====\n1. Build:\n   ```bash\n   colcon build\n   ```\n",
            "# Drive Build: ``` colcon build ```",
        ),
        ("| a | b |\n|---|---|\n| `/cmd_vel` | Twist |\n", "a b `/cmd_vel` Twist"),
        ('<p hidden="">/cmd_vel</p>\n\n<p\nhidden>/cmd_vel</p>\n\nDrive.', "Drive."),
        ("<dialog>\n/cmd_vel\n<pre>\ncolcon build\n</pre>\n</dialog>\n\nDrive.", "Drive."),
        ("<svg><desc>/cmd_vel</desc></svg>\n\n<video>\n\n/cmd_vel\n\n</video>\n\nDrive.", "Drive."),
        ("<audio>/cmd_vel\n<pre>\ncolcon build\n</pre></audio>\n\nDrive.", "Drive."),
        ("Drive. <noscript>/cmd_vel\n\n```\ncolcon build\n```\n\nis it</noscript>", "Drive."),
        ("<math><annotation>/cmd_vel\n\n# colcon\n\n</annotation></math>\n\nDrive.", "Drive."),
        ("<object data='a'>/cmd_vel\n\n1. colcon build\n\n</object> Drive.", "Drive."),
        ("Drive <b>on\n\nand on</b>.\n\n- <center>Go\n\non</center>", "Drive <b>on and on. <center>Go on"),
        (
            "Run ros2 run a <node>.\n\n```xml\n<node></node>\n```",
            "Run ros2 run a <node>. ``` <node></node> ```",
        ),
        ("A <select><option>/cmd_vel</option></select> b <textarea>colcon build</textarea>", "A b"),
        ("```mermaid\nA --> B[/cmd_vel]\n  %% colcon build\n```\n", "A --> B[/cmd_vel]"),
        ("<workspace>\n/src holds the package.", "<workspace> /src holds the package."),
        ("<section>\n\nDrive.\n\n</section>", "<section> Drive."),
        ("Drive[^1] on.\n\n[^1]: on `/cmd_vel`\n[^b]: /robot/status\n", "Drive[^1] on. on `/cmd_vel`"),
        # Of footnotes, GitHub shows all that anything refers to, also another footnote, and with all that is theirs.
        (
            "Drive.\n\n[^a]: Soon.\n\n[^a]: Later.\n\n    ```\n    colcon build\n    ```\n\n    On `/cmd_vel`.",
            "Drive.",
        ),
        ("[^a]: Soon\ncolcon build\n# Drive\n\n\t[^a]\n", "# Drive ``` [^a] ```"),
        (
            "Drive[^a].\n\n[^a]: On.\n\n    ```\n    colcon build\n    ```\nEnd.",
            "Drive[^a]. End. On. ``` colcon build ```",
        ),
        (
            "Drive.\n\n[^a]: On, see [^b].\n[^b]: See [^a].\n\n[^c]: /cmd_vel",
            "Drive. On, see [^b]. See [^a].",
        ),
        ("Drive.\n\n```\n[^a]: on\n```\n\n- [^b]: and on", "Drive. ``` [^a]: on ``` [^b]: and on"),
        ("Drive <?x /cmd_vel?><!-- /cmd_vel -->.\n\n<!DOCTYPE /cmd_vel>\n\n<![CDATA[/cmd_vel]]>", "Drive ."),
        # GitHub leaves out the style, and shows the text.
        ('<font color="white">Drive</font> <span style="font-size: 0">on</span>.', "Drive on."),
        ('<div style="color: white">\n\nDrive.\n\n</div>', "Drive."),
        ('<div aria-hidden="true">Drive.</div>', "Drive."),
        ("<details><summary>More</summary>\n\n/cmd_vel\n\n</details>", "<details><summary>More /cmd_vel"),
    ],
)
def test_of_a_readme_only_what_a_page_shows_is_read(
    look: Callable[[Texts], Files], text: str, read: str
) -> None:
    assert look(right_package() | {"README.md": text}).readme.split() == read.split()


@pytest.mark.parametrize(
    ("name", "text", "read"),
    [
        ("README.rst", ".. /cmd_vel\n\nDrive.\n\n..\n   ros2 run a b\n\n   more\n\nOn.", "Drive. On."),
        (
            "README.rst",
            ".. code-block:: bash\n\n   colcon build\n\n.. _there: x\n.. [1] on\n",
            "``` colcon build ``` 1 on",
        ),
        ("README.rst", "Drive ... on.\n\n..\n\n   quoted", "Drive ... on. quoted"),
        ("README.rst", "Drive\n=====\n\n.. |a| replace:: /cmd_vel\n\n.. meta::\n   :a: /cmd_vel", "# Drive"),
        ("README.rst", ".. |a| replace:: /cmd_vel\n\nUse |a| `here`_.\n\n.. _here: /x", "Use /cmd_vel here."),
        (
            "README.rst",
            "Drive.\n\n.. raw:: latex\n\n   colcon build\n\n.. class:: x\n\n.. title:: y",
            "Drive.",
        ),
        ("README.rst", "Drive.\n\n.. only:: never\n\n   ros2 run a b\n\n.. include:: setup.py", "Drive."),
        (
            "README.rst",
            ".. note:: Drive\n\n   on.\n\n1. ``a``::\n\n     ros2 run\n",
            "Drive on. `a`: ``` ros2 run ```",
        ),
        ("README.adoc", "Drive.\n\n[stem]\n++++\n/cmd_vel\n++++", "Drive."),
        ("README.rst", "Drive :math:`v = 2`.\n\n.. math::\n\n   \\phantom{/cmd_vel}\n", "Drive v = 2."),
        ("README.adoc", "// /cmd_vel\nDrive.\n////\nros2 run a b\n////\nOn http://x.", "Drive. On http://x."),
        (
            "README.org",
            "# /cmd_vel\n#+TITLE: Drive\n#+BEGIN_COMMENT\nx\n#+END_COMMENT\nOn.",
            "#+TITLE: Drive On.",
        ),
        (
            "README.adoc",
            "Robot\n-----\n:r: r\n:pkg: {r}c\n:x: /cmd_vel\n:z: {x}\n\nDrive {pkg} {y}.\n\n[comment]\n/cmd_vel\n\n[comment]\n--\n/cmd_vel\n\n--\nOn.",
            "Robot ----- Drive rc {y}. On.",
        ),
        (
            "README.adoc",
            "ifdef::env-github[]\n:tip: x\nOne.\nendif::[]\nifdef::never[]\n/cmd_vel\nifdef::pkg[]\n/cmd_vel\nendif::[]\nendif::[]\nifndef::never[Two.]\nifeval::[1 == 2]\n/cmd_vel\nendif::[]\nThree.",
            "One. Two. Three.",
        ),
        (
            "README.adoc",
            "====\n////\n/cmd_vel\n////\n====\n[source,bash]\n----\n// as it is\n:a: b\n----\n++++\n<!-- /cmd_vel -->\n++++\n* one",
            "==== ==== [source,bash] ---- // as it is :a: b ---- * one",
        ),
        (
            "README.org",
            "#+AUTHOR: /cmd_vel\n* One\n:PROPERTIES:\n:a: /cmd_vel\n:END:\n#+begin_src bash\ncolcon build\n#+end_src\n* Two :noexport:\n/cmd_vel\n** Below\n/cmd_vel\n* COMMENT Three\n/cmd_vel\n* Four\n#+BEGIN_EXPORT latex\n/cmd_vel\n#+END_EXPORT\n: on",
            "* One #+begin_src bash colcon build #+end_src * Four : on",
        ),
        (
            "README.org",
            "On.\n#+begin_src sh :exports none\nros2 run a b\n#+end_src\n#+HEADER: :exports results\n#+begin_src sh\nros2 run a b\n#+end_src\n",
            "On.",
        ),
        (
            "README.org",
            "#+PROPERTY: header-args :exports none\n#+begin_src sh\nros2 run a b\n#+end_src\n#+begin_src sh :exports code\ncolcon build\n#+end_src",
            "#+begin_src sh :exports code colcon build #+end_src",
        ),
        ("README.org", "Go @@latex:/cmd_vel@@on src_sh[:exports none]{ros2 run a b}.", "Go on ."),
        ("README.rst", ".. role:: tex(raw)\n   :format: latex\n\nDrive :tex:`/cmd_vel` _`on`.", "Drive on."),
        ("README.txt", "# Drive\n// on\n.. and on", "# Drive // on .. and on"),
    ],
)
def test_of_other_kinds_of_text_no_comment_is_read(
    look: Callable[[Texts], Files], name: str, text: str, read: str
) -> None:
    assert look(right_package() | {name: text}).readme.split() == read.split()


def test_the_readmes_of_package_and_workspace_count_and_those_of_other_packages_do_not(
    look: Callable[[Texts], Files],
) -> None:
    texts = {f"ws/src/robot_controller/{name}": text for name, text in right_package().items()}
    texts |= {"ws/README.md": "workspace", "ws/src/robot_controller/README.md": "package"}
    texts |= {"ws/src/other/package.xml": MANIFEST.replace("robot_controller", "other")}
    texts |= {"ws/src/other/README.md": "other", "LICENSE.md": "license"}
    assert look(texts).readme == "package\n\nworkspace"


def test_other_notes_are_read_where_there_is_no_readme(look: Callable[[Texts], Files]) -> None:
    assert look(right_package() | {"documentation.md": "how to", "LICENSE.md": "license"}).readme == "how to"


@pytest.mark.parametrize(
    ("file", "old", "new", "is_known"),
    [
        ("package.xml", "</description>", " {}</description>", False),
        ("package.xml", "</description>", "</description><!-- {} -->", False),
        ("package.xml", "</license>", "</license>\n  <depend>{}</depend>", True),
        ("setup.py", "description='", "description='{} ", False),
        ("setup.py", "from setuptools", "# {}\nfrom setuptools", False),
        ("robot_controller/status_publisher.py", "import rclpy\n", "import rclpy  # {}\n", False),
        ("robot_controller/status_publisher.py", "the robot is.", "the robot is: {}.", False),
        ("robot_controller/status_publisher.py", "import rclpy\n", 'import rclpy\nNAMES = "{}"\n', True),
        (
            "robot_controller/status_publisher.py",
            "import rclpy\n",
            "import rclpy\nclass Old:\n  {} = 1\n",
            True,
        ),
    ],
)
def test_what_only_people_read_is_no_name_of_code(
    look: Callable[[Texts], Files], file: str, old: str, new: str, is_known: bool
) -> None:
    """A README of another package's names is no truer for having its words in a comment or a description."""
    names = ("arm_mover", "grip_server", "joint_reader")
    texts = right_package() | {"README.md": " ".join(f"`{name}`" for name in names)}
    assert old in texts[file]
    separator = " = " if "class" in new else "</depend><depend>" if "depend" in new else " "
    found = look(texts | {file: texts[file].replace(old, new.format(separator.join(names)), 1)})
    assert found.readme_foreign == ([] if is_known else [*names])


def test_docstrings_and_comments_describe(look: Callable[[Texts], Files]) -> None:
    module = (
        "#!/usr/bin/env python3\nimport rclpy\n\n\nclass Bare:\n    def bare(self):\n        self.x = 1\n        self.y = 2\n\n\n"
        '# Says why.\nclass Commented:\n    """ """\n\n    def inside(self):\n        # Because.\n        pass\n\n\n'
        'def told():\n    """Do it."""\n\n\n'
        'def dotted():\n    """..."""\n    print(1)\n    print(2)\n\n\n'
        "USED = [Bare().bare, Commented().inside, told, dotted]\n"
    )
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": module})
    assert found.sources == {"modules": [1, 1], "classes": [1, 2], "functions": [0, 2], "about": [0, 1]}


@pytest.mark.parametrize("file", ["status.py", "nodes/status.py"])
def test_modules_that_setup_does_not_lead_to_are_described_all_the_same(
    look: Callable[[Texts], Files], file: str
) -> None:
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, file: STATUS, "test/test_it.py": STATUS})
    assert found.sources == {"modules": [1, 1], "classes": [1, 1], "functions": [2, 2], "about": [4, 4]}
    assert found.handlers["of an end"]


@pytest.mark.parametrize("file", ["status.py", "scripts/status.py", "src/nodes/status.py"])
@pytest.mark.parametrize(
    ("right", "wrong", "code"),
    [
        ("import rclpy\n", "import rospy\n", "ros1-import"),
        ("super().__init__", "super().init", "super-misspelt"),
    ],
)
def test_modules_that_setup_does_not_lead_to_are_diagnosed_all_the_same(
    look: Callable[[Texts], Files], file: str, right: str, wrong: str, code: str
) -> None:
    found = look({"package.xml": MANIFEST, file: STATUS.replace(right, wrong)})
    assert code in {one[0] for one in found.findings if one[2].startswith(file)}


BARE = "class Bare:\n    def __init__(self):\n        self.x = 1\n\n\ndef main():\n    Bare()\n"


@pytest.mark.parametrize(
    ("text", "functions"),
    [
        (BARE, [0, 0]),
        (BARE.replace("main():", "main():  # starts it").replace("x = 1", "x = 1  # in m, forward"), [2, 2]),
        ("def main():\n    print(1)\n    print(2)\n", [0, 1]),
        ("def tell():\n    print()\n", [0, 0]),
        ("def tell():\n    if True:\n        print()\n", [0, 1]),
        ("# --- telling it ---\n\n\ndef tell():\n    print(1)\n    print(2)\n", [1, 1]),
        ("if True:\n    X = 1\n    # the end\n\ndef tell():\n    print(1)\n    print(2)\n", [0, 1]),
        ("X = 1  # m\ndef tell():\n    print(1)\n    print(2)\n", [0, 1]),
        ("# --- telling ---\nX = 1\n\n\ndef tell():\n    print(1)\n    print(2)\n", [0, 1]),
    ],
)
def test_what_everybody_knows_needs_no_description(
    look: Callable[[Texts], Files], text: str, functions: list[int]
) -> None:
    """A constructor, the usual `main` and what has one statement count where they are described."""
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": _used(text)})
    assert found.sources["functions"] == functions


@pytest.mark.parametrize(
    ("body", "described"),
    [
        ("{about}{method}", (1, 0)),  # as a comment that stands in for a docstring
        ("{about}\n{method}", (1, 0)),
        ("\n{about}{method}", (0, 1)),
        ("\n{about}\n{method}", (1, 0)),
        ("{about}    @property\n{method}", (1, 0)),
        ("{about}\n{about}{method}", (1, 1)),
        ('    """Tell what the robot does now."""\n{about}{method}', (1, 1)),
        ("    state = 1  # what the robot does now\n\n{method}", (1, 0)),
    ],
)
def test_a_comment_describes_a_class_or_its_first_method(
    look: Callable[[Texts], Files], body: str, described: tuple[int, int]
) -> None:
    method = "    def tell(self):\n        print(1)\n        print(2)\n"
    text = _used("class Robot:\n" + body.format(about="    # Tells how the robot is.\n", method=method))
    text += "\nUSED.append(Robot().tell)\n"
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    assert (found.sources["classes"], found.sources["functions"]) == ([described[0], 1], [described[1], 1])


def _used(text: str) -> str:
    """Return a module of which something uses all functions and classes."""
    names = re.findall(r"^(?:def|class) (?!main)(\w+)", text, re.MULTILINE)
    return f"{text}\n\nUSED = [{', '.join(names)}]\n"


@pytest.mark.parametrize(
    ("comment", "is_described"),
    [
        ("# It counts.", 1),
        ("# speed = 1.0", 0),
        ("#self.publish(speed)", 0),
        ("# forward", 0),
        ("# seconds", 0),
        ("# battery goes down", 1),
        ("# 启动", 1),
        ("# File: status.py", 0),
        ("# !/usr/bin/env python3", 0),
        ("speed = 1.0  # in m/s, forward", 1),
        ("speed = 1.0  # forward\n    angle = 2  # left", 0),
        ("self.subscription  # prevent unused variable warning", 0),
        ("# Destroy the node explicitly\n    # (optional - otherwise it will be done)", 0),
        ("# speed: in m/s", 1),
        ("# the robot is ready", 1),
        ("# Status: ready", 1),
        ("# start\n    # stop", 1),
        ("# if self.is_ready:\n    #     self.publish(speed)", 0),
        ("# for word in words:", 0),
        ("# from std_msgs.msg import String", 0),
        ("# TODO: rename", 0),
        ("# robot_controller/status.py", 0),
        ("# Licensed under X.\n    # Unless required by law, it is as it is.", 0),
        ("# Licensed under X.\n\n    # It tells.", 1),
    ],
)
def test_code_that_was_taken_out_describes_nothing(
    look: Callable[[Texts], Files], comment: str, is_described: int
) -> None:
    text = _used(f"def tell():\n    {comment}\n    print(1)\n    print(2)\n")
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    assert found.sources["functions"] == [is_described, 1]


@pytest.mark.parametrize(
    ("docstring", "described"),
    [
        ("Tell {name}.", 0),  # whoever writes that of each has looked at none
        ("Function {name}.\n\n    :return: a value", 0),
        ("Say {text}.", 5),
        ("The {name}.", 5),
        ("{name}", 0),
        ("TODO: describe", 0),
        ("_summary_\n\n    Args:\n        x (_type_): _description_", 0),
        ("The {name} of the {text}, in m/s.", 5),
        ("速度", 0),  # of each the same
    ],
)
def test_a_docstring_describes_what_it_tells_from_others(
    look: Callable[[Texts], Files], docstring: str, described: int
) -> None:
    names = ("go", "turn", "halt", "wait", "look")
    said = ("where to", "left or right", "at once", "for long", "around")
    text = "\n\n".join(
        f'def {name}():\n    """{docstring.format(name=name, text=text)}"""\n    print(1)\n    print(2)\n'
        for name, text in zip(names, said, strict=True)
    )
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": _used(text)})
    assert found.sources["functions"] == [described, 5]


@pytest.mark.parametrize("count", [1, 2, 3, 4, 20])
def test_sentences_by_turns_are_generated(look: Callable[[Texts], Files], count: int) -> None:
    """A few sentences for all say as little as one does; that each has its own cannot be told from work."""
    said = ("Do the work of {}", "Part for {} here", "Care about {}", "Help with {}")[:count]
    said = said if count < 5 else tuple(f"Tell {letter * 5} of {{}}" for letter in "abcdefghijklmnop")
    names = ("go", "halt", "turn", "wait", "look", "call", "rest", "back")
    code = [
        f'def {name}():\n    """{said[number % len(said)].format(name)}."""\n    print(1)\n    print(2)\n'
        for number, name in enumerate(names)
    ] + [
        f'class {name.title()}er:\n    """{said[number % len(said)].format(f"{name.title()}er")}."""\n    x = 1\n    y = 2\n'
        for number, name in enumerate(names)
    ]
    text = _used("\n\n".join(code))
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    whole = [8, 8] if count > 4 else [0, 8]
    assert (found.sources["functions"], found.sources["classes"]) == (whole, whole)


def test_each_kind_may_be_described_in_one_way(look: Callable[[Texts], Files]) -> None:
    """Such as the classes of three nodes, and their callbacks."""
    kinds = (
        ('class {}:\n    """Node for the {}."""\n    x = 1\n    y = 2\n', ("Status", "Command", "Speed")),
        (
            'def {}():\n    """Callback called by {}."""\n    print(1)\n    print(2)\n',
            ("tick", "take", "told"),
        ),
    )
    text = _used("\n\n".join(form.format(name, name) for form, names in kinds for name in names))
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    assert (found.sources["functions"], found.sources["classes"]) == ([3, 3], [3, 3])


def test_some_may_be_described_alike(look: Callable[[Texts], Files]) -> None:
    """Such as the answers to commands: what tells that nobody wrote it is only that most are."""
    alike = [
        f'def {name}():\n    """Obey the command {name}."""\n    print(1)\n'
        for name in ("go", "halt", "turn", "wait")
    ]
    others = [f'def {name}():\n    """{said}."""\n    print(1)\n' for name, said in {
        "main": "Run it until Ctrl-C", "told": "Tell how fast it is", "tick": "Publish what is due", "text": "Return a line for the log"
    }.items()]  # fmt: skip
    text = _used("\n\n".join([*alike, *others]))
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    assert found.sources["functions"] == [8, 8]


@pytest.mark.parametrize(
    ("body", "is_used", "described"),
    [
        ("", True, 0),
        ("    pass\n", True, 0),
        ("    return 3\n", True, 0),
        ("    ...\n    return\n", True, 0),
        ("    print(3)\n", False, 0),
        ("    print(3)\n", True, 1),
        ("    raise NotImplementedError\n", True, 1),
    ],
)
def test_words_about_what_does_nothing_describe_nothing(
    look: Callable[[Texts], Files], body: str, is_used: bool, described: int
) -> None:
    """Nor those about what nothing uses: both can be made by the dozen."""
    text = f'def tell():\n    """Say what there is to say."""\n{body}'
    text = _used(text) if is_used else text
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": text})
    assert found.sources["functions"] == [described, described]


def test_one_docstring_may_tell_of_a_few(look: Callable[[Texts], Files]) -> None:
    """Such as of each `main`, and of a class as of its module."""
    text = '"""Run it."""\n\n\n' + "\n\n".join(
        f'class {name}:\n    """Run it."""\n    def main(self):\n        """Run it."""\n'
        for name in ("A", "B")
    )
    found = look({"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": _used(text)})
    assert found.sources["classes"] == [2, 2]


def test_own_tests_are_counted_and_those_of_style_are_not(look: Callable[[Texts], Files]) -> None:
    own = "import unittest\n\n\ndef test_one():\n    assert 1\n\n\nclass TestIt(unittest.TestCase):\n    def test_two(self):\n        pass\n"
    texts = right_package() | {"test/test_own.py": own, "test/helper.py": "x = 1\n"}
    texts["test/test_style.py"] = (
        "from ament_flake8.main import main\n\n\ndef test_flake8():\n    assert main() == 0\n"
    )
    texts["test/test_empty.py"] = "x = 1\n"
    texts["test/test_launch.py"] = f"import launch_testing\nNODE = ('robot_controller', 'status')\n{own}"
    found = look(texts)
    assert found.tests == {"test/test_own.py": 2}
    assert found.notes == ["test/test_launch.py was not run: launch_testing cannot be imported here."]
    assert found.tests_left_out == ["test/test_launch.py"]


@pytest.mark.parametrize(
    ("line", "is_about"),
    [
        ("import launch_testing", False),
        ("import launch_testing  # robot_controller", False),
        ("import launch_testing\n'Tests robot_controller.'", False),
        ("import launch_testing\nfrom robot_controller import status", True),
        ("import launch_testing\nPATH = 'robot_controller/launch/all.launch.py'", True),
    ],
)
def test_a_test_that_is_left_out_is_about_the_package(
    look: Callable[[Texts], Files], line: str, is_about: bool
) -> None:
    """One that names nothing of it would find no fault in it anywhere."""
    text = f"{line}\n\n\ndef test_one():\n    assert True\n"
    found = look(right_package() | {"test/test_launch.py": text})
    assert (found.tests, found.tests_left_out) == ({}, ["test/test_launch.py"] if is_about else [])


def test_launch_arguments_that_no_launch_file_names_are_known(look: Callable[[Texts], Files]) -> None:
    """Of one that includes others nobody knows what these take."""
    plain = "LaunchConfiguration('period')\n# colour\n"
    texts = right_package() | {
        "README.md": "`ros2 launch robot_controller a.launch.py period:=1 colour:=red VALUE:=3`",
        "launch/a.launch.py": plain,
        "launch/b.launch.py": f"{plain}IncludeLaunchDescription()\n",
    }
    assert look(texts).launch_lacks == {"launch/a.launch.py": ["colour"]}


def test_what_may_show_the_nodes_running_is_named(look: Callable[[Texts], Files]) -> None:
    shown = ["docs/Run.PNG", "logs/terminal_1.txt", "run.log"]
    others = ["notes.txt", "png", "docs/png.py", "requirements.txt"]
    assert look(right_package() | dict.fromkeys([*shown, *others], RECORDED)).recordings == shown


@pytest.mark.parametrize("text", ["", "\n", "0" * 9000, "it runs"])
def test_what_holds_nothing_shows_nothing(look: Callable[[Texts], Files], text: str) -> None:
    """A file that is only called a picture or a log is no evidence that anything ran."""
    assert look(right_package() | dict.fromkeys(["run.png", "run.log", "film.mp4"], text)).recordings == []


def test_not_more_than_a_few_pictures_are_named(look: Callable[[Texts], Files]) -> None:
    assert len(look(dict.fromkeys(map("{}.png".format, range(99)), RECORDED)).recordings) == 10


@pytest.mark.parametrize("name", ["Youri Smit", "You Li", "Young Kim", "Youssef Your"])
def test_a_person_may_have_a_name_like_that_of_a_reader(look: Callable[[Texts], Files], name: str) -> None:
    manifest = MANIFEST.replace("ada@example.org", f"{name.lower().replace(' ', '.')}@example.org")
    found = look({"package.xml": manifest.replace(">Ada<", f">{name}<"), "setup.py": SETUP})
    assert found.manifest["maintainer_is_written"]


def test_handlers_are_told_apart(look: Callable[[Texts], Files]) -> None:
    module = (
        "try:\n    work()\nexcept (KeyError, ValueError):\n    pass\nexcept Exception:\n    pass\n"
        "try:\n    work()\nexcept:\n    pass\n"
        "try:\n    work()\nexcept (KeyboardInterrupt, executors.ExternalShutdownException):\n    pass\n"
    )
    file = "robot_controller/helper.py"
    node = "import rclpy\n\nfrom robot_controller import helper\n"
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    texts |= {file: module, "robot_controller/node.py": node, "robot_controller/of_ros_1.py": module}
    found = look(texts)
    assert found.handlers == {
        "by name": [Place(file, 3)],
        "wholesale": [Place(file, 5), Place(file, 9)],
        "of an end": [Place(file, 13)],
    }


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("try:\n    work()\nexcept ValueError:\n    raise\n", ""),
        ("try:\n    work()\nexcept ValueError as error:\n    raise error\n", ""),
        ("try:\n    x = float('2.0')\nexcept ValueError:\n    x = 0.0\n", ""),
        ("try:\n    x = int(1)\n    pass\nexcept ValueError:\n    x = 0\n", ""),
        ("try:\n    work()\nexcept GeneratorExit:\n    pass\n", "of an end"),
        (
            "try:\n    work()\nexcept ValueError as error:\n    raise RuntimeError('no number') from error\n",
            "by name",
        ),
        ("try:\n    work()\nexcept ValueError:\n    print('no number')\n    raise\n", "by name"),
        ("try:\n    x = float(text)\nexcept ValueError:\n    x = 0.0\n", "by name"),
        ("try:\n    x = open('a')\nexcept OSError:\n    x = None\n", "by name"),
        ("try:\n    int(text)\nexcept ValueError:\n    pass\n", ""),
        ("try:\n    float(str(node.get_name()))\nexcept ValueError:\n    'no number'\n", ""),
        ("try:\n    node.get_parameter('x')\nexcept ParameterNotDeclaredException:\n    pass\n", ""),
        ("try:\n    int(text)\nexcept ValueError:\n    print('no number')\n", "by name"),
        ("try:\n    int(text)\nexcept ValueError:\n    pass\nelse:\n    work()\n", "by name"),
        ("try:\n    int(work())\nexcept ValueError:\n    pass\n", "by name"),
        ("try:\n    x = int(text)\nexcept ValueError:\n    pass\n", "by name"),
        ("try:\n    node.publish(text)\nexcept ValueError:\n    pass\n", "by name"),
    ],
)
def test_a_handler_that_changes_nothing_is_none(look: Callable[[Texts], Files], text: str, kind: str) -> None:
    """One that only raises again, or is around what comes out the same each time, or of which nothing comes."""
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    found = look(texts | {"robot_controller/node.py": f"import rclpy\n{text}"}).handlers
    assert [one for one, places in found.items() if places] == [kind] * bool(kind)


_OWN = "class Own(Exception):\n    pass\n\n\nclass Less(Own):\n    pass\n\n\n"
_TRIED = {  # what a method tries, and what it catches first and then; the last one is asked for
    "a line for the log": ("self.get_logger().info('well')", ["ValueError"], False),
    "a line with a count": ("self.count += 1\nself.get_logger().info(f'{self.count}')", ["KeyError"], False),
    "a printed line": ("print('here', self.count)", ["Exception"], False),
    "a choice of constants": ("if self.count > 3:\n    self.count = 0\nelse:\n    pass", ["OSError"], False),
    "a function that is only made": ("def later():\n    return open('a')", ["OSError"], False),
    "the making of its node": ("super().__init__('node')", ["ZeroDivisionError"], False),
    "what it raises anyway": ("print('now')\nraise ValueError('now')", ["ValueError"], False),
    "what always fails": ("x = 1 / 0", ["ZeroDivisionError"], False),
    "an index that is never there": ("x = {}['a']", ["KeyError"], False),
    "what was caught within": ("try:\n    work()\nexcept Exception:\n    pass", ["ValueError"], False),
    "what was caught before": ("work()", ["Exception", "ValueError"], False),
    "what a wider one has caught": ("work()", ["LookupError", "KeyError"], False),
    "an error that nobody raises": ("work()", ["Own"], False),
    "a derived error that nobody raises": ("raise Own() if self.count else self.why", ["Less"], False),
    "a line, and Ctrl-C besides": (
        "self.get_logger().info('well')",
        ["(ValueError, KeyboardInterrupt)"],
        False,
    ),
    "Ctrl-C at a line": ("self.get_logger().info('well')", ["KeyboardInterrupt"], True),
    "Ctrl-C after an error": ("work()", ["Exception", "KeyboardInterrupt"], True),
    "an attribute that may be missing": ("print(self.count)", ["AttributeError"], True),
    "what a property may raise": ("self.count = self.later", ["ValueError"], True),
    "a letter that a terminal lacks": ("print(self.count)", ["UnicodeEncodeError"], True),
    "values that are taken apart": ("x, y = word", ["ValueError"], True),
    "an error that is raised": ("if self.count:\n    raise Own('enough')", ["Own"], True),
    "an error that is raised as another": ("if self.count:\n    raise Less", ["Own"], True),
    "a narrower one before": ("work()", ["KeyError", "LookupError"], True),
    "all, after one": ("work()", ["ValueError", "Exception"], True),
    "a number in a message": ("self.speed = float(msg.data)", ["ValueError"], True),
    "a field of a message": ("self.word = msg.data.lower()", ["AttributeError"], True),
    "a choice by a message": ("if msg.data == 'go':\n    self.get_logger().info('go')", ["Exception"], True),
    "a parameter": (
        "self.speed = self.get_parameter('speed').value",
        ["ParameterNotDeclaredException"],
        True,
    ),
    "a word that is looked up": ("self.state = STATES[word]", ["KeyError"], True),
    "a division": ("self.rate = 1.0 / self.period", ["ZeroDivisionError"], True),
    "a condition that is refused": ("if self.count < 0:\n    raise ValueError('less')", ["ValueError"], True),
    "a sum of what may be anything": ("self.count += 1", ["TypeError"], True),
    "a message": ("self.publisher_.publish(String(data='well'))", ["Exception"], True),
    "a file": ("with open('a') as file:\n    self.text = 'read'", ["OSError"], True),
    "a module": ("import serial", ["ImportError"], True),
    "its node": ("super().__init__('node')", ["Exception"], True),
    "a node's own error": ("super().__init__('node')", ["InvalidNodeNameException"], True),
    "an assertion": ("assert self.count", ["AssertionError"], True),
    "an empty message": ("message = String()", ["ImportError"], False),
    "a division that is none": ("msg.linear.x = 0.2 * len([1])", ["ZeroDivisionError"], False),
    "a look at a field": ("self.word = msg.data", ["LookupError"], False),
    "what publishing never raises": ("self.publisher_.publish(msg)", ["ZeroDivisionError"], False),
    "an end of nothing": ("if msg.data == 'go':\n    self.count = self.count % 3", ["StopIteration"], False),
    "a function of its own": (
        "def say(n):\n    return f'at {n}'\n\nself.word = say(3)",
        ["UnicodeError"],
        False,
    ),
    "a text that cannot be sent": ("self.publisher_.publish(msg)", ["UnicodeEncodeError"], True),
    "a remainder": ("self.count = 12 % msg.step", ["ZeroDivisionError"], True),
    "a place in a list": ("self.word = msg.data.split()[1]", ["IndexError"], True),
    "a letter of a text": ("self.word = msg.data[0]", ["IndexError"], True),
    "a function of its own that fails": (
        "def say(n):\n    return STATES[n]\n\nself.word = say(word)",
        ["KeyError"],
        True,
    ),
    "one that parses": ("def say(n):\n    return float(n)\n\nself.word = say(word)", ["ValueError"], True),
    "one that refuses": (
        "def say(n):\n    if n < 0:\n        raise KeyError(n)\n    return n\n\nself.word = say(3)",
        ["KeyError"],
        True,
    ),
    "a next one": ("self.word = next(self.words)", ["StopIteration"], True),
    "an unknown call": ("self.word = work(msg.data)", ["ZeroDivisionError"], True),
    "a format": ("print(f'{self.count:d}')", ["ValueError"], True),
    "a word in a table of constants": ("WORDS['start']", ["KeyError"], False),
    "one that is not there": ("x = WORDS['go']['a']", ["KeyError"], True),
    "a place in a list of constants": ("self.word = NAMES[0]", ["IndexError"], False),
    "a letter of a constant": ("x = 'abc'[1]", ["IndexError"], False),
    "a part of a constant": ("x = 'a b'.index('b') + int(WORDS[FIRST])", ["ValueError"], False),
    "an own table": ("self.table = {'a': 1}\nself.word = self.table['a']", ["KeyError"], False),
    "a table that is filled": ("FILLED[word] = 1\nself.word = FILLED['a']", ["KeyError"], True),
    "a table that is given away": ("work(GIVEN)\nself.word = GIVEN['a']", ["KeyError"], True),
    "a table that is emptied": ("self.word = LESS['a']\nLESS.clear()", ["KeyError"], True),
    "a table by another name": ("OTHER = ALSO\nself.word = ALSO['a']", ["KeyError"], True),
    "a table that comes later": ("self.word = MADE['a']\nMADE = {'a': word}", ["KeyError"], True),
    "a table of another one": ("self.word = word['a']", ["KeyError"], True),
    "a word of a message": ("self.word = WORDS[msg.data]", ["KeyError"], True),
}
_TABLES = {"WORDS": {"start": 1}, "FIRST": "start", "NAMES": ["a", "b"]}
_TABLES |= {name: {"a": 1} for name in ("FILLED", "GIVEN", "LESS", "ALSO")}


@pytest.mark.parametrize(("body", "kinds", "is_handled"), _TRIED.values(), ids=_TRIED)
def test_a_handler_of_what_never_fails_handles_nothing(
    look: Callable[[Texts], Files], body: str, kinds: list[str], is_handled: bool
) -> None:
    tried = textwrap.indent(body, "    ")
    caught = "".join(f"except {kind}:\n    print('caught')\n" for kind in kinds)
    method = textwrap.indent(f"try:\n{tried}\n{caught}", "        ")
    tables = "".join(f"{name} = {value!r}\n" for name, value in _TABLES.items())
    text = f"import rclpy\nfrom std_msgs.msg import String\n\n\n{tables}{_OWN}class A:\n    def __init__(self, msg, word):\n{method}\n    def later(self):\n        pass\n\nA(1, 2)\n"
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    found = look(texts | {"robot_controller/node.py": text}).handlers
    last = text[: text.rindex("except ")].count("\n") + 1
    assert any(place.line == last for places in found.values() for place in places) == is_handled


@pytest.mark.parametrize(
    ("making", "tried", "is_handled"),
    [
        ("self.speed = 0.3", "print(self.speed)", False),
        ("self.speed: float = 0.3", "self.last = self.speed", False),
        ("self.speed: float", "print(self.speed)", True),
        ("if msg:\n    self.speed = 0.3", "print(self.speed)", True),
        ("self.last = 0.3", "print(self.speed)", True),
        ("self.speed = None", "print(self.speed.x)", True),
        ("self.speed = 0.3", "del self.speed", True),
        ("self.go()\nself.speed = 0.3", "print(self.speed)", True),
        ("other.speed = 0.3", "print(self.speed)", True),
    ],
)
def test_what_a_node_is_made_with_is_never_missing(
    look: Callable[[Texts], Files], making: str, tried: str, is_handled: bool
) -> None:
    text = (
        "import rclpy\n\n\nclass A:\n    def __init__(self, msg, other):\n"
        f"{textwrap.indent(making, ' ' * 8)}\n\n    def go(self):\n        try:\n            {tried}\n"
        "        except AttributeError:\n            print('caught')\n\n\nA(1, 2).go()\n"
    )
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    handlers = look(texts | {"robot_controller/node.py": text}).handlers
    assert any(handlers.values()) == is_handled


_ENDS_OF_OTHER_NAMES = {
    "an alias": "Stop = KeyboardInterrupt\n{}except Stop:\n    pass\n",
    "an alias of an alias": "A = KeyboardInterrupt\nStop: type = A\n{}except (Stop, SystemExit):\n    pass\n",
    "an import": "from builtins import KeyboardInterrupt as Stop\n{}except Stop:\n    pass\n",
    "a tuple": "ENDS = (KeyboardInterrupt, rclpy.executors.ExternalShutdownException)\n{}except ENDS:\n    pass\n",
    "a sum": "ENDS = (KeyboardInterrupt,)\n{}except (*ENDS, *(ENDS + (SystemExit,))):\n    pass\n",
    "a class": "class Stop(KeyboardInterrupt):\n    pass\n\n{}except Stop:\n    pass\n",
    "a name for itself": "Stop = Stop = KeyboardInterrupt\nStop = Stop\n{}except Stop:\n    pass\n",
}


@pytest.mark.parametrize("module", _ENDS_OF_OTHER_NAMES.values(), ids=_ENDS_OF_OTHER_NAMES)
def test_an_end_stays_one_under_another_name(look: Callable[[Texts], Files], module: str) -> None:
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    texts |= {
        "robot_controller/helper.py": module.format("try:\n    work()\n"),
        "robot_controller/node.py": "import rclpy\n\nfrom robot_controller import helper\n",
    }
    handlers = look(texts).handlers
    assert (len(handlers["of an end"]), handlers["by name"], handlers["wholesale"]) == (1, [], [])


@pytest.mark.parametrize(
    "module",
    [
        "Wrong = ValueError\n{}except Wrong:\n    pass\n",
        "from rclpy.exceptions import InvalidHandle as Wrong\n{}except (Wrong, KeyboardInterrupt):\n    pass\n",
        "class Wrong(Exception):\n    pass\n\ndef tell():\n    raise Wrong\n\n{}except Wrong:\n    pass\n",
    ],
)
def test_an_error_is_named_under_another_name(look: Callable[[Texts], Files], module: str) -> None:
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, "robot_controller/__init__.py": ""}
    texts |= {
        "robot_controller/helper.py": module.format("try:\n    work()\n"),
        "robot_controller/node.py": "import rclpy\n\nfrom robot_controller import helper\n",
    }
    assert look(texts).handlers["by name"]


@pytest.mark.parametrize("where", ["nodes/node", "core/machine"], ids=["the node", "what it imports"])
def test_a_node_may_have_rclpy_from_a_class_of_its_own(look: Callable[[Texts], Files], where: str) -> None:
    handler = "\n\ndef work(text):\n    try:\n        return float(text)\n    except ValueError:\n        return 0.0\n"
    folder = "robot_controller"
    texts = {"package.xml": MANIFEST, "setup.py": SETUP, f"{folder}/__init__.py": ""}
    texts |= {
        f"{folder}/nodes/__init__.py": "",
        f"{folder}/core/__init__.py": "",
        f"{folder}/core/base.py": "from rclpy.node import Node\n\n\nclass Base(Node):\n    pass\n",
        f"{folder}/core/machine.py": "",
        f"{folder}/nodes/node.py": (
            f"from {folder}.core.base import Base\nfrom {folder}.core import machine\n\n\n"
            "class Robot(Base):\n    def __init__(self):\n        machine.work('1')\n        work('1')\n"
        ),
        f"{folder}/alone.py": handler,
    }
    texts[f"{folder}/{where}.py"] += handler
    found = look(texts).handlers["by name"]
    assert [place.file for place in found] == [f"{folder}/{where}.py"]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("".join(f"<depend>d{number}</depend>" for number in range(2000)), "more than 30000 characters"),
        (f"<depend condition='{'(' * 40}1 == 1{')' * 40}'>d</depend>", "more than 5 brackets"),
    ],
    ids=["dependencies", "brackets"],
)
def test_a_manifest_that_would_take_minutes_is_passed_over(
    look: Callable[[Texts], Files], more: str, said: str
) -> None:
    manifest = MANIFEST.replace("<export>", more + "<export>")
    found = look({"package.xml": manifest, "setup.py": SETUP, "robot_controller/__init__.py": ""})
    assert not found.manifest["is_valid"]
    assert found.manifest["declares_rclpy"]
    assert any(code == "manifest-invalid" and said in cause for code, cause, *_ in found.findings)


def test_loose_files_are_described_and_have_no_facts(look: Callable[[Texts], Files]) -> None:
    found = look({"status.py": STATUS, "README.md": "how to"})
    assert (found.manifest, found.setup, found.readme) == ({}, {}, "how to")
    assert found.sources == {"modules": [1, 1], "classes": [1, 1], "functions": [2, 2], "about": [4, 4]}
    assert found.handlers["of an end"]


# Files that mean harm.


def entities(depth: int) -> str:
    lines = ['<!ENTITY a0 "ha">'] + [f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, depth)]
    return MANIFEST.replace("<package ", f"<!DOCTYPE x [{''.join(lines)}]>\n<package ", 1).replace(
        "Drives", f"&a{depth - 1};"
    )


HOSTILE: dict[str, Texts] = {
    "10 MB line": dict.fromkeys(("package.xml", "setup.py", "setup.cfg", "pyproject.toml"), "x" * 10000000),
    "deep nesting": {
        "setup.py": "(" * 100_000,
        "package.xml": "<a>" * 100_000,
        "pyproject.toml": "a = " + "[" * 100_000,
        "robot_controller/status_publisher.py": "import rclpy\nx = " + "-" * 50_000 + "1",
    },
    "zeros": {name: f"\0{text}\0" for name, text in right_package().items()},
    "entities": {"package.xml": entities(9)},
    "setup.py that would do harm": {"setup.py": "import os\nos.system('touch /tmp/harm')\nsetup(**globals())\n"},
    "paths that lead out": {
        "setup.cfg": SETUP_CFG + "[options]\npackage_dir = =../../..\npackages = find:\n"
        "[options.packages.find]\nwhere = ../..\n[options.data_files]\nshare = /etc/*\n",
        "setup.py": "from setuptools import setup\nsetup()\n",
    },
    "package in another folder": {
        "setup.py": SETUP.replace("    data_files", "    package_dir={'robot_controller': '/usr/lib', 'x': 3},\n    data_files")
    },
    "name that is a path": {"setup.py": SETUP.replace("'robot_controller'", "'../../../x'"), "package.xml": "<"},
    "patterns without end": {"setup.cfg": SETUP_CFG + "[options.data_files]\nshare = **/**/**/*\n"},
    "large value": {"setup.py": SETUP.replace("'robot_controller'", "'x' * 10**10")},
    "wrong types": {"setup.py": "from setuptools import setup\nsetup(name=3, entry_points=[1], data_files=7, packages={})\n"},
    "pyproject of wrong types": {"pyproject.toml": "project = [1]\n"},
    "project of wrong types": {"pyproject.toml": "[project]\nname = 3\nscripts = 'x'\n"},
    "more Python than anybody writes": {
        f"robot_controller/m{n}.py": f"import rclpy  # {'x' * 100}\n" * 6000 for n in range(3)
    },
    "more imports than anybody writes": {f"robot_controller/m{n}.py": "import rclpy\n" * 50_000 for n in range(3)},
    "brackets without end": {
        "launch/robot.launch.yaml": "launch: " + "[" * 90_000,
        "config/robot.yaml": "ros__parameters: " + "{" * 90_000,
    },
    "aliases of aliases": {
        "config/robot.yaml": "# ros__parameters\n" + "\n".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9 if n else 'x')}]" for n in range(30))
    },
    "comments without end": {"package.xml": "<!--" * 250_000},
    "packages of the machine": {
        "setup.py": SETUP.replace("find_packages(exclude=['test'])", "['/usr', '..', 'robot_controller']")
    },
    "a pattern that is none": {"setup.cfg": SETUP_CFG + "[options.data_files]\nshare/x = launch/**.py\n"},
    "a handler of nobody's": {
        "robot_controller/x.py": "try:\n    pass\nexcept " + "{0:" * 190 + "1" + "}" * 190 + ":\n    pass\n"
    },
    "pyproject with packages elsewhere": {
        "pyproject.toml": "[tool.setuptools.packages.find]\nwhere = ['/usr/lib', '../..', 3]\n"
    },
    "a folder in the place of a file": {"setup.py/x": "", "package.xml/x": "", "README.md/x": ""},
}  # fmt: skip


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.thorough if name == "more imports than anybody writes" else ())
        for name in HOSTILE
    ],
)
def test_hostile_files_are_looked_at_without_an_error(look: Callable[[Texts], Files], name: str) -> None:
    hostile = HOSTILE[name]
    replaced = {file.partition("/")[0] for file in hostile if file.endswith("/x")}
    texts = {file: text for file, text in right_package().items() if file not in replaced}
    found = look(texts | hostile)
    assert found.setup or "setup.py/x" in hostile
    assert not [
        place for places in found.handlers.values() for place in places if place.file.startswith(("/", ".."))
    ]
    assert not Path("/tmp/harm").exists()


@pytest.mark.parametrize("packages", ["['/usr', '/']", "['..']", "[3]"])
def test_the_diagnosis_of_a_hostile_submission_stays_in_it(tmp_path: Path, packages: str) -> None:
    """Not only what `look` asks it, but also what it makes of an error's text."""
    texts = right_package() | {"setup.py": SETUP.replace("find_packages(exclude=['test'])", packages)}
    assert packages in texts["setup.py"]
    for name, text in texts.items():
        path = tmp_path / "ws/src/robot_controller" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    found = of_text("ModuleNotFoundError: No module named 'robot_controller.statsu'", tmp_path / "ws")
    assert not any(finding.place.startswith(("/", "..")) for finding in found)


def described_as(description: str) -> Texts:
    """Return a right package of which package.xml and setup.py say something else."""
    texts = right_package()
    return texts | {
        name: texts[name].replace("Drives a robot by words.", description)
        for name in ("package.xml", "setup.py")
    }


@pytest.mark.parametrize(
    "described",
    [
        "Paquete que controla todo el robot",
        "Controla TODOS los nodos",
        "A to-do robot",
        "Velocity publisher",
        "Robot controller with three nodes",
        "Week 2 homework",
        "ROS 2 nodes",
        "Nodes &amp; commands",
        "三个节点控制机器人",
        "Три узла",
        "<![CDATA[Drives about]]>",
    ],
)
def test_a_few_words_of_ones_own_are_a_description(look: Callable[[Texts], Files], described: str) -> None:
    assert not false_facts(look(described_as(described)))


@pytest.mark.parametrize(
    "described",
    [
        "TBD",
        ".",
        "...",
        "xxx",
        "xxx xxx",
        "todo!",
        "n/a",
        "N. A.",
        "asdf",
        "-",
        "42",
        "robot_controller",
        "Robot controller",
        "RobotController",
        "The robot-controller package",
        "Package description",
        "a package",
        "TODO: say what the three nodes do",
    ],
)
def test_what_tells_nothing_is_no_description(look: Callable[[Texts], Files], described: str) -> None:
    found = false_facts(look(described_as(described)))
    assert found == {"manifest.description_is_written", "setup.is_described"}


def test_a_description_may_be_left_to_the_manifest(look: Callable[[Texts], Files]) -> None:
    texts = right_package()
    texts["setup.py"] = texts["setup.py"].replace("Drives a robot by words.", "")
    assert not false_facts(look(texts))


@pytest.mark.parametrize(
    ("line", "is_used"), [("# TODO: load robot.yaml", False), ("config = 'robot.yaml'  # all", True)]
)
def test_a_comment_uses_no_parameter_file(look: Callable[[Texts], Files], line: str, is_used: bool) -> None:
    name, file = "launch/robot.launch.py", "config/robot.yaml"
    found = look(right_package() | {file: "/**:\n  ros__parameters: {}\n", name: f"{LAUNCH}\n{line}\n"})
    assert found.parameter_file_users == {file: [name] * is_used}


@pytest.mark.parametrize(
    ("launched", "is_beside"),
    [("robot_controller", True), ("robot_controller_2", False), ("turtlesim", False)],
)
def test_a_launch_file_beside_the_package_counts_if_it_launches_it(
    look: Callable[[Texts], Files], launched: str, is_beside: bool
) -> None:
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    bringup = {
        "package.xml": MANIFEST.replace("robot_controller", "robot_bringup"),
        "launch/robot.launch.py": LAUNCH.replace("robot_controller", launched)
        + "# 'robot.yaml'\nX = 'robot.yaml'\n",
        "config/robot.yaml": PARAMETERS,
        "README.md": "How to start all of it.",
    }
    texts = {name: text for name, text in texts.items() if not name.endswith("README.md")}
    found = look(texts | {f"src/robot_bringup/{name}": text for name, text in bringup.items()})
    launch, config = "src/robot_bringup/launch/robot.launch.py", "src/robot_bringup/config/robot.yaml"
    assert found.launch_files == [launch] * is_beside
    assert found.parameter_files == ({config: {"/status_publisher": {"period": 2.0}}} if is_beside else {})
    assert found.parameter_file_users == ({config: [launch]} if is_beside else {})
    assert found.readme == ("How to start all of it." if is_beside else "")
    assert not false_facts(found)


@pytest.mark.parametrize(
    ("packages", "code"),
    [
        ("[package_name]", "package-not-listed"),
        ("find_packages(exclude=['test'])", "init-file-missing"),
        ("[package_name, package_name + '.nodes']", ""),
    ],
)
def test_modules_in_a_folder_that_is_not_installed(
    look: Callable[[Texts], Files], packages: str, code: str
) -> None:
    texts = right_package()
    setup = texts["setup.py"].replace("find_packages(exclude=['test'])", packages)
    texts["setup.py"] = setup.replace("robot_controller.status_publisher:", "robot_controller.nodes.status:")
    texts["robot_controller/nodes/status.py"] = texts.pop("robot_controller/status_publisher.py")
    found = look(texts)
    assert [finding[0] for finding in found.findings if finding[0] in SETUP_CODES] == [code] * bool(code)
    assert found.setup["installs_modules"] is not bool(code)


@pytest.mark.parametrize(
    ("changes", "false"),
    [
        # A folder of the package's name without modules, and entry points of another package.
        ({"status.py": STATUS}, {"setup.entry_points_are_own"}),
        ({}, {"setup.installs_modules", "setup.has_code", "setup.entry_points_are_own"}),
        ({"../status.py": STATUS}, {"setup.installs_modules", "setup.entry_points_are_own"}),
    ],
)
def test_what_is_not_there_is_not_installed(
    look: Callable[[Texts], Files], changes: Texts, false: set[str]
) -> None:
    texts = {name: text for name, text in right_package().items() if not name.startswith("robot_controller/")}
    texts["robot_controller/__init__.py"] = ""
    texts |= {f"robot_controller/{name}": text for name, text in changes.items()}
    texts["setup.py"] = texts["setup.py"].replace("= robot_controller.", "= homework.")
    asked = {"setup.installs_modules", "setup.has_code", "setup.entry_points_are_own"}
    assert asked & false_facts(look(texts)) == false


@pytest.mark.parametrize(
    ("name", "text", "is_one"),
    [
        ("robot_controller/launch/shapes_launch.py", LAUNCH, True),
        ("launch/robot.launch", "<launch/>", True),
        ("bringup/all.launch", "<launch/>", True),
        ("scripts/start.py", LAUNCH, True),
        ("launch/robot.xml", "<launch>\n</launch>", True),
        ("bringup/all.xml", "<robot/>", False),
        ("test/robot.launch.py", LAUNCH, False),
        ("build/robot.launch.py", LAUNCH, False),
        ("robot_controller/launch_tools.py", "X = 1\n", False),
    ],
)
def test_a_launch_file_is_one_wherever_it_lies_in_its_package(
    look: Callable[[Texts], Files], name: str, text: str, is_one: bool
) -> None:
    texts = {path: content for path, content in right_package().items() if "launch" not in path}
    found = look(texts | {name: text})
    assert found.launch_files == [name] * is_one
    fixes = [fix for code, _, _, fix, *_ in found.findings if code == "not-in-data-files" and name in fix]
    assert all("('share/robot_controller/launch'," in fix for fix in fixes)
    assert bool(fixes) is is_one


def test_a_copy_of_an_installed_launch_file_is_found_by_its_name(look: Callable[[Texts], Files]) -> None:
    texts = right_package()
    launch_and_parameters(texts)
    found = look(texts | {"robot.launch.py": LAUNCH})
    assert [code for code, *_ in found.findings] == []


@pytest.mark.parametrize(
    ("folder", "is_installed", "said"),
    [
        ("demos", True, "Did you mean robot_controller.demos.status_publisher?"),
        ("demos", False, "there is robot_controller/demos/status_publisher.py instead"),
        ("a/b", False, "there is robot_controller/a/b/status_publisher.py instead"),
    ],
)
def test_an_entry_point_is_led_to_a_file_that_is_there(
    look: Callable[[Texts], Files], folder: str, is_installed: bool, said: str
) -> None:
    """To one of the same name before one of a name alike; what is not installed has to be moved."""
    texts = right_package()
    text = texts.pop("robot_controller/status_publisher.py")
    texts["robot_controller/status_publishers.py"] = text
    texts |= {f"robot_controller/{folder}/status_publisher.py": text}
    texts |= {f"robot_controller/{folder}/__init__.py": ""} if is_installed else {}
    (cause,) = [cause for code, cause, *_ in look(texts).findings if code == "entry-point-module"]
    assert said in cause


def test_a_launch_file_in_the_workspace_counts(look: Callable[[Texts], Files]) -> None:
    texts = {f"ws/src/robot_controller/{name}": text for name, text in right_package().items()}
    found = look(texts | {"ws/launch/robot.launch.py": LAUNCH, "ws/install/a/launch/b.launch.py": LAUNCH})
    assert found.launch_files == ["ws/launch/robot.launch.py"]


def test_what_is_too_much_is_noted(look: Callable[[Texts], Files], monkeypatch: pytest.MonkeyPatch) -> None:
    """Here more than 10 kB are too much."""
    monkeypatch.setattr(graded_package, "MOST_SOURCE", 10_000)
    found = look(right_package() | {f"robot_controller/m{n}.py": "import rclpy\n" * 600 for n in range(2)})
    assert len(found.notes) == 1
    assert found.manifest["declares_rclpy"]


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("/**:\n  ros__parameters:\n    period: 1.5\n", {"/**": {"period": 1.5}}),
        (
            "status:\n  ros__parameters: {is_on: true, words: [a, b]}\n",
            {"/status": {"is_on": True, "words": "['a', 'b']"}},
        ),
        ("/robot:\n  status:\n    ros__parameters: {a: {b: 2}}\n", {"/robot/status": {"a.b": 2}}),
        ("status:\n  ros__parameters:\n", {}),  # what rcl refuses holds nothing
        ("a: &a [ros__parameters, x]\nb: *a\n", {}),  # with more of these a text of a line fills all memory
        ("status: [ros__parameters: {", {}),
        ("{" * 5000 + "ros__parameters", {}),
        ("!!python/object/apply:os.system [ros__parameters]", {}),
        ("status:\n  ros__parameters:\n    day: 2024-02-30\n", {"/status": {"day": "2024-02-30"}}),
        ("status:\n  ros__parameters:\n    is_on: !!bool maybe\n", {"/status": {"is_on": "maybe"}}),
        ("status:\n  ros__parameters:\n    count: !!int ''\n", {"/status": {"count": ""}}),
        ("status:\n  ros__parameters:\n    time: !!timestamp soon\n", {"/status": {"time": "soon"}}),
        (
            f"status:\n  ros__parameters:\n    count: 0x{'f' * 5000}\n",
            {"/status": {"count": f"0x{'f' * 5000}"}},
        ),
    ],
)
def test_the_values_in_a_parameter_file(
    look: Callable[[Texts], Files], text: str, values: dict[str, dict[str, object]]
) -> None:
    found = look(right_package() | {"config/robot.yaml": text})
    assert found.parameter_files["config/robot.yaml"] == values


def test_the_diagnosis_finds_what_is_wrong_in_the_package_and_not_beside_it(
    look: Callable[[Texts], Files],
) -> None:
    texts = right_package()
    broken = next(
        name for name in texts if name.endswith(".py") and "setup" not in name and "__init__" not in name
    )
    found = look(texts | {broken: "def main(:\n"})
    code, _, place, *_ = found.findings[0]
    assert (code, place.partition(":")[0]) == ("node-syntax", broken)


def test_classes_that_go_round_in_a_circle_are_no_end_of_the_grade(look: Callable[[Texts], Files]) -> None:
    texts = right_package()
    name = next(
        name for name in texts if name.endswith(".py") and "setup" not in name and "__init__" not in name
    )
    assert look(texts | {name: "class A(B): pass\nclass B(A): pass\n"}).sources


def test_paths_from_the_root_on_are_found_in_launch_files(look: Callable[[Texts], Files]) -> None:
    launch = (
        LAUNCH + "\nPATH = '/home/anna/ws/config/robot.yaml'\nTOPIC = '/robot/status'\n# '/old/robot.yaml'\n"
    )
    assert look(right_package() | {"launch/a.launch.py": launch}).hard_coded == [
        "/home/anna/ws/config/robot.yaml"
    ]


def test_what_a_readme_names_of_the_code_is_found(look: Callable[[Texts], Files]) -> None:
    readme = "StatusPublisher is in status_publisher.py, and main is its function."
    assert look(right_package() | {"README.md": readme}).readme_names == [
        "StatusPublisher",
        "status_publisher.py",
    ]


UNREADABLE = {
    "a section twice": "[options]\npackages = find:\n[develop]\nscript_dir=x\n[install]\ninstall_scripts=x\n[install]\n",
    "an option twice": "[options]\npackages = find:\npackages = robot_controller\n",
    "entry points twice": "[options.entry_points]\nconsole_scripts = a = b:c\nconsole_scripts = d = e:f\n",
    "files twice": "[options.data_files]\nshare/x = a\nshare/x = b\n",
    "an option of the defaults twice": "[DEFAULT]\nx = 1\nx = 2\n[options]\npackages = find:\n",
    "no section": "packages = find:\n",
    "no option": "[options]\npackages = find:\npackages\n",
}


@pytest.mark.parametrize("text", UNREADABLE.values(), ids=UNREADABLE)
def test_of_a_setup_cfg_that_setuptools_cannot_read_nothing_is_used(
    look: Callable[[Texts], Files], text: str
) -> None:
    """Nor does it keep anything else from being read; the line of its fault is told."""
    found = look({**right_package(), "setup.cfg": text})
    assert not false_facts(found)
    assert [code for code, *_ in found.findings] == ["setup-value"]
    ((_, cause, place, fix, *_),) = found.findings
    assert cause.startswith("setup.cfg has ")
    assert re.fullmatch(r".*setup\.cfg:\d+", place)
    assert fix


OF_SEVERAL = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Int32, String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.status = self.create_publisher(Int32, "/robot/status", 10)
        self.velocity = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_subscription(String, "/robot/comand", self.obey, 10)
        self.create_timer(1.0, self.drive)

    def obey(self, msg):
        if msg == "start":
            self.status.publish(Int32())

    def drive(self):
        twist = Twist()
        twist.linear.x = 1
        twist.speed = 2.0
        self.velocity.publish(String())


def main():
    rclpy.init()
    rclpy.spin(Robot())
"""


@pytest.mark.parametrize(
    ("code", "about"),
    [
        ("topic-type", "robot/status"),
        ("topic-near-miss", "robot/command"),
        ("int-in-float", "geometry_msgs.msg.Vector3"),
        ("message-field", "geometry_msgs.msg.Twist"),
        ("publish-type", "geometry_msgs.msg.Twist"),
        ("message-compared", "std_msgs.msg.String"),
    ],
)
def test_a_finding_tells_of_which_topic_or_message_it_is(
    look: Callable[[Texts], Files], code: str, about: str
) -> None:
    found = look(right_package() | {"robot_controller/status_publisher.py": OF_SEVERAL}).told()
    assert any(about in one.about for one in found if one.code == code), found


COMMAND = """import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class CommandSubscriber(Node):
    def __init__(self):
        super().__init__('command_subscriber')
        self.create_subscription(String, '/robot/command', self.obey, 10)

    def obey(self, msg):
        if msg.data == 'start':
            self.get_logger().info('starting')
        elif msg.data == 'stop':
            self.get_logger().info('stopping')
        elif msg.data == 'reset':
            self.get_logger().info('resetting')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(CommandSubscriber())
"""
SLIPS = {
    "a colon": ("'reset':", "'reset'"),
    "a bracket": ("info('starting')", "info('starting'"),
    "a quote": ("info('stopping')", "info('stopping)"),
    "another language's words": ("elif msg.data == 'stop'", "else if msg.data == 'stop'"),
    "one sign for two": ("== 'start'", "= 'start'"),
    "a space too many": ("        elif msg.data == 'stop'", "         elif msg.data == 'stop'"),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_of_a_file_with_a_slip_its_words_and_its_topic_are_read(
    look: Callable[[Texts | Path], Files], slip: str
) -> None:
    right, wrong = SLIPS[slip]
    assert right in COMMAND
    texts = right_package() | {"robot_controller/command_subscriber.py": COMMAND.replace(right, wrong, 1)}
    texts["setup.py"] = SETUP.replace(
        "'status_publisher =", "'command = robot_controller.command_subscriber:main', 'status_publisher ="
    )
    found = look(texts)
    assert found.depended_on == ["reset", "start", "stop"]
    assert {*found.compared} >= {"reset", "start", "stop"}
    assert any(end.topic == "/robot/command" and not end.is_publisher for end in found.ends)


def test_of_a_text_that_is_no_python_nothing_is_read(look: Callable[[Texts | Path], Files]) -> None:
    prose = "The node compares msg.data == 'start' with 'stop', and then with 'reset' :-)\n"
    found = look(right_package() | {"robot_controller/command_subscriber.py": prose})
    assert found.depended_on == []
