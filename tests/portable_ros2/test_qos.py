"""Quality of service: what the options mean, and which one fits the publishers."""

from __future__ import annotations

import argparse
from types import SimpleNamespace

import pytest
from rclpy import qos as ros
from rclpy.duration import Duration

from portable_ros2 import qos

RELIABLE, BEST_EFFORT = ros.QoSReliabilityPolicy.RELIABLE, ros.QoSReliabilityPolicy.BEST_EFFORT
KEPT, VOLATILE = ros.QoSDurabilityPolicy.TRANSIENT_LOCAL, ros.QoSDurabilityPolicy.VOLATILE


def parsed(*words: str, default: str = "sensor_data") -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    qos.add_arguments(parser, "subscribe", default)
    return parser.parse_args(words)


def publisher(reliability: object, durability: object = VOLATILE) -> SimpleNamespace:
    return SimpleNamespace(qos_profile=SimpleNamespace(reliability=reliability, durability=durability))


def test_the_names_are_those_that_rclpy_knows() -> None:
    assert list(qos.PROFILES) == ros.QoSPresetProfiles.short_keys()
    assert list(qos.HISTORIES) == ros.QoSHistoryPolicy.short_keys()
    assert list(qos.RELIABILITIES) == ros.QoSReliabilityPolicy.short_keys()
    assert list(qos.DURABILITIES) == ros.QoSDurabilityPolicy.short_keys()
    assert list(qos.LIVELINESSES) == ros.QoSLivelinessPolicy.short_keys()


def test_without_options_it_is_the_profile() -> None:
    assert qos.profile(parsed(default="default")) == ros.QoSPresetProfiles.DEFAULT.value
    assert qos.profile(parsed("--qos-profile", "parameters")) == ros.QoSPresetProfiles.PARAMETERS.value


def test_each_option_changes_its_part_of_the_profile_and_never_the_preset() -> None:
    before = str(ros.QoSPresetProfiles.SENSOR_DATA.value)
    words = "--qos-history keep_all --qos-reliability reliable --qos-durability transient_local --qos-depth 3"
    more = "--qos-liveliness manual_by_topic --qos-liveliness-lease-duration-seconds 1.5"
    chosen = qos.profile(parsed(*words.split(), *more.split()))
    assert chosen.history == ros.QoSHistoryPolicy.KEEP_ALL
    assert (chosen.reliability, chosen.durability, chosen.depth) == (RELIABLE, KEPT, 3)
    assert chosen.liveliness == ros.QoSLivelinessPolicy.MANUAL_BY_TOPIC
    assert chosen.liveliness_lease_duration == Duration(seconds=1.5)
    assert str(ros.QoSPresetProfiles.SENSOR_DATA.value) == before


def test_what_is_kept_for_late_comers_needs_a_depth() -> None:
    words = ("--qos-profile", "system_default", "--qos-durability", "transient_local")
    assert qos.profile(parsed(*words)).depth == 1
    assert qos.profile(parsed(*words, "--qos-depth", "4")).depth == 4


@pytest.mark.parametrize("depth", ["0", "-1"])
def test_a_depth_that_cannot_be_leaves_the_profiles(depth: str) -> None:
    assert qos.profile(parsed(f"--qos-depth={depth}")).depth == 5


@pytest.mark.parametrize(
    "words",
    [
        ("--qos-profile", "fast"),
        ("--qos-reliability", "sure"),
        ("--qos-durability", ""),
        ("--qos-history", "keep"),
        ("--qos-liveliness", "alive"),
        ("--qos-depth", "many"),
        ("--qos-liveliness-lease-duration-seconds", "long"),
    ],
)
def test_other_values_are_a_wrong_command_line(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as caught:
        parsed(*words)
    assert caught.value.code == 2
    assert words[0] in capsys.readouterr().err


@pytest.mark.parametrize(
    ("publishers", "reliability", "durability", "noted"),
    [
        ([], BEST_EFFORT, VOLATILE, []),
        ([publisher(RELIABLE)], RELIABLE, VOLATILE, []),
        ([publisher(BEST_EFFORT)], BEST_EFFORT, VOLATILE, []),
        ([publisher(RELIABLE, KEPT)], RELIABLE, KEPT, []),
        ([publisher(RELIABLE)] * 2, RELIABLE, VOLATILE, []),
        ([publisher(RELIABLE), publisher(BEST_EFFORT)], BEST_EFFORT, VOLATILE, ["Reliability"]),
        ([publisher(RELIABLE, KEPT), publisher(RELIABLE)], RELIABLE, VOLATILE, ["Durability"]),
        (
            [publisher(RELIABLE, KEPT), publisher(BEST_EFFORT)],
            BEST_EFFORT,
            VOLATILE,
            ["Reliability", "Durability"],
        ),
    ],
)
def test_all_publishers_are_heard(
    publishers: list[SimpleNamespace], reliability: object, durability: object, noted: list[str]
) -> None:
    chosen, notes = qos.profile_for(publishers, parsed())
    assert (chosen.reliability, chosen.durability) == (reliability, durability)
    assert len(notes) == len(noted)
    assert all(f"QoS{name}Policy" in note for name, note in zip(noted, notes, strict=True))


@pytest.mark.parametrize(
    "option", ["--qos-depth=7", "--qos-reliability=best_effort", "--qos-history=keep_last"]
)
def test_an_option_is_taken_at_its_word(option: str) -> None:
    chosen, notes = qos.profile_for([publisher(RELIABLE, KEPT)], parsed(option))
    assert (chosen.reliability, chosen.durability, notes) == (BEST_EFFORT, VOLATILE, [])


def test_the_profile_alone_is_still_fitted() -> None:
    chosen, _ = qos.profile_for([publisher(RELIABLE, KEPT)], parsed("--qos-profile", "parameters"))
    assert (chosen.reliability, chosen.durability, chosen.depth) == (RELIABLE, KEPT, 1000)


def test_room_is_made_for_what_arrives_while_python_is_busy() -> None:
    preset = qos.preset("sensor_data")
    assert qos.with_room(preset).depth == qos.ROOMY_DEPTH
    assert preset.depth == 5


@pytest.mark.parametrize(
    ("words", "depth"),
    [
        (("--qos-depth", "7"), 7),
        (("--qos-durability", "transient_local"), 5),
        (("--qos-history", "keep_all"), 5),
        (("--qos-reliability", "reliable"), qos.ROOMY_DEPTH),
    ],
)
def test_no_room_is_made_where_the_depth_means_something(words: tuple[str, ...], depth: int) -> None:
    args = parsed(*words)
    assert qos.with_room(qos.profile(args), args).depth == depth
