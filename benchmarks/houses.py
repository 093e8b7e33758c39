"""Time the generation of houses and their loading from the cache.

Run: python benchmarks/houses.py [--first 100000] [--count 500]

Every house is built from its number and written to a fresh cache folder, then loaded from it as
`hypernav find --scene houses:N` does. The textures that all houses share are painted once a
process; they count in the first house only. Other programs on the machine affect the times: hence
the CPU time beside them. A number that gives no house ends the program with an error.
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

from hypernav.houses.generator import build_house
from hypernav.houses.house_cache import cached_house
from hypernav.worlds.scenes.scene import Scene


def main(first: int = 100_000, count: int = 500, cached: int = 30) -> None:
    """Print the table.

    Args:
        first: Number of the first house.
        count: Number of houses to build.
        cached: Number of houses that are also loaded from the cache.
    """
    console = Console(highlight=False)
    numbers = range(first, first + count)
    built: list[tuple[float, float]] = []
    objects, triangles, kinds = [], [], Counter[str]()
    for number in numbers:
        scene, wall, cpu = timed(lambda n=number: build_house(n))
        built.append((wall, cpu))
        labels = [i.label for i in scene.instances if i.label is not None]
        kinds.update({label.category for label in labels})
        objects.append(len(labels))
        triangles.append(len(scene.faces))
    loaded = []
    with tempfile.TemporaryDirectory() as folder:
        for number in numbers[:cached]:
            cached_house(number, Path(folder))
        for number in numbers[:cached]:
            _, wall, cpu = timed(lambda n=number: cached_house(n, Path(folder)))
            loaded.append((wall, cpu))
    table = Table("what", "houses", "median s", "p95 s", "most s", "median CPU s")
    for name, spent in (("from its number", built), ("from the cache", loaded)):
        wall, cpu = np.array(spent).T
        values = (np.median(wall), np.quantile(wall, 0.95), wall.max(), np.median(cpu))
        table.add_row(name, str(len(spent)), *(f"{value:.2f}" for value in values))
    console.print(table)
    console.print(
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
