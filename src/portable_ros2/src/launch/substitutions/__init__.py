"""Texts that are only known while launching."""

from __future__ import annotations

import importlib
import math
import os
import shlex
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitution import TextSubstitution as TextSubstitution
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import coerce_to_type, is_substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

__getattr__ = lookup(__name__)

Texts = Iterable[SomeSubstitutionsType]


class SubstitutionFailure(Exception):  # noqa: N818 -- the name that launch files know
    """A substitution has no text."""


class LaunchConfiguration(Substitution):
    """The value of an argument, or of another launch configuration."""

    def __init__(self, variable_name: SomeSubstitutionsType, *, default: Any = None) -> None:
        self.variable_name = normalize_to_list_of_substitutions(variable_name)
        self._default = normalize_default(default)

    def describe(self) -> str:
        """Return a text for people."""
        return f"LaunchConfig({_described(self.variable_name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: if there is neither a value nor a default.
        """
        name = perform_substitutions(context, self.variable_name)
        if name in context.launch_configurations:
            value = context.launch_configurations[name]
            return value if isinstance(value, str) else str(value)
        if self._default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return perform_substitutions(context, self._default)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(
        self, name: SomeSubstitutionsType, *, default_value: SomeSubstitutionsType | None = None
    ) -> None:
        self.name = normalize_to_list_of_substitutions(name)
        self.default_value = (
            None if default_value is None else normalize_to_list_of_substitutions(default_value)
        )

    def describe(self) -> str:
        """Return a text for people."""
        return f"EnvVar({_described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the value.

        Raises:
            SubstitutionFailure: if there is neither a value nor a default.
        """
        name = perform_substitutions(context, self.name)
        if name in context.environment:
            return context.environment[name]
        if self.default_value is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return perform_substitutions(context, self.default_value)


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined; `/` joins more."""

    def __init__(self, substitutions: Texts) -> None:
        self.substitutions = [normalize_to_list_of_substitutions(part) for part in substitutions]

    def __truediv__(self, part: SomeSubstitutionsType) -> PathJoinSubstitution:
        return PathJoinSubstitution([*self.substitutions, part])

    def __repr__(self) -> str:
        return f"PathJoinSubstitution('{', '.join(_described(part) for part in self.substitutions)}')"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        return str(Path(*(perform_substitutions(context, part) for part in self.substitutions)))


class PathSubstitution(PathJoinSubstitution):
    """A path, or the parts of one, to which `/` joins more."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        super().__init__(normalize_to_list_of_substitutions(path))


class PythonExpression(Substitution):
    """The value of a Python expression."""

    def __init__(
        self, expression: SomeSubstitutionsType, python_modules: SomeSubstitutionsType = ("math",)
    ) -> None:
        self.expression = normalize_to_list_of_substitutions(expression)
        self.python_modules = normalize_to_list_of_substitutions(python_modules)

    def describe(self) -> str:
        """Return a text for people."""
        modules = ", ".join(sub.describe() for sub in self.python_modules)
        return f"PythonExpr({_described(self.expression)}, [{modules}])"

    def perform(self, context: LaunchContext) -> str:
        """Return the value as a text.

        Raises:
            SubstitutionFailure: if it has none.
        """
        names: dict[str, Any] = {}
        expression = perform_substitutions(context, self.expression)
        try:
            for sub in self.python_modules:
                module = importlib.import_module(context.perform_substitution(sub))
                names.update(vars(module) if module is math else {})
                names[module.__name__] = module
            return str(eval(expression, names))  # noqa: S307 -- this is what it is for
        except Exception as error:
            # Python's own words do not say which expression.
            raise SubstitutionFailure(f"{error} (in the Python expression: {expression})") from error


class Command(Substitution):
    """What a command writes to its standard output."""

    def __init__(self, command: SomeSubstitutionsType, *, on_stderr: SomeSubstitutionsType = "fail") -> None:
        self.command = normalize_to_list_of_substitutions(command)
        self.on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def describe(self) -> str:
        """Return a text for people."""
        return f"Command({_described(self.command)})"

    def perform(self, context: LaunchContext) -> str:
        """Run the command.

        Raises:
            SubstitutionFailure: if it cannot be run, fails, or writes errors though it must not.
        """
        command = perform_substitutions(context, self.command)
        on_stderr = perform_substitutions(context, self.on_stderr)
        if on_stderr not in ("fail", "ignore", "warn", "capture"):
            raise SubstitutionFailure(
                "expected 'on_stderr' to be one of: 'fail', 'ignore', 'warn' or 'capture'"
            )
        errors = subprocess.STDOUT if on_stderr == "capture" else subprocess.PIPE
        try:
            result = subprocess.run(
                shlex.split(command), stdout=subprocess.PIPE, stderr=errors, text=True, check=False
            )
        except OSError as error:
            raise SubstitutionFailure(f"file not found: {error}") from error
        if result.returncode != 0:
            text = f"\nCaptured stderr output: {result.stderr}" if result.stderr else ""
            raise SubstitutionFailure(f"executed command failed. Command: {command}{text}")
        if result.stderr and on_stderr in ("fail", "warn"):
            _complain(
                f"executed command showed stderr output. Command: {command}\n"
                f"Captured stderr output:\n{result.stderr}",
                fail=on_stderr == "fail",
            )
        return result.stdout


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self.name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Return a text for people."""
        return f"FindExec({_described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the path.

        Raises:
            SubstitutionFailure: if there is no such program.
        """
        name = perform_substitutions(context, self.name)
        path = shutil.which(name)
        if path is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return path


class FileContent(Substitution):
    """What is in a file."""

    def __init__(self, path: SomeSubstitutionsType) -> None:
        self.path = normalize_to_list_of_substitutions(path)

    def describe(self) -> str:
        """Return a text for people."""
        return f"FileContent({_described(self.path)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the text.

        Raises:
            SubstitutionFailure: if the file cannot be read.
        """
        path = perform_substitutions(context, self.path)
        try:
            return Path(path).read_text(encoding="utf-8")
        except FileNotFoundError:
            raise SubstitutionFailure(f"File not found: {path}") from None


class ThisLaunchFile(Substitution):
    """The path of the launch file that is read."""

    def describe(self) -> str:
        """Return a text for people."""
        return "ThisLaunchFile()"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        return _local(context, "current_launch_file_path", "ThisLaunchFile")


class ThisLaunchFileDir(PathSubstitution):
    """The folder of the launch file that is read."""

    def __init__(self) -> None:
        super().__init__(self)

    def describe(self) -> str:
        """Return a text for people."""
        return "ThisLaunchFileDir()"

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        return _local(context, "current_launch_file_directory", "ThisLaunchFileDir")


class LaunchLogDir(PathSubstitution):
    """The folder into which this launch writes."""

    def __init__(self) -> None:
        super().__init__(self)

    def describe(self) -> str:
        """Return a text for people."""
        return "LaunchLogDir()"

    def perform(self, context: LaunchContext) -> str:  # noqa: ARG002
        """Return the path."""
        import launch.logging

        return launch.logging.launch_config.log_dir


class LocalSubstitution(Substitution):
    """Something that is known at this place, such as `event.returncode`."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression
        self.description = description

    def describe(self) -> str:
        """Return a text for people."""
        return f"LocalVar('{self.description or self.expression}')"

    def perform(self, context: LaunchContext) -> str:
        """Return it as a text."""
        return str(eval(f"locals.{self.expression}", {"locals": context.locals}))  # noqa: S307


class AnonName(Substitution):
    """A name that nobody else has; the same one for the same name."""

    def __init__(self, name: SomeSubstitutionsType) -> None:
        self.name = normalize_to_list_of_substitutions(name)

    def describe(self) -> str:
        """Return a text for people."""
        return f"AnonName({_described(self.name)})"

    def perform(self, context: LaunchContext) -> str:
        """Return the name."""
        import secrets
        import socket

        name = perform_substitutions(context, self.name)
        if f"anon{name}" not in context.launch_configurations:
            unique = f"{name}_{socket.gethostname()}_{os.getpid()}_{secrets.randbits(63)}"
            context.launch_configurations[f"anon{name}"] = "".join("_" if c in ".-:" else c for c in unique)
        return str(context.launch_configurations[f"anon{name}"])


class EqualsSubstitution(Substitution):
    """`true` if two texts are equal, as truths, as numbers or as they are; else `false`."""

    def __init__(self, left: Any, right: Any) -> None:
        self.left = _comparable(left)
        self.right = _comparable(right)

    def describe(self) -> str:
        """Return a text for people."""
        return f"{type(self).__name__}({_described(self.left)} {_described(self.right)})"

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _said(self._are_equal(context))

    def _are_equal(self, context: LaunchContext) -> bool:
        left, right = perform_substitutions(context, self.left), perform_substitutions(context, self.right)
        truths = {"true": True, "1": True, "false": False, "0": False}
        if left.lower() in truths and right.lower() in truths:
            return truths[left.lower()] == truths[right.lower()]
        try:
            return math.isclose(float(left), float(right))
        except ValueError:
            return left == right


class NotEqualsSubstitution(EqualsSubstitution):
    """`false` if two texts are equal, else `true`."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _said(not self._are_equal(context))


class NotSubstitution(Substitution):
    """`true` for false and `false` for true."""

    def __init__(self, value: SomeSubstitutionsType) -> None:
        self.value = normalize_to_list_of_substitutions(value)

    def describe(self) -> str:
        """Return a text for people."""
        return f"NotSubstitution({_described(self.value)})"

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _said(not _truth(context, self.value))


class AllSubstitution(Substitution):
    """`true` if all are true."""

    def __init__(self, *args: SomeSubstitutionsType, container: Texts | None = None) -> None:
        self.args = [normalize_to_list_of_substitutions(arg) for arg in (*args, *(container or ()))]

    def describe(self) -> str:
        """Return a text for people."""
        return f"{type(self).__name__}({' '.join(_described(arg) for arg in self.args)})"

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _said(all([_truth(context, arg) for arg in self.args]))  # noqa: C419 -- each must be a truth


class AnySubstitution(AllSubstitution):
    """`true` if one or more are true."""

    def perform(self, context: LaunchContext) -> str:
        """Return `true` or `false`."""
        return _said(any([_truth(context, arg) for arg in self.args]))  # noqa: C419


class AndSubstitution(AllSubstitution):
    """`true` if both are true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)
        self.left, self.right = self.args


class OrSubstitution(AnySubstitution):
    """`true` if one or both are true."""

    def __init__(self, left: SomeSubstitutionsType, right: SomeSubstitutionsType) -> None:
        super().__init__(left, right)
        self.left, self.right = self.args


class IfElseSubstitution(Substitution):
    """One text if a condition is true, and another one if not."""

    def __init__(
        self,
        condition: SomeSubstitutionsType,
        if_value: SomeSubstitutionsType = "",
        else_value: SomeSubstitutionsType = "",
    ) -> None:
        self.condition = normalize_to_list_of_substitutions(condition)
        self.if_value = normalize_to_list_of_substitutions(if_value)
        self.else_value = normalize_to_list_of_substitutions(else_value)
        if if_value == else_value == "":
            raise RuntimeError("One of if_value and else_value should be specified")

    def describe(self) -> str:
        """Return a text for people."""
        return (
            f"IfElseSubstitution({_described(self.condition)}, "
            f"{_described(self.if_value)}, {_described(self.else_value)})"
        )

    def perform(self, context: LaunchContext) -> str:
        """Return one of the texts."""
        return perform_substitutions(
            context, self.if_value if _truth(context, self.condition) else self.else_value
        )


def normalize_default(default: Any) -> list[Substitution] | None:
    """Return the substitutions that make a text of a value, or of several of them; None if there is none."""
    if default is None:
        return None
    several = isinstance(default, Iterable) and not isinstance(default, str)
    return normalize_to_list_of_substitutions(
        [
            item if isinstance(item, Substitution) else str(item)
            for item in (default if several else [default])
        ]
    )


def _described(subs: Iterable[Substitution]) -> str:
    return " + ".join(sub.describe() for sub in subs)


def _said(truth: bool) -> str:
    return "true" if truth else "false"


def _truth(context: LaunchContext, subs: Iterable[Substitution]) -> bool:
    try:
        return bool(coerce_to_type(perform_substitutions(context, subs), bool))
    except ValueError as error:
        raise SubstitutionFailure(str(error)) from error


def _comparable(value: Any) -> list[Substitution]:
    if value is None:
        value = ""
    elif not is_substitution(value):
        value = str(value).lower() if isinstance(value, bool) else str(value)
    return normalize_to_list_of_substitutions(value)


def _local(context: LaunchContext, name: str, who: str) -> str:
    try:
        return str(context.get_locals_as_dict()[name])
    except KeyError:
        raise SubstitutionFailure(f"{who} used outside of a launch file (in a script)") from None


def _complain(text: str, *, fail: bool) -> None:
    import launch.logging

    if fail:
        raise SubstitutionFailure(text)
    launch.logging.get_logger().warning(text)
