"""The tags and substitutions that launch_ros adds to XML and YAML launch files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

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
from launch_ros import actions
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import ExecutableInPackage, FindPackagePrefix, FindPackageShare

if TYPE_CHECKING:
    from launch.frontend import Parser

expose("exec-in-pkg", ExecutableInPackage, 2, 2)
expose("find-pkg-prefix", FindPackagePrefix, 1, 1)
expose("find-pkg-share", FindPackageShare, 1, 1)


@tag(actions.Node, "node")
def _node(entity: Entity, parser: Parser) -> dict[str, Any]:
    arguments: dict[str, Any] = process_arguments(entity, parser)
    for name, attribute in {"arguments": "args", "ros_arguments": "ros_args"}.items():
        line = entity.get_attr(attribute, optional=True)
        if line is not None:
            arguments[name] = command_line(line, parser)
    parameters = entity.get_attr("param", data_type=list[Entity], optional=True) or []
    return {
        "executable": text(entity, parser, "exec"),
        "remappings": pairs(entity, parser, "remap", "from", "to"),
        "parameters": [_parameter(parameter, parser) for parameter in parameters],
        **texts(entity, parser, package="pkg", name="name", namespace="namespace", exec_name="exec_name"),
        **arguments,
    }


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


@expose_action("node_container")
@expose_action("load_composable_node")
@expose_action("ros_timer")
def _absent(entity: Entity, _: Parser) -> NoReturn:
    raise RuntimeError(
        f"The tag '{entity.type_name}' is not in this small launch_ros: it needs the real package launch_ros, "
        "which an installed ROS 2 brings (apt install ros-jazzy-launch-ros)."
    )
