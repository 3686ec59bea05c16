"""Compare names: which known name a misspelt one means."""

from __future__ import annotations

import difflib
import functools
import re
import unicodedata
from collections.abc import Collection, Iterable
from pathlib import Path, PurePosixPath


def nearest(name: object, known: Iterable[object], cutoff: float = 0.7) -> str | None:
    """Return the known name most similar to `name`; None if none is similar enough.

    A name that differs only in case and separators, or in the order of its words, comes first. Anything but a string is similar to no name.
    """
    if not isinstance(name, str):
        return None
    names = {candidate for candidate in known if isinstance(candidate, str)}
    same = [candidate for candidate in names if candidate != name and _letters(candidate) == _letters(name)]
    same = same or [other for other in names - {name} if _are_turned(name, other)]
    if same:
        return min(same, key=lambda candidate: (candidate.startswith("_"), candidate))
    close = difflib.get_close_matches(name, sorted(names - {name}), n=1, cutoff=cutoff)
    return close[0] if close else None


def _are_turned(name: str, other: str) -> bool:
    """Return whether two names have the same words in another order, such as `requires_python` and `python_requires`."""
    return len(name) == len(other) and sorted(words_of(name)) == sorted(words_of(other))


def snake_case(name: str) -> str:
    """Return the name of a class as that of a module or a node: `status_publisher` for `StatusPublisher`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()


def with_article(noun: str) -> str:
    """Return a noun with `a` or `an` before it, such as `an Odometry`, but `a UInt8`."""
    return f"{'an' if noun[:1] in tuple('AEIOaeio') else 'a'} {noun}"


def write_instead(wanted: str, written: str, taken: Collection[object]) -> str:
    """Return the fix of a misspelt name, which may also stand correctly among those that are taken beside it."""
    if wanted in taken:
        return f"remove {written}, and keep the right value as {wanted}, which is there as well"
    return f"write {wanted} instead of {written}"


def nothing_like(name: str, owner: str, where: str = "here", *, is_own: bool = False) -> str:
    """Return the fix of a name that its owner lacks, where it has none like it: it is left over, or not made yet.

    What a library lacks may be a name of another release: then it is spelt rightly, and no other one is meant.
    """
    otherwise = f"define it in {owner}" if is_own else f"write what {owner} has for it"
    return f"remove {name} {where}, or {otherwise}"


def did_you_mean(name: object, known: Iterable[object]) -> str:
    """Return the sentence ` Did you mean ...?`; empty if no known name is similar."""
    close = nearest(name, known)
    return f" Did you mean {close}?" if close else ""


def is_near_miss(name: object, wanted: object) -> bool:
    """Return whether `name` is a misspelling of `wanted`, and not another name.

    It has one letter too few, too many or wrong, two letters swapped, another case or separator, or a number
    at the end: `comand`, `cmd-vel`, `cmd_vel2`. `state` is no near miss of `status`, nor is `pose2` of `pose1` or
    `wheel_r` of `wheel_l`, which may stand beside it, and no non-string is.
    """
    return isinstance(name, str) and isinstance(wanted, str) and _is_near_miss(name, wanted)


def is_near_topic(topic: str, wanted: str) -> bool:
    """Return whether a topic was probably meant to be another one."""
    return is_near_miss(topic, wanted) or topic.endswith(wanted) or topic == f"/{wanted.rpartition('/')[2]}"


@functools.lru_cache(maxsize=10_000)  # the same names come in each submission of a class
def _is_near_miss(name: str, wanted: str) -> bool:
    if name == wanted:
        return False
    if _letters(name) == _letters(wanted):
        return True
    are_numbered = re.sub(r"\d+", "0", name) == re.sub(r"\d+", "0", wanted)
    if len(wanted) < 5 or are_numbered or _are_lettered(name, wanted):
        return False
    is_one_edit = abs(len(name) - len(wanted)) < 2 and _edits(name.lower(), wanted.lower()) < 2
    return is_one_edit or re.sub(r"_?\d+$", "", name) == wanted


def _are_lettered(name: str, wanted: str) -> bool:
    """Return whether two names differ in words of one letter, such as `wheel_l` and `wheel_r`."""
    pairs = [*zip(re.split(r"[\W_]+", name), re.split(r"[\W_]+", wanted), strict=False)]
    different = [pair for pair in pairs if pair[0] != pair[1]]
    return bool(different) and all(len(word) == 1 for pair in different for word in pair)


def same_letters(name: str, other: str) -> bool:
    """Return whether two names differ only in case and separators."""
    return _letters(name) == _letters(other)


def has_other_words(name: str, other: str) -> bool:
    """Return whether two names differ in a whole word: `speed_sum` and `speed`, or `left_wheel` and `right_wheel`.

    Whoever writes another word, or one more, names another thing; a misspelt word is none.
    """
    if same_letters(name, other):
        return False
    longer, shorter = sorted((words_of(name), words_of(other)), key=len, reverse=True)
    left = iter(longer)
    is_within = all(any(_is_same_word(word, found) for found in left) for word in shorter)
    return is_within if len(shorter) < len(longer) else len(longer) > 1 and not is_within


def may_mean(name: str, member: str, known: Collection[str]) -> bool:
    """Return whether a name may be meant as a similar one of a library.

    Not if that has another word, nor if it or the name is only one of several that have a word more.
    """
    if not has_other_words(name, member):
        return True
    if any(_are_lettered(name, other) for other in known):
        return False  # `stop_b` beside `stop_a` is one more of them, and not `stop`
    parts = set(name.split("_"))
    longer = [other for other in known if set(other.split("_")) > parts and has_other_words(name, other)]
    return set(member.split("_")) < parts or longer == [member]


def words_of(name: str) -> list[str]:
    """Return the words of a name, in small letters."""
    return re.findall(r"[a-z]+|\d+", snake_case(name))


def begin_alike(name: str, other: str) -> bool:
    """Return whether each word of a name begins with the three letters of the word of the other that stands there."""
    words, others = words_of(name), words_of(other)
    return len(words) <= len(others) and all(
        len(word) > 2 and word[:3] == found[:3] for word, found in zip(words, others, strict=False)
    )


def program_words(name: str) -> str:
    """Return what tells a program from others: the words of its name, in any order, without that it is a node."""
    return " ".join(sorted(word for word in words_of(name.rpartition(".")[2]) if word != "node"))


def _is_same_word(word: str, other: str) -> bool:
    """Return whether a word is another one, misspelt or shortened."""
    shorter, longer = sorted((word, other), key=len)
    letters = iter(longer)
    is_short = shorter[0] == longer[0] and all(letter in letters for letter in shorter)
    is_alike = difflib.SequenceMatcher(None, word, other).ratio() >= _SAME_WORD or _edits(word, other) < 2
    return word == other or (len(shorter) > 2 and (is_short or is_alike))


_SAME_WORD = 0.7  # the least similarity of two spellings of a word, as difflib measures it


def edits(name: str, wanted: str) -> int:
    """Return how many slips of typing turn one name into the other.

    A slip is a letter too few, too many or wrong, or two letters swapped; case and separators do not count.
    """
    return 0 if same_letters(name, wanted) else _edits(name.lower(), wanted.lower())


@functools.lru_cache(maxsize=10_000)
def _edits(name: str, wanted: str) -> int:
    rows: list[list[int]] = [[*range(len(wanted) + 1)]]
    for i, letter in enumerate(name, 1):
        row = [i]
        for j, other in enumerate(wanted, 1):
            cost = min(row[-1] + 1, rows[-1][j] + 1, rows[-1][j - 1] + (letter != other))
            if i > 1 and j > 1 and (name[i - 2], letter) == (other, wanted[j - 2]):
                cost = min(cost, rows[-2][j - 2] + 1)
            row.append(cost)
        rows.append(row)
    return rows[-1][-1]


def _letters(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def plain_signs(text: str) -> str:
    """Return a text with typographic characters, as from a web page, replaced by those of a keyboard."""
    signs = {"\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"', "\u201e": '"', "\u00b4": "'"}
    signs |= {"\u2013": "-", "\u2014": "-", "\u2212": "-", "\u200b": "", "\ufeff": ""}
    # Letters stay, with their accents; a character that only looks like one of Python's becomes that one.
    return "".join(
        signs.get(letter, letter if letter.isalpha() else unicodedata.normalize("NFKC", letter))
        for letter in text
    )


def alike(folder: Path, wanted: str) -> str:
    """Return the path below a folder that differs from a wanted one only in case, separators or a plural's s.

    Empty if there is none, or if the wanted one exists.
    """
    here = folder
    for part in PurePosixPath(wanted).parts:
        names = [path.name for path in here.iterdir()] if here.is_dir() else []
        same = [part] if part in names else [name for name in names if _plain(name) == _plain(part)]
        if len(same) != 1:
            return ""
        here /= same[0]
    found = here.relative_to(folder).as_posix()
    return "" if found == wanted else found


def _plain(name: str) -> str:
    stem, dot, ending = name.partition(".")
    return f"{_letters(stem).removesuffix('s')}{dot}{ending.lower()}"


def differs(found: str, wanted: str) -> str:
    """Say what tells two names apart that are `alike`."""
    if found.lower() == wanted.lower():
        return "upper and lower case count"
    if _letters(found) == _letters(wanted):
        return "hyphens and underscores count"
    return "every letter counts"


def has_form_of(name: str, word: str) -> bool:
    """Return whether a word has as many levels as a name, and so may be meant for it; `pkg/Type` is no package."""
    return name.strip("/").count("/") == word.strip("/").count("/") and ":" not in word
