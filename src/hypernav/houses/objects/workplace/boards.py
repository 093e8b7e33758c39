"""Models of boards and screens on the walls of public buildings."""

from hypernav.houses.materials import STEEL, WHITE_METAL, Palette, image_finish, wood
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, panel
from hypernav.houses.modelling.surfaces import cylinder
from hypernav.houses.random_stream import RandomStream

_CORK = Finish("cardboard", (0.74, 0.55, 0.36), 0.5, "brown", "cork")


def whiteboard(rng: RandomStream, palette: Palette) -> Model:
    """A white board with writing and a tray for pens; its back is the wall."""
    del palette
    builder = ModelBuilder()
    wide, high = rng.choice(((1.2, 0.9), (1.5, 1.0), (1.8, 1.0), (2.0, 1.1)))
    builder.add(STEEL, box(wide, 0.02, high, at=(0, 0, 0), bevel=0.004))
    key = f"whiteboard {rng.integer(0, 5)}"
    builder.add(image_finish(key), panel(wide - 0.04, high - 0.04, at=(0, 0.0115, 0.02)))
    builder.add(STEEL, box(wide * 0.5, 0.06, 0.015, at=(0, 0.03, 0.0)))
    for k, color in enumerate(((0.1, 0.15, 0.5), (0.7, 0.1, 0.1), (0.08, 0.08, 0.08))):
        pen = cylinder(0.009, 0.12, sides=6).turned(90, "y").moved(-0.15 + 0.15 * k, 0.035, 0.024)
        builder.add(Finish("", color), pen)
    return builder.model("whiteboard", "white board", "dry erase board", "board", main=WHITE_METAL)


def notice_board(rng: RandomStream, palette: Palette) -> Model:
    """A cork board with sheets of paper; its back is the wall."""
    builder = ModelBuilder()
    wide, high = rng.choice(((0.9, 0.6), (1.2, 0.9)))
    builder.add(wood(palette.secondary_wood), box(wide, 0.022, high, bevel=0.004))
    builder.add(_CORK, box(wide - 0.05, 0.01, high - 0.05, at=(0, 0.0085, 0.025)))
    for k in range(rng.integer(4, 7)):
        x = (k % 4 - 1.5) * wide * 0.22
        z = high * (0.52 if k < 4 else 0.1)
        sheet = Finish("", rng.choice(((0.96, 0.95, 0.92), (0.98, 0.93, 0.6), (0.75, 0.87, 0.95))))
        builder.add(sheet, panel(0.15, 0.2, at=(x, 0.0145, z)))
    return builder.model("notice board", "bulletin board", "pin board", "board", main=_CORK)


def projector_screen(rng: RandomStream, palette: Palette) -> Model:
    """A screen pulled out of its case; its back is the wall."""
    del palette
    builder = ModelBuilder()
    wide = rng.choice((1.6, 1.8, 2.0))
    high = wide * 0.62
    white = Finish("", (0.95, 0.95, 0.95), 1.0, "white", "fabric")
    builder.add(WHITE_METAL, box(wide + 0.12, 0.09, 0.09, at=(0, 0, high), bevel=0.01))
    builder.add(Finish("", (0.06, 0.06, 0.06)), box(wide, 0.006, high, at=(0, 0, 0.0)))
    builder.add(white, panel(wide - 0.1, high - 0.1, at=(0, 0.004, 0.05)))
    builder.add(STEEL, box(wide, 0.02, 0.02, at=(0, 0, 0)))
    return builder.model("projector screen", "projection screen", "screen", main=white)
