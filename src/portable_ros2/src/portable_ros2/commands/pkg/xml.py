"""`ros2 pkg xml`."""

from __future__ import annotations

import argparse

from portable_ros2 import ament_index, completion
from portable_ros2.verb import Verb


class XmlVerb(Verb):
    """Output the XML of the package manifest or a specific tag."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        package = parser.add_argument("package_name", help="The package name")
        package.completer = completion.packages  # type: ignore[attr-defined]
        parser.add_argument("-t", "--tag", help="The XML tag to output (e.g. 'version')")

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> str | None:
        from xml.etree import ElementTree

        try:
            path = ament_index.share_folder(args.package_name) / "package.xml"
        except ament_index.PackageNotFoundError:
            return "Package not found"
        if not path.is_file():
            return "Package XML manifest not found"
        try:
            root = ElementTree.parse(path).getroot()  # noqa: S314 -- a manifest that has been installed
        except ElementTree.ParseError as error:
            return f"{path} is not valid XML: {error}"
        if args.tag is None:
            print(ElementTree.tostring(root, encoding="unicode"))
            return None
        try:
            elements = root.findall(args.tag)
        except (SyntaxError, TypeError, KeyError):  # neither a tag nor a path of tags
            elements = []
        if not elements:
            return "XML tag not found"
        for element in elements:
            print(element.text)
        return None
