"""How a fault is made: the model with one change, which must cost one component and no other."""

from __future__ import annotations

from corpus.case import ALL_BONUS, Case, Loss
from corpus.package import MODEL
from corpus.tree import Change, Files, as_folder, made

# What of the bonus a fault must leave: a node that is wrong may fail its own tests, and what is not installed cannot
# be launched, so nothing is said of that.
_KEPT = {
    "workspace": ALL_BONUS,
    "documentation": ALL_BONUS,
    "package": frozenset(("errors",)),
}
RUNS = frozenset(("launch",))  # a node that is wrong and lives can be launched all the same


def fault(
    component: str,
    name: str,
    change: Change,
    cause: str,
    about: str,
    *,
    least: float = 0.5,
    most: float = 20,
    earns: frozenset[str] | None = None,
    unreadable: tuple[str, ...] = (),
    builds: bool = True,
) -> Case:
    """Return the model with a change that costs a component from `least` to `most` points, and half of the build if that fails."""
    return Case(
        f"{component}/{name}",
        about,
        as_folder(made(MODEL, change)),
        {component: Loss(least, most, cause)},
        earns=_KEPT.get(component, frozenset()) if earns is None else earns,
        unreadable=unreadable,
        builds=builds,
    )


def bonus_fault(
    item: str,
    name: str,
    change: Change,
    cause: str,
    about: str,
    *,
    costs: tuple[str, ...] = (),
    unreadable: tuple[str, ...] = (),
) -> Case:
    """Return the model with a change that costs an item of the bonus and no points.

    The items in `costs` may go with it, because they cannot be seen without it.
    """
    return Case(
        f"bonus/{name}",
        about,
        as_folder(made(MODEL, change)),
        earns=ALL_BONUS - {item, *costs},
        lacks=frozenset((item,)),
        bonus_cause=cause,
        unreadable=unreadable,
    )


def both(*changes: Change) -> Change:
    """Return several changes that make one fault."""

    def change(files: Files) -> None:
        for one in changes:
            one(files)

    return change
