"""Names and parameters of nodes, as launch files of others use them."""

from launch.absent import absent
from launch_ros.names import make_namespace_absolute, prefix_namespace
from launch_ros.parameters import evaluate_parameter_dict, evaluate_parameters

__getattr__ = absent(
    __name__,
    {
        "add_node_name",
        "get_node_name_count",
        "is_namespace_absolute",
        "is_root_namespace",
        "normalize_parameter_dict",
        "normalize_parameters",
        "normalize_remap_rule",
        "normalize_remap_rules",
        "to_parameters_list",
    },
)

__all__ = ["evaluate_parameter_dict", "evaluate_parameters", "make_namespace_absolute", "prefix_namespace"]
