"""Buildings with stairs: a row for each, with a section along hall and stairs and all storeys.

Run: python benchmarks/storey_pictures.py 3012 3024 --out docs/images/storeys.jpg

The section leaves out what lies before the hall and the stairs. Storeys are shown from above,
without their ceilings; what is sky blue in them is an opening in the floor.
"""

import math
from contextlib import closing
from pathlib import Path

import numpy as np
import tyro
from PIL import Image, ImageDraw, ImageFont, ImageOps

from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.export.building_views import views_from_above
from hypernav.simulator.houses.generator import generate, storeys_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene

GAP, TEXT = 8, 22
FLOORS = {-1: "basement", 0: "ground floor", 1: "first floor", 2: "second floor"}


def main(
    numbers: tyro.conf.Positional[tuple[int, ...]],
    width: int = 480,
    quality: int = 82,
    out: Path = Path("storeys.jpg"),
) -> None:
    """Write the sheet.

    Args:
        numbers: Numbers of the buildings.
        width: Width of one picture, pixels.
        quality: Quality of the JPEG, 1 to 95.
        out: File of the image.
    """
    rows = [pictures(Building("storeys", number)) for number in numbers]
    height = width * 2 // 3
    columns = max(map(len, rows))
    size = (columns * (width + GAP) + GAP, len(rows) * (height + TEXT + GAP) + GAP)
    sheet = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(15)
    for row, shown in enumerate(rows):
        for column, (words, image) in enumerate(shown):
            left = GAP + column * (width + GAP)
            top = GAP + row * (height + TEXT + GAP)
            draw.text((left, top), words, "black", font)
            view = ImageOps.contain(Image.fromarray(image), (width, height))
            sheet.paste(view, (left, top + TEXT))
    out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(out, quality=quality, optimize=True)
    print(f"{out}: {out.stat().st_size / 1000:.0f} kB")


def pictures(building: Building) -> list[tuple[str, np.ndarray]]:
    """The pictures of one building with their titles."""
    scene, storeys = generate(building), storeys_of(building)
    use = "home" if building.number % 2 == 0 else "office"
    shown = [(f"{building.scene}, {use}: section along hall and stairs", section(scene, storeys))]
    lowest = -1 if storeys[0].floor_z < 0.0 else 0
    for number, view in enumerate(views_from_above(scene, storeys)):
        floor = f"{FLOORS[lowest + number]}, {storeys[number].floor_z:.1f} m"
        shown.append((floor, np.ascontiguousarray(view)))
    return shown


def section(scene: Scene, storeys: tuple[FloorPlan, ...], width: int = 1280) -> np.ndarray:
    """The building from one of its long sides, without what lies before hall and stairs."""
    stairs = storeys[0].stairwell
    assert stairs is not None
    hall, well = (storeys[0].rooms[k].inner for k in (0, stairs.room))
    corners = scene.vertices[scene.faces]
    x = corners[:, :, 0].mean(axis=1)
    cut = np.where((x > well.x0) & (x < well.x1), well.y0, hall.y0) + 0.02
    whole = scene.of_faces(corners[:, :, 1].max(axis=1) > cut)
    low, high = (f(scene.vertices.astype(np.float64), axis=0) for f in (np.min, np.max))
    middle, size = (low + high) / 2.0, high - low
    focal, pitch = 3.0 * width, 8.0
    away = 1.05 * size[0] * focal / width
    camera = PinholeCamera(width, width * 2 // 3, focal, focal, width / 2, width / 3)
    eye = Pose2(float(middle[0]), float(well.y0) - away, math.pi / 2.0)
    above = float(middle[2]) + away * math.tan(math.radians(pitch))
    pose = eye.to_transform(above) @ optical_to_base(0.0, pitch)
    with closing(CpuRenderer(whole)) as renderer:
        return renderer.render(camera, pose).rgb


if __name__ == "__main__":
    tyro.cli(main)
