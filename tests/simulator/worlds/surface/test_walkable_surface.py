"""The main floor is where a building's things stand, or under a ceiling, whatever its roof."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from box_scenes import Box, room_boxes, scene_of
from hypernav.app.build.data.drawn_starts import scene_episodes
from hypernav.app.build.data.sources import DatasetRequest
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.storey_floors import Storeys
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

CLIMBS = BodyConfig(max_step_m=0.2)
BED: Box = ("bed", (4.0, 0.5, 0.0), (5.8, 2.0, 0.5))
FURNITURE: list[Box] = [
    BED,
    *(("chair", (0.3 + k, 3.0, 0.0), (0.8 + k, 3.5, 0.8)) for k in range(4)),
]
Quad = Sequence[tuple[float, float, float]]


def with_slopes(scene: Scene, *quads: Quad) -> Scene:
    """A scene with surfaces that are not level; they belong to its first box."""
    corners = np.array(quads, np.float32).reshape(-1, 3)
    first = np.arange(len(quads))[:, None] * 4 + len(scene.vertices)
    halves = (np.array([0, 1, 2]), np.array([0, 2, 3]))
    faces = np.concatenate([first + half for half in halves]).astype(np.int32)
    n = len(faces)
    return replace(
        scene,
        vertices=np.concatenate([scene.vertices, corners]),
        faces=np.concatenate([scene.faces, faces]),
        uv=np.concatenate([scene.uv, np.zeros((n, 3, 2), np.float32)]),
        colors=np.concatenate([scene.colors, np.full((n, 3, 3), 200, np.uint8)]),
        face_material=np.concatenate([scene.face_material, np.zeros(n, np.int32)]),
        face_instance=np.concatenate([scene.face_instance, np.zeros(n, np.int32)]),
    )


def gable(eaves: float, ridge: float, overhang: float = 0.8) -> list[Quad]:
    """Two slopes over a room of 6 m by 4 m."""
    a, b, low, high = -overhang, 6.0 + overhang, -overhang, 4.0 + overhang
    return [
        [(a, low, eaves), (b, low, eaves), (b, 2.0, ridge), (a, 2.0, ridge)],
        [(a, 2.0, ridge), (b, 2.0, ridge), (b, high, eaves), (a, high, eaves)],
    ]


OPEN, CLOSED = room_boxes(6.0, 4.0, ceiling=False), room_boxes(6.0, 4.0)
CHIMNEY: Box = ("chimney", (1.0, 1.0, 2.6), (1.5, 1.5, 6.0))
TERRAIN: Box = (None, (-15.0, -15.0, -0.9), (20.0, 20.0, -0.8))
PLINTH: Box = (None, (-0.1, -0.1, -0.8), (6.1, 4.1, -0.1))
CARPORT: list[Box] = [
    (None, (8.0, 0.0, 1.8), (13.0, 6.0, 1.9)),
    *((None, (x, y, -0.8), (x + 0.1, y + 0.1, 1.8)) for x in (8.0, 12.9) for y in (0.0, 5.9)),
]
TERRACE: list[Box] = [
    ("sunshade", (1.0, 1.0, 2.6), (3.0, 3.0, 5.0)),
    ("chair", (4.0, 1.0, 2.6), (4.5, 1.5, 3.4)),
]
COURTYARD: list[Box] = [(None, (-0.1, -6.0, -0.1), (6.1, -0.1, 0.0))]
SHAPES = {
    "gable roof": with_slopes(scene_of(*CLOSED, BED, CHIMNEY), *gable(2.6, 4.0)),
    "gable roof, no names": with_slopes(scene_of(*CLOSED, (None, *BED[1:])), *gable(2.6, 4.0)),
    "gable roof, no ceiling": with_slopes(scene_of(*OPEN, BED, CHIMNEY), *gable(2.5, 4.0)),
    "loft": with_slopes(scene_of(*CLOSED, *FURNITURE), *gable(3.2, 4.8)),
    "shed roof": with_slopes(
        scene_of(*CLOSED, BED, CHIMNEY),
        [(-1.0, -1.0, 2.6), (7.0, -1.0, 2.6), (7.0, 5.0, 4.2), (-1.0, 5.0, 4.2)],
    ),
    "roof terrace": scene_of(*CLOSED, *FURNITURE, *TERRACE),
    "carport and terrain": scene_of(*CLOSED, *FURNITURE, TERRAIN, PLINTH, *CARPORT),
    "courtyard": scene_of(*CLOSED, *FURNITURE, *COURTYARD),
    "cut open": scene_of(*OPEN, *FURNITURE),
    "cut open, no names": scene_of(*OPEN),
    "cut open, over a garage": scene_of(
        *OPEN, *FURNITURE, (None, (-1.0, -1.0, -2.6), (7.0, 5.0, -2.5)), CHIMNEY
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_main_floor_is_that_of_the_rooms(shape):
    for body in (BodyConfig(), CLIMBS):
        grid = WalkableGrid.from_scene(SHAPES[shape], body)
        assert grid.floor_z == pytest.approx(0.0, abs=0.01)
        assert grid.component_of(3.0, 2.4) == 0, "the middle of the room"


def test_a_roof_at_the_height_of_a_storey_is_not_its_main_part():
    upper = [
        (None, (low[0], low[1], low[2] + 2.6), (high[0], high[1], high[2] + 2.6))
        for _, low, high in CLOSED
    ]
    bed = ("bed", (4.0, 0.5, 2.6), (5.8, 2.0, 3.1))
    wing = (None, (6.1, -4.0, 0.0), (18.0, 12.0, 2.6))
    scene = scene_of(*CLOSED, *upper, bed, wing, CHIMNEY)
    grid = WalkableGrid.from_scene(scene, floor_z=2.6)
    assert grid.component_of(3.0, 2.4) == 0
    assert grid.component_of(12.0, 2.4) != 0


def test_a_level_that_no_stairs_lead_to_is_no_storey_of_a_robot_that_climbs():
    cupboards: list[Box] = [(None, (-0.1, 2.0, 0.0), (6.1, 4.1, 1.4))]
    scene = scene_of(*CLOSED, BED, *cupboards)
    assert len(Storeys.of(scene, CLIMBS).heights) == 2
    walkable = SimulatedWorld(scene, SimulationConfig(), Embodiment(body=CLIMBS)).walkable
    assert isinstance(walkable, WalkableGrid)


STAIRS: list[Box] = [
    (None, (1.0 + 0.3 * k, 3.0, 0.0), (1.3 + 0.3 * k, 4.0, 0.17 * (k + 1))) for k in range(16)
]
TWO_STOREYS: list[Box] = [
    (None, (-0.1, -0.1, -0.1), (8.1, 4.1, 0.0)),
    (None, (-0.1, -0.1, 0.0), (8.1, 0.0, 5.3)),
    (None, (-0.1, 4.0, 0.0), (8.1, 4.1, 5.3)),
    (None, (-0.1, 0.0, 0.0), (0.0, 4.0, 5.3)),
    (None, (8.0, 0.0, 0.0), (8.1, 4.0, 5.3)),
    (None, (0.0, 0.0, 2.52), (8.0, 2.9, 2.72)),
    (None, (5.8, 2.9, 2.52), (8.0, 4.0, 2.72)),
    (None, (-0.1, -0.1, 5.3), (8.1, 4.1, 5.4)),
    ("sofa", (0.2, 0.2, 0.0), (2.0, 1.0, 0.8)),
    ("bed", (0.2, 0.2, 2.72), (2.0, 1.6, 3.2)),
    *STAIRS,
]


def test_storeys_are_found_in_the_triangles():
    found = Storeys.of(scene_of(*TWO_STOREYS), CLIMBS).heights
    assert found == pytest.approx((0.0, 2.72), abs=0.05)
    for shape in ("gable roof, no ceiling", "shed roof", "roof terrace", "courtyard", "cut open"):
        floors = Storeys.of(SHAPES[shape], CLIMBS).heights
        assert floors[0] == pytest.approx(0.0, abs=0.01)
        assert len(floors) == 1 or shape == "shed roof", "a loft is a storey"


def test_a_robot_that_climbs_goes_from_storey_to_storey_of_an_unknown_building(monkeypatch):
    scene = with_slopes(scene_of(*TWO_STOREYS), *gable(5.4, 6.8, overhang=3.0))
    monkeypatch.setattr("hypernav.app.build.data.drawn_starts.load_scene", lambda *_: scene)
    config = SimulationConfig()
    assert isinstance(SimulatedWorld(scene, config).walkable, WalkableGrid)
    climbs = Embodiment(body=CLIMBS)
    surface = SimulatedWorld(scene, config, climbs).walkable
    assert isinstance(surface, NavmeshSurface)
    assert surface.storeys_z == pytest.approx((0.0, 2.72), abs=0.2)
    assert surface.distance((3.0, 2.0, 0.0), (3.0, 2.0, 2.72)) < 20.0
    request = DatasetRequest("mine.glb", "4", config, climbs)
    episodes = scene_episodes(request)
    assert {one.object_category for one in episodes} == {"bed", "sofa"}
    heights = [round(one.start_z or 0.0, 1) for one in episodes if one.object_category == "bed"]
    assert sorted(heights) == pytest.approx([0.0, 0.0, 2.7, 2.7], abs=0.25)
