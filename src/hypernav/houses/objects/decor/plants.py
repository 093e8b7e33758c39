"""Models of plants in pots."""

import math

from hypernav.houses.materials import CERAMIC, TERRACOTTA, Palette, plastic
from hypernav.houses.modelling.mesh import Finish, join
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import cushion
from hypernav.houses.modelling.surfaces import ball, lathe
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.objects.decor.leaves import _frond, _polar, _spread, green, leaves, rosette
from hypernav.houses.random_stream import RandomStream

_SOIL = Finish("soil", (1.0, 1.0, 1.0), 0.2)
_BARK = Finish("wood", (0.45, 0.34, 0.24), 0.3)


def pot(
    builder: ModelBuilder, rng: RandomStream, palette: Palette, radius: float, high: float
) -> None:
    """A pot with earth, standing on z = 0."""
    finish = rng.choice(
        (
            TERRACOTTA,
            CERAMIC,
            Finish("concrete", (0.6, 0.6, 0.58), 0.8, "gray", "stone"),
            Finish("wicker", (0.74, 0.58, 0.38), 0.2, "light brown", "wicker"),
            Finish("", plastic(palette.accent_hue).color, 1.0, palette.accent_hue, "ceramic"),
            Finish("", (0.12, 0.12, 0.13), 1.0, "black", "ceramic"),
        )
    )
    base = radius * rng.uniform(0.68, 0.9)
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
    builder.add(finish, lathe(profile, sides=24))
    builder.add(_SOIL, lathe([(0.0, high - 0.025), (radius * 0.94, high - 0.03)][::-1], sides=20))


def snake_plant(rng: RandomStream, palette: Palette) -> Model:
    """A snake plant with upright leaves."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.12, 0.16), rng.uniform(0.22, 0.3)
    pot(builder, rng, palette, radius, high)
    turns = _spread(rng, rng.integer(14, 20))
    roots = [_polar(turn, rng.uniform(0.1, 0.75) * radius, high - 0.03) for turn in turns]
    swords = leaves(
        [rng.uniform(0.4, 0.72) for _ in turns],
        [rng.uniform(0.055, 0.08) for _ in turns],
        [rng.uniform(-4, 12) for _ in turns],
        [rng.uniform(74, 88) for _ in turns],
        turns,
        roots,
        fold=0.35,
        shape="sword",
    )
    builder.add(green(rng, "striped leaf"), swords)
    return _named(builder, "snake plant")


def _named(builder: ModelBuilder, species: str) -> Model:
    return builder.model("potted plant", "plant", species, attributes=("green",))


def leafy_plant(rng: RandomStream, palette: Palette) -> Model:
    """A rosette of broad leaves, like a peace lily or a fern."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.13, 0.18), rng.uniform(0.22, 0.34)
    pot(builder, rng, palette, radius, high)
    kind = rng.choice(("peace lily", "fern", "rubber plant"))
    foliage = green(rng)
    if kind == "fern":
        builder.add(foliage, rosette(rng, 46, 0.42, 0.055, "sword", (0, 0, high - 0.03)))
    elif kind == "peace lily":
        builder.add(foliage, rosette(rng, 30, 0.48, 0.14, "oval", (0, 0, high - 0.03)))
    else:
        builder.add(
            _BARK, rod((0, 0, high - 0.03), (0.02, 0.01, high + 0.6), 0.012, end_radius=0.007)
        )
        turns = _spread(rng, 21)
        stem = [(0.0, 0.0, high + 0.05 + 0.028 * k) for k in range(21)]
        builder.add(
            foliage,
            leaves(
                [rng.uniform(0.2, 0.27) for _ in turns],
                [0.11] * 21,
                [40.0] * 21,
                [50.0] * 21,
                turns,
                stem,
            ),
        )
    return _named(builder, kind)


def monstera(rng: RandomStream, palette: Palette) -> Model:
    """Long stalks with large heart-shaped leaves."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.15, 0.19), rng.uniform(0.28, 0.36)
    pot(builder, rng, palette, radius, high)
    stalks, tips, sizes = [], [], []
    turns = _spread(rng, rng.integer(14, 19))
    for k, turn in enumerate(turns):
        out, up = rng.uniform(0.1, 0.26), 0.2 + 0.5 * k / len(turns)
        tip = _polar(turn, out, high + up)
        stalks.append(
            tube(
                [_polar(turn, 0.03, high - 0.03), _polar(turn, out * 0.5, high + up * 0.65), tip],
                0.006,
                sides=5,
            )
        )
        tips.append(tip)
        sizes.append(rng.uniform(0.24, 0.33))
    foliage = green(rng)
    builder.add(foliage.tinted(0.9), join(stalks))
    builder.add(
        foliage,
        leaves(
            sizes,
            [0.85 * s for s in sizes],
            [rng.uniform(30, 70) for _ in turns],
            [rng.uniform(0, 30) for _ in turns],
            turns,
            tips,
            fold=0.12,
            shape="heart",
        ),
    )
    return _named(builder, "monstera")


def indoor_tree(rng: RandomStream, palette: Palette) -> Model:
    """A small tree: a fig with many small leaves, or a palm with fronds."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.16, 0.2), rng.uniform(0.28, 0.36)
    pot(builder, rng, palette, radius, high)
    foliage = green(rng)
    if rng.chance(0.5):
        trunk = rng.uniform(0.3, 0.45)
        builder.add(
            _BARK,
            tube(
                [(0, 0, high - 0.03), (0.02, 0.01, high + trunk * 0.5), (0, 0, high + trunk + 0.3)],
                [0.02, 0.017, 0.01],
            ),
        )
        crown = high + trunk + 0.32
        turns, positions = _spread(rng, 190), []
        for turn in turns:
            rise = rng.uniform(-1.0, 1.0)
            reach = math.sqrt(max(1.0 - rise * rise, 0.0)) * rng.uniform(0.55, 1.0) * 0.3
            positions.append(_polar(turn, reach, crown + rise * 0.34))
        builder.add(
            foliage,
            leaves(
                [rng.uniform(0.09, 0.13) for _ in turns],
                [0.05] * 190,
                [40.0] * 190,
                [rng.uniform(-25, 50) for _ in turns],
                turns,
                positions,
                steps=3,
            ),
        )
        return _named(builder, "ficus")
    fronds = []
    for turn in _spread(rng, 11):
        lift, long = rng.uniform(60, 86), rng.uniform(0.75, 1.0)
        fronds.append(
            _frond(long, lift, rng.uniform(60, 100)).turned(turn).moved(0, 0, high - 0.02)
        )
    builder.add(foliage, join(fronds))
    return _named(builder, "palm")


def small_plant(rng: RandomStream, palette: Palette) -> Model:
    """A little plant for tables and sills."""
    builder = ModelBuilder()
    radius, high = rng.uniform(0.055, 0.075), rng.uniform(0.09, 0.12)
    pot(builder, rng, palette, radius, high)
    kind = rng.choice(("succulent", "cactus", "herb"))
    if kind == "cactus":
        builder.add(
            green(rng, ""),
            ball(0.07, 0.07, 0.16, at=(0, 0, high + 0.05), sides=12),
            ball(0.035, 0.035, 0.07, at=(0.04, 0, high + 0.07), sides=8),
        )
    else:
        count, long, wide = (26, 0.09, 0.035) if kind == "succulent" else (34, 0.14, 0.04)
        builder.add(green(rng), rosette(rng, count, long, wide, "oval", (0, 0, high - 0.02)))
    return builder.model(
        kind, "plant", "small plant", "potted plant", attributes=("green", "small")
    )


def flower_vase(rng: RandomStream, palette: Palette) -> Model:
    """A vase with cut flowers."""
    builder = ModelBuilder()
    glaze = Finish(
        "",
        plastic(rng.choice((palette.accent_hue, "white", "blue", "teal"))).color,
        1.0,
        "",
        "ceramic",
    )
    high = rng.uniform(0.18, 0.26)
    builder.add(
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
    ink = rng.choice(
        (
            (0.85, 0.2, 0.25),
            (0.95, 0.75, 0.2),
            (0.9, 0.55, 0.7),
            (0.95, 0.93, 0.88),
            (0.6, 0.35, 0.7),
        )
    )
    stems, heads, roots = [], [], []
    turns = _spread(rng, 9)
    for turn in turns:
        out, up = rng.uniform(0.03, 0.12), rng.uniform(0.12, 0.24)
        tip = _polar(turn, out, high + up)
        stems.append(rod((0, 0, high - 0.05), tip, 0.003, sides=5))
        heads.append(ball(0.05, 0.05, 0.035, at=tip, sides=8))
        roots.append(_polar(turn, out * 0.4, high + up * 0.3))
    stems.append(
        leaves(
            [0.1] * 9, [0.035] * 9, [30.0] * 9, [50.0] * 9, [t + 40 for t in turns], roots, steps=3
        )
    )
    builder.add(green(rng, ""), join(stems))
    builder.add(Finish("", ink), join(heads))
    return builder.model("vase", "flower vase", "vase with flowers", main=glaze)


def hedge_box(rng: RandomStream, palette: Palette) -> Model:
    """A long planter with dense green, for balconies."""
    builder = ModelBuilder()
    finish = palette.furniture_wood(rng)
    builder.add(finish, cushion(0.8, 0.26, 0.3, radius=0.01))
    foliage = green(rng)
    for k in range(5):
        builder.add(foliage, rosette(rng, 26, 0.2, 0.05, "oval", ((k - 2) * 0.15, 0, 0.28)))
    return builder.model("potted plant", "plant", "planter", attributes=("green",))
