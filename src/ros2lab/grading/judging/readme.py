"""Compare the commands in a README with what was built and seen."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePosixPath

from ros2lab import every_node
from ros2lab.diagnose.sources.spelling import is_near_miss
from ros2lab.grading.evidence import Build, Files, Run
from ros2lab.grading.judging.player import STAND_IN
from ros2lab.grading.judging.readme_owners import ROS_1, Owners, is_of_ros_1, is_placeholder
from ros2lab.grading.judging.shell_lines import is_run
from ros2lab.grading.receiving.submission import Submission

MOST_COMMANDS = 50

_COMMAND = re.compile(
    rf"\b(?:ros2 +(?:run|launch|topic|node|param)|colcon +(?:build|test)|python3?|{ROS_1})\b[^\n`#&|;<*]*(?:(?<=\s)<[\w -]+>)?"
)
_VALUE = re.compile(r"/[\w/]*\w")
_WAITS = re.compile(r"-[1tw]$|--(?:once|times|wait)")  # with these, `ros2 topic pub` waits for a subscriber
_CODE = re.compile(r"^ *(```|~~~).*?(?:^ *\1|\Z)|`[^`\n]+`", re.DOTALL | re.MULTILINE)
# The word before a command in a sentence, as in "Run colcon build in ~/ws"; an article makes it a noun.
_INSTRUCTION = re.compile(r"(?<!\w)(?!(?:the|an?) )[^\W\d_]+ +$", re.IGNORECASE)
_INDENTED = re.compile(r"(?: {4}|\t)\s*")  # a block of code
_PROMPT = re.compile(r"[^`]*[$%] *|\s*[^\s<]*> +")
# Marks of a list, a quotation or emphasis before the first word of a line.
_MARKS = re.compile(r"(?:[-*+>(]|\d+[.)]|\s)*")


def commands(
    text: str, submission: Submission, built: Build, runs: Sequence[Run], facts: Files | None = None
) -> dict[str, bool | None]:
    """Find the commands in a README, and return for each whether it is true of this submission.

    Args:
        text: the README.
        submission: what was handed in.
        built: the result of its build.
        runs: the runs of its programs.
        facts: the facts of its files; None if only the README is known.

    Returns:
        By command, whether what it names exists and takes its operands; None if it is not about the
        submission.
    """
    facts = facts or Files()
    known, operands = _Known(submission, built, runs, facts), Operands(facts, runs)
    written, text = text, _as_seen(text)
    code = [match.span() for match in _CODE.finditer(text)]
    found = [
        _command(words)
        for match in _COMMAND.finditer(text)
        if (words := match.group().split()) and _is_to_be_run(text, match.start(), words, code, known)
    ]
    judged = {command: known.judge(command.split()) for command in dict.fromkeys(found[:MOST_COMMANDS])}
    judged |= {
        command: False
        for command, is_true in judged.items()
        if (is_true and not operands.fit(command.split())) or not is_typed(command, written)
    }
    judged |= {command: None for command in judged if any(map(is_placeholder, command.split()[2:4]))}
    # A README may start other programs, such as turtlesim, and name their topics: we cannot know whether that is true.
    is_beside = any(
        known.owners.of(command.split()) in ("neighbour", "tool", "unknown") for command in judged
    )
    return judged | {command: None for command in judged if is_beside and known.is_elsewhere(command.split())}


def _as_seen(text: str) -> str:
    """Return a text with plain spaces and letters for those that look like them, and without what has no width."""
    plain = "".join(" " if sign.isspace() and sign not in "\n\t" else sign for sign in text)
    return "".join(c for c in unicodedata.normalize("NFKC", plain) if unicodedata.category(c) != "Cf")


def is_typed(command: str, text: str) -> bool:
    """Return whether a shell takes a command of a text as it is seen, with the spaces and letters of a keyboard."""
    pattern = re.compile(r"[.,:)\"']*[ \t]+".join(map(re.escape, command.split())))
    return bool(pattern.search(text) or not pattern.search(_as_seen(text)))


def misgiven(texts: Iterable[str], runs: Sequence[Run], facts: Files) -> list[str]:
    """Return the commands whose operands are wrong, whether or not what they name exists."""
    operands = Operands(facts, runs)
    return [text for text in texts if not operands.fit(text.split())]


def _is_to_be_run(
    text: str, start: int, words: Sequence[str], code: Iterable[tuple[int, int]], known: _Known
) -> bool:
    """Return whether a README asks to run the command at a place; in code, whether a shell would run it."""
    for begin, end in code:
        if begin <= start < end:
            is_inline = not text[begin:end].lstrip(" ").startswith(("```", "~~~"))
            if is_inline and is_of_ros_1(" ".join(words)):
                return False  # it may tell what ROS 2 has instead
            first = begin + is_inline
            return is_run(text[first:end], start - first)
    return _is_meant(words, _before(text, start), known)


def _before(text: str, start: int) -> str:
    """Return the part of a line before a place in it."""
    return text[text.rfind("\n", 0, start) + 1 : start]


def _is_meant(words: Sequence[str], before: str, known: _Known) -> bool:
    """Return whether words outside of code are a command, not a sentence about colcon or `ros2 run`.

    After a prompt they always are. Elsewhere `colcon build` is a command if no other word follows or an
    instruction comes before, and `ros2 run` if it begins its line or starts something that may belong to the
    submission.
    """
    if _PROMPT.fullmatch(before):
        return True
    if is_of_ros_1(" ".join(words)):
        return _INDENTED.fullmatch(before) is not None
    if words[0] == "colcon":
        is_last = len(words) < 3 or _bare(words[1]) != words[1] or not words[2][0].isalnum()
        return is_last or _INSTRUCTION.search(before) is not None
    if words[:2] in (["ros2", "run"], ["ros2", "launch"]):
        names = [_bare(word) for word in words[2:4]]
        return bool(_MARKS.fullmatch(before)) or known.may_start(names)
    return True


def _command(words: Sequence[str]) -> str:
    """Return a command without the sentence that goes on after it: colcon takes options only."""
    bare = [*map(_bare, words)]
    is_prose = bare[0] == "colcon" and not " ".join(bare[2:3]).startswith("-")
    return " ".join(bare[:2] if is_prose else bare)


def _bare(word: str) -> str:
    """Return a word of a command without punctuation of the sentence around it; a message's YAML stays."""
    return word if set(word) & {*"{}"} else word.rstrip(".,:)\"'") or word


class _Known:
    """The names that a command can use."""

    def __init__(self, submission: Submission, built: Build, runs: Sequence[Run], facts: Files) -> None:
        self.owners = Owners(submission, built.executables, [*built.shared, *facts.launch_files])
        self._own = self.owners.own
        self._packages = {package.name for package in submission.packages}
        # What is launched in the other packages; None if their files are not known.
        self._elsewhere = {PurePosixPath(path).name for path in facts.launch_files_elsewhere}
        self._is_read = bool(facts.manifest) and "launch_files_elsewhere" not in facts.unread
        self._executables = {
            executable.name for executable in built.executables if executable.command and not executable.fault
        }
        self._scripts = {
            f"{executable.name.removesuffix('.py')}.py"
            for executable in built.executables
            if executable.way == "script"
        }
        self._shared = {PurePosixPath(path).name for path in built.shared}
        self._broken = {name for run in runs if run.setting == "launched" for name in run.ended}
        self._is_built = built.is_built
        self._nodes = {node for run in runs for node in run.nodes}
        self._topics = set(every_node.HIDDEN_TOPICS)
        for run in runs:
            self._topics |= {*run.publishes, *run.subscribes, *run.quiet}

    def may_start(self, names: Sequence[str]) -> bool:
        """Return whether names after `ros2 run` or `ros2 launch` may be this package's, or placeholders."""
        if len(names) < 2:
            return any(re.search(r"\w[./]\w", name) for name in names)  # a launch file may be named alone
        return any(map(is_placeholder, names)) or self.owners.of(["ros2", "run", *names]) == "own"

    def is_elsewhere(self, words: Sequence[str]) -> bool:
        """Return whether a command names a topic or a node unlike any of this package's."""
        match words:
            case ["ros2", "topic" | "node" | "param", _, *rest]:
                own = self._topics | self._nodes
                named = next(filter(_VALUE.fullmatch, rest), "")
                return bool(named) and not any(named == name or _may_mean(named, name) for name in own)
        return False

    def judge(self, words: Sequence[str]) -> bool | None:
        match words:
            case ["ros2", "run" | "launch" as verb, package, name, *_]:
                known = self._executables if verb == "run" else self._shared
                owner = self.owners.of(words)
                is_there = name in known and (
                    package in self._own or (owner == "neighbour" and verb == "launch")
                )
                # Which launch files a neighbour has is known, and nothing of its programs.
                is_lost = verb == "launch" and self._is_read and name not in self._elsewhere
                is_open = owner in ("tool", "unknown") or (owner == "neighbour" and not is_lost)
                return (is_there and name not in self._broken) or (None if is_open else False)
            case ["ros2", "topic", verb, *rest]:
                return self._of_topic(verb, rest)
            case ["ros2", "node" | "param", _, *rest]:
                return self._names(rest, self._nodes)
            case ["colcon", *rest]:
                return self._is_built and self._builds(rest)
            case ["python" | "python3", file, *_] if PurePosixPath(file).name in self._scripts:
                return True
        return False if is_of_ros_1(" ".join(words)) else None

    def _names(self, words: Sequence[str], known: set[str]) -> bool | None:
        named = next((word for word in words if _VALUE.fullmatch(word)), None)
        return None if named is None else named in known

    def _of_topic(self, verb: str, words: Sequence[str]) -> bool | None:
        """Return whether a command about a topic is true; None if it only publishes, where nobody listens."""
        is_true = self._names(words, self._topics)
        if is_true is not False or verb != "pub" or any(map(_WAITS.match, words)):
            return is_true
        named = next(filter(_VALUE.fullmatch, words), "")
        return False if any(_may_mean(named, topic) for topic in self._topics) else None

    def _builds(self, words: Sequence[str]) -> bool:
        """Return whether colcon builds a package of the submission, and does not skip the graded one."""
        own, chosen = self._own & self._packages, self._chosen(words)
        is_left_out = bool(own) and own <= {*_values(words, "--packages-skip")}
        return not is_left_out and (not chosen or bool(chosen & self._packages))

    def _chosen(self, words: Sequence[str]) -> set[str]:
        """Return the packages that colcon's options select."""
        options = ("--packages-select", "--packages-up-to")
        return {name for option in options for name in _values(words, option)}


def _may_mean(named: str, name: str) -> bool:
    """Return whether a topic or a node is another one, misspelt or without its namespace."""
    return is_near_miss(named, name) or named == f"/{name.rpartition('/')[2]}" != name


def _values(words: Sequence[str], option: str) -> Iterator[str]:
    """Yield the values of an option that takes several values."""
    is_of_it = False
    for word in words:
        is_of_it = word == option or (is_of_it and not word.startswith("-"))
        if is_of_it and word != option:
            yield word


_TYPE = re.compile(r"([a-z]\w*)/(?:msg/)?([A-Z]\w*)")
_NAME = re.compile(r"[a-z_][\w.]*")
_GIVEN = re.compile(r"([a-z_][\w.]*):=.*")  # capitals are placeholders
# The options after --ros-args, up to a bare -- (rcl's own grammar); some take a value.
_ROS_FLAGS = re.compile(
    r"--|-[pre]|--(?:param|remap|enclave|params-file|log-level|log-config-file|log-file-name)"
    r"|--(?:en|dis)able-(?:rosout|stdout|external-lib)-logs"
)


class Operands:
    """Checks the operands of commands.

    Args:
        facts: the facts of the files.
        runs: the runs of the programs.
    """

    def __init__(self, facts: Files, runs: Sequence[Run]) -> None:
        self._facts = facts
        self._runs = runs

    def fit(self, words: Sequence[str]) -> bool:
        """Return whether no operand of a command is plainly wrong."""
        match words:
            case ["ros2", "topic", "pub" | "echo", *rest]:
                return self._has_type(rest)
            case ["ros2", "param", "get" | "set" | "describe", *rest]:
                node, name, *_ = (*(word for word in rest if not word.startswith("-")), "", "")
                return not _NAME.fullmatch(name) or self._has_parameter(self._held(node), name)
            case ["ros2", "run", _, program, *rest] if "--ros-args" in rest:
                return self._takes(program, rest[rest.index("--ros-args") + 1 :])
            case ["ros2", "launch", _, file, *rest]:
                return not any(
                    self._is_unnamed(file, match[1]) for match in map(_GIVEN.fullmatch, rest) if match
                )
        return True

    def _has_type(self, words: Sequence[str]) -> bool:
        """Return whether a topic has the type given in a command; True if none is given, or none is known."""
        topic = next((word for word in words if word.startswith("/")), "")
        given = next(filter(None, map(_TYPE.fullmatch, words)), None)
        types = {
            kind
            for run in self._runs
            for ends in (run.publishes, run.subscribes)
            for kinds in ends.get(topic, {}).values()
            for kind in kinds
        }
        known = {match.groups() for match in map(_TYPE.fullmatch, types) if match}
        return not (given and known) or STAND_IN in types or given.groups() in known

    def _held(self, node: str) -> list[set[str]]:
        """Return the parameters of a node, for each run in which it reported them."""
        return [{*run.parameters[node]} for run in self._runs if node in run.parameters]

    def _has_parameter(self, held: Sequence[set[str]], name: str) -> bool:
        is_known = name.partition(".")[0] in every_node.PARAMETERS or name in self._facts.declared
        return is_known or not held or any(name in names for names in held)

    def _takes(self, program: str, words: Sequence[str]) -> bool:
        """Return whether a program takes the words after `--ros-args`."""
        own = [run for run in self._runs if run.programs == [program] and run.setting == "alone"]
        held = [names for run in own for node in run.nodes for names in self._held(node)]
        # A program that has not reported its parameters, or whose nodes were not seen, may have any.
        is_told = bool(own) and all(run.parameters.keys() >= {*run.nodes} for run in own)
        before = ""
        for word in words:
            if word == "--":
                return True
            if word.startswith("-") and not _ROS_FLAGS.fullmatch(word):
                return False
            given = _GIVEN.fullmatch(word) if before in ("-p", "--param") else None
            if given and is_told and not self._has_parameter(held, given[1]):
                return False
            before = word
        return True

    def _is_unnamed(self, file: str, argument: str) -> bool:
        """Return whether there are launch files of this name, and none of them uses an argument."""
        found = [
            names
            for path, names in self._facts.launch_lacks.items()
            if PurePosixPath(path).name == PurePosixPath(file).name
        ]
        return bool(found) and all(argument in names for names in found)
