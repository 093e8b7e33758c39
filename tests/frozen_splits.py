"""Fingerprints of the frozen splits: what every building and its episodes must stay.

`RECORDED` holds them in a file, to which ``python tests/frozen_splits.py SPLIT…`` with an empty
``HYPERNAV_CACHE`` adds a new split, some 5 s a building. What is recorded stays as it is.

Digests are of numbers in whole millimetres and thousandths, so the last bits of floats, which
differ between processors, do not matter, and a chair that moved by a centimetre does. View points
come from thousands of rays, some of which graze an edge, so their number and middle are recorded.
"""

import argparse
import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.build.data.datasets import fingerprint, load_episodes
from hypernav.datasets.habitat_format import EpisodeDataset
from hypernav.houses.building import Building
from hypernav.houses.episodes.house_episodes import with_view_points
from hypernav.houses.episodes.splits import SPLITS, BuildingSplit, cached_episodes
from hypernav.houses.house_cache import cached_building
from hypernav.worlds.scenes.scene import Scene

RECORDED = Path(__file__).with_name("frozen_splits.json")
_STEPS = 1000
# Everything is rounded to tenths of a millimetre (or of a thousandth) before, so that an edge
# between two of those is as far from each as can be.
_EDGE = 0.55


@cache
def recorded() -> dict[str, Any]:
    """The recorded fingerprints by split: ``fingerprint`` of all, and ``buildings`` by number."""
    return json.loads(RECORDED.read_text("utf-8"))


def geometry_digest(scene: Scene) -> str:
    """Digest of what stands where: triangles, materials, and objects with their labels."""
    sha = hashlib.sha256(_whole(scene.vertices).tobytes())
    for array in (scene.faces, scene.face_material, scene.face_instance):
        sha.update(np.asarray(array, dtype="<i4").tobytes())
    sha.update(repr([(one.name, one.label) for one in scene.instances]).encode())
    looks = [(one.name, _whole(one.color).tolist(), one.unlit) for one in scene.materials]
    sha.update(repr((looks, scene.storeys)).encode())
    return sha.hexdigest()[:16]


def episodes_digest(dataset: EpisodeDataset) -> str:
    """Digest of a building's episodes: starts, goals, lengths of shortest paths."""
    episodes = [
        (
            *(one.episode_id, one.object_category, one.info and _in_steps(one.info)),
            *(_in_steps(one.start_position), _in_steps(one.start_rotation)),
        )
        for one in dataset.episodes
    ]
    goals = {
        key: [(one.object_id, one.object_category, _in_steps(one.position)) for one in found]
        for key, found in dataset.goals_by_category.items()
    }
    text = json.dumps((episodes, goals), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def view_points_of(dataset: EpisodeDataset, scene: Scene) -> list[float]:
    """Number of all view points of a building's goals, and their middle, metres."""
    found = with_view_points(dataset, scene).goals_by_category.values()
    objects = {one.object_id: one for goals in found for one in goals}.values()
    points = [p.agent_state.position for one in objects for p in one.view_points or ()]
    return [len(points), *np.mean(points, axis=0).round(3).tolist()]


def record(split: BuildingSplit, number: int, folder: Path | None) -> dict[str, Any]:
    """The fingerprints of one building of a split.

    Args:
        split: The split.
        number: Number of the building.
        folder: Cache folder; an empty one generates building and episodes; the platform's if None.
    """
    building = Building(split.kind, number)
    scene = cached_building(building, folder)
    dataset = cached_episodes(building, split.style, folder)
    return {
        "geometry": geometry_digest(scene),
        "episodes": episodes_digest(dataset),
        "view_points": view_points_of(dataset, scene),
    }


def _whole(values: Any) -> np.ndarray:
    return np.floor(np.asarray(values, dtype=np.float64) * _STEPS + _EDGE).astype("<i4")


def _in_steps(value: Any) -> Any:
    """The same value with every float in whole steps."""
    if isinstance(value, float):
        return int(_whole(value))
    if isinstance(value, dict):
        return {key: _in_steps(one) for key, one in value.items()}
    return [_in_steps(one) for one in value] if isinstance(value, list | tuple) else value


def sample_of(split: BuildingSplit) -> tuple[int, ...]:
    """The first, the middle and the last building of a split."""
    return (split.numbers[0], split.numbers[len(split.numbers) // 2], split.numbers[-1])


def main() -> None:
    """Record splits that are about to be frozen, first what the slow tests ask for."""
    parser = argparse.ArgumentParser(description="Record the fingerprints of splits.")
    parser.add_argument("splits", nargs="+", choices=list(SPLITS))
    splits = [SPLITS[name] for name in parser.parse_args().splits]
    known = json.loads(RECORDED.read_text("utf-8")) if RECORDED.is_file() else {}
    middles = [(split, sample_of(split)[1]) for split in splits]
    every = dict.fromkeys([*middles, *((split, k) for split in splits for k in split.numbers)])
    sampled = [(split, k) for split in splits for k in sample_of(split)]
    for split, number in sampled:
        entry = _entry(known, split, number)
        if "geometry" not in entry:
            entry["geometry"] = geometry_digest(cached_building(Building(split.kind, number)))
            _write(known)
    for done, (split, number) in enumerate(every, start=1):
        entry = _entry(known, split, number)
        if "episodes" not in entry:
            entry |= record(split, number, None)
            _write(known)
            print(f"{done} of {len(every)}: {split.name} {number}", flush=True)
    for split in splits:
        if "fingerprint" not in known[split.name]:
            known[split.name]["fingerprint"] = fingerprint(load_episodes(split.name))
            _write(known)


def _entry(splits: dict[str, Any], split: BuildingSplit, number: int) -> dict[str, Any]:
    """What is recorded of a building, to be added to."""
    buildings = splits.setdefault(split.name, {"buildings": {}})["buildings"]
    return buildings.setdefault(str(number), {})


def _write(splits: dict[str, Any]) -> None:
    """Write JSON with one building a line."""
    parts = []
    for name, one in splits.items():
        lines = [
            f'   "{key}": {json.dumps(value)}'
            for key, value in sorted(one["buildings"].items(), key=lambda item: int(item[0]))
            if value
        ]
        head = f'  "fingerprint": "{one["fingerprint"]}",\n' if "fingerprint" in one else ""
        parts.append(f' "{name}": {{\n{head}  "buildings": {{\n' + ",\n".join(lines) + "\n  }\n }")
    RECORDED.write_text("{\n" + ",\n".join(parts) + "\n}\n", "utf-8")


if __name__ == "__main__":
    main()
