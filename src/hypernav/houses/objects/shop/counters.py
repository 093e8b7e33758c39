"""Models of what stands around the checkout of shops, and of cooled shelves."""

from hypernav.houses.materials import (
    BLACK_METAL,
    CHROME,
    GLASS,
    RUBBER,
    STEEL,
    WHITE_METAL,
    Palette,
    image_finish,
    lacquer,
    plastic,
    wood,
)
from hypernav.houses.modelling.mesh import Finish
from hypernav.houses.modelling.model import Model, ModelBuilder, SupportSurface
from hypernav.houses.modelling.solids import box, panel, tile
from hypernav.houses.modelling.tubes import rod
from hypernav.houses.objects.repeated_images import repeated_image, repeated_panel
from hypernav.houses.random_stream import RandomStream


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
    del palette
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
    del palette
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
    del palette
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
    del palette
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
