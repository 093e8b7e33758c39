"""Models of luggage, umbrellas, tools and other belongings."""

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod, tube
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    HUES,
    RUBBER,
    STEEL,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    leather,
    plastic,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion, panel
from hypernav.simulator.houses.objects.furniture.storage import shoe_parts
from hypernav.simulator.houses.random_stream import RandomStream


def suitcase(rng: RandomStream, palette: Palette) -> Model:
    """A trolley case, upright."""
    builder = ModelBuilder()
    body = plastic(
        rng.choice(("blue", "red", "black", "teal", "yellow", "gray", palette.accent_hue))
    )
    wide, deep, high = 0.42, 0.26, rng.uniform(0.58, 0.68)
    builder.add(body, cushion(wide, deep, high, radius=0.05, rounds=3, at=(0, 0, 0.05)))
    for k in range(6):
        x = (k - 2.5) * 0.06
        for s in (-1.0, 1.0):
            builder.add(
                body.tinted(0.8),
                box(0.014, 0.01, high - 0.16, at=(x, s * (deep / 2), 0.13), bevel=0.004),
            )
    builder.add(plastic("black"), box(wide + 0.004, 0.012, high - 0.06, at=(0, 0, 0.08)))
    for x in (-0.13, 0.13):
        builder.add(
            STEEL, rod((x * 0.6, -0.07, high + 0.04), (x * 0.6, -0.07, high + 0.32), 0.008, sides=6)
        )
        for y in (-0.08, 0.08):
            builder.add(
                RUBBER, cylinder(0.024, 0.03, sides=12).turned(90, "y").moved(x - 0.015, y, 0.026)
            )
    builder.add(
        plastic("black"),
        box(0.2, 0.035, 0.03, at=(0, -0.07, high + 0.31), bevel=0.008),
        tube(
            [
                (-0.07, 0.02, high + 0.045),
                (-0.06, 0.02, high + 0.08),
                (0.06, 0.02, high + 0.08),
                (0.07, 0.02, high + 0.045),
            ],
            0.01,
        ),
    )
    return builder.model("suitcase", "luggage", "trolley", main=body)


def backpack(rng: RandomStream, palette: Palette) -> Model:
    """A backpack, standing."""
    builder = ModelBuilder()
    cloth = fabric(rng.choice(("navy", "red", "black", "green", "gray", palette.accent_hue)))
    builder.add(
        cloth,
        cushion(0.31, 0.17, 0.44, radius=0.07, rounds=3, puff=0.02, flats=2),
        cushion(0.25, 0.08, 0.2, radius=0.035, at=(0, 0.105, 0.03)),
    )
    builder.add(
        cloth.tinted(0.7),
        box(0.22, 0.006, 0.008, at=(0, 0.146, 0.21)),
        tube([(-0.04, 0, 0.45), (-0.03, 0, 0.49), (0.03, 0, 0.49), (0.04, 0, 0.45)], 0.009),
    )
    for s in (-1.0, 1.0):
        part = tube(
            [
                (s * 0.08, -0.08, 0.4),
                (s * 0.1, -0.13, 0.33),
                (s * 0.11, -0.12, 0.15),
                (s * 0.13, -0.08, 0.04),
            ],
            0.014,
        )
        builder.add(cloth.tinted(0.6), part)
    return builder.model("backpack", "rucksack", "school bag", main=cloth)


def handbag(rng: RandomStream, palette: Palette) -> Model:
    """A handbag with two handles."""
    builder = ModelBuilder()
    hide = leather(rng.choice(("brown", "black", "red", palette.accent_hue)))
    builder.add(hide, cushion(0.33, 0.13, 0.23, radius=0.04))
    for y in (-0.05, 0.05):
        builder.add(
            hide.tinted(0.8),
            tube([(-0.09, y, 0.22), (-0.07, y, 0.34), (0.07, y, 0.34), (0.09, y, 0.22)], 0.008),
        )
    builder.add(Finish("", (0.8, 0.65, 0.3)), box(0.04, 0.01, 0.03, at=(0, 0.066, 0.15)))
    return builder.model("handbag", "purse", "bag", main=hide)


def umbrella(rng: RandomStream, palette: Palette) -> Model:
    """Closed umbrellas in a stand."""
    builder = ModelBuilder()
    metal = rng.choice((BLACK_METAL, STEEL))
    builder.add(metal, cylinder(0.11, 0.02, sides=20))
    for z in (0.25, 0.48):
        builder.add(
            metal, lathe([(0.1, z), (0.106, z), (0.106, z + 0.015), (0.1, z + 0.015)], sides=20)
        )
    for k in range(4):
        x, y = ((0.1, 0), (-0.1, 0), (0, 0.1), (0, -0.1))[k]
        builder.add(metal, rod((x, y, 0.01), (x, y, 0.49), 0.005, sides=6))
    hue = rng.choice(("red", "blue", "black", "yellow", palette.accent_hue))
    for k, ink in enumerate((hue, "black")):
        x = 0.04 - 0.08 * k
        cloth = Finish("fabric", HUES[ink], 0.3, ink, "fabric")
        part = lathe(
            [(0.006, 0.02), (0.02, 0.1), (0.035, 0.45), (0.03, 0.62), (0.008, 0.68)],
            sides=10,
            crease_deg=80,
        ).moved(x, 0, 0)
        builder.add(cloth, part)
        builder.add(
            wood("walnut"),
            rod((x, 0, 0.66), (x, 0, 0.8), 0.008),
            tube([(x, 0, 0.79), (x, 0.02, 0.84), (x, 0.06, 0.85), (x, 0.085, 0.81)], 0.011),
        )
        if rng.chance(0.5):
            break
    return builder.model("umbrella", "umbrella stand", attributes=(hue,))


def cardboard_boxes(rng: RandomStream, palette: Palette) -> Model:
    """A stack of moving boxes."""
    builder = ModelBuilder()
    card = Finish("cardboard", (0.74, 0.57, 0.38), 0.5, "brown", "cardboard")
    z = 0.0
    for k in range(rng.integer(1, 3)):
        wide, deep, high = 0.48 - 0.05 * k, 0.38 - 0.03 * k, rng.uniform(0.26, 0.36)
        builder.add(card, box(wide, deep, high, at=(0, 0, z), bevel=0.003))
        builder.add(
            Finish("", (0.85, 0.75, 0.55)),
            box(0.05, deep + 0.002, 0.002, at=(0, 0, z + high - 0.001)),
            panel(0.05, 0.08, at=(0, deep / 2 + 0.001, z + high - 0.08)),
        )
        builder.add(
            image_finish(f"label {rng.integer(0, 7)}"),
            panel(0.14, 0.1, at=(0.1, deep / 2 + 0.001, z + 0.06)),
        )
        z += high
    return builder.model("cardboard box", "moving box", "box", main=card)


def toolbox(rng: RandomStream, palette: Palette) -> Model:
    """A tool box with a handle."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("red", "blue", "yellow", palette.accent_hue)))
    builder.add(body, box(0.45, 0.22, 0.18, bevel=0.01))
    builder.add(
        plastic("black"),
        box(0.46, 0.225, 0.05, at=(0, 0, 0.18), bevel=0.01),
        tube([(-0.12, 0, 0.23), (-0.1, 0, 0.29), (0.1, 0, 0.29), (0.12, 0, 0.23)], 0.012),
    )
    return builder.model("toolbox", "tool box", main=body)


def ladder(rng: RandomStream, palette: Palette) -> Model:
    """A folded step ladder that leans on the wall (-y)."""
    builder = ModelBuilder()
    for s in (-1.0, 1.0):
        builder.add(STEEL, rod((s * 0.21, 0.14, 0.0), (s * 0.17, -0.1, 1.6), 0.018))
    for k in range(5):
        t = (k + 1) / 6
        builder.add(
            STEEL, box(0.38 - 0.08 * t, 0.09, 0.025, at=(0, 0.14 - 0.24 * t, 1.6 * t), bevel=0.005)
        )
    return builder.model("ladder", "step ladder", main=STEEL)


def shoes(rng: RandomStream, palette: Palette) -> Model:
    """A pair of shoes on the floor."""
    builder = ModelBuilder()
    builder.extend(shoe_parts(rng, 0.0, 0.0))
    return builder.model("shoes", "pair of shoes")


def fire_extinguisher(rng: RandomStream, palette: Palette) -> Model:
    """A red extinguisher."""
    builder = ModelBuilder()
    red = plastic("red")
    profile = [(0, 0), (0.08, 0), (0.082, 0.38), (0.06, 0.45), (0.03, 0.48), (0, 0.48)]
    part = lathe(profile, sides=20, crease_deg=50)
    builder.add(red, part)
    builder.add(
        BLACK_METAL,
        box(0.03, 0.14, 0.03, at=(0, 0.03, 0.5)),
        cylinder(0.025, 0.04, at=(0, 0, 0.47)),
        tube([(0.02, 0.04, 0.5), (0.1, 0.05, 0.42), (0.1, 0.05, 0.15)], 0.012),
    )
    builder.add(
        image_finish("label 3"),
        lathe([(0.0835, 0.12), (0.0835, 0.28)], sides=20).textured(3.0, 6.0),
    )
    return builder.model("fire extinguisher", main=red)


def watering_can(rng: RandomStream, palette: Palette) -> Model:
    """A watering can."""
    builder = ModelBuilder()
    body = rng.choice((plastic("green"), STEEL, plastic(palette.accent_hue)))
    builder.add(
        body,
        cylinder(0.1, 0.22, sides=20, top_radius=0.085),
        rod((0.08, 0, 0.05), (0.27, 0, 0.27), 0.016),
        ball(0.07, 0.07, 0.03, at=(0.28, 0, 0.28), sides=10),
        tube([(-0.08, 0, 0.2), (-0.17, 0, 0.22), (-0.18, 0, 0.1), (-0.09, 0, 0.05)], 0.011),
    )
    return builder.model("watering can", main=body)


def folding_chair(rng: RandomStream, palette: Palette) -> Model:
    """A light chair for the balcony."""
    builder = ModelBuilder()
    metal = rng.choice((BLACK_METAL, WHITE_METAL))
    slat = wood(palette.secondary_wood)
    for s in (-1.0, 1.0):
        x = s * 0.2
        builder.add(
            metal,
            rod((x, 0.2, 0), (x, -0.2, 0.84), 0.011),
            rod((x, -0.22, 0), (x, 0.18, 0.44), 0.011),
            rod((x, 0.19, 0.44), (x, -0.06, 0.44), 0.009),
        )
    builder.add(
        slat,
        *[box(0.4, 0.06, 0.015, at=(0, -0.12 + 0.075 * k, 0.445), bevel=0.004) for k in range(5)],
    )
    builder.add(
        slat,
        *[
            box(0.4, 0.014, 0.055, at=(0, -0.115 - 0.035 * k, 0.62 + 0.075 * k), bevel=0.004)
            for k in range(3)
        ],
    )
    return builder.model("chair", "folding chair", "garden chair", main=metal)
