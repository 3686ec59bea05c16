"""Which node plays which part of the assignment: by topics and types, never by names alone."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from pathlib import PurePosixPath

from ros2lab.assignments import Assignment, Part
from ros2lab.diagnose.sources.spelling import is_near_topic
from ros2lab.grading.evidence import Evidence, Executable, Run, WrittenEnd
from ros2lab.grading.judging.by_type import (
    Candidate,
    is_alike,
    match_by_type,
    may_end,
    rightful,
    with_like_types,
    without_intruders,
)
from ros2lab.grading.judging.deaf import without_deaf
from ros2lab.grading.judging.doubled import Node, doubled
from ros2lab.grading.judging.player import (
    MATCHES,
    PLAIN_SETTINGS,
    Match,
    Player,
    is_busy,
    is_done,
    is_for_want,
    lacked,
    on_one_topic,
    stamped,
    without_given,
)
from ros2lab.grading.judging.ways import Way, best_way, shut_out
from ros2lab.grading.reading.deeds import PUBLISHES, READS
from ros2lab.grading.reading.unread import noted

MOST_PLAYERS = 10  # nodes that are considered for one part


class Case:
    """The evidence, and which nodes play the parts of the assignment in it."""

    def __init__(self, evidence: Evidence, assignment: Assignment) -> None:
        self.evidence = noted(evidence)
        self.assignment = assignment.with_unknown(evidence.coined)

    @cached_property
    def executables(self) -> dict[str, Executable]:
        """The programs by name."""
        build = self.evidence.build
        return {executable.name: executable for executable in build.executables} if build else {}

    @property
    def package(self) -> str:
        """The name of the assignment's package; empty if there is none."""
        package = self.evidence.submission.package
        return (package.name or "") if package else ""

    def at(self, file: str) -> str:
        """Return the path of a file of the package, or of the one whose module it is, as it was handed in."""
        submission, name = self.evidence.submission, file.partition("/")[0]
        packages = filter(None, (submission.package, *submission.packages))
        package = next((one for one in packages if one.name == name), submission.package)
        return str(PurePosixPath(package.folder, file)) if package else file

    @cached_property
    def short_lived(self) -> frozenset[str]:
        """The full names of the nodes whose program ended by itself when run alone."""
        alone = (run for run in self.evidence.runs if run.setting == "alone" and run.ended)
        return frozenset(node for run in alone for node in run.nodes)

    @cached_property
    def _found(self) -> dict[str, list[Player]]:
        """By part, the nodes that may play it."""
        runs = [
            (number, run) for number, run in enumerate(self.evidence.runs) if run.setting in PLAIN_SETTINGS
        ]
        owners = {node: run.programs[0] for _, run in runs if run.setting == "alone" for node in run.nodes}
        found: dict[str, list[Player]] = {name: [] for name in self.assignment.parts}
        for number, run in runs:
            for player in (*self._players_in(number, run, owners), *self._read_in(number, run)):
                found[player.part.name].append(player)
        taken = rightful(found)
        found = without_intruders(found, taken)
        for name, part in self.assignment.parts.items():
            # A part that seems missing may be there by another name, whatever else cannot be started or ended.
            if all(player.is_idle for player in found[name]):
                for number, run in runs:
                    alike = self._players_in(number, run, owners, by_type=part, taken=taken)
                    found[name] += [player for player in alike if player.part is part]
        return {
            name: [] if self.is_foreign(self.assignment.parts[name]) else without_given(players)
            for name, players in found.items()
        }

    def may_be(self, program: str, part: Part) -> bool:
        """Return whether a program of which nothing was seen may have a part's node.

        Its name decides; else its modules must make such an end, or it must be unknown what they make. One that
        cannot be started is known by its modules alone: without any, it makes nothing, whatever it is called.
        """
        executable, meant = self.executables.get(program), self.assignment.meant_by(program)
        if executable and not executable.command:
            if not executable.modules:
                return False
        elif meant is not None:
            return meant is part
        modules = {*executable.modules, executable.stem} - {""} if executable else set()
        ends = [end for end in self.evidence.files.ends if end.module in modules]
        if executable and executable.modules and not ends:
            return self._is_unread(modules)
        return not ends or any(may_end(end, part) for end in ends)

    def is_written(self, part: Part) -> bool:
        """Return whether the code may make a part's end, as far as reading tells."""
        return part.end == "service" or any(may_end(end, part) for end in self.evidence.files.ends)

    def is_foreign(self, part: Part) -> bool:
        """Return whether no code in the submission can make a part's end: a node with one is not its own."""
        elsewhere = self.evidence.files.ends_elsewhere
        is_read = elsewhere is not None and "ends" not in self.evidence.files.unread
        is_known = is_read and not self.is_written(part)
        return is_known and not any(may_end(end, part) for end in elsewhere or ())

    def _is_unread(self, modules: Collection[str]) -> bool:
        """Return whether one of some modules has a syntax error, or was not read, so that it is unknown what it makes."""
        return "ends" in self.evidence.files.unread or not self._broken.isdisjoint(modules)

    @cached_property
    def _broken(self) -> set[str]:
        """The modules that have a syntax error."""
        places = {finding.place for finding in self.evidence.files.told() if finding.code == "node-syntax"}
        return {PurePosixPath(place.partition(":")[0]).stem for place in places}

    @property
    def has_whole_code_read(self) -> bool:
        """Whether reading has found some ends, or that no code of the submission can make any."""
        files = self.evidence.files
        is_empty = files.ends_elsewhere == [] and "ends" not in files.unread and not self._broken
        return bool(files.ends) or is_empty

    @cached_property
    def shut_out(self) -> dict[str, str]:
        """The programs that run alone but not beside the others; with the last output of each there."""
        return shut_out(self.evidence.runs)

    @cached_property
    def players(self) -> dict[str, list[Player]]:
        """By part, its players in each run, the most telling first.

        A program that does not run beside the others counts only if it is the best way of starting.
        """
        if not self.shut_out:
            return self._everybody
        numbers = {player.number for players in self.way.values() for player in players}
        return {
            name: [
                player
                for player in players
                if player.number in numbers or (name in self.way and not self.is_solitary(player))
            ]
            for name, players in self._everybody.items()
        }

    def is_solitary(self, player: Player) -> bool:
        """Return whether a player was seen alone, and its program does not run beside the others."""
        return player.run.setting == "alone" and player.program in self.shut_out

    def shut_out_of(self, part: Part) -> str:
        """Return the program that would play a part if it ran beside the others; empty if there is none."""
        players = (player for player in self._everybody[part.name] if self.is_solitary(player))
        return next((player.program for player in players), "")

    @cached_property
    def _everybody(self) -> dict[str, list[Player]]:
        """By part, its players in all runs, sorted as in `players`."""
        found = {
            name: [player for player in players if self._is_backed(player)]
            for name, players in self._found.items()
        }
        for name, players in found.items():
            taken = {
                (player.number, player.topic, player.part.is_publisher)
                for candidates in found.values()
                for player in candidates
                if player.part.name != name and player.match in ("right", "near")
            }
            kept = [
                player
                for player in players
                if player.match in ("right", "near")
                or not any((player.number, player.topic, end) in taken for end in player.taken_ends)
            ]
            found[name] = [*on_one_topic(sorted(kept, key=self._rank))]
        # Other nodes may take the commands, too; the one that plays no other part is meant.
        busy = {
            (player.number, player.node)
            for players in found.values()
            for player in players
            if player.part.is_publisher and player.match == "right"
        }
        for name, part in self.assignment.parts.items():
            if not part.is_publisher:
                found[name].sort(
                    key=lambda player: (*self._rank(player)[:4], (player.number, player.node) in busy)
                )
            if part.commands:
                found[name] = without_deaf(found[name])
        return found

    def _read_in(self, number: int, run: Run) -> Iterator[Player]:
        """Yield the players that the code of a program tells, if it ended before it could be seen.

        It ended for lack of something that is not there, or without an error because nothing in it goes on.
        """
        name = run.programs[0] if run.setting == "alone" else ""
        program, said = self.executables.get(name), run.ended.get(name)
        if program is None or said is None:
            return
        is_done = program.is_brief and "Traceback (most recent call last)" not in said
        lacks = program.absent or lacked(said, program, self.evidence.files)
        if not is_done and not (is_for_want(said) and lacks):
            return
        for end in self.evidence.files.ends:
            is_seen = end.topic in (run.publishes if end.is_publisher else run.subscribes)
            for part in self.assignment.parts.values():
                is_like = part.end != "service" and part.is_publisher is end.is_publisher
                # An end that is made but not used does not count.
                is_used = end.does is None or not {PUBLISHES, READS}.isdisjoint(end.does)
                if not is_seen and is_like and is_used and end.module in ("", program.stem or name):
                    match = self._match(part, end.topic, [end.type_name], run, node="", program=name)
                    if match:
                        types = (end.type_name,)
                        yield Player(part, match, end.topic, name, types, number, run, name, is_read=True)

    def started(self, run: Run) -> set[str]:
        """Return the parts that some node may play in a run, even if it does not count."""
        return {name for name, players in self._found.items() if any(player.run is run for player in players)}

    def _is_backed(self, player: Player) -> bool:
        """Return whether a player can be one of the executables.

        A launch file may remap topics and set parameters; but then an executable also does the part without
        it, on whatever topic, or at least has its publisher, or ends with an error.
        """
        alone = [run for run in self.evidence.runs if run.setting != "launched"]
        return (
            player.run.setting != "launched"
            or any(player.node in run.publishes.get(player.topic, ()) for run in alone)
            or any(is_done(player.part, run, player.types) for run in alone)
            or any(
                "Traceback (most recent call last)" in said for run in alone for said in run.ended.values()
            )
        )

    def topics_besides(self, player: Player) -> list[str]:
        """Return the other topics on which a node might play the same part, which were not judged."""
        found = self._found[player.part.name]
        own = {seen.topic for seen in found if (seen.number, seen.node) == (player.number, player.node)}
        return sorted(own - {player.topic})

    def lost(self, found: Mapping[str, list[Player]]) -> set[str]:
        """Return the programs that cannot be started, or that ended by themselves and played no part."""
        playing = [player.run for players in found.values() for player in players]
        crashed = {
            name
            for run in self.evidence.runs
            if run.setting == "alone" and not any(played is run for played in playing)
            for name in run.ended
        }
        return crashed | {name for name, executable in self.executables.items() if not executable.command}

    def written(self, part: Part) -> WrittenEnd | None:
        """Return the end that the code makes for a part of which no node was seen; None if there is none.

        It has the right topic or a similar one, or the type that no other part has.
        """
        files = self.evidence.files
        ends = [end for end in files.ends_meant or files.ends if end.is_publisher is part.is_publisher]
        right = [end for end in ends if end.topic == part.topic]
        near = [end for end in ends if is_near_topic(end.topic, part.topic)]
        alike = [end for end in ends if end.type_name == part.type_name and self.assignment.is_only(part)]
        return next(iter((*right, *near, *alike)), None)

    @cached_property
    def way(self) -> Way:
        """By part, its players in the best way of starting; parts of different ways are not combined."""
        return best_way(self._everybody, self.shut_out)

    def counts(self, player: Player) -> bool:
        """Return whether a player was not launched, or belongs to the best way of starting."""
        return player.run.setting != "launched" or player in self.way.get(player.part.name, ())

    def at_once(self, part: Part) -> Player | None:
        """Return a part's most telling player in the best way of starting, else in any; None without one."""
        players = self.way.get(part.name) or self.players[part.name]
        return next(iter(players), None)

    def is_apart(self, part: Part) -> bool:
        """Return whether a part is played, but not in the best way of starting."""
        return bool(self.players[part.name]) and part.name not in self.way

    def main(self, part: Part) -> Player | None:
        """Return a part's most telling player whose topic is as right as in the best way of starting."""
        best = self.at_once(part)
        players = (player for player in self.players[part.name] if best and player.match == best.match)
        return next(filter(self.counts, players), best)

    def whole(self, part: Part) -> Player | None:
        """Return a part's player in the run with all commands, if it works there; else the most telling.

        A player whose topic fits less is another node, such as one whose messages the right node passes on.
        """
        main = self.main(part)
        alone = (
            player
            for player in self.players[part.name]
            if main and player.match == main.match and player.run.setting == "alone" and player.is_heard
        )
        return next(alone, main)

    @cached_property
    def doubled(self) -> frozenset[str]:
        """The parts that share their node with an earlier part; a service may share any node."""
        names = [
            name
            for name, part in self.assignment.parts.items()
            if part.end != "service" and any(not player.is_guessed for player in self.players[name])
        ]
        targets = {name: executable.target for name, executable in self.executables.items()}
        return doubled({name: self._equals(name) for name in names}, targets)

    def _equals(self, name: str) -> list[Node]:
        """Return the nodes that play a part best, by program and name; twins also differ by their part."""
        players = self.players[name]
        players = [player for player in players if player.match == players[0].match]
        players = [player for player in players if player.run.setting == "alone"] or players
        nodes = (
            (player.program, player.node, name if player.node in player.run.twins else "")
            for player in players
        )
        return [*dict.fromkeys(nodes)][:MOST_PLAYERS]

    def is_installed(self, player: Player) -> bool:
        """Return whether `ros2 run` or `ros2 launch` starts a player."""
        return player.run.setting == "launched" or self.is_installed_program(player.program)

    def is_installed_program(self, name: str) -> bool:
        """Return whether `ros2 run` starts a program."""
        program = self.executables.get(name)
        return program is not None and program.way == "installed" and not program.fault

    def _is_beside(self, player: Player) -> bool:
        """Return whether a player's program lies in another package than the graded one."""
        program = self.executables.get(player.program)
        return program is not None and bool(program.package)

    def _rank(self, player: Player) -> tuple[object, ...]:
        return (
            player.is_idle,
            MATCHES.index(player.match),
            player.part.type_name not in player.types,
            not player.is_heard,
            bool(player.part.period) and not player.comes_by_itself,
            not self.is_installed(player),
            self._is_beside(player),
            PLAIN_SETTINGS.index(player.run.setting),
            player.number,
            player.topic,
            player.node,
        )

    def _players_in(
        self,
        number: int,
        run: Run,
        owners: Mapping[str, str],
        *,
        by_type: Part | None = None,
        taken: Collection[tuple[str, str]] = (),
    ) -> Iterator[Player]:
        """Yield the players in a run; for the part `by_type` also those that only their type tells.

        Args:
            number: the run's number.
            run: the run.
            owners: by node, the program that has it.
            by_type: the part of which nobody has the topic; None if there is none.
            taken: the parts of which a node has the right type, each with the topic.
        """
        seen = (
            ("publisher", run.publishes),
            ("subscription", run.subscribes),
            ("service", run.services),
        )
        for end, ends in seen:
            parts = [part for part in self.assignment.parts.values() if part.end == end]
            for topic, nodes in ends.items():
                for node, types in nodes.items():
                    program = run.programs[0] if len(run.programs) == 1 else owners.get(node, "")
                    like = with_like_types(types, topic, self.evidence.files.ends, self.assignment)
                    for part in parts:
                        match = self._match(part, topic, like, run, node=node, program=program)
                        guess = (
                            match_by_type(self.assignment, part, topic, like, taken)
                            if part is by_type
                            else None
                        )
                        if guess:
                            match = (
                                guess
                                if is_alike(self.evidence, self.assignment, Candidate(part, topic, node, run))
                                else None
                            )
                        if match:
                            yield Player(part, match, topic, node, tuple(types), number, run, program)

    def _match(
        self, part: Part, topic: str, types: list[str], run: Run, *, node: str, program: str
    ) -> Match | None:
        if topic in self.assignment.topics:  # another part's topic is no misspelling
            return "right" if topic == part.topic else None
        if is_near_topic(topic, part.topic):
            return "near"
        if any(is_near_topic(topic, wanted) for wanted in self.assignment.topics):
            return None
        subject = part.topic.rpartition("/")[2]
        if self.assignment.is_only(part):
            is_other = bool({part.type_name, stamped(part.type_name)} & {*types})
        elif part.type_name not in types or not part.is_meant(f"{topic} {node} {program}"):
            is_other = False
        elif part.is_publisher:
            # Another part's node publishes its own messages, unless the topic is named for this part.
            heard = run.quiet.get(topic)
            is_its_own = subject in topic or not is_busy(self.assignment, part, node, run)
            is_other = is_its_own and heard is not None and heard.count > 1
        else:
            # Any node may receive texts: its topic, its name or its code must tell what they are about.
            is_about = (
                part.is_meant(topic)
                or subject in f"{node} {program}"
                or is_alike(self.evidence, self.assignment, Candidate(part, topic, node, run))
            )
            is_told = any(topic in other_run.publishes for other_run in self.evidence.runs)
            is_other = is_about and (part.is_meant(topic) or not is_told)
        return "other" if is_other else None
