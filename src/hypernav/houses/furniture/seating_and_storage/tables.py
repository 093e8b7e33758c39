"""Tables to eat at, to sit at and to put things on."""

import math
from itertools import pairwise

from hypernav.houses.dice import Dice
from hypernav.houses.kit.joinery import case, four_legs, front
from hypernav.houses.kit.model import Bench, Model, Top
from hypernav.houses.kit.solids import box
from hypernav.houses.kit.surfaces import cylinder, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import BLACK_METAL, GLASS, Taste, lacquer

TABLE_M = 0.75


def whole_top(x: float, y: float, z: float, clearance_m: float = 0.6, inset: float = 0.04) -> Top:
    """All of a rectangular surface around the origin but its rim."""
    return Top(-x / 2 + inset, -y / 2 + inset, x / 2 - inset, y / 2 - inset, z, clearance_m)


def dining_table(dice: Dice, taste: Taste, seats: int = 4) -> Model:
    """A table to eat at, for 2, 4, 6 or 8."""
    if seats <= 4 and dice.chance(0.3):
        return _round_table(dice, taste)
    long = {2: 0.8, 4: 1.25, 6: 1.7, 8: 2.1}[seats] + dice.uniform(-0.04, 0.1)
    deep = dice.uniform(0.78, 0.9) if seats > 2 else 0.75
    wood = taste.furniture_wood(dice)
    bench = Bench()
    style = dice.choice(
        ("classic", "classic", "splayed", "trestle" if seats == 6 else "splayed", "metal")
    )
    plate = 0.032
    top = box(long, deep, plate, at=(0, 0, TABLE_M - plate), bevel=0.006)
    bench.add(wood, top)
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
        bench.add(wood if dice.chance(0.8) else lacquer("white"), *legs)
        for s in (-1.0, 1.0):
            bench.add(
                wood,
                box(
                    apron_x, 0.022, 0.09, at=(0, s * (apron_y / 2 - 0.012), TABLE_M - plate - 0.09)
                ),
            )
            bench.add(
                wood,
                box(
                    0.022, apron_y, 0.09, at=(s * (apron_x / 2 - 0.012), 0, TABLE_M - plate - 0.09)
                ).swapped_uv(),
            )
    elif style == "trestle":
        for s in (-1.0, 1.0):
            x = s * (long / 2 - 0.22)
            bench.add(
                wood,
                box(0.08, 0.1, TABLE_M - plate, at=(x, 0, 0), bevel=0.008).swapped_uv(),
                box(0.09, deep - 0.14, 0.06, at=(x, 0, 0), bevel=0.01),
                box(0.07, deep - 0.2, 0.05, at=(x, 0, TABLE_M - plate - 0.05), bevel=0.006),
            )
        bench.add(wood, box(long - 0.5, 0.04, 0.1, at=(0, 0, 0.3), bevel=0.006))
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
                bench.add(BLACK_METAL, rod(a, b, 0.022, sides=8))
    return bench.model(
        "dining table",
        "table",
        main=wood,
        attributes=("rectangular",),
        tops=(whole_top(long, deep, TABLE_M),),
    )


def _round_table(dice: Dice, taste: Taste) -> Model:
    bench = Bench()
    radius = dice.uniform(0.48, 0.58)
    wood = taste.furniture_wood(dice)
    bench.add(wood, cylinder(radius, 0.03, at=(0, 0, TABLE_M - 0.03), sides=40, bevel=0.008))
    if dice.chance(0.6):
        bench.add(
            wood,
            lathe(
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
            ),
        )
        for k in range(4):
            a = math.radians(90 * k + 45)
            c, s = math.cos(a), math.sin(a)
            bench.add(
                wood,
                tube(
                    [
                        (c * 0.04, s * 0.04, 0.2),
                        (c * 0.2, s * 0.2, 0.1),
                        (c * 0.32, s * 0.32, 0.025),
                    ],
                    [0.035, 0.03, 0.022],
                ),
            )
    else:
        side = radius * 1.2
        bench.add(wood, *four_legs(side, side, TABLE_M - 0.03, thick=0.055, taper=0.6, round_=True))
    inner = radius * 0.6
    return bench.model(
        "dining table",
        "table",
        "round table",
        main=wood,
        attributes=("round",),
        tops=(Top(-inner, -inner, inner, inner, TABLE_M),),
    )


def coffee_table(dice: Dice, taste: Taste) -> Model:
    """A low table before a sofa."""
    bench = Bench()
    wood = taste.furniture_wood(dice)
    high, long, deep = dice.uniform(0.38, 0.45), dice.uniform(0.9, 1.2), dice.uniform(0.5, 0.6)
    style = dice.choice(("shelf", "round", "glass"))
    if style == "round":
        radius = dice.uniform(0.36, 0.45)
        bench.add(wood, cylinder(radius, 0.028, at=(0, 0, high - 0.028), sides=36, bevel=0.008))
        for k in range(3):
            a = math.radians(120 * k + 30)
            c, s = math.cos(a) * radius, math.sin(a) * radius
            bench.add(
                wood,
                rod(
                    (c * 0.85, s * 0.85, 0),
                    (c * 0.6, s * 0.6, high - 0.02),
                    0.014,
                    end_radius=0.024,
                ),
            )
        inner = radius * 0.6
        tops = (Top(-inner, -inner, inner, inner, high),)
        return bench.model("coffee table", main=wood, attributes=("round",), tops=tops)
    plate = GLASS if style == "glass" else wood
    bench.add(
        plate,
        box(
            long,
            deep,
            0.02 if style == "glass" else 0.03,
            at=(0, 0, high - (0.02 if style == "glass" else 0.03)),
            bevel=0.005,
        ),
    )
    legs = BLACK_METAL if style == "glass" else wood
    bench.add(legs, *four_legs(long - 0.04, deep - 0.04, high - 0.025, thick=0.045, taper=0.9))
    bench.add(wood, box(long - 0.09, deep - 0.09, 0.018, at=(0, 0, 0.14), bevel=0.003))
    return bench.model(
        "coffee table",
        main=wood if style == "shelf" else GLASS,
        attributes=("low",),
        tops=(whole_top(long, deep, high),),
    )


def side_table(dice: Dice, taste: Taste) -> Model:
    """A small table beside a sofa."""
    bench = Bench()
    wood = taste.furniture_wood(dice)
    high = dice.uniform(0.5, 0.58)
    if dice.chance(0.5):
        bench.add(wood, cylinder(0.22, 0.022, at=(0, 0, high - 0.022), sides=28, bevel=0.006))
        bench.add(
            BLACK_METAL,
            cylinder(0.018, high - 0.03, at=(0, 0, 0.01)),
            cylinder(0.16, 0.014, sides=28),
        )
        tops = (Top(-0.14, -0.14, 0.14, 0.14, high),)
        return bench.model("side table", "end table", main=wood, attributes=("round",), tops=tops)
    bench.add(
        wood,
        box(0.44, 0.44, 0.024, at=(0, 0, high - 0.024), bevel=0.005),
        box(0.38, 0.38, 0.016, at=(0, 0, 0.16)),
    )
    bench.add(wood, *four_legs(0.42, 0.42, high - 0.02, thick=0.035))
    return bench.model("side table", "end table", main=wood, tops=(whole_top(0.44, 0.44, high),))


def nightstand(dice: Dice, taste: Taste) -> Model:
    """A small chest beside a bed."""
    bench = Bench()
    wood = taste.furniture_wood(dice)
    wide, deep, high = dice.uniform(0.42, 0.5), 0.4, dice.uniform(0.5, 0.58)
    leg = dice.choice((0.12, 0.06, 0.2))
    case(bench, wood, wide, deep, high - leg, at=(0, 0, leg))
    bench.add(wood, box(wide + 0.02, deep + 0.02, 0.022, at=(0, 0.0, high - 0.018), bevel=0.005))
    bench.add(wood, *four_legs(wide, deep, leg, thick=0.035))
    drawers = 1 if leg > 0.15 or dice.chance(0.4) else 2
    room = high - leg - 0.04
    grip = dice.choice(("bar", "knob"))
    each = room / 2
    for k in range(drawers):
        front(
            bench,
            wood,
            taste.metal,
            wide - 0.01,
            each,
            at=(0, deep / 2, high - 0.03 - (k + 1) * each),
            grip=grip,
        )
    return bench.model(
        "nightstand", "bedside table", main=wood, tops=(whole_top(wide, deep, high + 0.004),)
    )
