"""Models of wardrobes, dressers and cabinets."""

from hypernav.houses.materials import BLACK_METAL, MIRROR, Palette, lacquer, plastic
from hypernav.houses.modelling.joinery import case, four_legs, front
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, panel
from hypernav.houses.modelling.surfaces import cylinder, lathe
from hypernav.houses.random_stream import RandomStream


def wardrobe(rng: RandomStream, palette: Palette) -> Model:
    """A tall closet for clothes with two or three doors, perhaps one with a mirror."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
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
        front(
            builder,
            wood,
            palette.metal,
            each,
            high - 0.1 - drawer,
            at=(x, deep / 2 - 0.02, 0.08 + drawer),
            upright=True,
            side=side,
            framed=framed,
        )
        if drawer:
            front(builder, wood, palette.metal, each, drawer, at=(x, deep / 2 - 0.02, 0.08))
        if mirrored and k == doors // 2:
            builder.add(
                MIRROR,
                panel(
                    each * 0.6,
                    high - 0.5 - drawer,
                    at=(x - side * 0.03, deep / 2 + 0.003, 0.25 + drawer),
                ),
            )
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
            front(
                builder,
                wood,
                palette.metal,
                each - 0.01,
                tall,
                at=(x, deep / 2 - 0.02, 0.07 + row * tall),
                grip=grip,
            )
    return builder.model(
        "dresser",
        "chest of drawers",
        main=wood,
        supports=(
            SupportSurface(
                -wide / 2 + 0.05, -deep / 2 + 0.04, wide / 2 - 0.05, deep / 2 - 0.05, high + 0.005
            ),
        ),
    )


def cabinet(rng: RandomStream, palette: Palette) -> Model:
    """A sideboard with doors."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
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
        front(
            builder,
            wood,
            palette.metal,
            each - 0.006,
            high - leg - 0.04 - drawers,
            at=(x, deep / 2 - 0.02, leg + 0.01),
            grip="knob",
            upright=True,
            side=1.0 if k % 2 == 0 else -1.0,
            framed=framed,
        )
        if drawers:
            front(
                builder,
                wood,
                palette.metal,
                each - 0.006,
                drawers,
                at=(x, deep / 2 - 0.02, high - 0.03 - drawers),
                grip="knob",
            )
    return builder.model(
        "cabinet",
        "sideboard",
        "buffet",
        main=wood,
        supports=(
            SupportSurface(
                -wide / 2 + 0.05, -deep / 2 + 0.05, wide / 2 - 0.05, deep / 2 - 0.05, high
            ),
        ),
    )


def tv_stand(rng: RandomStream, palette: Palette) -> Model:
    """A low cabinet under a television."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    wide, deep, leg = rng.uniform(1.45, 1.75), 0.42, rng.choice((0.05, 0.12))
    high = rng.uniform(0.45, 0.55)
    case(builder, wood, wide, deep, high - leg, at=(0, 0, leg), board=0.022)
    builder.add(wood, *four_legs(wide - 0.1, deep - 0.06, leg, thick=0.045))
    third = wide / 3
    for s in (-1.0, 1.0):
        builder.add(
            wood, box(0.018, deep - 0.01, high - leg - 0.04, at=(s * third / 2, 0, leg + 0.02))
        )
        front(
            builder,
            wood,
            palette.metal,
            third - 0.02,
            high - leg - 0.05,
            at=(s * third, deep / 2 - 0.02, leg + 0.025),
            grip="knob",
            upright=True,
            side=-s,
        )
    builder.add(wood, box(third, deep - 0.02, 0.018, at=(0, 0, leg + (high - leg) / 2)))
    builder.add(plastic("black"), box(0.32, 0.22, 0.06, at=(0, 0.02, leg + 0.023), bevel=0.006))
    return builder.model(
        "tv stand",
        "media console",
        "television stand",
        main=wood,
        supports=(
            SupportSurface(
                -wide / 2 + 0.05, -deep / 2 + 0.03, wide / 2 - 0.05, deep / 2 - 0.03, high, 1.3
            ),
        ),
    )


def filing_cabinet(rng: RandomStream, palette: Palette) -> Model:
    """Steel drawers for papers."""
    del palette
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
    return builder.model(
        "filing cabinet",
        "file cabinet",
        main=steel,
        supports=(SupportSurface(-0.21, -0.25, 0.21, 0.25, high),),
    )


def display_cabinet(rng: RandomStream, palette: Palette) -> Model:
    """A cabinet with lit shelves above and doors below."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    wide, deep, high = 0.9, 0.4, 1.85
    case(builder, wood, wide, deep, high - 0.8, at=(0, 0, 0.8), back=lacquer("white"))
    builder.add(wood, box(wide, deep - 0.02, 0.8, at=(0, -0.01, 0), bevel=0.004))
    for s in (-1.0, 1.0):
        front(
            builder,
            wood,
            palette.metal,
            wide / 2,
            0.7,
            at=(s * wide / 4, deep / 2 - 0.02, 0.06),
            grip="knob",
            upright=True,
            side=-s,
            framed=True,
        )
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
        builder.add(
            wood,
            box(
                0.03, 0.02, high - 0.84, at=(s * (wide / 2 - 0.02), deep / 2 - 0.01, 0.82)
            ).swapped_uv(),
        )
    return builder.model(
        "cabinet", "display cabinet", "china cabinet", main=wood, attributes=("tall",)
    )
