"""Parameter files are read as rcl reads them: each one here is given to a real node, too."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import UNKNOWN
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.nodes.parameter_faults import replaced_values, unread_file
from ros2lab.diagnose.sources.parameter_file import (
    ParameterFileError,
    UnreadParameterFileError,
    kind_of,
    read_parameter_file,
)

HEAD = "/**:\n  ros__parameters:\n"
VALUES = """\
    1 +1 -3 010 08 0x10 0b11 1_000 1:30 1. 1.5 .5 -.5 1e3 1e-3 1e 0x1p3 inf -.inf nan .NaN 9223372036854775807 9223372036854775808 1e999 0x1p9999
    yes Yes yEs y Y n on ON off no true TRUE tRue ~ null 0,3 2s 2024-01-01 '1' "on" abc %b
    [1,2] [1,2.0] [true,1] [a,1] ['a',b] [on,off] [[1],[2]]
"""
# What is wrong in a file, its line, and what its fix says.
REFUSED = {
    "a list for a name": ("? [a, b]\n: 1\n" + HEAD + "    p: 1\n", 1, "write a name"),
    "a mapping for a parameter": (HEAD + "    ? {a: b}\n    : 1\n", 3, "write a name"),
    "no value": (f"{HEAD}    p:\n", 3, "write a value"),
    "a comment for a value": (f"{HEAD}    p: #abc\n", 3, "in quotes if it begins with #"),
    "no parameters": (HEAD, 2, "write a parameter below it"),
    "only comments": (f"a:\n  ros__parameters:\n    # p: 1\n{HEAD}    p: 1\n", 2, "or remove it"),
    "only comments, and the node again": (f"{HEAD}    # p: 1\n    \n{HEAD}    p: 1\n", 2, "or remove it"),
    "only comments at the end": (f"{HEAD}    p: 1\na:\n  ros__parameters:\n    # q: 1\n", 5, "or remove it"),
    "nothing below the key": (f"{HEAD}p: 1\n", 3, "write `p: 1`, beginning with 4 spaces"),
    "the key's column": (f"{HEAD}  p: 1\n", 3, "write `p: 1`, beginning with 4 spaces"),
    "a lone line without a space": (f"{HEAD}    p:1\n", 3, "write `p: 1`"),
    "an equals sign": (f"{HEAD}    p = 1\n", 3, "write `p: 1`"),
    "a line without a space above another": (f"{HEAD}    p:1\n    q: 1\n", 3, "write `p: 1`"),
    "a line without a colon": (f"{HEAD}    p 1\n    q: 2\n", 3, "write `p: 1`"),
    "a line without a space between others": (f"{HEAD}    o: a\n    p:1\n    q: 1\n", 4, "write `p: 1`"),
    "lines without spaces": (
        f"{HEAD}    o: a\n    p:1\n    q:2\n    r: 3\n",
        4,
        "write `p: 1`, and the lines below it likewise",
    ),
    "a line without a space above a comment": (
        f"{HEAD}    o: a\n    p:1\n\n    # q\n    q: 1\n",
        4,
        "write `p: 1`",
    ),
    "no node": ("ros__parameters:\n  p: 1\n", 1, "write the node's name"),
    "a value beside": (f"{HEAD}    p: 1\n  q: 1\n", 4, "write `q: 1`, beginning with 4 spaces"),
    "a value outside": (f"q: 1\n{HEAD}    p: 1\n", 1, "indent it like the parameters"),
    "deeper": (f"{HEAD}    p: 1\n     q: 1\n", 4, "write `q: 1`, beginning with 4 spaces"),
    "less deep": (f"{HEAD}    p: 1\n   q: 1\n", 4, "write `q: 1`, beginning with 4 spaces"),
    "a tab": ("/**:\n\tros__parameters:\n    p: 1\n", 2, "write `ros__parameters:`, beginning with 2 spaces"),
    "an open quote": (f"{HEAD}    p: 'abc\n    q: 1\n", 3, "write `p: 'abc'`"),
    "an open bracket": (f"{HEAD}    p: [1, 2\n    q: 3\n", 3, "write `p: [1, 2]`"),
    "two colons": (f"{HEAD}    p: a: b\n", 3, "write `p: 'a: b'`"),
    "a sign": (f"{HEAD}    p: @x\n", 3, "write `p: '@x'`"),
    "an alias": (f"{HEAD}    p: *x\n", 3, "write `p: '*x'`"),
    "a star for a node": ("*:\n  ros__parameters:\n    p: 1\n", 1, "write `'*':`"),
    "a control character": (f"{HEAD}    p: 'a\x01'\n", 3, "save the file as UTF-8"),
    "a null byte": (f"{HEAD}    p: 1\n    q: a\0\n", 4, "save the file as UTF-8"),
}


def given_by_rcl(file: Path) -> dict[str, Any] | None:
    """Return the parameters that a node gets from a file, by name; None if rcl refuses the file."""
    context = Context()
    try:
        context.init(["--ros-args", "--params-file", str(file)])
    except RuntimeError:
        return None
    try:
        node = Node("some", context=context, automatically_declare_parameters_from_overrides=True)
        given = {one.name: one for one in node.get_parameters_by_prefix("").values()}
        node.destroy_node()
    finally:
        context.shutdown()
    return {name: one for name, one in given.items() if name in ("p", "q")}


@pytest.mark.parametrize("written", VALUES.split())
def test_a_value_has_the_type_that_rcl_gives_it(tmp_path: Path, written: str) -> None:
    file = tmp_path / "some.yaml"
    file.write_text(f"{HEAD}    p: {written}\n")
    theirs = given_by_rcl(file)
    if theirs is None:
        with pytest.raises(ParameterFileError):
            read_parameter_file(file.read_text())
        return
    ours = read_parameter_file(file.read_text())["/**"]["ros__parameters"]["p"]
    assert kind_of(ours) == theirs["p"].type_.name
    assert str(Parameter("p", value=ours).value) == str(theirs["p"].value)


@pytest.mark.parametrize(
    "written",
    ["p: 1\t# one", "p: 1\t", "p:\t1", "p\t: 1", "p: 'a\tb'", "p: a\tb", "p: [1,\t2]\t", "p: 'a'\t\t# a"],
)
def test_a_tab_is_right_where_rcl_takes_it(tmp_path: Path, written: str) -> None:
    file = tmp_path / "some.yaml"
    file.write_text(f"/**:\t# all\n  ros__parameters:\t\n    {written}\n    q: 2\n")
    theirs = given_by_rcl(file)
    assert theirs is not None
    ours = read_parameter_file(file.read_text())["/**"]["ros__parameters"]
    assert ours == {
        name: list(one.value) if "[" in str(one.value) else one.value for name, one in theirs.items()
    }


@pytest.mark.parametrize(("text", "line", "fix"), REFUSED.values(), ids=REFUSED.keys())
def test_what_rcl_refuses_is_told_where_it_stands(tmp_path: Path, text: str, line: int, fix: str) -> None:
    file = tmp_path / "some.yaml"
    file.write_text(text)
    assert given_by_rcl(file) is None
    with pytest.raises(ParameterFileError) as refused:
        read_parameter_file(text)
    found = unread_file("some.yaml", text, refused.value)
    assert found.place == f"some.yaml:{line}"
    assert fix in found.fix


@pytest.mark.parametrize(
    "value", ["[10, 22.5, 45]", "[1, 'a']", "[1.5, 2, true]", "[[1, 2], [3]]", "[1.5, two]"]
)
def test_values_that_do_not_go_together_are_no_slip_of_typing(value: str) -> None:
    """YAML reads them as they are meant: no sign is to be left out, and no number changed."""
    text = f"{HEAD}    p: {value}\n"
    with pytest.raises(ParameterFileError) as refused:
        read_parameter_file(text)
    assert unread_file("some.yaml", text, refused.value).fix == refused.value.fix


LEVELS = "".join(f"{' ' * depth}n{depth}:\n" for depth in range(60))
TOO_LARGE = {
    "a long comment": (f"{HEAD}    p: 1\n# {'#' * 100_000}\n", "more than 100000 characters", None),
    "a long value": (f"{HEAD}    p: {'1' * 100_000}\n", "more than 100000 characters", None),
    "many lines": (
        HEAD + "".join(f"    p{n}: 1\n" for n in range(10_000)),
        "more than 100000 characters",
        None,
    ),
    "deep names": (
        f"{LEVELS}{' ' * 60}ros__parameters:\n{' ' * 61}p: 1\n",
        "nested more than 50 levels deep",
        51,
    ),
    "deep lists": (f"{HEAD}    p: {'[' * 60}1{']' * 60}\n", "nested more than 50 levels deep", 3),
    "deep braces": ("{n: " * 60 + "1" + "}" * 60 + "\n", "nested more than 50 levels deep", 1),
}


@pytest.mark.parametrize(("text", "reason", "line"), TOO_LARGE.values(), ids=TOO_LARGE.keys())
def test_what_is_too_large_is_said_to_be(tmp_path: Path, text: str, reason: str, line: int | None) -> None:
    with pytest.raises(UnreadParameterFileError) as refused:
        read_parameter_file(text)
    assert reason in str(refused.value)
    assert refused.value.line == line
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    (file,) = root.rglob("robot.yaml")
    file.write_text(text)
    (found,) = [one for one in Look(root).findings if one.code == UNKNOWN]
    assert f"is not read here: it {'has' if line is None else 'is'} {reason}" in found.cause
    assert "spaces" not in found.fix
    assert "nobody writes this much" in found.fix


@pytest.mark.parametrize(
    ("text", "reason"),
    [(f"launch: []\n{'#' * 100_000}", "more than 100000 characters"), ("[" * 60, "levels deep")],
)
def test_a_launch_file_that_is_too_large_is_said_to_be(tmp_path: Path, text: str, reason: str) -> None:
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    (file,) = root.rglob("*.launch.py")
    file.with_name("more.launch.yaml").write_text(text)
    (found,) = [one for one in Look(root).findings if one.code == UNKNOWN]
    assert "is not read here" in found.cause
    assert reason in found.cause
    assert "nobody writes this much" in found.fix


def test_of_a_file_too_large_to_be_read_here_the_words_of_ros_are_told(tmp_path: Path) -> None:
    root = Files.right(NAMES[0]).write(tmp_path / "ws")
    (file,) = root.rglob("robot.yaml")
    file.write_text(TOO_LARGE["a long comment"][0])
    said = f"Couldn't parse params file: '--params-file {file}'. Error: Sequences can only be values, at ./src/parse.c:12"
    assert "Sequences can only be values" in of_text(said, root)[0].cause


@pytest.mark.parametrize(
    "text",
    [
        f"{HEAD}    p: 1\n---\nleft:\n  ros__parameters:\n    q: 1\n",
        f"# mine\n---\n{HEAD}    a:\n      p: 1\n",
        "left:\n  talker:\n    ros__parameters: {p: 1, 'q': [1, 2]}\n",
        f"{HEAD}    p: 'a: b'\n    y: 1\n",
        f"{HEAD}    p:\n    - 1\n    - 2\n",
    ],
)
def test_what_rcl_reads_is_read(tmp_path: Path, text: str) -> None:
    file = tmp_path / "some.yaml"
    file.write_text(text)
    assert given_by_rcl(file) is not None
    read_parameter_file(text)


@pytest.mark.parametrize(
    ("declared", "written", "fix"),
    [
        ("2.0", "2", "write period: 2.0"),
        ("2.0", "0,3", "write period: 0.3"),
        ("2.0", "2 s", "write period: 2.0"),
        ("2.0", "'2'", "write period: 2.0"),
        ("2", "2.5", "declare period with a default of type DOUBLE"),
        ("2", "two", "give it a value of type INTEGER"),
        ("'slow'", "on", "period: 'on'"),
        ("'slow'", "12", "period: '12'"),
        ("True", "1", "true or false"),
        ("[1.0]", "2.0", "write a list: period: [2.0]"),
    ],
)
def test_a_value_of_another_type_than_declared(tmp_path: Path, declared: str, written: str, fix: str) -> None:
    files = Files.right(NAMES[0]).change("node", "'period', 2.0", f"'period', {declared}")
    root = files.change("config/robot.yaml", "period: 2.0", f"period: {written}").write(tmp_path / "ws")
    (found,) = [one for one in Look(root).findings if one.code == "parameter-type"]
    assert fix in found.fix
    assert found.place.endswith("robot.yaml:3")


SOME = "some:\n  ros__parameters:\n"
# A file that sets p twice, the value that is lost, and the value that counts.
REPLACED = {
    "one mapping": (f"{SOME}    p: 3.0\n    q: 2\n\n    # late\n    p: 90.0\n", "3.0", "90.0"),
    "quotes": (f"{SOME}    'p': 3\n    q: 1\n    p: 4\n", "3", "4"),
    "the node again": (f"{SOME}    p: 3\n{SOME}    q: 1\n    p: 4\n", "3", "4"),
    "the node again, with nothing else": (f"{SOME}    p: 3\n{SOME}    p: 4\n", "3", "4"),
    "the node again, with a slash": (f"{SOME}    p: 3\n/{SOME}    p: 4\n", "3", "4"),
    "a pattern after the node": (f"{SOME}    p: 3\n{HEAD}    p: 4\n", "3", "4"),
    "lists": (f"{SOME}    p:\n      - 1\n      - 2\n    q: 1\n    p: [3,\n      4]\n", "- 1 - 2", "[3, 4]"),
    "another type": (f"{SOME}    p: 'true'\n    q: 5\n    p: true\n", "'true'", "true"),
    "braces": (f"{SOME}    p: 1\n    q: 5\n    p: 2  # now\n", "1", "2"),
}


@pytest.mark.parametrize(("text", "lost", "last"), REPLACED.values(), ids=REPLACED.keys())
def test_a_value_that_a_later_line_replaces(tmp_path: Path, text: str, lost: str, last: str) -> None:
    """Either of the two removals that are told leaves the value that it is told for."""
    file = tmp_path / "some.yaml"
    read_parameter_file(text)
    (found,) = replaced_values("some.yaml", text)
    assert f"to {lost} on line" in found.cause
    assert f"to {last} for the same node" in found.cause
    told = re.findall(
        r"lines? (\d+)(?: to (\d+))? if (.+?)(?: is meant, or |$)", found.fix.removesuffix(" is")
    )
    assert [value for _, _, value in told] == [lost, last]
    given = []
    for first, end, _ in told:
        lines = text.splitlines()
        del lines[int(first) - 1 : int(end or first)]
        file.write_text("\n".join(lines))
        given.append(given_by_rcl(file) or {})
        assert not [*replaced_values("some.yaml", file.read_text())]
    file.write_text(text)
    now = given_by_rcl(file) or {}
    assert given[0]["p"].value != now["p"].value == given[1]["p"].value
    assert {found.get("q") and found["q"].value for found in (*given, now)} == {
        now.get("q") and now["q"].value
    }


@pytest.mark.parametrize(
    "text",
    [
        f"{SOME}    p: 1\nother:\n  ros__parameters:\n    p: 2\n",
        f"{HEAD}    p: 1\n{SOME}    p: 2\n",
        f"left:\n  {SOME.replace('  ros', '    ros')}      p: 1\nright:\n  {SOME.replace('  ros', '    ros')}      p: 2\n",
        f"{SOME}    x:\n      p: 1\n    y:\n      p: 2\n    p: 3\n",
        f"{SOME}    p: 1\n{SOME}    q: 2\n",
        f"{SOME}    p: 1\n    p: 1\n",
        f"{SOME}    p: False\n    p: false\n",
        f"{SOME}    p: 1.0\n    p: 1.00\n",
        f"{SOME}    p: 'a'\n    p: a\n",
        f"{SOME}    p: [1, 2]\n    p:\n      - 1\n      - 2\n",
    ],
)
def test_values_that_all_count_are_right(text: str) -> None:
    read_parameter_file(text)
    assert not [*replaced_values("some.yaml", text)]


def test_a_node_that_is_written_twice_has_the_values_of_both() -> None:
    content = read_parameter_file(f"{SOME}    x: {{a: 1}}\n{SOME}    q: 2\n    x: {{b: 3}}\n")
    assert content["some"]["ros__parameters"] == {"x": {"a": 1, "b": 3}, "q": 2}


@pytest.mark.parametrize(
    ("text", "fix"),
    [
        (f"{SOME}    p: 1\n  ros__parameters:\n    q: 2\n", "remove this line"),
        (
            f"{SOME}    p: 1\n  ros__parameters:\n      q: 2\n",
            "move the parameters below it to those below line 2",
        ),
    ],
)
def test_ros_parameters_twice_in_one_node(tmp_path: Path, text: str, fix: str) -> None:
    file = tmp_path / "some.yaml"
    file.write_text(text)
    assert given_by_rcl(file) is None
    with pytest.raises(ParameterFileError) as refused:
        read_parameter_file(text)
    found = unread_file("some.yaml", text, refused.value)
    assert found.place == "some.yaml:4"
    assert fix in found.fix
    lines = text.splitlines()
    del lines[3]
    file.write_text("\n".join(line.replace(" " * 6, " " * 4) for line in lines))
    given = given_by_rcl(file)
    assert given is not None
    assert sorted(given) == ["p", "q"]


def test_a_value_that_is_replaced_on_its_own_line() -> None:
    (found,) = replaced_values("some.yaml", "some:\n  ros__parameters: {p: 1, q: 3, p: 2}\n")
    assert found.fix == "remove `p: 2` if 1 is meant, or `p: 1` if 2 is"


@pytest.mark.parametrize(
    ("value", "lists"),
    [
        ("[{name: a, x: 1.5}, {name: b, x: 3}]", ["name: [a, b]", "x: [1.5, 3.0]", "stops.name and stops.x"]),
        ("[{x: 1}, {x: 2}]", ["below stops: x: [1, 2];"]),
        ("[[0, 1.5], [2, 3]]", ["stops: [0.0, 1.5, 2.0, 3.0]"]),
        ('[["a b", c], d]', ['stops: ["a b", c, d]']),
        ("[[0, 1.5], [a, 3]]", ["for each thing that it holds"]),
        ("[{name: a}, {x: 1}]", ["for each thing that it holds"]),
        ("[{}, {}]", ["for each thing that it holds"]),
    ],
)
def test_lists_of_lists_and_of_mappings_are_written_as_lists_that_a_parameter_can_hold(
    value: str, lists: list[str]
) -> None:
    with pytest.raises(ParameterFileError) as caught:
        read_parameter_file(f"node:\n  ros__parameters:\n    stops: {value}\n")
    assert all(text in caught.value.fix for text in lists)
