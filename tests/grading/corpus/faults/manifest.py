"""Faults of package.xml."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import fault
from corpus.package import XML
from corpus.tree import drop, edit, put


def _xml(
    name: str, old: str, new: str, cause: str, about: str, *, most: float = 8, builds: bool = True
) -> Case:
    change = edit(XML, old, new)
    return fault("package", f"xml_{name}", change, cause, about, most=most, builds=builds)


_INVALID = r"manifest-invalid|package\.xml"

MANIFEST: tuple[Case, ...] = (
    fault(
        "package",
        "xml_missing",
        drop(XML),
        r"package\.xml",
        "without package.xml it is no ROS package",
        builds=False,
    ),
    fault("package", "xml_empty", put(XML, ""), _INVALID, "an empty file is no XML"),
    fault("package", "xml_is_a_word", put(XML, "robot_controller\n"), _INVALID, "a word is no XML"),
    _xml(
        "tag_not_closed",
        "<license>MIT</license>",
        "<license>MIT",
        _INVALID,
        "the XML is not well formed",
        most=12,
    ),
    _xml(
        "ampersand",
        "Status, commands and",
        "Status & commands and",
        _INVALID,
        "& must be written &amp;",
        most=12,
    ),
    _xml(
        "closed_twice",
        "</package>\n",
        "</package>\n</package>\n",
        _INVALID,
        "the XML is not well formed",
        most=12,
    ),
    _xml("no_name", "  <name>robot_controller</name>\n", "", _INVALID, "a package needs a name", most=12),
    _xml(
        "other_name",
        "<name>robot_controller<",
        "<name>robot_control<",
        r"name|marker|robot_control\b",
        "package.xml and setup.py give two names",
        most=12,
    ),
    _xml(
        "name_with_blank",
        "<name>robot_controller<",
        "<name>robot controller<",
        r"manifest-invalid|name",
        "a package's name has no blanks",
        most=12,
    ),
    _xml(
        "short_version",
        "<version>0.1.0<",
        "<version>1<",
        r"manifest-invalid|version",
        "a version has three numbers",
        most=12,
    ),
    _xml(
        "no_version",
        "  <version>0.1.0</version>\n",
        "",
        r"manifest-invalid|version",
        "a version is required",
        most=12,
    ),
    _xml(
        "no_email",
        ' email="mira.olsen@example.org"',
        "",
        r"manifest-invalid|e-?mail",
        "a maintainer has an e-mail address",
        most=12,
    ),
    _xml(
        "no_maintainer",
        '  <maintainer email="mira.olsen@example.org">Mira Olsen</maintainer>\n',
        "",
        r"manifest-invalid|maintainer",
        "a maintainer is required",
        most=12,
    ),
    _xml(
        "no_license",
        "  <license>MIT</license>\n",
        "",
        r"manifest-invalid|licen[sc]e",
        "a licence is required",
        most=12,
    ),
    _xml(
        "todo_description",
        "Status, commands and velocity of a small robot, homework of week two.",
        "TODO: Package description",
        r"TODO|description",
        "the description was never written",
        most=4,
    ),
    _xml(
        "name_for_description",
        "Status, commands and velocity of a small robot, homework of week two.",
        "The robot controller.",
        r"description",
        "the description tells nothing beyond the name",
        most=4,
    ),
    _xml(
        "todo_license",
        ">MIT<",
        ">TODO: License declaration<",
        r"TODO|licen[sc]e",
        "the licence was never chosen",
        most=4,
    ),
    _xml(
        "todo_maintainer",
        'email="mira.olsen@example.org">Mira Olsen',
        'email="root@todo.todo">root',
        r"TODO|maintainer",
        "the maintainer's address was never written",
        most=4,
    ),
    _xml(
        "build_type_misspelt",
        ">ament_python<",
        ">ament_pyton<",
        r"build-type|build.type|ament_pyton",
        "colcon has no such build type and builds nothing",
        most=15,
        builds=False,
    ),
    _xml(
        "build_type_cmake",
        ">ament_python<",
        ">ament_cmake<",
        r"build-type|build.type|cmake",
        "there is no CMakeLists.txt",
        most=15,
    ),
    _xml(
        "no_export",
        "  <export>\n    <build_type>ament_python</build_type>\n  </export>\n",
        "",
        r"build-type|build.type|export",
        "without a build type colcon takes it for catkin",
        most=15,
        builds=False,
    ),
    _xml("rclpy_undeclared", "  <depend>rclpy</depend>\n", "", r"rclpy", "the nodes import rclpy"),
    _xml(
        "std_msgs_undeclared", "  <depend>std_msgs</depend>\n", "", r"std_msgs", "the nodes import std_msgs"
    ),
    _xml(
        "geometry_msgs_undeclared",
        "  <depend>geometry_msgs</depend>\n",
        "",
        r"geometry_msgs",
        "the nodes import geometry_msgs",
    ),
    _xml(
        "std_msgs_misspelt",
        "<depend>std_msgs<",
        "<depend>std_msg<",
        r"std_msgs?",
        "there is no package std_msg",
    ),
    _xml(
        "geometry_msgs_misspelt",
        "<depend>geometry_msgs<",
        "<depend>geometry-msgs<",
        r"geometry.msgs",
        "the name has an underscore",
    ),
    _xml("rospy_for_rclpy", "<depend>rclpy<", "<depend>rospy<", r"rclpy|rospy", "rospy is of ROS 1"),
    _xml(
        "python_module_declared",
        "  <depend>rclpy</depend>\n",
        "  <depend>rclpy</depend>\n  <depend>math</depend>\n",
        r"math",
        "math is a module of Python, and rosdep does not know it",
        most=4,
    ),
    _xml(
        "only_for_tests",
        "<depend>geometry_msgs</depend>",
        "<test_depend>geometry_msgs</test_depend>",
        r"geometry_msgs",
        "it is needed at run time, not only by tests",
    ),
    _xml(
        "commented_out",
        "  <depend>std_msgs</depend>\n",
        "  <!-- <depend>std_msgs</depend> -->\n",
        r"std_msgs",
        "what stands in a comment is not declared",
    ),
    _xml(
        "all_undeclared",
        "  <depend>rclpy</depend>\n  <depend>std_msgs</depend>\n  <depend>geometry_msgs</depend>\n",
        "",
        r"rclpy|std_msgs|geometry_msgs",
        "nothing of what it needs is declared",
        most=10,
    ),
    _xml(
        "run_depend",
        "<depend>std_msgs</depend>",
        "<run_depend>std_msgs</run_depend>",
        r"manifest-invalid|run_depend|std_msgs",
        "run_depend is of format 1",
        most=12,
    ),
)
