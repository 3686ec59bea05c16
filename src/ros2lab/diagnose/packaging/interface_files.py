"""The .msg, .srv and .action files of a package, as the generator of ROS reads them."""

from __future__ import annotations

import contextlib
import importlib
import io
import itertools
import re
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ros2lab.diagnose.finding import Finding, at, in_a_row, line_with
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.python_source import PythonSource, read_text
from ros2lab.diagnose.sources.spelling import nearest, snake_case

_PARTS = {".msg": (), ".srv": ("request", "response"), ".action": ("goal", "result", "feedback")}
_READERS = {".msg": "message", ".srv": "service", ".action": "action"}
_GENERATES = re.compile(r"\brosidl_generate_interfaces\s*\(([^()]*)\)")
# What the generator's messages mean, by words that they contain.
_WHY = {
    "invalid field name": "the name of a field begins with a lower-case letter and has only such letters, digits and single underscores",
    "invalid constant name": "`=` makes it a constant, whose name has only capitals, digits and underscores",
    "invalid message name": "{0} is no type of a field",
    "the size of array type": "the size of a list is a whole number above 0, as in `float64[3]`, or left out, as in `float64[]`",
    "can not be converted": "what comes after `=`, or after the name of a field as its default, is no value of {0}",
    "must be a primitive type": "`=` makes it a constant, and {0} is no type for one",
}
# What to do where no similar line would be taken.
_OTHERWISE = {
    "invalid field name": "give the field another name",
    "invalid constant name": "give the constant another name",
    "can not be converted": "write a value of this type, or change the type",
}


def interface_faults(
    package: SourcePackage, own: Mapping[str, Collection[str]], files: Collection[PythonSource]
) -> Iterator[Finding]:
    """Yield what the generator refuses in the interface files of a package, so that the build stops.

    Args:
        package: the package.
        own: the names of the workspace's interfaces, by their modules, such as `my_robot.srv`.
        files: the Python files of the workspace, which may use a name that has to be changed.
    """
    paths = [path for path in package.own_files() if path.suffix in _PARTS]
    parser = _parser() if paths and package.is_built_by_cmake else None
    if parser:
        every = [_Interface(path, package, own, files, parser) for path in paths]
        refused = [fault for one in every for fault in one.faults()]
        yield from refused or _not_handed_over(package, every, files)


def _parser() -> Any:
    """Return the generator's parser; None if it is not installed."""
    with contextlib.suppress(ImportError):
        return importlib.import_module("rosidl_adapter.parser")
    return None


def _not_handed_over(
    package: SourcePackage, every: Collection[_Interface], files: Collection[PythonSource]
) -> Iterator[Finding]:
    """Yield the interface files that are used and that CMakeLists.txt surely does not hand to the generator.

    So it does with the packages whose messages they have as fields.
    """
    match = _GENERATES.search(re.sub(r"#.*", "", package.cmake))
    if not match or "${" in match[1].replace("${PROJECT_NAME}", "") or "GLOB" in package.cmake:
        return
    place = at(package.shown("CMakeLists.txt"), line_with(package.cmake, "rosidl_generate_interfaces"))
    words = re.findall(r"[^\s\"]+", match[1])
    named = [one for one in every if one.name in words]
    used = {(kind.pkg_name, kind.type): one for one in named for kind in one.fields}
    for one in every:
        add = f'"{one.name}" to rosidl_generate_interfaces(...)'
        if one.path.name in package.cmake:
            continue
        if user := used.get((package.name, one.path.stem)):
            cause = f"{user.name} has a field of the type {one.path.stem}, but CMakeLists.txt does not name {one.name}, so the build stops."
            yield _finding(package, cause, place, f"add {add}")
            continue
        target = f"{package.name}.{one.path.suffix[1:]}.{one.path.stem}"
        found = ((file, used) for file in files for used in file.imports if used.target == target)
        for file, imported in itertools.islice(found, 1):
            cause = f"{imported.local} cannot be imported: CMakeLists.txt of {package.name} does not name {one.name}, so the build makes no code for it."
            fix = f"add {add} in {place}; then build {package.name} again"
            yield Finding("import-wrong", cause, file.at(imported.line), fix, (package.name,))
    # What is named brings along what it depends on, and each service and action a time.
    homes = (home for home, _ in used if home not in (package.name, "builtin_interfaces"))
    for home in dict.fromkeys(homes) if "DEPENDENCIES" not in words else ():
        user = next(one for (name, _), one in used.items() if name == home)
        cause = f"{user.name} has a field of a type of {home}, but rosidl_generate_interfaces(...) in CMakeLists.txt does not name {home}, so the build stops."
        fix = f"write DEPENDENCIES {home} before its last bracket"
        found_it = re.search(rf"find_package\s*\(\s*{home}\b", package.cmake)
        fix += "" if found_it else f", find_package({home} REQUIRED) above it"
        yield _finding(package, cause, place, fix)


def _finding(package: SourcePackage, cause: str, place: str, fix: str) -> Finding:
    return Finding("interface-refused", cause, place, f"{fix}; then build again", (package.name,))


@dataclass(frozen=True)
class _Interface:
    """An interface file, with what it is compared with."""

    path: Path
    package: SourcePackage
    own: Mapping[str, Collection[str]]
    files: Collection[PythonSource]
    parser: Any

    @cached_property
    def shown(self) -> str:
        return self.package.shown(self.name)

    @cached_property
    def name(self) -> str:
        """Its path below the folder of its package, as CMakeLists.txt names it."""
        return self.path.relative_to(self.package.folder).as_posix()

    @property
    def fields(self) -> list[Any]:
        """The types of its fields that are messages; it is one that the generator takes."""
        kinds = [field.type for line in self.lines if line != "---" for field in self._fields(line)]
        return [kind for kind in kinds if kind.pkg_name]

    @cached_property
    def lines(self) -> list[str]:
        return read_text(self.path).splitlines()

    def faults(self) -> Iterator[Finding]:
        """Yield what is refused, each line by itself first."""
        parts = _PARTS[self.path.suffix]
        breaks = [number for number, line in enumerate(self.lines) if line == "---"]
        lines = [(n, line) for n, line in enumerate(self.lines, 1) if not (parts and line == "---")]
        if parts and len(breaks) != len(parts) - 1:
            yield self._divided(len(breaks), parts)
            lines = [(n, line) for n, line in lines if not _is_break(line)]
        refused = [(n, line, said) for n, line in lines if (said := self._refusal(line))]
        if refused:
            yield from (self._refused(*row) for row in refused)
            return
        yield from (fault for row in lines for fault in self._unknown_type(*row))
        if not parts or len(breaks) == len(parts) - 1:
            yield from self._whole(breaks)

    def _refusal(self, line: str) -> str:
        """Return what the generator says against a line; empty if it takes the line."""
        return self._said("message", "Name", line)

    def _said(self, kind: str, name: str, text: str) -> str:
        read: Callable[..., object] = getattr(self.parser, f"parse_{kind}_string")
        with contextlib.redirect_stderr(io.StringIO()):
            try:
                read(self.package.name, name, text)
            except Exception as error:  # it raises many kinds, among them IndexError
                return str(error) or type(error).__name__
        return ""

    def _refused(self, number: int, line: str, said: str) -> Finding:
        """Return why a line is refused, and a line that would be taken."""
        code = line.partition("#")[0].strip()
        words = code.split()
        why = next((text.format(words[0]) for known, text in _WHY.items() if known in said), "")
        why = why or "it begins with spaces" * line[:1].isspace()
        why = why or "in a .msg, the type of a field is package/Type" * (words[0].count("/") > 1)
        why = "a comment begins with #, not with //" if "//" in code else why
        why = why or ("a field needs a type and a name" if len(words) < 2 else said.replace("\n", " "))
        if _is_break(line):
            why = "--- divides a .srv or an .action, and a message has only one part"
        ways = [way for way in dict.fromkeys(self._meant(code)) if way != line and self._is_taken(way)]
        fix = f"write {' or '.join(f'`{way}`' for way in ways[:2])}" if ways else ""
        if "," in code and "[" not in code:
            fix, ways = "write each field on a line of its own, with its type", []
        fix = fix or _OTHERWISE.get(next((known for known in _OTHERWISE if known in said), ""), "")
        fix = fix or "write a type and a name, such as `float64 speed` or `geometry_msgs/Point place`"
        fix = "remove this line, or make it a .srv in the folder srv" if _is_break(line) else fix
        uses = self._uses(code, ways[0]) if ways else ""
        cause = f"`{code or line.strip()}` is refused when {self.package.name} is built: {why}."
        return _finding(self.package, cause, at(self.shown, number), f"{fix}{uses}")

    def _meant(self, code: str) -> Iterator[str]:
        """Yield lines that a refused one may mean, the likeliest first; some of them are refused as well."""
        if "//" in code:
            yield code.replace("//", "#", 1)
        plain = re.sub(r"\s*//.*|;\s*$", "", code)
        plain = re.sub(r"^(\w+)\s*:\s*(\S+)$", r"\2 \1", plain)  # as Python annotates a name
        plain = re.sub(r"^list\[(\S+)\](?= )", r"\1[]", plain)
        kind, _, rest = plain.partition(" ")
        kind = re.sub(r"^(\w+)(?:/msg/|\.msg\.|\.)(?=[A-Z])", r"\1/", kind)
        name, sign, value = (part.strip() for part in re.match(r"([^=]*)(=?)(.*)", rest).groups())  # type: ignore[union-attr]
        yield plain or "#"
        for alike in self._types(kind):
            if not sign:
                name, _, value = name.partition(" ")
                yield from (f"{alike} {part} {value}".strip() for part in (name, _field_name(name)))
                joined = _field_name(f"{name}_{value}")
                yield f"{alike} {joined}"
                element, bracket, _ = alike.partition("[")
                yield f"{element}{bracket and '[]'} {name}"
            else:
                yield f"{alike} {name.upper()}={value}"
                yield f"{alike} {_field_name(name)} {value}"
        if rest in self.parser.PRIMITIVE_TYPES:  # the name comes first
            yield f"{rest} {_field_name(kind)}"

    def _types(self, kind: str) -> list[str]:
        """Return the types that a word may mean, itself first if it is one."""
        word, bracket, size = kind.partition("[")
        package, slash, last = word.rpartition("/")
        primitive = [name for name in self.parser.PRIMITIVE_TYPES if name not in ("duration", "time")]
        if word in primitive:
            return [kind]
        of_idl = importlib.import_module("rosidl_adapter.msg").MSG_TYPE_TO_IDL
        found = [
            name for name in primitive if of_idl.get(name) == word.lower() and name not in ("byte", "char")
        ]
        begun = [name for name in primitive if name.startswith(word.lower()) or word.lower().startswith(name)]
        there = self.own.get(f"{self.package.name}.msg", ())
        found += ["int32"] if "int32" in begun else begun[:1]
        if slash:
            found = [f"{package}/{name}" for name in [nearest(last, self._in_package(package) or ())] if name]
            package = interfaces.meant(package) or nearest(package, self._packages) or ""
            found += [f"{package}/{last}"] if last in (self._in_package(package) or ()) else []
        else:
            found += [name for name in [nearest(word, [*there, *primitive])] if name]
            capital = f"{word[:1].upper()}{word[1:]}"
            found += [capital] if capital in there else []
            homes = (home for home in interfaces.homes_of(capital) if home.endswith(".msg"))
            found += [f"{home.removesuffix('.msg')}/{capital}" for home in homes]
        return [f"{name}{bracket}{size}" for name in dict.fromkeys([word, *found])]

    @property
    def _packages(self) -> list[str]:
        return [home.removesuffix(".msg") for home in self.own if home.endswith(".msg")]

    def _is_taken(self, line: str) -> bool:
        return not self._refusal(line) and self._lost(line) is None

    def _fields(self, text: str) -> list[Any]:
        with contextlib.redirect_stderr(io.StringIO()):
            return [*self.parser.parse_message_string(self.package.name, "Name", text).fields]

    def _in_package(self, name: str) -> Collection[str] | None:
        """Return the messages of a package; None if they are not known."""
        if (own := self.own.get(f"{name}.msg")) is not None or name == self.package.name:
            return own or ()
        if self.own.keys() & {f"{name}.srv", f"{name}.action"}:
            return ()
        return interfaces.names_in(f"{name}.msg")

    def _lost(self, line: str) -> Any:
        """Return the type of a line's field if its package surely has no such message; else None."""
        kinds = [field.type for field in self._fields(line) if field.type.pkg_name]
        for kind in kinds:
            there = self._in_package(kind.pkg_name)
            if there is not None and kind.type not in there:
                return kind
            if there is None and interfaces.meant(kind.pkg_name):
                return kind
        return None

    def _unknown_type(self, number: int, line: str) -> Iterator[Finding]:
        """Yield a field whose type is that of no message, which the generator looks for in vain."""
        if (kind := self._lost(line)) is None:
            return
        written, *rest = line.partition("#")[0].split()
        ways = [alike for alike in self._types(written) if alike != written]
        ways = [alike for alike in ways if self._is_taken(f"{alike} {' '.join(rest)}")]
        bare = kind.pkg_name == self.package.name and "/" not in written
        where = "ROS nor this package" if bare else f"the package {kind.pkg_name}"
        cause = f"`{written}` is not known when {self.package.name} is built: {'neither ' if bare else ''}{where} has {'a type' if bare else 'no message'} {kind.type}."
        fix = f"write {' or '.join(ways[:3])} instead of {written}" if ways else "write a type that exists"
        fix = (
            fix
            if ways or not bare
            else f"{fix}, or create msg/{kind.type}.msg, and name it in CMakeLists.txt"
        )
        yield _finding(self.package, cause, at(self.shown, number), fix)

    def _divided(self, there: int, parts: tuple[str, ...]) -> Finding:
        """Return that a file has too few or too many lines that divide it."""
        wanted, ending = len(parts) - 1, self.path.suffix
        wrong = next((n for n, line in enumerate(self.lines, 1) if _is_break(line) and line != "---"), None)
        lines = "a line" if wanted == 1 else "two lines"
        cause = f"A {ending} file has {in_a_row(parts)}, in this order, with {lines} of exactly --- between them; {self.path.name} has {there or 'no'} such line{'s' * (there > 1)}, so {self.package.name} is not built."
        fix = f"write {'---' if wanted == 1 else '--- twice'} alone on a line, between {in_a_row(parts)}, even where one of them is empty"
        if there > wanted:
            fix = (
                f"remove the --- that {'is' if there - wanted == 1 else 'are'} not between {in_a_row(parts)}"
            )
            wrong = [n for n, line in enumerate(self.lines, 1) if line == "---"][wanted]
        elif wrong:
            fix = "write exactly --- there, with no other sign and no space on the line"
        return _finding(self.package, cause, at(self.shown, wrong), fix)

    def _whole(self, breaks: Collection[int]) -> Iterator[Finding]:
        """Yield what is refused of a file whose lines are right: its own name, or a name that it has twice."""
        said = self._said(_READERS[self.path.suffix], self.path.stem, "\n".join(self.lines))
        place, stem = self.shown, self.path.stem
        if not said:
            return
        cause = f"{self.path.name} is refused when {self.package.name} is built: {said}."
        fix = "change it as it says"
        if "invalid message name" in said:
            new = "".join(f"{word[:1].upper()}{word[1:]}" for word in re.split(r"[^A-Za-z0-9]+", stem))
            cause = f"The file {self.path.name} has the name of no type: that begins with a capital and has only letters and digits, so {self.package.name} is not built."
            path = self.path.relative_to(self.package.folder).with_name(f"{new}{self.path.suffix}").as_posix()
            fix = f"mv {self.shown} {self.package.shown(path)}, and write {path} in CMakeLists.txt"
            fix += self._uses(f"- {stem}", f"- {new}")
        elif twice := re.search(r"duplicate names: (\w+)", said):
            numbers = [n for n, line in enumerate(self.lines, 1) if re.match(rf"\S+\s+{twice[1]}\b", line)]
            cause = f"{self.path.name} has two fields called {twice[1]}, so {self.package.name} is not built."
            edges = [0, *breaks, len(self.lines)]
            pairs = [
                (a, b)
                for a, b in itertools.pairwise(numbers)
                if any(x < a and b <= y for x, y in itertools.pairwise(edges))
            ]
            place, fix = (
                at(place, pairs[0][1] if pairs else None),
                "give this one another name, or remove it",
            )
        yield _finding(self.package, cause, place, fix)

    def _uses(self, old: str, new: str) -> str:
        """Say where Python files use the name that a changed line had; empty if none does."""
        before, after = (
            line.split()[1].partition("=")[0] if len(line.split()) > 1 else "" for line in (old, new)
        )
        if not before:
            return ""
        used = re.compile(rf"(?<!\w){re.escape(before)}(?!\w)")
        users = [file for file in self.files if f"{self.package.name}." in file.text]
        places = [
            f"{file.shown}:{number}"
            for file in users
            for number, line in enumerate(file.text.splitlines(), 1)
            if used.search(line)
        ]
        return f", and {after} in {in_a_row(places[:3])}, too" if places and before != after else ""


def _is_break(line: str) -> bool:
    """Return whether a line has nothing but dashes, as between the parts of a service."""
    return bool(re.fullmatch(r"\s*[-\u2013\u2014]{2,}\s*|\s*\u2014\s*", line))


def _field_name(name: str) -> str:
    """Return a name such as fields have."""
    return re.sub(r"_+", "_", re.sub(r"\W", "_", snake_case(name))).strip("_")
