"""Pictures show what is there, and say the same in words."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.qos import QoSProfile

from ros2lab.pictures import Tree, entry_point, node_graph, overlay_chain

SETUP = """
from setuptools import setup
setup(name="arm", entry_points={"console_scripts": ["wave = arm.gestures.wave:main", "wink=arm.wink:start"]})
"""


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a student's folder."""
    monkeypatch.setenv("ROS2LAB_WORK", str(tmp_path))
    return tmp_path


class TestTree:
    """A folder as lines."""

    def test_has_folders_first_and_arrows_for_links(self, work: Path) -> None:
        (work / "a_ws" / "src" / "deep" / "deeper").mkdir(parents=True)
        (work / "a_ws" / "a.txt").touch()
        (work / "a_ws" / ".hidden").touch()
        (work / "a_ws" / "src" / "link").symlink_to("deep")
        assert repr(Tree("~/a_ws", depth=2)).splitlines() == [
            "~/a_ws/",
            "├── src/",
            "│   ├── deep/",
            "│   └── link -> deep",
            "└── a.txt",
        ]

    def test_of_nothing_is_told(self, work: Path) -> None:
        with pytest.raises(NotADirectoryError, match="~/nowhere"):
            Tree("~/nowhere")


class TestOverlayChain:
    """The prefixes, one on top of the other."""

    def test_marks_the_package_that_runs(self, work: Path) -> None:
        prefixes = [work / "over_ws" / "install" / "arm", work / "under_ws" / "install" / "arm"]
        for prefix in prefixes:
            index = prefix / "share" / "ament_index" / "resource_index" / "packages"
            index.mkdir(parents=True)
            (index / "arm").touch()
        picture = overlay_chain({"AMENT_PREFIX_PATH": ":".join(map(str, prefixes))}, "arm")
        assert repr(picture).splitlines() == [
            "1. ~/over_ws/install/arm: arm, which runs",
            "2. ~/under_ws/install/arm: arm, hidden",
        ]
        bundle = picture._repr_mimebundle_()
        assert "p0 -- on top of --> p1" in bundle["text/vnd.mermaid"]
        assert bundle["text/plain"] == repr(picture)

    @pytest.mark.parametrize("environ", [{}, {"AMENT_PREFIX_PATH": ""}])
    def test_of_nothing(self, environ: dict[str, str]) -> None:
        assert repr(overlay_chain(environ)) == "nothing is sourced"


class TestEntryPoint:
    """An entry point taken apart."""

    def test_leads_to_the_line_of_the_function(self, work: Path) -> None:
        (work / "arm" / "arm" / "gestures").mkdir(parents=True)
        (work / "arm" / "setup.py").write_text(SETUP)
        (work / "arm" / "arm" / "gestures" / "wave.py").write_text("\n\ndef main():\n    pass\n")
        text = repr(entry_point("~/arm", "wave"))
        assert "arm.gestures.wave  (arm/gestures/wave.py)" in text
        assert "main  (def main, line 3)" in text
        assert "arm/wink.py is not there" in repr(entry_point("~/arm", "wink"))
        assert "no start in it" in repr(entry_point("~/arm", "wink"))

    def test_that_is_not_there_is_told(self, work: Path) -> None:
        (work / "setup.py").write_text(SETUP)
        with pytest.raises(LookupError, match="no entry point named jump"):
            entry_point("~", "jump")


def test_a_graph_shows_who_speaks_to_whom() -> None:
    """What every node has, and hidden nodes, are left out."""

    def ends(*names: str) -> list[Any]:
        return [end(name, "/") for name in names]

    def end(name: str, namespace: str) -> Any:
        return SimpleNamespace(
            node_name=name,
            node_namespace=namespace,
            topic_type="std_msgs/msg/String",
            qos_profile=QoSProfile(depth=1),
        )

    node = SimpleNamespace(
        get_node_names_and_namespaces=lambda: [("talker", "/"), ("listener", "/deep"), ("_ros2cli", "/")],
        get_topic_names_and_types=lambda: [("/news", ["std_msgs/msg/String"]), ("/rosout", ["x/msg/Log"])],
        get_publishers_info_by_topic=lambda _: ends("talker"),
        get_subscriptions_info_by_topic=lambda _: [
            end("listener", "/deep"),
            *ends("_ros2cli"),
        ],
    )
    picture = node_graph(node)
    assert repr(picture) == "/talker -> /news [std_msgs/msg/String] -> /deep/listener"
    assert "/rosout" not in picture.mermaid
