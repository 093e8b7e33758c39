"""The question where to go shows all floors that the robot knows a way to, and leads there."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from certainty import certain
from chat_models import Parrot
from exploration_views import exploration_view
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import (
    Destination,
    ExplorationView,
    StairsDestination,
)
from hypernav.core.exploring.floors import Drop, KnownFloor, WayOut
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.search.drawing.question_map import QuestionStyle
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.perception.config import OverviewConfig
from hypernav.search.perception.explorers.block_explorer import BlockExplorer
from hypernav.search.perception.explorers.floor_panels import FloorPanel, draw_floors
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import VlmReasoner

UP = WayOut(0, 3.0, 0.0, "stairs up", axis=0.0, to=1)
DOWN = WayOut(1, 3.0, 0.0, "stairs down", axis=0.0, to=0)
FARTHER_UP = WayOut(2, -3.0, 0.0, "stairs up", axis=np.pi)
NEW_DOWN = WayOut(3, 0.0, 0.5, "stairs down", axis=np.pi / 2.0)


def hall() -> OccupancyGrid:
    """A free hall of 8 by 2 m, open into the unknown at both ends."""
    cells = np.zeros((80, 200), dtype=np.uint8)
    cells[20:-20, 20:-20] = Cell.FREE
    cells[19, 20:-20] = cells[-20, 20:-20] = Cell.OCCUPIED
    return OccupancyGrid(cells, 0.05, (-5.0, -2.0))


ABOVE = KnownFloor(
    number=1,
    above_m=3.0,
    grid=hall(),
    trajectory=[(2.7, 0.0)],
    visits=[],
    things=[],
    stairs=[DOWN, FARTHER_UP],
    way=(UP,),
    arrival=(2.7, 0.0),
)


def view(*elsewhere: KnownFloor, ways_out: tuple[WayOut, ...] = ()) -> ExplorationView:
    seen = exploration_view(hall(), Pose2(0.0, 0.0, 0.0))
    return replace(seen, elsewhere=elsewhere, ways_out=ways_out)


def answered(
    view: ExplorationView, answer: str, **config: Any
) -> tuple[Destination | StairsDestination, Parrot]:
    """Where a model sends the robot, and the model with what it was asked."""
    model, log = Parrot(answer), ExchangeLog()
    chooser = VlmReasoner(model, log, GeometricReasoner(log))
    asked = OverviewConfig(**config)
    explorer = BlockExplorer(chooser, asked, MappingConfig(), (0.22,), Embodiment())
    return certain(explorer.next_destination(view)), model


def stairs_answered(view: ExplorationView, answer: str) -> StairsDestination:
    """The stairs that a model sends the robot to."""
    destination, _ = answered(view, answer)
    assert isinstance(destination, StairsDestination)
    return destination


def line_of(model: Parrot, words: str) -> str:
    """The first line of the question about blocks that says these words."""
    lines = model.asked[0].text.splitlines()
    return next(one for one in lines if one.startswith("- block") and words in one)


def number_in(line: str) -> str:
    return line.removeprefix("- block ").partition(":")[0]


def test_each_floor_is_a_panel_with_a_title():
    alone = answered(view(), "1")[1].asked[0].images[0]
    stairs = answered(view(ways_out=(NEW_DOWN,)), "1")[1].asked[0].images[0]
    both = answered(view(ABOVE), "1")[1].asked[0].images[0]
    assert alone.shape == (756, 756, 3)
    assert stairs.shape[0] > 756
    assert stairs.shape[1] == 756
    assert both.shape[0] == stairs.shape[0]
    assert both.shape[1] > 2 * 756


def test_the_lowest_floor_is_on_the_left():
    above = answered(view(ABOVE), "1")[1].asked[0].images[0]
    below = answered(view(replace(ABOVE, above_m=-3.0)), "1")[1].asked[0].images[0]
    arrows = [np.all(one == (213, 94, 0), axis=2).nonzero()[1].mean() for one in (above, below)]
    assert arrows[0] < 756 < arrows[1]


def test_stairs_with_the_same_words_are_named_each_at_its_place():
    left = replace(DOWN, connector=4, x=-3.5)

    def drawn(*stairs: WayOut) -> np.ndarray:
        floor = replace(ABOVE, stairs=stairs)
        return draw_floors([FloorPanel(floor, (), np.empty((0, 2)))], QuestionStyle(), size=756)

    right = replace(left, connector=5, x=2.0)
    both = drawn(left, right)
    assert np.array_equal(both[:, :378], drawn(left)[:, :378])
    assert np.array_equal(both[:, 378:], drawn(right)[:, 378:])


def test_the_words_for_one_floor_stay():
    alone, several = (answered(one, "1")[1].asked[0].text for one in (view(), view(ABOVE)))
    assert "one floor of the building" not in alone
    assert "one floor of the building" in several


def test_numbers_go_on_over_the_floors():
    model = answered(view(ABOVE, ways_out=(NEW_DOWN,)), "1")[1]
    numbers = [number_in(one) for one in model.asked[0].text.splitlines() if "- block" in one]
    assert len(set(numbers)) == len(numbers)
    assert [int(one) for one in numbers] == sorted(map(int, numbers))
    assert "on floor 2, 3.0 m higher" in line_of(model, f"- block {numbers[-2]}")
    assert "stairs up to another floor; on floor 2" in line_of(model, f"- block {numbers[-1]}")


def test_new_stairs_are_a_choice():
    seen = view(ways_out=(NEW_DOWN,))
    number = number_in(line_of(answered(seen, "1")[1], "stairs down to another floor"))
    destination = stairs_answered(seen, f"It is downstairs.\nAnswer: {number}")
    assert destination.connector == NEW_DOWN.connector
    assert destination.then is None


def test_a_block_of_another_floor_leads_over_the_stairs_to_it():
    number = number_in(line_of(answered(view(ABOVE), "1")[1], "on floor 2"))
    destination = stairs_answered(view(ABOVE), number)
    assert destination.connector == UP.connector
    assert destination.xy == UP.xy
    there = destination.then
    assert isinstance(there, Destination)
    assert ABOVE.grid.cells[ABOVE.grid.cell_of(*there.xy)] == Cell.FREE


def test_stairs_of_another_floor_lead_on_from_there():
    number = number_in(line_of(answered(view(ABOVE), "1")[1], "stairs up to another floor"))
    destination = stairs_answered(view(ABOVE), number)
    assert destination.connector == UP.connector
    assert isinstance(destination.then, StairsDestination)
    assert destination.then.connector == FARTHER_UP.connector


def test_what_was_visited_on_another_floor_is_not_chosen():
    number = number_in(line_of(answered(view(ABOVE), "1")[1], "on floor 2"))
    there = certain(stairs_answered(view(ABOVE), number).then)
    visited = replace(ABOVE, visits=[there.xy])
    model, log = Parrot(number, "1"), ExchangeLog()
    chooser = VlmReasoner(model, log, GeometricReasoner(log))
    explorer = BlockExplorer(chooser, OverviewConfig(), MappingConfig(), (0.22,), Embodiment())
    assert isinstance(explorer.next_destination(view(visited)), Destination)
    assert len(model.asked) == 2


def test_visits_of_another_floor_count_as_those_of_the_robots_do():
    number = number_in(line_of(answered(view(ABOVE), "1")[1], "on floor 2"))
    there = certain(stairs_answered(view(ABOVE), number).then).xy
    first = replace(ABOVE, visits=[there, (9.0, 9.0)])

    def goes_there(floor: KnownFloor, **config: Any) -> bool:
        destination, _ = answered(view(floor), number, **config)
        then = destination.then if isinstance(destination, StairsDestination) else None
        return then is not None and then.xy == there

    assert not goes_there(first)
    assert goes_there(first, visited="none")
    assert goes_there(first, visited="positions")
    assert not goes_there(replace(ABOVE, trajectory=[there]), visited="positions")


def test_what_is_forgotten_on_another_floor_is_not_visited():
    number = number_in(line_of(answered(view(ABOVE), "1")[1], "on floor 2"))
    there = certain(stairs_answered(view(ABOVE), number).then).xy
    all_forget: dict[str, Any] = {"forget_visits": True, "visited_radius_m": 100.0}
    upstairs = replace(view(), visits=[there])
    answered(upstairs, "1", **all_forget)
    forgot = replace(ABOVE, visits=[there], notes=upstairs.notes)
    assert certain(stairs_answered(view(forgot), number).then).xy == there


def test_a_floor_whose_stairs_are_out_of_reach_is_not_shown():
    far = replace(ABOVE, way=(replace(UP, x=30.0),))
    assert "floor 2" not in answered(view(far), "1")[1].asked[0].text


def test_an_edge_of_the_floor_is_a_choice():
    seen = replace(view(), drops=[Drop(2.0, 0.6, axis=1.0)])
    line = line_of(answered(seen, "1")[1], "the floor ends")
    destination, _ = answered(seen, number_in(line))
    assert isinstance(destination, Destination)
    assert destination.xy == pytest.approx((2.0, 0.6), abs=0.3)
    assert destination.face == 1.0


def test_edges_that_were_visited_use_up_no_questions():
    explorer = BlockExplorer(
        GeometricReasoner(ExchangeLog()),
        OverviewConfig(last_frontier_m=None),
        MappingConfig(),
        (0.22,),
        Embodiment(),
    )
    drops = [Drop(x, 0.6) for x in (-1.0, 0.5, 1.0, 1.5, 2.0)]
    visits = [one.xy for one in drops]
    destination = certain(explorer.next_destination(replace(view(), drops=drops, visits=visits)))
    assert "unknown in view" in destination.reason


def test_the_geometric_rule_goes_by_an_edge_of_the_floor():
    explorer = BlockExplorer(
        GeometricReasoner(ExchangeLog()), OverviewConfig(), MappingConfig(), (0.22,), Embodiment()
    )
    destination = certain(explorer.next_destination(replace(view(), drops=[Drop(1.0, 0.6)])))
    assert destination.xy == pytest.approx((1.0, 0.6), abs=0.3)
    assert "the floor ends" in destination.reason


@pytest.mark.parametrize("elsewhere", [(), (ABOVE,)])
def test_the_geometric_rule_chooses_on_its_floor(elsewhere: tuple[KnownFloor, ...]):
    explorer = BlockExplorer(
        GeometricReasoner(ExchangeLog()), OverviewConfig(), MappingConfig(), (0.22,), Embodiment()
    )
    here, there = (explorer.next_destination(one) for one in (view(), view(*elsewhere)))
    assert certain(here).xy == certain(there).xy
