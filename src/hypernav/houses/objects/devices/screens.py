"""Models of televisions and computers."""

from hypernav.houses.materials import BLACK_METAL, STEEL, Palette, image_finish, plastic
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder
from hypernav.houses.modelling.solids import box, panel, tile
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.random_stream import RandomStream

_FRAME = Finish("", (0.045, 0.045, 0.05), 1.0, "black", "plastic")


def _screen(
    builder: ModelBuilder, rng: RandomStream, wide: float, high: float, z: float, y: float, key: str
) -> None:
    rim = 0.014
    builder.add(_FRAME, box(wide, 0.035, high, at=(0, y - 0.0175, z), bevel=0.004))
    builder.add(
        image_finish(key),
        panel(wide - 2 * rim, high - 2.4 * rim, at=(0, y + 0.0012, z + 1.4 * rim)),
    )


def _programme(rng: RandomStream) -> str:
    return f"screen show {rng.integer(0, 11)}" if rng.chance(0.45) else "screen off"


def tv(rng: RandomStream, palette: Palette) -> Model:
    """A flat television on feet."""
    del palette
    builder = ModelBuilder()
    wide = rng.choice((0.97, 1.1, 1.1, 1.23, 1.3))
    high = wide * 0.58
    _screen(builder, rng, wide, high, 0.06, 0.0, _programme(rng))
    builder.add(_FRAME, box(wide * 0.6, 0.05, high * 0.5, at=(0, -0.045, 0.12), bevel=0.02))
    if rng.chance(0.5):
        builder.add(
            BLACK_METAL,
            box(wide * 0.4, 0.22, 0.014, at=(0, -0.02, 0), bevel=0.004),
            box(0.1, 0.03, 0.1, at=(0, -0.03, 0)),
        )
    else:
        for s in (-1.0, 1.0):
            x = s * wide * 0.36
            for y in (0.09, -0.13):
                builder.add(BLACK_METAL, rod((x, y, 0.006), (x, -0.02, 0.07), 0.007, sides=6))
    return builder.model("tv", "television", "flat screen tv", main=_FRAME)


def wall_tv(rng: RandomStream, palette: Palette) -> Model:
    """A flat television on a wall mount; its back is the wall."""
    del palette
    builder = ModelBuilder()
    wide = rng.choice((1.1, 1.23, 1.36, 1.45))
    high = wide * 0.575
    _screen(builder, rng, wide, high, 0.0, 0.0, _programme(rng))
    builder.add(BLACK_METAL, box(0.4, 0.04, 0.3, at=(0, -0.05, high / 2 - 0.15)))
    return builder.model("tv", "television", "flat screen tv", "wall tv", main=_FRAME)


def monitor(rng: RandomStream, palette: Palette) -> Model:
    """A computer monitor on its foot."""
    del palette
    builder = ModelBuilder()
    wide = rng.choice((0.5, 0.56, 0.62))
    _screen(
        builder,
        rng,
        wide,
        wide * 0.6,
        0.12,
        0.0,
        "screen desktop" if rng.chance(0.6) else "screen off",
    )
    builder.add(
        _FRAME,
        box(0.05, 0.03, 0.2, at=(0, -0.05, 0)),
        box(0.22, 0.18, 0.012, at=(0, -0.02, 0), bevel=0.004),
    )
    return builder.model("computer monitor", "monitor", "computer screen", main=_FRAME)


def laptop(rng: RandomStream, palette: Palette) -> Model:
    """An open laptop; its user sits in front (+y)."""
    del palette
    builder = ModelBuilder()
    body = STEEL if rng.chance(0.6) else plastic("dark gray")
    builder.add(body, box(0.34, 0.235, 0.016, at=(0, 0, 0), bevel=0.004))
    builder.add(image_finish("keyboard"), tile(0.3, 0.11, at=(0, -0.045, 0.0165)))
    builder.add(body.tinted(0.8), tile(0.1, 0.065, at=(0, 0.07, 0.0165)))
    lid = ModelBuilder()
    lid.add(body, box(0.34, 0.008, 0.225, bevel=0.003))
    lid.add(image_finish("screen desktop"), panel(0.325, 0.205, at=(0, 0.0045, 0.012)))
    for part in lid.parts:
        builder.add(part.finish, part.mesh.turned(16, "x").moved(0, -0.115, 0.012))
    return builder.model("laptop", "laptop computer", "notebook computer", main=body)


def keyboard(rng: RandomStream, palette: Palette) -> Model:
    """A computer keyboard."""
    del palette
    builder = ModelBuilder()
    body = plastic("black") if rng.chance(0.6) else plastic("white")
    builder.add(body, box(0.44, 0.145, 0.02, bevel=0.005))
    builder.add(image_finish("keyboard"), tile(0.42, 0.125, at=(0, 0, 0.0205)).turned(180))
    return builder.model("keyboard", "computer keyboard", main=body)
