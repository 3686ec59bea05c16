"""Parameters, remappings and names of nodes, in the forms in which they may be given."""

from __future__ import annotations

from launch.lookup import lookup
from launch_ros.names import (
    add_node_name,
    get_node_name_count,
    is_namespace_absolute,
    is_root_namespace,
    make_namespace_absolute,
    normalize_remap_rule,
    normalize_remap_rules,
    prefix_namespace,
)
from launch_ros.parameters import (
    evaluate_parameter_dict,
    evaluate_parameters,
    normalize_parameter_dict,
    normalize_parameters,
)

__getattr__ = lookup(
    __name__,
    absent={
        "LifecycleEventManager",
        "PluginException",
        "get_upper_bound_caret_version",
        "satisfies_version",
        "to_parameters_list",
    },
)

__all__ = [
    "add_node_name",
    "evaluate_parameter_dict",
    "evaluate_parameters",
    "get_node_name_count",
    "is_namespace_absolute",
    "is_root_namespace",
    "make_namespace_absolute",
    "normalize_parameter_dict",
    "normalize_parameters",
    "normalize_remap_rule",
    "normalize_remap_rules",
    "prefix_namespace",
]
