"""The checks of `03_packages`: right answers in many styles are accepted, wrong ones of many kinds are not."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from ros2lab import course, environment
from ros2lab.checks import CheckError, packages

SETUP = """
from setuptools import find_packages, setup
setup(
    name="{name}",
    version="0.1.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/{name}"]),
        ("share/{name}", ["package.xml"]),
    ],
    entry_points={points},
)
"""
GAUGE = 'def show_charge():\n    print("Battery: 87 %")\n'


@pytest.fixture
def src(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A student's workspace, still empty."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    folder = course.student_path(f"{packages.WORKSPACE}/src")
    folder.mkdir(parents=True)
    return folder


def create(src: Path, name: str, *options: str) -> Path:
    command = ["ros2", "pkg", "create", name, "--build-type", "ament_python", *options]
    command += ["--maintainer-name", "Ada", "--maintainer-email", "ada@example.org"]
    environ = environment.lab_environment()
    subprocess.run(command, cwd=src, env=environ, check=True, capture_output=True)
    return src / name


def build(src: Path, package: str) -> None:
    """Build with the real colcon, whether that goes well or not."""
    command = ["colcon", "build", "--packages-select", package]
    environ = environment.lab_environment()
    subprocess.run(command, cwd=src.parent, env=environ, check=False, capture_output=True)


def replace(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


DESCRIBED = ("--description", "Publishes the weather.", "--license", "MIT")


@pytest.mark.parametrize(
    "tags",
    [
        "<depend>rclpy</depend><depend>sensor_msgs</depend>",
        "<exec_depend>rclpy</exec_depend>\n<exec_depend>sensor_msgs</exec_depend>",
        "<build_depend>rclpy</build_depend><exec_depend>rclpy</exec_depend><depend>sensor_msgs</depend>",
        "<depend>std_msgs</depend><depend>sensor_msgs</depend><depend>rclpy</depend>",
    ],
)
def test_a_right_manifest(src: Path, tags: str) -> None:
    """Any tags that count when the package runs, in any order and with more beside them."""
    folder = create(src, "weather_station", *DESCRIBED)
    replace(folder / "package.xml", "<export>", f"{tags}<export>")
    assert packages.manifest().startswith("Right")


def test_a_right_manifest_by_options(src: Path) -> None:
    """`ros2 pkg create` may write all of it, with another licence."""
    create(
        src,
        "weather_station",
        "--description",
        "x",
        "--license",
        "BSL-1.0",
        "--dependencies",
        "rclpy",
        "sensor_msgs",
    )
    assert packages.manifest().startswith("Right")


BOTH = "<depend>rclpy</depend><depend>sensor_msgs</depend>"


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("Publishes the weather.", "TODO: Package description", "description of your own"),
        ("<license>MIT</license>", "<license>TODO: License declaration</license>", "a licence"),
        ("<license>MIT</license>", "", 'at least one "license" tag'),
        (BOTH, "", r"rclpy is not among .* \(nothing\)"),
        (BOTH, "<depend>rclpy</depend>", "sensor_msgs is not among"),
        (BOTH, BOTH.replace("sensor_msgs", "sensor_msg"), "sensor_msgs is not among"),
        (BOTH, BOTH.replace("depend>", "build_depend>"), "rclpy is not among"),
        (BOTH, BOTH.replace("</depend>", "", 1), "can be read"),
        ("ament_python</build_type>", "ament_cmake</build_type>", "build type ament_python"),
        ('format="3"', 'format="2"', "format 2"),
        ('email="ada@example.org"', "", "email"),
    ],
)
def test_a_wrong_manifest(src: Path, old: str, new: str, complaint: str) -> None:
    """What is missing, misspelt or not XML is named."""
    folder = create(src, "weather_station", *DESCRIBED)
    replace(folder / "package.xml", "<export>", f"{BOTH}<export>")
    replace(folder / "package.xml", old, new)
    with pytest.raises(CheckError, match=complaint):
        packages.manifest()


def test_no_manifest(src: Path) -> None:
    """A package that is not there is said to be missing."""
    with pytest.raises(CheckError, match="weather_station"):
        packages.manifest()


def battery(src: Path, points: str) -> Path:
    folder = create(src, "battery_monitor")
    (folder / "battery_monitor" / "gauge.py").write_text(GAUGE)
    (folder / "setup.py").write_text(SETUP.format(name="battery_monitor", points=points))
    return folder


@pytest.mark.parametrize(
    "points",
    [
        '{"console_scripts": ["charge = battery_monitor.gauge:show_charge"]}',
        "{'console_scripts': ('other=battery_monitor.gauge:none', 'charge=battery_monitor.gauge:show_charge',)}",
        '"[console_scripts]\\ncharge = battery_monitor.gauge:show_charge\\n"',
    ],
)
def test_a_right_entry_point(src: Path, points: str) -> None:
    """However setup.py writes it down."""
    battery(src, points)
    build(src, "battery_monitor")
    assert packages.entry_point().startswith("Right")


def test_a_right_entry_point_in_setup_cfg(src: Path) -> None:
    """Setuptools reads entry points from setup.cfg, too."""
    folder = battery(src, "None")
    with (folder / "setup.cfg").open("a") as file:
        file.write(
            "[options.entry_points]\nconsole_scripts =\n    charge = battery_monitor.gauge:show_charge\n"
        )
    build(src, "battery_monitor")
    assert packages.entry_point().startswith("Right")


@pytest.mark.parametrize(
    ("points", "complaint"),
    [
        ("{'console_scripts': []}", "no such executable"),
        ("{'console_script': ['charge = battery_monitor.gauge:show_charge']}", "no such executable"),
        ("{'console_scripts': ['Charge = battery_monitor.gauge:show_charge']}", "no such executable"),
        ("{'console_scripts': ['charge = battery_monitor.gauge:main']}", "has no attribute 'main'"),
        ("{'console_scripts': ['charge = battery_monitor.gauge']}", "not callable"),
        ("{'console_scripts': ['charge = gauge:show_charge']}", "No module named 'gauge'"),
        (
            "{'console_scripts': ['charge = battery_monitor/gauge:show_charge']}",
            "is not built|no such executable",
        ),
    ],
)
def test_a_wrong_entry_point(src: Path, points: str, complaint: str) -> None:
    """What `ros2 run` meets is told."""
    battery(src, points)
    build(src, "battery_monitor")
    with pytest.raises(CheckError, match=complaint):
        packages.entry_point()


def test_an_entry_point_that_was_not_built(src: Path) -> None:
    """A right line in setup.py is no executable yet."""
    battery(src, "{'console_scripts': ['charge = battery_monitor.gauge:show_charge']}")
    with pytest.raises(CheckError, match="battery_monitor is not built"):
        packages.entry_point()


def test_an_entry_point_to_something_else(src: Path) -> None:
    """Another function that prints something else does not count."""
    folder = battery(src, "{'console_scripts': ['charge = battery_monitor.gauge:hello']}")
    (folder / "battery_monitor" / "gauge.py").write_text(GAUGE + "def hello():\n    print('hello')\n")
    build(src, "battery_monitor")
    with pytest.raises(CheckError, match="'hello'"):
        packages.entry_point()


@pytest.mark.parametrize(
    "names",
    [
        packages.LOST_FILES,
        ("setup.cfg", "lamp_driver/__init__.py", "resource/lamp_driver"),
        ("__init__.py", "./setup.cfg", "lamp_driver/resource/lamp_driver"),
        (["resource/lamp_driver", "setup.cfg", "__init__.py"],),
        (Path("resource/lamp_driver"), Path("setup.cfg"), Path("lamp_driver/__init__.py")),
        ("src/lamp_driver/resource/lamp_driver", " setup.cfg ", "src/lamp_driver/lamp_driver/__init__.py"),
    ],
)
def test_the_missing_files(names: tuple[str, ...]) -> None:
    """In any order, written from the package, the workspace or as paths."""
    assert packages.missing(*names).startswith("Right")


@pytest.mark.parametrize(
    ("names", "complaint"),
    [
        ((), "you have 0 of 3"),
        (("setup.cfg",), "you have 1 of 3"),
        (("setup.cfg", "setup.cfg", "__init__.py"), "you have 2 of 3"),
        (("setup.py", "setup.cfg", "__init__.py"), r"setup\.py is not one"),
        ((*packages.LOST_FILES, "package.xml"), r"package\.xml is not one"),
        (("resource", "setup.cfg", "__init__.py"), "resource is not one"),
        ((3, 4, 5), "3 is not one"),
    ],
)
def test_other_files(names: tuple[str, ...], complaint: str) -> None:
    """Too few, too many, others, and what is no file."""
    with pytest.raises(CheckError, match=complaint):
        packages.missing(*names)


def mend(src: Path, *, without: str = "") -> None:
    folder = src / "lamp_driver"
    texts = {
        "setup.cfg": "[develop]\nscript_dir=$base/lib/lamp_driver\n[install]\ninstall_scripts=$base/lib/lamp_driver\n"
    }
    for name in packages.LOST_FILES:
        if name != without:
            (folder / name).write_text(texts.get(name, ""))


def test_a_mended_package(src: Path) -> None:
    """The files put back where they were."""
    packages.make_broken_package()
    mend(src)
    build(src, "lamp_driver")
    assert packages.lamp_driver().startswith("Right")


def test_a_package_mended_otherwise(src: Path) -> None:
    """Packages named in setup.py, a marker with text, and only the lines that are needed."""
    packages.make_broken_package()
    folder = src / "lamp_driver"
    (folder / "resource" / "lamp_driver").write_text("here\n")
    (folder / "setup.cfg").write_text("[install]\ninstall_scripts = $base/lib/lamp_driver\n")
    replace(folder / "setup.py", "find_packages(exclude=['test'])", "[package_name]")
    build(src, "lamp_driver")
    assert packages.lamp_driver().startswith("Right")


def test_a_package_mended_by_a_new_one(src: Path) -> None:
    """Made again by `ros2 pkg create`, with the old source."""
    packages.make_broken_package()
    shutil.move(src / "lamp_driver", src / "old")
    folder = create(src, "lamp_driver", "--node-name", "lamp")
    shutil.copy(src / "old" / "lamp_driver" / "lamp.py", folder / "lamp_driver")
    (src / "old" / "COLCON_IGNORE").touch()
    build(src, "lamp_driver")
    assert packages.lamp_driver().startswith("Right")


@pytest.mark.parametrize(
    ("without", "complaint"),
    [
        ("resource/lamp_driver", "is not built|no such executable"),
        ("setup.cfg", "no such executable where `ros2 run` looks"),
        ("lamp_driver/__init__.py", "No module named 'lamp_driver'"),
    ],
)
def test_a_package_half_mended(src: Path, without: str, complaint: str) -> None:
    """Each of the three is needed."""
    packages.make_broken_package()
    mend(src, without=without)
    build(src, "lamp_driver")
    with pytest.raises(CheckError, match=complaint):
        packages.lamp_driver()


def test_a_package_that_was_mended_but_not_built(src: Path) -> None:
    """Files alone run nothing."""
    packages.make_broken_package()
    mend(src)
    with pytest.raises(CheckError, match="lamp_driver is not built"):
        packages.lamp_driver()


def test_no_package_to_mend(src: Path) -> None:
    """The cell that makes it was left out."""
    with pytest.raises(CheckError, match="no package lamp_driver"):
        packages.lamp_driver()


def test_the_broken_package_of_a_student_stays(src: Path) -> None:
    """What was mended is not broken again."""
    packages.make_broken_package()
    assert not any((src / "lamp_driver" / name).exists() for name in packages.LOST_FILES)
    mend(src)
    packages.make_broken_package()
    assert all((src / "lamp_driver" / name).exists() for name in packages.LOST_FILES)
