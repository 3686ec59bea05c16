"""Corrects commands: compares each word with what the workspace and ROS have in its place."""

from __future__ import annotations

import itertools
import re
import shlex
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from ros2lab.diagnose.explaining.shell_assignments import without_blanks
from ros2lab.diagnose.explaining.typed_message import as_message, misfit, read_as
from ros2lab.diagnose.explaining.usage import accepted_form, of_colcon, plain_words
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.error_text import ErrorText
from ros2lab.diagnose.printed.names_there import all_service_ends, declared_parameters, node_names, topic_ends
from ros2lab.diagnose.printed.transcript import words_in
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.python_source import read_text
from ros2lab.diagnose.sources.spelling import nearest
from ros2lab.diagnose.sources.static_value import UNKNOWN

# What the words after each verb of ros2 are; further words are not checked.
_PLACES = {
    "run": ("package", "executable"),
    "launch": ("package", "launch file"),
    "topic pub": ("topic", "type", "message"),
    **{f"topic {verb}": ("topic",) for verb in ("echo", "hz", "info", "bw", "delay", "type")},
    "node info": ("node",),
    "param get": ("node", "parameter"),
    "param set": ("node", "parameter", "value"),
    "param describe": ("node", "parameter"),
    "param list": ("node",),
    "service call": ("service", "service type", "message"),
    "service type": ("service",),
    "interface show": ("type",),
    "pkg prefix": ("package",),
    "pkg executables": ("package",),
}
_MAY_LACK = frozenset(("param list", "pkg executables"))
_LEVELS = ("debug", "info", "warn", "error", "fatal")
# The values that ROS's own variables may have: a pattern, a description and an example.
_VARIABLES = {
    "ROS_DOMAIN_ID": (r"\d{1,2}|10[01]", "a whole number from 0 to 101", "7"),
    "ROS_AUTOMATIC_DISCOVERY_RANGE": (
        r"SUBNET|LOCALHOST|OFF|SYSTEM_DEFAULT",
        "SUBNET, LOCALHOST or OFF",
        "LOCALHOST",
    ),
    "ROS_LOCALHOST_ONLY": (r"[01]", "0 or 1", "1"),
    "RCUTILS_COLORIZED_OUTPUT": (r"[01]", "0 or 1", "1"),
    "RMW_IMPLEMENTATION": (r"rmw_\w+_cpp", "the name of a middleware that is installed", "rmw_fastrtps_cpp"),
}
REFUSED = re.compile(r"^(?:usage: )?ros2[ \w]*: error: ", re.M)
_MOST_CORRECTIONS = 4  # words of a command that are corrected
# A rule as it is typed after an option, with whatever stands between its two texts.
_SECOND = r"(?!-[-A-Za-z])[^\s:=&|;<>]\S*"
_RULE = re.compile(
    r" (?P<option>-p|--param|-r|--remap) +(?P<name>[\w/~][^\s:='\"]*(?::[^\s:='\"]+(?=\s*:=))?)"
    rf"(?P<sign>[\s:=]*(?={_SECOND})|[:=]*)(?P<value>{_SECOND})?"
)
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?")
_VALUE = r"'[^']*'|\"[^\"]*\"|(?!\S*:=)(?!-[a-z-])[^\s'\"]\S*"  # of a launch argument


@dataclass(frozen=True)
class Corrected:
    """A corrected command, and a sentence that says what was wrong with it."""

    line: str
    why: str


def corrected(line: str, look: Look, said: str = "") -> Corrected | None:
    """Correct the first wrong word of a command; None if no word is known to be wrong."""
    if spaced := without_blanks(line):
        return Corrected(*spaced)
    words = words_in(line.rstrip("& "))
    match words:
        case ["colcon", "build" | "test", *_]:
            better = of_colcon(line, words, look, said)
            return Corrected(*better) if better else None
        case ["export", setting, *_]:
            return _of_variable(setting)
        case ["ros2", "pkg", "create", *rest] if "already exists" in said and (
            own := {p.name for p in look.packages}.intersection(rest)
        ):
            name = own.pop()
            why = f"There is already a package {name}; a new one needs a different name."
            return Corrected(line.replace(name, f"{name}_2"), why)
    verbs = (verb for verb in _PLACES if words[: 1 + len(verb.split())] == ["ros2", *verb.split()])
    verb = next(verbs, "")
    if not verb:
        return None
    rest = words[1 + len(verb.split()) :]
    command = _Command(line, verb, rest, _Known(look, rest))
    return next(command.faults(), None)


def as_meant(line: str, error: ErrorText, look: Look) -> Corrected | None:
    """Return a command with all wrong words corrected, and the first fault; None if no fault is known."""
    meant = None
    for _ in range(_MOST_CORRECTIONS):
        # Errors of the parser come first: words are looked up only in a command that it accepts.
        form = accepted_form(line) if REFUSED.search(error.text) or meant else None
        better = Corrected(*form) if form else corrected(line, look, error.text)
        if better is None or better.line == line:
            break
        line = better.line
        meant = replace(better, why=meant.why if meant else better.why)
    return meant


def _of_variable(setting: str) -> Corrected | None:
    """Correct the value of one of ROS's variables; None if it is valid or the variable is not known."""
    name, sign, value = setting.partition("=")
    pattern, allowed, right = _VARIABLES.get(name, ("", "", ""))
    if not pattern or not sign or re.fullmatch(pattern, value):
        return None
    return Corrected(
        f"export {name}={right}",
        f"The variable {name} must be {allowed}, but is set to {value!r}; check ~/.bashrc too.",
    )


class _Known:
    """The names that exist for each place in a command."""

    def __init__(self, look: Look, rest: list[str]) -> None:
        self.look, self.first = look, rest[0] if rest else ""
        self.types = {end.topic: end.type for end in topic_ends(look)}
        self.parameters = declared_parameters(look)

    def is_foreign(self, place: str, word: str) -> bool:
        """Return whether a word may mean something that is not in the workspace."""
        if place == "package":
            return interfaces.folder_of(word) is not None or word in interfaces.PACKAGES
        return place in ("executable", "launch file") and self.first not in self.at("package")

    def at(self, place: str) -> list[str]:
        """Return the names that exist for a place, such as "topic"."""
        return self._names.get(place, [])

    @cached_property
    def _names(self) -> dict[str, list[str]]:
        look, package = self.look, self.look.package(self.first)
        servers = [end.name for end in all_service_ends(look) if end.is_server and not end.is_action]
        return {
            "package": [package.name for package in look.packages],
            "executable": [*(look.executables.get(self.first) or ())],
            "launch file": [path.name for path in package.launch_files] if package else [],
            "topic": [f"/{topic}" for topic in self.types if not topic.startswith("~")],
            "node": node_names(look),
            "parameter": [*self.parameters],
            "service": [f"/{name}" for name in servers if name],
        }


class _Command:
    def __init__(self, line: str, verb: str, rest: list[str], known: _Known) -> None:
        self.line, self.verb, self.rest, self.known = line, verb, rest, known
        self.plain = plain_words(["ros2", *verb.split(), *rest], len(verb.split()))

    def faults(self) -> Iterator[Corrected]:
        """Yield the command with one fault corrected at a time."""
        places = _PLACES[self.verb]
        yield from self._shifted(places)
        for number, place in enumerate(places):
            if number >= len(self.plain):
                yield from self._missing(place)
                return
            yield from self._word(place, self.plain[number])
        if self.verb == "launch":
            yield from self._launch_arguments(self.plain[2:])
        yield from self._options()

    def _with(self, old: str, new: str) -> str:
        for text in (f"'{old}'", f'"{old}"', old):
            # Only a whole word: it may be the beginning of another one.
            if match := re.search(rf" {re.escape(text)}(?![\w/.-])", self.line):
                return f"{self.line[: match.start()]} {in_shell(new)}{self.line[match.end() :]}"
        return self.line

    def _shifted(self, places: tuple[str, ...]) -> Iterator[Corrected]:
        """Yield corrections if the package name is missing, which launch allows for a path, or misplaced."""
        is_two = places in (_PLACES["run"], _PLACES["launch"])
        if not is_two or not self.plain or self.plain[0] in self.known.at("package"):
            return
        first, *others = self.plain
        look = self.known.look
        for package in look.packages:
            names = set(look.executables.get(package.name) or ())
            if self.verb == "launch":
                names = {path.name for path in package.launch_files}
            if others and others[0] == package.name and (right := _meant(first, [*names])):
                why = f"The two names are swapped: after `ros2 {self.verb}` the package comes first, then {right}."
                yield Corrected(self.line.replace(f" {first} {others[0]}", f" {others[0]} {right}", 1), why)
            elif (
                others
                and others[0] in names
                and (first in names or first in (look.executables.get(package.name) or ()))
            ):
                why = f"{first} is not a package: after `ros2 {self.verb}` the package name comes first."
                yield Corrected(self.line.replace(f" {first}", f" {package.name}", 1), why)
            elif first in names and not (look.root / first).exists():
                why = f"`ros2 {self.verb}` needs two names: the package's, then {first}."
                yield Corrected(self.line.replace(f" {first}", f" {package.name} {first}", 1), why)

    def _missing(self, place: str) -> Iterator[Corrected]:
        names = self.known.at(place)
        if names and self.verb not in _MAY_LACK:
            what = {"launch file": "the launch file's name"}.get(place, f"the {place}'s name")
            why = f"`ros2 {self.verb}` is incomplete: {what} must follow; available: {', '.join(sorted(names))}."
            yield Corrected(f"{self.line.rstrip('& ')} {sorted(names)[0]}", why)

    def _word(self, place: str, word: str) -> Iterator[Corrected]:
        if place == "message":
            yield from self._message(word)
        elif place == "value":
            yield from self._value(self.plain[1], word)
        elif place == "executable" and word in self.known.at("launch file"):
            why = f"{word} is a launch file, not an executable: start it with ros2 launch."
            yield Corrected(self.line.replace("ros2 run", "ros2 launch", 1), why)
        elif place in ("type", "service type"):
            yield from self._type(word)
        elif place in ("node", "topic", "service") and f"/{word.lstrip('/')}" in self.known.at(place):
            return
        elif (names := self.known.at(place)) and word not in names and not self.known.is_foreign(place, word):
            near = _meant(word, self._with_the_program(names) if place == "package" else names)
            # Only a launch file knows the namespace of a topic or a service.
            is_named = place in ("topic", "service")
            if near and not (is_named and f"/{word}".endswith(f"/{near.lstrip('/')}")):
                why = f"There is no {place} {word}; there is {near}."
                yield Corrected(self._with(word, near), why)

    def _with_the_program(self, packages: list[str]) -> list[str]:
        """Return the packages that may have the executable or the launch file that is named after the package."""
        if self.verb not in ("run", "launch") or len(self.plain) < 2:
            return packages
        others = (_Known(self.known.look, [name]) for name in packages)
        place = _PLACES[self.verb][1]
        return [other.first for other in others if _meant(self.plain[1], other.at(place))]

    def _type(self, word: str) -> Iterator[Corrected]:
        right_verb = {"srv": "service call", "msg": "topic pub"}.get(word.partition("/")[2].partition("/")[0])
        if right_verb and self.verb in ("service call", "topic pub") and self.verb != right_verb:
            what = f"the type of a {right_verb.partition(' ')[0]}"
            plain = [in_shell(plain_word) for plain_word in self.plain]
            yield Corrected(f"ros2 {right_verb} {' '.join(plain)}", f"{word} is {what}: ros2 {right_verb}.")
            return
        right = self.known.types.get(self.plain[0].lstrip("/")) if self.verb == "topic pub" else None
        short = word.rpartition("/")[2]
        homes = [home for home in interfaces.homes_of(short) if home.endswith((".msg", ".srv"))]
        full = right.replace(".", "/") if right else f"{homes[0].replace('.', '/')}/{short}" if homes else ""
        is_short = re.fullmatch(r"\w+/\w+", word) and self.verb.startswith("topic")
        is_whole = re.fullmatch(r"\w+/(?:msg|srv|action)/\w+", word) or is_short
        if not full and (near := _alike_type(word)):
            yield Corrected(self._with(word, near), f"The type {word} must be written {near}.")
            return
        same = (word, word.replace("/", "/msg/")) if is_short else (word,)
        if full and full not in same and (right or not is_whole):
            yield Corrected(self._with(word, full), f"The type must include its package: {full}.")

    def _message(self, word: str) -> Iterator[Corrected]:
        """Yield a correction if a message is not a YAML dictionary with the fields of its type."""
        package, _, name = self.plain[1].partition("/")
        kind, part = ("srv", "_Request") if self.verb == "service call" else ("msg", "")
        fields = interfaces.fields_of(f"{package}.{kind}.{name.removeprefix(f'{kind}/')}{part}")
        if not fields:
            return
        text = as_message(word, fields)
        if text != word:
            blank = re.search(r"\w+:(?=[^\s/:])", word)
            why = f"The message must be a YAML dictionary with the fields of {self.plain[1]}: {', '.join(fields)}."
            if blank:
                why = f"The space after the colon of {blank[0]!r} is missing, so YAML reads it as one word."
            elif taken := read_as(word, fields):
                why = f"YAML reads {taken[0]} as {taken[1]!r}, not as a string: a string that could be read as something else needs quotes."
            else:
                why = misfit(word, fields) or why
            yield Corrected(self._with(word, text), why)

    def _value(self, name: str, word: str) -> Iterator[Corrected]:
        default = self.known.parameters.get(name, UNKNOWN)
        if isinstance(default, bool):
            right = word.lower() if word.lower() in ("true", "false") else str(default).lower()
        elif isinstance(default, float):
            number = word.replace(",", ".")
            right = (
                (number if "." in number else f"{number}.0") if _NUMBER.fullmatch(number) else str(default)
            )
        elif isinstance(default, int):
            right = word.partition(".")[0] if _NUMBER.fullmatch(word) else str(default)
        else:
            return
        if right != word:
            kind = {"bool": "true or false", "float": "a number with a decimal point"}.get(
                type(default).__name__, "an integer"
            )
            yield Corrected(
                self._with(word, right),
                f"The parameter {name} is {kind}, so {right} is accepted, and {word} is not.",
            )

    def _launch_arguments(self, words: list[str]) -> Iterator[Corrected]:
        declared = self._declared()
        start = self.line.find(f" {self.plain[1]}") + 1
        for name in declared or ():
            written = re.compile(rf" -{{0,2}}{re.escape(name)}(?: *(?::=|=:|=|:) *| +)(?P<value>{_VALUE})")
            if (found := written.search(self.line, start)) and found[0] != (
                right := f" {name}:={found['value']}"
            ):
                why = f"A launch argument is written {right.strip()}, not as {found[0].strip()!r}."
                yield Corrected(f"{self.line[: found.start()]}{right}{self.line[found.end() :]}", why)
        for word in words:
            name, sign, value = re.match(r"([\w.]*)\s*(:=|=:|=|:)?(.*)", word).groups()  # type: ignore[union-attr]
            if sign != ":=" and sign:
                why = f"A launch argument is written with :=, not as {word!r}."
                yield Corrected(self._with(word, f"{name}:={value}"), why)
            elif declared is not None and name not in declared:
                short = (known for known in declared if name and name.startswith(known))
                near = nearest(name, declared, 0.6) or next(short, None)
                if not sign and not near and len(declared) == 1:
                    near, value = next(iter(declared)), word
                known = f"it has {', '.join(declared)}" if declared else "it has none"
                why = f"{self.plain[1]} has no argument {name}; {known}."
                better = self._with(word, f"{near}:={value}") if near else self.line.replace(f" {word}", "")
                yield Corrected(better, why)

    def _declared(self) -> Collection[str] | None:
        """Return the arguments that the launch file declares; None if they are not known."""
        look = self.known.look
        for file, path in look.launches:
            if len(self.plain) > 1 and path.name == self.plain[1]:
                text = read_text(path)
                is_whole = path.suffix == ".py" and "IncludeLaunchDescription(" not in text
                read = re.findall(r"DeclareLaunchArgument\(\s*(?:name=)?['\"](\w+)", text)
                return file.arguments if file.arguments is not None else read if is_whole else None
        return None

    def _options(self) -> Iterator[Corrected]:
        yield from self._rules()
        yield from self._without_option()
        for before, word in itertools.pairwise(self.rest):
            if before == "--log-level" and word.rpartition(":=")[2].lower() not in (*_LEVELS, "unset"):
                near = nearest(word.lower(), _LEVELS, 0.6) or "debug"
                why = f"There is no log level {word}; the levels are {', '.join(_LEVELS)}."
                yield Corrected(self._with(word, near), why)
            if before == "--params-file" and not word.startswith(("/", "~")):
                yield from self._file(word)

    def _rules(self) -> Iterator[Corrected]:
        """Yield corrections for rules after --ros-args that lack `:=`, or the value behind it, or have a blank beside it."""
        for match in _RULE.finditer(self.line, self.line.find("--ros-args") % (len(self.line) + 1)):
            option, name, sign, value = match.group("option", "name", "sign", "value")
            if (sign == ":=" and value) or (option in ("-r", "--remap") and not value):
                continue
            default = self.known.parameters.get(name, UNKNOWN)
            right = f"{name}:={value or (default if default is not UNKNOWN else 1.0)}"
            rule = match[0].partition(option)[2].strip()
            lack = "value after `:=`" if sign == ":=" else "`:=` between the two words"
            why = f"The rule {rule!r} after {option} has no {lack}."
            if " " in sign and "".join(sign.split()) == ":=":
                why = f"A rule has no blank before or after `:=`, but {rule!r} has one, so it is read as several words."
            yield Corrected(f"{self.line[: match.start('name')]}{right}{self.line[match.end() :]}", why)

    def _without_option(self) -> Iterator[Corrected]:
        """Yield corrections for settings after --ros-args that lack their option."""
        after = self.rest[self.rest.index("--ros-args") :] if "--ros-args" in self.rest else []
        for before, word in itertools.pairwise(after):
            name, sign, _ = word.partition(":=")
            if sign and (before == "--ros-args" or not before.startswith("-")):
                is_rule = name.startswith(("__", "/")) or name in self.known.types
                option = "-r" if is_rule else "-p"
                why = f"After --ros-args every setting needs its option: {option} before {word}."
                yield Corrected(self.line.replace(f" {word}", f" {option} {word}", 1), why)

    def _file(self, word: str) -> Iterator[Corrected]:
        """Yield a correction if a parameter file is in another folder of the workspace."""
        root = self.known.look.root
        there = [file for package in self.known.look.packages for file in package.parameter_files]
        lies = next((file for file in there if file.name == word.rpartition("/")[2]), None)
        if lies is not None and not (root / word).exists():
            why = f"There is no file {word} in the folder where this was typed."
            yield Corrected(self._with(word, str(lies.relative_to(root))), why)


def _alike_type(word: str) -> str:
    """Return the type that a word means apart from case or its middle part; empty if there is none."""
    package, *middle, name = word.split("/") if "/" in word else ("", "")
    for kind in middle or ("msg", "srv", "action"):
        classes = (known for known in interfaces.names_in(f"{package}.{kind}") or () if known[:1].isupper())
        same = [known for known in classes if known.lower() == name.lower()]
        if same and (same[0] != name or not middle):
            return f"{package}/{kind}/{same[0]}"
    return ""


def in_shell(word: str) -> str:
    """Return a word as it is typed in a shell, in the most readable quotes if it needs any."""
    if re.fullmatch(r"[\w./:=@,+~-]+", word):
        return word
    return f'"{word}"' if "'" in word and not set(word) & set('"$`\\!') else shlex.quote(word)


def _meant(word: str, names: list[str]) -> str | None:
    """Return the name that a word means apart from case, punctuation, endings and typos; None if none is."""
    bare = re.sub(r"\W|_", "", word.removesuffix(".py")).lower()
    same = [
        name for name in names if re.sub(r"\W|_", "", name).lower() == bare or name.partition(".")[0] == word
    ]
    return same[0] if same else nearest(word, names, 0.6)
