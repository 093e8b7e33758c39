"""Things with a plug."""

import math

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, panel, tile
from hypernav.houses.kit.surfaces import cylinder
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import CHROME, Taste, lacquer, picture, plastic

_GRILLE = Finish("fabric", (0.14, 0.14, 0.15), 0.2, "black", "fabric")


def fan(dice: Dice, taste: Taste) -> Model:
    """A standing fan."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("white", "black")))
    z = dice.uniform(1.0, 1.15)
    bench.add(body, cylinder(0.19, 0.03, sides=28, bevel=0.01), rod((0, 0, 0.02), (0, 0, z), 0.014))
    bench.add(body, cylinder(0.06, 0.13).turned(90, "x").moved(0, 0.02, z))
    for k in range(3):
        blade = (
            cushion(0.1, 0.16, 0.01, radius=0.004, at=(0, 0.11, 0)).turned(20, "y").turned(90, "x")
        )
        bench.add(body, blade.turned(120 * k, "y").moved(0, 0.06, z))
    for r in (0.21, 0.14, 0.07):
        ring = [
            (r * math.cos(a), 0.09 + 0.02 * (1 - r / 0.21), z + r * math.sin(a)) for a in _turn(24)
        ]
        bench.add(CHROME, tube(ring, 0.004 if r > 0.2 else 0.0025, sides=5, closed=True))
    for a in _turn(16):
        bench.add(
            CHROME,
            rod((0, 0.11, z), (0.21 * math.cos(a), 0.09, z + 0.21 * math.sin(a)), 0.0018, sides=4),
        )
    return bench.model("fan", "standing fan", "electric fan", main=body)


def _turn(count: int) -> list[float]:
    return [2.0 * math.pi * k / count for k in range(count)]


def speaker(dice: Dice, taste: Taste) -> Model:
    """A tall loudspeaker."""
    body = taste.furniture_wood(dice) if dice.chance(0.4) else plastic("black")
    return _speaker(body, 0.22, 0.28, dice.uniform(0.85, 1.0))


def speaker_small(dice: Dice, taste: Taste) -> Model:
    """A loudspeaker for a shelf."""
    del taste
    return _speaker(plastic(dice.choice(("black", "white"))), 0.15, 0.17, 0.24)


def _speaker(body: Finish, wide: float, deep: float, high: float) -> Model:
    bench = Bench()
    bench.add(body, box(wide, deep, high, bevel=0.006).swapped_uv())
    bench.add(_GRILLE, panel(wide * 0.86, high * 0.94, at=(0, deep / 2 + 0.001, high * 0.03)))
    for z, r in ((0.3, 0.36), (0.62, 0.3), (0.84, 0.16)):
        cone = cylinder(wide * r, 0.006, sides=20, top_radius=wide * r * 0.8).turned(-90, "x")
        bench.add(plastic("dark gray"), cone.moved(0, deep / 2 + 0.001, high * z))
    return bench.model("speaker", "loudspeaker", main=body)


def game_console(dice: Dice, taste: Taste) -> Model:
    """A flat black or white box."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("black", "white")))
    bench.add(body, box(0.3, 0.22, 0.06, bevel=0.01))
    bench.add(plastic("blue"), box(0.08, 0.004, 0.006, at=(0.08, 0.11, 0.028)))
    return bench.model("game console", "video game console", main=body)


def phone(dice: Dice, taste: Taste) -> Model:
    """A smartphone, lying."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("black", "white", "blue")))
    bench.add(body, box(0.075, 0.155, 0.009, bevel=0.004))
    bench.add(Finish("", (0.05, 0.05, 0.07)), tile(0.067, 0.14, at=(0, 0, 0.0095)))
    return bench.model("cell phone", "mobile phone", "smartphone", main=body)


def printer(dice: Dice, taste: Taste) -> Model:
    """A desk printer with paper."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("white", "light gray", "dark gray")))
    bench.add(
        body,
        cushion(0.4, 0.36, 0.18, radius=0.025),
        box(0.36, 0.3, 0.02, at=(0, -0.01, 0.18), bevel=0.006),
    )
    bench.add(
        plastic("black"),
        box(0.34, 0.02, 0.05, at=(0, 0.172, 0.05)),
        box(0.12, 0.004, 0.03, at=(-0.1, 0.18, 0.14)),
    )
    bench.add(plastic("gray"), box(0.3, 0.13, 0.008, at=(0, 0.235, 0.045)))
    bench.add(
        plastic("white"),
        box(0.21, 0.12, 0.006, at=(0, 0.235, 0.053)),
        box(0.21, 0.012, 0.16, at=(0, -0.17, 0.17)),
    )
    return bench.model("printer", "inkjet printer", main=body)


def vacuum_cleaner(dice: Dice, taste: Taste) -> Model:
    """A canister vacuum cleaner with its hose upright."""
    bench = Bench()
    body = plastic(dice.choice(("red", "blue", taste.accent, "dark gray")))
    bench.add(body, cushion(0.28, 0.42, 0.22, radius=0.09, rounds=3, at=(0, 0, 0.05)))
    bench.add(
        plastic("black"),
        *[
            cylinder(0.09, 0.04).turned(90, "y").moved(s * 0.14 - 0.02, -0.1, 0.09)
            for s in (-1.0, 1.0)
        ],
    )
    bench.add(
        plastic("dark gray"),
        tube([(0, 0.18, 0.2), (0, 0.3, 0.4), (0.1, 0.3, 0.75), (0.16, 0.18, 0.95)], 0.02),
    )
    bench.add(CHROME, rod((0.16, 0.18, 0.95), (0.2, 0.3, 0.06), 0.014))
    bench.add(plastic("black"), box(0.26, 0.1, 0.05, at=(0.2, 0.32, 0), bevel=0.01))
    return bench.model("vacuum cleaner", "hoover", main=body)


def air_purifier(dice: Dice, taste: Taste) -> Model:
    """A white tower with slots."""
    del taste
    bench = Bench()
    body = plastic(dice.choice(("white", "light gray")))
    bench.add(body, cushion(0.3, 0.22, 0.55, radius=0.05))
    for k in range(12):
        bench.add(plastic("gray"), box(0.2, 0.006, 0.008, at=(0, 0.109, 0.08 + 0.022 * k)))
    bench.add(lacquer("black"), box(0.1, 0.004, 0.03, at=(0, 0.109, 0.44)))
    return bench.model("air purifier", "air cleaner", main=body)


def hair_dryer(dice: Dice, taste: Taste) -> Model:
    """A hair dryer, lying."""
    bench = Bench()
    body = plastic(dice.choice(("black", "pink", "white", taste.accent)))
    bench.add(
        body,
        cylinder(0.04, 0.18, sides=16, top_radius=0.03).turned(90, "y").moved(-0.09, 0, 0.04),
        rod((-0.04, 0, 0.03), (-0.06, 0.13, 0.02), 0.02),
    )
    return bench.model("hair dryer", "hair drier", "blow dryer", main=body)


def radio(dice: Dice, taste: Taste) -> Model:
    """A small radio with a handle."""
    bench = Bench()
    body = taste.furniture_wood(dice) if dice.chance(0.5) else plastic(taste.accent)
    bench.add(body, box(0.26, 0.1, 0.16, bevel=0.012))
    bench.add(_GRILLE, panel(0.14, 0.11, at=(-0.045, 0.051, 0.025)))
    bench.add(
        CHROME,
        cylinder(0.02, 0.015, sides=14).turned(-90, "x").moved(0.085, 0.05, 0.06),
        rod((0.1, -0.03, 0.16), (0.14, -0.03, 0.33), 0.003, sides=5),
    )
    bench.add(picture("label 2"), panel(0.06, 0.03, at=(0.085, 0.051, 0.1)))
    return bench.model("radio", main=body)
