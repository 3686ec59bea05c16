"""README's section "Install": its lines are typed, as they stand there, on a bare Debian."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from bare_student import PROJECT, ROOT, Student, bare_root, clone, entering, environment, wait_for_address
from deadlines import DEADLINE

# pip takes two minutes for all packages where nothing else runs.
PATIENCE = 1200.0  # s


@pytest.mark.thorough
@pytest.mark.timeout(PATIENCE + DEADLINE)
@pytest.mark.parametrize("as_root", [False, True], ids=["student", "root"])
def test_what_readme_says_of_pip_opens_the_lab(as_root: bool, tmp_path: Path) -> None:
    home, log = tmp_path / "home", tmp_path / "lab.log"
    clone(home / "ros2lab")
    bare_root.hand_over(home, as_root=as_root)
    folder = PROJECT.replace(bare_root.HOME, bare_root.HOME_OF_ROOT if as_root else bare_root.HOME)
    typed = entering(["bash", "-e", "-c", lines_below("With pip")], home, as_root=as_root, folder=folder)
    with log.open("w") as output:
        lab = subprocess.Popen(
            typed,
            env=environment(as_root=as_root),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
        )
    try:
        student = Student(wait_for_address(log, lab, PATIENCE), home / "ros2lab/work")
        _, kernel = student.open("notebooks/00_welcome.ipynb")
        kernel.run("import rclpy, ros2lab")
        [output] = kernel.run("!ros2 --version")
        assert output["text"].startswith("portable_ros2 ")
        kernel.close()
        student.request("POST", "shutdown")
        assert lab.wait(DEADLINE) == 0, log.read_text()
    finally:
        lab.kill()  # and with it all that is inside
        lab.wait()


def lines_below(heading: str) -> str:
    """Return what README lets somebody type below a heading."""
    _, section = (ROOT / "README.md").read_text(encoding="utf-8").split(f"\n### {heading}\n")
    block = re.search(r"^```bash\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
    assert block, heading
    return block[1]
