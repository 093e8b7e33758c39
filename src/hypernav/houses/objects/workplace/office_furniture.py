"""Models of furniture of offices and other public buildings."""

from hypernav.houses.materials import (
    BLACK_METAL,
    CHROME,
    STEEL,
    WHITE_METAL,
    Palette,
    fabric,
    lacquer,
    plastic,
    wood,
)
from hypernav.houses.modelling.joinery import four_legs, front
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, prism
from hypernav.houses.modelling.surfaces import cylinder, rounded_outline
from hypernav.houses.objects.furniture.tables import full_support
from hypernav.houses.random_stream import RandomStream

TABLE_M = 0.74


def _table_top(rng: RandomStream, palette: Palette) -> Finish:
    return rng.weighted(
        ((lacquer("white"), 4.0), (wood(palette.wood), 3.0), (lacquer("light gray"), 2.0))
    )


def work_desk(rng: RandomStream, palette: Palette, wide: float = 1.6) -> Model:
    """A plain desk on a steel frame; its user sits in front (+y)."""
    builder = ModelBuilder()
    top = _table_top(rng, palette)
    frame = rng.choice((WHITE_METAL, BLACK_METAL, STEEL))
    deep = 0.8
    builder.add(top, box(wide, deep, 0.025, at=(0, 0, TABLE_M - 0.025), bevel=0.004))
    if rng.chance(0.5):
        builder.add(
            frame, *four_legs(wide - 0.06, deep - 0.08, TABLE_M - 0.025, thick=0.05, taper=1.0)
        )
    else:
        for s in (-1.0, 1.0):
            x = s * (wide / 2 - 0.2)
            builder.add(
                frame,
                box(0.08, deep - 0.1, 0.03, at=(x, 0, 0)),
                box(0.07, 0.1, TABLE_M - 0.055, at=(x, -0.06, 0.03)).swapped_uv(),
            )
    builder.add(frame, box(wide - 0.3, 0.03, 0.06, at=(0, -0.06, TABLE_M - 0.09)))
    builder.add(top.tinted(0.92), box(wide - 0.2, 0.016, 0.32, at=(0, -deep / 2 + 0.06, 0.37)))
    return builder.model(
        "desk",
        "office desk",
        "workstation",
        main=top,
        supports=(full_support(wide, deep, TABLE_M, 0.9),),
    )


def desk_screen(rng: RandomStream, palette: Palette, wide: float = 1.6) -> Model:
    """A cloth-covered screen that stands on the edge between two desks."""
    builder = ModelBuilder()
    cloth = fabric(rng.choice((palette.accent_hue, "gray", "dark gray", "light blue")))
    builder.add(cloth, box(wide - 0.1, 0.024, 0.36, at=(0, 0, 0.02), bevel=0.006))
    for s in (-1.0, 1.0):
        builder.add(STEEL, box(0.04, 0.03, 0.04, at=(s * wide * 0.35, 0, 0)))
    return builder.model("desk divider", "desk screen", "privacy screen", main=cloth)


def drawer_unit(rng: RandomStream, palette: Palette) -> Model:
    """Three drawers on castors, for under a desk."""
    del palette
    builder = ModelBuilder()
    body = rng.choice((WHITE_METAL, plastic("light gray"), BLACK_METAL))
    builder.add(body, box(0.4, 0.5, 0.5, at=(0, 0, 0.05), bevel=0.004))
    for k in range(3):
        front(builder, body, STEEL, 0.39, 0.155, at=(0, 0.25, 0.07 + 0.16 * k), grip="bar")
    for x in (-0.15, 0.15):
        for y in (-0.2, 0.2):
            builder.add(BLACK_METAL, cylinder(0.02, 0.05, at=(x, y, 0), sides=8))
    return builder.model(
        "drawer unit",
        "pedestal",
        "rolling drawers",
        main=body,
        supports=(SupportSurface(-0.18, -0.22, 0.18, 0.22, 0.55),),
    )


def meeting_table(rng: RandomStream, palette: Palette, seats: int = 6) -> Model:
    """A long table for 4 to 12 people."""
    builder = ModelBuilder()
    long = {4: 1.4, 6: 1.9, 8: 2.4, 10: 2.6}.get(seats, 2.6)
    deep = 0.9 if seats <= 6 else 1.15
    top = _table_top(rng, palette)
    radius = rng.choice((0.02, 0.12, deep / 2 - 0.02))
    outline = rounded_outline(long, deep, radius, 6)
    builder.add(top, prism(outline, 0.032, z=TABLE_M - 0.032))
    metal = rng.choice((STEEL, BLACK_METAL, CHROME))
    for s in (-1.0, 1.0):
        x = s * (long / 2 - 0.45)
        builder.add(
            metal,
            box(0.09, deep * 0.6, 0.025, at=(x, 0, 0), bevel=0.006),
            box(0.06, 0.2, TABLE_M - 0.05, at=(x, 0, 0.02)).swapped_uv(),
        )
    builder.add(plastic("black"), box(0.24, 0.1, 0.006, at=(0, 0, TABLE_M)))
    support = SupportSurface(
        -long / 2 + 0.25, -deep / 2 + 0.08, long / 2 - 0.25, deep / 2 - 0.08, TABLE_M + 0.006
    )
    return builder.model(
        "meeting table", "conference table", "table", main=top, supports=(support,)
    )


def reception_desk(rng: RandomStream, palette: Palette) -> Model:
    """A counter with a raised front; visitors stand in front (+y)."""
    builder = ModelBuilder()
    body = rng.choice((lacquer("white"), lacquer("dark gray"), wood(palette.wood)))
    stone = rng.choice(
        (
            lacquer("white"),
            wood(palette.secondary_wood),
            Finish("marble", (0.8, 0.79, 0.77), 0.8, "white", "stone"),
        )
    )
    long = rng.choice((1.8, 2.1, 2.4))
    builder.add(body, box(long, 0.06, 1.06, at=(0, 0.34, 0), bevel=0.004))
    builder.add(stone, box(long + 0.06, 0.3, 0.04, at=(0, 0.27, 1.06), bevel=0.006))
    for s in (-1.0, 1.0):
        builder.add(body, box(0.04, 0.7, 0.74, at=(s * (long / 2 - 0.02), -0.02, 0)).swapped_uv())
    builder.add(stone, box(long - 0.08, 0.66, 0.03, at=(0, -0.02, 0.71)))
    accent = fabric(palette.accent_hue) if rng.chance(0.3) else plastic(palette.accent_hue)
    builder.add(accent, box(long - 0.3, 0.012, 0.12, at=(0, 0.374, 0.16)))
    return builder.model(
        "reception desk",
        "front desk",
        "reception counter",
        "counter",
        main=body,
        supports=(SupportSurface(-long / 2 + 0.1, -0.32, long / 2 - 0.1, 0.1, 0.74, 0.5),),
    )


def locker(rng: RandomStream, palette: Palette) -> Model:
    """Three or four narrow steel lockers side by side."""
    builder = ModelBuilder()
    steel = Finish(
        "",
        rng.choice(((0.6, 0.62, 0.63), (0.3, 0.4, 0.5), (0.82, 0.82, 0.8))),
        1.0,
        "gray",
        "metal",
    )
    count = rng.choice((3, 4))
    wide, high = 0.3 * count, 1.8
    door = plastic(palette.accent_hue) if rng.chance(0.3) else steel
    builder.add(steel, box(wide, 0.46, high, at=(0, -0.01, 0.02), bevel=0.003))
    builder.add(BLACK_METAL, box(wide - 0.04, 0.4, 0.03, at=(0, -0.01, 0)))
    for k in range(count):
        x = (k + 0.5 - count / 2) * 0.3
        front(
            builder,
            door,
            BLACK_METAL,
            0.295,
            high - 0.1,
            at=(x, 0.22, 0.07),
            grip="knob",
            upright=True,
            side=1.0,
        )
        for j in range(3):
            builder.add(BLACK_METAL, box(0.14, 0.004, 0.008, at=(x, 0.24, 1.55 + 0.04 * j)))
    return builder.model("locker", "lockers", "steel cabinet", main=steel, attributes=("tall",))
