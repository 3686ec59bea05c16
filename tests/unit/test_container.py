"""Each image has what the bare Debian has on which its steps are tried."""

import importlib.util
import json
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INSTALL = re.compile(r"apt-get install (.*?) *\\\n")


def test_each_image_installs_the_packages_of_the_bare_debian() -> None:
    spec = importlib.util.spec_from_file_location("bare_root", ROOT / "tools/bare_root.py")
    assert spec
    assert spec.loader
    bare_root = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bare_root)
    (words,) = INSTALL.findall((ROOT / "Dockerfile").read_text())
    packages = {word for word in words.split() if not word.startswith("--")}
    assert packages == {*bare_root.PACKAGES}
    assert (ROOT / "binder/apt.txt").read_text().split() == [*bare_root.PACKAGES]


def test_an_editor_opens_the_same_image() -> None:
    text = (ROOT / ".devcontainer/devcontainer.json").read_text()
    settings = json.loads(re.sub(r"^ *//.*", "", text, flags=re.MULTILINE))
    dockerfile = ROOT / ".devcontainer" / settings["build"]["dockerfile"]
    assert dockerfile.resolve() == ROOT / "Dockerfile"
    assert f"USER {settings['remoteUser']}\n" in dockerfile.read_text()


def test_each_image_is_made_and_started_by_the_same_two_commands() -> None:
    install, start = "python3 tools/bootstrap.py", "ros2lab lab"
    settings = (ROOT / ".devcontainer/devcontainer.json").read_text()
    dockerfile = (ROOT / "Dockerfile").read_text()
    assert f'"postCreateCommand": "{install} student"' in settings
    assert f'RUN {install} "${{GROUP:-student}}"' in dockerfile
    assert (ROOT / "binder/postBuild").read_text().endswith(f"\n{install} student\n")
    assert f"{start} " in (ROOT / "binder/start").read_text().splitlines()[-1]


@pytest.mark.parametrize(
    "words", [["jupyter", "notebook", "--ip", "0.0.0.0"], ["python3", "-c", "pass", "--ip=::"]]
)
def test_what_mybinder_says_of_its_server_is_said_to_the_lab(words: list[str], tmp_path: Path) -> None:
    lab = tmp_path / ".venv/bin/ros2lab"
    lab.parent.mkdir(parents=True)
    lab.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    lab.chmod(0o755)
    said = subprocess.run(
        [ROOT / "binder/start", *words], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    options = words[words.index(next(word for word in words if word.startswith("--"))) :]
    assert said.stdout.split() == ["lab", "--no-browser", "--", *options]
