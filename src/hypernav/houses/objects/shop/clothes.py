"""Models of what clothes shops have: rails, mannequins, stands for shoes."""

import math

from hypernav.houses.materials import BLACK_METAL, CHROME, Palette, fabric, plastic, wood
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.objects.furniture.shelves import shoe_parts
from hypernav.houses.random_stream import RandomStream

_HUES = ("red", "navy", "black", "gray", "cream", "teal", "green", "white", "pink", "brown", "blue")


def _cloth(rng: RandomStream) -> Finish:
    return fabric(rng.choice(_HUES))


def clothes_rail(rng: RandomStream, palette: Palette) -> Model:
    """A straight rail with clothes on hangers."""
    del palette
    builder = ModelBuilder()
    metal = rng.choice((BLACK_METAL, CHROME))
    wide, high = rng.choice((1.2, 1.5)), 1.45
    for s in (-1.0, 1.0):
        x = s * (wide / 2 - 0.03)
        builder.add(metal, rod((x, 0, 0.03), (x, 0, high), 0.016, sides=8))
        builder.add(metal, box(0.05, 0.5, 0.035, at=(x, 0, 0), bevel=0.006))
    builder.add(metal, rod((-wide / 2 + 0.03, 0, high), (wide / 2 - 0.03, 0, high), 0.014, sides=8))
    x = -wide / 2 + 0.12
    cloth, long = _cloth(rng), rng.uniform(0.6, 1.05)
    while x < wide / 2 - 0.12:
        if rng.chance(0.25):
            cloth, long = _cloth(rng), rng.uniform(0.6, 1.05)
        if rng.chance(0.9):
            wobble = rng.uniform(-0.012, 0.012)
            piece = cushion(
                0.045, 0.44, long, radius=0.02, rounds=1, at=(x, wobble, high - 0.06 - long)
            )
            builder.add(cloth, piece)
            builder.add(CHROME, rod((x, 0, high - 0.07), (x, 0, high + 0.02), 0.004, sides=4))
        x += 0.062
    return builder.model("clothes rack", "clothes rail", "garment rack", main=metal)


def round_rack(rng: RandomStream, palette: Palette) -> Model:
    """A round stand with clothes on hangers."""
    del palette
    builder = ModelBuilder()
    high, radius = 1.3, 0.42
    builder.add(CHROME, cylinder(0.03, high, sides=10))
    builder.add(CHROME, box(0.7, 0.05, 0.04, bevel=0.008), box(0.05, 0.7, 0.04, bevel=0.008))
    cloth, long = _cloth(rng), rng.uniform(0.6, 0.95)
    for k in range(22):
        angle = 2.0 * math.pi * k / 22
        if k % 6 == 0:
            cloth, long = _cloth(rng), rng.uniform(0.6, 0.95)
        piece = cushion(0.06, 0.4, long, radius=0.02, rounds=1, at=(0, 0, high - 0.06 - long))
        turned = piece.turned(math.degrees(angle) + 90.0)
        builder.add(cloth, turned.moved(radius * math.cos(angle), radius * math.sin(angle), 0))
        builder.add(
            CHROME,
            rod(
                (radius * math.cos(angle), radius * math.sin(angle), high),
                (
                    radius * math.cos(angle + 2.0 * math.pi / 22),
                    radius * math.sin(angle + 2.0 * math.pi / 22),
                    high,
                ),
                0.012,
                sides=6,
            ),
        )
    return builder.model(
        "clothes rack", "round rack", "garment rack", main=CHROME, attributes=("round",)
    )


def mannequin(rng: RandomStream, palette: Palette) -> Model:
    """A dressed figure without a face, on a plate."""
    builder = ModelBuilder()
    skin = plastic(rng.choice(("white", "cream", "black", "light gray")))
    top, low = _cloth(rng), _cloth(rng)
    builder.add(CHROME, cylinder(0.19, 0.02, sides=24, bevel=0.005))
    builder.add(CHROME, rod((0, -0.05, 0.02), (0, -0.05, 0.8), 0.012, sides=6))
    skirt = rng.chance(0.5)
    for s in (-1.0, 1.0):
        builder.add(
            skin, rod((s * 0.09, 0, 0.03), (s * 0.08, 0, 0.85), 0.045, end_radius=0.07, sides=10)
        )
    if skirt:
        builder.add(
            low, lathe([(0.24, 0.45), (0.2, 0.75), (0.14, 0.98), (0.0, 0.99)], crease_deg=80)
        )
    else:
        for s in (-1.0, 1.0):
            builder.add(
                low, rod((s * 0.09, 0, 0.08), (s * 0.08, 0, 0.9), 0.065, end_radius=0.085, sides=10)
            )
        builder.add(low, ball(0.34, 0.24, 0.3, at=(0, 0, 0.92), sides=14))
    torso = lathe(
        [
            (0.13, 0.9),
            (0.12, 1.05),
            (0.16, 1.25),
            (0.19, 1.38),
            (0.1, 1.47),
            (0.05, 1.49),
            (0.0, 1.5),
        ],
        sides=16,
        crease_deg=80,
    )
    builder.add(top, torso.scaled(1.0, 0.68, 1.0))
    for s in (-1.0, 1.0):
        builder.add(
            top, rod((s * 0.25, 0.02, 1.1), (s * 0.17, 0, 1.4), 0.045, end_radius=0.055, sides=8)
        )
        builder.add(
            skin,
            rod((s * 0.24, 0.08, 0.86), (s * 0.25, 0.02, 1.1), 0.03, end_radius=0.036, sides=8),
        )
    builder.add(skin, cylinder(0.045, 0.1, at=(0, 0, 1.47), sides=10))
    builder.add(skin, ball(0.17, 0.2, 0.25, at=(0, 0.01, 1.66), sides=14))
    del palette
    return builder.model("mannequin", "dress form", "dummy", main=skin)


def shoe_display(rng: RandomStream, palette: Palette) -> Model:
    """A stepped stand with shoes."""
    builder = ModelBuilder()
    body = wood(palette.wood) if rng.chance(0.6) else plastic("white")
    for y, z in ((0.24, 0.3), (-0.06, 0.6), (-0.36, 0.9)):
        builder.add(body, box(1.2, 0.3, z, at=(0, y, 0), bevel=0.004))
        for j in range(2):
            if rng.chance(0.9):
                for part in shoe_parts(rng, (j - 0.5) * 0.5 + rng.uniform(-0.1, 0.1), z):
                    builder.add(part.finish, part.mesh.moved(0, y, 0))
    return builder.model("shoe display", "shoe shelf", "shoe stand", main=body)
