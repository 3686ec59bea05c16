"""Constants that packages share: they are followed, and where that does not lead to one value, nothing is claimed."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]
SENDER = """\
import rclpy
{imports}
from rclpy.node import Node
from std_msgs.msg import String


class Sender(Node):
    def __init__(self{parameter}):
        super().__init__('sender')
        self.sender = self.create_publisher(String, {topic}, {quality})
        self.sender.publish(String(data='ready'))


def main():
    rclpy.init()
    rclpy.spin(Sender({given}))
"""
READER = """\
import rclpy
{imports}
from rclpy.node import Node
from std_msgs.msg import String


class Reader(Node):
    def __init__(self):
        super().__init__('reader')
        self.create_subscription(String, {topic}, self.show, {quality})

    def show(self, message):
        self.get_logger().info(message.data)


def main():
    rclpy.init()
    rclpy.spin(Reader())
"""
PROFILE = "QoSProfile(depth=1, durability=DurabilityPolicy.{durability})"
IMPORTS = "from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy\n\n"
# The module shared.qualities, how it is imported, and how the profile is written.
WAYS = {
    "constant": (f"LATCHED = {PROFILE}", "from shared.qualities import LATCHED", "LATCHED"),
    "of a module": (f"LATCHED = {PROFILE}", "from shared import qualities", "qualities.LATCHED"),
    "by another name": (f"LATCHED = {PROFILE}", "import shared.qualities as q", "q.LATCHED"),
    "handed on": (f"LATCHED = {PROFILE}", "from shared import LATCHED", "LATCHED"),
    "of a function": (
        f"def latched():\n    return {PROFILE}",
        "from shared.qualities import latched",
        "latched()",
    ),
    "in a class": (
        f"class Profiles:\n    LATCHED = {PROFILE}",
        "from shared.qualities import Profiles",
        "Profiles.LATCHED",
    ),
    "a policy": (
        "KEPT = DurabilityPolicy.{durability}",
        "from rclpy.qos import QoSProfile\nfrom shared.qualities import KEPT",
        "QoSProfile(depth=1, durability=KEPT)",
    ),
}
# What may be anything.
OPEN = {
    "of a library": ("", "from robot_qualities import LATCHED", "LATCHED"),
    "in a dictionary": (
        f"ALL = {{{{'said': {PROFILE}}}}}",
        "from shared.qualities import ALL",
        "ALL['said']",
    ),
    "changed": (
        f"LATCHED = {PROFILE}\nLATCHED.durability = DurabilityPolicy.TRANSIENT_LOCAL",
        "from shared.qualities import LATCHED",
        "LATCHED",
    ),
    "assigned twice": (
        f"LATCHED = {PROFILE}\nLATCHED = None",
        "from shared.qualities import LATCHED",
        "LATCHED",
    ),
    "of a choice": (
        f"def pick(is_kept):\n    if is_kept:\n        return 5\n    return {PROFILE}",
        "from shared.qualities import pick",
        "pick(True)",
    ),
}


def told(
    folder: Path,
    shared: str,
    sender: tuple[str, str],
    reader: tuple[str, str] | None = None,
    topics: tuple[str, str] = ("'said'", "'said'"),
) -> list[str]:
    """Return the codes of what is said about a sender and a reader that use the qualities of another package."""
    files = Files(NAME)
    for package, modules in (("shared", []), ("pair", ["sender", "reader"])):
        points = "".join(f"'{module} = {package}.{module}:main', " for module in modules)
        base = f"src/{package}"
        files.texts |= {
            f"{base}/package.xml": MANIFEST.format(
                name=package, more=("<depend>shared</depend>" if modules else "")
            ),
            f"{base}/setup.py": SETUP.format(name=package, points=points),
            f"{base}/setup.cfg": f"[develop]\nscript_dir=$base/lib/{package}\n[install]\ninstall_scripts=$base/lib/{package}\n",
            f"{base}/resource/{package}": "",
            f"{base}/{package}/__init__.py": "",
        }
    handed_on = "from .qualities import LATCHED\n" if "LATCHED =" in shared else ""
    files.texts["src/shared/shared/__init__.py"] = handed_on
    files.texts["src/shared/shared/qualities.py"] = f"{IMPORTS}\n{shared}\n"
    files.texts["src/shared/shared/topics.py"] = (
        "SAID = 'said'\n\n\nclass Topics:\n    SAID = 'said/now'\n    SAYD = 'sayd/now'\n"
    )
    given = {
        "parameter": ", quality" if sender[1] == "quality" else "",
        "given": "LATCHED" if sender[1] == "quality" else "",
    }
    files.texts["src/pair/pair/sender.py"] = SENDER.format(
        imports=sender[0], quality=sender[1], topic=topics[0], **given
    )
    imports, quality = reader or sender
    files.texts["src/pair/pair/reader.py"] = READER.format(imports=imports, quality=quality, topic=topics[1])
    wanted = ("sent-early", "qos-mismatch", "queue-short", "topic-near-miss", "topic-name-invalid")
    return [f.code for f in of_workspace(files.write(folder)) if f.code in wanted]


MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>One of two</description>
  <maintainer email="anna@example.org">anna</maintainer>
  <license>MIT</license>
  <depend>rclpy</depend>
  <depend>std_msgs</depend>
  {more}
  <export>
    <build_type>ament_python</build_type>
  </export>
</package>
"""
SETUP = """\
from setuptools import setup

setup(
    name='{name}',
    version='0.1.0',
    packages=['{name}'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/{name}']),
        ('share/{name}', ['package.xml']),
    ],
    install_requires=['setuptools'],
    maintainer='anna',
    maintainer_email='anna@example.org',
    description='One of two',
    license='MIT',
    entry_points={{'console_scripts': [{points}]}},
)
"""


@pytest.mark.parametrize("way", WAYS)
def test_a_message_that_is_kept_is_not_sent_early(tmp_path: Path, way: str) -> None:
    shared, imports, quality = WAYS[way]
    assert told(tmp_path, shared.format(durability="TRANSIENT_LOCAL"), (imports, quality)) == []


@pytest.mark.parametrize("way", WAYS)
def test_a_message_that_is_not_kept_is_sent_early(tmp_path: Path, way: str) -> None:
    shared, imports, quality = WAYS[way]
    assert told(tmp_path, shared.format(durability="VOLATILE"), (imports, quality)) == ["sent-early"]


@pytest.mark.parametrize("way", OPEN)
def test_a_quality_that_is_not_known_is_no_default(tmp_path: Path, way: str) -> None:
    shared, imports, quality = OPEN[way]
    assert told(tmp_path, shared.format(durability="VOLATILE"), (imports, quality)) == []


def test_a_quality_that_is_handed_in_is_no_default(tmp_path: Path) -> None:
    imports = "from shared.qualities import LATCHED"
    shared = f"LATCHED = {PROFILE}".format(durability="TRANSIENT_LOCAL")
    assert told(tmp_path, shared, (imports, "quality"), (imports, "LATCHED")) == []


def test_a_number_that_is_shared_keeps_no_message(tmp_path: Path) -> None:
    assert told(tmp_path, "DEPTH = 10", ("from shared.qualities import DEPTH", "DEPTH")) == ["sent-early"]


@pytest.mark.parametrize("way", WAYS)
def test_a_reader_that_asks_for_more_than_is_offered_is_told(tmp_path: Path, way: str) -> None:
    shared, imports, quality = WAYS[way]
    found = told(tmp_path, shared.format(durability="TRANSIENT_LOCAL"), ("", "10"), (imports, quality))
    assert sorted(found) == ["qos-mismatch", "sent-early"]


@pytest.mark.parametrize("way", WAYS)
def test_a_reader_that_comes_too_late_is_told(tmp_path: Path, way: str) -> None:
    shared, imports, quality = WAYS[way]
    found = told(tmp_path, shared.format(durability="TRANSIENT_LOCAL"), (imports, quality), ("", "10"))
    assert found == ["qos-mismatch"]


TOPICS = "from shared.topics import SAID, Topics\n"


@pytest.mark.parametrize(
    ("topics", "codes"),
    [
        (("SAID", "'said'"), []),
        (("Topics.SAID", "'said/now'"), []),
        (("f'{SAID}/loud'", "'said/loud'"), []),
        (("Topics.SAYD", "Topics.SAID"), ["topic-near-miss"] * 2),
        (("f'{SAID} 1'", "f'{SAID} 1'"), ["topic-name-invalid"] * 2),
    ],
)
def test_a_topic_that_is_shared_is_followed(
    tmp_path: Path, topics: tuple[str, str], codes: list[str]
) -> None:
    shared, imports, quality = WAYS["constant"]
    ends = (f"{TOPICS}{imports}", quality)
    assert told(tmp_path, shared.format(durability="TRANSIENT_LOCAL"), ends, topics=topics) == codes
