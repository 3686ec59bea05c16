"""What a package brings and needs: modules that other packages bring, folders that setuptools takes, programs that are copied."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from setuptools import find_namespace_packages, find_packages
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_text, of_workspace
from ros2lab.diagnose.sources import interfaces
from ros2lab.diagnose.sources.setup_script import packages_in, read_setup

TYPE = "<build_type>ament_python</build_type>"
FOUND = "find_packages(exclude=['test'])"
ROWS = "    data_files=["


def right() -> Files:
    return Files.right(NAMES[1])


def importing(line: str, *tags: str) -> Files:
    files = right().change("node", "import rclpy\n", f"import rclpy\n{line}\n")
    return files.change("package.xml", "  <export>", "".join(f"  {tag}\n" for tag in tags) + "  <export>")


def told(files: Files, root: Path) -> list[str]:
    return [finding.code for finding in of_workspace(files.write(root))]


def proposed(files: Files, root: Path, code: str) -> list[str]:
    return [finding.fix for finding in of_workspace(files.write(root)) if finding.code == code]


def with_units(files: Files, name: str = "units_py", module: str = "units") -> Files:
    """Add a package that installs a module of another name."""
    manifest = files.texts["src/my_bot/package.xml"].replace("my_bot", name)
    setup = f"from setuptools import setup\nsetup(name='{name}', version='0.1.0', packages=['{module}'], data_files=[('share/ament_index/resource_index/packages', ['resource/{name}']), ('share/{name}', ['package.xml'])])\n"
    made = {"package.xml": manifest, "setup.py": setup, f"resource/{name}": "", f"{module}/__init__.py": ""}
    made[f"{module}/si.py"] = "LIMIT = 1\n"
    files.texts |= {f"src/{name}/{path}": text for path, text in made.items()}
    return files


BUFFER = "from tf2_ros import Buffer\nprint(Buffer)"
SI = "from units.si import LIMIT\nprint(LIMIT)"


@pytest.mark.parametrize(
    ("line", "tags", "wanted"),
    [
        (BUFFER, ["<depend>tf2_ros_py</depend>"], []),
        (BUFFER, ["<exec_depend>tf2_ros_py</exec_depend>"], []),
        (BUFFER, [], ["tf2_ros_py"]),
        (BUFFER, ["<depend>tf2_ros</depend>"], ["tf2_ros_py"]),
        ("import PyKDL\nprint(PyKDL)", ["<exec_depend>python_orocos_kdl_vendor</exec_depend>"], []),
        ("import tf2_geometry_msgs\nprint(tf2_geometry_msgs)", [], ["tf2_geometry_msgs"]),
        ("from sensor_msgs_py import point_cloud2\nprint(point_cloud2)", [], ["sensor_msgs_py"]),
        ("try:\n    import tf2_ros\nexcept ImportError:\n    tf2_ros = None\nprint(tf2_ros)", [], []),
        (SI, [], ["units_py"]),
        (SI, ["<depend>units_py</depend>"], []),
    ],
)
def test_what_is_declared_is_the_package_that_brings_a_module(
    tmp_path: Path, line: str, tags: list[str], wanted: list[str]
) -> None:
    fixes = proposed(with_units(importing(line, *tags)), tmp_path, "dependency-undeclared")
    assert fixes == [f"add <depend>{name}</depend> to package.xml" for name in wanted]


def test_a_module_of_its_own_is_not_another_packages(tmp_path: Path) -> None:
    files = with_units(importing("import units\nprint(units)")).put("PACKAGE/units.py", "LIMIT = 1\n")
    assert "dependency-undeclared" not in told(files, tmp_path)


def test_the_installed_packages_say_which_modules_they_bring(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = tmp_path / "lib/python3.12/site-packages"
    for name, modules in (("urdfdom_py", "urdf_parser_py\n"), ("pyserial", "serial\n")):
        (site / f"{name}-1.2.1-py3.12.egg-info").mkdir(parents=True)
        (site / f"{name}-1.2.1-py3.12.egg-info/top_level.txt").write_text(modules)
    (tmp_path / interfaces.INDEX).mkdir(parents=True)
    (tmp_path / interfaces.INDEX / "urdfdom_py").touch()
    monkeypatch.setattr(sys, "path", [*sys.path, str(site)])
    assert interfaces.package_of("urdf_parser_py") == "urdfdom_py"
    assert interfaces.package_of("serial") == "python3-serial"
    assert interfaces.package_of("rclpy") == "rclpy"


def test_a_module_that_is_not_installed_comes_with_a_package(tmp_path: Path) -> None:
    error = "Traceback (most recent call last):\n  File \"/x/node.py\", line 1, in <module>\n    import tf2_ros\nModuleNotFoundError: No module named 'tf2_ros'\n"
    first = of_text(error, importing(BUFFER, "<depend>tf2_ros_py</depend>").write(tmp_path))[0]
    assert first.fix.startswith("sudo apt install ros-jazzy-tf2-ros-py, ")


FOLDERS = (
    "p/__init__.py",
    "p/sub/__init__.py",
    "p/sub/deep/__init__.py",
    "p/plain/a.py",
    "p/plain/in/__init__.py",
)
FOLDERS += ("my-pkg/__init__.py", "p.q/__init__.py", "class/__init__.py", "test/__init__.py", "launch/a.py")


@pytest.mark.parametrize("is_namespace", [False, True])
@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"exclude": ("test",)},
        {"include": ("p",)},
        {"include": ("p", "p.*")},
        {"exclude": ("p",)},
        {"exclude": ("p.*",)},
        {"exclude": ("*.sub", "my-*")},
    ],
)
def test_what_is_found_is_what_setuptools_finds(
    tmp_path: Path, asked: dict[str, tuple[str, ...]], is_namespace: bool
) -> None:
    for name in FOLDERS:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    found = (find_namespace_packages if is_namespace else find_packages)(str(tmp_path), **asked)
    assert sorted(packages_in(tmp_path, **asked, is_namespace=is_namespace)) == sorted(found)
    kind = "find_namespace:" if is_namespace else "find:"
    rows = "\n".join(f"{key} =\n    " + "\n    ".join(value) for key, value in asked.items())
    (tmp_path / "setup.cfg").write_text(
        f"[options]\npackages = {kind}\n[options.packages.find]\nwhere = .\n{rows}\n"
    )
    (tmp_path / "setup.py").write_text("from setuptools import setup\nsetup()\n")
    script = read_setup(tmp_path, "setup.py")
    assert script is not None
    assert sorted(script.keywords["packages"]) == sorted(found)


SUB = {"PACKAGE/sub/__init__.py": "", "PACKAGE/sub/si.py": "LIMIT = 1\n"}
USES = "from my_bot.sub.si import LIMIT\nprint(LIMIT)"
DEEP = {"PACKAGE/a/__init__.py": "X = 1\n", "PACKAGE/a/b/__init__.py": "", "PACKAGE/a/b/u.py": "L = 1\n"}


@pytest.mark.parametrize(
    ("packages", "made", "line", "wanted"),
    [
        ("['my_bot', 'my_bot/sub']", SUB, USES, []),
        ("['my_bot', 'my_bot/sub/']", SUB, USES, []),
        ("[package_name, os.path.join(package_name, 'sub')]", SUB, USES, []),
        ("['my_bot', 'my_bot.sub']", SUB, USES, []),
        ("['my_bot']", SUB, USES, ["['my_bot', 'my_bot.sub']"]),
        ("['my_bot']", SUB | DEEP, f"{USES}\nfrom my_bot.a import X\nprint(X)", ["['my_bot', 'my_bot.sub', 'my_bot.a', 'my_bot.a.b']"]),
        ("find_packages(include=['my_bot'])", SUB | DEEP, f"{USES}\nfrom my_bot.a import X\nprint(X)", ["find_packages(include=['my_bot', 'my_bot.sub', 'my_bot.a', 'my_bot.a.b'])"]),
        ("find_packages()", {"my-tools/__init__.py": "", "my-tools/a.py": "A = 1\n"}, "", []),
        ("['my_bot']", DEEP, "from my_bot.a.b.u import L\nprint(L)", ["['my_bot', 'my_bot.a', 'my_bot.a.b']"]),
        ("['my_bot']", DEEP | {"PACKAGE/a/__init__.py": "from .b import u\nprint(u)\n"}, "", []),
    ],
)  # fmt: skip
def test_what_setup_must_list(
    tmp_path: Path, packages: str, made: dict[str, str], line: str, wanted: list[str]
) -> None:
    files = importing(line).change("setup.py", FOUND, packages)
    for name, text in made.items():
        files.put(name, text)
    fixes = proposed(files, tmp_path, "package-not-listed")
    assert len(fixes) == len(wanted)
    assert all(f"`packages={right}," in fix for fix, right in zip(fixes, wanted, strict=True))


PATH = "import sys\nfrom ament_index_python.packages import get_package_share_directory\nsys.path.append(get_package_share_directory('my_bot'))\n"
NET = "from models.net import load\nprint(load)"
TAKEN = "('share/my_bot/models', ['models/__init__.py', 'models/net.py']),"
WALKED = "*[(d, [os.path.join(d, f) for f in fs]) for d, _, fs in os.walk('models')],"


@pytest.mark.parametrize(
    ("line", "row", "is_told"),
    [
        (PATH + NET, TAKEN, False),
        (PATH + NET, "('share/my_bot/models', glob('models/*.py')),", False),
        (PATH + NET, WALKED, False),
        (NET, TAKEN, True),
        (PATH + NET, "", True),
        (PATH + NET.replace("models", "extra"), TAKEN, True),
    ],
)
def test_modules_that_are_data_are_found_by_a_path(
    tmp_path: Path, line: str, row: str, is_told: bool
) -> None:
    files = importing(line, "<depend>ament_index_python</depend>").change("setup.py", FOUND, "['my_bot']")
    files.change("setup.py", ROWS, f"{ROWS}\n        {row}")
    for folder in ("models", "extra"):
        files.put(f"{folder}/__init__.py", "").put(f"{folder}/net.py", "def load():\n    return 1\n")
    assert told(files, tmp_path) == ["package-not-listed"] * is_told


@pytest.mark.parametrize(
    ("row", "mode", "said"),
    [
        ("('lib/my_bot', ['scripts/talker', 'scripts/ears', 'scripts/wheels']),", 0o755, ""),
        ("(os.path.join('lib', package_name), glob('scripts/*')),", 0o755, ""),
        ("*[('lib/my_bot', [str(p) for p in Path('scripts').iterdir()])],", 0o755, ""),
        ("('lib/my_bot', ['scripts/talker', 'scripts/ears']),", 0o755, "so wheels goes into bin"),
        ("('lib/my_bot', glob('scripts/*')),", 0o644, "so the executables go into bin"),
        ("('bin', glob('scripts/*')),", 0o755, "so the executables go into bin"),
        ("('share/my_bot/scripts', glob('scripts/*')),", 0o755, "so the executables go into bin"),
    ],
)
def test_programs_that_are_copied_need_no_setup_cfg(tmp_path: Path, row: str, mode: int, said: str) -> None:
    files = right().remove("setup.cfg").change("setup.py", ROWS, f"{ROWS}\n        {row}")
    files.change("setup.py", "from setuptools", "from pathlib import Path\nfrom setuptools")
    for name in ("talker", "ears", "wheels"):
        files.put(f"scripts/{name}", f"#!/usr/bin/env python3\nfrom my_bot.{name} import main\nmain()\n")
    files.write(tmp_path)
    for path in tmp_path.glob("src/my_bot/scripts/*"):
        path.chmod(mode)
    causes = [f.cause for f in of_workspace(tmp_path) if f.code == "setup-cfg-missing"]
    assert len(causes) == bool(said)
    assert all(said in cause for cause in causes)


CATKIN = "find_package(catkin REQUIRED)\ncatkin_python_setup()\n"
TOOL = "<buildtool_depend>catkin</buildtool_depend>"
BOTH = '<build_type condition="$ROS_VERSION == 1">catkin</build_type><build_type condition="$ROS_VERSION == 2">ament_python</build_type>'


@pytest.mark.parametrize(
    ("tags", "kind", "cmake", "wanted"),
    [
        (TOOL, "", CATKIN, ["build-type-unknown"]),
        ("", "<build_type>catkin</build_type>", CATKIN, ["build-type-unknown"]),
        (TOOL, "", "", ["build-type-missing"]),
        ("", "", "", ["build-type-missing"]),
        (TOOL, TYPE, "", []),
        (TOOL.replace("d>c", 'd condition="$ROS_VERSION == 1">c'), BOTH, CATKIN, []),
        ("<buildtool_depend>ament_cmake</buildtool_depend>", "", CATKIN, []),
    ],
)
def test_a_package_of_ros_1_is_told_alone(
    tmp_path: Path, tags: str, kind: str, cmake: str, wanted: list[str]
) -> None:
    files = (
        right().change("package.xml", TYPE, kind).change("package.xml", "  <export>", f"{tags}\n  <export>")
    )
    if cmake:
        files.put("CMakeLists.txt", cmake)
    assert told(files, tmp_path) == wanted


CMAKE = "project(my_bot)\nfind_package(ament_cmake REQUIRED)\n{}ament_package()\n"


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("", "touch src/my_bot/COLCON_IGNORE, then mv "),
        ("# install(DIRECTORY launch DESTINATION share/my_bot)\n", "touch src/my_bot/COLCON_IGNORE, then mv "),
        ("install(DIRECTORY launch DESTINATION share/my_bot)\n", "write `install(PROGRAMS scripts/one.py scripts/two.py DESTINATION"),
        ("install(PROGRAMS scripts/one.py scripts/two.py DESTINATION lib/my_bot)\n", ""),
        ("install(DIRECTORY scripts DESTINATION lib/my_bot)\n", ""),
        ('rosidl_generate_interfaces(${PROJECT_NAME} "msg/Pose.msg")\n', ""),
        ("add_executable(driver src/driver.cpp)\n", ""),
        ("add_library(driver src/driver.cpp)\ninstall(TARGETS driver DESTINATION lib/my_bot)\n", ""),
        ("ament_python_install_package(my_bot)\n", ""),
        ("if(BUILD_TESTING)\n  find_package(ament_lint_auto REQUIRED)\nendif()\n", "touch src/my_bot/COLCON_IGNORE, then mv "),
    ],
)  # fmt: skip
def test_a_package_of_cmake_that_installs_files_installs_its_programs_too(
    tmp_path: Path, line: str, fix: str
) -> None:
    files = (
        right().change("package.xml", "ament_python", "ament_cmake").put("CMakeLists.txt", CMAKE.format(line))
    )
    node = files.texts[files.path("node")]
    for name in ("setup.py", "setup.cfg", "node", "listener", "driver"):
        files.remove(name)
    files.put("scripts/one.py", node).put("scripts/two.py", node)
    fixes = proposed(files, tmp_path, "build-type-cmake")
    assert len(fixes) == bool(fix)
    assert all(found.startswith(fix) for found in fixes)


@pytest.mark.parametrize(("folder", "is_of_interfaces"), [("my_bot", False), ("bot", False), ("bot", True)])
def test_a_package_of_cmake_without_anything_to_make_is_made_anew(
    tmp_path: Path, folder: str, is_of_interfaces: bool
) -> None:
    """Its folder may have another name; one of interfaces has something to make, whichever of its files are there."""
    group = "<member_of_group>rosidl_interface_packages</member_of_group>" * is_of_interfaces
    files = (
        right().change("package.xml", "ament_python", "ament_cmake").put("CMakeLists.txt", CMAKE.format(""))
    )
    files.change("package.xml", "  <export>", f"  {group}\n  <export>")
    node = files.texts[files.path("node")]
    texts = {f"scripts/{name}.py": node for name in ("one", "two")}
    texts |= {name: files.texts[files.path(name)] for name in ("package.xml", "CMakeLists.txt")}
    files.texts = {f"src/{folder}/{name}": text for name, text in texts.items()}
    fixes = proposed(files, tmp_path, "build-type-cmake")
    assert len(fixes) != is_of_interfaces
    for fix in fixes:
        assert f"mv src/{folder} src/{folder}_old" in fix
        assert fix.endswith(f"copy one.py, two.py from src/{folder}_old/scripts into src/my_bot/my_bot")


NOT_RUN = "class Gain:\n    pass\n"


@pytest.mark.parametrize(
    ("text", "is_program"),
    [
        (NOT_RUN, False),
        ('"""Sizes."""\nimport math\nSIZE = math.pi\n', False),
        (f"#!/usr/bin/env python3\n{NOT_RUN}", True),
        (f"{NOT_RUN}\n\nif __name__ == '__main__':\n    Gain()\n", True),
        (f"{NOT_RUN}\n\ndef main():\n    Gain()\n", True),
    ],
)
def test_a_module_that_cmake_does_not_install_is_no_program(
    tmp_path: Path, text: str, is_program: bool
) -> None:
    line = "install(DIRECTORY launch DESTINATION share/my_bot)\n"
    files = right().change("package.xml", "ament_python", "ament_cmake")
    files.put("CMakeLists.txt", CMAKE.format(line))
    for name in ("setup.py", "setup.cfg", "node", "listener", "driver"):
        files.remove(name)
    fixes = proposed(files.put("scripts/one.py", text), tmp_path, "build-type-cmake")
    assert len(fixes) == is_program


@pytest.mark.parametrize(
    ("takes", "given", "is_told"),
    [("kind", "Node", False), ("args", "", True), ("args=None", "[]", True), ("", "", True)],
)
def test_a_main_that_its_file_gives_what_it_needs_is_no_entry_point(
    tmp_path: Path, takes: str, given: str, is_told: bool
) -> None:
    files = right()
    for line in files.texts["src/my_bot/setup.py"].splitlines():
        if ":main'" in line:
            files.change("setup.py", f"{line}\n", "")
    for name in ("listener", "driver", "launch/robot.launch.py"):
        files.remove(name)
    files.change("node", "main(args=None)", f"main({takes})").change(
        "node", "    main()", f"    main({given})"
    )
    files.change("node", "init(args=args)", "init()")
    assert len(proposed(files, tmp_path, "entry-points-missing")) == is_told


@pytest.mark.parametrize(
    ("keywords", "is_told"),
    [
        ("package_data={'my_bot': ['plug/*']},", False),
        ("package_data={'': ['*/*.py']},", False),
        ("package_data={'my_bot': ['**/*.py']},", False),
        ("include_package_data=True,", False),
        ("package_data={'my_bot': ['plug/*.yaml']},", True),
        ("", True),
    ],
)
def test_modules_may_be_installed_as_the_data_of_a_package(
    tmp_path: Path, keywords: str, is_told: bool
) -> None:
    files = importing("from my_bot.plug.gain import GAIN").put("my_bot/plug/gain.py", "GAIN = 2\n")
    files.put("my_bot/plug/a.yaml", "").put("MANIFEST.in", "recursive-include my_bot *\n")
    files.change("setup.py", "    zip_safe=True,", f"    zip_safe=True,\n    {keywords}")
    assert len(proposed(files, tmp_path, "init-file-missing")) == is_told


@pytest.mark.parametrize("keywords", ["", "data_files=[('share/my_bot/plug', ['plug/gain.py'])],"])
def test_what_no_import_finds_may_be_installed_as_data(tmp_path: Path, keywords: str) -> None:
    files = importing("from plug.gain import GAIN").put("plug/gain.py", "GAIN = 2\n")
    if keywords:
        files.change("setup.py", "data_files=[", f"{keywords[:-2]}, ")
    causes = [one.cause for one in of_workspace(files.write(tmp_path)) if one.code == "init-file-missing"]
    assert len(causes) == 1
    assert causes[0].endswith(
        "so find_packages() skips it, and an installed program cannot import anything in it."
    )


def hyphenated(folder: str, file: str) -> Files:
    """Return a package with one program that no entry point names, and hyphens in its names."""
    files = right()
    setup = re.sub(r"'\w+ = my_bot[^']*',?", "", files.texts[files.path("setup.py")])
    files.texts = {
        path.replace("my_bot/talker", f"my_bot/{file}").replace("my_bot", folder): text.replace(
            "my_bot", folder
        )
        for path, text in (files.texts | {files.path("setup.py"): setup}).items()
        if not re.search(r"launch/|config/|ears|wheels", path)
    }
    return files


@pytest.mark.parametrize(
    ("folder", "file", "fix"),
    [
        ("my-pkg", "node", "mv src/my-pkg/my-pkg src/my-pkg/my_pkg, and add 'node = my_pkg.node:main'"),
        ("my-pkg", "my-node", "mv src/my-pkg/my-pkg src/my-pkg/my_pkg, and mv src/my-pkg/my_pkg/my-node.py src/my-pkg/my_pkg/my_node.py, and add 'my_node = my_pkg.my_node:main'"),
        ("my_pkg", "my-node", "mv src/my_pkg/my_pkg/my-node.py src/my_pkg/my_pkg/my_node.py, and add 'my_node = my_pkg.my_node:main'"),
        ("my-pkg", "2node", "mv src/my-pkg/my-pkg src/my-pkg/my_pkg, and add '2node = my_pkg.2node:main'"),
        ("my_pkg", "node", "add 'node = my_pkg.node:main'"),
    ],
)  # fmt: skip
def test_what_has_a_hyphen_is_renamed_and_nothing_else(
    tmp_path: Path, folder: str, file: str, fix: str
) -> None:
    (found,) = proposed(hyphenated(folder, file), tmp_path, "entry-points-missing")
    assert found == f"{fix} to 'console_scripts' in entry_points"


@pytest.mark.parametrize("slip", ["", "import os\nprint('a'\n"])
def test_every_program_is_to_have_an_entry_point(tmp_path: Path, slip: str) -> None:
    """Also one that Python cannot read yet."""
    files = hyphenated("my_pkg", "node")
    files.texts["src/my_pkg/my_pkg/other.py"] = slip + files.texts["src/my_pkg/my_pkg/node.py"]
    (fix,) = proposed(files, tmp_path, "entry-points-missing")
    rows = "'node = my_pkg.node:main', 'other = my_pkg.other:main'"
    assert fix == f"add {rows} to 'console_scripts' in entry_points"


@pytest.mark.parametrize(("other", "is_taken"), [("my_pkg", True), ("my_pkg2", False)])
def test_a_name_that_another_package_has_is_not_proposed(tmp_path: Path, other: str, is_taken: bool) -> None:
    files = hyphenated("my-pkg", "node")
    files.texts["src/away/package.xml"] = files.texts["src/my-pkg/package.xml"].replace("my-pkg", other)
    (fix,) = proposed(files, tmp_path, "package-name")
    assert fix.startswith(
        "touch src/my-pkg/COLCON_IGNORE, if src/away" if is_taken else "create the package again"
    )


@pytest.mark.parametrize("is_there", [True, False])
def test_a_move_over_a_file_says_so(tmp_path: Path, is_there: bool) -> None:
    files = hyphenated("my_pkg", "my-node")
    if is_there:
        files.texts["src/my_pkg/my_pkg/my_node.py"] = "LIMIT = 1\n"
    (fix,) = proposed(files, tmp_path, "entry-points-missing")
    told, _, rest = fix.partition("mv src/my_pkg/my_pkg/my-node.py ")
    assert rest.startswith("src/my_pkg/my_pkg/my_node.py")
    assert told.startswith("there is a src/my_pkg/my_pkg/my_node.py already") is is_there
