"""What is wrong with a launch file."""

from __future__ import annotations

from collections.abc import Sequence


class InvalidLaunchFileError(Exception):
    """A launch file cannot be read; the text names the likely reasons."""

    def __init__(self, extension: str = "", *, likely_errors: Sequence[Exception] = ()) -> None:
        self.extension = extension
        self.likely_errors = likely_errors
        super().__init__(self._text())

    def _text(self) -> str:
        if not self.extension or not self.likely_errors:
            return "The launch file may have a syntax error, or its format is unknown"
        number = "multiple exceptions" if len(self.likely_errors) > 1 else "exception"
        lines = [f"Caught {number} when trying to load file of format [{self.extension}]:"]
        lines += [f" - {type(error).__name__}: {error}" for error in self.likely_errors]
        return "\n".join(lines)


class InvalidFrontendLaunchFileError(InvalidLaunchFileError):
    """A launch file is neither good XML nor good YAML."""
