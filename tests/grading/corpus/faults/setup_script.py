"""Faults of setup.py, setup.cfg, the marker and the folders that they name. The nodes run all the same."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import both, fault
from corpus.package import CFG, MARKER, SETUP, STATUS, VELOCITY, M, P
from corpus.tree import Change, drop, edit, move, put

_STATUS_POINT = "'status_publisher = robot_controller.status_publisher:main'"
_POINTS = """\
    entry_points={
        'console_scripts': [
            'status_publisher = robot_controller.status_publisher:main',
            'command_subscriber = robot_controller.command_subscriber:main',
            'velocity_publisher = robot_controller.velocity_publisher:main',
        ],
    },
"""


def _setup(
    name: str,
    old: str,
    new: str,
    cause: str,
    about: str,
    *,
    most: float = 15,
    least: float = 1,
    builds: bool = True,
) -> Case:
    change = edit(SETUP, old, new)
    return fault("package", f"setup_{name}", change, cause, about, least=least, most=most, builds=builds)


def _unreadable(name: str, change: Change, about: str) -> Case:
    return fault(
        "package",
        f"setup_{name}",
        change,
        r"setup-syntax|setup\.py",
        about,
        least=2,
        unreadable=("setup.py",),
        builds=False,
    )


def _point(name: str, new: str, cause: str, about: str, *, builds: bool = True) -> Case:
    """A wrong entry point; the other two are right."""
    return _setup(f"point_{name}", _STATUS_POINT, new, f"entry-point|{cause}", about, builds=builds)


ENTRY_POINTS: tuple[Case, ...] = (
    _point(
        "slash",
        "'status_publisher = robot_controller/status_publisher:main'",
        r"/",
        "a module has dots; setup() refuses all of it",
        builds=False,
    ),
    _point(
        "colon_for_equals",
        "'status_publisher : robot_controller.status_publisher:main'",
        r"=",
        "= stands between name and module",
        builds=False,
    ),
    _point(
        "without_function",
        "'status_publisher = robot_controller.status_publisher'",
        r":main",
        "the module is called in place of its main",
    ),
    _point(
        "parentheses",
        "'status_publisher = robot_controller.status_publisher:main()'",
        r"main",
        "the function is named, not called",
        builds=False,
    ),
    _point(
        "module_misspelt",
        "'status_publisher = robot_controller.status_publsher:main'",
        r"status_publsher",
        "there is no such module",
    ),
    _point(
        "function_misspelt",
        "'status_publisher = robot_controller.status_publisher:mian'",
        r"mian",
        "there is no such function",
    ),
    _point(
        "package_misspelt",
        "'status_publisher = robot_controler.status_publisher:main'",
        r"robot_controler\b",
        "there is no such package",
    ),
    _point(
        "no_package",
        "'status_publisher = status_publisher:main'",
        r"status_publisher",
        "the module lies in the package robot_controller",
    ),
    _point(
        "file_name",
        "'status_publisher = robot_controller.status_publisher.py:main'",
        r"\.py",
        "a module has no .py",
    ),
    _point(
        "other_node",
        "'status_publisher = robot_controller.velocity_publisher:main'",
        r"status_publisher",
        "copied and not changed: nothing starts the status publisher",
    ),
    fault(
        "package",
        "point_without_main",
        edit(STATUS, "def main(args=None):", "def run(args=None):"),
        r"entry-point|main",
        "the entry point names main, and the module calls it run",
        least=1,
    ),
    fault(
        "package",
        "point_without_node",
        both(
            edit(
                STATUS,
                "    rclpy.init(args=args)\n    node = StatusPublisher()\n    try:\n        rclpy.spin(node)\n",
                "    node = None\n    try:\n        threading.Event().wait()\n",
            ),
            edit(STATUS, "        node.destroy_node()\n        rclpy.try_shutdown()\n", "        del node\n"),
            edit(STATUS, "import rclpy\n", "import threading\n\nimport rclpy\n"),
            edit(
                VELOCITY,
                "        rclpy.spin(node)\n",
                "        executor = SingleThreadedExecutor()\n        executor.add_node(node)\n"
                "        executor.add_node(StatusPublisher())\n        executor.spin()\n",
            ),
            edit(
                VELOCITY,
                "import ExternalShutdownException\n",
                "import ExternalShutdownException, SingleThreadedExecutor\n",
            ),
            edit(
                VELOCITY,
                "from std_msgs.msg import String\n",
                "from std_msgs.msg import String\n\nfrom robot_controller.status_publisher import StatusPublisher\n",
            ),
        ),
        r"No node comes up in status_publisher",
        "one program waits, and another one has its node",
        least=2,
        most=2,
    ),
    _setup(
        "point_missing",
        f"            {_STATUS_POINT},\n",
        "",
        r"status_publisher|entry.point",
        "one of the three has no executable",
    ),
    _setup(
        "point_names_equal",
        "'velocity_publisher = robot",
        "'status_publisher = robot",
        r"velocity_publisher|twice|same|entry.point",
        "two executables have one name, and the last one wins",
        builds=False,
    ),
    _setup(
        "no_comma_between_points",
        _STATUS_POINT + ",",
        _STATUS_POINT,
        r"entry-point-comma|comma",
        "Python joins the two texts, and setup() refuses all of it",
        builds=False,
    ),
    _setup("no_points", _POINTS, "", r"entry-points?|executable", "nothing is installed that can be run"),
    _setup(
        "points_empty",
        _POINTS,
        "    entry_points={'console_scripts': []},\n",
        r"entry-points?|executable",
        "nothing is installed that can be run",
    ),
    _setup(
        "points_key",
        "'console_scripts'",
        "'console_script'",
        r"entry-points-key|console_scripts",
        "setuptools knows no such group",
    ),
    _setup(
        "points_argument",
        "entry_points={",
        "entrypoints={",
        r"entry.?points?|executable",
        "setup() has no such argument",
    ),
)

SETUP_SCRIPT: tuple[Case, ...] = (
    fault(
        "package",
        "setup_missing",
        drop(SETUP),
        r"setup-missing|setup\.py",
        "ament_python needs setup.py",
        least=2,
        builds=False,
    ),
    fault(
        "package", "setup_empty", put(SETUP, ""), r"setup", "setup() is never called", least=2, builds=False
    ),
    fault(
        "package",
        "setup_not_called",
        edit(SETUP, "\nsetup(\n", "\ndict(\n"),
        r"setup",
        "setup() is never called",
        least=2,
        builds=False,
    ),
    _unreadable("no_comma", edit(SETUP, "version='0.1.0',", "version='0.1.0'"), "a comma is missing"),
    _unreadable("not_closed", edit(SETUP, "    },\n)\n", "    },\n"), "a bracket is never closed"),
    _unreadable("indentation", edit(SETUP, "\nsetup(", "\n  setup("), "it is indented for no reason"),
    _unreadable("quote", edit(SETUP, "license='MIT'", "license='MIT"), "a text is never closed"),
    _unreadable(
        "conflict",
        edit(
            SETUP,
            "    license='MIT',\n",
            "<<<<<<< HEAD\n    license='MIT',\n=======\n    license='BSD',\n>>>>>>> other\n",
        ),
        "git's marks of a conflict were left in it",
    ),
    _setup(
        "glob_not_imported", "from glob import glob\n", "", r"glob", "NameError when it is run", builds=False
    ),
    _setup(
        "setup_not_imported",
        "from setuptools import setup\n",
        "",
        r"setup",
        "NameError when it is run",
        builds=False,
    ),
    _setup(
        "import_misspelt",
        "from setuptools import",
        "from setuptool import",
        r"setup-import|setuptools?\b",
        "there is no such module",
        builds=False,
    ),
    _setup(
        "name_undefined",
        "packages=[package_name]",
        "packages=[packge_name]",
        r"packge_name",
        "NameError",
        builds=False,
    ),
    _setup(
        "reads_missing_file",
        "    zip_safe=True,\n",
        "    long_description=open('DESCRIPTION.rst').read(),\n",
        r"DESCRIPTION\.rst|setup",
        "it opens a file that is not there",
        builds=False,
    ),
    _setup(
        "other_name",
        "package_name = 'robot_controller'\n",
        "package_name = 'robot_control'\n",
        r"robot_control\b|name",
        "the package's name is another one",
        builds=False,
    ),
    _setup(
        "only_name_differs",
        "    name=package_name,",
        "    name='robot-control-homework',",
        r"robot-control-homework|name",
        "package.xml gives another name",
    ),
    _setup(
        "todo_license",
        "license='MIT'",
        "license='TODO: License declaration'",
        r"TODO",
        "it was never written",
        most=4,
        least=0.5,
    ),
    _setup(
        "no_packages",
        "packages=[package_name]",
        "packages=[]",
        r"package-not-listed|packages",
        "no module is installed",
    ),
    _setup(
        "packages_misspelt",
        "packages=[package_name]",
        "packages=['robot_controler']",
        r"robot_controler\b|package-folder",
        "there is no such folder",
        builds=False,
    ),
    fault(
        "package",
        "no_init",
        both(
            drop(f"{M}__init__.py"),
            edit(SETUP, "from setuptools import setup", "from setuptools import find_packages, setup"),
            edit(SETUP, "[package_name],", "find_packages(),"),
        ),
        r"__init__\.py|init-file",
        "find_packages() passes over a folder without __init__.py",
        least=1,
    ),
    fault(
        "package",
        "modules_beside_setup",
        move(M, P),
        r"package-folder|__init__|robot_controller",
        "the inner folder is missing",
        least=1,
        builds=False,
    ),
    fault(
        "package",
        "inner_folder_renamed",
        move(M, f"{P}scripts/"),
        r"package-folder|scripts|robot_controller",
        "the modules lie in another folder than setup.py and the imports say",
        least=1,
        builds=False,
    ),
    _setup(
        "no_marker_line",
        "        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n",
        "",
        r"marker|resource",
        "ROS does not find the package's marker",
        most=5,
    ),
    _setup(
        "marker_to_other_place",
        "'share/ament_index/resource_index/packages'",
        "'share/ament_index/resource_index/package'",
        r"marker|resource_index",
        "ROS looks in packages",
        most=5,
    ),
    _setup(
        "manifest_not_installed",
        "        ('share/' + package_name, ['package.xml']),\n",
        "",
        r"package\.xml",
        "tools look for package.xml in share",
        most=5,
        least=0.5,
    ),
    _setup(
        "data_file_missing",
        "['package.xml']",
        "['package.xml', 'CHANGES.txt']",
        r"CHANGES\.txt|data-file",
        "setup() stops at a file that is not there",
        builds=False,
    ),
    _setup(
        "no_data_files",
        """\
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),
        ('share/' + package_name + '/config', glob('config/*.yaml')),
    ],
""",
        "",
        r"marker|data_files|package\.xml",
        "neither marker nor package.xml are installed",
    ),
    fault(
        "package",
        "marker_missing",
        drop(MARKER),
        r"marker|resource",
        "setup() stops at the missing marker",
        least=1,
        builds=False,
    ),
    fault(
        "package",
        "marker_misnamed",
        move(MARKER, f"{P}resource/robot_control"),
        r"marker|resource",
        "setup() stops at the missing marker",
        least=1,
        builds=False,
    ),
    fault(
        "package",
        "cfg_missing",
        drop(CFG),
        r"setup-cfg|setup\.cfg",
        "executables go where ros2 run does not look",
        least=1,
    ),
    fault(
        "package",
        "cfg_empty",
        put(CFG, ""),
        r"setup-cfg|setup\.cfg",
        "executables go where ros2 run does not look",
        least=1,
    ),
    fault(
        "package",
        "cfg_dashes",
        both(edit(CFG, "script_dir", "script-dir"), edit(CFG, "install_scripts", "install-scripts")),
        r"setup-cfg|script.dir|dash",
        "setuptools warns of dashes, and refuses them from 80 on",
        most=5,
    ),
    fault(
        "package",
        "cfg_of_another_package",
        put(
            CFG,
            "[develop]\nscript_dir=$base/lib/my_package\n[install]\ninstall_scripts=$base/lib/my_package\n",
        ),
        r"my_package|setup\.cfg",
        "executables go to another package's folder",
        least=1,
    ),
    fault(
        "package",
        "cfg_only_develop",
        put(CFG, "[develop]\nscript_dir=$base/lib/robot_controller\n"),
        r"install|setup\.cfg",
        "what is not a symlink install goes to bin",
        least=1,
    ),
    fault(
        "package",
        "cfg_malformed",
        put(CFG, "develop\nscript_dir=$base/lib/robot_controller\n"),
        r"setup\.cfg|setup-cfg|section",
        "the sections have no brackets",
        least=1,
        builds=False,
    ),
)
