"""What the kernel of a page runs."""

from __future__ import annotations

import contextlib
import html
import io

from IPython.display import HTML, display

from ros2lab.session import LabSession
from ros2lab.widget_state import WIDGET_VIEW
from ros2lab.widgets.dashboard import Dashboard


def show() -> Dashboard | None:
    """Open a dashboard in the domain that `ROS_DOMAIN_ID` names, and show it as the cell's output.

    No picture is stored with it: nobody saves the page. Where it cannot be opened, a sentence says why, and None
    is returned.
    """
    try:
        with contextlib.redirect_stdout(
            io.StringIO()
        ):  # who else has nodes here is what the page is opened for
            session = LabSession()
        dashboard = Dashboard(session)
    except Exception as error:
        reason = html.escape(str(error).partition("\n")[0])
        sentence = f"The dashboard cannot be opened: {reason}. <code>ros2lab doctor</code> may tell more."
        display(HTML(f'<p role="alert">{sentence}</p>'))  # type: ignore[no-untyped-call]
        return None
    view = {"version_major": 2, "version_minor": 0, "model_id": dashboard.model_id}
    display({"text/plain": repr(dashboard), WIDGET_VIEW: view}, raw=True)  # type: ignore[no-untyped-call]
    return dashboard
