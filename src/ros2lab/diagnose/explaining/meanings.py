"""The meanings of error messages: which faults cause them, and what to say if none is found."""

from __future__ import annotations

from ros2lab.diagnose.explaining.meaning import Meaning, meaning
from ros2lab.diagnose.explaining.node_meanings import NODE_MEANINGS
from ros2lab.diagnose.sources.interfaces import nearest_module


def _with_layout(name: str) -> str:
    """Say how to build where the folder install has a layout already."""
    there, other = ("colcon build", "colcon build --merge-install")[:: 1 if name == "isolated" else -1]
    return f"type `{there}`; or `rm -r build install log` and `{other}`, and source install/setup.bash in a new terminal"


# The first match counts, so special meanings come before general ones.
MEANINGS: tuple[Meaning, ...] = (
    # Building
    meaning(
        r"option --(?:editable|uninstall) not recognized",
        "setuptools-too-new",
        "This version of setuptools no longer supports what `colcon build --symlink-install` asks for.",
        "pip install 'setuptools<72'",
    ),
    meaning(
        r"Unknown distribution option: 'tests_require'",
        "setuptools-too-new",
        "This version of setuptools no longer knows tests_require, which colcon uses to choose pytest, so `colcon test` runs none of the package's tests.",
        "write extras_require={{'test': ['pytest']}} instead of tests_require=['pytest'] in setup.py, and build again",
    ),
    meaning(
        r"was created with the layout '(?P<name>\w+)'",
        "link-stale",
        "The folder install has the layout {name}, but this build asks for the other one, and a folder cannot hold both: isolated is without --merge-install, merged with it.",
        _with_layout,
        "install/.colcon_install_layout",
    ),
    meaning(
        r"^Error processing '.+' of '|is an invalid (?:field|constant|message|package) name|find (?:unique )?separator '---'|Number of '---' separators|can not be converted to type '|iterable contains duplicate names|rosidl_adapter\.parser\.",
        "interface-refused",
    ),
    meaning(
        r"Duplicate package names not supported",
        "package-duplicate",
        "Two folders below src contain a package of the same name, so colcon builds nothing.",
        "remove one of them, or put an empty file COLCON_IGNORE into it",
    ),
    meaning(r"Check that the following packages have been built", "not-built"),
    meaning(
        r"share an exact name",
        "name-twice",
        "Two running nodes have the same name, so their parameters and logs get mixed up.",
        "give each its own name in super().__init__('...'), or stop the one that was started twice",
    ),
    meaning(
        r"can't copy '[^']*/build/(?P<name>[^/']+)/",
        "marker-missing data-file-missing link-stale",
        "A link in build/{name}, left over from an earlier build, points to a file that has since been renamed or removed.",
        "rm -r build/{name} install/{name}, then colcon build --packages-select {name}, then source install/setup.bash in a new terminal",
    ),
    meaning(
        r"PackageNotFoundError: (?:No package metadata was found for )?(?P<name>[\w-]+)$",
        "not-sourced",
        "Python does not find the installed {name}: a variable such as PYTHONPATH was overwritten after the workspace was sourced.",
        "source install/setup.bash in this terminal again, and write export PYTHONPATH=...:$PYTHONPATH where the variable is set",
    ),
    meaning(
        r"launch configuration '(?P<name>[^']+)' does not exist",
        "launch-argument",
        "The launch file uses LaunchConfiguration('{name}'), but does not declare an argument {name}.",
        "write DeclareLaunchArgument('{name}', default_value='{default}') as the first entry of LaunchDescription, with the value that you want as its default",
    ),
    meaning(
        r"'tuple' object has no attribute '(?:visit|describe|execute)\w*'",
        "comma-tuple",
        "One of the actions in LaunchDescription is a tuple: there is a comma at the end of the line that makes it.",
        "remove that comma",
    ),
    meaning(
        r"can't copy 'resource/(?P<name>[^']+)'",
        "marker-missing",
        "The file resource/{name}, which ROS uses to find the package, is missing; it is an empty file and easily lost.",
        "touch resource/{name} in the package's folder",
    ),
    meaning(
        r"can't copy '(?P<name>[^']+)'",
        "data-file-missing",
        "setup.py installs {name}, but there is no such file.",
        "create the file, or remove it from data_files",
    ),
    meaning(
        r"package directory '(?P<name>[^']+)' does not exist",
        "package-folder-missing",
        "setup.py installs the Python package {name}, but there is no folder {name} next to setup.py.",
        "create the folder {name} with an empty __init__.py, and put the nodes into it",
    ),
    meaning(
        r"Invalid dash-separated key '(?P<key>[\w-]+)'.*use the underscore name '(?P<name>\w+)'",
        "setup-cfg-dashes",
        "setup.cfg has {key} with a dash, but setuptools calls the option {name}.",
        "write it with an underscore",
    ),
    meaning(
        r"distutils\.core\.setup\(\)' was never called|EntryPoint must be in|Invalid entry.point|does not match any"
        r"|Duplicate element EntryPoint",
        "entry-point-comma entry-point-spec entry-point-twice setup-syntax setup-missing",
        "setup.py cannot be used, usually because of an entry point: a comma is missing between two of them, one does not have the form `name = package.module:function`, or two have the same name.",
        "check entry_points in setup.py",
    ),
    meaning(
        r"doesn't explicitly install a marker in the package index",
        "marker-not-installed",
        "setup.py does not install the marker file that ROS uses to find the package; colcon does it for you.",
        "add ('share/ament_index/resource_index/packages', ['resource/<package>']) to data_files",
    ),
    meaning(
        r"No task extension to '\w+' a 'ros\.(?P<kind>[^']*)' package",
        "build-type-unknown build-type-missing",
        "colcon does not know the build type {kind!r}, so it builds nothing.",
        "write <build_type>ament_python</build_type> between <export> and </export> in package.xml, instead of the build type that is there",
    ),
    meaning(
        r"does not appear to contain CMakeLists\.txt",
        "build-type-cmake build-type-missing",
        "The package's build type requires CMake, but it has no CMakeLists.txt: it is a Python package.",
        "write <build_type>ament_python</build_type> between <export> and </export> in package.xml, instead of the build type that is there",
    ),
    meaning(
        r"rosdep definition for \[(?P<name>[^\]]+)\]",
        "dependency-unknown dependency-not-ros dependency-key",
        "package.xml declares {name}, which rosdep does not know.",
        "write the package's correct name in package.xml (such as std_msgs), or remove the line",
    ),
    meaning(
        r"InvalidPackage|Error\(s\) in package|package\.xml.*(?:not valid|invalid|parse)", "manifest-invalid"
    ),
    # Starting
    meaning(
        r"No executable found",
        "executable-missing entry-points-key entry-points-missing setup-cfg-missing setup-cfg-dashes not-built install-stale",
    ),
    meaning(
        r"executable '(?P<name>[^']+)' not found on the libexec directory",
        "launch-executable setup-cfg-missing entry-points-key entry-points-missing install-stale",
        "The launch file starts {name}, but there is no such executable.",
        "write the executable's name as it is in entry_points in setup.py, or mark the file of that path with `chmod +x`, and build again",
    ),
    meaning(
        r"file '(?P<name>[^']+)' was not found in the share directory of package '(?P<package>[^']+)'",
        "not-in-data-files file-not-found",
        "",
    ),
    meaning(
        r"[Pp]ackage '(?P<name>[^']+)' not found|PackageNotFoundError.*?\"?package '(?P<name2>[^']+)'",
        "package-not-found",
        "",
    ),
    meaning(
        r"Parameter file path is not a file: ?(?P<name>\S*)",
        "parameter-file-missing path-absolute not-in-data-files",
        "The parameter file {name} does not exist, so the nodes keep their defaults.",
        "put it in config, add it to data_files in setup.py, and build again",
    ),
    meaning(
        r"(?:bash: )?(?:line \d+: )?(?P<name>ros2|colcon|rosdep): command not found",
        "command-not-found",
        "This terminal does not know the command {name}: ROS 2 is not sourced in it.",
        "source /opt/ros/jazzy/setup.bash, or activate the course's .venv",
    ),
    meaning(
        r"fixture '(?P<name>\w+)' not found",
        "test-fixture",
        "A test has the argument {name}, but there is no fixture of that name.",
        "write @pytest.fixture above the function {name} that makes it",
    ),
    # Imports
    meaning(
        r"No module named '(?:rospy|roslib|roslaunch)'",
        "ros1-import",
        "rospy belongs to ROS 1; in ROS 2 it is rclpy.",
        "import rclpy, and write the node as a subclass of rclpy.node.Node",
    ),
    meaning(
        r"No module named '?(?P<name>[\w./-]*\w)",
        "entry-point-module init-file-missing package-not-listed import-wrong module-missing install-stale not-built",
        "Python finds no module {name}: the name is misspelled, or the module is not installed, built or sourced.",
        lambda name: (
            f"write {near}"
            if (near := nearest_module(name))
            else f"write {name.removesuffix('.py').replace('/', '.')}, with dots and without .py"
            if "/" in name
            else "compare it with the file's name; then build again and source install/setup.bash"
        ),
    ),
    meaning(
        r"cannot import name '(?P<name>\w+)' from '(?P<module>[\w.]+)'",
        "import-wrong module-missing",
        "There is no {name} in {module}.",
        "remove {name} from the import if nothing uses it; otherwise write the name that {module} has for it",
    ),
    meaning(
        r"module '(?P<module>[\w.]+)' has no attribute 'main'",
        "entry-point-function install-stale",
        "The executable calls main() in {module}, but the module that Python imports has no such function.",
        "define main(args=None) in {module}, save it and build again",
    ),
    meaning(
        r"module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'",
        "entry-point-function import-wrong attribute-missing spin-missing attribute-unknown",
        "",
    ),
    meaning(
        r"'module' object is not callable",
        "entry-point-no-function import-wrong",
        "An entry point in setup.py names a module without a function, or a module is called like a function.",
        "write name = package.module:main in setup.py, and build again",
    ),
    meaning(
        r"name '(?P<name>\w+)' is not defined",
        "setup-import name-undefined-in-setup name-undefined name-missing",
        "",
    ),
    meaning(
        r"command '(?:install|develop)' has no such option|invalid variable '\w*'",
        "setup-cfg-missing setup-value",
        "",
    ),
    meaning(r"(?:Scanner|Parser|Composer|Constructor)Error: ", "parameter-file-syntax launch-syntax", ""),
    meaning(r"(?:SyntaxError|IndentationError|TabError)", "setup-syntax node-syntax launch-syntax", ""),
    *NODE_MEANINGS,
)
