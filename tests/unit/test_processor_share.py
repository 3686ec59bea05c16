"""The share of a processor that a program has."""

from __future__ import annotations

from pathlib import Path

import pytest

from ros2lab import processor_share


@pytest.mark.parametrize(
    ("said", "share"),
    [
        ("0.00 0.01 0.05 1/345 4711\n", 1.0),  # nobody but this process
        ("0.00 0.01 0.05 2/345 4711\n", 1.0),
        ("2.00 1.01 0.05 3/345 4711\n", 1.0),
        ("3.00 1.01 0.05 4/345 4711\n", 2 / 3),
        ("9.00 1.01 0.05 6/345 4711\n", 2 / 5),
        ("90.0 1.01 0.05 99/345 4711\n", 1 / 4),
        ("", 1.0),
        ("0.00 0.01\n", 1.0),
        ("0.00 0.01 0.05 -/- 4711\n", 1.0),
        (None, 1.0),
    ],
)
def test_who_computes_has_a_share(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, said: str | None, share: float
) -> None:
    """Of two processors."""
    path = tmp_path / "loadavg"
    if said is not None:
        path.write_text(said)
    monkeypatch.setattr(processor_share, "_LOADS", path)
    monkeypatch.setattr(processor_share.os, "sched_getaffinity", lambda _: {0, 1})
    assert processor_share.processor_share() == pytest.approx(share)
