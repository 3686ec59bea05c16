"""A CSV of names with paths or git addresses, and the checkouts of these."""

from __future__ import annotations

import csv
import hashlib
import os
import re
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path

from ros2lab.classroom.handed_in import ClassError, HandedIn

# What a column may be called.
COLUMNS: Mapping[str, tuple[str, ...]] = {
    "name": ("name", "full name", "student"),
    "id": ("id", "student id", "sid", "login"),
    "email": ("email", "email address", "mail"),
    "where": ("path", "submission", "git", "repository", "url", "address"),
    "late": ("late",),
    "attempt": ("attempt",),
}
CLONE_TIMEOUT = 120.0  # s
_ADDRESS = re.compile(r"(https?|ssh|git|file)://|[\w.-]+@[\w.-]+:")
_WARNING = re.compile("warning:", re.IGNORECASE)
_SPEAKER = re.compile(r"(fatal|error|remote): ")
_YES = ("1", "y", "yes", "true", "late", "x")


def read(path: Path, received: Path) -> list[HandedIn]:
    """Return a row for each line of a CSV; paths in it are relative to it.

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
        what: next((name for name in header if name.strip().lower() in known), "")
        for what, known in COLUMNS.items()
    }
    if not columns["where"] or not (columns["name"] or columns["id"]):
        raise ClassError(
            f"{path} needs a column `name` or `id`, and a column `path` or `git`; it has {', '.join(header) or 'none'}."
        )
    return [*_rows(path, lines, columns, received)]


def _rows(
    path: Path, lines: list[dict[str, str]], columns: Mapping[str, str], received: Path
) -> Iterator[HandedIn]:
    for number, line in enumerate(lines, start=2):
        cells = {what: (line.get(name) or "").strip() if name else "" for what, name in columns.items()}
        if not any(cells.values()):
            continue
        key = cells["id"] or cells["name"]
        place, reason = Path(), ""
        if not cells["where"]:
            reason = f"Line {number} of {path.name} names nothing that was handed in."
        elif _ADDRESS.match(cells["where"]):
            place, reason = checked_out(cells["where"], received)
        else:
            place = path.parent / cells["where"]
        yield HandedIn(
            key or f"line {number}",
            cells["name"] or key,
            cells["id"],
            cells["email"],
            () if reason else (place,),
            attempt=int(cells["attempt"]) if cells["attempt"].isdecimal() else 1,
            is_late=cells["late"].lower() in _YES,
            upload=number,
            label=key,
            reason=reason,
        )


def checked_out(address: str, received: Path) -> tuple[Path, str]:
    """Return the newest state of a repository, and a sentence if it cannot be had; nothing of it is run."""
    folder = received / f"git-{hashlib.sha256(address.encode()).hexdigest()[:16]}"
    if not (folder / ".git").is_dir():
        folder.mkdir(parents=True, exist_ok=True)
        _git(folder, "init", "--quiet")
    for words in (
        ("fetch", "--quiet", "--depth=1", "--no-tags", "--end-of-options", address, "HEAD"),
        ("checkout", "--quiet", "--force", "--detach", "FETCH_HEAD"),
    ):
        problem = _git(folder, *words)
        if problem:
            return folder, f"{address} cannot be cloned: {problem}."
    return folder, ""


def _git(folder: Path, *words: str) -> str:
    """Run git without questions, hooks and programs of the repository; return what it says if it fails."""
    calm = ("-c", "core.hooksPath=/dev/null", "-c", "core.fsmonitor=false", "-c", "core.symlinks=true")
    environ = {
        **os.environ,
        "LC_ALL": "C.UTF-8",  # what it says is told on
        "GIT_TERMINAL_PROMPT": "0",
        "GIT_ALLOW_PROTOCOL": "https:http:ssh:git:file",
        "GIT_SSH_COMMAND": "ssh -oBatchMode=yes",
        "GIT_LFS_SKIP_SMUDGE": "1",
    }
    try:
        done = subprocess.run(
            ["git", *calm, *words],
            cwd=folder,
            env=environ,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=CLONE_TIMEOUT,
            check=False,
        )
    except FileNotFoundError:
        return "git is not installed"
    except subprocess.TimeoutExpired:
        return f"it took longer than {CLONE_TIMEOUT:g} s"
    if done.returncode == 0:
        return ""
    # The first line says why; after it git tells what everybody should look after.
    lines = [line for line in done.stderr.splitlines() if line.strip() and not _WARNING.match(line)]
    return _SPEAKER.sub("", lines[0]).rstrip(". ") if lines else f"git ended with {done.returncode}"
