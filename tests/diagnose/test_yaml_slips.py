"""A slip of typing in YAML or setup.cfg: what is told, done literally, gives the file that was meant."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable

import pytest
import yaml

from ros2lab.diagnose.launching.entity_words import entity_repair
from ros2lab.diagnose.sources.parameter_file import parameter_file_repair
from ros2lab.diagnose.sources.setup_cfg import cfg_repair
from ros2lab.diagnose.sources.slips import Slip, Vocabulary
from ros2lab.diagnose.sources.yaml_slips import yaml_repair

PARAMETERS = """\
# of two nodes
talker:
  ros__parameters:
    period: 0.5
    limits:
      upper: 10
      lower: -3
    colours: ['red', 'blue']
motor:
  ros__parameters:
    gains: [1.0, 0.5]
"""
LAUNCH = """\
launch:
  - arg:
      name: floor
      default: ground
  - node:
      pkg: museum
      exec: guide
      param:
        - name: room
          value: cellar
  - node:
      pkg: museum
      exec: lamp
"""
OTHER = """\
common: &common
  speed: 3.0
lifts:
  gondola:
    <<: *common
    seats: 8
  chair:
    <<: *common
    seats: 2
"""


def of_launch(text: str) -> Slip | None:
    return entity_repair(text, is_xml=False)


FILES: dict[str, tuple[str, Callable[[str], Slip | None]]] = {
    "parameters": (PARAMETERS, parameter_file_repair),
    "launch": (LAUNCH, of_launch),
    "other": (OTHER, parameter_file_repair),
}
KINDS: dict[str, tuple[str, str]] = {  # what is written instead of what
    "no space after the colon": (r"(?<=[\w<]): ", ":"),
    "no colon": (r"(?<=\w):(?=\s)", ""),
    "too deep": (r"(?m)^(?= )", "  "),
    "no bracket at the end": (r"\]$", ""),
    "a misspelt alias": (r"\*common", "*comon"),
}


def mutants(text: str, pattern: str, new: str) -> list[str]:
    matches = [
        m for m in re.finditer(pattern, text, re.MULTILINE) if not text[: m.start()].endswith("launch")
    ]
    return [text[: match.start()] + new + text[match.end() :] for match in matches]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("file", FILES)
def test_nearly_every_slip_is_undone(file: str, kind: str) -> None:
    text, repair = FILES[file]
    found = [repair(broken) for broken in mutants(text, *KINDS[kind])]
    told = [slip for slip in found if slip]
    # What is still read may mean something else, and where two lines may be moved either may be meant.
    right = [slip for slip in told if yaml.safe_load(slip.text) == yaml.safe_load(text)]
    assert len(right) >= 0.8 * len(told)
    assert all(slip.told.startswith(("write `", "add `")) for slip in right)


@pytest.mark.parametrize("file", FILES)
def test_a_tab_becomes_the_spaces_of_its_neighbours(file: str) -> None:
    text, repair = FILES[file]
    broken = re.sub(r"(?m)^ +", "\t", text, count=1)
    slip = repair(broken)
    assert slip is not None
    assert "\t" not in slip.text
    assert "tab" in slip.why


@pytest.mark.parametrize("file", FILES)
def test_what_is_right_is_left(file: str) -> None:
    text, repair = FILES[file]
    assert repair(text) is None


@pytest.mark.parametrize(
    ("broken", "line", "told"),
    [
        ("lanch:\n  - node: {pkg: a, exec: b}\n", 1, "write `launch:`"),
        (LAUNCH.replace("  - node:\n      pkg: museum\n      exec: lamp", "  node:\n      pkg: museum\n      exec: lamp"), 11, "write `- node:`"),
    ],
)  # fmt: skip
def test_a_launch_file_is_one_of_launch(broken: str, line: int, told: str) -> None:
    slip = of_launch(broken)
    assert slip is not None
    assert (slip.line, slip.told) == (line, told)


def test_an_xml_launch_file_is_repaired() -> None:
    text = '<launch>\n  <node pkg="a" exec="b">\n    <param name="c" value="1"/>\n  </node>\n</launch>\n'
    for broken, line, was in (
        (text.replace("</node>", "<node>"), 4, "</node>"),
        (text.replace('"1"/>', '"1">'), 3, '<param name="c" value="1"/>'),
        (text.replace('exec="b"', 'exec="b'), 2, '<node pkg="a" exec="b">'),
        (text.replace("</launch>", "</lanch>"), 5, "</launch>"),
    ):
        slip = entity_repair(broken, is_xml=True)
        assert slip is not None
        assert (slip.line, slip.told) == (line, f"write `{was}`")


def test_aliases_of_aliases_are_not_followed() -> None:
    pairs = itertools.pairwise("abcdefghijklmnopqrstu")  # what they stand for would never be read to its end
    bomb = "a: &a [x, x]\n" + "".join(f"{name}: &{name} [*{old}, *{old}, *{old}]\n" for old, name in pairs)
    slip = parameter_file_repair(f"{bomb}z:1\ny: 1\n")
    assert slip is not None
    assert slip.told == "write `z: 1`"


CFG = "[develop]\nscript_dir=$base/lib/bot\n[install]\ninstall_scripts=$base/lib/bot\n"
WANTED = {"develop": ("script_dir", "$base/lib/bot"), "install": ("install_scripts", "$base/lib/bot")}


@pytest.mark.parametrize(
    ("was", "wrong"),
    [
        ("install_scripts=$base/lib/bot", "installscripts=$base/lib/bot"),
        ("install_scripts=$base/lib/bot", "install_scripts=$baselib/bot"),
        ("install_scripts=$base/lib/bot", "install_scripts$base/lib/bot"),
        ("script_dir=$base/lib/bot", "script_dir=$bae/lib/bot"),
        ("[install]", "[instal]"),
        ("[install]", "install]"),
    ],
)
def test_a_line_of_setup_cfg_is_written_as_it_should_be(was: str, wrong: str) -> None:
    slip = cfg_repair(CFG.replace(was, wrong), WANTED)
    assert slip is not None
    assert slip.told == f"write `{was}`"
    assert slip.text == CFG


@pytest.mark.parametrize("line", CFG.splitlines())
def test_a_line_that_setup_cfg_lacks_is_added(line: str) -> None:
    slip = cfg_repair(CFG.replace(f"{line}\n", "", 1), WANTED)
    assert slip is not None
    assert slip.told.startswith(f"add `{line}` ")
    assert slip.text.strip() == CFG.strip()


BODY = "talker:\n  ros__parameters:\n    speed: 1.0\n"


@pytest.mark.parametrize(
    ("head", "told"),
    [
        ('#!/usr/bin/env python3\n"""\nGains.\n\nDepends: nav\n  sudo apt install nav\n- a: b\n"""\n', "write # at the beginning of lines 2 to 8"),
        ('"""Gains."""\n', "write # at the beginning of line 1"),
        ("'''Gains: all'''\n", "write # at the beginning of line 1"),
        ("/* gains\n * of the wheels: both\n */\n", "write # at the beginning of lines 1 to 3"),
        ("// gains\n// of both: yes\n", "write # at the beginning of line 1 and of line 2"),
        ("These are the gains.\n", "write `# These are the gains.`"),
    ],
)  # fmt: skip
def test_a_comment_of_another_language_is_made_one(head: str, told: str) -> None:
    slip = yaml_repair(head + BODY, Vocabulary(()))
    assert slip is not None
    assert slip.told == told
    assert yaml.safe_load(slip.text) == yaml.safe_load(BODY)


@pytest.mark.parametrize("text", ['a: |\n  """\n  // b\n', "a: http://b // c\n", "a: 'b /* c */'\n# // d\n"])
def test_signs_in_a_text_are_no_comment(text: str) -> None:
    assert yaml_repair(text, Vocabulary(())) is None
