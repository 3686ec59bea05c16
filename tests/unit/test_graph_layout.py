"""Graphviz's layout of a graph: layers, no overlap, and calm when one node comes or goes."""

from __future__ import annotations

from itertools import combinations, pairwise

import pytest

from ros2lab.widgets.graph_layout import DIRECTIONS, Direction, Layout, Link, lay_out

COURSE = [
    ("panel", "command"),
    ("command", "command_subscriber"),
    ("command_subscriber", "state"),
    ("state", "status_publisher"),
    ("state", "velocity_publisher"),
    ("status_publisher", "status"),
    ("velocity_publisher", "cmd_vel"),
    ("cmd_vel", "plot"),
]
WIDTH, HEIGHT = 100.0, 30.0


def laid_out(
    pairs: list[tuple[str, str]],
    direction: Direction,
    before: Layout | None = None,
    *,
    alone: tuple[str, ...] = (),
) -> Layout:
    sizes = dict.fromkeys((*alone, *(name for pair in pairs for name in pair)), (WIDTH, HEIGHT))
    return lay_out(sizes, [Link(f"{a}>{b}", a, b) for a, b in pairs], direction, before)


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_boxes_lie_inside_and_apart_and_arrows_point_one_way(direction: Direction) -> None:
    layout = laid_out(COURSE, direction, alone=("alone",))
    along = 0 if direction == "LR" else 1
    for point in layout.boxes.values():
        assert WIDTH / 2 <= point.x <= layout.width - WIDTH / 2
        assert HEIGHT / 2 <= point.y <= layout.height - HEIGHT / 2
    for one, other in combinations(layout.boxes.values(), 2):
        assert abs(one.x - other.x) >= WIDTH or abs(one.y - other.y) >= HEIGHT
    for source, target in COURSE:
        assert layout.boxes[source][along] < layout.boxes[target][along]


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_arrows_go_from_box_to_box_also_around_a_loop(direction: Direction) -> None:
    loop = [("a", "t"), ("t", "a"), ("t", "b")]
    layout = laid_out(loop, direction)
    for source, target in loop:
        *points, tip = layout.curves[f"{source}>{target}"]
        assert len(points) % 3 == 1
        for point, name in ((points[0], source), (tip, target)):
            box = layout.boxes[name]
            assert abs(point.x - box.x) <= WIDTH / 2 + 2
            assert abs(point.y - box.y) <= HEIGHT / 2 + 2
        middle = layout.middle(f"{source}>{target}")
        assert 0 <= middle.x <= layout.width
        assert 0 <= middle.y <= layout.height


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("goes", sorted({name for pair in COURSE for name in pair}))
def test_when_one_goes_and_comes_back_no_two_others_change_places(direction: Direction, goes: str) -> None:
    """Across the arrows, and within a layer: that is what somebody who looks has remembered."""
    whole = laid_out(COURSE, direction)
    rest = laid_out([pair for pair in COURSE if goes not in pair], direction, whole)
    again = laid_out(COURSE, direction, rest)
    for before, after in pairwise((whole, rest, again)):
        along, across = (0, 1) if direction == "LR" else (1, 0)
        common = set(before.boxes) & set(after.boxes)
        for one, other in combinations(sorted(common), 2):
            layers = [layout.boxes[one][along] == layout.boxes[other][along] for layout in (before, after)]
            sides = [layout.boxes[one][across] - layout.boxes[other][across] for layout in (before, after)]
            assert not all(layers) or sides[0] * sides[1] > 0, f"{one} and {other} have changed places"


def test_the_same_graph_is_laid_out_the_same() -> None:
    assert laid_out(COURSE, "LR") == laid_out(COURSE[::-1], "LR")


def test_unconnected_parts_lie_below_each_other_where_it_is_narrow() -> None:
    layout = laid_out([("a", "b"), ("c", "d"), ("e", "f")], "TB")
    assert layout.width < 2 * WIDTH


def test_a_badge_gets_room_between_layers() -> None:
    sizes = {"a": (WIDTH, HEIGHT), "b": (WIDTH, HEIGHT)}
    plain, badged = (lay_out(sizes, [Link("l", "a", "b", has_badge)], "LR") for has_badge in (False, True))
    assert badged.width > plain.width


def test_nothing_is_laid_out_as_nothing() -> None:
    layout = lay_out({}, [])
    assert (layout.width, layout.height, layout.boxes) == (0, 0, {})


def test_names_are_taken_as_they_are() -> None:
    """Not as Graphviz's own language would read them."""
    odd = ['"; a -> b', "\\N", "<b>", "node"]
    assert set(laid_out([], "LR", alone=tuple(odd)).boxes) == set(odd)
