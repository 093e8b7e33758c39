"""Models of beds with their bedding."""

import numpy as np

from hypernav.simulator.houses.modelling.curves import rod, sheet
from hypernav.simulator.houses.modelling.joinery import four_legs
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    BRASS,
    WHITE_METAL,
    Palette,
    fabric,
    lacquer,
    leather,
)
from hypernav.simulator.houses.modelling.model import Finish, Mesh, Model, ModelBuilder
from hypernav.simulator.houses.modelling.solids import box, cushion
from hypernav.simulator.houses.objects.furniture.seating import throw_pillow
from hypernav.simulator.houses.random_stream import RandomStream

LONG_M = 2.0


def bedding(rng: RandomStream, hue: str) -> Finish:
    """Finish of a duvet cover."""
    kind = rng.weighted((("fabric", 4.0), ("stripes", 1.5), ("plaid", 1.5), ("floral", 1.5)))
    return fabric(
        hue if kind != "floral" else "white", kind, {"fabric": 0.3, "floral": 0.8}.get(kind, 0.5)
    )


def double_bed(rng: RandomStream, palette: Palette) -> Model:
    """A bed for two."""
    wide = rng.choice((1.4, 1.6, 1.6, 1.8))
    size = {1.4: "double bed", 1.6: "queen bed", 1.8: "king bed"}[wide]
    return _bed(
        rng, palette, wide, ("double bed",) if size == "double bed" else ("double bed", size)
    )


def single_bed(rng: RandomStream, palette: Palette) -> Model:
    """A bed for one."""
    return _bed(rng, palette, rng.choice((0.9, 1.0)), ("single bed",))


def _bed(rng: RandomStream, palette: Palette, wide: float, synonyms: tuple[str, ...]) -> Model:
    builder = ModelBuilder()
    frame = palette.furniture_wood(rng)
    mattress_z, mattress = 0.3, 0.22
    top = mattress_z + mattress
    half = LONG_M / 2
    head = rng.choice(("panel", "upholstered", "slats", "metal"))
    for s in (-1.0, 1.0):
        builder.add(
            frame, box(0.03, LONG_M, 0.16, at=(s * (wide / 2 + 0.02), 0.0, 0.2), bevel=0.005)
        )
    builder.add(frame, box(wide + 0.07, 0.03, 0.2, at=(0, half + 0.015, 0.18), bevel=0.005))
    builder.add(frame, box(wide, LONG_M, 0.03, at=(0, 0, 0.27)))
    legs = four_legs(wide + 0.05, LONG_M + 0.02, 0.2, thick=0.06, round_=rng.chance(0.4))
    builder.add(frame, *legs)
    builder.add(
        fabric("white"), cushion(wide, LONG_M, mattress, radius=0.05, at=(0, 0, mattress_z))
    )
    _headboard(builder, rng, palette, frame, head, wide, -half - 0.03)
    cover = bedding(rng, palette.linen_hue)
    sheet_cloth = fabric("white") if palette.linen_hue != "white" else fabric("light gray")
    fold = rng.uniform(0.45, 0.6)
    drop = rng.uniform(0.14, 0.26)
    builder.add(cover, _duvet(rng, wide, -half + fold, half + 0.03, top, drop))
    builder.add(
        sheet_cloth,
        _duvet(rng, wide - 0.02, -half + fold - 0.12, -half + fold + 0.16, top + 0.014, drop),
    )
    _pillows(builder, rng, palette, wide, -half, top, sheet_cloth)
    if rng.chance(0.5):
        throw = fabric(palette.accent_hue, rng.choice(("coarse fabric", "plaid", "fabric")), 0.4)
        builder.add(
            throw, _duvet(rng, wide + 0.02, half - 0.65, half - 0.15, top + 0.018, drop + 0.05)
        )
    return builder.model("bed", *synonyms, main=cover, attributes=(frame.material,))


def _duvet(rng: RandomStream, wide: float, y0: float, y1: float, top: float, drop: float) -> Mesh:
    """A cover that lies over the mattress and hangs down on both sides and beyond its foot."""
    flat, hang = 17, 4
    x_flat = np.linspace(-wide / 2 - 0.015, wide / 2 + 0.015, flat)
    sag = np.linspace(0.0, 1.0, hang + 1)[1:]
    over = 0.03 + 0.02 * np.sqrt(sag)
    x = np.concatenate([(-wide / 2 - over)[::-1], x_flat, wide / 2 + over])
    z = np.concatenate([(-drop * sag)[::-1], np.zeros(flat), -drop * sag])
    rows = 15
    y = np.linspace(y0, y1, rows)
    grid = np.zeros((len(x), rows, 3))
    grid[..., 0], grid[..., 1] = x[:, None], y[None, :]
    loft = 0.035 * (1.0 - np.abs(x[:, None] / (wide / 2 + 0.05)) ** 4)
    creases = rng.array(len(x) + 1, rows + 1)
    rough = (creases[1:, 1:] + creases[:-1, 1:] + creases[1:, :-1] + creases[:-1, :-1]) / 4.0 - 0.5
    end = np.minimum((y - y0) / 0.06, 1.0)[None, :]
    grid[..., 2] = (
        top + z[:, None] + np.clip(loft, 0.0, None) * (0.35 + 0.65 * end) + 0.03 * rough + 0.006
    )
    grid[..., 0] += (
        np.sign(x)[:, None]
        * np.where(np.abs(z) > 0.01, 0.035 * np.abs(rough.T[0, 0]), 0.0)[:, None]
    )
    skirt = np.where(z < -0.01, -z / drop, 0.0)[:, None]
    grid[..., 0] += np.sign(x)[:, None] * skirt * 0.02 * np.sin(y * 21.0)[None, :]
    if y1 > LONG_M / 2:
        tail = grid[:, -1:, :].copy()
        steps = []
        for k in range(1, 4):
            row = tail.copy()
            row[..., 1] += 0.012 * k
            row[..., 2] = np.minimum(row[..., 2], top + 0.03) - drop * k / 3
            row[..., 2] = np.maximum(row[..., 2], 0.16)
            steps.append(row)
        grid = np.concatenate([grid, *steps], axis=1)
    upper = sheet(grid)
    return upper


def _pillows(
    builder: ModelBuilder,
    rng: RandomStream,
    palette: Palette,
    wide: float,
    head_y: float,
    top: float,
    cloth: Finish,
) -> None:
    count = 2 if wide > 1.2 else 1
    each = min(0.68, wide / count - 0.04)
    for k in range(count):
        x = (k + 0.5 - count / 2) * wide / count
        pillow = throw_pillow(0.5).scaled(each / 0.5, 1.0, 1.1).turned(26, "x")
        builder.add(cloth, pillow.moved(x, head_y + 0.27, top + 0.05).turned(0, "z"))
    if rng.chance(0.6):
        accent = fabric(palette.accent_hue)
        for k in range(count):
            x = (k + 0.5 - count / 2) * wide / count * 0.8
            builder.add(
                accent, throw_pillow(0.42).turned(52, "x").moved(x, head_y + 0.4, top + 0.16)
            )


def _headboard(
    builder: ModelBuilder,
    rng: RandomStream,
    palette: Palette,
    frame: Finish,
    kind: str,
    wide: float,
    y: float,
) -> None:
    high, full = rng.uniform(0.95, 1.2), wide + 0.1
    if kind == "panel":
        builder.add(frame, box(full, 0.04, high - 0.2, at=(0, y, 0.2), bevel=0.008))
        builder.add(frame, box(full + 0.03, 0.06, 0.05, at=(0, y, high - 0.02), bevel=0.012))
        for k in range(3):
            at = ((k - 1) * full / 3, y + 0.025, 0.62)
            part = box(full / 3 - 0.08, 0.02, high - 0.75, bevel=0.006, at=at)
            builder.add(frame.tinted(1.06), part)
    elif kind == "upholstered":
        cloth = leather("brown") if rng.chance(0.2) else fabric(palette.upholstery_hue)
        columns = max(round(full / 0.3), 2)
        for k in range(columns):
            for row in range(2):
                tuft = cushion(
                    full / columns - 0.004,
                    (high - 0.3) / 2 - 0.004,
                    0.09,
                    radius=0.035,
                    puff=0.012,
                    flats=3,
                ).turned(90, "x")
                part = tuft.moved(
                    (k + 0.5 - columns / 2) * full / columns,
                    y + 0.05,
                    0.3 + (row + 0.5) * (high - 0.3) / 2,
                )
                builder.add(cloth, part)
        builder.add(cloth, box(full, 0.04, high - 0.1, at=(0, y - 0.005, 0.1), bevel=0.01))
    else:
        metal = rng.choice((BLACK_METAL, WHITE_METAL, BRASS)) if kind == "metal" else frame
        radius = 0.018 if kind == "metal" else 0.028
        for s in (-1.0, 1.0):
            builder.add(
                metal, rod((s * full / 2, y, 0.0), (s * full / 2, y, high), radius, sides=10)
            )
        for z in (high - 0.03, 0.55):
            builder.add(metal, rod((-full / 2, y, z), (full / 2, y, z), radius * 0.9, sides=10))
        count = round(full / 0.13)
        for k in range(1, count):
            x = (k / count - 0.5) * full
            builder.add(metal, rod((x, y, 0.55), (x, y, high - 0.03), radius * 0.5, sides=6))


def bunk_bed(rng: RandomStream, palette: Palette) -> Model:
    """Two beds, one above the other, with a ladder."""
    builder = ModelBuilder()
    frame = lacquer(palette.paint_hue) if rng.chance(0.4) else palette.furniture_wood(rng)
    wide, half = 0.95, LONG_M / 2
    high = 1.7
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            part = box(
                0.07, 0.07, high, at=(sx * (wide / 2 + 0.03), sy * (half + 0.03), 0), bevel=0.008
            )
            builder.add(frame, part.swapped_uv())
    covers = [bedding(rng, palette.linen_hue), bedding(rng, palette.accent_hue)]
    for level, cover in ((0.25, covers[0]), (1.2, covers[1])):
        for s in (-1.0, 1.0):
            part = box(0.03, LONG_M, 0.13, at=(s * (wide / 2 + 0.03), 0, level), bevel=0.004)
            builder.add(frame, part.swapped_uv())
            builder.add(frame, box(wide, 0.03, 0.13, at=(0, s * (half + 0.03), level), bevel=0.004))
        builder.add(
            fabric("white"),
            cushion(wide - 0.02, LONG_M - 0.02, 0.16, radius=0.04, at=(0, 0, level + 0.08)),
        )
        at = (0, half * 0.28, level + 0.22)
        part = cushion(wide, LONG_M * 0.72, 0.05, radius=0.022, puff=0.01, flats=3, at=at)
        builder.add(cover, part)
        pillow = throw_pillow(0.42).scaled(1.4, 1.0, 0.9)
        builder.add(fabric("white"), pillow.moved(0, -half + 0.28, level + 0.23))
    for z in (1.42, 1.54):
        builder.add(frame, box(0.025, LONG_M, 0.07, at=(-wide / 2 - 0.03, 0, z)).swapped_uv())
        builder.add(
            frame, box(0.025, LONG_M * 0.7, 0.07, at=(wide / 2 + 0.03, -0.28, z)).swapped_uv()
        )
        for s in (-1.0, 1.0):
            builder.add(frame, box(wide, 0.025, 0.07, at=(0, s * (half + 0.03), z)))
    x = wide / 2 + 0.08
    for y in (half - 0.5, half - 0.12):
        builder.add(frame, box(0.03, 0.05, 1.6, at=(x, y, 0)).swapped_uv())
    for k in range(5):
        builder.add(
            frame, rod((x, half - 0.5, 0.25 + 0.26 * k), (x, half - 0.12, 0.25 + 0.26 * k), 0.016)
        )
    return builder.model("bed", "bunk bed", main=frame)


def crib(rng: RandomStream, palette: Palette) -> Model:
    """A baby's bed with bars."""
    builder = ModelBuilder()
    frame = (
        lacquer(rng.choice(("white", palette.paint_hue)))
        if rng.chance(0.6)
        else palette.furniture_wood(rng)
    )
    wide, long, high = 0.7, 1.3, 0.9
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            part = box(0.045, 0.045, high, at=(sx * wide / 2, sy * long / 2, 0), bevel=0.006)
            builder.add(frame, part.swapped_uv())
    for z in (0.28, high - 0.06):
        for s in (-1.0, 1.0):
            builder.add(frame, box(0.025, long, 0.05, at=(s * wide / 2, 0, z)).swapped_uv())
            builder.add(frame, box(wide, 0.025, 0.05, at=(0, s * long / 2, z)))
    for s in (-1.0, 1.0):
        for k in range(1, 14):
            y = (k / 14 - 0.5) * long
            builder.add(
                frame, rod((s * wide / 2, y, 0.3), (s * wide / 2, y, high - 0.04), 0.009, sides=6)
            )
        for k in range(1, 7):
            x = (k / 7 - 0.5) * wide
            builder.add(
                frame, rod((x, s * long / 2, 0.3), (x, s * long / 2, high - 0.04), 0.009, sides=6)
            )
    builder.add(
        fabric("white"), cushion(wide - 0.05, long - 0.05, 0.12, radius=0.03, at=(0, 0, 0.32))
    )
    builder.add(
        fabric(palette.linen_hue, "stripes", 0.4),
        cushion(wide - 0.08, long * 0.6, 0.04, radius=0.018, at=(0, long * 0.17, 0.43)),
    )
    builder.add(
        fabric("white"), throw_pillow(0.28).scaled(1.3, 1, 0.8).moved(0, -long / 2 + 0.2, 0.43)
    )
    return builder.model("crib", "cot", "baby crib", main=frame)
