"""Look at what a process writes."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess, LogInfo, RegisterEventHandler
from launch.event_handlers import OnProcessIO
from launch.events.process import ProcessIO

TALKS = ExecuteProcess(cmd=["echo", "something"])


def _heard(event: ProcessIO) -> list[LogInfo]:
    return [LogInfo(msg=f"heard {event.text.decode().strip()} of {event.process_name}")]


def generate_launch_description() -> LaunchDescription:
    """Look at what a process writes."""
    return LaunchDescription(
        [
            TALKS,
            RegisterEventHandler(OnProcessIO(target_action=TALKS, on_stdout=_heard)),
        ]
    )
