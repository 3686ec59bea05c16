"""Classes of one's own whose objects are made otherwise than their bodies say, and classes that lost their constructor."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

HEAD = "import rclpy\nfrom rclpy.node import Node\n\n\n"
MAIN = """


def main(args=None):
    rclpy.init(args=args)
    node = {made}
    rclpy.spin(node)
    node.destroy_node()
    rclpy.try_shutdown()
"""
RIGHT = {
    "mixed in": "class Named:\n    def __init__(self, *args, **kwargs):\n        super().__init__('a', *args, **kwargs)\n\n\nclass A(Named, Node):\n    pass\n",
    "partial": "from functools import partialmethod\n\n\nclass A(Node):\n    __init__ = partialmethod(Node.__init__, 'a')\n",
    "assigned": "class A(Node):\n    pass\n\n\ndef _begin(self):\n    Node.__init__(self, 'a')\n\n\nA.__init__ = _begin\n",
    "assigned in its body": "def _begin(self):\n    Node.__init__(self, 'a')\n\n\nclass A(Node):\n    __init__ = _begin\n",
    "named otherwise": "class A(Node):\n    def begin(self):\n        super().__init__('a')\n\n    __init__ = begin\n",
    "setattr": "class A(Node):\n    pass\n\n\nsetattr(A, '__init__', lambda self: Node.__init__(self, 'a'))\n",
    "wrapped": "def named(name):\n    def decorate(cls):\n        class Wrapped(cls):\n            def __init__(self):\n                super().__init__(name)\n\n        return Wrapped\n\n    return decorate\n\n\n@named('a')\nclass A(Node):\n    pass\n",
    "decorated": "def named(cls):\n    begin = cls.__init__\n\n    def init(self):\n        begin(self, cls.__name__.lower())\n\n    cls.__init__ = init\n    return cls\n\n\n@named\nclass A(Node):\n    pass\n",
    "made anew": "def named(cls):\n    return lambda: cls('a')\n\n\nclass A(Node):\n    pass\n\n\nA = named(A)\n",
    "metaclass": "class Meta(type):\n    def __call__(cls):\n        return super().__call__(cls.__name__.lower())\n\n\nclass A(Node, metaclass=Meta):\n    pass\n",
    "entered": "class A(Node):\n    def __enter__(self):\n        Node.__init__(self, 'a')\n        return self\n\n    def __exit__(self, *_):\n        self.destroy_node()\n",
    "subclass": "class Base(Node):\n    def __init_subclass__(cls, name, **kwargs):\n        super().__init_subclass__(**kwargs)\n        cls.node_name = name\n\n    def __init__(self):\n        super().__init__(self.node_name)\n\n\nclass A(Base, name='a'):\n    pass\n",
    "a dataclass": "from dataclasses import InitVar, dataclass\n\n\n@dataclass(eq=False, repr=False)\nclass A(Node):\n    name: InitVar[str] = 'a'\n\n    def __post_init__(self, name):\n        Node.__init__(self, name)\n",
    "a dataclass and super": "import dataclasses\n\n\n@dataclasses.dataclass(eq=False)\nclass A(Node):\n    label: str = 'a'\n\n    def __post_init__(self):\n        super().__init__(self.label)\n",
    "a derived dataclass": "import dataclasses\n\n\n@dataclasses.dataclass(eq=False)\nclass Base(Node):\n    label: str = 'a'\n\n    def __post_init__(self):\n        super().__init__(self.label)\n\n\nclass A(Base):\n    pass\n",
    "an init of its own": "class A(Node):\n    def init(self):\n        self.count = 0\n",
}
MADE = {"entered": "A.__new__(A).__enter__()", "an init of its own": "A('a')\n    node.init()"}
WRONG = {
    "_init_": ("class A(Node):\n    def _init_(self):\n        super().__init__('a')\n", "A()", "super-misspelt", "write def __init__(self):"),
    "__intit__": ("class A(Node):\n    def __intit__(self, rate=1.0):\n        super().__init__('a')\n", "A()", "super-misspelt", "write def __init__(self, rate=1.0):"),
    "setup": ("class A(Node):\n    def setup(self):\n        Node.__init__(self, 'a')\n", "A()", "super-misspelt", "write def __init__(self):"),
    "a name that nothing calls": ("class A(Node):\n    def __post_init__(self):\n        super().__init__('a')\n", "A()", "super-misspelt", "write def __init__(self):"),
    "of PHP": ("class A(Node):\n    def __construct__(self):\n        super().__init__('a')\n", "A()", "super-misspelt", "write def __init__(self):"),
    "no dataclass": ("from typing import final\n\n\n@final\nclass A(Node):\n    def setup(self):\n        super().__init__('a')\n", "A()", "super-misspelt", "write def __init__(self):"),
    "none": ("class BusStop(Node):\n    pass\n", "BusStop()", "argument-missing", "write `BusStop('bus_stop')`"),
    "a name that is wanted": ("class A(Node):\n    def __init__(self, name):\n        super().__init__(name)\n", "A()", "argument-missing", "name"),
    "no base class": ("class A:\n    def __init__(self):\n        super().__init__('a')\n", "A()", "argument-unknown", "(Node)"),
}  # fmt: skip


def found(text: str, made: str, folder: Path) -> list[tuple[str, str]]:
    files = Files.right(NAMES[1])
    files.texts[files.path("node")] = HEAD + text + MAIN.format(made=made)
    files.remove("launch/robot.launch.py").remove("config/robot.yaml")
    return [(one.code, one.fix) for one in of_workspace(files.write(folder))]


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_made_in_a_way_of_its_own_is_no_fault(name: str, tmp_path: Path) -> None:
    assert found(RIGHT[name], MADE.get(name, "A()"), tmp_path) == []


@pytest.mark.parametrize("name", WRONG)
def test_what_lacks_its_constructor_is_told_once(name: str, tmp_path: Path) -> None:
    text, made, code, fix = WRONG[name]
    first, *others = found(text, made, tmp_path)
    assert not others or name == "no base class"  # of what has none, more is missed
    assert first[0] == code
    assert fix in first[1]


TWICE = {
    "_init_": "class A(Node):\n    def _init_(self):\n        super()._init_('a')\n",
    "__init_": "class A(Node):\n    def __init_(self, rate=1.0):\n        super().__init_('a')\n        self.rate = rate\n",
    "init": "class A(Node):\n    def init(self):\n        super().init('a')\n",
    "of the class": "class A(Node):\n    def _init_(self):\n        Node._init_(self, 'a')\n",
    "with its class": "class A(Node):\n    def _int_(self):\n        super(A, self)._int_('a')\n",
}


@pytest.mark.parametrize("name", TWICE)
def test_a_constructor_that_is_misspelt_in_both_places_is_told_in_both(name: str, tmp_path: Path) -> None:
    lines = TWICE[name].splitlines()
    told = found(TWICE[name], "A()", tmp_path / "before")
    assert [code for code, _ in told] == ["super-misspelt"] * 2
    for number, (_, fix) in zip((1, 2), told, strict=True):
        indent = len(lines[number]) - len(lines[number].lstrip())
        lines[number] = " " * indent + fix.removeprefix("write ")
    assert "super().__init__('a')" in lines[2]
    assert found("\n".join(lines) + "\n", "A()", tmp_path / "after") == []


GUARDS = ["_name_ == '_main_'", "name == 'main'", "__name == '__main'", "_name_ == '__main__'"]


@pytest.mark.parametrize("guard", GUARDS)
def test_a_guard_is_written_whole(guard: str, tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    files.texts[files.path("node")] = f"{HEAD}def main():\n    rclpy.init()\n\n\nif {guard}:\n    main()\n"
    told = [one for one in of_workspace(files.write(tmp_path)) if one.code == "name-undefined"]
    assert [one.fix for one in told] == ["write `if __name__ == '__main__':`"]
