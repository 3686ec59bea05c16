"""Run pytest with nbval on a busy machine.

After a kernel's answer nbval waits 5 s for what the cell still prints, and has no option for it.
"""

from __future__ import annotations

import sys

import pytest
from nbval.plugin import IPyNbCell

OUTPUT_TIMEOUT = 60  # s


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Make a cell's test more patient before it runs."""
    if isinstance(item, IPyNbCell):
        item.output_timeout = OUTPUT_TIMEOUT


if __name__ == "__main__":
    options = ["--nbval", "--nbval-kernel-name=ros2lab", "--nbval-kernel-startup-timeout=300"]
    sys.exit(pytest.main([*options, *sys.argv[1:]], plugins=[sys.modules[__name__]]))
