import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from box_scenes import room_boxes, scene_of
from gltf_writer import SQUARE_UV, GltfWriter
from hypernav.core.errors import MissingExtraError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Material, Scene, Wrap

CAMERA = PinholeCamera.from_hfov(80, 60, 79.0)
QUADRANTS = np.array(
    [[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 0]]], np.uint8
)  # red, green over blue, yellow


def looking(x: float, y: float, yaw_deg: float, height: float = 0.88) -> Transform:
    pose = Pose2(x, y, math.radians(yaw_deg))
    return pose.to_transform() @ optical_to_base(height)


def wall(
    material: Material, *, size: float = 2.0, repeat: float = 1.0, unlit: bool = True
) -> Scene:
    """A square in the plane x = 0 that faces -x, centred at y = 0, z = 0; v upwards."""
    s = size / 2
    scene = scene_of((None, (0, -s, -s), (0.01, s, s)))
    uv = np.array([[1, 0], [0, 0], [0, 1], [1, 1]], np.float32) * np.float32(repeat)
    return replace(
        scene,
        # To a camera that looks along +x, the left edge is at y = +s.
        vertices=np.array([[0, -s, -s], [0, s, -s], [0, s, s], [0, -s, s]], np.float32),
        faces=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
        uv=uv[[[0, 1, 2], [0, 2, 3]]],
        colors=np.full((2, 3, 3), 255, np.uint8),
        face_material=np.zeros(2, np.int32),
        face_instance=np.zeros(2, np.int32),
        materials=(material,),
        unlit=unlit,
    )


def textured(image: np.ndarray, wrap: Wrap = Wrap.REPEAT) -> Material:
    return Material("picture", (1.0, 1.0, 1.0), image, (wrap, wrap))


@pytest.fixture(scope="module")
def room() -> Scene:
    boxes = room_boxes()
    boxes += [
        ("table", (3.0, 1.0, 0.7), (4.2, 2.6, 0.75)),
        ("box", (1.5, 3.0, 0.0), (2.0, 3.5, 0.5)),
    ]
    return scene_of(*boxes)


def test_depth_of_a_plane_is_along_the_optical_axis() -> None:
    renderer = CpuRenderer(wall(Material("grey", (0.5, 0.5, 0.5)), size=100.0))
    view = renderer.render(CAMERA, looking(-3.0, 0.4, 0.0))
    np.testing.assert_allclose(view.depth, 3.0, atol=1e-5)
    assert (view.instance_ids == 0).all()


@given(yaw_deg=st.floats(-40, 40), pitch_deg=st.floats(-30, 30), away=st.floats(0.3, 30))
@settings(max_examples=20, deadline=None)
def test_hit_points_lie_on_the_plane(yaw_deg: float, pitch_deg: float, away: float) -> None:
    pose = Pose2(-away, 0.7, math.radians(yaw_deg)).to_transform()
    camera_to_scene = pose @ optical_to_base(0.5, pitch_deg)
    view = PLANE.render(CAMERA, camera_to_scene)
    points = camera_to_scene.apply(CAMERA.rays() * view.depth[..., None])
    seen = view.instance_ids >= 0
    assert seen.any()
    assert np.abs(points[seen][:, 0]).max() < 1e-5 * max(1.0, float(view.depth.max()))


PLANE = CpuRenderer(wall(Material("grey", (0.5, 0.5, 0.5)), size=1000.0))


def first_box(scene: Scene, origin: np.ndarray, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Instance and distance of the box that each ray enters first, by the slab method."""
    ids, best = np.full(rays.shape[:2], -1), np.full(rays.shape[:2], np.inf)
    for instance in scene.instances:
        with np.errstate(divide="ignore"):
            a = (np.array(instance.box_min) - origin) / rays
            b = (np.array(instance.box_max) - origin) / rays
        enter, leave = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
        hit = (enter <= leave) & (enter > 0.0) & (enter < best)
        ids[hit], best[hit] = instance.id, enter[hit]
    return ids, best


@given(x=st.floats(0.3, 2.6), y=st.floats(0.3, 2.7), yaw_deg=st.floats(-180, 180))
@settings(max_examples=15, deadline=None)
def test_every_pixel_shows_the_box_that_its_ray_meets(x: float, y: float, yaw_deg: float) -> None:
    camera_to_scene = looking(x, y, yaw_deg)
    view = BOXES.render(CAMERA, camera_to_scene)
    rays = CAMERA.rays() @ camera_to_scene.rotation.T
    ids, depth = first_box(BOX_SCENE, camera_to_scene.translation, rays)
    same = view.instance_ids == ids
    # A ray exactly along an edge may fall to either side.
    assert same.mean() > 0.995
    np.testing.assert_allclose(view.depth[same], depth[same], rtol=1e-4)


BOX_SCENE = scene_of(*room_boxes(), ("pole", (3.0, 1.5, 0.0), (3.1, 1.6, 1.5)))
BOXES = CpuRenderer(BOX_SCENE)


def test_left_is_left_and_up_is_up() -> None:
    scene = scene_of(
        ("left", (3.0, 0.5, 0.9), (3.5, 1.0, 1.4)), ("right", (3.0, -1.0, 0.4), (3.5, -0.5, 0.9))
    )
    ids = CpuRenderer(scene).render(CAMERA, looking(0.0, 0.0, 0.0)).instance_ids
    rows, columns = np.nonzero(ids == 0)
    other_rows, other_columns = np.nonzero(ids == 1)
    assert columns.max() < 40 < other_columns.min()
    assert rows.max() <= 30 <= other_rows.min()


def test_nothing_is_background_with_no_depth() -> None:
    scene = scene_of(("box", (3.0, -1.0, 0.0), (4.0, 1.0, 2.0)))
    renderer = CpuRenderer(scene, RenderConfig(background=(1, 2, 3)))
    view = renderer.render(CAMERA, looking(0.0, 0.0, 180.0))
    assert (view.rgb == [1, 2, 3]).all()
    assert (view.depth == 0.0).all()
    assert (view.instance_ids == -1).all()


def quadrant_colours(rgb: np.ndarray) -> list[list[list[int]]]:
    height, width = rgb.shape[:2]
    return [
        [rgb[row * height // 4, column * width // 4].tolist() for column in (1, 3)]
        for row in (1, 3)
    ]


def test_images_hang_the_right_way_round() -> None:
    camera = PinholeCamera.from_hfov(64, 64, 90.0)
    image = np.kron(QUADRANTS, np.ones((8, 8, 1), np.uint8))
    renderer = CpuRenderer(wall(textured(image, Wrap.CLAMP)))
    view = renderer.render(camera, looking(-1.0, 0.0, 0.0, 0.0))
    assert quadrant_colours(view.rgb) == QUADRANTS.tolist()


def test_images_of_a_file_hang_the_right_way_round(tmp_path: Path) -> None:
    writer = GltfWriter()
    material = writer.textured(np.kron(QUADRANTS, np.ones((8, 8, 1), np.uint8)), wrapS=33071)
    writer.document["materials"][material]["extensions"] = {"KHR_materials_unlit": {}}
    primitive = writer.square(material=material, TEXCOORD_0=writer.array(SQUARE_UV))
    writer.node(name="picture", mesh=writer.mesh(primitive))
    scene = read_scene(writer.write(tmp_path / "a.glb"))
    # The square faces -y of the scene: look along +y from in front of it.
    camera = PinholeCamera.from_hfov(64, 64, 90.0)
    view = CpuRenderer(scene).render(camera, looking(0.5, -0.5, 90.0, 0.5))
    assert quadrant_colours(view.rgb) == QUADRANTS.tolist()


def test_unlit_surfaces_show_the_very_colours_of_their_texture() -> None:
    image = np.arange(16 * 16 * 3).reshape(16, 16, 3).astype(np.uint8)
    camera = PinholeCamera.from_hfov(16, 16, 90.0)
    renderer = CpuRenderer(wall(textured(image)), RenderConfig(antialias=False))
    # One pixel is one texel, so the ray of a pixel meets the middle of its texel.
    view = renderer.render(camera, looking(-1.0, 0.0, 0.0, 0.0))
    np.testing.assert_array_equal(view.rgb, image)


def test_material_and_corner_colours_multiply_the_texture() -> None:
    image = np.full((1, 1, 3), 200, np.uint8)
    scene = wall(replace(textured(image), color=(1.0, 0.5, 0.0)))
    scene = replace(scene, colors=np.full((2, 3, 3), (128, 255, 255), np.uint8))
    view = CpuRenderer(scene).render(CAMERA, looking(-0.3, 0.0, 0.0, 0.0))
    np.testing.assert_array_equal(view.rgb[30, 40], [100, 100, 0])


def test_corner_colours_blend_over_the_face() -> None:
    scene = wall(Material("plain", (1.0, 1.0, 1.0)))
    colors = np.zeros((2, 3, 3), np.uint8)
    colors[0, 0] = colors[1, 0] = colors[1, 2] = 255  # the two corners on the right
    scene = replace(scene, colors=colors)
    row = CpuRenderer(scene).render(CAMERA, looking(-0.5, 0.0, 0.0, 0.0)).rgb[30, :, 0]
    rays = CAMERA.rays()[30, :, 0]
    np.testing.assert_allclose(row, (rays * 0.5 + 1.0) / 2.0 * 255.0, atol=1.0)


@pytest.mark.parametrize(
    ("wrap", "expected"),
    [
        (Wrap.REPEAT, [10, 200, 10, 200]),
        (Wrap.MIRROR, [200, 10, 10, 200]),
        (Wrap.CLAMP, [10, 10, 10, 200]),
    ],
)
def test_textures_go_on_beyond_their_edges(wrap: Wrap, expected: list[int]) -> None:
    image = np.repeat(np.array([[[10], [200]]], np.uint8), 3, axis=2)
    scene = wall(textured(np.kron(image, np.ones((8, 8, 1), np.uint8)), wrap))
    uv = scene.uv.copy()
    uv[..., 0] = 2.0 * uv[..., 0] - 1.0  # from -1 on the left to 1 on the right
    camera = PinholeCamera.from_hfov(64, 64, 90.0)
    view = CpuRenderer(replace(scene, uv=uv)).render(camera, looking(-1.0, 0.0, 0.0, 0.0))
    assert [int(view.rgb[32, column, 0]) for column in (8, 24, 40, 56)] == expected


def test_a_distant_checkerboard_is_an_even_grey() -> None:
    tiles = np.indices((64, 64)).sum(axis=0) % 2 * 255
    image = np.repeat(tiles[..., None], 3, axis=2).astype(np.uint8)
    renderer = CpuRenderer(wall(textured(image), size=40.0, repeat=40.0))
    view = renderer.render(CAMERA, looking(-12.0, 0.0, 0.0, 0.0))
    # Half the light of white is sRGB 188, not 128.
    np.testing.assert_allclose(view.rgb, 188, atol=2)


def test_a_floor_seen_at_a_slant_does_not_shimmer() -> None:
    tiles = np.indices((64, 64)).sum(axis=0) % 2 * 255
    image = np.repeat(tiles[..., None], 3, axis=2).astype(np.uint8)
    renderer = CpuRenderer(wall(textured(image), size=100.0, repeat=100.0))
    slanted = looking(-0.88, 0.0, 85.0, 0.0)
    first = renderer.render(CAMERA, slanted).rgb[:, 50:].astype(float)
    step = Transform(slanted.rotation, slanted.translation + np.array([0.0, 0.013, 0.004]))
    second = renderer.render(CAMERA, step).rgb[:, 50:].astype(float)
    assert np.abs(second - first).mean() < 6.0


def test_leaves_can_be_looked_through() -> None:
    opaque = np.ones((8, 8), bool)
    opaque[:, 4:] = False  # the right half
    leaf = replace(textured(np.full((8, 8, 3), 90, np.uint8), Wrap.CLAMP), opaque=opaque)
    front = wall(leaf)
    behind = wall(textured(np.full((1, 1, 3), 240, np.uint8)), size=50.0)
    scene = replace(
        front,
        vertices=np.concatenate(
            [front.vertices, behind.vertices + np.array([2.0, 0, 0], np.float32)]
        ),
        faces=np.concatenate([front.faces, behind.faces + 4]),
        uv=np.concatenate([front.uv, behind.uv]),
        colors=np.concatenate([front.colors, behind.colors]),
        face_material=np.array([0, 0, 1, 1], np.int32),
        face_instance=np.array([0, 0, 1, 1], np.int32),
        materials=(leaf, behind.materials[0]),
        instances=(front.instances[0], replace(behind.instances[0], id=1, name="behind")),
    )
    camera = PinholeCamera.from_hfov(64, 64, 90.0)
    view = CpuRenderer(scene).render(camera, looking(-1.0, 0.0, 0.0, 0.0))
    assert (view.instance_ids[:, :31] == 0).all()
    assert (view.instance_ids[:, 33:] == 1).all()
    np.testing.assert_allclose(view.depth[:, :31], 1.0, atol=1e-5)
    np.testing.assert_allclose(view.depth[:, 33:], 3.0, atol=1e-5)
    assert (view.rgb[:, :31] == 90).all()
    assert (view.rgb[:, 33:] == 240).all()


def test_faces_are_seen_from_both_sides() -> None:
    scene = wall(Material("grey", (0.5, 0.5, 0.5)), unlit=False)
    renderer = CpuRenderer(scene)
    for pose in (looking(-0.4, 0.0, 0.0, 0.0), looking(0.4, 0.0, 180.0, 0.0)):
        view = renderer.render(CAMERA, pose)
        assert (view.instance_ids == 0).all()
        assert view.rgb.min() > 60


def test_the_same_pose_gives_the_same_bytes_in_one_band_or_several(
    room: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = [looking(0.5, 0.5, 30.0), looking(5.5, 3.5, 200.0), looking(1.0, 3.0, -45.0)]
    first = CpuRenderer(room, RenderConfig(threads=1))
    second = CpuRenderer(room, RenderConfig(threads=3))
    views = [first.render(CAMERA, pose) for pose in poses]
    monkeypatch.setattr("hypernav.simulator.worlds.drawing.renderer._LEAST_PIXELS", 0)
    others = [second.render(CAMERA, pose) for pose in reversed(poses)][::-1]
    again = [first.render(CAMERA, pose) for pose in poses]
    for view, other, repeated in zip(views, others, again, strict=True):
        for image in ("rgb", "depth", "instance_ids"):
            assert getattr(view, image).tobytes() == getattr(other, image).tobytes()
            assert getattr(view, image).tobytes() == getattr(repeated, image).tobytes()


def test_antialiasing_changes_colours_at_edges_only(room: Scene) -> None:
    pose = looking(0.5, 0.5, 30.0)
    smooth = CpuRenderer(room).render(CAMERA, pose)
    sharp = CpuRenderer(room, RenderConfig(antialias=False)).render(CAMERA, pose)
    np.testing.assert_array_equal(smooth.depth, sharp.depth)
    np.testing.assert_array_equal(smooth.instance_ids, sharp.instance_ids)
    changed = (smooth.rgb != sharp.rgb).any(axis=2)
    assert 0.005 < changed.mean() < 0.15


def test_light_gives_form(room: Scene) -> None:
    renderer = CpuRenderer(room, RenderConfig(headlight=0.0))

    def brightness(x: float, y: float, z: float, direction: tuple[float, float, float]) -> float:
        forward = np.array(direction)
        right = np.cross(forward, [0.0, 0.0, 1.0] if forward[2] == 0.0 else [0.0, 1.0, 0.0])
        rotation = np.stack([right, np.cross(forward, right), forward], axis=1)
        pose = Transform(rotation, np.array([x, y, z]))
        camera = PinholeCamera.from_hfov(9, 9, 5.0)
        return float(renderer.render(camera, pose).rgb.mean())

    open_floor = brightness(1.2, 1.8, 1.0, (0.0, 0.0, -1.0))
    under_table = brightness(3.6, 1.8, 0.5, (0.0, 0.0, -1.0))
    beside_wall = brightness(5.95, 1.8, 1.0, (0.0, 0.0, -1.0))
    ceiling = brightness(1.2, 1.8, 1.5, (0.0, 0.0, 1.0))
    sides = {
        round(brightness(3.0, 2.9, 1.6, side))
        for side in [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    }
    assert under_table < open_floor - 15.0
    assert beside_wall < open_floor - 15.0
    assert ceiling < open_floor
    assert len(sides) >= 3


def test_textures_shrink_to_their_budget() -> None:
    image = np.random.default_rng(0).integers(0, 256, (256, 256, 3), dtype=np.uint8)
    scene = wall(textured(image))
    rich, poor = CpuRenderer(scene), CpuRenderer(scene, RenderConfig(texture_budget_mb=0.01))
    pose = looking(-0.05, 0.0, 0.0, 0.0)
    sharp, soft = rich.render(CAMERA, pose).rgb, poor.render(CAMERA, pose).rgb
    assert sharp.std() > 3 * soft.std()


def test_a_machine_without_embree_is_told_so(room: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "embreex", None)
    monkeypatch.delitem(sys.modules, "embreex.rtcore_scene", raising=False)
    monkeypatch.delitem(sys.modules, "embreex.mesh_construction", raising=False)
    with pytest.raises(MissingExtraError, match=r"embreex.*everything but the simulator"):
        CpuRenderer(room)


def test_small_house_is_closed_and_bright(small_house: Path) -> None:
    renderer = CpuRenderer(read_scene(small_house))
    view = renderer.render(CAMERA, looking(0.45, -0.8, 90.0))
    assert (view.instance_ids >= 0).all()
    assert 100 < view.rgb.mean() < 220
    assert view.rgb.std() > 20


@pytest.mark.parametrize("wrap", list(Wrap))
def test_strange_numbers_in_a_file_are_survived(wrap: Wrap) -> None:
    image = np.random.default_rng(0).integers(0, 256, (32, 32, 3), dtype=np.uint8)
    scene = wall(textured(image, wrap), unlit=False)
    uv = scene.uv.copy()
    uv[0], uv[1, 0] = np.inf, np.nan
    uv[1, 1] = 1e30
    normals = np.full((2, 3, 3), np.nan, np.float32)
    needle = scene.vertices.copy()
    needle[2] = needle[1] + np.array([0.0, 1e-7, 1e-7], np.float32)
    for strange in (
        replace(scene, uv=uv),
        replace(scene, normals=normals),
        replace(scene, vertices=needle, uv=uv, normals=normals),
        replace(scene, uv=scene.uv * np.float32(1e20)),
    ):
        renderer = CpuRenderer(strange)
        for pose in (looking(-1.0, 0.0, 0.0, 0.0), looking(0.0, -3.0, 90.0, 0.0)):
            view = renderer.render(CAMERA, pose)
            assert np.isfinite(view.depth).all()


def test_without_colours_depth_and_instances_are_the_same():
    scene = scene_of(*room_boxes(), ("bed", (2.0, 1.0, 0.0), (4.0, 3.0, 0.6)))
    pose = Pose2(1.0, 2.0, 0.3).to_transform() @ optical_to_base(0.88, 0.0)
    camera = PinholeCamera.from_hfov(160, 120, 79.0)
    seen = CpuRenderer(scene).render(camera, pose)
    blind = CpuRenderer(scene, RenderConfig(colours=False)).render(camera, pose)
    assert np.array_equal(blind.depth, seen.depth)
    assert np.array_equal(blind.instance_ids, seen.instance_ids)
    assert seen.rgb.any()
    assert not blind.rgb.any()
