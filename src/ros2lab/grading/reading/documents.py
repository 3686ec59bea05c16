"""What was written for readers: the README, and recordings of running nodes."""

from __future__ import annotations

import ast
import contextlib
import itertools
import re
import zlib
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from ros2lab.diagnose.sources.interfaces import PACKAGES
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.grading.reading import markdown, plain_markup
from ros2lab.grading.reading.described import code_of
from ros2lab.grading.receiving.clean_copy import CHUNK, opened
from ros2lab.grading.receiving.submission import MOST_SOURCE, FoundPackage, Submission

LONGEST_README = 200_000  # characters
MOST_RECORDINGS = 10
LEAST_RECORDING = 40  # bytes, packed
MOST_NAMES = 20
MOST_FILES = 500  # that are searched for names

_README = re.compile(r"read[ _-]?me[^/]*", re.IGNORECASE)
_NOT_README = re.compile(r"(?:changelog|license|licence|contributing|todo|evidence)\b.*", re.IGNORECASE)
_RECORDINGS = re.compile(
    r".+\.(?:png|jpe?g|gif|webp|svg|mp4|webm|mkv|mov|cast|log|pdf)|.*(?:log|output|run|terminal|evidence).*\.txt",
    re.IGNORECASE | re.DOTALL,
)
_OF_ROS = re.compile(r"\b(?:ros2|colcon)\b")
_OF_CODE = frozenset((".py", ".xml", ".cfg", ".toml", ".yaml", ".yml", ".msg", ".srv", ".action"))
_MADE = ("setup.py", "ros2_ws", "robot_ws", "colcon_ws", "setup", "install", "build")
_WORD = re.compile(r"[A-Za-z_]\w*")
_PYTHON_FILE = re.compile(r"\b\w+\.py\b")
_TOPIC = re.compile(r"`(/[a-z]\w*(?:/[a-z]\w*)*)`")
_QUOTED = re.compile(r"`([A-Za-z_]\w*)(?:\(\))?`")
_OF_MARKDOWN = ("", ".md", ".markdown", ".mdown", ".html")
_TEXTS = frozenset(
    (*_OF_MARKDOWN, ".rst", ".txt", ".adoc", ".asciidoc", ".org")
)  # whose hidden parts are known


def recordings(root: Path, paths: Iterable[PurePosixPath]) -> list[str]:
    """Return the first few pictures, films and logs that are not empty; they may show the nodes running."""
    named = sorted(path for path in paths if _RECORDINGS.fullmatch(path.name))
    shown = (str(path) for path in named if _holds_something(root / path))
    return [*itertools.islice(shown, MOST_RECORDINGS)]


def _holds_something(path: Path) -> bool:
    """Return whether a file has more content than a few bytes, or the same ones again and again."""
    with contextlib.suppress(OSError), opened(path) as file:
        return len(zlib.compress(file.read(CHUNK))) >= LEAST_RECORDING
    return False


def readmes(
    root: Path, paths: Iterable[PurePosixPath], submission: Submission, launching: Iterable[FoundPackage] = ()
) -> str:
    """Return the text of the READMEs, the package's first; if there are none, of other notes near it.

    Args:
        root: the folder that holds the submission.
        paths: the paths of all its files, relative to `root`.
        submission: what was found there.
        launching: other packages that count because they launch the assignment's.

    Returns:
        The text, at most `LONGEST_README` characters; empty if there is none.
    """
    package = submission.package.folder if submission.package else None
    counting = [found.folder for found in (*submission.also, *launching)]
    own = {package, submission.workspace, *counting} - {None}
    others = {found.folder for found in submission.packages} - own
    near = [file for file in paths if not others & {*map(str, file.parents)} - {"."}]
    files = [file for file in near if _is_text(file)]
    named = [file for file in files if _README.fullmatch(file.name)] or [*filter(_is_in_other_form, near)]
    if not named:
        around = {".", "docs", "doc"}.union(*({folder, f"{folder}/docs", f"{folder}/doc"} for folder in own))
        # Their names may be in any language; a .txt, or a file without an ending, must be about ROS.
        named = [
            file
            for file in files
            if str(file.parent) in around
            and (file.suffix.lower() not in ("", ".txt") or _OF_ROS.search(_any_text(root / file)))
        ]
    named.sort(key=lambda file: (str(file.parent) != package, len(file.parts), str(file)))
    texts = (_shown(root / file) for file in named)
    return "\n\n".join(filter(None, dict.fromkeys(texts)))[:LONGEST_README]


def unrendered(paths: Iterable[PurePosixPath]) -> list[str]:
    """Return a note on each README in a form of which it is not known what its page hides."""
    note = "{} is in a form that is not rendered here: if it is a text, and there is no other README, it was read as it stands, with what its page may hide."
    return [note.format(file) for file in paths if _is_in_other_form(file)][:MOST_RECORDINGS]


def _is_in_other_form(file: PurePosixPath) -> bool:
    return bool(_README.fullmatch(file.name)) and file.suffix.lower() not in _TEXTS | _OF_CODE


def is_prose(file: PurePosixPath) -> bool:
    """Return whether a file is a text for people, judged by its ending."""
    return file.suffix.lower() in _TEXTS - {""}


def _is_text(file: PurePosixPath) -> bool:
    return file.suffix.lower() in _TEXTS and not _NOT_README.fullmatch(file.name)


def _shown(file: Path) -> str:
    text, kind = _any_text(file)[:LONGEST_README], file.suffix.lower()
    if kind in _OF_MARKDOWN or kind not in _TEXTS:  # which may hold HTML
        return markdown.shown(text)
    if kind == ".rst":
        from ros2lab.grading.reading import restructured  # noqa: PLC0415 -- docutils is slow to import, and few need it

        return restructured.shown(text)
    return plain_markup.shown(text, kind)


def _any_text(path: Path) -> str:
    """Return the beginning of a file in any encoding; empty if it is not text."""
    try:
        with path.open("rb") as file:
            data = file.read(4 * LONGEST_README)
    except OSError:
        return ""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    if b"\0" in data:
        return ""
    cut = data.decode("utf-8-sig", errors="replace")
    # A single character is replaced where the file was cut; more of them are another encoding.
    return cut if cut.count("�") <= 1 else data.decode("cp1252", errors="replace")


def named_in(text: str, sources: Iterable[PythonSource]) -> list[str]:
    """Return the classes, functions and files that a text names, unless their names are plain words."""
    kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    names = {node.name for source in sources for node in source.nodes if isinstance(node, kinds)}
    names |= {PurePosixPath(source.shown).name for source in sources}
    words = {*re.findall(r"[\w.]+\w", text)}
    return sorted(name for name in names & words if re.search(r"[a-z][A-Z]|[^\W_][_.]\w", name))[:MOST_NAMES]


def foreign_names(text: str, root: Path, paths: Iterable[PurePosixPath]) -> list[str]:
    """Return a README's names of code that the submission lacks, if they outnumber those that it has.

    A name of code is that of a Python file, or in backticks and either a topic or not a plain word.
    """
    named = {*_PYTHON_FILE.findall(text), *_TOPIC.findall(text)}
    named |= {name for name in _QUOTED.findall(text) if re.search(r"[a-z][A-Z]|\w_\w", name)}
    known, read = {*PACKAGES, *_MADE}, 0
    for path in sorted(paths, key=lambda path: (len(path.parts), path))[:MOST_FILES]:
        known |= {path.name, path.stem, *path.parts}
        if path.suffix in _OF_CODE and named:
            text = read_text(root / path)
            read += len(text)
            known |= {*_WORD.findall(code_of(text, path.suffix) if read < MOST_SOURCE else text)}
    foreign = sorted(name for name in named if not {*_WORD.findall(name)} <= known and name not in known)
    return foreign[:MOST_NAMES] if 2 < len(foreign) > len(named) / 2 else []
