"""What both READMEs say of installing is typed, as it stands there, on a bare Debian."""

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
    lines = lines_below("With pip", ROOT / "README.md")
    typed = entering(["bash", "-e", "-c", lines], home, as_root=as_root, folder=folder)
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


@pytest.mark.thorough
@pytest.mark.timeout(PATIENCE)
def test_portable_ros2_stands_alone(tmp_path: Path) -> None:
    """In an environment that has nothing else; no package of the lab comes with it."""
    clone(tmp_path / "ros2lab")
    bare_root.hand_over(tmp_path)
    lines = lines_below("Install", ROOT / "src/portable_ros2/README.md")
    script = f"python3 -m venv ~/env; . ~/env/bin/activate\n{lines}\nros2 pkg list; pip list"
    typed = subprocess.run(
        entering(["bash", "-e", "-c", script], tmp_path, folder=PROJECT),
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert typed.returncode == 0, typed.stdout
    words = typed.stdout.split()
    assert {"portable_ros2", "rclpy", "std_msgs"} <= set(words)
    assert "ros2lab" not in words


def lines_below(heading: str, document: Path) -> str:
    """Return what a document lets somebody type first below a heading."""
    _, section = re.split(rf"^#+ {heading}$", document.read_text(encoding="utf-8"), flags=re.MULTILINE)
    block = re.search(r"^```bash\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
    assert block, heading
    return block[1]
