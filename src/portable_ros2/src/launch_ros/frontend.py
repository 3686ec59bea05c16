"""The tags and substitutions that launch_ros adds to XML and YAML launch files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.frontend.entity import Entity
from launch.frontend.expose import expose_action
from launch.frontend.parse_substitution import expose
from launch.frontend.tags import (
    command_line,
    condition,
    name_and_value,
    pairs,
    process_arguments,
    tag,
    text,
    texts,
)
from launch.frontend.type_utils import get_data_type_from_identifier
from launch.substitution import Substitution
from launch_ros import actions
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import ExecutableInPackage, FindPackagePrefix, FindPackageShare, Parameter

if TYPE_CHECKING:
    from launch.frontend import Parser


@tag(actions.Node, "node")
def _node(entity: Entity, parser: Parser) -> dict[str, Any]:
    arguments: dict[str, Any] = process_arguments(entity, parser)
    for name, attribute in {"arguments": "args", "ros_arguments": "ros_args"}.items():
        line = entity.get_attr(attribute, optional=True)
        if line is not None:
            arguments[name] = command_line(line, parser)
    return {
        "executable": text(entity, parser, "exec"),
        "remappings": pairs(entity, parser, "remap", "from", "to"),
        "parameters": _parameters(entity, parser),
        **texts(entity, parser, package="pkg", name="name", namespace="namespace", exec_name="exec_name"),
        **arguments,
    }


@tag(actions.LifecycleNode, "lifecycle_node")
def _lifecycle_node(entity: Entity, parser: Parser) -> dict[str, Any]:
    autostart = entity.get_attr("autostart", data_type=bool, optional=True)
    return {**_node(entity, parser), "autostart": parser.parse_if_substitutions(autostart or False)}


def _parameters(entity: Entity, parser: Parser) -> list[Any]:
    found = entity.get_attr("param", data_type=list[Entity], optional=True) or []
    return [_parameter(parameter, parser) for parameter in found]


def _parameter(entity: Entity, parser: Parser) -> Any:
    """Return a file or a dictionary."""
    path = entity.get_attr("from", optional=True)
    name = entity.get_attr("name", optional=True)
    if path is not None and name is not None:
        raise RuntimeError("name and from attributes are mutually exclusive")
    if path is None and name is None:
        raise ValueError("param Entity should have name or from attribute")
    substitutes = entity.get_attr("allow_substs", data_type=bool, optional=True)
    if path is None:
        if substitutes is not None:
            raise RuntimeError("'allow_substs' can only be used together with 'from' attribute")
        return _named(entity, parser)
    entity.assert_entity_completely_parsed()
    return ParameterFile(
        parser.parse_substitution(path), allow_substs=parser.parse_if_substitutions(substitutes or False)
    )


def _named(entity: Entity, parser: Parser) -> dict[Any, Any]:
    """Return a name with a value, or with the parameters in it."""
    name = tuple(text(entity, parser, "name"))
    kind = entity.get_attr("type", optional=True)
    data_type = None if kind is None else get_data_type_from_identifier(kind)
    value = entity.get_attr("value", data_type=data_type, optional=True)
    inner = entity.get_attr("param", data_type=list[Entity], optional=True)
    entity.assert_entity_completely_parsed()
    if inner and (value is not None or data_type is not None):
        what = "value" if value is not None else "type"
        raise RuntimeError(f"nested parameters and {what} attributes are mutually exclusive")
    if value is not None:
        return {name: ParameterValue(parser.parse_if_substitutions(value), value_type=data_type)}
    if not inner:
        raise RuntimeError("either a value attribute or nested params are needed")
    nested: dict[Any, Any] = {}
    for parameter in inner:
        nested.update(_named(parameter, parser))
    return {name: nested}


@tag(actions.PushROSNamespace, "push_ros_namespace", "push-ros-namespace")
def _push_ros_namespace(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"namespace": text(entity, parser, "namespace"), **condition(entity, parser)}


tag(actions.SetParameter, "set_parameter")(name_and_value)


@tag(actions.SetParametersFromFile, "set_parameters_from_file")
def _set_parameters_from_file(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"filename": text(entity, parser, "filename"), **condition(entity, parser)}


@tag(actions.SetUseSimTime, "set_use_sim_time")
def _set_use_sim_time(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"value": text(entity, parser, "value"), **condition(entity, parser)}


@tag(actions.SetRemap, "set_remap")
def _set_remap(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {
        "src": text(entity, parser, "from"),
        "dst": text(entity, parser, "to"),
        **condition(entity, parser),
    }


@tag(actions.SetROSLogDir, "set_ros_log_dir")
def _set_ros_log_dir(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {"new_log_dir": text(entity, parser, "new_log_dir"), **condition(entity, parser)}


@tag(actions.ComposableNodeContainer, "node_container")
def _node_container(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {**_node(entity, parser), "composable_node_descriptions": _composable_nodes(entity, parser)}


@tag(actions.LoadComposableNodes, "load_composable_node")
def _load_composable_node(entity: Entity, parser: Parser) -> dict[str, Any]:
    return {
        "target_container": text(entity, parser, "target"),
        "composable_node_descriptions": _composable_nodes(entity, parser),
        **condition(entity, parser),
    }


expose_action("ros_timer")(actions.ROSTimer)


def _composable_nodes(entity: Entity, parser: Parser) -> list[ComposableNode]:
    nodes = []
    for inner in entity.get_attr("composable_node", data_type=list[Entity], optional=True) or []:
        arguments: dict[str, Any] = {
            **texts(inner, parser, name="name", namespace="namespace"),
            **condition(inner, parser),
        }
        extra = pairs(inner, parser, "extra_arg", "name", "value")
        nodes.append(
            ComposableNode(
                package=text(inner, parser, "pkg"),
                plugin=text(inner, parser, "plugin"),
                remappings=pairs(inner, parser, "remap", "from", "to"),
                parameters=_parameters(inner, parser),
                extra_arguments=[{name: value} for name, value in extra],
                **arguments,
            )
        )
        inner.assert_entity_completely_parsed()
    return nodes


def _parameter_value(name: list[Substitution], default: list[Substitution] | None = None) -> Substitution:
    return Parameter(name, default=default)


expose("exec-in-pkg", ExecutableInPackage, 2, 2)
expose("find-pkg-prefix", FindPackagePrefix, 1, 1)
expose("find-pkg-share", FindPackageShare, 1, 1)
expose("param", _parameter_value, 1, 2)
