"""What a hand-in names that it does not hold, and that is not installed here either."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Collection, Iterable, Sequence
from pathlib import Path, PurePosixPath

from ros2lab.diagnose import interfaces
from ros2lab.diagnose.imports import ROS_1
from ros2lab.diagnose.launch_file import read_launch_file
from ros2lab.diagnose.python_source import PythonSource, read_text
from ros2lab.diagnose.spelling import is_near_miss
from ros2lab.grading.files import launch_files
from ros2lab.grading.graded_package import Package

MARKERS = "share/ament_index/resource_index/packages"  # where the names of installed packages lie
# What a launch file may look up the share folder of a package with, in Python, XML or YAML.
_SHARE_OF = re.compile(
    r"(?:get_package_share\w*|FindPackageShare)\(\s*(?:package(?:_name)?=)?['\"](\w+)|find-pkg-share +(\w+)"
)
_IS_LIST = re.compile(
    r"package\.xml|setup\.(?:py|cfg)|pyproject\.toml|.*requirements.*\.txt|Dockerfile|.*\.sh"
)
_INSTALLS = re.compile(r"^.*\binstall\b.*$", re.MULTILINE)
MOST_PLACES = 20
_HOMES = ("home", "root", "mnt", "media")  # where folders lie that a person has made
_PATH = re.compile(r"/[\w .+-]+(?:/[\w .+-]+)+/?")
# What robots are programmed with beside ROS, by the names that are imported; others must be named where they come from.
_KNOWN = frozenset(
    [
        "Adafruit_DHT",
        "Jetson",
        "RPi",
        "adafruit_blinka",
        "adafruit_motorkit",
        "adafruit_pca9685",
        "apriltag",
        "board",
        "busio",
        "bluetooth",
        "can",
        "cflib",
        "cv2",
        "depthai",
        "dronekit",
        "dynamixel_sdk",
        "evdev",
        "face_recognition",
        "flask",
        "gpiod",
        "gpiozero",
        "gi",
        "gtts",
        "inputs",
        "keyboard",
        "lgpio",
        "mavsdk",
        "mediapipe",
        "mpu6050",
        "open3d",
        "paho",
        "picamera",
        "picamera2",
        "pigpio",
        "playsound",
        "pyaudio",
        "pybullet",
        "pygame",
        "pymavlink",
        "pynput",
        "pyrealsense2",
        "pyttsx3",
        "rplidar",
        "scipy",
        "serial",
        "skimage",
        "sklearn",
        "smbus",
        "smbus2",
        "sounddevice",
        "spidev",
        "speech_recognition",
        "sshkeyboard",
        "tensorflow",
        "tflite_runtime",
        "torch",
        "torchvision",
        "transforms3d",
        "ultralytics",
        "usb",
        "vosk",
        "whisper",
        "zmq",
    ]
)
_PROGRAM_NAME = re.compile(r"[A-Za-z0-9_][\w.-]{0,99}")


def absent_packages(
    packages: Iterable[Package], own: Collection[str], prefixes: Sequence[str]
) -> dict[str, list[str]]:
    """Return what launch files start or name of packages that were not handed in and are not installed here.

    A name that looks like one of those that were handed in is a misspelt one, and no other package.
    """
    found: dict[str, list[str]] = {}

    def is_there(package: str) -> bool:
        is_own = any(package == name or is_near_miss(package, name) for name in own)
        return is_own or is_installed(package, prefixes)

    for path in launch_files(packages):
        for node in read_launch_file(path, path.name).nodes:
            words = (node.package, node.executable)
            if not all(isinstance(word, str) and _PROGRAM_NAME.fullmatch(word) for word in words):
                continue
            if not is_there(node.package) and node.executable not in found.get(node.package, ()):
                found.setdefault(node.package, []).append(node.executable)
        for names in _SHARE_OF.findall(read_text(path)):
            if not is_there(name := "".join(names)):
                found.setdefault(name, [])
    return found


def is_installed(package: str, prefixes: Sequence[str]) -> bool:
    """Return whether an ament package is installed here."""
    return any(prefix and Path(prefix, MARKERS, package).exists() for prefix in prefixes)


def absent_modules(
    root: Path, sources: Iterable[PythonSource], own: Collection[str], unbuilt: Collection[str]
) -> set[str]:
    """Return the modules that sources import and that were not handed in and are not installed here.

    A name that looks like that of one which is there is a misspelt one; one of ROS 1 is in no ROS 2. Those of packages
    that cannot be built here, such as messages of one's own, are among them.

    Args:
        root: the folder into which everything was received.
        sources: that are graded.
        own: the names of all packages that were handed in.
        unbuilt: those of them that cannot be built here.
    """
    tops = {
        found.target.partition(".")[0]
        for source in sources
        for found in source.imports
        if not found.is_guarded
    }
    there = {path.stem for path in root.rglob("*") if path.is_dir() or path.suffix == ".py"}
    known = ({*own} | there) - {*unbuilt} | sys.stdlib_module_names | {*ROS_1}
    return {
        top
        for top in tops - known
        if top.isidentifier() and not interfaces.is_installed(top)
        if top in unbuilt or not (interfaces.meant(top) or any(is_near_miss(top, name) for name in known))
    }


def named_elsewhere(root: Path, modules: Collection[str]) -> set[str]:
    """Return those of some modules of which more than an import tells that they exist.

    They are known, of ROS or not; or a manifest, a list of requirements or a command that installs something names
    them.
    """
    files = (path for path in root.rglob("*") if path.is_file() and not path.is_symlink())
    texts = [
        read_text(path) if _IS_LIST.fullmatch(path.name) else "\n".join(_INSTALLS.findall(read_text(path)))
        for path in files
        if _IS_LIST.fullmatch(path.name) or path.suffix.lower() in (".md", ".rst", ".txt")
    ]
    words = {word for text in texts for word in re.findall(r"\w+", text.replace("-", "_"))}
    return {name for name in modules if name in interfaces.PACKAGES | _KNOWN or name in words}


def named_places(sources: Iterable[PythonSource]) -> list[str]:
    """Return the folders that code names from the root on: where a file of it lies, or one below a home."""
    found = set[str]()
    for source in sources:
        constants = (node.value for node in source.nodes if isinstance(node, ast.Constant))
        for path in {
            PurePosixPath(value) for value in constants if isinstance(value, str) and _PATH.fullmatch(value)
        }:
            is_file = bool(path.suffix)
            if ".." not in path.parts and (is_file or path.parts[1] in _HOMES):
                found.add(str(path.parent if is_file else path))
    return sorted(found)[:MOST_PLACES]
