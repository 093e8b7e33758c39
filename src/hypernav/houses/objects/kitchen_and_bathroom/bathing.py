"""Models of bathtubs and showers."""

from hypernav.houses.materials import CERAMIC, CHROME, GLASS, Palette
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, prism
from hypernav.houses.modelling.surfaces import cylinder, rounded_outline
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.objects.kitchen_and_bathroom.sanitary import _fan, _loft, tap
from hypernav.houses.random_stream import RandomStream

_INSIDE = Finish("", (0.86, 0.87, 0.87))


def bathtub(rng: RandomStream, palette: Palette) -> Model:
    """A tub along a wall, 1.5 to 1.7 m."""
    del palette
    builder = ModelBuilder()
    long, deep, high = rng.choice((1.5, 1.6, 1.7)), 0.72, 0.56

    def ring(x: float, y: float, r: float, z: float) -> list[list[float]]:
        points = [[px, py, z] for px, py in rounded_outline(x, y, r, 5)]
        return [*points, list(points[0])]

    inside = [
        ring(long - 0.14, deep - 0.14, 0.2, high + 0.002),
        ring(long - 0.18, deep - 0.18, 0.2, high - 0.03),
        ring(long - 0.34, deep - 0.26, 0.18, 0.2),
        ring(long - 0.5, deep - 0.36, 0.14, 0.14),
    ]
    outside = [
        ring(long, deep, 0.03, 0.0),
        ring(long, deep, 0.03, high - 0.05),
        ring(long, deep, 0.03, high - 0.01),
        ring(long - 0.02, deep - 0.02, 0.03, high),
        ring(long - 0.14, deep - 0.14, 0.2, high + 0.002),
    ]
    builder.add(CERAMIC, _loft(outside))
    builder.add(_INSIDE, _loft(inside), _fan(ring(long - 0.5, deep - 0.36, 0.14, 0.14)))
    end = -long / 2 + 0.05
    builder.add(
        CHROME,
        tap(0.15, 0.13).turned(-90).moved(end, 0, high),
        cylinder(0.022, 0.003, at=(-long / 2 + 0.4, 0, 0.141)),
    )
    return builder.model("bathtub", "tub", "bath", main=CERAMIC)


def shower(rng: RandomStream, palette: Palette) -> Model:
    """A glass cabin on a tray, for a corner: its back is -y, its closed side -x."""
    del rng, palette
    builder = ModelBuilder()
    side, high = 0.9, 2.0
    builder.add(CERAMIC, prism(rounded_outline(side, side, 0.03), 0.06))
    builder.add(_INSIDE, prism(rounded_outline(side - 0.12, side - 0.12, 0.05), 0.004, z=0.058))
    builder.add(CHROME, cylinder(0.05, 0.004, at=(0, 0, 0.062)))
    h = side / 2 - 0.02
    for x, y in ((h, h), (-h, h), (h, -h), (0.0, h)):
        builder.add(CHROME, box(0.025, 0.025, high - 0.06, at=(x, y, 0.06)))
    for z in (0.06, high - 0.03):
        builder.add(
            CHROME,
            box(side - 0.02, 0.025, 0.03, at=(0, h, z)),
            box(0.025, side - 0.02, 0.03, at=(h, 0, z)),
        )
    for z in (0.45, 0.9, 1.35):
        builder.add(GLASS, box(side / 2 - 0.06, 0.006, 0.22, at=(-side / 4, h, z)))
    builder.add(
        CHROME,
        rod((-0.0, -h + 0.02, 1.0), (0.0, -h + 0.02, 1.95), 0.011),
        cylinder(0.09, 0.012, at=(0, -h + 0.24, 1.93), sides=24),
        rod((0, -h + 0.02, 1.95), (0, -h + 0.24, 1.95), 0.009),
        box(0.18, 0.05, 0.04, at=(0, -h + 0.02, 1.0), bevel=0.01),
        tube(
            [
                (0.02, -h + 0.06, 1.0),
                (0.08, -h + 0.05, 0.7),
                (0.1, -h + 0.04, 1.2),
                (0.03, -h + 0.03, 1.5),
            ],
            0.007,
            sides=6,
        ),
    )
    return builder.model("shower", "shower cabin", "shower stall", main=GLASS)
