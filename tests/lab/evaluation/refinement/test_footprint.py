import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.refinement.footprint import Footprint, OffTarget
from hypernav.search.memory.goal_area import GoalArea

CELL_M = 0.05


def of_box(x=(1.0, 1.5), y=(0.0, 0.5)):
    """The footprint of a cupboard in a room, on a map that begins at the scene's origin."""
    scene = scene_of(*room_boxes(), ("cupboard", (x[0], y[0], 0.0), (x[1], y[1], 1.0)))
    cupboard = len(scene.instances) - 1
    return Footprint.of_instances(scene, [cupboard], Pose2(0.0, 0.0, 0.0).to_transform(), CELL_M)


def area_of(points):
    area = GoalArea.from_points(
        np.array([(x, y, 0.5) for x, y in points]),
        resolution_m=CELL_M,
        largest_cluster_only=False,
    )
    assert area is not None
    return area


def test_a_box_stands_on_the_cells_below_it():
    footprint = of_box()
    cells = {(round(x / CELL_M - 0.5), round(y / CELL_M - 0.5)) for x, y in footprint.centres()}
    inside = {(column, row) for column in range(20, 30) for row in range(10)}
    around = {(column, row) for column in range(19, 31) for row in range(-1, 11)}
    assert inside <= cells <= around


@pytest.mark.parametrize(("within", "expected"), [(0, False), (1, False), (2, True), (3, True)])
def test_the_tolerance_is_counted_in_cells(within, expected):
    footprint = Footprint(np.ones((1, 1), dtype=bool), (0, 0), CELL_M)
    (held,) = footprint.holds(np.array([[0.125, 0.025]]), within_cells=within)
    assert held == expected


def test_the_footprint_turns_with_the_map():
    scene = scene_of(*room_boxes(), ("cupboard", (1.0, 0.0, 0.0), (1.5, 0.5, 1.0)))
    cupboard = len(scene.instances) - 1
    quarter = Pose2(1.0, 0.0, np.pi / 2.0).to_transform()
    turned = Footprint.of_instances(scene, [cupboard], quarter, CELL_M)
    # Seen from (1, 0) along y, the cupboard lies ahead and to the right.
    held = turned.holds(np.array([[0.25, -0.25], [0.25, 0.25]]), within_cells=0)
    np.testing.assert_array_equal(held, [True, False])


def test_cells_are_counted_by_hand():
    """Two of six cells lie on the cupboard, one beside it within the tolerance, three far off."""
    on, beside = [(1.125, 0.125), (1.375, 0.375)], [(1.525, 0.225)]
    far = [(2.125, 0.125), (2.175, 0.125), (2.225, 0.125)]
    off = OffTarget.of(area_of([*on, *beside, *far]), of_box())
    assert (off.seen, off.seen_off) == (6, 3)


@given(
    st.lists(st.tuples(st.floats(1.001, 1.499), st.floats(0.001, 0.499)), min_size=1, max_size=30)
)
def test_nothing_of_an_area_of_points_of_the_object_is_off_target(points):
    off = OffTarget.of(area_of(points), of_box())
    assert off.seen_off == 0
