"""The records of a navigation mesh file of habitat-sim, and the settings of its computation.

A file is a `SET_HEADER`, from version 2 on the `SETTINGS` that the mesh was computed with, and its
tiles: each a `TILE_REFERENCE` and the data that Detour's ``dtCreateNavMeshData`` made. These are a
`TILE_HEADER` and the arrays of `TILE_ARRAYS`, whose lengths it gives, each padded to four bytes.
Integers and floats have the byte order of the machine that wrote the file, shown by its magic
numbers.
Positions are in Habitat's frame: x right, y up, metres.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, UInt8

from hypernav.core.embodiment import BodyConfig

SET_MAGIC = int.from_bytes(b"MSET", "big")
TILE_MAGIC = int.from_bytes(b"DNAV", "big")
VERSIONS = (1, 2)
TILE_VERSION = 7

VERTICES_PER_POLYGON = 6
EXTERNAL = 0x8000
"""Flag of an edge that leads into a neighbouring tile; its direction is in the lowest byte."""
SIDES = (0, 2, 4, 6)
"""Directions of edges between tiles: towards +x, +z, -x, -z."""
WALKABLE = 0x01
"""Flag of a polygon that an agent may walk on."""


def _record(fields: str) -> np.dtype:
    """A packed record of fields, each ``name:format`` as numpy writes formats."""
    return np.dtype([(name, form) for name, form in (f.split(":") for f in fields.split())])


SET_HEADER = _record(
    "magic:<u4 version:<i4 tiles:<i4 origin:3<f4 tile_width:<f4 tile_height:<f4 most_tiles:<i4 "
    "most_polygons:<i4"
)
SETTINGS = _record(
    "cell_size:<f4 cell_height:<f4 agent_height:<f4 agent_radius:<f4 agent_max_climb:<f4 "
    "agent_max_slope:<f4 region_min_size:<f4 region_merge_size:<f4 edge_max_len:<f4 "
    "edge_max_error:<f4 verts_per_poly:<f4 detail_sample_dist:<f4 detail_sample_max_error:<f4 "
    "filter_low_hanging_obstacles:u1 filter_ledge_spans:u1 filter_walkable_low_height_spans:u1 "
    "include_static_objects:u1"
)
TILE_REFERENCE = _record("reference:<u4 size:<i4")
TILE_HEADER = _record(
    "magic:<u4 version:<i4 x:<i4 y:<i4 layer:<i4 user_id:<u4 polygons:<i4 vertices:<i4 "
    "most_links:<i4 detail_meshes:<i4 detail_vertices:<i4 detail_triangles:<i4 tree_nodes:<i4 "
    "off_mesh_connections:<i4 off_mesh_base:<i4 walkable_height:<f4 walkable_radius:<f4 "
    "walkable_climb:<f4 lowest:3<f4 highest:3<f4 quantisation:<f4"
)
POLYGON = _record(
    f"first_link:<u4 vertices:{VERTICES_PER_POLYGON}<u2 neighbours:{VERTICES_PER_POLYGON}<u2 "
    "flags:<u2 vertex_count:u1 area_and_type:u1"
)
DETAIL_MESH = _record(
    "vertex_base:<u4 triangle_base:<u4 vertex_count:u1 triangle_count:u1 padding:2u1"
)
TREE_NODE = _record("lowest:3<u2 highest:3<u2 index:<i4")
_DEFAULT_ROBOT = BodyConfig(radius_m=0.1, height_m=1.5)
"""Robot of a file without settings, as habitat-sim assumes."""


class TileArray(NamedTuple):
    """One array of a tile's data.

    Attributes:
        name: Its name in this package.
        length: Field of the header that gives its length.
        item: Type of its items.
    """

    name: str
    length: str
    item: np.dtype


TILE_ARRAYS = (
    TileArray("vertices", "vertices", np.dtype(("<f4", 3))),
    TileArray("polygons", "polygons", POLYGON),
    TileArray("links", "most_links", np.dtype("V12")),
    TileArray("details", "detail_meshes", DETAIL_MESH),
    TileArray("detail_vertices", "detail_vertices", np.dtype(("<f4", 3))),
    TileArray("detail_triangles", "detail_triangles", np.dtype(("u1", 4))),
    TileArray("tree", "tree_nodes", TREE_NODE),
)
"""In the order of the file. The space for links is filled by Detour when it loads the tile."""


@dataclass(frozen=True, eq=False)
class NavmeshTile:
    """One tile of a navigation mesh: the arrays of the file in this machine's byte order.

    Attributes:
        index: Number of the tile in the mesh.
        header: Record of type `TILE_HEADER`.
        vertices: Corners of the polygons, Habitat's frame, metres.
        polygons: Records of type `POLYGON`.
        details: Records of type `DETAIL_MESH`, one for every polygon.
        detail_vertices: Further vertices of the detail meshes, Habitat's frame, metres.
        detail_triangles: Three corners (those of the polygon come first) and flags of the edges.
        tree: Records of type `TREE_NODE`.
    """

    index: int
    header: np.void
    vertices: Float32[np.ndarray, "v 3"]
    polygons: np.ndarray
    details: np.ndarray
    detail_vertices: Float32[np.ndarray, "d 3"]
    detail_triangles: UInt8[np.ndarray, "t 4"]
    tree: np.ndarray


@dataclass(frozen=True, eq=False)
class NavmeshFile:
    """A navigation mesh file.

    Attributes:
        version: Version of the format, 1 or 2.
        header: Record of type `SET_HEADER`.
        settings: What the mesh was computed with, record of type `SETTINGS`; None in
            version 1, which doesn't say.
        tiles: At least one tile, in the order in which they are loaded.
    """

    version: int
    header: np.void
    settings: np.void | None
    tiles: tuple[NavmeshTile, ...]


def settings_for(body: BodyConfig, cell_m: float = 0.05) -> np.ndarray:
    """The settings with which habitat-sim computes a mesh for a robot.

    habitat-lab sets radius and height of its agent, a climb of 0.2 m and a slope of 45 degrees; the
    rest is ``NavMeshSettings::setDefaults``.

    Args:
        body: The robot; only radius and height are used, so the mesh climbs stairs even if the
            robot doesn't. `robot_navmesh` keeps such a robot off it where storeys are known.
        cell_m: Side of the voxels, metres.

    Returns:
        A record of type `SETTINGS`.
    """
    settings = np.zeros((), SETTINGS)
    settings["cell_size"], settings["cell_height"] = cell_m, 0.2
    settings["agent_height"], settings["agent_radius"] = body.height_m, body.radius_m
    settings["agent_max_climb"], settings["agent_max_slope"] = 0.2, 45.0
    settings["region_min_size"] = settings["region_merge_size"] = 20.0
    settings["edge_max_len"], settings["edge_max_error"] = 12.0, 1.3
    settings["verts_per_poly"] = VERTICES_PER_POLYGON
    settings["detail_sample_dist"], settings["detail_sample_max_error"] = 6.0, 1.0
    for name in ("low_hanging_obstacles", "ledge_spans", "walkable_low_height_spans"):
        settings[f"filter_{name}"] = 1
    return settings


def robot_in_voxels(settings: np.ndarray | np.void) -> tuple[int, int, int]:
    """Height, climb and radius of the robot, rounded to voxels as by Recast."""
    height = math.ceil(settings["agent_height"] / settings["cell_height"])
    climb = math.floor(settings["agent_max_climb"] / settings["cell_height"])
    return height, climb, math.ceil(settings["agent_radius"] / settings["cell_size"])


def is_mesh_of(settings: np.ndarray | np.void | None, body: BodyConfig) -> bool:
    """Whether a mesh with these settings is the one that habitat-sim would compute for a robot.

    habitat-sim compares the exact numbers; here heights or radii that Recast rounds to the same
    voxels are equal, so that a robot of 1.0 m is accepted for Habitat's of 0.88 m.

    Args:
        settings: Settings of the file; None in version 1 of the format, which has none.
        body: The robot.
    """
    known = settings_for(_DEFAULT_ROBOT) if settings is None else settings
    wanted = settings_for(body)
    names = [name for name in SETTINGS.names or () if name not in ("agent_height", "agent_radius")]
    same = all(np.isclose(known[name], wanted[name], rtol=0.0, atol=1e-5) for name in names)
    return same and robot_in_voxels(known) == robot_in_voxels(wanted)
