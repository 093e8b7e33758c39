"""Settings for computing a navigation mesh: habitat-sim's ``NavMeshSettings``."""

import math

import numpy as np

from hypernav.core.embodiment import BodyConfig
from hypernav.worlds.navmesh.files.file_format import SETTINGS, VERTICES_PER_POLYGON

_DEFAULT_ROBOT = BodyConfig(radius_m=0.1, height_m=1.5)
"""Robot of a file without settings, as habitat-sim assumes."""


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
