"""Names of objects, and whether an object is what a goal asks for.

Names are matched by a small, predictable grammar, not by a language model: the match decides what
counts as reached, so it must be the same on every machine and easy to read.

A detector has one word for a thing, and who asks for it may have another: a cactus is a potted
plant. Such other names only guide the robot through what it remembers.
"""

import re
from dataclasses import dataclass
from functools import lru_cache

from hypernav.core.goal import Goal
from hypernav.core.naming.words import caseless, first_sentence, noun_phrase, without_lead_in

_ALIKE: tuple[tuple[str, ...], ...] = (
    ("stove", "oven", "range"),
    ("bath", "bathtub"),
    ("sink", "washbasin", "basin"),
    ("cabinet", "cupboard"),
    ("sideboard", "dresser"),
    ("closet", "wardrobe"),
    ("table", "desk"),
    ("kitchen counter", "kitchen cabinet"),
    ("reception counter", "reception desk"),
    ("hamper", "laundry basket"),
    ("pillow", "cushion"),
    ("pouf", "ottoman"),
    ("coat rack", "coat stand", "hat stand", "coat hanger"),
    ("cup", "mug"),
    ("backpack", "rucksack"),
    ("handbag", "purse"),
    ("luggage", "suitcase"),
    ("teddy bear", "stuffed animal"),
    ("tv", "screen"),
    ("remote", "remote control"),
    ("speaker", "loudspeaker"),
    ("copier", "photocopier", "copy machine", "multifunction printer"),
    ("server rack", "server cabinet"),
    ("whiteboard", "dry erase board"),
    ("curtain", "drape"),
    ("coffee machine", "coffee maker"),
    ("microwave", "microwave oven"),
    ("blender", "mixer"),
    ("water dispenser", "water cooler"),
    ("vacuum cleaner", "hoover"),
    ("radiator", "heater"),
    ("fireplace", "hearth"),
    ("fish tank", "aquarium"),
    ("stairs", "staircase"),
    ("range hood", "extractor hood", "cooker hood"),
)
"""Names that one person uses for what another calls by the other ones of a row."""
_KINDS: dict[str, tuple[str, ...]] = {
    "potted plant": ("cactus", "succulent", "herb", "fern", "orchid", "bonsai", "palm", "flower"),
    "chair": ("armchair", "recliner", "stool"),
    "stool": ("ottoman", "pouf"),
    "sofa": ("futon", "sectional", "daybed"),
    "rug": ("bath mat", "doormat", "mat"),
    "stove": ("cooktop", "hob"),
    "cabinet": ("sideboard", "dresser"),
    "cupboard": ("wardrobe", "kitchen cabinet"),
    "shelf": ("bookshelf", "storage rack"),
    "shelving unit": ("bookshelf", "storage rack"),
    "lamp": ("chandelier", "lantern"),
    "picture": ("poster", "photo", "artwork", "picture frame"),
    "basket": ("hamper",),
    "bag": ("backpack", "handbag"),
    "coat hanger": ("coat hooks",),
    "toy": ("teddy bear", "doll"),
    "computer": ("laptop",),
    "screen": ("computer monitor",),
    "exercise equipment": ("treadmill", "exercise bike", "dumbbell"),
}
"""What is a kind of a wider word; the wider word names each of them, but not the other way."""
_OTHER: dict[str, tuple[str, ...]] = {}
for _row in _ALIKE:
    for _name in _row:
        _OTHER[_name] = tuple(one for one in _row if one != _name)
for _wider, _kinds in _KINDS.items():
    for _name in _kinds:
        _OTHER[_name] = (*_OTHER.get(_name, ()), _wider)

_SYNONYMS: tuple[tuple[str, ...], ...] = (
    ("sofa", "couch", "settee", "loveseat"),
    ("toilet", "lavatory", "wc", "water closet", "loo"),
    ("tv", "television", "television set", "tv monitor", "tvmonitor", "tv set", "telly"),
    ("refrigerator", "fridge"),
    ("potted plant", "plant", "house plant", "houseplant", "indoor plant", "pottedplant"),
    ("dining table", "dinner table", "diningtable"),
    ("nightstand", "night stand", "bedside table", "night table"),
    ("wardrobe", "armoire"),
    ("exercise equipment", "gym equipment", "fitness equipment", "exercise machine"),
    ("trash can", "garbage can", "waste bin", "trash bin", "bin", "dustbin", "rubbish bin"),
    ("tv stand", "television stand", "tv cabinet", "media console"),
    ("rug", "carpet"),
    ("doormat", "door mat"),
    ("cell phone", "mobile phone", "smartphone"),
    ("bicycle", "bike"),
    ("bookshelf", "bookcase", "book shelf"),
    ("picture", "painting"),
    ("armchair", "arm chair", "easy chair", "fauteuil"),
    ("dresser", "chest of drawers"),
    ("washing machine", "washer", "clothes washer"),
    ("clothes dryer", "tumble dryer", "dryer"),
    ("bathtub", "bath tub", "tub"),
    ("lamp", "light"),
    ("hair dryer", "hair drier", "blow dryer"),
    ("stool", "footstool"),
    ("piano", "upright piano"),
    ("laptop", "laptop computer", "notebook computer"),
    ("coffee table", "cocktail table"),
    ("desk", "writing desk"),
    ("stove", "cooker"),
)
_CANONICAL = {name: group[0] for group in _SYNONYMS for name in group}
_SINGULARS = (
    (re.compile(r"\b((?:cook|mov|hood|bean|brown|smooth|self)i|nich|quich|ax)es$"), r"\1e"),
    (re.compile(r"(ch|sh|ss|x)es$"), r"\1"),
    (re.compile(r"(shel|lea|loa|scar)ves$"), r"\1f"),
    (re.compile(r"knives$"), "knife"),
    (re.compile(r"(\w\w[^aeiou\W])ies$"), r"\1y"),
    (re.compile(r"(\w\w[^s\W])s$"), r"\1"),
)
"""Ends of plurals, and what the singular has there; the first that fits."""
_ARTICLE = re.compile(r"^(?:please )?(?:find |go to )?(?:the |a |an |my |some )?")
_IN_ROOM = re.compile(r" (?:(?:in|inside) (?:the |a |an |my )?|of (?:the|my) )(.+)$")
"""After "of" a room has an article: "the door of the kitchen", but a "chest of drawers"."""
_BESIDE = re.compile(r" (?:beside|next to|near|by|close to|on|under|at) (?:the |a |an |my )?(.+)$")


def other_names(name: str) -> tuple[str, ...]:
    """What else a thing of a name, in the singular, may be called."""
    return _OTHER.get(name, ())


@lru_cache(maxsize=65_536)
def normalise(name: str) -> str:
    """Without case (`caseless`), single spaces, no article, hyphens and underscores as spaces."""
    words = re.sub(r"[\s_\-]+", " ", caseless(name)).strip(" .!?\"'")
    return _ARTICLE.sub("", words)


@lru_cache(maxsize=65_536)
def canonical(name: str) -> str:
    """One name for all names that mean the same: "couch" and "settee" give "sofa".

    A plural is read as its singular.
    """
    name = normalise(name)
    if name in _CANONICAL:
        return _CANONICAL[name]
    if name.endswith("s") and name[:-1] in _CANONICAL:
        return _CANONICAL[name[:-1]]
    plural = next((end for end in _SINGULARS if end[0].search(name)), None)
    singular = name if plural is None else plural[0].sub(plural[1], name)
    return _CANONICAL.get(singular, singular)


def names_of(name: str) -> list[str]:
    """All names that mean the same, the given one first."""
    canon = canonical(name)
    group = next((group for group in _SYNONYMS if group[0] == canon), (canon,))
    return list(dict.fromkeys((name, *group)))


def same_name(a: str, b: str) -> bool:
    """Whether two names mean the same kind of object."""
    return canonical(a) == canonical(b)


@dataclass(frozen=True)
class AskedPlace:
    """Where a goal's words say that it is.

    Attributes:
        before: The words before, which say what it is; see `noun_phrase`.
        room: Room that it is in; empty if none is said.
        beside: What it is beside; empty if nothing is said.
    """

    before: str
    room: str = ""
    beside: str = ""


@lru_cache(maxsize=4096)
def asked_place(goal: Goal) -> AskedPlace:
    """Read "WHAT [beside the THING] [in the ROOM]", or the first sentence of a description."""
    return place_in(goal.text)


def place_in(text: str) -> AskedPlace:
    """The same of any text, whatever a model wrote."""
    text, room, beside = first_sentence(without_lead_in(normalise(text))), "", ""
    before = noun_phrase(text)
    if (match := _IN_ROOM.search(text)) is not None:
        text, room = text[: match.start()], noun_phrase(match[1])
    if (match := _BESIDE.search(text)) is not None:
        beside = noun_phrase(match[1])
    return AskedPlace(before, room, beside)


def label_for(goal: Goal) -> str:
    """What a thing is called that was taken for a goal: its text, or the name in a description."""
    name = asked_place(goal).before
    return goal.text if name == normalise(goal.text) else name


@dataclass(frozen=True)
class ObjectLabel:
    """Description of one object of a scene.

    Attributes:
        category: Kind of the object, for example "sofa".
        synonyms: Other names that fit, narrower or wider ("L-shaped sofa", "couch").
        attributes: Properties of the object ("red", "wooden", "L-shaped").
        room: Room that the object stands in; empty if unknown.
        beside: Categories of the objects next to it.
    """

    category: str
    synonyms: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    room: str = ""
    beside: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Category and synonyms."""
        return (self.category, *self.synonyms)

    def is_named(self, name: str) -> bool:
        """Whether a bare name fits: the category, a synonym, or the head noun of one of these.

        A "coffee table" is a "table", and a "tv stand" is not a "tv".
        """
        wanted = canonical(name)
        return any(
            wanted == canonical(own) or normalise(own).endswith(" " + wanted) for own in self.names
        )

    @lru_cache(maxsize=4096)  # noqa: B019 - labels are small values, and the same in every image
    def satisfies(self, goal: Goal) -> bool:
        """Whether this object is what the goal asks for.

        Reads "ATTRIBUTE… NAME [in the ROOM] [beside the THING]". Every part of the text must be
        true of the object.
        """
        text = normalise(goal.text)
        if self.is_named(text):
            return True
        text = without_lead_in(text)
        if (match := _IN_ROOM.search(text)) is not None:
            if not self.room or canonical(match[1]) != canonical(self.room):
                return False
            text = text[: match.start()]
        if (match := _BESIDE.search(text)) is not None:
            if not any(same_name(match[1], other) for other in self.beside):
                return False
            text = text[: match.start()]
        return self._fits_phrase(text.split())

    def may_satisfy(self, goal: Goal) -> bool:
        """Whether this object is of the kind that the goal asks for, whatever else it asks."""
        return self.named_words(goal) > 0

    def named_words(self, goal: Goal) -> int:
        """Number of the goal's last words, its place aside, that may name this object; else 0.

        Two words of "the metal table lamp" name a table lamp, and one names a ceiling lamp. A
        cactus may be called a potted plant, and a "dish washer" is a dishwasher.
        """
        words = asked_place(goal).before.split()
        heads = range(len(words))
        return next((len(words) - k for k in heads if self._may_be_called(words[k:])), 0)

    def has_own_name_in(self, goal: Goal) -> bool:
        """Whether the goal's last words, its place aside, are a name of this object itself."""
        words = asked_place(goal).before.split()
        return any(self.is_named(" ".join(words[head:])) for head in range(len(words)))

    def _may_be_called(self, words: list[str]) -> bool:
        name = " ".join(words)
        if self.is_named(name):
            return True
        wanted, joined = canonical(name), "".join(words)
        own = {form(one) for one in self.names for form in (canonical, normalise)}
        return any(wanted in other_names(one) or joined == one.replace(" ", "") for one in own)

    def _fits_phrase(self, words: list[str]) -> bool:
        true_words = {word for text in self.attributes for word in normalise(text).split()}
        for head in range(len(words)):
            if self.is_named(" ".join(words[head:])):
                return all(word in true_words for word in words[:head])
        return False
