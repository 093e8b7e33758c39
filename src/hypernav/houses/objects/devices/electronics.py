"""Models of electronic devices and small electrical appliances."""

import math

from hypernav.houses.materials import CHROME, Palette, image_finish, lacquer, plastic
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, panel, tile
from hypernav.houses.modelling.surfaces import cylinder
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.random_stream import RandomStream

_GRILLE = Finish("fabric", (0.14, 0.14, 0.15), 0.2, "black", "fabric")


def fan(rng: RandomStream, palette: Palette) -> Model:
    """A standing fan."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "black")))
    z = rng.uniform(1.0, 1.15)
    builder.add(
        body, cylinder(0.19, 0.03, sides=28, bevel=0.01), rod((0, 0, 0.02), (0, 0, z), 0.014)
    )
    builder.add(body, cylinder(0.06, 0.13).turned(90, "x").moved(0, 0.02, z))
    for k in range(3):
        blade = (
            cushion(0.1, 0.16, 0.01, radius=0.004, at=(0, 0.11, 0)).turned(20, "y").turned(90, "x")
        )
        builder.add(body, blade.turned(120 * k, "y").moved(0, 0.06, z))
    for r in (0.21, 0.14, 0.07):
        ring = [
            (r * math.cos(a), 0.09 + 0.02 * (1 - r / 0.21), z + r * math.sin(a)) for a in _turn(24)
        ]
        builder.add(CHROME, tube(ring, 0.004 if r > 0.2 else 0.0025, sides=5, closed=True))
    for a in _turn(16):
        builder.add(
            CHROME,
            rod((0, 0.11, z), (0.21 * math.cos(a), 0.09, z + 0.21 * math.sin(a)), 0.0018, sides=4),
        )
    return builder.model("fan", "standing fan", "electric fan", main=body)


def _turn(count: int) -> list[float]:
    return [2.0 * math.pi * k / count for k in range(count)]


def speaker(rng: RandomStream, palette: Palette) -> Model:
    """A tall loudspeaker."""
    body = palette.furniture_wood(rng) if rng.chance(0.4) else plastic("black")
    return _speaker(body, 0.22, 0.28, rng.uniform(0.85, 1.0))


def speaker_small(rng: RandomStream, palette: Palette) -> Model:
    """A loudspeaker for a shelf."""
    del palette
    return _speaker(plastic(rng.choice(("black", "white"))), 0.15, 0.17, 0.24)


def _speaker(body: Finish, wide: float, deep: float, high: float) -> Model:
    builder = ModelBuilder()
    builder.add(body, box(wide, deep, high, bevel=0.006).swapped_uv())
    builder.add(_GRILLE, panel(wide * 0.86, high * 0.94, at=(0, deep / 2 + 0.001, high * 0.03)))
    for z, r in ((0.3, 0.36), (0.62, 0.3), (0.84, 0.16)):
        cone = cylinder(wide * r, 0.006, sides=20, top_radius=wide * r * 0.8).turned(-90, "x")
        builder.add(plastic("dark gray"), cone.moved(0, deep / 2 + 0.001, high * z))
    return builder.model("speaker", "loudspeaker", main=body)


def game_console(rng: RandomStream, palette: Palette) -> Model:
    """A game console: a flat black or white box."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "white")))
    builder.add(body, box(0.3, 0.22, 0.06, bevel=0.01))
    builder.add(plastic("blue"), box(0.08, 0.004, 0.006, at=(0.08, 0.11, 0.028)))
    return builder.model("game console", "video game console", main=body)


def phone(rng: RandomStream, palette: Palette) -> Model:
    """A smartphone, lying."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "white", "blue")))
    builder.add(body, box(0.075, 0.155, 0.009, bevel=0.004))
    builder.add(Finish("", (0.05, 0.05, 0.07)), tile(0.067, 0.14, at=(0, 0, 0.0095)))
    return builder.model("cell phone", "mobile phone", "smartphone", main=body)


def printer(rng: RandomStream, palette: Palette) -> Model:
    """A desk printer with paper."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "light gray", "dark gray")))
    builder.add(
        body,
        cushion(0.4, 0.36, 0.18, radius=0.025),
        box(0.36, 0.3, 0.02, at=(0, -0.01, 0.18), bevel=0.006),
    )
    builder.add(
        plastic("black"),
        box(0.34, 0.02, 0.05, at=(0, 0.172, 0.05)),
        box(0.12, 0.004, 0.03, at=(-0.1, 0.18, 0.14)),
    )
    builder.add(plastic("gray"), box(0.3, 0.13, 0.008, at=(0, 0.235, 0.045)))
    builder.add(
        plastic("white"),
        box(0.21, 0.12, 0.006, at=(0, 0.235, 0.053)),
        box(0.21, 0.012, 0.16, at=(0, -0.17, 0.17)),
    )
    return builder.model("printer", "inkjet printer", main=body)


def vacuum_cleaner(rng: RandomStream, palette: Palette) -> Model:
    """A canister vacuum cleaner with its hose upright."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("red", "blue", palette.accent_hue, "dark gray")))
    builder.add(body, cushion(0.28, 0.42, 0.22, radius=0.09, rounds=3, at=(0, 0, 0.05)))
    builder.add(
        plastic("black"),
        *[
            cylinder(0.09, 0.04).turned(90, "y").moved(s * 0.14 - 0.02, -0.1, 0.09)
            for s in (-1.0, 1.0)
        ],
    )
    builder.add(
        plastic("dark gray"),
        tube([(0, 0.18, 0.2), (0, 0.3, 0.4), (0.1, 0.3, 0.75), (0.16, 0.18, 0.95)], 0.02),
    )
    builder.add(CHROME, rod((0.16, 0.18, 0.95), (0.2, 0.3, 0.06), 0.014))
    builder.add(plastic("black"), box(0.26, 0.1, 0.05, at=(0.2, 0.32, 0), bevel=0.01))
    return builder.model("vacuum cleaner", "hoover", main=body)


def air_purifier(rng: RandomStream, palette: Palette) -> Model:
    """A white tower with slots."""
    del palette
    builder = ModelBuilder()
    body = plastic(rng.choice(("white", "light gray")))
    builder.add(body, cushion(0.3, 0.22, 0.55, radius=0.05))
    for k in range(12):
        builder.add(plastic("gray"), box(0.2, 0.006, 0.008, at=(0, 0.109, 0.08 + 0.022 * k)))
    builder.add(lacquer("black"), box(0.1, 0.004, 0.03, at=(0, 0.109, 0.44)))
    return builder.model("air purifier", "air cleaner", main=body)


def hair_dryer(rng: RandomStream, palette: Palette) -> Model:
    """A hair dryer, lying."""
    builder = ModelBuilder()
    body = plastic(rng.choice(("black", "pink", "white", palette.accent_hue)))
    builder.add(
        body,
        cylinder(0.04, 0.18, sides=16, top_radius=0.03).turned(90, "y").moved(-0.09, 0, 0.04),
        rod((-0.04, 0, 0.03), (-0.06, 0.13, 0.02), 0.02),
    )
    return builder.model("hair dryer", "hair drier", "blow dryer", main=body)


def radio(rng: RandomStream, palette: Palette) -> Model:
    """A small radio with a handle."""
    builder = ModelBuilder()
    body = palette.furniture_wood(rng) if rng.chance(0.5) else plastic(palette.accent_hue)
    builder.add(body, box(0.26, 0.1, 0.16, bevel=0.012))
    builder.add(_GRILLE, panel(0.14, 0.11, at=(-0.045, 0.051, 0.025)))
    builder.add(
        CHROME,
        cylinder(0.02, 0.015, sides=14).turned(-90, "x").moved(0.085, 0.05, 0.06),
        rod((0.1, -0.03, 0.16), (0.14, -0.03, 0.33), 0.003, sides=5),
    )
    builder.add(image_finish("label 2"), panel(0.06, 0.03, at=(0.085, 0.051, 0.1)))
    return builder.model("radio", main=body)
