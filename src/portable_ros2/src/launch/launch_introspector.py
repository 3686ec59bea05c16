"""A launch description as a text for people."""

from __future__ import annotations

from collections.abc import Iterable

from launch.actions import EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler
from launch.launch_description import LaunchDescription
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.utilities import normalize_to_list_of_substitutions


class LaunchIntrospector:
    """Describes a launch description."""

    def format_launch_description(self, launch_description: LaunchDescription) -> str:
        """Return a tree of its entities."""
        return "\n".join([str(launch_description), *_tree(launch_description.entities)])


def _tree(entities: Iterable[LaunchDescriptionEntity]) -> list[str]:
    lines = []
    listed = list(entities)
    for number, entity in enumerate(listed, start=1):
        is_last = number == len(listed)
        lines.append(("└── " if is_last else "├── ") + _text(entity))
        if isinstance(entity, RegisterEventHandler):
            text, inner = entity.event_handler.describe()
            indent = "    " if is_last else "│   "
            lines += [f"{indent}└── {text}", *(f"{indent}    {line}" for line in _tree(inner))]
    return lines


def _text(entity: LaunchDescriptionEntity) -> str:
    if isinstance(entity, LogInfo):
        return f"LogInfo({_described(entity.msg)})"
    if isinstance(entity, EmitEvent):
        return f"EmitEvent(event='{entity.event.name}')"
    if isinstance(entity, RegisterEventHandler):
        return f"RegisterEventHandler('{entity.event_handler}'):"
    if isinstance(entity, ExecuteProcess):
        program = entity.process_description
        cmd = ", ".join(_described(part) for part in entity.cmd)
        cwd = None if program.cwd is None else f"'{_described(program.cwd)}'"
        env = None
        if program.env is not None:
            env = "{" + ", ".join(f"{_described(k)}: {_described(v)}" for k, v in program.env) + "}"
        return f"ExecuteProcess(cmd=[{cmd}], cwd={cwd}, env={env}, shell={entity.shell})"
    return f"Action('{entity}')"


def _described(substitutions: SomeSubstitutionsType) -> str:
    return " + ".join(sub.describe() for sub in normalize_to_list_of_substitutions(substitutions))
