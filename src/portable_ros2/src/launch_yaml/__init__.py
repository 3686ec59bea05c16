"""Launch files in YAML."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from launch import frontend
from launch.frontend.type_utils import check_is_list_entity
from launch.lookup import lookup
from launch.utilities.type_utils import is_instance_of

__getattr__ = lookup(__name__)

__all__ = ["Entity", "Parser", "launch_description_sources"]


class Entity(frontend.Entity):
    """A key with what stands below it."""

    def __init__(self, element: Any, type_name: str, *, parent: Entity | None = None) -> None:
        self.type_name = type_name
        self.parent = parent
        self._element = element
        self._unread = set(element) if isinstance(element, dict) else {type_name}

    @property
    def children(self) -> list[Entity]:
        """The entities in it: its items, or the items below its key `children`."""
        children = self._element
        if isinstance(children, dict):
            if "children" not in children:
                raise ValueError(
                    f"Expected entity `{self.type_name}` to have children entities. That can be a list of "
                    "subentities or a dictionary with a `children` list element"
                )
            self._unread.discard("children")
            children = children["children"]
        else:
            self._unread.clear()
        if not isinstance(children, list):
            raise TypeError(f"Expected a dict or list, got {type(children)}:\n---\n{children}\n---")
        return [_child(child, self) for child in children]

    def get_attr(
        self, name: str, *, data_type: Any = str, optional: bool = False, can_be_str: bool = True
    ) -> Any:
        """Return an attribute; see the base class. A value of another type is not converted."""
        if not isinstance(self._element, dict) or name not in self._element:
            if optional:
                return None
            raise AttributeError(f"Can not find attribute '{name}' in Entity '{self.type_name}'")
        self._unread.discard(name)
        data = self._element[name]
        if check_is_list_entity(data_type):
            if not (isinstance(data, list) and all(isinstance(item, dict) for item in data)):
                raise TypeError(
                    f"Attribute '{name}' of Entity '{self.type_name}' expected to be a list of dictionaries."
                )
            return [Entity(item, name, parent=self) for item in data]
        if not is_instance_of(data, data_type, can_be_str=can_be_str):
            raise TypeError(
                f"Attribute '{name}' of Entity '{self.type_name}' expected to be of type '{data_type}', "
                f"got '{type(data)}'"
            )
        return data

    def assert_entity_completely_parsed(self) -> None:
        """Raise ValueError if it has keys that nobody has asked for."""
        if not self._unread:
            return
        if isinstance(self._element, dict):
            raise ValueError(f"Unexpected key(s) found in `{self.type_name}`: {self._unread}")
        raise ValueError(f"Unexpected nested entity(ies) found in `{self.type_name}`: {self._element}")


class Parser(frontend.Parser):
    """Reads YAML."""

    @classmethod
    def load(cls, file: Any) -> tuple[Entity, Parser]:
        """Return what is in a file."""
        if not hasattr(file, "read"):
            with Path(file).open(encoding="utf-8") as stream:  # an error then tells the file's name
                return cls.load(stream)
        import yaml  # which a file in XML may not need

        tree = yaml.safe_load(file)
        if not isinstance(tree, dict) or len(tree) != 1:
            raise RuntimeError("Expected only one root")
        return _child(tree, None), cls()

    @classmethod
    def get_file_extensions(cls) -> set[str]:
        """Return the ends of the names of such files."""
        return {"launch.yaml", "launch.yml", "yaml", "yml", "launch"}


def _child(element: Any, parent: Entity | None) -> Entity:
    if not isinstance(element, dict) or len(element) != 1:
        raise RuntimeError("Subentities must be a dictionary with only one key, which is the entity type")
    ((type_name, inner),) = element.items()
    return Entity(inner, str(type_name), parent=parent)
