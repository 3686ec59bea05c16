"""The `ros2` command and launch files where no ROS 2 is installed, only the pip wheels of rclpy.

Where the real ones are, it steps aside: see `portable_ros2.stepping_aside`.
"""

__version__ = "0.1.0"
