"""Where the modules of this folder are found, and how many cases of a test `make test` runs."""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import pytest

HERE = Path(__file__).parent
MOST = 3  # of one test: each case is a question about a whole workspace, and all are of one kind

sys.path.insert(0, str(HERE))


def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    """Mark the cases of a test as thorough but for some, which are taken at equal distances."""
    cases: dict[tuple[Path, str], list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.path.is_relative_to(HERE) and not item.get_closest_marker("thorough"):
            cases[item.path, item.nodeid.partition("[")[0]].append(item)
    for alike in cases.values():
        kept = {number * len(alike) // MOST for number in range(MOST)}
        for number, item in enumerate(alike):
            if len(alike) > MOST and number not in kept:
                item.add_marker(pytest.mark.thorough)
