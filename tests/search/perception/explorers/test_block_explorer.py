import re
from dataclasses import replace

import numpy as np

from certainty import certain
from exploration_views import exploration_view
from hypernav.core.components.abilities import answers_at_once
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.overview import BlockChoice
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.memory.floor import SearchMemory
from hypernav.search.memory.memory import Memory
from hypernav.search.perception.config import OverviewConfig
from hypernav.search.perception.explorers.block_explorer import BlockExplorer
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.rivals.nearest_frontier import NearestFrontierExplorer

HERE = Pose2(0.0, 0.0, 0.0)
CLEARANCES_M = (0.22, 0.18)


def hall(length_m=8.0, width_m=2.0):
    """A free hall along x with walls on both sides, open into the unknown at both ends."""
    columns, rows = round(length_m / 0.05) + 40, round(width_m / 0.05) + 40
    cells = np.zeros((rows, columns), dtype=np.uint8)
    cells[20:-20, 20:-20] = Cell.FREE
    cells[19, 20:-20] = cells[-20, 20:-20] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-length_m / 2 - 1.0, -width_m / 2 - 1.0))


class Insists:
    """Names blocks from a list, whatever is excluded; notes what was excluded."""

    def __init__(self, *numbers):
        self._numbers = list(numbers)
        self.excluded = []

    def choose(self, overview, goal, excluded):
        self.excluded.append(set(excluded))
        return BlockChoice(self._numbers.pop(0), "because")


class InOrder:
    """Names the blocks in their order; notes what was excluded."""

    def __init__(self):
        self.excluded = []

    def choose(self, overview, goal, excluded):
        self.excluded.append(set(excluded))
        left = [block.number for block in overview.blocks if block.number not in excluded]
        return BlockChoice(left[0] if left else None, "because")


class Declines:
    """Names no block."""

    def choose(self, overview, goal, excluded):
        return BlockChoice(None, "nothing is left")


def blocks_explorer(reasoner, clearances_m=CLEARANCES_M, **config):
    return BlockExplorer(
        reasoner, OverviewConfig(**config), MappingConfig(), clearances_m, Embodiment()
    )


def next_of(explorer, search=None, *, grid=None, robot=HERE, been=None):
    """Where an explorer goes; `search` holds what was visited, `been` where the robot was."""
    view = exploration_view(hall() if grid is None else grid, robot, search, trajectory=been)
    return explorer.next_destination(view)


def visiting(*positions):
    """A search in which positions were visited."""
    return SearchMemory(visits=list(positions))


POSITIONS = {"visited": "positions", "max_questions": None, "forget_visits": True}
"""The memory of the paper."""


def test_the_chosen_block_is_the_destination():
    destination = certain(next_of(blocks_explorer(Insists(1))))
    block = next(b for b in destination.blocks if b.number == 1)
    assert destination.xy == block.destination
    assert destination.reason == "because"


def test_only_a_reasoner_that_answers_at_once_is_asked_again_on_the_way():
    assert answers_at_once(blocks_explorer(GeometricReasoner(ExchangeLog())))
    assert not answers_at_once(blocks_explorer(InOrder()))


def test_a_visited_block_is_excluded_and_asked_about_again():
    first = certain(next_of(blocks_explorer(Insists(1))))
    reasoner = Insists(1, 2)
    second = certain(next_of(blocks_explorer(reasoner), visiting(first.xy)))
    assert reasoner.excluded == [set(), {1}]
    assert second.xy != first.xy


def test_a_reasoner_that_insists_on_visited_blocks_ends_the_search_of_blocks():
    explorer = blocks_explorer(Insists(1, 1, 1, 1), last_frontier_m=None)
    first = certain(next_of(explorer))
    explorer = replace(explorer, reasoner=Insists(1, 1, 1, 1))
    assert next_of(explorer, visiting(first.xy)) is None


def test_a_new_search_forgets_visits():
    explorer = blocks_explorer(Insists(1, 1))
    first = certain(next_of(explorer))
    memory = Memory(MappingConfig(), Embodiment())
    memory.search.visits.append(first.xy)
    memory.begin_search()
    again = certain(next_of(explorer, memory.search))
    assert again.xy == first.xy


def test_where_the_robot_has_been_is_visited_wherever_it_was_going():
    blocks = certain(next_of(blocks_explorer(Insists(1)))).blocks
    reasoner = InOrder()
    explorer = blocks_explorer(reasoner, **POSITIONS)
    been = [blocks[0].destination, blocks[1].destination, HERE.xy]
    destination = certain(next_of(explorer, been=been))
    assert destination.xy == blocks[2].destination
    assert reasoner.excluded == [set(), {1}, {1, 2}]


def test_the_latest_destination_is_not_the_next_one():
    explorer, search = blocks_explorer(InOrder(), **POSITIONS), SearchMemory()
    first, second = (certain(next_of(explorer, search)) for _ in range(2))
    assert first.xy == second.xy
    search.visits.append(first.xy)
    third = certain(next_of(explorer, search))
    assert third.xy != first.xy
    search.visits.append(third.xy)
    assert certain(next_of(explorer, search)).xy == first.xy


def test_who_remembers_nothing_goes_where_it_was():
    explorer = blocks_explorer(InOrder(), visited="none")
    first = certain(next_of(explorer))
    again = certain(next_of(explorer, visiting(first.xy), been=[HERE.xy, first.xy]))
    assert again.xy == first.xy


def test_when_all_is_visited_visits_are_forgotten_but_for_where_the_robot_is():
    reasoner, search = InOrder(), SearchMemory()
    explorer = blocks_explorer(reasoner, (0.22,), **POSITIONS)
    first = certain(next_of(explorer, search))
    been = [block.destination for block in first.blocks]
    reasoner.excluded.clear()
    again = certain(next_of(explorer, search, been=been))
    assert again.xy == first.xy
    assert len(reasoner.excluded) == len(been) + 1
    # What was forgotten stays forgotten; what was visited since counts.
    been.append(first.xy)
    assert certain(next_of(explorer, search, been=been)).xy == first.blocks[1].destination


def test_where_the_only_block_is_the_robots_own_there_is_nowhere_to_go():
    grid = hall(length_m=1.0, width_m=1.0)
    explorer = blocks_explorer(InOrder(), (0.22,), visited_radius_m=5.0, **POSITIONS)
    assert next_of(explorer, grid=grid) is None


def test_where_no_block_is_left_the_frontiers_are_visited():
    explorer, search = blocks_explorer(Declines()), SearchMemory()
    near_left = Pose2(-2.5, 0.0, 0.0)
    first = certain(next_of(explorer, search, robot=near_left))
    assert first.x < -3.5
    assert re.fullmatch(r"no block is left; frontier: 2.0 m long, 1.\d m away", first.reason)
    assert not first.blocks
    search.visits.append(first.xy)
    second = certain(next_of(explorer, search, robot=near_left))
    assert second.x > 3.5
    search.visits.append(second.xy)
    assert next_of(explorer, search, robot=near_left) is None


def test_where_no_block_is_left_the_end_of_a_corridor_comes_before_a_gap_near_by():
    grid = hall(length_m=8.0)
    cells = grid.cells.copy()
    cells[:, 19] = Cell.OCCUPIED  # the end near the robot, all but a gap of 0.5 m
    cells[35:45, 19] = Cell.UNKNOWN
    grid = OccupancyGrid(cells, grid.resolution_m, grid.origin)
    there = certain(next_of(blocks_explorer(Declines()), robot=Pose2(-1.5, 0.0, 0.0), grid=grid))
    assert there.x > 3.5


def test_a_boundary_that_the_edges_of_blocks_cut_to_pieces_is_visited():
    # 0.5 m of boundary, half of it in either of two blocks: each is too short for the reasoner.
    grid = hall(width_m=4.0)
    cells = grid.cells.copy()
    cells[20:-20, 19] = cells[20:-20, -20] = Cell.OCCUPIED
    cells[55:65, -20] = Cell.UNKNOWN
    grid = OccupancyGrid(cells, grid.resolution_m, grid.origin)
    destinations = [
        next_of(
            blocks_explorer(GeometricReasoner(ExchangeLog()), last_frontier_m=last_m), grid=grid
        )
        for last_m in (None, 0.25)
    ]
    assert destinations[0] is None
    assert certain(destinations[1]).x > 3.5


def test_the_nearest_frontier_is_chosen_and_written_down():
    log = ExchangeLog()
    explorer, search = NearestFrontierExplorer(log, MappingConfig(), CLEARANCES_M), SearchMemory()
    near_left = Pose2(-2.5, 0.0, 0.0)
    destination = certain(next_of(explorer, search, robot=near_left))
    assert destination.x < -3.5
    (exchange,) = log.drain()
    assert (exchange.kind, exchange.asked) == ("choose frontier", "geometric")
    search.visits.append(destination.xy)
    assert certain(next_of(explorer, search, robot=near_left)).x > 3.5


def test_an_explored_map_leaves_nothing_to_choose():
    grid = hall()
    closed = grid.cells.copy()
    closed[19:-19, 19] = closed[19:-19, -20] = Cell.OCCUPIED
    closed[19:-19, 20:-20][closed[19:-19, 20:-20] == Cell.UNKNOWN] = Cell.OCCUPIED
    grid = OccupancyGrid(closed, grid.resolution_m, grid.origin)
    explorer = NearestFrontierExplorer(ExchangeLog(), MappingConfig(), CLEARANCES_M)
    assert next_of(explorer, grid=grid) is None
