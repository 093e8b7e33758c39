"""The map as files of common formats."""

import io
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.mapping.ros_map import occupancy, save_ros_map

_COLORS = np.array([[128, 128, 128, 0], [255, 255, 255, 255], [30, 30, 30, 255]], dtype=np.uint8)


def map_png(grid: OccupancyGrid) -> bytes:
    """One pixel a cell, y up: free white, occupied black, unknown transparent."""
    encoded = io.BytesIO()
    Image.fromarray(_COLORS[grid.cells[::-1]]).save(encoded, "PNG", compress_level=1)
    return encoded.getvalue()


def map_server_file(grid: OccupancyGrid, name: str) -> bytes:
    """``map.pgm`` or ``map.yaml``, for Nav2's map_server."""
    with tempfile.TemporaryDirectory() as folder:
        save_ros_map(grid, Path(folder))
        return (Path(folder) / name).read_bytes()


def occupancy_grid(grid: OccupancyGrid) -> dict[str, object]:
    """The map with the fields of ``nav_msgs/OccupancyGrid``: -1 unknown, 0 free, 100 occupied."""
    rows, columns = grid.cells.shape
    x, y = (round(value, 6) for value in grid.origin)
    return {
        "header": {"frame_id": "map"},
        "info": {
            "resolution": grid.resolution_m,
            "width": columns,
            "height": rows,
            "origin": {
                "position": {"x": x, "y": y, "z": 0.0},
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        },
        "data": occupancy(grid).ravel().tolist(),
    }
