"""Models of open shelves and racks."""

from hypernav.houses.materials import BLACK_METAL, Palette, fabric, image_finish, lacquer, plastic
from hypernav.houses.modelling.joinery import case
from hypernav.houses.modelling.mesh import Finish, Part
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, cushion, panel
from hypernav.houses.modelling.surfaces import ball, lathe
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream


def bookshelf(rng: RandomStream, palette: Palette) -> Model:
    """Open shelves with books and a few ornaments."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    wide, deep, high = rng.choice((0.6, 0.8, 0.8, 1.0)), 0.3, rng.choice((1.1, 1.8, 1.95, 2.05))
    case(builder, wood, wide, deep, high, at=(0, 0, 0), board=0.022)
    rows = max(round(high / 0.36), 3)
    each = (high - 0.06) / rows
    for k in range(rows):
        z = 0.05 + k * each
        builder.add(wood, box(wide - 0.044, deep - 0.01, 0.02, at=(0, 0, z - 0.02)))
        _fill_shelf(builder, rng, wide - 0.06, deep, z, each - 0.03)
    return builder.model(
        "bookshelf",
        "bookcase",
        "shelf",
        main=wood,
        attributes=("tall",) if high > 1.5 else ("low",),
    )


def _fill_shelf(
    builder: ModelBuilder, rng: RandomStream, wide: float, deep: float, z: float, high: float
) -> None:
    tall = min(high * 0.9, 0.27)
    share = rng.choice((1.0, 0.7, 0.55, 0.4))
    long = wide * share
    left = rng.chance(0.5)
    x = (-1 if left else 1) * (wide - long) / 2
    key = f"book spines {rng.integer(0, 5)}"
    shift = rng.unit()
    # A row of books is one block whose face is an image; the tops stay in shadow.
    face = panel(long, tall, at=(x, 0.09, z))
    builder.add(
        Finish(key, (1.0, 1.0, 1.0), 1.0, "", "paper"), face.textured(long / 0.8, 1.0, shift, 0.0)
    )
    builder.add(
        Finish("", (0.85, 0.82, 0.74)), box(long - 0.004, 0.18, tall - 0.035, at=(x, -0.003, z))
    )
    if share < 1.0:
        middle = (1 if left else -1) * (long / 2 + 0.005)
        _ornament(builder, rng, middle, z, min(wide - long - 0.02, 0.26), tall)
    del deep


def _ornament(
    builder: ModelBuilder, rng: RandomStream, x: float, z: float, wide: float, high: float
) -> None:
    kind = rng.choice(("box", "vase", "ball", "frame"))
    ink = plastic(rng.choice(("white", "teal", "orange", "gray", "yellow", "navy")))
    if kind == "box":
        builder.add(ink, box(wide * 0.8, 0.2, high * 0.6, at=(x, 0, z), bevel=0.006))
    elif kind == "vase":
        builder.add(
            ink,
            lathe(
                [(0, 0), (0.035, 0), (0.055, 0.07), (0.03, 0.14), (0.035, 0.17)],
                sides=16,
                crease_deg=60,
            ).moved(x, 0.02, z),
        )
    elif kind == "ball":
        builder.add(ink, ball(0.12, 0.12, 0.12, at=(x, 0.02, z + 0.06)))
    else:
        builder.add(lacquer("black"), box(0.15, 0.015, 0.2, at=(x, 0.0, z)))
        builder.add(
            image_finish(f"painting {rng.integer(0, 15)}"),
            panel(0.12, 0.17, at=(x, 0.0085, z + 0.015)),
        )


def shoe_rack(rng: RandomStream, palette: Palette) -> Model:
    """Two slatted levels with shoes."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    wide = 0.75
    for s in (-1.0, 1.0):
        builder.add(wood, box(0.025, 0.3, 0.48, at=(s * wide / 2, 0, 0)).swapped_uv())
    for z in (0.12, 0.32):
        for y in (-0.1, 0.0, 0.1):
            builder.add(wood, box(wide - 0.03, 0.04, 0.015, at=(0, y, z)))
        for k in range(3):
            if rng.chance(0.8):
                builder.extend(shoe_parts(rng, (k - 1) * 0.23, z + 0.015))
    builder.add(wood, box(wide + 0.03, 0.32, 0.02, at=(0, 0, 0.48), bevel=0.004))
    return builder.model(
        "shoe rack",
        "shoe shelf",
        main=wood,
        supports=(SupportSurface(-0.3, -0.12, 0.3, 0.12, 0.5),),
    )


def shoe_parts(rng: RandomStream, x: float, z: float) -> list[Part]:
    """Parts of a pair of shoes, toes to the front."""
    hide = plastic(rng.choice(("brown", "black", "white", "red", "blue")))
    parts = []
    for s in (-1.0, 1.0):
        parts.append(
            Part(box(0.085, 0.27, 0.022, at=(x + s * 0.052, 0, z), bevel=0.008), plastic("white"))
        )
        parts.append(
            Part(
                cushion(0.08, 0.25, 0.06, radius=0.028, at=(x + s * 0.052, 0.004, z + 0.015)), hide
            )
        )
        parts.append(
            Part(
                cushion(0.076, 0.12, 0.11, radius=0.03, at=(x + s * 0.052, -0.065, z + 0.015)), hide
            )
        )
    return parts


def coat_rack(rng: RandomStream, palette: Palette) -> Model:
    """A stand with hooks and a coat or two."""
    builder = ModelBuilder()
    wood = BLACK_METAL if rng.chance(0.4) else palette.furniture_wood(rng)
    builder.add(
        wood,
        rod((0, 0, 0.03), (0, 0, 1.75), 0.022, end_radius=0.018),
        ball(0.05, 0.05, 0.05, at=(0, 0, 1.77)),
    )
    for k in range(4):
        turn = 90 * k + 45
        builder.add(wood, rod((0, 0, 0.12), (0.24, 0, 0.015), 0.016).turned(turn))
        builder.add(wood, rod((0, 0, 1.6), (0.15, 0, 1.7), 0.01, sides=6).turned(turn))
        if k < 2 and rng.chance(0.8):
            cloth = fabric(rng.choice(("navy", "beige", "black", "red", "green", "gray")))
            coat = lathe(
                [(0.13, 0.0), (0.115, 0.3), (0.1, 0.7), (0.07, 0.86), (0.02, 0.93)],
                sides=12,
                crease_deg=80,
            )
            builder.add(cloth, coat.scaled(1.0, 0.7, 1.0).moved(0.15, 0, 0.76).turned(turn))
    return builder.model("coat rack", "coat stand", "hat stand", main=wood)


def metal_shelf(rng: RandomStream, palette: Palette) -> Model:
    """A storage rack with boxes."""
    del palette
    builder = ModelBuilder()
    wide, deep, high = rng.choice((0.8, 0.9)), 0.4, 1.75
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            builder.add(
                BLACK_METAL,
                box(0.03, 0.03, high, at=(sx * (wide / 2 - 0.015), sy * (deep / 2 - 0.015), 0)),
            )
    card = Finish("cardboard", (0.72, 0.55, 0.37), 0.5, "brown", "cardboard")
    for k in range(4):
        z = 0.1 + k * 0.52
        builder.add(plastic("gray"), box(wide, deep, 0.025, at=(0, 0, z)))
        x = -wide / 2 + 0.05
        while x < wide / 2 - 0.2 and k < 4:
            w, h = rng.uniform(0.18, 0.32), rng.uniform(0.15, 0.36)
            if x + w < wide / 2 - 0.03:
                material = rng.choice(
                    (card, card, plastic("blue"), plastic("white"), plastic("gray"))
                )
                builder.add(
                    material, box(w, deep - 0.1, h, at=(x + w / 2, 0, z + 0.025), bevel=0.004)
                )
            x += w + 0.03
    return builder.model(
        "storage rack", "metal shelf", "shelving unit", "shelf", attributes=("black", "metal")
    )


def wine_rack(rng: RandomStream, palette: Palette) -> Model:
    """Bottles lying in a wooden lattice."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    for k in range(4):
        z = 0.02 + k * 0.17
        for y in (-0.1, 0.1):
            builder.add(frame, box(0.56, 0.02, 0.03, at=(0, y, z)))
        for j in range(4):
            if k < 3 and rng.chance(0.7):
                glass = Finish(
                    "", rng.choice(((0.1, 0.2, 0.1), (0.18, 0.06, 0.07), (0.12, 0.12, 0.1)))
                )
                bottle = lathe(
                    [
                        (0, -0.14),
                        (0.037, -0.14),
                        (0.037, 0.04),
                        (0.014, 0.09),
                        (0.014, 0.15),
                        (0, 0.15),
                    ],
                    sides=12,
                )
                builder.add(glass, bottle.turned(90, "x").moved((j - 1.5) * 0.13, 0, z + 0.068))
    for sx in (-1.0, 1.0):
        for y in (-0.1, 0.1):
            builder.add(frame, box(0.03, 0.02, 0.6, at=(sx * 0.27, y, 0)).swapped_uv())
    return builder.model("wine rack", "bottle rack", main=frame)
