"""The tags of a launch file, each with the function that makes its action."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from typing import Any

from launch import actions
from launch.conditions import IfCondition, UnlessCondition
from launch.frontend import Entity, Parser
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

Maker = Callable[[Entity, Parser], LaunchDescriptionEntity]
# launch_ros adds its own.
TAGS: dict[str, Maker] = {}


def tag(*names: str) -> Callable[[Maker], Maker]:
    """Return a decorator: the function makes the action of a tag."""

    def register(function: Maker) -> Maker:
        TAGS.update(dict.fromkeys(names, function))
        return function

    return register


def condition(entity: Entity, parser: Parser) -> dict[str, Any]:
    """Return the condition of a tag, as the argument of an action."""
    if_text, unless_text = entity.get_attr("if", optional=True), entity.get_attr("unless", optional=True)
    if if_text is not None and unless_text is not None:
        raise RuntimeError("if and unless conditions can't be used simultaneously")
    if if_text is not None:
        return {"condition": IfCondition(parser.parse_substitution(if_text))}
    if unless_text is not None:
        return {"condition": UnlessCondition(parser.parse_substitution(unless_text))}
    return {}


def text(entity: Entity, parser: Parser, name: str) -> list[Substitution]:
    """Return the substitutions in an attribute that must be there."""
    return parser.parse_substitution(entity.get_attr(name))


def texts(entity: Entity, parser: Parser, **names: str) -> dict[str, list[Substitution]]:
    """Return those attributes of a tag that are there, by the names of arguments of an action."""
    given = {argument: entity.get_attr(name, optional=True) for argument, name in names.items()}
    return {
        argument: parser.parse_substitution(value) for argument, value in given.items() if value is not None
    }


def pairs(entity: Entity, parser: Parser, name: str, key: str, value: str) -> list[tuple[Any, Any]]:
    """Return two attributes of each tag of a name."""
    found = []
    for inner in entity.get_attr(name, data_type=list[Entity], optional=True) or []:
        found.append((tuple(text(inner, parser, key)), text(inner, parser, value)))
        inner.assert_entity_completely_parsed()
    return found


def values(entity: Entity, **types: Any) -> dict[str, Any]:
    """Return those attributes of a tag that are there and are no texts."""
    given = {
        name: entity.get_attr(name, data_type=data_type, optional=True, can_be_str=False)
        for name, data_type in types.items()
    }
    return {name: value for name, value in given.items() if value is not None}


def command_line(line: str, parser: Parser) -> list[list[Substitution]]:
    """Return the words of a command line; a substitution never falls apart."""
    words: list[list[Substitution]] = [[]]
    for sub in parser.parse_substitution(line):
        if not isinstance(sub, TextSubstitution):
            words[-1].append(sub)
            continue
        parts = shlex.split(sub.text)
        if sub.text[:1].isspace() and words[-1]:
            words.append([])
        for number, part in enumerate(parts):
            if number > 0:
                words.append([])
            words[-1].append(TextSubstitution(text=part))
        if sub.text[-1:].isspace() and words[-1]:
            words.append([])
    return [word for word in words if word]


def process_arguments(entity: Entity, parser: Parser) -> dict[str, Any]:
    """Return the arguments that `executable` and `node` have in common."""
    arguments: dict[str, Any] = {
        **condition(entity, parser),
        **texts(entity, parser, cwd="cwd", prefix="launch-prefix", output="output", respawn="respawn"),
        **values(entity, respawn_max_retries=int, shell=bool, emulate_tty=bool),
    }
    seconds = values(entity, respawn_delay=float, sigterm_timeout=float, sigkill_timeout=float)
    for name, value in seconds.items():
        if value < 0:
            raise ValueError(
                f"Attribute {name} of Entity node expected to be a non-negative value but got `{value}`"
            )
        arguments[name] = value if name == "respawn_delay" else str(value)
    on_exit = entity.get_attr("on_exit", optional=True)
    if on_exit not in (None, "shutdown"):
        raise ValueError(f"Attribute on_exit of Entity node expected to be shutdown but got `{on_exit}`")
    if on_exit is not None:
        arguments["on_exit"] = [actions.Shutdown()]
    variables = pairs(entity, parser, "env", "name", "value")
    if variables:
        arguments["additional_env"] = dict(variables)
    return arguments


@tag("executable")
def _executable(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    arguments: dict[str, Any] = {**texts(entity, parser, name="name"), **process_arguments(entity, parser)}
    return actions.ExecuteProcess(cmd=command_line(entity.get_attr("cmd"), parser), **arguments)


@tag("arg")
def _arg(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    arguments: dict[str, Any] = {
        **condition(entity, parser),
        **texts(entity, parser, default_value="default"),
    }
    description = entity.get_attr("description", optional=True)
    if description is not None:
        arguments["description"] = parser.escape_characters(description)
    choices = entity.get_attr("choice", data_type=list[Entity], optional=True)
    if choices is not None:
        arguments["choices"] = [parser.escape_characters(choice.get_attr("value")) for choice in choices]
    return actions.DeclareLaunchArgument(parser.escape_characters(entity.get_attr("name")), **arguments)


@tag("let")
def _let(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    name, value = text(entity, parser, "name"), text(entity, parser, "value")
    return actions.SetLaunchConfiguration(name, value, **condition(entity, parser))


@tag("set_env")
def _set_env(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    name, value = text(entity, parser, "name"), text(entity, parser, "value")
    return actions.SetEnvironmentVariable(name, value, **condition(entity, parser))


@tag("unset_env")
def _unset_env(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    return actions.UnsetEnvironmentVariable(text(entity, parser, "name"), **condition(entity, parser))


@tag("append_env")
def _append_env(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    prepend = entity.get_attr("prepend", data_type=bool, optional=True)
    arguments: dict[str, Any] = {**texts(entity, parser, separator="separator"), **condition(entity, parser)}
    return actions.AppendEnvironmentVariable(
        text(entity, parser, "name"),
        text(entity, parser, "value"),
        prepend=False if prepend is None else parser.parse_if_substitutions(prepend),
        **arguments,
    )


@tag("reset_env")
def _reset_env(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    return actions.ResetEnvironment(**condition(entity, parser))


@tag("reset")
def _reset(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    kept = dict(pairs(entity, parser, "keep", "name", "value"))
    return actions.ResetLaunchConfigurations(kept, **condition(entity, parser))


@tag("log")
def _log(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    return actions.LogInfo(msg=text(entity, parser, "message"), **condition(entity, parser))


@tag("shutdown")
def _shutdown(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    arguments: dict[str, Any] = {**texts(entity, parser, reason="reason"), **condition(entity, parser)}
    return actions.Shutdown(**arguments)


@tag("timer")
def _timer(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    cancel = entity.get_attr("cancel_on_shutdown", data_type=bool, optional=True)
    return actions.TimerAction(
        period=parser.parse_if_substitutions(entity.get_attr("period", data_type=float)),
        actions=[parser.parse_action(child) for child in entity.children],
        cancel_on_shutdown=True if cancel is None else parser.parse_if_substitutions(cancel),
        **condition(entity, parser),
    )


@tag("group")
def _group(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    return actions.GroupAction(
        launch_configurations=dict(pairs(entity, parser, "keep", "name", "value")),
        actions=[parser.parse_action(child) for child in entity.children if child.type_name != "keep"],
        **values(entity, scoped=bool, forwarding=bool),
        **condition(entity, parser),
    )


@tag("include")
def _include(entity: Entity, parser: Parser) -> LaunchDescriptionEntity:
    return actions.IncludeLaunchDescription(
        text(entity, parser, "file"),
        launch_arguments=pairs(entity, parser, "arg", "name", "value"),
        **condition(entity, parser),
    )
