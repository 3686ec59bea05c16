"""A student's server of a JupyterHub on one machine: a unit of systemd that no neighbour can hear or stop.

The unit has a network of its own with nothing but a loopback, so that whatever domain a student chooses, no node
meets a neighbour's; and a /dev/shm of its own, by which nodes of one machine meet as well. The hub's proxy reaches
the server on a socket in a folder that only the student and root can enter, and the server reaches the hub on the
hub's own socket.
"""

from __future__ import annotations

import grp
import os
import pwd
import sys
from pathlib import Path
from typing import Any
from urllib.parse import quote

from systemdspawner import SystemdSpawner
from traitlets import Unicode, default

# More of systemd's properties that each student's unit has; what a configuration sets beside them is added.
PROPERTIES = {
    "PrivateNetwork": "yes",  # ports, multicast, and sockets without a file
    "TemporaryFileSystem": "/dev/shm:mode=1777",  # noqa: S108 -- its bytes count as memory of the unit
    "PrivateTmp": "yes",
    "ProtectProc": "invisible",
    "MemorySwapMax": "0",
    "TasksMax": "1000",
}


class ClassSpawner(SystemdSpawner):
    """Starts `ros2lab lab` for each student, and lets instructors read in the students' homes.

    An instructor is an admin of the hub: that server has no limits.
    """

    instructors = Unicode(
        "instructors", help="The group of the system that may read in the students' homes."
    ).tag(config=True)

    @default("cmd")
    def _default_cmd(self) -> list[str]:
        return [str(Path(sys.executable).with_name("ros2lab")), "lab", "--no-browser"]

    @default("slice")
    def _default_slice(self) -> str:
        return "ros2lab.slice"  # all students together weigh as much as all else, of which the hub is

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.unit_extra_properties: dict[str, Any] = {**PROPERTIES, **self.unit_extra_properties}

    @property
    def address(self) -> str:
        """Where the student's server listens."""
        return socket_address(f"/run/{self.unit_name}/server.sock")

    def get_env(self) -> dict[str, str]:
        """Return the environment of the server."""
        env: dict[str, str] = super().get_env()
        return {**env, "JUPYTERHUB_SERVICE_URL": self.address + self.server.base_url}

    async def start(self) -> str:
        """Start the server, and return its address."""
        self.open_home()
        if self.user.admin:
            self.mem_limit = self.cpu_limit = None
        self._connect()
        await super().start()
        return self.address

    def load_state(self, state: dict[str, Any]) -> None:
        """Find the server again that was started before the hub started anew."""
        super().load_state(state)
        self._connect()

    def open_home(self) -> None:
        """Let the student, the instructors and nobody else into the student's home."""
        account = pwd.getpwnam(self._expand_user_vars(self.username_template))
        os.chown(account.pw_dir, account.pw_uid, grp.getgrnam(self.instructors).gr_gid)
        os.chmod(account.pw_dir, 0o750)  # noqa: S103, PTH101

    def _connect(self) -> None:
        """Say how the hub and its proxy connect; JupyterHub 6.1 would else add a port, which a socket does not have."""
        if self.server:
            self.server.connect_url = self.address


def socket_address(path: str) -> str:
    """Return the address of a socket of this machine, as JupyterHub writes it."""
    return f"http+unix://{quote(path, safe='')}"
