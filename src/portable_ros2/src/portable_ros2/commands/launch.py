"""`ros2 launch`.

It uses whichever `launch` Python finds, the real one or the one beside this package, and of it only what both have.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from portable_ros2 import ament_index, completion
from portable_ros2.verb import Verb

if TYPE_CHECKING:
    from launch import LaunchDescription

# How the names of launch files end, as far as completion knows.
ENDS = ("launch.py", ".launch", ".xml", ".yaml", ".yml")


class LaunchVerb(Verb):
    """Run a launch file."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        parser.add_argument(
            "-n",
            "--noninteractive",
            action="store_true",
            default=not (sys.stdin and sys.stdin.isatty()),
            help="Run the launch system non-interactively, with no terminal associated",
        )
        parser.add_argument("-d", "--debug", action="store_true", help="Write more of what is done")
        shown = parser.add_mutually_exclusive_group()
        shown.add_argument(
            "-p",
            "--print",
            "--print-description",
            action="store_true",
            help="Print the launch description instead of launching it",
        )
        shown.add_argument(
            "-s",
            "--show-args",
            "--show-arguments",
            action="store_true",
            help="Show the arguments that the launch file takes instead of launching it",
        )
        parser.add_argument(
            "-a",
            "--show-all-subprocesses-output",
            action="store_true",
            help="Show what all processes write, whatever the launch file says",
        )
        parser.add_argument(
            "--launch-prefix",
            help="Command that is put before all executables, e.g. --launch-prefix 'xterm -e gdb -ex run --args'",
        )
        parser.add_argument(
            "--launch-prefix-filter",
            help="Regular expression: the prefix is put only before executables with such names",
        )
        package = parser.add_argument(
            "package_name", help="Package that has the launch file, or the file's path"
        )
        package.completer = _complete_packages  # type: ignore[attr-defined]
        file = parser.add_argument("launch_file_name", nargs="?", help="Name of the launch file")
        file.completer = _complete_files  # type: ignore[attr-defined]
        arguments = parser.add_argument(
            "launch_arguments",
            nargs="*",
            help="Arguments of the launch file: <name>:=<value>; of the same name, the last one counts",
        )
        arguments.completer = _complete_arguments  # type: ignore[attr-defined]

    def passes_on(self, args: argparse.Namespace) -> bool:
        return not (args.print or args.show_args)

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int | str | None:
        path, given = _file_and_arguments(args)
        if args.launch_prefix is None and args.launch_prefix_filter is not None:
            return "--launch-prefix must be specified if --launch-prefix-filter is provided"
        if args.show_all_subprocesses_output:
            os.environ["OVERRIDE_LAUNCH_PROCESS_OUTPUT"] = "both"
        if args.print:
            _print_description(path)
            return None
        if args.show_args:
            _show_arguments(path)
            return None
        if args.launch_prefix:
            given.append(f"launch-prefix:={args.launch_prefix}")
        if args.launch_prefix_filter:
            given.append(f"launch-prefix-filter:={args.launch_prefix_filter}")
        return _launch(path, given, noninteractive=args.noninteractive, debug=args.debug)


def _launch(path: Path, given: list[str], *, noninteractive: bool, debug: bool) -> int:
    arguments = _parsed(given)
    from launch import LaunchDescription, LaunchService
    from launch.actions import IncludeLaunchDescription
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    service = LaunchService(argv=given, noninteractive=noninteractive, debug=debug)
    source = AnyLaunchDescriptionSource(str(path))
    include = IncludeLaunchDescription(source, launch_arguments=arguments.items())
    service.include_launch_description(LaunchDescription([include]))
    return service.run()


def _print_description(path: Path) -> None:
    description = _read(path)
    from launch import LaunchIntrospector

    print(LaunchIntrospector().format_launch_description(description))


def _show_arguments(path: Path) -> None:
    arguments = _read(path).get_launch_arguments()
    print("Arguments (pass arguments as '<name>:=<value>'):")
    for argument in arguments:
        print(f"\n    '{argument.name}':{'*' if argument._conditionally_included else ''}")
        print(f"        {argument.description}")
        if argument.default_value is not None:
            print(f"        (default: {' + '.join(part.describe() for part in argument.default_value)})")
    if not arguments:
        print("\n  No arguments.")
    elif any(argument._conditionally_included for argument in arguments):
        print("\n* argument(s) which are only used if specific conditions occur")


def _read(path: Path) -> LaunchDescription:
    from launch.launch_description_sources import get_launch_description_from_any_launch_file

    try:
        return get_launch_description_from_any_launch_file(str(path))
    except (Exception, SystemExit) as error:  # a launch file may raise anything
        raise RuntimeError(str(error)) from error


def _file_and_arguments(args: argparse.Namespace) -> tuple[Path, list[str]]:
    """Return the launch file, and the arguments for it: the second word is one if the first is a file."""
    first, second = args.package_name, args.launch_file_name
    if Path(first).is_file():
        return Path(first), [*([second] if second is not None else []), *args.launch_arguments]
    if "/" in first or first.endswith(ENDS):
        raise RuntimeError(f"There is no launch file '{first}'.")
    try:
        share = ament_index.share_folder(first)
    except ament_index.PackageNotFoundError:
        searched = [str(prefix) for prefix in ament_index.prefixes()]
        raise RuntimeError(
            f"Package '{first}' not found: \"package '{first}' not found, searching: {searched}\""
        ) from None
    return _found(first, share, second), list(args.launch_arguments)


def _found(package: str, share: Path, name: str | None) -> Path:
    if name is None:
        names = ", ".join(sorted(path.name for path in _launch_files(share))) or "none"
        raise RuntimeError(f"Name the launch file of package '{package}' too; there are: {names}.")
    paths = sorted(path for path in _files(share) if path.name == name)
    if not paths:
        raise RuntimeError(
            f"file '{name}' was not found in the share directory of package '{package}' which is at '{share}'"
        )
    if len(paths) > 1:
        listed = ", ".join(f"'{path}'" for path in paths)
        raise RuntimeError(
            f"file '{name}' was found more than once in the share directory of package '{package}': [{listed}]"
        )
    return paths[0]


def _parsed(given: list[str]) -> dict[str, str]:
    arguments = {}
    for argument in given:
        name, separator, value = argument.partition(":=")
        if not name or not separator or not value:
            raise RuntimeError(f"malformed launch argument '{argument}', expected format '<name>:=<value>'")
        arguments[name] = value
    return arguments


def _files(folder: Path) -> list[Path]:
    """Return the files below a folder; colcon's links to files count, too."""
    return [Path(root, name) for root, _, names in os.walk(folder) for name in names]


def _launch_files(folder: Path) -> list[Path]:
    return [path for path in _files(folder) if path.name.endswith(ENDS) and path.name != "package.xml"]


def _complete_packages(prefix: str, **_: Any) -> list[str]:
    folder, _slash, name = prefix.rpartition("/")
    paths = [
        path for path in Path(folder or ("/" if _slash else ".")).glob(f"{name}*") if path.name[0] != "."
    ]
    before = folder + _slash
    found = [f"{before}{path.name}/" for path in paths if path.is_dir()]
    found += [f"{before}{path.name}" for path in paths if path.is_file() and path.name.endswith(ENDS)]
    return [*completion.packages(), *found]


def _complete_files(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    if Path(parsed_args.package_name).is_file():
        return _complete_arguments(parsed_args)
    try:
        return [path.name for path in _launch_files(ament_index.share_folder(parsed_args.package_name))]
    except ament_index.PackageNotFoundError:
        return []


def _complete_arguments(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    try:
        path, _arguments = _file_and_arguments(parsed_args)
        return [f"{name}:=" for name in dict.fromkeys(_declared(path)) if isinstance(name, str)]
    except Exception:
        return []


def _declared(path: Path) -> Iterator[object]:
    """Yield the names of arguments that a launch file declares, as its text shows them: a key that asks runs nothing."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        import ast

        for call in ast.walk(ast.parse(text)):
            if isinstance(call, ast.Call) and ast.unparse(call.func).endswith("DeclareLaunchArgument"):
                given = [*call.args[:1], *(word.value for word in call.keywords if word.arg == "name")]
                yield from (value.value for value in given if isinstance(value, ast.Constant))
    elif path.suffix in (".yaml", ".yml"):
        import yaml

        yield from (entry["arg"]["name"] for entry in yaml.safe_load(text)["launch"] if "arg" in entry)
    else:
        from xml.etree import ElementTree

        yield from (entry.get("name") for entry in ElementTree.fromstring(text).findall("arg"))  # noqa: S314 -- Expat bounds it
