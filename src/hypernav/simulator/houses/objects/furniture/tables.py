"""Models of tables, nightstands, desks, consoles and worktops."""

import math
from functools import partial
from itertools import pairwise

from hypernav.simulator.houses.modelling.curves import cylinder, lathe, rod, rounded_outline, tube
from hypernav.simulator.houses.modelling.joinery import case, four_legs, front, square_bar
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CHROME,
    GLASS,
    MIRROR,
    Palette,
    lacquer,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder, SupportSurface
from hypernav.simulator.houses.modelling.solids import box, prism
from hypernav.simulator.houses.random_stream import RandomStream

TABLE_M = 0.75


def full_support(x: float, y: float, z: float, clearance_m: float = 0.6) -> SupportSurface:
    """Support surface of a rectangle around the origin, without its rim."""
    return SupportSurface(-x / 2 + 0.04, -y / 2 + 0.04, x / 2 - 0.04, y / 2 - 0.04, z, clearance_m)


def dining_table(rng: RandomStream, palette: Palette, seats: int = 4) -> Model:
    """A table to eat at, for 2, 4, 6 or 8."""
    if seats <= 4 and rng.chance(0.3):
        return _round_table(rng, palette)
    long = {2: 0.8, 4: 1.25, 6: 1.7, 8: 2.1}[seats] + rng.uniform(-0.04, 0.1)
    deep = rng.uniform(0.78, 0.9) if seats > 2 else 0.75
    wood = palette.furniture_wood(rng)
    builder = ModelBuilder()
    style = rng.choice(
        ("classic", "classic", "splayed", "trestle" if seats == 6 else "splayed", "metal")
    )
    plate = 0.032
    top = box(long, deep, plate, at=(0, 0, TABLE_M - plate), bevel=0.006)
    builder.add(wood, top)
    if style in ("classic", "splayed"):
        apron_x, apron_y = long - 0.14, deep - 0.14
        legs = four_legs(
            long - 0.08,
            deep - 0.08,
            TABLE_M - plate,
            thick=0.075 if style == "classic" else 0.055,
            taper=0.8 if style == "classic" else 0.5,
            round_=style == "splayed",
        )
        builder.add(wood if rng.chance(0.8) else lacquer("white"), *legs)
        for s in (-1.0, 1.0):
            part = box(
                apron_x, 0.022, 0.09, at=(0, s * (apron_y / 2 - 0.012), TABLE_M - plate - 0.09)
            )
            builder.add(wood, part)
            part = box(
                0.022, apron_y, 0.09, at=(s * (apron_x / 2 - 0.012), 0, TABLE_M - plate - 0.09)
            )
            builder.add(wood, part.swapped_uv())
    elif style == "trestle":
        for s in (-1.0, 1.0):
            x = s * (long / 2 - 0.22)
            builder.add(
                wood,
                box(0.08, 0.1, TABLE_M - plate, at=(x, 0, 0), bevel=0.008).swapped_uv(),
                box(0.09, deep - 0.14, 0.06, at=(x, 0, 0), bevel=0.01),
                box(0.07, deep - 0.2, 0.05, at=(x, 0, TABLE_M - plate - 0.05), bevel=0.006),
            )
        builder.add(wood, box(long - 0.5, 0.04, 0.1, at=(0, 0, 0.3), bevel=0.006))
    else:
        for s in (-1.0, 1.0):
            x = s * (long / 2 - 0.06)
            frame = [
                (x, -deep / 2 + 0.08, TABLE_M - plate),
                (x, -deep / 2 + 0.08, 0.02),
                (x, deep / 2 - 0.08, 0.02),
                (x, deep / 2 - 0.08, TABLE_M - plate),
            ]
            for a, b in pairwise(frame):
                builder.add(BLACK_METAL, rod(a, b, 0.022, sides=8))
    surface = full_support(long, deep, TABLE_M)
    return builder.model(
        "dining table", "table", main=wood, attributes=("rectangular",), supports=(surface,)
    )


def _round_table(rng: RandomStream, palette: Palette) -> Model:
    builder = ModelBuilder()
    radius = rng.uniform(0.48, 0.58)
    wood = palette.furniture_wood(rng)
    builder.add(wood, cylinder(radius, 0.03, at=(0, 0, TABLE_M - 0.03), sides=40, bevel=0.008))
    if rng.chance(0.6):
        part = lathe(
            [
                (0.0, 0.05),
                (0.06, 0.05),
                (0.05, 0.12),
                (0.075, 0.25),
                (0.045, 0.5),
                (0.07, 0.68),
                (0.16, 0.72),
                (0.0, 0.72),
            ]
        )
        builder.add(wood, part)
        for k in range(4):
            a = math.radians(90 * k + 45)
            c, s = math.cos(a), math.sin(a)
            part = tube(
                [(c * 0.04, s * 0.04, 0.2), (c * 0.2, s * 0.2, 0.1), (c * 0.32, s * 0.32, 0.025)],
                [0.035, 0.03, 0.022],
            )
            builder.add(wood, part)
    else:
        side = radius * 1.2
        builder.add(
            wood, *four_legs(side, side, TABLE_M - 0.03, thick=0.055, taper=0.6, round_=True)
        )
    inner = radius * 0.6
    surface = SupportSurface(-inner, -inner, inner, inner, TABLE_M)
    return builder.model(
        "dining table",
        "table",
        "round table",
        main=wood,
        attributes=("round",),
        supports=(surface,),
    )


def coffee_table(rng: RandomStream, palette: Palette) -> Model:
    """A low table before a sofa."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    high, long, deep = rng.uniform(0.38, 0.45), rng.uniform(0.9, 1.2), rng.uniform(0.5, 0.6)
    style = rng.choice(("shelf", "round", "glass"))
    if style == "round":
        radius = rng.uniform(0.36, 0.45)
        builder.add(wood, cylinder(radius, 0.028, at=(0, 0, high - 0.028), sides=36, bevel=0.008))
        for k in range(3):
            a = math.radians(120 * k + 30)
            c, s = math.cos(a) * radius, math.sin(a) * radius
            part = rod(
                (c * 0.85, s * 0.85, 0), (c * 0.6, s * 0.6, high - 0.02), 0.014, end_radius=0.024
            )
            builder.add(wood, part)
        inner = radius * 0.6
        supports = (SupportSurface(-inner, -inner, inner, inner, high),)
        return builder.model("coffee table", main=wood, attributes=("round",), supports=supports)
    plate = GLASS if style == "glass" else wood
    at = (0, 0, high - (0.02 if style == "glass" else 0.03))
    part = box(long, deep, 0.02 if style == "glass" else 0.03, at=at, bevel=0.005)
    builder.add(plate, part)
    legs = BLACK_METAL if style == "glass" else wood
    builder.add(legs, *four_legs(long - 0.04, deep - 0.04, high - 0.025, thick=0.045, taper=0.9))
    builder.add(wood, box(long - 0.09, deep - 0.09, 0.018, at=(0, 0, 0.14), bevel=0.003))
    return builder.model(
        "coffee table",
        main=wood if style == "shelf" else GLASS,
        attributes=("low",),
        supports=(full_support(long, deep, high),),
    )


def side_table(rng: RandomStream, palette: Palette) -> Model:
    """A small table beside a sofa."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    high = rng.uniform(0.5, 0.58)
    if rng.chance(0.5):
        builder.add(wood, cylinder(0.22, 0.022, at=(0, 0, high - 0.022), sides=28, bevel=0.006))
        builder.add(
            BLACK_METAL,
            cylinder(0.018, high - 0.03, at=(0, 0, 0.01)),
            cylinder(0.16, 0.014, sides=28),
        )
        supports = (SupportSurface(-0.14, -0.14, 0.14, 0.14, high),)
        return builder.model(
            "side table", "end table", main=wood, attributes=("round",), supports=supports
        )
    builder.add(
        wood,
        box(0.44, 0.44, 0.024, at=(0, 0, high - 0.024), bevel=0.005),
        box(0.38, 0.38, 0.016, at=(0, 0, 0.16)),
    )
    builder.add(wood, *four_legs(0.42, 0.42, high - 0.02, thick=0.035))
    return builder.model(
        "side table", "end table", main=wood, supports=(full_support(0.44, 0.44, high),)
    )


def nightstand(rng: RandomStream, palette: Palette) -> Model:
    """A small chest beside a bed."""
    builder = ModelBuilder()
    wood = palette.furniture_wood(rng)
    wide, deep, high = rng.uniform(0.42, 0.5), 0.4, rng.uniform(0.5, 0.58)
    leg = rng.choice((0.12, 0.06, 0.2))
    case(builder, wood, wide, deep, high - leg, at=(0, 0, leg))
    builder.add(wood, box(wide + 0.02, deep + 0.02, 0.022, at=(0, 0.0, high - 0.018), bevel=0.005))
    builder.add(wood, *four_legs(wide, deep, leg, thick=0.035))
    drawers = 1 if leg > 0.15 or rng.chance(0.4) else 2
    room = high - leg - 0.04
    grip = rng.choice(("bar", "knob"))
    each = room / 2
    for k in range(drawers):
        at = (0, deep / 2, high - 0.03 - (k + 1) * each)
        front(builder, wood, palette.metal, wide - 0.01, each, at=at, grip=grip)
    return builder.model(
        "nightstand", "bedside table", main=wood, supports=(full_support(wide, deep, high + 0.004),)
    )


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
            at = ((k - 0.5) * each, deep / 2 - 0.02, high - 0.15)
            front(builder, wood, palette.metal, each, 0.12, at=at, grip="knob")
        builder.add(wood, box(long - 0.1, deep - 0.06, 0.12, at=(0, 0, high - 0.146)))
    surface = full_support(long, deep, high)
    return builder.model(
        "console table", "hall table", "sideboard table", main=wood, supports=(surface,)
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
        at = (s * (long - 0.08) / 4, deep / 2 - 0.035, 0.62)
        front(builder, wood, palette.metal, (long - 0.08) / 2, 0.12, at=at, grip="knob")
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
    fit = partial(front, builder, body, palette.metal)
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
        fit(
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
    surface = SupportSurface(-0.18, -0.18, 0.18, 0.18, 0.72)
    return builder.model(
        "table",
        "bistro table",
        "garden table",
        main=top,
        attributes=("round",),
        supports=(surface,),
    )
