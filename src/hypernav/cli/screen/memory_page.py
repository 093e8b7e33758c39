"""The page about a memory: a plan of every floor with its things, key images and the history."""

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np

from hypernav.core.files.allowance import megabytes
from hypernav.core.labels import names_of
from hypernav.mapping.memory.connectors import Connector
from hypernav.mapping.memory.floor import Floor
from hypernav.mapping.memory.key_images import KeyImage
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.memory_folder import MemoryFolder
from hypernav.mapping.memory.thing import MOST_CHANCE, Thing
from hypernav.show.climbs import StairsMark
from hypernav.show.drawing.map_painter import MapPainter
from hypernav.show.drawing.map_view import MapView
from hypernav.show.templating import data_uri, image_uri, page_environment

_PLAN_PX = 900
_DRIVEN_M = 1.0
"""Distance between two positions, metres, beyond which another search began, or on stairs."""
_THUMBNAIL_PX = 240
_NEAREST_M = 0.1
"""Distance in front of a camera, metres, from which a corner of a thing is marked."""
_OUTCOMES = {
    "found": "found",
    "not_found": "not found",
    "model_unavailable": "the model was unavailable",
    "interrupted": "interrupted",
    "": "under way, or killed",
}


def memory_page(home: MemoryFolder) -> str:
    """The page, as HTML in one file.

    Args:
        home: The opened memory.
    """
    memory = home.memory
    kept = memory.images.kept if memory.images else []
    images = {one.number: (one, _thumbnail(one)) for one in kept}
    template = page_environment().get_template("memory.html.j2")
    return template.render(
        name=home.folder.resolve().name,
        building="" if home.place is None else home.place.building,
        left_out=home.left_out,
        most_chance=MOST_CHANCE,
        floors=[_floor(number, memory, images) for number in range(len(memory.floors))],
        images=[
            {
                "uri": images[one.number][1],
                "floor": one.floor + 1,
                "search": one.search,
                "shows": (shows := _shown(memory.floors[one.floor], one.number)),
                "words": " ".join(name for label in shows for name in names_of(label)),
            }
            for one in kept
            if one.floor < len(memory.floors)
        ],
        megabytes=sum(one.size for one in kept) / 1e6,
        limit=megabytes(home.most_bytes),
        history=[
            {
                "number": one.search,
                "goal": one.goal,
                "began": one.began.replace("T", " ")[:16],
                "outcome": _OUTCOMES.get(one.outcome, one.outcome),
                "steps": one.steps if one.outcome else "–",  # they are counted at its end
                "refuted": len(one.refuted),
            }
            for one in reversed(home.history)
        ],
    )


def _shown(floor: Floor, image: int) -> list[str]:
    """The names of the things that a key image shows best."""
    return sorted({thing.label for thing in floor.things.known if thing.image == image})


def _stairs(connectors: Sequence[Connector], floor: int) -> list[StairsMark]:
    """The stairs on a floor on which the robot may rely, and where they lead."""
    return [
        StairsMark(one.end, one.words if to is None else f"{one.words} to floor {to + 1}")
        for one in connectors
        if one.floor == floor and one.is_usable and (to := one.other_floor) != floor
    ]


_Images = Mapping[int, tuple[KeyImage, str]]
"""Key images and their thumbnails, by number."""


def _floor(number: int, memory: Memory, images: _Images) -> dict[str, Any]:
    floor = memory.floors[number]
    grid = floor.map.grid.cropped()
    view = MapView.fit(grid, _PLAN_PX)
    painter = MapPainter(grid, view=view)
    driven = ways(floor.trajectory)
    for way in driven:
        painter.trajectory(way)
    painter.stairs(_stairs(memory.connectors, number), driven)
    painter.scale_bar()
    return {
        "number": number + 1,
        "above_first_m": floor.z - memory.floors[0].z,
        "area_m2": float(grid.free.sum()) * grid.resolution_m**2,
        "plan": image_uri(painter.image),
        "size": _PLAN_PX,
        "things": [
            _thing(one, view, images)
            for one in sorted(floor.things.known, key=lambda one: (one.label, one.number))
        ],
    }


def ways(trajectory: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """The parts of a trajectory between which the robot did not drive."""
    ways = list[list[tuple[float, float]]]()
    for position in trajectory:
        if not ways or math.dist(ways[-1][-1], position) > _DRIVEN_M:
            ways.append([])
        ways[-1].append(position)
    return ways


def _thing(thing: Thing, view: MapView, images: _Images) -> dict[str, Any]:
    (left, bottom), (right, top) = (view.pixel_of(*one[:2]) for one in (thing.low, thing.high))
    x, y, z = thing.position
    shown, uri = (None, "") if thing.image is None else images.get(thing.image, (None, ""))
    return {
        "number": thing.number,
        "label": thing.label,
        "words": " ".join(names_of(thing.label)),
        "box": (left, top, max(right - left, 4.0), max(bottom - top, 4.0)),
        "area": thing.size[0] * thing.size[1],
        "position": f"{x:z.1f}, {y:z.1f}",
        "height": f"{z:z.1f}",
        "size": " × ".join(f"{side:.1f}" for side in thing.size),
        "chance": thing.chance,
        "is_gone": thing.is_gone,
        "seen": thing.seen,
        "missed": thing.missed,
        "last_search": thing.last_search,
        "image": uri,
        "mark": None if shown is None else mark(thing, shown),
    }


def mark(thing: Thing, image: KeyImage) -> tuple[float, float, float, float] | None:
    """Where a key image shows a thing, as the box around its corners there.

    Returns:
        Left, top, width and height as shares of the image; None if no corner is in front of it.
    """
    corners = np.array(list(itertools.product(*zip(thing.low, thing.high, strict=True))))
    seen = image.camera_to_map.inverse().apply(corners)
    seen = seen[seen[:, 2] > _NEAREST_M]
    if not len(seen):
        return None
    at = image.camera.project(seen) / (image.camera.width, image.camera.height)
    (left, top), (right, bottom) = (
        bound.clip(0.0, 1.0).tolist() for bound in (at.min(0), at.max(0))
    )
    return (left, top, right - left, bottom - top)


def _thumbnail(image: KeyImage) -> str:
    rgb = image.rgb
    height = max(round(rgb.shape[0] * _THUMBNAIL_PX / rgb.shape[1]), 1)
    small = cv2.resize(
        np.ascontiguousarray(rgb), (_THUMBNAIL_PX, height), interpolation=cv2.INTER_AREA
    )
    _, data = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])
    return data_uri(data.tobytes(), "image/jpeg")
