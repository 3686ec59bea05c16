"""Read the bytes of files as Python does."""

from __future__ import annotations

import contextlib
import importlib
import tokenize
from io import BytesIO
from pathlib import Path
from typing import Any


def decoded(data: bytes, path: Path) -> str:
    """Return the text of a file: a Python file's in the encoding that it declares, if that is one of texts; else in UTF-8."""
    if path.suffix == ".py":
        with contextlib.suppress(SyntaxError, LookupError, UnicodeError):
            encoding, _ = tokenize.detect_encoding(BytesIO(data).readline)
            return data.decode(encoding, errors="replace")
    return data.decode("utf-8-sig", errors="replace")


def read_toml(text: str) -> dict[str, Any]:
    """Return the contents of a text in TOML; empty if it cannot be read."""
    for name in ("tomllib", "setuptools.compat.py310"):  # Python 3.10 has none of its own
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        reader = getattr(module, "tomllib", module)
        try:
            return dict(reader.loads(text))
        except (ValueError, RecursionError):
            return {}
    return {}
