"""Forms in which work is handed in: the same three nodes, packed, placed and written in other ways."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path

from corpus.case import ALL_BONUS, Case, Loss, Make
from corpus.faults.workspace import BUILT
from corpus.package import (
    CFG,
    COMMAND,
    LAUNCH,
    MODEL,
    README,
    README_TEXT,
    SETUP,
    STATUS,
    TESTS,
    VELOCITY,
    XML,
    YAML,
    M,
    P,
)
from corpus.styles.making import PLAIN_README
from corpus.tree import (
    Change,
    Content,
    Files,
    Link,
    as_folder,
    as_tar,
    as_zip,
    drop,
    edit,
    every,
    made,
    move,
    put,
    zip_bytes,
)

REPOSITORY = Path(__file__).parents[4]


def _form(
    name: str,
    about: str,
    make: Make,
    *,
    loses: Mapping[str, Loss] | None = None,
    earns: frozenset[str] = ALL_BONUS,
) -> Case:
    return Case(f"form/{name}", about, make, loses or {}, earns=earns)


def _folder(name: str, about: str, *changes: Change, folder: str = "robot_project_ws") -> Case:
    return _form(name, about, as_folder(made(MODEL, *changes), folder))


def _reference(folder: Path, _: Mapping[str, str]) -> Path:
    """Copy the course's own workspace and package, with the link between them."""
    made_by_tools = shutil.ignore_patterns(
        "__pycache__", "build", "install", "log", "*.egg-info", ".pytest_cache"
    )
    for name in ("robot_controller", "robot_project_ws"):
        shutil.copytree(REPOSITORY / name, folder / "work" / name, symlinks=True, ignore=made_by_tools)
    return folder / "work"


def _added(files: Mapping[str, Content], below: str = "") -> Change:
    return lambda here: here.update({below + path: content for path, content in files.items()})


def _utf_16(files: Files) -> None:
    files[README] = README_TEXT.encode("utf-16")


_PACKAGE_ALONE = made(MODEL, drop(README), move(P, ""), put("README.md", README_TEXT))
_NO_WORKSPACE = {"workspace": Loss(2, 12, r"src|workspace")}
_OTHER = "src/my_first_package/"
_OTHER_PACKAGE: Files = {
    f"{_OTHER}package.xml": str(MODEL[XML]).replace("robot_controller", "my_first_package"),
    f"{_OTHER}setup.py": "from setuptools import setup\n\nsetup(\n    name='my_first_package',\n    version='0.1.0',\n"
    "    packages=['my_first_package'],\n    data_files=[\n"
    "        ('share/ament_index/resource_index/packages', ['resource/my_first_package']),\n"
    "        ('share/my_first_package', ['package.xml']),\n    ],\n"
    "    entry_points={'console_scripts': ['hello = my_first_package.hello:main']},\n)\n",
    f"{_OTHER}setup.cfg": "[develop]\nscript_dir=$base/lib/my_first_package\n[install]\ninstall_scripts=$base/lib/my_first_package\n",
    f"{_OTHER}resource/my_first_package": "",
    f"{_OTHER}my_first_package/__init__.py": "",
    f"{_OTHER}my_first_package/hello.py": "def main():\n    print('Hello')\n",
}
_MOTORS = "src/robot_motors/"
_MOTORS_PACKAGE: Files = {
    path.replace("my_first_package", "robot_motors"): str(text)
    .replace("my_first_package", "robot_motors")
    .replace("hello", "velocity_publisher")
    for path, text in _OTHER_PACKAGE.items()
    if not path.endswith("hello.py")
}
_SPREAD = made(
    MODEL,
    _added(_MOTORS_PACKAGE),
    move(VELOCITY, f"{_MOTORS}robot_motors/velocity_publisher.py"),
    edit(
        SETUP,
        "            'velocity_publisher = robot_controller.velocity_publisher:main',\n",
        "",
    ),
    edit(
        LAUNCH,
        "package='robot_controller', executable='velocity_publisher'",
        "package='robot_motors', executable='velocity_publisher'",
    ),
    edit(
        README,
        "ros2 run robot_controller velocity_publisher",
        "ros2 run robot_motors velocity_publisher",
    ),
    drop(TESTS),
)
_BRINGUP = "src/robot_bringup/"
_BRINGUP_PACKAGE: Files = {
    f"{_BRINGUP}package.xml": str(MODEL[XML])
    .replace("robot_controller", "robot_bringup")
    .replace("<depend>rclpy</depend>", "<exec_depend>robot_controller</exec_depend>"),
    f"{_BRINGUP}setup.py": "from glob import glob\n\nfrom setuptools import setup\n\nsetup(\n    name='robot_bringup',\n"
    "    version='0.1.0',\n    packages=[],\n    data_files=[\n"
    "        ('share/ament_index/resource_index/packages', ['resource/robot_bringup']),\n"
    "        ('share/robot_bringup', ['package.xml']),\n"
    "        ('share/robot_bringup/launch', glob('launch/*')),\n"
    "        ('share/robot_bringup/config', glob('config/*')),\n    ],\n)\n",
    f"{_BRINGUP}setup.cfg": str(MODEL[CFG]).replace("robot_controller", "robot_bringup"),
    f"{_BRINGUP}resource/robot_bringup": "",
}
_GERMAN = (
    README_TEXT.replace(
        "A ROS 2 Jazzy package with three nodes for a small robot, written for week two by Mira Olsen.",
        "Ein Paket für ROS 2 Jazzy mit drei Knoten, die einen kleinen Roboter lenken.",
    )
    .replace("## Set up", "## Einrichten")
    .replace("## Run", "## Starten")
    .replace("All together:", "Alle zusammen:")
    .replace(
        "Or each in a terminal of its own, in which `source install/setup.bash` was run:",
        "Oder jeden in seinem eigenen Terminal, nach `source install/setup.bash`:",
    )
    .replace("Then tell the robot what to do:", "Dann sagt man dem Roboter, was er tun soll:")
    .replace("## Nodes", "## Knoten")
    .replace("publishes", "sendet")
    .replace("subscribes to", "hört")
    .replace("every 2 s", "alle 2 s")
    .replace(
        "The commands are `start`, `stop` and `reset`; anything else is refused with a warning.",
        "Die Befehle sind `start`, `stop` und `reset`; alles andere wird mit einer Warnung abgelehnt.",
    )
    .replace(
        "The robot drives after `start` and stands still after `stop` and `reset`.",
        "Nach `start` fährt der Roboter, nach `stop` und `reset` steht er.",
    )
)
_SCRIPTS_README = """\
# Robot

Three nodes for ROS 2 Jazzy: `status_publisher`, `command_subscriber` and `velocity_publisher`.
They need rclpy, std_msgs and geometry_msgs; there is nothing to build. Each runs in a terminal of its own:

```bash
source /opt/ros/jazzy/setup.bash
python3 status_publisher.py
python3 command_subscriber.py
python3 velocity_publisher.py
```

`/robot/status` says every two seconds how the robot is, `/robot/command` takes `start`, `stop` and `reset`, and
`/cmd_vel` says how fast it should go:

```bash
ros2 topic pub --once /robot/command std_msgs/msg/String "{data: start}"
ros2 topic echo /cmd_vel
```
"""
_LOOSE: Files = {
    "README.md": _SCRIPTS_README,
    **{path.rpartition("/")[2]: MODEL[path] for path in (STATUS, COMMAND, VELOCITY)},
}

FORMS: tuple[Case, ...] = (
    _folder("workspace", "the model as it is"),
    _form("reference", "the course's own package, linked into its workspace", _reference),
    _form(
        "package_alone",
        "the package's folder without a workspace",
        as_folder(_PACKAGE_ALONE, "robot_controller"),
        loses=_NO_WORKSPACE,
    ),
    _form(
        "package_alone_in_zip",
        "the package's files at the top of a zip",
        as_zip(_PACKAGE_ALONE, "robot_controller.zip"),
        loses=_NO_WORKSPACE,
    ),
    _form(
        "built_folders",
        "build, install and log were handed in, from another machine; they are not used",
        as_folder(
            made(MODEL, _added(BUILT), put(f"{M}__pycache__/status_publisher.cpython-312.pyc", b"\xcb\r\r\n"))
        ),
        loses={"workspace": Loss(0.5, 2, "build")},
    ),
    _folder(
        "git_checkout",
        "a repository with its history",
        put(".git/HEAD", "ref: refs/heads/main\n"),
        put(".git/config", "[core]\n\tbare = false\n"),
        put(".git/refs/heads/.keep", ""),
        put(".gitignore", "build/\ninstall/\nlog/\n"),
    ),
    _form("zip", "a zip of the workspace", as_zip(made(MODEL, move("", "robot_project_ws/")))),
    _form("zip_without_folder", "a zip with src at its top", as_zip(MODEL)),
    _form("zip_in_zip", "a zip in a zip", as_zip(made(MODEL, move("", "robot_project_ws/")), depth=2)),
    _form(
        "zip_in_repository",
        "a repository that holds nothing but a zip and a line about it",
        as_folder(
            {"submission.zip": zip_bytes(MODEL, {}), "NOTES.txt": "my homework is in the zip\n"}, "homework"
        ),
    ),
    _form("tar", "a compressed tar", as_tar(made(MODEL, move("", "robot_project_ws/")))),
    _folder(
        "two_folders_down",
        "the workspace lies two folders down",
        move("", "homework/week2/robot_project_ws/"),
        folder="ros_course",
    ),
    _folder("several_packages", "src holds another package, too", _added(_OTHER_PACKAGE)),
    _folder(
        "bringup_package",
        "launch and parameter file are in a package of their own",
        _added(_BRINGUP_PACKAGE),
        move(f"{P}launch/", f"{_BRINGUP}launch/"),
        move(f"{P}config/", f"{_BRINGUP}config/"),
        edit(
            f"{_BRINGUP}launch/robot.launch.py",
            "get_package_share_directory('robot_controller')",
            "get_package_share_directory('robot_bringup')",
        ),
        edit(README, "ros2 launch robot_controller", "ros2 launch robot_bringup"),
    ),
    _form(
        "spread_over_packages",
        "one of the nodes is in a package of its own, which the launch file and the README know",
        as_folder(_SPREAD),
        earns=ALL_BONUS - {"tests"},
    ),
    _form(
        "spread_and_not_installed",
        "the package of one node does not install it, which costs no more than in the first package",
        as_folder(
            made(
                _SPREAD,
                edit(
                    f"{_MOTORS}setup.py", "['velocity_publisher = ", "['a = b.c:main' 'velocity_publisher = "
                ),
            )
        ),
        loses={"package": Loss(1, 4, r"entry.point|comma")},
        earns=frozenset(("errors",)),
    ),
    _folder(
        "broken_package_beside",
        "another package that cannot be built is built beside the assignment's",
        _added(_OTHER_PACKAGE),
        put(
            f"{_OTHER}launch/robot.launch.xml",
            '<launch><node pkg="robot_controller" exec="status_publisher"/></launch>\n',
        ),
        put(f"{_OTHER}setup.py", "raise SystemExit('not finished')\n"),
    ),
    _folder(
        "copy_inside_itself",
        "the package holds an older copy of itself, which colcon does not see",
        _added({f"{M}{path.removeprefix(P)}": MODEL[path] for path in MODEL if path.startswith(P)}),
        put(f"{M}robot_controller/status_publisher.py", "import rclpy\n\nraise SystemExit('to do')\n"),
        drop(f"{M}test/test_nodes.py"),
    ),
    _folder(
        "unfinished_namesake",
        "beside the package lies one that nobody can build, with nodes and topics like those of the assignment",
        put(
            "src/my_robot_controller/setup.py",
            str(MODEL[SETUP]).replace("robot_controller", "my_robot_controller"),
        ),
        put(
            "src/my_robot_controller/my_robot_controller/driver.py",
            "import rclpy\n\nTOPICS = ['/robot/status', '/robot/command', '/cmd_vel']\n",
        ),
    ),
    _folder(
        "launches_what_is_not_here",
        "the launch file starts programs, too, that are not installed where it is graded",
        edit(
            LAUNCH,
            "    return LaunchDescription([\n",
            "    return LaunchDescription([\n"
            "        Node(package='robot_state_publisher', executable='robot_state_publisher'),\n"
            "        Node(package='rviz2', executable='rviz2', arguments=['-d', 'robot.rviz']),\n",
        ),
    ),
    _folder("deeper_in_src", "src has folders of its own", move(P, "src/homework/week2/robot_controller/")),
    _folder(
        "linked_package",
        "src holds a link to the package",
        move(P, "robot_controller/"),
        put("src/robot_controller", Link("../robot_controller")),
    ),
    _form(
        "loose_files",
        "three programs, no package",
        as_folder(_LOOSE, "homework"),
        earns=frozenset(("errors",)),
        loses={"workspace": Loss(8, 15, r"src|workspace|package"), "package": Loss(10, 15, r"package")},
    ),
    _folder(
        "crlf",
        "all lines end as on Windows",
        every(lambda text: text.replace("\n", "\r\n"), ".py", ".md", ".xml", ".cfg", ".yaml"),
    ),
    _folder(
        "byte_order_mark",
        "Windows' editor has put its mark before each text",
        every(lambda text: "\ufeff" + text, ".py", ".md", ".xml"),
    ),
    _folder("readme_in_utf_16", "the README is in Windows' own encoding", _utf_16),
    _folder(
        "names_not_ascii",
        "files have names in Danish, Chinese and with an emoji",
        put("noter/målinger_æøå.txt", "1, 2, 3\n"),
        put("照片/机器人.txt", "robot\n"),
        put(f"{P}docs/🤖.md", "beep\n"),
        folder="Øvelse 2",
    ),
    _folder(
        "blanks_in_path",
        "folders have blanks, brackets and quotes in their names",
        move("", "My ROS (final) work/it's a 'ws' & more/"),
        folder="hand in  2",
    ),
    _folder("case_clash", "two files differ by capitals only", put("readme.MD", "See README.md.\n")),
    _folder("readme_german", "the README is in German", put(README, _GERMAN)),
    _folder("readme_in_docs", "the README lies in docs", move(README, "docs/README.md")),
    _folder("readme_in_package", "the README lies in the package", move(README, f"{P}README.md")),
    _folder("readme_as_rst", "the README is named README.rst", move(README, "README.rst")),
    _folder(
        "rubbish",
        "files of editors and of macOS lie about",
        put(".DS_Store", b"\0\0\0\1Bud1"),
        put(f"{P}.vscode/settings.json", "{}\n"),
        put("__MACOSX/src/._robot_controller", b"\0\5\26\7"),
    ),
)

EVERYTHING = {
    "status_publisher": Loss(20, 20),
    "command_subscriber": Loss(20, 20),
    "velocity_publisher": Loss(20, 20),
    "documentation": Loss(10, 10),
}
_CREATED = made(
    MODEL,
    drop(README, LAUNCH, YAML, STATUS, COMMAND, VELOCITY, f"{P}test/test_nodes.py"),
    every(
        lambda text: (
            text[: text.index("            'status_publisher")] + text[text.index("        ],\n    },\n") :]
        ),
        "setup.py",
    ),
    every(
        lambda text: (
            text.replace(
                "Status, commands and velocity of a small robot, homework of week two.",
                "TODO: Package description",
            )
            .replace("MIT", "TODO: License declaration")
            .replace("Mira Olsen", "root")
            .replace("mira.olsen@example.org", "root@todo.todo")
        ),
        ".xml",
        "setup.py",
    ),
)

EXTREMES: tuple[Case, ...] = (
    Case(
        "extreme/empty_folder", "nothing was handed in", as_folder({}, "empty"), None, most=0, is_refused=True
    ),
    Case(
        "extreme/empty_workspace",
        "a workspace without anything in src",
        as_folder({"src/.gitkeep": "", "README.md": ""}),
        None,
        most=5,
    ),
    Case(
        "extreme/only_a_readme",
        "a README about work that was not done",
        as_folder({"README.md": PLAIN_README}),
        None,
        most=10,
    ),
    Case(
        "extreme/only_pictures",
        "no program at all",
        as_folder(
            {"screenshot.png": b"\x89PNG\r\n\x1a\n" + bytes(200), "report.pdf": b"%PDF-1.4\n"}, "homework"
        ),
        None,
        most=0,
    ),
    Case(
        "extreme/package_as_created",
        "what `ros2 pkg create` writes, untouched: it builds, and no more",
        as_folder(_CREATED),
        EVERYTHING | {"package": Loss(4, 13, r"TODO|entry|executable")},
        lacks=ALL_BONUS,
    ),
    Case(
        "extreme/not_an_archive",
        "a text that is named .zip",
        lambda folder, _: _one_file(folder, "work.zip", b"my homework\n"),
        None,
        most=0,
        is_refused=True,
    ),
    Case(
        "extreme/empty_file",
        "a zip of no bytes",
        lambda folder, _: _one_file(folder, "work.zip", b""),
        None,
        most=0,
        is_refused=True,
    ),
    Case(
        "extreme/broken_zip",
        "the second half of the upload is missing",
        lambda folder, _: _one_file(folder, "work.zip", _half(zip_bytes(MODEL, {}))),
        None,
        most=0,
        is_refused=True,
    ),
    Case(
        "extreme/missing",
        "a path where nothing is",
        lambda folder, _: folder / "nowhere.zip",
        None,
        most=0,
        is_refused=True,
    ),
)


def _one_file(folder: Path, name: str, data: bytes) -> Path:
    (folder / name).write_bytes(data)
    return folder / name


def _half(data: bytes) -> bytes:
    return data[: len(data) // 2]
