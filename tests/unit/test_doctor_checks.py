"""The doctor's checks judge an environment as it is; whatever goes wrong in one is a row."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from ros2lab import environment
from ros2lab.verbs import doctor
from ros2lab.verbs.doctor_report import Diagnosis, Finding


@pytest.fixture
def judge(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Finding, ...]]:
    """Run one check on an environment of which only some variables are given."""

    def run(check: Callable[..., object], **environ: str) -> tuple[Finding, ...]:
        monkeypatch.setattr(doctor, "_CHECKS", (check,))
        return doctor.examine({"HOME": "/root", "PATH": "/usr/bin:/bin", **environ}).findings

    return run


@pytest.mark.parametrize(
    ("text", "status"),
    [
        ("0", "ok"),
        ("101", "ok"),
        ("102", "warning"),
        ("232", "warning"),
        ("233", "failed"),
        ("-1", "failed"),
        ("abc", "failed"),
        ("4.5", "failed"),
        ("", "failed"),
        ("٣", "failed"),
    ],
)
def test_domain(judge: Callable[..., tuple[Finding, ...]], text: str, status: str) -> None:
    """Ports decide: above 101 they may be taken, above 232 there are none."""
    (finding,) = judge(doctor._domain, ROS_DOMAIN_ID=text)
    assert finding.status == status
    assert (finding.fix == "unset ROS_DOMAIN_ID") == (status != "ok")


def test_own_domain(judge: Callable[..., tuple[Finding, ...]]) -> None:
    """Without a setting it is the lab's choice, and said to be."""
    (finding,) = judge(doctor._domain)
    assert finding.found == f"{environment.own_domain()} (the lab's choice for you)"


@pytest.mark.parametrize(
    ("reach", "status"),
    [("LOCALHOST", "ok"), ("SUBNET", "warning"), ("SYSTEM_DEFAULT", "warning"), ("OFF", "failed"), ("near", "warning")],
)  # fmt: skip
def test_discovery(judge: Callable[..., tuple[Finding, ...]], reach: str, status: str) -> None:
    """Only OFF keeps the nodes of one machine apart."""
    (finding,) = judge(doctor._discovery, ROS_AUTOMATIC_DISCOVERY_RANGE=reach)
    assert finding.status == status


@pytest.mark.parametrize(
    ("name", "value", "status"),
    [
        ("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp", "failed"),
        ("ROS_LOCALHOST_ONLY", "1", "warning"),
        ("ROS_DISCOVERY_SERVER", "127.0.0.1:11811", "warning"),
        ("ROS_STATIC_PEERS", "10.0.0.2", "warning"),
        ("ROS_SECURITY_ENABLE", "true", "failed"),
        ("ROS_PYTHON_CHECK_FIELDS", "", "warning"),
        ("FASTRTPS_DEFAULT_PROFILES_FILE", "/nowhere.xml", "warning"),
        ("ROS_DISTRO", "humble", "warning"),
        ("AMENT_PREFIX_PATH", "/nowhere", "warning"),
        ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "1", "failed"),
    ],
)
def test_settings_that_hurt(
    judge: Callable[..., tuple[Finding, ...]], name: str, value: str, status: str
) -> None:
    """Each is a row of its own name, with what to type."""
    findings = {finding.name: finding for finding in judge(doctor._settings, **{name: value})}
    assert findings[name].status == status
    assert findings[name].fix


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp"),
        ("ROS_PYTHON_CHECK_FIELDS", "1"),
        ("ROS_SECURITY_ENABLE", "false"),
        ("ROS_DISTRO", "jazzy"),
        ("AMENT_PREFIX_PATH", "/usr"),
        ("PYTHONPATH", "/usr"),
        ("FASTRTPS_DEFAULT_PROFILES_FILE", __file__),
    ],
)
def test_settings_that_do_no_harm(judge: Callable[..., tuple[Finding, ...]], name: str, value: str) -> None:
    """What works is not complained of."""
    assert [finding.status for finding in judge(doctor._settings, **{name: value})] == ["ok"]


def test_another_ros_on_the_path(judge: Callable[..., tuple[Finding, ...]], tmp_path: Path) -> None:
    """An rclpy on PYTHONPATH is another one than the lab's."""
    (tmp_path / "rclpy").mkdir()
    (finding,) = judge(doctor._settings, PYTHONPATH=str(tmp_path))
    assert (finding.name, finding.status) == ("PYTHONPATH", "failed")
    assert str(tmp_path) in finding.found


def test_log_folder(judge: Callable[..., tuple[Finding, ...]], tmp_path: Path) -> None:
    """A node cannot start without a place for its log; the settings that say where come in ROS's order."""
    assert judge(doctor._logs, HOME="/proc/none")[0].status == "failed"
    assert judge(doctor._logs, HOME="")[0].status == "failed"
    assert judge(doctor._logs, HOME="/proc/none", ROS_HOME=str(tmp_path))[0].values == {
        "path": str(tmp_path / "log")
    }
    assert (
        judge(doctor._logs, HOME="/proc/none", ROS_LOG_DIR=str(tmp_path / "new" / "logs"))[0].status == "ok"
    )


def test_a_check_that_fails_is_a_row(judge: Callable[..., tuple[Finding, ...]]) -> None:
    """Nothing that a check raises becomes a traceback."""

    def _odd_thing(_: object) -> Finding:
        raise RuntimeError("the machine is on fire")

    assert judge(_odd_thing) == (
        Finding("odd thing", "failed", "could not be looked at: RuntimeError: the machine is on fire"),
    )


def test_diagnosis() -> None:
    """A warning does not keep the lab from working; both shapes show all there is, as text."""
    fine = Finding("a", "ok", "<b>fine</b>", values={"n": 1})
    odd = Finding("b", "warning", "odd", "fix it")
    bad = Finding("c", "failed", "bad [red]", "fix that")
    assert Diagnosis((fine, odd)).is_ok
    diagnosis = Diagnosis((fine, odd, bad))
    assert not diagnosis.is_ok
    assert repr(diagnosis) == "Diagnosis(is_ok=False)"
    told = json.loads(diagnosis.as_json())
    assert set(told) == {"schema", "ros2lab", "is_ok", "checks"}
    assert told["schema"] == 1
    assert told["checks"][0] == {
        "name": "a",
        "status": "ok",
        "found": "<b>fine</b>",
        "fix": "",
        "values": {"n": 1},
    }
    page = diagnosis._repr_html_()
    assert page.startswith('<details class="doctor" open><summary')
    assert "Look at: b, c." in page
    well = Diagnosis((fine, fine))._repr_html_()
    assert well.startswith('<details class="doctor"><summary')
    assert "2 of 2 checks are ok" in well
    assert "&lt;b&gt;fine" in page
    assert "fix that" in page
