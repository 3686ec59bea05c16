"""Substitutions and entities in the forms in which they may be given."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch.launch_description_entity import LaunchDescriptionEntity
from launch.lookup import lookup
from launch.substitution import Substitution, TextSubstitution

if TYPE_CHECKING:
    import asyncio

    from launch.launch_context import LaunchContext
    from launch.some_entities_type import SomeEntitiesType
    from launch.some_substitutions_type import SomeSubstitutionsType

FilePath = str | bytes | os.PathLike[str]

__getattr__ = lookup(__name__, absent={"AsyncSafeSignalManager"})


def isclassinstance(obj: object) -> bool:
    """Return whether this is an instance of a class, as everything in Python is."""
    return hasattr(obj, "__class__")


def is_a(obj: object, entity_type: type) -> bool:
    """Return whether an object is an instance of a class.

    Raises:
        RuntimeError: if the latter is no class.
    """
    if not isinstance(entity_type, type):
        raise RuntimeError(f"entity_type '{entity_type}' is not a class")
    return isinstance(obj, entity_type)


def is_a_subclass(obj: object, entity_type: type) -> bool:
    """Return whether an object is an instance of a class, or a class derived from it."""
    return is_a(obj, entity_type) or (isinstance(obj, type) and issubclass(obj, entity_type))


def ensure_argument_type(
    argument: object, types: type | Iterable[type], argument_name: str, caller: str | None = None
) -> None:
    """Raise TypeError if an argument is of none of the types.

    Args:
        argument: its value.
        types: the types that it may have.
        argument_name: its name, for the message.
        caller: what takes it, for the message.
    """
    allowed = (types,) if isinstance(types, type) else tuple(types)
    if not isinstance(argument, allowed):
        who = "E" if caller is None else f"'{caller}' e"
        names = ", ".join(str(kind) for kind in allowed)
        raise TypeError(
            f"{who}xpected '{argument_name}' to be one of [{names}], "
            f"but got '{argument}' of type '{type(argument)}'"
        )


def visit_all_entities_and_collect_futures(
    entity: LaunchDescriptionEntity, context: LaunchContext
) -> list[tuple[LaunchDescriptionEntity, asyncio.Future[Any]]]:
    """Visit an entity and then what it returns; return those that are not done with that, and what ends them."""
    entities = entity.visit(context)
    future = entity.get_asyncio_future()
    found = [] if future is None else [(entity, future)]
    for inner in normalize_to_list_of_entities(entities):
        found += visit_all_entities_and_collect_futures(inner, context)
    return found


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return substitutions for a text, a path, a substitution or several of them.

    Raises:
        TypeError: if something else is among them.
    """
    if isinstance(subs, (str, Path, Substitution)):
        subs = [subs]
    normalized: list[Substitution] = []
    for item in subs:
        if isinstance(item, (str, Path)):
            normalized.append(TextSubstitution(text=str(item)))
        elif isinstance(item, Substitution):
            normalized.append(item)
        else:
            raise TypeError(
                f"Failed to normalize given item of type '{type(item)}', when only "
                "'str' or 'launch.Substitution' were expected."
            )
    return normalized


def perform_substitutions(context: LaunchContext, subs: Iterable[Substitution]) -> str:
    """Return the text that substitutions make together."""
    return "".join(context.perform_substitution(sub) for sub in subs)


def normalize_to_list_of_entities(entities: SomeEntitiesType | None) -> list[LaunchDescriptionEntity]:
    """Return entities for one, several or none.

    Raises:
        RuntimeError: if something else is among them.
    """
    if entities is None:
        return []
    if isinstance(entities, LaunchDescriptionEntity):
        return [entities]
    if not isinstance(entities, Iterable):
        raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{entities}'")
    flat = [entity for given in entities for entity in ([given] if given is not None else [])]
    for entity in flat:
        if not isinstance(entity, LaunchDescriptionEntity):
            raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{entity}'")
    return flat
