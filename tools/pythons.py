"""Try the course on every Python that README names: `make pythons`.

Each bare Debian has a Python of its own, and each Python of this machine runs in one of them. Everything begins
with a fresh clone of the last commit. At the end a table says what ran, and what did not.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import bare_root
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).resolve().parent.parent
VERSIONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
SAYS_VERSION = "import sys; print(sys.base_prefix, '{}.{}'.format(*sys.version_info))"
FULL_MARKS = "110 of 100 points"  # with the bonus
BUILD_TESTS = ("tests/ros/test_workspace.py", "tests/ros/test_reference.py")
# Waits for a page that tells of the first lesson, as long as the server lives.
ANSWERS = """
import os, sys, time, urllib.error, urllib.request
address, server = sys.argv[1:]
while True:
    try:
        answer = urllib.request.urlopen(address).read()
        sys.exit(b"00_welcome.ipynb" not in answer)
    except urllib.error.HTTPError as error:
        sys.exit(str(error))
    except urllib.error.URLError:
        os.kill(int(server), 0)
        time.sleep(0.2)
"""
# Inside, by an ordinary user with an empty home.
CLONE = "git clone --quiet /mnt/project ~/ros2lab && cd ~/ros2lab"
DEVELOPMENT = "python3 tools/bootstrap.py development"


class Place(NamedTuple):
    """Where the course is tried.

    Attributes:
        suite: a bare Debian's.
        prefix: the prefix of a Python of this machine; None for Debian's own.
        version: the Python's, such as `3.12`; empty if the Debian is not there.
    """

    suite: str
    prefix: Path | None
    version: str

    @property
    def name(self) -> str:
        """How the table calls it."""
        return f"{self.version or '?'}, {'of this machine, in ' if self.prefix else ''}Debian {self.suite}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Try everything everywhere; 0 if nothing that ran has failed."""
    parser = argparse.ArgumentParser(description="Try the course on every Python that README names.")
    parser.add_argument(
        "only", nargs="*", help=f"suites, versions and stages ({', '.join(STAGES)}) to try; all without"
    )
    only = set(parser.parse_args(arguments).only)
    stages = only.intersection(STAGES) or set(STAGES)
    wanted = only.difference(STAGES)
    table = Table("Python", *STAGES, title="What is not run is not promised.")
    failures = 0
    versions = set()
    with tempfile.TemporaryDirectory(prefix="ros2lab-pythons-") as scratch:
        project = Path(scratch, "project")
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(project)], check=True)
        for place in places():
            if wanted and not wanted & {place.version, place.suite if not place.prefix else ""}:
                continue
            results = [try_stage(stage, place, project) if stage in stages else "not run" for stage in STAGES]
            failures += sum(result.startswith("failed") for result in results)
            versions.add(place.version)
            table.add_row(place.name, *results)
    for version in VERSIONS:
        if version not in versions:
            table.add_row(version, *["not run"] * len(STAGES))
    Console(width=140).print(table)
    return min(failures, 1)


def places() -> Iterator[Place]:
    """Yield each bare Debian with its own Python, and each other Python of this machine in one of them."""
    here = own_suite()
    for suite in bare_root.SUITES:
        yield Place(suite, None, debians_version(suite))
    for version in VERSIONS:
        prefix = prefix_of(version)
        if prefix:
            yield Place(here, prefix, version)


def own_suite() -> str:
    """Return the bare Debian whose libraries are those of this machine, or else the newest stable one."""
    try:
        lines = Path("/etc/os-release").read_text(encoding="utf-8").splitlines()
    except OSError:
        return "trixie"
    names = {line.partition("=")[2].strip('"') for line in lines if line.startswith("VERSION_CODENAME=")}
    return next((suite for suite in bare_root.SUITES if suite in names), "trixie")


def debians_version(suite: str) -> str:
    """Return the version of a bare Debian's Python; nothing, after saying why, where it cannot be had."""
    try:
        return run_inside(suite, None, f'python3 -c "{SAYS_VERSION}"').stdout.split()[-1]
    except bare_root.RootError as error:
        print(error, file=sys.stderr)
        return ""


def prefix_of(version: str) -> Path | None:
    """Return the prefix of a Python of this machine, on PATH or of pyenv, that no package of the system owns."""
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    found = [
        *sorted(pyenv.glob(f"versions/{version}.*/bin/python{version}")),
        shutil.which(f"python{version}"),
    ]
    for python in filter(None, found):
        answer = subprocess.run([python, "-c", SAYS_VERSION], capture_output=True, text=True, check=False)
        prefix = answer.stdout.partition(" ")[0].strip()
        if answer.returncode == 0 and prefix != "/usr":
            return Path(prefix)
    return None


def try_stage(stage: str, place: Place, project: Path) -> str:
    """Run one stage in one place, and return what the table says of it."""
    if not place.version:
        return "not run"
    print(f"{place.name}: {stage} ...", file=sys.stderr, flush=True)
    finished = STAGES[stage](place, project)
    log = bare_root.cache() / "pythons" / f"{place.version}-{place.suite}-{stage}.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text(finished.stdout, encoding="utf-8")
    if stage == "reference" and finished.returncode == 0 and FULL_MARKS not in finished.stdout:
        return f"failed: not {FULL_MARKS}; {log}"
    return "passed" if finished.returncode == 0 else f"failed: {log}"


def demo(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Type `make demo`."""
    return run_inside(place.suite, place.prefix, f"{CLONE} && make demo", project)


def grade(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Grade the reference, as somebody hands it in: without links."""
    copy = "cp --recursive --dereference robot_project_ws ~/reference"
    install = "python3 tools/bootstrap.py student && .venv/bin/ros2lab grade ~/reference"
    return run_inside(place.suite, place.prefix, f"{CLONE} && {copy} && {install}", project)


def build(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Run the tests of building, which need what developers have."""
    tests = f".venv/bin/python -m pytest -q {' '.join(BUILD_TESTS)}"
    return run_inside(place.suite, place.prefix, f"{CLONE} && {DEVELOPMENT} && {tests}", project)


def lessons(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Let a student go through the lessons."""
    return watched(place, project, "tests/student")


def pip(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Type what the READMEs say of pip, as an ordinary user and as root."""
    return watched(place, project, "--thorough tests/installation/test_readme_install.py")


def watched(place: Place, project: Path, words: str) -> subprocess.CompletedProcess[str]:
    """Run tests on this machine that look at what a student does in a place."""
    environ = {**os.environ, "STUDENT_SUITE": place.suite, "STUDENT_PYTHON": str(place.prefix or "")}
    tests = f".venv/bin/python -m pytest -q --numprocesses 2 --dist worksteal {words}"
    return subprocess.run(
        ["sh", "-c", f"{DEVELOPMENT} && {tests}"],
        cwd=project,
        env=environ,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )


def offline(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Type `./lab` in what `ros2lab bundle offline` has made on this machine, where there is no network, and drive."""
    bundle = project.parent / f"offline-{place.version}"
    python = ".".join(place.version.split(".")[:2])
    if not bundle.exists():
        made = [
            str(ROOT / ".venv/bin/ros2lab"),
            "bundle",
            "offline",
            "--python",
            python,
            "--out",
            str(bundle),
        ]
        subprocess.run(made, check=True)
    script = f"""
        set -e
        cp --recursive /mnt/project ~/ros2lab
        cd ~/ros2lab
        ./lab > lab.log 2>&1 &
        server=$!
        until grep -q token= lab.log; do kill -0 $server || (cat lab.log; exit 1); sleep 0.2; done
        cat lab.log
        python3 -c '{ANSWERS}' "$(sed -n 's|^ *\\(http.*\\)/lab/.*token=|\\1/api/contents/notebooks?token=|p' lab.log)" $server
        kill $server
        wait $server
        .venv/bin/ros2lab demo
    """
    return run_inside(place.suite, place.prefix, script, bundle, has_network=False)


def container(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Do what the Dockerfile does after its Debian packages, which the bare Debian has, and drive."""
    script = " && ".join(["mkdir ~/ros2lab", "cd ~/ros2lab", *steps_of(project / "Dockerfile")])
    script += " && rm -rf .git && make demo"  # .dockerignore leaves it out
    return run_inside(place.suite, place.prefix, script, project)


def binder(place: Place, project: Path) -> subprocess.CompletedProcess[str]:
    """Do what mybinder does after its Debian packages, with the words by which it starts a server; log in, and drive.

    It has the project in the home, and a Python that is not the lab's.
    """
    token, address = "of-a-visitor", "127.0.0.1:8888/user/visitor/"
    options = f"--ip=127.0.0.1 --port=8888 --ServerApp.base_url=/user/visitor/ --ServerApp.token={token}"
    script = f"""
        set -e
        cp --recursive /mnt/project/. ~
        ./binder/postBuild
        ./binder/start python3 -c 'raise SystemExit("This is the other server.")' {options} > server.log 2>&1 &
        server=$!
        python3 -c '{ANSWERS}' 'http://{address}api/contents/notebooks?token={token}' $server || (cat server.log; exit 1)
        cat server.log
        kill $server
        wait $server
        make demo
    """
    return run_inside(place.suite, place.prefix, script, project)


def steps_of(dockerfile: Path) -> Iterator[str]:
    """Yield what an ordinary user's COPY and RUN in a Dockerfile do, as lines of shell where the project is mounted."""
    _, user, instructions = dockerfile.read_text(encoding="utf-8").partition(f"USER {bare_root.USER}\n")
    if not user:
        raise ValueError(f"{dockerfile} does not change to the user {bare_root.USER}.")
    for line in instructions.replace("\\\n", "").splitlines():
        kind, _, words = line.partition(" ")
        if kind == "RUN":
            yield words
        elif kind == "COPY":
            *sources, target = [word for word in words.split() if not word.startswith("--")]
            # Of a folder Docker copies what is in it.
            paths = [
                f"/mnt/project/{source}/."
                if (dockerfile.parent / source).is_dir()
                else f"/mnt/project/{source}"
                for source in sources
            ]
            yield f"mkdir --parents {target} && cp --recursive {' '.join(paths)} {target}"


STAGES: dict[str, Callable[[Place, Path], subprocess.CompletedProcess[str]]] = {
    "demo": demo,
    "reference": grade,
    "build": build,
    "lessons": lessons,
    "pip": pip,
    "offline": offline,
    "container": container,
    "binder": binder,
}


def run_inside(
    suite: str,
    prefix: Path | None,
    script: str,
    project: Path | None = None,
    *,
    has_network: bool = True,
) -> subprocess.CompletedProcess[str]:
    """Run a line of shell as an ordinary user with an empty home, where the project lies at /mnt/project.

    Raises:
        RootError: if the Debian cannot be made here.
    """
    root = bare_root.bare_root(suite)
    with tempfile.TemporaryDirectory(prefix="ros2lab-home-") as home:
        bare_root.hand_over(Path(home))
        binds = {"/mnt/project": project} if project else {}
        options = [] if has_network else ["--unshare-net"]
        trusting = f"git config --global --add safe.directory '*' && {script}" if project else script
        return subprocess.run(
            bare_root.entering(
                root, ["sh", "-c", trusting], Path(home), python=prefix, binds=binds, options=options
            ),
            env=bare_root.environment(python=prefix),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )


if __name__ == "__main__":
    sys.exit(main())
