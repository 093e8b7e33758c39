import math
from collections.abc import Callable
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from hypernav.app.show.climbs import StairsMark
from hypernav.app.show.map_images import draw_map, draw_result, write_map_png
from hypernav.core.exploring.overview import Block
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import BlockRecord, StepTrace
from hypernav.search.drawing import map_painter, palette
from hypernav.search.drawing.label_placement import Disc, Square, number_position
from hypernav.search.drawing.map_painter import MapPainter
from hypernav.search.drawing.map_view import MapView, rasterize_map
from hypernav.search.drawing.question_map import draw_question_map
from hypernav.search.drawing.text import text_width


def pixels_near(image: np.ndarray, color: palette.Rgb, tolerance: int = 40) -> np.ndarray:
    """``(u, v)`` of the middles of all pixels of about this colour."""
    far = np.abs(image.astype(int) - np.array(color)).max(axis=2)
    return np.argwhere(far < tolerance)[:, ::-1] + 0.5


def block(number: int, x: float, y: float, size: float = 1.0) -> Block:
    return Block(number, x, y, size, 10, 3, (x + size / 2, y + size / 2), 1.0)


def grid_of_blocks(size: float, columns: int, rows: int) -> list[Block]:
    return [
        block(1 + column + row * columns, -1.0 + column * size, -2.0 + row * size, size)
        for row in range(rows)
        for column in range(columns)
    ]


def test_every_cell_has_its_colour_where_the_view_says(room: OccupancyGrid) -> None:
    view = MapView.fit(room, 500)
    image = rasterize_map(room, view)
    colors = {Cell.UNKNOWN: palette.UNKNOWN, Cell.FREE: palette.FREE}
    colors[Cell.OCCUPIED] = palette.OCCUPIED
    checked = 0
    for row in range(0, 120):
        for column in range(0, 140, 3):
            u, v = view.pixel_of(*room.centre_of(row, column))
            if 0 <= u < 500 and 0 <= v < 500:
                state = Cell(room.cells[row, column])
                assert tuple(image[int(v), int(u)]) == colors[state], (row, column)
                checked += 1
    assert checked > 2000


def test_a_map_that_is_not_square_and_one_of_one_cell_can_be_drawn() -> None:
    for shape in ((1, 1), (1, 300), (300, 1)):
        grid = OccupancyGrid(np.full(shape, Cell.FREE, dtype=np.uint8), 0.05, (3.0, -4.0))
        image = draw_map(grid, size=200)
        assert image.shape == (200, 200, 3)
        assert len(pixels_near(image, palette.FREE, 3)) > 0


def test_an_unexplored_map_is_grey() -> None:
    grid = OccupancyGrid(np.zeros((50, 50), dtype=np.uint8), 0.05, (0.0, 0.0))
    assert (MapPainter(grid, size=128).image == palette.UNKNOWN).all()


def test_a_thin_wall_stays_visible_on_the_map_of_a_huge_building() -> None:
    cells = np.full((3000, 3000), Cell.FREE, dtype=np.uint8)
    cells[1500, :] = Cell.OCCUPIED
    image = rasterize_map(
        OccupancyGrid(cells, 0.05, (-75.0, -75.0)), MapView(-80.0, 80.0, 300 / 160.0, 300)
    )
    column = image[:, 150, :].astype(int).sum(axis=1)
    assert column.min() == sum(palette.OCCUPIED)
    assert len(pixels_near(image, palette.FREE, 3)) > 60_000


@settings(max_examples=30)
@given(st.floats(-math.pi, math.pi), st.floats(-0.5, 2.5), st.floats(-1.5, 0.5))
def test_the_arrow_stands_and_points_where_the_robot_does(yaw: float, x: float, y: float) -> None:
    grid = OccupancyGrid(np.full((60, 80), Cell.FREE, dtype=np.uint8), 0.05, (-1.0, -2.0))
    painter = MapPainter(grid, size=768)
    painter.robot(Pose2(x, y, yaw))
    away = painter.view.to_metres(pixels_near(painter.image, palette.ROBOT)) - np.array([x, y])
    c, s = math.cos(yaw), math.sin(yaw)
    ahead, left = away @ (c, s), away @ (-s, c)
    assert len(away) > 50
    assert abs(left.mean()) < 0.01, "as much on the left as on the right"
    assert ahead.max() > -ahead.min(), "the tip reaches farther than the tail"
    front, back = np.abs(left[ahead > 0.0]).max(), np.abs(left[ahead < 0.0]).max()
    assert front < 0.75 * back, "and is narrower"


def test_what_lies_ahead_left_lies_there_in_the_image(room: OccupancyGrid) -> None:
    view = MapView.fit(room, 400)
    robot = Pose2(1.0, -0.5, math.pi / 2)
    image = draw_map(room, view=view, robot=robot, destination=(0.0, 0.5))
    arrow = pixels_near(image, palette.ROBOT).mean(axis=0)
    mark = pixels_near(image, palette.PATH).mean(axis=0)
    assert mark[0] < arrow[0] - 50, "to the left of a robot that looks up"
    assert mark[1] < arrow[1] - 50, "and ahead of it"
    assert mark == pytest.approx(np.array(view.pixel_of(0.0, 0.5)), abs=1.0)


@given(
    st.floats(0, 500), st.floats(0, 500), st.floats(4, 200),
    st.floats(4, 40), st.floats(4, 30),
    st.floats(0, 500), st.floats(0, 500), st.floats(2, 40),
)  # fmt: skip
def test_a_number_never_touches_the_robot(
    left: float, top: float, side: float, width: float, height: float,
    u: float, v: float, radius: float,
) -> None:  # fmt: skip
    square, robot = Square(left, top, side), Disc(u, v, radius)
    at = number_position(square, width, height, robot)
    nearest = np.clip(
        [u, v],
        [at[0] - width / 2, at[1] - height / 2],
        [at[0] + width / 2, at[1] + height / 2],
    )
    assert math.hypot(nearest[0] - u, nearest[1] - v) >= radius - 1e-6
    if side >= 2 * radius + 2 * max(width, height):
        assert left <= at[0] - width / 2 + 1e-6
        assert at[0] + width / 2 <= left + side + 1e-6
        assert top <= at[1] - height / 2 + 1e-6
        assert at[1] + height / 2 <= top + side + 1e-6


def test_a_number_stands_in_the_middle_when_no_robot_is_near() -> None:
    assert number_position(Square(10, 20, 40), 15, 10, None) == (30, 40)
    assert number_position(Square(10, 20, 40), 15, 10, Disc(300, 300, 20)) == (30, 40)


def test_a_number_avoids_the_destination_where_it_can_and_the_robot_always() -> None:
    square, robot = Square(0, 0, 100), Disc(80, 50, 15)
    u, v = number_position(square, 20, 12, robot, Disc(50, 50, 13))
    assert max(abs(u - 50) - 10, 0) + max(abs(v - 50) - 6, 0) >= 13
    crowded = number_position(square, 20, 12, robot, Disc(50, 50, 200))
    assert crowded == number_position(square, 20, 12, robot)


def test_the_overview_shows_the_whole_arrow_among_sixty_numbers(room: OccupancyGrid) -> None:
    blocks = grid_of_blocks(0.4, 10, 6)
    for x, y in ((0.2, -1.3), (1.0, -0.6), (2.05, 0.15)):
        robot = Pose2(x, y, 0.7)
        with_numbers = draw_question_map(room, blocks, robot, [])
        alone = draw_question_map(room, [], robot, [])
        assert with_numbers.shape == (768, 768, 3)
        assert len(pixels_near(with_numbers, palette.ROBOT, 8)) >= 0.95 * len(
            pixels_near(alone, palette.ROBOT, 8)
        )


def test_the_overview_holds_blocks_that_reach_beyond_the_explored_area(
    room: OccupancyGrid,
) -> None:
    far = block(7, 2.5, 0.5, 2.5)
    image = draw_question_map(room, [far], Pose2(1.0, -0.5, 0.0), [(0.0, -1.0), (1.0, -0.5)])
    outline = pixels_near(image, palette.BLOCK, 12)
    view = MapView.fit(room, 768, points=[(2.5, 0.5), (5.0, 3.0)], margin=0.04)
    left, top = view.pixel_of(2.5, 3.0)
    assert outline[:, 1].min() == pytest.approx(top, abs=2.0)
    assert outline[:, 0].max() == pytest.approx(left + 2.5 * view.pixels_per_m, abs=2.0)


def test_excluded_and_chosen_blocks_look_different(room: OccupancyGrid) -> None:
    blocks = grid_of_blocks(1.0, 3, 2)
    plain = draw_map(room, blocks=blocks)
    excluded = draw_map(room, blocks=blocks, excluded=[2])
    chosen = draw_map(room, blocks=blocks, chosen=2)
    for other in (excluded, chosen):
        view = MapView.fit(room, 768)
        changed = view.to_metres(np.argwhere((plain != other).any(axis=2))[:, ::-1] + 0.5)
        assert len(changed) > 500
        assert changed.min(axis=0) == pytest.approx(np.array([0.0, -2.0]), abs=0.1)
        assert changed.max(axis=0) == pytest.approx(np.array([1.0, -1.0]), abs=0.1)


def test_records_of_blocks_draw_the_same_image_as_blocks(room: OccupancyGrid) -> None:
    blocks = grid_of_blocks(1.0, 3, 2)
    records = [
        BlockRecord(number=b.number, x_min=b.x_min, y_min=b.y_min, size_m=b.size_m) for b in blocks
    ]
    assert (draw_map(room, blocks=blocks) == draw_map(room, blocks=records)).all()


def test_drawing_changes_neither_map_nor_result(room: OccupancyGrid) -> None:
    before = room.cells.copy()
    arguments = (room, grid_of_blocks(1.0, 3, 2), Pose2(0.0, 0.0, 1.0), [(0.0, -1.0), (0.0, 0.0)])
    first = draw_question_map(*arguments)
    assert (first == draw_question_map(*arguments)).all()
    assert (room.cells == before).all()


def test_the_trajectory_darkens_towards_now(room: OccupancyGrid) -> None:
    painter = MapPainter(room, size=400)
    painter.trajectory([(x, -0.5) for x in np.linspace(-0.5, 2.5, 60)])
    start, end = (painter.view.pixel_of(x, -0.5) for x in (-0.4, 2.4))
    early, late = (int(painter.image[int(v), int(u)].sum()) for u, v in (start, end))
    assert late < early < sum(palette.FREE)


def test_what_lies_outside_the_image_is_cut_off(room: OccupancyGrid) -> None:
    far = [(1e6, 1e6), (-1e6, 1e6), (0.0, -1e6)]
    image = draw_map(
        room,
        size=200,
        robot=Pose2(1e6, 0.0, 0.0),
        trajectory=far,
        path=[(0.0, 0.0), (30.0, 0.0)],
        destination=(1e6, 0.0),
        goal_area=[far],
        blocks=[block(1, 1e5, 1e5)],
        excluded=[1],
    )
    assert image.shape == (200, 200, 3)


@pytest.mark.parametrize("points", [[], [(0.0, 0.0)], [(0.0, 0.0), (0.0, 0.0)]])
def test_lines_of_no_length_are_no_problem(
    room: OccupancyGrid, points: list[tuple[float, float]]
) -> None:
    image = draw_map(room, size=100, trajectory=points, path=points, goal_area=[points])
    assert image.shape == (100, 100, 3)


def test_the_map_on_disk_has_map_and_legend(
    room: OccupancyGrid, make_step: Callable[..., StepTrace], tmp_path: Path
) -> None:
    steps = [make_step(n) for n in range(5)]
    path = write_map_png(tmp_path / "new" / "map.png", room, steps, size=300)
    image = np.asarray(Image.open(path))
    assert image.shape[1] == 300
    assert image.shape[0] > 300
    assert (image[:300] == draw_result(room, steps, size=300)).all()
    assert (image[300:] != palette.PAPER).any()
    empty = write_map_png(tmp_path / "empty.png", room, [], size=300)
    assert np.asarray(Image.open(empty)).shape == image.shape


def test_stairs_are_marked_where_they_begin(room: OccupancyGrid) -> None:
    view = MapView.fit(room, 500)
    marked = draw_map(room, view=view, stairs=[StairsMark((1.0, -0.5), "to floor 2")])
    near = pixels_near(marked, palette.STAIRS, tolerance=5)
    distances = np.linalg.norm(near - view.pixel_of(1.0, -0.5), axis=1)
    assert distances.min() < 5.0
    assert len(pixels_near(draw_map(room, view=view), palette.STAIRS, tolerance=5)) == 0


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> dict[str, tuple[float, float]]:
    """Where the words of maps are written, pixels."""
    written = dict[str, tuple[float, float]]()

    def note(image: object, text: str, at: tuple[float, float], *_: object, **__: object) -> None:
        written[text] = at

    monkeypatch.setattr(map_painter, "draw_text", note)
    return written


def test_the_words_of_two_flights_at_one_landing_are_apart(
    room: OccupancyGrid, written: dict[str, tuple[float, float]]
) -> None:
    places = {"to floor 1": (1.0, -0.5), "to floor 3": (1.1, -0.5), "to floor 4": (1.0, -0.4)}
    marks = [StairsMark(position, words) for words, position in places.items()]
    draw_map(room, size=500, stairs=marks)
    size, width = round(20 * 500 / 768), text_width("to floor 1", 13, bold=True)
    for one, other in combinations(places, 2):
        (u, v), (u_other, v_other) = written[one], written[other]
        assert abs(u - u_other) >= width or abs(v - v_other) >= size


def test_the_words_of_stairs_lie_beside_the_trajectory(
    room: OccupancyGrid, written: dict[str, tuple[float, float]]
) -> None:
    view, mark = MapView.fit(room, 500), StairsMark((0.5, -0.5), "up to floor 2")
    u, v = view.pixel_of(*mark.position)
    for along in (1.0, -1.0):
        draw_map(room, view=view, stairs=[mark], trajectory=[mark.position, (0.5 + along, -0.5)])
        at_u, at_v = written[mark.words]
        assert (at_u - u) * along < 0.0 or abs(at_v - v) > 8.0
