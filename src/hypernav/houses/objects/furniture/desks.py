"""Models of tables with a special use: desks, consoles, worktops."""

from hypernav.houses.materials import BLACK_METAL, CHROME, MIRROR, Palette, lacquer
from hypernav.houses.modelling.joinery import case, four_legs, front, square_bar
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, prism
from hypernav.houses.modelling.surfaces import cylinder, rounded_outline
from hypernav.houses.objects.furniture.tables import full_support
from hypernav.houses.random_stream import RandomStream

TABLE_M = 0.75


def desk(rng: RandomStream, palette: Palette) -> Model:
    """A table to work at; its user sits in front (+y)."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    long, deep = rng.uniform(1.15, 1.5, 0.05), rng.uniform(0.6, 0.7)
    builder.add(wood, box(long, deep, 0.028, at=(0, 0, TABLE_M - 0.028), bevel=0.005))
    body = lacquer("white") if rng.chance(0.3) else wood
    if rng.chance(0.6):
        x = rng.choice((-1.0, 1.0)) * (long / 2 - 0.22)
        case(builder, body, 0.4, deep - 0.06, TABLE_M - 0.03, at=(x, -0.01, 0))
        each = (TABLE_M - 0.08) / 3
        for k in range(3):
            front(
                builder, body, palette.metal, 0.39, each, at=(x, deep / 2 - 0.04, 0.03 + k * each)
            )
        side = -x / abs(x) * (long / 2 - 0.03)
        builder.add(body, box(0.028, deep - 0.06, TABLE_M - 0.03, at=(side, -0.01, 0)).swapped_uv())
        builder.add(body, box(long - 0.1, 0.018, 0.35, at=(0, -deep / 2 + 0.06, 0.34)))
    else:
        legs = BLACK_METAL if rng.chance(0.5) else wood
        builder.add(
            legs, *four_legs(long - 0.04, deep - 0.04, TABLE_M - 0.028, thick=0.045, taper=0.8)
        )
        builder.add(legs, box(long - 0.12, 0.02, 0.08, at=(0, -deep / 2 + 0.05, TABLE_M - 0.11)))
    return builder.model(
        "desk", "writing desk", main=wood, supports=(full_support(long, deep, TABLE_M, 0.9),)
    )


def console_table(rng: RandomStream, palette: Palette) -> Model:
    """A narrow table against a wall."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    long, deep, high = rng.uniform(0.85, 1.15), 0.32, 0.8
    legs = BLACK_METAL if rng.chance(0.4) else wood
    builder.add(wood, box(long, deep, 0.025, at=(0, 0, high - 0.025), bevel=0.005))
    builder.add(wood, box(long - 0.06, deep - 0.04, 0.018, at=(0, 0, 0.16)))
    builder.add(legs, *four_legs(long - 0.03, deep - 0.02, high - 0.02, thick=0.035, taper=0.9))
    if rng.chance(0.5):
        each = (long - 0.1) / 2
        for k in range(2):
            front(
                builder,
                wood,
                palette.metal,
                each,
                0.12,
                at=((k - 0.5) * each, deep / 2 - 0.02, high - 0.15),
                grip="knob",
            )
        builder.add(wood, box(long - 0.1, deep - 0.06, 0.12, at=(0, 0, high - 0.146)))
    return builder.model(
        "console table",
        "hall table",
        "sideboard table",
        main=wood,
        supports=(full_support(long, deep, high),),
    )


def dressing_table(rng: RandomStream, palette: Palette) -> Model:
    """A table with a mirror, for the bedroom."""
    builder = ModelBuilder()
    wood = lacquer(palette.paint_hue) if rng.chance(0.5) else palette.furniture_wood(rng)
    long, deep = 0.9, 0.42
    builder.add(wood, box(long, deep, 0.025, at=(0, 0, 0.74), bevel=0.005))
    builder.add(wood, *four_legs(long - 0.03, deep - 0.02, 0.74, thick=0.04, taper=0.6))
    builder.add(wood, box(long - 0.06, deep - 0.06, 0.12, at=(0, -0.01, 0.62)))
    for s in (-1.0, 1.0):
        front(
            builder,
            wood,
            palette.metal,
            (long - 0.08) / 2,
            0.12,
            at=(s * (long - 0.08) / 4, deep / 2 - 0.035, 0.62),
            grip="knob",
        )
    outline = rounded_outline(0.56, 0.66, 0.14, 6)
    mirror = prism(outline, 0.02).turned(90, "x")
    builder.add(wood, mirror.scaled(1.1, 1, 1.08).moved(0, -deep / 2 + 0.03, 1.16))
    builder.add(MIRROR, mirror.moved(0, -deep / 2 + 0.042, 1.16))
    return builder.model(
        "dressing table", "vanity", main=wood, supports=(full_support(long, deep - 0.1, 0.765),)
    )


def kitchen_island(rng: RandomStream, palette: Palette) -> Model:
    """A free-standing worktop with cabinets below."""
    builder = ModelBuilder()
    body = lacquer(palette.paint_hue)
    long, deep, high = rng.uniform(1.2, 1.5), 0.75, 0.9
    builder.add(body, box(long - 0.08, deep - 0.14, high - 0.12, at=(0, 0.0, 0.08), bevel=0.003))
    builder.add(lacquer("dark gray"), box(long - 0.14, deep - 0.24, 0.08, at=(0, 0, 0)))
    worktop = (
        Finish("granite", (0.55, 0.53, 0.5), 0.4, "gray", "stone")
        if rng.chance(0.5)
        else palette.furniture_wood(rng)
    )
    builder.add(worktop, box(long, deep, 0.04, at=(0, 0, high - 0.04), bevel=0.006))
    each = (long - 0.1) / 3
    for k in range(3):
        front(
            builder,
            body,
            palette.metal,
            each,
            high - 0.16,
            at=((k - 1) * each, deep / 2 - 0.07, 0.1),
            upright=True,
            side=1.0 if k < 2 else -1.0,
            framed=rng.chance(0.5),
        )
    return builder.model(
        "kitchen island", "island counter", main=body, supports=(full_support(long, deep, high),)
    )


def folding_table(rng: RandomStream, palette: Palette) -> Model:
    """A small bistro table for the balcony."""
    builder = ModelBuilder()
    metal = rng.choice((BLACK_METAL, CHROME))
    top = palette.furniture_wood(rng)
    builder.add(top, cylinder(0.3, 0.02, at=(0, 0, 0.7), sides=28, bevel=0.005))
    for s in (-1.0, 1.0):
        builder.add(
            metal,
            square_bar((s * 0.24, -0.22, 0.0), (s * 0.22, 0.2, 0.7), 0.02),
            square_bar((s * 0.2, 0.22, 0.0), (s * 0.18, -0.2, 0.7), 0.02),
        )
    return builder.model(
        "table",
        "bistro table",
        "garden table",
        main=top,
        attributes=("round",),
        supports=(SupportSurface(-0.18, -0.18, 0.18, 0.18, 0.72),),
    )
