import pytest
from hypothesis import given
from hypothesis import strategies as st

from hypernav.core.geometry.boxes import Box

numbers = st.floats(-50, 700)
boxes = st.builds(
    lambda x, y, w, h: Box(x, y, x + w, y + h), numbers, numbers, st.floats(0, 500), numbers
)


@given(boxes, boxes)
def test_overlap_is_symmetric_and_a_share(a, b):
    assert a.iou(b) == pytest.approx(b.iou(a))
    assert 0.0 <= a.iou(b) <= 1.0 + 1e-9


@given(boxes)
def test_clipping_keeps_a_box_inside_the_image(box):
    clipped = box.clipped(640, 480)
    assert 0 <= clipped.x_min <= 640
    assert 0 <= clipped.y_max <= 480
    assert clipped.clipped(640, 480) == clipped


def test_the_mask_of_a_box_holds_its_pixels_inside_the_image():
    mask = Box(-3.0, 1.2, 2.0, 3.0).mask(5, 4)
    assert mask.shape == (4, 5)
    assert mask.sum() == mask[1:3, :2].sum() == 4
    assert not Box(9.0, 9.0, 12.0, 12.0).mask(5, 4).any()


def test_a_box_overlaps_itself_fully_and_a_distant_one_not_at_all():
    box = Box(10, 10, 20, 30)
    assert box.iou(box) == pytest.approx(1.0)
    assert box.iou(Box(100, 100, 120, 120)) == 0.0
    assert Box(0, 0, 2, 1).iou(Box(1, 0, 3, 1)) == pytest.approx(1 / 3)


def test_an_inverted_box_has_no_area():
    assert Box(10, 10, 5, 20).area == 0.0


def test_whole_pixels_cover_the_box():
    assert Box(1.2, 2.8, 3.1, 4.0).pixels() == (1, 2, 4, 4)
