"""Quality of service as options on a command line, and chosen to fit the publishers that are there.

Source of the names: https://docs.ros.org/en/jazzy/Concepts/Intermediate/About-Quality-of-Service-Settings.html
"""

from __future__ import annotations

import argparse
import copy
from collections.abc import Sequence
from typing import Any

# rclpy knows these, but importing it takes longer than printing help may take.
PROFILES = (
    "unknown",
    "default",
    "system_default",
    "sensor_data",
    "services_default",
    "parameters",
    "parameter_events",
    "action_status_default",
    "best_available",
)
HISTORIES = ("system_default", "keep_last", "keep_all", "unknown")
RELIABILITIES = ("system_default", "reliable", "best_effort", "unknown", "best_available")
DURABILITIES = ("system_default", "transient_local", "volatile", "unknown", "best_available")
LIVELINESSES = ("system_default", "automatic", "manual_by_topic", "unknown", "best_available")

# So many messages may wait while Python is busy: 4 s of a topic with 1 kHz, where Jazzy's five are 5 ms.
ROOMY_DEPTH = 4000


def add_arguments(parser: argparse.ArgumentParser, purpose: str, default_profile: str) -> None:
    """Add the `--qos-...` options.

    Args:
        parser: gets the options.
        purpose: "publish" or "subscribe", for the help.
        default_profile: the short name of the profile that holds where no option says otherwise.
    """
    parser.add_argument(
        "--qos-profile",
        choices=PROFILES,
        default=default_profile,
        help=f"Quality of service preset profile to {purpose} with (default: {default_profile})",
    )
    parser.add_argument(
        "--qos-depth",
        metavar="N",
        type=int,
        help=f"Queue size to {purpose} with (instead of the profile's)",
    )
    for name, choices in {
        "history": HISTORIES,
        "reliability": RELIABILITIES,
        "durability": DURABILITIES,
        "liveliness": LIVELINESSES,
    }.items():
        parser.add_argument(
            f"--qos-{name}",
            choices=choices,
            help=f"{name.capitalize()} to {purpose} with (instead of the profile's)",
        )
    parser.add_argument(
        "--qos-liveliness-lease-duration-seconds",
        metavar="SECONDS",
        type=float,
        help=f"Liveliness lease duration to {purpose} with (instead of the profile's)",
    )


def profile(args: argparse.Namespace) -> Any:
    """Return the `QoSProfile` that the options of `add_arguments` ask for."""
    from rclpy import qos
    from rclpy.duration import Duration

    chosen = preset(args.qos_profile)
    if args.qos_history:
        chosen.history = qos.QoSHistoryPolicy.get_from_short_key(args.qos_history)
    if args.qos_reliability:
        chosen.reliability = qos.QoSReliabilityPolicy.get_from_short_key(args.qos_reliability)
    if args.qos_durability:
        chosen.durability = qos.QoSDurabilityPolicy.get_from_short_key(args.qos_durability)
    if args.qos_liveliness:
        chosen.liveliness = qos.QoSLivelinessPolicy.get_from_short_key(args.qos_liveliness)
    lease = args.qos_liveliness_lease_duration_seconds
    if lease is not None and lease > 0:
        chosen.liveliness_lease_duration = Duration(seconds=lease)
    if args.qos_depth is not None and args.qos_depth > 0:
        chosen.depth = args.qos_depth
    elif chosen.durability == qos.QoSDurabilityPolicy.TRANSIENT_LOCAL and chosen.depth == 0:
        chosen.depth = 1
    return chosen


def preset(name: str) -> Any:
    """Return a copy of a preset `QoSProfile`, which can be changed."""
    from rclpy.qos import QoSPresetProfiles

    return copy.copy(QoSPresetProfiles.get_from_short_key(name))


def profile_for(publishers: Sequence[Any], args: argparse.Namespace) -> tuple[Any, list[str]]:
    """Return the `QoSProfile` to subscribe with, and what is to be told about it.

    Any option but the profile is taken at its word. Otherwise reliability and durability are the strictest that
    all the publishers offer, so that each of them is heard.

    Args:
        publishers: what rclpy's `get_publishers_info_by_topic` gave.
        args: what the options of `add_arguments` have become.
    """
    chosen = profile(args)
    return chosen, [] if not publishers or _has_options(args) else fit(chosen, publishers)


def fit(chosen: Any, publishers: Sequence[Any]) -> list[str]:
    """Make reliability and durability of a `QoSProfile` the strictest that all publishers offer.

    Returns:
        What is to be told about it.
    """
    from rclpy.qos import QoSDurabilityPolicy, QoSReliabilityPolicy

    notes = []
    for name, strict, lenient in (
        ("reliability", QoSReliabilityPolicy.RELIABLE, QoSReliabilityPolicy.BEST_EFFORT),
        ("durability", QoSDurabilityPolicy.TRANSIENT_LOCAL, QoSDurabilityPolicy.VOLATILE),
    ):
        are_strict = [getattr(publisher.qos_profile, name) == strict for publisher in publishers]
        setattr(chosen, name, strict if all(are_strict) else lenient)
        if any(are_strict) and not all(are_strict):
            kind = f"QoS{name.capitalize()}Policy"
            notes.append(
                f"Some, but not all, publishers are offering {kind}.{strict.name}. "
                f"Falling back to {kind}.{lenient.name} as it will connect to all publishers"
            )
    return notes


def with_room(chosen: Any, args: argparse.Namespace | None = None) -> Any:
    """Return a profile to subscribe with that keeps what arrives while Python is busy.

    A depth that was asked for stays, and so does that of a subscription to what was published earlier, where
    the depth decides how much of that is shown.
    """
    from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy

    roomy = copy.copy(chosen)
    keeps_last = roomy.history == QoSHistoryPolicy.KEEP_LAST
    if (
        keeps_last
        and roomy.durability == QoSDurabilityPolicy.VOLATILE
        and getattr(args, "qos_depth", None) is None
    ):
        roomy.depth = max(roomy.depth, ROOMY_DEPTH)
    return roomy


def _has_options(args: argparse.Namespace) -> bool:
    return any(
        value is not None
        for name, value in vars(args).items()
        if name.startswith("qos_") and name != "qos_profile"
    )
