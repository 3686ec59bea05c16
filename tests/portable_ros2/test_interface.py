"""`ros2 interface`: which types there are, and how they are defined."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from portable_ros2 import interfaces

Ros2 = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def own_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with a message, a service and an action, in a prefix of its own before the others."""
    share = tmp_path / "prefix" / "share"
    index = share / "ament_index" / "resource_index"
    for kind in ("packages", "rosidl_interfaces"):
        (index / kind).mkdir(parents=True)
    (index / "packages" / "own").touch()
    files = {
        "msg/Pose.msg": "# a place\n\nstd_msgs/Header header   # when\nOther[<=3] others\nint32 MOST=3 # at most\n"
        'string<=5 name "a#b"\nfloat64[2] place\n',
        "msg/Other.msg": "# inner\nbool is_there # or not\n",
        "srv/Ask.srv": "string question\n---\nbool is_understood\n",
        "action/Go.action": "float32 far\n---\n---\nfloat32 gone\n",
    }
    names = []
    for name, text in files.items():
        path = share / "own" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        names += [str(Path(name).with_suffix(".idl")), name]
    (index / "rosidl_interfaces" / "own").write_text("\n".join(sorted(names)))
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))
    return share / "own"


def test_fields_are_told_from_constants_comments_and_separators(own_package: Path) -> None:
    nested = {line.code: line.nested for line in interfaces.definition("own/msg/Pose")}
    assert nested == {
        "": None,
        "std_msgs/Header header": "std_msgs/msg/Header",
        "Other[<=3] others": "own/msg/Other",
        "int32 MOST=3": None,
        'string<=5 name "a#b"': None,
        "float64[2] place": None,
    }


def test_a_definition_is_shown_with_what_it_holds(ros2: Ros2, own_package: Path) -> None:
    """Comments of the type itself are shown, those of nested types only if asked for."""
    shown = ros2("interface", "show", "own/msg/Pose")
    assert (shown.returncode, shown.stderr) == (0, "")
    assert shown.stdout.splitlines() == [
        "# a place",
        "",
        "std_msgs/Header header   # when",
        "\tbuiltin_interfaces/Time stamp",
        "\t\tint32 sec",
        "\t\tuint32 nanosec",
        "\tstring frame_id",
        "Other[<=3] others",
        "\tbool is_there",
        "int32 MOST=3 # at most",
        'string<=5 name "a#b"',
        "float64[2] place",
    ]
    assert "# inner" in ros2("interface", "show", "--all-comments", "own/msg/Pose").stdout
    bare = ros2("interface", "show", "--no-comments", "own/msg/Pose").stdout
    assert "# " not in bare
    assert "\n\n" not in bare


def test_a_service_and_an_action_are_shown_with_their_separators(ros2: Ros2, own_package: Path) -> None:
    assert ros2("interface", "show", "own/srv/Ask").stdout == "string question\n---\nbool is_understood\n"
    assert ros2("interface", "show", "own/action/Go").stdout == "float32 far\n---\n---\nfloat32 gone\n"


def test_the_type_may_come_from_a_pipe(ros2: Ros2) -> None:
    shown = ros2("interface", "show", "-", text="std_msgs/msg/String\n")
    assert shown.stdout.splitlines()[-1] == "string data"
    assert ros2("interface", "show", "-").returncode == 2


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("String", "Invalid name 'String'. Expected three parts separated by '/'"),
        ("std_msgs/String", "Invalid name 'std_msgs/String'"),
        ("nowhere/msg/String", "Unknown package 'nowhere'"),
        ("std_msgs/msg/Strin", "Could not find the interface"),
        ("std_msgs//String", "Invalid name"),
        ("/msg/String", "Invalid name"),
    ],
)
def test_what_is_not_there_gets_a_sentence(ros2: Ros2, name: str, words: str) -> None:
    shown = ros2("interface", "show", name)
    assert (shown.returncode, shown.stdout) == (1, "")
    assert words in shown.stderr
    assert "Traceback" not in shown.stderr


def test_lists(ros2: Ros2, own_package: Path) -> None:
    """All types by kind, a package's types, and the packages that have a kind."""
    listed = ros2("interface", "list").stdout.splitlines()
    heads = [listed.index(f"{head}:") for head in ("Messages", "Services", "Actions")]
    assert heads == sorted(heads)
    assert heads[0] < listed.index("    own/msg/Pose") < heads[1] < listed.index("    own/srv/Ask") < heads[2]
    assert "    geometry_msgs/msg/Twist" in listed
    assert ros2("interface", "list", "-a").stdout == "Actions:\n    own/action/Go\n"
    assert set(ros2("interface", "package", "own").stdout.split()) == {
        "own/action/Go",
        "own/msg/Other",
        "own/msg/Pose",
        "own/srv/Ask",
    }
    assert ros2("interface", "package", "own", "--only-srvs").stdout == "own/srv/Ask\n"
    assert ros2("interface", "packages", "-a").stdout == "own\n"
    assert "geometry_msgs" in ros2("interface", "packages").stdout.split()
    unknown = ros2("interface", "package", "nowhere")
    assert (unknown.returncode, unknown.stderr) == (1, "Unknown package 'nowhere'\n")


def test_a_prototype_is_what_pub_takes(ros2: Ros2) -> None:
    twist = ros2("interface", "proto", "geometry_msgs/msg/Twist")
    zero = "  x: 0.0\n  y: 0.0\n  z: 0.0\n"
    assert twist.stdout == f'"linear:\n{zero}angular:\n{zero}"\n'
    request = ros2("interface", "proto", "--no-quotes", "std_srvs/srv/SetBool")
    assert request.stdout.strip() == "data: false"
    assert ros2("interface", "proto", "std_msgs/msg/Nothing").returncode == 1


@pytest.mark.parametrize("verb", ["start", "stop", "status"])
def test_no_daemon_is_needed(ros2: Ros2, verb: str) -> None:
    said = ros2("daemon", verb)
    assert said.returncode == 0
    assert "none and needs none" in said.stdout
