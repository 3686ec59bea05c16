"""What docstrings and comments say of the definitions that run."""

from __future__ import annotations

import ast
import contextlib
import io
import itertools
import re
import textwrap
import tokenize
import unicodedata
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ros2lab.diagnose.sources.python_source import Function, PythonSource
from ros2lab.grading.code.running import Code
from ros2lab.grading.reading.launch_files import without_comments
from ros2lab.manifest_words import FEWEST_WORDS, words_in

MOST_NAMES_OF_ONE = 3  # definitions that may share a docstring
LONGEST_ARTICLE = 3  # letters
STEM = 4  # letters, in which words of one family agree, in many languages
_LETTERS = re.compile(r"[^\W\d_]+")
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])")
_A_WORD = re.compile(r"[^\W\d_]{2}|[^\W\da-zA-Z_]")  # in some scripts, a single letter is a word
# What a licence and the tutorials of ROS have written in many files.
_OF_OTHERS = re.compile(
    r"copyright|licen[sc]e|prevent unused variable|destroy the node explicitly", re.IGNORECASE
)
_FILE_NAME = re.compile(r"\S+\.py\b")
_OF_TOOLS = re.compile(r"#\s*(?:[!/]|(?:todo|fixme|xxx)\b)|#.*(?:coding[:=]|noqa|type:)", re.IGNORECASE)
_NEVER_PROSE = (
    ast.Assign,
    ast.AugAssign,
    ast.Call,
    ast.ImportFrom,
    ast.FunctionDef,
    ast.ClassDef,
    ast.If,
    ast.For,
    ast.While,
    ast.With,
    ast.Try,
)
_DESCRIPTION = re.compile(
    r"<description\b(?s:.*?)(?:</description|\Z)|\bdescription\s*[:=]\s*(?:(['\"])(?s:.*?)\1|[^\n]*)"
)


def described(sources: Iterable[PythonSource], code: Code = (), readme: str = "") -> dict[str, list[int]]:
    """Count the modules, classes and functions with a docstring or a comment, and all of them, by kind.

    A module is described by itself or by one of its classes.

    Under `about` are those of which a word also stands in the code of their file or in the README, and all that
    have a docstring or a comment.

    Args:
        sources: the modules.
        code: the nodes that run. A described definition that never runs, or does nothing, is not counted.
        readme: the text of the README.
    """
    running = {node for _, node in code}
    by_source = {source: [*_describable(source, running)] for source in sources}
    found = [definition for definitions in by_source.values() for definition in definitions]
    said = _said_of_many(found) | _generated(found)
    counts = {"modules": [0, 0], "classes": [0, 0], "functions": [0, 0], "about": [0, 0]}
    for source, definitions in by_source.items():
        known = _stems(code_of(source.text, ".py")) | _stems(readme)
        used = [definition for definition in definitions if definition.texts and not definition.is_vain]
        counts["about"][0] += sum(
            any(_is_about(text, known) for text in definition.texts) for definition in used
        )
        counts["about"][1] += len(used)
    for definitions in by_source.values():
        told = [
            any(said.isdisjoint((text, definition.rest(text))) for text in definition.texts)
            for definition in definitions
        ]
        own = zip(definitions, told, strict=True)
        has_class = any(is_told and one.kind == "classes" and not one.is_vain for one, is_told in own)
        for definition, is_told in zip(definitions, told, strict=True):
            is_described = is_told or (has_class and definition.kind == "modules")
            if is_described and definition.is_vain:
                continue
            if is_described or not definition.says_itself:
                counts[definition.kind][0] += is_described
                counts[definition.kind][1] += 1
    return counts


def _stems(text: str) -> set[str]:
    """Return the beginnings of a text's longer words, also of those of which a name is made."""
    words = _LETTERS.findall(_HUMP.sub(" ", text).lower())
    return {word[:STEM] for word in words if len(word) >= STEM}


def _is_about(text: str, known: Collection[str]) -> bool:
    """Return whether a text and some code have a word in common; none is asked for in a script that code has not."""
    is_latin = all(unicodedata.name(letter, "").startswith("LATIN") for letter in text if letter.isalpha())
    return not is_latin or not _stems(text).isdisjoint(known)


@dataclass(frozen=True)
class _Describable:
    """A module, a class or a function, and the words about it.

    Attributes:
        kind: `modules`, `classes` or `functions`.
        names: its own name, followed by those of its parameters; empty for a module.
        docstring: its docstring; empty if that says no more than the name.
        comments: its own comments.
        says_itself: whether it needs no words.
        is_vain: whether it never runs, or does nothing.
    """

    kind: str
    names: Sequence[str]
    docstring: str
    comments: Sequence[str]
    says_itself: bool = False
    is_vain: bool = False

    @property
    def texts(self) -> list[str]:
        """Its docstring, unless it is empty, and its comments."""
        return [*filter(None, [self.docstring]), *self.comments]

    def rest(self, text: str) -> str:
        """Return the words of a text in lower case, without those of the names."""
        own = {*_LETTERS.findall(" ".join(self.names).lower())}
        return " ".join(word for word in dict.fromkeys(_LETTERS.findall(text.lower())) if word not in own)


def _said_of_many(found: Iterable[_Describable]) -> set[str]:
    """Return the docstrings that definitions of too many names share, so that they describe none of them.

    Modules do not count: a class may repeat its module's docstring.
    """
    names: dict[str, set[str]] = {}
    for definition in found:
        if definition.names and definition.docstring:
            names.setdefault(definition.docstring, set()).add(definition.names[0])
    return {text for text, sharing in names.items() if len(sharing) > MOST_NAMES_OF_ONE}


def _generated(found: Iterable[_Describable]) -> set[str]:
    """Return the few texts that most described definitions share, apart from names: a program can write them.

    A person may have written them if only words as short as an article or a preposition are left, and may say the
    same of a few of one kind, such as of the callbacks; hardly of classes and of functions.
    """
    sharing: dict[str, dict[str, str]] = {}  # by text, the names with their kinds
    for definition in found:
        for text in definition.texts if definition.names else ():
            sharing.setdefault(definition.rest(text), {})[definition.names[0]] = definition.kind
    alike = {
        text: kinds
        for text, kinds in sharing.items()
        if len(kinds) > MOST_NAMES_OF_ONE - (len({*kinds.values()}) > 1)
        and any(len(word) > LONGEST_ARTICLE for word in text.split())
    }
    is_most = len({*itertools.chain(*alike.values())}) > len({*itertools.chain(*sharing.values())}) / 2
    return {*alike} if is_most else set()


def _describable(source: PythonSource, running: Collection[ast.AST]) -> Iterator[_Describable]:
    comments = _comments(source.text) if source.tree.body else {}
    if source.tree.body:
        first = source.tree.body[0].lineno
        above = [token.string for line, token in comments.items() if line < first]
        yield _Describable("modules", [], _docstring(source.tree), above)
    lines = source.text.splitlines()
    named = [n for n in source.nodes if isinstance(n, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef))]
    of_classes: dict[ast.AST, list[int]] = {
        node: _of_class(node, comments, lines) for node in named if isinstance(node, ast.ClassDef)
    }
    left = {line: token for line, token in comments.items() if line not in set().union(*of_classes.values())}
    for node in named:
        is_class = isinstance(node, ast.ClassDef)
        given = [] if isinstance(node, ast.ClassDef) else [*ast.walk(node.args)]
        yield _Describable(
            "classes" if is_class else "functions",
            [node.name, *(parameter.arg for parameter in given if isinstance(parameter, ast.arg))],
            _docstring(node),
            [
                *(comments[line].string for line in of_classes.get(node, ())),
                *_own_comments(node, left, lines),
            ],
            _says_itself(node, named),
            _does_nothing(node) or bool(running and node not in running),
        )


def _of_class(node: ast.ClassDef, comments: Collection[int], lines: Sequence[str]) -> list[int]:
    """Return the lines of the comments between the head of a class and its first definition that are about the class.

    Those right above the definition are about that one if a blank line is above them.
    """
    first = node.body[0]
    if not isinstance(first, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
        return [line for line in comments if node.lineno <= line <= first.lineno]
    start = above = _start(first)
    while above - 1 in comments and above - 1 > node.lineno:
        above -= 1
    end = start if lines[above - 2].strip() else above
    return [line for line in comments if node.lineno <= line < end]


def _start(node: ast.ClassDef | Function) -> int:
    """Return the first line of a definition, with its decorators."""
    return min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])


def _own_comments(
    node: ast.ClassDef | Function, comments: Mapping[int, tokenize.TokenInfo], lines: Sequence[str]
) -> list[str]:
    """Return the comments in a function, and the one right above a definition, of those that are about no class above."""
    start = _start(node)
    # Comments in its methods do not describe a class.
    end = start if isinstance(node, ast.ClassDef) else node.end_lineno or node.lineno
    above = start - 1
    while above > 0 and not lines[above - 1].strip():
        above -= 1
    own = [token.string for line, token in comments.items() if start <= line <= end]
    # A comment further to the right is the end of the function above.
    if above in comments and comments[above].start[1] <= node.col_offset:
        own.append(comments[above].string)
    return own


def _says_itself(node: ast.ClassDef | Function, named: Sequence[ast.ClassDef | Function]) -> bool:
    """Return whether a definition needs no words: `__init__`, `main` beside others, a single statement."""
    is_short = len(node.body) == 1 and not {"body", "cases"} & {*node.body[0]._fields}
    is_known = re.fullmatch(r"__\w+__|setUp|tearDown", node.name) or (node.name == "main" and len(named) > 1)
    return is_short or bool(is_known)


def _does_nothing(node: ast.ClassDef | Function) -> bool:
    """Return whether a function only passes, or returns a constant."""
    if isinstance(node, ast.ClassDef):
        return False
    return all(
        isinstance(statement, ast.Pass)
        or (
            isinstance(statement, (ast.Expr, ast.Return))
            and (not statement.value or isinstance(statement.value, ast.Constant))
        )
        for statement in node.body
    )


def _docstring(node: ast.Module | ast.ClassDef | Function) -> str:
    """Return a docstring if it is prose and more than the name or a to-do note; otherwise empty."""
    text = ast.get_docstring(node) or ""
    name = getattr(node, "name", "").replace("_", "").lower()
    is_name = bool(name) and re.sub(r"[\W_]", "", text).lower() == name
    return text if not is_name and any(_is_prose(f"# {line}") for line in text.splitlines()) else ""


def _comments(text: str) -> dict[int, tokenize.TokenInfo]:
    """Return the comments that were written for readers, by line.

    Licences, a tutorial's, settings of tools, to-do notes, single words, names of files and commented-out code are not.
    """
    return {
        token.start[0]: token
        for block in _blocks(found for found in _tokens(text) if found.type == tokenize.COMMENT)
        if not _is_code(textwrap.dedent("\n".join(token.string[1:] for token in block)))
        and not any(_OF_OTHERS.search(token.string) for token in block)
        and len({*words_in(_FILE_NAME.sub("", " ".join(token.string for token in block)))}) >= FEWEST_WORDS
        for token in block
        if _is_prose(token.string)
    }


def code_of(text: str, suffix: str) -> str:
    """Return the text of a file of code without comments, docstrings and descriptions."""
    if suffix == ".py":
        tokens = [token for token in _tokens(text) if token.type not in (tokenize.NL, tokenize.COMMENT)]
        begin = (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.STRING)
        before = [tokenize.NEWLINE, *(token.type for token in tokens)]
        text = " ".join(
            token.string
            for token, kind in zip(tokens, before, strict=False)
            if token.type != tokenize.STRING or kind not in begin
        )
    return _DESCRIPTION.sub("", without_comments(text))


def _tokens(text: str) -> Iterator[tokenize.TokenInfo]:
    """Yield the tokens of Python, as far as it can be read."""
    with contextlib.suppress(tokenize.TokenError, SyntaxError, RecursionError):
        yield from tokenize.generate_tokens(io.StringIO(text).readline)


def _blocks(tokens: Iterable[tokenize.TokenInfo]) -> list[list[tokenize.TokenInfo]]:
    """Group comments on consecutive lines that start in the same column; one behind code stands alone."""
    blocks: list[list[tokenize.TokenInfo]] = []
    for token in tokens:
        is_next = blocks and (blocks[-1][-1].start[0] + 1, blocks[-1][-1].start[1]) == token.start
        if is_next and token.line.lstrip().startswith("#"):
            blocks[-1].append(token)
        else:
            blocks.append([token])
    return blocks


def _is_prose(comment: str) -> bool:
    text = comment.lstrip("# ")
    is_path = " " not in text and bool(re.search(r"[/.]\w", text))
    is_read = _A_WORD.search(text) and not _OF_TOOLS.match(comment)
    return bool(is_read) and not is_path and not _is_code(text)


def _is_code(text: str) -> bool:
    """Return whether a comment is Python code that cannot be prose."""
    for end in ("", "\n    pass"):  # it may be the first line of a block
        try:
            statements = ast.parse(text + end).body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            continue
        values = [
            statement.value if isinstance(statement, ast.Expr) else statement for statement in statements
        ]
        # A line of prose may be a name, a comparison (`the robot is ready`) or `import messages`.
        return any(isinstance(value, _NEVER_PROSE) for value in values)
    return False
