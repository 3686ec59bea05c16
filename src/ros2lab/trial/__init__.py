"""Run a workspace's nodes for seconds, as the grader does, and report what does not work as intended."""

from ros2lab.trial.run import MOST_PROGRAMS, Trial, try_out

__all__ = ["MOST_PROGRAMS", "Trial", "try_out"]
