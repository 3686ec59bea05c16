"""What the extension of colcon writes down, and that it keeps out of the way."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ros2lab import colcon_record
from ros2lab.colcon_record import Record, read_record


class TestExtension:
    """colcon loads the extension, which does nothing unless it is told where to write."""

    def colcon(self, folder: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        environ = {name: value for name, value in os.environ.items() if name != colcon_record.VARIABLE}
        colcon = str(Path(sys.executable).with_name("colcon"))
        return subprocess.run(
            [colcon, *arguments],
            cwd=folder,
            env=environ | variables,
            capture_output=True,
            text=True,
            check=False,
        )

    def test_without_the_variable_it_is_not_there(self, tmp_path: Path) -> None:
        """Neither colcon's output nor its help has a trace of it, and no file is made."""
        listed = self.colcon(tmp_path, "--log-base", os.devnull, "list")
        assert (listed.returncode, listed.stdout, listed.stderr) == (0, "", "")
        assert "ros2lab_record" not in self.colcon(tmp_path, "build", "--help").stdout
        assert [*tmp_path.iterdir()] == []

    def test_its_import_loads_nothing_of_the_lab(self) -> None:
        code = "import sys, ros2lab.colcon_extension\nprint(*sorted(n for n in sys.modules if n.startswith('ros2lab')))"
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        assert said.split() == ["ros2lab", "ros2lab.colcon_extension"]

    def test_both_sides_name_the_same_variable(self) -> None:
        code = "from ros2lab.colcon_extension import VARIABLE\nprint(VARIABLE)"
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        assert said.strip() == colcon_record.VARIABLE

    def test_nothing_found(self, tmp_path: Path) -> None:
        """A folder without packages is told from a run of which nothing is known."""
        path = tmp_path / "record"
        self.colcon(tmp_path, "--log-base", os.devnull, "list", **{colcon_record.VARIABLE: str(path)})
        assert read_record(path.read_text()) == Record(is_begun=True, packages=[])

    @pytest.mark.parametrize(
        ("path", "words", "shown"),
        [
            ("missing/record", ["--log-base", os.devnull, "list"], "pk\tpk\t(python)\n"),
            pytest.param("/dev/full", ["build"], "Summary: 1 package finished", marks=pytest.mark.thorough),
        ],
        ids=["that cannot be opened", "of a full disk"],
    )
    def test_a_record_that_cannot_be_written_is_one_warning(
        self, tmp_path: Path, path: str, words: list[str], shown: str
    ) -> None:
        """The work is done all the same."""
        (tmp_path / "pk").mkdir()
        (tmp_path / "pk" / "setup.py").write_text(
            "from setuptools import setup\nsetup(name='pk', version='1')\n"
        )
        done = self.colcon(tmp_path, *words, **{colcon_record.VARIABLE: path})
        assert done.returncode == 0
        assert shown in done.stdout
        (warning,) = [line for line in done.stderr.splitlines() if "record" in line]
        assert f"The record of this run cannot be written to {path}" in warning

    @pytest.mark.thorough
    def test_a_colcon_that_a_package_starts_records_nothing(self, tmp_path: Path) -> None:
        (tmp_path / "pk").mkdir()
        write = f"import os\nif {colcon_record.VARIABLE!r} in os.environ: raise SystemExit('inherited')\n"
        setup = "from setuptools import setup\nsetup(name='pk', version='1')\n"
        (tmp_path / "pk" / "setup.py").write_text(write + setup)
        path = tmp_path / "record"
        self.colcon(tmp_path, "build", **{colcon_record.VARIABLE: str(path)})
        assert read_record(path.read_text()).jobs["pk"].returncode == 0

    @pytest.mark.parametrize(
        ("imports", "spared"),
        [
            ("from setuptools import setup", 1),
            pytest.param("import setuptools\nsetup = setuptools.setup", 1, marks=pytest.mark.thorough),
            pytest.param(
                "try:\n    from setuptools import setup\nexcept ImportError:\n    from distutils.core import setup",
                1,
                marks=pytest.mark.thorough,
            ),
            ("# setuptools has it, too\nfrom distutils.core import setup", 0),
        ],
    )
    def test_a_setup_script_is_not_started_to_list_what_is_known(
        self, tmp_path: Path, imports: str, spared: int
    ) -> None:
        """What colcon learns and builds is the same; only where nobody knows which commands there are, they are listed."""
        (tmp_path / "pk").mkdir()
        count = f"open({str(tmp_path / 'starts')!r}, 'a').write('x')\n"
        (tmp_path / "pk" / "setup.py").write_text(
            f"{imports}\n{count}setup(name='pk', version='1', py_modules=['one'])\n"
        )
        (tmp_path / "pk" / "one.py").touch()
        installed, starts = [], []
        for variables in ({}, {colcon_record.VARIABLE: str(tmp_path / "record")}):
            bases = [f"--{base}-base={tmp_path / base}{len(installed)}" for base in ("build", "install")]
            (tmp_path / "starts").unlink(missing_ok=True)
            self.colcon(tmp_path, "--log-base", os.devnull, "build", *bases, **variables)
            root = tmp_path / f"install{len(installed)}"
            names = {str(path.relative_to(root)) for path in root.rglob("*") if "egg" not in path.suffix}
            installed.append(sorted(names))
            starts.append(len((tmp_path / "starts").read_text()))
        assert "pk/lib" in installed[0]
        assert installed[0] == installed[1]
        assert starts[0] - starts[1] == spared
