"""Interior views of generated houses on one sheet, as a robot's camera sees them.

Run: python benchmarks/contact_sheet.py --first 4000 --houses 24 --out docs/images/houses.jpg

Every house contributes one of the four views that show most objects, each in another room. The rank
of the chosen view changes from house to house, so that the sheet does not show living rooms only.
"""

from pathlib import Path

import numpy as np
import tyro
from PIL import Image

from hypernav.houses.building import house
from hypernav.houses.export.page import interior_views
from hypernav.houses.generator import generate, plan_of

GAP = 6


def main(
    first: int = 4000,
    houses: int = 24,
    columns: int = 4,
    width: int = 400,
    quality: int = 82,
    out: Path = Path("houses.jpg"),
) -> None:
    """Write the sheet.

    Args:
        first: Number of the first house.
        houses: Number of consecutive houses, one view each.
        columns: Number of columns of the sheet.
        width: Width of one view, pixels.
        quality: Quality of the JPEG, 1 to 95.
        out: File of the image.
    """
    height = width * 3 // 4
    rows = -(-houses // columns)
    size = (columns * (width + GAP) + GAP, rows * (height + GAP) + GAP)
    sheet = Image.new("RGB", size, "white")
    for k in range(houses):
        number = first + k
        views = interior_views(generate(house(number)), plan_of(house(number)), number, 4)
        view = Image.fromarray(np.ascontiguousarray(views[k % len(views)]))
        row, column = divmod(k, columns)
        corner = (GAP + column * (width + GAP), GAP + row * (height + GAP))
        sheet.paste(view.resize((width, height), Image.Resampling.LANCZOS), corner)
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, quality=quality, optimize=True)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    tyro.cli(main)
