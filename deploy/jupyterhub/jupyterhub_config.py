"""A class on one server; README.md beside this file says how. What is yours stands in OWN, and holds against this."""

from pathlib import Path

from ros2lab.class_spawner import socket_address

c = get_config()  # noqa: F821 -- JupyterHub has it here
HERE, OWN = Path(__file__).parent, Path("/etc/ros2lab-hub.py")

# Where the class enters.
c.JupyterHub.bind_url = "http://:8000"

# What one student may use at the most. Instructors' servers have no limits.
c.Spawner.cpu_limit = 1.0  # cores
c.Spawner.mem_limit = "1.5G"
c.Spawner.start_timeout = c.Spawner.http_timeout = (
    300  # s; a whole class enters at once, and each waits for all
)

# Who may enter: accounts of this machine, with their passwords.
c.JupyterHub.authenticator_class = "pam"
c.PAMAuthenticator.allowed_groups = {"students", "instructors"}
c.PAMAuthenticator.admin_groups = {"instructors"}
c.PAMAuthenticator.open_sessions = False

# The rest: each student's server in a network of its own, which is why all speak by sockets that are files.
c.JupyterHub.spawner_class = "ros2lab.class_spawner.ClassSpawner"
c.JupyterHub.hub_bind_url = socket_address("/run/ros2lab-hub/hub.sock")
c.JupyterHub.hub_connect_url = socket_address("/run/ros2lab-hub/hub.sock")
c.JupyterHub.hub_socket_mode = 0o666  # whoever connects needs a token
c.JupyterHub.cleanup_servers = False  # the class goes on while the hub starts again
c.ConfigurableHTTPProxy.api_url = socket_address("/var/lib/ros2lab-hub/proxy.sock")
c.ConfigurableHTTPProxy.command = [str(HERE / "node_modules/.bin/configurable-http-proxy")]

if OWN.exists():
    load_subconfig(str(OWN))  # noqa: F821 -- as above
