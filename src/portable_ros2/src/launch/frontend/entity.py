"""What a launch file in XML or YAML is made of."""

from __future__ import annotations

from typing import Any


class Entity:
    """A tag with its attributes and the tags in it."""

    type_name: str
    parent: Entity | None

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
            can_be_str: also accept a text instead of another type: it may become one while launching.

        Raises:
            AttributeError: if it is not there.
            TypeError: if it is of another type.
        """
        raise NotImplementedError

    def assert_entity_completely_parsed(self) -> None:
        """Raise ValueError if it has attributes or tags that nobody has asked for."""
        raise NotImplementedError
