"""Crowded offices: the screen is in sight from the opening, and reached around the far end only."""

from functools import cache

import pytest
from collisions import collisions

from hypernav.core.embodiment import BodyConfig
from hypernav.core.goal import Goal
from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.simulator.houses.assembly import PlacedModel
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import generate, placed_models, plan_of
from hypernav.simulator.houses.plan.office_plans import MEETING_ROOMS, screen_side, wide_opening
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.surface.goal_regions import view_points
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

NUMBERS = range(3002, 3008)


@cache
def crowded(number: int) -> list[tuple[str, int, list[PlacedModel]]]:
    """Screen's side, number, and models of every meeting room that is full of chairs."""
    building = Building("crowded", number)
    plan = plan_of(building)
    models = placed_models(building, plan)
    rooms = []
    for k, room in enumerate(plan.rooms):
        opening = wide_opening(plan.openings_of(k))
        own = [one for one in models if one.room == room.name]
        if room.kind in MEETING_ROOMS and opening is not None:
            rooms.append((screen_side(room, opening), k, own))
    return rooms


def count(models: list[PlacedModel], category: str) -> int:
    return sum(one.model.category == category for one in models)


@pytest.mark.slow
@pytest.mark.parametrize("number", NUMBERS)
def test_every_crowded_office_has_a_room_full_of_chairs_with_a_screen(number: int):
    assert any(
        count(models, "chair") >= 6 and count(models, "meeting table") and count(models, "tv")
        for _, _, models in crowded(number)
    )


def test_models_of_crowded_offices_do_not_penetrate_each_other():
    building = Building("crowded", 3002)
    assert collisions(placed_models(building, plan_of(building))) == []


def test_the_screen_has_view_points_that_a_robot_reaches():
    scene = generate(Building("crowded", 3002))
    grid = WalkableGrid.from_scene(scene, BodyConfig())
    screens = [
        one for one in scene.instances if one.label is not None and one.label.satisfies(Goal("tv"))
    ]
    rays = RayCaster(scene)
    assert screens
    assert any(len(view_points(scene, grid, screen, rays)) for screen in screens)


def test_crowded_offices_have_a_training_split_only():
    assert [name for name, split in SPLITS.items() if split.kind == "crowded"] == ["crowded-train"]
