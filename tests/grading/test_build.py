"""Submissions built by the real colcon in the real sandbox, and how each program of theirs can be started."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest
from test_files import (
    MANIFEST,
    REFERENCE,
    SETUP,
    SETUP_CFG,
    VELOCITY,
    Texts,
    by_glob,
    everything_in_setup_cfg,
    right_package,
    src_layout,
    sub_packages,
    write,
)

from ros2lab import assignments
from ros2lab.build_report import BuildResult, PackageResult
from ros2lab.grading.building import colcon_build, programs
from ros2lab.grading.building.build import build
from ros2lab.grading.evidence import Build, Executable
from ros2lab.grading.reading import build_plan
from ros2lab.grading.reading.boxed import read
from ros2lab.grading.receiving.submission import FoundPackage, copied
from ros2lab.grading.sandbox.box import Box, Limits
from ros2lab.grading.sandbox.worlds import ENVIRON, FILES, World, underlay
from ros2lab.grading.watching.observe import SHOWN

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="bubblewrap is for Linux")

LIMITS = Limits(wall_s=120, cpu_s=60, memory_bytes=500_000_000, processes=64, disk_bytes=50_000_000)
# A node that says that it was started, and ends.
TALKER = "import rclpy\nimport sys\n\n\ndef main(args=None):\n    rclpy.init(args=args)\n    print('started', *sys.argv[1:])\n"


class Built:
    """What was built, in a World that is still there to run it."""

    def __init__(self, world: World, build: Build) -> None:
        self.world, self.build = world, build

    def __getitem__(self, name: str) -> Executable:
        (found,) = [one for one in self.build.executables if one.name == name]
        return found

    def run(self, name: str, *arguments: str) -> Box:
        return self.world.run([*self[name].command, *arguments], environ=self.build.environ)

    @property
    def faults(self) -> dict[str, str]:
        return {one.name: one.fault for one in self.build.executables}


@pytest.fixture
def make(tmp_path: Path) -> Iterator[Callable[..., Built]]:
    """Receive what is handed in, and build it."""
    worlds = []

    def make(given: Texts | Path, limits: Limits = LIMITS) -> Built:
        number = len(worlds)
        path = given if isinstance(given, Path) else write(tmp_path / f"handed_in{number}", given)
        root = tmp_path / f"received{number}"
        root.mkdir()
        received = copied(path, root)
        world = World(root, shown=SHOWN, limits=limits)
        worlds.append(world)
        found = read(world, received, assignments.load())
        return Built(world, build(world, found.submission, found.plan))

    yield make
    for world in worlds:
        world.close()


# Right packages.


def test_the_reference_is_built_and_its_executables_have_no_fault(make: Callable[..., Built]) -> None:
    made = make(REFERENCE)
    assert (made.build.is_built, made.build.error, made.build.warnings, made.build.notes) == (
        True,
        "",
        [],
        [],
    )
    assert made.faults == dict.fromkeys(("command_subscriber", "status_publisher", "velocity_publisher"), "")
    assert {one.way for one in made.build.executables} == {"installed"}
    assert made.build.shared == ["config/robot.yaml", "launch/robot.launch.py"]
    assert sourced(made) == made.build.environ


def sourced(made: Built) -> dict[str, str]:
    """Return the variables after `source install/setup.bash`, among those that hold already."""
    command = ["bash", "-c", f"source {FILES}/{build_plan.WORKSPACE}/install/setup.bash && env"]
    said = made.world.run(command, environ=underlay()).output
    pairs = (line.partition("=") for line in said.splitlines())
    apart = {*ENVIRON, "PWD", "OLDPWD", "SHLVL", "_"} - {"PATH"}
    return {name: value for name, _, value in pairs if name not in apart}


@pytest.mark.parametrize(
    "style",
    [
        src_layout,
        *(
            pytest.param(style, marks=pytest.mark.thorough)
            for style in (everything_in_setup_cfg, sub_packages, by_glob)
        ),
    ],
    ids=lambda style: style.__name__,
)
def test_a_right_package_is_built_whatever_its_style(
    make: Callable[..., Built], style: Callable[[Texts], None]
) -> None:
    texts = right_package()
    style(texts)
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    assert made.faults == {"status_publisher": "", "velocity_publisher": ""}


def test_a_package_is_built_with_those_that_it_needs_and_no_other(make: Callable[..., Built]) -> None:
    texts = {f"my ws/src/robot_controller/{name}": text for name, text in right_package().items()}
    texts["my ws/src/robot_controller/robot_controller/status_publisher.py"] = f"import words\n{TALKER}"
    texts["my ws/src/robot_controller/package.xml"] = MANIFEST.replace(
        "</license>", "</license><depend>words</depend>"
    )
    texts["my ws/src/words/package.xml"] = MANIFEST.replace("robot_controller", "words")
    texts["my ws/src/words/setup.py"] = SETUP.replace("robot_controller", "words").replace(
        "words.status", "words.s"
    )
    texts["my ws/src/words/setup.cfg"] = SETUP_CFG.replace("robot_controller", "words")
    texts["my ws/src/words/resource/words"] = ""
    texts["my ws/src/words/words/__init__.py"] = ""
    texts["my ws/src/broken/package.xml"] = MANIFEST.replace("robot_controller", "broken")
    texts["my ws/src/broken/setup.py"] = "raise SystemExit(1)\n"
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    assert made.faults == {"status_publisher": "", "velocity_publisher": ""}
    assert made.run("status_publisher", "x").output == "started x\n"
    assert sourced(made) == made.build.environ


@pytest.mark.parametrize(
    ("setup", "shared"),
    [
        (SETUP, ["a.launch.xml"]),
        pytest.param("raise SystemExit(1)\n", [], marks=pytest.mark.thorough),  # as of one that is not needed
    ],
)
def test_a_package_that_launches_it_is_built_beside_it(
    make: Callable[..., Built], setup: str, shared: list[str]
) -> None:
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    bringup = right_package() | {
        "setup.py": setup.replace("['package.xml']", "['package.xml', 'launch/a.launch.xml']")
    }
    for name, text in bringup.items():
        texts[f"src/bringup/{name}".replace("robot_controller", "bringup")] = text.replace(
            "robot_controller", "bringup"
        )
    texts["src/bringup/launch/a.launch.xml"] = (
        '<launch><node pkg="robot_controller" exec="status_publisher"/></launch>\n'
    )
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    assert made.build.shared == shared
    assert made.faults == {"status_publisher": "", "velocity_publisher": ""}


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("setup.py", "status_publisher:main',", "status_publisher:main'"),
        *(
            pytest.param(*edit, marks=pytest.mark.thorough)
            for edit in (
                ("setup.py", "'velocity_publisher = robot_controller.velocity_publisher:main',", ""),
                ("setup.cfg", SETUP_CFG, ""),
            )
        ),
    ],
    ids=["comma missing", "no entry point", "installed in bin"],
)
def test_a_node_of_another_package_that_does_not_install_it_is_started_all_the_same(
    make: Callable[..., Built], file: str, old: str, new: str
) -> None:
    """As one of the graded package is: what keeps it from being installed is charged once, and not at the node."""
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    del texts["src/robot_controller/robot_controller/velocity_publisher.py"]
    wheels = right_package() | {"robot_controller/velocity_publisher.py": f"TOPIC = '/cmd_vel'\n{TALKER}"}
    assert old in wheels[file]
    wheels[file] = wheels[file].replace(old, new)
    for name, text in wheels.items():
        texts[f"src/wheels/{name}".replace("robot_controller", "wheels")] = text.replace(
            "robot_controller", "wheels"
        )
    made = make(texts)
    assert (made.build.is_built, made["status_publisher"].package) == (True, "")
    (started,) = [one for one in made.build.executables if one.target == "wheels.velocity_publisher:main"]
    assert (started.way, started.package) == ("module", "wheels")
    assert made.run(started.name, "x").output == "started x\n"


@pytest.mark.parametrize("setup", [pytest.param(SETUP, marks=pytest.mark.thorough), "raise SystemExit(1)\n"])
def test_the_files_of_a_package_that_needs_cmake_are_found(make: Callable[..., Built], setup: str) -> None:
    """As far as its CMakeLists.txt installs them; it is not built where there is no ament_cmake."""
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    texts["src/robot_controller/setup.py"] = setup
    manifest = texts["src/robot_controller/package.xml"].replace("robot_controller", "bringup")
    texts |= {
        "src/bringup/package.xml": manifest.replace("ament_python", "ament_cmake"),
        "src/bringup/CMakeLists.txt": "find_package(ament_cmake)\ninstall(DIRECTORY launch\n  DESTINATION share/x) # config\n",
        "src/bringup/launch/a.launch.xml": '<launch><node pkg="robot_controller" exec="status_publisher"/></launch>\n',
        "src/bringup/config/a.yaml": "{}\n",
    }
    made = make(texts)
    assert (made.build.is_built, made.build.shared) == (setup == SETUP, ["launch/a.launch.xml"])
    assert "Not built, for it needs CMake, but its files are found: bringup." in made.build.notes
    find = "from ament_index_python import get_package_share_path as s; print(*sorted(p.name for p in s('bringup').iterdir()))"
    box = made.world.run([sys.executable, "-c", find], environ=made.build.environ)
    assert box.output == "launch\n"


@pytest.mark.thorough
def test_scripts_and_links_are_installed_as_they_are(make: Callable[..., Built], tmp_path: Path) -> None:
    texts = right_package()
    texts["setup.py"] = SETUP.partition("    entry_points={")[0] + "    scripts=['scripts/talker'],\n)\n"
    texts |= {"scripts/talker": f"#!/usr/bin/env python3\n{TALKER}main()\n"}
    texts |= {"robot_controller/talker.py": texts.pop("robot_controller/status_publisher.py")}
    folder = write(tmp_path / "ws/src/robot_controller", texts)
    (folder / "robot_controller/velocity_publisher.py").unlink()
    (folder / "robot_controller/velocity_publisher.py").symlink_to("../../../shared.py")
    (tmp_path / "ws/shared.py").write_text(VELOCITY)
    made = make(tmp_path / "ws")
    assert made.build.is_built
    assert (made["talker"].way, made["talker"].fault, made["talker"].target) == ("installed", "", "")
    assert made.run("talker", "x").output == "started x\n"
    assert made["velocity_publisher"].fault == "No entry point leads to it."


# Faults.


def test_each_program_of_a_broken_setup_can_be_started_as_a_module(make: Callable[..., Built]) -> None:
    texts = right_package() | {"robot_controller/status_publisher.py": TALKER}
    texts["setup.py"] = SETUP.replace("setup(\n", "setup\n", 1)
    made = make(texts)
    assert not made.build.is_built
    assert "setup.py" in made.build.error
    assert made.faults == dict.fromkeys(
        ("status_publisher", "velocity_publisher"), "The package was not built."
    )
    assert {one.way for one in made.build.executables} == {"module"}
    assert made.run("status_publisher", "a", "b").output == "started a b\n"


@pytest.mark.parametrize(
    ("code", "limits"),
    [
        ("import time\nwhile True: time.sleep(1)\n", replace(LIMITS, wall_s=6)),
        ("while True: print('x' * 10_000)\n", replace(LIMITS, file_bytes=1_000_000)),  # colcon's log of it
    ],
)
def test_a_build_that_a_limit_ends_says_so(make: Callable[..., Built], code: str, limits: Limits) -> None:
    """Also where the limit has ended setup.py, and colcon then says that this has failed."""
    made = make(right_package() | {"setup.py": code + SETUP}, limits)
    assert not made.build.is_built
    assert made.build.cut.startswith("It ")
    assert made.build.error == made.build.cut


@pytest.mark.thorough
def test_a_fault_of_one_entry_point_is_no_fault_of_another(make: Callable[..., Built]) -> None:
    texts = right_package()
    texts["robot_controller/renamed.py"] = TALKER
    texts["robot_controller/unnamed.py"] = TALKER
    texts["robot_controller/guarded.py"] = (
        f"{TALKER.replace('main', 'go')}\n\nif __name__ == '__main__':\n    go()\n"
    )
    texts["robot_controller/missing.py"] = f"import geometry_msg\n{TALKER}"
    texts["robot_controller/leaves.py"] = f"import os\n{TALKER}\nos._exit(3)\n"
    texts["setup.py"] = SETUP.replace(
        "        ],\n    },",
        "            'renamed = robot_controller.renamed:mian',\n"
        "            'missing = robot_controller.missing:main',\n"
        "            'leaves = robot_controller.leaves:main',\n"
        "            'lost = robot_controller.lost:main',\n        ],\n    },",
    )
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    why = "Its module cannot be imported: ModuleNotFoundError: No module named"
    assert made.faults == {
        "status_publisher": "",
        "velocity_publisher": "",
        "renamed": "There is no mian in robot_controller.renamed.",
        "missing": f"{why} 'geometry_msg' (missing.py, line 1).",
        "leaves": "Its module ends Python while it is imported.",
        "lost": f"{why} 'robot_controller.lost'.",
        "unnamed": "No entry point leads to it.",
        "go": "No entry point leads to it.",
    }
    for name in ("renamed", "unnamed", "go"):
        assert made.run(name, "x").output == "started x\n", name
    assert made["lost"].command == []


def test_what_is_not_installed_here_is_no_fault(make: Callable[..., Built]) -> None:
    """A library, messages of a workspace's own that need CMake, and programs of a launch file."""
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    texts["src/robot_controller/robot_controller/status_publisher.py"] = (
        "import my_msgs.msg\nimport RPi.GPIO as GPIO\nfrom my_msgs.msg import Battery\nfrom smbus2 import SMBus\n"
        "GPIO.setup(17, GPIO.OUT)\nclass Bus(SMBus):\n    pass\nassert not Bus(1).read()\n"
        f"Battery().level = 3\n{TALKER}"
    )
    texts["src/robot_controller/package.xml"] = MANIFEST.replace(
        "</license>", "</license><depend>my_msgs</depend>"
    )
    texts["src/robot_controller/launch/robot.launch.xml"] = (
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher"/></launch>\n'
    )
    texts["src/my_msgs/package.xml"] = MANIFEST.replace("robot_controller", "my_msgs").replace(
        "ament_python", "ament_cmake"
    )
    texts["src/my_msgs/CMakeLists.txt"] = "find_package(rosidl_default_generators REQUIRED)\n"
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    assert made.faults == {"status_publisher": "", "velocity_publisher": ""}
    assert made.run("status_publisher", "x").output == "started x\n"
    noted = [note.partition(": ")[2] for note in made.build.notes if note.startswith("Not installed here")]
    assert noted == ["robot_state_publisher of robot_state_publisher.", "RPi, my_msgs, smbus2."]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("file", "old", "new", "fault"),
    [
        ("setup.cfg", SETUP_CFG, "", "It was installed in bin, where `ros2 run` does not look."),
        (
            "setup.cfg",
            "lib/robot_controller",
            "lib/first_robot",
            "It was installed in lib/first_robot, where `ros2 run` does not look.",
        ),
        ("package.xml", "<name>robot_controller", "<name>robot_driver", ""),  # found as robot_controller
    ],
    ids=["no setup.cfg", "that of another package", "another name in package.xml"],
)
def test_executables_are_where_ros_looks_if_they_lie_beside_a_marker(
    make: Callable[..., Built], file: str, old: str, new: str, fault: str
) -> None:
    texts = right_package() | {"robot_controller/status_publisher.py": TALKER}
    texts[file] = texts[file].replace(old, new)
    made = make(texts)
    assert made.build.is_built
    assert set(made.faults.values()) == {fault}
    assert made.run("status_publisher", "x").output == "started x\n"
    warned = [line for line in made.build.warnings if "doesn't explicitly install" in line]
    assert len(warned) == (2 if file == "package.xml" else 0)


@pytest.mark.thorough
def test_packages_that_only_cmake_builds_are_noted(make: Callable[..., Built]) -> None:
    texts = {f"src/robot_controller/{name}": text for name, text in right_package().items()}
    other = MANIFEST.replace("robot_controller", "robot_arm").replace("ament_python", "ament_cmake")
    notes = make(texts | {"src/robot_arm/package.xml": other}).build.notes
    assert notes == ["Not built, for they need CMake, and nothing of what is graded needs them: robot_arm."]


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("package.xml", MANIFEST.replace("</license>", ""), "package.xml is not valid"),
        ("package.xml", MANIFEST.replace("ament_python", "ament_cmake"), "CMake"),
        pytest.param(
            "setup.py",
            SETUP.replace("import find_packages, setup", "import setup"),
            "find_packages",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            "setup.py",
            SETUP.replace("['package.xml']", "['package.xml', 'missing']"),
            "missing",
            marks=pytest.mark.thorough,
        ),
    ],
    ids=["invalid package.xml", "ament_cmake", "missing import", "missing file"],
)
def test_what_is_not_built_as_ament_python_says_why(
    make: Callable[..., Built], file: str, text: str, said: str
) -> None:
    made = make(right_package() | {file: text})
    assert not made.build.is_built
    assert said in made.build.error
    assert "\n" not in made.build.error
    assert set(made.faults.values()) == {"The package was not built."}


def test_loose_files_are_scripts_without_a_build(make: Callable[..., Built]) -> None:
    made = make({"week 3/talker.py": f"{TALKER}main()\n", "notes.txt": "x"})
    assert (made.build.is_built, made.build.error) == (False, "There is no package to build.")
    assert (made["talker"].way, made["talker"].fault) == (
        "script",
        "There is no package to which it belongs.",
    )
    assert made.run("talker", "x").output == "started x\n"


def test_what_loose_files_need_is_no_fault(make: Callable[..., Built]) -> None:
    """A library that is not here does nothing, and a folder of the student's machine is there; files know each other."""
    writes = "open('/home/ada/logs/run.txt', 'a').write('x')\nopen('/data/a/b.csv', 'w')\n"
    text = (
        f"import cv2\nimport odd_brain\nimport helper\nimport rclpy\n{writes}rclpy.init\nprint('started')\n"
    )
    made = make({"talker.py": f"{text}def main():\n    rclpy.init()\n", "helper.py": "", "notes.txt": "x"})
    assert made.run("talker").output == "started\n"
    assert (made["talker"].absent, made["talker"].is_brief) == (["cv2", "odd_brain"], True)
    assert any(note.endswith("imported in their place: cv2, odd_brain.") for note in made.build.notes)


@pytest.mark.thorough
def test_nodes_beside_setup_py_are_scripts(make: Callable[..., Built]) -> None:
    texts = {name: text for name, text in right_package().items() if "robot_controller/" not in name}
    made = make(texts | {"resource/robot_controller": "", "status_publisher.py": TALKER})
    assert not [one for one in made.build.executables if not one.fault]
    (script,) = [one for one in made.build.executables if one.way == "script"]
    assert made.world.run([*script.command, "x"], environ=made.build.environ).output == "started x\n"


@pytest.mark.thorough
def test_a_node_that_runs_while_it_is_imported_has_no_fault(
    make: Callable[..., Built], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(programs, "IMPORT_TIME", 1.0)
    texts = right_package() | {
        "robot_controller/status_publisher.py": "import time\nwhile True:\n    time.sleep(60)\n"
    }
    assert make(texts).faults == {"status_publisher": "", "velocity_publisher": ""}


@pytest.mark.thorough
def test_a_trial_that_ends_without_a_word_is_made_again(
    make: Callable[..., Built], monkeypatch: pytest.MonkeyPatch
) -> None:
    run, trials = World.run, list[object]()

    def run_or_fail(world: World, command: Sequence[str | Path], **settings: Any) -> Box:
        if programs._IMPORTER in command:
            trials.append(command)
            command = command if len(trials) > 1 else ["false"]
        return run(world, command, **settings)

    monkeypatch.setattr(World, "run", run_or_fail)
    assert make(right_package()).faults == {"status_publisher": "", "velocity_publisher": ""}
    assert len(trials) == 2


@pytest.mark.thorough
def test_a_module_that_ends_whoever_imports_it_is_told(make: Callable[..., Built]) -> None:
    texts = right_package() | {
        "robot_controller/status_publisher.py": "import os\nos.kill(os.getppid(), 9)\n"
    }
    fault = "Its module could not be tried: the trial ended with code 137"
    assert make(texts).faults == {"status_publisher": fault, "velocity_publisher": fault}


# Programs and settings that mean harm.


def test_settings_of_a_submission_do_not_change_the_build_and_are_noted(make: Callable[..., Built]) -> None:
    """Nor does a COLCON_IGNORE, which was noted when the package was received; its nodes are to be seen."""
    texts = {f"ws/src/robot_controller/{name}": text for name, text in right_package().items()}
    harm = "raise SystemExit('harm')\n"
    texts |= {f"ws/{name}": harm for name in ("sitecustomize.py", "conftest.py", "src/usercustomize.py")}
    texts |= {
        "ws/colcon.meta": "{",
        "ws/defaults.yaml": "build: {packages-skip: [robot_controller]}",
        "ws/x.pth": harm,
    }
    texts |= {".colcon/defaults.yaml": "build: {packages-skip: [robot_controller]}"}
    texts["ws/src/robot_controller/sitecustomize.py"] = harm
    texts["ws/src/robot_controller/COLCON_IGNORE"] = ""
    texts["ws/src/robot_controller/test/conftest.py"] = ""
    texts["ws/src/robot_controller/colcon.pkg"] = '{"hooks": []}'
    texts["ws/src/robot_controller/setup.cfg"] = (
        f"{SETUP_CFG}[build]\nbuild_base=/tmp/elsewhere\n"
        "[options.entry_points]\ncolcon_core.task.build =\n    ros.ament_python = robot_controller:Harm\n"
    )
    made = make(texts)
    assert (made.build.is_built, made.build.error) == (True, "")
    assert made.faults == {"status_publisher": "", "velocity_publisher": ""}
    assert {one.way for one in made.build.executables} == {"installed"}
    noted = "\n".join(made.build.notes)
    assert "conftest.py, ws/defaults.yaml" in noted
    assert "ws/src/robot_controller/colcon.pkg, ws/src/robot_controller/sitecustomize.py" in noted
    assert "build.build_base in setup.cfg" in noted
    assert "test/conftest.py" not in noted
    assert "COLCON_IGNORE" not in noted


HARM = """
import os, pathlib, subprocess, sys
print("100 of 100 points")
print('{"is_built": true}')
for path in (os.path.expanduser("~/harm"), "%(outside)s/harm", "/work/harm", "/usr/harm", sys.prefix + "/harm"):
    try:
        pathlib.Path(path).write_text("harm")
    except OSError:
        pass
subprocess.Popen(["sleep", "1000"], start_new_session=True, stdout=-3, stderr=-3)
record = pathlib.Path("%(ws)s/%(record)s")
record.unlink(missing_ok=True)
record.symlink_to("%(outside)s/secret")
metadata = pathlib.Path("%(ws)s/install/robot_controller/lib/python3/site-packages/x.egg-info")
metadata.mkdir(parents=True, exist_ok=True)
(metadata / "entry_points.txt").symlink_to("%(outside)s/secret")
os.mkfifo(metadata.with_name("entry_points.txt"))
sys.exit(1)
"""


def test_a_setup_script_reaches_nothing_of_the_grader(make: Callable[..., Built], tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("[console_scripts]\nsecret = secret:secret\n")
    workspace = f"{FILES}/{build_plan.WORKSPACE}"
    harm = HARM % {"outside": tmp_path, "ws": workspace, "record": colcon_build.RECORD}
    made = make(right_package() | {"setup.py": harm})
    assert not made.build.is_built
    assert "secret" not in str(asdict(made.build))
    assert secret.exists()
    assert not [path for path in tmp_path.rglob("harm") if path.is_file()]
    assert not Path(sys.prefix, "harm").exists()
    assert make(right_package()).build.is_built


@pytest.mark.thorough
def test_a_name_that_is_a_path_leads_nowhere(make: Callable[..., Built], tmp_path: Path) -> None:
    text = SETUP.replace("package_name = 'robot_controller'", f"package_name = '{tmp_path}/harm'")
    made = make(right_package() | {"setup.py": text, "package.xml": "<"})
    assert not made.build.is_built
    assert not (tmp_path / "harm").exists()
    assert {one.way for one in made.build.executables} == {"module"}


@pytest.mark.parametrize(
    ("harm", "error"),
    [
        pytest.param(
            "record.unlink()",
            "it is unknown what was built: colcon left no record of it",
            marks=pytest.mark.thorough,
        ),
        ("record.unlink(); os.mkfifo(record)", "it is unknown what was built: colcon left no record of it"),
        pytest.param(
            "record.write_text('[' * 10**5)",
            "it is unknown what was built: colcon left no record of it",
            marks=pytest.mark.thorough,
        ),
        ("record.write_text(FAILED); raise SystemExit(3)", r"error: \ud800"),
    ],
)
def test_a_record_that_is_overwritten_is_no_error_of_the_grader(
    make: Callable[..., Built], harm: str, error: str
) -> None:
    """It is not trusted, and what cannot be known is not told as a fault of the package."""
    failed = [
        {
            "event": "found",
            "packages": [{"name": "robot_controller", "path": "\0", "type": "ros.ament_python"}],
        },
        {"event": "stderr", "job": "robot_controller", "text": "error: \ud800"},
        {"event": "ended", "job": "robot_controller", "time": 1.0, "code": 3},
    ]
    text = (
        f"import atexit, os, pathlib\nFAILED = {chr(10).join(map(json.dumps, failed)) + chr(10)!r}\n"
        f"record = pathlib.Path('{FILES}/{build_plan.WORKSPACE}/{colcon_build.RECORD}')\n"
        f"if 'build' in os.sys.argv:\n    {harm}\n"
    )
    made = make(right_package() | {"setup.py": text + SETUP})
    assert not made.build.is_built
    assert made.build.error == error


def test_a_setup_script_that_sleeps_is_ended(make: Callable[..., Built]) -> None:
    texts = right_package() | {"setup.py": f"import time\ntime.sleep(10**6)\n{SETUP}"}
    made = make(texts, limits=Limits(wall_s=6, processes=64, memory_bytes=500_000_000))
    assert made.build.error == "It ran longer than 6 s."
    assert made.faults == dict.fromkeys(
        ("status_publisher", "velocity_publisher"), "The package was not built."
    )


def test_a_setup_script_that_forks_without_end_is_ended(make: Callable[..., Built]) -> None:
    text = "import os, time\nwhile True:\n    try:\n        os.fork()\n    except OSError:\n        time.sleep(1)\n"
    made = make(
        right_package() | {"setup.py": text},
        limits=Limits(wall_s=6, cpu_s=20, processes=64, memory_bytes=256_000_000),
    )
    assert not made.build.is_built
    assert made.build.error


# What is judged from data.


def outcome(kind: str, files: list[str], is_ok: bool = True) -> tuple[bool, str]:
    found = FoundPackage(".", "pk", "ament_python", None)
    plan = build_plan.Plan(found, "pk", {"pk": "."}, ["pk"], [], [], [], "graded_ws")
    mine = PackageResult("pk", is_ok, 1.0, (), None if is_ok else "error: no")
    result = BuildResult(is_ok, (mine,), mine.error, 1.0, 0)
    left = {"files": dict.fromkeys(files, True), "points": {}, "heads": {}, "record": ""}
    judged = colcon_build.judge(plan, result, {"pk": kind} if kind else {}, None, left)
    return judged.is_built, judged.error


MARKER = "pk/share/ament_index/resource_index/packages/pk"
METADATA = "pk/lib/python3.12/site-packages/pk-0.1.0-py3.12.egg-info/PKG-INFO"


@pytest.mark.parametrize(
    ("kind", "files", "is_ok", "error"),
    [
        ("ros.ament_python", [MARKER, METADATA], True, ""),
        (
            "ros.ament_python",
            [MARKER, METADATA.replace("lib/python3.12/site", "local/lib/python3.12/dist")],
            True,
            "",
        ),
        ("ros.ament_python", [MARKER, METADATA], False, "error: no"),
        ("python", [MARKER, METADATA], True, "colcon lists it as python, not as ros.ament_python."),
        ("", [MARKER, METADATA], True, "colcon finds no package pk."),
        ("ros.ament_python", [METADATA], True, "colcon ended without an error, and nothing was installed."),
        ("ros.ament_python", [MARKER], True, "colcon ended without an error, and nothing was installed."),
    ],
)
def test_only_what_is_listed_built_and_installed_is_built(
    kind: str, files: list[str], is_ok: bool, error: str
) -> None:
    assert outcome(kind, files, is_ok) == (not error, error)


@pytest.mark.parametrize(
    "text", ["", "[console_scripts", "a=b", "[console_scripts]\na\n", "\0", "[x]\n[x]\n"]
)
def test_metadata_that_cannot_be_read_names_no_entry_point(text: str) -> None:
    assert [*colcon_build.points_in({"pk/entry_points.txt": text}, "pk")] == []


def test_entry_points_are_read_with_extras_and_without_those_of_others() -> None:
    texts = {
        "pk/e": "[console_scripts]\nTalk = pk.talk : main [extra]\n",
        "other/e": "[console_scripts]\nx = y:z\n",
    }
    assert [(one.name, one.target) for one in colcon_build.points_in(texts, "pk")] == [
        ("Talk", "pk.talk:main")
    ]


@pytest.mark.parametrize("printed", ["", "{", "100 points"])
def test_what_cannot_be_read_counts_as_nothing_left(printed: str) -> None:
    assert colcon_build.read_left(printed)["files"] == {}


def test_errors_are_one_line_without_codes_for_a_terminal() -> None:
    assert build_plan.one_line(f"a\x1b[2J\n{FILES}/graded_ws/src/x") == r"a\x1b[2J src/x"
    assert len(build_plan.one_line("x" * 10_000)) == 400
