# PYTHON_ARGCOMPLETE_OK
"""The `ros2` command: finds the verb that is asked for, and loads only that."""

from __future__ import annotations

import signal

# Ctrl-C ends the command without a traceback while what follows is imported.
_interrupt = signal.signal(signal.SIGINT, signal.SIG_DFL)

import argparse
import importlib
import inspect
import io
import os
import pkgutil
import sys
import warnings
from collections.abc import Sequence
from types import ModuleType
from typing import Any, TextIO

from portable_ros2 import __version__, commands
from portable_ros2.arguments import Parser
from portable_ros2.stepping_aside import step_aside
from portable_ros2.verb import Verb, summary

signal.signal(signal.SIGINT, _interrupt)

BROKEN_PIPE = 128 + signal.SIGPIPE  # what a shell reports of a program that a closed pipe has ended
VERSION = f"portable_ros2 {__version__} (an own implementation for ROS 2 Jazzy, not the ros2 of ros2cli)"

# What would move the cursor, rename the window or turn the direction of writing, as Python writes it.
_CODES = (*range(0x09), *range(0x0B, 0x20), *range(0x7F, 0xA0), 0x61C, 0x200E, 0x200F, *range(0x202A, 0x202F))
SIGNS = {code: ascii(chr(code))[1:-1] for code in (*_CODES, *range(0x2066, 0x206A))}


class _Terminal:
    """A terminal that gets no codes: messages, parameters and names of others may hold them."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(text.translate(SIGNS))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def main(argv: Sequence[str] | None = None) -> int | str | None:
    """Run a command line (without the program's name; `sys.argv` if None); return the exit code or a text."""
    if argv is None:
        step_aside(sys.argv[1:])
    if "_ARGCOMPLETE" in os.environ:
        _complete()
    result = _outcome(sys.argv[1:] if argv is None else argv)
    participants = sys.modules.get("portable_ros2.participants")
    if argv is None and participants and not participants.shares_memory():
        _leave(result)
    return result


def _outcome(words: Sequence[str]) -> int | str | None:
    """Run a command line; return the exit code or a text, also where it was ended by something else."""
    try:
        try:
            return _run(words)
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except KeyboardInterrupt:
        warnings.simplefilter("ignore")  # Python would tell of the coroutine that rclpy had just made
        return int(signal.SIGINT)
    except BrokenPipeError:
        _discard_output()
        return BROKEN_PIPE
    except OSError as error:  # such as a full disk
        _discard_output()
        return str(error)


def parser_of(words: Sequence[str] | None) -> argparse.ArgumentParser:
    """Return the parser that understands a command line; only what this names is loaded in full.

    Args:
        words: the command line without the program's name; None loads everything.
    """
    parser = Parser(prog="ros2", description="ros2 is an extensible command-line tool for ROS 2.")
    parser.add_argument("--version", action="version", version=VERSION)
    parser.add_argument(
        "--use-python-default-buffering",
        action="store_true",
        help="Do not force line buffering in stdout and instead use the python default buffering",
    )
    named = [word for word in words or () if not word.startswith("-")]
    _add_subparsers(parser, "ros2", commands, None if words is None else named)
    return parser


def _run(words: Sequence[str]) -> int | str | None:
    for stream in sys.stdout, sys.stderr:
        if isinstance(
            stream, io.TextIOWrapper
        ):  # a letter that its encoding has not is written as Python does
            stream.reconfigure(errors="backslashreplace")
    parser = parser_of(words)
    args = parser.parse_args(words)
    if not args.use_python_default_buffering and sys.stdout is not None:
        sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]
    verb = getattr(args, "verb_object", None)
    if verb is None:
        args.shown_parser.print_help()
        return 0
    unreadable = next((word for word in words if not _is_text(word)), None)
    if unreadable is not None and not verb.takes_bytes:
        encoding = sys.getfilesystemencoding().upper()
        return f"The argument {unreadable!r} cannot be read as text in {encoding}, the encoding of this terminal."
    for name in () if verb.passes_on(args) else ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is not None and stream.isatty():
            setattr(sys, name, _Terminal(stream))
    try:
        result: int | str | None = verb.main(args.shown_parser, args)
    except RuntimeError as error:
        return str(error)
    return result


def _is_text(word: str) -> bool:
    """Return whether a word of the command line could be read; Python keeps each byte that could not by itself."""
    return not any(0xD800 <= ord(letter) <= 0xDFFF for letter in word)


def _leave(result: int | str | None) -> None:
    """End this process as `sys.exit` does, but at once: after its last participant Fast DDS sleeps for 0.1 s."""
    if isinstance(result, str):
        print(result, file=sys.stderr)
        result = 1
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    os._exit(result or 0)


def _discard_output() -> None:
    """Let what is still to be written at the exit go nowhere, where it would fail again."""
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _complete() -> None:
    import argcomplete

    line = os.environ.get("COMP_LINE", "")[: int(os.environ.get("COMP_POINT") or 0)]
    argcomplete.autocomplete(parser_of(line.split()[1:]), exclude=["-h", "--help"], validator=_is_offered)


def _is_offered(word: str, typed: str) -> bool:
    """Return whether a word goes on as was typed, and a shell that shows it gives the terminal no codes."""
    return word.startswith(typed) and word.isprintable()


def _add_subparsers(
    parser: argparse.ArgumentParser, prog: str, package: ModuleType, named: list[str] | None
) -> None:
    """Add the modules of a package as sub-commands; those that are not named get no arguments."""
    parser.set_defaults(shown_parser=parser)
    if hasattr(package, "add_arguments"):
        package.add_arguments(parser)  # options that stand before the verb
    names = sorted(module.name for module in pkgutil.iter_modules(package.__path__) if module.name[0] != "_")
    first = named[0] if named else ""
    # A word that is no sub-command is told what there is, like no word at all.
    loaded = [first] if first in names else names
    modules = {name: importlib.import_module(f"{package.__name__}.{name}") for name in loaded}
    texts = {name: summary(_verb_class(module) or module) for name, module in modules.items()}
    width = max(map(len, names), default=0)
    subparsers = parser.add_subparsers(
        title="Commands",
        description="\n".join(f"{name.ljust(width)}  {text}" for name, text in texts.items()),
        metavar=f"Call `{prog} <command> -h` for more detailed usage.",
    )
    for name in names:
        command = subparsers.add_parser(name, description=texts.get(name), prog=f"{prog} {name}")
        command.set_defaults(shown_parser=command)
        if named is None or name == first:
            _fill(command, f"{prog} {name}", modules[name], named and named[1:])


def _fill(parser: argparse.ArgumentParser, prog: str, module: ModuleType, named: list[str] | None) -> None:
    verb_class = _verb_class(module)
    if verb_class is not None:
        verb = verb_class()
        verb.add_arguments(parser)
        parser.set_defaults(verb_object=verb)
    if hasattr(module, "__path__"):
        _add_subparsers(parser, prog, module, named)


def _verb_class(module: ModuleType) -> type[Verb] | None:
    """Return the verb that a module defines; a package of verbs may define what it does without one."""
    defined = (value for value in vars(module).values() if inspect.isclass(value) and issubclass(value, Verb))
    return next((value for value in defined if value.__module__ == module.__name__), None)


if __name__ == "__main__":
    sys.exit(main())
