"""Modules that only the build makes are there, however they are imported; misspelt and forgotten ones are not."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace
from ros2lab.diagnose.look import Look
from ros2lab.trial.words import own_words

NAME = NAMES[1]
MAKER = """\
from pathlib import Path
from setuptools.command.build_py import build_py


class BuildWithTable(build_py):
    def run(self):
        super().run()
        (Path(self.build_lib) / 'PACKAGE' / {file}).write_text('LIMIT = 1.0')


package_name = 'PACKAGE'
"""
IMPORTS = [
    "from PACKAGE.table import LIMIT",
    "from .table import LIMIT",
    "from PACKAGE import table",
    "from . import table",
    "import PACKAGE.table",
    "import PACKAGE.table as limits",
]
MISSING = frozenset(("module-missing", "import-wrong", "entry-point-module"))


def made(imports: str, file: str = "'table.py'") -> Files:
    """Return a workspace whose setup.py writes a module, which a node imports."""
    files = Files.right(NAME).change("setup.py", "package_name = 'PACKAGE'\n", MAKER.format(file=file))
    files.change(
        "setup.py", "    zip_safe=True,", "    zip_safe=True,\n    cmdclass={'build_py': BuildWithTable},"
    )
    return files.change("node", "import rclpy\n", f"import rclpy\n{imports}\n")


def missing(files: Files, folder: Path) -> list[tuple[str, str]]:
    """Return code and fix of what is said to be missing."""
    return [(f.code, f.fix) for f in of_workspace(files.write(folder)) if f.code in MISSING]


def install(files: Files, module: str) -> Files:
    """Put a module where the package is installed."""
    files.texts[f"install/{NAME.package}/lib/python3.12/site-packages/{NAME.package}/{module}.py"] = (
        "LIMIT = 1.0\n"
    )
    return files


@pytest.mark.parametrize("imports", IMPORTS)
def test_a_module_that_setup_writes_is_there(tmp_path: Path, imports: str) -> None:
    assert missing(made(imports), tmp_path) == []


@pytest.mark.parametrize("imports", IMPORTS)
def test_one_whose_name_setup_puts_together_is_there_if_it_is_installed(tmp_path: Path, imports: str) -> None:
    files = install(made(imports, "f'{Path(__file__).stem}.py'"), "table")
    assert missing(files, tmp_path) == []


def test_one_whose_name_setup_puts_together_may_be_there_before_the_build(tmp_path: Path) -> None:
    assert missing(made(IMPORTS[0], "f'{Path(__file__).stem}.py'"), tmp_path) == []


def test_an_entry_point_may_name_it(tmp_path: Path) -> None:
    files = made(IMPORTS[0]).change(
        "setup.py",
        "'DRIVER = PACKAGE.DRIVER:main',",
        "'DRIVER = PACKAGE.DRIVER:main', 'table = PACKAGE.table:main',",
    )
    assert missing(files, tmp_path) == []


@pytest.mark.parametrize(
    ("imports", "name", "text"),
    [
        (
            "from PACKAGE._version import version",
            "pyproject.toml",
            "[tool.setuptools_scm]\nversion_file = 'PACKAGE/_version.py'\n",
        ),
        ("from PACKAGE._fast import limit", "PACKAGE/_fast.cpython-312-x86_64-linux-gnu.so", ""),
    ],
)
def test_one_that_is_made_without_setup_is_there(tmp_path: Path, imports: str, name: str, text: str) -> None:
    files = Files.right(NAME).change("node", "import rclpy\n", f"import rclpy\n{imports}\n").put(name, text)
    assert missing(files, tmp_path) == []


def test_a_package_in_another_folder_is_there(tmp_path: Path) -> None:
    files = Files.right(NAME).change(
        "node", "import rclpy\n", "import rclpy\nfrom PACKAGE.made.table import LIMIT\n"
    )
    files.change(
        "setup.py",
        "packages=find_packages(exclude=['test']),",
        "packages=[package_name, 'PACKAGE.made'],\n    package_dir={'PACKAGE.made': 'generated'},",
    )
    files.put("generated/__init__.py", "").put("generated/table.py", "LIMIT = 1.0\n")
    assert missing(files, tmp_path) == []


@pytest.mark.parametrize(
    "given",
    [
        "package_dir={os.path.basename(os.getcwd()): 'code'}",
        "package_dir={open('name').read(): 'code', 'a.b': 'code'}",
        "package_dir={**dict(), 'a.b': 3}",
        "package_dir=[os.getcwd()]",
        "package_data={os.getcwd(): ['*.yaml'], 'a': os.getcwd()}",
        "entry_points={os.getcwd(): ['a = b:c']}",
        "entry_points={'console_scripts': {os.getcwd(): 'a'}, 'a': os.getcwd()}",
        "data_files=[(os.getcwd(), [os.getcwd()]), os.getcwd()]",
        "packages=[os.getcwd(), 3]",
        "py_modules=[os.getcwd(), 3]",
        "scripts=[os.getcwd()]",
        "name=os.getcwd(), version=os.getcwd(), license=[os.getcwd()]",
        "**{os.getcwd(): os.getcwd()}",
    ],
)
def test_no_rule_fails_on_what_a_setup_py_says(tmp_path: Path, given: str) -> None:
    """Also where a key of a dict is known only to setuptools."""
    script = f"import os\nfrom setuptools import setup\nsetup({given})\n"
    root = Files.right(NAME).put("setup.py", script).write(tmp_path)
    assert not any("rules failed" in one.cause for one in of_workspace(root))
    assert set(own_words(Look(root))) >= set()


@pytest.mark.parametrize(
    ("folders", "module", "inner"),
    [
        ("{'': 'src'}", "my_bot.gone", "src/my_bot"),
        ("{'my_bot': 'code'}", "my_bot.gone", "code"),
        ("{'my_bot': 'code'}", "my_bot.nodes.gone", "code"),
        ("{'': 'python'}", "my_bot.gone", "python/my_bot"),
        ("{}", "my_bot.gone", "my_bot"),
    ],
)
def test_a_file_is_to_be_made_where_setup_py_looks_for_it(
    tmp_path: Path, folders: str, module: str, inner: str
) -> None:
    files, home = Files.right(NAME), "src/my_bot/my_bot/"
    files.texts = {n.replace(home, f"src/my_bot/{inner}/"): text for n, text in files.texts.items()}
    packages = f"packages=[package_name],\n    package_dir={folders},"
    files.change("setup.py", "packages=find_packages(exclude=['test']),", packages)
    files.change(
        "setup.py", "            'MODULE =", f"            'gone = {module}:main',\n            'MODULE ="
    )
    found = [f.fix for f in of_workspace(files.write(tmp_path)) if f.code == "entry-point-module"]
    path = f"src/my_bot/{inner}/{module.partition('.')[2].replace('.', '/')}.py"
    assert found == [f"create {path} with the function main, or remove this entry point"]


@pytest.mark.parametrize(
    ("line", "fix"),
    [
        ("from all_interfaces import Wrist", "write `from all_interfaces.msg import Wrist`"),
        ("from all_interfaces import Turn", "write `from all_interfaces.action import Turn`"),
        ("from all_interfaces import Wrists", ""),
        ("from all_interfaces.msg import Wrist", ""),
        ("from all_interfaces.srv import Spin_Request", ""),
        ("from all_interfaces import srv", ""),
    ],
)
def test_an_interface_is_in_the_module_of_its_kind(tmp_path: Path, line: str, fix: str) -> None:
    files = Files.right(NAME).put(f"{NAME.package}/near.py", "")
    home = "src/all_interfaces"
    files.texts |= {
        f"{home}/CMakeLists.txt": CMAKE.format("all_interfaces"),
        f"{home}/package.xml": MANIFEST.format("all_interfaces"),
        f"{home}/msg/Wrist.msg": "float64 angle\n",
        f"{home}/srv/Spin.srv": "---\n",
        f"{home}/action/Turn.action": "---\n---\n",
        f"{home}/all_interfaces/__init__.py": "",
        f"{home}/all_interfaces/talk.py": f"{line}\n",
    }
    found = [f.fix for f in of_workspace(files.write(tmp_path)) if f.code == "import-wrong"]
    assert [one for one in found if one.startswith("write")] == [fix] * bool(fix)


@pytest.mark.parametrize(
    "imports", [i.replace("table", "tabel") for i in IMPORTS if i.endswith("LIMIT") or "as" in i]
)
@pytest.mark.parametrize("is_built", [False, True])
def test_a_misspelt_one_is_told(tmp_path: Path, imports: str, is_built: bool) -> None:
    files = made(imports)
    files = install(files, "table") if is_built else files
    fix = f"write {NAME.package}.table instead of {NAME.package}.tabel"
    assert missing(files, tmp_path) == [("module-missing", fix)]


@pytest.mark.parametrize("imports", IMPORTS)
def test_one_that_nothing_makes_is_told(tmp_path: Path, imports: str) -> None:
    """A copy that is installed may be of a file that has been renamed."""
    files = Files.right(NAME).change("node", "import rclpy\n", f"import rclpy\n{imports}\n")
    assert len(missing(install(files, "table"), tmp_path)) == 1


CMAKE = "project({0})\nfind_package(rosidl_default_generators REQUIRED)\nrosidl_generate_interfaces(${{PROJECT_NAME}} msg/Wrist.msg)\nament_package()\n"
MANIFEST = "<package format='3'><name>{0}</name><version>0.1.0</version><description>Wrists</description><maintainer email='a@b.de'>A</maintainer><license>MIT</license><export><build_type>ament_cmake</build_type></export></package>"
NEAR = "There is no Python package {}. Did you mean {}?"


@pytest.mark.parametrize(
    ("name", "line", "near"),
    [
        ("all_interfaces", "from all_interfaces.msg import Wrist", ""),
        ("nav_msg", "from nav_msg.msg import Wrist", ""),
        ("std_srv", "import std_srv.msg", ""),
        ("wrist_msgs", "from all_interfaces.msg import Wrist", ""),
        ("wrist_msgs", "from nav_msg.msg import Odometry", "nav_msgs"),
        ("wrist_msgs", "from nav_msg.msg import Odometri", "nav_msgs"),
        ("wrist_msgs", "import std_msg.msg", "std_msgs"),
    ],
)
@pytest.mark.parametrize("file", ["node", "launch/robot.launch.py"])
def test_a_package_of_the_workspace_comes_before_a_similar_one(
    tmp_path: Path, file: str, name: str, line: str, near: str
) -> None:
    """A similar package is only offered if it may have what is imported."""
    first = "import rclpy\n" if file == "node" else "from launch import LaunchDescription\n"
    files = Files.right(NAME).change(file, first, f"{first}{line}\n")
    files.texts |= {
        f"src/{name}/CMakeLists.txt": CMAKE.format(name),
        f"src/{name}/package.xml": MANIFEST.format(name),
        f"src/{name}/msg/Wrist.msg": "float64 angle\n",
    }
    found = [f.cause for f in of_workspace(files.write(tmp_path)) if f.code == "module-missing"]
    assert found == ([NEAR.format(line.split()[1].partition(".")[0], near)] if near else [])


def test_a_cmake_file_that_colcon_does_not_read_makes_no_messages(tmp_path: Path) -> None:
    files = (
        Files.right(NAME).put("CMakeLists.txt", CMAKE.format(NAME.package)).put("msg/Wrist.msg", "int32 x\n")
    )
    files.change("node", "import rclpy\n", "import rclpy\nfrom PACKAGE.msg import Wrist\n")
    ((code, fix),) = missing(files, tmp_path)
    assert code == "module-missing"
    assert fix.startswith("put the .msg files into a separate ament_cmake package")
