"""Defaults and fields that are computed where they are defined, and those for which that is right."""

from __future__ import annotations

import textwrap
from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.defined_once import defined_once
from ros2lab.diagnose.finding import Finding

HEAD = """
    import random
    import time
    import uuid
    from dataclasses import dataclass, field
    from datetime import datetime
    from typing import ClassVar
"""


def told(code: str, folder: Path) -> list[Finding]:
    text = textwrap.dedent(HEAD) + textwrap.dedent(code)
    return [*defined_once(sources_of(text, folder, "watch"))]


TWO = "\na, b = C(), C()\n"


@pytest.mark.parametrize(
    ("code", "fix"),
    [
        ("class C:\n  def age(self, now=time.monotonic()): return now", "write now=None here, and `if now is None: now = time.monotonic()`"),
        ("def roll(*, n=random.randint(1, 6)): return n", "if n is None: n = random.randint(1, 6)"),
        ("def stamp(text, at=datetime.now().isoformat()): return at", "if at is None: at = datetime.now().isoformat()"),
        ("def name(one=str(uuid.uuid4())[:8]): return one", "if one is None"),
        ("def add(x, to=[]):\n  to.append(x)\n  return to", "write to=None here, and `if to is None: to = []`"),
        ("class C:\n  def __init__(self, items=[]): self.items = items\n  def add(self, x): self.items.append(x)", "if items is None: items = []"),
        ("class C:\n  def __init__(self, seen={}): self.seen = seen\n  def add(self, x): self.seen[x] = 1", "if seen is None: seen = {}"),
        ("@dataclass\nclass C:\n  at: float = time.time()", "write field(default_factory=lambda: time.time())"),
        ("@dataclass(frozen=True)\nclass C:\n  n: int = random.randint(1, 6)", "write field(default_factory"),
        ("class C:\n  n = random.random()\n  def show(self): print(self.n)" + TWO, "write `self.n = random.random()` in __init__"),
    ],
)  # fmt: skip
def test_what_was_meant_for_each_is_told(tmp_path: Path, code: str, fix: str) -> None:
    (found,) = told(code, tmp_path)
    assert found.code in ("computed-once", "one-object")
    assert fix in found.fix


@pytest.mark.parametrize(
    "code",
    [
        "def age(now=None): return now or time.time()",
        "def age(clock=time.monotonic): return clock()",
        "def age(clock=lambda: time.time()): return clock()",
        "def wait(limit=time.strptime('1', '%S')): return limit",
        "def roll(source=random.Random(3)): return source",
        "def add(x, to=()): return [*to, x]",
        "def add(x, to=[]): return to + [x]",
        "def middle(values=[3, 1, 2]):\n  values.sort()\n  return values[1]",
        "def last(values=[3, 1, 2]):\n  values.reverse()\n  return values[0]",
        "def add(x, to=[]):\n  to = list(to)\n  to.append(x)\n  return to",
        "def load(x, cache={}):\n  if x not in cache: cache[x] = 1\n  return cache[x]",
        "class C:\n  def __init__(self, items=[]): self.items = list(items)\n  def add(self, x): self.items.append(x)",
        "class C:\n  def __init__(self, items=[]): self.items = items\n  def show(self): print(self.items)",
        "@dataclass\nclass C:\n  at: float = field(default_factory=time.time)",
        "@dataclass\nclass C:\n  born: ClassVar[float] = time.time()",
        "class C:\n  start = time.time()\n  def show(self): print(self.start)\n\na = C()",
        "class C:\n  n = random.random()\n  def show(self): print(C.n)" + TWO,
        "START = time.time()",
    ],
)  # fmt: skip
def test_what_holds_for_all_is_left_alone(tmp_path: Path, code: str) -> None:
    assert told(code, tmp_path) == []
