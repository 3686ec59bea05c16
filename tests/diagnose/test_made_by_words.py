"""Of a publisher that only a message makes, its silence is no fault: what was sent as a trial made it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from right_workspace import right_workspace
from test_trial import STRING, run_of

from ros2lab import assignments
from ros2lab.diagnose.look import Look
from ros2lab.trial.seen import Seen, seen_faults

INIT = "        self.state = 'idle'\n"
TOLD = "    def command_callback(self, msg):\n"
PUBLISHER = "self.create_publisher(String, {topic}, 10)"
HELPER = "    def pub_of(self, name):\n        return self.pubs.setdefault(name, {made})\n\n"


def made(topic: str) -> str:
    return PUBLISHER.format(topic=topic)


IN_CALLBACK = {
    "a dictionary by name": (f"        self.pubs.setdefault(msg.data, {made('msg.data')})\n", ""),
    "a constant topic": (f"        self.late = {made(repr('/go/order'))}\n", ""),
    "used at once": (f"        {made('msg.data')}.publish(msg)\n", ""),
    "in a method": ("        self.pub_of(msg.data)\n", HELPER.format(made=made("name + '/order'"))),
    "in a loop": (f"        for name in msg.data.split():\n            {made('name')}\n", ""),
}
AT_START = {
    "in the constructor": f"        self.early = {made(repr('/go/order'))}\n",
    "in a loop": f"        self.all = [{made('name')} for name in self.names()]\n",
    "of a parameter": f"        self.early = {made('self.get_parameter(str(1)).value')}\n",
}


@pytest.mark.parametrize(
    ("name", "is_late"), [*((name, True) for name in IN_CALLBACK), *((name, False) for name in AT_START)]
)
def test_a_publisher_that_only_a_trial_message_made_may_be_silent(
    tmp_path: Path, name: str, is_late: bool
) -> None:
    body, helper = IN_CALLBACK[name] if is_late else ("", "")
    files = right_workspace().change("listener", TOLD, f"{helper}{TOLD}{body}")
    files.change("listener", INIT, f"{INIT}        self.pubs = {{}}\n{'' if is_late else AT_START[name]}")
    run = run_of("command_subscriber", "/go/order", STRING, None)
    run = replace(run, subscribes={"/robot/command": {"/command_subscriber": [STRING]}})
    seen = Seen(Look(files.write(tmp_path)), assignments.load(), [run], [])
    codes = [finding.code for finding in seen_faults(seen)]
    assert codes.count("publishes-nothing") == (not is_late)
