"""The real colcon builds real workspaces; what it does and what it only pretends to do is told apart."""

from __future__ import annotations

import datetime
import io
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from deadlines import DEADLINE
from ros2lab.workspace import Workspace, WorkspaceError

PACKAGE_XML = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.1</version>
  <description>A package of the tests.</description>
  <maintainer email="robot@example.org">Robot</maintainer>
  <license>Apache-2.0</license>
  {depends}
  <export><build_type>ament_python</build_type></export>
</package>
"""
SETUP_CFG = "[develop]\nscript_dir=$base/lib/{name}\n[install]\ninstall_scripts=$base/lib/{name}\n"
SETUP_PY = """from setuptools import setup
setup(
    name='{name}',
    version='0.0.1',
    packages=['{name}'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/{name}']),
        ('share/{name}', ['package.xml']),
    ],
    entry_points={{'console_scripts': ['hello = {name}.hello:main']}},
    extras_require={{'test': ['pytest']}},
)
"""
HELLO = "def main():\n    print('hello from {name}')\n"


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    """An empty workspace."""
    return Workspace(tmp_path / "ws").create()


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for what is built once; it knows its path, so every test works at the same one."""
    return tmp_path_factory.mktemp("kept")


@pytest.fixture
def built(kept: Path) -> Workspace:
    """A workspace with one package, after `colcon build`."""
    workspace, copy = Workspace(kept / "ws"), kept / "copy"
    if copy.exists():
        shutil.rmtree(workspace.path)
        shutil.copytree(copy, workspace.path, symlinks=True)
    else:
        add_package(workspace.create())
        assert workspace.build(show=False).is_ok
        shutil.copytree(workspace.path, copy, symlinks=True)
    return workspace


def add_package(workspace: Workspace, name: str = "pk", *, below: str = "", depends: str = "") -> Path:
    """Write an ament_python package with one executable, `hello`; return its folder."""
    folder = workspace.path / "src" / below / name
    for part in (name, "resource"):
        (folder / part).mkdir(parents=True)
    (folder / "resource" / name).touch()
    (folder / name / "__init__.py").touch()
    (folder / name / "hello.py").write_text(HELLO.format(name=name))
    depend = f"<depend>{depends}</depend>" if depends else ""
    (folder / "package.xml").write_text(PACKAGE_XML.format(name=name, depends=depend))
    (folder / "setup.cfg").write_text(SETUP_CFG.format(name=name))
    (folder / "setup.py").write_text(SETUP_PY.format(name=name))
    return folder


def replace(path: Path, old: str, new: str) -> None:
    """Change a file's text, which must hold `old`."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def output_of(workspace: Workspace, executable: str = "hello", package: str | None = None) -> str:
    """Run an executable in the overlay and return what it prints."""
    (found,) = (one for one in workspace.executables(package) if one.name == executable)
    finished = subprocess.run(
        [found.path], env=workspace.overlay, capture_output=True, text=True, check=False
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout.strip()


class TestCreate:
    """A workspace is made without harm to what is there."""

    def test_twice(self, tmp_path: Path) -> None:
        """Making it again changes nothing, and gives the same workspace."""
        workspace = Workspace(tmp_path / "a" / "ws").create()
        notes = workspace.path / "src" / "notes.txt"
        notes.write_text("mine")
        assert workspace.create() is workspace
        assert notes.read_text() == "mine"

    def test_relative_path(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """A workspace stays where it is when the working folder changes."""
        monkeypatch.chdir(tmp_path)
        workspace = Workspace("ws").create()
        monkeypatch.chdir("/")
        assert workspace.path == tmp_path / "ws"

    @pytest.mark.parametrize("in_the_way", ["ws", "ws/src"])
    def test_a_file_in_the_way(self, tmp_path: Path, in_the_way: str) -> None:
        """A file where a folder should be is named, for every verb."""
        path = tmp_path / in_the_way
        path.parent.mkdir(exist_ok=True)
        path.touch()
        workspace = Workspace(tmp_path / "ws")
        with pytest.raises(WorkspaceError, match="file is in the way"):
            workspace.create()
        with pytest.raises(WorkspaceError, match=r"is a file|no src folder"):
            workspace.build()

    def test_no_source_folder(self, tmp_path: Path) -> None:
        """A folder that is no workspace is not built."""
        for verb in (Workspace(tmp_path).build, Workspace(tmp_path).test, Workspace(tmp_path).packages):
            with pytest.raises(WorkspaceError, match=r"There is no src folder in .*create"):
                verb()

    @pytest.mark.parametrize("verb", ["create", "build"])
    def test_a_folder_that_cannot_be_written(self, workspace: Workspace, verb: str) -> None:
        """What root may always do is taken from root first."""
        add_package(workspace)
        path = workspace.path if verb == "build" else workspace.path / "new"
        code = (
            "import sys; from ros2lab.workspace import *\n"
            f"try: Workspace(sys.argv[1]).{verb}()\n"
            "except WorkspaceError as error: print(error)"
        )
        powerless = ["setpriv", "--bounding-set=-all"] if os.geteuid() == 0 else []
        workspace.path.chmod(0o555)
        finished = subprocess.run(
            [*powerless, sys.executable, "-c", code, path], capture_output=True, text=True, check=False
        )
        workspace.path.chmod(0o755)
        assert "cannot be written (Permission denied)" in finished.stdout, finished.stderr
        assert len(finished.stdout.splitlines()) == 1

    def test_results_of_another_user(self, workspace: Workspace) -> None:
        """After `sudo colcon build`, the folder that is root's is named."""
        (workspace.path / "install").mkdir()
        (workspace.path / "install").chmod(0o555)
        code = (
            "import sys; from ros2lab.workspace import *\n"
            "try: Workspace(sys.argv[1]).build()\nexcept WorkspaceError as error: print(error)"
        )
        powerless = ["setpriv", "--bounding-set=-all"] if os.geteuid() == 0 else []
        finished = subprocess.run(
            [*powerless, sys.executable, "-c", code, workspace.path],
            capture_output=True,
            text=True,
            check=False,
        )
        assert f"{workspace.path / 'install'} cannot be written" in finished.stdout, finished.stderr

    def test_no_colcon(self, workspace: Workspace, tmp_path: Path) -> None:
        """Where colcon is not installed, a sentence says what to type."""
        add_package(workspace)
        python = tmp_path / "bare" / "bin" / "python"
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "bare"], check=True)
        paths = os.pathsep.join(path for path in sys.path if path)
        code = (
            "import sys; from ros2lab.workspace import *\n"
            "try: Workspace(sys.argv[1]).build()\nexcept WorkspaceError as error: print(error)"
        )
        finished = subprocess.run(
            [python, "-c", code, workspace.path],
            env={**os.environ, "PATH": "/usr/bin:/bin", "PYTHONPATH": paths},
            capture_output=True,
            text=True,
            check=False,
        )
        assert finished.stdout == "The command colcon is not installed; run `make lab`.\n", finished.stderr

    @pytest.mark.parametrize("name", ['say "ws"', "$HOME", "`ls`", "a:b", "{x}"])
    def test_names_that_colcon_cannot_live_with(self, tmp_path: Path, name: str) -> None:
        """Such a folder is refused before colcon builds elsewhere or bash runs a piece of its name."""
        with pytest.raises(WorkspaceError, match=r"which colcon's setup\.bash cannot live with"):
            Workspace(tmp_path / name)


class TestBuild:
    """Right answers in many styles are built and can be run."""

    def test_a_package(self, workspace: Workspace) -> None:
        """An ament_python package is built, listed, and runs in the overlay."""
        folder = add_package(workspace)
        result = workspace.build(show=False)
        assert result.is_ok
        assert repr(result) == "colcon build: 1 of 1 package built\n  pk  built"
        assert 0 < result.packages[0].seconds <= result.seconds
        (package,) = workspace.packages()
        assert (package.name, package.path, package.build_type) == ("pk", folder, "ament_python")
        assert package.problem is None
        (executable,) = workspace.executables()
        assert executable.path == workspace.path / "install/pk/lib/pk/hello"
        assert output_of(workspace) == "hello from pk"
        assert workspace.executables("other") == []

    @pytest.mark.parametrize(
        "name",
        [
            "Grüße ☃; it's a & b (1)",
            *(
                pytest.param(name, marks=pytest.mark.thorough)
                for name in ("with blank", "it's", "tab\tnew\nline")
            ),
        ],
    )
    def test_names_of_workspaces(self, tmp_path: Path, name: str) -> None:
        """Blanks, quotes, non-ASCII letters and the like in the path do no harm."""
        workspace = Workspace(tmp_path / name).create()
        add_package(workspace)
        result = workspace.build(show=False)
        assert result.is_ok, result
        assert output_of(workspace) == "hello from pk"

    @pytest.mark.thorough
    def test_packages_that_depend_on_each_other(self, workspace: Workspace) -> None:
        """They are built in order, in sub-folders too; a part can be chosen."""
        add_package(workspace, "arm", below="robots/one", depends="base")
        add_package(workspace, "base", below="robots")
        add_package(workspace, "other")
        result = workspace.build(up_to="arm", show=False)
        assert result.is_ok
        assert [one.name for one in result.packages] == ["base", "arm"]
        assert {one.package for one in workspace.executables()} == {"base", "arm"}
        result = workspace.build(["other"], show=False)
        assert [one.name for one in result.packages] == ["other"]
        assert output_of(workspace, package="arm") == "hello from arm"
        assert output_of(workspace, package="other") == "hello from other"
        with pytest.raises(
            WorkspaceError, match=r"There is no package 'nope' in .*colcon finds: arm, base, other"
        ):
            workspace.build(["arm", "nope"])

    def test_a_package_that_colcon_is_told_to_ignore(self, workspace: Workspace) -> None:
        """It lies where it should, and is not there."""
        (add_package(workspace) / "COLCON_IGNORE").touch()
        for work in (workspace.build, workspace.test):
            with pytest.raises(WorkspaceError, match=r"There is no package 'pk' in .*colcon finds: none"):
                work("pk", show=False)
            (workspace.path / "install").mkdir(exist_ok=True)
            (workspace.path / "install" / "setup.bash").touch()

    @pytest.mark.thorough
    def test_a_linked_package(self, workspace: Workspace, tmp_path: Path) -> None:
        """A package that is a link to another folder is built, as the reference workspace does it."""
        elsewhere = Workspace(tmp_path / "elsewhere").create()
        folder = add_package(elsewhere)
        (workspace.path / "src" / "pk").symlink_to(os.path.relpath(folder, workspace.path / "src"))
        assert workspace.build(show=False).is_ok
        assert output_of(workspace) == "hello from pk"

    @pytest.mark.thorough
    def test_symlink_install(self, workspace: Workspace) -> None:
        """An edit is seen without a new build; building without links afterwards works too."""
        folder = add_package(workspace)
        assert workspace.build(symlink=True, show=False).is_ok
        replace(folder / "pk" / "hello.py", "hello", "good morning")
        assert output_of(workspace) == "good morning from pk"
        assert workspace.build(show=False).is_ok
        replace(folder / "pk" / "hello.py", "morning", "evening")
        assert output_of(workspace) == "good morning from pk"

    @pytest.mark.thorough
    def test_a_plain_python_package(self, workspace: Workspace) -> None:
        """A package without package.xml is built as what it is, and is not blamed for it."""
        folder = add_package(workspace)
        for name in ("package.xml", "setup.cfg"):
            (folder / name).unlink()
        replace(folder / "setup.py", "('share/pk', ['package.xml']),", "")
        result = workspace.build(show=False)
        assert result.is_ok
        assert result.packages[0].warnings == ()
        assert workspace.packages()[0].build_type == "python"
        assert "pk" in workspace.overlay["PYTHONPATH"]

    @pytest.mark.thorough
    def test_merged_install(self, workspace: Workspace) -> None:
        """A workspace whose own defaults merge the packages is read as well."""
        (workspace.path / "colcon_defaults.yaml").write_text("build:\n  merge-install: true\n")
        add_package(workspace)
        assert workspace.build(show=False).is_ok
        assert [(one.package, one.name) for one in workspace.executables()] == [("pk", "hello")]
        assert output_of(workspace) == "hello from pk"

    @pytest.mark.thorough
    def test_results_that_came_in_a_zip(self, workspace: Workspace) -> None:
        """Where somebody else's `log` was unpacked, colcon's links are folders and stay so; nothing is lost."""
        add_package(workspace)
        for name in ("latest_build", "latest", "build_2020-01-01_00-00-00"):
            (workspace.path / "log" / name).mkdir(parents=True)
        assert workspace.build(show=False).is_ok

    def test_no_package_chosen(self, workspace: Workspace) -> None:
        """An empty choice does not mean all, nor that there is no package."""
        add_package(workspace)
        assert repr(workspace.build([], show=False)) == (
            "colcon build: nothing was built: no package was chosen"
        )
        assert workspace.executables() == []

    @pytest.mark.thorough  # as TestLastBuild
    def test_building_again_after_a_repair(self, workspace: Workspace) -> None:
        """A fixed package builds in the same workspace, and no complaint stays."""
        folder = add_package(workspace)
        (folder / "setup.cfg").rename(folder / "away")
        assert workspace.build(show=False).packages[0].warnings != ()
        (folder / "away").rename(folder / "setup.cfg")
        (folder / "resource" / "pk").unlink()
        assert not workspace.build(show=False).is_ok
        (folder / "resource" / "pk").touch()
        result = workspace.build(show=False)
        assert result.is_ok
        assert result.packages[0].warnings == ()


class TestFailures:
    """The first real error is found, wherever colcon has put it."""

    @pytest.mark.parametrize(
        ("file", "old", "new", "error"),
        [
            ("resource/pk", None, None, "error: can't copy 'resource/pk': doesn't exist or not a regular file"),
            ("setup.cfg", "[install]", "[install", "configparser."),
            ("setup.py", "'0.0.1',", "'0.0.1'", "SyntaxError: invalid syntax. Perhaps you forgot a comma? (setup.py, line 4)"),
            pytest.param("setup.py", "'0.0.1'", "os.name", "NameError: name 'os' is not defined", marks=pytest.mark.thorough),
            pytest.param("setup.py", "pk.hello:main'", "pk/hello:main()'", "error in pk setup command: Problems to parse EntryPoint(name='hello', value='pk/hello:main()'", marks=pytest.mark.thorough),
            ("setup.py", None, None, "there is no setup.py in src/pk"),
            ("package.xml", "ament_python", "ament_cmake", "CMake Error: The source directory " if shutil.which("cmake") else "RuntimeError: Could not find 'cmake' executable"),
            ("package.xml", "ament_python", "ament_pyton", "colcon knows no build type 'ament_pyton'; write <build_type>ament_python</build_type> in pk/package.xml"),
        ],
    )  # fmt: skip
    def test_error(
        self, workspace: Workspace, file: str, old: str | None, new: str | None, error: str
    ) -> None:
        """One thing is wrong with the package, and that is what is told."""
        path = add_package(workspace) / file
        if old is None or new is None:
            path.unlink()
        else:
            replace(path, old, new)
        result = workspace.build(show=False)
        assert not result.is_ok
        assert result.first_error is not None
        assert result.first_error.startswith(error)
        assert result.packages[0].error == result.first_error

    @pytest.mark.thorough
    def test_two_copies(self, workspace: Workspace) -> None:
        """A package that is there twice is named with both places."""
        folder = add_package(workspace)
        shutil.copytree(folder, folder.with_name("copy"))
        result = workspace.build(show=False)
        assert not result.is_ok
        assert result.first_error == "Duplicate package names not supported: pk: src/copy src/pk"

    def test_others_are_not_blamed(self, workspace: Workspace) -> None:
        """What was not built because of another package says so."""
        folder = add_package(workspace, "base")
        add_package(workspace, "arm", depends="base")
        (folder / "resource" / "base").unlink()
        result = workspace.build(show=False)
        assert result.returncode != 0
        assert [one.error for one in result.packages] == [
            "error: can't copy 'resource/base': doesn't exist or not a regular file",
            "colcon did not begin it because another package failed",
        ]

    @pytest.mark.thorough
    def test_another_layout(self, built: Workspace) -> None:
        """What colcon refuses before it looks at a package is told in its own words."""
        (built.path / "install" / ".colcon_install_layout").write_text("merged\n")
        result = built.build(show=False)
        assert not result.is_ok
        assert "layout" in str(result.first_error)

    @pytest.mark.parametrize("verb", ["build", pytest.param("test", marks=pytest.mark.thorough)])
    def test_settings_that_colcon_cannot_read(self, built: Workspace, verb: str) -> None:
        """A run that fails before it begins is not taken for the one before, nor for one without packages."""
        (built.path / "colcon_defaults.yaml").write_text(f"{verb}: [\n")
        result = getattr(built, verb)(show=False)
        assert not result.is_ok
        assert result.packages == ()
        assert str(result.first_error).startswith("yaml.parser.ParserError: while parsing")

    def test_colcon_that_does_not_begin(
        self, built: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """When no colcon can start, that is what is told, and not the build before."""
        (tmp_path / "colcon_core.py").write_text("raise ImportError('no colcon here')\n")
        monkeypatch.setenv("PYTHONPATH", str(tmp_path))
        with pytest.raises(WorkspaceError, match=r"colcon list failed in .*no colcon here"):
            built.build(show=False)

    @pytest.mark.thorough
    def test_colcon_without_the_extension(
        self, workspace: Workspace, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Where colcon cannot record what it does, nobody claims that there is no package."""
        add_package(workspace)
        groups = ("colcon_core.event_handler", "colcon_core.package_augmentation")
        monkeypatch.setenv(
            "COLCON_EXTENSION_BLOCKLIST", ":".join(f"{group}.ros2lab_record" for group in groups)
        )
        for ask in (workspace.packages, workspace.build):
            with pytest.raises(WorkspaceError, match=r"does not load ros2lab's extension.*run `make lab`"):
                ask()

    def test_killed_colcon(self, built: Workspace) -> None:
        """A build whose colcon was killed says so of itself and of each package, after one that went well."""
        setup = built.path / "src" / "pk" / "setup.py"
        # The parent of setup.py is colcon; it is killed while it builds and not when it looks at the package.
        kill = "import os, signal, sys\nif 'build' in sys.argv: os.kill(os.getppid(), signal.SIGKILL)\n"
        setup.write_text(kill + setup.read_text())
        result = built.build(show=False)
        assert not result.is_ok
        assert result.first_error == "colcon was ended by SIGKILL"
        assert [package.error for package in result.packages] == ["colcon was stopped while it built it"]

    @pytest.mark.thorough
    def test_a_build_in_the_second_of_another(self, workspace: Workspace) -> None:
        """Where colcon's log folder of this second is there already, a build is told of itself all the same."""
        marker = add_package(workspace) / "resource" / "pk"
        marker.unlink()
        now = datetime.datetime.now()
        for seconds in range(60):
            name = f"build_{now + datetime.timedelta(seconds=seconds):%Y-%m-%d_%H-%M-%S}"
            (workspace.path / "log" / name).mkdir(parents=True)
        for is_there in (False, True):
            marker.touch() if is_there else marker.unlink(missing_ok=True)
            assert workspace.build(show=False).is_ok == is_there


class TestMisleadingSuccess:
    """colcon ends with 0, and yet something is wrong."""

    @pytest.fixture(autouse=True)
    def no_bytecode(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Have Python told to compile nothing, which must not hide what compiling finds."""
        monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")

    @pytest.mark.parametrize("how", ["empty", "ignored"])
    def test_nothing_to_build(self, workspace: Workspace, how: str) -> None:
        """Without a package that colcon may see, nothing was built."""
        if how == "ignored":
            (add_package(workspace) / "COLCON_IGNORE").touch()
        result = workspace.build(show=False)
        assert result.returncode == 0
        assert not result.is_ok
        assert result.first_error == "nothing was built: colcon finds no package"

    @pytest.mark.parametrize(
        ("file", "old", "new", "warning"),
        [
            ("package.xml", "</package>", "", "package.xml is not valid, so that colcon takes it for a plain Python package: The manifest contains invalid XML"),
            pytest.param("package.xml", "robot@example.org", "robot", 'package.xml is not valid, so that colcon takes it for a plain Python package: Invalid email "robot"', marks=pytest.mark.thorough),
            pytest.param("setup.cfg", "script_dir", "script-dir", "Invalid dash-separated options: Usage of dash-separated 'script-dir' will not be supported in future versions. Please use the underscore name 'script_dir' instead.", marks=pytest.mark.thorough),
            pytest.param("setup.cfg", "install_scripts=$base/lib/pk", "", "hello went to install/pk/bin, where `ros2 run` does not look", marks=pytest.mark.thorough),
            pytest.param("setup.py", "('share/pk', ['package.xml']),", "", "Package 'pk' doesn't explicitly install the 'package.xml' file", marks=pytest.mark.thorough),
            pytest.param("pk/hello.py", "main():", "main(:", "SyntaxError: invalid syntax (hello.py, line 1)", marks=pytest.mark.thorough),
            pytest.param("pk/hello.py", "    print", "print", "IndentationError: expected an indented block after function definition on line 1 (hello.py, line 2)", marks=pytest.mark.thorough),
        ],
    )  # fmt: skip
    def test_warning(self, workspace: Workspace, file: str, old: str, new: str, warning: str) -> None:
        """The package is built, and one line says what is wrong with it."""
        replace(add_package(workspace) / file, old, new)
        result = workspace.build(show=False)
        assert result.is_ok, result
        (told,) = result.packages[0].warnings
        assert told.startswith(warning)

    @pytest.mark.thorough
    def test_the_package_template_is_not_blamed(self, workspace: Workspace) -> None:
        """What `ros2 pkg create` writes gives no warning, though setuptools has one."""
        replace(
            add_package(workspace) / "setup.py",
            "extras_require={'test': ['pytest']}",
            "tests_require=['pytest']",
        )
        result = workspace.build(show=False)
        assert result.is_ok
        assert result.packages[0].warnings == ()


class TestLiveOutput:
    """What colcon prints is seen while it builds, without the noise."""

    def test_it_comes_while_colcon_works(
        self, workspace: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The package waits for its own announcement to have been printed; it would wait in vain otherwise."""
        seen = tmp_path / "seen"

        class Screen(io.StringIO):
            def write(self, text: str) -> int:
                if "Starting >>> pk" in text:
                    seen.touch()
                return super().write(text)

        wait = (
            f"import os, time\ndeadline = time.monotonic() + 60\nwhile not os.path.exists({str(seen)!r}):\n"
            "    assert time.monotonic() < deadline, 'never announced'\n    time.sleep(0.01)\n"
        )
        setup = add_package(workspace) / "setup.py"
        setup.write_text(wait + setup.read_text())
        screen = Screen()
        monkeypatch.setattr(sys, "stdout", screen)
        result = workspace.build()
        assert result.is_ok, result
        assert "Finished <<< pk" in screen.getvalue()
        assert "Summary: 1 package finished" in screen.getvalue()

    @pytest.mark.thorough
    def test_it_can_be_switched_off(self, workspace: Workspace, capfd: pytest.CaptureFixture[str]) -> None:
        add_package(workspace)
        workspace.build(show=False)
        assert capfd.readouterr() == ("", "")

    @pytest.mark.thorough
    def test_warnings_of_setuptools_do_not_drown_it(
        self, workspace: Workspace, capfd: pytest.CaptureFixture[str]
    ) -> None:
        """Sixty lines about a dash are one."""
        replace(add_package(workspace) / "setup.cfg", "script_dir", "script-dir")
        workspace.build()
        lines = capfd.readouterr().out.splitlines()
        assert sum("script-dir" in line for line in lines) == 1
        assert len(lines) < 10, lines


class TestLastBuild:
    """What went wrong in the last build, whoever has started it, is known afterwards."""

    def test_the_last_build_counts(self, built: Workspace) -> None:
        """A build that fails leaves the earlier install; one that succeeds makes good for it."""
        marker = built.path / "src" / "pk" / "resource" / "pk"
        marker.unlink()
        built.build(show=False)
        assert "hello from pk" in output_of(built)
        (said,) = built.failures().values()
        assert said.startswith("error: can't copy 'resource/pk'")
        marker.touch()
        built.build(show=False)
        assert built.failures() == {}

    def test_a_package_that_is_gone_is_not_blamed(self, workspace: Workspace) -> None:
        folder = add_package(workspace)
        (folder / "setup.py").unlink()
        workspace.build(show=False)
        assert workspace.failures() == {"pk": "there is no setup.py in src/pk"}
        shutil.rmtree(folder)
        assert workspace.failures() == {}


class TestInterrupt:
    """Ctrl-C ends colcon and all that it has started, and is Ctrl-C for the caller."""

    # Started by colcon through setup.py; it ignores what is asked of it politely.
    STUBBORN = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); time.sleep(600)"
    CODE = (
        "import sys; from ros2lab.workspace import Workspace\n"
        "try: Workspace(sys.argv[1]).build()\n"
        "except KeyboardInterrupt: print('interrupted')"
    )

    @pytest.mark.parametrize("presses", [1, pytest.param(2, marks=pytest.mark.thorough)])
    def test_nothing_is_left(self, workspace: Workspace, tmp_path: Path, presses: int) -> None:
        """Also a stubborn child in a session of its own is gone, and the workspace builds afterwards."""
        started = tmp_path / "started"
        setup = add_package(workspace) / "setup.py"
        text = setup.read_text()
        setup.write_text(
            "import pathlib, subprocess, sys, time\n"
            f"child = subprocess.Popen([sys.executable, '-c', {self.STUBBORN!r}], start_new_session=True)\n"
            f"path = pathlib.Path({str(started)!r})\n"
            "path.with_suffix('.new').write_text(str(child.pid))\n"
            "path.with_suffix('.new').rename(path)\n"
            f"time.sleep(600)\n{text}"
        )
        with subprocess.Popen(
            [sys.executable, "-c", self.CODE, workspace.path], stdout=subprocess.PIPE, text=True
        ) as script:
            wait_for(started.exists)
            family = psutil.Process(script.pid).children(recursive=True)
            assert int(started.read_text()) in [process.pid for process in family]
            script.send_signal(signal.SIGINT)
            for _ in range(presses - 1):
                wait_for(lambda: any(has_ended(one) for one in family))
                script.send_signal(signal.SIGINT)
            output, _ = script.communicate(timeout=DEADLINE)
        assert output.splitlines()[-1] == "interrupted"
        _, alive = psutil.wait_procs(family, timeout=DEADLINE)
        assert alive == []
        setup.write_text(text)
        assert workspace.build(show=False).is_ok


class TestOverlay:
    """The overlay is what bash has, whatever the environment was before."""

    def test_before_a_build(self, workspace: Workspace) -> None:
        with pytest.raises(WorkspaceError, match=r"setup.bash is missing; build the workspace first"):
            _ = workspace.overlay

    def test_odd_environment(self, built: Workspace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Values with newlines survive, a start-up file of bash is not read, and nothing is invented."""
        (tmp_path / "startup").write_text("export INTRUDER=1\n")
        monkeypatch.setenv("BASH_ENV", str(tmp_path / "startup"))
        monkeypatch.setenv("TWO_LINES", "one\ntwo=2")
        monkeypatch.setenv("EMPTY", "")
        monkeypatch.delenv("OLDPWD", raising=False)
        overlay = built.overlay
        assert overlay["TWO_LINES"] == "one\ntwo=2"
        assert overlay["EMPTY"] == ""
        assert "INTRUDER" not in overlay
        assert "OLDPWD" not in overlay
        assert overlay["AMENT_PREFIX_PATH"].split(":")[0] == str(built.path / "install" / "pk")
        assert overlay["ROS_DOMAIN_ID"] == os.environ["ROS_DOMAIN_ID"]

    def test_a_broken_file(self, built: Workspace) -> None:
        """A setup file that bash cannot read is named."""
        (built.path / "install" / "setup.bash").write_text("if then\n")
        with pytest.raises(WorkspaceError, match=r"bash cannot source .*syntax error.*build again"):
            _ = built.overlay


class TestTests:
    """`colcon test` is told by its reports and not by its return code."""

    @pytest.fixture(autouse=True)
    def no_pytest_around(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Let the package's pytest know nothing of this one, nor of its plugins, which take seconds."""
        for name in list(os.environ):
            if name.startswith("PYTEST_"):
                monkeypatch.delenv(name)
        monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")

    def test_verdicts(self, workspace: Workspace) -> None:
        """A passing, a failing and a package without tests, in one run; one asks for pytest as older templates do."""
        for name, test in (("good", "assert True"), ("bad", "assert 1 == 2, 'no robot'"), ("none", "")):
            folder = add_package(workspace, name)
            (folder / "test").mkdir()
            if test:
                (folder / "test" / "test_it.py").write_text(f"def test_it():\n    {test}\n")
        replace(
            workspace.path / "src/bad/setup.py",
            "extras_require={'test': ['pytest']}",
            "tests_require=['pytest']",
        )
        with pytest.raises(WorkspaceError, match="Nothing is built"):
            workspace.test()
        workspace.build(show=False)
        result = workspace.test(show=False)
        assert not result.is_ok
        assert {one.name: (one.is_ok, one.tests) for one in result.packages} == {
            "good": (True, 1),
            "bad": (False, 1),
            "none": (False, 0),
        }
        assert result.first_error is not None
        assert result.first_error.startswith("test_it: AssertionError: no robot")
        alone = workspace.test("good", show=False)
        assert alone.is_ok
        assert repr(alone) == "colcon test: 1 test run, 0 failed\n  good  passed"

    @pytest.mark.thorough
    def test_unittest(self, workspace: Workspace) -> None:
        """A package that does not ask for pytest is tested by unittest, which writes no report."""
        folder = add_package(workspace)
        replace(folder / "setup.py", "extras_require={'test': ['pytest']},", "")
        (folder / "test").mkdir()
        (folder / "test" / "__init__.py").touch()
        (folder / "test" / "test_it.py").write_text(
            "import unittest\nclass TestIt(unittest.TestCase):\n"
            "    def test_good(self): pass\n    def test_bad(self): self.assertEqual(1, 2)\n"
        )
        assert workspace.build(show=False).is_ok
        old = workspace.path / "build" / "pk" / "pytest.xml"
        old.write_text('<testsuite tests="1" failures="0"><testcase name="of last year"/></testsuite>')
        os.utime(old, (0, 0))
        result = workspace.test(show=False)
        assert not result.is_ok
        assert result.packages[0].tests == 2
        assert result.first_error is not None
        assert result.first_error.startswith("test_bad (")
        assert result.first_error.endswith("AssertionError: 1 != 2")


def wait_for(condition: Callable[[], bool], timeout: float = 60.0) -> None:
    """Wait until a condition holds; fail at the deadline."""
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline, "the deadline has passed"
        time.sleep(0.01)


def has_ended(process: psutil.Process) -> bool:
    """Return whether a process runs no more."""
    return not process.is_running() or process.status() == psutil.STATUS_ZOMBIE
