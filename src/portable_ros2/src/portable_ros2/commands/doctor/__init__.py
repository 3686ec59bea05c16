"""`ros2 doctor`."""

from __future__ import annotations

import argparse
import os
import platform
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from portable_ros2 import __version__, ament_index, graph
from portable_ros2.verb import Verb

LARGEST_DOMAIN = 232
RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
HIDDEN_TOPICS = ("/rosout", "/parameter_events")


@dataclass
class Diagnosis:
    """What was found.

    Attributes:
        sections: rows of name and value, by title.
        errors: what keeps nodes from starting or from meeting, a sentence each.
        warnings: what may surprise.
    """

    sections: dict[str, list[tuple[str, str]]] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


class DoctorCommand(Verb):
    """Check ROS setup and other potential issues."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        report = parser.add_mutually_exclusive_group()
        report.add_argument("--report", "-r", action="store_true", help="Print all reports.")
        report.add_argument(
            "--report-failed", "-rf", action="store_true", help="Print reports of failed checks only."
        )
        parser.add_argument(
            "--exclude-packages", "-ep", action="store_true", help="Accepted; no package is asked about."
        )
        parser.add_argument(
            "--include-warnings", "-iw", action="store_true", help="Include warnings as failed checks."
        )

    def main(self, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:
        diagnosis = Diagnosis()
        _look_at_settings(diagnosis)
        if not diagnosis.errors:  # with one of them rclpy would end this process
            _look_at_graph(diagnosis, args)
        for kind, texts in (("Error", diagnosis.errors), ("Warning", diagnosis.warnings)):
            for text in texts:
                print(f"{kind}: {text}", file=sys.stderr)
        failed = len(diagnosis.errors) + (len(diagnosis.warnings) if args.include_warnings else 0)
        if args.report or (args.report_failed and failed):
            for title, rows in diagnosis.sections.items():
                _print_section(title, rows)
            return 0
        print(f"\n{failed} check(s) failed\n" if failed else "\nAll checks passed\n")
        return 1 if failed else 0


def _look_at_settings(diagnosis: Diagnosis) -> None:
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not domain.isdecimal() or int(domain) > LARGEST_DOMAIN:
        diagnosis.errors.append(
            f"ROS_DOMAIN_ID={domain} is no number from 0 to {LARGEST_DOMAIN}: unset ROS_DOMAIN_ID."
        )
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET"
    if reach not in RANGES:
        diagnosis.warnings.append(
            f"ROS_AUTOMATIC_DISCOVERY_RANGE={reach} is none of {', '.join(RANGES)}: unset it."
        )
    if reach == "OFF":
        diagnosis.warnings.append("ROS_AUTOMATIC_DISCOVERY_RANGE=OFF: no node finds another one.")
    middleware = os.environ.get("RMW_IMPLEMENTATION")
    prefixes = ament_index.prefixes()
    if middleware and not any((prefix / "lib" / f"lib{middleware}.so").exists() for prefix in prefixes):
        diagnosis.errors.append(
            f"RMW_IMPLEMENTATION={middleware} is not installed, so every node ends at once: "
            "unset RMW_IMPLEMENTATION."
        )
    workspaces = [str(prefix) for prefix in prefixes if str(prefix) != sys.prefix]
    diagnosis.sections |= {
        "PLATFORM INFORMATION": [
            ("system", platform.system()),
            ("platform info", platform.platform()),
            ("python", f"{platform.python_version()} at {sys.executable}"),
        ],
        "ROS 2 INFORMATION": [
            ("ros2 command", f"portable_ros2 {__version__}, an own implementation for ROS 2 Jazzy"),
            ("packages", str(len(ament_index.resources(ament_index.PACKAGES)))),
            ("sourced", ", ".join(workspaces) or "no workspace"),
            ("domain id", domain),
            ("discovery range", reach),
        ],
        "ENVIRONMENT": [
            (name, value) for name, value in sorted(os.environ.items()) if name.startswith("ROS_")
        ],
    }


def _look_at_graph(diagnosis: Diagnosis, args: argparse.Namespace) -> None:
    import rclpy

    with graph.GraphNode(args) as node:
        diagnosis.sections["RMW MIDDLEWARE"] = [
            ("middleware name", rclpy.get_rmw_implementation_identifier())
        ]
        names = sorted(
            f"{namespace.rstrip('/')}/{name}"
            for name, namespace in node.get_node_names_and_namespaces()
            if not name.startswith("_")
        )
        topics = [name for name, _ in node.get_topic_names_and_types() if name not in HIDDEN_TOPICS]
        rows: list[tuple[str, str]] = []
        pairs: list[tuple[str, str]] = []
        for topic in sorted(topics):
            publishers = node.get_publishers_info_by_topic(topic)
            subscribers = node.get_subscriptions_info_by_topic(topic)
            rows += [
                ("topic", topic),
                ("publisher count", str(len(publishers))),
                ("subscriber count", str(len(subscribers))),
            ]
            if publishers and not subscribers:
                diagnosis.warnings.append(f"Publisher without subscriber detected on {topic}.")
            if subscribers and not publishers:
                diagnosis.warnings.append(f"Subscriber without publisher detected on {topic}.")
            pairs += _pairs(topic, publishers, subscribers, diagnosis)
    diagnosis.sections |= {
        "NODE LIST": [("node", name) for name in names] or [("node", "none")],
        "QOS COMPATIBILITY LIST": pairs or [("compatibility status", "No publisher/subscriber pairs found")],
        "TOPIC LIST": rows or [("topic", "none")],
    }


def _pairs(
    topic: str, publishers: list[Any], subscribers: list[Any], diagnosis: Diagnosis
) -> Iterator[tuple[str, str]]:
    """Yield rows about each publisher and subscriber of a topic; those that do not fit are an error."""
    from rclpy.qos import QoSCompatibility, qos_check_compatible

    for publisher in publishers:
        for subscriber in subscribers:
            compatibility, reason = qos_check_compatible(publisher.qos_profile, subscriber.qos_profile)
            reason = re.sub(r"^(error|warning): ", "", reason.strip(), flags=re.IGNORECASE)
            if publisher.topic_type != subscriber.topic_type:
                compatibility = QoSCompatibility.ERROR
                reason = f"the types {publisher.topic_type} and {subscriber.topic_type} differ"
            if compatibility != QoSCompatibility.OK:
                kind = "error" if compatibility == QoSCompatibility.ERROR else "warning"
                found = diagnosis.errors if kind == "error" else diagnosis.warnings
                pair = f"{publisher.node_name} -> {subscriber.node_name}"
                found.append(f"QoS compatibility {kind} found on topic '{topic}' ({pair}): {reason}")
            yield "topic [type]", f"{topic} [{publisher.topic_type}]"
            yield "publisher node", publisher.node_name
            yield "subscriber node", subscriber.node_name
            yield "compatibility status", reason or "OK"


def _print_section(title: str, rows: list[tuple[str, str]]) -> None:
    width = max((len(name) for name, _ in rows), default=0)
    print(f"\n   {title}")
    for name, value in rows:
        print(f"{name.ljust(width)} : {value}")
