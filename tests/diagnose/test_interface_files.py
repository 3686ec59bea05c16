"""Interface files that the generator refuses are told where they are, with a line that it takes."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.finding import Finding

CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(shapes)
find_package(ament_cmake REQUIRED)
find_package(geometry_msgs REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME}
  NAMES
  DEPENDENCIES geometry_msgs
)
ament_package()
"""
MANIFEST = """\
<package format="3">
  <name>shapes</name>
  <version>0.1.0</version>
  <description>Messages</description>
  <maintainer email="a@example.org">A</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <depend>geometry_msgs</depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
READER = "from shapes.msg import Box\n\n\ndef area(box: Box) -> float:\n    return box.sideLength**2\n"


def _found(root: Path, files: dict[str, str], cmake: str = "") -> list[Finding]:
    """Return what is told of a package with interface files, beside one with Python files."""
    folder = Files.right(NAMES[1]).put("PACKAGE/area.py", READER).write(root) / "src" / "shapes"
    names = " ".join(f'"{name}"' for name in files)
    for name, text in {"package.xml": MANIFEST, "CMakeLists.txt": cmake or CMAKE, **files}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text.replace("NAMES", names))
    return [f for f in of_workspace(root) if f.code in ("interface-refused", "import-wrong")]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("int32 batteryLevel", "`int32 battery_level`"),
        ("string name_", "`string name`"),
        ("string 2nd", "give the field another name"),
        ("float64 x;", "`float64 x`"),
        ("float64 my name", "`float64 my_name`"),
        ("float64 x, y", "each field on a line of its own"),
        (" int32 x", "`int32 x`"),
        ("int32 max=5", "`int32 MAX=5` or `int32 max 5`"),
        ("int32 MAX=abc", "a value of this type"),
        ("float64[] sizes = [1.0]", "`float64[] sizes [1.0]`"),
        ("float32[0] a", "`float32[] a`"),
        ("float x", "`float32 x` or `float64 x`"),
        ("double x", "`float64 x`"),
        ("int x", "`int32 x`"),
        ("str name", "`string name`"),
        ("name string", "`string name`"),
        ("x: float64", "`float64 x`"),
        ("point p", "`geometry_msgs/Point p`"),
        ("geometry_msgs/msg/Point p", "`geometry_msgs/Point p`"),
        ("geometry_msgs.Point p", "`geometry_msgs/Point p`"),
        ("geometry_msgs/Pont p", "geometry_msgs/Point instead of geometry_msgs/Pont"),
        ("geometry_msg/Point p", "geometry_msgs/Point instead of geometry_msg/Point"),
        ("Header header", "std_msgs/Header instead of Header"),
        ("Strng name", "string instead of Strng"),
        ("Shape shape", "create msg/Shape.msg"),
        ("speed", "write a type and a name"),
        ("// the width", "`# the width`"),
        ("int32 x // in meters", "`int32 x # in meters`"),
        ("---", "remove this line"),
        ("int32 x\nint32 x", "another name"),
        ("string[] names ['a']", ""),
        ("int32 x 5", ""),
        ("string<=5 short", ""),
        ("geometry_msgs/Point[2] ends", ""),
        ("Wheel wheel # a message of this package", ""),
        ("robot_parts/Arm arm", ""),
        ("# only a comment\n\nint32 MAX=3", ""),
    ],
)
def test_a_line_of_a_message(tmp_path: Path, line: str, fix: str) -> None:
    cmake = CMAKE.replace("DEPENDENCIES", "DEPENDENCIES robot_parts")
    found = _found(tmp_path, {"msg/Car.msg": f"{line}\n", "msg/Wheel.msg": "float64 radius\n"}, cmake)
    assert [fix in one.fix for one in found] == [True] * bool(fix), found
    assert all(one.place == f"src/shapes/msg/Car.msg:{line.count(chr(10)) + 1}" for one in found)


@pytest.mark.parametrize(
    ("name", "text", "place", "fix"),
    [
        ("srv/Go.srv", "int32 x\n", "", "write --- alone on a line"),
        ("srv/Go.srv", "int32 x\n----\nbool ok\n", ":2", "exactly ---"),
        ("srv/Go.srv", "int32 x\n--- \nbool ok\n", ":2", "exactly ---"),
        ("srv/Go.srv", "int32 x\n---\nbool ok\n---\nbool far\n", ":4", "remove the ---"),
        ("action/Go.action", "int32 x\n---\nbool ok\n", "", "--- twice"),
        ("srv/Go.srv", "int32 x\nint32 x\n---\n", ":2", "another name"),
        ("srv/go.srv", "---\n", "", "mv src/shapes/srv/go.srv src/shapes/srv/Go.srv"),
        ("msg/Car_state.msg", "int32 x\n", "", "src/shapes/msg/CarState.msg"),
        ("srv/Go.srv", "---\n", None, ""),
        ("srv/Go.srv", "int32 x\n---\nint32 x\n", None, ""),
        ("action/Go.action", "---\n---\n", None, ""),
    ],
)
def test_parts_and_names(tmp_path: Path, name: str, text: str, place: str | None, fix: str) -> None:
    found = [(one.place, fix in one.fix) for one in _found(tmp_path, {name: text})]
    assert found == ([] if place is None else [(f"src/shapes/{name}{place}", True)])


@pytest.mark.parametrize(
    ("files", "old", "new", "fix"),
    [
        ({"msg/Box.msg": "Side a\n", "msg/Side.msg": "float64 a\n"}, ' "msg/Side.msg"', "", 'add "msg/Side.msg"'),
        ({"msg/Box.msg": "", "msg/Side.msg": ""}, '"msg/Box.msg"', "", 'add "msg/Box.msg"'),
        ({"msg/Box.msg": "geometry_msgs/Point a\n"}, "DEPENDENCIES geometry_msgs\n", "\n", "write DEPENDENCIES geometry_msgs"),
        ({"msg/Box.msg": "std_msgs/Header a\n"}, "", "", ""),  # geometry_msgs, which is named, brings it along
        ({"action/Go.action": "builtin_interfaces/Duration a\n---\n---\n"}, "DEPENDENCIES geometry_msgs\n", "\n", ""),
        ({"msg/Box.msg": "", "msg/Side.msg": ""}, ' "msg/Side.msg"', "", ""),
        ({"msg/Box.msg": "", "msg/Side.msg": ""}, '"msg/Box.msg"', "${FILES}", ""),
    ],
)  # fmt: skip
def test_what_cmake_hands_over(tmp_path: Path, files: dict[str, str], old: str, new: str, fix: str) -> None:
    names = " ".join(f'"{name}"' for name in files)
    found = _found(tmp_path, files, CMAKE.replace("NAMES", names).replace(old, new))
    assert [fix in one.fix for one in found] == [True] * bool(fix), found


SAID = """\
Error processing 'float64 sideLength' of 'shapes/Box':
''sideLength' is an invalid field name.  It should have the pattern
'^(?!.*__)(?!.*_$)[a-z][a-z0-9_]*$''
NameError: 'sideLength' is an invalid field name.  It should have the pattern
"""


@pytest.mark.parametrize("said", [SAID, "".join(SAID.splitlines(keepends=True)[:3]), SAID.splitlines()[-1]])
def test_what_the_generator_says_names_the_line(tmp_path: Path, said: str) -> None:
    _found(tmp_path, {"msg/Box.msg": "float64 sideLength\n"})
    found = of_text(said, tmp_path)[0]
    assert found.place == "src/shapes/msg/Box.msg:1"
    assert found.fix.startswith("write `float64 side_length`, and side_length in src/")
