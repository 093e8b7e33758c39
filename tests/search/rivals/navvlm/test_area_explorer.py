"""NavVLM's areas, turns and frontiers."""

import math
from dataclasses import replace

import numpy as np
import pytest

from arrow_views import HERE, room_with_wall
from certainty import certain
from chat_models import Parrot
from exploration_views import exploration_view
from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.exploring.guidance import Direction, GuideChoice, GuideView
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.rivals.config import AreaConfig
from hypernav.search.rivals.navvlm.area_explorer import AreaExplorer, _largest_piece
from hypernav.search.rivals.navvlm.guides import ChatGuide, TruthGuide, direction_in
from images import thing_before_wall

ROBOT = Embodiment(camera=CameraConfig(width=320, height=240))


def hall():
    """Free floor around the robot up to a wall 3 m ahead, open into the unknown behind."""
    cells = np.zeros((200, 200), dtype=np.uint8)
    cells[40:160, 60:160] = Cell.FREE
    cells[40:160, 160] = Cell.OCCUPIED
    cells[39, 60:161] = cells[160, 60:161] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-5.0, -5.0))


class Points:
    """Says one direction after the other, the last again and again; notes what it was shown."""

    def __init__(self, *directions):
        self.left, self.views = list(directions), []

    def direct(self, view, goal):
        self.views.append(view)
        return GuideChoice(self.left.pop(0) if len(self.left) > 1 else self.left[0], "because")


def explorer_of(guide):
    return AreaExplorer(guide, ExchangeLog(), ROBOT, MappingConfig(), (0.2,))


def next_of(explorer, search=None, *, robot=HERE, grid=None):
    view = exploration_view(grid or hall(), room_with_wall(3.0, robot=robot), search)
    return certain(explorer.next_destination(view))


@pytest.mark.parametrize(
    ("direction", "side"), [(Direction.LEFT, 1), (Direction.RIGHT, -1), (Direction.STRAIGHT, 0)]
)
def test_what_the_image_shows_in_a_direction_is_gone_to(direction, side):
    area = next_of(explorer_of(Points(direction)))
    assert 2.0 < area.x < 3.0
    assert np.sign(area.y) * (abs(area.y) > 0.4) == side
    assert area.holds
    assert (area.arrival_m, area.most_steps) == (0.8, 10)


@pytest.mark.parametrize("scale", [0.25, 0.5, 1.0])
def test_the_labelled_squares_are_those_of_the_original_in_an_image_of_any_size(scale):
    camera = CameraConfig(width=round(640 * scale), height=round(480 * scale))
    guide = Points(Direction.LEFT)
    view = exploration_view(hall(), room_with_wall(3.0, camera=camera))
    area = certain(explorer_of(guide).next_destination(view))
    columns = {
        Direction.LEFT: (60, 260),
        Direction.STRAIGHT: (220, 420),
        Direction.RIGHT: (380, 580),
    }
    windows = {name: (one.start, one.stop) for name, one in guide.views[0].windows.items()}
    assert windows == {name: (a * scale, b * scale) for name, (a, b) in columns.items()}
    box = certain(certain(area.insight).window).box
    assert box == pytest.approx(np.array([60, 140, 260, 340]) * scale)


def test_where_nothing_leads_there_it_turns_right_and_then_goes_to_a_frontier(monkeypatch):
    monkeypatch.setattr("hypernav.search.rivals.navvlm.area_explorer._TURNS", 3)
    guide = Points(Direction.EXPLORE)
    explorer, search = explorer_of(guide), SearchMemory()
    for _ in range(3):
        turn = next_of(explorer, search)
        search.visits.append(turn.xy)
        assert turn.xy == HERE.xy
        assert turn.face == pytest.approx(-math.pi / 6)
    frontier = next_of(explorer, search)
    assert frontier.face is None
    assert "nearest frontier" in frontier.reason
    assert next_of(explorer, search).face is not None  # it asks, and turns, anew


def test_an_area_that_was_reached_is_none(monkeypatch):
    monkeypatch.setattr("hypernav.search.rivals.navvlm.area_explorer._TURNS", 0)
    explorer = explorer_of(Points(Direction.STRAIGHT))
    area = next_of(explorer)
    reached = SearchMemory(visits=[area.xy])
    assert "nearest frontier" in next_of(explorer, reached).reason
    assert next_of(explorer, SearchMemory()).xy == area.xy
    at_wall = Pose2(2.4, 0.0, 0.0)
    assert "nearest frontier" in next_of(explorer, robot=at_wall).reason  # it is there already


@pytest.mark.parametrize(("from_m", "is_gone_to"), [(2.6, True), (1.4, False)])
def test_an_area_is_gone_to_only_if_floor_near_it_can_be_reached(monkeypatch, from_m, is_gone_to):
    """The image looks over a low wall across the hall, which nothing leads around."""
    monkeypatch.setattr("hypernav.search.rivals.navvlm.area_explorer._TURNS", 0)
    grid = hall()
    _, column = grid.cell_of(from_m, 0.0)
    grid.cells[40:160, column] = Cell.OCCUPIED
    area = next_of(explorer_of(Points(Direction.STRAIGHT)), grid=grid)
    assert ("frontier" not in area.reason) == is_gone_to
    assert area.x < from_m


def test_an_image_without_depth_has_no_areas(monkeypatch):
    monkeypatch.setattr("hypernav.search.rivals.navvlm.area_explorer._TURNS", 0)
    explorer = explorer_of(Points(Direction.STRAIGHT))
    seen = room_with_wall(3.0)
    seen.depth[:] = 0.0
    destination = certain(explorer.next_destination(exploration_view(hall(), seen)))
    assert "frontier" in destination.reason


def test_the_past_is_shown_from_the_second_choice_on():
    guide = Points(Direction.EXPLORE)
    explorer, search = explorer_of(guide), SearchMemory()
    next_of(explorer, search)
    next_of(explorer, search)
    first, second = guide.views
    assert len(first.images) == 1
    assert second.images[1].shape == (480, 640 + 480, 3)


@pytest.mark.parametrize(
    ("says", "direction"),
    [
        ("Left.", Direction.LEFT),
        ("left or right", Direction.LEFT),
        ("go right", Direction.RIGHT),
        ("straight ahead", Direction.STRAIGHT),
        ("explore more, perhaps left", Direction.EXPLORE),
        ("I cannot see a bed on the left", Direction.EXPLORE),
        ("hm", Direction.EXPLORE),
    ],
)
def test_answers_are_read_by_their_words_in_the_order_of_the_original(says, direction):
    assert direction_in(says) is direction


def test_a_model_is_asked_for_the_way_to_the_goal():
    log, chat = ExchangeLog(), Parrot("to the left")
    view = GuideView(room_with_wall(), {})
    assert ChatGuide(chat, log).direct(view, Goal("the oven")).direction is Direction.LEFT
    assert "find an oven" in chat.asked[0].text
    assert "second" not in chat.asked[0].text
    later = replace(view, draw_past=lambda: np.zeros((2, 2, 3), np.uint8))
    ChatGuide(chat, log).direct(later, Goal("the oven"))
    assert "second" in chat.asked[1].text
    assert len(chat.asked[1].images) == 2
    assert [one.kind for one in log.drain()] == ["choose direction"] * 2


def test_the_stand_in_points_to_the_likely_room():
    seen = thing_before_wall(box=(10, 20, 50, 100), label=ObjectLabel("nightstand"))
    windows = {Direction.LEFT: slice(0, 60), Direction.RIGHT: slice(100, 160)}
    guide = TruthGuide(ExchangeLog())
    assert guide.direct(GuideView(seen, windows), Goal("pillow")).direction is Direction.LEFT
    assert guide.direct(GuideView(seen, windows), Goal("oven")).direction is Direction.EXPLORE
    alike = {Direction.LEFT: slice(0, 60), Direction.RIGHT: slice(0, 60)}
    assert guide.direct(GuideView(seen, alike), Goal("oven")).direction is Direction.EXPLORE
    nothing = replace(seen, truth=LabelledPixels(certain(seen.truth).ids, {}))
    assert guide.direct(GuideView(nothing, windows), Goal("oven")).direction is Direction.EXPLORE


@pytest.mark.parametrize(("clear_rows", "rows"), [(False, {20, 21, 22}), (True, {21, 22})])
def test_a_row_with_anything_besides_the_largest_piece_may_be_dropped(clear_rows, rows):
    grid = OccupancyGrid(np.zeros((60, 60), np.uint8), 0.05, (0.0, 0.0))
    cells = [(row, column) for row in (20, 21, 22) for column in range(10, 16)] + [(20, 40)]
    points = np.array([grid.centre_of(row, column) for row, column in cells])
    kept = _largest_piece(grid, points, AreaConfig(clear_rows=clear_rows))
    assert set(kept[:, 0].tolist()) == rows
    assert kept[:, 1].max() == 15
