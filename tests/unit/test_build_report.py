"""A run of colcon is judged right: the real error, the warnings, and successes that mislead."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from ros2lab.build_report import (
    BuildResult,
    Package,
    judge_build,
    judge_package_tests,
    judge_tests,
    read_tests,
    read_unittest,
)
from ros2lab.build_text import condensed, find_warnings, first_error
from ros2lab.colcon_record import STOPPED, FoundPackage, Job, Message, Record

# What Python writes for a setup.py that setuptools cannot read, and colcon's own traceback above it.
COLCON_TRACEBACK = """\
Traceback (most recent call last):
  File "/v/lib/python3.11/site-packages/colcon_core/executor/__init__.py", line 91, in __call__
    rc = await self.task(*args, **kwargs)
         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  File "/usr/lib/python3.11/subprocess.py", line 571, in run
    raise CalledProcessError(retcode, process.args,
subprocess.CalledProcessError: Command '['python', '-c', '...']' returned non-zero exit status 1.
"""

DASHES = """\
/v/lib/python3.11/site-packages/setuptools/dist.py:599: SetuptoolsDeprecationWarning: Invalid dash-separated \
key 'script-dir' in 'develop' (setup.cfg), please use the underscore name 'script_dir' instead.
!!

        ********************************************************************************
        Usage of dash-separated 'script-dir' will not be supported in future
        ********************************************************************************

!!
  opt = self._enforce_underscore(opt, section)
"""
DASHES_TOLD = (
    "Invalid dash-separated key 'script-dir' in 'develop' (setup.cfg), "
    "please use the underscore name 'script_dir' instead."
)

DASHES_OF_71 = """\
/v/lib/python3.11/site-packages/setuptools/dist.py:452: SetuptoolsDeprecationWarning: Invalid dash-separated options
!!

        ********************************************************************************
        Usage of dash-separated 'script-dir' will not be supported in future
        versions. Please use the underscore name 'script_dir' instead.

        By 2024-Sep-26, you need to update your project and remove deprecated calls
        ********************************************************************************

!!
  opt = self.warn_dash_deprecation(opt, section)
"""
DASHES_OF_71_TOLD = (
    "Invalid dash-separated options: Usage of dash-separated 'script-dir' will not be supported in future versions. "
    "Please use the underscore name 'script_dir' instead."
)

TEMPLATE_WARNING = """\
/v/lib/python3.11/site-packages/setuptools/_distutils/dist.py:289: UserWarning: Unknown distribution option: \
'tests_require'
  warnings.warn(msg)
"""


def package(name: str, build_type: str = "ament_python", problem: str | None = None) -> Package:
    return Package(name, Path("src") / name, build_type, problem)


def built(name: str, *errors: str, ended: float = 1.5) -> Job:
    return Job(name, returncode=0, started=0.5, ended=ended, errors=list(errors))


def failed(name: str, *errors: str, ended: float = 1.5) -> Job:
    return Job(name, returncode=1, started=0.5, ended=ended, errors=list(errors))


def recorded(*jobs: Job, packages: list[Package] | None = None, messages: Sequence[Message] = ()) -> Record:
    """Return the record of a run that came as far as working on packages."""
    listed = packages if packages is not None else [package(job.name) for job in jobs]
    found = [FoundPackage(one.name, str(one.path), one.build_type) for one in listed]
    return Record(True, True, found, {job.name: job for job in jobs}, [*messages])


def judged(
    jobs: list[Job],
    *,
    returncode: int = 0,
    packages: list[Package] | None = None,
    messages: Sequence[Message] = (),
) -> BuildResult:
    """Judge a build of which it is given what colcon did."""
    listed = packages if packages is not None else [package(job.name) for job in jobs]
    record = recorded(*jobs, packages=listed, messages=messages)
    return judge_build(returncode, 2.0, listed, record)


class TestFirstError:
    """The line that says what went wrong is found, and not one that only repeats it."""

    @pytest.mark.parametrize(
        ("written", "error"),
        [
            (
                "warning: no files found\nerror: can't copy 'resource/pk': doesn't exist\n",
                "error: can't copy 'resource/pk': doesn't exist",
            ),
            (
                "error in pk setup command: Problems to parse EntryPoint(name='a').\nPlease ensure ...\n",
                "error in pk setup command: Problems to parse EntryPoint(name='a').",
            ),
            (
                '  File "/w/src/pk/setup.py", line 12\n    version=1\n            ^\nSyntaxError: invalid syntax\n',
                "SyntaxError: invalid syntax (setup.py, line 12)",
            ),
            (
                'Traceback (most recent call last):\n  File "/w/src/pk/setup.py", line 4, in <module>\n'
                '    setup()\n  File "/v/site-packages/setuptools/dist.py", line 370, in f\n    raise X\n'
                "packaging.version.InvalidVersion: Invalid version: 'one'\n",
                "packaging.version.InvalidVersion: Invalid version: 'one' (setup.py, line 4)",
            ),
            (
                "CMake Warning:\n  Ignoring\n\nCMake Error at CMakeLists.txt:3 (find_package):\n"
                '  By not providing "Findx.cmake"\n',
                'CMake Error at CMakeLists.txt:3 (find_package): By not providing "Findx.cmake"',
            ),
            (
                "a.cpp:1:1: warning: unused\na.cpp:3:5: error: expected ';'\nmake: *** [all] Error 2\n",
                "a.cpp:3:5: error: expected ';'",
            ),
            ("first\nI refuse\n\n", "I refuse"),
            (
                "Traceback (most recent call last):\n"
                '  File "/w/ast.py", line 50, in parse\n    return compile(source, filename, mode, flags)\n'
                '  File "<unknown>", line 1\n    copied\n    ^^^\nSyntaxError: invalid syntax\n',
                "colcon cannot read what setup.py tells it: leave print() out there, and give setup() plain values",
            ),
        ],
    )
    def test_found(self, written: str, error: str) -> None:
        assert first_error(written.splitlines()) == error

    def test_a_syntax_error_in_a_node_does_not_hide_the_failure(self) -> None:
        """Byte-compiling complains first and stops nothing; setuptools' own verdict is the error."""
        written = (
            '  File "/w/pk/hello.py", line 1\n    def main(:\n\nSyntaxError: bad\n\nerror: no resource\n'
        )
        assert first_error(written.splitlines()) == "error: no resource"

    def test_silence(self) -> None:
        """Where nothing was written there is nothing to find."""
        assert first_error([]) is None
        assert first_error(["", "  "]) is None


class TestWarnings:
    """What deserves attention is one line each; what the student cannot help is left out."""

    @pytest.mark.parametrize(("written", "told"), [(DASHES, DASHES_TOLD), (DASHES_OF_71, DASHES_OF_71_TOLD)])
    def test_dashes_in_setup_cfg(self, written: str, told: str) -> None:
        """Fifteen lines, twice, become one, which names the key, wherever that stands."""
        assert find_warnings((written + written).splitlines()) == [told]

    def test_the_template_is_not_blamed(self) -> None:
        """`ros2 pkg create` writes tests_require; setuptools' complaint is not the student's."""
        assert find_warnings(TEMPLATE_WARNING.splitlines()) == []

    def test_a_node_that_is_no_python(self) -> None:
        """Colcon goes on when byte-compiling fails; the student must hear of it."""
        written = (
            '  File "/w/install/pk/hello.py", line 3\n    def main(:\n             ^\nSyntaxError: bad\n\n'
        )
        assert find_warnings(written.splitlines()) == ["SyntaxError: bad (hello.py, line 3)"]
        sorry = "Sorry: TabError: inconsistent use of tabs and spaces in indentation (hello.py, line 3)"
        assert find_warnings([sorry]) == [sorry.removeprefix("Sorry: ")]

    def test_prints_of_a_setup_py_are_no_warning(self) -> None:
        assert find_warnings(["loud", "deep breath"]) == []

    def test_compilers(self) -> None:
        """The warnings of distutils, CMake and gcc are kept."""
        written = (
            "warning: no files found matching 'a'\nCMake Warning:\n  Ignoring path\na.c:1:2: warning: x\n"
        )
        assert find_warnings(written.splitlines()) == [
            "no files found matching 'a'",
            "CMake Warning: Ignoring path",
            "a.c:1:2: warning: x",
        ]


class TestCondensed:
    """Live output keeps every line but the padding of Python's warnings."""

    @pytest.mark.parametrize(("written", "told"), [(DASHES, DASHES_TOLD), (DASHES_OF_71, DASHES_OF_71_TOLD)])
    def test_each_warning_is_told_once(self, written: str, told: str) -> None:
        lines = ["Starting >>> pk\n", *(written + written).splitlines(True), "Finished <<< pk\n"]
        assert list(condensed(lines)) == [
            "Starting >>> pk\n",
            f"warning: {told}\n",
            "Finished <<< pk\n",
        ]

    def test_the_template_is_not_blamed(self) -> None:
        assert list(condensed([*TEMPLATE_WARNING.splitlines(True), "---\n"])) == ["---\n"]

    def test_everything_else_passes(self) -> None:
        """Indented lines, exclamation marks and tracebacks that follow no warning stay."""
        lines = ["!!\n", "  indented\n", "\n", *COLCON_TRACEBACK.splitlines(True), "no newline"]
        assert list(condensed(lines)) == lines

    def test_a_box_that_does_not_end(self) -> None:
        """An error after an unfinished warning is not swallowed beyond the next warning or the end."""
        lines = [*DASHES.splitlines(True)[:2], *TEMPLATE_WARNING.splitlines(True), "error: real\n"]
        assert "error: real\n" in list(condensed(lines))

    def test_lines_come_at_once(self) -> None:
        """A line is handed on before the next one is there."""
        source = iter(["one\n", "two\n"])
        lines = condensed(source)
        assert next(lines) == "one\n"
        assert next(source) == "two\n"


class TestBuildResult:
    """A return code of 0 is not taken for success."""

    def test_success(self) -> None:
        result = judged([built("talk"), built("listen", ended=4.0)])
        assert result.is_ok
        assert result.first_error is None
        assert [(one.name, one.is_ok, one.seconds) for one in result.packages] == [
            ("talk", True, 1.0),
            ("listen", True, 3.5),
        ]
        assert repr(result) == ("colcon build: 2 of 2 packages built\n  talk    built\n  listen  built")

    def test_failure(self) -> None:
        """The error is that of the package that failed first, not of those that colcon stopped."""
        jobs = [
            Job("early", returncode=STOPPED, started=0.1, ended=1.0),
            failed("listen", "error: later", ended=3.0),
            failed("talk", "error: sooner", ended=2.0),
            Job("never"),
        ]
        result = judged(jobs, returncode=1)
        assert not result.is_ok
        assert result.first_error == "error: sooner"
        errors = {one.name: one.error for one in result.packages}
        assert errors["early"] == "colcon stopped it because another package failed"
        assert errors["never"] == "colcon did not begin it because another package failed"
        assert "  talk    FAILED\n          error: sooner" in repr(result)

    def test_the_reason_behind_colcons_traceback(self) -> None:
        """What setup.py itself says is told instead of colcon's traceback."""
        job = failed("talk", *COLCON_TRACEBACK.splitlines())
        assert job.is_colcon_traceback
        reasons = {"talk": "NameError: name 'os' (setup.py)"}
        result = judge_build(1, 1.0, [package("talk")], recorded(job), reasons=reasons)
        assert result.first_error == "NameError: name 'os' (setup.py)"

    def test_nothing_to_build(self) -> None:
        """Colcon ends with 0 where it finds no package."""
        result = judged([])
        assert not result.is_ok
        assert repr(result) == "colcon build: nothing was built: colcon finds no package"

    def test_unknown_build_type(self) -> None:
        """Colcon leaves out what it cannot build, and ends with 0."""
        messages = [Message(False, "No task extension to 'build' a 'ros.ament_pyton' package")]
        packages = [package("talk"), package("listen", "ament_pyton")]
        result = judged([built("talk")], packages=packages, messages=messages)
        assert not result.is_ok
        assert result.warnings == ()
        assert result.first_error is not None
        assert "'ament_pyton'" in result.first_error
        assert [one.is_ok for one in result.packages] == [True, False]
        # The same if it is the only one: then there is no job at all.
        assert not judged([], packages=[package("listen", "ament_pyton")], messages=messages).is_ok

    def test_unselected_packages_are_not_missed(self) -> None:
        """What was not to be built is neither a failure nor a success."""
        result = judged([built("talk"), Job("other", is_selected=False)])
        assert result.is_ok
        assert [one.name for one in result.packages] == ["talk"]

    def test_invalid_manifest(self) -> None:
        """A package that colcon takes for plain Python because of its package.xml is built, with a warning."""
        result = judged([built("talk")], packages=[package("talk", "python", "no maintainer")])
        assert result.is_ok
        assert "package.xml is not valid" in result.packages[0].warnings[0]
        assert "no maintainer" in repr(result)

    def test_colcons_own_warnings(self) -> None:
        """Those that name a package are its own; the others are the build's."""
        messages = [
            Message(False, "Package 'talker' doesn't explicitly install a marker"),
            Message(False, "The path '/gone' in the environment variable X doesn't exist"),
        ]
        result = judged([built("talk"), built("talker")], messages=messages)
        assert result.packages[0].warnings == ()
        assert result.packages[1].warnings == ("Package 'talker' doesn't explicitly install a marker",)
        assert result.warnings == ("The path '/gone' in the environment variable X doesn't exist",)

    def test_an_error_before_any_package(self) -> None:
        """Colcon's own error is told when it never began, or else the last thing it printed."""
        text = "colcon build: Duplicate package names not supported:\n- pk:\n  - src/a\n"
        result = judged([], returncode=1, messages=[Message(True, text)])
        assert result.first_error == "Duplicate package names not supported: pk: src/a"
        words = ["usage: colcon", "colcon: error: no\n", "\n"]
        assert judge_build(2, 0.1, [], Record(), last_words=words).first_error == "colcon: error: no"
        assert judge_build(2, 0.1, [], Record()).first_error == "colcon ended with code 2 and said nothing"
        words = [*COLCON_TRACEBACK.splitlines(), ""]
        assert str(judge_build(1, 0.1, [], Record(), last_words=words).first_error).startswith(
            "subprocess.CalledProcessError: "
        )

    @pytest.mark.parametrize(
        ("returncode", "error"),
        [
            (0, "it is unknown what was built: colcon left no record of it"),
            (-9, "colcon was ended by SIGKILL"),
        ],
    )
    def test_a_run_without_a_record(self, returncode: int, error: str) -> None:
        """Where nothing is known of a run, nobody claims that it was a success, or found no package."""
        result = judge_build(returncode, 0.1, [], Record(), last_words=["Summary: 1 package finished"])
        assert not result.is_ok
        assert result.first_error == error

    def test_a_run_that_was_stopped(self) -> None:
        """No package is blamed on another one where none has failed."""
        jobs = [
            built("base"),
            Job("arm", started=0.5),
            Job("hand", returncode=STOPPED, started=0.5, ended=1),
            Job("leg"),
        ]
        result = judged(jobs, returncode=-15)
        assert result.first_error == "colcon was ended by SIGTERM"
        stopped = "colcon was stopped while it built it"
        assert [one.error for one in result.packages] == [
            None,
            stopped,
            stopped,
            "colcon did not begin it because it was stopped",
        ]

    def test_html_shows_no_markup_of_a_package(self) -> None:
        """What a build printed is text in the notebook, whatever it looks like."""
        result = judged([failed("talk", "error: <script>alert(1)</script>")], returncode=1)
        page = result._repr_html_()
        assert "&lt;script&gt;" in page
        assert "<script>" not in page


class TestTests:
    """Test reports become counts and one line for each failure."""

    REPORT = """<?xml version="1.0"?><testsuites><testsuite name="pk" tests="4" failures="1" errors="1">
    <testcase name="test_good"/><testcase name="test_bad"><failure message="assert 1 == 2&#10;more"/></testcase>
    <testcase name="test_broken"><error message="failed on setup"/></testcase>
    <testcase name="test_later"><skipped message="no robot"/></testcase></testsuite></testsuites>"""

    def test_xunit(self) -> None:
        failures = ["test_bad: assert 1 == 2", "test_broken: failed on setup"]
        assert read_tests(self.REPORT) == (4, 1, failures)

    @pytest.mark.parametrize("report", ["<package/>", "no xml", ""])
    def test_other_files(self, report: str) -> None:
        with pytest.raises(ValueError, match=r"tag|XML"):
            read_tests(report)

    def test_unittest(self) -> None:
        """Unittest writes no report; what it prints is read."""
        printed = (
            "test_add (test.T) ... FAIL\n\n======\nFAIL: test_add (test.T)\n------\n"
            'Traceback (most recent call last):\n  File "/w/test.py", line 5, in test_add\n    self.fail()\n'
            "AssertionError: 1 != 2\n\n------\nRan 3 tests in 0.001s\n\nFAILED (failures=1)\n"
        )
        assert read_unittest(printed.splitlines()) == (3, ["test_add (test.T): AssertionError: 1 != 2"])

    def test_no_test_is_no_success(self) -> None:
        """Colcon test ends with 0 where no test exists."""
        job = built("pk", "", "Ran 0 tests in 0.000s", "", "OK")
        result = judge_tests(0, 1.0, [judge_package_tests(job, [])], recorded(job))
        assert not result.is_ok
        assert result.first_error is not None
        assert "no test ran" in result.first_error

    def test_verdicts(self) -> None:
        """Colcon test ends with 0 also where tests failed; the reports decide."""
        job = built("pk")
        result = judge_tests(0, 1.0, [judge_package_tests(job, [self.REPORT, "<other/>"])], recorded(job))
        assert not result.is_ok
        assert result.first_error == "test_bad: assert 1 == 2"
        assert repr(result).startswith("colcon test: 4 tests run, 2 failed\n  pk  FAILED")
        good = '<testsuite tests="1"><testcase name="a"/></testsuite>'
        result = judge_tests(0, 1.0, [judge_package_tests(job, [good])], recorded(job))
        assert result.is_ok
        assert repr(result) == "colcon test: 1 test run, 0 failed\n  pk  passed"

    def test_a_run_that_died(self) -> None:
        """A package whose test command failed without a test names the reason."""
        job = failed("pk", "ModuleNotFoundError: No module named 'pytest'")
        result = judge_tests(1, 1.0, [judge_package_tests(job, [])], recorded(job))
        assert result.first_error == "pk: ModuleNotFoundError: No module named 'pytest'"

    def test_a_run_that_was_killed(self) -> None:
        """Neither the package nor its tests are blamed."""
        job = Job("pk", started=0.5)
        result = judge_tests(-9, 1.0, [judge_package_tests(job, [])], recorded(job))
        assert result.first_error == "colcon was ended by SIGKILL"
        assert judge_tests(-9, 1.0, [], Record()).first_error == "colcon was ended by SIGKILL"
