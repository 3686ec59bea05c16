"""Why something was never carried out while a program ran: each step of the reason, and the values in lines that failed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import STRING, build, run_of
from workspace_files import NAMES, Files

from ros2lab import assignments
from ros2lab.diagnose.finding import SAID, Finding
from ros2lab.diagnose.look import Look
from ros2lab.grading.evidence import Heard
from ros2lab.trial import try_out
from ros2lab.trial.failing import with_values
from ros2lab.trial.held_back import with_reasons
from ros2lab.trial.seen import Seen
from ros2lab.trial.witnessed import Witnessed, environ_in, witnessed

NAME = NAMES[0]
ROBOT = """\
class Robot:
    def __init__(self):
        self.count = 0
        self.ready = False
        self.state = 'idle'
        self.items = [1, 2, 3]

    def publish(self, message):
        pass

    def on_ready(self):
        self.ready = True

    def calibrate(self):
        if self.count > 90:
            self.on_ready()

    def done(self):
        return self.state, self.ready, self.items

    def tick(self):
        self.count += 3
        BODY

    def keep(self):
        self.kept = self.count

    def count_subscribers(self, topic):
        return 1 - self.get_subscription_count()

    def get_subscription_count(self):
        return 0

    def get_logger(self):
        return self


def main():
    robot = Robot()
    for _ in range(5):
        robot.tick()


main()
"""
FIRST = ROBOT[: ROBOT.index("BODY")].count("\n") + 1  # the line of the body


def noted(body: str, folder: Path) -> Witnessed:
    """Return what a program notes with something in the method that is called five times."""
    files = Files.right(NAME)
    code = ROBOT.replace("BODY", body.replace("\n", "\n        "))
    root = files.put("node", code).write(folder / "ws")
    notes = folder / "notes"
    notes.mkdir()
    environ = {**os.environ, **environ_in(notes, root, {})}
    command = [sys.executable, "-c", f"import {NAME.package}.{Path(files.path('node')).stem}"]
    subprocess.run(command, cwd=root / "src" / NAME.package, env=environ, capture_output=True, check=False)
    return witnessed(notes, Look(root))


def told(body: str, folder: Path) -> tuple[list[Finding], list[Finding]]:
    """Return the findings and the notes on what was not reached."""
    what = noted(body, folder)
    seen = Seen(what.unreached.look, assignments.load(), [], [])
    found, notes, _ = with_reasons(what.wrong, [], what, seen)
    return found, notes


SEND = "self.publish(self.count)"


@pytest.mark.parametrize(
    ("body", "words", "line"),
    [
        (f"if self.count % 7 > 20: {SEND}", ["`self.count % 7 > 20` was never true in 5 checks (self.count % 7 was between 1 and 6)"], 0),
        (f"if self.ready and self.count: {SEND}", ["self.ready was False in 5 checks", "line 12 in on_ready(), was not reached: on_ready() was never called, as line 16"], 14 - FIRST),
        (f"if self.count > 0 and self.state == 'busy': {SEND}", ["`self.state == 'busy'` was never true in 5 checks (self.state was 'idle' each time)", "nothing in the code sets it to another value"], 0),
        (f"if self.state == 'busy' or self.ready: {SEND}", ["self.state was 'idle' each time", " and self.ready was False in 5 checks"], 0),
        (f"if self.count < 12 and -self.count > 9: {SEND}", ["`-self.count > 9` was never true in 3 checks", "only asked when `self.count < 12` is true"], 0),
        (f"if self.count > 2: pass\nelif self.count > 8: {SEND}", ["`self.count > 2` was always true in 5 checks"], 0),
        (f"if self.count % 7 < 90:\n    return\n{SEND}", ["`return` on line 24 came first each time, because `self.count % 7 < 90` was always true"], 0),
        (f"for one in self.items:\n    if one < 5: continue\n    {SEND}", ["`continue` on line 24 came first", "(one was between 1 and 3)"], 1),
        (f"for one in self.items[3:]: {SEND}", ["the loop over self.items[3:] on line 23 had nothing to go through"], 0),
        (f"try:\n    total = self.items[7]\n    {SEND}\nexcept Exception:\n    pass", ["line 24 failed with IndexError: list index out of range (self.items was a list of 3 (1, 2, 3))", "the `except` on line 26 caught 5 times"], 1),
        (f"match self.state:\n    case 'busy': {SEND}", ["`case 'busy'` was never taken (self.state was 'idle' each time)"], 1),
        (f"match self.count % 7 > 20:\n    case True: {SEND}", ["`case True` was never taken (self.count % 7 > 20 was False each time)"], 1),
        (f"match self.count % 7 > 20 and not self.ready:\n    case True: {SEND}", ["`case True` was never taken"], 1),
        (f"if not (self.count % 7 < 99 or self.ready): {SEND}", ["`self.count % 7 < 99` was always true in 5 checks"], 0),
        (f"if 90 < self.count % 7 < 99: {SEND}", ["`90 < self.count % 7 < 99` was never true in 5 checks (self.count % 7 was between 1 and 6)"], 0),
        (f"ready = self.count > 3\nif self.ready: {SEND}", ["self.ready was False"], None),
        (f"self.state = 'idle'\nif self.state == 'busy': {SEND}\nself.state = 'busy'", ["self.state was 'idle' each time", "line 23 set it to 'idle' 5 times"], 0),
        (f"if not self.ready and self.count % 7 < 90: pass\nelif not self.ready:\n    self.ready = True\n    {SEND}", ["`self.count % 7 < 90` was always true in 5 checks (self.count % 7 was between 1 and 6)"], 0),
        (f"if self.state == 'idle':\n    pass\nelse:\n    {SEND}\n    self.state = 'done'", ["`self.state == 'idle'` was always true in 5 checks (self.state was 'idle' each time)"], 0),
        (f"if self.count > 3: pass\nelif self.ready: {SEND}", ["`self.count > 3` on line 23 was true 4 of 5 times, and where line 24 was reached, self.ready was False in the only check"], 0),
        (f"if self.count > 3: return\nif not self.ready: return\n{SEND}", ["`return` on line 23 came first 4 of 5 times, and where line 24 was reached, `return` on line 24 came first each time"], 0),
        (f"for one in self.items:\n    if one > 1: continue\n    if self.ready: {SEND}", ["`continue` on line 24 came first 10 of 15 times, and where line 25 was reached"], 1),
        (f"if self.count < 4:\n    self.ready = False\n    if self.ready: {SEND}", ["`self.count < 4` on line 23 was not true 4 of 5 times"], 0),
        (f"if self.count < 7: return\nif self.ready: {SEND}", ["`return` on line 23 came first 2 of 5 times, and where line 24 was reached, self.ready was False in 3 checks"], None),
        (f"if self.count < 4: return\nif self.ready: {SEND}", [": self.ready was False in 4 checks"], None),
    ],
)  # fmt: skip
def test_the_reason_is_followed(tmp_path: Path, body: str, words: list[str], line: int | None) -> None:
    _, notes = told(body, tmp_path)
    (note,) = [note for note in notes if SEND in note.cause]
    assert all(word in note.cause for word in words), note.cause
    assert all(note.cause.count(test) == 1 for test in re.findall("`[^`]+` was [an]", note.cause)), note.cause
    assert line is None or note.place.endswith(f":{FIRST + line}"), note.place


@pytest.mark.parametrize(
    "body",
    [
        SEND,
        f"if self.count > 3: {SEND}",
        f"try: {SEND}\nexcept Exception: self.ready = True",
        "if self.count > 99: print('never')",  # nothing else depends on it
        f"if self.count > 99: raise RuntimeError\n{SEND}",
        f"if self.count > 20: {SEND}",  # it goes there
        f"if 20 - self.count < 0: {SEND}",
        f"if self.count < 90: return\n{SEND}",
        f"try:\n    raise KeyboardInterrupt\n    {SEND}\nexcept KeyboardInterrupt: pass",
        # Trouble that did not come:
        f"if self.ready:\n    self.get_logger().warning('full')\n    return\n{SEND}",
        f"if self.ready:\n    print('full')\n    return\n{SEND}",
        f"if self.count:\n    {SEND}\nelse:\n    self.get_logger().error('no count')",
        # What watches is counted, too:
        f"if self.get_subscription_count(): {SEND}",
        f"readers = self.count_subscribers('out')\nif readers == 0 or self.ready: {SEND}",
    ],
)
def test_what_is_reached_is_not_told(tmp_path: Path, body: str) -> None:
    found, notes = told(body, tmp_path)
    assert (found, [note for note in notes if note.code == "never-passed"]) == ([], [])


@pytest.mark.parametrize(
    ("line", "is_told"),
    [
        ("self.ready = self.count > 90", False),  # that is what is found, and decides
        ("ready = self.ready", True),
        ("if self.count > 90: self.on_ready(); self.ready = True", False),
    ],
)
def test_what_only_follows_from_a_fault_is_not_told_beside_it(
    tmp_path: Path, line: str, *, is_told: bool
) -> None:
    what = noted(f"{line}\nif self.ready: {SEND}", tmp_path)
    seen = Seen(what.unreached.look, assignments.load(), [], [])
    (source,) = (source for source in what.unreached.look.files if "class Robot" in source.text)
    fault = Finding("no-effect", "It has no effect.", source.at(FIRST), "change it")
    _, notes, _ = with_reasons([fault], [], what, seen)
    assert [SEND in note.cause for note in notes if note.code == "never-passed"] == [True] * is_told


KEPT = "if self.count TEST: self.kept = 0\nself.sum = self.kept"


@pytest.mark.parametrize(
    ("body", "is_told"),
    [
        (KEPT.replace("TEST", "% 7 < 20"), True),
        (KEPT.replace("TEST", "> 0"), True),  # it only goes further away
        (KEPT.replace("TEST", "> 3"), False),  # not always
        (KEPT.replace("TEST", "< 90"), False),  # it goes there
        (f"self.last = self.kept\n{KEPT.replace('TEST', '% 7 < 20')}", False),  # it was used before
        ("if self.kept or self.count % 7 < 20: self.kept = 0", False),
        ("if self.count % 7 < 20:\n    self.last = self.kept\n    self.kept = 0\nprint(self.kept)", False),
        ("if self.count % 7 < 20: self.kept = 0", False),  # nothing else reads it
    ],
)
def test_what_is_always_set_anew_before_it_is_used_is_told(
    tmp_path: Path, body: str, *, is_told: bool
) -> None:
    _, notes = told(f"self.keep()\n{body}", tmp_path)
    lost = [note.cause for note in notes if "sets self.kept anew each time" in note.cause]
    assert len(lost) == is_told, notes
    assert all(" was between " in cause for cause in lost)


@pytest.mark.parametrize(
    ("body", "is_wrong"),
    [
        ("try: self.missing.go()\nexcept Exception: print('no')", True),
        ("try: self.items.push(4)\nexcept: pass", True),
        ("try: self.missing.go()\nexcept AttributeError: pass", False),  # it is expected
        ("try: self.items[self.count]\nexcept Exception: pass", False),  # it may be of the values
        ("try: self.last = None; self.last.data\nexcept Exception: pass", False),  # not there yet
        ("try:\n    if self.count > 9: self.missing.go()\nexcept Exception: pass", False),
    ],
)
def test_a_mistake_that_is_always_hidden_is_wrong(tmp_path: Path, body: str, *, is_wrong: bool) -> None:
    found, _ = told(body, tmp_path)
    assert [finding.code for finding in found] == ["errors-hidden"] * is_wrong


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("self.items[self.count]", "self.items was a list of 3 (1, 2, 3) and self.count was 3"),
        ("{'left': 1}.items(); sides = {'left': 1}; sides[self.state]", "sides was a dict with 'left' and self.state was 'idle', which line 6 sets"),
        ("span = self.count - 3\n1 / span", "span was 0, which line 23 sets"),
        ("1 / (len(self.items) - 3)", "len(self.items) - 3 was 0"),
        ("low, high = self.items", "self.items was a list of 3 (1, 2, 3)"),
        ("min(self.items[3:])", "self.items[3:] was an empty list"),
        ("int(self.state)", "self.state was 'idle'"),
        ("self.ready = None; self.ready.data", "self.ready was None"),
        ("self.state + self.count", "self.state was 'idle' and self.count was 3"),
        ("raise RuntimeError(self.state)", ""),
    ],
)  # fmt: skip
def test_the_values_that_made_a_line_fail_are_told(tmp_path: Path, line: str, said: str) -> None:
    (error,) = noted(line, tmp_path).unreached.record.errors
    finding = with_values(Finding("python-error", "It fails.", error.place, "correct it"), [error])
    if said:
        assert f"In that line, {said.partition(', which')[0]}" in finding.cause
    else:
        assert finding.cause == "It fails."
        known = with_values(Finding(SAID, "It fails", error.place), [error])
        assert "It fails. In that line, self.state was 'idle'." in known.cause
    other = Finding("attribute-missing", "It fails.", error.place)
    assert with_values(other, [error]) == other


def test_what_the_program_has_is_not_run_to_see_its_values(tmp_path: Path) -> None:
    """A property, or an element of an own class, may do anything."""
    body = "class Own:\n    @property\n    def size(self): print('asked')\n    def __getitem__(self, at): print('asked')\nown = Own()\n1 / 0, own.size, own[0]"
    (error,) = noted(body, tmp_path).unreached.record.errors
    assert [value for value in error.values if value[0] != "own"] == []


SILENT = Finding("publishes-nothing", "It published nothing there.", "", "look", ("status_publisher",))


@pytest.mark.parametrize(
    ("test", "others", "is_told"),
    [
        ("self.count > 90", True, False),  # an alarm that does not ring
        ("self.count > 90", False, True),
        ("self.count == -1", True, True),
    ],
)
def test_a_silent_publisher_has_a_reason_unless_a_limit_was_only_not_passed(
    tmp_path: Path, test: str, others: bool, is_told: bool
) -> None:
    files = right_workspace()
    code = (
        "from rclpy.node import Node\nfrom std_msgs.msg import String\n\n\nclass Silent(Node):\n"
        "    def __init__(self):\n        self.count = 0\n        self.made = False\n        if self.made:\n"
        "            self.out = self.create_publisher(String, 'news', 10)\n\n"
        f"    def tick(self):\n        self.count += 1\n        if {test}:\n            self.out.publish(String())\n\n\n"
        "silent = Silent.__new__(Silent)\nSilent.__init__(silent)\nfor _ in range(5):\n    silent.tick()\n"
    )
    root = files.put("node", code).write(tmp_path / "ws")
    notes = tmp_path / "notes"
    notes.mkdir()
    (path,) = root.glob("src/*/*/status_publisher.py")
    environ = {**os.environ, **environ_in(notes, root, {})}
    command = [sys.executable, "-c", f"import {path.parent.name}.status_publisher"]
    done = subprocess.run(command, cwd=path.parent.parent, env=environ, capture_output=True, check=False)
    assert done.stderr == b""
    look = Look(root)
    (source,) = (source for source in look.files if "class Silent" in source.text)
    heard = Heard(STRING, "/status_publisher", [1.0], [{"data": "a"}], 1) if others else None
    seen = Seen(look, assignments.load(), [run_of("status_publisher", "/other", STRING, heard)], [])
    found, _, _ = with_reasons([replace(SILENT, place=source.at(10))], [], witnessed(notes, look), seen)
    assert [finding.code for finding in found][:1] == ["publishes-nothing"] * is_told
    for finding in found[:1]:
        assert f"because `{test}` was never true in 5 checks (self.count was between 1 and 5" in finding.cause
        assert finding.place == source.at(14)


def test_a_real_node_that_never_begins_is_told_with_its_reason(tmp_path: Path) -> None:
    files = right_workspace()
    files.change("node", "        self.count = 0\n", "        self.count = 0\n        self.warm = 0\n")
    files.change(
        "node",
        "        msg = String()\n",
        "        self.warm = 0\n        self.warm += 1\n        if self.warm < 3:\n            return\n        msg = String()\n",
    )
    root = files.only("node").write(tmp_path)
    build(root)
    found = [one for one in try_out(root).findings if one.code == "publishes-nothing"]
    assert len(found) == 1
    assert "`self.warm < 3` was always true" in found[0].cause
