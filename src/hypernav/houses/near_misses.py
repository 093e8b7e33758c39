"""Near misses of a goal: objects that nearly satisfy it and are easily confused with it."""

import re
from collections.abc import Iterator, Sequence

from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, canonical, normalise
from hypernav.core.world import Instance

_PREPOSITION = re.compile(r" (?:in|inside|of|beside|next to|near|by|close to|on|under|at) ")

_ALIKE: tuple[frozenset[str], ...] = tuple(
    frozenset(canonical(name) for name in group)
    for group in (
        ("sofa", "armchair", "bean bag", "ottoman", "bench"),
        ("chair", "armchair", "rocking chair", "stool", "bench"),
        ("bed", "crib", "sofa", "pet basket"),
        ("washing machine", "clothes dryer", "dishwasher", "oven"),
        ("oven", "microwave", "fireplace"),
        ("refrigerator", "wardrobe", "cabinet"),
        ("wardrobe", "bookshelf", "cabinet", "dresser", "storage rack", "filing cabinet"),
        ("nightstand", "dresser", "cabinet", "side table"),
        ("tv", "computer monitor", "laptop", "picture", "mirror"),
        ("toilet", "sink", "bathtub", "shower"),
        ("potted plant", "vase", "succulent", "cactus", "herb"),
        ("backpack", "handbag", "suitcase"),
        ("trash can", "basket", "laundry basket", "bucket"),
        ("bicycle", "exercise equipment"),
        ("picture", "mirror", "window", "clock"),
        ("rug", "bath mat", "doormat", "yoga mat"),
    )
)
"""Groups of categories that look alike or serve the same purpose."""


def near_misses(instances: Sequence[Instance], goal: Goal) -> tuple[Instance, ...]:
    """Instances that do not satisfy a goal but come close.

    An instance comes close if it has the goal's name but not its appearance or position ("the red
    armchair" and a blue one), if the last words of the names are the same (window curtain and
    shower curtain), or if its category looks similar or serves the same purpose (washing machine
    and clothes dryer).

    Args:
        instances: All instances of the scene, with labels.
        goal: The goal of the search.
    """
    labelled = [(i, i.label) for i in instances if i.label is not None]
    wanted = [label for _, label in labelled if label.satisfies(goal)]
    names = list(_names_in(goal)) + [label.category for label in wanted]
    return tuple(
        instance
        for instance, label in labelled
        if not label.satisfies(goal) and any(_comes_close(label, name) for name in names)
    )


def _names_in(goal: Goal) -> Iterator[str]:
    """Names of the goal with fewer attributes each: "red dining chair", "dining chair", "chair"."""
    words = _PREPOSITION.split(normalise(goal.text), maxsplit=1)[0].split()
    for first in range(len(words)):
        yield " ".join(words[first:])


def _comes_close(label: ObjectLabel, name: str) -> bool:
    wanted = canonical(name)
    if label.is_named(name):
        return True
    own = canonical(label.category)
    if own.rsplit(" ", maxsplit=1)[-1] == wanted.rsplit(" ", maxsplit=1)[-1]:
        return True
    return any(wanted in group and own in group for group in _ALIKE)
