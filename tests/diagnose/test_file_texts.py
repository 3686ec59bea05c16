"""Python files are read in the encoding in which Python reads them."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from ros2lab.diagnose.rules import text_faults
from ros2lab.diagnose.sources.python_source import read_source

NAMED = "GRÖSSE = ['Früher']\nprint(GRÖSSE)\n"
SHEBANG = "#!/usr/bin/env python3\n"
FILES = {
    "declared": (f"# -*- coding: latin-1 -*-\n{NAMED}", "latin-1"),
    "declared on the second line": (f"{SHEBANG}# coding: cp1252\n{NAMED}a = '€'\n", "cp1252"),
    "declared as vim reads it": (f"# vim: set fileencoding=iso-8859-15 :\n{NAMED}", "iso-8859-15"),
    "with a mark at the beginning": (NAMED, "utf-8-sig"),
    "not declared": (NAMED, "utf-8"),
    "undeclared and another": (NAMED, "latin-1"),
    "declared and another": (f"# coding: utf-8\n{NAMED}", "cp1252"),
    "declared too late": (f"\n\n# coding: latin-1\n{NAMED}", "latin-1"),
    "an encoding that Python does not know": (f"# coding: latin-11\n{NAMED}", "latin-1"),
    "the same of plain letters": ("# coding: latin-11\na = 1\n", "ascii"),
    "no encoding of texts": ("# -*- coding: zlib -*-\na = 1\n", "ascii"),
    "no encoding of texts, on the second line": (f"{SHEBANG}# coding: rot13\na = 1\n", "ascii"),
    "an encoding of names": ("# coding: idna\na = 1\n", "ascii"),
    "an encoding of nothing": ("# coding: undefined\na = 1\n", "ascii"),
    "no encoding of texts, declared below code": ("a = 1\n# coding: zlib\n", "ascii"),
    "no encoding of texts, declared too late": ("\n\n# coding: zlib\n", "ascii"),
    "plus for letters": ("# coding: utf-7\na = 'ü'\n", "utf-7"),
}


@pytest.mark.parametrize(("text", "encoding"), FILES.values(), ids=FILES)
def test_what_python_reads_is_read(tmp_path: Path, text: str, encoding: str) -> None:
    path = tmp_path / "size.py"
    path.write_bytes(text.encode(encoding))
    spec = importlib.util.spec_from_file_location("size", path)
    assert spec is not None
    assert spec.loader is not None
    try:
        spec.loader.exec_module(importlib.util.module_from_spec(spec))
        said = ""
    except SyntaxError as error:
        said = error.msg
    source = read_source(path, "pk.size", "size.py")
    (told,) = text_faults(source) or [None]
    assert (said and source.fault and source.fault.msg) == said
    assert (told.code if told else None) == ("node-syntax" if said else None)
    assert bool(said) or source.text == text
