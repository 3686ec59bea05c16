"""A file that is run and prints nothing: told is what calls nothing in it, and how it is run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from workspace_files import NAMES, Files

from ros2lab.diagnose import Finding, of_text

NAME = NAMES[1]
MAIN = "def main(args=None):\n    print('hello')\n"
GUARD = "\n\nif __name__ == '__main__':\n    main()\n"


def asked(root: Path, code: str, typed: str = "", name: str = "hello") -> list[Finding]:
    files = Files.right(NAME)
    files.put(f"PACKAGE/{name}.py", code)
    files.change(
        "setup.py", "'console_scripts': [", f"'console_scripts': ['{name} = {NAME.package}.{name}:main',"
    )
    files.write(root)
    return of_text(typed or f"$ cd src/my_bot/my_bot\n$ python3 {name}.py\n$ ls\n{name}.py\n", root)


def printed(file: Path) -> str:
    return subprocess.run(
        [sys.executable, file], capture_output=True, text=True, timeout=60, check=True
    ).stdout


@pytest.mark.parametrize(
    ("wrong", "place", "fix"),
    [
        ("", "def main", "write `if __name__ == '__main__':` at the very end of the file and, indented below it, `main()`"),
        ("\n\nif __name__ == 'main':\n    main()\n", "if __name__", "write `if __name__ == '__main__':`"),
        ("\n\nif __name__ == '__main__':\n    main\n", "    main", "write main()"),
        ("\n    if __name__ == '__main__':\n        main()\n", "    if __name__", "to the left margin"),
        ("\n\nif '__main__' is __name__ + '':\n    main()\n", "if '__main__'", "write `if __name__ == '__main__':`"),
    ],
)  # fmt: skip
def test_nothing_calls_main(tmp_path: Path, wrong: str, place: str, fix: str) -> None:
    code = f"import os\n\nNAME = 'anna'\n\n\n{MAIN}{wrong}"
    first, *_ = asked(tmp_path, code)
    file = tmp_path / "src/my_bot/my_bot/hello.py"
    assert printed(file) == ""
    assert first.code == "never-called"
    assert fix in first.fix
    number = int(first.place.rpartition(":")[2])
    assert code.splitlines()[number - 1].startswith(place)
    file.write_text(f"{MAIN}{GUARD}")
    assert printed(file) == "hello\n"


@pytest.mark.parametrize(
    "typed",
    [
        "$ python3 src/my_bot/my_bot/hello.py\n$ ",
        "anna@pc:~/ws$ python hello.py\nanna@pc:~/ws$ \n",
        "$ python3 -u ./hello.py\n$ ls\nhello.py\n",
        "$ cd src/my_bot && python3 my_bot/hello.py\n$ python3 my_bot/hello.py\n",
        "$ python3 -m my_bot.hello\n$ ",
        "$ ./hello.py\n$ ",
        "$ python3 hello.py\n$ ros2 topic echo /words --once\nWARNING: topic [/words] does not appear to be published yet\n",
    ],
)
def test_however_it_is_run(tmp_path: Path, typed: str) -> None:
    assert asked(tmp_path, MAIN, typed)[0].code == "never-called"


@pytest.mark.parametrize(
    ("code", "fix"),
    [
        ("def generate_launch_description():\n    return None\n", "type `ros2 launch my_bot hello.py`"),
        ("def test_it():\n    assert 1\n", "type `python3 -m pytest src/my_bot/my_bot/hello.py`"),
        ("class Robot:\n    pass\n", "write def main()"),
        ("def start():\n    print('a')\n\n\ndef turn(angle):\n    print(angle)\n", "`start()`"),
    ],
)
def test_what_else_calls_it(tmp_path: Path, code: str, fix: str) -> None:
    assert fix in asked(tmp_path, code)[0].fix


@pytest.mark.parametrize(
    ("code", "typed"),
    [
        (f"{MAIN}{GUARD}", ""),
        (f"{MAIN}\n\nmain()\n", ""),
        ("from pathlib import Path\n\nPath('a').touch()\n", ""),
        ("import os\n\nhome = os.listdir('.')\n", ""),
        (MAIN, "$ python3 hello.py\nhello\n$ "),
        (MAIN, "$ python3 -m py_compile hello.py\n$ "),
        (MAIN, "$ cat hello.py\n$ ros2 run my_bot hello\nhello\n"),
        (MAIN, "$ python3 other.py\n$ "),
        (MAIN, "$ touch hello.py\n$ "),
    ],
)
def test_what_is_right_is_not_told(tmp_path: Path, code: str, typed: str) -> None:
    """It calls something, prints something, or was not run."""
    assert [one for one in asked(tmp_path, code, typed) if one.code == "never-called"] == []
