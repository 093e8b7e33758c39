"""What a measured form says for and against a name."""

import math
from dataclasses import dataclass

from hypernav.perception.shape.form import Form
from hypernav.perception.shape.kinds import KindShape

_AGAINST, _PER_FACTOR = 1.0, 4.0
_MOST_AGAINST = 4.0
"""Log-odds of one contradiction: the base, the growth with the logarithm of how far it is beyond
its range, and the most. All are ours."""
_FITS = 0.5
_MARGIN_M = 0.06
"""Errors of depth and of masks."""
_OFF_FLOOR_M = 0.35
_LEAST_SEEN = 0.3
"""Share of the least length that one side of a thing shows: it may be seen from its short side."""
_LOW_CEILING_M = 1.6
_GOES_ON = 0.6
_FLOOR_M = 0.1


@dataclass(frozen=True)
class ShapeEvidence:
    """How a form shifts the belief in a name.

    Attributes:
        log_odds: Shift; below 0 speaks against the name.
        reasons: Why, in words, the contradictions only.
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
