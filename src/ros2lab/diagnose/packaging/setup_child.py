"""Ask setuptools itself, in a process of its own, which of the values that setup() is given it takes.

Only plain values travel here: no code of a student's is run.
"""

from __future__ import annotations

import ast
import io
import sys
import warnings
from collections.abc import Iterator, Mapping
from importlib.metadata import entry_points
from typing import Any


def refusals(given: Mapping[str, Any]) -> dict[str, tuple[str, Any]]:
    """Return what setuptools says of each value that it refuses, and the value that it takes instead of it, or None.

    Of an option that it does not know, what it says is empty, and the value is all that it knows.
    """
    found: dict[str, tuple[str, Any]] = {}
    for name, value in given.items():
        said = _refusal(name, value)
        if said is not None:
            better = _known() if not said else next(_taken(name, value, said), None)
            found[name] = (said, better)
    return found


def _taken(name: str, value: Any, said: str) -> Iterator[Any]:
    """Yield the forms of a value that setuptools takes."""
    match value:
        case [only]:
            forms = [only]
        case str() if "list" in said:
            forms = [[value]]
        case str() | [*_] | dict():
            forms = []
        case _:
            forms = [str(value), [str(value)]]
    yield from (form for form in forms if _refusal(name, form) is None)


def _refusal(name: str, value: Any) -> str | None:
    """Return what setuptools says of a value; empty if it does not know what it is for, None if it takes it."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            distribution = _distribution({name: value})
            distribution.finalize_options()
            distribution.metadata.write_pkg_file(io.StringIO())
            distribution.get_command_obj("build_py").ensure_finalized()
        except Exception as error:
            return str(error) or type(error).__name__
    for one in said:
        if str(one.message).startswith("Unknown distribution option"):
            return ""
        if "should be a list" in str(one.message):
            return str(one.message)
    return None


def _distribution(given: Mapping[str, Any]) -> Any:
    from setuptools import Distribution  # type: ignore[import-untyped]

    return Distribution({"name": "name", "version": "0.0.0", **given})


def _known() -> list[str]:
    """Return the names of all options."""
    plain = _distribution({})
    names = {*vars(plain), *vars(plain.metadata)}
    names |= {one.name for one in entry_points(group="distutils.setup_keywords")}
    return sorted(name for name in names if name[0] != "_")


if __name__ == "__main__":
    sys.stdout.write(repr(refusals(ast.literal_eval(sys.stdin.read()))))
