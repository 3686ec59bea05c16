"""Faults of the workspace: its folders, and what lies where."""

from __future__ import annotations

from corpus.case import Case
from corpus.faults.making import both, fault
from corpus.package import MODEL, M, P
from corpus.tree import Change, Files, every, move, put

BUILT: Files = {
    "build/robot_controller/colcon_build.rc": "0\n",
    "build/.built_by": "colcon\n",
    "install/setup.bash": "# made by colcon\n",
    "install/robot_controller/lib/robot_controller/status_publisher": "#!/usr/bin/python3\nraise SystemExit(3)\n",
    "install/.colcon_install_layout": "isolated\n",
    "log/latest_build/events.log": "[0.0] (-) TimerEvent: {}\n",
    "log/COLCON_IGNORE": "",
}


def _built_in(folder: str) -> Change:
    return lambda files: files.update({f"{folder}{path}": content for path, content in BUILT.items()})


def _copied_to(folder: str) -> Change:
    return lambda files: files.update(
        {folder + path.removeprefix(P): content for path, content in MODEL.items() if path.startswith(P)}
    )


_OUTER = """\
<?xml version="1.0"?>
<package format="3">
  <name>homework</name><version>0.0.1</version><description>All of my homework.</description>
  <maintainer email="mira.olsen@example.org">Mira Olsen</maintainer><license>MIT</license>
  <export><build_type>ament_python</build_type></export>
</package>
"""

WORKSPACE: tuple[Case, ...] = (
    fault(
        "workspace",
        "package_beside_src",
        both(move(P, "robot_controller/"), put("src/.gitkeep", "")),
        r"\bsrc\b",
        "the package lies in the workspace's top folder, and src is empty",
    ),
    fault(
        "workspace", "src_misspelt", move(P, "scr/robot_controller/"), r"\bsrc\b", "the folder is named scr"
    ),
    fault(
        "workspace",
        "other_package_name",
        both(
            every(lambda text: text.replace("robot_controller", "week2_robot"), ".py", ".md", ".xml", ".cfg"),
            move(f"{P}resource/robot_controller", f"{P}resource/week2_robot"),
            move(M, f"{P}week2_robot/"),
            move(P, "src/week2_robot/"),
        ),
        r"week2_robot",
        "the package has another name than was asked for, everywhere the same",
        most=1,
    ),
    fault(
        "workspace",
        "two_copies",
        _copied_to("src/old/robot_controller/"),
        r"package-duplicate|twice|two|cop(y|ies)|same name",
        "colcon refuses two packages of one name",
    ),
    fault(
        "workspace",
        "colcon_ignore",
        put(f"{P}COLCON_IGNORE", ""),
        r"COLCON_IGNORE",
        "colcon does not look into the package; the package itself is right",
    ),
    fault(
        "workspace",
        "ignored_src",
        put("src/COLCON_IGNORE", ""),
        r"COLCON_IGNORE",
        "colcon does not look into src; the package itself is right",
    ),
    fault(
        "workspace",
        "built_in_src",
        _built_in("src/"),
        r"build|install|log",
        "colcon build was run in src, and what it made was handed in",
    ),
    fault(
        "workspace",
        "built_in_package",
        _built_in(P),
        r"build|install|log",
        "colcon build was run in the package, and what it made was handed in",
    ),
    fault(
        "workspace",
        "package_in_package",
        both(move(P, "src/homework/robot_controller/"), put("src/homework/package.xml", _OUTER)),
        r"in another|inside|homework",
        "colcon does not look for packages below a package",
    ),
)
