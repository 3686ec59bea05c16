"""What runs because a file is imported: rclpy.init(), so that main needs none, or what never ends, so that main is never reached."""

from __future__ import annotations

import pytest

from ros2lab.diagnose.finding import Finding
from ros2lab.diagnose.rules import source_faults
from ros2lab.diagnose.sources.node_source import NodeSources
from ros2lab.diagnose.sources.python_source import PythonSource

NODE = "from rclpy.node import Node\nimport rclpy\n{imports}\n\ndef main():\n    rclpy.spin(Node('demo'))\n"


def codes(imports: str, **files: str) -> list[str]:
    return [finding.code for finding in found(imports, **files)]


def found(imports: str, **files: str) -> list[Finding]:
    texts = {
        "pk.node": NODE.format(imports=imports),
        **{name.replace("__", "."): text for name, text in files.items()},
    }
    sources = NodeSources(
        {name: PythonSource(name, f"{name}.py", text, name == "pk") for name, text in texts.items()}
    )
    return [*source_faults(sources)]


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


FAN = """\
import threading
import rclpy
from rclpy.node import Node

LIMIT = 3


def main():
    rclpy.init()
    rclpy.spin(Node('fan'))


def wait(is_short=False):
    while rclpy.ok():
        if is_short:
            return


{top}
"""


@pytest.mark.parametrize(
    ("imports", "top", "fix"),
    [
        ("from pk.fan import LIMIT", "main()", "above this line"),
        ("import pk.fan", "try:\n    main()\nexcept KeyboardInterrupt:\n    pass", "move this"),
        ("from pk import fan", "rclpy.init()\nrclpy.spin(Node('fan'))", "move this"),
        ("import pk.fan", "while True:\n    print(LIMIT)", "move this"),
        ("from pk.other import LIMIT", "def go():\n    main()\n\n\ngo()", "above this line"),
    ],
)
def test_a_program_is_not_reached_where_an_import_does_not_end(imports: str, top: str, fix: str) -> None:
    other = "from pk.fan import LIMIT\n"
    told = [
        f for f in found(imports, pk__fan=FAN.format(top=top), pk__other=other) if f.code == "never-called"
    ]
    assert [(finding.place.partition(":")[0], "line 3" in finding.cause) for finding in told] == [
        ("pk.fan.py", True)
    ]
    assert fix in told[0].fix


@pytest.mark.parametrize(
    ("imports", "top"),
    [
        ("from pk.fan import LIMIT", "if __name__ == '__main__':\n    main()"),
        ("from pk.fan import LIMIT", "threading.Thread(target=main, daemon=True).start()"),
        ("from pk.fan import LIMIT", "wait(True)"),
        ("from pk.fan import LIMIT", "if LIMIT > 4:\n    main()"),
        ("from pk.fan import LIMIT", "while True:\n    break"),
        ("if False:\n    import pk.fan", "main()"),
        ("", "main()"),
    ],
)
def test_a_program_is_reached_where_each_import_ends_or_may_end(imports: str, top: str) -> None:
    assert "never-called" not in codes(imports, pk__fan=FAN.format(top=top))


@pytest.mark.parametrize(
    "body",
    [
        "    with Context() as own:\n        rclpy.create_node('a', context=own)\n",
        "    own = Context()\n    own.init()\n    rclpy.create_node('a', context=own)\n",
        "    own = Context()\n    rclpy.init(context=own)\n    rclpy.create_node('a', context=own)\n",
        "    with ExitStack() as stack:\n        own = stack.enter_context(Context())\n        rclpy.create_node('a', context=own)\n",
        "    rclpy.create_node('a', context=ready())\n",
    ],
)
def test_a_context_of_its_own_may_be_initialized_elsewhere(body: str) -> None:
    top = "import rclpy\nfrom contextlib import ExitStack\nfrom pk.more import ready\nfrom rclpy.context import Context\n"
    told = found("", pk__own=f"{top}\n\ndef main():\n{body}")
    assert ["pk.node" in one.place for one in told if one.code == "rclpy-init-missing"] == [True]


@pytest.mark.parametrize(
    ("below", "said"),
    [
        ("if __name__ == '__main__':\n    main()\n    rclpy.spin(node)\n", "never comes to line 12"),
        ("if __name__ == '__main__':\n    main()\n", "never spins it, so"),
    ],
)
def test_a_spin_that_only_python_reaches_is_named(below: str, said: str) -> None:
    top = "import rclpy\nfrom rclpy.node import Node\n\ndef main():\n    global node\n    rclpy.init()\n    node = Node('own')\n    node.create_timer(1.0, print)\n\n"
    told = found("", pk__own=f"{top}{below}")
    (spin,) = [one for one in told if one.code == "spin-missing"]
    assert said in spin.cause
    assert ("remove line 12" in spin.fix) == ("line 12" in said)
