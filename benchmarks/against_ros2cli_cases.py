"""The commands that are compared: every verb and flag that the course may meet, in right and in wrong use."""

from __future__ import annotations

from dataclasses import replace

from against_ros2cli_case import Case
from against_ros2cli_place import LAUNCH_FILES

_PIPE = "No traceback where the reader of a pipe has gone."


def _cases(
    text: str,
    *normal: str,
    world: str = "quiet",
    until: str = "",
    seconds: float = 20.0,
    is_terminal: bool = False,
    why: str = "",
) -> list[Case]:
    """Make a case of each line."""
    lines = [line.strip() for line in text.strip().splitlines()]
    return [Case(line, normal, world, until, seconds, is_terminal, why) for line in lines if line]


def _complete(*lines: str, world: str = "quiet") -> list[Case]:
    """Make a case of what the Tab key offers at the end of each line."""
    return [Case(f"tab '{line}'", ("tool_packages",), world) for line in lines]


TOP = [
    *_cases(
        """
        ros2
        ros2 --help
        ros2 -h
        """,
        "flags",
        why="The real one also has action, component, lifecycle and multicast; ours has --version.",
    ),
    *_cases(
        """
        ros2 nonsense
        ros2 --nonsense
        ros2 topic nonsense
        ros2 pkg nonsense
        """
    ),
]

HELP = _cases(
    "\n".join(
        f"ros2 {verb} --help"
        for verb in (
            *("pkg", "pkg create", "pkg list", "pkg executables", "pkg prefix", "pkg xml", "run", "launch"),
            *("topic", "topic list", "topic echo", "topic info", "topic hz", "topic bw", "topic delay"),
            *("topic pub", "topic type", "topic find", "node", "node list", "node info"),
            *("param", "param list", "param get", "param set", "param describe", "param dump", "param load"),
            *("param delete", "service", "service list", "service type", "service find", "service call"),
            *("interface", "interface list", "interface show", "interface package", "interface packages"),
            *("interface proto", "daemon", "daemon start", "daemon status", "daemon stop", "doctor", "wtf"),
        )
    )
    + "\nros2 pkg\nros2 topic\nros2 node\nros2 param\nros2 service\nros2 interface",
    "flags",
)

PKG = [
    *_cases(
        """
        ros2 pkg create plain
        ros2 pkg create plain --build-type ament_python
        ros2 pkg create plain --build-type ament_python --license Apache-2.0
        ros2 pkg create --build-type ament_python --license MIT --node-name talker plain
        ros2 pkg create plain --build-type ament_python --license BSD-3-Clause
        ros2 pkg create plain --build-type ament_python --license Unheard-1.0
        ros2 pkg create plain --build-type ament_python --license ?
        ros2 pkg create plain --build-type ament_python --dependencies rclpy std_msgs geometry_msgs
        ros2 pkg create plain --build-type ament_python --library-name parts
        ros2 pkg create plain --build-type ament_python --node-name talker --library-name parts
        ros2 pkg create plain --build-type ament_python --node-name plain
        ros2 pkg create plain --build-type ament_python --library-name plain
        ros2 pkg create plain --build-type ament_python --description "It says things"
        ros2 pkg create plain --build-type ament_python --description 'a < b & "c"'
        ros2 pkg create plain --build-type ament_python --maintainer-name Anna --maintainer-email anna@example.org
        ros2 pkg create plain --build-type ament_python --package-format 2
        ros2 pkg create plain --build-type ament_python --package-format 1
        ros2 pkg create plain --build-type ament_python --destination-directory deep
        mkdir deep; ros2 pkg create plain --build-type ament_python --destination-directory deep
        ros2 pkg create plain --build-type ament_python >/dev/null; ros2 pkg create plain --build-type ament_python
        ros2 pkg create plain --build-type ament_cmake --node-name talker --dependencies rclcpp
        ros2 pkg create plain --build-type ament_cmake --library-name parts --license MIT
        ros2 pkg create plain --build-type cmake --node-name talker
        ros2 pkg create plain --build-type catkin
        ros2 pkg create
        ros2 pkg create Plain-1 --build-type ament_python
        ros2 pkg create 1plain --build-type ament_python
        ros2 pkg create plain_ --build-type ament_python
        ros2 pkg create test --build-type ament_python
        ros2 pkg create plain --build-type ament_python --maintainer-email nobody
        ros2 pkg create plain --build-type ament_python --nonsense
        """,
        "own_texts",
    ),
    *_cases("ros2 pkg list", "tool_packages"),
    *_cases("ros2 pkg list | head -1", why=_PIPE),
    *_cases("ros2 pkg executables", "tool_packages"),
    *_cases("ros2 pkg executables --full-path | grep parts"),
    *_cases(
        """
        ros2 pkg executables parts
        ros2 pkg executables parts --full-path
        ros2 pkg executables robot_controller
        ros2 pkg executables rclpy
        ros2 pkg executables nowhere
        ros2 pkg prefix parts
        ros2 pkg prefix parts --share
        ros2 pkg prefix rclpy
        ros2 pkg prefix rclpy --share
        ros2 pkg prefix nowhere
        ros2 pkg prefix
        ros2 pkg xml parts
        ros2 pkg xml parts -t name
        ros2 pkg xml parts --tag version
        ros2 pkg xml parts -t maintainer
        ros2 pkg xml parts -t exec_depend
        ros2 pkg xml parts -t export
        ros2 pkg xml parts -t nothing
        ros2 pkg xml nowhere
        """
    ),
]

RUN = [
    *_cases(
        """
        ros2 run parts say
        ros2 run parts say one "two three" --four
        ros2 run parts say --ros-args -p greeting:=hello -r __node:=other -r __ns:=/far
        ros2 run parts fail
        ros2 run --prefix "echo before" parts say one
        ros2 run --prefix nowhere parts say
        ros2 run parts nothing
        ros2 run nowhere say
        ros2 run parts
        ros2 run
        ros2 run rclpy nothing
        ros2 run parts dies
        """
    ),
    *_cases("ros2 run parts waits\nros2 run parts stubborn", until="waiting", seconds=8),
]

TOPIC_QUIET = [
    *_cases(
        """
        ros2 topic list
        ros2 topic list --no-daemon
        ros2 topic list -s
        ros2 topic list -t
        ros2 topic list -c
        ros2 topic list -v
        ros2 topic list --include-hidden-topics
        ros2 topic list --spin-time 0.5 --no-daemon
        ros2 topic list --spin-time abc
        ros2 topic info /nowhere
        ros2 topic info nowhere
        ros2 topic info "/bad name"
        ros2 topic info
        ros2 topic type /nowhere
        ros2 topic find std_msgs/msg/String
        ros2 topic find nonsense
        ros2 topic find -c rcl_interfaces/msg/Log
        ros2 topic find rcl_interfaces/msg/Log
        """,
        "own_nodes",
    ),
    *_cases(
        """
        ros2 topic echo
        ros2 topic echo /nowhere
        ros2 topic echo /nowhere --timeout 1
        ros2 topic echo /nowhere nonsense
        ros2 topic echo /nowhere std_msgs/msg/Nonsense
        ros2 topic echo /nowhere nowhere_msgs/msg/String
        ros2 topic echo /nowhere std_msgs/msg/String --timeout 1
        ros2 topic echo /nowhere std_msgs/msg/String --qos-reliability nonsense
        ros2 topic echo "/bad name" std_msgs/msg/String
        ros2 topic echo /nowhere std_msgs/msg/String --filter "m.data =="
        ros2 topic hz
        ros2 topic hz /nowhere --window 0
        ros2 topic hz /nowhere --window abc
        ros2 topic bw
        ros2 topic delay
        ros2 topic pub
        ros2 topic pub /heard
        ros2 topic pub /heard nonsense
        ros2 topic pub /heard nonsense "{}"
        ros2 topic pub /heard std_msgs/msg/Nonsense "{}"
        ros2 topic pub /heard nowhere_msgs/msg/String "{}"
        ros2 topic pub /heard std_msgs/String "data: [1"
        ros2 topic pub /heard std_msgs/msg/String "{data: [1"
        ros2 topic pub /heard std_msgs/msg/String "{nonsense: 1}"
        ros2 topic pub /heard std_msgs/msg/String hello
        ros2 topic pub /heard std_msgs/msg/Int32 "{data: hello}"
        ros2 topic pub /heard std_msgs/msg/UInt8 "{data: 300}"
        ros2 topic pub /heard geometry_msgs/msg/Twist "{linear: 1.0}"
        ros2 topic pub /heard geometry_msgs/msg/Twist "{linear: {x: fast}}"
        ros2 topic pub -r 0 /heard std_msgs/msg/String "{data: hi}"
        ros2 topic pub -r -1 /heard std_msgs/msg/String "{data: hi}"
        ros2 topic pub -1 -t 2 /heard std_msgs/msg/String "{data: hi}"
        ros2 topic pub -1 -w 0 "/bad name" std_msgs/msg/String "{data: hi}"
        ros2 topic pub -t 2 -w 0 /nowhere std_msgs/msg/String "{data: hi}"
        ros2 topic pub -1 --max-wait-time-secs 1 /nowhere std_msgs/msg/String "{data: hi}"
        ros2 topic pub -w 1 --max-wait-time-secs 1 /nowhere std_msgs/msg/String "{data: hi}"
        """,
        "repeats",
        seconds=8,
    ),
    *_cases("ros2 topic echo /nowhere std_msgs/msg/String", seconds=2),
    *_cases(
        """
        ros2 topic hz /nowhere
        ros2 topic bw /nowhere
        ros2 topic delay /nowhere
        ros2 topic echo /nowhere std_msgs/msg/String --once
        ros2 topic pub -1 /nowhere std_msgs/msg/String "{data: hi}"
        """,
        "repeats",
        seconds=3,
    ),
]

TOPIC = [
    *_cases(
        """
        ros2 topic list
        ros2 topic list --no-daemon
        ros2 topic list -t
        ros2 topic list --show-types
        ros2 topic list -c
        ros2 topic list -v
        ros2 topic list -vt
        ros2 topic list --include-hidden-topics
        ros2 topic info /chatter
        ros2 topic info chatter
        ros2 topic info /chatter -v
        ros2 topic info /latched --verbose
        ros2 topic info /heard
        ros2 topic info /mixed
        ros2 topic info /mixed -v
        ros2 topic info /_hidden
        ros2 topic type /chatter
        ros2 topic type chatter
        ros2 topic type /mixed
        ros2 topic find std_msgs/msg/String
        ros2 topic find -c std_msgs/msg/String
        ros2 topic find std_msgs/String
        ros2 topic find --include-hidden-topics std_msgs/msg/String
        """,
        "gids",
        "own_nodes",
        world="talkers",
    ),
    *_cases(
        """
        ros2 topic echo --once /chatter
        ros2 topic echo --once chatter
        ros2 topic echo --once /chatter std_msgs/msg/String
        ros2 topic echo --once /chatter std_msgs/String
        ros2 topic echo --once /twist
        ros2 topic echo --once /twist --field linear
        ros2 topic echo --once /twist --field linear.x
        ros2 topic echo --once /twist --field nonsense
        ros2 topic echo --once /twist --csv
        ros2 topic echo --once /twist --csv --field angular
        ros2 topic echo --once /twist --flow-style
        ros2 topic echo --once /twist --filter "m.linear.x > 0"
        ros2 topic echo --once /twist --timeout 1 --filter "m.linear.x > 1"
        ros2 topic echo --once /array
        ros2 topic echo --once /array --full-length
        ros2 topic echo --once /array --truncate-length 5
        ros2 topic echo --once /array --no-arr
        ros2 topic echo --once /array --csv
        ros2 topic echo --once /array --csv --no-arr
        ros2 topic echo --once /array --field data
        ros2 topic echo --once /array --field "data[3]"
        ros2 topic echo --once /bytes
        ros2 topic echo --once /long_text
        ros2 topic echo --once /long_text -f
        ros2 topic echo --once /long_text --no-str
        ros2 topic echo --once /chatter --raw
        ros2 topic echo --once /quick
        ros2 topic echo --once /quick --qos-reliability reliable --timeout 2
        ros2 topic echo --once /latched
        ros2 topic echo --once /latched --qos-durability transient_local
        ros2 topic echo --once /latched --qos-durability volatile --timeout 2
        ros2 topic echo --once /chatter --qos-profile sensor_data
        ros2 topic echo --once /chatter --qos-depth 5 --qos-history keep_last
        ros2 topic echo --once /chatter std_msgs/msg/Int32 --timeout 2
        ros2 topic echo --once /mixed --timeout 2
        ros2 topic echo --once /_hidden
        ros2 topic echo --once /silent --timeout 1
        ros2 topic echo --once /number --no-lost-messages
        """,
        world="talkers",
        seconds=8,
    ),
    *_cases("ros2 topic echo --once /pose", "stamps", world="talkers"),
    *_cases("ros2 topic echo --once /pose --csv", "stamp_columns", world="talkers"),
    *_cases("ros2 topic echo --once /chatter --include-message-info", "information", world="talkers"),
    *_cases(
        "ros2 topic echo /twist", "repeated_messages", world="talkers", until=r"(?s)(---.*){3}", seconds=10
    ),
    *_cases("ros2 topic echo /twist | head -2", world="talkers", why=_PIPE),
    *_cases(
        """
        ros2 topic hz /chatter
        ros2 topic hz /chatter --window 5
        ros2 topic hz /chatter --wall-time
        ros2 topic hz /number --filter "m.data == 7"
        ros2 topic hz chatter
        """,
        "rates",
        "not_yet",
        "repeats",
        world="talkers",
        until=r"(?s)(average rate.*){2}",
        seconds=8,
    ),
    *_cases(
        """
        ros2 topic bw /chatter
        ros2 topic bw /array --window 5
        """,
        "sizes",
        "rates",
        "not_yet",
        "repeats",
        world="talkers",
        until=r"(?s)(/s from.*){2}",
        seconds=8,
    ),
    *_cases(
        "ros2 topic delay /pose",
        "rates",
        "not_yet",
        "repeats",
        world="talkers",
        until=r"(?s)(average delay.*){2}",
        seconds=8,
    ),
    *_cases("ros2 topic delay /chatter", "not_yet", world="talkers", seconds=4),
    *_cases(
        """
        ros2 topic pub -1 /heard std_msgs/msg/String "{data: hi}"; heard
        ros2 topic pub --once /heard std_msgs/String "data: hi"; heard
        ros2 topic pub -1 heard std_msgs/msg/String '{"data": "hi"}'; heard
        ros2 topic pub -1 /heard std_msgs/msg/String; heard
        ros2 topic pub -1 /heard std_msgs/msg/String "{data: 5}"; heard
        ros2 topic pub -t 3 -r 5 /heard std_msgs/msg/String "{data: hi}"; heard
        ros2 topic pub -t 2 -p 2 -r 10 /heard std_msgs/msg/String "{data: hi}"; heard
        ros2 topic pub -t 2 -r 10 -w 1 -n named /heard std_msgs/msg/String "{data: hi}"; heard
        ros2 topic pub -1 --keep-alive 1 /heard std_msgs/msg/String "{data: hi}"; heard
        ros2 topic pub -1 --qos-profile sensor_data -w 0 /heard std_msgs/msg/String "{data: hi}"
        ros2 topic pub -1 /heard_twist geometry_msgs/msg/Twist "{linear: {x: 1}}"; heard
        ros2 topic pub -1 /heard_twist geometry_msgs/msg/Twist "linear: {x: 0.5}"; heard
        ros2 topic pub -1 /heard_twist geometry_msgs/msg/Twist "{}"; heard
        printf 'data: one\\n---\\ndata: two\\n' | ros2 topic pub --stdin -w 1 /heard std_msgs/msg/String
        """,
        "waits",
        "repeats",
        world="talkers",
        seconds=8,
    ),
    *_cases(
        'ros2 topic pub -1 /stamped geometry_msgs/msg/PoseStamped "{header: auto}" -w 0\n'
        'ros2 topic pub -1 /stamped std_msgs/msg/Header "{stamp: now}" -w 0',
        "stamps",
        world="talkers",
    ),
    *_cases(
        'ros2 topic pub /heard std_msgs/msg/String "{data: hi}"\n'
        'ros2 topic pub -r 10 /heard std_msgs/msg/String "{data: hi}"',
        world="talkers",
        until="publishing #2",
        seconds=8,
    ),
]

NODE = [
    *_cases(
        """
        ros2 node list
        ros2 node list -c
        ros2 node info /nowhere
        ros2 node info
        """
    ),
    *_cases(
        """
        ros2 node list
        ros2 node list --no-daemon
        ros2 node list -a
        ros2 node list --all
        ros2 node list -c
        ros2 node info /talker
        ros2 node info talker
        ros2 node info --include-hidden /talker
        ros2 node info /deep/space/listener
        ros2 node info /nowhere
        ros2 node info /_mixed_string
        """,
        "own_nodes",
        world="talkers",
    ),
    *_cases("ros2 node list\nros2 node list -c\nros2 node info /twin", world="twins"),
]

PARAM = [
    *_cases(
        """
        ros2 param list
        ros2 param list /nowhere
        ros2 param get /nowhere a
        ros2 param set /nowhere a 1
        ros2 param describe /nowhere a
        ros2 param dump /nowhere
        ros2 param load /nowhere nothing.yaml
        ros2 param delete /nowhere a
        ros2 param get
        ros2 param set /nowhere a
        """
    ),
    *_cases(
        """
        ros2 param list
        ros2 param list /talker
        ros2 param list talker
        ros2 param list /talker --param-type
        ros2 param list /talker --param-prefixes group
        ros2 param list --filter "a_.*"
        ros2 param list --filter "("
        ros2 param list --include-hidden-nodes
        ros2 param get /talker a_bool
        ros2 param get /talker an_int
        ros2 param get /talker a_double
        ros2 param get /talker a_string
        ros2 param get /talker bools
        ros2 param get /talker ints
        ros2 param get /talker doubles
        ros2 param get /talker strings
        ros2 param get /talker any
        ros2 param get /talker group.inner
        ros2 param get --hide-type /talker an_int
        ros2 param get /talker nonsense
        ros2 param get talker an_int
        ros2 param get /deep/space/listener use_sim_time
        ros2 param describe /talker a_bool
        ros2 param describe /talker an_int a_double
        ros2 param describe /talker ints
        ros2 param describe /talker nonsense
        ros2 param describe /talker fixed
        ros2 param dump /talker
        ros2 param dump /deep/space/listener
        ros2 param set /talker an_int 5; ros2 param get /talker an_int; ros2 param set /talker an_int 3
        ros2 param set /talker an_int 11
        ros2 param set /talker an_int 1.5
        ros2 param set /talker an_int text
        ros2 param set /talker a_double 1
        ros2 param set /talker a_double 0.25; ros2 param get /talker a_double; ros2 param set /talker a_double 0.5
        ros2 param set /talker a_double 2.0
        ros2 param set /talker a_bool false; ros2 param get /talker a_bool; ros2 param set /talker a_bool true
        ros2 param set /talker a_bool off; ros2 param set /talker a_bool yes
        ros2 param set /talker a_string "b c"; ros2 param get /talker a_string; ros2 param set /talker a_string text
        ros2 param set /talker a_string 5
        ros2 param set /talker a_string "'5'"; ros2 param set /talker a_string text
        ros2 param set /talker a_string bad
        ros2 param set /talker ints "[4, 5]"; ros2 param get /talker ints; ros2 param set /talker ints "[1, 2, 3]"
        ros2 param set /talker strings "[x, y]"; ros2 param set /talker strings "[a, b c]"
        ros2 param set /talker doubles "[1, 2]"
        ros2 param set /talker fixed 2
        ros2 param set /talker nonsense 2
        ros2 param set /talker any 2; ros2 param get /talker any
        ros2 param delete /talker fixed
        ros2 param delete /talker an_int
        ros2 param delete /talker any
        ros2 param delete /talker nonsense
        ros2 param load /talker nothing.yaml
        printf '/talker:\\n  ros__parameters:\\n    an_int: 4\\n' >p.yaml; ros2 param load /talker p.yaml
        printf '/**:\\n  ros__parameters:\\n    an_int: 3\\n' >p.yaml; ros2 param load /talker p.yaml
        printf '/**:\\n  ros__parameters:\\n    an_int: 3\\n' >p.yaml; ros2 param load --no-use-wildcard /talker p.yaml
        printf '/other:\\n  ros__parameters:\\n    an_int: 3\\n' >p.yaml; ros2 param load /talker p.yaml
        printf '/talker:\\n  an_int: 3\\n' >p.yaml; ros2 param load /talker p.yaml
        printf '/talker:\\n  ros__parameters:\\n    an_int: 99\\n' >p.yaml; ros2 param load /talker p.yaml
        printf '{' >p.yaml; ros2 param load /talker p.yaml
        ros2 param dump /talker >p.yaml; ros2 param load /talker p.yaml
        """,
        world="talkers",
    ),
]

SERVICE = [
    *_cases(
        """
        ros2 service list
        ros2 service list -t
        ros2 service list -c
        ros2 service type /nowhere
        ros2 service find std_srvs/srv/Trigger
        ros2 service find nonsense
        ros2 service call
        ros2 service call /nowhere
        ros2 service call /nowhere nonsense
        ros2 service call /nowhere nonsense "{}"
        ros2 service call /nowhere std_srvs/srv/Nonsense "{}"
        ros2 service call /nowhere nowhere/srv/Empty "{}"
        ros2 service call /nowhere std_srvs/srv/SetBool "{data"
        """
    ),
    *_cases("ros2 service call /nowhere std_srvs/srv/Trigger", seconds=3),
    *_cases(
        """
        ros2 service list
        ros2 service list -t
        ros2 service list --show-types
        ros2 service list -c
        ros2 service list --include-hidden-services
        ros2 service type /switch
        ros2 service type switch
        ros2 service find std_srvs/srv/SetBool
        ros2 service find -c std_srvs/srv/SetBool
        ros2 service find std_srvs/SetBool
        ros2 service call /switch std_srvs/srv/SetBool "{data: true}"
        ros2 service call /switch std_srvs/SetBool "data: false"
        ros2 service call switch std_srvs/srv/SetBool
        ros2 service call /switch std_srvs/srv/SetBool "{data: 5}"
        ros2 service call /switch std_srvs/srv/SetBool "{nonsense: 5}"
        ros2 service call /switch std_srvs/srv/SetBool "{data: [1"
        ros2 service call /trigger std_srvs/srv/Trigger
        ros2 service call /trigger std_srvs/srv/Trigger "{}"
        ros2 service call /nothing std_srvs/srv/Empty
        ros2 service call /talker/get_parameters rcl_interfaces/srv/GetParameters "{names: [an_int, a_string]}"
        """,
        "own_nodes",
        "waits",
        world="talkers",
        seconds=8,
    ),
    *_cases(
        "ros2 service call -r 5 /trigger std_srvs/srv/Trigger",
        "repeats",
        world="talkers",
        until=r"(?s)(response:.*){2}",
        seconds=8,
    ),
]

INTERFACE = [
    *_cases("ros2 interface list | head -3", why=_PIPE),
    # The real one's order is that of a set, another one at every run.
    *_cases("ros2 interface package std_srvs\nros2 interface package geometry_msgs -m", "order"),
    *_cases(
        """
    ros2 interface list
    ros2 interface list -m
    ros2 interface list --only-srvs
    ros2 interface list -a
    ros2 interface package nowhere
    ros2 interface package rclpy
    ros2 interface packages
    ros2 interface packages -m
    ros2 interface packages -s
    ros2 interface packages -a
    ros2 interface show std_msgs/msg/String
    ros2 interface show geometry_msgs/msg/Twist
    ros2 interface show geometry_msgs/Twist
    ros2 interface show geometry_msgs/msg/PoseStamped
    ros2 interface show geometry_msgs/msg/PoseStamped --no-comments
    ros2 interface show geometry_msgs/msg/PoseStamped --all-comments
    ros2 interface show sensor_msgs/msg/Image
    ros2 interface show nav_msgs/msg/Odometry
    ros2 interface show nav_msgs/srv/GetPlan
    ros2 interface show std_srvs/srv/SetBool
    ros2 interface show std_srvs/srv/Empty
    ros2 interface show rcl_interfaces/msg/ParameterDescriptor
    ros2 interface show rcl_interfaces/srv/SetParameters --no-comments
    ros2 interface show nonsense
    ros2 interface show std_msgs/msg/Nonsense
    ros2 interface show nowhere/msg/String
    ros2 interface show std_msgs/nonsense/String
    ros2 interface show
    ros2 interface proto std_msgs/msg/String
    ros2 interface proto geometry_msgs/msg/Twist
    ros2 interface proto geometry_msgs/msg/Twist --no-quotes
    ros2 interface proto std_srvs/srv/SetBool
    ros2 interface proto sensor_msgs/msg/LaserScan
    ros2 interface proto std_msgs/msg/Nonsense
    ros2 interface proto nonsense
    echo geometry_msgs/msg/Point | ros2 interface show -
    """
    ),
]

LAUNCH_COMMAND = [
    *_cases("ros2 launch robot_controller robot.launch.py -p", "modules"),
    *_cases(
        """
        ros2 launch
        ros2 launch nowhere
        ros2 launch nowhere.launch.py
        ros2 launch nowhere robot.launch.py
        ros2 launch robot_controller
        ros2 launch robot_controller nowhere.launch.py
        ros2 launch robot_controller robot.launch.py --show-args
        ros2 launch robot_controller robot.launch.py -s
                ros2 launch robot_controller robot.launch.py status_period:=soon
        ros2 launch robot_controller robot.launch.py nonsense
        ros2 launch robot_controller robot.launch.py :=1
        """
    ),
    *_cases(
        """
        ros2 launch robot_controller robot.launch.py
        ros2 launch robot_controller robot.launch.py status_period:=0.5 namespace:=anna
        ros2 launch robot_controller robot.launch.py unknown:=1
        ros2 launch -n robot_controller robot.launch.py
        ros2 launch -a robot_controller robot.launch.py
        """,
        "ends",  # a node may get a second SIGINT while it ends, and may see another one end before
        "end_levels",
        "partings",
        "order",
        until=r"(?s)has a publisher.*has a publisher",
        seconds=10,
    ),
]

DAEMON = _cases("ros2 daemon\nros2 daemon status\nros2 daemon start\nros2 daemon stop\nros2 daemon nonsense")

DOCTOR = _cases("ros2 doctor\nros2 wtf\nros2 doctor --report\nros2 doctor nonsense", "order")

COMPLETION = [
    *_complete(
        "ros2 ",
        "ros2 to",
        "ros2 topic ",
        "ros2 topic ec",
        "ros2 pkg create --",
        "ros2 pkg create --build-type ",
        "ros2 pkg prefix par",
        "ros2 run par",
        "ros2 run parts ",
        "ros2 run parts s",
        "ros2 launch robot_con",
        "ros2 launch robot_controller ",
        "ros2 launch robot_controller robot.launch.py ",
        "ros2 interface show geometry_msgs/msg/Tw",
        "ros2 topic pub /x std_msgs/msg/Str",
        "ros2 topic echo --qos-reliability ",
    ),
    *_complete(
        "ros2 topic echo ",
        "ros2 topic echo /ch",
        "ros2 topic pub /chatter ",
        "ros2 topic pub /chatter std_msgs/msg/String ",
        "ros2 node info ",
        "ros2 param get ",
        "ros2 param get /talker a",
        "ros2 service call ",
        "ros2 service call /switch ",
        world="talkers",
    ),
]

# Launch files: how each is started, and what else it is started with.
_LAUNCHED = {
    "arguments.launch.py": (
        "",
        "needed:=x",
        "needed:=x colour:=green",
        "-s",
        "needed:=x colour:=blue bare:=",
    ),
    "conditions.launch.py": ("", "wanted:=false", "wanted:=1", "wanted:=perhaps"),
    "include.launch.py": ("", "-s", "needed:=y"),
    "include_without_argument.launch.py": ("", "-s"),
    "logs.launch.xml": ("", "colour:=blue", "-s", "-p"),
    "logs.launch.yaml": ("", "colour:=blue", "-s"),
    "groups.launch.xml": ("", "wanted:=false", "-s"),
    "processes.launch.py": (
        "",
        "-p",
        "-d",
        "-a",
        "--launch-prefix env",
        "--launch-prefix env --launch-prefix-filter e.*",
    ),
    "substitutions.launch.py": ("", "-p"),
    "names.launch.py": ("", "-p"),
    "events.launch.py": ("", "-p"),
    "failing.launch.py": ("", "--launch-prefix nowhere"),
}
_ON_PURPOSE = {
    ("processes.launch.py", "-d"): "What is logged for finding faults in launch itself is each one's own.",
    ("deprecated.launch.py", ""): "The warning is in our own words.",
}
_WAITING = ("waiting.launch.py", "stubborn.launch.py")
_CONCURRENT = (
    "processes",
    "events",
    "environment",
    "shell",
    "terminal",
    "many",
    "groups",
    "on_exit",
    "output_",
)


def _launched() -> list[Case]:
    """Make cases of every launch file."""
    cases = []
    for path in sorted(LAUNCH_FILES.glob("*.launch.*")):
        until = "waiting" if path.name in _WAITING else ""
        order = ("order",) if path.name.startswith(_CONCURRENT) or until else ()
        for words in _LAUNCHED.get(path.name, ("",)):
            command = f"ros2 launch $LAUNCH_FILES/{path.name} {words}".strip()
            normal = ("modules",) if words.endswith("-p") else order
            cases.append(
                Case(command, normal, until=until, seconds=12, why=_ON_PURPOSE.get((path.name, words), ""))
            )
    return cases


LAUNCH_FILE = [
    *_launched(),
    *_cases("echo 'def broken(:' >broken.launch.py; ros2 launch broken.launch.py"),
    *_cases(
        "ros2 launch $LAUNCH_FILES/nothing.launch.py\nros2 launch $LAUNCH_FILES\nros2 launch parts nothing.launch.py"
    ),
    *_cases(
        "ros2 launch $LAUNCH_FILES/output_screen.launch.py\nros2 launch $LAUNCH_FILES/failing.launch.py",
        is_terminal=True,
    ),
    *_cases("ros2 launch $LAUNCH_FILES/waiting.launch.py", "order", is_terminal=True, until="waiting"),
    *_cases("ros2 launch $LAUNCH_FILES/waiting.launch.py | head -2", seconds=4, why=_PIPE),
    *_cases(
        "ros2 launch $LAUNCH_FILES/output_own_log.launch.py; cd $ROS_LOG_DIR; cat */*-stdout.log; rm -r *"
    ),
]

# Where ours differs on purpose: the command, the world, and why.
_FILES_ONLY = "Own templates, and a sentence that this machine only stores the files."
_DAEMON = "Ours also sees the daemon of the real one, which counts its own node; without it both count alike."
_REASONS = {
    ("ros2 topic list -v", "quiet"): _DAEMON,
    ("ros2 topic list -v", "talkers"): _DAEMON,
    ("ros2 topic list -vt", "talkers"): _DAEMON,
    ("ros2 nonsense", "quiet"): "Ours names the commands that it has.",
    ("tab 'ros2 '", "quiet"): "Ours offers the commands that it has, and --version.",
    (
        "tab 'ros2 launch robot_controller robot.launch.py '",
        "quiet",
    ): "Ours also offers the launch arguments.",
    ("ros2 node list --no-daemon", "talkers"): "The real one does not wait until it has found all.",
    ("ros2 topic list --no-daemon", "talkers"): "The real one does not wait until it has found all.",
    ("ros2 launch robot_controller", "quiet"): "Ours names the launch files that there are.",
    ("ros2 pkg create plain", "quiet"): _FILES_ONLY,
    (
        "ros2 pkg create plain --build-type ament_cmake --node-name talker --dependencies rclcpp",
        "quiet",
    ): _FILES_ONLY,
    (
        "ros2 pkg create plain --build-type ament_cmake --library-name parts --license MIT",
        "quiet",
    ): _FILES_ONLY,
    ("ros2 pkg create plain --build-type cmake --node-name talker", "quiet"): _FILES_ONLY,
}


def _with_reasons(cases: list[Case]) -> list[Case]:
    return [replace(case, why=_REASONS.get((case.command, case.world), case.why)) for case in cases]


_ALL = {
    "top": TOP,
    "help": HELP,
    "pkg": PKG,
    "run": RUN,
    "interface": INTERFACE,
    "topic_quiet": TOPIC_QUIET,
    "topic": TOPIC,
    "node": NODE,
    "param": PARAM,
    "service": SERVICE,
    "launch": LAUNCH_COMMAND,
    "launch_file": LAUNCH_FILE,
    "completion": COMPLETION,
    "doctor": DOCTOR,
    "daemon": DAEMON,
}
GROUPS = {name: _with_reasons(cases) for name, cases in _ALL.items()}
