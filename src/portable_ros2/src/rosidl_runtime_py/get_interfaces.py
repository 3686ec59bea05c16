"""Which interfaces are installed."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from portable_ros2 import interfaces


def get_interfaces(
    package_names: Iterable[str] = (), kinds: tuple[str, ...] = tuple(interfaces.KINDS)
) -> dict[str, list[str]]:
    """Return the interfaces of some packages, or of all, by package; LookupError if there is no such package."""
    found = {name: interfaces.of_package(name, kinds) for name in package_names or interfaces.packages()}
    return {name: names for name, names in found.items() if names}


get_message_interfaces = partial(get_interfaces, kinds=("msg",))
get_service_interfaces = partial(get_interfaces, kinds=("srv",))
get_action_interfaces = partial(get_interfaces, kinds=("action",))


def get_interface_packages() -> dict[str, str]:
    """Return the packages that have interfaces; the real one gives each its prefix, too."""
    return dict.fromkeys(interfaces.packages(), "")


def get_interface_path(interface_name: str) -> str:
    """Return the file that defines an interface; LookupError if there is none."""
    return str(interfaces.definition_file(interface_name))
