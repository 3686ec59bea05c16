"""The checks of `09_troubleshooting`: any right mend is accepted, and each fault that is left is named."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from ros2lab import course
from ros2lab.checks import CheckError, troubleshooting
from ros2lab.diagnose import of_workspace

Mend = tuple[str, str, str]  # a file of the package, and one text for another


@pytest.fixture
def src(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The ward as the lesson makes it."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path / "my work"))
    troubleshooting.make_patients()
    return course.student_path(f"{troubleshooting.WARD}/src")


def change(package: Path, *mends: Mend) -> None:
    """Change files of a package; an empty old text appends."""
    for name, old, new in mends:
        file = package / name
        text = file.read_text() if file.exists() else ""
        assert old in text
        file.write_text(text.replace(old, new, 1) if old else text + new)


def test_a_patient_that_is_there_already_is_left_alone(src: Path) -> None:
    """Running the cell again loses nothing of what was mended."""
    change(src / "owl", ("setup.py", "", "# mended\n"))
    assert "owl" in troubleshooting.make_patients()
    assert (src / "owl" / "setup.py").read_text().endswith("# mended\n")


def test_the_robots_of_the_clinic_are_alike_but_for_their_names(src: Path) -> None:
    """Each copy is a package that bears its own name everywhere."""
    assert troubleshooting.make_healthy_robot() == "~/clinic_ws/src: patrol"
    assert troubleshooting.admit("robin", "wren") == "~/clinic_ws/src: robin, wren"
    clinic = course.student_path(troubleshooting.CLINIC) / "src"
    for file in (clinic / "robin").rglob("*"):
        assert "patrol" not in file.name
        assert file.is_dir() or "patrol" not in file.read_text()
    assert len([*(clinic / "robin").rglob("*")]) == len([*(clinic / "patrol").rglob("*")])


MARKER = ("resource/owl", "", "")


@pytest.mark.parametrize(
    "mends",
    [
        [("setup.py", "from setuptools", "from glob import glob\nfrom setuptools"), MARKER],
        [
            ("setup.py", "from setuptools", "import glob\nfrom setuptools"),
            ("setup.py", 'glob("launch', 'glob.glob("launch'),
            ("setup.py", 'glob("config', 'glob.glob("config'),
            ("resource/owl", "", "owl\n"),
        ],
        [
            ("setup.py", 'glob("launch/*")', '["launch/owl.launch.py"]'),
            ("setup.py", 'glob("config/*")', '["config/speed.yaml"]'),
            MARKER,
        ],
    ],
)
def test_a_mended_owl(src: Path, mends: list[Mend]) -> None:
    """However glob gets a meaning, and whatever the marker holds."""
    change(src / "owl", *mends)
    assert troubleshooting.owl().startswith("Right")


IMPORT = ("setup.py", "from setuptools", "from glob import glob\nfrom setuptools")


@pytest.mark.parametrize(
    ("mends", "complaint"),
    [
        ([], "name 'glob' is not defined"),
        ([IMPORT], "can't copy 'resource/owl'"),
        ([IMPORT, MARKER, ("owl/driver.py", "0.5", "0.9")], r"0\.9 m/s"),
        ([IMPORT, MARKER, ("owl/driver.py", "cmd_vel", "cmd_val")], "publishes on /cmd_val"),
        ([IMPORT, MARKER, ("setup.cfg", "[install]", "[instal]")], "No executable found"),
    ],
)
def test_an_owl_that_is_not_mended(src: Path, mends: list[Mend], complaint: str) -> None:
    """The fault that is left is named, be it one of ours or a new one."""
    change(src / "owl", *mends)
    with pytest.raises(CheckError, match=complaint):
        troubleshooting.owl()


def test_an_owl_that_is_gone(src: Path) -> None:
    """A package that was removed is asked for."""
    shutil.rmtree(src / "owl")
    with pytest.raises(CheckError, match="no package 'owl'"):
        troubleshooting.owl()


def test_no_ward_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who has skipped the cell that makes the patients is sent there."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    with pytest.raises(CheckError, match="make_patients"):
        troubleshooting.kite()


NAME = ("setup.py", ":mian", ":main")
CALLBACK = ("kite/driver.py", "self.drive())", "self.drive)")


@pytest.mark.parametrize(
    "mends",
    [
        [NAME, CALLBACK],
        [
            ("kite/driver.py", "def main", "def mian"),
            ("kite/driver.py", "self.drive()", "lambda: self.drive()"),
        ],
        [
            ("kite/driver.py", "", "\n\nmian = main\n"),
            ("kite/driver.py", "0.1, self.drive()", "0.2, callback=self.drive"),
        ],
    ],
)
def test_a_mended_kite(src: Path, mends: list[Mend]) -> None:
    """At either end of the entry point, and with any callback."""
    change(src / "kite", *mends)
    assert troubleshooting.kite().startswith("Right")


@pytest.mark.parametrize(
    ("mends", "complaint"),
    [
        ([], "no attribute 'mian'"),
        ([NAME], "'NoneType' object is not callable"),
        ([NAME, CALLBACK, ("kite/driver.py", "rclpy.spin(Driver())", "Driver()")], "said nothing"),
        ([NAME, CALLBACK, ("kite/driver.py", "= self.speed", "= 1")], "must be of type 'float'"),
        ([NAME, CALLBACK, ("kite/driver.py", "import Twist", "import Twst")], "cannot import name 'Twst'"),
    ],
)
def test_a_kite_that_is_not_mended(src: Path, mends: list[Mend], complaint: str) -> None:
    """The last line of what it says is shown."""
    change(src / "kite", *mends)
    with pytest.raises(CheckError, match=complaint):
        troubleshooting.kite()


LAUNCH = (
    "setup.py",
    '        ("share/crow/config"',
    '        ("share/crow/launch", glob("launch/*")),\n        ("share/crow/config"',
)
NODE = ("config/speed.yaml", "drive:", "driver:")


@pytest.mark.parametrize(
    "mends",
    [
        [LAUNCH, NODE],
        [LAUNCH, ("crow/driver.py", '"driver"', '"drive"')],
        [
            ("setup.py", 'glob("config/*")', 'glob("config/*") + ["launch/crow.launch.py"]'),
            ("config/speed.yaml", "drive:", "/**:"),
        ],
    ],
)
def test_a_mended_crow(src: Path, mends: list[Mend]) -> None:
    """In the parameter file, in the node, or for all nodes; and launch files anywhere in share."""
    change(src / "crow", *mends)
    assert troubleshooting.crow().startswith("Right")


@pytest.mark.parametrize(
    ("mends", "complaint"),
    [
        ([], "'crow.launch.py' was not found"),
        ([NODE], "'crow.launch.py' was not found"),
        ([LAUNCH], r"drives at 0\.5 m/s"),
        ([LAUNCH, ("config/speed.yaml", "drive:", "driver")], "Found: "),
        ([LAUNCH, NODE, ("launch/crow.launch.py", '"driver"', '"drivr"')], "'drivr' not found"),
    ],
)
def test_a_crow_that_is_not_mended(src: Path, mends: list[Mend], complaint: str) -> None:
    """What launch says is shown, or the speed that is wrong."""
    change(src / "crow", *mends)
    with pytest.raises(CheckError, match=complaint):
        troubleshooting.crow()


@pytest.mark.parametrize("letters", [("b", "c", "a"), ("B", "C", "A"), (" b", "c ", "a")])
def test_the_right_causes(letters: tuple[str, ...]) -> None:
    """However the letters are written."""
    assert troubleshooting.causes(*letters).startswith("Right")


@pytest.mark.parametrize(
    "letters", [(), ("b", "c"), ("a", "c", "a"), ("b", "a", "a"), ("b", "c", "x"), ("b", "c", "a", "a")]
)
def test_wrong_causes(letters: tuple[str, ...]) -> None:
    """Too few, too many, another letter, no letter."""
    with pytest.raises(CheckError):
        troubleshooting.causes(*letters)


@pytest.mark.parametrize("answer", [("jackdaw", "c"), ("Jackdaw", "C"), (" jackdaw ", "c")])
def test_the_silent_one(answer: tuple[str, ...]) -> None:
    """However it is written."""
    assert troubleshooting.silent_one(*answer).startswith("Right")


@pytest.mark.parametrize(
    ("answer", "complaint"),
    [
        ((), "0 answers"),
        (("jackdaw",), "1 answers"),
        (("magpie", "c"), "start (one|the other)"),
        (("jackdaw", "a"), "topic list"),
        (("jackdaw", "b"), "names the type"),
        (("jackdaw", "d"), "how fast"),
        (("jackdaw", "qos"), "the letters are"),
    ],
)
def test_another_one(answer: tuple[str, ...], complaint: str) -> None:
    """Each wrong answer has a nudge of its own."""
    with pytest.raises(CheckError, match=complaint):
        troubleshooting.silent_one(*answer)


@pytest.mark.parametrize("name", troubleshooting.PATIENTS)
def test_the_colleague_finds_what_is_wrong_and_nothing_else(src: Path, name: str) -> None:
    """`ros2lab diagnose`, which the lesson recommends, knows every patient; the magpie is the healthy one."""
    findings = of_workspace(src / name)
    assert bool(findings) == (name != "magpie"), findings


def test_the_healthy_robot_is_healthy(src: Path) -> None:
    """Otherwise each of its copies would have one fault more than the lesson says."""
    troubleshooting.make_healthy_robot()
    assert of_workspace(course.student_path(troubleshooting.CLINIC)) == []
