"""Memory of a kernel in which lesson 8 has run, beside that of a bare one."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack

import psutil
from kernel import Kernel
from lesson import code_cells
from place import own_place
from row import Quantity, Row

MEGABYTE = 1e6


def measure(advance: Callable[[float], None], *, is_quick: bool = False) -> list[Row]:  # noqa: ARG001
    """Run all cells of the lesson: three nodes, panel, plot, logs, and everything stays open."""
    cells = code_cells()
    with ExitStack() as stack:
        place = stack.enter_context(own_place())
        kernel = stack.enter_context(Kernel(place.environ, place.folder))
        bare = psutil.Process(kernel.pid).memory_full_info()
        for number, cell in enumerate(cells):
            kernel.run(cell)
            advance((number + 1) / len(cells))
        full = psutil.Process(kernel.pid).memory_full_info()
    return [
        Row(
            "memory of a kernel after lesson 8: three nodes, panel, plot, logs",
            Quantity(full.rss / MEGABYTE, "MB"),
            "a bare ipykernel",
            Quantity(bare.rss / MEGABYTE, "MB"),
            {"value": 250.0},
            f"RSS; its own alone (USS) is {full.uss / MEGABYTE:.0f} MB, of a bare one {bare.uss / MEGABYTE:.0f} MB",
        )
    ]
