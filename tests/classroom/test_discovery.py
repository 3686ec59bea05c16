"""What is found in folders, downloads, trees and tables; nothing of it is opened."""

from __future__ import annotations

import contextlib
import csv
import os
import subprocess
import time
import zipfile
from pathlib import Path

import pytest

from ros2lab.classroom import discovery, names, roster
from ros2lab.classroom.handed_in import ClassError, HandedIn, latest


def made(folder: Path, *files: str) -> Path:
    for name in files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)
    return folder


def found(path: Path, tmp_path: Path, form: str = "") -> dict[str, HandedIn]:
    received = tmp_path / "received"
    received.mkdir(exist_ok=True)
    return {row.key: row for row in discovery.find(path, received, form)}


@pytest.mark.parametrize(
    ("name", "key", "shown", "is_late", "is_unsure"),
    [
        ("maieranna_1042_88123_project.zip", "1042", "maieranna", False, False),
        ("maieranna_LATE_1042_88123_project.zip", "1042", "maieranna", True, False),
        ("maieranna_LATE_1042_88123_my_ws-2.tar.gz", "1042", "maieranna", True, False),
        ("müllerjörg_7_9_a_b_1_2_c.zip", "7", "müllerjörg", False, True),
        ("maieranna_101_102_5003_robot.zip", "101", "maieranna", False, True),
        ("maieranna_LATE_101_102_5003_robot.zip", "101", "maieranna", True, True),
        ("maieranna_101_LATE_102_5003_robot.zip", "102", "maieranna_101", True, False),
        ("o_brien_7_9_ws.zip", "7", "o_brien", False, False),
        ("late_7_9_ws.zip", "7", "late", False, False),
        ("=cmd|' !a'_7_9_ws-1.zip", "7", "=cmd|' !a'", False, False),
        ("x_7_9_week-2_of_2024.zip", "7", "x", False, False),
    ],
)
def test_a_name_of_canvas_says_who_and_when_and_whether_that_is_sure(
    name: str, key: str, shown: str, is_late: bool, is_unsure: bool
) -> None:
    """The number behind a file's name is the student's own to choose, and says nothing of an attempt."""
    row = names.canvas(Path(name))
    assert row is not None
    assert (row.key, row.name, row.is_late, row.is_unsure) == (key, shown, is_late, is_unsure)
    assert (row.attempt, row.reason) == (1, "")
    assert name.startswith(row.label)


def test_a_text_typed_into_a_platform_is_a_row_with_a_reason() -> None:
    for row in (
        names.canvas(Path("maieranna_LATE_1042_text.html")),
        names.canvas(Path("maieranna_1042_link.html")),
        names.moodle(Path("Anna Maier_4711_assignsubmission_onlinetext_")),
    ):
        assert row is not None
        assert row.reason
        assert row.paths == ()


def test_other_names_are_not_taken_for_those_of_a_platform() -> None:
    for name in ("anna", "anna_1.zip", "week_2_final.zip", "maier_1042.zip", "assignsubmission_file_"):
        assert names.canvas(Path(name)) is None
        assert names.moodle(Path(name)) is None


def test_of_a_canvas_download_an_archive_of_each_counts_or_the_loose_files(tmp_path: Path) -> None:
    folder = made(
        tmp_path / "download",
        "a_LATE_1_10_ws-1.zip",
        "a_LATE_1_8_photo.png",
        "b_2_11_status.py",
        "b_2_12_velocity.py",
        "c_3_text.html",
        "stranger.zip",
    )
    rows = found(folder, tmp_path)
    assert [path.name for path in rows["1"].paths] == ["a_LATE_1_10_ws-1.zip"]
    assert rows["1"].is_late
    assert "photo.png" in rows["1"].notes[0]
    assert [path.name for path in rows["2"].paths] == ["b_2_11_status.py", "b_2_12_velocity.py"]
    assert rows["3"].reason
    assert rows["stranger"].paths


@pytest.mark.parametrize(
    "names_",
    [
        ("maieranna_101_5001_robot.zip", "maieranna_101_102_5003_robot-9.zip"),
        ("maieranna_101_5001_robot.zip", "maieranna_101_102_5003_robot.zip"),
        ("maieranna_LATE_101_5001_robot.zip", "maieranna_101_5003_robot.zip"),
        ("dora_107_5008_ws.zip", "dora_107_5009_ws-2147483647.zip"),
        ("maieranna_101_5001_status.py", "maieranna_101_102_5003_status.py"),
    ],
)
def test_two_of_one_student_where_canvas_gives_one_replace_each_other_in_no_way(
    names_: tuple[str, str], tmp_path: Path
) -> None:
    rows = [*found(made(tmp_path / "download", *names_, "zoe_1_2_ws.zip"), tmp_path).values()]
    assert sorted(path.name for row in rows for path in row.paths) == sorted([*names_, "zoe_1_2_ws.zip"])
    assert [bool(row.notes) for row in rows] == [row.name != "zoe" for row in rows]
    assert len(rows) == 3


def test_an_archive_counts_before_the_loose_files_of_the_same_attempt() -> None:
    rows = latest(
        HandedIn("1", "a", paths=(Path(name),), upload=upload)
        for name, upload in (("ws.zip", 1), ("readme.pdf", 2))
    )
    assert [path.name for path in rows[0].paths] == ["ws.zip"]


def test_a_name_that_a_student_has_given_a_file_hands_nothing_in_for_another(tmp_path: Path) -> None:
    """Moodle writes whose it is before the name of the file, and takes each _ out of a person's name."""
    for name in (
        "Anna Maier_4711_assignsubmission_file_a.zip",
        "Ben Berg_4712_assignsubmission_file_Anna Maier_4711_assignsubmission_file_b.zip",
    ):
        (tmp_path / name).touch()
    rows = discovery.find(tmp_path, tmp_path / "received", "moodle")
    assert {row.key: [path.name[-5:] for path in row.paths] for row in rows} == {
        "4711": ["a.zip"],
        "4712": ["b.zip"],
    }


def test_a_link_takes_nothing_of_another_student_unseen(tmp_path: Path) -> None:
    """In a folder in which students put things themselves."""
    made(tmp_path / "submitted", "ben/week2/work/robot_project_ws/src/p/package.xml", "anna/week2/notes.txt")
    (tmp_path / "submitted/anna/week2/work").symlink_to("../../ben/week2/work")
    anna, ben = discovery.find(tmp_path / "submitted", tmp_path / "received", "nbgrader")
    assert anna.paths == (tmp_path / "submitted/anna/week2",)
    assert ben.paths == (tmp_path / "submitted/ben/week2/work/robot_project_ws",)


@pytest.mark.parametrize(
    ("form", "own", "link", "target"),
    [
        ("folder", "ben/a.py", "eve", "ben"),
        ("folder", "ben.zip", "eve.zip", "ben.zip"),
        ("folder", "ben/a.py", "eve", "/etc"),
        ("moodle", "Ben_1_assignsubmission_file_/a.py", "Eve_2_assignsubmission_file_", "Ben_1_assignsubmission_file_"),
        ("canvas", "ben_1_5_ws.zip", "eve_2_6_ws.zip", "ben_1_5_ws.zip"),
        ("nbgrader", "submitted/ben/week2/a.py", "submitted/eve/week2", "../ben/week2"),
        ("nbgrader", "submitted/ben/week2/a.py", "submitted/eve", "ben"),
        ("nbgrader", "submitted/ben/week2/a.py", "submitted/eve", "nowhere"),
    ],
)  # fmt: skip
def test_a_hand_in_that_is_a_link_is_a_row_with_a_reason(
    form: str, own: str, link: str, target: str, tmp_path: Path
) -> None:
    """In a folder in which students put things themselves, it may lead to somebody else's work, or to a secret."""
    folder = made(tmp_path / "class", own)
    (folder / link).parent.mkdir(parents=True, exist_ok=True)
    (folder / link).symlink_to(target)
    ben, eve = discovery.find(folder, tmp_path / "received", form)
    assert ben.paths == (folder / own.removesuffix("/a.py"),)
    assert not ben.reason
    assert eve.paths == ()
    assert eve.reason.endswith(
        f"is a link to {target}, and no link is followed; put the files themselves there."
    )


@pytest.mark.parametrize("where", ["eve", "eve/ws", "./eve/../eve/ws", "file://eve"])
def test_a_csv_does_not_lead_through_links(where: str, tmp_path: Path) -> None:
    made(tmp_path / "class", "ben/ws/a.py")
    (tmp_path / "class/eve").symlink_to("ben")
    (tmp_path / "link").symlink_to("class")  # how the instructor gets there is not the students' doing
    table = tmp_path / "link/class.csv"
    table.write_text(f"id,path\n1,ben\n2,{where}\n")
    rows = found(table, tmp_path)
    assert rows["1"].paths == (tmp_path / "link/ben",)
    assert rows["2"].paths == ()
    assert "is a link to ben; put the files themselves there" in rows["2"].reason


ANNA = "Anna Maier_1001_assignsubmission_file_"


@pytest.mark.parametrize(
    "name",
    [
        f"{ANNA}_1002_assignsubmission_file_",
        "Anna Maier_1001_assignsubmission_onlinetext_1002_assignsubmission_file_",
        "Anna_Maier_1001_assignsubmission_file_1002_assignsubmission_file_",
        "Anna Maier_1001_1002_assignsubmission_file",
        f"{ANNA}{ANNA}1002_assignsubmission_file_",
    ],
)
def test_whose_a_folder_of_moodle_is_stands_at_its_end(name: str, tmp_path: Path) -> None:
    """What comes before that is the student's name, and may hold anything."""
    rows = found(made(tmp_path / "moodle", f"{ANNA}/ws.zip", f"{name}/ws.zip"), tmp_path)
    assert {key: row.paths[0].name for key, row in rows.items()} == {"1001": ANNA, "1002": name}
    assert not any(row.notes or row.reason for row in rows.values())


def test_nobodys_work_is_replaced_by_what_came_with_the_same_id(tmp_path: Path) -> None:
    """Where a name is the student's own to choose, it may hold the number of another."""
    for form, names_ in {
        "canvas": ("maieranna_1042_88_a.zip", "berg_1042_89_1043_90_b.zip"),
        "moodle": (f"{ANNA}ws.zip", f"{ANNA}_1002_assignsubmission_file_ws.zip"),
        "folder": (),
    }.items():
        folder = made(tmp_path / form, *names_)
        if form == "folder":
            folder.mkdir()
            (folder / "class.csv").write_text("name,id,path\nAnna,1,anna\nBen,1,anna\n")
            made(folder, "anna/a.py")
        rows = discovery.find(folder / "class.csv" if form == "folder" else folder, tmp_path, "")
        first, second = rows
        assert first.key != second.key
        assert first.paths
        assert second.paths
        assert all("decide yourself whose each of them is." in " ".join(row.notes) for row in rows)


def test_several_files_of_one_student_are_one_row_still(tmp_path: Path) -> None:
    rows = found(
        made(tmp_path / "moodle", f"{ANNA}a.py", f"{ANNA}b.py", "Ben_2_assignsubmission_file_c.py"), tmp_path
    )
    assert [path.name[-4:] for path in rows["1001"].paths] == ["a.py", "b.py"]
    assert not rows["1001"].notes


def test_a_download_of_moodle_is_understood_as_folders_and_as_files(tmp_path: Path) -> None:
    folder = made(
        tmp_path / "moodle",
        "Anna Maier_11_assignsubmission_file_/ws.zip",
        "Anna Maier_11_assignsubmission_onlinetext_/onlinetext.html",
        "Jörg Müller-Lüdenscheidt, jun._12_assignsubmission_file_ws.zip",
        "Only Words_13_assignsubmission_onlinetext_/onlinetext.html",
    )
    rows = found(folder, tmp_path)
    assert {key: row.name for key, row in rows.items()} == {
        "11": "Anna Maier",
        "12": "Jörg Müller-Lüdenscheidt, jun.",
        "13": "Only Words",
    }
    assert rows["11"].label == "Anna Maier_11_assignsubmission_file_"
    assert rows["13"].reason
    assert not rows["11"].reason


def test_an_export_of_gradescope_gives_a_row_to_each_of_a_group(tmp_path: Path) -> None:
    folder = made(
        tmp_path / "x/assignment_1_export", "submission_5/a.py", "submission_6/a.py", "submission_7/a.py"
    )
    (folder / "submission_metadata.yml").write_text(
        "submission_5:\n  :submitters:\n  - :name: Ann\n    :sid: s1\n    :email: ann@x.org\n"
        "  - :name: Bob\n    :sid: s2\n    :email: bob@x.org\n"
        "submission_6:\n  :submitters:\n  - :name: Cy\n    :sid:\n    :email: cy@x.org\n"
    )
    rows = found(tmp_path / "x", tmp_path)
    assert rows["s1"].paths == rows["s2"].paths
    assert (rows["s1"].name, rows["s1"].email) == ("Ann", "ann@x.org")
    assert rows["cy@x.org"].name == "Cy"
    assert rows["7"].name == "submission_7"


def test_what_a_student_hands_in_does_not_say_whose_the_class_is(tmp_path: Path) -> None:
    folder = made(tmp_path / "all", "ann/submission_1/a.py", "bob/a.py", "cy/a.py")
    (folder / "ann/submission_metadata.yml").write_text(
        "submission_1:\n  :submitters:\n  - :name: Bob\n    :sid: bob\n"
    )
    rows = found(folder, tmp_path)
    assert {key: row.paths for key, row in rows.items()} == {
        name: (folder / name,) for name in ("ann", "bob", "cy")
    }


@pytest.mark.parametrize(
    ("files", "keys"),
    [
        (("ann/a.py", "bob.zip", "submitted/ann/week2/a.py"), ["ann", "bob", "submitted"]),
        (("ann/a.py", "submitted/robot_project_ws/src/a.py"), ["ann", "submitted"]),
        (("ann/a.py", "submitted/.git/HEAD", "submitted/src/a.py", "submitted/docs/a.md"), ["ann", "submitted"]),
        ((f"{ANNA}/ws.zip", "Ben_2_assignsubmission_file_/a.zip", "submitted/ann/week2/a.py"), ["1001", "2", "submitted"]),
        (("a_1_9_ws.zip", "b_2_9_ws.zip", "submitted/ann/week2/a.py"), ["1", "2", "submitted"]),
        (("ann/a.py", "bob/a.py", "submission_metadata.yml"), ["ann", "bob", "submission_metadata.yml"]),
        (("ann/a.py", "bob/a.py", "submitted.zip"), ["ann", "bob", "submitted"]),
        (("submitted/ann/week2/a.py", "source/week2/a.py", "gradebook.db", "notes.md"), ["ann"]),
        (("submitted/ann/week2/a.py", "submitted/bob.zip"), ["ann", "bob"]),
    ],
)  # fmt: skip
def test_no_hand_in_says_how_the_others_are_read(
    files: tuple[str, ...], keys: list[str], tmp_path: Path
) -> None:
    assert sorted(found(made(tmp_path / "class", *files), tmp_path)) == keys


def test_where_two_forms_are_possible_the_instructor_is_asked(tmp_path: Path) -> None:
    folder = made(tmp_path / "class", "ann/a.py", "nbgrader_config.py", "submitted/bob/week2/a.py")
    said = "nbgrader_config.py, as a course of nbgrader does, and also ann; say --from nbgrader if it is one"
    with pytest.raises(ClassError, match=said):
        found(folder, tmp_path)
    assert set(found(folder, tmp_path, "nbgrader")) == {"bob"}
    assert set(found(folder, tmp_path, "folder")) == {"ann", "nbgrader_config.py", "submitted"}


def test_a_folder_called_as_that_of_nbgrader_is_graded_with_a_note(tmp_path: Path) -> None:
    rows = found(made(tmp_path / "class", "ann/a.py", "submitted/bob/week2/a.py"), tmp_path)
    assert ["--from nbgrader" in " ".join(row.notes) for row in rows.values()] == [False, True]
    (tmp_path / "all").mkdir()
    (tmp_path / "all/submitted").symlink_to(tmp_path / "class")
    assert found(tmp_path / "all", tmp_path)["submitted"].reason


def test_what_is_taken_for_no_hand_in_is_named(tmp_path: Path) -> None:
    folder = made(tmp_path / "all", "ann/a.py", ".bob/a.py", "__MACOSX/a", ".DS_Store")
    course = made(
        tmp_path / "course",
        "source/a",
        "gradebook.db",
        "submitted/ann/week2/a.py",
        "submitted/ann/b.txt",
        "submitted/.bob/a",
    )
    for place, names_ in (
        (folder, [".DS_Store", ".bob", "__MACOSX"]),
        (course, [".bob", "gradebook.db", "source"]),
    ):
        told = list[str]()
        (row,) = discovery.find(place, tmp_path, "", told.extend)
        assert (row.key, told) == ("ann", names_)
    assert "b.txt" in row.notes[0]


@pytest.mark.parametrize(
    "said",
    [
        ":created_at: 2026-13-45 10:00:00",
        f":count: {'9' * 5000}",
        ":ratio: !!float x",
        ":at: !ruby/object:Time 1",
        "x: 0x",
    ],
)
def test_an_impossible_value_in_the_metadata_of_gradescope_ends_nothing(said: str, tmp_path: Path) -> None:
    folder = made(tmp_path / "export", "submission_5/a.py")
    (folder / "submission_metadata.yml").write_text(
        f"submission_5:\n  {said}\n  :submitters:\n  - :name: 12:30:45\n    :sid: 0x65\n    :email: null\n"
    )
    (row,) = found(folder, tmp_path).values()
    assert (row.name, row.student_id, row.email) == ("12:30:45", "0x65", "")


@pytest.mark.parametrize("text", ["[" * 20000, "\udcff", "a: [", "\x00"])
def test_metadata_that_are_no_yaml_are_refused_in_a_sentence(text: str, tmp_path: Path) -> None:
    folder = made(tmp_path / "export", "submission_5/a.py")
    (folder / "submission_metadata.yml").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ClassError, match="cannot be read"):
        found(folder, tmp_path)


def test_a_tree_of_nbgrader_is_understood_and_several_assignments_are_refused(tmp_path: Path) -> None:
    course = made(tmp_path / "course", "submitted/ann/week2/a.py", "submitted/bob/week2/a.py")
    (course / "submitted/cy").mkdir()
    rows = found(course, tmp_path)
    assert rows["ann"].paths == (course / "submitted/ann/week2",)
    assert rows["cy"].reason
    made(course, "submitted/bob/week3/a.py")
    with pytest.raises(ClassError, match="week2, week3"):
        found(course, tmp_path)


def test_a_zip_of_all_submissions_is_unpacked_and_they_stay_packed(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "submissions.zip", "w") as archive:
        archive.writestr("a_1_9_ws.zip", b"inner")
        archive.writestr("ü_2_9_ws.zip", b"inner")
        archive.writestr("../../escape_3_9_ws.zip", b"inner")
    rows = found(tmp_path / "submissions.zip", tmp_path)
    assert set(rows) == {"1", "2", "3"}
    assert all(path.is_relative_to(tmp_path / "received") for row in rows.values() for path in row.paths)
    assert not (tmp_path.parent / "escape_3_9_ws.zip").exists()


def test_a_folder_of_anything_has_a_row_for_each_thing_in_it(tmp_path: Path) -> None:
    folder = made(
        tmp_path / "all", "ann/package.xml", "bob.tar.gz", "cy.zip", "d.e/f", ".DS_Store", "__MACOSX/x"
    )
    assert set(found(folder, tmp_path)) == {"ann", "bob", "cy", "d.e"}


def test_a_csv_names_paths_and_git_addresses(tmp_path: Path) -> None:
    repository = made(tmp_path / "repository", "package.xml")
    git = ["git", "-c", "user.name=x", "-c", "user.email=x@x"]
    for words in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "first"]):
        subprocess.run([*git, *words], cwd=repository, check=True)
    made(tmp_path, "ann/package.xml")
    table = tmp_path / "class.csv"
    table.write_text(
        "\ufeffName,ID,Git,Late\n"
        f'"Maier, Ann",1,ann,yes\nBob,2,file://{repository},\n'
        "Cy,3,,\nDi,4,file:///nowhere/at/all,\nEd,5,ext::sh -c whoami,\nFy,6,--upload-pack=x@y:z,\n\n",
        encoding="utf-8",
    )
    rows = found(table, tmp_path)
    assert rows["1"].paths == (tmp_path / "ann",)
    assert rows["1"].name == "Maier, Ann"
    assert rows["1"].is_late
    assert (rows["2"].paths[0] / "package.xml").is_file()
    assert "Line 4" in rows["3"].reason
    assert rows["4"].reason == "Line 5 of class.csv names file:///nowhere/at/all, which is not there."
    assert rows["5"].reason == "Line 6 of class.csv names ext::sh -c whoami, which is not there."
    assert not rows["6"].paths


def test_a_bare_repository_is_no_folder_of_files(tmp_path: Path) -> None:
    subprocess.run(["git", "init", "-q", "--bare", "ann.git"], cwd=tmp_path, check=True)
    made(tmp_path, "bob/HEAD")
    (tmp_path / "class.csv").write_text("name,path\nAnn,ann.git\nBob,bob\n")
    rows = found(tmp_path / "class.csv", tmp_path)
    said = "Line 2 of class.csv names ann.git, which is a bare repository of git; write file://ann.git."
    assert rows["Ann"].reason == said
    assert not rows["Bob"].reason


def test_a_line_without_name_and_id_is_called_by_its_address_or_its_number(tmp_path: Path) -> None:
    made(tmp_path, "ann/x", "bob/x", "cy/x")
    (tmp_path / "class.csv").write_text("name,path,email\n,ann,ann@x.org\n,bob,\nCy,cy,cy@x.org\n")
    rows = found(tmp_path / "class.csv", tmp_path)
    names = {key: (row.name, row.label, row.student_id) for key, row in rows.items()}
    assert names == {
        "ann@x.org": ("ann@x.org", "ann@x.org", ""),
        "line 3": ("line 3", "line 3", ""),
        "Cy": ("Cy", "Cy", ""),
    }


def test_each_line_of_a_csv_says_where_it_is_in_one_of_several_columns(tmp_path: Path) -> None:
    made(tmp_path, "ann/package.xml", "bob/package.xml", "cy/package.xml")
    (tmp_path / "class.csv").write_text("name,path,git\nAnn,ann,\nBob,,bob\nCy,cy,bob\nDi,,\n")
    rows = found(tmp_path / "class.csv", tmp_path)
    assert {key: [path.name for path in row.paths] for key, row in rows.items()} == {
        "Ann": ["ann"],
        "Bob": ["bob"],
        "Cy": ["cy"],
        "Di": [],
    }


def test_a_csv_that_students_fill_in_names_nothing_outside_its_folder(tmp_path: Path) -> None:
    """Nor does a long or strange cell end the class."""
    made(tmp_path, "secret/package.xml", "class/ann/package.xml")
    subprocess.run(["git", "init", "-q", tmp_path / "secret"], check=True)
    folder = tmp_path / "class"
    (folder / "ann" / "link").symlink_to("/etc")
    outside = ["..", ".", "../secret", "ann/../../secret", "ann/link", str(tmp_path / "secret"), "/etc"]
    outside += [f"file://{tmp_path}/secret", f"file://{folder}/%2e%2e/secret", "file://../secret", "file:///"]
    nowhere = ["x" * 300, "file://localhost/etc", "ssh:x", "fd::0", "ext::sh -c whoami"]
    with (folder / "class.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerows([["name", "path", "attempt"], *([where, where, ""] for where in outside + nowhere)])
        table.writerow(["Ann", "ann", "9" * 5000])
    rows = found(folder / "class.csv", tmp_path)
    assert rows.pop("Ann").paths == (folder / "ann",)
    assert len(rows) == len(outside + nowhere)
    assert not any(row.paths for row in rows.values())
    for where in outside:
        assert rows[where].reason.endswith(
            f"{where}, which does not lie in the folder of that CSV; put it there."
        )


def test_of_a_repository_that_keeps_git_waiting_no_process_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(roster, "CLONE_TIMEOUT", 1.0)
    repository = tmp_path / "repository"
    subprocess.run(["git", "init", "--quiet", str(repository)], check=True)
    (repository / ".git" / "HEAD").unlink()
    os.mkfifo(repository / ".git" / "HEAD")
    _, reason = roster.checked_out(repository.as_uri(), tmp_path / "received")
    assert reason.endswith("cannot be cloned: it took longer than 1 s.")
    deadline = time.monotonic() + 30
    while f"upload-pack\0{repository}\0" in _running():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def _running() -> str:
    """Return the command lines of all processes."""
    found = ""
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            found += path.read_text(errors="replace")
    return found


def test_a_repository_that_unfolds_without_end_is_not_checked_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each folder of it holds the next one ten times; or it is one file of zeros, larger than a submission may be."""

    def git(*words: str, given: str = "") -> str:
        done = subprocess.run(
            ["git", *words], cwd=repository, input=given, text=True, stdout=subprocess.PIPE, check=True
        )
        return done.stdout.strip()

    monkeypatch.setattr(roster, "MOST_BYTES", 1_000_000)
    repository = made(tmp_path / "repository", "zeros")
    git("init", "-q")
    many = git("mktree", given=f"100644 blob {git('hash-object', '-w', '--stdin')}\tx\n")
    for _ in range(7):
        many = git("mktree", given="".join(f"040000 tree {many}\t{n}\n" for n in range(10)))
    (repository / "zeros").write_bytes(bytes(1_000_001))
    large = git("mktree", given=f"100644 blob {git('hash-object', '-w', 'zeros')}\tzeros\n")
    (tmp_path / "class.csv").write_text(f"name,git\nBob,file://{repository}\n")
    for tree in (many, large):
        commit = git("-c", "user.name=x", "-c", "user.email=x@x", "commit-tree", "-m", "x", tree)
        git("update-ref", "HEAD", commit)
        row = found(tmp_path / "class.csv", tmp_path)["Bob"]
        assert "it holds more than 1 MB, or 30000 files and folders" in row.reason
        assert not row.paths
        assert [path.name for path in (tmp_path / "received").glob("git-*/*")] == [".git"]


@pytest.mark.parametrize("text", ["", "a,b\n1,2\n", "name\nAnn\n"])
def test_a_csv_without_the_columns_is_refused_in_a_sentence(text: str, tmp_path: Path) -> None:
    (tmp_path / "class.csv").write_text(text)
    with pytest.raises(ClassError, match="column"):
        found(tmp_path / "class.csv", tmp_path)


def test_a_student_is_chosen_by_name_id_or_email_address() -> None:
    rows = [HandedIn("1", "Anna Maier", "1", "a@x.org"), HandedIn("2", "Bob", "2", "b@x.org")]
    for words in (["1"], ["a@x.org"], ["anna"], ["Anna Maier"]):
        assert [row.key for row in discovery.chosen(rows, words)] == ["1"]
    with pytest.raises(ClassError, match="Zoe"):
        discovery.chosen(rows, ["Zoe"])


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "none").mkdir()
    with pytest.raises(ClassError, match="no submissions"):
        found(tmp_path / "none", tmp_path)


@pytest.mark.parametrize(
    ("table", "keys"),
    [
        ("name,path\nAda,a\nAda,b\n", {"Ada (a)", "Ada (b)"}),
        ("name,path,email\nAda,a,a@x\nAda,b,b@x\n", {"Ada (a@x)", "Ada (b@x)"}),
        ("name,path,email\nAda,a,a@x\nAda,b,\n", {"Ada (a@x)", "Ada (b)"}),
        ("name,path,email\nAda,a,a@x\nAda,b,a@x\n", {"Ada"}),  # handed in twice
        ("name,path,attempt\nAda,a,1\nAda,b,2\n", {"Ada"}),
        ("name,path,attempt\nAda,a,1\nAda,b,1\n", {"Ada (a)", "Ada (b)"}),
        ("name,path,id\nAda,a,1\nAda,b,2\n", {"1", "2"}),
        ("name,path,id\nAda,a,1\nAda,b,1\n", {"1"}),
        ("name,path,id\nAda,a,1\nAda,b,\n", {"1", "Ada"}),
        ("name,path\nAda,a\nada,b\n", {"Ada", "ada"}),
    ],
)
def test_people_of_one_name_stay_apart_in_a_csv(tmp_path: Path, table: str, keys: set[str]) -> None:
    """Where neither an id nor an email address nor an attempt says that it is one, each is somebody, and is told so."""
    made(tmp_path, "a/package.xml", "b/package.xml")
    (tmp_path / "class.csv").write_text(table)
    rows = found(tmp_path / "class.csv", tmp_path)
    assert {*rows} == keys
    for key, row in rows.items():
        assert row.name.casefold() == "ada"
        assert any("no id tells whose it is" in note for note in row.notes) == ("(" in key)
