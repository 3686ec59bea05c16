"""Where rclpy.init() runs because a file is imported, a node may be made without a call in main."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.look import source_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

NODE = "from rclpy.node import Node\nimport rclpy\n{imports}\n\ndef main():\n    rclpy.spin(Node('demo'))\n"


def codes(imports: str, **files: str) -> list[str]:
    texts = {
        "pk.node": NODE.format(imports=imports),
        **{name.replace("__", "."): text for name, text in files.items()},
    }
    sources = NodeSources(
        {name: PythonSource(name, f"{name}.py", text, name == "pk") for name, text in texts.items()}
    )
    return [finding.code for finding in source_faults(sources)]


@pytest.mark.parametrize(
    ("imports", "files"),
    [
        ("", {"pk": "import rclpy\nrclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\nrclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\nif not rclpy.ok():\n    rclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\n\ndef go():\n    rclpy.init()\n\ngo()\n"}),
        ("from pk import first", {"pk__first": "import pk.start\n", "pk__start": "import rclpy\nrclpy.init()\n"}),
    ],
)  # fmt: skip
def test_what_runs_at_import_counts(imports: str, files: dict[str, str]) -> None:
    assert "rclpy-init-missing" not in codes(imports, **files)


@pytest.mark.parametrize(
    ("imports", "files"),
    [
        ("", {"pk__start": "import rclpy\nrclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\nif __name__ == '__main__':\n    rclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\n\ndef go():\n    rclpy.init()\n"}),
        ("import pk.start", {"pk__start": "import rclpy\n\nclass A:\n    def go(self):\n        rclpy.init()\n"}),
    ],
)  # fmt: skip
def test_what_does_not_run_at_import_does_not_count(imports: str, files: dict[str, str]) -> None:
    assert "rclpy-init-missing" in codes(imports, **files)
