"""Load launch files as `ros2 launch` does, start nothing, and print what they would start, as a line of JSON for each.

It runs in a process of its own that can change nothing and that ends with the process that started it.
"""

from __future__ import annotations

import contextlib
import functools
import io
import itertools
import json
import logging
import os
import re
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Mapping
from types import FrameType, MappingProxyType
from typing import Any

import yaml

from ros2lab.diagnose.confinement import confine
from ros2lab.diagnose.launching.by_argument import note_arguments, parameters_in_order
from ros2lab.diagnose.launching.in_order import InOrder
from ros2lab.diagnose.launching.waited_for import WaitedFor

MEMORY = 2_000_000_000  # bytes
MOST_TRIED = 1  # s, for all that is loaded once more, with other values of arguments
LONGEST = 20  # s, on a busy machine; files that wait for something are not waited for
MOST_TOLD = 10_000_000  # bytes
# Audit events of what changes or starts something; that a file truly cannot, Linux sees to.
_CHANGES = re.compile(
    r"os\.(?!listdir|scandir|putenv|unsetenv|add_dll|fwalk|walk)|shutil\.|subprocess\.|socket\.|pty\."
)


def main() -> None:
    """Load the files named on the command line; nothing is printed where this process cannot be confined."""
    import launch.logging
    import launch_ros.actions  # while files can still be written: importing compiles modules

    sys.dont_write_bytecode = True
    launch.logging.launch_config.log_dir = "/"  # nothing is written there: the handler drops all records
    launch.logging.launch_config.log_handler_factory = lambda *_, **__: logging.NullHandler()
    refused: list[str] = []
    sys.addaudithook(_noting(refused))
    confine(memory_bytes=MEMORY, cpu_s=LONGEST, written_bytes=MOST_TOLD)
    real = sys.stdout

    def load(path: str, given: Mapping[str, str] = MappingProxyType({})) -> dict[str, Any]:
        return _Loading(path, launch_ros.actions.Node, given).result(refused)

    def tell(path: str) -> None:
        real.write(f"\n{json.dumps({path: found[path]}, default=str)}\n")
        real.flush()  # whatever becomes of those after it

    found: dict[str, dict[str, Any]] = {}
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        for path in sys.argv[1:]:
            found[path] = load(path)
            tell(path)
        end = threading.Timer(MOST_TRIED, os._exit, [0])  # a file may wait for any value
        end.daemon = True
        end.start()
        for path, told in found.items():
            if note_arguments(told, functools.partial(load, path)):
                tell(path)


def _noting(refused: list[str]) -> Callable[[str, tuple[Any, ...]], None]:
    """Return an audit hook that refuses, and notes, what would change something on this machine."""

    def hook(event: str, given: tuple[Any, ...]) -> None:
        if event == "open":
            path, mode, flags = given
            writes = mode
            if isinstance(flags, int):
                writes = flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC)
            if not writes or isinstance(path, int) or path == os.devnull:
                return
        elif not _CHANGES.match(event):
            return
        refused.append(event)
        raise PermissionError(f"{event}: a launch file is only looked at here")

    return hook


# Such an error may only mean that a file, module, package, variable or argument is not on this machine.
_OUTSIDE = (OSError, ImportError, LookupError, RuntimeError, SystemExit)
# But an error raised in these modules is a fault of the launch file.
_READ_IN = ("launch.launch_description", "launch.launch_description_entity", "launch.utilities")


def _words_of(problem: BaseException) -> str:
    """Return the last line of an error's message, without the attempts listed before it."""
    if isinstance(problem, yaml.MarkedYAMLError) and problem.problem:
        return str(problem.problem)
    lines = [line for line in str(problem).splitlines() if line.strip()]
    return lines[-1].removeprefix(" - ").strip() if lines else type(problem).__name__


def _is_outside(problem: BaseException) -> bool:
    modules = [frame.f_globals["__name__"] for frame, _ in traceback.walk_tb(problem.__traceback__)]
    return _asks_the_machine(problem) or (isinstance(problem, _OUTSIDE) and modules[-1] not in _READ_IN)


# Substitutions that fail because of the launch file itself; all others ask the machine.
_OF_THE_FILE = ("LaunchConfiguration", "PythonExpression")


def _asks_the_machine(problem: BaseException) -> bool:
    """Return whether a substitution fails because something outside the launch file is missing."""
    frames = (frame for frame, _ in traceback.walk_tb(problem.__traceback__))
    failing = [type(frame.f_locals["self"]).__name__ for frame in frames if "self" in frame.f_locals]
    return type(problem).__name__ == "SubstitutionFailure" and failing[-1] not in _OF_THE_FILE


def _lacking(problem: BaseException) -> str:
    """Return the message about a package or module that is not on this machine; empty for other errors.

    A name that a module lacks, or a module that its package lacks, is misspelt or of another version.
    """
    said, searched, _ = str(problem.args[0] if problem.args else "").partition(", searching")
    top = problem.name.partition(".")[0] if isinstance(problem, ModuleNotFoundError) and problem.name else ""
    return said if searched or (top and top not in sys.modules) else ""


def _parameters(frame: FrameType) -> dict[str, Any]:
    """Return the arguments of a frame's function by name, without self."""
    code = frame.f_code
    names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
    return {name: frame.f_locals[name] for name in names if name != "self" and name in frame.f_locals}


def _inside(entity: Any) -> list[Any]:
    """Return what an entity holds, whether or not it is visited."""
    inner: list[tuple[str, list[Any]]] = getattr(entity, "describe_conditional_sub_entities", list)()
    return [child for _, several in inner for child in several]


def _text(context: Any, given: Any) -> str | None:
    """Return what launch makes of a text with substitutions; None for nothing."""
    from launch.utilities import normalize_to_list_of_substitutions, perform_substitutions

    if given is None:
        return None
    given = normalize_to_list_of_substitutions(getattr(given, "param_file", given))
    return str(perform_substitutions(context, given))


class _Loading:
    """A launch file, with every node that it makes, and those that would be started with some launch arguments."""

    def __init__(self, path: str, node: Any, arguments: Mapping[str, str]) -> None:
        self.path, self.node, self.given = path, node, arguments
        self.made: list[tuple[Any, dict[str, Any], int | None]] = []
        self.nodes: list[dict[str, Any]] = []
        self.reached: set[int] = set()
        self.conditions: dict[int, tuple[Any, ...]] = {}  # of each entity, with those of what it is in
        self.choices: list[
            list[list[str | None]]
        ] = []  # all nodes, then those that each choice of arguments starts
        self.faults: list[dict[str, Any]] = []
        self.arguments: dict[str, str | None] = {}  # with their values, where known
        self.asked: dict[str, set[str]] = {}  # by tag, the attributes that its action asks for
        self.later: list[dict[str, Any]] = []  # what only actions lack that launch does not run at once
        self.is_later = False
        self.lines: dict[int, tuple[Any, int | None]] = {}  # of each action, where this file makes it
        self.waited_for = WaitedFor()
        self.order = InOrder(lambda action: self.lines.get(id(action), (None, None))[1])

    def result(self, refused: list[str]) -> dict[str, Any]:
        """Return what it would start, why launch refuses it, or what it lacks; empty if unknown."""
        error = None
        refused.clear()
        with self._watched():
            try:
                self._load()
            except (Exception, SystemExit) as raised:  # a launch file may raise anything
                # Launch tries several parsers; the cause is the error of the one that fits the file's name.
                problem = raised.__cause__ if type(raised).__name__ == "InvalidLaunchFileError" else raised
                if problem is not None and not _is_outside(problem):
                    error = {
                        "message": _words_of(problem),
                        "is_yaml": isinstance(problem, yaml.YAMLError),
                        "line": self._line_of(problem),
                        "refused": self._refused(problem),
                        "is_later": self.is_later,
                    }
                elif not self.faults:
                    lacks = "" if problem is None or refused else _lacking(problem)
                    return {"lacks": lacks, "line": self._line_of(problem)} if problem and lacks else {}
        lost = [line for action, _, line in self.made if id(action) not in self.reached and line]
        if refused:
            return {}
        return {
            "nodes": self.nodes,
            "choices": self.choices,
            "arguments": dict(sorted(self.arguments.items())),
            "lost": [] if error else lost,
            "faults": self.faults,
            "error": error,
            "later": self.later,
            "late": self.order.late,
            "unknown": self.order.lost,
            "shared": self.order.shared,
            "waited_for": [] if error else [*self._waited_for()],
        }

    def _waited_for(self) -> Iterator[dict[str, Any]]:
        """Yield the handlers that wait for what launch is not given, with a node that is written alike and that it is given."""
        nodes = [(node, given) for node, given, _ in self.made]
        for kind, target, line in self.waited_for.lost(self.reached):
            own = next((given for node, given in nodes if node is target), {})
            alike = [n for n, given in nodes if own and str(given) == str(own) and id(n) in self.reached]
            places = [self.lines.get(id(action), (None, None))[1] for action in (target, *alike)]
            executable = str(own.get("executable", "")) or type(target).__name__
            row = {"kind": kind, "line": line, "waits_for": executable}
            yield {**row, "made": places[0], "alike": places[1:]}

    def _line_of(self, problem: BaseException) -> int | None:
        frames = reversed(traceback.extract_tb(problem.__traceback__))
        return next((frame.lineno for frame in frames if frame.filename == self.path), None)

    def _refused(self, problem: BaseException) -> dict[str, str]:
        """Return the argument of a library function that it refuses; empty if the message names none.

        Inner functions may know the value by another name than the one it was passed by: the object is the same.
        """
        frames = [frame for frame, _ in traceback.walk_tb(problem.__traceback__)]
        last = max(
            (n for n, f in enumerate(frames) if f.f_code.co_filename == self.path), default=len(frames)
        )
        called = frames[last + 1 :]
        for frame in reversed(called):
            for name, value in _parameters(frame).items():
                given = [parameter for parameter, known in _parameters(called[0]).items() if known is value]
                if re.search(rf"\b{name}\b", str(problem)) and given:
                    owner = called[0].f_locals.get("self")
                    function = called[0].f_code.co_name if owner is None else type(owner).__name__
                    return {"name": name, "given": given[0], "to": function, "type": type(value).__name__}
        return {}

    def _load(self) -> None:
        from launch import LaunchContext
        from launch.actions import IncludeLaunchDescription
        from launch.launch_description_sources import AnyLaunchDescriptionSource

        included = IncludeLaunchDescription(AnyLaunchDescriptionSource(self.path))  # as `ros2 launch` does
        context = LaunchContext(noninteractive=True)
        context.launch_configurations.update(self.given)
        self._visit(included, context)
        for name in self.arguments:
            self.arguments[name] = context.launch_configurations.get(name)
        with contextlib.suppress(Exception):  # of a node that is not started, anything may be unknown
            self._choose(context)

    def _choose(self, context: Any) -> None:
        """Note all nodes, and then those that start with the defaults and with each other value of a switch."""
        given = context.launch_configurations
        words = [
            [_text(context, made.get(word)) for word in ("package", "executable", "name")]
            for _, made, _ in self.made
        ]
        self.choices.append(words)
        switches = [n for n in sorted(self.arguments) if given.get(n, "").lower() in ("true", "false")]
        for name, value in [("", ""), *itertools.product(switches, ("true", "false"))]:
            before, given[name] = given.get(name, ""), value
            starts = [self._is_started(node, context) for node, _, _ in self.made]
            self.choices.append([*itertools.compress(words, starts)])
            given[name] = before

    def _is_started(self, node: Any, context: Any) -> bool:
        """Return whether the conditions of a node, and of what it is in, hold; one that fails counts as if it did."""
        with contextlib.suppress(Exception):
            return all(condition.evaluate(context) for condition in self.conditions.get(id(node), ()))
        return True

    def _visit(self, entity: Any, context: Any) -> None:
        from launch.actions import ExecuteProcess, OpaqueCoroutine, RegisterEventHandler, TimerAction

        self._reach(entity, ())
        condition = getattr(entity, "condition", None)
        if not isinstance(entity, (ExecuteProcess, OpaqueCoroutine, RegisterEventHandler, TimerAction)):
            following = self.order.visit(entity, context)
            with self.order.within(entity, following, context):
                for child in following:
                    self._visit(child, context)
            return
        self.order.used()
        if condition is not None and not condition.evaluate(context):
            return
        if isinstance(entity, ExecuteProcess):
            self._start(entity, context)
        else:
            # Timers and event handlers are taken to fire.
            self.order.waits()
            self.waited_for.registered(entity)
            for child in _inside(entity):
                self._visit_later(child, context)

    def _visit_later(self, entity: Any, context: Any) -> None:
        """Visit what runs only when the file is loaded: what the machine lacks until then does not count."""
        was_later, self.is_later = self.is_later, True
        try:
            self._visit(entity, context)
        except Exception as problem:  # a launch file may raise anything
            if not _is_outside(problem):
                raise
            if lacks := _lacking(problem):
                self.later.append({"lacks": lacks, "line": self._line_of(problem)})
        self.is_later = was_later

    def _reach(self, entity: Any, conditions: tuple[Any, ...]) -> None:
        from launch.actions import DeclareLaunchArgument

        self.reached.add(id(entity))
        own = getattr(entity, "condition", None)
        conditions = self.conditions.setdefault(id(entity), conditions if own is None else (*conditions, own))
        if isinstance(entity, DeclareLaunchArgument):
            self.arguments[entity.name] = None
        for child in _inside(entity):
            self._reach(child, conditions)

    def _start(self, action: Any, context: Any) -> None:
        text = functools.partial(_text, context)
        known = next(((given, line) for node, given, line in self.made if node is action), None)
        given, line = known or ({}, None)  # a process that is not a node may be anything
        self.order.started(text(given.get("executable")), line)
        parameters = given.get("parameters") or []
        base = context.launch_configurations.get("ros_namespace") or ""
        own = text(given.get("namespace")) or ""
        scoped = context.launch_configurations.get("global_params", [])
        in_order: list[Any] = [
            dict([entry]) if isinstance(entry, tuple) else os.path.realpath(str(text(entry)))
            for entry in scoped
        ]
        in_order += parameters_in_order(parameters, context, text)
        renamed = [*context.launch_configurations.get("ros_remaps", []), *(given.get("remappings") or [])]
        is_whole = own.startswith("/") or not base
        self.nodes.append(
            {
                "package": text(given.get("package")),
                "executable": text(given.get("executable")),
                "name": text(given.get("name")),
                "namespace": own if is_whole else f"{base.rstrip('/')}/{own}".rstrip("/"),
                "remappings": [[text(part) for part in pair] for pair in renamed],
                "output": None if given.get("output") is None else str(given["output"]),
                "arguments": [text(word) for word in given.get("arguments") or []],
                "given": in_order,
                "by_argument": [],
                "is_wrapped": bool(given.get("prefix") or context.launch_configurations.get("launch-prefix")),
                "line": line,
                "file": os.path.realpath(getattr(context.locals, "current_launch_file_path", self.path)),
            }
        )

    @contextlib.contextmanager
    def _watched(self) -> Iterator[None]:
        """Note each node that is made, with its line, and each XML or YAML attribute that no action takes."""
        import launch
        import launch.event_handler
        import launch_xml
        import launch_yaml

        init = vars(self.node)["__init__"]
        init_of_all = vars(launch.Action)["__init__"]
        loading = self

        def line_here() -> int | None:
            frame: Any = sys._getframe(2)
            while frame is not None and frame.f_code.co_filename != loading.path:
                frame = frame.f_back
            return frame.f_lineno if frame else None

        def noted(node: Any, **given: Any) -> None:
            init(node, **given)
            loading.made.append((node, given, line_here()))

        def placed(action: Any, *given: Any, **named: Any) -> None:
            loading.lines[id(action)] = (action, line_here())
            init_of_all(action, *given, **named)

        def handled(handler: Any, *given: Any, **named: Any) -> None:
            loading.waited_for.made(handler, sys._getframe(1), line_here())
            init_of_handlers(handler, *given, **named)

        handlers = launch.event_handler.BaseEventHandler
        init_of_handlers = vars(handlers)["__init__"]
        kept = [(self.node, "__init__", init), (launch.Action, "__init__", init_of_all)]
        kept.append((handlers, "__init__", init_of_handlers))
        setattr(handlers, "__init__", handled)  # noqa: B010 -- likewise
        setattr(self.node, "__init__", noted)  # noqa: B010 -- a class that is only known here
        setattr(launch.Action, "__init__", placed)  # noqa: B010 -- likewise
        for entity in (launch_xml.Entity, launch_yaml.Entity):
            kept += [
                (entity, name, getattr(entity, name))
                for name in ("get_attr", "assert_entity_completely_parsed")
            ]
            self._collect(entity)
        try:
            yield
        finally:
            for owner, name, value in kept:
                setattr(owner, name, value)

    def _collect(self, entity: Any) -> None:
        get, check = entity.get_attr, entity.assert_entity_completely_parsed

        def get_attr(element: Any, name: str, **options: Any) -> Any:
            # In XML, what holds more is no attribute but an element of its own.
            if "launch_xml" not in entity.__module__ or "Entity" not in str(options.get("data_type")):
                self.asked.setdefault(element.type_name, set()).add(name)
            try:
                value = get(element, name, **options)
                if value is not None:
                    vars(element).setdefault("given", []).append(name)
                return value
            except AttributeError:
                if options.get("data_type", str) is not str:
                    raise
                self.faults.append({"tag": element.type_name, "missing": name})
                return "unknown"

        def checked(element: Any) -> None:
            try:
                check(element)
            except ValueError as error:
                names = re.findall(r"'([\w-]+)'", str(error).partition(": ")[2])
                known = sorted(self.asked.get(element.type_name, ()))
                given = vars(element).get("given", [])
                fault = {"tag": element.type_name, "unexpected": names, "known": known, "given": given}
                self.faults.append(fault)

        entity.get_attr, entity.assert_entity_completely_parsed = get_attr, checked


if __name__ == "__main__":
    main()
