"""Slips of typing that Python cannot read, in right packages of many styles: how many are undone to the letter."""

from __future__ import annotations

import ast
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from row import Quantity, Row

from ros2lab.diagnose.code.syntax_repairs import repairs_of
from ros2lab.diagnose.sources.python_source import read_source

TESTS = Path(__file__).parents[1] / "tests"
EACH = 6  # slips of a file
MOST = 10.0  # %, of those that may stay


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:
    """Make slips in all files of the styles of the corpus, and mend each file as its explanation says."""
    sys.path[:0] = [str(TESTS / "grading"), str(TESTS / "diagnose")]
    import corpus  # noqa: PLC0415
    from slips import unreadable  # noqa: PLC0415

    styles = [case for case in corpus.STYLES if case.assignment is None][:: 10 if is_quick else 1]
    count = stays = elsewhere = 0
    for done, case in enumerate(styles, 1):
        for text in _files(case):
            for slip in unreadable(text, EACH, seed=done):
                fault_line, mended = _mended(slip.text)
                count += 1
                stays += mended != ast.dump(ast.parse(text))
                elsewhere += fault_line != slip.line
        advance(done / len(styles))
    return [
        Row(
            f"slips of typing that are not undone to the letter, of {count} in {len(styles)} packages",
            Quantity(100 * stays / count, "%"),
            "those for which Python names another line",
            Quantity(100 * elsewhere / count, "%"),
            {"value": MOST},
        )
    ]


def _files(case: object) -> Iterator[str]:
    """Yield the Python files of a case, once for all that are alike."""
    with tempfile.TemporaryDirectory(prefix="ros2lab-slips-") as name:
        case.make(Path(name), {})
        texts = {path.read_text(encoding="utf-8-sig") for path in Path(name).rglob("*.py")}
    yield from sorted(text for text in texts if text.count("\n") > 1)


def _mended(text: str) -> tuple[int, str]:
    """Return the line that Python names, and the syntax tree of the file as mended; empty if Python cannot read it."""
    with tempfile.NamedTemporaryFile("w", suffix=".py", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        source = read_source(Path(file.name), "file", "file.py")
    assert not source.tree.body
    assert source.fault is not None
    lines = text.splitlines()
    for repair in repairs_of(text, source.fault):
        lines = repair.applied(lines)
    try:
        return source.fault.lineno or 0, ast.dump(ast.parse("\n".join([*lines, ""])))
    except SyntaxError:
        return source.fault.lineno or 0, ""
