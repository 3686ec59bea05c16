"""Who has handed in the same: names, comments and order do not hide it, and what all were given is no sign of it."""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Callable, Mapping

import pytest

from portable_ros2.new_package import File, NewPackage
from ros2lab.classroom import similarity
from ros2lab.classroom.similarity import Shared, most_alike, pairs

OWN = '''"""A filter of my own."""


def smoothed(values, weight):
    """Return the values, each with a part of the one before."""
    result = []
    for value in values:
        if result and abs(value - result[-1]) < 10 * weight:
            result.append(weight * value + (1 - weight) * result[-1])
        else:
            result.append(value)  # a jump
    return result


def longest_pause(times):
    best, last = 0.0, None
    while times:
        now = times.pop(0)
        if last is not None and now - last > best:
            best = now - last
        last = now
    return {'pause': best, 'end': last}


class Ring:
    def __init__(self, size):
        self.size, self.items = size, [None] * size
        self.next = 0

    def put(self, item):
        self.items[self.next % self.size] = item
        self.next += 1
        return self.next > self.size
'''
OTHER = """import math


class Vector:
    def __init__(self, x, y):
        self.x, self.y = x, y

    def __add__(self, other):
        return Vector(self.x + other.x, self.y + other.y)

    def length(self):
        return math.sqrt(self.x ** 2 + self.y ** 2)

    def turned(self, angle):
        c, s = math.cos(angle), math.sin(angle)
        return Vector(c * self.x - s * self.y, s * self.x + c * self.y)


def path_of(steps):
    place = Vector(0, 0)
    yield place
    for angle, distance in steps:
        place = place + Vector(distance, 0).turned(angle)
        yield place


def area(corners):
    total = 0
    for first, second in zip(corners, corners[1:] + corners[:1]):
        total += first.x * second.y - second.x * first.y
    return abs(total) / 2
"""


def of_ones_own(seed: int, functions: int = 6) -> str:
    """Return functions that nobody else has."""
    chance = random.Random(seed)

    def value(depth: int) -> str:
        if depth == 0:
            return chance.choice(["a", "b", "1", "'x'", "len(a)", "b[0]", "self.a"])
        left, right = value(depth - 1), value(depth - 1)
        forms = (
            "({} + {})",
            "({} < {})",
            "[{}, {}]",
            "{}.get({})",
            "({} if {} else 0)",
            "{} // {}",
            "f({}, {})",
        )
        return chance.choice(forms).format(left, right)

    heads = ("if {}:", "while {}:", "for c in {}:", "with {}:")
    return "\n\n".join(
        f"def f(a, b):\n    {chance.choice(heads).format(value(2))}\n        a = {value(3)}\n    return {value(3)}\n"
        for _ in range(functions)
    )


def disguised(text: str) -> str:
    """Return the same program with other names, comments, strings and another order."""
    for number, name in enumerate(
        ("values", "weight", "result", "value", "times", "best", "last", "item", "size")
    ):
        text = re.sub(rf"\b{name}\b", f"thing_{number}", text)
    text = text.replace("smoothed", "my_fun").replace("Ring", "Buffer").replace('"""', "'''", 4)
    parts = re.split(r"\n\n\n", text)
    return "# all my own work\n" + "\n\n\n".join([parts[0], *reversed(parts[1:])])


def test_of_each_pair_the_largest_share_is_told() -> None:
    hidden = {"a.py": OWN, "unused.py": OTHER * 3}
    found = pairs({"ann": {"a.py": OWN}, "bob": {"a.py": OWN}})
    assert most_alike([*pairs({"ann": hidden, "bob": {"a.py": OWN}}), *found]) == found


def test_other_names_comments_and_another_order_hide_nothing() -> None:
    found = pairs({"ann": {"a.py": OWN}, "bob": {"src/b.py": disguised(OWN)}, "cy": {"c.py": OTHER}})
    assert [(pair.first, pair.second) for pair in found] == [("ann", "bob")]
    assert found[0].share > 0.7
    left = [line.text for line in found[0].left["a.py"] if line.is_alike]
    assert any("10 * weight" in line for line in left)
    right = [line.text for line in found[0].right["src/b.py"] if line.is_alike]
    assert any("10 * thing_1" in line for line in right)


def in_other_letters(text: str) -> str:
    """Return the same program, with other letters of Unicode for those of its names."""
    names = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    own = [name for name in names if name.islower() and name not in ("None", "self")]
    wide = {ord(letter): chr(ord(letter) + 0xFEE0) for letter in "abcdefghijklmnopqrstuvwxyz"}
    return re.sub(rf"\b({'|'.join(own)})\b", lambda name: name[0].translate(wide), text)


def as_few_lines(text: str) -> str:
    """Return the same program with all simple statements of a block on one line."""
    simple = r"[^\n]*[^:\n]"
    return re.sub(rf"^( +)({simple})\n\1(?=\w{simple}$)", r"\1\2; ", ast.unparse(ast.parse(text)), flags=re.M)


def in_brackets(text: str) -> str:
    """Return the same program with brackets around each thing that is computed, and each sign of it on a line of its own."""
    return re.sub(r"((?:= |return )(?!\[\]))([^=\n]+)$", r"\1(\n(\n\2\n)\n)", text, flags=re.M)


@pytest.mark.parametrize("form", [in_other_letters, as_few_lines, in_brackets])
def test_what_python_reads_alike_is_alike(form: Callable[[str], str]) -> None:
    """Whoever has written something else beside it has no part in it, and each line is shown as it is written."""
    other = form(OWN)
    assert other != OWN
    (pair,) = pairs({"ann": {"a.py": OWN}, "bob": {"b.py": other}, "cy": {"c.py": form(OTHER)}})
    assert (pair.first, pair.second) == ("ann", "bob")
    assert pair.share > 0.9
    lines = other.splitlines()
    assert all(line.text == lines[line.number - 1] for line in pair.right["b.py"] if line.number)


@pytest.mark.parametrize("fault", ["", "\ndef unfinished(:\n    pass\n"])
def test_the_template_is_the_same_in_any_form(fault: str) -> None:
    """Also to who has left a slip in it, and to who has formatted it."""
    sources = {"ann": {"a.py": OWN + fault}, "bob": {"a.py": in_brackets(OWN) + fault}}
    assert pairs(sources, template=[OWN]) == []


def test_what_was_cut_into_other_files_is_still_found() -> None:
    first, *rest = disguised(OWN).split("\n\n\n")
    files = {f"{number}.py": part for number, part in enumerate([first, *rest])}
    assert pairs({"ann": {"a.py": OWN}, "bob": files})


def test_the_template_is_no_sign_of_anything() -> None:
    assert pairs({"ann": {"a.py": OWN}, "bob": {"a.py": OWN}}, template=[OWN]) == []


def test_what_most_of_a_class_has_is_told_once_and_makes_no_pairs() -> None:
    """Whoever has little else is named, too; whoever has little but the lessons, or code of their own, is not."""
    common: list[str] = []
    shared: list[Shared] = []
    many = {str(number): {"a.py": OWN} for number in range(6)}
    others = {"own": {"a.py": OWN, "b.py": OTHER}, "tiny": {"a.py": "x = 1\nprint(x)\n"}}
    assert pairs({**many, **others}, common=common.append, shared=shared.append) == []
    assert common == [*many]
    assert [piece.students for piece in shared] == [[*many, "own"]]
    assert any("10 * weight" in line.text and line.is_alike for line in shared[0].files["a.py"])


def class_of(size: int, *rings: Mapping[int, Mapping[str, str]]) -> dict[str, dict[str, str]]:
    """Return a class in which each has something of their own, and some, by number, what they share."""
    whole = {str(number): {"own.py": of_ones_own(number)} for number in range(size)}
    for ring in rings:
        for number, files in ring.items():
            whole[str(number)] |= files
    return whole


def left_out_in_turn(number: int) -> dict[str, str]:
    parts = [of_ones_own(900 + part, 4) for part in range(7)]
    return {f"{part}.py": text for part, text in enumerate(parts) if part != number}


FIRST, SECOND = range(6), range(10, 16)
MUCH = of_ones_own(1000, 30)
SHARING = {
    "a quarter and more, each with much of their own": (
        class_of(20, {n: {"node.py": OWN, "more.py": of_ones_own(100 + n, 40)} for n in FIRST}),
        [FIRST],
    ),
    "one file in each": (class_of(20, {n: {f"my_{n}.py": disguised(OWN)} for n in range(8)}), [range(8)]),
    "two rings": (
        class_of(20, {n: {"a.py": MUCH} for n in FIRST}, {n: {"b.py": OTHER} for n in SECOND}),
        [FIRST, SECOND],
    ),
    "each leaves out another part": (
        class_of(20, {n: left_out_in_turn(n) for n in range(7)}),
        [range(7)],
    ),
    "a ring in a class that has a skeleton": (
        class_of(20, {n: {"skeleton.py": OTHER} for n in range(20)}, {n: {"a.py": MUCH} for n in FIRST}),
        [FIRST, range(20)],
    ),
    "nothing": (class_of(20), []),
    "some lines": (class_of(20, {n: {"main.py": OWN[:250]} for n in range(20)}), []),
    "a few": (class_of(8, {n: {"a.py": OWN} for n in range(5)}), []),
}


@pytest.mark.parametrize("name", SHARING)
def test_who_shares_what_many_have_is_named(name: str) -> None:
    sources, expected = SHARING[name]
    found: list[Shared] = []
    pairs(sources, shared=found.append)
    assert [piece.students for piece in found] == [[*map(str, students)] for students in expected]
    assert all(any(line.is_alike for lines in piece.files.values() for line in lines) for piece in found)


def test_a_new_package_and_the_template_are_shared_by_nobody() -> None:
    new = NewPackage("robot_controller", "ament_python", 3, "Drives.", "MIT", "Ann", "a@b.org", [])
    files = {step.path: new.render(step.template) for step in new.steps if isinstance(step, File)}
    sources = {path: text for path, text in files.items() if path.endswith(".py")}
    found: list[Shared] = []
    assert pairs({"ann": sources, "bob": sources}) == []
    everybody = class_of(8, {n: {**sources, "given.py": OWN} for n in range(8)})
    assert pairs(everybody, template=[OWN], shared=found.append) == []
    assert found == []


def test_little_code_and_none_say_nothing() -> None:
    tiny = "x = 1\nprint(x)\n"
    assert pairs({"ann": {"a.py": tiny}, "bob": {"a.py": tiny}, "cy": {}}) == []


def test_the_lessons_code_is_no_sign_of_anything() -> None:
    from ros2lab.classroom.similarity import _lessons

    lesson = max(_lessons(), key=len)
    assert pairs({"ann": {"a.py": lesson}, "bob": {"a.py": lesson}}) == []


@pytest.mark.parametrize("text", ["(" + "\t\n" * 50_000, "a." * 100_000])
def test_what_takes_without_end_is_left_out_and_named(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setattr(similarity, "PATIENCE", 0.3)
    left_out: list[str] = []
    found = pairs(
        {"ann": {"a.py": OWN}, "bob": {"b.py": disguised(OWN)}, "cy": {"c.py": text}}, (), left_out.append
    )
    assert left_out == ["cy"]
    assert [(pair.first, pair.second) for pair in found] == [("ann", "bob")]


def test_a_pair_that_takes_without_end_to_be_shown_is_named_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of many passages that all are alike, each is compared with each."""

    def without_end(*_: object) -> None:
        while True:
            pass

    monkeypatch.setattr(similarity, "PATIENCE", 0.3)
    monkeypatch.setattr(similarity, "_side_by_side", without_end)
    (pair,) = pairs({"ann": {"a.py": OWN}, "bob": {"b.py": disguised(OWN)}})
    assert (pair.first, pair.second, pair.left, pair.right) == ("ann", "bob", {}, {})
