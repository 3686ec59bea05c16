"""What the installer decides and says, without installing anything."""

from __future__ import annotations

import ast
import errno
import fcntl
import importlib.util
import json
import os
import queue
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from deadlines import DEADLINE

SOURCE = Path(__file__).parents[2] / "tools" / "bootstrap.py"
THIS = f"{sys.version_info[0]}.{sys.version_info[1]}"


def _load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("bootstrap", SOURCE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


bootstrap = _load()


PROJECTS = (".", "src/portable_ros2")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A project in a folder with spaces and foreign letters, that has a working .venv/bin/python."""
    root = tmp_path / "mein Kurs ü"
    (root / "locks").mkdir(parents=True)
    (root / "locks" / "student.txt").write_text("a==1\n")
    for project in PROJECTS:
        (root / project).mkdir(parents=True, exist_ok=True)
        (root / project / "pyproject.toml").write_text("[project]\n")
    (root / ".venv" / "bin").mkdir(parents=True)
    (root / ".venv" / "bin" / "python").symlink_to(sys.executable)
    return root


@pytest.fixture
def installed(root: Path) -> Any:
    """What that .venv holds: everything for a student."""
    content = bootstrap.wanted_content(root, None, "student", is_chosen=False)
    bootstrap.write_content(root / ".venv", content)
    return content


def test_an_old_python_can_read_the_installer() -> None:
    ast.parse(SOURCE.read_text(encoding="utf-8"), feature_version=(3, 6))


@pytest.mark.parametrize(
    ("platform", "machine", "largest", "named"),
    [
        ("linux", "aarch64", 2**63 - 1, "64-bit Python on aarch64 linux"),
        ("darwin", "x86_64", 2**63 - 1, "x86_64 darwin"),
        ("linux", "x86_64", 2**31 - 1, "32-bit Python"),
    ],
)
def test_another_machine_gets_a_sentence(platform: str, machine: str, largest: int, named: str) -> None:
    with pytest.raises(bootstrap.Stop, match=named):
        bootstrap.check_machine(platform, machine, largest)


def test_this_kind_of_machine_will_do() -> None:
    bootstrap.check_machine("linux", "x86_64", 2**63 - 1)


@pytest.mark.parametrize(("version", "age"), [((3, 9), "3.9 is too old"), ((3, 15), "3.15 is too new")])
def test_an_unfit_python_gets_a_sentence(
    root: Path, monkeypatch: pytest.MonkeyPatch, version: tuple[int, int], age: str
) -> None:
    monkeypatch.setattr(bootstrap, "THIS_PYTHON", version)
    monkeypatch.setenv("PATH", str(root))  # where there is no other
    with pytest.raises(bootstrap.Stop, match=age):
        bootstrap.choose_python(root, is_chosen=False)


def test_an_old_python_hands_over_to_a_newer_one(root: Path, started: list[list[str]]) -> None:
    bootstrap.THIS_PYTHON = (3, 9)
    newer = _fake_python(root / "bin", "python3.13", "3.13")
    with pytest.raises(_Replaced):
        bootstrap.choose_python(root, is_chosen=False)
    assert started[0][:2] == [newer, str(SOURCE)]


def test_an_old_python_hands_over_to_that_of_the_venv(
    root: Path, installed: Any, started: list[list[str]]
) -> None:
    bootstrap.THIS_PYTHON = (3, 9)
    with pytest.raises(_Replaced):
        bootstrap.choose_python(root, is_chosen=False)
    assert started[0][0] == str(root / ".venv" / "bin" / "python")


def test_a_python_that_was_asked_for_does_not_hand_over(root: Path, started: list[list[str]]) -> None:
    bootstrap.THIS_PYTHON = (3, 9)
    _fake_python(root / "bin", "python3.13", "3.13")
    with pytest.raises(bootstrap.Stop, match="too old"):
        bootstrap.choose_python(root, is_chosen=True)
    assert not started


def test_an_installed_jazzy_gets_the_python_it_was_made_for(
    root: Path, started: list[list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    _sourced_jazzy(root / "jazzy", monkeypatch)
    fitting = _fake_python(root / "bin", "python3.12", "3.12")
    bootstrap.THIS_PYTHON = (3, 11)
    with pytest.raises(_Replaced):
        bootstrap.choose_python(root, is_chosen=False)
    assert started[0][0] == fitting
    bootstrap.THIS_PYTHON = (3, 12)
    bootstrap.choose_python(root, is_chosen=False)
    assert bootstrap.choose_ros(root, (3, 12)) == str(root / "jazzy")
    assert bootstrap.choose_ros(root, (3, 11)) == "wheels"


def test_pythons_that_only_look_like_one_are_passed_over(root: Path) -> None:
    """Those that pyenv puts there for versions it does not start end with 127; a link may lead anywhere."""
    bin_ = root / "bin"
    _fake_python(bin_, "python3.12", None)
    _fake_python(bin_, "python3.11", "3.9")
    good = _fake_python(bin_, "python3.10", "3.10")
    assert list(bootstrap.other_pythons({"PATH": str(bin_)})) == [(good, (3, 10))]


@pytest.mark.parametrize(
    ("version", "system", "is_debian", "advice"),
    [
        ((3, 11), (3, 11), True, "`sudo apt install python3-venv`"),
        ((3, 12), (3, 11), True, "`sudo apt install python3.12-venv`"),
        ((3, 12), None, False, "your system's package"),
    ],
)
def test_a_missing_venv_module_is_named_with_its_package(
    version: tuple[int, int], system: tuple[int, int] | None, is_debian: bool, advice: str
) -> None:
    assert advice in bootstrap.venv_sentence(version, system, is_debian)


def test_nothing_is_done_where_everything_is_installed(
    root: Path, installed: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bootstrap, "Installation", None)  # whoever uses it fails
    bootstrap.bootstrap(root, "student", is_chosen=False)
    assert not (root / ".venv" / bootstrap.LOCK).exists()


@pytest.mark.parametrize("group", ["student", "instructor", "development"])
def test_a_larger_group_holds_a_smaller_one(root: Path, group: str) -> None:
    everything = bootstrap.wanted_content(root, None, "development", is_chosen=False)
    assert bootstrap.wanted_content(root, everything, group, is_chosen=False) == everything


def test_another_group_is_added_and_none_taken_away(root: Path, installed: Any) -> None:
    wanted = bootstrap.wanted_content(root, installed, "instructor", is_chosen=False)
    assert wanted.groups == ("student", "instructor")
    assert bootstrap.can_update(installed, wanted)


def test_new_locks_get_a_new_venv(root: Path, installed: Any) -> None:
    (root / "locks" / "student.txt").write_text("a==2\n")
    wanted = bootstrap.wanted_content(root, installed, "student", is_chosen=False)
    assert not bootstrap.can_update(installed, wanted)


@pytest.mark.parametrize("project", PROJECTS)
def test_new_metadata_is_installed_into_the_same_venv(root: Path, installed: Any, project: str) -> None:
    (root / project / "pyproject.toml").write_text("[project]\nname='b'\n")
    wanted = bootstrap.wanted_content(root, installed, "student", is_chosen=False)
    assert wanted != installed
    assert bootstrap.can_update(installed, wanted)


def test_the_python_of_a_venv_stays_until_another_is_asked_for(root: Path, installed: Any) -> None:
    older = installed._replace(python="3.10" if THIS != "3.10" else "3.11")
    assert bootstrap.wanted_content(root, older, "student", is_chosen=False).python == older.python
    chosen = bootstrap.wanted_content(root, older, "student", is_chosen=True)
    assert chosen.python == THIS
    assert not bootstrap.can_update(older, chosen)


def test_an_installed_jazzy_takes_the_place_of_the_wheels(
    root: Path, installed: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bootstrap, "THIS_PYTHON", (3, 12))
    before = installed._replace(python="3.12")
    _sourced_jazzy(root / "jazzy", monkeypatch)
    wanted = bootstrap.wanted_content(root, before, "student", is_chosen=False)
    assert wanted.ros == str(root / "jazzy")
    assert not bootstrap.can_update(before, wanted)


def _without_stamp(root: Path) -> None:
    (root / ".venv" / bootstrap.STAMP).unlink()


def _with_spoilt_stamp(root: Path) -> None:
    (root / ".venv" / bootstrap.STAMP).write_text('{"project"')


def _with_stamp_of_another_release(root: Path) -> None:
    (root / ".venv" / bootstrap.STAMP).write_text(json.dumps({"groups": ["student"], "colour": "red"}))


def _without_its_python(root: Path) -> None:
    (root / ".venv" / "bin" / "python").unlink()
    (root / ".venv" / "bin" / "python").symlink_to("/usr/bin/python3.1")


def _with_an_upgraded_python(root: Path) -> None:
    (root / ".venv" / "bin" / "python").unlink()
    _fake_python(root / ".venv" / "bin", "python", "3.7")


@pytest.mark.parametrize(
    "spoil",
    [
        _without_stamp,
        _with_spoilt_stamp,
        _with_stamp_of_another_release,
        _without_its_python,
        _with_an_upgraded_python,
    ],
)
def test_a_half_made_venv_counts_as_none(root: Path, installed: Any, spoil: Callable[[Path], None]) -> None:
    assert bootstrap.read_content(root) == installed
    spoil(root)
    assert bootstrap.read_content(root) is None
    assert not bootstrap.can_update(None, installed)


def test_a_moved_venv_counts_as_none(root: Path, installed: Any) -> None:
    moved = root.rename(root.with_name("moved"))
    assert bootstrap.read_content(moved) is None


def test_a_foreign_venv_is_left_alone(root: Path) -> None:
    with pytest.raises(bootstrap.Stop, match="move it away"), bootstrap.locked(root / ".venv"):
        pass
    assert [path.name for path in (root / ".venv").iterdir()] == ["bin"]


@pytest.mark.parametrize("make", [lambda path: None, Path.mkdir], ids=["absent", "empty"])
def test_a_new_venv_is_ours(tmp_path: Path, make: Callable[[Path], None]) -> None:
    make(tmp_path / ".venv")
    with bootstrap.locked(tmp_path / ".venv"):
        pass
    with bootstrap.locked(tmp_path / ".venv"):  # also when only half of it was made
        pass


def test_the_activation_is_extended_once(root: Path) -> None:
    """The shell that activates the .venv gets the course's settings."""
    activate = root / ".venv" / "bin" / "activate"
    activate.write_text("deactivate () { :; }\n")
    with (root / "lock").open("w") as lock:
        installation = bootstrap.Installation(root, None, lock)
        installation.extend_activation()
        installation.extend_activation()
    assert activate.read_text().count("ros2lab.environment") == 1
    assert activate.read_text().startswith("deactivate () { :; }\n")


def test_what_the_boxes_of_the_grader_run_is_compiled(root: Path) -> None:
    """A box can store no compiled module, and without one each grade compiles colcon and the observer anew."""
    site = root / ".venv" / "lib" / "python3.11" / "site-packages"
    modules = [
        root / "src" / "ros2lab" / "observer.py",
        site / "colcon_core" / "verb.py",
        site / "another" / "part.py",
    ]
    for module in modules:
        module.parent.mkdir(parents=True)
        module.write_text("")
    with (root / "lock").open("w") as lock:
        bootstrap.Installation(root, None, lock.fileno()).compile_for_boxes()
    assert [Path(importlib.util.cache_from_source(str(one))).exists() for one in modules] == [
        True,
        True,
        False,
    ]


def test_a_file_in_the_place_of_the_venv_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / ".venv").write_text("mine")
    with pytest.raises(bootstrap.Stop, match="move it away"), bootstrap.locked(tmp_path / ".venv"):
        pass
    assert (tmp_path / ".venv").read_text() == "mine"


def test_the_second_of_two_says_that_it_waits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    has_waited = threading.Event()

    def second() -> None:
        with bootstrap.locked(tmp_path / ".venv"):
            has_waited.set()

    said: queue.Queue[str] = queue.Queue()
    monkeypatch.setattr(bootstrap, "_say", said.put)
    thread = threading.Thread(target=second)
    with bootstrap.locked(tmp_path / ".venv"):
        thread.start()
        assert "waiting for it" in said.get(timeout=DEADLINE)
        assert not has_waited.is_set()
    assert has_waited.wait(10)
    thread.join(10)


def test_the_lock_lasts_as_long_as_a_program_that_installs(tmp_path: Path, root: Path) -> None:
    """Or else one that is started after a kill -9 would work against what the first has left running."""
    with bootstrap.locked(root / "new") as lock:
        installation = bootstrap.Installation(root, None, lock)
        installation.log = tmp_path / "log"
        test = "import fcntl, sys; fcntl.flock({}, fcntl.LOCK_EX | fcntl.LOCK_NB)"
        assert installation.step("with the lock", [sys.executable, "-c", test.format(lock)])
        with (root / "new" / bootstrap.LOCK).open() as other, pytest.raises(BlockingIOError):
            fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_a_folder_that_cannot_be_written_gets_a_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not even root can make a folder in /sys."""
    monkeypatch.setattr(bootstrap, "ROOT", Path("/sys/kernel"))
    assert bootstrap.main(["student"]) == 1
    said = capsys.readouterr().err
    assert "cannot be written to: copy the project to a folder of your own" in said
    assert "Traceback" not in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (errno.EROFS, "cannot be written to"),
        (errno.EACCES, "cannot be written to"),
        (errno.ENOSPC, "disk is full"),
        (errno.EDQUOT, "disk is full"),
        (errno.EIO, "Input/output error"),
    ],
)
def test_an_error_of_the_system_gets_a_sentence(number: int, words: str) -> None:
    sentence = bootstrap.os_sentence(Path("/course"), OSError(number, os.strerror(number), "/course/.venv"))
    assert words in sentence
    assert "run this" in sentence


@pytest.mark.parametrize(
    ("log", "free", "words"),
    [
        ("error: dns error: failed to lookup address information", 1e12, "connect this computer"),
        ("NewConnectionError: [Errno 101] Network is unreachable", 1e12, "connect this computer"),
        ("OSError: [Errno 28] No space left on device", 1e12, "disk is full"),
        ("Temporary failure in name resolution", 1e6, "disk is full"),
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES", 1e12, "the reason is at the end of"),
    ],
)
def test_a_failed_installation_says_why(log: str, free: float, words: str) -> None:
    sentence = bootstrap.failure_sentence(Path("/course"), Path("/course/.venv/install.log"), log, free)
    assert words in sentence
    assert words == "disk is full" or "/course/.venv/install.log" in sentence


def test_ctrl_c_is_one_sentence_and_exit_code_130(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(bootstrap, "bootstrap", interrupted)
    assert bootstrap.main(["student"]) == 130
    assert capsys.readouterr().err.startswith("Interrupted: ")


def test_packages_beside_the_project_are_installed_without_a_network(tmp_path: Path) -> None:
    """No index is asked by either installer, and both look there."""
    (tmp_path / "wheels").mkdir()
    result = bootstrap.child_environment({}, tmp_path)
    assert {result["PIP_NO_INDEX"], result["UV_NO_INDEX"]} == {"1"}
    assert {result["PIP_FIND_LINKS"], result["UV_FIND_LINKS"]} == {str(tmp_path / "wheels")}


def test_what_leads_an_installer_elsewhere_is_taken_out_of_its_environment(tmp_path: Path) -> None:
    environ = {"PYTHONPATH": "/else", "PIP_USER": "1", "PIP_INDEX_URL": "https://mirror", "HOME": "/home/x"}
    result = bootstrap.child_environment(environ, tmp_path)
    assert "PYTHONPATH" not in result
    assert result["PIP_USER"] == "0"
    assert result["PIP_INDEX_URL"] == "https://mirror"
    assert result["UV_PYTHON_DOWNLOADS"] == "never"
    assert result["UV_SYSTEM_CERTS"] == "1"
    assert "UV_NO_INDEX" not in result


class _Replaced(BaseException):
    """Stands for the end of this process when another program takes its place."""


@pytest.fixture
def started(root: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[list[str]]]:
    """The command lines of the programs that took the place of this one. Only those in root/bin are found."""
    commands: list[list[str]] = []

    def replace(_path: str, command: list[str]) -> None:
        commands.append(command)
        raise _Replaced

    monkeypatch.setattr(os, "execv", replace)
    monkeypatch.setattr(bootstrap, "THIS_PYTHON", bootstrap.THIS_PYTHON)  # put back afterwards
    monkeypatch.setenv("PATH", str(root / "bin"))
    return commands


def _fake_python(folder: Path, name: str, version: str | None) -> str:
    """Write a program that answers as a Python of this version, or as pyenv does for one it does not have."""
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(f"#!/bin/sh\necho {version}\n" if version else "#!/bin/sh\nexit 127\n")
    path.chmod(0o755)
    return str(path)


def _sourced_jazzy(prefix: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Make up an installed Jazzy for Python 3.12, and source it."""
    package = prefix / "lib" / "python3.12" / "site-packages" / "rclpy"
    package.mkdir(parents=True)
    (package / "_rclpy_pybind11.cpython-312-x86_64-linux-gnu.so").touch()
    (prefix / "share" / "rclpy").mkdir(parents=True)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
