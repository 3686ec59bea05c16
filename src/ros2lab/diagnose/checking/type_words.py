"""The types that the type checker names, in plain words for beginners."""

from __future__ import annotations

import ast
import re

from ros2lab.diagnose.code.bound_names import bound_in
from ros2lab.diagnose.code.unknown_names import written_with
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources.python_source import assigned_to, assignments, own_nodes, walk
from ros2lab.diagnose.sources.signatures import heads_of
from ros2lab.diagnose.sources.spelling import same_letters, with_article
from ros2lab.diagnose.sources.syntax_parts import calls_in

_NODE = "rclpy.node.Node"


def of_class(said: dict[str, str], spot: Spot) -> tuple[str, str, str]:
    """Return cause, place and fix of a class that is used where an instance is needed."""
    assert spot.source is not None
    given = re.sub(r"<class '(.+)'>", r"\1", said.get("given", ""))
    place = spot.source.at(spot.line)
    used = _class_used(given, said["owner"].rpartition(".")[2], spot)
    if used is not None and (made := made_of(used.id, spot)):
        cause = f"{used.id} is the class itself; its instance here is {made}."
        return cause, place, written_with(spot.source, used, made)
    name = given or (used.id if used else "")
    kept = _kept_class(name, spot)
    kind = f"the class {kept}" if kept else "the class"
    cause = f"{name or 'The class'} is {kind} itself, not an instance"
    if lines := [call.lineno for call in spot.file.calls if getattr(call.func, "id", "") == name]:
        fix = f"write the instance that line {lines[0]} makes instead of {name}"
        return f"{cause}; line {lines[0]} makes one.", place, fix
    cause += ": the parentheses after it are missing."
    if kept:
        return cause, place, f"write `{name} = {kept}()` instead of `{name} = {kept}`"
    where = f", as in node = {name}()" if name else ""
    new = f"{name}()" if name else "() after the name of the class"
    return cause, place, f"write {new} where the instance is made{where}"


def _class_used(name: str, method: str, spot: Spot) -> ast.Name | None:
    """Return where a line uses a class; if its name is not known, that of which it calls a method."""
    calls = calls_in(spot.nodes)
    owners = [
        call.func.value for call in calls if isinstance(call.func, ast.Attribute) and call.func.attr == method
    ]
    called = {id(call.func) for call in calls}
    names = [n for n in spot.nodes if isinstance(n, ast.Name) and n.id == name and id(n) not in called]
    found = names if name else [owner for owner in owners if isinstance(owner, ast.Name)]
    return found[0] if len(found) == 1 else None


def _kept_class(name: str, spot: Spot) -> str:
    """Return the class of the file that a variable is given; empty if there is none."""
    scope = spot.function or spot.file.tree
    kept = {getattr(value, "id", "") for value in assigned_to(own_nodes(scope), name)}
    return kept.pop() if len(kept) == 1 and kept <= {*spot.file.classes} else ""


def made_of(name: str, spot: Spot) -> str:
    """Return what holds an instance of a class, a variable or an attribute of self, or has its name in small letters."""
    source, scope = spot.file, spot.function or spot.file.tree
    alike = [known for known in sorted(bound_in(scope)) if known != name and same_letters(known, name)]
    nodes = {
        name for name, n in source.classes.items() if any(source.resolve(base) == _NODE for base in n.bases)
    }
    around = source.class_at(spot.line) if spot.function else None
    for place, prefix in ((scope, ""), (around, "self."), (source.tree, "")):
        for target, value in assignments(walk(place) if prefix else own_nodes(place)) if place else ():
            made, called = ast.unparse(target), getattr(getattr(value, "func", None), "id", "")
            is_held = made.startswith(prefix) if prefix else isinstance(target, ast.Name)
            if is_held and (called == name or (source.names.get(name) == _NODE and called in nodes)):
                return made
    return alike[0] if alike else ""


def types_named(said: str, message: str) -> int:
    """Return how many of the expected and actual types of an argument an error message names."""
    types = re.search(r"Expected `(.+)`, found `(.+)`", said)
    heads = heads_of(types[1]) | heads_of(types[2]) if types else set()
    return len(heads.intersection(re.findall(r"\w+", message)))


def not_taken(function: str, value: str, wanted: str, given: str) -> tuple[str, str]:
    """Return cause and fix of an argument of the wrong type; its value is empty if that is not known."""
    takes, is_given = plain(wanted), plain(given)
    is_list = is_given.startswith("a list") and takes.startswith("a list")
    if is_list or is_given in takes.split(" or "):  # the same words say nothing
        called, has = (re.search(r"\(([^()]*)\) ->", kind) for kind in (wanted, given))
        if called is None or has is None:
            return f"{function} takes `{wanted}` here, but is given `{given}`.", f"give it `{wanted}`"
        number, own = _counted(called[1]), _counted(has[1])
        values = f"{number} value{'s' * (number != 1)}"
        called_as = f"`{value}`" if value else "the function"
        fix = f"let {called_as} take {values} (self is not counted)"
        return f"{function} calls {called_as} with {values}, but it takes {own}.", fix
    is_given = "a string" if is_given.startswith("the string ") else is_given.partition("[")[0]
    takes, is_given = map(_with_article, (takes, is_given))
    named = f"is given {is_given}" if value in ("", is_given) else f"`{value}` is {is_given}"
    return f"{function} takes {takes} here, but {named}.", f"give it {takes}"


def _with_article(words: str) -> str:
    """Return types in words, with an article before each class."""
    alone = r"(?:^|(?<= or ))(?!None\b|True\b|False\b)\w+(?= or |$)"
    return re.sub(alone, lambda match: with_article(match[0]), words)


def _counted(names: str) -> int:
    """Count the parameters, without self, in the list that the type checker writes between parentheses."""
    return sum(name.strip() not in ("", "/", "*", "self") for name in names.split(","))


def plain(kind: str) -> str:  # noqa: PLR0911 -- a table
    """Return a type in plain words."""
    if text := re.fullmatch(r"Literal\[([\"'])(.*)\1\]", kind):
        return f"the string {text[2]!r}"
    kind = re.sub(r"\b(\w+)@\w+", r"\1", re.sub(r"^Self@\w+", "self", kind))  # a type variable
    kind = kind.replace("SupportsIndex | float*", "float").removesuffix("*")
    kind = re.sub(r"\[(?:Unknown|Any)[^\]]*\]", "", kind)
    if re.match(r"(?:Iterable|list|Sequence)\[.*\[", kind):
        return "a list of pairs, as in [('a', 'b')]" if "[tuple" in kind else "a list"
    kind = re.sub(
        r"Iterable\[str \| (?:Path \| )?Substitution\] \| (?:Path \| )?Substitution", "str", kind
    )  # what launch calls a text
    parts = [part for part in re.split(r" \| (?![^\[(]*[\])])", kind) if part != "None"]
    if len(parts) > 1 or kind.endswith(" | None"):
        return " or ".join(dict.fromkeys(map(plain, parts)))
    if inner := re.fullmatch(r"(?:Iterable|list|Sequence|List|Collection)\[(.+)\]", kind):
        return "a list" if "|" in inner[1] else f"a list of {inner[1].rpartition('.')[2]}s, in brackets"
    if made := re.fullmatch(r"type\[(.+)\]|<class '(.+)'>", kind):
        return f"the class {made[1] or made[2]} itself"
    if module := re.fullmatch(r"<module '(.+)'>", kind):
        return f"the module {module[1]}"
    if kind.startswith(("(", "def ", "bound method", "Callable", "Overload[")):
        return "a function without its parentheses"
    known = {
        "str": "a string",
        "int": "an integer",
        "float": "a float",
        "None": "None",
        "bool": "True or False",
    }
    return known.get(kind, re.sub(r"^Literal\[(.*)\]$", r"\1", kind))
