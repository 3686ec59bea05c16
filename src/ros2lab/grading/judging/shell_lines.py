"""Whether a shell would run a command in the code of a README: whether one starts there and is reached."""

from __future__ import annotations

import re
import shlex

# POSIX's utilities that invoke another utility; sudo and watch do so, too.
_INVOKING = frozenset(
    ("command", "env", "eval", "exec", "nice", "nohup", "time", "timeout", "xargs", "sudo", "watch")
)
_RESERVED = frozenset(("!", "{", "then", "do", "else", "elif", "if", "while", "until"))
_OPERATORS = frozenset(("&&", "||", ";", "|", "&", "|&", "(", ")", ";;"))
_NEVER = frozenset((("false", "&&"), ("true", "||"), (":", "||")))
_SETTING = re.compile(r"\w+\+?=.*", re.DOTALL)
_HANDED = re.compile(r"--|-\w*[cex]")  # the option after which a terminal or a shell is told what to run
_PROMPT = re.compile(r"\s*(?:[^\n#]*?[^\s#]?[$%]|[^\s<#]*>|[^\s#]+@[^\s#]+#)\s+|\s*[$%>]\s*")
_LABEL = re.compile(r".*\w[.):\]]|[-*+>]", re.DOTALL)  # such as `Terminal 1:`
_HEREDOC = re.compile(r"<<-?\s*(['\"]?)(\w+)\1[^\n]*\n.*?(?:^\s*\2\s*$|\Z)", re.MULTILINE | re.DOTALL)
_SHUT = re.compile(
    r"^\s*(?:if|while)\s+false\s*(?:;|\n).*?(?:^\s*|;\s*)(?:fi|done)\b", re.MULTILINE | re.DOTALL
)


def is_run(text: str, start: int) -> bool:
    """Return whether a shell would run the command that starts at a place in some code."""
    if any(
        match.start() < start < match.end() for kind in (_HEREDOC, _SHUT) for match in kind.finditer(text)
    ):
        return False
    line = text[text.rfind("\n", 0, start) + 1 : start]
    prompt = _PROMPT.match(line)
    return _begins(line[prompt.end() :] if prompt else line)


def _begins(before: str) -> bool:
    """Return whether a command can begin after these words of its line."""
    try:
        words = _words(before)
    except ValueError:  # inside open quotes
        quote = max(before.rfind("'"), before.rfind('"'))
        handed = before[:quote].split()[-1:]
        is_handed = bool(handed) and bool(handed[0] in _INVOKING or _HANDED.fullmatch(handed[0]))
        return is_handed and _begins(before[quote + 1 :])
    if words is None:
        return False
    commands: list[tuple[list[str], str]] = [([], "")]
    for word in words:
        if word in _OPERATORS:
            commands[-1] = (commands[-1][0], word)
            commands.append(([], ""))
        else:
            commands[-1][0].append(word)
    if any((" ".join(command), sign) in _NEVER for command, sign in commands):
        return False
    return _is_handed_on(commands[-1][0])


def _words(before: str) -> list[str] | None:
    """Return the words and operators of the beginning of a line; None if it ends in a comment."""
    lexer = shlex.shlex(before + " end", posix=True, punctuation_chars=True)
    lexer.whitespace_split, lexer.commenters = True, "#"
    words = [*lexer]
    return words[:-1] if words[-1:] == ["end"] else None


def _is_handed_on(words: list[str]) -> bool:
    """Return whether a command runs after these words: variable settings, or a utility that invokes it."""
    while words and (_SETTING.fullmatch(words[0]) or words[0] in _RESERVED):
        words = words[1:]
    if not words or words[0] in _INVOKING:
        return True
    last = words[-1]
    return bool(_HANDED.fullmatch(last) or _LABEL.fullmatch(last))
