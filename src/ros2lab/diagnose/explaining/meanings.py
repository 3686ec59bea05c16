"""What the words of an error may mean: where to look for its cause, and what to say where none is found."""

from __future__ import annotations

from ros2lab.diagnose.explaining.meaning import Meaning, meaning
from ros2lab.diagnose.explaining.node_meanings import NODE_MEANINGS
from ros2lab.diagnose.sources.interfaces import nearest_module

# The first one that fits counts, so what is special comes before what is general.
MEANINGS: tuple[Meaning, ...] = (
    # Building
    meaning(
        r"option --(?:editable|uninstall) not recognized",
        "setuptools-too-new",
        "This setuptools no longer knows what `colcon build --symlink-install` asks of it.",
        "pip install 'setuptools<72'",
    ),
    meaning(
        r"Unknown distribution option: 'tests_require'",
        "setuptools-too-new",
        "This setuptools no longer knows tests_require, by which colcon chooses pytest: `colcon test` runs none of the package's tests.",
        "write extras_require={{'test': ['pytest']}} instead of tests_require=['pytest'] in setup.py, and build again",
    ),
    meaning(
        r"was created with the layout '(?P<name>\w+)'",
        "link-stale",
        "The folder install was made by a build of another kind ({name}), with or without --merge-install, and cannot hold both.",
        "type the same options as before; or rm -r build install log, and build again with these",
    ),
    meaning(
        r"Duplicate package names not supported",
        "package-duplicate",
        "Two folders below src hold a package of the same name, and colcon builds nothing then.",
        "remove one of them, or put an empty file COLCON_IGNORE into it",
    ),
    meaning(
        r"share an exact name",
        "name-twice",
        "Two nodes that run have the same name, so parameters and logs of the two are mixed up.",
        "give each a name of its own in super().__init__('...'), or stop the one that was started twice",
    ),
    meaning(
        r"can't copy '[^']*/build/(?P<name>[^/']+)/",
        "link-stale",
        "A link in build/{name} leads to a file that was renamed or removed since: it is left from an earlier build.",
        "rm -r build/{name} install/{name}, then colcon build --packages-select {name}",
    ),
    meaning(
        r"ROS_DOMAIN_ID.*(?:not an integral|out of range|invalid|is not)|(?:not an integral|out of range).*ROS_DOMAIN_ID",
        "typed-wrong",
        "The variable ROS_DOMAIN_ID holds something that is no domain: it must be a whole number from 0 to 101.",
        "unset ROS_DOMAIN_ID, or export ROS_DOMAIN_ID=7; look also into ~/.bashrc",
    ),
    meaning(
        r"librmw_(?P<name>\w+?)(?:_cpp)?\.so|RMW_IMPLEMENTATION",
        "typed-wrong",
        "The variable RMW_IMPLEMENTATION names a middleware {name} that is not installed here.",
        "unset RMW_IMPLEMENTATION, in this terminal and in ~/.bashrc",
    ),
    meaning(
        r"PackageNotFoundError: (?:No package metadata was found for )?(?P<name>[\w-]+)$",
        "not-sourced",
        "Python does not find the installed {name}: a variable such as PYTHONPATH was set anew after the workspace was sourced.",
        "source install/setup.bash in this terminal once more, and write export PYTHONPATH=...:$PYTHONPATH where the variable is set",
    ),
    meaning(
        r"launch configuration '(?P<name>[^']+)' does not exist",
        "launch-argument",
        "The launch file uses LaunchConfiguration('{name}'), and no argument {name} is declared in it.",
        "write DeclareLaunchArgument('{name}', default_value='...') into LaunchDescription, before it is used, or the declared name here",
    ),
    meaning(
        r"'tuple' object has no attribute '(?:visit|describe|execute)\w*'",
        "comma-tuple",
        "One of the actions in LaunchDescription is a tuple: a comma stands at the end of the line that makes it.",
        "take that comma away",
    ),
    meaning(
        r"can't copy 'resource/(?P<name>[^']+)'",
        "marker-missing",
        "The file resource/{name}, by which ROS knows the package, is missing; it is empty and easily lost.",
        "touch resource/{name} in the package's folder",
    ),
    meaning(
        r"can't copy '(?P<name>[^']+)'",
        "data-file-missing",
        "setup.py installs {name}, and there is no such file.",
        "make the file, or take it out of data_files",
    ),
    meaning(
        r"package directory '(?P<name>[^']+)' does not exist",
        "package-folder-missing",
        "setup.py installs the Python package {name}, and there is no folder {name} beside setup.py.",
        "make the folder {name} with an empty __init__.py, and put the nodes into it",
    ),
    meaning(
        r"Invalid dash-separated key '(?P<key>[\w-]+)'.*use the underscore name '(?P<name>\w+)'",
        "setup-cfg-dashes",
        "setup.cfg writes {key} with a dash, and setuptools wants an underscore.",
        "write it with an underscore",
    ),
    meaning(
        r"distutils\.core\.setup\(\)' was never called|EntryPoint must be in|Invalid entry.point|does not match any"
        r"|Duplicate element EntryPoint",
        "entry-point-comma entry-point-spec entry-point-twice setup-syntax setup-missing",
        "setup.py cannot be used, most often because of an entry point: a comma between two of them is missing, one "
        "is not of the form `name = package.module:function`, or two have the same name.",
        "look at entry_points in setup.py",
    ),
    meaning(
        r"doesn't explicitly install a marker in the package index",
        "marker-not-installed",
        "setup.py does not install the marker by which ROS finds the package; colcon does it for you.",
        "add ('share/ament_index/resource_index/packages', ['resource/<package>']) to data_files",
    ),
    meaning(
        r"No task extension to '\w+' a 'ros\.(?P<kind>[^']*)' package",
        "build-type-unknown build-type-missing",
        "colcon does not know the build type {kind!r}, so it builds nothing.",
        "write <build_type>ament_python</build_type> in package.xml",
    ),
    meaning(
        r"does not appear to contain CMakeLists\.txt",
        "build-type-cmake build-type-missing",
        "The package's build type asks for CMake, and it has no CMakeLists.txt: it is a Python package.",
        "write <export><build_type>ament_python</build_type></export> in package.xml",
    ),
    meaning(
        r"rosdep definition for \[(?P<name>[^\]]+)\]",
        "dependency-unknown dependency-not-ros",
        "package.xml declares {name}, which rosdep does not know.",
        "write the package's right name in package.xml (std_msgs, geometry_msgs), or remove the line",
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
        "The launch file starts {name}, and the package has no such executable.",
        "write the executable's name as it stands in the entry points of setup.py, and build again",
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
        "The parameter file {name} is not there, so the nodes keep their defaults.",
        "put it under config, add it to data_files in setup.py, and build again",
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
        "A test asks for {name} in its parentheses, and there is no fixture of that name.",
        "write @pytest.fixture above the function {name} that makes it",
    ),
    # Imports
    meaning(
        r"No module named '(?:rospy|roslib|roslaunch)'",
        "ros1-import",
        "rospy belongs to ROS 1; in ROS 2 it is rclpy.",
        "import rclpy, and write the node as a class derived from rclpy.node.Node",
    ),
    meaning(
        r"No module named '?(?P<name>[\w./-]*\w)",
        "entry-point-module init-file-missing package-not-listed import-wrong module-missing install-stale not-built",
        "Python finds no module {name}: its name is misspelt, or it is not installed, built or sourced.",
        lambda name: (
            f"write {near}"
            if (near := nearest_module(name))
            else f"write {name.removesuffix('.py').replace('/', '.')}, with dots, and without .py"
            if "/" in name
            else "compare the name with the file's; then build again and source install/setup.bash"
        ),
    ),
    meaning(
        r"cannot import name '(?P<name>\w+)' from '(?P<module>[\w.]+)'",
        "import-wrong module-missing",
        "There is no {name} in {module}.",
        "nodes come from rclpy.node, messages from <package>.msg",
    ),
    meaning(
        r"module '(?P<module>[\w.]+)' has no attribute 'main'",
        "entry-point-function install-stale",
        "The executable calls main() in {module}, and there is no such function.",
        "define main(args=None) in that file, save it and build again",
    ),
    meaning(
        r"module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'",
        "entry-point-function import-wrong attribute-missing spin-missing attribute-unknown",
        "",
    ),
    meaning(
        r"'module' object is not callable",
        "entry-point-no-function",
        "An entry point of setup.py names a module and no function in it, or a module is called as if it were a function.",
        "write name = package.module:main in setup.py, and build again",
    ),
    meaning(
        r"name '(?P<name>\w+)' is not defined",
        "setup-import name-undefined-in-setup name-undefined name-missing",
        "",
    ),
    meaning(r"(?:SyntaxError|IndentationError|TabError)", "setup-syntax node-syntax launch-syntax", ""),
    *NODE_MEANINGS,
)
