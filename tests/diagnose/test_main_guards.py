"""Guards about `__name__`: true when the file is run, or never."""

from __future__ import annotations

from pathlib import Path

import pytest
from one_file import sources_of

from ros2lab.diagnose.code.main_guards import main_guard_faults

FILE = "def main():\n    print('x')\n\n\n{guard}\n    main()\n"


def told(text: str, folder: Path) -> list[str]:
    sources = sources_of(text, folder)
    return [finding.fix for source in sources.sources.values() for finding in main_guard_faults(source)]


@pytest.mark.parametrize(
    "guard",
    [
        "if __name__ == 'main':",
        "if __name__ == '_main_':",
        "if '__main___' == __name__:",
        "if '__name__' == '__main__':",
        "if __name__ == 'node':",
        "if __name__ in ('main', 'Main'):",
        "if not __name__ != 'main':",
    ],
)
def test_a_guard_that_is_never_true_is_told(tmp_path: Path, guard: str) -> None:
    assert told(FILE.format(guard=guard), tmp_path) == ["write `if __name__ == '__main__':`"]


@pytest.mark.parametrize(
    "guard",
    [
        "if __name__ == '__main__':",
        "if __name__ in {'__main__', '__mp_main__'}:",
        "if __name__ != '__main__':",
        "if __name__ == 'pk.node':",
        "if __name__.endswith('main__'):",
        "if __name__ == NAME:",
    ],
)
def test_a_guard_that_may_be_true_is_right(tmp_path: Path, guard: str) -> None:
    assert not told(FILE.format(guard=guard), tmp_path)


def test_a_guard_inside_the_function_that_it_calls(tmp_path: Path) -> None:
    text = "def main():\n    print('x')\n    if __name__ == '__main__':\n        main()\n"
    assert told(text, tmp_path) == ["move it, with the lines below it, to the left margin"]
