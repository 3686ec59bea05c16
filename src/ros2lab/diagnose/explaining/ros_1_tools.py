"""The commands of ROS 1 that ROS 2 has under other names."""

from __future__ import annotations

ROS_1_TOOLS = {
    **{
        f"ros{verb}": f"ros2 {verb}"
        for verb in ("run", "launch", "topic", "node", "param", "service", "bag", "pkg")
    },
    **{"rosmsg": "ros2 interface", "rossrv": "ros2 interface", "roscore": "nothing (ROS 2 needs no master)"},
    **{"catkin_make": "colcon build", "roscd": "cd", "catkin": "colcon"},
}
