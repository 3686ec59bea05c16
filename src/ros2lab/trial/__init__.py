"""Run a workspace's nodes for seconds, as the grader does, and report what does not work as intended."""

from ros2lab.trial.run import Trial, try_out

__all__ = ["Trial", "try_out"]
