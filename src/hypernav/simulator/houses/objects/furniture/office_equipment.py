"""Models of office furniture, machines and boards."""

from functools import partial

from hypernav.simulator.houses.modelling.curves import cylinder, rounded_outline
from hypernav.simulator.houses.modelling.joinery import four_legs, front
from hypernav.simulator.houses.modelling.materials import (
    BLACK_GLASS,
    BLACK_METAL,
    CHROME,
    STEEL,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    lacquer,
    plastic,
    repeated_image,
    repeated_panel,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder, SupportSurface
from hypernav.simulator.houses.modelling.solids import box, panel, prism, tile
from hypernav.simulator.houses.objects.furniture.tables import full_support
from hypernav.simulator.houses.random_stream import RandomStream

TABLE_M = 0.74

_WATER = Finish("", (0.55, 0.72, 0.86), 1.0, "blue", "plastic")
_LED = Finish("", (0.3, 0.95, 0.45), 1.0, unlit=True)

_CORK = Finish("cardboard", (0.74, 0.55, 0.36), 0.5, "brown", "cork")


def _table_top(rng: RandomStream, palette: Palette) -> Finish:
    return rng.weighted(
        ((lacquer("white"), 4.0), (wood(palette.wood), 3.0), (lacquer("light gray"), 2.0))
    )


def work_desk(rng: RandomStream, palette: Palette, wide: float = 1.6) -> Model:
    """A plain desk on a steel frame; its user sits in front (+y)."""
    builder = ModelBuilder()
    top = _table_top(rng, palette)
    frame = rng.choice((WHITE_METAL, BLACK_METAL, STEEL))
    deep = 0.8
    builder.add(top, box(wide, deep, 0.025, at=(0, 0, TABLE_M - 0.025), bevel=0.004))
    if rng.chance(0.5):
        builder.add(
            frame, *four_legs(wide - 0.06, deep - 0.08, TABLE_M - 0.025, thick=0.05, taper=1.0)
        )
    else:
        for s in (-1.0, 1.0):
            x = s * (wide / 2 - 0.2)
            builder.add(
                frame,
                box(0.08, deep - 0.1, 0.03, at=(x, 0, 0)),
                box(0.07, 0.1, TABLE_M - 0.055, at=(x, -0.06, 0.03)).swapped_uv(),
            )
    builder.add(frame, box(wide - 0.3, 0.03, 0.06, at=(0, -0.06, TABLE_M - 0.09)))
    builder.add(top.tinted(0.92), box(wide - 0.2, 0.016, 0.32, at=(0, -deep / 2 + 0.06, 0.37)))
    surface = full_support(wide, deep, TABLE_M, 0.9)
    return builder.model("desk", "office desk", "workstation", main=top, supports=(surface,))


def desk_screen(rng: RandomStream, palette: Palette, wide: float = 1.6) -> Model:
    """A cloth-covered screen that stands on the edge between two desks."""
    builder = ModelBuilder()
    cloth = fabric(rng.choice((palette.accent_hue, "gray", "dark gray", "light blue")))
    builder.add(cloth, box(wide - 0.1, 0.024, 0.36, at=(0, 0, 0.02), bevel=0.006))
    for s in (-1.0, 1.0):
        builder.add(STEEL, box(0.04, 0.03, 0.04, at=(s * wide * 0.35, 0, 0)))
    return builder.model("desk divider", "desk screen", "privacy screen", main=cloth)


def drawer_unit(rng: RandomStream, palette: Palette) -> Model:
    """Three drawers on castors, for under a desk."""
    builder = ModelBuilder()
    body = rng.choice((WHITE_METAL, plastic("light gray"), BLACK_METAL))
    builder.add(body, box(0.4, 0.5, 0.5, at=(0, 0, 0.05), bevel=0.004))
    for k in range(3):
        front(builder, body, STEEL, 0.39, 0.155, at=(0, 0.25, 0.07 + 0.16 * k), grip="bar")
    for x in (-0.15, 0.15):
        for y in (-0.2, 0.2):
            builder.add(BLACK_METAL, cylinder(0.02, 0.05, at=(x, y, 0), sides=8))
    surface = SupportSurface(-0.18, -0.22, 0.18, 0.22, 0.55)
    return builder.model(
        "drawer unit", "pedestal", "rolling drawers", main=body, supports=(surface,)
    )


def meeting_table(rng: RandomStream, palette: Palette, seats: int = 6) -> Model:
    """A long table for 4 to 12 people."""
    builder = ModelBuilder()
    long = {4: 1.4, 6: 1.9, 8: 2.4, 10: 2.6}.get(seats, 2.6)
    deep = 0.9 if seats <= 6 else 1.15
    top = _table_top(rng, palette)
    radius = rng.choice((0.02, 0.12, deep / 2 - 0.02))
    outline = rounded_outline(long, deep, radius, 6)
    builder.add(top, prism(outline, 0.032, z=TABLE_M - 0.032))
    metal = rng.choice((STEEL, BLACK_METAL, CHROME))
    for s in (-1.0, 1.0):
        x = s * (long / 2 - 0.45)
        builder.add(
            metal,
            box(0.09, deep * 0.6, 0.025, at=(x, 0, 0), bevel=0.006),
            box(0.06, 0.2, TABLE_M - 0.05, at=(x, 0, 0.02)).swapped_uv(),
        )
    builder.add(plastic("black"), box(0.24, 0.1, 0.006, at=(0, 0, TABLE_M)))
    support = SupportSurface(
        -long / 2 + 0.25, -deep / 2 + 0.08, long / 2 - 0.25, deep / 2 - 0.08, TABLE_M + 0.006
    )
    return builder.model(
        "meeting table", "conference table", "table", main=top, supports=(support,)
    )


def reception_desk(rng: RandomStream, palette: Palette) -> Model:
    """A counter with a raised front; visitors stand in front (+y)."""
    builder = ModelBuilder()
    body = rng.choice((lacquer("white"), lacquer("dark gray"), wood(palette.wood)))
    stone = rng.choice(
        (
            lacquer("white"),
            wood(palette.secondary_wood),
            Finish("marble", (0.8, 0.79, 0.77), 0.8, "white", "stone"),
        )
    )
    long = rng.choice((1.8, 2.1, 2.4))
    builder.add(body, box(long, 0.06, 1.06, at=(0, 0.34, 0), bevel=0.004))
    builder.add(stone, box(long + 0.06, 0.3, 0.04, at=(0, 0.27, 1.06), bevel=0.006))
    for s in (-1.0, 1.0):
        builder.add(body, box(0.04, 0.7, 0.74, at=(s * (long / 2 - 0.02), -0.02, 0)).swapped_uv())
    builder.add(stone, box(long - 0.08, 0.66, 0.03, at=(0, -0.02, 0.71)))
    accent = fabric(palette.accent_hue) if rng.chance(0.3) else plastic(palette.accent_hue)
    builder.add(accent, box(long - 0.3, 0.012, 0.12, at=(0, 0.374, 0.16)))
    surface = SupportSurface(-long / 2 + 0.1, -0.32, long / 2 - 0.1, 0.1, 0.74, 0.5)
    return builder.model(
        "reception desk",
        "front desk",
        "reception counter",
        "counter",
        main=body,
        supports=(surface,),
    )


def locker(rng: RandomStream, palette: Palette) -> Model:
    """Three or four narrow steel lockers side by side."""
    builder = ModelBuilder()
    steel = Finish(
        "",
        rng.choice(((0.6, 0.62, 0.63), (0.3, 0.4, 0.5), (0.82, 0.82, 0.8))),
        1.0,
        "gray",
        "metal",
    )
    count = rng.choice((3, 4))
    wide, high = 0.3 * count, 1.8
    door = plastic(palette.accent_hue) if rng.chance(0.3) else steel
    fit = partial(front, builder, door, BLACK_METAL)
    builder.add(steel, box(wide, 0.46, high, at=(0, -0.01, 0.02), bevel=0.003))
    builder.add(BLACK_METAL, box(wide - 0.04, 0.4, 0.03, at=(0, -0.01, 0)))
    for k in range(count):
        x = (k + 0.5 - count / 2) * 0.3
        fit(0.295, high - 0.1, at=(x, 0.22, 0.07), grip="knob", upright=True, side=1.0)
        for j in range(3):
            builder.add(BLACK_METAL, box(0.14, 0.004, 0.008, at=(x, 0.24, 1.55 + 0.04 * j)))
    return builder.model("locker", "lockers", "steel cabinet", main=steel, attributes=("tall",))


def copier(rng: RandomStream, palette: Palette) -> Model:
    """A floor-standing copier with paper trays, a scanner and a control panel."""
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
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "dark gray", "white")))
    builder.add(body, box(0.36, 0.27, 0.44, at=(0, 0, 0.01), bevel=0.012))
    builder.add(plastic("gray"), box(0.38, 0.29, 0.14, at=(0, 0, 0.44), bevel=0.015))
    builder.add(plastic("black"), box(0.26, 0.02, 0.006, at=(0, 0, 0.579)))
    builder.add(_LED, tile(0.012, 0.012, at=(0.14, 0.08, 0.581)))
    return builder.model("paper shredder", "shredder", main=body)


def projector(rng: RandomStream, palette: Palette) -> Model:
    """A projector under the ceiling, hanging from z = 0, its lens to the front."""
    builder = ModelBuilder()
    body = WHITE_METAL if rng.chance(0.7) else BLACK_METAL
    builder.add(WHITE_METAL, cylinder(0.025, 0.26, at=(0, 0, -0.26), sides=10))
    builder.add(body, box(0.34, 0.28, 0.11, at=(0, 0, -0.37), bevel=0.012))
    lens = cylinder(0.04, 0.03, sides=16).turned(-90, "x")
    builder.add(BLACK_GLASS, lens.moved(0.07, 0.138, -0.315))
    return builder.model("projector", "video projector", "beamer", main=body)


def light_panel(rng: RandomStream, palette: Palette) -> Model:
    """A flat lamp under the ceiling, hanging from z = 0."""
    builder = ModelBuilder()
    wide, deep = rng.choice(((0.6, 0.6), (1.2, 0.3)))
    glow = Finish("", (1.0, 1.0, 0.98), 1.0, "white", "glass", unlit=True)
    builder.add(WHITE_METAL, box(wide, deep, 0.04, at=(0, 0, -0.04)))
    builder.add(glow, box(wide - 0.04, deep - 0.04, 0.006, at=(0, 0, -0.044)))
    return builder.model("ceiling lamp", "ceiling light", "light panel", "lamp", main=WHITE_METAL)


def desk_computer(rng: RandomStream, palette: Palette) -> Model:
    """A computer in a box beside or under a desk."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "dark gray", "white")))
    builder.add(body, box(0.19, 0.42, 0.4, at=(0, 0, 0.01), bevel=0.006))
    builder.add(plastic("gray"), box(0.15, 0.012, 0.1, at=(0, 0.212, 0.27)))
    builder.add(_LED, panel(0.012, 0.012, at=(0.05, 0.2185, 0.22)))
    surface = SupportSurface(-0.08, -0.18, 0.08, 0.18, 0.41, 0.3)
    return builder.model(
        "desktop computer", "computer", "computer tower", main=body, supports=(surface,)
    )


def whiteboard(rng: RandomStream, palette: Palette) -> Model:
    """A white board with writing and a tray for pens; its back is the wall."""
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
    builder = ModelBuilder()
    wide = rng.choice((1.6, 1.8, 2.0))
    high = wide * 0.62
    white = Finish("", (0.95, 0.95, 0.95), 1.0, "white", "fabric")
    builder.add(WHITE_METAL, box(wide + 0.12, 0.09, 0.09, at=(0, 0, high), bevel=0.01))
    builder.add(Finish("", (0.06, 0.06, 0.06)), box(wide, 0.006, high, at=(0, 0, 0.0)))
    builder.add(white, panel(wide - 0.1, high - 0.1, at=(0, 0.004, 0.05)))
    builder.add(STEEL, box(wide, 0.02, 0.02, at=(0, 0, 0)))
    return builder.model("projector screen", "projection screen", "screen", main=white)
