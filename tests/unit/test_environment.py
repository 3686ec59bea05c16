"""One ROS 2 is chosen, and only its folders are on the path."""

from __future__ import annotations

import fcntl
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from ros2lab import environment


def make_prefix(folder: Path, python: str = "3.12") -> Path:
    """Make a folder that looks like an installed Jazzy for one Python."""
    rclpy = folder / "lib" / f"python{python}" / "site-packages" / "rclpy"
    rclpy.mkdir(parents=True)
    (rclpy / f"_rclpy_pybind11.cpython-{python.replace('.', '')}-x86_64-linux-gnu.so").touch()
    (folder / "share" / "rclpy").mkdir(parents=True)
    (folder / "setup.bash").write_text(
        f'export ROS_DISTRO=jazzy AMENT_PREFIX_PATH="{folder}" PYTHONPATH="{rclpy.parent}"\n'
        f'export LD_LIBRARY_PATH="{folder}/lib" PATH="{folder}/bin:$PATH"\n'
    )
    return folder


def sourced(prefix: Path, distribution: str = "jazzy") -> dict[str, str]:
    return {
        "ROS_DISTRO": distribution,
        "AMENT_PREFIX_PATH": f"{prefix}:/elsewhere",
        "PATH": f"{prefix}/bin:/usr/bin",
    }


def test_nothing_installed_takes_the_wheels(tmp_path: Path) -> None:
    """A machine without ROS uses pip's, and says why."""
    found = environment.find_ros({}, (3, 12), tmp_path / "none", has_wheels=True)
    assert (found.kind, found.prefix) == ("wheels", None)
    assert "no Jazzy is sourced" in found.reason


def test_neither_is_said_with_its_fix(tmp_path: Path) -> None:
    """Without wheels and without Jazzy the fix is named."""
    found = environment.find_ros({}, (3, 12), tmp_path / "none", has_wheels=False)
    assert found.kind == "missing"
    assert "make lab" in found.reason


def test_an_installed_jazzy_wins(tmp_path: Path) -> None:
    """It need not be sourced."""
    prefix = make_prefix(tmp_path / "jazzy")
    found = environment.find_ros({}, (3, 12), prefix, has_wheels=True)
    assert (found.kind, found.prefix, found.is_sourced) == ("installed", prefix, False)


def test_a_sourced_jazzy_wins_over_an_installed_one(tmp_path: Path) -> None:
    """A Jazzy built from source and sourced is meant."""
    own, system = make_prefix(tmp_path / "own"), make_prefix(tmp_path / "system")
    found = environment.find_ros(sourced(own), (3, 12), system, has_wheels=True)
    assert (found.kind, found.prefix, found.is_sourced) == ("installed", own, True)


@pytest.mark.parametrize("is_sourced", [True, False])
def test_a_jazzy_for_another_python_is_not_used(tmp_path: Path, is_sourced: bool) -> None:
    """Its compiled half would not load."""
    prefix = make_prefix(tmp_path / "jazzy", "3.12")
    environ = sourced(prefix) if is_sourced else {}
    found = environment.find_ros(environ, (3, 11), prefix, has_wheels=True)
    assert found.kind == "wheels"
    assert "not for Python 3.11" in found.reason


def test_another_distribution_is_not_used(tmp_path: Path) -> None:
    """A sourced Humble is named and left alone."""
    prefix = make_prefix(tmp_path / "humble")
    found = environment.find_ros(sourced(prefix, "humble"), (3, 12), tmp_path / "none", has_wheels=True)
    assert found.kind == "wheels"
    assert "humble" in found.reason


def test_a_sourced_workspace_without_rclpy_is_looked_through(tmp_path: Path) -> None:
    """An overlay stands before its underlay on the path; the underlay is found."""
    prefix = make_prefix(tmp_path / "jazzy")
    environ = {"ROS_DISTRO": "jazzy", "AMENT_PREFIX_PATH": f"{tmp_path}/ws/install/pk:{prefix}"}
    assert environment.find_ros(environ, (3, 12), tmp_path / "none", has_wheels=True).prefix == prefix


def test_the_wheels_environment_holds_nothing_of_a_sourced_ros(tmp_path: Path) -> None:
    """Never both on one path: the folders of a sourced Humble go, the user's own stay."""
    prefix = make_prefix(tmp_path / "humble")
    environ = {
        **sourced(prefix, "humble"),
        "PYTHONPATH": f"{prefix}/lib/python3.10/site-packages:/home/me/python",
        "LD_LIBRARY_PATH": f"{prefix}/lib",
        environment.WHEELS_GUARD: "1",
    }
    source = environment.find_ros(environ, (3, 12), tmp_path / "none", has_wheels=True)
    result = environment.lab_environment(environ, source)
    assert not [name for name, value in result.items() if str(prefix) in value]
    assert result["PYTHONPATH"] == "/home/me/python"
    assert "ROS_DISTRO" not in result
    assert environment.WHEELS_GUARD not in result
    assert result["PATH"].endswith(":/usr/bin")


def test_the_guard_of_these_wheels_stays_for_a_program_and_goes_for_a_shell(tmp_path: Path) -> None:
    """It saves a program a second start; in a shell somebody may start another Python, with its own wheels."""
    libraries = f"/elsewhere:{Path(sys.prefix, 'lib')}"
    environ = {environment.WHEELS_GUARD: "1", "LD_LIBRARY_PATH": libraries}
    source = environment.find_ros(environ, (3, 12), tmp_path / "none", has_wheels=True)
    assert environment.lab_environment(environ, source)[environment.WHEELS_GUARD] == "1"
    assert environment.WHEELS_GUARD not in environment.terminal_environment(tmp_path, environ)
    stale = environ | {"LD_LIBRARY_PATH": "/elsewhere"}
    assert environment.WHEELS_GUARD not in environment.lab_environment(stale, source)


def test_the_environment_of_an_installed_jazzy_comes_from_bash(tmp_path: Path) -> None:
    """Its setup file is sourced, not imitated; spaces in its path do no harm."""
    prefix = make_prefix(tmp_path / "my own jazzy")
    source = environment.find_ros({}, (3, 12), prefix, has_wheels=True)
    result = environment.lab_environment({"PATH": "/usr/bin:/bin", "HOME": "/root"}, source)
    assert result["AMENT_PREFIX_PATH"] == str(prefix)
    assert result["ROS_DISTRO"] == "jazzy"
    assert result["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"


def test_a_setup_file_that_fails_is_one_sentence(tmp_path: Path) -> None:
    """The sentence names the file and what bash said."""
    prefix = make_prefix(tmp_path / "jazzy")
    (prefix / "setup.bash").write_text("echo broken >&2; return 1\n")
    source = environment.find_ros({}, (3, 12), prefix)
    with pytest.raises(RuntimeError, match=r"setup.bash could not be sourced: broken"):
        environment.lab_environment({"PATH": "/usr/bin:/bin"}, source)


def test_what_the_user_has_set_stays() -> None:
    """The lab adds settings and overrides none."""
    settings = environment.lab_settings({"ROS_DOMAIN_ID": "0", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"})
    assert "ROS_DOMAIN_ID" not in settings
    assert "ROS_AUTOMATIC_DISCOVERY_RANGE" not in settings
    assert settings["ROS_PYTHON_CHECK_FIELDS"] == "1"


def test_a_discovery_server_keeps_its_own_profile() -> None:
    """Whoever has another discovery does not get the lab's."""
    assert "FASTRTPS_DEFAULT_PROFILES_FILE" not in environment.lab_settings({"ROS_DISCOVERY_SERVER": "x:1"})


def test_domains_are_safe_steady_and_differ() -> None:
    """Every user gets a domain from 1 to 101, always the same, and few share one."""
    domains = [environment.own_domain(f"{user}:/home/{user}") for user in range(1000)]
    assert set(domains) == set(range(1, 102))
    assert environment.own_domain() == environment.own_domain()


def test_only_shared_memory_of_the_dead_is_removed(tmp_path: Path) -> None:
    """A locked file, a new one and a stranger's stay, and a port, which has no lock; not one that was never initialized."""
    old, initialized = time.time() - 60, bytes((2, 0, 0, 0))
    for name, content in (
        ("fastrtps_dead", initialized),
        ("fastrtps_dead_el", b""),
        ("sem.fastrtps_dead_mutex", b""),
        ("fastrtps_alive_el", b""),
        ("fastrtps_port7411", initialized),
        ("fastrtps_port7413", b""),
        ("fastrtps_port7415", bytes((1, 0, 0, 0, 0))),
        ("sem.fastrtps_port7415_mutex", b""),
        ("fastrtps_port7411_sl", b""),
        ("other_el", b""),
    ):
        (tmp_path / name).write_bytes(content)
        os.utime(tmp_path / name, (old, old))
    (tmp_path / "fastrtps_new_el").touch()
    (tmp_path / "fastrtps_new").touch()
    with (tmp_path / "fastrtps_alive_el").open() as alive:
        fcntl.flock(alive, fcntl.LOCK_EX)
        removed = environment.remove_dead_shared_memory(tmp_path)
    assert sorted(removed) == [
        "fastrtps_dead",
        "fastrtps_dead_el",
        "fastrtps_port7413",
        "fastrtps_port7415",
        "sem.fastrtps_dead_mutex",
        "sem.fastrtps_port7415_mutex",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "fastrtps_alive_el",
        "fastrtps_new",
        "fastrtps_new_el",
        "fastrtps_port7411",
        "fastrtps_port7411_sl",
        "other_el",
    ]


def test_an_environment_with_lines_and_signs_is_read() -> None:
    """Values may hold line ends and equals signs."""
    assert environment.parse_environment(b"A=1\0B=x=y\nz\0C=\0") == {"A": "1", "B": "x=y\nz", "C": ""}


def test_the_shell_lines_give_bash_what_the_lab_has(tmp_path: Path) -> None:
    """What is set stays, what the lab has not goes, and a second time there is nothing to do."""
    before = {
        "PATH": "/usr/bin:/bin",
        "ROS_DOMAIN_ID": "7",
        "HOME": str(tmp_path),
        "PYTHONDONTWRITEBYTECODE": "1",
        **sourced(tmp_path / "humble", "humble"),
    }
    wanted = environment.lab_environment(before)
    lines = environment.shell_lines(before)
    finished = subprocess.run(
        ["bash", "--norc", "-c", 'eval "$1"; env -0', "bash", lines],
        env=before,
        capture_output=True,
        check=True,
    )
    after = environment.parse_environment(finished.stdout)
    assert {name: after[name] for name in wanted} == wanted
    assert not {"PYTHONDONTWRITEBYTECODE", "ROS_DISTRO"} & after.keys()
    assert after["ROS_DOMAIN_ID"] == "7"
    assert environment.shell_lines(after) == ""


def test_the_shell_lines_hold_whatever_signs_a_value_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder's name is no command."""
    value = 'it\'s $(touch here) `id`\n"quoted" ü'
    monkeypatch.setattr(environment, "lab_environment", lambda _: {"A": value})
    lines = environment.shell_lines({})
    finished = subprocess.run(
        ["bash", "-c", 'eval "$1"; printf %s "$A"', "bash", lines], capture_output=True, check=True, text=True
    )
    assert finished.stdout == value
