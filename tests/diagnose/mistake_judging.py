"""Whether an answer of `ros2lab diagnose` would have helped: its cause, its place, and its fix applied literally."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from pathlib import Path
from socket import AF_UNIX, socket

from more_cases import BUILT, Case
from right_workspace import right_workspace
from student_terminal import Screen, first_environ, type_in

from ros2lab.diagnose.finding import UNKNOWN
from ros2lab.domain_lease import leased

TIMEOUT = 60  # s, for an answer
_COMMAND = re.compile(
    r"(?:\./|(?:\w+=\S+ )?(?:colcon|source|touch|mv|cp|rm|mkdir|chmod|chown|sudo|sed|ros2|python3|dos2unix|"
    r"iconv|export|unset|cd|pip|git)\b)"
)


@dataclass(frozen=True)
class Answer:
    """What was said first, and what it is worth.

    Attributes:
        verdict: one of `more_cases.VERDICTS`.
        said: the answer, as one text.
        reason: what decided.
    """

    verdict: str
    said: str
    reason: str = ""


@dataclass(frozen=True)
class Outcome:
    """What became of a case.

    Attributes:
        name: the case's.
        answers: by the checkout that was asked.
        text: what was seen.
        after: what was seen after the case's own fix.
        problem: why the case itself is not right; empty if it is.
    """

    name: str
    answers: Mapping[str, Answer] = field(default_factory=dict)
    text: str = ""
    after: str = ""
    problem: str = ""


def outcome(case: Case, checkouts: Sequence[Path], *, with_fix: bool = True) -> Outcome:
    """Make a mistake, ask each checkout about it, and set it right.

    Args:
        case: the mistake.
        checkouts: folders in which `.venv/bin/ros2lab` is.
        with_fix: whether the case's own fix is tried, too.
    """
    if case.needs == "root" and os.geteuid() != 0:
        return Outcome(case.name, problem=f"only {case.needs} can make it")
    with _domains() as (domain, other), tempfile.TemporaryDirectory() as home:
        place = _Place(case, Path(home), domain, other)
        screen = place.break_it()
        if not case.is_seen(screen.text):
            return Outcome(case.name, text=screen.text, problem="what must be seen is not seen")
        answers = {str(checkout): _answer(place, screen, checkout) for checkout in checkouts}
        if not with_fix:
            return Outcome(case.name, answers, screen.text)
        after = place.after_its_fix()
        problem = "" if case.is_solved(after) else "its own fix does not set it right"
        return Outcome(case.name, answers, screen.text, after, problem)


@contextmanager
def _domains() -> Iterator[tuple[int, int]]:
    with closing(socket(AF_UNIX)) as first, closing(socket(AF_UNIX)) as second:
        yield leased(first), leased(second)


class _Place:
    """A workspace in a home of its own, which can be set back to how it was when the mistake was seen."""

    def __init__(self, case: Case, home: Path, domain: int, other: int) -> None:
        self.case = case
        self.root = home / "ros2_ws"
        self._seen = home / "seen"
        self._environ = first_environ(home, domain, other)

    def break_it(self) -> Screen:
        """Make the mistake, and return what is seen."""
        self.case.files().write(self.root)
        if self.case.shell:
            self._type(self.case.shell, self._environ)
        screen = self._type(self.case.typed, self._environ, "" if self.case.quiet else self.case.seen)
        self._copy(self.root, self._seen)
        return screen

    def solves(self, commands: Sequence[str], screen: Screen) -> bool:
        """Return whether commands, typed where the mistake was seen, set it right."""
        self._set_back()
        again = [*commands, *self.case.typed_after(commands)]
        return self.case.is_solved(self._type(again, screen.environ, self.case.sign()).text)

    def after_its_fix(self) -> str:
        """Return what is seen after the case's own fix, or with the right files."""
        self._set_back()
        commands = [*self.case.fix, *self.case.typed_after(self.case.fix)]
        if not self.case.fix:
            shutil.rmtree(self.root / "src")
            right_workspace().write(self.root)
            commands = list(self.case.typed)
        elif (
            not any(command.startswith("source") for command in commands) and (self.root / "install").is_dir()
        ):
            commands = [BUILT[1], *commands]
        return self._type(commands, self._environ, self.case.sign()).text

    def _type(self, commands: Sequence[str], environ: Mapping[str, str], until: str = "") -> Screen:
        is_bound = self.case.needs == "root" and commands is not self.case.shell
        return type_in(commands, self.root, environ, self.case.elsewhere, until=until, bound=is_bound)

    def _set_back(self) -> None:
        shutil.rmtree(self.root)
        self._copy(self._seen, self.root)

    @staticmethod
    def _copy(source: Path, target: Path) -> None:
        subprocess.run(["cp", "-a", source, target], check=True)


def _answer(place: _Place, screen: Screen, checkout: Path) -> Answer:
    """Return what a checkout says first of what was seen, or, where it knows nothing of that, of the workspace."""
    of_text, of_workspace = (
        _findings(checkout, arguments, place.root, screen) for arguments in (["-", "--json"], ["--json"])
    )
    if of_text is None or of_workspace is None:
        return Answer("wrong", "", "it failed")

    def solves(commands: Sequence[str]) -> bool:
        return place.solves(commands, screen)

    if of_text and not _is_unknown(of_text[0]):
        return judged(place.case, of_text[0], solves, screen.text)
    verdict = "unknown" if of_text and not place.case.quiet else "nothing"
    if not of_workspace or _is_unknown(of_workspace[0]):
        return Answer(verdict, _said(of_text[0]) if of_text else "")
    answer = judged(place.case, of_workspace[0], solves)
    # What is true of the workspace and explains nothing of what was seen is as if nothing had been said.
    is_beside = answer.verdict in ("vague", "wrong") and answer.reason != "does harm"
    return Answer(verdict, answer.said, "beside the point") if is_beside else answer


def judged(
    case: Case, finding: Mapping[str, str], solves: Callable[[Sequence[str]], bool], seen: str = ""
) -> Answer:
    """Judge one finding.

    Args:
        case: what was wrong.
        finding: code, cause, place and fix.
        solves: whether commands, typed where the mistake was seen, set it right.
        seen: what was seen, which explains nothing and is no advice if it is only said again.
    """
    said = _said(finding)
    own = _own_words(finding["cause"], seen)
    fault = _fault_of_cause(case, finding, own)
    if fault:
        return Answer(fault[0], said, fault[1])
    commands = commands_in(finding["fix"])
    is_placed = _is_placed(case, finding)
    # Commands that need no place tell none.
    if commands and (is_placed or not finding["place"]) and solves(commands):
        return Answer("right", said, "typed and seen")
    if not is_placed:
        return Answer("insufficient", said, "another place")
    told = finding["fix"] if commands else f"{own} {finding['fix']}"
    is_told = bool(finding["fix"]) and _holds(case.advice, told)
    reason = "typed in vain; by its words" if commands else "by its words"
    return Answer("right" if is_told else "insufficient", said, reason)


def _fault_of_cause(case: Case, finding: Mapping[str, str], own: str) -> tuple[str, str] | None:
    """Return the verdict on a cause that is not the right one, and what decides; None if it is."""
    if case.wrong and _holds(case.wrong, f"{finding['fix']}\n{_said(finding)}"):
        return "wrong", "does harm"
    if _holds(case.cause, finding["cause"] if case.clear else own):
        return None
    if own != " ".join(finding["cause"].split()):
        return "vague", "says again what was seen"
    is_vague = bool(case.vague) and _holds(case.vague, own)
    return "vague" if is_vague else "wrong", "another cause"


def commands_in(fix: str) -> list[str]:
    """Return the commands of a fix that begins with one, or that is one among few words; else none.

    Nothing is typed that could delete what lies outside the workspace.
    """
    quoted = re.findall(r"`([^`]+)`", fix)
    if quoted and len(re.sub(r"`[^`]+`", "", fix).split()) <= 6:
        parts = quoted
    else:
        plain = re.sub(r"\([^)]*\)|\b(?:run|type) (?=colcon|ros2|source)", "", fix)
        parts = re.split(r"(?:,|;|\.)? (?:and )?then |,? and |, |; | && |\. ", plain)
        if not _COMMAND.match(parts[0]):
            return []
    commands = [part.strip().rstrip(".") for part in parts if _COMMAND.match(part.strip())]
    commands = [
        re.sub(r" (?:in|here|again|once more|from|where) .*| (?:again|there|here)$", "", part)
        for part in commands
    ]
    return [] if any(re.match(r"(?:sudo )?rm .*(?: /| ~|\.\.)", part) for part in commands) else commands


def _own_words(sentence: str, seen: str) -> str:
    """Return a sentence without what it repeats of what was seen: lines of code, and five words or more in a row."""
    for code in re.findall(r"`[^`]{12,}`", sentence):
        if code.strip("`") in seen:
            sentence = sentence.replace(code, "")
    words = sentence.split()
    bare, printed = ([word.strip(".,:;()`'\"") for word in text.split()] for text in (sentence, seen))
    while True:
        same = SequenceMatcher(None, bare, printed, autojunk=False).find_longest_match()
        if same.size < 5:
            return " ".join(words)
        del words[same.a : same.a + same.size], bare[same.a : same.a + same.size]


def _findings(
    checkout: Path, arguments: Sequence[str], folder: Path, screen: Screen
) -> list[dict[str, str]] | None:
    """Return what is found; None if it fails."""
    # They lead to the wheels of this checkout, and perhaps not to those of the one that is asked.
    wheels = ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
    done = subprocess.run(
        [str(checkout / ".venv/bin/ros2lab"), "diagnose", *arguments],
        cwd=folder,
        env={name: value for name, value in screen.environ.items() if name not in wheels},
        input=screen.text,
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    try:
        found = json.loads(done.stdout)
    except json.JSONDecodeError:
        return None
    return [{**dict.fromkeys(("code", "cause", "place", "fix"), ""), **finding} for finding in found]


def _is_placed(case: Case, finding: Mapping[str, str]) -> bool:
    places = case.places()
    where = finding["place"] or f"{finding['cause']} {finding['fix']}"
    return not places or any(place in where for place in places)


def _is_unknown(finding: Mapping[str, str]) -> bool:
    return finding["code"] == UNKNOWN


def _said(finding: Mapping[str, str]) -> str:
    place, fix = (f" [{finding['place']}]" if finding["place"] else ""), finding["fix"]
    return f"{finding['code']}: {finding['cause']}{place}{f' → {fix}' if fix else ''}"


def _holds(pattern: str, text: str) -> bool:
    return bool(re.search(pattern, text, re.IGNORECASE | re.MULTILINE))
