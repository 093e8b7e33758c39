"""Models of wardrobes, dressers, cabinets, shelves and racks."""

from functools import partial

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod
from hypernav.simulator.houses.modelling.joinery import case, four_legs, front
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    MIRROR,
    Palette,
    fabric,
    image_finish,
    lacquer,
    plastic,
)
from hypernav.simulator.houses.modelling.model import (
    Finish,
    Model,
    ModelBuilder,
    Part,
    SupportSurface,
)
from hypernav.simulator.houses.modelling.solids import box, cushion, panel
from hypernav.simulator.houses.random_stream import RandomStream


def wardrobe(rng: RandomStream, palette: Palette) -> Model:
    """A tall closet for clothes with two or three doors, perhaps one with a mirror."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    fit = partial(front, builder, wood, palette.metal)
    doors = rng.choice((2, 2, 3))
    wide, deep, high = doors * 0.5, 0.58, rng.uniform(1.95, 2.15)
    builder.add(wood, box(wide, deep - 0.02, high, at=(0, -0.01, 0), bevel=0.004).swapped_uv())
    builder.add(wood, box(wide + 0.03, deep + 0.01, 0.04, at=(0, 0, high), bevel=0.008))
    framed, mirrored = rng.chance(0.4), rng.chance(0.35)
    drawer = 0.26 if rng.chance(0.4) else 0.0
    each = wide / doors
    for k in range(doors):
        x = (k + 0.5 - doors / 2) * each
        side = 1.0 if k % 2 == 0 else -1.0
        at = (x, deep / 2 - 0.02, 0.08 + drawer)
        fit(each, high - 0.1 - drawer, at=at, upright=True, side=side, framed=framed)
        if drawer:
            fit(each, drawer, at=(x, deep / 2 - 0.02, 0.08))
        if mirrored and k == doors // 2:
            at = (x - side * 0.03, deep / 2 + 0.003, 0.25 + drawer)
            part = panel(each * 0.6, high - 0.5 - drawer, at=at)
            builder.add(MIRROR, part)
    return builder.model("wardrobe", "armoire", "closet", main=wood)


def dresser(rng: RandomStream, palette: Palette) -> Model:
    """A chest of drawers."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    columns = rng.choice((1, 2))
    rows = rng.choice((3, 4))
    wide, deep, high = (0.8 if columns == 1 else 1.3), 0.45, 0.26 * rows + 0.08
    case(builder, wood, wide, deep - 0.02, high - 0.02, at=(0, -0.01, 0.0))
    builder.add(wood, box(wide + 0.02, deep + 0.01, 0.025, at=(0, 0, high - 0.02), bevel=0.006))
    grip = rng.choice(("bar", "knob", "cup"))
    each = wide / columns
    tall = (high - 0.1) / rows
    for row in range(rows):
        for column in range(columns):
            x = (column + 0.5 - columns / 2) * each
            at = (x, deep / 2 - 0.02, 0.07 + row * tall)
            front(builder, wood, palette.metal, each - 0.01, tall, at=at, grip=grip)
    surface = SupportSurface(
        -wide / 2 + 0.05, -deep / 2 + 0.04, wide / 2 - 0.05, deep / 2 - 0.05, high + 0.005
    )
    return builder.model("dresser", "chest of drawers", main=wood, supports=(surface,))


def cabinet(rng: RandomStream, palette: Palette) -> Model:
    """A sideboard with doors."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    fit = partial(front, builder, wood, palette.metal)
    doors = rng.choice((2, 3))
    wide, deep, leg = doors * 0.45, 0.42, rng.choice((0.08, 0.16))
    high = rng.uniform(0.78, 0.9)
    builder.add(wood, box(wide, deep - 0.02, high - leg - 0.02, at=(0, -0.01, leg), bevel=0.003))
    builder.add(wood, box(wide + 0.03, deep + 0.02, 0.025, at=(0, 0, high - 0.025), bevel=0.006))
    builder.add(wood, *four_legs(wide - 0.06, deep - 0.06, leg, thick=0.045, taper=0.6))
    each = wide / doors
    framed = rng.chance(0.5)
    drawers = 0.16 if rng.chance(0.5) else 0.0
    for k in range(doors):
        x = (k + 0.5 - doors / 2) * each
        fit(
            each - 0.006,
            high - leg - 0.04 - drawers,
            at=(x, deep / 2 - 0.02, leg + 0.01),
            grip="knob",
            upright=True,
            side=1.0 if k % 2 == 0 else -1.0,
            framed=framed,
        )
        if drawers:
            at = (x, deep / 2 - 0.02, high - 0.03 - drawers)
            fit(each - 0.006, drawers, at=at, grip="knob")
    surface = SupportSurface(
        -wide / 2 + 0.05, -deep / 2 + 0.05, wide / 2 - 0.05, deep / 2 - 0.05, high
    )
    return builder.model("cabinet", "sideboard", "buffet", main=wood, supports=(surface,))


def tv_stand(rng: RandomStream, palette: Palette) -> Model:
    """A low cabinet under a television."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    fit = partial(front, builder, wood, palette.metal)
    wide, deep, leg = rng.uniform(1.45, 1.75), 0.42, rng.choice((0.05, 0.12))
    high = rng.uniform(0.45, 0.55)
    case(builder, wood, wide, deep, high - leg, at=(0, 0, leg), board=0.022)
    builder.add(wood, *four_legs(wide - 0.1, deep - 0.06, leg, thick=0.045))
    third = wide / 3
    for s in (-1.0, 1.0):
        builder.add(
            wood, box(0.018, deep - 0.01, high - leg - 0.04, at=(s * third / 2, 0, leg + 0.02))
        )
        at = (s * third, deep / 2 - 0.02, leg + 0.025)
        fit(third - 0.02, high - leg - 0.05, at=at, grip="knob", upright=True, side=-s)
    builder.add(wood, box(third, deep - 0.02, 0.018, at=(0, 0, leg + (high - leg) / 2)))
    builder.add(plastic("black"), box(0.32, 0.22, 0.06, at=(0, 0.02, leg + 0.023), bevel=0.006))
    surface = SupportSurface(
        -wide / 2 + 0.05, -deep / 2 + 0.03, wide / 2 - 0.05, deep / 2 - 0.03, high, 1.3
    )
    return builder.model(
        "tv stand", "media console", "television stand", main=wood, supports=(surface,)
    )


def filing_cabinet(rng: RandomStream, palette: Palette) -> Model:
    """Steel drawers for papers."""
    builder = ModelBuilder()
    steel = Finish(
        "",
        rng.choice(((0.62, 0.63, 0.63), (0.25, 0.26, 0.28), (0.85, 0.85, 0.83))),
        1.0,
        "gray",
        "metal",
    )
    rows = rng.choice((2, 3, 4))
    high = rows * 0.31 + 0.06
    builder.add(steel, box(0.42, 0.5, high, bevel=0.004))
    for k in range(rows):
        front(builder, steel, BLACK_METAL, 0.4, 0.3, at=(0, 0.25, 0.04 + k * 0.31), grip="cup")
        builder.add(lacquer("white"), panel(0.08, 0.04, at=(0, 0.27, 0.24 + k * 0.31)))
    surface = SupportSurface(-0.21, -0.25, 0.21, 0.25, high)
    return builder.model("filing cabinet", "file cabinet", main=steel, supports=(surface,))


def display_cabinet(rng: RandomStream, palette: Palette) -> Model:
    """A cabinet with lit shelves above and doors below."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    fit = partial(front, builder, wood, palette.metal)
    wide, deep, high = 0.9, 0.4, 1.85
    case(builder, wood, wide, deep, high - 0.8, at=(0, 0, 0.8), back=lacquer("white"))
    builder.add(wood, box(wide, deep - 0.02, 0.8, at=(0, -0.01, 0), bevel=0.004))
    for s in (-1.0, 1.0):
        at = (s * wide / 4, deep / 2 - 0.02, 0.06)
        fit(wide / 2, 0.7, at=at, grip="knob", upright=True, side=-s, framed=True)
    for k in range(3):
        z = 0.82 + k * 0.34
        builder.add(wood, box(wide - 0.04, deep - 0.03, 0.015, at=(0, 0, z - 0.015)))
        for j in range(4):
            x = (j - 1.5) * 0.2
            cup = lathe([(0, 0), (0.03, 0), (0.045, 0.05), (0.05, 0.09)], sides=14, crease_deg=60)
            plate = cylinder(0.09, 0.01, sides=20).turned(-75, "x").moved(0, 0, 0.09)
            builder.add(
                plastic(rng.choice(("white", "white", "light blue", "cream"))),
                (cup if rng.chance(0.5) else plate).moved(x, 0.0, z),
            )
    for s in (-1.0, 0.0, 1.0):
        part = box(0.03, 0.02, high - 0.84, at=(s * (wide / 2 - 0.02), deep / 2 - 0.01, 0.82))
        builder.add(wood, part.swapped_uv())
    return builder.model(
        "cabinet", "display cabinet", "china cabinet", main=wood, attributes=("tall",)
    )


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
        Finish(key, (1.0, 1.0, 1.0), 1.0, "", "paper"), face.textured(long / 0.8, 1.0, shift)
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
        part = lathe(
            [(0, 0), (0.035, 0), (0.055, 0.07), (0.03, 0.14), (0.035, 0.17)],
            sides=16,
            crease_deg=60,
        ).moved(x, 0.02, z)
        builder.add(ink, part)
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
    surface = SupportSurface(-0.3, -0.12, 0.3, 0.12, 0.5)
    return builder.model("shoe rack", "shoe shelf", main=wood, supports=(surface,))


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
            profile = [(0.13, 0.0), (0.115, 0.3), (0.1, 0.7), (0.07, 0.86), (0.02, 0.93)]
            coat = lathe(profile, sides=12, crease_deg=80)
            builder.add(cloth, coat.scaled(1.0, 0.7, 1.0).moved(0.15, 0, 0.76).turned(turn))
    return builder.model("coat rack", "coat stand", "hat stand", main=wood)


def metal_shelf(rng: RandomStream, palette: Palette) -> Model:
    """A storage rack with boxes."""
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
                profile = [
                    (0, -0.14),
                    (0.037, -0.14),
                    (0.037, 0.04),
                    (0.014, 0.09),
                    (0.014, 0.15),
                    (0, 0.15),
                ]
                bottle = lathe(profile, sides=12)
                builder.add(glass, bottle.turned(90, "x").moved((j - 1.5) * 0.13, 0, z + 0.068))
    for sx in (-1.0, 1.0):
        for y in (-0.1, 0.1):
            builder.add(frame, box(0.03, 0.02, 0.6, at=(sx * 0.27, y, 0)).swapped_uv())
    return builder.model("wine rack", "bottle rack", main=frame)
