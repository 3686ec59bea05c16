"""`ros2 param`, as a student types it beside a running node."""

from __future__ import annotations

import math
import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from portable_ros2.commands.param import _parameters, dump

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]
Worker = Callable[..., "subprocess.Popen[str]"]
NAMES = [
    *("a.b", "count", "fixed", "flags", "free", "is_on", "names", "numbers", "rate", "speed"),
    *("start_type_description_service", "steps", "use_sim_time", "xs"),
]
PARAMETERS = {
    "a": {"b": "text"},
    "count": 3,
    "fixed": 7,
    "flags": [True, False],
    "free": None,
    "is_on": True,
    "names": ["a", "b"],
    "numbers": [1, 2],
    "rate": 2.5,
    "speed": 1.5,
    "start_type_description_service": True,
    "steps": 4,
    "use_sim_time": False,
    "xs": [1.0, 2.5],
}


def test_list(ros2: Ros2, worker: Worker) -> None:
    """Names stand in order, below the node if none was named."""
    worker()
    indented = "".join(f"  {name}\n" for name in NAMES)
    assert ros2("param", "list", "/ns/worker").stdout == indented
    assert ros2("param", "list").stdout == f"/ns/worker:\n{indented}"
    assert ros2("param", "list", "ns/worker", "--filter", "s.*").stdout == (
        "  speed\n  start_type_description_service\n  steps\n"
    )
    assert ros2("param", "list", "/ns/worker", "--param-prefixes", "a", "xs").stdout == "  a.b\n  xs\n"
    typed = ros2("param", "list", "/ns/worker", "--param-type").stdout.splitlines()
    assert typed[:5] == [
        "  a.b (type: string)",
        "  count (type: integer)",
        "  fixed (type: integer)",
        "  flags (type: boolean array)",
        "  free (type: not set)",
    ]


def test_get(ros2: Ros2, worker: Worker) -> None:
    """Each type has its words, which can be hidden."""
    worker()
    for name, shown in (
        ("rate", "Double value is: 2.5\n"),
        ("names", "String values are: ['a', 'b']\n"),
        ("free", "Parameter not set.\n"),
    ):
        result = ros2("param", "get", "/ns/worker", name)
        assert (result.returncode, result.stdout, result.stderr) == (0, shown, "")
    assert ros2("param", "get", "--hide-type", "ns/worker", "xs").stdout == "[1.0, 2.5]\n"
    result = ros2("param", "get", "/ns/worker", "nothing")
    assert (result.returncode, result.stdout, result.stderr) == (1, "", "Parameter not set\n")


def test_set_and_delete(ros2: Ros2, worker: Worker) -> None:
    """What the node refuses is told on standard error, with exit code 0 as in Jazzy."""
    worker()
    for words, output, error in (
        (("set", "rate", "3.5"), "Set parameter successful\n", ""),
        (("set", "names", "[x, y]"), "Set parameter successful\n", ""),
        (("set", "rate", "3"), "", "Setting parameter failed: Wrong parameter type"),
        (("set", "speed", "5.0"), "", "Setting parameter failed: Parameter speed out of range"),
        (("set", "fixed", "8"), "", "Setting parameter failed: Trying to set a read-only parameter: fixed."),
        (("set", "nothing", "8"), "", "Setting parameter failed: Invalid access to undeclared parameter"),
        (("delete", "free"), "Deleted parameter successfully\n", ""),
        (("delete", "rate"), "", "Deleting parameter failed: Static parameter cannot be undeclared"),
    ):
        result = ros2("param", words[0], "/ns/worker", *words[1:])
        assert (result.returncode, result.stdout) == (0, output), words
        assert result.stderr.startswith(error) if error else result.stderr == "", words
    assert ros2("param", "get", "--hide-type", "/ns/worker", "rate").stdout == "3.5\n"


def test_describe(ros2: Ros2, worker: Worker) -> None:
    """Descriptions and limits are shown."""
    worker()
    result = ros2("param", "describe", "/ns/worker", "speed", "fixed", "steps")
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == (
        "Parameter name: speed\n"
        "  Type: double\n"
        "  Description: A speed in m/s\n"
        "  Constraints:\n"
        "    Min value: 0.0\n"
        "    Max value: 2.0\n"
        "    Step: 0.5\n"
        "Parameter name: fixed\n"
        "  Type: integer\n"
        "  Constraints:\n"
        "    Read only: true\n"
        "    Additional constraints: always seven\n"
        "Parameter name: steps\n"
        "  Type: integer\n"
        "  Constraints:\n"
        "    Min value: 1\n"
        "    Max value: 9\n"
    )


def test_dump_and_load(ros2: Ros2, worker: Worker, tmp_path: Path) -> None:
    """What was dumped can be loaded, by the same node and by a new one."""
    worker()
    dumped = ros2("param", "dump", "/ns/worker").stdout
    assert yaml.safe_load(dumped) == {"/ns/worker": {"ros__parameters": PARAMETERS}}
    assert dumped.startswith("/ns/worker:\n  ros__parameters:\n    a:\n      b: text\n    count: 3\n")
    (tmp_path / "file.yaml").write_text(
        "/ns/worker: {ros__parameters: {rate: 9.5, speed: 9.0, a: {b: nested}}}\n"
        "/**: {ros__parameters: {count: 5}}\n"
    )
    result = ros2("param", "load", "/ns/worker", "file.yaml")
    assert result.returncode == 0
    assert sorted(result.stdout.splitlines()) == [
        f"Set parameter {name} successful" for name in ("a.b", "count", "rate")
    ]
    assert result.stderr.startswith("Set parameter speed failed: Parameter speed out of range")
    assert "count" not in ros2("param", "load", "/ns/worker", "file.yaml", "--no-use-wildcard").stdout


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (None, "Cannot read 'file.yaml': No such file or directory"),
        ("[", "'file.yaml' is not valid YAML"),
        ("a: 1", "YAML file is not a valid ROS parameter file for node a"),
        ("", "'file.yaml' is not a ROS parameter file"),
        ("- 1", "'file.yaml' is not a ROS parameter file"),
        ("7", "'file.yaml' is not a ROS parameter file"),
    ],
)
def test_a_wrong_file_ends_with_a_sentence(
    content: str | None, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file that is none, is not YAML or holds no parameters."""
    from portable_ros2.commands.param.load import _read

    monkeypatch.chdir(tmp_path)
    if content is not None:
        Path("file.yaml").write_text(content)
    with pytest.raises(RuntimeError, match=sentence.replace("(", r"\(")):
        _read("file.yaml", use_wildcard=True)


def test_a_missing_node_is_told(ros2: Ros2) -> None:
    """Every verb says so, after the time that it was given."""
    for words in (
        ("list", "/nobody"),
        ("get", "/nobody", "x"),
        ("set", "/nobody", "x", "1"),
        ("describe", "/nobody", "x"),
        ("dump", "/nobody", "--timeout", "0"),
        ("load", "nobody", "file.yaml"),
        ("delete", "/nobody", "x"),
    ):
        result = ros2("param", *words)
        assert (result.returncode, result.stdout, result.stderr) == (1, "", "Node not found\n"), words


def test_a_node_that_does_not_answer_does_not_stop_the_others(ros2: Ros2, worker: Worker) -> None:
    """One that was stopped costs a deadline, and a sentence on standard error."""
    worker()
    stopped = worker("--ros-args", "-r", "__node:=stopped")
    stopped.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, stopped.pid, os.WSTOPPED)
    result = ros2("param", "list")
    assert result.returncode == 0
    assert "/ns/worker:\n  a.b\n" in result.stdout
    assert "Traceback" not in result.stderr


def test_a_wrong_filter_ends_with_a_sentence(ros2: Ros2) -> None:
    """A filter is a regular expression."""
    result = ros2("param", "list", "--filter", "[")
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr.startswith("The filter '[' is no regular expression")


class TestValueFromText:
    """Values as `ros2 param set` takes them."""

    @pytest.mark.parametrize(
        ("text", "value"),
        [
            ("true", True),
            ("False", False),
            ("3", 3),
            ("-0x10", -16),
            ("2.5", 2.5),
            ("1.0e+3", 1000.0),
            ("1.0e3", "1.0e3"),
            (".inf", math.inf),
            ("hello", "hello"),
            ("'3'", "3"),
            ("", ""),
            ("null", "null"),
            ("[true, false]", [True, False]),
            ("[1, 2]", [1, 2]),
            ("[1.0, 2.5]", [1.0, 2.5]),
            ("[a, b]", ["a", "b"]),
            ("[1, 2.5]", "[1, 2.5]"),
            ("[a, 1]", "[a, 1]"),
            ("{a: 1}", "{a: 1}"),
            ("a: b: c", "a: b: c"),
            ("[", "["),
            ("2024-01-01", "2024-01-01"),
            ("@x", "@x"),
            ("9223372036854775807", 2**63 - 1),
        ],
    )
    def test_type_follows_from_yaml(self, text: str, value: Any) -> None:
        from rclpy.parameter import parameter_value_to_python

        found = parameter_value_to_python(_parameters.value_from_text(text))
        assert (type(found), found) == (type(value), value)

    @pytest.mark.parametrize("text", ["9223372036854775808", "[1, -9223372036854775809]"])
    def test_a_number_may_be_too_large(self, text: str) -> None:
        with pytest.raises(RuntimeError, match="does not fit into 64 bits"):
            _parameters.value_from_text(text)


class TestNested:
    """Parameters as a file has them."""

    @pytest.mark.parametrize(
        ("flat", "tree"),
        [
            ({}, {}),
            ({"a": 1}, {"a": 1}),
            ({"a.b": 1, "a.c.d": 2}, {"a": {"b": 1, "c": {"d": 2}}}),
            ({"a": 1, "a.b": 2}, {"a": 1, "a.b": 2}),
        ],
    )
    def test_dots_become_levels(self, flat: dict[str, Any], tree: dict[str, Any]) -> None:
        assert dump.nested(flat) == tree
