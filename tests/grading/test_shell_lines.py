"""A command of a README's code counts where a shell would run it."""

from __future__ import annotations

import pytest

from ros2lab.grading.judging.shell_lines import is_run

RUN = [
    "colcon build",
    "$ colcon build",
    "~/ws$ colcon build",
    "user@pc:~/ws$ colcon build",
    "(venv) me@pc:~/ws $ colcon build",
    "root@box:/ws# colcon build",
    r"C:\ws> colcon build",
    "cd ws && colcon build",
    "source x.bash; colcon build &",
    "(cd ws && colcon build)",
    "sudo colcon build",
    "X=1 colcon build",
    "timeout 5 colcon build",
    'bash -c "cd ws && colcon build"',
    "docker run -it img bash -c 'colcon build'",
    "gnome-terminal -- colcon build",
    "xterm -e colcon build",
    "Terminal 1: colcon build",
    "1. colcon build",
    "- colcon build",
    "if true; then colcon build; fi",
    "cat > a.sh <<EOF\nls\nEOF\ncolcon build",
    "cd ~/ws    # the workspace\ncolcon build",
    'echo "it\'s here" && colcon build',
]
NOT_RUN = [
    "# colcon build",
    "ls # colcon build",
    "$ # colcon build",
    ": colcon build",
    "echo colcon build",
    "$ echo colcon build && ls",
    "echo 'colcon build'",
    "printf 'colcon build'",
    "man colcon build",
    "which colcon build",
    'grep "colcon build" history.txt',
    "alias b='colcon build'",
    "false && colcon build",
    "true || colcon build",
    "cat <<EOF\ncolcon build\nEOF",
    "if false; then colcon build; fi",
    "if false\nthen\n  colcon build\nfi",
]


@pytest.mark.parametrize("text", RUN)
def test_what_a_shell_would_run_is_a_command(text: str) -> None:
    assert is_run(text, text.rindex("colcon"))


@pytest.mark.parametrize("text", NOT_RUN)
def test_what_it_would_only_say_or_pass_over_is_none(text: str) -> None:
    assert not is_run(text, text.rindex("colcon"))
