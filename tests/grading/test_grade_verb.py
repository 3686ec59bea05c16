"""`ros2lab grade` and `ros2lab regrade`: what they write, what they refuse, and their exit codes."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest
from click.testing import Result
from typer.testing import CliRunner

from deadlines import DEADLINE
from ros2lab import course
from ros2lab.cli import app

COMMAND = [sys.executable, "-c", "from ros2lab.cli import main; main()"]
TIMEOUT = 240  # s


def run(*words: str | Path, **environ: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *map(str, words)],
        env={**os.environ, **environ},
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )


def called(*words: str | Path, cwd: Path, **environ: str) -> Result:
    """Do what the command does in this process, which has imported what that needs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(cwd)
        return CliRunner().invoke(app, [*map(str, words)], env=environ, catch_exceptions=False)


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """The reference, with only its quick tests."""
    copy = course.copy_reference(tmp_path / "handed in")
    for path in (copy / "src/robot_controller/test").glob("test_*.py"):
        if path.name not in ("test_velocity.py", "test_status_line.py"):
            path.unlink()
    return copy


def test_the_reference_gets_everything_in_every_form(workspace: Path, tmp_path: Path) -> None:
    before = {path: path.read_bytes() for path in workspace.rglob("*") if path.is_file()}
    forms = ("json", "html", "md", "gradescope", "junit", "evidence")
    files = {form: tmp_path / f"grade.{form}" for form in forms}
    done = run("grade", workspace, *(word for form in forms for word in (f"--{form}", files[form])))
    assert done.returncode == 0, done.stderr
    grade = json.loads(files["json"].read_text())
    lost = [(one["id"], one["reason"]) for one in grade["criteria"] if one["points"] < one["max"]]
    assert lost == []
    assert grade["total"] == 110
    assert grade["max"] == 100
    assert grade["clock"] == "stepped"
    assert set(grade["seconds"]) == {"unpack", "build", "observe", "total"}
    assert "110" in done.stdout
    assert "<h1" in files["html"].read_text()
    assert files["md"].read_text().startswith("# ")
    assert json.loads(files["gradescope"].read_text())["score"] == 110
    assert ET.parse(files["junit"]).getroot().tag == "testsuites"
    assert {path: path.read_bytes() for path in workspace.rglob("*") if path.is_file()} == before

    again = run("regrade", files["evidence"], "--json", "-")
    assert again.returncode == 0, again.stderr
    assert json.loads(again.stdout) == grade

    overrides = tmp_path / "overrides.yaml"
    first = grade["criteria"][0]
    overrides.write_text(f"{first['id']}: {{points: 0, comment: late by a week, by: I. Structor}}\n")
    lowered = json.loads(run("regrade", files["evidence"], "--json", "-", "--overrides", overrides).stdout)
    assert lowered["total"] == 110 - first["max"]
    assert lowered["criteria"][0]["override"] == {
        "points": 0,
        "comment": "late by a week",
        "by": "I. Structor",
        "machine": first["max"],
    }


@pytest.mark.parametrize("kind", ["empty folder", "text", "broken zip", "encrypted", "only a README"])
def test_nothing_to_grade(tmp_path: Path, kind: str) -> None:
    """It says what was found, and the reports give 0."""
    path = tmp_path / "handed\nin\x1b[1m"
    if kind == "empty folder":
        path.mkdir()
    elif kind == "only a README":
        path.mkdir()
        (path / "README.md").write_text("# My robot\nIt is very good.\n")
    elif kind == "text":
        path.write_text("hello")
    elif kind == "broken zip":
        path.write_bytes(b"PK\x03\x04" + bytes(100))
    else:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("x/package.xml", "<package/>")
        content = bytearray(path.read_bytes())
        content[6] |= 1
        content[content.index(b"PK\x01\x02") + 8] |= 1
        path.write_bytes(content)
    done = called("grade", path, "--json", "-", cwd=tmp_path)
    assert done.exit_code == 3, done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert "\x1b[1m" not in done.stderr
    grade = json.loads(done.stdout)
    assert grade["total"] == 0
    assert all(one["reason"] for one in grade["criteria"])


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ([], "Give either what to grade, or --self"),
        (["{path}", "--self"], "Give either what to grade, or --self"),
        (["{path}/not/there"], "There is no"),
        ([""], "This is empty"),
        (["{path}", "--json", "{path}/grade.json"], "lies in what is graded"),
        (["{path}", "--json", "/nowhere/grade.json"], "cannot be written"),
        (["{path}", "--json", "{path}"], "cannot be written"),
        (["{path}", "--json", "{path}/../x", "--html", "{path}/../x"], "have the same file"),
        (["{path}", "--rubric", "{path}/none.yaml"], "cannot be read"),
        (["{path}", "--overrides", "{path}/none.yaml"], "cannot be read"),
        (["{path}", "--speed", "9"], "No such option"),
    ],
)
def test_wrong_usage(tmp_path: Path, words: list[str], problem: str) -> None:
    path = tmp_path / "handed in"
    path.mkdir()
    done = CliRunner().invoke(app, ["grade", *(word.format(path=path) for word in words)])
    assert done.exit_code == 2, done.exception
    assert problem in done.stderr
    assert list(path.iterdir()) == []


@pytest.mark.parametrize("text", [None, "", "{", "[]", '{"schema": 99}'])
def test_what_is_no_evidence_cannot_be_graded_again(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / "evidence.json"
    if text is not None:
        path.write_text(text)
    done = CliRunner().invoke(app, ["regrade", str(path)])
    assert done.exit_code == 2, done.exception
    assert str(path) in done.stderr


def test_a_machine_without_bubblewrap_says_what_to_install(workspace: Path, tmp_path: Path) -> None:
    programs = tmp_path / "bin"
    programs.mkdir()
    for found in (shutil.which("bash"), Path(sys.executable).with_name("colcon")):
        assert found
        (programs / Path(found).name).symlink_to(found)
    done = run("grade", workspace, PATH=str(programs))
    assert done.returncode == 4
    assert "bubblewrap is not installed: run `sudo apt install bubblewrap`." in done.stderr


def test_closed_streams_are_nobodys_fault(tmp_path: Path) -> None:
    """Nor is a file that was opened in their place taken for one of them."""
    (tmp_path / "README.md").write_text("# My robot\n")
    report = tmp_path.parent / "closed.md"
    done = subprocess.run(
        ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *COMMAND, "grade", tmp_path, "--md", report],
        timeout=DEADLINE,
        check=False,
    )
    assert done.returncode == 3
    assert report.read_text().startswith("# Grade of ")


def test_self_grades_the_workspace_one_is_in(tmp_path: Path) -> None:
    """Also from below it; here it is one with nothing in it."""
    inside = tmp_path / "robot_project_ws" / "src"
    inside.mkdir(parents=True)
    done = called("grade", "--self", "--json", "-", cwd=inside)
    assert done.exit_code == 3, done.stderr
    assert json.loads(done.stdout)["submission"] == "robot_project_ws"


def test_self_without_a_workspace_says_where_it_looked(tmp_path: Path) -> None:
    done = called("grade", "--self", cwd=tmp_path, ROS2LAB_WORK=str(tmp_path / "work"))
    assert done.exit_code == 2
    assert f"There is no robot_project_ws here or in {tmp_path / 'work'}" in done.stderr


@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.thorough), signal.SIGHUP]
)
def test_a_signal_ends_everything(workspace: Path, tmp_path: Path, number: signal.Signals) -> None:
    """While it runs and before it has written anything; the fixture of all tests sees whether a process is left."""
    report = tmp_path / "grade.json"
    process = subprocess.Popen(
        [*COMMAND, "grade", str(workspace), "--json", str(report)],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    while not [*tmp_path.glob("ros2lab-scratch-*/src")]:
        assert process.poll() is None
    process.send_signal(number)
    said = process.communicate(timeout=DEADLINE)[1]
    assert process.returncode == 128 + number, said
    assert said.strip().splitlines()[-1] == "Interrupted: everything was ended, and nothing was written."
    assert "Traceback" not in said
    assert not report.exists()
    assert [*tmp_path.glob("ros2lab-scratch-*")] == []


def test_what_a_killed_grader_has_left_goes_with_the_next_start(tmp_path: Path) -> None:
    """And what belongs to one that runs stays."""
    (tmp_path / "tmp").mkdir()
    hold = "from ros2lab.scratch import scratch_folder\nwith scratch_folder() as f: print(f, flush=True); input()"
    environ = {**os.environ, "TMPDIR": str(tmp_path / "tmp")}
    folders = []
    graders = []
    for _ in range(2):
        grader = subprocess.Popen(
            [sys.executable, "-c", hold],
            env=environ,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert grader.stdout is not None
        folders.append(Path(grader.stdout.readline().strip()))
        graders.append(grader)
    killed, alive = graders
    with killed:
        killed.kill()
    for folder in folders:
        (folder / "file").touch()
    run("grade", tmp_path, TMPDIR=str(tmp_path / "tmp"))
    assert [folder.exists() for folder in folders] == [False, True]
    alive.communicate("")
    assert not folders[1].exists()


FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, ({most}, {most}))
from ros2lab.cli import main
main()
"""


@pytest.mark.parametrize(
    ("most", "said"),
    [(100, "File too large"), pytest.param(20_000, "`ulimit -Hf` is unlimited", marks=pytest.mark.thorough)],
)
def test_a_full_disk_is_told_in_a_sentence(workspace: Path, tmp_path: Path, most: int, said: str) -> None:
    """A limit on the size of files stands for it: the first one meets the copy, the second one a box."""
    report = tmp_path / "out" / "grade.html"
    report.parent.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", FULL.format(most=most), "grade", str(workspace), "--html", str(report)],
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert done.returncode == 4, done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert [*report.parent.iterdir()] == []


def test_a_fault_of_the_grader_is_told_in_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise KeyError("x")

    monkeypatch.setattr("ros2lab.grading.reading.boxed.read", fail)
    (tmp_path / "handed in").mkdir()
    (tmp_path / "handed in" / "x.py").touch()
    done = CliRunner().invoke(app, ["grade", str(tmp_path / "handed in")])
    assert done.exit_code == 4, done.exception
    assert "no fault of the submission: KeyError: 'x'" in done.stderr


def test_ctrl_c_while_it_is_imported_shows_no_traceback() -> None:
    # Pressed when the first of what takes long is looked for.
    press = (
        "import os, signal, sys\nclass Press:\n    @classmethod\n    def find_spec(cls, name, *_):\n"
        "        if name == 'typer': os.kill(os.getpid(), signal.SIGINT)\nsys.meta_path.insert(0, Press)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"{press}from ros2lab.cli import main"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == -signal.SIGINT
    assert done.stderr == ""
