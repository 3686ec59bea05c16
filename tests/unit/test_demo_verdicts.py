"""The demonstration's verdicts follow from times and velocities alone."""

from __future__ import annotations

import itertools
import random

import pytest

from ros2lab.verbs.demo import (
    FEWEST_GAPS,
    MOST_GAPS,
    Step,
    Twist,
    is_unclear,
    judge_moving,
    judge_nonsense,
    judge_period,
    judge_standing,
)


def step(*linear: float, deaths: tuple[str, ...] = (), began: float = 10.0) -> Step:
    """A step after which these velocities came, 0.1 s apart."""
    twists = (Twist(began + 0.1 * number, value, 0.0) for number, value in enumerate(linear))
    return Step(began, tuple(twists), deaths)


def gaps_of(period: float, jitter: float, seed: int) -> list[float]:
    """Gaps (s) of a timer whose messages are late by up to `jitter` s, observed as the demonstration does."""
    late = random.Random(seed)
    times = [number * period + late.uniform(0, jitter) for number in range(MOST_GAPS + 1)]
    gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
    enough = next((n for n in range(FEWEST_GAPS, MOST_GAPS) if not is_unclear(gaps[:n])), MOST_GAPS)
    return gaps[:enough]


class TestPeriod:
    """2.0 s is right and 2.4 s is not, on a busy machine too."""

    @pytest.mark.parametrize("period", [1.9, 1.95, 2.0, 2.05, 2.1])
    def test_right(self, period: float) -> None:
        assert judge_period([period] * FEWEST_GAPS).is_met

    @pytest.mark.parametrize("period", [0.5, 1.0, 1.6, 1.75, 2.25, 2.4, 4.0])
    def test_wrong(self, period: float) -> None:
        """A wrong period is told without waiting longer."""
        assert not judge_period([period] * FEWEST_GAPS).is_met
        assert not is_unclear([period] * FEWEST_GAPS)

    @pytest.mark.parametrize("seed", range(200))
    def test_busy(self, seed: int) -> None:
        """Messages late by up to 0.3 s neither make 2.0 s wrong nor 2.4 s right."""
        assert judge_period(gaps_of(2.0, 0.3, seed)).is_met
        assert not judge_period(gaps_of(2.4, 0.3, seed)).is_met

    def test_one_late_message(self) -> None:
        """A pause of a second, as of a machine that swaps, changes nothing."""
        assert judge_period([2.0, 3.0, 1.0, 2.0]).is_met

    def test_a_status_at_each_change_too(self) -> None:
        """The first gap may begin at an extra status."""
        assert judge_period([0.7, 2.0, 2.0, 2.0]).is_met

    @pytest.mark.parametrize("gaps", [[], [2.0], [2.0, 2.0, 2.0]])
    def test_too_few(self, gaps: list[float]) -> None:
        assert not judge_period(gaps).is_met

    def test_what_was_seen(self) -> None:
        assert judge_period([2.0, 2.004, 1.996, 2.0]).seen == "periods 2.00, 2.00, 2.00, 2.00 s"


class TestMoving:
    """A command that starts the robot."""

    @pytest.mark.parametrize("came", [(0.5,), (0.0, 0.0, 0.5), (-0.5,)])
    def test_right(self, came: tuple[float, ...]) -> None:
        """It may take a moment, and go backwards."""
        assert judge_moving("start", step(*came)).is_met

    def test_latency_is_told(self) -> None:
        seen = judge_moving("start", step(0.0, 0.0, 0.5))
        assert seen.is_met
        assert seen.seen == "0.50 m/s, 0.00 rad/s after 0.20 s"

    def test_turning_is_moving(self) -> None:
        assert judge_moving("start", Step(0.0, (Twist(1.0, 0.0, 0.2),))).is_met

    def test_wrong(self) -> None:
        """Zeros and silence are no motion, and say which it was; a node that ended is named."""
        assert judge_moving("start", step(0.0, 0.0)).seen == "2 came, none but zero"
        silent = judge_moving("start", step(deaths=("node ended by itself with code 1",)))
        assert not silent.is_met
        assert silent.seen == "nothing came on /cmd_vel; node ended by itself with code 1"


class TestStanding:
    """A command that stops the robot."""

    @pytest.mark.parametrize("came", [(0.0,), (0.5, 0.5, 0.0, 0.0), (0.5, 0.0)])
    def test_right(self, came: tuple[float, ...]) -> None:
        """What was under way may still come; one zero is enough of those who publish only changes."""
        assert judge_standing("stop", step(*came)).is_met

    @pytest.mark.parametrize("came", [(), (0.5, 0.5), (0.5, 0.0, 0.5), (0.0, 0.0, 0.1)])
    def test_wrong(self, came: tuple[float, ...]) -> None:
        """Silence leaves the robot moving, and a zero among others does not stop it."""
        assert not judge_standing("stop", step(*came)).is_met

    def test_before_the_first_command(self) -> None:
        """Then silence is right, and any motion is wrong."""
        assert judge_standing("before", step(), must_publish=False).is_met
        assert judge_standing("before", step(0.0, 0.0), must_publish=False).is_met
        assert not judge_standing("before", step(0.5, 0.0), must_publish=False).is_met


class TestNonsense:
    """Words that are no command."""

    def test_right(self) -> None:
        assert judge_nonsense("", step(0.5, 0.5, 0.5), step(0.5, 0.0), should_move=True).is_met
        assert judge_nonsense("", step(0.0, 0.0), step(0.0, 0.5), should_move=False).is_met

    def test_silence_is_no_change(self) -> None:
        """Who publishes only changes has changed nothing."""
        assert judge_nonsense("", step(), step(0.0), should_move=True).is_met
        assert judge_nonsense("", step(), step(0.5), should_move=False).is_met

    def test_a_velocity_that_passes_zero(self) -> None:
        """A sine is zero at times."""
        assert judge_nonsense("", step(0.1, 0.0, -0.1), step(0.0), should_move=True).is_met

    def test_a_change(self) -> None:
        """Stopping and starting by nonsense are wrong; what was under way does not hide it."""
        assert judge_nonsense("", step(0.5, 0.0, 0.0, 0.0), step(0.0), should_move=True).seen == "it stopped"
        assert not judge_nonsense("", step(0.0, 0.5, 0.5), step(0.5), should_move=False).is_met

    def test_a_node_that_ends(self) -> None:
        """It is named also where its end was noticed only when the next command had no effect."""
        death = "command_subscriber ended by itself with code 1: ValueError"
        assert judge_nonsense("", step(0.5, deaths=(death,)), step(0.0), should_move=True).seen == death
        assert judge_nonsense("", step(0.5), step(0.5, deaths=(death,)), should_move=True).seen == death

    def test_a_node_that_the_next_command_ends(self) -> None:
        """Nonsense is not blamed for a node that obeyed afterwards, and ended then."""
        death = "command_subscriber ended by itself with code 1: ValueError"
        assert judge_nonsense("", step(0.5), step(0.5, 0.0, deaths=(death,)), should_move=True).is_met
