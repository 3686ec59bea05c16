"""What the tags and substitutions of a launch file stand for; a package may add its own."""

from __future__ import annotations

import importlib.util
import inspect
import warnings
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from launch.action import Action
    from launch.frontend.entity import Entity
    from launch.frontend.parser import Parser
    from launch.some_substitutions_type import SomeSubstitutionsType
    from launch.substitution import Substitution

Parsed = tuple[Callable[..., Any], dict[str, Any]]
Exposed = TypeVar("Exposed", bound=Callable[..., Any])

# Of each name, the function that returns a class and the keyword arguments for it.
action_parse_methods: dict[str, Callable[[Entity, Parser], Parsed]] = {}
substitution_parse_methods: dict[str, Callable[[Iterable[SomeSubstitutionsType]], Parsed]] = {}

EXTENSION_GROUP = "launch.frontend.launch_extension"


def expose_action(name: str) -> Callable[[Exposed], Exposed]:
    """Return a decorator for a class with a class method `parse(entity, parser)`, or for such a function.

    A tag of this name then becomes what it returns: an action's class, with keyword arguments.
    """
    return _decorator("action", name, action_parse_methods)


def expose_substitution(name: str) -> Callable[[Exposed], Exposed]:
    """Return a decorator for a class with a class method `parse(data)`, or for such a function."""
    return _decorator("substitution", name, substitution_parse_methods)


def instantiate_action(entity: Entity, parser: Parser) -> Action:
    """Return the action of a tag.

    Raises:
        RuntimeError: if there is no such tag.
        ValueError: if it has attributes that there are not.
    """
    parse = _found(action_parse_methods, entity.type_name)
    if parse is None:
        raise RuntimeError(f"Unrecognized entity of the type: {entity.type_name}")
    make, keywords = parse(entity, parser)
    entity.assert_entity_completely_parsed()
    action: Action = make(**keywords)
    return action


def instantiate_substitution(
    type_name: str, args: Iterable[SomeSubstitutionsType] | None = None
) -> Substitution:
    """Return the substitution of a name.

    Raises:
        RuntimeError: if there is none of this name.
    """
    parse = _found(substitution_parse_methods, type_name)
    if parse is None:
        raise RuntimeError(f"Unknown substitution: {type_name}")
    make, keywords = parse([] if args is None else args)
    substitution: Substitution = make(**keywords)
    return substitution


def load_extensions() -> None:
    """Bring in everything that installed packages add."""
    while _pending:
        _pending.pop()()


def entry_points(group: str) -> Iterator[tuple[EntryPoint, Any]]:
    """Yield the entry points of a group with what they load; warn of those that cannot be loaded."""
    from importlib import metadata

    for entry_point in metadata.entry_points(group=group):
        try:
            yield entry_point, entry_point.load()
        except Exception as error:  # another package may raise anything
            warnings.warn(
                f"The launch extension '{entry_point.name}' cannot be loaded: "
                f"{type(error).__name__}: {error}",
                stacklevel=2,
            )


def _decorator(kind: str, name: str, methods: dict[str, Any]) -> Callable[[Exposed], Exposed]:
    def expose(exposed: Exposed) -> Exposed:
        parse = getattr(exposed, "parse", None) if inspect.isclass(exposed) else exposed
        if not callable(parse):
            raise RuntimeError(
                f"The {kind} '{name}' can only be exposed by a class with a class method 'parse' "
                f"or by a function, not by {exposed!r}."
            )
        if methods.setdefault(name, parse) != parse:
            raise RuntimeError(f"Two parsing methods are exposed for the {kind} '{name}'.")
        return exposed

    return expose


def _found(methods: dict[str, Any], name: str) -> Any:
    """Return the method of a name; only for one that is unknown yet, look what other packages add."""
    while name not in methods and _pending:
        _pending.pop()()
    return methods.get(name)


def _load_nodes() -> None:
    if importlib.util.find_spec("launch_ros") is not None:
        importlib.import_module("launch_ros.frontend")


def _load_entry_points() -> None:
    for _ in entry_points(EXTENSION_GROUP):
        pass


_pending: list[Callable[[], None]] = [_load_entry_points, _load_nodes]  # the last one first
