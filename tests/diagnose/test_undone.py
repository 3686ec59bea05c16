"""What only looks wrong in a transcript: a state that was undone, a word in an answer, a package that nobody needs."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text

RUN = "$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n^Z\n[1]+  Stopped                 ros2 run my_bot talker\n"
MET = "data: running 1\n---\n^C\n"
MISSED = "WARNING: topic [/robot/status] does not appear to be published yet\nCould not determine the type for the passed topic\n"
ECHO = "$ ros2 topic echo /robot/status\n"
ON = "[1]+ ros2 run my_bot talker &\n"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return Files.right(NAMES[1]).write(tmp_path)


@pytest.mark.parametrize(
    "text",
    [
        f"{RUN}$ bg\n{ON}{ECHO}{MET}",
        f"{RUN}$ bg %1\n{ON}$ jobs\n[1]+  Running                 ros2 run my_bot talker &\n",
        f"{RUN}$ fg\nros2 run my_bot talker\n[INFO] [talker]: running 1\n^C\n",
        f"{RUN}$ %1\nros2 run my_bot talker\n^C\n",
        f"{RUN}$ kill %1\n$ jobs\n[1]+  Terminated              ros2 run my_bot talker\n",
        f"{RUN}$ ls\nsrc\n[1]+  Killed                  ros2 run my_bot talker\n",
        f"{RUN}{ECHO}{MISSED}$ bg\n{ON}{ECHO}{MET}",
    ],
)
def test_a_program_that_goes_on_is_not_frozen(text: str, root: Path) -> None:
    assert of_text(text, root) == []


@pytest.mark.parametrize(
    "text",
    [
        RUN,
        f"{RUN}{ECHO}{MISSED}",
        f"{RUN}$ jobs\n[1]+  Stopped                 ros2 run my_bot talker\n",
        f"{RUN}$ bg\n{ON}$ fg\nros2 run my_bot talker\n^Z\n[1]+  Stopped                 ros2 run my_bot talker\n",
        f"{RUN}{ECHO}{MISSED}$ fg\nros2 run my_bot talker\n^C\n",
        f"$ ros2 run my_bot ears\n^Z\n[1]+  Stopped                 ros2 run my_bot ears\n{RUN.replace('[1]', '[2]')}$ bg %1\n[1]- ros2 run my_bot ears &\n",
        "pc% ros2 run my_bot talker\n^Z\n[1]  + 4711 suspended  ros2 run my_bot talker\n",
    ],
)
def test_a_program_that_stands_still_is_all_that_is_told(text: str, root: Path) -> None:
    (finding,) = of_text(text, root)
    assert finding.code == "not-running"
    assert "`ros2 run my_bot talker`" in finding.cause
    assert "`bg`" in finding.fix
    assert "second terminal" in finding.fix


@pytest.mark.parametrize(
    "text",
    [
        "$ ros2 interface show std_srvs/srv/Trigger\n---\nbool success   # whether it did well\nstring message # informational, e.g. for error messages\n",
        "$ ros2 interface show diagnostic_msgs/msg/DiagnosticStatus\nbyte OK=0\nbyte ERROR=2\n",
        "$ ros2 topic list\n/chatter\n/error\n",
        "$ ros2 action list -t\n/failed [demo/action/Failed]\n",
        "$ ros2 param get /talker mode\nString value is: unknown error\n",
        "$ ros2 service call /reset std_srvs/srv/Trigger\nrequester: making request: std_srvs.srv.Trigger_Request()\n\nresponse:\nstd_srvs.srv.Trigger_Response(success=True, message='no error')\n",
        "$ ls\nerror.txt  failed_runs\n",
    ],
)
def test_a_word_of_an_answer_is_no_error(text: str, root: Path) -> None:
    assert of_text(text, root) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("$ ros2 topic info /error\nUnknown topic '/error'\n", "/error"),
        ("$ ros2 interface show std_msgs/msg/Strin\nUnknown interface 'std_msgs/msg/Strin'\n", "Strin"),
        ("$ ros2 run my_bot talker\nerror: x = 5 failed\n", "failed"),
        ("$ cat notes.txt\ncat: notes.txt: No such file or directory\n", "notes.txt"),
    ],
)
def test_what_a_tool_says_itself_is_told(text: str, said: str, root: Path) -> None:
    assert said in of_text(text, root)[0].cause


LATER = "def plan():\n    return 'next week'\n"
SETUP = "from setuptools import setup\n\nsetup(name='later', version='0.0.1', packages=['later'], data_files=[('share/ament_index/resource_index/packages', ['resource/later']), ('share/later', ['package.xml'])], install_requires=['setuptools'])\n"
MANIFEST = "<?xml version='1.0'?>\n<package format='3'><name>later</name><version>0.0.1</version><description>Plans.</description><maintainer email='a@b.de'>A</maintainer><license>MIT</license><export><build_type>ament_python</build_type></export></package>\n"


def with_a_later_package(root: Path) -> Path:
    """Add a package that is not built to a workspace in which the other one is, as far as ROS is asked."""
    folder = root / "src/later"
    for name, text in {
        "later/__init__.py": "",
        "later/plan.py": LATER,
        "setup.py": SETUP,
        "setup.cfg": "[develop]\nscript_dir=$base/lib/later\n[install]\ninstall_scripts=$base/lib/later\n",
        "package.xml": MANIFEST,
        "resource/later": "",
    }.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    (root / "install").mkdir(exist_ok=True)
    (root / "install/setup.bash").touch()
    return root


def unbuilt(text: str, root: Path) -> list[str]:
    return [one.place for one in of_text(text, root) if one.code == "not-built" and "later" in one.place]


@pytest.mark.parametrize(
    "text",
    [
        "$ colcon build --packages-up-to my_bot\nStarting >>> my_bot\nFinished <<< my_bot [2.41s]\n\nSummary: 1 package finished [5.10s]\n",
        "$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n^C\n",
        "$ ros2 launch my_bot robot.launch.py\n[INFO] [talker-1]: process started with pid [2]\n^C\n",
    ],
)
def test_a_package_that_no_command_needs_is_not_missed(text: str, root: Path) -> None:
    with_a_later_package(root)
    assert unbuilt(text, root) == []
    talker = root / "src/my_bot/my_bot/talker.py"
    talker.write_text(f"from later.plan import plan\n{talker.read_text()}", encoding="utf-8")
    assert unbuilt(text, root)


@pytest.mark.parametrize(
    "text",
    [
        "$ colcon build\n$ ros2 run my_bot talker\n[INFO] [talker]: running 0\n",
        "$ ros2 pkg prefix later\nPackage not found\n",
        "$ ros2 pkg list\n",
    ],
)
def test_a_package_that_one_may_need_is(text: str, root: Path) -> None:
    assert unbuilt(text, with_a_later_package(root))
