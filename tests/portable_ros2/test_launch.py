"""The libraries launch and launch_ros: what launch descriptions do, mostly with real processes."""

from __future__ import annotations

import asyncio
import importlib
import os
import re
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

import launch.logging
from launch import LaunchContext, LaunchDescription, LaunchService
from launch.actions import (
    AppendEnvironmentVariable,
    DeclareLaunchArgument,
    EmitEvent,
    ExecuteProcess,
    GroupAction,
    IncludeLaunchDescription,
    LogInfo,
    OpaqueCoroutine,
    OpaqueFunction,
    RegisterEventHandler,
    ResetLaunchConfigurations,
    SetEnvironmentVariable,
    SetLaunchConfiguration,
    Shutdown,
    TimerAction,
    UnregisterEventHandler,
    UnsetEnvironmentVariable,
    UnsetLaunchConfiguration,
)
from launch.conditions import (
    IfCondition,
    LaunchConfigurationEquals,
    LaunchConfigurationNotEquals,
    UnlessCondition,
)
from launch.event_handlers import (
    OnExecutionComplete,
    OnProcessExit,
    OnProcessIO,
    OnProcessStart,
    OnShutdown,
)
from launch.events import Shutdown as ShutdownEvent
from launch.events import matches_action
from launch.events.process import ShutdownProcess, SignalProcess, matches_name
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import (
    AllSubstitution,
    AndSubstitution,
    AnonName,
    AnySubstitution,
    Command,
    EnvironmentVariable,
    EqualsSubstitution,
    FileContent,
    FindExecutable,
    IfElseSubstitution,
    LaunchConfiguration,
    LaunchLogDir,
    LocalSubstitution,
    NotEqualsSubstitution,
    NotSubstitution,
    OrSubstitution,
    PathJoinSubstitution,
    PathSubstitution,
    PythonExpression,
    SubstitutionFailure,
    TextSubstitution,
    ThisLaunchFile,
    ThisLaunchFileDir,
)
from launch_ros.actions import (
    Node,
    PushRosNamespace,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetROSLogDir,
    SetUseSimTime,
)
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from launch_ros.substitutions import ExecutableInPackage, FindPackagePrefix, FindPackageShare
from launch_ros.substitutions import Parameter as ParameterOfAll

pytestmark = pytest.mark.usefixtures("clean_launch")

Launched = Callable[..., tuple[int, list[str]]]
# Ends a sleeping shell in each test that fails, and in no test that does not.
FOREVER = "sleep 60 & wait"
STUBBORN = "import signal, time; [signal.signal(s, signal.SIG_IGN) for s in {ignored}]; print('up', flush=True); time.sleep(60)"


def said(text: str) -> str:
    return f"[INFO] [launch.user]: {text}"


def failed(text: str) -> str:
    return f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {text}"


def python(code: str, **arguments: Any) -> ExecuteProcess:
    return ExecuteProcess(cmd=[sys.executable, "-u", "-c", code], name="py", output="screen", **arguments)


def shell(script: str, **arguments: Any) -> ExecuteProcess:
    return ExecuteProcess(cmd=["sh", "-c", script], **{"output": "screen", "name": "sh", **arguments})


def output_of(lines: list[str], name: str = "sh") -> list[str]:
    return [line.partition("] ")[2] for line in lines if line.startswith(f"[{name}] ")]


# Substitutions


@pytest.mark.parametrize(
    ("substitution", "expected"),
    [
        (TextSubstitution(text="a"), "a"),
        (LaunchConfiguration("there"), "value"),
        (LaunchConfiguration(["the", TextSubstitution(text="re")]), "value"),
        (LaunchConfiguration("nowhere", default="other"), "other"),
        (LaunchConfiguration("nowhere", default=["o", LaunchConfiguration("there")]), "ovalue"),
        (LaunchConfiguration("nowhere", default=5), "5"),
        (EnvironmentVariable("THERE"), "set"),
        (EnvironmentVariable("NOWHERE", default_value=["o", "ther"]), "other"),
        (PathJoinSubstitution(["/a", "b", LaunchConfiguration("there")]), "/a/b/value"),
        (PathJoinSubstitution(["/a", ["b", LaunchConfiguration("there")]]), "/a/bvalue"),
        (PathJoinSubstitution(["/a"]) / "b" / LaunchConfiguration("there"), "/a/b/value"),
        (PathJoinSubstitution(["/a/", Path("b/"), ""]), "/a/b"),
        (PathSubstitution("/a") / "b", "/a/b"),
        (PathSubstitution(["/a", Path("b")]) / ["c", LaunchConfiguration("there")], "/a/b/cvalue"),
        (LaunchConfiguration("nowhere", default=Path("/a")), "/a"),
        (PythonExpression("1 + 2"), "3"),
        (PythonExpression(["'", LaunchConfiguration("there"), "' == 'value'"]), "True"),
        (PythonExpression("round(pi, 2) + math.floor(1.5)"), "4.140000000000001"),
        (PythonExpression("[n for n in range(int(sqrt(9)))]"), "[0, 1, 2]"),
        (PythonExpression("os.path.sep", ["os"]), "/"),
        (Command("echo hello"), "hello\n"),
        (Command(["echo -n ", LaunchConfiguration("there")]), "value"),
        (Command("sh -c 'echo no >&2; echo yes'", on_stderr="ignore"), "yes\n"),
        (Command("sh -c 'echo no >&2'", on_stderr="capture"), "no\n"),
        (FindExecutable(name="true"), re.compile(r"/.*/true")),
        (FileContent("/proc/sys/kernel/ostype"), "Linux\n"),
        (EqualsSubstitution("1", "true"), "true"),
        (EqualsSubstitution(LaunchConfiguration("there"), "value"), "true"),
        (EqualsSubstitution(1.0, "1.00"), "true"),
        (EqualsSubstitution(True, "TRUE"), "true"),
        (EqualsSubstitution(None, ""), "true"),
        (EqualsSubstitution("a", "A"), "false"),
        (NotEqualsSubstitution("a", "b"), "true"),
        (NotSubstitution("false"), "true"),
        (NotSubstitution("1"), "false"),
        (AndSubstitution("true", "1"), "true"),
        (AndSubstitution("true", "0"), "false"),
        (OrSubstitution("false", "True"), "true"),
        (AllSubstitution("true", "true", "false"), "false"),
        (AnySubstitution("false", "false", "true"), "true"),
        (AllSubstitution("true", container=["1", "false"]), "false"),
        (AnySubstitution(container=["false", "true"]), "true"),
        (IfElseSubstitution("true", if_value="a", else_value="b"), "a"),
        (IfElseSubstitution(EqualsSubstitution("1", "2"), "a", LaunchConfiguration("there")), "value"),
        (LocalSubstitution("answer"), "42"),
        (AnonName("x"), re.compile(r"x_\w+_\d+_\d+")),
        (FindPackageShare("demo"), re.compile(r"/.*/install/share/demo")),
        (FindPackagePrefix("demo"), re.compile(r"/.*/install")),
        (FindPackageShare("demo") / "config", re.compile(r"/.*/install/share/demo/config")),
        (FindPackagePrefix("demo") / "lib", re.compile(r"/.*/install/lib")),
        (LaunchLogDir() / "own", re.compile(r"/.*/own")),
        (ExecutableInPackage(package="demo", executable="show"), re.compile(r"/.*/install/lib/demo/show")),
        (
            PathJoinSubstitution([FindPackageShare("demo"), "config", "demo.yaml"]),
            re.compile(r"/.*/share/demo/config/demo.yaml"),
        ),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_a_substitution_becomes_a_text(
    substitution: Any, expected: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("THERE", "set")
    context = LaunchContext()
    context.launch_configurations["there"] = "value"
    context.extend_locals({"answer": 42})
    result = context.perform_substitution(substitution)
    assert expected.fullmatch(result) if isinstance(expected, re.Pattern) else result == expected
    assert isinstance(substitution.describe(), str)


@pytest.mark.parametrize(
    ("substitution", "text"),
    [
        (LaunchConfiguration("nowhere"), "launch configuration 'nowhere' does not exist"),
        (EnvironmentVariable("NOWHERE"), "environment variable 'NOWHERE' does not exist"),
        (PythonExpression("nowhere + 1"), "name 'nowhere' is not defined"),
        (PythonExpression("1 +"), "invalid syntax"),
        (PythonExpression("1", ["no_such_module"]), "No module named 'no_such_module'"),
        (Command("no-such-program"), "No such file or directory: 'no-such-program'"),
        (Command("false"), "executed command failed. Command: false"),
        (Command("sh -c 'echo no >&2'"), "executed command showed stderr output"),
        (Command("true", on_stderr="maybe"), "expected 'on_stderr' to be one of"),
        (FindExecutable(name="no-such-program"), "executable 'no-such-program' not found on the PATH"),
        (FileContent("/no/such/file"), "File not found: /no/such/file"),
        (ThisLaunchFile(), "ThisLaunchFile used outside of a launch file"),
        (ThisLaunchFileDir(), "ThisLaunchFileDir used outside of a launch file"),
        (NotSubstitution("maybe"), "Cannot convert value 'maybe'"),
        (AndSubstitution("false", "maybe"), "Cannot convert value 'maybe'"),
        (FindPackageShare("no_such_package"), "package 'no_such_package' not found, searching: ["),
        (ExecutableInPackage("nothing", "demo"), "executable 'nothing' not found on the libexec directory"),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_a_substitution_that_has_no_text_says_why(substitution: Any, text: str) -> None:
    with pytest.raises(SubstitutionFailure, match=re.escape(text)):
        substitution.perform(LaunchContext())


def test_what_is_no_substitution_is_told() -> None:
    with pytest.raises(TypeError, match="when only 'str'"):
        LogInfo(msg=[5])  # type: ignore[list-item]
    with pytest.raises(TypeError, match="expected 'text' to be of type 'str'"):
        TextSubstitution(text=5)  # type: ignore[arg-type]


def test_the_log_folder_can_be_asked_for(launched: Launched, tmp_path: Path) -> None:
    _, lines = launched(LogInfo(msg=LaunchLogDir()))
    assert lines[0].startswith(said(str(tmp_path / "log")))


# Arguments, configurations, conditions, groups


def test_an_argument_has_its_default_and_a_configuration_its_value(launched: Launched) -> None:
    code, lines = launched(
        DeclareLaunchArgument("a", default_value="x"),
        SetLaunchConfiguration("b", [LaunchConfiguration("a"), "y"]),
        DeclareLaunchArgument("b", default_value="not used"),
        LogInfo(msg=[LaunchConfiguration("a"), " ", LaunchConfiguration("b")]),
        UnsetLaunchConfiguration("b"),
        LogInfo(msg=LaunchConfiguration("b", default="gone")),
    )
    assert (code, lines) == (0, [said("x xy"), said("gone")])


def test_a_required_argument_that_is_not_given_ends_all(launched: Launched) -> None:
    code, lines = launched(DeclareLaunchArgument("a", description="what it is"), LogInfo(msg="never"))
    assert code == 1
    assert lines == [
        '[ERROR] [launch.actions.declare_launch_argument]: Required launch argument "a" '
        '(description: "what it is") was not provided',
        failed('Required launch argument "a" was not provided.'),
    ]


@pytest.mark.parametrize(("value", "code"), [("x", 0), ("y", 0), ("z", 1), ("", 1), ("X", 1)])
def test_only_choices_can_be_chosen(launched: Launched, value: str, code: int) -> None:
    result = launched(
        SetLaunchConfiguration("a", value),
        DeclareLaunchArgument("a", choices=["x", "y"]),
        LogInfo(msg="reached"),
    )
    text = f"Argument \"a\" provided value \"{value}\" is not valid. Valid options are: ['x', 'y']"
    wrong = [f"[ERROR] [launch.actions.declare_launch_argument]: {text}", failed(text)]
    assert result == (code, wrong if code else [said("reached")])


def test_a_default_must_be_one_of_the_choices() -> None:
    with pytest.raises(RuntimeError, match='Provided default_value "z" is not in provided choices'):
        DeclareLaunchArgument("a", choices=["x"], default_value="z")
    with pytest.raises(RuntimeError, match="Provided choices arg is empty"):
        DeclareLaunchArgument("a", choices=[])


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({}, "no description given"),
        ({"description": "d"}, "d"),
        ({"choices": ["x"]}, "One of: ['x']"),
        ({"choices": ["x"], "description": "d"}, "d. Valid choices are: ['x']"),
        ({"choices": ["x"], "description": "d."}, "d. Valid choices are: ['x']"),
    ],
)
def test_the_description_names_the_choices(arguments: dict[str, Any], text: str) -> None:
    assert DeclareLaunchArgument("a", **arguments).description == text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("true", "if"),
        ("1", "if"),
        (" True ", "if"),
        ("false", "unless"),
        ("0", "unless"),
        ("FALSE", "unless"),
    ],
)
def test_true_is_true_and_false_is_false(launched: Launched, text: str, expected: str) -> None:
    assert launched(
        LogInfo(msg="if", condition=IfCondition(text)),
        LogInfo(msg="unless", condition=UnlessCondition([text])),
    ) == (0, [said(expected)])


@pytest.mark.parametrize("text", ["", "yes", "2", "none"])
def test_what_is_neither_true_nor_false_ends_all(launched: Launched, text: str) -> None:
    code, lines = launched(LogInfo(msg="never", condition=IfCondition(text)))
    assert code == 1
    assert lines == [
        failed(
            f"invalid condition expression, expected one of [true, 1, false, 0] but got '{text}', "
            f"expanded from ''{text}''"
        )
    ]


def test_the_old_conditions_still_work_and_say_that_they_are_old(launched: Launched) -> None:
    with pytest.warns(UserWarning, match="EqualsSubstitution"):
        conditions = [
            LaunchConfigurationEquals("a", "x"),
            LaunchConfigurationEquals("a", "y"),
            LaunchConfigurationNotEquals("a", "y"),
            LaunchConfigurationEquals("b", None),
        ]
    entities = [LogInfo(msg=str(number), condition=condition) for number, condition in enumerate(conditions)]
    _, lines = launched(SetLaunchConfiguration("a", "x"), *entities)
    assert lines == [said("0"), said("2"), said("3")]


def test_a_group_forgets_what_it_sets_unless_it_is_not_scoped(launched: Launched) -> None:
    show = [LaunchConfiguration("v", default="-"), EnvironmentVariable("SOME_V", default_value="-")]
    _, lines = launched(
        SetLaunchConfiguration("v", "1"),
        SetEnvironmentVariable("SOME_V", "1"),
        GroupAction(
            [SetLaunchConfiguration("v", "2"), SetEnvironmentVariable("SOME_V", "2"), LogInfo(msg=show)]
        ),
        LogInfo(msg=show),
        GroupAction([LogInfo(msg=show)], forwarding=False),
        GroupAction([LogInfo(msg=show)], launch_configurations={"v": "3"}),
        GroupAction(
            [LogInfo(msg=show)],
            forwarding=False,
            launch_configurations={"v": [LaunchConfiguration("v"), "4"]},
        ),
        LogInfo(msg=show),
        GroupAction([SetLaunchConfiguration("v", "5")], scoped=False),
        LogInfo(msg=show),
        ResetLaunchConfigurations({"w": LaunchConfiguration("v")}),
        LogInfo(msg=[*show, LaunchConfiguration("w")]),
    )
    assert lines == [said(text) for text in ("22", "11", "--", "31", "14-", "11", "51", "-15")]


def test_what_is_no_text_is_kept_as_it_is() -> None:
    context = LaunchContext()
    ResetLaunchConfigurations({"global_params": [("p", 1)], "files": ["a", "b"]}).visit(context)
    assert context.launch_configurations == {"global_params": [("p", 1)], "files": ["a", "b"]}


def test_environment_variables_are_set_extended_and_removed(launched: Launched) -> None:
    _, lines = launched(
        SetEnvironmentVariable("SOME_V", "1"),
        AppendEnvironmentVariable("SOME_V", "2"),
        AppendEnvironmentVariable("SOME_V", "0", prepend=True, separator="-"),
        shell("echo $SOME_V; echo $MORE", additional_env={"MORE": [LaunchConfiguration("m", default="9")]}),
        UnsetEnvironmentVariable("SOME_V"),
        AppendEnvironmentVariable("SOME_V", "new"),
        LogInfo(msg=EnvironmentVariable("SOME_V")),
    )
    assert output_of(lines) == ["0-1:2", "9"]
    assert said("new") in lines


def test_an_opaque_function_gets_the_context_and_may_return_entities(launched: Launched) -> None:
    def function(context: LaunchContext, greeting: str, *, whom: str) -> list[Any]:
        return [LogInfo(msg=[greeting, " ", whom, " ", LaunchConfiguration("v").perform(context)])]

    _, lines = launched(
        SetLaunchConfiguration("v", "5"),
        OpaqueFunction(function=function, args=["hello"], kwargs={"whom": "you"}),
        OpaqueFunction(function=lambda context: None),
    )
    assert lines == [said("hello you 5")]


@pytest.mark.parametrize(
    ("function", "text"),
    [
        (lambda context: 5, "expected a LaunchDescriptionEntity, got '5'"),
        (lambda context: ["x"], "expected a LaunchDescriptionEntity, got 'x'"),
        (lambda: None, "takes 0 positional arguments but 1 was given"),
        (lambda context: 1 / 0, "division by zero"),
        (lambda context: context.locals.nothing, "context.locals does not contain attribute 'nothing'"),
    ],
)
def test_a_wrong_opaque_function_ends_all_and_the_processes_too(
    launched: Launched, function: Any, text: str
) -> None:
    process = shell(FOREVER)
    code, lines = launched(
        process,
        RegisterEventHandler(
            OnProcessStart(target_action=process, on_start=[OpaqueFunction(function=function)])
        ),
    )
    assert code == 1
    assert [line for line in lines if line.startswith(failed("")) and text in line]
    assert process.return_code == -signal.SIGINT


def test_a_coroutine_runs_beside_the_rest_and_its_error_is_told(launched: Launched) -> None:
    async def count(context: LaunchContext, number: int) -> None:
        await asyncio.sleep(0)
        context.launch_configurations["n"] = str(number)

    async def fail() -> None:
        raise RuntimeError("broken")

    code, lines = launched(OpaqueCoroutine(coroutine=count, args=[5]))
    assert (code, lines) == (0, [])
    assert launched(OpaqueCoroutine(coroutine=fail, ignore_context=True)) == (1, [failed("broken")])
    with pytest.raises(TypeError, match="expected a coroutine function"):
        OpaqueCoroutine(coroutine=print)  # type: ignore[arg-type]


def test_a_coroutine_is_cancelled_at_the_shutdown(launched: Launched) -> None:
    async def wait_forever() -> None:
        await asyncio.Event().wait()

    code, _ = launched(
        OpaqueCoroutine(coroutine=wait_forever, ignore_context=True),
        TimerAction(period=0.05, actions=[Shutdown()]),
    )
    assert code == 0


# Processes


def test_a_process_that_ends_well_and_one_that_does_not(launched: Launched) -> None:
    code, lines = launched(shell("echo out; echo err >&2"), shell("exit 3", name="bad"))
    assert code == 0  # as Jazzy: what becomes of a process is no failure of the launch
    assert lines.count("[INFO] [sh]: process started with pid N]") == 1
    assert sorted(output_of(lines)) == ["err", "out"]
    assert lines.count("[INFO] [sh]: process has finished cleanly [pid N]") == 1
    assert lines.count("[ERROR] [bad]: process has died [pid N, exit code 3, cmd 'sh -c exit 3'].") == 1


def test_all_that_a_process_writes_is_shown_before_its_end(launched: Launched) -> None:
    process = python("for n in range(20000): print(n, 'x' * 50)")
    _, lines = launched(process)
    assert output_of(lines, "py") == [f"{n} {'x' * 50}" for n in range(20000)]
    assert lines[-1].startswith("[INFO] [py]: process has finished cleanly")


def test_output_without_a_line_end_and_in_pieces_and_in_no_encoding(launched: Launched) -> None:
    write = "import sys, time; w = sys.stdout.buffer.write; "
    pieces = "".join(
        f"w({piece!r}); sys.stdout.flush(); time.sleep(0.02); "
        for piece in ("ä".encode()[:1], "ä".encode()[1:])
    )
    _, lines = launched(python(f"{write}{pieces} w(b'\\n\\xff\\n\\nend')"))
    assert output_of(lines, "py") == ["ä", "�", "", "end"]


def test_processes_are_named_after_their_program_and_numbered(
    capsys: pytest.CaptureFixture[str],
) -> None:
    service = LaunchService()
    service.include_launch_description(
        LaunchDescription([ExecuteProcess(cmd=["/bin/echo"]), ExecuteProcess(cmd=["echo"], name="mine")])
    )
    service.run()
    names = re.findall(r"\[(\w+-\d+)\]: process started", capsys.readouterr().out)
    (first, first_number), (second, second_number) = (name.split("-") for name in names)
    assert (first, second) == ("echo", "mine")
    assert int(second_number) == int(first_number) + 1


@pytest.mark.parametrize(
    ("output", "screen", "file", "more"),
    [
        ("screen", {"out", "err"}, set(), set()),
        ("log", {"err"}, {"out", "err"}, set()),
        ("both", {"out", "err"}, {"out", "err"}, set()),
        ("own_log", set(), set(), {"sh.log", "sh-stdout.log", "sh-stderr.log"}),
        ("full", {"out", "err"}, {"out", "err"}, {"sh.log", "sh-stdout.log", "sh-stderr.log"}),
        ({"stdout": "screen", "stderr": ["log"]}, {"out"}, {"err"}, set()),
        ({"both": "log"}, set(), {"out", "err"}, set()),
        (LaunchConfiguration("o", default="screen"), {"out", "err"}, set(), set()),
    ],
)
def test_the_output_goes_where_it_is_told(  # noqa: PLR0917
    launched: Launched, tmp_path: Path, output: Any, screen: set[str], file: set[str], more: set[str]
) -> None:
    _, lines = launched(shell("echo out; echo err >&2", output=output))
    assert set(output_of(lines)) == screen
    (folder,) = (path for path in (tmp_path / "log").iterdir() if path.name != "latest")
    assert (tmp_path / "log/latest").resolve() == folder
    text = (folder / "launch.log").read_text()
    assert {
        word for word in ("out", "err") if re.search(rf"^\d+\.\d+ \[sh-\d+\] {word}$", text, re.MULTILINE)
    } == file
    assert re.search(
        r"^\d+\.\d{7} \[INFO\] \[sh-\d+\]: process started with pid \[\d+\]$", text, re.MULTILINE
    )
    assert {re.sub(r"-\d+", "", path.name) for path in folder.iterdir()} == more | {"launch.log"}


@pytest.mark.parametrize("output", ["scren", {"stdin": "screen"}, {"stdout": "scren"}, 5])
def test_a_wrong_output_is_told(launched: Launched, output: Any) -> None:
    try:
        code, lines = launched(shell("true", output=output))
    except TypeError:
        assert output == 5
    else:
        assert code == 1
        assert "is not a valid" in lines[0]


def test_one_variable_shows_the_output_of_all(launched: Launched, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OVERRIDE_LAUNCH_PROCESS_OUTPUT", "both")
    _, lines = launched(shell("echo out", output="log"))
    assert output_of(lines) == ["out"]


def test_a_program_that_cannot_be_started_is_told_in_one_line(launched: Launched, tmp_path: Path) -> None:
    (tmp_path / "text").write_text("no program")
    for program, reason in {
        "no-such-program": "[Errno 2] No such file or directory: 'no-such-program'",
        str(tmp_path / "text"): "[Errno 13] Permission denied: ",
    }.items():
        code, lines = launched(ExecuteProcess(cmd=[program], name="x"), ExecuteProcess(cmd=["true"], cwd="/"))
        assert code == 0
        (line,) = (line for line in lines if "ERROR" in line)
        assert line.startswith(f"[ERROR] [x]: exception occurred while executing process: {reason}")


def test_where_and_how_a_process_runs(launched: Launched, tmp_path: Path) -> None:
    _, lines = launched(
        shell("pwd; env | grep ^ONLY", cwd=str(tmp_path), env={"ONLY": "1", "PATH": os.environ["PATH"]}),
        ExecuteProcess(cmd=["echo a b |", "wc -w"], shell=True, output="screen", name="pipe"),
        ExecuteProcess(cmd=["echo", "x y"], prefix="echo 'be fore'", output="screen", name="prefix"),
        shell("test -t 1 && test -t 2 && echo terminal", emulate_tty=True, name="tty"),
        shell("test -t 1 || echo pipe", name="notty"),
        GroupAction(
            [SetLaunchConfiguration("emulate_tty", "true"), shell("test -t 1 && echo terminal", name="conf")]
        ),
    )
    assert output_of(lines) == [str(tmp_path), "ONLY=1"]
    assert output_of(lines, "pipe") == ["2"]
    assert output_of(lines, "prefix") == ["be fore echo x y"]
    assert output_of(lines, "tty") == ["terminal"]
    assert output_of(lines, "notty") == ["pipe"]
    assert output_of(lines, "conf") == ["terminal"]


def test_a_prefix_for_all_can_be_filtered(launched: Launched) -> None:
    _, lines = launched(
        SetLaunchConfiguration("launch-prefix", "echo before"),
        SetLaunchConfiguration("launch-prefix-filter", "ec"),
        ExecuteProcess(cmd=["echo", "x"], name="yes", output="screen"),
        ExecuteProcess(cmd=["printf", "x"], name="no", output="screen"),
    )
    assert output_of(lines, "yes") == ["before echo x"]
    assert output_of(lines, "no") == ["x"]


def test_the_output_can_be_kept(launched: Launched) -> None:
    process = shell("echo out; echo err >&2", cached_output=True)
    launched(process)
    assert (process.get_stdout(), process.get_stderr(), process.return_code) == ("out\n", "err\n", 0)
    with pytest.raises(RuntimeError, match="cached output must be true"):
        shell("true").get_stdout()


def test_an_own_format_of_the_output(launched: Launched) -> None:
    _, lines = launched(shell("echo out", output_format="<{line}> of {this.process_description.final_name}"))
    assert [line for line in lines if line.startswith("<out> of sh-")]


def test_a_process_is_started_again_as_often_as_it_is_told(launched: Launched) -> None:
    _, lines = launched(shell("echo once", respawn=True, respawn_max_retries=2, respawn_delay=0.01))
    assert output_of(lines) == ["once"] * 3


def test_a_process_that_is_always_started_again_ends_at_the_shutdown(launched: Launched) -> None:
    started: list[int] = []

    def on_start(event: Any, _: LaunchContext) -> Any:
        started.append(event.pid)
        return EmitEvent(event=ShutdownEvent()) if len(started) == 3 else None

    process = shell("true", respawn=LaunchConfiguration("r", default="true"))
    code, _ = launched(
        RegisterEventHandler(OnProcessStart(target_action=process, on_start=on_start)), process
    )
    assert code == 0
    assert len(set(started)) == 3


def test_a_respawn_delay_does_not_hold_up_the_shutdown(launched: Launched) -> None:
    process = shell(
        "true", respawn=True, respawn_delay=60.0, on_exit=[TimerAction(period=0.05, actions=[Shutdown()])]
    )
    assert launched(process)[0] == 0


def test_the_same_process_cannot_be_run_twice(launched: Launched) -> None:
    process = shell("true")
    code, lines = launched(process, process)
    assert code == 1
    assert any("executed more than once" in line for line in lines)


def test_what_a_process_left_behind_does_not_hold_up_the_end(launched: Launched) -> None:
    """A grandchild that keeps the output open."""
    _, lines = launched(shell("echo out; sleep 5 & echo $!"))
    out, pid = output_of(lines)
    os.kill(int(pid), signal.SIGKILL)
    assert out == "out"


# Events


def test_the_life_of_a_process_can_be_followed(launched: Launched) -> None:
    process = shell("echo out; echo err >&2; exit 4")
    other = shell("sleep 0.3", name="other")
    seen: list[Any] = []

    def keep(kind: str) -> Callable[..., None]:
        return lambda event, *_: seen.append((kind, event.process_name.rpartition("-")[0], event.pid > 0))

    _, lines = launched(
        RegisterEventHandler(OnProcessStart(target_action=process, on_start=keep("start"))),
        RegisterEventHandler(
            OnProcessIO(target_action=process, on_stdout=keep("out"), on_stderr=keep("err"))
        ),
        RegisterEventHandler(
            OnProcessExit(
                target_action=process,
                on_exit=[LogInfo(msg=["code ", LocalSubstitution("event.returncode")])],
            )
        ),
        RegisterEventHandler(
            OnProcessExit(target_action=lambda action: action is other, on_exit=keep("other"))
        ),
        RegisterEventHandler(OnProcessExit(on_exit=keep("any"))),
        process,
        other,
    )
    assert seen[0] == ("start", "sh", True)
    assert sorted(seen[1:3]) == [("err", "sh", True), ("out", "sh", True)]
    assert seen[3] == ("any", "sh", True)
    assert sorted(seen[4:]) == [("any", "other", True), ("other", "other", True)]
    assert said("code 4") in lines


def test_one_process_starts_after_another(launched: Launched) -> None:
    first, second = shell("echo first"), shell("echo second", name="second")
    _, lines = launched(
        first, RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[LogInfo(msg="then"), second]))
    )
    order = [lines.index(line) for line in ("[sh] first", said("then"), "[second] second")]
    assert order == sorted(order)


def test_a_handler_can_handle_once_and_be_unregistered(launched: Launched) -> None:
    seen: list[str] = []
    once = OnProcessStart(on_start=lambda *_: seen.append("once"), handle_once=True)
    never = OnProcessStart(on_start=lambda *_: seen.append("never"))
    done = OnExecutionComplete(
        target_action=lambda action: isinstance(action, LogInfo), on_completion=lambda *_: seen.append("log")
    )
    launched(
        RegisterEventHandler(once),
        RegisterEventHandler(never),
        RegisterEventHandler(done),
        UnregisterEventHandler(never),
        shell("true"),
        shell("true"),
        LogInfo(msg="x"),
    )
    assert sorted(seen) == ["log", "once"]


def test_wrong_handlers_are_told() -> None:
    with pytest.raises(TypeError, match="must be an 'ExecuteLocal' instance or a callable"):
        OnProcessExit(target_action="p", on_exit=[])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="must be an 'ExecuteLocal' instance or a callable"):
        OnProcessExit(target_action=LogInfo(msg="x"), on_exit=[])
    with pytest.raises(TypeError, match="of type 'LaunchDescriptionEntity' but got '<class 'str'>'"):
        OnProcessExit(on_exit=["x"])  # type: ignore[list-item]
    with pytest.raises(RuntimeError, match="expected an event instance"):
        EmitEvent(event="shutdown")  # type: ignore[arg-type]


def test_a_required_process_ends_all(launched: Launched) -> None:
    other = shell(FOREVER, name="other")
    _, lines = launched(
        other,
        shell("exit 1", on_exit=Shutdown(reason="it is over")),
        RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg=LocalSubstitution("event.reason"))])),
    )
    order = [
        "[INFO] [launch]: process[sh] was required: shutting down launched system",
        said("it is over"),
        "[INFO] [other]: sending signal 'SIGINT' to process[other]",
        "[ERROR] [other]: process has died [pid N, exit code -2, cmd 'sh -c sleep 60 & wait'].",
    ]
    assert [line for line in lines if line in order] == order


def test_the_shutdown_knows_its_reason(launched: Launched) -> None:
    tell = RegisterEventHandler(OnShutdown(on_shutdown=lambda event, _: LogInfo(msg=event.reason)))
    assert launched(tell) == (0, [said("idle")])
    assert launched(tell, EmitEvent(event=ShutdownEvent(reason="enough"))) == (0, [said("enough")])
    assert launched(tell, Shutdown()) == (0, [said("reason not given")])


def test_nothing_is_started_after_the_shutdown(launched: Launched) -> None:
    process = shell("true")
    _, lines = launched(RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg="end"), process])))
    assert lines == [said("end")]


def test_a_timer_waits_unless_it_is_cancelled(launched: Launched) -> None:
    cancelled = TimerAction(period=0.05, actions=[LogInfo(msg="never")])
    _, lines = launched(
        SetLaunchConfiguration("p", "0.1"),
        TimerAction(period=LaunchConfiguration("p"), actions=[LogInfo(msg="late")]),
        TimerAction(period=0.01, actions=[LogInfo(msg="sooner")]),
        LogInfo(msg="now"),
        cancelled,
        OpaqueFunction(function=lambda _: cancelled.cancel()),
        TimerAction(period=60.0, actions=[LogInfo(msg="never")], condition=IfCondition("false")),
    )
    assert lines == [said("now"), said("sooner"), said("late")]


def test_a_timer_knows_what_was_set_when_it_began(launched: Launched) -> None:
    """Also the parameters of all nodes; and what it sets itself is forgotten."""
    shown = [
        LogInfo(msg=[LaunchConfiguration("a"), " ", ParameterOfAll("p")]),
        SetLaunchConfiguration("a", "of the timer"),
    ]
    _, lines = launched(
        SetLaunchConfiguration("a", "first"),
        SetParameter("p", [1, 2]),
        TimerAction(period=0.01, actions=shown),
        SetLaunchConfiguration("a", "second"),
        TimerAction(period=0.1, actions=shown),
    )
    assert lines == [said("first (1, 2)"), said("second (1, 2)")]


def test_a_period_is_a_number_of_seconds_with_a_point(launched: Launched) -> None:
    with pytest.raises(TypeError, match=r"to be a float or a substitution: 5\.0, not 5"):
        TimerAction(period=5, actions=[])
    with pytest.warns(UserWarning, match="must be a float or a substitution: 0.1, not a text"):
        timer = TimerAction(period="0.1", actions=[LogInfo(msg="late")])
    assert launched(timer) == (0, [said("late")])


def test_the_shutdown_waits_for_no_timer(launched: Launched) -> None:
    _, lines = launched(TimerAction(period=60.0, actions=[LogInfo(msg="never")]), Shutdown())
    assert lines == []


def test_a_process_can_get_a_signal_and_be_ended_by_an_event(launched: Launched) -> None:
    first, second = shell(FOREVER), shell(FOREVER, name="second")
    launched(
        first,
        second,
        RegisterEventHandler(
            OnProcessStart(
                target_action=first,
                on_start=[
                    EmitEvent(
                        event=SignalProcess(
                            signal_number=signal.SIGUSR1, process_matcher=matches_action(first)
                        )
                    )
                ],
            )
        ),
        RegisterEventHandler(
            OnProcessStart(
                target_action=second,
                on_start=lambda event, _: EmitEvent(
                    event=ShutdownProcess(process_matcher=matches_name(event.process_name))
                ),
            )
        ),
    )
    assert (first.return_code, second.return_code) == (-signal.SIGUSR1, -signal.SIGINT)


@pytest.mark.parametrize(
    ("ignored", "sigkill_timeout", "return_code"),
    [("(2,)", "60", -signal.SIGTERM), ("(2, 15)", "0.3", -signal.SIGKILL)],
)
def test_stronger_and_stronger_signals(
    launched: Launched, ignored: str, sigkill_timeout: str, return_code: int
) -> None:
    process = python(STUBBORN.format(ignored=ignored), sigterm_timeout="0.2", sigkill_timeout=sigkill_timeout)
    shutdown = OnProcessIO(target_action=process, on_stdout=lambda _: Shutdown())
    code, lines = launched(process, RegisterEventHandler(shutdown))
    assert code == 0
    assert process.return_code == return_code
    ladder = [line for line in lines if "process[py]" in line]
    expected = [
        "[INFO] [py]: sending signal 'SIGINT' to process[py]",
        "[ERROR] [py]: process[py] failed to terminate '0.2' seconds after receiving 'SIGINT', escalating to 'SIGTERM'",
        "[INFO] [py]: sending signal 'SIGTERM' to process[py]",
        "[ERROR] [py]: process[py] failed to terminate '0.5' seconds after receiving 'SIGTERM', escalating to 'SIGKILL'",
        "[INFO] [py]: sending signal 'SIGKILL' to process[py]",
    ]
    assert ladder == expected[: 3 if return_code == -signal.SIGTERM else 5]


def test_the_timeouts_are_five_seconds_unless_a_configuration_says_otherwise() -> None:
    process = shell("true")
    timeouts = (process.sigterm_timeout, process.sigkill_timeout)
    context = LaunchContext()
    assert [[sub.perform(context) for sub in timeout] for timeout in timeouts] == [["5"], ["5"]]
    context.launch_configurations.update(sigterm_timeout="1", sigkill_timeout="2")
    assert [[sub.perform(context) for sub in timeout] for timeout in timeouts] == [["1"], ["2"]]


# The service


def test_the_service_can_be_ended_from_another_thread(capsys: pytest.CaptureFixture[str]) -> None:
    service = LaunchService(noninteractive=True)
    process = shell(FOREVER)
    threads = []

    def end_it(*_: Any) -> None:
        threads.append(threading.Thread(target=service.shutdown))
        threads[0].start()

    service.include_launch_description(
        LaunchDescription([process, RegisterEventHandler(OnProcessStart(on_start=end_it))])
    )
    assert service.run() == 0
    threads[0].join()
    assert process.return_code == -signal.SIGINT
    assert service.shutdown() is None  # too late, and no error


def test_the_service_can_run_in_a_loop_of_somebody_else_and_stay_idle() -> None:
    async def use() -> int:
        service = LaunchService()
        task = asyncio.ensure_future(service.run_async(shutdown_when_idle=False))
        while service.event_loop is None:
            await asyncio.sleep(0)
        seen = asyncio.Event()
        service.include_launch_description(LaunchDescription([OpaqueFunction(function=lambda _: seen.set())]))
        await seen.wait()
        ended = service.shutdown()
        assert ended is not None
        await ended
        return await task

    assert asyncio.run(use()) == 0


def test_the_service_needs_the_main_thread_and_runs_once_at_a_time() -> None:
    errors: list[Exception] = []

    def run() -> None:
        try:
            LaunchService().run()
        except RuntimeError as error:
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert "can only be run in the main thread" in str(errors[0])
    service = LaunchService()

    async def again(_: LaunchContext) -> None:
        await service.run_async()

    service.include_launch_description(LaunchDescription([OpaqueCoroutine(coroutine=again)]))
    assert service.run() == 1


def test_signal_handlers_are_given_back() -> None:
    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)]
    LaunchService().run()
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)] == before


def test_debug_shows_the_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    def broken(_: LaunchContext) -> None:
        raise RuntimeError("broken")

    service = LaunchService(debug=True)
    service.include_launch_description(LaunchDescription([OpaqueFunction(function=broken)]))
    assert service.run() == 1
    text = capsys.readouterr().out
    assert "Default logging verbosity is set to DEBUG" in text
    assert "[DEBUG] [launch]: Traceback (most recent call last):" in text


def test_a_log_folder_that_cannot_be_made_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "file"))
    with pytest.raises(RuntimeError, match=r"cannot be made \(.*\); set ROS_LOG_DIR to a folder"):
        LaunchService().run()


def test_the_screen_format_can_be_changed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for text, expected in {
        "default_with_timestamp": r"\d+\.\d{7} \[INFO\] \[a\]: hello",
        "{name}\\t{msg}": r"a\thello",
    }.items():
        monkeypatch.setenv("OVERRIDE_LAUNCH_SCREEN_FORMAT", text)
        launch.logging.reset()
        launch.logging.get_logger("a").info("hello")
        assert re.fullmatch(expected, capsys.readouterr().out.rstrip("\n"))


# Nodes


def ros_arguments(launched: Launched, *entities: Any, name: str = "show") -> list[str]:
    """Return what the executable `show` was given; parameter files are FILE and what they hold."""
    _, lines = launched(*entities)
    return [re.sub(r"^/\S*launch_params_\w+$", "FILE", line) for line in output_of(lines, name)]


def show(**arguments: Any) -> Node:
    return Node(package="demo", executable="show", output="screen", **arguments)


@pytest.mark.usefixtures("prefix")
def test_a_node_gets_its_arguments_in_the_order_of_jazzy(launched: Launched) -> None:
    node = show(
        name="talker",
        namespace="robot",
        arguments=["a", LaunchConfiguration("b", default="c")],
        ros_arguments=["--log-level", "debug"],
        parameters=[{"period": 2}],
        remappings=[("chatter", "talk"), ("/x", LaunchConfiguration("y", default="/z"))],
    )
    assert ros_arguments(launched, node) == [
        *("a", "c", "--ros-args", "--log-level", "debug", "--ros-args"),
        *("-r", "__node:=talker", "-r", "__ns:=/robot", "--params-file", "FILE"),
        *("/robot/talker:", "  ros__parameters:", "    period: 2"),
        *("-r", "chatter:=talk", "-r", "/x:=/z"),
    ]
    assert node.node_name == "/robot/talker"


@pytest.mark.usefixtures("prefix")
def test_a_node_without_more_gets_nothing(launched: Launched) -> None:
    node = show()
    assert ros_arguments(launched, node) == ["--ros-args"]
    with pytest.raises(RuntimeError, match="cannot access 'node_name' before executing action"):
        _ = show().node_name


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"a": 1}, {"a": 1}),
        ({"a": 1.0, "b": True, "c": "text"}, {"a": 1.0, "b": True, "c": "text"}),
        ({"a": "1.0"}, {"a": "1.0"}),
        ({"a": ""}, {"a": ""}),
        ({"a": {"b": {"c": 1}, "d": 2}}, {"a.b.c": 1, "a.d": 2}),
        ({"a": [1, 2]}, {"a": [1, 2]}),
        ({"a": [1, 2.5]}, {"a": [1.0, 2.5]}),
        ({"a": ["x", "1"]}, {"a": ["x", "1"]}),
        ({"a": LaunchConfiguration("five")}, {"a": 5}),
        ({"a": [LaunchConfiguration("five")]}, {"a": 5}),
        ({"a": ["n", LaunchConfiguration("five")]}, {"a": "n5"}),
        ({"a": [[LaunchConfiguration("five")], ["6"]]}, {"a": [5, 6]}),
        ({"a": LaunchConfiguration("list")}, {"a": [1, 2]}),
        ({"a": LaunchConfiguration("empty")}, {"a": ""}),
        ({("a", LaunchConfiguration("five")): 1}, {"a5": 1}),
        ({"a": ParameterValue(LaunchConfiguration("five"), value_type=str)}, {"a": "5"}),
        ({"a": ParameterValue(LaunchConfiguration("five"), value_type=float)}, {"a": 5.0}),
        ({"a": ParameterValue([LaunchConfiguration("five")], value_type=int)}, {"a": 5}),
        ({"a": ParameterValue(["5", "6"], value_type=list[str])}, {"a": ["5", "6"]}),
        ({"a": ParameterValue([1, 2], value_type=list[float])}, {"a": [1.0, 2.0]}),
        ({"a": ParameterValue(LaunchConfiguration("list"), value_type=list[int])}, {"a": [1, 2]}),
        ({"a": ParameterValue(True)}, {"a": True}),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_parameters_keep_their_types(launched: Launched, given: Any, expected: Any) -> None:
    configurations = {"five": "5", "list": "[1, 2]", "empty": ""}
    entities = [SetLaunchConfiguration(name, value) for name, value in configurations.items()]
    lines = ros_arguments(launched, *entities, show(parameters=[given]))
    content = yaml.safe_load("\n".join(lines[lines.index("FILE") + 1 :]))
    result = content["/**"]["ros__parameters"]
    assert result == expected
    assert [type(value) for value in result.values()] == [type(value) for value in expected.values()]


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"a": 1}, "Expected 'parameters' to be a list"),
        ("file.yaml", "Expected 'parameters' to be a list"),
        ([{"a": None}], "Unexpected type for parameter value None"),
        ([{"a": []}], "Expected a non-empty sequence"),
        ([{"a": [1, "x"]}], 'Got inconsistent input for "a"'),
        ([{"a": LaunchConfiguration("m", default="{x: 1}")}], "Allowed value types are"),
        (
            [{"a": LaunchConfiguration("m", default="a: b: c")}],
            "Unable to parse the value of parameter a as yaml",
        ),
        (
            [{"a": ParameterValue(LaunchConfiguration("m", default="x"), value_type=int)}],
            "invalid literal for int()",
        ),
        ([5], "object is not iterable"),
        (
            [ParameterFile("bad.yaml", allow_substs=True)],
            "The substituted parameter file is not a valid yaml file",
        ),
        ([ParameterFile("none.yaml", allow_substs=True)], "No such file or directory"),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_wrong_parameters_are_told(
    launched: Launched, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parameters: Any, text: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.yaml").write_text("a: b: c")
    code, lines = launched(OpaqueFunction(function=lambda _: [show(parameters=parameters)]))
    assert code == 1
    assert text in "\n".join(lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.parametrize(
    ("value", "kind"), [(5, str), ("x", int), ([1], int), ([1, "x"], None), ({}, None), (1, dict)]
)
def test_a_value_that_can_never_be_of_its_type(value: Any, kind: Any) -> None:
    with pytest.raises((TypeError, ValueError)):
        ParameterValue(value, value_type=kind).evaluate(LaunchContext())


def test_parameter_files_and_single_parameters(launched: Launched, prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "with.yaml").write_text("/**: {ros__parameters: {a: $(var v), b: $(env SOME_V none)}}\n")
    share = PathJoinSubstitution([FindPackageShare("demo"), "config", "demo.yaml"])
    lines = ros_arguments(
        launched,
        SetLaunchConfiguration("v", "7"),
        show(
            parameters=[
                share,
                prefix / "share/demo/config/demo.yaml",
                [FindPackageShare("demo"), "/config/demo.yaml"],
                ParameterFile(str(tmp_path / "with.yaml"), allow_substs=True),
                Parameter("x", LaunchConfiguration("v"), value_type=str),
                Parameter("y", [1, 2]),
            ]
        ),
    )
    file = str(prefix / "share/demo/config/demo.yaml")
    assert [line for line in lines if line.startswith(("--params", "/", "FILE", "-p"))] == [
        *("--params-file", file, "/**:") * 3,
        *("--params-file", "FILE", "/**: {ros__parameters: {a: 7, b: none}}"),
        *("-p", "-p"),
    ]
    assert "x:='7'" in lines
    assert "y:=[1, 2]" in lines


@pytest.mark.usefixtures("prefix")
def test_a_parameter_file_that_is_not_there_is_a_warning(launched: Launched) -> None:
    _, lines = launched(show(parameters=["/no/file.yaml"]))
    assert lines[0] == "[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: /no/file.yaml"
    assert output_of(lines, "show") == ["--ros-args"]


@pytest.mark.usefixtures("prefix")
def test_namespaces_parameters_and_remappings_of_a_group(launched: Launched) -> None:
    outer, inner, absolute = (show(exec_name=name) for name in ("outer", "inner", "absolute"))
    inner = show(exec_name="inner", namespace="c")
    absolute = show(exec_name="absolute", namespace="/d")
    _, lines = launched(
        PushRosNamespace("a"),
        SetParameter("p", 1),
        GroupAction([PushRosNamespace("b"), SetParameter("q", "1"), SetRemap("x", "y"), inner, absolute]),
        SetUseSimTime(True),
        outer,
    )
    assert output_of(lines, "inner") == [
        *("--ros-args", "-r", "__ns:=/a/b/c", "-p", "p:=1", "-p", "q:='1'", "-r", "x:=y")
    ]
    assert output_of(lines, "absolute")[:3] == ["--ros-args", "-r", "__ns:=/d"]
    assert output_of(lines, "outer") == [
        *("--ros-args", "-r", "__ns:=/a", "-p", "p:=1", "-p", "use_sim_time:=true")
    ]


def test_parameters_of_a_file_and_the_log_folder_of_all_nodes(
    launched: Launched, prefix: Path, tmp_path: Path
) -> None:
    file = str(prefix / "share/demo/config/demo.yaml")
    _, lines = launched(
        SetParametersFromFile(file),
        SetROSLogDir("nodes"),
        show(),
        LogInfo(msg=EnvironmentVariable("ROS_LOG_DIR")),
    )
    assert output_of(lines, "show")[:3] == ["--ros-args", "--params-file", file]
    assert said(str(tmp_path / "log/nodes")) in lines


@pytest.mark.parametrize(
    ("entity", "text"),
    [
        (lambda: Node(package="none_such", executable="show"), "package 'none_such' not found, searching: ["),
        (
            lambda: Node(package="demo", executable="none"),
            "executable 'none' not found on the libexec directory",
        ),
        (
            lambda: show(name="a-b"),
            "node name must not contain characters other than alphanumerics or '_':\n  'a-b'\n    ^",
        ),
        (lambda: show(name=""), "node name must not be empty"),
        (lambda: show(name="1a"), "node name must not start with a number"),
        (
            lambda: show(namespace="x/1a"),
            "namespace must not have a token that starts with a number:\n  '/x/1a'\n      ^",
        ),
        (lambda: show(namespace="x//y"), "namespace must not be empty"),
        (
            lambda: PushRosNamespace("x-y"),
            "The resulting namespace is invalid: [previous_namespace='None', pushed_namespace='x-y']",
        ),
        (lambda: show(remappings=["a:=b"]), "Expected 'remap_rule' to be a tuple"),
        (lambda: show(remappings=[("a", "b", "c")]), "remap_rule must be a tuple of length 2, got length 3"),
        (lambda: show(parametrs=[]), "got an unexpected keyword argument 'parametrs'"),
        (lambda: Node(package="demo"), "missing 1 required keyword-only argument: 'executable'"),
    ],
)
@pytest.mark.usefixtures("prefix")
def test_a_wrong_node_is_told(launched: Launched, entity: Any, text: str) -> None:
    code, lines = launched(OpaqueFunction(function=lambda _: [entity()]))
    assert code == 1
    assert text in "\n".join(lines)
    assert "Traceback" not in "\n".join(lines)


@pytest.mark.usefixtures("prefix")
def test_a_namesake_is_a_warning(launched: Launched) -> None:
    _, lines = launched(*(show(name="same", namespace="/") for _ in range(2)))
    assert [line for line in lines if line.startswith("[WARNING]")] == [
        "[WARNING] [show]: there are now at least 2 nodes with the name /same created within this launch context"
    ]


def test_an_executable_without_a_package(launched: Launched, prefix: Path) -> None:
    node = Node(executable=str(prefix / "lib/demo/show"), output="screen")
    assert ros_arguments(launched, node) == ["--ros-args"]


def test_no_parameter_file_is_left(launched: Launched, prefix: Path, tmp_path: Path) -> None:
    """Those of a process are removed at its end."""
    folder = tmp_path / "tmp"
    folder.mkdir()
    script = (
        "from launch import *; from launch_ros.actions import Node; s = LaunchService();"
        "s.include_launch_description(LaunchDescription([Node(package='demo', executable='show',"
        " parameters=[{'a': 1}])])); s.run()"
    )
    os.environ["TMPDIR"] = str(folder)
    launched(ExecuteProcess(cmd=[sys.executable, "-c", script], output="screen"))
    assert list(folder.iterdir()) == []


# What is not there

JAZZY = {
    "launch": "Action Condition Event EventHandler InvalidLaunchFileError LaunchContext LaunchDescription "
    "LaunchDescriptionEntity LaunchDescriptionSource LaunchIntrospector LaunchService SomeEntitiesType "
    "SomeEntitiesType_types_tuple SomeSubstitutionsType SomeSubstitutionsType_types_tuple Substitution actions "
    "conditions descriptions events frontend logging substitutions",
    "launch.actions": "AppendEnvironmentVariable DeclareLaunchArgument EmitEvent ExecuteLocal ExecuteProcess "
    "GroupAction IncludeLaunchDescription LogInfo OpaqueCoroutine OpaqueFunction PopEnvironment "
    "PopLaunchConfigurations PushEnvironment PushLaunchConfigurations RegisterEventHandler ResetEnvironment "
    "ResetLaunchConfigurations SetEnvironmentVariable SetLaunchConfiguration Shutdown TimerAction "
    "UnregisterEventHandler UnsetEnvironmentVariable UnsetLaunchConfiguration",
    "launch.substitutions": "AllSubstitution AndSubstitution AnonName AnySubstitution Command "
    "EnvironmentVariable EqualsSubstitution FileContent FindExecutable IfElseSubstitution LaunchConfiguration "
    "LaunchLogDir LocalSubstitution NotEqualsSubstitution NotSubstitution OrSubstitution PathJoinSubstitution "
    "PathSubstitution PythonExpression SubstitutionFailure TextSubstitution ThisLaunchFile ThisLaunchFileDir",
    "launch.conditions": "IfCondition InvalidConditionExpressionError LaunchConfigurationEquals "
    "LaunchConfigurationNotEquals UnlessCondition evaluate_condition_expression",
    "launch.event_handlers": "OnExecutionComplete OnIncludeLaunchDescription OnProcessExit OnProcessIO "
    "OnProcessStart OnShutdown event_named",
    "launch.events": "ExecutionComplete IncludeLaunchDescription Shutdown TimerEvent matches_action process",
    "launch.events.process": "ProcessExited ProcessIO ProcessStarted ProcessStderr ProcessStdin ProcessStdout "
    "ProcessTargetedEvent RunningProcessEvent ShutdownProcess SignalProcess matches_executable matches_name "
    "matches_pid",
    "launch.utilities": "ensure_argument_type is_a is_a_subclass isclassinstance normalize_to_list_of_entities "
    "normalize_to_list_of_substitutions perform_substitutions visit_all_entities_and_collect_futures",
    "launch_ros.actions": "ComposableNodeContainer LifecycleNode LifecycleTransition LoadComposableNodes Node "
    "PushROSNamespace PushRosNamespace ROSTimer RosTimer SetParameter SetParametersFromFile SetROSLogDir "
    "SetRemap SetUseSimTime",
    "launch_ros.substitutions": "ExecutableInPackage FindPackage FindPackagePrefix FindPackageShare Parameter",
    "launch_ros.descriptions": "ComposableLifecycleNode ComposableNode Parameter ParameterFile ParameterValue",
    "launch_ros.event_handlers": "OnStateTransition",
    "launch_ros.events.lifecycle": "ChangeState StateTransition",
    "launch_xml": "Entity Parser",
    "launch_xml.launch_description_sources": "XMLLaunchDescriptionSource",
    "launch_yaml": "Entity Parser",
    "launch_yaml.launch_description_sources": "YAMLLaunchDescriptionSource",
}


@pytest.mark.parametrize(("module", "name"), [(m, n) for m, names in JAZZY.items() for n in names.split()])
def test_every_name_of_jazzy_is_there_or_says_what_it_needs(module: str, name: str) -> None:
    loaded = importlib.import_module(module)
    try:
        getattr(loaded, name)
        sentence = None
    except ImportError as error:
        sentence = str(error)
    package = module.partition(".")[0]
    assert sentence is None or re.fullmatch(
        rf"{re.escape(module)}\.{name} is not in this small {package}: it needs the real package {package}, "
        r"which an installed ROS 2 brings \(apt install ros-jazzy-[a-z-]+\)\.",
        sentence,
    )


@pytest.mark.parametrize("module", sorted(JAZZY))
def test_a_name_that_there_never_was_is_an_ordinary_mistake(module: str) -> None:
    with pytest.raises(AttributeError):
        _ = importlib.import_module(module).NoSuchThing


def test_importing_launch_costs_nothing() -> None:
    import subprocess

    code = "import sys, launch, launch_ros; print([m for m in ('asyncio', 'yaml', 'rclpy', 'xml') if m in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_including_gives_back_the_place(launched: Launched, tmp_path: Path) -> None:
    """After an included file, `this` is again the including one."""
    inner, outer = tmp_path / "in", tmp_path / "out"
    header = "from launch import *\nfrom launch.actions import *\nfrom launch.substitutions import *\n"
    header += "from launch.launch_description_sources import *\ndef generate_launch_description():\n"
    for folder in (inner, outer):
        folder.mkdir()
    (inner / "inner.launch.py").write_text(
        f"{header}    return LaunchDescription([LogInfo(msg=ThisLaunchFileDir())])\n"
    )
    (outer / "outer.launch.py").write_text(
        f"{header}    return LaunchDescription([IncludeLaunchDescription(PythonLaunchDescriptionSource("
        "[ThisLaunchFileDir(), '/../in/inner.launch.py'])), LogInfo(msg=ThisLaunchFile())])\n"
    )
    source = PythonLaunchDescriptionSource(str(outer / "outer.launch.py"))
    code, lines = launched(IncludeLaunchDescription(source))
    assert code == 0
    assert lines == [said(f"{outer}/../in"), said(str(outer / "outer.launch.py"))]
