import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from box_scenes import scene_of
from gltf_writer import GltfWriter
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.errors import SceneError
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.scenes.stray_parts import (
    in_one_line,
    without_stray_parts,
    without_surroundings,
)
from hypernav.simulator.worlds.surface.walkable import WalkableGrid


def box(name: str, low: tuple[float, ...], high: tuple[float, ...]) -> MeshPart:
    scene = scene_of((name, low, high))
    return MeshPart(name, name, scene.vertices, scene.faces, 0)


ROOM = [
    box("floor", (0.0, 0.0, -0.1), (8.0, 6.0, 0.0)),
    box("wall", (0.0, 6.0, 0.0), (8.0, 6.1, 2.6)),
    box("bed", (1.0, 1.0, 0.0), (3.0, 2.6, 0.5)),
    box("book", (1.2, 1.2, 0.5), (1.4, 1.4, 0.53)),
]
FAR = st.floats(30.0, 1e30).flatmap(lambda away: st.sampled_from([away, -away]))


def names(parts: list[MeshPart]) -> list[str]:
    return [part.node for part in parts]


@given(axis=st.integers(0, 2), away=FAR, place=st.integers(0, 4))
def test_one_part_far_away_never_costs_the_rest(axis: int, away: float, place: int) -> None:
    stray = box("stray", (0.0, 0.0, 0.0), (0.2, 0.2, 0.2))
    stray.vertices[:, axis] += np.float32(away)
    kept, left_out = without_stray_parts([*ROOM[:place], stray, *ROOM[place:]])
    assert names(kept) == names(ROOM)
    assert len(left_out) == 1
    assert left_out[0].startswith("stray (")


@given(st.tuples(*[st.floats(-15.0, 20.0)] * 3))
def test_what_is_near_the_building_stays(corner: tuple[float, float, float]) -> None:
    x, y, z = corner
    parts = [*ROOM, box("kiosk", (x, y, z), (x + 1.0, y + 1.0, z + 1.0))]
    assert without_stray_parts(parts) == (parts, [])


@pytest.mark.parametrize(
    ("part", "why"),
    [
        (box("sky", (-900.0, -900.0, -10.0), (900.0, 900.0, 400.0)), "1800 × 1800 × 410 m large"),
        (box("ground", (-500.0, -500.0, -0.1), (500.0, 500.0, -0.05)), "m large"),
        (box("dot", (2.0, 2.0, 1.0), (2.0, 2.0, 1.0)), "no surface"),
        (box("nowhere", (np.nan, 0.0, 0.0), (np.nan, 1.0, 1.0)), "no corners that are numbers"),
    ],
)
def test_domes_grounds_and_empty_meshes_are_named(part: MeshPart, why: str) -> None:
    kept, left_out = without_stray_parts([part, *ROOM])
    assert names(kept) == names(ROOM)
    assert len(left_out) == 1
    assert left_out[0].startswith(part.node)
    assert why in left_out[0]


def test_a_floor_as_large_as_the_building_is_no_ground() -> None:
    hangar = [
        box("floor", (0.0, 0.0, -0.1), (200.0, 150.0, 0.0)),
        box("east", (200.0, 0.0, 0.0), (200.1, 150.0, 12.0)),
        box("west", (-0.1, 0.0, 0.0), (0.0, 150.0, 12.0)),
        *[box(f"shelf {k}", (4.0 * k, 20.0, 0.0), (4.0 * k + 2.0, 130.0, 6.0)) for k in range(50)],
    ]
    assert without_stray_parts(hangar) == (hangar, [])


def test_a_file_with_nothing_sensible_is_left_as_it_is() -> None:
    dots = [box(f"dot {k}", (k, 0.0, 0.0), (k, 0.0, 0.0)) for k in range(3)]
    assert without_stray_parts(dots) == (dots, [])


def test_many_strays_make_one_line() -> None:
    strays = [box(f"s{k}", (100.0 * k, 0.0, 0.0), (100.0 * k + 1, 1.0, 1.0)) for k in range(1, 9)]
    kept, left_out = without_stray_parts([*ROOM, *strays])
    assert names(kept) == names(ROOM)
    assert in_one_line(left_out) == (
        "s1 (92 m from the rest), s2 (192 m from the rest), s3 (292 m from the rest), "
        "s4 (392 m from the rest), s5 (492 m from the rest) and 3 more"
    )


def write_room(path: Path, *strays: list[float]) -> Path:
    """A room of squares with stray books."""
    writer = GltfWriter()
    square = writer.mesh(writer.square())
    flat = [-0.7071068, 0.0, 0.0, 0.7071068]
    writer.node(name="Floor", mesh=square, rotation=flat, scale=[6.0, 6.0, 1.0])
    writer.node(name="Wall", mesh=square, scale=[6.0, 2.5, 1.0])
    writer.node(name="camera", camera=0)
    writer.node(name="Sun", extensions={"KHR_lights_punctual": {"light": 0}})
    for place in strays:
        writer.node(name="Book", mesh=square, scale=[-0.2, 0.2, 0.2], translation=place)
    return writer.write(path)


def test_a_room_with_a_book_in_the_sky_is_a_room(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    plain = load_scene(str(write_room(tmp_path / "plain.glb", [1.0, 0.0, -1.0])))
    assert caplog.messages == []
    path = write_room(tmp_path / "sky.glb", [1.0, 0.0, -1.0], [1.0, 343582.7, -1.0])
    objects = [{"name": "flown", "category": "book", "nodes": ["Book#2"]}]
    (tmp_path / "objects.json").write_text(json.dumps({"objects": objects}))
    scene = load_scene(str(path))
    assert caplog.messages == [f"{path}: leaves out Book#2 (343580 m from the rest)"]
    assert [instance.name for instance in scene.instances] == ["Floor", "Wall", "Book"]
    np.testing.assert_array_equal(scene.vertices, plain.vertices)
    assert WalkableGrid.from_scene(scene).area_m2() > 20.0


def test_a_scene_that_is_all_too_large_is_refused_as_before(tmp_path: Path) -> None:
    writer = GltfWriter()
    flat = [-0.7071068, 0.0, 0.0, 0.7071068]
    land = writer.mesh(writer.square())
    writer.node(name="Land", mesh=land, rotation=flat, scale=[9000.0, 900.0, 1.0])
    scene = load_scene(str(writer.write(tmp_path / "a.glb")))
    with pytest.raises(SceneError, match="are its units metres"):
        WalkableGrid.from_scene(scene)


def instance_parts(scene: Scene) -> list[MeshPart]:
    return [
        MeshPart(one.name, one.name, scene.vertices, scene.faces[scene.face_instance == one.id], 0)
        for one in scene.instances
    ]


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("kind", ["houses", "offices", "shops"])
def test_nothing_of_a_generated_building_is_left_out(kind: str, number: int) -> None:
    parts = instance_parts(load_scene(f"{kind}:{number}"))
    assert without_stray_parts(parts) == (parts, [])


def test_nothing_of_the_small_house_is_left_out(
    small_house: Path, caplog: pytest.LogCaptureFixture
) -> None:
    load_scene(str(small_house))
    assert caplog.messages == []


@pytest.mark.parametrize("side", [100.0, 1000.0])
def test_a_ground_far_beyond_the_building_is_cut_to_it_and_stays_its_floor(side: float) -> None:
    ground = box("ground", (-side / 2, -side / 2, -0.3), (side / 2, side / 2, -0.2))
    house = [part for part in ROOM if part.node != "floor"]
    kept, left_out = without_surroundings([ground, *house])
    assert names(kept) == ["ground", *names(house)]
    cut = kept[0].vertices[kept[0].faces].reshape(-1, 3)
    low, high = (
        np.min([p.vertices.min(0) for p in house], 0),
        np.max([p.vertices.max(0) for p in house], 0),
    )
    np.testing.assert_allclose(cut.min(axis=0)[:2], low[:2], atol=1e-4)
    np.testing.assert_allclose(cut.max(axis=0)[:2], high[:2], atol=1e-4)
    assert len(left_out) == 1
    assert "ground" in left_out[0]


def test_a_cut_ground_keeps_its_texture_in_place() -> None:
    corners = np.array([[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    ground = MeshPart("ground", "ground", corners, faces, 0, corners[faces][:, :, :2] / 10)
    cut = without_surroundings([*ROOM[1:], ground])[0][-1]
    assert cut.uv is not None
    np.testing.assert_allclose(cut.uv, cut.vertices[cut.faces][:, :, :2] / 10, atol=1e-4)


def test_a_large_floor_under_large_furniture_is_no_ground() -> None:
    floor = box("floor", (0.0, 0.0, -0.1), (60.0, 40.0, 0.0))
    hall = [floor, *(box(f"shelf {k}", (4.0 * k, 2, 0), (4.0 * k + 1, 36, 2)) for k in range(14))]
    assert without_surroundings(hall) == (hall, [])


def test_a_ground_alone_stays() -> None:
    ground = box("ground", (-50.0, -50.0, -0.3), (50.0, 50.0, -0.2))
    assert without_surroundings([ground]) == ([ground], [])
