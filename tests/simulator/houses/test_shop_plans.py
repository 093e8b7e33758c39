from functools import cache

import pytest

from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import plan_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.houses.plan.public_plans import LEAST_M2, MOST_M2
from hypernav.simulator.houses.plan.shop_plans import HALLS

NUMBERS = range(40)
HUBS = {"arcade", "corridor", *HALLS}


@cache
def drawn(number: int) -> FloorPlan:
    return plan_of(Building("shops", number))


@pytest.mark.parametrize("number", NUMBERS)
def test_shops_have_the_promised_size_a_hall_and_a_restroom(number: int):
    plan = drawn(number)
    assert LEAST_M2 <= sum(room.cell.area for room in plan.rooms) <= MOST_M2
    kinds = {room.kind for room in plan.rooms}
    assert kinds & set(HALLS)
    assert {"stock room", "restroom"} & kinds
    assert sum(opening.kind == "entrance" for opening in plan.openings) == 1


@pytest.mark.parametrize("number", NUMBERS)
def test_every_room_of_a_shop_is_reached_through_halls_and_corridors(number: int):
    plan = drawn(number)
    for k, a in enumerate(plan.rooms):
        assert not any(a.cell.overlaps(b.cell) for b in plan.rooms[k + 1 :])
    entrance = next(o for o in plan.openings if o.kind == "entrance")
    todo = [max(entrance.rooms)]
    seen = set(todo)
    while todo:
        here = todo.pop()
        for opening in plan.openings_of(here) if plan.rooms[here].kind in HUBS else ():
            for room in set(opening.rooms) - seen if opening.is_passable else ():
                seen.add(room)
                todo.append(room)
    assert seen == set(range(len(plan.rooms)))


def test_shops_are_halls_departments_arcades_and_rounds():
    plans = [drawn(number) for number in NUMBERS]
    halls = [sum(room.kind in HALLS for room in plan.rooms) for plan in plans]
    assert halls.count(1) >= 5
    assert any(2 <= count <= 3 for count in halls)
    assert any(room.kind == "arcade" for plan in plans for room in plan.rooms)
    # In a round, the first and the second hall touch only through the third and the fourth.
    assert any(
        count == 4 and not any({0, 1} == set(o.rooms) for o in plan.openings)
        for count, plan in zip(halls, plans, strict=True)
    )
    assert max(max(r.inner.area for r in plan.rooms) for plan in plans) > 150.0
