"""A check accepts right answers in many styles, and rejects wrong ones of many kinds with a hint."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ros2lab.checks import CheckError, drive_the_robot, welcome
from ros2lab.topics import Sample


def log_of(*words: str) -> Any:
    """Stand in for a log that heard these words; only its samples are looked at."""
    samples = [Sample(float(n), SimpleNamespace(data=word)) for n, word in enumerate(words)]
    return SimpleNamespace(topic="/hello", count=len(words), samples=lambda: samples)


def with_division(twist: Any) -> float:
    return math.inf if twist.angular.z == 0 else abs(twist.linear.x / twist.angular.z)


def with_exception(twist: Any) -> float:
    try:
        return math.fabs(twist.linear.x) / math.fabs(twist.angular.z)
    except ZeroDivisionError:
        return float("inf")


def with_numpy(twist: Any) -> Any:
    with np.errstate(divide="ignore"):
        return np.abs(np.float64(twist.linear.x) / np.float64(twist.angular.z))


class Radius:
    """An object that can be called is a function too."""

    def __call__(self, twist: Any) -> float:
        return with_division(twist)


@pytest.mark.parametrize(
    "right",
    [
        with_division,
        with_exception,
        with_numpy,
        Radius(),
        lambda t: abs(t.linear.x) / abs(t.angular.z) if t.angular.z else math.inf,
    ],
)
def test_a_right_radius(right: Any) -> None:
    """Any way of computing it counts."""
    assert drive_the_robot.turn_radius(right).startswith("Right")


@pytest.mark.parametrize(
    ("wrong", "hint"),
    [
        (lambda _: None, "needs a return"),
        (lambda t: t.linear.x / t.angular.z if t.angular.z else math.inf, "never negative"),
        (lambda t: abs(t.linear.x / t.angular.z), "it raised ZeroDivisionError"),
        (lambda t: abs(t.linear.x / t.angular.z) if t.angular.z else 0.0, r"math\.inf"),
        (lambda t: abs(t.angular.z / t.linear.x), "which two fields"),
        (lambda t: t.linear.z, "which two fields"),
        (lambda _: 2.5, "which two fields"),
        (lambda _: "2.5", "which two fields"),
        (lambda _: True, "which two fields"),
        (lambda: 2.5, "it raised TypeError"),
        (2.5, "without its parentheses"),
        (None, "without its parentheses"),
    ],
)
def test_a_wrong_radius(wrong: Any, hint: str) -> None:
    """What is wrong is said, with a hint that fits."""
    with pytest.raises(CheckError, match=rf"Expected: .* Found: .*{hint}|{hint}"):
        drive_the_robot.turn_radius(wrong)


@pytest.mark.parametrize(
    "words", ["My robot is called Pico.", "a b c", "¡Hola, soy un robot!", "three\nlines\nhere"]
)
def test_right_words(words: str) -> None:
    """Any sentence that was published counts."""
    assert welcome.my_words(lambda: words, log_of("Hello", words)).startswith("Right")


@pytest.mark.parametrize(
    ("function", "heard", "hint"),
    [
        (lambda: None, [], "in quotes"),
        (lambda: 3, [], "in quotes"),
        (lambda: "two words", ["two words"], "what would a robot say"),
        (lambda: "", [""], "what would a robot say"),
        (lambda: "never published at all", ["Hello"], "publish it first"),
        (lambda: 1 / 0, [], "ZeroDivisionError"),
        ("my words", ["my words"], "without its parentheses"),
    ],
)
def test_wrong_words(function: Any, heard: list[str], hint: str) -> None:
    """Silence, too few words, and no function are told apart."""
    with pytest.raises(CheckError, match=hint):
        welcome.my_words(function, log_of(*heard))


def test_a_failed_check_shows_no_traceback() -> None:
    """In a notebook only the sentence is shown."""
    error = CheckError("a", "b", "c")
    assert error._render_traceback_() == [str(error)] == ["Not yet. Expected: a. Found: b. Hint: c"]
