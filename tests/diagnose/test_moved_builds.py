"""Links of a build that lead nowhere: what was built and moved, or moved within src, is told from what never was built."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace

MARKER = "share/ament_index/resource_index/packages/my_bot"
NOT_FOUND = "$ source install/setup.bash\n$ ros2 run my_bot talker\nPackage 'my_bot' not found\n"
AGAIN = "rm -rf build install log, then colcon build --symlink-install, then source install/setup.bash in a new terminal"


def linked(root: Path, first: Path, package: str = "src/my_bot") -> Path:
    """Make what `colcon build --symlink-install` leaves, built when the workspace was another folder."""
    links = {
        f"install/my_bot/{MARKER}": first / "build/my_bot/resource/my_bot",
        "build/my_bot/resource/my_bot": first / package / "resource/my_bot",
        "build/my_bot/setup.py": first / package / "setup.py",
    }
    for name, target in links.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(target)
    (root / "install/setup.sh").write_text(f"_colcon_prefix_chain_sh_COLCON_CURRENT_PREFIX={first}/install\n")
    (root / "install/setup.bash").touch()
    return root


@pytest.mark.parametrize("first", ["/home/other/ws", "HERE/old", "HERE-of-before"])
def test_a_workspace_that_was_built_elsewhere_is_built_anew(tmp_path: Path, first: str) -> None:
    root = Files.right(NAMES[1]).write(tmp_path / "ws")
    linked(root, Path(first.replace("HERE", str(root))))
    failed = f"$ colcon build\n--- stderr: my_bot\npython3: can't open file '{root}/build/my_bot/setup.py': [Errno 2] No such file or directory\n---\nFailed   <<< my_bot [0.5s, exited with code 2]\n"
    for found in (of_workspace(root)[0], of_text(NOT_FOUND, root)[0], of_text(failed, root)[0]):
        assert found.code == "link-stale"
        assert "The workspace was built in " in found.cause
        assert found.fix == AGAIN


def test_a_package_that_was_moved_within_src_is_built_anew(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    linked(root, root, "src/bots/my_bot")
    for found in (of_workspace(root)[0], of_text(NOT_FOUND, root)[0]):
        assert found.code == "link-stale"
        assert found.fix.startswith(
            "rm -r build/my_bot install/my_bot, then colcon build --packages-select my_bot"
        )


def test_links_that_lead_to_the_sources_are_right(tmp_path: Path) -> None:
    root = linked(Files.right(NAMES[1]).write(tmp_path), tmp_path)
    assert not [found for found in of_workspace(root) if found.code in ("link-stale", "not-built")]


def test_what_was_never_built_stays_not_built(tmp_path: Path) -> None:
    root = Files.right(NAMES[1]).write(tmp_path)
    (root / "install").mkdir()
    (root / "install/setup.bash").touch()
    assert of_workspace(root)[0].code == of_text(NOT_FOUND, root)[0].code == "not-built"
