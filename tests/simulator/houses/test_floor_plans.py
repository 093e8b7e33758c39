from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.generator import plan_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.houses.plan.home_plans import LIMITS
from hypernav.simulator.houses.plan.openings import leaf_rect

SOME = (0, 1, 5, 1000, 1017, 2003, 54_321, 987_654_321)
PASSABLE = ("hall", "living room", "dining room", "kitchen")


@cache
def drawn(number: int) -> FloorPlan:
    return plan_of(house(number))


def reached(plan: FloorPlan, through: tuple[str, ...]) -> set[int]:
    """Rooms that are reached from the front door through rooms of certain kinds only."""
    entrance = next(o for o in plan.openings if o.kind == "entrance")
    todo = [max(entrance.rooms)]
    seen = set(todo)
    while todo:
        here = todo.pop()
        if plan.rooms[here].kind not in through:
            continue
        for opening in plan.openings_of(here):
            if opening.is_passable:
                for room in set(opening.rooms) - seen:
                    seen.add(room)
                    todo.append(room)
    return seen


@pytest.mark.parametrize("number", SOME)
def test_homes_have_the_promised_size(number: int):
    plan = drawn(number)
    inside = [r for r in plan.rooms if not r.is_outside]
    assert 3 <= len(plan.rooms) <= 12
    assert 45.0 <= sum(r.cell.area for r in inside) <= 220.0
    for room in plan.rooms:
        narrow, long = sorted((room.inner.width, room.inner.depth))
        least, ratio = LIMITS[room.kind]
        assert narrow >= least - 1e-6
        assert long <= ratio * narrow + 0.2
    assert len({r.name for r in plan.rooms}) == len(plan.rooms)
    assert {"living room", "bedroom", "bathroom"} <= {r.kind for r in plan.rooms}


@pytest.mark.parametrize("number", SOME)
def test_rooms_do_not_overlap(number: int):
    rooms = drawn(number).rooms
    for k, a in enumerate(rooms):
        for b in rooms[k + 1 :]:
            assert not a.cell.overlaps(b.cell)


@pytest.mark.parametrize("number", SOME)
def test_every_room_is_reached_without_crossing_a_bathroom(number: int):
    plan = drawn(number)
    everything = set(range(len(plan.rooms)))
    assert reached(plan, (*PASSABLE, "bedroom", "office")) == everything
    public = reached(plan, PASSABLE)
    assert any(plan.rooms[k].kind == "bathroom" for k in public)
    assert all(k in public for k in everything if plan.rooms[k].kind in ("bedroom", "office"))


@pytest.mark.parametrize("number", SOME)
def test_doors_have_real_widths_and_lie_in_their_walls(number: int):
    plan = drawn(number)
    for opening in plan.openings:
        if opening.kind in ("door", "doorway", "entrance", "glass door"):
            assert 0.8 <= opening.width <= 1.0
        if opening.kind == "passage":
            assert opening.width >= 0.95
        for number_ in opening.rooms:
            if number_ >= 0 and not plan.rooms[number_].is_outside:
                inner = plan.rooms[number_].inner
                low, high = (inner.x0, inner.x1) if opening.along == "x" else (inner.y0, inner.y1)
                assert low - 1e-6 <= opening.start
                assert opening.end <= high + 1e-6


@pytest.mark.parametrize("number", SOME)
def test_open_leaves_block_no_other_door(number: int):
    plan = drawn(number)
    leaves = [(o, leaf) for o in plan.openings if (leaf := leaf_rect(o)) is not None]
    for opening, leaf in leaves:
        assert plan.rooms[opening.leaf_room].inner.holds(leaf)
        for other in plan.openings:
            if other is not opening and other.bottom == 0.0:
                assert not leaf.overlaps(other.strip(-0.9, 0.9))


def test_the_builtin_house_is_a_small_flat():
    rooms = [r.kind for r in plan_of(house(BUILTIN_HOUSE)).rooms]
    assert sorted(rooms) == ["bathroom", "bedroom", "hall", "kitchen", "living room"]


@pytest.mark.slow
@given(st.integers(0, 10**9))
@settings(max_examples=150, deadline=None)
def test_all_laws_hold_for_any_number(number: int):
    test_homes_have_the_promised_size(number)
    test_rooms_do_not_overlap(number)
    test_every_room_is_reached_without_crossing_a_bathroom(number)
    test_doors_have_real_widths_and_lie_in_their_walls(number)
    test_open_leaves_block_no_other_door(number)
