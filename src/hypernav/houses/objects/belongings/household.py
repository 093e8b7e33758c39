"""Models of bins, brushes, bottles and baskets."""

from hypernav.houses.materials import (
    BLACK_METAL,
    CERAMIC,
    CHROME,
    GLASS,
    HUES,
    STEEL,
    Palette,
    image_finish,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, panel, tile
from hypernav.houses.modelling.surfaces import ball, cylinder, lathe
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.objects.kitchen_and_bathroom.tableware import glazed
from hypernav.houses.random_stream import RandomStream


def basket(rng: RandomStream, palette: Palette) -> Model:
    """A wicker basket with a blanket."""
    builder = ModelBuilder()
    cane = Finish("wicker", (0.76, 0.6, 0.4), 0.2, "light brown", "wicker")
    radius = rng.uniform(0.18, 0.24)
    builder.add(
        cane,
        lathe(
            [
                (0, 0),
                (radius * 0.85, 0),
                (radius, 0.2),
                (radius * 0.97, 0.34),
                (radius * 0.92, 0.34),
                (radius * 0.9, 0.1),
            ],
            sides=24,
            crease_deg=60,
        ),
    )
    builder.add(
        Finish("terry", HUES[palette.accent_hue], 0.25, palette.accent_hue, "fabric"),
        ball(radius * 1.7, radius * 1.7, 0.2, at=(0, 0, 0.28), sides=14),
    )
    return builder.model("basket", "storage basket", main=cane)


def trash_can(rng: RandomStream, palette: Palette) -> Model:
    """A waste bin with a lid or a swing top."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, plastic("white"), plastic("black"), plastic(palette.accent_hue)))
    high = rng.uniform(0.35, 0.62)
    radius = 0.13 + high * 0.06
    builder.add(body, lathe([(0, 0), (radius * 0.9, 0), (radius, high)], sides=24))
    if rng.chance(0.6):
        builder.add(
            body.tinted(0.8),
            lathe(
                [
                    (radius * 1.03, high - 0.02),
                    (radius * 1.03, high + 0.02),
                    (radius * 0.7, high + 0.06),
                    (0, high + 0.07),
                ],
                sides=24,
                crease_deg=60,
            ),
        )
        builder.add(BLACK_METAL, box(0.1, 0.05, 0.02, at=(0, radius + 0.02, 0.01)))
    else:
        builder.add(
            plastic("white"),
            lathe(
                [
                    (radius * 1.01, high - 0.06),
                    (radius * 1.05, high + 0.006),
                    (radius * 0.9, high - 0.05),
                ],
                sides=20,
            ),
        )
        builder.add(plastic("dark gray"), cylinder(radius * 0.9, 0.01, at=(0, 0, high * 0.7)))
    return builder.model("trash can", "waste bin", "garbage can", main=body)


def soap_dispenser(rng: RandomStream, palette: Palette) -> Model:
    """A pump bottle."""
    builder = ModelBuilder()
    body = glazed(rng.choice(("white", palette.accent_hue, "teal")))
    builder.add(
        body,
        lathe(
            [(0, 0), (0.035, 0), (0.036, 0.11), (0.014, 0.13), (0, 0.13)], sides=18, crease_deg=50
        ),
    )
    builder.add(
        CHROME,
        rod((0, 0, 0.13), (0, 0, 0.165), 0.006, sides=6),
        rod((0, 0, 0.163), (0, 0.045, 0.158), 0.006, sides=6),
    )
    return builder.model("soap dispenser", "soap bottle", main=body)


def toothbrush_cup(rng: RandomStream, palette: Palette) -> Model:
    """A tumbler with toothbrushes."""
    builder = ModelBuilder()
    body = glazed(rng.choice(("white", palette.accent_hue)))
    builder.add(
        body, lathe([(0, 0), (0.032, 0), (0.038, 0.1), (0.034, 0.1), (0.03, 0.01)], sides=16)
    )
    for k, hue in enumerate(("blue", "red")):
        builder.add(
            plastic(hue),
            rod((0.01 - 0.02 * k, 0, 0.01), (0.025 - 0.05 * k, 0.01, 0.19), 0.005, sides=6),
        )
    return builder.model("toothbrush", "toothbrush cup", main=body)


def detergent(rng: RandomStream, palette: Palette) -> Model:
    """A bottle of washing liquid."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("blue", "orange", "white", "green", "purple")))
    builder.add(body, cushion(0.17, 0.09, 0.24, radius=0.03))
    builder.add(image_finish(f"label {rng.integer(0, 7)}"), panel(0.12, 0.13, at=(0, 0.0455, 0.05)))
    builder.add(plastic("white"), cylinder(0.03, 0.05, at=(0.03, 0, 0.235), sides=14))
    return builder.model("detergent", "laundry detergent", main=body)


def toilet_brush(rng: RandomStream, palette: Palette) -> Model:
    """A brush in its holder."""
    del palette
    builder = ModelBuilder()
    body = rng.choice((CERAMIC, STEEL, plastic("white")))
    builder.add(body, lathe([(0, 0), (0.05, 0), (0.055, 0.14), (0.04, 0.15)], sides=18))
    builder.add(
        CHROME,
        rod((0, 0, 0.1), (0, 0, 0.4), 0.007, sides=6),
        ball(0.022, 0.022, 0.03, at=(0, 0, 0.41), sides=8),
    )
    return builder.model("toilet brush", main=body)


def scale(rng: RandomStream, palette: Palette) -> Model:
    """Bathroom scales."""
    del palette
    builder = ModelBuilder()
    body = rng.choice((GLASS, plastic("black"), plastic("white")))
    builder.add(body, cushion(0.3, 0.3, 0.035, radius=0.014))
    builder.add(plastic("dark gray"), tile(0.09, 0.04, at=(0, 0.1, 0.0355)))
    return builder.model("bathroom scale", "scale", main=body)


def bucket(rng: RandomStream, palette: Palette) -> Model:
    """A bucket with a handle."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("blue", "red", "green", palette.accent_hue)))
    builder.add(
        body,
        lathe(
            [(0, 0), (0.11, 0), (0.145, 0.27), (0.152, 0.28), (0.14, 0.27), (0.1, 0.01)], sides=24
        ),
    )
    builder.add(
        CHROME,
        tube(
            [
                (-0.145, 0, 0.26),
                (-0.12, 0.09, 0.34),
                (0, 0.13, 0.37),
                (0.12, 0.09, 0.34),
                (0.145, 0, 0.26),
            ],
            0.004,
            sides=5,
        ),
    )
    return builder.model("bucket", main=body)


def broom(rng: RandomStream, palette: Palette) -> Model:
    """A broom, upright."""
    builder = ModelBuilder()
    builder.add(wood("beech"), rod((0, 0, 0.14), (0, 0, 1.3), 0.012))
    builder.add(
        plastic(rng.choice(("red", "blue", palette.accent_hue))),
        box(0.3, 0.06, 0.05, at=(0, 0, 0.11), bevel=0.01),
    )
    builder.add(Finish("pile", (0.8, 0.7, 0.45), 0.2), box(0.3, 0.07, 0.11))
    return builder.model("broom", main=wood("beech"))
