"""Models of seats: chairs, sofas, armchairs, bean bags, benches, stools."""

import math

import numpy as np

from hypernav.simulator.houses.modelling.curves import (
    arc,
    cylinder,
    lathe,
    rod,
    rounded_outline,
    sheet,
    tube,
)
from hypernav.simulator.houses.modelling.joinery import four_legs, square_bar
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CHROME,
    Palette,
    fabric,
    lacquer,
    leather,
    plastic,
)
from hypernav.simulator.houses.modelling.model import Finish, Mesh, Model, ModelBuilder, join
from hypernav.simulator.houses.modelling.solids import box, cushion, prism
from hypernav.simulator.houses.random_stream import RandomStream

SEAT_M = 0.455


def dining_chair(rng: RandomStream, palette: Palette) -> Model:
    """A chair without arms, in one of four styles."""
    style = rng.choice(("slats", "ladder", "upholstered", "shell"))
    if style == "shell":
        return _shell_chair(rng, palette)
    frame = palette.furniture_wood(rng)
    builder = ModelBuilder()
    wide, deep, top = rng.uniform(0.43, 0.47), rng.uniform(0.42, 0.46), rng.uniform(0.86, 0.98)
    if style == "upholstered":
        return _upholstered_chair(builder, rng, palette, frame, wide, deep, top)
    post, lean = 0.036, 0.075
    back_y, front_y = -deep / 2 + post / 2, deep / 2 - post / 2
    for s in (-1.0, 1.0):
        x = s * (wide / 2 - post / 2)
        builder.add(
            frame, square_bar((x, front_y, 0.0), (x, front_y, SEAT_M - 0.02), post * 0.75, post)
        )
        builder.add(
            frame, square_bar((x, back_y - 0.03, 0.0), (x, back_y, SEAT_M), post * 0.75, post)
        )
        builder.add(
            frame, square_bar((x, back_y, SEAT_M), (x, back_y - lean, top), post, post * 0.8)
        )
        builder.add(frame, box(0.02, deep - 2 * post, 0.05, at=(x, 0, SEAT_M - 0.07)))
        builder.add(frame, box(0.018, deep - 2 * post + 0.02, 0.025, at=(x, -0.01, 0.17)))
    for y in (front_y, back_y):
        builder.add(frame, box(wide - 2 * post, 0.02, 0.05, at=(0, y, SEAT_M - 0.07)))
    seat = fabric(palette.upholstery_hue) if rng.chance(0.4) else frame
    at = (0, 0.01, SEAT_M - 0.025)
    part = cushion(wide, deep + 0.01, 0.035 if seat is frame else 0.06, radius=0.016, at=at)
    builder.add(seat, part)
    _wooden_back(builder, frame, style, wide - post, back_y, lean, top, rng)
    return builder.model("chair", "dining chair", "wooden chair", main=frame)


def _wooden_back(
    builder: ModelBuilder,
    frame: Finish,
    style: str,
    wide: float,
    y: float,
    lean: float,
    top: float,
    rng: RandomStream,
) -> None:
    """Slats or rungs between the back posts, which lean back by ``lean`` over their height."""
    rise = top - SEAT_M

    def at_height(z: float) -> float:
        return y - lean * (z - SEAT_M) / rise

    tilt = math.degrees(math.atan2(lean, rise))
    rail = box(wide, 0.024, 0.075, bevel=0.006).turned(tilt, "x")
    builder.add(frame, rail.moved(0, at_height(top - 0.075), top - 0.075))
    if style == "ladder":
        for k in range(3):
            z = SEAT_M + 0.1 + k * (rise - 0.2) / 3
            rung = box(wide - 0.02, 0.018, 0.05, bevel=0.005).turned(tilt, "x")
            builder.add(frame, rung.moved(0, at_height(z), z))
        return
    low = SEAT_M + 0.1
    builder.add(frame, box(wide - 0.02, 0.02, 0.03, at=(0, at_height(low), low)))
    count = rng.integer(4, 6)
    for k in range(count):
        x = (k + 0.5 - count / 2) * (wide - 0.03) / count
        builder.add(
            frame,
            square_bar((x, at_height(low), low), (x, at_height(top - 0.07), top - 0.07), 0.016),
        )


def _upholstered_chair(
    builder: ModelBuilder,
    rng: RandomStream,
    palette: Palette,
    frame: Finish,
    wide: float,
    deep: float,
    top: float,
) -> Model:
    cloth = leather(palette.upholstery_hue) if rng.chance(0.3) else fabric(palette.upholstery_hue)
    builder.add(frame, *four_legs(wide - 0.02, deep - 0.02, SEAT_M - 0.06, thick=0.04, taper=0.65))
    builder.add(
        cloth,
        cushion(wide, deep, 0.1, radius=0.035, puff=0.012, flats=3, at=(0, 0, SEAT_M - 0.075)),
    )
    back = cushion(wide - 0.01, top - SEAT_M + 0.05, 0.07, radius=0.03, puff=0.015, flats=3)
    back = back.turned(90, "x").moved(0, 0.035, (top - SEAT_M + 0.05) / 2).turned(9, "x")
    builder.add(cloth, back.moved(0, -deep / 2 + 0.03, SEAT_M - 0.05))
    return builder.model("chair", "dining chair", "upholstered chair", main=cloth)


def _shell_chair(rng: RandomStream, palette: Palette) -> Model:
    """A moulded plastic seat on wooden or metal legs."""
    builder = ModelBuilder()
    shell = plastic(rng.choice(("white", "black", "gray", palette.accent_hue, "teal", "red")))
    builder.add(shell, _moulded_seat(0.46, 0.44, 0.38).moved(0, 0, SEAT_M))
    if rng.chance(0.6):
        legs = palette.furniture_wood(rng)
        for sx in (-1.0, 1.0):
            for sy in (-1.0, 1.0):
                part = rod(
                    (sx * 0.22, sy * 0.21, 0.0),
                    (sx * 0.12, sy * 0.11, SEAT_M - 0.01),
                    0.012,
                    end_radius=0.02,
                )
                builder.add(legs, part)
    else:
        legs = rng.choice((BLACK_METAL, CHROME))
        for s in (-1.0, 1.0):
            path = [
                (s * 0.2, 0.2, 0.0),
                (s * 0.15, 0.14, SEAT_M - 0.02),
                (s * 0.15, -0.14, SEAT_M - 0.02),
                (s * 0.2, -0.21, 0.0),
            ]
            builder.add(legs, tube(path, 0.01))
    return builder.model("chair", "dining chair", "plastic chair", main=shell)


def _moulded_seat(wide: float, deep: float, high: float, thick: float = 0.012) -> Mesh:
    """A curved shell that runs from the seat's front lip up the back; its seat is at z = 0."""
    line = [
        (deep / 2, -0.03),
        (deep / 2 - 0.02, 0.0),
        (deep * 0.25, -0.008),
        (0.0, -0.012),
        (-deep * 0.3, 0.0),
        (-deep * 0.42, 0.045),
        (-deep * 0.48, 0.13),
        (-deep * 0.52, 0.25),
        (-deep * 0.56, high - 0.03),
        (-deep * 0.565, high),
    ]
    nu = 9
    across = np.linspace(-1.0, 1.0, nu)[:, None]
    y = np.array([p[0] for p in line])[None, :]
    z = np.array([p[1] for p in line])[None, :]
    width = wide / 2 * np.array([0.82, 0.9, 1.0, 1.0, 0.98, 0.96, 0.95, 0.92, 0.8, 0.66])[None, :]
    curl = across**2
    backness = np.clip(z / high, 0.0, 1.0)
    points = np.stack(
        [
            across * width,
            y + curl * (0.05 * backness) + 0 * across,
            z + curl * 0.045 * (1.0 - backness) + 0 * across,
        ],
        axis=-1,
    )
    upper = sheet(points)
    shift = upper.normals * -thick
    lower = Mesh(upper.positions + shift, -upper.normals, upper.uv, upper.faces[:, ::-1])
    return join([upper, lower])


def office_chair(rng: RandomStream, palette: Palette) -> Model:
    """A swivel chair on five castors."""
    builder = ModelBuilder()
    cloth = rng.choice(
        (fabric("black"), fabric("dark gray"), leather("black"), fabric(palette.upholstery_hue))
    )
    base = BLACK_METAL if rng.chance(0.6) else CHROME
    seat = 0.48
    for k in range(5):
        a = math.radians(72 * k + 90)
        end = (0.3 * math.cos(a), 0.3 * math.sin(a), 0.07)
        builder.add(base, rod((0, 0, 0.11), end, 0.022, end_radius=0.014))
        wheel = (
            cylinder(0.028, 0.045, sides=10)
            .moved(0, 0, -0.0225)
            .turned(90, "x")
            .turned(72 * k, "z")
        )
        builder.add(BLACK_METAL, wheel.moved(end[0], end[1], 0.028))
    builder.add(
        BLACK_METAL,
        cylinder(0.032, 0.2, at=(0, 0, 0.09)),
        cylinder(0.02, 0.16, at=(0, 0, 0.28)),
        box(0.2, 0.24, 0.04, at=(0, 0, seat - 0.1), bevel=0.01),
    )
    builder.add(
        cloth,
        cushion(0.5, 0.49, 0.1, radius=0.045, puff=0.015, flats=3, at=(0, 0.01, seat - 0.065)),
    )
    tall = rng.uniform(0.5, 0.64)
    back = cushion(0.46, tall, 0.08, radius=0.038, puff=0.012, flats=3).turned(90, "x")
    builder.add(cloth, back.moved(0, 0.04, tall / 2).turned(8, "x").moved(0, -0.25, seat + 0.08))
    builder.add(
        BLACK_METAL,
        tube([(0, -0.1, seat - 0.07), (0, -0.28, seat - 0.06), (0, -0.31, seat + 0.25)], 0.02),
    )
    if rng.chance(0.75):
        for s in (-1.0, 1.0):
            part = tube(
                [
                    (s * 0.2, 0.02, seat - 0.07),
                    (s * 0.29, 0.02, seat - 0.04),
                    (s * 0.29, 0.0, seat + 0.2),
                ],
                0.016,
            )
            builder.add(BLACK_METAL, part)
            builder.add(
                plastic("black"),
                cushion(0.07, 0.26, 0.035, radius=0.015, at=(s * 0.29, 0.01, seat + 0.19)),
            )
    return builder.model("chair", "office chair", "desk chair", "swivel chair", main=cloth)


def rocking_chair(rng: RandomStream, palette: Palette) -> Model:
    """A wooden armchair on two runners."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    for s in (-1.0, 1.0):
        x = s * 0.25
        runner = [(x, y, z + 1.118) for y, z in arc((0.0, 0.0), 1.1, 250, 290, 12)]
        builder.add(frame, tube([(px, py, pz) for px, py, pz in runner], 0.018))
        builder.add(
            frame,
            rod((x, 0.22, 0.04), (x, 0.22, 0.64), 0.018),
            rod((x, -0.22, 0.04), (x, -0.27, 1.05), 0.018),
        )
        builder.add(frame, box(0.055, 0.5, 0.022, at=(x, 0.0, 0.63), bevel=0.006))
        builder.add(frame, rod((x, 0.22, 0.36), (x, -0.23, 0.34), 0.012))
    for z, y in ((0.3, 0.22), (0.3, -0.23)):
        builder.add(frame, rod((-0.25, y, z), (0.25, y, z), 0.013))
    builder.add(
        fabric(palette.upholstery_hue),
        cushion(0.5, 0.48, 0.07, radius=0.03, puff=0.015, flats=3, at=(0, 0, 0.36)),
    )
    builder.add(frame, box(0.5, 0.024, 0.09, at=(0, -0.265, 0.95), bevel=0.008))
    for k in range(6):
        x = (k - 2.5) * 0.075
        builder.add(frame, rod((x, -0.235, 0.36), (x, -0.268, 0.97), 0.009, sides=6))
    return builder.model("rocking chair", "wooden rocking chair", main=frame)


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


def throw_pillow(x: float) -> Mesh:
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
    return join([sheet(upper), sheet(lower[::-1])])


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
    part = cushion(
        wide - 0.01, back_thick, top - 0.1 - base_z, radius=0.06, rounds=3, at=(0, back_y, base_z)
    )
    builder.add(cloth, part)
    _arms(builder, rng, cloth, wide, deep, arm, arm_top, base_z)
    # Seat cushions
    seat_deep = deep - back_thick + 0.02
    each = inner / seats
    for k in range(seats):
        x = (k + 0.5) * each - inner / 2
        long = chaise != 0.0 and (k == (0 if chaise < 0 else seats - 1))
        extra = 0.68 if long else 0.0
        part = cushion(
            each - 0.008,
            seat_deep + extra,
            0.17,
            radius=0.045,
            puff=0.018,
            flats=3,
            rounds=3,
            at=(x, deep / 2 - seat_deep / 2 + extra / 2, seat - 0.17),
        )
        builder.add(cloth, part)
        high = top - seat + 0.03
        pad = cushion(each - 0.012, high, 0.17, radius=0.065, puff=0.025, flats=3, rounds=3).turned(
            90, "x"
        )
        builder.add(
            cloth,
            pad.moved(0, 0.085, high / 2).turned(10, "x").moved(x, -deep / 2 + 0.17, seat - 0.02),
        )
        if long:
            at = (x, deep / 2 + extra / 2 - 0.03, base_z)
            part = cushion(each + arm * 0.0, extra, seat - 0.15 - base_z, radius=0.02, at=at)
            builder.add(cloth, part)
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
    profile = [
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
    ]
    sack = lathe(profile, sides=24, crease_deg=80)
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


def stool(rng: RandomStream, palette: Palette) -> Model:
    """A low stool with three or four legs and a round seat."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    high, radius = 0.45, rng.uniform(0.15, 0.18)
    seat = fabric(palette.upholstery_hue) if rng.chance(0.4) else frame
    builder.add(seat, cylinder(radius, 0.04, at=(0, 0, high - 0.04), sides=24, bevel=0.008))
    count = rng.integer(3, 4)
    for k in range(count):
        a = math.radians(360 / count * k + 45)
        c, s = math.cos(a), math.sin(a)
        part = rod(
            (c * radius, s * radius, 0),
            (c * radius * 0.62, s * radius * 0.62, high - 0.03),
            0.014,
            end_radius=0.018,
        )
        builder.add(frame, part)
    return builder.model("stool", main=seat, attributes=("round",))


def bench_seat(rng: RandomStream, palette: Palette) -> Model:
    """A long seat without a back."""
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    long = rng.uniform(0.95, 1.25, 0.05)
    if rng.chance(0.5):
        cloth = fabric(palette.upholstery_hue)
        builder.add(
            cloth, cushion(long, 0.38, 0.09, radius=0.03, puff=0.01, flats=3, at=(0, 0, 0.37))
        )
        builder.add(frame, box(long - 0.04, 0.34, 0.05, at=(0, 0, 0.325)))
        builder.add(frame, *four_legs(long - 0.1, 0.32, 0.33, thick=0.045))
        return builder.model("bench", "upholstered bench", main=cloth)
    builder.add(
        frame,
        *[box(long, 0.115, 0.03, at=(0, (k - 1) * 0.125, 0.42), bevel=0.005) for k in range(3)],
    )
    for s in (-1.0, 1.0):
        builder.add(
            frame, box(0.04, 0.34, 0.42, at=(s * (long / 2 - 0.12), 0, 0), bevel=0.004).swapped_uv()
        )
    builder.add(frame, box(long - 0.24, 0.03, 0.06, at=(0, 0, 0.2)))
    return builder.model("bench", "wooden bench", main=frame)


def ottoman(rng: RandomStream, palette: Palette) -> Model:
    """A padded footrest or pouf."""
    builder = ModelBuilder()
    cloth = leather(palette.upholstery_hue) if rng.chance(0.3) else fabric(palette.upholstery_hue)
    if rng.chance(0.5):
        builder.add(cloth, cylinder(0.25, 0.38, sides=28, bevel=0.05))
        return builder.model("ottoman", "pouf", "footstool", main=cloth, attributes=("round",))
    builder.add(cloth, cushion(0.6, 0.45, 0.32, radius=0.05, puff=0.015, flats=3, at=(0, 0, 0.08)))
    builder.add(palette.furniture_wood(rng), *four_legs(0.56, 0.41, 0.09, thick=0.04))
    return builder.model("ottoman", "footstool", main=cloth, attributes=("square",))


def step_stool(rng: RandomStream, palette: Palette) -> Model:
    """Two steps."""
    builder = ModelBuilder()
    frame = lacquer(palette.paint_hue) if rng.chance(0.5) else palette.furniture_wood(rng)
    outline = rounded_outline(0.4, 0.2, 0.02)
    for y, z in ((0.1, 0.21), (-0.1, 0.43)):
        builder.add(frame, prism(outline, 0.025, z=z).moved(0, y, 0))
        for s in (-1.0, 1.0):
            builder.add(frame, box(0.022, 0.16, z, at=(s * 0.17, y, 0)).swapped_uv())
    return builder.model("step stool", "step ladder", main=frame)
