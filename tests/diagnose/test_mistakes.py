"""Every mistake that beginners were seen to make: is its right cause said first?"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from mistakes import ALL, FURTHER, IN_LESSONS, PACKAGING, RUNNING, SECOND, Mistake
from styles import STYLES
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace
from ros2lab.diagnose.finding import STAGES, UNKNOWN

WANTED_RATE = 0.95
Looked = Callable[[Mistake, int], tuple[Path, list[Finding]]]


def broken(mistake: Mistake, number: int) -> Files:
    """Return the workspace with a mistake, in one of three variations; the last one holds a second fault, too."""
    files = Files.right(NAMES[number])
    if number == 2:
        second = SECOND[mistake.code.startswith("dependency")]
        second[1](files)
    if mistake.makes is not None:
        mistake.makes(files)
    return files


EVERY_NAMING = pytest.mark.parametrize(
    "number", [0, *(pytest.param(n, marks=pytest.mark.thorough) for n in range(1, len(NAMES)))]
)


# What beginners were seen to do in a lesson is asked for its place and its fix, too; here is one of each code and kind of
# file, and so no other test has to ask of these codes.
SHOWN_IN_LESSONS = {
    (mistake.code, Path(mistake.file).suffix): mistake for mistake in reversed(IN_LESSONS)
}.values()
ONE_OF_EACH = {mistake.code: mistake for mistake in reversed(ALL)}
IN_ONE_LESSON = {mistake.code for mistake in SHOWN_IN_LESSONS}
NOT_IN_LESSONS = [mistake for code, mistake in ONE_OF_EACH.items() if code not in IN_ONE_LESSON]
PARTS = 3  # which workers take side by side; of more, `make test` would leave some out


@pytest.fixture(scope="module")
def looked(tmp_path_factory: pytest.TempPathFactory) -> Looked:
    """Return a function that writes a workspace with a mistake and looks at it, once for all tests."""

    @functools.cache
    def look(mistake: Mistake, number: int) -> tuple[Path, list[Finding]]:
        root = broken(mistake, number).write(tmp_path_factory.mktemp("mistake"))
        return root, of_workspace(root) if mistake.makes is not None else []

    return look


def first(findings: list[Finding]) -> str:
    return findings[0].code if findings else "nothing"


@pytest.mark.long
@pytest.mark.parametrize(
    ("asked_of", "number"),
    [
        *(
            pytest.param(NOT_IN_LESSONS[part::PARTS], 0, id=f"one of each code, {part + 1} of {PARTS}")
            for part in range(PARTS)
        ),
        *(pytest.param(ALL, n, id=f"all, {n}", marks=pytest.mark.thorough) for n in range(len(NAMES))),
    ],
)
def test_the_right_cause_comes_first(looked: Looked, asked_of: Sequence[Mistake], number: int) -> None:
    """Of mistakes in a variation, from the files and from the text; at least 95 % are right."""
    wrong: list[str] = []
    asked = 0
    for mistake in asked_of:
        files = broken(mistake, number)
        root, found = looked(mistake, number)
        answers = []
        if mistake.makes is not None:
            is_placed = bool(found) and files.filled(mistake.file) in found[0].place
            answers.append(
                ("files", mistake.code, first(found) if is_placed else f"{first(found)} elsewhere")
            )
        if mistake.text:
            text = files.filled(mistake.text)
            answers.append(("text", mistake.code, first(of_text(text, root))))
            answers.append(("text alone", mistake.bare or mistake.code, first(of_text(text))))
        asked += len(answers)
        wrong += [
            f"{mistake.name} ({files.names.package}, {what}): {given} instead of {right}"
            for what, right, given in answers
            if given != right
        ]
    rate = 1 - len(wrong) / asked
    print(f"\n{asked - len(wrong)} of {asked} answers are right ({rate:.1%})", *wrong, sep="\n")
    assert rate >= WANTED_RATE, wrong


@EVERY_NAMING
@pytest.mark.parametrize(
    "mistake",
    [
        pytest.param(
            mistake, marks=() if mistake in SHOWN_IN_LESSONS else pytest.mark.thorough, id=mistake.name
        )
        for mistake in IN_LESSONS
    ],
)
def test_what_was_found_in_a_lesson_is_fixed(looked: Looked, mistake: Mistake, number: int) -> None:
    """The cause, its place and its fix are told, and nothing is told that follows from it."""
    files = broken(mistake, number)
    root, found = looked(mistake, number)
    place, fix = files.filled(mistake.file), files.filled(mistake.fix)
    if mistake.makes is not None:
        cause, *more = found
        assert cause.code == mistake.code
        assert place in cause.place
        assert fix in cause.fix
        second = SECOND[0][0] if number == 2 else None
        others = [finding.code for finding in more if finding.code != second]
        assert mistake.others is None or others == [*mistake.others]
    if mistake.text:
        cause, bare = (of_text(files.filled(mistake.text), where)[0] for where in (root, None))
        assert (cause.code, bare.code) == (mistake.code, mistake.bare or mistake.code)
        assert fix in cause.fix
        assert fix in bare.fix or mistake.bare


@pytest.mark.thorough
def test_a_second_fault_is_told_as_well(looked: Looked) -> None:
    """A mistake does not hide another one in another file."""
    hidden = []
    for mistake in (m for m in ALL if m.makes is not None and m.code != "manifest-invalid"):
        second = SECOND[mistake.code.startswith("dependency")][0]
        codes = [finding.code for finding in looked(mistake, 2)[1]]
        if not {mistake.code, second} <= set(codes):
            hidden.append((mistake.name, codes))
    assert not hidden


@pytest.mark.parametrize("style", STYLES)
def test_right_packages_raise_no_alarm(tmp_path: Path, style: str) -> None:
    """In each of the styles in which packages are rightly written."""
    assert of_workspace(STYLES[style]().write(tmp_path)) == []


def test_the_corpus_is_large_enough() -> None:
    """Every row is there, and so are fifteen styles."""
    assert len(PACKAGING) + len(RUNNING) >= 50
    assert FURTHER
    assert len(STYLES) >= 15


def test_every_code_has_one_place_in_the_order() -> None:
    """Codes are kebab-case and stand once."""
    codes = [code for stage in STAGES for code in stage]
    assert len(codes) == len(set(codes))
    assert all(code == code.lower() and "_" not in code for code in codes)
    assert {mistake.code for mistake in ALL} <= set(codes)


@pytest.mark.parametrize(
    ("text", "decisive"),
    [
        ("one\nsomething odd: the flux capacitor is not aligned (error 42)\ntwo", "flux capacitor"),
        (
            'Traceback (most recent call last):\n  File "/x/a.py", line 3, in f\n    g()\nOddError: 7 of 9',
            "OddError: 7 of 9",
        ),
        ("OddError: could not convert the flux to float: 'x'", "could not convert"),
        ("nothing at all is wrong here", "nothing at all"),
    ],
)
def test_what_is_not_known_is_quoted(text: str, decisive: str) -> None:
    """An unknown error is called unknown, with the line that decides."""
    (finding,) = of_text(text)
    assert finding.code == UNKNOWN
    assert decisive in finding.cause
    assert finding.fix == ""


@pytest.mark.parametrize(
    "text",
    [
        "",
        "\n\n  \n",
        "\x1b[0m",
        "[INFO] [1763712000.123456789] [driver]: errors: 0",
        "[INFO] [driver-1]: process started with pid [7]\n[driver-1] [INFO] [1763712000.1] [driver]: I drive",
        "Starting >>> my_pkg\nFinished <<< my_pkg [0.62s]\n\nSummary: 1 package finished [0.80s]",
    ],
)
def test_a_text_without_an_error_has_no_findings(text: str) -> None:
    assert of_text(text) == []


def test_nothing_is_run_and_nothing_is_written(tmp_path: Path) -> None:
    """A setup.py or a node that does something when it is imported does not do it."""
    files = Files.right(NAMES[0])
    harm = f"import pathlib\npathlib.Path({str(tmp_path / 'harm')!r}).touch()\n"
    for name in ("setup.py", "node", "launch/robot.launch.py"):
        files.put(name, harm + files.texts[files.path(name)])
    root = files.write(tmp_path / "ws")
    before = set(tmp_path.rglob("*"))
    assert of_workspace(root) == []
    assert set(tmp_path.rglob("*")) == before


# What is strange in any file, and what is strange in one language and in the others no more than another text.
STRANGE = {
    "\0": "any",
    "x = " + "1+" * 2000 + "1\n": "Python",
    "x = [n for a in range(9) for n in glob('/**', recursive=True)]\nsetup(name='%99999999d' % 1)\n": "Python",
    "(" * 5000: "any",
    "x = '\\ud800'\n": "Python",
    "def f(:\n": "Python",
    "class A(A): pass\n": "Python",
    "setup(**{**{}})\n": "Python",
    "é = ñ\n": "any",
    "lambda: (yield)\n": "Python",
    "launch: &again [node: {pkg: 1, exec: [a]}, *again]\n": "YAML",
    "<launch>" + "<group>" * 600 + "</group>" * 600 + "</launch>": "XML",
    "<launch><node/><node pkg='$(var p)' exec=''><param/></node></launch>": "XML",
}
IN = {
    "node": "Python",
    "setup.py": "Python",
    "launch/robot.launch.py": "Python",
    "setup.cfg": "INI",
    "package.xml": "XML",
    "config/robot.yaml": "YAML",
    "launch/x.launch.yaml": "YAML",
    "launch/x.xml": "XML",
}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        pytest.param(name, text, marks=() if of in ("any", language) else pytest.mark.thorough)
        for name, language in IN.items()
        for text, of in STRANGE.items()
    ],
)
def test_strange_files_do_not_stop_it(tmp_path: Path, name: str, text: str) -> None:
    """Whatever a file holds, the others are looked at."""
    files = Files.right(NAMES[0])
    files.put(name, text)
    SECOND[1][1](files)
    assert "topic-near-miss" in [finding.code for finding in of_workspace(files.write(tmp_path))]


def test_a_build_is_explained_below_its_warnings(tmp_path: Path) -> None:
    """The first line is not always the one that counts."""
    text = (
        "Starting >>> pk\n--- stderr: pk\n/x/setuptools/_distutils/cmd.py:90: SetuptoolsDeprecationWarning: old\n!!\n"
        "        ****\n        Please avoid running setup.py directly.\n!!\n  self.initialize_options()\n"
        "error: can't copy 'resource/pk': doesn't exist or not a regular file\n---\nFailed   <<< pk [0.5s]\n"
    )
    (finding,) = of_text(text)
    assert (finding.code, finding.fix) == ("marker-missing", "touch resource/pk in the package's folder")


def test_what_is_printed_beside_an_exception_does_not_hide_it() -> None:
    text = (
        "[INFO] [talker]: package 'x' not found yet\nTraceback (most recent call last):\n"
        '  File "/ws/src/pk/pk/talk.py", line 3, in <module>\n    import rospy\n'
        "ModuleNotFoundError: No module named 'rospy'\n[ros2run]: Process exited with failure 1\n"
    )
    (finding,) = of_text(text)
    assert finding.code == "ros1-import"
    assert finding.place == "/ws/src/pk/pk/talk.py:3"
