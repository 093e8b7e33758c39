"""Laws of single stages, on random scenes: from voxels to detail meshes."""

from typing import NamedTuple

import numpy as np
import pytest

from hypernav.core.embodiment import BodyConfig
from hypernav.simulator.worlds.navmesh.file_format import robot_in_voxels, settings_for
from hypernav.simulator.worlds.navmesh.recast_detour.recast_contours import (
    Contour,
    area2,
    crosses,
    join_holes,
    touches,
    trace_contours,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_detail import (
    Detail,
    Sampling,
    delaunay,
    detail_meshes,
    triangles_of_hull,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_polygons import (
    Polygons,
    convex_polygons,
    neighbours,
    triangulate,
)
from hypernav.simulator.worlds.navmesh.recast_detour.recast_regions import join_regions, watershed
from hypernav.simulator.worlds.navmesh.recast_detour.recast_voxels import (
    NOTHING,
    OpenSpace,
    Solid,
    ceilings,
    drop_ledges,
    drop_low_ceilings,
    erode,
    keep_low_obstacles,
    open_space,
    rasterize,
    smooth_distances,
    walkable_triangles,
)
from random_triangles import Triangles, random_scene

_SETTINGS = settings_for(BodyConfig(radius_m=0.18, height_m=0.88))
_HEIGHT, _CLIMB, _RADIUS = robot_in_voxels(_SETTINGS)
_CELLS = np.array([_SETTINGS["cell_size"], _SETTINGS["cell_height"]])


class Stages(NamedTuple):
    """What the stages make of one scene."""

    scene: Triangles
    raw: Solid
    solid: Solid
    width: int
    before: OpenSpace
    space: OpenSpace
    regions: np.ndarray
    contours: list[Contour]
    outlines: list[Contour]
    polygons: Polygons
    details: list[Detail]


def copied(solid: Solid) -> Solid:
    return Solid(*(array.copy() for array in solid))


@pytest.fixture(scope="module", params=range(6))
def stages(request: pytest.FixtureRequest) -> Stages:
    scene = random_scene(np.random.default_rng([request.param, 3]))
    bounds = np.stack([scene.vertices.min(axis=0), scene.vertices.max(axis=0)])
    width, _, depth = ((bounds[1] - bounds[0]) / _CELLS[0] + np.float32(0.5)).astype(int).tolist()
    up = walkable_triangles(scene.vertices, scene.faces, np.cos(np.float32(np.pi / 4)))
    raw = rasterize(scene.vertices, scene.faces, up, bounds, (depth, width), _CELLS, _CLIMB)
    solid = copied(raw)
    keep_low_obstacles(solid, _CLIMB)
    drop_ledges(solid, width, _HEIGHT, _CLIMB)
    drop_low_ceilings(solid, _HEIGHT)
    before = open_space(solid, width, _HEIGHT, _CLIMB)
    space = before._replace(walkable=before.walkable.copy())
    erode(space, _RADIUS)
    regions, _ = join_regions(space, *watershed(space, *smooth_distances(space)), 400, 400)
    contours = trace_contours(space, regions, np.float32(1.3), 240)
    outlines = join_holes(contours)
    polygons = convex_polygons(outlines)
    sampling = Sampling(
        *(np.float32(value) for value in (*_CELLS, _CELLS[0] * np.float32(6.0), _CELLS[1])), reach=2
    )
    details = detail_meshes(space, regions, polygons, bounds[0], sampling)
    return Stages(
        *(scene, raw, solid, width, before, space),
        *(regions, contours, outlines, polygons, details),
    )


def test_spans_of_a_column_lie_apart_and_in_order(stages: Stages) -> None:
    solid = stages.raw
    assert (solid.low < solid.high).all()
    same = np.ones(len(solid.low) - 1, dtype=bool)
    same[solid.start[1:-1][(solid.start[1:-1] > 0) & (solid.start[1:-1] < len(solid.low))] - 1] = 0
    assert (solid.low[1:][same] > solid.high[:-1][same]).all()


def test_every_vertex_lies_in_a_span(stages: Stages) -> None:
    solid, low = stages.raw, stages.scene.vertices.min(axis=0)
    depth = (len(solid.start) - 1) // stages.width
    x, y, z = (stages.scene.vertices - low).T
    x, z = (x / _CELLS[0]).astype(int), (z / _CELLS[0]).astype(int)
    inside = (x < stages.width) & (z < depth)
    assert inside.any()
    for column, height in zip((x + z * stages.width)[inside], y[inside], strict=True):
        own = slice(solid.start[column], solid.start[column + 1])
        voxel = height / _CELLS[1]
        assert ((solid.low[own] <= voxel + 1e-3) & (voxel - 1e-3 <= solid.high[own])).any()


def test_what_can_be_stood_on_has_room_above_it(stages: Stages) -> None:
    solid = stages.solid
    assert solid.walkable.any()
    assert (ceilings(solid) - solid.high)[solid.walkable].min() >= _HEIGHT


def test_ledges_and_ceilings_only_take_away(stages: Stages) -> None:
    kept = copied(stages.raw)
    keep_low_obstacles(kept, _CLIMB)
    assert (kept.walkable >= stages.raw.walkable).all()
    assert (kept.walkable >= stages.solid.walkable).all()


def test_neighbours_are_mutual_beside_each_other_and_within_a_climb(stages: Stages) -> None:
    space = stages.before
    for direction, (step_x, step_z) in enumerate(((-1, 0), (0, 1), (1, 0), (0, -1))):
        i = np.flatnonzero(space.neighbours[:, direction] != NOTHING)
        j = space.neighbours[i, direction]
        assert (space.x[j] - space.x[i] == step_x).all()
        assert (space.z[j] - space.z[i] == step_z).all()
        assert (np.abs(space.floor[j] - space.floor[i]) <= _CLIMB).all()
        assert (space.neighbours[j, (direction + 2) % 4] == i).all()


def test_erosion_only_shrinks_and_more_of_it_shrinks_more(stages: Stages) -> None:
    smaller = stages.before._replace(walkable=stages.before.walkable.copy())
    erode(smaller, _RADIUS + 2)
    assert stages.before.walkable.sum() > stages.space.walkable.sum() > smaller.walkable.sum()
    assert (stages.space.walkable >= smaller.walkable).all()


def test_distances_grow_by_no_more_than_a_step(stages: Stages) -> None:
    distance, greatest = smooth_distances(stages.space)
    assert 0 <= distance.min() <= distance.max() <= greatest
    i, direction = np.nonzero(stages.space.neighbours != NOTHING)
    # Two halves of a column from one to the next, and what smoothing rounds.
    assert np.abs(distance[stages.space.neighbours[i, direction]] - distance[i]).max() <= 3


def test_regions_lie_on_what_is_walkable_and_hang_together(stages: Stages) -> None:
    space, regions = stages.space, stages.regions
    assert regions.max() > 0
    assert not regions[~space.walkable].any()
    # All that is left without a region belongs to parts too small for one.
    for region in range(1, regions.max() + 1):
        spans = np.flatnonzero(regions == region)
        reached, front = {int(spans[0])}, [int(spans[0])]
        while front:
            for beside in space.neighbours[front.pop()].tolist():
                if beside != NOTHING and regions[beside] == region and beside not in reached:
                    reached.add(beside)
                    front.append(beside)
        assert len(reached) == len(spans)


def test_outlines_close_along_the_regions_cells(stages: Stages) -> None:
    assert stages.contours
    assert {c.region for c in stages.contours} <= set(range(1, stages.regions.max() + 1))
    for corners, region in stages.contours:
        assert len(corners) >= 3
        own = stages.regions == region
        assert corners[:, 0].min() >= stages.space.x[own].min()
        assert corners[:, 0].max() <= stages.space.x[own].max() + 1
        assert corners[:, 2].min() >= stages.space.z[own].min()
        assert corners[:, 2].max() <= stages.space.z[own].max() + 1


def test_polygons_are_convex_and_share_their_sides(stages: Stages) -> None:
    places = stages.polygons.vertices
    beyond = neighbours(stages.polygons.corners)
    for number, padded in enumerate(stages.polygons.corners):
        corners = places[padded[padded >= 0]]
        before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
        assert (area2(before, corners, after) <= 0).all()
        for side, other in enumerate(beyond[number][: len(corners)]):
            if other >= 0:
                assert number in beyond[other]
                ends = {padded[side], padded[(side + 1) % len(corners)]}
                assert ends <= set(stages.polygons.corners[other].tolist())


def test_polygons_cover_what_their_outlines_enclose(stages: Stages) -> None:
    outlined = sum(_area(contour.corners) for contour in stages.outlines)
    covered = sum(
        _area(stages.polygons.vertices[padded[padded >= 0]]) for padded in stages.polygons.corners
    )
    assert covered == pytest.approx(outlined)


def test_detail_meshes_cover_their_polygons(stages: Stages) -> None:
    low = stages.scene.vertices.min(axis=0)
    for padded, detail in zip(stages.polygons.corners, stages.details, strict=True):
        corners = stages.polygons.vertices[padded[padded >= 0]]
        placed = corners[:, [0, 2]] * _CELLS[0] + low[[0, 2]]
        assert np.allclose(detail.points[: len(corners), [0, 2]], placed, atol=1e-4)
        triangles = detail.points[detail.triangles[:, :3].astype(int)].astype(np.float64)
        total = sum(abs(_area(triangle)) for triangle in triangles)
        # Vertices on sides lie where the side does, but for single precision.
        assert total == pytest.approx(_area(corners) * _CELLS[0] ** 2, rel=1e-2)


@pytest.mark.parametrize("seed", range(20))
def test_ears_cut_a_star_without_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.linspace(0.0, -2 * np.pi, int(rng.integers(4, 15)), endpoint=False)
    reach = rng.integers(20, 200, len(angles))
    star = np.zeros((len(angles), 4), dtype=np.int64)
    star[:, 0], star[:, 2] = (reach * np.cos(angles)).round(), (-reach * np.sin(angles)).round()
    star = star if _area(star) > 0 else star[::-1]
    parts = triangulate(star)
    assert len(parts) == len(star) - 2
    assert sum(_area(star[list(part)]) for part in parts) == pytest.approx(_area(star))
    assert all(_area(star[list(part)]) >= 0 for part in parts)


def test_a_hole_is_joined_by_a_bridge_there_and_back() -> None:
    square = np.array([[0, 0, 0, 0], [0, 0, 20, 0], [20, 0, 20, 0], [20, 0, 0, 0]])
    hole = np.array([[8, 0, 8, 0], [12, 0, 8, 0], [12, 0, 12, 0], [8, 0, 12, 0]])
    joined, emptied = join_holes([Contour(square, 1), Contour(hole, 1)])
    assert len(emptied.corners) == 0
    # Both turns close, and each end of the bridge comes twice.
    assert len(joined.corners) == len(square) + len(hole) + 2
    assert abs(_area(joined.corners)) == 20 * 20 - 4 * 4


def test_segments_that_only_touch_do_not_cross() -> None:
    a, b, c, d = np.array([[0, 0, 0], [4, 0, 0], [2, 0, 0], [2, 0, 3]])
    below = np.array([2, 0, -3])
    assert touches(a, b, c, d)
    assert not crosses(a, b, c, d)
    assert crosses(a, b, below, d)


@pytest.mark.parametrize("seed", range(10))
def test_both_triangulations_of_a_polygon_fill_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.uniform(0, 2 * np.pi, 6))[::-1]
    ring = np.zeros((6, 3), dtype=np.float32)
    ring[:, 0], ring[:, 2] = 3 * np.cos(angles), 3 * np.sin(angles)
    hull = list(range(6))
    inside = (0.3 * ring[:3].mean(axis=0) + 0.7 * ring.mean(axis=0)).astype(np.float32)
    whole = abs(_area(ring.astype(np.float64)))
    for points, faces in (
        (ring, triangles_of_hull(ring, hull, 6)),
        (np.vstack([ring, inside]), delaunay(np.vstack([ring, inside]), hull)),
    ):
        parts = points[np.array(faces)].astype(np.float64)
        assert sum(abs(_area(part)) for part in parts) == pytest.approx(whole, rel=1e-4)


def _area(corners: np.ndarray) -> float:
    """Area in the plane of x and z, as an outline of a region is traced."""
    x, z = corners[:, 0].astype(np.float64), corners[:, 2].astype(np.float64)
    return float((np.roll(x, -1) * z - x * np.roll(z, -1)).sum() / 2)
