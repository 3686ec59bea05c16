"""Give a node parameters whose type is said."""

from launch import LaunchDescription
from launch.substitutions import TextSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Give a node parameters whose type is said."""
    return LaunchDescription(
        [
            Node(
                package="parts",
                executable="shows",
                output="screen",
                parameters=[
                    ParameterFile([FindPackageShare("parts"), "/config/values.yaml"], allow_substs=True),
                    {
                        "text": ParameterValue(TextSubstitution(text="5"), value_type=str),
                        "number": ParameterValue("6", value_type=int),
                    },
                ],
            ),
        ]
    )
