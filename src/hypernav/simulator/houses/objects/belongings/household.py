"""Models of household things and of laundry equipment."""

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CERAMIC,
    CHROME,
    GLASS,
    HUES,
    STEEL,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    plastic,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder, SupportSurface
from hypernav.simulator.houses.modelling.solids import box, cushion, panel, tile
from hypernav.simulator.houses.objects.belongings.kitchenware import glazed
from hypernav.simulator.houses.random_stream import RandomStream


def basket(rng: RandomStream, palette: Palette) -> Model:
    """A wicker basket with a blanket."""
    builder = ModelBuilder()
    cane = Finish("wicker", (0.76, 0.6, 0.4), 0.2, "light brown", "wicker")
    radius = rng.uniform(0.18, 0.24)
    profile = [
        (0, 0),
        (radius * 0.85, 0),
        (radius, 0.2),
        (radius * 0.97, 0.34),
        (radius * 0.92, 0.34),
        (radius * 0.9, 0.1),
    ]
    part = lathe(profile, sides=24, crease_deg=60)
    builder.add(cane, part)
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
        profile = [
            (radius * 1.03, high - 0.02),
            (radius * 1.03, high + 0.02),
            (radius * 0.7, high + 0.06),
            (0, high + 0.07),
        ]
        part = lathe(profile, sides=24, crease_deg=60)
        builder.add(body.tinted(0.8), part)
        builder.add(BLACK_METAL, box(0.1, 0.05, 0.02, at=(0, radius + 0.02, 0.01)))
    else:
        profile = [
            (radius * 1.01, high - 0.06),
            (radius * 1.05, high + 0.006),
            (radius * 0.9, high - 0.05),
        ]
        part = lathe(profile, sides=20)
        builder.add(plastic("white"), part)
        builder.add(plastic("dark gray"), cylinder(radius * 0.9, 0.01, at=(0, 0, high * 0.7)))
    return builder.model("trash can", "waste bin", "garbage can", main=body)


def soap_dispenser(rng: RandomStream, palette: Palette) -> Model:
    """A pump bottle."""
    builder = ModelBuilder()
    body = glazed(rng.choice(("white", palette.accent_hue, "teal")))
    part = lathe(
        [(0, 0), (0.035, 0), (0.036, 0.11), (0.014, 0.13), (0, 0.13)], sides=18, crease_deg=50
    )
    builder.add(body, part)
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
    builder = ModelBuilder()
    body = plastic(rng.choice(("blue", "orange", "white", "green", "purple")))
    builder.add(body, cushion(0.17, 0.09, 0.24, radius=0.03))
    builder.add(image_finish(f"label {rng.integer(0, 7)}"), panel(0.12, 0.13, at=(0, 0.0455, 0.05)))
    builder.add(plastic("white"), cylinder(0.03, 0.05, at=(0.03, 0, 0.235), sides=14))
    return builder.model("detergent", "laundry detergent", main=body)


def toilet_brush(rng: RandomStream, palette: Palette) -> Model:
    """A brush in its holder."""
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
    builder = ModelBuilder()
    body = rng.choice((GLASS, plastic("black"), plastic("white")))
    builder.add(body, cushion(0.3, 0.3, 0.035, radius=0.014))
    builder.add(plastic("dark gray"), tile(0.09, 0.04, at=(0, 0.1, 0.0355)))
    return builder.model("bathroom scale", "scale", main=body)


def bucket(rng: RandomStream, palette: Palette) -> Model:
    """A bucket with a handle."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("blue", "red", "green", palette.accent_hue)))
    part = lathe(
        [(0, 0), (0.11, 0), (0.145, 0.27), (0.152, 0.28), (0.14, 0.27), (0.1, 0.01)], sides=24
    )
    builder.add(body, part)
    part = tube(
        [
            (-0.145, 0, 0.26),
            (-0.12, 0.09, 0.34),
            (0, 0.13, 0.37),
            (0.12, 0.09, 0.34),
            (0.145, 0, 0.26),
        ],
        0.004,
        sides=5,
    )
    builder.add(CHROME, part)
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


def washing_machine(rng: RandomStream, palette: Palette) -> Model:
    """A front loader with a glass door."""
    body = rng.weighted(((WHITE_METAL, 4.0), (STEEL, 1.0)))
    return _front_loader(
        body,
        glass=GLASS.tinted(0.45),
        drawer=True,
        names=("washing machine", "washer", "clothes washer"),
    )


def clothes_dryer(rng: RandomStream, palette: Palette) -> Model:
    """A tumble dryer with a solid door."""
    body = rng.weighted(((WHITE_METAL, 4.0), (STEEL, 1.0)))
    return _front_loader(
        body,
        glass=body.tinted(0.85),
        drawer=False,
        names=("clothes dryer", "tumble dryer", "dryer"),
    )


def _front_loader(body: Finish, glass: Finish, *, drawer: bool, names: tuple[str, ...]) -> Model:
    builder = ModelBuilder()
    wide, deep, high = 0.6, 0.58, 0.85
    y = deep / 2
    builder.add(body, box(wide, deep, high, bevel=0.012))
    builder.add(
        body.tinted(0.9), box(wide - 0.01, 0.012, 0.11, at=(0, y, high - 0.125), bevel=0.004)
    )
    dial = cylinder(0.035, 0.03, sides=20, top_radius=0.03, bevel=0.004).turned(-90, "x")
    builder.add(CHROME, dial.moved(0.04, y + 0.004, high - 0.07))
    builder.add(
        Finish("", (0.06, 0.07, 0.09)), box(0.13, 0.004, 0.04, at=(0.19, y + 0.006, high - 0.09))
    )
    if drawer:
        builder.add(
            body.tinted(0.82),
            box(0.17, 0.01, 0.08, at=(-0.19, y + 0.004, high - 0.11), bevel=0.004),
        )
    ring = lathe(
        [(0.215, 0.0), (0.21, 0.035), (0.185, 0.045), (0.155, 0.03)], sides=32, crease_deg=70
    ).turned(-90, "x")
    builder.add(CHROME if drawer else body.tinted(0.94), ring.moved(0, y - 0.002, 0.4))
    profile = [
        (0.158, 0.028),
        (0.12, 0.042 if not drawer else 0.01),
        (0.0, 0.05 if not drawer else -0.004),
    ]
    dome = lathe(profile, sides=32, crease_deg=80)
    builder.add(glass, dome.turned(-90, "x").moved(0, y - 0.002, 0.4))
    builder.add(plastic("gray"), box(0.035, 0.02, 0.1, at=(0.195, y + 0.035, 0.35), bevel=0.006))
    builder.add(plastic("dark gray"), box(wide - 0.06, 0.004, 0.05, at=(0, y, 0.02)))
    surface = SupportSurface(-0.26, -0.24, 0.26, 0.24, high, 0.5)
    return builder.model(names[0], *names[1:], main=body, supports=(surface,))


def iron(rng: RandomStream, palette: Palette) -> Model:
    """A clothes iron."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("blue", "white", palette.accent_hue)))
    builder.add(STEEL, cushion(0.11, 0.24, 0.02, radius=0.009))
    builder.add(body, cushion(0.1, 0.22, 0.06, radius=0.028, at=(0, 0, 0.015)))
    builder.add(
        body, tube([(0, -0.08, 0.07), (0, -0.07, 0.13), (0, 0.05, 0.13), (0, 0.07, 0.07)], 0.014)
    )
    return builder.model("iron", "clothes iron", main=body)


def sewing_machine(rng: RandomStream, palette: Palette) -> Model:
    """A sewing machine."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "black", palette.accent_hue)))
    builder.add(
        body,
        box(0.4, 0.18, 0.07, bevel=0.01),
        cushion(0.09, 0.13, 0.24, radius=0.03, at=(0.14, 0, 0.06)),
        cushion(0.36, 0.11, 0.09, radius=0.03, at=(0, 0, 0.22)),
        box(0.06, 0.08, 0.1, at=(-0.14, 0, 0.14), bevel=0.01),
    )
    builder.add(
        CHROME,
        rod((-0.14, 0, 0.07), (-0.14, 0, 0.15), 0.004, sides=6),
        cylinder(0.05, 0.02).turned(90, "y").moved(0.18, 0, 0.26),
    )
    return builder.model("sewing machine", main=body)


def laundry_basket(rng: RandomStream, palette: Palette) -> Model:
    """A hamper with clothes."""
    builder = ModelBuilder()
    body = rng.choice(
        (
            plastic("white"),
            plastic(palette.accent_hue),
            Finish("wicker", (0.76, 0.62, 0.42), 0.2, "light brown", "wicker"),
        )
    )
    part = lathe(
        [(0, 0), (0.18, 0), (0.23, 0.5), (0.235, 0.52), (0.22, 0.5), (0.17, 0.02)], sides=24
    ).scaled(1.15, 0.85, 1)
    builder.add(body, part)
    for k in range(5):
        cloth = fabric(rng.choice(("white", "blue", "red", "gray", "yellow", palette.linen_hue)))
        builder.add(
            cloth,
            ball(0.2, 0.16, 0.12, at=((k % 3 - 1) * 0.11, (k // 3 - 0.5) * 0.12, 0.5), sides=10),
        )
    return builder.model("laundry basket", "laundry hamper", "hamper", main=body)


def drying_rack(rng: RandomStream, palette: Palette) -> Model:
    """A folding clothes horse with laundry."""
    builder = ModelBuilder()
    for s in (-1.0, 1.0):
        builder.add(
            WHITE_METAL,
            rod((s * 0.55, -0.25, 0), (s * 0.55, 0.25, 0.95), 0.01),
            rod((s * 0.55, 0.25, 0), (s * 0.55, -0.25, 0.95), 0.01),
        )
    for k in range(7):
        y = -0.25 + k * 0.5 / 6
        builder.add(WHITE_METAL, rod((-0.55, y, 0.95), (0.55, y, 0.95), 0.005, sides=6))
    for k in range(4):
        cloth = fabric(
            rng.choice(("white", "blue", "gray", "pink", palette.linen_hue, palette.accent_hue))
        )
        wide, drop = rng.uniform(0.22, 0.34), rng.uniform(0.3, 0.55)
        x, y = -0.36 + 0.25 * k, rng.choice((-0.25, -0.083, 0.083, 0.25))
        builder.add(
            cloth,
            box(wide * 0.7, 0.012, drop, at=(x, y + 0.012, 0.957 - drop)),
            box(wide * 0.7, 0.012, drop * 0.7, at=(x, y - 0.012, 0.957 - drop * 0.7)),
        )
    return builder.model("drying rack", "clothes rack", "clothes horse", main=WHITE_METAL)


def ironing_board(rng: RandomStream, palette: Palette) -> Model:
    """An ironing board, open."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.linen_hue, "light blue", "gray")),
        rng.choice(("stripes", "floral", "fabric")),
        0.5,
    )
    builder.add(
        cloth,
        cushion(1.05, 0.34, 0.03, radius=0.013, at=(-0.1, 0, 0.86)),
        cylinder(0.165, 0.03, at=(0.42, 0, 0.86), sides=20),
    )
    for s in (-1.0, 1.0):
        builder.add(
            CHROME,
            rod((s * 0.45, -0.16, 0.0), (-s * 0.4, -0.05, 0.86), 0.011),
            rod((s * 0.45, 0.16, 0.0), (-s * 0.4, 0.05, 0.86), 0.011),
            rod((s * 0.45, -0.17, 0.012), (s * 0.45, 0.17, 0.012), 0.012),
        )
    return builder.model("ironing board", main=cloth)
