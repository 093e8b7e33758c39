"""Images on objects: paintings, screens, book spines, clock faces, labels, rugs, boards, goods."""

import math

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.textures.patterns import (
    Image,
    cloud_noise,
    mix,
    pixel_grid,
    smooth_noise,
    to_image,
)

Canvas = Float64[np.ndarray, "height width 3"]
INKS = (
    (0.75, 0.2, 0.17),
    (0.9, 0.66, 0.2),
    (0.2, 0.36, 0.55),
    (0.23, 0.45, 0.33),
    (0.88, 0.86, 0.8),
    (0.18, 0.18, 0.2),
    (0.55, 0.3, 0.45),
    (0.85, 0.5, 0.36),
    (0.42, 0.6, 0.68),
    (0.93, 0.8, 0.66),
)


def _hills(rng: RandomStream, width: int, base: float, cells: int) -> Float64[np.ndarray, "width"]:
    line = smooth_noise(rng, 1, width, 1, cells)[0] * 0.7
    return base + 0.16 * (line + 0.3 * smooth_noise(rng, 1, width, 1, cells * 3)[0])


def landscape(rng: RandomStream, height: int = 192, width: int = 256) -> Canvas:
    """Landscape painting: sky, sun, hills and water."""
    row, column = pixel_grid(height, width)
    skies = (
        ((0.35, 0.55, 0.82), (0.9, 0.9, 0.86)),
        ((0.86, 0.45, 0.3), (0.97, 0.85, 0.55)),
        ((0.5, 0.62, 0.75), (0.93, 0.85, 0.8)),
    )
    top, low = rng.choice(skies)
    canvas = mix(top, low, row * 1.7)
    sun_x, sun_y = rng.uniform(0.2, 0.8), rng.uniform(0.15, 0.4)
    sun = np.sqrt(((column - sun_x) * width / height) ** 2 + (row - sun_y) ** 2) < 0.06
    canvas[sun] = (1.0, 0.97, 0.85)
    greens = ((0.45, 0.55, 0.62), (0.33, 0.5, 0.42), (0.24, 0.38, 0.22), (0.5, 0.48, 0.2))
    for k, ink in enumerate(greens):
        line = _hills(rng, width, 0.42 + 0.14 * k, 3 + k)
        shade = 0.8 + 0.4 * smooth_noise(rng, height, width, 24, 32)[..., None]
        canvas = np.where((row > line[None, :])[..., None], np.array(ink) * shade, canvas)
    return canvas


def abstract(rng: RandomStream, height: int = 192, width: int = 192) -> Canvas:
    """Abstract painting: overlapping fields of colour."""
    row, column = pixel_grid(height, width)
    canvas = np.ones((height, width, 3)) * np.array(rng.choice(INKS[4:5] + INKS[9:]))
    for _ in range(rng.integer(5, 9)):
        ink = np.array(rng.choice(INKS))
        cx, cy, size = rng.unit(), rng.unit(), rng.uniform(0.1, 0.3)
        if rng.chance(0.5):
            area = (column - cx) ** 2 + (row - cy) ** 2 < size * size
        else:
            area = (np.abs(column - cx) < size) & (np.abs(row - cy) < size * rng.uniform(0.4, 1.4))
        canvas = np.where(area[..., None], ink, canvas)
    return canvas * (0.92 + 0.12 * smooth_noise(rng, height, width, 40, 40)[..., None])


def still_life(rng: RandomStream, height: int = 224, width: int = 176) -> Canvas:
    """Still life: a vase with blossoms on a table."""
    row, column = pixel_grid(height, width)
    canvas = mix((0.5, 0.47, 0.42), (0.75, 0.7, 0.62), smooth_noise(rng, height, width, 6, 6))
    canvas[row > 0.78] = (0.4, 0.27, 0.18)
    body = np.abs(column - 0.5) < 0.13 * np.sqrt(
        np.clip(1.0 - ((row - 0.72) / 0.17) ** 2, 0.0, 1.0)
    )
    canvas[body] = rng.choice(INKS[2:5])
    for _ in range(26):
        angle, reach = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.0, 0.22)
        cx, cy = 0.5 + reach * math.cos(angle) * 1.2, 0.36 + reach * math.sin(angle)
        petal = (column - cx) ** 2 * (width / height) ** 2 + (row - cy) ** 2 < rng.uniform(
            0.02, 0.06
        ) ** 2
        canvas[petal] = rng.choice((INKS[0], INKS[1], INKS[7], INKS[4], (0.25, 0.42, 0.2)))
    return canvas


def portrait(rng: RandomStream, height: int = 224, width: int = 176) -> Canvas:
    """Portrait: head and shoulders before a plain background."""
    row, column = pixel_grid(height, width)
    ground = rng.choice(INKS)
    canvas = mix(ground, (0.2, 0.18, 0.17), np.abs(column - 0.5) + 0.3 * row)
    coat = (
        np.abs(column - 0.5) < 0.34 * np.sqrt(np.clip((row - 0.62) / 0.38, 0.0, 1.0)) + 0.05
    ) & (row > 0.62)
    canvas[coat] = rng.choice(INKS)
    skin = rng.choice(((0.9, 0.74, 0.62), (0.62, 0.44, 0.33), (0.8, 0.62, 0.48)))
    hair = ((column - 0.5) / 0.2) ** 2 + ((row - 0.37) / 0.2) ** 2 < 1.0
    canvas[hair] = rng.choice(((0.2, 0.14, 0.1), (0.45, 0.3, 0.16), (0.7, 0.6, 0.45)))
    face = ((column - 0.5) / 0.14) ** 2 + ((row - 0.42) / 0.18) ** 2 < 1.0
    canvas[face | ((np.abs(column - 0.5) < 0.06) & (row > 0.5) & (row < 0.68))] = skin
    for side in (-0.055, 0.055):
        canvas[((column - 0.5 - side) ** 2 + (row - 0.4) ** 2) < 0.012**2] = (0.12, 0.1, 0.1)
    canvas[(np.abs(column - 0.5) < 0.04) & (np.abs(row - 0.51) < 0.006)] = (0.6, 0.25, 0.25)
    return canvas


def painting(rng: RandomStream) -> Image:
    """Painting in a frame: a landscape, abstract, still life or portrait."""
    return to_image(rng.choice((landscape, abstract, still_life, portrait, landscape))(rng))


def screen_off(rng: RandomStream, height: int = 96, width: int = 160) -> Image:
    """Dark screen with the faint reflection of a window."""
    row, column = pixel_grid(height, width)
    glow = np.clip(1.0 - np.abs(column - 0.3 - 0.25 * row) * 4.0, 0.0, 1.0) * (1.0 - row)
    return to_image(mix((0.035, 0.037, 0.042), (0.14, 0.15, 0.17), glow))


def screen_show(rng: RandomStream) -> Image:
    """Television programme: a landscape or a speaker, with a title bar."""
    canvas = landscape(rng, 180, 320)
    row, column = pixel_grid(180, 320)
    if rng.chance(0.4):
        speaker = portrait(rng, 180, 176)
        canvas[:, 72:248] = speaker
    bar = (row > 0.8) & (row < 0.93) & (column > 0.05) & (column < 0.75)
    canvas[bar] = rng.choice(INKS[:4])
    letters = bar & ((np.floor(column * 60) % 3) < 2) & (row > 0.835) & (row < 0.89)
    canvas[letters & (column < 0.65)] = (0.97, 0.97, 0.97)
    return to_image(canvas)


def screen_desktop(rng: RandomStream, height: int = 160, width: int = 256) -> Image:
    """Desktop of a computer with windows."""
    row, column = pixel_grid(height, width)
    canvas = landscape(rng, height, width) * 0.9
    for _ in range(2):
        x0, y0 = rng.uniform(0.04, 0.35), rng.uniform(0.08, 0.25)
        x1, y1 = x0 + rng.uniform(0.35, 0.55), y0 + rng.uniform(0.4, 0.55)
        window = (column > x0) & (column < x1) & (row > y0) & (row < y1)
        canvas[window] = (0.95, 0.95, 0.96)
        canvas[window & (row < y0 + 0.06)] = (0.3, 0.42, 0.6)
        lines = window & ((row * 40.0) % 2.0 < 0.8) & (row > y0 + 0.1) & (column > x0 + 0.03)
        canvas[lines & (column < x1 - 0.03 - 0.12 * ((np.floor(row * 20) * 7) % 3))] = (
            0.4,
            0.4,
            0.45,
        )
    canvas[row > 0.94] = (0.15, 0.17, 0.2)
    return to_image(canvas)


def book_spines(rng: RandomStream, height: int = 128, width: int = 512) -> Image:
    """Spines of a row of books on a shelf; about 0.8 m × 0.26 m."""
    canvas = np.ones((height, width, 3)) * 0.07
    x = 0
    while x < width:
        thick = rng.integer(9, 26)
        top = rng.integer(2, int(height * 0.28))
        ink = np.array(rng.choice(INKS)) * rng.uniform(0.7, 1.05)
        end = min(x + thick, width)
        canvas[top:, x:end] = ink
        canvas[top:, x : min(x + 1, width)] *= 0.6
        canvas[top:, max(end - 2, x) : end] *= 0.75
        light = np.array((0.95, 0.9, 0.75)) if ink.mean() < 0.5 else np.array((0.15, 0.12, 0.1))
        at = top + rng.integer(8, 20)
        canvas[at : at + 26, x + thick // 3 : min(x + 2 * thick // 3, width)] = light
        canvas[at + 38 : at + 41, x:end] = light
        x = end
    return to_image(canvas)


def clock_face(rng: RandomStream, size: int = 192) -> Image:
    """Clock face with marks and hands."""
    row, column = pixel_grid(size, size)
    dy, dx = 0.5 - row, column - 0.5
    radius = np.sqrt(dx * dx + dy * dy)
    angle = np.arctan2(dx, dy) % (2.0 * np.pi)
    canvas = np.ones((size, size, 3)) * 0.95
    hour = (angle / (2 * np.pi) * 12.0 + 0.5) % 1.0 - 0.5
    minute = (angle / (2 * np.pi) * 60.0 + 0.5) % 1.0 - 0.5
    canvas[(np.abs(hour) * radius < 0.014) & (radius > 0.36) & (radius < 0.46)] = 0.08
    canvas[(np.abs(minute) * radius < 0.03) & (radius > 0.43) & (radius < 0.46)] = 0.2

    def hand(turn: float, length: float, width: float) -> Bool[np.ndarray, "height width"]:
        s, c = math.sin(2 * math.pi * turn), math.cos(2 * math.pi * turn)
        along, across = dx * s + dy * c, dx * c - dy * s
        return (np.abs(across) < width) & (along > -0.05) & (along < length)

    canvas[hand(rng.unit(), 0.25, 0.014) | hand(rng.unit(), 0.38, 0.009)] = 0.06
    canvas[radius < 0.025] = 0.06
    return to_image(canvas)


def keyboard(rng: RandomStream, height: int = 96, width: int = 256) -> Image:
    """Keyboard with rows of keys."""
    row, column = pixel_grid(height, width)
    r, c = (row * 5.6 + 0.7) % 1.0, (column * 15.5 + np.floor(row * 5.6 + 0.7) * 0.3) % 1.0
    key = (r > 0.16) & (c > 0.14)
    space = (row > 0.87) & (np.abs(column - 0.45) < 0.2)
    tone = np.where(key | space, 0.8 - 0.25 * r, 0.12)
    return to_image(np.where((row < 0.04) | (row > 0.97), 0.1, tone))


def label(rng: RandomStream, height: int = 96, width: int = 128) -> Image:
    """Printed label or package: a field of colour, a stripe, lines of text."""
    row, column = pixel_grid(height, width)
    ink, other = rng.choice(INKS[:4]), rng.choice(INKS)
    canvas = np.ones((height, width, 3)) * np.array(ink)
    canvas[(row > 0.3) & (row < 0.62)] = other if other != ink else INKS[4]
    canvas[((column - 0.5) ** 2 + (row - 0.46) ** 2) < 0.02] = (0.97, 0.95, 0.9)
    text = ((row * 26.0) % 2.0 < 0.9) & (row > 0.7) & (row < 0.92) & (np.abs(column - 0.5) < 0.4)
    canvas[text] = (0.95, 0.95, 0.93)
    return to_image(canvas)


def rug(rng: RandomStream, height: int = 256, width: int = 384) -> Image:
    """Carpet with borders and an inner pattern."""
    row, column = pixel_grid(height, width)
    palettes = (
        ((0.5, 0.13, 0.12), (0.85, 0.75, 0.58), (0.14, 0.17, 0.3)),
        ((0.85, 0.83, 0.78), (0.45, 0.46, 0.48), (0.65, 0.64, 0.62)),
        ((0.2, 0.3, 0.45), (0.85, 0.82, 0.74), (0.6, 0.35, 0.25)),
        ((0.72, 0.62, 0.47), (0.35, 0.25, 0.18), (0.9, 0.86, 0.76)),
        ((0.36, 0.45, 0.4), (0.87, 0.84, 0.75), (0.75, 0.5, 0.28)),
    )
    ground, ink, accent = rng.choice(palettes)
    canvas = np.ones((height, width, 3)) * np.array(ground)
    kind = rng.integer(0, 3)
    if kind == 0:
        lattice = np.abs((row * 4) % 1 - 0.5) + np.abs((column * 6) % 1 - 0.5)
        canvas[np.abs(lattice - 0.5) < 0.06] = ink
        canvas[lattice < 0.15] = accent
    elif kind == 1:
        band = np.floor(column * 14).astype(np.int64) % 4
        canvas[band == 1], canvas[band == 3] = ink, accent
    elif kind == 2:
        medallion = ((row - 0.5) / 0.36) ** 2 + ((column - 0.5) / 0.3) ** 2
        canvas[(medallion % 0.5) < 0.22] = accent
        canvas[medallion < 0.3] = ink
    edge = np.minimum(np.minimum(row, 1 - row) * height, np.minimum(column, 1 - column) * width)
    if kind != 3:
        canvas[(edge < 34) & (edge > 10)] = ink
        canvas[(edge < 27) & (edge > 17)] = accent
    tufts = 0.8 + 0.3 * smooth_noise(rng, height, width, height // 2, width // 2)
    return to_image(canvas * tufts[..., None])


def outdoors(rng: RandomStream, height: int = 256, width: int = 256) -> Image:
    """View out of a window: bright sky, trees, perhaps houses."""
    row, column = pixel_grid(height, width)
    clouds = (
        smooth_noise(rng, height, width, 5, 4) * 0.6 + smooth_noise(rng, height, width, 12, 8) * 0.4
    )
    canvas = mix((0.66, 0.8, 0.95), (0.97, 0.98, 1.0), clouds * 0.9 + row * 0.5)
    if rng.chance(0.6):
        for _ in range(5):
            left, wide = rng.unit(), rng.uniform(0.1, 0.25)
            roof = rng.uniform(0.4, 0.62)
            house = (column > left) & (column < left + wide) & (row > roof)
            canvas[house] = np.array(
                rng.choice(((0.8, 0.74, 0.66), (0.66, 0.6, 0.56), (0.85, 0.83, 0.8)))
            )
            panes = house & ((column * 40) % 2 < 0.9) & ((row * 30) % 2 < 0.9)
            canvas[panes] = (0.45, 0.5, 0.56)
    for k in range(3):
        line = _hills(rng, width, 0.5 + 0.12 * k, 6)
        leaves = 0.6 + 0.7 * cloud_noise(rng, 256, 24, octaves=3)[:height, :width]
        shade = np.array((0.42, 0.55, 0.33)) * (1.0 - 0.15 * k) * leaves[..., None]
        canvas = np.where((row > line[None, :])[..., None], shade, canvas)
    return to_image(np.clip(canvas * 1.08, 0.0, 1.0))


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
