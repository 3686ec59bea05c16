"""Give a node parameters as dict, file and substitution."""

from launch import LaunchDescription
from launch.substitutions import PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Give a node parameters as dict, file and substitution."""
    return LaunchDescription(
        [
            Node(
                package="parts",
                executable="shows",
                output="screen",
                parameters=[
                    PathJoinSubstitution([FindPackageShare("parts"), "config", "values.yaml"]),
                    {
                        "number": 7,
                        "text": "given",
                        "rate": 0.5,
                        "is_on": True,
                        "many": [1, 2],
                        "words": ["a", "b"],
                        "inner": {"deep": 1.5},
                        "computed": PythonExpression("3 * 4"),
                    },
                ],
            ),
        ]
    )
