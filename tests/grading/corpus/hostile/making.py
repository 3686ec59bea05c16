"""How a hostile submission is made: the model, or one whose nodes do nothing, with code that attacks."""

from __future__ import annotations

import textwrap

from corpus.case import Case, Make
from corpus.hostile.trap import SECRET, trap
from corpus.package import COMMAND, MODEL, SETUP, SETUP_TEXT, STATUS, VELOCITY, P
from corpus.tree import Change, Files, as_folder, drop, edit, made, put

# Valid packaging, a README, and three programs that do nothing: what an attack for points starts from.
_NO_NODE = '''\
"""Nothing here publishes."""


def main(args=None):
    """Do nothing."""
    print("no node")
'''
POOR: Files = made(
    MODEL, put(STATUS, _NO_NODE), put(COMMAND, _NO_NODE), put(VELOCITY, _NO_NODE), drop(f"{P}test/")
)
POOR_MOST = 15 + 15 + 10 + 4  # workspace, package, documentation, and what of the bonus stands in files


def attack(name: str, about: str, *changes: Change, most: float = 110) -> Case:
    """Return the model with code that attacks; it may keep what its nodes deserve."""
    return packed(name, about, as_folder(made(MODEL, *changes)), most=most)


def swindle(name: str, about: str, *changes: Change, most: float = POOR_MOST) -> Case:
    """Return three programs that do nothing, and an attempt to get points for them."""
    return packed(name, about, as_folder(made(POOR, *changes)), most=most)


def packed(
    name: str,
    about: str,
    make: Make,
    *,
    most: float = 110,
    is_refused: bool = False,
    unreadable: tuple[str, ...] = (),
) -> Case:
    """Return a hostile submission in a form of its own."""
    return Case(
        f"hostile/{name}",
        about,
        make,
        None,
        most=most,
        is_refused=is_refused,
        unreadable=unreadable,
        forbidden=(SECRET,),
        trap=trap,
    )


def careless(code: str) -> str:
    """Return code that goes on, whatever happens in it."""
    return (
        "try:\n"
        + textwrap.indent(code, "    ")
        + "except BaseException as error:\n    print(type(error).__name__)\n"
    )


def in_setup(code: str) -> Change:
    """Run code in setup.py before setup()."""
    return put(SETUP, careless(code) + SETUP_TEXT)


def in_node(code: str) -> Change:
    """Run code in the status publisher before its node is made."""
    return edit(
        STATUS,
        "    rclpy.init(args=args)\n",
        textwrap.indent(careless(code), "    ") + "    rclpy.init(args=args)\n",
    )
