"""`ros2 launch` as a submission's launch file is started: it also says when a timer begins that will shut everything down."""

from __future__ import annotations

import sys

from ros2lab.grading.evidence import TIMED

_LAUNCH = f"""
import contextlib, runpy, shutil, sys
from launch.actions import RegisterEventHandler, TimerAction
from launch.events import Shutdown

def ends(entity, context):
    condition = getattr(entity, "condition", None)
    if isinstance(entity, RegisterEventHandler) or (condition and not condition.evaluate(context)):
        return False
    inner = [entity.describe_sub_entities(), *(few for _, few in entity.describe_conditional_sub_entities())]
    below = any(ends(one, context) for several in inner for one in several)
    return below or isinstance(getattr(entity, "event", None), Shutdown)

def begin(timer, context, execute=TimerAction.execute):
    with contextlib.suppress(Exception):
        if ends(timer, context):
            print({TIMED!r}, flush=True)
    return execute(timer, context)

TimerAction.execute = begin
sys.argv[0] = shutil.which("ros2")
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def command(words: list[str]) -> list[str]:
    """Return the command that launches a file, by the words that follow `ros2 launch`."""
    return [sys.executable, "-P", "-c", _LAUNCH, "launch", *words]
