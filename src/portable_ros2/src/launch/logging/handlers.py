"""The handlers of Python's logging, which here may also have a format of its own for each logger.

`launch.logging.handlers.RotatingFileHandler`, for instance, is made when it is asked for.
"""

from __future__ import annotations

import functools
import importlib
import logging
from typing import Any


class PerLoggerFormatting:
    """What is added to a handler."""

    def setFormatterFor(self, logger: logging.Logger, formatter: logging.Formatter) -> None:  # noqa: N802
        """Let the records of a logger have this format."""
        self._formatters()[logger.name] = formatter

    def unsetFormatterFor(self, logger: logging.Logger) -> None:  # noqa: N802
        """Let the records of a logger have the format that the others have."""
        self._formatters().pop(logger.name, None)

    def format(self, record: logging.LogRecord) -> str:
        """Return the text of a record."""
        formatter = self._formatters().get(record.name)
        text: str = super().format(record) if formatter is None else formatter.format(record)  # type: ignore[misc]
        return text

    def _formatters(self) -> dict[str, logging.Formatter]:
        """Return the formats by the names of loggers."""
        found: dict[str, logging.Formatter] = self.__dict__.setdefault("_formatters_by_name", {})
        return found


class Handler(PerLoggerFormatting, logging.Handler):
    """A handler of no kind yet."""


def __getattr__(name: str) -> Any:
    """Return what Python's logging has of this name: of a handler, a class derived from it."""
    for module in ("logging", "logging.handlers"):
        found = getattr(importlib.import_module(module), name, None)
        if found is not None:
            is_handler = isinstance(found, type) and issubclass(found, logging.Handler)
            return _derived(found) if is_handler else found
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


@functools.cache
def _derived(handler: type[logging.Handler]) -> type[logging.Handler]:
    return type(handler.__name__, (PerLoggerFormatting, handler), {"__module__": __name__})
