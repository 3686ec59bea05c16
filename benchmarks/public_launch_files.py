"""Launch files of public repositories with our `ros2` and with the real one, and count which do the same.

FILES holds the repositories as OWNER/NAME, at the commits that `public_launch_files.txt` names (a file is at
https://github.com/OWNER/NAME/blob/COMMIT/PATH). Nothing of them is in this project. Each file is launched by both in
the same surroundings: every package that its repository has or names is there, and every executable, which only
tells how it was called and stays for a second. What the real one misses is given to both, as long as it is an argument
or a file of another package.
Two do the same if they end with the same code, start the same executables with the same arguments, parameters and
namespaces, and log the same lines for the user.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import re
import signal
import subprocess
import sys
import sysconfig
import tempfile
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import yaml

LIST = Path(__file__).with_suffix(".txt")
OURS = Path(sysconfig.get_path("scripts"), "ros2")
PATIENCE = 25.0  # s until a launch that does not end by itself is interrupted
LAST_WAIT = 20.0  # s until it is killed
MOST_GIVEN = 8  # so many things are given to a launch file that misses them
MISSING_ARGUMENT = re.compile(r"""(?:missing required argument|Required launch argument) ['"](\w+)['"]""")
MISSING_FILE = re.compile(r"No such file or directory: '([^']+)'")
STANDINS = {
    ".py": "from launch import LaunchDescription\ndef generate_launch_description():\n    return LaunchDescription()\n",
    ".xml": "<launch/>\n",
    ".yaml": "{}\n",
    ".yml": "{}\n",
}
PROGRAMS = ("xacro", "rviz2", "gz", "gazebo", "gzserver", "gzclient", "ign", "urdf_to_graphiz")
TOLD = "CALLED "
# Executables of launch files: it tells its arguments, with the text of parameter files, on one line.
PROGRAM = f"""#!{sys.executable} -IS
import json, os, sys, time
words = [[word, open(word).read()] if os.path.isfile(word) else word for word in sys.argv]
print("{TOLD}" + json.dumps(words), flush=True)
time.sleep(1)  # the end of one may end all
"""
PACKAGE = re.compile(
    r"""(?:package|pkg|FindPackageShare|get_package_share_directory|get_package_share_path|get_package_prefix"""
    r"""|package_name|pkg_name)\s*(?:=|\(|:)\s*\[?\s*['"]?([a-z][a-z0-9_]+)['"]?"""
    r"""|find-pkg-share\s+([a-z0-9_]+)"""
)
EXECUTABLE = re.compile(r"""(?:executable|exec)\s*(?:=|:)\s*['"]?([\w.\-]+)['"]?""")


class Outcome(NamedTuple):
    """What a launch did.

    Attributes:
        code: its exit code.
        calls: how executables were called, each as a text.
        lines: what it logged for the user.
        errors: what it said that went wrong.
    """

    code: int
    calls: Counter[str]
    lines: Counter[str]
    errors: list[str]


def main(arguments: Sequence[str] | None = None) -> int:
    """Compare all files; return 0 if as many as are asked for do the same."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("real", type=Path, metavar="REAL", help="the real `ros2`")
    parser.add_argument("files", type=Path, metavar="FILES", help="where the repositories are")
    parser.add_argument("--modules", type=Path, help="a folder of Python modules that launch files import")
    parser.add_argument(
        "--at-least", type=int, default=0, metavar="N", help="how many have to do the same (0)"
    )
    parser.add_argument("--only", default="", metavar="TEXT", help="only files with this in their names")
    options = parser.parse_args(arguments)
    # A job in the background would hand down that it is ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    names = [line.split(maxsplit=2) for line in LIST.read_text(encoding="utf-8").splitlines()]
    chosen = [(repository, path) for repository, _, path in names if options.only in f"{repository}/{path}"]
    same = calls = failed = only_ours = 0
    with ThreadPoolExecutor(2) as pool:
        compared = pool.map(lambda file: _compared(options, *file), chosen)
        for file, (real, ours) in zip(chosen, compared, strict=True):
            differs = [name for name in Outcome._fields[:3] if getattr(real, name) != getattr(ours, name)]
            same += not differs
            calls += real.calls.total()
            failed += real.code != 0
            only_ours += real.code != 0 and ours.code == 0
            if differs:
                print(f"{'/'.join(file)}: {', '.join(differs)}\n{_difference(real, ours)}")
    print(f"{same} of {len(chosen)} do the same, and {only_ours} are launched by ours only")
    print(f"the real one calls {calls} executables, and {failed} of its launches fail")
    return int(same < options.at_least)


def _compared(options: argparse.Namespace, repository: str, path: str) -> tuple[Outcome, Outcome]:
    """Launch a file with both."""
    file = (options.files / repository / path).resolve()
    with tempfile.TemporaryDirectory() as folder:
        environ = _surroundings(Path(folder), options.files / repository)
        if options.modules:
            environ["PYTHONPATH"] = str(options.modules.resolve())
        words = [str(file)]
        for _ in range(MOST_GIVEN):
            real = _launched(options.real, words, environ, Path(folder))
            if not _give_what_is_missing("\n".join(real.errors), words, Path(folder)):
                break
        return real, _launched(OURS, words, environ, Path(folder))


def _give_what_is_missing(errors: str, words: list[str], folder: Path) -> bool:
    """Give what the real launch has missed: an argument, or a file of a package that is not in the repository."""
    argument = MISSING_ARGUMENT.search(errors)
    if argument is not None:
        words.append(f"{argument[1]}:=given")
        return True
    for match in MISSING_FILE.finditer(errors):
        file = Path(match[1])
        if folder in file.parents and folder.resolve() in file.resolve().parents and not file.exists():
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(STANDINS.get(file.suffix, "<robot name='robot'/>"), encoding="utf-8")
            return True
    return False


def _surroundings(folder: Path, checkout: Path) -> dict[str, str]:
    """Install every package and every executable that a repository's launch files name; return the environment."""
    packages, executables = _named(checkout)
    sources = _sources(checkout)
    index = folder / "share/ament_index/resource_index/packages"
    for place in (index, folder / "bin", folder / "home"):
        place.mkdir(parents=True)
    for name in executables:
        _write_program(folder / "programs" / name)
    for package in packages | sources.keys():
        (index / package).touch()
        if package in sources:
            (folder / "share" / package).symlink_to(sources[package].resolve())
        else:
            (folder / "share" / package).mkdir()
        (folder / "lib").mkdir(exist_ok=True)
        (folder / "lib" / package).symlink_to(folder / "programs")
    for name in PROGRAMS:
        _write_program(folder / "bin" / name)
    kept = ("LANG", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_DOMAIN_ID")
    return {name: os.environ[name] for name in kept if name in os.environ} | {
        "PATH": f"{folder / 'bin'}{os.pathsep}{os.environ['PATH']}",
        "AMENT_PREFIX_PATH": str(folder),
        "HOME": str(folder / "home"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONWARNINGS": "ignore",
        "TURTLEBOT3_MODEL": "burger",
        "LINOROBOT2_BASE": "2wd",
    }


@functools.cache
def _named(checkout: Path) -> tuple[set[str], set[str]]:
    """Return the packages and the executables that the launch files of a repository name."""
    texts = [
        file.read_text(encoding="utf-8", errors="replace")
        for file in checkout.rglob("*")
        if file.is_file() and "launch" in str(file.relative_to(checkout))
    ]
    packages = {name for text in texts for match in PACKAGE.finditer(text) for name in match.groups() if name}
    return packages, {match[1] for text in texts for match in EXECUTABLE.finditer(text)}


@functools.cache
def _sources(checkout: Path) -> dict[str, Path]:
    """Return the packages of a repository, by name."""
    found = {}
    for manifest in checkout.rglob("package.xml"):
        name = re.search(
            r"<name>\s*([\w-]+)\s*</name>", manifest.read_text(encoding="utf-8", errors="replace")
        )
        if name is not None:
            found[name[1]] = manifest.parent
    return found


def _write_program(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(PROGRAM, encoding="utf-8")
    path.chmod(0o755)


def _launched(program: Path, words: list[str], environ: dict[str, str], folder: Path) -> Outcome:
    process = subprocess.Popen(
        [str(program), "launch", "--show-all-subprocesses-output", *words],
        # The real launch looks for what it has installed itself.
        env={
            **environ,
            "AMENT_PREFIX_PATH": f"{environ['AMENT_PREFIX_PATH']}{os.pathsep}{program.parent.parent}",
        },
        cwd=folder / "home",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        output, _ = process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        try:
            output, _ = process.communicate(timeout=LAST_WAIT)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
    lines = output.splitlines()
    told = [line.partition(TOLD)[2] for line in lines if TOLD in line]
    logged = [line for line in lines if line.startswith("[INFO] [launch.user]")]
    wrong = [line for line in lines if "Caught exception" in line or line.startswith(" - ")]
    return Outcome(process.returncode, Counter(map(_call, told)), Counter(logged), wrong)


def _call(told: str) -> str:
    """Return how an executable was called, with parameters by their values and files by what they hold."""
    words = [_word(*([word] if isinstance(word, str) else word)) for word in json.loads(told)]
    return re.sub(r"/tmp/\w+", "/tmp/X", json.dumps(words))


def _word(word: str, text: str | None = None) -> Any:
    if text is not None and (word.endswith((".yaml", ".yml")) or "launch_params" in word):
        return _plain(yaml.load(text, _Loader))
    name, separator, value = word.partition(":=")
    return [name, _plain(yaml.load(value, _Loader))] if separator else word


class _Loader(yaml.SafeLoader):
    """Reads what the real launch writes: a tuple is a list."""


_Loader.add_constructor(
    "tag:yaml.org,2002:python/tuple", lambda loader, node: loader.construct_sequence(node)
)


def _plain(value: Any) -> Any:
    return {str(key): _plain(inner) for key, inner in value.items()} if isinstance(value, dict) else value


def _difference(real: Outcome, ours: Outcome) -> str:
    def shown(sign: str, texts: Iterable[str]) -> list[str]:
        return [f"  {sign} {text[:300]}" for text in texts]

    rows = [f"  exit code {real.code}, ours {ours.code}"]
    for name in ("calls", "lines"):
        one, other = getattr(real, name), getattr(ours, name)
        rows += shown("-", (one - other).elements()) + shown("+", (other - one).elements())
    return "\n".join([*rows, *shown("real:", real.errors), *shown("ours:", ours.errors)])


if __name__ == "__main__":
    sys.exit(main())
