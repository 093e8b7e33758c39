"""Models of what shops are fitted with: shelves of goods, counters, racks of clothes."""

import math
from collections.abc import Sequence

from hypernav.simulator.houses.modelling.curves import ball, cylinder, lathe, rod
from hypernav.simulator.houses.modelling.materials import (
    BLACK_METAL,
    CHROME,
    GLASS,
    HUES,
    RUBBER,
    STEEL,
    WHITE_METAL,
    Palette,
    fabric,
    image_finish,
    lacquer,
    plastic,
    repeated_image,
    repeated_panel,
    wood,
)
from hypernav.simulator.houses.modelling.model import Finish, Model, ModelBuilder, SupportSurface
from hypernav.simulator.houses.modelling.solids import box, cushion, panel, tile
from hypernav.simulator.houses.objects.furniture.storage import shoe_parts
from hypernav.simulator.houses.random_stream import RandomStream

_PRICE = Finish("", (0.95, 0.9, 0.35))
_CARD = Finish("cardboard", (0.72, 0.55, 0.37), 0.5, "brown", "cardboard")
_FILL = Finish("", (0.55, 0.53, 0.5))

_HUES = ("red", "navy", "black", "gray", "cream", "teal", "green", "white", "pink", "brown", "blue")


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


def _till(builder: ModelBuilder, x: float, y: float, z: float) -> None:
    """Add a till whose keys face -y."""
    builder.add(plastic("black"), box(0.34, 0.34, 0.1, at=(x, y, z), bevel=0.006))
    builder.add(plastic("dark gray"), box(0.3, 0.04, 0.2, at=(x, y + 0.05, z + 0.12)))
    screen = panel(0.27, 0.17).turned(180.0).moved(x, y + 0.0295, z + 0.135)
    builder.add(image_finish("screen desktop"), screen)
    builder.add(
        image_finish("keyboard"), tile(0.26, 0.12, at=(x, y - 0.09, z + 0.1005)).turned(0.0)
    )


def checkout_counter(rng: RandomStream, palette: Palette) -> Model:
    """A checkout with a belt and a till; customers pass in front (+y)."""
    builder = ModelBuilder()
    body = rng.choice((plastic("light gray"), plastic("white"), lacquer("dark gray")))
    long, deep, high = 2.1, 0.6, 0.84
    builder.add(body, box(long, deep, high, at=(0, 0, 0), bevel=0.008))
    builder.add(RUBBER, box(1.15, deep - 0.14, 0.012, at=(-0.42, 0.02, high)))
    builder.add(STEEL, box(0.8, deep - 0.1, 0.012, at=(0.6, 0, high)))
    builder.add(STEEL, box(long, 0.02, 0.1, at=(0, deep / 2 - 0.01, high)))
    builder.add(plastic(palette.accent_hue), box(long - 0.02, 0.012, 0.14, at=(0, deep / 2, 0.5)))
    _till(builder, 0.42, -0.1, high + 0.012)
    builder.add(STEEL, rod((0.98, -0.25, high), (0.98, -0.25, 1.75), 0.018))
    number = Finish("", (0.95, 0.95, 0.6), 1.0, unlit=True)
    builder.add(number, box(0.14, 0.06, 0.2, at=(0.96, -0.25, 1.6)))
    support = SupportSurface(-0.95, -0.18, 0.1, 0.2, high + 0.012, 0.4)
    return builder.model(
        "checkout counter", "checkout", "cash desk", "counter", main=body, supports=(support,)
    )


def sales_counter(rng: RandomStream, palette: Palette) -> Model:
    """A counter with a till and a card terminal; customers stand in front (+y)."""
    builder = ModelBuilder()
    body = wood(palette.wood) if rng.chance(0.5) else lacquer(rng.choice(("white", "dark gray")))
    long, deep, high = rng.choice((1.5, 1.9, 2.3)), 0.65, 0.98
    builder.add(body, box(long, deep - 0.06, high - 0.04, at=(0, -0.02, 0), bevel=0.005))
    builder.add(body.tinted(0.8), box(long + 0.04, deep, 0.04, at=(0, 0, high - 0.04), bevel=0.006))
    _till(builder, 0.25, -0.1, high)
    builder.add(plastic("black"), box(0.09, 0.17, 0.05, at=(-0.1, 0.12, high), bevel=0.01))
    builder.add(
        plastic(palette.accent_hue), box(long - 0.2, 0.01, 0.2, at=(0, deep / 2 - 0.046, 0.4))
    )
    support = SupportSurface(-long / 2 + 0.06, -0.26, -0.2, 0.24, high, 0.5)
    return builder.model(
        "sales counter", "shop counter", "cash desk", "counter", main=body, supports=(support,)
    )


def shopping_cart(rng: RandomStream, palette: Palette) -> Model:
    """A wire trolley on four castors; it is pushed from its back (-y)."""
    builder = ModelBuilder()
    accent = plastic(rng.choice(("red", "blue", "green", "yellow")))
    low, high = 0.45, 0.95
    for s in (-1.0, 1.0):
        builder.add(CHROME, rod((s * 0.24, -0.4, 0.08), (s * 0.26, -0.42, 1.0), 0.014, sides=6))
        builder.add(CHROME, rod((s * 0.24, -0.4, 0.12), (s * 0.18, 0.42, 0.1), 0.013, sides=6))
        builder.add(
            CHROME, rod((s * 0.26, -0.4, high), (s * 0.2, 0.44, high - 0.08), 0.01, sides=6)
        )
        builder.add(
            CHROME, rod((s * 0.24, -0.36, low), (s * 0.18, 0.38, low + 0.08), 0.01, sides=6)
        )
        for k in range(6):
            y = -0.34 + 0.14 * k
            lower, upper = (
                (s * 0.235 - s * 0.011 * k, y, low + 0.013 * k),
                (s * 0.25 - s * 0.01 * k, y, high - 0.015 * k),
            )
            builder.add(CHROME, rod(lower, upper, 0.004, sides=4))
        for y in (-0.38, 0.4):
            x = s * (0.24 if y < 0 else 0.18)
            builder.add(RUBBER, box(0.03, 0.1, 0.1, at=(x, y, 0), bevel=0.01))
    for k in range(6):
        y = -0.34 + 0.14 * k
        half = 0.235 - 0.011 * k
        z = low + 0.013 * k
        builder.add(CHROME, rod((-half, y, z), (half, y, z), 0.004, sides=4))
    for z in (0.55, 0.65, 0.75, 0.86):
        builder.add(CHROME, rod((-0.19, 0.41, z), (0.19, 0.41, z), 0.004, sides=4))
    builder.add(CHROME, rod((-0.2, 0.44, 0.87), (0.2, 0.44, 0.87), 0.01, sides=6))
    builder.add(accent, rod((-0.27, -0.43, 1.0), (0.27, -0.43, 1.0), 0.02, sides=8))
    return builder.model("shopping cart", "shopping trolley", "trolley", "cart", main=CHROME)


def basket_stack(rng: RandomStream, palette: Palette) -> Model:
    """A stack of shopping baskets."""
    builder = ModelBuilder()
    hue = rng.choice(("red", "blue", "green"))
    count = rng.integer(3, 6)
    for k in range(count):
        z = 0.01 + 0.07 * k
        tint = plastic(hue).tinted(1.0 - 0.05 * (k % 2))
        builder.add(tint, box(0.42, 0.3, 0.06, at=(0, 0, z), bevel=0.006))
        builder.add(tint, box(0.46, 0.34, 0.012, at=(0, 0, z + 0.056), bevel=0.004))
    top = 0.01 + 0.07 * count
    builder.add(BLACK_METAL, rod((-0.2, 0, top), (0.2, 0, top), 0.012, sides=6))
    return builder.model("shopping basket", "shopping baskets", "basket", main=plastic(hue))


def display_refrigerator(rng: RandomStream, palette: Palette) -> Model:
    """A tall cooled shelf with drinks and dairy, open or behind glass doors."""
    builder = ModelBuilder()
    body = rng.choice((WHITE_METAL, plastic("dark gray")))
    wide, deep, high = 1.25, 0.75, 2.0
    builder.add(body, box(wide, 0.06, high, at=(0, -deep / 2 + 0.03, 0)))
    builder.add(body, box(wide, deep, 0.22, at=(0, 0, 0), bevel=0.008))
    builder.add(body, box(wide, deep, 0.16, at=(0, 0, high - 0.16), bevel=0.008))
    for s in (-1.0, 1.0):
        builder.add(body, box(0.05, deep - 0.02, high - 0.3, at=(s * (wide / 2 - 0.025), 0, 0.2)))
    light = Finish("", (0.97, 0.99, 1.0), 1.0, unlit=True)
    builder.add(light, box(wide - 0.1, 0.04, 0.02, at=(0, deep / 2 - 0.08, high - 0.181)))
    for k in range(4):
        z = 0.24 + 0.39 * k
        reach = deep / 2 - 0.1
        builder.add(STEEL, box(wide - 0.1, deep - 0.16, 0.02, at=(0, -0.02, z)))
        face = repeated_panel(wide - 0.12, 0.28, rng.unit())
        goods = repeated_image(f"goods {rng.integer(0, 5)}")
        builder.add(goods, face.moved(0, reach, z + 0.022))
        builder.add(plastic("gray"), box(wide - 0.12, deep - 0.24, 0.24, at=(0, -0.04, z + 0.021)))
    if rng.chance(0.5):
        for s in (-1.0, 1.0):
            x = s * wide / 4
            for dx in (-1.0, 1.0):
                bar = box(
                    0.03, 0.02, high - 0.42, at=(x + dx * (wide / 4 - 0.02), deep / 2 - 0.02, 0.23)
                )
                builder.add(BLACK_METAL, bar)
            grip = box(0.02, 0.04, 0.4, at=(x - s * (wide / 4 - 0.05), deep / 2 + 0.01, 0.9))
            builder.add(CHROME, grip)
    return builder.model(
        "display refrigerator", "refrigerated shelf", "refrigerator", "fridge", main=body
    )


def chest_freezer(rng: RandomStream, palette: Palette) -> Model:
    """A low freezer with glass lids over its goods."""
    builder = ModelBuilder()
    body = rng.choice((WHITE_METAL, plastic("light blue"), plastic("dark gray")))
    wide, deep, high = 1.5, 0.8, 0.84
    builder.add(body, box(wide, deep, high - 0.1, at=(0, 0, 0), bevel=0.012))
    key = Finish(f"goods {rng.integer(0, 5)}", (0.95, 0.98, 1.0), 1.0, "", "paper")
    builder.add(key, tile(wide - 0.14, deep - 0.14, at=(0, 0, high - 0.098)))
    for s in (-1.0, 1.0):
        builder.add(body, box(wide, 0.05, 0.1, at=(0, s * (deep / 2 - 0.025), high - 0.1)))
        builder.add(body, box(0.05, deep - 0.1, 0.1, at=(s * (wide / 2 - 0.025), 0, high - 0.1)))
    builder.add(BLACK_METAL, box(wide - 0.1, 0.03, 0.02, at=(0, 0.0, high)))
    builder.add(GLASS, box(0.03, deep - 0.1, 0.02, at=(0, 0, high)))
    return builder.model("chest freezer", "freezer", "ice cream freezer", main=body)


def _cloth(rng: RandomStream) -> Finish:
    return fabric(rng.choice(_HUES))


def clothes_rail(rng: RandomStream, palette: Palette) -> Model:
    """A straight rail with clothes on hangers."""
    builder = ModelBuilder()
    metal = rng.choice((BLACK_METAL, CHROME))
    wide, high = rng.choice((1.2, 1.5)), 1.45
    for s in (-1.0, 1.0):
        x = s * (wide / 2 - 0.03)
        builder.add(metal, rod((x, 0, 0.03), (x, 0, high), 0.016, sides=8))
        builder.add(metal, box(0.05, 0.5, 0.035, at=(x, 0, 0), bevel=0.006))
    builder.add(metal, rod((-wide / 2 + 0.03, 0, high), (wide / 2 - 0.03, 0, high), 0.014, sides=8))
    x = -wide / 2 + 0.12
    cloth, long = _cloth(rng), rng.uniform(0.6, 1.05)
    while x < wide / 2 - 0.12:
        if rng.chance(0.25):
            cloth, long = _cloth(rng), rng.uniform(0.6, 1.05)
        if rng.chance(0.9):
            wobble = rng.uniform(-0.012, 0.012)
            piece = cushion(
                0.045, 0.44, long, radius=0.02, rounds=1, at=(x, wobble, high - 0.06 - long)
            )
            builder.add(cloth, piece)
            builder.add(CHROME, rod((x, 0, high - 0.07), (x, 0, high + 0.02), 0.004, sides=4))
        x += 0.062
    return builder.model("clothes rack", "clothes rail", "garment rack", main=metal)


def round_rack(rng: RandomStream, palette: Palette) -> Model:
    """A round stand with clothes on hangers."""
    builder = ModelBuilder()
    high, radius = 1.3, 0.42
    builder.add(CHROME, cylinder(0.03, high, sides=10))
    builder.add(CHROME, box(0.7, 0.05, 0.04, bevel=0.008), box(0.05, 0.7, 0.04, bevel=0.008))
    cloth, long = _cloth(rng), rng.uniform(0.6, 0.95)
    for k in range(22):
        angle = 2.0 * math.pi * k / 22
        if k % 6 == 0:
            cloth, long = _cloth(rng), rng.uniform(0.6, 0.95)
        piece = cushion(0.06, 0.4, long, radius=0.02, rounds=1, at=(0, 0, high - 0.06 - long))
        turned = piece.turned(math.degrees(angle) + 90.0)
        builder.add(cloth, turned.moved(radius * math.cos(angle), radius * math.sin(angle), 0))
        part = rod(
            (radius * math.cos(angle), radius * math.sin(angle), high),
            (
                radius * math.cos(angle + 2.0 * math.pi / 22),
                radius * math.sin(angle + 2.0 * math.pi / 22),
                high,
            ),
            0.012,
            sides=6,
        )
        builder.add(CHROME, part)
    return builder.model(
        "clothes rack", "round rack", "garment rack", main=CHROME, attributes=("round",)
    )


def mannequin(rng: RandomStream, palette: Palette) -> Model:
    """A dressed figure without a face, on a plate."""
    builder = ModelBuilder()
    skin = plastic(rng.choice(("white", "cream", "black", "light gray")))
    top, low = _cloth(rng), _cloth(rng)
    builder.add(CHROME, cylinder(0.19, 0.02, sides=24, bevel=0.005))
    builder.add(CHROME, rod((0, -0.05, 0.02), (0, -0.05, 0.8), 0.012, sides=6))
    skirt = rng.chance(0.5)
    for s in (-1.0, 1.0):
        builder.add(
            skin, rod((s * 0.09, 0, 0.03), (s * 0.08, 0, 0.85), 0.045, end_radius=0.07, sides=10)
        )
    if skirt:
        builder.add(
            low, lathe([(0.24, 0.45), (0.2, 0.75), (0.14, 0.98), (0.0, 0.99)], crease_deg=80)
        )
    else:
        for s in (-1.0, 1.0):
            builder.add(
                low, rod((s * 0.09, 0, 0.08), (s * 0.08, 0, 0.9), 0.065, end_radius=0.085, sides=10)
            )
        builder.add(low, ball(0.34, 0.24, 0.3, at=(0, 0, 0.92), sides=14))
    profile = [
        (0.13, 0.9),
        (0.12, 1.05),
        (0.16, 1.25),
        (0.19, 1.38),
        (0.1, 1.47),
        (0.05, 1.49),
        (0.0, 1.5),
    ]
    torso = lathe(profile, sides=16, crease_deg=80)
    builder.add(top, torso.scaled(1.0, 0.68, 1.0))
    for s in (-1.0, 1.0):
        builder.add(
            top, rod((s * 0.25, 0.02, 1.1), (s * 0.17, 0, 1.4), 0.045, end_radius=0.055, sides=8)
        )
        builder.add(
            skin,
            rod((s * 0.24, 0.08, 0.86), (s * 0.25, 0.02, 1.1), 0.03, end_radius=0.036, sides=8),
        )
    builder.add(skin, cylinder(0.045, 0.1, at=(0, 0, 1.47), sides=10))
    builder.add(skin, ball(0.17, 0.2, 0.25, at=(0, 0.01, 1.66), sides=14))
    return builder.model("mannequin", "dress form", "dummy", main=skin)


def shoe_display(rng: RandomStream, palette: Palette) -> Model:
    """A stepped stand with shoes."""
    builder = ModelBuilder()
    body = wood(palette.wood) if rng.chance(0.6) else plastic("white")
    for y, z in ((0.24, 0.3), (-0.06, 0.6), (-0.36, 0.9)):
        builder.add(body, box(1.2, 0.3, z, at=(0, y, 0), bevel=0.004))
        for j in range(2):
            if rng.chance(0.9):
                for part in shoe_parts(rng, (j - 0.5) * 0.5 + rng.uniform(-0.1, 0.1), z):
                    builder.add(part.finish, part.mesh.moved(0, y, 0))
    return builder.model("shoe display", "shoe shelf", "shoe stand", main=body)
