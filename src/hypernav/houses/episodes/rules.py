"""Goals and distances of episodes in each kind of building."""

from dataclasses import dataclass

HABITAT_CATEGORIES = ("chair", "bed", "potted plant", "toilet", "tv", "sofa")
"""The six goals of Habitat's ObjectNav challenge on HM3D."""

CATEGORIES = (
    *HABITAT_CATEGORIES,
    *("refrigerator", "oven", "sink", "bathtub", "washing machine", "dishwasher"),
    *("dining table", "coffee table", "desk", "nightstand", "tv stand"),
    *("wardrobe", "bookshelf", "dresser", "armchair", "mirror", "floor lamp", "table lamp"),
)
"""Goals of ``houses-val`` and ``houses-train``; these are the seen names of ``houses-ovon``."""


@dataclass(frozen=True)
class EpisodeRules:
    """Goals and distances of the episodes in one kind of building.

    Attributes:
        categories: Goals that are categories. Things that are everywhere, such as desks in
            offices, are no goals: they would be found by looking around.
        frequent: The categories that come first in every building.
        least_m: Least geodesic distance from a start to its goal, metres.
        most_m: Greatest geodesic distance from a start to its goal, metres.
    """

    categories: tuple[str, ...]
    frequent: tuple[str, ...]
    least_m: float
    most_m: float


RULES = {
    "houses": EpisodeRules(CATEGORIES, HABITAT_CATEGORIES, 2.0, 30.0),
    "offices": EpisodeRules(
        (
            *("copier", "printer", "whiteboard", "reception desk", "meeting table", "tv", "sofa"),
            *("refrigerator", "coffee machine", "microwave", "toilet", "sink", "water dispenser"),
            *("vending machine", "coat rack", "locker", "server rack", "filing cabinet"),
            *("bookshelf", "armchair", "coffee table", "dining table", "mirror", "storage rack"),
            *("potted plant", "notice board", "fire extinguisher", "projector screen"),
        ),
        (),
        4.0,
        60.0,
    ),
    "shops": EpisodeRules(
        (
            *("checkout counter", "sales counter", "reception desk", "shopping cart", "copier"),
            *("display refrigerator", "chest freezer", "mannequin", "display table", "mirror"),
            *("magazine rack", "book cart", "shoe display", "ladder", "bicycle", "toolbox"),
            *("shopping basket", "armchair", "toilet", "sink", "coffee machine", "microwave"),
            *("vending machine", "water dispenser", "desk", "meeting table", "filing cabinet"),
            *("potted plant", "bench", "suitcase", "cardboard box", "coat rack", "dining table"),
        ),
        (),
        4.0,
        60.0,
    ),
    "crowded": EpisodeRules(
        ("tv", "whiteboard", "meeting table", "refrigerator", "copier", "toilet", "sofa"),
        ("tv",),
        4.0,
        60.0,
    ),
}
RULES["storeys"] = EpisodeRules(
    tuple(dict.fromkeys((*CATEGORIES, *RULES["offices"].categories))), (), 2.0, 60.0
)
"""Rules of the episodes by kind of building."""
