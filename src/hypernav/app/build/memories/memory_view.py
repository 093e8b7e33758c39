"""The content of the view in three dimensions of what a robot remembers of a building."""

import math
from collections.abc import Sequence
from itertools import groupby

import numpy as np

from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import View, camera_frame, floor_plate, packed_cloud
from hypernav.core.geometry.transforms import Transform
from hypernav.search.memory.memory import Memory

_DRIVEN_M = 1.0
"""Distance between two positions, metres, beyond which another search began, or on stairs."""


def memory_view(memory: Memory) -> View | None:
    """What its key images show, its things and the ways; None of a memory without a floor."""
    if not memory.floors:
        return None
    cloud = ColouredCloud()
    views = []
    for one in memory.images.kept if memory.images else []:
        if one.floor >= len(memory.floors):
            continue
        up = Transform(np.eye(3), np.array([0.0, 0.0, memory.floors[one.floor].z]))
        camera_to_map = up @ one.camera_to_map
        cloud.add(one.rgb, one.depth, one.camera, camera_to_map, floor=one.floor + 1)
        views.append(
            {
                "floor": one.floor + 1,
                "corners": camera_frame(one.camera, camera_to_map),
                "image": f"image-{one.number}",
                "words": f"key image of search {one.search}",
            }
        )
    return {
        "floors": [
            floor_plate(number, f"Floor {number}", floor.z, floor.map.grid)
            for number, floor in enumerate(memory.floors, 1)
        ],
        "cloud": packed_cloud(cloud) if views else None,
        "paths": [
            {
                "floor": number,
                "color": "--way",
                "points": [[round(x, 3), round(y, 3), floor.z] for x, y in way],
            }
            for number, floor in enumerate(memory.floors, 1)
            for way in ways([at for at, _ in groupby(floor.trajectory)])
            if len(way) > 1
        ],
        "marks": [],
        "boxes": [
            {
                "floor": number,
                "low": [*one.low[:2], floor.z + one.low[2]],
                "high": [*one.high[:2], floor.z + one.high[2]],
                "color": "--bad" if one.is_gone else "--series-1",
                "words": f"{one.label}, {100 * one.chance:.0f} % sure",
                "row": f"thing-{number}-{one.number}",
            }
            for number, floor in enumerate(memory.floors, 1)
            for one in floor.things.known
        ],
        "views": views,
    }


def ways(trajectory: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """The parts of a trajectory between which the robot did not drive."""
    ways = list[list[tuple[float, float]]]()
    for position in trajectory:
        if not ways or math.dist(ways[-1][-1], position) > _DRIVEN_M:
            ways.append([])
        ways[-1].append(position)
    return ways
