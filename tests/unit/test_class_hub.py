"""What a class is deployed with holds together: the hub's configuration, its proxy, and the values of its chart."""

from __future__ import annotations

import json
import re
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml
from traitlets.config import Config, PyFileConfigLoader

from ros2lab import course, jupyter_settings

DEPLOY = Path(__file__).parents[2] / "deploy"
HUB = DEPLOY / "jupyterhub"


@pytest.fixture
def spawner() -> ModuleType:
    """The module of the spawner; all of JupyterHub comes with it, which is of no use to other tests."""
    from ros2lab import class_spawner

    return class_spawner


def test_the_hub_knows_every_setting_of_its_configuration(spawner: ModuleType) -> None:
    """A misspelt name would change nothing, in silence."""
    from jupyterhub.app import JupyterHub
    from jupyterhub.auth import PAMAuthenticator
    from jupyterhub.proxy import ConfigurableHTTPProxy

    known = {kind.__name__: kind for kind in (JupyterHub, PAMAuthenticator, ConfigurableHTTPProxy)}
    known["Spawner"] = spawner.ClassSpawner
    settings: Config = PyFileConfigLoader("jupyterhub_config.py", str(HUB)).load_config()
    assert len(settings) == len(known)
    for kind, values in settings.items():
        assert set(values) <= set(known[kind].class_trait_names(config=True))


def test_a_student_has_a_network_and_a_shared_memory_of_ones_own(spawner: ModuleType) -> None:
    assert spawner.PROPERTIES["PrivateNetwork"] == "yes"
    assert spawner.PROPERTIES["TemporaryFileSystem"].startswith("/dev/shm:")


def test_the_lab_listens_where_a_hub_says(tmp_path: Path, spawner: ModuleType) -> None:
    address = spawner.socket_address("/run/anna/server.sock") + "/user/anna/"
    assert "--ServerApp.sock=/run/anna/server.sock" in jupyter_settings.hub_settings(tmp_path, address)
    assert not any(
        ".sock" in option
        for option in jupyter_settings.hub_settings(tmp_path, "http://0.0.0.0:8888/user/anna/")
    )
    (tmp_path / ".jupyter/runtime").mkdir(parents=True)
    given = {"JUPYTERHUB_API_TOKEN": "secret", "JUPYTER_PORT": "1", "JUPYTERLAB_DIR": "/elsewhere"}
    kept = {name for name in jupyter_settings.jupyter_variables(tmp_path, given) if name in given}
    assert kept == {"JUPYTERHUB_API_TOKEN"}


def test_the_proxy_is_the_locked_one() -> None:
    wanted = json.loads((HUB / "package.json").read_text())["dependencies"]
    packages = json.loads((HUB / "package-lock.json").read_text())["packages"]
    assert packages[""]["dependencies"] == wanted
    assert all(package["integrity"] for name, package in packages.items() if name)


def test_a_pod_runs_what_the_image_has() -> None:
    values: dict[str, Any] = yaml.safe_load((DEPLOY / "kubernetes/values.yaml").read_text())
    student = values["singleuser"]
    (home,) = re.findall(r"^WORKDIR (.*)", (DEPLOY.parent / "Dockerfile").read_text(), re.MULTILINE)
    assert student["cmd"][0] == f"{home}/.venv/bin/ros2lab"
    assert student["storage"]["homeMountPath"] == str(course.work_folder({}, Path(home)))
    mounts = {mount["name"] for mount in student["storage"]["extraVolumeMounts"]}
    assert mounts == {volume["name"] for volume in student["storage"]["extraVolumes"]}
