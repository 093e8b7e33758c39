"""Images fitted to surfaces of offices and shops: whiteboards, rows of goods, racks of clothes."""

import numpy as np

from hypernav.houses.random_stream import RandomStream
from hypernav.houses.textures.images import INKS
from hypernav.houses.textures.noise import Image, pixel_grid, to_image


def whiteboard(rng: RandomStream, height: int = 160, width: int = 256) -> Image:
    """Writing, boxes with arrows and a curve on a white board."""
    row, column = pixel_grid(height, width)
    canvas = np.ones((height, width, 3)) * 0.955
    pens = ((0.12, 0.18, 0.5), (0.68, 0.15, 0.14), (0.1, 0.1, 0.1), (0.1, 0.42, 0.2))
    for _ in range(rng.integer(3, 6)):
        ink = rng.choice(pens)
        top, left = rng.uniform(0.08, 0.75), rng.uniform(0.05, 0.5)
        wave = 0.006 * np.sin(column * rng.uniform(150.0, 260.0))
        line = np.abs(row - top - wave) < 0.012
        canvas[line & (column > left) & (column < left + rng.uniform(0.15, 0.4))] = ink
    for _ in range(rng.integer(1, 3)):
        ink = rng.choice(pens)
        x0, y0 = rng.uniform(0.5, 0.75), rng.uniform(0.1, 0.6)
        dx, dy = np.abs(column - x0 - 0.08), np.abs(row - y0 - 0.1)
        edge = (np.maximum(dx / 0.08, dy / 0.1) < 1.0) & (np.maximum(dx / 0.073, dy / 0.088) > 1.0)
        canvas[edge] = ink
    curve = 0.85 - 0.3 * column**2 * rng.uniform(0.5, 1.5)
    canvas[(np.abs(row - curve) < 0.01) & (column > 0.1) & (column < 0.45)] = rng.choice(pens)
    return to_image(canvas)


def goods(rng: RandomStream, height: int = 128, width: int = 512) -> Image:
    """Packages side by side on a shelf, several of each sort; about 1 m × 0.3 m."""
    canvas = np.ones((height, width, 3)) * 0.16
    x = 0
    while x < width:
        wide, count = rng.integer(16, 40), rng.integer(2, 5)
        ink, other = np.array(rng.choice(INKS)), np.array(rng.choice(INKS))
        top = rng.integer(int(height * 0.08), int(height * 0.4))
        is_round = rng.chance(0.3)
        band = rng.integer(top + 12, top + 40)
        for _ in range(count):
            end = min(x + wide - 2, width)
            if end <= x:
                break
            across = np.linspace(-1.0, 1.0, wide - 2)[: end - x]
            shade = (1.0 - 0.4 * across**2 if is_round else 1.0 - 0.1 * np.abs(across))[:, None]
            canvas[top:, x:end] = ink * shade
            canvas[band : band + 22, x:end] = other * shade
            canvas[band + 6 : band + 10, x + 3 : max(end - 3, x + 3)] = (0.95, 0.94, 0.9)
            canvas[band + 34 : band + 37, x + 4 : max(end - 4, x + 4)] = other
            x += wide
    return to_image(canvas)
