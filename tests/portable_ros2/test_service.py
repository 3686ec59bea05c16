"""`ros2 service`, as a student types it beside a running node."""

from __future__ import annotations

import signal
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path

import pytest

from portable_ros2.commands.service import _services

COMMAND = str(Path(sysconfig.get_path("scripts"), "ros2"))
Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Worker = Callable[..., "subprocess.Popen[str]"]
CALLED = (
    "requester: making request: std_srvs.srv.SetBool_Request(data=True)\n\n"
    "response:\nstd_srvs.srv.SetBool_Response(success=True, message='on')\n\n"
)


def test_look_ups(ros2: Ros2, worker: Worker) -> None:
    """`list`, `type`, `find` and `info` tell of visible services, and of hidden ones if asked."""
    worker()
    names = ros2("service", "list").stdout.splitlines()
    assert names == sorted(names)
    assert names[:3] == ["/elsewhere", "/ns/die", "/ns/switch"]  # the first has only a client
    assert len(names) == 10
    assert ros2("service", "list", "-c").stdout == "10\n"
    assert "/ns/switch [std_srvs/srv/SetBool]" in ros2("service", "list", "-t").stdout.splitlines()
    for words in (
        ("service", "list", "--include-hidden-services"),
        ("service", "--include-hidden-services", "list"),
    ):
        assert "/ns/_secret" in ros2(*words).stdout.splitlines()

    assert ros2("service", "type", "/ns/switch").stdout == "std_srvs/srv/SetBool\n"
    assert ros2("service", "find", "std_srvs/srv/Trigger").stdout == "/elsewhere\n/ns/die\n"
    assert ros2("service", "find", "-c", "std_srvs/srv/Trigger", "--include-hidden-services").stdout == "3\n"
    info = ros2("service", "info", "/ns/switch")
    assert info.stdout == "Type: std_srvs/srv/SetBool\nClients count: 0\nServices count: 1\n"


def test_look_ups_without_success(ros2: Ros2) -> None:
    """What is not there is told as Jazzy does."""
    for words, code, output, error in (
        (("list",), 0, "", ""),
        (("list", "-c"), 0, "0\n", ""),
        (("type", "/nothing"), 1, "", ""),
        (("find", "std_srvs/srv/Empty"), 0, "", ""),
        (("info", "/nothing"), 1, "", "Unknown service '/nothing'\n"),
    ):
        result = ros2("service", *words)
        assert (result.returncode, result.stdout, result.stderr) == (code, output, error), words


class TestCall:
    """`ros2 service call`."""

    @pytest.mark.parametrize(
        ("kind", "values"),
        [
            ("std_srvs/srv/SetBool", "{data: true}"),
            ("std_srvs/SetBool", '{"data": true}'),
            ("std_srvs/srv/SetBool", "data: True"),
        ],
    )
    def test_shows_request_and_response(self, kind: str, values: str, ros2: Ros2, worker: Worker) -> None:
        worker()
        result = ros2("service", "call", "/ns/switch", kind, values)
        assert (result.returncode, result.stdout, result.stderr) == (0, CALLED, "")

    def test_default_values_and_standard_input(self, ros2: Ros2, worker: Worker) -> None:
        worker()
        assert "(data=False)" in ros2("service", "call", "/ns/switch", "std_srvs/srv/SetBool").stdout
        words = ("service", "call", "--stdin", "/ns/switch", "std_srvs/srv/SetBool")
        assert ros2(*words, text="data: true\n").stdout == CALLED

    @pytest.mark.parametrize(
        ("words", "sentence"),
        [
            (("std_srvs/srv/Nope",), "The passed service type is invalid"),
            (("nopackage/srv/Nope",), "The passed service type is invalid"),
            (("std_msgs/msg/String",), "The passed service type is invalid"),
            (("word",), "The passed service type is invalid"),
            (("std_srvs/srv/SetBool", "{data: maybe}"), "Failed to populate field"),
            (("std_srvs/srv/SetBool", "{dta: true}"), "Failed to populate field"),
            (("std_srvs/srv/SetBool", "{data: ["), "not valid YAML"),
            (("std_srvs/srv/SetBool", "true"), "needs to be a dictionary"),
            (("std_srvs/srv/SetBool", "{data: true}", "-r", "0"), "rate must be greater than zero"),
            (("std_srvs/srv/SetBool", "{data: true}", "-r", "-2"), "rate must be greater than zero"),
        ],
    )
    def test_wrong_words_end_with_a_sentence(self, words: tuple[str, ...], sentence: str, ros2: Ros2) -> None:
        result = ros2("service", "call", "/service", *words)
        assert (result.returncode, result.stdout) == (1, "")
        assert sentence in result.stderr
        assert "Traceback" not in result.stderr

    def test_a_wrong_name_ends_with_a_sentence(self, ros2: Ros2) -> None:
        result = ros2("service", "call", "/no name", "std_srvs/srv/Empty")
        assert result.returncode == 1
        assert "Invalid service name" in result.stderr
        assert "Traceback" not in result.stderr

    def test_repeats_at_a_rate_until_interrupted(self, worker: Worker, tmp_path: Path) -> None:
        worker()
        words = ["service", "call", "-r", "50", "/ns/switch", "std_srvs/srv/SetBool", "{data: true}"]
        with subprocess.Popen(
            [COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
        ) as process:
            assert process.stdout is not None
            responses = 0
            while responses < 5:
                responses += process.stdout.readline() == "response:\n"
            process.send_signal(signal.SIGINT)
            _, error = process.communicate()
        assert (process.returncode, error) == (signal.SIGINT, "")

    def test_waits_for_a_service_until_interrupted(self, worker: Worker, tmp_path: Path) -> None:
        words = ["service", "call", "/ns/switch", "std_srvs/srv/SetBool", "{data: true}"]
        waiting = "waiting for service to become available...\n"
        with subprocess.Popen(
            [COMMAND, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == waiting
            worker()
            assert process.communicate() == (CALLED, "")
        with subprocess.Popen(
            [COMMAND, "service", "call", "/nothing", "std_srvs/srv/Empty"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == waiting
            process.send_signal(signal.SIGINT)
            _, error = process.communicate()
        assert (process.returncode, error) == (signal.SIGINT, "")


def test_types_complete() -> None:
    """Every service type that is installed completes, and no message."""
    types = _services.service_types()
    assert {"std_srvs/srv/SetBool", "rcl_interfaces/srv/ListParameters"} <= set(types)
    assert types == sorted(types)
    assert not [name for name in types if "/msg/" in name]
