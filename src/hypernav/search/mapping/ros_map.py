"""Maps on disk as ROS reads them: ``map.pgm`` and ``map.yaml``."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from jaxtyping import Int8
from PIL import Image

from hypernav.core.errors import MapError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.io.parsing import MOST_CHARACTERS, parse_yaml
from hypernav.io.reading import MOST_PIXELS, read_file, text_of
from hypernav.io.writing import write_whole

OCCUPIED_THRESHOLD = 0.65
FREE_THRESHOLD = 0.196
_SHADES = np.array([205, 254, 0], dtype=np.uint8)
_OCCUPANCY = np.array([-1, 0, 100], dtype=np.int8)


def save_ros_map(grid: OccupancyGrid, folder: Path, name: str = "map") -> Path:
    """Write a map for Nav2's map_server; see `ros_map_files`. Each file is replaced as a whole.

    Args:
        grid: The map.
        folder: Folder for both files; made if missing.
        name: Name of both files, without ending.

    Returns:
        Path of the YAML file.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for file, content in ros_map_files(grid, name).items():
        write_whole(folder / file, content)
    return folder / f"{name}.yaml"


def ros_map_files(grid: OccupancyGrid, name: str = "map") -> dict[str, bytes]:
    """The image and the YAML file of a map for Nav2's map_server, by name.

    Shades and thresholds are those of map_saver: free 254, occupied 0, unknown 205. The thresholds
    0.65 and 0.196 read them back as the same three states; with map_saver's newer free threshold of
    0.25, unknown cells would be read as free. The image's first row is the map's highest y.

    Source: nav2_map_server, ``map_io.cpp``.

    Args:
        grid: The map.
        name: Name of both files, without ending.
    """
    rows, columns = grid.cells.shape
    pixels = _SHADES[grid.cells[::-1]].tobytes()
    facts = {
        "image": f"{name}.pgm",
        "mode": "trinary",
        "resolution": float(grid.resolution_m),
        "origin": [round(float(grid.origin[0]), 6), round(float(grid.origin[1]), 6), 0.0],
        "negate": 0,
        "occupied_thresh": OCCUPIED_THRESHOLD,
        "free_thresh": FREE_THRESHOLD,
    }
    text = yaml.safe_dump(facts, sort_keys=False, default_flow_style=None)
    return {
        f"{name}.pgm": f"P5\n{columns} {rows}\n255\n".encode() + pixels,
        f"{name}.yaml": text.encode(),
    }


def occupancy(grid: OccupancyGrid) -> Int8[np.ndarray, "rows columns"]:
    """The cells as ``nav_msgs/OccupancyGrid`` has them: -1 unknown, 0 free, 100 occupied."""
    return _OCCUPANCY[grid.cells]


def load_ros_map(path: Path) -> OccupancyGrid:
    """Read a map as Nav2's map_server does in trinary mode.

    Args:
        path: Path of the YAML file.

    Raises:
        MapError: A file is missing, broken or too large, or the map is turned, as no grid can be.
    """
    facts = _read_facts(path)
    try:
        resolution, (x, y, yaw) = float(facts["resolution"]), map(float, facts["origin"])
        occupied, free = float(facts["occupied_thresh"]), float(facts["free_thresh"])
        image = path.parent / str(facts["image"])
        negate, corner = bool(facts.get("negate", 0)), (x, y)
    except (KeyError, TypeError, ValueError) as error:
        raise MapError(
            f"{path}: expected image, resolution, origin [x, y, yaw], occupied_thresh and "
            f"free_thresh, got {facts}"
        ) from error
    if not (resolution > 0.0 and np.isfinite([resolution, x, y]).all()):
        raise MapError(
            f"{path}: resolution must be positive and the origin finite, got {resolution} m and "
            f"{corner}"
        )
    if yaw != 0.0:
        raise MapError(f"{path}: a map turned by {yaw} rad cannot be read; save it unturned")
    try:
        with Image.open(io.BytesIO(read_file(image))) as opened:
            if opened.width * opened.height > MOST_PIXELS:
                raise MapError(
                    f"{path}: its image has {opened.width} × {opened.height} pixels, at most "
                    f"{MOST_PIXELS:,} are read; save a smaller map"
                )
            shades = np.asarray(opened.convert("L"), dtype=np.float64)
    except (OSError, ValueError, Image.DecompressionBombError) as error:
        raise MapError(f"{path}: cannot read its image {image}: {error}") from error
    darkness = shades / 255.0 if negate else (255.0 - shades) / 255.0
    cells = np.full(shades.shape, Cell.UNKNOWN, dtype=np.uint8)
    cells[darkness > occupied] = Cell.OCCUPIED
    cells[darkness < free] = Cell.FREE
    return OccupancyGrid(np.ascontiguousarray(cells[::-1]), resolution, corner)


def _read_facts(path: Path) -> dict[str, Any]:
    try:
        facts = parse_yaml(text_of(read_file(path, most=4 * MOST_CHARACTERS)))
    except OSError as error:
        raise MapError(f"cannot read the map {path}: {error.strerror}") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise MapError(f"{path} is not valid YAML: {error}") from error
    if not isinstance(facts, dict):
        raise MapError(f"{path}: expected the keys of a ROS map, got {facts!r:.60}")
    return facts
