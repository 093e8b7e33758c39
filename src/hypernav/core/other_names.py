"""What else people call a thing: wider words, and those that one person uses for another's.

A detector has one word for a thing, and who asks for it may have another: a cactus is a potted
plant. That only guides the robot through what it remembers. What counts as reached is decided by
the names of the scene alone (`hypernav.core.labels`).
"""

_ALIKE: tuple[tuple[str, ...], ...] = (
    ("stove", "oven", "range"),
    ("toilet", "lavatory", "wc"),
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


def other_names(name: str) -> tuple[str, ...]:
    """What else a thing of a name, in the singular, may be called."""
    return _OTHER.get(name, ())
