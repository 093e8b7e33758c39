"""Noise, and the textures of surfaces: wood, cloth, tiles, stone."""

import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.simulator.houses.random_stream import RandomStream

Gray = Float64[np.ndarray, "height width"]
Image = UInt8[np.ndarray, "height width 3"]


def smooth_noise(rng: RandomStream, height: int, width: int, rows: int, columns: int) -> Gray:
    """Periodic noise in [0, 1): random values on a lattice, interpolated smoothly.

    Args:
        rng: Source of randomness.
        height: Height of the image, pixels.
        width: Width of the image, pixels.
        rows: Number of lattice cells from top to bottom.
        columns: Number of lattice cells from left to right.
    """
    lattice = rng.array(rows, columns)
    y, fy = _split(height, rows)
    x, fx = _split(width, columns)
    y1, x1 = (y + 1) % rows, (x + 1) % columns
    top = lattice[np.ix_(y, x)] * (1.0 - fx) + lattice[np.ix_(y, x1)] * fx
    bottom = lattice[np.ix_(y1, x)] * (1.0 - fx) + lattice[np.ix_(y1, x1)] * fx
    return top * (1.0 - fy[:, None]) + bottom * fy[:, None]


def _split(pixels: int, cells: int) -> tuple[np.ndarray, np.ndarray]:
    at = np.arange(pixels) * (cells / pixels)
    whole = np.floor(at).astype(np.int64)
    part = at - whole
    return whole % cells, part * part * (3.0 - 2.0 * part)


def cloud_noise(
    rng: RandomStream, size: int, cells: int, *, octaves: int = 4, stretch: int = 1
) -> Gray:
    """Fractal noise in about [0, 1], mean one half; ``stretch`` elongates it along columns."""
    total = np.zeros((size, size))
    weight, norm = 1.0, 0.0
    for octave in range(octaves):
        rows = min(cells * 2**octave, size)
        columns = max(rows // stretch, 1)
        total += weight * smooth_noise(rng, size, size, rows, columns)
        norm += weight
        weight *= 0.5
    return total / norm


def speckle(rng: RandomStream, size: int) -> Gray:
    """White noise in [0, 1)."""
    return rng.array(size, size)


def to_image(values: Float64[np.ndarray, "height width *channels"]) -> Image:
    """Numbers from 0 to 1 as an 8-bit sRGB image; grey if there is only one channel."""
    # The unusual offset keeps theoretically exact values away from the rounding boundary.
    bytes_ = np.floor(np.clip(values, 0.0, 1.0) * 255.0 + 0.50137).astype(np.uint8)
    return np.repeat(bytes_[..., None], 3, axis=2) if bytes_.ndim == 2 else bytes_


def mix(
    a: tuple[float, float, float], b: tuple[float, float, float], t: Gray
) -> Float64[np.ndarray, "height width 3"]:
    """Linear interpolation from colour a where t is 0 to colour b where t is 1."""
    t3 = np.clip(t, 0.0, 1.0)[..., None]
    return np.array(a) * (1.0 - t3) + np.array(b) * t3


def pixel_grid(height: int, width: int) -> tuple[Gray, Gray]:
    """Row and column of every pixel, as fractions of the image in [0, 1)."""
    rows = (np.arange(height) + 0.5) / height
    columns = (np.arange(width) + 0.5) / width
    return rows[:, None] + np.zeros((1, width)), columns[None, :] + np.zeros((height, 1))


def wood(rng: RandomStream, size: int = 512, contrast: float = 0.3) -> Image:
    """Boards with the grain along u; one image covers about a metre."""
    bend = smooth_noise(rng, size, size, 4, 2) * 0.25
    row, _ = pixel_grid(size, size)
    rings = (row + bend * 0.6) * 14.0
    wave = 0.5 + 0.5 * np.sin(2.0 * np.pi * rings)
    grain = cloud_noise(rng, size, 64, octaves=3, stretch=32)
    pores = (smooth_noise(rng, size, size, 256, 16) > 0.82) * 0.35
    tone = 1.0 - contrast * (0.35 * wave + 0.75 * grain + 0.4 * pores)
    return to_image(np.stack([tone, tone**1.12, tone**1.3], axis=2))


def satin(rng: RandomStream, size: int = 256) -> Image:
    """Painted wood with faint brush strokes along u; one image covers about 1 m."""
    strokes = cloud_noise(rng, size, 64, octaves=2, stretch=32)
    return to_image(0.975 + 0.03 * (strokes - 0.5) + 0.02 * (cloud_noise(rng, size, 4) - 0.5))


def planks(rng: RandomStream, size: int = 512, rows: int = 10, contrast: float = 0.3) -> Image:
    """A floor of planks along u; one image covers about 1.2 m."""
    row, column = pixel_grid(size, size)
    number = np.floor(row * rows).astype(np.int64)
    shift = rng.array(rows)[number]
    along = (column + shift) % 1.0
    half = np.floor(along * 2.0).astype(np.int64)
    tone = 0.78 + 0.22 * rng.array(rows, 2)[number, half]
    grain = cloud_noise(rng, size, 64, octaves=3, stretch=24)
    streak = np.abs(smooth_noise(rng, size, size, 40, 3) - 0.5) * 0.5
    tone = tone * (1.0 - contrast * (grain * 0.7 + streak))
    edge_row = (row * rows) % 1.0
    edge_column = (along * 2.0) % 1.0
    gap = (edge_row < 0.045) | (edge_column < 0.006)
    tone = np.where(gap, tone * 0.62, tone)
    return to_image(np.stack([tone, tone**1.1, tone**1.25], axis=2))


def fabric(rng: RandomStream, size: int = 256, coarse: float = 0.16) -> Image:
    """A plain weave; one image covers about 0.3 m."""
    row, column = pixel_grid(size, size)
    threads = 64
    weave = np.sin(2 * np.pi * threads * row) * np.sin(2 * np.pi * threads * column)
    tone = 0.9 + coarse * 0.35 * weave + coarse * (speckle(rng, size) - 0.5)
    tone += coarse * 0.6 * (cloud_noise(rng, size, 8) - 0.5)
    return to_image(tone)


def pile(rng: RandomStream, size: int = 256, depth: float = 0.35) -> Image:
    """Pile of carpet, terry cloth and wool; one image covers about 0.4 m."""
    tufts = smooth_noise(rng, size, size, size // 3, size // 3)
    tone = 1.0 - depth * tufts - 0.4 * depth * speckle(rng, size)
    return to_image(tone + 0.1 * (cloud_noise(rng, size, 4) - 0.5))


def leather(rng: RandomStream, size: int = 256) -> Image:
    """Grained leather; one image covers about 0.4 m."""
    folds = np.abs(smooth_noise(rng, size, size, 48, 48) - 0.5) * 2.0
    tone = 0.82 + 0.14 * folds**0.5 + 0.16 * (cloud_noise(rng, size, 4) - 0.5)
    return to_image(tone)


def tiles(
    rng: RandomStream,
    size: int = 512,
    columns: int = 3,
    rows: int = 3,
    *,
    brick: bool = False,
    joint: float = 0.012,
    spread: float = 0.05,
    joint_tone: float = 0.72,
) -> Image:
    """Ceramic tiles with joints; one image holds ``columns`` × ``rows`` of them."""
    row, column = pixel_grid(size, size)
    number = np.floor(row * rows).astype(np.int64)
    across = column + (number % 2) * 0.5 / columns if brick else column
    cell = np.floor(across * columns).astype(np.int64) % columns
    tone = 0.97 - spread * rng.array(rows, columns)[number, cell]
    tone = tone - 0.06 * (cloud_noise(rng, size, 6) - 0.5)
    fr, fc = (row * rows) % 1.0 / rows, (across * columns) % 1.0 / columns
    near = np.minimum(np.minimum(fr, 1.0 / rows - fr), np.minimum(fc, 1.0 / columns - fc))
    tone = np.where(near < joint / 2.0, joint_tone, tone)
    return to_image(tone)


def marble(rng: RandomStream, size: int = 512, strength: float = 0.35) -> Image:
    """Stone with veins; one image covers about 1.2 m."""
    warp = cloud_noise(rng, size, 4, octaves=5)
    row, column = pixel_grid(size, size)
    vein = np.abs(np.sin(2.0 * np.pi * (column + row + 2.2 * (warp - 0.5))))
    tone = 1.0 - strength * (1.0 - np.minimum(vein * 3.0, 1.0)) * cloud_noise(rng, size, 6)
    tone -= 0.1 * (cloud_noise(rng, size, 3) - 0.5)
    return to_image(np.stack([tone, tone, tone**0.97], axis=2))


def granite(rng: RandomStream, size: int = 256) -> Image:
    """Granite for worktops; one image covers about 0.4 m."""
    grains = smooth_noise(rng, size, size, size // 4, size // 4)
    tone = 0.85 + 0.3 * (grains - 0.5) + 0.15 * (speckle(rng, size) - 0.5)
    return to_image(tone)


def plaster(rng: RandomStream, size: int = 256, depth: float = 0.05) -> Image:
    """Painted wall; one image covers about 1.5 m."""
    tone = 0.975 + depth * (cloud_noise(rng, size, 6, octaves=5) - 0.5)
    return to_image(tone + depth * 0.4 * (speckle(rng, size) - 0.5))


def wallpaper(rng: RandomStream, size: int = 256, kind: int = 0) -> Image:
    """Wallpaper with stripes, rhombs or flowers; one image covers about 0.5 m."""
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
    tone = 0.97 - 0.07 * pattern + 0.03 * (cloud_noise(rng, size, 8) - 0.5)
    return to_image(tone)


def brushed(rng: RandomStream, size: int = 256) -> Image:
    """Brushed metal with strokes along u; one image covers about 0.6 m."""
    strokes = smooth_noise(rng, size, size, size, 6)
    broad = smooth_noise(rng, size, size, 6, 2)
    return to_image(0.86 + 0.1 * (strokes - 0.5) + 0.16 * (broad - 0.5))


def bricks(rng: RandomStream, size: int = 256) -> Image:
    """Brick masonry; one image covers about 0.8 m."""
    wall = tiles(rng, size, 4, 10, brick=True, joint=0.016, spread=0.35, joint_tone=0.95)
    rough = 1.0 - 0.25 * cloud_noise(rng, size, 24)
    return to_image(wall / 255.0 * rough[..., None])


def concrete(rng: RandomStream, size: int = 256) -> Image:
    """Concrete, also of stone pots; one image covers about 1 m."""
    tone = 0.86 + 0.2 * (cloud_noise(rng, size, 4, octaves=6) - 0.5)
    return to_image(tone - 0.12 * (speckle(rng, size) > 0.97))


def wicker(rng: RandomStream, size: int = 256, strands: int = 12) -> Image:
    """Woven cane; one image covers about 0.3 m."""
    row, column = pixel_grid(size, size)
    over = (np.floor(row * strands) + np.floor(column * strands)) % 2
    across = np.where(over > 0, (row * strands) % 1.0, (column * strands) % 1.0)
    tone = 0.45 + 0.55 * np.sin(np.pi * across) - 0.1 * speckle(rng, size)
    return to_image(tone)


def soil(rng: RandomStream, size: int = 128) -> Image:
    """Potting soil; one image covers about 0.2 m."""
    lumps = smooth_noise(rng, size, size, 32, 32) * 0.6 + speckle(rng, size) * 0.4
    return to_image(mix((0.1, 0.07, 0.05), (0.34, 0.25, 0.18), lumps))


def leaf(rng: RandomStream, size: int = 128, stripes: bool = False) -> Image:
    """Leaf of a plant, fitted to its surface, with the middle rib along v."""
    row, column = pixel_grid(size, size)
    off = np.abs(column - 0.5) * 2.0
    veins = np.abs(((row * 9.0 + off * 3.0) % 1.0) - 0.5) * 2.0
    tone = 0.72 + 0.16 * veins * (1.0 - off) + 0.16 * (cloud_noise(rng, size, 6) - 0.5)
    tone = np.where(off < 0.05, 1.0, tone)
    if stripes:
        bands = smooth_noise(rng, size, size, 14, 3)
        tone = tone * np.where(bands > 0.55, 0.72, 1.0)
        edge = np.clip((off - 0.75) * 6.0, 0.0, 1.0)
        return to_image(
            np.stack(
                [
                    tone * (1 - edge) + edge,
                    tone * (1 - edge) + edge,
                    tone * (1 - edge) + 0.55 * edge,
                ],
                2,
            )
        )
    return to_image(np.stack([tone * 0.98, tone, tone * 0.92], axis=2))


def stripes(rng: RandomStream, size: int = 256, count: int = 6, depth: float = 0.35) -> Image:
    """Cloth with stripes; one image covers about 0.6 m."""
    _, column = pixel_grid(size, size)
    lines = np.where((column * count) % 1.0 < 0.45, 1.0 - depth, 1.0)
    return to_image(lines * (0.95 + 0.06 * (speckle(rng, size) - 0.5)))


def plaid(rng: RandomStream, size: int = 256, count: int = 4, depth: float = 0.4) -> Image:
    """Cloth with a check; one image covers about 0.6 m."""
    row, column = pixel_grid(size, size)

    def bands(at: Gray) -> Gray:
        wide = ((at * count) % 1.0 < 0.4) * 0.6
        thin = (np.abs((at * count) % 1.0 - 0.7) < 0.03) * 0.8
        return wide + thin

    tone = 1.0 - depth * 0.5 * (bands(row) + bands(column))
    return to_image(tone + 0.06 * (speckle(rng, size) - 0.5))


def floral(rng: RandomStream, size: int = 256, count: int = 14) -> Image:
    """Cloth with blossoms on a light ground; one image covers about 0.8 m."""
    row, column = pixel_grid(size, size)
    image = np.ones((size, size, 3)) * 0.96
    inks = ((0.78, 0.36, 0.42), (0.36, 0.5, 0.72), (0.86, 0.66, 0.3), (0.45, 0.6, 0.4))
    for _ in range(count):
        cy, cx, radius = rng.unit(), rng.unit(), rng.uniform(0.04, 0.09)
        dy = (row - cy + 0.5) % 1.0 - 0.5
        dx = (column - cx + 0.5) % 1.0 - 0.5
        distance = np.sqrt(dx * dx + dy * dy)
        flower = distance < radius * (0.75 + 0.25 * np.cos(5.0 * np.arctan2(dy, dx)))
        image[flower] = rng.choice(inks)
        image[distance < radius * 0.25] = (0.95, 0.85, 0.5)
    return to_image(image - 0.05 * speckle(rng, size)[..., None])


def cardboard(rng: RandomStream, size: int = 128) -> Image:
    """Brown cardboard; one image covers about 0.5 m."""
    tone = 0.9 + 0.1 * (smooth_noise(rng, size, size, 64, 4) - 0.5)
    return to_image(tone + 0.05 * (speckle(rng, size) - 0.5))
