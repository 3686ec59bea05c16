"""The operands of a README's commands besides programs, topics and nodes: types, parameters and arguments.

An operand is wrong only if the evidence plainly contradicts it: a type that no end of the topic has, a
parameter that a node which was asked does not have, an argument that no launch file of that name uses.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath

from ros2lab import every_node
from ros2lab.grading.evidence import Files, Run
from ros2lab.grading.judging.player import STAND_IN

_TYPE = re.compile(r"([a-z]\w*)/(?:msg/)?([A-Z]\w*)")
_NAME = re.compile(r"[a-z_][\w.]*")
_GIVEN = re.compile(r"([a-z_][\w.]*):=.*")  # capitals are placeholders
# The options after --ros-args, up to a bare -- (rcl's own grammar); some take a value.
_ROS_FLAGS = re.compile(
    r"--|-[pre]|--(?:param|remap|enclave|params-file|log-level|log-config-file|log-file-name)"
    r"|--(?:en|dis)able-(?:rosout|stdout|external-lib)-logs"
)


class Operands:
    """Checks the operands of commands.

    Args:
        facts: the facts of the files.
        runs: the runs of the programs.
    """

    def __init__(self, facts: Files, runs: Sequence[Run]) -> None:
        self._facts = facts
        self._runs = runs

    def fit(self, words: Sequence[str]) -> bool:
        """Return whether no operand of a command is plainly wrong."""
        match words:
            case ["ros2", "topic", "pub" | "echo", *rest]:
                return self._has_type(rest)
            case ["ros2", "param", "get" | "set" | "describe", *rest]:
                node, name, *_ = (*(word for word in rest if not word.startswith("-")), "", "")
                return not _NAME.fullmatch(name) or self._has_parameter(self._held(node), name)
            case ["ros2", "run", _, program, *rest] if "--ros-args" in rest:
                return self._takes(program, rest[rest.index("--ros-args") + 1 :])
            case ["ros2", "launch", _, file, *rest]:
                return not any(
                    self._is_unnamed(file, match[1]) for match in map(_GIVEN.fullmatch, rest) if match
                )
        return True

    def _has_type(self, words: Sequence[str]) -> bool:
        """Return whether a topic has the type given in a command; True if none is given, or none is known."""
        topic = next((word for word in words if word.startswith("/")), "")
        given = next(filter(None, map(_TYPE.fullmatch, words)), None)
        types = {
            kind
            for run in self._runs
            for ends in (run.publishes, run.subscribes)
            for kinds in ends.get(topic, {}).values()
            for kind in kinds
        }
        known = {match.groups() for match in map(_TYPE.fullmatch, types) if match}
        return not (given and known) or STAND_IN in types or given.groups() in known

    def _held(self, node: str) -> list[set[str]]:
        """Return the parameters of a node, for each run in which it reported them."""
        return [{*run.parameters[node]} for run in self._runs if node in run.parameters]

    def _has_parameter(self, held: Sequence[set[str]], name: str) -> bool:
        is_known = name.partition(".")[0] in every_node.PARAMETERS or name in self._facts.declared
        return is_known or not held or any(name in names for names in held)

    def _takes(self, program: str, words: Sequence[str]) -> bool:
        """Return whether a program takes the words after `--ros-args`."""
        own = [run for run in self._runs if run.programs == [program] and run.setting == "alone"]
        held = [names for run in own for node in run.nodes for names in self._held(node)]
        # A program that has not reported its parameters, or whose nodes were not seen, may have any.
        is_told = bool(own) and all(run.parameters.keys() >= {*run.nodes} for run in own)
        before = ""
        for word in words:
            if word == "--":
                return True
            if word.startswith("-") and not _ROS_FLAGS.fullmatch(word):
                return False
            given = _GIVEN.fullmatch(word) if before in ("-p", "--param") else None
            if given and is_told and not self._has_parameter(held, given[1]):
                return False
            before = word
        return True

    def _is_unnamed(self, file: str, argument: str) -> bool:
        """Return whether there are launch files of this name, and none of them uses an argument."""
        found = [
            names
            for path, names in self._facts.launch_lacks.items()
            if PurePosixPath(path).name == PurePosixPath(file).name
        ]
        return bool(found) and all(argument in names for names in found)
