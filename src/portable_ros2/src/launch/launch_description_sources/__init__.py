"""Launch files, and how they are read."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from launch.invalid_launch_file_error import InvalidFrontendLaunchFileError, InvalidLaunchFileError
from launch.launch_description import LaunchDescription
from launch.launch_description_source import LaunchDescriptionSource
from launch.lookup import lookup
from launch.some_substitutions_type import SomeSubstitutionsType

if TYPE_CHECKING:
    from launch.frontend import Parser


__getattr__ = lookup(__name__)


class InvalidPythonLaunchFileError(Exception):
    """A Python file is not a launch file."""


def get_launch_description_from_python_launch_file(python_launch_file_path: str) -> LaunchDescription:
    """Return what `generate_launch_description()` of a file returns.

    Raises:
        InvalidPythonLaunchFileError: if there is no such function, or if it returns something else.
    """
    module = load_python_launch_file_as_module(python_launch_file_path)
    if not hasattr(module, "generate_launch_description"):
        raise InvalidPythonLaunchFileError(
            f"launch file at '{python_launch_file_path}' does not contain the required function "
            "'generate_launch_description()'"
        )
    description = module.generate_launch_description()
    if not isinstance(description, LaunchDescription):
        raise InvalidPythonLaunchFileError(
            f"generate_launch_description() in the launch file at '{python_launch_file_path}' must return "
            f"a LaunchDescription, but it returns {description!r}"
        )
    return description


def load_python_launch_file_as_module(python_launch_file_path: str) -> ModuleType:
    """Run a Python file and return it as a module, without leaving a compiled file beside it."""
    loader = SourceFileLoader("python_launch_file", str(python_launch_file_path))
    spec = spec_from_loader(loader.name, loader)
    if spec is None:
        raise RuntimeError(f"The file '{python_launch_file_path}' cannot be read as Python.")
    module = module_from_spec(spec)
    writes, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        loader.exec_module(module)
    finally:
        sys.dont_write_bytecode = writes
    return module


def get_launch_description_from_frontend_launch_file(
    frontend_launch_file_path: str, *, parser: type[Parser] | None = None
) -> LaunchDescription:
    """Return what an XML or YAML file describes, read by a parser or by the one that its name asks for."""
    from launch.frontend import Parser

    entity, reader = (parser or Parser).load(frontend_launch_file_path)
    return reader.parse_description(entity)


def get_launch_description_from_any_launch_file(
    launch_file_path: str, *, parser: type[Parser] | None = None
) -> LaunchDescription:
    """Return what a file describes, read as its name says and else in any way that works.

    Raises:
        InvalidLaunchFileError: if no way works.
    """
    loaders: list[Callable[[str], LaunchDescription]] = [
        partial(get_launch_description_from_frontend_launch_file, parser=parser),
        get_launch_description_from_python_launch_file,
    ]
    name = Path(launch_file_path).name
    extension = Path(name).suffix[1:]
    if extension == "py":
        loaders.reverse()
    elif not _is_frontend_file(name):
        extension = ""
    errors: list[Exception] = []
    for load in loaders:
        try:
            return load(launch_file_path)
        except Exception as error:  # launch files may raise anything
            errors.append(error)
    raise InvalidLaunchFileError(extension, likely_errors=errors) from errors[0]


def _is_frontend_file(name: str) -> bool:
    from launch.frontend import Parser  # which a file in Python does not need

    return Parser.is_filename_valid(name)


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A Python, XML or YAML launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_any_launch_file(location)


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A Python launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted python launch file")

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_python_launch_file(location)


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """An XML or YAML launch file."""

    def __init__(
        self,
        launch_file_path: SomeSubstitutionsType,
        *,
        parser: type[Parser] | None = None,
        method: str = "interpreted frontend launch file",
    ) -> None:
        super().__init__(None, launch_file_path, method)
        self._parser = parser

    def _get_launch_description(self, location: str) -> LaunchDescription:
        return get_launch_description_from_frontend_launch_file(location, parser=self._parser)


__all__ = [
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "InvalidFrontendLaunchFileError",
    "InvalidLaunchFileError",
    "InvalidPythonLaunchFileError",
    "PythonLaunchDescriptionSource",
    "get_launch_description_from_any_launch_file",
    "get_launch_description_from_frontend_launch_file",
    "get_launch_description_from_python_launch_file",
    "load_python_launch_file_as_module",
]
