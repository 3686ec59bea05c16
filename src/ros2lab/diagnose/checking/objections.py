"""What the type checker says of a workspace, and which of it is certainly a fault."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ros2lab.diagnose.checking.base_classes import asked_of, may_be_of_subclass
from ros2lab.diagnose.checking.checked_copies import RULES, said_of
from ros2lab.diagnose.checking.doubts import contradicted, is_contradicted, is_doubtful, is_misled
from ros2lab.diagnose.checking.type_words import types_named
from ros2lab.diagnose.code.lost_parameters import CODE, definitions
from ros2lab.diagnose.finding import Finding, shown_path
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.printed.spots import Spot
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.construction import is_of_construction
from ros2lab.diagnose.sources.node_source import NodeSources, is_self_attribute
from ros2lab.diagnose.sources.one_run import may_be_caught
from ros2lab.diagnose.sources.python_source import PythonSource, names_bound, read_source, read_text

# Types about which there is no doubt: no unions and no containers.
_PLAIN = re.compile(r"Literal\[.*\]|str|int|float|bool|SupportsIndex \| float\*|")


@dataclass(frozen=True)
class Objection:
    """What the type checker says of a line.

    Attributes:
        said: what the rule takes from it; the message itself if no rule knows it.
        source: the file; None for a launch file.
    """

    row: re.Match[str]
    said: re.Match[str]
    source: PythonSource | None
    shown: str

    @property
    def line(self) -> int:
        """The number of the line."""
        return int(self.row["line"])

    @property
    def place(self) -> str:
        """The file and the line, as they are shown."""
        return f"{self.shown}:{self.row['line']}"

    @property
    def groups(self) -> dict[str, str]:
        """The parts of the message by name, empty where it has none; a type variable is what it is bound to."""
        found = {key: value or "" for key, value in self.said.groupdict().items()}
        if "owner" in found:
            found["owner"] = _bound_of(found["owner"], self.source) or found["owner"]
        return found

    def read(self) -> PythonSource:
        """Return the file, read if that was not done before."""
        path = Path("/", self.row["file"])
        return self.source or read_source(path, path.stem, self.shown)


def objections_of(look: Look, message: str) -> list[Objection]:
    """Return what the type checker says of a workspace; first what names the types of an error's message."""
    sources = {
        str(s.path): s for p in look.packages for s in p.sources.values() if s.path and s.text and not s.fault
    }
    rows = said_of([*sources, *_launch_files(look)], packages=[package.folder for package in look.packages])
    found = list[Objection]()
    for row in sorted(rows, key=lambda row: -types_named(row["said"], message)):
        said = re.search(RULES[row["rule"]], row["said"]) if row["rule"] in RULES else None
        source = sources.get(f"/{row['file']}")
        shown = source.shown if source else shown_path(Path("/", row["file"]), look.root)
        found.append(Objection(row, said or row, source, shown))
    return found


class Doubts:
    """Whether an objection of the type checker is a fault, and no other rule's."""

    def __init__(self, look: Look, known: Sequence[Finding], objections: Iterable[Objection]) -> None:
        self._known = known
        self._owners = {s: look.sources(p) for p in look.packages for s in p.sources.values()}
        said: dict[PythonSource, list[tuple[int, str]]] = {}
        for objection in objections:
            if objection.source is not None:
                said.setdefault(objection.source, []).append((objection.line, objection.row["said"]))
        self._denied = {source: contradicted(source, rows) for source, rows in said.items()}

    def is_of_another_rule(self, objection: Objection) -> bool:
        """Return whether no rule here knows an objection, or one elsewhere says it better."""
        row, said, source = objection.row, objection.said, objection.source
        if said is row or _is_told_elsewhere(row, said):
            return True
        if row["rule"] in _OF_ARGUMENTS and _is_of_def(said["owner"], self._owners, self._known):
            return True
        return source in self._owners and is_of_construction(
            self._owners[source], source, objection.line, said[0]
        )

    def is_certain(self, objection: Objection) -> bool:
        """Return whether a line fails as the type checker says, whatever runs before it."""
        source, line, groups = objection.source, objection.line, objection.groups
        if not (_is_sure(groups) and _may_not_fail(source, line, groups)):
            return False
        owner, name = owner_and_name(groups)
        asked = asked_of(objection.row["rule"], objection.said[0], groups["owner"], name)
        if may_be_of_subclass(*asked, Spot(objection.read(), line), self._owners):
            return False
        if source is None:
            return True
        if _may_be_given(self._owners.get(source), owner, name):
            return False
        is_doubted = source in self._owners and is_doubtful(
            objection.row, objection.said, source, self._owners[source]
        )
        if is_doubted or is_contradicted(source, line, self._denied[source]):
            return False
        own = self._owners.get(source)
        return own is None or not is_misled(source, line, objection.row["rule"], own)


_OF_ARGUMENTS = frozenset(("too-many-positional-arguments", "unknown-argument", "missing-argument"))


def _is_of_def(name: str, owners: Mapping[PythonSource, NodeSources], known: Iterable[Finding]) -> bool:
    """Return whether the def of a function is wrong, and not its calls."""
    told = {finding.place for finding in known if finding.code in (CODE, "node-property")}
    named = (
        (found for source in owners for found in definitions(source) if found.name == name) if told else ()
    )
    return any(definition.source.at(definition.function) in told for definition in named)


def _launch_files(look: Look) -> Iterator[str]:
    """Yield the paths of the Python launch files; files too large to read are left out."""
    paths = (path for package in look.packages for path in package.launch_files)
    return (str(path) for path in paths if path.suffix == ".py" and read_text(path))


def _is_told_elsewhere(row: re.Match[str], said: re.Match[str]) -> bool:
    """Return whether another rule reports this better: undefined names, members of a class or None."""
    if row["rule"] == "unresolved-reference":  # our own rule knows exec() and globals()
        return True
    groups = said.groupdict()
    return groups.get("owner") in ("property", "None") or groups.get("message") == "None"


def _may_not_fail(source: PythonSource | None, line: int, groups: dict[str, str]) -> bool:
    """Return whether a line is not guarded by `try`, and uses no class that may be a subclass, nor an added attribute."""
    if source is None:
        return True
    return not (
        may_be_caught(source, line, AttributeError, TypeError, ImportError)
        or _is_of_any_class(source, line, groups["owner"])
        or _is_set_from_outside(source, *owner_and_name(groups))
    )


def _is_sure(said: dict[str, str]) -> bool:
    owner = said["owner"]
    if owner.startswith("bound method "):
        return True
    kinds = [said.get(name, "") for name in ("wanted", "given", "both")]
    if kinds[0] == "bool" and re.fullmatch(r"int|Literal\[\d+\]", kinds[1]):
        return False  # Python takes any number for a truth; the fields of messages, which do not, have their own rule
    if not all(_PLAIN.fullmatch(kind) for kind in kinds):
        return False
    # What a type variable stands for is open, as is the class that a mixin is used with; functions may have attributes.
    is_clear = not re.search(r"Unknown| \| |\[|^object$|^def |@", owner)
    return is_clear or _PLAIN.fullmatch(owner) is not None


def _bound_of(kind: str, source: PythonSource | None) -> str:
    """Return the class to which a type variable is bound where a file makes it; empty for any other type."""
    name = kind.partition("@")[0] if re.fullmatch(r"\w+@\w+", kind) else ""
    for node in source.nodes if name and source else ():
        made, bounds = getattr(node, "name", ""), [getattr(node, "bound", None)]  # def show[T: String]()
        if isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            made = node.args[0].value
            bounds = [keyword.value for keyword in node.keywords if keyword.arg == "bound"]
        found = [bound for bound in bounds if isinstance(bound, (ast.Name, ast.Attribute))]
        if made == name and found:
            return ast.unparse(found[0]).rpartition(".")[2]
    return ""


def _is_set_from_outside(source: PythonSource, owner: str, name: str) -> bool:
    """Return whether a file sets an attribute on an object other than self; messages refuse new attributes."""
    stored = (n for n in source.nodes if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store))
    is_message = any(interfaces.fields_of(f"{home}.{owner}") for home in interfaces.homes_of(owner))
    return not is_message and any(node.attr == name and not is_self_attribute(node) for node in stored)


def _may_be_given(own: NodeSources | None, owner: str, name: str) -> bool:
    """Return whether other code may give the instances of a package's own class an attribute."""
    named = [known for known in own.classes.values() if known.definition.name == owner] if own else []
    given = [own.given(known) for known in named] if own else []
    return any(names is None or name in names for names in given)


def _is_of_any_class(source: PythonSource, line: int, owner: str) -> bool:
    """Return whether a line instantiates a class in a variable, which may take other arguments."""
    given = {node.arg for node in source.nodes if isinstance(node, ast.arg)}
    given |= names_bound(source.nodes)
    called = [n.func for n in source.calls if n.lineno == line]
    return owner.endswith(".__init__") and any(
        isinstance(function, ast.Subscript)
        or is_self_attribute(function)
        or getattr(function, "id", "") in given
        for function in called
    )


def owner_and_name(said: dict[str, str]) -> tuple[str, str]:
    """Return the owner and the name of the member or argument that the type checker reports."""
    name = said.get("name") or said.get("field", "")
    return (said["owner"] or said.get("message", "")).removesuffix(".__init__"), name.replace("`", "")
