import threading
from collections.abc import Sequence

import numpy as np
import pytest

from hypernav.core.components.abilities import Prefetches
from hypernav.core.components.protocols import Explorer
from hypernav.core.destination import Destination
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Exchange, ExchangeLog
from hypernav.perception.explorers.prefetch import PrefetchConfig, PrefetchingExplorer

GRID = OccupancyGrid(np.full((200, 200), Cell.FREE, dtype=np.uint8), 0.05, (-5.0, -5.0))
NEAR, FAR = Pose2(0.5, 0.0, 0.0), Pose2(-3.0, 0.0, 0.0)
GOING = Destination(1.0, 0.0, "first")


class Slow:
    """Chooses positions from a list, once it is let; logs every question."""

    def __init__(self, log: ExchangeLog, *says: Destination | Exception | None) -> None:
        self.log = log
        self.says = list(says)
        self.let = threading.Event()
        self.let.set()
        self.visited: list[tuple[float, float]] = []
        self.grids: list[OccupancyGrid] = []

    def reset(self, goal: Goal) -> None:
        self.visited = []

    def remember_visit(self, x: float, y: float) -> None:
        self.visited.append((x, y))

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        assert self.let.wait(10.0)
        self.grids.append(grid)
        self.log.record(Exchange(kind="choose block", asked="m", question="?", answer="!"))
        said = self.says.pop(0)
        if isinstance(said, Exception):
            raise said
        return said


def ahead(*says: Destination | Exception | None, **settings: float):
    own, log = ExchangeLog(), ExchangeLog()
    slow = Slow(own, *says)
    config = PrefetchConfig.model_validate({"enabled": True, **settings})
    return PrefetchingExplorer(slow, own, log, config), slow, log


def test_it_is_an_explorer_that_thinks_ahead():
    explorer, *_ = ahead()
    assert isinstance(explorer, Explorer)
    assert isinstance(explorer, Prefetches)


def test_the_answer_is_there_when_the_robot_arrives():
    following = Destination(2.0, 1.0, "second")
    explorer, slow, log = ahead(following)
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)] * 2, GOING)
    assert log.drain() == []
    assert explorer.next_destination(GRID, NEAR, [(0.0, 0.0)] * 3) is following
    (told,) = log.drain()
    assert told.remarks == ["asked ahead"]
    assert slow.visited == [GOING.xy]


def test_the_robot_drives_on_while_the_model_thinks():
    explorer, slow, log = ahead(Destination(2.0, 1.0, "second"))
    slow.let.clear()
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    assert log.drain() == []
    slow.let.set()
    assert explorer.next_destination(GRID, NEAR, [(0.0, 0.0)] * 2) is not None


def test_far_from_the_destination_nothing_is_asked():
    explorer, slow, log = ahead(Destination(2.0, 1.0, "second"))
    explorer.prefetch(GRID, FAR, [(0.0, 0.0)], GOING)
    assert slow.visited == []
    assert explorer.next_destination(GRID, FAR, [(0.0, 0.0)]) is not None
    assert log.drain()[0].remarks == []


def test_an_old_answer_is_paid_for_but_not_used():
    old, new = Destination(2.0, 1.0, "old"), Destination(2.0, -1.0, "new")
    explorer, _, log = ahead(old, new, good_for_steps=3)
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    assert explorer.next_destination(GRID, NEAR, [(0.0, 0.0)] * 9) is new
    assert [one.remarks for one in log.drain()] == [["asked ahead, not used"], []]


def test_a_place_that_turned_out_to_be_a_wall_is_not_used():
    wall, new = Destination(2.0, 1.0, "wall"), Destination(2.0, -1.0, "new")
    explorer, *_ = ahead(wall, new)
    cells = GRID.cells.copy()
    grid = OccupancyGrid(cells, GRID.resolution_m, GRID.origin)
    explorer.prefetch(grid, NEAR, [(0.0, 0.0)], GOING)
    cells[grid.cell_of(2.0, 1.0)] = Cell.OCCUPIED
    assert explorer.next_destination(grid, NEAR, [(0.0, 0.0)] * 2) is new


def test_it_thinks_about_the_map_as_it_was_when_asked():
    explorer, slow, _ = ahead(Destination(2.0, 1.0, "second"))
    cells = GRID.cells.copy()
    slow.let.clear()
    explorer.prefetch(OccupancyGrid(cells, 0.05, (-5.0, -5.0)), NEAR, [(0.0, 0.0)], GOING)
    cells[:] = Cell.UNKNOWN
    slow.let.set()
    explorer.next_destination(GRID, NEAR, [(0.0, 0.0)] * 2)
    assert (slow.grids[0].cells == Cell.FREE).all()


def test_an_outage_shows_when_the_answer_is_needed():
    explorer, *_ = ahead(ModelUnavailableError("gone"))
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    with pytest.raises(ModelUnavailableError, match="gone"):
        explorer.next_destination(GRID, NEAR, [(0.0, 0.0)] * 2)


def test_a_new_search_forgets_what_was_asked():
    new = Destination(2.0, -1.0, "new")
    explorer, slow, log = ahead(Destination(2.0, 1.0, "old"), new)
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    explorer.reset(Goal("bed"))
    assert slow.visited == []
    assert explorer.next_destination(GRID, NEAR, [(0.0, 0.0)]) is new
    assert [one.remarks for one in log.drain()] == [[]]


@pytest.mark.parametrize("said", [Destination(2.0, 1.0, "late"), ModelUnavailableError("gone")])
def test_closing_leaves_no_thread_behind(said):
    before = set(threading.enumerate())
    explorer, *_ = ahead(said)
    explorer.prefetch(GRID, NEAR, [(0.0, 0.0)], GOING)
    (thread,) = set(threading.enumerate()) - before
    explorer.close()
    assert not thread.is_alive()
