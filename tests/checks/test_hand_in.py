"""The checks of `10_hand_in`: a hand-in that is complete and true passes, and what is missing is named."""

from __future__ import annotations

import dataclasses
import shutil
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from ros2lab import course, hand_in, observed_domain
from ros2lab.checks import CheckError
from ros2lab.checks import hand_in as check
from ros2lab.hand_in import Evidence, Heard
from ros2lab.workspace import Workspace

README = """
`status_publisher` tells on /robot/status, `command_subscriber` obeys /robot/command, `velocity_publisher`
drives on /cmd_vel.
    colcon build
    source install/setup.bash
    ros2 run robot_controller status_publisher
"""
MOVING = Heard("geometry_msgs/msg/Twist", 50, 10.02, "linear.x 0.5", True)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A built copy of the reference workspace; a test gets a copy of it."""
    workspace = Workspace(course.copy_reference(tmp_path_factory.mktemp("reference")))
    assert workspace.build(show=False).is_ok
    return workspace.path


@pytest.fixture
def workspace(built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Workspace]:
    """A student's workspace with README and evidence, not yet in git."""
    home = tmp_path / "my work"
    monkeypatch.setenv("ROS2LAB_WORK", str(home))
    shutil.copytree(built, home / "robot_project_ws", symlinks=True)
    folder = home / "robot_project_ws"
    (folder / "README.md").write_text(README)
    (folder / "EVIDENCE.md").write_text("# Evidence\n")
    return Workspace(folder)


def evidence_of(workspace: Workspace, **changes: object) -> Evidence:
    """Evidence as a right package gives it, with changes."""
    right = Evidence(
        dict.fromkeys(("command_subscriber", "status_publisher", "velocity_publisher"), "runs"),
        ["/command_subscriber", "/status_publisher", "/velocity_publisher"],
        {
            "/cmd_vel": MOVING,
            "/robot/status": Heard("std_msgs/msg/String", 3, 0.5, "state=idle", False),
        },
        {"/robot/command": ["std_msgs/msg/String"]},
        [f"[INFO] [command_subscriber]: Received '{word}'" for word in hand_in.COMMANDS],
        workspace.path / "EVIDENCE.md",
    )
    return dataclasses.replace(right, **changes)  # type: ignore[arg-type]


def git(workspace: Workspace, *words: str) -> None:
    name = ("-c", "user.name=Ada", "-c", "user.email=ada@example.org")
    subprocess.run(["git", *name, *words], cwd=workspace.path, check=True, capture_output=True)


def commit(workspace: Workspace, ignored: str = "build/\ninstall/\nlog/\n") -> None:
    (workspace.path / ".gitignore").write_text(ignored)
    git(workspace, "init", "-q")
    git(workspace, "add", ".")
    git(workspace, "commit", "-q", "-m", "All of it")


def test_evidence_is_what_was_seen(built: Path, workspace: Workspace) -> None:
    """The package really runs; what is written has its headings, and an earlier file is kept."""
    Path(workspace.path / "EVIDENCE.md").write_text("my own notes")
    workspace = Workspace(built)  # where it was built
    found = hand_in.collect_evidence(workspace)
    assert set(found.programs.values()) == {"runs"}
    assert len(found.nodes) == 3
    assert set(hand_in.TOPICS) <= set(found.topics)
    velocity = found.published["/cmd_vel"]
    assert velocity.has_moved
    assert velocity.count > 10
    assert check.evidence(found, velocity.rate).startswith("Right")
    first = found.file.read_text()
    headings = [line for line in first.splitlines() if line.startswith("#")]
    assert headings == [
        "# Evidence",
        "## Executables",
        "## Nodes",
        "## Topics published",
        "## Topics listened to",
        "## Log",
    ]
    assert "Received 'reset'" in first
    facts = hand_in.measure(workspace, found)
    assert all(facts[part] for part in hand_in.POINTS)
    assert all(facts["velocity publisher"].values())
    hand_in._write_kept(found.file, "another one")
    assert [path.read_text() for path in course.earlier_folder().iterdir()] == [first]


@pytest.mark.parametrize("rate", [10, 10.0, 9.7])
def test_right_evidence(workspace: Workspace, rate: float) -> None:
    """A number near the measured one."""
    assert check.evidence(evidence_of(workspace), rate).startswith("Right")


@pytest.mark.parametrize(
    ("changes", "rate", "hint"),
    [
        ({}, (), "the rate of /cmd_vel"),
        ({}, 2, "the rate of /cmd_vel"),
        ({}, "10 Hz", "the rate of /cmd_vel"),
        ({"programs": {}}, 10, "there are no executables"),
        ({"programs": {"status_publisher": "ended: NameError"}}, 10, "status_publisher ended: NameError"),
        ({"subscribed": {}}, 10, "Found: /cmd_vel, /robot/status"),
        (
            {
                "published": {"/robot/status": Heard("T", 3, 0.5, "", False)},
                "subscribed": {"/cmd_vel": ["T"], "/robot/command": ["T"]},
            },
            10,
            "a node that publishes /cmd_vel. Found: none does",
        ),
        (
            {"published": {"/cmd_vel": MOVING}, "subscribed": {topic: ["T"] for topic in hand_in.TOPICS}},
            10,
            "a node that publishes /robot/status. Found: none does",
        ),
        (
            {"published": dict.fromkeys(hand_in.TOPICS, MOVING), "subscribed": {}},
            10,
            "a node that listens to /robot/command. Found: none does",
        ),
        (
            {
                "published": {
                    "/cmd_vel": Heard("T", 0, None, "", False),
                    "/robot/status": Heard("T", 0, None, "", False),
                }
            },
            10,
            "messages on",
        ),
    ],
    ids=range(10),
)
def test_wrong_evidence(workspace: Workspace, changes: dict[str, object], rate: object, hint: str) -> None:
    """Nothing runs, something ended, a topic is missing or silent, the file was not read."""
    with pytest.raises(CheckError, match=hint):
        check.evidence(evidence_of(workspace, **changes), rate)
    with pytest.raises(CheckError):
        check.evidence(None, rate)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "ignored",
    ["build/\ninstall/\nlog/\n", "build\ninstall\nlog\n*.pyc\n", "/*\n!/src\n!/*.md\n!/.gitignore\n"],
)
def test_a_right_repository(workspace: Workspace, ignored: str) -> None:
    """However .gitignore says it."""
    commit(workspace, ignored)
    assert check.repository(workspace).startswith("Right")
    assert check.committed(workspace).startswith("Right")


def test_wrong_repositories(workspace: Workspace) -> None:
    """None, an enclosing one, no commit, built files in it, a .gitignore with a gap, and no package."""
    with pytest.raises(CheckError, match="Found: none"):
        check.repository(workspace)
    outer = Workspace(workspace.path.parent)
    git(outer, "init", "-q")
    with pytest.raises(CheckError, match="Found: the one in"):
        check.repository(workspace)
    git(workspace, "init", "-q")
    with pytest.raises(CheckError, match="Found: none yet"):
        check.repository(workspace)
    commit(workspace, "build/\nlog/\n")
    with pytest.raises(CheckError, match="nothing that was built is in git"):
        check.repository(workspace)
    git(workspace, "rm", "-r", "-q", "--cached", "install")
    git(workspace, "commit", "-q", "-m", "Take it out")
    with pytest.raises(CheckError, match="Found: 2 of them"):
        check.repository(workspace)
    git(workspace, "rm", "-r", "-q", "--cached", "src")
    git(workspace, "commit", "-q", "-m", "Take too much out")
    with pytest.raises(CheckError, match=r"no package\.xml"):
        check.repository(workspace)


def test_what_is_not_committed(workspace: Workspace) -> None:
    """A changed file, a new one, a README or evidence outside of git."""
    commit(workspace)
    (workspace.path / "README.md").write_text("changed")
    with pytest.raises(CheckError, match="1 changed or unknown files, the first M README"):
        check.committed(workspace)
    git(workspace, "checkout", "README.md")
    (workspace.path / "notes.txt").touch()
    with pytest.raises(CheckError, match=r"\?\? notes\.txt"):
        check.committed(workspace)
    for name in ("EVIDENCE.md", "README.md"):
        git(workspace, "rm", "-q", "--cached", name)
        git(workspace, "commit", "-q", "-m", "Take it out")
        with pytest.raises(CheckError, match=f"{name[:-3]}.md is in git"):
            check.committed(workspace)


@pytest.mark.parametrize(
    "text",
    [
        README,
        README + "    ros2 launch robot_controller robot.launch.py\n    ros2 topic echo --once /cmd_vel\n",
        README.replace(
            "ros2 run robot_controller status_publisher", "ros2 launch robot_controller robot.launch.py"
        ),
        README + "Type ros2 run robot_controller velocity_publisher. Then ros2 topic hz /cmd_vel.\n",
        README + "    ros2 run turtlesim turtlesim_node\n    ros2 topic echo /turtle1/pose\n",
        README + "    ros2 run demo_nodes_cpp talker\n    ros2 launch my_robot_controller all.launch.py\n",
        README + "    ros2 topic echo /rosout\n    ros2 topic echo /parameter_events\n",
        README.replace("install/setup.bash", "install/local_setup.zsh"),
    ],
    ids=range(8),
)
def test_a_right_readme(workspace: Workspace, text: str) -> None:
    """By `ros2 run` or by `ros2 launch`, at the end of a sentence, and with what other packages have."""
    (workspace.path / "README.md").write_text(text)
    assert check.readme(workspace, evidence_of(workspace)).startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("/robot/status", "/status", "the topic /robot/status"),
        ("command_subscriber", "commander", "the executable command_subscriber"),
        ("colcon build", "make", "with colcon build"),
        ("source install/setup.bash", "", "install/setup.bash"),
        ("ros2 run robot_controller status_publisher", "", "with ros2 run or ros2 launch"),
        ("ros2 run robot_controller", "ros2 run robot_controler", "the package is called robot_controller"),
        ("ros2 run robot_controller", "ros2 run robot-controller", "the package is called robot_controller"),
        (
            "    ros2 run",
            "    ros2 run turtlesim turtlesim_node\n    ros2 topic echo /cmdvel\n    ros2 run",
            "the topic /cmdvel",
        ),
        (
            "ros2 run robot_controller status_publisher",
            "ros2 run robot_controller status",
            "commands that are true",
        ),
        (
            "ros2 run robot_controller status_publisher",
            "ros2 launch robot_controller all.launch.py",
            "no such file",
        ),
        ("\n    colcon", "\n    ros2 topic echo /cmdvel\n    colcon", "a command with the topic /cmdvel"),
    ],
)
def test_a_wrong_readme(workspace: Workspace, old: str, new: str, hint: str) -> None:
    """What is missing and what is not true is named."""
    assert old in README
    (workspace.path / "README.md").write_text(README.replace(old, new))
    with pytest.raises(CheckError, match=hint):
        check.readme(workspace, evidence_of(workspace))


def test_a_self_assessment(workspace: Workspace) -> None:
    """Points near those measured are right; missing, too many, too high and too low ones are not."""
    commit(workspace)
    right = dict(hand_in.POINTS)
    facts = hand_in.measure(workspace, evidence_of(workspace))
    assert all(all(part.values()) for part in facts.values()), facts
    for claims in (right, {**right, "bonus": 5}, {part: float(most) for part, most in right.items()}):
        assert check.self_assessment(claims, facts).startswith("Right")
    for claims, hint in (
        ({}, "points for 'workspace'"),
        ({**right, "bonus": 11}, "from 0 to 10"),
        ({**right, "bonus": "all"}, "from 0 to 10"),
        ({**right, "status publisher": 5}, "claim what is yours"),
        ({**right, "beauty": 5}, "also 'beauty'"),
        (100, "in braces"),
    ):
        with pytest.raises(CheckError, match=hint):
            check.self_assessment(claims, facts)  # type: ignore[arg-type]
    facts["velocity publisher"] = dict.fromkeys(facts["velocity publisher"], False)
    with pytest.raises(CheckError, match="it was not seen that a Twist"):
        check.self_assessment(right, facts)


def test_right_archives(workspace: Workspace, tmp_path: Path) -> None:
    """Packed here, twice, and by another program; linked sources are in it, and nothing built."""
    moved = tmp_path / "elsewhere"
    package = workspace.path / "src" / "robot_controller"
    package.rename(moved)
    package.symlink_to(moved)
    (package / "robot_controller" / "__pycache__").mkdir(exist_ok=True)
    (package / "robot_controller" / "__pycache__" / "old.pyc").touch()
    first, second = hand_in.pack(workspace, "Ada Lovelace"), hand_in.pack(workspace, "Ada Lovelace")
    assert (first.name, second.name) == (
        "Ada_Lovelace_robot_project_ws_1.zip",
        "Ada_Lovelace_robot_project_ws_2.zip",
    )
    names = zipfile.ZipFile(first).namelist()
    assert "robot_project_ws/src/robot_controller/package.xml" in names
    assert not [name for name in names if "pycache" in name or "/install/" in name or "/.git/" in name]
    assert check.archive(first).startswith("Right")
    for folder in ("build", "install", "log"):
        shutil.rmtree(workspace.path / folder)
    shutil.rmtree(package / "robot_controller" / "__pycache__")
    package.unlink()
    moved.rename(package)
    by_hand = shutil.make_archive(str(tmp_path / "by_hand"), "zip", workspace.path)
    assert check.archive(by_hand).startswith("Right")
    with_top = shutil.make_archive(str(tmp_path / "top"), "zip", workspace.path.parent, workspace.path.name)
    assert "robot_project_ws/" in zipfile.ZipFile(with_top).namelist()
    assert check.archive(with_top).startswith("Right")


def test_wrong_archives(workspace: Workspace, tmp_path: Path) -> None:
    """No archive, a blank in its name, built files, no README, no package, and one that does not build."""
    for nothing in ((), None, str(workspace.path)):
        with pytest.raises(CheckError, match="the path of a zip file"):
            check.archive(nothing)
    good = hand_in.pack(workspace)
    with pytest.raises(CheckError, match="a name without blanks"):
        check.archive(shutil.copy(good, tmp_path / "my work.zip"))
    everything = shutil.make_archive(str(tmp_path / "everything"), "zip", workspace.path)
    with pytest.raises(CheckError, match="only what you have written"):
        check.archive(everything)
    for made in ("src/build", "src/robot_controller/install"):
        bad = shutil.copy(good, tmp_path / f"with_{Path(made).name}.zip")
        with zipfile.ZipFile(bad, "a") as target:
            target.writestr(f"robot_project_ws/{made}/COLCON_IGNORE", "")
            target.writestr(f"robot_project_ws/{made}/robot_controller/some.py", "")
        with pytest.raises(
            CheckError, match=f"2 files, the first {made}.*colcon was run in the wrong folder"
        ):
            check.archive(bad)
    for lost, hint in (
        ("README.md", "README"),
        ("EVIDENCE.md", "EVIDENCE"),
        ("package.xml", "src/ with a package"),
        ("resource/robot_controller", "it builds where it is unpacked"),
    ):
        bad = tmp_path / f"without_{Path(lost).name}.zip"
        with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w") as target:
            for name in source.namelist():
                if not name.endswith(lost):
                    target.writestr(name, source.read(name))
        with pytest.raises(CheckError, match=hint):
            check.archive(bad)


def test_practices_are_counted(workspace: Workspace) -> None:
    """Of each practice how often it holds, and where it first does not."""
    inner = workspace.path / "src" / "robot_controller" / "robot_controller"
    shutil.rmtree(inner)
    inner.mkdir()
    (inner / "node.py").write_text(
        "class badName:\n    def Tell(self, x):\n        try:\n            print(x)\n        except:\n"
        "            self.log.info(x)\n\n\ndef right(x: int) -> None:\n    '''Do it.'''\n"
        f"    pass  # {'x' * 88}\n"
    )
    (inner / "torn.py").write_text("def torn(:\n")
    rows = {name: (count, place) for name, count, place in hand_in.practices(workspace).rows}
    assert rows == {
        "names as in PEP 8": ("1 of 3", "node.py:1"),
        "docstrings of modules and classes": ("0 of 2", "node.py:1"),
        "type hints": ("1 of 2", "node.py:2"),
        "logger and not print": ("1 of 2", "node.py:4"),
        "exceptions caught by name": ("0 of 1", "node.py:5"),
        "lines up to 99 characters": ("10 of 11", "node.py:11"),
        "can be read as Python": ("0 of 1", "torn.py:1"),
    }


USUAL = """
class Driver(Node):
    '''Drive on.'''

    def obey(self, message):
        try:
            self.speed = float(message.data)
        except ValueError as error:
            self.get_logger().warning(str(error))
"""
FUNCTIONS = """
import sys

def main():
    node = rclpy.create_node("driver")
    log = node.get_logger()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        log.info("The end")
    except Exception:
        print("It cannot go on.", file=sys.stderr)
        raise
"""
OTHER_PRINTS = f"""
LONG = "{"ö" * 90}"
console.print("This is no print, and neither is the next one.")
blueprint(1)
"""


@pytest.mark.parametrize("text", [USUAL, FUNCTIONS, OTHER_PRINTS, ""], ids=range(4))
def test_right_practices(workspace: Workspace, text: str) -> None:
    """With classes and without, errors under many names, an empty __init__.py, and prints that are none."""
    inner = package_with(workspace, f"'''Drive the robot.'''\n{text}")
    (inner / "__init__.py").touch()
    assert check.practices(workspace).startswith("Right")


def test_the_reference_has_right_practices(workspace: Workspace) -> None:
    assert check.practices(workspace).startswith("Right")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "self.get_logger().warning(str(error))",
            "print(error)",
            r"no print.* Found: nodes/driver\.py:10\. ",
        ),
        ("class Driver", "print(1)\nclass Driver", r"no print.* Found: nodes/driver\.py:3\. "),
        ("except ValueError as error", "except", r"no bare `except:`\. Found: nodes/driver\.py:9\. "),
        ("'''Drive the robot.'''", "import rclpy", r"a docstring .* Found: nodes/driver\.py:1\. "),
        ("'''Drive on.'''", "speed = 0.0", r"a docstring .* Found: nodes/driver\.py:3\. "),
        ("'''Drive on.'''", "# Drive on.", r"a docstring .* Found: nodes/driver\.py:3\. "),
        ("Drive on.", "Drive on " * 11, r"than 99 characters\. Found: nodes/driver\.py:4\. "),
        ("try:", "try", r"Python can read\. Found: nodes/driver\.py:7\. "),
        (
            "self.speed = float(message.data)",
            "print(1)\n            print(2)",
            r"no print.* Found: nodes/driver\.py:8 and 1 more\. Hint",
        ),
    ],
)
def test_wrong_practices(workspace: Workspace, old: str, new: str, said: str) -> None:
    """A print, a bare except, no docstring, a long line, and no Python: each is told with its place."""
    text = f"'''Drive the robot.'''\n{USUAL}"
    assert old in text
    inner = package_with(workspace, "")
    (inner / "nodes").mkdir()
    (inner / "nodes" / "driver.py").write_text(text.replace(old, new))
    with pytest.raises(CheckError, match=said):
        check.practices(workspace)


def test_practices_of_nothing(workspace: Workspace) -> None:
    shutil.rmtree(workspace.path / "src")
    with pytest.raises(CheckError, match="modules in src/robot_controller/robot_controller"):
        check.practices(workspace)


def package_with(workspace: Workspace, text: str) -> Path:
    """Leave one module in the package; return the folder of its modules."""
    inner = workspace.path / "src" / "robot_controller" / "robot_controller"
    shutil.rmtree(inner)
    inner.mkdir()
    (inner / "driver.py").write_text(text)
    return inner


@pytest.mark.parametrize("made", ["src/build", "src/robot_controller/install"])
def test_colcon_in_the_wrong_folder(workspace: Workspace, made: str) -> None:
    """What it has built there is not to be in git; the archive leaves it out."""
    (workspace.path / made).mkdir()
    (workspace.path / made / "COLCON_IGNORE").touch()
    commit(workspace, "/build/\n/install/\n/log/\n")
    with pytest.raises(CheckError, match=f"1 files, the first {made}.*colcon was run in the wrong folder"):
        check.repository(workspace)
    assert not [name for name in zipfile.ZipFile(hand_in.pack(workspace)).namelist() if "COLCON" in name]


def test_a_source_folder_may_be_called_log(workspace: Workspace) -> None:
    """Only what colcon has made is built."""
    module = workspace.path / "src" / "robot_controller" / "robot_controller" / "log" / "__init__.py"
    module.parent.mkdir()
    module.write_text("")
    commit(workspace, "/build/\n/install/\n/log/\n")
    assert check.repository(workspace).startswith("Right")
    assert check.archive(hand_in.pack(workspace)).startswith("Right")


def test_a_fact_is_measured_in_one_way(workspace: Workspace) -> None:
    """What a check takes for right is measured as right, however it is written; and what is wrong, as wrong."""
    commit(workspace, "/*\n!/src\n!/*.md\n!/.gitignore\n")
    (workspace.path / "README.md").rename(workspace.path / "Readme.txt")
    (workspace.path / "EVIDENCE.md").touch()
    facts = hand_in.measure(workspace, evidence_of(workspace))
    assert facts["workspace"]["git ignores build, install and log"]
    assert facts["documentation"]["README says how to build and run"]
    assert check.readme(workspace, evidence_of(workspace)).startswith("Right")
    inner = package_with(workspace, "try:\n    pass\nexcept:\n    # unlike except ValueError\n    pass\n")
    facts = hand_in.measure(workspace, evidence_of(workspace))
    assert not facts["bonus"]["errors are caught by name"]
    (inner / "driver.py").write_text("try:\n    pass\nexcept errors.of_mine:\n    pass\n")
    facts = hand_in.measure(workspace, evidence_of(workspace))
    assert facts["bonus"]["errors are caught by name"]


@pytest.mark.parametrize(
    ("rate", "holds"), [(0.5, True), (0.42, True), (0.62, True), (0.4, False), (0.65, False)]
)
def test_every_two_seconds_is_within_a_fifth(workspace: Workspace, rate: float, holds: bool) -> None:
    published = {"/robot/status": Heard("std_msgs/msg/String", 3, rate, "", False)}
    facts = hand_in.measure(workspace, evidence_of(workspace, published=published))
    assert facts["status publisher"]["every 2 s"] is holds


def nodes(workspace: Workspace, velocity: str) -> None:
    """Let the built package have one executable, a node that drives as told."""
    for script in (workspace.path / "install/robot_controller/lib/robot_controller").iterdir():
        if script.name == "velocity_publisher":
            script.write_text(f"{script.read_text().splitlines()[0]}\n{NODE.format(velocity=velocity)}")
        else:
            script.unlink()


NODE = """
import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("robot")
words, twist = [], Twist()
node.create_subscription(String, "/robot/command", lambda message: words.append(message.data), 10)
status = node.create_publisher(String, "/robot/status", 10)
velocity = node.create_publisher(Twist, "/cmd_vel", 10)

def drive():
    twist.linear.x = float({velocity})
    velocity.publish(twist)
    status.publish(String(data="well"))

node.create_timer(0.05, drive)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""


@pytest.mark.parametrize(
    ("velocity", "has_moved"),
    [("words[-1:] == ['start']", True), ("words[-1:] in (['stop'], ['reset'])", False), ("not words", False)],
)
def test_moving_is_moving_after_start(
    built: Path, kept: None, velocity: str, has_moved: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not before the first command, and not after another one."""
    workspace = Workspace(built)
    nodes(workspace, velocity)
    monkeypatch.setattr(hand_in, "OBSERVED", 0.5)
    found = hand_in.collect_evidence(workspace)
    assert found.programs == {"velocity_publisher": "runs"}
    assert found.published["/cmd_vel"].has_moved is has_moved
    assert hand_in.measure(workspace, found)["velocity publisher"]["it moves after start"] is has_moved


def test_a_type_that_cannot_be_imported_is_listed(
    built: Path, kept: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A message of the student's own, which the notebook has not sourced."""

    def find(name: str) -> type:
        if name == "geometry_msgs/msg/Twist":
            raise ValueError(f"The message type {name!r} cannot be imported.")
        return find_type(name)

    find_type = observed_domain.find_type
    monkeypatch.setattr(observed_domain, "find_type", find)
    monkeypatch.setattr(hand_in, "OBSERVED", 0.5)
    workspace = Workspace(built)
    nodes(workspace, "1")
    found = hand_in.collect_evidence(workspace)
    assert found.published["/cmd_vel"] == Heard("geometry_msgs/msg/Twist", None, None, "nothing", False)
    assert found.published["/robot/status"].count
    assert "| /cmd_vel | geometry_msgs/msg/Twist | - | - | nothing |" in found.file.read_text()
    with pytest.raises(CheckError, match="messages on /cmd_vel"):
        check.evidence(found, 0)


@pytest.fixture
def kept(built: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Put back what a test changes in the built workspace, which knows the folder in which it was built."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    shutil.copytree(built, tmp_path / "kept", symlinks=True)
    yield
    shutil.rmtree(built)
    shutil.move(tmp_path / "kept", built)
