"""Launch files in XML."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

from launch import frontend
from launch.frontend.type_utils import check_is_list_entity
from launch.lookup import lookup
from launch.utilities.type_utils import get_typed_value

__getattr__ = lookup(__name__)

__all__ = ["Entity", "Parser", "launch_description_sources"]


class Entity(frontend.Entity):
    """A tag."""

    def __init__(self, xml_element: ET.Element, *, parent: Entity | None = None) -> None:
        self.type_name = xml_element.tag
        self.parent = parent
        self._element = xml_element
        self._unread = set(xml_element.attrib)
        self._unread_tags = {item.tag for item in xml_element}

    @property
    def children(self) -> list[Entity]:
        """The tags in it."""
        self._unread_tags.clear()
        return [Entity(item, parent=self) for item in self._element]

    def get_attr(
        self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True
    ) -> Any:
        """Return an attribute; see the base class."""
        if check_is_list_entity(data_type):
            found: Any = [Entity(item, parent=self) for item in self._element if item.tag == name] or None
            self._unread_tags.discard(name)
        else:
            found = self._attribute(name, data_type, can_be_str)
        if found is None and not optional:
            raise AttributeError(
                f"Attribute '{name}' of type '{data_type}' not found in Entity '{self.type_name}'"
            )
        return found

    def _attribute(self, name: str, data_type: Any, can_be_str: bool) -> Any:
        text = self._element.attrib.get(name)
        if text is None:
            return None
        self._unread -= {name, f"{name}-sep"}
        separator = self._element.attrib.get(f"{name}-sep")
        value = text if separator is None else text.split(separator)
        try:
            return get_typed_value(value, data_type, can_be_str=can_be_str)
        except ValueError:
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.type_name}' expected to be of type '{data_type}'. "
                f"'{text}' can not be converted to one of those types"
            ) from None

    def assert_entity_completely_parsed(self) -> None:
        """Raise ValueError if it has attributes or tags that nobody has asked for."""
        if self._unread_tags:
            raise ValueError(f"Unexpected nested tag(s) found in `{self.type_name}`: {self._unread_tags}")
        if self._unread:
            raise ValueError(f"Unexpected attribute(s) found in `{self.type_name}`: {self._unread}")


class Parser(frontend.Parser):
    """Reads XML."""

    @classmethod
    def load(cls, file: Any) -> tuple[Entity, Parser]:
        """Return what is in a file."""
        return Entity(ET.parse(file).getroot()), cls()  # noqa: S314 -- a launch file may run anything anyway

    @classmethod
    def get_file_extensions(cls) -> set[str]:
        """Return the ends of the names of such files."""
        return {"launch.xml", "xml", "launch"}
