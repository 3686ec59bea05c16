"""Keys that are not there: compared with the file that is read, with what was typed, or with the dictionary itself."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

NAME = NAMES[1]
PROGRAM = """\
import configparser
import csv
import json
import os
from pathlib import Path

import yaml

FILE = Path(__file__).parent.parent / 'config' / 'DATA'


def tick():
    LINES


tick()
"""
CSV = "with open(FILE, encoding='utf-8') as file:\n        rows = list(csv.DictReader(file, delimiter=';'))\n    row = rows.pop(0)\n    print(row['name'])"
PLAIN = "rows = list(csv.DictReader(open(FILE)))\n    print(rows[0]['name'])"
YAML = "config = yaml.safe_load(FILE.read_text())\n    print(config['speed'])"
JSON = "with open(FILE) as file:\n        config = json.load(file)\n    print(config['speed'])"
# A file, what it says, the program that reads it, what is said of the key, and what is written instead of what.
FILES = {
    "a mark at the beginning": ("fields.csv", "\ufeffname;x\na;1\n", CSV, "byte order mark", "encoding='utf-8-sig'", "encoding='utf-8'"),
    "a mark, and no encoding": ("fields.csv", "\ufeffname,x\na,1\n", PLAIN, "byte order mark", "open(FILE, encoding='utf-8-sig')", "open(FILE)"),
    "a capital": ("fields.csv", "Name;x\na;1\n", CSV, "its key is 'Name'", "'Name'", "'name'"),
    "a space": ("fields.csv", "x; name\n1;a\n", CSV, "spaces around it", "' name'", "'name'"),
    "another separator": ("fields.csv", "name,x\na,1\n", CSV, "separates its columns with ','", "delimiter=','", "delimiter=';'"),
    "no separator given": ("fields.csv", "name;x\na;1\n", PLAIN, "separates its columns with ';'", "csv.DictReader(open(FILE), delimiter=';')", "csv.DictReader(open(FILE))"),
    "a deeper key": ("robot.yaml", "robot:\n  speed: 1.0\n", YAML, "is below 'robot'", "config['robot']['speed']", "config['speed']"),
    "almost the key": ("robot.json", '{"spede": 1.0}', JSON, "its key is 'spede'", "'spede'", "'speed'"),
    "almost the key, in YAML": ("robot.yaml", "Speed: 1.0\n", YAML, "its key is 'Speed'", "'Speed'", "'speed'"),
}  # fmt: skip


def failed(root: Path, name: str, data: str, lines: str) -> tuple[Finding, Path]:
    """Run a program that reads a file, and return what is said of its error."""
    files = Files.right(NAME)
    files.put(f"config/{name}", "").put(
        "PACKAGE/read.py", PROGRAM.replace("DATA", name).replace("LINES", lines)
    )
    files.write(root)
    (root / files.path(f"config/{name}")).write_text(data, encoding="utf-8")
    file = root / files.path("PACKAGE/read.py")
    printed = run(file)
    assert "KeyError" in printed, printed
    return of_text(printed, root)[0], file


def run(file: Path, **variables: str) -> str:
    return subprocess.run(
        [sys.executable, file],
        env={**os.environ, **variables},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
        check=False,
    ).stdout


@pytest.mark.parametrize("case", FILES.values(), ids=FILES)
def test_a_key_is_compared_with_those_of_the_file(tmp_path: Path, case: tuple[str, ...]) -> None:
    """What is told is written, and then the program runs."""
    name, data, lines, cause, new, old = case
    finding, file = failed(tmp_path, name, data, lines)
    assert cause in finding.cause, finding
    text = file.read_text()
    number = int(finding.place.rpartition(":")[2])
    if "delimiter" in finding.fix and "csv" in finding.fix:
        new, old = finding.fix.removeprefix("write ").split(" instead of ")
    else:
        assert finding.fix == f"write {new} instead of {old}"
    mended = text.splitlines()
    assert old in mended[number - 1]
    mended[number - 1] = mended[number - 1].replace(old, new)
    file.write_text("\n".join(mended))
    assert "Error" not in run(file)


def test_a_key_that_the_file_has_not_is_not_guessed(tmp_path: Path) -> None:
    finding, _ = failed(tmp_path, "robot.json", '{"wheels": 2, "height": 1}', JSON)
    assert "it has 'wheels', 'height'" in finding.cause
    assert "if 'speed' in" not in finding.fix


def test_an_installed_file_that_was_not_built_again(tmp_path: Path) -> None:
    lines = JSON.replace(
        "open(FILE)", f"open({str(tmp_path / 'install/my_bot/share/my_bot/config/robot.json')!r})"
    )
    old = tmp_path / "install/my_bot/share/my_bot/config/robot.json"
    old.parent.mkdir(parents=True)
    old.write_text("{}")
    finding, _ = failed(tmp_path, "robot.json", '{"speed": 2}', lines)
    assert finding.code == "install-stale"
    assert finding.fix.startswith("colcon build --packages-select my_bot")


@pytest.mark.parametrize(
    ("lines", "fix"),
    [
        ("speeds = {'slow': 1, 'fast': 2}\n    print(speeds['quick'])", "use one of these instead of 'quick'"),
        ("speeds = {'slow': 1, 'fast': 2}\n    print(speeds['Slow'])", "write 'slow' instead of 'Slow'"),
        ("words = dict(zip('ab', 'cd'))\n    print(words['c'])", "print words on the line above"),
        ("word, speeds = os.sep, {'slow': 1}\n    print(speeds[word])", "write these two lines above line 14: `if word not in speeds:`, and indented below it `return`"),
        ("speeds = {'a': 1}\n    for word in 'ab':\n        print(speeds[word])", "write these two lines above line 15: `if word not in speeds:`, and indented below it `continue`"),
        ("word, speeds = os.sep, {'slow': 1}\n    return speeds[word]", "write speeds.get(word, ...) instead of speeds[word], with a default for missing keys"),
    ],
)  # fmt: skip
def test_a_key_of_a_dictionary_of_ones_own(tmp_path: Path, lines: str, fix: str) -> None:
    finding, _ = failed(tmp_path, "robot.json", "{}", lines)
    assert finding.fix.startswith(fix), finding


# What was typed before the program, and what is to be typed.
TYPED = {
    "not exported": ("$ ROBOT=anna\n$ echo $ROBOT\nanna", "export ROBOT=anna"),
    "not exported, in one line": ("$ ROBOT='anna b'; echo $ROBOT\nanna b", "export ROBOT='anna b'"),
    "another name": ("$ export ROBOTT=anna", "export ROBOT=anna"),
    "another terminal": (
        "$ export ROBOT=anna\n# terminal 2\n$ source install/setup.bash",
        "export ROBOT=anna",
    ),
    "as in another shell": ("$ set ROBOT=anna", "export ROBOT=anna"),
    "spaces": ("$ ROBOT = anna\nROBOT: command not found", "export ROBOT=anna"),
    "kept for later": ("$ echo 'export ROBOT=anna' >> ~/.bashrc", "source ~/.bashrc"),
    "taken away": ("$ export ROBOT=anna\n$ unset ROBOT", "export ROBOT=..."),
    "never set": ("$ source install/setup.bash", "export ROBOT=..."),
}


@pytest.mark.parametrize("access", ["os.environ['ROBOT']", "environ['ROBOT']"])
@pytest.mark.parametrize(("typed", "command"), TYPED.values(), ids=TYPED)
def test_a_variable_of_the_terminal(tmp_path: Path, typed: str, command: str, access: str) -> None:
    files = Files.right(NAME)
    text = f"import os\nfrom os import environ\n\nname = {access}\nprint(name)\n"
    files.put("PACKAGE/named.py", text).write(tmp_path)
    file = tmp_path / files.path("PACKAGE/named.py")
    said = run(file)
    assert "KeyError: 'ROBOT'" in said
    finding, *_ = of_text(f"{typed}\n$ ros2 run my_bot named\n{said}", tmp_path)
    assert f"type `{command}`" in finding.fix, finding
    assert "if 'ROBOT' in" not in finding.fix
    assert run(file, ROBOT="anna") == "anna\n"
