"""Models of sofas, armchairs and bean bags."""

import numpy as np

from hypernav.houses.materials import BLACK_METAL, Palette, fabric, leather
from hypernav.houses.modelling.joinery import four_legs
from hypernav.houses.modelling.mesh import Finish, Mesh, join
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion
from hypernav.houses.modelling.surfaces import lathe, sheet
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream


def upholstery(rng: RandomStream, palette: Palette) -> Finish:
    """Finish of cloth or leather in the room's colour."""
    return rng.weighted(
        (
            (fabric(palette.upholstery_hue), 4.0),
            (fabric(palette.upholstery_hue, "coarse fabric", 0.4), 3.0),
            (leather(palette.upholstery_hue), 2.0),
            (leather("brown"), 1.0),
        )
    )


def throw_pillow(x: float, finish_uv: float = 1.0) -> Mesh:
    """A square pillow with pinched corners, lying on z = 0; edge length ``x``."""
    n = 9
    at = np.linspace(-1.0, 1.0, n)
    u, v = np.meshgrid(at, at, indexing="ij")
    thick = ((1.0 - u**4) * (1.0 - v**4)) ** 0.5
    pull_u = 1.0 - 0.07 * (1.0 - v**2)
    pull_v = 1.0 - 0.07 * (1.0 - u**2)
    px, py = u * pull_u * x / 2, v * pull_v * x / 2
    high = x * 0.17
    upper = np.stack([px, py, high + thick * high], axis=-1)
    lower = np.stack([px, py, high - thick * high], axis=-1)
    return join([sheet(upper), sheet(lower[::-1])]).textured(finish_uv, finish_uv)


def sofa(rng: RandomStream, palette: Palette) -> Model:
    """A sofa for two or three."""
    seats = rng.weighted(((2, 2.0), (3, 3.0)))
    wide = seats * rng.uniform(0.6, 0.7) + 0.4
    return _sofa(
        rng,
        palette,
        wide,
        seats,
        "sofa",
        ("couch", "two-seater sofa" if seats == 2 else "three-seater sofa"),
    )


def l_shaped_sofa(rng: RandomStream, palette: Palette) -> Model:
    """A sofa with a chaise at one end."""
    wide = rng.uniform(2.3, 2.7)
    return _sofa(
        rng,
        palette,
        wide,
        3,
        "sofa",
        ("L-shaped sofa", "sectional sofa", "corner sofa", "couch"),
        chaise=rng.choice((-1.0, 1.0)),
    )


def armchair(rng: RandomStream, palette: Palette) -> Model:
    """A padded chair for one, with arms."""
    return _sofa(rng, palette, rng.uniform(0.82, 0.92), 1, "armchair", ("easy chair", "arm chair"))


def _sofa(
    rng: RandomStream,
    palette: Palette,
    wide: float,
    seats: int,
    category: str,
    synonyms: tuple[str, ...],
    chaise: float = 0.0,
) -> Model:
    builder = ModelBuilder()
    cloth = upholstery(rng, palette)
    deep, seat, top = rng.uniform(0.85, 0.95), rng.uniform(0.42, 0.46), rng.uniform(0.8, 0.9)
    arm, arm_top = rng.uniform(0.13, 0.22), rng.uniform(0.58, 0.66)
    leg = rng.choice((0.05, 0.1, 0.14))
    inner = wide - 2 * arm
    base_z = leg
    # Base, back and arms
    builder.add(
        cloth,
        cushion(wide - 0.02, deep - 0.06, seat - 0.15 - base_z, radius=0.02, at=(0, 0, base_z)),
    )
    back_thick = 0.2
    back_y = -deep / 2 + back_thick / 2
    builder.add(
        cloth,
        cushion(
            wide - 0.01,
            back_thick,
            top - 0.1 - base_z,
            radius=0.06,
            rounds=3,
            at=(0, back_y, base_z),
        ),
    )
    _arms(builder, rng, cloth, wide, deep, arm, arm_top, base_z)
    # Seat cushions
    seat_deep = deep - back_thick + 0.02
    each = inner / seats
    for k in range(seats):
        x = (k + 0.5) * each - inner / 2
        long = chaise != 0.0 and (k == (0 if chaise < 0 else seats - 1))
        extra = 0.68 if long else 0.0
        builder.add(
            cloth,
            cushion(
                each - 0.008,
                seat_deep + extra,
                0.17,
                radius=0.045,
                puff=0.018,
                flats=3,
                rounds=3,
                at=(x, deep / 2 - seat_deep / 2 + extra / 2, seat - 0.17),
            ),
        )
        high = top - seat + 0.03
        pad = cushion(each - 0.012, high, 0.17, radius=0.065, puff=0.025, flats=3, rounds=3).turned(
            90, "x"
        )
        builder.add(
            cloth,
            pad.moved(0, 0.085, high / 2).turned(10, "x").moved(x, -deep / 2 + 0.17, seat - 0.02),
        )
        if long:
            builder.add(
                cloth,
                cushion(
                    each + arm * 0.0,
                    extra,
                    seat - 0.15 - base_z,
                    radius=0.02,
                    at=(x, deep / 2 + extra / 2 - 0.03, base_z),
                ),
            )
    legs = BLACK_METAL if rng.chance(0.4) else palette.furniture_wood(rng)
    builder.add(
        legs, *four_legs(wide - 0.08, deep - 0.1, leg + 0.01, thick=0.05, round_=rng.chance(0.5))
    )
    if chaise:
        x = chaise * (inner / 2 - 0.06)
        builder.add(legs, rod((x, deep / 2 + 0.58, 0), (x, deep / 2 + 0.58, leg + 0.01), 0.02))
    attributes = ("L-shaped",) if chaise else ()
    return builder.model(category, *synonyms, main=cloth, attributes=attributes)


def _arms(
    builder: ModelBuilder,
    rng: RandomStream,
    cloth: Finish,
    wide: float,
    deep: float,
    arm: float,
    top: float,
    base: float,
) -> None:
    style = rng.choice(("box", "rolled", "soft"))
    for s in (-1.0, 1.0):
        x = s * (wide - arm) / 2
        if style == "rolled":
            radius = arm / 2 + 0.01
            roll = lathe(
                [
                    (0, 0),
                    (radius - 0.012, 0),
                    (radius, 0.012),
                    (radius, deep - 0.03),
                    (0, deep - 0.03),
                ],
                sides=20,
                crease_deg=60,
            ).turned(-90, "x")
            builder.add(cloth, roll.moved(x, -deep / 2 + 0.015, top - radius))
            builder.add(
                cloth,
                box(arm - 0.03, deep - 0.03, top - radius - base, at=(x, 0, base), bevel=0.01),
            )
        else:
            radius = 0.03 if style == "box" else 0.075
            builder.add(
                cloth, cushion(arm, deep, top - base, radius=radius, rounds=3, at=(x, 0, base))
            )


def bean_bag(rng: RandomStream, palette: Palette) -> Model:
    """A soft sack to sit in."""
    builder = ModelBuilder()
    cloth = fabric(rng.choice((palette.accent_hue, palette.upholstery_hue, "red", "blue")))
    sack = lathe(
        [
            (0.0, 0.0),
            (0.3, 0.0),
            (0.4, 0.06),
            (0.44, 0.18),
            (0.41, 0.32),
            (0.33, 0.45),
            (0.24, 0.56),
            (0.14, 0.64),
            (0.05, 0.68),
            (0.0, 0.69),
        ],
        sides=24,
        crease_deg=80,
    )
    lean = sack.positions.copy()
    rise = np.clip(lean[:, 2] / 0.69, 0.0, 1.0)
    lean[:, 1] -= 0.16 * rise**2
    dent = np.exp(-((lean[:, 0] / 0.25) ** 2) - ((lean[:, 1] - 0.22) / 0.2) ** 2)
    lean[:, 2] -= 0.14 * dent * rise
    angle = np.arctan2(lean[:, 1], lean[:, 0])
    folds = 1.0 + 0.025 * np.sin(6 * angle) * rise * (1 - rise) * 4
    lean[:, :2] *= folds[:, None]
    builder.add(cloth, Mesh(lean, sack.normals, sack.uv, sack.faces))
    return builder.model("bean bag", "beanbag", main=cloth)


def futon(rng: RandomStream, palette: Palette) -> Model:
    """A slim sofa bed on a wooden or metal frame."""
    builder = ModelBuilder()
    cloth = fabric(palette.upholstery_hue)
    frame = BLACK_METAL if rng.chance(0.4) else palette.furniture_wood(rng)
    wide = rng.uniform(1.8, 2.0)
    builder.add(
        cloth, cushion(wide - 0.14, 0.72, 0.16, radius=0.06, puff=0.01, flats=3, at=(0, 0.06, 0.28))
    )
    pad = cushion(wide - 0.14, 0.56, 0.15, radius=0.06, puff=0.015, flats=3).turned(90, "x")
    builder.add(cloth, pad.moved(0, 0.07, 0.28).turned(14, "x").moved(0, -0.31, 0.36))
    for s in (-1.0, 1.0):
        x = s * (wide / 2 - 0.03)
        builder.add(
            frame,
            box(0.05, 0.05, 0.56, at=(x, 0.38, 0), bevel=0.005).swapped_uv(),
            box(0.05, 0.05, 0.6, at=(x, -0.36, 0), bevel=0.005).swapped_uv(),
            box(0.06, 0.84, 0.03, at=(x, 0.01, 0.56), bevel=0.005),
            box(0.03, 0.7, 0.05, at=(x, 0.01, 0.24)),
        )
    builder.add(frame, box(wide - 0.1, 0.03, 0.08, at=(0, 0.38, 0.22)))
    return builder.model("sofa", "futon", "couch", main=cloth)
