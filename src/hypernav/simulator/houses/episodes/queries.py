"""Goal queries of a building: categories, other names, and descriptions that single out objects.

Every text is checked with the grammar of `hypernav.core.naming.labels`, which decides what counts
as reached: a description is only used if it is true of one object and false of another object of
the same name. Near misses of a goal are objects that nearly satisfy it and are easily confused
with it.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count, cycle, islice
from typing import Literal

from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, canonical, normalise
from hypernav.core.world import Instance
from hypernav.simulator.houses.episodes.building_truth import BuildingTruth
from hypernav.simulator.houses.random_stream import RandomStream

HABITAT_CATEGORIES = ("chair", "bed", "potted plant", "toilet", "tv", "sofa")
"""The six goals of Habitat's ObjectNav challenge on HM3D."""

CATEGORIES = (
    *HABITAT_CATEGORIES,
    *("refrigerator", "oven", "sink", "bathtub", "washing machine", "dishwasher"),
    *("dining table", "coffee table", "desk", "nightstand", "tv stand"),
    *("wardrobe", "bookshelf", "dresser", "armchair", "mirror", "floor lamp", "table lamp"),
)
"""Goals of ``houses-val`` and ``houses-train``; these are the seen names of ``houses-ovon``."""

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

Vocabulary = Literal["seen", "synonym", "unseen"]

_UBIQUITOUS = ("window", "door", "ceiling lamp", "kitchen cabinet")
_MIN_SIDE_AREA_M2 = 0.1
"""Smallest area of the largest side of an object's box: plates and cups are no goals."""


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


def near_misses(instances: Sequence[Instance], goal: Goal) -> tuple[Instance, ...]:
    """Instances that do not satisfy a goal but come close.

    An instance comes close if it has the goal's name but not its appearance or position ("the red
    armchair" and a blue one), if the last words of the names are the same (window curtain and
    shower curtain), or if its category looks similar or serves the same purpose (washing machine
    and clothes dryer).
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


@dataclass(frozen=True)
class Query:
    """Goal query of an episode.

    Attributes:
        text: Text of the goal, in a person's words.
        vocabulary: Kind of the name in it: one of the rules' categories, a synonym of one of
            these, or the name of another category.
        is_description: Whether the text says more than a name.
        instances: Instances that satisfy it.
        near_misses: Instances that don't, but come close.
    """

    text: str
    vocabulary: Vocabulary
    is_description: bool
    instances: tuple[Instance, ...]
    near_misses: tuple[Instance, ...]


def category_queries(
    rng: RandomStream, truth: BuildingTruth, rules: EpisodeRules
) -> Iterator[Query]:
    """Endless queries for the building's categories in random order; the frequent come first."""
    held = [c for c in rules.categories if truth.satisfying(c)]
    first = rng.shuffled([c for c in held if c in rules.frequent])
    order = first + rng.shuffled([c for c in held if c not in rules.frequent])
    queries = [_name_query(truth, c, "seen") for c in order]
    while queries:
        yield from queries


def phrase_queries(rng: RandomStream, truth: BuildingTruth, rules: EpisodeRules) -> Iterator[Query]:
    """Queries by seen, synonymous and unseen names in turn, every other one a description.

    Endless unless the house is empty.
    """
    names: dict[Vocabulary, list[str]] = {
        vocabulary: rng.fork(vocabulary).shuffled(found)
        for vocabulary, found in _names(truth, rules).items()
        if found
    }
    turns = rng.shuffled(list(names))
    plain = {vocabulary: cycle(found) for vocabulary, found in names.items()}
    ambiguous = {vocabulary: cycle(found) for vocabulary, found in names.items()}
    for number in count() if turns else ():
        vocabulary = turns[number % len(turns)]
        if number // len(turns) % 2 == 0:
            yield _name_query(truth, next(plain[vocabulary]), vocabulary)
            continue
        tried = islice(ambiguous[vocabulary], len(names[vocabulary]))
        name = next((n for n in tried if len(truth.satisfying(n)) > 1), None)
        if name is None:
            yield _name_query(truth, next(plain[vocabulary]), vocabulary)
        else:
            yield _description(rng.fork("description", number), truth, name, vocabulary)


def _names(truth: BuildingTruth, rules: EpisodeRules) -> dict[Vocabulary, list[str]]:
    """Names that a phrase may use, by vocabulary, in the scene's order."""
    known = {canonical(c) for c in rules.categories}
    names: dict[Vocabulary, dict[str, None]] = {"seen": {}, "synonym": {}, "unseen": {}}
    for instance in _searchable(truth):
        label = _label_of(instance)
        if label.category in rules.categories:
            names["seen"][label.category] = None
            others = (s for s in label.synonyms if s not in rules.categories)
            names["synonym"].update(dict.fromkeys(others))
        elif canonical(label.category) not in known:
            names["unseen"][label.category] = None
    return {vocabulary: list(found) for vocabulary, found in names.items()}


def _searchable(truth: BuildingTruth) -> list[Instance]:
    """Instances of sufficient size whose category is not ubiquitous."""
    return [
        instance
        for instance in truth.scene.instances
        if instance.label is not None
        and instance.label.category not in _UBIQUITOUS
        and _largest_side_m2(instance) >= _MIN_SIDE_AREA_M2
    ]


def _largest_side_m2(instance: Instance) -> float:
    sides = zip(instance.box_min, instance.box_max, strict=True)
    *_, middle, longest = sorted(high - low for low, high in sides)
    return middle * longest


def _name_query(truth: BuildingTruth, name: str, vocabulary: Vocabulary) -> Query:
    wanted = truth.satisfying(name)
    return Query(name, vocabulary, False, wanted, near_misses(truth.scene.instances, Goal(name)))


def _description(
    rng: RandomStream, truth: BuildingTruth, name: str, vocabulary: Vocabulary
) -> Query:
    """Query by a phrase that is true of only some objects of this name, else by the name.

    A phrase that is true of a single object gets the article "the", as in natural speech.
    """
    bearers = truth.satisfying(name)
    target = rng.choice([b for b in bearers if b in _searchable(truth)] or bearers)
    for phrase in rng.shuffled(_phrases(name, _label_of(target))):
        goal = Goal(phrase)
        if all(_label_of(b).satisfies(goal) for b in bearers):
            continue
        wanted = truth.satisfying(phrase)
        if target in wanted:
            text = f"the {phrase}" if len(wanted) == 1 else phrase
            return Query(text, vocabulary, True, wanted, near_misses(truth.scene.instances, goal))
    return _name_query(truth, name, vocabulary)


def _phrases(name: str, label: ObjectLabel) -> list[str]:
    """True phrases about an object: by attributes, by room, by objects beside it."""
    looks = [f"{a} {name}" for a in label.attributes if not a.startswith(("in ", "with "))]
    others = [other for other in label.beside[:3] if not label.is_named(other)]
    phrases = [*looks, *(f"{name} beside the {other}" for other in others)]
    if label.room:
        in_room = f"in the {label.room}"
        phrases += [f"{text} {in_room}" for text in (name, *looks)]
    return phrases


def _label_of(instance: Instance) -> ObjectLabel:
    if instance.label is None:
        raise ValueError(f"{instance.name} is part of the building and has no label")
    return instance.label
