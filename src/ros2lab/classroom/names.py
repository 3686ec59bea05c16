"""What learning platforms write into names: pure functions from a name to the row that it stands for.

Canvas:  `maieranna_LATE_1042_88123_project.zip`: name, whether late, user, upload, and the file as its student has called it.
Moodle:  `Anna Maier_4711_assignsubmission_file_` as a folder, or with the file's name behind it.
Gradescope: `submission_88123`, with the students in submission_metadata.yml beside it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ros2lab.classroom.handed_in import HandedIn

_OF_CANVAS = r"_(?P<late>LATE_)?(?P<user>\d+)_(?P<upload>\d+|text|link))(?:_(?P<file>.+)|\.html?)"
_CANVAS = re.compile(rf"(?P<label>(?P<name>.*?){_OF_CANVAS}", re.DOTALL | re.IGNORECASE)
# A name and a file may hold numbers, too: whose it is stands behind a name, and before a file.
_CANVAS_OTHERWISE = re.compile(rf"(?P<label>(?P<name>.*){_OF_CANVAS}", re.DOTALL | re.IGNORECASE)
_OF_MOODLE = r"_(?P<user>\d+)_assignsubmission_(?P<kind>[a-z]+)_?)"
# A folder's name ends with what Moodle says of it, and whatever a person is called comes before that.
_MOODLE_FOLDER = re.compile(rf"(?P<label>(?P<name>.+){_OF_MOODLE}", re.DOTALL)
# A file's name ends as its student has called it.
_MOODLE_FILE = re.compile(rf"(?P<label>(?P<name>.+?){_OF_MOODLE}(?P<file>.*)", re.DOTALL)
_GRADESCOPE = re.compile(r"submission_(\d+)")


def canvas(path: Path) -> HandedIn | None:
    """Return what Canvas has called so in a download of all submissions; None if it has not."""
    match = _CANVAS.fullmatch(path.name)
    if match is None or (match["file"] is None and match["upload"].isdecimal()):
        return None
    other = _CANVAS_OTHERWISE.fullmatch(path.name)
    row = HandedIn(
        match["user"],
        match["name"],
        match["user"],
        paths=(path,),
        is_late=bool(match["late"]),
        label=match["label"],
        is_unsure=other is not None and other["user"] != match["user"],
    )
    if not match["upload"].isdecimal():
        return replace(row, reason="A text or an address was handed in to Canvas, and no file.", paths=())
    return replace(row, upload=int(match["upload"]))


def moodle(path: Path) -> HandedIn | None:
    """Return what Moodle has called so in a download of all submissions; None if it has not."""
    of_folder = _MOODLE_FOLDER.fullmatch(path.name)
    of_file = _MOODLE_FILE.fullmatch(path.name)
    match = of_folder if of_folder and not path.is_file() else of_file
    if match is None:
        return None
    other = _MOODLE_FOLDER.match(path.name)
    is_unsure = match is of_file and other is not None and other["user"] != match["user"]
    row = HandedIn(
        match["user"],
        match["name"].replace("_", " ").strip(),
        match["user"],
        paths=(path,),
        label=match["label"],
        is_unsure=is_unsure,
    )
    if match["kind"] != "file":
        return replace(row, reason="A text was typed into Moodle, and no file was handed in.", paths=())
    return row


def gradescope(path: Path, described: Mapping[str, Any]) -> list[HandedIn] | None:
    """Return a row for each student of a submission that Gradescope has exported; None if it is none.

    Args:
        path: of the submission.
        described: what submission_metadata.yml says of it.
    """
    match = _GRADESCOPE.fullmatch(path.stem)
    if match is None:
        return None
    return [*_submitters(path, match[1], described)]


def _submitters(path: Path, number: str, described: Mapping[str, Any]) -> Iterator[HandedIn]:
    given = _field(described, "submitters")
    people = [person for person in given if isinstance(person, Mapping)] if isinstance(given, list) else []
    for person in people or [{}]:
        given = [_field(person, key) for key in ("name", "sid", "email")]
        name, student_id, email = (
            text if isinstance(text, str) and text not in ("~", "null") else "" for text in given
        )
        key = student_id or email or (f"{number} {name}" if name else number)
        yield HandedIn(
            key, name or path.name, student_id, email, (path,), upload=int(number), label=path.name
        )


def _field(data: Mapping[str, Any], name: str) -> Any:
    """Return a value of Gradescope's YAML, whose names are symbols of Ruby."""
    return data.get(f":{name}", data.get(name))
