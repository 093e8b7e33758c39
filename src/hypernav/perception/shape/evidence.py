"""What measured forms say for and against a name: one image, and all images together.

One image shows one side: an armchair may be a sofa seen from its end. From two sides, or of a
screen's face, the width is known; and a level surface that hardly any image shows is not there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hypernav.core.kind_shapes import KindShape
from hypernav.core.observation import Observation
from hypernav.mapping.memory.candidate import Measure
from hypernav.perception.shape.form import Form

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
