"""Size and place speak for and against names, and what is hidden or cut off only bounds them."""

import math
from dataclasses import astuple

import numpy as np
import pytest

import images
from box_views import SolidBox, room, view_of
from certainty import certain
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.naming.kind_shapes import KINDS, kind_shape
from hypernav.core.naming.labels import canonical
from hypernav.core.observation import Observation
from hypernav.search.models.closed_set import COCO_CLASSES
from hypernav.search.perception.local.shape import (
    Form,
    ShapeEvidence,
    measured_form,
    shape_evidence,
)

AT = Pose2(0.6, 3.0, 0.0)
ROOM = room(8.0, 6.0)
REFRIGERATOR: SolidBox = ((3.0, 2.7, 0.0), (3.7, 3.4, 1.8))
CHAIR: SolidBox = ((3.0, 2.8, 0.0), (3.5, 3.3, 0.9))
BED: SolidBox = ((2.2, 2.0, 0.0), (4.2, 3.6, 0.5))
RACK: SolidBox = ((3.0, 1.8, 0.0), (3.5, 4.2, 1.8))


def seen(thing: SolidBox, *others: SolidBox) -> tuple[Observation, np.ndarray]:
    """A view of a thing in a room, and the pixels that show it."""
    view = view_of([*ROOM, thing, *others], AT)
    without = view_of([*ROOM, *others], AT)
    return view, view.depth != without.depth


def box_of(mask: np.ndarray) -> Box:
    rows, columns = np.nonzero(mask)
    edges = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
    return Box(*(float(edge) for edge in edges))


def form_of(thing: SolidBox, *others: SolidBox) -> Form:
    view, mask = seen(thing, *others)
    form = measured_form(view, mask, box_of(mask))
    assert form is not None
    return form


def says(name: str, form: Form) -> ShapeEvidence:
    kind = kind_shape(name)
    assert kind is not None
    return shape_evidence(form, kind)


def test_a_box_is_measured_in_the_map():
    form = form_of(REFRIGERATOR)
    assert form.top_m == pytest.approx(1.8, abs=0.1)
    assert form.bottom_m == pytest.approx(0.0, abs=0.1)
    assert form.long_m == pytest.approx(0.7, abs=0.1)
    assert form.is_bottom_seen
    assert form.is_top_seen
    assert form.is_long_seen
    assert form.level_share < 0.1
    assert form_of(BED).level_share > 0.2


@pytest.mark.parametrize("turn_deg", [30, 90, 135, 250])
def test_a_form_is_the_same_however_the_map_is_turned(turn_deg: int):
    screen: SolidBox = ((2.5, 2.4, 0.5), (2.6, 3.6, 1.2))
    for thing in (screen, BED):
        view, mask = seen(thing)
        turned = view.in_frame(Pose2(3.0, -2.0, math.radians(turn_deg)).to_transform())
        forms = [measured_form(one, mask, box_of(mask)) for one in (view, turned)]
        upright, expected = (certain(one) for one in forms)
        assert upright.is_plane_upright == (thing is screen)
        assert astuple(upright) == pytest.approx(astuple(expected), abs=1e-6)


def test_a_flat_face_has_its_own_width_from_whichever_side_it_is_seen():
    screen: SolidBox = ((3.0, 2.5, 0.5), (3.05, 3.5, 1.2))
    for y in (1.0, 2.0, 3.0, 4.0, 5.0):
        robot = Pose2(1.2, y, math.atan2(3.0 - y, 1.8))
        view, without = (view_of([*ROOM, *more], robot) for more in ([screen], []))
        mask = view.depth != without.depth
        form = certain(measured_form(view, mask, box_of(mask)))
        assert form.is_plane_upright
        assert form.long_m == pytest.approx(1.0, abs=0.1)


def test_a_table_top_that_takes_five_rows_of_the_image_is_level():
    rows = 5
    view = view_of([*ROOM, ((1.0, 2.0, 0.0), (3.0, 4.0, 0.7))], AT)
    mask = np.zeros(view.depth.shape, bool)
    mask[190 : 190 + rows, 100:200] = True
    form = certain(measured_form(view, mask, box_of(mask)))
    assert form.top_m == pytest.approx(0.7, abs=0.01)
    assert form.level_share == 1.0


@pytest.mark.parametrize("side", range(4))
@pytest.mark.parametrize(("short_px", "is_seen"), [(0, True), (4, True), (5, False), (20, False)])
def test_a_mask_that_falls_short_of_its_box_by_a_tenth_shows_no_end_there(
    side: int, short_px: int, is_seen: bool
):
    view = images.thing_before_wall(box=(50, 40, 95, 85))
    edges = [50.0, 40.0, 95.0, 85.0]
    edges[side] += -short_px if side < 2 else short_px
    form = certain(measured_form(view, images.thing_pixels(view), Box(*edges)))
    ends = {"long": form.is_long_seen, "top": form.is_top_seen, "bottom": form.is_bottom_seen}
    beyond = ("long", "top", "long", "bottom")[side]
    assert ends == {name: is_seen or name != beyond for name in ends}


@pytest.mark.parametrize(
    ("name", "thing", "fits"),
    [
        ("refrigerator", REFRIGERATOR, True),
        ("refrigerator", CHAIR, False),
        ("refrigerator", RACK, False),
        ("chair", CHAIR, True),
        ("chair", REFRIGERATOR, False),
        ("bed", BED, True),
        ("bed", RACK, False),
        ("toilet", RACK, False),
        ("potted plant", CHAIR, True),
        ("refrigerator", ((3.0, 2.7, 0.0), (3.7, 3.4, 1.08)), True),  # 2 cm too low
    ],
)
def test_names_fit_things_of_their_size(name: str, thing: SolidBox, fits: bool):
    evidence = says(name, form_of(thing))
    assert (evidence.log_odds > 0.0) == fits
    assert bool(evidence.reasons) != fits


def test_what_something_nearer_hides_only_bounds_the_form():
    table: SolidBox = ((2.0, 2.4, 0.0), (2.3, 3.7, 0.75))
    shelf: SolidBox = ((2.0, 2.4, 0.95), (2.3, 3.7, 2.4))
    hidden = form_of(REFRIGERATOR, table, shelf)
    assert not hidden.is_bottom_seen
    assert not hidden.is_top_seen
    assert not says("refrigerator", hidden).reasons


def test_what_the_image_cuts_off_may_be_larger_but_is_no_smaller():
    near: SolidBox = ((1.8, 0.5, 0.0), (2.3, 3.5, 1.0))
    form = form_of(near)
    assert not form.is_bottom_seen
    assert not form.is_long_seen
    assert not says("sofa", form).reasons
    assert says("toilet", form).reasons


def test_a_patch_of_a_wall_is_no_bed_but_may_be_a_picture():
    view = view_of(ROOM, Pose2(5.0, 3.0, 0.0))
    mask = np.zeros(view.depth.shape, bool)
    mask[100:150, 120:200] = True
    form = measured_form(view, mask, box_of(mask))
    assert form is not None
    assert form.goes_on > 0.9
    assert form.is_plane_upright
    assert "it is a part of a wall's plane" in says("bed", form).reasons
    assert not any("wall" in reason for reason in says("picture", form).reasons)


def test_a_patch_of_the_floor_is_no_keyboard_but_may_be_a_rug():
    view = view_of(ROOM, AT)
    mask = np.zeros(view.depth.shape, bool)
    mask[190:215, 120:200] = True
    form = measured_form(view, mask, box_of(mask))
    assert form is not None
    assert "it is a part of the floor" in says("cutting board", form).reasons
    assert "it is a part of the floor" not in says("rug", form).reasons


def test_few_pixels_and_pixels_without_depth_say_nothing():
    view, mask = seen(CHAIR)
    assert measured_form(view, np.zeros_like(mask), box_of(mask)) is None
    blind = view_of([*ROOM, CHAIR], AT, max_depth_m=1.0)
    assert measured_form(blind, mask, box_of(mask)) is None


def test_of_a_long_name_only_the_last_words_are_kept():
    before = canonical.cache_info().misses
    assert kind_shape("word " * 1000 + "easy chair") == kind_shape("armchair")
    assert canonical.cache_info().misses - before < 10


def test_the_table_knows_indoor_kinds_by_all_their_names():
    assert len(KINDS) > 200
    indoor = COCO_CLASSES[COCO_CLASSES.index("chair") :]
    assert [one for one in indoor if kind_shape(one) is None] == []
    assert kind_shape("couch") == kind_shape("sofa")
    assert kind_shape("dining chair") == kind_shape("chair")
    assert kind_shape("spaceship") is None
    for name, kind in KINDS.items():
        assert 0.0 <= kind.height_m[0] < kind.height_m[1], name
        assert 0.0 < kind.long_m[0] < kind.long_m[1], name
