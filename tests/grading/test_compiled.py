"""What boxes import is compiled before, for they cannot write it."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

from ros2lab.grading.sandbox import compiled


def test_what_is_not_compiled_as_it_is_now_is_compiled(tmp_path: Path) -> None:
    new, changed, locked = (tmp_path / name for name in ("new.py", "changed.py", "locked/module.py"))
    locked.parent.mkdir()
    (locked.parent / "__pycache__").write_text("in the place of the folder")
    for path in (new, changed, locked):
        path.write_text("x = 1\n")
    compiled.compile_modules([changed])
    before = _compiled(changed).read_bytes()
    changed.write_text("x = 'another'\n")
    os.utime(changed, (1, 1))
    assert compiled.compile_modules([new, changed, locked]) == 2
    assert _compiled(new).is_file()
    assert _compiled(changed).read_bytes() != before


def test_what_is_compiled_stays_as_it_is(tmp_path: Path) -> None:
    source = tmp_path / "module.py"
    source.write_text("x = 1\n")
    compiled.compile_modules([source])
    os.utime(_compiled(source), ns=(0, 0))
    assert compiled.compile_modules([source]) == 1
    assert _compiled(source).stat().st_mtime_ns == 0


@pytest.mark.parametrize(
    "module", ["colcon_core.command", "setuptools.command.egg_info", "_pytest.main", "launch", "yaml"]
)
def test_what_boxes_import_is_among_the_sources(module: str) -> None:
    spec = importlib.util.find_spec(module)
    assert spec
    assert spec.origin
    assert Path(spec.origin) in {*compiled.imported()}


@pytest.mark.parametrize("module", ["watching.observer", "reading.reader"])
def test_a_program_of_a_box_imports_nothing_of_the_lab_that_it_does_not_need(module: str) -> None:
    code = f"import sys, ros2lab.grading.{module}; print(*sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert {*said.split()}.isdisjoint({"ros2lab.workspace", "psutil", "IPython", "matplotlib", "typer"})


def _compiled(source: Path) -> Path:
    return Path(importlib.util.cache_from_source(str(source)))
