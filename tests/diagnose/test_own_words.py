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


LOGS = "        self.get_logger().{}\n"


@pytest.mark.parametrize(
    ("call", "line"),
    [
        ("error('empty')", "[ERROR] [talker]: empty"),
        ("warn('E42')", "[WARN] [talker]: E42"),
        ("error(f'no {self.count}')", "[ERROR] [talker]: no 7"),
        ("error('%d failed' % self.count)", "[ERROR] [talker]: 7 failed"),
        ("fatal('{} failed'.format(self.count))", "[FATAL] [talker]: 7 failed"),
        ("error(str(self.count))", "[ERROR] [hall.talker]: cannot go on"),
        ("get_child('pump').error('failed')", "[ERROR] [talker.pump]: failed"),
    ],
)
def test_what_an_own_logger_logs_is_no_error_however_short(tmp_path: Path, call: str, line: str) -> None:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, COUNT + LOGS.format(call))
    assert of_text(f"$ ros2 run my_bot talker\n{line}\n", files.write(tmp_path)) == []


@pytest.mark.parametrize(
    "line", ["[ERROR] [talker]: cannot open", "[ERROR] [rcl]: failed", "[ERROR] [rmw]: no"]
)
def test_what_another_logger_or_call_says_is_not_the_own_code(tmp_path: Path, line: str) -> None:
    call = "info('cannot open')" if "talker" in line else "error(str(self.count))"
    files = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, COUNT + LOGS.format(call))
    found = of_text(f"$ ros2 run my_bot talker\n{line} by rcl\n", files.write(tmp_path))
    assert not found or found[0].code in (UNKNOWN, "passed-on")


@pytest.mark.parametrize(
    ("descriptor", "said", "told"),
    [
        ("read_only=True", "Trying to set a read-only parameter: level.", "--ros-args -p level:=9"),
        ("description='x'", "Parameter level out of range. Min: 0, Max: 5, value: 9", "Min: 0, Max: 5"),
        ("", "the moon is full", UNKNOWN),
    ],
)
def test_a_refusal_that_the_declaration_asks_for_is_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, descriptor: str, said: str, told: str
) -> None:
    more = f", ParameterDescriptor({descriptor})" if descriptor else ""
    line = f"        self.declare_parameter('level', 3{more})\n"
    files = Files.right(NAME).change("PACKAGE/MODULE.py", COUNT, COUNT + line)
    files = files.change(
        "PACKAGE/MODULE.py",
        "import rclpy\n",
        "import rclpy\nfrom rcl_interfaces.msg import ParameterDescriptor\n",
    )
    monkeypatch.chdir(files.write(tmp_path))
    text = f"$ ros2 param set /talker level 9\nSetting parameter failed: {said}\n"
    shown = CliRunner().invoke(app, ["diagnose", "-"], input=text, env={"COLUMNS": "400"}).stdout
    assert told in shown
    assert ("Nothing was found" in shown) is bool(descriptor)
