"""Names in a README count where there are words, in whatever language, or where they stand in a command."""

from __future__ import annotations

import evidences
import pytest

from ros2lab.grading.reading import markdown
from ros2lab.grading.rubric import load
from ros2lab.grading.verdict import verdict

HEADLINE = "# robot_controller\n\n"
COMMANDS = {"colcon build": True, "ros2 run robot_controller status_publisher": True}
HOW = "\n```bash\n{}\n```\n"
SHOWN = {
    **dict.fromkeys(f"ros2 topic echo {topic}" for topic in ("/robot/status", "/robot/command", "/cmd_vel")),
    **dict.fromkeys(f"ros2 run robot_controller {node}" for node in evidences.NODES),
}
NAMES = "status_publisher, command_subscriber, velocity_publisher, /robot/status, /robot/command, /cmd_vel"


def points(text: str, commands: dict[str, bool | None] | None = None) -> list[float]:
    """Return what a README gets for being about the package and for its names, with a block of commands in it."""
    given = {**COMMANDS, **(commands or {})}
    shown = markdown.shown(HEADLINE + text + "\n" + HOW.format("\n".join(given)))
    seen = evidences.files(readme=shown, readme_commands=given)(evidences.right())
    worth = {criterion.id: criterion.points for criterion in verdict(seen, load()).criteria}
    return [worth["documentation.readme"], worth["documentation.interface"]]


FULL = points("Three nodes tell how a small robot is, obey and drive it. " + NAMES)


@pytest.mark.parametrize(
    "text",
    [
        NAMES,
        NAMES.replace(",", ""),
        "\n".join(f"- `{name}`" for name in NAMES.split(", ")),
        f"```\n{NAMES} robot.launch.py timer_period StatusPublisher\n```",
        "| " + NAMES.replace(", ", " | ") + " |\n|---|---|---|---|---|---|",
        f"~~It has the nodes and topics {NAMES}.~~",
        f"<del>It has the nodes and topics {NAMES}.</del>",
    ],
    ids=["by commas", "heap", "list", "code", "table", "struck out", "struck out in HTML"],
)
def test_names_without_words_describe_nothing(text: str) -> None:
    about, named = points(text)
    assert about < FULL[0]
    assert named < FULL[1]


@pytest.mark.parametrize(
    "text",
    [
        f"Nodes and their topics: {NAMES}",
        f"## Nodes\n\n{NAMES.partition(', /')[0]}\n\n## Topics\n\n/{NAMES.partition(', /')[2]}",
        "| Knoten | Thema |\n|---|---|\n| status_publisher | /robot/status |\n| command_subscriber | /robot/command |\n"
        "| velocity_publisher | /cmd_vel |",
        "status_publisher发布/robot/status,command_subscriber订阅/robot/command,velocity_publisher发布/cmd_vel。"
        * 2,
        "- status_publisher publica /robot/status\n- command_subscriber lee /robot/command\n"
        "- velocity_publisher publica /cmd_vel",
        f"```bash\n# what there is: {NAMES}\n```",
    ],
    ids=["a label", "headlines", "German table", "Chinese", "Spanish list", "comment in code"],
)
def test_a_few_words_in_any_language_are_enough(text: str) -> None:
    assert points(text + "\n\n" + "Build and run it as below. " * 3) == FULL
    assert points(text)[1] == FULL[1]


def test_names_in_commands_need_no_words() -> None:
    assert points("", SHOWN) == FULL
