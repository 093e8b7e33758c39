import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from hypernav.core.errors import MapError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.search.mapping.ros_map import load_ros_map, save_ros_map

grids = st.builds(
    OccupancyGrid,
    arrays(np.uint8, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.integers(0, 2)),
    st.just(0.05),
    st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
)


def map_server_value(shade, facts):
    """nav2_map_server's rule for one pixel in trinary mode, written down independently."""
    occupancy = (255 - shade) / 255.0
    if occupancy > facts["occupied_thresh"]:
        return 100
    return 0 if occupancy < facts["free_thresh"] else -1


@given(grids)
def test_a_saved_map_reads_back_as_it_was(tmp_path_factory, grid):
    path = save_ros_map(grid, tmp_path_factory.mktemp("map"))
    loaded = load_ros_map(path)
    np.testing.assert_array_equal(loaded.cells, grid.cells)
    assert loaded.resolution_m == grid.resolution_m
    assert loaded.origin == pytest.approx(grid.origin, abs=1e-6)


def test_map_server_reads_the_three_states_and_the_first_row_is_the_top(tmp_path):
    cells = np.array([[Cell.FREE, Cell.FREE], [Cell.UNKNOWN, Cell.OCCUPIED]], dtype=np.uint8)
    path = save_ros_map(OccupancyGrid(cells, 0.05, (1.0, 2.0)), tmp_path)
    facts = yaml.safe_load(path.read_text())
    with Image.open(tmp_path / facts["image"]) as image:
        assert image.format == "PPM"
        shades = np.asarray(image)
    values = [[map_server_value(int(shade), facts) for shade in row] for row in shades]
    assert values == [[-1, 100], [0, 0]]
    assert facts["origin"] == [1.0, 2.0, 0.0]
    assert (facts["mode"], facts["negate"]) == ("trinary", 0)


def test_a_map_drawn_by_others_is_read(test_data):
    grid = load_ros_map(test_data / "scenes" / "small_house" / "slam_map" / "map.yaml")
    assert grid.resolution_m == 0.05
    assert grid.free.sum() * grid.resolution_m**2 > 80.0
    assert 0 < grid.occupied.sum() < grid.free.sum()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("image: [", "not valid YAML"),
        ("just a text", "expected the keys"),
        ("image: map.pgm", "expected image, resolution"),
        (
            "{image: no.pgm, resolution: 1, origin: [0, 0, 0], occupied_thresh: 1, free_thresh: 0}",
            "cannot read its image",
        ),
        (
            "{image: no.pgm, resolution: 1, origin: [0, 0, 1], occupied_thresh: 1, free_thresh: 0}",
            "turned",
        ),
        (
            "{image: no.pgm, resolution: 0, origin: [0, 0, 0], occupied_thresh: 1, free_thresh: 0}",
            "resolution must be positive",
        ),
        (
            "{image: a, resolution: 1, origin: [0, 0, x], occupied_thresh: 1, free_thresh: 0}",
            "expected image, resolution",
        ),
    ],
)
def test_a_broken_map_says_what_is_wrong(tmp_path, content, words):
    path = tmp_path / "map.yaml"
    path.write_text(content)
    with pytest.raises(MapError, match=words):
        load_ros_map(path)


def test_a_missing_map_is_named(tmp_path):
    with pytest.raises(MapError, match=r"nowhere\.yaml"):
        load_ros_map(tmp_path / "nowhere.yaml")
