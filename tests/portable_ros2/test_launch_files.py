"""Launch files in Python, XML and YAML: right ones of many kinds, and what wrong ones say."""

from __future__ import annotations

import importlib
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from launch import LaunchContext, LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.frontend import Parser
from launch.frontend.parse_substitution import parse_substitution
from launch.launch_description_sources import (
    AnyLaunchDescriptionSource,
    FrontendLaunchDescriptionSource,
    InvalidLaunchFileError,
    PythonLaunchDescriptionSource,
    get_launch_description_from_any_launch_file,
)
from launch.utilities import perform_substitutions
from launch_xml.launch_description_sources import XMLLaunchDescriptionSource
from launch_yaml.launch_description_sources import YAMLLaunchDescriptionSource

pytestmark = pytest.mark.usefixtures("clean_launch", "prefix")

Launched = Callable[..., tuple[int, list[str]]]
Run = Callable[..., tuple[int, list[str]]]
IMPORTS = """
from launch import *
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.substitutions import *
"""


@pytest.fixture
def run(launched: Launched, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Return a function that launches a text as a file of a name; its folder is the working folder."""
    monkeypatch.chdir(tmp_path)

    def run_file(name: str, text: str, **arguments: str) -> tuple[int, list[str]]:
        (tmp_path / name).write_text(text)
        include = IncludeLaunchDescription(
            AnyLaunchDescriptionSource(name), launch_arguments=arguments.items()
        )
        return launched(include)

    return run_file


def python(body: str, before: str = "") -> str:
    return (
        f"{IMPORTS}\n{before}\ndef generate_launch_description():\n    return LaunchDescription([{body}])\n"
    )


def said(*texts: str) -> list[str]:
    return [f"[INFO] [launch.user]: {text}" for text in texts]


def shown(lines: list[str], name: str = "show") -> list[str]:
    words = [line.partition("] ")[2] for line in lines if line.startswith(f"[{name}] ")]
    return [re.sub(r"^/\S*launch_params_\w+$", "FILE", word) for word in words]


def failed(text: str) -> str:
    return f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {text}"


# Substitutions in texts


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ""),
        ("plain text with 'quotes' and (parentheses)", "plain text with 'quotes' and (parentheses)"),
        ("$(var a)", "A"),
        ("x$(var a)y$(var b)z", "xAyBz"),
        ("$(var nowhere default)", "default"),
        ("$(var nowhere 'two words')", "two words"),
        ('$(var nowhere "two words")', "two words"),
        ("$(var nowhere '')", ""),
        ("$(var nowhere $(var a)$(var b)c)", "ABc"),
        ("$(var nowhere 'x $(var a) y')", "x A y"),
        ("$(var $(var name))", "A"),
        ("$(env SOME_V)", "set"),
        ("$(env NOWHERE other)", "other"),
        ("$(eval '1 + 2')", "3"),
        ("$(eval 1+2)", "3"),
        ("$(eval '$(var five) * 2')", "10"),
        ("$(eval '\\'$(var a)\\' == \\'A\\'')", "True"),
        ("$(eval \"'$(var a)' == 'A'\")", "True"),
        ("$(eval 'os.sep' 'os, math')", "/"),
        ("$(command 'echo -n hello')", "hello"),
        ("$(command 'sh -c \"echo no >&2\"' ignore)", ""),
        ("$(not true)", "false"),
        ("$(and true $(not false))", "true"),
        ("$(or false 0)", "false"),
        ("$(any false true false)", "true"),
        ("$(all true true)", "true"),
        ("$(equals $(var a) A)", "true"),
        ("$(not-equals $(var a) A)", "false"),
        ("$(if true yes no)", "yes"),
        ("$(if false yes)", ""),
        ("$(find-exec true)", re.compile("/.*/true")),
        ("$(find-pkg-share demo)/config", re.compile("/.*/install/share/demo/config")),
        ("$(find-pkg-prefix demo)", re.compile("/.*/install")),
        ("$(exec-in-pkg show demo)", re.compile("/.*/lib/demo/show")),
        ("$(file-content /proc/sys/kernel/ostype)", "Linux\n"),
        ("$(anon x)", re.compile(r"x_\w+")),
        ("$(log_dir)", re.compile("/.*/log/.*")),
        (r"\$(var a)", "$(var a)"),
        (r"a \\ b", "a \\ b"),
        ("costs 5$ or $5", "costs 5$ or $5"),
        ("$", "$"),
        ("äöü $(var a)", "äöü A"),
    ],
)
def test_a_text_with_substitutions(text: str, expected: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOME_V", "set")
    context = LaunchContext()
    context.launch_configurations.update(a="A", b="B", name="a", five="5")
    result = perform_substitutions(context, Parser().parse_substitution(text))
    assert expected.fullmatch(result) if isinstance(expected, re.Pattern) else result == expected


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("$(var", r"Expected a '\)' in the text '\$\(var' before 'its end'"),
        ("$(var a", r"Expected a '\)'"),
        ("$()", "Expected a name"),
        ("$( var a)", "Expected a name"),
        ("$(var 'a)", 'Expected a "\'"'),
        ("$(var a(b))", r"Expected a '\)'"),
        ("$(no-such x)", "Unknown substitution: no-such"),
        ("$(var)", "var substitution expects 1 or 2 arguments, got 0"),
        ("$(var a b c)", "var substitution expects 1 or 2 arguments, got 3"),
        ("$(eval 1 + 2)", "eval substitution expects 1 or 2 arguments, got 3"),
        ("$(dirname x)", "dirname substitution expects no arguments, got 1"),
        ("$(find-pkg-share)", "find-pkg-share substitution expects 1 argument, got 0"),
        ("$(and true)", "and substitution expects 2 arguments, got 1"),
    ],
)
def test_a_text_with_wrong_substitutions(text: str, error: str) -> None:
    with pytest.raises((ValueError, RuntimeError, TypeError), match=error):
        parse_substitution(text)


PATHS = """
import launch
import launch_ros
from launch.actions.declare_launch_argument import DeclareLaunchArgument
from launch.actions.execute_process import ExecuteProcess
from launch.conditions.if_condition import IfCondition
from launch.descriptions.executable import Executable
from launch.event_handlers.event_named import event_named
from launch.event_handlers.on_process_exit import OnProcessExit
from launch.launch_description_sources import InvalidFrontendLaunchFileError
from launch.launch_description_sources.python_launch_description_source import PythonLaunchDescriptionSource
from launch.frontend.expose import expose_action
from launch.frontend.type_utils import check_is_list_entity
from launch.substitutions.boolean_substitution import NotSubstitution
from launch.substitutions.launch_configuration import LaunchConfiguration
from launch.utilities.class_tools_impl import is_a
from launch.utilities.typing_file_path import FilePath
from launch_ros.actions import ComposableNodeContainer, LifecycleTransition
from launch_ros.actions.node import Node
from launch_ros.actions.push_ros_namespace import PushROSNamespace
from launch_ros.events.matchers.matches_node_name import matches_node_name
from launch_ros.parameters_type import SomeParameters
from launch_ros.remap_rule_type import RemapRule
from launch_ros.ros_adapters import get_ros_node
from launch_ros.substitutions.find_package import FindPackageShare
from launch_ros.utilities.normalize_parameters import normalize_parameter_dict
from launch_xml.parser import Parser

class Own(LifecycleTransition): pass

def generate_launch_description():
    assert launch_ros.actions.Node is Node
    assert launch.event_handlers.event_named is event_named
    assert launch_ros.actions.LifecycleTransition is LifecycleTransition
    hello = launch.descriptions.Executable(cmd=["echo", "hello"])
    end = launch.actions.LogInfo(msg="ended")
    action = launch.actions.ExecuteLocal(process_description=hello, output="screen", on_exit=end)
    seen = OnProcessExit(target_action=action, on_exit=[launch.actions.LogInfo(msg="seen")])
    return launch.LaunchDescription([launch.actions.RegisterEventHandler(seen), action])
"""


def test_paths_of_the_real_launch_lead_to_what_is_here(run: Run) -> None:
    """Also names of what only the real one has, as long as nobody uses them."""
    code, lines = run("paths.launch.py", PATHS)
    assert code == 0, lines
    assert {"[echo] hello", "[INFO] [launch.user]: ended", "[INFO] [launch.user]: seen"} <= set(lines)


@pytest.mark.parametrize("path", Path(__file__).with_name("launch_paths.txt").read_text().split())
def test_every_path_of_the_real_launch_can_be_imported(path: str) -> None:
    """The list has all modules of `launch` 3.4.11 and `launch_ros` 0.26.12 but one, which is of their tests."""
    assert importlib.import_module(path)


@pytest.mark.parametrize("name", ["launch.actions.no_such", "launch.no_such", "launch_ros.no_such.node"])
def test_other_paths_lead_nowhere(name: str) -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module(name)


# The same in three languages

RIGHT_XML = """
<launch>
  <arg name="a" default="x" description="the a"><choice value="x"/><choice value="y"/></arg>
  <let name="b" value="$(var a)$(var a)"/>
  <log message="$(var b)"/>
  <log message="if" if="$(equals $(var a) y)"/>
  <log message="unless" unless="$(equals $(var a) y)"/>
  <set_env name="SOME_V" value="1"/>
  <append_env name="SOME_V" value="2" separator="-" prepend="true"/>
  <log message="$(env SOME_V)"/>
  <unset_env name="SOME_V"/>
  <log message="$(env SOME_V none)"/>
  <group scoped="true">
    <let name="b" value="inner"/>
    <log message="$(var b)"/>
  </group>
  <group forwarding="false"><keep name="c" value="$(var b)"/><log message="$(var b none) $(var c)"/></group>
  <timer period="0.05"><log message="late"/></timer>
  <log message="$(dirname) $(filename)"/>
</launch>
"""
RIGHT_YAML = """
launch:
- arg:
    name: a
    default: x
    description: the a
    choice:
    - value: x
    - value: y
- let: {name: b, value: $(var a)$(var a)}
- log: {message: $(var b)}
- log: {message: if, if: $(equals $(var a) y)}
- log: {message: unless, unless: $(equals $(var a) y)}
- set_env: {name: SOME_V, value: '1'}
- append_env: {name: SOME_V, value: '2', separator: '-', prepend: true}
- log: {message: $(env SOME_V)}
- unset_env: {name: SOME_V}
- log: {message: $(env SOME_V none)}
- group:
  - let: {name: b, value: inner}
  - log: {message: $(var b)}
- group:
    forwarding: false
    keep:
    - {name: c, value: $(var b)}
    children:
    - log: {message: $(var b none) $(var c)}
- timer:
    period: 0.05
    children:
    - log: {message: late}
- log: {message: $(dirname) $(filename)}
"""
RIGHT_PYTHON = python("""
    DeclareLaunchArgument("a", default_value="x", description="the a", choices=["x", "y"]),
    SetLaunchConfiguration("b", [LaunchConfiguration("a"), LaunchConfiguration("a")]),
    LogInfo(msg=LaunchConfiguration("b")),
    LogInfo(msg="if", condition=IfCondition(EqualsSubstitution(LaunchConfiguration("a"), "y"))),
    LogInfo(msg="unless", condition=UnlessCondition(EqualsSubstitution(LaunchConfiguration("a"), "y"))),
    SetEnvironmentVariable("SOME_V", "1"),
    AppendEnvironmentVariable("SOME_V", "2", separator="-", prepend=True),
    LogInfo(msg=EnvironmentVariable("SOME_V")),
    UnsetEnvironmentVariable("SOME_V"),
    LogInfo(msg=EnvironmentVariable("SOME_V", default_value="none")),
    GroupAction([SetLaunchConfiguration("b", "inner"), LogInfo(msg=LaunchConfiguration("b"))]),
    GroupAction(
        [LogInfo(msg=[LaunchConfiguration("b", default="none"), " ", LaunchConfiguration("c")])],
        forwarding=False,
        launch_configurations={"c": LaunchConfiguration("b")},
    ),
    TimerAction(period=0.05, actions=[LogInfo(msg="late")]),
    LogInfo(msg=[ThisLaunchFileDir(), " ", ThisLaunchFile()]),
""")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.launch.xml", RIGHT_XML),
        ("a.xml", RIGHT_XML),
        ("a.launch", RIGHT_XML),
        ("no_extension", RIGHT_XML),
        ("a.launch.yaml", RIGHT_YAML),
        ("a.launch.yml", RIGHT_YAML),
        ("a.launch", RIGHT_YAML),
        ("a.txt", RIGHT_YAML),
        ("a.launch.py", RIGHT_PYTHON),
        ("a_launch.py", RIGHT_PYTHON),
        ("wrong.xml", RIGHT_PYTHON),
    ],
)
@pytest.mark.parametrize(("value", "branch"), [("x", "unless"), ("y", "if")])
def test_three_languages_do_the_same(  # noqa: PLR0917
    run: Run, tmp_path: Path, name: str, text: str, value: str, branch: str
) -> None:
    code, lines = run(name, text, a=value)
    place = f"{tmp_path} {tmp_path / name}"
    twice = value * 2
    assert (code, lines) == (
        0,
        said(twice, branch, "2-1", "none", "inner", f"none {twice}", place, "late"),
    )


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.launch.xml", RIGHT_XML), ("a.launch.yaml", RIGHT_YAML), ("a.launch.py", RIGHT_PYTHON)],
)
def test_the_arguments_of_a_file_can_be_told(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    (argument,) = get_launch_description_from_any_launch_file(str(tmp_path / name)).get_launch_arguments()
    assert argument.name == "a"
    assert argument.description == "the a. Valid choices are: ['x', 'y']"
    assert [part.describe() for part in argument.default_value or []] == ["'x'"]


NODE_XML = """
<launch>
  <arg name="q" default="5"/>
  <group>
    <push-ros-namespace namespace="g"/>
    <set_parameter name="gp" value="3"/>
    <set_remap from="m" to="n"/>
    <node pkg="demo" exec="show" name="talker" namespace="ns" output="screen" exec_name="first"
          args="a $(var q)b 'c d'" ros_args="--log-level info">
      <param name="i" value="1"/>
      <param name="f" value="$(var q)" type="float"/>
      <param name="s" value="1" type="str"/>
      <param name="l" value="1,2" value-sep=","/>
      <param name="y" value="[a, b]"/>
      <param name="nest"><param name="x" value="true"/><param name="deep"><param name="z" value="w"/></param></param>
      <param from="$(find-pkg-share demo)/config/demo.yaml"/>
      <remap from="a" to="$(var q)"/>
      <env name="SOME_V" value="1"/>
    </node>
  </group>
  <node pkg="demo" exec="show" output="screen" exec_name="second"/>
</launch>
"""
NODE_YAML = """
launch:
- arg: {name: q, default: '5'}
- group:
  - push_ros_namespace: {namespace: g}
  - set_parameter: {name: gp, value: '3'}
  - set_remap: {from: m, to: n}
  - node:
      pkg: demo
      exec: show
      name: talker
      namespace: ns
      output: screen
      exec_name: first
      args: a $(var q)b 'c d'
      ros_args: --log-level info
      param:
      - {name: i, value: 1}
      - {name: f, value: $(var q), type: float}
      - {name: s, value: '1', type: str}
      - {name: l, value: [1, 2]}
      - {name: y, value: [a, b]}
      - name: nest
        param:
        - {name: x, value: true}
        - name: deep
          param: [{name: z, value: w}]
      - from: $(find-pkg-share demo)/config/demo.yaml
      remap:
      - {from: a, to: $(var q)}
      env:
      - {name: SOME_V, value: '1'}
- node: {pkg: demo, exec: show, output: screen, exec_name: second}
"""


@pytest.mark.parametrize(("name", "text"), [("n.launch.xml", NODE_XML), ("n.launch.yaml", NODE_YAML)])
def test_a_node_gets_what_its_tag_says(run: Run, prefix: Path, name: str, text: str) -> None:
    _, lines = run(name, text)

    def file(*parameters: str) -> list[str]:
        content = ["/g/ns/talker:", "  ros__parameters:", *(f"    {line}" for line in parameters)]
        return ["--params-file", "FILE", *content]

    assert shown(lines, "first") == [
        *("a", "5b", "c d", "--ros-args", "--log-level", "info", "--ros-args"),
        *("-r", "__node:=talker", "-r", "__ns:=/g/ns", "-p", "gp:=3"),
        *file("i: 1"),
        *file("f: 5.0"),
        *file("s: '1'"),
        *file("l:", "- 1", "- 2"),
        *file("y:", "- a", "- b"),
        *file("nest.deep.z: w", "nest.x: true"),
        *("--params-file", str(prefix / "share/demo/config/demo.yaml")),
        *("/**:", "  ros__parameters:", "    k: 1"),
        *("-r", "m:=n", "-r", "a:=5"),
    ]
    assert shown(lines, "second") == ["--ros-args"]


PROCESS_XML = """
<launch>
  <executable cmd="echo $(var w hello) 'two words'" output="screen" name="one"/>
  <executable cmd="pwd; echo $SOME_V" shell="true" cwd="/" output="screen" name="two">
    <env name="SOME_V" value="set"/>
  </executable>
  <executable cmd="test -t 1" emulate_tty="true" name="three"/>
  <executable cmd="echo again" respawn="true" respawn_max_retries="1" respawn_delay="0.01" output="screen" name="four"/>
  <executable cmd="echo x" launch-prefix="echo before" output="screen" name="five"/>
  <executable cmd="sleep 60" sigterm_timeout="1" sigkill_timeout="1.5" name="six"/>
  <executable cmd="ALL_DONE" shell="true" on_exit="shutdown" name="seven"/>
</launch>
"""
PROCESS_YAML = """
launch:
- executable: {cmd: "echo $(var w hello) 'two words'", output: screen, name: one}
- executable:
    cmd: pwd; echo $SOME_V
    shell: true
    cwd: /
    output: screen
    name: two
    env:
    - {name: SOME_V, value: set}
- executable: {cmd: test -t 1, emulate_tty: true, name: three}
- executable:
    {cmd: echo again, respawn: 'true', respawn_max_retries: 1, respawn_delay: 0.01, output: screen, name: four}
- executable: {cmd: echo x, launch-prefix: echo before, output: screen, name: five}
- executable: {cmd: sleep 60, sigterm_timeout: 1.0, sigkill_timeout: 1.5, name: six}
- executable: {cmd: "ALL_DONE", shell: true, on_exit: shutdown, name: seven}
"""
# Ends, and not well, once the log tells of the end of all others but the one that sleeps; one of them ran twice.
ALL_DONE = (
    "until grep -c cleanly $(env ROS_LOG_DIR)/latest/launch.log | grep -qx 6; do sleep 0.02; done; exit 1"
)


@pytest.mark.parametrize(("name", "text"), [("p.launch.xml", PROCESS_XML), ("p.launch.yaml", PROCESS_YAML)])
def test_a_process_runs_as_its_tag_says(run: Run, name: str, text: str) -> None:
    code, lines = run(name, text.replace("ALL_DONE", ALL_DONE))
    assert code == 0
    assert shown(lines, "one") == ["hello two words"]
    assert shown(lines, "two") == ["/", "set"]
    assert "[INFO] [three]: process has finished cleanly [pid N]" in lines
    assert shown(lines, "four") == ["again", "again"]
    assert shown(lines, "five") == ["before echo x"]
    assert "[INFO] [six]: sending signal 'SIGINT' to process[six]" in lines
    assert "[INFO] [launch]: process[seven] was required: shutting down launched system" in lines


def test_include_in_all_directions(run: Run, tmp_path: Path) -> None:
    (tmp_path / "end.launch.py").write_text(
        python("DeclareLaunchArgument('a'), LogInfo(msg=['end ', LaunchConfiguration('a')])")
    )
    (tmp_path / "middle.launch.yaml").write_text(
        "launch:\n- arg: {name: a}\n- include:\n    file: $(dirname)/end.launch.py\n"
        "    let:\n    - {name: a, value: $(var a)2}\n"
    )
    (tmp_path / "start.launch.xml").write_text(
        '<launch><include file="$(dirname)/middle.launch.yaml"><arg name="a" value="1"/></include></launch>'
    )
    text = python("IncludeLaunchDescription(ThisLaunchFileDir() / 'start.launch.xml')")
    assert run("all.launch.py", text) == (0, said("end 12"))


@pytest.mark.parametrize(
    ("source", "name", "text"),
    [
        (XMLLaunchDescriptionSource, "x", "<launch><log message='hi'/></launch>"),
        (YAMLLaunchDescriptionSource, "y", "launch: [log: {message: hi}]"),
        (FrontendLaunchDescriptionSource, "f", "launch: [log: {message: hi}]"),
        (PythonLaunchDescriptionSource, "p", python("LogInfo(msg='hi')")),
        (AnyLaunchDescriptionSource, "a", python("LogInfo(msg='hi')")),
    ],
)
def test_each_source_reads_its_language(
    launched: Launched, tmp_path: Path, source: Any, name: str, text: str
) -> None:
    (tmp_path / name).write_text(text)
    assert launched(IncludeLaunchDescription(source(str(tmp_path / name)))) == (0, said("hi"))


@pytest.mark.parametrize(
    ("source", "text"),
    [
        (XMLLaunchDescriptionSource, "launch: []"),
        (YAMLLaunchDescriptionSource, "<launch/>"),
        (PythonLaunchDescriptionSource, "<launch/>"),
        (FrontendLaunchDescriptionSource, python("")),
    ],
)
def test_no_source_reads_another_language(launched: Launched, tmp_path: Path, source: Any, text: str) -> None:
    (tmp_path / "file").write_text(text)
    code, lines = launched(IncludeLaunchDescription(source(str(tmp_path / "file"))))
    assert code == 1
    assert lines[0].startswith(failed(""))


def test_a_deprecated_file_says_so(run: Run, tmp_path: Path) -> None:
    _, lines = run("old.launch.xml", "<launch deprecated='use new.launch.xml'/>")
    assert lines == [
        f"[WARNING] [root]: launch file [{tmp_path / 'old.launch.xml'}] is deprecated: use new.launch.xml"
    ]
    description = LaunchDescription(deprecated_reason="old")
    assert description.deprecated
    description.add_action(LaunchDescription())
    assert len(description.entities) == 1


def test_reading_a_launch_file_leaves_nothing_beside_it(run: Run, tmp_path: Path) -> None:
    run("a.launch.py", python("LogInfo(msg='hi')"))
    assert not list(tmp_path.rglob("__pycache__"))


# Wrong files

EITHER = "Caught multiple exceptions when trying to load file of format"
UNKNOWN = "The launch file may have a syntax error, or its format is unknown"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def generate_launch_description(:\n", " - SyntaxError: invalid syntax (a.launch.py, line 1)"),
        ("def generate_launch_description():\nreturn 1\n", " - IndentationError: expected an indented block"),
        ("import no_such_module\n", " - ModuleNotFoundError: No module named 'no_such_module'"),
        ("from launch.actions import NoSuchAction\n", " - ImportError: cannot import name 'NoSuchAction'"),
        (
            "from launch_ros.actions import LifecycleTransition\nLifecycleTransition()\n",
            " - NotImplementedError: launch_ros.actions.LifecycleTransition is not in this small launch_ros: "
            "it needs the real package launch_ros, which an installed ROS 2 brings",
        ),
        (
            "import launch_ros\nlaunch_ros.events.lifecycle.ChangeState()\n",
            " - NotImplementedError: launch_ros.events.lifecycle.ChangeState is not in this small launch_ros",
        ),
        ("x = 1\n", "does not contain the required function 'generate_launch_description()'"),
        ("", "does not contain the required function 'generate_launch_description()'"),
        (
            "def generate_launch_description():\n    pass\n",
            "must return a LaunchDescription, but it returns None",
        ),
        (
            "def generate_launch_description():\n    return []\n",
            "must return a LaunchDescription, but it returns []",
        ),
        (
            "def generate_launch_description(x):\n    pass\n",
            " - TypeError: generate_launch_description() missing 1",
        ),
        (
            "def generate_launch_description():\n    return LaunchDescription([])\n",
            " - NameError: name 'LaunchDescription'",
        ),
        (
            python("Node()"),
            " - TypeError: Node.__init__() missing 1 required keyword-only argument: 'executable'",
        ),
        (
            python("LogInfo('x')"),
            " - TypeError: LogInfo.__init__() takes 1 positional argument but 2 were given",
        ),
        (python("LogInfo(msg=5)"), " - TypeError: 'int' object is not iterable"),
        (python("1 / 0"), " - ZeroDivisionError: division by zero"),
        (python("Shutdwn()"), " - NameError: name 'Shutdwn' is not defined"),
        (python("DeclareLaunchArgument('a', default_value=5)"), " - TypeError: 'int' object is not iterable"),
        (python("ExecuteProcess(cmd=['a', 5])"), " - TypeError: 'int' object is not iterable"),
        (
            python("TimerAction(period='x', actions=[])"),
            " - ValueError: could not convert string to float: 'x'",
        ),
        ("\x00", "source code string cannot contain null bytes"),
    ],
)
def test_a_wrong_python_file(run: Run, text: str, expected: str) -> None:
    code, lines = run("a.launch.py", text)
    assert code == 1
    assert lines[0] == failed(f"{EITHER} [py]:")
    assert expected in lines[1]
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("'text'", "expected a LaunchDescriptionEntity, got 'text'"),
        ("LogInfo", "expected a LaunchDescriptionEntity, got '<class 'launch.actions.flow.LogInfo'>'"),
        ("LogInfo(msg=LaunchConfiguration('nowhere'))", "launch configuration 'nowhere' does not exist"),
        (
            "DeclareLaunchArgument('a')",
            "Included launch description missing required argument 'a' (description: 'no description given'), given: []",
        ),
        (
            "GroupAction([DeclareLaunchArgument('a')])",
            "Included launch description missing required argument 'a'",
        ),
        (
            "GroupAction([DeclareLaunchArgument('a')], condition=IfCondition('true'))",
            'Required launch argument "a" was not provided.',
        ),
        ("IncludeLaunchDescription('/no/file.launch.py')", f"{EITHER} [py]:"),
        ("IncludeLaunchDescription('/no/file.launch.xml')", f"{EITHER} [xml]:"),
        ("IncludeLaunchDescription('/no/file')", UNKNOWN),
        (
            "IncludeLaunchDescription([FindPackageShare('none_such'), '/x'])",
            "package 'none_such' not found, searching: [",
        ),
        ("PopLaunchConfigurations()", "launch_configurations stack unexpectedly empty"),
        ("PopEnvironment()", "environment stack unexpectedly empty"),
        (
            "ExecuteProcess(cmd=['true'], respawn='maybe')",
            "value='maybe' is not an instance of <class 'bool'>",
        ),
        (
            "ExecuteProcess(cmd=['true'], respawn=LaunchConfiguration('x', default='maybe'))",
            "Cannot convert value 'maybe' to",
        ),
    ],
)
def test_a_python_file_that_goes_wrong_while_launching(run: Run, body: str, expected: str) -> None:
    code, lines = run("a.launch.py", python(body))
    assert code == 1
    assert expected in "\n".join(lines)
    assert any(line.startswith(failed("")) for line in lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("<nod pkg='demo'/>", "RuntimeError: Unrecognized entity of the type: nod"),
        (
            "<node pkg='demo' exec='show' nam='x'/>",
            "ValueError: Unexpected attribute(s) found in `node`: {'nam'}",
        ),
        (
            "<node pkg='demo' exec='show'><parm/></node>",
            "ValueError: Unexpected nested tag(s) found in `node`: {'parm'}",
        ),
        (
            "<log message='x'><log message='y'/></log>",
            "ValueError: Unexpected nested tag(s) found in `log`: {'log'}",
        ),
        (
            "<node pkg='demo'/>",
            "AttributeError: Attribute 'exec' of type '<class 'str'>' not found in Entity 'node'",
        ),
        ("<log/>", "AttributeError: Attribute 'message' of type '<class 'str'>' not found in Entity 'log'"),
        ("<log message='$(nowhere)'/>", "RuntimeError: Unknown substitution: nowhere"),
        ("<log message='$(var'/>", "ValueError: Expected a ')' in the text '$(var'"),
        (
            "<log message='x' if='true' unless='true'/>",
            "RuntimeError: if and unless conditions can't be used simultaneously",
        ),
        (
            "<executable cmd='true' shell='maybe'/>",
            "TypeError: Attribute 'shell' of Entity 'executable' expected to be of type",
        ),
        (
            "<executable cmd='true' respawn_delay='-1'/>",
            "ValueError: Attribute respawn_delay of Entity node expected to be a non-negative value",
        ),
        (
            "<executable cmd='true' on_exit='respawn'/>",
            "ValueError: Attribute on_exit of Entity node expected to be shutdown but got `respawn`",
        ),
        ("<executable cmd='echo &quot;x'/>", "ValueError: No closing quotation"),
        ("<timer period='soon'/>", "could not convert string to float"),
        (
            "<node pkg='demo' exec='show'><param name='a'/></node>",
            "RuntimeError: either a value attribute or nested params are needed",
        ),
        (
            "<node pkg='demo' exec='show'><param value='a'/></node>",
            "ValueError: param Entity should have name or from attribute",
        ),
        (
            "<node pkg='demo' exec='show'><param name='a' from='b'/></node>",
            "RuntimeError: name and from attributes are mutually exclusive",
        ),
        (
            "<node pkg='demo' exec='show'><param name='a' value='x' type='int'/></node>",
            "TypeError: value='x' is not an instance of <class 'int'>",
        ),
        (
            "<node pkg='demo' exec='show'><param name='a' value='x' type='text'/></node>",
            "ValueError: Got invalid type identifier 'text'",
        ),
        (
            "<node pkg='demo' exec='show'><param name='a' value='x'><param name='b' value='1'/></param></node>",
            "nested parameters and value attributes are mutually exclusive",
        ),
        (
            "<node pkg='demo' exec='show'><param name='a' value='x' allow_substs='true'/></node>",
            "RuntimeError: 'allow_substs' can only be used together with 'from' attribute",
        ),
    ],
)
def test_a_wrong_tag(run: Run, body: str, expected: str) -> None:
    code, lines = run("a.launch.xml", f"<launch>{body}</launch>")
    assert code == 1
    assert expected in "\n".join(lines)
    assert any(line.startswith(failed("")) for line in lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<launch><log message='x'></launch>", "ParseError: mismatched tag: line 1, column "),
        ("<launch>", "ParseError: no element found"),
        ("", "ParseError: no element found"),
        ("no xml", "ParseError: syntax error: line 1, column 0"),
        ("<lunch/>", "RuntimeError: Expected 'launch' as root tag"),
    ],
)
def test_a_broken_xml_file(run: Run, text: str, expected: str) -> None:
    code, lines = run("a.launch.xml", text)
    assert code == 1
    assert lines[0] == failed(f"{EITHER} [xml]:")
    assert expected in "\n".join(lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("launch:\n- nod: {pkg: demo}\n", "RuntimeError: Unrecognized entity of the type: nod"),
        (
            "launch:\n- log: {message: x, mesage: y}\n",
            "ValueError: Unexpected key(s) found in `log`: {'mesage'}",
        ),
        ("launch:\n- log: {}\n", "AttributeError: Can not find attribute 'message' in Entity 'log'"),
        ("launch:\n- log:\n", "AttributeError: Can not find attribute 'message' in Entity 'log'"),
        (
            "launch:\n- log: {message: 5}\n",
            "TypeError: Attribute 'message' of Entity 'log' expected to be of type '<class 'str'>', got '<class 'int'>'",
        ),
        (
            "launch:\n- arg: {name: a, default: true}\n",
            "expected to be of type '<class 'str'>', got '<class 'bool'>'",
        ),
        (
            "launch:\n- log: {message: x}\n  let: {name: a, value: b}\n",
            "Subentities must be a dictionary with only one key",
        ),
        ("launch:\n- log\n", "Subentities must be a dictionary with only one key"),
        ("launch:\n- group: {scoped: true}\n", "Expected entity `group` to have children entities"),
        (
            "launch:\n- node: {pkg: demo, exec: show, remap: {from: a, to: b}}\n",
            "expected to be a list of dictionaries",
        ),
        (
            "launch:\n- node: {pkg: demo, exec: show, param: [{name: a, value: {b: 1}}]}\n",
            "Attribute 'value' of Entity 'param' expected to be of type",
        ),
        (
            "launch:\n- node: {pkg: demo, exec: show, param: [{name: a, value: [1, x, 2.5]}]}\n",
            "Attribute 'value' of Entity 'param' expected to be of type",
        ),
        ("launch:\n", "Expected a dict or list, got <class 'NoneType'>"),
        ("launch: 5\n", "Expected a dict or list, got <class 'int'>"),
        ("launch: []\nother: []\n", "RuntimeError: Expected only one root"),
        ("other: []\n", "RuntimeError: Expected 'launch' as root tag"),
        ("", "RuntimeError: Expected only one root"),
        ("- a\n", "RuntimeError: Expected only one root"),
        ("launch:\n- log: {message: x\n", "ParserError: while parsing a flow mapping"),
        ("launch:\n\t- log: {message: x}\n", "ScannerError: while scanning for the next token"),
        ("launch:\n- log: {message: $(var a: b)}\n", "ParserError: while parsing a flow mapping"),
    ],
)
def test_a_wrong_yaml_file(run: Run, text: str, expected: str) -> None:
    code, lines = run("a.launch.yaml", text)
    assert code == 1
    assert lines[0] == failed(f"{EITHER} [yaml]:")
    assert expected in "\n".join(lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize("name", ["a.txt", "a", "a.lanch.py.bak"])
def test_a_file_of_no_language(run: Run, name: str) -> None:
    assert run(name, "hello\n") == (1, [failed(UNKNOWN)])


def test_the_error_keeps_its_reasons(tmp_path: Path) -> None:
    (tmp_path / "a.launch.py").write_text("import no_such_module")
    with pytest.raises(InvalidLaunchFileError) as caught:
        get_launch_description_from_any_launch_file(str(tmp_path / "a.launch.py"))
    assert isinstance(caught.value.__cause__, ModuleNotFoundError)


def test_a_missing_argument_of_an_included_file_is_told_before_anything_is_started(
    run: Run, tmp_path: Path
) -> None:
    (tmp_path / "inner.launch.xml").write_text("<launch><arg name='a' description='the a'/></launch>")
    body = "LogInfo(msg='never'), IncludeLaunchDescription([ThisLaunchFileDir(), '/inner.launch.xml'])"
    outer = python(body)
    (tmp_path / "outer.launch.py").write_text(outer)
    code, lines = run("all.launch.xml", f"<launch><include file='{tmp_path}/outer.launch.py'/></launch>")
    assert code == 1
    assert (
        failed("Included launch description missing required argument 'a' (description: 'the a'), given: []")
        in lines
    )
    assert os.environ["ROS_LOG_DIR"].startswith(str(tmp_path))
