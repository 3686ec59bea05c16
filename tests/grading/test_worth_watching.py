"""Which programs are watched where there are more than there is time for."""

from __future__ import annotations

from dataclasses import replace

import evidences
import pytest

from ros2lab import assignments
from ros2lab.grading.evidence import Executable, Files, WrittenEnd
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict
from ros2lab.grading.watching.rounds import MOST_PROGRAMS, worth_watching

STRING = "std_msgs/msg/String"
MANY = [Executable(f"aa{number:02}", f"p.aa{number:02}:main", "installed", ["aa"]) for number in range(30)]
LAST = Executable("zz", "p.zz:main", "installed", ["zz"])


def end(module: str, topic: str, type_name: str = STRING) -> WrittenEnd:
    return WrittenEnd(topic, type_name, is_publisher=True, periods=[], module=module)


@pytest.mark.parametrize(
    ("ends", "is_watched"),
    [
        ([], False),
        ([end("zz", "/robot/status")], True),
        ([end("zz", "/robot/staus")], True),
        ([end("zz", "/chatter", "std_msgs/msg/Int32")], False),
        ([end("zz", "/robot/status"), *(end(one.stem, "/chatter") for one in MANY)], True),
        ([end("zz", "/robot/status"), *(end(one.stem, "/robot/status") for one in MANY)], False),
    ],
)
def test_of_too_many_those_are_watched_that_have_a_part_by_their_code(
    ends: list[WrittenEnd], is_watched: bool
) -> None:
    chosen = worth_watching([*MANY, LAST], Files(ends=ends), assignments.load())
    assert len(chosen) == MOST_PROGRAMS
    assert (LAST in chosen) is is_watched
    assert not is_watched or chosen[0] is LAST
    assert worth_watching([LAST, *MANY[:3]], Files(ends=ends), assignments.load()) == [LAST, *MANY[:3]]


def test_what_was_not_watched_is_named() -> None:
    right = evidences.right()
    assert right.build is not None
    assert right.unwatched == []
    more = replace(right, build=replace(right.build, executables=[*right.build.executables, *MANY]))
    (note,) = [note for note in verdict(more, load()).notes if "not watched" in note]
    assert note.endswith("not watched: aa00, aa01, aa02, aa03, aa04 and 25 more.")
