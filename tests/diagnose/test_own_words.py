"""Refusals and errors that the student's own code words: they are no error of ROS, and are told with their line."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner
from workspace_files import NAMES, Files

from ros2lab.cli import app
from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import UNKNOWN

NAME = NAMES[1]
COUNT = "        self.count = 0\n"
SET = "$ ros2 param set /talker period 9.0\nSetting parameter failed: {}\n"
SAYS = {
    "a refusal": ("        self.says = dict(successful=False, reason='steady or blink')\n", "steady or blink"),
    "with a value": ("        self.says = f'level {self.count} is too high'\n", "level 7 is too high"),
    "with percent": ("        self.says = 'only these are allowed: %s' % self.count\n", "only these are allowed: 7"),
    "over lines": ("        self.says = ('this level is '\n                     'beyond the limit')\n", "this level is beyond the limit"),
    "a constant": ("        self.says = self.SAYS\n\n    SAYS = 'not while it is driving'\n", "not while it is driving"),
}  # fmt: skip


@pytest.mark.parametrize("form", SAYS)
def test_words_of_the_own_code_are_known_with_their_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    line, said = SAYS[form]
    root = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, COUNT + line).write(tmp_path)
    monkeypatch.chdir(root)
    text = SET.format(said)
    assert of_text(text, root) == []
    shown = CliRunner().invoke(app, ["diagnose", "-"], input=text, env={"COLUMNS": "400"}).stdout
    assert "a message of your own code" in shown
    file, _, number = shown.partition("Python: ")[2].partition(")")[0].rpartition(":")
    assert line.strip().splitlines()[0].split("'")[0].split("(")[0] in (root / file).read_text()
    assert any(word in (root / file).read_text().splitlines()[int(number) - 1] for word in said.split()[:3])


def test_other_words_are_still_not_known(tmp_path: Path) -> None:
    root = Files.right(NAME).write(tmp_path)
    (found,) = of_text(SET.format("the moon is full"), root)
    assert found.code == UNKNOWN
