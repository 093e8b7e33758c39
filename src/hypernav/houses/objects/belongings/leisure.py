"""Models of musical instruments, an easel and a fireplace."""

import math

from hypernav.houses.materials import (
    BLACK_METAL,
    BRASS,
    CHROME,
    Palette,
    image_finish,
    lacquer,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, panel, prism
from hypernav.houses.modelling.surfaces import cylinder, lathe
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream


def piano(rng: RandomStream, palette: Palette) -> Model:
    """An upright piano; the player sits in front (+y)."""
    builder = ModelBuilder()
    body = rng.choice((lacquer("black"), wood("walnut"), wood("cherry"), lacquer("white")))
    wide = 1.46
    builder.add(
        body,
        box(wide, 0.3, 1.15, at=(0, -0.14, 0), bevel=0.008),
        box(wide + 0.03, 0.36, 0.03, at=(0, -0.13, 1.15), bevel=0.006),
        box(wide, 0.3, 0.09, at=(0, 0.12, 0.6), bevel=0.008),
        box(wide - 0.16, 0.02, 0.45, at=(0, 0.02, 0.1)),
    )
    for s in (-1.0, 1.0):
        builder.add(
            body,
            box(0.06, 0.3, 0.18, at=(s * (wide / 2 - 0.03), 0.12, 0.6), bevel=0.01),
            box(0.06, 0.07, 0.6, at=(s * (wide / 2 - 0.05), 0.22, 0), bevel=0.008),
        )
    keys = wide - 0.16
    builder.add(plastic("white"), box(keys, 0.14, 0.02, at=(0, 0.19, 0.69)))
    white = 52
    each = keys / white
    builder.add(
        plastic("gray"),
        *[
            box(0.0015, 0.141, 0.0205, at=((k + 1 - white / 2) * each, 0.19, 0.69))
            for k in range(white - 1)
        ],
    )
    black = [k for k in range(white - 1) if k % 7 in (0, 1, 3, 4, 5)]
    builder.add(
        plastic("black"),
        *[
            box(each * 0.55, 0.09, 0.016, at=((k + 1 - white / 2) * each, 0.165, 0.71))
            for k in black
        ],
    )
    builder.add(body, box(0.6, 0.015, 0.24, at=(0, 0.025, 0.82)).turned(0))
    builder.add(image_finish("label 0"), panel(0.3, 0.2, at=(0, 0.035, 0.84)))
    builder.add(BRASS, *[box(0.05, 0.1, 0.02, at=((k - 1) * 0.12, 0.1, 0.03)) for k in range(3)])
    del palette
    return builder.model(
        "piano",
        "upright piano",
        main=body,
        supports=(SupportSurface(-0.65, -0.26, 0.65, 0.0, 1.18),),
    )


def guitar(rng: RandomStream, palette: Palette) -> Model:
    """An acoustic guitar on its stand."""
    builder = ModelBuilder()
    body = wood(rng.choice(("pine", "cherry", "oak")))
    outline = []
    for k in range(36):
        a = 2 * math.pi * k / 36
        waist = 0.165 + 0.035 * math.cos(2 * a + math.pi) - 0.02 * math.sin(a)
        outline.append((waist * math.cos(a) * 1.05, 0.24 * math.sin(a)))
    shell = prism(outline, 0.1).turned(90, "x").moved(0, 0.05, 0.34)
    dark = wood("wenge")
    parts = [
        (body, shell),
        (dark, cylinder(0.045, 0.004, sides=20).turned(-90, "x").moved(0, 0.05, 0.42)),
        (dark, box(0.05, 0.025, 0.46, at=(0, 0.045, 0.56))),
        (dark, box(0.075, 0.02, 0.15, at=(0, 0.04, 1.0))),
        (dark, box(0.14, 0.015, 0.025, at=(0, 0.055, 0.24))),
    ]
    for finish, mesh in parts:
        builder.add(finish, mesh.turned(9, "x").moved(0, 0.02, 0))
    builder.add(
        CHROME,
        *[
            rod((x * 0.006, 0.065, 0.25), (x * 0.006, 0.062, 1.1), 0.0012, sides=4)
            .turned(9, "x")
            .moved(0, 0.02, 0)
            for x in (-2.5, -1.5, -0.5, 0.5, 1.5, 2.5)
        ],
    )
    for s in (-1.0, 1.0):
        builder.add(
            BLACK_METAL,
            rod((s * 0.17, 0.16, 0), (s * 0.06, -0.06, 0.35), 0.008),
            rod((s * 0.1, -0.02, 0.1), (s * 0.1, 0.14, 0.09), 0.008),
        )
    builder.add(
        BLACK_METAL,
        rod((0, -0.24, 0), (0, -0.06, 0.36), 0.008),
        rod((0, -0.06, 0.34), (0, -0.11, 0.85), 0.008),
    )
    del palette
    return builder.model("guitar", "acoustic guitar", main=body)


def fireplace(rng: RandomStream, palette: Palette) -> Model:
    """A fireplace with mantelpiece and a fire."""
    builder = ModelBuilder()
    stone = rng.choice(
        (
            Finish("bricks", (0.66, 0.33, 0.26), 0.8, "red", "brick"),
            Finish("marble", (0.93, 0.92, 0.9), 1.0, "white", "marble"),
            Finish("concrete", (0.6, 0.58, 0.55), 1.0, "gray", "stone"),
        )
    )
    wide, deep, high = 1.3, 0.35, 1.05
    for s in (-1.0, 1.0):
        builder.add(stone, box(0.27, deep, high, at=(s * (wide - 0.27) / 2, 0, 0)))
    builder.add(stone, box(wide - 0.54, deep, 0.32, at=(0, 0, high - 0.32)))
    builder.add(
        Finish("bricks", (0.16, 0.14, 0.13), 0.6),
        box(wide - 0.54, 0.03, high - 0.3, at=(0, -deep / 2 + 0.02, 0)),
    )
    builder.add(Finish("", (0.1, 0.09, 0.09)), box(wide - 0.5, deep + 0.0, 0.03, at=(0, 0, 0)))
    mantel = palette.furniture_wood(rng)
    builder.add(mantel, box(wide + 0.14, deep + 0.08, 0.06, at=(0, 0.02, high), bevel=0.012))
    for k in range(4):
        log = (
            cylinder(0.05, 0.42, sides=10)
            .turned(90, "y")
            .moved(-0.21, -0.02 + 0.05 * (k % 2), 0.09 + 0.07 * (k // 2))
        )
        builder.add(Finish("wood", (0.3, 0.2, 0.14), 0.3), log.turned(8 * (k - 1.5)))
    for k in range(7):
        flame = lathe([(0, 0.0), (0.045, 0.05), (0.03, 0.14), (0, 0.24)], sides=8, crease_deg=80)
        ink = ((1.0, 0.55, 0.1), (1.0, 0.78, 0.25))[k % 2]
        builder.add(
            Finish("", ink, unlit=True), flame.moved((k - 3) * 0.06, 0.02 * (k % 3 - 1), 0.15)
        )
    return builder.model(
        "fireplace",
        "hearth",
        main=stone,
        supports=(SupportSurface(-0.6, -0.12, 0.6, 0.16, high + 0.06),),
    )


def easel(rng: RandomStream, palette: Palette) -> Model:
    """An easel with a painting."""
    builder = ModelBuilder()
    frame = wood(palette.secondary_wood)
    for s in (-1.0, 1.0):
        builder.add(frame, rod((s * 0.32, 0.2, 0), (s * 0.04, -0.08, 1.6), 0.014))
    builder.add(
        frame,
        rod((0, -0.42, 0), (0, -0.08, 1.55), 0.014),
        box(0.6, 0.06, 0.025, at=(0, 0.09, 0.72)),
    )
    canvas = panel(0.62, 0.5).turned(10, "x").moved(0, 0.09, 0.75)
    builder.add(
        lacquer("white"),
        box(0.64, 0.02, 0.52, at=(0, -0.011, 0)).turned(10, "x").moved(0, 0.09, 0.745),
    )
    builder.add(image_finish(f"painting {rng.integer(0, 15)}"), canvas)
    return builder.model("easel", "painting easel", main=frame)
