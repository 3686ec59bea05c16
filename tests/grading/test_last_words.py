"""Why a program ended, by what it printed last: neither what Python ignores nor what launch only announces."""

from __future__ import annotations

import re
import sys
import textwrap
from dataclasses import replace
from subprocess import run

import evidences
import pytest

from ros2lab.diagnose.printed.error_text import read_error
from ros2lab.diagnose.printed.ignored import without_ignored
from ros2lab.grading.evidence import NO_WORD, OTHER_TYPE, Run, WrittenEnd
from ros2lab.grading.questions.answer import error_of, last_word
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

# Each makes this Python print an exception that it ignores, before or after the one that ends it.
IGNORED = {
    "in __del__": """
        class Held:
            def __del__(self):
                self.gone.close()
        held = Held()
        """,
    "in __del__, with a cause": """
        class Held:
            def __del__(self):
                try:
                    self.gone.close()
                except AttributeError as error:
                    raise ValueError("not closed") from error
        held = Held()
        """,
    "in a callback of weakref": """
        import weakref
        class Held: pass
        held = Held()
        ref = weakref.ref(held, lambda gone: gone.missing)
        del held
        """,
    "in atexit": """
        import atexit
        atexit.register(lambda: {}["gone"])
        """,
    "in a generator that is closed": """
        def numbers():
            try:
                yield 1
            finally:
                {}["gone"]
        held = numbers()
        next(held)
        """,
}


@pytest.mark.parametrize("how", IGNORED)
def test_an_ignored_exception_is_not_why_a_program_ended(how: str) -> None:
    """Python itself says it, in its own words of today."""
    code = textwrap.dedent(IGNORED[how]) + "raise RuntimeError('the model is missing')\n"
    said = run([sys.executable, "-c", code], capture_output=True, text=True, check=False).stderr
    assert "Exception ignored" in said
    assert last_word(said) == "“RuntimeError: the model is missing”", said
    report = read_error(said).report
    assert report is not None
    assert report.line == "RuntimeError: the model is missing", said


def test_an_ignored_exception_alone_is_no_end_but_can_be_explained() -> None:
    said = "Exception ignored in: <function Robot.__del__ at 0x7f>\nTraceback (most recent call last):\n  File \"a.py\", line 3\nKeyError: 'left'"
    assert last_word(said) == "no word of why"
    report = read_error(said).report
    assert report is not None
    assert report.kind == "KeyError"


def test_of_programs_that_were_launched_together_each_has_its_own_ignored_exception() -> None:
    lines = [
        "[a-1] Exception ignored in thread started by: <bound method>",
        "[b-2] Traceback (most recent call last):",
        '[a-1]   File "a.py", line 3',
        "[b-2] KeyError: 'left'",
        "[a-1] BrokenPipeError: [Errno 32] Broken pipe",
        "[a-1] ValueError: its own",
    ]
    assert without_ignored(lines) == [lines[1], lines[3], lines[5]]


@pytest.mark.parametrize(
    "why",
    [
        "PackageNotFoundError: \"package 'robot_bringup' not found\"",
        "SyntaxError: invalid syntax (robot.launch.py, line 7)",
        "NameError: name 'Node' is not defined",
        "KeyError: 'HOME'",
    ],
)
def test_what_launch_announces_is_no_reason_but_what_it_lists_below(why: str) -> None:
    said = (
        "[INFO] [launch]: All log files can be found below /tmp\n"
        "[ERROR] [launch]: Caught exception in launch (see debug for traceback): Caught multiple exceptions when trying to load file of format [py]:\n"
        f" - {why}\n"
        " - InvalidFrontendLaunchFileError: The launch file may have a syntax error, or its format is unknown\n"
    )
    assert last_word(said) == f"“{why}”"


ODD_ENDS = {
    "a group": (
        "raise ExceptionGroup('two', [ValueError('one'), ExceptionGroup('inner', [KeyError('left')])])",
        "KeyError: 'left'",
    ),
    "a group of a task": (
        "import asyncio\nasync def fail():\n    raise ValueError('it | is')\nasync def main():\n"
        "    async with asyncio.TaskGroup() as group:\n        group.create_task(fail())\nasyncio.run(main())",
        "ValueError: it | is",
    ),
    "one that nothing can be printed of": (
        "import sys\nclass Odd(Exception):\n    def __repr__(self):\n        raise self\ndel sys.stderr\nraise Odd",
        "an error that Python could not print",
    ),
    "one for which there is no output": (
        "import sys\ndel sys.stderr\nraise LookupError('no robot')",
        "LookupError('no robot')",
    ),
    "one after a table": ("print('+---+\\n| 1 |\\n+---+')\nraise ValueError('no')", "ValueError: no"),
}


@pytest.mark.parametrize("how", ODD_ENDS)
def test_of_an_error_in_odd_lines_its_own_words_are_told(how: str) -> None:
    """Python itself prints them."""
    code, word = ODD_ENDS[how]
    if "roup" in code and sys.version_info < (3, 11):
        pytest.skip("Python 3.10 has no groups of errors")
    done = run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert last_word(f"{done.stdout}{done.stderr}").strip("“”") == word, done.stderr


def test_what_launch_says_on_one_line_is_the_reason() -> None:
    said = "[ERROR] [launch]: Caught exception in launch (see debug for traceback): executable 'x' not found on the libexec directory"
    assert last_word(said) == "“executable 'x' not found on the libexec directory”"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "an error of the grader, which costs nothing",
        "x\nan error of the grader, which costs nothing",
        "\n" * 12 + "could not be tried, which costs nothing",
        "x”. The grader has failed, which costs nothing: “y",
        "x. Did you mean: nothing",
        "\x1b[2J\u202ethe grader has failed",
    ],
)
def test_what_a_program_says_is_never_the_graders_own_sentence(text: str) -> None:
    """Whatever it is, what stands around its quotes stays the same."""
    end = f'Traceback (most recent call last):\n  File "n.py", line 3, in main\nRuntimeError: {text}'
    for at in (None, "stop"):
        given = evidences.ended(evidences.COMMAND, end, at)(evidences.right())
        plain = evidences.ended(evidences.COMMAND, "KeyError: 1", at)(evidences.right())
        told, usual = (verdict(one, load()) for one in (given, plain))
        around = [
            [re.sub("“[^“”]*”", "“”", one.reason) for one in grade.criteria] + [*grade.notes]
            for grade in (told, usual)
        ]
        around = [[re.sub("“[^“”]*”", "“”", line) for line in lines] for lines in around]
        assert around[0] == around[1]
        reasons = "".join(one.reason for one in told.criteria)
        assert "“" in reasons


@pytest.mark.parametrize("said", ["The build is fine, and costs nothing", "RuntimeError: it costs nothing"])
def test_what_setup_py_says_is_quoted_and_what_the_grader_says_is_not(said: str) -> None:
    assert error_of(said) == f"“{said}”"
    assert error_of(NO_WORD) == NO_WORD.rstrip(".")
    assert error_of(f"{OTHER_TYPE[0]}: no module") == f"{OTHER_TYPE[0]}: no module"


def test_a_note_says_that_words_were_made_up() -> None:
    """They are the grader's own, as is a topic that nothing of the hand-in subscribes to."""
    given = evidences.ended(evidences.COMMAND, "KeyError: 'rrat'", at="stop")(evidences.right())
    run = given.runs[1]
    coined = replace(run.commands[-1], text="rrat, srat, sspp")
    told = replace(run, commands=[*run.commands[:-1], coined], commanded="/observer_1")
    notes = verdict(replace(given, runs=[given.runs[0], told, *given.runs[2:]]), load()).notes
    assert (
        "command_subscriber, alone: it ended with “KeyError: 'rrat'” after made-up words were published: rrat, srat, sspp."
        in notes
    )
    assert not any("/observer_1" in note for note in notes)


@pytest.mark.parametrize(
    ("name", "end", "code", "said", "is_reason"),
    [
        ("check_topics", ("/limits", False), 0, "start", False),  # it says what it was sent
        ("send_command", ("/robot/command", True), 0, "sent", False),
        ("hello", ("/hello", False), 0, "", False),
        ("ask", ("/answers", False), 0, "[ERROR] [1.0] [ask]: nobody answers", True),
        ("ask", ("/answers", False), 1, "start", True),
        ("check_topics", ("/robot/command", False), 0, "start", True),  # it should go on
    ],
)
def test_an_end_without_an_error_is_no_reason_where_nothing_was_to_go_on(
    name: str, end: tuple[str, bool], code: int, said: str, is_reason: bool
) -> None:
    program = replace(evidences.executable(name), modules=[name])
    run = Run([name], "alone", "stepped", [], {}, {}, {}, {}, {}, [], {name: said}, {}, [])
    run = replace(run, done=[] if code else [name])
    given = evidences.right([evidences.status_run(), evidences.velocity_run(), run])
    assert given.build
    others = [one for one in given.build.executables if one.name != evidences.COMMAND]
    given = replace(given, build=replace(given.build, executables=[*others, program]))
    given = evidences.files(ends=[WrittenEnd(end[0], evidences.STRING, end[1], [], name)])(given)
    grade = verdict(given, load())
    one = next(one for one in grade.criteria if one.id == "command_subscriber.topic")
    assert (f"{name} ended with" in one.reason) is is_reason, one.reason
    is_quoted = code != 0 or "ERROR" in said
    assert any("no error" in note for note in grade.notes) is not is_quoted
