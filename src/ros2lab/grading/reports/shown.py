"""How texts and numbers are shown: a submission's texts are visible, shortened, and have no effect."""

from __future__ import annotations

import re
import unicodedata

LONGEST = 400  # characters of a text
MOST_MARKS = 4  # marks on one letter; more of them cover other lines

_HIDDEN = ("Cc", "Cf", "Cs", "Zl", "Zp")
_JOINERS = (0x200C, 0x200D)  # some scripts need them
# At the beginning of a cell; where a spreadsheet divides by something else than a comma, also in the middle of a text.
_FORMULA = re.compile(r"(^|[;\t\r\n])(?=\s*[=+@\-\uff1d\uff0b\uff0d\uff20])")


class _Signs(dict[int, str]):
    """The sign for each character, computed when it is first needed."""

    def __missing__(self, code: int) -> str:
        if code < 0x20:
            sign = chr(0x2400 + code)
        elif code == 0x7F:
            sign = "\u2421"
        elif is_hidden(code):
            sign = f"<U+{code:04X}>"
        else:
            sign = chr(code)
        self[code] = sign
        return sign


def is_hidden(code: int) -> bool:
    """Return whether a character is invisible or changes how others look, such as controls and surrogates."""
    is_none = code & 0xFFFE == 0xFFFE  # a Unicode noncharacter
    return is_none or (code not in _JOINERS and unicodedata.category(chr(code)) in _HIDDEN)


_SIGNS = _Signs()


def visible(text: object, longest: int = LONGEST, *, keeps_lines: bool = False) -> str:
    """Return a text with signs for what cannot be seen, such as ␛ or <U+202E>.

    Args:
        text: of any origin.
        longest: in characters; what is cut off is counted at the end.
        keeps_lines: whether line ends stay and tabs become spaces; else they are shown as ␊ and ␉.
    """
    whole = str(text)
    cut = whole[:longest]
    if keeps_lines:
        lines = cut.replace("\r\n", "\n").replace("\t", "    ").split("\n")
        result = "\n".join(_bounded_marks(line.translate(_SIGNS)) for line in lines)
    else:
        result = _bounded_marks(cut.translate(_SIGNS))
    left_out = len(whole) - len(cut) + max(0, len(result) - longest)
    return f"{result[:longest]}… ({left_out} more characters)" if left_out else result


def disarmed(text: str) -> str:
    """Return a text changed so that no spreadsheet takes it for a formula."""
    return _FORMULA.sub(r"\1'", text)


def number(value: float) -> str:
    """Return points or seconds with at most two decimals."""
    return f"{round(value, 2):.15g}"


def title(component: str) -> str:
    """Return a component's name for use in a heading."""
    return component.replace("_", " ").capitalize()


def _bounded_marks(text: str) -> str:
    if text.isascii():
        return text
    result, marks = [], 0
    for letter in text:
        marks = marks + 1 if unicodedata.category(letter) in ("Mn", "Me") else 0
        result.append(letter if marks <= MOST_MARKS else f"<U+{ord(letter):04X}>")
    return "".join(result)
