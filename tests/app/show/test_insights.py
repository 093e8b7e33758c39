"""What an explorer looked at, drawn for people."""

import numpy as np

from hypernav.app.show.map_images import draw_graph, draw_values
from hypernav.app.show.video_frame import draw_insight
from hypernav.core.exploring.insight import (
    ImageMark,
    ImageWindow,
    Insight,
    RememberedThing,
    ThingGraph,
    ValueImage,
)
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.search.drawing import palette
from hypernav.search.drawing.map_painter import MapPainter
from hypernav.search.drawing.map_view import MapView
from hypernav.search.drawing.shapes import ArrowStyle, draw_arrows, foot_pixel

GREY = np.full((240, 320, 3), 120, np.uint8)
CAMERA = PinholeCamera.from_hfov(320, 240, 79.0)


def changed(image, u, v, reach=3):
    part = image[int(v) - reach : int(v) + reach + 1, int(u) - reach : int(u) + reach + 1]
    return (part != 120).any()


def test_each_mark_is_drawn_where_it_lies_and_the_image_stays():
    marks = {1: (40.0, 200.0), 2: (200.0, 150.0)}
    drawn = draw_arrows(GREY, marks, (160.0, 240.0), ArrowStyle())
    assert (GREY == 120).all()
    assert all(changed(drawn, *pixel) for pixel in marks.values())
    assert changed(drawn, 180.0, 195.0, 2)  # the line to the second
    alone = draw_arrows(GREY, marks, (160.0, 240.0), ArrowStyle(shafts=False))
    assert not changed(alone, 180.0, 195.0, 2)


def test_turning_is_offered_at_the_left_edge():
    drawn = draw_arrows(GREY, {}, (160.0, 240.0), ArrowStyle(), may_turn=True)
    assert changed(drawn, 11.0, 120.0)
    assert not changed(drawn, 200.0, 120.0, 60)


def test_the_foot_of_a_camera_that_looks_down_lies_below_its_image():
    u, v = foot_pixel(CAMERA, optical_to_base(1.5, 45.0))
    assert abs(u - 160.0) < 1e-6
    assert 240.0 < v < 1000.0
    assert foot_pixel(CAMERA, optical_to_base(0.88)) == (160.0, 240.0)


def test_what_was_chosen_is_orange():
    marks = [ImageMark(number=n, pixel=(60.0 * n, 100.0), chosen=n == 2) for n in (1, 2)]
    drawn = draw_insight(GREY, Insight(marks=marks, foot=(160.0, 240.0)))

    def orange(u):
        return (drawn[94:107, u - 6 : u + 7] == palette.CHOSEN).all(axis=-1).any()

    assert orange(120)
    assert not orange(60)
    window = ImageWindow(box=(50, 40, 150, 140), label="left")
    shown = draw_insight(GREY, Insight(window=window))
    assert changed(shown, 100.0, 90.0)
    assert not changed(shown, 250.0, 90.0)


def test_remembered_things_are_dots_joined_where_near_and_named_where_told():
    grid = OccupancyGrid(np.ones((100, 100), np.uint8), 0.05, (0.0, 0.0))
    painter = MapPainter(grid, view=MapView(left_m=0.0, top_m=5.0, pixels_per_m=50.0, size=250))
    before = painter.image.copy()
    things = [
        RememberedThing(label="bed", position=(1.0, 4.0), told=True),
        RememberedThing(label="nightstand", position=(2.0, 4.0)),
        RememberedThing(label="oven", position=(4.0, 1.0)),
    ]
    draw_graph(painter, ThingGraph(things=things, near=[(0, 1)]))
    for thing in things[1:]:
        u, v = (round(at) for at in painter.view.pixel_of(*thing.position))
        assert (painter.image[v, u] == palette.BLOCK).all()
    touched = (painter.image != before).any(axis=-1)
    assert touched[50, 65:90].any()  # the line between the two that are near
    assert not touched[60:190].any()  # the oven stands alone
    assert touched[40:60, 35:65].sum() > touched[190:210, 190:210].sum()  # the name of the bed


def test_values_are_tinted_where_they_lie_with_y_up():
    values = np.full((10, 10), np.nan, np.float32)
    values[2, 7], values[8, 1] = 0.9, 0.1
    image = np.full((200, 200, 3), 120, np.uint8)
    view = MapView(left_m=-1.0, top_m=3.0, pixels_per_m=50.0, size=200)
    draw_values(image, view, ValueImage.of(values, (0.0, 0.0), 0.2))
    high, low = view.pixel_of(1.5, 0.5), view.pixel_of(0.3, 1.7)
    yellow = image[int(high[1]), int(high[0])].astype(int)
    blue = image[int(low[1]), int(low[0])].astype(int)
    assert yellow[0] > 120 > yellow[2]
    assert blue[2] > 120 > blue[0]
    assert not changed(image, *view.pixel_of(0.9, 1.1), 2)
    edge = view.pixel_of(1.4, 0.5)
    assert (image[int(edge[1]), int(edge[0]) - 1] == 120).all()
    assert (image[int(edge[1]), int(edge[0]) + 1] != 120).any()
