"""Can everything in a room be seen from where a robot can stand beside it?

What is hidden behind furniture, or hangs so far above a bed that nobody gets near, is no goal that
could be reached, so it is taken away again. The test is strict: boxes around things block the
view, and a fair share of an object's own points must be in sight.
"""

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.houses.assembly import Placed
from hypernav.houses.furnish.site import Site
from hypernav.houses.furnish.spots import Solid
from hypernav.houses.kit.mesh import rotation_matrix
from hypernav.houses.plan.shapes import Rect

_EYE_M = 0.88
_REACH_M = 0.92
_POINTS = 20
_PLACES = 12
_LEAST_SHARE = 0.2
_LEAST_PLACES = 2
_ON_TOP_M = 0.02


def remove_unseen(site: Site) -> None:
    """Take away small things and pictures that no robot could find."""
    spots = site.standing_points()
    for piece in [p for p in site.placed if site.is_loose(p)]:
        if site.takes_space(piece) and not _is_seen(piece, site, spots):
            site.remove(piece)


def _is_seen(piece: Placed, site: Site, spots: Float64[np.ndarray, "n 2"]) -> bool:
    own = site.solid_of(piece)
    x = np.maximum(np.maximum(own.rect.x0 - spots[:, 0], spots[:, 0] - own.rect.x1), 0.0)
    y = np.maximum(np.maximum(own.rect.y0 - spots[:, 1], spots[:, 1] - own.rect.y1), 0.0)
    near = spots[x * x + y * y <= _REACH_M**2]
    if len(near) == 0:
        return False
    near = near[:: max(len(near) // _PLACES, 1)]
    targets = _surface_points(piece)
    eyes = np.column_stack([near, np.full(len(near), _EYE_M)])
    clear = _in_sight(
        np.repeat(eyes, len(targets), axis=0),
        np.tile(targets, (len(eyes), 1)),
        _in_the_way(own, site),
    )
    seeing = clear.reshape(len(eyes), -1).mean(axis=1) >= _LEAST_SHARE
    return int(seeing.sum()) >= min(_LEAST_PLACES, len(eyes))


def _in_the_way(own: Solid, site: Site) -> list[Solid]:
    """All that may hide something.

    Of what it lies in, as a cushion on a sofa, single parts; and of curtains, which are drawn back.
    """
    whole = {id(s) for s in site.solids if s is not own and not _holds(s, own)}
    others: list[Solid] = []
    for piece in site.placed:
        if not site.takes_space(piece) or site.solid_of(piece) is own:
            continue
        solid = site.solid_of(piece)
        if _holds(solid, own) or piece.model.category.endswith("curtain"):
            others += [s for s in _parts_of(piece) if not _holds(s, own)]
            whole.discard(id(solid))
    return others + [s for s in site.solids if id(s) in whole]


def _holds(outer: Solid, inner: Solid) -> bool:
    """Whether something lies in another, not on it."""
    return outer.rect.holds(inner.rect) and outer.low < inner.low < outer.high - _ON_TOP_M


def _parts_of(piece: Placed) -> list[Solid]:
    """Boxes around the parts of something."""
    solids = []
    for part in piece.model.parts:
        points = _in_scene(part.mesh.positions, piece)
        (x0, y0, z0), (x1, y1, z1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        solids.append(Solid(Rect(x0, y0, x1, y1), z0, z1))
    return solids


def _surface_points(piece: Placed) -> Float64[np.ndarray, "n 3"]:
    """Some of an object's vertices in the scene."""
    points = np.concatenate([part.mesh.positions for part in piece.model.parts])
    return _in_scene(points[:: max(len(points) // _POINTS, 1)], piece)


def _in_scene(points: Float64[np.ndarray, "n 3"], piece: Placed) -> Float64[np.ndarray, "n 3"]:
    """Points of a model, where it stands."""
    r = rotation_matrix(piece.yaw_deg)
    x = points[:, 0] * r[0, 0] + points[:, 1] * r[0, 1]
    y = points[:, 0] * r[1, 0] + points[:, 1] * r[1, 1]
    return np.column_stack([x + piece.x, y + piece.y, points[:, 2] + piece.z])


def _in_sight(
    starts: Float64[np.ndarray, "n 3"], ends: Float64[np.ndarray, "n 3"], solids: list[Solid]
) -> Bool[np.ndarray, "n"]:
    """Which straight lines meet no box."""
    if not solids:
        return np.ones(len(starts), dtype=bool)
    low = np.array([(s.rect.x0, s.rect.y0, s.low) for s in solids])
    high = np.array([(s.rect.x1, s.rect.y1, s.high) for s in solids])
    way = ends - starts
    way = np.where(np.abs(way) < 1e-9, 1e-9, way)[:, None]
    a, b = (low - starts[:, None]) / way, (high - starts[:, None]) / way
    enter = np.minimum(a, b).max(axis=2)
    leave = np.maximum(a, b).min(axis=2)
    hit = (enter < leave) & (leave > 0.0) & (enter < 0.999)
    return ~hit.any(axis=1)
