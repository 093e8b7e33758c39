"""Models of bicycles, fitness machines and balls."""

import math

from hypernav.simulator.houses.modelling.curves import ball, cylinder, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CHROME,
    HUES,
    RUBBER,
    STEEL,
    Palette,
    image_finish,
    plastic,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion, panel
from hypernav.simulator.houses.random_stream import RandomStream


def bicycle(rng: RandomStream, palette: Palette) -> Model:
    """A bicycle on its stand, standing along x."""
    builder = ModelBuilder()
    paint = Finish(
        "",
        HUES[rng.choice(("red", "blue", "black", "teal", "green", palette.accent_hue))],
        1.0,
        "",
        "metal",
    )
    radius, base = 0.33, 0.52
    for x in (-base, base):
        ring = [
            (x + radius * math.cos(a), 0, radius + 0.012 + radius * math.sin(a))
            for a in (2 * math.pi * k / 28 for k in range(28))
        ]
        builder.add(RUBBER, tube(ring, 0.016, sides=7, closed=True))
        builder.add(
            CHROME,
            *[
                rod(
                    (x, 0, radius + 0.012),
                    (x + 0.31 * math.cos(a), 0, radius + 0.012 + 0.31 * math.sin(a)),
                    0.0018,
                    sides=4,
                )
                for a in (2 * math.pi * k / 14 for k in range(14))
            ],
            cylinder(0.022, 0.08).turned(90, "x").moved(x, 0.04, radius + 0.012),
        )
    rear, front = (-base, 0, 0.342), (base, 0, 0.342)
    crank, seat, head = (-0.06, 0, 0.31), (-0.2, 0, 0.78), (0.36, 0, 0.8)
    for a, b, r in (
        (crank, seat, 0.017),
        (crank, head, 0.019),
        (seat, head, 0.017),
        (rear, crank, 0.011),
        (rear, seat, 0.01),
        (head, (0.33, 0, 0.9), 0.017),
    ):
        builder.add(paint, rod(a, b, r))
    for y in (-0.045, 0.045):
        builder.add(
            paint, tube([(0.37, y * 0.4, 0.76), (0.4, y, 0.68), (front[0], y, front[2])], 0.011)
        )
    builder.add(
        CHROME,
        rod(seat, (-0.235, 0, 0.9), 0.013),
        rod((0.33, 0, 0.9), (0.31, 0, 1.0), 0.014),
        rod((-0.06, -0.08, 0.31), (-0.06, 0.08, 0.31), 0.012),
    )
    builder.add(
        BLACK_METAL,
        cushion(0.27, 0.15, 0.06, radius=0.028, at=(-0.25, 0, 0.9)),
        cylinder(0.09, 0.006, sides=24).turned(90, "x").moved(-0.06, 0.05, 0.31),
    )
    part = tube(
        [(0.22, -0.28, 1.0), (0.32, -0.12, 1.02), (0.32, 0.12, 1.02), (0.22, 0.28, 1.0)], 0.013
    )
    builder.add(BLACK_METAL, part)
    for s in (-1.0, 1.0):
        builder.add(
            CHROME,
            rod((-0.06, s * 0.09, 0.31), (-0.06 + s * 0.12, s * 0.09, 0.31 - s * 0.1), 0.009),
        )
        builder.add(
            BLACK_METAL, box(0.09, 0.07, 0.02, at=(-0.06 + s * 0.13, s * 0.12, 0.3 - s * 0.1))
        )
    builder.add(BLACK_METAL, rod((-0.2, -0.02, 0.3), (-0.18, -0.17, 0.0), 0.008))
    return builder.model("bicycle", "bike", main=paint)


def treadmill(rng: RandomStream, palette: Palette) -> Model:
    """A running machine; its user faces -y."""
    builder = ModelBuilder()
    builder.add(plastic("dark gray"), box(0.74, 1.5, 0.14, bevel=0.02))
    builder.add(RUBBER, box(0.48, 1.36, 0.012, at=(0, 0.06, 0.14)))
    for s in (-1.0, 1.0):
        builder.add(STEEL, box(0.07, 1.4, 0.03, at=(s * 0.31, 0.04, 0.14), bevel=0.008))
        builder.add(
            BLACK_METAL,
            tube([(s * 0.34, -0.6, 0.1), (s * 0.33, -0.62, 1.1), (s * 0.33, -0.55, 1.2)], 0.03),
            tube([(s * 0.33, -0.58, 1.0), (s * 0.33, -0.1, 0.95)], 0.022),
        )
    builder.add(
        BLACK_METAL, cushion(0.72, 0.12, 0.32, radius=0.04).turned(20, "x").moved(0, -0.6, 1.08)
    )
    builder.add(
        image_finish("screen desktop", unlit=True),
        panel(0.34, 0.16, at=(0, 0.061, 0.1)).turned(20, "x").moved(0, -0.6, 1.08),
    )
    return builder.model(
        "exercise equipment", "treadmill", "running machine", main=plastic("dark gray")
    )


def exercise_bike(rng: RandomStream, palette: Palette) -> Model:
    """A stationary bicycle."""
    builder = ModelBuilder()
    paint = Finish(
        "", HUES[rng.choice(("red", "black", "white", palette.accent_hue))], 1.0, "", "metal"
    )
    for y in (-0.42, 0.42):
        builder.add(BLACK_METAL, rod((-0.25, y, 0.03), (0.25, y, 0.03), 0.03))
    builder.add(
        paint,
        rod((0, -0.42, 0.05), (0, 0.42, 0.05), 0.03),
        rod((0, 0.1, 0.05), (0, 0.3, 0.85), 0.035),
        rod((0, -0.3, 0.06), (0, -0.42, 0.95), 0.03),
    )
    builder.add(STEEL, cylinder(0.23, 0.05, sides=32).turned(90, "y").moved(-0.025, -0.25, 0.36))
    builder.add(
        BLACK_METAL,
        cushion(0.24, 0.27, 0.08, radius=0.035, at=(0, 0.3, 0.85)),
        tube(
            [(-0.22, -0.25, 1.12), (-0.2, -0.42, 1.05), (0.2, -0.42, 1.05), (0.22, -0.25, 1.12)],
            0.016,
        ),
        box(0.16, 0.03, 0.11, at=(0, -0.47, 1.06)),
    )
    for s in (-1.0, 1.0):
        builder.add(
            BLACK_METAL,
            box(0.1, 0.09, 0.025, at=(s * 0.16, -0.02 + s * 0.1, 0.3 - s * 0.08)),
            rod((s * 0.05, -0.02, 0.3), (s * 0.14, -0.02 + s * 0.1, 0.31 - s * 0.08), 0.012),
        )
    return builder.model("exercise equipment", "exercise bike", "stationary bike", main=paint)


def dumbbells(rng: RandomStream, palette: Palette) -> Model:
    """A pair of dumbbells."""
    builder = ModelBuilder()
    ink = plastic(rng.choice(("black", "blue", palette.accent_hue)))
    for y in (-0.09, 0.09):
        builder.add(CHROME, rod((-0.1, y, 0.06), (0.1, y, 0.06), 0.014))
        for s in (-1.0, 1.0):
            builder.add(
                ink,
                cylinder(0.06, 0.07, sides=8, bevel=0.008)
                .turned(90, "y")
                .moved(s * 0.11 - 0.035, y, 0.06),
            )
    return builder.model("dumbbell", "dumbbells", "weights", main=ink)


def exercise_ball(rng: RandomStream, palette: Palette) -> Model:
    """A large gymnastics ball."""
    builder = ModelBuilder()
    ink = plastic(rng.choice(("blue", "pink", "gray", palette.accent_hue)))
    builder.add(ink, ball(0.6, 0.6, 0.58, at=(0, 0, 0.29), sides=28))
    return builder.model("exercise ball", "gym ball", "ball", main=ink)


def football(rng: RandomStream, palette: Palette) -> Model:
    """A ball to play with."""
    builder = ModelBuilder()
    ink = rng.choice(
        (Finish("", (0.85, 0.45, 0.15), 1.0, "orange", "rubber"), plastic("white"), plastic("red"))
    )
    builder.add(ink, ball(0.23, 0.23, 0.23, at=(0, 0, 0.115), sides=20))
    return builder.model(
        "ball", "basketball" if ink.hue == "orange" else "football", "sports ball", main=ink
    )


def skateboard(rng: RandomStream, palette: Palette) -> Model:
    """A skateboard."""
    builder = ModelBuilder()
    builder.add(
        plastic(rng.choice(("red", "black", palette.accent_hue))),
        cushion(0.78, 0.2, 0.02, radius=0.009, at=(0, 0, 0.09)),
    )
    for x in (-0.24, 0.24):
        builder.add(STEEL, box(0.05, 0.14, 0.03, at=(x, 0, 0.06)))
        for y in (-0.08, 0.08):
            builder.add(
                plastic("white"),
                cylinder(0.027, 0.035, sides=14).turned(90, "x").moved(x, y + 0.0175, 0.03),
            )
    return builder.model("skateboard", main=plastic("red"))
