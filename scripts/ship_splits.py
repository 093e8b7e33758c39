"""Writes what is shipped of the built-in splits: their episodes, and what their buildings are.

For a new split, or one whose buildings were given new numbers; what is written stays as it is, and
no file is made again. Some 10 s a building.

Run: python scripts/ship_splits.py SPLIT…
"""

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.lab.datasets.building_splits import SPLITS
from hypernav.lab.datasets.habitat_files import write_episodes
from hypernav.lab.datasets.habitat_format import EpisodeDataset
from hypernav.lab.datasets.shipped import SHIPPED
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.episodes.house_episodes import with_view_points
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.house_cache import cached_building, geometry_digest
from hypernav.simulator.worlds.scenes.scene import Scene

BUILDINGS = SHIPPED / "buildings.json"


def main() -> None:
    """Write the files of some splits."""
    parser = argparse.ArgumentParser(description="Write the shipped files of splits.")
    parser.add_argument("splits", nargs="+", choices=list(SPLITS))
    for name in parser.parse_args().splits:
        ship(name, SHIPPED)


def ship(name: str, folder: Path) -> None:
    """Write the episodes of a split, and record its buildings one by one."""
    split, known = SPLITS[name], json.loads(BUILDINGS.read_text("utf-8"))
    path = folder / f"{name}.json.gz"
    if not path.is_file():
        write_episodes(load_split(name), path)
    buildings = known.setdefault(name, {})
    for number in split.numbers:
        if "view_points" not in (entry := buildings.setdefault(str(number), {})):
            entry |= record(name, number)
            _write(known)
            print(f"{name} {number}", flush=True)


def record(name: str, number: int, cache: Path | None = None) -> dict[str, Any]:
    """What is recorded of a building.

    Args:
        name: Name of its split.
        number: Its number.
        cache: Cache folder; an empty one draws the building anew, None is the platform's.
    """
    scene = cached_building(Building(SPLITS[name].kind, number), cache)
    episodes = load_split(name, numbers=range(number, number + 1), cache=cache)
    return {
        "geometry": geometry_digest(scene),
        "view_points": view_points_of(episodes, scene),
    }


def view_points_of(dataset: EpisodeDataset, scene: Scene) -> list[float]:
    """Number of all view points of a building's goals, and their middle, metres.

    They come from thousands of rays, some of which graze an edge, so they have no digest.
    """
    found = with_view_points(dataset, scene).goals_by_category.values()
    objects = {one.object_id: one for goals in found for one in goals}.values()
    points = [p.agent_state.position for one in objects for p in one.view_points or ()]
    return [len(points), *np.mean(points, axis=0).round(3).tolist()]


def _write(splits: dict[str, dict[str, Any]]) -> None:
    """Write JSON with one building a line."""
    parts = []
    for name, buildings in splits.items():
        numbers = sorted(filter(buildings.get, buildings), key=int)
        lines = [f'  "{number}": {json.dumps(buildings[number])}' for number in numbers]
        parts.append(f' "{name}": {{\n' + ",\n".join(lines) + "\n }")
    BUILDINGS.write_text("{\n" + ",\n".join(parts) + "\n}\n", "utf-8")


if __name__ == "__main__":
    main()
