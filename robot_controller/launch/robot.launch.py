"""Start the three nodes of the robot: `ros2 launch robot_controller robot.launch.py`.

The topics have relative names, so `namespace:=anna` moves all of them: `/anna/cmd_vel` and so on.
A period given here beats the one in the configuration file.
"""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

PACKAGE = "robot_controller"


def generate_launch_description() -> LaunchDescription:
    """Return the launch arguments and the three nodes."""
    default_config = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "robot.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "config", default_value=default_config, description="Parameter file (YAML)"
            ),
            DeclareLaunchArgument(
                "namespace",
                default_value="",
                description="Namespace of nodes and topics",
            ),
            DeclareLaunchArgument(
                "status_period",
                default_value="",
                description="Seconds between two status messages",
            ),
            DeclareLaunchArgument(
                "velocity_period",
                default_value="",
                description="Seconds between two velocity messages",
            ),
            OpaqueFunction(function=_nodes),
        ]
    )


def _nodes(context: LaunchContext) -> list[Node]:
    return [
        _node("command_subscriber"),
        _node("status_publisher", *_given(context, "status_period")),
        _node("velocity_publisher", *_given(context, "velocity_period")),
    ]


def _given(context: LaunchContext, argument: str) -> list[dict[str, float]]:
    text = LaunchConfiguration(argument).perform(context)
    if not text:
        return []
    try:
        return [{"period": float(text)}]
    except ValueError:
        raise ValueError(f"{argument}:={text} is not a number of seconds, such as 0.5") from None


def _node(name: str, *parameters: dict[str, float]) -> Node:
    return Node(
        package=PACKAGE,
        executable=name,
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("config"), *parameters],
        output="screen",
    )
