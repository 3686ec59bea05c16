"""Ask setuptools, in a separate process, which arguments of setup() it accepts.

Only plain values are passed: no student code is run.
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
    """Return for each argument that setuptools rejects its message, and a value that it accepts or None.

    For an unknown keyword the message is empty, and the value is the list of all known keywords.
    """
    found: dict[str, tuple[str, Any]] = {}
    for name, value in given.items():
        said = _refusal(name, value)
        if said is not None:
            better = _known() if not said else next(_taken(name, value, said), None)
            found[name] = (said, better)
    return found


def _taken(name: str, value: Any, said: str) -> Iterator[Any]:
    """Yield other forms of a value that setuptools accepts."""
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
    """Return why setuptools rejects a value; empty for an unknown keyword, None if it accepts the value."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            distribution = _distribution({name: value})
            distribution.finalize_options()
            distribution.metadata.write_pkg_file(io.StringIO())
            distribution.get_command_obj("build_py").ensure_finalized()
        except Exception as error:
            return str(error) or type(error).__name__
    for warning in said:
        if str(warning.message).startswith("Unknown distribution option"):
            return ""
        if "should be a list" in str(warning.message):
            return str(warning.message)
    return None


def _distribution(given: Mapping[str, Any]) -> Any:
    from setuptools import Distribution  # type: ignore[import-untyped]

    return Distribution({"name": "name", "version": "0.0.0", **given})


def _known() -> list[str]:
    """Return the names of all keywords of setup()."""
    plain = _distribution({})
    names = {*vars(plain), *vars(plain.metadata)}
    names |= {entry_point.name for entry_point in entry_points(group="distutils.setup_keywords")}
    return sorted(name for name in names if name[0] != "_")


if __name__ == "__main__":
    sys.stdout.write(repr(refusals(ast.literal_eval(sys.stdin.read()))))
