"""A thing that a robot remembers: where it is, and how surely it is one and still there."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel

_SAME_SHARE = 0.35
_SAME_M = (0.15, 0.6)
"""Margin around a thing in which the middle of another view of it may lie: this share of its larger
side on the floor plan, within these limits, metres. Front and back of a sofa are one thing, and
chairs around a table are not."""
_SAME_HEIGHT_M = 0.5
_LOWEST_M, _HIGHEST_M = -0.5, 2.9
"""Heights above a floor between which things are in its room, metres.

Sunken floors and lamps are, but not what is seen down a stairwell or up on a gallery.
"""
_TALL_M = 1.0
"""Height of a thing, metres, above which its lower part alone tells what floor it stands on."""
_AT_SCORE = 7.0
_AT_RECALL = 4.4
_AT_NOTHING = -9.3
"""Log-odds that a thing is what it was taken for: `_AT_NOTHING`, and the others times its highest
score and times the share of the images, of those that should show it, in which it was detected.
Fitted to YOLOX-nano in eight training houses; in eight others 33 % of 440 remembered things were
right, 11 % of those with scores below 0.4 and 88 % from 0.9 on (docs/results/memory.md). A detector
errs the same way from every side, so that many images of a low score are no better than one."""
MOST_CHANCE = 1.0 / (1.0 + math.exp(-(_AT_NOTHING + _AT_SCORE + _AT_RECALL)))
"""Greatest chance of a thing, that of a score of 1 in each image which should show it: 0.89."""
_RECALL = (0.3, 0.95)
"""Limits of how often a detector is believed to see a thing that is there."""
_REFUTED = 0.4
"""Share of the chance that is left of a thing that a search has rejected."""
MOST_VIEWS = 4
"""Number of views of a thing."""
APART_M = 1.0
"""Distance between two positions, metres, from which their images are different views."""
_GONE = 0.2
"""Chance below which a thing counts as gone."""

SAME_SIDE = math.cos(math.radians(30.0))
"""Cosine of the angle between two directions from a thing that lie on the same side of it."""

Corner = tuple[float, float, float]
View = tuple[float, float, float]
"""Position ``(x, y)`` of the robot, metres, and score."""


@dataclass(frozen=True)
class Thing:
    """A thing on a floor, as an upright box.

    Attributes:
        number: Its number on this floor.
        label: The detector's word for it.
        score: Highest score of a detection of it, 0 to 1.
        low: Lowest corner ``(x, y, z)`` of its box, ``map`` frame, heights above the floor, metres.
        high: Highest corner of its box.
        views: Positions ``(x, y)`` of the robot, metres, far enough apart to be different, each
            with the highest score there; first that of the image that shows it largest.
        pixels: Area of its box in that image, square pixels.
        first_search: Number of the search that saw it first.
        last_search: Number of the search that saw it last.
        seen: Number of images that it was detected in.
        missed: Number of images since the last detection that should have shown it.
        overlooked: Number of images before the last detection that should have shown it.
        image: Number of the key image that shows it largest; None if there is none.
        image_pixels: Area of its box in that image, square pixels.
        refuted_in: Number of the search that took it for its goal last and rejected it; 0 if none.
    """

    number: int
    label: str
    score: float
    low: Corner
    high: Corner
    views: tuple[View, ...]
    pixels: float
    first_search: int
    last_search: int
    seen: int = 1
    missed: int = 0
    overlooked: int = 0
    image: int | None = None
    image_pixels: float = 0.0
    refuted_in: int = 0

    @property
    def seen_from(self) -> tuple[float, float]:
        """Position ``(x, y)``, metres, of the robot in the image that shows it largest."""
        x, y, _ = self.views[0]
        return (x, y)

    @property
    def position(self) -> Corner:
        """The middle of its box ``(x, y, z)``, metres."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return ((x0 + x1) / 2.0, (y0 + y1) / 2.0, (z0 + z1) / 2.0)

    @property
    def size(self) -> Corner:
        """The extent of its box along x, y and z, metres."""
        (x0, y0, z0), (x1, y1, z1) = self.low, self.high
        return (x1 - x0, y1 - y0, z1 - z0)

    @property
    def outline(self) -> tuple[tuple[float, float], ...]:
        """Its middle and the corners of its box on the floor plan, ``(x, y)``, metres."""
        (x0, y0, _), (x1, y1, _), (x, y, _) = self.low, self.high, self.position
        return ((x, y), (x0, y0), (x1, y0), (x1, y1), (x0, y1))

    @property
    def chance(self) -> float:
        """Chance that it is what it was taken for and still there.

        Its highest score counts, and how often it was overlooked before the last detection. Every
        miss since then counts by Bayes' rule for a detector that sees this thing as often as it did
        before.
        """
        share = self.seen / (self.seen + self.overlooked)
        log_odds = _AT_NOTHING + _AT_SCORE * min(self.score, 1.0) + _AT_RECALL * share
        before = 1.0 / (1.0 + math.exp(-log_odds))
        before *= _REFUTED if self.refuted_in else 1.0
        if self.missed == 0:
            return before
        recall = (self.seen + 1) / (self.seen + self.overlooked + 2)
        unseen = (1.0 - min(max(recall, _RECALL[0]), _RECALL[1])) ** self.missed
        return before * unseen / (before * unseen + 1.0 - before)

    @property
    def is_gone(self) -> bool:
        """Whether it was missed so often that it probably is no longer there."""
        return self.missed > 0 and self.chance < _GONE

    def was_seen_from(self, positions: Float64[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
        """Whether it was seen from about the direction in which each position lies from it.

        What hides it from other sides, such as the wall that it hangs on, may be on no map.

        Args:
            positions: Positions ``(x, y)``, metres.
        """
        middle = np.array(self.position[:2])
        here, seen = positions - middle, np.array(self.views)[:, :2] - middle
        lengths = np.linalg.norm(here, axis=1)[:, None] * np.linalg.norm(seen, axis=1)
        return (here @ seen.T >= SAME_SIDE * lengths).any(axis=1)

    def fits(self, goal: Goal) -> float:
        """How well its label fits a goal: 1 as far as asked, 0.5 only its kind, 0 not at all."""
        return fit(self.label, goal)


def is_in_room(height_m: float, ground_m: float = 0.0) -> bool:
    """Whether what is at a height belongs to a floor.

    Args:
        height_m: The height above the ground from which it is seen, metres.
        ground_m: Height of that ground above the floor, metres: another level has the room over
            the floor as well as that over itself.
    """
    lowest_m, highest_m = _LOWEST_M - max(ground_m, 0.0), _HIGHEST_M - min(ground_m, 0.0)
    return lowest_m <= height_m <= highest_m


def stands_in_room(thing: Thing, ground_m: float) -> bool:
    """Whether a thing is of the floor from which it was seen, however high it reaches.

    Args:
        thing: The thing.
        ground_m: Height above the floor of the ground from which it was seen, metres.
    """
    middle_m, bottom_m = thing.position[2] - ground_m, thing.low[2] - ground_m
    return is_in_room(min(middle_m, max(0.0, bottom_m + _TALL_M / 2.0)), ground_m)


@lru_cache(maxsize=4096)
def fit(label: str, goal: Goal) -> float:
    """How well a label fits a goal; see `Thing.fits`."""
    if ObjectLabel(label).satisfies(goal):
        return 1.0
    return 0.5 if ObjectLabel(label).may_satisfy(goal) else 0.0


def overlap(a: Thing, b: Thing) -> bool:
    """Whether the middle of one lies in the other's box, or right beside it."""
    return holds(a, b.position) or holds(b, a.position)


def holds(one: Thing, position: Corner) -> bool:
    """Whether a position lies in a thing's box, or right beside it."""
    (x0, y0, z0), (x1, y1, z1), (x, y, z) = one.low, one.high, position
    beside_m = min(max(_SAME_SHARE * max(x1 - x0, y1 - y0), _SAME_M[0]), _SAME_M[1])
    return (
        x0 - beside_m <= x <= x1 + beside_m
        and y0 - beside_m <= y <= y1 + beside_m
        and z0 - _SAME_HEIGHT_M <= z <= z1 + _SAME_HEIGHT_M
    )


def joined(known: list[Thing], new: Thing) -> Thing:
    """What is known of a thing and one more view of it, which may show that several are one.

    What was remembered from earlier searches gives way to the first view of this one that shows the
    thing as large: it may have been moved a little.
    """
    best = max(known, key=lambda one: one.pixels)
    others = [one for one in known if one is not best]
    is_larger = new.pixels > best.pixels
    is_renewed = best.last_search < new.last_search and 2.0 * new.pixels >= best.pixels
    first = new.views[0] if is_larger or is_renewed else best.views[0]
    boxes = [new] if is_renewed else [*known, new]
    x0, y0, z0 = map(min, zip(*(one.low for one in boxes), strict=True))
    x1, y1, z1 = map(max, zip(*(one.high for one in boxes), strict=True))
    return replace(
        best,
        number=min(one.number for one in known),
        score=max(best.score, new.score),
        low=(x0, y0, z0),
        high=(x1, y1, z1),
        views=_views(first, [view for one in (best, *others, new) for view in one.views]),
        pixels=new.pixels if is_larger or is_renewed else best.pixels,
        first_search=min(one.first_search for one in known),
        last_search=new.last_search,
        seen=sum(one.seen for one in known) + 1,
        missed=0,
        overlooked=sum(one.overlooked + one.missed for one in known),
    )


def _views(first: View, others: list[View]) -> tuple[View, ...]:
    """A view and others from elsewhere, the highest score of each; at most `MOST_VIEWS`."""
    kept = [first]
    for x, y, score in others:
        for k, (other_x, other_y, best) in enumerate(kept):
            if math.hypot(x - other_x, y - other_y) < APART_M:
                kept[k] = (other_x, other_y, max(score, best))
                break
        else:
            kept.append((x, y, score))
    return tuple(kept[:MOST_VIEWS])
