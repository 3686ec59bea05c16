"""How many of the real launch's own tests pass with ours, of those that pass with the real packages.

SOURCES holds checkouts of ros2/launch and ros2/launch_ros (branch jazzy). REAL and OURS are Pythons of two
environments with ROS's wheels, pytest, pytest-timeout, pytest-xdist and osrf_pycommon; one has the real `launch`,
`launch_ros`, `launch_xml` and `launch_yaml` besides, by `pip install --no-deps` of those checkouts, the other one
`portable_ros2`. No wheel brings `composition_interfaces`, which the real `launch_ros` imports: the folder of --modules
has a module of that name, whose `srv` has a class `LoadNode` with an empty class `Request`. The packages
`demo_nodes_py` and `test_launch_ros` are to be built and sourced. Nothing of the tests is in this project, and none is
changed; the tests of style are left out.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Sequence
from pathlib import Path

SUITES = ("launch/launch", "launch/launch_xml", "launch/launch_yaml", "launch_ros/test_launch_ros")
STYLE = shutil.ignore_patterns("test_copyright.py", "test_flake8.py", "test_mypy.py", "test_pep257.py")
TIMEOUT = 60  # s for a test


def main(arguments: Sequence[str] | None = None) -> int:
    """Run them with both; return 0 if as many as are asked for pass with ours."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sources", type=Path, metavar="SOURCES", help="where the checkouts are")
    parser.add_argument("real", type=Path, metavar="REAL", help="the Python that has the real packages")
    parser.add_argument("ours", type=Path, metavar="OURS", help="the Python that has portable_ros2")
    parser.add_argument(
        "--modules", type=Path, help="a folder of Python modules that the real packages import"
    )
    parser.add_argument("--at-least", type=int, default=0, metavar="N", help="how many have to pass (0)")
    options = parser.parse_args(arguments)
    real, ours = (
        {name for suite in SUITES for name in _passed(options, suite, python)}
        for python in (options.real, options.ours)
    )
    print(*sorted(f"fails only with ours: {name}" for name in real - ours), sep="\n")
    print(f"{len(real & ours)} of the {len(real)} that pass with the real packages pass with ours")
    return int(len(real & ours) < options.at_least)


def _passed(options: argparse.Namespace, suite: str, python: Path) -> Iterator[str]:
    """Yield the names of the tests of a suite that pass."""
    prefixes = [os.environ.get("AMENT_PREFIX_PATH", ""), str(python.parent.parent)]
    environ = {
        **os.environ,
        # The real packages look for what they have installed; a sourced workspace comes first.
        "AMENT_PREFIX_PATH": os.pathsep.join(filter(None, prefixes)),
        "PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}",
    }
    if options.modules and python == options.real:
        environ["PYTHONPATH"] = os.pathsep.join(
            [str(options.modules.resolve()), os.environ.get("PYTHONPATH", "")]
        )
    with tempfile.TemporaryDirectory() as folder:
        tests, report = Path(folder, "test"), Path(folder, "report.xml")
        shutil.copytree(options.sources / suite / "test", tests, ignore=STYLE)
        words = [
            "-q",
            "-n",
            "2",
            "--dist",
            "loadfile",
            "--timeout",
            str(TIMEOUT),
            f"--junitxml={report}",
            ".",
        ]
        subprocess.run(
            [str(python.absolute()), "-m", "pytest", *words],
            cwd=tests,
            env={**environ, "ROS_LOG_DIR": str(Path(folder, "log"))},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=False,
        )
        for case in ET.parse(report).iter("testcase"):
            if not any(child.tag in ("failure", "error", "skipped") for child in case):
                yield f"{suite} {case.get('classname')}.{case.get('name')}"


if __name__ == "__main__":
    sys.exit(main())
