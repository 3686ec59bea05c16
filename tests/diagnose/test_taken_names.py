"""Names that every node has, and the free names that are offered in their place."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace


@pytest.mark.parametrize(
    ("written", "fix"),
    [
        ("self._subscriptions = []", "write self.subscriptions_ instead,"),
        ("self._default_callback_group = None", "write self.default_callback_group_ instead,"),
        ("self._parameters = {}", "write self.parameters instead,"),
        ("self.parameters = []\n        self._parameters = {}", "write self.parameters_ instead,"),
        ("self.timers = []", "write self.timers_ instead of self.timers here"),
        ("self.timers_ = []\n        self.timers = []", "write self.timers__ instead of self.timers here"),
        ("self.count = 0\n\n    def clients(self):\n        pass", "rename it, for example to clients_,"),
        ("self.clients_ = 0\n\n    def clients(self):\n        pass", "rename it, for example to clients__,"),
    ],
)
def test_the_name_that_is_offered_is_free(tmp_path: Path, written: str, fix: str) -> None:
    files = Files.right(NAMES[0])
    path = files.path("node")
    files.texts[path] = files.texts[path].replace("self.count = 0", written)
    found = next(one for one in of_workspace(files.write(tmp_path)) if one.code == "node-property")
    assert found.fix.startswith(fix)


GRIP = "def grip():\n    return 1\n"
ASKED = "from my_bot.arm import grip\n\nprint(grip())\n"


def with_folder(inner: str, asked: str = ASKED, file: str = GRIP) -> Files:
    """Return a package with a file arm.py and a folder arm beside it, and a file that asks for what is in one."""
    files = Files.right(NAMES[1]).put("my_bot/asks.py", asked).put("my_bot/arm.py", file)
    return files.put("my_bot/arm/__init__.py", inner).put("my_bot/arm/inner.py", GRIP)


@pytest.mark.parametrize(
    ("inner", "asked"),
    [("", ASKED), ("LIMIT = 1\n", ASKED), ("", ASKED.replace("my_bot.arm", ".arm"))],
)
def test_a_file_that_a_folder_hides_is_given_another_name(tmp_path: Path, inner: str, asked: str) -> None:
    root = with_folder(inner, asked).write(tmp_path)
    (found,) = of_workspace(root)
    assert (found.code, found.place) == ("name-shadowed", "src/my_bot/my_bot/arm.py")
    assert "mv src/my_bot/my_bot/arm.py src/my_bot/my_bot/arm_node.py, write my_bot.arm_node" in found.fix
    assert "src/my_bot/my_bot/asks.py:1" in found.fix
    said = "ImportError: cannot import name 'grip' from 'my_bot.arm' (/w/my_bot/arm/__init__.py)"
    assert of_text(f"Traceback (most recent call last):\n{said}\n", root) == [found]


STARTED = """\
$ ros2 run my_bot talker
Traceback (most recent call last):
  File "/w/install/my_bot/lib/my_bot/talker", line 33, in <module>
    sys.exit(load_entry_point('my-bot==0.1.0', 'console_scripts', 'talker')())
  File "/w/install/my_bot/lib/my_bot/talker", line 25, in importlib_load_entry_point
    return next(matches).load()
AttributeError: module 'my_bot.talker' has no attribute 'main'
"""


def test_the_script_that_starts_a_hidden_program_is_not_the_place(tmp_path: Path) -> None:
    files = Files.right(NAMES[1])
    right = files.write(tmp_path / "right")
    assert "install" not in of_text(STARTED, right)[0].place
    (found,) = of_text(STARTED, files.put("my_bot/talker/__init__.py", "").write(tmp_path / "hidden"))
    assert (found.code, found.place) == ("name-shadowed", "src/my_bot/my_bot/talker.py")
    assert "my_bot.talker_node instead of my_bot.talker in src/my_bot/setup.py:" in found.fix


@pytest.mark.parametrize(
    "files",
    [
        with_folder("from .inner import grip\n"),
        with_folder("", "from my_bot.arm import inner\n\nprint(inner.grip())\n", "inner = 1\n"),
        with_folder("LIMIT = 1\n", "from my_bot.arm import LIMIT\n\nprint(LIMIT)\n"),
    ],
)
def test_a_file_of_which_nothing_is_asked_may_be_hidden(tmp_path: Path, files: Files) -> None:
    assert of_workspace(files.write(tmp_path)) == []


def test_a_folder_that_a_file_hides_is_given_another_name(tmp_path: Path) -> None:
    files = with_folder(
        "", "from my_bot.arm.inner import grip\nfrom my_bot import arm\n\nprint(grip(), arm)\n"
    )
    del files.texts[files.path("my_bot/arm/__init__.py")]
    (found,) = of_workspace(files.write(tmp_path))
    assert found.code == "init-file-missing"
    assert "mv src/my_bot/my_bot/arm src/my_bot/my_bot/arm_parts && touch" in found.fix
    assert "write my_bot.arm_parts instead of my_bot.arm" in found.fix
