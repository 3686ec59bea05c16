"""Widgets that show and drive a session's nodes in a notebook."""

from ros2lab.widgets.command_panel import CommandPanel
from ros2lab.widgets.dashboard import Dashboard
from ros2lab.widgets.graph_view import GraphView
from ros2lab.widgets.message_form import MessageForm
from ros2lab.widgets.node_log import NodeLog
from ros2lab.widgets.robot_view import RobotView
from ros2lab.widgets.teleop import Teleop
from ros2lab.widgets.topic_monitor import TopicMonitor
from ros2lab.widgets.twist_plot import TwistPlot, twist_figure
from ros2lab.widgets.view_group import SideBySide

__all__ = [
    "CommandPanel",
    "Dashboard",
    "GraphView",
    "MessageForm",
    "NodeLog",
    "RobotView",
    "SideBySide",
    "Teleop",
    "TopicMonitor",
    "TwistPlot",
    "twist_figure",
]
