"""Lines of sight on the map."""

import numpy as np
import pytest

from drawn_grids import drawn
from hypernav.search.mapping.sight_lines import lines_are_clear

# Two rooms with a door in the wall between them, and the unknown on the right.
ROOMS = """
    ....#....??
    ....#....??
    .........??
    ....#....??
"""
NOTHING = np.zeros((0, 2))


def is_clear(start, end, through=NOTHING):
    lines = np.array([start, end], dtype=float).reshape(2, 1, 2)
    (clear,) = lines_are_clear(drawn(ROOMS, scale=10), *lines, through=through)
    return bool(clear)


@pytest.mark.parametrize(
    ("start", "end", "clear"),
    [
        ((1.0, 1.75), (1.0, 0.25), True),  # in one room
        ((1.0, 1.75), (4.0, 1.75), False),  # through the wall
        ((1.0, 0.75), (4.0, 0.75), True),  # through the door
        ((4.0, 1.25), (5.4, 1.25), True),  # into the unknown, which hides nothing
        ((4.0, 1.25), (9.0, 1.25), True),  # and beyond the map
    ],
)
def test_a_wall_hides_and_a_door_does_not(start, end, clear):
    assert is_clear(start, end) is clear
    assert is_clear(end, start) is clear


def test_what_is_looked_at_does_not_hide_itself():
    wall = drawn(ROOMS, scale=10)
    own = wall.centres_of(np.argwhere(wall.occupied))
    assert is_clear((1.0, 1.75), (4.0, 1.75), through=own)


def test_no_line_is_no_answer():
    assert len(lines_are_clear(drawn(ROOMS), NOTHING, NOTHING, through=NOTHING)) == 0
