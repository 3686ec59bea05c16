"""What is there speaks before a guess at a name: modules, parts of an entry point, types that are used, values so far."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text, of_workspace

NAME = NAMES[1]
PACKAGE = f"src/{NAME.package}"
INNER = f"{PACKAGE}/{NAME.package}"
POINT = f"'{NAME.listener} = {NAME.package}.{NAME.listener}:main'"


def test_a_module_that_no_entry_point_calls(tmp_path: Path) -> None:
    root = Files.right(NAME).change("setup.py", f"            {POINT},\n", "").write(tmp_path)
    installed = root / "install" / NAME.package / "lib" / NAME.package
    installed.mkdir(parents=True)
    said = f"student$ ros2 run {NAME.package} {NAME.listener}\nNo executable found\n"
    first = of_text(said, root)[0]
    assert (first.code, first.place) == ("executable-missing", f"{PACKAGE}/setup.py")
    assert first.fix == f"write `{POINT}` into 'console_scripts', and build again"


@pytest.mark.parametrize(
    "written",
    [
        f"{NAME.package}.{NAME.listener}:main = {NAME.listener}",
        f"{NAME.listener} = main:{NAME.package}.{NAME.listener}",
        f"{NAME.listener}: {NAME.package}.{NAME.listener} = main",
    ],
)
def test_an_entry_point_with_its_parts_in_another_order(tmp_path: Path, written: str) -> None:
    files = Files.right(NAME).change("setup.py", POINT, repr(written))
    first = of_workspace(files.write(tmp_path))[0]
    assert (first.code, first.fix) == ("entry-point-spec", f"write {POINT}")


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("ears:my_bot.eers:main", "ears"),
        ("ears; my_bot.eers:main", "ears"),
        ("ears -> my_bot/ears.py:main", "ears"),
        ("hear:eers:main", "hear"),
        ("my_bot.ears:main", "ears"),
        ('hear = my_bot" 5.ears:main', "hear"),
        ('my_bot = my_bot" 5.ears:main', "my_bot"),
        ("hear = my_bot.eers:main()", "hear"),
        ("my ears = my_bot.ears:main", "my_ears"),
    ],
)
def test_an_entry_point_is_written_with_its_own_name_and_a_module_that_exists(
    tmp_path: Path, written: str, name: str
) -> None:
    files = Files.right(NAMES[1]).change("setup.py", "'ears = my_bot.ears:main'", repr(written))
    first = of_workspace(files.write(tmp_path))[0]
    assert (first.code, first.fix) == ("entry-point-spec", f"write '{name} = my_bot.ears:main'")


def test_a_module_with_a_hyphen_in_its_name(tmp_path: Path) -> None:
    files = Files.right(NAME)
    text = files.texts.pop(files.path("listener"))
    files.put(f"{NAME.package}/my-ears.py", text)
    files.change("setup.py", POINT, f"'ears = {NAME.package}.my-ears:main'")
    first = of_workspace(files.write(tmp_path))[0]
    moved = f"mv {INNER}/my-ears.py {INNER}/my_ears.py"
    assert first.fix == f"{moved}, and write 'ears = {NAME.package}.my_ears:main'"


@pytest.mark.parametrize(
    ("chain", "is_fault"),
    [
        ("x > 0", False),
        ("x > 10", True),
        ("x >= 10", True),
        ("x == 10", False),
        ("y > 10", False),
        ("x < 20", False),
    ],
)
def test_a_condition_that_an_earlier_one_takes_all_of(tmp_path: Path, chain: str, is_fault: bool) -> None:
    """The earlier one is x > 5."""
    lines = f"        x = y = self.speed\n        if x > 5:\n            self.speed = 1.0\n        elif {chain}:\n            self.speed = 2.0\n"
    files = Files.right(NAME).change("driver", "    def drive(self):\n", f"    def drive(self):\n{lines}")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "unreachable"]
    assert bool(found) is is_fault
    if found:
        assert found[0].fix == f"check `{chain}` first, and `x > 5` after it"


def failing(line: str, said: str, folder: Path, more: str = "") -> Finding:
    """Return what is told of a line at the head of the driver's callback, at which Python stops."""
    files = Files.right(NAME).change(
        "driver", "    def drive(self):\n", f"    def keep(self, msg):\n{more or '        pass'}\n\n    def drive(self):\n        {line}\n"
    ).change("driver", "self.speed = 0.5", "self.speed = 0.5\n        self.loaves = 0")  # fmt: skip
    root = files.write(folder)
    path = root / INNER / f"{NAME.driver}.py"
    number = path.read_text().splitlines().index(f"        {line}") + 1
    text = (
        f'Traceback (most recent call last):\n  File "{path}", line {number}, in drive\n    {line}\n{said}\n'
    )
    return of_text(text, root)[0]


def test_a_divisor_that_has_no_value_yet(tmp_path: Path) -> None:
    more = "        self.loaves = msg.data"
    told = failing(
        "average = 100 / self.loaves", "ZeroDivisionError: division by zero", tmp_path / "later", more
    )
    assert told.cause.startswith("self.loaves is still 0, as line ")
    assert told.fix == "write `if self.loaves == 0:` above this line, and below that, indented, `return`"
    never = failing("average = 100 / self.loaves", "ZeroDivisionError: division by zero", tmp_path / "never")
    assert never.fix.startswith("make sure the divisor is not 0")


@pytest.mark.parametrize(
    ("quoted", "fix"),
    [
        (
            "79.5",
            "write float(str(self.speed)) instead of int(str(self.speed)); or, for 79, int(float(str(self.speed)))",
        ),
        ("ready", "write a number with a decimal point and without a unit, or catch ValueError around it"),
    ],
)
def test_a_text_of_which_another_number_can_be_made(tmp_path: Path, quoted: str, fix: str) -> None:
    said = f"ValueError: invalid literal for int() with base 10: '{quoted}'"
    assert failing("degrees = int(str(self.speed))", said, tmp_path).fix == fix


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (
            "ros2 topic pub --once /rinse std_srvs/srv/Trigger '{}'",
            "ros2 service call /rinse std_srvs/srv/Trigger '{}'",
        ),
        (
            "ros2 service call /robot/command std_msgs/msg/String '{data: go}'",
            "ros2 topic pub /robot/command std_msgs/msg/String '{data: go}'",
        ),
    ],
)
def test_a_service_is_no_topic(tmp_path: Path, typed: str, meant: str) -> None:
    kind = "srv/Trigger" if "srv/" in typed else "msg/String"
    said = f"student$ {typed}\nThe passed message type is invalid: '{kind}' is not of the kind package/msg/Name\n"
    assert of_text(said, Files.right(NAME).write(tmp_path))[0].fix == f"type `{meant}`"


def test_who_makes_messages_of_its_type_means_it(tmp_path: Path) -> None:
    """The listener comes first in the package, and it is the one that is wrong."""
    files = Files.right(NAME)
    files.change("listener", "from std_msgs.msg import String", "from std_msgs.msg import Int32")
    files.change("listener", "String,", "Int32,")
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "topic-type"]
    assert found
    assert all(one.place.startswith(f"{INNER}/{NAME.listener}.py") for one in found)


def test_what_is_computed_where_a_function_is_defined_is_none_of_its_body(tmp_path: Path) -> None:
    files = Files.right(NAME)
    text = files.texts[files.path("driver")]
    created = next(line.strip() for line in text.splitlines() if "self.create_timer(" in line)
    new = f"def tell(pub=self.create_publisher(Twist, '/other', 10)):\n            pub.publish(Twist(linear=Vector3(x=0.5)))\n\n        {created.replace('self.drive', 'tell')}"
    files.change("driver", created, new)
    files.change(
        "driver", "from geometry_msgs.msg import Twist", "from geometry_msgs.msg import Twist, Vector3"
    )
    found = [one.code for one in of_workspace(files.write(tmp_path))]
    assert "made-again" not in found


def test_a_description_that_is_made_by_a_function_without_a_name(tmp_path: Path) -> None:
    text = (
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n"
        "generate_launch_description = lambda: LaunchDescription(\n"
        f"    [Node(package='{NAME.package}', executable='{NAME.listener}')]\n)\n"
    )
    root = Files.right(NAME).put("launch/robot.launch.py", text).write(tmp_path)
    assert "launch-function" not in [one.code for one in of_workspace(root)]


def test_two_words_in_one_text_of_a_launch_file(tmp_path: Path) -> None:
    said = (
        f"student$ ros2 launch {NAME.package} robot.launch.py\n[stairs-1] usage: stairs [-h] [--side {{left,right}}]\n"
        "[stairs-1] stairs: error: unrecognized arguments: --side left\n"
        "[ERROR] [stairs-1]: process has died [pid 1, exit code 2, cmd 'stairs --side left --ros-args'].\n"
    )
    first = of_text(said, Files.right(NAME).write(tmp_path))[0]
    assert first.fix == "write '--side', 'left' instead of '--side left' in the launch file"


def test_a_dictionary_that_is_gone_through(tmp_path: Path) -> None:
    line = "for name, speed in self.speeds:"
    more = "        self.speeds = {'slow': 0.1}"
    said = "ValueError: too many values to unpack (expected 2)"
    assert (
        failing(f"{line} pass", said, tmp_path, more).fix
        == "write self.speeds.items() instead of self.speeds"
    )


def driver_with(folder: Path, *methods: str) -> Path:
    """Return a workspace whose driver has more methods, which its callback calls as keep(), and its source."""
    more = "\n\n".join(methods)
    files = Files.right(NAME).change(
        "driver", "    def drive(self):\n", f"{more}\n\n    def drive(self):\n        self.keep()\n"
    )
    return files.write(folder) / INNER / f"{NAME.driver}.py"


def line_of(path: Path, text: str) -> int:
    return next(n for n, line in enumerate(path.read_text().splitlines(), 1) if text in line)


def test_each_if_of_a_chain_is_told(tmp_path: Path) -> None:
    chain = (
        "    def keep(self):\n        if self.count == 1:\n            self.speed = 0.8\n"
        "        if self.count == 2:\n            self.speed = 0.2\n"
        "        if self.count == 3:\n            self.speed = 0.1\n        else:\n            self.speed = 0.0"
    )
    path = driver_with(tmp_path, chain)
    (finding,) = (one for one in of_workspace(tmp_path) if one.code == "replaced")
    first, second = line_of(path, "count == 2"), line_of(path, "count == 3")
    assert finding.place.endswith(f":{first}")
    assert finding.fix == f"write elif instead of if on lines {first} and {second}"


@pytest.mark.parametrize(
    ("line", "said", "fix"),
    [
        (
            "rate = self.rates[str(self.loaves)]",
            "KeyError: '0'",
            "write these two lines above line 21: `if str(self.loaves) not in self.rates:`",
        ),
        ("rate = self.rates['Stop']", "KeyError: 'Stop'", "write 'stop' instead of 'Stop'"),
        ("humidity = self.parts[1]", "IndexError: list index out of range", "print self.text above line "),
        ("latest = self.kept[3]", "IndexError: list index out of range", "print self.kept on the line above"),
        (
            "least = min(self.kept[5:8])",
            "ValueError: min() arg is an empty sequence",
            "print len(self.kept), and",
        ),
        (
            "least = max(self.kept[5:])",
            "ValueError: max() iterable argument is empty",
            "print len(self.kept), and",
        ),
        (
            "least = min(k for k in self.kept if k < 'a')",
            "ValueError: min() arg is an empty sequence",
            "keep the values in a list",
        ),
        (
            "first = self.kept.pop()",
            "IndexError: pop from empty list",
            "check first that self.kept is not empty",
        ),
        (
            "one = min(max(self.kept), max(self.parts))",
            "ValueError: max() arg is an empty sequence",
            "check first that there is one",
        ),
    ],
)
def test_an_element_that_is_not_there(tmp_path: Path, line: str, said: str, fix: str) -> None:
    """What is known only as it runs is no part of the fix, and another element is none."""
    more = "        self.rates = {'stop': 0.0}\n        self.text = msg.data\n        self.parts = self.text.split(',')\n        self.kept = list(self.text)"
    assert failing(line, said, tmp_path, more).fix.startswith(fix)


def test_a_property_that_sets_itself(tmp_path: Path) -> None:
    getter = "    @property\n    def rate(self):\n        return self._rate"
    setter = "    @rate.setter\n    def rate(self, value):\n        self.rate = value"
    path = driver_with(tmp_path, getter, setter, "    def keep(self):\n        self.rate = 1")
    number = line_of(path, "self.rate = value")
    said = f'Traceback (most recent call last):\n  File "{path}", line {number}, in rate\n    self.rate = value\nRecursionError: maximum recursion depth exceeded'
    assert of_text(said, tmp_path)[0].fix.startswith("write self._rate instead of self.rate here")


def test_what_a_setter_keeps_is_read_by_the_getter(tmp_path: Path) -> None:
    getter = "    @property\n    def load(self):\n        return self._load"
    setter = "    @load.setter\n    def load(self, value):\n        self._load = value % 5"
    driver_with(tmp_path, getter, setter, "    def keep(self):\n        self.load = 1")
    assert of_workspace(tmp_path) == []


def test_prints_in_place_of_returns(tmp_path: Path) -> None:
    speed = (
        "def speed_for(word):\n    if word == 'fast':\n        print(0.8)\n    else:\n        print(0.0)\n"
    )
    test = f"from {NAME.package}.speed import speed_for\n\n\ndef test_fast():\n    assert speed_for('fast') == 0.8\n"
    files = Files.right(NAME)
    files.texts |= {f"{INNER}/speed.py": speed, f"{PACKAGE}/test/test_speed.py": test}
    root = files.write(tmp_path)
    said = (
        "    def test_fast():\n>       assert speed_for('fast') == 0.8\nE       AssertionError: assert None == 0.8\n"
        "E        +  where None = speed_for('fast')\n\ntest/test_speed.py:5: AssertionError"
    )
    assert (
        of_text(said, root)[0].fix
        == "write return instead of print: `return 0.8` on line 3, and `return 0.0` on line 5"
    )


@pytest.mark.parametrize("times", [2, 3])
def test_each_key_that_stands_again_is_told(tmp_path: Path, times: int) -> None:
    points = "".join(
        f"            'console_scripts': ['n{n} = {NAME.package}.{NAME.listener}:main'],\n"
        for n in range(1, times)
    )
    files = Files.right(NAME).change("setup.py", "entry_points={\n", f"entry_points={{\n{points}")
    (finding,) = (one for one in of_workspace(files.write(tmp_path)) if one.code == "replaced")
    assert ("twice" if times == 2 else "three times") in finding.cause
    assert ("this entry" if times == 2 else "the others") in finding.fix


SHARE = f"/home/student/ws/install/{NAME.package}/share/{NAME.package}"
ROW = "('share/ament_index/resource_index/packages'"


@pytest.mark.parametrize(
    ("row", "wanted", "code", "fix"),
    [
        (
            "",
            "data/way.csv",
            "not-in-data-files",
            f"add ('share/{NAME.package}/data', ['data/way.csv']) to data_files and build again",
        ),
        (
            "",
            "way.csv",
            "not-in-data-files",
            f"add ('share/{NAME.package}', ['data/way.csv']) to data_files and build again",
        ),
        (
            f"('share/{NAME.package}', ['data/way.csv']),",
            "data/way.csv",
            "installed-elsewhere",
            f"write 'share/{NAME.package}/data' instead of 'share/{NAME.package}' in data_files, and build again",
        ),
        (
            f"('share/{NAME.package}/data', ['data/way.csv']),",
            "data/way.csv",
            "install-stale",
            f"colcon build --packages-select {NAME.package}, and run the same command again",
        ),
        ("", "data/ways.csv", "data-file-missing", "write way.csv instead of ways.csv"),
        (
            "",
            "urdf/robot.urdf",
            "data-file-missing",
            f"create the file {PACKAGE}/urdf/robot.urdf",
        ),
    ],
)
def test_a_file_that_is_not_in_the_share_folder(
    tmp_path: Path, row: str, wanted: str, code: str, fix: str
) -> None:
    files = Files.right(NAME).put("data/way.csv", "1,2\n").change("setup.py", ROW, f"{row}\n        {ROW}")
    root = files.write(tmp_path)
    said = f"FileNotFoundError: [Errno 2] No such file or directory: '{SHARE}/{wanted}'"
    report = f'Traceback (most recent call last):\n  File "{root}/{INNER}/{NAME.module}.py", line 9, in __init__\n    with open(path) as f:\n{said}\n'
    for text in (
        f"$ ros2 run {NAME.package} {NAME.module}\n{report}",
        f"$ ros2 launch {NAME.package} robot.launch.py\n[ERROR] [launch]: Caught exception in launch (see debug for "
        f"traceback): Caught multiple exceptions when trying to load file of format [py]:\n - {said}\n",
    ):
        first = of_text(text, root)[0]
        assert (first.code, first.fix) == (code, fix)


@pytest.mark.parametrize("is_installed", [True, False])
@pytest.mark.parametrize(
    "given",
    ["'config/a.yaml'", "{'config/a.yaml'}", "('config/a.yaml',)", "['config/', 'a.yaml']", "ParameterFile('config/a.yaml')", "Path('config/a.yaml')"],
)  # fmt: skip
def test_a_parameter_file_that_is_looked_for_where_launch_is_typed(
    tmp_path: Path, given: str, is_installed: bool
) -> None:
    files = Files.right(NAME).put("config/a.yaml", "/**:\n  ros__parameters:\n    period: 2.0\n")
    if not is_installed:
        (own,) = (
            path.name for path in map(Path, files.texts) if path.suffix == ".yaml" and path.name != "a.yaml"
        )
        files.change("setup.py", "glob('config/*.yaml')", f"['config/{own}']")
    lines = "from pathlib import Path\n\nfrom launch_ros.actions import Node\nfrom launch_ros.parameter_descriptions import ParameterFile\n"
    node = f"Node(package='{NAME.package}', executable='{NAME.module}', parameters=[{given}])"
    files.texts[f"{PACKAGE}/launch/more.launch.py"] = (
        f"{lines}from launch import LaunchDescription\n\n\ndef generate_launch_description():\n    return LaunchDescription([{node}])\n"
    )
    found = of_workspace(files.write(tmp_path))
    told = [one.fix for one in found if one.code == "parameter-file-missing"]
    assert "passed-on" not in [one.code for one in found]
    assert len(told) == ("config/a.yaml" in given)
    assert all(("data_files" in fix) is not is_installed and "at the top" in fix for fix in told)
    lost = [one for one in found if one.code == "not-in-data-files" and "a.yaml" in one.about]
    assert len(lost) == (not is_installed and not told)
    assert not any("cannot be found" in one.cause for one in lost)


def test_a_folder_that_is_not_in_the_share_folder(tmp_path: Path) -> None:
    root = Files.right(NAME).put("maps/a.csv", "1\n").put("maps/b.csv", "2\n").write(tmp_path)
    said = f"FileNotFoundError: [Errno 2] No such file or directory: '{SHARE}/maps'"
    report = f'Traceback (most recent call last):\n  File "{root}/{INNER}/{NAME.module}.py", line 9, in __init__\n    names = os.listdir(path)\n{said}\n'
    first = of_text(report, root)[0]
    assert first.code == "not-in-data-files"
    assert f"('share/{NAME.package}/maps', [str(path) for path in Path('maps').iterdir()])" in first.fix
