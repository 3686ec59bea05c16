"""The tags and attributes of launch files in XML and YAML."""

from __future__ import annotations

import yaml

from ros2lab.diagnose.sources.slips import Slip, Vocabulary
from ros2lab.diagnose.sources.xml_slips import xml_repair
from ros2lab.diagnose.sources.yaml_slips import yaml_repair

_ANY = ("if", "unless")
_PAIR = ("name", "value")
_PROCESS = (
    "name",
    "output",
    "respawn",
    "respawn_delay",
    "env",
    "cwd",
    "launch-prefix",
    "sigterm_timeout",
    *_ANY,
)
_NODE = ("pkg", "exec", "namespace", "args", "ros_args", "param", "remap", "on_exit", *_PROCESS)
_ACTIONS = {  # the usual ones first
    "node": _NODE,
    "arg": (*_PAIR, "default", "description", "choice"),
    "include": ("file", "arg", "let"),
    "append_env": (*_PAIR, "prepend"),
    "executable": ("cmd", "shell", *_PROCESS),
    "let": _PAIR,
    "lifecycle_node": (*_NODE, "autostart"),
    "load_composable_node": ("target", "composable_node"),
    "log": ("message", "level"),
    "node_container": (*_NODE, "composable_node"),
    "push_ros_namespace": ("namespace",),
    "reset": ("keep",),
    "set_env": _PAIR,
    "set_parameter": _PAIR,
    "set_parameters_from_file": ("filename",),
    "set_remap": ("from", "to"),
    "set_use_sim_time": ("value",),
    "shutdown": ("reason",),
    "unset_env": ("name",),
}
_BELOW = {
    "choice": ("value",),
    "composable_node": ("pkg", "plugin", "name", "namespace", "param", "remap", "extra_arg"),
    "env": _PAIR,
    "extra_arg": _PAIR,
    "keep": _PAIR,
    "param": (*_PAIR, "from", "sep", "type", "param", "allow_substs"),
    "remap": ("from", "to"),
}
_NAMES = (*_ACTIONS, "group", "timer", "push-ros-namespace", "reset_env")
_ENTITIES = Vocabulary(
    _NAMES,
    {
        "": ("launch",),
        "launch": (*_NAMES, "version"),
        "group": (*_NAMES, "keep", "scoped", "forwarding", *_ANY),
        "timer": (*_NAMES, "period", "cancel_on_shutdown", *_ANY),
        **{action: (*words, *_ANY) for action, words in _ACTIONS.items()},
        **_BELOW,
    },
)


def entity_repair(text: str, *, is_xml: bool) -> Slip | None:
    """Return the likeliest slip of typing that keeps launch from reading a file; None if none is found."""
    return xml_repair(text, _ENTITIES) if is_xml else yaml_repair(text, _ENTITIES, _check)


def words_below(name: str) -> list[str]:
    """Return the attributes of the items of an attribute that is a list, such as `name` and `value` of `param`."""
    return [*_BELOW.get(name, _PAIR)]


def _check(node: yaml.Node) -> None:
    keys = [key.value for key, _ in node.value] if isinstance(node, yaml.MappingNode) else []
    if "launch" not in keys:
        raise yaml.MarkedYAMLError(problem="its root element is not launch", problem_mark=node.start_mark)
