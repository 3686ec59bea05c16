"""The meanings of error messages that come from running nodes and from messages."""

from __future__ import annotations

from ros2lab.diagnose.explaining.meaning import Meaning, meaning
from ros2lab.diagnose.nodes.message_faults import filling
from ros2lab.diagnose.nodes.parameter_values import value_fix

NODE_MEANINGS: tuple[Meaning, ...] = (
    # Nodes
    meaning(
        r"_TYPE_SUPPORT|might be a ROS 1 message type",
        "type-not-a-message",
        "A publisher or a subscription was given something that is not a message type.",
        "use a type such as String, from std_msgs.msg import String",
    ),
    meaning(
        r"'Publisher' object has no attribute '(?P<name>\w+)'",
        "publisher-method",
        "A publisher has no method {name}; it is publish.",
        "write publish(msg)",
    ),
    meaning(
        r"'NoneType' object is not callable",
        "callback-called",
        "Something that is None was called: usually a callback was called where it should only be passed.",
        "look for parentheses after the method passed to create_timer or create_subscription, and remove them",
    ),
    meaning(
        r"callback should be either be callable with one argument",
        "callback-arguments callback-missing argument-order",
        "A subscription calls its callback with the message, but this callback does not take one.",
        "write def callback(self, msg):",
    ),
    meaning(
        r"create_(?:subscription|publisher)\(\) missing 1 required positional argument: 'qos_profile'",
        "qos-missing argument-order",
        "The queue depth is missing.",
        "add 10 as the last argument",
    ),
    meaning(
        r"\.(?P<name>create_\w+)\(\) missing \d+ required positional arguments?: (?P<what>.*)",
        "argument-missing argument-order dot-for-comma",
        "{name} is missing {what}.",
        "add the missing arguments",
    ),
    meaning(
        r"Expected QoSProfile or int, but received <class '(?:[\w.]+\.)?(?P<given>\w+)'>",
        "argument-order argument-type",
        "The quality of service must be a queue length such as 10, or a QoSProfile, but a value of type {given} is given.",
        "write 10 where the queue length belongs, as in create_subscription(String, 'topic', self.callback, 10)",
    ),
    meaning(
        r"unexpected keyword argument 'queue_size'",
        "queue-size",
        "queue_size belongs to ROS 1; in ROS 2 the queue depth is the last argument.",
        "write create_publisher(String, 'topic', 10)",
    ),
    meaning(
        r"'(?:float|int)' object has no attribute 'self'",
        "dot-for-comma",
        "After a number there is a dot where a comma should be, as in create_timer(2.0.self.callback).",
        "write a comma and a space instead of the dot",
    ),
    meaning(
        r"'(?:float|int)' object has no attribute '(?P<name>\w+)'",
        "dot-for-comma attribute-missing message-field attribute-unknown",
        "",
    ),
    meaning(
        r"'super' object has no attribute '(?P<name>\w*init\w*)'|descriptor '__init__' .*'super' object|type super.*__init__",
        "super-misspelt",
        "The constructor of Node is called with super().__init__, with two underscores on each side.",
        "write super().__init__('node_name')",
    ),
    meaning(
        r"has no attribute '_(?:default_callback_group|Node__\w+|logger|parameters|handle|context|clock|callback_groups)'",
        "super-missing super-late super-misspelt",
        "The node is used before super().__init__() is called, or it is never called.",
        "write super().__init__('node_name') as the first line of __init__",
    ),
    meaning(
        r"__init__(?:\(\))? (?:of type \S+ was )?(?:not|never) called",
        "super-missing super-misspelt",
        "The constructor of a class from which this object's class inherits was never called.",
        "call super().__init__() as the first line of its __init__; with several bases, call the __init__ of each by its name",
    ),
    meaning(
        r"property '(?P<name>\w+)' of '(?P<owner>\w+)' object has no setter|can't set attribute '?(?P<name2>\w*)",
        "node-property",
        "{name}{name2} is already a property of every node, and cannot be assigned.",
        "give yours another name, such as self.{name}{name2}_",
    ),
    meaning(
        r"InvalidNodeNameException|[Ii]nvalid node name",
        "node-name-invalid",
        "A node's name may contain only letters, digits and _.",
        "write _ instead of other characters",
    ),
    meaning(
        r"validating node name or namespace for .*namespace=(?!None)(?P<name>[^']*)'",
        "node-name-invalid",
        "The namespace {name!r} is not valid: between slashes it may contain only letters, digits and _, and no part may begin with a digit.",
        "write _ instead of other characters",
    ),
    meaning(
        r"Callback returned an invalid type",
        "value-none",
        "A callback of add_on_set_parameters_callback must return a SetParametersResult, but returns something else.",
        "write `return SetParametersResult(successful=True)` as its last line, with `from rcl_interfaces.msg import SetParametersResult` at the top",
    ),
    meaning(
        r"generator already executing|Executor is already spinning",
        "not-spinning",
        "Two threads spin the same executor: rclpy.spin() and its like all use the one that rclpy has for a program.",
        "give rclpy.spin in each thread an executor of its own, a SingleThreadedExecutor of rclpy.executors, as the second argument",
    ),
    meaning(
        r"Transition is not registered",
        "transition-wrong",
        "The managed node was asked for a transition that its present state does not have: it must be configured before it can be activated.",
        "type `ros2 lifecycle set /node configure` first, with the node's name, and then activate; `ros2 lifecycle get /node` shows its state",
    ),
    meaning(
        r"Logger severity cannot be changed between calls",
        "python-error",
        "rclpy remembers the severity of each logging line, but this line logs sometimes with one severity and sometimes with another.",
        "call the logger on a line of its own for each severity that the line has now, each in its own branch of an `if`",
    ),
    meaning(
        r"UnknownROSArgsError: \[(?P<name>.*)\]",
        "typed-wrong launch-argument",
        "After --ros-args there is {name}, which ROS does not know there; each parameter needs a -p of its own, each remapping a -r.",
        "put a value with a space in quotes, or write _ instead of the space, and put the node's own arguments before --ros-args",
    ),
    meaning(
        r"InvalidTopicNameException|InvalidServiceNameException|[Ii]nvalid topic name",
        "topic-name-invalid",
        "Between slashes, a topic name may contain only letters, digits and _, and no part may begin with a digit.",
        "write _ instead of other characters",
    ),
    meaning(
        r"NotInitializedException|rclpy\.init\(\) has not been called",
        "rclpy-init-missing",
        "A node is made before rclpy.init() is called.",
        "write rclpy.init(args=args) as the first line of main",
    ),
    meaning(
        r"Context\.init\(\) must only be called once",
        "rclpy-init-twice",
        "rclpy.init() is called twice in one program.",
        "remove one of the two; the call belongs in main",
    ),
    meaning(
        r"'method' object does not support the context manager protocol",
        "node-property",
        "Every node already has `handle`, which a method of this name hides.",
        "rename the method, for example to handle_, also where it is used",
    ),
    meaning(
        r"object does not support the context manager protocol|AttributeError: __enter__",
        "context-manager",
        "What comes after `with` cannot be used there; in ROS 2 Jazzy neither rclpy.init() nor a node can.",
        "write rclpy.init(args=args) as the first line of main, and rclpy.try_shutdown() as its last",
    ),
    meaning(
        r"rcl_shutdown already called|Context must be initialized before it can be shutdown",
        "shutdown-twice",
        "rclpy was already shut down, by Ctrl-C or by another line, and this line does it again; this is harmless.",
        "write rclpy.try_shutdown() instead of rclpy.shutdown()",
    ),
    meaning(
        r"ParameterNotDeclaredException|undeclared parameter\(s\): (?P<name>\w*)",
        "parameter-undeclared",
        "The node reads a parameter that it has never declared.",
        "write self.declare_parameter('name', 1.0) before it is read",
    ),
    meaning(
        r"Trying to set parameter '(?P<name>[\w.]+)' to '(?P<value>.*?)' of type '(?P<kind>\w+)', expecting type '(?P<wanted>\w+)'",
        "parameter-type",
        "The parameter {name} must be {wanted}, but is given {value}.",
        value_fix,
    ),
    meaning(
        r"InvalidParameterTypeException",
        "parameter-type",
        "A parameter is given a value of the wrong type.",
        "write 2.0 instead of 2 for a double",
    ),
    meaning(
        r"yaml\.\w+Error|parse[rd]? .*ya?ml|Couldn't parse params file",
        "parameter-file-syntax parameter-file-node",
        "The parameter file cannot be read.",
        "indent with spaces, and write the node's name, then ros__parameters:, then the parameters",
    ),
    # Messages
    meaning(
        # Numbers so near 0 are hardly ever meant: they are the bytes of an int, read as a float.
        r"\b(?P<value>\d(?:\.\d+)?e-3(?:0[89]|1\d|2[0-4]))\b",
        "int-in-float",
        "{value} is practically 0, and nobody wrote it: an int was put into a field that holds a float, and ROS read the wrong bytes.",
        "write 1.0 instead of 1 where that field is set",
    ),
    meaning(
        r"PyFloat_Check|must be of type 'float'",
        "int-in-float field-type",
        "This field holds a float, but was given something else: an int, a string, or None from a parameter without a default.",
        "write 1.0 instead of 1, or float(...) around the value, and give a parameter a default, as in declare_parameter('speed', 0.5)",
    ),
    meaning(
        r"has no (?:field|attribute) '(?P<name>\w+):(?P<value>[^' ]+)'",
        "message-field",
        "YAML needs a space after a colon; without one, {name}:{value} is a single name.",
        "write {name}: {value}",
    ),
    meaning(
        r"PyUnicode_Check|bad argument type for built-in operation|The 'data' field must be of type 'str'",
        "string-data-type field-type",
        "The data field of a String was given something that is not a string.",
        "write str(...) around it",
    ),
    meaning(
        r"The '(?P<name>\w+)' field must be a sub message of type '(?P<what>\w+)'",
        "field-type int-in-float string-data-type",
        "The field {name} needs a message of type {what}.",
        "give it a value of that type",
    ),
    meaning(
        r"The '(?P<name>\w+)' field must be (?P<what>.*)",
        "field-type int-in-float string-data-type",
        "The field {name} must be {what}.",
        "give it a value of that type",
    ),
    meaning(
        r"Expected <class '(?P<package>\w+)\.msg\.\w+\.(?P<wanted>\w+)'>, got <class '(?:[\w.]+\.)?(?P<given>\w+)'>",
        "publish-text publish-type",
        "publish() needs a message of type {wanted}, but was given a value of type {given}.",
        lambda package, wanted, given: filling(f"{package}.msg.{wanted}", "...", given),
    ),
    meaning(
        r"RcutilsLogger\.\w+\(\) takes|rclpy_logging_rcutils_log\(\): incompatible function arguments",
        "logger-arguments",
        "A logger's method takes one string.",
        "combine the values into one string: f'... {{value}}'",
    ),
    meaning(
        r"takes (?P<takes>\d+) positional arguments? but (?P<given>\d+) (?:was|were) given",
        "node-property callback-arguments argument-missing",
        "A function is called with {given} arguments but takes {takes} (counting self).",
        "give it the parameters it is called with; a subscription's callback is def callback(self, msg):",
    ),
    meaning(
        r"(?P<name>\w+)\(\) missing (?P<number>\d+) required positional arguments?: (?P<what>.*)",
        "entry-point-function callback-arguments argument-missing argument-order",
        "{name}() is called without {what}.",
        "pass it {what} in the parentheses",
    ),
    meaning(
        r"incompatible QoS\..*[Ll]ast incompatible policy: (?P<policy>\w+)|incompatible QoS",
        "qos-mismatch",
        "The two ends of a topic do not agree on the quality of service ({policy}), so nothing arrives.",
        "give the publisher and the subscription the same quality of service",
    ),
    meaning(
        r"'property' object has no attribute '(?P<name>\w+)'",
        "attribute-unknown",
        ".{name} is used on a field of a class itself: the parentheses that make an instance of it are missing.",
        "make an instance first, with parentheses after the class: twist = Twist()",
    ),
    meaning(
        r"'(?P<owner>\w+)' object has no attribute '(?P<name>\w+)'",
        "private-name attribute-missing message-field callback-missing super-missing publisher-method attribute-unknown",
        "",
    ),
)
