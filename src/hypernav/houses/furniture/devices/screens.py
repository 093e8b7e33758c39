"""Televisions and computers."""

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, panel, tile
from hypernav.houses.kit.tubes import rod
from hypernav.houses.palette import BLACK_METAL, STEEL, Taste, picture, plastic

_FRAME = Finish("", (0.045, 0.045, 0.05), 1.0, "black", "plastic")


def _screen(
    bench: Bench, dice: Dice, wide: float, high: float, z: float, y: float, key: str
) -> None:
    rim = 0.014
    bench.add(_FRAME, box(wide, 0.035, high, at=(0, y - 0.0175, z), bevel=0.004))
    bench.add(
        picture(key), panel(wide - 2 * rim, high - 2.4 * rim, at=(0, y + 0.0012, z + 1.4 * rim))
    )


def _programme(dice: Dice) -> str:
    return f"screen show {dice.integer(0, 11)}" if dice.chance(0.45) else "screen off"


def tv(dice: Dice, taste: Taste) -> Model:
    """A flat television on feet."""
    del taste
    bench = Bench()
    wide = dice.choice((0.97, 1.1, 1.1, 1.23, 1.3))
    high = wide * 0.58
    _screen(bench, dice, wide, high, 0.06, 0.0, _programme(dice))
    bench.add(_FRAME, box(wide * 0.6, 0.05, high * 0.5, at=(0, -0.045, 0.12), bevel=0.02))
    if dice.chance(0.5):
        bench.add(
            BLACK_METAL,
            box(wide * 0.4, 0.22, 0.014, at=(0, -0.02, 0), bevel=0.004),
            box(0.1, 0.03, 0.1, at=(0, -0.03, 0)),
        )
    else:
        for s in (-1.0, 1.0):
            x = s * wide * 0.36
            for y in (0.09, -0.13):
                bench.add(BLACK_METAL, rod((x, y, 0.006), (x, -0.02, 0.07), 0.007, sides=6))
    return bench.model("tv", "television", "flat screen tv", main=_FRAME)


def wall_tv(dice: Dice, taste: Taste) -> Model:
    """A flat television on a wall mount; its back is the wall."""
    del taste
    bench = Bench()
    wide = dice.choice((1.1, 1.23, 1.36, 1.45))
    high = wide * 0.575
    _screen(bench, dice, wide, high, 0.0, 0.0, _programme(dice))
    bench.add(BLACK_METAL, box(0.4, 0.04, 0.3, at=(0, -0.05, high / 2 - 0.15)))
    return bench.model("tv", "television", "flat screen tv", "wall tv", main=_FRAME)


def monitor(dice: Dice, taste: Taste) -> Model:
    """A computer monitor on its foot."""
    del taste
    bench = Bench()
    wide = dice.choice((0.5, 0.56, 0.62))
    _screen(
        bench,
        dice,
        wide,
        wide * 0.6,
        0.12,
        0.0,
        "screen desktop" if dice.chance(0.6) else "screen off",
    )
    bench.add(
        _FRAME,
        box(0.05, 0.03, 0.2, at=(0, -0.05, 0)),
        box(0.22, 0.18, 0.012, at=(0, -0.02, 0), bevel=0.004),
    )
    return bench.model("computer monitor", "monitor", "computer screen", main=_FRAME)


def laptop(dice: Dice, taste: Taste) -> Model:
    """An open laptop; its user sits in front (+y)."""
    del taste
    bench = Bench()
    body = STEEL if dice.chance(0.6) else plastic("dark gray")
    bench.add(body, box(0.34, 0.235, 0.016, at=(0, 0, 0), bevel=0.004))
    bench.add(picture("keyboard"), tile(0.3, 0.11, at=(0, -0.045, 0.0165)))
    bench.add(body.tinted(0.8), tile(0.1, 0.065, at=(0, 0.07, 0.0165)))
    lid = Bench()
    lid.add(body, box(0.34, 0.008, 0.225, bevel=0.003))
    lid.add(picture("screen desktop"), panel(0.325, 0.205, at=(0, 0.0045, 0.012)))
    for part in lid.parts:
        bench.add(part.finish, part.mesh.turned(16, "x").moved(0, -0.115, 0.012))
    return bench.model("laptop", "laptop computer", "notebook computer", main=body)


def keyboard(dice: Dice, taste: Taste) -> Model:
    """A computer keyboard."""
    del taste
    bench = Bench()
    body = plastic("black") if dice.chance(0.6) else plastic("white")
    bench.add(body, box(0.44, 0.145, 0.02, bevel=0.005))
    bench.add(picture("keyboard"), tile(0.42, 0.125, at=(0, 0, 0.0205)).turned(180))
    return bench.model("keyboard", "computer keyboard", main=body)
