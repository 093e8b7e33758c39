"""The GPU renderer shows what the CPU renderer shows; without a GPU, Warp runs it on the CPU."""

import logging
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.data.scenes import load_scene
from hypernav.core.errors import MissingExtraError
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.world import RenderedView
from hypernav.simulator.worlds.config import SimulationConfig
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig, renderer_of
from hypernav.simulator.worlds.drawing.warp_renderer import WarpRenderer
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.scenes.scene import Material, Scene, Wrap
from hypernav.simulator.worlds.simulation import SimulatedWorld
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

CAMERA = PinholeCamera.from_hfov(160, 120, 79.0)
SMALL = PinholeCamera.from_hfov(40, 30, 79.0)
SCREEN = 6
LONGEST_ERROR_M = 1e-3
LEAST_EQUAL_DEPTH = 0.999
LEAST_EQUAL_IDS = 0.998
MOST_COLOUR_ERROR = 2.0  # mean over an image, of 255; the CPU renderer smooths edges alone


@pytest.fixture(scope="module")
def warp() -> ModuleType:
    reason = "needs the package warp-lang: pip install 'hypernav[gpu]'"
    return pytest.importorskip("warp", reason=reason)


@pytest.fixture
def scene() -> Scene:
    """A textured room without ceiling; a bed lies on its floor, and a screen stands above it."""
    image = np.random.default_rng(0).integers(0, 256, (32, 32, 3), dtype=np.uint8)
    bed = ("bed", (3.0, 1.0, 0.0), (4.5, 2.6, 0.6))
    screen = ("screen", (2.2, 1.2, 0.02), (2.3, 3.0, 1.3))
    plain = scene_of(*room_boxes(ceiling=False), bed, screen)
    corners = plain.vertices[plain.faces]
    return replace(
        plain,
        uv=corners[..., [0, 2]] + corners[..., [1, 1]] - 3.0,
        materials=(Material("picture", (0.9, 1.0, 0.8), image),),
    )


def poses_in(scene: Scene, count: int) -> list[Transform]:
    """Cameras where a robot can stand, at several heights and pitches."""
    rng = np.random.default_rng(1)
    floor = WalkableGrid.from_scene(scene)
    low, high = scene.vertices.min(axis=0), scene.vertices.max(axis=0)
    places = [floor.nearest_standable(*rng.uniform(low[:2], high[:2])) for _ in range(count)]
    return [
        Pose2(place[0], place[1], rng.uniform(-3.0, 3.0)).to_transform()
        @ optical_to_base(rng.uniform(0.3, 1.5), rng.uniform(-20.0, 30.0))
        for place in places
    ]


def assert_alike(seen: RenderedView, expected: RenderedView) -> None:
    assert (np.abs(seen.depth - expected.depth) <= LONGEST_ERROR_M).mean() >= LEAST_EQUAL_DEPTH
    assert (seen.instance_ids == expected.instance_ids).mean() >= LEAST_EQUAL_IDS
    assert np.abs(seen.rgb.astype(int) - expected.rgb).mean() < MOST_COLOUR_ERROR


def assert_same_bytes(seen: RenderedView, expected: RenderedView) -> None:
    assert np.array_equal(seen.rgb, expected.rgb)
    assert np.array_equal(seen.depth, expected.depth)
    assert np.array_equal(seen.instance_ids, expected.instance_ids)


@pytest.mark.usefixtures("warp")
@pytest.mark.parametrize("name", ["builtin", "houses:100"])
def test_buildings_look_as_on_the_cpu(name: str) -> None:
    scene = load_scene(name)
    poses = poses_in(scene, 6)
    cpu, gpu = CpuRenderer(scene), WarpRenderer(scene)
    for pose, seen in zip(poses, gpu.render_batch(CAMERA, poses), strict=True):
        assert_alike(seen, cpu.render(CAMERA, pose))


@pytest.mark.usefixtures("warp")
@pytest.mark.slow
def test_a_furnished_house_made_by_others_looks_as_on_the_cpu(small_house: Path) -> None:
    scene = read_scene(small_house)
    poses = poses_in(scene, 12)
    cpu, gpu = CpuRenderer(scene), WarpRenderer(scene)
    for pose, seen in zip(poses, gpu.render_batch(CAMERA, poses), strict=True):
        assert_alike(seen, cpu.render(CAMERA, pose))


@pytest.mark.usefixtures("warp")
@pytest.mark.parametrize("wrap", list(Wrap))
def test_textures_with_holes_show_what_is_behind(scene: Scene, wrap: Wrap) -> None:
    image = np.random.default_rng(2).integers(0, 256, (16, 16, 3), dtype=np.uint8)
    opaque = np.random.default_rng(3).random((16, 16)) < 0.5
    lace = Material("lace", (1.0, 1.0, 1.0), image, (wrap, wrap), opaque)
    laced = replace(
        scene,
        materials=(*scene.materials, lace),
        face_material=np.where(scene.face_instance == SCREEN, 1, 0).astype(np.int32),
    )
    solid = replace(laced, materials=(*scene.materials, replace(lace, opaque=None)))
    config = RenderConfig(antialias=False)
    cpu, gpu = CpuRenderer(laced, config), WarpRenderer(laced, config)
    for yaw in (-0.6, 0.1, 0.7):
        pose = Pose2(1.0, 2.0, yaw).to_transform() @ optical_to_base(0.88)
        seen = gpu.render(CAMERA, pose)
        assert_alike(seen, cpu.render(CAMERA, pose))
        solid_ids = CpuRenderer(solid).render(CAMERA, pose).instance_ids
        assert (seen.instance_ids != solid_ids).mean() > 0.02


@pytest.mark.usefixtures("warp")
def test_a_scan_is_seen_from_the_front_alone(scene: Scene) -> None:
    scan = replace(scene, stored_z_up=True, unlit=True)  # the floor lies on the bed's underside
    config = RenderConfig(antialias=False)
    cpu, gpu = CpuRenderer(scan, config), WarpRenderer(scan, config)
    outside = Pose2(-3.0, 2.0, 0.2).to_transform() @ optical_to_base(0.9)
    inside_the_bed = Pose2(3.5, 2.0, 0.2).to_transform() @ optical_to_base(0.3)
    for pose in (outside, inside_the_bed, *poses_in(scene, 4)):
        assert_alike(gpu.render(CAMERA, pose), cpu.render(CAMERA, pose))
    two_sided = WarpRenderer(replace(scan, stored_z_up=False)).render(CAMERA, inside_the_bed)
    seen = gpu.render(CAMERA, inside_the_bed)
    assert (seen.instance_ids != two_sided.instance_ids).mean() > 0.5


@pytest.mark.usefixtures("warp")
def test_a_batch_equals_its_views_one_by_one_in_any_order(scene: Scene) -> None:
    poses = poses_in(scene, 4)
    batch = WarpRenderer(scene).render_batch(SMALL, poses)
    alone = WarpRenderer(scene)
    for pose, seen in reversed(list(zip(poses, batch, strict=True))):
        assert_same_bytes(alone.render(SMALL, pose), seen)
        assert_same_bytes(alone.render(SMALL, pose), seen)
    assert alone.render_batch(SMALL, []) == []


@pytest.mark.usefixtures("warp")
def test_without_colours_depth_and_instances_are_the_same(scene: Scene) -> None:
    pose = poses_in(scene, 1)[0]
    gpu = WarpRenderer(scene, RenderConfig(colours=False))
    blind = gpu.render(SMALL, pose)
    gpu.colours = True
    seen = gpu.render(SMALL, pose)
    assert not blind.rgb.any()
    assert seen.rgb.any()
    assert np.array_equal(blind.depth, seen.depth)
    assert np.array_equal(blind.instance_ids, seen.instance_ids)


@pytest.mark.usefixtures("warp")
def test_light_colours_and_background_are_those_of_the_configuration(scene: Scene) -> None:
    rng = np.random.default_rng(4)
    a, b, c = np.moveaxis(scene.vertices[scene.faces], 1, 0)
    flat = np.cross(b - a, c - a)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    normals = flat[:, None] + rng.uniform(-0.3, 0.3, (len(flat), 3, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    colors = rng.integers(0, 256, scene.colors.shape, dtype=np.uint8)
    coloured = replace(scene, normals=normals, colors=colors)
    config = RenderConfig(
        exposure=1.1,
        ambient=0.7,
        headlight=0.4,
        light_cell_m=0.2,
        background=(9, 99, 200),
        antialias=False,
    )
    pose = Pose2(0.5, 2.0, 0.1).to_transform() @ optical_to_base(1.2, -15.0)
    for one in (scene, coloured, replace(coloured, unlit=True)):
        seen = WarpRenderer(one, config).render(CAMERA, pose)
        expected = CpuRenderer(one, config).render(CAMERA, pose)
        # Without further rays, what is left is the rounding of numbers.
        assert (np.abs(seen.rgb.astype(int) - expected.rgb) <= 1).mean() > 0.98
        assert (seen.rgb[seen.instance_ids < 0] == config.background).all()
        assert 0.1 < (seen.instance_ids < 0).mean() < 0.9


@pytest.mark.usefixtures("warp")
def test_strange_numbers_in_a_file_are_survived(scene: Scene) -> None:
    uv = scene.uv.copy()
    uv[:, 0], uv[:, 1, 0] = np.inf, np.nan
    uv[:, 2] = 1e30
    normals = np.full((len(scene.faces), 3, 3), np.nan, np.float32)
    pose = poses_in(scene, 1)[0]
    plain = WarpRenderer(scene).render(SMALL, pose)
    seen = WarpRenderer(replace(scene, uv=uv, normals=normals)).render(SMALL, pose)
    assert np.array_equal(seen.depth, plain.depth)
    assert np.array_equal(seen.instance_ids, plain.instance_ids)


@pytest.mark.usefixtures("warp")
def test_a_simulated_world_is_drawn_as_its_configuration_says(scene: Scene) -> None:
    pose = poses_in(scene, 1)[0]
    views = [
        SimulatedWorld(scene, SimulationConfig(renderer=name)).view_from(pose)
        for name in ("cpu", "warp")
    ]
    assert_alike(*views)
    assert isinstance(renderer_of(scene, "warp"), WarpRenderer)


def test_the_kernels_compile_for_a_gpu(warp: ModuleType, tmp_path: Path) -> None:
    from hypernav.simulator.worlds.drawing import warp_kernels

    warp.compile_aot_module(warp_kernels, arch=75, module_dir=tmp_path, use_ptx=True)
    code = "".join(file.read_text() for file in tmp_path.glob("*.ptx"))
    for kernel in ("find_surfaces", "want_light", "bake_light", "shade"):
        assert f".entry {kernel}" in code


def test_without_a_gpu_it_says_that_it_draws_on_the_cpu(
    warp: ModuleType,
    scene: Scene,
    caplog: pytest.LogCaptureFixture,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(warp, "is_cuda_available", lambda: False)
    with caplog.at_level(logging.WARNING, "hypernav"):
        assert WarpRenderer(scene).device == "cpu"
    assert "finds no CUDA device and draws on its CPU back end" in caplog.text


def test_without_warp_the_error_names_the_extra(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "warp", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'hypernav\[gpu\]'"):
        SimulatedWorld(scene, SimulationConfig(renderer="warp"))
