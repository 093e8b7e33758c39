"""Doubts whether a building stands upright and is in metres, from what is known of buildings.

A model that lies on its side, or whose numbers are inches, gives searches that look right and mean
nothing. Five kinds of evidence say which way is up: floors and ceilings are level, walls are
upright, furniture stands on few levels, the largest flat surface is a floor or a ceiling, and
things have the heights and lengths of their kind. The sizes say the unit, too, and where no kind is
known, as by names of another language, the heights of storeys do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from hypernav.core.naming.kind_shapes import KindShape, kind_shape
from hypernav.simulator.worlds.config import Axis
from hypernav.simulator.worlds.scenes.mesh_parts import TO_Z_UP, MeshPart, SceneObject, axis_along
from hypernav.simulator.worlds.scenes.node_names import is_structural, words_of

_LEVEL = frozenset("floor floors flooring ground ceiling ceilings".split())  # noqa: SIM905
_UPRIGHT = frozenset({"wall", "walls"})
_ALIGNED = 0.98
"""Least cosine between a face's normal and an axis that it lies across."""
_UNITS = {
    0.001: "millimetres",
    0.01: "centimetres",
    0.0254: "inches",
    0.3048: "feet",
    100.0: "hundreds of metres",
    1000.0: "kilometres",
}
_SLACK = 1.15
"""Factor on the limits of a kind's sizes."""
_FEWEST_THINGS, _FEWEST_KINDS = 5, 4
_LARGEST_M, _SMALLEST_M = 150.0, 1.0
"""Beyond these extents of a building, few things suffice to doubt its unit."""
_LOW_STOREY_M, _HIGH_STOREY_M, _HIGHEST_M = 2.0, 5.0, 20.0
"""Heights of usual storeys, and of the highest hall that is not doubted."""
_TALLEST_PART_M = 5.0
"""Median height of the parts of a building that is not doubted."""
_LEVEL_SHARE, _LAYERS = 0.2, 40
"""Least area of a level, as a share of the building's outline or its second largest level, and the
number of layers in which levels are searched."""
_MOST_FACES = 500_000
"""Triangles that are looked at; of more, every n-th."""


@dataclass(frozen=True, eq=False)
class _Vote:
    """What one kind of evidence says.

    Attributes:
        axis: Number of the scene's axis that is up.
        sign: Sense in which it is up, 1 or -1; 0 if the evidence doesn't tell.
        words: The evidence, for people.
    """

    axis: int
    sign: int
    words: str


@dataclass(frozen=True, eq=False)
class _Things:
    """Boxes of the objects that have a label, scene frame; the shape of a kind, where known."""

    low: Float64[np.ndarray, "things 3"]
    high: Float64[np.ndarray, "things 3"]
    names: tuple[str, ...]
    kinds: tuple[KindShape | None, ...]

    @staticmethod
    def of(parts: Sequence[MeshPart], objects: Sequence[SceneObject]) -> "_Things":
        """The labelled objects of a file."""
        labelled = [(item.nodes, item.label.category) for item in objects if item.label]
        number = {node: k for k, (nodes, _) in enumerate(labelled) for node in nodes}
        low, high = np.full((len(labelled), 3), np.inf), np.full((len(labelled), 3), -np.inf)
        for part in parts:
            corners = part.vertices[part.faces].reshape(-1, 3)
            if part.node in number and len(corners) and np.isfinite(corners).all():
                k = number[part.node]
                low[k] = np.minimum(low[k], corners.min(axis=0))
                high[k] = np.maximum(high[k], corners.max(axis=0))
        there = [k for k in range(len(labelled)) if np.isfinite(low[k]).all()]
        names = tuple(labelled[k][1] for k in there)
        return _Things(low[there], high[there], names, tuple(map(kind_shape, names)))

    @property
    def kind_count(self) -> int:
        """The number of known kinds: many things of one kind, as pallets, say one thing."""
        pairs = zip(self.names, self.kinds, strict=True)
        return len({name for name, kind in pairs if kind is not None})

    def fitting(self, axis: int, scale: float = 1.0) -> int:
        """The number of known kinds most of whose things have its size, were this axis up."""
        by_kind: dict[str, list[bool]] = {}
        sizes = (self.high - self.low) * scale
        for name, kind, size in zip(self.names, self.kinds, sizes, strict=True):
            if kind is not None:
                height, length = float(size[axis]), float(np.delete(size, axis).max())
                fits = _within(height, kind.height_m) and _within(length, kind.long_m)
                by_kind.setdefault(name, []).append(fits)
        return sum(2 * sum(fits) > len(fits) for fits in by_kind.values())

    def standing(self) -> list[int]:
        """The things that stand on a floor; all, if few of their kinds are known."""
        known = [k for k, kind in enumerate(self.kinds) if kind and kind.support == "floor"]
        return known if len(known) >= _FEWEST_THINGS else list(range(len(self.kinds)))


def _within(size: float, limits: tuple[float, float]) -> bool:
    low, high = limits
    return low / _SLACK <= size <= high * _SLACK


@dataclass(frozen=True, eq=False)
class _Faces:
    """Areas of the triangles of some parts that lie across each axis."""

    across: Float64[np.ndarray, "faces 3"]
    area: Float64[np.ndarray, "faces"]
    centres: Float64[np.ndarray, "faces 3"]

    @staticmethod
    def of(parts: Sequence[MeshPart]) -> "_Faces":
        """The triangles of parts, without those that are not finite."""
        step = 1 + sum(len(part.faces) for part in parts) // _MOST_FACES
        some = (part.vertices[part.faces[::step]] for part in parts)
        corners = [np.zeros((0, 3, 3)), *some]
        triangles = np.concatenate(corners).astype(np.float64)
        triangles = triangles[np.isfinite(triangles).all(axis=(1, 2))]
        sides = triangles[:, 1:] - triangles[:, :1]
        normals = np.cross(sides[:, 0], sides[:, 1]) / 2.0
        area = np.linalg.norm(normals, axis=1)
        across = np.abs(normals) > _ALIGNED * area[:, None]
        return _Faces(across * area[:, None], area, triangles.mean(axis=1))

    def shares(self) -> Float64[np.ndarray, "3"]:
        """Shares of the area that lie across each axis."""
        return self.across.sum(axis=0) / max(float(self.area.sum()), 1e-30)

    def largest_planes(self, thickness: float) -> Float64[np.ndarray, "3"]:
        """The largest area across each axis within one layer."""
        largest = np.zeros(3)
        for axis in range(3):
            on = self.across[:, axis] > 0.0
            layers = np.floor(self.centres[on, axis] / thickness).astype(np.int64)
            if len(layers):
                layers -= layers.min()
                _, layers = np.unique(layers, return_inverse=True)
                largest[axis] = np.bincount(layers, self.area[on]).max()
        return largest


def doubts_of(
    parts: Sequence[MeshPart],
    objects: Sequence[SceneObject],
    read_up: Axis,
    *,
    up_is_given: bool = False,
    scale_is_given: bool = False,
) -> list[str]:
    """What speaks against the axis and the unit by which a file was read, with the remedy.

    Args:
        parts: Parts of the file as read, scene frame.
        objects: Its objects.
        read_up: The axis of the file that was taken for up.
        up_is_given: Whether somebody chose that axis: then it is not doubted.
        scale_is_given: The same for its unit.
    """
    things = _Things.of(parts, objects)
    low, extents = _outline(parts)
    votes = [] if up_is_given or not extents.any() else _votes(parts, objects, things, extents)
    up = _agreed(votes)
    doubts: list[str] = []
    if up is not None:
        axis, sign = up
        direction = np.zeros(3)
        direction[axis] = sign
        file_axis = axis_along(TO_Z_UP[read_up].T @ direction)
        words = ", ".join(vote.words for vote in votes if vote.axis == axis)
        doubts.append(
            f"this building seems to lie on its side: with the file's {file_axis} axis up, not its "
            f"{read_up} axis, {words}; --set world.file_up={file_axis} turns it, "
            f"--set world.file_up={read_up} takes it as it is"
        )
    axis = 2 if up is None else up[0]
    unit = None if scale_is_given else _better_unit(parts, things, axis, low, extents)
    if unit is not None:
        scale, words = unit
        doubts.append(
            f"this building seems to be in {_UNITS[scale]}, not in metres: {words}; "
            f"--set world.file_scale={scale:g} converts it, --set world.file_scale=1 takes it as "
            "it is"
        )
    return doubts


def _outline(
    parts: Sequence[MeshPart],
) -> tuple[Float64[np.ndarray, "3"], Float64[np.ndarray, "3"]]:
    """The lowest corner of a building and its extents; zeros where it has none."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for part in parts:
        corners = part.vertices[part.faces].reshape(-1, 3)
        corners = corners[np.isfinite(corners).all(axis=1)].astype(np.float64)
        low = np.minimum(low, corners.min(axis=0, initial=np.inf))
        high = np.maximum(high, corners.max(axis=0, initial=-np.inf))
    return (low, high - low) if (high >= low).all() else (np.zeros(3), np.zeros(3))


def _votes(
    parts: Sequence[MeshPart],
    objects: Sequence[SceneObject],
    things: _Things,
    extents: Float64[np.ndarray, "3"],
) -> list[_Vote]:
    """What every kind of evidence says that says anything clearly."""
    thickness = float(extents.max()) / 400.0
    everything = _Faces.of(parts)
    names = {node: item.name for item in objects if item.label is None for node in item.nodes}
    words = [_structural_word(part, names) for part in parts]
    floors = _Faces.of([part for part, word in zip(parts, words, strict=True) if word in _LEVEL])
    walls = _Faces.of([part for part, word in zip(parts, words, strict=True) if word in _UPRIGHT])
    found: list[_Vote] = []
    axis, sign, share = _feet(things)
    stands = len(things.kinds) and share > 0.0
    level = floors.shares()
    if level.max() >= 0.7:
        up = int(level.argmax())
        above = (everything.centres[:, up] @ everything.area) / everything.area.sum()
        below = (floors.centres[:, up] @ floors.area) / floors.area.sum()
        side = sign if stands and axis == up else 1 if above >= below else -1
        found.append(_Vote(up, side, f"{level[up]:.0%} of what is called floor is level"))
    upright = np.sort(walls.shares())
    if upright[0] <= 0.15 and upright[1] >= 0.15 and upright.sum() >= 0.7:
        up = int(walls.shares().argmin())
        found.append(_Vote(up, 0, "what is called wall is upright"))
    if stands:
        found.append(_Vote(axis, sign, f"{share:.0%} of the furniture stands on one level"))
    planes = everything.largest_planes(thickness)
    if planes.max() >= 1.3 * np.sort(planes)[1] and planes.max() > 0.0:
        found.append(_Vote(int(planes.argmax()), 0, "the largest flat surface is level"))
    fits = np.array([max(things.fitting(k, s) for s in (1.0, *_UNITS)) for k in range(3)])
    best, count = int(fits.argmax()), things.kind_count
    others = float(np.sort(fits)[1])
    if count >= _FEWEST_KINDS and fits[best] >= max(0.7 * count, others + 0.12 * count):
        words = f"{fits[best]} of {count} kinds of things have their usual height"
        found.append(_Vote(best, 0, words))
    return found


def _structural_word(part: MeshPart, names: dict[str, str]) -> str:
    """The last word of a name that means a level or an upright part of the building, or ""."""
    for name in (part.descriptive_name, names.get(part.node, "")):
        if is_structural(name):
            known = [word for word in words_of(name) if word in _LEVEL | _UPRIGHT]
            return known[-1] if known else ""
    return ""


def _feet(things: _Things) -> tuple[int, int, float]:
    """Axis and sense in which most furniture stands on one level, and its share; 0 if unclear."""
    standing = things.standing()
    if len(standing) < _FEWEST_THINGS:
        return 2, 1, 0.0
    low, high = things.low[standing], things.high[standing]
    tolerance = 0.04 * float(np.median((high - low).max(axis=1)))
    shares = {
        (axis, sign): max(float((np.abs(feet - foot) <= tolerance).mean()) for foot in feet)
        for axis in range(3)
        for sign, feet in ((1, low[:, axis]), (-1, -high[:, axis]))
    }
    (first, second) = sorted(shares, key=lambda side: -shares[side])[:2]
    clear = shares[first] >= 0.3 and shares[first] >= 1.5 * shares[second]
    return *first, shares[first] if clear else 0.0


def _agreed(votes: Sequence[_Vote]) -> tuple[int, int] | None:
    """The direction that is up by clear evidence; None if that is z, or the evidence differs.

    One kind of evidence is a building with something odd in it; two that agree are not.
    """
    axes = {vote.axis for vote in votes}
    if len(votes) < 2 or len(axes) > 1:
        return None
    senses = [vote.sign for vote in votes if vote.sign]
    sense = senses[0] if senses else 1
    up = (axes.pop(), sense)
    if up[0] == 2 and (sense > 0 or len(senses) < 2 or len(set(senses)) > 1):
        return None
    return up


def _better_unit(
    parts: Sequence[MeshPart],
    things: _Things,
    axis: int,
    low: Float64[np.ndarray, "3"],
    extents: Float64[np.ndarray, "3"],
) -> tuple[float, str] | None:
    """A unit that fits a building better than metres, and the evidence; None if there is none.

    Things of known kinds decide. Where few are known, a storey does that is higher than any hall,
    if most parts are high as well: a sky around a building has such a storey, too.
    """
    count, now = things.kind_count, things.fitting(axis)
    if count and now > 0.4 * count:
        return None
    is_odd = not _SMALLEST_M <= float(extents.max()) <= _LARGEST_M
    if count >= (1 if is_odd else _FEWEST_KINDS):
        fits = {scale: things.fitting(axis, scale) for scale in _UNITS}
        best = max(fits, key=lambda scale: fits[scale])
        words = f"{fits[best]} of its {count} known kinds of things have the usual size then, {now}"
        if fits[best] >= 0.7 * count:
            return best, f"{words} now"
    if extents[axis] <= _HIGHEST_M:
        return None
    if np.median([_outline([part])[1][axis] for part in parts]) <= _TALLEST_PART_M:
        return None
    storey = _storey(_Faces.of(parts), axis, low, extents)
    wide = float(np.delete(extents, axis).max())
    for scale in _UNITS:
        is_usual = _LOW_STOREY_M <= storey * scale <= _HIGH_STOREY_M
        if is_usual and _LOW_STOREY_M <= wide * scale <= _LARGEST_M:
            return scale, f"its highest storey has {storey * scale:.2g} m then, {storey:.3g} m now"
    return None


def _storey(
    faces: _Faces, axis: int, low: Float64[np.ndarray, "3"], extents: Float64[np.ndarray, "3"]
) -> float:
    """The height of the highest storey, where no level within it makes it a usual one; else 0.

    A storey lies between two levels of a building, or between one and its end. A site around a
    tower is so large that its floors seem no levels, but they leave no room for a high storey.

    Args:
        faces: All of its faces.
        axis: The axis that is up; its sense doesn't matter.
        low: Its lowest corner.
        extents: Its extents.
    """
    on = faces.across[:, axis] > 0.0
    layers = ((faces.centres[on, axis] - low[axis]) * (_LAYERS / extents[axis])).astype(np.int64)
    area = np.bincount(layers, faces.area[on], minlength=_LAYERS + 1)
    height = np.bincount(layers, faces.area[on] * (faces.centres[on, axis] - low[axis]))
    outline = float(np.prod(np.delete(extents, axis)))

    def highest(least_area: float) -> float:
        levels = np.flatnonzero((area >= least_area) & (area > 0.0))
        ends = np.array([0.0, *(height[levels] / area[levels]), extents[axis]])
        return float(np.diff(ends).max()) if len(levels) else 0.0

    if highest(_LEVEL_SHARE * float(np.sort(area)[-2])) <= _HIGHEST_M:
        return 0.0
    return highest(_LEVEL_SHARE * outline)
