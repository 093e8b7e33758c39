"""Models of rugs, mats, cushions and blankets."""

from hypernav.houses.materials import HUES, Palette, fabric, terry
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion, tile
from hypernav.houses.modelling.surfaces import cylinder
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.objects.furniture.sofas import throw_pillow
from hypernav.houses.random_stream import RandomStream


def rug(rng: RandomStream, palette: Palette) -> Model:
    """A carpet with a pattern, about 2.3 m × 1.6 m."""
    del palette
    wide, deep = rng.uniform(1.9, 2.6, 0.1), rng.uniform(1.3, 1.7, 0.1)
    return _rug(wide, deep, rng.integer(0, 11))


def small_rug(rng: RandomStream, palette: Palette) -> Model:
    """A carpet for beside the bed or the hall."""
    del palette
    return _rug(rng.uniform(0.9, 1.2, 0.1), rng.uniform(0.55, 0.7, 0.05), rng.integer(0, 11))


def runner(rng: RandomStream, palette: Palette) -> Model:
    """A long narrow carpet."""
    del palette
    return _rug(rng.uniform(1.8, 2.4, 0.1), 0.65, rng.integer(0, 11))


def _rug(wide: float, deep: float, pattern: int) -> Model:
    builder = ModelBuilder()
    key = f"rug {pattern}"
    builder.add(Finish(key, (1.0, 1.0, 1.0), 1.0, "", "wool"), tile(wide, deep, at=(0, 0, 0.0082)))
    edge = Finish("terry", (0.5, 0.46, 0.4), 0.25)
    builder.add(edge, box(wide, deep, 0.008))
    return builder.model("rug", "carpet", attributes=("patterned",))


def bath_mat(rng: RandomStream, palette: Palette) -> Model:
    """A small mat of terry cloth."""
    builder = ModelBuilder()
    cloth = terry(rng.choice((palette.accent_hue, "white", "gray", "light blue")))
    builder.add(cloth, cushion(0.75, 0.5, 0.018, radius=0.008))
    return builder.model("bath mat", "bathroom rug", main=cloth)


def doormat(rng: RandomStream, palette: Palette) -> Model:
    """A coarse mat at the front door."""
    del palette
    builder = ModelBuilder()
    cloth = Finish("pile", rng.choice(((0.45, 0.33, 0.2), (0.3, 0.3, 0.3))), 0.3, "brown", "fibre")
    builder.add(cloth, box(0.7, 0.42, 0.009))
    return builder.model("doormat", "door mat", main=cloth)


def sofa_cushion(rng: RandomStream, palette: Palette) -> Model:
    """A square cushion that leans against a sofa's back; its back is at -y."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.accent_hue, palette.accent_hue, palette.linen_hue, "white")),
        rng.choice(("fabric", "coarse fabric", "stripes", "plaid")),
        0.4,
    )
    builder.add(cloth, throw_pillow(rng.choice((0.4, 0.45))).turned(66, "x").moved(0, 0, 0.2))
    return builder.model("cushion", "throw pillow", "pillow", main=cloth)


def folded_blanket(rng: RandomStream, palette: Palette) -> Model:
    """A blanket, folded twice."""
    builder = ModelBuilder()
    cloth = fabric(
        rng.choice((palette.accent_hue, palette.upholstery_hue)),
        rng.choice(("coarse fabric", "plaid")),
        0.4,
    )
    for k in range(4):
        builder.add(
            cloth, cushion(0.42 - 0.004 * k, 0.34, 0.03, radius=0.014, at=(0, 0, 0.028 * k))
        )
    return builder.model("blanket", "folded blanket", main=cloth)


def folded_towels(rng: RandomStream, palette: Palette) -> Model:
    """A stack of towels."""
    builder = ModelBuilder()
    cloth = terry("white")
    for k in range(3):
        cloth = terry(rng.choice((palette.accent_hue, "white", palette.linen_hue)))
        builder.add(cloth, cushion(0.32, 0.22, 0.055, radius=0.024, at=(0, 0, 0.054 * k)))
    return builder.model("towel", "folded towels", "bath towel", main=cloth)


def rolled_mat(rng: RandomStream, palette: Palette) -> Model:
    """A rolled yoga mat, standing."""
    builder = ModelBuilder()
    foam = Finish(
        "terry", HUES[rng.choice(("purple", "teal", "blue", palette.accent_hue))], 0.3, "", "foam"
    )
    builder.add(
        foam, cylinder(0.07, 0.61, sides=20), rod((0.0, 0.0, 0.605), (0.0, 0.0, 0.612), 0.02)
    )
    return builder.model("yoga mat", "exercise mat", main=foam)
