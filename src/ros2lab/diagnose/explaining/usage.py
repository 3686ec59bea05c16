"""Corrects commands that colcon or ros2 rejects, the latter by changes until its parser accepts one."""

from __future__ import annotations

import argparse
import contextlib
import io
import itertools
import re
import shlex
from collections.abc import Collection, Iterator, Mapping, Sequence

from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.transcript import words_in
from ros2lab.diagnose.sources.spelling import nearest

_NUMBER = re.compile(r"[-+]?\d+(?:[.,]\d+)?")
# Versions of a command, each with what was wrong before.
_Versions = Iterator[tuple[list[str], str]]
_SHOWN_PLAIN = re.compile(r"[\w./:=@,+~-]+")


def accepted_form(line: str) -> tuple[str, str] | None:
    """Return a form of the command that the parser accepts, and what was wrong; None if it is right, or none helps."""
    words = words_in(line.rstrip("& "))
    if words[:1] != ["ros2"] or {"-h", "--help"} & set(words) or _is_accepted(words):
        return None
    return next(((_line(new, line), why) for new, why in _repairs(words) if _is_accepted(new)), None)


def plain_words(words: Sequence[str], verbs: int) -> list[str]:
    """Return the words of a command after `ros2` and its verbs that are no options and no values of options."""
    parser, _ = _parser(words)
    options = {name: action for action in parser._actions for name in action.option_strings}
    found, waiting = list[str](), [*words[1 + verbs :]]
    while waiting and waiting[0] != "--ros-args":
        word = waiting.pop(0)
        name, sign, _ = word.partition("=")
        is_option = word.startswith("-") and len(word) > 1 and not _NUMBER.fullmatch(word)
        action = options.get(name) or next((options[long] for long in options if long.startswith(name)), None)
        if not is_option:
            found.append(word)
        elif action is not None and action.nargs != 0 and not sign:
            waiting = waiting[1:]
    return found


def _line(words: Sequence[str], line: str) -> str:
    """Join words into a command line; words of the old line keep its quotes."""
    quoted = {shlex.split(text)[0]: text for text in re.findall(r"'[^']*'|\"[^\"]*\"", line)}
    return " ".join(
        quoted.get(word) or (word if _SHOWN_PLAIN.fullmatch(word) else shlex.quote(word)) for word in words
    )


def _is_accepted(words: Sequence[str]) -> bool:
    from portable_ros2.command import parser_of

    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        try:
            args = parser_of(words[1:]).parse_args(words[1:])
        except SystemExit:
            return False
    return getattr(args, "verb_object", None) is not None


def _repairs(words: list[str]) -> _Versions:
    """Yield versions of a command with one change each, the likeliest first, and why each is needed."""
    parser, depth = _parser(words)
    yield from _other_verb(words, parser, depth)
    actions = {name: action for action in parser._actions for name in action.option_strings}
    for number, word in enumerate(words):
        if word.startswith("-") and word != "--ros-args" and not _NUMBER.fullmatch(word):
            yield from _other_option(words, number, actions)
    yield from _in_another_order(words)
    yield from _parted(words, depth)
    for number in range(depth + 1, len(words) - 1):
        if words[number].endswith((":", ",", "{")) or words[number + 1].endswith("}"):
            joined = " ".join(words[number:])
            yield [*words[:number], joined], f"{joined!r} is one value, so it needs quotes."


def _other_option(words: list[str], number: int, actions: dict[str, argparse.Action]) -> _Versions:
    """Yield versions with another option in its place, or other words after it."""
    before, after = words[:number], words[number + 1 :]
    name, sign, given = words[number].partition("=")
    action = actions.get(name)
    if action is None:
        yield from _unknown_option(words, number, actions)
    elif action.nargs in ("+", "*"):
        taken = list(itertools.takewhile(lambda argument: not argument.startswith("-"), after))
        for value in reversed(taken):
            rest = [argument for argument in after if argument is not value]
            why = f"{name} takes all the words after it, including {value!r}."
            yield [*before, value, name, *rest], why
    elif action.nargs != 0 and (given or after):
        value, rest = (given, after) if sign else (after[0], after[1:])
        for right in _values_for(action, value):
            kept = [*before, name, right, value, *rest]
            why = f"{name} takes {_kind(action)}, so it uses up {value!r}, which belongs to what follows."
            is_other = not sign and (action.choices or not _NUMBER.match(value))
            yield from [(kept, why)] if is_other else []
            why = f"{name} must be followed by {_kind(action)}, not {value!r}."
            yield [*before, name, right, *rest], why
    elif action.nargs != 0:
        for right in _values_for(action, ""):
            yield [*words, right], f"{name} must be followed by {_kind(action)}."


def _parted(words: list[str], depth: int) -> _Versions:
    for number in range(depth + 1, len(words)):
        name, sign, value = re.match(r"([\w./~]*)(:=|=|:|)(.*)", words[number]).groups()  # type: ignore[union-attr]
        if not sign:
            name, sign, value = words[number].rpartition("/")
        if name and sign and value:
            parted = [*words[:number], name, value, *words[number + 1 :]]
            why = f"{name} and {value} must be two words here, with a space between them instead of {sign}."
            yield parted, why


def _in_another_order(words: list[str]) -> _Versions:
    if "--ros-args" in words[:-2]:
        start = words.index("--ros-args")
        end = start + 1
        while end + 1 < len(words) and words[end].startswith("-"):
            end += 2
        moved = [*words[:start], *words[end:], *words[start:end]]
        why = "--ros-args and what follows it must come after the names of the package and the executable."
        yield moved, why


def _unknown_option(words: list[str], number: int, actions: dict[str, argparse.Action]) -> _Versions:
    """Yield versions with an unknown option replaced by a similar one or a launch argument, or removed."""
    name, sign, given = words[number].partition("=")
    before, after = words[:number], words[number + 1 :]
    if near := nearest(name, actions, 0.7):
        yield [*before, f"{near}{sign}{given}", *after], f"There is no option {name}; there is {near}."
    value, rest = (given.lstrip("="), after) if sign else (after[0] if after else "", after[1:])
    bare = name.lstrip("-").rstrip(":")
    if words[1:2] == ["launch"] and value:
        why = f"{name} is not an option of ros2 launch: a launch argument is written {bare}:={value}."
        yield [*before, f"{bare}:={value}", *rest], why
    yield [*before, *after], f"There is no option {name} here."


def _other_verb(words: list[str], parser: argparse.ArgumentParser, depth: int) -> _Versions:
    for action in parser._actions:
        wrong = words[depth + 1] if len(words) > depth + 1 else ""
        if isinstance(action, argparse._SubParsersAction) and wrong not in action.choices:
            near = nearest(wrong, action.choices, 0.6)
            if near:
                said = " ".join(words[: depth + 1])
                why = f"`{said}` has no {wrong}; there is {near}."
                yield [*words[: depth + 1], near, *words[depth + 2 :]], why


def _parser(words: Sequence[str]) -> tuple[argparse.ArgumentParser, int]:
    """Return the parser of the innermost subcommand, and the number of words that lead to it."""
    from portable_ros2.command import parser_of

    parser, depth = parser_of(words[1:]), 0
    for word in words[1:]:
        inner = next((a for a in parser._actions if isinstance(a, argparse._SubParsersAction)), None)
        if inner is None or word not in inner.choices:
            break
        parser, depth = inner.choices[word], depth + 1
    return parser, depth


def _values_for(action: argparse.Action, value: str) -> list[str]:
    """Return values that may have been meant for an option; empty if the given one is accepted."""
    if value in (action.choices or ()):
        return []
    if action.choices:
        near = nearest(value, [str(choice) for choice in action.choices], 0.6)
        return [near] if near else [str(choice) for choice in action.choices][1:2]
    if action.type is None:
        return []  # any text will do
    number = _NUMBER.match(value)
    default = action.default if isinstance(action.default, (int, float)) and action.default else 1
    return [number[0].replace(",", "."), number[0].partition(",")[0]] if number else [f"{default:g}"]


def _kind(action: argparse.Action) -> str:
    return f"one of {', '.join(map(str, action.choices))}" if action.choices else "a number"


# The options of colcon that the names of packages follow.
_SELECTING = (
    "--packages-select",
    "--packages-up-to",
    "--packages-skip",
    "--packages-above",
    "--packages-start",
    "--packages-end",
    "--packages-ignore",
    "--allow-overriding",
)

_Better = tuple[str, str]  # the corrected command, and what was wrong with it


def of_colcon(line: str, words: Sequence[str], look: Look, said: str) -> _Better | None:
    """Return the command that was meant and why; None if no word is known to be wrong."""
    folders = {package.shown("").rstrip("/"): package.name for package in look.packages}
    names = {*folders.values()}
    return (
        _apart(line, words, names)
        or _without_option(line, words, folders, said)
        or _other_selection(line, words, names)
        or _misspelt(line, words, names)
    )


def _apart(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Part package names that commas or semicolons join."""
    pairs = re.findall(r"([\w-]+)\s*[,;]\s*(?=([\w-]*))", line)
    joined = {name for pair in pairs for name in pair if name}
    if not joined or not joined <= {*names} or {*_SELECTING}.isdisjoint(words):
        return None
    return re.sub(r"\s*[,;]\s*", " ", line), "colcon separates package names by spaces alone."


def _without_option(line: str, words: Sequence[str], folders: Mapping[str, str], said: str) -> _Better | None:
    """Put an option before names, or folders, of packages that have none."""
    refused = re.search(r"unrecognized arguments:(.*)", said)
    bare = [*itertools.takewhile(lambda word: not word.startswith("-"), words[2:])]
    if not bare and refused and not refused[1].lstrip().startswith("-"):
        taken = {word for before, word in itertools.pairwise(words) if before in _SELECTING}
        bare = [word for word in refused[1].split() if word not in taken]
    meant = [folders.get(word.removeprefix("./").rstrip("/"), word) for word in bare]
    known = [name for name in meant if name in folders.values()]
    if not known:
        return None
    why = f"colcon {words[1]} accepts package names only after an option such as --packages-select."
    return line.replace(f" {' '.join(bare)}", f" --packages-select {' '.join(known)}", 1), why


def _other_selection(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Correct an option before a package's name that takes no names."""
    for option, word in itertools.pairwise(words[1:]):
        if option.startswith("--") and word in names and option not in _SELECTING:
            begun = (known for known in _SELECTING if known.startswith(option))
            right = next(begun, None) or nearest(option, _SELECTING, 0.5) or "--packages-select"
            return line.replace(option, right, 1), f"colcon {words[1]} has no option {option}; it is {right}."
    return None


def _misspelt(line: str, words: Sequence[str], names: Collection[str]) -> _Better | None:
    """Correct a package's name after an option that takes names."""
    for option, word in itertools.pairwise(words[1:]):
        if option in _SELECTING and word not in names and (near := nearest(word, names, 0.6)):
            return line.replace(word, near), f"No package here is called {word}; there is {near}."
    return None
