"""Plants in pots."""

import math

from hypernav.houses.dice import Dice
from hypernav.houses.furniture.decor.leaves import _frond, _polar, _spread, green, leaves, rosette
from hypernav.houses.kit.mesh import Finish, join
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import cushion
from hypernav.houses.kit.surfaces import ball, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import CERAMIC, TERRACOTTA, Taste, plastic

_SOIL = Finish("soil", (1.0, 1.0, 1.0), 0.2)
_BARK = Finish("wood", (0.45, 0.34, 0.24), 0.3)


def pot(bench: Bench, dice: Dice, taste: Taste, radius: float, high: float) -> None:
    """A pot with earth, standing on z = 0."""
    finish = dice.choice(
        (
            TERRACOTTA,
            CERAMIC,
            Finish("concrete", (0.6, 0.6, 0.58), 0.8, "gray", "stone"),
            Finish("wicker", (0.74, 0.58, 0.38), 0.2, "light brown", "wicker"),
            Finish("", plastic(taste.accent).color, 1.0, taste.accent, "ceramic"),
            Finish("", (0.12, 0.12, 0.13), 1.0, "black", "ceramic"),
        )
    )
    base = radius * dice.uniform(0.68, 0.9)
    rim = 0.03 if finish is TERRACOTTA else 0.012
    profile = [
        (0.0, 0.0),
        (base, 0.0),
        (radius * 0.97, high - rim * 1.5),
        (radius * 1.05, high - rim * 1.5),
        (radius * 1.06, high),
        (radius * 0.95, high),
        (radius * 0.92, high - 0.04),
    ]
    bench.add(finish, lathe(profile, sides=24))
    bench.add(_SOIL, lathe([(0.0, high - 0.025), (radius * 0.94, high - 0.03)][::-1], sides=20))


def snake_plant(dice: Dice, taste: Taste) -> Model:
    """Upright swords."""
    bench = Bench()
    radius, high = dice.uniform(0.12, 0.16), dice.uniform(0.22, 0.3)
    pot(bench, dice, taste, radius, high)
    turns = _spread(dice, dice.integer(14, 20))
    roots = [_polar(turn, dice.uniform(0.1, 0.75) * radius, high - 0.03) for turn in turns]
    swords = leaves(
        [dice.uniform(0.4, 0.72) for _ in turns],
        [dice.uniform(0.055, 0.08) for _ in turns],
        [dice.uniform(-4, 12) for _ in turns],
        [dice.uniform(74, 88) for _ in turns],
        turns,
        roots,
        fold=0.35,
        shape="sword",
    )
    bench.add(green(dice, "striped leaf"), swords)
    return _named(bench, "snake plant")


def _named(bench: Bench, species: str) -> Model:
    return bench.model("potted plant", "plant", species, attributes=("green",))


def leafy_plant(dice: Dice, taste: Taste) -> Model:
    """A rosette of broad leaves, like a peace lily or a fern."""
    bench = Bench()
    radius, high = dice.uniform(0.13, 0.18), dice.uniform(0.22, 0.34)
    pot(bench, dice, taste, radius, high)
    kind = dice.choice(("peace lily", "fern", "rubber plant"))
    foliage = green(dice)
    if kind == "fern":
        bench.add(foliage, rosette(dice, 46, 0.42, 0.055, "sword", (0, 0, high - 0.03)))
    elif kind == "peace lily":
        bench.add(foliage, rosette(dice, 30, 0.48, 0.14, "oval", (0, 0, high - 0.03)))
    else:
        bench.add(
            _BARK, rod((0, 0, high - 0.03), (0.02, 0.01, high + 0.6), 0.012, end_radius=0.007)
        )
        turns = _spread(dice, 21)
        stem = [(0.0, 0.0, high + 0.05 + 0.028 * k) for k in range(21)]
        bench.add(
            foliage,
            leaves(
                [dice.uniform(0.2, 0.27) for _ in turns],
                [0.11] * 21,
                [40.0] * 21,
                [50.0] * 21,
                turns,
                stem,
            ),
        )
    return _named(bench, kind)


def monstera(dice: Dice, taste: Taste) -> Model:
    """Long stalks with large heart-shaped leaves."""
    bench = Bench()
    radius, high = dice.uniform(0.15, 0.19), dice.uniform(0.28, 0.36)
    pot(bench, dice, taste, radius, high)
    stalks, tips, sizes = [], [], []
    turns = _spread(dice, dice.integer(14, 19))
    for k, turn in enumerate(turns):
        out, up = dice.uniform(0.1, 0.26), 0.2 + 0.5 * k / len(turns)
        tip = _polar(turn, out, high + up)
        stalks.append(
            tube(
                [_polar(turn, 0.03, high - 0.03), _polar(turn, out * 0.5, high + up * 0.65), tip],
                0.006,
                sides=5,
            )
        )
        tips.append(tip)
        sizes.append(dice.uniform(0.24, 0.33))
    foliage = green(dice)
    bench.add(foliage.tinted(0.9), join(stalks))
    bench.add(
        foliage,
        leaves(
            sizes,
            [0.85 * s for s in sizes],
            [dice.uniform(30, 70) for _ in turns],
            [dice.uniform(0, 30) for _ in turns],
            turns,
            tips,
            fold=0.12,
            shape="heart",
        ),
    )
    return _named(bench, "monstera")


def indoor_tree(dice: Dice, taste: Taste) -> Model:
    """A small tree: a fig with many small leaves, or a palm with fronds."""
    bench = Bench()
    radius, high = dice.uniform(0.16, 0.2), dice.uniform(0.28, 0.36)
    pot(bench, dice, taste, radius, high)
    foliage = green(dice)
    if dice.chance(0.5):
        trunk = dice.uniform(0.3, 0.45)
        bench.add(
            _BARK,
            tube(
                [(0, 0, high - 0.03), (0.02, 0.01, high + trunk * 0.5), (0, 0, high + trunk + 0.3)],
                [0.02, 0.017, 0.01],
            ),
        )
        crown = high + trunk + 0.32
        turns, places = _spread(dice, 190), []
        for turn in turns:
            rise = dice.uniform(-1.0, 1.0)
            reach = math.sqrt(max(1.0 - rise * rise, 0.0)) * dice.uniform(0.55, 1.0) * 0.3
            places.append(_polar(turn, reach, crown + rise * 0.34))
        bench.add(
            foliage,
            leaves(
                [dice.uniform(0.09, 0.13) for _ in turns],
                [0.05] * 190,
                [40.0] * 190,
                [dice.uniform(-25, 50) for _ in turns],
                turns,
                places,
                steps=3,
            ),
        )
        return _named(bench, "ficus")
    fronds = []
    for turn in _spread(dice, 11):
        lift, long = dice.uniform(60, 86), dice.uniform(0.75, 1.0)
        fronds.append(
            _frond(long, lift, dice.uniform(60, 100)).turned(turn).moved(0, 0, high - 0.02)
        )
    bench.add(foliage, join(fronds))
    return _named(bench, "palm")


def small_plant(dice: Dice, taste: Taste) -> Model:
    """A little plant for tables and sills."""
    bench = Bench()
    radius, high = dice.uniform(0.055, 0.075), dice.uniform(0.09, 0.12)
    pot(bench, dice, taste, radius, high)
    kind = dice.choice(("succulent", "cactus", "herb"))
    if kind == "cactus":
        bench.add(
            green(dice, ""),
            ball(0.07, 0.07, 0.16, at=(0, 0, high + 0.05), sides=12),
            ball(0.035, 0.035, 0.07, at=(0.04, 0, high + 0.07), sides=8),
        )
    else:
        count, long, wide = (26, 0.09, 0.035) if kind == "succulent" else (34, 0.14, 0.04)
        bench.add(green(dice), rosette(dice, count, long, wide, "oval", (0, 0, high - 0.02)))
    return bench.model(kind, "plant", "small plant", "potted plant", attributes=("green", "small"))


def flower_vase(dice: Dice, taste: Taste) -> Model:
    """A vase with cut flowers."""
    bench = Bench()
    glaze = Finish(
        "", plastic(dice.choice((taste.accent, "white", "blue", "teal"))).color, 1.0, "", "ceramic"
    )
    high = dice.uniform(0.18, 0.26)
    bench.add(
        glaze,
        lathe(
            [
                (0.0, 0.0),
                (0.045, 0.0),
                (0.07, high * 0.35),
                (0.06, high * 0.7),
                (0.03, high * 0.9),
                (0.042, high),
                (0.03, high - 0.01),
            ],
            sides=20,
            crease_deg=60,
        ),
    )
    ink = dice.choice(
        (
            (0.85, 0.2, 0.25),
            (0.95, 0.75, 0.2),
            (0.9, 0.55, 0.7),
            (0.95, 0.93, 0.88),
            (0.6, 0.35, 0.7),
        )
    )
    stems, heads, roots = [], [], []
    turns = _spread(dice, 9)
    for turn in turns:
        out, up = dice.uniform(0.03, 0.12), dice.uniform(0.12, 0.24)
        tip = _polar(turn, out, high + up)
        stems.append(rod((0, 0, high - 0.05), tip, 0.003, sides=5))
        heads.append(ball(0.05, 0.05, 0.035, at=tip, sides=8))
        roots.append(_polar(turn, out * 0.4, high + up * 0.3))
    stems.append(
        leaves(
            [0.1] * 9, [0.035] * 9, [30.0] * 9, [50.0] * 9, [t + 40 for t in turns], roots, steps=3
        )
    )
    bench.add(green(dice, ""), join(stems))
    bench.add(Finish("", ink), join(heads))
    return bench.model("vase", "flower vase", "vase with flowers", main=glaze)


def hedge_box(dice: Dice, taste: Taste) -> Model:
    """A long planter with dense green, for balconies."""
    bench = Bench()
    finish = taste.furniture_wood(dice)
    bench.add(finish, cushion(0.8, 0.26, 0.3, radius=0.01))
    foliage = green(dice)
    for k in range(5):
        bench.add(foliage, rosette(dice, 26, 0.2, 0.05, "oval", ((k - 2) * 0.15, 0, 0.28)))
    return bench.model("potted plant", "plant", "planter", attributes=("green",))
