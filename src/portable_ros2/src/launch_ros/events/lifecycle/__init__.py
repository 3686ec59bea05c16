"""Here are none: there are no lifecycle nodes."""

from launch.absent import absent

__getattr__ = absent(__name__, {"ChangeState", "StateTransition", "matches_node_name"})
