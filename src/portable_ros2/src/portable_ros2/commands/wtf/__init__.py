"""`ros2 wtf`: another name for `ros2 doctor`."""

from __future__ import annotations

from portable_ros2.commands.doctor import DoctorCommand


class WtfCommand(DoctorCommand):
    """Use `wtf` as alias to `doctor`."""
