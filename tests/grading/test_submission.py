"""What students hand in, in every form, and what attackers hand in: nothing but the empty folder is written."""

from __future__ import annotations

import bz2
import dataclasses
import gzip
import importlib.util
import io
import itertools
import json
import marshal
import os
import shutil
import socket
import stat
import struct
import subprocess
import tarfile
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from ros2lab.grading.receiving import clean_copy, submission, unpacking
from ros2lab.grading.receiving.clean_copy import SubmissionError
from ros2lab.grading.receiving.notes import Note
from ros2lab.grading.receiving.repository_links import linked_members
from ros2lab.grading.receiving.submission import FoundPackage, Submission, receive

NODE = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class NAME(Node):
    def __init__(self):
        super().__init__('NAME')
        self.publisher = self.create_publisher(String, 'TOPIC', 10)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(NAME())
"""
TOPICS = ("/robot/status", "/robot/command", "/cmd_vel")
PACKAGE_XML = """\
<?xml version="1.0"?>
<package format="3">
  <name>NAME</name><version>0.0.0</version><description>d</description>
  <maintainer email="a@b.cc">a</maintainer><license>MIT</license>
  <depend>rclpy</depend>
  <export><build_type>ament_python</build_type></export>
</package>
"""
SETUP_PY = "from setuptools import setup\nsetup(name='NAME', version='0.0.0', packages=['NAME'])\n"

Files = dict[str, str | bytes]


def node(topic: str, name: str = "Talker") -> str:
    return NODE.replace("TOPIC", topic).replace("NAME", name)


def package(name: str = "robot_controller", topics: Iterable[str] = TOPICS) -> Files:
    """The files of a package with a node for each topic."""
    nodes = {f"{name}/node_{n}.py": node(topic) for n, topic in enumerate(topics)}
    return {
        "package.xml": PACKAGE_XML.replace("NAME", name),
        "setup.py": SETUP_PY.replace("NAME", name),
        f"resource/{name}": "",
        f"{name}/__init__.py": "",
        **nodes,
    }


def below(folder: str, files: Mapping[str, str | bytes]) -> Files:
    return {f"{folder}/{name}": text for name, text in files.items()}


WORKSPACE = below("src/robot_controller", package()) | {"README.md": "# My robot\n"}
FOUND = FoundPackage("src/robot_controller", "robot_controller", "ament_python", None)
BUILT: Files = {
    "build/COLCON_IGNORE": "",
    "build/robot_controller/build/lib/robot_controller/node_0.py": node("/built"),
    "install/setup.bash": "",
    "install/robot_controller/share/robot_controller/package.xml": PACKAGE_XML.replace("NAME", "old"),
    "log/latest_build/events.log": "",
}


def data(text: str | bytes) -> bytes:
    return text if isinstance(text, bytes) else text.encode()


def as_folder(path: Path, files: Mapping[str, str | bytes]) -> Path:
    for name, text in files.items():
        file = path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data(text))
    return path


def as_zip(path: Path, files: Mapping[str, str | bytes]) -> Path:
    path = path.with_suffix(".zip")
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


def zip_bytes(files: Mapping[str, str | bytes]) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return target.getvalue()


def as_tar(path: Path, files: Mapping[str, str | bytes], compression: str = "", **more: Any) -> Path:
    path = path.with_name(f"{path.name}.tar{compression and '.'}{compression}")
    mode: Any = f"w:{compression}"
    with tarfile.open(path, mode, **more) as archive:
        for name, text in files.items():
            add(archive, name, data(text))
    return path


def add(archive: tarfile.TarFile, name: str, text: bytes = b"", **attributes: Any) -> None:
    """Add a member of any kind to a tar."""
    info = tarfile.TarInfo(name)
    info.size = len(text)
    for attribute, value in attributes.items():
        setattr(info, attribute, value)
    archive.addfile(info, io.BytesIO(text))


def as_checkout(path: Path, files: Mapping[str, str | bytes]) -> Path:
    as_folder(path, files)
    for command in (["init", "-q"], ["add", "-f", "."], ["commit", "-q", "-m", "All"]):
        identity = ["-c", "user.name=a", "-c", "user.email=a@b.cc", "-c", "commit.gpgsign=false"]
        subprocess.run(["git", *identity, *command], cwd=path, check=True)
    return path


CONTAINERS: dict[str, Callable[[Path, Mapping[str, str | bytes]], Path]] = {
    "folder": as_folder,
    "checkout": as_checkout,
    "zip": as_zip,
    "tar": as_tar,
    "tar.gz": lambda path, files: as_tar(path, files, "gz"),
    "tar.bz2": lambda path, files: as_tar(path, files, "bz2"),
    "tar.xz": lambda path, files: as_tar(path, files, "xz"),
}


def tree(folder: Path, without: Path | None = None) -> dict[str, tuple[Any, ...]]:
    """Everything in a folder: kind, permissions, time, and what it says."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if without is not None and (path == without or without in path.parents):
            continue
        state = path.lstat()
        says = (
            str(path.readlink())
            if path.is_symlink()
            else path.read_bytes()
            if stat.S_ISREG(state.st_mode)
            else ""
        )
        time = 0 if stat.S_ISDIR(state.st_mode) else state.st_mtime_ns
        found[str(path.relative_to(folder))] = (oct(state.st_mode), state.st_nlink, time, says)
    return found


Take = Callable[[Path], Submission]


@pytest.fixture
def unpacked(tmp_path: Path) -> Path:
    (tmp_path / "unpacked").mkdir()
    return tmp_path / "unpacked"


@pytest.fixture
def take(tmp_path: Path, unpacked: Path) -> Take:
    """Receive something; whatever becomes of it, nothing but the given folder may have changed."""

    def run(path: Path) -> Submission:
        before = tree(tmp_path, unpacked)
        try:
            result = receive(path, unpacked)
        finally:
            assert tree(tmp_path, unpacked) == before
        for file in unpacked.rglob("*"):
            kind = file.lstat().st_mode
            assert stat.S_ISREG(kind) or stat.S_ISDIR(kind) or stat.S_ISLNK(kind), file
            assert file.resolve().is_relative_to(unpacked), file
            assert stat.S_ISLNK(kind) or stat.S_IMODE(kind) in (0o644, 0o755), file
        return result

    return run


def noted(result: Submission, *words: str) -> bool:
    """Return whether one of the notes holds all of these words."""
    return any(all(word in str(note) for word in words) for note in result.notes)


def names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()}


# --- forms --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("container", CONTAINERS)
def test_a_workspace_is_the_same_in_every_container(
    container: str, tmp_path: Path, take: Take, unpacked: Path
) -> None:
    """Folder, git checkout, zip and tars give the same result and the same files."""
    result = take(CONTAINERS[container](tmp_path / "anna", WORKSPACE))
    notes = [Note("by a tool", [".git"], count=1)] if container == "checkout" else []
    assert result == Submission("workspace", ".", [FOUND], FOUND, [], notes)
    assert {name: (unpacked / name).read_bytes() for name in names(unpacked)} == {
        name: data(text) for name, text in WORKSPACE.items()
    }


@pytest.mark.parametrize("container", ["folder", "zip", "tar.gz"])
def test_a_package_alone(container: str, tmp_path: Path, take: Take) -> None:
    """Without a src above it there is no workspace, and the package is found at the top."""
    result = take(CONTAINERS[container](tmp_path / "anna", package()))
    assert (result.form, result.workspace) == ("package", None)
    assert result.package == FoundPackage(".", "robot_controller", "ament_python", None)


@pytest.mark.parametrize("container", ["folder", "zip", "tar.xz"])
def test_a_workspace_some_folders_down(container: str, tmp_path: Path, take: Take) -> None:
    """The workspace is found where it is, and the package may lie in a group below src."""
    result = take(CONTAINERS[container](tmp_path / "x", below("anna/week 3/ws/src/group/rc", package())))
    assert (result.form, result.workspace) == ("workspace", "anna/week 3/ws")
    assert result.package is not None
    assert result.package.folder == "anna/week 3/ws/src/group/rc"


@pytest.mark.parametrize("container", CONTAINERS)
def test_what_colcon_built_is_left_out(container: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Committed build, install and log are neither looked at nor kept, with COLCON_IGNORE or without."""
    files = below("ws", WORKSPACE | BUILT) | {
        "ws/src/robot_controller/build/lib/x.py": "",
        "ws/src/robot_controller/robot_controller/__pycache__/a.cpython-312.pyc": b"\0",
        "ws/src/robot_controller/robot_controller.egg-info/PKG-INFO": "",
        "ws/env/pyvenv.cfg": "",
        "ws/venv/lib/x.py": "",
        "__MACOSX/ws/._README.md": "",
    }
    result = take(CONTAINERS[container](tmp_path / "anna", files))
    assert (result.form, result.workspace) == ("workspace", "ws")
    assert [one.name for one in result.packages] == ["robot_controller"]
    assert names(unpacked) == {f"ws/{name}" for name in WORKSPACE}
    # Apart, for a list is cut, and a folder that was built in a wrong place is a fault.
    assert {note.kind for note in result.notes} == {"by a tool", "by a build"}
    assert "ws/src/robot_controller/build" in result.noted("by a build")


def test_folders_that_only_look_built_are_kept(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """A package called log and a module folder called build are the student's own."""
    files = below("src/log", package("log")) | below("src/robot_controller", package())
    files["src/robot_controller/robot_controller/build/__init__.py"] = ""
    result = take(as_folder(tmp_path / "ws", files))
    assert [one.folder for one in result.packages] == ["src/log", "src/robot_controller"]
    assert names(unpacked) == set(files)
    assert result.noted("by a tool", "by a build") == []


def test_a_zip_in_a_repository(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Where no package is outside, the archive in it is unpacked beside itself."""
    files = {"README.md": "", "week3/my work.zip": zip_bytes(WORKSPACE), "week3/my work/notes.txt": ""}
    result = take(as_checkout(tmp_path / "repository", files))
    assert (result.form, result.workspace) == ("workspace", "week3/my work_2")
    assert noted(result, "Unpacked", "week3/my work.zip")
    assert not list(unpacked.rglob("*.zip"))


def test_archives_in_archives_of_every_kind(tmp_path: Path, take: Take) -> None:
    """A tar.gz in a zip in a tar.bz2 is found."""
    inner = as_tar(tmp_path / "inner", WORKSPACE, "gz").read_bytes()
    middle = zip_bytes({"a/inner.tar.gz": inner})
    result = take(as_tar(tmp_path / "outer", {"m.zip": middle}, "bz2"))
    assert (result.form, result.workspace) == ("workspace", "m/a/inner")


@pytest.mark.parametrize(
    ("name", "folder"), [("..zip", "archive"), ("...zip", "archive"), (".a.ZIP", "a"), ("x.y.zip", "x.y")]
)
def test_archives_with_odd_names(name: str, folder: str, tmp_path: Path, take: Take) -> None:
    """What is in them lands in a folder of its own, beside them."""
    assert take(as_folder(tmp_path / "x", {f"in/{name}": zip_bytes(WORKSPACE)})).workspace == f"in/{folder}"


def test_archives_are_unpacked_to_a_small_depth(tmp_path: Path, take: Take) -> None:
    """An archive that lies deeper than anybody packs stays packed, and that is said."""
    archive = zip_bytes(WORKSPACE)
    for _ in range(unpacking.DEEPEST_ARCHIVE + 1):
        archive = zip_bytes({"again.zip": archive})
    result = take(as_folder(tmp_path / "ws", {"again.zip": archive}))
    assert (result.form, result.package) == ("nothing", None)
    assert noted(result, "Not unpacked", "again/again/again/again.zip")


def test_archives_beside_a_package_are_left_alone(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """An old zip in the workspace does not count, for the package is there."""
    result = take(as_folder(tmp_path / "ws", WORKSPACE | {"old.zip": zip_bytes(package("old"))}))
    assert result.packages == [FOUND]
    assert (unpacked / "old.zip").is_file()


def test_a_broken_inner_archive_is_noted(tmp_path: Path, take: Take) -> None:
    """The other one is graded all the same."""
    files = {"a.zip": zip_bytes(WORKSPACE)[:-30], "b.zip": zip_bytes(WORKSPACE), "c.rar": b"Rar!\x1a\x07\x01"}
    result = take(as_folder(tmp_path / "x", files))
    assert result.workspace == "b"
    assert noted(result, "Not unpacked: a.zip is broken")
    assert noted(result, "c.rar is a RAR archive")


@pytest.mark.parametrize("container", ["folder", "zip", "tar"])
def test_loose_files(container: str, tmp_path: Path, take: Take) -> None:
    """Files with nodes are found without any package, also one that Python cannot read; helpers are not nodes."""
    files = {
        "status.py": node("/robot/status"),
        "sub/command.py": "import rclpy\nnode = rclpy.create_node('c')\nrclpy.spin(node)\n",
        "star.py": "from rclpy.node import *\nclass A(Node): pass\n",
        "broken.py": "import rclpy\ndef main(:\n",
        "by_name.py": "import rclpy.node as n\nclass A(n.Node): pass\n",
        "helper.py": "from rclpy.qos import QoSProfile\nfrom rclpy.node import Node\ndef f(node: Node): pass\n",
        "other.py": "print('/cmd_vel')\n",
    }
    result = take(CONTAINERS[container](tmp_path / "anna", files))
    assert (result.form, result.packages, result.package, result.workspace) == ("files", [], None, None)
    assert set(result.node_files) == {"status.py", "sub/command.py", "star.py", "broken.py", "by_name.py"}


def test_nothing_that_could_be_graded(tmp_path: Path, take: Take) -> None:
    """A report without code is received, and is nothing."""
    result = take(as_zip(tmp_path / "x", {"report.pdf": b"%PDF", "main.py": "print('hello')"}))
    assert result == Submission("nothing", None, [], None, [], [])


def test_a_link_in_src_to_a_package_elsewhere(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """A package that the workspace reaches by a link inside the repository lies in the workspace, and is one."""
    repository = as_folder(tmp_path / "r", below("robot_controller", package()))
    (repository / "ws" / "src").mkdir(parents=True)
    (repository / "ws" / "src" / "robot_controller").symlink_to("../../robot_controller")
    result = take(repository)
    assert (result.form, result.workspace) == ("workspace", "ws")
    assert [one.folder for one in result.packages] == ["robot_controller"]
    assert str((unpacked / "ws/src/robot_controller").readlink()) == "../../robot_controller"


def test_the_result_is_plain_data(tmp_path: Path, take: Take) -> None:
    """It can be written as JSON."""
    result = take(as_folder(tmp_path / "ws", WORKSPACE))
    assert json.loads(json.dumps(dataclasses.asdict(result)))["package"]["name"] == "robot_controller"


def test_the_reference_is_received(take: Take) -> None:
    """The package of this repository is the assignment's."""
    result = take(Path(__file__).parents[2] / "robot_controller")
    assert result.package == FoundPackage(".", "robot_controller", "ament_python", None)


# --- which package ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("decoys_first", [True, False])
@pytest.mark.parametrize(
    ("name", "topics"),
    [
        ("robot_controller", TOPICS),
        ("team7", TOPICS),
        ("my_bot", ("robot/status", "robot/command", "cmd_vel")),
        ("robot_controller", ("/robot/statu", "/robot_command", "/cmdvel")),
        ("robot_controler", ("/status",)),
    ],
)
def test_the_package_is_chosen_by_what_it_does(
    name: str, topics: tuple[str, ...], decoys_first: bool, tmp_path: Path, take: Take
) -> None:
    """Neither the folders' order nor another package with rclpy and a topic of the three hides it."""
    letter = "z" if decoys_first else "a"
    decoys = {
        "m1": package("talker_demo", ["/chatter"]),
        "m2": package("interfaces", []),
        "m3": package("teleop", ["/cmd_vel"]),
    }
    files: Files = below(f"src/{letter}", package(name, topics))
    for folder, decoy in decoys.items():
        files |= below(f"src/{folder}", decoy)
    result = take(as_folder(tmp_path / "ws", files))
    assert len(result.packages) == 4
    assert result.package is not None
    assert (result.package.folder, result.package.name) == (f"src/{letter}", name)
    assert result.noted("for a library") == []
    # The other one has no node; where nothing but the name is better, nothing else is said to be.
    assert result.noted("more elsewhere", "not graded") == ["src/m1", "src/m3"]
    assert bool(result.noted("not graded")) is (topics == ("/status",))


def test_a_package_that_stands_in_for_a_library_is_noted(tmp_path: Path, take: Take) -> None:
    """What the nodes import is theirs then; whoever reads the report would look for it elsewhere."""
    files = below("src/robot_controller", package("robot_controller", TOPICS))
    files |= below("src/rclpy", package("rclpy", [])) | below("src/more", package("more", []))
    result = take(as_folder(tmp_path / "ws", files))
    assert result.noted("for a library") == ["src/rclpy"]


@pytest.mark.parametrize(
    "line",
    [
        "node.create_publisher(Twist, '/wheels', 10)",
        "node.create_subscription(String, '/orders', print, 10)",
        "is_moving = order == 'start'",
        "speed = {'stop': 0.0, 'reset': 0.0}.get(order)",
    ],
)
@pytest.mark.parametrize("folder", ["a", "z"])
def test_where_no_topic_tells_types_and_commands_do(
    line: str, folder: str, tmp_path: Path, take: Take
) -> None:
    """Neither the folders' order nor the names decide, where one of two does more of what was asked for."""
    source = f"import rclpy\nfrom geometry_msgs.msg import Twist\nfrom std_msgs.msg import String\nnode = rclpy.create_node('x')\norder = ''\n{line}\n"
    files: Files = below("m", package("m", ["/chatter"])) | below(folder, package(folder, ["/chatter"]))
    result = take(as_folder(tmp_path / "x", files | {f"{folder}/{folder}/more.py": source}))
    assert result.package is not None
    assert result.package.name == folder
    assert noted(result, "Not graded", f"{folder} has more of what was asked for: m")


def test_an_empty_package_of_the_right_name_is_not_it(tmp_path: Path, take: Take) -> None:
    """The nodes decide, not the name alone."""
    files = below("src/robot_controller", package("robot_controller", [])) | below("src/x", package("x"))
    result = take(as_folder(tmp_path / "ws", files))
    assert result.package is not None
    assert result.package.name == "x"


@pytest.mark.parametrize(
    ("own", "others", "also"),
    [
        (TOPICS, {"teleop": ["/cmd_vel"], "copy": TOPICS}, []),
        (TOPICS[:2], {"motors": ["/cmd_vel"], "chatter": ["/chatter"]}, ["motors"]),
        (TOPICS[:2], {"turtle": ["/turtle1/cmd_vel"]}, ["turtle"]),
        (
            TOPICS[:1],
            {"ears": ["/robot/comand"], "wheels": ["/cmd_vel"], "more": ["/cmd_vel"]},
            ["more", "ears"],
        ),
    ],
)
def test_work_may_be_spread_over_packages(
    own: Sequence[str], others: Mapping[str, Sequence[str]], also: list[str], tmp_path: Path, take: Take
) -> None:
    """Those count that are built and have what the others have not; practice beside a whole package does not."""
    script = SETUP_PY.replace(")\n", ", entry_points={'console_scripts': ['go = NAME.node_0:main']})\n")
    files: Files = {}
    for name, topics in {"robot_controller": own, **others}.items():
        files |= below(f"src/{name}", package(name, topics) | {"setup.py": script.replace("NAME", name)})
    files |= below("src/unbuilt", package("unbuilt", TOPICS[2:]))
    result = take(as_folder(tmp_path / "ws", files))
    assert result.package is not None
    assert result.package.name == "robot_controller"
    assert [one.name for one in result.also] == also


@pytest.mark.parametrize(("topics", "also"), [(TOPICS[1:], ["heart"]), (TOPICS, [])])
def test_the_rhythm_of_another_package_may_fill_an_empty_part(
    topics: Sequence[str], also: list[str], tmp_path: Path, take: Take
) -> None:
    """A text every two seconds is taken for the status, whatever its topic is called; one that is there is enough."""
    beating = """\
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Beat(Node):
    def __init__(self):
        super().__init__('beat')
        self.out = self.create_publisher(String, 'life', 10)
        self.create_timer(2.0, self.tick)

    def tick(self):
        self.out.publish(String())
"""
    script = SETUP_PY.replace(")\n", ", entry_points={'console_scripts': ['go = heart.beat:main']})\n")
    heart = package("heart", ()) | {"setup.py": script, "heart/beat.py": beating}
    own = below("src/robot_controller", package("robot_controller", topics))
    result = take(as_folder(tmp_path / "ws", own | below("src/heart", heart)))
    assert result.package is not None
    assert result.package.name == "robot_controller"
    assert [one.name for one in result.also] == also


def test_a_copy_outside_of_src_is_not_graded_though_more_is_in_it(tmp_path: Path, take: Take) -> None:
    """What lies in the workspace is meant, unless much more is in the other one; the note says why."""
    script = SETUP_PY.replace(")\n", ", entry_points={'console_scripts': ['go = robot.node_0:main']})\n")
    copy, whole = (
        package("robot", TOPICS[:2]) | {"setup.py": script},
        package("robot", TOPICS) | {"setup.py": script},
    )
    files = below("src/robot", copy) | below("old/robot", whole)
    result = take(as_folder(tmp_path / "ws", files))
    assert result.package is not None
    assert result.package.folder == "src/robot"
    assert noted(result, "src of a workspace", ": old/robot")


def test_of_two_that_are_alike_the_one_in_the_workspace_is_taken(tmp_path: Path, take: Take) -> None:
    """That is noted, so that nobody wonders."""
    files = below("backup", package()) | below("ws/src/robot_controller", package())
    result = take(as_folder(tmp_path / "x", files))
    assert result.workspace == "ws"
    assert noted(result, "at least as well", "ws/src/robot_controller", ": backup")


def test_a_package_in_a_package_and_one_that_is_hidden(tmp_path: Path, take: Take) -> None:
    """Both are noted, for colcon sees neither; the nodes of the hidden one are there as files."""
    files = below("src/a", package("a", [])) | below("src/a/robot_controller", package())
    files |= below("src/b", package("b")) | {"src/b/COLCON_IGNORE": ""}
    result = take(as_folder(tmp_path / "ws", files))
    assert result.package is not None
    assert result.package.folder == "src/a/robot_controller"
    assert noted(result, "lies in another one: src/a/robot_controller")
    assert noted(result, "COLCON_IGNORE", "src/b")
    assert result.node_files == ["src/b/b/node_0.py", "src/b/b/node_1.py", "src/b/b/node_2.py"]


# --- manifests ----------------------------------------------------------------------------------------------

BOMB_XML = '<!DOCTYPE p [<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {chr(98 + n)} "{f"&{chr(97 + n)};" * 10}">' for n in range(12)
)


INVALID = "package.xml is not valid: "


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (PACKAGE_XML.replace("</package>", ""), ("robot_controller", None, INVALID)),
        ("", ("robot_controller", None, INVALID)),
        (b"\xff\xfe\0\0", ("robot_controller", None, INVALID)),
        (BOMB_XML + "]><package>&l;</package>", ("robot_controller", None, INVALID + "it defines entities")),
        (None, ("robot_controller", None, "There is no package.xml beside setup.py.")),
        (PACKAGE_XML.replace("<build_type>ament_python</build_type>", ""), ("NAME", None, "")),
        (PACKAGE_XML.replace("ament_python", "cmake"), ("NAME", "cmake", "")),
        ("\ufeff" + PACKAGE_XML.replace("\n", "\r\n"), ("NAME", "ament_python", "")),
    ],
)
def test_package_xml_in_all_states(
    text: str | bytes | None, expected: tuple[str, str | None, str], tmp_path: Path, take: Take
) -> None:
    """A package is found by its files; a manifest that cannot be used is a sentence and never an exception."""
    files = package()
    del files["package.xml"]
    result = take(as_folder(tmp_path / "p", files if text is None else files | {"package.xml": text}))
    name, build_type, error = expected
    assert result.form == "package"
    assert result.package is not None
    assert (result.package.name, result.package.build_type) == (name, build_type)
    said = result.package.error
    assert said is None if not error else said is not None and said.startswith(error) and said.endswith(".")


def test_a_name_that_setup_py_only_computes_is_none(tmp_path: Path, take: Take) -> None:
    """Nothing is run to learn a name."""
    touched = tmp_path / "touched"
    setup = f"open({str(touched)!r}, 'w')\nfrom setuptools import setup\nsetup(name=input())\n"
    result = take(as_folder(tmp_path / "p", {"setup.py": setup, "a.py": node("/cmd_vel")}))
    assert result.package == FoundPackage(".", None, None, "There is no package.xml beside setup.py.")
    assert not touched.exists()


@pytest.mark.parametrize(
    "text",
    [
        "import rclpy\n" + "(" * 100_000,
        "import rclpy\nx = " + "-" * 100_000 + "1",
        "import rclpy\nx = a" + ".b" * 100_000,
        "import rclpy\nx = 1" + " + 1" * 100_000,
        "import rclpy\n\0",
        b"import rclpy\n\xff\xfe",
        "import rclpy\nclass A(B): pass\nclass B(A): pass\n",
        "import rclpy\n" + "x = 1\n" * 400_000,
    ],
)
def test_python_that_breaks_parsers(text: str | bytes, tmp_path: Path, take: Take) -> None:
    """The file beside it is found all the same."""
    result = take(as_folder(tmp_path / "x", {"a.py": text, "z.py": node("/cmd_vel")}))
    assert "z.py" in result.node_files


def test_only_so_much_python_is_parsed(tmp_path: Path, take: Take, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is beyond is kept and noted; what lies highest is looked at first."""
    monkeypatch.setattr(submission, "MOST_SOURCE", 1000)
    files = {"deep/er/a.py": node("/cmd_vel") + "#" * 600, "z.py": node("/cmd_vel")}
    result = take(as_folder(tmp_path / "x", files))
    assert result.node_files == ["z.py"]
    assert noted(result, "Not looked at", "deep/er/a.py")


def test_only_so_many_packages_are_looked_at(
    tmp_path: Path, take: Take, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that lie highest are."""
    monkeypatch.setattr(submission, "MOST_PACKAGES", 2)
    files = {f"{'a/' * n}p/package.xml": PACKAGE_XML for n in range(4)}
    result = take(as_folder(tmp_path / "x", files))
    assert [one.folder for one in result.packages] == ["a/p", "p"]
    assert noted(result, "more than 2 packages: a/a/p, a/a/a/p")


# --- names --------------------------------------------------------------------------------------------------

ODD: Files = {
    "my robot/Ünïcode 机器人.py": node("/cmd_vel").replace("\n", "\r\n"),
    "my robot/bom.py": b"\xef\xbb\xbf" + data(node("/robot/status")),
    "my robot/Node.py": "A = 1\n",
    "my robot/node.py": "a = 1\r\n",
    "My Robot/node.py": "",
    "semi;colon&$(touch x)'\".txt": "",
    "-rf": "",
    "new\nline\x1b[31m.txt": "",
}


@pytest.mark.parametrize("container", CONTAINERS)
def test_names_and_contents_survive(container: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Blanks, non-ASCII, case clashes, CRLF, BOM and what a shell would take for a command stay as they are."""
    result = take(CONTAINERS[container](tmp_path / "x", ODD))
    assert {name: (unpacked / name).read_bytes() for name in names(unpacked)} == {
        name: data(text) for name, text in ODD.items()
    }
    assert result.node_files == ["my robot/bom.py", "my robot/Ünïcode 机器人.py"]


@pytest.mark.parametrize("container", ["folder", "tar", "tar.gz"])
def test_a_name_that_is_not_unicode(container: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """It is kept byte by byte, and noted in a way that can be printed."""
    name = os.fsdecode(b"caf\xe9.py")
    if container == "folder":
        path = as_folder(tmp_path / "x", {name: node("/cmd_vel")})
    else:
        with tarfile.open(tmp_path / "x.tar.gz", "w:gz", format=tarfile.GNU_FORMAT) as archive:
            add(archive, name, data(node("/cmd_vel")))
        path = tmp_path / "x.tar.gz"
    result = take(path)
    assert [os.fsencode(path.name) for path in unpacked.iterdir()] == [b"caf\xe9.py"]
    assert noted(result, "not valid Unicode", r"caf\udce9.py")
    "".join(map(str, result.notes)).encode()


def test_names_of_zips_from_other_systems(tmp_path: Path, take: Take, unpacked: Path) -> None:
    r"""A Mac leaves out the flag for UTF-8, and Windows may write `\` between folders."""
    mac = bytearray(zip_bytes({"Grüße/a.py": ""}))
    for signature, offset in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        at = mac.index(signature) + offset
        mac[at : at + 2] = struct.pack("<H", struct.unpack("<H", mac[at : at + 2])[0] & ~0x800)
    windows = io.BytesIO()
    with zipfile.ZipFile(windows, "w") as archive:
        info = zipfile.ZipInfo("src\\b.py")
        info.create_system = 0
        archive.writestr(info, "")
        info = zipfile.ZipInfo("..\\..\\evil.py")
        info.create_system = 0
        archive.writestr(info, "")
    result = take(as_folder(tmp_path / "x", {"mac.zip": bytes(mac), "windows.zip": windows.getvalue()}))
    assert names(unpacked) == {"mac/Grüße/a.py", "windows/src/b.py"}
    assert noted(result, "leads out", "../../evil.py")


def test_notes_hold_no_terminal_commands_and_stay_short(tmp_path: Path, take: Take) -> None:
    """A thousand refused members are one sentence."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        add(archive, "a.txt", b"a")
        for number in range(1000):
            add(archive, f"../\x1b]0;evil\x07\u202e{number}" + "x" * 300)
    note = str(take(tmp_path / "x.tar").notes[0])
    assert note.isprintable()
    assert "995 more" in note
    assert len(note) < 1500


# --- what cannot be received --------------------------------------------------------------------------------


def _damaged(text: bytes, at: int) -> bytes:
    return text[:at] + bytes(byte ^ 0xFF for byte in text[at : at + 8]) + text[at + 8 :]


def _refused(folder: Path) -> dict[str, tuple[Path, str]]:
    """Make what cannot be received: the path, and what the error has to say."""
    noise = os.urandom(5000)
    files: Files = {"a.bin": noise, "b.bin": noise[::-1], "c.txt": "c" * 2000}
    good_zip = as_zip(folder / "good", files).read_bytes()
    good_tar, good_gz, good_bz2, good_xz = (
        as_tar(folder / "good", files, kind).read_bytes() for kind in ("", "gz", "bz2", "xz")
    )
    locked = bytearray(good_zip)
    for signature, offset in ((b"PK\3\4", 6), (b"PK\1\2", 8)):
        at = locked.index(signature) + offset
        locked[at] |= 1
    small = bytearray(good_zip)  # says that the last file is shorter than it is
    at = small.rindex(b"PK\1\2") + 24
    small[at : at + 4] = struct.pack("<I", 7)
    far = bytearray(good_zip)  # says that the first file begins nowhere
    at = far.index(b"PK\1\2") + 42
    far[at : at + 4] = b"\xff\xff\xff\x7f"
    unusual = io.BytesIO()
    with zipfile.ZipFile(unusual, "w", zipfile.ZIP_BZIP2) as archive:
        archive.writestr("a.py", "a" * 10_000)
    written = {
        "empty.zip": (b"", "is empty"),
        "nothing.zip": (zip_bytes({}), "is empty"),
        "nothing.tar": (b"\0" * 10_240, "is empty"),
        "nothing.tar.gz": (gzip.compress(b"\0" * 10_240), "is empty"),
        "node.py": (data(node("/cmd_vel")), "neither a zip nor a tar"),
        "work.7z": (b"7z\xbc\xaf\x27\x1c" + noise, "7-Zip"),
        "work.rar": (b"Rar!\x1a\x07\x00" + noise, "RAR"),
        "wrong.zip": (b"Rar!\x1a\x07\x00" + noise, "RAR"),
        "locked.zip": (bytes(locked), "password"),
        "unusual.zip": (unusual.getvalue(), "unusual way (method 12)"),
        "half.zip": (good_zip[: len(good_zip) // 2], "broken or incomplete"),
        "damaged.zip": (_damaged(good_zip, 1000), "broken or incomplete"),
        "small.zip": (bytes(small), "broken or incomplete"),
        "far.zip": (bytes(far), "broken or incomplete"),
        "half.tar": (good_tar[:8000], "broken or incomplete"),
        "damaged.tar": (_damaged(good_tar, 512 + 5120), "broken or incomplete"),
        "half.tar.gz": (good_gz[:-3000], "broken or incomplete"),
        "no_end.tar.gz": (good_gz[:-4], "broken or incomplete"),
        "damaged.tar.gz": (_damaged(good_gz, len(good_gz) - 8), "broken or incomplete"),
        "half.tar.bz2": (good_bz2[:-3000], "broken or incomplete"),
        "damaged.tar.bz2": (_damaged(good_bz2, 3000), "broken or incomplete"),
        "half.tar.xz": (good_xz[:-3000], "broken or incomplete"),
        "damaged.tar.xz": (_damaged(good_xz, 3000), "broken or incomplete"),
        "notes.gz": (gzip.compress(b"no tar " * 200), "not a tar archive"),
        "short.gz": (gzip.compress(b"no tar"), "not a tar archive"),
        "only_built.zip": (zip_bytes(BUILT), "nothing to grade (Left out, because a build made it: "),
        "only_up.zip": (zip_bytes({"../a.py": ""}), "nothing to grade (Refused, because it leads out"),
    }
    for name, (text, _) in written.items():
        (folder / name).write_bytes(text)
    (folder / "empty").mkdir()
    (folder / "hollow" / "src" / "a").mkdir(parents=True)
    os.mkfifo(folder / "pipe")
    (folder / "nowhere").symlink_to("nothing")
    (folder / "loop").symlink_to("loop")
    return {name: (folder / name, words) for name, (_, words) in written.items()} | {
        "missing": (folder / "missing.zip", "missing.zip does not exist"),
        "nowhere": (folder / "nowhere", "nowhere does not exist"),
        "loop": (folder / "loop", "does not exist"),
        "empty folder": (folder / "empty", "is empty"),
        "folders only": (folder / "hollow", "is empty"),
        "pipe": (folder / "pipe", "neither a folder nor a file"),
        "device": (Path("/dev/zero"), "neither a folder nor a file"),
    }


def test_what_cannot_be_received_is_one_sentence(tmp_path: Path) -> None:
    """It says what was found and what to do; nothing hangs, and nothing else is raised."""
    (tmp_path / "in").mkdir()
    refused = _refused(tmp_path / "in")
    for name, (path, words) in refused.items():
        folder = tmp_path / "out" / name
        folder.mkdir(parents=True)
        with pytest.raises(SubmissionError) as error:
            receive(path, folder)
        said = str(error.value)
        assert words in said, name
        assert said.endswith("."), name
        assert said.isprintable(), name
        assert "; " in said, name
        assert str(tmp_path) not in said, name


def test_zstd_is_read_where_python_can(tmp_path: Path, take: Take) -> None:
    """Python 3.14 unpacks it; an older one says what to do."""
    if shutil.which("zstd") is None:
        pytest.skip("no zstd command to make such an archive")
    path = as_tar(tmp_path / "ws", WORKSPACE)
    subprocess.run(["zstd", "-q", path], check=True)
    try:
        from compression import zstd  # type: ignore[import-not-found, unused-ignore]  # noqa: F401
    except ImportError:
        with pytest.raises(SubmissionError, match=r"ws\.tar\.zst is compressed with zstd.*hand in"):
            take(tmp_path / "ws.tar.zst")
    else:
        assert take(tmp_path / "ws.tar.zst").packages == [FOUND]


@pytest.mark.skipif(
    os.geteuid() == 0, reason="root can read everything; test_sandbox.py runs it as nobody, too"
)
def test_what_cannot_be_read(tmp_path: Path, unpacked: Path) -> None:
    """A file without permission is noted; an archive without permission is refused."""
    folder = as_folder(tmp_path / "x", WORKSPACE | {"secret": "", "closed/a": ""})
    archive = as_zip(tmp_path / "a", WORKSPACE)
    for path in (folder / "secret", folder / "closed", archive):
        path.chmod(0)
    try:
        result = receive(folder, unpacked)
        assert result.package == FOUND
        assert noted(result, "cannot be read", "closed", "secret")
        (tmp_path / "other").mkdir()
        with pytest.raises(SubmissionError, match="cannot be read"):
            receive(archive, tmp_path / "other")
    finally:
        (folder / "closed").chmod(0o755)


def test_the_folder_has_to_be_empty_and_outside(tmp_path: Path) -> None:
    """What would mix two submissions, or copy a folder into itself, is the caller's mistake."""
    ws = as_folder(tmp_path / "ws", WORKSPACE)
    with pytest.raises(ValueError, match="not empty"):
        receive(as_folder(tmp_path / "other", WORKSPACE), ws)
    (ws / "inner").mkdir()
    with pytest.raises(ValueError, match="lies in"):
        receive(ws, ws / "inner")


# --- hostile ------------------------------------------------------------------------------------------------


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A file and a folder outside that nobody may reach."""
    folder = tmp_path / "secrets"
    folder.mkdir()
    (folder / "key").write_text("secret")
    return folder


@pytest.mark.parametrize("container", ["zip", "tar", "tar.gz"])
def test_paths_that_lead_out(
    container: str, tmp_path: Path, take: Take, unpacked: Path, secret: Path
) -> None:
    """Members with `..` or an absolute path are refused, and the rest is graded."""
    evil: Files = {
        "../evil": "1",
        "src/../../evil": "2",
        "src/robot_controller/../../../secrets/key": "3",
        str(secret / "key"): "4",
        f"/{tmp_path}/evil": "5",
        "..": "6",
        "./../evil": "7",
        "src/..": "8",
    }
    result = take(CONTAINERS[container](tmp_path / "x", evil | WORKSPACE))
    assert result.package == FOUND
    assert names(unpacked) == set(WORKSPACE)
    assert noted(result, "leads out", "../evil", "more")


def test_links_in_a_tar_that_lead_out(tmp_path: Path, take: Take, unpacked: Path, secret: Path) -> None:
    """No link leads out, directly or by a chain, and nothing is written through one."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        for name, text in WORKSPACE.items():
            add(archive, name, data(text))
        for name, target in {
            "etc": "/etc",
            "absolute": str(secret),
            "up": "../secrets",
            "far/up": "../../secrets/key",
            "passwd": "/etc/passwd",
            "back": f"../{unpacked.name}/README.md",
            "first": "second",
            "second": "third/../../secrets/key",
            "third": "src",
            "deep": "src/robot_controller/../../..",
            "self": "self",
            "ping": "pong",
            "pong": "ping",
            "nowhere": "nothing",
            "of_file": "README.md/../README.md",
            "empty": "",
            "long": "x" * 300,
            "longer": "src/" * 500,
        }.items():
            add(archive, name, type=tarfile.SYMTYPE, linkname=target)
        add(archive, "etc/passwd2", b"evil")
        add(archive, "absolute/key", b"evil")
        add(archive, "up/key", b"evil")
        add(archive, "passwd", b"evil")
    result = take(tmp_path / "x.tar")
    links = {path.name for path in unpacked.rglob("*") if path.is_symlink()}
    assert links == {"third"}
    assert names(unpacked) >= {
        "etc/passwd2",
        "absolute/key",
        "up/key",
        "passwd",
    }  # plain files of these names
    assert (secret / "key").read_text() == "secret"
    assert noted(result, "leads out", "far/up -> ", "back -> ", "first -> ", "second -> ", "deep -> ")
    assert noted(result, "nothing that was handed in", "nowhere -> nothing")


def test_links_that_stay_inside_are_kept(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Links to files, to folders, to other links and upwards work in the copy."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        for name, target in {
            "READ.md": "README.md",
            "docs/README.md": "../README.md",
            "code": "src/robot_controller",
            "twice": "code/package.xml",
            "src/robot_controller/up": "../..",
        }.items():
            add(archive, name, type=tarfile.SYMTYPE, linkname=target)
        for name, text in WORKSPACE.items():
            add(archive, name, data(text))
    result = take(tmp_path / "x.tar")
    assert result == Submission("workspace", ".", [FOUND], FOUND, [], [])
    assert (unpacked / "docs/README.md").read_text() == "# My robot\n"
    assert (unpacked / "twice").read_text() == (unpacked / "src/robot_controller/package.xml").read_text()
    assert str((unpacked / "src/robot_controller/up").readlink()) == "../.."


@pytest.mark.parametrize("container", ["folder", "zip"])
def test_links_in_a_folder_and_a_zip(
    container: str, tmp_path: Path, take: Take, unpacked: Path, secret: Path
) -> None:
    """They are treated as in a tar, and what they lead to is never read."""
    links = {"out": str(secret), "src/key": "../../secrets/key", "in": "README.md", "log": "src"}
    if container == "folder":
        path = as_folder(tmp_path / "ws", WORKSPACE)
        for name, target in links.items():
            (path / name).symlink_to(target)
    else:
        path = as_zip(tmp_path / "ws", WORKSPACE)
        with zipfile.ZipFile(path, "a") as archive:
            for name, target in links.items():
                info = zipfile.ZipInfo(name)
                info.external_attr = (stat.S_IFLNK | 0o777) << 16
                archive.writestr(info, target)
    result = take(path)
    assert {path.name for path in unpacked.rglob("*") if path.is_symlink()} == {"in", "log"}
    assert noted(result, "leads out", "out -> ", "src/key -> ../../secrets/key")
    assert result.package == FOUND


def test_links_inside_a_repository(tmp_path: Path, take: Take, unpacked: Path, secret: Path) -> None:
    """Those that the repository has are followed to where it goes on; no other, and never out of it."""
    top = as_folder(tmp_path / "lab", below("package", package()))
    source = as_folder(top / "ws", {"README.md": "A workspace."}) / "src"
    source.mkdir()
    (source / "robot_controller").symlink_to("../../package")
    (source / "key").symlink_to("../../../secrets")
    (source / "git").symlink_to("../../.git")
    as_checkout(top, {})
    (source / "later").symlink_to("../../package")
    result = take(top / "ws")
    assert names(unpacked) == {"README.md", *(f"src/robot_controller/{name}" for name in package())}
    assert result.package == FOUND
    assert noted(result, "Taken from elsewhere", "src/robot_controller -> ../../package")
    assert noted(result, "leads out", "src/key -> ", "src/git -> ", "src/later -> ")
    (source / "robot_controller").unlink()
    (source / "robot_controller").symlink_to("../../../secrets/../lab/package")
    assert not linked(top / "ws")


@pytest.mark.parametrize(
    ("link", "target"),
    [
        ("copied/ws/src/robot_controller", "../../../anna/ws/src/robot_controller"),
        ("copied/ws/src", "../../anna/ws/src"),
        ("copied/ws", "../anna/ws"),
        ("copied/robot_controller", "../anna/ws/src/robot_controller"),
        ("copied/all", "../anna"),
    ],
)
def test_no_link_leads_to_the_workspace_of_somebody_else(
    tmp_path: Path, take: Take, link: str, target: str
) -> None:
    top = as_folder(tmp_path / "class", below("anna/ws/src/robot_controller", package()))
    as_folder(top / "copied", {"README.md": "My work."})
    path = top / link
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(target)
    as_checkout(top, {})
    assert not linked(top / "copied")
    result = take(top / "copied")
    assert result.package is None
    assert noted(result, "another workspace", f"{link.partition('/')[2]} -> {target}")


@pytest.mark.parametrize("handed_in", ["lab", "lab/ws"], ids=["the whole", "a part"])
@pytest.mark.parametrize("held", ["..", "../..", "/"])
def test_a_repository_holds_nothing_that_lies_outside_of_it(
    tmp_path: Path, secret: Path, held: str, handed_in: str
) -> None:
    """Its own settings may say that it does, as those of a work tree elsewhere."""
    top = as_checkout(as_folder(tmp_path / "lab", {"ws/README.md": "A workspace."}), {})
    (top / "ws" / "key").symlink_to("../../secrets")
    key = top / "ws" / "key"
    digest = subprocess.run(
        ["git", "-C", str(top), "hash-object", "-w", "--stdin"],
        input=os.fsencode(key.readlink()),
        capture_output=True,
        check=True,
    ).stdout.decode()
    root = os.path.normpath(top / ".git" / held)
    for name in os.path.relpath(key, root), os.path.relpath(key, top):
        entry = f"120000,{digest.strip()},{name}"
        subprocess.run(["git", "-C", str(top), "update-index", "--add", "--cacheinfo", entry], check=True)
    subprocess.run(["git", "-C", str(top), "config", "core.worktree", held], check=True)
    assert secret.is_relative_to(root) or held == ".."
    assert not linked(tmp_path / handed_in)


@pytest.mark.parametrize("name", ["config", "index", "HEAD", "info/exclude", "objects"])
def test_a_repository_that_keeps_git_waiting_is_received(
    tmp_path: Path, take: Take, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """What git reads of it may be a pipe into which nobody writes; its links then lead nowhere."""
    monkeypatch.setattr("ros2lab.git.PATIENCE", 1.0)
    top = as_checkout(as_folder(tmp_path / "lab", below("ws/src/robot_controller", package())), {})
    path = top / ".git" / name
    shutil.rmtree(path, ignore_errors=True)
    path.unlink(missing_ok=True)
    path.parent.mkdir(exist_ok=True)
    os.mkfifo(path)
    assert take(top / "ws").package == FOUND


def linked(folder: Path) -> list[str]:
    """Return the names of what links lead to elsewhere in the repository."""
    return [member.name for member, _ in linked_members(folder, lambda _kind, _path: None)]


def test_hard_links_in_a_tar(tmp_path: Path, take: Take, unpacked: Path, secret: Path) -> None:
    """One to a file of the submission is a copy; one to anything else is refused and shares nothing."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        add(archive, "a.txt", b"hello")
        for name, target in {
            "b.txt": "a.txt",
            "passwd": "/etc/passwd",
            "key": str(secret / "key"),
            "up": "../secrets/key",
            "later": "z.txt",
            "long": "x" * 300,
            "a.txt": "a.txt",
        }.items():
            add(archive, name, type=tarfile.LNKTYPE, linkname=target)
        add(archive, "soft", type=tarfile.SYMTYPE, linkname=str(secret / "key"))
        add(archive, "soft_hard", type=tarfile.LNKTYPE, linkname="soft")
        add(archive, "z.txt", b"z")
    result = take(tmp_path / "x.tar")
    assert names(unpacked) == {"a.txt", "b.txt", "z.txt"}
    assert {(unpacked / name).stat().st_nlink for name in names(unpacked)} == {1}
    assert (unpacked / "b.txt").read_text() == (unpacked / "a.txt").read_text() == "hello"
    assert noted(result, "leads out", "passwd -> /etc/passwd", "up -> ../secrets/key")
    assert noted(result, "nothing that was handed in", "later -> z.txt", "soft_hard -> soft")


@pytest.mark.parametrize(
    "kind", [tarfile.CHRTYPE, tarfile.BLKTYPE, tarfile.FIFOTYPE, b"Z"], ids=["chr", "blk", "fifo", "unknown"]
)
def test_devices_in_a_tar(kind: bytes, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """They are refused."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        add(archive, "a.txt")
        add(archive, "dev", type=kind, devmajor=1, devminor=5)
    result = take(tmp_path / "x.tar")
    assert names(unpacked) == {"a.txt"}
    assert noted(result, "neither a file nor a folder nor a link", "dev")


def test_devices_in_a_zip_and_a_folder(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Pipes and sockets in a folder are not opened, and devices in a zip not made."""
    folder = as_folder(tmp_path / "x", {"a.txt": ""})
    os.mkfifo(folder / "pipe")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(os.path.relpath(folder / "socket"))
        inner = io.BytesIO()
        with zipfile.ZipFile(inner, "w") as archive:
            info = zipfile.ZipInfo("device")
            info.external_attr = (stat.S_IFBLK | 0o666) << 16
            archive.writestr(info, "")
        (folder / "inner.zip").write_bytes(inner.getvalue())
        result = take(folder)
    assert names(unpacked) == {"a.txt"}
    assert noted(result, "neither a file nor a folder nor a link", "pipe, socket, device")


@pytest.mark.parametrize("container", ["folder", "zip", "tar"])
def test_permissions_are_reduced(container: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Only whether a file is a program is kept: no set-uid, no set-gid, no sticky bit, nothing unreadable."""
    modes = {"suid": 0o4755, "sgid": 0o2755, "sticky": 0o1777, "closed": 0o400, "open": 0o666}
    if container == "folder":
        path = as_folder(tmp_path / "x", dict.fromkeys(modes, ""))
        for name, mode in modes.items():
            (path / name).chmod(mode)
    elif container == "zip":
        path = tmp_path / "x.zip"
        with zipfile.ZipFile(path, "w") as archive:
            for name, mode in modes.items():
                info = zipfile.ZipInfo(name)
                info.external_attr = (stat.S_IFREG | mode) << 16
                archive.writestr(info, "")
    else:
        path = tmp_path / "x.tar"
        with tarfile.open(path, "w") as tar:
            add(tar, "folder", type=tarfile.DIRTYPE, mode=0o7000)
            for name, mode in modes.items():
                add(tar, name, mode=mode, uid=0, uname="root")
    take(path)
    found = {file.name: stat.S_IMODE(file.stat().st_mode) for file in unpacked.iterdir() if file.is_file()}
    assert found == {"suid": 0o755, "sgid": 0o755, "sticky": 0o755, "closed": 0o644, "open": 0o644}
    assert all(file.stat().st_uid == os.geteuid() for file in unpacked.iterdir())


def test_members_that_are_in_each_others_way(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Of two files of one name the later stays; a file never takes a folder's place, nor the reverse."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        add(archive, "a", b"1")
        add(archive, "a", b"2")
        add(archive, "a/b", b"3")
        add(archive, "c/d", b"4")
        add(archive, "c", b"5")
        add(archive, "a", type=tarfile.SYMTYPE, linkname="c/d")
        add(archive, "./", type=tarfile.DIRTYPE)
        add(archive, ".//c/./e", b"6")
    result = take(tmp_path / "x.tar")
    assert {name: (unpacked / name).read_text() for name in names(unpacked)} == {
        "a": "2",
        "c/d": "4",
        "c/e": "6",
    }
    assert noted(result, "the same name", "a/b, c, a -> c/d")


# --- bombs --------------------------------------------------------------------------------------------------


@pytest.fixture
def small_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clean_copy, "MOST_BYTES", 3_000_000)
    monkeypatch.setattr(clean_copy, "LARGEST_FILE", 1_000_000)
    monkeypatch.setattr(clean_copy, "MOST_MEMBERS", 1200)


def written(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


@pytest.mark.usefixtures("small_limits")
@pytest.mark.parametrize("container", CONTAINERS)
def test_a_file_that_is_too_large_is_left_out(container: str, tmp_path: Path, take: Take) -> None:
    """A recording that was handed in along with the package costs nothing but a note."""
    result = take(CONTAINERS[container](tmp_path / "x", WORKSPACE | {"bag/record.mcap": bytes(1_000_001)}))
    assert result.package == FOUND
    assert noted(result, "larger than 1 MB", "bag/record.mcap")


@pytest.mark.usefixtures("small_limits")
@pytest.mark.parametrize("container", CONTAINERS)
@pytest.mark.parametrize("size", [900_000, 1_100_000], ids=["allowed", "too-large"])
def test_many_bytes(container: str, size: int, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Twenty files are beyond the limit together, also if each of them is left out; little is written."""
    path = CONTAINERS[container](tmp_path / "x", {f"{n}.bin": bytes(size) for n in range(20)})
    with pytest.raises(SubmissionError, match=r"more than 3 MB; hand in only what you have written\."):
        take(path)
    assert written(unpacked) <= 3_000_000 + 65536


@pytest.mark.usefixtures("small_limits")
@pytest.mark.parametrize("container", CONTAINERS)
def test_many_files(container: str, tmp_path: Path, take: Take) -> None:
    """They are beyond the limit."""
    path = CONTAINERS[container](tmp_path / "x", {f"{n}.txt": "" for n in range(1300)})
    with pytest.raises(SubmissionError, match="more than 1200 files and folders"):
        take(path)


@pytest.mark.usefixtures("small_limits")
def test_many_folders_in_few_members(tmp_path: Path, take: Take) -> None:
    """Folders that are only on the way to a file count as well."""
    path = as_zip(tmp_path / "x", {"/".join([str(n)] * 35) + "/a": "" for n in range(40)})
    with pytest.raises(SubmissionError, match="more than 1200 files and folders"):
        take(path)


def test_a_tar_of_a_thousand_files(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """A large submission is received as it is."""
    files: Files = {f"data/{n % 10}/{n}.txt": f"{n}" * 10 for n in range(1000)}
    assert take(as_tar(tmp_path / "x", files | WORKSPACE, "gz")).package == FOUND
    assert names(unpacked) == files.keys() | WORKSPACE.keys()


@pytest.mark.usefixtures("small_limits")
def test_a_zip_bomb(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """100 MB in 100 kB: it is cut at the limit of one file, and the package beside it is graded."""
    path = as_zip(tmp_path / "x", WORKSPACE)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, archive.open("bomb", "w") as bomb:
        for _ in range(100):
            bomb.write(bytes(1_000_000))
    assert path.stat().st_size < 200_000
    result = take(path)
    assert result.package == FOUND
    assert noted(result, "larger than 1 MB", "bomb")
    assert written(unpacked) < 100_000


@pytest.mark.usefixtures("small_limits")
def test_a_zip_whose_members_share_their_bytes(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """Many entries in the list for one and the same file are counted as what they unpack to, or are refused."""
    name = b"a.bin"
    one = zip_bytes({"a.bin": bytes(900_000)})
    at = one.index(b"PK\1\2")
    entry = one[at : one.index(b"PK\5\6")]
    entries = b"".join(entry.replace(name, f"{n:05}".encode()) for n in range(1000))
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 1000, 1000, len(entries), at, 0)
    (tmp_path / "x.zip").write_bytes(one[:at] + entries + end)
    with pytest.raises(SubmissionError):
        take(tmp_path / "x.zip")
    assert written(unpacked) <= 3_065_536


def test_a_zip_with_an_endless_list(tmp_path: Path, take: Take) -> None:
    """A list of members that is larger than any student's is not read into memory."""
    entry = struct.pack("<4s6H3I5H2I", b"PK\1\2", *[0] * 9, 1, 0, 0, 0, 0, 0, 0) + b"a"
    entries = entry * (1 + (1 << 23) // len(entry))
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 0, 0, len(entries), 0, 0)
    (tmp_path / "x.zip").write_bytes(entries + end)
    (tmp_path / "y.zip").write_bytes(b"PK\3\4" + entries + end)
    for name in ("x.zip", "y.zip"):
        with pytest.raises(SubmissionError, match=r"is too long|neither a zip"):
            take(tmp_path / name)


@pytest.mark.usefixtures("small_limits")
def test_a_tar_that_unpacks_without_end(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """What is left out of a compressed tar has to be unpacked as well, and so it counts."""
    header = tarfile.TarInfo(".git/objects/huge")
    header.size = 8_000_000_000
    (tmp_path / "x.tar.bz2").write_bytes(bz2.compress(header.tobuf() + bytes(50_000_000)))
    with pytest.raises(SubmissionError, match="more than 3 MB"):
        take(tmp_path / "x.tar.bz2")
    assert written(unpacked) == 0


@pytest.mark.parametrize("kind", [tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.GNUTYPE_LONGNAME])
def test_a_tar_with_an_endless_header(kind: bytes, tmp_path: Path, take: Take) -> None:
    """What stands before a member is read into memory; one that is larger than any path is not read."""
    header = tarfile.TarInfo("x")
    header.type, header.size = kind, 100_000_000
    first = tarfile.TarInfo("a.txt").tobuf()
    (tmp_path / "x.tar.gz").write_bytes(gzip.compress(first + header.tobuf() + b"1" * 100_000_000, 1))
    with pytest.raises(SubmissionError, match="a header is too long"):
        take(tmp_path / "x.tar.gz")


@pytest.mark.usefixtures("small_limits")
@pytest.mark.parametrize("form", ["gnu", "posix", "oldgnu"])
def test_a_sparse_file(form: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """A hole of 100 GB in a tar of 10 kB, or on the disk, is cut."""
    folder = as_folder(tmp_path / "x", WORKSPACE)
    with (folder / "hole").open("wb") as file:
        file.truncate(100_000_000_000)
    # The folder itself first: its tree cannot be compared, for nobody can read the file.
    other = tmp_path / "other"
    other.mkdir()
    assert noted(receive(folder, other), "larger than 1 MB", "hole")
    subprocess.run(
        ["tar", f"--format={form}", "--sparse", "-czf", tmp_path / "x.tar.gz", "-C", folder, "."], check=True
    )
    shutil.rmtree(folder)
    shutil.rmtree(other)
    assert (tmp_path / "x.tar.gz").stat().st_size < 100_000
    result = take(tmp_path / "x.tar.gz")
    assert result.package == FOUND
    assert noted(result, "larger than 1 MB", "hole")
    assert written(unpacked) < 100_000


@pytest.mark.usefixtures("small_limits")
def test_bombs_in_archives(tmp_path: Path, take: Take, unpacked: Path) -> None:
    """The limits hold for all archives together."""
    inner = zip_bytes({"a.bin": bytes(900_000)})
    path = as_zip(tmp_path / "x", {f"{n}.zip": inner for n in range(20)})
    with pytest.raises(SubmissionError, match="more than 3 MB"):
        take(path)
    assert written(unpacked) <= 3_065_536


@pytest.mark.parametrize("container", ["folder", "zip", "tar.gz"])
def test_deep_folders_and_long_names(container: str, tmp_path: Path, take: Take, unpacked: Path) -> None:
    """They are left out and noted, and the rest is graded."""
    deep = "/".join("d" * 60)
    long = "/".join(["x" * 200] * 6)
    files: Files = WORKSPACE | {f"{deep}/a": "", f"{long}/a": ""}
    if container != "folder":
        files["y" * 300] = ""
    result = take(CONTAINERS[container](tmp_path / "x", files))
    assert result.package == FOUND
    assert names(unpacked) == set(WORKSPACE)
    assert noted(result, "too long or too deep", "d/d/d")


def test_a_folder_without_end(tmp_path: Path) -> None:
    """Folders in folders, deeper than any path can be, are followed only a little."""
    start = os.open(tmp_path, os.O_RDONLY)
    here = os.dup(start)
    (tmp_path / "out").mkdir()
    try:
        for _ in range(1000):
            os.mkdir("deep", dir_fd=here)
            inner = os.open("deep", os.O_RDONLY, dir_fd=here)
            os.close(here)
            here = inner
        (tmp_path / "deep" / "a.txt").write_text("a")
        assert noted(receive(tmp_path / "deep", tmp_path / "out"), "too long or too deep")
        assert names(tmp_path / "out") == {"a.txt"}
    finally:
        os.close(here)
        os.close(start)
        subprocess.run(["rm", "-rf", tmp_path / "deep"], check=True)


def test_many_links(tmp_path: Path, take: Take, unpacked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A long chain of links ends, and too many are beyond the limit; those in build do not count."""
    with tarfile.open(tmp_path / "x.tar", "w") as archive:
        add(archive, "l900", b"end")
        add(archive, "build/COLCON_IGNORE")
        for number in range(900):
            add(archive, f"l{number}", type=tarfile.SYMTYPE, linkname=f"l{number + 1}")
            add(archive, f"build/l{number}", type=tarfile.SYMTYPE, linkname="/etc")
    result = take(tmp_path / "x.tar")
    assert noted(result, "nothing that was handed in", "more")
    kept = {path.name for path in unpacked.iterdir() if path.is_symlink()}
    assert "l899" in kept
    assert all((unpacked / name).read_text() == "end" for name in kept)
    monkeypatch.setattr(clean_copy, "MOST_LINKS", 899)
    (tmp_path / "unpacked2").mkdir()
    with pytest.raises(SubmissionError, match="more than 899 links"):
        receive(tmp_path / "x.tar", tmp_path / "unpacked2")


def test_what_is_endless_to_unpack_is_given_up(
    take: Take, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clean_copy, "MOST_CPU", -1.0)
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr("x.py", "x = 1")
    with pytest.raises(SubmissionError, match="takes more than -1 s of CPU time; pack it"):
        take(tmp_path / "x.zip")


# What a build leaves, by the folder in which it lies.
MADE = {
    "build": {".built_by": "colcon", "COLCON_IGNORE": "", "robot_controller/colcon_build.rc": "0"},
    "build without its mark": {"COLCON_IGNORE": "", "robot_controller/colcon_build.rc": "0"},
    "build of one package": {"colcon_build.rc": "0", "build/lib/robot_controller/x.py": ""},
    "build with copies for links": {
        "robot_controller/colcon_build.rc": "0",
        **below("robot_controller", package()),
    },
    "install": {
        ".colcon_install_layout": "isolated",
        "robot_controller/share/robot_controller/package.xml": "<package/>",
        "robot_controller/lib/python3.12/site-packages/robot_controller/x.py": "",
    },
    "install without its mark": {"local_setup.bash": "", "_local_setup_util_sh.py": ""},
    "install of one package": {
        "share/colcon-core/packages/robot_controller": "",
        "share/robot_controller/package.xml": "",
    },
    "install of which no mark is left": {
        "share/ament_index/resource_index/packages/robot_controller": "",
        "share/robot_controller/package.xml": "",
        "lib/robot_controller/status": "",
    },
    "log": {"COLCON_IGNORE": "", "build_2026-01-01_10-00-00/events.log": "", "build_2026-01-01_10-00-00/logger_all.log": ""},
    "log of one run": {"events.log": "", "logger_all.log": ""},
    "metadata": {"PKG-INFO": "Metadata-Version: 2.1"},
    "metadata of what is installed": {"METADATA": "", "RECORD": ""},
}  # fmt: skip
# What only looks so, and was written by hand.
WRITTEN = {
    "a package that is ignored": {"COLCON_IGNORE": "", **package("old_controller")},
    "notes that are ignored": {"COLCON_IGNORE": "", "notes.md": "x"},
    "own log": {"events.log": "", "notes.md": ""},
    "own logs of runs": {"run_1/status.log": "", "run_1/velocity.log": "", "run_2.txt": ""},
    "a script for the shell": {"setup.bash": "", "local_setup.bash": ""},
    "an unpacked source distribution": {"PKG-INFO": "", **package("old_controller")},
    "a workspace that was built in itself": {
        ".built_by": "colcon",
        ".colcon_install_layout": "isolated",
        **below("src/old_controller", package("old_controller")),
    },
}


@pytest.mark.parametrize("where", ["old", "src/robot_controller/old.d", "src/x"])
@pytest.mark.parametrize("name", MADE)
def test_what_a_build_leaves_is_left_out_whatever_it_is_called(
    name: str, where: str, tmp_path: Path, take: Take, unpacked: Path
) -> None:
    result = take(as_folder(tmp_path / "anna", below("ws", WORKSPACE | below(where, MADE[name]))))
    assert names(unpacked) == {f"ws/{name}" for name in WORKSPACE}
    assert result.noted("by a build") == [f"ws/{where}"]
    assert [one.name for one in result.packages] == ["robot_controller"]


@pytest.mark.parametrize(
    ("where", "name"),
    [
        *itertools.product(["old", "src/x"], WRITTEN),
        *itertools.product(["log", "build"], ["own logs of runs"]),
    ],
)
def test_what_has_no_mark_of_a_build_or_a_source_in_it_stays(
    name: str, where: str, tmp_path: Path, take: Take, unpacked: Path
) -> None:
    files = below("ws", WORKSPACE | below(where, WRITTEN[name]))
    result = take(as_folder(tmp_path / "anna", files))
    assert names(unpacked) == {*files}
    assert result.noted("by a build") == []


def _compiled() -> bytes:
    return importlib.util.MAGIC_NUMBER + bytes(12) + marshal.dumps(compile("x = 1", "x.py", "exec"))


def _tar_gz(files: Mapping[str, str]) -> bytes:
    target = io.BytesIO()
    with tarfile.open(fileobj=target, mode="w:gz") as archive:
        for name, text in files.items():
            add(archive, name, data(text))
    return target.getvalue()


OF_NODE = {"robot_controller/node_0.py": ""}
# Files by what made them, and files like them that somebody wrote or brought along.
MADE_FILES: Mapping[str, bytes] = {
    "compiled Python": _compiled(),
    "an extension": b"\x7fELF\2\1\1" + bytes(70_000) + b"PyInit_fast\0",
    "a wheel": zip_bytes(OF_NODE | {"robot-1.dist-info/METADATA": "", "robot-1.dist-info/RECORD": ""}),
    "a source distribution": _tar_gz({"robot-1/PKG-INFO": ""} | below("robot-1", OF_NODE)),
    "a workspace that was built": zip_bytes(WORKSPACE | BUILT | {"build/rc/colcon_build.rc": "0"}),
}
OWN_FILES: Mapping[str, bytes] = {
    "text": b"ab\r\n\r\nc",
    "a library": b"\x7fELF\2\1\1" + bytes(100) + b"lidar_open\0",
    "a workspace": zip_bytes(WORKSPACE),
    "a wheel of others": zip_bytes({"serial/x.py": "", "serial-1.dist-info/METADATA": "", "serial-1.dist-info/RECORD": ""}),
    "a broken archive": b"PK\3\4 and no more",
}  # fmt: skip


@pytest.mark.parametrize("what", [*MADE_FILES, *OWN_FILES])
def test_what_python_or_a_build_makes_is_known_by_what_is_in_it(
    what: str, tmp_path: Path, take: Take
) -> None:
    name = "src/robot_controller/robot_controller/data.bin"
    data = {**MADE_FILES, **OWN_FILES}[what]
    result = take(as_folder(tmp_path / "anna", {**WORKSPACE, name: data}))
    assert result.noted("made") == ([name] if what in MADE_FILES else [])


def test_all_that_keeps_a_hand_in_from_being_graded_is_named(tmp_path: Path, take: Take) -> None:
    """Each archive with its own cause, and not the first one alone."""
    folder = as_folder(tmp_path / "anna", {"report.pdf": b""})
    (folder / "report.pdf").unlink()
    (folder / "one.zip").write_bytes(b"PK\3\4 and no more")
    (folder / "two.tar.gz").write_bytes(b"\x1f\x8b and no more")
    (folder / "three.7z").write_bytes(b"7z\xbc\xaf\x27\x1c and no more")
    with pytest.raises(SubmissionError) as said:
        take(folder)
    assert all(
        name in str(said.value)
        for name in ("one.zip is broken", "two.tar.gz is broken", "three.7z is a 7-Zip")
    )


def test_of_a_damaged_tar_the_damage_is_named_beside_what_is_too_large(
    tmp_path: Path, take: Take, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ros2lab.grading.receiving.clean_copy.LARGEST_FILE", 20_000)
    packed = as_tar(
        tmp_path / "all", {"ws/large.bin": b"x" * 30_000, "ws/a.py": b"import rclpy\n"}
    ).read_bytes()
    folder = as_folder(tmp_path / "anna", {"report.pdf": b""})
    (folder / "report.pdf").unlink()
    (folder / "all.tar.gz").write_bytes(gzip.compress(_damaged(packed, packed.index(b"ws/a.py"))))
    with pytest.raises(
        SubmissionError, match=r"larger than .*large\.bin.*all\.tar\.gz is broken or incomplete"
    ):
        take(folder)
