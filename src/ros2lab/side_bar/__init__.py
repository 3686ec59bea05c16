"""The course's progress in JupyterLab's side bar: what the server answers, and the extension that shows it.

The extension is plain JavaScript that JupyterLab loads as it is; nothing is built, and no kernel has to run.
"""

from pathlib import Path

EXTENSIONS = Path(__file__).with_name("labextensions")
