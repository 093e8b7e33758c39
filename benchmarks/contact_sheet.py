"""Interior views of generated houses on one sheet, as a robot's camera sees them.

Run: python benchmarks/contact_sheet.py --first 4000 --houses 24 --out docs/images/houses.jpg

From every house the view that shows most things is taken, of four in different rooms; which rooms
these are is turned on from house to house, or there would be nothing but living rooms.
"""

from pathlib import Path

import numpy as np
import tyro
from PIL import Image

from hypernav.houses.export.page import interior_views
from hypernav.houses.generator import build_house, plan_of

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
        first: First house.
        houses: So many houses follow each other, one view each.
        columns: Of the sheet.
        width: Of one view, pixels.
        quality: Of the JPEG.
        out: The image.
    """
    height = width * 3 // 4
    rows = -(-houses // columns)
    size = (columns * (width + GAP) + GAP, rows * (height + GAP) + GAP)
    sheet = Image.new("RGB", size, "white")
    for k in range(houses):
        number = first + k
        views = interior_views(build_house(number), plan_of(number), number, 4)
        view = Image.fromarray(np.ascontiguousarray(views[k % len(views)]))
        row, column = divmod(k, columns)
        place = (GAP + column * (width + GAP), GAP + row * (height + GAP))
        sheet.paste(view.resize((width, height), Image.Resampling.LANCZOS), place)
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, quality=quality, optimize=True)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    tyro.cli(main)
