"""The real launch has a module of its own for each class: such a path leads to the module that has it here.

`launch.actions.execute_process` shows all that `launch.actions` has, `ExecuteProcess` among it.
"""

from __future__ import annotations

import functools
import re
import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from launch.lookup import ABSENT

PACKAGES = {"launch", "launch_ros", "launch_xml", "launch_yaml"}
# Modules that are not called as a class or function in them is.
OTHERS = {
    "launch.actions": {"shutdown_action"},
    "launch.events": {"matchers"},
    "launch.events.process": {"process_matchers", "process_targeted_event"},
    "launch.launch_description_sources": {
        "any_launch_file_utilities",
        "frontend_launch_file_utilities",
        "python_launch_file_utilities",
    },
    "launch.substitutions": {"boolean_substitution"},
    "launch.utilities": {"class_tools_impl", "signal_management", "typing_file_path"},
    "launch_ros.events": {"matchers"},
    "launch_ros.events.matchers": {"matches_node_name"},
    "launch_ros.events.lifecycle": {"lifecycle_node_matchers"},
    "launch_ros.utilities": {
        "evaluate_parameters",
        "namespace_utils",
        "normalize_parameters",
        "normalize_remap_rule",
        "plugin_support",
        "to_parameters_list",
        "track_node_names",
    },
}


# Not derived from importlib.abc, which takes longer to import than all else that `import launch` needs.
class _Paths:
    """A finder and loader of what no file has; asked last, it costs nothing where files are."""

    def find_spec(self, fullname: str, *_: Any) -> ModuleSpec | None:
        """Return what is to be loaded, if the package above has what the module is named for."""
        package, name = fullname.rpartition(".")[::2]
        if package.partition(".")[0] in PACKAGES and name in _modules_of(package):
            return ModuleSpec(fullname, self)  # type: ignore[arg-type]
        return None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return a module that shows what the package above has."""
        module = ModuleType(spec.name)
        above = sys.modules[spec.name.rpartition(".")[0]]
        module.__getattr__ = functools.partial(getattr, above)  # type: ignore[method-assign]
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: it is complete."""


def _modules_of(package: str) -> set[str]:
    """Return the names of the modules that the real package has for the classes and functions of this one."""
    module = sys.modules[package]
    names = {*getattr(module, "__all__", dir(module)), *ABSENT.get(package, ())}
    functions = {f"{name}_impl" for name in names if name.islower()}
    classes = {
        re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower() for name in names
    }
    return classes - names | functions | OTHERS.get(package, set())


def install() -> None:
    """Let these paths be imported."""
    if not any(isinstance(finder, _Paths) for finder in sys.meta_path):
        sys.meta_path.append(_Paths())
