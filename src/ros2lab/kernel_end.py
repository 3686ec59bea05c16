"""What a widget's part in the browser does once its kernel has gone."""

from __future__ import annotations

from pathlib import Path

_ENDING = Path(__file__).parent / "widgets" / "kernel_end.js"


def ending_with_its_kernel(module: str | Path) -> str:
    """Return the browser's part of a widget, which stands still, and says so, once its kernel has gone.

    Args:
        module: a module, or the file that holds it; its default export is a widget of anywidget, or makes one.
    """
    source = module.read_text(encoding="utf-8") if isinstance(module, Path) else module
    own = source.replace("export default", "const ros2labWidget =", 1)
    ending = _ENDING.read_text(encoding="utf-8")
    return f"{own}\n{ending}\nexport default endingWithItsKernel(ros2labWidget);\n"
