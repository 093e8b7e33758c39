"""A building that lies on its side, or has another unit, is doubted; one that is right never is."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hypernav.app.build.data.scenes import load_scene
from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.mesh_parts import (
    TO_Z_UP,
    Axis,
    MeshPart,
    SceneObject,
    axis_along,
    placed,
)
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.scenes.scene_doubts import doubts_of

TURNS: list[Axis] = ["x", "-x", "y", "-y", "-z"]
UNITS = [0.001, 0.01, 0.0254, 0.3048, 100.0, 1000.0]
Parts = list[MeshPart]
Objects = list[SceneObject]


def taken_apart(scene: Scene) -> tuple[Parts, Objects]:
    parts, objects = [], []
    for item in scene.instances:
        faces = scene.faces[scene.face_instance == item.id]
        used, numbers = np.unique(faces, return_inverse=True)
        corners = numbers.reshape(-1, 3).astype(np.int32)
        parts.append(MeshPart(item.name, item.name, scene.vertices[used], corners, 0))
        objects.append(SceneObject(item.name, frozenset({item.name}), item.label))
    return parts, objects


def turned(parts: Sequence[MeshPart], up: Axis = "z", scale: float = 1.0) -> Parts:
    matrix = np.eye(4)
    matrix[:3, :3] = TO_Z_UP[up] * scale
    return [placed(part, matrix) for part in parts]


def check_all_ways(
    parts: Parts,
    objects: Objects,
    turns: Sequence[Axis] = TURNS,
    units: Sequence[float] = UNITS,
) -> None:
    assert doubts_of(parts, objects, "z") == []
    for turn in turns:
        (doubt,) = doubts_of(turned(parts, turn), objects, "z")
        assert f"file_up={axis_along(TO_Z_UP[turn][:, 2])} turns it" in doubt
        assert doubts_of(turned(parts, turn), objects, "z", up_is_given=True) == []
    for unit in units:
        (doubt,) = doubts_of(turned(parts, scale=1.0 / unit), objects, "z")
        assert f"file_scale={unit:g} converts it" in doubt
        both = doubts_of(turned(parts, "y", 1.0 / unit), objects, "z")
        assert len(both) == 2


def test_a_modelled_house(small_house: Path) -> None:
    check_all_ways(*taken_apart(read_scene(small_house)), ["x", "-y"], [0.3048])


def test_a_generated_house() -> None:
    check_all_ways(*taken_apart(load_scene("builtin")), ["-x", "y", "-z"], [0.0254])


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("kind", ["houses", "offices", "shops", "crowded", "storeys"])
def test_generated_buildings_of_all_kinds(kind: str, number: int) -> None:
    check_all_ways(*taken_apart(load_scene(f"{kind}:{number}")))


def box(name: str, low: Sequence[float], high: Sequence[float]) -> MeshPart:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    vertices = np.array(low) + corners * (np.array(high) - np.array(low))
    return MeshPart(name, name, vertices.astype(np.float32), np.array(faces, np.int32), 0)


def room(width: float = 6.0, height: float = 2.5) -> Parts:
    return [
        box("floor", (-0.1, -0.1, -0.1), (width, 4.1, 0.0)),
        box("wall_south", (-0.1, -0.1, 0.0), (width, 0.0, height)),
        box("wall_north", (-0.1, 4.0, 0.0), (width, 4.1, height)),
        box("wall_west", (-0.1, 0.0, 0.0), (0.0, 4.0, height)),
        box("wall_east", (width - 0.1, 0.0, 0.0), (width, 4.0, height)),
        box("bed_01", (0.1, 0.1, 0.0), (2.0, 1.7, 0.5)),
    ]


def objects_of(parts: Sequence[MeshPart], **labels: str) -> Objects:
    return [
        SceneObject(
            part.node,
            frozenset({part.node}),
            ObjectLabel(labels[part.node]) if part.node in labels else None,
        )
        for part in parts
    ]


@pytest.mark.parametrize("turn", TURNS[:4])
def test_names_of_floor_and_walls_suffice(turn: Axis) -> None:
    parts = room()
    objects = objects_of(parts, bed_01="bed")
    assert doubts_of(parts, objects, "z") == []
    (doubt,) = doubts_of(turned(parts, turn), objects, "z")
    assert "what is called floor is level" in doubt
    assert "what is called wall is upright" in doubt


@pytest.mark.parametrize(
    "parts",
    [
        room(width=2.5, height=30.0),  # a stairwell: its walls are its largest surfaces
        room(height=12.0),
        [part for part in room() if "wall" not in part.node],
        [part for part in room() if part.node == "bed_01"],
        [box("wall", (0, 0, 0), (20, 0.2, 3)), box("bed_01", (0, 0, 0), (2, 1.6, 0.5))],
        [box("Floor_1", (0, 0, 0), (8, 6, 18)), box("bed_01", (0, 0, 0), (2, 1.6, 0.5))],
        [box("bed_01", (0, 0, 0), (1.6, 0.4, 2))],  # against a wall, folded up
        [],
    ],
)
def test_odd_buildings_are_not_doubted(parts: Parts) -> None:
    assert doubts_of(parts, objects_of(parts, bed_01="bed"), "z") == []


def furniture(*names: str) -> Parts:
    """Things of different heights that stand in a room of 6 by 4 m."""
    return [
        box(name, (x, y, 0.0), (x + 0.5, y + 0.6, 0.4 + 0.2 * k))
        for k, name in enumerate(names)
        for x, y in [(0.3 + 0.8 * k, 0.4 + 0.37 * k)]
    ]


def test_names_in_any_language_will_do_where_things_stand_on_one_level() -> None:
    names = {"墙_南": "墙", "床_01": "床", "椅": "椅", "桌": "桌", "灯": "灯", "柜": "柜"}
    structure = [box("床面", (-3, -3, -0.1), (9, 8, 0.0)), box("墙_南", (0, -0.1, 0), (6, 0, 2.5))]
    parts = [*structure, *furniture(*list(names)[1:])]
    assert doubts_of(parts, objects_of(parts, **names), "z") == []
    (doubt,) = doubts_of(turned(parts, "y"), objects_of(parts, **names), "z")
    assert "lie on its side" in doubt


GERMAN = {"Tisch_01": "tisch", "Stuhl_01": "stuhl", "Bett": "bett", "Lampe": "lampe"}


def german(height: float = 2.5, *, ceiling: bool = True) -> Parts:
    """A room of 6 by 4 m with furniture, metres."""
    names = {"floor": "Boden", "bed_01": "Schrank"}
    parts = [
        replace(part, node=name, descriptive_name=name)
        for part in room(height=height)
        for name in [names.get(part.node, part.node.replace("wall", "Wand"))]
    ]
    decke = box("Decke", (-0.1, -0.1, height), (6.0, 4.1, height + 0.2))
    return [*parts, *furniture(*GERMAN), *([decke] if ceiling else [])]


@pytest.mark.parametrize("ceiling", [True, False])
@pytest.mark.parametrize("unit", [0.001, 0.01, 0.0254])
def test_the_height_of_storeys_says_the_unit_in_any_language(unit: float, ceiling: bool) -> None:
    parts = german(ceiling=ceiling)
    objects = objects_of(parts, **GERMAN)
    assert doubts_of(parts, objects, "z") == []
    (doubt,) = doubts_of(turned(parts, scale=1.0 / unit), objects, "z")
    assert f"file_scale={unit:g} converts it" in doubt
    assert "its highest storey has 2." in doubt
    assert doubts_of(turned(parts, scale=1.0 / unit), objects, "z", scale_is_given=True) == []


@pytest.mark.parametrize("unit", [0.001, 0.01, 0.0254])
def test_several_storeys_are_no_high_one(unit: float) -> None:
    storeys = [
        replace(
            part,
            node=f"{part.node}_{k}",
            vertices=part.vertices + np.array([0, 0, 2.7 * k], np.float32),
        )
        for k in range(4)
        for part in german()
    ]
    assert doubts_of(storeys, objects_of(storeys), "z") == []
    (doubt,) = doubts_of(turned(storeys, scale=1.0 / unit), objects_of(storeys), "z")
    assert f"file_scale={unit:g} converts it" in doubt


def test_high_and_wide_things_in_metres_are_not_doubted() -> None:
    site = box("Gelände", (-150, -150, -1), (150, 150, 0))
    floors = [box(f"Decke_{k}", (0, 0, 3 * k), (30, 30, 3 * k + 0.3)) for k in range(1, 40)]
    fronts = [box("Wand", (0, 0, 0), (30, 0.3, 117)), box("Wand_2", (0, 30, 0), (30, 30.3, 117))]
    hall = [*german(height=18.0), box("Dach", (-80, -80, 18), (80, 80, 18.5))]
    x, y = np.meshgrid(np.arange(0.0, 1000.0, 20.0), np.arange(0.0, 1000.0, 20.0))
    hills = np.stack([x, y, 75.0 + 75.0 * np.sin(x / 300.0) * np.cos(y / 200.0)], axis=-1)
    square = np.array([[0, 1, 50], [1, 51, 50]])
    corners = [k for k in range(49 * 50) if k % 50 < 49]
    faces = np.concatenate([square + k for k in corners]).astype(np.int32)
    ground = MeshPart("Hügel", "Hügel", hills.reshape(-1, 3).astype(np.float32), faces, 0)
    sky = [*german(), box("Himmel", (-200, -200, -200), (200, 200, 200))]
    for parts in ([site, *floors, *fronts], hall, [ground], sky):
        assert doubts_of(parts, objects_of(parts), "z") == []


def test_many_things_of_one_kind_say_one_thing() -> None:
    """A warehouse: sixty pallets that are called boxes."""
    pallets = [box(f"box_{k}", (k, 0, 0), (k + 0.8, 1.5, 1.0)) for k in range(60)]
    parts = [*room(width=70.0), *pallets]
    labels = {"bed_01": "bed"} | {part.node: "box" for part in pallets}
    assert doubts_of(parts, objects_of(parts, **labels), "z") == []


def test_a_few_things_of_odd_size_say_nothing_of_the_unit() -> None:
    parts = [*room(), box("doll_bed", (3, 1, 0), (3.02, 1.04, 0.01))]
    assert doubts_of(parts, objects_of(parts, bed_01="bed", doll_bed="bed"), "z") == []


def test_the_options_turn_and_convert_what_a_file_holds(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1000 0 0\nv 0 2000 0\nv 0 0 3000\nf 1 2 3\nf 1 3 4\n")
    scene = load_scene(str(path), SimulationConfig(file_up="z", file_scale=0.001))
    np.testing.assert_allclose(scene.vertices.max(axis=0), [1, 2, 3])
    np.testing.assert_allclose(scene.instances[0].box_max, [1, 2, 3])
    with pytest.raises(SceneError, match="is no file"):
        load_scene("builtin", SimulationConfig(file_up="z"))
    (tmp_path / "a.world").write_text("<sdf/>")
    with pytest.raises(SceneError, match="are z up"):
        load_scene(str(tmp_path / "a.world"), SimulationConfig(file_up="y"))


@pytest.mark.parametrize("axis", TO_Z_UP)
def test_turns_are_rotations(axis: Axis) -> None:
    matrix = TO_Z_UP[axis]
    np.testing.assert_array_equal(matrix @ matrix.T, np.eye(3))
    assert np.linalg.det(matrix) == pytest.approx(1.0)
    assert axis_along(matrix.T @ np.array([0.0, 0.0, 1.0])) == axis
