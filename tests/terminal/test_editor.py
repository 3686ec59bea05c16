"""`%%editor` in a notebook: the cell is saved as a file, and nothing that a student wrote is lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from IPython.core.error import UsageError
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config

from ros2lab.terminal import editor, load_ipython_extension

Cell = Callable[[str, str], str]


@pytest.fixture
def cell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Iterator[Cell]:
    """Return a function that runs a cell, its path and its text, and returns what it shows."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    monkeypatch.setattr(editor, "_written", {})
    shell = InteractiveShell.instance(config=Config({"HistoryManager": {"enabled": False}}))
    load_ipython_extension(shell)

    def run(path: str, text: str) -> str:
        shell.run_cell_magic("editor", path, text)
        return capsys.readouterr().out

    yield run
    InteractiveShell.clear_instance()


def test_a_cell_becomes_a_file(cell: Cell, tmp_path: Path) -> None:
    assert cell("~/node.py", "x = 'ü'\ny = 2\n") == "~/node.py: 2 lines\n"
    assert (tmp_path / "node.py").read_text(encoding="utf-8") == "x = 'ü'\ny = 2\n"
    assert cell("sub.py", "x") == "~/sub.py: 1 line\n"
    assert (tmp_path / "sub.py").read_text() == "x\n"


def test_a_name_may_have_blanks(cell: Cell, tmp_path: Path) -> None:
    for name in ('"~/my node.py"', "~/your node.py"):
        cell(name, "x\n")
    assert (tmp_path / "my node.py").read_text() == (tmp_path / "your node.py").read_text() == "x\n"


def test_a_name_must_be_there(cell: Cell) -> None:
    with pytest.raises(UsageError, match="Which file"):
        cell("", "x\n")


@pytest.mark.parametrize("name", ["~/src", "src/", "'~/new folder/'", "~", "/"])
def test_a_folder_is_no_file(cell: Cell, tmp_path: Path, name: str) -> None:
    (tmp_path / "src").mkdir()
    with pytest.raises(UsageError, match="names a folder: write a file's name after it"):
        cell(name, "x\n")
    assert [path.name for path in tmp_path.iterdir()] == ["src"]


def test_running_a_cell_again_keeps_no_copies(cell: Cell, tmp_path: Path) -> None:
    for text in ("one\n", "two\n", "two\n", "three\n"):
        assert cell("~/node.py", text) == "~/node.py: 1 line\n"
    assert not (tmp_path / "earlier").exists()


def test_what_somebody_else_wrote_is_kept(cell: Cell, tmp_path: Path) -> None:
    cell("~/node.py", "from the cell\n")
    (tmp_path / "node.py").write_text("from another editor\n")
    assert cell("~/node.py", "from the cell\n").endswith("what was there before is in ~/earlier\n")
    assert (tmp_path / "earlier" / "node.py-1").read_text() == "from another editor\n"
    assert (tmp_path / "node.py").read_text() == "from the cell\n"


def test_an_empty_or_equal_file_need_not_be_kept(cell: Cell, tmp_path: Path) -> None:
    (tmp_path / "empty.py").touch()
    (tmp_path / "equal.py").write_text("x\n")
    cell("~/empty.py", "x\n")
    cell("~/equal.py", "x\n")
    assert not (tmp_path / "earlier").exists()


def test_a_folder_that_is_not_there_is_told(cell: Cell) -> None:
    with pytest.raises(FileNotFoundError, match=r"no folder ~/nowhere/src: make it first"):
        cell("~/nowhere/src/node.py", "x\n")


def test_a_script_stays_a_script_and_a_link_a_link(cell: Cell, tmp_path: Path) -> None:
    (tmp_path / "script.sh").write_text("#!/bin/sh\n")
    (tmp_path / "script.sh").chmod(0o755)
    (tmp_path / "link.sh").symlink_to("script.sh")
    cell("~/link.sh", "#!/bin/bash\n")
    assert (tmp_path / "link.sh").is_symlink()
    assert (tmp_path / "script.sh").read_text() == "#!/bin/bash\n"
    assert (tmp_path / "script.sh").stat().st_mode & 0o777 == 0o755
