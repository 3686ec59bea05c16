"""A CSV of names with paths or git addresses, and the checkouts of these."""

from __future__ import annotations

import csv
import hashlib
import os
import re
import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from urllib.parse import unquote

from ros2lab.classroom.handed_in import ClassError, HandedIn
from ros2lab.git import ended
from ros2lab.grading.receiving.clean_copy import MOST_BYTES, MOST_MEMBERS

# What a column may be called; of several, the first counts that says something in a line.
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "name": ("name", "full name", "student"),
    "id": ("id", "student id", "sid", "login"),
    "email": ("email", "email address", "mail"),
    "where": ("path", "submission", "git", "repository", "url", "address"),
    "late": ("late",),
    "attempt": ("attempt",),
}
CLONE_TIMEOUT = 120.0  # s
_ADDRESS = re.compile(r"(https?|ssh|git)://|[\w.-]+@[\w.-]+:")
_FILE = "file://"
_NUMBER = re.compile(r"\d{1,9}")
_WARNING = re.compile("warning:", re.IGNORECASE)
_SPEAKER = re.compile(r"(fatal|error|remote): ")
_YES = ("1", "y", "yes", "true", "late", "x")


def read(path: Path, received: Path) -> list[HandedIn]:
    """Return a row for each line of a CSV, which students may have filled in: paths of it lie in its folder.

    Args:
        path: with a header line.
        received: where git addresses are checked out.

    Raises:
        ClassError: if it cannot be read, or has no columns for the name and for what was handed in.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = [*csv.DictReader(file)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ClassError(
            f"{path} cannot be read ({error}); give a CSV in UTF-8 with a header line."
        ) from None
    header = [name for name in (lines[0] if lines else {}) if name]
    columns = {
        what: [name for name in header if name.strip().lower() in known] for what, known in COLUMNS.items()
    }
    if not columns["where"] or not (columns["name"] or columns["id"]):
        raise ClassError(
            f"{path} needs a column `name` or `id`, and a column `path` or `git`; it has {', '.join(header) or 'none'}."
        )
    return [*_rows(path, lines, columns, received)]


def _rows(
    path: Path, lines: list[dict[str, str]], columns: Mapping[str, Sequence[str]], received: Path
) -> Iterator[HandedIn]:
    table = [
        {
            what: next(filter(None, ((line.get(name) or "").strip() for name in names)), "")
            for what, names in columns.items()
        }
        for line in lines
    ]
    namesakes = _namesakes(table)
    for number, cells in enumerate(table, start=2):
        if not any(cells.values()):
            continue
        label = key = cells["id"] or cells["name"] or cells["email"] or f"line {number}"
        notes: tuple[str, ...] = ()
        if not cells["id"] and key in namesakes:
            key = f"{key} ({cells['email'] or cells['where'] or f'line {number}'})"
            notes = (f"Another line of {path.name} has this name, too, and no id tells whose it is.",)
        try:
            place, reason = _handed_in(cells["where"], path.parent, received)
        except ValueError as error:
            place, reason = Path(), f"Line {number} of {path.name} names {error}."
        yield HandedIn(
            key,
            cells["name"] or label,
            cells["id"],
            cells["email"],
            () if reason else (place,),
            attempt=int(cells["attempt"]) if _NUMBER.fullmatch(cells["attempt"]) else 1,
            is_late=cells["late"].lower() in _YES,
            upload=number,
            label=label,
            reason=reason,
            notes=notes,
        )


def _namesakes(table: Iterable[Mapping[str, str]]) -> set[str]:
    """Return the names under which several people may stand: no id, no email address and no attempt says they are one."""
    lines: dict[str, list[Mapping[str, str]]] = {}
    for cells in table:
        if cells["name"] and not cells["id"]:
            lines.setdefault(cells["name"], []).append(cells)
    found = set()
    for name, alike in lines.items():
        emails = {cells["email"] for cells in alike}
        attempts = {cells["attempt"] for cells in alike}
        is_one = len(emails) == 1 and (emails != {""} or len(attempts) == len(alike))
        if not is_one:
            found.add(name)
    return found


def _handed_in(where: str, folder: Path, received: Path) -> tuple[Path, str]:
    """Return what a cell names, and a sentence if it cannot be had; a ValueError says why it may not."""
    if not where:
        raise ValueError("nothing that was handed in")
    if _ADDRESS.match(where):
        return checked_out(where, received)
    is_repository = where.startswith(_FILE)
    named = folder / (unquote(where.removeprefix(_FILE)) if is_repository else where)
    try:
        place = named.resolve(strict=True)
    except (OSError, ValueError, RuntimeError):
        raise ValueError(f"{where}, which is not there") from None
    if folder.resolve() not in place.parents:
        raise ValueError(f"{where}, which does not lie in the folder of that CSV; put it there")
    for above in (named, *named.parents):
        if above.samefile(folder):
            break
        if above.is_symlink():
            raise ValueError(
                f"{where}, which is a link to {above.readlink()}; put the files themselves there"
            )
    if not is_repository and all((named / part).exists() for part in ("HEAD", "objects", "refs")):
        raise ValueError(f"{where}, which is a bare repository of git; write {_FILE}{where}")
    return checked_out(place.as_uri(), received) if is_repository else (named, "")


def checked_out(address: str, received: Path) -> tuple[Path, str]:
    """Return the newest state of a repository, and a sentence if it cannot be had; nothing of it is run."""
    folder = received / f"git-{hashlib.sha256(address.encode()).hexdigest()[:16]}"
    if not (folder / ".git").is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        _git(folder, "init", "--quiet")
    problem = (
        _git(folder, "fetch", "--quiet", "--depth=1", "--no-tags", "--end-of-options", address, "HEAD")
        or _too_much(folder)
        or _git(folder, "checkout", "--quiet", "--force", "--detach", "FETCH_HEAD")
    )
    return folder, f"{address} cannot be cloned: {problem}." if problem else ""


def _too_much(folder: Path) -> str:
    """Say whether what was fetched is more than a submission may hold: a few bytes of git can be any number of files."""
    tree = ("ls-tree", "-r", "-t", "--long", "FETCH_HEAD")
    with subprocess.Popen(
        _calm_git(*tree), cwd=folder, env=_environ(), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as listing:
        assert listing.stdout is not None
        left = MOST_BYTES
        for number, entry in enumerate(listing.stdout):
            size = entry.split(maxsplit=4)[3]
            left -= int(size) if size.isdigit() else 0
            if left < 0 or number == MOST_MEMBERS:
                listing.kill()
                return f"it holds more than {MOST_BYTES / 1e6:g} MB, or {MOST_MEMBERS} files and folders"
    return ""


def _calm_git(*words: str) -> list[str]:
    """Return a command of git that runs no program of a repository, and writes no file of any size."""
    calm = ("-c", "core.hooksPath=/dev/null", "-c", "core.fsmonitor=false", "-c", "core.symlinks=true")
    return ["prlimit", f"--fsize={MOST_BYTES}", "--", "git", *calm, *words]


def _environ() -> dict[str, str]:
    """Return an environment in which git asks nothing."""
    return {
        **os.environ,
        "LC_ALL": "C.UTF-8",  # what it says is told on
        "GIT_TERMINAL_PROMPT": "0",
        "GIT_ALLOW_PROTOCOL": "https:http:ssh:git:file",
        "GIT_SSH_COMMAND": "ssh -oBatchMode=yes",
        "GIT_LFS_SKIP_SMUDGE": "1",
    }


def _git(folder: Path, *words: str) -> str:
    """Run git; return what it says if it fails."""
    if not shutil.which("git"):
        return "git is not installed"
    try:
        done = ended(_calm_git(*words), folder, _environ(), CLONE_TIMEOUT)
    except subprocess.TimeoutExpired:
        return f"it took longer than {CLONE_TIMEOUT:g} s"
    if done.returncode == 0:
        return ""
    # The first line says why; after it git tells what everybody should look after.
    lines = [line for line in done.stderr.splitlines() if line.strip() and not _WARNING.match(line)]
    return _SPEAKER.sub("", lines[0]).rstrip(". ") if lines else f"git ended with {done.returncode}"
