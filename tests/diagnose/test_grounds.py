"""What is told of topics, services and packages only if everything that it depends on was seen."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import CFG, MANIFEST, SETUP

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.look import Look

NODE = """\
import rclpy
from rclpy.node import Node
{imports}

class Demo(Node):
    def __init__(self):
        super().__init__({name!r})
        {made}

    def got(self, msg):
        self.get_logger().info(str(msg))

    def serve(self, request, response):
        return response


def main():
    rclpy.init()
    rclpy.spin(Demo())
"""
LAUNCH = """\
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([{nodes}])
"""
FIRST, SECOND = "example_interfaces.msg.String", "std_msgs.msg.String"
CODES = frozenset(("topic-type", "topic-near-miss", "qos-mismatch"))


def node(made: str, *types: str, name: str = "demo") -> str:
    imports = "".join(f"from {kind.rpartition('.')[0]} import {kind.rpartition('.')[2]}\n" for kind in types)
    return NODE.format(imports=imports, made=made, name=name)


def end(kind: str, topic: str, *, is_publisher: bool) -> str:
    short = kind.rpartition(".")[2]
    return (
        f"self.pub = self.create_publisher({short}, {topic!r}, 10)"
        if is_publisher
        else f"self.create_subscription({short}, {topic!r}, self.got, 10)"
    )


def pub(kind: str, topic: str, name: str = "demo") -> str:
    return node(end(kind, topic, is_publisher=True), kind, name=name)


def sub(kind: str, topic: str, name: str = "demo") -> str:
    return node(end(kind, topic, is_publisher=False), kind, name=name)


def package(name: str, modules: dict[str, str], more: dict[str, str] | None = None) -> dict[str, str]:
    """Return the files of a package with a program for each module, and more of its files."""
    rows = "".join(f"            '{module} = {name}.{module}:main',\n" for module in modules)
    begin, _, rest = SETUP.partition("            'MODULE")
    setup = f"{begin}{rows}        ],{rest.partition('        ],')[2]}"
    files = {
        "setup.py": setup,
        "setup.cfg": CFG,
        "package.xml": MANIFEST,
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        **{f"{name}/{module}.py": text for module, text in modules.items()},
        **(more or {}),
    }
    return {f"src/{name}/{path}": text.replace("PACKAGE", name) for path, text in files.items()}


def found_in(folder: Path, *packages: dict[str, str]) -> list[Finding]:
    for path, text in (item for files in packages for item in files.items()):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    return Look(folder, loads=True).findings


def told(folder: Path, *packages: dict[str, str]) -> list[str]:
    return [finding.code for finding in found_in(folder, *packages) if finding.code in CODES]


CPP = {"cpp/talk.cpp": 'node->create_publisher<T>("number", 10);\nnode->create_service<S>("yang", serve);\n'}
BRIDGE = {"config/bridge.yaml": "- ros_topic_name: /number\n"}


@pytest.mark.parametrize(
    "packages",
    [
        [package("a", {"talk": pub(FIRST, "robot_news"), "hear": sub(FIRST, "robot_news")})],
        [
            package("a", {"talk": pub(FIRST, "number"), "hear": sub(FIRST, "number")}),
            package("b", {"talk": pub(SECOND, "number"), "hear": sub(SECOND, "number")}),
        ],
        [package("a", {"talk": pub(FIRST, "number")}), package("b", {"talk": pub(SECOND, "number")})],
        [
            package("a", {"talk": pub(FIRST, "number"), "hear": sub(FIRST, "number")}),
            package("b", {"talk": pub(SECOND, "number")}),
        ],
        [
            package("a", {"talk": pub(FIRST, "number")}),
            package("b", {"hear": sub(SECOND, "number")}),
            package("c", {"hear": sub(SECOND, "number")}),
        ],
        [package("a", {"talk": pub(FIRST, "robot_news")})],
        [package("a", {"talk": pub(FIRST, "number"), "hear": sub(SECOND, "number")}, CPP)],
        [package("a", {"talk": pub(FIRST, "number"), "hear": sub(SECOND, "number")}, BRIDGE)],
        [package("a", {"talk": pub(FIRST, "wheel_l/speed"), "hear": sub(FIRST, "wheel_r/speed")})],
        [package("a", {"talk": pub(FIRST, "numbers"), "hear": sub(SECOND, "number")})],
        [package("a", {"talk": pub(FIRST, "numbers"), "hear": sub(FIRST, "number")}, CPP)],
    ],
)
def test_an_end_that_has_or_may_have_a_partner_is_not_told(
    tmp_path: Path, packages: list[dict[str, str]]
) -> None:
    assert not told(tmp_path, *packages)


SLOW = "self.pub = self.create_publisher(String, '/robot/status', 10); self.create_timer(1.0, self.tick)"
TICK = "\n    def tick(self):\n        self.pub.publish(String(data='on'))\n\n    def got"
STATUS = node(SLOW, SECOND).replace("\n    def got", TICK, 1)
NEAR = pub(SECOND, "robot_status")


@pytest.mark.parametrize(
    ("modules", "wanted"),
    [
        ({"robot_controller": {"talk": NEAR}}, ["topic-near-miss src/robot_controller"]),
        ({"robot_controller": {"talk": STATUS}}, ["period src/robot_controller"]),
        ({"bot": {"talk": STATUS, "hear": sub(SECOND, "robot/command")}}, ["period src/bot"]),
        ({"my_robot_controller": {"talk": pub(SECOND, "robot_new")}}, ["topic-near-miss src/my_robot_controller"]),
        ({"arm": {"talk": NEAR}, "robot_controller": {"talk": NEAR}}, ["topic-near-miss src/robot_controller"]),
        ({"robot_controller": {"tell": pub(FIRST, "number")}, "arm": {"talk": STATUS}}, []),
        ({"brain": {"talk": NEAR, "drive": pub("geometry_msgs.msg.Twist", "cmd_vel")}}, []),
        ({"my_status": {"talk": STATUS}}, []),
        ({"my_status": {"hear": sub(SECOND, "robot_command")}}, []),
        ({"news": {"talk": pub(SECOND, "robot_new")}}, []),
        ({"wall": {"drive": pub("geometry_msgs.msg.Twist", "cmd_vell")}}, []),
    ],
)  # fmt: skip
def test_the_course_asks_only_of_its_own_packages(
    tmp_path: Path, modules: dict[str, dict[str, str]], wanted: list[str]
) -> None:
    found = found_in(tmp_path, *(package(name, texts) for name, texts in modules.items()))
    told_of = [
        f"{one.code} {'/'.join(one.place.split('/')[:2])}" for one in found if one.code in (*CODES, "period")
    ]
    assert told_of == wanted


TOGETHER = {
    "launch/both.launch.py": LAUNCH.format(
        nodes="Node(package='a', executable='talk'), Node(package='b', executable='hear')"
    )
}


@pytest.mark.parametrize(
    ("packages", "code"),
    [
        ([package("a", {"talk": pub(FIRST, "number"), "hear": sub(SECOND, "number")})], "topic-type"),
        ([package("my_robot_controller", {"talk": pub(FIRST, "robot_news")})], "topic-type"),
        (
            [package("a", {"talk": pub(FIRST, "number")}), package("b", {"hear": sub(SECOND, "number")})],
            "topic-type",
        ),
        (
            [
                package("a", {"talk": pub(FIRST, "number")}),
                package("b", {"hear": sub(SECOND, "number")}, TOGETHER),
            ],
            "topic-type",
        ),
        (
            [package("a", {"talk": pub(FIRST, "number")}), package("b", {"hear": sub(FIRST, "nunber")})],
            "topic-near-miss",
        ),
    ],
)
def test_an_end_without_a_partner_is_told(tmp_path: Path, packages: list[dict[str, str]], code: str) -> None:
    assert set(told(tmp_path, *packages)) == {code}


@pytest.mark.parametrize(
    ("spaces", "is_told"), [(("alpha", "beta"), False), (("alpha", "alpha"), True), ((None, None), True)]
)
def test_the_namespaces_of_two_nodes(
    tmp_path: Path, spaces: tuple[str | None, str | None], is_told: bool
) -> None:
    nodes = {"talk": pub(FIRST, "number", "a"), "hear": sub(SECOND, "number", "b")}
    for (module, text), space in zip([*nodes.items()], spaces, strict=True):
        given = f", namespace={space!r})" if space else ")"
        nodes[module] = text.replace("')\n        self", f"'{given}\n        self")
    assert bool(told(tmp_path, package("a", nodes))) == is_told


CLIENT = "self.cli = self.create_client(Trigger, '{}')"
SERVER = "self.create_service(Trigger, '{}', self.serve)"
TRIGGER = "std_srvs.srv.Trigger"


@pytest.mark.parametrize(
    ("modules", "more", "is_told"),
    [
        ({"a": node(CLIENT.format("start"), TRIGGER), "b": node(SERVER.format("strat"), TRIGGER)}, {}, True),
        ({"a": node(CLIENT.format("yang"), TRIGGER), "b": node(SERVER.format("yan_g"), TRIGGER)}, CPP, False),
        (
            {"a": node(f"{CLIENT.format('l/open')}\n        {SERVER.format('r/open')}", TRIGGER)},
            {},
            False,
        ),
        (
            {"a": node(f"{CLIENT.format('start')}\n        {SERVER.format('strat')}", TRIGGER)},
            {},
            False,
        ),
    ],
)
def test_a_server_that_is_meant(
    tmp_path: Path, modules: dict[str, str], more: dict[str, str], is_told: bool
) -> None:
    assert bool(told(tmp_path, package("pk", modules, more))) == is_told


BUILD_TYPE = "<build_type>ament_python</build_type>"
CMAKE = "cmake_minimum_required(VERSION 3.8)\nproject(a)\n{}ament_package()\n"


@pytest.mark.parametrize("kind", ["ament_cmake", ""])
@pytest.mark.parametrize(
    ("installs", "codes"),
    [
        ("install(PROGRAMS a/talk.py DESTINATION lib/a)\n", []),
        ("install(DIRECTORY a/ DESTINATION lib/a)\n", []),
        ("ament_python_install_package(a)\n", []),
        ("install(DIRECTORY launch DESTINATION share/a)\n", ["build-type-cmake"]),
    ],
)
def test_a_setup_script_that_cmake_does_not_read(
    tmp_path: Path, installs: str, codes: list[str], kind: str
) -> None:
    """Without a build type, colcon takes a package for one of catkin, and so builds it with CMake as well."""
    files = package("a", {"talk": pub(SECOND, "x")}, {"CMakeLists.txt": CMAKE.format(installs)})
    files["src/a/setup.py"] = files["src/a/setup.py"].replace("talk:main',", "talk:main'\n 'b = a.b:main'")
    written = f"<build_type>{kind}</build_type>" if kind else "<rviz/>"
    files["src/a/package.xml"] = files["src/a/package.xml"].replace(BUILD_TYPE, written)
    del files["src/a/setup.cfg"]
    kinds = ("build-", "entry-", "marker-", "not-in", "package-", "setup-")
    found = [finding for finding in found_in(tmp_path, files) if finding.code.startswith(kinds)]
    assert [finding.code for finding in found] == codes


@pytest.mark.parametrize(
    ("installs", "executable", "fix"),
    [
        ("install(PROGRAMS a/talk.py DESTINATION lib/a)\n", "talk", "write talk.py instead of talk"),
        ("install(PROGRAMS\n  ${CMAKE_CURRENT_SOURCE_DIR}/a/talk.py\n  DESTINATION lib/${PROJECT_NAME})\n", "talk", "write talk.py instead of talk"),
        ("install(PROGRAMS a/talk.py DESTINATION lib/a)\n", "talk.py", ""),
        ("install(PROGRAMS a/talk.py DESTINATION lib/a RENAME talk)\n", "talk", ""),
        ("add_executable(talk talk.cpp)\ninstall(PROGRAMS a/talk.py DESTINATION lib/a)\n", "talk", ""),
        ("# install(PROGRAMS a/talk.py DESTINATION lib/a)\ninstall(DIRECTORY a/ DESTINATION lib/a)\n", "talk", ""),
    ],
)  # fmt: skip
def test_a_script_is_installed_under_the_name_of_its_file(
    tmp_path: Path, installs: str, executable: str, fix: str
) -> None:
    files = package("a", {"talk": pub(SECOND, "x")}, {"CMakeLists.txt": CMAKE.format(installs)})
    files["src/a/package.xml"] = files["src/a/package.xml"].replace("ament_python", "ament_cmake")
    files["src/a/launch/a.launch.py"] = LAUNCH.format(nodes=f"Node(package='a', executable={executable!r})")
    found = [finding.fix for finding in found_in(tmp_path, files) if finding.code == "launch-executable"]
    assert found == [fix] * bool(fix)


@pytest.mark.parametrize(
    ("executable", "fix"),
    [("talk", ""), ("talc", "write talk instead of talc"), ("talk.py", "write talk instead of talk.py")],
)
@pytest.mark.parametrize("twin", ["0", "z"])
def test_of_packages_with_one_name_a_launch_file_means_its_own(
    tmp_path: Path, twin: str, executable: str, fix: str
) -> None:
    own = package("a", {"talk": pub(SECOND, "x")})
    made = package("a", {"talk": pub(SECOND, "x")}, {"CMakeLists.txt": CMAKE.format("install(PROGRAMS a/talk.py DESTINATION lib/a)\n")})  # fmt: skip
    other = {path.replace("src/a/", f"src/{twin}/", 1): text for path, text in made.items()}
    other[f"src/{twin}/package.xml"] = own["src/a/package.xml"].replace("ament_python", "ament_cmake")
    launch = LAUNCH.format(nodes=f"Node(package='a', executable={executable!r})")
    third = package("b", {"hear": sub(SECOND, "x")}, {"launch/b.launch.py": launch})
    own["src/a/launch/a.launch.py"] = launch
    found = [one for one in found_in(tmp_path, own, other, third) if one.code == "launch-executable"]
    assert [(one.place, one.fix) for one in found] == [("src/a/launch/a.launch.py:6", fix)] * bool(fix)


TWIST = "geometry_msgs.msg.Twist"
WAYS = "; or, if each type is right, give one of the two topics another name"


@pytest.mark.parametrize(
    ("topic", "hears", "reads", "fix"),
    [
        ("x", "String()", "msg", f"write String, with `from std_msgs.msg import String`, and change where a Twist is made, too{WAYS}"),
        ("x", "", "msg.data", f"write Twist, with `from geometry_msgs.msg import Twist`, and change the callback, which reads data, too{WAYS}"),
        ("x", "", "msg.linear", "write Twist, with `from geometry_msgs.msg import Twist`"),
        ("x", "", "msg", "write Twist, with `from geometry_msgs.msg import Twist`"),
        ("cmd_vel", "", "msg.data", "write Twist, with `from geometry_msgs.msg import Twist`, and change the callback, which reads data, too"),
    ],
)  # fmt: skip
def test_what_is_written_for_the_old_type_changes_with_it(
    tmp_path: Path, topic: str, hears: str, reads: str, fix: str
) -> None:
    talk = node(f"{end(TWIST, topic, is_publisher=True)}\n        self.pub.publish(Twist())", TWIST)
    hear = node(f"{end(SECOND, topic, is_publisher=False)}\n        {hears}", SECOND)
    name = "robot_controller" if topic == "cmd_vel" else "a"
    hear = hear.replace("str(msg)", f"str({reads})")
    found = found_in(tmp_path, package(name, {"talk": talk, "hear": hear}))
    (one,) = (one for one in found if one.code == "topic-type")
    assert one.place.startswith(f"src/{name}/{name}/{'talk' if hears else 'hear'}.py:")
    assert one.fix == fix


@pytest.mark.parametrize(
    ("name", "declared", "meant"),
    [
        ("rosbot_localization", "robot_localization", ""),
        ("nav_bringup", "nav2_bringup", ""),
        ("talker", "uav_msgs", ""),
        ("talker", "sqlite3", ""),
        ("talker", "rclpyy", "rclpy"),
        ("talker", "exmaple_interfaces", "example_interfaces"),
        ("talker", "math", "remove"),
        ("talker", "rclpy_action", "remove this line: rclpy is declared as well"),
        ("talker", "std_srvs_srv", "write std_srvs instead of std_srvs_srv"),
        ("talker", "rclpy_message_converter", ""),
        ("talker", "numpy", ""),
        ("talker", "lz4", ""),
    ],
)
def test_a_declared_name_that_is_not_known(tmp_path: Path, name: str, declared: str, meant: str) -> None:
    files = package(name, {"talk": pub(SECOND, "x")})
    path = f"src/{name}/package.xml"
    files[path] = files[path].replace(
        "  <depend>rclpy<", f"  <exec_depend>{declared}</exec_depend>\n  <depend>rclpy<"
    )
    codes = ("dependency-unknown", "dependency-not-ros")
    found = [finding for finding in found_in(tmp_path, files) if finding.code in codes]
    assert [meant in finding.fix for finding in found] == [True] * bool(meant)


@pytest.mark.parametrize(
    ("module", "tags", "fix"),
    [
        ("numpy", ["numpy"], "write python3-numpy instead of numpy"),
        ("cv2", ["cv2"], "write python3-opencv instead of cv2"),
        ("cv2", ["cv2", "python3-opencv"], "remove this line: python3-opencv is declared as well"),
        ("psutil", ["psutil"], "remove the line with psutil, or write rosdep's name for it"),
        ("nothing_like_it", ["nothing_like_it"], ""),
        ("std_srvs", ["std_srvs"], ""),
        ("numpy", ["python3-numpy"], ""),
    ],
)
def test_a_module_that_is_declared_by_its_own_name(
    tmp_path: Path, module: str, tags: list[str], fix: str
) -> None:
    files = package("a", {"talk": f"import {module}\n{pub(SECOND, 'x')}\n\nprint({module})\n"})
    rows = "".join(f"  <exec_depend>{tag}</exec_depend>\n" for tag in tags)
    files["src/a/package.xml"] = files["src/a/package.xml"].replace("  <export>", f"{rows}  <export>")
    found = [finding.fix for finding in found_in(tmp_path, files) if finding.code == "dependency-key"]
    assert found == [fix] * bool(fix)


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("examples_interfaces.msg", "write `<depend>example_interfaces</depend>`"),
        ("geometry_msg.msg.Twist", "write `<depend>geometry_msgs</depend>`"),
        ("libgstreamer1.0-dev", ""),
        ("my_own.msg", ""),
    ],
)
def test_a_misspelt_package_with_a_module_behind_it(tmp_path: Path, written: str, fix: str) -> None:
    files = package("a", {"talk": pub(SECOND, "x")})
    text = files["src/a/package.xml"].replace("  <depend>geometry_msgs</depend>\n", "")
    files["src/a/package.xml"] = text.replace("  <export>", f"  <depend>{written}</depend>\n  <export>")
    found = [finding.fix for finding in found_in(tmp_path, files) if finding.code == "dependency-joined"]
    assert found == [fix] * bool(fix)


def test_a_package_that_a_launch_file_keeps_in_a_variable(tmp_path: Path) -> None:
    launch = LAUNCH.format(nodes="Node(package=package_, executable='talk')")
    launch = launch.replace("    return", "    package_ = 'catch_the_turtle_cpp'\n    return")
    other = package("catch_the_turtle_cpp", {"talk": pub(SECOND, "y")})
    files = package("a", {"talk": pub(SECOND, "x")}, {"launch/a.launch.py": launch})
    manifest = files["src/a/package.xml"]
    for declared, code in (("catch_the_turtles_cpp", "dependency-unknown"), ("rviz2", "dependency-launched")):
        tag = f"  <exec_depend>{declared}</exec_depend>\n  <export>"
        files["src/a/package.xml"] = manifest.replace("  <export>", tag)
        found = [one for one in found_in(tmp_path, files, other) if one.code.startswith("dependency-")]
        assert [one.code for one in found] == [code]
        assert "catch_the_turtle_cpp" in found[0].fix


ROWS = "            'talk = a.talk:main',\n"


@pytest.mark.parametrize(
    ("rows", "fix"),
    [
        ("'talk = a.talk:main'  # the first\n 'hear = a.hear:main',\n", "`'talk = a.talk:main',`"),
        (
            "'talk = a.talk:main'\n # and\n 'hear = a.hear:main'\n\n 'x = a.hear:main'\n",
            "`'talk = a.talk:main',` on line 25 and `'hear = a.hear:main',` on line 27",
        ),
        (
            "'talk = ' + package_name + '.talk:main'\n 'hear = a.hear:main'\n",
            "`'talk = ' + package_name + '.talk:main',`",
        ),
        ("'talk = a\" 5.talk:main'\n 'hear = a\" 5.hear:main'\n", "`'talk = a.talk:main',`"),
        ("'talk = a.talk:main, hear = a.hear:main'\n", "'talk = a.talk:main', 'hear = a.hear:main'"),
        ("'talk = '\n 'a.talk:main', 'hear = a.hear:main'\n", ""),
        ("'talk == a.talk:main', 'hear = a.hear:main'\n", ""),
    ],
)
def test_a_comma_is_missing_where_a_string_ends(tmp_path: Path, rows: str, fix: str) -> None:
    files = package("a", {"talk": pub(SECOND, "x"), "hear": sub(SECOND, "x")})
    setup = files["src/a/setup.py"].replace("            'hear = a.hear:main',\n", "").replace(ROWS, rows)
    files["src/a/setup.py"] = setup
    found = [finding for finding in found_in(tmp_path, files) if finding.code == "entry-point-comma"]
    assert [finding.fix for finding in found] == [f"write {fix}"] * bool(fix)


def test_a_program_without_an_entry_point(tmp_path: Path) -> None:
    launch = LAUNCH.format(nodes="Node(package='a', executable='hear')")
    files = package(
        "a", {"talk": pub(SECOND, "x")}, {"launch/a.launch.py": launch, "a/hear.py": sub(SECOND, "x")}
    )
    (found,) = (finding for finding in found_in(tmp_path, files) if finding.code == "launch-executable")
    assert found.fix.startswith("write `'hear = a.hear:main',` as the first entry point")


@pytest.mark.parametrize(("is_twice", "fix"), [(True, "remove this line"), (False, "move this line")])
def test_a_dependency_inside_export(tmp_path: Path, is_twice: bool, fix: str) -> None:
    files, element = package("a", {"talk": pub(SECOND, "x")}), "<exec_depend>turtlesim</exec_depend>"
    text = files["src/a/package.xml"].replace("  <export>\n", f"  <export>\n    {element}\n")
    if is_twice:
        text = text.replace("  <depend>rclpy", f"  {element}\n  <depend>rclpy")
    files["src/a/package.xml"] = text
    (found,) = (finding for finding in found_in(tmp_path, files) if finding.code == "dependency-joined")
    assert found.fix.startswith(fix)
    assert element in text.splitlines()[int(found.place.rpartition(":")[2]) - 1]
    assert int(found.place.rpartition(":")[2]) > text[: text.index("<export>")].count("\n")
