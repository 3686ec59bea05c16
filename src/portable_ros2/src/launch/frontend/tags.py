"""The tags of a launch file: how the attributes of each become the arguments of its action."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from launch import actions
from launch.action import Action
from launch.conditions import IfCondition, UnlessCondition
from launch.frontend.entity import Entity
from launch.frontend.expose import expose_action
from launch.substitution import Substitution
from launch.substitutions import TextSubstitution

if TYPE_CHECKING:
    from launch.frontend.parser import Parser

Reader = Callable[[Entity, "Parser"], dict[str, Any]]


def tag(action: type[Action], *names: str) -> Callable[[Reader], Reader]:
    """Return a decorator: the function reads what an action, and each class derived from it, is made with."""

    def register(function: Reader) -> Reader:
        action._keywords = staticmethod(function)
        for name in names:
            expose_action(name)(action)
        return function

    return register


@tag(actions.ResetEnvironment, "reset_env")
@tag(Action)
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


@tag(actions.ExecuteProcess, "executable")
def _executable(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {
        "cmd": command_line(entity.get_attr("cmd"), parser),
        **texts(entity, parser, name="name"),
        **process_arguments(entity, parser),
    }


@tag(actions.DeclareLaunchArgument, "arg")
def _arg(entity: Entity, parser: Parser) -> dict[str, Any]:
    arguments: dict[str, Any] = {
        "name": parser.escape_characters(entity.get_attr("name")),
        **texts(entity, parser, default_value="default"),
        **condition(entity, parser),
    }
    description = entity.get_attr("description", optional=True)
    if description is not None:
        arguments["description"] = parser.escape_characters(description)
    choices = entity.get_attr("choice", data_type=list[Entity], optional=True)
    if choices is not None:
        arguments["choices"] = [parser.escape_characters(choice.get_attr("value")) for choice in choices]
    return arguments


@tag(actions.SetLaunchConfiguration, "let")
@tag(actions.SetEnvironmentVariable, "set_env")
def name_and_value(entity: Entity, parser: Parser) -> dict[str, Any]:
    """Return the arguments of an action that gives a value to a name."""
    return {
        "name": text(entity, parser, "name"),
        "value": text(entity, parser, "value"),
        **condition(entity, parser),
    }


@tag(actions.UnsetEnvironmentVariable, "unset_env")
def _name(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"name": text(entity, parser, "name"), **condition(entity, parser)}


@tag(actions.AppendEnvironmentVariable, "append_env")
def _append_env(entity: Entity, parser: Parser) -> dict[str, Any]:
    prepend = entity.get_attr("prepend", data_type=bool, optional=True)
    return {
        **name_and_value(entity, parser),
        "prepend": False if prepend is None else parser.parse_if_substitutions(prepend),
        **texts(entity, parser, separator="separator"),
    }


@tag(actions.ResetLaunchConfigurations, "reset")
def _reset(entity: Entity, parser: Parser) -> dict[str, Any]:
    kept = dict(pairs(entity, parser, "keep", "name", "value"))
    return {"launch_configurations": kept, **condition(entity, parser)}


@tag(actions.LogInfo, "log")
def _log(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"msg": text(entity, parser, "message"), **condition(entity, parser)}


@tag(actions.Shutdown, "shutdown")
def _shutdown(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {**texts(entity, parser, reason="reason"), **condition(entity, parser)}


@tag(actions.TimerAction, "timer")
def _timer(entity: Entity, parser: Parser) -> dict[str, Any]:
    cancel = entity.get_attr("cancel_on_shutdown", data_type=bool, optional=True)
    return {
        "period": parser.parse_if_substitutions(entity.get_attr("period", data_type=float)),
        "actions": [parser.parse_action(child) for child in entity.children],
        "cancel_on_shutdown": True if cancel is None else parser.parse_if_substitutions(cancel),
        **condition(entity, parser),
    }


@tag(actions.GroupAction, "group")
def _group(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {
        "launch_configurations": dict(pairs(entity, parser, "keep", "name", "value")),
        "actions": [parser.parse_action(child) for child in entity.children if child.type_name != "keep"],
        **values(entity, scoped=bool, forwarding=bool),
        **condition(entity, parser),
    }


@tag(actions.IncludeLaunchDescription, "include")
def _include(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {
        "launch_description_source": text(entity, parser, "file"),
        "launch_arguments": [
            pair for name in ("arg", "let") for pair in pairs(entity, parser, name, "name", "value")
        ],
        **condition(entity, parser),
    }
