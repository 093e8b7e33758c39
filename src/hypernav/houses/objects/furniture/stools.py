"""Models of seats without a back."""

import math

from hypernav.houses.materials import Palette, fabric, lacquer, leather
from hypernav.houses.modelling.joinery import four_legs
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, prism
from hypernav.houses.modelling.surfaces import cylinder, rounded_outline
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream


def stool(rng: RandomStream, palette: Palette) -> Model:
    """A low stool with three or four legs and a round seat."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    high, radius = 0.45, rng.uniform(0.15, 0.18)
    seat = fabric(palette.upholstery_hue) if rng.chance(0.4) else frame
    builder.add(seat, cylinder(radius, 0.04, at=(0, 0, high - 0.04), sides=24, bevel=0.008))
    count = rng.integer(3, 4)
    for k in range(count):
        a = math.radians(360 / count * k + 45)
        c, s = math.cos(a), math.sin(a)
        builder.add(
            frame,
            rod(
                (c * radius, s * radius, 0),
                (c * radius * 0.62, s * radius * 0.62, high - 0.03),
                0.014,
                end_radius=0.018,
            ),
        )
    return builder.model("stool", main=seat, attributes=("round",))


def bench_seat(rng: RandomStream, palette: Palette) -> Model:
    """A long seat without a back."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    long = rng.uniform(0.95, 1.25, 0.05)
    if rng.chance(0.5):
        cloth = fabric(palette.upholstery_hue)
        builder.add(
            cloth, cushion(long, 0.38, 0.09, radius=0.03, puff=0.01, flats=3, at=(0, 0, 0.37))
        )
        builder.add(frame, box(long - 0.04, 0.34, 0.05, at=(0, 0, 0.325)))
        builder.add(frame, *four_legs(long - 0.1, 0.32, 0.33, thick=0.045))
        return builder.model("bench", "upholstered bench", main=cloth)
    builder.add(
        frame,
        *[box(long, 0.115, 0.03, at=(0, (k - 1) * 0.125, 0.42), bevel=0.005) for k in range(3)],
    )
    for s in (-1.0, 1.0):
        builder.add(
            frame, box(0.04, 0.34, 0.42, at=(s * (long / 2 - 0.12), 0, 0), bevel=0.004).swapped_uv()
        )
    builder.add(frame, box(long - 0.24, 0.03, 0.06, at=(0, 0, 0.2)))
    return builder.model("bench", "wooden bench", main=frame)


def ottoman(rng: RandomStream, palette: Palette) -> Model:
    """A padded footrest or pouf."""
    builder = ModelBuilder()
    cloth = leather(palette.upholstery_hue) if rng.chance(0.3) else fabric(palette.upholstery_hue)
    if rng.chance(0.5):
        builder.add(cloth, cylinder(0.25, 0.38, sides=28, bevel=0.05))
        return builder.model("ottoman", "pouf", "footstool", main=cloth, attributes=("round",))
    builder.add(cloth, cushion(0.6, 0.45, 0.32, radius=0.05, puff=0.015, flats=3, at=(0, 0, 0.08)))
    builder.add(palette.furniture_wood(rng), *four_legs(0.56, 0.41, 0.09, thick=0.04))
    return builder.model("ottoman", "footstool", main=cloth, attributes=("square",))


def step_stool(rng: RandomStream, palette: Palette) -> Model:
    """Two steps."""
    builder = ModelBuilder()
    frame = lacquer(palette.paint_hue) if rng.chance(0.5) else palette.furniture_wood(rng)
    outline = rounded_outline(0.4, 0.2, 0.02)
    for y, z in ((0.1, 0.21), (-0.1, 0.43)):
        builder.add(frame, prism(outline, 0.025, z=z).moved(0, y, 0))
        for s in (-1.0, 1.0):
            builder.add(frame, box(0.022, 0.16, z, at=(s * 0.17, y, 0)).swapped_uv())
    return builder.model("step stool", "step ladder", main=frame)
