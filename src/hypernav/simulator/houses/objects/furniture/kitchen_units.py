"""Models of fitted kitchen units and large kitchen appliances."""

from functools import partial

from hypernav.simulator.houses.modelling.curves import cylinder, lathe, rod, rounded_outline
from hypernav.simulator.houses.modelling.joinery import front
from hypernav.simulator.houses.modelling.materials import (
    BLACK_GLASS,
    BLACK_METAL,
    CHROME,
    STEEL,
    WHITE_METAL,
    Palette,
    lacquer,
    plastic,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder, SupportSurface
from hypernav.simulator.houses.modelling.solids import box, panel, prism
from hypernav.simulator.houses.objects.furniture.sanitary import tap
from hypernav.simulator.houses.random_stream import RandomStream

COUNTER_M = 0.9
DEEP_M = 0.6
_GAP = Finish("", (0.2, 0.2, 0.21))


def refrigerator(rng: RandomStream, palette: Palette) -> Model:
    """A tall fridge-freezer, in one of three builds."""
    builder = ModelBuilder()
    body = rng.weighted(
        (
            (STEEL, 4.0),
            (WHITE_METAL, 4.0),
            (Finish("", (0.13, 0.13, 0.14), 1.0, "black", "metal"), 1.0),
        )
    )
    style = rng.choice(("top freezer", "bottom freezer", "french door"))
    wide = 0.9 if style == "french door" else rng.uniform(0.6, 0.72)
    deep, high = 0.68, rng.uniform(1.66, 1.82)
    door = 0.06
    builder.add(
        body.tinted(0.93),
        box(wide, deep - door - 0.012, high, at=(0, -door / 2 - 0.006, 0.03), bevel=0.006),
    )
    builder.add(
        _GAP,
        box(wide - 0.02, 0.02, high - 0.03, at=(0, deep / 2 - door - 0.008, 0.05)),
        box(wide - 0.06, deep - 0.1, 0.05, at=(0, 0, 0)),
    )
    y, top = deep / 2 - door / 2, high + 0.03
    split = 0.67 if style == "top freezer" else 0.36
    cut = 0.06 + (high - 0.03) * split
    grip = CHROME if body is not WHITE_METAL or rng.chance(0.4) else body.tinted(0.8)
    if style == "french door":
        half = wide / 2
        for s in (-1.0, 1.0):
            part = box(
                half - 0.004, door, top - cut - 0.01, at=(s * half / 2, y, cut + 0.008), bevel=0.012
            )
            builder.add(body, part)
            _grip(
                builder, grip, (s * 0.045, deep / 2, cut + 0.12), (s * 0.045, deep / 2, top - 0.16)
            )
        for k in range(2):
            each = (cut - 0.06) / 2
            builder.add(
                body, box(wide, door, each - 0.008, at=(0, y, 0.06 + k * each), bevel=0.012)
            )
            z = 0.06 + (k + 1) * each - 0.07
            _grip(builder, grip, (-wide * 0.36, deep / 2, z), (wide * 0.36, deep / 2, z))
        if rng.chance(0.5):
            builder.add(
                BLACK_GLASS,
                box(0.2, 0.008, 0.3, at=(-half / 2, deep / 2 + 0.002, top - 0.62), bevel=0.003),
            )
            builder.add(
                _GAP.tinted(1.4),
                box(0.15, 0.01, 0.14, at=(-half / 2, deep / 2 + 0.004, top - 0.58)),
            )
    else:
        side = rng.choice((-1.0, 1.0)) * (wide / 2 - 0.05)
        builder.add(
            body,
            box(wide, door, cut - 0.068, at=(0, y, 0.06), bevel=0.014),
            box(wide, door, top - cut - 0.008, at=(0, y, cut + 0.008), bevel=0.014),
        )
        low = cut - 0.1 if split > 0.5 else cut - 0.12
        _grip(builder, grip, (side, deep / 2, max(low - 0.55, 0.2)), (side, deep / 2, low))
        _grip(
            builder,
            grip,
            (side, deep / 2, cut + 0.08),
            (side, deep / 2, min(cut + 0.5, top - 0.08)),
        )
        if rng.chance(0.4):
            _magnets(builder, rng, wide, deep / 2, cut + 0.1, top - 0.1, side)
    surface = SupportSurface(
        -wide / 2 + 0.06, -deep / 2 + 0.08, wide / 2 - 0.06, deep / 2 - 0.12, top, 0.4
    )
    return builder.model(
        "refrigerator", "fridge", style + " refrigerator", main=body, supports=(surface,)
    )


def _grip(
    builder: ModelBuilder,
    finish: Finish,
    start: tuple[float, float, float],
    end: tuple[float, float, float],
) -> None:
    """A bar before a door, on two posts."""
    off = 0.045
    builder.add(
        finish, rod((start[0], start[1] + off, start[2]), (end[0], end[1] + off, end[2]), 0.012)
    )
    for t in (0.08, 0.92):
        p = [start[k] + (end[k] - start[k]) * t for k in range(3)]
        builder.add(finish, rod((p[0], p[1], p[2]), (p[0], p[1] + off, p[2]), 0.009, sides=6))


def _magnets(
    builder: ModelBuilder,
    rng: RandomStream,
    wide: float,
    y: float,
    low: float,
    high: float,
    grip_x: float,
) -> None:
    for _ in range(rng.integer(2, 5)):
        x = rng.uniform(-0.2, 0.14) * wide - (0.1 if grip_x > 0 else -0.1)
        paper = rng.choice(
            (
                Finish("label 1", (1, 1, 1)),
                Finish("", (0.95, 0.94, 0.85)),
                Finish("painting 4", (1, 1, 1)),
            )
        )
        part = panel(
            rng.uniform(0.08, 0.15),
            rng.uniform(0.09, 0.16),
            at=(x, y + 0.003, rng.uniform(low, high - 0.2)),
        )
        builder.add(paper, part)


def oven(rng: RandomStream, palette: Palette) -> Model:
    """A range: hob above, oven with a window below."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, WHITE_METAL, Finish("", (0.13, 0.13, 0.14), 1.0, "black", "metal")))
    wide, y = 0.6, DEEP_M / 2
    builder.add(body, box(wide, DEEP_M - 0.04, COUNTER_M - 0.05, at=(0, -0.02, 0.04), bevel=0.004))
    builder.add(_GAP, box(wide - 0.04, DEEP_M - 0.1, 0.05, at=(0, 0, 0)))
    builder.add(
        body,
        box(wide - 0.01, 0.035, 0.5, at=(0, y - 0.0225, 0.24), bevel=0.006),
        box(wide - 0.01, 0.03, 0.15, at=(0, y - 0.025, 0.08), bevel=0.006),
        box(wide - 0.01, 0.04, 0.11, at=(0, y - 0.025, 0.75), bevel=0.006),
    )
    builder.add(BLACK_GLASS, box(wide - 0.13, 0.006, 0.28, at=(0, y - 0.004, 0.31), bevel=0.003))
    _grip(builder, CHROME, (-0.23, y - 0.005, 0.69), (0.23, y - 0.005, 0.69))
    for k in range(5):
        knob = cylinder(0.02, 0.026, sides=12, top_radius=0.016, bevel=0.004).turned(-90, "x")
        builder.add(
            BLACK_METAL if body is not BLACK_METAL else CHROME,
            knob.moved((k - 2) * 0.1, y - 0.006, 0.805),
        )
    builder.add(
        BLACK_GLASS, box(wide, DEEP_M - 0.02, 0.014, at=(0, -0.01, COUNTER_M - 0.014), bevel=0.004)
    )
    for x, dy, r in (
        (-0.15, 0.12, 0.09),
        (0.15, 0.12, 0.07),
        (-0.15, -0.14, 0.07),
        (0.15, -0.14, 0.09),
    ):
        ring = lathe([(r - 0.006, 0.0), (r - 0.004, 0.003), (r, 0.003), (r + 0.002, 0.0)], sides=24)
        builder.add(plastic("gray"), ring.moved(x, dy, COUNTER_M))
        if body is WHITE_METAL or body is STEEL:
            for turn in (0, 90):
                builder.add(
                    BLACK_METAL, box(2 * r, 0.012, 0.02).turned(turn).moved(x, dy, COUNTER_M)
                )
    return builder.model(
        "oven",
        "stove",
        "cooker",
        "range",
        main=body,
        supports=(
            SupportSurface(-0.24, -0.24, -0.04, -0.04, COUNTER_M + 0.02),
            SupportSurface(0.04, 0.02, 0.24, 0.22, COUNTER_M + 0.02),
        ),
    )


def dishwasher(rng: RandomStream, palette: Palette) -> Model:
    """A dishwasher under its piece of worktop."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, WHITE_METAL))
    builder.add(body.tinted(0.9), box(0.6, DEEP_M - 0.06, COUNTER_M - 0.14, at=(0, -0.03, 0.1)))
    y = DEEP_M / 2 - 0.06
    builder.add(
        body,
        box(0.594, 0.04, 0.64, at=(0, y + 0.02, 0.11), bevel=0.006),
        box(0.594, 0.045, 0.1, at=(0, y + 0.02, 0.755), bevel=0.006),
    )
    builder.add(BLACK_GLASS, box(0.16, 0.004, 0.03, at=(0.16, y + 0.043, 0.79)))
    for k in range(3):
        builder.add(
            _GAP,
            cylinder(0.008, 0.004, sides=10)
            .turned(-90, "x")
            .moved(-0.2 + 0.04 * k, y + 0.0425, 0.805),
        )
    _grip(builder, CHROME, (-0.22, y + 0.04, 0.7), (0.22, y + 0.04, 0.7))
    builder.add(_GAP, box(0.6, DEEP_M - 0.12, 0.1, at=(0, -0.04, 0)))
    builder.add(
        worktop(rng.fork("top"), palette),
        box(0.6, DEEP_M, 0.04, at=(0, 0, COUNTER_M - 0.04), bevel=0.004),
    )
    surface = SupportSurface(-0.27, -0.25, 0.27, 0.25, COUNTER_M)
    return builder.model("dishwasher", "dish washer", main=body, supports=(surface,))


def range_hood(rng: RandomStream, palette: Palette) -> Model:
    """An extractor above the stove."""
    builder = ModelBuilder()
    body = rng.choice((STEEL, BLACK_METAL))
    hood = box(0.6, 0.48, 0.05, bevel=0.004)
    builder.add(
        body,
        hood,
        prism([(-0.14, -0.12), (0.14, -0.12), (0.14, 0.12), (-0.14, 0.12)], 0.55, z=0.22).moved(
            0, -0.11, 0
        ),
    )
    taper = box(0.58, 0.46, 0.18)
    upper = taper.positions[:, 2] > 0.1
    taper.positions[upper, 0] *= 0.5
    taper.positions[upper, 1] = taper.positions[upper, 1] * 0.52 - 0.1
    builder.add(body, taper.moved(0, 0, 0.05))
    return builder.model("range hood", "extractor hood", "cooker hood", main=body)


def worktop(rng: RandomStream, palette: Palette) -> Finish:
    """Finish of stone or wood for all worktops of a kitchen."""
    return rng.choice(
        (
            Finish("granite", (0.3, 0.3, 0.31), 0.4, "dark gray", "stone"),
            Finish("granite", (0.75, 0.72, 0.68), 0.4, "light gray", "stone"),
            Finish("marble", (0.93, 0.92, 0.9), 1.0, "white", "marble"),
            palette.furniture_wood(rng),
        )
    )


def base_cabinet(
    builder: ModelBuilder,
    rng: RandomStream,
    body: Finish,
    metal: Finish,
    wide: float,
    *,
    drawers: bool = False,
) -> None:
    """A floor cabinet without its worktop."""
    fit = partial(front, builder, body, metal)
    high = COUNTER_M - 0.04
    builder.add(body, box(wide, DEEP_M - 0.04, high - 0.1, at=(0.0, -0.02, 0.1), bevel=0.002))
    builder.add(_GAP, box(wide, DEEP_M - 0.12, 0.1, at=(0.0, -0.04, 0)))
    y = DEEP_M / 2 - 0.04
    if drawers:
        for z, h in ((0.11, 0.28), (0.39, 0.26), (0.65, 0.2)):
            fit(wide, h, at=(0.0, y, z))
        return
    doors = 1 if wide < 0.5 else 2
    for k in range(doors):
        x = (k + 0.5 - doors / 2) * wide / doors
        side = 1.0 if k == 0 else -1.0
        fit(wide / doors, high - 0.115, at=(x, y, 0.11), upright=True, side=side)


def kitchen_cabinet(
    rng: RandomStream, palette: Palette, wide: float = 0.6, top: Finish | None = None
) -> Model:
    """A floor cabinet with worktop."""
    builder = ModelBuilder()
    body = lacquer(palette.paint_hue)
    base_cabinet(builder, rng, body, palette.metal, wide, drawers=rng.chance(0.35))
    builder.add(
        top or worktop(rng, palette),
        box(wide, DEEP_M, 0.04, at=(0, 0, COUNTER_M - 0.04), bevel=0.004),
    )
    surface = SupportSurface(-wide / 2 + 0.02, -0.27, wide / 2 - 0.02, 0.25, COUNTER_M, 0.45)
    return builder.model(
        "kitchen cabinet",
        "kitchen counter",
        "counter",
        "base cabinet",
        main=body,
        supports=(surface,),
    )


def kitchen_sink(rng: RandomStream, palette: Palette, top: Finish | None = None) -> Model:
    """A cabinet with a steel sink let into its worktop."""
    builder = ModelBuilder()
    body = lacquer(palette.paint_hue)
    wide = 0.8
    base_cabinet(builder, rng, body, palette.metal, wide)
    stone = top or worktop(rng, palette)
    x0, hole_x, hole_y = -0.14, 0.42, 0.38
    z = COUNTER_M - 0.04
    builder.add(
        stone,
        box(
            wide / 2 - (x0 + hole_x / 2), DEEP_M, 0.04, at=((wide / 2 + x0 + hole_x / 2) / 2, 0, z)
        ),
        box(x0 - hole_x / 2 + wide / 2, DEEP_M, 0.04, at=((x0 - hole_x / 2 - wide / 2) / 2, 0, z)),
        box(hole_x, (DEEP_M - hole_y) / 2, 0.04, at=(x0, (DEEP_M + hole_y) / 4, z)),
        box(hole_x, (DEEP_M - hole_y) / 2, 0.04, at=(x0, -(DEEP_M + hole_y) / 4, z)),
    )
    inner = STEEL.tinted(0.85)
    for s in (-1.0, 1.0):
        builder.add(
            inner,
            box(0.012, hole_y, 0.18, at=(x0 + s * hole_x / 2, 0, COUNTER_M - 0.177)),
            box(hole_x, 0.012, 0.18, at=(x0, s * hole_y / 2, COUNTER_M - 0.177)),
        )
    builder.add(inner.tinted(0.8), box(hole_x, hole_y, 0.01, at=(x0, 0, COUNTER_M - 0.18)))
    rim = rounded_outline(hole_x + 0.05, hole_y + 0.05, 0.03)
    for a, b in zip(rim, [*rim[1:], rim[0]], strict=True):
        builder.add(
            STEEL, rod((a[0] + x0, a[1], COUNTER_M), (b[0] + x0, b[1], COUNTER_M), 0.006, sides=6)
        )
    builder.add(
        STEEL,
        box(0.3, 0.4, 0.008, at=(0.24, 0, COUNTER_M), bevel=0.003),
        *[box(0.26, 0.012, 0.006, at=(0.24, (k - 3) * 0.05, COUNTER_M + 0.008)) for k in range(7)],
    )
    builder.add(CHROME, tap(0.2, 0.18).moved(x0, -0.24, COUNTER_M))
    return builder.model("sink", "kitchen sink", main=STEEL)


def wall_cabinet(rng: RandomStream, palette: Palette, wide: float = 0.8) -> Model:
    """A cupboard that hangs above a worktop."""
    builder = ModelBuilder()
    body = lacquer(palette.paint_hue)
    fit = partial(front, builder, body, palette.metal)
    deep, high = 0.34, 0.68
    builder.add(body, box(wide, deep - 0.02, high, at=(0, -0.01, 0), bevel=0.002))
    doors = 1 if wide < 0.5 else 2
    for k in range(doors):
        x = (k + 0.5 - doors / 2) * wide / doors
        fit(
            wide / doors,
            high,
            at=(x, deep / 2 - 0.02, 0),
            grip="knob" if rng.chance(0.3) else "bar",
            upright=True,
            side=0.75 if k == 0 else -0.75,
        )
    return builder.model("kitchen cabinet", "wall cabinet", "cupboard", main=body)
