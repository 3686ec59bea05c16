"""What is scrolled away rests, and is right when it is seen again."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from browsing import TIMEOUT_MS, Lab, Tab
from driving import height_of_line, trail_pixels, wait_for_picture
from playwright.sync_api import expect

pytestmark = pytest.mark.long

CELLS = [
    "from IPython.display import HTML, display\n"
    "from ipywidgets import Label\n"
    "from geometry_msgs.msg import Twist\n"
    "from ros2lab import GraphView, LabSession, NodeLog, RobotView, TwistPlot\n"
    "session = LabSession()\nrobot = RobotView(session)\nplot = TwistPlot(session, window=120)\n"
    "graph = GraphView(session)\nlog = NodeLog(session)",
    "robot",
    "plot",
    "graph",
    "log",
    "told = Label('seen')\ndisplay(HTML('<div id=\"below\" style=\"margin-top: 3000px\">below</div>'), told)",
    "import threading, time\n\n"
    "def drive_unseen():\n"
    "    while any(view.is_watched() for view in (robot, plot, graph, log._lookout)):\n"
    "        time.sleep(0.1)\n"
    "    told.value = 'unseen'\n"
    "    session.node.get_logger().info('a word that nobody saw')\n"
    "    session.node.create_publisher(Twist, '/news', 1)\n"
    "    twist = Twist()\n"
    "    session.publish('/cmd_vel', twist)\n"
    "    twist.linear.x = 1.0\n"
    "    while robot.pose.x < 1.5:\n"
    "        session.publish('/cmd_vel', twist)\n"
    "        time.sleep(0.1)\n"
    "    told.value = 'driven'\n\n"
    "threading.Thread(target=drive_unseen, daemon=True).start()",
]
VIEWS = [".ros2lab-robot", ".ros2lab-plot", ".ros2lab-graph", ".ros2lab-scroller"]
DRAWN = """() => {
    window.drawn = 0;
    const targets = document.querySelectorAll(".ros2lab-robot, .ros2lab-plot, .ros2lab-graph, .ros2lab-scroller");
    const note = () => window.drawn++;
    targets.forEach((target) => new MutationObserver(note)
        .observe(target, { subtree: true, childList: true, attributes: true, characterData: true }));
    const stroke = CanvasRenderingContext2D.prototype.stroke;
    CanvasRenderingContext2D.prototype.stroke = function (...path) { note(); return stroke.apply(this, path); };
    return targets.length;
}"""


@pytest.mark.thorough
def test_what_is_scrolled_away_is_not_drawn_and_comes_back_right(
    lab: Lab, open_tab: Callable[[str], Tab]
) -> None:
    """The robot drives on meanwhile, and plot, graph and log have missed nothing."""
    lab.write("hidden.ipynb", CELLS)
    tab = open_tab("hidden.ipynb")
    tab.run_all(len(CELLS))
    for view in VIEWS:
        tab.scroll_to(view)
    tab.scroll_to(".ros2lab-robot")
    expect(tab.page.locator(".ros2lab-robot [data-value=x]")).to_have_text("0.00", timeout=TIMEOUT_MS)
    before = trail_pixels(tab)

    tab.scroll_to("#below")
    expect(tab.page.get_by_text("unseen", exact=True)).to_be_attached(timeout=TIMEOUT_MS)
    assert tab.page.evaluate(DRAWN) == len(VIEWS)
    expect(tab.page.get_by_text("driven", exact=True)).to_be_attached(timeout=TIMEOUT_MS)
    assert tab.page.evaluate("window.drawn") == 0, "nothing is drawn that nobody sees"

    tab.scroll_to(".ros2lab-robot")
    tab.page.wait_for_function(
        "() => parseFloat(document.querySelector('.ros2lab-robot [data-value=x]').textContent) >= 1.5",
        timeout=TIMEOUT_MS,
    )
    wait_for_picture(
        lambda: trail_pixels(tab) > before + 30, "the trail leads from where it was to where the robot is"
    )
    tab.scroll_to(".ros2lab-plot")
    expect(tab.page.locator(".ros2lab-plot").get_by_role("img", name="1.00 m/s")).to_be_visible(
        timeout=TIMEOUT_MS
    )
    wait_for_picture(lambda: height_of_line(tab) > 30, "the line rises where it rose")
    tab.scroll_to(".ros2lab-graph")
    expect(tab.page.locator('.ros2lab-graph [data-id*="/news"]').first).to_be_attached(timeout=TIMEOUT_MS)
    tab.scroll_to(".ros2lab-scroller")
    expect(tab.page.locator("table.ros2lab-log")).to_contain_text("a word that nobody saw")
    assert tab.complaints == []
