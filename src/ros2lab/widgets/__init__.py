"""Widgets that show and drive a session's nodes in a notebook."""

from ros2lab.widgets.command_panel import CommandPanel
from ros2lab.widgets.dashboard import Dashboard
from ros2lab.widgets.node_log import NodeLog
from ros2lab.widgets.side_by_side import SideBySide
from ros2lab.widgets.twist_plot import TwistPlot, twist_figure

__all__ = ["CommandPanel", "Dashboard", "NodeLog", "SideBySide", "TwistPlot", "twist_figure"]
