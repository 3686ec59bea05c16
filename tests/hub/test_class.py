"""A class on one server, as deploy/jupyterhub says it: a real hub, its real proxy, and students at once."""

from __future__ import annotations

import json
import os
import time
import urllib.error
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import nbformat
import psutil
import pytest
from class_server import ClassServer, class_server, publish, readme_blocks
from hub_user import HubUser

from bare_student import Kernel, Student
from ros2lab import course

COUNT = 20
NAMES = [f"student{number:02}" for number in range(1, COUNT + 1)]
NOTEBOOK = "notebooks/00_welcome.ipynb"
LESSONS = ("00", "08")
DRIVE = """
from geometry_msgs.msg import Twist
from std_msgs.msg import String
from ros2lab import CommandPanel, LabSession, course
session = LabSession(domain_id=7)
for node_class in course.reference_nodes():
    session.run(node_class)
panel = CommandPanel(session)
velocity = session.log("/cmd_vel", Twist)
greetings = session.log("/greeting", String)
print(next(button.model_id for button in panel.children[1].children if button.description == "start"))
"""
# In the same domain as all others, and with discovery as wide as it goes.
GREET = """
import os
os.environ.update(ROS_DOMAIN_ID="7", ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET")
from std_msgs.msg import String
from ros2lab import LabSession
session = LabSession(domain_id=7)
"""
Result = TypeVar("Result")


@dataclass
class AtWork:
    """A student who has entered."""

    user: HubUser
    lab: Student
    kernel: Kernel

    def prints(self, source: str) -> str:
        """Run a cell, and return what it prints; others may have kept everybody waiting since the last one."""
        self.kernel.connect_again()
        return printed(self.kernel.run(source))


def printed(outputs: list[Any]) -> str:
    """Return what a cell has printed.

    Raises:
        AssertionError: if there is an error among the outputs.
    """
    errors = ["\n".join(output["traceback"]) for output in outputs if output["output_type"] == "error"]
    said = "".join(output["text"] for output in outputs if output["output_type"] == "stream")
    assert not errors, f"{said}\n{errors[0]}"
    return said


def at_once(do: Callable[[Any], Result], people: list[Any]) -> list[Result]:
    """Let all do something at the same time."""
    with ThreadPoolExecutor(len(people)) as pool:
        return list(pool.map(do, people))


@pytest.mark.thorough
@pytest.mark.timeout(2400)
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can boot a system beside the one that runs")
def test_a_class_works_on_one_server(tmp_path: Path) -> None:
    with class_server(tmp_path / "debian") as server:
        set_up(server)
        with pytest.raises(urllib.error.HTTPError, match="403"):
            HubUser(server.address, NAMES[0], "a guess")
        users = at_once(lambda name: HubUser(server.address, name, f"{name}'s, secret"), NAMES)
        at_once(HubUser.start, users)
        assert at_once(HubUser.first_page, users) == [f"/user/{name}/lab/tree/{NOTEBOOK}" for name in NAMES]
        class_ = at_once(open_notebook, users)
        all_drive_and_nobody_hears_another(class_)
        one_who_takes_all_stops_nobody(server, class_)
        a_new_start_of_the_hub_ends_no_work(server, class_)
        at_once(go_through_lessons, class_)
        at_once(lambda one: one.kernel.leave(), class_)  # which has ended with its lesson
        class_ = at_once(lambda one: open_notebook(one.user), class_)
        an_update_keeps_what_a_student_wrote(server, class_[2])
        an_instructor_grades(server, class_[3], class_[4])
        at_once(lambda one: one.kernel.leave(), class_)


def set_up(server: ClassServer) -> None:
    """Type what README says, up to the start."""
    blocks = readme_blocks()
    server.type(blocks["Install"].replace("ADDRESS", "/mnt/ros2lab"))
    (server.folder / "root/class.csv").write_text("".join(f"{name},{name}'s, secret\n" for name in NAMES))
    server.type(blocks["The class"])
    server.type("useradd --create-home --groups instructors prof && echo prof:points | chpasswd")
    (server.folder / "etc/ros2lab-hub.py").write_text(f"c.JupyterHub.bind_url = {server.address!r}\n")
    server.type(blocks["Start"])
    server.start()


def open_notebook(user: HubUser) -> AtWork:
    lab = Student(user.address, Path())
    return AtWork(user, lab, Kernel(lab, NOTEBOOK))


def all_drive_and_nobody_hears_another(class_: list[AtWork]) -> None:
    """Each hears a program of one's own, in another process, and no neighbour, all of whom speak meanwhile."""
    panels = at_once(lambda one: one.prints(GREET + DRIVE).strip(), class_)
    for one in class_:
        one.prints(
            "import threading\n"
            "is_over = threading.Event()\n"
            "def greet():\n"
            "    while not is_over.wait(0.1):\n"
            f"        session.publish('/greeting', '{one.user.name}')\n"
            "threading.Thread(target=greet).start()"
        )
    heard = at_once(heard_by_another_process, class_)
    assert heard == [one.user.name for one in class_]
    everything = at_once(
        lambda one: one.prints(
            "is_over.set(); print(*{sample.message.data for sample in greetings.samples()})"
        ),
        class_,
    )
    assert [words.split() for words in everything] == [[one.user.name] for one in class_]

    def click(place: int) -> str:
        kernel = class_[place].kernel
        kernel.send_to_widget(panels[place], {"event": "click"})
        changed = "velocity.wait_until(lambda twist: twist.linear.x > 0, timeout=60)"
        return printed(kernel.run(f"print(panel.description)\nprint({changed}.message.linear.x)"))

    assert {said.splitlines()[-1] for said in at_once(click, list(range(len(class_))))} == {"0.5"}


def heard_by_another_process(one: AtWork) -> str:
    """Return what the first greeting is that another kernel of a student hears, once it is heard."""
    other = Kernel(one.lab, "notebooks/01_workspaces.ipynb")
    try:
        listen = "log = session.log('/greeting', String); print(*{s.message.data for s in log.wait_for(20, timeout=60)})"
        return printed(other.run(GREET + listen)).splitlines()[-1]
    finally:
        other.close()


def one_who_takes_all_stops_nobody(server: ClassServer, class_: list[AtWork]) -> None:
    """Four busy loops get one core, a kernel that wants more memory than there is for one ends, and all others go on."""
    greedy, hungry, *others = class_
    greedy.prints(
        "import subprocess; loops = [subprocess.Popen(['sh', '-c', 'while :; do :; done']) for _ in range(4)]"
    )
    unit = server.processes(greedy.user.name)
    hungry.kernel.connect_again()
    before = processor_time(unit)
    begin = time.monotonic()
    with pytest.raises(AssertionError, match="The kernel died"):
        hungry.kernel.run("held = b'x' * (3 * 10**9)")
    sums = at_once(lambda one: one.prints("print(sum(range(1_000_000)))"), others)
    time.sleep(max(0.0, begin + 5.0 - time.monotonic()))  # long enough for the quota, which is one of 0.1 s
    used = (processor_time(unit) - before) / (time.monotonic() - begin)
    assert set(sums) == {"499999500000\n"}
    assert 0.01 < used < 1.1, f"{greedy.user.name} used {used:.2f} cores."
    assert hungry.lab.request("GET", "status")["kernels"] == 1
    greedy.prints("for loop in loops: loop.kill(); loop.wait()")


def processor_time(processes: list[psutil.Process]) -> float:
    """Return how long processes have run, in s."""
    return sum(sum(process.cpu_times()[:2]) for process in processes)


def a_new_start_of_the_hub_ends_no_work(server: ClassServer, class_: list[AtWork]) -> None:
    """Each kernel still knows what it knew, and is reached by a new connection."""
    at_once(lambda one: one.prints(f"known = {one.user.name!r}"), class_)
    server.start()
    assert at_once(lambda one: one.prints("print(known)").strip(), class_) == [
        one.user.name for one in class_
    ]


def go_through_lessons(one: AtWork) -> None:
    """Run all that lessons 0 and 8 let a student run, answered."""
    for path in (path for path in course.notebooks() if path.stem[:2] in LESSONS):
        kernel = Kernel(one.lab, f"notebooks/{path.name}")
        for cell in nbformat.read(path, as_version=4).cells:
            if cell.cell_type == "code" and cell.source != "check.quiz()":
                printed(kernel.run(cell.source))
        kernel.close()


def an_update_keeps_what_a_student_wrote(server: ClassServer, one: AtWork) -> None:
    """Lesson 1, which the student has saved, stays, and the new one lies beside it; lesson 2 is the new one."""
    own = one.lab.request("GET", "contents/notebooks/01_workspaces.ipynb")
    own["content"]["cells"].append(nbformat.v4.new_markdown_cell("Mine"))
    one.lab.request("PUT", "contents/notebooks/01_workspaces.ipynb", own)
    for name in ("01_workspaces", "02_overlays"):
        path = server.folder / "mnt/ros2lab/notebooks" / f"{name}.ipynb"
        lesson = nbformat.read(path, as_version=4)
        lesson.cells.append(nbformat.v4.new_markdown_cell("New"))
        nbformat.write(lesson, path)
    publish(server.folder / "mnt/ros2lab")
    server.type(readme_blocks()["Update"])
    server.start()
    one.user.stop()
    one.user.start()
    lessons = {
        name: one.lab.request("GET", f"contents/notebooks/{name}.ipynb")["content"]["cells"][-1]["source"]
        for name in ("01_workspaces", "01_workspaces%20(new%201)", "02_overlays")
    }
    assert list(lessons.values()) == ["Mine", "New", "New"]


def an_instructor_grades(server: ClassServer, one: AtWork, other: AtWork) -> None:
    """The work of a student is graded where it lies, and no neighbour can read it."""
    one.prints("from ros2lab import course; course.copy_reference(course.work_folder(), has_tests=False)")
    instructor = HubUser(server.address, "prof", "points")
    instructor.start()
    kernel = Kernel(Student(instructor.address, Path()), "notebooks/00_welcome.ipynb")
    grade = f"ros2lab class grade /srv/class --only {one.user.name} --out ~/grades --quiet"
    export = "ros2lab class export jsonl ~/grades --out ~/grades.jsonl"
    lines = printed(kernel.run(f"!{grade} && {export} && cat ~/grades.jsonl")).splitlines()
    assert json.loads(lines[-1])["grade"]["total"] >= 100
    assert "Permission denied" in other.prints(f"!ls /srv/class/{one.user.name}")
    kernel.close()
