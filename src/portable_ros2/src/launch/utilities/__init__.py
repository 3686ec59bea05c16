"""Substitutions and entities in the forms in which they may be given."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from launch.absent import absent
from launch.launch_description_entity import LaunchDescriptionEntity
from launch.substitution import Substitution

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch.some_entities_type import SomeEntitiesType
    from launch.some_substitutions_type import SomeSubstitutionsType

__getattr__ = absent(
    __name__,
    {
        "AsyncSafeSignalManager",
        "ensure_argument_type",
        "is_a",
        "is_a_subclass",
        "isclassinstance",
        "visit_all_entities_and_collect_futures",
    },
)


def normalize_to_list_of_substitutions(subs: SomeSubstitutionsType) -> list[Substitution]:
    """Return substitutions for a text, a substitution or several of both.

    Raises:
        TypeError: if something else is among them.
    """
    from launch.substitutions import TextSubstitution

    if isinstance(subs, (str, Substitution)):
        subs = [subs]
    normalized: list[Substitution] = []
    for item in subs:
        if isinstance(item, str):
            normalized.append(TextSubstitution(text=item))
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
    flat = [one for given in entities for one in ([given] if given is not None else [])]
    for one in flat:
        if not isinstance(one, LaunchDescriptionEntity):
            raise RuntimeError(f"expected a LaunchDescriptionEntity, got '{one}'")
    return flat
