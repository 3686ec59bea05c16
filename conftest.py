"""What `pytest --nbval notebooks` needs: each lesson is run in a new student's folder, by a kernel of the lab.

Options of nbval that were given on the command line stay as they were given. For a notebook elsewhere:
`python -m pytest -p conftest --nbval PATH`, typed here.
"""

from __future__ import annotations

import os
import socket
import tempfile
from pathlib import Path

import pytest

from ros2lab import course, domain_lease, environment

ROOT = Path(__file__).resolve().parent
LESSONS = ROOT / "notebooks"
OUTPUT_TIMEOUT = 60  # s, for what a cell still prints after the kernel's answer; nbval has no option for it
# Of nbval: its own default, and ours.
OPTIONS = {
    "nbval_cell_timeout": (2000, 120),  # s
    "nbval_kernel_startup_timeout": (60, 300),  # s
    "nbval_sanitize_with": (None, str(ROOT / "tests" / "notebooks" / "sanitize.cfg")),
    "nbval_kernel_name": (None, "ros2lab"),
}


def pytest_addoption(parser: pytest.Parser) -> None:
    """Offer an option for the student's folder."""
    help_text = "the student's folder in which notebooks are run; without it, a new one for each"
    parser.addoption("--nbval-work", help=help_text)


def pytest_configure(config: pytest.Config) -> None:
    """Prepare for notebooks, if there will be any."""
    if not (config.getoption("nbval", False) or config.getoption("nbval_lax", False)):
        return
    if config.getoption("numprocesses", None):
        config.option.dist = "loadfile"  # one process has a notebook's kernel; each has a domain of its own
    else:
        config.pluginmanager.register(Lessons(config))


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out what lies among the lessons and is none of them, such as copies and what somebody wrote there."""
    is_stray = collection_path.parent == LESSONS and not course.LESSON_NAME.fullmatch(collection_path.name)
    return is_stray or None


class Lessons:
    """Has nbval run notebooks as the lab would."""

    def __init__(self, config: pytest.Config) -> None:
        for name, (default, ours) in OPTIONS.items():
            if getattr(config.option, name) == default:
                setattr(config.option, name, ours)
        self._cell_class = config.pluginmanager.get_plugin("nbval").IPyNbCell
        # nbval leaves files open.
        config.addinivalue_line("filterwarnings", "default::ResourceWarning")
        config.addinivalue_line("filterwarnings", "default::pytest.PytestUnraisableExceptionWarning")
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._lease = socket.socket(socket.AF_UNIX)
        self._given = config.option.nbval_work
        if "ROS_DOMAIN_ID" not in os.environ:  # nor do they meet the nodes of a lab that is open
            os.environ["ROS_DOMAIN_ID"] = str(domain_lease.leased(self._lease))
        os.environ.update(environment.lab_environment())
        os.environ.pop("PYTEST_ADDOPTS", None)  # the students' tests are not ours
        os.environ["JUPYTER_PATH"] = str(ROOT / "tests" / "notebooks" / "jupyter")

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Make a student's folder before a notebook's kernel starts, and be patient with its cells."""
        if not isinstance(item, self._cell_class):
            return
        item.output_timeout = OUTPUT_TIMEOUT
        if item.parent.kernel is None:
            self._remove_folder()
            self._folder = tempfile.TemporaryDirectory(prefix="ros2lab ", ignore_cleanup_errors=True)
            os.environ["ROS2LAB_WORK"] = self._given or self._folder.name

    def pytest_unconfigure(self) -> None:
        """Remove what was made."""
        self._remove_folder()
        self._lease.close()

    def _remove_folder(self) -> None:
        if self._folder is not None:
            self._folder.cleanup()
