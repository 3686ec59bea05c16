"""From a launch file in XML or YAML to a launch description."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, ClassVar, TextIO

import launch.frontend.tags  # noqa: F401 -- what the tags of launch itself stand for
from launch.frontend.entity import Entity
from launch.frontend.expose import entry_points, instantiate_action, load_extensions
from launch.frontend.parse_substitution import (
    parse_if_substitutions,
    parse_substitution,
    replace_escaped_characters,
)
from launch.invalid_launch_file_error import InvalidFrontendLaunchFileError
from launch.launch_description import LaunchDescription
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.substitution import Substitution

PARSER_GROUP = "launch.frontend.parser"
OWN_PARSERS = {"xml": "launch_xml", "yaml": "launch_yaml"}


class Parser:
    """Reads a launch file.

    Attributes:
        frontend_parsers: the parsers by their names, in the order of their trial.
    """

    frontend_parsers: ClassVar[dict[str, type[Parser]]] = {}
    _has_all_parsers: ClassVar[bool] = False

    @classmethod
    def load(cls, file: str | bytes | os.PathLike[str] | TextIO) -> tuple[Entity, Parser]:
        """Return what is in a file, read as its name says and else in any way that works.

        Args:
            file: its path, or the open file.

        Raises:
            InvalidFrontendLaunchFileError: if no way works.
        """
        if isinstance(file, (str, bytes, os.PathLike)):
            with Path(os.fsdecode(file)).open(encoding="utf-8") as stream:
                return cls._load(stream)
        return cls._load(file)

    @classmethod
    def _load(cls, stream: TextIO) -> tuple[Entity, Parser]:
        name = str(getattr(stream, "name", ""))
        by_name = cls.get_parsers_from_filename(name)
        errors: list[Exception] = []
        for parser in dict.fromkeys([*by_name, *Parser.frontend_parsers.values()]):
            stream.seek(0)
            try:
                return parser.load(stream)
            except Exception as error:  # whatever xml and yaml raise
                errors.append(error)
        raise InvalidFrontendLaunchFileError(Path(name).suffix[1:] if by_name else "", likely_errors=errors)

    @classmethod
    def load_launch_extensions(cls) -> None:
        """Bring in the tags and substitutions that installed packages add."""
        load_extensions()

    @classmethod
    def load_parser_implementations(cls) -> None:
        """Bring in the parsers that installed packages add."""
        cls._load_own_parsers()
        if not Parser._has_all_parsers:
            Parser._has_all_parsers = True
            for entry_point, parser in entry_points(PARSER_GROUP):
                Parser.frontend_parsers.setdefault(entry_point.name, parser)

    @classmethod
    def get_available_extensions(cls) -> Iterable[str]:
        """Return the names of the parsers."""
        cls.load_parser_implementations()
        return Parser.frontend_parsers.keys()

    @classmethod
    def get_file_extensions(cls) -> set[str]:
        """Return the ends of the names of such files."""
        return set()

    @classmethod
    def get_file_extensions_from_parsers(cls) -> set[str]:
        """Return the ends of the names of all files that can be read."""
        cls.load_parser_implementations()
        return {end for parser in Parser.frontend_parsers.values() for end in parser.get_file_extensions()}

    @classmethod
    def get_parsers_from_filename(cls, filename: str) -> list[type[Parser]]:
        """Return the parsers of files with such a name; other packages' are looked for if none here is one."""
        cls._load_own_parsers()
        if not any(parser.may_parse(filename) for parser in Parser.frontend_parsers.values()):
            cls.load_parser_implementations()
        return [parser for parser in Parser.frontend_parsers.values() if parser.may_parse(filename)]

    @classmethod
    def may_parse(cls, filename: str) -> bool:
        """Return whether a file has such a name."""
        return any(filename.endswith(f".{extension}") for extension in cls.get_file_extensions())

    @classmethod
    def is_filename_valid(cls, filename: str) -> bool:
        """Return whether a file has a name of any kind that can be read."""
        return bool(cls.get_parsers_from_filename(filename))

    @classmethod
    def _load_own_parsers(cls) -> None:
        for name, module in OWN_PARSERS.items():
            if name not in Parser.frontend_parsers:
                Parser.frontend_parsers[name] = importlib.import_module(module).Parser

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
        return instantiate_action(entity, self)

    def parse_substitution(self, value: str) -> list[Substitution]:
        """Return the substitutions in a text."""
        return parse_substitution(value)

    def parse_if_substitutions(self, value: Any) -> Any:
        """Return a value in which texts with substitutions, if there are any, are replaced by these."""
        return parse_if_substitutions(value)

    def escape_characters(self, value: str) -> str:
        """Return a text without the backslashes before characters."""
        return replace_escaped_characters(value)
