"""Here are none: there are no lifecycle nodes."""

from launch.lookup import lookup

__getattr__ = lookup(__name__, absent={"ChangeState", "StateTransition", "matches_node_name"})
