"""Models of chairs."""

import math

import numpy as np

from hypernav.houses.materials import BLACK_METAL, CHROME, Palette, fabric, leather, plastic
from hypernav.houses.modelling.joinery import four_legs, square_bar
from hypernav.houses.modelling.mesh import Finish, Mesh, join
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, cushion
from hypernav.houses.modelling.surfaces import arc, cylinder, sheet
from hypernav.houses.modelling.tubes import rod, tube
from hypernav.houses.random_stream import RandomStream

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
    builder.add(
        seat,
        cushion(
            wide,
            deep + 0.01,
            0.035 if seat is frame else 0.06,
            radius=0.016,
            at=(0, 0.01, SEAT_M - 0.025),
        ),
    )
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
                builder.add(
                    legs,
                    rod(
                        (sx * 0.22, sy * 0.21, 0.0),
                        (sx * 0.12, sy * 0.11, SEAT_M - 0.01),
                        0.012,
                        end_radius=0.02,
                    ),
                )
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
            builder.add(
                BLACK_METAL,
                tube(
                    [
                        (s * 0.2, 0.02, seat - 0.07),
                        (s * 0.29, 0.02, seat - 0.04),
                        (s * 0.29, 0.0, seat + 0.2),
                    ],
                    0.016,
                ),
            )
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
