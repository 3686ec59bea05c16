"""Start one thing after another, then shut down."""

from launch import LaunchDescription
from launch.actions import EmitEvent, ExecuteProcess, LogInfo, RegisterEventHandler
from launch.event_handlers import OnProcessExit, OnProcessStart, OnShutdown
from launch.events import Shutdown

FIRST = ExecuteProcess(cmd=["echo", "first"], output="screen")
SECOND = ExecuteProcess(cmd=["echo", "second"], output="screen")


def generate_launch_description() -> LaunchDescription:
    """Start one thing after another, then shut down."""
    return LaunchDescription(
        [
            FIRST,
            RegisterEventHandler(
                OnProcessStart(target_action=FIRST, on_start=[LogInfo(msg="the first has started")])
            ),
            RegisterEventHandler(
                OnProcessExit(target_action=FIRST, on_exit=[LogInfo(msg="the first has ended"), SECOND])
            ),
            RegisterEventHandler(
                OnProcessExit(
                    target_action=SECOND, on_exit=[EmitEvent(event=Shutdown(reason="it is enough"))]
                )
            ),
            RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg="going down")])),
        ]
    )
