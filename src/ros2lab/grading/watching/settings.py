"""Sets the parameters of programs while they run, each to another value and back, and hears what comes of it."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from ros2lab import every_node
from ros2lab.grading.watching.given import Given
from ros2lab.grading.watching.quiet import STEP, Quiet
from ros2lab.grading.watching.watch import Gone, NotStepped, Watch

MOST, CONTROLS = 6, 3  # parameters; times before anything is set
STEPS, REAL_STEPS = 42, 24  # for each value, on the stepped clock and on the real one


class Settings(Given):
    """Gives each parameter another value and then its own one, and all else again and again in the same way.

    The plan's `settings` are the texts that the code compares, each group after the name of what is compared with them;
    None if nothing is to be set.
    """

    def __init__(self, watch: Watch, plan: Mapping[str, Any], *given: Any) -> None:
        super().__init__(watch, plan, *given)
        self._words, self._controls, self._sets = plan["settings"], list[Any](), list[dict[str, Any]]()

    def told(self) -> dict[str, Any]:
        """Return what the grader is told of it."""
        return {**super().told(), "controls": self._controls, "sets": self._sets}

    def _turns(self) -> None:
        watch = self._watch
        if watch.is_stepped and {*watch.nodes()} - watch.clock_followers():
            raise NotStepped("A node does not follow the ROS clock.")
        quiet = Quiet(watch, is_brief=True)
        quiet.on_the_stepped_clock() if watch.is_stepped else quiet.on_the_real_clock()
        self._hear()  # afterwards all is as it will be at the end of each time
        self._controls += [self._hear() for _ in range(CONTROLS)]
        found = [(node, *one) for node, held in sorted(watch.values.items()) for one in held.items()]
        tried = [(*one, others) for one in found if (others := other_values(*one[1:], self._words))]
        for node, name, old, others in tried[:MOST]:
            if node in watch.nodes() and node not in watch.twins:
                any(self._set(node, name, value) for value in others)  # the first may be refused
                self._set(node, name, old, is_back=True)

    def _hear(self) -> dict[str, Any]:
        """Return what is published and logged for some time, while the same is given as in all other times."""
        watch = self._watch
        self._number, self._counts = 0, defaultdict(int)
        watch.part()
        watch.log_part()
        for _ in range(STEPS if watch.is_stepped else REAL_STEPS):
            self._give()
            self._number += 1
            watch.step(STEP) if watch.is_stepped else watch.until(lambda: False, STEP)
            watch.check()
        return {"topics": watch.part(), "log": watch.log_part()}

    def _set(self, node: str, name: str, value: Any, *, is_back: bool = False) -> bool:
        """Set a parameter, and note the answer and what followed; return whether it was taken."""
        watch = self._watch
        self._note_ends()
        self._last = {name: value}
        client = watch.node.create_client(SetParameters, f"{node}/set_parameters")
        watch.until(client.service_is_ready, watch.patience)
        wanted = Parameter(name, value=value).to_parameter_msg()
        answer = client.call_async(SetParameters.Request(parameters=[wanted]))
        if not watch.until(answer.done, watch.patience):
            raise Gone  # its program has ended, or does nothing more
        watch.node.destroy_client(client)
        result, told = answer.result().results[0], {"node": node, "name": name, "value": value}
        told |= {"taken": result.successful, "reason": result.reason, "back": is_back}
        self._sets.append({**told, **(self._hear() if result.successful else {})})
        return bool(result.successful)


def other_values(name: str, value: Any, words: Sequence[Sequence[str]] | None) -> list[Any]:
    """Return other values for a parameter of the code; none if it is not known which may fit."""
    if words is None or name.partition(".")[0] in every_node.PARAMETERS:
        return []
    match value:
        case bool():
            return [not value]
        case int() | float():
            near = [type(value)(value / 2), value * 2, value + 1]
            is_valid = math.isfinite if type(value) is float else range(-(2**63), 2**63).__contains__
            return [other for other in near if other not in (0, value) and is_valid(other)]
        case str():
            kin = (texts for key, *texts in words if value in texts or key == name)
            return [text for texts in kin for text in texts if text != value][:1]
    return []
