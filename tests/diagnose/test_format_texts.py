"""Errors that come out of a format text: told is where it is written, and what is written there instead of what."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from one_file import printed_by
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

NAME = NAMES[1]
PROGRAM = """\
from std_msgs.msg import Float64

from my_bot.texts import LINE

FORMAT = CONSTANT


class Meter:
    FORM = CONSTANT

    def __init__(self):
        self.form = CONSTANT
        self.flow = 3.14
        self.word = 'open'
        self.count = 7

    def tick(self, msg):
        print(TICK)


Meter().tick(Float64(data=2.5))
"""
# A format text, how it is filled, and the place that is meant.
WRONG = {
    "no colon": ("'flow {0.1f} l'", "FORMAT.format(self.flow)", "{0:.1f}"),
    "no colon, by name": ("'flow {flow.2f} l'", "FORMAT.format(flow=self.flow)", "{flow:.2f}"),
    "a comma for the point": ("'flow {:,1f} l'", "FORMAT.format(self.flow)", "{:.1f}"),
    "the point after": ("'flow {:1f.} l'", "FORMAT.format(self.flow)", "{:.1f}"),
    "letter and digits exchanged": ("'flow {:f.2} l'", "FORMAT.format(self.flow)", "{:.2f}"),
    "a percent sign in braces": ("'flow {:%.1f} l'", "FORMAT.format(self.flow)", "{:.1f}"),
    "another name": ("'flow {folw} l'", "FORMAT.format(flow=self.flow)", "{flow}"),
    "a name with nothing of that name": ("'flow {flow} l'", "FORMAT.format(self.flow)", "{}"),
    "the name of something else": ("'{what}: {flow}'", "FORMAT.format(self.word, flow=self.flow)", "{}"),
    "a whole number of a float": ("'flow {:d} l'", "FORMAT.format(self.flow)", "{:.0f}"),
    "a number of a text": ("'valve {:.1f}'", "FORMAT.format(self.word)", "{}"),
    "an element of a number": ("'flow {0[x]} l'", "FORMAT.format(self.flow)", "{}"),
    "a field of a message": ("'flow {0.dta} l'", "FORMAT.format(msg)", "{0.data}"),
    "one too far": ("'flow {1} l'", "FORMAT.format(self.flow)", "{}"),
    "braces of JSON": ("'{\"flow\": {}}'", "FORMAT.format(self.flow)", "{{"),
    "a lone brace": ("'flow } {}'", "FORMAT.format(self.flow)", "}}"),
    "of the class": ("'flow {0.1f} l'", "self.FORM.format(self.flow)", "{0:.1f}"),
    "of the object": ("'flow {0.1f} l'", "self.form.format(self.flow)", "{0:.1f}"),
    "of another file": ("'flow {0.1f} l'", "LINE.format(self.flow)", "{0:.1f}"),
    "in place": ("''", "'flow {0.1f} l'.format(self.flow)", "{0:.1f}"),
    "percent, a number of a text": ("'valve %d'", "FORMAT % self.word", "%s"),
    "percent, a float of a text": ("'valve %.1f'", "FORMAT % self.word", "%s"),
    "percent, without its letter": ("'flow %.1'", "FORMAT % self.flow", "%.1f"),
    "percent, a lone sign": ("'%s: 50 % open'", "FORMAT % self.word", "%%"),
    "percent, another name": ("'flow %(folw)s'", "FORMAT % {'flow': self.flow}", "%(flow)s"),
    "an f-string, the point after": ("''", "f'flow {self.flow:1f.} l'", ":.1f"),
    "an f-string, a whole number of a float": ("''", "f'flow {self.flow:d} l'", ":.0f"),
    "an f-string, a number of a text": ("''", "f'valve {self.word:.2f}'", ""),
}  # fmt: skip
# What is wrong with a line beside a text that is right.
OTHERS = {
    "the value has no such attribute": ("'flow {:.1f} l'", "FORMAT.format(self.flow.data)", "AttributeError"),
    "the object has not": ("'flow {:.1f} l'", "FORMAT.format(self.flwo)", "AttributeError"),
    "a list has none": ("'flow {} l'", "FORMAT.format([][0])", "IndexError"),
    "a key": ("'flow {} l'", "FORMAT.format({'a': 1}['b'])", "KeyError"),
}


def told(root: Path, constant: str, tick: str) -> tuple[Finding, str]:
    """Run a program, and return what is said of its error, with the error."""
    files = Files.right(NAME)
    files.put("PACKAGE/texts.py", f"# Texts\nLINE = {constant}\n")
    files.put("PACKAGE/meter.py", PROGRAM.replace("CONSTANT", constant).replace("TICK", tick)).write(root)
    printed = run(root / files.path("PACKAGE/meter.py"))
    assert "Error" in printed, printed
    return of_text(printed, root)[0], printed.splitlines()[-1]


def run(file: Path) -> str:
    path = f"{file.parents[1]}:{os.environ.get('PYTHONPATH', '')}"
    return printed_by(file, environ={**os.environ, "PYTHONPATH": path})


@pytest.mark.parametrize(("constant", "tick", "meant"), WRONG.values(), ids=WRONG)
def test_the_text_is_written_as_is_told(tmp_path: Path, constant: str, tick: str, meant: str) -> None:
    finding, error = told(tmp_path, constant, tick)
    match = re.match(r"write `(?P<new>.*?)` instead of `(?P<old>.+?)`", finding.fix)
    assert match, (finding, error)
    assert meant in match["new"]
    name, _, number = finding.place.rpartition(":")
    lines = (tmp_path / name).read_text().splitlines()
    assert match["old"] in lines[int(number) - 1]
    lines[int(number) - 1] = lines[int(number) - 1].replace(match["old"], match["new"])
    (tmp_path / name).write_text("\n".join(lines))
    printed = run(tmp_path / f"src/{NAME.package}/{NAME.package}/meter.py")
    assert "Error" not in printed, (finding, printed)


@pytest.mark.parametrize(("constant", "tick", "error"), OTHERS.values(), ids=OTHERS)
def test_a_text_that_is_right_is_not_blamed(tmp_path: Path, constant: str, tick: str, error: str) -> None:
    finding, said = told(tmp_path, constant, tick)
    assert said.startswith(error)
    assert "format string" not in finding.cause
