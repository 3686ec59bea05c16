"""ROS nodes in launch files, where no ROS 2 is installed: a small launch_ros for the small launch beside it.

Only what courses use is here; the rest names the real package.
"""
