"""What other packages build upon: own tags, substitutions and parsers, typed values, handlers of log records."""

from __future__ import annotations

import asyncio
import io
import logging
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from launch_ros.events.matchers import matches_node_name

import launch.logging
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity, LaunchService
from launch.actions import ExecuteProcess, LogInfo, OpaqueFunction, SetLaunchConfiguration
from launch.frontend import Entity, Parser, expose, expose_action, expose_substitution
from launch.frontend.parser import InvalidFrontendLaunchFileError
from launch.frontend.type_utils import check_is_list_entity, get_data_type_from_identifier
from launch.substitutions import LocalSubstitution, TextSubstitution
from launch.utilities import (
    ensure_argument_type,
    is_a_subclass,
    perform_substitutions,
    visit_all_entities_and_collect_futures,
)
from launch.utilities.type_utils import (
    coerce_list,
    extract_type,
    get_typed_value,
    is_normalized_substitution,
    is_typing_list,
    normalize_typed_substitution,
    perform_typed_substitution,
)
from launch_ros.actions import (
    ComposableNodeContainer,
    LifecycleNode,
    LoadComposableNodes,
    Node,
    ROSTimer,
    SetUseSimTime,
)
from launch_ros.descriptions import ComposableNode, ParameterFile
from launch_ros.utilities import evaluate_parameters, normalize_parameters

pytestmark = pytest.mark.usefixtures("clean_launch")

Launched = Callable[..., tuple[int, list[str]]]
EXTENSION = """
from launch.actions import LogInfo
from launch.frontend import expose_action, expose_substitution
from launch.substitutions import TextSubstitution

@expose_action("shout")
class Shout(LogInfo):
    @classmethod
    def parse(cls, entity, parser):
        cls, keywords = super().parse(entity, parser)
        keywords["msg"] = [*keywords["msg"], "!" * entity.get_attr("times", data_type=int)]
        return cls, keywords

@expose_substitution("twice")
def twice(data):
    return TextSubstitution, {"text": data[0][0].text * 2}
"""
PARSER = """
from launch.frontend import Entity, Parser as Base

class Line(Entity):
    parent = None
    def __init__(self, type_name, text):
        self.type_name, self._text = type_name, text
    @property
    def children(self):
        return [Line("log", line) for line in self._text.splitlines()]
    def get_attr(self, name, *, data_type=str, optional=False, can_be_str=True):
        return self._text if name == "message" else None
    def assert_entity_completely_parsed(self):
        pass

class Parser(Base):
    @classmethod
    def load(cls, file):
        return Line("launch", file.read()), cls()
    @classmethod
    def get_file_extensions(cls):
        return {"lines"}
"""
ENTRY_POINTS = """
[launch.frontend.launch_extension]
shout = shouting
broken = no_such_module_at_all

[launch.frontend.parser]
lines = shouting_lines:Parser
"""


@pytest.fixture
def extension(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Install a package whose entry points add a tag, a substitution and a parser; yield its folder."""
    info = tmp_path / "shouting-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: shouting\nVersion: 1\n")
    (info / "entry_points.txt").write_text(ENTRY_POINTS)
    (tmp_path / "shouting.py").write_text(EXTENSION)
    (tmp_path / "shouting_lines.py").write_text(PARSER)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(expose, "_pending", [expose._load_entry_points])
    monkeypatch.setattr(Parser, "_has_all_parsers", False)
    for name in ("action_parse_methods", "substitution_parse_methods"):
        monkeypatch.setattr(expose, name, dict(getattr(expose, name)))
    before = dict(Parser.frontend_parsers)
    yield tmp_path
    Parser.frontend_parsers.clear()
    Parser.frontend_parsers.update(before)
    for module in ("shouting", "shouting_lines"):
        sys.modules.pop(module, None)


def described(text: str) -> LaunchDescription:
    entity, parser = Parser.load(io.StringIO(textwrap.dedent(text)))
    return parser.parse_description(entity)


# Tags, substitutions and parsers of other packages


@pytest.mark.filterwarnings("ignore:The launch extension 'broken' cannot be loaded:UserWarning")
def test_a_package_may_add_a_tag_and_a_substitution(extension: Path, launched: Launched) -> None:
    description = described("<launch><shout message='$(twice ho)' times='3' if='true'/></launch>")
    assert launched(description) == (0, ["[INFO] [launch.user]: hoho!!!"])


def test_an_extension_that_cannot_be_loaded_is_told_and_hinders_no_other(extension: Path) -> None:
    with pytest.warns(UserWarning, match=r"'broken' cannot be loaded: ModuleNotFoundError: No module named"):
        Parser.load_launch_extensions()
    assert "shout" in expose.action_parse_methods


def test_a_package_may_add_a_parser(extension: Path, launched: Launched) -> None:
    (extension / "a.lines").write_text("one\ntwo\n")
    entity, parser = Parser.load(extension / "a.lines")
    expected = ["[INFO] [launch.user]: one", "[INFO] [launch.user]: two"]
    assert launched(parser.parse_description(entity)) == (0, expected)
    assert {"xml", "yaml", "lines"} <= set(Parser.get_available_extensions())
    assert {"launch.xml", "yml", "lines"} <= Parser.get_file_extensions_from_parsers()


def test_an_unknown_tag_and_an_unknown_substitution_stay_unknown() -> None:
    with pytest.raises(RuntimeError, match="Unrecognized entity of the type: nowhere"):
        described("<launch><nowhere/></launch>")
    with pytest.raises(RuntimeError, match="Unknown substitution: nowhere"):
        described("<launch><log message='$(nowhere)'/></launch>")


def test_a_name_stands_for_one_thing() -> None:
    def parse(*_: Any) -> Any:
        raise AssertionError

    with pytest.raises(RuntimeError, match="Two parsing methods are exposed for the action 'log'"):
        expose_action("log")(parse)
    with pytest.raises(
        RuntimeError, match="'five' can only be exposed by a class with a class method 'parse'"
    ):
        expose_substitution("five")(5)  # type: ignore[type-var]
    expose_action("log")(LogInfo)  # once more the same


def test_a_class_derived_from_an_action_reads_what_its_base_reads() -> None:
    class Own(SetLaunchConfiguration):
        pass

    entity, parser = Parser.load(io.StringIO("<let name='a' value='b' unless='true'/>"))
    made, keywords = Own.parse(entity, parser)
    assert made is Own
    assert set(keywords) == {"name", "value", "condition"}


def test_an_open_file_is_read_as_its_content_asks_for() -> None:
    for text in ("<launch><log message='a'/></launch>", "launch:\n- log: {message: a}\n"):
        assert isinstance(described(text).entities[0], LogInfo)
    with pytest.raises(InvalidFrontendLaunchFileError, match="syntax error, or its format is unknown"):
        described("{")


def test_a_tag_knows_the_one_it_is_in_and_the_types_of_its_attributes() -> None:
    entity, _ = Parser.load(io.StringIO("<a><b c='1;2' c-sep=';' d='3'/></a>"))
    (inner,) = entity.children
    assert inner.parent is entity
    assert entity.parent is None
    assert inner.get_attr("c", data_type=list[str]) == ["1", "2"]
    assert inner.get_attr("c", data_type=list[float]) == [1.0, 2.0]
    with pytest.raises(TypeError):
        inner.get_attr("c", data_type=int)
    assert entity.get_attr("b", data_type=list[Entity])[0].get_attr("d", data_type=None) == 3


@pytest.mark.parametrize(
    ("kind", "value", "expected"),
    [
        ("list_of_int", "1; 2", [1, 2]),
        ("list_of_float", "1; 2.5", [1.0, 2.5]),
        ("list_of_bool", "true; false", [True, False]),
        ("list_of_str", "1; $(var a)", ["1", "A"]),
    ],
)
def test_a_parameter_may_be_a_list_with_separators(kind: str, value: str, expected: list[Any]) -> None:
    description = described(
        f"""
        <launch>
          <node exec="true"><param name="p" value="{value}" value-sep="; " type="{kind}"/></node>
        </launch>
        """
    )
    (node,) = description.entities
    assert isinstance(node, Node)
    context = LaunchContext()
    context.launch_configurations["a"] = "A"
    assert evaluate_parameters(context, node._parameters) == ({"p": expected},)


def test_the_types_that_a_launch_file_names() -> None:
    assert get_data_type_from_identifier("list_of_int") == list[int]
    assert get_data_type_from_identifier("yaml") is None
    with pytest.raises(ValueError, match="Got invalid type identifier 'complex'"):
        get_data_type_from_identifier("complex")
    assert check_is_list_entity(list[Entity])
    assert not check_is_list_entity(list[int])


# Typed values and other helpers


def test_texts_become_values_of_a_type() -> None:
    assert get_typed_value("[1, 2]", list[int]) == [1, 2]
    assert get_typed_value(["1", "2"], list[int]) == [1, 2]
    assert coerce_list(["a", "1"], can_be_str=True) == ["a", 1]
    for value, kind in ((["1", "2"], int), ({"a"}, None), ([1, 2], None)):
        with pytest.raises(TypeError):
            get_typed_value(value, kind)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="to one type"):
        coerce_list(["a", "1"])
    assert is_typing_list(list[int])
    assert not is_typing_list(list)
    assert extract_type(list[str]) == (str, True)


def test_values_are_of_their_type_while_launching() -> None:
    context = LaunchContext()
    text = TextSubstitution(text="3")
    assert perform_typed_substitution(context, normalize_typed_substitution(text, int), int) == 3
    assert perform_typed_substitution(context, [[text], 4], list[int]) == [3, 4]
    assert is_normalized_substitution([text])
    assert not is_normalized_substitution([])
    for value, kind, error in (
        (1.0, int, TypeError),
        (object, int, TypeError),
        ([1], int, ValueError),
        ([[text], [TextSubstitution(text="x")]], None, ValueError),
    ):
        with pytest.raises(error):
            perform_typed_substitution(context, value, kind)


def test_an_argument_of_another_type_is_told_by_its_name() -> None:
    ensure_argument_type(1, [str, int], "number")
    with pytest.raises(
        TypeError, match=r"'Clock' expected 'period' to be one of \[<class 'float'>\], but got '1'"
    ):
        ensure_argument_type(1, float, "period", "Clock")
    assert is_a_subclass(Node, ExecuteProcess)
    assert is_a_subclass(True, int)
    with pytest.raises(RuntimeError, match="is not a class"):
        is_a_subclass(1, 2)  # type: ignore[arg-type]


def test_all_entities_are_visited_and_their_futures_collected() -> None:
    class Waiting(LaunchDescriptionEntity):
        def __init__(self, *inner: LaunchDescriptionEntity) -> None:
            self.inner = inner

        def visit(self, _: LaunchContext) -> Any:
            return self.inner

        def get_asyncio_future(self) -> asyncio.Future[None]:
            return asyncio.get_running_loop().create_future()

    async def visited(entity: LaunchDescriptionEntity) -> list[LaunchDescriptionEntity]:
        return [found for found, _ in visit_all_entities_and_collect_futures(entity, LaunchContext())]

    inner = Waiting()
    outer = Waiting(LaunchDescriptionEntity(), inner)
    assert asyncio.run(visited(outer)) == [outer, inner]


# Context and service


def test_what_is_known_at_a_place_is_extended_and_never_set() -> None:
    context = LaunchContext()
    context.extend_locals({"a": 1})
    assert context.locals.a == 1
    with pytest.raises(AttributeError, match="can only be set by context"):
        context.locals.a = 2


def test_nothing_is_started_when_a_later_entity_cannot_be_visited(launched: Launched, tmp_path: Path) -> None:
    def fail(_: LaunchContext) -> None:
        raise RuntimeError("no way")

    touch = ExecuteProcess(cmd=["touch", str(tmp_path / "started")])
    code, lines = launched(touch, OpaqueFunction(function=fail), LogInfo(msg="never"))
    assert (code, len(lines)) == (1, 1)
    assert lines[0].endswith("no way")
    assert not (tmp_path / "started").exists()


def test_the_end_of_a_service_may_be_made_a_task() -> None:
    async def use() -> int:
        service = LaunchService()
        task = asyncio.ensure_future(service.run_async(shutdown_when_idle=False))
        while service.event_loop is None:
            await asyncio.sleep(0)
        ended = service.shutdown()
        assert ended is not None
        await asyncio.get_running_loop().create_task(ended)
        return await task

    assert asyncio.run(use()) == 0


# Handlers of log records


def test_a_handler_has_a_format_for_each_logger() -> None:
    stream = io.StringIO()
    handler = launch.logging.handlers.StreamHandler(stream)
    plain, other = logging.Logger("plain"), logging.Logger("other")
    for logger in (plain, other):
        logger.addHandler(handler)
    handler.setFormatter(logging.Formatter("{name} {message}", style="{"))
    handler.setFormatterFor(plain, logging.Formatter("{message}", style="{"))
    for logger in (plain, other):
        logger.warning("seen")
    handler.unsetFormatterFor(plain)
    plain.warning("again")
    assert stream.getvalue() == "seen\nother seen\nplain again\n"
    assert launch.logging.handlers.RotatingFileHandler.__mro__[2] is logging.handlers.RotatingFileHandler
    with pytest.raises(AttributeError):
        _ = launch.logging.handlers.NoSuchHandler


def test_log_files_are_made_by_a_handler_of_ones_own(tmp_path: Path) -> None:
    written: dict[str, list[str]] = {}

    class Kept(launch.logging.handlers.Handler):
        def __init__(self, path: str, encoding: str | None = None) -> None:
            super().__init__()
            assert encoding == "utf-8"
            self.lines = written.setdefault(path, [])

        def emit(self, record: logging.LogRecord) -> None:
            self.lines.append(self.format(record))

    config = launch.logging.launch_config
    config.log_dir = str(tmp_path)
    config.log_handler_factory = Kept
    config.set_log_format("%(name)s: %(message)s", log_style="%")
    launch.logging.get_logger("me").error("here")
    out, _ = launch.logging.get_output_loggers("me", "both")
    out.info("there")
    (lines,) = (written[path] for path in written if path == config.get_log_file_path())
    assert lines[0] == "me: here"
    assert lines[1].endswith(" there")
    with pytest.raises(ValueError, match="has a style of its own"):
        config.set_log_format("default", log_style="%")


# What goes beyond this small launch_ros


def test_composable_nodes_may_stand_in_a_file_that_does_not_use_them(launched: Launched) -> None:
    description = described(
        """
        <launch>
          <arg name="composed" default="false"/>
          <node_container pkg="a" exec="b" name="c" namespace="" if="$(var composed)">
            <composable_node pkg="a" plugin="b::C" name="d"><param name="p" value="1"/></composable_node>
          </node_container>
          <load_composable_node target="c" if="$(var composed)">
            <composable_node pkg="a" plugin="b::C" name="d"><remap from="e" to="f"/></composable_node>
          </load_composable_node>
          <log message="without" unless="$(var composed)"/>
        </launch>
        """
    )
    assert launched(description) == (0, ["[INFO] [launch.user]: without"])


@pytest.mark.parametrize(
    "action",
    [
        ComposableNodeContainer(
            name="c",
            namespace="",
            package="a",
            executable="b",
            composable_node_descriptions=[ComposableNode(package="a", plugin="b::C")],
        ),
        LoadComposableNodes(target_container="c", composable_node_descriptions=[]),
    ],
    ids=lambda action: type(action).__name__,
)
def test_a_composable_node_that_is_used_names_the_real_package(action: Any, launched: Launched) -> None:
    code, (line,) = launched(action)
    assert code == 1
    assert f"launch_ros.actions.{type(action).__name__} is not in this small launch_ros" in line
    assert "(apt install ros-jazzy-launch-ros)" in line


def test_a_timer_of_the_nodes_needs_the_clock_on_the_wall(launched: Launched) -> None:
    timer = ROSTimer(period=0.01, actions=[LogInfo(msg="late")])
    assert launched(timer) == (0, ["[INFO] [launch.user]: late"])
    code, lines = launched(SetUseSimTime(True), ROSTimer(period=0.01, actions=[]))
    assert code == 1
    assert "launch_ros.actions.ROSTimer is not in this small launch_ros" in lines[0]


def test_a_lifecycle_node_is_run_and_has_a_name(launched: Launched) -> None:
    node = LifecycleNode(executable="echo", name="n", namespace="s", output="screen")
    assert launched(node)[0] == 0
    assert node.cmd[-4:] == ["-r", "__node:=n", "-r", "__ns:=/s"]
    assert matches_node_name("s/n")(node)


@pytest.mark.usefixtures("prefix")
def test_a_lifecycle_node_that_shall_start_by_itself_needs_the_real_package(launched: Launched) -> None:
    tag = "<launch><lifecycle_node pkg='demo' exec='show' name='n' namespace='s' autostart='{}'/></launch>"
    assert launched(*described(tag.format("false")).entities)[0] == 0
    code, lines = launched(*described(tag.format("true")).entities)
    assert code == 1
    assert "launch_ros.actions.LifecycleNode(autostart=True) is not in this small launch_ros" in lines[0]


def test_a_parameter_of_all_nodes_is_a_substitution() -> None:
    text = "<launch><set_parameter name='p' value='5'/><log message='$(param p) $(param q none)'/></launch>"
    given, log = described(text).entities
    context = LaunchContext()
    given.visit(context)
    assert isinstance(log, LogInfo)
    assert perform_substitutions(context, log.msg) == "5 none"


def test_parameters_of_no_type_are_told_when_a_node_is_described() -> None:
    for wrong in ({5: "a"}, {"a": {1, 2}}, {"a": {"b": [1, 2, [3]]}}, {"a": object()}):
        with pytest.raises(TypeError):
            Node(executable="true", parameters=[wrong])


def test_parameters_keep_their_types() -> None:
    given = {
        "text": "1",
        "mixed": [1, 2.5],
        "nested": {"inner": True},
        "made": [[TextSubstitution(text="2")]],
    }
    (evaluated,) = evaluate_parameters(LaunchContext(), normalize_parameters([given]))
    assert evaluated == {"text": "1", "mixed": (1.0, 2.5), "nested.inner": True, "made": (2,)}


def test_the_file_that_was_made_for_its_substitutions_is_deleted(tmp_path: Path) -> None:
    (tmp_path / "p.yaml").write_text("/**: {ros__parameters: {a: $(var b)}}\n")
    context = LaunchContext()
    context.launch_configurations["b"] = "7"
    file = ParameterFile(tmp_path / "p.yaml", allow_substs=True)
    made = file.evaluate(context)
    assert "a: 7" in made.read_text()
    assert file.param_file == made
    file.cleanup()
    assert not made.exists()
    assert LocalSubstitution("event.text").describe() == "LocalVar('event.text')"
