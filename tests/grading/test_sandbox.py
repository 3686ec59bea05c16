"""A hostile program in a box: what it tries, what comes of it, and that nothing is left of it."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from deadlines import DEADLINE
from ros2lab.grading.sandbox import bubblewrap, worlds
from ros2lab.grading.sandbox.box import SIGNALS, Box, Limits, SandboxMissing, why
from ros2lab.grading.sandbox.keeper.box import BYTES_PER_OPEN_FILE
from ros2lab.grading.sandbox.worlds import World

LIMITS = Limits(
    wall_s=60, cpu_s=20, memory_bytes=256_000_000, processes=64, disk_bytes=20_000_000, file_bytes=8_000_000
)

# Calls libc's functions by name; prints the result or the name of the error.
SYSTEM_CALLS = """
import ctypes, errno, sys
libc = ctypes.CDLL(None, use_errno=True)
def call(name, *arguments):
    result = getattr(libc, name)(*arguments)
    print(name, 'done' if result >= 0 else errno.errorcode[ctypes.get_errno()], flush=True)
"""


def python(source: str) -> list[str]:
    return [sys.executable, "-I", "-S", "-c", source]


def namespace_of(world: World) -> str:
    """Name the World's network; who is in it is of the World."""
    return world.run(["readlink", "/proc/self/ns/net"], files="none").output.strip()


def processes_in(namespace: str) -> list[str]:
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if str((process / "ns/net").readlink()) == namespace:
                found.append(process.name)
        except OSError:
            continue  # it has ended, or is another user's
    return found


def await_none_in(namespace: str) -> None:
    """Wait until Linux has taken away the last process, which it does some time after its SIGKILL."""
    deadline = time.monotonic() + DEADLINE
    while left := processes_in(namespace):
        assert time.monotonic() < deadline, f"processes left: {left}"
        time.sleep(0.01)


@pytest.fixture
def make_world() -> Iterator[Callable[..., World]]:
    """Make Worlds; at the end no process and no mount of theirs may be left."""
    mounts = Path("/proc/self/mounts").read_text()
    made = []

    def make(*arguments: Path, limits: Limits = LIMITS, **options: list[Path]) -> World:
        world = World(*arguments, limits=limits, **options)
        made.append((world, namespace_of(world)))
        return world

    yield make
    for world, namespace in made:
        world.close()
        assert namespace.startswith("net:[")
        await_none_in(namespace)
    assert Path("/proc/self/mounts").read_text() == mounts


@pytest.fixture
def world(make_world: Callable[..., World]) -> World:
    return make_world()


def lines(box: Box) -> list[str]:
    return box.output.split()


# Programs that mean no harm.


def test_a_program_gives_its_output_and_its_exit_code(world: World) -> None:
    box = world.run(["sh", "-c", "echo out; echo err >&2; exit 3"])
    assert (box.output, box.code, box.cut) == ("out\nerr\n", 3, None)
    assert 0 < box.seconds < DEADLINE


def test_it_looks_like_a_machine_without_hardware(world: World) -> None:
    """As one without a battery: where it would be nothing is, and nothing is told of the real one."""
    box = world.run(
        ["sh", "-c", "ls /sys/class | head -n 1; ls /sys/class/power_supply /sys/class/net; ls /sys"]
    )
    assert box.code == 0
    assert lines(box)[1:] == ["/sys/class/net:", "/sys/class/power_supply:", "class"]


def test_a_program_that_is_not_there_says_so(world: World) -> None:
    box = world.run(["no-such-program"])
    assert box.code == 127
    assert "no-such-program" in box.output


def test_a_program_ended_by_a_signal_has_128_and_its_number(world: World) -> None:
    assert world.run(["sh", "-c", "kill -TERM $$"]).code == 128 + signal.SIGTERM


def test_the_environment_is_what_was_given(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SECRET_TOKEN", "abc")
    assert set(world.run(["env"], environ={"A": "1 = 2"}).output.splitlines()) == {
        "A=1 = 2",
        "HOME=/tmp/home",
        "LANG=C.UTF-8",
        "OPENBLAS_NUM_THREADS=1",
        "PATH=/usr/bin:/bin",
    }


def test_standard_input_is_what_was_given(world: World) -> None:
    reading, writing = os.pipe()
    box = world.start(["cat"], stdin=reading)
    os.close(reading)
    os.write(writing, b"hello")
    assert box.wait_for("hello", DEADLINE)
    os.close(writing)
    assert box.wait(DEADLINE) == 0
    assert world.run(["cat"]).output == ""


def test_what_one_box_writes_to_the_submission_the_grader_and_the_next_box_read(
    make_world: Callable[..., World], tmp_path: Path
) -> None:
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "given").write_text("given")
    (tmp_path / "package" / "given").chmod(0o600)
    (tmp_path / "link").symlink_to("/etc/shadow")
    os.mkfifo(tmp_path / "pipe")
    world = make_world(tmp_path)
    assert (
        world.run(["sh", "-c", "cat given; echo made > made"], files="write", cwd="/submission/package").code
        == 0
    )
    assert (world.folder / "package" / "made").read_text() == "made\n"
    box = world.run(["cat", "/submission/package/made", "/submission/link"])
    assert box.output.startswith("made\ncat: /submission/link")
    assert sorted(path.name for path in world.folder.iterdir()) == ["link", "package"]
    assert not (tmp_path / "package" / "made").exists()
    assert world.run(["ls", "/submission"], files="none").code != 0


def test_what_is_shown_is_read_only_at_its_place(make_world: Callable[..., World], tmp_path: Path) -> None:
    shown = tmp_path / "a" / "b"
    shown.mkdir(parents=True)
    (shown / "text").write_text("text")
    (tmp_path / "a" / "hidden").write_text("hidden")
    world = make_world(shown=[shown / "text"])
    box = world.run(["sh", "-c", f"cat {shown}/text {tmp_path}/a/hidden; echo > {shown}/text"])
    assert box.output.startswith("text")
    assert "hidden: No such file" in box.output
    assert (shown / "text").read_text() == "text"
    with pytest.raises(ValueError, match="is not there"):
        World(shown=[tmp_path / "missing"])


def test_only_a_box_that_is_shown_the_grader_sees_it(make_world: Callable[..., World]) -> None:
    """Also where a folder around it is shown, as that of installed packages is."""
    module, profile = (
        bubblewrap.PACKAGE / "course" / "__init__.py",
        bubblewrap.PACKAGE / "fastdds_profile.xml",
    )
    for shown in ([profile], [profile, bubblewrap.PACKAGE.parent]):
        world = make_world(shown=shown)
        seen = world.run(["find", str(bubblewrap.PACKAGE), "-type", "f"]).output.split()
        assert seen == [str(profile)]
        assert world.run(["touch", str(module)]).code == 1
        assert str(module) in world.run(["find", str(bubblewrap.PACKAGE)], shown=[bubblewrap.PACKAGE]).output


def test_the_solution_is_not_shown_with_the_folder_of_the_checkout() -> None:
    """It may lie in what every box sees, such as /usr; what is to be shown of it is there all the same."""
    profile, checkout = bubblewrap.PACKAGE / "fastdds_profile.xml", bubblewrap.HIDDEN[0]
    assert (checkout / "robot_project_ws").is_dir()
    with World(shown=[checkout, profile, Path(__file__)]) as world:
        find = ["find", str(checkout), "-path", sys.prefix, "-prune", "-o", "-type", "f", "-print"]
        assert sorted(world.run(find).output.split()) == sorted([str(profile), __file__])


def test_files_larger_than_the_disk_are_refused(make_world: Callable[..., World], tmp_path: Path) -> None:
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**12)
    with pytest.raises(ValueError, match=r"cannot be copied into the sandbox: .*No space left") as told:
        World(tmp_path, limits=LIMITS)
    assert "/" not in str(told.value)  # where the grader has it is no student's matter


def test_interrupt_reaches_the_program_and_its_children(world: World) -> None:
    box = world.start(
        python(
            "import os, signal, time\n"
            "child = os.fork()\n"
            "try:\n"
            "    print('ready', flush=True)\n"
            "    signal.pause()\n"
            "except KeyboardInterrupt:\n"
            "    print('interrupted', flush=True)\n"
            "    if child:\n"
            "        os.wait()\n"
        )
    )
    assert box.wait_for("ready\nready", DEADLINE)
    assert box.code is None
    box.interrupt()
    assert box.wait(DEADLINE) == 0
    assert box.output.count("interrupted") == 2
    assert box.cut is None


def test_an_interrupt_at_any_moment_of_a_short_life_does_no_harm(world: World) -> None:
    for _ in range(30):
        box = world.start(["true"])
        while box.code is None:
            box.interrupt()
        assert box.wait(DEADLINE) in (0, 128 + signal.SIGINT)
    assert world.run(["true"]).code == 0


def test_kill_ends_what_does_not_listen(world: World) -> None:
    box = world.start(["sh", "-c", "trap '' INT TERM HUP; echo ready; while :; do read x; done < /dev/zero"])
    assert box.wait_for("ready", DEADLINE)
    with pytest.raises(TimeoutError, match="still runs"):
        box.wait(0.1)
    box.interrupt()
    box.kill()
    assert box.wait(DEADLINE) == 128 + signal.SIGKILL
    assert box.cut is None
    box.kill()
    box.interrupt()


def test_what_is_held_stands_until_it_is_released(world: World) -> None:
    """Also what forks without end, and is in no group of the program's; what ends meanwhile has ended."""
    tick = "while :; do setsid sh -c 'echo tick; sleep 0.01' & wait; done"
    box = world.start(["sh", "-c", f"({tick}) & {tick}"])
    assert box.wait_for("tick", DEADLINE)
    assert box.hold(DEADLINE)
    world.run(["sleep", "0.2"])
    before = box.output
    assert world.run(["sleep", "0.2"]).code == 0
    assert box.output == before
    box.release()
    assert box.wait_for(f"{before}tick", DEADLINE)
    assert box.hold(DEADLINE)
    box.kill()
    assert box.wait(DEADLINE) == 128 + signal.SIGKILL


# Ways to have Linux itself let a process go on that stands: at a time, and whenever a datagram comes.
WAKING = {
    "timer": """
libc = ctypes.CDLL(None)
event = struct.pack("=QiI48x", 0, signal.SIGCONT, 0)
timer = ctypes.c_void_p()
libc.timer_create(time.CLOCK_MONOTONIC, event, ctypes.byref(timer))
libc.timer_settime(timer, 0, (ctypes.c_long * 4)(0, 10_000_000, 0, 10_000_000), None)
""",
    "socket": """
ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.bind(("127.0.0.1", 7007))
fcntl.fcntl(ear, fcntl.F_SETOWN, os.getpid())
try:
    fcntl.fcntl(ear, 10, signal.SIGCONT)  # F_SETSIG
    fcntl.fcntl(ear, fcntl.F_SETFL, os.O_ASYNC | os.O_NONBLOCK)
except PermissionError:
    pass
""",
}
KNOCKING = "import socket\nwith socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:\n    while True:\n        out.sendto(b'x', ('127.0.0.1', 7007))\n"


@pytest.mark.parametrize("way", WAKING)
def test_nothing_that_is_held_lets_itself_go_on(world: World, way: str) -> None:
    imports = "import ctypes, fcntl, os, signal, socket, struct, time\nsignal.signal(signal.SIGCONT, print)\n"
    tick = "while True:\n    print('tick', flush=True)\n    time.sleep(0.005)\n"
    box = world.start(python(f"{imports}{WAKING[way]}{tick}"))
    assert box.wait_for("tick", DEADLINE)
    knocking = world.start(python(KNOCKING))
    assert box.hold(DEADLINE)
    world.run(["sleep", "0.1"])
    before = box.output
    world.run(["sleep", "0.3"])
    assert box.output == before
    knocking.kill()
    box.kill()


def test_terminal_codes_do_not_reach_the_reader(world: World) -> None:
    codes = r"\033[31mred\033[0m \033]0;title\007bell\007 \033]52;c;x\033\\clip back\bspace \302\2334mC1 \342\200\256bidi\r\nend\r"
    assert world.run(["printf", codes]).output == "red bell clip backspace C1 bidi\nend\n"
    hostile = world.run(python(r"print('\x1b]' * 400_000)"), limits=replace(LIMITS, output_bytes=900_000))
    began = time.process_time()
    assert hostile.output.strip() == ""
    assert time.process_time() - began < 5  # it is linear in the length


# The network.


def test_two_boxes_of_one_world_meet_on_loopback_and_two_worlds_do_not(
    make_world: Callable[..., World],
) -> None:
    here, elsewhere = make_world(), make_world()
    receiver = here.start(
        python(
            "import socket\n"
            "s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
            "s.bind(('127.0.0.1', 9000))\n"
            "print('ready', flush=True)\n"
            "print(s.recv(100).decode())\n"
        )
    )
    assert receiver.wait_for("ready", DEADLINE)

    def send(world: World, text: str) -> None:
        source = f"import socket; socket.socket(2, 2).sendto(b'{text}', ('127.0.0.1', 9000))"
        assert world.run(python(source)).code == 0

    send(elsewhere, "from elsewhere")
    send(here, "from here")
    assert receiver.wait(DEADLINE) == 0
    assert receiver.output == "ready\nfrom here\n"


def test_boxes_among_each_other_have_their_own_places_in_common(world: World) -> None:
    """As programs of one machine have; others of the same World, and what comes after them, do not."""
    places = ("/tmp", "/tmp/home", "/home", "/dev/shm")
    tells = "import os\nfor place in {!r}:\n    print(sorted(os.listdir(place)))\n    open(place + '/made', 'a')\n"
    command = python(tells.format(places))
    seen = [_among(world, name, command) for name in ("some", "some", "others", "")]
    assert [["made" in line for line in output.splitlines()] for output in seen] == [
        [False] * 4,
        [True] * 4,
        *[[False] * 4] * 2,
    ]
    assert seen[0] == seen[2]


def test_no_box_among_others_keeps_the_next_one_from_being_made(world: World) -> None:
    """Whatever it puts in the place of what they have in common."""
    code = "import os, shutil\nshutil.rmtree('/tmp/own')\nos.rmdir('/tmp/home')\nopen('/tmp/home', 'x')\nos.symlink('/', '/tmp/own')"
    assert _among(world, "some", python(code)) == ""
    assert _among(world, "some", python("print('there')")) == "there\n"


def _among(world: World, name: str, command: list[str]) -> str:
    box = world.start(command, among=name)
    assert box.wait(DEADLINE) == 0
    return box.output


def test_no_network_but_its_own(world: World) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        socket.create_connection(("127.0.0.1", port)).close()  # it is there for others
        server.accept()[0].close()
        server.setblocking(False)
        box = world.run(
            python(
                "import errno, socket\n"
                "def reach(family, address):\n"
                "    try:\n"
                "        socket.socket(family, socket.SOCK_STREAM).connect(address)\n"
                "        print('REACHED', address)\n"
                "    except OSError as error:\n"
                "        print(errno.errorcode[error.errno])\n"
                f"reach(socket.AF_INET, ('127.0.0.1', {port}))\n"
                "reach(socket.AF_INET, ('192.0.2.1', 80))\n"
                "reach(socket.AF_INET6, ('2001:db8::1', 80))\n"
                "reach(40, (2, 1024))\n"  # vsock, to the host of a virtual machine
            )
        )
        assert lines(box) == ["ECONNREFUSED", "ENETUNREACH", "ENETUNREACH", "EAFNOSUPPORT"]
        with pytest.raises(BlockingIOError):
            server.accept()


def test_two_ros_nodes_of_one_world_hear_one_another(make_world: Callable[..., World]) -> None:
    pytest.importorskip("rclpy")
    from ros2lab import environment

    world = make_world(
        shown=[environment.DDS_PROFILE], limits=replace(LIMITS, memory_bytes=10**9, processes=256)
    )
    environ = {
        name: value
        for name, value in environment.lab_environment({"ROS_DOMAIN_ID": "5"}).items()
        if name not in ("HOME", "PWD")
    }
    environ |= worlds.ROS_SETTINGS
    begin = "import rclpy, std_msgs.msg\nrclpy.init()\nnode = rclpy.create_node('{}')\n"
    listener = world.start(
        [
            sys.executable,
            "-c",
            begin.format("listener")
            + "node.create_subscription(std_msgs.msg.String, 'greeting', lambda m: print(m.data, flush=True), 10)\n"
            "rclpy.spin(node)\n",
        ],
        environ=environ,
    )
    talker = world.start(
        [
            sys.executable,
            "-c",
            begin.format("talker")
            + "publisher = node.create_publisher(std_msgs.msg.String, 'greeting', 10)\n"
            "node.create_timer(0.1, lambda: publisher.publish(std_msgs.msg.String(data='hello from a box')))\n"
            "rclpy.spin(node)\n",
        ],
        environ=environ,
    )
    assert listener.wait_for("hello from a box", DEADLINE), listener.output + talker.output
    talker.kill()
    listener.kill()
    talker.wait(DEADLINE)
    listener.wait(DEADLINE)


# What a program can see and change.


def test_a_node_does_not_import_what_it_does_not_need(make_world: Callable[..., World]) -> None:
    """What generates messages takes a seventh of its start; messages have their C side all the same, and numpy works."""
    pytest.importorskip("rclpy")
    from ros2lab import environment
    from ros2lab.grading.sandbox.worlds import underlay

    world = make_world(shown=[environment.DDS_PROFILE])
    code = (
        "import sys\n"
        "from rosidl_generator_py import import_type_support\n"
        "from std_msgs.msg import String\n"
        "String.__import_type_support__()\n"
        "print('rosidl_parser.parser' in sys.modules, import_type_support('std_msgs') is not None)\n"
        "import rosidl_parser.parser\n"
        "import numpy, numpy.fft, numpy.linalg, numpy.ma, numpy.polynomial, numpy.random\n"
        "print(numpy.ma.masked_equal([1, 2], 2).sum(), numpy.array.__doc__)\n"
    )
    box = world.run([sys.executable, "-c", code], environ=underlay())
    assert (box.code, box.output.splitlines()) == (0, ["False True", "1 None"])


def test_files_of_the_host_are_not_there(make_world: Callable[..., World], tmp_path: Path) -> None:
    key = tmp_path / "key"
    key.write_text("secret")
    world = make_world()
    home = Path.home()
    wanted = [key, *(home / name for name in (".ssh", ".bashrc", ".profile", ".gitconfig")), Path(__file__)]
    wanted += [
        Path(p)
        for p in (
            "/etc/shadow",
            "/etc/hostname",
            "/etc/machine-id",
            "/var/log",
            "/run",
            "/box",
            "/sys/devices",
        )
    ]
    box = world.run(
        python(
            "import os, sys\n"
            "for path in sys.argv[1:]:\n"
            "    try:\n"
            "        print(path, os.stat(path))\n"
            "    except FileNotFoundError:\n"
            "        pass\n"
            "for pid in filter(str.isdigit, os.listdir('/proc')):\n"
            "    assert b'python' in (words := open(f'/proc/{pid}/cmdline', 'rb').read()) or words == b'init\\0'\n"
            "    assert len(open(f'/proc/{pid}/environ', 'rb').read()) < 100\n"
            "assert len(os.listdir('/proc/self/fd')) == 4\n"
            "print('looked')\n"
        )
        + [str(path) for path in wanted]
    )
    assert box.output == "looked\n"


def test_what_lies_beside_the_packages_of_python_is_not_there(
    make_world: Callable[..., World], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Such as submissions, where somebody works in the folder in which the lab is installed."""
    for name in ("submissions/bob/node.py", "bin/tool", "lib/python3/site-packages/module.py", "pyvenv.cfg"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    base = Path(sys.base_prefix)
    monkeypatch.setattr(sys, "base_prefix", str(tmp_path))
    found = (
        make_world(shown=[base]).run(["find", str(tmp_path), "-type", "f", "-printf", "%P\n"]).output.split()
    )
    assert sorted(found) == ["bin/tool", "lib/python3/site-packages/module.py", "pyvenv.cfg"]


def test_folders_of_another_machine_are_its_own(world: World) -> None:
    """They lie in its /tmp and count there; what is shown, and the system's, stays what it is."""
    shown = str(Path(sys.prefix).resolve().parent)
    world.folders += ["/home/ada/logs", "/data", "/usr/share/ada", shown]
    box = world.run(
        python(
            "import os, shutil, sys\n"
            "for place in ('/home/ada/logs', '/data', '/usr/share/ada', sys.prefix):\n"
            "    try:\n"
            "        open(os.path.join(place, 'made'), 'w').write('x')\n"
            "        print(place, os.path.samestat(os.stat(place), os.stat('/tmp/own' + place)))\n"
            "    except OSError:\n"
            "        pass\n"
        )
    )
    assert box.output.splitlines() == ["/home/ada/logs True", "/data True"]


@pytest.mark.parametrize(
    "folder",
    ["/", f"/{'a' * 300}/logs", f"/data/{'/'.join(['b' * 200] * 25)}", "/course/grader/logs"],
    ids=["root", "name", "path", "hidden"],
)
def test_no_name_of_a_folder_keeps_a_box_from_being_made(
    world: World, monkeypatch: pytest.MonkeyPatch, folder: str
) -> None:
    """The code of a submission names them; what cannot be made, or lies where the grader is hidden, is not there."""
    monkeypatch.setattr(bubblewrap, "HIDDEN", [*bubblewrap.HIDDEN, Path("/course/grader")])
    world.folders += [folder, "/data/logs"]
    assert world.run(["ls", "/data"]).output == "logs\n"


@pytest.mark.parametrize(("files", "own"), [("read", set()), ("write", {"/submission"})])
def test_it_writes_nowhere_but_to_its_own_places(world: World, files: worlds.Access, own: set[str]) -> None:
    box = world.run(
        python(
            "import os\n"
            "places = {line.split()[4] for line in open('/proc/self/mountinfo')}\n"
            "places |= {'/' + name for name in os.listdir('/')}\n"
            "places |= {os.path.dirname(place) for place in places}\n"
            "for place in places:\n"
            "    try:\n"
            "        open(os.path.join(place, 'made'), 'w').write('x')\n"
            "        print(place)\n"
            "    except OSError:\n"
            "        pass\n"
            "for place in ('/proc/sys/kernel/core_pattern', '/proc/sysrq-trigger', '/etc/passwd', '/etc/ld.so.cache'):\n"
            "    try:\n"
            "        open(place, 'r+').write('x')\n"
            "        print(place)\n"
            "    except OSError:\n"
            "        pass\n"
        ),
        files=files,
    )
    # The Python that is shown may lie below /tmp: the folders on the way to it are the box's own, too.
    written = {place for place in lines(box) if not place.startswith("/tmp/")}
    assert written - {"/home", "/root"} == {"/tmp", "/dev/shm"} | own  # those two lie in /tmp
    assert not any(Path(place, "made").exists() for place in lines(box))


def test_it_says_nothing_to_linux_about_its_processes(world: World) -> None:
    """Such as that something else be ended first where memory is short."""
    box = world.run(
        python(
            "import os\n"
            "for folder, folders, names in os.walk('/proc'):\n"
            "    for name in [] if folder.endswith('/fd') else names:\n"
            "        path = os.path.join(folder, name)\n"
            "        try:\n"
            "            os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK))\n"
            "            print(path)\n"
            "        except OSError:\n"
            "            pass\n"
        )
    )
    assert box.output == ""


def test_no_mark_of_one_box_is_there_for_the_next(world: World) -> None:
    """Files of the machine take no mark; the times of its devices do, and are others before the next box starts."""
    shared = "{line.split()[4] for line in open('/proc/self/mountinfo') if line.split()[3] != '/'}"
    code = (
        "import os\n"
        f"for place in {shared}:\n"
        "    before = os.stat(place).st_mtime_ns\n"
        "    try:\n"
        "        os.utime(place)\n"
        "        print(place, before, os.stat(place).st_mtime_ns)\n"
        "    except OSError:\n"
        "        pass\n"
    )
    first, second = (
        {place: (found, left) for place, found, left in map(str.split, box.output.splitlines())}
        for box in (world.run(python(code), files="none"), world.run(python(code), files="none"))
    )
    assert first.keys() == second.keys()
    assert all(place.startswith("/dev/") for place in first)
    assert not [place for place, (_, left) in first.items() if second[place][0] == left]


def test_it_has_no_rights_and_can_get_none(world: World) -> None:
    box = world.run(
        python(
            SYSTEM_CALLS + "status = dict(line.split(':', 1) for line in open('/proc/self/status'))\n"
            "print(*(status[name].split()[0] for name in ('Uid', 'Gid', 'CapEff', 'CapBnd', 'NoNewPrivs')))\n"
            "call('setuid', 0)\n"
            "call('chroot', b'/tmp')\n"
            "call('mount', b'none', b'/tmp', b'tmpfs', 0, None)\n"
            "call('unshare', 0x10000000)\n"
            "call('setns', 0, 0)\n"
            "call('syscall', 56, 0x10000011, 0, 0, 0, 0)\n"  # clone, with a new user namespace
            "call('syscall', 435, 0, 0)\n"  # clone3
            "call('syscall', 250, 0, -3, 1)\n"  # keyctl
            "call('memfd_create', b'hidden', 0)\n"
            "call('shmget', 0, 4096, 0o1600)\n"
            "call('syscall', 425, 1, 0)\n"  # io_uring_setup
            "call('syscall', 206, 60_000, 0)\n"  # io_setup
            "call('semget', 0, 32000, 0o1600)\n"
            "call('msgget', 0, 0o1600)\n"
            "call('syscall', 240, b'queue', 0o102, 0o600, None)\n"  # mq_open
            "call('inotify_init1', 0)\n"
            "call('syscall', 9, 0, 4096, 3, 0x21, -1, 0)\n"  # mmap, shared and anonymous
        )
    )
    rights, *calls = box.output.splitlines()
    assert rights == "1000 1000 0000000000000000 0000000000000000 1"
    assert [line.split()[1] for line in calls] == [
        *("EINVAL", "EPERM", "EPERM", "EPERM", "EPERM", "EPERM"),
        *("ENOSYS", "EPERM", "ENOSYS", "EPERM", "EPERM"),
        *("EPERM", "EPERM", "EPERM", "EPERM", "EPERM", "EPERM"),
    ]


def test_calls_of_another_architecture_end_the_program(world: World) -> None:
    """A 32-bit call has other numbers, which the filter does not know."""
    box = world.run(
        python(
            SYSTEM_CALLS + "import mmap\n"
            "code = mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, 7)\n"
            "code.write(bytes.fromhex('b814000000cd80c3'))\n"  # mov eax, 20 (getpid); int 0x80; ret
            "address = ctypes.addressof(ctypes.c_char.from_buffer(code))\n"
            "print(ctypes.CFUNCTYPE(ctypes.c_int)(address)())\n"
        )
    )
    assert (box.output, box.code) == ("", 128 + signal.SIGSYS)
    x32 = world.run(python(SYSTEM_CALLS + "call('syscall', 0x40000000 + 39)"))
    assert (x32.output, x32.code) == ("", 128 + signal.SIGSYS)


def test_it_cannot_touch_its_parent_and_ends_only_itself(world: World) -> None:
    other = world.start(["sh", "-c", "echo ready; exec sleep 1000"])
    assert other.wait_for("ready", DEADLINE)
    box = world.run(
        python(
            SYSTEM_CALLS + "import os, signal\n"
            "print(os.getppid(), sorted(filter(str.isdigit, os.listdir('/proc'))))\n"
            "call('ptrace', 16, os.getppid(), 0, 0)\n"
            "call('process_vm_readv', os.getppid(), 0, 0, 0, 0, 0)\n"
            "call('syscall', 438, os.pidfd_open(os.getppid()), 4, 0)\n"  # pidfd_getfd: how the box tells its end
            "os.kill(os.getppid(), signal.SIGKILL)\n"
            "child = os.fork() or signal.pause()\n"
            "os.kill(-1, signal.SIGKILL)\n"
            "assert os.WTERMSIG(os.waitpid(child, 0)[1]) == signal.SIGKILL\n"
            "print('alive', flush=True)\n"
            "os.kill(os.getpid(), signal.SIGKILL)\n"
        )
    )
    assert box.output.splitlines() == [
        "1 ['1', '2']",
        "ptrace EPERM",
        "process_vm_readv EPERM",
        "syscall EPERM",
        "alive",
    ]
    assert box.code == 128 + signal.SIGKILL
    assert other.code is None
    assert world.run(["true"]).code == 0


def test_it_reaches_no_terminal(world: World) -> None:
    source = "import fcntl, termios\nfor n in 0, 1, 2:\n    try: fcntl.ioctl(n, termios.TIOCSTI, b'x'); print('TYPED')\n"
    box = world.run(python(source + "    except OSError: print('no')\nopen('/dev/tty')\n"))
    assert lines(box).count("no") == 3
    assert "No such device or address: '/dev/tty'" in box.output


# What a program can use up.


def test_processes_and_threads_are_counted_for_the_box(world: World) -> None:
    box = world.run(
        python(
            "import os, signal\n"
            "made = 0\n"
            "try:\n"
            "    while made < 1000:\n"
            "        if not os.fork():\n"
            "            signal.pause()\n"
            "        made += 1\n"
            "except BlockingIOError:\n"
            "    print(made)\n"
        ),
        limits=replace(LIMITS, memory_bytes=10**9),
    )
    assert lines(box) == [str(LIMITS.processes - 2)]  # itself, and the first process of the box


def test_a_fork_bomb_is_ended(world: World) -> None:
    bomb = "import os\nprint('on', flush=True)\nwhile True:\n    try: os.fork()\n    except OSError: pass\n"
    box = world.run(python(bomb), limits=replace(LIMITS, cpu_s=1, memory_bytes=10**9))
    assert box.cut == "It used more than 1 s of CPU time."
    assert box.code == 128 + signal.SIGKILL


def test_a_memory_bomb_of_one_process_is_stopped(world: World) -> None:
    box = world.run(python("a = []\nwhile True: a.append(bytearray(10**7))"))
    assert "MemoryError" in box.output or box.cut == "It used more than 256 MB of memory."
    assert box.code != 0


# Each makes memory that is resident in no process, or in one of many.
HIDING = {
    "processes": "for _ in range(8):\n    if not os.fork():\n        kept = bytearray(b'x' * 60_000_000)\n        signal.pause()\n",
    "page tables": (
        "for _ in range(300):\n"
        "    kept.append(mmap.mmap(-1, 1 << 30, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, mmap.PROT_READ))\n"
        "    for at in range(0, 1 << 30, 1 << 21): kept[-1][at]\n"
    ),
    "maps of memory": (
        "place = libc.mmap(None, 60_000 * 4096, 0, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, -1, 0)\n"
        "for n in range(0, 60_000, 2): libc.mprotect(place + n * 4096, 4096, mmap.PROT_READ)\n"
        "for _ in range(7):\n"
        "    if not os.fork(): signal.pause()\n"
    ),
    "full socket buffers": (
        "for _ in range(10):\n"
        "    if not os.fork():\n"
        "        for _ in range(400):\n"
        "            kept.append(socket.socketpair())\n"
        "            kept[-1][0].setblocking(False)\n"
        "            try:\n"
        "                while True: kept[-1][0].send(bytes(30_000))\n"
        "            except BlockingIOError: pass\n"
        "        signal.pause()\n"
    ),
    "full pipes": (
        "for _ in range(10):\n"
        "    if not os.fork():\n"
        "        for _ in range(400):\n"
        "            kept.append(os.pipe())\n"
        "            os.set_blocking(kept[-1][1], False)\n"
        "            os.write(kept[-1][1], bytes(65536))\n"
        "        signal.pause()\n"
    ),
    "sockets inside sockets": (
        "while True:\n"
        "    full, outer = socket.socketpair(), socket.socketpair()\n"
        "    fill(full[0])\n"
        "    socket.send_fds(outer[0], [b'x'], [end.fileno() for end in full])\n"
        "    kept.append(outer)\n"
        "    for end in full: end.close()\n"
    ),
    "connections that nobody accepts": (
        "for name in range(9):\n"
        "    kept.append(socket.socket(socket.AF_UNIX))\n"
        "    kept[-1].bind(f'\\0{name}')\n"
        "    kept[-1].listen(500)\n"
        "    for _ in range(500):\n"
        "        with socket.socket(socket.AF_UNIX) as client:\n"
        "            client.connect(f'\\0{name}')\n"
        "            fill(client)\n"
    ),
}
# libc's functions that take or give an address.
ADDRESSES = """
import ctypes
libc = ctypes.CDLL(None)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
libc.mprotect.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int]
"""
# Sends until no more is taken, and returns how much that was.
FILL = """
def fill(end):
    sent = 0
    end.setblocking(False)
    try:
        while True: sent += end.send(bytes(30_000))
    except BlockingIOError: return sent
"""


@pytest.mark.parametrize("memory", HIDING)
def test_memory_that_one_process_does_not_show_is_counted(world: World, memory: str) -> None:
    box = world.run(
        python(
            f"{ADDRESSES}import mmap, os, signal, socket\nkept = []\n{FILL}{HIDING[memory]}signal.pause()\n"
        ),
    )
    assert box.cut == "It used more than 256 MB of memory.", box.output


def test_what_many_boxes_hold_together_is_counted(world: World) -> None:
    """The one that holds most is ended, and the others go on."""
    limits = replace(LIMITS, together_bytes=400_000_000)
    hold = "held = b'x' * int({})\nprint('there', flush=True)\n"
    small = world.start(python(hold.format(1e8) + "import time\ntime.sleep(600)\n"), limits=limits)
    assert small.wait_for("there", DEADLINE)
    others = [
        world.start(python(hold.format(2e8) + "import time\ntime.sleep(600)\n"), limits=limits)
        for _ in range(2)
    ]
    deadline = time.monotonic() + DEADLINE
    while all(box.code is None for box in others):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    [ended] = [box for box in others if box.code is not None]
    assert ended.cut == "It and what ran beside it used more than 400 MB of memory."
    assert small.code is None


def test_room_that_is_not_used_costs_nothing(world: World) -> None:
    box = world.run(
        python(
            f"{ADDRESSES}import mmap, os, time\n"
            "libc.mmap(None, 1 << 34, 0, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, -1, 0)\n"
            "for _ in range(7):\n"
            "    if not os.fork(): time.sleep(1), os._exit(0)\n"
            "while True: os.wait()\n"
        )
    )
    assert box.cut is None
    assert "ChildProcessError" in box.output


def test_no_socket_and_no_pipe_holds_more_than_is_counted(world: World) -> None:
    """Neither a large buffer that is asked for, nor one that TCP lets grow."""
    box = world.run(
        python(
            f"import fcntl, os, socket\n{FILL}"
            "with socket.create_server(('127.0.0.1', 0)) as server:\n"
            "    client = socket.create_connection(server.getsockname())\n"
            "    accepted, _ = server.accept()\n"
            "    print(fill(client))\n"
            "pair = socket.socketpair()\n"
            "pair[0].setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 22)\n"
            "print(fill(pair[0]))\n"
            "try:\n"
            "    print(fcntl.fcntl(os.pipe()[0], 1031, 1 << 20))\n"
            "except PermissionError:\n"
            "    print(0)\n"
        )
    )
    assert box.code == 0, box.output
    assert all(int(size) <= BYTES_PER_OPEN_FILE for size in lines(box)), box.output


def test_memory_that_nobody_would_show_is_refused(world: World) -> None:
    """What is mapped of /dev/zero, or of nothing, and shared, stays when its pages are given back."""
    box = world.run(
        python(
            "import mmap\n"
            "def attempt(file):\n"
            "    try:\n"
            "        mmap.mmap(file, 4096)\n"
            "        print('done')\n"
            "    except (OSError, ValueError) as error:\n"
            "        print(type(error).__name__)\n"
            "attempt(-1)\n"
            "attempt(open('/dev/zero', 'r+b', 0).fileno())\n"
        )
    )
    assert box.code == 0, box.output
    assert "done" not in box.output


def test_no_call_keeps_memory_that_is_not_counted(world: World) -> None:
    """Two million bytes of memory are one page where a program wishes that, sockets take pages of files, and so on."""
    box = world.run(
        python(
            SYSTEM_CALLS + "import os, socket\n"
            "inner, outer = os.pipe()\n"
            "here, there = socket.socketpair()\n"
            "file = os.open('/tmp/x', os.O_RDWR | os.O_CREAT)\n"
            "os.write(file, bytes(4096))\n"
            "class Piece(ctypes.Structure):\n"
            "    _fields_ = [('start', ctypes.c_void_p), ('size', ctypes.c_size_t)]\n"
            "page = ctypes.create_string_buffer(4096)\n"
            "piece = Piece(ctypes.addressof(page), 1)\n"
            "call('syscall', 278, outer, ctypes.byref(piece), 1, 0)\n"  # vmsplice
            "call('syscall', 275, file, ctypes.byref(ctypes.c_long(0)), outer, None, 1, 0)\n"  # splice
            "call('syscall', 276, inner, os.pipe()[1], 1, 0)\n"  # tee
            "call('syscall', 40, here.fileno(), file, ctypes.byref(ctypes.c_long(0)), 1)\n"  # sendfile
            "one = ctypes.byref(ctypes.c_int(1))\n"
            "tcp = socket.socket()\n"
            "call('setsockopt', tcp.fileno(), socket.SOL_SOCKET, 60, one, 4)\n"  # SO_ZEROCOPY
            "for protocol in (132, 136, 262): call('socket', socket.AF_INET, 1, protocol)\n"  # SCTP, UDP-Lite, MPTCP
            "call('syscall', 444, None, 0, 1)\n"  # landlock_create_ruleset
            "call('syscall', 300, 0x200, 0)\n"  # fanotify_init
            "call('syscall', 317, 1, 0, None)\n"  # seccomp
            "call('syscall', 450, 0, 0, 0, 0)\n"  # the first that is later than what is known
            "call('prctl', 22, 1, 0, 0, 0)\n"  # PR_SET_SECCOMP
            "call('prctl', 78, 1, 1 << 20, 0, 0)\n"  # PR_FUTEX_HASH, of 64 MB
        )
    )
    assert [line.split()[1] for line in box.output.splitlines()] == [
        *["ENOSYS"] * 4,
        "EPERM",
        *["EPROTONOSUPPORT"] * 3,
        "ENOSYS",
        "EPERM",
        *["ENOSYS"] * 2,
        *["EINVAL"] * 2,
    ]


def test_files_are_copied_without_the_calls_that_are_not_there(world: World) -> None:
    box = world.run(
        python(
            "import asyncio, os, shutil, socket\n"
            "open('/tmp/a', 'wb').write(b'x' * 300_000)\n"
            "shutil.copyfile('/tmp/a', '/tmp/b')\n"
            "here, there = socket.socketpair()\n"
            "here.sendfile(open('/tmp/a', 'rb'), count=1000)\n"
            "os.system('cat /tmp/a | cat > /tmp/c; cp /tmp/a /tmp/d; head -c 99 /tmp/a | tee /tmp/e > /dev/null')\n"
            "print(len(there.recv(2000)), *(os.path.getsize(f'/tmp/{name}') for name in 'bcde'))\n"
        )
    )
    assert box.output == "1000 300000 300000 300000 99\n"


def test_no_box_takes_all_signals_that_may_wait(world: World) -> None:
    box = world.run(
        python(
            SYSTEM_CALLS + "import os, signal\n"
            "number, sent = signal.SIGRTMIN + 3, 0\n"
            "signal.pthread_sigmask(signal.SIG_BLOCK, [number])\n"
            "while sent < 10_000 and libc.sigqueue(os.getpid(), number, None) == 0: sent += 1\n"
            "print(sent)\n"
        )
    )
    assert 0 < int(box.output) <= SIGNALS


def test_open_files_that_a_box_passes_on_keep_no_other_world_from_being_made(
    make_world: Callable[..., World],
) -> None:
    """Linux counts them for all of a user."""
    box = make_world().start(
        python(
            "import os, socket\n"
            "pairs = []\n"
            "file = os.open('/dev/null', os.O_RDONLY)\n"
            "try:\n"
            "    while True:\n"
            "        pairs.append(socket.socketpair())\n"
            "        socket.send_fds(pairs[-1][0], [b'x'], [file] * 250)\n"
            "except OSError:\n"
            "    print('full', flush=True)\n"
            "input()\n"
        ),
        stdin=(ends := os.pipe())[0],
    )
    allowed = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        assert box.wait_for("full", DEADLINE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (1024, allowed[1]))  # as most systems have it
        assert make_world().run(["echo", "made"]).output == "made\n"
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, allowed)
        for end in ends:
            os.close(end)
    box.wait()


def test_where_the_machine_has_too_little_memory_that_is_no_fault_of_the_program(world: World) -> None:
    box = world.start(["sleep", "1000"], limits=replace(LIMITS, spare_bytes=10**15))
    with pytest.raises(SandboxMissing, match="too little memory left: end other programs"):
        box.wait(DEADLINE)


def test_a_disk_filler_finds_its_disk_full(world: World) -> None:
    box = world.run(
        python(
            "import errno, os\n"
            "for place in '/tmp', '/dev/shm', '/submission':\n"
            "    written = 0\n"
            "    try:\n"
            "        for n in range(1000):\n"
            "            with open(f'{place}/{n}', 'wb', buffering=0) as file:\n"
            "                written += file.write(bytes(1_000_000))\n"
            "    except OSError as error:\n"
            "        print(errno.errorcode[error.errno], 18_000_000 < written <= 21_000_000)\n"
        ),
        files="write",
    )
    assert box.output == "ENOSPC True\n" * 3
    assert box.cut is None


def test_a_sparse_file_and_a_large_file_are_refused(world: World) -> None:
    box = world.run(
        python(
            "import errno\n"
            "with open('/tmp/sparse', 'wb', buffering=0) as file:\n"
            "    for act in lambda: file.truncate(10**12), lambda: (file.seek(10**12), file.write(b'x')):\n"
            "        try:\n"
            "            act()\n"
            "        except OSError as error:\n"
            "            print(errno.errorcode[error.errno])\n"
        )
    )
    assert lines(box) == ["EFBIG", "EFBIG"]


@pytest.mark.parametrize("place", ["/tmp", "/dev/shm", "/submission"])
def test_countless_empty_files_are_cut(world: World, place: str) -> None:
    source = f"import itertools\nfor n in itertools.count(): open(f'{place}/{{n}}', 'w').close()\n"
    box = world.run(python(source), files="write")
    assert box.cut == "It made more files than its disk is for."


def test_endless_output_is_cut_at_its_limit(world: World) -> None:
    box = world.run(["yes"], limits=replace(LIMITS, output_bytes=100_000))
    assert box.cut == "It wrote more than 0.1 MB."
    assert box.output == "y\n" * 50_000


def test_an_idle_program_is_cut_in_time(world: World) -> None:
    box = world.run(["sleep", "1000"], limits=replace(LIMITS, wall_s=0.3))
    assert box.cut == "It ran longer than 0.3 s."
    assert 0.3 < box.seconds < DEADLINE


def test_cpu_time_of_all_processes_is_summed(world: World) -> None:
    source = "import os\nfor n in range(3): os.fork()\nwhile True: pass"
    box = world.run(python(source), limits=replace(LIMITS, cpu_s=0.5))
    assert box.cut == "It used more than 0.5 s of CPU time."


def test_cpu_time_of_processes_that_have_ended_counts(world: World) -> None:
    box = world.run(["sh", "-c", "while :; do /bin/true; done"], limits=replace(LIMITS, cpu_s=0.5))
    assert box.cut == "It used more than 0.5 s of CPU time."


def test_cpu_time_counts_also_of_children_that_nobody_waits_for(world: World) -> None:
    source = (
        "import os, signal, time\n"
        "signal.signal(signal.SIGCHLD, signal.SIG_IGN)\n"
        "while True:\n"
        "    if not os.fork():\n"
        "        while time.process_time() < 0.2: pass\n"
        "        os._exit(0)\n"
        "    try:\n"
        "        os.wait()\n"  # it waits for the end, and gets nothing of it
        "    except ChildProcessError:\n"
        "        pass\n"
    )
    box = world.run(python(source), limits=replace(LIMITS, cpu_s=1))
    assert box.cut == "It used more than 1 s of CPU time."


# Nothing outlives.


def test_a_daemon_ends_with_its_program(world: World) -> None:
    box = world.run(
        python(
            "import os, signal\n"
            "if not os.fork():\n"
            "    os.setsid()\n"
            "    if not os.fork():\n"
            "        for number in range(1, 32):\n"
            "            try: signal.signal(number, signal.SIG_IGN)\n"
            "            except OSError: pass\n"
            "        print('daemon', flush=True)\n"
            "        while True: signal.pause()\n"
            "    os._exit(0)\n"
            "os.wait()\n"
            "import time\n"
            "while not any(b'-c' in open(f'/proc/{p}/cmdline', 'rb').read()\n"
            "              and p not in ('1', str(os.getpid())) for p in os.listdir('/proc') if p.isdigit()):\n"
            "    time.sleep(0.01)\n"
        )
    )
    assert box.code == 0
    namespace = namespace_of(world)
    left = [Path(f"/proc/{pid}/cmdline").read_bytes() for pid in processes_in(namespace)]
    assert [words for words in left if b"keeper.main" not in words] == []


GRADER = """
import os, sys
from ros2lab.grading.sandbox.worlds import World
world = World()
print(world.run(["readlink", "/proc/self/ns/net"]).output, end="", flush=True)
box = world.start(["sh", "-c", "trap '' INT TERM HUP; setsid sleep 1000 & echo ready; while :; do sleep 1000; done"])
assert box.wait_for("ready", 60)
if sys.argv[1] == "forked":
    child = os.fork()  # it holds all that the grader holds
    if not child:
        os.read(0, 1)
        os._exit(0)
print("ready", flush=True)
os.read(0, 1)
"""


@pytest.mark.parametrize("kind", ["alone", "forked"])
def test_when_the_grader_is_killed_its_boxes_end(kind: str) -> None:
    source = str(Path(worlds.__file__).parents[2])
    grader = subprocess.Popen(
        [sys.executable, "-W", "ignore", "-c", GRADER, kind],
        env={**os.environ, "PYTHONPATH": source},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    with grader:
        assert grader.stdout is not None
        namespace = grader.stdout.readline().strip()
        assert grader.stdout.readline() == "ready\n"
        assert len(processes_in(namespace)) >= 4
        grader.kill()
        await_none_in(namespace)
        # With its standard input, a forked child ends too.


def test_when_the_keeper_is_killed_its_boxes_end(world: World) -> None:
    box = world.start(["sh", "-c", "readlink /proc/self/ns/net; echo ready; exec sleep 1000"])
    assert box.wait_for("ready", DEADLINE)
    namespace = lines(box)[0]
    (keeper,) = (
        pid
        for pid in processes_in(namespace)
        if b"keeper.main" in Path(f"/proc/{pid}/cmdline").read_bytes().split(b"bwrap")[0]
    )
    os.kill(int(keeper), signal.SIGKILL)
    with pytest.raises(SandboxMissing, match=r"The keeper of the sandbox ended \(it was killed\): end other"):
        box.wait(DEADLINE)
    await_none_in(namespace)
    with pytest.raises(RuntimeError, match="the World has ended"):
        world.run(["true"])


def test_a_box_that_has_given_its_output_away_has_ended_all_the_same(world: World) -> None:
    taker = world.start(
        python(
            "import contextlib, os, signal, socket\n"
            "s = socket.socket(socket.AF_UNIX)\n"
            "s.bind('\\0meet')\n"
            "s.listen()\n"
            "print('ready', flush=True)\n"
            "_, kept, _, _ = socket.recv_fds(s.accept()[0], 10, 1)\n"
            "with contextlib.suppress(BrokenPipeError):  # the giver may have ended by now\n"
            "    os.write(kept[0], b'not its own\\n')\n"
            "print('kept', flush=True)\n"
            "signal.pause()\n"
        )
    )
    assert taker.wait_for("ready", DEADLINE)
    giver = world.start(
        python(
            "import os, socket\n"
            "s = socket.socket(socket.AF_UNIX)\n"
            "s.connect('\\0meet')\n"
            "socket.send_fds(s, [b'x'], [1])\n"
        )
    )
    assert giver.wait(DEADLINE / 2) == 0  # not when the other one ends
    assert taker.wait_for("kept", DEADLINE)


def test_boxes_of_worlds_that_are_beside_each_other_do_not_meet(make_world: Callable[..., World]) -> None:
    here = make_world()
    box = here.start(
        python(
            "import socket\ns = socket.socket(socket.AF_UNIX)\ns.bind('\\0meet')\ns.listen()\nprint('ready', flush=True)\ns.accept()"
        )
    )
    assert box.wait_for("ready", DEADLINE)
    connect = python("import socket\nsocket.socket(socket.AF_UNIX).connect('\\0meet')\nprint('met')")
    with here.beside() as there:
        assert "Connection refused" in there.run(connect).output
    assert here.run(connect).output == "met\n"


def test_closing_a_world_ends_its_boxes(make_world: Callable[..., World]) -> None:
    world = make_world()
    box = world.start(["sleep", "1000"])
    world.close()
    assert box.wait(DEADLINE) == 137
    world.close()
    with pytest.raises(RuntimeError, match="the World is closed"):
        world.start(["true"])


@pytest.mark.parametrize("number", [10, pytest.param(50, marks=pytest.mark.thorough)])
def test_many_worlds_leave_nothing(number: int) -> None:
    namespaces = set()
    before = len(list(Path("/proc/self/fd").iterdir()))
    for _ in range(number):
        with World(limits=LIMITS) as world:
            world.start(["sleep", "1000"])
            namespaces.add(namespace_of(world))
    assert len(list(Path("/proc/self/fd").iterdir())) == before
    for namespace in namespaces:
        await_none_in(namespace)


@pytest.mark.parametrize(
    "word", ["a\0b", "\ud800", "x" * 200_000, "x" * 10**7], ids=["zero", "surrogate", "long", "longer"]
)
def test_a_word_that_no_program_can_be_given_ends_one_box(world: World, word: str) -> None:
    """The code of a submission may name a parameter so."""
    other = world.start(["sleep", "600"])
    box = world.run(["true", word])
    assert (box.code, box.cut) == (126, None)
    assert box.output.startswith("It cannot be started: ")
    assert other.code is None
    assert world.run(["true"]).code == 0


# Machines that cannot.


def test_a_limit_of_the_grader_is_not_a_programs() -> None:
    """A low one that may be raised is raised; where it may not, nothing is graded. No umask does harm."""
    source = (
        "import resource, sys\n"
        "from ros2lab.grading.sandbox.worlds import World\n"
        "os.umask(0o777)\n"
        "for kind in (resource.RLIMIT_AS, resource.RLIMIT_FSIZE):\n"
        "    resource.setrlimit(kind, (10**9, resource.getrlimit(kind)[1]))\n"
        "with World() as world:\n"
        "    print(world.run(['sh', '-c', 'ulimit -v']).output.strip(), flush=True)\n"
        "resource.setrlimit(resource.RLIMIT_AS, (10**9, 10**9))\n"
        "World()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import os\n{source}"], capture_output=True, text=True, check=False
    )
    assert done.stdout == "unlimited\n"
    assert "start the grader where `ulimit -Hv` is unlimited" in done.stderr


def test_without_bubblewrap_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(SandboxMissing, match="apt install bubblewrap"):
        World()


def test_another_architecture_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Such a machine cannot be here, so its name is made up."""
    monkeypatch.setattr(bubblewrap.platform, "machine", lambda: "aarch64")
    with pytest.raises(SandboxMissing, match="needs an x86-64 machine and this is aarch64"):
        World()


@pytest.mark.parametrize("uid", ["0", "1000"])
def test_in_a_container_without_user_namespaces_it_says_so(uid: str) -> None:
    source = Path(worlds.__file__).parents[2]
    container = ["bwrap", "--unshare-user", "--disable-userns", "--uid", uid, "--dev-bind", "/", "/"]
    made = "from ros2lab.grading.sandbox.box import *\nfrom ros2lab.grading.sandbox.worlds import *\ntry: World().run(['true'])\nexcept SandboxMissing as e: print(e)\n"
    finished = subprocess.run(
        [*container, sys.executable, "-c", made],
        env={**os.environ, "PYTHONPATH": str(source)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert finished.stdout.startswith("This machine, probably a container, allows no user namespaces"), (
        finished
    )


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("kernel/apparmor_restrict_unprivileged_userns", "1", "AppArmor"),
        ("kernel/unprivileged_userns_clone", "0", "only root"),
        ("user/max_user_namespaces", "0", "user.max_user_namespaces=10000"),
    ],
)
def test_a_kernel_setting_that_refuses_is_named(tmp_path: Path, name: str, value: str, words: str) -> None:
    """These settings cannot be changed in a test, so the files are made up."""
    (tmp_path / name).parent.mkdir()
    (tmp_path / name).write_text(f"{value}\n")
    said = "bwrap: setting up uid map: Permission denied"
    assert words in why(said, tmp_path)
    (tmp_path / name).write_text("2\n")
    assert "probably a container" in why(said, tmp_path)


# What rests on who the grader is: rights, and what is counted by user.
OF_USERS = (
    test_files_of_the_host_are_not_there,
    test_it_writes_nowhere_but_to_its_own_places,
    test_it_has_no_rights_and_can_get_none,
    test_it_cannot_touch_its_parent_and_ends_only_itself,
    test_it_says_nothing_to_linux_about_its_processes,
    test_no_mark_of_one_box_is_there_for_the_next,
    test_no_network_but_its_own,
    test_processes_and_threads_are_counted_for_the_box,
    test_a_fork_bomb_is_ended,
    test_a_disk_filler_finds_its_disk_full,
    test_what_is_held_stands_until_it_is_released,
    test_nothing_that_is_held_lets_itself_go_on,
    test_when_the_grader_is_killed_its_boxes_end,
    test_closing_a_world_ends_its_boxes,
)


@pytest.mark.long
@pytest.mark.timeout(900)  # with --thorough, all of the tests above once more
@pytest.mark.skipif(os.getuid() != 0, reason="only root can become another user")
def test_all_this_holds_for_an_ordinary_user(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """The same tests as nobody, who is shown the Python and the sources that only root can reach."""
    repository = Path(__file__).parents[2]
    shown = {repository, Path(sys.prefix), Path(sys.base_prefix), Path(sys.prefix).resolve()}
    tmp_path.chmod(0o777)
    view = [
        "bwrap",
        "--bind",
        "/",
        "/",
        "--dev-bind",
        "/dev",
        "/dev",
        "--tmpfs",
        str(Path.home()),
        "--tmpfs",
        "/tmp",
    ]
    assert shutil.which("setpriv")
    for path in sorted(shown):
        for parent in reversed(path.parents[:-1]):
            view += ["--dir", str(parent)]
        view += ["--ro-bind", str(path), str(path)]
    view += ["--dir", str(tmp_path), "--bind", str(tmp_path), str(tmp_path)]
    user = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"]
    is_thorough = request.config.getoption("--thorough")
    chosen = [__file__] if is_thorough else [f"{__file__}::{test.__name__}" for test in OF_USERS]
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-x",
        *chosen,
        f"{Path(__file__).with_name('test_submission.py')}::test_what_cannot_be_read",
        f"--basetemp={tmp_path}/base",
        "--rootdir",
        str(repository),
    ]
    finished = subprocess.run(
        [*view, *user, *words],
        env={
            "PATH": os.environ["PATH"],
            "HOME": str(tmp_path),
            "PYTHONPATH": str(Path(worlds.__file__).parents[2]),
            "PYTHONDONTWRITEBYTECODE": "1",
        },
        cwd=repository,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout[-5000:]
    assert ("skipped" in finished.stdout) == is_thorough  # this very test
