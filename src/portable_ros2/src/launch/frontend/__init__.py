"""Launch files in XML and YAML: tags and their attributes become actions."""

from __future__ import annotations

import errno
import importlib.util
import os
import typing
from pathlib import Path
from typing import Any

from launch.absent import absent
from launch.invalid_launch_file_error import InvalidLaunchFileError
from launch.launch_description import LaunchDescription
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.substitution import Substitution

__getattr__ = absent(__name__, {"expose_action", "expose_substitution"})

# The parsers in the order of their trial, and the package with more tags.
PARSERS = ("launch_xml", "launch_yaml")
EXTENSION = "launch_ros"


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """A launch file is neither good XML nor good YAML."""


class Entity:
    """A tag with its attributes and the tags in it."""

    type_name: str

    @property
    def children(self) -> list[Any]:
        """The tags in it."""
        raise NotImplementedError

    def get_attr(
        self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True
    ) -> Any:
        """Return an attribute.

        Args:
            name: its name.
            data_type: bool, int, float, str, a list such as `list[int]`, None for any of these, or
                `list[Entity]` for the tags of this name.
            optional: return None if it is not there.
            can_be_str: also accept a text in place of another type: it may become one while launching.

        Raises:
            AttributeError: if it is not there.
            TypeError: if it is of another type.
        """
        raise NotImplementedError

    def assert_entity_completely_parsed(self) -> None:
        """Raise ValueError if it has attributes or tags that nobody has asked for."""
        raise NotImplementedError


class Parser:
    """Reads a launch file."""

    @classmethod
    def load(cls, file: Any) -> tuple[Entity, Parser]:
        """Return what is in a file, read as its name says and else in any way that works.

        Raises:
            InvalidFrontendLaunchFileError: if no way works.
        """
        path = str(file)
        if not Path(path).exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        parsers = sorted(_parsers(), key=lambda parser: not parser.may_parse(path))
        errors: list[Exception] = []
        for parser in parsers:
            try:
                return parser.load(path)
            except Exception as error:  # whatever xml and yaml raise
                errors.append(error)
        extension = Path(path).suffix[1:] if cls.is_filename_valid(path) else ""
        raise InvalidFrontendLaunchFileError(extension, likely_errors=errors)

    @classmethod
    def get_file_extensions(cls) -> set[str]:
        """Return the ends of the names of such files."""
        return set()

    @classmethod
    def get_file_extensions_from_parsers(cls) -> set[str]:
        """Return the ends of the names of all files that can be read."""
        return {extension for parser in _parsers() for extension in parser.get_file_extensions()}

    @classmethod
    def may_parse(cls, filename: str) -> bool:
        """Return whether a file has such a name."""
        return any(filename.endswith(f".{extension}") for extension in cls.get_file_extensions())

    @classmethod
    def is_filename_valid(cls, filename: str) -> bool:
        """Return whether a file has a name of any kind that can be read."""
        return any(parser.may_parse(filename) for parser in _parsers())

    def parse_description(self, entity: Entity) -> LaunchDescription:
        """Return what a file describes."""
        if entity.type_name != "launch":
            raise RuntimeError("Expected 'launch' as root tag")
        deprecated = entity.get_attr("deprecated", optional=True)
        actions = [self.parse_action(child) for child in entity.children]
        return LaunchDescription(actions, deprecated_reason=deprecated)

    def parse_action(self, entity: Entity) -> LaunchDescriptionEntity:
        """Return the action of a tag.

        Raises:
            RuntimeError: if there is no such tag.
            ValueError: if it has attributes that there are not.
        """
        from launch.frontend.tags import TAGS

        load_extension()
        if entity.type_name not in TAGS:
            raise RuntimeError(f"Unrecognized entity of the type: {entity.type_name}")
        action = TAGS[entity.type_name](entity, self)
        entity.assert_entity_completely_parsed()
        return action

    def parse_substitution(self, value: str) -> list[Substitution]:
        """Return the substitutions in a text."""
        from launch.frontend.parse_substitution import parse_substitution

        return parse_substitution(value)

    def parse_if_substitutions(self, value: Any) -> Any:
        """Return a value in which texts with substitutions, if there are any, are replaced by these."""
        from launch.substitutions import TextSubstitution

        if isinstance(value, list):
            return [self.parse_if_substitutions(item) for item in value]
        if not isinstance(value, str):
            return value
        subs = self.parse_substitution(value)
        return subs[0].text if len(subs) == 1 and isinstance(subs[0], TextSubstitution) else subs

    def escape_characters(self, value: str) -> str:
        """Return a text without the backslashes before characters."""
        from launch.frontend.parse_substitution import unescaped

        return unescaped(value)


def is_list_of_entities(data_type: Any) -> bool:
    """Return whether `list[Entity]` is meant."""
    arguments = typing.get_args(data_type)
    return bool(arguments) and arguments[0] is Entity


def _parsers() -> list[type[Parser]]:
    return [importlib.import_module(name).Parser for name in PARSERS]


def load_extension() -> None:
    """Bring in the tags and substitutions of nodes, if they are installed."""
    if importlib.util.find_spec(EXTENSION) is not None:
        importlib.import_module(f"{EXTENSION}.frontend")
