"""What else people call a thing: wider words, and those that one person uses for another's.

A detector has one word for a thing, and who asks for it may have another: a cactus is a potted
plant. That only guides the robot through what it remembers. What counts as reached is decided by
the names of the scene alone (`hypernav.core.labels`).
"""

_CALLED: dict[str, tuple[str, ...]] = {
    "potted plant": ("cactus", "succulent", "herb", "fern", "orchid", "bonsai", "palm", "flower"),
    "chair": ("armchair", "recliner", "stool"),
    "stool": ("ottoman", "pouf"),
    "sofa": ("futon", "sectional", "daybed"),
    "rug": ("bath mat", "doormat", "mat"),
    "stove": ("oven", "cooktop", "hob", "range"),
    "oven": ("stove", "range"),
    "toilet": ("lavatory", "wc"),
    "lavatory": ("toilet",),
    "sink": ("washbasin", "basin"),
    "washbasin": ("sink",),
    "basin": ("sink",),
    "cabinet": ("cupboard", "sideboard", "dresser"),
    "cupboard": ("cabinet", "wardrobe"),
    "closet": ("wardrobe",),
    "wardrobe": ("closet",),
    "shelf": ("bookshelf",),
    "table": ("desk",),
    "desk": ("table",),
    "lamp": ("chandelier", "lantern"),
    "picture": ("poster", "photo", "artwork", "picture frame"),
    "basket": ("hamper",),
    "cup": ("mug",),
    "mug": ("cup",),
    "bag": ("backpack", "handbag"),
    "luggage": ("suitcase",),
    "suitcase": ("luggage",),
    "toy": ("teddy bear", "doll"),
    "computer": ("laptop",),
    "screen": ("tv", "computer monitor"),
    "tv": ("screen",),
    "exercise equipment": ("treadmill", "exercise bike", "dumbbell"),
    "curtain": ("drapes",),
    "extractor hood": ("range hood",),
    "cooker hood": ("range hood",),
}
_WIDER: dict[str, tuple[str, ...]] = {}
for _word, _things in _CALLED.items():
    for _thing in _things:
        _WIDER[_thing] = (*_WIDER.get(_thing, ()), _word)


def other_names(name: str) -> tuple[str, ...]:
    """What else a thing of a name, in the singular, may be called."""
    return _WIDER.get(name, ())
