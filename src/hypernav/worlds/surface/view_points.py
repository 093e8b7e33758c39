"""View points: positions of a robot that has reached an object.

As Habitat's ObjectNav defines them: standable points within 1.0 m (horizontal) of the object's
axis-aligned box from which the object is really visible. Habitat counts object pixels in images
taken from the point with the camera turned to the object; here rays go from the camera's height
to points on the object's surface, and one must hit the object first. As in Habitat, the camera's
direction and vertical field of view don't matter.
"""

import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.world import Instance
from hypernav.worlds.drawing.rays import RayCaster
from hypernav.worlds.scenes.scene import Scene
from hypernav.worlds.surface.walkable_surface import WalkableSurface

REACH_M = 1.0
EYE_HEIGHT_M = 0.88

_SURFACE_POINTS = 128
_ROUNDS = (4, 12, 32, 80)
"""Number of surface points tried at a time; most view points see one of the first."""


def view_points(
    scene: Scene,
    walkable: WalkableSurface,
    instance: Instance,
    rays: RayCaster,
    *,
    reach_m: float = REACH_M,
    eye_height_m: float = EYE_HEIGHT_M,
) -> Float64[np.ndarray, "n 3"]:
    """Positions from which an object counts as reached.

    Every cell of the largest connected part of the walkable surface is tried, so the points are one
    cell (5 cm) apart.

    Args:
        scene: Scene that holds the object.
        walkable: Walkable surface of the scene.
        instance: Object to reach.
        rays: Ray caster of the scene.
        reach_m: Greatest horizontal distance to the object's box.
        eye_height_m: Height of the camera above the floor.

    Returns:
        Points on the floor, metres, scene frame; empty if the object is not visible from anywhere.
    """
    floor = walkable.floor_near(instance.box_min, instance.box_max, reach_m)
    eyes = floor + np.array([0.0, 0.0, eye_height_m])
    return floor[_sees(scene, instance, eyes, rays)]


def _sees(
    scene: Scene, instance: Instance, eyes: Float64[np.ndarray, "n 3"], rays: RayCaster
) -> Bool[np.ndarray, "n"]:
    """Whether an object is visible from each eye."""
    surface = surface_points(scene, instance, _SURFACE_POINTS)
    seen = np.zeros(len(eyes), dtype=bool)
    first = 0
    for count in _ROUNDS:
        targets = surface[first : first + count]
        first += count
        waiting = np.flatnonzero(~seen)
        if len(waiting) == 0 or len(targets) == 0:
            break
        origins = np.repeat(eyes[waiting].astype(np.float32), len(targets), axis=0)
        directions = np.tile(targets, (len(waiting), 1)) - origins
        met = rays.instances(origins, directions) == instance.id
        seen[waiting] = met.reshape(len(waiting), len(targets)).any(axis=1)
    return seen


def surface_points(scene: Scene, instance: Instance, count: int) -> Float32[np.ndarray, "n 3"]:
    """Points spread evenly over an object's surface, the same on every call.

    The first few are spread as evenly as all of them. Empty if the object has no triangles.
    """
    corners = scene.vertices[scene.faces[scene.face_instance == instance.id]].astype(np.float64)
    if len(corners) == 0:
        return np.zeros((0, 3), dtype=np.float32)
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0
    # Objects may have only triangles without area, for example lines.
    shares = np.cumsum(areas if areas.sum() > 0.0 else np.ones(len(areas)))
    # Multiples of the three-dimensional golden ratio, modulo 1, are spread evenly for any number.
    golden = 1.2207440846057596
    along, u, v = (0.5 + np.arange(1, count + 1)[:, None] / golden ** np.arange(1, 4)).T % 1.0
    chosen = np.minimum(np.searchsorted(shares, along * shares[-1]), len(corners) - 1)
    folded = u + v > 1.0
    u, v = np.where(folded, 1.0 - u, u), np.where(folded, 1.0 - v, v)
    points = corners[chosen, 0] + u[:, None] * sides[chosen, 0] + v[:, None] * sides[chosen, 1]
    return points.astype(np.float32)
