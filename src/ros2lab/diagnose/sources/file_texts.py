"""Read the bytes of files as Python does."""

from __future__ import annotations

import contextlib
import importlib
import tokenize
from io import BytesIO
from pathlib import Path
from typing import Any

LARGEST_FILE = 1_000_000  # bytes; nobody writes more by hand


def is_endless(path: Path) -> bool:
    """Return whether a file is a link to one that the kernel makes up, of which there may be no end."""
    return path.is_symlink() and path.resolve().parts[1:2] in (("proc",), ("sys",))


def bytes_of(path: Path) -> bytes:
    """Return what a file holds; nothing if it is missing, cannot be read, or is too large.

    Reading a device, a pipe, or what the kernel makes up may never end: no more is read than the file is said to hold.
    """
    with contextlib.suppress(OSError):
        if path.is_file() and (size := path.stat().st_size) <= LARGEST_FILE:
            with path.open("rb") as file:
                return file.read(size)
    return b""


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
