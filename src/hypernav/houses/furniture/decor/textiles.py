"""Rugs, mats, cushions, blankets."""

from hypernav.houses.dice import Dice
from hypernav.houses.furniture.seating_and_storage.sofas import throw_pillow
from hypernav.houses.kit.mesh import Finish
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box, cushion, tile
from hypernav.houses.kit.surfaces import cylinder
from hypernav.houses.kit.tubes import rod
from hypernav.houses.palette import HUES, Taste, fabric, terry


def rug(dice: Dice, taste: Taste) -> Model:
    """A carpet with a pattern, about 2.3 m × 1.6 m."""
    del taste
    wide, deep = dice.uniform(1.9, 2.6, 0.1), dice.uniform(1.3, 1.7, 0.1)
    return _rug(wide, deep, dice.integer(0, 11))


def small_rug(dice: Dice, taste: Taste) -> Model:
    """A carpet for beside the bed or the hall."""
    del taste
    return _rug(dice.uniform(0.9, 1.2, 0.1), dice.uniform(0.55, 0.7, 0.05), dice.integer(0, 11))


def runner(dice: Dice, taste: Taste) -> Model:
    """A long narrow carpet."""
    del taste
    return _rug(dice.uniform(1.8, 2.4, 0.1), 0.65, dice.integer(0, 11))


def _rug(wide: float, deep: float, pattern: int) -> Model:
    bench = Bench()
    key = f"rug {pattern}"
    bench.add(Finish(key, (1.0, 1.0, 1.0), 1.0, "", "wool"), tile(wide, deep, at=(0, 0, 0.0082)))
    edge = Finish("terry", (0.5, 0.46, 0.4), 0.25)
    bench.add(edge, box(wide, deep, 0.008))
    return bench.model("rug", "carpet", attributes=("patterned",))


def bath_mat(dice: Dice, taste: Taste) -> Model:
    """A small mat of terry cloth."""
    bench = Bench()
    cloth = terry(dice.choice((taste.accent, "white", "gray", "light blue")))
    bench.add(cloth, cushion(0.75, 0.5, 0.018, radius=0.008))
    return bench.model("bath mat", "bathroom rug", main=cloth)


def doormat(dice: Dice, taste: Taste) -> Model:
    """A coarse mat at the front door."""
    del taste
    bench = Bench()
    cloth = Finish("pile", dice.choice(((0.45, 0.33, 0.2), (0.3, 0.3, 0.3))), 0.3, "brown", "fibre")
    bench.add(cloth, box(0.7, 0.42, 0.009))
    return bench.model("doormat", "door mat", main=cloth)


def sofa_cushion(dice: Dice, taste: Taste) -> Model:
    """A square cushion that leans against a sofa's back; its back is at -y."""
    bench = Bench()
    cloth = fabric(
        dice.choice((taste.accent, taste.accent, taste.linen, "white")),
        dice.choice(("fabric", "coarse fabric", "stripes", "plaid")),
        0.4,
    )
    bench.add(cloth, throw_pillow(dice.choice((0.4, 0.45))).turned(66, "x").moved(0, 0, 0.2))
    return bench.model("cushion", "throw pillow", "pillow", main=cloth)


def folded_blanket(dice: Dice, taste: Taste) -> Model:
    """A blanket, folded twice."""
    bench = Bench()
    cloth = fabric(
        dice.choice((taste.accent, taste.soft)), dice.choice(("coarse fabric", "plaid")), 0.4
    )
    for k in range(4):
        bench.add(cloth, cushion(0.42 - 0.004 * k, 0.34, 0.03, radius=0.014, at=(0, 0, 0.028 * k)))
    return bench.model("blanket", "folded blanket", main=cloth)


def folded_towels(dice: Dice, taste: Taste) -> Model:
    """A stack of towels."""
    bench = Bench()
    cloth = terry("white")
    for k in range(3):
        cloth = terry(dice.choice((taste.accent, "white", taste.linen)))
        bench.add(cloth, cushion(0.32, 0.22, 0.055, radius=0.024, at=(0, 0, 0.054 * k)))
    return bench.model("towel", "folded towels", "bath towel", main=cloth)


def rolled_mat(dice: Dice, taste: Taste) -> Model:
    """A rolled yoga mat, standing."""
    bench = Bench()
    foam = Finish(
        "terry", HUES[dice.choice(("purple", "teal", "blue", taste.accent))], 0.3, "", "foam"
    )
    bench.add(foam, cylinder(0.07, 0.61, sides=20), rod((0.0, 0.0, 0.605), (0.0, 0.0, 0.612), 0.02))
    return bench.model("yoga mat", "exercise mat", main=foam)
