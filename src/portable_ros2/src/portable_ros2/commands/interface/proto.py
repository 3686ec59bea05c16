"""`ros2 interface proto`."""

from __future__ import annotations

import argparse

from portable_ros2.commands.interface._kinds import complete_types
from portable_ros2.verb import Verb


class ProtoVerb(Verb):
    """Output an interface prototype."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        name = parser.add_argument("type", help="Show an interface definition (e.g. 'std_msgs/msg/String')")
        name.completer = complete_types  # type: ignore[attr-defined]
        parser.add_argument("--no-quotes", action="store_true", help="if true output has no outer quotes.")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        from portable_ros2 import messages

        kind = args.type.split("/")[1:2]
        if kind == ["srv"]:
            prototype = messages.find_service(args.type).Request()
        elif kind == ["action"]:
            prototype = messages.find_action(args.type).Goal()
        else:
            prototype = messages.find_message(args.type)()
        text = messages.to_yaml(prototype)
        print(text if args.no_quotes else f'"{text}"')
        return None
