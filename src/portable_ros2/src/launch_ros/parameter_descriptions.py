"""Parameters of nodes."""

from __future__ import annotations

import atexit
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.some_substitutions_type import SomeSubstitutionsType
from launch.substitution import Substitution
from launch.substitutions import SubstitutionFailure
from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions
from launch.utilities.type_utils import normalize_typed_substitution, perform_typed_substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

SomePath = SomeSubstitutionsType | os.PathLike[str]


class ParameterValue:
    """A value, or a substitution and the type that its text becomes.

    Args:
        value: the value.
        value_type: bool, int, float, str, or a list such as `list[int]`; None for what YAML makes of it.
    """

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value = self._given = normalize_typed_substitution(value, value_type)
        self.value_type = value_type

    def evaluate(self, context: LaunchContext) -> Any:
        """Return the value, which `value` then is, too."""
        self.value = perform_typed_substitution(context, self._given, self.value_type)
        return self.value


class Parameter:
    """A name and a value."""

    def __init__(self, name: SomeSubstitutionsType, value: Any, *, value_type: Any = None) -> None:
        self._given_name = normalize_to_list_of_substitutions(name)
        self.name: str | list[Substitution] = self._given_name
        self._value = ParameterValue(value, value_type=value_type)

    @property
    def value(self) -> Any:
        """The value, or what it will be made of."""
        return self._value.value

    @property
    def value_type(self) -> Any:
        """The type of the value, None for what YAML makes of it."""
        return self._value.value_type

    def evaluate(self, context: LaunchContext) -> tuple[str, Any]:
        """Return both, which `name` and `value` then are, too."""
        name = self.name = perform_substitutions(context, self._given_name)
        return name, self._value.evaluate(context)


class ParameterFile:
    """A YAML file with parameters; `allow_substs` lets it hold substitutions such as `$(var name)`."""

    def __init__(self, param_file: SomePath, *, allow_substs: bool | SomeSubstitutionsType = False) -> None:
        path = os.fspath(param_file) if isinstance(param_file, os.PathLike) else param_file
        self._given = normalize_to_list_of_substitutions(path)
        self.param_file: Path | list[Substitution] = self._given
        self.allow_substs = normalize_typed_substitution(allow_substs, bool)
        self._made: Path | None = None

    def evaluate(self, context: LaunchContext) -> Path:
        """Return the path of a file without substitutions, which `param_file` then is, too.

        Raises:
            SubstitutionFailure: if the file is no good YAML with them replaced.
        """
        path = Path(perform_substitutions(context, self._given))
        if perform_typed_substitution(context, self.allow_substs, bool):
            path = self._made = _with_values(context, path)
        self.param_file = path
        return path

    def cleanup(self) -> None:
        """Delete the file that was made for the substitutions in it, if there is one."""
        if self._made is not None:
            self._made.unlink(missing_ok=True)
            self._made, self.param_file = None, self._given


def _with_values(context: LaunchContext, path: Path) -> Path:
    """Return a file like another one, with its substitutions replaced."""
    import yaml

    from launch.frontend.parse_substitution import parse_substitution

    text = perform_substitutions(context, parse_substitution(path.read_text(encoding="utf-8")))
    try:
        yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise SubstitutionFailure(
            f"The substituted parameter file is not a valid yaml file: {path}: {error}"
        ) from None
    return temporary_file(text)


def temporary_file(text: str) -> Path:
    """Return a file that lasts as long as this process: a node that is started again reads it again."""
    descriptor, path = tempfile.mkstemp(prefix="launch_params_")
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        file.write(text)
    atexit.register(Path(path).unlink, missing_ok=True)
    return Path(path)
