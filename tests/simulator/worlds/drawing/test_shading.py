from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.simulator.worlds.drawing.rays import RayCaster
from hypernav.simulator.worlds.drawing.shading import LightGrid

UP, DOWN = 4, 5


@pytest.fixture(scope="module")
def caster() -> RayCaster:
    boxes = [*room_boxes(ceiling=False), ("table", (3.0, 1.0, 0.7), (4.2, 2.6, 0.75))]
    return RayCaster(scene_of(*boxes))


def grid_of(caster: RayCaster, cell_m: float = 0.25) -> LightGrid:
    return LightGrid(np.zeros(3), np.array([6.0, 4.0, 2.5]), cell_m, caster.distances)


def bake_all(grid: LightGrid, cells: np.ndarray) -> None:
    with ThreadPoolExecutor(2) as pool:
        grid.bake(cells, pool)


def cell_at(grid: LightGrid, x: float, y: float, z: float) -> int:
    i, j, k = ((np.array([x, y, z]) - grid.origin) / grid.cell_m).astype(int)
    return int(np.ravel_multi_index((k, j, i), grid.nodes.shape[:3]))


def light_at(grid: LightGrid, x: float, y: float, z: float) -> np.ndarray:
    cell = cell_at(grid, x, y, z)
    bake_all(grid, np.array([cell]))
    return grid.nodes.reshape(-1, 8)[cell, :6].astype(int)


def test_light_comes_from_above(caster: RayCaster) -> None:
    middle = light_at(grid_of(caster), 1.5, 2.0, 1.2)
    assert middle[UP] > middle[:4].max() > middle[DOWN]


def test_a_table_takes_the_light_from_below_it(caster: RayCaster) -> None:
    grid = grid_of(caster)
    assert light_at(grid, 3.6, 1.8, 0.3)[UP] < 0.6 * light_at(grid, 1.5, 2.0, 0.3)[UP]


def test_only_the_corners_of_wanted_cells_are_computed(caster: RayCaster) -> None:
    grid = grid_of(caster)
    bake_all(grid, np.array([cell_at(grid, 1.5, 2.0, 1.2)]))
    assert int(grid.nodes[..., 7].sum()) == 8
    assert grid.nodes[grid.nodes[..., 7] == 0].max() == 0


def test_light_does_not_depend_on_the_order_of_looks(caster: RayCaster) -> None:
    grid, other = grid_of(caster), grid_of(caster)
    layers, rows, columns = grid.nodes.shape[:3]
    corners = np.indices((layers - 1, rows - 1, columns - 1)).reshape(3, -1)
    inside = np.arange(layers * rows * columns).reshape(layers, rows, columns)[tuple(corners)]
    bake_all(grid, inside)
    for part in np.array_split(np.random.default_rng(0).permutation(inside), 5):
        bake_all(other, part)
    np.testing.assert_array_equal(grid.nodes, other.nodes)


def test_vast_scenes_get_a_coarser_grid(caster: RayCaster) -> None:
    vast = LightGrid(np.zeros(3), np.array([900.0, 900.0, 30.0]), 0.08, caster.distances)
    assert vast.nodes.size < 80_000_000
    assert vast.cell_m > 0.5
