"""The quality of service of recorded topics: as rosbag2 writes it, and for a replay."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from portable_ros2 import bounded_yaml

REPLAYED_DEPTH = 5000  # messages that may wait to be sent
KEPT_DEPTH = 10  # messages that a replayed transient-local topic keeps for late-joining subscribers


def qos_text(profiles: Sequence[QoSProfile]) -> str:
    """Write qualities of service as rosbag2 does in Jazzy."""
    return str(
        yaml.safe_dump(
            [
                {
                    "history": profile.history.name.lower(),
                    "depth": profile.depth,
                    "reliability": profile.reliability.name.lower(),
                    "durability": profile.durability.name.lower(),
                    "deadline": _duration(profile.deadline),
                    "lifespan": _duration(profile.lifespan),
                    "liveliness": profile.liveliness.name.lower(),
                    "liveliness_lease_duration": _duration(profile.liveliness_lease_duration),
                    "avoid_ros_namespace_conventions": profile.avoid_ros_namespace_conventions,
                }
                for profile in profiles
            ],
            sort_keys=False,
        )
    )


def replayed_qos(offered: str) -> QoSProfile:
    """Return a quality of service that serves every subscriber that one of the recorded publishers served.

    Args:
        offered: the recorded offers as YAML, in the words of Jazzy or the numbers of earlier versions.
    """
    try:
        offers = bounded_yaml.load(offered, yaml.SafeLoader, has_aliases=False) or []
        profiles = [profile for profile in offers if isinstance(profile, dict)]
    except (yaml.YAMLError, ValueError, TypeError):  # a ValueError: there is no 31st of February
        profiles = []
    reliabilities = {_policy(ReliabilityPolicy, profile.get("reliability")) for profile in profiles}
    durabilities = {_policy(DurabilityPolicy, profile.get("durability")) for profile in profiles}
    is_lossy = reliabilities == {ReliabilityPolicy.BEST_EFFORT}
    is_kept = DurabilityPolicy.TRANSIENT_LOCAL in durabilities
    depths = [depth for profile in profiles if isinstance(depth := profile.get("depth"), int) and depth > 0]
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        # How many a publisher keeps is not told to others: rosbag2 records 0 for it.
        depth=min(max(depths, default=0), REPLAYED_DEPTH) or KEPT_DEPTH if is_kept else REPLAYED_DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if is_lossy else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if is_kept else DurabilityPolicy.VOLATILE,
    )


def _policy(policies: Any, value: object) -> Any:
    """Return the policy of a recorded word or number, None if there is none."""
    if isinstance(value, int):
        return next((policy for policy in policies if policy.value == value), None)
    return policies.__members__.get(str(value).upper())


def _duration(duration: Duration) -> dict[str, int]:
    seconds, nanoseconds = divmod(duration.nanoseconds, 10**9)
    return {"sec": seconds, "nsec": nanoseconds}
