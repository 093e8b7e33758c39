"""The page about what a robot remembers of a building, and its things as rows of a table.

The page shows a plan of every floor with its things, a view in three dimensions, key images and the
history.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

import cv2
import numpy as np

from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import View, camera_frame, floor_plate, library, packed_cloud
from hypernav.app.show.templating import data_uri, html_table, image_uri, page_environment
from hypernav.core.geometry.transforms import Transform
from hypernav.core.naming.labels import names_of
from hypernav.core.naming.words import megabytes
from hypernav.search.drawing.map_painter import MapPainter, StairsMark
from hypernav.search.drawing.map_view import MapView
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.floor import Floor
from hypernav.search.memory.key_images import KeyImage
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.search.memory.thing import MOST_CHANCE, Thing

_PLAN_PX = 900
_THUMBNAIL_PX = 240
_OUTCOMES = {
    "found": "found",
    "not_found": "not found",
    "model_unavailable": "the model was unavailable",
    "interrupted": "interrupted",
    "": "under way, or killed",
}
_DRIVEN_M = 1.0
"""Distance between two positions, metres, beyond which another search began, or on stairs."""


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
        space=memory_view(memory),
        library=library(),
        images=[
            {
                "number": one.number,
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


def in_short(memory: Memory) -> str:
    """The plan of every floor and a table of its things, as HTML for a notebook."""
    floors = (_floor(number, memory, {}) for number in range(len(memory.floors)))
    plans = "".join(
        f'<figure><img src="{one["plan"]}" alt="plan of floor {one["number"]}" '
        f'style="max-width: 30em"><figcaption>floor {one["number"]}, {one["area_m2"]:.0f} m² seen'
        "</figcaption></figure>"
        for one in floors
    )
    return plans + html_table([_in_words(row) for row in thing_rows(memory)])


def thing_rows(memory: Memory) -> list[dict[str, Any]]:
    """A row for every thing, floor by floor.

    ``x``, ``y`` and ``z`` are the middle of its box in the ``map`` frame, ``length_x``,
    ``length_y`` and ``height`` its sides: metres, heights above the floor.
    """
    return [
        {
            "floor": number,
            "thing": one.number,
            "label": one.label,
            **dict(zip(("x", "y", "z"), one.position, strict=True)),
            **dict(zip(("length_x", "length_y", "height"), one.size, strict=True)),
            "chance": one.chance,
            "seen": one.seen,
            "missed": one.missed,
            "is_gone": one.is_gone,
            "first_search": one.first_search,
            "last_search": one.last_search,
        }
        for number, floor in enumerate(memory.floors, 1)
        for one in floor.things.known
    ]


def _in_words(row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "thing": row["label"],
        "floor": row["floor"],
        "x, y, z in m": f"{row['x']:.1f}, {row['y']:.1f}, {row['z']:.1f}",
        "images": row["seen"],
        "chance": f"{row['chance']:.0%}",
        "": "gone" if row["is_gone"] else "",
    }


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
        "mark": None if shown is None else shown.box_of(thing.low, thing.high),
    }


def _thumbnail(image: KeyImage) -> str:
    rgb = image.rgb
    height = max(round(rgb.shape[0] * _THUMBNAIL_PX / rgb.shape[1]), 1)
    small = cv2.resize(
        np.ascontiguousarray(rgb), (_THUMBNAIL_PX, height), interpolation=cv2.INTER_AREA
    )
    _, data = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])
    return data_uri(data.tobytes(), "image/jpeg")


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
