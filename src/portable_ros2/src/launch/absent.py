"""What the real launch has and this one has not is answered with one sentence."""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import NoReturn


def absent(module: str, names: Collection[str]) -> Callable[[str], NoReturn]:
    """Return a module's `__getattr__` that says which names only the real package has."""

    def getattr_of_module(name: str) -> NoReturn:
        if name in names:
            package = module.partition(".")[0]
            raise ImportError(
                f"{module}.{name} is not in this small {package}: it needs the real package {package}, "
                f"which an installed ROS 2 brings (apt install ros-jazzy-{package.replace('_', '-')})."
            )
        raise AttributeError(f"module '{module}' has no attribute '{name}'")

    return getattr_of_module
