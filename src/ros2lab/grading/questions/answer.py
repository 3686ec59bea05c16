"""What a question is, and what an answer to it holds."""

from __future__ import annotations

import inspect
import itertools
import re
import signal
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace

from ros2lab.assignments import End, Part
from ros2lab.diagnose import net
from ros2lab.diagnose.printed.ignored import without_ignored
from ros2lab.grading.evidence import DOCUMENTED, KEYBOARD, NO_WORD, OTHER_TYPE
from ros2lab.grading.judging.excuses import Excuse, excuse, quoted
from ros2lab.grading.judging.player import finds_no_keyboard
from ros2lab.grading.judging.players import Case
from ros2lab.grading.judging.sisters import lost_sister
from ros2lab.grading.reading.unread import FAILED, NO_FAULT, missing
from ros2lab.grading.sandbox.keeper import is_limit
from ros2lab.grading.sandbox.worlds import FILES

LONGEST = 80  # characters of a submission's text in a sentence

# What differs between two runs of the same program: addresses, times, process ids.
_CHANCE = re.compile(r"0x[0-9a-fA-F]+|\b\d{5,}(?:\.\d+)?\b|(?<=\()/[^)]*/")
_LAST_WORD = re.compile(r"^[\w.]*(?:Error|Exception|Exit|Warning)\b.*|^\w+(?:\.\w+)+: .*")
_MARGIN = re.compile(r"^\s*(?:\| |\+[-+ \d.]*$)")  # of the errors in an ExceptionGroup
# Python's own last word of an error, after what the error is, where the program has taken sys.stderr away.
_UNPRINTED, _DUMPED = "lost sys.stderr", re.compile(r"^object repr +: (.*\S)", re.MULTILINE)
_OF_LAUNCH = re.compile(r"\[ERROR\] \[launch\]: (?:Caught exception in launch \([^)]*\): )?(.+)")
_DIED = re.compile(r"\[ERROR\] \[([^\]]+)\]: process has died \[pid \d+, exit code (-?\d+)")
# What `ros2 launch` prints about a program that it asks to end, and what that program prints then.
_ASKED = re.compile(
    r"(?:\[INFO\] )?\[([^\]]+)\]:? (?:sending signal 'SIGINT' to process|KeyboardInterrupt$|[\w.]*\bExternalShutdownException\b)"
)
_LOGS_ERROR = re.compile(r"\s*\[(?:WARN|ERROR|FATAL)\] \[")
_REPORT = re.compile(r"\s*\[(?:DEBUG|INFO)\] \[")  # log lines about no error

# A traceback's frame in the submission, as it was written or as it was installed.
_FRAME = re.compile(rf'File "{FILES}/([^"\n]*-packages/)?([^"\n]+)", line (\d+)')


def shown(text: object, longest: int = LONGEST) -> str:
    """Return a submission's text for use in a sentence: one line, shortened, no control characters."""
    line = " ".join(str(text).split())
    line = "".join("�" if unicodedata.category(c)[0] == "C" else c for c in line[: 10 * longest])
    return line if len(line) <= longest else f"{line[: longest - 1]}…"


def listed(words: list[str]) -> str:
    """Return words as a list in a sentence, at most four and the number of the others."""
    some = [shown(word) for word in words[:4]]
    if len(words) > 4:
        some.append(f"{len(words) - 4} more")
    return " and ".join(filter(None, (", ".join(some[:-1]), *some[-1:])))


@dataclass(frozen=True)
class Answer:
    """What the evidence says about a question.

    Attributes:
        level: the name of the answer, which the rubric gives a share of the points.
        seen: the values for the braces in the level's sentence.
        evidence: the keys of the evidence on which it rests.
        place: a file, a topic or a node; empty if there is none.
        excuse: why it could not be tried here as intended, in a clause; empty if it could.
        lack: why the code would not do it anywhere, so that the excuse does not count, in a clause; empty if it
            would.
    """

    level: str
    seen: Mapping[str, str] = field(default_factory=dict)
    evidence: tuple[str, ...] = ()
    place: str = ""
    excuse: str = ""
    lack: str = ""

    @property
    def is_for_want(self) -> bool:
        """Whether it could not be tried for want of what is not where it is graded, or of time: not for our fault."""
        return self.excuse not in ("", FAILED)


@dataclass(frozen=True)
class Question:
    """A question that a rubric can ask.

    Attributes:
        name: its name in the rubric.
        answers: the levels that an answer can have, the best first.
        names: the names that every answer fills in.
        codes: the codes of `diagnose` findings that explain a loss.
        is_of_part: whether it is asked about a part of the assignment, not about the submission as a whole;
            an answer then also fills in what was `asked` of the part.
        ends: the ends that such a part may have.
        needs: what the assignment must give for such a part, such as `period`; empty if nothing.
        mute: the answers that may only mean that something could not be tried here.
        deeds: what the code must do for there to be anything to try, besides what every end needs.
        tells: the answers by which the node of a part is known; empty if it asks what any node does.
    """

    name: str
    answers: tuple[str, ...]
    names: frozenset[str]
    codes: frozenset[str]
    is_of_part: bool
    ends: tuple[End, ...]
    needs: str
    mute: frozenset[str]
    deeds: frozenset[str]
    tells: frozenset[str]
    _ask: Callable[..., Answer]

    def ask(self, case: Case, part: Part | None) -> Answer:
        """Answer the question, about `part` if it needs one; an answer from an unread fact, or none, costs nothing."""
        with missing(case.evidence) as unread:
            try:
                answer = self._answer(case, part)
            except Exception as error:
                net.unjudged(error)
                why = f"a question of the grader itself has failed, {NO_FAULT} ({type(error).__name__}: {error})"
                seen = dict.fromkeys(self.names, "") | (asked(part) if part and self.is_of_part else {})
                return Answer(self.answers[-1], seen, excuse=why)
        is_open = unread and answer.level != self.answers[0]
        return replace(answer, excuse=FAILED, lack="") if is_open else answer

    def _answer(self, case: Case, part: Part | None) -> Answer:
        if not self.is_of_part or part is None:
            return self._ask(case)
        answer = self._ask(case, part)
        # For what was never seen, the code must plainly do what is asked for.
        is_open = answer.level in ("written", *self.mute)
        why, lack = excuse(case, part, self.deeds) if is_open else Excuse()
        why = why or (lost_sister(case, part) if answer.level in self.mute else "")
        seen = {**asked(part), "outside": _outside(case, part), "but": _handed_on(case, part), **answer.seen}
        return replace(answer, seen=seen, excuse=why, lack=lack)


def _outside(case: Case, part: Part) -> str:
    """Return where a part's node was seen, if not by itself in the lab with all that it imports, as the end of a clause."""
    player = case.main(part)
    program = case.executables.get(player.program) if player else None
    if player and player.run.refused:
        return " outside the lab, which refuses its numbers"
    absent = [name for name in program.absent if name != KEYBOARD] if program else []
    stood_in = f", with an empty stand-in for {listed(absent)}" if absent else ""
    if player and player.run.setting == DOCUMENTED:
        return ", with the parameters that the README gives"
    typed = [repr(line) for line in player.run.typed] if player else []
    return f"{stood_in}, while {listed(typed)} were typed" if typed else stood_in


def _handed_on(case: Case, part: Part) -> str:
    """Return what came from a part's node and does not count, as the end of a sentence that says that nothing came."""
    player = case.main(part)
    runs = case.evidence.runs if player and part.is_publisher else []
    taken = [run.commanded for run in runs if player and replace(player, run=run).repeats_words]
    return f" but what {shown(player.node)} hands on from {shown(taken[0])}" if player and taken else ""


def asked(part: Part) -> dict[str, str]:
    """Return what is asked of a part, by the names that the rubric's sentences use."""
    package, class_name = part.type_name.partition("/")[0], part.short_type
    ends = {
        "publisher": ("publishes on", "a publisher"),
        "subscription": ("subscribes to", "a subscription"),
        "service": ("provides", "a service"),
    }
    verb, an_end = ends[part.end]
    return {
        "wanted": part.topic,
        "wanted_type": part.type_name,
        "wanted_class": class_name,
        "wanted_package": package,
        "wanted_period": str(part.period),
        "verb": verb,
        "an_end": an_end,
        "wanted_within": f"{part.within:g}",
        "commands": listed([*part.commands]),
        "when": "on each change" if part.when == "change" else part.when,
        "parameters": listed([asked.name for asked in part.parameters]),
    }


ASKED = frozenset((*asked(Part("", "publisher", "", "")), "outside", "but"))
QUESTIONS: dict[str, Question] = {}


def question(
    answers: str,
    names: str = "",
    codes: frozenset[str] = frozenset(),
    ends: tuple[End, ...] = ("publisher", "subscription"),
    *,
    needs: str = "",
    mute: str = "",
    deeds: str = "",
    tells: str = "",
) -> Callable[[Callable[..., Answer]], Callable[..., Answer]]:
    """Register a function of a `Case`, or of a `Case` and a `Part`, as a question that a rubric can ask.

    Args:
        answers: the levels, the best first, separated by spaces.
        names: the names that every answer fills in, separated by spaces.
        codes: the codes of `diagnose` findings that explain a loss.
        ends: the ends that the part may have.
        needs: what the assignment must give for such a part.
        mute: the levels that may only mean that something could not be tried here, separated by spaces.
        deeds: what the code must do, or these levels would be the same anywhere, separated by spaces; see
            `deeds`.
        tells: the levels by which the node of a part is known, separated by spaces.
    """

    def enter(ask: Callable[..., Answer]) -> Callable[..., Answer]:
        name = ask.__name__
        is_of_part = len(inspect.signature(ask).parameters) == 2
        seen = frozenset(names.split()) | (ASKED if is_of_part else frozenset())
        QUESTIONS[name] = Question(
            name,
            tuple(answers.split()),
            seen,
            codes,
            is_of_part,
            ends,
            needs,
            frozenset(mute.split()),
            frozenset(deeds.split()),
            frozenset(tells.split()),
            ask,
        )
        return ask

    return enter


def ended(said: str, otherwise: str = "by itself with", *, is_done: bool = False) -> str:
    """Return how a program ended, by its last output, as the rest of a sentence.

    Args:
        said: its last lines, or the limit that ended it.
        otherwise: the words before the reason, if it ended by itself.
        is_done: whether its exit code says that all went well: what it prints then is no reason, but for an error.
    """
    if is_limit(said):
        return f"at a limit: it{shown(said).removeprefix('It').rstrip('.')}"
    if is_done and not tells_error(said):
        return f"{otherwise} no error"
    return f"{otherwise} {last_word(said)}"


def tells_error(said: str) -> bool:
    """Return whether a program's last output holds an error, or a line of the log that is one."""
    return any(_LAST_WORD.match(line.strip()) or _LOGS_ERROR.match(line) for line in said.splitlines())


def is_shut_down(said: str) -> bool:
    """Return whether a launch file itself ended what it had started, without a fault, by its last output."""
    lines = [line.strip() for line in said.splitlines()]
    deaths = [line for line in lines if _DIED.match(line)]
    asked = _asked_to_end(lines)
    return bool(asked) and {*deaths} <= asked and not any(map(_OF_LAUNCH.fullmatch, lines))


def _asked_to_end(lines: Iterable[str]) -> set[str]:
    """Return the lines of `ros2 launch` about the end of programs that it had asked to end."""
    lines = [*lines]
    asked = {match[1] for match in map(_ASKED.match, lines) if match}
    found = {line for line in lines if _ASKED.match(line)}
    for line in lines:
        died = _DIED.match(line)
        if died and (int(died[2]) == -signal.SIGINT or died[1] in asked):
            found.add(line)
    return found


def last_word(text: str, longest: int = LONGEST) -> str:
    """Return in quotes the line that says why a program ended, without the parts that differ between runs."""
    said = without_ignored(text.splitlines())
    bare = (_MARGIN.sub("", line).strip() for line in said if not _REPORT.match(line))
    lines = [*filter(None, bare)]
    # The end of a program that was asked to end is no reason.
    asked = _asked_to_end(lines)
    lines = [line for line in lines if line not in asked] or lines
    # After the error that ends a launch file come the ends of what it had started.
    below = {line: following.removeprefix("- ") for line, following in itertools.pairwise(lines)}
    telling = [
        below.get(line, match[1]) if line.endswith(":") else match[1]  # it says why on the next line
        for line, match in zip(lines, map(_OF_LAUNCH.fullmatch, lines), strict=True)
        if match
    ]
    telling = telling or [line for line in lines if _LAST_WORD.match(line)]
    reports = [line.partition("]: ")[2] for line in text.splitlines() if _REPORT.match(line)]
    mute = f"no error; it said last: {quoted(shown(reports[-1]))}" if any(reports) else "no word of why"
    if _UNPRINTED in lines:
        lines, mute = _DUMPED.findall(text), "an error that Python could not print"
    if not (telling or lines):
        return mute
    word = (telling or lines)[-1].replace(f"{FILES}/", "")
    word = shown(_CHANCE.sub("…", word.partition(". Did you mean: ")[0]), longest).rstrip(".:")
    is_unread = finds_no_keyboard(word) and finds_no_keyboard(text)
    return f"{quoted(word)}, for there is no keyboard where it is graded" if is_unread else quoted(word)


def error_of(error: str, longest: int = LONGEST) -> str:
    """Return why a build failed: in quotes, but for what the grader itself says of it."""
    is_ours = error == NO_WORD or error.startswith(OTHER_TYPE)
    return shown(error, longest).rstrip(".:") if is_ours else last_word(error, longest)


def raised_at(case: Case, text: str, program: str) -> str:
    """Return a traceback's last place in the submission, as it was handed in; the program's name if there is none."""
    places = [f"{case.at(file) if built else file}:{line}" for built, file, line in _FRAME.findall(text)]
    return shown([program, *places][-1])
