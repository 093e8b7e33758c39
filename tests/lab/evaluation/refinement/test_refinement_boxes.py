import numpy as np
import pytest

from hypernav.core.geometry.boxes import Box, Detection
from hypernav.lab.evaluation.refinement.boxes import (
    JITTER_SHARE,
    is_wide_enough,
    jittered,
    matching,
)

TRUE = Box(100.0, 100.0, 200.0, 300.0)


def moved_edges(count=2000):
    rng = np.random.default_rng(0)
    boxes = [jittered(TRUE, rng, width=640, height=480) for _ in range(count)]
    return np.array([[b.x_min - 100, b.x_max - 200, b.y_min - 100, b.y_max - 300] for b in boxes])


def test_edges_move_by_a_share_of_their_own_side():
    edges = moved_edges()
    assert np.abs(edges.mean(axis=0)).max() < 2.0
    np.testing.assert_allclose(
        edges.std(axis=0), JITTER_SHARE * np.array([100, 100, 200, 200]), rtol=0.1
    )


def test_a_jittered_box_stays_in_the_image_and_is_no_inverted_one():
    rng = np.random.default_rng(1)
    for _ in range(500):
        box = jittered(Box(0.0, 470.0, 2.0, 480.0), rng, width=640, height=480)
        assert 0.0 <= box.x_min <= box.x_max <= 640.0
        assert 0.0 <= box.y_min <= box.y_max <= 480.0


def test_the_same_generator_gives_the_same_box():
    first, second = (
        jittered(TRUE, np.random.default_rng([3, 7]), width=640, height=480) for _ in range(2)
    )
    assert first == second


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ([], None),
        ([Detection(Box(150.0, 100.0, 250.0, 300.0), 0.9, "bed")], None),
        ([Detection(Box(105.0, 100.0, 205.0, 300.0), 0.3, "bed")], 105.0),
        (
            [
                Detection(Box(120.0, 100.0, 220.0, 300.0), 0.9, "bed"),
                Detection(Box(101.0, 100.0, 201.0, 300.0), 0.3, "bed"),
            ],
            101.0,
        ),
        ([Detection(TRUE, 0.9, "sofa", is_goal=False)], None),
    ],
)
def test_the_box_that_overlaps_most_is_the_detectors(found, expected):
    box = matching(TRUE, found)
    assert (None if box is None else box.x_min) == expected


@pytest.mark.parametrize(
    ("x_max", "y_max", "expected"), [(10, 10, True), (9, 90, False), (90, 9, False)]
)
def test_a_line_is_no_box(x_max, y_max, expected):
    assert is_wide_enough(Box(0.0, 0.0, float(x_max), float(y_max))) == expected
