"""`%%terminal`: a real bash that stays open between cells."""

from ros2lab.terminal.bash import Terminal, TerminalError
from ros2lab.terminal.magic import load_ipython_extension

__all__ = ["Terminal", "TerminalError", "load_ipython_extension"]
