"""The doctor works on a machine that does not, and says what is wrong with it."""

from __future__ import annotations

import contextlib
import importlib.metadata
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest

import ros2lab
from deadlines import DEADLINE
from ros2lab.verbs.doctor import examine

CHECKS = [
    "system", "python", "ros2lab", "ROS 2", "rclpy", "common interfaces", "colcon", "ros2 command",
    "setuptools", "jupyterlab",
    "domain", "discovery", "settings", "logs", "bash", "disk", "shared memory", "network", "message",
]  # fmt: skip
COMMAND = ["-c", "from ros2lab.cli import main; main()", "doctor"]


def diagnose(*before: str, python: str | Path = sys.executable, **environ: str) -> tuple[dict[str, Any], int]:
    """Run the command with changes to the environment; return each row by name, and the exit code."""
    finished = subprocess.run(
        [*before, python, *COMMAND, "--json"],
        env={**os.environ, **environ},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in finished.stdout + finished.stderr
    told = json.loads(finished.stdout)
    rows = {check["name"]: check for check in told["checks"]}
    assert (
        told["is_ok"] == (finished.returncode == 0) == all(row["status"] != "failed" for row in rows.values())
    )
    assert all(row["fix"] for row in rows.values() if row["status"] != "ok")
    return rows, finished.returncode


def without_privileges(*options: str) -> list[str]:
    """Begin a command that runs in namespaces of its own, as root or as anybody else."""
    return ["unshare", *([] if os.geteuid() == 0 else ["--map-root-user"]), *options]


def test_a_machine_that_works() -> None:
    """Every row is there, in its order, and a real message has come through; a notebook shows it as a table."""
    diagnosis = examine()
    assert diagnosis.is_ok, diagnosis.as_json()
    assert diagnosis._repr_html_().count("<tr>") == 1 + len(CHECKS)
    rows = {check["name"]: check for check in json.loads(diagnosis.as_json())["checks"]}
    assert list(rows) == CHECKS
    assert rows["rclpy"]["values"]["version"].startswith("7.")
    assert rows["message"]["values"]["message_s"] > 0
    assert rows["message"]["values"]["discovery_s"] > 0
    assert rows["domain"]["values"]["domain_id"] == os.environ["ROS_DOMAIN_ID"]


def test_table() -> None:
    """Without --json there is a table, also in a terminal that knows no letters but ASCII."""
    finished = subprocess.run(
        [sys.executable, *COMMAND],
        env={**os.environ, "LC_ALL": "POSIX", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0", "COLUMNS": "80"},
        capture_output=True,
        check=False,
    )
    assert finished.returncode == 0
    text = finished.stdout.decode("ascii")
    assert all(name in text for name in CHECKS)


@pytest.mark.parametrize(
    ("environ", "failed", "fix"),
    [
        pytest.param(
            {"HOME": "/proc/none"}, {"logs", "message"}, "export ROS_LOG_DIR=", marks=pytest.mark.thorough
        ),
        (
            {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"},
            {"RMW_IMPLEMENTATION", "rclpy", "common interfaces", "message"},
            "unset RMW_IMPLEMENTATION",
        ),
        pytest.param(
            {"ROS_DOMAIN_ID": "mine"},
            {"domain", "message"},
            "unset ROS_DOMAIN_ID",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"},
            {"discovery", "message"},
            "unset ROS_AUTOMATIC_DISC",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            {"ROS2LAB_WORK": "/proc/none/work"},
            {"disk"},
            "ROS2LAB_WORK=~/ros2lab-work make lab",
            marks=pytest.mark.thorough,
        ),
        pytest.param(
            {"_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1", "LD_LIBRARY_PATH": ""},
            {"_ROS_WHEELS_BOOTSTRAP_COMPLETE"},
            "unset _ROS_WHEELS_BOOTSTRAP_COMPLETE",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_settings_that_break_the_lab(environ: dict[str, str], failed: set[str], fix: str) -> None:
    """The setting's own row has failed, and the message with it where none can come through."""
    rows, code = diagnose(**environ)
    assert code == 1
    assert {name for name, row in rows.items() if row["status"] == "failed"} == failed
    assert any(fix in row["fix"] for row in rows.values())
    assert not any(row["fix"] == "make lab" for row in rows.values())


def test_another_ros_on_the_path(tmp_path: Path) -> None:
    """An rclpy that cannot be imported, in front of the lab's own."""
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text("raise ImportError('built for another Python')\n")
    rows, code = diagnose(PYTHONPATH=str(tmp_path))
    assert code == 1
    assert "built for another Python" in rows["rclpy"]["found"]
    assert rows["PYTHONPATH"]["status"] == "failed"
    assert str(tmp_path) in rows["PYTHONPATH"]["found"]


def test_almost_nothing_is_installed(tmp_path: Path) -> None:
    """Without ROS, colcon and JupyterLab each is a row that says what installs it."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "bare"], check=True)
    packages = tmp_path / "packages"
    packages.mkdir()
    (packages / "ros2lab").symlink_to(Path(ros2lab.__file__).parent)
    for path in installed_for("typer"):
        (packages / path.name).symlink_to(path)
    rows, code = diagnose(
        python=tmp_path / "bare" / "bin" / "python", PYTHONPATH=str(packages), PATH="/usr/bin:/bin"
    )
    assert code == 1
    for name in ("ROS 2", "rclpy", "common interfaces", "colcon", "ros2 command", "jupyterlab"):
        assert rows[name]["status"] == "failed", rows[name]
        assert rows[name]["fix"] == 'pip install "ros2lab[ros]"'  # it is no checkout
    assert rows["rclpy"]["found"] == "cannot be imported: ModuleNotFoundError: No module named 'rclpy'"
    assert rows["network"]["status"] == "ok"


@pytest.mark.thorough  # as a ros2 that does not run
def test_colcon_does_not_run(tmp_path: Path) -> None:
    """A colcon that is there and fails is not taken for one that works."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "bare"], check=True)
    colcon = tmp_path / "bare" / "bin" / "colcon"
    colcon.write_text("#!/bin/sh\necho 'error: no module named colcon' >&2; exit 3\n")
    colcon.chmod(0o755)
    paths = os.pathsep.join(path for path in sys.path if path)
    rows, code = diagnose(python=tmp_path / "bare" / "bin" / "python", PYTHONPATH=paths)
    assert code == 1
    assert rows["colcon"]["status"] == "failed"
    assert "does not run: error: no module named colcon" in rows["colcon"]["found"]


@pytest.mark.parametrize(
    ("code", "status", "found"),
    [
        pytest.param(2, "ok", "that of the installed ROS 2", marks=pytest.mark.thorough),
        (3, "failed", "does not run: error: what broke"),
    ],
)
def test_another_ros2_command(tmp_path: Path, code: int, status: str, found: str) -> None:
    """Where there is a real one, that is looked at: it knows no --version, which is a wrong usage."""
    ros2 = tmp_path / "ros2"
    ros2.write_text(f"#!/bin/sh\necho 'error: what broke' >&2; exit {code}\n")
    ros2.chmod(0o755)
    rows, _ = diagnose(PATH=f"{tmp_path}:{os.environ['PATH']}")
    assert rows["ros2 command"]["status"] == status
    assert found in rows["ros2 command"]["found"]


def test_no_network() -> None:
    """In a network namespace of its own even the loopback interface is down."""
    rows, code = diagnose(*without_privileges("--net"))
    assert code == 1
    assert {name for name, row in rows.items() if row["status"] == "failed"} == {"network", "message"}
    assert rows["network"]["fix"] == "sudo ip link set lo up"


@pytest.mark.thorough
def test_no_shared_memory() -> None:
    """A /dev/shm that cannot be written is a warning: messages come through all the same."""
    mount = 'mount -t tmpfs -o ro none /dev/shm && exec "$@"'
    rows, code = diagnose(*without_privileges("--mount"), "sh", "-c", mount, "sh")
    assert code == 0
    assert rows["shared memory"]["status"] == "warning"
    assert rows["message"]["status"] == "ok"


def test_interrupt() -> None:
    """Ctrl-C ends it with 130, quietly, and leaves nothing running."""
    with subprocess.Popen(
        [sys.executable, *COMMAND],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Discovery is off, so that it would look for its second half for many seconds.
        env={**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"},
        start_new_session=True,
    ) as process:
        children: dict[psutil.Process, list[str]] = {}
        while process.poll() is None and not any("ping" in words for words in children.values()):
            children = running_children(process.pid)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.02)
        os.killpg(process.pid, signal.SIGINT)
        output, errors = process.communicate(timeout=DEADLINE)
    assert process.returncode == 130
    assert "Traceback" not in output + errors
    _, alive = psutil.wait_procs(list(children), timeout=DEADLINE)
    assert alive == []


def installed_for(*distributions: str) -> set[Path]:
    """Return what is installed in site-packages for these distributions and all that they need."""
    found: set[Path] = set()
    seen: set[str] = set()
    waiting = list(distributions)
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        distribution = importlib.metadata.distribution(name)
        for file in distribution.files or []:
            if file.parts[0] not in ("..", "__pycache__"):
                found.add(Path(str(distribution.locate_file(file.parts[0]))))
        needs = [
            need for need in distribution.requires or [] if "extra ==" not in need and "Windows" not in need
        ]
        waiting += [re.split(r"[^\w.-]", need)[0] for need in needs]
    return found


def running_children(pid: int) -> dict[psutil.Process, list[str]]:
    """Return the processes below one with their command lines, without those that end meanwhile."""
    found = {}
    for child in psutil.Process(pid).children(recursive=True):
        with contextlib.suppress(psutil.Error):
            found[child] = child.cmdline()
    return found
