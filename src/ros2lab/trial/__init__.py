"""Run a workspace's nodes for seconds, as the grader does, and say what is silent, or not as it is meant."""

from ros2lab.trial.run import MOST_PROGRAMS, Trial, try_out

__all__ = ["MOST_PROGRAMS", "Trial", "try_out"]
