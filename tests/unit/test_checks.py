"""What all checks have in common: the card, and what stands beside it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output

from ros2lab import checks, edition, progress
from ros2lab.checks import CheckError, exercise


@pytest.fixture(autouse=True)
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Give the test a student's folder, and no failures before its own."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    monkeypatch.setattr(checks, "_failures", {})


@pytest.fixture
def shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[InteractiveShell]:
    """Return a shell that passes for a notebook's."""
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    shell = InteractiveShell.instance(colors="nocolor")
    shell.history_manager.enabled = False
    shell.kernel = None  # type: ignore[attr-defined]
    yield shell
    shell.history_manager.end_session()
    shell.history_manager.save_thread and shell.history_manager.save_thread.stop()
    InteractiveShell.clear_instance()


def refused(*hints: str, times: int, key: str = "test.one") -> CheckError:
    """Return the error of a check that has failed so many times."""

    def check() -> str:
        raise CheckError("1 < 2", "$base `x`", *hints)

    check.__module__, _, check.__name__ = key.partition(".")
    checked = exercise(check)
    for _ in range(times - 1):
        with pytest.raises(CheckError):
            checked()
    with pytest.raises(CheckError) as caught:
        checked()
    return caught.value


def test_a_failed_check_shows_no_traceback() -> None:
    """Where no card can be shown, only the sentence is."""
    error = CheckError("a", "b", "c")
    assert error._render_traceback_() == [str(error)] == ["Not yet. Expected: a. Found: b. Hint: c"]


def test_a_sentence_has_one_full_stop() -> None:
    assert "Expected: 1, 2, ... Found: it is so. Hint" in str(CheckError("1, 2, ...", "it is so.", "c"))


def test_a_notebook_shows_the_card_once(shell: InteractiveShell) -> None:
    """The error stays, so that nothing after it runs, and programs see it; its text is all that it says."""
    shell.user_ns["error"] = CheckError("a", "b", "c")
    with capture_output() as captured:
        result = shell.run_cell("raise error")
    assert isinstance(result.error_in_exec, CheckError)
    (card,) = captured.outputs
    assert card.data["text/plain"] == "Not yet. Expected: a. Found: b. Hint: c"
    assert "<b>Not yet</b>" in card.data["text/html"]
    assert captured.stdout.strip() == card.data["text/plain"]


def test_a_card_tells_what_is_expected_and_found_and_is_no_formula() -> None:
    html = refused("think", times=1)._repr_html_()
    assert "1 &lt; 2<" in html
    assert ">x</code>" in html
    assert "$base" in html
    assert "mathjax_ignore tex2jax_ignore" in html
    assert "<b>Hint</b>" in html


def test_what_a_program_says_is_shown_as_it_is() -> None:
    html = CheckError("a", "it said:\nTypeError: `x` <y>", "c")._repr_html_()
    assert "it said:\nTypeError: `x` &lt;y&gt;" in html


def test_hints_are_told_one_after_the_other_and_the_others_are_a_click_away() -> None:
    first, second = (refused("think", "look", "type", times=times)._repr_html_() for times in (1, 2))
    told, _, folded = first.partition("<details")
    assert "think" in told
    assert "look" not in told
    assert "type" not in folded.partition("<details")[0], "a click shows one more, and not both"
    assert "look" in second.partition("<details")[0]
    assert "Hint 2 of 3" in second


@pytest.mark.parametrize(
    ("hints", "times", "is_offered"), [(1, 2, False), (1, 3, True), (3, 3, False), (3, 4, True)]
)
def test_the_worked_solution_is_offered_after_honest_tries(hints: int, times: int, is_offered: bool) -> None:
    """When all hints were told and the same fault is still there, and never before the third try."""
    error = refused(*"abc"[:hints], times=times, key="welcome.my_words")
    assert ("Show a worked solution" in error._repr_html_()) == is_offered
    assert ("return &quot;My robot is called Pico.&quot;" in error._repr_html_()) == is_offered
    assert "BEGIN SOLUTION" not in error._repr_html_()
    assert "Pico" not in str(error)


@pytest.mark.parametrize("lesson", progress.lessons())
def test_every_exercise_has_a_worked_solution(lesson: str) -> None:
    """But for the quiz, in which every answer has its nudge."""
    for name in progress.exercises(lesson):
        cells = edition.solution(lesson, name)
        assert bool(cells) == (name != "quiz"), name
        assert all("SOLUTION" not in cell for cell in cells)


def test_what_has_no_worked_solution_has_none() -> None:
    assert edition.solution("no_lesson", "x") == edition.solution("welcome", "no_exercise") == []


def test_a_broken_card_does_not_hide_the_sentence(
    shell: InteractiveShell, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any) -> list[str]:
        raise OSError("no notebook")

    monkeypatch.setattr(edition, "solution", fail)
    error = refused("a", times=5)
    with capture_output() as captured:
        assert error._render_traceback_() == [str(error)]
    assert "Not yet" in captured.outputs[0].data["text/html"]
