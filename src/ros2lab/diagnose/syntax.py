"""A file that Python cannot parse."""

from __future__ import annotations

import re

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.python_source import PythonSource


def syntax_finding(code: str, source: PythonSource) -> Finding:
    """Explain why Python cannot read a file; `source.fault` says it."""
    fault = source.fault
    assert fault is not None
    line = fault.lineno
    return Finding(
        code, f"Python cannot read {source.shown}: {explained(fault)}.", at(source.shown, line), fix(fault)
    )


def explained(fault: SyntaxError) -> str:
    """Say in plain words what Python says of a syntax error."""
    said = fault.msg or "invalid syntax"
    if isinstance(fault, TabError):
        return "tabs and blanks are mixed in the indentation"
    if isinstance(fault, IndentationError):
        return f"the indentation is wrong ({said})"
    if "codec" in said:
        return f"it is not saved in UTF-8, so a letter with an accent or an umlaut cannot be read ({said})"
    return said.removesuffix(".").removesuffix("?")


def fix(fault: SyntaxError) -> str:
    """Say what to do about a syntax error."""
    if isinstance(fault, IndentationError):
        return "indent with four blanks everywhere, and never with tabs"
    if "codec" in (fault.msg or ""):
        return "save the file anew with the encoding UTF-8"
    if match := re.search(r"invalid (?:non-printable )?character (.+)", fault.msg or ""):
        return f"delete {match[1].rstrip('.')}, which was copied from a web page or a text, and type a plain blank, quote or minus in its place"
    if "comma" in (fault.msg or ""):
        return "put the comma that is missing at the end of this line or of the one above"
    if "never closed" in (fault.msg or "") or "EOF" in (fault.msg or ""):
        return "close the bracket or the quote"
    return "look at this line, and at the end of the one above: a comma, a bracket, a colon or a quote is missing"
