"""Views of generated buildings on one sheet: from inside, as a robot's camera sees them, or above.

Run: python benchmarks/contact_sheet.py --first 4000 --count 24 --out docs/images/houses.jpg
     python benchmarks/contact_sheet.py --kind shops --count 6 --columns 3 --above --out shops.jpg

Every building contributes one of the four views that show most objects, each in another room. The
rank of the chosen view changes from one to the next: the sheet does not show living rooms only.
"""

from contextlib import closing
from pathlib import Path

import numpy as np
import tyro
from PIL import Image, ImageOps

from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.export.building_views import interior_views, view_from_above
from hypernav.simulator.houses.generator import generate, plan_of
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

GAP = 6


def main(
    kind: str = "houses",
    first: int = 4000,
    count: int = 24,
    columns: int = 4,
    above: bool = False,
    width: int = 400,
    quality: int = 82,
    out: Path = Path("houses.jpg"),
) -> None:
    """Write the sheet.

    Args:
        kind: Kind of the buildings: houses, offices or shops.
        first: Number of the first building.
        count: Number of consecutive buildings, one view each.
        columns: Number of columns of the sheet.
        above: Whether to show each building without its ceilings from above.
        width: Width of one view, pixels.
        quality: Quality of the JPEG, 1 to 95.
        out: File of the image.
    """
    height = width * 3 // 4
    rows = -(-count // columns)
    size = (columns * (width + GAP) + GAP, rows * (height + GAP) + GAP)
    sheet = Image.new("RGB", size, "white")
    for k in range(count):
        building = Building(kind, first + k)
        scene = generate(building)
        if above:
            image = view_from_above(scene)
        else:
            grid = WalkableGrid.from_scene(scene)
            with closing(CpuRenderer(scene)) as renderer:
                views = interior_views(
                    scene, plan_of(building), building.number, 4, grid=grid, renderer=renderer
                )
            image = views[k % len(views)]
        view = ImageOps.contain(Image.fromarray(np.ascontiguousarray(image)), (width, height))
        row, column = divmod(k, columns)
        left = GAP + column * (width + GAP) + (width - view.width) // 2
        top = GAP + row * (height + GAP) + (height - view.height) // 2
        sheet.paste(view, (left, top))
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, quality=quality, optimize=True)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    tyro.cli(main)
