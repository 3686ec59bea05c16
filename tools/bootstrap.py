"""Make `.venv` and install the course into it: `python3 tools/bootstrap.py student|instructor|hub|development`.

The Makefile calls it before everything else. Where everything is installed it does nothing, in a tenth of a
second. Only the standard library is used, and only the syntax of Python 3.6: an old Python must get its
sentence and not a SyntaxError.
"""
# ruff: noqa: UP006, UP035, UP045 -- what Python 3.6 does not have
# ruff: noqa: E402 -- what Ctrl-C does is said before the slow imports

import signal

# Ctrl-C ends this without a traceback while what follows is imported.
_interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)

import argparse
import contextlib
import errno
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

signal.signal(signal.SIGINT, _interrupt)

Version = Tuple[int, int]

ROOT = Path(__file__).resolve().parent.parent
THIS_PYTHON = sys.version_info[:2]
OLDEST, NEWEST = (3, 10), (3, 14)
PYTHON_OF_JAZZY = (3, 12)
OTHER_PYTHONS = ("python3.12", "python3.11", "python3.13", "python3.10", "python3.14")
GROUPS = {
    "student": ("student",),
    "instructor": ("student", "instructor"),
    "hub": ("student", "hub"),
    "development": ("student", "instructor", "development"),
}
# What a notebook and its server import: read once now, so that the first start is as quick as the second.
WARM_UP = (
    "jupyterlab.labapp",
    "ipykernel.kernelapp",
    "ipywidgets",
    "anywidget",
    "matplotlib.pyplot",
    "nbgrader.preprocessors",
    "typer",
    "ros2lab.grading.reading.reader",
)
# What runs in the grader's boxes, where no module can be stored compiled: it would be compiled each time.
IN_BOXES = ("argcomplete", "colcon_*", "distlib", "em.py", "notify2.py", "setuptools")
WHEELS_WARM_UP = (
    "rclpy.node",
    "rclpy.executors",
    "geometry_msgs.msg",
    "std_msgs.msg",
    "catkin_pkg.package",
)
# For bash and zsh; the domain differs from user to user, so it is asked for each time.
ACTIVATION = """\
# The course's settings (a ROS domain of your own, ...), wherever you have set none; and completion of ros2.
eval "$("$VIRTUAL_ENV/bin/python" -m ros2lab.environment)"
[ -z "${BASH_VERSION-}" ] || . "$VIRTUAL_ENV/../src/portable_ros2/src/portable_ros2/completion/ros2.bash"
[ -z "${ZSH_VERSION-}" ] || . "$VIRTUAL_ENV/../src/portable_ros2/src/portable_ros2/completion/ros2.zsh"
"""
STAMP, LOCK = "ros2lab.json", "ros2lab.lock"
NO_SPACE = ("no space left", "disk quota exceeded")
NO_NETWORK = (
    "connection",
    "dns error",
    "error sending request",
    "name resolution",
    "network is unreachable",
    "timed out",
)


class Stop(Exception):  # noqa: N818 -- it is the end of the run, by one sentence
    """One sentence for the person at the terminal: what is wrong, and what to do."""


class Content(NamedTuple):
    """What a `.venv` holds.

    Attributes:
        project: the folder of the project; the commands in `.venv` only work there.
        python: version of its Python, such as `3.12`.
        ros: `wheels`, or the folder of the installed ROS 2 that is used instead.
        locks: a hash of the lock files.
        groups: the groups of dependencies, in the order of `GROUPS`.
        metadata: a hash of the metadata of the projects that are installed as links.
    """

    project: str
    python: str
    ros: str
    locks: str
    groups: Tuple[str, ...]
    metadata: str


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Install, and return the exit code."""
    parser = argparse.ArgumentParser(description="Make .venv and install the course into it.")
    parser.add_argument("group", choices=list(GROUPS))
    parser.add_argument(
        "--this-python", action="store_true", help="use the Python that runs this, or refuse it"
    )
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        bootstrap(ROOT, options.group, options.this_python)
    except KeyboardInterrupt:
        _say("Interrupted: nothing is broken, the same command goes on from here.")
        return 130
    except Stop as stop:
        _say(stop)
        return 1
    except OSError as error:
        _say(os_sentence(ROOT, error))
        return 1
    return 0


def bootstrap(root: Path, group: str, is_chosen: bool) -> None:
    """Bring `root/.venv` to what `group` needs; leave it alone if it has that already.

    Args:
        root: the project.
        group: a key of `GROUPS`.
        is_chosen: whether the Python that runs this was asked for, and no other is to be used.

    Raises:
        Stop: if it cannot be done.
        OSError: if a file cannot be written.
    """
    check_machine(sys.platform, os.uname().machine, sys.maxsize)
    choose_python(root, is_chosen)
    installed = read_content(root)
    if installed is not None and installed == wanted_content(root, installed, group, is_chosen):
        return
    with locked(root / ".venv") as lock:
        installed = read_content(root)  # another one may have made it while this one waited
        wanted = wanted_content(root, installed, group, is_chosen)
        if installed != wanted:
            Installation(root, wanted, lock).run(is_update=can_update(installed, wanted))


# ---- what to do -----------------------------------------------------------------------------------------


def check_machine(platform: str, machine: str, largest_integer: int) -> None:
    """Raise Stop unless this is 64-bit Linux on an Intel or AMD processor."""
    if not platform.startswith("linux") or machine not in ("x86_64", "amd64") or largest_integer < 2**32:
        bits = 64 if largest_integer > 2**32 else 32
        raise Stop(
            f"The course needs x86-64 Linux and this is {bits}-bit Python on {machine} {platform}: "
            "use such a computer, or a virtual machine of that kind."
        )


def choose_python(root: Path, is_chosen: bool) -> None:
    """Return if the Python that runs this will do, or start this program anew with one that does.

    Raises:
        Stop: if there is none.
    """
    this = THIS_PYTHON
    is_supported = OLDEST <= this <= NEWEST
    if not is_chosen and not is_supported and read_content(root):
        _start_again([str(root / ".venv" / "bin" / "python")])
    if not is_chosen and not (is_supported and has_venv()):
        _start_again([path for path, _ in other_pythons(os.environ)])
    if not is_supported:
        raise Stop(version_sentence(this))
    if not is_chosen and choose_ros(root, this) == "wheels" != choose_ros(root, PYTHON_OF_JAZZY):
        _start_again([path for path, version in other_pythons(os.environ) if version == PYTHON_OF_JAZZY])


def wanted_content(root: Path, installed: Optional[Content], group: str, is_chosen: bool) -> Content:
    """Say what `.venv` has to hold. Installed groups stay, and so does its Python if that fits."""
    this = THIS_PYTHON
    ros = choose_ros(root, this)
    groups = set(GROUPS[group])
    if installed is not None:
        groups |= set(installed.groups)
        if not is_chosen and ros == "wheels" == choose_ros(root, _parsed(installed.python)):
            this = _parsed(installed.python)
    ordered = tuple(name for name in GROUPS if name in groups)
    locks = hash_of(*sorted((root / "locks").glob("*.txt")))
    metadata = hash_of(*(project / "pyproject.toml" for project in projects(root)))
    return Content(str(root), _dotted(this), ros, locks, ordered, metadata)


def can_update(installed: Optional[Content], wanted: Content) -> bool:
    """Return whether `.venv` becomes what is wanted by installing more into it; otherwise it is made anew.

    Nothing is ever taken out: inside ROS's wheels are traces of other packages (`rclpy` in `ros-rclpy`),
    and an installer that removes what no lock file names removes ROS.
    """
    return installed is not None and installed[:4] == wanted[:4]


def choose_ros(root: Path, version: Version) -> str:
    """Return `wheels`, or the folder of the installed ROS 2 that a Python of this version will use."""
    sys.path.insert(0, str(root / "src"))
    try:
        from ros2lab.environment import find_ros  # noqa: PLC0415 -- unreadable for an old Python
    finally:
        sys.path.pop(0)
    source = find_ros(os.environ, version, has_wheels=True)
    return str(source.prefix) if source.kind == "installed" else "wheels"


def projects(root: Path) -> List[Path]:
    """List the folders of the projects that are installed as links: the `ros2` command, and the course."""
    return [root / "src" / "portable_ros2", root]


def hash_of(*paths: Path) -> str:
    """Return a hash of the names and contents of files."""
    result = hashlib.sha256()
    for path in paths:
        result.update(path.name.encode() + b"\0" + path.read_bytes())
    return result.hexdigest()


# ---- which Python ---------------------------------------------------------------------------------------


def has_venv() -> bool:
    """Return whether the Python that runs this can make a .venv with pip in it. Debian takes that out."""
    return all(importlib.util.find_spec(name) for name in ("venv", "ensurepip"))


def other_pythons(environ: Mapping[str, str]) -> Iterator[Tuple[str, Version]]:
    """Yield the Pythons on PATH that will do, the preferred one first."""
    for name in OTHER_PYTHONS:
        path = shutil.which(name, path=environ.get("PATH"))
        version = ask_version(path, "venv, ensurepip") if path else None
        if path and version and OLDEST <= version <= NEWEST:
            yield path, version


def ask_version(python: str, modules: str = "sys") -> Optional[Version]:
    """Return the version of a Python that has `modules`; None if it does not run.

    A file of that name says nothing: pyenv puts one there for versions that it will not start, and the
    Python of a .venv goes when the system moves to a newer one.
    """
    code = f"import sys, {modules}; print(*sys.version_info[:2], sep='.')"
    try:
        answer = subprocess.run(
            [python, "-I", "-S", "-c", code],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            check=True,
            timeout=20,
        )
        return _parsed(answer.stdout.decode().strip())
    except (OSError, ValueError, subprocess.SubprocessError):
        return None


def version_sentence(version: Version) -> str:
    """Say that a Python will not do."""
    age = "old" if version < OLDEST else "new"
    return (
        f"Python {_dotted(version)} is too {age}: install one from {_dotted(OLDEST)} to {_dotted(NEWEST)} "
        "and give its name, for example `make lab PYTHON=python3.12`."
    )


def venv_sentence(version: Version, system_version: Optional[Version], is_debian: bool) -> str:
    """Say how to get the missing venv and ensurepip."""
    name = _dotted(version)
    if not is_debian:
        return f"Python {name} lacks venv or pip: install your system's package for them and run this again."
    package = "python3-venv" if version == system_version else f"python{name}-venv"
    return f"Python {name} lacks venv: type `sudo apt install {package}` and run this again."


def _start_again(pythons: Sequence[str]) -> None:
    """Run this program with the first of these Pythons instead, if there is one."""
    if pythons:
        os.execv(pythons[0], [pythons[0], str(Path(__file__).resolve()), *sys.argv[1:]])  # noqa: S606


# ---- the .venv ------------------------------------------------------------------------------------------


def read_content(root: Path) -> Optional[Content]:
    """Return what `root/.venv` holds; None if it is not there, half made, moved, or its Python has gone."""
    venv = root / ".venv"
    try:
        fields = json.loads((venv / STAMP).read_text(encoding="utf-8"))
        content = Content(**dict(fields, groups=tuple(fields["groups"])))
    except (OSError, ValueError, KeyError, TypeError):
        return None
    version = ask_version(str(venv / "bin" / "python"))
    is_whole = content.project == str(root) and version is not None and _dotted(version) == content.python
    return content if is_whole else None


def write_content(venv: Path, content: Content) -> None:
    """Write what `.venv` holds, at once and whole."""
    part = venv / (STAMP + ".part")
    part.write_text(json.dumps(content._asdict(), indent=1), encoding="utf-8")
    part.replace(venv / STAMP)


@contextlib.contextmanager
def locked(venv: Path) -> Iterator[int]:
    """Hold the `.venv` that is to be made, against another one that makes it; yield the lock.

    The file of the lock is also the mark by which a half-made `.venv` is known as ours.

    Raises:
        Stop: if there is a `.venv` that somebody else has made.
    """
    import fcntl  # noqa: PLC0415 -- check_machine has a sentence for systems without it

    mark = venv / LOCK
    if os.path.lexists(str(venv)) and not mark.exists() and not is_empty(venv):
        raise Stop(
            f"{venv} was not made by this course's installer: move it away "
            f"(mv '{venv}' '{venv}.old') and run this again."
        )
    venv.mkdir(exist_ok=True)
    with mark.open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            _say(f"Another installation into {venv} is under way: waiting for it.")
            fcntl.flock(file, fcntl.LOCK_EX)
        yield file.fileno()


def is_empty(folder: Path) -> bool:
    """Return whether this is a folder with nothing in it."""
    return folder.is_dir() and not any(folder.iterdir())


class Installation:
    """One run of the installer. Every step is a program whose output goes to a log file."""

    def __init__(self, root: Path, wanted: Content, lock: int) -> None:
        self.root = root
        self.wanted = wanted
        self.lock = lock
        self.venv = root / ".venv"
        self.python = str(self.venv / "bin" / "python")
        self.uv = self.venv / "bin" / "uv"
        self.log = self.venv / "install.log"

    def run(self, *, is_update: bool) -> None:
        """Install what is wanted.

        Raises:
            Stop: if a step fails.
        """
        start = time.monotonic()
        self.log.write_bytes(b"")
        if is_update:
            (self.venv / STAMP).unlink()
        else:
            self.make_venv()
        self.install_packages()
        self.install_project()
        self.extend_activation()
        imports = ", ".join(WARM_UP + (WHEELS_WARM_UP if self.wanted.ros == "wheels" else ()))
        self.step("Preparing the first start", [self.python, "-c", "import " + imports])
        self.compile_for_boxes()
        write_content(self.venv, self.wanted)
        _say(f"Installed in {time.monotonic() - start:.0f} s.")

    def make_venv(self) -> None:
        """Make an empty `.venv` with pip."""
        if not has_venv():
            is_debian = Path("/etc/debian_version").exists()
            raise Stop(venv_sentence(THIS_PYTHON, ask_version("/usr/bin/python3"), is_debian))
        for path in self.venv.iterdir():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(str(path))
            elif path.name not in (LOCK, self.log.name):
                path.unlink()
        # The Python of the .venv itself has just gone; it runs this if somebody has activated it.
        python = getattr(sys, "_base_executable", None) or sys.executable
        command = [python, "-I", "-m", "venv", "--prompt", "ros2lab", str(self.venv)]
        if not self.step(f"Making .venv with Python {self.wanted.python}", command):
            raise self.failure()

    def install_packages(self) -> None:
        """Install the locked packages: with uv, or else with pip, which takes ten times as long."""
        folder = self.root / "locks"
        names = [*self.wanted.groups, *(["ros"] if self.wanted.ros == "wheels" else [])]
        options = ["install", "--require-hashes", "--no-deps"]  # the lock files are complete
        locks = [part for name in names for part in ("-r", str(folder / f"{name}.txt"))]
        pip = [self.python, "-I", "-m", "pip", *options]
        uv = [str(self.uv), "pip", *options, "--python", self.python]
        text = f"Installing the packages for {self.wanted.groups[-1]}"
        has_uv = self.uv.exists() or self.step(
            "Fetching the installer uv", [*pip, "-r", str(folder / "uv.txt")]
        )
        if has_uv and self.step(text, [*uv, *locks]):
            return
        if not self.step(text + " with pip, which takes minutes", [*pip, *locks]):
            raise self.failure()

    def install_project(self) -> None:
        """Install the project itself, as a link to its sources."""
        links = [part for project in projects(self.root) for part in ("-e", str(project))]
        options = ["--no-deps", "--no-build-isolation", *links]
        uv = [str(self.uv), "pip", "install", "--python", self.python, *options]
        pip = [self.python, "-I", "-m", "pip", "install", *options]
        text = "Installing the course"
        if not (self.uv.exists() and self.step(text, uv)) and not self.step(text, pip):
            raise self.failure()

    def extend_activation(self) -> None:
        """Let `source .venv/bin/activate` give a shell what the lab's own terminals have."""
        path = self.venv / "bin" / "activate"
        text = path.read_text(encoding="utf-8")
        if ACTIVATION not in text:
            path.write_text(text.rstrip("\n") + "\n\n" + ACTIVATION, encoding="utf-8")

    def compile_for_boxes(self) -> None:
        """Compile what the grader's boxes run."""
        folders = ("bin", "lib/python*/site-packages")  # colcon finds what lies beside it first
        packages = [
            str(path)
            for folder in folders
            for name in IN_BOXES
            for path in self.venv.glob(f"{folder}/{name}")
        ]
        compiled = [str(self.root / "src"), *packages]
        self.step("Preparing the grader", [self.python, "-m", "compileall", "-qq", "-j", "0", *compiled])

    def step(self, text: str, command: List[str]) -> bool:
        """Run a program, with a line that shows that time passes; return whether it succeeded."""
        start = time.monotonic()
        is_terminal = sys.stderr.isatty()
        with self.log.open("ab") as log:
            log.write("\n$ {}\n".format(" ".join(command)).encode())
            log.flush()
            # The lock goes along: it holds as long as this program lives, even if we are killed. Its own
            # session, so that it ends with all its children, whoever of us is interrupted.
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                cwd=str(self.root),
                env=child_environment(os.environ, self.root),
                pass_fds=[self.lock],
                start_new_session=True,
            )
            try:
                _say(text + " ...", end="" if is_terminal else "\n")
                while process.poll() is None:
                    with contextlib.suppress(subprocess.TimeoutExpired):
                        process.wait(1)
                    if is_terminal:
                        _say(f"\r{text} ... {time.monotonic() - start:.0f} s", end="")
            except BaseException:
                with contextlib.suppress(ProcessLookupError):  # it may just have ended
                    os.killpg(process.pid, signal.SIGKILL)  # it is made anew next time
                process.wait()
                raise
            finally:
                if is_terminal:
                    _say("")
        return process.returncode == 0

    def failure(self) -> Stop:
        """Return the sentence for the step that failed."""
        text = self.log.read_text(encoding="utf-8", errors="replace")
        return Stop(failure_sentence(self.root, self.log, text, shutil.disk_usage(str(self.root)).free))


def child_environment(environ: Mapping[str, str], root: Path) -> Dict[str, str]:
    """Return `environ` for the programs that install, without what would lead them elsewhere.

    Where the packages lie beside the project, nothing is fetched: `ros2lab bundle offline` has put them there.
    """
    unwanted = ("PYTHONHOME", "PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "PIP_USER", "PIP_TARGET", "PIP_PREFIX")
    result = {name: value for name, value in environ.items() if name not in unwanted}
    result.update(
        UV_PYTHON_DOWNLOADS="never", PIP_USER="0", PIP_NO_INPUT="1", PIP_DISABLE_PIP_VERSION_CHECK="1"
    )
    # An institute that looks into its encrypted traffic has its certificate on the system, not in uv.
    result.setdefault("UV_SYSTEM_CERTS", "1")
    packages = root / "wheels"
    if packages.is_dir():
        result.update({tool + "_NO_INDEX": "1" for tool in ("PIP", "UV")})
        result.update({tool + "_FIND_LINKS": str(packages) for tool in ("PIP", "UV")})
    return result


# ---- sentences ------------------------------------------------------------------------------------------


def failure_sentence(root: Path, log: Path, text: str, free: int) -> str:
    """Say why an installation failed.

    Args:
        root: the project.
        log: the log file, to be named.
        text: what is in it.
        free: what is left on the project's disk, in bytes.
    """
    lowered = text.lower()
    if free < 20e6 or any(words in lowered for words in NO_SPACE):
        return space_sentence(root)
    if any(words in lowered for words in NO_NETWORK):
        return (
            "The packages could not be fetched from the internet: connect this computer "
            f"(or set your mirror in pip.conf) and run this again; details are in {log}."
        )
    return f"The installation failed: the reason is at the end of {log}; run this again when it is fixed."


def os_sentence(root: Path, error: OSError) -> str:
    """Say what an error of the system means for the installation."""
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return space_sentence(root)
    if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
        return (
            f"{error.filename or root} cannot be written to: copy the project to a folder of your own "
            f"(cp -r '{root}' ~/ros2lab) and run this there."
        )
    return f"The installation failed ({error}): fix that and run this again."


def space_sentence(root: Path) -> str:
    """Say that the disk is full."""
    return (
        f"The disk is full: the course needs about 1.5 GB in {root} and ~/.cache together; "
        "make room and run this again."
    )


def _dotted(version: Sequence[int]) -> str:
    return "{}.{}".format(*version)


def _parsed(version: str) -> Version:
    major, minor = version.split(".")
    return int(major), int(minor)


def _say(text: Any, end: str = "\n") -> None:
    print(text, end=end, file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
