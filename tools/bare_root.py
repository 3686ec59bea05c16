"""Run a command on a bare Debian: `python3 tools/bare_root.py trixie COMMAND...`.

The Debian holds what README tells a newcomer to have, and nothing else. It is made once by mmdebstrap, kept in
the user's cache and entered by bubblewrap, read-only and by pivot_root, so that another bubblewrap works inside.
The command gets an own /tmp, /dev/shm and process table, an environment of its own, and this machine's network.
Of this machine only the settings of its package clients go along.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import hashlib
import os
import shutil
import signal
import ssl
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

SUITES = ("bookworm", "trixie", "testing")  # Python 3.11, 3.13 and 3.14
PACKAGES = ("python3-venv", "make", "git", "bash", "ca-certificates", "bubblewrap")
USER, USER_ID = "student", 1000
HOME, HOME_OF_ROOT = "/home/student", "/root"
OF_PACKAGE_CLIENTS = ("PIP_", "UV_", "HTTP_PROXY", "HTTPS_PROXY", "ALL_PROXY", "NO_PROXY")
OF_APT = ("Acquire::http", "Acquire::Check-", "Acquire::Retries")
CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"  # where Debian has them
UV_CACHE = "/var/cache/uv"
# For root, bubblewrap covers a few folders of /proc, and with such a one the kernel lets no other bubblewrap have any.
WITH_WHOLE_PROC = ("sh", "-c", 'mount -t proc proc /proc && exec "$@"', "sh")
MAKE_USER = f'chroot "$1" useradd --uid {USER_ID} --create-home --shell /bin/bash {USER}'


class RootError(Exception):
    """One sentence: what keeps a root from being made or entered, and what to do."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command, and return its exit code."""
    parser = argparse.ArgumentParser(description="Run a command on a bare Debian.")
    parser.add_argument("suite", help=f"the Debian: {', '.join(SUITES)}, or another suite")
    parser.add_argument(
        "command", nargs=argparse.REMAINDER, help="what to run; without it, the root is only made"
    )
    parser.add_argument("--root", action="store_true", help="run it as root, not as an ordinary user")
    parser.add_argument(
        "--home", type=Path, help="the home folder, kept afterwards; without it, an empty one"
    )
    parser.add_argument(
        "--python", type=Path, metavar="PREFIX", help="the prefix of a Python of this machine to use"
    )
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        folder = bare_root(options.suite)
        if not options.command:
            return 0
        with tempfile.TemporaryDirectory(prefix="ros2lab-home-") as scratch:
            home = (options.home or Path(scratch)).absolute()
            hand_over(home)
            return subprocess.run(
                entering(folder, options.command, home, as_root=options.root, python=options.python),
                env=environment(as_root=options.root, python=options.python),
                check=False,
            ).returncode
    except RootError as error:
        print(error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130


def bare_root(suite: str, packages: Sequence[str] = PACKAGES) -> Path:
    """Return the folder of a bare Debian, which is made where it is not there yet.

    Args:
        suite: Debian's name of it, such as `trixie`.
        packages: what it has beside the least that a Debian has.

    Raises:
        RootError: if it cannot be made or entered on this machine.
    """
    check_machine()
    content = f"{suite} {packages} {MAKE_USER}"
    folder = cache() / "roots" / f"{suite}-{hashlib.sha256(content.encode()).hexdigest()[:12]}"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with _locked(folder.with_suffix(".lock")):
        if not folder.is_dir():
            unfinished = folder.with_suffix(".unfinished")
            _remove(unfinished)
            try:
                _make(suite, unfinished, packages)
                unfinished.rename(folder)
            finally:
                _remove(unfinished)
    return folder


def check_machine() -> None:
    """Raise RootError if this machine cannot make and enter a root."""
    missing = [name for name in ("mmdebstrap", "bwrap", "tar") if not shutil.which(name)]
    if missing:
        packages = " ".join(missing).replace("bwrap", "bubblewrap")
        raise RootError(
            f"A bare Debian needs {packages}: type `sudo apt install {packages}` and run this again."
        )
    probe = ["bwrap", "--unshare-pid", "--ro-bind", "/", "/", "true"]
    if subprocess.run(probe, stderr=subprocess.DEVNULL, check=False).returncode:
        raise RootError(
            "A bare Debian needs root or user namespaces, and here are neither: "
            "run this as root, or in a container with --privileged."
        )


def cache() -> Path:
    """Return the folder in which roots and downloaded packages are kept."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ros2lab"


def entering(
    root: Path,
    command: Sequence[str],
    home: Path,
    *,
    as_root: bool = False,
    python: Path | None = None,
    binds: Mapping[str, Path] | None = None,
    folder: str = "",
    options: Sequence[str] = (),
) -> list[str]:
    """Return the command that runs `command` in a root; run it in the `environment` below.

    Args:
        root: what `bare_root` returned.
        command: the program and its arguments.
        home: a folder of this machine, which becomes the home.
        as_root: whether to run it as root, and not as an ordinary user.
        python: the prefix of a Python of this machine, to be used instead of Debian's.
        binds: more folders of this machine, writable, by what they are called inside.
        folder: where to start, inside; the home without it.
        options: more of bubblewrap's, such as `--unshare-net`.
    """
    inside = HOME_OF_ROOT if as_root else HOME
    packages = cache() / ("uv-of-root" if as_root else "uv")
    packages.mkdir(parents=True, exist_ok=True)
    hand_over(packages, as_root=as_root)
    options = [*options, "--bind", str(root), "/", "--dev", "/dev", "--proc", "/proc", "--tmpfs", "/run"]
    for place in ("/tmp", "/dev/shm"):  # noqa: S108 -- its own, writable for everybody as everywhere
        options += ["--perms", "1777", "--tmpfs", place]
    if python and python.parts[1] in {"home", "root"} - {inside[1:]}:
        options += ["--tmpfs", f"/{python.parts[1]}"]  # nobody else may look into the one that is there
    for source, place in {home: inside, packages: UV_CACHE}.items():
        options += ["--bind", str(source), place]
    for place, source in (binds or {}).items():
        options += ["--bind", str(source), place]
    if python:
        for parent in reversed(python.parents):
            options += ["--perms", "755", "--dir", str(parent)]
        options += ["--ro-bind", str(python), str(python)]
    for place in ("/etc/resolv.conf", "/etc/hosts"):
        options += ["--ro-bind-try", place, place]
    if certificates():
        options += ["--ro-bind", str(certificates()), CERTIFICATES]
    options += ["--remount-ro", "/", "--chdir", folder or inside]
    options += ["--unshare-pid", "--unshare-ipc", "--unshare-uts", "--die-with-parent"]
    user = "0" if as_root else str(USER_ID)
    if os.geteuid() != 0:
        return ["bwrap", *options, "--unshare-user", "--uid", user, "--gid", user, "--", *command]
    drop = ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups", "--inh-caps=-all", "--"]
    return [
        "bwrap",
        *options,
        "--cap-add",
        "ALL",
        "--",
        *WITH_WHOLE_PROC,
        *([] if as_root else drop),
        *command,
    ]


def environment(*, as_root: bool = False, python: Path | None = None) -> dict[str, str]:
    """Return the environment of a newly made user, with this machine's settings of the package clients."""
    path = ["/usr/local/bin", "/usr/bin", "/bin"]
    if as_root:
        path = ["/usr/local/sbin", "/usr/sbin", "/sbin", *path]
    if python:
        path = [f"{python}/bin", *path]
    settings = {
        name: value
        for name, value in os.environ.items()
        if name.upper().startswith(OF_PACKAGE_CLIENTS) and not _names_a_file(value)
    }
    if certificates():
        settings |= {"PIP_CERT": CERTIFICATES, "SSL_CERT_FILE": CERTIFICATES}
    return {
        **settings,
        "HOME": HOME_OF_ROOT if as_root else HOME,
        "LANG": "C.UTF-8",
        "LOGNAME": "root" if as_root else USER,
        "PATH": ":".join(path),
        "SHELL": "/bin/bash",
        "TERM": "xterm-256color",
        "USER": "root" if as_root else USER,
        "UV_CACHE_DIR": UV_CACHE,
    }


def certificates() -> Path | None:
    """Return the file of the certificates that this machine trusts, if there is one."""
    places = [os.environ.get("PIP_CERT"), ssl.get_default_verify_paths().cafile, CERTIFICATES]
    return next((Path(place) for place in places if place and Path(place).is_file()), None)


def hand_over(folder: Path, *, as_root: bool = False) -> None:
    """Let the ordinary user inside own a folder of this machine and all that is in it."""
    if os.geteuid() != 0 or as_root or folder.stat().st_uid == USER_ID:
        return
    for place, folders, files in os.walk(folder):
        for name in (*folders, *files):
            os.chown(Path(place, name), USER_ID, USER_ID, follow_symlinks=False)
    os.chown(folder, USER_ID, USER_ID)


def _make(suite: str, folder: Path, packages: Sequence[str]) -> None:
    """Let mmdebstrap make a Debian in a new folder.

    Its tar file is unpacked here, so that all of it belongs to this user, who may be anyone.
    """
    print(f"Making a bare Debian {suite} ...", file=sys.stderr, flush=True)
    folder.mkdir()
    log = folder.with_suffix(".log")
    with log.open("wb") as said, tempfile.NamedTemporaryFile("w", suffix=".conf") as settings:
        settings.write(apt_settings())
        settings.flush()
        debian = subprocess.Popen(
            [
                "mmdebstrap",
                "--variant=minbase",
                "--format=tar",
                f"--include={','.join(packages)}",
                f"--aptopt={settings.name}",
                f"--customize-hook={MAKE_USER}",
                suite,
                "-",
            ],
            stdout=subprocess.PIPE,
            stderr=said,
        )
        unpacking = ["tar", "--extract", "--no-same-owner", "--exclude=./dev/*", f"--directory={folder}"]
        try:
            unpacked = subprocess.run(unpacking, stdin=debian.stdout, stderr=said, check=False)
        finally:
            debian.stdout.close()  # type: ignore[union-attr]
            made = debian.wait()  # after Ctrl-C, too: it cleans up
    if made or unpacked.returncode:
        raise RootError(f"Debian {suite} could not be made: the reason is at the end of {log}.")
    log.unlink()


def apt_settings() -> str:
    """Return how this machine reaches Debian's packages, where it is a Debian."""
    if not shutil.which("apt-config"):
        return ""
    command = ["apt-config", "dump", "--no-empty", "--format", '%F "%v";%n', "Acquire"]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return "".join(f"{line}\n" for line in lines if line.startswith(OF_APT))


def _names_a_file(setting: str) -> bool:
    """Return whether a setting names a file or folder of this machine, which is not there inside."""
    return any(word.startswith(("/", "~", "file:")) for word in setting.split())


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[None]:
    with path.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _remove(folder: Path) -> None:
    """Remove a folder, also where some in it are closed to their owner."""
    if folder.exists():
        subprocess.run(["chmod", "--recursive", "u+rwX", str(folder)], check=True)
        shutil.rmtree(folder)


if __name__ == "__main__":
    sys.exit(main())
