"""The form of an entry point, and what one that is not of that form was meant to be."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import replace
from shlex import quote

from ros2lab.diagnose.finding import Finding, at
from ros2lab.diagnose.sources.joined_texts import strings
from ros2lab.diagnose.sources.other_names import meant_function
from ros2lab.diagnose.sources.package import SourcePackage
from ros2lab.diagnose.sources.setup_script import EntryPoint
from ros2lab.diagnose.sources.spelling import is_near_miss, nearest


def can_be_named(module: str) -> bool:
    """Return whether an entry point can name a module: not if its file has a hyphen or a space in its name."""
    return re.fullmatch(r"[\w.]+", module) is not None


def wrong_form(package: SourcePackage, point: EntryPoint, place: str) -> Finding:
    """Explain an entry point that is not of the form `name = package.module:function`."""
    if joined := _without_comma(package, point):
        rows = [f"`{written},` on line {number}" for number, written in joined]
        after = " and ".join(f"line {number}" for number, _ in joined)
        cause = f"A comma is missing after the entry point on {after}, so Python joins it with the next one: {point.text!r}."
        shown = package.setup.source.shown if package.setup else ""
        fix = f"write `{joined[0][1]},`" if len(joined) == 1 else f"write {' and '.join(rows)}"
        return Finding("entry-point-comma", cause, at(shown, joined[0][0]), fix)
    # In one string, they are divided by a comma or a space.
    parts = [
        re.sub(r"\s*=\s*", " = ", entry)
        for entry in re.findall(r"(?<![\w-])[\w-]+\s*=\s*[\w.]+:\w+(?=[\s,;]|$)", point.text)
    ]
    if len(parts) > 1:
        cause = f"Two entry points are in one string: {point.text!r}; each needs its own quotes, with a comma between them."
        fix = f"write {', '.join(map(repr, parts))}"
        return Finding("entry-point-comma", cause, place, fix)
    if meant := of_its_parts(package, point):
        return put_in_order(package, point, meant, place)
    cause = f"The entry point {point.text!r} {_why(point.text)}."
    return Finding("entry-point-spec", cause, place, f"write {_in_form(package, point)!r}")


def _in_form(package: SourcePackage, point: EntryPoint) -> str:
    """Return an entry point in the right form, if possible with a module that exists."""
    name, _, rest = point.text.partition("=")
    module = re.sub(r"[^\w.]", "", rest.replace("/", ".").partition(":")[0]).removesuffix(".py")
    if not rest:
        words = re.findall(r"[\w./-]+", point.text)
        paths = [word for word in words if "." in word or "/" in word] or words[1:-1]
        module = paths[0].replace("/", ".").removesuffix(".py") if paths else ""
        name = words[0] if words and words[0] not in paths else module.rpartition(".")[2]
    name = re.sub(r"[^\w.-]+", "_", name.strip())
    module = module or f"{package.name}.{name}"
    if module not in package.sources:
        modules = [other for other in package.sources if other != package.name and can_be_named(other)]
        module = meant_file(package, replace(point, name=name, module=module), modules) or module
    written = point.text.rpartition(":")[2] if ":" in point.text else ""
    return f"{name} = {module}:{meant_function(package, module, written)}"


def meant_file(package: SourcePackage, point: EntryPoint, modules: Sequence[str]) -> str | None:
    """Return the likely module of an entry point; that of another one is likely only for a misspelling."""
    points = package.setup.entry_points if package.setup else None
    taken = {other.module for other in points or () if other.line != point.line}
    free = {name.rpartition(".")[2]: name for name in modules if name not in taken}
    for wanted in (point.module.rpartition(".")[2], point.name):
        if close := wanted if wanted in free else nearest(wanted, free):
            return free[close]
    return next((name for name in modules if name in taken and is_near_miss(point.module, name)), None)


def _without_comma(package: SourcePackage, point: EntryPoint) -> list[tuple[int, str]]:
    """Return what a comma should follow in setup.py, each with its line; empty if none is missing.

    Python joins strings that follow each other: each that begins a new entry point should have been an item.
    """
    setup = package.setup
    if setup is None or point.text.count("=") < 2 or not point.line:
        return []
    texts = strings(setup.source.text)
    lines = setup.source.text.splitlines()
    found = []
    for (line, former, is_next), (_, following, _) in itertools.pairwise(texts):
        begins = re.match(r"\w?['\"]+\s*([\w-]+\s*=)", following)
        is_own = line >= point.line and bool(begins) and begins is not None and begins[1] in point.text
        if is_next and is_own and ":" in former:
            # The end of an expression, such as a sum, is shown with the rest of its line.
            before = lines[line - 1].partition(former)[0].lstrip()
            is_end = before.rstrip().endswith("+")
            found.append((line, before + former if is_end else _corrected(package, former)))
    return found


def _corrected(package: SourcePackage, code: str) -> str:
    """Return the code of a string with an entry point in the right form."""
    text = code.strip("'\"")
    name, _, target = text.partition("=")
    is_right = re.fullmatch(r"\s*[\w-]+\s*", name) and re.fullmatch(r"\s*[\w.{}]+:[\w.{}]+\s*", target)
    if is_right or code[0] not in "'\"" or "\\" in code:
        return code
    point = EntryPoint(text, None)
    return repr(of_its_parts(package, point) or _in_form(package, point))


def _why(text: str, meant: str = "") -> str:
    """Say what is wrong with the form of an entry point, from its signs and, if it is known, the right one."""
    function, target = meant.rpartition(":")[2], text.rpartition("=")[2]
    has_all = bool(meant) and set(re.findall(r"\w+", text)) == set(re.findall(r"\w+", meant))
    ways = (
        ("/" in target, "has a slash where a dot should be"),
        ("(" in target, "has parentheses after the function, but only its name belongs there"),
        ("=" not in text, "has no `=` between the executable and the module"),
        (target.count(":") > 1, "has two colons"),
        (
            bool(function) and text.endswith(f".{function}") and ":" not in text,
            f"has a dot before {function} where a colon should be",
        ),
        (has_all, "has its parts not in the form `name = package.module:function`"),
    )
    other = "is not of the form `name = package.module:function`"
    return next((why for is_so, why in ways if is_so), other)


def put_in_order(package: SourcePackage, point: EntryPoint, meant: str, place: str) -> Finding:
    """Return a finding with an entry point in the right order; a module with a hyphen is renamed first."""
    module = meant.rpartition(" = ")[2].partition(":")[0]
    if "-" not in module:
        cause = f"The entry point {point.text!r} {_why(point.text, meant)}."
        return Finding("entry-point-spec", cause, place, f"write {meant!r}")
    shown = package.sources[module].shown
    folder, _, file = shown.rpartition("/")
    cause = f"{shown} has a hyphen in its name, so Python cannot import it."
    written = meant.replace(module, module.replace("-", "_"))
    moved = f"mv {quote(shown)} {quote(f'{folder}/' + file.replace('-', '_'))}"
    return Finding("entry-point-spec", cause, place, f"{moved}, and write {written!r}")


def of_its_parts(package: SourcePackage, point: EntryPoint) -> str:
    """Return an entry point in the right form if its parts name a module and a function that exist; else empty."""
    name, _, target = point.text.partition("=")
    words = re.findall(r"\w+(?:-\w+)*", re.sub(r"\.py\b", "", target))
    for end in range(len(words), 0, -1) if re.fullmatch(r"\s*[\w-]+\s*", name) else ():
        written = ".".join(words[:end])
        spelt = (written, written.replace("-", "_"), f"{package.name}.{written}")
        for module in spelt:
            if module in package.sources and (function := function_of(package, module, words[end:])):
                return f"{name.strip()} = {module}:{function}"
    is_named = "=" in point.text and re.fullmatch(r"[\w\s-]+", name)
    parts = re.findall(r"[\w.-]+", point.text)
    for part in parts:
        modules = (module for module in (part, f"{package.name}.{part}") if module in package.sources)
        for module in modules:
            functions = package.sources[module].functions
            rest = [word for word in parts if word != part]
            function = next((word for word in rest if word in functions), "")
            names = [word for word in rest if word != function and "." not in word]
            if function and len(names) == 1 and (not is_named or names[0] == name.strip()):
                return f"{names[0]} = {module}:{function}"
    return ""


def function_of(package: SourcePackage, module: str, words: list[str]) -> str:
    """Return the function of a module that the words after it mean; empty if they mean none."""
    functions = package.sources[module].functions
    if not words or len(words) > 1:
        return meant_function(package, module) if not words and functions else ""
    is_class = words[0] in package.sources[module].classes
    if words[0] in functions:
        return words[0]
    return "main" if is_class and "main" in functions else nearest(words[0], functions, 0.6) or ""
