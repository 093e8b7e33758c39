"""Models of machines of offices and other public buildings."""

from hypernav.houses.materials import (
    BLACK_GLASS,
    BLACK_METAL,
    STEEL,
    WHITE_METAL,
    Palette,
    image_finish,
    plastic,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, panel, tile
from hypernav.houses.modelling.surfaces import cylinder
from hypernav.houses.objects.repeated_images import repeated_image, repeated_panel
from hypernav.houses.random_stream import RandomStream

_WATER = Finish("", (0.55, 0.72, 0.86), 1.0, "blue", "plastic")
_LED = Finish("", (0.3, 0.95, 0.45), 1.0, unlit=True)


def copier(rng: RandomStream, palette: Palette) -> Model:
    """A floor-standing copier with paper trays, a scanner and a control panel."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "light gray")))
    dark = plastic("dark gray")
    builder.add(body, box(0.6, 0.6, 0.86, at=(0, 0, 0.06), bevel=0.008))
    builder.add(dark, box(0.56, 0.56, 0.06, at=(0, 0, 0)))
    for k in range(3):
        z = 0.1 + 0.17 * k
        builder.add(body.tinted(0.95), box(0.56, 0.02, 0.155, at=(0, 0.305, z), bevel=0.005))
        builder.add(dark, box(0.2, 0.012, 0.025, at=(0, 0.318, z + 0.1)))
    builder.add(dark, box(0.5, 0.02, 0.16, at=(-0.02, 0.296, 0.66)))
    builder.add(plastic("white"), tile(0.3, 0.21, at=(-0.02, 0.19, 0.921)))
    builder.add(body, box(0.6, 0.52, 0.16, at=(0, -0.04, 0.96), bevel=0.008))
    builder.add(dark, box(0.1, 0.56, 0.06, at=(-0.24, 0, 0.91)))
    builder.add(body.tinted(0.9), box(0.52, 0.42, 0.08, at=(-0.03, -0.06, 1.12), bevel=0.01))
    builder.add(dark, box(0.3, 0.16, 0.03, at=(0.14, 0.27, 0.99), bevel=0.006))
    builder.add(image_finish("screen desktop"), tile(0.16, 0.1, at=(0.1, 0.27, 1.0215)))
    return builder.model(
        "copier", "copy machine", "photocopier", "multifunction printer", main=body
    )


def water_dispenser(rng: RandomStream, palette: Palette) -> Model:
    """A cooler with a bottle of water on top, or with a tap from the mains."""
    del palette
    builder = ModelBuilder()
    body = WHITE_METAL if rng.chance(0.6) else plastic("dark gray")
    builder.add(body, box(0.32, 0.33, 0.98, at=(0, 0, 0), bevel=0.012))
    builder.add(plastic("black"), box(0.24, 0.02, 0.26, at=(0, 0.165, 0.62)))
    for s, hue in ((-1.0, "blue"), (1.0, "red")):
        builder.add(plastic(hue), cylinder(0.014, 0.05, at=(s * 0.05, 0.19, 0.82), sides=8))
    builder.add(STEEL, box(0.2, 0.07, 0.012, at=(0, 0.195, 0.62)))
    if rng.chance(0.7):
        builder.add(
            _WATER,
            cylinder(0.06, 0.05, at=(0, 0, 0.98), sides=16),
            cylinder(0.132, 0.3, at=(0, 0, 1.03), sides=20, bevel=0.03),
        )
    return builder.model("water dispenser", "water cooler", main=body)


def vending_machine(rng: RandomStream, palette: Palette) -> Model:
    """A tall machine with drinks and snacks behind glass."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("red", "blue", "dark gray", "black")))
    builder.add(body, box(0.86, 0.72, 1.82, at=(0, 0, 0.02), bevel=0.01))
    builder.add(BLACK_METAL, box(0.8, 0.66, 0.03, at=(0, 0, 0)))
    builder.add(plastic("black"), box(0.58, 0.012, 1.26, at=(-0.1, 0.362, 0.5)))
    for k in range(5):
        z = 0.54 + 0.24 * k
        shift = rng.unit()
        builder.add(
            repeated_image(f"goods {rng.integer(0, 5)}"),
            repeated_panel(0.54, 0.18, shift).moved(-0.1, 0.3695, z),
        )
        builder.add(STEEL, box(0.56, 0.008, 0.02, at=(-0.1, 0.37, z - 0.02)))
    builder.add(plastic("gray"), box(0.17, 0.02, 0.5, at=(0.31, 0.365, 0.9), bevel=0.004))
    builder.add(_LED, panel(0.1, 0.05, at=(0.31, 0.3765, 1.28)))
    builder.add(plastic("black"), box(0.56, 0.02, 0.2, at=(-0.1, 0.362, 0.22)))
    return builder.model("vending machine", "snack machine", "drinks machine", main=body)


def server_rack(rng: RandomStream, palette: Palette) -> Model:
    """A black cabinet with computers and lights behind a glass door."""
    del palette
    builder = ModelBuilder()
    builder.add(BLACK_METAL, box(0.6, 0.78, 1.95, at=(0, -0.01, 0.02), bevel=0.006))
    builder.add(BLACK_METAL, box(0.54, 0.7, 0.03, at=(0, -0.01, 0)))
    builder.add(BLACK_GLASS, box(0.52, 0.012, 1.8, at=(0, 0.386, 0.08)))
    for k in range(14):
        z = 0.14 + 0.122 * k
        if rng.chance(0.85):
            builder.add(plastic("dark gray"), box(0.46, 0.01, 0.085, at=(0, 0.394, z)))
            for j in range(3):
                builder.add(_LED, panel(0.02, 0.012, at=(0.1 + 0.045 * j, 0.4, z + 0.035)))
    builder.add(STEEL, box(0.02, 0.03, 0.16, at=(0.27, 0.395, 0.95)))
    return builder.model("server rack", "server cabinet", "rack", main=BLACK_METAL)


def paper_shredder(rng: RandomStream, palette: Palette) -> Model:
    """A bin for paper with a cutting head."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "dark gray", "white")))
    builder.add(body, box(0.36, 0.27, 0.44, at=(0, 0, 0.01), bevel=0.012))
    builder.add(plastic("gray"), box(0.38, 0.29, 0.14, at=(0, 0, 0.44), bevel=0.015))
    builder.add(plastic("black"), box(0.26, 0.02, 0.006, at=(0, 0, 0.579)))
    builder.add(_LED, tile(0.012, 0.012, at=(0.14, 0.08, 0.581)))
    return builder.model("paper shredder", "shredder", main=body)


def projector(rng: RandomStream, palette: Palette) -> Model:
    """A projector under the ceiling, hanging from z = 0, its lens to the front."""
    del palette
    builder = ModelBuilder()
    body = WHITE_METAL if rng.chance(0.7) else BLACK_METAL
    builder.add(WHITE_METAL, cylinder(0.025, 0.26, at=(0, 0, -0.26), sides=10))
    builder.add(body, box(0.34, 0.28, 0.11, at=(0, 0, -0.37), bevel=0.012))
    lens = cylinder(0.04, 0.03, sides=16).turned(-90, "x")
    builder.add(BLACK_GLASS, lens.moved(0.07, 0.138, -0.315))
    return builder.model("projector", "video projector", "beamer", main=body)


def light_panel(rng: RandomStream, palette: Palette) -> Model:
    """A flat lamp under the ceiling, hanging from z = 0."""
    del palette
    builder = ModelBuilder()
    wide, deep = rng.choice(((0.6, 0.6), (1.2, 0.3)))
    glow = Finish("", (1.0, 1.0, 0.98), 1.0, "white", "glass", unlit=True)
    builder.add(WHITE_METAL, box(wide, deep, 0.04, at=(0, 0, -0.04)))
    builder.add(glow, box(wide - 0.04, deep - 0.04, 0.006, at=(0, 0, -0.044)))
    return builder.model("ceiling lamp", "ceiling light", "light panel", "lamp", main=WHITE_METAL)


def desk_computer(rng: RandomStream, palette: Palette) -> Model:
    """A computer in a box beside or under a desk."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "dark gray", "white")))
    builder.add(body, box(0.19, 0.42, 0.4, at=(0, 0, 0.01), bevel=0.006))
    builder.add(plastic("gray"), box(0.15, 0.012, 0.1, at=(0, 0.212, 0.27)))
    builder.add(_LED, panel(0.012, 0.012, at=(0.05, 0.2185, 0.22)))
    return builder.model(
        "desktop computer",
        "computer",
        "computer tower",
        main=body,
        supports=(SupportSurface(-0.08, -0.18, 0.08, 0.18, 0.41, 0.3),),
    )
