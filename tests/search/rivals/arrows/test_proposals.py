"""Laws of proposed moves."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from arrow_views import CAMERA, HERE, room_with_wall
from drawn_grids import drawn
from exploration_views import exploration_view
from hypernav.core.embodiment import Embodiment
from hypernav.search.drawing.shapes import ArrowStyle
from hypernav.search.rivals.arrows.arrow_sight import ArrowSight, mark_of
from hypernav.search.rivals.arrows.pivot import GaussianProposer
from hypernav.search.rivals.arrows.proposals import FreeDirections, biased_moves, spatial_moves
from hypernav.search.rivals.config import ArrowsConfig

FOV = math.radians(79.0)
HEADINGS = np.linspace(-0.75 * FOV, 0.75 * FOV, 60)


@st.composite
def directions(draw):
    free = draw(st.lists(st.floats(0.0, 5.0), min_size=60, max_size=60))
    explored = draw(st.lists(st.booleans(), min_size=60, max_size=60))
    return FreeDirections(HEADINGS, np.array(free), np.array(explored), FOV)


@given(directions())
def test_no_biased_move_ends_beyond_two_thirds_of_the_free_floor(seen):
    for move in biased_moves(seen, may_turn=True):
        free_m, _ = seen.at(move.heading)
        assert 0.75 < move.length_m <= min(0.66 * free_m, 1.7) + 1e-9


@given(directions())
def test_biased_moves_keep_apart_and_are_numbered_from_left_to_right(seen):
    moves = biased_moves(seen, may_turn=True)
    angles = [move.heading for move in moves]
    assert angles == sorted(angles, reverse=True)
    assert all(a - b >= 0.9 * 79.0 / 360.0 - 1e-9 for a, b in pairwise(angles))


@given(directions())
def test_the_longest_unexplored_direction_is_always_offered(seen):
    worth = (0.66 * seen.free_m > 0.75) & ~seen.is_explored
    moves = biased_moves(seen, may_turn=True)
    if worth.any():
        longest = HEADINGS[worth][seen.free_m[worth].argmax()]
        assert any(math.isclose(move.heading, longest) for move in moves)


@settings(max_examples=40)
@given(directions(), st.sets(st.integers(0, 59), max_size=3), st.booleans())
def test_explored_directions_are_offered_where_nothing_is_near_and_only_there(
    seen, unexplored, space_explored
):
    seen.is_explored[:] = True
    seen.is_explored[list(unexplored)] = False
    unit = 79.0 / 360.0
    offered = [
        (move.heading, seen.at(move.heading)[1])
        for move in biased_moves(seen, may_turn=True, space_explored=space_explored)
    ]
    fresh = [heading for heading, is_explored in offered if not is_explored]
    taken = [heading for heading, _ in offered] if space_explored else fresh
    for heading, is_explored in offered:
        others = [abs(heading - one) for one in taken if one != heading]
        assert not (fresh and is_explored) or min(others) >= 4.0 * unit - 1e-9
    for k in np.flatnonzero(0.66 * seen.free_m > 0.75):  # nothing more could be offered
        if fresh:
            spacing, others = (4.0, taken) if seen.is_explored[k] else (0.9, fresh)
        else:
            spacing, others = 1.0, [heading for heading, _ in offered]
        assert min(abs(HEADINGS[k] - one) for one in others) < spacing * unit or any(
            heading == HEADINGS[k] for heading, _ in offered
        )


def test_where_nothing_is_free_there_is_something_only_if_it_may_not_turn():
    nothing = FreeDirections(HEADINGS, np.zeros(60), np.zeros(60, dtype=bool), FOV)
    assert biased_moves(nothing, may_turn=True) == []
    assert len(biased_moves(nothing, may_turn=False)) == 4


@given(directions())
def test_points_in_space_are_free_reachable_and_few(seen):
    def left_half(x, y):
        return y >= 0.0

    moves = spatial_moves(seen, HERE, left_half)
    assert len(moves) <= 8
    assert len(set(moves)) == len(moves)
    for move in moves:
        free_m, _ = seen.at(move.heading)
        assert move.length_m <= 0.66 * free_m + 1e-9
        assert move.length_m * math.sin(move.heading) >= 0.0


def test_marks_lie_in_the_image_in_the_direction_of_their_moves():
    seen = room_with_wall()
    for heading in np.radians([-30.0, 0.0, 25.0]):
        u, v = mark_of(seen, heading, 2.5, slide=True) or (0.0, 0.0)
        assert CAMERA.intrinsics.bearing_of(u) == pytest.approx(heading)
        # On the floor: its depth leads back to the end of the move.
        depth = 2.5 * math.cos(heading)
        point = seen.camera.unproject(np.array([u]), np.array([v]), depth)
        x, y, z = seen.camera_to_map.apply(point)[0]
        assert (x, y, z) == pytest.approx((depth, 2.5 * math.sin(heading), 0.0), abs=1e-6)


def test_near_ends_slide_into_the_image_or_are_left_out():
    seen = room_with_wall()
    u, v = mark_of(seen, 0.2, 1.0, slide=True) or (0.0, 0.0)
    assert CAMERA.intrinsics.bearing_of(u) == pytest.approx(0.2)
    assert v <= 0.96 * CAMERA.height
    assert mark_of(seen, 0.2, 1.0, slide=False) is None
    assert mark_of(seen, 1.2, 2.5, slide=True) is None  # beside the image


def test_every_number_maps_back_to_its_end():
    shown = exploration_view(drawn("."), room_with_wall(4.0))
    sight = ArrowSight(shown, Embodiment(camera=CAMERA), ArrowsConfig(), ArrowStyle())
    seen = sight.look()
    moves = biased_moves(seen, may_turn=True)
    arrows = sight.marked(moves, seen, may_overlap=True)
    assert len(arrows) >= 3
    view = sight.view(arrows, may_turn=True)
    for number, arrow in enumerate(arrows, start=1):
        assert view.arrow(number) is arrow
        heading = math.atan2(arrow.end[1], arrow.end[0])
        assert heading == pytest.approx(arrow.heading)
        assert math.hypot(*arrow.end) == pytest.approx(arrow.length_m)
        assert CAMERA.intrinsics.bearing_of(arrow.pixel[0]) == pytest.approx(heading)
        assert sight.along(arrow, "there").xy == arrow.end
    assert (view.image != sight.observation.rgb).any()


@given(st.integers(0, 1000))
def test_gaussian_marks_keep_their_distances_and_equal_seeds_draw_equal_marks(seed):
    marks = GaussianProposer(CAMERA.intrinsics, np.random.default_rng(seed)).draw(8)
    again = GaussianProposer(CAMERA.intrinsics, np.random.default_rng(seed)).draw(8)
    np.testing.assert_array_equal(marks, again)
    assert len(marks) <= 8
    assert (marks >= [16.0, 12.0]).all()
    assert (marks <= [304.0, 228.0]).all()
    for k, one in enumerate(marks):
        assert all(np.hypot(*(one - other)) > 100.0 * 240 / 1080 for other in marks[:k])


def test_the_distribution_is_fitted_to_the_best():
    proposer = GaussianProposer(CAMERA.intrinsics, np.random.default_rng(0))
    assert proposer.mean.tolist() == [160.0, 120.0]
    assert proposer.deviation.tolist() == [80.0, 60.0]
    proposer.fit(np.empty((0, 2)))
    assert proposer.deviation.tolist() == [80.0, 60.0]
    proposer.fit(np.array([[100.0, 50.0]]))
    assert proposer.draw(3).tolist() == [[100.0, 50.0]]
