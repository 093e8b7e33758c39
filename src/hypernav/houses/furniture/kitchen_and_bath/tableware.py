"""What stands in kitchens and on dining tables."""

from hypernav.houses.dice import Dice
from hypernav.houses.kit.mesh import Finish, Mesh
from hypernav.houses.kit.model import Bench, Model
from hypernav.houses.kit.solids import box
from hypernav.houses.kit.surfaces import ball, cylinder, lathe
from hypernav.houses.kit.tubes import rod, tube
from hypernav.houses.palette import BLACK_METAL, CHROME, HUES, STEEL, Taste, picture, plastic, wood


def glazed(hue: str) -> Finish:
    """Coloured ceramic."""
    return Finish("", HUES[hue], 1.0, hue, "ceramic")


def cup(dice: Dice, taste: Taste) -> Model:
    """A mug."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", taste.accent, "blue", "yellow", "red")))
    bench.add(
        glaze,
        lathe(
            [
                (0, 0),
                (0.036, 0),
                (0.041, 0.01),
                (0.041, 0.095),
                (0.037, 0.095),
                (0.036, 0.02),
                (0, 0.018),
            ],
            sides=18,
        ),
    )
    bench.add(
        glaze,
        tube(
            [(0.04, 0, 0.075), (0.068, 0, 0.072), (0.07, 0, 0.035), (0.04, 0, 0.022)],
            0.006,
            sides=6,
        ),
    )
    bench.add(plastic("brown"), cylinder(0.036, 0.002, at=(0, 0, 0.08)))
    return bench.model("cup", "mug", "coffee cup", main=glaze)


def bowl(dice: Dice, taste: Taste) -> Model:
    """An empty bowl."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", taste.accent, "teal", "cream")))
    bench.add(glaze, _bowl(0.12, 0.075))
    return bench.model("bowl", main=glaze)


def _bowl(radius: float, high: float) -> Mesh:
    return lathe(
        [
            (0, 0),
            (radius * 0.45, 0),
            (radius * 0.5, 0.008),
            (radius * 0.85, high * 0.55),
            (radius, high),
            (radius * 0.96, high),
            (radius * 0.8, high * 0.55),
            (radius * 0.4, 0.016),
            (0, 0.014),
        ],
        sides=28,
        crease_deg=60,
    )


def fruit_bowl(dice: Dice, taste: Taste) -> Model:
    """A bowl with oranges, apples and bananas."""
    bench = Bench()
    glaze = (
        glazed(dice.choice(("white", "teal", taste.accent))) if dice.chance(0.6) else wood("oak")
    )
    bench.add(glaze, _bowl(0.16, 0.08))
    inks = ((0.95, 0.55, 0.12), (0.78, 0.12, 0.1), (0.5, 0.68, 0.2), (0.95, 0.6, 0.15))
    for k, (x, y, z) in enumerate(
        (
            (0.06, 0.02, 0.075),
            (-0.05, 0.055, 0.075),
            (-0.03, -0.06, 0.075),
            (0.04, -0.06, 0.08),
            (0.0, 0.0, 0.115),
        )
    ):
        bench.add(
            Finish("", inks[(k + dice.integer(0, 3)) % 4]),
            ball(0.078, 0.078, 0.074, at=(x, y, z), sides=14),
        )
    banana = [(-0.09, 0.03, 0.1), (-0.03, 0.06, 0.135), (0.04, 0.06, 0.135), (0.09, 0.03, 0.11)]
    bench.add(Finish("", (0.95, 0.8, 0.2)), tube(banana, [0.008, 0.018, 0.018, 0.007]))
    return bench.model("fruit bowl", "bowl", main=glaze)


def plate(dice: Dice, taste: Taste) -> Model:
    """A plate with knife and fork."""
    bench = Bench()
    glaze = glazed(dice.choice(("white", "white", "light blue", taste.accent)))
    bench.add(
        glaze,
        lathe(
            [(0, 0), (0.08, 0), (0.13, 0.018), (0.128, 0.021), (0.085, 0.008), (0, 0.006)],
            sides=28,
            crease_deg=60,
        ),
    )
    for x in (-0.165, 0.165):
        bench.add(CHROME, box(0.014, 0.19, 0.004, at=(x, 0, 0)))
    return bench.model("plate", "dish", main=glaze)


def bottle(dice: Dice, taste: Taste) -> Model:
    """A bottle of wine or water."""
    del taste
    bench = Bench()
    glass = Finish(
        "",
        dice.choice(((0.1, 0.22, 0.12), (0.15, 0.05, 0.06), (0.6, 0.75, 0.8), (0.3, 0.2, 0.1))),
        1.0,
        "",
        "glass",
    )
    bench.add(
        glass,
        lathe(
            [(0, 0), (0.037, 0), (0.038, 0.19), (0.014, 0.24), (0.014, 0.31), (0, 0.31)],
            sides=18,
            crease_deg=50,
        ),
    )
    bench.add(
        picture(f"label {dice.integer(0, 7)}"),
        lathe([(0.0385, 0.06), (0.0385, 0.15)], sides=18).textured(8.0, 11.0),
    )
    return bench.model("bottle", main=glass)


def pot(dice: Dice, taste: Taste) -> Model:
    """A cooking pot with its lid."""
    bench = Bench()
    body = dice.choice((STEEL, glazed(taste.accent), plastic("red")))
    radius = dice.uniform(0.095, 0.11)
    bench.add(
        body,
        lathe([(0, 0), (radius, 0), (radius, 0.11), (radius * 1.03, 0.115)], sides=24),
        lathe([(radius * 1.03, 0.115), (radius * 0.8, 0.13), (0, 0.14)], sides=24, crease_deg=60),
    )
    bench.add(BLACK_METAL, ball(0.03, 0.03, 0.025, at=(0, 0, 0.15), sides=10))
    for s in (-1.0, 1.0):
        bench.add(
            BLACK_METAL, box(0.03, 0.05, 0.015, at=(s * (radius + 0.012), 0, 0.08), bevel=0.005)
        )
    return bench.model("pot", "cooking pot", "saucepan", main=body)


def knife_block(dice: Dice, taste: Taste) -> Model:
    """Knives in a wooden block."""
    del dice
    bench = Bench()
    body = wood(taste.wood)
    bench.add(body, box(0.1, 0.14, 0.2, bevel=0.008))
    for k in range(4):
        bench.add(
            plastic("black"),
            box(0.016, 0.024, 0.09, at=(-0.03 + 0.02 * k, 0.01 * (k % 2), 0.2), bevel=0.005),
        )
    return bench.model("knife block", "knives", main=body)


def paper_towels(dice: Dice, taste: Taste) -> Model:
    """A roll of kitchen paper on its stand."""
    del dice, taste
    bench = Bench()
    bench.add(
        CHROME, cylinder(0.075, 0.012, sides=24), rod((0, 0, 0.01), (0, 0, 0.3), 0.006, sides=6)
    )
    bench.add(
        Finish("terry", (0.97, 0.97, 0.96), 0.2, "white", "paper"),
        cylinder(0.06, 0.24, at=(0, 0, 0.014), sides=24),
    )
    return bench.model("paper towels", "kitchen roll", main=CHROME)


def cutting_board(dice: Dice, taste: Taste) -> Model:
    """A board with bread."""
    bench = Bench()
    board = wood(taste.second_wood)
    bench.add(board, box(0.38, 0.24, 0.02, bevel=0.006))
    if dice.chance(0.7):
        bench.add(
            Finish("terry", (0.72, 0.48, 0.25), 0.3),
            ball(0.24, 0.12, 0.11, at=(-0.02, 0, 0.07), sides=14),
        )
    return bench.model("cutting board", "chopping board", main=board)
