"""What setuptools is told by another way than a plain call of setup() and a setup.cfg counts, and nothing else does."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import CFG, NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.look import Look
from ros2lab.diagnose.packaging import setup_run

CONFIGURED = """\
[options]
packages = PACKAGE
[options.entry_points]
console_scripts =
    MODULE = PACKAGE.MODULE:main
    LISTENER = PACKAGE.LISTENER:main
    DRIVER = PACKAGE.DRIVER:main
[options.data_files]
share/ament_index/resource_index/packages = resource/PACKAGE
share/PACKAGE = package.xml
share/PACKAGE/launch = launch/robot.launch.py
share/PACKAGE/config = config/robot.yaml
"""
CALLED = {
    "of an imported module": '__import__("setuptools").setup()',
    "by import_module": "from importlib import import_module\nimport_module('setuptools').setup()",
    "by getattr": "import setuptools\ngetattr(setuptools, 'setup')()",
    "by partial": "from functools import partial\nfrom setuptools import setup\npartial(setup, zip_safe=True)()",
    "in a file that is read": "exec(open('other.py').read())",
    "in a module beside it": "import other",
}
NOT_CALLED = {
    "other functions": "from setuptools import find_packages, setup\nfind_packages()",
    "in a function": "from setuptools import setup\ndef go():\n    setup()",
    "under a wrong name": "from setuptools import setup\nif __name__ == 'main':\n    setup()",
}
RIGHT, WRONG = "$base/lib/my_bot", "$base/lib/bot"
INSTALL = """\
from setuptools.command.install import install
class Install(install):
    def finalize_options(self):
        super().finalize_options()
        self.install_scripts = self.prefix + '/lib/my_bot'
"""
SET = {
    "options": f"options={{'install': {{'install_scripts': '{RIGHT}'}}}}",
    "made by dict": f"options={{'install': dict(install_scripts='{RIGHT}')}}",
    "unpacked": f"**{{'options': {{'install': {{'install_scripts': '{RIGHT}'}}}}}}",
    "a command of its own": "cmdclass={'install': Install}",
}


def told(files: Files, folder: Path) -> list[str]:
    return [finding.cause for finding in of_workspace(files.write(folder))]


@pytest.mark.parametrize("script", CALLED.values(), ids=CALLED)
def test_setup_may_be_called_in_any_way(tmp_path: Path, script: str) -> None:
    files = Files.right(NAMES[1]).put("setup.py", script).put("setup.cfg", f"{CFG}{CONFIGURED}")
    files.put("other.py", "from setuptools import setup\nsetup()\n")
    assert told(files, tmp_path) == []


@pytest.mark.parametrize("script", NOT_CALLED.values(), ids=NOT_CALLED)
def test_what_never_calls_setup_installs_nothing(tmp_path: Path, script: str) -> None:
    files = Files.right(NAMES[1]).put("setup.py", script)
    assert told(files, tmp_path) == ["setup.py never calls setup(), so nothing is installed."]


@pytest.mark.parametrize("config", [None, "[metadata]\nlicense = MIT\n"])
@pytest.mark.parametrize("given", SET.values(), ids=SET)
def test_the_folder_of_executables_may_be_set_anywhere(
    tmp_path: Path, given: str, config: str | None
) -> None:
    assert told(_set(given, config), tmp_path) == []


def test_a_wrong_folder_of_executables_is_named(tmp_path: Path) -> None:
    given = SET["options"].replace(RIGHT, WRONG)
    cause = "setup.cfg is missing, so the executables go into lib/bot, where `ros2 run` does not look."
    assert told(_set(given, None), tmp_path) == [cause]


def test_where_no_code_may_run_setup_is_only_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(setup_run, "_taken", None)
    for number, script in enumerate(one for one in CALLED.values() if "(" in one):
        root = Files.right(NAMES[1]).put("setup.py", script).write(tmp_path / str(number))
        causes = [finding.cause for finding in Look(root).findings]
        assert not any("setup()" in cause or "rules failed" in cause for cause in causes)


def _set(given: str, config: str | None) -> Files:
    files = Files.right(NAMES[1])
    files = files.change("setup.py", "setup(\n", f"setup(\n    {given},\n")
    files = files.change("setup.py", "from setuptools", f"{INSTALL}from setuptools")
    return files.put("setup.cfg", config) if config else files.remove("setup.cfg")
