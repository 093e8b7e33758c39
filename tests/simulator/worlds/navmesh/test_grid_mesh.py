"""Grids of standable cells as navigation meshes."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from hypernav.core.errors import NavmeshError
from hypernav.simulator.worlds.navmesh.grid_mesh import mesh_from_grid, outlines
from hypernav.simulator.worlds.navmesh.navmesh_surface import NavmeshSurface
from hypernav.simulator.worlds.surface.walkable import WalkableGrid
from navmesh_files import navmesh_from

masks = hnp.arrays(
    np.int8, st.tuples(st.integers(1, 14), st.integers(1, 14)), elements=st.integers(0, 3)
).map(lambda m: m != 0)


def _area(points: np.ndarray) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2.0)


@settings(max_examples=200, deadline=None)
@given(masks)
def test_outlines_hold_the_cells_and_leave_out_the_holes(mask: np.ndarray) -> None:
    lines = outlines(mask, 0.0)
    # A corner of the outline cuts an eighth of a cell off.
    assert sum(_area(line.points) for line in lines) == pytest.approx(
        mask.sum(), abs=mask.sum() / 2
    )
    for line in lines:
        assert mask[line.cells[:, 0], line.cells[:, 1]].all()
        gaps = np.abs(line.points - line.cells[:, ::-1] - 0.5)
        assert np.allclose(gaps.sum(axis=1), 0.5)


def test_a_smooth_wall_drawn_in_cells_becomes_one_side() -> None:
    (line,) = outlines(np.tri(40, dtype=bool), 0.34)
    assert len(line.points) < 8


@settings(max_examples=150, deadline=None)
@given(masks.filter(lambda mask: mask.any()))
def test_polygons_are_joined_as_the_cells_are(mask: np.ndarray) -> None:
    grid = WalkableGrid.from_mask(mask, cell_m=0.25, origin=(-1.0, 2.0), floor_z=0.5)
    surface = NavmeshSurface(navmesh_from(mesh_from_grid(grid)))
    assert surface.navmesh.area_m2 <= mask.sum() * 0.25**2 * 1.1
    centres = [grid.centres(part) for part in range(grid.components.max() + 1)]
    for part in centres:
        for x, y in part.tolist():
            assert surface.height_at(x, y) == pytest.approx(0.5)
    for part in centres:
        for other in centres:
            length = surface.distance((*part[0].tolist(), 0.5), (*other[-1].tolist(), 0.5))
            assert math.isfinite(length) == (part is other)


def test_a_mesh_has_the_heights_of_the_grid() -> None:
    mask = np.ones((20, 40), dtype=bool)
    heights = np.linspace(0.0, 1.0, 40, dtype=np.float32) * np.ones((20, 1), dtype=np.float32)
    flat = WalkableGrid.from_mask(mask)
    grid = WalkableGrid(mask, heights, flat.components, flat.cell_m, flat.origin, 0.5)
    surface = NavmeshSurface(navmesh_from(mesh_from_grid(grid)))
    for x in (0.1, 0.5, 1.0, 1.9):
        assert surface.height_at(x, 0.5) == pytest.approx(grid.height_at(x, 0.5), abs=0.03)


def test_nothing_to_stand_on_is_no_mesh() -> None:
    with pytest.raises(NavmeshError, match="no standable cell"):
        mesh_from_grid(WalkableGrid.from_mask(np.zeros((3, 3), dtype=bool)))
