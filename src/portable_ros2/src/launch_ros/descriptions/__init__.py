"""Parameters of nodes, where the real package also has them."""

from launch.absent import absent
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue

__getattr__ = absent(__name__, {"ComposableNode"})

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]
