"""Size and form of what a mask shows, and what they say for and against a name.

One image shows one side: an armchair may be a sofa seen from its end. From two sides, or of a
screen's face, the width is known; and a level surface that hardly any image shows is not there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64

from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.depth import is_measured
from hypernav.core.naming.kind_shapes import KindShape
from hypernav.core.observation import Observation
from hypernav.search.memory.candidate import Measure

_LEAST_POINTS = 40
_TRIM = (3.0, 97.0)
"""Percentiles that stand for the ends: masks bleed over edges."""
_BESIDE_PX = 3
_AROUND_PX = 40
"""Largest distance from a thing, pixels, up to which its surroundings are examined."""
_EDGE_SHARE = 0.03
"""A box that ends so near the image's edge, as a share of the image, is cut off there."""
_NEARER_M = 0.12  # difference in depth from which something beside a thing may hide it
_HIDDEN_SHARE = 0.3  # share of an end's outline with something nearer, from which it is hidden
_SHORT_OF_BOX = 0.1
"""Share of the box that a mask may fall short of it."""
MANY_PIXELS = 4000
"""Number of pixels of a thing, about, beyond which more of them tell no more."""
_PLANE_M = 0.03  # distance within which a point lies in a plane
_ON_PLANE = 0.8  # share of its points in a plane from which a thing is flat
_LEVEL = 0.85
_UPRIGHT = 0.2
"""Cosines of the angle between normal and vertical: least of a level, most of an upright face."""

_AGAINST, _PER_FACTOR = 1.0, 4.0
_MOST_AGAINST = 4.0
"""Log-odds of one contradiction: the base, the growth with the logarithm of how far it is beyond
its range, and the most. All are ours."""
_FITS = 0.5  # log-odds for each of height and extent that is seen whole and fits
_MARGIN_M = 0.06
"""Error of lengths that depth and masks may cause, metres."""
_OFF_FLOOR_M = 0.35  # height of the lower end above which a thing doesn't stand on the floor
_LEAST_SEEN = 0.3
"""Share of a kind's least length that must show: a thing may be seen from its short side."""
_LOW_CEILING_M = 1.6  # height of the top below which a thing doesn't hang from the ceiling
_GOES_ON = 0.6  # `Form.goes_on` from which a flat thing is a part of a larger plane
_FLOOR_M = 0.1  # height of the top below which such a plane is the floor
_SIDES_DEG = 50.0
"""Least angle between two views of which one shows most of a thing's longer side."""
_MEASURED_SHARE = 0.9
"""Share of a thing's width that is measured at least, since masks lack edges."""
_NARROW, _NARROW_PER_FACTOR, _MOST_NARROW = 2.0, 8.0, 6.0
"""Log-odds against a thing that is too narrow: the base, the growth with the logarithm of the
missing factor, and the most. All are ours."""
_NO_TOP, _NO_TOP_YET = 2.5, 1.5
"""Log-odds against a thing without a level surface in view: where one would show, and where another
side may yet show it, as of a sofa seen from behind."""
_LEAST_LEVEL, _MOST_IMAGES = 0.06, 0.8
"""Least share of a thing's pixels that its level surface takes, and the quantile over all images at
which the share is read."""
_NEAR_M = 3.5
"""Distance up to which a level surface takes enough pixels, metres."""
_BELOW_EYE_M = 0.25
"""Height above a thing, metres, from which the camera sees its level surface from any side."""
_LEAST_M = 0.05


@dataclass(frozen=True)
class Form:
    """Size and form of what an image shows of a thing; heights are above the floor, metres.

    Attributes:
        bottom_m: Height of its lowest part in view.
        top_m: Height of its highest part in view.
        long_m: Horizontal extent in view, metres: along a flat upright face, else across the line
            of sight.
        is_bottom_seen: Whether its lower end is in view, not cut off by the image or hidden.
        is_top_seen: The same for the top.
        is_long_seen: The same for its left and right sides.
        level_share: Share of its surface in view that is level.
        goes_on: Share of the surroundings in the image that lie in the plane of a flat thing; 0 if
            it is not flat.
        is_plane_upright: Whether it is a flat upright face, as of a screen or a door.
    """

    bottom_m: float
    top_m: float
    long_m: float
    is_bottom_seen: bool
    is_top_seen: bool
    is_long_seen: bool
    level_share: float
    goes_on: float
    is_plane_upright: bool


def measured_form(
    observation: Observation, mask: Bool[np.ndarray, "height width"], box: Box
) -> Form | None:
    """The form of what a mask shows; None where too few of its pixels have depth.

    Masks cut by depth often lack legs and edges, and hold some of what is behind. So an end counts
    as seen only where the mask reaches the detector's box, and the extent of a thing that is not
    flat is measured across the line of sight.

    Args:
        observation: A frame whose map has its floor at height 0.
        mask: Pixels of the thing.
        box: Box of the detection, pixels.
    """
    part = _Part.around(mask, observation)
    rows, columns = np.nonzero(part.mask & is_measured(part.depth))
    if len(rows) < _LEAST_POINTS:
        return None
    step = -(-len(rows) // MANY_PIXELS)
    points = part.points(rows[::step], columns[::step])
    normal = _normal_of_flat(points)
    is_upright = normal is not None and abs(float(normal[2])) < _UPRIGHT
    across = observation.camera_to_map.rotation[:, 0]
    if normal is not None and is_upright:
        across = np.array([-normal[1], normal[0], 0.0]) / np.hypot(normal[0], normal[1])
    bottom, top = np.percentile(points[:, 2], _TRIM)
    left, right = np.percentile(points @ across, _TRIM)
    is_bottom_seen, is_top_seen, is_long_seen = _ends_seen(part, box)
    goes_on = 0.0 if normal is None else _plane_beyond(part, points, normal)
    return Form(
        float(bottom),
        float(top),
        float(right - left),
        is_bottom_seen,
        is_top_seen,
        is_long_seen,
        _level_share(part),
        goes_on,
        is_upright,
    )


@dataclass(frozen=True, eq=False)
class _Part:
    """The part of a frame around a mask: images are large, and most things in them small.

    Attributes:
        observation: The whole frame.
        mask: Pixels of the thing, in the part.
        depth: Depth, in the part, metres.
        row: First row of the part in the whole frame.
        column: First column of the part in the whole frame.
    """

    observation: Observation
    mask: Bool[np.ndarray, "rows columns"]
    depth: Float32[np.ndarray, "rows columns"]
    row: int
    column: int

    @staticmethod
    def around(mask: Bool[np.ndarray, "height width"], observation: Observation) -> "_Part":
        """The part with the whole mask and a margin around it."""
        left, top, width, height = cv2.boundingRect(mask.view(np.uint8))
        row, column = max(top - _AROUND_PX, 0), max(left - _AROUND_PX, 0)
        rows = slice(row, top + height + _AROUND_PX)
        columns = slice(column, left + width + _AROUND_PX)
        depth = observation.depth[rows, columns]
        return _Part(observation, mask[rows, columns], depth, row, column)

    @property
    def margins(self) -> tuple[int, int, int, int]:
        """Pixels of the frame beyond the part's upper, right, lower and left edge."""
        (height, width), (rows, columns) = self.observation.depth.shape, self.mask.shape
        return (self.row, width - self.column - columns, height - self.row - rows, self.column)

    def points(self, rows: np.ndarray, columns: np.ndarray) -> Float64[np.ndarray, "n 3"]:
        """Points of pixels of the part, given by row and column, ``map`` frame, metres."""
        depth, camera = self.depth[rows, columns], self.observation.camera
        return self.observation.camera_to_map.apply(
            camera.unproject_pixels(rows + self.row, columns + self.column, depth)
        )


def _ends_seen(part: _Part, box: Box) -> tuple[bool, bool, bool]:
    """Whether the thing ends in view at its bottom, at its top, and at both of its sides."""
    top, right, bottom, left = [_ends(part, turns) for turns in range(4)]
    rows, columns = np.nonzero(part.mask)
    rows, columns = rows + part.row, columns + part.column
    high, wide = box.y_max - box.y_min, box.x_max - box.x_min
    top &= bool(rows.min() - box.y_min < _SHORT_OF_BOX * high)
    bottom &= bool(box.y_max - 1 - rows.max() < _SHORT_OF_BOX * high)
    left &= bool(columns.min() - box.x_min < _SHORT_OF_BOX * wide)
    right &= bool(box.x_max - 1 - columns.max() < _SHORT_OF_BOX * wide)
    return bottom, top, left and right


def _ends(part: _Part, turns: int) -> bool:
    """Whether a mask ends towards one edge of the image: the upper one after quarter turns."""
    depth, mask = np.rot90(part.depth, turns), np.rot90(part.mask, turns)
    beyond = part.margins[turns]
    first = mask.argmax(axis=0)
    columns = np.flatnonzero(mask.any(axis=0))
    extent = int(first[columns].min())
    if beyond + extent < _EDGE_SHARE * part.observation.depth.shape[turns % 2]:
        return False
    # Only the part of the outline that reaches as far as the thing itself does.
    span = max(int(np.flatnonzero(mask.any(axis=1))[-1]) - extent, 1)
    columns = columns[first[columns] <= extent + 0.3 * span]
    inner, outer = first[columns] + 1, np.maximum(first[columns] - _BESIDE_PX, 0)
    own, other = depth[np.minimum(inner, len(depth) - 1), columns], depth[outer, columns]
    nearer = is_measured(own) & is_measured(other) & (other < own - _NEARER_M)
    return float(nearer.mean()) < _HIDDEN_SHARE


def _level_share(part: _Part) -> float:
    """Share of a thing's pixels whose surface is level, seen from above or below."""
    rows, columns = np.nonzero(part.mask)
    step = max(int((len(rows) / MANY_PIXELS) ** 0.5), 1) * 2
    window = np.ix_(
        np.arange(rows.min(), rows.max() + 1, step),
        np.arange(columns.min(), columns.max() + 1, step),
    )
    grid_rows, grid_columns = np.broadcast_arrays(*window)
    depth = part.depth[window]
    if min(depth.shape) < 3:
        return 0.0
    points = part.points(grid_rows.ravel(), grid_columns.ravel()).reshape(*depth.shape, 3)
    down, right = np.diff(points, axis=0)[:, :-1], np.diff(points, axis=1)[:-1]
    normals = np.cross(right, down)
    valid = part.mask[window] & is_measured(depth)
    valid = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:]
    if not valid.any():
        return 0.0
    normals = normals[valid]
    return float((np.abs(normals[:, 2]) > _LEVEL * np.linalg.norm(normals, axis=1)).mean())


def _normal_of_flat(points: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "3"] | None:
    """The normal of the plane that most points lie in; None if they lie in none."""
    normal = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][2]
    away = np.abs((points - np.median(points, axis=0)) @ normal)
    return normal if (away < _PLANE_M).mean() >= _ON_PLANE else None


def _plane_beyond(
    part: _Part, points: Float64[np.ndarray, "n 3"], normal: Float64[np.ndarray, "3"]
) -> float:
    """How much of what surrounds a flat thing lies in its plane."""
    rows, columns = np.nonzero(part.mask)
    across = min(int(np.ptp(rows)), int(np.ptp(columns))) // 3 + 1
    width = 2 * min(max(across, 8), _AROUND_PX) + 1
    mask = part.mask.astype(np.uint8)
    wide = cv2.dilate(mask, np.ones((width, width), np.uint8)).astype(bool)
    slim = cv2.dilate(mask, np.ones((7, 7), np.uint8)).astype(bool)
    around = np.nonzero(wide & ~slim & is_measured(part.depth))
    if len(around[0]) < _LEAST_POINTS:
        return 0.0
    away = np.abs((part.points(*around) - np.median(points, axis=0)) @ normal)
    return float((away < _PLANE_M).mean())


@dataclass(frozen=True)
class ShapeEvidence:
    """How a form shifts the belief in a name.

    Attributes:
        log_odds: Shift; below 0 speaks against the name.
        reasons: The contradictions, in words; empty if the form fits.
    """

    log_odds: float
    reasons: tuple[str, ...]


def shape_evidence(form: Form, kind: KindShape) -> ShapeEvidence:
    """Compare what is seen with what is known of a kind.

    What the image's edge or something nearer hides only bounds the form: a thing that is cut off
    may be larger than it looks, never smaller.

    Args:
        form: What is measured of a thing.
        kind: What things of a name are like.
    """
    against: list[tuple[float, str]] = []

    def refute(what: str, value: float, limit: float) -> None:
        factor = max(value, limit) / max(min(value, limit), _MARGIN_M)
        shift = min(_AGAINST + _PER_FACTOR * math.log(factor), _MOST_AGAINST)
        against.append((shift, f"{what} is {value:.2f} m, expected {_side(value, limit)}"))

    stands = kind.support in ("floor", "flat")
    height = form.top_m if stands else form.top_m - form.bottom_m
    is_height_seen = form.is_top_seen and (stands or form.is_bottom_seen)
    if height > kind.height_m[1] + _MARGIN_M:
        refute("its height", height, kind.height_m[1])
    elif is_height_seen and height < kind.height_m[0] - _MARGIN_M:
        refute("its height", height, kind.height_m[0])
    if form.long_m > kind.long_m[1] + _MARGIN_M:
        refute("its extent", form.long_m, kind.long_m[1])
    elif form.is_long_seen and form.long_m < _LEAST_SEEN * kind.long_m[0]:
        refute("its extent", form.long_m, _LEAST_SEEN * kind.long_m[0])
    if stands and form.is_bottom_seen and form.bottom_m > _OFF_FLOOR_M:
        against.append((_AGAINST, f"it ends {form.bottom_m:.2f} m above the floor"))
    if kind.support == "ceiling" and form.is_top_seen and form.top_m < _LOW_CEILING_M:
        against.append((_MOST_AGAINST / 2, f"it hangs no higher than {form.top_m:.2f} m"))
    if reason := _larger_plane(form, kind):
        against.append((_MOST_AGAINST / 2, reason))
    if against:
        return ShapeEvidence(-sum(one for one, _ in against), tuple(why for _, why in against))
    return ShapeEvidence(_FITS * (is_height_seen + form.is_long_seen), ())


def _side(value: float, limit: float) -> str:
    return f"at most {limit:.2f} m" if value > limit else f"at least {limit:.2f} m"


def _larger_plane(form: Form, kind: KindShape) -> str:
    """Why a flat thing is a part of something larger; empty if it is not.

    What hangs on walls, is upright as doors are, or lies flat may well be in a larger plane.
    """
    if form.goes_on < _GOES_ON:
        return ""
    if form.is_plane_upright:
        is_usual = kind.support == "wall" or kind.face == "upright"
        return "" if is_usual else "it is a part of a wall's plane"
    if kind.support == "flat":
        return ""
    return "it is a part of the floor" if form.top_m < _FLOOR_M else ""


@dataclass(frozen=True)
class FormEvidence:
    """How the form that all images together show shifts the belief in a name.

    Attributes:
        log_odds: Shift, at most 0: many things have a form that fits.
        is_doubtful: Whether the form would speak against the name if another side were the same.
    """

    log_odds: float
    is_doubtful: bool


def measure_of(form: Form, centre: tuple[float, float], observation: Observation) -> Measure:
    """What an image contributes to the knowledge of a candidate's form.

    Args:
        form: Form of the thing in this image.
        centre: Middle of the thing ``(x, y)``, ``map`` frame, metres.
        observation: The image.
    """
    robot, eye_m = observation.robot, float(observation.camera_to_map.translation[2])
    is_near = robot.distance_to(*centre) <= _NEAR_M
    return Measure(
        towards=math.atan2(robot.y - centre[1], robot.x - centre[0]),
        width_m=form.long_m if form.is_long_seen else None,
        is_face=form.is_plane_upright,
        level_share=form.level_share if is_near else None,
        is_below_eye=form.top_m < eye_m - _BELOW_EYE_M,
    )


def form_evidence(measures: Sequence[Measure], kind: KindShape) -> FormEvidence:
    """Compare what several images show with what is known of a kind.

    For a kind that is an upright face, such as a screen, one view of the face gives the width: a
    mask that is flat hardly holds what is beside. A flat side of another kind may be its end.
    """
    whole = [one for one in measures if one.width_m is not None]
    near = [one for one in measures if one.level_share is not None]
    faces = [one for one in whole if one.is_face and kind.face == "upright"]
    narrow = _narrowness(faces or whole, kind)
    is_width_known = bool(faces) or _are_around(whole)
    is_flat = kind.face == "level" and _lacks_a_top(near)
    is_top_known = _are_around(near) or any(one.is_below_eye for one in near)
    against = narrow if is_width_known else 0.0
    if is_flat:
        against += _NO_TOP if is_top_known else _NO_TOP_YET
    is_doubtful = (narrow > 0.0 and not is_width_known) or (is_flat and not is_top_known)
    return FormEvidence(-against, is_doubtful)


def _narrowness(whole: Sequence[Measure], kind: KindShape) -> float:
    """Log-odds against a thing by its greatest width in images that show it whole; at least 0."""
    widest_m = max((one.width_m or 0.0 for one in whole), default=math.inf)
    least_m = _MEASURED_SHARE * kind.long_m[0]
    if widest_m >= least_m:
        return 0.0
    factor = least_m / max(widest_m, _LEAST_M)
    return min(_NARROW + _NARROW_PER_FACTOR * math.log(factor), _MOST_NARROW)


def _lacks_a_top(near: Sequence[Measure]) -> bool:
    """Whether hardly any image shows a level surface; False without images."""
    shares = [one.level_share or 0.0 for one in near]
    return bool(shares) and float(np.quantile(shares, _MOST_IMAGES)) < _LEAST_LEVEL


def _are_around(measures: Sequence[Measure]) -> bool:
    """Whether two of the images, one of them the first, are from sides far enough apart."""
    turns = [abs(math.remainder(one.towards - measures[0].towards, math.tau)) for one in measures]
    return max(turns, default=0.0) >= math.radians(_SIDES_DEG)
