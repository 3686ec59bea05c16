"""What programs publish before any command, and in which rhythm: on the stepped clock, or on the real one."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable

from ros2lab.grading.watching.ear import Ear
from ros2lab.grading.watching.watch import NotStepped, Watch
from ros2lab.observed_domain import LATE
from ros2lab.rhythm import REAL_HORIZON

STEP = 0.1  # s of the stepped clock
QUICK = 1.0  # s: topics with shorter periods are observed in small steps
BRIEF_HORIZON = 2.6  # s, where periods are known already
HORIZON = 8.0  # s, for three messages of a 2.4 s timer
FAR_HORIZON = 12.0  # s, for two of a 5 s timer
JUMPS = 3
MOST_LOOKS = 4  # at the graph for new topics
SLOW = 5.0  # s, in which two messages of a 2.4 s timer come
MANY = 12  # messages after which a topic is believed to go on
TOO_LITTLE = "Too little comes on"
UNEVEN = 0.45  # s, the largest difference between the gaps of one topic


class Quiet:
    """The part of a run before any command.

    Args:
        watch: the run's Watch.
        is_brief: whether it is already known what the programs do alone.

    Attributes:
        stalled: topics that were published in a rhythm and then stopped.
    """

    def __init__(self, watch: Watch, *, is_brief: bool) -> None:
        self.stalled: list[str] = []
        self._watch = watch
        self._is_brief = is_brief
        self._begin = time.monotonic()
        self._is_fine = False  # whether to go on in short steps, since one long step brought nothing

    def on_the_stepped_clock(self) -> None:
        """Step the clock until the rhythm of each topic is known.

        Raises:
            NotStepped: if a topic does not follow the clock.
            Gone: if all programs have ended.
        """
        watch = self._watch
        self._begin = time.monotonic()
        # On a busy machine a node may answer before the graph shows what it publishes.
        for _ in range(MOST_LOOKS):
            self._step_until_heard()
            if not watch.look_again():
                break
        closed = [ear.topic for ear in watch.ears.values() if ear.is_closed]
        if closed:
            raise NotStepped(unfollowing(closed))
        periodic = watch.periodic()
        # What a thread publishes is seen whenever the thread gets its turn; on the real clock, when it comes.
        uneven = [ear.topic for ear in periodic if max(ear.gaps()[1:]) - min(ear.gaps()[1:]) > UNEVEN]
        if uneven:
            raise NotStepped(unfollowing(uneven))
        if periodic:
            self._jump(periodic)

    def _step_until_heard(self) -> None:
        watch = self._watch
        start, kept = watch.now(), dict[Ear, int]()
        horizon, least = (BRIEF_HORIZON, 1) if self._is_brief else (HORIZON, 3)

        def step(times: int) -> None:
            """Step the clock, in larger steps once enough messages of all quick topics were heard."""
            quick = [ear for ear in watch.periodic() if min(ear.gaps()[1:]) < QUICK]
            is_first = watch.now() < start + QUICK
            if not is_first:
                kept.update({ear: ear.count for ear in quick if ear.count >= least and ear not in kept})
            watch.step(STEP if is_first or any(ear not in kept for ear in quick) else times * STEP)

        while watch.now() < start + horizon and not (
            watch.now() >= start + QUICK and _all_have(watch, least)
        ):
            # A topic without two messages by now is slow, if it comes again at all.
            is_slow = watch.now() >= start + SLOW and all(
                ear.count < 2 or ear.count >= least for ear in watch.ears.values()
            )
            step(5 if is_slow else 2)
            watch.check_still()
        while not self._is_brief and watch.now() < start + FAR_HORIZON and not _all_have(watch, 2):
            step(5)
        for ear, count in kept.items():  # messages in larger steps tell nothing about the rhythm
            ear.forget(count)

    def _jump(self, periodic: list[Ear]) -> None:
        watch = self._watch
        # A topic that follows the clock comes once per jump, however short in real time, and never in
        # between.
        jump = max(max(ear.gaps()) for ear in periodic)
        kept = [(ear, ear.count) for ear in watch.ears.values()]
        longest = 0.0
        for _ in range(JUMPS):
            start = time.monotonic()
            if late := self._leap(periodic, jump):
                raise NotStepped(unfollowing(late))
            longest = max(longest, time.monotonic() - start)
        before = {ear.topic: ear.total for ear in periodic}
        watch.until(lambda: any(e.total > before[e.topic] + 1 for e in periodic), max(0.02, 4 * longest))
        restless = [ear.topic for ear in periodic if ear.total > before[ear.topic] + 1]
        if restless:
            raise NotStepped(unfollowing(restless))
        while not self._is_brief and any(ear.total < MANY for ear in self._going(periodic)):
            if self._leap(periodic, jump):
                break
        for ear, count in kept:
            ear.forget(count)

    def _leap(self, periodic: list[Ear], jump: float) -> list[str]:
        """Set the clock forward by the longest period; return the silent topics that have not stalled."""
        late = self._silent_after(self._going(periodic), jump)
        if late and self._are_at_rest(late):
            # A timer that fires more often than its node publishes fires once per step, however long that is.
            self._is_fine = True
            still = self._silent_after(late, jump + STEP)
            if still == late:
                self.stalled += [ear.topic for ear in late]
                return []
            late = still
        return [ear.topic for ear in late]

    def _silent_after(self, ears: list[Ear], seconds: float) -> list[Ear]:
        """Set the clock forward, at once or in short steps; return the silent topics."""
        step = (STEP if seconds < QUICK else 2 * STEP) if self._is_fine else seconds
        return silent_after(self._watch, ears, seconds, step)

    def _going(self, ears: list[Ear]) -> list[Ear]:
        return [ear for ear in ears if ear.topic not in self.stalled]

    def _are_at_rest(self, late: list[Ear]) -> bool:
        """Return whether topics that had a rhythm are silent on the real clock, too."""
        watch = self._watch
        before = watch.heard
        period = (time.monotonic() - self._begin) / min(ear.total for ear in late)  # if it was in real time
        is_rhythm = all(ear.count > 2 for ear in late)
        return is_rhythm and not watch.until(lambda: watch.heard > before, max(watch.late, 3 * period))

    def on_the_real_clock(self) -> None:
        """Listen until the rhythm of each topic is known, or must have shown.

        Raises:
            Gone: if all programs have ended.
        """
        watch = self._watch
        horizon, least = (BRIEF_HORIZON, 1) if self._is_brief else (REAL_HORIZON, 3)
        # A loop around spin_once publishes whenever we ask it something: that is no rhythm of its own.
        watch.until(lambda: False, watch.late)
        for ear in watch.ears.values():
            ear.set_aside()
        start = watch.now()

        def is_enough() -> bool:
            return watch.now() - start > 1.0 and _all_have(watch, least)

        while watch.now() - start < horizon and not is_enough():
            watch.until(is_enough, LATE)
            watch.check()
            watch.look_again()
        for ear in watch.ears.values():
            if ear.count < 2:
                ear.take_back()
        # Topics on the stepped clock have been checked already.
        if not self._is_brief:
            doubtful = filter(_is_doubtful, watch.periodic())
            self.stalled += [ear.topic for ear in doubtful if not self._comes_again(ear)]

    def _comes_again(self, ear: Ear) -> bool:
        watch = self._watch
        before = ear.total
        is_again = watch.until(lambda: ear.total > before, max(watch.patience, 2 * max(ear.gaps()[1:])))
        watch.check()
        return is_again


def silent_after(watch: Watch, ears: list[Ear], seconds: float, step: float = math.inf) -> list[Ear]:
    """Set the clock forward, `step` s at a time; return the given topics on which nothing was published then."""
    before = {ear.topic: ear.total for ear in ears}
    end = watch.now() + seconds
    while (left := end - watch.now()) > step + STEP / 100:
        watch.step(step)
    watch.step(left)
    watch.until(lambda: all(ear.total > before[ear.topic] for ear in ears), watch.late)
    watch.check()
    return [ear for ear in ears if ear.total <= before[ear.topic]]


def unfollowing(topics: Iterable[str]) -> str:
    """Say which topic shows that a program does not follow the stepped clock."""
    return f"What comes on {min(topics)} does not follow the stepped clock."


def too_little(topics: Iterable[str]) -> str:
    """Say on which topic too few messages came to show that a program follows the stepped clock."""
    return f"{TOO_LITTLE} {min(topics)} to tell whether it follows the stepped clock."


def _is_doubtful(ear: Ear) -> bool:
    """Return whether a periodic topic may have stopped: it is overdue, or few messages were seen."""
    return max(ear.gaps()[1:]) >= 1.0 if ear.count < 3 else ear.is_overdue()


def _all_have(watch: Watch, count: int) -> bool:
    return all(ear.count >= count or ear.is_closed for ear in watch.ears.values())
