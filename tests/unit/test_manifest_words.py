"""What is said of a package.xml that is not valid."""

from __future__ import annotations

import pytest
from catkin_pkg.package import InvalidPackage, parse_package_string

from ros2lab.manifest_words import fault_of


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "<package>\n  <depend>rclpy</exec_depend>\n</package>",
            ": <depend> is not closed before </exec_depend>",
        ),
        ("<package>\n  <depend>rclpy\n</package>", ": <depend> is not closed before </package>"),
        ("<package>\n  <depend>rclpy<depend>\n</package>", ": <depend> is not closed before </package>"),
        ("<package>\n  <a>ü</b>\n</package>", ": <a> is not closed before </b>"),
        ("<package>\n  <name>a & b</name>\n</package>", "not well-formed"),
        ("<package>\n  <name>a</name>", "no element found"),
        ("", "no element found"),
    ],
)
def test_the_tags_that_do_not_fit_are_named(text: str, said: str) -> None:
    with pytest.raises(InvalidPackage) as caught:
        parse_package_string(text)
    assert said in fault_of(caught.value, text)
