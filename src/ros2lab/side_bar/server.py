"""What JupyterLab's server knows of the course's progress."""

from __future__ import annotations

from typing import Any

from jupyter_server.base.handlers import APIHandler
from jupyter_server.serverapp import ServerApp
from jupyter_server.utils import url_path_join
from tornado import web

from ros2lab import course, progress

ADDRESS = "ros2lab/progress"


def add_to(app: ServerApp) -> None:
    """Let a server answer with the student's progress."""
    pattern = url_path_join(app.base_url, ADDRESS)
    app.web_app.add_handlers(".*", [(pattern, ProgressHandler)])  # type: ignore[no-untyped-call]


class ProgressHandler(APIHandler):
    """Answers with what is done, lesson by lesson."""

    @web.authenticated
    def get(self) -> None:
        """Answer with `course_progress`, as JSON."""
        self.finish(course_progress())


def course_progress() -> dict[str, Any]:
    """Return what the side bar shows, as JSON has it.

    Returns:
        `lessons`, in their order: of each its `title`, the `path` of its notebook in the student's folder, and of
        its exercises how many are `done` and how many there are (`count`). And `next`, the path of the first
        lesson that is not done yet; None if all are.
    """
    whole = progress.Progress()
    return {
        "lessons": [
            {
                "title": progress.title(lesson),
                "path": _path(lesson),
                "done": sum(done for _, done in marks),
                "count": len(marks),
            }
            for lesson, marks in whole.marks.items()
        ],
        "next": whole.next_lesson and _path(whole.next_lesson),
    }


def _path(lesson: str) -> str:
    return f"{course.LESSONS}/{progress.notebook_name(lesson)}"
