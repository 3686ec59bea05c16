"""What the words of an error may mean: where to look for its cause, and what to say where none is found."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from ros2lab.diagnose.interfaces import nearest_module
from ros2lab.diagnose.message_faults import filling
from ros2lab.diagnose.parameter_faults import value_fix


@dataclass(frozen=True)
class Meaning:
    """What an error may mean.

    Attributes:
        pattern: the words; its groups fill in `cause` and `fix`.
        codes: what may have caused it; a finding of one of them in the sources explains it best.
        cause: what is said where there is none; the code is then the first one. Empty: nothing is said.
        fix: what to do then; or a function that says it, given the groups by their names.
    """

    pattern: re.Pattern[str]
    codes: tuple[str, ...]
    cause: str = ""
    fix: str | Callable[..., str] = ""


def _meaning(pattern: str, codes: str, cause: str = "", fix: str | Callable[..., str] = "") -> Meaning:
    return Meaning(re.compile(pattern), tuple(codes.split()), cause, fix)


# The first one that fits counts, so what is special comes before what is general.
MEANINGS: tuple[Meaning, ...] = (
    # Building
    _meaning(
        r"option --(?:editable|uninstall) not recognized",
        "setuptools-too-new",
        "This setuptools no longer knows what `colcon build --symlink-install` asks of it.",
        "pip install 'setuptools<80'",
    ),
    _meaning(
        r"Duplicate package names not supported",
        "package-duplicate",
        "Two folders below src hold a package of the same name, and colcon builds nothing then.",
        "remove one of them, or put an empty file COLCON_IGNORE into it",
    ),
    _meaning(
        r"^\[\d+\]\S* +Stopped\b",
        "not-spinning",
        "Ctrl-Z does not end a program: it stands still, and its node is there and does nothing.",
        "type fg to let it go on, and then Ctrl-C to end it",
    ),
    _meaning(
        r"share an exact name",
        "name-twice",
        "Two nodes that run have the same name, so parameters and logs of the two are mixed up.",
        "give each a name of its own in super().__init__('...'), or stop the one that was started twice",
    ),
    _meaning(
        r"can't copy '[^']*/build/(?P<name>[^/']+)/",
        "link-stale",
        "A link in build/{name} leads to a file that was renamed or removed since: it is left from an earlier build.",
        "rm -r build/{name} install/{name}, then colcon build --packages-select {name}",
    ),
    _meaning(
        r"ROS_DOMAIN_ID.*(?:not an integral|out of range|invalid|is not)|(?:not an integral|out of range).*ROS_DOMAIN_ID",
        "typed-wrong",
        "The variable ROS_DOMAIN_ID holds something that is no domain: it must be a whole number from 0 to 101.",
        "unset ROS_DOMAIN_ID, or export ROS_DOMAIN_ID=7; look also into ~/.bashrc",
    ),
    _meaning(
        r"librmw_(?P<name>\w+?)(?:_cpp)?\.so|RMW_IMPLEMENTATION",
        "typed-wrong",
        "The variable RMW_IMPLEMENTATION names a middleware {name} that is not installed here.",
        "unset RMW_IMPLEMENTATION, in this terminal and in ~/.bashrc",
    ),
    _meaning(
        r"PackageNotFoundError: (?:No package metadata was found for )?(?P<name>[\w-]+)$",
        "not-sourced",
        "Python does not find the installed {name}: a variable such as PYTHONPATH was set anew after the workspace was sourced.",
        "source install/setup.bash in this terminal once more, and write export PYTHONPATH=...:$PYTHONPATH where the variable is set",
    ),
    _meaning(
        r"launch configuration '(?P<name>[^']+)' does not exist",
        "launch-argument",
        "The launch file uses LaunchConfiguration('{name}'), and no argument {name} is declared in it.",
        "write DeclareLaunchArgument('{name}', default_value='...') into LaunchDescription, before it is used, or the declared name here",
    ),
    _meaning(
        r"'tuple' object has no attribute '(?:visit|describe|execute)\w*'",
        "comma-tuple",
        "One of the actions in LaunchDescription is a tuple: a comma stands at the end of the line that makes it.",
        "take that comma away",
    ),
    _meaning(
        r"can't copy 'resource/(?P<name>[^']+)'",
        "marker-missing",
        "The file resource/{name}, by which ROS knows the package, is missing; it is empty and easily lost.",
        "touch resource/{name} in the package's folder",
    ),
    _meaning(
        r"can't copy '(?P<name>[^']+)'",
        "data-file-missing",
        "setup.py installs {name}, and there is no such file.",
        "make the file, or take it out of data_files",
    ),
    _meaning(
        r"package directory '(?P<name>[^']+)' does not exist",
        "package-folder-missing",
        "setup.py installs the Python package {name}, and there is no folder {name} beside setup.py.",
        "make the folder {name} with an empty __init__.py, and put the nodes into it",
    ),
    _meaning(
        r"Invalid dash-separated key '(?P<key>[\w-]+)'.*use the underscore name '(?P<name>\w+)'"
        r"|Usage of dash-separated '(?P<key2>[\w-]+)'",
        "setup-cfg-dashes",
        "setup.cfg writes {key}{key2} with a dash, and setuptools wants an underscore.",
        "write it with an underscore",
    ),
    _meaning(
        r"distutils\.core\.setup\(\)' was never called|EntryPoint must be in|Invalid entry.point|does not match any"
        r"|Duplicate element EntryPoint",
        "entry-point-comma entry-point-spec entry-point-twice setup-syntax setup-missing",
        "setup.py cannot be used, most often because of an entry point: a comma between two of them is missing, one "
        "is not of the form `name = package.module:function`, or two have the same name.",
        "look at entry_points in setup.py",
    ),
    _meaning(
        r"doesn't explicitly install a marker in the package index",
        "marker-not-installed",
        "setup.py does not install the marker by which ROS finds the package; colcon does it for you.",
        "add ('share/ament_index/resource_index/packages', ['resource/<package>']) to data_files",
    ),
    _meaning(
        r"No task extension to '\w+' a 'ros\.(?P<kind>[^']*)' package",
        "build-type-unknown build-type-missing",
        "colcon does not know the build type {kind!r}, so it builds nothing.",
        "write <build_type>ament_python</build_type> in package.xml",
    ),
    _meaning(
        r"does not appear to contain CMakeLists\.txt",
        "build-type-cmake build-type-missing",
        "The package's build type asks for CMake, and it has no CMakeLists.txt: it is a Python package.",
        "write <export><build_type>ament_python</build_type></export> in package.xml",
    ),
    _meaning(
        r"rosdep definition for \[(?P<name>[^\]]+)\]",
        "dependency-unknown dependency-not-ros",
        "package.xml declares {name}, which rosdep does not know.",
        "write the package's right name in package.xml (std_msgs, geometry_msgs), or remove the line",
    ),
    _meaning(
        r"InvalidPackage|Error\(s\) in package|package\.xml.*(?:not valid|invalid|parse)", "manifest-invalid"
    ),
    # Starting
    _meaning(
        r"No executable found",
        "executable-missing entry-points-key entry-points-missing setup-cfg-missing setup-cfg-dashes not-built install-stale",
    ),
    _meaning(
        r"executable '(?P<name>[^']+)' not found on the libexec directory",
        "launch-executable setup-cfg-missing entry-points-key entry-points-missing install-stale",
        "The launch file starts {name}, and the package has no such executable.",
        "write the executable's name as it stands in the entry points of setup.py, and build again",
    ),
    _meaning(
        r"file '(?P<name>[^']+)' was not found in the share directory of package '(?P<package>[^']+)'",
        "not-in-data-files file-not-found",
        "",
    ),
    _meaning(
        r"[Pp]ackage '(?P<name>[^']+)' not found|PackageNotFoundError.*?\"?package '(?P<name2>[^']+)'",
        "package-not-found",
        "",
    ),
    _meaning(
        r"Parameter file path is not a file: ?(?P<name>\S*)",
        "parameter-file-missing path-absolute not-in-data-files",
        "The parameter file {name} is not there, so the nodes keep their defaults.",
        "put it under config, add it to data_files in setup.py, and build again",
    ),
    _meaning(
        r"(?:bash: )?(?:line \d+: )?(?P<name>ros2|colcon|rosdep): command not found",
        "command-not-found",
        "This terminal does not know the command {name}: ROS 2 is not sourced in it.",
        "source /opt/ros/jazzy/setup.bash, or activate the course's .venv",
    ),
    # Imports
    _meaning(
        r"No module named '(?:rospy|roslib|roslaunch)'",
        "ros1-import",
        "rospy belongs to ROS 1; in ROS 2 it is rclpy.",
        "import rclpy, and write the node as a class derived from rclpy.node.Node",
    ),
    _meaning(
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
    _meaning(
        r"cannot import name '(?P<name>\w+)' from '(?P<module>[\w.]+)'",
        "import-wrong module-missing",
        "There is no {name} in {module}.",
        "nodes come from rclpy.node, messages from <package>.msg",
    ),
    _meaning(
        r"module '(?P<module>[\w.]+)' has no attribute 'main'",
        "entry-point-function install-stale",
        "The executable calls main() in {module}, and there is no such function.",
        "define main(args=None) in that file, save it and build again",
    ),
    _meaning(
        r"module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'",
        "entry-point-function import-wrong attribute-missing spin-missing attribute-unknown",
        "",
    ),
    _meaning(
        r"'module' object is not callable",
        "entry-point-no-function",
        "An entry point of setup.py names a module and no function in it, or a module is called as if it were a function.",
        "write name = package.module:main in setup.py, and build again",
    ),
    _meaning(
        r"name '(?P<name>\w+)' is not defined",
        "setup-import name-undefined-in-setup name-undefined name-missing",
        "",
    ),
    _meaning(r"(?:SyntaxError|IndentationError|TabError)", "setup-syntax node-syntax launch-syntax", ""),
    # Nodes
    _meaning(
        r"_TYPE_SUPPORT|might be a ROS 1 message type",
        "type-not-a-message",
        "A publisher or a subscription was given something that is no message type.",
        "give a type such as String, from std_msgs.msg import String",
    ),
    _meaning(
        r"'Publisher' object has no attribute '(?P<name>\w+)'",
        "publisher-method",
        "A publisher has no method {name}; it is publish.",
        "write publish(msg)",
    ),
    _meaning(
        r"'NoneType' object is not callable",
        "callback-called",
        "Something that is None was called: most often a callback was called where it should be given.",
        "write self.callback without parentheses",
    ),
    _meaning(
        r"callback should be either be callable with one argument",
        "callback-arguments callback-missing argument-order",
        "The callback of a subscription is called with the message, and it does not take one.",
        "write def callback(self, msg):",
    ),
    _meaning(
        r"create_(?:subscription|publisher)\(\) missing 1 required positional argument: 'qos_profile'",
        "qos-missing argument-order",
        "The length of the queue is missing.",
        "add 10 as the last argument",
    ),
    _meaning(
        r"\.(?P<name>create_\w+)\(\) missing \d+ required positional arguments?: (?P<what>.*)",
        "argument-missing argument-order dot-for-comma",
        "{name} lacks {what}.",
        "give it what it lacks",
    ),
    _meaning(
        r"Expected QoSProfile or int, but received",
        "argument-order",
        "The arguments stand in the wrong order: the length of the queue is the last one.",
        "write create_subscription(String, 'topic', self.callback, 10)",
    ),
    _meaning(
        r"unexpected keyword argument 'queue_size'",
        "queue-size",
        "queue_size belongs to ROS 1; in ROS 2 the queue's length is the last argument.",
        "write create_publisher(String, 'topic', 10)",
    ),
    _meaning(
        r"'(?:float|int)' object has no attribute 'self'",
        "dot-for-comma",
        "Behind a number a dot stands where a comma belongs, as in create_timer(2.0.self.callback).",
        "write a comma and a blank in place of the dot",
    ),
    _meaning(
        r"'(?:float|int)' object has no attribute '(?P<name>\w+)'",
        "dot-for-comma attribute-missing message-field attribute-unknown",
        "",
    ),
    _meaning(
        r"'super' object has no attribute '(?P<name>\w*init\w*)'|descriptor '__init__' .*'super' object|type super.*__init__",
        "super-misspelt",
        "The constructor of Node is called super().__init__, with two underscores on each side.",
        "write super().__init__('node_name')",
    ),
    _meaning(
        r"has no attribute '_(?:default_callback_group|Node__\w+|logger|parameters|handle|context|clock|callback_groups)'"
        r"|__init__ \w*(?:not|never) called",
        "super-missing super-late super-misspelt",
        "The node is used before super().__init__() was called, or it never is.",
        "write super().__init__('node_name') as the first line of __init__",
    ),
    _meaning(
        r"property '(?P<name>\w+)' of '(?P<owner>\w+)' object has no setter|can't set attribute '?(?P<name2>\w*)",
        "node-property",
        "Every node already has `{name}{name2}`, which cannot be set.",
        "give your own another name, such as self.{name}{name2}_",
    ),
    _meaning(
        r"InvalidNodeNameException|[Ii]nvalid node name",
        "node-name-invalid",
        "A node's name may hold letters, digits and _ only.",
        "write _ in place of other characters",
    ),
    _meaning(
        r"validating node name or namespace for .*namespace=(?P<name>[^']*)'",
        "node-name-invalid",
        "The namespace {name!r} is not valid: between its slashes, letters, digits and _ may stand, and no digit first.",
        "write _ in place of other characters",
    ),
    _meaning(
        r"UnknownROSArgsError: (?P<name>\[.*\])",
        "typed-wrong",
        "Behind --ros-args stands {name}, which ROS does not know.",
        "put a value that holds a blank in quotes, or write _ for the blank, and what the node itself is to read before --ros-args",
    ),
    _meaning(
        r"InvalidTopicNameException|InvalidServiceNameException|[Ii]nvalid topic name",
        "topic-name-invalid",
        "Between its slashes, a topic's name may hold letters, digits and _ only, and no digit first.",
        "write _ in place of other characters",
    ),
    _meaning(
        r"NotInitializedException|rclpy\.init\(\) has not been called",
        "rclpy-init-missing",
        "A node is made before rclpy.init() was called.",
        "write rclpy.init(args=args) as the first line of main",
    ),
    _meaning(
        r"Context\.init\(\) must only be called once",
        "rclpy-init-twice",
        "rclpy.init() is called twice in one program.",
        "remove one of the two; it belongs into main",
    ),
    _meaning(
        r"'method' object does not support the context manager protocol",
        "node-property",
        "Every node already has `handle`, which a method of this name hides.",
        "call the method handle_ or another name, also where it is used",
    ),
    _meaning(
        r"object does not support the context manager protocol|AttributeError: __enter__",
        "context-manager",
        "What stands behind `with` is not made for it; in ROS 2 Jazzy neither rclpy.init() nor a node is.",
        "write rclpy.init(args=args) as the first line of main, and rclpy.try_shutdown() as its last",
    ),
    _meaning(
        r"rcl_shutdown already called",
        "shutdown-twice",
        "Ctrl-C had already shut rclpy down, and the program does it once more: it is harmless.",
        "write rclpy.try_shutdown() in place of rclpy.shutdown()",
    ),
    _meaning(
        r"ParameterNotDeclaredException|undeclared parameter\(s\): (?P<name>\w*)",
        "parameter-undeclared",
        "A parameter is read that the node has never declared.",
        "write self.declare_parameter('name', 1.0) before it is read",
    ),
    _meaning(
        r"Trying to set parameter '(?P<name>[\w.]+)' to '(?P<value>[^']*)' of type '(?P<kind>\w+)', expecting type '(?P<wanted>\w+)'",
        "parameter-type",
        "The parameter {name} is of type {wanted}, and it is given {value}, of type {kind}.",
        value_fix,
    ),
    _meaning(
        r"InvalidParameterTypeException",
        "parameter-type",
        "A parameter is given a value of another type.",
        "write 2.0 and not 2 for a double",
    ),
    _meaning(
        r"yaml\.\w+Error|parse[rd]? .*ya?ml|Couldn't parse params file",
        "parameter-file-syntax parameter-file-node",
        "The parameter file cannot be read.",
        "indent with blanks, and write the node's name, then ros__parameters:, then the parameters",
    ),
    # Messages
    _meaning(
        # Numbers so near 0 that they are hardly ever meant: they are bytes of an int, read as a float.
        r"\b(?P<value>\d(?:\.\d+)?e-3(?:0[89]|1\d|2[0-4]))\b",
        "int-in-float",
        "{value} is as good as 0, and nobody has written it: an int was put into a field that holds a float, and ROS has "
        "read the wrong bytes.",
        "write 1.0 and not 1 where that field is filled",
    ),
    _meaning(
        r"PyFloat_Check|must be of type 'float'",
        "int-in-float field-type",
        "This field holds a float, and was given something else: an int, a text, or the None of a parameter without a default.",
        "write 1.0 and not 1, or float(...) around the value; and give a parameter a default, as in declare_parameter('speed', 0.5)",
    ),
    _meaning(
        r"has no (?:field|attribute) '(?P<name>\w+):(?P<value>[^' ]+)'",
        "message-field",
        "YAML wants a blank after a colon; without one {name}:{value} is a name.",
        "write {name}: {value}",
    ),
    _meaning(
        r"PyUnicode_Check|bad argument type for built-in operation|The 'data' field must be of type 'str'",
        "string-data-type field-type",
        "The text of a String was given something that is no text.",
        "write str(...) around it",
    ),
    _meaning(
        r"The '(?P<name>\w+)' field must be (?P<what>.*)",
        "field-type int-in-float string-data-type",
        "The field {name} must be {what}.",
        "give it a value of that type",
    ),
    _meaning(
        r"Expected <class '(?P<package>\w+)\.msg\.\w+\.(?P<wanted>\w+)'>, got <class '(?:[\w.]+\.)?(?P<given>\w+)'>",
        "publish-text publish-type",
        "publish() wants a {wanted}, and was given a value of type {given}.",
        lambda package, wanted, given: filling(f"{package}.msg.{wanted}", "...", given),
    ),
    _meaning(
        r"RcutilsLogger\.\w+\(\) takes|rclpy_logging_rcutils_log\(\): incompatible function arguments",
        "logger-arguments",
        "A logger's method takes one text.",
        "make one text of the values: f'... {{value}}'",
    ),
    _meaning(
        r"takes (?P<takes>\d+) positional arguments? but (?P<given>\d+) (?:was|were) given",
        "node-property callback-arguments argument-missing",
        "A function is called with {given} arguments and takes {takes} (self is counted).",
        "write the parameters that it is called with; a subscription's callback is def callback(self, msg):",
    ),
    _meaning(
        r"(?P<name>\w+)\(\) missing (?P<number>\d+) required positional arguments?: (?P<what>.*)",
        "entry-point-function callback-arguments argument-missing argument-order",
        "{name}() is called without {what}.",
        "give it {what} in its parentheses",
    ),
    _meaning(
        r"incompatible QoS\..*[Ll]ast incompatible policy: (?P<policy>\w+)|incompatible QoS",
        "qos-mismatch",
        "The two ends of a topic do not agree on the quality of service ({policy}), so nothing arrives.",
        "give the publisher and the subscription the same quality of service",
    ),
    _meaning(
        r"'property' object has no attribute '(?P<name>\w+)'",
        "attribute-unknown",
        "Here .{name} is asked of a field of a class, and not of an object of that class.",
        "make an object first, with parentheses behind the class: twist = Twist()",
    ),
    _meaning(
        r"'(?P<owner>\w+)' object has no attribute '(?P<name>\w+)'",
        "attribute-missing message-field callback-missing super-missing publisher-method attribute-unknown",
        "",
    ),
)
