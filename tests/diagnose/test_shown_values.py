"""What a program shows as nan, and where that was made of many values."""

from __future__ import annotations

from pathlib import Path

import pytest
from right_workspace import right_workspace

from ros2lab.diagnose import of_text
from ros2lab.diagnose.finding import Finding

RUN = "$ ros2 run my_bot status_publisher\n"


def told(lines: str, said: str, folder: Path) -> list[Finding]:
    files = right_workspace().change(
        "node", "        msg = String()", f"        {lines}\n        msg = String()"
    )
    files.change(
        "node", "        self.count = 0", "        self.count, self.ranges, self.distance = 0, [0.2], 0.3"
    )
    root = files.write(folder)
    return [one for one in of_text(RUN + said, root) if one.code == "value-nan"]


@pytest.mark.parametrize(
    ("lines", "said", "fix"),
    [
        ("near = min(self.ranges); print(f'near {near:.2f} m')", "near nan m", "min([v for v in self.ranges if"),
        ("self.get_logger().info('far: %.1f' % max(self.ranges))", "[INFO] [s]: far: nan", "max([v for v in self.ranges"),
        ("mean = sum(self.ranges) / 4; print('mean is', mean)", "mean is nan", "sum([v for v in self.ranges"),
        ("m = np.mean(self.ranges); print('mean = {:.2f}'.format(m))", "mean = nan", "np.mean([v for v in self.ranges"),
        ("w = sorted(self.ranges); print(f'worst: {w[0]}')", "worst: nan", "sorted([v for v in self.ranges"),
    ],
)  # fmt: skip
def test_nan_is_followed_to_what_it_was_made_of(tmp_path: Path, lines: str, said: str, fix: str) -> None:
    found = told(lines, said + "\n", tmp_path)
    assert found
    assert fix in found[0].fix


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("near = min(self.ranges); print(f'near {near:.2f} m')", "near 0.20 m"),
        ("near = min(self.ranges); print(f'near {near:.2f} m')", "another nan m"),
        ("near = min(self.ranges); print('near Nanette')", "near Nanette"),
        ("x = min(v for v in self.ranges if not math.isnan(v)); print(f'near {x} m')", "near nan m"),
        ("x = self.distance; print(f'near {x} m')", "near nan m"),
    ],
)
def test_what_is_not_shown_as_nan_is_left_alone(tmp_path: Path, lines: str, said: str) -> None:
    assert told(lines, said + "\n", tmp_path) == []
