"""Time the generation of buildings and their loading from the cache.

Run: python benchmarks/houses.py [--kind offices] [--first 100000] [--count 500]

Every building is built from its number and written to a fresh cache folder, then loaded from it as
`hypernav find --scene houses:N` does. The textures that all share are painted once a process; they
count in the first building only. Other programs on the machine affect the times: hence the CPU time
beside them. A number that gives no building ends the program with an error.
"""

import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.generator import generate, plan_of
from hypernav.simulator.houses.house_cache import cached_building
from hypernav.simulator.worlds.scenes.scene import Scene


def main(kind: str = "houses", first: int = 100_000, count: int = 500, cached: int = 30) -> None:
    """Print the table.

    Args:
        kind: Kind of the buildings: houses or offices.
        first: Number of the first building.
        count: Number of buildings to build.
        cached: Number of buildings that are also loaded from the cache.
    """
    console = Console(highlight=False)
    buildings = [Building(kind, number) for number in range(first, first + count)]
    built: list[tuple[float, float]] = []
    per_area: list[float] = []
    objects, triangles, kinds = [], [], Counter[str]()
    for building in buildings:
        scene, wall, cpu = timed(lambda b=building: generate(b))
        built.append((wall, cpu))
        per_area.append(1000.0 * cpu / sum(r.cell.area for r in plan_of(building).rooms))
        labels = [i.label for i in scene.instances if i.label is not None]
        kinds.update({label.category for label in labels})
        objects.append(len(labels))
        triangles.append(len(scene.faces))
    loaded = []
    with tempfile.TemporaryDirectory() as folder:
        for building in buildings[:cached]:
            cached_building(building, Path(folder))
        for building in buildings[:cached]:
            _, wall, cpu = timed(lambda b=building: cached_building(b, Path(folder)))
            loaded.append((wall, cpu))
    table = Table("what", kind, "median s", "p95 s", "most s", "median CPU s")
    for name, spent in (("from its number", built), ("from the cache", loaded)):
        wall, cpu = np.array(spent).T
        values = (np.median(wall), np.quantile(wall, 0.95), wall.max(), np.median(cpu))
        table.add_row(name, str(len(spent)), *(f"{value:.2f}" for value in values))
    console.print(table)
    console.print(
        f"processor: median {np.median(per_area):.1f} ms a square metre; "
        f"objects: median {np.median(objects):.0f}, {min(objects)} to {max(objects)}; "
        f"triangles: median {np.median(triangles):,.0f}, at most {max(triangles):,}; "
        f"{len(kinds)} kinds in all"
    )
    console.print(", ".join(f"{kind} {n}" for kind, n in sorted(kinds.items())), soft_wrap=True)


def timed(make: Callable[[], Scene]) -> tuple[Scene, float, float]:
    """A scene, the wall-clock seconds that it took, and the processor seconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    scene = make()
    return scene, time.perf_counter() - wall, time.process_time() - cpu


if __name__ == "__main__":
    tyro.cli(main)
