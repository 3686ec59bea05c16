"""An attribute that is a property means its value, and one that is a method means the method."""

from __future__ import annotations

from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import of_workspace

NAME = NAMES[1]
PUBLISHED = "create_publisher(String, self.where, self.depth)"
FORMS = {
    "property": "    @property\n    def where(self): return 'a'\n\n    @property\n    def depth(self): return 10\n\n",
    "cached": "    @functools.cached_property\n    def where(self): return 'a'\n\n    @functools.cached_property\n    def depth(self): return 10\n\n",
    "abstract": "    @property\n    @abc.abstractmethod\n    def where(self): ...\n\n    @property\n    @abc.abstractmethod\n    def depth(self): ...\n\n",
    "of its own": "    @lazy_property\n    def where(self): return 'a'\n\n    @lazy_property\n    def depth(self): return 10\n\n",
    "with a setter": "    @property\n    def where(self): return 'a'\n\n    @where.setter\n    def where(self, new): pass\n\n    @property\n    def depth(self): return 10\n\n",
}  # fmt: skip
METHODS = "    def where(self): return 'a'\n\n    def depth(self): return 10\n\n"


def codes(folder: Path, methods: str) -> list[str]:
    files = Files.right(NAME).change("PACKAGE/MODULE.py", "create_publisher(String, 'TOPIC', 10)", PUBLISHED)
    files.change("PACKAGE/MODULE.py", "    def CALLBACK(", f"{methods}    def CALLBACK(")
    head = "import abc\nimport functools\nfrom functools import cached_property as lazy_property\n\nimport rclpy\n"
    files.change("PACKAGE/MODULE.py", "import rclpy\n", head)
    return [one.code for one in of_workspace(files.write(folder))]


@pytest.mark.parametrize("form", FORMS)
def test_a_property_is_its_value(tmp_path: Path, form: str) -> None:
    assert "argument-order" not in codes(tmp_path, FORMS[form])


def test_a_method_that_is_not_called_is_told(tmp_path: Path) -> None:
    assert "argument-order" in codes(tmp_path, METHODS)


NAMED_ALONE = {
    "self.subscriptions": False,
    "self.publishers": False,
    "self.handle": False,
    "self.executor": False,
    "self.default_callback_group": False,
    "self.where": False,
    "msg.data": False,
    "self.get_logger": True,
    "self.destroy_node": True,
    "self.CALLBACK": True,
    "rclpy.shutdown": True,
}


@pytest.mark.parametrize("text", NAMED_ALONE)
def test_only_a_function_that_stands_alone_lacks_its_call(tmp_path: Path, text: str) -> None:
    files = Files.right(NAME).change(
        "PACKAGE/MODULE.py", "    def CALLBACK(", f"{FORMS['property']}    def CALLBACK("
    )
    files.change(
        "PACKAGE/MODULE.py", "        self.count += 1\n", f"        self.count += 1\n        {text}\n"
    )
    found = [one for one in of_workspace(files.write(tmp_path)) if one.code == "no-effect"]
    assert bool(found) is NAMED_ALONE[text], found
