"""Lines in the syntax of other languages, with letters copied from a web page or with invalid names, as Python has them."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator

from ros2lab.diagnose.code.line_edits import USUAL, Repair
from ros2lab.diagnose.sources.spelling import plain_signs


def _rule(pattern: str, new: str, why: str) -> tuple[re.Pattern[str], str, str]:
    return re.compile(pattern), new, why


# Syntax of other languages; a change is reported only if Python can read on after it.
_FOREIGN = (
    _rule(r"(?<!=)(?<![\w)\]])(\+\+|--)([\w.]+)\s*;?\s*$", r"\2 \1= 1", "Python has no `++` or `--`"),
    _rule(r"([\w.\]]+)\s*\+\+\s*;?\s*$", r"\1 += 1", "Python has no `++`"),
    _rule(r"([\w.\]]+)\s*--\s*;?\s*$", r"\1 -= 1", "Python has no `--`"),
    _rule(r"\s*&&\s*", " and ", "Python writes `and` where other languages write `&&`"),
    _rule(r"\s*\|\|\s*", " or ", "Python writes `or` where other languages write `||`"),
    _rule(r"!(?!=)\s*", "not ", "Python writes `not` where other languages write `!`"),
    _rule(r"([=!])==", r"\1=", "Python compares with == and !="),
    _rule(r"\(([\w, ]*)\)\s*=>\s*", r"lambda \1: ", "Python writes a short function with `lambda`"),
    _rule(
        r"(\w)\s*==\s*(?=[^()]*\)\s*(?:->.*)?:?\s*$)",
        r"\1=",
        "a default or a keyword argument is given with a single =",
    ),
    _rule(r"=([<>])(?!=)", r"\1=", "in a comparison the = comes last, as in >= and <="),
    _rule(r"<>", "!=", "Python writes != where other languages write <>"),
    _rule(r"^(\s*)\}?\s*(?:else\s+if|elseif|elsif)\b", r"\1elif", "Python writes `elif` for `else if`"),
    _rule(r"^(\s*)\}\s*(else|elif|except|finally)\b", r"\1\2", "Python has no braces around blocks"),
    _rule(r"\s*\{\s*$", ":", "Python begins a block with a colon, not with a brace"),
    _rule(r"^\s*[}]\s*;?\s*$", "", "Python ends a block by its indentation, not with a brace"),
    _rule(r"^\s*end\s*$", "", "Python ends a block by its indentation, not with `end`"),
    _rule(r"\s+(?:then|do)\s*:?\s*$", ":", "Python begins a block with a colon"),
    _rule(r"^(\s*)(?://|/\*|<!--)\s?(.*?)\s*(?:\*/|-->)?$", r"\1# \2", "a comment in Python begins with #"),
    _rule(r"\s*//\s*(?=[A-Za-z]).*$", "", "a comment in Python begins with #, not with //"),
    _rule(r"->|::", ".", "Python writes a dot where other languages write -> or ::"),
    _rule(r"\bnew\s+(?=[A-Z])", "", "Python creates an object without `new`"),
    _rule(
        r"^(\s*)catch\s*\(?\s*(\w+)(?:\s+(\w+))?\s*\)?\s*:?",
        r"\1except \2 as \3:",
        "Python writes `except` for `catch`",
    ),
    _rule(r"^(\s*)except\s+(\w+)\s*,\s*(\w+)\s*:", r"\1except \2 as \3:", "Python writes `as` here"),
    _rule(r"^(\s*)throw\s+(?:new\s+)?", r"\1raise ", "Python writes `raise` for `throw`"),
    _rule(
        r"^(\s*)(?:for|foreach)\s*\(\s*(?:\w+\s+)?(\w+)\s*=\s*(\w+)\s*;\s*\w+\s*<\s*([^;]+);.*?\)\s*[:{]?",
        r"\1for \2 in range(\3, \4):",
        "Python counts with `for ... in range(...)`",
    ),
    _rule(
        r"^(\s*)import\s+([\w, ]+?)\s+from\s+([\w.]+)\s*$",
        r"\1from \3 import \2",
        "the module is named first, and then what is imported from it",
    ),
    _rule(r"^(\s*)from\s+([\w.]+)\s+(?!import\b)(\w+)\s*$", r"\1from \2 import \3", "`import` is missing"),
    _rule(r"^(\s*)(print|exec)\s+([^=].*?);?\s*$", r"\1\2(\3)", "Python 3 calls a function with parentheses"),
    _rule(
        r"^(\s*)(?!def\b|class\b|async\b|if\b|elif\b|while\b|for\b|with\b|return\b)(?:[\w<>]+\s+)+(\w+)\s*(\(.*\))\s*[:{]?\s*$",
        r"\1def \2\3:",
        "a function begins with `def`, without a type in front of it",
    ),
    _rule(
        r"^(\s*)(?!if\b|elif\b|while\b|return\b|del\b|self\b)[A-Za-z_][\w.:<>]*[&*]?\s+(?:\w+\s+)?((?:self\.)?\w+\s*=(?!=).*?);?\s*$",
        r"\1\2",
        "a variable is created by giving it a value, without a type or a keyword in front of it",
    ),
    _rule(
        r"^(\s*(?:if|elif|while)\b[^=]*[^=!<>:])=(?!=)\s*",
        r"\1== ",
        "a single = assigns a value; == compares",
    ),
    _rule(r"\b0+(?=[1-9]\d*\b)", "", "an integer may not begin with 0"),
    _rule(r"^(\s*(?:def|class)\s+)(\d+)(\w+)", r"\1\3\2", "a name may not begin with a digit"),
    _rule(r"(?<!\w)(\d+)([A-Za-z_]\w+)(?=\s*[=.(])", r"\2\1", "a name may not begin with a digit"),
)


def in_pythons_words(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with typographic characters and the syntax of other languages replaced by Python's."""
    plain = plain_signs(line)
    if plain != line:
        strange = next(letter for letter in line if plain_signs(letter) != letter)
        why = f"the letter {strange!r} (U+{ord(strange):04X}) was copied from a web page or a document"
        yield Repair(number, plain, why)
    yield from _names(number, plain)
    versions = [(plain, "")]
    for _ in range(3):
        versions = [
            (changed, why or said)
            for text, why in versions
            for pattern, new, said in _FOREIGN
            if (changed := pattern.sub(new, text)) != text
        ][:30]
        yield from (Repair(number, text, why, USUAL - 0.15) for text, why in versions)


def _names(number: int, line: str) -> Iterator[Repair]:
    """Yield a line with an invalid name replaced by a valid one."""
    for word in dict.fromkeys(re.findall(r"(?<=\.)[a-z]+\b|\b[a-z]+(?=\s*=[^=])|(?<=def )[a-z]+\b", line)):
        if keyword.iskeyword(word):
            new = re.sub(rf"(?<![\w]){word}(?!\w)(?=\s*[=.(\[,)]|\s*$)", f"{word}_", line)
            yield Repair(number, new, f"{word} is a Python keyword and cannot be used as a name")
    for name in re.findall(r"[A-Za-z_]\w*(?:-[A-Za-z_]\w*)+", line):
        new = line.replace(name, name.replace("-", "_"))
        yield Repair(number, new, f"{name} contains a minus sign, which a name may not")
