"""The image has what the bare Debian has on which its steps are tried."""

import importlib.util
import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
INSTALL = re.compile(r"apt-get install (.*?) *\\\n")


def test_the_image_installs_the_packages_of_the_bare_debian() -> None:
    spec = importlib.util.spec_from_file_location("bare_root", ROOT / "tools/bare_root.py")
    assert spec
    assert spec.loader
    bare_root = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bare_root)
    (words,) = INSTALL.findall((ROOT / "Dockerfile").read_text())
    packages = {word for word in words.split() if not word.startswith("--")}
    assert packages == {*bare_root.PACKAGES}


def test_an_editor_opens_the_same_image() -> None:
    text = (ROOT / ".devcontainer/devcontainer.json").read_text()
    settings = json.loads(re.sub(r"^ *//.*", "", text, flags=re.MULTILINE))
    dockerfile = ROOT / ".devcontainer" / settings["build"]["dockerfile"]
    assert dockerfile.resolve() == ROOT / "Dockerfile"
    assert f"USER {settings['remoteUser']}\n" in dockerfile.read_text()
