"""What is compared of a submission: its Python, whatever it is called, and what of its texts is Python, too."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ros2lab.classroom.one import _sources, texts_of_code

CODE = "import rclpy\n\n\ndef main():\n    rclpy.init()\n"
WORDS = f"Words first.\n{CODE}"
RUNS = "from pathlib import Path\nexec(Path(__file__).with_suffix('{}').read_text())\n"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (CODE, [CODE]),
        (f"exec({CODE!r})\n", [f"exec({CODE!r})\n", CODE]),
        (f"exec({CODE.encode()!r})\n", [f"exec({CODE.encode()!r})\n", CODE]),
        (f"TEXT = {CODE!r}\nexec(TEXT)\n", [f"TEXT = {CODE!r}\nexec(TEXT)\n", CODE]),
        ("print('''two\nlines of prose''')\n", ["print('''two\nlines of prose''')\n"]),
        ("Drive the robot.\n\n    import rclpy\n", []),
        ('{"linear": 1}\n', []),
        ("rclpy\n", []),
        (f"# Robot\n\n```python\n{CODE}```\n\nIt drives (fast).\n", [CODE.strip()]),
        (f"'Words first.' + {CODE!r}", [CODE]),
        (f"TEXT = {WORDS!r}\n", [CODE]),
        (json.dumps({"cells": [{"source": CODE.splitlines(keepends=True)}]}, indent=1), [CODE]),
        ("import a\njunk here\nf(1)\nmore junk\ndef g():\n    f(2)", ["import a\nf(1)\ndef g():\n    f(2)"]),
        ("x" * 1000 + "(" * 1000, []),
        ("\0", []),
    ],
)
def test_texts_that_are_python_are_found(text: str, found: list[str]) -> None:
    assert [*texts_of_code(text)] == found


@pytest.mark.parametrize("suffix", [".txt", ".dat", ""])
def test_python_is_compared_whatever_its_file_is_called(suffix: str, tmp_path: Path) -> None:
    folder = tmp_path / "package"
    folder.mkdir()
    (folder / "node.py").write_text(RUNS.format(suffix))
    (folder / f"node{suffix}").write_text(CODE)
    (folder / "README.md").write_text("# Robot\n\nIt drives.\n")
    (folder / "picture.png").write_bytes(b"\x89PNG\r\n\x1a\n" * 100)
    (folder / "broken.py").write_text("def main(:\n")
    found = _sources(tmp_path, ["package"], [])
    assert found.keys() == {"package/node.py", f"package/node{suffix}", "package/broken.py"}
    assert found[f"package/node{suffix}"] == CODE


@pytest.mark.parametrize("codec", ["utf-8", "latin-1", "utf-7", "unicode_escape", "raw_unicode_escape", "hz"])
def test_python_is_read_in_the_encoding_that_it_declares(codec: str, tmp_path: Path) -> None:
    """What another reader would see in the bytes is not what runs."""
    folder = tmp_path / "package"
    folder.mkdir()
    data = CODE.encode() if codec == "latin-1" else CODE.encode(codec)
    escaped = "".join(f"\\u{ord(sign):04x}" for sign in CODE).encode()
    (folder / "node.py").write_bytes(
        f"# coding: {codec}\n".encode() + (escaped if "escape" in codec else data)
    )
    found = _sources(tmp_path, ["package"], [])
    assert found == {"package/node.py": f"# coding: {codec}\n{CODE}"}
