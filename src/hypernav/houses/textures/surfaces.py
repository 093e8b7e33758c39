"""Textures that cover a surface without end: wood, cloth, tiles, stone, walls.

They are light and nearly grey, so that the colour of a finish tints them.
"""

import numpy as np

from hypernav.houses.dice import Dice
from hypernav.houses.textures.noise import (
    Gray,
    Picture,
    cloud_noise,
    mix,
    pixel_grid,
    smooth_noise,
    speckle,
    to_picture,
)


def wood(dice: Dice, size: int = 512, contrast: float = 0.3) -> Picture:
    """Boards with the grain along u; one picture covers about a metre."""
    bend = smooth_noise(dice, size, size, 4, 2) * 0.25
    row, _ = pixel_grid(size, size)
    rings = (np.floor((row + bend) * 8) % 1, (row + bend * 0.6) * 14.0)[1]
    wave = 0.5 + 0.5 * np.sin(2.0 * np.pi * rings)
    grain = cloud_noise(dice, size, 64, octaves=3, stretch=32)
    pores = (smooth_noise(dice, size, size, 256, 16) > 0.82) * 0.35
    tone = 1.0 - contrast * (0.35 * wave + 0.75 * grain + 0.4 * pores)
    return to_picture(np.stack([tone, tone**1.12, tone**1.3], axis=2))


def satin(dice: Dice, size: int = 256) -> Picture:
    """Painted wood: even, with a trace of brush strokes along u; about 1 m."""
    strokes = cloud_noise(dice, size, 64, octaves=2, stretch=32)
    return to_picture(0.975 + 0.03 * (strokes - 0.5) + 0.02 * (cloud_noise(dice, size, 4) - 0.5))


def planks(dice: Dice, size: int = 512, rows: int = 10, contrast: float = 0.3) -> Picture:
    """A floor of planks along u; one picture covers about 1.2 m."""
    row, column = pixel_grid(size, size)
    number = np.floor(row * rows).astype(np.int64)
    shift = dice.array(rows)[number]
    along = (column + shift) % 1.0
    half = np.floor(along * 2.0).astype(np.int64)
    tone = 0.78 + 0.22 * dice.array(rows, 2)[number, half]
    grain = cloud_noise(dice, size, 64, octaves=3, stretch=24)
    streak = np.abs(smooth_noise(dice, size, size, 40, 3) - 0.5) * 0.5
    tone = tone * (1.0 - contrast * (grain * 0.7 + streak))
    edge_row = (row * rows) % 1.0
    edge_column = (along * 2.0) % 1.0
    gap = (edge_row < 0.045) | (edge_column < 0.006)
    tone = np.where(gap, tone * 0.62, tone)
    return to_picture(np.stack([tone, tone**1.1, tone**1.25], axis=2))


def fabric(dice: Dice, size: int = 256, coarse: float = 0.16) -> Picture:
    """A plain weave; one picture covers about 0.3 m."""
    row, column = pixel_grid(size, size)
    threads = 64
    weave = np.sin(2 * np.pi * threads * row) * np.sin(2 * np.pi * threads * column)
    tone = 0.9 + coarse * 0.35 * weave + coarse * (speckle(dice, size) - 0.5)
    tone += coarse * 0.6 * (cloud_noise(dice, size, 8) - 0.5)
    return to_picture(tone)


def pile(dice: Dice, size: int = 256, depth: float = 0.35) -> Picture:
    """Carpet, terry and wool: short hairs with shadows between; about 0.4 m."""
    tufts = smooth_noise(dice, size, size, size // 3, size // 3)
    tone = 1.0 - depth * tufts - 0.4 * depth * speckle(dice, size)
    return to_picture(tone + 0.1 * (cloud_noise(dice, size, 4) - 0.5))


def leather(dice: Dice, size: int = 256) -> Picture:
    """Grained hide; about 0.4 m."""
    folds = np.abs(smooth_noise(dice, size, size, 48, 48) - 0.5) * 2.0
    tone = 0.82 + 0.14 * folds**0.5 + 0.16 * (cloud_noise(dice, size, 4) - 0.5)
    return to_picture(tone)


def tiles(
    dice: Dice,
    size: int = 512,
    columns: int = 3,
    rows: int = 3,
    *,
    brick: bool = False,
    joint: float = 0.012,
    spread: float = 0.05,
    joint_tone: float = 0.72,
) -> Picture:
    """Ceramic tiles with joints; one picture holds ``columns`` × ``rows`` of them."""
    row, column = pixel_grid(size, size)
    number = np.floor(row * rows).astype(np.int64)
    across = column + (number % 2) * 0.5 / columns if brick else column
    place = np.floor(across * columns).astype(np.int64) % columns
    tone = 0.97 - spread * dice.array(rows, columns)[number, place]
    tone = tone - 0.06 * (cloud_noise(dice, size, 6) - 0.5)
    fr, fc = (row * rows) % 1.0 / rows, (across * columns) % 1.0 / columns
    near = np.minimum(np.minimum(fr, 1.0 / rows - fr), np.minimum(fc, 1.0 / columns - fc))
    tone = np.where(near < joint / 2.0, joint_tone, tone)
    return to_picture(tone)


def marble(dice: Dice, size: int = 512, strength: float = 0.35) -> Picture:
    """Stone with veins; about 1.2 m."""
    warp = cloud_noise(dice, size, 4, octaves=5)
    row, column = pixel_grid(size, size)
    vein = np.abs(np.sin(2.0 * np.pi * (column + row + 2.2 * (warp - 0.5))))
    tone = 1.0 - strength * (1.0 - np.minimum(vein * 3.0, 1.0)) * cloud_noise(dice, size, 6)
    tone -= 0.1 * (cloud_noise(dice, size, 3) - 0.5)
    return to_picture(np.stack([tone, tone, tone**0.97], axis=2))


def granite(dice: Dice, size: int = 256) -> Picture:
    """Stone of many grains, for worktops; about 0.4 m."""
    grains = smooth_noise(dice, size, size, size // 4, size // 4)
    tone = 0.85 + 0.3 * (grains - 0.5) + 0.15 * (speckle(dice, size) - 0.5)
    return to_picture(tone)


def plaster(dice: Dice, size: int = 256, depth: float = 0.05) -> Picture:
    """A painted wall; about 1.5 m."""
    tone = 0.975 + depth * (cloud_noise(dice, size, 6, octaves=5) - 0.5)
    return to_picture(tone + depth * 0.4 * (speckle(dice, size) - 0.5))


def wallpaper(dice: Dice, size: int = 256, kind: int = 0) -> Picture:
    """Paper with a quiet pattern: stripes, rhombs or flowers; about 0.5 m."""
    row, column = pixel_grid(size, size)
    if kind == 0:
        pattern = (np.floor(column * 8.0) % 2) * 1.0
    elif kind == 1:
        pattern = ((np.floor((row + column) * 6.0) + np.floor((row - column) * 6.0)) % 2) * 1.0
    else:
        pattern = np.zeros((size, size))
        for cy, cx in ((0.25, 0.25), (0.75, 0.75)):
            dy, dx = row - cy, column - cx
            radius = np.sqrt(dy * dy + dx * dx)
            petals = 0.13 + 0.05 * np.cos(6.0 * np.arctan2(dy, dx))
            pattern = np.maximum(pattern, (radius < petals) * 1.0)
    tone = 0.97 - 0.07 * pattern + 0.03 * (cloud_noise(dice, size, 8) - 0.5)
    return to_picture(tone)


def brushed(dice: Dice, size: int = 256) -> Picture:
    """Brushed metal, strokes along u; about 0.6 m."""
    strokes = smooth_noise(dice, size, size, size, 6)
    broad = smooth_noise(dice, size, size, 6, 2)
    return to_picture(0.86 + 0.1 * (strokes - 0.5) + 0.16 * (broad - 0.5))


def bricks(dice: Dice, size: int = 256) -> Picture:
    """Masonry; about 0.8 m."""
    wall = tiles(dice, size, 4, 10, brick=True, joint=0.016, spread=0.35, joint_tone=0.95)
    rough = 1.0 - 0.25 * cloud_noise(dice, size, 24)
    return to_picture(wall / 255.0 * rough[..., None])


def concrete(dice: Dice, size: int = 256) -> Picture:
    """Cast concrete, stone pots, asphalt; about 1 m."""
    tone = 0.86 + 0.2 * (cloud_noise(dice, size, 4, octaves=6) - 0.5)
    return to_picture(tone - 0.12 * (speckle(dice, size) > 0.97))


def wicker(dice: Dice, size: int = 256, strands: int = 12) -> Picture:
    """Woven cane; about 0.3 m."""
    row, column = pixel_grid(size, size)
    over = (np.floor(row * strands) + np.floor(column * strands)) % 2
    across = np.where(over > 0, (row * strands) % 1.0, (column * strands) % 1.0)
    tone = 0.45 + 0.55 * np.sin(np.pi * across) - 0.1 * speckle(dice, size)
    return to_picture(tone)


def soil(dice: Dice, size: int = 128) -> Picture:
    """Potting earth; about 0.2 m."""
    lumps = smooth_noise(dice, size, size, 32, 32) * 0.6 + speckle(dice, size) * 0.4
    return to_picture(mix((0.1, 0.07, 0.05), (0.34, 0.25, 0.18), lumps))


def leaf(dice: Dice, size: int = 128, stripes: bool = False) -> Picture:
    """One leaf, its middle rib along v, fitted to the blade."""
    row, column = pixel_grid(size, size)
    off = np.abs(column - 0.5) * 2.0
    veins = np.abs(((row * 9.0 + off * 3.0) % 1.0) - 0.5) * 2.0
    tone = 0.72 + 0.16 * veins * (1.0 - off) + 0.16 * (cloud_noise(dice, size, 6) - 0.5)
    tone = np.where(off < 0.05, 1.0, tone)
    if stripes:
        bands = smooth_noise(dice, size, size, 14, 3)
        tone = tone * np.where(bands > 0.55, 0.72, 1.0)
        edge = np.clip((off - 0.75) * 6.0, 0.0, 1.0)
        return to_picture(
            np.stack(
                [
                    tone * (1 - edge) + edge,
                    tone * (1 - edge) + edge,
                    tone * (1 - edge) + 0.55 * edge,
                ],
                2,
            )
        )
    return to_picture(np.stack([tone * 0.98, tone, tone * 0.92], axis=2))


def stripes(dice: Dice, size: int = 256, count: int = 6, depth: float = 0.35) -> Picture:
    """Cloth with stripes; about 0.6 m."""
    _, column = pixel_grid(size, size)
    lines = np.where((column * count) % 1.0 < 0.45, 1.0 - depth, 1.0)
    return to_picture(lines * (0.95 + 0.06 * (speckle(dice, size) - 0.5)))


def plaid(dice: Dice, size: int = 256, count: int = 4, depth: float = 0.4) -> Picture:
    """Cloth with a check; about 0.6 m."""
    row, column = pixel_grid(size, size)

    def bands(at: Gray) -> Gray:
        wide = ((at * count) % 1.0 < 0.4) * 0.6
        thin = (np.abs((at * count) % 1.0 - 0.7) < 0.03) * 0.8
        return wide + thin

    tone = 1.0 - depth * 0.5 * (bands(row) + bands(column))
    return to_picture(tone + 0.06 * (speckle(dice, size) - 0.5))


def floral(dice: Dice, size: int = 256, count: int = 14) -> Picture:
    """Cloth with blossoms on a light ground; about 0.8 m."""
    row, column = pixel_grid(size, size)
    picture = np.ones((size, size, 3)) * 0.96
    inks = ((0.78, 0.36, 0.42), (0.36, 0.5, 0.72), (0.86, 0.66, 0.3), (0.45, 0.6, 0.4))
    for _ in range(count):
        cy, cx, radius = dice.unit(), dice.unit(), dice.uniform(0.04, 0.09)
        dy = (row - cy + 0.5) % 1.0 - 0.5
        dx = (column - cx + 0.5) % 1.0 - 0.5
        distance = np.sqrt(dx * dx + dy * dy)
        flower = distance < radius * (0.75 + 0.25 * np.cos(5.0 * np.arctan2(dy, dx)))
        picture[flower] = dice.choice(inks)
        picture[distance < radius * 0.25] = (0.95, 0.85, 0.5)
    return to_picture(picture - 0.05 * speckle(dice, size)[..., None])


def cardboard(dice: Dice, size: int = 128) -> Picture:
    """Brown board; about 0.5 m."""
    tone = 0.9 + 0.1 * (smooth_noise(dice, size, size, 64, 4) - 0.5)
    return to_picture(tone + 0.05 * (speckle(dice, size) - 0.5))
