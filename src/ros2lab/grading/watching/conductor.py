"""Conducts a run of a submission's programs on the ROS graph, in the observer."""

from __future__ import annotations

import contextlib
import math
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from ros2lab.assignments import Assignment
from ros2lab.grading.watching import OWN_CLOCK, ends
from ros2lab.grading.watching.ear import TEXT, gaps
from ros2lab.grading.watching.given import Given, wanted
from ros2lab.grading.watching.quiet import STEP, Quiet, silent_after, too_little
from ros2lab.grading.watching.script import FLOOD, Script
from ros2lab.grading.watching.service_calls import call_services
from ros2lab.grading.watching.settings import Settings
from ros2lab.grading.watching.watch import ANSWER_TIMEOUT, Gone, NotStepped, Watch
from ros2lab.observed_domain import LATE

QUEUE = 10  # messages of a flood that a node keeps in its queue, and takes one after the other
FLOOD_ROUNDS = 20  # each lets a node take two messages from its queue
TIMER = 1.0  # s, the period of a node that acts on a command later
TWINS = "Which of two nodes of one name follows the clock cannot be told."

# How long we wait, in s, for what only a wrong program, or one that never spins, keeps from coming.
START_TIMEOUT = 30.0
MEET_TIMEOUT = 5.0  # participants announce themselves every 3 s
REACTION_TIMEOUT = 1.0
REACTION_MESSAGES = 3  # a loop that takes one message per round publishes once or twice before it obeys
SLOW_REACTION = 2.0  # s between messages; for slower topics we do not wait after a command
MOST_UNANSWERED = 2  # unanswered commands in a row, after which we stop waiting
LEAVE_TIMEOUT = 0.5
MOMENT = 0.02
MOST_LONGER = 10.0  # s of real time in which the clock is stepped further


class Conductor:
    """Conducts one run, from the start of its programs to their end.

    Args:
        assignment: the assignment whose parts the programs may play.
        plan: `run` (its number), `domain`, `seconds` (its time limit), `programs` (how many), `nodes` (how
            many a launch file has to start; 0 for other programs), `enclaves` (those that tell which program
            a node belongs to, if that is to be told), `is_stepped`, `has_commands`, `is_brief` (what the
            programs do alone is known), `is_again` (so is what they do on commands), `contents` (what their code
            compares, by topic, if they are given what they may wait for; else None), `longer` (s, for which the clock
            is stepped further), `has_keys` (whether somebody types for them).
        say: sends a message to the grader.
    """

    def __init__(
        self, assignment: Assignment, plan: dict[str, Any], say: Callable[[dict[str, Any]], None]
    ) -> None:
        self.plan = plan
        self._assignment = assignment
        self._script = Script(assignment.commanded)
        self._send = say
        self._alive = plan["programs"]
        self._go = threading.Semaphore(0)
        self._marks = 0
        self._commands: list[dict[str, Any]] = []
        self._calls: list[dict[str, Any]] = []
        self._quiet: dict[str, Any] = {}
        self._quiet_log: list[list[str]] = []
        self._stalled: list[str] = []
        self._may_begin = False  # whether the command is the first one, or a word of the submission's own
        self._coming: set[str] = set()  # topics with messages when the stepped clock was last set far forward
        self._longest_taken = 0.0  # s, the longest that a node needed to take a command
        self._unanswered = 0  # commands in a row after which a node did not answer
        self._unfollowed = 0  # commands in a row after which nothing came
        self._has_printed = False  # since the last mark
        self._first_values: dict[str, dict[str, Any]] = {}
        self._waits: list[str] = []
        self._given: Given | None = None
        self._meanwhile: dict[str, Any] = {}  # what was published while it was given
        self._clocked: set[str] = set()
        self._fault = ""  # of the observer's own, that has ended the run
        self._deadline = time.monotonic() + plan["seconds"]

    def tell(self, message: dict[str, Any]) -> None:
        """Take a message from the grader: how many programs live, whether they printed, whether to go on."""
        self._alive = message.get("alive", self._alive)
        self._has_printed = message.get("printed", self._has_printed)
        if message.get("go"):
            self._go.release()

    def run(self) -> None:
        """Conduct the run, and send what was seen."""
        try:
            with contextlib.closing(
                Watch(
                    self._assignment,
                    self.plan["domain"],
                    is_stepped=self.plan["is_stepped"],
                    alive=lambda: self._alive,
                    at_each_turn=(lambda: self._say("type")) if self.plan["has_keys"] else None,
                )
            ) as watch:
                self._say("start")
                try:
                    self._observe(watch)
                    watch.look()
                except NotStepped as reason:
                    # Which of two nodes with the same name shows it first is chance.
                    why = TWINS if self._has_twin(watch) else str(reason)
                    self._say("real", why=why, parameters=self._first_values)
                    return
                except Gone:
                    pass
                except Exception as error:  # what was seen by then counts
                    self._fault = _told(error)
                self._end(watch)
        except Exception as error:  # the grader reports it
            self._say("failed", why=_told(error))

    def _observe(self, watch: Watch) -> None:
        self._await_nodes(watch)
        self._say("met")
        self._waits = sorted({name for _, name, _ in wanted(watch)} - {watch.command_topic()})
        if self.plan["contents"] is not None:
            self._give(watch)
        if self._given is None or self.plan["has_commands"]:
            self._listen(watch)
        self._quiet = watch.part()
        self._mark()  # what was printed before belongs to the quiet part
        self._quiet_log = watch.log_part()
        self._coming = {t for t, heard in self._quiet.items() if heard["count"] > 1} - {*self._stalled}
        self._go_on(watch)
        self._verify_owners(watch)
        silent = [ear for ear in watch.ears.values() if ear.total < 2]
        answered = dict.fromkeys((ear.topic for ear in silent), 0)
        if self.plan["has_commands"]:
            for call in call_services(watch, self._assignment.services, answered, self._is_whole):
                self._calls.append(call)
            if self._calls:  # log lines about a request belong to no command
                watch.log_part()
                self._mark()
            if watch.command_topic():
                self._give_commands(watch, answered)
        # How many messages prove that a topic follows the clock: one that follows another may come only later.
        least = 3 if self.plan["is_brief"] or self.plan["programs"] > 1 else math.inf
        unknown = [t for t, count in answered.items() if count < 2 and watch.ears[t].total < least]
        if watch.is_stepped and unknown and not (self.plan.get("longer") or "settings" in self.plan):
            raise NotStepped(too_little(unknown))

    def _give(self, watch: Watch) -> None:
        """Give the programs what they may wait for, and record what is published meanwhile if more follows."""
        is_followed = self.plan["has_commands"]
        kind = Settings if "settings" in self.plan else Given
        self._given = kind(watch, self.plan, [] if is_followed else self._calls, lambda: self._alive)
        try:
            self._given.give_all()
        finally:
            if is_followed:
                self._meanwhile = watch.part()
                watch.log_part()

    def _listen(self, watch: Watch) -> None:
        """Record what is published before any command."""
        quiet = Quiet(watch, is_brief=self.plan["is_brief"])
        self._stalled = quiet.stalled if self._given is None else []
        if not watch.is_stepped:
            quiet.on_the_real_clock()
            return
        unclocked = set(watch.nodes()) - watch.clock_followers()
        if unclocked:
            raise NotStepped(f"{min(unclocked)} does not follow the ROS clock.")
        quiet.on_the_stepped_clock()
        if self._has_twin(watch):
            raise NotStepped(TWINS)

    def _go_on(self, watch: Watch) -> None:
        """Step the clock further, if the plan says so, as long as that is quick and the nodes follow."""
        end = time.monotonic() + MOST_LONGER
        with contextlib.suppress(NotStepped):
            for _ in range(round(self.plan.get("longer", 0.0) / STEP) if watch.is_stepped else 0):
                if time.monotonic() < end:
                    watch.step(STEP)

    def _verify_owners(self, watch: Watch) -> None:
        """Ask the nodes of each program while all others are held, for a node may report another's enclave.

        Raises:
            NotStepped: if a node does not answer then.
        """
        for enclave in self.plan["enclaves"]:
            self._hold(enclave)
            own = [node for node in watch.asked() if enclave in watch.enclaves[node]]
            if silent := watch.ask(own, watch.patience):
                raise NotStepped(f"{min(silent)} is not of the program whose enclave it tells.")
        if self.plan["enclaves"]:
            self._hold("")

    def _hold(self, enclave: str) -> None:
        """Have the grader let only the program of an enclave run, or all of them if it is empty."""
        self._say("hold", enclave=enclave)
        self._go.acquire()

    def _give_commands(self, watch: Watch, answered: dict[str, int]) -> None:
        """Send all commands, or only a few if the time does not suffice for more."""
        # All were tried already: alone, or with the programs' own parameters.
        is_told_before = any(self.plan[key] for key in ("is_brief", "nodes", "is_again"))
        is_told_before |= self._given is not None
        if is_told_before and self._script.before:
            self._command(watch, self._script.first, answered)
        is_quick = watch.is_answering and not watch.is_slow
        waiting = deque(self._script.all if is_quick and not is_told_before else self._script.few)
        longest = 0.0
        while waiting and (left := self._deadline - time.monotonic()) > longest:
            flood = QUEUE * self._longest_taken if self._script.flood in waiting else 0.0
            if is_quick and not is_told_before and longest * len(waiting) + flood > left:
                is_quick, said = False, {command["text"] for command in self._commands}
                waiting = deque(text for text in self._script.few if text not in said)
                continue
            start = time.monotonic()
            self._command(watch, waiting.popleft(), answered)
            longest = max(longest, time.monotonic() - start)
        if waiting or not is_quick:
            watch.notes.add("A node is slow to answer: not all of the commands were tried.")

    def _is_whole(self) -> bool:
        return bool(self._alive == self.plan["programs"])

    def _has_twin(self, watch: Watch) -> bool:
        return self.plan["programs"] == 1 and bool(watch.twins)

    def _await_nodes(self, watch: Watch) -> None:
        watch.wait_for_start(lambda: watch.nodes() or not self._alive, START_TIMEOUT)
        watch.until(lambda: watch.participants() >= self._alive, START_TIMEOUT)
        watch.until(lambda: len(watch.nodes()) >= self.plan["nodes"], START_TIMEOUT)
        watch.check()
        watch.look()  # from now on, what does not follow the clock is heard
        watch.until(lambda: not watch.has_nameless(), watch.patience)
        watch.look()  # one that never answers may have gone by the next time
        watch.is_answering = watch.settle(watch.patience)
        watch.check()
        watch.check_still()
        watch.look()
        # Under load one participant may be met seconds after another, and the graph shows an endpoint before
        # its node.
        watch.until(lambda: not watch.has_unmet() and not watch.has_nameless(), MEET_TIMEOUT)
        watch.look()
        if watch.is_stepped and not watch.is_answering:
            raise NotStepped("A node does not answer.")
        watch.list_parameters()  # by new clients, as in `look_again`
        # A node that was met only now may not answer.
        watch.is_answering &= watch.settle(ANSWER_TIMEOUT if watch.is_answering else LATE)
        watch.look_again()
        watch.check()
        watch.check_still()
        self._first_values = {name: dict(values) for name, values in sorted(watch.values.items())}

    def _command(self, watch: Watch, text: str, answered: dict[str, int]) -> None:
        totals = {topic: watch.ears[topic].total for topic in answered}
        before = {name: dict(values) for name, values in watch.values.items()}
        self._may_begin = not self._commands or text in self._script.own
        self._say_command(watch, text)
        if text in self._script.changes:
            for topic, total in totals.items():
                answered[topic] += watch.ears[topic].total > total
        watch.look_again()
        with contextlib.suppress(Gone):
            watch.check()
            self._let_time_pass(watch)
            if watch.look_again():
                self._let_time_pass(watch)
        said = [command["text"] for command in self._commands]
        if self._script.flood in said and text == said[-1] and not watch.has_part():
            # What a flood crowded out comes with the next DDS heartbeat, in real time.
            watch.until(watch.has_part, watch.patience)
        self._commands.append(
            {
                "text": text,
                "mark": self._mark(),
                "topics": watch.part(),
                "log": watch.log_part(),
                "parameters": {
                    f"{node}:{name}": value
                    for node, values in sorted(watch.values.items())
                    for name, value in values.items()
                    if before.get(node, {}).get(name) != value
                },
                "alive": self._alive,
                "anew": [] if self.plan["nodes"] else watch.anew(self.plan["programs"]),
            }
        )
        watch.check()

    def _say_command(self, watch: Watch, text: str) -> None:
        """Publish a command and wait until the nodes have taken it."""
        if self._script.before and text == self._script.first:
            for word in self._script.before[:-1]:
                watch.say(watch.command_topic(), word)
                watch.settle(watch.patience)
            text = self._script.before[-1]
        is_flood = text == self._script.flood
        for word in FLOOD // 2 * self._script.words[:2] if is_flood else (text,):
            watch.say(watch.command_topic(), word)
        if watch.is_answering:
            start = time.monotonic()
            is_answered = watch.settle(least=FLOOD_ROUNDS if is_flood else 1)
            self._longest_taken = max(self._longest_taken, time.monotonic() - start)
            self._unanswered = 0 if is_answered else self._unanswered + 1
            watch.is_answering = self._unanswered < MOST_UNANSWERED
            if self._unfollowed < MOST_UNANSWERED:
                self._unfollowed = 0 if self._is_followed(watch) else self._unfollowed + 1
        if is_flood:  # how many of them a queue of ten loses is chance
            watch.part()
            watch.log_part()
            self._mark()

    def _is_followed(self, watch: Watch) -> bool:
        """Wait for a reaction to a command; a node with threads may react after it has answered questions."""
        if watch.until(watch.has_part, MOMENT):
            return True
        self._say_mark("look", 0)
        # A log line is printed before it is published.
        return (
            watch.until(watch.has_part, 5 * MOMENT if self._has_printed else watch.late) or self._has_printed
        )

    def _let_time_pass(self, watch: Watch) -> None:
        """After a command, wait until the topics that are published repeatedly have come again."""
        periods = {topic: self._period(topic) for topic in watch.ears}
        if watch.is_stepped:
            # Where nothing is published by itself, the reaction may wait for a timer.
            self._step_on(watch, max(periods.values(), default=0.0) or TIMER)
        else:
            self._wait_on(watch, periods)

    def _step_on(self, watch: Watch, longest: float) -> None:
        for _ in range(3):
            watch.step(STEP)
        for _ in range(2 if longest > STEP else 0):
            before = {topic: ear.total for topic, ear in watch.ears.items()}
            silent_after(watch, [watch.ears[topic] for topic in self._coming], longest)
            self._coming = {topic for topic, total in before.items() if watch.ears[topic].total > total}

    def _wait_on(self, watch: Watch, periods: Mapping[str, float]) -> None:
        """Wait for the next messages on frequent topics, and on those that are to answer commands."""
        # A robot that starts with the first command, or with a word of its own, publishes velocities
        # repeatedly or once: that takes time to see.
        moved = {
            part.type_name
            for part in self._assignment.parts.values()
            if part.is_publisher and not part.period and not part.when
        }
        moving = {topic for topic, ear in watch.ears.items() if ear.type_name in moved}
        if self._may_begin:
            begun = [watch.ears[topic] for topic in moving if watch.ears[topic].total < 2]
            watch.until(lambda: all(ear.total > 1 for ear in begun), REACTION_TIMEOUT)
        waited = {
            topic: period
            for topic, period in periods.items()
            if 0 < period <= (SLOW_REACTION if topic in moving else LATE)
        }
        before = {topic: watch.ears[topic].total for topic in waited}
        if waited:
            longest = max(REACTION_TIMEOUT, REACTION_MESSAGES * max(waited.values()) + LATE)
            watch.until(
                lambda: all(watch.ears[t].total >= before[t] + REACTION_MESSAGES for t in waited), longest
            )
        elif not watch.is_answering:
            watch.until(lambda: False, REACTION_TIMEOUT)
        elif self.plan["is_again"]:  # what comes of a command is known, and is missed if it does not come
            watch.until(lambda: False, watch.late)

    def _period(self, topic: str) -> float:
        """Return the longest gap between messages on a topic before any command, in s; 0 if there is none."""
        times = self._quiet.get(topic, {}).get("times", [])
        # On the real clock, what came before the first message is the time in which programs start.
        return max(gaps(times)[0 if self.plan["is_stepped"] else 1 :], default=0.0)

    def _end(self, watch: Watch) -> None:
        ended_before, gone = self._alive == 0, watch.glimpsed()
        participants = watch.participants()
        if participants > self.plan["programs"] and not self.plan["nodes"]:
            more = f"{participants} instead of {self.plan['programs']}"
            watch.notes.add(f"Nodes joined ROS as if they were of more programs than were started: {more}.")
        if not watch.is_stepped and OWN_CLOCK not in watch.notes:
            self._clocked = watch.clock_followers()
        self._say("interrupt")
        self._go.acquire()  # all have ended
        topics = [topic for topic in watch.ears if topic in watch.publishes]
        watch.wait(lambda: not any(watch.node.count_publishers(topic) for topic in topics), LEAVE_TIMEOUT)
        before = -1
        while before != watch.heard:  # their last messages
            before = watch.heard
            watch.wait(lambda: watch.heard > before, MOMENT)  # noqa: B023
        final = {topic: ear.plain(ear.last) for topic, ear in sorted(watch.ears.items()) if ear.last}
        if ended_before and not self._quiet:
            self._quiet = watch.part()
        names = sorted(watch.names - gone)
        publishes, subscribes = ends.left(watch.publishes, gone), ends.left(watch.subscribes, gone)
        self._say(
            "result",
            nodes=names,
            enclaves={name: sorted(watch.enclaves.get(name, ())) for name in names},
            publishes=publishes,
            subscribes=subscribes,
            qos={topic: sorted(watch.qos[topic]) for topic in sorted({*publishes, *subscribes})},
            parameters=dict(sorted({**watch.values, **self._first_values}.items())),  # some come later
            quiet=self._quiet,
            log=self._quiet_log,
            twins=sorted(watch.twins),
            stalled=self._stalled,
            commanded=watch.command_topic(),
            commands=self._commands,
            services=ends.left(watch.services, gone),
            calls=self._calls,
            waits=self._waits,
            meanwhile=self._meanwhile,
            handed_on=self._given.handed_on(self._meanwhile) if self._given else [],
            **(self._given.told() if self._given else {}),
            clocked=sorted(self._clocked),
            final=final,
            notes=sorted(watch.notes),
            why=self._fault,
        )

    def _say(self, do: str, **more: Any) -> None:
        self._send({"run": self.plan["run"], "do": do, **more})

    def _mark(self) -> int:
        """Have the grader mark how much the programs have printed so far.

        The World reads the programs' output and ours in one thread. The second line is written after it has
        read the first; once it has read the second, it has read all that was printed before the first.
        """
        self._marks += 1
        self._say_mark("a", 0)
        self._say_mark("b", self._marks)
        return self._marks

    def _say_mark(self, label: str, number: int) -> None:
        """Print a line and wait until the grader has seen it; a number also marks the output until then."""
        line = f"({self.plan['run']}.{self._marks}{label})\n"
        os.write(1, line.encode())
        self._say("mark", line=line, number=number)
        self._go.acquire()


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"[:TEXT]
