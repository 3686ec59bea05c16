"""The texts with which a program compares what it gets."""

import pytest

from ros2lab.diagnose.sources.python_source import PythonSource
from ros2lab.grading.code.compared import compared
from ros2lab.grading.code.running import running

WORDS = ["reset", "start", "stop"]


def words_in(*texts: str) -> list[str]:
    sources = [PythonSource(f"pk.m{number}", f"m{number}.py", text) for number, text in enumerate(texts)]
    return [text for text in compared(node for _, node in running(sources)) if text != "__main__"]


@pytest.mark.parametrize(
    "body",
    [
        "if m.data == 'start': pass\n        elif 'stop' == m.data: pass\n        elif m.data != 'reset': pass",
        "match m.data:\n            case 'start' | 'stop': pass\n            case 'reset': pass",
        "{'start': self.go, 'stop': self.halt, 'reset': self.go}[m.data]()",
        "TABLE[m.data](self)",
        "self.obey(m.data)",
    ],
)
def test_words_that_are_told_apart_are_found(body: str) -> None:
    text = f"""
TABLE = {{'start': 1, 'stop': 2, 'reset': 3}}
class Robot:
    def __init__(self):
        self.create_subscription(String, '/robot/command', self.heard, 10)
    def heard(self, m):
        {body}
    def obey(self, word):
        if word == 'start' or word == 'stop' or word == 'reset': pass
def main():
    Robot()
"""
    assert words_in(text) == WORDS


LOOKED_FOR = [
    "if 'left' in m.data: pass",
    "if 'left' not in m.data: pass",
    "if m.data.startswith('left'): pass",
    "if m.data.strip().lower().endswith('left'): pass",
    "if m.data.find('left') >= 0: pass",
    "if m.data.count('left'): pass",
    "if re.search('left', m.data): pass",
    "if re.match(r'^\\s*left\\b', m.data): pass",
    "if (found := re.fullmatch('(?i)left', m.data)): pass",
    "words = m.data.split()\n        if 'left' in words: pass",
    "words = m.data.split()\n        if words[0] == 'left': pass",
    "match m.data.split():\n            case ['left', *rest]: pass",
    "{'left': 1}.get(m.data, 0)",
]


@pytest.mark.parametrize("body", LOOKED_FOR)
def test_words_that_are_looked_for_in_a_text_are_found(body: str) -> None:
    text = f"import re\ndef main():\n    def heard(m):\n        {body}\n    create_subscription(heard)\n"
    assert words_in(text) == ["left"]


@pytest.mark.parametrize(
    "body",
    [
        "m.data.replace('left', '')",
        "m.data.split('left')",
        "re.compile(m.data)",
        "re.search('left|right|back', m.data)",  # does not tell these apart
        "m.data in ('left', 'right')",
        "startswith('left')",
        "'left'.startswith(m.data)",
    ],
)
def test_words_that_are_not_looked_for_do_not_count(body: str) -> None:
    assert words_in(f"import re\ndef main():\n    {body}\n") == []


def test_a_table_in_another_file_is_used_where_its_name_is() -> None:
    table = "STATES = {'start': 'on', 'stop': 'off', 'reset': 'idle'}\n"
    assert words_in(table, "from pk.m0 import STATES\ndef main():\n    print(STATES)\n") == WORDS
    assert words_in(table, "def main():\n    pass\n") == []


@pytest.mark.parametrize(
    "text",
    [
        "def unused(word):\n    if word == 'start': pass\n",
        "def unused(word):\n    return unused(word) if word == 'start' else ''\n",
        "STATES = {'start': 1}\ndef unused(word):\n    return STATES[word]\n",
        "def main():\n    print('start', 'stop')\n",
        "def main():\n    return w in ('start', 'stop')\n",
        "def main():\n    return w == 'start' * 20 == '" + 40 * "start" + "'\n",
        "this is no Python",
        "",
    ],
)
def test_what_is_not_run_or_not_compared_does_not_count(text: str) -> None:
    assert words_in(text) == []


SHUT = [
    "if False:\n        {}",
    "if 0 and w:\n        {}",
    "if not 'x':\n        {}",
    "while 1 > 2:\n        {}",
    "for _ in ():\n        {}",
    "return\n    {}",
    "raise SystemExit\n    {}",
    "import sys\n    sys.exit(0)\n    {}",
    "if True:\n        pass\n    else:\n        {}",
    "x = False and [{}]",
    "x = [{}] if None else 1",
    "try:\n        pass\n    except ValueError:\n        {}",
    "try:\n        w.n = x = 0\n    except ValueError:\n        {}",
    "for _ in w:\n        continue\n        {}",
    "def inner():\n        {}",
    "class Inner:\n        def of(self):\n            {}",
]
OPEN = [
    "if w:\n        {}",
    "while True:\n        {}",
    "if w:\n        return\n    {}",
    "try:\n        int(w)\n    except ValueError:\n        {}",
    "try:\n        x = w.n\n    except AttributeError:\n        {}",
    "try:\n        x, y = 1 / w, 2\n    except ZeroDivisionError:\n        {}",
    "def inner():\n        {}\n    w.connect(inner)",
    "class Inner(threading.Thread):\n        def run(self):\n            {}\n    Inner().start()",
    "class Inner:\n        @property\n        def of(self):\n            return {}\n    Inner().of",
    "class Inner:\n        def on_a(self):\n            {}\n    getattr(Inner(), 'on_' + w)()",
    "class Inner:\n        def on_a(self):\n            {}\n    getattr(Inner(), 'on_a')()",
    "class Inner(Node):\n        def destroy_node(self):\n            {}\n    Inner()",
    "class A(Node): pass\n    class B(A):\n        def destroy_node(self):\n            {}\n    B()",
    "@app.command\n    def inner():\n        {}",
    "x = lambda: {}",
    "x = w and {}",
]


@pytest.mark.parametrize(
    ("code", "is_run"), [*((one, False) for one in SHUT), *((one, True) for one in OPEN)]
)
def test_what_constants_and_names_shut_does_not_run(code: str, is_run: bool) -> None:
    body = code.format("w == 'start'")
    text = f"from rclpy.node import Node\n\ndef main(w=0):\n    {body}\n"
    assert words_in(text) == ["start"] * is_run


def test_what_an_entry_point_may_call_counts() -> None:
    assert words_in("def run_it(args=None):\n    return args == 'start'\n") == ["start"]


def test_a_great_many_are_cut() -> None:
    assert len(words_in("\n".join(f"x == 'w{number}'" for number in range(1000)))) == 100
