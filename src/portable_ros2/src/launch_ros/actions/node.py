"""The action that runs a node."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import launch.logging
from launch.actions import ExecuteProcess
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitutions import TextSubstitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch_ros.names import (
    add_node_name,
    get_node_name_count,
    make_namespace_absolute,
    normalize_remap_rules,
    prefix_namespace,
    validate_namespace,
    validate_node_name,
)
from launch_ros.parameter_descriptions import Parameter, temporary_file
from launch_ros.parameters import evaluate_parameters, normalize_parameters
from launch_ros.substitutions import ExecutableInPackage

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__getattr__ = lookup(__name__, absent={"NodeActionExtension", "get_extensions", "instantiate_extension"})

NO_NAME = "<node_name_unspecified>"
NO_NAMESPACE = "<node_namespace_unspecified>"


class Node(ExecuteProcess):
    """Runs a node.

    Args:
        executable: the executable of the package, or a path without a package.
        package: the package.
        name: the name of the node; what the node itself says if None.
        namespace: its namespace, below the one that is pushed unless it begins with a slash.
        exec_name: how the process is called in the output.
        parameters: dictionaries, paths of YAML files, `Parameter` and `ParameterFile`; later ones win.
        remappings: pairs of names: from and to.
        ros_arguments: arguments after `--ros-args`.
        arguments: arguments before it.
        process_arguments: see `ExecuteProcess`.
    """

    UNSPECIFIED_NODE_NAME = NO_NAME
    UNSPECIFIED_NODE_NAMESPACE = NO_NAMESPACE

    def __init__(
        self,
        *,
        executable: SomeSubstitutionsType,
        package: SomeSubstitutionsType | None = None,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        exec_name: SomeSubstitutionsType | None = None,
        parameters: Sequence[Any] | None = None,
        remappings: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] | None = None,
        ros_arguments: Iterable[SomeSubstitutionsType] | None = None,
        arguments: Iterable[SomeSubstitutionsType] | None = None,
        **process_arguments: Any,
    ) -> None:
        program = executable if package is None else ExecutableInPackage(executable, package)
        cmd: list[SomeSubstitutionsType] = [program, *(arguments or [])]
        if ros_arguments is not None:
            cmd += ["--ros-args", *ros_arguments]
        super().__init__(cmd=[*cmd, "--ros-args"], name=exec_name, **process_arguments)
        self.node_package = package
        self.node_executable = executable
        self._node_name = name
        self._namespace = namespace
        self._parameters = normalize_parameters([] if parameters is None else parameters)
        self._remappings = list(normalize_remap_rules(remappings or []))
        self._final_node_name: str | None = None
        self.expanded_node_namespace = NO_NAMESPACE
        self.expanded_remapping_rules: list[tuple[str, str]] = []

    @property
    def node_name(self) -> str:
        """The name with its namespace, known when the node is run."""
        if self._final_node_name is None:
            raise RuntimeError("cannot access 'node_name' before executing action")
        return self._final_node_name

    def is_node_name_fully_specified(self) -> bool:
        """Return whether name and namespace are given."""
        return NO_NAME not in self.node_name and NO_NAMESPACE not in self.node_name

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity] | None:
        """Run it."""
        result = super().execute(context)
        if self.is_node_name_fully_specified():
            self._warn_of_a_namesake(context)
        return result

    def prepare(self, context: LaunchContext) -> None:
        """Find out what is known now, the node's name and parameters among it."""
        self._perform_substitutions(context)
        super().prepare(context)

    def _perform_substitutions(self, context: LaunchContext) -> None:
        """Find out the name, the parameters and the remappings, and add them to the command."""
        name, namespace = self._expanded_name(context)
        self._final_node_name = prefix_namespace(namespace or NO_NAMESPACE, name or NO_NAME)
        arguments = [] if name is None else ["-r", f"__node:={name}"]
        arguments += [] if namespace is None else ["-r", f"__ns:={namespace}"]
        for given in context.launch_configurations.get("global_params", []):
            arguments += _parameter_arguments(given)
        for evaluated in evaluate_parameters(context, self._parameters):
            given = evaluated.evaluate(context) if isinstance(evaluated, Parameter) else evaluated
            arguments += _parameter_arguments(self._in_file(given))
        own = [
            (perform_substitutions(context, source), perform_substitutions(context, target))
            for source, target in self._remappings
        ]
        self.expanded_remapping_rules = [*context.launch_configurations.get("ros_remaps", []), *own]
        for source, target in self.expanded_remapping_rules:
            arguments += ["-r", f"{source}:={target}"]
        self.process_description.cmd += [[TextSubstitution(text=argument)] for argument in arguments]

    def _expanded_name(self, context: LaunchContext) -> tuple[str | None, str | None]:
        """Return the name and the absolute namespace, None where there are none."""
        try:
            name = _performed(context, self._node_name)
            if name is not None:
                validate_node_name(name)
            base = context.launch_configurations.get("ros_namespace")
            namespace = make_namespace_absolute(prefix_namespace(base, _performed(context, self._namespace)))
            if namespace is not None:
                validate_namespace(namespace)
                self.expanded_node_namespace = namespace
        except Exception:
            launch.logging.get_logger("launch_ros.actions.node").error(
                "Error while expanding or validating node name or namespace for "
                f"'package={self.node_package}, executable={self.node_executable}, "
                f"name={self._node_name}, namespace={self._namespace}':"
            )
            raise
        return name, namespace

    def _in_file(self, given: Any) -> Any:
        """Write a dictionary of parameters to a file: only this keeps all types."""
        if not isinstance(given, dict):
            return given
        import yaml

        node = self.node_name if self.is_node_name_fully_specified() else "/**"
        return temporary_file(yaml.safe_dump({node: {"ros__parameters": given}}))

    def _warn_of_a_namesake(self, context: LaunchContext) -> None:
        add_node_name(context, self.node_name)
        count = get_node_name_count(context, self.node_name)
        if count > 1:
            launch.logging.get_logger(self.process_description.final_name).warning(
                f"there are now at least {count} nodes with the name {self.node_name} "
                "created within this launch context"
            )


def _parameter_arguments(given: Any) -> list[str]:
    if isinstance(given, tuple):
        import yaml

        name, value = given
        text = yaml.safe_dump(value, default_flow_style=True, width=float("inf")).strip()
        return ["-p", f"{name}:={text.removesuffix('...').strip()}"]
    if not Path(given).is_file():
        launch.logging.get_logger("launch_ros.actions.node").warning(
            f"Parameter file path is not a file: {given}"
        )
        return []
    return ["--params-file", str(given)]


def _performed(context: LaunchContext, given: SomeSubstitutionsType | None) -> str | None:
    return (
        None if given is None else perform_substitutions(context, normalize_to_list_of_substitutions(given))
    )
