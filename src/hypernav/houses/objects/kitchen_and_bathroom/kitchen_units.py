"""Models of fitted kitchen units."""

from hypernav.houses.materials import CHROME, STEEL, Palette, lacquer
from hypernav.houses.modelling.joinery import front
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box
from hypernav.houses.modelling.surfaces import rounded_outline
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.objects.kitchen_and_bathroom.appliances import worktop
from hypernav.houses.objects.kitchen_and_bathroom.sanitary import tap
from hypernav.houses.random_stream import RandomStream

COUNTER_M = 0.9
DEEP_M = 0.6
_GAP = Finish("", (0.2, 0.2, 0.21))


def base_cabinet(
    builder: ModelBuilder,
    rng: RandomStream,
    body: Finish,
    metal: Finish,
    wide: float,
    *,
    at_x: float = 0.0,
    drawers: bool = False,
    framed: bool = False,
) -> None:
    """A floor cabinet without its worktop, centred at ``at_x``."""
    high = COUNTER_M - 0.04
    builder.add(body, box(wide, DEEP_M - 0.04, high - 0.1, at=(at_x, -0.02, 0.1), bevel=0.002))
    builder.add(_GAP, box(wide, DEEP_M - 0.12, 0.1, at=(at_x, -0.04, 0)))
    y = DEEP_M / 2 - 0.04
    if drawers:
        for z, h in ((0.11, 0.28), (0.39, 0.26), (0.65, 0.2)):
            front(builder, body, metal, wide, h, at=(at_x, y, z), framed=framed)
        return
    doors = 1 if wide < 0.5 else 2
    for k in range(doors):
        x = at_x + (k + 0.5 - doors / 2) * wide / doors
        side = 1.0 if k == 0 else -1.0
        front(
            builder,
            body,
            metal,
            wide / doors,
            high - 0.115,
            at=(x, y, 0.11),
            upright=True,
            side=side,
            framed=framed,
        )
    del rng


def kitchen_cabinet(
    rng: RandomStream, palette: Palette, wide: float = 0.6, top: Finish | None = None
) -> Model:
    """A floor cabinet with worktop."""
    builder = ModelBuilder()
    body = lacquer(palette.paint_hue)
    base_cabinet(builder, rng, body, palette.metal, wide, drawers=rng.chance(0.35), framed=False)
    builder.add(
        top or worktop(rng, palette),
        box(wide, DEEP_M, 0.04, at=(0, 0, COUNTER_M - 0.04), bevel=0.004),
    )
    return builder.model(
        "kitchen cabinet",
        "kitchen counter",
        "counter",
        "base cabinet",
        main=body,
        supports=(SupportSurface(-wide / 2 + 0.02, -0.27, wide / 2 - 0.02, 0.25, COUNTER_M, 0.45),),
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
    deep, high = 0.34, 0.68
    builder.add(body, box(wide, deep - 0.02, high, at=(0, -0.01, 0), bevel=0.002))
    doors = 1 if wide < 0.5 else 2
    for k in range(doors):
        x = (k + 0.5 - doors / 2) * wide / doors
        front(
            builder,
            body,
            palette.metal,
            wide / doors,
            high,
            at=(x, deep / 2 - 0.02, 0),
            grip="knob" if rng.chance(0.3) else "bar",
            upright=True,
            side=0.75 if k == 0 else -0.75,
        )
    return builder.model("kitchen cabinet", "wall cabinet", "cupboard", main=body)
