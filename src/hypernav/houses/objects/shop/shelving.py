"""Models of shelves of shops and libraries; goods and books are images on blocks."""

from collections.abc import Sequence

from hypernav.houses.materials import (
    BLACK_METAL,
    HUES,
    STEEL,
    WHITE_METAL,
    Palette,
    lacquer,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, panel
from hypernav.houses.objects.repeated_images import repeated_image, repeated_panel
from hypernav.houses.random_stream import RandomStream

_PRICE = Finish("", (0.95, 0.9, 0.35))
_CARD = Finish("cardboard", (0.72, 0.55, 0.37), 0.5, "brown", "cardboard")
_FILL = Finish("", (0.55, 0.53, 0.5))


def _row(
    builder: ModelBuilder,
    rng: RandomStream,
    key: str,
    wide: float,
    deep: float,
    high: float,
    z: float,
    front: float,
    side: float,
) -> None:
    """Add one row of goods whose face is an image, seen from the side +1 or -1 of y."""
    share = rng.choice((1.0, 1.0, 0.9, 0.75))
    long = wide * share
    x = rng.choice((-1.0, 1.0)) * (wide - long) / 2
    face = repeated_panel(long, high, rng.unit())
    face = face if side > 0 else face.turned(180.0)
    builder.add(repeated_image(key), face.moved(x, side * front, z))
    body = box(long - 0.004, deep, high * 0.88, at=(x, side * (front - 0.004 - deep / 2), z))
    builder.add(_FILL, body)


def _goods(rng: RandomStream) -> str:
    return f"goods {rng.integer(0, 5)}"


def gondola(rng: RandomStream, palette: Palette) -> Model:
    """A double-sided shelf of a supermarket with goods on all levels."""
    del palette
    builder = ModelBuilder()
    frame = rng.choice((WHITE_METAL, plastic("light gray"), STEEL))
    wide, deep, high = 1.25, 0.86, rng.choice((1.45, 1.75, 1.95))
    builder.add(frame, box(wide, 0.05, high, at=(0, 0, 0)))
    builder.add(plastic("dark gray"), box(wide, deep, 0.14, at=(0, 0, 0), bevel=0.004))
    levels = round((high - 0.15) / 0.38)
    each = (high - 0.16) / levels
    sorts = (_goods(rng), _goods(rng))
    for k in range(levels):
        z = 0.14 + each * k
        reach = deep / 2 - 0.02 if k < 2 else deep / 2 - 0.1
        for side in (1.0, -1.0):
            if k:
                board = box(wide, reach - 0.025, 0.025, at=(0, side * (reach + 0.025) / 2, z))
                builder.add(frame, board)
                strip = box(wide, 0.006, 0.035, at=(0, side * (reach + 0.003), z - 0.005))
                builder.add(_PRICE if rng.chance(0.3) else WHITE_METAL, strip)
            key = sorts[0 if side > 0 else 1] if rng.chance(0.5) else _goods(rng)
            tall = (each - 0.07) * rng.choice((1.0, 0.8))
            _row(builder, rng, key, wide - 0.04, reach - 0.08, tall, z + 0.03, reach - 0.02, side)
    return builder.model(
        "grocery shelf",
        "supermarket shelf",
        "store shelf",
        "gondola",
        "shelf",
        main=frame,
        attributes=("tall",) if high > 1.5 else ("low",),
    )


def wall_gondola(rng: RandomStream, palette: Palette) -> Model:
    """A shelf of a supermarket with its back to the wall."""
    del palette
    builder = ModelBuilder()
    frame = rng.choice((WHITE_METAL, plastic("light gray")))
    wide, deep, high = 1.25, 0.48, 2.05
    builder.add(frame, box(wide, 0.04, high, at=(0, -deep / 2 + 0.02, 0)))
    builder.add(plastic("dark gray"), box(wide, deep, 0.14, at=(0, 0, 0), bevel=0.004))
    each = (high - 0.15) / 5
    for k in range(5):
        z = 0.14 + each * k
        reach = deep / 2 if k == 0 else deep / 2 - 0.07
        if k:
            middle = (reach - deep / 2) / 2
            builder.add(frame, box(wide, reach + deep / 2, 0.025, at=(0, middle, z)))
            builder.add(_PRICE, box(wide, 0.006, 0.03, at=(0, reach + 0.003, z - 0.004)))
        tall = (each - 0.07) * rng.choice((1.0, 0.85))
        _row(
            builder,
            rng,
            _goods(rng),
            wide - 0.04,
            reach + deep / 2 - 0.09,
            tall,
            z + 0.03,
            reach - 0.02,
            1.0,
        )
    return builder.model(
        "grocery shelf",
        "supermarket shelf",
        "store shelf",
        "shelf",
        main=frame,
        attributes=("tall",),
    )


def library_shelf(rng: RandomStream, palette: Palette) -> Model:
    """A double-sided bookshelf, as libraries and bookshops have them."""
    builder = ModelBuilder()
    body = wood(palette.wood) if rng.chance(0.6) else lacquer(rng.choice(("white", "light gray")))
    wide, deep, high = 1.0, 0.58, rng.choice((1.35, 1.8, 2.1))
    for s in (-1.0, 1.0):
        board = box(0.03, deep, high, at=(s * (wide / 2 - 0.015), 0, 0), bevel=0.003)
        builder.add(body, board.swapped_uv())
    builder.add(body, box(wide - 0.06, 0.02, high - 0.02, at=(0, 0, 0)))
    rows = round((high - 0.1) / 0.34)
    each = (high - 0.1) / rows
    for k in range(rows + 1):
        builder.add(body, box(wide - 0.06, deep - 0.02, 0.022, at=(0, 0, 0.06 + each * k)))
    for k in range(rows):
        for side in (1.0, -1.0):
            key = f"book spines {rng.integer(0, 5)}"
            tall = min(0.27, each - 0.05)
            _row(builder, rng, key, wide - 0.08, 0.2, tall, 0.084 + each * k, deep / 2 - 0.04, side)
    return builder.model(
        "bookshelf",
        "bookcase",
        "library shelf",
        "shelf",
        main=body,
        attributes=("tall",) if high > 1.5 else ("low",),
    )


def pallet_rack(rng: RandomStream, palette: Palette) -> Model:
    """A heavy rack with boxes and tools, open on both sides."""
    del palette
    builder = ModelBuilder()
    wide, deep, high = 1.6, 0.8, 2.25
    post, beam = plastic("blue"), plastic("orange")
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            at = (sx * (wide / 2 - 0.035), sy * (deep / 2 - 0.035), 0)
            builder.add(post, box(0.07, 0.07, high, at=at))
    for k, z in enumerate((0.12, 0.78, 1.44)):
        builder.add(wood("pine"), box(wide - 0.02, deep - 0.04, 0.03, at=(0, 0, z)))
        for sy in (-1.0, 1.0):
            builder.add(beam, box(wide - 0.14, 0.03, 0.1, at=(0, sy * (deep / 2 - 0.02), z - 0.08)))
        x = -wide / 2 + 0.1
        while x < wide / 2 - 0.3:
            w = min(rng.uniform(0.22, 0.45), wide / 2 - 0.09 - x)
            h = rng.uniform(0.2, 0.46 if k < 2 else 0.6)
            ink = rng.choice((_CARD, _CARD, plastic("gray"), plastic("red"), plastic("green")))
            builder.add(ink, box(w, deep - 0.16, h, at=(x + w / 2, 0, z + 0.03), bevel=0.004))
            x += w + 0.03
    return builder.model(
        "storage rack",
        "pallet rack",
        "warehouse shelf",
        "shelf",
        attributes=("blue", "metal", "tall"),
    )


def magazine_rack(rng: RandomStream, palette: Palette) -> Model:
    """A stand with rows of magazines that lean back."""
    builder = ModelBuilder()
    body = BLACK_METAL if rng.chance(0.5) else wood(palette.secondary_wood)
    wide, deep = 0.9, 0.4
    builder.add(body, box(wide, deep, 0.1, at=(0, 0, 0), bevel=0.004))
    builder.add(body, box(wide, 0.03, 1.5, at=(0, -deep / 2 + 0.015, 0)))
    for k in range(4):
        z = 0.16 + 0.33 * k
        y = 0.13 - 0.075 * k
        builder.add(body, box(wide, 0.12, 0.02, at=(0, y - 0.02, z)))
        builder.add(body, box(wide, 0.012, 0.06, at=(0, y + 0.045, z)))
        for j in range(4):
            sheet = panel(0.19, 0.27).turned(12, "x").moved((j - 1.5) * 0.215, y + 0.02, z + 0.02)
            builder.add(Finish(f"label {rng.integer(0, 5)}", (1.0, 1.0, 1.0)), sheet)
    return builder.model("magazine rack", "newspaper stand", "magazine stand", main=body)


def display_table(rng: RandomStream, palette: Palette) -> Model:
    """A low table in a shop with stacks of folded clothes."""
    hues = ("red", "navy", "teal", "cream", "gray", "green", "white", "yellow")
    return _sales_table(rng, palette, 0.3, 0.035, hues, "fabric")


def book_table(rng: RandomStream, palette: Palette) -> Model:
    """A low table in a shop with stacks of books."""
    hues = ("red", "navy", "teal", "cream", "black", "orange", "white", "purple")
    return _sales_table(rng, palette, 0.2, 0.028, hues, "")


def _sales_table(
    rng: RandomStream,
    palette: Palette,
    piece: float,
    thick: float,
    hues: Sequence[str],
    texture: str,
) -> Model:
    """A table with stacks of pieces of a width, a thickness, hues and a texture."""
    builder = ModelBuilder()
    body = wood(palette.wood) if rng.chance(0.6) else lacquer("white")
    wide, deep, high = rng.choice((1.2, 1.5)), 0.8, 0.72
    builder.add(body, box(wide, deep, 0.05, at=(0, 0, high - 0.05), bevel=0.005))
    for s in (-1.0, 1.0):
        side = box(0.05, deep - 0.06, high - 0.05, at=(s * (wide / 2 - 0.06), 0, 0))
        builder.add(body, side.swapped_uv())
    builder.add(body, box(wide - 0.16, deep - 0.1, 0.03, at=(0, 0, 0.22)))
    columns = int((wide - 0.1) / (piece + 0.05))
    for k in range(columns):
        for y in (-0.19, 0.19):
            x = (k + 0.5 - columns / 2) * (piece + 0.05)
            for j in range(rng.integer(1, 4)):
                top = box(
                    piece, 0.3, thick, at=(x, y, high + (thick + 0.001) * j), bevel=0.2 * thick
                )
                builder.add(Finish(texture, HUES[rng.choice(hues)], 0.3), top)
    support = SupportSurface(
        -wide / 2 + 0.1, -deep / 2 + 0.1, wide / 2 - 0.1, deep / 2 - 0.1, 0.25, 0.4
    )
    return builder.model("display table", "table", "sales table", main=body, supports=(support,))


def book_cart(rng: RandomStream, palette: Palette) -> Model:
    """A trolley with two rows of books on castors."""
    builder = ModelBuilder()
    body = rng.choice((plastic(palette.accent_hue), STEEL, plastic("dark gray")))
    wide, deep = 0.8, 0.42
    for s in (-1.0, 1.0):
        builder.add(body, box(0.025, deep, 1.0, at=(s * (wide / 2 - 0.0125), 0, 0.1)).swapped_uv())
        for y in (-0.15, 0.15):
            builder.add(BLACK_METAL, box(0.03, 0.07, 0.1, at=(s * (wide / 2 - 0.03), y, 0)))
    for z in (0.22, 0.66):
        builder.add(body, box(wide - 0.05, deep - 0.04, 0.02, at=(0, 0, z)))
        for side in (1.0, -1.0):
            key = f"book spines {rng.integer(0, 5)}"
            _row(builder, rng, key, wide - 0.07, 0.15, 0.25, z + 0.022, deep / 2 - 0.03, side)
    return builder.model("book cart", "library cart", "book trolley", "trolley", main=body)
